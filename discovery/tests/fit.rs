//! A drive is recovered from recordings that the plant itself makes.

#[path = "../src/testing.rs"]
mod testing;

use drivescope_discovery::{
    Evidence, Fitted, Measured, Observer, Options, Setting, USUAL_HZ, evaluate, fit, noise,
};
use drivescope_plant::drive::{Drive, NoiseData};
use drivescope_recording::Recording;
use testing::{bench, dr300, driven, gaussian, loaded, noisy};

fn truth() -> Drive {
    let mut drive = dr300();
    drive.motor.k_m = 0.0599;
    drive.noise = NoiseData::default();
    drive
}

fn wrong(drive: &Drive) -> Drive {
    let mut wrong = drive.clone();
    for (k, parameter) in drive.fitted().iter().enumerate() {
        let factor = [1.2, 0.8, 0.85, 1.15, 1.3, 0.8, 1.2, 1.3][k % 8];
        wrong.set(&parameter.name, parameter.value * factor).expect("possible");
    }
    wrong
}

/// Noise of the sensors in the tests: current, speed; and of a position.
const SD: [f64; 2] = [0.01, 0.3];
const SD_POSITION: f64 = 1e-3;
/// Standard errors that an estimate may be off: one in 15,000 is farther.
const SIGMAS: f64 = 4.0;

/// The recordings with these columns, and the noise as the differences tell it.
fn evidence(base: &Drive, recordings: &[Recording], columns: &[&str]) -> Evidence {
    let mut evidence = Evidence::default();
    for recording in recordings {
        let mut some = recording.clone();
        some.signals.retain(|signal| columns.contains(&signal.name.as_str()));
        let measured = Measured::new(base, &some).expect("usable");
        let noise = noise(base, &measured, &[]);
        evidence.noise.push(noise.iter().map(|noise| noise.sd).collect());
        evidence.recordings.push(measured);
    }
    evidence
}

fn fitted(base: &Drive, evidence: &Evidence) -> (Fitted, Setting) {
    let observer = Observer::choose(base, &evidence.recordings, &evidence.noise);
    let setting = Setting::new(base, observer);
    (fit(base, evidence, &setting, &Options::default()).expect("it converges"), setting)
}

fn assert_recovered(fitted: &Fitted, truth: &Drive, but: &[&str]) {
    for estimate in fitted.parameters.iter().filter(|it| !but.contains(&it.name.as_str())) {
        let all = truth.parameters();
        let value = all.iter().find(|it| it.name == estimate.name).expect("the same drive").value;
        let sigmas = (estimate.value - value) / estimate.std_error;
        assert!(sigmas.abs() < SIGMAS, "{estimate:?}: truth {value}");
        assert!(estimate.std_error < 0.2 * value, "{estimate:?}: hardly known");
    }
}

#[test]
fn a_drive_with_current_and_speed_is_recovered() {
    let truth = truth();
    let recording = noisy(bench(&truth, 8.0, 0.001), SD, 5);
    let base = wrong(&truth);
    let evidence = evidence(&base, &[recording], &["u", "i", "omega"]);
    let (fitted, setting) = fitted(&base, &evidence);
    assert_eq!(setting.observer, Observer::NONE);
    assert_recovered(&fitted, &truth, &[]);
    assert_eq!((fitted.parameters.len(), fitted.not_identifiable.len()), (8, 0));
    let before = evaluate(&base, &evidence, &setting, false).expect("it runs");
    let (before, after) = (before.squares.error(), fitted.squares.error());
    assert!(before > 10.0 && (0.97..1.03).contains(&after), "{before} -> {after}");
    // K_m follows K_e.
    assert_eq!(fitted.drive.motor.k_m, fitted.drive.motor.k_e.expect("voltage-driven"));
}

