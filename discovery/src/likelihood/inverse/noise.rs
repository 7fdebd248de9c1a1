//! What is random in the torque: a load that forgets what it was (Ornstein-Uhlenbeck), what has no memory,
//! and what grows with the speed, for a position that is read a moment sooner or later is off by as much as
//! the shaft goes in it; columns of windows whitened by the filter that knows it.

use nalgebra::DMatrix;

/// Standard deviations, N m (N), of what grows with the speed N m s/rad (N s/m), and the load's correlation
/// time, s.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct TorqueNoise {
    pub(super) white: f64,
    pub(super) load: f64,
    pub(super) load_s: f64,
    pub(super) by_speed: f64,
}

/// What windows allow the noise to be.
#[derive(Debug, Clone, Copy)]
pub(super) struct Bounds {
    /// Time between them, s: a load is correlated over no less.
    pub(super) apart_s: f64,
    /// What positions that are read a moment sooner or later may make of the torque, N m s/rad (N s/m).
    pub(super) by_speed: f64,
}

/// The windows of a recording, one after the other.
#[derive(Debug, Clone)]
pub(super) struct Course {
    /// Time between them, s.
    pub(super) apart_s: f64,
    /// Whether a piece begins with it.
    pub(super) begins: Vec<bool>,
    /// Whether it counts.
    pub(super) used: Vec<bool>,
    /// Mean speed, rad/s (m/s).
    pub(super) speed: Vec<f64>,
}

/// Changes of a number, ln, that are tried in turn, and the gain in evidence that is worth one.
const STEPS: [f64; 3] = [1.0, 0.5, 0.25];
const WORTH: f64 = 0.1;
/// Turns with the same step at most.
const TURNS: usize = 6;
/// Longest correlation time, s, and the shortest over the time between windows.
const LONGEST_S: f64 = 2.0;
const SHORTEST: f64 = 1.0;

impl TorqueNoise {
    /// With a load of another size.
    pub(super) fn with_load(self, factor: f64) -> Self {
        Self { load: factor * self.load, ..self }
    }

    /// The noise with which `evidence` is greatest, from here on.
    pub(super) fn searched(self, bounds: Bounds, evidence: impl Fn(&Self) -> f64) -> Self {
        let mut best = Self { by_speed: self.by_speed.min(bounds.by_speed), ..self };
        let mut most = evidence(&best);
        for step in STEPS {
            for _ in 0..TURNS {
                let before = most;
                for number in 0..4 {
                    for by in [step, -step] {
                        let tried = best.moved(number, by.exp(), bounds);
                        let found = if tried == best { most } else { evidence(&tried) };
                        if found > most + WORTH {
                            (best, most) = (tried, found);
                            break;
                        }
                    }
                }
                if most <= before {
                    break;
                }
            }
        }
        best
    }

    fn moved(mut self, number: usize, factor: f64, bounds: Bounds) -> Self {
        match number {
            0 => self.white *= factor,
            1 => self.load *= factor,
            2 => self.by_speed = (factor * self.by_speed).min(bounds.by_speed),
            _ => {
                let longest = LONGEST_S.max(2.0 * bounds.apart_s);
                self.load_s = (factor * self.load_s).clamp(SHORTEST * bounds.apart_s, longest);
            }
        }
        self
    }

