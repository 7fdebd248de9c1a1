//! Co-Simulation instances of both FMI versions: values, steps, reset, FMU state, threads.

use drivescope_fmu::import::{Error, Fmu, Instance, InstanceOptions, Interface, Progress, Value};
use rayon::prelude::*;

use crate::support::probe;

/// The probe computes the exact solution, up to rounding of a few hundred operations.
const ROUNDING: f64 = 1e-12;

fn both(test: impl Fn(&Fmu)) {
    for fmi in ["2", "3"] {
        if let Some(fmu) = probe(fmi) {
            test(&fmu);
        }
    }
}

fn instance(fmu: &Fmu) -> Instance {
    fmu.co_simulation(&InstanceOptions::named("p")).expect("the probe")
}

fn number(instance: &mut Instance, name: &str) -> f64 {
    match instance.value(name).expect(name) {
        Value::Number(number) => number,
        Value::Text(text) => panic!("{name} is {text}"),
    }
}

/// Steps of 0.05 s from 0 with u = 2 until `steps` are done; x after each.
fn lag(instance: &mut Instance, first: usize, steps: usize) -> Vec<f64> {
    (first..first + steps)
        .map(|k| {
            instance.set(&[1], &[2.0]).unwrap();
            assert_eq!(instance.step(k as f64 * 0.05, 0.05).unwrap(), Progress::Continue);
            let mut x = [0.0];
            instance.get(&[3], &mut x).unwrap();
            x[0]
        })
        .collect()
}

#[test]
fn steps_agree_with_the_exact_solution() {
    both(|fmu| {
        let mut p = instance(fmu);
        p.set_value("T", &Value::Number(0.25)).unwrap();
        p.initialize(0.0, None, None).unwrap();
        for (k, x) in lag(&mut p, 0, 40).into_iter().enumerate() {
            let exact = 2.0 * (1.0 - (-(k as f64 + 1.0) * 0.05 / 0.25).exp());
            assert!((x - exact).abs() < ROUNDING, "step {k}: {x} {exact}");
        }
        assert_eq!(number(&mut p, "n"), 20.0);
        p.terminate().unwrap();
    });
}

#[test]
fn values_of_all_types_go_in_and_out() {
    both(|fmu| {
        let mut p = instance(fmu);
        p.set_value("label", &Value::Text("hello".into())).unwrap();
        assert_eq!(p.value("label").unwrap(), Value::Text("hello".into()));
        p.set_value("on", &Value::Text("false".into())).unwrap();
        p.set_value("mode", &Value::Text("fast".into())).unwrap();
        assert_eq!((number(&mut p, "on"), number(&mut p, "mode")), (0.0, 5.0));
        let group = p.group(&["mode", "T", "on", "u", "fail"]).unwrap();
        p.write(&group, &[1.0, 0.125, 1.0, 7.0, 0.0]).unwrap();
        let mut values = [f64::NAN; 5];
        p.read(&group, &mut values).unwrap();
        assert_eq!(values, [1.0, 0.125, 1.0, 7.0, 0.0]);
        let error = p.set_value("on", &Value::Number(0.5)).unwrap_err().to_string();
        assert!(error.contains("`on` is of type Boolean and cannot take the value 0.5"), "{error}");
        let error = p.set_value("labell", &Value::Number(0.5)).unwrap_err().to_string();
        assert!(error.contains("did you mean `label`?"), "{error}");
        assert!(matches!(p.set(&[1, 2], &[0.0]), Err(Error::Lengths { .. })));
        assert!(matches!(p.group(&["label"]), Err(Error::Variable { .. })));
    });
}

#[test]
fn fmi_3_has_arrays_and_single_precision() {
    let Some(fmu) = probe("3") else { return };
    let mut p = instance(&fmu);
    assert_eq!(p.array("triple").unwrap(), [1.0, 2.0, 3.0]);
    p.set_value("single", &Value::Number(0.1)).unwrap();
    assert_eq!(number(&mut p, "single"), f64::from(0.1_f32));
    let error = p.group(&["triple"]).unwrap_err().to_string();
    assert!(error.contains("array of 3 elements"), "{error}");
}

#[test]
fn a_reset_instance_repeats_its_run() {
    both(|fmu| {
        let mut p = instance(fmu);
        p.initialize(0.0, None, None).unwrap();
        let first = lag(&mut p, 0, 10);
        assert!(matches!(p.initialize(0.0, None, None), Err(Error::Order { .. })));
        p.reset().unwrap();
        assert!(matches!(p.step(0.0, 0.1), Err(Error::Order { .. })));
        p.initialize(0.0, None, None).unwrap();
        assert_eq!(lag(&mut p, 0, 10), first);
    });
}

#[test]
fn a_restored_state_replays_bit_for_bit() {
    both(|fmu| {
        for kind in [Interface::CoSimulation, Interface::ModelExchange] {
            let mut p = fmu.instantiate(kind, &InstanceOptions::default()).unwrap();
            p.initialize(0.0, None, None).unwrap();
            lag(&mut p, 0, 5);
            let mut state = p.state().unwrap();
            let first = lag(&mut p, 5, 10);
            p.restore(&state).unwrap();
            assert_eq!(p.time(), 0.25);
            assert_eq!(lag(&mut p, 5, 10), first);
            let bytes = p.serialize(&state).unwrap();
            let copy = p.deserialize(&bytes).unwrap();
            for wrong in [&bytes[..9], &[255; 99], &[]] {
                assert!(matches!(p.deserialize(wrong), Err(Error::StateBytes { .. })));
            }
            lag(&mut p, 5, 3);
            p.restore(&copy).unwrap();
            assert_eq!(lag(&mut p, 5, 10), first);
            p.save_into(&mut state).unwrap();
            let on = lag(&mut p, 15, 2);
            p.restore(&state).unwrap();
            assert_eq!(lag(&mut p, 15, 2), on);
            let mut other = fmu.instantiate(kind, &InstanceOptions::default()).unwrap();
            assert!(matches!(other.restore(&state), Err(Error::ForeignState { .. })));
            let elsewhere = other.deserialize(&bytes).unwrap();
            other.restore(&elsewhere).unwrap();
            assert_eq!(lag(&mut other, 5, 10), first);
        }
    });
}

#[test]
fn directional_derivatives_are_those_of_the_model() {
    both(|fmu| {
        let mut p = instance(fmu);
        p.initialize(0.0, None, None).unwrap();
        // d(der(x)) = (du - dx) / T with T = 0.5
        assert_eq!(p.directional_derivative(&[4], &[1, 3], &[1.0, 0.25]).unwrap(), [1.5]);
    });
}

#[test]
fn instances_run_in_parallel_and_are_independent() {
    both(|fmu| {
        let run = |seed: usize| {
            let mut p = instance(fmu);
            p.set_value("T", &Value::Number(0.1 + 0.01 * seed as f64)).unwrap();
            p.initialize(0.0, None, None).unwrap();
            lag(&mut p, 0, 50)
        };
        let serial: Vec<_> = (0..32).map(run).collect();
        let parallel: Vec<_> = (0..32).into_par_iter().map(run).collect();
        assert_eq!(serial, parallel);
        assert_ne!(serial[0], serial[1]);
    });
}

#[test]
fn a_model_may_start_at_any_time() {
    both(|fmu| {
        let mut p = instance(fmu);
        p.initialize(10.0, Some(11.0), None).unwrap();
        p.step(10.0, 0.5).unwrap();
        assert!((number(&mut p, "x") - (1.0 - (-1.0_f64).exp())).abs() < ROUNDING);
    });
}
