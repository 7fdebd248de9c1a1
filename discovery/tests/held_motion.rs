//! Motors that a position loop turns slowly, simulated here and not by the plant: the loop cancels what
//! disturbs the motion, so that only the current shows it.

mod joint;

use std::f64::consts::TAU;
use std::path::PathBuf;

use drivescope_discovery::{Discovery, Unwatched, Verdict, discover};
use drivescope_plant::drive::Drive;
use drivescope_recording::{ReadOptions, Recording, read};
use joint::{evidence, recording};
use rand::SeedableRng as _;
use rand_distr::{Distribution as _, StandardNormal};
use rand_pcg::Pcg64;

/// A first drive file of such a motor, with values that are off.
const DRIVE: &str = "schema = 1\nname = \"servo\"\n[motor]\ninput = \"force\"\nK_m = 0.05\n\
                     J = 1.0e-4\nB_m = 1.0e-3\n[[effect]]\nkind = \"coulomb\"\nT_c = 0.01\n\
                     [fit]\nfixed = [\"K_m\"]\n";
const K_M: f64 = 0.05;
const PERIOD_S: f64 = 2e-3;
/// Steps of the simulation a sample.
const STEPS: usize = 40;
const COUNTS: f64 = 8192.0;

/// Current and position of a motor that follows a triangle of so many revolutions at that speed,
/// rad/s, against a torque that depends on the position.
fn recorded(speed: f64, seed: u64, disturbs: impl Fn(f64) -> f64) -> Recording {
    let (j, b, t_c) = (6e-5, 4e-4, 6e-3);
    let (stiff, damped, integral) = (4.0, 0.04, 40.0);
    let mut random = Pcg64::seed_from_u64(seed);
    let (mut theta, mut omega, mut sum) = (0.0, 0.0, 0.0);
    let dt = PERIOD_S / STEPS as f64;
    let (mut current, mut position) = (Vec::new(), Vec::new());
    let mut normal = || -> f64 { StandardNormal.sample(&mut random) };
    for k in 0..9000 {
        let t = k as f64 * PERIOD_S;
        // There and back every six seconds.
        let part = (t / 6.0).fract();
        let (forth, way) = if part < 0.5 { (1.0, part) } else { (-1.0, 1.0 - part) };
        let (wanted, wanted_speed) = (speed * 6.0 * way, speed * forth);
        let measured = (theta * COUNTS / TAU).round() * TAU / COUNTS;
        sum += integral * (wanted - theta) * PERIOD_S;
        let torque = stiff * (wanted - theta) + damped * (wanted_speed - omega) + sum;
        current.push(torque / K_M + 0.002 * normal());
        position.push(measured);
        for _ in 0..STEPS {
            let friction = t_c * (omega / 1e-2_f64).tanh() + b * omega;
            omega += dt / j * (torque - friction - disturbs(theta));
            theta += dt * omega;
        }
    }
    recording(PERIOD_S, [("i", "A", current), ("theta", "rad", position)])
}

fn found(disturbs: impl Fn(f64) -> f64) -> Discovery {
    let drive = Drive::parse(DRIVE, "servo.toml").expect("right");
    let [estimation, validation] = [(4.0, 1), (3.0, 2)]
        .map(|(speed, seed)| evidence(&drive, &recorded(speed, seed, &disturbs)));
    discover(&drive, &estimation, &validation, &Unwatched).expect("the base can be fitted")
}

fn torque(found: &Discovery, step: usize) -> f64 {
    let remainder = &found.ladder[step].validation_unexplained;
    remainder.torque.expect("torque and motion were measured").rms
}

#[test]
fn a_cogging_that_the_loop_cancels_is_named_with_its_periods() {
    let answer = found(|theta| 4e-3 * (7.0 * theta + 0.4).sin());
    assert_eq!(answer.named, ["cogging"], "{:?}", answer.ranking);
    let first = answer.ranking.iter().find(|it| it.refused.is_none()).expect("it was named");
    assert_eq!(first.parameters["cogging.N"].value, 7.0);
    let (a, b) = (first.parameters["cogging.a"].value, first.parameters["cogging.b"].value);
    let size = a.hypot(b);
    assert!((size / 4e-3 - 1.0).abs() < 0.1, "{size}");
    assert!(torque(&answer, 1) < 0.5 * torque(&answer, 0), "{:?}", answer.ladder);
}

