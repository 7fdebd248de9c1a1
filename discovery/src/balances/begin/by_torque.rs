//! The values that the torque balance (21) gives.

use drivescope_plant::drive::Drive;

use super::super::laws::Linear;
use super::super::scales::{speeds, tried};
use super::super::torque::{self, TorqueFit};
use super::super::windows::Reading;
use super::super::{Balances, Begun};
use super::{is_fitted, take};
use crate::estimate::Evidence;

/// Standard errors from which on an inertia is told.
const IDENTIFIED: f64 = 3.0;
/// A tried speed must leave at most this share of the squared error that the file's value leaves.
const CLEARLY_LESS: f64 = 0.98;
/// Rounds in which the load's share is made right where only the voltage was measured.
const ROUNDS: usize = 3;

/// Takes over what the torque balance tells.
pub(super) fn begin(begun: &mut Begun, balances: &Balances, linear: &Linear, evidence: &Evidence) {
    let columns = &linear.of[0];
    let by_voltage = balances.reading == Reading::Voltage;
    let fixed = [!is_fitted(&begun.drive, "J"), by_voltage || !is_fitted(&begun.drive, "B_m")];
    let mut zero = Drive { motor: begun.drive.motor, ..linear.zero.clone() };
    if by_voltage {
        // K and viscous friction brake alike: the latter keeps the file's value, and its share of
        // the column is taken off where K is.
        zero.motor.b_m = 0.0;
    }
    let mut per_volt = zero.motor.k_m / zero.motor.r.unwrap_or(1.0);
    let fit = |zero: &Drive, per_volt: f64| {
        let fixed = [fixed[0], fixed[1] && !by_voltage];
        let fit =
            TorqueFit::new(&balances.torque, zero, columns, (balances.reading, per_volt), fixed);
        fit.solve(columns, fixed)
    };
    for it in speeds(&linear.others) {
        let least = tried(it, evidence).map(|value| {
            let mut with = zero.clone();
            let sse =
                with.set(&it.name, value).map_or(f64::INFINITY, |()| fit(&with, per_volt).sse);
            (sse, value)
        });
        let least = least.min_by(|a, b| a.0.total_cmp(&b.0));
        let now = fit(&zero, per_volt).sse;
        if let Some((_, value)) = least.filter(|(sse, _)| *sse < CLEARLY_LESS * now) {
            take(begun, &it.name, Some(value), None);
            let _ = zero.set(&it.name, value);
        }
    }
    let mut found = fit(&zero, per_volt);
    if by_voltage {
        for _ in 0..ROUNDS {
            let Some(k) = found.values[1].filter(|_| is_fitted(&begun.drive, "K_e")) else { break };
            take(
                begun,
                "K_e",
                constant(k, &begun.drive),
                Some(found.errors[1] * balances.overlap()),
            );
            per_volt = begun.drive.motor.k_m / begun.drive.motor.r.unwrap_or(1.0);
            found = fit(&zero, per_volt);
        }
    }
    let scale = if by_voltage { per_volt } else { 1.0 };
    let inertia =
        found.values[0].filter(|j| *j > IDENTIFIED * found.errors[0] * balances.overlap());
    let names = columns.iter().map(|it| it.name.as_str());
    let names: Vec<&str> = ["J", "B_m"].into_iter().chain(names).collect();
    for (k, name) in names.iter().enumerate().filter(|(k, _)| *k > 1 || !fixed[*k]) {
        let (value, identified) = match (k, found.values[k]) {
            // An inertia that is not told is begun with all the same: any other is no better.
            (0, value) => (value.map(|j| j * scale).filter(|j| *j > 0.0), inertia.map(|_| 0.0)),
            // A law that the recordings do not tell beside the others is not there.
            (_, None) if k > 1 => (Some(0.0), None),
            (_, value) => (value.map(|value| value * scale), value.map(|_| 0.0)),
        };
        take(begun, name, value, identified);
    }
    let drive = &begun.drive;
    let factor = balances.torque.iter().map(|it| match by_voltage {
        true => balances.overlap(),
        false => torque::factor(it, drive),
    });
    let factor = scale * factor.fold(1.0, f64::max);
    for (name, error) in names.iter().zip(&found.errors) {
        if let Some(identified) = begun.identified.iter_mut().find(|it| it.name == *name) {
            identified.std_error = error * factor;
        }
    }
    // Less than its own error: the value is as good as any, and not told.
    let j = begun.drive.motor.j;
    begun.identified.retain(|it| it.name != "J" || it.std_error < j);
}

/// K of the sum K + B_m R / K.
fn constant(sum: f64, drive: &Drive) -> Option<f64> {
    let friction = drive.motor.b_m * drive.motor.r.unwrap_or(1.0);
    let root = (sum * sum - 4.0 * friction).max(0.0).sqrt();
    Some(0.5 * (sum + root)).filter(|k| *k > 0.0)
}
