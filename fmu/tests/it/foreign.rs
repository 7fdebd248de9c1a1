//! FMUs that other tools made: `pythonfmu` (FMI 2.0) and `pythonfmu3` (FMI 3.0). Their binaries expect
//! a Python process as host; the importer has to give them one.

use std::path::PathBuf;
use std::sync::OnceLock;

use drivescope_fmu::import::{Fmu, Instance, InstanceOptions, Value};
use rayon::prelude::*;

use crate::support::python_fmu;

/// A lag `T dy/dt = u - y`, stepped exactly, with variables of all types.
const LAG_2: &str = r#"
import math
from pythonfmu import Fmi2Slave, Fmi2Causality, Fmi2Variability, Real, Integer, Boolean, String
class LagTwo(Fmi2Slave):
    def __init__(self, **kwargs):
        super().__init__(**kwargs)
        self.u = 0.0; self.y = 0.0; self.T = 2.0; self.n = 0; self.on = True; self.label = "a"
        self.register_variable(Real("u", causality=Fmi2Causality.input))
        self.register_variable(Real("T", causality=Fmi2Causality.parameter, variability=Fmi2Variability.tunable))
        self.register_variable(String("label", causality=Fmi2Causality.parameter, variability=Fmi2Variability.fixed))
        self.register_variable(Boolean("on", causality=Fmi2Causality.input))
        self.register_variable(Integer("n", causality=Fmi2Causality.output))
        self.register_variable(Real("y", causality=Fmi2Causality.output))
    def do_step(self, t, h):
        if self.label == "bad":
            raise ValueError("no such label")
        a = math.exp(-h / self.T)
        self.y = a * self.y + (1 - a) * self.u
        self.n += 1
        return True
"#;

const LAG_3: &str = r#"
import math
from pythonfmu3 import Fmi3Slave, Fmi3Causality, Fmi3Variability, Float64, Int32, Boolean, String
class LagThree(Fmi3Slave):
    def __init__(self, **kwargs):
        super().__init__(**kwargs)
        self.time = 0.0
        self.u = 0.0; self.y = 0.0; self.T = 2.0; self.n = 0; self.on = True; self.label = "a"
        self.register_variable(Float64("time", causality=Fmi3Causality.independent, variability=Fmi3Variability.continuous))
        self.register_variable(Float64("u", causality=Fmi3Causality.input, variability=Fmi3Variability.continuous))
        self.register_variable(Float64("T", causality=Fmi3Causality.parameter, variability=Fmi3Variability.tunable))
        self.register_variable(String("label", causality=Fmi3Causality.parameter, variability=Fmi3Variability.fixed))
        self.register_variable(Boolean("on", causality=Fmi3Causality.input, variability=Fmi3Variability.discrete))
        self.register_variable(Int32("n", causality=Fmi3Causality.output, variability=Fmi3Variability.discrete))
        self.register_variable(Float64("y", causality=Fmi3Causality.output, variability=Fmi3Variability.continuous))
    def do_step(self, t, h):
        if self.label == "bad":
            raise ValueError("no such label")
        a = math.exp(-h / self.T)
        self.y = a * self.y + (1 - a) * self.u
        self.n += 1
        return True
"#;

/// Van der Pol's oscillator for Model Exchange; the reference is integrated here by Runge-Kutta.
const VAN_DER_POL: &str = r#"
from pythonfmu3 import Fmi3Causality, Fmi3Initial, Fmi3SlaveBase, Fmi3Variability, Float64, ModelExchange
class Vdp(Fmi3SlaveBase, ModelExchange):
    def __init__(self, **kwargs):
        super().__init__(**kwargs)
        self.time = 0.0; self.mu = 1.0; self.x0 = 2.0; self.x1 = 0.0; self.derx0 = 0.0; self.derx1 = 0.0
        c = Fmi3Variability.continuous
        self.register_variable(Float64("time", causality=Fmi3Causality.independent, variability=c))
        self.register_variable(Float64("x0", causality=Fmi3Causality.output, start=2, variability=c, initial=Fmi3Initial.exact))
        self.register_variable(Float64("x1", causality=Fmi3Causality.output, start=0, variability=c, initial=Fmi3Initial.exact))
        self.register_variable(Float64("derx0", causality=Fmi3Causality.local, variability=c, derivative=1))
        self.register_variable(Float64("derx1", causality=Fmi3Causality.local, variability=c, derivative=2))
        self.register_variable(Float64("mu", causality=Fmi3Causality.parameter, variability=Fmi3Variability.fixed))
    def get_continuous_state_derivatives(self):
        self.derx0 = self.x1
        self.derx1 = self.mu * ((1 - self.x0**2) * self.x1) - self.x0
        return [self.derx0, self.derx1]
"#;

/// The lags for both versions; each is built once for all tests. Their names differ because the
/// embedded Python keeps modules by name.
pub(crate) fn lags() -> Vec<PathBuf> {
    static LAGS: OnceLock<Vec<PathBuf>> = OnceLock::new();
    let build = || {
        let two = python_fmu("pythonfmu", "LagTwo", LAG_2);
        let three = python_fmu("pythonfmu3", "LagThree", LAG_3);
        two.into_iter().chain(three).collect()
    };
    LAGS.get_or_init(build).clone()
}

