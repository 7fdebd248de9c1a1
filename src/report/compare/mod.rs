//! The report of a comparison: the verdict, where the model fails, and what that rests on.

pub(crate) mod pictures;
pub(crate) mod tables;

use drivescope_discovery::Evidence;
use drivescope_discovery::compare::Comparison;
use drivescope_plant::drive::Drive;
use drivescope_recording::Clock;
use maud::{Markup, html};

use super::page::{figure, page, section};
use super::words::number;
use crate::read_evidence::KnownNoise;

/// What a report of a comparison tells beside the comparison itself.
#[derive(Debug, Clone)]
pub(crate) struct Setting {
    /// Name of the drive.
    pub(crate) drive: String,
    /// Noise of the first recording's outputs: name, value with unit, where it comes from.
    pub(crate) noise: Vec<(String, String, String)>,
    /// Error on the recordings that only judge, if there are any.
    pub(crate) validation_error: Option<f64>,
    /// The step of a search that it is, if it is one.
    pub(crate) step: Option<OfStep>,
    /// When the samples of each recording were taken.
    pub(crate) clocks: Vec<Clock>,
    /// What makes the recordings doubtful.
    pub(crate) doubts: Vec<String>,
    /// Seed.
    pub(crate) seed: u64,
}

/// A drive that was fitted to a part of the recordings that it is compared with: its error on that
/// part and on the rest are two figures, and the one over all of them is none.
#[derive(Debug, Clone, Copy)]
pub(crate) struct OfStep {
    /// Error on what it was fitted to.
    pub(crate) estimation_error: f64,
    /// Whether its parameters were estimated there, or typed.
    pub(crate) fitted: bool,
}

impl Setting {
    /// Of a drive on recordings, with the noise of the first one's outputs.
    pub(crate) fn new(
        drive: &Drive,
        evidence: &Evidence,
        noise: &[KnownNoise],
        validation_error: Option<f64>,
        doubts: &[String],
        seed: u64,
    ) -> Self {
        let known = |it: &KnownNoise| {
            let source = format!("{:?}", it.source).to_lowercase();
            (it.name.to_owned(), format!("{:.3e} {}", it.sd, it.unit), source)
        };
        Self {
            drive: drive.name.clone(),
            noise: noise.iter().map(known).collect(),
            validation_error,
            step: None,
            clocks: evidence.recordings.iter().map(|it| it.clock.clone()).collect(),
            doubts: doubts.to_vec(),
            seed,
        }
    }
}

/// Above the floor by which an error is that of the noise still.
const AT_THE_FLOOR: f64 = 1.05;

/// Whether the model explains the recordings down to their noise.
pub(crate) fn explains(compared: &Comparison) -> bool {
    compared.error <= AT_THE_FLOOR * compared.floor
}

/// What is to be seen first.
pub(crate) fn verdict(compared: &Comparison) -> String {
    let Some(first) = compared.findings.first() else {
        return if explains(compared) {
            "The model explains these recordings down to their noise.".to_owned()
        } else {
            "The error is above the noise, but it depends on no variable that was tested: it \
             looks like a random load."
                .to_owned()
        };
    };
    let others: Vec<&str> = compared.findings.iter().skip(1).map(|it| it.variable).collect();
    let also = match others.as_slice() {
        [] => String::new(),
        some => format!(" Then over {}.", some.join(", ")),
    };
    format!("The model fails over {}: {}.{also}", first.variable, first.words)
}

/// The second sentence: what the error is, and what fitting could do.
pub(crate) fn remark(compared: &Comparison, step: Option<OfStep>) -> String {
    let floor = if compared.observer_hz > 0.0 {
        format!("; {} is the floor with the observer", number(compared.floor))
    } else {
        "; 1 is the noise floor".to_owned()
    };
    let error = step.map_or(compared.error, |step| step.estimation_error);
    let on = if step.is_some() { " on what it is fitted to" } else { "" };
    let mut text = format!("Its error{on} is {} in units of the noise{floor}.", number(error));
    // Whoever fitted it to a part need not do so again because the rest would have it otherwise.
    let fitted = step.is_some_and(|step| step.fitted);
    if compared.is_unfitted() && !fitted {
        text += &format!(
            " Its parameters are not those that fit all of these recordings best: others would take \
             {:.0} % of the excess away, to about {}. Fit it to all of them first: what is said here \
             is what they could not explain.",
            100.0 * compared.by_parameters,
            number(compared.error_if_fitted)
        );
    }
    if compared.by_balances && compared.parameters_matter() && !fitted {
        text += &format!(
            " Its values are those of least squares on the balances: others would follow the \
             observed motion closer, to about {}, and explain no more of the torque.",
            number(compared.error_if_fitted)
        );
    }
    text
}

/// One self-contained HTML page.
pub(crate) fn compare_html(compared: &Comparison, setting: &Setting) -> String {
    let title = format!("Model against measurement: {}", setting.drive);
    let about = html! { "A drive's model compared with recordings of the drive." };
    let made = html! {
        "drivescope compare, seed " (setting.seed) ". The same files and seed give the same \
         figures."
    };
    page(&title, &about, &body(compared, setting), &made)
}

/// The findings and what they rest on, as sections.
pub(crate) fn body(compared: &Comparison, setting: &Setting) -> Markup {
    html! {
        p.verdict { (verdict(compared)) }
        p.second { (remark(compared, setting.step)) }
        (tables::tiles(compared, setting))
        (findings(compared))
        (curves(compared))
        (recordings(compared, setting))
        (section("residual", "Is the residual white", &tables::residuals(compared)))
        (section("setting", "What this rests on", &tables::setting(compared, setting)))
    }
}

fn findings(compared: &Comparison) -> Markup {
    section("where", "Where it fails", &tables::findings(compared))
}

fn curves(compared: &Comparison) -> Markup {
    section(
        "curves",
        "What is missing over each variable",
        &html! {
            p {
                "Each curve is the torque, voltage or resistance that the model lacks, estimated from \
                 the outputs together with the drive\u{2019}s own parameters; the band holds 95 % of a \
                 bootstrap of time blocks. A band that contains zero everywhere shows nothing \
                 missing. One effect shows over several variables, for they move together: the table \
                 above says over which it is told best."
            }
            @for (place, curve) in compared.curves.iter().enumerate() {
                (figure(
                    &format!("curve-{place}"),
                    pictures::curve(curve, place).svg(),
                    curve.words,
                    &html! { (pictures::caption(curve)) },
                ))
            }
        },
    )
}

fn recordings(compared: &Comparison, setting: &Setting) -> Markup {
    section(
        "recordings",
        "Each recording",
        &html! {
            @for (place, recording) in compared.recordings.iter().enumerate() {
                h3 { (recording.name) }
                (figure(
                    &format!("recording-{place}"),
                    pictures::recording(recording, &setting.clocks[place], place).svg(),
                    &format!("Model and measurement, {}", recording.name),
                    &html! {
                        "Measured in the colour of text, model in blue; below, the residual in units \
                         of the noise. Shaded: spans in which the error is above what noise allows."
                    },
                ))
                @if recording.spans.is_empty() {
                    p.note { "No span of time stands out." }
                } @else {
                    ul.reading {
                        @for span in &recording.spans {
                            li { (span.sentence) " (error " (number(span.error)) ")" }
                        }
                    }
                }
            }
        },
    )
}
