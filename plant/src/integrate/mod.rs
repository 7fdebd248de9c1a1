//! Time integration of the drive over a sample.
//!
//! The rule that ties internal steps to samples and communication points: inputs are held
//! from one instant at which they may change (a sample of the controller, a communication
//! point, an event of the importer) to the next. Over such an interval of length h the state is
//! advanced by one exact affine step where the drive is affine. Else n equal sub-steps h / n resolve
//! it; n follows from the fastest rate of the drive ([`longest_substep`]). As many of them as hold
//! a smooth motion without states of the laws' own are made as one: a span (`span.rs`), from the exact
//! motor and the laws at a few instants (`collocation.rs`), or at rest from the armature alone. All
//! of this depends only on the state, the inputs and h. Events of stick-slip lie inside spans and
//! sub-steps, which are split there. Time is t0 + k h, never a running sum.
//!
//! [`Integrator`] advances one drive; [`Block`] advances lanes of drives and hands a lane that
//! meets an event to the former, from its saved state: a lane equals the scalar run with the
//! same longest sub-step bit for bit. Both `paced` constructors fix that length, so that a
//! campaign gives the same bytes however its drives are grouped, and a fit has no jumps.
//!
//! A state that grew without bound is not hidden: whoever drives a run asks
//! [`State::is_finite`] after each interval and ends the run there. An interval that would need
//! more than [`MOST_SUBSTEPS`] sub-steps ends the same way: its state becomes NaN, since fewer
//! sub-steps would give an answer that looks like one ([`Integrator::out_of_budget`]).

mod affine;
mod automaton;
mod block;
mod collocation;
mod exponential;
mod grain;
mod nodes;
mod renew;
mod response;
mod span;
mod step;

use std::sync::OnceLock;

use drivescope_numerics::Real;

use crate::model::{Applied, Model, OWN, Rows, SPEED, at_rest, zeros};
use affine::{Affine, Exponentials};
use grain::Grain;
use span::{Room, Span};
use step::Armature;

pub use block::Block;

/// Sub-step times fastest rate. A free oscillation is off by x^4 / 120 a radian at order four:
/// 1e-8, which an armature that rings over several radians with all of its current sums to 4e-8.
const RADIANS_A_STEP: f64 = 0.033;
/// Sub-step over armature time constant. The decay itself is exact; what is left is the quadrature
/// of the torque of a current that dies away, x^4 / 2880 of it. Against an independent program
/// over stick-slip runs (`tests/core/independent.rs`) 0.18 leaves 4e-8 of a variable's range, and
/// 2e-7 where the shaft creeps at break-away and errors grow 40-fold; this leaves a fifth of it,
/// which Model Exchange in another simulator can tell (1e-7).
const ARMATURE_A_STEP: f64 = 0.12;
/// Sub-steps of one interval, some 10 ms of work: what needs more of them is not stepped at all, its
/// state becomes NaN.
pub const MOST_SUBSTEPS: usize = 100_000;

/// The state of `N` drives: current, speed, position, own states; and the sign of the motion.
#[derive(Debug, Clone, PartialEq)]
#[repr(C, align(64))]
pub struct State<R, const N: usize> {
    /// +1 forward, -1 backward, 0 stuck; never 0 without dry friction, and +1 throughout where
    /// no law depends on it ([`Model::directed`]).
    pub sign: [f64; N],
    /// `x[state][lane]`, in the order of [`crate::model`].
    pub x: Rows<R, N>,
}

impl<R: Real, const N: usize> State<R, N> {
    /// At rest: every state zero.
    pub fn at_rest(model: &Model<R, N>) -> Self {
        let sign = if model.dry() { 0.0 } else { 1.0 };
        Self { sign: [sign; N], x: zeros(model.states()) }
    }

    /// Whether every state and every derivative it carries is finite.
    pub fn is_finite(&self) -> bool {
        self.x.iter().flatten().all(|value| value.is_finite())
    }

    /// Sets the speed, and with it the sign of the motion, of lane `l`.
    pub fn set_speed(&mut self, model: &Model<R, N>, l: usize, omega: R) {
        self.x[SPEED][l] = omega;
        let value = omega.value();
        if model.dry() && value == 0.0 {
            self.sign[l] = 0.0;
        } else if model.directed() {
            self.sign[l] = if value < 0.0 { -1.0 } else { 1.0 };
        }
    }
}

/// How an interval of one length is stepped, for one set of parameters.
#[derive(Debug, Clone)]
struct Plan<R, const N: usize> {
    h: R,
    /// 0 where they would be too many: then only the exact step can be taken.
    substeps: usize,
    armature: Armature<R, N>,
    grain: Grain<N>,
    forward: Option<Affine<R, N>>,
    backward: Option<Affine<R, N>>,
    /// Into how many spans an interval is divided, each of as many sub-steps.
    spans: usize,
    /// Whether a span may be made in one step.
    whole_spans: bool,
    /// How that is done: made where it is first needed, most runs are at speed throughout.
    span: OnceLock<Box<Span<R>>>,
}

