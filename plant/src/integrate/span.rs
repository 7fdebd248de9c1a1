//! The spans of an interval: each in one step where that holds, else in sub-steps.

use drivescope_numerics::Real;

use super::collocation::{self, Collocation, Course};
use super::step::{Armature, Stages, step_at_rest};
use super::{Plan, automaton, sub_step};
use crate::model::{Applied, CURRENT, Model, OWN, Rows, SPEED, at_rest, field, zeros};

/// What makes a span in one step.
#[derive(Debug, Clone)]
pub(super) struct Span<R> {
    /// While the shaft slips, if it can be made for that motor.
    slipping: Option<Collocation<R>>,
    /// While it sticks: the current alone moves.
    sticking: Armature<R, 1>,
}

/// Room for the steps of a drive; allocated once.
#[derive(Debug, Clone)]
pub(super) struct Room<R> {
    stages: Stages<R, 1>,
    nodes: collocation::Room<R>,
    /// The state to return to.
    saved: Rows<R, 1>,
}

impl<R: Real> Room<R> {
    /// For a drive of so many states.
    pub(super) fn new(states: usize) -> Self {
        let (stages, nodes) = (Stages::new(states), collocation::Room::new());
        Self { stages, nodes, saved: zeros(states) }
    }
}

/// What is under way: the state and its sign of the motion, and room for a step.
struct Under<'a, R> {
    model: &'a Model<R, 1>,
    plan: &'a Plan<R, 1>,
    x: &'a mut [[R; 1]],
    sign: &'a mut f64,
    room: &'a mut Room<R>,
}

