//! The boundary to foreign code: loads an FMU's binary and calls its C functions (FMI 2.0 section 2.1,
//! FMI 3.0 section 2.2). This is the one file of the import side that may be `unsafe`; everything in
//! it is reached through safe methods that take slices and return a [`Status`].
//!
//! What safety rests on: the functions have the types that the standard gives them (nobody can check
//! that), lengths come from slices, returned statuses are plain numbers, an instance is called by one
//! thread at a time (`&mut self`), and library, callbacks and environment outlive the instance.
#![allow(unsafe_code)]

use std::ffi::{CStr, CString, c_char, c_void};
use std::path::Path;
use std::ptr::{null, null_mut};
use std::sync::Arc;

use libloading::Library;

use super::binary::Binary;
use super::description::Kind;
use super::functions::Functions;
use super::logging::{Log, Message};
use super::native::{Getter, Native, Setter};
use super::status::Status;

pub(super) type Pointer = *mut c_void;

/// Loads a binary with all its symbols resolved: a lazily bound one would abort the process at the
/// first call of a function that is not there.
pub(super) fn load(path: &Path, global: bool) -> Result<Library, libloading::Error> {
    #[cfg(unix)]
    {
        use libloading::os::unix::{Library as Unix, RTLD_GLOBAL, RTLD_LOCAL, RTLD_NOW};
        let scope = if global { RTLD_GLOBAL } else { RTLD_LOCAL };
        // SAFETY: running the initialisers of a foreign library is what importing an FMU means.
        unsafe { Unix::open(Some(path), RTLD_NOW | scope) }.map(Library::from)
    }
    #[cfg(windows)]
    {
        use libloading::os::windows::{LOAD_WITH_ALTERED_SEARCH_PATH, Library as Windows};
        let _ = global;
        // SAFETY: as above. The flag makes Windows look for dependencies beside the binary.
        unsafe { Windows::load_with_flags(path, LOAD_WITH_ALTERED_SEARCH_PATH) }.map(Library::from)
    }
}

/// The address of a function as the type that the standard gives it, if the binary has it.
pub(super) fn symbol<F: Copy>(library: &Library, name: &CStr) -> Option<F> {
    // SAFETY: `functions` pairs each name with its type from the standard.
    unsafe { library.get::<F>(name.to_bytes_with_nul()) }.ok().map(|symbol| *symbol)
}

/// `fmi2CallbackFunctions`. FMUs keep its address, so it lives as long as the instance.
#[repr(C)]
pub(super) struct Callbacks {
    logger: unsafe extern "C" fn(
        *const Environment,
        *const c_char,
        i32,
        *const c_char,
        *const c_char,
        ...
    ),
    allocate: unsafe extern "C" fn(usize, usize) -> Pointer,
    free: unsafe extern "C" fn(Pointer),
    step_finished: *const c_void,
    environment: *const Environment,
}

/// What the FMU hands back with each message. `c/fmi2_log.c` knows its first field.
#[repr(C)]
pub(super) struct Environment {
    line: extern "C" fn(*const Environment, i32, *const c_char, *const c_char),
    log: Arc<Log>,
}

// The C side reads the first field of the environment only and hands its address back.
#[allow(improper_ctypes)]
unsafe extern "C" {
    fn drivescope_fmi2_log(
        _: *const Environment,
        _: *const c_char,
        _: i32,
        _: *const c_char,
        _: *const c_char,
        ...
    );
    fn calloc(count: usize, size: usize) -> Pointer;
    fn free(memory: Pointer);
}

/// The FMI 3.0 logger, and the second half of the FMI 2.0 one.
extern "C" fn log_line(
    to: *const Environment,
    status: i32,
    category: *const c_char,
    text: *const c_char,
) {
    let string = |pointer: *const c_char| match pointer.is_null() {
        true => String::new(),
        // SAFETY: the standard says that it is a terminated string.
        false => unsafe { CStr::from_ptr(pointer) }.to_string_lossy().trim_end().to_owned(),
    };
    // SAFETY: `to` is null or the environment that `instantiate` gave to the FMU.
    if let Some(environment) = unsafe { to.as_ref() } {
        let status = Status::from_c(status);
        environment.log.push(Message { status, category: string(category), text: string(text) });
    }
}

/// How an instance is to be made.
pub(super) struct Making<'a> {
    pub(super) kind: Kind,
    pub(super) name: &'a CStr,
    pub(super) token: &'a CStr,
    /// FMI 2.0: URI, FMI 3.0: path; an FMU without resources gets a null pointer.
    pub(super) resources: Option<&'a CStr>,
    pub(super) logging: bool,
}

/// One instance in the foreign library.
pub(super) struct Handle {
    instance: Pointer,
    binary: Arc<Binary>,
    // The FMU holds the addresses of both until it is freed.
    _callbacks: Box<Callbacks>,
    _environment: Box<Environment>,
}

