//! The base of a round, as evidence is counted from it: the motion that torques make, or the torque of
//! a motion that is known.

use drivescope_plant::drive::{Drive, EffectData};
use drivescope_plant::effects::grid::Spans;

use super::candidate::Candidate;
use super::curves::Curve;
use super::refit::Model;
use super::report::RandomLoad;
use crate::estimate::Evidence;
use crate::formula::{self, Formula};
use crate::likelihood::{
    CurveWeight, Filtered, Inverse, Law, Optimum, Randomness, Scene, Weights, weigh,
};

/// A drive at its own best.
pub(crate) enum Ground {
    /// Filtered: what was measured is predicted from what drives.
    Filtered(Box<Filtered>),
    /// Read backwards: what drives is predicted from the motion.
    Inverse(Box<Inverse>),
}

impl Ground {
    /// Read backwards where that can be; `randomness` is what is random beside a drive that lacked
    /// more, where that is known. Nothing where the drive overflows.
    pub(crate) fn of(
        model: &Model,
        (estimation, validation): (&Evidence, &Evidence),
        randomness: Option<Randomness>,
    ) -> Option<Self> {
        if let Some(inverse) = Inverse::of(Scene::whole(model, estimation, validation)) {
            return Some(Self::Inverse(Box::new(inverse)));
        }
        let scene = Scene::of(model, estimation, validation);
        Filtered::of(scene, randomness).map(|it| Self::Filtered(Box::new(it)))
    }

    /// The filter, where it is one.
    pub(crate) fn filtered(&self) -> Option<&Filtered> {
        match self {
            Self::Filtered(it) => Some(it),
            Self::Inverse(_) => None,
        }
    }

    fn scene(&self) -> &Scene {
        match self {
            Self::Filtered(it) => &it.scene,
            Self::Inverse(it) => &it.scene,
        }
    }

    /// The drive of its fit.
    pub(crate) fn drive(&self) -> &Drive {
        &self.scene().drive
    }

    /// Evidence of the base.
    pub(crate) fn base(&self) -> &Optimum {
        match self {
            Self::Filtered(it) => &it.base,
            Self::Inverse(it) => &it.base,
        }
    }

    /// What is random in the load.
    pub(crate) fn load(&self) -> RandomLoad {
        match self {
            Self::Filtered(it) => it.load(),
            Self::Inverse(it) => it.load(),
        }
    }

    /// Where a search for what is random begins in a drive that lacks less.
    pub(crate) fn randomness(&self) -> Option<Randomness> {
        self.filtered().map(Filtered::broad)
    }

    /// Whether it can tell of that candidate.
    pub(crate) fn tells(&self, candidate: &Candidate) -> bool {
        match self {
            Self::Filtered(_) => true,
            Self::Inverse(it) => it.tells(candidate),
        }
    }

    /// What every candidate that it can tell of, and every curve, would explain.
    pub(crate) fn weigh(
        &self,
        candidates: &[Candidate],
        spans: &Spans,
        tolerated: impl Fn(&Curve) -> Option<f64> + Sync,
        stopped: &(dyn Fn() -> bool + Sync),
    ) -> Option<Weights> {
        match self {
            Self::Filtered(it) => {
                let (randomnesses, references) = (it.randomnesses(), &it.references);
                weigh(&it.scene, &randomnesses, references, candidates, spans, tolerated, stopped)
            }
            Self::Inverse(it) => it.weigh(candidates, spans, tolerated),
        }
    }

    /// The drive with one of those effects at its own best, and the evidence there.
    pub(crate) fn with(
        &self,
        effects: &[EffectData],
        estimated: &[String],
        coefficients: &[String],
    ) -> Option<(Drive, Optimum)> {
        match self {
            Self::Filtered(it) => {
                let (scene, optimum) = it.with(effects, estimated, coefficients)?;
                Some((scene.drive, optimum))
            }
            Self::Inverse(it) => it.with(effects, estimated, coefficients),
        }
    }

    /// The same where every recording has a disturbance of its own of that law.
    pub(crate) fn beside(&self, law: &EffectData, coefficients: &[String]) -> Option<Self> {
        match self {
            Self::Filtered(it) => {
                it.beside(law, coefficients).map(|it| Self::Filtered(Box::new(it)))
            }
            Self::Inverse(it) => it.beside(law, coefficients).map(|it| Self::Inverse(Box::new(it))),
        }
    }

    /// ln of the evidence of a law, fitted in that drive, in all recordings, where a curve explains
    /// what it can; nothing where the drive overflows.
    pub(crate) fn beside_curve(
        &self,
        drive: &Drive,
        law: &Law<'_>,
        estimated: &[String],
        curve: &CurveWeight,
    ) -> Option<f64> {
        let effect = drive.effects.iter().find(|effect| effect.id == law.id)?;
        let scene = self.scene();
        let with = scene.with(effect, estimated.iter().cloned()).with_values_in(drive);
        let of = |scene: &Scene, law: Option<&Law<'_>>| match self {
            Self::Filtered(it) => it.beside_curve(scene, law, curve),
            Self::Inverse(it) => it.beside_curve(scene, law, curve),
        };
        Some(of(&with, Some(law))?.all - of(scene, None)?.all)
    }

    /// Formulas for what nobody knows, of more than that evidence.
    pub(crate) fn formulas(&self, asked: f64, stopped: &(dyn Fn() -> bool + Sync)) -> Vec<Formula> {
        self.filtered().map_or_else(Vec::new, |it| formula::formulas(it, asked, stopped))
    }
}
