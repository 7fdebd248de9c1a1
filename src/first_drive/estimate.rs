//! Rough values by linear regression over short windows of the recording.
//!
//! Balances (20)-(23) are integrated over each window, so that no signal is differentiated:
//!
//! ```text
//! sum u h            = R int i + L (i_b - i_a) + K_e int omega
//! K_m int i - int T_l = J (omega_b - omega_a) + B_m int omega + T_c int sgn omega
//! ```
//!
//! u is held between samples, so its sum is exact; the other integrals are trapezoids. Without a
//! current the two are one, of which only ratios to R (force-driven: to K_m) can be known:
//!
//! ```text
//! sum u h = (J / k) (omega_b - omega_a) + b int omega + (T_c / k) int sgn omega,
//! voltage: k = K / R, b = K + B_m / k;  force: k = K_m, b = B_m / k
//! ```

use drivescope_numerics::Regression;
use drivescope_plant::drive::Input;

use super::signals::Signals;
use super::{FirstDrive, Origin, Value};

/// Length of a window of the electrical balance, s: a few time constants of a small armature.
const ELECTRICAL_S: f64 = 0.01;
/// Length of a window of the torque balance, s.
const MECHANICAL_S: f64 = 0.05;
/// Windows that there should be at least.
const LEAST_WINDOWS: usize = 8;
/// Share of the greatest speed below which the direction of dry friction is not certain.
const SLOW: f64 = 0.02;

/// What a small motor has where the recording does not tell: R ohm, L / R s, K V s/rad, J / K.
const USUAL: [f64; 4] = [1.0, 1e-3, 0.05, 2e-3];
/// Friction torque over the torque constant where the recording does not tell, A.
const USUAL_FRICTION: f64 = 0.1;

const BY_U: &str = "estimated: regression of u on i, its change, and the speed";
const BY_TORQUE: &str = "estimated: torque balance over short windows, K_m = K_e";
const BY_U_ALONE: &str =
    "estimated: regression of u on the speed and its change; scales with the guess it rests on";
const MEASURE_R: &str = "measure the resistance between the terminals";
const MEASURE_L: &str =
    "take it from the data sheet; a fit finds it if the recording is fast enough";
const NEEDS_EXCITATION: &str = "take it from the data sheet, or record steps and reversals";
const NEEDS_KNOWN_K: &str =
    "take it from the data sheets of amplifier and motor: only ratios to it can be measured";

fn estimated(value: f64, how: &'static str) -> Value {
    Value { value, origin: Origin::Estimated(how) }
}

fn guessed(value: f64, todo: &'static str) -> Value {
    Value { value, origin: Origin::Guessed(todo) }
}

/// The estimate where it is physically possible, else the guess.
fn or_guess(found: Option<f64>, how: &'static str, guess: f64, todo: &'static str) -> Value {
    match found.filter(|value| value.is_finite() && *value > 0.0) {
        Some(value) => estimated(value, how),
        None => guessed(guess, todo),
    }
}

/// The same for what may be zero; a small negative value is zero measured badly.
fn or_zero(found: Option<f64>, how: &'static str, guess: f64) -> Value {
    match found.filter(|value| value.is_finite()) {
        Some(value) => estimated(value.max(0.0), how),
        None => guessed(guess, NEEDS_EXCITATION),
    }
}

/// A window: its first sample and the sample after its end.
type Window = (usize, usize);

/// Windows of about that length that overlap by half.
fn windows(samples: usize, period_s: f64, length_s: f64) -> impl Iterator<Item = Window> {
    let wanted = (length_s / period_s).round() as usize;
    let length = wanted.min(samples / LEAST_WINDOWS).max(2);
    let last = samples.saturating_sub(length);
    (0..last).step_by(length / 2).map(move |from| (from, from + length))
}

fn trapezoid(values: &[f64], (from, to): Window, period_s: f64) -> f64 {
    let inner: f64 = values[from..=to].iter().sum();
    (inner - 0.5 * (values[from] + values[to])) * period_s
}

fn change(values: &[f64], (from, to): Window) -> f64 {
    values[to] - values[from]
}

fn solved(regression: &Regression, columns: &[usize]) -> Option<Vec<f64>> {
    regression.solve_columns(columns).ok().map(|fit| fit.parameters)
}

/// R, L, K_e of the electrical balance; L falls away where it cannot be told.
fn electrical(signals: &Signals, i: &[f64]) -> Option<(f64, Option<f64>, f64)> {
    let h = signals.period_s;
    let mut balance = Regression::new(3);
    for window in windows(i.len(), h, ELECTRICAL_S) {
        let u: f64 = signals.u[window.0..window.1].iter().sum();
        let speed = trapezoid(&signals.speed, window, h);
        balance.push([trapezoid(i, window, h), change(i, window), speed], u * h);
    }
    let all = solved(&balance, &[0, 1, 2]).filter(|found| found[1] > 0.0);
    match all {
        Some(found) => Some((found[0], Some(found[1]), found[2])),
        None => solved(&balance, &[0, 2]).map(|found| (found[0], None, found[1])),
    }
}

