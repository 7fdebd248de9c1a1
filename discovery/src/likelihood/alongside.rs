//! What known torques and voltages would explain beside the base, thousands of them at little cost:
//! of each only its products with the base, the data and itself are kept.

use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;

use super::base::{Further, Known, Pooled, grams, terms};
use super::columns::{Series, Source};
use super::gram::References;
use super::ground::Filtered;
use super::guess::excerpt;
use super::marginal::{Beside, ln_mean_exp, log_evidence};
use super::scene::{Recorded, Scene};
use super::track::{Tick, Track};
use super::weigh::{Filtering, filtered};
use super::weighing::SIZES;

/// Columns of a source: sources are filtered in parallel.
const A_SOURCE: usize = 32;

/// The base in an excerpt of the recordings of the fit, filtered with each of the randomnesses with which laws
/// are weighed.
pub(crate) struct Alongside {
    scene: Scene,
    references: References,
    known: Vec<Known>,
    filters: Vec<Filtering>,
}

/// What the recordings tell of a group of columns.
#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct GroupEvidence {
    /// ln of the evidence over that of the base, averaged over sizes.
    pub(crate) evidence: f64,
    /// The most probable coefficients, in their own units.
    pub(crate) coefficients: Vec<f64>,
}

impl Alongside {
    /// Nothing where the drive overflows.
    pub(crate) fn of(ground: &Filtered) -> Option<Self> {
        Self::along(excerpt(&ground.scene), ground)
    }

    /// The same along all of the recordings of the fit.
    pub(crate) fn fitted(ground: &Filtered) -> Option<Self> {
        Self::along(ground.scene.fitted(), ground)
    }

    fn along(scene: Scene, ground: &Filtered) -> Option<Self> {
        let filters = filtered(&scene, &ground.randomnesses())?;
        let known = Known::of(&scene, &filters[0].tracks);
        Some(Self { scene, references: ground.references, known, filters })
    }

    /// The recordings with their tracks.
    pub(crate) fn recordings(&self) -> impl Iterator<Item = (&Recorded, &[Tick])> {
        let ticks = self.filters[0].tracks.iter().map(|track| track.ticks.as_slice());
        self.scene.recordings.iter().zip(ticks)
    }

    /// What is told of each group of so many of the `series` of a recording, each with the
    /// randomness with which it explains most; nothing where it is stopped.
    pub(crate) fn evidence(
        &self,
        series: impl Fn(usize) -> Vec<Series> + Sync,
        groups: &[usize],
        stopped: &(dyn Fn() -> bool + Sync),
    ) -> Option<Vec<GroupEvidence>> {
        let each = self.under_each(series, groups, stopped, group_evidence)?;
        let most = most(&each);
        let of = |group: usize| {
            let under = |(base, each_group): &(f64, Vec<GroupEvidence>)| {
                let GroupEvidence { evidence, coefficients } = each_group[group].clone();
                GroupEvidence { evidence: evidence + base - most, coefficients }
            };
            let best = each.iter().map(under).max_by(|a, b| a.evidence.total_cmp(&b.evidence));
            best.unwrap_or_default()
        };
        Some((0..groups.len()).map(of).collect())
    }

    /// ln of the ratio of the greatest likelihood with each group to that of the base, each with the
    /// randomness with which it is most.
    pub(crate) fn log_ratios(
        &self,
        series: impl Fn(usize) -> Vec<Series> + Sync,
        groups: &[usize],
    ) -> Option<Vec<f64>> {
        let each = self.under_each(series, groups, &|| false, log_ratio)?;
        let most = most(&each);
        let of = |group: usize| {
            let under = each.iter().map(|(base, ratios)| base + ratios[group] - most);
            under.fold(f64::NEG_INFINITY, f64::max)
        };
        Some((0..groups.len()).map(of).collect())
    }

