//! Directional derivatives J v and adjoint derivatives J' w
//! (FMI 2.0.4 section 2.1.9, FMI 3.0.2 section 2.2.11).

use super::Model;
use super::exchange::finite;
use super::instance::Instance;
use super::phase::Phase;
use super::refusal::Refusal;
use super::refusal::same_length;
use crate::description::{TIME, Type};

const EVALUATED: &[Phase] = &[
    Phase::Initialization,
    Phase::Event,
    Phase::Continuous,
    Phase::Step,
    Phase::Terminated,
    Phase::Failed,
];

impl<M: Model> Instance<M> {
    /// `sensitivity[i] = sum over j of d unknowns[i] / d knowns[j] * seed[j]`.
    pub fn directional(
        &self,
        unknowns: &[u32],
        knowns: &[u32],
        seed: &[f64],
        sensitivity: &mut [f64],
    ) -> Result<(), Refusal> {
        self.check_derivative(unknowns, knowns, seed)?;
        same_length(seed.len(), knowns.len())?;
        same_length(sensitivity.len(), unknowns.len())?;
        let answer = self.model.directional(unknowns, knowns, seed);
        let answer = answer.ok_or(Refusal::NoDerivative)?;
        same_length(answer.len(), unknowns.len())?;
        sensitivity.copy_from_slice(&answer);
        Ok(())
    }

    /// `sensitivity[j] = sum over i of seed[i] * d unknowns[i] / d knowns[j]`, a column of the
    /// Jacobian at a time.
    pub fn adjoint(
        &self,
        unknowns: &[u32],
        knowns: &[u32],
        seed: &[f64],
        sensitivity: &mut [f64],
    ) -> Result<(), Refusal> {
        self.check_derivative(unknowns, knowns, seed)?;
        same_length(seed.len(), unknowns.len())?;
        same_length(sensitivity.len(), knowns.len())?;
        for (known, sensitivity) in knowns.iter().zip(sensitivity) {
            let column = self.model.directional(unknowns, &[*known], &[1.0]);
            let column = column.ok_or(Refusal::NoDerivative)?;
            *sensitivity = column.iter().zip(seed).map(|(column, seed)| column * seed).sum();
        }
        Ok(())
    }

    fn check_derivative(
        &self,
        unknowns: &[u32],
        knowns: &[u32],
        seed: &[f64],
    ) -> Result<(), Refusal> {
        self.require(EVALUATED)?;
        for reference in unknowns.iter().chain(knowns).filter(|reference| **reference != TIME) {
            self.table.variable(*reference, Type::Float64)?;
        }
        seed.iter().try_for_each(|seed| finite("a seed", *seed))
    }
}
