//! Lanes of drives advanced together; a lane that meets an event is redone alone.

use drivescope_numerics::Real;

use super::dispatch::{Work, widest};
use super::step::{Stages, step};
use super::{Integrator, Plan, State, substeps};
use crate::model::{Applied, Model, OWN, SPEED};

/// Advances `N` drives of one structure.
#[derive(Debug, Clone)]
pub struct Block<R, const N: usize> {
    model: Model<R, N>,
    speed: f64,
    plan: Option<Plan<R, N>>,
    room: Stages<R, N>,
    saved: Vec<[R; N]>,
    /// One integrator a lane, for those that meet events.
    alone: Vec<Integrator<R>>,
    redo: [bool; N],
}

impl<R: Real, const N: usize> Block<R, N> {
    /// A block of those drives; `speed` is the greatest speed to expect, rad/s.
    pub fn new(model: Model<R, N>, speed: f64) -> Self {
        let room = Stages::new(model.states());
        let alone = (0..N).map(|l| Integrator::new(model.lane(l), speed)).collect();
        let saved = vec![[R::zero(); N]; model.states()];
        Self { model, speed, plan: None, room, saved, alone, redo: [false; N] }
    }

    /// The drives.
    pub fn model(&self) -> &Model<R, N> {
        &self.model
    }

    /// Changes the drives' parameters.
    pub fn change(&mut self, change: impl FnOnce(&mut Model<R, N>)) {
        change(&mut self.model);
        self.plan = None;
        self.alone = (0..N).map(|l| Integrator::new(self.model.lane(l), self.speed)).collect();
    }

    /// Advances every lane by `h`, the inputs held. Every lane takes the sub-steps that the
    /// fastest of them needs.
    pub fn advance(&mut self, state: &mut State<R, N>, applied: &Applied<R, N>, h: R) {
        if self.plan.as_ref().is_none_or(|plan| plan.h != h) {
            let steps = substeps(&self.model, h.value(), self.speed);
            self.plan = Some(Plan::new(&self.model, h, steps));
            for alone in &mut self.alone {
                alone.plan = None;
                alone.ready(h, Some(steps));
            }
        }
        widest(Advance { block: self, state, applied });
        self.redo_alone(state, applied);
    }

    fn redo_alone(&mut self, state: &mut State<R, N>, applied: &Applied<R, N>) {
        for l in 0..N {
            if !self.redo[l] {
                continue;
            }
            let mut alone = State {
                x: self.saved.iter().map(|values| [values[l]]).collect(),
                sign: [state.sign[l]],
            };
            let held = Applied { u: [applied.u[l]], load: [applied.load[l]], time: applied.time };
            self.alone[l].advance_planned(&mut alone, &held);
            state.sign[l] = alone.sign[0];
            for (values, value) in state.x.iter_mut().zip(&alone.x) {
                values[l] = value[0];
            }
        }
    }
}

/// One interval of a block.
struct Advance<'a, R, const N: usize> {
    block: &'a mut Block<R, N>,
    state: &'a mut State<R, N>,
    applied: &'a Applied<R, N>,
}

impl<R: Real, const N: usize> Work for Advance<'_, R, N> {
    #[inline(always)]
    fn run(self) {
        let Self { block, state, applied } = self;
        let Block { model, plan, room, saved, redo, .. } = block;
        let Some(plan) = plan else { return };
        saved.copy_from_slice(&state.x);
        // The block moves as its first lane does; lanes that move otherwise are redone alone.
        let sign = state.sign[0];
        if let Some(affine) = plan.affine(sign) {
            let next = affine.step(&state.x, applied);
            for l in 0..N {
                let holds = !model.dry()
                    || (state.sign[l] == sign && affine.holds(l, &state.x, &next, applied));
                redo[l] = !holds;
            }
            state.x[..OWN].copy_from_slice(&next);
            return;
        }
        if model.dry() && sign == 0.0 && plan.forward.is_some() {
            // Near rest in an affine drive the scalar run decides step by step.
            *redo = [true; N];
            return;
        }
        let h = plan.h.scaled(1.0 / plan.substeps as f64);
        for l in 0..N {
            redo[l] = model.dry() && state.sign[l] == 0.0;
        }
        for k in 0..plan.substeps {
            let time = applied.time + k as f64 * h.value();
            let held = Applied { time, ..*applied };
            step(model, &mut state.x, &held, &state.sign, h, &plan.armature, room);
            if model.dry() {
                for l in 0..N {
                    redo[l] |= state.sign[l] * state.x[SPEED][l].value() < 0.0;
                }
            }
        }
    }
}
