//! [`Slave`]: how anything is run, in plain `f64`.

use super::{Interface, Value};
use crate::{Error, Result};
use std::any::Any;

/// A saved state. Only the slave that made it, or one made in the same way, can read it.
pub type Snapshot = Box<dyn Any + Send>;

/// Anything that is stepped in time: a native model, an imported FMU, a wired system.
///
/// Variables are named by their index in [`Interface::variables`]. Booleans are 0 and 1, integers
/// and items of enumerations whole numbers; texts have their own calls.
///
/// The order of calls is that of FMI 2.0: set start values, [`start`](Slave::start), set inputs and
/// read outputs, [`finish_start`](Slave::finish_start), then set inputs, step, read outputs.
pub trait Slave {
    /// What it is and which variables it has.
    fn interface(&self) -> &Interface;

    /// The value of a variable at the last communication point.
    ///
    /// # Errors
    /// A text variable, or a call before [`start`](Slave::start).
    fn get(&mut self, variable: usize) -> Result<f64>;

    /// Sets a parameter or input.
    ///
    /// # Errors
    /// A variable that cannot be set now, or a value that it does not accept. The old value stays.
    fn set(&mut self, variable: usize, value: f64) -> Result<()>;

    /// Sets a parameter or input of any kind.
    ///
    /// # Errors
    /// As [`set`](Slave::set) and [`set_text`](Slave::set_text).
    fn set_value(&mut self, variable: usize, value: &Value) -> Result<()> {
        match value {
            Value::Text(text) => self.set_text(variable, text),
            Value::Real(v) => self.set(variable, *v),
            Value::Integer(v) => self.set(variable, f64::from(*v)),
            Value::Boolean(v) => self.set(variable, f64::from(u8::from(*v))),
        }
    }

    /// The value of a text variable.
    ///
    /// # Errors
    /// As [`get`](Slave::get).
    fn text(&mut self, variable: usize) -> Result<String>;

    /// Sets a text variable.
    ///
    /// # Errors
    /// As [`set`](Slave::set).
    fn set_text(&mut self, variable: usize, text: &str) -> Result<()>;

    /// Gives an input its first derivative \[unit/s\]: from the communication point on, until the
    /// next value or derivative is set, the input is value + rate (t - t_c).
    ///
    /// # Errors
    /// Not a real input, or the slave cannot interpolate.
    fn set_rate(&mut self, variable: usize, rate: f64) -> Result<()>;

    /// The values of several real variables, as [`get`](Slave::get) has them.
    ///
    /// # Errors
    /// As [`get`](Slave::get).
    fn get_all(&mut self, variables: &[usize], values: &mut [f64]) -> Result<()> {
        for (variable, value) in variables.iter().zip(values) {
            *value = self.get(*variable)?;
        }
        Ok(())
    }

    /// Sets several real inputs and, where the slave can interpolate, their rates.
    ///
    /// # Errors
    /// As [`set`](Slave::set) and [`set_rate`](Slave::set_rate).
    fn set_all(&mut self, variables: &[usize], values: &[f64], rates: &[f64]) -> Result<()> {
        let interpolates = self.can_interpolate();
        for ((variable, value), rate) in variables.iter().zip(values).zip(rates) {
            self.set(*variable, *value)?;
            if interpolates {
                self.set_rate(*variable, *rate)?;
            }
        }
        Ok(())
    }

    /// True if [`set_rate`](Slave::set_rate) has an effect.
    fn can_interpolate(&self) -> bool;

    /// Fixes the experiment's start and, if given, its end \[s\], and begins initialization.
    ///
    /// # Errors
    /// Already started; times that are not finite or reversed.
    fn start(&mut self, start: f64, stop: Option<f64>) -> Result<()>;

    /// Ends initialization; the slave is ready for the first step.
    ///
    /// # Errors
    /// Parameters that contradict each other; no state at the start.
    fn finish_start(&mut self) -> Result<()>;

    /// The first derivative of a real output at the last communication point \[unit/s\], over about one
    /// internal step of the slave.
    ///
    /// # Errors
    /// Not a real output, not between steps, or the slave does not know it.
    fn output_derivative(&mut self, variable: usize) -> Result<f64> {
        let name = &self.interface().variables[variable].name;
        Err(Error::call(format!("the derivative of {name} is not offered")))
    }

    /// The directional derivatives of outputs: sum over `knowns`, which are inputs and before the first step
    /// also parameters, of the partial derivative of each of `unknowns` times the number in `seed`.
    ///
    /// # Errors
    /// Variables that have none, or a slave that does not offer them.
    fn directional_derivatives(
        &mut self,
        unknowns: &[usize],
        knowns: &[usize],
        seed: &[f64],
    ) -> Result<Vec<f64>> {
        let _ = (unknowns, knowns, seed);
        Err(Error::call(format!("{} does not offer directional derivatives", self.interface().name)))
    }

    /// The step of its own time grid \[s\], if it has one and tells it.
    fn own_step(&self) -> Option<f64> {
        None
    }

    /// True if a part inside gets the value of this output: in a wired system.
    fn is_passed_on(&self, variable: usize) -> bool {
        let _ = variable;
        false
    }

    /// Parts inside that get the value of this output get `change` more from now on, until another change
    /// is said. Nothing happens where nothing is passed on.
    fn change_passed_on(&mut self, variable: usize, change: f64) {
        let _ = (variable, change);
    }

    /// What the user should know about the start, once that is finished.
    fn warning(&self) -> Option<String> {
        None
    }

    /// Steps from the communication point `time` by `length` seconds.
    ///
    /// # Errors
    /// A time that is not where the last step ended, a length that is not positive, or a model that
    /// left its validity.
    fn step(&mut self, time: f64, length: f64) -> Result<()>;

    /// Saves all that changes during a run.
    ///
    /// # Errors
    /// The slave cannot.
    fn save(&mut self) -> Result<Snapshot>;

    /// Overwrites an earlier snapshot of this slave with the present state, without allocating where
    /// that is possible.
    ///
    /// # Errors
    /// As [`save`](Slave::save).
    fn save_into(&mut self, snapshot: &mut Snapshot) -> Result<()> {
        *snapshot = self.save()?;
        Ok(())
    }

    /// Goes back to a saved state.
    ///
    /// # Errors
    /// A snapshot of another slave.
    fn restore(&mut self, snapshot: &Snapshot) -> Result<()>;

    /// A snapshot as bytes, readable by any slave with the same GUID on any machine.
    ///
    /// # Errors
    /// As [`save`](Slave::save).
    fn serialize(&mut self, snapshot: &Snapshot) -> Result<Vec<u8>>;

    /// The snapshot in `bytes`.
    ///
    /// # Errors
    /// Bytes that are damaged or of another model.
    fn deserialize(&mut self, bytes: &[u8]) -> Result<Snapshot>;

    /// Back to how it was when it was made.
    ///
    /// # Errors
    /// The slave cannot.
    fn reset(&mut self) -> Result<()>;

    /// Index of the variable called `name`.
    ///
    /// # Errors
    /// No such variable.
    fn find(&self, name: &str) -> Result<usize> {
        self.interface().find(name)
    }
}

/// The error for a call in the wrong order: `what` is not possible `when`.
pub(crate) fn wrong_order(what: &str, when: &str) -> Error {
    Error::call(format!("{what} is not possible {when}"))
}
