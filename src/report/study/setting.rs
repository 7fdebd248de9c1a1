//! What was simulated.

use drivescope_scenarios::results::StudyResults;
use maud::{Markup, html};

use crate::report::page::{self, math};
use crate::report::words::{count, given, percent, si_units, torque};

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
pub(super) fn section(study: &StudyResults) -> Markup {
    let (drive, noise) = (&study.drive, &study.noise);
    let unit = &drive.tacho_unit;
    let (_, force) = si_units(unit);
    let span = study.fault_span;
    let time = |samples: usize| given(samples as f64 * drive.period_s);
    let facts = [
        ("Drive", format!("{}, file {}", drive.name, drive.digest)),
        ("Set point", format!("{} {unit}, closed loop", given(drive.set_point))),
        ("Sampling time", format!("{} ms", given(1e3 * drive.period_s))),
        (
            "Faults act over",
            format!(
                "samples {} to {} ({} s to {} s)",
                span.from,
                span.to,
                time(span.from),
                time(span.to)
            ),
        ),
        ("Profile of the faults", study.profile.clone()),
        ("Torque fault read as", torque(study.torque).to_owned()),
        ("Noise sd, reference", speed(noise.reference, unit)),
        ("Noise sd, tachometer", speed(noise.omega, unit)),
        ("Noise sd, current", format!("{} A", given(noise.i))),
        (
            "Noise sd, load",
            format!(
                "{} {force}, correlated over {} ms",
                given(noise.torque),
                given(1e3 * noise.torque_time)
            ),
        ),
        ("Seed", study.seed.to_string()),
        (
            "Confidence level",
            format!("beta = {} % outside the bands, two-sided", percent(study.beta, 0)),
        ),
        ("Declaration", format!("after {} samples in a row outside", study.window)),
        (
            "Healthy runs judged",
            format!(
                "{}, {} samples in all, without the first {} of each",
                count(study.healthy.runs, "run"),
                study.healthy.samples,
                study.healthy.run_up
            ),
        ),
        (
            "Process model",
            format!(
                "{}, trained on {} samples",
                study.model.process_model, study.model.training_samples
            ),
        ),
    ];
    page::section(
        "setting",
        "Experiment",
        &html! {
            dl.facts { @for (name, value) in facts {
                    div { dt { (name) } dd { (math(&value)) } }
                } }
            p.note {
                "Each run is a co-simulation of the exported FMU, not of the plant itself. What is "
                "watched is the residual " (math("r = T \u{2212} y_m")) " between the tachometer "
                "and a model that sees the control signal " (math("C_m")) " alone."
            }
        },
    )
}