impl<R: Real, const N: usize> Plan<R, N> {
    fn new(model: &Model<R, N>, h: R, substeps: usize) -> Self {
        let spans = collocation::spans(model, substeps);
        let whole_spans = spans.is_some();
        let spans = spans.unwrap_or(1);
        // Each span takes as many sub-steps.
        let substeps = substeps.next_multiple_of(spans);
        let armature = Armature::new(model, sub_step(h, substeps));
        let mut exponentials = Exponentials::over(h);
        let forward = Affine::new(model, 1.0, &mut exponentials);
        let backward = if model.dry() { Affine::new(model, -1.0, &mut exponentials) } else { None };
        let (grain, span) = (Grain::new(model), OnceLock::new());
        Self { h, substeps, armature, grain, forward, backward, spans, whole_spans, span }
    }

    /// Length of a sub-step.
    fn sub_step(&self) -> R {
        sub_step(self.h, self.substeps)
    }

    /// The plan of one lane, for the model of that lane: what it holds was made lane by lane.
    fn lane(&self, l: usize, model: &Model<R, 1>) -> Plan<R, 1> {
        let lane = |affine: &Affine<R, N>| affine.lane(l);
        Plan {
            h: self.h,
            substeps: self.substeps,
            armature: Armature::new(model, self.sub_step()),
            grain: self.grain.lane(l),
            forward: self.forward.as_ref().map(lane),
            backward: self.backward.as_ref().map(lane),
            spans: self.spans,
            whole_spans: self.whole_spans,
            span: OnceLock::new(),
        }
    }

    /// Takes the exact step where all lanes go one way and it holds for each; else leaves the state as it
    /// is and says so.
    #[inline(always)]
    fn exact(&self, state: &mut State<R, N>, applied: &Applied<R, N>) -> bool {
        // Most of the time all lanes go one way: what each of them takes need not be chosen then,
        // which would stand between a sample and the next.
        let Some(affine) = self.affine(state.sign[0]) else { return false };
        let Some(x) = state.x.first_chunk_mut::<OWN>() else { return false };
        let next = affine.step(x, applied);
        let holds = all(&affine.holds((x, &state.sign), &next, applied));
        if holds {
            *x = next;
        }
        holds
    }

    /// The exact step in that direction of motion, if there is one.
    #[inline(always)]
    fn affine(&self, sign: f64) -> Option<&Affine<R, N>> {
        if sign > 0.0 {
            self.forward.as_ref()
        } else if sign < 0.0 {
            self.backward.as_ref()
        } else {
            None
        }
    }
}

/// Whether it is 1 in every lane.
#[inline(always)]
fn all<const N: usize>(lanes: &[u64; N]) -> bool {
    let mut all = 1;
    for l in 0..N {
        all &= lanes[l];
    }
    all == 1
}

fn sub_step<R: Real>(h: R, substeps: usize) -> R {
    h.scaled(1.0 / substeps.max(1) as f64)
}

/// The longest sub-step that resolves every lane up to that speed, s.
pub fn longest_substep<R: Real, const N: usize>(model: &Model<R, N>, speed: f64) -> f64 {
    let needed = (0..N).map(|l| {
        let motor = model.motors.lane(l);
        let armature = if model.force { 0.0 } else { (motor.r / motor.l).value() };
        let smooth = model.fastest(l, speed) / RADIANS_A_STEP;
        smooth.max(armature / ARMATURE_A_STEP)
    });
    1.0 / needed.fold(0.0, f64::max)
}

/// Equal sub-steps of an interval of `h` seconds, none longer than that; not finite where a rate is
/// not.
fn substeps(h: f64, longest: f64) -> f64 {
    // An interval that is a whole number of them must not gain one by a rounding error.
    (h / longest * (1.0 - 4.0 * f64::EPSILON)).ceil().max(1.0)
}

/// Those sub-steps where the budget allows them, else none.
fn within_budget(needed: f64) -> usize {
    // Not a number is beyond the budget too.
    if needed <= MOST_SUBSTEPS as f64 { needed as usize } else { 0 }
}

/// What sets the length of the sub-steps.
#[derive(Debug, Clone, Copy)]
enum Pace {
    /// The drive's own fastest rate up to this speed, anew when its parameters change.
    Speed(f64),
    /// This longest sub-step, s, whatever the parameters.
    Longest(f64),
}

impl Pace {
    fn substeps<R: Real, const N: usize>(self, model: &Model<R, N>, h: f64) -> f64 {
        let longest = match self {
            Self::Speed(speed) => longest_substep(model, speed),
            Self::Longest(longest) => longest,
        };
        substeps(h, longest)
    }
}

/// Advances one drive.
#[derive(Debug, Clone)]
pub struct Integrator<R> {
    model: Model<R, 1>,
    pace: Pace,
    plan: Option<Plan<R, 1>>,
    /// The plan for the length before: a delayed input splits every interval into two.
    other_plan: Option<Plan<R, 1>>,
    room: Room<R>,
}

