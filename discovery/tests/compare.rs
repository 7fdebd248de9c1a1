//! Where a model fails, on recordings of drives that have what it lacks.

#[path = "../src/testing.rs"]
mod testing;

use drivescope_discovery::compare::{CompareError, Comparison, Options, compare};
use drivescope_discovery::{Evidence, Measured, Observer, Setting, evaluate, fit, noise};
use drivescope_plant::drive::{Drive, NoiseData};
use drivescope_recording::Recording;
use testing::{bench, dr300, loaded, noisy, random_load};

const SD: [f64; 2] = [0.01, 0.3];
const OPTIONS: Options = Options { curves: false, seed: 1, fit: true };

fn base() -> Drive {
    let mut drive = dr300();
    drive.motor.k_m = 0.0599;
    drive.noise = NoiseData::default();
    drive
}

/// The base with further effects, as their tables in a drive file.
fn with(effects: &str) -> Drive {
    let text = include_str!("../../scenarios/drives/dr300.toml");
    let text = text.replacen("[controller]", &format!("{effects}\n[controller]"), 1);
    let mut drive = Drive::parse(&text, "hidden.toml").expect("a right drive file");
    drive.motor.k_m = 0.0599;
    drive.noise = NoiseData::default();
    drive
}

fn evidence(recordings: &[Recording]) -> Evidence {
    let mut evidence = Evidence::default();
    for recording in recordings {
        let mut some = recording.clone();
        some.signals.retain(|signal| signal.name != "theta");
        let measured = Measured::new(&base(), &some).expect("usable");
        let noise = noise(&base(), &measured, &[]);
        evidence.noise.push(noise.iter().map(|noise| noise.sd).collect());
        evidence.recordings.push(measured);
    }
    evidence
}

/// The base, fitted to the recordings, compared with them.
fn compared(evidence: &Evidence, options: &Options) -> Comparison {
    let setting = Setting::new(&base(), Observer::NONE);
    let fitted = fit(&base(), evidence, &setting, &Default::default()).expect("it converges");
    compare(&fitted.drive, evidence, &setting, options).expect("it runs")
}

fn first(hidden: &str) -> Option<&'static str> {
    let recording = noisy(bench(&with(hidden), 8.0, 0.001), SD, 3);
    compared(&evidence(&[recording]), &OPTIONS).findings.first().map(|it| it.variable)
}

#[test]
fn the_variable_of_what_is_hidden_comes_first() {
    for (hidden, variable) in [
        ("[[effect]]\nkind = \"cogging\"\na = 0.004\nb = 0.0\nN = 6", "theta"),
        ("[[effect]]\nkind = \"constant_load\"\nT_0 = 0.003", "omega_sign"),
        ("[[effect]]\nkind = \"quadratic_drag\"\nc = 1.5e-7", "omega"),
        (
            "[[effect]]\nkind = \"custom\"\ntorque = \"-c * tanh(omega) * t\"\nparameters = { c = 3e-4 }",
            "time",
        ),
        (
            "[[effect]]\nkind = \"custom\"\nvoltage = \"-v * tanh(20 * i)\"\nparameters = { v = 0.4 }",
            "i",
        ),
    ] {
        assert_eq!(first(hidden), Some(variable), "{hidden}");
    }
}

#[test]
fn nothing_is_found_where_nothing_is_hidden() {
    for seed in [1, 2] {
        let white = noisy(bench(&base(), 8.0, 0.001), SD, seed);
        let found = compared(&evidence(&[white]), &OPTIONS);
        assert_eq!(found.findings, [], "white, seed {seed}");
        assert!((0.95..1.05).contains(&found.error), "{}", found.error);
        assert!(found.recordings.iter().all(|it| it.spans.is_empty()));
    }
}

#[test]
fn curves_show_what_is_hidden_and_nothing_else() {
    // 5 mN m against positive motion only: the rest is Coulomb friction, which the base has.
    let recording =
        noisy(bench(&with("[[effect]]\nkind = \"constant_load\"\nT_0 = 0.005"), 8.0, 0.001), SD, 3);
    let found = compared(&evidence(&[recording]), &Options { curves: true, seed: 1, fit: true });
    let curve = found.curves.iter().find(|it| it.variable == "omega").expect("it is drawn");
    let far: Vec<f64> =
        (0..curve.x.len()).filter(|k| curve.x[*k].abs() > 50.0).map(|k| curve.value[k]).collect();
    let mean = far.iter().sum::<f64>() / far.len() as f64;
    assert!((mean.abs() / 0.005 - 1.0).abs() < 0.2, "{mean}: {curve:?}");
    let again = compared(
        &evidence(&[noisy(bench(&base(), 8.0, 0.001), SD, 5)]),
        &Options { curves: true, seed: 1, fit: true },
    );
    for curve in &again.curves {
        let ends = curve.lower.iter().zip(&curve.upper);
        let out = ends.filter(|(low, high)| **low > 0.0 || **high < 0.0).count();
        assert!(out <= curve.x.len() / 3, "{curve:?}");
    }
}

#[test]
fn a_drive_that_was_not_fitted_is_said_not_to_be() {
    let recording = noisy(bench(&base(), 8.0, 0.001), SD, 3);
    let evidence = evidence(&[recording]);
    let mut off = base();
    let r = off.motor.r.expect("voltage-driven");
    off.set("R", 1.03 * r).expect("possible");
    let setting = Setting::new(&off, Observer::NONE);
    let found = compare(&off, &evidence, &setting, &OPTIONS).expect("it runs");
    assert!(found.is_unfitted() && found.by_parameters > 0.9, "{}", found.by_parameters);
    assert!(!found.by_balances);
    let judged = evaluate(&off, &evidence, &setting, true).expect("it runs").squares.error();
    assert_eq!(found.error, judged);
}

#[test]
fn several_recordings_are_one_machine_and_must_be_alike() {
    let hidden = with("[[effect]]\nkind = \"cogging\"\na = 0.004\nb = 0.0\nN = 6");
    let one = |seed| noisy(bench(&hidden, 4.0, 0.001), SD, seed);
    let found = compared(&evidence(&[one(1), one(2)]), &OPTIONS);
    assert_eq!(found.findings.first().map(|it| it.variable), Some("theta"));
    assert_eq!(found.recordings.len(), 2);
    let mut other = one(3);
    other.signals.retain(|signal| signal.name != "i");
    let mixed = evidence(&[one(1), other]);
    let setting = Setting::new(&base(), Observer::NONE);
    let refused = compare(&base(), &mixed, &setting, &OPTIONS);
    assert!(matches!(refused, Err(CompareError::Unequal { .. })), "{refused:?}");
}

#[test]
fn a_random_load_is_no_finding() {
    let u = bench(&base(), 8.0, 0.001).signals[0].values.clone();
    let load = random_load(u.len(), 0.001, (2e-3, 0.1), 4);
    let mut recording = noisy(loaded(&base(), u, &load, 0.001), SD, 9);
    recording.signals.retain(|signal| signal.name != "T_l");
    let found = compared(&evidence(&[recording]), &OPTIONS);
    assert_eq!(found.findings, []);
    assert!(found.error > 1.05, "the load is there: {}", found.error);
    assert!(found.recordings[0].outputs.iter().any(|it| it.autocorrelation.correlated));
}
