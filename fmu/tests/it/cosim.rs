//! The co-simulation algorithm, against the same recursions written out by hand.

use std::sync::Arc;

use drivescope_fmu::cosim::{
    Algorithm, Component, End, Error, Experiment, Failure, FmuComponent, Outcome, Phase, Port,
    Ports, System,
};
use drivescope_fmu::import::{Conversion, Fmu, InstanceOptions, Interface, Progress, Value};
use drivescope_recording::{Recording, Signal};
use rayon::prelude::*;

use crate::foreign::lags;
use crate::support::probe;

/// Exponentials and products rounded in another order over some hundred steps.
const ROUNDING: f64 = 1e-13;

/// A probe with another time constant.
fn lag(fmu: &Fmu, time_constant: f64) -> FmuComponent {
    let mut instance = fmu.co_simulation(&InstanceOptions::default()).expect("the probe");
    instance.set_value("T", &Value::Number(time_constant)).expect("the probe");
    FmuComponent::new(instance)
}

/// Two lags that follow each other: `0.5 dx/dt = y - x`, `0.2 dy/dt = 1 - x - y`.
fn ring(fmu: &Fmu, experiment: Experiment) -> System<'static> {
    let mut system = System::new(experiment);
    system.add("a", lag(fmu, 0.5)).unwrap();
    system.add("b", lag(fmu, 0.2)).unwrap();
    system.connect("b.x", "a.u").unwrap();
    system.connect_scaled("a.x", "b.u", Conversion { factor: -1.0, offset: 1.0 }).unwrap();
    system.record("a.x").unwrap();
    system.record("b.x").unwrap();
    system
}

fn signal<'a>(outcome: &'a Outcome, name: &str) -> &'a [f64] {
    &outcome.recording.signal(name).expect(name).values
}

/// The recursion that the ring must follow; `order` is which component steps first, if one does.
fn by_hand(h: f64, steps: usize, first: Option<char>) -> Vec<(f64, f64)> {
    let (a, b) = ((-h / 0.5_f64).exp(), (-h / 0.2_f64).exp());
    let follow = |x: f64, u: f64, decay: f64| u + (x - u) * decay;
    let mut points = vec![(0.0, 0.0)];
    for k in 0..steps {
        let (x, y) = points[k];
        points.push(match first {
            None => (follow(x, y, a), follow(y, 1.0 - x, b)),
            Some('a') => {
                let x = follow(x, y, a);
                (x, follow(y, 1.0 - x, b))
            }
            Some(_) => {
                let y = follow(y, 1.0 - x, b);
                (follow(x, y, a), y)
            }
        });
    }
    points
}

#[test]
fn gauss_seidel_and_jacobi_follow_their_recursions() {
    for fmi in ["2", "3"] {
        let Some(fmu) = probe(fmi) else { return };
        let algorithms = [
            (Algorithm::Jacobi, None),
            (Algorithm::GaussSeidel, Some('a')),
            (Algorithm::GaussSeidelIn(vec!["b".into(), "a".into()]), Some('b')),
        ];
        for (algorithm, first) in algorithms {
            let experiment = Experiment { algorithm, ..Experiment::new(0.0, 2.0, 0.01) };
            let outcome = ring(&fmu, experiment).run().unwrap();
            assert_eq!((outcome.end.clone(), outcome.recording.len()), (End::Stop, 201));
            let points = by_hand(0.01, 200, first);
            let found = signal(&outcome, "a.x").iter().zip(signal(&outcome, "b.x"));
            for ((x, y), (exact_x, exact_y)) in found.zip(points) {
                assert!((x - exact_x).abs() < ROUNDING && (y - exact_y).abs() < ROUNDING);
            }
        }
    }
}

#[test]
fn the_error_falls_in_first_order_with_the_step_size() {
    let Some(fmu) = probe("3") else { return };
    for algorithm in [Algorithm::GaussSeidel, Algorithm::Jacobi] {
        // The coupled equations, integrated here with a step that is far smaller.
        let (mut x, mut y, fine) = (0.0_f64, 0.0_f64, 1e-5);
        for _ in 0..100_000 {
            let rate = |x: f64, y: f64| ((y - x) / 0.5, (1.0 - x - y) / 0.2);
            let (p, q) = rate(x, y);
            let (r, s) = rate(x + 0.5 * fine * p, y + 0.5 * fine * q);
            (x, y) = (x + fine * r, y + fine * s);
        }
        let error = |h: f64| {
            let experiment =
                Experiment { algorithm: algorithm.clone(), ..Experiment::new(0.0, 1.0, h) };
            let outcome = ring(&fmu, experiment).run().unwrap();
            (signal(&outcome, "a.x").last().unwrap() - x).abs()
        };
        let ratio = error(0.01) / error(0.005);
        assert!((1.8..2.2).contains(&ratio), "{algorithm:?}: {ratio}");
    }
}

