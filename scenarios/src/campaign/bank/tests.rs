//! The bank of a campaign: what it finds, that it says what it did not judge, and that it is the bank
//! that watches a recording.

use std::path::Path;
use std::sync::LazyLock;

use drivescope_diagnoser::bank::Event;
use drivescope_recording::dataset::Values;

use super::*;
use crate::campaign::{Campaign, Design, Rows};
use crate::seen::rows as rows_of;

/// Faults of ten per cent from 6 s on, and health; machines that differ.
const PLAN: &str = "schema = 1\ndrive = \"dr300\"\ndraws = 6\nduration = 9\nseed = 11\n\
    [parameters]\nR = { normal = [1, 0.02], relative = true }\n\
    B_m = { normal = [1, 0.05], relative = true }\n\
    [[fault]]\nkind = { grid = [\"tacho\", \"actuator\", \"current_sensor\", \"none\"] }\n\
    size = { grid = [0.1], either_sign = true }\nonset = { uniform = [6, 6.5] }\n\
    [detector]\nmethods = [\"bank\", \"bands\"]\narl_0 = 1e6\n[design]\nsamples = 20000\n";

/// The same with the bank that was designed for it.
static DESIGNED: LazyLock<Design> = LazyLock::new(|| Design::new(&plan(PLAN)).expect("it suits"));

fn plan(text: &str) -> Plan {
    Plan::parse(text, "plan.toml", Path::new("")).expect("a right plan")
}

fn run(campaign: &Campaign) -> Rows {
    campaign.run(0..campaign.plan().scenarios(), &|_| false).expect("nobody stops it")
}

fn column<'a>(rows: &'a Rows, name: &str) -> &'a Values {
    let column = rows.columns.iter().find(|column| column.name == name);
    &column.unwrap_or_else(|| panic!("no column {name}")).values
}

fn texts<'a>(rows: &'a Rows, name: &str) -> &'a [String] {
    match column(rows, name) {
        Values::Texts(values) => values,
        other => panic!("{name}: {other:?}"),
    }
}

fn numbers<'a>(rows: &'a Rows, name: &str) -> &'a [f64] {
    match column(rows, name) {
        Values::Numbers(values) => values,
        other => panic!("{name}: {other:?}"),
    }
}

fn flags<'a>(rows: &'a Rows, name: &str) -> &'a [Option<bool>] {
    match column(rows, name) {
        Values::Flags(values) => values,
        other => panic!("{name}: {other:?}"),
    }
}

#[test]
fn faults_are_found_named_and_measured_and_health_raises_no_alarm() {
    let rows = run(&Campaign::new(plan(PLAN), DESIGNED.clone()));
    let (kinds, named) = (texts(&rows, "fault_kind"), texts(&rows, "bank_mechanism"));
    let (sizes, delays) = (numbers(&rows, "fault_size"), numbers(&rows, "bank_delay"));
    let (low, high) = (numbers(&rows, "bank_size_low"), numbers(&rows, "bank_size_high"));
    let mut held = 0;
    for k in 0..rows.len() {
        assert_eq!(texts(&rows, "bank_baseline")[k], "learned", "{k}");
        assert_eq!(numbers(&rows, "bank_false_alarms")[k], 0.0, "{k}");
        assert_eq!(named[k], kinds[k], "{k}");
        if kinds[k] == "none" {
            assert_eq!(flags(&rows, "bank_detected")[k], None);
            assert_eq!(flags(&rows, "bank_in_set")[k], None);
            assert_eq!(texts(&rows, "bank_set")[k], "none");
            continue;
        }
        assert_eq!(flags(&rows, "bank_in_set")[k], Some(true), "{k}");
        assert!(texts(&rows, "bank_set")[k].split(' ').any(|it| it == kinds[k]), "{k}");
        // Ten per cent are seen within a tenth of a second.
        assert!(delays[k] > 0.0 && delays[k] <= 0.1, "{k}: {}", delays[k]);
        assert!((numbers(&rows, "bank_size")[k] - sizes[k]).abs() < 0.02, "{k}");
        held += usize::from(low[k] <= sizes[k] && sizes[k] <= high[k]);
    }
    assert!(held >= 15, "{held} of 18 intervals of 95 % hold the size");
}

