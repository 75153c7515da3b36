//! An instance of an FMU: a slave behind FMI's state machine, types and messages. Safe Rust; the
//! pointers are dealt with in `export` and `export3`.

use super::c::{Fmi, Status};
use super::entry::Entry;
use super::log::{Log, Master};
use super::make::make;
use super::resources::model_file;
use super::state::{Function, State};
use crate::model::{Interface, Kind, Slave, Snapshot, check_experiment, reference};
use crate::{Error, Result};
use std::ffi::{CStr, CString};

/// What a master holds a pointer to.
pub struct Instance {
    slave: Box<dyn Slave>,
    state: State,
    log: Log,
    /// What an FMU that this one carries has to say.
    carried: Option<std::sync::Arc<super::import::log::Log>>,
    /// Value references, sorted, with the indices of their variables.
    references: Vec<(u32, usize)>,
    /// That of the time, which FMI 3.0 has as a variable.
    time_reference: Option<u32>,
    experiment: Option<(f64, Option<f64>)>,
    /// End of the last step \[s\].
    time: f64,
    /// Texts handed out by the last fmi2GetString.
    texts: Vec<CString>,
}

/// A saved state as a master holds it.
pub struct Saved {
    state: State,
    experiment: Option<(f64, Option<f64>)>,
    time: f64,
    snapshot: Snapshot,
}

impl Instance {
    /// The model that the resources name, if the GUID is that of its description.
    ///
    /// # Errors
    /// Resources that cannot be read or are of another version, an unknown model, another GUID.
    pub fn new(
        models: &[Entry],
        name: &CStr,
        expected_guid: &str,
        location: Option<&str>,
        master: Master,
        debug: bool,
    ) -> Result<Self> {
        let (resources, text) = model_file(location)?;
        let made = make(models, &resources, &text)?;
        if expected_guid != made.guid {
            return Err(Error::fmu(format!(
                "the GUID {expected_guid} is not that of this FMU, {}: the description, the resources and the binary do not belong together",
                made.guid
            )));
        }
        let time = (master.fmi() == Fmi::Three).then(|| time_variable(made.slave.interface()));
        let variables = made.slave.interface().variables.iter();
        let mut references: Vec<(u32, usize)> =
            variables.enumerate().map(|(index, v)| (reference(&v.name), index)).collect();
        references.sort_unstable();
        Ok(Self {
            slave: made.slave,
            references,
            time_reference: time.map(|(_, reference)| reference),
            state: State::Instantiated,
            log: Log::new(master, name, debug),
            carried: made.messages,
            experiment: None,
            time: 0.0,
            texts: Vec::new(),
        })
    }

    /// What it runs, and its messages: to end it and still have a say.
    pub fn take_apart(self) -> (Box<dyn Slave>, Log) {
        (self.slave, self.log)
    }

    /// Begins a call of an FMI function.
    pub fn enter(&mut self) {
        self.log.enter();
    }

    /// Ends it.
    pub fn leave(&mut self) {
        self.log.leave();
    }

    /// Runs `body` if `function` may be called now. An error is told to the master and leaves the
    /// instance in the error state, as the standard has it.
    pub fn call(&mut self, function: Function, body: impl FnOnce(&mut Self) -> Result<()>) -> Status {
        let result = if function.allowed_in(self.state) {
            body(self)
        } else if function == Function::CancelStep {
            Err(Error::call("no step is in progress: steps of this FMU are never asynchronous"))
        } else {
            Err(Error::call(format!("not possible {}", self.state.words(self.log.fmi()))))
        };
        self.pass_on();
        match result {
            Ok(()) => Status::Ok,
            Err(error) if self.state == State::Fatal => {
                self.fatal(&format!("{}: {error}", self.name(function)))
            }
            Err(error) => self.fail(function, &error),
        }
    }

    /// What the master calls a function.
    pub fn name(&self, function: Function) -> String {
        function.name(self.log.fmi())
    }

