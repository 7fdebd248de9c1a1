//! An effect that may be missing.
//!
//! A candidate stands in the drive at its null, where it changes nothing, and is differentiated
//! by its coefficients there. What the derivative depends on besides (the number of periods of a
//! ripple, a Stribeck speed, a time constant) is a grid of variants, scaled to this drive and
//! these recordings. Effects that vanish at an infinite stiffness have no derivative at their
//! null: their variants are points from which a short refit begins.

use drivescope_plant::drive::{Drive, EffectData};
use drivescope_plant::effects::info::Beside;
use drivescope_plant::effects::law::{Info, Variable};
use drivescope_plant::effects::registry::Entry;

/// An effect at its null with one choice of its shape.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Variant {
    /// Its parameters, the coefficients at their nulls.
    pub(crate) effect: EffectData,
}

/// An effect that may be missing.
#[derive(Debug, Clone)]
pub(crate) struct Candidate {
    /// What it is called in answers: its kind, or the name that the user gave a typed law.
    pub(crate) name: String,
    /// What is known of its kind.
    pub(crate) info: &'static Info,
    /// The variables over which a model without it fails.
    pub(crate) fails_over: Vec<Variable>,
    /// Its name in the drive.
    pub(crate) id: String,
    /// The coefficients that vanish at the null; none where the null is infinite.
    pub(crate) coefficients: Vec<String>,
    /// Least and greatest value of each coefficient.
    pub(crate) ranges: Vec<(f64, f64)>,
    /// Choices of its shape, at least one.
    pub(crate) variants: Vec<Variant>,
    /// Parameters that stay as the variant has them: whole numbers.
    pub(crate) frozen: Vec<&'static str>,
}

impl Candidate {
    /// Whether the user typed it.
    pub(crate) fn is_typed(&self) -> bool {
        self.variants[0].effect.law.is_some()
    }

    /// Its parameters.
    pub(crate) fn parameters(&self) -> impl ExactSizeIterator<Item = &str> {
        self.variants[0].effect.parameters.iter().map(|(name, _)| name.as_str())
    }

    /// Names in the drive of its parameters that are estimated.
    pub(crate) fn estimated(&self) -> Vec<String> {
        let free = self.parameters().filter(|name| !self.frozen.contains(name));
        free.map(|name| format!("{}.{name}", self.id)).collect()
    }

    /// An effect of its kind with coefficients times a factor.
    pub(crate) fn scaled(&self, effect: &EffectData, factor: f64) -> EffectData {
        let mut scaled = effect.clone();
        let own = scaled.parameters.iter_mut().filter(|(it, _)| self.coefficients.contains(it));
        own.for_each(|(_, value)| *value *= factor);
        scaled
    }

    /// Whether all its coefficients are 0 in that drive.
    pub(crate) fn vanishes_in(&self, drive: &Drive) -> bool {
        let own = drive.effects.iter().find(|effect| effect.id == self.id);
        let is_zero = |name: &String| {
            let parameters = own.into_iter().flat_map(|effect| &effect.parameters);
            parameters.filter(|(it, _)| it == name).all(|(_, value)| *value == 0.0)
        };
        own.is_some() && self.is_linear() && self.coefficients.iter().all(is_zero)
    }

    /// Whether it has a derivative at its null.
    pub(crate) fn is_linear(&self) -> bool {
        !self.coefficients.is_empty()
    }

    /// Whether it is a torque, a voltage or a flux of the motor: it changes no sensor and delays nothing.
    pub(crate) fn acts_at_motor(&self) -> bool {
        !self.info.senses() && !self.info.delays
    }

    /// Whether that sensor beside the motor shows one of its own states.
    pub(crate) fn shows_on(&self, sensor: Beside) -> bool {
        let shows = |entry: &Entry| entry.states.iter().any(|it| it.beside == Some(sensor));
        Entry::find(self.info.id).is_some_and(shows)
    }

    /// Whether it parts the load from the motor, so that the load moves by itself.
    pub(crate) fn has_load(&self) -> bool {
        Entry::find(self.info.id).is_some_and(Entry::has_load)
    }

    /// The drive with this variant in it.
    pub(crate) fn added(&self, drive: &Drive, variant: &Variant) -> Drive {
        let mut with = drive.clone();
        with.effects.push(variant.effect.clone());
        for name in &self.frozen {
            with.fixed.push(format!("{}.{name}", self.id));
        }
        with
    }
}
