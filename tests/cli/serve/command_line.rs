//! "The same on a command line" is the same: run in a folder with the files that were dropped, the
//! commands of every step write the drive file that the page offers, byte for byte.

use std::fmt::Write as _;
use std::path::Path;
use std::process::Command;

use super::client::Server;
use crate::{done, folder, put};

const SEED: &str = "5";
const MODEL: &str = include_str!("../../../docs/worked-example/model.toml");
const MACHINE: &str = include_str!("../../../docs/worked-example/machine.toml");

/// Runs of the machine: one with the columns of the program, one with those of another logger.
fn recorded(here: &Path) {
    put(here, "machine.toml", MACHINE);
    for (name, seed, input) in [
        ("one.csv", "3", "8 * sin(2 * t) + 4 * sign(sin(11 * t))"),
        ("two.csv", "4", "9 * sin(1.7 * t) + 6 * sign(sin(9 * t))"),
    ] {
        let simulate = ["simulate", "machine.toml", "--input", input, "--period", "0.002"];
        let to = ["--duration", "4", "--seed", seed, "-o", name];
        done(here, &[simulate, to].concat());
    }
    let two = std::fs::read_to_string(here.join("two.csv")).expect("it was written");
    let mut foreign = "time [s],Steller [V],Strom 7 [A],Welle [rpm]\n".to_owned();
    for row in two.lines().skip(1) {
        let cells: Vec<f64> = row.split(',').map(|it| it.parse().expect("a number")).collect();
        let rpm = cells[3] * 9.549_296_585_513_721;
        let _ = writeln!(foreign, "{},{},{},{rpm}", cells[0], cells[1], cells[2]);
    }
    put(here, "two.csv", foreign);
}

/// The command line of a step, as a person copies it.
fn command(server: &Server, session: &str, step: usize) -> String {
    let pieces = server.get(&format!("{session}pieces?step={step}")).json();
    let html = pieces["pieces"]["take"].as_str().expect("HTML").to_owned();
    let html = scraper::Html::parse_fragment(&html);
    let place = scraper::Selector::parse("#command").expect("a selector");
    html.select(&place).flat_map(|it| it.text()).collect()
}

#[test]
fn the_same_on_a_command_line_is_the_same() {
    let here = folder();
    recorded(here.path());
    let server = Server::open(here.path(), &["--seed", SEED]);
    let session = server.session();
    let send = |name: &str| {
        let bytes = std::fs::read(here.path().join(name)).unwrap_or_else(|_| MODEL.into());
        let answer = server.post(&format!("{session}file?name={name}"), &bytes);
        assert_eq!(answer.status, 204, "{name}: {answer:?}");
        server.settled(&session);
    };
    let tell = |command: &str| {
        let answer = server.post(&format!("{session}do"), command.as_bytes());
        assert_eq!(answer.status, 204, "{command}: {answer:?}");
        server.settled(&session)["problem"].clone()
    };
    let right = |command: &str| assert_eq!(tell(command), serde_json::Value::Null, "{command}");
    ["model.toml", "one.csv", "two.csv"].into_iter().for_each(send);
    for (column, signal, unit) in
        [("Steller", "u", "V"), ("Strom 7", "i", "A"), ("Welle", "omega", "rpm")]
    {
        // Before the last of them the recording is not complete.
        let is = format!(r#""column":"{column}","signal":"{signal}","unit":"{unit}""#);
        tell(&format!(r#"{{"do":"column","recording":1,{is}}}"#));
    }
    right(r#"{"do":"add","step":0,"effect":"cogging"}"#);
    let law = r#"{"target":"torque","text":"-c * omega * abs(omega)","coefficients":"c = 1e-7"}"#;
    right(&format!(r#"{{"do":"law","step":1,"law":{law}}}"#));
    right(r#"{"do":"set","step":0,"name":"R","value":2.3}"#);
    right(r#"{"do":"fit","step":3}"#);

    // Another folder: what was said on the page is known from the commands alone.
    let shell = folder();
    put(shell.path(), "model.toml", MODEL);
    for name in ["one.csv", "two.csv"] {
        let bytes = std::fs::read(here.path().join(name)).expect("written before");
        put(shell.path(), name, bytes);
    }
    let program = Path::new(env!("CARGO_BIN_EXE_drivescope")).parent().expect("a folder");
    let path = format!("{}:{}", program.display(), std::env::var("PATH").unwrap_or_default());
    for step in 0..5 {
        let typed = command(&server, &session, step);
        let ran = Command::new("sh")
            .args(["-e", "-c", &typed])
            .current_dir(shell.path())
            .env("PATH", &path)
            .output()
            .expect("a shell");
        assert!(ran.status.success(), "{typed}\n{}", String::from_utf8_lossy(&ran.stderr));
        let own = std::fs::read_to_string(shell.path().join(format!("step-{step}.toml")));
        let page = server.get(&format!("{session}take/drive.toml?step={step}")).body;
        assert_eq!(own.expect("it was written"), page, "{typed}");
    }
}