#[test]
fn rows_do_not_depend_on_how_the_work_is_split() {
    let campaign = Campaign::new(plan(PLAN), DESIGNED.clone());
    // Missing values are not equal to themselves.
    let text = |rows: &Rows| format!("{:?}", rows.columns);
    let whole = text(&run(&campaign));
    let mut joined = Rows::none(campaign.plan());
    for range in [0..1, 1..18, 18..24] {
        assert!(joined.append(campaign.run(range, &|_| false).expect("nobody stops it")));
    }
    assert_eq!(whole, text(&joined));
    let one = rayon::ThreadPoolBuilder::new().num_threads(1).build().expect("a thread");
    assert_eq!(whole, one.install(|| text(&run(&campaign))));
}

/// A bank that learns and watches the kept signals of a scenario by itself.
#[test]
fn a_row_says_what_the_bank_says_of_its_signals() {
    let campaign = Campaign::new(plan(PLAN), DESIGNED.clone());
    let rows = run(&campaign);
    let of_plan = campaign.design().bank.as_ref().expect("the plan has one");
    let bank = Bank::new(campaign.plan(), of_plan).expect("a process");
    let (run_up, horizon) = (campaign.plan().run_up, of_plan.horizon);
    assert_eq!((run_up, of_plan.baseline), (1000, 1000));
    for k in 0..rows.len() {
        let scenario = campaign.plan().scenario(k as u64);
        let signals = rows_of(&campaign.trace(k as u64).expect("a native drive"), bank.per_si);
        let limits = of_plan.tails.limits(scenario.settings.arl_0);
        let mut watch = bank.process.learn(&signals[..run_up], limits, horizon).expect("healthy");
        let alarms = signals[run_up..].iter().enumerate().filter_map(|(k, row)| {
            matches!(watch.step(row), Some(Event::Alarm(_))).then_some(run_up + k + 1)
        });
        let first =
            alarms.collect::<Vec<_>>().first().map_or(f64::NAN, |t_dt| *t_dt as f64 * 0.005);
        assert_eq!(numbers(&rows, "bank_detection_time")[k].to_bits(), first.to_bits(), "{k}");
    }
}

#[test]
fn a_machine_that_is_not_learned_is_told_and_not_counted() {
    let text = PLAN.replace("R = { normal = [1, 0.02]", "R = { choice = [1, 1.6]");
    let other = plan(&text);
    let design = Design { plan: other.digest.clone(), ..DESIGNED.clone() };
    let rows = run(&Campaign::new(other, design));
    let refused: Vec<usize> = (0..rows.len())
        .filter(|k| texts(&rows, "bank_baseline")[*k] == "out_of_tolerance")
        .collect();
    assert!((4..20).contains(&refused.len()), "{} of 24", refused.len());
    for k in 0..rows.len() {
        let is_refused = refused.contains(&k);
        assert_eq!(texts(&rows, "bank_mechanism")[k] == "not_learned", is_refused, "{k}");
        assert_eq!(numbers(&rows, "bank_false_alarms")[k].is_nan(), is_refused, "{k}");
        let is_faulty = texts(&rows, "fault_kind")[k] != "none";
        assert_eq!(flags(&rows, "bank_detected")[k].is_some(), is_faulty && !is_refused, "{k}");
        // Other methods judge it.
        assert_eq!(flags(&rows, "bands_detected")[k].is_some(), is_faulty, "{k}");
    }
}

#[test]
fn the_design_is_stored_and_is_there_only_where_it_is_asked_for() {
    let text = DESIGNED.to_toml().expect("text");
    assert!(Design::parse(&text).expect("the same") == *DESIGNED);
    let without = Design { bank: None, ..DESIGNED.clone() };
    let text = without.to_toml().expect("text");
    assert!(!text.contains("bank"), "{text}");
    assert_ne!(without.digest(), DESIGNED.digest());
}
