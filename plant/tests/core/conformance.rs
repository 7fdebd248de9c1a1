//! What every effect owes: exact derivatives, a null, no energy from nowhere, fine sub-steps.

use std::f64::consts::TAU;

use drivescope_numerics::{Dual, Real};
use drivescope_plant::effects::registry::{Entry, REGISTRY};
use drivescope_plant::integrate::{Integrator, State, longest_substep};
use drivescope_plant::model::{Applied, CURRENT, Model, SPEED, field};

use crate::battery::{cases, with};
use crate::support::{TOP_SPEED, noise};

/// Length of an interval, s, and their number.
const H: f64 = 0.005;
const SAMPLES: usize = 100;

/// Slow reversals that stick: u at interval k.
fn voltage(k: usize) -> f64 {
    3.0 * (TAU * 4.0 * k as f64 * H).sin()
}

/// Runs of all states over the test voltage with sub-steps of at most `longest` seconds.
fn run<R: Real>(model: Model<R, 1>, longest: f64) -> Vec<Vec<R>> {
    let mut state = State::at_rest(&model);
    let mut integrator = Integrator::paced(model, longest);
    (0..SAMPLES)
        .map(|k| {
            let time = k as f64 * H;
            let load = R::constant(0.002 * (TAU * 3.0 * time).cos());
            let applied = Applied { u: [R::constant(voltage(k))], load: [load], time };
            integrator.advance(&mut state, &applied, R::constant(H));
            assert!(state.is_finite());
            state.x.iter().map(|x| x[0]).collect()
        })
        .collect()
}

fn range(run: &[Vec<f64>], j: usize) -> f64 {
    run.iter().map(|x| x[j].abs()).fold(f64::MIN_POSITIVE, f64::max)
}

/// Sub-steps short enough that a step boundary passing an event leaves no trace in differences.
const FINE: f64 = 2e-5;
/// Relative change of a parameter for differences, and twice it for extrapolation.
const STEP: f64 = 1e-5;
/// Extrapolated differences and duals agree to this share of the greatest derivative ..
const DERIVATIVE: f64 = 1e-6;
/// The same where a step boundary passes a kink that no step locates.
const KINKED_DERIVATIVE: f64 = 1e-4;
/// .. or to this rounding error of the state's range over the change of the parameter.
const ROUNDING: f64 = 1e-12;
/// Half of the derivatives of drives with one effect agree better than this, events and all.
const TYPICAL_DERIVATIVE: f64 = 4e-9;

#[test]
fn duals_equal_finite_differences_through_stick_slip() {
    let mut typical = Vec::new();
    for case in cases() {
        let values = case.parameters();
        let base = run(case.nominal::<f64>(), FINE);
        for k in 0..values.len() {
            let dual = run(case.model(|j, v| Dual::<1> { v, d: [f64::from(j == k)] }), FINE);
            let change = STEP * values[k].abs();
            let moved = |steps: f64| {
                run(case.model(|j, v| if j == k { v + steps * change } else { v }), FINE)
            };
            let [up, down, far_up, far_down] = [1.0, -1.0, 2.0, -2.0].map(moved);
            for j in 0..base[0].len() {
                let difference = |n: usize| {
                    let near = up[n][j] - down[n][j];
                    let far = far_up[n][j] - far_down[n][j];
                    (8.0 * near - far) / (12.0 * change)
                };
                let size = dual.iter().map(|x| x[j].d[0].abs()).fold(0.0, f64::max);
                let apart = (0..SAMPLES).map(|n| (difference(n) - dual[n][j].d[0]).abs());
                let worst = apart.fold(0.0, f64::max);
                let share = if case.kinked() { KINKED_DERIVATIVE } else { DERIVATIVE };
                let allowed = share * size + ROUNDING * range(&base, j) / change;
                let name = case.name;
                assert!(
                    worst <= allowed,
                    "{name}, parameter {k}, state {j}: {worst:e} of {size:e}"
                );
                if size > 0.0 && case.entry.is_some() {
                    typical.push(worst / size);
                }
            }
        }
    }
    typical.sort_by(f64::total_cmp);
    let (median, count) = (typical[typical.len() / 2], typical.len());
    println!("duals against differences: median {median:.1e} of {count} derivatives");
    assert!(median < TYPICAL_DERIVATIVE, "{median:e}");
}

/// A quantised signal has the slope of its mean, which is not that of its steps.
const STEPPED: [&str; 1] = ["quantisation"];

