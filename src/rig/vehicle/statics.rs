//! Forces with which a wheel carrier is in balance where the vehicle stands.

use crate::mechanics::Wrench;
use crate::{Error, Result};
use nalgebra::{Matrix6, Vector6};

/// What a unit force in a joint puts on the carrier, about its centre.
pub type Column = Wrench<f64>;

/// The least share of a joint in holding the carrier: what the worst direction of its six gets of a unit force.
const LEAST_HELD: f64 = 1e-4;

/// Sizes of the six forces with which a carrier is in balance under all other loads on it.
///
/// # Errors
/// The joints do not hold the carrier: it can move without any of them being strained.
pub fn balance(what: &str, columns: &[Column; 6], loads: &Wrench<f64>) -> Result<[f64; 6]> {
    let six = |w: &Wrench<f64>| Vector6::from_iterator(w.force.iter().chain(&w.moment).copied());
    let matrix = Matrix6::from_columns(&columns.each_ref().map(six));
    let least = matrix.singular_values().min();
    let forces = matrix.lu().solve(&-six(loads)).filter(|_| least > LEAST_HELD);
    forces.map(Into::into).ok_or_else(|| {
        Error::variable(format!(
            "the joints of the {what} do not hold its wheel: it can move without straining any of them; the lines of the links must not all meet, nor lie in one plane"
        ))
    })
}
