//! Every C function of FMI 2.0 (standard 2.0.4, `fmi2Functions.h`): its arguments and the
//! instance's method that answers.

/// Emits the functions for one model.
#[doc(hidden)]
#[macro_export]
macro_rules! fmi2_functions {
    ($model:ty) => {
        #[unsafe(no_mangle)]
        pub extern "C" fn fmi2GetTypesPlatform() -> *const ::std::ffi::c_char {
            c"default".as_ptr()
        }

        #[unsafe(no_mangle)]
        pub extern "C" fn fmi2GetVersion() -> *const ::std::ffi::c_char {
            c"2.0".as_ptr()
        }

        #[unsafe(no_mangle)]
        pub extern "C" fn fmi2Instantiate(
            name: $crate::export::abi::Text,
            kind: i32,
            token: $crate::export::abi::Text,
            resources: $crate::export::abi::Text,
            callbacks: $crate::export::abi::In<$crate::export::abi::Callbacks2>,
            _visible: i32,
            logging: i32,
        ) -> $crate::export::abi::Handle<$model> {
            $crate::export::abi::instantiate2(name, kind, token, resources, callbacks, logging != 0)
        }

        #[unsafe(no_mangle)]
        pub extern "C" fn fmi2FreeInstance(c: $crate::export::abi::Handle<$model>) {
            c.free();
        }

        const _: () = {
            use $crate::export::abi::{
                Boolean2, EventInfo2, Experiment, In, Out, Refusal, State, Text, Version,
            };
            $crate::fmi_functions! { Version::Two, $model;

    fn fmi2SetDebugLogging(c, on: i32, n: usize, categories: In<Text>) =>
        |i| i.set_debug_logging(on != 0, &categories.texts(n)?);
    fn fmi2SetupExperiment(c, has_tolerance: i32, tolerance: f64, start: f64, has_stop: i32, stop: f64) =>
        |i| i.setup_experiment(Experiment::new((has_tolerance != 0).then_some(tolerance), start, (has_stop != 0).then_some(stop)));
    fn fmi2EnterInitializationMode(c) => |i| i.enter_initialization();
    fn fmi2ExitInitializationMode(c) => |i| i.exit_initialization();
    fn fmi2Terminate(c) => |i| i.terminate();
    fn fmi2Reset(c) => |i| i.reset();

    fn fmi2GetReal(c, vr: In<u32>, n: usize, values: Out<f64>) => |i| i.get(vr.slice(n)?, values.slice(n)?);
    fn fmi2GetInteger(c, vr: In<u32>, n: usize, values: Out<i32>) => |i| i.get(vr.slice(n)?, values.slice(n)?);
    fn fmi2GetBoolean(c, vr: In<u32>, n: usize, values: Out<Boolean2>) => |i| i.get(vr.slice(n)?, values.slice(n)?);
    fn fmi2GetString(c, vr: In<u32>, n: usize, values: Out<Text>) => |i| i.no_such_type("String", vr.slice(n)?);
    fn fmi2SetReal(c, vr: In<u32>, n: usize, values: In<f64>) => |i| i.set(vr.slice(n)?, values.slice(n)?);
    fn fmi2SetInteger(c, vr: In<u32>, n: usize, values: In<i32>) => |i| i.set(vr.slice(n)?, values.slice(n)?);
    fn fmi2SetBoolean(c, vr: In<u32>, n: usize, values: In<Boolean2>) => |i| i.set(vr.slice(n)?, values.slice(n)?);
    fn fmi2SetString(c, vr: In<u32>, n: usize, values: In<Text>) => |i| i.no_such_type("String", vr.slice(n)?);

    fn fmi2GetFMUstate(c, state: Out<State>) =>
        |i| { let state = state.get()?; *state = State::of(i.save_state(state.key())?); Ok(()) };
    fn fmi2SetFMUstate(c, state: State) => |i| i.restore_state(state.key());
    fn fmi2FreeFMUstate(c, state: Out<State>) =>
        |i| { let state = state.get()?; i.free_state(state.key())?; *state = State::of(0); Ok(()) };
    fn fmi2SerializedFMUstateSize(c, state: State, size: Out<usize>) =>
        |i| { *size.get()? = i.serialize_state(state.key())?.len(); Ok(()) };
    fn fmi2SerializeFMUstate(c, state: State, bytes: Out<u8>, size: usize) =>
        |i| i.serialize_into(state.key(), bytes.slice(size)?);
    fn fmi2DeSerializeFMUstate(c, bytes: In<u8>, size: usize, state: Out<State>) =>
        |i| { let state = state.get()?; *state = State::of(i.deserialize_state(bytes.slice(size)?, state.key())?); Ok(()) };

    fn fmi2GetDirectionalDerivative(c, unknowns: In<u32>, n: usize, knowns: In<u32>, m: usize, seed: In<f64>, sensitivity: Out<f64>) =>
        |i| i.directional(unknowns.slice(n)?, knowns.slice(m)?, seed.slice(m)?, sensitivity.slice(n)?);

    fn fmi2EnterEventMode(c) => |i| i.enter_event_mode();
    fn fmi2NewDiscreteStates(c, info: Out<EventInfo2>) =>
        |i| { let info = info.get()?; *info = i.update_discrete()?.into(); Ok(()) };
    fn fmi2EnterContinuousTimeMode(c) => |i| i.enter_continuous_time_mode();
    fn fmi2CompletedIntegratorStep(c, no_set_state: i32, enter_event_mode: Out<Boolean2>, terminate: Out<Boolean2>) =>
        |i| { let flags = [enter_event_mode.get()?, terminate.get()?]; i.completed_integrator_step()?; flags.into_iter().for_each(|flag| *flag = Boolean2::FALSE); Ok(()) };
    fn fmi2SetTime(c, time: f64) => |i| i.set_time(time);
    fn fmi2SetContinuousStates(c, states: In<f64>, n: usize) => |i| i.set_states(states.slice(n)?);
    fn fmi2GetDerivatives(c, values: Out<f64>, n: usize) => |i| i.derivatives(values.slice(n)?);
    fn fmi2GetEventIndicators(c, values: Out<f64>, n: usize) => |i| i.event_indicators(values.slice(n)?);
    fn fmi2GetContinuousStates(c, values: Out<f64>, n: usize) => |i| i.states(values.slice(n)?);
    fn fmi2GetNominalsOfContinuousStates(c, values: Out<f64>, n: usize) => |i| i.nominals(values.slice(n)?);

    fn fmi2SetRealInputDerivatives(c, vr: In<u32>, n: usize, orders: In<i32>, values: In<f64>) =>
        |_| Err(Refusal::NotOffered("an input derivative"));
    fn fmi2GetRealOutputDerivatives(c, vr: In<u32>, n: usize, orders: In<i32>, values: Out<f64>) =>
        |_| Err(Refusal::NotOffered("an output derivative"));
    fn fmi2DoStep(c, t: f64, h: f64, no_set_state: i32) => |i| i.do_step(t, h);
    fn fmi2CancelStep(c) => |_| Err(Refusal::NotOffered("asynchronous stepping"));
    fn fmi2GetStatus(c, kind: i32, value: Out<i32>) => |i| i.no_status(kind);
    fn fmi2GetRealStatus(c, kind: i32, value: Out<f64>) =>
        |i| { *value.get()? = i.last_successful_time(kind)?; Ok(()) };
    fn fmi2GetIntegerStatus(c, kind: i32, value: Out<i32>) => |i| i.no_status(kind);
    fn fmi2GetBooleanStatus(c, kind: i32, value: Out<Boolean2>) =>
        |i| { let value = value.get()?; i.never_terminates(kind)?; *value = Boolean2::FALSE; Ok(()) };
    fn fmi2GetStringStatus(c, kind: i32, value: Out<Text>) => |i| i.no_status(kind);

            }
        };
    };
}
