//! The C functions of FMI 2.0 and 3.0 that an importer calls, with the types that the standard gives
//! them (`fmi2FunctionTypes.h`, `fmi3FunctionTypes.h`). Statuses are plain numbers here: a foreign
//! binary can return any, and a Rust enum must not hold one that it does not know.
//!
//! A missing function is found here; only a call of it, or of one that every run needs, is an error.

use std::ffi::{CStr, c_char, c_void};

use libloading::Library;

use super::binding::{Callbacks, Environment, EventInfo, LogLine, Pointer, symbol};
use super::boolean::Boolean2;
use super::description::{Interface, Version};

pub(super) type Instance = Pointer;
type Text = *const c_char;
pub(super) type Refs = *const u32;

/// A table of functions: field, symbol, type.
macro_rules! table {
    ($(#[$doc:meta])* $name:ident { $($field:ident = $symbol:literal ($($argument:ty),*) $(-> $result:ty)?;)* }) => {
        $(#[$doc])*
        pub(super) struct $name {
            $(pub(super) $field: Option<unsafe extern "C" fn($($argument),*) $(-> $result)?>,)*
        }
        impl $name {
            fn load(library: &Library) -> $name {
                $name { $($field: symbol(library, $symbol),)* }
            }
            /// All symbols that the standard demands and the binary lacks.
            fn missing(&self) -> Vec<&'static CStr> {
                let all: &[(&CStr, bool)] = &[$(($symbol, self.$field.is_some()),)*];
                all.iter().filter(|(_, there)| !there).map(|(name, _)| *name).collect()
            }
        }
    };
}

table! {
    /// FMI 2.0.
    Two {
        instantiate = c"fmi2Instantiate" (Text, i32, Text, Text, *const Callbacks, i32, i32) -> Instance;
        free_instance = c"fmi2FreeInstance" (Instance);
        setup = c"fmi2SetupExperiment" (Instance, i32, f64, f64, i32, f64) -> i32;
        enter_initialization = c"fmi2EnterInitializationMode" (Instance) -> i32;
        exit_initialization = c"fmi2ExitInitializationMode" (Instance) -> i32;
        terminate = c"fmi2Terminate" (Instance) -> i32;
        reset = c"fmi2Reset" (Instance) -> i32;
        get_real = c"fmi2GetReal" (Instance, Refs, usize, *mut f64) -> i32;
        get_integer = c"fmi2GetInteger" (Instance, Refs, usize, *mut i32) -> i32;
        get_boolean = c"fmi2GetBoolean" (Instance, Refs, usize, *mut Boolean2) -> i32;
        get_string = c"fmi2GetString" (Instance, Refs, usize, *mut Text) -> i32;
        set_real = c"fmi2SetReal" (Instance, Refs, usize, *const f64) -> i32;
        set_integer = c"fmi2SetInteger" (Instance, Refs, usize, *const i32) -> i32;
        set_boolean = c"fmi2SetBoolean" (Instance, Refs, usize, *const Boolean2) -> i32;
        set_string = c"fmi2SetString" (Instance, Refs, usize, *const Text) -> i32;
        get_state = c"fmi2GetFMUstate" (Instance, *mut Pointer) -> i32;
        set_state = c"fmi2SetFMUstate" (Instance, Pointer) -> i32;
        free_state = c"fmi2FreeFMUstate" (Instance, *mut Pointer) -> i32;
        state_size = c"fmi2SerializedFMUstateSize" (Instance, Pointer, *mut usize) -> i32;
        serialize = c"fmi2SerializeFMUstate" (Instance, Pointer, *mut u8, usize) -> i32;
        deserialize = c"fmi2DeSerializeFMUstate" (Instance, *const u8, usize, *mut Pointer) -> i32;
        directional = c"fmi2GetDirectionalDerivative" (Instance, Refs, usize, Refs, usize, *const f64, *mut f64) -> i32;
        do_step = c"fmi2DoStep" (Instance, f64, f64, i32) -> i32;
        get_real_status = c"fmi2GetRealStatus" (Instance, i32, *mut f64) -> i32;
        get_boolean_status = c"fmi2GetBooleanStatus" (Instance, i32, *mut i32) -> i32;
        enter_event_mode = c"fmi2EnterEventMode" (Instance) -> i32;
        new_discrete_states = c"fmi2NewDiscreteStates" (Instance, *mut EventInfo) -> i32;
        enter_continuous_time_mode = c"fmi2EnterContinuousTimeMode" (Instance) -> i32;
        completed_step = c"fmi2CompletedIntegratorStep" (Instance, i32, *mut i32, *mut i32) -> i32;
        set_time = c"fmi2SetTime" (Instance, f64) -> i32;
        set_continuous_states = c"fmi2SetContinuousStates" (Instance, *const f64, usize) -> i32;
        get_derivatives = c"fmi2GetDerivatives" (Instance, *mut f64, usize) -> i32;
        get_event_indicators = c"fmi2GetEventIndicators" (Instance, *mut f64, usize) -> i32;
        get_continuous_states = c"fmi2GetContinuousStates" (Instance, *mut f64, usize) -> i32;
        get_nominals = c"fmi2GetNominalsOfContinuousStates" (Instance, *mut f64, usize) -> i32;
    }
}

table! {
    /// FMI 3.0.
    Three {
        instantiate_cs = c"fmi3InstantiateCoSimulation" (Text, Text, Text, bool, bool, bool, bool, Refs, usize, *const Environment, LogLine, *const c_void) -> Instance;
        instantiate_me = c"fmi3InstantiateModelExchange" (Text, Text, Text, bool, bool, *const Environment, LogLine) -> Instance;
        free_instance = c"fmi3FreeInstance" (Instance);
        enter_initialization = c"fmi3EnterInitializationMode" (Instance, bool, f64, f64, bool, f64) -> i32;
        exit_initialization = c"fmi3ExitInitializationMode" (Instance) -> i32;
        enter_event_mode = c"fmi3EnterEventMode" (Instance) -> i32;
        terminate = c"fmi3Terminate" (Instance) -> i32;
        reset = c"fmi3Reset" (Instance) -> i32;
        get_float64 = c"fmi3GetFloat64" (Instance, Refs, usize, *mut f64, usize) -> i32;
        set_float64 = c"fmi3SetFloat64" (Instance, Refs, usize, *const f64, usize) -> i32;
        get_float32 = c"fmi3GetFloat32" (Instance, Refs, usize, *mut f32, usize) -> i32;
        set_float32 = c"fmi3SetFloat32" (Instance, Refs, usize, *const f32, usize) -> i32;
        get_int8 = c"fmi3GetInt8" (Instance, Refs, usize, *mut i8, usize) -> i32;
        set_int8 = c"fmi3SetInt8" (Instance, Refs, usize, *const i8, usize) -> i32;
        get_uint8 = c"fmi3GetUInt8" (Instance, Refs, usize, *mut u8, usize) -> i32;
        set_uint8 = c"fmi3SetUInt8" (Instance, Refs, usize, *const u8, usize) -> i32;
        get_int16 = c"fmi3GetInt16" (Instance, Refs, usize, *mut i16, usize) -> i32;
        set_int16 = c"fmi3SetInt16" (Instance, Refs, usize, *const i16, usize) -> i32;
        get_uint16 = c"fmi3GetUInt16" (Instance, Refs, usize, *mut u16, usize) -> i32;
        set_uint16 = c"fmi3SetUInt16" (Instance, Refs, usize, *const u16, usize) -> i32;
        get_int32 = c"fmi3GetInt32" (Instance, Refs, usize, *mut i32, usize) -> i32;
        set_int32 = c"fmi3SetInt32" (Instance, Refs, usize, *const i32, usize) -> i32;
        get_uint32 = c"fmi3GetUInt32" (Instance, Refs, usize, *mut u32, usize) -> i32;
        set_uint32 = c"fmi3SetUInt32" (Instance, Refs, usize, *const u32, usize) -> i32;
        get_int64 = c"fmi3GetInt64" (Instance, Refs, usize, *mut i64, usize) -> i32;
        set_int64 = c"fmi3SetInt64" (Instance, Refs, usize, *const i64, usize) -> i32;
        get_uint64 = c"fmi3GetUInt64" (Instance, Refs, usize, *mut u64, usize) -> i32;
        set_uint64 = c"fmi3SetUInt64" (Instance, Refs, usize, *const u64, usize) -> i32;
        get_boolean = c"fmi3GetBoolean" (Instance, Refs, usize, *mut bool, usize) -> i32;
        set_boolean = c"fmi3SetBoolean" (Instance, Refs, usize, *const bool, usize) -> i32;
        get_string = c"fmi3GetString" (Instance, Refs, usize, *mut Text, usize) -> i32;
        set_string = c"fmi3SetString" (Instance, Refs, usize, *const Text, usize) -> i32;
        get_binary = c"fmi3GetBinary" (Instance, Refs, usize, *mut usize, *mut *const u8, usize) -> i32;
        get_state = c"fmi3GetFMUState" (Instance, *mut Pointer) -> i32;
        set_state = c"fmi3SetFMUState" (Instance, Pointer) -> i32;
        free_state = c"fmi3FreeFMUState" (Instance, *mut Pointer) -> i32;
        state_size = c"fmi3SerializedFMUStateSize" (Instance, Pointer, *mut usize) -> i32;
        serialize = c"fmi3SerializeFMUState" (Instance, Pointer, *mut u8, usize) -> i32;
        deserialize = c"fmi3DeserializeFMUState" (Instance, *const u8, usize, *mut Pointer) -> i32;
        directional = c"fmi3GetDirectionalDerivative" (Instance, Refs, usize, Refs, usize, *const f64, usize, *mut f64, usize) -> i32;
        enter_continuous_time_mode = c"fmi3EnterContinuousTimeMode" (Instance) -> i32;
        completed_step = c"fmi3CompletedIntegratorStep" (Instance, bool, *mut bool, *mut bool) -> i32;
        update_discrete_states = c"fmi3UpdateDiscreteStates" (Instance, *mut bool, *mut bool, *mut bool, *mut bool, *mut bool, *mut f64) -> i32;
        set_time = c"fmi3SetTime" (Instance, f64) -> i32;
        set_continuous_states = c"fmi3SetContinuousStates" (Instance, *const f64, usize) -> i32;
        get_derivatives = c"fmi3GetContinuousStateDerivatives" (Instance, *mut f64, usize) -> i32;
        get_event_indicators = c"fmi3GetEventIndicators" (Instance, *mut f64, usize) -> i32;
        get_continuous_states = c"fmi3GetContinuousStates" (Instance, *mut f64, usize) -> i32;
        get_nominals = c"fmi3GetNominalsOfContinuousStates" (Instance, *mut f64, usize) -> i32;
        number_of_states = c"fmi3GetNumberOfContinuousStates" (Instance, *mut usize) -> i32;
        number_of_event_indicators = c"fmi3GetNumberOfEventIndicators" (Instance, *mut usize) -> i32;
        do_step = c"fmi3DoStep" (Instance, f64, f64, bool, *mut bool, *mut bool, *mut bool, *mut f64) -> i32;
    }
}

/// Functions that no run here calls but that the standards demand of every binary.
const REST_OF_TWO: [&CStr; 3] =
    [c"fmi2GetVersion", c"fmi2GetTypesPlatform", c"fmi2SetDebugLogging"];
const REST_OF_TWO_CS: [&CStr; 6] = [
    c"fmi2CancelStep",
    c"fmi2SetRealInputDerivatives",
    c"fmi2GetRealOutputDerivatives",
    c"fmi2GetStatus",
    c"fmi2GetIntegerStatus",
    c"fmi2GetStringStatus",
];
const REST_OF_THREE: [&CStr; 23] = [
    c"fmi3GetVersion",
    c"fmi3SetDebugLogging",
    c"fmi3InstantiateScheduledExecution",
    c"fmi3SetBinary",
    c"fmi3GetClock",
    c"fmi3SetClock",
    c"fmi3GetNumberOfVariableDependencies",
    c"fmi3GetVariableDependencies",
    c"fmi3GetAdjointDerivative",
    c"fmi3EnterConfigurationMode",
    c"fmi3ExitConfigurationMode",
    c"fmi3GetIntervalDecimal",
    c"fmi3GetIntervalFraction",
    c"fmi3GetShiftDecimal",
    c"fmi3GetShiftFraction",
    c"fmi3SetIntervalDecimal",
    c"fmi3SetIntervalFraction",
    c"fmi3SetShiftDecimal",
    c"fmi3SetShiftFraction",
    c"fmi3EvaluateDiscreteStates",
    c"fmi3EnterStepMode",
    c"fmi3GetOutputDerivatives",
    c"fmi3ActivateModelPartition",
];

/// FMI 2.0 functions that only Co-Simulation needs.
const TWO_CS: [&CStr; 3] = [c"fmi2DoStep", c"fmi2GetRealStatus", c"fmi2GetBooleanStatus"];
/// FMI 2.0 functions that only Model Exchange needs.
const TWO_ME: [&CStr; 10] = [
    c"fmi2EnterEventMode",
    c"fmi2NewDiscreteStates",
    c"fmi2EnterContinuousTimeMode",
    c"fmi2CompletedIntegratorStep",
    c"fmi2SetTime",
    c"fmi2SetContinuousStates",
    c"fmi2GetDerivatives",
    c"fmi2GetEventIndicators",
    c"fmi2GetContinuousStates",
    c"fmi2GetNominalsOfContinuousStates",
];

/// The functions of one loaded binary, which stays loaded as long as they do.
pub(super) enum Functions {
    /// FMI 2.0.
    Two(Box<Two>),
    /// FMI 3.0.
    Three(Box<Three>),
}

impl Functions {
    pub(super) fn load(library: &Library, fmi: Version) -> Functions {
        match fmi {
            Version::Two => Functions::Two(Box::new(Two::load(library))),
            Version::Three => Functions::Three(Box::new(Three::load(library))),
        }
    }

    /// The functions without which no run of this interface type is possible, and that are missing.
    pub(super) fn missing_to_run(&self, kind: Interface) -> Vec<String> {
        let there = match (self, kind) {
            (Functions::Two(f), Interface::CoSimulation) => vec![
                (c"fmi2Instantiate", f.instantiate.is_some()),
                (c"fmi2SetupExperiment", f.setup.is_some()),
                (c"fmi2EnterInitializationMode", f.enter_initialization.is_some()),
                (c"fmi2ExitInitializationMode", f.exit_initialization.is_some()),
                (c"fmi2DoStep", f.do_step.is_some()),
            ],
            (Functions::Two(f), Interface::ModelExchange) => vec![
                (c"fmi2Instantiate", f.instantiate.is_some()),
                (c"fmi2SetupExperiment", f.setup.is_some()),
                (c"fmi2EnterInitializationMode", f.enter_initialization.is_some()),
                (c"fmi2ExitInitializationMode", f.exit_initialization.is_some()),
                (c"fmi2NewDiscreteStates", f.new_discrete_states.is_some()),
                (c"fmi2SetTime", f.set_time.is_some()),
            ],
            (Functions::Three(f), Interface::CoSimulation) => vec![
                (c"fmi3InstantiateCoSimulation", f.instantiate_cs.is_some()),
                (c"fmi3EnterInitializationMode", f.enter_initialization.is_some()),
                (c"fmi3ExitInitializationMode", f.exit_initialization.is_some()),
                (c"fmi3DoStep", f.do_step.is_some()),
            ],
            (Functions::Three(f), Interface::ModelExchange) => vec![
                (c"fmi3InstantiateModelExchange", f.instantiate_me.is_some()),
                (c"fmi3EnterInitializationMode", f.enter_initialization.is_some()),
                (c"fmi3ExitInitializationMode", f.exit_initialization.is_some()),
                (c"fmi3UpdateDiscreteStates", f.update_discrete_states.is_some()),
                (c"fmi3SetTime", f.set_time.is_some()),
            ],
        };
        let names = there.into_iter().filter(|(_, there)| !there).map(|(name, _)| name);
        names.map(|name| name.to_string_lossy().into_owned()).collect()
    }

    /// The functions that the standard demands of a binary with these interface types, and that
    /// are missing.
    pub(super) fn missing(&self, library: &Library, kinds: &[Interface]) -> Vec<String> {
        let absent = |name: &&'static CStr| symbol::<Pointer>(library, name).is_none();
        let mut missing = match self {
            Functions::Two(f) => f.missing(),
            Functions::Three(f) => f.missing(),
        };
        match self {
            Functions::Three(_) => missing.extend(REST_OF_THREE.iter().filter(|n| absent(n))),
            Functions::Two(_) => {
                missing.extend(REST_OF_TWO.iter().filter(|n| absent(n)));
                if kinds.contains(&Interface::CoSimulation) {
                    missing.extend(REST_OF_TWO_CS.iter().filter(|n| absent(n)));
                } else {
                    missing.retain(|name| !TWO_CS.contains(name));
                }
                if !kinds.contains(&Interface::ModelExchange) {
                    missing.retain(|name| !TWO_ME.contains(name));
                }
            }
        }
        missing.into_iter().map(|name| name.to_string_lossy().into_owned()).collect()
    }
}
