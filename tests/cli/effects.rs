//! Every effect of the library through the program: shown, in a drive file, exported and run.

use std::fmt::Write;
use std::path::Path;

use drivescope_plant::effects::registry::{Entry, REGISTRY};

use crate::{column, done, folder, put, refused};

const DR300: &str = include_str!("../../scenarios/drives/dr300.toml");
/// The two laws that stand in the drive file.
const TYPED: &str = "[[effect]]\nkind = \"custom\"\ntorque = \"-c * omega * abs(omega)\"\n\
                     parameters = { c = 3e-7 }\n";
const LEARNED: &str = "[[effect]]\nkind = \"learned\"\nbalance = \"torque\"\nover = \"theta\"\n\
                       knots = [0, 2, 4]\nvalues = [0.002, -0.001, 0.001]\n";

/// The effect at its nominal values, under a name of its own.
fn nominal(entry: &Entry) -> String {
    let id = entry.info.id;
    let mut text = format!("[[effect]]\nkind = \"{id}\"\nid = \"the_{id}\"\n");
    for parameter in entry.parameters {
        let _ = writeln!(text, "{} = {:?}", parameter.name, parameter.nominal);
    }
    text
}

/// Greatest difference of current and position, native against the exported FMU, relative.
fn apart(here: &Path, effect: &str, kind: &str) -> f64 {
    put(here, "drive.toml", format!("{DR300}\n{effect}"));
    done(here, &["export", "drive.toml", "-o", "a.fmu", "--quiet", "--fmi", "3", "--open-loop"]);
    let native = ["simulate", "drive.toml", "--noise", "off", "--duration", "0.5"];
    let input = ["--input", "3 * sin(20 * t) + 3 * sign(sin(31 * t))", "-o", "native.csv"];
    done(here, &[&native[..], &input].concat());
    let run = ["fmu", "run", "a.fmu", "--input", "native.csv", "-o", "fmu.csv", "--stop", "0.5"];
    done(here, &[&run[..], &["--step", "0.001", "--kind", kind]].concat());
    let of = |name: &str| {
        let native = column(here, "native.csv", name);
        let fmu = column(here, "fmu.csv", name);
        assert_eq!(native.len(), fmu.len());
        let scale = native.iter().fold(0.0, |most: f64, value| most.max(value.abs()));
        assert!(scale > 0.0, "{name} moves");
        native.iter().zip(&fmu).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max) / scale
    };
    of("i [A]").max(of("omega [rad/s]")).max(of("theta [rad]"))
}

/// Co-simulation is the same code over the same steps.
const SAME: f64 = 1e-12;
/// Model Exchange is another integrator, at the FMU's own tolerance of 1e-9.
const EXCHANGED: f64 = 1e-6;

#[test]
fn an_exported_effect_is_the_native_one() {
    let here = folder();
    let of_registry = REGISTRY.iter().map(nominal);
    for effect in of_registry.chain([TYPED.to_owned(), LEARNED.to_owned()]) {
        let apart = apart(here.path(), &effect, "cs");
        assert!(apart <= SAME, "{effect}: {apart:e}");
    }
}

#[test]
fn a_delayed_input_arrives_in_model_exchange_too() {
    let delay = Entry::find("delay").expect("it is registered");
    let here = folder();
    let apart = apart(here.path(), &nominal(delay), "me");
    assert!(apart <= EXCHANGED, "{apart:e}");
}

#[test]
fn the_library_is_shown_as_it_is_registered() {
    let here = folder();
    let all = done(here.path(), &["effects", "--json", "-"]).json();
    assert_eq!(all.as_array().map(Vec::len), Some(REGISTRY.len()));
    for (entry, shown) in REGISTRY.iter().zip(all.as_array().into_iter().flatten()) {
        assert_eq!(shown["id"], entry.info.id);
        assert_eq!(shown["fails_over"][0], entry.info.fails_over[0].name());
        let text = done(here.path(), &["effects", entry.info.id]).out;
        for word in [entry.info.id, entry.info.law, "fails over", "parameters"] {
            assert!(text.contains(word), "{word} is not in {text}");
        }
    }
    for id in ["custom", "learned"] {
        assert!(done(here.path(), &["effects", id]).out.contains("[[effect]]"));
    }
    let message = refused(here.path(), &["effects", "warp"]);
    assert!(message.contains("asymmetric_friction"), "{message}");
}
