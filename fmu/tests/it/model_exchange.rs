//! Model Exchange: the integration between events, time events, state events found by bisection.

use drivescope_fmu::import::{Error, Fmu, Instance, InstanceOptions, Value};

use crate::support::probe;

/// The tolerance that the tests ask the integrator for.
const TOLERANCE: f64 = 1e-10;
/// The error may grow over the run, and after each bounce; not by more than this.
const ALLOWED: f64 = 1e-8;

fn both(test: impl Fn(&Fmu)) {
    for fmi in ["2", "3"] {
        if let Some(fmu) = probe(fmi) {
            test(&fmu);
        }
    }
}

fn start(fmu: &Fmu) -> Instance {
    let mut p = fmu.model_exchange(&InstanceOptions::default()).expect("the probe");
    p.initialize(0.0, None, Some(TOLERANCE)).expect("the probe starts");
    p
}

#[test]
fn it_agrees_with_co_simulation_through_bounces_and_samples() {
    both(|fmu| {
        let mut me = start(fmu);
        let mut cs = fmu.co_simulation(&InstanceOptions::default()).unwrap();
        cs.initialize(0.0, None, None).unwrap();
        // 0.03 s is no divisor of the sampling time 0.1 s, so most samples fall inside a step.
        let h = 0.03;
        for k in 0..50 {
            let t = f64::from(k) * h;
            for p in [&mut me, &mut cs] {
                p.set(&[1], &[(3.0 * t).sin()]).unwrap();
                p.step(t, h).unwrap();
            }
            let (mut a, mut b) = ([0.0; 4], [0.0; 4]);
            me.get(&[3, 5, 6, 10], &mut a).unwrap();
            cs.get(&[3, 5, 6, 10], &mut b).unwrap();
            for (a, b) in a.iter().zip(&b) {
                assert!((a - b).abs() < ALLOWED, "t = {t}: {a} {b}");
            }
        }
    });
}

#[test]
fn a_bounce_is_found_at_its_time() {
    both(|fmu| {
        let mut p = start(fmu);
        // From 1 m it falls for sqrt(2 / g); then it rises with e times its speed.
        let fall = (2.0_f64 / 9.81).sqrt();
        p.step(0.0, fall + 0.1).unwrap();
        let mut now = [0.0; 2];
        p.get(&[5, 6], &mut now).unwrap();
        let up = 0.7 * 9.81 * fall;
        assert!((now[0] - (up * 0.1 - 0.5 * 9.81 * 0.01)).abs() < ALLOWED, "{now:?}");
        assert!((now[1] - (up - 9.81 * 0.1)).abs() < ALLOWED, "{now:?}");
    });
}

#[test]
fn inputs_that_are_set_before_a_sample_are_sampled() {
    both(|fmu| {
        let mut p = start(fmu);
        let mut held = [0.0];
        for k in 0..3 {
            p.set(&[1], &[f64::from(k) + 5.0]).unwrap();
            p.step(f64::from(k) * 0.1, 0.1).unwrap();
            p.get(&[10], &mut held).unwrap();
            assert_eq!(held[0], f64::from(k) + 5.0);
        }
    });
}

#[test]
fn the_error_falls_with_the_tolerance() {
    let Some(fmu) = probe("3") else { return };
    let error = |tolerance: f64| {
        let mut p = fmu.model_exchange(&InstanceOptions::default()).unwrap();
        p.set_value("g", &Value::Number(1e-3)).unwrap();
        p.initialize(0.0, None, Some(tolerance)).unwrap();
        p.step(0.0, 0.09).unwrap();
        let mut x = [0.0];
        p.get(&[3], &mut x).unwrap();
        (x[0] - (1.0 - (-0.09_f64 / 0.5).exp())).abs()
    };
    let errors = [1e-3, 1e-6, 1e-9].map(error);
    assert!(errors[2] < 1e-9 && errors[2] <= errors[1] && errors[1] <= errors[0], "{errors:?}");
}

#[test]
fn endless_bouncing_is_reported() {
    both(|fmu| {
        let mut p = start(fmu);
        // The bounces accumulate at 0.45 s (1 + e) / (1 - e) = 2.56 s.
        let error = (0..40).find_map(|k| p.step(f64::from(k) * 0.1, 0.1).err());
        let Some(Error::Integration { time, .. }) = error else { panic!("{error:?}") };
        assert!((2.4..2.7).contains(&time), "{time}");
    });
}

#[test]
fn an_error_in_the_derivatives_is_reported() {
    both(|fmu| {
        let mut p = fmu.model_exchange(&InstanceOptions::named("bad")).unwrap();
        p.set_value("fail", &Value::Number(3.0)).unwrap();
        p.set_value("e", &Value::Number(0.0)).unwrap();
        p.initialize(0.0, None, None).unwrap();
        p.step(0.0, 0.3).unwrap();
        let error = p.step(0.9, 0.2).unwrap_err().to_string();
        assert!(error.contains("Derivatives of `bad` returned Error"), "{error}");
    });
}
