//! Lanes of drives advanced together; a lane that meets an event is redone alone.

use drivescope_numerics::Real;
use drivescope_numerics::dispatch::{Work, widest};

use super::step::{Stages, may_dip, step};
use super::{Integrator, Pace, Plan, State, all, within_budget};
use crate::model::{Applied, Model, OWN, Rows, SPEED, zeros};

/// Up to this share of the lanes, one in `FEW`, those that cannot take the exact step are made
/// alone; beyond it sub-steps of the whole block cost less.
const FEW: usize = 8;

/// Advances `N` drives of one structure.
#[derive(Debug, Clone)]
pub struct Block<R, const N: usize> {
    pub(super) model: Model<R, N>,
    pub(super) pace: Pace,
    pub(super) plan: Option<Plan<R, N>>,
    room: Stages<R, N>,
    saved: Rows<R, N>,
    /// The state during sub-steps.
    moving: Rows<R, N>,
    /// One integrator a lane, once that has met an event.
    pub(super) alone: Vec<Option<Integrator<R>>>,
    /// The state of a lane that is made alone.
    one: State<R, 1>,
    /// 1 where the sub-steps do not stand: a number, so that a loop over it is vector code.
    redo: [u64; N],
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
        let saved = zeros(model.states());
        let moving = zeros(model.states());
        let one = State { sign: [0.0], x: zeros(model.states()) };
        Self { model, pace, plan: None, room, saved, moving, alone: Vec::new(), one, redo: [0; N] }
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
        widest(Advance { block: self, state, applied, h });
    }

    /// The same as part of work that is compiled for an instruction set already.
    #[inline(always)]
    pub(super) fn advance_inlined(
        &mut self,
        state: &mut State<R, N>,
        applied: &Applied<R, N>,
        h: R,
    ) {
        if self.plan.as_ref().is_none_or(|plan| plan.h != h) {
            self.ready(h);
        }
        let Some(plan) = &self.plan else { return };
        if !plan.exact(state, applied) {
            widest(Apart { block: self, state, applied });
        }
    }

    /// The plan for intervals of length `h`; the lanes alone make theirs when they need it.
    #[cold]
    fn ready(&mut self, h: R) {
        let steps = within_budget(self.pace.substeps(&self.model, h.value()));
        self.plan = Some(Plan::new(&self.model, h, steps));
        self.alone = vec![None; N];
    }

    /// Makes the lanes that the exact step does not take, the others taking it.
    #[inline(never)]
    fn advance_others(
        &mut self,
        state: &mut State<R, N>,
        applied: &Applied<R, N>,
        exact: &Exact<R, N>,
    ) {
        let Some(plan) = &self.plan else { return };
        self.saved.copy_from_slice(&state.x);
        let lanes = exact.lanes.iter().zip(&state.sign);
        let others = lanes.filter(|(exact, sign)| **exact == 0 && **sign != 0.0).count();
        if plan.whole_spans || plan.forward.is_some() && others <= N / FEW {
            state.x[..OWN].copy_from_slice(&exact.next);
            self.redo = [1; N];
        } else {
            widest(SubSteps { block: self, state, applied });
            exact.put_into(&mut state.x);
        }
        for l in 0..N {
            if self.redo[l] == 1 && exact.lanes[l] == 0 {
                self.redo_alone(l, state, applied);
            }
        }
    }

    /// Makes lane `l` anew from the saved state, by the automaton.
    fn redo_alone(&mut self, l: usize, state: &mut State<R, N>, applied: &Applied<R, N>) {
        let Some(plan) = &self.plan else { return };
        let integrator = self.alone[l].get_or_insert_with(|| {
            let mut made = Integrator::with(self.model.lane(l), self.pace);
            made.plan = Some(plan.lane(l, made.model()));
            made
        });
        let alone = &mut self.one;
        alone.sign = [state.sign[l]];
        for (value, values) in alone.x.iter_mut().zip(self.saved.iter()) {
            *value = [values[l]];
        }
        let held = Applied { u: [applied.u[l]], load: [applied.load[l]], time: applied.time };
        integrator.advance_planned(alone, &held);
        state.sign[l] = alone.sign[0];
        for (values, value) in state.x.iter_mut().zip(alone.x.iter()) {
            values[l] = value[0];
        }
    }
}

