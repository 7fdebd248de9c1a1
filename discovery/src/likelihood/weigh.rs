//! What every law at its null, and every free curve, would explain beside a fitted drive.
//!
//! All columns of a recording stand in one matrix of products, so that the evidence of any set of
//! them is one small decomposition.

use drivescope_plant::drive::{Drive, Input};
use drivescope_plant::effects::grid::Spans;

use super::base::{Further, Pooled, grams, parameters, passes, terms};
use super::columns::{Series, Source};
use super::gram::{Gram, References};
use super::marginal::log_evidence;
use super::optimum::BackgroundCurve;
use super::passes::{LawColumns, Passes};
use super::randomness::Randomness;
use super::scene::{Recorded, Scene, longest};
use super::state::own_states;
use super::stepper::{Stepped, stepped};
use super::track::{Tick, Track};
use super::weighing::Weighing;
use super::weights::{CurveWeight, Weights};
use crate::discover::{Candidate, Curve, Trajectory, curves};

/// What is known of the variables along the tracks.
fn trajectory(it: &Recorded, track: &Track) -> Trajectory {
    let of = |value: &dyn Fn(&Tick) -> f64| track.by_sample(it.measured.len(), value);
    let force = it.drive.motor.input == Input::Force;
    Trajectory {
        current: if force { it.measured.u.clone() } else { of(&|tick| tick.filtered[0]) },
        speed: of(&|tick| tick.filtered[1]),
        position: of(&|tick| tick.filtered[2]),
    }
}

/// The drives and series from which the columns of one recording are made.
struct Made {
    with: Vec<Drive>,
    stiff: Vec<(Drive, f64)>,
    /// The drive of the track, stepped; none where stiff laws are not weighed.
    stepped: Vec<Stepped>,
    curves: Vec<Vec<Series>>,
}

/// Size of the random load, and the time after which it forgets what it was, over those of the base,
/// with which laws and curves are weighed besides: it may have taken what they explain, and it takes
/// what stays the same by a long memory.
const SMALLER: f64 = 0.2;
const SHORTER: f64 = 0.2;

/// All recordings filtered with one randomness.
pub(super) struct Filtering {
    pub(super) tracks: Vec<Track>,
    /// ln of the prior odds of the randomness.
    pub(super) ln_prior: f64,
}

/// The scene filtered with each of the randomnesses with which laws are weighed; the first of those that
/// are given is its own, along which the plant is linearised. Nothing where the drive overflows.
pub(super) fn filtered(scene: &Scene, randomnesses: &[Randomness]) -> Option<Vec<Filtering>> {
    let (own, others) = randomnesses.split_first()?;
    let along = scene.tracks(own)?;
    let beside = [own.scaled(SMALLER), own.with_time(SHORTER * own.load_s)];
    let at = |other: &Randomness| {
        let tracks = scene.retraced(&along, other)?;
        Some(Filtering { tracks, ln_prior: other.ln_prior() })
    };
    let mut filters: Vec<Filtering> = beside.iter().chain(others).filter_map(at).collect();
    filters.insert(0, Filtering { tracks: along, ln_prior: own.ln_prior() });
    Some(filters)
}

/// Weighs the candidates and the curves beside the scene's drive, with each of those randomnesses, of
/// which the first is its own.
///
/// `tolerated` names curves that stand in the background with a standard deviation: what the
/// formula of a named law may leave.
pub(crate) fn weigh(
    scene: &Scene,
    randomnesses: &[Randomness],
    references: &References,
    candidates: &[Candidate],
    spans: &Spans,
    tolerated: impl Fn(&Curve) -> Option<f64> + Sync,
    stopped: &(dyn Fn() -> bool + Sync),
) -> Option<Weights> {
    let filters = filtered(scene, randomnesses)?;
    let tracks: Vec<&[Track]> = filters.iter().map(|it| it.tracks.as_slice()).collect();
    let each = weigh_along((scene, &tracks, references), candidates, (spans, &tolerated), stopped);
    let each = each.into_iter().zip(&filters).map(|(weights, it)| weights.with_prior(it.ln_prior));
    each.reduce(Weights::best_of)
}

