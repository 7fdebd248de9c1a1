//! The motion of a recording and what drives it, averaged over windows as short as noise allows,
//! and where the direction of the motion is certain.

use drivescope_plant::drive::{Drive, Input};

use super::laws::{Laws, Point};
use super::runs::{Run, averaged, noise_of_motion};
use crate::jitter::jitter;
use crate::measured::{Measured, Output};
use crate::rms::rms;

/// Half length of the shortest window, s: what is faster than 100 Hz is no rigid shaft's.
const SHORTEST_S: f64 = 0.003;
/// Windows that a recording must hold at least.
const LEAST_WINDOWS: usize = 12;
/// Share of noise in the acceleration's squares up to which a window is long enough.
const QUIET: f64 = 0.01;
/// Share of the greatest speed below which the direction of dry friction is not certain.
pub(super) const SLOW: f64 = 0.02;
/// Standard deviations of a smoothed speed below which the shaft may be at rest.
const AT_REST: f64 = 4.0;
/// Windows that must be left once those that are slow are out, as a share of all.
const LEAST_MOVING: f64 = 0.02;
/// Laws are looked at along the motion averaged over this share of a window.
const OF_WINDOW: usize = 3;
/// Points at which the laws are tried for linearity.
const TRIED: usize = 60;

/// A recording averaged over windows.
pub(super) struct Windows {
    pub(super) runs: Vec<Averaged>,
    /// Variance of speed and acceleration by the sensors' noise.
    pub(super) noise: [f64; 2],
    /// Intervals in a window's half.
    pub(super) length: usize,
    /// Length of an interval, s.
    pub(super) period_s: f64,
}

/// A run averaged: one entry a window, and the points along it.
pub(super) struct Averaged {
    pub(super) driver: Vec<f64>,
    pub(super) load: Vec<f64>,
    pub(super) speed: Vec<f64>,
    pub(super) acceleration: Vec<f64>,
    points: Vec<Point>,
    /// Whether the direction of motion is certain over the whole window.
    moving: Vec<bool>,
}

/// How the balance is read.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Reading {
    /// What drives is a force by K_m.
    Force,
    /// By the measured current.
    Current,
    /// By the voltage, for want of a current.
    Voltage,
}

impl Reading {
    pub(super) fn of(drive: &Drive, measured: &Measured) -> Self {
        match (drive.motor.input, measured.output(Output::Current)) {
            (Input::Force, _) => Self::Force,
            (Input::Voltage, Some(_)) => Self::Current,
            (Input::Voltage, None) => Self::Voltage,
        }
    }
}

impl Windows {
    /// Of a recording; `sds` is the noise of its outputs. None if it tells no motion.
    pub(super) fn of(
        measured: &Measured,
        runs: &[Run],
        sds: &[f64],
        reading: Reading,
    ) -> Option<Self> {
        let h = measured.period_s;
        let by_position = measured.output(Output::Speed).is_none();
        let shown = if by_position { Output::Position } else { Output::Speed };
        let sd = measured.outputs.iter().zip(sds).find(|(it, _)| it.output == shown)?.1;
        let longest = runs.iter().map(|run| run.speed.len()).max()?;
        let most = (longest / (2 * LEAST_WINDOWS)).max(1);
        let mut length = ((SHORTEST_S / h).ceil() as usize).clamp(1, most);
        // Positions that are read a moment sooner or later are off by the way of the shaft in it.
        let speeds = runs.iter().flat_map(|run| run.speed.iter().copied());
        let off = (jitter(measured) * rms(speeds)).powi(2);
        let noise =
            |length| noise_of_motion(by_position, h, length).map(|gain| gain * (sd * sd + off));
        let share = |length: usize| {
            let squares = runs.iter().flat_map(|run| averaged(&run.acceleration, length));
            let (sum, count) = squares.fold((0.0, 0), |(sum, n), a| (sum + a * a, n + 1));
            noise(length)[1] / (sum / f64::from(count.max(1)))
        };
        // Where no window is quiet, the one in which the noise is least.
        let mut best = (f64::INFINITY, length);
        loop {
            let now = share(length);
            if now < best.0 {
                best = (now, length);
            }
            if now <= QUIET || length == most {
                break;
            }
            length = (length * 3 / 2 + 1).min(most);
        }
        let length = best.1;
        let fine = length.div_ceil(OF_WINDOW);
        let doubt = AT_REST * noise(fine)[0].sqrt();
        let smooth: Vec<Vec<f64>> = runs.iter().map(|run| averaged(&run.speed, fine)).collect();
        let greatest = smooth.iter().flatten().fold(0.0_f64, |most, w| most.max(w.abs()));
        let slow = (SLOW * greatest).max(doubt.min(greatest / 2.0));
        let made = runs.iter().filter(|run| run.speed.len() >= 2 * (length + fine));
        let runs: Vec<Averaged> =
            made.map(|run| Averaged::of(run, (length, fine), slow, (reading, h))).collect();
        let mut windows = Self { runs, noise: noise(length), length, period_s: h };
        windows.keep_some();
        (!windows.runs.is_empty()).then_some(windows)
    }

