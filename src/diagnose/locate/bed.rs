//! Runs for tests.

use crate::fit::{Channel, Drive, Run};
use crate::model::{Causality, Interface, Kind, Variability, VariableInfo};
use std::sync::Arc;

/// A run: inputs are the variables 0.., channels those after them.
pub fn run(name: &str, step: f64, inputs: &[Vec<f64>], channels: &[Vec<f64>]) -> Run {
    let points = channels[0].len();
    let inputs = inputs.iter().cloned().enumerate().collect::<Vec<_>>();
    let first = inputs.len();
    Run {
        name: name.into(),
        time: (0..points).map(|k| k as f64 * step).collect(),
        channels: channels
            .iter()
            .enumerate()
            .map(|(c, values)| Channel {
                variable: first + c,
                values: values.clone(),
                counts: false,
                unresolved: Vec::new(),
            })
            .collect(),
        drive: Arc::new(Drive::new(0.0, step, points, inputs)),
    }
}

/// An interface of inputs and outputs: name and unit.
pub fn interface(inputs: &[(&str, &str)], outputs: &[(&str, &str)]) -> Interface {
    let of = |(name, unit): &(&str, &str), causality, reference| VariableInfo {
        name: (*name).into(),
        reference,
        description: String::new(),
        unit: Some((*unit).into()),
        kind: Kind::Real,
        causality,
        variability: Variability::Continuous,
        initial: None,
        start: None,
        min: None,
        max: None,
        nominal: None,
        meaning: None,
    };
    let inputs = inputs.iter().map(|v| (v, Causality::Input));
    let outputs = outputs.iter().map(|v| (v, Causality::Output));
    Interface {
        name: "bed".into(),
        description: String::new(),
        communication_step: 0.01,
        start_time: 0.0,
        stop_time: 1.0,
        directional_derivatives: false,
        variables: inputs.chain(outputs).zip(0..).map(|((v, c), i)| of(v, c, i)).collect(),
    }
}
