//! The torque balance J domega/dt + B_m omega + brake = K_m i - T_l over windows of a recording.
//!
//! Without a measured current a voltage-driven motor is looked at through its voltage: the armature
//! is quick, so that i = (u - K omega) / R and
//! u = (K + B_m R / K) omega + R / K (J domega/dt + brake + T_l).

use drivescope_plant::drive::Drive;
use drivescope_plant::parameters::NamedParameter;

use super::laws::Laws;
use super::solve::{Normal, Solution};
use super::windows::{Reading, Windows};
use crate::estimate::correlation_samples;

/// The linear problem of the torque balance over all recordings.
pub(super) struct TorqueFit {
    /// Columns: J, B_m, then the linear parameters.
    pub(super) normal: Normal,
    /// Variance of each column's noise.
    pub(super) noise: Vec<f64>,
    reading: Reading,
}

impl TorqueFit {
    /// With columns J, B_m and those parameters; `zero` holds what is known, `fixed` whether J and
    /// B_m are. Without a current the target is the voltage, and `per_volt` the torque a volt.
    pub(super) fn new(
        all: &[Windows],
        zero: &Drive,
        columns: &[NamedParameter],
        (reading, per_volt): (Reading, f64),
        fixed: [bool; 2],
    ) -> Self {
        let known = [zero.motor.j, zero.motor.b_m];
        let still = Laws::new(zero);
        let each: Vec<Laws> = columns.iter().filter_map(|it| at_nominal(zero, it)).collect();
        let mut normal = Normal::new(2 + each.len());
        let (mut noise, mut rows) = (vec![0.0; 2 + each.len()], 0.0);
        for windows in all {
            let brake = windows.braked(&still);
            let shares: Vec<Vec<Vec<f64>>> = each.iter().map(|laws| windows.braked(laws)).collect();
            let before = normal.rows();
            for (r, k) in windows.moving() {
                let run = &windows.runs[r];
                let share = |(share, it): (&Vec<Vec<f64>>, &NamedParameter)| {
                    (share[r][k] - brake[r][k]) / it.nominal
                };
                let mut row = vec![run.acceleration[k], run.speed[k]];
                row.extend(shares.iter().zip(columns).map(share));
                let taken = (0..2).filter(|it| fixed[*it]).map(|it| known[it] * row[it]);
                let taken = taken.sum::<f64>() + run.load[k] + brake[r][k];
                let target = match reading {
                    Reading::Voltage => run.driver[k] - taken / per_volt,
                    _ => zero.motor.k_m * run.driver[k] - taken,
                };
                normal.push(&row, target);
            }
            let added = (normal.rows() - before) as f64;
            noise[0] += windows.noise[1] * added;
            noise[1] += windows.noise[0] * added;
            rows += added;
        }
        noise.iter_mut().for_each(|it| *it /= f64::max(rows, 1.0));
        Self { normal, noise, reading }
    }

    /// The solution; dry friction is preferred to viscous, and both to what may have either sign. Where
    /// the voltage is read, the induced voltage comes first: no motor is without it.
    pub(super) fn solve(&self, columns: &[NamedParameter], fixed: [bool; 2]) -> Solution {
        let signed = |it: &NamedParameter| it.range.0 < 0.0;
        let mut order: Vec<usize> = (0..2 + columns.len()).collect();
        order.retain(|k| *k > 1 || !fixed[*k]);
        order.sort_by_key(|k| match *k {
            0 => 0,
            1 if self.reading == Reading::Voltage => 1,
            1 => 3,
            k if columns[k - 2].name.starts_with("coulomb.") => 2,
            k if signed(&columns[k - 2]) => 5,
            _ => 4,
        });
        let signs: Vec<bool> = [false; 2].into_iter().chain(columns.iter().map(signed)).collect();
        self.normal.solve(&self.noise, &signs, &order)
    }
}

fn at_nominal(zero: &Drive, parameter: &NamedParameter) -> Option<Laws> {
    let mut drive = zero.clone();
    drive.set(&parameter.name, parameter.nominal).ok().map(|()| Laws::new(&drive))
}

/// Torques of a window, N m (N), and its acceleration.
struct Torques {
    applied: f64,
    /// What loads and laws take of it, all but the inertia.
    taken: f64,
    /// What the inertia takes.
    inertial: f64,
    acceleration: f64,
}

/// The torques of a drive, window by window.
fn torques<'a>(windows: &'a Windows, drive: &'a Drive) -> impl Iterator<Item = Torques> + 'a {
    let motor = &drive.motor;
    let (brake, inertia) = windows.along(&Laws::of_drive(drive));
    windows.moving().map(move |(r, k)| {
        let run = &windows.runs[r];
        let acceleration = run.acceleration[k];
        Torques {
            applied: motor.k_m * run.driver[k],
            taken: run.load[k] + motor.b_m * run.speed[k] + brake[r][k],
            inertial: inertia * acceleration,
            acceleration,
        }
    })
}

/// What the drive leaves unexplained of the torque, window by window, and the applied torque.
fn missing<'a>(windows: &'a Windows, drive: &'a Drive) -> impl Iterator<Item = [f64; 2]> + 'a {
    torques(windows, drive).map(|it| [it.applied - it.taken - it.inertial, it.applied])
}

/// Products of the acceleration and the torque that is left for it: of both with themselves, and with
/// each other.
pub(super) fn accelerating(windows: &Windows, drive: &Drive) -> [f64; 3] {
    torques(windows, drive).fold([0.0; 3], |[a, t, both], it| {
        let left = it.applied - it.taken;
        [a + it.acceleration * it.acceleration, t + left * left, both + it.acceleration * left]
    })
}

/// Squares of the torque that the drive leaves unexplained, and of the applied one, with their
/// number.
pub(super) fn unexplained(windows: &Windows, drive: &Drive) -> [f64; 3] {
    let add = |[sum, all, n]: [f64; 3], [missing, applied]: [f64; 2]| {
        [sum + missing * missing, all + applied * applied, n + 1.0]
    };
    missing(windows, drive).fold([0.0; 3], add)
}

/// Root mean square of the torque that the drive leaves unexplained, averaged over that time, s.
pub(super) fn slowly_missing(windows: &Windows, drive: &Drive, time_s: f64) -> f64 {
    let remainder: Vec<f64> = missing(windows, drive).map(|it| it[0]).collect();
    let samples = ((time_s / windows.period_s).ceil() as usize).clamp(1, remainder.len().max(1));
    let means = remainder.chunks(samples).map(|some| some.iter().sum::<f64>() / some.len() as f64);
    let (sum, n) = means.fold((0.0, 0.0), |(sum, n), mean| (sum + mean * mean, n + 1.0));
    (sum / f64::max(n, 1.0)).sqrt()
}

/// By how much a standard error is larger than of independent windows.
pub(super) fn factor(windows: &Windows, drive: &Drive) -> f64 {
    let remainder: Vec<f64> = missing(windows, drive).map(|it| it[0]).collect();
    (1.0 + 2.0 * correlation_samples(&remainder, windows.period_s)).sqrt()
}
