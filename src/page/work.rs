//! The long work of a session: analyse, learn, add, fit again. Each runs on copies and answers with
//! what changes in the state.

use std::sync::Arc;
use std::time::Duration;

use drivescope_discovery::{Estimate, Options, Purpose, Setting, add, discover, fit_seen};
use drivescope_plant::drive::Drive;
use drivescope_recording::Recording;

use super::basis::Basis;
use super::bench::{Bench, GivenDrive, State};
use super::command_line::{Files, file_of};
use super::fresh::{Drawn, Fresh};
use super::job::Cancelled;
use super::progress::Progress;
use super::recordings::Taken;
use super::session_step::SessionStep;
use crate::answer::discover::Missing;
use crate::drive_text::{with_effects, with_estimates};
use crate::evidence::Gathered;
use crate::failure::into_report;
use crate::first_drive::{FirstDrive, Given};
use crate::read_evidence::{ReadEvidence, evidence_of, given_noise};

/// Time that the browser has the processors for itself to draw what was found, before they search.
const FIRST_LOOK: Duration = Duration::from_millis(250);
/// A name for the drive that is made from a recording.
const FIRST: &str = "first.toml";

impl Bench {
    /// Begins to analyse the recordings from the start; what was done before is dropped. Nothing
    /// more happens without a recording, or while one is to be completed.
    pub(super) fn analyse(self: &Arc<Self>) {
        let anew = |state: &mut State| {
            state.end_job();
            state.forget();
            let whole = state.recordings.iter().all(|it| it.incomplete.is_none());
            whole && !state.recordings.is_empty()
        };
        self.begin("Analysing", anew, analyse);
    }
}

/// Reads the recordings as evidence, fits the drive, looks where it fails, and asks what it lacks.
pub(super) fn analyse(progress: &Progress) -> miette::Result<impl FnOnce(&mut State) + use<>> {
    let (recordings, given, files) = {
        let state = progress.bench.state();
        let of = |it: &Taken| Some((it.name.clone(), Arc::clone(it.recording.as_ref()?)));
        let recordings: Vec<(String, Arc<Recording>)> =
            state.recordings.iter().filter_map(of).collect();
        let files = Files::of(&state.recordings, progress.bench.seed);
        (recordings, state.drive.clone(), files)
    };
    progress.doing("reading the recordings")?;
    // Whoever removed the last one began anew.
    let (_, recording) = recordings.first().ok_or(Cancelled)?;
    let given = match given {
        Some(given) => given,
        None => first_drive(recording)?,
    };
    let fixes: Vec<_> = {
        let state = progress.bench.state();
        let each = state.recordings.iter().enumerate();
        each.flat_map(|(k, it)| it.fixes(k, &given.drive)).collect()
    };
    progress.bench.hand_in(progress.number, |state| {
        state.fixes = fixes;
        state.drive = Some(given.clone());
    });
    let noise = given_noise(&given.drive, None)?;
    let named: Vec<(String, Recording)> =
        recordings.iter().map(|(name, it)| (name.clone(), Recording::clone(it))).collect();
    let read = evidence_of((&given.drive, Purpose::Search), &named, &noise)?;
    drop(named);
    let basis = Basis {
        whole: Arc::new(read.evidence.clone()),
        gathered: Arc::new(Gathered::of(read, ReadEvidence::none())?),
        files,
        seed: progress.bench.seed,
    };
    let Gathered { estimation, .. } = &*basis.gathered;
    let setting = Setting::of_fit(&given.drive, estimation);
    progress.doing("fitting the drive")?;
    let options = Options { seed: basis.seed, ..Options::default() };
    let fitted =
        fit_seen(&given.drive, estimation, &setting, &options, &|error| progress.fitting(error))
            .map_err(into_report)?;
    let command = basis.files.begun(&given.name, given.made);
    let text = with_estimates((&given.name, &given.text), &fitted, &basis.gathered)?;
    let fresh = Fresh { parent: None, label: "the base, fitted".to_owned(), command, text };
    let step = Arc::new(fresh.step(fitted.into(), setting, &basis, progress)?);
    let drive = step.drive.clone();
    progress.bench.hand_in(progress.number, |state| {
        (state.gathered, state.whole) = (Some(basis.gathered.clone()), Some(basis.whole.clone()));
        state.steps = vec![step];
    });
    let missing = lacking(&drive, &basis, progress)?;
    Ok(move |state: &mut State| {
        state.missing.insert(0, Arc::new(missing));
    })
}

/// The first drive that a recording tells.
fn first_drive(recording: &Recording) -> miette::Result<GivenDrive> {
    let (text, drive) = FirstDrive::of(recording, None, &Given::default())?.file(FIRST)?;
    Ok(GivenDrive { name: FIRST.to_owned(), text, drive, made: true })
}