#[test]
fn a_weight_that_the_loop_holds_is_named() {
    let answer = found(|theta| 6e-3 * theta.sin());
    assert_eq!(answer.named, ["unbalance"], "{:?}", answer.ranking);
}

/// A first drive file without dry friction: its signs count although the base has none.
#[test]
fn the_dry_friction_that_a_file_lacks_is_named() {
    let greased = DRIVE.replace("[[effect]]\nkind = \"coulomb\"\nT_c = 0.01\n", "");
    let drive = Drive::parse(&greased, "servo.toml").expect("right");
    assert!(drive.effects.is_empty());
    let of = |speed, seed| evidence(&drive, &recorded(speed, seed, |_| 0.0));
    // At one speed it is viscous friction.
    let (mut estimation, slower, validation) = (of(4.0, 1), of(1.5, 3), of(3.0, 2));
    estimation.recordings.extend(slower.recordings);
    estimation.noise.extend(slower.noise);
    let answer = discover(&drive, &estimation, &validation, &Unwatched).expect("it can be fitted");
    assert_eq!(answer.named, ["coulomb"], "{:?}", answer.ranking);
    let first = answer.ranking.iter().find(|it| it.refused.is_none()).expect("it was named");
    let t_c = first.parameters["coulomb.T_c"].value;
    assert!((t_c / 6e-3 - 1.0).abs() < 0.1, "{t_c}");
}

/// A joint that goes to and fro over less than a radian, as that of an arm.
fn found_in_a_joint(disturbs: impl Fn(f64) -> f64) -> Discovery {
    let drive = Drive::parse(DRIVE, "joint.toml").expect("right");
    let [estimation, validation] = [(0.3, 1), (0.25, 2)]
        .map(|(speed, seed)| evidence(&drive, &recorded(speed, seed, &disturbs)));
    discover(&drive, &estimation, &validation, &Unwatched).expect("the base can be fitted")
}

#[test]
fn the_weight_of_a_joint_is_named_and_explains_its_torque() {
    let answer = found_in_a_joint(|theta| 6e-2 * (theta + 0.4).sin());
    assert_eq!(answer.named, ["unbalance"], "{:?}", answer.ranking);
    let last = answer.ladder.len() - 1;
    assert!(torque(&answer, last) < 0.1 * torque(&answer, 0), "{:?}", answer.ladder);
}

#[test]
fn no_wave_is_named_over_a_part_of_its_period() {
    let answer = found_in_a_joint(|theta| 3e-2 * (theta - 0.4));
    let waves = ["cogging", "torque_ripple"];
    assert!(!answer.named.iter().any(|it| waves.contains(&it.as_str())), "{:?}", answer.ranking);
    assert_ne!(answer.verdict, Verdict::None, "{:?}", answer.ranking);
}

#[test]
fn nothing_is_named_where_nothing_disturbs() {
    let answer = found(|_| 0.0);
    assert_eq!((answer.verdict, answer.named.len()), (Verdict::None, 0), "{:?}", answer.ranking);
}

/// A brushless motor that a position loop turns slowly (data found through `DRIVESCOPE_DATA`, not
/// shipped): cogging of seven periods a revolution is the largest of what disturbs it.
#[test]
fn the_cogging_of_a_recorded_motor_is_named() {
    let folder = std::env::var_os("DRIVESCOPE_DATA").map(|data| PathBuf::from(data).join("odrive"));
    let Some(folder) = folder.filter(|folder| folder.is_dir()) else {
        println!("NOT RUN: DRIVESCOPE_DATA names no folder with odrive/");
        return;
    };
    let text = DRIVE
        .replace("K_m = 0.05", "K_m = 1.0")
        .replace("J = 1.0e-4", "J = 2.4e-4")
        .replace("[\"K_m\"]", "[\"K_m\", \"J\"]");
    let drive = Drive::parse(&text, "odrive.toml").expect("right");
    let [estimation, validation] = ["0.csv", "1.csv"].map(|name| {
        let (recording, _) = read(folder.join(name), &ReadOptions::default()).expect("it reads");
        evidence(&drive, &recording)
    });
    let found = discover(&drive, &estimation, &validation, &Unwatched).expect("the base is fitted");
    assert_eq!(found.named, ["cogging"], "{:?}", found.ranking);
    assert_eq!(found.ranking[0].parameters["cogging.N"].value, 7.0);
    assert!(torque(&found, 1) < 0.8 * torque(&found, 0), "{:?}", found.ladder);
}
