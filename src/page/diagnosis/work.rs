//! The long work of diagnosing: train, and judge.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use drivescope_diagnoser::Diagnoser;
use drivescope_recording::Recording;

use super::super::bench::State;
use super::super::progress::Progress;
use super::FILE;
use super::material::{Judged, Material, Ready};
use super::picture::Traces;
use crate::commands::{Diagnose, Plan, TrainMaterial, at_period, interface, train};
use crate::session::Session;

/// Fresh healthy samples that limits of a bank are verified on: somebody waits for the answer.
const VERIFIED: usize = 300_000;

/// Trains a diagnoser on the healthy recordings and judges the others.
pub(super) fn train_all(progress: &Progress) -> miette::Result<impl FnOnce(&mut State) + use<>> {
    let (material, drive) = {
        let state = progress.bench.state();
        let step = state.diagnosis.step.and_then(|step| state.steps.get(step));
        let drive = step.map(|it| (it.text.clone(), it.drive.clone()));
        (state.diagnosis.material.clone(), state.diagnosis.step.zip(drive))
    };
    let session = Session::silent(progress.bench.seed);
    let healthy: Vec<&Material> = material.iter().filter(|it| it.healthy).collect();
    let first = healthy.first();
    let first = first.ok_or_else(|| miette::Report::msg("take a healthy recording first"))?;
    let interface = interface(&first.recording, &[], None)?;
    let at_one_rate =
        |it: &&Material| at_period(Recording::clone(&it.recording), interface.period_s, &session);
    let recordings = healthy.iter().map(at_one_rate).collect::<miette::Result<_>>()?;
    progress.doing(match &drive {
        Some(_) => "learning noise and limits of the bank, then the models",
        None => "fitting the models",
    })?;
    let (step, drive) = drive.unzip();
    // What takes longest and decides least is left to the command line.
    let plan = Plan { drive, recurrent: false, gmdh: false, verified: VERIFIED, ..Plan::default() };
    let of = TrainMaterial { healthy: recordings, ..TrainMaterial::default() };
    let trained = train(&interface, of, &plan, &session)?;
    let healthy = healthy.iter().map(|it| it.name.clone()).collect();
    let ready = Arc::new(Ready { trained, healthy, step });
    progress.bench.hand_in(progress.number, |state| {
        state.diagnosis.changes += 1;
        state.diagnosis.ready = Some(Arc::clone(&ready));
        state.diagnosis.material.iter_mut().for_each(|it| it.judged = None);
    });
    each(progress)
}

/// Judges what is to be watched and was not judged yet.
pub(super) fn each(progress: &Progress) -> miette::Result<impl FnOnce(&mut State) + use<>> {
    let (material, ready) = {
        let diagnosis = &progress.bench.state().diagnosis;
        (diagnosis.material.clone(), diagnosis.ready.clone())
    };
    let ready = ready.ok_or_else(|| miette::Report::msg("train a diagnoser first"))?;
    let diagnoser = &ready.trained.learned.diagnoser;
    let open = material.into_iter().filter(|it| !it.healthy && it.judged.is_none());
    for (k, Material { name, recording, .. }) in open.enumerate() {
        progress.doing(&format!("watching {name}"))?;
        let judged = Arc::new(judged(diagnoser, &name, &recording, k));
        progress.bench.hand_in(progress.number, |state| {
            if let Some(material) = state.diagnosis.find(&name) {
                material.judged = Some(judged);
            }
        });
    }
    Ok(|state: &mut State| state.diagnosis.changes += 1)
}

fn judged(diagnoser: &Diagnoser, name: &str, recording: &Recording, number: usize) -> Judged {
    let mut traces = None;
    let session = Session::silent(0);
    let diagnose = Diagnose::on(PathBuf::from(FILE), Path::new(name));
    let answer = at_period(recording.clone(), diagnoser.interface.period_s, &session)
        .and_then(|recording| {
            let mut seen = Traces::new(diagnoser, &recording);
            let answer = diagnose.watched(diagnoser, &recording, &session, |monitor, k| {
                seen.take(monitor, k);
            })?;
            traces = Some(seen);
            Ok(answer)
        })
        .map_err(|error| super::super::bench::words(&error));
    let figure = answer
        .as_ref()
        .ok()
        .zip(traces)
        .map(|(answer, traces)| traces.figure(answer, &format!("watched-{number}")).svg());
    Judged { answer, figure }
}
