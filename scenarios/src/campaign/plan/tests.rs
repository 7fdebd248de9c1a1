//! Plans that are read, and those that are refused with their place.

use std::path::Path;

use drivescope_plant::fault::Mechanism;

use super::*;

const QUICK: &str = include_str!("../../../plans/quick.toml");

fn plan(text: &str) -> Plan {
    read(text).unwrap_or_else(|error| panic!("{error}\n{text}"))
}

fn read(text: &str) -> Result<Plan, PlanError> {
    Plan::parse(text, "plan.toml", Path::new(""))
}

#[test]
fn the_shipped_plan_is_right_and_spans_its_grid() {
    let plan = plan(QUICK);
    assert_eq!(plan.scenarios(), 240);
    let kinds = ["tacho", "flux", "actuator", "load"].map(|id| Mechanism::find(id).expect("known"));
    for k in 0..24 {
        for draw in 0..10 {
            let scenario = plan.scenario(k + 24 * draw);
            if let Some(fault) = scenario.faults[0] {
                assert_eq!(fault.mechanism, kinds[(k % 4) as usize]);
                let size = 0.01 * 20f64.powf((k / 4) as f64 / 5.0);
                assert!((fault.size.abs() / size - 1.0).abs() < 1e-12);
                assert!((2400..3600).contains(&fault.from) && fault.until == fault.from + 1000);
            }
        }
    }
    let healthy = (0..240).filter(|k| plan.scenario(*k).faults[0].is_none()).count();
    assert!((10..45).contains(&healthy), "{healthy} of 240 with a probability of 0.1");
}

#[test]
fn a_scenario_is_a_function_of_seed_and_number() {
    let plan = plan(QUICK);
    assert_eq!(plan.scenario(17), plan.scenario(17));
    assert_ne!(plan.scenario(17), plan.scenario(17 + 24));
    let more = read(&QUICK.replace("draws = 10 ", "draws = 11 ")).expect("right");
    assert_eq!(more.scenario(17), plan.scenario(17), "more draws change none");
    let other = read(&QUICK.replace("seed = 1", "seed = 2")).expect("right");
    assert_ne!(other.scenario(17), plan.scenario(17));
    // What drives the comments is nobody's business.
    let same = read(&QUICK.replace("# s", "# seconds")).expect("right");
    assert_eq!(same.digest, plan.digest);
    assert_ne!(other.digest, plan.digest);
}

#[test]
fn distributions_are_what_they_say() {
    let of = |law: &str| {
        let text = format!(
            "schema = 1\ndrive = \"dr300\"\ndraws = 20000\nduration = 10\n[parameters]\nR = {law}\n"
        );
        let plan = plan(&text);
        let mut drawn: Vec<f64> = (0..20_000).map(|k| plan.scenario(k).parameters[0]).collect();
        drawn.sort_by(f64::total_cmp);
        drawn
    };
    let median = |drawn: &[f64]| drawn[drawn.len() / 2];
    let uniform = of("{ uniform = [2, 4] }");
    assert!(uniform[0] >= 2.0 && uniform[19_999] < 4.0 && (median(&uniform) - 3.0).abs() < 0.03);
    let log_uniform = of("{ log_uniform = [1, 100] }");
    assert!((median(&log_uniform) / 10.0 - 1.0).abs() < 0.07, "{}", median(&log_uniform));
    let normal = of("{ normal = [1, 0.1], relative = true }");
    assert!((median(&normal) / 3.13 - 1.0).abs() < 0.005);
    assert!((normal[16_827] / normal[10_000] - 1.1).abs() < 0.01, "one standard deviation");
    // Cut off where a resistance ends.
    assert!(of("{ normal = [0.5, 1] }")[0] > 0.0);
    let choice = of("{ choice = [1, 2] }");
    assert!(choice.iter().all(|it| *it == 1.0 || *it == 2.0));
    let count = choice.iter().filter(|it| **it == 1.0).count();
    assert!((9700..10_300).contains(&count), "{count}");
}

#[test]
fn chosen_traces_are_their_share() {
    let plan = plan(&QUICK.replace("keep_traces = 0.01", "keep_traces = 0.25"));
    let kept = (0..4000).filter(|k| plan.keeps_trace(*k)).count();
    assert!((880..1120).contains(&kept), "{kept} of 4000");
}

