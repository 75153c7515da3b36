//! A slave as a test stand: put into the state of constant inputs, asked how that changes, driven on from there.

use crate::model::{Causality, Interface, Slave, Value};
use crate::{Error, Result};
use nalgebra::{DMatrix, DVector};
use std::cell::{Cell, RefCell, RefMut};
use std::collections::HashMap;
use std::rc::Rc;

/// The parameter with which a rig refuses a start that is not stationary.
const ONLY_STATIONARY: &str = "only_stationary_start";

/// A difference as a share of an input's range,
const DIFFERENCE: f64 = 1e-5;
/// if that is no wider than this: beyond, it says nothing of the input's size.
const LARGEST_RANGE: f64 = 10.0;

/// Numbers that are remembered at most, 8 MB, and with the questions some four times that; then all are forgotten.
const MOST_REMEMBERED: usize = 1_000_000;

/// The number that a variable starts with, if it is one.
pub fn number(value: Option<&Value>) -> Option<f64> {
    match value? {
        Value::Real(x) => Some(*x),
        Value::Integer(n) => Some(f64::from(*n)),
        Value::Boolean(on) => Some(f64::from(u8::from(*on))),
        Value::Text(_) => None,
    }
}

/// Values of a slave's variables, by number.
pub type Values = [(usize, f64)];

/// What a slave can be asked, to the last bit.
#[derive(PartialEq, Eq, Hash)]
enum Question {
    /// All outputs in the stationary state of these values.
    State(Bits),
    /// How outputs change with inputs there: values, outputs, inputs.
    Slopes(Bits, Vec<usize>, Vec<usize>),
    /// Outputs along a motion from there: values, rates, duration, steps, outputs.
    Along(Bits, Bits, u64, usize, Vec<usize>),
}

type Bits = Vec<(usize, u64)>;

fn bits(values: &Values) -> Bits {
    values.iter().map(|(variable, value)| (*variable, value.to_bits())).collect()
}

/// A slave that starts in the stationary state of its inputs, as all rigs of this library do.
///
/// It remembers what it has answered: a search comes back to the same conditions with the same parameters, in an identification with two
/// of five of its questions.
pub struct Stand {
    slave: RefCell<Box<dyn Slave>>,
    interface: Interface,
    /// Its outputs that are real numbers.
    outputs: Vec<usize>,
    /// What every start is given first.
    fixed: Vec<(usize, f64)>,
    starts: Cell<usize>,
    answers: RefCell<HashMap<Question, Rc<[f64]>>>,
    /// How many numbers these are.
    remembered: Cell<usize>,
}

impl Stand {
    /// A stand with this slave. `fixed` is set before each start, in front of what the start itself asks for.
    pub fn new(slave: Box<dyn Slave>, fixed: &Values) -> Self {
        let interface = slave.interface().clone();
        let mut fixed = fixed.to_vec();
        fixed.extend(interface.index(ONLY_STATIONARY).map(|v| (v, 1.0)));
        let outputs =
            interface.with(Causality::Output).filter(|v| interface.variables[*v].is_real()).collect();
        let (starts, answers, remembered) = Default::default();
        Self { slave: slave.into(), interface, outputs, fixed, starts, answers, remembered }
    }

    /// What the slave's variables are.
    pub fn interface(&self) -> &Interface {
        &self.interface
    }

    /// How often it was started: what its answers cost.
    pub fn starts(&self) -> usize {
        self.starts.get()
    }

    /// The number of a variable that can be set before a start: a parameter or an input.
    ///
    /// # Errors
    /// There is none of that name, or it is an output.
    pub fn settable(&self, name: &str) -> Result<usize> {
        let found = self.interface.find(name)?;
        let info = &self.interface.variables[found];
        match info.causality {
            Causality::Parameter | Causality::Input if number(info.start.as_ref()).is_some() => Ok(found),
            _ => Err(Error::variable(format!(
                "{name} of {} is no parameter and no input",
                self.interface.name
            ))),
        }
    }

    /// Outputs in the stationary state of `values`.
    ///
    /// # Errors
    /// There is no such state, or a value is refused.
    pub fn stationary(&self, values: &Values, outputs: &[usize]) -> Result<Vec<f64>> {
        let state =
            self.answered(Question::State(bits(values)), || self.settled(&mut **self.begin(values)?))?;
        let known =
            |v: &usize| Some(state[self.outputs.iter().position(|o| o == v)?]).filter(|x| !x.is_nan());
        if let Some(known) = outputs.iter().map(known).collect() {
            return Ok(known);
        }
        // what is no output, or no number: the slave says what it is
        let mut slave = self.begin(values)?;
        slave.finish_start()?;
        outputs.iter().map(|v| slave.get(*v)).collect()
    }

    /// All outputs of a slave that has begun, at rest.
    fn settled(&self, slave: &mut dyn Slave) -> Result<Vec<f64>> {
        slave.finish_start()?;
        Ok(self.outputs.iter().map(|v| slave.get(*v).unwrap_or(f64::NAN)).collect())
    }

    /// What is remembered of a question, or what `find` finds.
    fn answered(&self, question: Question, find: impl FnOnce() -> Result<Vec<f64>>) -> Result<Rc<[f64]>> {
        let known = self.answers.borrow().get(&question).cloned();
        known.map_or_else(|| Ok(self.remember(question, find()?)), Ok)
    }

