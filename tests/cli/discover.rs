//! `discover` and `add`: a hidden effect is named, added, and the error falls to the noise floor,
//! from recordings through to the exported FMU; and nothing or "unknown" is answered where due.

use std::path::Path;

use serde_json::Value;

use crate::{column, done, folder, put, refused};

const INPUT: &str = "10 * sin(2 * t) + 6 * sin(7 * t) + 5 * sign(sin(11 * t))";
const OTHER: &str = "9 * sin(1.7 * t) + 7 * sign(sin(9 * t)) + 3 * sin(23 * t)";

/// DR300 without the ripples of its load, and with what is hidden.
fn truth(folder: &Path, hidden: &str) {
    let text = include_str!("../../scenarios/drives/dr300.toml");
    let text = text.replace("torque = 1.0e-3", "").replace("torque_time = 0.05", "");
    let text: String = text
        .lines()
        .filter(|line| !line.contains("noise.torque"))
        .flat_map(|line| [line, "\n"])
        .collect();
    put(
        folder,
        "truth.toml",
        format!("{}\n{hidden}\n", text.replace("K_m = 0.06 ", "K_m = 0.0599 ")),
    );
    let base = include_str!("../../scenarios/drives/dr300.toml");
    let base = base.replace("R = 3.13 ", "R = 3.5 ").replace("J = 8.2e-5 ", "J = 7.3e-5 ");
    put(folder, "base.toml", base.replace("# ohm", "# ohm, from the plate"));
}

fn record(folder: &Path, name: &str, input: &str, seed: &str) {
    let run = ["simulate", "truth.toml", "--input", input, "-o", name, "--seed", seed];
    done(folder, &[&run[..], &["--period", "0.001", "--duration", "5"]].concat());
}

/// Two recordings, `one.csv` and `two.csv`, of the machine in which that is hidden.
fn recorded(folder: &Path, hidden: &str) {
    truth(folder, hidden);
    record(folder, "one.csv", INPUT, "3");
    record(folder, "two.csv", OTHER, "4");
}

/// The answer of a discovery where that is hidden.
fn discovered(folder: &Path, hidden: &str) -> Value {
    recorded(folder, hidden);
    let run = ["discover", "base.toml", "one.csv", "--validate", "two.csv", "-o", "found.toml"];
    let ran = done(folder, &[&run[..], &["--json", "-"]].concat());
    let answer = ran.json();
    // Each step is said as it comes, by the number that it has in the ladder.
    for step in 0..answer["ladder"].as_array().map_or(0, Vec::len) {
        let said = ran.err.lines().any(|line| line.starts_with(&format!("{step}: ")));
        assert!(said, "{step}: {}", ran.err);
    }
    answer
}

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("{value} is no number"))
}

/// Share of the error above the floor that a learned curve may leave: its 17 knots are farther
/// apart than the bump is wide.
const LEFT_BY_A_CURVE: f64 = 0.4;
/// Largest error after the loop, over the noise floor.
const FLOOR: f64 = 1.05;

#[test]
fn hidden_effects_are_named_and_the_error_falls_to_the_floor() {
    for (kind, law) in [
        ("cogging", "N = 6\na = 0.003\nb = 0.002"),
        ("quadratic_drag", "c = 4e-7"),
        ("saturation", "c = 0.02"),
        ("asymmetric_friction", "dT_c = 0.003\ndB_m = 2e-5"),
        ("winding_heating", "alpha = 0.0039\nR_th = 4\nC_th = 0.4"),
    ] {
        let here = folder();
        let here = here.path();
        let answer = discovered(here, &format!("[[effect]]\nkind = \"{kind}\"\n{law}"));
        assert_eq!(answer["verdict"], "named", "{kind}: {answer}");
        assert_eq!(answer["named"], serde_json::json!([kind]), "{answer}");
        for (key, most) in [("error", FLOOR), ("validation_error", FLOOR)] {
            let (before, after) = (number(&answer["before"][key]), number(&answer["after"][key]));
            assert!(after < most && after < before, "{kind}, {key}: {before} to {after}");
        }
        assert_eq!(answer["ladder"].as_array().map(Vec::len), Some(2), "{answer}");
        if kind == "asymmetric_friction" {
            let share = |when: &str, of: &str| number(&answer[when][of]["torque"]["share"]);
            for of in ["unexplained", "validation_unexplained"] {
                let (before, after) = (share("before", of), share("after", of));
                assert!(after < 0.9 * before && after > 0.0, "{of}: {before} to {after}");
                assert_eq!(answer["ladder"][1][of], answer["after"][of], "{answer}");
            }
            let fit = |when: &str, of: &str| number(&answer[when][of]["omega"]);
            for of in ["fit_percent", "validation_fit_percent"] {
                let (before, after) = (fit("before", of), fit("after", of));
                assert!(before < after && after > 99.0, "{of}: {before} to {after}");
                assert_eq!(answer["ladder"][1][of], answer["after"][of], "{answer}");
            }
        }
        let text = std::fs::read_to_string(here.join("found.toml")).expect("it was written");
        assert!(text.contains(kind) && text.contains("# ohm, from the plate"), "{text}");
    }
}

