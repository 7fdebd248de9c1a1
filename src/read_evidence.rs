//! Recordings read as evidence on a drive, with what is known of their noise.

use std::path::PathBuf;

use drivescope_discovery::signals::{SignalFinding, findings, repaired};
use drivescope_discovery::{Evidence, Measured, NoiseSource, Purpose, doubts, noise};
use drivescope_plant::drive::Drive;
use drivescope_plant::units::name_for_motion;
use drivescope_recording::{NoiseGain, Recording, rounded};
use serde::Serialize;

use crate::commands::{RecordingOptions, resampled_near};
use crate::failure::{Failure, into_report};
use crate::session::Session;

/// The noise of one output of a recording.
#[derive(Debug, Clone, Serialize)]
pub(crate) struct KnownNoise {
    /// The output.
    pub(crate) name: &'static str,
    /// Standard deviation, SI.
    pub(crate) sd: f64,
    pub(crate) unit: String,
    /// Where it comes from.
    pub(crate) source: NoiseSource,
}

/// Recordings with what was found out about them.
#[derive(Debug, Clone)]
pub(crate) struct ReadEvidence {
    /// The recordings.
    pub(crate) evidence: Evidence,
    /// Noise of the outputs of each.
    pub(crate) noise: Vec<Vec<KnownNoise>>,
    /// What is wrong with their signals, the gravest first.
    pub(crate) signals: Vec<SignalFinding>,
    /// What makes them doubtful, in words: what is wrong with their signals first.
    pub(crate) doubts: Vec<String>,
}

impl ReadEvidence {
    /// No recording.
    pub(crate) fn none() -> Self {
        let (evidence, noise) = (Evidence::default(), Vec::new());
        Self { evidence, noise, signals: Vec::new(), doubts: Vec::new() }
    }
}

/// Reads whole recordings for that purpose; says what was assumed and what is doubtful.
///
/// # Errors
/// A recording that cannot be read or used with that drive.
pub(crate) fn read_evidence(
    (drive, purpose): (&Drive, Purpose),
    files: &[PathBuf],
    given: &[(String, f64)],
    reading: &RecordingOptions,
    session: &Session,
) -> miette::Result<ReadEvidence> {
    let mut recordings = Vec::new();
    for (file, name) in files.iter().zip(short_names(files)) {
        recordings.push((name, reading.read_for_model(file, session)?.0));
    }
    let read = evidence_of((drive, purpose), &recordings, given)?;
    for measured in &read.evidence.recordings {
        if let Some(remark) = measured.driving.remark() {
            session.remark(format_args!("{}: {remark}", measured.name));
        }
        for remark in &measured.remarks {
            session.remark(format_args!("{}: {remark}", measured.name));
        }
    }
    read.doubts.iter().for_each(|doubt| session.remark(doubt));
    Ok(read)
}

/// Recordings, each with its name, as evidence on a drive.
///
/// # Errors
/// A recording that cannot be used with that drive.
pub(crate) fn evidence_of(
    (drive, purpose): (&Drive, Purpose),
    recordings: &[(String, Recording)],
    given: &[(String, f64)],
) -> miette::Result<ReadEvidence> {
    let mut read = ReadEvidence::none();
    let period_s = common_period(recordings.iter().map(|(_, recording)| recording));
    for (name, recording) in recordings {
        let (recording, remark) = at_common(recording.clone(), period_s)?;
        let (recording, mut spoiled) = repaired(recording);
        spoiled.iter_mut().for_each(|it| it.recording.clone_from(name));
        read.signals.extend(spoiled);
        let measured = Measured::of(drive, &recording, purpose).map_err(into_report)?;
        let mut measured = Measured { name: name.clone(), ..measured };
        measured.remarks.extend(remark);
        read.doubts
            .extend(doubts(drive, &measured).map_err(into_report)?.iter().map(ToString::to_string));
        let found = noise(drive, &measured, given);
        let known = measured.outputs.iter().zip(&found).map(|(channel, noise)| KnownNoise {
            name: channel.name,
            sd: noise.sd,
            unit: channel.unit.clone(),
            source: noise.source,
        });
        read.noise.push(known.collect());
        read.evidence.noise.push(found.iter().map(|noise| noise.sd).collect());
        read.evidence.recordings.push(measured);
    }
    read.signals.extend(findings(drive, &read.evidence));
    read.signals.sort_by_key(|it| it.consequence);
    read.doubts.splice(0..0, read.signals.iter().map(ToString::to_string));
    Ok(read)
}

/// The sampling time of recordings that belong together, s: that of the first whose rows are samples,
/// or of the first.
fn common_period<'a>(mut recordings: impl Iterator<Item = &'a Recording> + Clone) -> Option<f64> {
    let as_sampled = recordings.clone().find(|it| it.noise_gain == NoiseGain::NONE);
    as_sampled.or_else(|| recordings.next()).map(|it| it.period_s)
}

