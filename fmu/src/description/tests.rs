//! A small description that has one of everything, for the tests of this crate.

use super::*;

/// References: 1 `k` (parameter), 2 `u` (input), 3 `x` (state), 4 `der(x)`, 5 `y` (output),
/// 6 `z` (event indicator), 7 `n` (integer), 8 `held` (boolean input), 9 `g` (constant).
pub(crate) fn description() -> ModelDescription {
    use Causality::{Input, Local, Output, Parameter};
    use Variability::{Constant, Continuous, Discrete, Fixed, Tunable};
    let unit = |variable: Variable, unit: &str| variable.in_unit(unit).unwrap();
    let k = Variable::new(1, "k", Parameter, Tunable).starting_at(2.0).described("A < B & \"C\"");
    let u = Variable::new(2, "u", Input, Discrete).starting_at(0.0);
    let x = Variable::new(3, "shaft.x", Local, Continuous).starting_at(1.0);
    let derivative = Variable::new(4, "der(shaft.x)", Local, Continuous);
    let y = Variable::new(5, "y", Output, Continuous);
    let z = Variable::new(6, "z", Local, Continuous);
    let n = Variable::new(7, "n", Parameter, Fixed).starting_at(3.0);
    let held = Variable::new(8, "held", Input, Discrete).starting_at(1.0);
    let g = Variable::new(9, "g", Local, Constant).starting_at(9.81);
    let unknown = |reference, dependencies: &[u32]| Unknown {
        reference,
        dependencies: dependencies.to_vec(),
    };
    ModelDescription {
        name: "Tiny & sound".into(),
        identifier: "tiny".into(),
        description: "One of everything".into(),
        version: "1.2.3".into(),
        generation_tool: "drivescope".into(),
        capabilities: Capabilities {
            co_simulation: true,
            model_exchange: true,
            directional_derivatives: true,
            variable_step: true,
        },
        variables: vec![
            Variable { min: Some(1e-7), ..unit(k, "1/s") },
            Variable { min: Some(-10.0), max: Some(10.0), ..unit(u, "rpm") },
            Variable {
                initial: Some(Initial::Exact),
                nominal: Some(5.0),
                reinit: true,
                ..unit(x, "rad")
            },
            Variable { derivative_of: Some(3), ..unit(derivative, "rad/s") },
            y,
            z,
            Variable { kind: Type::Int32, max: Some(7.0), ..n },
            Variable { kind: Type::Boolean, ..held },
            g,
        ],
        structure: Structure {
            outputs: vec![unknown(5, &[3, 2])],
            derivatives: vec![unknown(4, &[3])],
            event_indicators: vec![unknown(6, &[TIME, 3])],
            initial_unknowns: vec![unknown(5, &[3]), unknown(4, &[3, 1])],
        },
        default_experiment: DefaultExperiment {
            start: Some(0.0),
            stop: Some(2.0),
            tolerance: Some(1e-9),
            step: Some(0.01),
        },
    }
}

#[test]
fn fmi2_refers_by_index_and_fmi3_by_value_reference() {
    let description = description();
    let two = description.to_xml(Version::Two).unwrap();
    assert!(two.contains(r#"<Real unit="rad/s" derivative="4"/>"#), "{two}");
    assert!(two.contains(r#"<Unknown index="6" dependencies="3 4"/>"#), "{two}");
    let initial = two.split("<InitialUnknowns>").nth(1).unwrap();
    let order = [initial.find("index=\"5\""), initial.find("index=\"6\"")];
    assert!(order[0].unwrap() < order[1].unwrap(), "initial unknowns by ascending index: {two}");
    assert!(two.contains(r#"numberOfEventIndicators="1""#), "{two}");

    let three = description.to_xml(Version::Three).unwrap();
    assert!(three.contains(r#"unit="rad/s" derivative="3"/>"#), "{three}");
    assert!(three.contains(r#"<Output valueReference="5" dependencies="3 2"/>"#), "{three}");
    assert!(
        three.contains(r#"<EventIndicator valueReference="6" dependencies="0 3"/>"#),
        "{three}"
    );
}

#[test]
fn both_versions_escape_and_keep_every_digit() {
    for version in [Version::Two, Version::Three] {
        let xml = description().to_xml(version).unwrap();
        assert!(xml.contains("A &lt; B &amp; &quot;C&quot;"), "{xml}");
        assert!(xml.contains(r#"min="1e-7""#), "{xml}");
        assert!(
            xml.contains(r#"<BaseUnit s="-1" rad="1" factor="0.10471975511965977"/>"#),
            "{xml}"
        );
        assert!(!xml.contains(r#"start="calculated"#), "{xml}");
    }
}

#[test]
fn the_token_follows_the_content() {
    let first = description();
    assert_eq!(first.token(), description().token());
    let token = first.token();
    assert!(first.to_xml(Version::Two).unwrap().contains(&format!(r#"guid="{token}""#)));
    let mut second = description();
    second.variables[0].start = Some(2.0 + f64::EPSILON * 2.0);
    assert_ne!(token, second.token());
}

#[test]
fn states_are_ordered_by_their_derivatives() {
    assert_eq!(description().states(), [3]);
}

/// What the importer reads is what the model said, by the importer's own model of a description.
#[cfg(feature = "import")]
#[test]
fn the_importer_reads_what_was_written() {
    let own = description();
    for version in [Version::Two, Version::Three] {
        let xml = own.to_xml(version).unwrap();
        let read = crate::import::parsed(&xml).unwrap();
        assert_eq!((read.fmi, &read.token), (version, &own.token()));
        assert_eq!(
            (&read.model_name, read.default_experiment),
            (&own.name, own.default_experiment)
        );
        assert_eq!(read.variables.len(), own.variables.len() + 1, "and time");
        for said in &own.variables {
            let got = read.variable(&said.name).unwrap();
            assert_eq!((got.reference, got.kind), (said.reference, said.kind), "{}", said.name);
            assert_eq!((got.causality, got.variability), (said.causality, said.variability));
            assert_eq!(got.initial, Some(said.initial()), "{}", said.name);
            assert_eq!(got.description.as_deref().unwrap_or_default(), said.description);
            assert_eq!((got.range, got.nominal), ((said.min, said.max), said.nominal));
            assert_eq!(got.unit, said.unit.as_ref().map(|unit| unit.name.clone()));
            assert_eq!(got.unit.as_ref().and_then(|name| read.unit(name)), said.unit.as_ref());
            let start = got.start.first().map(|text| match text.as_str() {
                "true" => 1.0,
                "false" => 0.0,
                number => number.parse().unwrap(),
            });
            assert_eq!(start, said.start, "{}", said.name);
        }
        let names = |unknowns: &[crate::import::Unknown]| -> Vec<String> {
            let positions = unknowns.iter().map(|unknown| unknown.variable.unwrap());
            positions.map(|position| read.variables[position].name.clone()).collect()
        };
        assert_eq!(names(&read.structure.outputs), ["y"]);
        assert_eq!(names(&read.structure.derivatives), ["der(shaft.x)"]);
        assert_eq!(read.structure.event_indicators, own.structure.event_indicators.len());
        assert!(crate::import::against_rules(&read).is_empty(), "{version:?}");
    }
}
