//! A parameter that is set on an FMU is as good as one that was exported with it: every parameter of
//! every shipped drive, over a run in which it matters.

use std::path::Path;

use drivescope_fmu::import::{Causality, Fmu, InstanceOptions, Value};
use drivescope_plant::drive::Drive;

use crate::{done, folder, put};

/// Communication step, s, and their number.
const STEP: f64 = 0.005;
const STEPS: usize = 80;

/// All outputs after every step of a run under a changing input, that value set before it.
fn run(fmu: &Fmu, set: Option<(&str, f64)>) -> Vec<f64> {
    let mut instance = fmu.co_simulation(&InstanceOptions::named("one")).expect("an instance");
    if let Some((name, value)) = set {
        instance.set_value(name, &Value::Number(value)).expect("it can be set");
    }
    let outputs: Vec<String> =
        fmu.description().scalars(Causality::Output).map(|v| v.name.clone()).collect();
    let outputs: Vec<&str> = outputs.iter().map(String::as_str).collect();
    let outputs = instance.group(&outputs).expect("outputs");
    let driven = ["reference", "u"].into_iter().find(|name| fmu.variable(name).is_ok());
    let generator = ["C_g"].into_iter().filter(|name| fmu.variable(name).is_ok());
    let inputs: Vec<&str> = driven.into_iter().chain(["T_l"]).chain(generator).collect();
    let inputs = instance.group(&inputs).expect("inputs");
    let mut row = vec![0.0; inputs.len()];
    let mut values = vec![0.0; outputs.len()];
    let mut all = Vec::new();
    instance.initialize(0.0, None, None).expect("it initialises");
    for k in 0..STEPS {
        // Forward, back, and far enough to reach the limits.
        let sign = if k < STEPS / 2 { 1.0 } else { -1.0 };
        row.fill(0.001 * sign);
        row[0] = sign * if driven == Some("u") { 5.0 } else { 300.0 };
        if row.len() > 2 {
            row[2] = 8.0;
        }
        instance.write(&inputs, &row).expect("inputs");
        instance.step(k as f64 * STEP, STEP).expect("it steps");
        instance.read(&outputs, &mut values).expect("outputs");
        all.extend_from_slice(&values);
    }
    all
}

fn exported(here: &Path, drive: &str) -> Fmu {
    done(here, &["export", drive, "-o", "a.fmu", "--quiet"]);
    Fmu::open(here.join("a.fmu")).expect("our own FMU")
}

#[test]
fn a_parameter_set_on_an_fmu_is_that_of_the_drive() {
    let here = folder();
    for name in ["dr300", "emps"] {
        let path = format!("{}/scenarios/drives/{name}.toml", env!("CARGO_MANIFEST_DIR"));
        let text = std::fs::read_to_string(path).expect("the shipped drive");
        let drive = Drive::parse(&text, name).expect("the shipped drive is right");
        let fmu = exported(here.path(), name);
        let plain = run(&fmu, None);
        let mut seen = 0;
        let parameters: Vec<_> = fmu
            .description()
            .variables
            .iter()
            .filter(|variable| variable.causality == Causality::Parameter)
            .collect();
        assert!(parameters.len() > 4, "{name}");
        for parameter in &parameters {
            let start: f64 = parameter.start[0].parse().expect("a number");
            let value = if start == 0.0 { 0.01 } else { 1.4 * start };
            let mut changed = drive.clone();
            // The reference: a drive whose file says so. Tied constants are the fit's alone.
            changed.set(&parameter.name, value).expect("the drive has it");
            put(here.path(), "changed.toml", changed.to_toml());
            let set = run(&fmu, Some((&parameter.name, value)));
            let own = run(&exported(here.path(), "changed.toml"), None);
            let apart = set.iter().zip(&own).position(|(a, b)| (a - b).abs() > 1e-12 * b.abs());
            assert_eq!(apart, None, "{name}: {} = {value}", parameter.name);
            seen += usize::from(set != plain);
        }
        // A parameter that changes nothing would agree with anything.
        assert!(2 * seen > parameters.len(), "{name}: {seen} of {} are seen", parameters.len());
    }
}
