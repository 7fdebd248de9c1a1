//! A training in every medium.

use drivescope_diagnoser::Channel;
use drivescope_diagnoser::bank::{LearnedNoise, Limits};
use drivescope_scenarios::results::SizeGroup;

use super::*;
use crate::answer::testing::{holds, in_report, on_page};
use crate::answer::text;

fn bands() -> BandsAnswer {
    BandsAnswer {
        orders: Some([4, 3]),
        run_up: 210,
        v: 5.678_9,
        plain: 6.543_2,
        samples: 3000,
        whiteness_p: Some(0.012_34),
        normality_p: None,
        used: true,
        refused: None,
    }
}

fn bank() -> BankAnswer {
    let confusion = Confusion {
        mechanism: "flux".to_owned(),
        size: 0.1,
        shows: true,
        set: vec!["torque_constant".to_owned()],
        separable: vec![Separable { mechanism: "torque_constant".to_owned(), speed: 157.08 }],
        set_without_current: None,
    };
    BankAnswer {
        drive: "AMIRA DR300".to_owned(),
        noise: LearnedNoise { omega: 0.314_15, i: 0.010_12, torque: 0.001_23, torque_time: 0.0503 },
        arl_0: 1e6,
        limits: Limits { ratio: 21.43, squares: 33.21 },
        horizon_samples: 100,
        baseline_samples: 1000,
        verified: VerifiedAnswer {
            samples: 3_000_000,
            alarms: 2,
            arl_0_at_least: 412_345.0,
            recorded: 6001,
            recorded_alarms: 0,
        },
        confusions: vec![confusion],
    }
}

fn answer() -> TrainAnswer {
    let channel = |name: &str, unit: &str| Channel { name: name.into(), unit: unit.into() };
    let fault = FaultAnswer {
        fault: "tacho".to_owned(),
        right: 0.987,
        unknown: 0.0123,
        s: 2.345,
        group: SizeGroup::Small,
    };
    TrainAnswer {
        output: Some("diagnoser.toml".into()),
        detectors: Stored::default(),
        designed: vec![("another test", "threshold 7.031".to_owned())],
        inputs: vec![channel("C_m", "V")],
        watched: channel("T", "rpm"),
        period: 0.005,
        beta: 0.05,
        window_samples: 50,
        run_up_samples: 500,
        process_model: ProcessAnswer {
            v1: 3,
            v2: 5,
            order: 2,
            estimation_rms: 4.321,
            validation_rms: 4.567,
        },
        structures: Vec::new(),
        bands: bands(),
        recurrent_error: None,
        constant: ConstantAnswer { lower: -12.34, upper: 11.65 },
        windows: None,
        gmdh: None,
        faults: Some(FaultsAnswer {
            classes: vec![vec!["tacho".to_owned()], vec!["flux".to_owned()]],
            faults: vec![fault],
        }),
        bank: Some(bank()),
    }
}

#[test]
fn text_and_page_tell_the_same_numbers() {
    let blocks = answer().blocks();
    let (said, page) = (text(&blocks), on_page(&blocks));
    holds(&blocks, &page);
    holds(&blocks, &in_report(&blocks));
    for number in ["5.68 rpm", "4.32 rpm", "-12.3 rpm to 11.7 rpm", "98.7 %", "21.4", "157 (SI)"] {
        assert!(said.contains(number), "{number} is not in: {said}");
    }
    // The page keeps the diagnoser and names no file.
    assert!(said.contains("written: diagnoser.toml") && !page.contains("diagnoser.toml"));
}
