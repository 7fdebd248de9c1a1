//! What the drive did along a recording, by the model: the variables over which it may fail.
//!
//! The model's own signals are taken, not the measured ones: they have no noise, and they stand
//! still exactly where the model does. Beside a random load they are the filter's.

use drivescope_plant::drive::Input;
use drivescope_plant::model::{CURRENT, POSITION, SPEED};

use crate::case::Case;
use crate::likelihood::{Recorded, Tick};
use crate::measured::Measured;
use crate::run::Runner;
use crate::sign::sign;

/// Share of the samples whose magnitude is below what counts as a signal's usual top: a short
/// peak must not stretch the bins.
const TOP: f64 = 0.998;

/// Signals of one recording, one value a sample, 0 between the pieces.
pub(super) struct DriveMotion {
    /// Current, A (force-driven: the command).
    pub(super) i: Vec<f64>,
    /// Speed, rad/s (m/s).
    pub(super) omega: Vec<f64>,
    /// Angle, rad (position, m); the measured one where there is one.
    pub(super) theta: Vec<f64>,
    /// Sign of the motion, 0 at rest.
    pub(super) direction: Vec<f64>,
    /// Acceleration over the coming sample.
    pub(super) alpha: Vec<f64>,
    /// Input.
    pub(super) u: Vec<f64>,
    /// Share of the recording that has passed.
    pub(super) share: Vec<f64>,
    /// Way since the motion last began or turned, rad (m).
    pub(super) since: Vec<f64>,
    /// Sampling time, s.
    pub(super) period_s: f64,
    /// Place among the recordings.
    pub(super) place: usize,
    /// Whether the drive is driven by force: it has no armature circuit.
    pub(super) force: bool,
}

impl DriveMotion {
    pub(super) fn new(case: &Case<'_>, place: usize) -> Self {
        let measured = case.measured;
        let zeros = || vec![0.0; measured.len()];
        let mut path = Self {
            i: zeros(),
            omega: zeros(),
            theta: zeros(),
            direction: zeros(),
            alpha: zeros(),
            u: measured.u.clone(),
            share: (0..measured.len()).map(|k| k as f64 / measured.len() as f64).collect(),
            since: zeros(),
            period_s: measured.period_s,
            place,
            force: case.drive.motor.input == Input::Force,
        };
        let mut runner = Runner::of_values(case);
        for (piece, start) in measured.pieces.iter().zip(case.starts) {
            let (mut way, mut last) = (0.0, 0.0);
            for k in piece.clone() {
                // The runner takes up the start with the first sample of a piece.
                let before = |state: usize| match k == piece.start {
                    true => start.values()[state],
                    false => finite(runner.state().x[state][0]),
                };
                let [current, speed, position] = [CURRENT, SPEED, POSITION].map(before);
                runner.sample(k, [0.0; 2]);
                path.i[k] = if path.force { measured.u[k] } else { current };
                path.omega[k] = speed;
                path.theta[k] = measured.angle.as_ref().map_or(position, |angle| angle[k]);
                path.direction[k] = sign(speed);
                if path.direction[k] != last {
                    (way, last) = (0.0, path.direction[k]);
                }
                way += speed.abs() * path.period_s;
                path.since[k] = way;
                if k > piece.start {
                    path.alpha[k - 1] = (speed - path.omega[k - 1]) / path.period_s;
                }
            }
        }
        path
    }

