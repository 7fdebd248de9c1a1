//! Checks an FMU: its description against the standard's rules, its binary for the functions that
//! it must have, and a short run in each interface type. What `fmu validate` does.

use super::description::{Description, Interface, Version};
use super::error::Error;
use super::finding::Finding;
use super::fmu::Fmu;
use super::instance::Progress;
use super::instantiate::InstanceOptions;
use super::{rules, rules_structure};

/// Steps of the short run.
const STEPS: u32 = 5;

/// Checks an FMU; nothing is found in a good one.
pub fn validate(fmu: &Fmu) -> Vec<Finding> {
    let description = fmu.description();
    let mut findings = general(description);
    findings.extend(rules::check(description));
    findings.extend(rules_structure::check(description));
    for kind in description.interfaces() {
        match fmu.missing_functions(kind) {
            Ok(missing) if missing.is_empty() => {}
            Ok(missing) => findings.push(Finding::error(
                None,
                format!("the binary lacks {} functions: {}", missing.len(), missing.join(", ")),
            )),
            // Another platform is no fault of the FMU; it just cannot be tried here.
            Err(error @ Error::Platform { .. }) => {
                findings.push(Finding::warning(None, format!("{error}; it was not run")));
                continue;
            }
            Err(error) => {
                findings.push(Finding::error(None, error.to_string()));
                continue;
            }
        }
        match try_out(fmu, kind) {
            Ok(true) => {}
            Ok(false) => {
                let text =
                    format!("{kind}: a run after a reset gives other outputs than the first");
                findings.push(Finding::error(None, text));
            }
            Err(error) => findings.push(Finding::error(None, format!("{kind}: {error}"))),
        }
    }
    // Both interface types may share a binary, and then its faults.
    let mut unique: Vec<Finding> = Vec::new();
    for finding in findings {
        if !unique.contains(&finding) {
            unique.push(finding);
        }
    }
    unique
}

fn general(description: &Description) -> Vec<Finding> {
    let mut findings = Vec::new();
    if description.interfaces().is_empty() {
        let text = "the FMU offers neither Co-Simulation nor Model Exchange";
        findings.push(Finding::error(None, text));
    }
    for kind in description.interfaces() {
        let identifier = description.capabilities(kind).map_or("", |c| &c.model_identifier);
        let letter = |c: char| c.is_ascii_alphanumeric() || c == '_';
        let starts = identifier.starts_with(|c: char| c.is_ascii_digit());
        if identifier.is_empty() || starts || !identifier.chars().all(letter) {
            let text = format!("the model identifier `{identifier}` is no name of C");
            findings.push(Finding::error(None, text));
        }
    }
    let proposed = description.default_experiment;
    let start = proposed.start.unwrap_or(0.0);
    if proposed.stop.is_some_and(|stop| stop <= start) {
        let text = format!("the default experiment does not stop after its start at {start} s");
        findings.push(Finding::error(None, text));
    }
    for (name, value) in [("tolerance", proposed.tolerance), ("step size", proposed.step)] {
        if value.is_some_and(|value| !(value.is_finite() && value > 0.0)) {
            let text = format!("the default experiment's {name} is not positive");
            findings.push(Finding::error(None, text));
        }
    }
    for (at, unit) in description.units.iter().enumerate() {
        if description.units[..at].iter().any(|other| other.name == unit.name) {
            findings.push(Finding::error(None, format!("unit `{}` is defined twice", unit.name)));
        }
    }
    if description.fmi == Version::Three && description.fmi_version.contains("beta") {
        let text = format!("FMI {} is no released version", description.fmi_version);
        findings.push(Finding::warning(None, text));
    }
    findings
}

/// Two short runs with a reset between, then the end; whether the runs agree.
fn try_out(fmu: &Fmu, kind: Interface) -> Result<bool, Error> {
    let proposed = fmu.description().default_experiment;
    let start = proposed.start.unwrap_or(0.0);
    let stop = proposed.stop.filter(|stop| *stop > start);
    let fixed = fmu.description().capabilities(kind).and_then(|c| c.fixed_step);
    let step = fixed.or(proposed.step).unwrap_or(stop.map_or(0.01, |stop| (stop - start) / 100.0));
    let names: Vec<String> = fmu
        .description()
        .scalars(super::Causality::Output)
        .map(|variable| variable.name.clone())
        .collect();
    let names: Vec<&str> = names.iter().map(String::as_str).collect();
    let mut instance = fmu.instantiate(kind, &InstanceOptions::named("validate"))?;
    let outputs = instance.group(&names)?;
    let mut runs = Vec::new();
    for run in 0..2 {
        if run > 0 {
            instance.reset()?;
        }
        instance.initialize(start, stop, proposed.tolerance)?;
        let mut values = vec![0.0; names.len()];
        let mut ended = false;
        for k in 0..STEPS {
            if instance.step(start + f64::from(k) * step, step)? == Progress::Terminate {
                ended = true;
                break;
            }
        }
        instance.read(&outputs, &mut values)?;
        runs.push(values);
        if ended {
            break;
        }
    }
    instance.terminate()?;
    let same = |(a, b): (&f64, &f64)| a.to_bits() == b.to_bits();
    Ok(runs.len() < 2 || runs[0].iter().zip(&runs[1]).all(same))
}
