//! Every C function of FMI 3.0 (standard 3.0.2, `fmi3Functions.h`): its arguments and the
//! instance's method that answers. The model has no clocks, no arrays, no strings.

/// Emits the functions for one model.
#[doc(hidden)]
#[macro_export]
macro_rules! fmi3_functions {
    ($model:ty) => {
        #[unsafe(no_mangle)]
        pub extern "C" fn fmi3GetVersion() -> *const ::std::ffi::c_char {
            c"3.0".as_ptr()
        }

        #[unsafe(no_mangle)]
        pub extern "C" fn fmi3FreeInstance(c: $crate::export::abi::Handle<$model>) {
            c.free();
        }

        const _: () = {
            use ::std::ffi::c_void;
            use $crate::export::abi::{
                Boolean3, Experiment, Handle, In, Interface, Logger3, Out, Refusal, State, Text,
                Version, instantiate3,
            };

            #[unsafe(no_mangle)]
            pub extern "C" fn fmi3InstantiateModelExchange(
                name: Text,
                token: Text,
                resources: Text,
                _visible: u8,
                logging: u8,
                environment: *mut c_void,
                logger: Option<Logger3>,
            ) -> Handle<$model> {
                let (texts, log) = ((name, token, resources), (environment, logger));
                let function = "fmi3InstantiateModelExchange";
                instantiate3(function, Ok(Interface::ModelExchange), texts, logging != 0, log)
            }

            #[unsafe(no_mangle)]
            pub extern "C" fn fmi3InstantiateCoSimulation(
                name: Text,
                token: Text,
                resources: Text,
                _visible: u8,
                logging: u8,
                event_mode_used: u8,
                _early_return_allowed: u8,
                _intermediate: In<u32>,
                _n_intermediate: usize,
                environment: *mut c_void,
                logger: Option<Logger3>,
                _intermediate_update: *const c_void,
            ) -> Handle<$model> {
                let (texts, log) = ((name, token, resources), (environment, logger));
                let interface = match event_mode_used {
                    0 => Ok(Interface::CoSimulation),
                    _ => Err(Refusal::NotOffered("event mode in Co-Simulation")),
                };
                instantiate3("fmi3InstantiateCoSimulation", interface, texts, logging != 0, log)
            }

            #[unsafe(no_mangle)]
            pub extern "C" fn fmi3InstantiateScheduledExecution(
                name: Text,
                token: Text,
                resources: Text,
                _visible: u8,
                logging: u8,
                environment: *mut c_void,
                logger: Option<Logger3>,
                _clock_update: *const c_void,
                _lock_preemption: *const c_void,
                _unlock_preemption: *const c_void,
            ) -> Handle<$model> {
                let (texts, log) = ((name, token, resources), (environment, logger));
                let function = "fmi3InstantiateScheduledExecution";
                let interface = Err(Refusal::NotOffered("Scheduled Execution"));
                instantiate3(function, interface, texts, logging != 0, log)
            }

            $crate::fmi_functions! { Version::Three, $model;

    fn fmi3SetDebugLogging(c, on: u8, n: usize, categories: In<Text>) =>
        |i| i.set_debug_logging(on != 0, &categories.texts(n)?);
    fn fmi3EnterInitializationMode(c, has_tolerance: u8, tolerance: f64, start: f64, has_stop: u8, stop: f64) =>
        |i| {
            i.setup_experiment(Experiment::new((has_tolerance != 0).then_some(tolerance), start, (has_stop != 0).then_some(stop)))?;
            i.enter_initialization()
        };
    fn fmi3ExitInitializationMode(c) => |i| i.exit_initialization();
    fn fmi3Terminate(c) => |i| i.terminate();
    fn fmi3Reset(c) => |i| i.reset();

    fn fmi3GetFloat64(c, vr: In<u32>, n: usize, values: Out<f64>, m: usize) => |i| i.get(vr.slice(n)?, values.slice(m)?);
    fn fmi3GetInt32(c, vr: In<u32>, n: usize, values: Out<i32>, m: usize) => |i| i.get(vr.slice(n)?, values.slice(m)?);
    fn fmi3GetBoolean(c, vr: In<u32>, n: usize, values: Out<Boolean3>, m: usize) => |i| i.get(vr.slice(n)?, values.slice(m)?);
    fn fmi3SetFloat64(c, vr: In<u32>, n: usize, values: In<f64>, m: usize) => |i| i.set(vr.slice(n)?, values.slice(m)?);
    fn fmi3SetInt32(c, vr: In<u32>, n: usize, values: In<i32>, m: usize) => |i| i.set(vr.slice(n)?, values.slice(m)?);
    fn fmi3SetBoolean(c, vr: In<u32>, n: usize, values: In<Boolean3>, m: usize) => |i| i.set(vr.slice(n)?, values.slice(m)?);

    fn fmi3GetFloat32(c, vr: In<u32>, n: usize, values: Out<f32>, m: usize) => |i| i.no_such_type("Float32", vr.slice(n)?);
    fn fmi3GetInt8(c, vr: In<u32>, n: usize, values: Out<i8>, m: usize) => |i| i.no_such_type("Int8", vr.slice(n)?);
    fn fmi3GetUInt8(c, vr: In<u32>, n: usize, values: Out<u8>, m: usize) => |i| i.no_such_type("UInt8", vr.slice(n)?);
    fn fmi3GetInt16(c, vr: In<u32>, n: usize, values: Out<i16>, m: usize) => |i| i.no_such_type("Int16", vr.slice(n)?);
    fn fmi3GetUInt16(c, vr: In<u32>, n: usize, values: Out<u16>, m: usize) => |i| i.no_such_type("UInt16", vr.slice(n)?);
    fn fmi3GetUInt32(c, vr: In<u32>, n: usize, values: Out<u32>, m: usize) => |i| i.no_such_type("UInt32", vr.slice(n)?);
    fn fmi3GetInt64(c, vr: In<u32>, n: usize, values: Out<i64>, m: usize) => |i| i.no_such_type("Int64", vr.slice(n)?);
    fn fmi3GetUInt64(c, vr: In<u32>, n: usize, values: Out<u64>, m: usize) => |i| i.no_such_type("UInt64", vr.slice(n)?);
    fn fmi3GetString(c, vr: In<u32>, n: usize, values: Out<Text>, m: usize) => |i| i.no_such_type("String", vr.slice(n)?);
    fn fmi3GetBinary(c, vr: In<u32>, n: usize, sizes: Out<usize>, values: Out<In<u8>>, m: usize) => |i| i.no_such_type("Binary", vr.slice(n)?);
    fn fmi3GetClock(c, vr: In<u32>, n: usize, values: Out<u8>) => |i| i.no_such_type("Clock", vr.slice(n)?);
    fn fmi3SetFloat32(c, vr: In<u32>, n: usize, values: In<f32>, m: usize) => |i| i.no_such_type("Float32", vr.slice(n)?);
    fn fmi3SetInt8(c, vr: In<u32>, n: usize, values: In<i8>, m: usize) => |i| i.no_such_type("Int8", vr.slice(n)?);
    fn fmi3SetUInt8(c, vr: In<u32>, n: usize, values: In<u8>, m: usize) => |i| i.no_such_type("UInt8", vr.slice(n)?);
    fn fmi3SetInt16(c, vr: In<u32>, n: usize, values: In<i16>, m: usize) => |i| i.no_such_type("Int16", vr.slice(n)?);
    fn fmi3SetUInt16(c, vr: In<u32>, n: usize, values: In<u16>, m: usize) => |i| i.no_such_type("UInt16", vr.slice(n)?);
    fn fmi3SetUInt32(c, vr: In<u32>, n: usize, values: In<u32>, m: usize) => |i| i.no_such_type("UInt32", vr.slice(n)?);
    fn fmi3SetInt64(c, vr: In<u32>, n: usize, values: In<i64>, m: usize) => |i| i.no_such_type("Int64", vr.slice(n)?);
    fn fmi3SetUInt64(c, vr: In<u32>, n: usize, values: In<u64>, m: usize) => |i| i.no_such_type("UInt64", vr.slice(n)?);
    fn fmi3SetString(c, vr: In<u32>, n: usize, values: In<Text>, m: usize) => |i| i.no_such_type("String", vr.slice(n)?);
    fn fmi3SetBinary(c, vr: In<u32>, n: usize, sizes: In<usize>, values: In<In<u8>>, m: usize) => |i| i.no_such_type("Binary", vr.slice(n)?);
    fn fmi3SetClock(c, vr: In<u32>, n: usize, values: In<u8>) => |i| i.no_such_type("Clock", vr.slice(n)?);

    fn fmi3GetNumberOfVariableDependencies(c, vr: u32, n: Out<usize>) =>
        |_| Err(Refusal::NotOffered("a dependency of single elements"));
    fn fmi3GetVariableDependencies(c, vr: u32, elements: Out<usize>, independents: Out<u32>, their_elements: Out<usize>, kinds: Out<i32>, n: usize) =>
        |_| Err(Refusal::NotOffered("a dependency of single elements"));

    fn fmi3GetFMUState(c, state: Out<State>) =>
        |i| { let state = state.get()?; *state = State::of(i.save_state(state.key())?); Ok(()) };
    fn fmi3SetFMUState(c, state: State) => |i| i.restore_state(state.key());
    fn fmi3FreeFMUState(c, state: Out<State>) =>
        |i| { let state = state.get()?; i.free_state(state.key())?; *state = State::of(0); Ok(()) };
    fn fmi3SerializedFMUStateSize(c, state: State, size: Out<usize>) =>
        |i| { *size.get()? = i.serialize_state(state.key())?.len(); Ok(()) };
    fn fmi3SerializeFMUState(c, state: State, bytes: Out<u8>, size: usize) =>
        |i| i.serialize_into(state.key(), bytes.slice(size)?);
    fn fmi3DeserializeFMUState(c, bytes: In<u8>, size: usize, state: Out<State>) =>
        |i| { let state = state.get()?; *state = State::of(i.deserialize_state(bytes.slice(size)?, state.key())?); Ok(()) };

    fn fmi3GetDirectionalDerivative(c, unknowns: In<u32>, n: usize, knowns: In<u32>, m: usize, seed: In<f64>, n_seed: usize, sensitivity: Out<f64>, n_sensitivity: usize) =>
        |i| i.directional(unknowns.slice(n)?, knowns.slice(m)?, seed.slice(n_seed)?, sensitivity.slice(n_sensitivity)?);
    fn fmi3GetAdjointDerivative(c, unknowns: In<u32>, n: usize, knowns: In<u32>, m: usize, seed: In<f64>, n_seed: usize, sensitivity: Out<f64>, n_sensitivity: usize) =>
        |i| i.adjoint(unknowns.slice(n)?, knowns.slice(m)?, seed.slice(n_seed)?, sensitivity.slice(n_sensitivity)?);

    fn fmi3EnterConfigurationMode(c) => |_| Err(Refusal::NotOffered("a structural parameter"));
    fn fmi3ExitConfigurationMode(c) => |_| Err(Refusal::NotOffered("a structural parameter"));

    fn fmi3GetIntervalDecimal(c, vr: In<u32>, n: usize, intervals: Out<f64>, qualifiers: Out<i32>) => |i| i.no_such_type("Clock", vr.slice(n)?);
    fn fmi3GetIntervalFraction(c, vr: In<u32>, n: usize, counters: Out<u64>, resolutions: Out<u64>, qualifiers: Out<i32>) => |i| i.no_such_type("Clock", vr.slice(n)?);
    fn fmi3GetShiftDecimal(c, vr: In<u32>, n: usize, shifts: Out<f64>) => |i| i.no_such_type("Clock", vr.slice(n)?);
    fn fmi3GetShiftFraction(c, vr: In<u32>, n: usize, counters: Out<u64>, resolutions: Out<u64>) => |i| i.no_such_type("Clock", vr.slice(n)?);
    fn fmi3SetIntervalDecimal(c, vr: In<u32>, n: usize, intervals: In<f64>) => |i| i.no_such_type("Clock", vr.slice(n)?);
    fn fmi3SetIntervalFraction(c, vr: In<u32>, n: usize, counters: In<u64>, resolutions: In<u64>) => |i| i.no_such_type("Clock", vr.slice(n)?);
    fn fmi3SetShiftDecimal(c, vr: In<u32>, n: usize, shifts: In<f64>) => |i| i.no_such_type("Clock", vr.slice(n)?);
    fn fmi3SetShiftFraction(c, vr: In<u32>, n: usize, counters: In<u64>, resolutions: In<u64>) => |i| i.no_such_type("Clock", vr.slice(n)?);
    fn fmi3EvaluateDiscreteStates(c) => |_| Err(Refusal::NotOffered("fmi3EvaluateDiscreteStates"));
    fn fmi3ActivateModelPartition(c, clock: u32, time: f64) => |_| Err(Refusal::NotOffered("Scheduled Execution"));

    fn fmi3EnterEventMode(c) => |i| i.enter_event_mode();
    fn fmi3UpdateDiscreteStates(c, again: Out<Boolean3>, terminate: Out<Boolean3>, nominals: Out<Boolean3>, values: Out<Boolean3>, defined: Out<Boolean3>, time: Out<f64>) =>
        |i| {
            let (flags, time) = ([again.get()?, terminate.get()?, nominals.get()?, values.get()?, defined.get()?], time.get()?);
            let update = i.update_discrete()?;
            *time = update.next_event.unwrap_or(0.0);
            let reported = [update.again, false, false, update.states_changed, update.next_event.is_some()];
            flags.into_iter().zip(reported).for_each(|(flag, value)| *flag = value.into());
            Ok(())
        };
    fn fmi3EnterContinuousTimeMode(c) => |i| i.enter_continuous_time_mode();
    fn fmi3CompletedIntegratorStep(c, no_set_state: u8, enter_event_mode: Out<Boolean3>, terminate: Out<Boolean3>) =>
        |i| { let flags = [enter_event_mode.get()?, terminate.get()?]; i.completed_integrator_step()?; flags.into_iter().for_each(|flag| *flag = false.into()); Ok(()) };
    fn fmi3SetTime(c, time: f64) => |i| i.set_time(time);
    fn fmi3SetContinuousStates(c, states: In<f64>, n: usize) => |i| i.set_states(states.slice(n)?);
    fn fmi3GetContinuousStateDerivatives(c, values: Out<f64>, n: usize) => |i| i.derivatives(values.slice(n)?);
    fn fmi3GetEventIndicators(c, values: Out<f64>, n: usize) => |i| i.event_indicators(values.slice(n)?);
    fn fmi3GetContinuousStates(c, values: Out<f64>, n: usize) => |i| i.states(values.slice(n)?);
    fn fmi3GetNominalsOfContinuousStates(c, values: Out<f64>, n: usize) => |i| i.nominals(values.slice(n)?);
    fn fmi3GetNumberOfEventIndicators(c, n: Out<usize>) => |i| { *n.get()? = i.counts()?.1; Ok(()) };
    fn fmi3GetNumberOfContinuousStates(c, n: Out<usize>) => |i| { *n.get()? = i.counts()?.0; Ok(()) };

    fn fmi3EnterStepMode(c) => |_| Err(Refusal::NotOffered("event mode in Co-Simulation"));
    fn fmi3GetOutputDerivatives(c, vr: In<u32>, n: usize, orders: In<i32>, values: Out<f64>, m: usize) =>
        |_| Err(Refusal::NotOffered("an output derivative"));
    fn fmi3DoStep(c, t: f64, h: f64, no_set_state: u8, event_needed: Out<Boolean3>, terminate: Out<Boolean3>, early_return: Out<Boolean3>, last_time: Out<f64>) =>
        |i| {
            let (flags, last_time) = ([event_needed.get()?, terminate.get()?, early_return.get()?], last_time.get()?);
            flags.into_iter().for_each(|flag| *flag = false.into());
            let done = i.do_step(t, h);
            *last_time = i.time();
            done
        };

            }
        };
    };
}
