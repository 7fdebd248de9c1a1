//! A diagnoser that holds a drive: what failed is named with size, onset and end, without a faulty
//! recording having been shown; live rows say the same; what makes no baseline is refused in words.

use std::io::Write as _;
use std::path::Path;
use std::process::Stdio;

use serde_json::Value;

use crate::{done, folder, program, put, refused, run};

/// Two healthy recordings of the laboratory rig.
pub(crate) fn simulated(here: &Path, name: &str, seed: u32, more: &[&str]) {
    let seed = seed.to_string();
    let usual = ["simulate", "dr300", "-o", name, "--seed", &seed, "--quiet"];
    done(here, &[&usual[..], more].concat());
}

const AT_2000: [&str; 4] = ["--reference", "2000 [rpm]", "--duration", "20"];

/// Trains on them; the answer.
pub(crate) fn trained(here: &Path) -> Value {
    for seed in [1, 2] {
        simulated(here, &format!("h{seed}.csv"), seed, &AT_2000);
    }
    let train = ["train", "h1.csv", "h2.csv", "--drive", "dr300", "-o", "rig.toml", "--json", "-"];
    let quick = ["--without", "recurrent,gmdh", "--verify", "100000", "--quiet"];
    done(here, &[&train[..], &quick].concat()).json()
}

fn diagnosed(here: &Path, more: &[&str]) -> Value {
    let usual = ["diagnose", "rig.toml", "--json", "-", "--quiet"];
    done(here, &[&usual[..], more].concat()).json()
}

pub(crate) fn live(here: &Path, file: &str) -> Vec<Value> {
    let mut program = program(here)
        .args(["diagnose", "rig.toml", "-", "--json", "-", "--quiet"])
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::null())
        .spawn()
        .expect("it starts");
    let rows = std::fs::read(here.join(file)).expect("written before");
    let mut input = program.stdin.take().expect("piped");
    input.write_all(&rows).expect("it reads");
    drop(input);
    let out = program.wait_with_output().expect("it ends").stdout;
    let text = String::from_utf8(out).expect("text");
    text.lines().map(|line| serde_json::from_str(line).expect("a line of JSON")).collect()
}

#[test]
fn faults_are_named_with_size_and_time_live_or_not() {
    let here = folder();
    let here = here.path();
    let answer = trained(here);
    let bank = &answer["bank"];
    // The drive file says 0.3142 rad/s and a quantum of 0.2094 rad/s beside it, 10 mA, 1 mN m.
    for (name, low, high) in [("omega", 0.25, 0.4), ("i", 0.009, 0.011), ("torque", 7e-4, 1.4e-3)] {
        let sd = bank["noise"][name].as_f64().expect("a number");
        assert!((low..high).contains(&sd), "{name}: {sd}");
    }
    assert_eq!(bank["verified"]["recorded_alarms"], 0, "{bank}");
    let confusions = bank["confusions"].as_array().expect("a list");
    let of = |id: &str| confusions.iter().find(|it| it["mechanism"] == id).expect("it is one");
    let has =
        |list: &Value, id: &str| list.as_array().is_some_and(|list| list.iter().any(|it| it == id));
    assert!(has(&of("supply")["set"], "actuator"), "{bank}");
    // A bias is no gain at another speed; the supply acts as the amplifier does at any.
    assert!(has(&of("tacho")["set"], "tacho_bias"), "{bank}");
    let separable = &of("tacho")["separable"];
    let other =
        separable.as_array().and_then(|all| all.iter().find(|it| it["mechanism"] == "tacho_bias"));
    let speed = other.and_then(|it| it["speed"].as_f64()).expect("another speed tells them apart");
    assert!(!(200.0..220.0).contains(&speed), "{speed}");
    let never = of("supply")["separable"].as_array().expect("a list");
    assert!(never.iter().all(|it| it["mechanism"] != "actuator"), "{bank}");
    // Without a current nobody knows whether the motor or what it drives has changed.
    let blind = &of("resistance")["set_without_current"];
    assert!(blind.as_array().is_some_and(|set| !set.is_empty()), "{bank}");

    for (kind, size, seed) in
        [("tacho", 0.05, 11), ("flux", -0.1, 12), ("actuator", 0.1, 13), ("resistance", 0.2, 14)]
    {
        let fault = format!("{kind}={}%@8..10", 100.0 * size);
        let fault = ["--duration", "12", "--reference", "2000 [rpm]", "--fault", &fault];
        simulated(here, "ill.csv", seed, &fault);
        let answer = diagnosed(here, &["ill.csv"]);
        assert_eq!((&answer["verdict"], &answer["method"]), (&"fault".into(), &"bank".into()));
        let declared = &answer["declarations"][0];
        assert_eq!(declared["mechanism"], kind, "{declared}");
        assert!(has(&declared["set"], kind), "{declared}");
        let number = |value: &Value| value.as_f64().expect("a number");
        assert!((number(&declared["from"]) - 8.0).abs() < 0.05, "{declared}");
        assert!((number(&declared["to"]) - 10.0).abs() < 0.05, "{declared}");
        let [low, high] = [0, 1].map(|k| number(&declared["interval"][k]));
        // Twice the width of the 95 % interval: one in twenty would miss a single one.
        assert!((number(&declared["size"]) - size).abs() < high - low, "{declared}");
        assert!(number(&declared["noticed"]) < 8.3, "{declared}");
        assert_eq!(run(here, &["diagnose", "rig.toml", "ill.csv", "--check"]).code, Some(1));
        let lines = live(here, "ill.csv");
        let last = lines.last().expect("the answer");
        assert_eq!(last["declarations"], answer["declarations"]);
        assert_eq!(last["methods"], answer["methods"]);
        let judged = lines.iter().find(|line| line["decision"] == "judged").expect("it is said");
        assert_eq!((&judged["mechanism"], &judged["size"]), (&kind.into(), &declared["size"]));
        assert_eq!(lines[0]["decision"], "alarm");
    }

    // What grows by 2 % a second began long before it is noticed. Its first set holds it, and the rows
    // that follow tell it from the rest.
    for (kind, rate, seed) in [("flux", -0.02, 34), ("actuator", 0.02, 33), ("tacho", 0.02, 36)] {
        let fault = format!("{kind}={}%@8:ramp=10", 1000.0 * rate);
        let fault = ["--duration", "12", "--reference", "2000 [rpm]", "--fault", &fault];
        simulated(here, "grows.csv", seed, &fault);
        let lines = live(here, "grows.csv");
        let judged: Vec<&Value> = lines.iter().filter(|it| it["decision"] == "judged").collect();
        assert!(has(&judged[0]["set"], kind), "{}", judged[0]);
        let last = judged[judged.len() - 1];
        assert_eq!(last["mechanism"], kind, "{last}");
        let number = |value: &Value| value.as_f64().expect("a number");
        assert!((number(&last["from"]) - 8.0).abs() < 0.2, "{last}");
        // The size is that of the moment, within the width of its interval.
        let size = rate * (number(&last["time"]) - 8.0);
        let [low, high] = [0, 1].map(|k| number(&last["interval"][k]));
        assert!((number(&last["size"]) - size).abs() < high - low, "{last} against {size}");
        assert_eq!(
            diagnosed(here, &["grows.csv"])["declarations"],
            lines[lines.len() - 1]["declarations"]
        );
    }

    // Another set point, steps and a reversal, which no recording of the training had.
    let steps = "1200 * sign(sin(0.8 * t)) [rpm]";
    for (seed, reference) in [(21, "1000 [rpm]"), (22, "2000 * cos(0.5 * t) [rpm]"), (23, steps)] {
        simulated(here, "well.csv", seed, &["--duration", "12", "--reference", reference]);
        let answer = diagnosed(here, &["well.csv", "--baseline", "h1.csv"]);
        assert_eq!(answer["verdict"], "healthy", "{reference}: {}", answer["declarations"]);
        let share = answer["share_outside"].as_f64().expect("a number");
        assert!((share - 0.05).abs() < 0.02, "{share}");
        assert!(answer["baseline"]["machine"]["resistance"].as_f64().is_some(), "{answer}");
    }
}

