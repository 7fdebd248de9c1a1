//! An arm that a position loop moves from place to place, logged over a bus: now and then a row repeats the
//! last position, and the others are read a moment late. The torque that the loop asks for shows its weight
//! all the same.

mod joint;

use drivescope_discovery::signals::repaired;
use drivescope_discovery::{Discovery, Unwatched, discover};
use drivescope_plant::drive::Drive;
use drivescope_recording::Recording;
use joint::{evidence, recording};
use rand::{RngExt as _, SeedableRng as _};
use rand_distr::{Distribution as _, StandardNormal};
use rand_pcg::Pcg64;

/// A first drive file of such an arm, with values that are off.
const DRIVE: &str = "schema = 1\nname = \"arm\"\n[motor]\ninput = \"force\"\nK_m = 1.0\n\
                     J = 0.05\nB_m = 0.5\n[[effect]]\nkind = \"coulomb\"\nT_c = 0.5\n\
                     [fit]\nfixed = [\"K_m\"]\n";
const PERIOD_S: f64 = 2e-3;
/// Steps of the simulation a sample.
const STEPS: usize = 20;
/// Counts a radian.
const COUNTS: f64 = 6e4;
/// Weight times its arm, N m.
const WEIGHT: f64 = 4.0;
/// Time that a reading may be late, s, and the share of rows that repeat the last one.
const LATE_S: f64 = 6e-4;
const REPEATED: f64 = 0.1;

fn recorded(seed: u64, weight: f64) -> Recording {
    let (j, b, t_c) = (0.25, 0.05, 0.25);
    let mut random = Pcg64::seed_from_u64(seed);
    let (mut theta, mut omega, mut target, mut wanted) = (0.0_f64, 0.0_f64, 0.0, 0.0);
    let dt = PERIOD_S / STEPS as f64;
    let (mut torques, mut positions) = (Vec::new(), Vec::<f64>::new());
    for k in 0..9000 {
        if k % 600 == 0 {
            target = random.random_range(0.0..4.0);
        }
        // The loop's own generator is no faster than the arm.
        let most: f64 = 8.0 * PERIOD_S;
        wanted += f64::clamp(target - wanted, -most, most);
        let shown = ((theta - omega * random.random_range(0.0..LATE_S)) * COUNTS).round() / COUNTS;
        let repeats = random.random_range(0.0..1.0) < REPEATED;
        positions.push(positions.last().copied().filter(|_| repeats).unwrap_or(shown));
        let asked: f64 = 300.0 * (wanted - theta) - 12.0 * omega;
        let noise: f64 = StandardNormal.sample(&mut random);
        torques.push(asked.clamp(-32.0, 32.0) + 0.02 * noise);
        for _ in 0..STEPS {
            let friction = t_c * (omega / 1e-2).tanh() + b * omega;
            let torque = torques[k] - friction - weight * theta.sin();
            omega += dt / j * torque;
            theta += dt * omega;
        }
    }
    repaired(recording(PERIOD_S, [("i", "A", torques), ("theta", "rad", positions)])).0
}

fn found(weight: f64) -> Discovery {
    let drive = Drive::parse(DRIVE, "arm.toml").expect("right");
    let [estimation, validation] = [1, 2].map(|seed| evidence(&drive, &recorded(seed, weight)));
    discover(&drive, &estimation, &validation, &Unwatched).expect("the base can be fitted")
}

#[test]
fn the_weight_of_an_arm_is_named_with_its_size() {
    let answer = found(WEIGHT);
    assert_eq!(answer.named, ["unbalance"], "{:?}", answer.ranking);
    let first = answer.ranking.iter().find(|it| it.refused.is_none()).expect("it was named");
    let size = first.parameters["unbalance.a"].value.hypot(first.parameters["unbalance.b"].value);
    assert!((size / WEIGHT - 1.0).abs() < 0.1, "{size}");
}

#[test]
fn nothing_is_named_where_the_arm_has_no_weight() {
    let answer = found(0.0);
    assert!(answer.named.is_empty(), "{:?}", answer.ranking);
}