#[test]
fn foreign_fmus_are_coupled() {
    let paths = lags();
    if paths.len() < 2 {
        return;
    }
    for algorithm in [Algorithm::GaussSeidel, Algorithm::Jacobi] {
        let jacobi = algorithm == Algorithm::Jacobi;
        let mut system = System::new(Experiment { algorithm, ..Experiment::new(0.0, 1.0, 0.01) });
        for (name, path, time_constant) in [("a", &paths[0], 0.5), ("b", &paths[1], 0.2)] {
            system.add(name, lag(&Fmu::open(path).unwrap(), time_constant)).unwrap();
        }
        system.connect("b.y", "a.u").unwrap();
        system.connect_scaled("a.y", "b.u", Conversion { factor: -1.0, offset: 1.0 }).unwrap();
        system.record_all();
        let outcome = system.run().unwrap();
        let points = by_hand(0.01, 100, if jacobi { None } else { Some('a') });
        for (y, (exact, _)) in signal(&outcome, "a.y").iter().zip(points) {
            assert!((y - exact).abs() < ROUNDING, "{y} {exact}");
        }
        assert_eq!(signal(&outcome, "b.n").last(), Some(&100.0));
    }
}

#[test]
fn systems_run_in_parallel_with_equal_results() {
    let Some(fmu) = probe("2") else { return };
    let run =
        |k: usize| ring(&fmu, Experiment::new(0.0, 0.5, 0.001 * (k + 1) as f64)).run().unwrap();
    let serial: Vec<_> = (0..8).map(run).collect();
    let parallel: Vec<_> = (0..8).into_par_iter().map(run).collect();
    assert_eq!(serial, parallel);
}

#[test]
fn model_exchange_components_step_too() {
    let Some(fmu) = probe("3") else { return };
    let run = |kind| {
        let instance = fmu.instantiate(kind, &InstanceOptions::default()).unwrap();
        let mut system =
            System::new(Experiment { tolerance: Some(1e-10), ..Experiment::new(0.0, 1.0, 0.05) });
        system.add("a", FmuComponent::new(instance)).unwrap();
        system.add("b", lag(&fmu, 0.2)).unwrap();
        system.connect("b.x", "a.u").unwrap();
        system.record("a.x").unwrap();
        system.record("a.held").unwrap();
        system.run().unwrap()
    };
    let (cs, me) = (run(Interface::CoSimulation), run(Interface::ModelExchange));
    for name in ["a.x", "a.held"] {
        for (cs, me) in signal(&cs, name).iter().zip(signal(&me, name)) {
            assert!((cs - me).abs() < 1e-8, "{name}: {cs} {me}");
        }
    }
}

#[test]
fn units_are_converted_and_checked() {
    let Some(fmu) = probe("2") else { return };
    let mut system = System::new(Experiment::new(0.0, 1.0, 0.1));
    system.add("a", lag(&fmu, 0.5)).unwrap();
    system.add("b", lag(&fmu, 1e-3)).unwrap();
    // The speed in rpm becomes rad/s again; the fast lag follows it within a step.
    system.connect("a.x_rpm", "b.u").unwrap();
    system.record_all();
    let outcome = system.run().unwrap();
    let (a, b) = (signal(&outcome, "a.x"), signal(&outcome, "b.x"));
    assert!((a[10] - b[10]).abs() < ROUNDING && a[10] > 0.8);
    assert_eq!(outcome.recording.signal("a.x_rpm").unwrap().unit, "rpm");

    let mut system = System::new(Experiment::new(0.0, 1.0, 0.1));
    system.add("a", lag(&fmu, 0.5)).unwrap();
    system.add("b", lag(&fmu, 0.5)).unwrap();
    let error = system.connect("a.h", "b.u").unwrap_err().to_string();
    assert!(error.contains("`a.h` is in `m`, `b.u` in `rad/s`"), "{error}");
    assert!(matches!(system.connect("a.n", "b.u"), Err(Error::Kind { .. })));
    assert!(matches!(system.connect("a.x", "c.u"), Err(Error::NoComponent { .. })));
    let error = system.connect("a.xx", "b.u").unwrap_err().to_string();
    assert!(error.contains("did you mean `x`?"), "{error}");
    system.connect("a.x", "b.u").unwrap();
    assert!(matches!(system.connect("a.twice", "b.u"), Err(Error::TwoSources { .. })));
    assert!(matches!(system.record("b.u"), Err(Error::RecordInput { .. })));
    assert!(matches!(system.add("a", lag(&fmu, 1.0)), Err(Error::Twice { .. })));
}