    /// Where the shaft hardly ever moves for certain, all windows count.
    fn keep_some(&mut self) {
        let all: usize = self.runs.iter().map(|run| run.moving.len()).sum();
        let moving = self.runs.iter().flat_map(|run| &run.moving).filter(|moves| **moves).count();
        if (moving as f64) < (LEAST_MOVING * all as f64).max(LEAST_WINDOWS as f64) {
            self.runs.iter_mut().for_each(|run| run.moving.fill(true));
        }
    }

    /// Some points along the motion.
    pub(super) fn some_points(&self) -> Vec<Point> {
        let all: Vec<Point> = self.runs.iter().flat_map(|run| run.points.iter().copied()).collect();
        let every = (all.len() / TRIED).max(1);
        all.into_iter().step_by(every).collect()
    }

    /// Sum of the squared accelerations, and their number.
    pub(super) fn acceleration(&self) -> [f64; 2] {
        let all = self.runs.iter().flat_map(|run| &run.acceleration);
        all.fold([0.0; 2], |[sum, n], a| [sum + a * a, n + 1.0])
    }

    /// Root mean square of the speed.
    pub(super) fn speed(&self) -> f64 {
        rms(self.runs.iter().flat_map(|run| run.speed.iter().copied()))
    }

    /// Windows with a certain direction, each with the run and its number there.
    pub(super) fn moving(&self) -> impl Iterator<Item = (usize, usize)> + '_ {
        self.runs.iter().enumerate().flat_map(|(r, run)| {
            run.moving.iter().enumerate().filter(|(_, moves)| **moves).map(move |(k, _)| (r, k))
        })
    }

    /// The brake of these laws averaged over the windows of each run.
    pub(super) fn braked(&self, laws: &Laws) -> Vec<Vec<f64>> {
        self.along(laws).0
    }

    /// The same, with the inertia of the shaft.
    pub(super) fn along(&self, laws: &Laws) -> (Vec<Vec<f64>>, f64) {
        let each = self.runs.iter().map(|run| laws.along(&run.points, self.period_s));
        let (braked, inertias): (Vec<_>, Vec<_>) = each.unzip();
        let braked = braked.iter().map(|brake| averaged(brake, self.length)).collect();
        (braked, inertias.first().copied().unwrap_or(f64::NAN))
    }
}

impl Averaged {
    fn of(
        run: &Run,
        (length, fine): (usize, usize),
        slow: f64,
        (reading, h): (Reading, f64),
    ) -> Self {
        let driver = if reading == Reading::Current { &run.current } else { &run.u };
        // Points lie where the finer average is known: they lack `margin` intervals at either end.
        let margin = fine - 1;
        let [current, speed, angle] =
            [driver, &run.speed, &run.angle].map(|values| averaged(values, fine));
        let point = |k: usize| Point {
            current: if reading == Reading::Voltage { 0.0 } else { current[k] },
            speed: speed[k],
            angle: angle[k],
            time: run.start_s + (k + margin) as f64 * h,
        };
        let points: Vec<Point> = (0..speed.len()).map(point).collect();
        // Over the windows for which all points are there.
        let windows = (points.len() + 2).saturating_sub(2 * length);
        let cut = |values: &[f64]| averaged(values, length)[margin..margin + windows].to_vec();
        let uncertain = |k: usize| {
            speed[k].abs() < slow || (k > 0 && speed[k].signum() != speed[k - 1].signum())
        };
        let mut sum = 0usize;
        let mut sums = vec![0usize];
        sums.extend((0..points.len()).map(|k| {
            sum += usize::from(uncertain(k));
            sum
        }));
        let moving = (0..windows).map(|k| sums[k + 2 * length - 1] == sums[k]).collect();
        Self {
            driver: cut(driver),
            load: cut(&run.load),
            speed: cut(&run.speed),
            acceleration: cut(&run.acceleration),
            points,
            moving,
        }
    }
}
