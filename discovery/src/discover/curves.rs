//! Curves of no particular formula: what any law over one variable could explain at most.
//!
//! A curve is a sum of hats over a variable (speed, current, angle, time, ...), as a torque, a
//! voltage or a share of the flux, perhaps with the sign of the motion (friction) or the current
//! (a resistance) as a factor. Its responses are those to known series along the run, so one
//! linear step tells how much of the residual a law of that kind could take away. It judges the
//! shape of a candidate, and is the answer where nobody knows the law. None goes over the acceleration:
//! that is what comes of the torques, and such a curve takes what a sensor shows a few milliseconds
//! late for a cause.

use std::f64::consts::TAU;

use drivescope_plant::drive::{Drive, Motion};
use drivescope_plant::effects::grid::Spans;
use drivescope_plant::effects::law::Variable;

use crate::measured::Measured;
use crate::response::Forcing;

/// Hats over a signed variable, over a magnitude, and over an angle or time.
const SIGNED: usize = 17;
const MAGNITUDE: usize = 8;
const AROUND: usize = 12;
/// One in that many values may lie outside what a curve goes over.
const SELDOM: usize = 1000;

/// The variables along one recording.
#[derive(Debug, Clone)]
pub(crate) struct Trajectory {
    /// Current, A (the commanded signal where force-driven).
    pub(crate) current: Vec<f64>,
    /// Speed, rad/s (m/s).
    pub(crate) speed: Vec<f64>,
    /// Position, rad (m): measured where it is.
    pub(crate) position: Vec<f64>,
}

/// Where a curve stands.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Balance {
    /// A torque (force) against the motion.
    Torque,
    /// A voltage lost in the armature circuit.
    Voltage,
    /// A share of the flux lost: in both.
    Flux,
}

/// What a curve goes over.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Over {
    Speed,
    SpeedMagnitude,
    Current,
    CurrentMagnitude,
    Position,
    Time,
}

/// What multiplies a curve.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Factor {
    One,
    Direction,
    Current,
}

/// A family of hats.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Curve {
    pub(crate) balance: Balance,
    pub(crate) over: Over,
    pub(crate) factor: Factor,
    pub(crate) knots: Vec<f64>,
    /// The period after which it repeats.
    pub(crate) period: Option<f64>,
}

impl Curve {
    /// Variables of a comparison under which it shows.
    pub(crate) fn variables(&self) -> &'static [Variable] {
        match (self.over, self.factor) {
            (Over::Speed | Over::SpeedMagnitude, _) => &[Variable::Omega, Variable::OmegaSign],
            (Over::Current | Over::CurrentMagnitude, _) => &[Variable::Current, Variable::Limits],
            (Over::Position, _) => &[Variable::Theta],
            (Over::Time, _) => &[Variable::Time, Variable::Temperature],
        }
    }

    /// Whether the current is its variable or its factor.
    pub(crate) fn is_over_current(&self) -> bool {
        matches!(self.over, Over::Current | Over::CurrentMagnitude)
            || self.factor == Factor::Current
            || self.balance == Balance::Flux
    }

    /// Whether the speed is its variable.
    pub(crate) fn is_over_speed(&self) -> bool {
        matches!(self.over, Over::Speed | Over::SpeedMagnitude)
    }

    /// What it adds to the balances of one recording, a hat at a time.
    pub(crate) fn forcings(
        &self,
        drive: &Drive,
        measured: &Measured,
        run: &Trajectory,
    ) -> Vec<Forcing> {
        let n = run.speed.len();
        let z = |k: usize| match self.over {
            Over::Speed => run.speed[k],
            Over::SpeedMagnitude => run.speed[k].abs(),
            Over::Current => run.current[k],
            Over::CurrentMagnitude => run.current[k].abs(),
            Over::Position => run.position[k],
            Over::Time => measured.time(k) - measured.clock.start_s,
        };
        let factor = |k: usize| match self.factor {
            Factor::One => 1.0,
            Factor::Direction if run.speed[k] == 0.0 => 0.0,
            Factor::Direction => run.speed[k].signum(),
            Factor::Current => run.current[k],
        };
        let mut hats = vec![vec![0.0; n]; self.knots.len()];
        for k in 0..n {
            for (knot, share) in self.shares(z(k)) {
                hats[knot][k] += share * factor(k);
            }
        }
        let times = |hat: &[f64], with: &[f64], by: f64| -> Vec<f64> {
            hat.iter().zip(with).map(|(hat, with)| by * hat * with).collect()
        };
        let against = |hat: Vec<f64>| hat.iter().map(|value| -value).collect();
        let of = |hat: Vec<f64>| match self.balance {
            Balance::Torque => Forcing::torque(against(hat)),
            Balance::Voltage => Forcing::voltage(against(hat)),
            Balance::Flux => Forcing {
                torque: times(&hat, &run.current, -drive.motor.k_m),
                voltage: times(&hat, &run.speed, drive.motor.k_e.unwrap_or(0.0)),
            },
        };
        hats.into_iter().map(of).collect()
    }

    /// The knots around a value with their shares.
    fn shares(&self, z: f64) -> [(usize, f64); 2] {
        let last = self.knots.len() - 1;
        if let Some(period) = self.period {
            let turn = (z - self.knots[0]).rem_euclid(period) / period * (last + 1) as f64;
            let knot = (turn as usize).min(last);
            let share = turn - knot as f64;
            return [(knot, 1.0 - share), ((knot + 1) % (last + 1), share)];
        }
        let z = z.clamp(self.knots[0], self.knots[last]);
        let knot = self.knots.partition_point(|knot| *knot <= z).clamp(1, last) - 1;
        let share = (z - self.knots[knot]) / (self.knots[knot + 1] - self.knots[knot]);
        [(knot, 1.0 - share), (knot + 1, share)]
    }
}

