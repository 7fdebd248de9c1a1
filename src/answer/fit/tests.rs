//! A fit in text and in HTML.

use std::collections::BTreeMap;

use drivescope_discovery::{BothUnexplained, Estimate, NoiseSource, NotIdentifiable, Unexplained};
use drivescope_plant::drive::Motion;

use super::{Before, BeforeAndAfter, Correlation, FitAnswer, OfRecording};
use crate::answer::testing::{holds, in_report, on_page};
use crate::answer::text;
use crate::read_evidence::KnownNoise;

fn estimate(name: &str, value: f64, std_error: f64) -> Estimate {
    let unit = "ohm".to_owned();
    Estimate { name: name.to_owned(), value, std_error, before: 3.7, unit, at_bound: false }
}

fn answer(error: f64) -> FitAnswer {
    let remainder =
        |share| BothUnexplained { torque: Some(Unexplained { rms: 0.01, share }), voltage: None };
    let fits = |fit| BTreeMap::from([("omega", Some(fit))]);
    let both = [estimate("R", 3.128_456_7, 0.012_34), estimate("L", 0.005_012_3, 0.004)];
    let noise = KnownNoise {
        name: "omega",
        sd: 0.312_34,
        unit: "rad/s".to_owned(),
        source: NoiseSource::Estimated,
    };
    FitAnswer {
        drive: "AMIRA DR300".to_owned(),
        motion: Motion::Rotary,
        output: Some("fitted.toml".into()),
        order: both.iter().map(|it| it.name.clone()).collect(),
        parameters: both.into_iter().map(|it| (it.name.clone(), it)).collect(),
        correlation: Correlation {
            names: Vec::new(),
            matrix: Vec::new(),
            strong: vec![("R".to_owned(), "L".to_owned(), -0.987)],
        },
        not_identifiable: vec!["B_m".to_owned()],
        kept: vec![NotIdentifiable { parameter: "B_m".to_owned(), kept: 6e-5, with: Vec::new() }],
        error,
        validation_error: 1.234 * error,
        before: Before { error: None, validation_error: Some(41.234_5) },
        unexplained: BeforeAndAfter {
            before: remainder(0.5),
            after: remainder(0.069),
            validation_before: remainder(0.55),
            validation_after: remainder(0.0712),
        },
        fit_percent: BeforeAndAfter {
            before: BTreeMap::new(),
            after: fits(97.345),
            validation_before: fits(80.125),
            validation_after: fits(96.5),
        },
        noise: BTreeMap::new(),
        noise_source: BTreeMap::new(),
        recordings: vec![OfRecording {
            file: "one.csv".to_owned(),
            held_out: false,
            values: 100,
            error,
            noise: vec![noise],
            own: vec![estimate("constant_load.T_0", 0.001_234_5, 1e-5)],
        }],
        split: "judged by two.csv".to_owned(),
        signals: Vec::new(),
        doubts: Vec::new(),
        observer_hz: 0.0,
        noise_floor: 1.0,
        relative_force_error: None,
        block_s: 0.1,
        starts: 3,
        by_balances: false,
        seed: 1,
    }
}

#[test]
fn text_and_html_tell_the_same_numbers() {
    let blocks = answer(1.162_5).blocks();
    holds(&blocks, &in_report(&blocks));
    holds(&blocks, &on_page(&blocks));
    let said = text(&blocks);
    assert!(said.starts_with("AMIRA DR300: fitted to one.csv\njudged by two.csv\n"), "{said}");
    for words in ["3.12846", "0.0123", "80 %", "6.9 %", "overflow", "1.163", "41.23", "-0.987"] {
        assert!(said.contains(words), "{words} is not in: {said}");
    }
    assert!(said.contains("in one.csv") && said.ends_with("written: fitted.toml\n"), "{said}");
    assert!(said.contains("not identifiable: B_m, kept at 6.00000e-5: nothing"), "{said}");
}

/// Where the noise is out of reach its unit says nothing.
#[test]
fn errors_far_above_the_noise_are_left_out() {
    let said = text(&answer(2345.6).blocks());
    assert!(!said.contains("units of the noise") && said.contains("unexplained torque"), "{said}");
}