/// Native and exported, the drive file runs the same under the same u.
fn assert_runs_as_an_fmu(here: &Path, drive: &str) {
    let quiet = ["--noise", "off", "--duration", "2", "--period", "0.001"];
    let native = ["simulate", drive, "--input", OTHER, "-o", "native.csv"];
    done(here, &[&native[..], &quiet].concat());
    done(here, &["export", drive, "-o", "found.fmu", "--open-loop", "--quiet"]);
    let run =
        ["fmu", "run", "found.fmu", "--input", "native.csv", "--stop", "2", "--step", "0.001"];
    done(here, &[&run[..], &["-o", "fmu.csv"]].concat());
    let [a, b] = ["native.csv", "fmu.csv"].map(|name| column(here, name, "omega [rad/s]"));
    let largest = a.iter().fold(0.0_f64, |most, y| most.max(y.abs()));
    let worst = a.iter().zip(&b).fold(0.0_f64, |worst, (a, b)| worst.max((a - b).abs()));
    assert!(largest > 20.0 && worst < 1e-9 * largest, "{worst} of {largest}");
}

#[test]
fn what_was_found_runs_as_an_fmu_and_needs_nothing_more() {
    let here = folder();
    let here = here.path();
    discovered(here, "[[effect]]\nkind = \"quadratic_drag\"\nc = 4e-7");
    let again = ["discover", "found.toml", "one.csv", "--validate", "two.csv", "--json", "-"];
    let again = done(here, &again).json();
    assert_eq!((&again["verdict"], &again["output"]), (&"none".into(), &Value::Null), "{again}");
    assert_runs_as_an_fmu(here, "found.toml");
}

#[test]
fn nothing_hidden_is_none_and_something_strange_is_unknown() {
    let here = folder();
    let answer = discovered(here.path(), "");
    assert_eq!((&answer["verdict"], &answer["remaining"]), (&"none".into(), &"none".into()));
    assert_eq!(answer["formulas"], serde_json::json!([]), "{answer}");
    assert_eq!(answer["named"], serde_json::json!([]), "{answer}");
    let here = folder();
    // A brush that chatters around one speed.
    let bump = "[[effect]]\nkind = \"custom\"\ntorque = \"-h * sign(omega) * exp(-((abs(omega) - \
                60) / 12)^2)\"\nparameters = { h = 0.008 }";
    let here = here.path();
    let answer = discovered(here, bump);
    assert_eq!(answer["verdict"], "unknown", "{answer}");
    assert_eq!(answer["named"], serde_json::json!([]), "{answer}");
    assert_eq!(answer["where"][0]["variable"], "omega", "{answer}");
    // The curve is shown with a formula, and it can be added like any effect.
    let learned = &answer["learned"];
    assert_eq!((&learned["balance"], &learned["over"]), (&"torque".into(), &"omega".into()));
    assert!(learned["formula"].as_str().is_some_and(|it| it.contains("omega")), "{learned}");
    let add = ["add", "base.toml", "learned", "one.csv", "--validate", "two.csv"];
    let added = done(here, &[&add[..], &["-o", "added.toml", "--json", "-"]].concat()).json();
    for key in ["error", "validation_error"] {
        let (before, after) = (number(&added["before"][key]), number(&added["after"][key]));
        let remainder = (after - 1.0) / (before - 1.0);
        assert!(remainder < LEFT_BY_A_CURVE, "{key}: {before} to {after}");
    }
    assert_runs_as_an_fmu(here, "added.toml");
    // So can the most probable of the formulas.
    let best = &answer["formulas"][0];
    assert!(best["probability"].as_f64().is_some_and(|it| it > 0.3), "{best}");
    let parameters = best["parameters"].as_object().expect("it has some").iter();
    let shape: Vec<String> = parameters
        .filter(|(name, _)| !["c", "d"].contains(&name.as_str()))
        .map(|(name, value)| format!("{name} = {value}"))
        .collect();
    let text = best["torque"].as_str().expect("it is a torque");
    let formula = format!("formula:torque = {text}; {}", shape.join(", "));
    let add = ["add", "base.toml", &formula, "one.csv", "--validate", "two.csv"];
    let added = done(here, &[&add[..], &["-o", "formula.toml", "--json", "-"]].concat()).json();
    assert_eq!(added["named"], serde_json::json!(["formula"]), "{added}");
    for key in ["error", "validation_error"] {
        let (before, after) = (number(&added["before"][key]), number(&added["after"][key]));
        let remainder = (after - 1.0) / (before - 1.0);
        assert!(remainder < LEFT_BY_A_CURVE, "{key}: {before} to {after} with {formula}");
    }
    assert_runs_as_an_fmu(here, "formula.toml");
}

