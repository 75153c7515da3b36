//! What of a load history matters for damage, and how a simulation stands beside recordings of the same run: extremes, cycles, level
//! crossings, range pairs, spectra.

mod compare;
mod count;
mod table;

pub use compare::{Band, Compared, Conditions, Event, Load, QUANTITIES, SURE, compare};
pub use count::{
    Classes, Cycle, Rainflow, Residue, extremes, from_to, large_turning_points, level_crossings, rainflow,
    rainflow_matrix, range_pairs, summed_up, turning_points,
};
pub use table::{counts, matrices, quantities};
