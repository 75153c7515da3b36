//! Recordings that look like what often goes wrong with them.

use super::estimate::Point;
use super::evidence::{Evidence, Read};
use crate::stats::{correlation, deviation};
use crate::{Error, Result};
use std::collections::BTreeSet;

/// What is recorded has something to do with what the model says if they are so coherent: parameters that are not known yet
/// change sizes, not shapes.
const COHERENT: f64 = 0.9;
/// A factor counts as a known mistake if it is within this factor of it: parameters make forces half or twice as large.
const NEAR: f64 = 2.5;

/// Compares channels of the outputs with what the model says, `simulated` for each reading of `reads`.
///
/// # Errors
/// A channel has the other sign or is in another unit, as far as one can tell: which, and in which recordings.
pub fn check(evidence: &Evidence, reads: &[Read], simulated: &[Vec<Point>]) -> Result<()> {
    for (output, (name, _)) in evidence.signals.outputs.iter().enumerate() {
        let (mut own, mut model, mut files) = (Vec::new(), Vec::new(), BTreeSet::new());
        for (read, points) in reads.iter().zip(simulated) {
            for (k, point) in read.members.iter().zip(points) {
                let reading = &evidence.readings[*k];
                own.push(reading.point.outputs[output]);
                model.push(point.outputs[output]);
                files.insert(evidence.names[reading.recording].as_str());
            }
        }
        // about their means: a zero that is wrong is another matter
        let coherence = correlation(&own, &model);
        let factor = coherence * deviation(&own) / deviation(&model);
        if coherence.is_nan() || coherence.abs() < COHERENT {
            continue;
        }
        let is = |other: f64| (factor.abs() / other).ln().abs() < NEAR.ln();
        let guess = if is(1e-3) || is(1e3) {
            "a unit that is a thousand times another, as kN for N"
        } else if factor < 0.0 {
            "the other sign"
        } else {
            continue;
        };
        return Err(Error::file(format!(
            "channel \"{name}\" is {factor:.3} times what the model says, in {}: it looks like {guess}. Channels are in the model's axes \
             (ISO 8855, H axes) and in the unit of their header",
            files.into_iter().collect::<Vec<_>>().join(", ")
        )));
    }
    Ok(())
}
