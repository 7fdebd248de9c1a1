//! One instance in a foreign library: the FMI functions of both versions behind methods that take
//! slices and return a [`Status`].

use std::ffi::{CStr, CString, c_char};
use std::ptr::{null, null_mut};
use std::sync::Arc;

use super::binary::Binary;
use super::binding::{Call, EventInfo, Foreign, Kept, LOG_LINE, Saved, bytes_of, text_of};
use super::description::Interface;
use super::functions::Functions;
use super::logging::Log;
use super::native::{Getter, Native, Setter};
use super::status::Status;

/// How an instance is to be made.
pub(super) struct Making<'a> {
    pub(super) kind: Interface,
    pub(super) name: &'a CStr,
    pub(super) token: &'a CStr,
    /// FMI 2.0: URI, FMI 3.0: path; an FMU without resources gets a null pointer.
    pub(super) resources: Option<&'a CStr>,
    pub(super) logging: bool,
}

/// One instance in the foreign library.
pub(super) struct Handle {
    instance: Foreign,
    binary: Arc<Binary>,
    /// What the FMU holds addresses of, until it is freed.
    kept: Option<Kept>,
}

/// Calls the FMI 2.0 or the FMI 3.0 function of one meaning and the same arguments.
macro_rules! either {
    ($self:expr, $two:ident | $three:ident $(, $argument:expr)*) => {
        match &$self.binary.functions {
            Functions::Two(f) => f.$two.status(($self.instance.0, $($argument,)*)),
            Functions::Three(f) => f.$three.status(($self.instance.0, $($argument,)*)),
        }
    };
}

impl Handle {
    /// Makes an instance; `None` if the FMU refuses.
    pub(super) fn instantiate(
        binary: Arc<Binary>,
        log: Arc<Log>,
        making: Making,
    ) -> Option<Handle> {
        let kept = Kept::new(log);
        let Making { kind, name, token, resources, logging } = making;
        let (name, token) = (name.as_ptr(), token.as_ptr());
        let resources = resources.map_or(null(), CStr::as_ptr);
        let to = kept.environment();
        // FMI 3.0 Co-Simulation: no event mode and no early return, which every FMU must be able to do
        // without, and no intermediate update.
        let instance = match (&binary.functions, kind) {
            (Functions::Two(f), kind) => {
                let kind = i32::from(kind == Interface::CoSimulation);
                let callbacks = kept.callbacks();
                let logging = i32::from(logging);
                f.instantiate.call((name, kind, token, resources, callbacks, 0, logging))
            }
            (Functions::Three(f), Interface::CoSimulation) => {
                let none = (false, false, null(), 0);
                let (event_mode, early_return, intermediate, count) = none;
                f.instantiate_cs.call((
                    name,
                    token,
                    resources,
                    false,
                    logging,
                    event_mode,
                    early_return,
                    intermediate,
                    count,
                    to,
                    LOG_LINE,
                    null(),
                ))
            }
            (Functions::Three(f), Interface::ModelExchange) => {
                f.instantiate_me.call((name, token, resources, false, logging, to, LOG_LINE))
            }
        };
        let instance = instance.filter(|pointer| !pointer.is_null()).map(Foreign)?;
        Some(Handle { instance, binary, kept: Some(kept) })
    }

    pub(super) fn enter_initialization(
        &mut self,
        tolerance: Option<f64>,
        start: f64,
        stop: Option<f64>,
    ) -> Status {
        let (given, tolerance) = (tolerance.is_some(), tolerance.unwrap_or(0.0));
        let (ends, stop) = (stop.is_some(), stop.unwrap_or(0.0));
        match &self.binary.functions {
            Functions::Two(f) => {
                let (given, ends) = (i32::from(given), i32::from(ends));
                let status = f.setup.status((self.instance.0, given, tolerance, start, ends, stop));
                if status.is_good() {
                    f.enter_initialization.status((self.instance.0,))
                } else {
                    status
                }
            }
            Functions::Three(f) => f.enter_initialization.status((
                self.instance.0,
                given,
                tolerance,
                start,
                ends,
                stop,
            )),
        }
    }

    pub(super) fn exit_initialization(&mut self) -> Status {
        either!(self, exit_initialization | exit_initialization)
    }

    pub(super) fn terminate(&mut self) -> Status {
        either!(self, terminate | terminate)
    }

    pub(super) fn reset(&mut self) -> Status {
        either!(self, reset | reset)
    }

    pub(super) fn get<T: Native>(&mut self, references: &[u32], values: &mut [T]) -> Status {
        let (n, count) = (references.len(), values.len());
        match T::getter(&self.binary.functions) {
            Getter::Two(_) if n != count => Status::Missing,
            Getter::Two(f) => {
                f.status((self.instance.0, references.as_ptr(), n, values.as_mut_ptr()))
            }
            Getter::Three(f) => {
                f.status((self.instance.0, references.as_ptr(), n, values.as_mut_ptr(), count))
            }
        }
    }

