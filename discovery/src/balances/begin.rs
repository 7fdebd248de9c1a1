//! The values of a drive from its balances, one after the other: the voltage's first, for the
//! torque balance needs K.

use drivescope_plant::drive::Drive;

use super::laws::{Linear, without_states};
use super::scales::{speeds, tried};
use super::torque::{self, TorqueFit};
use super::voltage;
use super::windows::{Reading, Windows};
use super::{Balances, Begun, Told};
use crate::estimate::{Evidence, set};

/// Standard errors from which on an inertia is told.
const TOLD: f64 = 3.0;
/// A tried speed must leave at most this share of the squared error that the file's value leaves.
const CLEARLY_LESS: f64 = 0.98;
/// Rounds in which the load's share is made right where only the voltage was measured.
const ROUNDS: usize = 3;

/// The drive at the values that least squares on the balances of the recordings give. What they do
/// not tell, and what is fixed, keeps its value. The drive as it is if the balances say nothing at
/// all.
pub fn begin(drive: &Drive, evidence: &Evidence) -> Begun {
    let nothing = || Begun { drive: drive.clone(), told: Vec::new() };
    let Some(balances) = Balances::of(drive, evidence) else { return nothing() };
    let mut begun = nothing();
    let points: Vec<_> = balances.torque.iter().flat_map(Windows::some_points).collect();
    let linear = Linear::of(&without_states(drive), &points);
    if !balances.voltage.is_empty() {
        begin_voltage(&mut begun, &balances, &linear);
    }
    begin_torque(&mut begun, &balances, &linear, evidence);
    begun
}

fn is_fitted(drive: &Drive, name: &str) -> bool {
    drive.fitted().iter().any(|it| it.name == name)
}

/// Takes a value over if it is possible; its standard error, if the recordings tell it.
fn take(begun: &mut Begun, name: &str, value: Option<f64>, told: Option<f64>) {
    let Some(value) = value else { return };
    let range = begun.drive.parameters().iter().find(|it| it.name == name).map(|it| it.range);
    if range.is_some_and(|(low, high)| value.is_finite() && low <= value && value <= high) {
        set(&mut begun.drive, name, value);
        begun.told.retain(|it| it.name != name);
        begun.told.extend(told.map(|std_error| Told { name: name.to_owned(), std_error }));
    }
}

fn begin_voltage(begun: &mut Begun, balances: &Balances, linear: &Linear) {
    let fixed = voltage::OWN.map(|name| !is_fitted(&begun.drive, name));
    let found = voltage::solve(&balances.voltage, &linear.zero, &linear.of[1], fixed);
    let names = linear.of[1].iter().map(|it| it.name.as_str());
    let names: Vec<&str> = voltage::OWN.into_iter().chain(names).collect();
    for (name, value) in names.iter().zip(&found.values) {
        let possible = value.filter(|value| *value > 0.0 || !voltage::OWN.contains(name));
        take(begun, name, possible, Some(0.0));
    }
    let factor =
        balances.voltage.iter().map(|it| voltage::factor(it, &begun.drive)).fold(1.0, f64::max);
    for (name, error) in names.iter().zip(&found.errors) {
        let told = begun.told.iter_mut().find(|it| it.name == *name);
        if let Some(told) = told {
            told.std_error = error * factor;
        }
    }
}

fn begin_torque(begun: &mut Begun, balances: &Balances, linear: &Linear, evidence: &Evidence) {
    let columns = &linear.of[0];
    let by_voltage = balances.reading == Reading::Voltage;
    let fixed = [!is_fitted(&begun.drive, "J"), by_voltage || !is_fitted(&begun.drive, "B_m")];
    let mut zero = Drive { motor: begun.drive.motor.clone(), ..linear.zero.clone() };
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
    let inertia = found.values[0].filter(|j| *j > TOLD * found.errors[0] * balances.overlap());
    let names = columns.iter().map(|it| it.name.as_str());
    let names: Vec<&str> = ["J", "B_m"].into_iter().chain(names).collect();
    for (k, name) in names.iter().enumerate().filter(|(k, _)| *k > 1 || !fixed[*k]) {
        let (value, told) = match (k, found.values[k]) {
            // An inertia that is not told is begun with all the same: any other is no better.
            (0, value) => (value.map(|j| j * scale).filter(|j| *j > 0.0), inertia.map(|_| 0.0)),
            // A law that the recordings do not tell beside the others is not there.
            (_, None) if k > 1 => (Some(0.0), None),
            (_, value) => (value.map(|value| value * scale), value.map(|_| 0.0)),
        };
        take(begun, name, value, told);
    }
    let drive = &begun.drive;
    let factor = balances.torque.iter().map(|it| match by_voltage {
        true => balances.overlap(),
        false => torque::factor(it, drive),
    });
    let factor = scale * factor.fold(1.0, f64::max);
    for (name, error) in names.iter().zip(&found.errors) {
        if let Some(told) = begun.told.iter_mut().find(|it| it.name == *name) {
            told.std_error = error * factor;
        }
    }
    // Less than its own error: the value is as good as any, and not told.
    let j = begun.drive.motor.j;
    begun.told.retain(|it| it.name != "J" || it.std_error < j);
}

