//! `cosim`: connected FMUs, stepped together.

use std::fmt::Write;
use std::path::{Path, PathBuf};

use clap::Args;
use drivescope_fmu::cosim::{End, open};
use drivescope_recording::{ReadOptions, Recording, read, rounded};
use serde::Serialize;

use super::Run;
use crate::failure::{Ending, into_report};
use crate::next::Next;
use crate::output;
use crate::session::Session;

/// Co-simulate connected FMUs and write a recording of their outputs.
#[derive(Debug, Args)]
pub(crate) struct Cosim {
    /// System description: SSP (.ssp, .ssd) or .toml.
    system: PathBuf,
    /// Recording to write (.csv).
    #[arg(short, long, value_name = "REC")]
    output: PathBuf,
}

#[derive(Debug, Serialize)]
struct CosimAnswer {
    output: PathBuf,
    samples: usize,
    start: f64,
    period: f64,
    signals: Vec<String>,
    /// Whether the stop time was reached, and what happened if not.
    complete: bool,
    #[serde(skip_serializing_if = "Option::is_none")]
    ended: Option<String>,
    algebraic_loops: Vec<Vec<String>>,
}

fn recording(path: &Path) -> Result<Recording, Box<dyn std::error::Error + Send + Sync>> {
    Ok(read(path, &ReadOptions { of_model: true, ..ReadOptions::default() })?.0)
}

/// Why the run ended early, if it did.
fn early(end: &End) -> Option<String> {
    match end {
        End::Stop => None,
        End::Terminated { component, time } => {
            Some(format!("`{component}` asked to end the simulation at {} s", rounded(*time)))
        }
        End::Discarded { component, time, reached, .. } => Some(format!(
            "`{component}` could not complete the step from {} s: it reached {} s",
            rounded(*time),
            rounded(*reached)
        )),
    }
}

impl Run for Cosim {
    fn run(self, session: &Session) -> miette::Result<Ending> {
        let document = open(&self.system).map_err(into_report)?;
        session.check_writable(&[&self.output])?;
        let mut system = document.build(&recording).map_err(into_report)?;
        let left_out = system.left_out();
        if !left_out.is_empty() {
            session.remark(format_args!(
                "neither connected nor recorded, for they are no scalar numbers: {}",
                left_out.join(", ")
            ));
        }
        let outcome = system.run().map_err(into_report)?;
        output::write_recording(&self.output, &outcome.recording)?;
        let recording = &outcome.recording;
        let (samples, period) = (recording.len(), recording.period_s);
        let output = self.output.clone();
        let mut text =
            format!("{samples} samples every {} s: {}\n", rounded(period), output.display());
        let ended = early(&outcome.end);
        if let Some(ended) = &ended {
            let _ = writeln!(text, "ended early: {ended}");
        }
        for outputs in &outcome.algebraic_loops {
            let _ = writeln!(text, "algebraic loop, solved at the start: {}", outputs.join(", "));
        }
        let answer = CosimAnswer {
            signals: recording.signals.iter().map(|signal| signal.header()).collect(),
            output,
            samples,
            start: recording.start_s,
            period,
            complete: ended.is_none(),
            ended,
            algebraic_loops: outcome.algebraic_loops,
        };
        session.wrote(&text, &answer, &Next::new("serve").files([&self.output]))?;
        Ok(Ending::Done)
    }
}