/// A recording that was put on a grid of its own, for its rows come unevenly, on the common one where
/// that is near, and what was done; any other as it is.
fn at_common(
    recording: Recording,
    period_s: Option<f64>,
) -> miette::Result<(Recording, Option<String>)> {
    let Some(period_s) = period_s.filter(|_| recording.noise_gain != NoiseGain::NONE) else {
        return Ok((recording, None));
    };
    let (recording, from_s) = resampled_near(recording, period_s)?;
    let remark = from_s.map(|from_s| {
        format!(
            "its rows come unevenly: resampled from {} s to the {} s of the recordings beside it",
            rounded(from_s),
            rounded(period_s)
        )
    });
    Ok((recording, remark))
}

/// Names of files without their folders, as results show them; with the last folder where two
/// would be the same.
fn short_names(files: &[PathBuf]) -> Vec<String> {
    let own = |file: &PathBuf| {
        let name = file.file_name().unwrap_or(file.as_os_str()).to_string_lossy();
        name.into_owned()
    };
    let with_folder = |file: &PathBuf| {
        let folder = file.parent().and_then(|it| it.file_name())?.to_string_lossy().into_owned();
        Some(format!("{folder}/{}", own(file)))
    };
    let alone = |file: &&PathBuf| files.iter().filter(|it| own(it) == own(file)).count() == 1;
    files
        .iter()
        .map(|file| match alone(&file) {
            true => own(file),
            false => with_folder(file).unwrap_or_else(|| own(file)),
        })
        .collect()
}

/// The standard deviations of the command line: `i=0.01,omega=0.3`.
///
/// # Errors
/// A part that is no name with a number above 0, or a name that is no output of that drive.
pub(crate) fn given_noise(drive: &Drive, text: Option<&str>) -> miette::Result<Vec<(String, f64)>> {
    let wrong = |what: String| Failure::Usage {
        what,
        instead: "give standard deviations above 0 in SI units, such as --noise i=0.01,omega=0.3"
            .to_owned(),
    };
    let known = ["i", "omega", "theta", "omega_load", "theta_load", "temperature"]
        .map(|name| name_for_motion(drive.motion, name));
    let mut given = Vec::new();
    let items = text.unwrap_or_default().split(',').map(str::trim);
    for item in items.filter(|item| !item.is_empty()) {
        let parsed = item
            .split_once('=')
            .and_then(|(name, sd)| Some((name.trim().to_owned(), sd.trim().parse::<f64>().ok()?)));
        let Some((name, sd)) = parsed.filter(|(_, sd)| sd.is_finite() && *sd > 0.0) else {
            return Err(wrong(format!("--noise: `{item}` is no NAME=SD")).into());
        };
        if !known.contains(&name.as_str()) {
            let known = known.join(", ");
            return Err(wrong(format!("--noise: there is no output `{name}`, only {known}")).into());
        }
        given.push((name, sd));
    }
    Ok(given)
}

#[cfg(test)]
mod tests {
    use drivescope_recording::{ReadOptions, Signal};

    use super::*;

    #[test]
    fn recordings_are_called_by_their_files() {
        let names =
            |files: &[&str]| short_names(&files.iter().map(PathBuf::from).collect::<Vec<_>>());
        assert_eq!(names(&["/home/me/a.csv", "b.csv"]), ["a.csv", "b.csv"]);
        assert_eq!(names(&["/x/1/a.csv", "/x/2/a.csv"]), ["1/a.csv", "2/a.csv"]);
    }

    #[test]
    fn uneven_rows_go_on_the_grid_of_the_recordings_beside_them() {
        let even = |period_s: f64| {
            let values = (0..200).map(|k| (f64::from(k) * period_s).sin()).collect();
            let speed = Signal { name: "omega".into(), unit: "rad/s".into(), values };
            Recording::new("run", 0.0, period_s, vec![speed])
        };
        let uneven = |period_s: f64| {
            let stamp = |k: u32| (f64::from(k) + 0.3 * f64::from(k % 2)) * period_s;
            let rows = (0..200).map(|k| format!("{},{}\n", stamp(k), stamp(k).sin()));
            let folder = tempfile::tempdir().expect("a folder");
            let file = folder.path().join("run.csv");
            let text = "t [s],omega [rad/s]\n".to_owned() + &rows.collect::<String>();
            std::fs::write(&file, text).expect("written");
            drivescope_recording::read(&file, &ReadOptions::default()).expect("read").0
        };
        let moved = |all: &[Recording], at: usize| {
            let period_s = common_period(all.iter());
            let (recording, remark) = at_common(all[at].clone(), period_s).expect("long enough");
            (recording.period_s, remark.is_some())
        };
        let both = [uneven(0.0103), even(0.01)];
        assert_eq!((moved(&both, 0), moved(&both, 1)), ((0.01, true), (0.01, false)));
        // Rows that are samples stay as they are, and so does another rate.
        let apart = [even(0.01), even(0.0104), uneven(0.02)];
        assert_eq!((moved(&apart, 1).1, moved(&apart, 2).1), (false, false));
    }

    #[test]
    fn noise_is_given_by_name() {
        let drive = crate::drive_source::drive("dr300").expect("it is built in");
        let given = given_noise(&drive, Some("i=0.01, omega=0.3")).expect("right");
        assert_eq!(given, [("i".to_owned(), 0.01), ("omega".to_owned(), 0.3)]);
        for wrong in ["i", "i=-1", "i=x", "v=1"] {
            assert!(given_noise(&drive, Some(wrong)).is_err(), "{wrong}");
        }
    }
}
