//! Which FMI function may be called when: the state machine of a co-simulation slave as a table.

/// Where an instance is (FMI 2.0.5, section 4.2.4). Steps are never asynchronous, so the states
/// `stepInProgress` and `stepCanceled` do not exist.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(u8)]
pub enum State {
    /// Made.
    Instantiated = 1,
    /// Between fmi2EnterInitializationMode and fmi2ExitInitializationMode.
    Initialization = 2,
    /// Ready for a step.
    StepComplete = 4,
    /// After fmi2Terminate.
    Terminated = 8,
    /// After a call that returned fmi2Error.
    Error = 16,
    /// After a call that returned fmi2Fatal: nothing but fmi2FreeInstance is possible.
    Fatal = 32,
}

impl State {
    /// The state with this number.
    pub fn from_number(number: u8) -> Option<Self> {
        [Self::Instantiated, Self::Initialization, Self::StepComplete, Self::Terminated, Self::Error]
            .into_iter()
            .find(|s| *s as u8 == number)
    }

    /// As part of a sentence.
    pub fn words(self) -> &'static str {
        match self {
            Self::Instantiated => "before initialization",
            Self::Initialization => "during initialization",
            Self::StepComplete => "between steps",
            Self::Terminated => "after fmi2Terminate",
            Self::Error => "after an error; only fmi2Reset, fmi2SetFMUstate and fmi2FreeInstance help",
            Self::Fatal => "after a fatal error; only fmi2FreeInstance is",
        }
    }
}

/// The functions that are bound to states.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[allow(missing_docs)] // the names are those of the standard, without fmi2
pub enum Function {
    SetDebugLogging,
    SetupExperiment,
    EnterInitializationMode,
    ExitInitializationMode,
    Terminate,
    Reset,
    GetReal,
    GetInteger,
    GetBoolean,
    GetString,
    SetReal,
    SetInteger,
    SetBoolean,
    SetString,
    GetFMUstate,
    SetFMUstate,
    FreeFMUstate,
    SerializedFMUstateSize,
    SerializeFMUstate,
    DeSerializeFMUstate,
    GetDirectionalDerivative,
    SetRealInputDerivatives,
    GetRealOutputDerivatives,
    DoStep,
    CancelStep,
    GetStatus,
    GetRealStatus,
    GetIntegerStatus,
    GetBooleanStatus,
    GetStringStatus,
}

const I: u8 = State::Instantiated as u8;
const N: u8 = State::Initialization as u8;
const C: u8 = State::StepComplete as u8;
const T: u8 = State::Terminated as u8;
const E: u8 = State::Error as u8;
const ALL: u8 = I | N | C | T | E;
const READ: u8 = N | C | T | E;
const WRITE: u8 = I | N | C;
const STATUS: u8 = C | T | E;

impl Function {
    /// The states in which the function may be called.
    fn states(self) -> u8 {
        use Function::*;
        match self {
            SetDebugLogging | Reset => ALL,
            SetupExperiment | EnterInitializationMode => I,
            ExitInitializationMode => N,
            Terminate | DoStep => C,
            GetReal | GetInteger | GetBoolean | GetString => READ,
            // Which variable may be set when is up to its causality and variability. Strictly, inputs have
            // to wait for initialization; FMPy sets their start values before, which does no harm.
            SetReal | SetInteger | SetBoolean | SetString => WRITE,
            SetRealInputDerivatives => N | C,
            GetDirectionalDerivative => N | C,
            GetRealOutputDerivatives => C,
            GetFMUstate
            | SetFMUstate
            | FreeFMUstate
            | SerializedFMUstateSize
            | SerializeFMUstate
            | DeSerializeFMUstate => ALL,
            // there is never a step in progress
            CancelStep => 0,
            GetStatus | GetRealStatus | GetIntegerStatus | GetBooleanStatus | GetStringStatus => STATUS,
        }
    }

    /// True when the function may be called in `state`.
    pub fn allowed_in(self, state: State) -> bool {
        self.states() & state as u8 != 0
    }
}