    /// Whitens columns of windows, and returns ln of the likelihood of the noise without the columns' part
    /// and its constant. A window that is not `used` becomes 0.
    pub(super) fn whiten(&self, course: &Course, columns: &mut DMatrix<f64>) -> f64 {
        let Course { apart_s, begins, used, speed } = course;
        let keeps = (-apart_s / self.load_s).exp();
        let (load, white) = (self.load * self.load, self.white * self.white);
        let fresh = load * (1.0 - keeps * keeps);
        let mut gains = Vec::with_capacity(used.len());
        let (mut variance, mut ln_likelihood) = (load, 0.0);
        for ((begins, used), speed) in begins.iter().zip(used).zip(speed) {
            if *begins {
                variance = load;
            }
            let (gain, sd) = if *used {
                let all = variance + white + (self.by_speed * speed).powi(2);
                ln_likelihood -= 0.5 * all.ln();
                (variance / all, all.sqrt())
            } else {
                (0.0, f64::INFINITY)
            };
            gains.push((gain, sd));
            variance = keeps * keeps * variance * (1.0 - gain) + fresh;
        }
        for mut column in columns.column_iter_mut() {
            let mut expected = 0.0;
            for (k, (gain, sd)) in gains.iter().enumerate() {
                if begins[k] {
                    expected = 0.0;
                }
                let innovation = column[k] - expected;
                column[k] = if sd.is_finite() { innovation / sd } else { 0.0 };
                expected = keeps * (expected + gain * innovation);
            }
        }
        ln_likelihood
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::SeedableRng as _;
    use rand_distr::{Distribution as _, StandardNormal};
    use rand_pcg::Pcg64;

    /// White noise and a load of those sizes, windows 10 ms apart.
    fn drawn(noise: &TorqueNoise, count: usize) -> DMatrix<f64> {
        let mut random = Pcg64::seed_from_u64(3);
        let mut normal = || -> f64 { StandardNormal.sample(&mut random) };
        let keeps = (-0.01 / noise.load_s).exp();
        let mut load = noise.load * normal();
        DMatrix::from_fn(count, 1, |_, _| {
            load = keeps * load + noise.load * (1.0 - keeps * keeps).sqrt() * normal();
            load + noise.white * normal()
        })
    }

    fn course(speed: Vec<f64>) -> Course {
        let count = speed.len();
        Course { apart_s: 0.01, begins: vec![false; count], used: vec![true; count], speed }
    }

    #[test]
    fn the_noise_is_found_and_whitened() {
        let truth = TorqueNoise { white: 2.0, load: 5.0, load_s: 0.2, by_speed: 0.0 };
        let count = 8000;
        let mut all = drawn(&truth, count);
        let likelihood = |all: &DMatrix<f64>, course: &Course, noise: &TorqueNoise| {
            let mut white = all.clone();
            let ln = noise.whiten(course, &mut white);
            ln - 0.5 * white.norm_squared()
        };
        let bounds = Bounds { apart_s: 0.01, by_speed: f64::INFINITY };
        let first = TorqueNoise { white: 1.0, load: 1.0, load_s: 0.05, by_speed: 0.1 };
        let at_rest = course(vec![0.0; count]);
        let found = first.searched(bounds, |noise| likelihood(&all, &at_rest, noise));
        let near = |found: f64, truth: f64, by: f64| (found / truth).ln().abs() < by;
        assert!(near(found.white, truth.white, 0.15), "{found:?}");
        assert!(near(found.load, truth.load, 0.25) && near(found.load_s, 0.2, 0.5), "{found:?}");
        let mut white = all.clone();
        truth.whiten(&at_rest, &mut white);
        let power = white.norm_squared() / count as f64;
        let next: f64 = (1..count).map(|k| white[k] * white[k - 1]).sum::<f64>() / count as f64;
        assert!((power - 1.0).abs() < 0.05 && next.abs() < 0.04, "{power} {next}");
        // What grows with the speed is told from what does not.
        let moving = course((0..count).map(|k| (0.01 * k as f64).sin() * 10.0).collect());
        let alone = drawn(&TorqueNoise { white: 1.0, load: 0.0, ..truth }, count);
        for (k, speed) in moving.speed.iter().enumerate() {
            all[k] += speed * alone[count - 1 - k];
        }
        let found = first.searched(bounds, |noise| likelihood(&all, &moving, noise));
        assert!(near(found.by_speed, 1.0, 0.15), "{found:?}");
    }

    #[test]
    fn a_window_that_is_not_used_tells_nothing() {
        let noise = TorqueNoise { white: 1.0, load: 2.0, load_s: 0.1, by_speed: 0.0 };
        let mut course = course(vec![1.0; 50]);
        course.used[20] = false;
        let mut columns = drawn(&noise, 50);
        let mut others = columns.clone();
        others[20] = 1e3;
        noise.whiten(&course, &mut columns);
        noise.whiten(&course, &mut others);
        assert_eq!(columns[20], 0.0);
        assert!((&columns - &others).amax() < 1e-12);
    }
}
