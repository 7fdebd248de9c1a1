//! The least model of a drive that follows its input: gain, lag and dead zone.
//!
//! y = c + sum over the inputs of k D(u), through a lag of the first order; D is the dead zone that
//! dry friction makes, D(u) = sgn(u) max(|u| - u_0, 0). Few parameters: what differs from day to day
//! cannot hide in them. Beyond a dead zone, constant and zone are one number on runs that never rest, so
//! a model has one of the two. What is slower than half a window is a drift for the windows, and no lag;
//! and a run begins with the mean of its first inputs, for a single one is mostly noise.

use drivescope_numerics::Regression;
use serde::{Deserialize, Serialize};

use crate::data::Data;
use crate::memory::{Memory, MemoryError, Walk};

/// Dead zones that are tried, as shares of the greatest input.
const ZONES: usize = 20;
const WIDEST: f64 = 0.8;
/// Lags that are tried, samples, by a constant ratio.
const LAGS: usize = 16;
const SHORTEST: f64 = 0.5;
/// By how much a constant must lower the error, as a share, to be preferred to a dead zone.
const WORTH: f64 = 0.02;

/// The model.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Lag {
    /// Share of the output that is left after a sample.
    #[serde(rename = "left")]
    pub pole: f64,
    /// c, output unit.
    pub constant: f64,
    /// k of each input, output unit an input unit.
    pub gains: Vec<f64>,
    /// u_0 of each input.
    pub zones: Vec<f64>,
}

fn beyond(u: f64, zone: f64) -> f64 {
    u.signum() * (u.abs() - zone).max(0.0)
}

/// Share of the way to its input that a lag goes with the sample of that number: at first that of a
/// mean.
fn share(pole: f64, sample: usize) -> f64 {
    (1.0 - pole).max(1.0 / (sample + 1) as f64)
}

/// A signal behind the lag; each segment begins in the steady state.
fn lagged(data: &Data, values: &[f64], zone: f64, pole: f64) -> Vec<f64> {
    let mut made = Vec::with_capacity(values.len());
    for segment in data.segments() {
        let mut y = 0.0;
        for (k, u) in values[segment.clone()].iter().enumerate() {
            y += share(pole, k) * (beyond(*u, zone) - y);
            made.push(y);
        }
    }
    made
}

impl Lag {
    /// The model of least squares over healthy data, its lag at most that many samples; nothing if
    /// they do not tell one.
    pub fn fit(data: &[&Data], longest: f64) -> Option<Self> {
        let inputs = data.first()?.inputs().len();
        let greatest = |k: usize| {
            let all = data.iter().flat_map(|data| data.inputs()[k].values);
            all.fold(0.0_f64, |top, u| top.max(u.abs()))
        };
        let greatest: Vec<f64> = (0..inputs).map(greatest).collect();
        let mut best: Option<(f64, Self)> = None;
        for zone in 0..ZONES {
            let share = WIDEST * zone as f64 / ZONES as f64;
            let zones: Vec<f64> = greatest.iter().map(|most| share * most).collect();
            for lag in 0..LAGS {
                let ratio = lag as f64 / (LAGS - 1) as f64;
                let pole = (-1.0 / (SHORTEST * (longest.max(1.0) / SHORTEST).powf(ratio))).exp();
                let Some((error, gains, constant)) = fitted(data, &zones, pole) else { continue };
                let error = if zone == 0 { (1.0 + WORTH) * error } else { error };
                if best.as_ref().is_none_or(|(least, _)| error < *least) {
                    best = Some((error, Self { pole, constant, gains, zones: zones.clone() }));
                }
            }
        }
        best.map(|(_, model)| model)
    }

    /// The residual over data, each segment from the steady state of its first input.
    pub fn residual(&self, data: &Data) -> Vec<f64> {
        let mut run = LagRun::new(self.clone());
        let mut u = vec![0.0; data.inputs().len()];
        let mut made = Vec::with_capacity(data.len());
        for segment in data.segments() {
            run.reset();
            for k in segment.clone() {
                u.iter_mut().zip(data.inputs()).for_each(|(u, column)| *u = column.values[k]);
                made.push(data.output().values[k] - run.step(&u));
            }
        }
        made
    }

    /// What inputs as large as the dead zones would drive without them, output unit.
    pub fn over_dead_zones(&self) -> f64 {
        self.gains.iter().zip(&self.zones).map(|(gain, zone)| (gain * zone).abs()).sum()
    }

    /// Whether those inputs leave a drive at rest.
    pub fn is_at_rest(&self, u: impl Iterator<Item = f64>) -> bool {
        let mut within = u.zip(&self.zones).map(|(u, zone)| *zone > 0.0 && u.abs() <= *zone);
        within.all(|within| within)
    }
}

/// Error, gains and constant of least squares with those dead zones and that lag.
fn fitted(data: &[&Data], zones: &[f64], pole: f64) -> Option<(f64, Vec<f64>, f64)> {
    let with_constant = zones.iter().all(|zone| *zone == 0.0);
    let mut regression = Regression::new(zones.len() + usize::from(with_constant));
    for data in data {
        let columns: Vec<Vec<f64>> = data
            .inputs()
            .iter()
            .zip(zones)
            .map(|(column, zone)| lagged(data, column.values, *zone, pole))
            .collect();
        for (k, y) in data.output().values.iter().enumerate() {
            let one = with_constant.then_some(1.0);
            regression.push(columns.iter().map(|column| column[k]).chain(one), *y);
        }
    }
    let solution = regression.solve().ok()?;
    let (gains, constant) = solution.parameters.split_at(zones.len());
    Some((solution.sse, gains.to_vec(), constant.first().copied().unwrap_or(0.0)))
}

/// The model, running.
#[derive(Debug, Clone)]
pub struct LagRun {
    model: Lag,
    y: f64,
    sample: usize,
}

impl LagRun {
    /// From the next input on, in its steady state.
    pub fn new(model: Lag) -> Self {
        Self { model, y: 0.0, sample: 0 }
    }

    /// What runs.
    pub fn model(&self) -> &Lag {
        &self.model
    }

    /// Begins anew.
    pub fn reset(&mut self) {
        (self.y, self.sample) = (0.0, 0);
    }

    /// The output under the inputs of the next sample.
    pub fn step(&mut self, u: &[f64]) -> f64 {
        let Lag { pole, constant, gains, zones } = &self.model;
        let terms = u.iter().zip(gains).zip(zones);
        let driven: f64 = terms.map(|((u, gain), zone)| gain * beyond(*u, *zone)).sum();
        self.y += share(*pole, self.sample) * (driven - self.y);
        self.sample += 1;
        self.y + constant
    }
}

impl Memory for LagRun {
    fn walk(&mut self, walk: &mut Walk) -> Result<(), MemoryError> {
        self.y.walk(walk)?;
        self.sample.walk(walk)
    }
}