    /// Passes on what a carried FMU said in this call. Why a call failed is in our own message already.
    fn pass_on(&self) {
        for message in self.carried.iter().flat_map(|log| log.drain()) {
            match message.status {
                0 => self.log.event(&message.text),
                1 => self.log.warning(&message.text),
                _ => {}
            }
        }
    }

    /// Tells the master that a question has no answer.
    pub fn discard(&mut self, function: Function) {
        let message =
            format!("{}: there is no such status: steps are never asynchronous", self.name(function));
        self.log.error(Status::Discard, &message);
    }

    /// Tells the master of an error.
    pub fn fail(&mut self, function: Function, error: &Error) -> Status {
        self.log.error(Status::Error, &format!("{}: {error}", self.name(function)));
        self.state = State::Error;
        Status::Error
    }

    /// Tells the master that nothing helps any more.
    pub fn fatal(&mut self, message: &str) -> Status {
        self.log.error(Status::Fatal, message);
        self.state = State::Fatal;
        Status::Fatal
    }

    /// fmi2SetDebugLogging.
    pub fn set_debug_logging(&mut self, on: bool, categories: &[&str]) -> Result<()> {
        self.log.set_categories(on, categories).map_err(Error::call)
    }

    /// fmi2SetupExperiment.
    pub fn setup_experiment(&mut self, tolerance: Option<f64>, start: f64, stop: Option<f64>) -> Result<()> {
        if let Some(tolerance) = tolerance
            && !(tolerance.is_finite() && tolerance > 0.0)
        {
            return Err(Error::call(format!("the tolerance {tolerance} is not a positive number")));
        }
        check_experiment(start, stop)?;
        self.experiment = Some((start, stop));
        Ok(())
    }

    /// fmi2EnterInitializationMode.
    pub fn enter_initialization(&mut self) -> Result<()> {
        let Some((start, stop)) = self.experiment else {
            return Err(Error::call("fmi2SetupExperiment has to be called first"));
        };
        self.slave.start(start, stop)?;
        self.time = start;
        self.state = State::Initialization;
        self.log.event(&format!("initialization at {start} s"));
        Ok(())
    }

    /// fmi2ExitInitializationMode.
    pub fn exit_initialization(&mut self) -> Result<()> {
        self.slave.finish_start()?;
        self.state = State::StepComplete;
        self.log.event("initialized");
        if let Some(warning) = self.slave.warning() {
            self.log.warning(&warning);
        }
        Ok(())
    }

    /// fmi2Terminate.
    pub fn terminate(&mut self) -> Result<()> {
        self.state = State::Terminated;
        self.log.event("terminated");
        Ok(())
    }

    /// fmi2Reset.
    pub fn reset(&mut self) -> Result<()> {
        self.slave.reset()?;
        self.experiment = None;
        self.time = 0.0;
        self.state = State::Instantiated;
        self.log.event("reset");
        Ok(())
    }

    /// Index of the variable with this value reference, which has to be of one of these types.
    fn variable(&self, reference: u32, of_type: &str, fits: impl Fn(&Kind) -> bool) -> Result<usize> {
        let found = self.references.binary_search_by_key(&reference, |(number, _)| *number).ok();
        let index = found.map(|at| self.references[at].1);
        match index.map(|index| (index, &self.slave.interface().variables[index])) {
            None => Err(Error::variable(format!(
                "there is no variable with the value reference {reference}; modelDescription.xml has those that are there"
            ))),
            Some((_, v)) if !fits(&v.kind) => {
                Err(Error::variable(format!("{} (value reference {reference}) is not {of_type}", v.name)))
            }
            Some((index, _)) => Ok(index),
        }
    }

    fn real(&self, reference: u32) -> Result<usize> {
        let words = self.word("a Real", "a Float64");
        self.variable(reference, words, |k| *k == Kind::Real)
    }

    /// In FMI 3.0, enumerations have functions of their own.
    fn integer(&self, reference: u32) -> Result<usize> {
        let is_three = self.log.fmi() == Fmi::Three;
        self.variable(reference, self.word("an Integer or Enumeration", "an Int32"), |k| {
            *k == Kind::Integer || !is_three && matches!(k, Kind::Enumeration(_))
        })
    }