/// Python and Rust call the same `exp`; a few operations may be rounded in another order.
const ROUNDING: f64 = 1e-14;

fn run(p: &mut Instance, period: f64, steps: u32) -> Vec<f64> {
    p.set_value("T", &Value::Number(period)).unwrap();
    p.initialize(0.0, None, None).unwrap();
    let (u, y) =
        (p.fmu().variable("u").unwrap().reference, p.fmu().variable("y").unwrap().reference);
    (0..steps)
        .map(|k| {
            p.set(&[u], &[1.0]).unwrap();
            p.step(f64::from(k) * 0.1, 0.1).unwrap();
            let mut value = [0.0];
            p.get(&[y], &mut value).unwrap();
            value[0]
        })
        .collect()
}

#[test]
fn python_fmus_are_loaded_stepped_reset_and_freed() {
    for path in lags() {
        for _ in 0..2 {
            let fmu = Fmu::open(&path).unwrap();
            let mut p = fmu.co_simulation(&InstanceOptions::named("lag")).unwrap();
            p.set_value("label", &Value::Text("hello".into())).unwrap();
            p.set_value("on", &Value::Number(0.0)).unwrap();
            let first = run(&mut p, 2.0, 20);
            for (k, y) in first.iter().enumerate() {
                let exact = 1.0 - (-(k as f64 + 1.0) * 0.1 / 2.0).exp();
                assert!((y - exact).abs() < ROUNDING, "{y} {exact}");
            }
            assert_eq!(p.value("n").unwrap(), Value::Number(20.0));
            assert_eq!(p.value("label").unwrap(), Value::Text("hello".into()));
            assert_eq!(p.value("on").unwrap(), Value::Number(0.0));
            p.reset().unwrap();
            p.set_value("u", &Value::Number(0.0)).unwrap();
            p.initialize(0.0, None, None).unwrap();
            p.step(0.0, 0.1).unwrap();
            p.terminate().unwrap();
        }
    }
}

#[test]
fn python_fmus_run_in_many_threads() {
    for path in lags() {
        let fmu = Fmu::open(path).unwrap();
        let run = |k: u32| {
            let mut p = fmu.co_simulation(&InstanceOptions::named(&format!("lag {k}"))).unwrap();
            run(&mut p, 1.0 + f64::from(k), 30)
        };
        let serial: Vec<_> = (0..8).map(run).collect();
        let parallel: Vec<_> = (0..8).into_par_iter().map(run).collect();
        assert_eq!(serial, parallel);
        assert_ne!(serial[0], serial[1]);
    }
}

#[test]
fn a_python_exception_is_an_error_with_its_text() {
    for path in lags() {
        let fmu = Fmu::open(path).unwrap();
        // `pythonfmu` logs nothing, not even errors, unless it is told to log.
        let options = InstanceOptions { name: "lag".to_owned(), logging: true };
        let mut p = fmu.co_simulation(&options).unwrap();
        p.set_value("label", &Value::Text("bad".into())).unwrap();
        p.initialize(0.0, None, None).unwrap();
        let error = p.step(0.0, 0.1).unwrap_err().to_string();
        assert!(error.contains("DoStep of `lag` returned"), "{error}");
        assert!(error.contains("no such label"), "{error}");
    }
}

#[test]
fn a_python_model_exchange_fmu_is_integrated() {
    let Some(path) = python_fmu("pythonfmu3", "Vdp", VAN_DER_POL) else { return };
    let fmu = Fmu::open(path).unwrap();
    let mut p = fmu.model_exchange(&InstanceOptions::default()).unwrap();
    p.initialize(0.0, Some(2.0), Some(1e-9)).unwrap();
    for k in 0..20 {
        p.step(f64::from(k) * 0.1, 0.1).unwrap();
    }
    let group = p.group(&["x0", "x1"]).unwrap();
    let mut x = [0.0; 2];
    p.read(&group, &mut x).unwrap();
    let exact = runge_kutta([2.0, 0.0], 2.0, 20_000);
    for (x, exact) in x.iter().zip(exact) {
        assert!((x - exact).abs() < 1e-7, "{x} {exact}");
    }
}

fn runge_kutta(mut x: [f64; 2], time: f64, steps: u32) -> [f64; 2] {
    let h = time / f64::from(steps);
    let rate = |x: [f64; 2]| [x[1], (1.0 - x[0] * x[0]) * x[1] - x[0]];
    let along = |x: [f64; 2], k: [f64; 2], h: f64| [x[0] + h * k[0], x[1] + h * k[1]];
    for _ in 0..steps {
        let a = rate(x);
        let b = rate(along(x, a, 0.5 * h));
        let c = rate(along(x, b, 0.5 * h));
        let d = rate(along(x, c, h));
        for i in 0..2 {
            x[i] += h / 6.0 * (a[i] + 2.0 * b[i] + 2.0 * c[i] + d[i]);
        }
    }
    x
}