/// Advances by an interval.
#[inline(never)]
pub(super) fn advance<R: Real>(
    model: &Model<R, 1>,
    plan: &Plan<R, 1>,
    (x, sign): (&mut [[R; 1]], &mut f64),
    applied: &Applied<R, 1>,
    room: &mut Room<R>,
) {
    if plan.substeps == 0 {
        x.fill([R::constant(f64::NAN)]);
        return;
    }
    let span = plan.span(model);
    let h = sub_step(plan.h, plan.spans);
    let mut under = Under { model, plan, x, sign, room };
    for k in 0..plan.spans {
        let held = Applied { time: applied.time + k as f64 * h.value(), ..*applied };
        match span {
            Some(span) => under.whole(span, &held, h),
            None => under.in_sub_steps(&held),
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
        let done = if self.model.dry() && *self.sign == 0.0 {
            self.stay(&span.sticking, applied) || self.break_away(span, applied, h)
        } else {
            let slipping = span.slipping.as_ref();
            match slipping
                .map(|step| step.advance(self.x, *self.sign, (applied, 1.0), &mut self.room.nodes))
            {
                Some(Course::Made) => true,
                Some(Course::Stops(instant, there)) => {
                    self.stop(span, (instant, there), applied, h);
                    true
                }
                Some(Course::Refused) | None => false,
            }
        };
        if !done {
            self.in_sub_steps(applied);
        }
    }

    /// Makes a span in the sub-steps of the plan.
    fn in_sub_steps(&mut self, applied: &Applied<R, 1>) {
        let Plan { substeps, spans, armature, .. } = self.plan;
        self.sub_steps(applied, substeps / spans, armature, self.plan.sub_step());
    }

    /// Takes a step of a shaft that sticks throughout; else leaves all as it is and says so.
    fn stay(&mut self, armature: &Armature<R, 1>, applied: &Applied<R, 1>) -> bool {
        if self.model.restless() {
            return false;
        }
        // The torque on the shaft follows the current, which goes one way: the end tells.
        let before = self.x[CURRENT];
        step_at_rest(self.model, self.x, applied, armature, &mut self.room.stages);
        let stays = at_rest(self.model, self.x, applied).margin().value() >= 0.0;
        if !stays {
            self.x[CURRENT] = before;
        }
        stays
    }

    /// Goes on from a stop at that instant to the end of the span of `h`.
    #[cold]
    fn stop(
        &mut self,
        span: &Span<R>,
        (instant, there): (f64, [R; OWN]),
        applied: &Applied<R, 1>,
        h: R,
    ) {
        let then = Applied { time: applied.time + instant, ..*applied };
        self.x.copy_from_slice(&there.map(|value| [value]));
        let slope = self.slope(&then);
        // By how much the instant moves with the parameters: the value of that is zero.
        let rate = slope[SPEED][0].value();
        let inverse = if rate == 0.0 { 0.0 } else { 1.0 / rate };
        let moved = (R::constant(there[SPEED].value()) - there[SPEED]).scaled(inverse);
        self.move_by(&slope, moved);
        self.x[SPEED] = [R::zero()];
        *self.sign = automaton::after(self.model, self.x, *self.sign, &then);
        self.go_on(span, &then, h - R::constant(instant) - moved);
    }

    /// Breaks away within the span of `h`, and goes on to its end; false where the instant is not clear.
    #[cold]
    fn break_away(&mut self, span: &Span<R>, applied: &Applied<R, 1>, h: R) -> bool {
        let Self { model, room: Room { stages, .. }, .. } = self;
        if model.restless() {
            return false;
        }
        // At rest the current alone moves.
        let mut there = self.x.to_vec();
        let mut margin = |tau: f64| {
            there[CURRENT] = self.x[CURRENT];
            let armature = Armature::new(model, R::constant(tau));
            step_at_rest(model, &mut there, applied, &armature, stages);
            at_rest(model, &there, applied).margin().value()
        };
        let (first, last) = (margin(0.0), margin(h.value()));
        let located =
            if first > 0.0 { automaton::locate(first, last, h.value(), margin) } else { None };
        let Some(instant) = located else { return false };
        let (there, moved) = automaton::at_event(model, self.x, 0.0, applied, (instant, h), stages);
        let then = Applied { time: applied.time + instant, ..*applied };
        *self.sign = automaton::after(model, &there, 0.0, &then);
        self.x.copy_from_slice(&there);
        self.go_on(span, &then, h - R::constant(instant) - moved);
        true
    }

    /// Goes on for what is left of a span after an event.
    fn go_on(&mut self, span: &Span<R>, then: &Applied<R, 1>, left: R) {
        if left.value() <= 0.0 {
            return;
        }
        let sticks = self.model.dry() && *self.sign == 0.0;
        let done = if sticks {
            self.stay(&Armature::new(self.model, left), then)
        } else {
            self.slip_on(span, then, left)
        };
        if done {
            return;
        }
        let count = (left.value() / self.plan.sub_step().value()).ceil().max(1.0);
        let part = left.scaled(1.0 / count);
        self.sub_steps(then, count as usize, &Armature::new(self.model, part), part);
    }

    /// Slips on for what is left, as a share of a step over a whole span; false where that does not hold.
    fn slip_on(&mut self, span: &Span<R>, then: &Applied<R, 1>, left: R) -> bool {
        let Some(step) = &span.slipping else { return false };
        let share = left.value() / step.seconds();
        if !matches!(
            step.advance(self.x, *self.sign, (then, share), &mut self.room.nodes),
            Course::Made
        ) {
            return false;
        }
        let slope = self.slope(&Applied { time: then.time + left.value(), ..*then });
        self.move_by(&slope, left - R::constant(left.value()));
        true
    }

    /// Rates of the state.
    fn slope(&self, then: &Applied<R, 1>) -> [[R; 1]; OWN] {
        let mut slope = [[R::zero(); 1]; OWN];
        field(self.model, self.x, then, &[*self.sign], &mut slope, None);
        slope
    }

    /// Moves the state by a time whose value is zero, for its derivatives.
    fn move_by(&mut self, slope: &[[R; 1]; OWN], moved: R) {
        for (state, slope) in self.x.iter_mut().zip(slope) {
            state[0] += slope[0] * moved;
        }
    }

    /// So many sub-steps of `h`, each through the automaton.
    fn sub_steps(
        &mut self,
        applied: &Applied<R, 1>,
        count: usize,
        armature: &Armature<R, 1>,
        h: R,
    ) {
        let Self { model, plan, x, sign, room: Room { stages, saved, .. } } = self;
        for k in 0..count {
            let held = Applied { time: applied.time + k as f64 * h.value(), ..*applied };
            saved.copy_from_slice(x);
            let before = **sign;
            automaton::advance(model, (x, sign), &held, h, armature, stages, saved);
            let parts = plan.grain.parts(0, saved[SPEED][0].value(), x[SPEED][0].value());
            if parts > 1.0 {
                x.copy_from_slice(saved);
                **sign = before;
                automaton::advance_in_parts(model, (x, sign), &held, h, parts, stages, saved);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use crate::integrate::{Integrator, State, longest_substep};
    use crate::model::{Applied, SPEED};
    use crate::testing::{DR300, drive};

    /// Greatest difference of the speed, rad/s, where the fastest is 40: a kink costs a sub-step its order.
    const APART: f64 = 4e-6;

    /// A law with kinks is not resolved where they lie in a step: sub-steps are made there.
    #[test]
    fn a_law_with_kinks_is_stepped_as_near() {
        let law = "\n[[effect]]\nkind = \"custom\"\nparameters = { c = 2e-4 }\n\
                   torque = \"-c * sign(omega) * max(abs(omega) - 12, 0)\"\n";
        let model = drive(&format!("{DR300}{law}")).model();
        let longest = longest_substep(&model, 400.0);
        let mut runs = [1.0, 16.0].map(|finer| {
            (State::at_rest(&model), Integrator::paced(model.clone(), longest / finer))
        });
        let mut fastest: f64 = 0.0;
        for k in 0..800 {
            let time = f64::from(k) * 0.005;
            let applied = Applied { u: [4.0 * (6.0 * time).sin()], load: [0.0], time };
            for (state, integrator) in &mut runs {
                integrator.advance(state, &applied, 0.005);
            }
            let [coarse, fine] = runs.each_ref().map(|(state, _)| state.x[SPEED][0]);
            assert!((coarse - fine).abs() < APART, "{coarse} against {fine} at {time}");
            fastest = fastest.max(fine);
        }
        assert!(fastest > 20.0, "it meets its kink: {fastest}");
    }
}
