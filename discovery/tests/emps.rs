//! EMPS, a real positioning system (its data are found through `DRIVESCOPE_DATA`, and not
//! shipped): the published parameters are recovered, and the direction of friction shows.

use std::path::PathBuf;

use drivescope_discovery::{
    Estimate, Evidence, Fitted, LadderStep, Measured, Observer, Options, Ranked, Setting,
    USUAL_BAND_HZ, Unwatched, compare, discover, evaluate, fit, noise, relative_force_error,
};
use drivescope_plant::drive::Drive;
use drivescope_recording::{ReadOptions, read};

const EMPS: &str = include_str!("../../scenarios/drives/emps.toml");

fn folder() -> Option<PathBuf> {
    let folder = std::env::var_os("DRIVESCOPE_DATA").map(|data| PathBuf::from(data).join("emps"));
    let found = folder.filter(|folder| folder.is_dir());
    if found.is_none() {
        println!("NOT RUN: DRIVESCOPE_DATA names no folder with emps/");
    }
    found
}

fn evidence(drive: &Drive, folder: &std::path::Path, name: &str) -> Evidence {
    let (recording, _) = read(folder.join(name), &ReadOptions::default()).expect("it reads");
    let measured = Measured::new(drive, &recording).expect("usable");
    let sds = noise(drive, &measured, &[]).iter().map(|noise| noise.sd).collect();
    Evidence { recordings: vec![measured], noise: vec![sds] }
}

fn estimate<'a>(fitted: &'a Fitted, name: &str) -> &'a Estimate {
    let own = fitted.recordings.iter().flat_map(|fit| &fit.own);
    let mut all = fitted.parameters.iter().chain(own);
    all.find(|it| it.name == name).unwrap_or_else(|| panic!("{name} was estimated"))
}

#[test]
fn published_parameters_are_recovered() {
    let Some(folder) = folder() else { return };
    let drive = Drive::parse(EMPS, "emps.toml").expect("right");
    let data = evidence(&drive, &folder, "emps_estimation.csv");
    let observer = Observer::choose(&drive, &data.recordings, &data.noise);
    assert_eq!(observer.hz, 10.0, "a position alone is an integral");
    let setting = Setting::new(&drive, observer);
    let fitted = fit(&drive, &data, &setting, &Options::default()).expect("it converges");
    assert!(fitted.not_identifiable.is_empty(), "{:?}", fitted.not_identifiable);
    // Published by Janot, Gautier and Brunot (2019). The mass differs by 0.6 %, 2.4 of our standard
    // errors. The estimator is the reason, not the data: theirs makes the error of the force least,
    // and least squares on the force with a low-pass of 30 to 150 Hz yields 95.06 to 95.14 kg from
    // the same file; ours makes the error of the position about an observer least, and what both
    // models lack (direction, something elastic, a ripple) weighs differently in it. A delay is not
    // the reason: added to the drive it stays at 0 and leaves the mass where it is.
    for (name, published, sigmas) in [
        ("J", 95.1089, 3.0),
        ("B_m", 203.5034, 2.0),
        ("coulomb.T_c", 20.3935, 2.0),
        ("constant_load.T_0", -3.1648, 2.0),
    ] {
        let found = estimate(&fitted, name);
        let off = (found.value - published) / found.std_error;
        assert!(off.abs() < sigmas, "{found:?}: published {published}");
        assert!(found.std_error < 0.1 * published.abs(), "{found:?}");
    }
    // Published 4.08 % with another filter; 4.35 % below 100 Hz.
    let drive = fitted.drive_of(0);
    let force = relative_force_error(&drive, &data.recordings[0], USUAL_BAND_HZ).expect("force");
    assert!((0.042..0.047).contains(&force), "{force}");
}

#[test]
fn the_direction_and_the_pitch_of_the_screw_are_seen() {
    let Some(folder) = folder() else { return };
    let drive = Drive::parse(EMPS, "emps.toml").expect("right");
    let data = evidence(&drive, &folder, "emps_estimation.csv");
    let setting = Setting::new(&drive, Observer::choose(&drive, &data.recordings, &data.noise));
    let fitted = fit(&drive, &data, &setting, &Options::default()).expect("it converges");
    let options = compare::Options { curves: false, seed: 1, fit: false };
    let found = compare::compare(&fitted.drive, &data, &setting, &options).expect("it runs");
    assert!(found.findings.iter().any(|it| it.variable == "omega_sign"), "{:?}", found.findings);
    // A revolution of the screw is 2.5 mm; an inverse-dynamics torque shows 2.50 mm too.
    let ripple = found.findings.iter().find_map(|it| it.period).expect("a ripple is found");
    assert!((ripple / 2.5e-3 - 1.0).abs() < 0.01, "{ripple}");
}

