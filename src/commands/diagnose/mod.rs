//! `diagnose`: a diagnoser at work on a recording or on live rows from standard input.

mod answer;
mod live;
mod watch;

use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum};
use drivescope_diagnoser::Diagnoser;
use drivescope_scenarios::results::Method;

use self::answer::Answer;
use self::watch::Watch;
use super::{RecordingOptions, Run};
use crate::failure::{Ending, Failure, told};
use crate::next::Next;
use crate::session::Session;

/// Run a diagnoser on a recording, or on rows as they come in: what lies outside its thresholds, when
/// a fault is declared, and which of the faults it was shown it is.
#[derive(Debug, Args)]
pub(crate) struct Diagnose {
    /// Diagnoser file, as `train` writes it.
    diagnoser: PathBuf,
    /// Recording, or `-` for CSV rows from standard input.
    recording: PathBuf,
    /// The method whose declarations are the verdict; the others are shown beside it.
    #[arg(long, value_enum, default_value_t = Asked::Mem)]
    method: Asked,
    /// Another share of healthy samples outside the bands than the file's.
    #[arg(long, allow_negative_numbers = true)]
    beta: Option<f64>,
    /// End with exit code 1 if a fault is declared.
    #[arg(long)]
    check: bool,
    #[command(flatten)]
    reading: RecordingOptions,
}

/// Methods that can be asked for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
#[value(rename_all = "snake_case")]
enum Asked {
    /// Bands by model error modelling, ARX error model.
    Mem,
    /// The same with the recurrent error model.
    MemRecurrent,
    /// Constant thresholds.
    Constant,
    /// Intervals of the GMDH network.
    Gmdh,
}

impl From<Asked> for Method {
    fn from(asked: Asked) -> Self {
        match asked {
            Asked::Mem => Self::Mem,
            Asked::MemRecurrent => Self::MemRecurrent,
            Asked::Constant => Self::Constant,
            Asked::Gmdh => Self::Gmdh,
        }
    }
}

/// Judged windows below which a diagnosis says that it rests on little.
const FEW_WINDOWS: usize = 10;

impl Run for Diagnose {
    fn run(self, session: &Session) -> miette::Result<Ending> {
        let diagnoser = Diagnoser::load(&self.diagnoser).map_err(told)?;
        session.check_writable(&[])?;
        let asked = Method::from(self.method);
        let watch = Watch::new(&diagnoser, asked, self.beta)?;
        if !watch.has_asked() {
            return Err(Failure::Usage {
                what: format!("{}: holds no {}", self.diagnoser.display(), asked.label()),
                instead: "train it again with one, or ask for another --method".to_owned(),
            }
            .into());
        }
        let (name, watch) = if self.recording == Path::new("-") {
            ("standard input".to_owned(), self.live(&diagnoser, watch, session)?)
        } else {
            self.recorded(&diagnoser, watch, session)?
        };
        let window = diagnoser.window;
        let (samples, run_up, methods) = watch.finish();
        let judged = samples.saturating_sub(run_up);
        if judged < window {
            return Err(Failure::Usage {
                what: format!(
                    "{name}: {samples} samples, of which the first {run_up} only settle the models: \
                     {judged} are left to judge, and a declaration takes {window}"
                ),
                instead: "give a longer recording".to_owned(),
            }
            .into());
        }
        if judged < FEW_WINDOWS * window {
            session.remark(format_args!(
                "{name}: {judged} samples are judged, less than {FEW_WINDOWS} windows of {window}: \
                 the shares outside are rough, and a fault that shows later is not seen"
            ));
        }
        let of_asked = methods.iter().find(|found| found.method == asked);
        let declared = of_asked.map_or(&[][..], |found| &found.declared);
        let named = declared.iter().filter_map(|declared| declared.fault.as_ref());
        let fault = named.max_by_key(|fault| fault.samples).cloned();
        let declared = !declared.is_empty();
        let answer = Answer {
            diagnoser: self.diagnoser,
            recording: name,
            samples,
            run_up,
            verdict: if declared { "fault" } else { "healthy" },
            method: asked,
            fault,
            methods,
        };
        let next = match (declared, &answer.fault) {
            // The faults that are known by name are those of the training.
            (true, None) => {
                Next::new("train HEALTHY --fault NAME=REC -o").files([&answer.diagnoser])
            }
            _ => Next::new("diagnose").files([&answer.diagnoser]).options(" - --check < live.csv"),
        };
        session.say(&answer.text(), &answer, &next)?;
        Ok(if declared && self.check { Ending::Forbidden } else { Ending::Done })
    }
}

impl Diagnose {
    fn recorded(
        &self,
        diagnoser: &Diagnoser,
        mut watch: Watch,
        session: &Session,
    ) -> miette::Result<(String, Watch)> {
        let (recording, report) = self.reading.read(&self.recording, session)?;
        let interface = &diagnoser.interface;
        let channels = interface.inputs.iter().chain([&interface.output]);
        let names: Vec<&str> = channels.map(|channel| channel.name.as_str()).collect();
        report.require(&recording, &names).map_err(told)?;
        let data = interface.select(&recording).map_err(told)?;
        let mut u = vec![0.0; data.inputs().len()];
        for (k, y) in data.output().values.iter().enumerate() {
            if recording.breaks.iter().any(|it| it.at == k) {
                watch.begin();
            }
            u.iter_mut().zip(data.inputs()).for_each(|(u, column)| *u = column.values[k]);
            watch.step(&u, *y, recording.time(k))?;
        }
        Ok((recording.name.clone(), watch))
    }
}
