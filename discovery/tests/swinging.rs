//! A shaft that its torque hardly moves, simulated here and not by the plant: an arm that swings freely.
//! Read backwards, its torque would be explained best by a drive of hardly any inertia.

use std::f64::consts::TAU;

use drivescope_discovery::{Discovery, Unwatched, Verdict, discover};
use drivescope_plant::drive::Drive;
use drivescope_recording::Recording;
use rand::SeedableRng as _;
use rand_distr::{Distribution as _, StandardNormal};
use rand_pcg::Pcg64;

mod joint;

use joint::{evidence, recording};

/// A first drive file, with values that are off.
const DRIVE: &str = "schema = 1\nname = \"arm\"\n[motor]\ninput = \"force\"\nK_m = 1.0\n\
                     J = 0.02\nB_m = 0.02\n[[effect]]\nkind = \"coulomb\"\nT_c = 0.1\n\
                     [fit]\nfixed = [\"K_m\"]\n";
const PERIOD_S: f64 = 2e-3;
/// Steps of the simulation a sample.
const STEPS: usize = 40;

/// An arm of that weight, N m, under a torque of a few sines, that is let go from below.
fn swings(weight: f64, seed: u64) -> Recording {
    let (j, b, t_c) = (0.03, 0.01, 0.05);
    let mut random = Pcg64::seed_from_u64(seed);
    let mut normal = || -> f64 { StandardNormal.sample(&mut random) };
    let phases: [f64; 4] = std::array::from_fn(|_| TAU * normal());
    let dt = PERIOD_S / STEPS as f64;
    let (mut theta, mut omega) = (0.0_f64, 0.0_f64);
    let (mut u, mut speed, mut position) = (Vec::new(), Vec::new(), Vec::new());
    for k in 0..5000 {
        let t = k as f64 * PERIOD_S;
        let waves = [0.23, 0.61, 1.7, 3.1].iter().zip(&phases);
        let torque: f64 = waves.map(|(hz, phase)| 0.2 * (TAU * hz * t + phase).sin()).sum();
        u.push(torque);
        speed.push(omega + 0.08 * normal());
        position.push((theta / 4e-4).round() * 4e-4);
        for _ in 0..STEPS {
            let friction = t_c * (omega / 1e-2).tanh() + b * omega;
            omega += dt / j * (torque - friction - weight * theta.sin());
            theta += dt * omega;
        }
    }
    recording(PERIOD_S, [("u", "V", u), ("omega", "rad/s", speed), ("theta", "rad", position)])
}

/// A wheel that a constant current runs up, whose sensor has noise.
fn runs_up(seed: u64) -> Recording {
    let mut random = Pcg64::seed_from_u64(seed);
    let mut normal = || -> f64 { StandardNormal.sample(&mut random) };
    let samples = 0..1500;
    let u = samples.clone().map(|_| 3.0 + 0.5 * normal()).collect();
    let speed = samples.map(|k| 50.0 * k as f64 * PERIOD_S + 2.0 * normal()).collect();
    recording(PERIOD_S, [("u", "V", u), ("omega", "rad/s", speed)])
}

fn found(recordings: [Recording; 2]) -> Discovery {
    let drive = Drive::parse(DRIVE, "arm.toml").expect("right");
    let [estimation, validation] = recordings.map(|it| evidence(&drive, &it));
    discover(&drive, &estimation, &validation, &Unwatched).expect("the base can be fitted")
}

#[test]
fn the_weight_of_an_arm_that_swings_freely_is_named_with_its_size() {
    let answer = found([1, 2].map(|seed| swings(1.5, seed)));
    assert_eq!(answer.named, ["unbalance"], "{:?}", answer.ranking);
    let first = answer.ranking.iter().find(|it| it.refused.is_none()).expect("it was named");
    let size = first.parameters["unbalance.b"].value;
    assert!((size.abs() / 1.5 - 1.0).abs() < 0.05, "{size}");
    assert!((answer.drive.motor.j / 0.03 - 1.0).abs() < 0.1, "{}", answer.drive.motor.j);
}

#[test]
fn nothing_is_named_where_it_has_no_weight() {
    let answer = found([3, 4].map(|seed| swings(0.0, seed)));
    assert_eq!((answer.verdict, answer.named.len()), (Verdict::None, 0), "{:?}", answer.ranking);
}

#[test]
fn what_the_noise_of_a_constant_current_does_not_move_is_no_loss_of_flux() {
    let answer = found([5, 6].map(runs_up));
    assert!(answer.named.is_empty(), "{:?}", answer.ranking);
    let untold = |id: &str| answer.not_judged.iter().any(|it| it.effect == id);
    let of_current = ["armature_reaction", "saturation", "load_friction"];
    assert!(of_current.iter().all(|id| untold(id)), "{:?}", answer.not_judged);
}