    fn remember(&self, question: Question, answer: Vec<f64>) -> Rc<[f64]> {
        let answer: Rc<[f64]> = answer.into();
        let mut answers = self.answers.borrow_mut();
        if self.remembered.get() + answer.len() > MOST_REMEMBERED {
            answers.clear();
            self.remembered.set(0);
        }
        self.remembered.set(self.remembered.get() + answer.len());
        answers.insert(question, Rc::clone(&answer));
        answer
    }

    /// Outputs in that state, and how they (rows) change with inputs (columns): by the slave's own derivatives, or by
    /// differences where it has none.
    ///
    /// # Errors
    /// As [`stationary`](Self::stationary).
    pub fn state(
        &self,
        values: &Values,
        outputs: &[usize],
        inputs: &[usize],
    ) -> Result<(Vec<f64>, DMatrix<f64>)> {
        let mut slopes = DMatrix::zeros(outputs.len(), inputs.len());
        if !self.interface.directional_derivatives {
            for (k, input) in inputs.iter().enumerate() {
                // extrapolated from two differences: a peak may be as narrow as a thousandth of the input's range, and its
                // curvature is then no small part of the slope
                let half = self.difference(*input);
                let [wide, narrow] =
                    [half, 0.5 * half].map(|half| self.central(values, outputs, *input, half));
                slopes.set_column(k, &((narrow? * 4.0 - wide?) / 3.0));
            }
            return Ok((self.stationary(values, outputs)?, slopes));
        }
        let question = Question::Slopes(bits(values), outputs.to_vec(), inputs.to_vec());
        let found = self.answered(question, || {
            let mut slave = self.begin(values)?;
            let mut columns = Vec::with_capacity(slopes.len());
            for input in inputs {
                columns.extend(slave.directional_derivatives(outputs, &[*input], &[1.0])?);
            }
            self.remember(Question::State(bits(values)), self.settled(&mut **slave)?);
            Ok(columns)
        })?;
        slopes.copy_from_slice(&found);
        Ok((self.stationary(values, outputs)?, slopes))
    }

    /// The central difference of outputs over an input.
    fn central(&self, values: &Values, outputs: &[usize], input: usize, half: f64) -> Result<DVector<f64>> {
        let [below, above] = [-half, half].map(|side| {
            let at = self.value(values, input) + side;
            let moved = [values, &[(input, at)]].concat();
            self.stationary(&moved, outputs).map(|found| (at, DVector::from_vec(found)))
        });
        let ((low, below), (high, above)) = (below?, above?);
        Ok((above - below) / (high - low))
    }

    /// The value that a variable has among `values`, or starts with.
    pub fn value(&self, values: &Values, variable: usize) -> f64 {
        let set = values.iter().rev().find(|(v, _)| *v == variable).map(|(_, value)| *value);
        set.or_else(|| number(self.interface.variables[variable].start.as_ref())).unwrap_or(0.0)
    }

    /// Half of the wider of the differences by which a slope is found \[the input's unit\]: what truncation and rounding then leave
    /// of an output that turns within a thousandth of its input's range is some 1e-10.
    fn difference(&self, input: usize) -> f64 {
        let info = &self.interface.variables[input];
        match (info.min, info.max) {
            (Some(low), Some(high)) if high - low < LARGEST_RANGE => DIFFERENCE * (high - low),
            _ => DIFFERENCE,
        }
    }

    /// Outputs while inputs move with constant rates for `time` seconds, from the stationary state of `values` on, in
    /// `steps` communication steps: at the beginning, and after each of them.
    ///
    /// # Errors
    /// As [`stationary`](Self::stationary); the run leaves the model's validity.
    pub fn along(
        &self,
        values: &Values,
        rates: &Values,
        time: f64,
        steps: usize,
        outputs: &[usize],
    ) -> Result<Vec<Vec<f64>>> {
        let question = Question::Along(bits(values), bits(rates), time.to_bits(), steps, outputs.to_vec());
        let rows = self.answered(question, || {
            let mut slave = self.begin(values)?;
            slave.finish_start()?;
            let mut rows = Vec::with_capacity((steps + 1) * outputs.len());
            let mut read = |slave: &mut dyn Slave| -> Result<()> {
                for output in outputs {
                    rows.push(slave.get(*output)?);
                }
                Ok(())
            };
            read(&mut **slave)?;
            let moving: Vec<usize> = rates.iter().map(|(v, _)| *v).collect();
            let speeds: Vec<f64> = rates.iter().map(|(_, rate)| *rate).collect();
            let at = |k: usize| time * k as f64 / steps as f64;
            for k in 0..steps {
                let places: Vec<f64> =
                    rates.iter().map(|(v, rate)| self.value(values, *v) + rate * at(k)).collect();
                slave.set_all(&moving, &places, &speeds)?;
                slave.step(at(k), at(k + 1) - at(k))?;
                read(&mut **slave)?;
            }
            Ok(rows)
        })?;
        Ok((0..=steps).map(|k| rows[k * outputs.len()..][..outputs.len()].to_vec()).collect())
    }

    fn begin(&self, values: &Values) -> Result<RefMut<'_, Box<dyn Slave>>> {
        self.starts.set(self.starts.get() + 1);
        let mut slave = self.slave.borrow_mut();
        slave.reset()?;
        for (variable, value) in self.fixed.iter().chain(values) {
            slave.set(*variable, *value)?;
        }
        slave.start(0.0, None)?;
        Ok(slave)
    }
}
