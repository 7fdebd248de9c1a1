//! One scenario of a plan: what is drawn for it.

use drivescope_plant::fault::MECHANISMS;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

use super::{FaultPlan, Plan};
use crate::profile::Profile;

/// Odd constant (2^64 over the golden ratio) that spreads neighbouring seeds and scenarios.
const SPREAD: u64 = 0x9E37_79B9_7F4A_7C15;
/// A time that lies that share of a sample beside one is meant to be it: 0.3 / 0.1 is below 3.
const ROUNDING: f64 = 1e-6;

/// Streams of one scenario that do not meet.
#[derive(Debug, Clone, Copy)]
enum Purpose {
    /// What the plan draws.
    Plan,
    /// Whether its signals are kept.
    Trace,
    /// Noise of a scenario.
    Noise,
    /// Noise of a number that scenarios share.
    SharedNoise,
    /// Faults that come and go.
    Intermittent,
}

/// The seed of a stream.
fn stream(seed: u64, purpose: Purpose, number: u64) -> u64 {
    let tag = (purpose as u64 + 1).wrapping_mul(0xD1B5_4A32_D192_ED03);
    let mixed = seed.wrapping_mul(SPREAD).rotate_left(29) ^ tag;
    // The finaliser of splitmix64: neighbouring numbers share no bits.
    let mut z = mixed.wrapping_add(number.wrapping_mul(SPREAD));
    z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
    z ^ (z >> 31)
}

/// The seed of what comes and goes in that fault of a scenario.
pub(in crate::campaign) fn stream_of_fault(seed: u64, scenario: u64, number: usize) -> u64 {
    stream(stream(seed, Purpose::Intermittent, scenario), Purpose::Plan, number as u64)
}

/// The seed of a scenario's noise.
pub(in crate::campaign) fn stream_of_noise(seed: u64, scenario: &Scenario) -> u64 {
    match scenario.noise_seed {
        Some(number) => stream(seed, Purpose::SharedNoise, number),
        None => stream(seed, Purpose::Noise, scenario.index),
    }
}

/// Where between 0 and 1 a scenario lies when a share of them is chosen.
pub(super) fn share_of(seed: u64, scenario: u64) -> f64 {
    // 53 bits are a number of its own.
    (stream(seed, Purpose::Trace, scenario) >> 11) as f64 / (1u64 << 53) as f64
}

/// A scenario.
#[derive(Debug, Clone, PartialEq)]
pub struct Scenario {
    /// Its number.
    pub index: u64,
    /// Speed that the controller follows, rad/s (m/s).
    pub set_point: f64,
    /// Number of the noise, where the plan gives one.
    pub noise_seed: Option<u64>,
    /// Values of the parameters that the plan changes, SI.
    pub parameters: Vec<f64>,
    /// Each fault of the plan; nothing where it does not act.
    pub faults: Vec<Option<ScenarioFault>>,
    /// Settings of the detectors.
    pub settings: Settings,
}

/// A fault of a scenario.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ScenarioFault {
    /// Number among [`MECHANISMS`].
    pub mechanism: usize,
    /// In the unit of the mechanism.
    pub size: f64,
    /// First faulty sample.
    pub from: usize,
    /// First sample after it.
    pub until: usize,
    /// How it goes between them.
    pub profile: Profile,
}

impl ScenarioFault {
    /// What fails.
    pub fn kind(&self) -> &'static str {
        MECHANISMS[self.mechanism].id
    }
}

/// Settings of the detectors.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Settings {
    /// Share of healthy samples outside constant thresholds and bands.
    pub beta: f64,
    /// Exceedances in a row that declare a fault.
    pub window: u64,
    /// Mean samples between false alarms that the CUSUM is designed for.
    pub arl_0: f64,
    /// Drift of the CUSUM, in standard deviations of the innovations.
    pub kappa: f64,
}

impl Scenario {
    /// First and last sample at which any fault may act: the begin of the first, the end of the last.
    pub fn faulty(&self) -> Option<(usize, usize)> {
        let acting = || self.faults.iter().flatten();
        Some((acting().map(|it| it.from).min()?, acting().map(|it| it.until).max()?))
    }
}

/// The coordinates of a point of the grid, one after the other.
struct Point(u64);

impl Point {
    fn along(&mut self, points: u64) -> u64 {
        let at = self.0 % points;
        self.0 /= points;
        at
    }
}

impl Plan {
    /// Set points that detectors are designed at: the one there is, those of the grid, or some that
    /// are drawn.
    pub(in crate::campaign) fn design_set_points(&self, most: u64) -> Vec<f64> {
        let any = (f64::NEG_INFINITY, f64::INFINITY);
        let points = self.set_point.points();
        let count = if self.set_point.is_fixed() { 1 } else { most };
        let seed = stream(self.design_seed, Purpose::Plan, u64::MAX);
        let mut random = Pcg64Mcg::seed_from_u64(seed);
        (0..count)
            .map(|k| self.set_point.value(k * points / count % points, &mut random, any))
            .collect()
    }

    /// The scenario of that number.
    pub fn scenario(&self, index: u64) -> Scenario {
        let any = (f64::NEG_INFINITY, f64::INFINITY);
        let mut random = Pcg64Mcg::seed_from_u64(stream(self.seed, Purpose::Plan, index));
        let mut point = Point(index % self.points);
        let mut value = |quantity: &super::Quantity, range: (f64, f64)| {
            quantity.value(point.along(quantity.points()), &mut random, range)
        };
        let set_point = value(&self.set_point, any);
        let noise_seed = self.noise_seed.as_ref().map(|it| value(it, any).round() as u64);
        let parameters = self.parameters.iter().map(|(parameter, quantity)| {
            let own = if quantity.relative { parameter.value } else { 1.0 };
            let (low, high) = parameter.range;
            own * value(quantity, if own > 0.0 { (low / own, high / own) } else { any })
        });
        let parameters = parameters.collect();
        let faults =
            self.faults.iter().map(|fault| self.fault(fault, &mut point, &mut random)).collect();
        let mut value = |quantity: &super::Quantity| {
            quantity.value(point.along(quantity.points()), &mut random, any)
        };
        let settings = Settings {
            beta: value(&self.detector.beta),
            window: value(&self.detector.window).round() as u64,
            arl_0: value(&self.detector.arl_0),
            kappa: value(&self.detector.kappa),
        };
        Scenario { index, set_point, noise_seed, parameters, faults, settings }
    }

    fn fault(
        &self,
        plan: &FaultPlan,
        point: &mut Point,
        random: &mut Pcg64Mcg,
    ) -> Option<ScenarioFault> {
        let any = (f64::NEG_INFINITY, f64::INFINITY);
        let kind = *plan.kind.value(point.along(plan.kind.points()), random);
        let mut value = |quantity: &super::Quantity| {
            quantity.value(point.along(quantity.points()), random, any)
        };
        let size = value(&plan.size);
        let onset_s = value(&plan.onset_s);
        let duration_s = plan.duration_s.as_ref().map(&mut value);
        let profile = *plan.profile.value(point.along(plan.profile.points()), random);
        let acts = random.random::<f64>() < plan.probability;
        let sample = |time: f64| (time / self.experiment.period_s - ROUNDING).ceil() as usize;
        let from = sample(onset_s);
        let until = duration_s.map_or(self.samples, |it| sample(onset_s + it).min(self.samples));
        let mechanism = kind.filter(|_| acts)?;
        Some(ScenarioFault { mechanism, size, from, until, profile })
    }
}
