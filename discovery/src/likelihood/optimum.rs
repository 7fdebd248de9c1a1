//! The evidence of a drive with a law in it, fitted: linearised at its own optimum.
//!
//! At its null a law that is far from linear is judged by a poor column. With the law in the drive
//! and everything fitted, the columns are those of the law as it is; the prior of its coefficients
//! still stands around their null.

use rayon::prelude::*;

use super::base::{Further, Known, Pooled, grams, parameters, terms};
use super::columns::{Pass, Series, Source};
use super::gram::{Products, References};
use super::marginal::{Terms, coefficients, ln_mean_exp, log_evidence, standing_out};
use super::scene::{Recorded, Scene};
use super::share::Share;
use super::state::own_states;
use super::stepper::stepped;
use super::track::Track;
use super::weighing::SIZES;

/// What is added to the law of the base, in a fitted drive.
pub(crate) struct Law<'a> {
    /// Its name in the drive.
    pub(crate) id: &'a str,
    /// Its coefficients, which are 0 where it vanishes.
    pub(crate) coefficients: &'a [String],
}

/// A curve that stands in the background: its series in each recording, and the standard deviation of
/// its values, of the balance's size.
pub(super) struct BackgroundCurve {
    pub(super) series: Vec<Vec<Series>>,
    pub(super) sd: f64,
}

/// ln of the evidence of the recordings of the fit, and of these with those held out.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Optimum {
    pub(crate) fitted: f64,
    pub(crate) all: f64,
    /// Of those held out, given the others.
    pub(crate) repeats: f64,
    /// Root of the mean square of what the law does, of the balance's size.
    pub(crate) size: f64,
    /// By how much all recordings together move a parameter of the machine at most, ln.
    pub(super) moves: f64,
}

impl Optimum {
    /// `fitted`, `all` and `repeats` over those of a base.
    pub(crate) fn over(&self, base: &Self) -> [f64; 3] {
        [self.fitted - base.fitted, self.all - base.all, self.repeats - base.repeats]
    }

    /// With ln of the prior odds of what it has beside a law.
    pub(super) fn with_prior(self, ln_prior: f64) -> Self {
        Self { fitted: self.fitted + ln_prior, all: self.all + ln_prior, ..self }
    }

    /// The same where all recordings are as they are in another.
    pub(super) fn with_all_of(self, other: &Self) -> Self {
        Self { all: other.all, repeats: other.repeats, ..self }
    }
}

/// A law, and what is lost in each recording without it.
pub(super) type TakenOut<'a> = (&'a Law<'a>, &'a [Vec<Share>]);

impl Law<'_> {
    /// Shares of what is lost in each recording where the law is taken out of the drive.
    pub(super) fn taken_out(&self, scene: &Scene, tracks: &[Track]) -> Vec<Vec<Share>> {
        let one = |(it, track): (&Recorded, &Track)| {
            let mut without = it.drive.clone();
            without.effects.retain(|effect| effect.id != self.id);
            let (known, shared) = (own_states(&it.drive), own_states(&without));
            let ticks = &track.ticks;
            let from = stepped(&it.drive, &it.measured, known, scene.longest_s, ticks);
            let longest_s = scene.longest_s;
            let source = Source::Difference { of: &without, from: &from, shared, longest_s };
            Pass::new(&it.drive, it.recording(), source).all(track)
        };
        scene.recordings.par_iter().zip(tracks).map(one).collect()
    }
}

/// What is known of a law before the recordings: around 0 for its coefficients.
pub(super) struct Prior {
    /// Values of its coefficients in the units of their columns.
    values: Vec<f64>,
    /// Places of its coefficients, and of all its parameters.
    coefficients: Vec<usize>,
    all: Vec<usize>,
}

impl Prior {
    /// Of a law in a scene whose columns have that `scale`; its shapes, known to a factor, get their
    /// variances among the terms.
    pub(super) fn of(law: &Law<'_>, scene: &Scene, scale: &[f64], terms: &mut Terms) -> Self {
        let mut prior =
            Self { values: vec![0.0; terms.columns.len()], coefficients: vec![], all: vec![] };
        let known = scene.drive.parameters();
        for (place, name) in scene.names.iter().enumerate() {
            let Some(("", parameter)) =
                name.strip_prefix(law.id).map(|it| it.split_once('.').unwrap_or(("none", "")))
            else {
                continue;
            };
            prior.all.push(place);
            let value = known.iter().find(|it| it.name == *name).map_or(0.0, |it| it.value);
            if law.coefficients.iter().any(|it| it == parameter) {
                prior.coefficients.push(place);
                prior.values[place] = value / scale[place];
            } else {
                let relative = value.abs() / scale[place];
                terms.variances[place] = (relative * relative).clamp(1e-12, 1e12);
            }
        }
        prior
    }