/// K of the sum K + B_m R / K.
fn constant(sum: f64, drive: &Drive) -> Option<f64> {
    let friction = drive.motor.b_m * drive.motor.r.unwrap_or(1.0);
    let root = (sum * sum - 4.0 * friction).max(0.0).sqrt();
    Some(0.5 * (sum + root)).filter(|k| *k > 0.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::balances::{small_inertia, unexplained};
    use crate::measured::Measured;
    use crate::testing::{bench, dr300, gaussian};
    use drivescope_recording::Recording;

    /// Standard errors that a value may be off, and what trapezoids and windows add, relative.
    const MOST_ERRORS: f64 = 4.0;
    const BIAS: f64 = 0.05;

    fn noisy(mut recording: Recording, sds: &[(&str, f64)]) -> Recording {
        for (seed, (name, sd)) in sds.iter().enumerate() {
            let signal = recording.signals.iter_mut().find(|it| it.name == *name).expect("there");
            let noise = gaussian(signal.values.len(), seed as u64 + 1);
            signal.values.iter_mut().zip(noise).for_each(|(value, noise)| *value += sd * noise);
        }
        recording
    }

    fn evidence(drive: &Drive, recording: &Recording, noise: &[f64]) -> Evidence {
        let measured = Measured::new(drive, recording).expect("usable");
        Evidence { recordings: vec![measured], noise: vec![noise.to_vec()] }
    }

    /// The drive with other values everywhere.
    fn elsewhere(drive: &Drive, factor: f64) -> Drive {
        let mut other = drive.clone();
        for (k, it) in drive.fitted().into_iter().enumerate() {
            set(&mut other, &it.name, it.value * if k % 2 == 0 { factor } else { 1.0 / factor });
        }
        other
    }

    fn value(drive: &Drive, name: &str) -> f64 {
        drive.parameters().into_iter().find(|it| it.name == name).expect("it has it").value
    }

    fn near(drive: &Drive, truth: &Drive, name: &str, share: f64) {
        let ratio = value(drive, name) / value(truth, name);
        assert!((ratio - 1.0).abs() < share, "{name}: {} of the truth", ratio);
    }

    #[test]
    fn both_balances_give_their_parameters_from_any_file() {
        let mut truth = dr300();
        truth.motor.k_m = truth.motor.k_e.expect("it has one");
        let recording = noisy(bench(&truth, 8.0, 0.001), &[("i", 0.01), ("omega", 0.3)]);
        let from = |factor| {
            let drive = elsewhere(&truth, factor);
            begin(&drive, &evidence(&drive, &recording, &[0.01, 0.3]))
        };
        let begun = from(3.0);
        for (name, share) in
            [("R", 0.02), ("K_e", 0.01), ("J", 0.03), ("L", 0.2), ("coulomb.T_c", 0.1)]
        {
            near(&begun.drive, &truth, name, share);
            let told = begun.told.iter().find(|it| it.name == name).expect("told");
            let off = value(&begun.drive, name) - value(&truth, name);
            let bound = MOST_ERRORS * told.std_error + BIAS * value(&truth, name);
            assert!(off.abs() < bound, "{name}: off by {off}, error {}", told.std_error);
        }
        // But for where a Stribeck speed of the file ends.
        let other = from(0.2).drive;
        ["R", "K_e", "J", "L"].iter().for_each(|name| near(&other, &begun.drive, name, 1e-3));
        let seen = evidence(&truth, &recording, &[0.01, 0.3]);
        let [torque, voltage] = unexplained(&truth, &seen).map(|it| it.expect("measured").share);
        assert!(torque < 0.05 && voltage < 0.02, "{torque} {voltage}");
    }

    #[test]
    fn a_position_without_a_current_gives_ratios() {
        let mut truth = dr300();
        truth.motor.k_m = truth.motor.k_e.expect("it has one");
        let mut recording = noisy(bench(&truth, 8.0, 0.001), &[("theta", 1e-3)]);
        recording.signals.retain(|signal| ["u", "theta"].contains(&signal.name.as_str()));
        let begun = begin(&truth, &evidence(&truth, &recording, &[1e-3]));
        for (name, share) in [("K_e", 0.03), ("J", 0.06), ("coulomb.T_c", 0.15)] {
            near(&begun.drive, &truth, name, share);
        }
        assert_eq!(begun.drive.motor.r, truth.motor.r);
    }

    #[test]
    fn steady_speeds_tell_friction_and_no_inertia() {
        let text = include_str!("../../../scenarios/drives/emps.toml").replace("linear", "rotary");
        let mut drive = Drive::parse(&text, "emps.toml").expect("a right drive file");
        drive.effects.retain(|effect| effect.kind == "coulomb");
        let speed = |k: usize| 10.0 + 5.0 * (k / 4) as f64;
        let signal =
            |name: &str, unit: &str, of: &dyn Fn(usize) -> f64| drivescope_recording::Signal {
                name: name.into(),
                unit: unit.into(),
                values: (0..40).map(of).collect(),
            };
        let torque = |k: usize| (2.0 + 0.05 * speed(k)) / drive.motor.k_m;
        let signals = vec![signal("u", "V", &torque), signal("omega", "rad/s", &speed)];
        let map = Recording::new("map", 0.0, 1.0, signals);
        let begun = begin(&drive, &evidence(&drive, &map, &[0.01]));
        assert!(!begun.told.iter().any(|it| it.name == "J"), "{:?}", begun.told);
        let value = |name: &str| value(&begun.drive, name);
        assert!((value("B_m") - 0.05).abs() < 0.01, "{}", value("B_m"));
        assert!((value("coulomb.T_c") - 2.0).abs() < 0.2, "{}", value("coulomb.T_c"));
        let small = small_inertia(&begun.drive, &evidence(&drive, &map, &[0.01])).expect("moved");
        assert!(small * 5.0 < 0.1 * 4.0, "{small}");
    }
}
