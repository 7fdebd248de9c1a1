//! The values of a drive from its balances, one after the other: the voltage's first, for the
//! torque balance needs K.

mod by_torque;
mod by_voltage;

use drivescope_plant::drive::Drive;
use drivescope_plant::effects::registry::Entry;
use drivescope_plant::model::{Applied, AtRest, at_rest};

use super::laws::{Linear, without_states};
use super::windows::Windows;
use super::{Balances, Begun, Identified};
use crate::estimate::{Evidence, set};

/// The drive at the values that least squares on the balances of the recordings give. What they do
/// not tell, and what is fixed, keeps its value. The drive as it is if the balances say nothing at
/// all.
pub fn begin(drive: &Drive, evidence: &Evidence) -> Begun {
    let nothing = || Begun { drive: drive.clone(), identified: Vec::new() };
    let Some(balances) = Balances::of(drive, evidence) else { return nothing() };
    let mut begun = nothing();
    let points: Vec<_> = balances.torque.iter().flat_map(Windows::some_points).collect();
    let linear = Linear::of(&without_states(drive), &points);
    if !balances.voltage.is_empty() {
        by_voltage::begin(&mut begun, &balances, &linear);
    }
    by_torque::begin(&mut begun, &balances, &linear, evidence);
    release(&mut begun, drive, evidence);
    begun
}

/// Gives laws of dry friction their values in that drive back, the one first that holds the shaft most,
/// while they would hold it against all that drives it: no recording in which it moves has such a
/// level. Where it moves fast throughout, least squares find any for a Stribeck torque.
fn release(begun: &mut Begun, from: &Drive, evidence: &Evidence) {
    let is_dry = |k: &usize| Entry::find(&from.effects[*k].kind).is_some_and(|law| law.info.dry);
    let mut dry: Vec<usize> = (0..from.effects.len()).filter(is_dry).collect();
    let driving = evidence.driving(&begun.drive);
    while level(&begun.drive) > driving {
        let with = |k: usize| {
            let mut drive = begun.drive.clone();
            drive.effects[k].clone_from(&from.effects[k]);
            drive
        };
        let lowest = |a: &usize, b: &usize| level(&with(*a)).total_cmp(&level(&with(*b)));
        let Some(k) = dry.iter().copied().min_by(lowest) else { return };
        dry.retain(|it| *it != k);
        begun.drive = with(k);
        begun.identified.retain(|it| !it.name.starts_with(&format!("{}.", from.effects[k].id)));
    }
}

/// Torques (forces) of dry friction on a shaft at rest.
pub(crate) fn friction_at_rest(drive: &Drive) -> AtRest<f64> {
    let model = drive.model();
    let applied = Applied { u: [0.0], load: [0.0], time: 0.0 };
    at_rest(&model, &vec![[0.0]; model.states()], &applied)
}

/// The lower one of both directions, N m (N).
fn level(drive: &Drive) -> f64 {
    let levels = friction_at_rest(drive);
    levels.forward.min(levels.backward)
}

fn is_fitted(drive: &Drive, name: &str) -> bool {
    drive.fitted().iter().any(|it| it.name == name)
}

/// Takes a value over if it is possible; its standard error, if the recordings tell it.
fn take(begun: &mut Begun, name: &str, value: Option<f64>, identified: Option<f64>) {
    let Some(value) = value else { return };
    let range = begun.drive.parameters().iter().find(|it| it.name == name).map(|it| it.range);
    if range.is_some_and(|(low, high)| value.is_finite() && low <= value && value <= high) {
        set(&mut begun.drive, name, value);
        begun.identified.retain(|it| it.name != name);
        begun
            .identified
            .extend(identified.map(|std_error| Identified { name: name.to_owned(), std_error }));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::balances::{small_inertia, unexplained};
    use crate::measured::Measured;
    use crate::testing::{bench, dr300, gaussian};
    use drivescope_plant::drive::EffectData;
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
            let identified = begun.identified.iter().find(|it| it.name == name).expect("told");
            let off = value(&begun.drive, name) - value(&truth, name);
            let bound = MOST_ERRORS * identified.std_error + BIAS * value(&truth, name);
            assert!(off.abs() < bound, "{name}: off by {off}, error {}", identified.std_error);
        }
        // But for where a Stribeck speed of the file ends.
        let other = from(0.2).drive;
        ["R", "K_e", "J", "L"].iter().for_each(|name| near(&other, &begun.drive, name, 1e-3));
        let seen = evidence(&truth, &recording, &[0.01, 0.3]);
        let [torque, voltage] = unexplained(&truth, &seen).map(|it| it.expect("measured").share);
        assert!(torque < 0.05 && voltage < 0.02, "{torque} {voltage}");
    }

    #[test]
    fn a_load_of_each_recording_is_its_own_in_what_stays_unexplained() {
        let mut truth = dr300();
        truth.motor.k_m = truth.motor.k_e.expect("it has one");
        let loaded = |torque: f64| {
            let mut drive = truth.clone();
            drive.effects.push(EffectData {
                kind: "constant_load".to_owned(),
                id: "constant_load".to_owned(),
                parameters: vec![("T_0".to_owned(), torque)],
                law: None,
            });
            drive
        };
        let recordings = [0.02, -0.02].map(|torque| bench(&loaded(torque), 4.0, 0.001));
        let measured = recordings.map(|it| Measured::new(&truth, &it).expect("usable"));
        let seen = Evidence { recordings: measured.to_vec(), noise: vec![vec![1e-3, 1e-2]; 2] };
        let left = |drive: &Drive| unexplained(drive, &seen)[0].expect("measured").share;
        let shared = loaded(0.0);
        let mut own = shared.clone();
        own.per_recording.push("constant_load.T_0".to_owned());
        assert!(left(&own) < 0.2 * left(&shared), "{} {}", left(&own), left(&shared));
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
        let text =
            include_str!("../../../../scenarios/drives/emps.toml").replace("linear", "rotary");
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
        assert!(!begun.identified.iter().any(|it| it.name == "J"), "{:?}", begun.identified);
        let value = |name: &str| value(&begun.drive, name);
        assert!((value("B_m") - 0.05).abs() < 0.01, "{}", value("B_m"));
        assert!((value("coulomb.T_c") - 2.0).abs() < 0.2, "{}", value("coulomb.T_c"));
        let small = small_inertia(&begun.drive, &evidence(&drive, &map, &[0.01])).expect("moved");
        assert!(small * 5.0 < 0.1 * 4.0, "{small}");
    }
}