#[test]
fn without_a_current_ratios_are_known_and_said_to_be() {
    let truth = truth();
    let recording = noisy(bench(&truth, 8.0, 0.001), SD, 5);
    // What cannot be told is right in the file: then the rest must be, too.
    let mut base = wrong(&truth);
    base.motor.r = truth.motor.r;
    base.motor.b_m = truth.motor.b_m;
    let evidence = evidence(&base, &[recording], &["u", "omega"]);
    let (fitted, _) = fitted(&base, &evidence);
    let kept: Vec<&str> = fitted.not_identifiable.iter().map(|it| it.parameter.as_str()).collect();
    assert_eq!(kept, ["R", "B_m"]);
    for name in ["L", "J", "coulomb.T_c"] {
        assert!(fitted.not_identifiable[0].with.iter().any(|it| it == name), "{name} goes with R");
    }
    assert_eq!(fitted.drive.motor.r, base.motor.r);
    assert_recovered(&fitted, &truth, &[]);
}

#[test]
fn a_position_alone_is_observed_and_fitted() {
    let truth = truth();
    let mut recording = bench(&truth, 8.0, 0.001);
    for (value, draw) in recording.signals[3].values.iter_mut().zip(gaussian(8000, 3)) {
        *value += SD_POSITION * draw;
    }
    let recording = noisy(recording, SD, 5);
    let base = wrong(&truth);
    let evidence = evidence(&base, &[recording], &["u", "i", "theta"]);
    let (fitted, setting) = fitted(&base, &evidence);
    assert_eq!(setting.observer.hz, USUAL_HZ);
    assert_recovered(&fitted, &truth, &[]);
    let floor = setting.observer.floor(&evidence.recordings[0]);
    let error = fitted.squares.error();
    assert!((error / floor - 1.0).abs() < 0.03, "{error} against a floor of {floor}");
}

#[test]
fn several_recordings_are_one_machine_and_some_values_their_own() {
    let truth = truth();
    let (one, two) = (bench(&truth, 4.0, 0.001), bench(&truth, 5.0, 0.002));
    let loads = [2e-3, -1e-3];
    let recordings: Vec<Recording> = [one, two]
        .into_iter()
        .zip(loads)
        .enumerate()
        .map(|(k, (clean, load))| {
            let u = clean.signals[0].values.clone();
            let loads = vec![load; u.len()];
            noisy(loaded(&truth, u, &loads, clean.period_s), SD, 20 + k as u64)
        })
        .collect();
    let law = "\n[[effect]]\nkind = \"custom\"\nid = \"rest\"\ntorque = \"-T\"\n\
               parameters = { T = 0.0 }\n[fit]\nper_recording = [\"rest.T\"]\n";
    let base =
        Drive::parse(&format!("{}{law}", wrong(&truth).to_toml()), "own.toml").expect("right");
    let evidence = evidence(&base, &recordings, &["u", "i", "omega"]);
    let (fitted, setting) = fitted(&base, &evidence);
    assert_recovered(&fitted, &truth, &[]);
    for (recording, load) in fitted.recordings.iter().zip(loads) {
        let own = &recording.own[0];
        assert_eq!(own.name, "rest.T");
        let sigmas = (own.value - load) / own.std_error;
        assert!(sigmas.abs() < SIGMAS && own.std_error < 0.1 * load.abs(), "{own:?}: {load}");
    }
    // On data it has not seen only its own load is estimated.
    let judged = evaluate(&fitted.drive, &evidence, &setting, true).expect("it runs");
    let without = evaluate(&fitted.drive, &evidence, &setting, false).expect("it runs");
    assert!((judged.squares.error() - 1.0).abs() < 0.03 && without.squares.error() > 1.5);
}

