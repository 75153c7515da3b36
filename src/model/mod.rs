//! What a model is: its variable table, its plain state, and how anything is run.
//!
//! [`Model`] is how one writes a model, [`Slave`] is how one runs anything. [`Native`] makes a
//! slave of a model; everything else (simulation, export, the FMI interface) knows only slaves.

mod access;
mod clock;
mod clone;
mod interface;
mod join;
mod meaning;
mod native;
mod numbers;
mod settings;
mod slave;
mod table;
pub mod unit;
mod variable;

pub use access::{Access, Lens};
pub use clock::{check_experiment, check_step};
#[cfg(feature = "host")]
pub(crate) use interface::did_you_mean;
pub use interface::{Causality, Initial, Interface, Kind, Value, Variability, VariableInfo};
pub use join::{Joined, join};
pub use meaning::{Meaning, Purpose, Role};
pub use native::Native;
pub use numbers::groups;
pub use settings::{Free, Setting, Settings};
pub(crate) use settings::{Lines, key, line_of};
pub(crate) use slave::wrong_order;
pub use slave::{Slave, Snapshot};
pub use table::Table;
pub(crate) use table::reference;
pub use variable::{
    Row, Variable, boolean_parameter, input, integer_parameter, local, output, parameter, text_parameter,
};

use crate::Result;
use serde::{Serialize, de::DeserializeOwned};

/// A model: one plain value that holds parameters, inputs, states and outputs.
///
/// Whoever clones the value has saved the state; whoever serialises it can continue elsewhere. The
/// table [`variables`](Model::variables) declares every variable once; the FMI description, the
/// command line, CSV columns and parameter files are derived from it.
///
/// A model is made in this order: `default()`, then every start value of the table and every
/// setting of the user is written, then [`initialize`](Model::initialize), then steps.
pub trait Model: Clone + Default + PartialEq + Serialize + DeserializeOwned + Send + 'static {
    /// The name that users type and that model files carry, in kebab-case.
    const NAME: &'static str;
    /// What it models, in one sentence.
    const DESCRIPTION: &'static str;
    /// Documentation for the FMU's `documentation/index.html`, where the tables that follow from
    /// [`variables`](Model::variables) come after it: HTML whose topics begin with `<h2>`, with nothing
    /// from outside (`include_str!` files), in fragments one after the other. It is trusted and taken as it
    /// stands, and no part of the GUID.
    const DOCUMENTATION: &'static [&'static str] = &[];
    /// The communication step that suits the model \[s\].
    const COMMUNICATION_STEP: f64 = 1e-3;
    /// The length of an experiment that shows what the model does \[s\].
    const STOP_TIME: f64 = 1.0;

    /// True if [`directional_derivatives`](Model::directional_derivatives) has answers.
    const DIRECTIONAL_DERIVATIVES: bool = false;

    /// Every variable, in the order in which they are shown. Its name tells a variable's FMI value reference: rows
    /// may be moved, and others put between them.
    fn variables() -> Table<Self>;

    /// The step h of the model's own time grid t0 + n h \[s\]. May depend on parameters, on nothing
    /// else.
    fn step_size(&self) -> f64;

    /// Checks the parameters against each other and finds the state at the start from parameters
    /// and inputs. May be called again with other inputs until the first step.
    ///
    /// # Errors
    /// Parameters that contradict each other.
    fn initialize(&mut self) -> Result<()> {
        Ok(())
    }

    /// Takes over tunable parameters that were set after initialization; called before the next step.
    ///
    /// # Errors
    /// Parameters that contradict each other.
    fn tune(&mut self) -> Result<()> {
        Ok(())
    }

    /// Checks a value that was read from bytes, which may come from anywhere: whatever
    /// [`step`](Model::step) takes for granted, such as lengths of vectors. Parameters are within
    /// the ranges of the table.
    ///
    /// # Errors
    /// A value that no run of this model leads to.
    fn check(&self) -> Result<()> {
        Ok(())
    }

    /// What the user should know about the state that [`initialize`](Model::initialize) found.
    fn warning(&self) -> Option<String> {
        None
    }

    /// The derivatives of the outputs `unknowns` along a change of inputs: pairs of an input's name and its
    /// share in the direction. Before the first step (`starting`) the state moves
    /// with the inputs, as [`initialize`](Model::initialize) would have it; between steps it stays.
    ///
    /// `None` stands for an output without a formula. Before the first step [`Native`] then takes differences
    /// of [`initialize`](Model::initialize): FMI lets a master ask for every output there. Between steps every
    /// output needs its number.
    ///
    /// # Errors
    /// A model without [`DIRECTIONAL_DERIVATIVES`](Model::DIRECTIONAL_DERIVATIVES).
    fn directional_derivatives(
        &self,
        starting: bool,
        direction: &[(&str, f64)],
        unknowns: &[&str],
    ) -> Result<Vec<Option<f64>>> {
        let _ = (starting, direction, unknowns);
        Err(crate::Error::call(format!("{} has no directional derivatives", Self::NAME)))
    }

    /// Advances by `length` seconds (the step size, or less to reach a point between grid points).
    /// The inputs hold their values at the end of the step.
    ///
    /// # Errors
    /// A state outside the model's validity. The state is then undefined; the caller rolls back or
    /// gives up.
    fn step(&mut self, length: f64) -> Result<()>;
}
