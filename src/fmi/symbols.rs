//! [`export_fmus!`](crate::export_fmus): the C functions of FMI 2.0 and FMI 3.0 by name, as a library of models has them.

/// One C function per line, each forwarding to `export` or `export3`.
#[doc(hidden)]
#[macro_export]
macro_rules! __c_functions {
    ($($symbol:ident($($argument:ident: $type:ty),*) $(-> $result:ty)? = $body:expr;)*) => {$(
        #[unsafe(no_mangle)]
        #[allow(non_snake_case, missing_docs, clippy::missing_safety_doc, clippy::too_many_arguments)]
        pub unsafe extern "C" fn $symbol($($argument: $type),*) $(-> $result)? {
            // SAFETY: the master keeps to the standard.
            unsafe { $body }
        }
    )*};
}

/// Exports the named models as the functions of FMI 2.0 and FMI 3.0 of a crate of type `cdylib`: which of them an FMU is, its
/// description says.
///
/// ```text
/// latsch::export_fmus!(MyModel, AnotherModel);
/// latsch::export_fmus!(entries: &[Entry::of::<MyModel>()]); // a list that is made elsewhere
/// ```
#[macro_export]
macro_rules! export_fmus {
    ($($model:ty),+ $(,)?) => {
        $crate::export_fmus!(entries: &[$(Entry::of::<$model>()),+]);
    };
    (entries: $entries:expr) => {
        mod latsch_fmi {
            #[allow(unused_imports)]
            use super::*;
            use ::std::ffi::{c_int, c_void};
            use $crate::fmi::c::*;
            use $crate::fmi::export::{self, Sink};
            use $crate::fmi::export3;
            use $crate::fmi::{Entry, Function};

            const MODELS: &[Entry] = $entries;

            $crate::__c_functions! {
                latsch_models(sink: Sink, context: *mut c_void) = export::describe_models(MODELS, sink, context);
                fmi2GetTypesPlatform() -> Text = export::TYPES_PLATFORM.as_ptr();
                fmi2GetVersion() -> Text = export::FMI_VERSION.as_ptr();
                fmi2SetDebugLogging(c: Component, on: Boolean, n: usize, categories: *const Text) -> Status
                    = export::set_debug_logging(c, on, n, categories);
                fmi2Instantiate(name: Text, kind: c_int, guid: Text, location: Text, functions: *const CallbackFunctions, visible: Boolean, debug: Boolean) -> Component
                    = export::instantiate(MODELS, name, kind, guid, location, functions, visible, debug);
                fmi2FreeInstance(c: Component) = export::free_instance(c);
                fmi2SetupExperiment(c: Component, tolerance_defined: Boolean, tolerance: f64, start: f64, stop_defined: Boolean, stop: f64) -> Status
                    = export::setup_experiment(c, tolerance_defined, tolerance, start, stop_defined, stop);
                fmi2EnterInitializationMode(c: Component) -> Status = export::enter_initialization_mode(c);
                fmi2ExitInitializationMode(c: Component) -> Status = export::exit_initialization_mode(c);
                fmi2Terminate(c: Component) -> Status = export::terminate(c);
                fmi2Reset(c: Component) -> Status = export::reset(c);
                fmi2GetReal(c: Component, vr: *const ValueReference, n: usize, values: *mut f64) -> Status = export::get_real(c, vr, n, values, n);
                fmi2GetInteger(c: Component, vr: *const ValueReference, n: usize, values: *mut c_int) -> Status = export::get_integer(c, vr, n, values, n);
                fmi2GetBoolean(c: Component, vr: *const ValueReference, n: usize, values: *mut Boolean) -> Status = export::get_boolean(c, vr, n, values, n);
                fmi2GetString(c: Component, vr: *const ValueReference, n: usize, values: *mut Text) -> Status = export::get_string(c, vr, n, values, n);
                fmi2SetReal(c: Component, vr: *const ValueReference, n: usize, values: *const f64) -> Status = export::set_real(c, vr, n, values, n);
                fmi2SetInteger(c: Component, vr: *const ValueReference, n: usize, values: *const c_int) -> Status = export::set_integer(c, vr, n, values, n);
                fmi2SetBoolean(c: Component, vr: *const ValueReference, n: usize, values: *const Boolean) -> Status = export::set_boolean(c, vr, n, values, n);
                fmi2SetString(c: Component, vr: *const ValueReference, n: usize, values: *const Text) -> Status = export::set_string(c, vr, n, values, n);
                fmi2GetFMUstate(c: Component, state: *mut FmuState) -> Status = export::get_fmu_state(c, state);
                fmi2SetFMUstate(c: Component, state: FmuState) -> Status = export::set_fmu_state(c, state);
                fmi2FreeFMUstate(c: Component, state: *mut FmuState) -> Status = export::free_fmu_state(c, state);
                fmi2SerializedFMUstateSize(c: Component, state: FmuState, size: *mut usize) -> Status = export::serialized_fmu_state_size(c, state, size);
                fmi2SerializeFMUstate(c: Component, state: FmuState, bytes: *mut Byte, size: usize) -> Status = export::serialize_fmu_state(c, state, bytes, size);
                fmi2DeSerializeFMUstate(c: Component, bytes: *const Byte, size: usize, state: *mut FmuState) -> Status = export::deserialize_fmu_state(c, bytes, size, state);
                fmi2GetDirectionalDerivative(c: Component, unknowns: *const ValueReference, n_unknowns: usize, knowns: *const ValueReference, n_knowns: usize, seed: *const f64, values: *mut f64) -> Status
                    = export::get_directional_derivative(c, unknowns, n_unknowns, knowns, n_knowns, seed, n_knowns, values, n_unknowns);
                fmi2SetRealInputDerivatives(c: Component, vr: *const ValueReference, n: usize, orders: *const c_int, values: *const f64) -> Status
                    = export::set_real_input_derivatives(c, vr, n, orders, values);
                fmi2GetRealOutputDerivatives(c: Component, vr: *const ValueReference, n: usize, orders: *const c_int, values: *mut f64) -> Status
                    = export::get_real_output_derivatives(c, vr, n, orders, values, n);
                fmi2DoStep(c: Component, time: f64, length: f64, no_state_prior: Boolean) -> Status = export::do_step(c, time, length, no_state_prior);
                fmi2CancelStep(c: Component) -> Status = export::not_offered(c, Function::CancelStep);
                fmi2GetStatus(c: Component, _kind: c_int, value: *mut Status) -> Status
                    = export::no_status(c, Function::GetStatus, value);
                fmi2GetRealStatus(c: Component, kind: c_int, value: *mut f64) -> Status = export::get_real_status(c, kind, value);
                fmi2GetIntegerStatus(c: Component, _kind: c_int, value: *mut c_int) -> Status
                    = export::no_status(c, Function::GetIntegerStatus, value);
                fmi2GetBooleanStatus(c: Component, kind: c_int, value: *mut Boolean) -> Status = export::get_boolean_status(c, kind, value);
                fmi2GetStringStatus(c: Component, _kind: c_int, value: *mut Text) -> Status
                    = export::no_status(c, Function::GetStringStatus, value);
            }

            $crate::__c_functions! {
                fmi3GetVersion() -> Text = export3::FMI_VERSION.as_ptr();
                fmi3SetDebugLogging(c: Component, on: Boolean3, n: usize, categories: *const Text) -> Status
                    = export::set_debug_logging(c, on.into(), n, categories);
                fmi3InstantiateCoSimulation(name: Text, token: Text, resources: Text, _visible: Boolean3, debug: Boolean3, event_mode: Boolean3, _early_return: Boolean3, _intermediate: *const ValueReference, _n: usize, environment: *mut c_void, log: LogMessage, _update: IntermediateUpdate) -> Component
                    = export3::instantiate(MODELS, name, token, resources, debug, event_mode, environment, log);
                fmi3InstantiateModelExchange(name: Text, _token: Text, _resources: Text, _visible: Boolean3, _debug: Boolean3, environment: *mut c_void, log: LogMessage) -> Component
                    = export3::refuse_kind("fmi3InstantiateModelExchange", name, environment, log);
                fmi3InstantiateScheduledExecution(name: Text, _token: Text, _resources: Text, _visible: Boolean3, _debug: Boolean3, environment: *mut c_void, log: LogMessage, _clock: IntermediateUpdate, _lock: IntermediateUpdate, _unlock: IntermediateUpdate) -> Component
                    = export3::refuse_kind("fmi3InstantiateScheduledExecution", name, environment, log);
                fmi3FreeInstance(c: Component) = export::free_instance(c);
                fmi3EnterInitializationMode(c: Component, tolerance_defined: Boolean3, tolerance: f64, start: f64, stop_defined: Boolean3, stop: f64) -> Status
                    = export3::enter_initialization_mode(c, tolerance_defined, tolerance, start, stop_defined, stop);
                fmi3ExitInitializationMode(c: Component) -> Status = export::exit_initialization_mode(c);
                fmi3Terminate(c: Component) -> Status = export::terminate(c);
                fmi3Reset(c: Component) -> Status = export::reset(c);
                fmi3GetFloat64(c: Component, vr: *const ValueReference, n: usize, values: *mut f64, m: usize) -> Status = export::get_real(c, vr, n, values, m);
                fmi3GetInt32(c: Component, vr: *const ValueReference, n: usize, values: *mut i32, m: usize) -> Status = export::get_integer(c, vr, n, values, m);
                fmi3GetInt64(c: Component, vr: *const ValueReference, n: usize, values: *mut i64, m: usize) -> Status = export::get_enumeration(c, vr, n, values, m);
                fmi3GetBoolean(c: Component, vr: *const ValueReference, n: usize, values: *mut Boolean3, m: usize) -> Status = export::get_byte_boolean(c, vr, n, values, m);
                fmi3GetString(c: Component, vr: *const ValueReference, n: usize, values: *mut Text, m: usize) -> Status = export::get_string(c, vr, n, values, m);
                fmi3SetFloat64(c: Component, vr: *const ValueReference, n: usize, values: *const f64, m: usize) -> Status = export::set_real(c, vr, n, values, m);
                fmi3SetInt32(c: Component, vr: *const ValueReference, n: usize, values: *const i32, m: usize) -> Status = export::set_integer(c, vr, n, values, m);
                fmi3SetInt64(c: Component, vr: *const ValueReference, n: usize, values: *const i64, m: usize) -> Status = export::set_enumeration(c, vr, n, values, m);
                fmi3SetBoolean(c: Component, vr: *const ValueReference, n: usize, values: *const Boolean3, m: usize) -> Status = export::set_byte_boolean(c, vr, n, values, m);
                fmi3SetString(c: Component, vr: *const ValueReference, n: usize, values: *const Text, m: usize) -> Status = export::set_string(c, vr, n, values, m);
                fmi3GetFloat32(c: Component, _vr: *const ValueReference, n: usize, _values: *mut f32, _m: usize) -> Status = export3::no_variables(c, "fmi3GetFloat32", n);
                fmi3GetInt8(c: Component, _vr: *const ValueReference, n: usize, _values: *mut i8, _m: usize) -> Status = export3::no_variables(c, "fmi3GetInt8", n);
                fmi3GetUInt8(c: Component, _vr: *const ValueReference, n: usize, _values: *mut u8, _m: usize) -> Status = export3::no_variables(c, "fmi3GetUInt8", n);
                fmi3GetInt16(c: Component, _vr: *const ValueReference, n: usize, _values: *mut i16, _m: usize) -> Status = export3::no_variables(c, "fmi3GetInt16", n);
                fmi3GetUInt16(c: Component, _vr: *const ValueReference, n: usize, _values: *mut u16, _m: usize) -> Status = export3::no_variables(c, "fmi3GetUInt16", n);
                fmi3GetUInt32(c: Component, _vr: *const ValueReference, n: usize, _values: *mut u32, _m: usize) -> Status = export3::no_variables(c, "fmi3GetUInt32", n);
                fmi3GetUInt64(c: Component, _vr: *const ValueReference, n: usize, _values: *mut u64, _m: usize) -> Status = export3::no_variables(c, "fmi3GetUInt64", n);
                fmi3GetBinary(c: Component, _vr: *const ValueReference, n: usize, _sizes: *mut usize, _values: *mut *const u8, _m: usize) -> Status = export3::no_variables(c, "fmi3GetBinary", n);
                fmi3GetClock(c: Component, _vr: *const ValueReference, n: usize, _values: *mut Boolean3) -> Status = export3::no_variables(c, "fmi3GetClock", n);
                fmi3SetFloat32(c: Component, _vr: *const ValueReference, n: usize, _values: *const f32, _m: usize) -> Status = export3::no_variables(c, "fmi3SetFloat32", n);
                fmi3SetInt8(c: Component, _vr: *const ValueReference, n: usize, _values: *const i8, _m: usize) -> Status = export3::no_variables(c, "fmi3SetInt8", n);
                fmi3SetUInt8(c: Component, _vr: *const ValueReference, n: usize, _values: *const u8, _m: usize) -> Status = export3::no_variables(c, "fmi3SetUInt8", n);
                fmi3SetInt16(c: Component, _vr: *const ValueReference, n: usize, _values: *const i16, _m: usize) -> Status = export3::no_variables(c, "fmi3SetInt16", n);
                fmi3SetUInt16(c: Component, _vr: *const ValueReference, n: usize, _values: *const u16, _m: usize) -> Status = export3::no_variables(c, "fmi3SetUInt16", n);
                fmi3SetUInt32(c: Component, _vr: *const ValueReference, n: usize, _values: *const u32, _m: usize) -> Status = export3::no_variables(c, "fmi3SetUInt32", n);
                fmi3SetUInt64(c: Component, _vr: *const ValueReference, n: usize, _values: *const u64, _m: usize) -> Status = export3::no_variables(c, "fmi3SetUInt64", n);
                fmi3SetBinary(c: Component, _vr: *const ValueReference, n: usize, _sizes: *const usize, _values: *const *const u8, _m: usize) -> Status = export3::no_variables(c, "fmi3SetBinary", n);
                fmi3SetClock(c: Component, _vr: *const ValueReference, n: usize, _values: *const Boolean3) -> Status = export3::no_variables(c, "fmi3SetClock", n);
                fmi3GetFMUState(c: Component, state: *mut FmuState) -> Status = export::get_fmu_state(c, state);
                fmi3SetFMUState(c: Component, state: FmuState) -> Status = export::set_fmu_state(c, state);
                fmi3FreeFMUState(c: Component, state: *mut FmuState) -> Status = export::free_fmu_state(c, state);
                fmi3SerializedFMUStateSize(c: Component, state: FmuState, size: *mut usize) -> Status = export::serialized_fmu_state_size(c, state, size);
                fmi3SerializeFMUState(c: Component, state: FmuState, bytes: *mut u8, size: usize) -> Status = export::serialize_fmu_state(c, state, bytes.cast(), size);
                fmi3DeserializeFMUState(c: Component, bytes: *const u8, size: usize, state: *mut FmuState) -> Status = export::deserialize_fmu_state(c, bytes.cast(), size, state);
                fmi3GetDirectionalDerivative(c: Component, unknowns: *const ValueReference, n_unknowns: usize, knowns: *const ValueReference, n_knowns: usize, seed: *const f64, n_seed: usize, values: *mut f64, n_values: usize) -> Status
                    = export::get_directional_derivative(c, unknowns, n_unknowns, knowns, n_knowns, seed, n_seed, values, n_values);
                fmi3GetOutputDerivatives(c: Component, vr: *const ValueReference, n: usize, orders: *const i32, values: *mut f64, m: usize) -> Status
                    = export::get_real_output_derivatives(c, vr, n, orders, values, m);
                fmi3DoStep(c: Component, time: f64, length: f64, _no_state_prior: Boolean3, event: *mut Boolean3, end: *mut Boolean3, early: *mut Boolean3, reached: *mut f64) -> Status
                    = export3::do_step(c, time, length, [event, end, early], reached);
                fmi3GetNumberOfVariableDependencies(c: Component, _vr: ValueReference, _n: *mut usize) -> Status = export3::not_offered(c, "fmi3GetNumberOfVariableDependencies");
                fmi3GetVariableDependencies(c: Component, _dependent: ValueReference, _elements: *mut usize, _independents: *mut ValueReference, _of: *mut usize, _kinds: *mut c_int, _n: usize) -> Status = export3::not_offered(c, "fmi3GetVariableDependencies");
                fmi3GetAdjointDerivative(c: Component, _unknowns: *const ValueReference, _n: usize, _knowns: *const ValueReference, _m: usize, _seed: *const f64, _k: usize, _values: *mut f64, _l: usize) -> Status = export3::not_offered(c, "fmi3GetAdjointDerivative");
                fmi3EnterConfigurationMode(c: Component) -> Status = export3::not_offered(c, "fmi3EnterConfigurationMode");
                fmi3ExitConfigurationMode(c: Component) -> Status = export3::not_offered(c, "fmi3ExitConfigurationMode");
                fmi3EnterEventMode(c: Component) -> Status = export3::not_offered(c, "fmi3EnterEventMode");
                fmi3EnterStepMode(c: Component) -> Status = export3::not_offered(c, "fmi3EnterStepMode");
                fmi3EvaluateDiscreteStates(c: Component) -> Status = export3::not_offered(c, "fmi3EvaluateDiscreteStates");
                fmi3UpdateDiscreteStates(c: Component, _more: *mut Boolean3, _end: *mut Boolean3, _nominals: *mut Boolean3, _values: *mut Boolean3, _defined: *mut Boolean3, _time: *mut f64) -> Status = export3::not_offered(c, "fmi3UpdateDiscreteStates");
                fmi3GetIntervalDecimal(c: Component, _vr: *const ValueReference, _n: usize, _intervals: *mut f64, _qualifiers: *mut c_int) -> Status = export3::not_offered(c, "fmi3GetIntervalDecimal");
                fmi3GetIntervalFraction(c: Component, _vr: *const ValueReference, _n: usize, _counters: *mut u64, _resolutions: *mut u64, _qualifiers: *mut c_int) -> Status = export3::not_offered(c, "fmi3GetIntervalFraction");
                fmi3GetShiftDecimal(c: Component, _vr: *const ValueReference, _n: usize, _shifts: *mut f64) -> Status = export3::not_offered(c, "fmi3GetShiftDecimal");
                fmi3GetShiftFraction(c: Component, _vr: *const ValueReference, _n: usize, _counters: *mut u64, _resolutions: *mut u64) -> Status = export3::not_offered(c, "fmi3GetShiftFraction");
                fmi3SetIntervalDecimal(c: Component, _vr: *const ValueReference, _n: usize, _intervals: *const f64) -> Status = export3::not_offered(c, "fmi3SetIntervalDecimal");
                fmi3SetIntervalFraction(c: Component, _vr: *const ValueReference, _n: usize, _counters: *const u64, _resolutions: *const u64) -> Status = export3::not_offered(c, "fmi3SetIntervalFraction");
                fmi3SetShiftDecimal(c: Component, _vr: *const ValueReference, _n: usize, _shifts: *const f64) -> Status = export3::not_offered(c, "fmi3SetShiftDecimal");
                fmi3SetShiftFraction(c: Component, _vr: *const ValueReference, _n: usize, _counters: *const u64, _resolutions: *const u64) -> Status = export3::not_offered(c, "fmi3SetShiftFraction");
                fmi3EnterContinuousTimeMode(c: Component) -> Status = export3::not_offered(c, "fmi3EnterContinuousTimeMode");
                fmi3CompletedIntegratorStep(c: Component, _no_state_prior: Boolean3, _event: *mut Boolean3, _end: *mut Boolean3) -> Status = export3::not_offered(c, "fmi3CompletedIntegratorStep");
                fmi3SetTime(c: Component, _time: f64) -> Status = export3::not_offered(c, "fmi3SetTime");
                fmi3SetContinuousStates(c: Component, _states: *const f64, _n: usize) -> Status = export3::not_offered(c, "fmi3SetContinuousStates");
                fmi3GetContinuousStateDerivatives(c: Component, _derivatives: *mut f64, _n: usize) -> Status = export3::not_offered(c, "fmi3GetContinuousStateDerivatives");
                fmi3GetEventIndicators(c: Component, _indicators: *mut f64, _n: usize) -> Status = export3::not_offered(c, "fmi3GetEventIndicators");
                fmi3GetContinuousStates(c: Component, _states: *mut f64, _n: usize) -> Status = export3::not_offered(c, "fmi3GetContinuousStates");
                fmi3GetNominalsOfContinuousStates(c: Component, _nominals: *mut f64, _n: usize) -> Status = export3::not_offered(c, "fmi3GetNominalsOfContinuousStates");
                fmi3GetNumberOfEventIndicators(c: Component, _n: *mut usize) -> Status = export3::not_offered(c, "fmi3GetNumberOfEventIndicators");
                fmi3GetNumberOfContinuousStates(c: Component, _n: *mut usize) -> Status = export3::not_offered(c, "fmi3GetNumberOfContinuousStates");
                fmi3ActivateModelPartition(c: Component, _clock: ValueReference, _time: f64) -> Status = export3::not_offered(c, "fmi3ActivateModelPartition");
            }
        }
    };
}