#[test]
fn a_far_start_is_left_and_an_overflow_said() {
    let truth = truth();
    let recording = noisy(bench(&truth, 4.0, 0.001), SD, 6);
    let mut far = truth.clone();
    for (name, factor) in [("R", 4.0), ("J", 0.2), ("K_e", 2.0), ("coulomb.T_c", 0.2), ("L", 8.0)] {
        let value = truth.parameters().iter().find(|it| it.name == name).expect("it has it").value;
        far.set(name, factor * value).expect("possible");
    }
    let evidence = evidence(&far, &[recording], &["u", "i", "omega"]);
    let (fitted, _) = fitted(&far, &evidence);
    assert_recovered(&fitted, &truth, &[]);
    let mut broken = truth.clone();
    broken.motor.b_m = 0.0;
    let law = "\n[[effect]]\nkind = \"custom\"\ntorque = \"a * omega^3 * 1e6\"\n\
               parameters = { a = 1 }\n[fit]\nfixed = [\"custom.a\"]\n";
    let broken = Drive::parse(&format!("{}{law}", broken.to_toml()), "x.toml").expect("right");
    let setting = Setting::new(&broken, Observer::NONE);
    let error = fit(&broken, &evidence, &setting, &Options::default()).expect_err("overflow");
    assert!(error.to_string().contains("overflows from each of 3 starts"), "{error}");
}

/// Where something is missing two starts end beside each other, not in one point: the same of them
/// must be the answer, whatever values the drive file had.
#[test]
fn what_the_drive_file_said_does_not_show_in_the_fit() {
    let mut recording = noisy(bench(&truth(), 8.0, 0.001), SD, 5);
    recording.signals.retain(|signal| signal.name == "i" || signal.name == "omega");
    recording.signals.iter_mut().filter(|it| it.name == "i").for_each(|it| it.name = "u".into());
    // Friction depends on the speed in another way than this drive says, which knows no Stribeck.
    let ended = |j: f64, b_m: f64, t_c: f64| {
        let text = format!(
            "schema = 1\nname = \"first\"\nmotion = \"rotary\"\n[motor]\ninput = \"force\"\n\
             K_m = 1.0\nJ = {j}\nB_m = {b_m}\n[[effect]]\nkind = \"coulomb\"\nT_c = {t_c}\n\
             [fit]\nfixed = [\"K_m\"]\n"
        );
        let drive = Drive::parse(&text, "first.toml").expect("a right drive file");
        let evidence = evidence(&drive, std::slice::from_ref(&recording), &["u", "omega"]);
        let setting = Setting::of_fit(&drive, &evidence);
        let options = Options { starts: 2, balanced: false, ..Options::default() };
        let fitted = fit(&drive, &evidence, &setting, &options).expect("it converges");
        assert!(fitted.squares.error() > 1.2, "{}", fitted.squares.error());
        let values: Vec<f64> = fitted.parameters.iter().map(|it| it.value).collect();
        values
    };
    let ends = [ended(1e-3, 1e-3, 0.2), ended(3e-3, 3e-4, 0.5), ended(4e-4, 2e-3, 0.1)];
    for (one, other) in ends[1..].iter().flat_map(|end| end.iter().zip(&ends[0])) {
        assert!((one / other - 1.0).abs() < 1e-9, "{one:e} and {other:e}");
    }
}

#[test]
fn a_constant_input_tells_little_and_that_is_said() {
    let truth = truth();
    let still = driven(&truth, vec![6.0; 3000], 0.001);
    let base = wrong(&truth);
    // The settled part alone: u, i, omega constant.
    let mut settled = noisy(still, SD, 8);
    settled.signals.iter_mut().for_each(|it| drop(it.values.drain(..1500)));
    let evidence = evidence(&base, &[settled], &["u", "i", "omega"]);
    let (fitted, _) = fitted(&base, &evidence);
    let kept: Vec<&str> = fitted.not_identifiable.iter().map(|it| it.parameter.as_str()).collect();
    for name in ["L", "J", "stribeck.T_b", "stribeck.omega_s"] {
        assert!(kept.contains(&name), "{name} is told by {kept:?}");
    }
    assert!(kept.len() >= 6, "two equations of rest tell two values: {kept:?}");
}
