//! The delay line of u: u(t) -> u(t - tau), exact for an input that is held.
//!
//! An interval over which the input was to be held is split where a delayed change falls into
//! it. Each piece is a dual number too: its ends move with tau, so that the derivative with
//! respect to tau is exact, at tau = 0 as well, where the piece has no length.

use std::collections::VecDeque;

use drivescope_numerics::Real;

use super::Sampled;
use crate::integrate::{State, Stepper};
use crate::model::Applied;

/// Ends of pieces lie on this many parts of an interval. Pieces of equal samples so have equal
/// lengths in spite of the rounding of time, and one plan serves them; 2^-26 of 1 ms is 15 ps.
const PARTS: f64 = 67_108_864.0;
/// Two instants this close, relative to the delay, are one.
const SAME_INSTANT: f64 = 1e-9;

/// What was set and has yet to act, for `N` drives.
#[derive(Debug, Clone, PartialEq)]
pub struct DelayLine<R, const N: usize> {
    /// The delay of each drive, s.
    delays: [R; N],
    /// When an input was set, s, and the input; the first has been held since ever.
    set: VecDeque<(f64, [R; N])>,
    pieces: Vec<(Applied<R, N>, R)>,
}

impl<R: Real, const N: usize> DelayLine<R, N> {
    /// An empty line with those delays, s.
    pub fn new(delays: [R; N]) -> Self {
        Self { delays, set: VecDeque::new(), pieces: Vec::new() }
    }

    /// The input is set to `u` at that time. The first one is taken to have been there before.
    pub fn set(&mut self, time: f64, u: [R; N]) {
        let since = match self.set.back_mut() {
            None => f64::NEG_INFINITY,
            Some((_, last)) if *last == u => return,
            Some((since, last)) if *since >= time => {
                *last = u;
                return;
            }
            Some(_) => time,
        };
        self.set.push_back((since, u));
        // One more than acts is kept: right at a change the derivative asks for both sides of it.
        let acts = |line: &Self, k: usize| (0..N).all(|l| line.due(k, l) <= time);
        while self.set.len() > 2 && acts(self, 2) {
            self.set.pop_front();
        }
    }

    /// When what was set as number `k` acts on lane `l`, s.
    fn due(&self, k: usize, l: usize) -> f64 {
        let delay = self.delays[l].value();
        self.set[k].0 + delay - SAME_INSTANT * delay
    }

    /// What acts at that time; nothing if nothing was ever set.
    pub fn acting(&self, time: f64) -> Option<[R; N]> {
        let (_, first) = self.set.front()?;
        let mut u = *first;
        for (l, u) in u.iter_mut().enumerate() {
            let last = (0..self.set.len()).rev().find(|k| self.due(*k, l) <= time);
            *u = self.set[last.unwrap_or(0)].1[l];
        }
        Some(u)
    }

    /// When the next change acts after that time, s.
    pub fn next_change(&self, time: f64) -> Option<f64> {
        let after = |k: usize| (0..N).map(move |l| (k, l)).find(|(k, l)| self.due(*k, *l) > time);
        let (k, l) = (0..self.set.len()).find_map(after)?;
        Some(self.set[k].0 + self.delays[l].value())
    }

    /// The pieces of an interval of `h` that starts at `applied.time` with its input set there:
    /// what acts over each, and its length.
    pub fn pieces(&mut self, applied: &Applied<R, N>, h: R) -> &[(Applied<R, N>, R)] {
        self.set(applied.time, applied.u);
        // Where in the interval each change acts, on the grid of its parts.
        let grid = h.value() / PARTS;
        let mut changes: Vec<(R, usize, usize)> = Vec::new();
        let mut u = self.set[0].1;
        for k in 1..self.set.len() {
            for l in 0..N {
                let offset = self.delays[l] + R::constant(self.set[k].0 - applied.time);
                let snapped = (offset.value() / grid).round() * grid;
                let offset = offset + R::constant(snapped - offset.value());
                // A change right at the start moves it into the interval or out of it.
                if snapped < 0.0 || offset == R::zero() {
                    u[l] = self.set[k].1[l];
                } else if snapped < h.value() {
                    changes.push((offset, k, l));
                }
            }
        }
        changes.sort_by(|a, b| a.0.value().total_cmp(&b.0.value()));
        self.pieces.clear();
        let mut from = R::zero();
        for (offset, k, l) in changes {
            let time = applied.time + from.value();
            self.push(Applied { u, time, ..*applied }, offset - from);
            u[l] = self.set[k].1[l];
            from = offset;
        }
        let time = applied.time + from.value();
        self.push(Applied { u, time, ..*applied }, h - from);
        &self.pieces
    }