#[test]
fn what_makes_no_baseline_is_said() {
    let here = folder();
    let here = here.path();
    trained(here);
    let short = ["--duration", "0.4", "--reference", "2000 [rpm]"];
    simulated(here, "short.csv", 3, &short);
    let rest = ["--duration", "6", "--reference", "0 [rpm]"];
    simulated(here, "rest.csv", 4, &rest);
    let ill = ["--duration", "8", "--reference", "2000 [rpm]", "--fault", "load=30%@4"];
    simulated(here, "ill.csv", 5, &ill);
    let well = ["--duration", "8", "--reference", "2000 [rpm]"];
    simulated(here, "well.csv", 6, &well);
    let other = std::fs::read_to_string(
        Path::new(env!("CARGO_MANIFEST_DIR")).join("scenarios/drives/dr300.toml"),
    );
    let other = other.expect("it ships").replace("R = 3.13 ", "R = 6.26 ");
    put(here, "other.toml", other);
    let usual = ["simulate", "other.toml", "-o", "other.csv", "--quiet"];
    done(here, &[&usual[..], &well].concat());
    for (baseline, said) in [
        ("short.csv", "samples"),
        ("rest.csv", "at rest"),
        ("ill.csv", "baseline"),
        ("other.csv", "another drive or a fault"),
    ] {
        let asked = ["diagnose", "rig.toml", "well.csv", "--baseline", baseline];
        let message = refused(here, &asked);
        assert!(message.contains(said) && message.contains(baseline), "{said}: {message}");
    }
    // Its own first seconds are no baseline: nothing is made up.
    let answer = diagnosed(here, &["other.csv"]);
    assert_eq!(answer["verdict"], "not_judged", "{answer}");
    assert!(answer["why"].as_str().is_some_and(|why| why.contains("another drive")), "{answer}");
    assert_eq!(answer["declarations"], serde_json::json!([]));
    let message =
        refused(here, &["train", "well.csv", "--drive", "dr300", "--arl0", "1", "-o", "x"]);
    assert!(message.contains("--arl0 1"), "{message}");
    // A drive that is not that of the recordings.
    let asked = ["train", "other.csv", "well.csv", "--drive", "dr300", "-o", "x.toml"];
    let message = refused(here, &asked);
    assert!(message.contains("fit"), "{message}");
}