    pub(super) fn set<T: Native>(&mut self, references: &[u32], values: &[T]) -> Status {
        let (n, count) = (references.len(), values.len());
        match T::setter(&self.binary.functions) {
            Setter::Two(_) if n != count => Status::Missing,
            Setter::Two(f) => f.status((self.instance.0, references.as_ptr(), n, values.as_ptr())),
            Setter::Three(f) => {
                f.status((self.instance.0, references.as_ptr(), n, values.as_ptr(), count))
            }
        }
    }

    /// The texts of one variable; the FMU's memory is copied at once, as it may be reused.
    pub(super) fn get_strings(&mut self, reference: u32, count: usize) -> (Status, Vec<String>) {
        let mut texts: Vec<*const c_char> = vec![null(); count];
        let to = texts.as_mut_ptr();
        let status = match &self.binary.functions {
            Functions::Two(_) if count != 1 => Status::Missing,
            Functions::Two(f) => {
                f.get_string.status((self.instance.0, &raw const reference, 1, to))
            }
            Functions::Three(f) => {
                f.get_string.status((self.instance.0, &raw const reference, 1, to, count))
            }
        };
        let texts = if status.is_good() { texts } else { Vec::new() };
        (status, texts.into_iter().map(text_of).collect())
    }

    /// The bytes of one variable (FMI 3.0), copied at once too.
    pub(super) fn get_binaries(&mut self, reference: u32, count: usize) -> (Status, Vec<Vec<u8>>) {
        let (mut sizes, mut bytes) = (vec![0; count], vec![null(); count]);
        let status = match &self.binary.functions {
            Functions::Two(_) => Status::Missing,
            Functions::Three(f) => f.get_binary.status((
                self.instance.0,
                &raw const reference,
                1,
                sizes.as_mut_ptr(),
                bytes.as_mut_ptr(),
                count,
            )),
        };
        let sizes = if status.is_good() { sizes } else { Vec::new() };
        let copied = bytes.into_iter().zip(sizes).map(|(bytes, size)| bytes_of(bytes, size));
        (status, copied.collect())
    }

    pub(super) fn set_string(&mut self, reference: u32, text: &CString) -> Status {
        let text = text.as_ptr();
        match &self.binary.functions {
            Functions::Two(f) => {
                f.set_string.status((self.instance.0, &raw const reference, 1, &raw const text))
            }
            Functions::Three(f) => {
                f.set_string.status((self.instance.0, &raw const reference, 1, &raw const text, 1))
            }
        }
    }

    /// One communication step; whether the FMU asks to end the simulation, and the time it reached.
    pub(super) fn do_step(
        &mut self,
        time: f64,
        step: f64,
        may_go_back: bool,
    ) -> (Status, bool, f64) {
        let mut reached = time + step;
        match &self.binary.functions {
            Functions::Two(f) => {
                let status =
                    f.do_step.status((self.instance.0, time, step, i32::from(!may_go_back)));
                let mut ends = 0;
                if status == Status::Discard {
                    // `fmi2LastSuccessfulTime` and `fmi2Terminated`; older FMUs lack them.
                    f.get_real_status.status((self.instance.0, 2, &raw mut reached));
                    f.get_boolean_status.status((self.instance.0, 3, &raw mut ends));
                }
                (status, ends != 0, reached)
            }
            Functions::Three(f) => {
                let (mut event, mut ends, mut early) = (false, false, false);
                let status = f.do_step.status((
                    self.instance.0,
                    time,
                    step,
                    !may_go_back,
                    &raw mut event,
                    &raw mut ends,
                    &raw mut early,
                    &raw mut reached,
                ));
                (status, ends, reached)
            }
        }
    }

    /// Saves the FMU state, into the memory of an earlier one if given.
    pub(super) fn save(&mut self, into: Option<Saved>) -> (Status, Saved) {
        let mut state = into.map_or(null_mut(), |saved| saved.pointer());
        (either!(self, get_state | get_state, &raw mut state), Saved::new(state))
    }

    pub(super) fn restore(&mut self, saved: Saved) -> Status {
        either!(self, set_state | set_state, saved.pointer())
    }

    pub(super) fn free_saved(&mut self, saved: Saved) -> Status {
        let mut state = saved.pointer();
        either!(self, free_state | free_state, &raw mut state)
    }

    pub(super) fn serialize(&mut self, saved: Saved) -> (Status, Vec<u8>) {
        let mut size = 0;
        let status = either!(self, state_size | state_size, saved.pointer(), &raw mut size);
        if !status.is_good() {
            return (status, Vec::new());
        }
        let mut bytes = vec![0; size];
        (either!(self, serialize | serialize, saved.pointer(), bytes.as_mut_ptr(), size), bytes)
    }

    pub(super) fn deserialize(&mut self, bytes: &[u8]) -> (Status, Saved) {
        let mut state = null_mut();
        let status =
            either!(self, deserialize | deserialize, bytes.as_ptr(), bytes.len(), &raw mut state);
        (status, Saved::new(state))
    }