    /// ln of the evidence of the base with each of the randomnesses, and what the information and the
    /// score of each group say beside it, with the scales of their units.
    fn under_each<T>(
        &self,
        series: impl Fn(usize) -> Vec<Series> + Sync,
        groups: &[usize],
        stopped: &(dyn Fn() -> bool + Sync),
        of: impl Fn(&DMatrix<f64>, &DVector<f64>, &[f64]) -> T,
    ) -> Option<Vec<(f64, Vec<T>)>> {
        let recordings = 0..self.scene.recordings.len();
        let series: Vec<Vec<Series>> = recordings.into_par_iter().map(&series).collect();
        let sources = sources(groups);
        let further = |recording: usize| {
            let mut from = 0;
            let source = |count: &usize| {
                from += count;
                Source::Series(&series[recording][from - count..from])
            };
            Further { judged: sources.iter().map(source).collect(), groups, ..Further::default() }
        };
        let filters: Vec<&[Track]> = self.filters.iter().map(|it| it.tracks.as_slice()).collect();
        let (scene, known) = (&self.scene, Some(self.known.as_slice()));
        let grams = grams(scene, &filters, &self.references, known, further, stopped);
        if stopped() {
            return None;
        }
        let terms = terms(scene);
        let base = terms.columns.len();
        let under = |(grams, it): (&Vec<_>, &Filtering)| {
            let pooled = Pooled::of(grams, base, scene, &self.references);
            let products = pooled.sum(scene, |_| true);
            let likelihood: f64 = it.tracks.iter().map(|track| track.log_likelihood).sum();
            let beside = Beside::of(&products, &terms)?;
            let mut from = base;
            let each = groups.iter().map(|count| {
                from += count;
                let columns: Vec<usize> = (from - count..from).collect();
                let (information, score) = beside.information_and_score(&products, &columns);
                let scale: Vec<f64> = columns.iter().map(|it| pooled.scale[*it]).collect();
                of(&information, &score, &scale)
            });
            let base = likelihood + it.ln_prior + log_evidence(&products, &terms);
            Some((base, each.collect()))
        };
        Some(grams.iter().zip(&self.filters).filter_map(under).collect())
    }
}

/// The greatest evidence of the base.
fn most<T>(each: &[(f64, T)]) -> f64 {
    each.iter().map(|(base, _)| *base).fold(f64::NEG_INFINITY, f64::max)
}

/// Counts of columns that hold whole groups.
fn sources(groups: &[usize]) -> Vec<usize> {
    let mut sources = vec![0];
    for count in groups {
        match sources.last_mut() {
            Some(last) if *last + count <= A_SOURCE || *last == 0 => *last += count,
            _ => sources.push(*count),
        }
    }
    sources
}

/// Share of the information of a column that is added to it: what others imitate as closely tells
/// nothing.
const RIDGE: f64 = 1e-9;

/// ln of the ratio of likelihoods that columns of that information and score are worth at their best.
fn log_ratio(information: &DMatrix<f64>, score: &DVector<f64>, _: &[f64]) -> f64 {
    let mut h = information.clone();
    (0..h.nrows()).for_each(|k| h[(k, k)] += RIDGE * h[(k, k)].abs() + f64::MIN_POSITIVE);
    let half = h.cholesky().and_then(|it| it.l().solve_lower_triangular(score));
    half.map_or(0.0, |half| 0.5 * half.norm_squared())
}

/// Of columns of that information and score, in units of which those are the scales.
fn group_evidence(
    information: &DMatrix<f64>,
    score: &DVector<f64>,
    scale: &[f64],
) -> GroupEvidence {
    let with = |size: f64| {
        let mut h = information.clone();
        (0..h.nrows()).for_each(|k| h[(k, k)] += 1.0 / (size * size));
        h.cholesky()
    };
    let of = |size: &f64| {
        let Some(h) = with(*size) else { return f64::NAN };
        let half = h.l().solve_lower_triangular(score).map_or(f64::NAN, |it| it.norm_squared());
        let ln_determinant: f64 = h.l_dirty().diagonal().iter().map(|it| it.ln()).sum();
        0.5 * half - ln_determinant - scale.len() as f64 * size.ln()
    };
    // A column of nothing, or one that overflows, tells nothing.
    if scale.contains(&0.0) {
        return GroupEvidence { evidence: f64::NEG_INFINITY, coefficients: vec![0.0; scale.len()] };
    }
    let mean = with(1.0).map(|h| h.solve(score));
    let coefficient = |(k, scale): (usize, &f64)| mean.as_ref().map_or(0.0, |mean| mean[k] * scale);
    GroupEvidence {
        evidence: ln_mean_exp(SIZES.iter().map(of)),
        coefficients: scale.iter().enumerate().map(coefficient).collect(),
    }
}
