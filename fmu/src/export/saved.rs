//! FMU states: saved, restored, freed, and as bytes
//! (FMI 2.0.4 section 2.1.8, FMI 3.0.2 section 2.2.10).
//!
//! An importer holds a key, not a pointer: a freed or foreign FMU state is refused instead of
//! read, and what an importer forgets to free goes with the instance.

use super::Model;
use super::instance::Instance;
use super::phase::{Phase, Run};
use super::refusal::{Refusal, same_length};
use super::snapshots::{SerializedError, Snapshot};
use crate::vocabulary::Interface;

/// First bytes of a serialised FMU state; the digit is its layout's version.
const MAGIC: &[u8; 8] = b"FMUSTAT1";
const PHASES: [Phase; 7] = [
    Phase::Instantiated,
    Phase::Initialization,
    Phase::Event,
    Phase::Continuous,
    Phase::Step,
    Phase::Terminated,
    Phase::Failed,
];

impl<M: Model> Instance<M> {
    /// Saves the present state under `key`, or under a new key where that is 0.
    pub fn save_state(&mut self, key: usize) -> Result<usize, Refusal> {
        let snapshot = Snapshot { model: self.model.clone(), run: self.run };
        self.store(key, snapshot)
    }

    /// Makes a saved state the present one.
    pub fn restore_state(&mut self, key: usize) -> Result<(), Refusal> {
        let snapshot = self.saved.states.get(&key).ok_or(Refusal::UnknownState(key))?;
        self.model = snapshot.model.clone();
        self.run = snapshot.run;
        Ok(())
    }

    /// Forgets a saved state; 0, the NULL state, is nothing to forget.
    pub fn free_state(&mut self, key: usize) -> Result<(), Refusal> {
        if key == 0 || self.saved.states.remove(&key).is_some() {
            return Ok(());
        }
        Err(Refusal::UnknownState(key))
    }

    /// A saved state as bytes: magic, interface, phase, experiment known, stop known, time, stop
    /// (little-endian doubles), token, model.
    pub fn serialize_state(&self, key: usize) -> Result<Vec<u8>, Refusal> {
        let Snapshot { model, run } =
            self.saved.states.get(&key).ok_or(Refusal::UnknownState(key))?;
        let phase = PHASES.iter().position(|phase| *phase == run.phase).unwrap_or(PHASES.len());
        let mut bytes = MAGIC.to_vec();
        bytes.extend([
            self.interface_byte(),
            phase as u8,
            u8::from(run.has_experiment),
            u8::from(run.stop.is_some()),
        ]);
        bytes.extend(run.time.to_le_bytes());
        bytes.extend(run.stop.unwrap_or(0.0).to_le_bytes());
        bytes.extend(self.table.token.as_bytes());
        bytes.extend(model.serialize());
        Ok(bytes)
    }

    /// [`Instance::serialize_state`] into a buffer of that size.
    pub fn serialize_into(&self, key: usize, buffer: &mut [u8]) -> Result<(), Refusal> {
        let bytes = self.serialize_state(key)?;
        same_length(buffer.len(), bytes.len())?;
        buffer.copy_from_slice(&bytes);
        Ok(())
    }

    /// The inverse, stored under `key` or, where that is 0, under a new key.
    pub fn deserialize_state(&mut self, bytes: &[u8], key: usize) -> Result<usize, Refusal> {
        let not_one = SerializedError::NotOne(bytes.len());
        let rest = bytes.strip_prefix(MAGIC).ok_or(not_one)?;
        let (flags, rest) = rest.split_first_chunk::<4>().ok_or(not_one)?;
        let (time, rest) = rest.split_first_chunk::<8>().ok_or(not_one)?;
        let (stop, rest) = rest.split_first_chunk::<8>().ok_or(not_one)?;
        let own = self.table.token.as_bytes();
        let content = rest.strip_prefix(own).ok_or(SerializedError::OtherModel)?;
        let [interface, phase, has_experiment, has_stop] = *flags;
        if interface != self.interface_byte() {
            return Err(SerializedError::OtherInterface.into());
        }
        let phase = *PHASES.get(usize::from(phase)).ok_or(not_one)?;
        let mut model = self.pristine.clone();
        model.deserialize(content).map_err(|error| Refusal::model("deserialize", &error))?;
        let run = Run {
            phase,
            time: f64::from_le_bytes(*time),
            stop: (has_stop != 0).then_some(f64::from_le_bytes(*stop)),
            has_experiment: has_experiment != 0,
        };
        self.store(key, Snapshot { model, run })
    }

    fn store(&mut self, key: usize, snapshot: Snapshot<M>) -> Result<usize, Refusal> {
        if key == 0 {
            self.saved.last_key += 1;
            self.saved.states.insert(self.saved.last_key, snapshot);
            return Ok(self.saved.last_key);
        }
        let old = self.saved.states.get_mut(&key).ok_or(Refusal::UnknownState(key))?;
        *old = snapshot;
        Ok(key)
    }

    fn interface_byte(&self) -> u8 {
        match self.interface {
            Interface::ModelExchange => 0,
            Interface::CoSimulation => 1,
        }
    }
}
