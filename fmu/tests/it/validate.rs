//! The rules of the standard, each broken once.

use drivescope_fmu::import::{Finding, Fmu, Severity, validate};

use crate::foreign::lags;
use crate::support::{archive, probe, probe_with};

fn texts(findings: &[Finding]) -> Vec<String> {
    findings.iter().map(Finding::to_string).collect()
}

#[test]
fn nothing_is_found_in_a_good_fmu() {
    for fmi in ["2", "3"] {
        let Some(fmu) = probe(fmi) else { return };
        assert_eq!(texts(&validate(&fmu)), Vec::<String>::new());
    }
}

#[test]
fn every_broken_rule_is_found() {
    let cases = [
        ("2", "name=\"g\"", "name=\"e\"", "variable `e` exists twice, first in line 25"),
        ("2", "name=\"held\"", "name=\"1 held\"", "does not follow the structured naming"),
        (
            "3",
            "name=\"g\" valueReference=\"8\"",
            "name=\"g\" valueReference=\"9\"",
            "has value reference 9, as has",
        ),
        (
            "2",
            "<Real start=\"1\" unit=\"m\"/>",
            "<Real start=\"1\" unit=\"yd\"/>",
            "unit `yd` of `h` is not defined",
        ),
        (
            "3",
            "declaredType=\"Mode\"",
            "declaredType=\"Mood\"",
            "type `Mood` of `mode` is not defined",
        ),
        (
            "2",
            "initial=\"exact\"><Real start=\"1\" unit=\"m\"/>",
            "initial=\"exact\"><Real unit=\"m\"/>",
            "`h` has no start value",
        ),
        (
            "3",
            "causality=\"output\" unit=\"rpm\"",
            "causality=\"output\" start=\"0\" unit=\"rpm\"",
            "`x_rpm` must not have a start value",
        ),
        (
            "3",
            "valueReference=\"31\" causality=\"parameter\" variability=\"fixed\"",
            "valueReference=\"31\" causality=\"parameter\" variability=\"discrete\"",
            "do not go together",
        ),
        (
            "2",
            "causality=\"input\" variability=\"continuous\"",
            "causality=\"input\" initial=\"exact\" variability=\"continuous\"",
            "`u` must not state `initial`",
        ),
        (
            "2",
            "<Boolean start=\"true\"/>",
            "<Boolean start=\"yes\"/>",
            "the start value `yes` of `on` is no Boolean",
        ),
        ("3", "start=\"1 2 3\"", "start=\"1 2\"", "`triple` has 2 start values for 3 elements"),
        (
            "3",
            "start=\"0.5\" unit=\"s\"",
            "start=\"0.5\" max=\"0.1\" unit=\"s\"",
            "is outside its range",
        ),
        (
            "3",
            "<Output valueReference=\"5\" dependencies=\"5\"/>",
            "",
            "`h` is missing from the outputs",
        ),
        (
            "2",
            "<Unknown index=\"11\" dependencies=\"\"/>",
            "<Unknown index=\"99\"/>",
            "one of the outputs is no variable",
        ),
        (
            "2",
            "dependenciesKind=\"dependent\"",
            "dependenciesKind=\"dependent fixed\"",
            "1 dependencies, but 2 kinds",
        ),
        (
            "3",
            "<InitialUnknown valueReference=\"11\"/>",
            "",
            "`x_rpm` is missing from the initial unknowns",
        ),
        (
            "3",
            "<InitialUnknown valueReference=\"11\"/>",
            "<InitialUnknown valueReference=\"11\"/><InitialUnknown valueReference=\"2\"/>",
            "`T` does not belong to the initial unknowns",
        ),
        (
            "2",
            "<Real derivative=\"4\"/>",
            "<Real/>",
            "`der(x)` does not say whose derivative it is",
        ),
        ("3", "derivative=\"3\"", "derivative=\"2\"", "the state `T` of `der(x)` is no continuous"),
        (
            "3",
            "<Float64 name=\"time\" valueReference=\"0\" causality=\"independent\" variability=\"continuous\" unit=\"s\"/>",
            "",
            "there is no independent variable",
        ),
        ("2", "stopTime=\"1\"", "stopTime=\"0\"", "does not stop after its start"),
        ("2", "guid=\"{probe}\"", "guid=\"{x}\"", "Co-Simulation: "),
    ];
    for (fmi, from, to, expected) in cases {
        let Some(fmu) = probe_with(fmi, |text| {
            assert!(text.contains(from), "{from}");
            text.replacen(from, to, 1)
        }) else {
            return;
        };
        let found = validate(&fmu);
        let texts = texts(&found);
        assert!(texts.iter().any(|text| text.contains(expected)), "{expected}: {texts:#?}");
        assert!(found.iter().any(|finding| finding.severity == Severity::Error), "{expected}");
    }
}

#[test]
fn findings_have_places() {
    let Some(fmu) = probe_with("3", |text| text.replace("unit=\"m\"/>", "unit=\"yd\"/>")) else {
        return;
    };
    let found = texts(&validate(&fmu));
    assert!(found[0].starts_with("error: modelDescription.xml:22:5: unit `yd`"), "{found:?}");
}

#[test]
fn an_fmu_for_another_platform_gets_a_warning() {
    let fmu =
        Fmu::open(archive(&[("modelDescription.xml", include_bytes!("data/probe3.xml"))])).unwrap();
    let found = validate(&fmu);
    assert!(found.iter().all(|finding| finding.severity == Severity::Warning) && !found.is_empty());
}

#[test]
fn foreign_fmus_are_checked() {
    for path in lags() {
        let found = texts(&validate(&Fmu::open(path).unwrap()));
        // What `pythonfmu` leaves out of the model structure; nothing else is wrong.
        assert!(found.iter().all(|text| text.contains("of the model structure")), "{found:#?}");
    }
}
