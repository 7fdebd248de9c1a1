//! The boundary to foreign code: loads an FMU's binary and calls its C functions (FMI 2.0 section 2.1,
//! FMI 3.0 section 2.2). This is the one file of the import side that may be `unsafe`; everything in
//! it is reached through [`Handle`](super::handle::Handle), whose methods are safe.
//!
//! What safety rests on: the functions have the types that the standard gives them (nobody can check
//! that), lengths come from slices, returned statuses are plain numbers, an instance is called by one
//! thread at a time (`&mut self`), and library, callbacks and environment outlive the instance.
#![allow(unsafe_code)]

use std::ffi::{CStr, c_char, c_void};
use std::path::Path;
use std::ptr::{null, null_mut};
use std::sync::Arc;

use libloading::Library;

use super::logging::{Log, Message};
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

/// Starts the Python of a loaded library, unless it runs already, and lets go of its lock. Without
/// signal handlers: Ctrl-C stays the host's.
pub(super) fn start_python(library: &Library, executable: Option<&CStr>) {
    let running = symbol::<unsafe extern "C" fn() -> i32>(library, c"Py_IsInitialized");
    let start = symbol::<unsafe extern "C" fn(i32)>(library, c"Py_InitializeEx");
    let release = symbol::<unsafe extern "C" fn() -> Pointer>(library, c"PyEval_SaveThread");
    let decode = symbol::<unsafe extern "C" fn(*const c_char, Pointer) -> Pointer>(
        library,
        c"Py_DecodeLocale",
    );
    let name = symbol::<unsafe extern "C" fn(Pointer)>(library, c"Py_SetProgramName");
    let (Some(running), Some(start), Some(release)) = (running, start, release) else { return };
    // SAFETY: the types are those of Python's C interface; the caller lets one thread in at a time.
    unsafe {
        if running() != 0 {
            return;
        }
        if let (Some(decode), Some(name), Some(executable)) = (decode, name, executable) {
            name(decode(executable.as_ptr(), null_mut()));
        }
        start(0);
        release();
    }
}

/// Ends the process, once it exits, before the finalisers of the libraries loaded so far: their exit
/// handlers were registered before this one and would run after it. Output is flushed, and the exit
/// status stays. Only the GNU C library tells a handler the status.
pub(super) fn leave_before_finalisers() {
    #[cfg(all(target_os = "linux", target_env = "gnu"))]
    {
        unsafe extern "C" {
            fn on_exit(handler: extern "C" fn(i32, Pointer), argument: Pointer) -> i32;
            fn fflush(stream: Pointer) -> i32;
            fn _exit(status: i32) -> !;
        }
        extern "C" fn leave(status: i32, _: Pointer) {
            // SAFETY: a null stream means all of them; the process ends here.
            unsafe {
                fflush(null_mut());
                _exit(status)
            }
        }
        // SAFETY: the handler takes what the C library gives it. If it cannot be registered, the
        // process ends in the ordinary way.
        unsafe { on_exit(leave, null_mut()) };
    }
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
    // SAFETY: `to` is null or the environment that `instantiate` gave to the FMU.
    if let Some(environment) = unsafe { to.as_ref() } {
        let status = Status::from_c(status);
        environment.log.push(Message {
            status,
            category: text_of(category),
            text: text_of(text).trim_end().to_owned(),
        });
    }
}

/// The FMI 3.0 logger as an argument.
pub(super) const LOG_LINE: LogLine = log_line;
pub(super) type LogLine = extern "C" fn(*const Environment, i32, *const c_char, *const c_char);

/// A text that the FMU owns, copied; empty for a null pointer.
pub(super) fn text_of(text: *const c_char) -> String {
    if text.is_null() {
        return String::new();
    }
    // SAFETY: the standard says that it is a terminated string until the next call.
    unsafe { CStr::from_ptr(text) }.to_string_lossy().into_owned()
}

/// Bytes that the FMU owns, copied; none for a null pointer.
pub(super) fn bytes_of(bytes: *const u8, size: usize) -> Vec<u8> {
    if bytes.is_null() {
        return Vec::new();
    }
    // SAFETY: the standard says that they are that many until the next call.
    unsafe { std::slice::from_raw_parts(bytes, size) }.to_vec()
}

/// What an FMU holds addresses of as long as its instance lives.
pub(super) struct Kept {
    callbacks: Box<Callbacks>,
    environment: Box<Environment>,
}

impl Kept {
    pub(super) fn new(log: Arc<Log>) -> Kept {
        let environment = Box::new(Environment { line: log_line, log });
        let callbacks = Box::new(Callbacks {
            logger: drivescope_fmi2_log,
            allocate: calloc,
            free,
            step_finished: null(),
            environment: &raw const *environment,
        });
        Kept { callbacks, environment }
    }

    pub(super) fn callbacks(&self) -> *const Callbacks {
        &raw const *self.callbacks
    }

    pub(super) fn environment(&self) -> *const Environment {
        &raw const *self.environment
    }
}

// SAFETY: the log is shared under a lock, and the rest is never written.
unsafe impl Send for Kept {}

/// The address of an instance.
pub(super) struct Foreign(pub(super) Pointer);

// SAFETY: FMI lets any thread call an instance as long as calls do not overlap (FMI 2.0 section 2.1.4,
// FMI 3.0 section 2.2.1), and each call of a handle takes `&mut self`.
unsafe impl Send for Foreign {}

/// One saved FMU state, valid for the instance that made it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Saved(Pointer);

impl Saved {
    pub(super) fn new(pointer: Pointer) -> Saved {
        Saved(pointer)
    }

    pub(super) fn pointer(self) -> Pointer {
        self.0
    }
}

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

/// Calls a function of the table, if the binary has it.
pub(super) trait Call<Arguments>: Sized {
    type Result;

    /// The function's result; `None` if there is no such function.
    fn call(self, arguments: Arguments) -> Option<Self::Result>;

    /// The status it returns.
    #[inline]
    fn status(self, arguments: Arguments) -> Status
    where
        Self: Call<Arguments, Result = i32>,
    {
        self.call(arguments).map_or(Status::Missing, Status::from_c)
    }
}

macro_rules! calls {
    ($($kind:ident),*) => {
        impl<R, $($kind),*> Call<($($kind,)*)> for Option<unsafe extern "C" fn($($kind),*) -> R> {
            type Result = R;

            #[inline]
            #[allow(non_snake_case)]
            fn call(self, ($($kind,)*): ($($kind,)*)) -> Option<R> {
                // SAFETY: see the head of this file.
                self.map(|function| unsafe { function($($kind),*) })
            }
        }
    };
}
calls!(A);
calls!(A, B);
calls!(A, B, C);
calls!(A, B, C, D);
calls!(A, B, C, D, E);
calls!(A, B, C, D, E, F);
calls!(A, B, C, D, E, F, G);
calls!(A, B, C, D, E, F, G, H);
calls!(A, B, C, D, E, F, G, H, I);
calls!(A, B, C, D, E, F, G, H, I, J, K, L);

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