    fn push(&mut self, held: Applied<R, N>, length: R) {
        if length != R::zero() {
            self.pieces.push((held, length));
        }
    }

    /// What was set and may yet act, oldest first: time, s, and input.
    pub fn history(&self) -> impl Iterator<Item = (f64, [R; N])> {
        self.set.iter().copied()
    }

    /// Puts back what [`DelayLine::history`] gave; nothing empties the line.
    pub fn restore(&mut self, history: impl IntoIterator<Item = (f64, [R; N])>) {
        self.set = history.into_iter().collect();
    }
}

impl<const N: usize> DelayLine<f64, N> {
    /// Moves the drives on by `h` under the input that is set, held back: not inlined into the
    /// runs of drives without a delay.
    #[inline(never)]
    pub(super) fn advance<S: Stepper<N>>(
        &mut self,
        stepper: &mut S,
        state: &mut State<f64, N>,
        applied: &Applied<f64, N>,
        h: f64,
    ) {
        for (held, length) in self.pieces(applied, h) {
            stepper.advance(state, held, *length);
        }
    }
}

impl<const N: usize, S: Stepper<N>> Sampled<N, S> {
    /// What holds u back, if the drive has a delay.
    pub fn delay(&self) -> Option<&DelayLine<f64, N>> {
        self.delay.as_ref()
    }

    /// The same, to put back what it remembers.
    pub fn delay_mut(&mut self) -> Option<&mut DelayLine<f64, N>> {
        self.delay.as_mut()
    }