#[test]
fn a_load_that_oscillates_is_no_effect_and_is_said_with_its_frequency() {
    let here = folder();
    let here = here.path();
    truth(here, "");
    for (name, input, seed) in [("one.csv", INPUT, "3"), ("two.csv", OTHER, "4")] {
        let run = ["simulate", "truth.toml", "--input", input, "-o", name, "--seed", seed];
        let load = ["--load", "0.004 * sin(38 * t)", "--period", "0.001", "--duration", "5"];
        done(here, &[&run[..], &load].concat());
        // What loads the shaft was not recorded.
        let text = std::fs::read_to_string(here.join(name)).expect("it was written");
        let columns = |line: &str| line.split(',').take(4).collect::<Vec<_>>().join(",");
        put(here, name, text.lines().map(|line| columns(line) + "\n").collect::<String>());
    }
    let run = ["discover", "base.toml", "one.csv", "--validate", "two.csv", "--json", "found.json"];
    let said = done(here, &run).out;
    assert!(said.contains(" times its floor, is taken for a random load of "), "{said}");
    assert!(said.contains(" s beside its oscillation\nthe load oscillates at 6.0"), "{said}");
    let answer = std::fs::read_to_string(here.join("found.json")).expect("it was written");
    let answer: Value = serde_json::from_str(&answer).expect("JSON");
    assert_eq!(answer["verdict"], "none", "{answer}");
    let load = &answer["load"];
    assert!(number(&load["sd"]) > 0.0 && number(&load["time"]) > 0.0, "{load}");
    let (hz, sd) = (number(&load["oscillation"]["hz"]), number(&load["oscillation"]["sd"]));
    assert!((hz - 38.0 / std::f64::consts::TAU).abs() < 0.1, "{hz} Hz");
    assert!((sd / (0.004 / 2.0_f64.sqrt()) - 1.0).abs() < 0.2, "{sd} N m");
}

#[test]
fn a_typed_law_is_ranked_and_only_what_is_named_gets_a_value() {
    let law = |c: &str| {
        format!(
            "[[effect]]\nkind = \"custom\"\nid = \"contact\" # an idea\n\
             voltage = \"-c * i * abs(i)\"\nparameters = {{ c = {c} }}\n"
        )
    };
    let here = folder();
    let here = here.path();
    recorded(here, &law("0.2"));
    let base = std::fs::read_to_string(here.join("base.toml")).expect("it is there");
    let other = "[[effect]]\nkind = \"custom\"\nid = \"swell\"\n\
                 torque = \"-w * sin(omega / 30)\"\nparameters = { w = 0 }\n";
    put(here, "ideas.toml", format!("{base}\n{other}\n{}", law("0")));
    let run = ["ideas.toml", "one.csv", "--validate", "two.csv", "-o", "found.toml"];
    let found = done(here, &[&["discover"][..], &run, &["--json", "-"]].concat()).json();
    assert_eq!(found["named"], serde_json::json!(["contact"]), "{found}");
    let text = std::fs::read_to_string(here.join("found.toml")).expect("it was written");
    assert!(text.contains("id = \"contact\" # an idea"), "{text}");
    assert!(text.contains("{ w = 0 }") && !text.contains("swell.w"), "{text}");
    assert!(text.contains("\"contact.c\" = ") || text.contains("contact.c = "), "{text}");
    assert_runs_as_an_fmu(here, "found.toml");
    let ran = done(here, &["add", "ideas.toml", "contact", "one.csv", "-o", "added.toml"]);
    assert!(ran.out.contains("added: contact"), "{}", ran.out);
    let error = refused(here, &["add", "ideas.toml", "custom", "one.csv", "-o", "no.toml"]);
    assert!(error.contains("type in the drive file"), "{error}");
    let error = refused(here, &["add", "found.toml", "contact", "one.csv", "-o", "no.toml"]);
    assert!(error.contains("not 0"), "{error}");
}