/// Inertia, viscous and Coulomb friction that turn the windows of `torque` into motion, in units
/// of that torque.
fn mechanical(signals: &Signals, torque: impl Fn(Window) -> f64) -> Option<[f64; 3]> {
    let (h, speed) = (signals.period_s, &signals.speed);
    let greatest = speed.iter().fold(0.0, |most: f64, value| most.max(value.abs()));
    let mut balance = Regression::new(3);
    for window in windows(speed.len(), h, MECHANICAL_S) {
        let within = &speed[window.0..=window.1];
        let moves =
            within.iter().all(|w| w.abs() > SLOW * greatest && w.signum() == within[0].signum());
        if moves {
            let duration = (window.1 - window.0) as f64 * h;
            let dry = within[0].signum() * duration;
            balance.push([change(speed, window), trapezoid(speed, window, h), dry], torque(window));
        }
    }
    if balance.rows() < LEAST_WINDOWS {
        return None;
    }
    // Viscous friction is the first to go where speeds do not differ enough, or it comes out
    // negative because something else bends the curve.
    let all = solved(&balance, &[0, 1, 2]).filter(|found| found[1] >= 0.0 && found[2] >= 0.0);
    let found = all.map(|found| [found[0], found[1], found[2]]);
    found.or_else(|| solved(&balance, &[0, 2]).map(|found| [found[0], 0.0, found[1]]))
}

/// What the signals say of the drive.
pub(super) fn first_drive(signals: &Signals) -> FirstDrive {
    let (input, because) = signals.input;
    let electrical = match (&signals.i, input) {
        (Some(i), Input::Voltage) => with_current(signals, i),
        (None, Input::Voltage) => voltage_alone(signals),
        (_, Input::Force) => force(signals),
    };
    let Values { r, l, k, j, b_m, t_c } = electrical;
    FirstDrive {
        recording: signals.name.clone(),
        motion: signals.motion,
        input,
        because,
        u_unit: signals.u_unit.clone(),
        r,
        l,
        k,
        j,
        b_m,
        t_c,
        controlled: signals.controlled,
    }
}

struct Values {
    r: Option<Value>,
    l: Option<Value>,
    k: Value,
    j: Value,
    b_m: Value,
    t_c: Value,
}

fn with_current(signals: &Signals, i: &[f64]) -> Values {
    let h = signals.period_s;
    let [usual_r, usual_time, usual_k, usual_j] = USUAL;
    let found = electrical(signals, i);
    let r = or_guess(found.map(|f| f.0), BY_U, usual_r, MEASURE_R);
    let l = or_guess(found.and_then(|f| f.1), BY_U, r.value * usual_time, MEASURE_L);
    let k = or_guess(found.map(|f| f.2), BY_U, usual_k, NEEDS_EXCITATION);
    let load = |window| signals.load.as_ref().map_or(0.0, |load| trapezoid(load, window, h));
    let motion = mechanical(signals, |window| k.value * trapezoid(i, window, h) - load(window));
    Values {
        j: or_guess(motion.map(|m| m[0]), BY_TORQUE, usual_j * k.value, NEEDS_EXCITATION),
        b_m: or_zero(motion.map(|m| m[1]), BY_TORQUE, 0.0),
        t_c: or_zero(motion.map(|m| m[2]), BY_TORQUE, USUAL_FRICTION * k.value),
        r: Some(r),
        l: Some(l),
        k,
    }
}

/// The windows of u, less the load where it was measured; `per_u` is the torque a unit of u.
fn by_u(signals: &Signals, per_u: f64) -> Option<[f64; 3]> {
    let h = signals.period_s;
    mechanical(signals, |window| {
        let u: f64 = signals.u[window.0..window.1].iter().sum();
        let load = signals.load.as_ref().map_or(0.0, |load| trapezoid(load, window, h));
        u * h - load / per_u
    })
}

fn voltage_alone(signals: &Signals) -> Values {
    let [r, usual_time, usual_k, usual_j] = USUAL;
    // A load can only be weighed once K is known: the first pass leaves it out.
    let without_load = Signals { load: None, ..signals.clone() };
    let rough = by_u(&without_load, 1.0).map_or(usual_k, |found| found[1]);
    let rough = if rough > 0.0 { rough } else { usual_k };
    let found = by_u(signals, rough / r);
    let k = or_guess(found.map(|f| f[1]), BY_U_ALONE, usual_k, NEEDS_EXCITATION);
    let torque = |per_k: f64| per_k * k.value / r;
    Values {
        j: or_guess(found.map(|f| torque(f[0])), BY_U_ALONE, usual_j * k.value, NEEDS_EXCITATION),
        b_m: guessed(
            0.0,
            "without a current it cannot be told from K; a data sheet or a coasting run tells",
        ),
        t_c: or_zero(found.map(|f| torque(f[2])), BY_U_ALONE, USUAL_FRICTION * k.value),
        r: Some(guessed(r, MEASURE_R)),
        l: Some(guessed(r * usual_time, MEASURE_L)),
        k,
    }
}

