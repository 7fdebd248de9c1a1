//! What a fitted drive may be off by, so that nothing of it is taken for something missing: its
//! parameters, an offset of the torque in every recording, and the law of dry friction at zero
//! speed, which no formula holds exactly.

use drivescope_plant::drive::Drive;
use drivescope_plant::model::SPEED;
use rayon::prelude::*;

use super::columns::{Pass, Series, Source};
use super::gram::{Gram, Products, References, gram};
use super::marginal::{Terms, log_evidence};
use super::scene::Scene;
use super::share::{A_PASS, Share};
use super::track::Track;

/// Standard deviation of a parameter's share, of the balance's size: nearly flat.
pub(crate) const FLAT: f64 = 5.0;
/// Standard deviation of a recording's own offset of the torque, of the balance's size.
pub(super) const OFFSET: f64 = 0.02;
/// Standard deviation by which dry friction at zero speed may differ, of the balance's size, and
/// the speeds over which it does, over the fastest one.
pub(super) const ZERO_SPEED: f64 = 0.3;
pub(super) const NEAR_ZERO: [f64; 4] = [0.001, 0.003, 0.01, 0.03];

/// Series of the base in one recording: offsets of the torque, then friction at zero speed.
struct Base(Vec<Series>);

impl Base {
    /// Of that recording of the scene; `fastest` is the greatest speed of all.
    fn of(scene: &Scene, recording: usize, track: &Track, fastest: f64) -> Self {
        let torque = |torque: Vec<f64>| Series { torque, ..Series::default() };
        let offset = |other: usize| {
            torque(if other == recording { vec![1.0; track.ticks.len()] } else { vec![] })
        };
        let near = |share: &f64| {
            let width = share * fastest;
            let differs = |omega: f64| {
                if omega == 0.0 { 0.0 } else { omega.signum() - (omega / width).tanh() }
            };
            torque(track.ticks.iter().map(|tick| differs(tick.filtered[SPEED])).collect())
        };
        let offsets = (0..scene.recordings.len()).map(offset);
        Self(offsets.chain(NEAR_ZERO.iter().map(near)).collect())
    }

    /// Its sources in the order of [`terms`]; `known` shares are those of its parameters.
    fn sources<'a>(
        &'a self,
        scene: &'a Scene,
        recording: usize,
        known: Option<&'a Known>,
    ) -> Vec<Source<'a>> {
        let it = &scene.recordings[recording];
        let given = |shares: &'a [Vec<Share>], names: &[String]| {
            let each = shares.iter().zip(names.chunks(A_PASS));
            each.map(|(shares, names)| Source::Given { shares, count: names.len() }).collect()
        };
        let passes = |names: &'a [String]| passes(&it.drive, names);
        let mut sources =
            known.map_or_else(|| passes(&scene.names), |it| given(&it.machine, &scene.names));
        sources.push(Source::Series(&self.0));
        for (other, of) in scene.recordings.iter().enumerate() {
            if other == recording {
                sources.extend(
                    known.map_or_else(|| passes(&it.own), |known| given(&known.own, &it.own)),
                );
            } else {
                sources.push(Source::Nothing(of.own.len()));
            }
        }
        sources
    }
}

/// Shares of a drive's parameters along a track, a pass after the other: those of the machine and of
/// the recording.
pub(super) struct Known {
    machine: Vec<Vec<Share>>,
    own: Vec<Vec<Share>>,
}

impl Known {
    /// Of each recording, as the plant is linearised along the tracks.
    pub(super) fn of(scene: &Scene, tracks: &[Track]) -> Vec<Self> {
        let one = |(it, track): (&super::scene::Recorded, &Track)| {
            let shares = |names: &[String]| -> Vec<Vec<Share>> {
                let passes = passes(&it.drive, names).into_iter();
                let pass = |source| Pass::new(&it.drive, it.recording(), source).all(track);
                passes.map(pass).collect()
            };
            Self { machine: shares(&scene.names), own: shares(&it.own) }
        };
        scene.recordings.par_iter().zip(tracks).map(one).collect()
    }
}

/// Passes over parameters of a drive.
pub(super) fn passes<'a>(drive: &'a Drive, names: &'a [String]) -> Vec<Source<'a>> {
    names.chunks(A_PASS).map(|names| Source::Parameters { drive, names }).collect()
}

/// Products of the base along those tracks.
pub(super) fn pooled(
    scene: &Scene,
    tracks: &[Track],
    references: &References,
    known: Option<&[Known]>,
) -> Pooled {
    let filters = [tracks];
    let grams = grams(scene, &filters, references, known, |_| Further::default(), &|| false);
    Pooled::of(&grams[0], terms(scene).variances.len(), scene, references)
}

/// ln of the probability of the recordings along those tracks, what is not `flat` of the base
/// integrated out, and the parameters too where they are.
pub(super) fn probability(scene: &Scene, tracks: &[Track], pooled: &Pooled, flat: bool) -> f64 {
    let all = terms(scene);
    let terms = if flat { all } else { nuisance(&all) };
    let likelihood: f64 = tracks.iter().map(|track| track.log_likelihood).sum();
    likelihood + log_evidence(&pooled.sum(scene, |_| true), &terms)
}

