//! Lanes of drives advanced together; a lane that meets an event is redone alone.

use drivescope_numerics::Real;

use super::dispatch::{Work, widest};
use super::step::{Stages, may_dip, step};
use super::{Integrator, Pace, Plan, State};
use crate::model::{Applied, Model, OWN, SPEED};

/// Up to this share of the lanes, one in `FEW`, those that cannot take the exact step are made
/// alone; beyond it sub-steps of the whole block cost less.
const FEW: usize = 8;

/// Advances `N` drives of one structure.
#[derive(Debug, Clone)]
pub struct Block<R, const N: usize> {
    model: Model<R, N>,
    pace: Pace,
    plan: Option<Plan<R, N>>,
    room: Stages<R, N>,
    saved: Vec<[R; N]>,
    /// One integrator a lane, for those that meet events.
    alone: Vec<Integrator<R>>,
    redo: [bool; N],
}

impl<R: Real, const N: usize> Block<R, N> {
    /// A block of those drives; `speed` is the greatest speed to expect, rad/s. Every lane
    /// takes the sub-steps that the fastest of them needs.
    pub fn new(model: Model<R, N>, speed: f64) -> Self {
        Self::with(model, Pace::Speed(speed))
    }

    /// A block whose sub-steps last at most `longest` seconds whatever the drives: a lane
    /// equals [`Integrator::paced`] bit for bit, whichever drives stand beside it.
    pub fn paced(model: Model<R, N>, longest: f64) -> Self {
        Self::with(model, Pace::Longest(longest))
    }

    fn with(model: Model<R, N>, pace: Pace) -> Self {
        let room = Stages::new(model.states());
        let saved = vec![[R::zero(); N]; model.states()];
        Self { model, pace, plan: None, room, saved, alone: Vec::new(), redo: [false; N] }
    }

    /// The drives.
    pub fn model(&self) -> &Model<R, N> {
        &self.model
    }

    /// Changes the drives' parameters.
    pub fn change(&mut self, change: impl FnOnce(&mut Model<R, N>)) {
        let states = self.model.states();
        change(&mut self.model);
        if self.model.states() != states {
            *self = Self::with(self.model.clone(), self.pace);
        }
        self.plan = None;
    }

    /// Advances every lane by `h`, the inputs held.
    pub fn advance(&mut self, state: &mut State<R, N>, applied: &Applied<R, N>, h: R) {
        if self.plan.as_ref().is_none_or(|plan| plan.h != h) {
            self.ready(h);
        }
        widest(Advance { block: self, state, applied });
        self.redo_alone(state, applied);
    }

    /// The plan for intervals of length `h`, the same for the block and for its lanes alone.
    fn ready(&mut self, h: R) {
        let steps = self.pace.substeps(&self.model, h.value());
        let plan = Plan::new(&self.model, h, steps);
        self.alone.clear();
        for l in 0..N {
            let mut alone = Integrator::with(self.model.lane(l), self.pace);
            alone.plan = Some(Plan::new(alone.model(), h, steps));
            self.alone.push(alone);
        }
        self.plan = Some(plan);
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
        let mut exact = [false; N];
        let mut next = [[R::zero(); N]; OWN];
        for way in [1.0, -1.0] {
            let Some(affine) = plan.affine(way).filter(|_| state.sign.contains(&way)) else {
                continue;
            };
            let there = affine.step(&state.x, applied);
            for l in 0..N {
                let holds = !model.dry() | affine.holds(l, &state.x, &there, applied);
                let goes = holds & (state.sign[l] == way);
                for row in 0..OWN {
                    next[row][l] = R::select(goes, there[row][l], next[row][l]);
                }
                exact[l] |= goes;
            }
        }
        let others = exact.iter().zip(&state.sign).filter(|(exact, s)| !**exact && **s != 0.0);
        if plan.forward.is_some() && others.count() <= N / FEW {
            state.x[..OWN].copy_from_slice(&next);
            for l in 0..N {
                redo[l] = !exact[l];
            }
            return;
        }
        let h = plan.h.scaled(1.0 / plan.substeps as f64);
        for l in 0..N {
            redo[l] = model.dry() && state.sign[l] == 0.0;
        }
        for k in 0..plan.substeps {
            let time = applied.time + k as f64 * h.value();
            let held = Applied { time, ..*applied };
            let before = state.x[SPEED];
            step(model, &mut state.x, &held, &state.sign, h, &plan.armature, room);
            let (after, [start, end]) = (&state.x[SPEED], room.accelerations());
            for l in 0..N {
                let sign = state.sign[l];
                let (first, last) = (before[l].value(), after[l].value());
                let [falls, rises] = [start, end].map(|slope| sign * slope[l].value() * h.value());
                let dips = may_dip((sign * first, sign * last), (falls, rises));
                let event = model.directed() & ((sign * last < 0.0) | dips);
                redo[l] |= event | plan.grain.too_coarse(l, first, last);
            }
        }
        for (values, next) in state.x.iter_mut().zip(&next) {
            for l in 0..N {
                values[l] = R::select(exact[l], next[l], values[l]);
            }
        }
        for l in 0..N {
            redo[l] &= !exact[l];
        }
    }
}