    /// Lets a delay know what is applied from that time on, where another integrator advances
    /// the drives.
    pub fn remember_input(&mut self, time: f64) {
        let u = self.set_now(time).u;
        if let Some(line) = &mut self.delay {
            line.set(time, u);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::drive::Drive;
    use crate::integrate::Integrator;
    use crate::model::{CURRENT, SPEED};
    use crate::testing::{self, DR300};
    use drivescope_numerics::Dual;

    /// Sampling time, s.
    const H: f64 = 1e-3;

    /// The DR300; K_m is free as in a run.
    fn drive() -> Drive {
        testing::drive(&DR300.replace("tie_K = true", "tie_K = false"))
    }

    fn input(k: usize) -> f64 {
        if k % 7 < 3 { 9.0 } else { 4.0 + k as f64 * 0.1 }
    }

    /// Current and speed at every sample, u delayed by the line.
    fn delayed<R: Real>(tau: R, samples: usize) -> Vec<[R; 2]> {
        let drive = drive();
        let values = drive.parameters();
        let model = drive.model_of(|name| {
            R::constant(values.iter().find(|p| p.name == name).expect("its own name").value)
        });
        let mut state = State::at_rest(&model);
        let mut integrator = Integrator::paced(model, 1e-4);
        let mut line = DelayLine::new([tau]);
        (0..samples)
            .map(|k| {
                let u = [R::constant(input(k))];
                let applied = Applied { u, load: [R::zero()], time: 3.0 + k as f64 * H };
                for (held, length) in line.pieces(&applied, R::constant(H)) {
                    integrator.advance(&mut state, held, *length);
                }
                [state.x[CURRENT][0], state.x[SPEED][0]]
            })
            .collect()
    }

    /// Pieces change the steps of the run: what is left of its own error (1e-8).
    const STEPS: f64 = 1e-6;

    #[test]
    fn a_fraction_of_a_sample_is_exact() {
        // The same on a grid of a tenth of the sampling time, where 2.3 samples are 23 steps.
        let found = delayed(2.3e-3, 60);
        let drive = drive();
        let mut state = State::at_rest(&drive.model());
        let mut integrator = Integrator::paced(drive.model(), 1e-4);
        for step in 0..600usize {
            let k = step.saturating_sub(23) / 10;
            let time = 3.0 + step as f64 * 1e-4;
            integrator.advance(&mut state, &Applied { u: [input(k)], load: [0.0], time }, 1e-4);
            if step % 10 == 9 {
                let [current, speed] = found[step / 10];
                assert!((current - state.x[CURRENT][0]).abs() < STEPS, "step {step}");
                assert!((speed - state.x[SPEED][0]).abs() < 100.0 * STEPS, "step {step}");
            }
        }
    }

    /// Differences of this step, s: the grid of 15 ps leaves 3e-6 of them, and of those to one
    /// side the armature's rate of 626 / s leaves 1e-3.
    const STEP: f64 = 3e-6;
    const DERIVATIVE: f64 = 1e-5;
    const ONE_SIDED: f64 = 2e-3;

    #[test]
    fn the_derivative_with_respect_to_the_delay_is_exact_at_none_too() {
        for (tau, up, down) in [(0.0, 1.0, 0.0), (3.4e-4, 1.0, 1.0), (2.3e-3, 1.0, 1.0)] {
            let dual = delayed(Dual::<1>::parameter(tau, 0), 40);
            let moved = |by: f64| delayed(tau + by * STEP, 40);
            let (above, below) = (moved(up), moved(-down));
            for j in 0..2 {
                let size = dual.iter().map(|x| x[j].d[0].abs()).fold(0.0, f64::max);
                for k in 0..40 {
                    let slope = (above[k][j] - below[k][j]) / ((up + down) * STEP);
                    let apart = (slope - dual[k][j].d[0]).abs();
                    let allowed = if down == 0.0 { ONE_SIDED } else { DERIVATIVE } * size;
                    assert!(apart <= allowed, "tau {tau}, {k}, {j}: {apart:e} of {size:e}");
                }
            }
        }
    }

    #[test]
    fn lanes_have_their_own_delays() {
        let mut line = DelayLine::new([0.0, 0.4 * H, 1.2 * H]);
        let mut at = |k: usize, u: f64| {
            let applied = Applied { u: [u; 3], load: [0.0; 3], time: k as f64 * H };
            let round = |x: f64| (x / H * 1e6).round() / 1e6;
            let all = line.pieces(&applied, H).iter();
            all.map(|(held, length)| (held.u, round(*length))).collect::<Vec<_>>()
        };
        assert_eq!(at(0, 1.0), [([1.0; 3], 1.0)]);
        assert_eq!(at(1, 2.0), [([2.0, 1.0, 1.0], 0.4), ([2.0, 2.0, 1.0], 0.6)]);
        let third = [([3.0, 2.0, 1.0], 0.2), ([3.0, 2.0, 2.0], 0.2), ([3.0, 3.0, 2.0], 0.6)];
        assert_eq!(at(2, 3.0), third);
        assert_eq!(at(3, 3.0), [([3.0, 3.0, 2.0], 0.2), ([3.0; 3], 0.8)]);
        assert_eq!(at(4, 3.0), [([3.0; 3], 1.0)]);
    }

    #[test]
    fn it_tells_what_acts_and_when_that_changes() {
        let mut line = DelayLine::new([0.3]);
        assert_eq!((line.acting(5.0), line.next_change(5.0)), (None, None));
        line.set(5.0, [1.0]);
        assert_eq!((line.acting(5.0), line.next_change(5.0)), (Some([1.0]), None));
        line.set(6.0, [2.0]);
        assert_eq!((line.acting(6.2), line.next_change(6.2)), (Some([1.0]), Some(6.3)));
        assert_eq!((line.acting(6.3), line.next_change(6.3)), (Some([2.0]), None));
    }
}
