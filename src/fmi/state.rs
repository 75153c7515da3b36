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
    /// After a call that returned fmi2Fatal: nothing is possible. (fmi2FreeInstance, which the standard does
    /// not allow either, does no harm.)
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
            Self::Fatal => "after a fatal error: nothing is any more",
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
            SetReal | SetInteger | SetBoolean | SetString | SetRealInputDerivatives => WRITE,
            // After an error what is read is for debugging only.
            GetDirectionalDerivative => READ,
            // during initialization nothing has moved yet
            GetRealOutputDerivatives => C | T | E,
            GetFMUstate
            | SetFMUstate
            | FreeFMUstate
            | SerializedFMUstateSize
            | SerializeFMUstate
            | DeSerializeFMUstate => ALL,
            // there is never a step in progress
            CancelStep => 0,
            // They ask how a step went that was discarded or is in progress, not what an error left.
            GetStatus | GetRealStatus | GetIntegerStatus | GetBooleanStatus | GetStringStatus => C | T,
        }
    }

    /// True when the function may be called in `state`.
    pub fn allowed_in(self, state: State) -> bool {
        self.states() & state as u8 != 0
    }
}

#[cfg(test)]
mod tests {
    use super::Function::{self, *};
    use super::State;

    /// The table of FMI 2.0.5, section 4.2.4, for the states that a slave without asynchronous steps and
    /// without discarded ones has. `x` and the numbers of notes are calls that are allowed; the notes are about
    /// which variables and what values are worth.
    /// Columns: instantiated, Initialization Mode, stepComplete, terminated, error, fatal.
    const TABLE: &[(Function, &str)] = &[
        (SetDebugLogging, "x x x x x ."),
        (SetupExperiment, "x . . . . ."),
        (EnterInitializationMode, "x . . . . ."),
        (ExitInitializationMode, ". x . . . ."),
        (Terminate, ". . x . . ."),
        (Reset, "x x x x x ."),
        (GetReal, ". 2 x x 7 ."),
        (GetInteger, ". 2 x x 7 ."),
        (GetBoolean, ". 2 x x 7 ."),
        (GetString, ". 2 x x 7 ."),
        (SetReal, "1 3 6 . . ."),
        (SetInteger, "1 3 6 . . ."),
        (SetBoolean, "1 3 6 . . ."),
        (SetString, "1 3 6 . . ."),
        (GetFMUstate, "x x x x 7 ."),
        (SetFMUstate, "x x x x x ."),
        (FreeFMUstate, "x x x x x ."),
        (SerializedFMUstateSize, "x x x x x ."),
        (SerializeFMUstate, "x x x x x ."),
        (DeSerializeFMUstate, "x x x x x ."),
        (GetDirectionalDerivative, ". x x x 7 ."),
        (SetRealInputDerivatives, "x x x . . ."),
        (GetRealOutputDerivatives, ". . x x 7 ."),
        (DoStep, ". . x . . ."),
        (CancelStep, ". . . . . ."),
        (GetStatus, ". . x x . ."),
        (GetRealStatus, ". . x x . ."),
        (GetIntegerStatus, ". . x x . ."),
        (GetBooleanStatus, ". . x x . ."),
        (GetStringStatus, ". . x x . ."),
    ];

    const STATES: [State; 6] = [
        State::Instantiated,
        State::Initialization,
        State::StepComplete,
        State::Terminated,
        State::Error,
        State::Fatal,
    ];

    #[test]
    fn calls_are_legal_when_the_standard_says_so() {
        // every function is in the table: GetStringStatus is the last
        assert_eq!(TABLE.len(), GetStringStatus as usize + 1);
        for (number, (function, row)) in TABLE.iter().enumerate() {
            assert!(TABLE[..number].iter().all(|(other, _)| other != function), "{function:?} twice");
            let marks: Vec<&str> = row.split(' ').collect();
            assert_eq!(marks.len(), STATES.len(), "{function:?}");
            for (state, mark) in STATES.iter().zip(marks) {
                assert_eq!(function.allowed_in(*state), mark != ".", "{function:?} in {state:?}");
            }
        }
    }
}