/// Those of the terms that are no parameters: what no value of the drive describes.
pub(super) fn nuisance(all: &Terms) -> Terms {
    let kept = |(_, variance): &(&usize, &f64)| **variance != FLAT * FLAT;
    let (columns, variances) = all.columns.iter().zip(&all.variances).filter(kept).unzip();
    Terms { columns, variances }
}

/// The parameters alone, whose priors are flat.
pub(crate) fn parameters(scene: &Scene) -> Terms {
    let all = terms(scene);
    let flat = |(_, variance): &(&usize, &f64)| **variance == FLAT * FLAT;
    let (columns, variances) = all.columns.iter().zip(&all.variances).filter(flat).unzip();
    Terms { columns, variances }
}

/// The base's columns with the variances of their priors.
pub(crate) fn terms(scene: &Scene) -> Terms {
    let own: usize = scene.recordings.iter().map(|it| it.own.len()).sum();
    let mut variances = vec![FLAT * FLAT; scene.names.len()];
    variances.extend(vec![OFFSET * OFFSET; scene.recordings.len()]);
    variances.extend(vec![ZERO_SPEED * ZERO_SPEED; NEAR_ZERO.len()]);
    variances.extend(vec![FLAT * FLAT; own]);
    Terms { columns: (0..variances.len()).collect(), variances }
}

/// Sources of one recording beside the base: those that stand in the background with it, and those
/// that are judged, in groups of so many columns.
#[derive(Default)]
pub(crate) struct Further<'a> {
    pub(crate) background: Vec<Source<'a>>,
    pub(crate) judged: Vec<Source<'a>>,
    pub(crate) groups: &'a [usize],
}

/// Products of the base's columns, then of the `further` ones of each recording, under each of the
/// `filters`, which are those of all recordings and linearised along the first; `known` are the
/// shares of the base's parameters where they are at hand.
pub(crate) fn grams<'a>(
    scene: &'a Scene,
    filters: &'a [&'a [Track]],
    references: &References,
    known: Option<&'a [Known]>,
    further: impl Fn(usize) -> Further<'a> + Sync,
    stopped: &(dyn Fn() -> bool + Sync),
) -> Vec<Vec<Gram>> {
    let fastest = fastest(filters[0]);
    let one = |recording: usize| {
        let it = &scene.recordings[recording];
        let tracks: Vec<&Track> = filters.iter().map(|tracks| &tracks[recording]).collect();
        let base = Base::of(scene, recording, tracks[0], fastest);
        let known = known.map(|known| &known[recording]);
        let mut background = base.sources(scene, recording, known);
        let further = further(recording);
        background.extend(further.background.iter().copied());
        let sources = (background.as_slice(), further.judged.as_slice());
        gram(&it.drive, it.recording(), &tracks, references, sources, further.groups, stopped)
    };
    let mut each: Vec<_> =
        (0..scene.recordings.len()).into_par_iter().map(|it| one(it).into_iter()).collect();
    let of = |_: &&[Track]| each.iter_mut().filter_map(Iterator::next).collect();
    filters.iter().map(of).collect()
}

pub(crate) fn fastest(tracks: &[Track]) -> f64 {
    let ticks = tracks.iter().flat_map(|track| &track.ticks);
    ticks.fold(f64::MIN_POSITIVE, |most, tick| most.max(tick.filtered[SPEED].abs()))
}

/// Products of several recordings with columns in units of the balances' sizes.
pub(crate) struct Pooled {
    each: Vec<Products>,
    /// Of each column its own unit in that unit: a coefficient of the scaled column times this is
    /// the coefficient of the column.
    pub(crate) scale: Vec<f64>,
}

impl Pooled {
    /// `base` columns are the base's; a column of nothing stays nothing.
    pub(crate) fn of(grams: &[Gram], base: usize, scene: &Scene, references: &References) -> Self {
        let samples: usize = grams.iter().map(|gram| gram.samples).sum();
        let columns = grams[0].size.len();
        // Offsets and friction at zero speed are in units of the balance as they stand.
        let as_it_stands = scene.names.len()
            ..scene.names.len() + scene.recordings.len() + NEAR_ZERO.len().min(base);
        let of = |column: usize| {
            if as_it_stands.contains(&column) {
                return references.torque;
            }
            let sum: f64 = grams.iter().map(|it| it.size[column] * it.samples as f64).sum();
            let rms = (sum / samples as f64).sqrt();
            if rms > 0.0 && rms.is_finite() { 1.0 / rms } else { 0.0 }
        };
        let mut scale: Vec<f64> = (0..columns).map(of).collect();
        scale.push(1.0);
        let each = grams.iter().map(|gram| gram.products.scaled(&scale));
        Self { each: each.collect(), scale }
    }

    /// The products of the recordings that are `wanted` by whether they were held out.
    pub(crate) fn sum(&self, scene: &Scene, wanted: impl Fn(bool) -> bool) -> Products {
        let each = self.each.iter().zip(&scene.recordings).filter(|(_, it)| wanted(it.held_out));
        let none = self.each[0].scaled(&vec![0.0; self.scale.len()]);
        each.fold(none, |sum, (products, _)| sum.and(products))
    }
}