#[test]
fn a_typed_law_that_overflows_is_named_and_the_rest_goes_on() {
    let here = folder();
    let here = here.path();
    truth(here, "");
    record(here, "one.csv", INPUT, "3");
    let base = std::fs::read_to_string(here.join("base.toml")).expect("it is there");
    let with = |name: &str, c: &str| {
        let law =
            "[[effect]]\nkind = \"custom\"\nid = \"steep\"\ntorque = \"-c * exp(10 * omega)\"\n";
        put(here, name, format!("{base}\n{law}parameters = {{ c = {c} }}\n"));
    };
    with("in.toml", "1e-3");
    let error = refused(here, &["discover", "in.toml", "one.csv", "-o", "no.toml"]);
    assert!(error.contains("without the typed law steep it does not"), "{error}");
    assert!(!here.join("no.toml").exists());
    // As a candidate it is out, and the rest goes on.
    with("beside.toml", "0");
    let ran = done(here, &["discover", "beside.toml", "one.csv"]);
    let line = ran.out.lines().find(|line| line.trim_start().starts_with("steep: "));
    assert!(line.is_some_and(|line| line.contains("overflows on these recordings")), "{}", ran.out);
    assert!(ran.out.contains("nothing is missing"), "{}", ran.out);
    let error = refused(here, &["add", "beside.toml", "steep", "one.csv", "-o", "no.toml"]);
    assert!(error.contains("steep cannot be added: the model overflows with it"), "{error}");
}

#[test]
fn one_effect_is_added_or_refused_in_words() {
    let here = folder();
    let here = here.path();
    recorded(here, "[[effect]]\nkind = \"brush_drop\"\nV_b = 0.6\ni_b = 0.1");
    let add = |effect: &'static str| {
        ["add", "base.toml", effect, "one.csv", "--validate", "two.csv", "-o", "added.toml"]
    };
    let ran = done(here, &add("brush_drop"));
    assert!(
        ran.out.contains("+ brush_drop") && ran.out.contains("added: brush_drop"),
        "{}",
        ran.out
    );
    let text = std::fs::read_to_string(here.join("added.toml")).expect("it was written");
    assert!(text.contains("kind = \"brush_drop\""), "{text}");
    let other = ["add", "base.toml", "cheese", "one.csv", "-o", "no.toml"];
    let error = refused(here, &other);
    assert!(error.contains("cheese") && error.contains("cogging"), "{error}");
    let axis = ["add", "emps", "brush_drop", "one.csv", "-o", "no.toml"];
    assert!(!refused(here, &axis).is_empty());
}

#[test]
fn validation_data_of_another_machine_are_said() {
    let here = folder();
    let here = here.path();
    recorded(here, "");
    let text = std::fs::read_to_string(here.join("truth.toml")).expect("it was written");
    put(here, "truth.toml", text.replace("J = 8.2e-5", "J = 12.2e-5"));
    record(here, "strange.csv", OTHER, "5");
    let doubts = |validation| {
        let run = ["discover", "base.toml", "one.csv", "--validate", validation, "--json", "-"];
        let stated = done(here, &run).json();
        stated["doubts"]
            .as_array()
            .expect("a list")
            .iter()
            .map(Value::to_string)
            .collect::<String>()
    };
    assert!(!doubts("two.csv").contains("another machine"));
    let stated = doubts("strange.csv");
    assert!(stated.contains("another machine") && stated.contains("J "), "{stated}");
}