#[test]
fn duals_equal_finite_differences_of_what_sensors_show() {
    let smooth = |entry: &&Entry| entry.info.senses() && !STEPPED.contains(&entry.info.id);
    for entry in REGISTRY.iter().filter(smooth) {
        let case = with(entry);
        let states = case.nominal::<f64>().states();
        let values = case.parameters();
        let mut draw = noise(9);
        for (mut x, applied, _) in situations(states) {
            x[3..].iter_mut().for_each(|own| own[0] = draw());
            for k in 0..values.len() {
                let change = STEP * values[k].abs();
                let moved = |steps: f64| {
                    let model = case.model(|j, v| if j == k { v + steps * change } else { v });
                    model.outputs(&x, &applied).lane(0)
                };
                let (up, down) = (moved(1.0), moved(-1.0));
                let lift = |value: f64| Dual::<1>::constant(value);
                let model = case.model(|j, v| Dual::<1> { v, d: [f64::from(j == k)] });
                let lifted: Vec<_> = x.iter().map(|x| x.map(lift)).collect();
                let applied = Applied {
                    u: applied.u.map(lift),
                    load: applied.load.map(lift),
                    time: applied.time,
                };
                let dual = model.outputs(&lifted, &applied).lane(0);
                for (up, down, dual) in [
                    (up.i, down.i, dual.i),
                    (up.omega, down.omega, dual.omega),
                    (up.theta, down.theta, dual.theta),
                ] {
                    let apart = ((up - down) / (2.0 * change) - dual.d[0]).abs();
                    let allowed = DERIVATIVE * dual.d[0].abs() + ROUNDING * up.abs() / change;
                    assert!(apart <= allowed, "{}, parameter {k}: {apart:e}", entry.info.id);
                }
            }
        }
    }
}

/// The pace of a drive leaves no more than this against sub-steps eight times as short (own
/// states of ringing couplings and bristles; the three of the motor stay 5 times below it).
const PACE: f64 = 1e-6;
/// The same where a law has a kink that no step locates: what `Info::kinked` promises.
const KINKED_PACE: f64 = 1e-5;

#[test]
fn the_pace_is_fine_enough_for_every_effect() {
    for case in cases() {
        let longest = longest_substep(&case.nominal::<f64>(), TOP_SPEED);
        let found = run(case.nominal::<f64>(), longest);
        let fine = run(case.nominal::<f64>(), longest / 8.0);
        let apart = (0..found[0].len()).map(|j| {
            let apart = (0..SAMPLES).map(|n| (found[n][j] - fine[n][j]).abs());
            apart.fold(0.0, f64::max) / range(&fine, j)
        });
        let worst = apart.fold(0.0, f64::max);
        println!("{}: off by {worst:.1e} with sub-steps of {longest:.1e} s", case.name);
        let pace = if case.kinked() { KINKED_PACE } else { PACE };
        assert!(worst < pace, "{}: {worst:e}", case.name);
    }
}

/// States and inputs over all quadrants, own states at zero.
fn situations(states: usize) -> impl Iterator<Item = (Vec<[f64; 1]>, Applied<f64, 1>, f64)> {
    let mut draw = noise(5);
    (0..400).map(move |_| {
        let mut x = vec![[0.0]; states];
        x[CURRENT] = [2.0 * draw()];
        x[SPEED] = [if draw() > 0.0 { 100.0 } else { 3.0 } * draw()];
        x[2] = [10.0 * draw()];
        let applied = Applied { u: [10.0 * draw()], load: [0.02 * draw()], time: draw().abs() };
        let sign = x[SPEED][0].signum();
        (x, applied, sign)
    })
}

/// Slopes of current, speed and position.
fn slopes(model: &Model<f64, 1>, x: &[[f64; 1]], applied: &Applied<f64, 1>, sign: f64) -> [f64; 3] {
    let mut dx = vec![[0.0]; model.states()];
    field(model, x, applied, &[sign], &mut dx, None);
    [dx[0][0], dx[1][0], dx[2][0]]
}

/// The case's drive with the parameters of the tested effect at their nulls, `large` for an
/// infinite stiffness.
fn nulled(entry: &'static Entry, large: f64) -> Model<f64, 1> {
    let mut case = with(entry);
    let (_, values) = case.parts.last_mut().expect("the tested effect");
    for (name, null) in entry.info.nulls {
        let place = entry.parameters.iter().position(|p| p.name == *name);
        values[place.expect("a null names a parameter")] =
            if null.is_finite() { *null } else { large };
    }
    case.nominal()
}

/// The base drive without the tested effect.
fn without(entry: &'static Entry) -> Model<f64, 1> {
    let mut case = with(entry);
    case.parts.pop();
    case.nominal()
}

