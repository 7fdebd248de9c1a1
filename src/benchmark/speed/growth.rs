//! How costs grow: with samples, lanes, effects, scenarios and threads.

use std::hint::black_box;

use drivescope_plant::drive::{Drive, EffectData};
use drivescope_plant::effects::registry::REGISTRY;
use miette::IntoDiagnostic as _;
use serde::Serialize;

use super::clock::least_of;
use super::{Held, SAMPLES, ours};
use crate::interrupt;

/// Costs over one quantity, all else kept.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub(crate) struct Growth {
    /// What grows.
    pub(crate) over: &'static str,
    /// What is timed.
    pub(crate) what: &'static str,
    pub(crate) unit: &'static str,
    /// How much of it, and the cost in `unit`.
    pub(crate) points: Vec<(f64, f64)>,
}

/// Effects that are added one after another: those without own states, which need no further signal.
const EFFECTS: [usize; 5] = [0, 1, 2, 4, 8];

pub(super) fn measure(drive: &Drive, held: &Held, short: bool) -> miette::Result<Vec<Growth>> {
    let all = [samples, lanes, effects, scenarios, threads];
    all.into_iter()
        .map(|growth| {
            interrupt::check()?;
            growth(drive, held, short)
        })
        .collect()
}

fn samples(drive: &Drive, held: &Held, _: bool) -> miette::Result<Growth> {
    let time = |samples: usize| {
        let inputs: Vec<_> = held.inputs.iter().copied().cycle().take(samples).collect();
        let held = Held { inputs, ..held.clone() };
        1e6 * least_of(&mut || drop(black_box(ours::alone(drive, &held))))
    };
    let points = [500, 5000, 50_000].map(|it| (it as f64, time(it))).to_vec();
    Ok(Growth { over: "samples", what: "a run of one drive", unit: "us", points })
}

fn lanes(drive: &Drive, held: &Held, _: bool) -> miette::Result<Growth> {
    fn time<const N: usize>(drive: &Drive, held: &Held) -> (f64, f64) {
        let run = least_of(&mut || ours::lanes::<N>(drive, held));
        (N as f64, 1e9 * run / held.inputs.len() as f64 / N as f64)
    }
    let points = vec![
        time::<1>(drive, held),
        time::<4>(drive, held),
        time::<16>(drive, held),
        time::<32>(drive, held),
    ];
    Ok(Growth { over: "lanes", what: "a sample of a drive", unit: "ns", points })
}

fn effects(drive: &Drive, held: &Held, _: bool) -> miette::Result<Growth> {
    let others = || {
        let has = |id: &str| drive.effects.iter().any(|it| it.kind == id);
        REGISTRY.iter().filter(move |law| law.states.is_empty() && !has(law.info.id))
    };
    let time = |count: usize| {
        let mut more = drive.clone();
        more.effects.extend(others().take(count).map(|law| EffectData {
            kind: law.info.id.to_owned(),
            id: law.info.id.to_owned(),
            parameters: law.parameters.iter().map(|it| (it.name.to_owned(), it.nominal)).collect(),
            law: None,
        }));
        let run = least_of(&mut || drop(black_box(ours::alone(&more, held))));
        1e9 * run / held.inputs.len() as f64
    };
    let points = EFFECTS.map(|count| (count as f64, time(count))).to_vec();
    Ok(Growth { over: "effects added", what: "a sample of a drive", unit: "ns", points })
}

fn scenarios(_: &Drive, _: &Held, short: bool) -> miette::Result<Growth> {
    let counts: &[usize] = if short { &[32, 128] } else { &[32, 128, 512, 2048] };
    let one = rayon::ThreadPoolBuilder::new().num_threads(1).build().into_diagnostic()?;
    let time = |count: &usize| {
        let campaign = ours::campaign(*count, SAMPLES, "")?;
        let run = one.install(|| least_of(&mut || ours::scenarios(&campaign)));
        Ok((*count as f64, 1e3 * run))
    };
    let points = counts.iter().map(time).collect::<miette::Result<_>>()?;
    Ok(Growth { over: "scenarios", what: "a campaign on one thread", unit: "ms", points })
}

fn threads(_: &Drive, _: &Held, short: bool) -> miette::Result<Growth> {
    let most = rayon::current_num_threads();
    let campaign = ours::campaign(if short { 256 } else { 2048 }, SAMPLES, "")?;
    let counts = std::iter::successors(Some(1), |it| Some(2 * it)).take_while(|it| *it < most);
    let time = |count: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(count).build().into_diagnostic()?;
        let run = pool.install(|| least_of(&mut || ours::scenarios(&campaign)));
        Ok((count as f64, 1e3 * run))
    };
    let points = counts.chain([most]).map(time).collect::<miette::Result<_>>()?;
    Ok(Growth { over: "threads", what: "a campaign", unit: "ms", points })
}