#[test]
fn algebraic_loops_are_iterated_or_reported() {
    let Some(fmu) = probe("3") else { return };
    let run = |factor: f64| {
        let mut system = System::new(Experiment::new(0.0, 0.1, 0.1));
        for name in ["a", "b"] {
            system.add(name, lag(&fmu, 0.5)).unwrap();
        }
        // twice = 2 u: a loop w = (2 factor) (2 factor w + 1) through both.
        system.connect_scaled("a.twice", "b.u", Conversion { factor, offset: 0.0 }).unwrap();
        system.connect_scaled("b.twice", "a.u", Conversion { factor, offset: 1.0 }).unwrap();
        system.record_all();
        system.run()
    };
    let outcome = run(0.25).unwrap();
    assert_eq!(outcome.algebraic_loops, [["a.twice", "b.twice"]]);
    // u_a = 0.25 (2 (0.25 (2 u_a))) + 1 = u_a / 4 + 1
    assert!((signal(&outcome, "a.twice")[0] - 8.0 / 3.0).abs() < 1e-11);
    let error = run(0.6).unwrap_err();
    let Error::AlgebraicLoop { cycle, .. } = &error else { panic!("{error}") };
    assert_eq!(cycle, &["a.twice", "b.twice"]);
}

/// A participant in Rust: counts the steps in which its input exceeds a threshold.
#[derive(Default)]
struct Alarm {
    seen: Vec<f64>,
    alarms: usize,
}

impl Component for Alarm {
    fn ports(&self) -> Ports {
        Ports {
            inputs: vec![Port::float("speed")],
            outputs: vec![Port::float("alarms")],
            ..Ports::default()
        }
    }

    fn select(&mut self, _: &[usize], _: &[usize]) -> Result<(), Failure> {
        Ok(())
    }

    fn initialize(&mut self, phase: Phase, _: &[f64], outputs: &mut [f64]) -> Result<(), Failure> {
        if matches!(phase, Phase::Enter(_)) {
            *self = Alarm::default();
        }
        outputs.fill(self.alarms as f64);
        Ok(())
    }

    fn step(
        &mut self,
        time: f64,
        _: f64,
        inputs: &[f64],
        outputs: &mut [f64],
    ) -> Result<Progress, Failure> {
        if time > 0.95 {
            return Err(Failure::Participant("no more paper".into()));
        }
        self.seen.push(inputs[0]);
        self.alarms += usize::from(inputs[0] > 0.5);
        outputs.fill(self.alarms as f64);
        Ok(if self.alarms == 30 { Progress::Terminate } else { Progress::Continue })
    }
}

fn watched<'a>(fmu: &Fmu, alarm: &'a mut Alarm, stop: f64, step: f64) -> System<'a> {
    let mut system = System::new(Experiment::new(0.0, stop, step));
    // Added first; the connections put it last.
    system.add("alarm", alarm).unwrap();
    system.add("a", lag(fmu, 0.5)).unwrap();
    system.connect("a.x", "alarm.speed").unwrap();
    system.record_all();
    system
}

#[test]
fn a_participant_in_rust_sees_the_newest_outputs() {
    let Some(fmu) = probe("2") else { return };
    let mut alarm = Alarm::default();
    let outcome = watched(&fmu, &mut alarm, 0.9, 0.01).run().unwrap();
    assert_eq!(alarm.seen, signal(&outcome, "a.x")[1..]);
    let expected = signal(&outcome, "a.x")[1..].iter().filter(|x| **x > 0.5).count();
    assert_eq!((alarm.alarms, expected), (30.min(expected), alarm.alarms));
}

#[test]
fn a_component_can_end_the_run_or_fail() {
    let Some(fmu) = probe("2") else { return };
    let mut alarm = Alarm::default();
    // x exceeds 0.5 from 0.347 s on, so the thirtieth alarm comes at 0.376 s.
    let outcome = watched(&fmu, &mut alarm, 0.9, 0.001).run().unwrap();
    let End::Terminated { component, time } = &outcome.end else { panic!("{:?}", outcome.end) };
    assert_eq!((component.as_str(), outcome.recording.len()), ("alarm", 377));
    assert!((time - 0.376).abs() < 1e-12);
    let error = watched(&fmu, &mut alarm, 2.0, 0.1).run().unwrap_err().to_string();
    assert!(error.contains("component `alarm` failed at 1 s: no more paper"), "{error}");
}

