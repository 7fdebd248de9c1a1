//! Lanes equal the scalar run bit for bit, through reversals and sticking, however grouped.

use std::f64::consts::TAU;

use drivescope_numerics::Real;
use drivescope_plant::integrate::{Block, Integrator, State, longest_substep};
use drivescope_plant::model::{Applied, Model};

use crate::battery::{Case, base, cases};
use crate::support::{TOP_SPEED, noise};

const H: f64 = 0.005;
const SAMPLES: usize = 120;
/// Drives of a case; blocks of this width and narrower ones hold them.
const DRIVES: usize = 32;
/// Greatest relative change of a parameter.
const SPREAD: f64 = 0.2;

/// A drive whose parameters are all moved a little, the same for the same number.
fn perturbed(case: &Case, number: usize) -> Model<f64, 1> {
    let mut draw = noise(number as u64);
    let mut near = move |value: f64| value * (1.0 + SPREAD * (draw() / 3.0).clamp(-1.0, 1.0));
    let mut model = case.model(|_, value| near(value));
    for value in [
        &mut model.motors.r[0],
        &mut model.motors.l[0],
        &mut model.motors.k_m[0],
        &mut model.motors.j[0],
        &mut model.motors.b_m[0],
    ] {
        *value = near(*value);
    }
    model
}

/// Voltage and load of drive `number` over interval `k`: reversals with sticking, each drive at
/// its own phase; a third of them runs up to speed and stays there.
fn inputs(number: usize, k: usize) -> (f64, f64) {
    let time = k as f64 * H;
    let phase = number as f64 * 0.2;
    let u = if number.is_multiple_of(3) { 15.0 } else { 3.0 * (TAU * 4.0 * time + phase).sin() };
    (u, 0.002 * (TAU * 3.0 * time + phase).cos())
}

fn bits(state: &[f64], sign: f64) -> Vec<u64> {
    state.iter().chain([&sign]).map(|x| x.to_bits()).collect()
}

/// Every sample of one drive alone.
fn alone(case: &Case, longest: f64, number: usize) -> Vec<Vec<u64>> {
    let model = perturbed(case, number);
    let mut state = State::at_rest(&model);
    let mut integrator = Integrator::paced(model, longest);
    let samples = (0..SAMPLES).map(|k| {
        let (u, load) = inputs(number, k);
        let applied = Applied { u: [u], load: [load], time: k as f64 * H };
        integrator.advance(&mut state, &applied, H);
        assert!(state.is_finite(), "{}: drive {number} at sample {k}", case.name);
        let x: Vec<f64> = state.x.iter().map(|x| x[0]).collect();
        bits(&x, state.sign[0])
    });
    samples.collect()
}

/// Every sample of `N` drives from number `first` on, in a block.
fn block<const N: usize>(case: &Case, longest: f64, first: usize) -> Vec<Vec<Vec<u64>>> {
    let models: [Model<f64, 1>; N] = std::array::from_fn(|l| perturbed(case, first + l));
    let model = Model::side_by_side(models.each_ref());
    let mut state = State::at_rest(&model);
    let mut block = Block::paced(model, longest);
    let mut runs = vec![Vec::new(); N];
    for k in 0..SAMPLES {
        let drives: [(f64, f64); N] = std::array::from_fn(|l| inputs(first + l, k));
        let (u, load) = (drives.map(|d| d.0), drives.map(|d| d.1));
        block.advance(&mut state, &Applied { u, load, time: k as f64 * H }, H);
        for (l, run) in runs.iter_mut().enumerate() {
            let x: Vec<f64> = state.x.iter().map(|x| x[l]).collect();
            run.push(bits(&x, state.sign[l]));
        }
    }
    runs
}

#[test]
fn lanes_equal_the_scalar_run_bit_for_bit() {
    let mut all = cases();
    all.push(base());
    for case in all {
        let longest = longest_substep(&case.nominal::<f64>(), TOP_SPEED);
        let scalar: Vec<_> = (0..DRIVES).map(|number| alone(&case, longest, number)).collect();
        let reversed = |run: &Vec<Vec<u64>>| {
            let sign = |x: &Vec<u64>| f64::from_bits(x[1]).partial_cmp(&0.0);
            run.windows(2).any(|pair| sign(&pair[0]) != sign(&pair[1]))
        };
        assert!(scalar.iter().filter(|run| reversed(run)).count() > DRIVES / 2, "they reverse");
        // Each grouping in a thread of its own.
        let (wide, narrow) = std::thread::scope(|scope| {
            let wide = scope.spawn(|| block::<DRIVES>(&case, longest, 0));
            let narrow = scope.spawn(|| {
                let eights = (0..DRIVES / 8).flat_map(|b| block::<8>(&case, longest, 8 * b));
                eights.collect::<Vec<_>>()
            });
            (wide.join().expect("a block"), narrow.join().expect("blocks"))
        });
        for number in 0..DRIVES {
            for k in 0..SAMPLES {
                let expected = &scalar[number][k];
                let (wide, narrow) = (&wide[number][k], &narrow[number][k]);
                assert_eq!(wide, expected, "{}: drive {number}, sample {k}", case.name);
                assert_eq!(narrow, expected, "{}: drive {number}, sample {k}", case.name);
            }
        }
    }
}

/// A block finds its own sub-steps as a drive does: equal drives take equal ones.
#[test]
fn equal_drives_need_no_fixed_pace() {
    for case in cases() {
        let model = case.nominal::<f64>();
        let mut one = State::at_rest(&model);
        let mut many = State::<f64, 4>::at_rest(&Model::side_by_side([&model; 4]));
        let mut block = Block::new(Model::side_by_side([&model; 4]), TOP_SPEED);
        let mut integrator = Integrator::new(model, TOP_SPEED);
        for k in 0..SAMPLES {
            let (u, load) = inputs(1, k);
            let time = k as f64 * H;
            integrator.advance(&mut one, &Applied { u: [u], load: [load], time }, H);
            block.advance(&mut many, &Applied { u: [u; 4], load: [load; 4], time }, H);
            for (x, lanes) in one.x.iter().zip(many.x.iter()) {
                assert_eq!(lanes, &[x[0]; 4], "{} at sample {k}", case.name);
            }
        }
    }
}

/// A state that is no number is seen, whichever lane it stands in.
#[test]
fn a_state_that_is_no_number_is_seen() {
    let model = base().nominal::<f64>();
    let mut state = State::<f64, 3>::at_rest(&Model::side_by_side([&model; 3]));
    assert!(state.is_finite());
    state.x[0][2] = f64::NAN;
    assert!(!state.is_finite());
    state.x[0][2] = f64::zero();
    state.x[1][0] = f64::INFINITY;
    assert!(!state.is_finite());
}
