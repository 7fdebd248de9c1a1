//! The loop, as the page asks for it: an example, where it fails, the effect, the error falls.

use super::client::Server;
use crate::{done, folder};

fn steps(server: &Server, session: &str) -> usize {
    let pieces = server.get(&format!("{session}pieces")).json();
    pieces["steps"].as_array().expect("a list").len()
}

#[test]
fn the_hidden_effect_is_found_added_and_taken_along() {
    let here = folder();
    let server = Server::open(here.path(), &[]);
    let session = server.session();
    let tell = |command: &str| {
        let answer = server.post(&format!("{session}do"), command.as_bytes());
        assert_eq!(answer.status, 204, "{command}: {answer:?}");
    };
    tell(r#"{"do":"example","id":"hidden"}"#);
    let news = server.settled(&session);
    assert_eq!(news["problem"], serde_json::Value::Null, "{news}");
    let pieces = server.get(&format!("{session}pieces")).json();
    let piece = |name: &str| pieces["pieces"][name].as_str().expect("HTML").to_owned();
    assert!(piece("verdict").contains("The model fails over theta"), "{}", piece("verdict"));
    let cards = piece("cards");
    let first = cards.split("data-effect=\"").nth(1).and_then(|rest| rest.split('"').next());
    assert_eq!(first, Some("cogging"));
    // The law, the curve that convicts, the button.
    assert!(cards.contains("missing torque [N m]") && cards.contains("Add cogging"), "{cards}");

    tell(r#"{"do":"add","step":0,"effect":"cogging"}"#);
    let news = server.settled(&session);
    assert_eq!((&news["steps"], &news["problem"]), (&2.into(), &serde_json::Value::Null), "{news}");
    let pieces = server.get(&format!("{session}pieces?step=1")).json();
    let ladder = pieces["pieces"]["ladder"].as_str().expect("HTML").to_owned();
    let html = scraper::Html::parse_fragment(&ladder);
    let cell = scraper::Selector::parse("tr[data-step='1'] td").expect("a selector");
    let errors: Vec<f64> = html
        .select(&cell)
        .filter_map(|cell| cell.text().collect::<String>().trim().parse().ok())
        .collect();
    assert!(errors.len() == 2 && errors.iter().all(|error| *error < 1.1), "{errors:?}");
    assert!(pieces["pieces"]["cards"].as_str().is_some_and(|it| it.contains("Nothing is missing")));

    let file = server.get(&format!("{session}take/drive.toml?step=1"));
    assert!(file.body.contains("kind = \"cogging\""), "{file:?}");
    assert!(file.header("content-disposition").is_some_and(|it| it.contains("step-1.toml")));
    let fmu = server.get(&format!("{session}take/drive.fmu?step=1&fmi=3"));
    assert!(fmu.status == 200 && fmu.body.starts_with("PK"), "{}", fmu.head);
    let report = server.get(&format!("{session}take/report.html?step=1"));
    let report = scraper::Html::parse_document(&report.body);
    assert!(report.errors.is_empty(), "{:?}", report.errors);
    let ids = scraper::Selector::parse("[id]").expect("a selector");
    let mut ids: Vec<_> = report.select(&ids).filter_map(|it| it.attr("id")).collect();
    ids.sort_unstable();
    let all = ids.len();
    ids.dedup();
    assert_eq!(ids.len(), all, "every id is one of a kind");

    // A fork from the base, by hand, then a typed law.
    tell(r#"{"do":"set","step":0,"name":"R","value":2.3}"#);
    server.settled(&session);
    let law = r#"{"target":"torque","text":"-c * omega * abs(omega)","coefficients":"c"}"#;
    let said = server.post(&format!("{session}law?step=0"), law.as_bytes()).json();
    assert!(said["html"].as_str().is_some_and(|it| it.contains("Understood")), "{said}");
    let wrong = law.replace("omega)", "speed)");
    let said = server.post(&format!("{session}law?step=0"), wrong.as_bytes()).json();
    assert_eq!(said["wrong"]["at"], 17, "{said}");
    tell(&format!(r#"{{"do":"law","step":0,"law":{law}}}"#));
    let news = server.settled(&session);
    assert_eq!((&news["steps"], &news["problem"]), (&4.into(), &serde_json::Value::Null), "{news}");
    let file = server.get(&format!("{session}take/drive.toml?step=3"));
    assert!(file.body.contains("omega * abs(omega)"), "{file:?}");
    let file = server.get(&format!("{session}take/drive.toml?step=2"));
    assert!(file.body.contains("R = 2.3 "), "{file:?}");
}

#[test]
fn a_window_over_what_is_fitted_and_what_judges_has_two_errors() {
    const MACHINE: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/docs/worked-example/machine.toml");
    let here = folder();
    let input = "8 * sin(2 * t) + 4 * sign(sin(11 * t))";
    let simulate = ["simulate", MACHINE, "--input", input, "--period", "0.002", "--duration", "6"];
    done(here.path(), &[&simulate[..], &["-o", "one.csv", "--quiet"]].concat());
    let server = Server::open(here.path(), &[MACHINE, "one.csv"]);
    let session = server.session();
    server.settled(&session);
    // The last third of a single recording is held out.
    let error = |from: f64, to: f64| {
        let path = format!("{session}within?step=0&recording=0&from={from}&to={to}");
        let html = server.get(&path).json()["html"].as_str().expect("HTML").to_owned();
        let error = html.split("Its error is ").nth(1).and_then(|it| it.split(", in units").next());
        error.expect("it is told").to_owned()
    };
    let (fitted, judges) = ("on what it is fitted to", "on what only judges");
    let (early, late, both) = (error(0.5, 3.5), error(4.5, 5.5), error(3.0, 5.5));
    assert!(early.ends_with(fitted) && !early.contains(judges), "{early}");
    assert!(late.ends_with(judges) && !late.contains(fitted), "{late}");
    assert!(both.contains(&format!("{fitted} and ")) && both.ends_with(judges), "{both}");
}

#[test]
fn work_can_be_cancelled_and_sessions_do_not_mix() {
    let here = folder();
    let server = Server::open(here.path(), &[]);
    let (one, two) = (server.session(), server.session());
    assert_ne!(one, two);
    let tell = |session: &str, command: &str| {
        server.post(&format!("{session}do"), command.as_bytes()).status
    };
    assert_eq!(tell(&one, r#"{"do":"example","id":"hidden"}"#), 204);
    assert_eq!(tell(&two, r#"{"do":"example","id":"complete"}"#), 204);
    // One thing at a time in a session; another session is free.
    assert_eq!(tell(&one, r#"{"do":"learn","step":0}"#), 422);
    assert_eq!(tell(&one, r#"{"do":"cancel"}"#), 204);
    assert!(server.settled(&one)["job"].is_null());
    let before = steps(&server, &one);
    let news = server.settled(&two);
    assert_eq!(news["steps"], 1, "{news}");
    let cards = server.get(&format!("{two}pieces")).json()["pieces"]["cards"].to_string();
    assert!(cards.contains("Nothing is missing"), "{cards}");
    assert_eq!(steps(&server, &one), before, "what was cancelled changes nothing later");
}

#[test]
fn signals_come_as_numbers() {
    let here = folder();
    let server = Server::open(here.path(), &[]);
    let session = server.session();
    server.post(&format!("{session}do"), br#"{"do":"example","id":"complete"}"#);
    server.settled(&session);
    let answer = server.get(&format!("{session}signals?step=0&recording=1&points=400"));
    assert_eq!(answer.status, 200, "{}", answer.head);
    let from = answer.body.find('{').expect("a head");
    let to = answer.body.find("]}").expect("an end") + 2;
    let head: serde_json::Value = serde_json::from_str(&answer.body[from..to]).expect("JSON");
    assert_eq!(head["count"], 386, "5001 samples in buckets of 26, two points each: {head}");
    let columns = head["columns"].as_array().expect("columns");
    assert_eq!(columns.len(), 1 + 2 * 4);
    assert_eq!(columns[1], serde_json::json!({"output": "i", "unit": "A", "role": "measured"}));
    assert_eq!(server.get(&format!("{session}signals?step=0&recording=2")).status, 422);
    assert_eq!(server.get(&format!("{session}signals?step=1")).status, 422);
}
