//! What plans refer to by name and no data can say: functionals, transforms and inversions in closed form.

use super::solve::Unsolved;
use std::collections::BTreeMap;

/// Numbers by name.
pub type Numbers = BTreeMap<String, f64>;

/// A number that is read from a stationary state.
#[derive(Clone, Copy)]
pub struct Functional {
    /// Its name.
    pub name: &'static str,
    /// The outputs that it is made of.
    pub outputs: &'static [&'static str],
    /// The inputs that it is made of.
    pub inputs: &'static [&'static str],
    /// The number, from outputs and inputs.
    pub read: fn(&[f64], &[f64]) -> f64,
}

/// Parameters of a model that a transform gives values.
pub type Changed = Vec<(&'static str, f64)>;

/// Other parameters than the model's, which a group looks for.
#[derive(Clone, Copy)]
pub struct Transform {
    /// Its name.
    pub name: &'static str,
    /// How many values it takes: those that a group looks for, and those that it fixes.
    pub size: usize,
    /// The model's parameters from the values that are looked for and from all parameters as they are known.
    pub to_model: fn(&[f64], &Numbers) -> Changed,
    /// Those of them that it gives a value only until a later group does.
    pub assumes: &'static [&'static str],
    /// What is looked for, from the model's parameters.
    pub from_model: fn(&Numbers) -> Vec<f64>,
}

/// The parameters of a group from the values of its targets, what the targets' conditions hold, and all parameters as they are
/// known.
pub type Invert = fn(&[f64], &[Numbers], &Numbers) -> Result<Vec<f64>, Unsolved>;

/// An inversion in closed form.
#[derive(Clone, Copy)]
pub struct Inversion {
    /// Its name.
    pub name: &'static str,
    /// How many targets it takes, and parameters it gives; any number, if it does not say.
    pub size: Option<usize>,
    /// Inputs that the conditions of all its targets have to hold.
    pub held: &'static [&'static str],
    /// The parameters.
    pub invert: Invert,
}

/// All that is registered for a plan.
#[derive(Clone, Copy, Default)]
pub struct Registry {
    /// Functionals.
    pub functionals: &'static [Functional],
    /// Transforms.
    pub transforms: &'static [Transform],
    /// Inversions.
    pub inversions: &'static [Inversion],
}