// SAFETY: FMI lets any thread call an instance as long as calls do not overlap (FMI 2.0 section 2.1.4,
// FMI 3.0 section 2.2.1), and every call that is not a plain read takes `&mut self`.
unsafe impl Send for Handle {}

/// One saved FMU state, valid for the instance that made it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Saved(Pointer);

// SAFETY: only the instance that made it dereferences it, under `&mut`.
unsafe impl Send for Saved {}

/// What `fmi2NewDiscreteStates` and `fmi3UpdateDiscreteStates` say. The layout is `fmi2EventInfo`'s.
#[repr(C)]
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct EventInfo {
    pub(super) again: i32,
    pub(super) terminate: i32,
    pub(super) nominals_changed: i32,
    pub(super) states_changed: i32,
    pub(super) next_time_defined: i32,
    pub(super) next_time: f64,
}

/// Calls a function of the table; `Missing` if the binary has none.
macro_rules! call {
    ($function:expr, $($argument:expr),* $(,)?) => {
        match $function {
            // SAFETY: see the head of this file.
            Some(function) => Status::from_c(unsafe { function($($argument),*) }),
            None => Status::Missing,
        }
    };
}

/// Calls the FMI 2.0 or the FMI 3.0 function of one meaning and the same arguments.
macro_rules! either {
    ($self:expr, $two:ident | $three:ident $(, $argument:expr)*) => {
        match &$self.binary.functions {
            Functions::Two(f) => call!(f.$two, $self.instance $(, $argument)*),
            Functions::Three(f) => call!(f.$three, $self.instance $(, $argument)*),
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
        let environment = Box::new(Environment { line: log_line, log });
        let callbacks = Box::new(Callbacks {
            logger: drivescope_fmi2_log,
            allocate: calloc,
            free,
            step_finished: null(),
            environment: &*environment,
        });
        let Making { kind, name, token, resources, logging } = making;
        let (name, token) = (name.as_ptr(), token.as_ptr());
        let resources = resources.map_or(null(), CStr::as_ptr);
        let to: *const Environment = &*environment;
        // SAFETY: see the head of this file. FMI 3.0: no event mode and no early return in
        // Co-Simulation, which every FMU must be able to do without, and no intermediate update.
        let instance = unsafe {
            match (&binary.functions, kind) {
                (Functions::Two(f), _) => {
                    let kind = i32::from(kind == Kind::CoSimulation);
                    (f.instantiate?)(
                        name,
                        kind,
                        token,
                        resources,
                        &*callbacks,
                        0,
                        i32::from(logging),
                    )
                }
                (Functions::Three(f), Kind::CoSimulation) => (f.instantiate_cs?)(
                    name,
                    token,
                    resources,
                    false,
                    logging,
                    false,
                    false,
                    null(),
                    0,
                    to,
                    log_line,
                    null(),
                ),
                (Functions::Three(f), Kind::ModelExchange) => {
                    (f.instantiate_me?)(name, token, resources, false, logging, to, log_line)
                }
            }
        };
        let made = Handle { instance, binary, _callbacks: callbacks, _environment: environment };
        (!instance.is_null()).then_some(made)
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
                let status = call!(f.setup, self.instance, given, tolerance, start, ends, stop);
                if status.is_good() { call!(f.enter_initialization, self.instance) } else { status }
            }
            Functions::Three(f) => {
                call!(f.enter_initialization, self.instance, given, tolerance, start, ends, stop)
            }
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
            Getter::Two(f) => call!(f, self.instance, references.as_ptr(), n, values.as_mut_ptr()),
            Getter::Three(f) => {
                call!(f, self.instance, references.as_ptr(), n, values.as_mut_ptr(), count)
            }
        }
    }

    pub(super) fn set<T: Native>(&mut self, references: &[u32], values: &[T]) -> Status {
        let (n, count) = (references.len(), values.len());
        match T::setter(&self.binary.functions) {
            Setter::Two(_) if n != count => Status::Missing,
            Setter::Two(f) => call!(f, self.instance, references.as_ptr(), n, values.as_ptr()),
            Setter::Three(f) => {
                call!(f, self.instance, references.as_ptr(), n, values.as_ptr(), count)
            }
        }
    }

    /// The text of one variable; the FMU's memory is copied at once, as it may be reused.
    pub(super) fn get_string(&mut self, reference: u32) -> (Status, String) {
        let mut text: *const c_char = null();
        let status = match &self.binary.functions {
            Functions::Two(f) => call!(f.get_string, self.instance, &reference, 1, &mut text),
            Functions::Three(f) => call!(f.get_string, self.instance, &reference, 1, &mut text, 1),
        };
        if !status.is_good() || text.is_null() {
            return (status, String::new());
        }
        // SAFETY: after a good status it is a terminated string until the next call.
        (status, unsafe { CStr::from_ptr(text) }.to_string_lossy().into_owned())
    }

    pub(super) fn set_string(&mut self, reference: u32, text: &CString) -> Status {
        let text = text.as_ptr();
        match &self.binary.functions {
            Functions::Two(f) => call!(f.set_string, self.instance, &reference, 1, &text),
            Functions::Three(f) => call!(f.set_string, self.instance, &reference, 1, &text, 1),
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
                let status = call!(f.do_step, self.instance, time, step, i32::from(!may_go_back));
                let mut ends = 0;
                if status == Status::Discard {
                    // `fmi2LastSuccessfulTime` and `fmi2Terminated`; older FMUs lack them.
                    call!(f.get_real_status, self.instance, 2, &mut reached);
                    call!(f.get_boolean_status, self.instance, 3, &mut ends);
                }
                (status, ends != 0, reached)
            }
            Functions::Three(f) => {
                let (mut event, mut ends, mut early) = (false, false, false);
                let status = call!(
                    f.do_step,
                    self.instance,
                    time,
                    step,
                    !may_go_back,
                    &mut event,
                    &mut ends,
                    &mut early,
                    &mut reached
                );
                (status, ends, reached)
            }
        }
    }

    /// Saves the FMU state, into the memory of an earlier one if given.
    pub(super) fn save(&mut self, into: Option<Saved>) -> (Status, Saved) {
        let mut state = into.map_or(null_mut(), |saved| saved.0);
        (either!(self, get_state | get_state, &mut state), Saved(state))
    }

    pub(super) fn restore(&mut self, saved: Saved) -> Status {
        either!(self, set_state | set_state, saved.0)
    }

    pub(super) fn free_saved(&mut self, Saved(mut state): Saved) -> Status {
        either!(self, free_state | free_state, &mut state)
    }

    pub(super) fn serialize(&mut self, saved: Saved) -> (Status, Vec<u8>) {
        let mut size = 0;
        let status = either!(self, state_size | state_size, saved.0, &mut size);
        if !status.is_good() {
            return (status, Vec::new());
        }
        let mut bytes = vec![0; size];
        (either!(self, serialize | serialize, saved.0, bytes.as_mut_ptr(), size), bytes)
    }

    pub(super) fn deserialize(&mut self, bytes: &[u8]) -> (Status, Saved) {
        let mut state = null_mut();
        let status =
            either!(self, deserialize | deserialize, bytes.as_ptr(), bytes.len(), &mut state);
        (status, Saved(state))
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
            Functions::Two(f) => call!(f.directional, self.instance, u, nu, k, nk, seed, out),
            Functions::Three(f) => {
                call!(f.directional, self.instance, u, nu, k, nk, seed, nk, out, nu)
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
            Functions::Two(f) => call!(f.new_discrete_states, self.instance, &mut info),
            Functions::Three(f) => {
                let mut flags = [false; 5];
                let [a, b, c, d, e] = &mut flags;
                let status = call!(
                    f.update_discrete_states,
                    self.instance,
                    a,
                    b,
                    c,
                    d,
                    e,
                    &mut info.next_time
                );
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
                let status = call!(f.completed_step, self.instance, 1, &mut event, &mut ends);
                (status, event != 0, ends != 0)
            }
            Functions::Three(f) => {
                let (mut event, mut ends) = (false, false);
                let status = call!(f.completed_step, self.instance, true, &mut event, &mut ends);
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
        let good = call!(f.number_of_states, self.instance, &mut states).is_good()
            && call!(f.number_of_event_indicators, self.instance, &mut indicators).is_good();
        good.then_some((states, indicators))
    }
}

impl Drop for Handle {
    fn drop(&mut self) {
        // SAFETY: the instance is freed once, and nothing uses it afterwards.
        let free = match &self.binary.functions {
            Functions::Two(f) => f.free_instance,
            Functions::Three(f) => f.free_instance,
        };
        if let (Some(free), false) = (free, self.instance.is_null()) {
            unsafe { free(self.instance) };
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fmi_2_messages_are_expanded() {
        let log = Arc::new(Log::default());
        let environment = Environment { line: log_line, log: Arc::clone(&log) };
        let (format, name) = (c"speed %.1f of %s", c"motor");
        // SAFETY: the arguments match the format.
        unsafe {
            drivescope_fmi2_log(
                &environment,
                null(),
                3,
                null(),
                format.as_ptr(),
                2.5_f64,
                name.as_ptr(),
            );
            drivescope_fmi2_log(null(), null(), 3, null(), format.as_ptr(), 2.5_f64, name.as_ptr());
        }
        let messages = log.take();
        assert_eq!(messages.len(), 1);
        assert_eq!(
            (messages[0].status, messages[0].text.as_str()),
            (Status::Error, "speed 2.5 of motor")
        );
    }
}