fn weigh_along(
    (scene, filters, references): (&Scene, &[&[Track]], &References),
    candidates: &[Candidate],
    (spans, tolerated): (&Spans, &impl Fn(&Curve) -> Option<f64>),
    stopped: &(dyn Fn() -> bool + Sync),
) -> Vec<Weights> {
    let tracks = filters[0];
    let trajectories: Vec<Trajectory> =
        scene.recordings.iter().zip(tracks).map(|(it, track)| trajectory(it, track)).collect();
    let families = curves(&scene.drive, spans, &trajectories);
    let shared = Passes::of(candidates);
    let mut stiff: Vec<(usize, usize)> = Vec::new();
    for (number, candidate) in candidates.iter().enumerate().filter(|it| !it.1.is_linear()) {
        stiff.extend((0..candidate.variants.len()).map(|variant| (number, variant)));
    }
    let timed = |drive: Drive| {
        let longest_s = longest(&drive, scene.speed).min(scene.longest_s);
        (drive, longest_s)
    };
    let made: Vec<Made> = scene
        .recordings
        .iter()
        .zip(tracks)
        .zip(&trajectories)
        .map(|((it, track), trajectory)| {
            let with = |pass: usize| shared.drive(pass, &it.drive, candidates);
            let changed = |(candidate, variant): &(usize, usize)| {
                let candidate = &candidates[*candidate];
                timed(candidate.added(&it.drive, &candidate.variants[*variant]))
            };
            let step = !it.held_out && !stiff.is_empty();
            let own = own_states(&it.drive);
            let stepped = || stepped(&it.drive, &it.measured, own, scene.longest_s, &track.ticks);
            Made {
                stepped: if step { stepped() } else { Vec::new() },
                with: (0..shared.laws.len()).map(with).collect(),
                stiff: stiff.iter().map(changed).collect(),
                curves: families.iter().map(|curve| series(curve, it, track, trajectory)).collect(),
            }
        })
        .collect();
    // What stands in the background comes first, for only its products with all are known.
    let known: Vec<(usize, f64)> = families
        .iter()
        .enumerate()
        .filter_map(|(number, curve)| Some((number, tolerated(curve)?)))
        .collect();
    let is_known = |number: usize| known.iter().any(|(it, _)| *it == number);
    let mut law_columns = Vec::new();
    let mut background = terms(scene);
    let base = background.columns.len();
    let mut next = base;
    let mut take = |count: usize| {
        next += count;
        (next - count..next).collect::<Vec<usize>>()
    };
    let plain = background.clone();
    let mut left_by_formulas = Vec::new();
    for (number, sd) in &known {
        let columns = take(families[*number].knots.len());
        background = background.with(&columns, sd * sd);
        left_by_formulas.push(columns);
    }
    for (candidate, variant) in shared.laws.iter().flatten() {
        let columns = take(candidates[*candidate].coefficients.len());
        law_columns.push(LawColumns { candidate: *candidate, variant: *variant, columns });
    }
    for (candidate, variant) in &stiff {
        law_columns.push(LawColumns { candidate: *candidate, variant: *variant, columns: take(1) });
    }
    // Columns of laws, which are judged by the recordings of the fit alone.
    let columns: usize = law_columns.iter().map(|law| law.columns.len()).sum();
    let curves: Vec<(Curve, Vec<usize>)> = families
        .iter()
        .enumerate()
        .filter(|(number, _)| !is_known(*number))
        .map(|(_, curve)| (curve.clone(), take(curve.knots.len())))
        .collect();
    let groups: Vec<usize> = law_columns
        .iter()
        .map(|law| law.columns.len())
        .chain(curves.iter().map(|(_, columns)| columns.len()))
        .collect();
    let further = |recording: usize| {
        let (made, held_out) = (&made[recording], scene.recordings[recording].held_out);
        let linear: Vec<Source<'_>> = if held_out {
            vec![Source::Nothing(columns - stiff.len())]
        } else {
            let each = made.with.iter().zip(&shared.names);
            each.flat_map(|(drive, names)| passes(drive, names)).collect()
        };
        let stiff: Vec<Source<'_>> = if made.stepped.is_empty() {
            vec![Source::Nothing(stiff.len())]
        } else {
            let own = own_states(&scene.recordings[recording].drive);
            made.stiff
                .iter()
                .map(|(of, longest_s)| Source::Difference {
                    of,
                    from: &made.stepped,
                    shared: own,
                    longest_s: *longest_s,
                })
                .collect()
        };
        let judged = made.curves.iter().enumerate().filter(|(number, _)| !is_known(*number));
        Further {
            background: known.iter().map(|(it, _)| Source::Series(&made.curves[*it])).collect(),
            judged: linear
                .into_iter()
                .chain(stiff)
                .chain(judged.map(|(_, it)| Source::Series(it)))
                .collect(),
            groups: &groups,
        }
    };
    let grams = grams(scene, filters, references, None, further, stopped);
    let with = |(grams, tracks): (&Vec<Gram>, &&[Track])| {
        let pooled = Pooled::of(grams, base, scene, references);
        let weighing = Weighing {
            fitted: pooled.sum(scene, |held_out| !held_out),
            all: pooled.sum(scene, |_| true),
            scale: &pooled.scale,
            background: background.clone(),
            parameters: parameters(scene),
            feedback: None,
        };
        let each = || scene.recordings.iter().zip(*tracks);
        let fitted = each().filter(|(it, _)| !it.held_out);
        let likelihood: f64 = fitted.map(|(_, track)| track.log_likelihood).sum();
        let all: f64 = each().map(|(_, track)| track.log_likelihood).sum();
        Weights {
            base: likelihood + log_evidence(&weighing.fitted, &weighing.background),
            base_of_all: all + log_evidence(&weighing.all, &weighing.background),
            plain: all + log_evidence(&weighing.all, &plain),
            left_by_formulas: weighing.best_beside(&plain, &left_by_formulas),
            laws: weighing.laws(candidates, &law_columns),
            curves: weighing.curves(curves.clone()),
        }
    };
    grams.iter().zip(filters).map(with).collect()
}

/// A curve in the background of a scene, as large as it was found.
pub(super) fn beside(scene: &Scene, tracks: &[Track], curve: &CurveWeight) -> BackgroundCurve {
    let each = scene.recordings.iter().zip(tracks);
    let one = |(it, track)| series(&curve.curve, it, track, &trajectory(it, track));
    BackgroundCurve { series: each.map(one).collect(), sd: curve.size }
}

/// A curve's hats along a recording.
fn series(curve: &Curve, it: &Recorded, track: &Track, along: &Trajectory) -> Vec<Series> {
    let of = |values: &Vec<f64>| -> Vec<f64> {
        let at = |sample: usize| values.get(sample).copied().unwrap_or(0.0);
        track.ticks.iter().map(|tick| at(tick.sample)).collect()
    };
    let forcings = curve.forcings(&it.drive, &it.measured, along);
    let one = |it: &crate::response::Forcing| Series {
        torque: of(&it.torque),
        voltage: of(&it.voltage),
        ..Series::default()
    };
    forcings.iter().map(one).collect()
}