impl<R: Real> Integrator<R> {
    /// An integrator of that drive; `speed` is the greatest speed to expect, rad/s (it sets the
    /// sub-steps where a law is faster at speed, such as cogging).
    pub fn new(model: Model<R, 1>, speed: f64) -> Self {
        Self::with(model, Pace::Speed(speed))
    }

    /// An integrator whose sub-steps last at most `longest` seconds whatever its parameters
    /// become: [`longest_substep`] of the nominal drive.
    pub fn paced(model: Model<R, 1>, longest: f64) -> Self {
        Self::with(model, Pace::Longest(longest))
    }

    fn with(model: Model<R, 1>, pace: Pace) -> Self {
        let room = Room::new(model.states());
        Self { model, pace, plan: None, other_plan: None, room }
    }

    /// The drive.
    pub fn model(&self) -> &Model<R, 1> {
        &self.model
    }

    /// Changes the drive: its parameters, or a continuous controller put around it.
    pub fn change(&mut self, change: impl FnOnce(&mut Model<R, 1>)) {
        let states = self.model.states();
        change(&mut self.model);
        if self.model.states() != states {
            *self = Self::with(self.model.clone(), self.pace);
        }
        (self.plan, self.other_plan) = (None, None);
    }

    /// The plan for intervals of length `h`, from one of the last two calls if it was theirs.
    #[inline]
    fn ready(&mut self, h: R) {
        let other = |plan: &Option<Plan<R, 1>>| plan.as_ref().is_none_or(|plan| plan.h != h);
        if other(&self.plan) {
            std::mem::swap(&mut self.plan, &mut self.other_plan);
        }
        if other(&self.plan) {
            let steps = within_budget(self.pace.substeps(&self.model, h.value()));
            self.plan = Some(Plan::new(&self.model, h, steps));
        }
    }

    /// The sub-steps that an interval of `h` seconds needs, if they are more than [`MOST_SUBSTEPS`].
    pub fn out_of_budget(&self, h: f64) -> Option<f64> {
        let needed = self.pace.substeps(&self.model, h);
        (within_budget(needed) == 0).then_some(needed)
    }

    /// Advances the state by `h`, the inputs held.
    #[inline]
    pub fn advance(&mut self, state: &mut State<R, 1>, applied: &Applied<R, 1>, h: R) {
        self.ready(h);
        self.advance_planned(state, applied);
    }

    #[inline(always)]
    fn advance_planned(&mut self, state: &mut State<R, 1>, applied: &Applied<R, 1>) {
        let Some(plan) = &self.plan else { return };
        if !plan.exact(state, applied) {
            self.advance_else(state, applied);
        }
    }

    /// Advances where the exact step does not hold.
    #[inline(never)]
    fn advance_else(&mut self, state: &mut State<R, 1>, applied: &Applied<R, 1>) {
        let Self { model, plan, room, .. } = self;
        let Some(plan) = plan else { return };
        let State { sign: [sign], x } = state;
        if model.dry() && *sign == 0.0 {
            // The exact step does not hold for one that breaks away: it is at rest where it starts.
            *sign = at_rest(model, x, applied).sign();
        }
        span::advance(model, plan, (x, sign), applied, room);
    }
}

/// What advances `N` drives: one by an [`Integrator`], lanes by a [`Block`].
pub trait Stepper<const N: usize> {
    /// The drives.
    fn model(&self) -> &Model<f64, N>;

    /// Changes the drives' parameters.
    fn change(&mut self, change: impl FnOnce(&mut Model<f64, N>));

    /// The same where the parameters of those lanes alone change.
    fn change_lanes(&mut self, lanes: &[bool; N], change: impl FnOnce(&mut Model<f64, N>)) {
        let _ = lanes;
        self.change(change);
    }

    /// Advances the state by `h` seconds, the inputs held. The exact step is inlined, so that it
    /// is compiled for the instruction set of the run around it.
    fn advance(&mut self, state: &mut State<f64, N>, applied: &Applied<f64, N>, h: f64);
}

impl Stepper<1> for Integrator<f64> {
    fn model(&self) -> &Model<f64, 1> {
        Self::model(self)
    }

    fn change(&mut self, change: impl FnOnce(&mut Model<f64, 1>)) {
        Self::change(self, change);
    }

    #[inline(always)]
    fn advance(&mut self, state: &mut State<f64, 1>, applied: &Applied<f64, 1>, h: f64) {
        Self::advance(self, state, applied, h);
    }
}

impl<const N: usize> Stepper<N> for Block<f64, N> {
    fn model(&self) -> &Model<f64, N> {
        Self::model(self)
    }

    fn change(&mut self, change: impl FnOnce(&mut Model<f64, N>)) {
        Self::change(self, change);
    }

    fn change_lanes(&mut self, lanes: &[bool; N], change: impl FnOnce(&mut Model<f64, N>)) {
        Self::change_lanes(self, lanes, change);
    }

    #[inline(always)]
    fn advance(&mut self, state: &mut State<f64, N>, applied: &Applied<f64, N>, h: f64) {
        self.advance_inlined(state, applied, h);
    }
}
