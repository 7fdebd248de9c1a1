//! A drive as a simulation unit: named variables, steps, and the continuous-time interface.
//!
//! It knows no simulator standard; an FMU wraps it, and a native run of it is the same code.
//! Rule of time: an input acts from the communication point (or event) at which it was set.
//! A controlled drive samples at t0 + k period with the inputs set before that instant; its
//! C_m, T and I_m hold from sample to sample. Without a controller T and I_m are read whenever
//! they are asked for.

mod exchange;
mod memory;
mod variables;

use std::sync::Arc;

use thiserror::Error;

use crate::drive::Drive;
use crate::effects::law::Outputs;
use crate::fault::{FaultLanes, Faults};
use crate::integrate::Integrator;
use crate::model::{CURRENT, POSITION, SPEED};
use crate::sampled::{InputLanes, Inputs, Sampled, Signals, speed_bound};

pub use exchange::Update;
pub use memory::MemoryError;
use variables::{InputSlot, OutputSlot, Slot};
pub use variables::{Role, Variable};

/// What cannot be done with a unit.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum UnitError {
    /// No variable has that reference.
    #[error("the drive has no variable number {reference}")]
    Reference {
        /// The reference.
        reference: usize,
    },
    /// The variable is calculated by the drive.
    #[error("`{name}` is calculated by the drive and cannot be set")]
    Calculated {
        /// The variable.
        name: String,
    },
    /// The value is not possible.
    #[error("`{name}` = {value} is not possible: {reason}")]
    Value {
        /// The variable.
        name: String,
        /// The value.
        value: f64,
        /// Why not.
        reason: String,
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
    /// Sampling time of the controller, if it is sampled.
    period: Option<f64>,
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
            period: drive.controller.filter(|_| controlled).and_then(|c| c.period),
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
        self.period
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

    /// The value of a variable at the present time; none for an unknown reference.
    pub fn get(&self, reference: usize) -> Option<f64> {
        let slot = self.variables.get(reference)?.slot;
        Some(match slot {
            Slot::Input(slot) => self.input(slot),
            Slot::Fault(number) => {
                let mut faults = self.faults;
                *faults.size_mut(number)?
            }
            Slot::Output(slot) => self.output(slot),
            Slot::State(number) => self.sampled.state().x[number][0],
            Slot::Derivative(number) => self.clone().derivatives()[number],
            Slot::Indicator(number) => self.clone().event_indicators()[number],
            Slot::Parameter(number) => self.drive.parameters().get(number)?.value,
        })
    }

    fn input(&self, slot: InputSlot) -> f64 {
        match slot {
            InputSlot::U => self.inputs.u,
            InputSlot::Reference => self.inputs.reference,
            InputSlot::Load => self.inputs.load,
            InputSlot::NoiseLoad => self.noise_load,
            InputSlot::GeneratorControl => self.inputs.c_g,
            InputSlot::NoiseReference => self.inputs.noise_reference,
            InputSlot::NoiseTacho => self.inputs.noise_t,
            InputSlot::NoiseCurrent => self.inputs.noise_i_m,
        }
    }

    fn output(&self, slot: OutputSlot) -> f64 {
        let shown = || -> Outputs<f64> {
            let mut sampled = self.sampled.clone();
            sampled.apply(&self.input_lanes(), &FaultLanes::splat(self.faults));
            sampled.outputs(self.time).lane(0)
        };
        // Without effects that sense, the sensors show the state itself.
        let state = &self.sampled.state().x;
        match slot {
            OutputSlot::Current if self.sampled.model().shows_state() => state[CURRENT][0],
            OutputSlot::Speed if self.sampled.model().shows_state() => state[SPEED][0],
            OutputSlot::Position if self.sampled.model().shows_state() => state[POSITION][0],
            OutputSlot::Current => shown().i,
            OutputSlot::Speed => shown().omega,
            OutputSlot::Position => shown().theta,
            OutputSlot::Control => self.signals().c_m,
            OutputSlot::Tacho => self.signals().t,
            OutputSlot::MeasuredCurrent => self.signals().i_m,
            OutputSlot::GeneratorCurrent => self.signals().i_g,
            OutputSlot::Voltage => self.signals().u,
            OutputSlot::Load => self.signals().load,
        }
    }

    /// The signals now: held since the last sample where controlled, else read now.
    fn signals(&self) -> Signals<f64> {
        if !self.inputs_changed && (self.controlled && self.period.is_some()) {
            return self.sampled.signals().lane(0);
        }
        let (inputs, faults) = (self.input_lanes(), FaultLanes::splat(self.faults));
        let mut sampled = self.sampled.clone();
        sampled.apply(&inputs, &faults);
        if self.controlled && self.period.is_some() {
            return sampled.signals().lane(0);
        }
        sampled.measured(self.time, &inputs, &faults).lane(0)
    }

    fn input_lanes(&self) -> InputLanes<f64, 1> {
        InputLanes::splat(Inputs { load: self.inputs.load + self.noise_load, ..self.inputs })
    }

    /// Sets an input, a parameter or, before a run, a state.
    ///
    /// # Errors
    /// An unknown reference, a calculated variable, a value that is not possible; the unit is
    /// then as before.
    pub fn set(&mut self, reference: usize, value: f64) -> Result<(), UnitError> {
        let variable = self.variables.get(reference).ok_or(UnitError::Reference { reference })?;
        let refused =
            |reason: String| UnitError::Value { name: variable.name.clone(), value, reason };
        if !value.is_finite() {
            return Err(refused("it is not finite".to_owned()));
        }
        let (low, high) = variable.range;
        if value < low || value > high {
            return Err(refused(format!("it must lie between {low} and {high}")));
        }
        match variable.slot {
            Slot::Input(slot) => {
                let place = match slot {
                    InputSlot::U => &mut self.inputs.u,
                    InputSlot::Reference => &mut self.inputs.reference,
                    InputSlot::Load => &mut self.inputs.load,
                    InputSlot::NoiseLoad => &mut self.noise_load,
                    InputSlot::GeneratorControl => &mut self.inputs.c_g,
                    InputSlot::NoiseReference => &mut self.inputs.noise_reference,
                    InputSlot::NoiseTacho => &mut self.inputs.noise_t,
                    InputSlot::NoiseCurrent => &mut self.inputs.noise_i_m,
                };
                self.inputs_changed |= *place != value;
                *place = value;
            }
            Slot::Fault(number) => {
                let place =
                    self.faults.size_mut(number).ok_or(UnitError::Reference { reference })?;
                self.inputs_changed |= *place != value;
                *place = value;
            }
            Slot::State(SPEED) => {
                let model = self.sampled.model().clone();
                self.sampled.state_mut().set_speed(&model, 0, value);
            }
            Slot::State(number) => self.sampled.state_mut().x[number] = [value],
            Slot::Parameter(_) => {
                let name = variable.name.clone();
                self.drive.set(&name, value).map_err(|error| UnitError::Value {
                    name,
                    value,
                    reason: error.to_string(),
                })?;
                self.parameters_changed = true;
            }
            Slot::Output(_) | Slot::Derivative(_) | Slot::Indicator(_) => {
                return Err(UnitError::Calculated { name: variable.name.clone() });
            }
        }
        Ok(())
    }

    /// Starts a run at that time: samples count from there.
    pub fn initialize(&mut self, start: f64) {
        self.start = start;
        self.time = start;
        self.next_sample = 0;
        self.inputs_changed = true;
        self.take_changes();
    }

    /// Co-simulation: from the present time by `h` > 0 seconds, the inputs held.
    ///
    /// # Errors
    /// [`UnitError::NotFinite`] if the state overflowed.
    #[inline]
    pub fn step(&mut self, h: f64) -> Result<(), UnitError> {
        self.take_changes();
        let from = self.time;
        let to = from + h;
        match self.period {
            Some(period) => {
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
            Err(UnitError::NotFinite { time: to })
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
mod tests {
    use super::*;
    use crate::drive::TachoUnit;

    fn dr300() -> Drive {
        let text = include_str!("../../../scenarios/drives/dr300.toml");
        Drive::parse(text, "dr300.toml").expect("the shipped drive is right")
    }

    fn set(unit: &mut Unit, name: &str, value: f64) {
        let reference = unit.reference(name).expect("the variable exists");
        unit.set(reference, value).expect("it can be set");
    }

    fn get(unit: &Unit, name: &str) -> f64 {
        unit.reference(name).and_then(|reference| unit.get(reference)).expect("it exists")
    }

    fn at_set_point(unit: &mut Unit) {
        set(unit, "reference", 2000.0 / TachoUnit::Rpm.per_si());
        unit.initialize(0.0);
        for _ in 0..1000 {
            unit.step(0.005).expect("it steps");
        }
    }

    #[test]
    fn the_loop_holds_its_set_point() {
        let mut unit = Unit::new(dr300(), false);
        at_set_point(&mut unit);
        assert!((get(&unit, "T") - 2000.0).abs() < 3.0, "{}", get(&unit, "T"));
        // Friction and drag: 0.016 + 6e-5 x 209 N m over 0.06 N m/A.
        assert!((get(&unit, "i") - 0.476).abs() < 0.01, "{}", get(&unit, "i"));
    }

    #[test]
    fn finer_communication_steps_give_the_same_samples() {
        let mut whole = Unit::new(dr300(), false);
        let mut parts = whole.clone();
        for unit in [&mut whole, &mut parts] {
            set(unit, "reference", 150.0);
            unit.initialize(0.0);
        }
        for _ in 0..400 {
            whole.step(0.005).expect("it steps");
        }
        for _ in 0..1000 {
            parts.step(0.002).expect("it steps");
        }
        let difference = get(&whole, "omega") - get(&parts, "omega");
        assert!(difference.abs() < 1e-6, "{difference}");
    }

    #[test]
    fn memory_replays_bit_for_bit_in_another_unit() {
        let mut unit = Unit::new(dr300(), false);
        at_set_point(&mut unit);
        set(&mut unit, "fault_flux", 0.1);
        set(&mut unit, "R", 3.3);
        unit.step(0.005).expect("it steps");
        let memory = unit.memory();
        let mut other = Unit::new(dr300(), false);
        other.restore(&memory).expect("it is the memory of this drive");
        for _ in 0..100 {
            unit.step(0.005).expect("it steps");
            other.step(0.005).expect("it steps");
        }
        assert_eq!(unit.memory(), other.memory());
        assert!(other.restore(&memory[1..]).is_err());
    }

    #[test]
    fn a_continuous_controller_holds_its_set_point_too() {
        let mut drive = dr300();
        if let Some(controller) = &mut drive.controller {
            controller.period = None;
        }
        let mut unit = Unit::new(drive, false);
        at_set_point(&mut unit);
        assert!((get(&unit, "T") - 2000.0).abs() < 3.0, "{}", get(&unit, "T"));
    }

    #[test]
    fn wrong_references_and_values_are_refused() {
        let mut unit = Unit::new(dr300(), true);
        let omega = unit.reference("omega").expect("it exists");
        assert!(matches!(unit.set(omega, 1.0), Err(UnitError::Calculated { .. })));
        assert!(matches!(unit.set(9999, 1.0), Err(UnitError::Reference { .. })));
        let r = unit.reference("R").expect("it exists");
        assert!(matches!(unit.set(r, -1.0), Err(UnitError::Value { .. })));
        assert!(matches!(unit.set(r, f64::NAN), Err(UnitError::Value { .. })));
    }
}