#[test]
fn what_is_wrong_is_said_with_its_place() {
    for (from, to, place, said) in [
        ("schema = 1", "schema = 2", "3:10", "this program reads 1"),
        ("drive = \"dr300\"", "drive = \"dr3000\"", "5:9", "neither a file beside the plan"),
        ("drive = \"dr300\"", "drive = \"emps\"", "5:9", "speed control"),
        ("draws = 10 ", "draws = 0 ", "7:9", "1 or more"),
        ("draws = 10 ", "draws = 41666666667 ", "7:9", "1000000000008 scenarios"),
        ("duration = 25.0", "duration = \"long\"", "8:12", "expected f64"),
        ("duration = 25.0", "duration = 1e9", "8:12", "samples"),
        ("keep_traces = 0.01", "keep_traces = 2", "9:15", "a share from 0 to 1"),
        ("seed = 1\n", "seeds = 1\n", "6:1", "unknown field `seeds`"),
        ("R = {", "r = {", "12:1", "did you mean `R`?"),
        ("[1.0, 0.005]", "[-1.0, 0.005]", "12:5", "a finite number above 0"),
        ("[1.0, 0.005]", "[1.0, 0]", "12:5", "a deviation above 0"),
        ("[\"tacho\", \"flux\"", "[\"tacko\", \"flux\"", "16:8", "there is no fault `tacko`"),
        ("grid = [\"tacho\", \"flux\", \"actuator\", \"load\"]", "grid = []", "16:8", "empty"),
        ("from = 0.01", "from = 0.3", "17:8", "from 0.3 to 0.2 is empty"),
        ("steps = 6", "steps = 1", "17:8", "`steps` = 1"),
        ("steps = 6", "stepz = 6", "17:33", "unknown field `stepz`"),
        ("to = 0.2", "to = 2.0", "17:8", "everything cannot be lost"),
        ("[12.0, 18.0]", "[18.0, 12.0]", "18:9", "from 18 to 12 is empty"),
        ("[12.0, 18.0]", "[2.0, 18.0]", "18:9", "may begin at 2 s, within the first 5 s"),
        ("duration = 5.0", "duration = 8.0", "19:12", "may end at 26 s, after the run of 25 s"),
        ("duration = 5.0", "duration = 0", "19:12", "a time above 0 s"),
        ("\"ramp=2\"", "\"ramp\"", "20:11", "a time above 0 s"),
        ("probability = 0.9", "probability = -1", "21:15", "a share from 0 to 1"),
        ("\"cusum\"]", "\"glr\"]", "24:33", "there is no method `glr`"),
        ("\"cusum\"]", "\"bank\"]\nrun_up = 0.4", "24:33", "set detector.run_up = 0.5 or more"),
        ("beta = 0.05", "beta = 1.5", "25:8", "a share between 0 and 1"),
        ("arl_0 = 1e5", "arl_0 = { uniform = [1, 5] }", "27:9", "10 to 1e12"),
    ] {
        let text = QUICK.replacen(from, to, 1);
        assert_ne!(text, QUICK, "{from}");
        let error = read(&text).expect_err(to).to_string();
        assert!(error.starts_with(&format!("plan.toml:{place}: ")), "{to}: {error}");
        assert!(error.contains(said), "{to}: {error}");
    }
    let seeds = format!("{QUICK}[design]\nseed = 1\n");
    let error = read(&seeds).expect_err("one seed for both").to_string();
    assert!(error.starts_with("plan.toml:29:8: `design.seed` is that of the plan"), "{error}");
}

#[test]
fn the_schema_tells_all_keys() {
    let schema = schema_json();
    for key in ["keep_traces", "log_uniform", "either_sign", "probability", "arl_0", "run_up"] {
        assert!(schema.contains(&format!("\"{key}\"")), "{key}");
    }
    assert!(!schema.contains("null"), "TOML has no null");
}

#[test]
fn a_bank_needs_a_drive_that_it_has_a_filter_for() {
    let folder = tempfile::tempdir().expect("a folder");
    let held_back = "\n[[effect]]\nkind = \"delay\"\ntau = 0.002\n";
    let drive = crate::drives::built_in("dr300").expect("it is there").expect("it is right");
    std::fs::write(folder.path().join("late.toml"), drive.to_toml() + held_back).expect("room");
    let text = QUICK.replace("\"dr300\"", "\"late.toml\"");
    assert!(Plan::parse(&text, "plan.toml", folder.path()).is_ok());
    let text = text.replace("\"cusum\"]", "\"bank\"]");
    let error = Plan::parse(&text, "plan.toml", folder.path()).expect_err("a delay").to_string();
    assert!(error.starts_with("plan.toml:24:33: `detector.methods`: the bank has no"), "{error}");
    assert!(error.ends_with("or leave `bank` out"), "{error}");
}
