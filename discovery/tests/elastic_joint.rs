//! A motor that a position loop swings faster and faster with a load behind a spring, simulated here and
//! not by the plant: the torque that the loop asks for shows the load.

mod joint;

use std::f64::consts::TAU;

use drivescope_discovery::{Discovery, Unwatched, discover};
use drivescope_plant::drive::Drive;
use drivescope_recording::Recording;
use joint::{evidence, recording};
use rand::SeedableRng as _;
use rand_distr::{Distribution as _, StandardNormal};
use rand_pcg::Pcg64;

/// A first drive file of such a motor, with values that are off.
const DRIVE: &str = "schema = 1\nname = \"joint\"\n[motor]\ninput = \"force\"\nK_m = 0.05\n\
                     J = 1.0e-4\nB_m = 1.0e-3\n[[effect]]\nkind = \"coulomb\"\nT_c = 0.01\n\
                     [fit]\nfixed = [\"K_m\"]\n";
const K_M: f64 = 0.05;
const PERIOD_S: f64 = 4e-3;
/// Steps of the simulation a sample.
const STEPS: usize = 40;
const COUNTS: f64 = 65536.0;
const J: f64 = 6e-5;

/// Current and position over a sweep from 0.2 Hz to so many, Hz; a share of the inertia hangs on a spring
/// with which it alone swings at `swings`, Hz.
fn recorded(to_hz: f64, seed: u64, (ratio, swings): (f64, f64)) -> Recording {
    let (b, t_c) = (4e-4, 2e-3);
    let (stiff, damped) = (0.15, 0.003);
    let [j_m, j_l] = [1.0 - ratio, ratio].map(|share| share * J);
    let k = j_l * (TAU * swings).powi(2);
    let d = 0.15 * k / (TAU * swings);
    let mut random = Pcg64::seed_from_u64(seed);
    let mut normal = || -> f64 { StandardNormal.sample(&mut random) };
    let [mut theta, mut omega, mut theta_l, mut omega_l, mut phase] = [0.0_f64; 5];
    let dt = PERIOD_S / STEPS as f64;
    let (mut current, mut position) = (Vec::new(), Vec::new());
    let count = 5000;
    for n in 0..count {
        let hz = 0.2 + (to_hz - 0.2) * f64::from(n) / f64::from(count);
        phase += TAU * hz * PERIOD_S;
        let (wanted, wanted_speed) = (0.5 * phase.sin(), 0.5 * TAU * hz * phase.cos());
        let measured = (theta * COUNTS / TAU).round() * TAU / COUNTS;
        let torque = stiff * (wanted - theta) + damped * (wanted_speed - omega);
        current.push(torque / K_M + 0.002 * normal());
        position.push(measured);
        for _ in 0..STEPS {
            let joint =
                if ratio > 0.0 { k * (theta - theta_l) + d * (omega - omega_l) } else { 0.0 };
            let friction = t_c * (omega / 1e-2).tanh() + b * omega;
            omega += dt / j_m * (torque - friction - joint);
            theta += dt * omega;
            omega_l += dt / j_l.max(1e-12) * joint;
            theta_l += dt * omega_l;
        }
    }
    recording(PERIOD_S, [("i", "A", current), ("theta", "rad", position)])
}

fn found(load: (f64, f64)) -> Discovery {
    let drive = Drive::parse(DRIVE, "joint.toml").expect("right");
    let [estimation, validation] =
        [(5.0, 1), (4.0, 2)].map(|(to_hz, seed)| evidence(&drive, &recorded(to_hz, seed, load)));
    discover(&drive, &estimation, &validation, &Unwatched).expect("the base can be fitted")
}

#[test]
fn a_load_behind_a_spring_is_named_with_its_values() {
    let answer = found((0.5, 10.0));
    assert_eq!(answer.named, ["flexible_coupling"], "{:?}", answer.ranking);
    let value = |name: &str| {
        let all = answer.drive.parameters();
        all.into_iter().find(|it| it.name == name).expect("it is in the drive").value
    };
    let [k, ratio, j] = ["flexible_coupling.k", "flexible_coupling.ratio", "J"].map(value);
    assert!((j / J - 1.0).abs() < 0.1 && (ratio - 0.5).abs() < 0.1, "{j} {ratio}");
    let swings = (k / (ratio * j)).sqrt() / TAU;
    assert!((swings / 10.0 - 1.0).abs() < 0.1, "{swings} Hz");
    let left = |step: usize| {
        let torque = answer.ladder[step].validation_unexplained.torque;
        torque.expect("torque and motion were measured").rms
    };
    assert!(left(1) < 0.5 * left(0), "{:?}", answer.ladder);
}

#[test]
fn a_rigid_shaft_has_no_load_behind_a_spring() {
    let answer = found((0.0, 10.0));
    assert!(answer.named.is_empty(), "{:?}", answer.ranking);
}