#[test]
fn a_discarded_step_takes_all_back() {
    for fmi in ["2", "3"] {
        let Some(fmu) = probe(fmi) else { return };
        let mut first = lag(&fmu, 0.5);
        let mut bad = lag(&fmu, 0.5);
        bad.instance().set_value("fail", &Value::Number(2.0)).unwrap();
        let mut system =
            System::new(Experiment { rollback: true, ..Experiment::new(0.0, 2.0, 0.25) });
        system.add("first", &mut first).unwrap();
        system.add("bad", &mut bad).unwrap();
        system.record_all();
        let outcome = system.run().unwrap();
        drop(system);
        let End::Discarded { component, time, rolled_back, .. } = &outcome.end else { panic!() };
        assert_eq!((component.as_str(), *time, *rolled_back), ("bad", 1.0, true));
        assert_eq!(outcome.recording.len(), 5);
        assert_eq!(first.instance().time(), 1.0);
        let x = first.instance().value("x").unwrap();
        assert_eq!(x, Value::Number(signal(&outcome, "first.x")[4]));
    }
    let Some(fmu) = probe("2") else { return };
    let mut alarm = Alarm::default();
    let mut system = System::new(Experiment { rollback: true, ..Experiment::new(0.0, 2.0, 0.25) });
    system.add("a", lag(&fmu, 0.5)).unwrap();
    system.add("alarm", &mut alarm).unwrap();
    assert!(matches!(system.run(), Err(Error::NoRollback { component }) if component == "alarm"));
}

#[test]
fn recordings_drive_inputs_and_are_held() {
    let Some(fmu) = probe("3") else { return };
    let values = vec![30.0, 60.0, 90.0];
    let signals = vec![Signal { name: "speed".into(), unit: "rpm".into(), values }];
    let recording = Arc::new(Recording::new("r", 0.0, 0.1, signals));
    let mut system = System::new(Experiment::new(0.0, 0.4, 0.05));
    system.add("a", lag(&fmu, 1e-3)).unwrap();
    system.input(&recording, "speed", "a.u").unwrap();
    system.record("a.u").unwrap();
    system.record("a.x").unwrap();
    let outcome = system.run().unwrap();
    let rpm = std::f64::consts::PI / 30.0;
    let expected = [30.0, 30.0, 60.0, 60.0, 90.0, 90.0, 90.0, 90.0, 90.0].map(|n| n * rpm);
    for (k, (u, expected)) in signal(&outcome, "a.u").iter().zip(expected).enumerate() {
        assert!((u - expected).abs() < ROUNDING * expected, "{k}: {u} {expected}");
        if k > 0 {
            let x = signal(&outcome, "a.x")[k];
            assert!((x - signal(&outcome, "a.u")[k - 1]).abs() < ROUNDING * 10.0);
        }
    }
    let error = system.input(&recording, "torque", "a.u").unwrap_err().to_string();
    assert!(error.contains("has no signal `torque`; it has: speed"), "{error}");
}

#[test]
fn experiments_and_orders_are_checked() {
    let Some(fmu) = probe("2") else { return };
    for (start, stop, step) in [(0.0, 0.0, 0.1), (0.0, 1.0, 0.0), (0.0, f64::INFINITY, 0.1)] {
        let error = ring(&fmu, Experiment::new(start, stop, step)).run();
        assert!(matches!(error, Err(Error::Experiment { .. })));
    }
    for (order, problem) in
        [(vec!["a"], "missing"), (vec!["a", "a"], "named twice"), (vec!["c"], "unknown")]
    {
        let algorithm = Algorithm::GaussSeidelIn(order.into_iter().map(str::to_owned).collect());
        let error = ring(&fmu, Experiment { algorithm, ..Experiment::new(0.0, 1.0, 0.1) }).run();
        assert!(error.unwrap_err().to_string().contains(problem));
    }
}

/// Nothing vanishes in silence: what is no scalar number is named.
#[test]
fn ports_that_cannot_be_connected_are_named() {
    let output = |text: String| {
        let parameter = "causality=\"parameter\" variability=\"fixed\" start=\"1 2 3\"";
        assert!(text.contains(parameter));
        text.replace(parameter, "causality=\"output\"")
    };
    let Some(fmu) = crate::support::probe_with("3", output) else { return };
    let mut system = System::new(Experiment::new(0.0, 1.0, 0.1));
    system.add("a", lag(&fmu, 0.5)).unwrap();
    assert_eq!(system.left_out(), ["a.triple (an array of 3 elements)"]);
    let error = system.record("a.triple").unwrap_err().to_string();
    assert!(error.contains("`a.triple` is an array of 3 elements"), "{error}");
}