#[test]
fn the_report_shows_what_is_missing_and_how_the_error_fell() {
    let here = folder();
    let here = here.path();
    recorded(here, "[[effect]]\nkind = \"quadratic_drag\"\nc = 4e-7");
    let run = ["base.toml", "one.csv", "--validate", "two.csv", "--out", "report.html"];
    done(here, &[&["discover"], &run[..]].concat());
    let text = std::fs::read_to_string(here.join("report.html")).expect("it was written");
    let page = scraper::Html::parse_document(&text);
    assert!(page.errors.is_empty(), "{:?}", page.errors);
    let count = |selector: &str| {
        page.select(&scraper::Selector::parse(selector).expect("a selector")).count()
    };
    assert_eq!(count("script, [src], link"), 0);
    assert_eq!(count("#ladder tbody tr"), 2);
    assert_eq!(count("#missing .card[data-effect=quadratic_drag] svg.plot"), 1);
    assert!(count("#parameters tbody tr") >= 7);
    assert!(count("#recordings svg.plot") == 1 && count("#curves svg.plot") > 3);
    done(here, &[&["add"], &run[..1], &["stribeck"], &run[1..], &["-o", "b.toml"]].concat());
    let text = std::fs::read_to_string(here.join("report.html")).expect("it was written");
    assert!(!text.contains("id=\"missing\""), "nobody was asked what is missing");
}

/// The recording with one column, by its place, changed.
fn spoiled(folder: &Path, from: &str, to: &str, column: usize, change: impl Fn(usize, f64) -> f64) {
    let text = std::fs::read_to_string(folder.join(from)).expect("it was written");
    let mut lines = text.lines();
    let mut out = format!("{}\n", lines.next().expect("a header"));
    for (row, line) in lines.enumerate() {
        let cells = line.split(',').enumerate().map(|(k, cell)| match k == column {
            true => change(row, cell.parse().expect("a number")).to_string(),
            false => cell.to_owned(),
        });
        out += &format!("{}\n", cells.collect::<Vec<_>>().join(","));
    }
    put(folder, to, out);
}

#[test]
fn what_is_wrong_with_the_signals_is_said_first_and_nothing_is_named() {
    let here = folder();
    let here = here.path();
    recorded(here, "");
    let text = std::fs::read_to_string(here.join("one.csv")).expect("it was written");
    let headers: Vec<&str> = text.lines().next().expect("a header").split(',').collect();
    let place = |name: &str| headers.iter().position(|it| it.starts_with(name)).expect("a column");
    spoiled(here, "one.csv", "turned.csv", place("i ["), |_, i| -i);
    let discover = ["discover", "base.toml", "turned.csv", "--validate", "two.csv"];
    let ran = done(here, &[&discover[..], &["-o", "found.toml", "--json", "-"]].concat());
    let answer = ran.json();
    assert_eq!(answer["verdict"], "not_judged", "{answer}");
    assert_eq!((&answer["named"], &answer["before"]), (&serde_json::json!([]), &Value::Null));
    let first = &answer["signals"][0];
    assert_eq!((&first["what"], &first["channel"]), (&"sign".into(), &"i".into()), "{first}");
    assert!(!here.join("found.toml").exists(), "nothing was judged, nothing is written");
    let said = done(here, &[&discover[..], &["--quiet"]].concat()).out;
    assert!(
        said.starts_with("AMIRA DR300: not judged") && said.contains("the sign of i"),
        "{said}"
    );
    let compared = done(here, &["compare", "base.toml", "turned.csv", "--quiet"]).out;
    assert!(compared.starts_with("not to be judged: turned.csv: the sign of i"), "{compared}");
    // A spike is set to missing, and everything goes on.
    let spike = |row, omega| if row == 2000 { 1e9 } else { omega };
    spoiled(here, "one.csv", "spiked.csv", place("omega"), spike);
    let fit = ["fit", "base.toml", "spiked.csv", "--validate", "two.csv", "-o", "fitted.toml"];
    let answer = done(here, &[&fit[..], &["--json", "-"]].concat()).json();
    let [only] = &answer["signals"].as_array().expect("a list")[..] else { panic!("{answer}") };
    assert_eq!((&only["what"], &only["consequence"]), (&"spikes".into(), &"repaired".into()));
    assert_eq!(only["where"]["from"], 2000, "{only}");
    let error = number(&answer["error"]);
    assert!(error < FLOOR, "{error}");
}