    pub(super) fn directional_derivative(
        &mut self,
        unknowns: &[u32],
        knowns: &[u32],
        seed: &[f64],
        out: &mut [f64],
    ) -> Status {
        if seed.len() != knowns.len() || out.len() != unknowns.len() {
            return Status::Missing;
        }
        let (u, k) = (unknowns.as_ptr(), knowns.as_ptr());
        let (nu, nk) = (unknowns.len(), knowns.len());
        let (seed, out) = (seed.as_ptr(), out.as_mut_ptr());
        match &self.binary.functions {
            Functions::Two(f) => f.directional.status((self.instance.0, u, nu, k, nk, seed, out)),
            Functions::Three(f) => {
                f.directional.status((self.instance.0, u, nu, k, nk, seed, nk, out, nu))
            }
        }
    }

    pub(super) fn enter_event_mode(&mut self) -> Status {
        either!(self, enter_event_mode | enter_event_mode)
    }

    pub(super) fn enter_continuous_time_mode(&mut self) -> Status {
        either!(self, enter_continuous_time_mode | enter_continuous_time_mode)
    }

    pub(super) fn update_discrete_states(&mut self) -> (Status, EventInfo) {
        let mut info = EventInfo::default();
        let status = match &self.binary.functions {
            Functions::Two(f) => f.new_discrete_states.status((self.instance.0, &raw mut info)),
            Functions::Three(f) => {
                let mut flags = [false; 5];
                let [a, b, c, d, e] = &mut flags;
                let status = f.update_discrete_states.status((
                    self.instance.0,
                    a,
                    b,
                    c,
                    d,
                    e,
                    &raw mut info.next_time,
                ));
                let [again, terminate, nominals_changed, states_changed, next_time_defined] =
                    flags.map(i32::from);
                info = EventInfo {
                    again,
                    terminate,
                    nominals_changed,
                    states_changed,
                    next_time_defined,
                    ..info
                };
                status
            }
        };
        (status, info)
    }

    /// Announces an accepted integrator step: whether event mode is needed, whether to end.
    pub(super) fn completed_integrator_step(&mut self) -> (Status, bool, bool) {
        match &self.binary.functions {
            Functions::Two(f) => {
                let (mut event, mut ends) = (0, 0);
                let status =
                    f.completed_step.status((self.instance.0, 1, &raw mut event, &raw mut ends));
                (status, event != 0, ends != 0)
            }
            Functions::Three(f) => {
                let (mut event, mut ends) = (false, false);
                let status =
                    f.completed_step.status((self.instance.0, true, &raw mut event, &raw mut ends));
                (status, event, ends)
            }
        }
    }

    pub(super) fn set_time(&mut self, time: f64) -> Status {
        either!(self, set_time | set_time, time)
    }

    pub(super) fn set_continuous_states(&mut self, x: &[f64]) -> Status {
        either!(self, set_continuous_states | set_continuous_states, x.as_ptr(), x.len())
    }

    pub(super) fn continuous_states(&mut self, x: &mut [f64]) -> Status {
        either!(self, get_continuous_states | get_continuous_states, x.as_mut_ptr(), x.len())
    }

    pub(super) fn derivatives(&mut self, dx: &mut [f64]) -> Status {
        either!(self, get_derivatives | get_derivatives, dx.as_mut_ptr(), dx.len())
    }

    pub(super) fn event_indicators(&mut self, z: &mut [f64]) -> Status {
        either!(self, get_event_indicators | get_event_indicators, z.as_mut_ptr(), z.len())
    }

    pub(super) fn nominals(&mut self, x: &mut [f64]) -> Status {
        either!(self, get_nominals | get_nominals, x.as_mut_ptr(), x.len())
    }

    /// Numbers of continuous states and event indicators (FMI 3.0; the description of a 2.0 FMU has them).
    pub(super) fn sizes(&mut self) -> Option<(usize, usize)> {
        let Functions::Three(f) = &self.binary.functions else { return None };
        let (mut states, mut indicators) = (0, 0);
        let good = f.number_of_states.status((self.instance.0, &raw mut states)).is_good()
            && f.number_of_event_indicators
                .status((self.instance.0, &raw mut indicators))
                .is_good();
        good.then_some((states, indicators))
    }

    /// Gives the instance up: after `Fatal` no function of the FMU may be called, not even the one that
    /// frees it (FMI 2.0 section 2.1.3, FMI 3.0 section 2.2.2). Its memory and library stay.
    pub(super) fn abandon(&mut self) {
        if let Some(kept) = self.kept.take() {
            std::mem::forget((kept, Arc::clone(&self.binary)));
        }
    }

    pub(super) fn is_abandoned(&self) -> bool {
        self.kept.is_none()
    }
}

impl Drop for Handle {
    fn drop(&mut self) {
        if !self.is_abandoned() {
            match &self.binary.functions {
                Functions::Two(f) => f.free_instance.call((self.instance.0,)),
                Functions::Three(f) => f.free_instance.call((self.instance.0,)),
            };
        }
    }
}