fn force(signals: &Signals) -> Values {
    let [_, _, _, usual_j] = USUAL;
    let found = by_u(signals, 1.0);
    Values {
        r: None,
        l: None,
        k: guessed(1.0, NEEDS_KNOWN_K),
        j: or_guess(found.map(|f| f[0]), BY_U_ALONE, usual_j, NEEDS_EXCITATION),
        b_m: or_zero(found.map(|f| f[1]), BY_U_ALONE, 0.0),
        t_c: or_zero(found.map(|f| f[2]), BY_U_ALONE, USUAL_FRICTION),
    }
}

#[cfg(test)]
mod tests {
    use drivescope_plant::drive::Drive;
    use drivescope_recording::{Quantity, Recording};
    use indicatif::ProgressBar;

    use super::*;
    use crate::expression::SignalOverTime;
    use crate::simulation::typed::{Driven, Run};

    /// A run with the drive's own noise under a rich input, sampled at 1 kHz.
    fn recorded(name: &str, input: &str) -> (Drive, Recording) {
        let mut drive = crate::drive_source::drive(name).expect("it is built in");
        // A first drive is a motor with Coulomb friction: a constant load is not looked for.
        drive.effects.retain(|effect| effect.kind != "constant_load");
        let u = SignalOverTime::parse("--input", input, Quantity::Voltage).expect("it is a law");
        let run = Run {
            drive: drive.clone(),
            driven: Driven::Input(u.sampled("--input", 1e-3, 8000).expect("it is finite")),
            load: None,
            faults: Vec::new(),
            period_s: 1e-3,
            seed: 3,
        };
        (drive, run.simulate(&ProgressBar::hidden()).expect("it runs"))
    }

    fn near(value: &Value, truth: f64, share: f64) {
        assert!((value.value / truth - 1.0).abs() < share, "{value:?}, truly {truth}");
        assert!(matches!(value.origin, Origin::Estimated(_)));
    }

    #[test]
    fn a_voltage_driven_drive_is_found_roughly() {
        let (drive, recording) =
            recorded("dr300", "12 * sin(2 * t) + 6 * sin(7 * t) + 4 * sign(sin(20 * t))");
        let found = FirstDrive::of(&recording, None).expect("it is enough");
        let motor = &drive.motor;
        let r = found.r.as_ref().expect("it has one");
        near(r, motor.r.expect("it has one"), 0.02);
        near(&found.k, motor.k_m, 0.02);
        near(&found.j, motor.j, 0.03);
        near(&found.t_c, 0.016, 0.1);
        // The inductance shows in the few samples after a step only, viscous friction is small.
        near(found.l.as_ref().expect("it has one"), motor.l.expect("it has one"), 0.2);
        near(&found.b_m, motor.b_m, 0.5);
        let (_, drive) = found.file("first.toml").expect("it is a drive");
        assert_eq!(drive.effects.len(), 1);
    }

    #[test]
    fn without_a_current_ratios_are_found() {
        let (drive, mut recording) =
            recorded("dr300", "12 * sin(2 * t) + 6 * sin(7 * t) + 4 * sign(sin(20 * t))");
        recording.signals.retain(|signal| ["u", "omega"].contains(&signal.name.as_str()));
        let found = FirstDrive::of(&recording, None).expect("it is enough");
        let motor = &drive.motor;
        let r = found.r.as_ref().expect("it has one").value;
        // K takes B_m R / K on board: 5 %.
        near(&found.k, motor.k_m, 0.07);
        let ratio = found.j.value / found.k.value * r;
        let truth = motor.j / motor.k_m * motor.r.expect("it has one");
        assert!((ratio / truth - 1.0).abs() < 0.03, "{ratio} {truth}");
        found.file("first.toml").expect("it is a drive");
    }

    #[test]
    fn a_force_driven_axis_is_found_up_to_its_constant() {
        let (drive, mut recording) = recorded("emps", "2 * sin(2 * t) + sign(sin(9 * t))");
        recording.signals.retain(|signal| ["u", "x"].contains(&signal.name.as_str()));
        let found = FirstDrive::of(&recording, None).expect("it is enough");
        assert_eq!(found.guesses().first().map(|(name, _)| *name), Some("K_m"));
        near(&found.j, drive.motor.j / drive.motor.k_m, 0.02);
        near(&found.b_m, drive.motor.b_m / drive.motor.k_m, 0.02);
        found.file("first.toml").expect("it is a drive");
    }

    #[test]
    fn a_recording_that_tells_nothing_still_gives_a_drive() {
        let (_, mut recording) = recorded("dr300", "0");
        for signal in &mut recording.signals {
            signal.values.fill(0.0);
        }
        let found = FirstDrive::of(&recording, None).expect("it is enough");
        assert!(found.guesses().len() >= 5, "{:?}", found.guesses());
        found.file("first.toml").expect("it is a drive");
    }
}