    fn enumeration(&self, reference: u32) -> Result<usize> {
        self.variable(reference, "an Enumeration", |k| matches!(k, Kind::Enumeration(_)))
    }

    fn word<'a>(&self, two: &'a str, three: &'a str) -> &'a str {
        match self.log.fmi() {
            Fmi::Two => two,
            Fmi::Three => three,
        }
    }

    fn boolean(&self, reference: u32) -> Result<usize> {
        self.variable(reference, "a Boolean", |k| *k == Kind::Boolean)
    }

    fn text(&self, reference: u32) -> Result<usize> {
        self.variable(reference, "a String", |k| *k == Kind::Text)
    }

    /// fmi2GetReal for one variable.
    pub fn get_real(&mut self, reference: u32) -> Result<f64> {
        if self.time_reference == Some(reference) {
            return Ok(self.time);
        }
        let index = self.real(reference)?;
        self.slave.get(index)
    }

    /// fmi2GetInteger for one variable.
    pub fn get_integer(&mut self, reference: u32) -> Result<i32> {
        let index = self.integer(reference)?;
        Ok(self.slave.get(index)? as i32)
    }

    /// fmi3GetInt64 for one variable.
    pub fn get_enumeration(&mut self, reference: u32) -> Result<i64> {
        let index = self.enumeration(reference)?;
        Ok(self.slave.get(index)? as i64)
    }

    /// fmi2GetBoolean for one variable.
    pub fn get_boolean(&mut self, reference: u32) -> Result<bool> {
        let index = self.boolean(reference)?;
        Ok(self.slave.get(index)? != 0.0)
    }

    /// fmi2GetString: the texts live until the next call.
    pub fn get_texts(&mut self, references: &[u32]) -> Result<&[CString]> {
        let mut texts = Vec::with_capacity(references.len());
        for reference in references {
            let index = self.text(*reference)?;
            let text = self.slave.text(index)?;
            texts.push(CString::new(text).map_err(|_| Error::variable("a text holds a zero byte"))?);
        }
        self.texts = texts;
        Ok(&self.texts)
    }

    /// fmi2SetReal for one variable.
    pub fn set_real(&mut self, reference: u32, value: f64) -> Result<()> {
        let index = self.real(reference)?;
        self.slave.set(index, value)
    }

    /// fmi2SetInteger for one variable.
    pub fn set_integer(&mut self, reference: u32, value: i32) -> Result<()> {
        let index = self.integer(reference)?;
        self.slave.set(index, f64::from(value))
    }

    /// fmi3SetInt64 for one variable.
    pub fn set_enumeration(&mut self, reference: u32, value: i64) -> Result<()> {
        let index = self.enumeration(reference)?;
        self.slave.set(index, value as f64)
    }

    /// fmi2SetBoolean for one variable.
    pub fn set_boolean(&mut self, reference: u32, value: i32) -> Result<()> {
        let index = self.boolean(reference)?;
        self.slave.set(index, f64::from(value))
    }

    /// fmi2SetString for one variable.
    pub fn set_text(&mut self, reference: u32, text: &str) -> Result<()> {
        let index = self.text(reference)?;
        self.slave.set_text(index, text)
    }

    /// fmi2SetRealInputDerivatives for one variable.
    pub fn set_rate(&mut self, reference: u32, order: i32, value: f64) -> Result<()> {
        let index = self.real(reference)?;
        if order != 1 {
            return Err(Error::call(format!(
                "derivative of order {order} of {}: only the first derivative is used",
                self.slave.interface().variables[index].name
            )));
        }
        self.slave.set_rate(index, value)
    }

    /// fmi2GetRealOutputDerivatives for one variable. Orders that are not known are 0, as the standard
    /// has it.
    pub fn output_derivative(&mut self, reference: u32, order: i32) -> Result<f64> {
        let index = self.real(reference)?;
        if order < 1 {
            return Err(Error::call(format!("derivative of order {order}: the order is at least 1")));
        }
        let first = self.slave.output_derivative(index)?;
        Ok(if order == 1 { first } else { 0.0 })
    }

