//! The spans of an interval: each in one step where that holds, else in sub-steps.

use drivescope_numerics::Real;

use super::collocation::{Collocation, Course};
use super::step::{Armature, Stages, step_at_rest};
use super::{Plan, automaton, sub_step};
use crate::model::{Applied, Model, SPEED, at_rest, field};

/// What makes a span in one step.
#[derive(Debug, Clone)]
pub(super) struct Span<R> {
    /// While the shaft slips, if it can be made for that motor.
    slipping: Option<Collocation<R>>,
    /// While it sticks: the current alone moves.
    sticking: Armature<R, 1>,
}

/// What is under way: the state and its sign of the motion, and room for a step.
struct Under<'a, R> {
    model: &'a Model<R, 1>,
    plan: &'a Plan<R, 1>,
    x: &'a mut Vec<[R; 1]>,
    sign: &'a mut f64,
    room: &'a mut Stages<R, 1>,
    saved: &'a mut Vec<[R; 1]>,
}

/// Advances by an interval.
#[inline(never)]
pub(super) fn advance<R: Real>(
    model: &Model<R, 1>,
    plan: &Plan<R, 1>,
    (x, sign): (&mut Vec<[R; 1]>, &mut f64),
    applied: &Applied<R, 1>,
    room: &mut Stages<R, 1>,
    saved: &mut Vec<[R; 1]>,
) {
    if plan.substeps == 0 {
        x.fill([R::constant(f64::NAN)]);
        return;
    }
    let span = plan.span(model);
    let h = sub_step(plan.h, plan.spans);
    let mut under = Under { model, plan, x, sign, room, saved };
    for k in 0..plan.spans {
        let held = Applied { time: applied.time + k as f64 * h.value(), ..*applied };
        match span {
            Some(span) => under.whole(span, &held, h),
            None => {
                under.sub_steps(&held, plan.substeps / plan.spans, &plan.armature, plan.sub_step())
            }
        }
    }
}

impl<R: Real> Plan<R, 1> {
    /// What makes a span in one step, if anything may.
    fn span(&self, model: &Model<R, 1>) -> Option<&Span<R>> {
        let h = sub_step(self.h, self.spans);
        let made = || {
            let sticking = Armature::new(model, h);
            Box::new(Span { slipping: Collocation::new(model, h), sticking })
        };
        self.whole_spans.then(|| &**self.span.get_or_init(made))
    }
}

impl<R: Real> Under<'_, R> {
    /// Makes a span of `h`, in one step where that holds.
    fn whole(&mut self, span: &Span<R>, applied: &Applied<R, 1>, h: R) {
        let Self { model, plan, .. } = *self;
        if model.dry() && *self.sign == 0.0 {
            let done = self.stay(&span.sticking, applied) || self.break_away(applied, h);
            if !done {
                self.sub_steps(
                    applied,
                    plan.substeps / plan.spans,
                    &plan.armature,
                    plan.sub_step(),
                );
            }
            return;
        }
        let slipping = span.slipping.as_ref();
        match slipping.map(|step| step.advance(self.x, *self.sign, applied)) {
            Some(Course::Whole) => {}
            Some(Course::Stops(instant, there)) => self.stop(instant, there, applied, h),
            Some(Course::Refused) | None => {
                self.sub_steps(
                    applied,
                    plan.substeps / plan.spans,
                    &plan.armature,
                    plan.sub_step(),
                );
            }
        }
    }

    /// Takes a step of a shaft that sticks throughout; else leaves all as it is and says so.
    fn stay(&mut self, armature: &Armature<R, 1>, applied: &Applied<R, 1>) -> bool {
        if self.model.restless() {
            return false;
        }
        // The torque on the shaft follows the current, which goes one way: the end tells.
        self.saved.clone_from(self.x);
        step_at_rest(self.model, self.x, applied, armature, self.room);
        let stays = at_rest(self.model, self.x, applied).margin().value() >= 0.0;
        if !stays {
            self.x.copy_from_slice(self.saved);
        }
        stays
    }

    /// Goes on from a stop at that instant to the end of the span of `h`.
    #[cold]
    fn stop(&mut self, instant: f64, there: [R; 3], applied: &Applied<R, 1>, h: R) {
        let then = Applied { time: applied.time + instant, ..*applied };
        let mut slope = [[R::zero(); 1]; 3];
        let speed = there[SPEED];
        *self.x = there.map(|value| [value]).into();
        field(self.model, self.x, &then, &[*self.sign], &mut slope, None);
        // By how much the instant moves with the parameters: the value of that is zero.
        let rate = slope[SPEED][0].value();
        let inverse = if rate == 0.0 { 0.0 } else { 1.0 / rate };
        let moved = (R::constant(speed.value()) - speed).scaled(inverse);
        for (state, slope) in self.x.iter_mut().zip(&slope) {
            state[0] += slope[0] * moved;
        }
        self.x[SPEED] = [R::zero()];
        *self.sign = automaton::after(self.model, self.x, *self.sign, &then);
        self.go_on(&then, h - R::constant(instant) - moved);
    }

    /// Breaks away within the span of `h`, and goes on to its end; false where the instant is not clear.
    #[cold]
    fn break_away(&mut self, applied: &Applied<R, 1>, h: R) -> bool {
        let Self { model, room, .. } = self;
        if model.restless() {
            return false;
        }
        let mut margin = |tau: f64| {
            let mut there = self.x.clone();
            let armature = Armature::new(model, R::constant(tau));
            step_at_rest(model, &mut there, applied, &armature, room);
            at_rest(model, &there, applied).margin().value()
        };
        let (first, last) = (margin(0.0), margin(h.value()));
        let located =
            if first > 0.0 { automaton::locate(first, last, h.value(), margin) } else { None };
        let Some(instant) = located else { return false };
        let (there, moved) = automaton::at_event(model, self.x, 0.0, applied, (instant, h), room);
        let then = Applied { time: applied.time + instant, ..*applied };
        *self.sign = automaton::after(model, &there, 0.0, &then);
        *self.x = there;
        self.go_on(&then, h - R::constant(instant) - moved);
        true
    }

    /// Goes on for what is left of a span after an event.
    fn go_on(&mut self, then: &Applied<R, 1>, left: R) {
        if left.value() <= 0.0 {
            return;
        }
        let sticks = self.model.dry() && *self.sign == 0.0;
        if sticks && self.stay(&Armature::new(self.model, left), then) {
            return;
        }
        let count = (left.value() / self.plan.sub_step().value()).ceil().max(1.0);
        let part = left.scaled(1.0 / count);
        self.sub_steps(then, count as usize, &Armature::new(self.model, part), part);
    }

    /// So many sub-steps of `h`, each through the automaton.
    fn sub_steps(
        &mut self,
        applied: &Applied<R, 1>,
        count: usize,
        armature: &Armature<R, 1>,
        h: R,
    ) {
        let Self { model, plan, x, sign, room, saved } = self;
        for k in 0..count {
            let held = Applied { time: applied.time + k as f64 * h.value(), ..*applied };
            saved.clone_from(x);
            let before = **sign;
            automaton::advance(model, (x, sign), &held, h, armature, room, saved);
            let parts = plan.grain.parts(0, saved[SPEED][0].value(), x[SPEED][0].value());
            if parts > 1.0 {
                x.clone_from(saved);
                **sign = before;
                automaton::advance_in_parts(model, (x, sign), &held, h, parts, room, saved);
            }
        }
    }
}
