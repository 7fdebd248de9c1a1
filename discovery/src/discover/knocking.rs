//! The evidence of a law whose teeth knock, from what the free run predicts.
//!
//! A filter is linear about its state, and when teeth meet is not: a knock predicted a little too
//! early leaves it in the wrong place. What the free run (or the observer that was frozen for this
//! drive) predicts of a sample from those before is a probability too, with the exact moments of
//! contact. A random load stays in its errors, and what their own past predicts of them is taken out.

use drivescope_plant::effects::info::Beside;
use drivescope_plant::effects::registry::{Entry, REGISTRY};

use super::candidate::Candidate;
use super::columns::Columns;
use super::ground::Ground;
use super::judged::{Judged, Weighed};
use super::refit::{Model, refit};
use super::round::Round;
use super::whiten::Whitener;
use crate::balances::unexplained;
use crate::estimate::Evidence;
use crate::measured::Measured;

/// A law fitted in free run, with ln of its evidence over that of the base.
pub(super) struct FreeRunFit {
    pub(super) model: Model,
    /// In the recordings of the fit, in all, and in those held out.
    pub(super) evidence: [f64; 3],
    /// What it does, of what the balance holds.
    pub(super) size: f64,
}

impl FreeRunFit {
    /// As a fitted candidate of that number.
    pub(super) fn judged(self, candidate: usize) -> Judged {
        let weighed = Weighed::of(self.evidence, self.size);
        Judged::of(candidate, self.model, weighed)
    }
}

impl Round<'_> {
    /// Whether only its fit in free run tells a law: one that knocks, or is excluded by one that does,
    /// and one with states of its own where sensors beside the motor show them.
    pub(super) fn is_of_free_run(&self, it: &Candidate) -> bool {
        let knocks = |entry: &Entry| entry.info.knocks && entry.info.excludes.contains(&it.info.id);
        it.info.knocks || REGISTRY.iter().any(knocks) || self.acts_beside(it)
    }

    /// Whether sensors beside the motor were recorded that show its own states: the motor's balance does
    /// not tell its size, and the filter does not look at them.
    pub(super) fn acts_beside(&self, it: &Candidate) -> bool {
        self.sensors_beside().any(|sensor| it.shows_on(sensor))
    }

    /// Sensors beside the motor that were recorded.
    fn sensors_beside(&self) -> impl Iterator<Item = Beside> {
        let outputs = self.estimation.recordings.iter().flat_map(|it| &it.outputs);
        outputs.filter_map(|channel| channel.output.beside())
    }

    /// Nothing where no fit ends, or the filter sees not every sample, which are not to be compared.
    /// `variants` are shapes of the law, the most promising first; `other` is the squared error that
    /// another law leaves.
    pub(super) fn fit_of_free_run(
        &self,
        ground: &Ground,
        it: &Candidate,
        variants: &[usize],
        other: Option<f64>,
    ) -> Option<FreeRunFit> {
        let ground = ground.filtered()?;
        if ground.scene.is_reduced(self.estimation, self.validation) {
            return None;
        }
        let (estimation, validation) = (self.estimation, self.validation);
        let seen = |_| self.watch.stopped();
        let model = refit(self.model, (it, variants), other, estimation, validation, &seen)?;
        let base = &self.model.fitted;
        // No inverse is told of what has a mass behind teeth: of the torque that the base leaves
        // unexplained it has as much as of the error. Without a balance the random load is that torque.
        let random = || {
            let load = ground.load();
            load.oscillation.map_or(load.sd, |it| it.sd.hypot(load.sd))
        };
        let balance = unexplained(&base.drive, estimation)[0];
        let remainder = balance.map_or_else(random, |it| it.rms);
        let kept = model.fitted.squares.sum / base.squares.sum;
        let size = remainder * (1.0 - kept).max(0.0).sqrt() / ground.references.torque;
        let [own, others] = self.ln_probabilities(&model);
        // A filter knows less of each reversal than a free run, and nothing of what stands beside the
        // motor: the base is the better of both where they speak of the same. Its evidence holds the
        // price of its parameters; Laplace's of a single one is this.
        let parameters = model.fitted.parameters.len() as f64;
        let price = 0.5 * parameters * (model.fitted.squares.values as f64).ln();
        let [before, rest] = self.ln_probabilities(self.model);
        let both = before + rest;
        let looks_beside = self.sensors_beside().next().is_some();
        let by_filter = |evidence: f64| if looks_beside { f64::MIN } else { evidence };
        let fitted = own - price - before.max(by_filter(ground.base.fitted));
        let all = own + others - price - both.max(by_filter(ground.base.all));
        Some(FreeRunFit { model, evidence: [fitted, all, all - fitted], size })
    }

    /// ln of the probability of the estimation data in free run, without its constant, and of those
    /// that judge: of what the past of the errors does not predict of them, for a random load
    /// stays in them.
    fn ln_probabilities(&self, model: &Model) -> [f64; 2] {
        let own = Columns::residuals(&model.at(self.estimation));
        let whitener = Whitener::of(&own.places, &own.residual);
        let others = Columns::residuals(&model.at_others(self.validation));
        [
            whitener.ln_probability(&own.places, &own.residual) - ln_noise(self.estimation),
            whitener.ln_probability(&others.places, &others.residual) - ln_noise(self.validation),
        ]
    }
}

/// ln of the sizes of the noise of all that was measured, summed.
fn ln_noise(evidence: &Evidence) -> f64 {
    let each = evidence.recordings.iter().zip(&evidence.noise);
    let of = |(measured, noise): (&Measured, &Vec<f64>)| -> f64 {
        let known = measured.outputs.iter().zip(noise);
        known.map(|(channel, sd)| measured.values_of(channel) as f64 * sd.ln()).sum()
    };
    each.map(of).sum()
}
