//! Reading and setting the variables of a unit.

use super::variables::{InputSlot, OutputSlot, Slot};
use super::{Unit, UnitError};
use crate::effects::law::Outputs;
use crate::fault::FaultLanes;
use crate::model::{CURRENT, POSITION, SPEED};
use crate::sampled::Signals;

impl Unit {
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
        if !self.inputs_changed && (self.controlled && self.period().is_some()) {
            return self.sampled.signals().lane(0);
        }
        let (inputs, faults) = (self.input_lanes(), FaultLanes::splat(self.faults));
        let mut sampled = self.sampled.clone();
        sampled.apply(&inputs, &faults);
        if self.controlled && self.period().is_some() {
            return sampled.signals().lane(0);
        }
        sampled.measured(self.time, &inputs, &faults).lane(0)
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
                let before = self.period();
                self.drive.set(&name, value).map_err(|error| UnitError::Value {
                    name,
                    value,
                    reason: error.to_string(),
                })?;
                self.parameters_changed = true;
                if let Some(before) = before.filter(|_| self.period() != before) {
                    self.count_from_last_sample(before);
                }
            }
            Slot::Output(_) | Slot::Derivative(_) | Slot::Indicator(_) => {
                return Err(UnitError::Calculated { name: variable.name.clone() });
            }
        }
        Ok(())
    }

    /// The sampling time has changed during a run: the last sample stands, and the next one comes a
    /// new period after it.
    fn count_from_last_sample(&mut self, period_before: f64) {
        if let Some(last) = self.next_sample.checked_sub(1) {
            self.start += last as f64 * period_before;
            self.next_sample = 1;
        }
    }
}
