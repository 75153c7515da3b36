//! What an FMU says of itself: the content of modelDescription.xml as plain data, which an FMU that
//! carries another one has beside it instead of a reader of XML.

use crate::model::Interface;
use serde::{Deserialize, Serialize};

#[cfg(feature = "host")]
/// Name of the tool whose annotations say what variables mean.
pub(in crate::fmi) const ANNOTATIONS: &str = "latsch";

/// The content of a modelDescription.xml, with type definitions and FMI's defaults resolved.
///
/// Where the standard's rules on single variables are broken (an input with `initial`, a parameter
/// without `variability`) the description is read as it was meant: refusing is for validators.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Description {
    /// As written: "2.0", or "2.0.x" from tools that do not know better.
    pub fmi_version: String,
    /// Name of the model.
    pub model_name: String,
    /// What the binary has to confirm.
    pub guid: String,
    /// The tool that made the FMU.
    pub generation_tool: Option<String>,
    /// Name of the binary without ending: a C identifier.
    pub model_identifier: String,
    /// The variables, and the default experiment with this importer's defaults where it is silent.
    pub interface: Interface,
    /// The default experiment as written.
    pub experiment: Experiment,
    /// What the FMU can do.
    pub capabilities: Capabilities,
}

/// The attributes of the element DefaultExperiment.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct Experiment {
    /// Start \[s\].
    pub start: Option<f64>,
    /// End \[s\].
    pub stop: Option<f64>,
    /// Relative tolerance.
    pub tolerance: Option<f64>,
    /// Communication step \[s\].
    pub step_size: Option<f64>,
}

/// The attributes of the element CoSimulation that say what the FMU can do.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Capabilities {
    /// Needs the tool that made it, installed and licensed.
    pub needs_execution_tool: bool,
    /// Takes communication steps of changing length.
    pub can_handle_variable_step: bool,
    /// Takes derivatives of its inputs.
    pub can_interpolate_inputs: bool,
    /// Highest derivative that it has of its outputs.
    pub max_output_derivative_order: u32,
    /// Steps in the background if asked.
    pub can_run_asynchronously: bool,
    /// One instance at a time in each process.
    pub can_be_instantiated_once: bool,
    /// Allocates by itself.
    pub can_not_use_memory_functions: bool,
    /// Saves and restores its state.
    pub can_get_and_set_state: bool,
    /// Turns a saved state into bytes.
    pub can_serialize_state: bool,
    /// Has partial derivatives.
    pub provides_directional_derivatives: bool,
}