#[test]
fn friction_differs_by_direction_and_lowers_the_validation_error() {
    let Some(folder) = folder() else { return };
    let base = Drive::parse(EMPS, "emps.toml").expect("right");
    let effect = "[[effect]]\nkind = \"asymmetric_friction\"\ndT_c = 0.0\ndB_m = 0.0\n\n[fit]\n";
    let richer = Drive::parse(&EMPS.replace("[fit]\n", effect), "asymmetric.toml").expect("right");
    let data = evidence(&base, &folder, "emps_estimation.csv");
    let unseen = evidence(&base, &folder, "emps_validation.csv");
    let setting = Setting::new(&base, Observer::choose(&base, &data.recordings, &data.noise));
    let fitted = |drive: &Drive| fit(drive, &data, &setting, &Options::default()).expect("fits");
    let judged = |fitted: &Fitted| {
        evaluate(&fitted.drive, &unseen, &setting, true).expect("it runs").squares.error()
    };
    let (base, richer) = (fitted(&base), fitted(&richer));
    let difference = 2.0 * estimate(&richer, "asymmetric_friction.dB_m").value;
    let mean = estimate(&richer, "B_m").value;
    println!("F_v- minus F_v+ {difference}, mean {mean}");
    let ratio = judged(&richer) / judged(&base);
    println!("validation error {ratio} of the base");
    assert!((65.0..82.0).contains(&difference) && (185.0..210.0).contains(&mean));
    assert!(ratio <= 0.80, "{ratio}");
}

#[test]
fn discovery_names_the_direction_of_friction_and_refuses_the_rest_in_words() {
    let Some(folder) = folder() else { return };
    let base = Drive::parse(EMPS, "emps.toml").expect("right");
    let data = evidence(&base, &folder, "emps_estimation.csv");
    let unseen = evidence(&base, &folder, "emps_validation.csv");
    let found = discover(&base, &data, &unseen, &Unwatched).expect("the base can be fitted");
    let others: Vec<&String> = found.named.iter().filter(|it| *it != "delay").collect();
    assert_eq!(others, ["asymmetric_friction"], "{:?}", found.ranking);
    let all = found.drive.parameters();
    let value = |name: &str| all.iter().find(|it| it.name == name).expect("it has it").value;
    let difference = 2.0 * value("asymmetric_friction.dB_m");
    let mean = value("B_m");
    assert!((65.0..82.0).contains(&difference) && (185.0..210.0).contains(&mean));
    let ends = |step: &LadderStep| step.validation_error;
    let ratio = ends(found.ladder.last().expect("a base")) / ends(&found.ladder[0]);
    println!("F_v- minus F_v+ {difference}, mean {mean}, validation error {ratio} of the base");
    assert!(ratio <= 0.80, "{ratio}");
    // Nothing slow was recorded, and the ripple of the screw is small and has another phase in each recording.
    let stribeck = found.not_judged.iter().find(|it| it.effect == "stribeck").expect("refused");
    assert!(stribeck.reason.contains("nothing slow enough was recorded"), "{stribeck:?}");
    let of_screw = |it: &&Ranked| {
        let wave = it.parameters.get("cogging.N").map_or(0.0, |it| it.value);
        (std::f64::consts::TAU / wave - 2.5e-3).abs() < 0.05e-3
    };
    let ripple = found.ranking.iter().find(of_screw).expect("it is reported");
    let refused = ripple.refused.as_deref().unwrap_or_default();
    assert!(refused.contains("phase changes") || refused.contains("balance only"), "{ripple:?}");
    // What passed beside it is refused in words too, and sizes have the units of an axis.
    let alone = |it: &Ranked| it.refused.is_some() || it.effect == "asymmetric_friction";
    assert!(found.ranking.iter().all(alone), "{:?}", found.ranking);
    let named = found.ranking.iter().find(|it| it.effect == "asymmetric_friction");
    assert_eq!(named.expect("named").parameters["asymmetric_friction.dB_m"].unit, "N s/m");
}
