//! A study in every medium.

use drivescope_scenarios::results::{DetectorKind, StudyResults};
use drivescope_scenarios::trials::{Detectable, HiddenEffect, ModelRows};

use super::blocks;
use super::words::verdict;
use crate::answer::testing::{holds, in_report, on_page};
use crate::answer::text;
use crate::report::testing::{HOSTILE, pictures, study};

/// Columns of a plain terminal.
const WIDTH: usize = 80;

fn said(study: &StudyResults) -> String {
    text(&blocks(study, &[]))
}

fn hidden() -> HiddenEffect {
    let detectable = |mechanism: &str, size| Detectable {
        mechanism: mechanism.to_owned(),
        size,
        curve: vec![(0.002, 0.2), (0.6, 0.8)],
    };
    let rows = |size| ModelRows {
        torque_noise: 0.004,
        alarms: 2,
        samples: 300_000,
        arl_0_at_least: 5e4,
        learned: 15,
        mechanisms: vec![detectable("load", size), detectable("tacho", Some(0.002))],
    };
    HiddenEffect {
        effect: "quadratic_drag".to_owned(),
        arl_0: 1e5,
        machines: 200,
        before: rows(None),
        after: rows(Some(0.0421)),
    }
}

#[test]
fn text_page_and_report_tell_the_same_numbers() {
    let mut study = study();
    study.hidden_effect = Some(hidden());
    let blocks = blocks(&study, &pictures());
    holds(&blocks, &in_report(&blocks));
    holds(&blocks, &on_page(&blocks));
    let said = text(&blocks);
    for number in ["5.02", "21.4 rpm", "-12.0 to 11.6 rpm", "0.310", "90.0", "17.39", "0 (equal)"] {
        assert!(said.contains(number), "{number} is not in: {said}");
    }
}

#[test]
fn a_model_too_far_from_the_machine_judges_nothing_and_says_so() {
    let mut study = study();
    let mut hidden = hidden();
    hidden.before = ModelRows { learned: 0, samples: 0, alarms: 0, ..hidden.before };
    study.hidden_effect = Some(hidden);
    assert!(in_report(&blocks(&study, &[])).contains("none, for nothing is judged"));
}

#[test]
fn tables_fit_a_plain_terminal() {
    let mut found = study();
    found.hidden_effect = Some(hidden());
    for line in said(&found).lines().filter(|line| line.starts_with(' ')) {
        assert!(line.chars().count() <= WIDTH, "{line}");
    }
}

#[test]
fn ours_stand_beside_the_papers() {
    let mut found = study();
    found.detection[0].t_dt = None;
    found.detection[0].delay = None;
    found.detection[1].false_alarms = 1;
    let text = said(&found);
    let words = |start: &str| -> Vec<Vec<String>> {
        let rows = text.lines().filter(|line| line.trim_start().starts_with(start));
        rows.map(|row| row.split_whitespace().map(str::to_owned).collect()).collect()
    };
    let five = words("tacho +5 %");
    assert_eq!(five[0][3..], ["f_1^1", "99.9", "97.9", "none", "4074", "-", "74"]);
    assert_eq!(five[1][3..], ["f_1^1", "99.3", "98.1", "4054", "4072", "54", "72"]);
    assert_eq!(five[2][3..], ["f_1^1", "9.00", "2.45"]);
    assert_eq!(words("tacho -5 %")[0][6..], ["(4056)", "4055", "-", "55"]);
    assert_eq!(words("flux -5 %")[1][6..], ["4055", "(3132)", "55", "-"]);
    assert!(text.contains("Table 1, model error modelling\n"), "{text}");
    assert!(text.contains("10 of 12 faults detected by model error modelling, 0 false alarms"));
}

/// The last line is read first.
#[test]
fn a_text_ends_in_the_verdicts_and_a_report_begins_with_one() {
    let blocks = blocks(&study(), &[]);
    let last = verdict(&study(), DetectorKind::ALL[DetectorKind::ALL.len() - 1]);
    assert!(text(&blocks).ends_with(&format!("\n{last}\n")));
    assert!(in_report(&blocks).trim_start().starts_with(&verdict(&study(), DetectorKind::Mem)));
}

#[test]
fn the_verdict_counts_what_was_declared_in_time() {
    let mut found = study();
    let line = "12 of 12 faults detected by model error modelling, 0 false alarms in 90000 \
                healthy samples";
    assert_eq!(verdict(&found, DetectorKind::Mem), line);
    let missed = found.detection.iter_mut().find(|row| row.method == DetectorKind::Mem).unwrap();
    missed.false_alarms = 1;
    *found.healthy.alarms.get_mut(DetectorKind::Mem) = 1;
    let line = "11 of 12 faults detected by model error modelling, 1 false alarm in 90000 \
                healthy samples, 1 declaration before a fault began";
    assert_eq!(verdict(&found, DetectorKind::Mem), line);
}

#[test]
fn a_level_that_is_no_whole_per_cent_is_told_alike_everywhere() {
    let mut found = study();
    found.beta = 0.025;
    let report = in_report(&blocks(&found, &pictures()));
    assert!(report.contains("designed 2.5 %") && report.contains("beta = 2.5 %"), "{report}");
    assert!(!report.contains("designed 2 %") && !report.contains("designed 3 %"));
    assert!(said(&found).contains("2.5"));
}

#[test]
fn sizes_before_and_after_stand_side_by_side() {
    let mut study = study();
    assert!(!said(&study).contains("hidden"));
    assert!(!in_report(&blocks(&study, &[])).contains("Hidden effect"));
    study.hidden_effect = Some(hidden());
    let blocks = blocks(&study, &[]);
    for stated in [text(&blocks), in_report(&blocks)] {
        assert!(stated.contains("quadratic drag hidden and added"), "{stated}");
        assert!(stated.contains("not up to 60") && stated.contains("4.21"), "{stated}");
        assert!(stated.contains("0.20 or less") && !stated.contains("4.21 or"), "{stated}");
    }
}

#[test]
fn a_name_does_not_steer_the_terminal() {
    let mut found = study();
    assert!(said(&found).starts_with(&format!("Drive: {HOSTILE}\n")));
    found.drive.name = "a\u{1b}[2Jb\n".into();
    assert!(said(&found).starts_with("Drive: a?[2Jb?\n"));
}
