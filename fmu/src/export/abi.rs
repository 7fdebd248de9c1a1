//! The C side: pointers become references and slices here and nowhere else.
//!
//! [`In`], [`Out`], [`Text`] and [`Handle`] have the layout of the C pointers that they stand for
//! and no constructor: a value of them comes from an importer, which owes what the standard says
//! about it (valid for its length and for the time of the call; an instance that we made and that
//! is not freed). NULL, misaligned pointers and impossible lengths are refused; beyond that a
//! pointer cannot be checked. What the methods return is used within the call only.
#![allow(unsafe_code)]

use std::ffi::{CStr, CString, c_char, c_void};
use std::marker::PhantomData;
use std::panic::{AssertUnwindSafe, catch_unwind};

pub use super::instance::Instance;
pub use super::lifecycle::Experiment;
pub use super::refusal::{Refusal, Status};
pub use super::values::{Boolean2, Boolean3};
use super::{DiscreteUpdate, Model, instance, location};
pub use crate::description::Version;
pub use crate::vocabulary::Interface;

/// A pointer to values that the importer gives.
#[derive(Debug)]
#[repr(transparent)]
pub struct In<T>(*const T);

/// A pointer to values that the importer wants.
#[derive(Debug)]
#[repr(transparent)]
pub struct Out<T>(*mut T);

/// A NUL-terminated string, or NULL.
#[derive(Clone, Copy, Debug)]
#[repr(transparent)]
pub struct Text(*const c_char);

/// An FMU state as the importer sees it: an opaque pointer that is a key, never dereferenced.
#[derive(Clone, Copy, Debug)]
#[repr(transparent)]
pub struct State(*mut c_void);

/// An instance of a model, or NULL.
#[derive(Debug)]
#[repr(transparent)]
pub struct Handle<M>(*mut c_void, PhantomData<M>);

impl<T> Copy for In<T> {}
impl<T> Clone for In<T> {
    fn clone(&self) -> Self {
        *self
    }
}
impl<T> Copy for Out<T> {}
impl<T> Clone for Out<T> {
    fn clone(&self) -> Self {
        *self
    }
}

fn check<T>(pointer: *const T, n: usize) -> Result<(), Refusal> {
    if pointer.is_null() {
        return Err(Refusal::NullPointer(n));
    }
    if !pointer.is_aligned() || n > isize::MAX as usize / size_of::<T>().max(1) {
        return Err(Refusal::BadPointer(n));
    }
    Ok(())
}

impl<T> In<T> {
    /// The `n` values.
    pub fn slice<'a>(self, n: usize) -> Result<&'a [T], Refusal> {
        if n == 0 {
            return Ok(&[]);
        }
        check(self.0, n)?;
        // SAFETY: not NULL, aligned; the importer owes n readable values for the call.
        Ok(unsafe { std::slice::from_raw_parts(self.0, n) })
    }
}

impl<T> Out<T> {
    /// The `n` places.
    pub fn slice<'a>(self, n: usize) -> Result<&'a mut [T], Refusal> {
        if n == 0 {
            return Ok(&mut []);
        }
        check(self.0, n)?;
        // SAFETY: not NULL, aligned; the importer owes n writable places, its own for the call.
        Ok(unsafe { std::slice::from_raw_parts_mut(self.0, n) })
    }

    /// The one place.
    pub fn get<'a>(self) -> Result<&'a mut T, Refusal> {
        Ok(&mut self.slice(1)?[0])
    }
}

impl Text {
    /// The string, `None` for NULL.
    pub fn optional<'a>(self) -> Result<Option<&'a str>, Refusal> {
        if self.0.is_null() {
            return Ok(None);
        }
        // SAFETY: not NULL; the importer owes a terminated string for the call.
        let text = unsafe { CStr::from_ptr(self.0) };
        text.to_str().map(Some).map_err(|_| Refusal::NotUtf8)
    }

