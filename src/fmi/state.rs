//! Which FMI function may be called when: the state machine of a co-simulation slave as a table. It is that of FMI 2.0; that of
//! FMI 3.0 has the same states and calls for a slave without Event Mode.

use super::c::Fmi;

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

    /// As part of a sentence, with the names of a version of the standard.
    pub fn words(self, fmi: Fmi) -> String {
        let name = |function: Function| function.name(fmi);
        match self {
            Self::Instantiated => "before initialization".into(),
            Self::Initialization => "during initialization".into(),
            Self::StepComplete => "between steps".into(),
            Self::Terminated => format!("after {}", name(Function::Terminate)),
            Self::Error => format!(
                "after an error; only {}, {} and {}FreeInstance help",
                name(Function::Reset),
                name(Function::SetFMUstate),
                fmi.prefix()
            ),
            Self::Fatal => "after a fatal error: nothing is any more".into(),
        }
    }
}

/// The functions that are bound to states.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[allow(missing_docs)] // the names are those of FMI 2.0, without fmi2
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
    /// One that only FMI 3.0 has, and that is refused: the error names it.
    NotOffered,
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
    /// The name that it has in a version of the standard.
    pub fn name(self, fmi: Fmi) -> String {
        let own = format!("{self:?}");
        match fmi {
            Fmi::Three if self == Self::NotOffered => "a function of FMI 3.0".into(),
            Fmi::Three => {
                let renamed = own
                    .replace("GetRealOutputDerivatives", "GetOutputDerivatives")
                    .replace("Real", "Float64")
                    .replace("Integer", "Int32")
                    .replace("FMUstate", "FMUState")
                    .replace("DeSerialize", "Deserialize");
                fmi.prefix().to_owned() + &renamed
            }
            Fmi::Two => fmi.prefix().to_owned() + &own,
        }
    }

    /// The states in which the function may be called.
    fn states(self) -> u8 {
        use Function::*;
        match self {
            SetDebugLogging | Reset | NotOffered => ALL,
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
    use super::{Fmi, State};

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
        (NotOffered, "x x x x x ."),
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
        // every function is in the table: NotOffered is the last
        assert_eq!(TABLE.len(), NotOffered as usize + 1);
        for (number, (function, row)) in TABLE.iter().enumerate() {
            assert!(TABLE[..number].iter().all(|(other, _)| other != function), "{function:?} twice");
            let marks: Vec<&str> = row.split(' ').collect();
            assert_eq!(marks.len(), STATES.len(), "{function:?}");
            for (state, mark) in STATES.iter().zip(marks) {
                assert_eq!(function.allowed_in(*state), mark != ".", "{function:?} in {state:?}");
            }
        }
    }

    #[test]
    fn functions_have_the_names_of_each_version() {
        for (function, two, three) in [
            (DoStep, "fmi2DoStep", "fmi3DoStep"),
            (GetReal, "fmi2GetReal", "fmi3GetFloat64"),
            (SetInteger, "fmi2SetInteger", "fmi3SetInt32"),
            (GetRealOutputDerivatives, "fmi2GetRealOutputDerivatives", "fmi3GetOutputDerivatives"),
            (SerializedFMUstateSize, "fmi2SerializedFMUstateSize", "fmi3SerializedFMUStateSize"),
            (DeSerializeFMUstate, "fmi2DeSerializeFMUstate", "fmi3DeserializeFMUState"),
        ] {
            assert_eq!((function.name(Fmi::Two).as_str(), function.name(Fmi::Three).as_str()), (two, three));
        }
    }
}
