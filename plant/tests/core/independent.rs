//! The integration core against an independent program over `ode_solvers` at 1e-10.

use drivescope_plant::effects::registry::Kind;

use crate::oracle::{self, DR300, Solver, Truth};
use crate::support::{
    OpenLoop, PERIOD, Run, closed_loop, dr300, dr300_friction, drive, noise, ours, ours_over, part,
    relative_difference, stick_slip,
};

/// The bar: greatest difference of a variable over its greatest magnitude.
const BAR: f64 = 1e-6;
/// The sub-steps are chosen so that a well-conditioned run stays this far below the bar.
const COMFORT: f64 = 5.0;
/// Relative change of u from which the conditioning of a run is measured.
const NUDGE: f64 = 1e-9;
/// A run that answers to that change by more than this many times as much lets any two
/// integrations part (a break-away that just happens): it proves nothing and is not used.
const WORST_CONDITION: f64 = 1e4;

fn greatest(of: [f64; 3]) -> f64 {
    of.into_iter().fold(0.0, f64::max)
}

fn agree(name: &str, found: &Run, expected: &Run) {
    within(BAR / COMFORT, name, found, expected);
}

fn within(bar: f64, name: &str, found: &Run, expected: &Run) {
    let [i, omega, theta] = relative_difference(found, expected);
    println!("{name}: i {i:.1e}, omega {omega:.1e}, theta {theta:.1e}");
    assert!(greatest([i, omega, theta]) < bar, "{name}: {i:e}, {omega:e}, {theta:e}");
}

fn run(scenario: &OpenLoop, gain: f64, mut advance: impl FnMut(f64, f64) -> [f64; 3]) -> Run {
    scenario.inputs.iter().map(|[u, load]| advance(gain * u, *load)).collect()
}

#[test]
fn a_closed_loop_run_from_rest_agrees() {
    let found = closed_loop(5000, ours(dr300()));
    let expected = closed_loop(5000, oracle::reference(DR300, PERIOD));
    assert!(found[4999][1] > 200.0, "it runs at speed");
    agree("closed loop", &found, &expected);
    // The speed that `benches/stepping.rs` compares is not bought with accuracy.
    let plain = closed_loop(5000, oracle::run_by(Solver::Plain, DR300, PERIOD));
    let [own, other] = [&found, &plain].map(|run| greatest(relative_difference(run, &expected)));
    println!("closed loop: ours {own:.1e}, Dopri5 at 1e-6 {other:.1e}");
    assert!(own <= other, "{own:e} against {other:e}");
}

#[test]
fn stick_slip_runs_agree() {
    for scenario in stick_slip() {
        let found = run(&scenario, 1.0, ours(dr300()));
        let expected = run(&scenario, 1.0, oracle::reference(DR300, PERIOD));
        let stuck = expected.iter().filter(|x| x[1] == 0.0).count();
        assert_eq!(stuck, found.iter().filter(|x| x[1] == 0.0).count());
        agree(&format!("{} ({stuck} samples stuck)", scenario.name), &found, &expected);
    }
}

#[test]
fn stick_slip_runs_with_nonlinear_effects_agree() {
    let truth = Truth { drag: 1e-7, cogging: [12.0, 0.002, 0.003], saturation: 0.02, ..DR300 };
    let mut parts = dr300_friction();
    parts.push(part(Kind::QuadraticDrag, &[1e-7]));
    parts.push(part(Kind::Cogging, &[12.0, 0.002, 0.003]));
    parts.push(part(Kind::Saturation, &[0.02]));
    for scenario in stick_slip() {
        let found = run(&scenario, 1.0, ours(drive(&parts)));
        let expected = run(&scenario, 1.0, oracle::reference(truth, PERIOD));
        let nudged = run(&scenario, 1.0 + NUDGE, oracle::reference(truth, PERIOD));
        let condition = greatest(relative_difference(&nudged, &expected)) / NUDGE;
        assert!(condition < WORST_CONDITION, "{}: {condition:e}", scenario.name);
        agree(&format!("{} (condition {condition:.0})", scenario.name), &found, &expected);
    }
}

/// An armature slow enough to ring (complex eigenvalues) and long intervals: the exact step must
/// not jump over a dip of the speed to zero.
#[test]
fn long_intervals_of_a_ringing_drive_agree() {
    const LONG: f64 = 0.25;
    let truth = Truth { r: 1.5, l: 0.1, ..DR300 };
    let mut model = dr300();
    model.motors.r = [truth.r];
    model.motors.l = [truth.l];
    let mut ours = ours_over(model, LONG);
    let mut expected = oracle::reference(truth, LONG);
    let mut u = noise(11);
    let inputs: Vec<f64> =
        (0..400).map(|k| if k % 6 < 3 { 12.0 + u() } else { 3.5 + u() }).collect();
    let found: Run = inputs.iter().map(|u| ours(*u, 0.0)).collect();
    let expected: Run = inputs.iter().map(|u| expected(*u, 0.0)).collect();
    // Radians of ringing add up: without comfort.
    within(BAR, "ringing armature, 0.25 s", &found, &expected);
}