#[test]
fn a_finite_null_contributes_nothing_at_all() {
    let finite = |entry: &&Entry| entry.info.nulls.iter().all(|(_, null)| null.is_finite());
    for entry in REGISTRY.iter().filter(finite) {
        assert!(!entry.info.nulls.is_empty(), "{} can vanish", entry.info.id);
        let (model, base) = (nulled(entry, f64::NAN), without(entry));
        for (x, applied, sign) in situations(model.states()) {
            let expected = slopes(&base, &x[..3], &applied, sign);
            assert_eq!(slopes(&model, &x, &applied, sign), expected, "{}", entry.info.id);
            let shown = base.outputs(&x[..3], &applied);
            assert_eq!(model.outputs(&x, &applied), shown, "{}", entry.info.id);
        }
    }
}

/// Ten times the stiffness leaves at most this share of the difference from the base drive:
/// it falls with the compliance or its root.
const STIFFER: f64 = 0.5;

#[test]
fn an_infinite_null_is_reached_in_the_limit() {
    let infinite = |entry: &&Entry| entry.info.nulls.iter().any(|(_, null)| null.is_infinite());
    for entry in REGISTRY.iter().filter(infinite) {
        let expected = run(without(entry), FINE);
        let apart = [10.0, 100.0, 1000.0].map(|factor| {
            let of = entry.parameters.iter().find(|p| p.name == entry.info.nulls[0].0);
            let large = of.expect("a null names a parameter").nominal * factor;
            let found = run(nulled(entry, large), FINE);
            let apart = (0..SAMPLES).map(|n| (found[n][SPEED] - expected[n][SPEED]).abs());
            apart.fold(0.0, f64::max) / range(&expected, SPEED)
        });
        println!("{}: {apart:?} from the base drive", entry.info.id);
        assert!(apart[1] < STIFFER * apart[0] && apart[2] < STIFFER * apart[1], "{apart:?}");
    }
}

#[test]
fn what_dissipates_is_so_marked_and_friction_does() {
    for entry in REGISTRY {
        let (model, base) = (with(entry).nominal::<f64>(), without(entry));
        let (mut takes, mut gives) = (0, 0);
        for (x, applied, sign) in situations(model.states()) {
            let [_, with, _] = slopes(&model, &x, &applied, sign);
            let [_, without, _] = slopes(&base, &x[..3], &applied, sign);
            let power = (with - without) * x[SPEED][0];
            takes += usize::from(power < 0.0);
            gives += usize::from(power > 0.0);
        }
        let dissipates = takes > 0 && gives == 0;
        let replaces = entry.info.replaces_dry;
        assert!(
            replaces || dissipates == entry.info.dissipates,
            "{}: {takes}, {gives}",
            entry.info.id
        );
    }
}

/// Rounding of a power of some ten watts.
const WATT: f64 = 1e-12;

/// Of what acts in the electrical balance nothing makes energy; with K_m = K_e the armature
/// gives to the shaft what the back-EMF takes, so an effect on the flux changes no sum.
#[test]
fn energy_closes_for_electrical_effects() {
    for entry in REGISTRY {
        let [model, base] = [with(entry).nominal::<f64>(), without(entry)].map(|mut model| {
            model.motors.k_e = model.motors.k_m;
            model
        });
        let mut shares = Vec::new();
        for (x, applied, sign) in situations(model.states()) {
            let [current, speed, _] = slopes(&model, &x, &applied, sign);
            let [base_current, base_speed, _] = slopes(&base, &x[..3], &applied, sign);
            if current != base_current {
                let electrical = x[CURRENT][0] * model.motors.l[0] * (current - base_current);
                let mechanical = x[SPEED][0] * model.motors.j[0] * (speed - base_speed);
                shares.push((electrical, mechanical));
            }
        }
        let name = entry.info.id;
        assert!(name != "saturation" || !shares.is_empty(), "saturation is electrical");
        for (electrical, mechanical) in shares {
            let (sum, size) = (electrical + mechanical, electrical.abs());
            assert!(sum <= WATT * (1.0 + size), "{name}: {sum:e} W made");
            // With its own states at zero an effect in both balances is one on the flux.
            let flux = mechanical == 0.0 || sum.abs() <= WATT * (1.0 + size);
            assert!(flux, "{name}: {electrical} W and {mechanical} W");
        }
    }
}

/// A disturbed stiff state stays finite where the nominal drive already looks well.
#[test]
fn a_stiff_contact_stays_finite() {
    for entry in REGISTRY.iter().filter(|entry| entry.info.stiff) {
        for factor in [0.01, 0.1, 1.0, 10.0, 100.0] {
            let mut case = with(entry);
            let (_, values) = case.parts.last_mut().expect("the tested effect");
            values.iter_mut().for_each(|v| *v *= factor);
            let model = case.nominal::<f64>();
            let longest = longest_substep(&model, TOP_SPEED);
            // `run` asserts that every state is finite.
            run(model, longest);
        }
    }
}
