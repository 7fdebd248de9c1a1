//! A comparison in every medium.

use drivescope_discovery::NoiseSource;
use drivescope_discovery::compare::{
    Comparison, Correlation, Curve, Finding, OutputComparison, RecordingComparison, Span,
};
use drivescope_plant::drive::Motion;
use drivescope_recording::Recording;

use super::{OfStep, Setting, blocks};
use crate::answer::testing::{holds, in_report, on_page};
use crate::answer::text;
use crate::read_evidence::KnownNoise;

fn correlation(correlated: bool) -> Correlation {
    let (lags, values, bands) = (vec![0.0, 0.001], vec![1.0, 0.2], vec![0.1, 0.1]);
    Correlation { lags, values, bands, effective_samples: 1234.4, correlated }
}

/// Of a drive that lacks a torque over the angle.
pub(in crate::answer) fn comparison() -> Comparison {
    let output = OutputComparison {
        name: "omega",
        unit: "rad/s".to_owned(),
        noise: 0.3,
        fit_percent: Some(98.765_4),
        rms: 0.456_78,
        error: 1.523_45,
        one_step_error: 1.023_45,
        one_step_percent: Some(99.123_4),
        autocorrelation: correlation(true),
        input_correlation: correlation(false),
        residual: vec![0.1; 4],
        model: vec![1.0; 4],
    };
    let span = |sentence: &str| Span {
        from: 0.01,
        to: 0.02,
        sentence: sentence.to_owned(),
        error: 3.456_78,
    };
    let x = vec![0.0, 0.25, 0.5];
    Comparison {
        observer_hz: 12.5,
        floor: 0.987_65,
        error: 1.616_16,
        error_if_fitted: 1.313_13,
        by_parameters: 0.62,
        parameters_matter: true,
        by_balances: false,
        findings: vec![Finding {
            variable: "theta",
            p_value: 4.8e-23,
            share: 0.7344,
            balance: "torque",
            words: "a torque repeats with the angle".to_owned(),
            period: Some(0.524_1),
        }],
        tested: 17,
        block_s: 0.2,
        recordings: vec![RecordingComparison {
            name: "one.csv".to_owned(),
            error: 1.616_16,
            outputs: vec![output],
            spans: vec![span("Between 0.01 and 0.02 s omega is too low")],
        }],
        curves: vec![Curve {
            variable: "theta",
            balance: "torque",
            words: "torque over the angle",
            x_unit: "rad".to_owned(),
            unit: "N m".to_owned(),
            value: vec![0.0, 0.005, 0.0],
            lower: vec![-0.001, 0.004, -0.001],
            upper: vec![0.001, 0.006, 0.001],
            x,
        }],
    }
}

fn setting(step: Option<OfStep>) -> Setting {
    Setting {
        drive: "AMIRA DR300".to_owned(),
        motion: Motion::Rotary,
        noise: vec![KnownNoise {
            name: "omega",
            sd: 0.3,
            unit: "rad/s".to_owned(),
            source: NoiseSource::Given,
        }],
        validation_error: Some(1.717_17),
        step,
        clocks: vec![Recording::new("one.csv", 0.0, 0.01, Vec::new()).clock()],
        doubts: Vec::new(),
        seed: 1,
    }
}

#[test]
fn text_page_and_report_tell_the_same_numbers() {
    let blocks = blocks(&comparison(), &setting(None));
    holds(&blocks, &in_report(&blocks));
    holds(&blocks, &on_page(&blocks));
    let said = text(&blocks);
    for number in ["1.616", "1.717", "1.313", "73.4 %", "4.80e-23", "0.524 rad", "98.77 %"] {
        assert!(said.contains(number), "{number} is not in: {said}");
    }
    assert!(said.starts_with("AMIRA DR300: The model fails over theta: a torque"), "{said}");
}

/// Of a drive that was fitted to a part, the error over all is none of its figures.
#[test]
fn estimation_and_validation_are_never_pooled() {
    let step = OfStep { estimation_error: 1.212_12, fitted: true };
    let mut compared = comparison();
    compared.recordings[0].error = 1.5;
    let blocks = blocks(&compared, &setting(Some(step)));
    for stated in [text(&blocks), on_page(&blocks), in_report(&blocks)] {
        assert!(stated.contains("1.212") && stated.contains("1.717"), "{stated}");
        assert!(!stated.contains("1.616"), "{stated}");
    }
}
