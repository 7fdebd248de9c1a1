//! A drive as a simulation unit: named variables, steps, and the continuous-time interface.
//!
//! It knows no simulator standard; an FMU wraps it, and a native run of it is the same code.
//! Rule of time: an input acts from the communication point (or event) at which it was set.
//! A controlled drive samples at t0 + k period with the inputs set before that instant; its
//! C_m, T and I_m hold from sample to sample. Without a controller T and I_m are read whenever
//! they are asked for.

mod access;
mod exchange;
mod memory;
mod variables;

use std::sync::Arc;

use thiserror::Error;

use crate::drive::Drive;
use crate::fault::{FaultLanes, Faults};
use crate::integrate::{Integrator, MOST_SUBSTEPS};
use crate::sampled::{InputLanes, Inputs, Sampled, speed_bound};

pub use exchange::Update;
pub use memory::MemoryError;
use variables::Slot;
pub use variables::{Role, Variable};

/// What cannot be done with a unit.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum UnitError {
    /// No variable has that reference.
    #[error("the drive has no variable number {reference}")]
    Reference { reference: usize },
    /// The variable is calculated by the drive.
    #[error("`{name}` is calculated by the drive and cannot be set")]
    Calculated { name: String },
    /// The value is not possible.
    #[error("`{name}` = {value} is not possible: {reason}")]
    Value {
        name: String,
        value: f64,
        /// Why not.
        reason: String,
    },
    /// A step that would take too much work.
    #[error(
        "a step of {step} s needs {needed:.3e} {what}, more than the {most} that one step may \
         take: {advice}"
    )]
    Work {
        /// Length of the step, s.
        step: f64,
        /// How many it needs.
        needed: f64,
        /// What they are.
        what: &'static str,
        /// How many it may take.
        most: usize,
        /// What to do.
        advice: &'static str,
    },
    /// The state is no longer finite.
    #[error(
        "the state of the drive is not finite at {time} s: a parameter or input is out of range"
    )]
    NotFinite {
        /// When, s.
        time: f64,
    },
}

/// Share of the period (or of the step) within which two instants are the same.
const SAME_INSTANT: f64 = 1e-6;
/// Samples of the controller within one communication step: some seconds of work.
const MOST_SAMPLES: usize = 10_000_000;

/// One drive with its sampled layer.
#[derive(Debug, Clone)]
pub struct Unit {
    drive: Drive,
    variables: Arc<[Variable]>,
    sampled: Sampled<1, Integrator<f64>>,
    inputs: Inputs<f64>,
    noise_load: f64,
    faults: Faults<f64>,
    start: f64,
    time: f64,
    /// Number of the next sample.
    next_sample: u64,
    controlled: bool,
    inputs_changed: bool,
    parameters_changed: bool,
    states: Vec<f64>,
    derivatives: Vec<f64>,
    indicators: Vec<f64>,
}

impl Unit {
    /// The drive at rest at time 0; `open_loop` makes u an input even if it has a controller.
    pub fn new(drive: Drive, open_loop: bool) -> Self {
        let controlled = drive.controller.is_some() && !open_loop;
        let integrator = Integrator::new(drive.model(), speed_bound(&drive));
        let sampled = Sampled::new(&drive, integrator, controlled);
        let states = vec![0.0; sampled.model().states()];
        Self {
            variables: variables::list(&drive, controlled, sampled.model().directed()).into(),
            derivatives: states.clone(),
            indicators: vec![1.0; 2 * usize::from(sampled.model().directed())],
            states,
            sampled,
            drive,
            inputs: Inputs::NONE,
            noise_load: 0.0,
            faults: Faults::NONE,
            start: 0.0,
            time: 0.0,
            next_sample: 0,
            controlled,
            inputs_changed: true,
            parameters_changed: false,
        }
    }

    /// Every variable; a reference is a place in this list.
    pub fn variables(&self) -> &[Variable] {
        &self.variables
    }

    /// The reference of the variable of that name.
    pub fn reference(&self, name: &str) -> Option<usize> {
        self.variables.iter().position(|variable| variable.name == name)
    }

    /// The drive with its present parameters.
    pub fn drive(&self) -> &Drive {
        &self.drive
    }

    /// Whether the drive's controller closes the loop.
    pub fn controlled(&self) -> bool {
        self.controlled
    }

    /// Sampling time of the controller, s, if it is sampled.
    pub fn period(&self) -> Option<f64> {
        self.drive.controller.filter(|_| self.controlled)?.period
    }

