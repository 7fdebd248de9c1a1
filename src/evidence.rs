//! Recordings as evidence on a drive: read, judged fit for use, their noise known, and part of
//! them held out where the user names no validation.

use std::path::PathBuf;

use clap::Args;
use drivescope_discovery::signals::SignalFinding;
use drivescope_discovery::{Evidence, Measured, NoiseSource, Purpose};
use drivescope_plant::drive::Drive;

use crate::commands::RecordingOptions;
use crate::failure::into_report;
use crate::next::Next;
use crate::read_evidence::{KnownNoise, ReadEvidence, given_noise, read_evidence};
use crate::session::Session;

/// Share of a single recording that is held out.
const HELD_OUT: usize = 3;
/// Factor between estimates of one sensor's noise beyond which they are doubtful.
const UNEQUAL: f64 = 5.0;

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

/// Recordings to fit to, and others to judge by.
#[derive(Debug)]
pub(crate) struct Gathered {
    /// To fit to.
    pub(crate) estimation: Evidence,
    /// To judge by.
    pub(crate) validation: Evidence,
    /// Noise of the recordings to fit to, then of those to judge by.
    pub(crate) noise: Vec<Vec<KnownNoise>>,
    /// How the validation was chosen, in words.
    pub(crate) split: String,
    /// What is wrong with their signals, the gravest first.
    pub(crate) signals: Vec<SignalFinding>,
    /// What makes the recordings doubtful.
    pub(crate) doubts: Vec<String>,
}

impl EvidenceOptions {
    /// The recordings to fit to.
    pub(crate) fn files(&self) -> &[PathBuf] {
        &self.recordings
    }

    /// The command on the same recordings.
    pub(crate) fn on(&self, next: Next) -> Next {
        let next = next.files(&self.recordings);
        self.reading.on(next.judged(&self.validate, self.noise.as_deref()))
    }

    /// Reads and splits the recordings for that purpose; says what was assumed and what is doubtful.
    ///
    /// # Errors
    /// A recording that cannot be read or used with that drive.
    pub(crate) fn gather(
        &self,
        of: (&Drive, Purpose),
        session: &Session,
    ) -> miette::Result<Gathered> {
        let given = given_noise(of.0, self.noise.as_deref())?;
        let read = |files: &[PathBuf]| read_evidence(of, files, &given, &self.reading, session);
        let first = read(&self.recordings)?;
        let second = match self.validate.is_empty() {
            true => ReadEvidence::none(),
            false => read(&self.validate)?,
        };
        let said = first.doubts.len() + second.doubts.len();
        let gathered = Gathered::of(first, second)?;
        gathered.doubts[said..].iter().for_each(|doubt| session.remark(doubt));
        Ok(gathered)
    }
}

impl Gathered {
    /// Of what was read to fit to and to judge by; holds out where nothing is to judge by.
    ///
    /// # Errors
    /// A single recording that is too short to be parted.
    pub(crate) fn of(first: ReadEvidence, second: ReadEvidence) -> miette::Result<Self> {
        let mut estimation = first.evidence.recordings;
        let mut validation = second.evidence.recordings;
        // The noise is known best over the whole of a recording.
        let mut noises: Vec<Vec<KnownNoise>> =
            first.noise.into_iter().chain(second.noise).collect();
        let split = split(&mut estimation, &mut validation, &mut noises)?;
        let named = estimation.iter().chain(&validation).map(|it| it.name.as_str()).zip(&noises);
        let unequal = unequal_noise(&named.collect::<Vec<_>>());
        let sds = |noise: &Vec<KnownNoise>| noise.iter().map(|it| it.sd).collect();
        let mut known = noises.iter().map(sds);
        let estimation_noise = known.by_ref().take(estimation.len()).collect();
        let validation_noise = known.collect();
        Ok(Self {
            estimation: Evidence { recordings: estimation, noise: estimation_noise },
            validation: Evidence { recordings: validation, noise: validation_noise },
            noise: noises,
            split,
            signals: first.signals.into_iter().chain(second.signals).collect(),
            doubts: first.doubts.into_iter().chain(second.doubts).chain(unequal).collect(),
        })
    }

    /// What was assumed of the recordings, and what of them is not used, a sentence each.
    pub(crate) fn remarks(&self) -> Vec<String> {
        let mut all: Vec<String> = Vec::new();
        for measured in self.estimation.recordings.iter().chain(&self.validation.recordings) {
            let driven = measured.driving.remark().map(str::to_owned);
            for remark in driven.iter().chain(&measured.remarks) {
                let said = format!("{}: {remark}", measured.name);
                // The parts of one recording say the same.
                if !all.contains(&said) {
                    all.push(said);
                }
            }
        }
        all
    }

    /// Names of the files that are fitted to.
    pub(crate) fn files(&self) -> String {
        let names: Vec<_> = self.estimation.recordings.iter().map(|it| it.name.as_str()).collect();
        names.join(", ")
    }
}

/// Doubts about outputs whose noise was estimated, and very differently from file to file.
fn unequal_noise(recordings: &[(&str, &Vec<KnownNoise>)]) -> Vec<String> {
    let outputs = recordings.first().map_or(0, |(_, noise)| noise.len());
    let of = |output: usize| {
        let each = recordings.iter().filter_map(|(name, noise)| Some((*name, noise.get(output)?)));
        let estimated = each.filter(|(_, noise)| noise.source == NoiseSource::Estimated);
        let mut all: Vec<(&str, &KnownNoise)> = estimated.collect();
        all.sort_by(|a, b| a.1.sd.total_cmp(&b.1.sd));
        let ((quiet, least), (noisy, most)) = (*all.first()?, *all.last()?);
        (most.sd > UNEQUAL * least.sd).then(|| {
            format!(
                "the noise of {name} is estimated as {:.2e} {unit} in {quiet} and {:.2e} {unit} in \
                 {noisy}, and one sensor has one noise: errors in units of it compare only within \
                 a recording; give it, as --noise {name}=SD",
                least.sd,
                most.sd,
                name = most.name,
                unit = most.unit,
            )
        })
    };
    (0..outputs).filter_map(of).collect()
}

/// Holds recordings out where none was named, and says which.
fn split(
    estimation: &mut Vec<Measured>,
    validation: &mut Vec<Measured>,
    noises: &mut Vec<Vec<KnownNoise>>,
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
    estimation.push(whole.part(0..from).map_err(into_report)?);
    validation.push(whole.part(from..whole.len()).map_err(into_report)?);
    noises.push(noises[0].clone());
    Ok(split)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_sensor_with_two_noises_is_doubtful() {
        let noise = |sd, source| vec![KnownNoise { name: "x", sd, unit: "m".to_owned(), source }];
        let (quiet, noisy) =
            (noise(1e-9, NoiseSource::Estimated), noise(2e-8, NoiseSource::Estimated));
        let doubts = unequal_noise(&[("a.csv", &noisy), ("b.csv", &quiet)]);
        assert_eq!(doubts.len(), 1);
        let said = "1.00e-9 m in b.csv and 2.00e-8 m in a.csv";
        assert!(doubts[0].contains(said) && doubts[0].contains("--noise x=SD"), "{doubts:?}");
        let given = noise(2e-8, NoiseSource::Given);
        assert!(unequal_noise(&[("a.csv", &given), ("b.csv", &quiet)]).is_empty());
        assert!(unequal_noise(&[("a.csv", &quiet), ("b.csv", &quiet)]).is_empty());
    }
}