    /// The string, which must not be NULL.
    pub fn required<'a>(self) -> Result<&'a str, Refusal> {
        self.optional()?.ok_or(Refusal::NullPointer(1))
    }
}

impl In<Text> {
    /// `n` strings.
    pub fn texts<'a>(self, n: usize) -> Result<Vec<&'a str>, Refusal> {
        self.slice(n)?.iter().map(|text| text.required()).collect()
    }
}

impl State {
    /// 0 for NULL.
    pub fn key(self) -> usize {
        self.0.addr()
    }

    /// The pointer of a key.
    pub fn of(key: usize) -> Self {
        Self(std::ptr::without_provenance_mut(key))
    }
}

/// FMI 2.0 `fmi2EventInfo`.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub struct EventInfo2 {
    new_discrete_states_needed: i32,
    terminate_simulation: i32,
    nominals_changed: i32,
    values_changed: i32,
    next_event_time_defined: i32,
    next_event_time: f64,
}

impl From<DiscreteUpdate> for EventInfo2 {
    fn from(update: DiscreteUpdate) -> Self {
        Self {
            new_discrete_states_needed: i32::from(update.again),
            terminate_simulation: 0,
            nominals_changed: 0,
            values_changed: i32::from(update.states_changed),
            next_event_time_defined: i32::from(update.next_event.is_some()),
            next_event_time: update.next_event.unwrap_or(0.0),
        }
    }
}

type Logger2 =
    unsafe extern "C" fn(*mut c_void, *const c_char, Status, *const c_char, *const c_char, ...);
/// FMI 3.0 `fmi3LogMessageCallback`.
pub type Logger3 = unsafe extern "C" fn(*mut c_void, Status, *const c_char, *const c_char);

/// FMI 2.0 `fmi2CallbackFunctions`; memory and step callbacks are not used.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub struct Callbacks2 {
    logger: Option<Logger2>,
    allocate_memory: *const c_void,
    free_memory: *const c_void,
    step_finished: *const c_void,
    environment: *mut c_void,
}

/// The importer's logger.
#[derive(Clone, Copy)]
enum Logger {
    Two(Option<Logger2>, *mut c_void),
    Three(Option<Logger3>, *mut c_void),
}

impl Logger {
    fn emit(self, name: &CStr, message: &instance::Message) {
        let category = c_string(message.category.name());
        match self {
            Self::Two(Some(log), environment) => {
                // The message is a printf format in which `#` marks a value reference.
                let text = c_string(&message.text.replace('%', "%%").replace('#', "##"));
                let (name, category, text) = (name.as_ptr(), category.as_ptr(), text.as_ptr());
                // SAFETY: the importer's own function with the arguments of its type; the
                // strings outlive the call and no reference into the instance is alive.
                unsafe { log(environment, name, message.status, category, text) }
            }
            Self::Three(Some(log), environment) => {
                let text = c_string(&message.text);
                // SAFETY: as above.
                unsafe { log(environment, message.status, category.as_ptr(), text.as_ptr()) }
            }
            Self::Two(None, _) | Self::Three(None, _) => {}
        }
    }
}

fn c_string(text: &str) -> CString {
    CString::new(text.replace('\0', " ")).unwrap_or_default()
}

struct Slot<M: Model> {
    instance: Instance<M>,
    name: CString,
    logger: Logger,
}

impl<M: Model> Handle<M> {
    fn create(
        logger: Logger,
        function: &str,
        name: Text,
        make: impl FnOnce(&str) -> Result<Instance<M>, Refusal>,
    ) -> Self {
        let made = catch_unwind(AssertUnwindSafe(|| {
            let name = name.required()?;
            Ok(Slot { instance: make(name)?, name: c_string(name), logger })
        }));
        let refusal = match made {
            Ok(Ok(slot)) => return Self(Box::into_raw(Box::new(slot)).cast(), PhantomData),
            Ok(Err(refusal)) => refusal,
            Err(panic) => Refusal::Panicked(instance::panic_text(panic.as_ref())),
        };
        let status = refusal.status();
        let text = format!("{function}: {refusal}");
        let name = c_string(name.optional().ok().flatten().unwrap_or_default());
        logger.emit(&name, &instance::Message { status, category: status.category(), text });
        Self(std::ptr::null_mut(), PhantomData)
    }

