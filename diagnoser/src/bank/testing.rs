//! A process of the first order that tests run the bank on: x' = a x + b (1 + g) (1 + s_0) u,
//! y = (1 + s_1) x + s_2, with a learned gain g of the machine.

use rand::SeedableRng;
use rand_distr::{Distribution, StandardNormal};
use rand_pcg::Pcg64Mcg;

use super::process::{Advanced, Belief, MECHANISMS, Mechanism, Process, Row, SENSORS, Sensed};
use super::watch::{Limits, Watch};
use crate::memory::{Memory, MemoryError, Walk};

const A: f64 = 0.9;
const B: f64 = 0.5;
pub(super) const NOISE: f64 = 0.05;
const DISTURBANCE: f64 = 0.02;
const TOLERANCE: f64 = 0.1;

/// Numbers of the mechanisms.
pub(super) const ACTUATOR: usize = 0;
pub(super) const GAIN: usize = 1;
pub(super) const BIAS: usize = 2;

/// Limits for some thousands of samples without an alarm.
pub(super) const LIMITS: Limits = Limits { ratio: 16.0, squares: 16.0 };
pub(super) const HORIZON: usize = 80;

#[derive(Debug, Clone)]
pub(super) struct Tank {
    mechanisms: Vec<Mechanism>,
    learned: Vec<String>,
    gain: f64,
    faults: [f64; 3],
}

impl Tank {
    pub(super) fn new() -> Self {
        let mechanism = |id: &str| Mechanism {
            id: id.to_owned(),
            unit: "1".to_owned(),
            most: 0.9,
            least: -0.9,
            rarer: 0.0,
        };
        Self {
            mechanisms: ["actuator", "gain", "bias"].map(mechanism).into(),
            learned: vec!["gain of the machine".to_owned()],
            gain: 0.0,
            faults: [0.0; 3],
        }
    }

    pub(super) fn gain(&self) -> f64 {
        self.gain
    }
}

impl Process<2> for Tank {
    fn mechanisms(&self) -> &[Mechanism] {
        &self.mechanisms
    }

    fn quanta(&self) -> [f64; SENSORS] {
        [0.0; SENSORS]
    }

    fn learned(&self) -> &[String] {
        &self.learned
    }

    fn begin(&self, row: &Row) -> Belief<2> {
        let covariance = [[100.0 * NOISE * NOISE, 0.0], [0.0, TOLERANCE * TOLERANCE]];
        Belief { mean: [row.shown[0], 0.0], covariance }
    }

    fn sense(&mut self, x: &[f64; 2], _row: &Row) -> Sensed<2> {
        let gain = 1.0 + self.faults[GAIN];
        let mut sensed = Sensed {
            shown: [gain * x[0] + self.faults[BIAS], 0.0, 0.0],
            rows: [[0.0; 2]; SENSORS],
            variance: [NOISE * NOISE, 0.0, 0.0],
            columns: [[0.0; MECHANISMS]; SENSORS],
        };
        sensed.rows[0][0] = gain;
        (sensed.columns[0][GAIN], sensed.columns[0][BIAS]) = (x[0], 1.0);
        sensed
    }

    fn advance(&mut self, belief: &Belief<2>, row: &Row) -> Advanced<2> {
        let [x, offset] = belief.mean;
        let input = B * row.control * (1.0 + self.gain);
        let acting = input * (1.0 + self.faults[ACTUATOR]);
        let mut advanced = Advanced {
            next: [A * x + acting + acting * offset, offset],
            transition: [[A, acting], [0.0, 1.0]],
            added: [[DISTURBANCE * DISTURBANCE, 0.0], [0.0, 1e-10]],
            columns: [[0.0; MECHANISMS]; 2],
        };
        advanced.columns[0][ACTUATOR] = input;
        advanced
    }

    fn set_fault(&mut self, mechanism: usize, size: f64) {
        self.faults = [0.0; 3];
        self.faults[mechanism] = size;
    }

    fn walk_machine(&mut self, walk: &mut Walk) -> Result<(), MemoryError> {
        self.gain.walk(walk)
    }

    fn settle(&mut self, belief: &mut Belief<2>) {
        self.gain = (1.0 + self.gain) * (1.0 + std::mem::take(&mut belief.mean[1])) - 1.0;
    }
}

/// A machine whose gain is 6 % off, under a varying input.
pub(super) struct Machine {
    random: Pcg64Mcg,
    x: f64,
    sample: usize,
    /// Sizes of the faults.
    pub(super) faults: [f64; 3],
    /// The sensor repeats what it showed last.
    pub(super) frozen: bool,
    /// Factor on the noise of the sensor.
    pub(super) noise: f64,
    last: f64,
}

pub(super) const OFF: f64 = 0.06;

impl Machine {
    pub(super) fn new(seed: u64) -> Self {
        let random = Pcg64Mcg::seed_from_u64(seed);
        Self { random, x: 5.0, sample: 0, faults: [0.0; 3], frozen: false, noise: 1.0, last: 0.0 }
    }

    fn normal(&mut self) -> f64 {
        StandardNormal.sample(&mut self.random)
    }

    pub(super) fn row(&mut self) -> Row {
        let [actuator, gain, bias] = self.faults;
        let shown = (1.0 + gain) * self.x + bias + self.noise * NOISE * self.normal();
        self.last = if self.frozen { self.last } else { shown };
        let control = 1.0 + 0.3 * (self.sample as f64 / 7.0).sin();
        self.sample += 1;
        self.x =
            A * self.x + B * (1.0 + OFF) * (1.0 + actuator) * control + DISTURBANCE * self.normal();
        Row { control, shown: [self.last, f64::NAN, f64::NAN] }
    }

    pub(super) fn rows(&mut self, count: usize) -> Vec<Row> {
        (0..count).map(|_| self.row()).collect()
    }

    /// A watch that has learned this machine.
    pub(super) fn watch(&mut self) -> Watch<2, Tank> {
        let rows = self.rows(1000);
        super::learn(Tank::new(), &rows, LIMITS, HORIZON).expect("it is healthy")
    }
}
