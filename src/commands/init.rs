//! `init`: a first drive file from a recording.

use std::fmt::Write as _;
use std::io::Write as _;
use std::path::PathBuf;

use clap::{Args, ValueEnum};
use drivescope_discovery::{BothUnexplained, Unexplained};
use drivescope_plant::drive::Input;
use serde::Serialize;

use super::Run;
use super::recording_options::RecordingOptions;
use crate::failure::{Ending, into_report};
use crate::first_drive::{FirstDrive, Given, Origin, Value, offer};
use crate::next::Next;
use crate::output;
use crate::report::words::{balances, number, significant};
use crate::session::Session;
use crate::simulation::replay::Fit;

/// Signals that a first drive is made from: none may have holes.
const USED: [&str; 11] = ["u", "torque", "i", "I_m", "C_m", "omega", "v", "theta", "x", "T", "T_l"];

/// Make a first drive file from a recording: what was measured decides what is modelled, least
/// squares and a fit give the values, and what the recording does not tell is marked.
#[derive(Debug, Args)]
pub(crate) struct Init {
    /// Recording of the drive.
    recording: PathBuf,
    /// Drive file to write (.toml).
    #[arg(short, long, value_name = "DRIVE")]
    output: PathBuf,
    /// What u is: the armature voltage, or a command that u x K_m turns into torque or force.
    #[arg(long, value_name = "voltage|force", hide_possible_values = true)]
    input: Option<Kind>,
    /// Values of a data sheet, SI, that are taken as they are: `K_m=0.05,R=2.1`.
    #[arg(long, value_name = "NAME=VALUE,..")]
    given: Option<String>,
    #[command(flatten)]
    reading: RecordingOptions,
}

#[derive(Debug, Clone, Copy, ValueEnum)]
enum Kind {
    Voltage,
    Force,
}

#[derive(Debug, Serialize)]
struct InitAnswer<'a> {
    output: PathBuf,
    motion: drivescope_plant::drive::Motion,
    input: Input,
    /// What was modelled, and why.
    choice: &'a str,
    parameters: Vec<Parameter<'a>>,
    /// How well the file's drive reproduces the recording.
    fit: &'a [Fit],
    /// Bandwidth of the observer with which it does, Hz; 0 in free run.
    observer_hz: f64,
    /// What the balances leave unexplained.
    unexplained: BothUnexplained,
    /// The command to type next.
    next: String,
}

#[derive(Debug, Serialize)]
struct Parameter<'a> {
    name: &'a str,
    value: f64,
    std_error: Option<f64>,
    unit: &'a str,
    /// Whether the recording tells it.
    estimated: bool,
    origin: &'a str,
}

impl Run for Init {
    fn run(self, session: &Session) -> miette::Result<Ending> {
        let given = Given::parse(self.given.as_deref().unwrap_or_default())?;
        session.check_writable(&[&self.output])?;
        let (recording, report) = self.reading.read_for_model(&self.recording, session)?;
        let used = USED.into_iter().filter(|name| recording.signal(name).is_some());
        report.require(&recording, &used.collect::<Vec<_>>()).map_err(into_report)?;
        if let Some(offer) = offer(&report.constants, &given) {
            session.remark(offer);
        }
        let input = self.input.map(|kind| match kind {
            Kind::Voltage => Input::Voltage,
            Kind::Force => Input::Force,
        });
        let first = FirstDrive::of(&recording, input, &given)?;
        first.choice.remarks.iter().for_each(|remark| session.remark(remark));
        let (text, _) = first.file(&self.output.display().to_string())?;
        output::write_file(&self.output, |out| out.write_all(text.as_bytes()))?;
        if let Some(remark) = strays(&first.quality.fits) {
            session.remark(remark);
        }
        let next = self.next();
        let answer = InitAnswer {
            output: self.output.clone(),
            motion: first.choice.motion,
            input: first.choice.input,
            choice: &first.choice.sentence,
            parameters: first.values.iter().map(parameter).collect(),
            fit: &first.quality.fits,
            observer_hz: first.quality.observer_hz,
            unexplained: first.quality.unexplained.into(),
            next: next.command().to_owned(),
        };
        session.wrote(&said(&first, &answer), &answer, &next)?;
        Ok(Ending::Done)
    }
}

impl Init {
    /// The command to type next, with the columns that were named here.
    fn next(&self) -> Next {
        let fit = Next::new("fit").files([&self.output, &self.recording]);
        self.reading.on(fit).options(" -o fitted.toml")
    }
}

/// What to say where the drive follows a signal worse than the signal's mean does.
fn strays(fits: &[Fit]) -> Option<String> {
    let worse = fits.iter().filter(|it| it.percent.is_some_and(|percent| percent < 0.0));
    let signals: Vec<&str> = worse.map(|it| it.signal.as_str()).collect();
    (!signals.is_empty()).then(|| {
        format!(
            "the drive follows {} worse than the mean does: its values are where a fit starts, no \
             more; if the fit stays there, look at the units and signs of the columns (--columns), or \
             give what a data sheet says (--given)",
            signals.join(" and ")
        )
    })
}

fn parameter(value: &Value) -> Parameter<'_> {
    let (estimated, origin) = match value.origin {
        Origin::Estimated(how) => (true, how),
        Origin::Given(how) | Origin::Guessed(how) => (false, how),
    };
    let Value { name, value, unit, std_error, .. } = value;
    Parameter { name, value: *value, std_error: *std_error, unit, estimated, origin }
}

fn said(first: &FirstDrive, answer: &InitAnswer<'_>) -> String {
    let mut text = format!("{}: {}\n", answer.output.display(), first.choice.sentence);
    for Value { name, value, unit, std_error, origin } in &first.values {
        let known = match (origin, std_error) {
            (Origin::Estimated(_), Some(error)) => format!("+- {}", significant(*error, 2)),
            (Origin::Estimated(_), None) => "at its bound".to_owned(),
            (Origin::Given(_), _) => "given".to_owned(),
            (Origin::Guessed(_), _) => "FILL IN".to_owned(),
        };
        let value = significant(*value, 5);
        let row = format!("  {name:<18} {value:<12} {known:<12} {unit}");
        let _ = writeln!(text, "{}", row.trim_end());
    }
    for (name, todo) in first.guesses() {
        let _ = writeln!(text, "fill in {name}: {todo}");
    }
    let how = match answer.observer_hz {
        0.0 => "in free run".to_owned(),
        hz => format!("with an observer of {hz:.3} Hz, for the plant integrates its errors"),
    };
    for Fit { signal, percent, rms, unit } in answer.fit {
        let percent = percent.map_or("constant".to_owned(), |it| format!("{it:.1} %"));
        let _ = writeln!(text, "  {signal:<8} fit {percent}, rms {} {unit}, {how}", number(*rms));
    }
    for (name, remainder) in balances(answer.motion, &answer.unexplained) {
        if let Some(Unexplained { share, .. }) = remainder {
            let _ = writeln!(text, "  {:.1} % of the {name} unexplained", 100.0 * share);
        }
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_drive_that_follows_worse_than_the_mean_is_named() {
        let fit = |signal: &str, percent| Fit {
            signal: signal.to_owned(),
            percent,
            rms: 1.0,
            unit: "rad/s".to_owned(),
        };
        assert_eq!(strays(&[fit("omega", Some(90.0)), fit("i", None)]), None);
        let said = strays(&[fit("omega", Some(-161.0)), fit("i", Some(3.0))]).expect("a sentence");
        assert!(said.starts_with("the drive follows omega worse than the mean does"), "{said}");
    }
}