/// The curves that these recordings can tell.
pub(crate) fn curves(drive: &Drive, spans: &Spans, runs: &[Trajectory]) -> Vec<Curve> {
    use {Balance::*, Factor::*};
    let uniform = |low: f64, high: f64, count: usize| -> Vec<f64> {
        (0..count).map(|k| low + (high - low) * k as f64 / (count - 1) as f64).collect()
    };
    let signed = |most: f64| uniform(-most, most, SIGNED);
    let magnitude = |most: f64| uniform(0.0, most, MAGNITUDE);
    let duration = uniform(0.0, spans.duration_s, AROUND);
    let most = |of: fn(&Trajectory) -> &Vec<f64>| {
        let all = runs.iter().flat_map(|run| of(run).iter());
        reached(all.map(|value| value.abs()).collect())
    };
    let (speed, current) = (most(|run| &run.speed), most(|run| &run.current));
    let mut all = Vec::new();
    let mut add = |balance, over, factor, knots: Vec<f64>, period| {
        let increasing = knots.windows(2).all(|pair| pair[0] < pair[1]);
        if increasing {
            all.push(Curve { balance, over, factor, knots, period });
        }
    };
    add(Torque, Over::Speed, One, signed(speed), None);
    add(Torque, Over::Current, One, signed(current), None);
    add(Torque, Over::CurrentMagnitude, Direction, magnitude(current), None);
    add(Torque, Over::Time, Direction, duration.clone(), None);
    add(Torque, Over::Time, One, duration.clone(), None);
    match drive.motion {
        Motion::Rotary => {
            let turn: Vec<f64> = (0..AROUND).map(|k| TAU * k as f64 / AROUND as f64).collect();
            add(Torque, Over::Position, One, turn.clone(), Some(TAU));
            add(Torque, Over::Position, Direction, turn, Some(TAU));
        }
        Motion::Linear => {
            let (low, high) = runs
                .iter()
                .flat_map(|run| run.position.iter())
                .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| {
                    (low.min(*x), high.max(*x))
                });
            let way = uniform(low, high, AROUND);
            add(Torque, Over::Position, One, way.clone(), None);
            add(Torque, Over::Position, Direction, way, None);
        }
    }
    if drive.motor.k_e.is_some() {
        add(Voltage, Over::Speed, One, signed(speed), None);
        add(Voltage, Over::Current, One, signed(current), None);
        add(Voltage, Over::Time, Current, duration, None);
        add(Flux, Over::SpeedMagnitude, One, magnitude(speed), None);
        add(Flux, Over::CurrentMagnitude, One, magnitude(current), None);
    }
    all
}

/// The greatest of magnitudes, but no more than twice what one in a thousand exceeds: a filter that begins
/// without a speed passes through ones that no shaft has.
fn reached(mut magnitudes: Vec<f64>) -> f64 {
    if magnitudes.is_empty() {
        return 0.0;
    }
    let place = magnitudes.len() - 1 - magnitudes.len() / SELDOM;
    let (_, often, beyond) = magnitudes.select_nth_unstable_by(place, f64::total_cmp);
    let most = beyond.iter().copied().fold(*often, f64::max);
    if *often > 0.0 { most.min(2.0 * *often) } else { most }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn curve(knots: &[f64], period: Option<f64>) -> Curve {
        let (balance, over, factor) = (Balance::Torque, Over::Speed, Factor::One);
        Curve { balance, over, factor, knots: knots.to_vec(), period }
    }

    #[test]
    fn hats_add_up_to_one_and_reproduce_a_line() {
        let plain = curve(&[-3.0, 0.0, 1.0, 5.0], None);
        for z in [-3.0, -1.3, 0.0, 0.4, 1.0, 4.9, 5.0] {
            let shares = plain.shares(z);
            assert!((shares[0].1 + shares[1].1 - 1.0).abs() < 1e-12);
            let line: f64 = shares.iter().map(|(knot, share)| share * plain.knots[*knot]).sum();
            assert!((line - z).abs() < 1e-12, "{line} at {z}");
        }
        // Beyond the ends it keeps the end value.
        assert_eq!(plain.shares(9.0).map(|(knot, share)| knot as f64 * share), [0.0, 3.0]);
    }

    #[test]
    fn an_angle_repeats() {
        let turn = curve(&[0.0, 1.0, 2.0, 3.0], Some(4.0));
        assert_eq!(turn.shares(3.25), [(3, 0.75), (0, 0.25)]);
        assert_eq!(turn.shares(-0.75), turn.shares(3.25));
    }
}
