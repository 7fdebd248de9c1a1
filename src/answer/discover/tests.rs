//! A discovery in every medium.

use std::collections::BTreeMap;

use drivescope_discovery::{
    BothUnexplained, Coefficient, LadderStep, LearnedCurve, Oscillation, RandomLoad, Ranked,
    Unexplained, Unfitted, Verdict,
};
use drivescope_plant::drive::Motion;

use super::{Missing, Step, ladder};
use crate::answer::block::Block;
use crate::answer::compare::sample;
use crate::answer::testing::{holds, in_report, on_page};
use crate::answer::text;

fn step(added: Option<&str>, error: f64) -> LadderStep {
    let remainder = Some(Unexplained { rms: 0.001, share: 0.0690 });
    let remainder = BothUnexplained { torque: remainder, voltage: None };
    let fits = BTreeMap::from([("omega", Some(97.345)), ("i", None)]);
    LadderStep {
        added: added.map(str::to_owned),
        error,
        validation_error: 1.3 * error,
        unexplained: remainder,
        validation_unexplained: remainder,
        fit_percent: fits.clone(),
        validation_fit_percent: fits,
    }
}

fn ranked(effect: &str, refused: Option<&str>) -> Ranked {
    let value = Coefficient { value: 0.005_12, std_error: 1.2e-5, unit: "N m".to_owned() };
    Ranked {
        effect: effect.to_owned(),
        confusion_set: vec!["torque_ripple".to_owned()],
        delta_bic: 321.0,
        p_value: 1e-9,
        excess_removed: 0.876,
        validation_gain: 10.0,
        probability: 0.987_65,
        size: 0.1234,
        parameters: BTreeMap::from([(format!("{effect}.a"), value)]),
        refused: refused.map(str::to_owned),
    }
}

fn missing() -> Missing {
    let oscillation = Some(Oscillation { sd: 0.002_345, hz: 6.048, time: 1.0 });
    Missing {
        verdict: Verdict::Named,
        named: vec!["cogging".to_owned()],
        remaining: Verdict::None,
        ranking: vec![ranked("quadratic_drag", Some("too small")), ranked("cogging", None)],
        unfitted: vec![Unfitted { effect: "iron_loss".to_owned(), delta_bic: -3.0 }],
        ladder: vec![step(None, 2.345_67), step(Some("cogging"), 1.234_56)],
        not_judged: Vec::new(),
        load: Some(RandomLoad { sd: 0.001_234, time: 0.056, oscillation }),
        learned: Some(LearnedCurve {
            balance: drivescope_discovery::Balance::Torque,
            over: "theta",
            times: None,
            knots: vec![0.0, 0.123_45],
            over_unit: "rad".to_owned(),
            values: vec![0.0, -0.004_321],
            unit: "N m".to_owned(),
            formula: None,
            excess_removed: 0.432,
        }),
        formulas: Vec::new(),
        closer_than: None,
        next_experiment: None,
        not_shown: vec![("brush_drop".to_owned(), "the drive stands still".to_owned())],
        unusable: Vec::new(),
        typed: Vec::new(),
        values: vec![("cogging".to_owned(), "a = 0.01 N m, N = 7".to_owned())],
        motion: Motion::Rotary,
        added: false,
    }
}

fn steps() -> Vec<Step> {
    missing().ladder.iter().map(Step::from).collect()
}

#[test]
fn text_page_and_report_tell_the_same_numbers() {
    let blocks = missing().blocks(&sample().curves);
    holds(&blocks, &in_report(&blocks));
    holds(&blocks, &on_page(&blocks));
    let said = text(&blocks);
    let wanted = "missing: cogging (not told from torque_ripple by these recordings)";
    assert!(said.contains(wanted), "{said}");
    assert!(in_report(&blocks).contains(&wanted[1..]) && on_page(&blocks).contains(&wanted[1..]));
    for number in ["0.9877", "12.3 %", "87.6 %", "6.05 Hz", "1.605 times its floor", "43 %"] {
        assert!(said.contains(number), "{number} is not in: {said}");
    }
    assert!(said.contains("iron_loss: weighed, and promised too little"), "{said}");
    assert!(on_page(&blocks).contains("promised too little"));
    let (first, second) = (said.find("cogging  "), said.find("quadratic_drag  "));
    assert!(first < second, "what is named stands first: {said}");
}

#[test]
fn the_ladder_is_the_same_everywhere() {
    let blocks = ladder(Motion::Rotary, &steps());
    holds(&blocks, &in_report(&blocks));
    for stated in [text(&blocks), on_page(&blocks), in_report(&blocks)] {
        for words in ["+ cogging", "2.346", "1.235", "1.605"] {
            assert!(stated.contains(words), "{words} is not in: {stated}");
        }
    }
    assert!(text(&blocks).contains("6.9 %") && !on_page(&blocks).contains("6.9 %"));
}

/// Far above the noise its unit says nothing, and the page shows errors all the same: it has no room
/// for what is unexplained.
#[test]
fn far_from_the_noise_the_unexplained_is_told() {
    let far: Vec<Step> = [step(None, 2000.0)].iter().map(Step::from).collect();
    let blocks: Vec<Block> = ladder(Motion::Rotary, &far);
    assert!(!text(&blocks).contains("2600") && !in_report(&blocks).contains("2600"));
    assert!(on_page(&blocks).contains("2600") && text(&blocks).contains("97.34 %"));
}
