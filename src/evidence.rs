//! Recordings as evidence on a drive: read, judged fit for use, their noise known, and part of
//! them held out where the user names no validation.

use std::path::PathBuf;

use clap::Args;
use drivescope_discovery::{Evidence, Measured, Noise, NoiseSource, doubts, noise};
use drivescope_plant::drive::Drive;
use serde::Serialize;

use crate::commands::RecordingOptions;
use crate::failure::{Failure, told};
use crate::session::Session;

/// Share of a single recording that is held out.
const HELD_OUT: usize = 3;

/// Which recordings, and what is known of them.
#[derive(Debug, Args)]
pub(crate) struct EvidenceOptions {
    /// Recordings of one machine.
    #[arg(required = true, value_name = "REC")]
    recordings: Vec<PathBuf>,
    /// Recordings to judge by only; without them the last recording, or the last third of a
    /// single one, is held out.
    #[arg(long, value_name = "REC", num_args = 1..)]
    validate: Vec<PathBuf>,
    /// Standard deviations of the sensors' noise, SI: `i=0.01,omega=0.3`; what is not given is
    /// taken from the drive file or estimated from the recording.
    #[arg(long, value_name = "NAME=SD,..")]
    noise: Option<String>,
    #[command(flatten)]
    reading: RecordingOptions,
}

/// The noise of one output of a recording.
#[derive(Debug, Clone, Serialize)]
pub(crate) struct NamedNoise {
    /// The output.
    pub(crate) name: &'static str,
    /// Standard deviation, SI.
    pub(crate) sd: f64,
    /// Its unit.
    pub(crate) unit: String,
    /// Where it comes from.
    pub(crate) source: NoiseSource,
}

/// Recordings to fit to, and others to judge by.
#[derive(Debug)]
pub(crate) struct Gathered {
    /// To fit to.
    pub(crate) estimation: Evidence,
    /// To judge by.
    pub(crate) validation: Evidence,
    /// Noise of the recordings to fit to, then of those to judge by.
    pub(crate) noise: Vec<Vec<NamedNoise>>,
    /// How the validation was chosen, in words.
    pub(crate) split: String,
    /// What makes the recordings doubtful.
    pub(crate) doubts: Vec<String>,
}

impl EvidenceOptions {
    /// Reads and splits the recordings; says what was assumed and what is doubtful.
    ///
    /// # Errors
    /// A recording that cannot be read or used with that drive.
    pub(crate) fn gather(&self, drive: &Drive, session: &Session) -> miette::Result<Gathered> {
        let given = self.given(drive)?;
        let read = |path: &PathBuf| -> miette::Result<Measured> {
            let (recording, _) = self.reading.read(path, session)?;
            Measured::new(drive, &recording).map_err(told)
        };
        let mut estimation = self.recordings.iter().map(read).collect::<Result<Vec<_>, _>>()?;
        let mut validation = self.validate.iter().map(read).collect::<Result<Vec<_>, _>>()?;
        let mut found = Vec::new();
        for measured in estimation.iter().chain(&validation) {
            found.extend(doubts(drive, measured).map_err(told)?.iter().map(ToString::to_string));
        }
        // The noise is known best over the whole of a recording.
        let of = |measured: &Measured| noise(drive, measured, &given);
        let mut noises: Vec<Vec<Noise>> = estimation.iter().chain(&validation).map(of).collect();
        let split = split(&mut estimation, &mut validation, &mut noises)?;
        for doubt in &found {
            session.remark(doubt);
        }
        let named = |(measured, noise): (&Measured, &Vec<Noise>)| {
            let each = measured.outputs.iter().zip(noise);
            each.map(|(channel, noise)| NamedNoise {
                name: channel.name,
                sd: noise.sd,
                unit: channel.unit.clone(),
                source: noise.source,
            })
            .collect()
        };
        let all = estimation.iter().chain(&validation);
        let noise = all.zip(&noises).map(named).collect();
        let mut sds = noises.iter().map(|noise| noise.iter().map(|noise| noise.sd).collect());
        let estimation_noise = sds.by_ref().take(estimation.len()).collect();
        let validation_noise = sds.collect();
        Ok(Gathered {
            estimation: Evidence { recordings: estimation, noise: estimation_noise },
            validation: Evidence { recordings: validation, noise: validation_noise },
            noise,
            split,
            doubts: found,
        })
    }

    /// The standard deviations of the command line.
    fn given(&self, drive: &Drive) -> miette::Result<Vec<(String, f64)>> {
        let wrong = |what: String| Failure::Usage {
            what,
            instead:
                "give standard deviations above 0 in SI units, such as --noise i=0.01,omega=0.3"
                    .to_owned(),
        };
        let known = ["i", "omega", "theta"]
            .map(|name| drivescope_plant::units::name_for_motion(drive.motion, name));
        let items = self.noise.as_deref().unwrap_or_default().split(',').map(str::trim);
        let mut given = Vec::new();
        for item in items.filter(|item| !item.is_empty()) {
            let parsed = item.split_once('=').and_then(|(name, sd)| {
                Some((name.trim().to_owned(), sd.trim().parse::<f64>().ok()?))
            });
            let Some((name, sd)) = parsed.filter(|(_, sd)| sd.is_finite() && *sd > 0.0) else {
                return Err(wrong(format!("--noise: `{item}` is no NAME=SD")).into());
            };
            if !known.contains(&name.as_str()) {
                let known = known.join(", ");
                return Err(
                    wrong(format!("--noise: there is no output `{name}`, only {known}")).into()
                );
            }
            given.push((name, sd));
        }
        Ok(given)
    }
}

/// Holds recordings out where none was named, and says which.
fn split(
    estimation: &mut Vec<Measured>,
    validation: &mut Vec<Measured>,
    noises: &mut Vec<Vec<Noise>>,
) -> miette::Result<String> {
    let names =
        |some: &[Measured]| some.iter().map(|it| it.name.as_str()).collect::<Vec<_>>().join(", ");
    if !validation.is_empty() {
        return Ok(format!("judged by {}", names(validation)));
    }
    if estimation.len() > 1 {
        validation.extend(estimation.pop());
        return Ok(format!("{} is held out to judge by", names(validation)));
    }
    let whole = estimation.remove(0);
    let from = whole.len() - whole.len() / HELD_OUT;
    let split = format!(
        "the last third of {}, from {:.3} s on, is held out to judge by: another recording judges \
         better (--validate)",
        whole.name,
        whole.time(from)
    );
    estimation.push(whole.part(0..from).map_err(told)?);
    validation.push(whole.part(from..whole.len()).map_err(told)?);
    noises.push(noises[0].clone());
    Ok(split)
}