    /// fmi2GetDirectionalDerivative.
    pub fn directional_derivatives(
        &mut self,
        unknowns: &[u32],
        knowns: &[u32],
        seed: &[f64],
    ) -> Result<Vec<f64>> {
        let real = |references: &[u32]| references.iter().map(|r| self.real(*r)).collect::<Result<Vec<_>>>();
        let (unknowns, knowns) = (real(unknowns)?, real(knowns)?);
        self.slave.directional_derivatives(&unknowns, &knowns, seed)
    }

    /// fmi2DoStep.
    pub fn do_step(&mut self, time: f64, length: f64) -> Result<()> {
        self.slave.step(time, length)?;
        self.time = time + length;
        Ok(())
    }

    /// End of the last step \[s\].
    pub fn last_successful_time(&self) -> f64 {
        self.time
    }

    /// fmi2GetFMUstate.
    pub fn save(&mut self) -> Result<Saved> {
        Ok(Saved {
            state: self.state,
            experiment: self.experiment,
            time: self.time,
            snapshot: self.slave.save()?,
        })
    }

    /// fmi2GetFMUstate into an earlier one.
    pub fn save_into(&mut self, saved: &mut Saved) -> Result<()> {
        (saved.state, saved.experiment, saved.time) = (self.state, self.experiment, self.time);
        self.slave.save_into(&mut saved.snapshot)
    }

    /// fmi2SetFMUstate.
    pub fn restore(&mut self, saved: &Saved) -> Result<()> {
        self.slave.restore(&saved.snapshot)?;
        (self.state, self.experiment, self.time) = (saved.state, saved.experiment, saved.time);
        self.log.event(&format!("back at {} s", self.time));
        Ok(())
    }

    /// fmi2SerializeFMUstate.
    pub fn serialize(&mut self, saved: &Saved) -> Result<Vec<u8>> {
        let (start, stop) = saved.experiment.unzip();
        let numbers = [start.unwrap_or(f64::NAN), stop.flatten().unwrap_or(f64::NAN), saved.time];
        let mut bytes = vec![saved.state as u8];
        bytes.extend(numbers.iter().flat_map(|n| n.to_le_bytes()));
        bytes.extend(self.slave.serialize(&saved.snapshot)?);
        let digest = digest(&bytes);
        bytes.extend(digest.as_bytes());
        Ok(bytes)
    }

    /// fmi2DeSerializeFMUstate.
    pub fn deserialize(&mut self, bytes: &[u8]) -> Result<Saved> {
        let damaged = || Error::call("the bytes of the serialised state are damaged or not of this FMU");
        let (content, end) = bytes.split_last_chunk::<16>().ok_or_else(damaged)?;
        if end != digest(content).as_bytes() {
            return Err(damaged());
        }
        let (head, rest) = content.split_at_checked(25).ok_or_else(damaged)?;
        let state = State::from_number(head[0]).ok_or_else(damaged)?;
        let mut numbers = head[1..].chunks_exact(8).map(|b| {
            let mut bytes = [0; 8];
            bytes.copy_from_slice(b);
            f64::from_le_bytes(bytes)
        });
        let mut next = || numbers.next().unwrap_or(f64::NAN);
        let (start, stop, time) = (next(), next(), next());
        if !time.is_finite() {
            return Err(damaged());
        }
        let experiment = start.is_finite().then_some((start, stop.is_finite().then_some(stop)));
        Ok(Saved { state, experiment, time, snapshot: self.slave.deserialize(rest)? })
    }
}

/// Name and value reference of the time, which FMI 3.0 wants to be a variable: neither is one of the model's.
pub(super) fn time_variable(interface: &Interface) -> (String, u32) {
    let mut name = String::from("time");
    let is_taken =
        |name: &str| interface.variables.iter().any(|v| v.name == name || v.reference == reference(name));
    while is_taken(&name) {
        name.push('_');
    }
    let number = reference(&name);
    (name, number)
}

fn digest(bytes: &[u8]) -> uuid::Uuid {
    uuid::Uuid::new_v5(&uuid::Uuid::NAMESPACE_OID, bytes)
}