    /// Does one call and then, the instance no longer borrowed, logs.
    pub fn call(
        self,
        version: Version,
        function: &'static str,
        work: impl FnOnce(&mut Instance<M>) -> Result<(), Refusal>,
    ) -> Status {
        let pointer = self.0.cast::<Slot<M>>();
        if check(pointer, 1).is_err() {
            return Status::Error;
        }
        // SAFETY: not NULL, aligned; the importer owes a pointer from `create` that is not freed,
        // and no second call at the same time.
        let slot = unsafe { &mut *pointer };
        let status = slot.instance.answer(version, function, work);
        let messages = slot.instance.take_messages();
        if !messages.is_empty() {
            let (name, logger) = (slot.name.clone(), slot.logger);
            messages.iter().for_each(|message| logger.emit(&name, message));
        }
        status
    }

    /// Frees the instance; NULL is nothing to free.
    pub fn free(self) {
        let pointer = self.0.cast::<Slot<M>>();
        if check(pointer, 1).is_err() {
            return;
        }
        // SAFETY: as in `call`; the importer does not use the pointer again.
        let slot = unsafe { Box::from_raw(pointer) };
        // A panic in the model's drop has nobody left to be told.
        drop(catch_unwind(AssertUnwindSafe(|| drop(slot))));
    }
}

/// `fmi2Instantiate`.
pub fn instantiate2<M: Model>(
    name: Text,
    kind: i32,
    token: Text,
    resources: Text,
    callbacks: In<Callbacks2>,
    logging: bool,
) -> Handle<M> {
    let Ok([callbacks]) = callbacks.slice(1) else {
        return Handle(std::ptr::null_mut(), PhantomData);
    };
    let logger = Logger::Two(callbacks.logger, callbacks.environment);
    Handle::create(logger, "fmi2Instantiate", name, |name| {
        let interface = match kind {
            0 => Interface::ModelExchange,
            1 => Interface::CoSimulation,
            _ => return Err(Refusal::NotOffered("this type of FMU")),
        };
        let resources = location::resources(Version::Two, resources.optional()?);
        let token = token.required()?;
        Instance::new(Version::Two, interface, name, token, resources.as_deref(), logging)
    })
}

/// `fmi3Instantiate...`; `interface` is the reason why it is refused, where it is.
pub fn instantiate3<M: Model>(
    function: &'static str,
    interface: Result<Interface, Refusal>,
    (name, token, resources): (Text, Text, Text),
    logging: bool,
    (environment, logger): (*mut c_void, Option<Logger3>),
) -> Handle<M> {
    Handle::create(Logger::Three(logger, environment), function, name, |name| {
        let interface = interface?;
        let resources = location::resources(Version::Three, resources.optional()?);
        let token = token.required()?;
        Instance::new(Version::Three, interface, name, token, resources.as_deref(), logging)
    })
}

/// Emits C functions that answer with a status: name, arguments after the instance, work.
#[doc(hidden)]
#[macro_export]
macro_rules! fmi_functions {
    ($version:expr, $model:ty;
     $(fn $name:ident($c:ident $(, $argument:ident: $type:ty)* $(,)?) => $work:expr;)*) => {$(
        #[allow(unused_variables)]
        #[unsafe(no_mangle)]
        pub extern "C" fn $name(
            $c: $crate::export::abi::Handle<$model> $(, $argument: $type)*
        ) -> $crate::export::abi::Status {
            $c.call($version, stringify!($name), $work)
        }
    )*};
}
