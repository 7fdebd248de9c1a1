//! What was simulated.

use drivescope_scenarios::results::StudyResults;

use super::words::{level, si_units};
use crate::answer::block::{ALL, Block, Fact, HTML};
use crate::report::words::{count, given, torque};

/// Revolutions a minute of 1 rad/s.
const RPM: f64 = 30.0 / std::f64::consts::PI;

/// A speed in SI, and in the unit of T where that differs.
fn speed(value: f64, tacho_unit: &str) -> String {
    let (unit, _) = si_units(tacho_unit);
    match tacho_unit {
        "rpm" => format!("{} {unit} ({} rpm)", given(value), given(value * RPM)),
        _ => format!("{} {unit}", given(value)),
    }
}

/// The section.
pub(super) fn blocks(study: &StudyResults) -> Vec<Block> {
    let about = "Each run is a co-simulation of the exported FMU, not of the plant itself. What is \
                 watched is the residual r = T - y_m between the tachometer and a model that sees the \
                 control signal C_m alone";
    vec![Block::Facts(facts(study)), Block::In(HTML, vec![Block::Note(about.to_owned())])]
}

fn facts(study: &StudyResults) -> Vec<Fact> {
    let (drive, noise, healthy) = (&study.drive, &study.noise, &study.healthy);
    let unit = &drive.tacho_unit;
    let (_, force) = si_units(unit);
    let span = study.fault_span;
    let time = |samples: usize| given(samples as f64 * drive.period_s);
    let all = |name: &str, value: String| Fact::new(ALL, name, value);
    // What the tables of a text say themselves.
    let html = |name: &str, value: String| Fact::new(HTML, name, value);
    vec![
        all("Drive", drive.name.clone()),
        html("Drive file", drive.digest.clone()),
        all("Set point", format!("{} {unit}, closed loop", given(drive.set_point))),
        all("Sampling time", format!("{} ms", given(1e3 * drive.period_s))),
        all(
            "Faults act over",
            format!(
                "samples {} to {} ({} s to {} s)",
                span.from,
                span.to,
                time(span.from),
                time(span.to)
            ),
        ),
        all("Profile of the faults", study.profile.clone()),
        all("Torque fault read as", torque(study.torque).to_owned()),
        all("Noise sd, reference", speed(noise.reference, unit)),
        all("Noise sd, tachometer", speed(noise.omega, unit)),
        all("Noise sd, current", format!("{} A", given(noise.i))),
        all(
            "Noise sd, load",
            format!(
                "{} {force}, correlated over {} ms",
                given(noise.torque),
                given(1e3 * noise.torque_time)
            ),
        ),
        all("Seed", study.seed.to_string()),
        html(
            "Confidence level",
            format!("beta = {} % outside the bands, two-sided", level(study.beta)),
        ),
        html("Declaration", format!("after {} samples in a row outside", study.window)),
        html(
            "Healthy runs judged",
            format!(
                "{}, {} samples in all, without the first {} of each",
                count(healthy.runs, "run"),
                healthy.samples,
                healthy.run_up
            ),
        ),
        all(
            "Process model",
            format!(
                "{}, trained on {} samples",
                study.model.process_model, study.model.training_samples
            ),
        ),
    ]
}