    /// References of the event indicators, in their order; none without dry friction.
    pub fn indicator_references(&self) -> Vec<usize> {
        let indicator = |slot| matches!(slot, Slot::Indicator(_));
        (0..self.variables.len()).filter(|k| indicator(self.variables[*k].slot)).collect()
    }

    /// Present time, s.
    pub fn time(&self) -> f64 {
        self.time
    }

    /// Starts a run at that time: samples count from there.
    pub fn initialize(&mut self, start: f64) {
        self.start = start;
        self.time = start;
        self.next_sample = 0;
        self.inputs_changed = true;
        if let Some(line) = self.sampled.delay_mut() {
            line.restore([]);
        }
        self.take_changes();
    }

    /// Co-simulation: from the present time by `h` > 0 seconds, the inputs held.
    ///
    /// # Errors
    /// [`UnitError::Work`] if a step of that length takes too many samples or sub-steps (the unit is
    /// then as before, or its state is not a number), [`UnitError::NotFinite`] if the state overflowed.
    #[inline]
    pub fn step(&mut self, h: f64) -> Result<(), UnitError> {
        self.take_changes();
        let from = self.time;
        let to = from + h;
        match self.period() {
            Some(period) => {
                let samples = h / period;
                if samples > MOST_SAMPLES as f64 {
                    return Err(self.too_many_samples(h, samples));
                }
                while let Some(until) = self.sample_if_due(period, to) {
                    let length = until - self.time;
                    // A whole period or a whole step keeps its own length, free of rounding.
                    let same = |whole: f64| (length - whole).abs() <= SAME_INSTANT * whole;
                    let length = match () {
                        () if same(period) => period,
                        () if same(h) => h,
                        () => length,
                    };
                    self.sampled.advance(self.time, length);
                    self.time = until;
                }
            }
            None => self.sampled.advance(from, h),
        }
        self.time = to;
        if self.sampled.state().x.iter().all(|value| value[0].is_finite()) {
            Ok(())
        } else {
            Err(self.not_finite(h))
        }
    }

    #[cold]
    fn too_many_samples(&self, h: f64, needed: f64) -> UnitError {
        UnitError::Work {
            step: h,
            needed,
            what: "samples of the controller",
            most: MOST_SAMPLES,
            advice: "shorten the step, or give the controller a longer period",
        }
    }

    /// Why the state is not a number at the end of a step of `h` seconds.
    #[cold]
    fn not_finite(&self, h: f64) -> UnitError {
        let longest = self.period().map_or(h, |period| period.min(h));
        match self.sampled.stepper().out_of_budget(longest) {
            Some(needed) => UnitError::Work {
                step: longest,
                needed,
                what: "sub-steps",
                most: MOST_SUBSTEPS,
                advice: "a rate of the drive is too fast for it: shorten the step, or check its \
                         stiffnesses, R and L",
            },
            None => UnitError::NotFinite { time: self.time },
        }
    }

    /// Takes the sample that is due, and tells how far the drive moves on from here; nothing
    /// once `to` is reached.
    fn sample_if_due(&mut self, period: f64, to: f64) -> Option<f64> {
        let near = SAME_INSTANT * period;
        if to - self.time <= near {
            return None;
        }
        if self.time >= self.sample_time(period) - near {
            self.sample();
        }
        let next = self.sample_time(period);
        Some(if next < to - near { next } else { to })
    }

    fn sample_time(&self, period: f64) -> f64 {
        self.start + self.next_sample as f64 * period
    }

    fn sample(&mut self) {
        let (inputs, faults) = (self.input_lanes(), FaultLanes::splat(self.faults));
        self.sampled.sample(self.time, &inputs, &faults);
        self.next_sample += 1;
    }

    fn input_lanes(&self) -> InputLanes<f64, 1> {
        InputLanes::splat(Inputs { load: self.inputs.load + self.noise_load, ..self.inputs })
    }

    /// Lets changed parameters and inputs act.
    #[inline]
    fn take_changes(&mut self) {
        if self.parameters_changed {
            let integrator = Integrator::new(self.drive.model(), speed_bound(&self.drive));
            self.sampled = self.sampled.with_parameters(&self.drive, integrator);
            self.parameters_changed = false;
            self.inputs_changed = true;
        }
        if self.inputs_changed {
            self.sampled.apply(&self.input_lanes(), &FaultLanes::splat(self.faults));
            self.inputs_changed = false;
        }
    }
}

#[cfg(test)]
mod tests;