    /// The same by the filter, which follows what was measured: one value a tick of its `whole` recording,
    /// or of the stretches and means of it that are filtered.
    pub(super) fn filtered(it: &Recorded, ticks: &[Tick], whole: &Measured) -> Self {
        let measured = &it.measured;
        let force = it.drive.motor.input == Input::Force;
        let each = |f: &dyn Fn(&Tick) -> f64| ticks.iter().map(f).collect::<Vec<f64>>();
        let times: Vec<f64> = (0..whole.len()).map(|k| whole.time(k)).collect();
        let passed = |tick: &Tick| {
            let time = measured.time(tick.sample);
            times.partition_point(|it| *it < time) as f64 / times.len() as f64
        };
        let place = |tick: &Tick| {
            let of_angle = measured.angle.as_ref().map(|angle| angle[tick.sample]);
            of_angle.unwrap_or(tick.mean[POSITION])
        };
        let (mut way, mut last) = (0.0, 0.0);
        let mut since = |tick: &Tick| {
            let direction = it.direction.at(tick.sample);
            if tick.begins || direction != last {
                (way, last) = (0.0, direction);
            }
            way += tick.mean[SPEED].abs() * measured.period_s;
            way
        };
        Self {
            since: ticks.iter().map(&mut since).collect(),
            i: each(&|tick| if force { measured.u[tick.sample] } else { tick.mean[CURRENT] }),
            omega: each(&|tick| tick.mean[SPEED]),
            theta: each(&place),
            direction: each(&|tick| it.direction.at(tick.sample)),
            alpha: each(&|tick| tick.acceleration(measured.period_s)),
            u: each(&|tick| measured.u[tick.sample]),
            share: each(&passed),
            period_s: measured.period_s,
            place: it.place,
            force,
        }
    }

    pub(super) fn len(&self) -> usize {
        self.u.len()
    }
}

fn finite(value: f64) -> f64 {
    if value.is_finite() { value } else { 0.0 }
}

/// Usual tops of signals, the same for all recordings.
#[derive(Debug, Clone, Copy)]
pub(super) struct Scales {
    pub(super) i: f64,
    pub(super) omega: f64,
    pub(super) alpha: f64,
    /// Inertia, kg m^2 (kg).
    pub(super) inertia: f64,
}

impl Scales {
    pub(super) fn new(paths: &[DriveMotion], inertia: f64) -> Self {
        let top = |signal: fn(&DriveMotion) -> &Vec<f64>| {
            quantile(paths.iter().flat_map(|path| signal(path).iter().map(|v| v.abs())), TOP)
        };
        Self {
            i: top(|path| &path.i),
            omega: top(|path| &path.omega),
            alpha: top(|path| &path.alpha),
            inertia,
        }
    }
}

/// The value below which that share of the values lies; 1 if that is not above 0.
pub(super) fn quantile(values: impl Iterator<Item = f64>, share: f64) -> f64 {
    let mut all: Vec<f64> = values.collect();
    if all.is_empty() {
        return 1.0;
    }
    let at = ((all.len() - 1) as f64 * share) as usize;
    let (_, value, _) = all.select_nth_unstable_by(at, f64::total_cmp);
    if *value > 0.0 { *value } else { 1.0 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rig::Rig;
    use crate::testing::{bench, dr300};

    #[test]
    fn the_path_is_the_run_that_made_the_recording() {
        let mut drive = dr300();
        // The file's K_m is not its K_e, to which a fit ties it.
        drive.motor.tie_k = false;
        let recording = bench(&drive, 2.0, 0.001);
        let rig = Rig::new(drive, &recording, &[0.01, 0.3], 0.0);
        let path = DriveMotion::new(&rig.case(), 0);
        let omega = &recording.signal("omega").expect("it is there").values;
        let top = omega.iter().fold(0.0_f64, |most, w| most.max(w.abs()));
        // The accuracy that the pace of an estimate keeps.
        const PACED: f64 = 1e-4;
        for (found, shown) in path.omega.iter().zip(omega) {
            assert!((found - shown).abs() < PACED * top, "{found} against {shown}");
        }
        assert!(path.direction.contains(&0.0) && path.direction.contains(&-1.0));
        let reversal = (1..path.len()).find(|k| path.direction[*k] * path.direction[k - 1] < 0.0);
        if let Some(k) = reversal {
            assert!(path.since[k] <= path.omega[k].abs() * path.period_s * 1.001);
        }
    }

    #[test]
    fn a_quantile_leaves_peaks_out() {
        let values = (0..1000).map(|k| if k == 0 { 1e6 } else { f64::from(k) });
        assert_eq!(quantile(values, 0.998), 998.0);
        assert_eq!(quantile([0.0].into_iter(), 0.5), 1.0);
    }
}
