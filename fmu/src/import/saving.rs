//! The FMU state: saved, restored, turned into bytes and back (FMI 2.0 section 2.1.8, FMI 3.0 section
//! 2.2.6). A Model Exchange instance's integrator is saved with it.

use std::sync::Arc;

use super::binding::Saved;
use super::bytes::{Reader, Writer};
use super::description::Capabilities;
use super::error::Error;
use super::instance::Instance;
use super::integrator::Integrator;
use super::mode::Mode;
use super::state::State;

impl Instance {
    /// Saves the state.
    ///
    /// # Errors
    /// The FMU has no FMU state, or fails.
    pub fn state(&mut self) -> Result<State, Error> {
        self.need(|c| c.state, "saving the FMU state")?;
        self.states.free_dropped(&mut self.handle);
        let (status, saved) = self.handle.save(None);
        self.check("GetFMUState", status)?;
        Ok(self.wrap(saved))
    }

    /// Saves the state into an earlier saved one, whose memory is used again.
    ///
    /// # Errors
    /// As [`state`](Instance::state), and if it was saved by another instance.
    pub fn save_into(&mut self, state: &mut State) -> Result<(), Error> {
        self.own(state)?;
        let (status, saved) = self.handle.save(Some(state.saved));
        if let Some(live) = self.states.live.iter_mut().find(|live| **live == state.saved) {
            *live = saved;
        }
        state.saved = saved;
        self.check("GetFMUState", status)?;
        (state.mode, state.time) = (self.mode, self.time);
        state.integrator.clone_from(&self.integrator);
        Ok(())
    }

    /// Goes back to a saved state, any number of times.
    ///
    /// # Errors
    /// The state was saved by another instance, or the FMU fails.
    pub fn restore(&mut self, state: &State) -> Result<(), Error> {
        self.own(state)?;
        let status = self.handle.restore(state.saved);
        self.check("SetFMUState", status)?;
        (self.mode, self.time) = (state.mode, state.time);
        self.integrator.clone_from(&state.integrator);
        Ok(())
    }

    /// Turns a saved state into bytes: those of the FMU, after what the importer adds to them (the
    /// time, and the integrator of a Model Exchange instance).
    ///
    /// # Errors
    /// The FMU cannot serialise, or the state was saved by another instance.
    pub fn serialize(&mut self, state: &State) -> Result<Vec<u8>, Error> {
        self.need(|c| c.serialize_state, "serialising the FMU state")?;
        self.own(state)?;
        let (status, bytes) = self.handle.serialize(state.saved);
        self.check("SerializeFMUState", status)?;
        let mut out = Writer::default();
        out.number(state.time);
        out.flag(state.mode == Mode::Initialization);
        out.flag(state.mode == Mode::Stepping);
        out.flag(state.integrator.is_some());
        if let Some(integrator) = &state.integrator {
            integrator.write(&mut out);
        }
        out.0.extend(bytes);
        Ok(out.0)
    }

    /// Makes a state from bytes that [`serialize`](Instance::serialize) gave, also those of another
    /// instance of this FMU.
    ///
    /// # Errors
    /// The FMU cannot serialise, or the bytes are not such.
    pub fn deserialize(&mut self, bytes: &[u8]) -> Result<State, Error> {
        self.need(|c| c.serialize_state, "deserialising the FMU state")?;
        self.states.free_dropped(&mut self.handle);
        let wrong = || Error::StateBytes { fmu: self.fmu.name().to_owned() };
        let mut bytes = Reader(bytes);
        let (time, mode, integrator) = read_own(&mut bytes).ok_or_else(wrong)?;
        let fits = match (&integrator, &self.integrator) {
            (Some(read), Some(own)) => read.fits(own),
            (None, None) => true,
            _ => false,
        };
        if !fits {
            return Err(wrong());
        }
        let (status, saved) = self.handle.deserialize(bytes.0);
        self.check("DeserializeFMUState", status)?;
        let mut state = self.wrap(saved);
        (state.time, state.mode, state.integrator) = (time, mode, integrator);
        Ok(state)
    }

    fn wrap(&mut self, saved: Saved) -> State {
        self.states.live.push(saved);
        State {
            saved,
            integrator: self.integrator.clone(),
            mode: self.mode,
            time: self.time,
            dropped: Arc::clone(&self.states.dropped),
        }
    }

    fn own(&self, state: &State) -> Result<(), Error> {
        self.callable("a function of the FMU state")?;
        if Arc::ptr_eq(&state.dropped, &self.states.dropped) {
            return Ok(());
        }
        Err(Error::ForeignState { fmu: self.fmu.name().to_owned() })
    }

    fn need(
        &self,
        has: impl Fn(&Capabilities) -> bool,
        capability: &'static str,
    ) -> Result<(), Error> {
        self.callable(capability)?;
        if self.fmu.description().capabilities(self.interface()).is_some_and(has) {
            return Ok(());
        }
        Err(Error::Capability { fmu: self.fmu.name().to_owned(), capability })
    }
}

/// What the importer adds to an FMU's bytes.
fn read_own(bytes: &mut Reader) -> Option<(f64, Mode, Option<Box<Integrator>>)> {
    let time = bytes.number()?;
    let mode = match (bytes.flag()?, bytes.flag()?) {
        (false, false) => Mode::Instantiated,
        (true, false) => Mode::Initialization,
        (false, true) => Mode::Stepping,
        (true, true) => return None,
    };
    let integrator = match bytes.flag()? {
        true => Some(Box::new(Integrator::read(bytes)?)),
        false => None,
    };
    Some((time, mode, integrator))
}