    /// Those of the terms that are not the law's.
    pub(super) fn others(&self, terms: Terms) -> Terms {
        let each = terms.columns.iter().zip(&terms.variances);
        let (columns, variances) = each.filter(|(column, _)| !self.all.contains(column)).unzip();
        Terms { columns, variances }
    }
}

/// ln of the evidence of the terms over that of no column, averaged over the sizes of a law's
/// coefficients.
pub(super) fn evidence(products: Products, terms: &Terms, prior: Option<&Prior>) -> f64 {
    let Some(prior) = prior else { return log_evidence(&products, terms) };
    let (products, moved) = products.shifted(&prior.values);
    let of = |size: f64| {
        let mut terms: Terms = terms.clone();
        for place in &prior.coefficients {
            terms.variances[*place] = size * size;
        }
        log_evidence(&products, &terms)
    };
    let none = prior.coefficients.is_empty();
    moved + if none { of(1.0) } else { ln_mean_exp(SIZES.map(of).into_iter()) }
}

/// Of the scene's drive along those tracks, with the shares of its parameters and of what is lost
/// without the law, `beside` a curve perhaps; nothing where it overflows.
pub(super) fn optimum(
    scene: &Scene,
    (law, beside): (Option<TakenOut<'_>>, Option<&BackgroundCurve>),
    (tracks, known): (&[Track], &[Known]),
    references: &References,
) -> Option<Optimum> {
    let further = |recording: usize| {
        let background = beside.map(|it| Source::Series(&it.series[recording]));
        let of_law = law.map(|(_, out)| Source::Given { shares: &out[recording], count: 1 });
        Further {
            groups: if of_law.is_some() { &[1] } else { &[] },
            background: background.into_iter().collect(),
            judged: of_law.into_iter().collect(),
        }
    };
    let filters = [tracks];
    let grams = grams(scene, &filters, references, Some(known), further, &|| false).swap_remove(0);
    let law = law.map(|(law, _)| law);
    let mut terms = terms(scene);
    if let Some(it) = beside {
        let known = terms.columns.len();
        let columns: Vec<usize> = (known..known + it.series[0].len()).collect();
        terms = terms.with(&columns, it.sd * it.sd);
    }
    let base = terms.columns.len();
    let pooled = Pooled::of(&grams, base, scene, references);
    let prior = law.map(|law| Prior::of(law, scene, &pooled.scale, &mut terms));
    let likelihood = |wanted: &dyn Fn(bool) -> bool| -> f64 {
        let each = scene.recordings.iter().zip(tracks).filter(|(it, _)| wanted(it.held_out));
        each.map(|(_, track)| track.log_likelihood).sum()
    };
    let evidence = |wanted: &dyn Fn(bool) -> bool| {
        likelihood(wanted) + evidence(pooled.sum(scene, wanted), &terms, prior.as_ref())
    };
    let size = if let Some(prior) = &prior {
        let samples: usize = grams.iter().map(|gram| gram.samples).sum();
        let sum: f64 = grams.iter().map(|it| it.size[base] * it.samples as f64).sum();
        let others = prior.others(parameters(scene));
        (sum / samples as f64).sqrt() * standing_out(&pooled.sum(scene, |_| true), &others, base)
    } else {
        0.0
    };
    let (fitted, all) = (evidence(&|held_out| !held_out), evidence(&|_| true));
    Some(Optimum { fitted, all, repeats: all - fitted, size, moves: moves(scene, &pooled, &terms) })
}

/// By how much all recordings together move a parameter of the machine that is positive, ln, where
/// the plant is as it was linearised.
fn moves(scene: &Scene, pooled: &Pooled, terms: &Terms) -> f64 {
    let Some(mean) = coefficients(&pooled.sum(scene, |_| true), terms) else { return 0.0 };
    let known = scene.drive.parameters();
    let each = scene.names.iter().zip(mean.iter().zip(&pooled.scale));
    let moved = each.filter_map(|(name, (mean, scale))| {
        let it = known.iter().find(|it| it.name == *name)?;
        let positive = it.range.0 >= 0.0 && it.value > 0.0;
        positive.then(|| (mean * scale / it.value).abs())
    });
    moved.fold(0.0, f64::max)
}
