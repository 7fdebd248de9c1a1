//! Everything that a run of a unit depends on, as numbers that another process can read.

use thiserror::Error;

use super::Unit;
use crate::fault::MECHANISMS;
use crate::sampled::{Inputs, SignalLanes, Signals};

/// Why numbers are not the memory of this unit.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum MemoryError {
    /// Another number of numbers.
    #[error("the saved state holds {found} numbers, this drive needs {expected}")]
    Length {
        /// How many there are.
        found: usize,
        /// How many there should be.
        expected: usize,
    },
    /// A number that cannot be.
    #[error("the saved state holds {value} at place {place}")]
    Value {
        /// Which number.
        place: usize,
        value: f64,
    },
}

impl Unit {
    /// All that a run depends on, in a fixed order.
    pub fn memory(&self) -> Vec<f64> {
        let mut numbers = vec![self.start, self.time, self.next_sample as f64, self.noise_load];
        let Inputs { reference, u, load, c_g, noise_reference, noise_t, noise_i_m } = self.inputs;
        numbers.extend([reference, u, load, c_g, noise_reference, noise_t, noise_i_m]);
        let Signals { c_m, t, i_m, u, i_g, load } = self.sampled.signals().lane(0);
        numbers.extend([c_m, t, i_m, u, i_g, load, self.sampled.integrals()[0]]);
        let mut faults = self.faults;
        numbers.extend((0..MECHANISMS.len()).filter_map(|k| faults.size_mut(k).copied()));
        numbers.push(self.sampled.state().sign[0]);
        numbers.extend(self.continuous_states());
        numbers.extend(self.drive.parameters().iter().map(|parameter| parameter.value));
        if let Some(line) = self.sampled.delay() {
            numbers.extend(line.history().flat_map(|(time, [u])| [time, u]));
        }
        numbers
    }

    /// Puts back what [`Unit::memory`] gave.
    ///
    /// # Errors
    /// Numbers that are not the memory of a unit of this drive; the unit is then as before.
    pub fn restore(&mut self, numbers: &[f64]) -> Result<(), MemoryError> {
        // What a delay remembers comes last, and may be any number of pairs.
        let remembered = self.sampled.delay().map_or(0, |line| 2 * line.history().count());
        let expected = self.memory().len() - remembered;
        let pairs = numbers.len().checked_sub(expected);
        let right =
            |more: usize| more == 0 || (self.sampled.delay().is_some() && more.is_multiple_of(2));
        if !pairs.is_some_and(right) {
            return Err(MemoryError::Length { found: numbers.len(), expected });
        }
        if let Some(place) = numbers.iter().position(|value| value.is_nan()) {
            return Err(MemoryError::Value { place, value: numbers[place] });
        }
        let mut restored = self.clone();
        let mut rest = numbers.iter().copied();
        let mut next = || rest.next().unwrap_or_default();
        restored.start = next();
        restored.time = next();
        restored.next_sample = next() as u64;
        restored.noise_load = next();
        restored.inputs = Inputs {
            reference: next(),
            u: next(),
            load: next(),
            c_g: next(),
            noise_reference: next(),
            noise_t: next(),
            noise_i_m: next(),
        };
        let signals =
            Signals { c_m: next(), t: next(), i_m: next(), u: next(), i_g: next(), load: next() };
        let integral = next();
        for number in 0..MECHANISMS.len() {
            if let Some(size) = restored.faults.size_mut(number) {
                *size = next();
            }
        }
        let sign = next();
        let states: Vec<f64> = (0..self.state_count()).map(|_| next()).collect();
        let names: Vec<_> =
            self.drive.parameters().into_iter().map(|p| (p.name, p.value)).collect();
        let parameters_at = expected - names.len();
        for (k, (name, present)) in names.iter().enumerate() {
            let value = next();
            if value != *present {
                let place = parameters_at + k;
                let refused = |_| MemoryError::Value { place, value };
                restored.drive.set(name, value).map_err(refused)?;
                restored.parameters_changed = true;
            }
        }
        restored.set_continuous_states(&states);
        restored.sampled.state_mut().sign = [sign];
        restored.sampled.restore([integral], SignalLanes::splat(signals));
        restored.inputs_changed = true;
        restored.take_changes();
        if let Some(line) = restored.sampled.delay_mut() {
            let pairs = numbers[expected..].chunks_exact(2);
            line.restore(pairs.map(|pair| (pair[0], [pair[1]])));
        }
        *self = restored;
        Ok(())
    }
}