/// What a drive lacks.
fn lacking(drive: &Drive, basis: &Basis, progress: &Progress) -> miette::Result<Missing> {
    progress.doing("asking what is missing")?;
    std::thread::sleep(FIRST_LOOK);
    let Gathered { estimation, validation, .. } = &*basis.gathered;
    let found = discover(drive, estimation, validation, progress).map_err(into_report)?;
    progress.doing("done")?;
    Ok(Missing::of(&found, false))
}

/// What a job at a step works with.
fn at(progress: &Progress, number: usize) -> miette::Result<(Basis, Arc<SessionStep>)> {
    Ok((Basis::of(progress)?, progress.bench.state().step(number)?))
}

/// Asks what the drive of a step lacks.
pub(super) fn learn(
    progress: &Progress,
    number: usize,
) -> miette::Result<impl FnOnce(&mut State) + use<>> {
    let (basis, step) = at(progress, number)?;
    let missing = lacking(&step.drive, &basis, progress)?;
    Ok(move |state: &mut State| {
        state.missing.insert(number, Arc::new(missing));
    })
}

/// Adds an effect to the drive of a step: a new step, and what it lacks then.
pub(super) fn extend(
    progress: &Progress,
    number: usize,
    effect: &str,
) -> miette::Result<impl FnOnce(&mut State) + use<>> {
    let (basis, step) = at(progress, number)?;
    let Gathered { estimation, validation, .. } = &*basis.gathered;
    let found = add(&step.drive, effect, estimation, validation, progress).map_err(into_report)?;
    progress.doing("comparing")?;
    let name = file_of(number);
    let text = with_effects((&name, &step.text), &step.drive, &found.drive, &basis.gathered)?;
    let next = progress.bench.state().steps.len();
    let command = basis.files.add(number, effect, next);
    let label = format!("+ {}", effect.replace('_', " "));
    let fresh = Fresh { parent: Some(number), label, command, text };
    let setting = step.setting.of(&found.drive);
    finish(fresh, found.into(), setting, &basis, progress)
}

/// Fits a drive that people changed: a typed law added, or a value set.
pub(super) fn refit(
    progress: &Progress,
    number: usize,
    (label, text): (String, String),
) -> miette::Result<impl FnOnce(&mut State) + use<>> {
    let (basis, step) = at(progress, number)?;
    let next = progress.bench.state().steps.len();
    let name = file_of(number);
    let drive = Drive::parse(&text, &name).map_err(into_report)?;
    progress.doing("fitting")?;
    // As `fit` chooses it, but for the observer: errors along a ladder compare under one alone.
    let own = Setting::of_fit(&drive, &basis.gathered.estimation);
    let setting = Setting { observer: step.setting.observer, ..own };
    let options = Options { seed: basis.seed, ..Options::default() };
    let seen = |error| progress.fitting(error);
    let fitted = fit_seen(&drive, &basis.gathered.estimation, &setting, &options, &seen)
        .map_err(into_report)?;
    let command = basis.files.refit((number, &step.text), &text, next);
    let text = with_estimates((&name, &text), &fitted, &basis.gathered)?;
    let fresh = Fresh { parent: Some(number), label, command, text };
    finish(fresh, fitted.into(), setting, &basis, progress)
}

/// Judges a drive with a value that people set, nothing fitted.
pub(super) fn judge(
    progress: &Progress,
    number: usize,
    (label, text): (String, String),
) -> miette::Result<impl FnOnce(&mut State) + use<>> {
    let (basis, step) = at(progress, number)?;
    let drive = Drive::parse(&text, &file_of(number)).map_err(into_report)?;
    let setting = step.setting.of(&drive);
    let parameters = drive.fitted().into_iter().map(|it| {
        let old = step.parameters.iter().find(|other| other.name == it.name);
        Estimate {
            before: old.map_or(it.value, |old| old.value),
            name: it.name,
            value: it.value,
            std_error: f64::NAN,
            unit: it.unit,
            at_bound: false,
        }
    });
    let parameters = parameters.collect();
    let next = progress.bench.state().steps.len();
    let command = basis.files.compare(&text, next);
    let fresh = Fresh { parent: Some(number), label, command, text };
    let drawn = Drawn { parameters, not_identifiable: Vec::new(), fitted: false };
    finish(fresh, drawn, setting, &basis, progress)
}

/// Hands in a new step and asks what it lacks.
fn finish(
    fresh: Fresh,
    drawn: Drawn,
    setting: Setting,
    basis: &Basis,
    progress: &Progress,
) -> miette::Result<impl FnOnce(&mut State) + use<>> {
    let step = Arc::new(fresh.step(drawn, setting, basis, progress)?);
    let drive = step.drive.clone();
    let mut number = 0;
    progress.bench.hand_in(progress.number, |state| {
        number = state.steps.len();
        state.steps.push(step);
    });
    let missing = lacking(&drive, basis, progress)?;
    Ok(move |state: &mut State| {
        state.missing.insert(number, Arc::new(missing));
    })
}
