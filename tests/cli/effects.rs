//! Every effect of the library through the program: shown, in a drive file, exported and run.

use std::fmt::Write;
use std::path::Path;

use drivescope_plant::effects::custom::Target;
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

/// The statements of a printed law that can be typed, as effects with their nominal values.
fn typed(entry: &Entry, k_m: f64) -> Option<String> {
    let statements = entry.info.law.split("; ").filter_map(|it| it.split_once(" = "));
    let given = |(key, _): &(&str, &str)| Target::ALL.iter().any(|(target, _)| target == key);
    let mut text = String::new();
    for (number, (key, formula)) in statements.filter(given).enumerate() {
        let names = || formula.split(|it: char| !(it.is_alphanumeric() || it == '_'));
        let own = entry.parameters.iter().map(|it| (it.name, it.nominal));
        let used = own.chain([("K_m", k_m)]).filter(|(name, _)| names().any(|it| it == *name));
        let values: Vec<String> = used.map(|(name, value)| format!("{name} = {value:?}")).collect();
        let id = format!("the_{}_{number}", entry.info.id);
        let _ =
            writeln!(text, "[[effect]]\nkind = \"custom\"\nid = \"{id}\"\n{key} = \"{formula}\"");
        let _ = writeln!(text, "parameters = {{ {} }}", values.join(", "));
    }
    (!text.is_empty()).then_some(text)
}

/// Laws of the library that are one formula or several, at least: a printed law that is no formula
/// any more would be passed over in silence.
const FORMULAS: usize = 17;

#[test]
fn a_printed_law_that_is_typed_is_the_effect() {
    let here = folder();
    let here = here.path();
    let table: toml::Table = DR300.parse().expect("it is TOML");
    let k_m = table["motor"]["K_m"].as_float().expect("a number");
    let mut found = 0;
    for entry in REGISTRY {
        let Some(typed) = typed(entry, k_m) else { continue };
        found += 1;
        put(here, "library.toml", format!("{DR300}\n{}", nominal(entry)));
        put(here, "typed.toml", format!("{DR300}\n{typed}"));
        put(here, "without.toml", DR300);
        // In one direction: a typed sign has no friction at rest. After a while what the start
        // from rest changed is forgotten.
        for direction in ["", "-"] {
            let run = |name: &str| {
                let file = format!("{name}.toml");
                let input = format!("{direction}(4.5 + 2.6 * sin(2 * t))");
                let run = ["simulate", file.as_str(), "--noise", "off", "--duration", "3"];
                done(here, &[&run[..], &["--input", input.as_str(), "-o", "run.csv"]].concat());
                ["i [A]", "omega [rad/s]"].map(|name| column(here, "run.csv", name).split_off(100))
            };
            let [library, typed, without] = ["library", "typed", "without"].map(run);
            let apart = |one: &[Vec<f64>; 2], other: &[Vec<f64>; 2]| {
                let of = |(a, b): (&Vec<f64>, &Vec<f64>)| {
                    let scale = a.iter().fold(0.0, |most: f64, value| most.max(value.abs()));
                    a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max) / scale
                };
                one.iter().zip(other).map(of).fold(0.0, f64::max)
            };
            let (off, does) = (apart(&library, &typed), apart(&library, &without));
            // A wrong sign would be twice as far as no law; the steps of typed laws are coarser.
            assert!(off < 0.02 * does, "{}: {off:e} apart", entry.info.id);
            assert!(does > 1e-5, "{} does {does:e}: nothing was compared", entry.info.id);
        }
    }
    assert!(found >= FORMULAS, "only {found} printed laws could be typed");
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
