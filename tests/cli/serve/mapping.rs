//! Columns said to be something on the page: files that cannot be read as they stand are
//! completed there, and nothing is answered with an option of the command line.

use serde_json::Value;

use super::client::Server;
use crate::{folder, put};

/// A log of 2 s whose rows are made of time in s, voltage in V and speed in rad/s.
fn log(header: &str, row: impl Fn(f64, f64, f64) -> String) -> String {
    let mut text = format!("{header}\n");
    let mut omega = 0.0;
    for k in 0..2000 {
        let t = f64::from(k) * 1e-3;
        let u = 8.0 * (6.0 * t).sin() + 4.0 * (23.0 * t).sin().signum();
        omega += 1e-3 * (12.0 * u - omega) / 0.05;
        text += &row(t, u, omega);
        text.push('\n');
    }
    text
}

/// The pieces of a page at rest, but for the box with the command line.
fn shown(server: &Server, session: &str) -> (String, Value) {
    let news = server.settled(session);
    let pieces = server.get(&format!("{session}pieces")).json();
    let pieces = pieces["pieces"].as_object().expect("pieces").clone();
    let shown = pieces.into_iter().filter(|it| it.0 != "take").map(|it| it.1.to_string());
    (shown.collect::<String>().replace("\\\"", "\""), news)
}

fn no_option(text: &str) {
    let at = text.match_indices("--").find(|(at, _)| {
        let after = text[at + 2..].chars().next();
        after.is_some_and(|it| it.is_ascii_lowercase())
    });
    assert_eq!(at.map(|(at, _)| &text[at.saturating_sub(200)..]), None);
}

#[test]
fn what_cannot_be_read_as_it_stands_is_completed_and_no_option_is_named() {
    let here = folder();
    let server = Server::open(here.path(), &[]);
    let cases = [
        (
            "no time",
            log("u,tick,omega", |t, u, w| format!("{u},{},{w}", 1e3 * t)),
            "Take `tick` as time in ms",
        ),
        (
            "no time at all",
            log("u,omega", |_, u, w| format!("{u},{w}")),
            "The rows are sampled every",
        ),
        (
            "a time that is none",
            log("time,u,omega", |t, u, w| format!("{},{u},{w}", (997.0 * t).sin())),
            "The rows are sampled every",
        ),
        (
            "time backwards",
            log("time,u,omega", |t, u, w| format!("{},{u},{w}", 5.0 - t)),
            "The rows are sampled every",
        ),
        (
            "two of one name",
            log("time,u,u,omega", |t, u, w| format!("{t},{u},{},{w}", 2.0 * u)),
            "Leave out column 3",
        ),
        (
            "two of one meaning",
            log("time,u [V],u [mV],omega", |t, u, w| format!("{t},{u},{},{w}", 2.0 * u)),
            "Leave out",
        ),
        (
            "no such unit",
            log("time,u,omega [furlong]", |t, u, w| format!("{t},{u},{w}")),
            "Take `omega` in rpm",
        ),
    ];
    for (case, text, way_out) in cases {
        let session = server.session();
        let answer = server.post(&format!("{session}file?name=log.csv"), text.as_bytes());
        assert_eq!(answer.status, 204, "{case}: {answer:?}");
        let (html, news) = shown(&server, &session);
        assert_eq!((&news["problem"], &news["steps"]), (&Value::Null, &0.into()), "{case}");
        assert!(html.contains("log.csv is to be completed."), "{case}: {html}");
        assert!(html.contains(way_out), "{case}: {html}");
        assert!(
            html.contains("svg class=\"spark\"") && html.contains("speed of the shaft"),
            "{case}"
        );
        no_option(&html);
    }
}

#[test]
fn what_is_read_and_says_too_little_names_no_option_either() {
    let here = folder();
    let server = Server::open(here.path(), &["--largest-upload", "1"]);
    let cases = [
        log("time,omega", |t, _, w| format!("{t},{w}")),
        log("time,u", |t, u, _| format!("{t},{u}")),
        log("time,a,b", |t, u, w| format!("{t},{u},{w}")),
        log("count,T,enc [counts],torque [%],u,omega", |t, u, w| {
            format!("{},{w},{w},{u},{u},{}", 1e3 * t, 1e3 * w)
        }),
    ];
    for text in cases {
        let session = server.session();
        let answer = server.post(&format!("{session}file?name=log.csv"), text.as_bytes());
        no_option(&answer.body);
        let (html, news) = shown(&server, &session);
        no_option(&html);
        no_option(&news.to_string());
    }
    let session = server.session();
    let large = "1,2,3\n".repeat(200_000);
    for (name, body) in [
        ("a.csv", "nonsense"),
        ("a.exe", "MZ"),
        ("a.csv", ""),
        ("a.mat", "MATLAB"),
        ("a.csv", large.as_str()),
    ] {
        let answer = server.post(&format!("{session}file?name={name}"), body.as_bytes());
        assert!(answer.status >= 400, "{name}: {answer:?}");
        no_option(&answer.body);
    }
    no_option(&server.get(&session).body.replace("<!--", ""));
    for script in ["page.js", "faults.js"] {
        no_option(&server.get(&format!("/assets/{script}")).body);
    }
}

#[test]
fn a_named_file_is_mapped_in_words_and_what_was_said_is_kept() {
    let here = folder();
    let text = log("Zeitmarke;Steller;Welle", |t, u, w| {
        format!("{};{u};{}", 1e3 * t, w * 30.0 / std::f64::consts::PI).replace('.', ",")
    });
    put(here.path(), "log.csv", &text);
    let server = Server::open(here.path(), &["log.csv"]);
    let session = server.session();
    let tell = |column: &str, signal: &str, unit: &str| {
        let command = serde_json::json!({
            "do": "column", "recording": 0, "column": column, "signal": signal, "unit": unit,
        });
        server.post(&format!("{session}do"), command.to_string().as_bytes())
    };
    let time = tell("Zeitmarke", "time", "ms");
    assert_eq!(time.status, 204, "{time:?}");
    assert_eq!(tell("Steller", "u", "V").status, 204);
    assert_eq!(tell("Welle", "omega", "rad/s").status, 204);
    let before = shown(&server, &session).0;
    assert_eq!(tell("Welle", "omega", "rpm").status, 204);
    let (html, news) = shown(&server, &session);
    assert_eq!((&news["problem"], &news["steps"]), (&Value::Null, &1.into()), "{news}");
    assert!(before.contains("rad/s") && before != html, "the values changed");
    assert!(html.contains("Kept in log.csv.columns.toml"), "{html}");
    no_option(&html);
    let refusal = tell("Welle", "omega", "furlong");
    assert_eq!(refusal.status, 422);
    let problem = refusal.json()["problem"].as_str().expect("words").to_owned();
    assert!(problem.contains("`furlong`") && problem.contains("speed of the shaft"), "{problem}");
    let kept = std::fs::read_to_string(here.path().join("log.csv.columns.toml")).expect("kept");
    assert!(kept.contains("omega = \"Welle:rpm\""), "{kept}");

    // Whoever opens it later finds it so, without a word; and commands as well.
    let again = Server::open(here.path(), &["log.csv"]);
    let session = again.session();
    let (html, news) = shown(&again, &session);
    assert_eq!((&news["problem"], &news["steps"]), (&Value::Null, &1.into()), "{news}");
    assert!(html.contains("As kept in log.csv.columns.toml"), "{html}");
    let take = again.get(&format!("{session}pieces")).json();
    let take = take["pieces"]["take"].as_str().expect("HTML").to_owned();
    assert!(take.contains("drivescope init log.csv --columns"), "{take}");
}