/// What the exact step gives.
struct Exact<R, const N: usize> {
    next: [[R; N]; OWN],
    /// 1 where it holds, else 0.
    lanes: [u64; N],
}

impl<R: Real, const N: usize> Exact<R, N> {
    #[inline(always)]
    fn new(plan: &Plan<R, N>, state: &State<R, N>, applied: &Applied<R, N>) -> Self {
        let mut made = Self { next: [[R::zero(); N]; OWN], lanes: [0; N] };
        for affine in [&plan.forward, &plan.backward].into_iter().flatten() {
            if !any_goes(&state.sign, affine.sign) {
                continue;
            }
            let there = affine.step(&state.x, applied);
            let holds = affine.holds((&state.x, &state.sign), &there, applied);
            for row in 0..OWN {
                for l in 0..N {
                    made.next[row][l] = R::select(holds[l] == 1, there[row][l], made.next[row][l]);
                }
            }
            for l in 0..N {
                made.lanes[l] |= holds[l];
            }
        }
        made
    }

    /// Puts it into the states of the lanes where it holds.
    fn put_into(&self, x: &mut [[R; N]]) {
        for (values, next) in x.iter_mut().zip(&self.next) {
            for l in 0..N {
                values[l] = R::select(self.lanes[l] == 1, next[l], values[l]);
            }
        }
    }
}

/// Whether any lane goes that way.
#[inline(always)]
fn any_goes<const N: usize>(signs: &[f64; N], sign: f64) -> bool {
    let mut any = 0u64;
    for l in 0..N {
        any |= u64::from(signs[l] == sign);
    }
    any != 0
}

/// One interval of a block.
struct Advance<'a, R, const N: usize> {
    block: &'a mut Block<R, N>,
    state: &'a mut State<R, N>,
    applied: &'a Applied<R, N>,
    h: R,
}

impl<R: Real, const N: usize> Work for Advance<'_, R, N> {
    #[inline(always)]
    fn run(self) {
        self.block.advance_inlined(self.state, self.applied, self.h);
    }
}

/// An interval of which each lane takes its own part.
struct Apart<'a, R, const N: usize> {
    block: &'a mut Block<R, N>,
    state: &'a mut State<R, N>,
    applied: &'a Applied<R, N>,
}

impl<R: Real, const N: usize> Work for Apart<'_, R, N> {
    #[inline(always)]
    fn run(self) {
        let Self { block, state, applied } = self;
        let Some(plan) = &block.plan else { return };
        let exact = Exact::new(plan, state, applied);
        if all(&exact.lanes) {
            state.x[..OWN].copy_from_slice(&exact.next);
        } else {
            block.advance_others(state, applied, &exact);
        }
    }
}

/// The sub-steps of an interval, every lane; those that meet an event are to be redone.
struct SubSteps<'a, R, const N: usize> {
    block: &'a mut Block<R, N>,
    state: &'a mut State<R, N>,
    applied: &'a Applied<R, N>,
}

impl<R: Real, const N: usize> Work for SubSteps<'_, R, N> {
    #[inline(always)]
    fn run(self) {
        let Self { block, state, applied } = self;
        let Block { model, plan, room, moving, redo, .. } = block;
        let Some(plan) = plan else { return };
        let h = plan.sub_step();
        let seconds = h.value();
        let sign = state.sign;
        moving.copy_from_slice(&state.x);
        let directed = u64::from(model.directed());
        // Without a budget every lane is left to the automaton, which says so.
        let mut suspect = [u64::from(plan.substeps == 0); N];
        for l in 0..N {
            suspect[l] |= u64::from(model.dry() & (sign[l] == 0.0));
        }
        for k in 0..plan.substeps {
            let time = applied.time + k as f64 * seconds;
            let before = moving[SPEED];
            step(model, moving, (applied, time), &sign, h, &plan.armature, room);
            let (after, [start, end]) = (&moving[SPEED], room.accelerations());
            for l in 0..N {
                let (first, last) = (before[l].value(), after[l].value());
                let falls = sign[l] * start[l].value() * seconds;
                let rises = sign[l] * end[l].value() * seconds;
                let dips = may_dip((sign[l] * first, sign[l] * last), (falls, rises));
                let event = directed & u64::from((sign[l] * last < 0.0) | dips);
                suspect[l] |= event | u64::from(plan.grain.too_coarse(l, first, last));
            }
        }
        state.x.copy_from_slice(moving);
        *redo = suspect;
    }
}
