//! What the model says where a recording was read.

use super::estimate::Point;
use super::matching::{Reading, Signals};
use crate::identify::plan::{Condition, Touch};
use crate::identify::readings::Readings;
use crate::identify::registry::Numbers;
use crate::identify::stand::number;
use crate::{Error, Result};

/// A ramp begins so far off the road \[the unit of its input: m\], so that a wrong offset of the height does not matter.
const OFF_THE_ROAD: f64 = 2e-3;

impl Readings<'_> {
    /// The outputs where a reading was taken, with its inputs less their `offsets` (0 where there is none).
    ///
    /// # Errors
    /// The model has no such state.
    pub(super) fn respond(
        &self,
        condition: &Condition,
        reading: &Reading,
        signals: &Signals,
        offsets: &[f64],
        parameters: &Numbers,
    ) -> Result<Vec<f64>> {
        let outputs: Vec<usize> = signals.outputs.iter().map(|(_, variable)| *variable).collect();
        let mut values = self.held(condition, parameters)?;
        let actual = |k: usize| reading.point.inputs[k] - offsets.get(k).copied().unwrap_or(0.0);
        for (k, (name, variable)) in signals.inputs.iter().enumerate() {
            if condition.recorded.contains_key(name) {
                let info = &self.stand.interface().variables[*variable];
                // what was recorded at the end of a range may be beyond it by an offset
                let least = info.min.unwrap_or(f64::NEG_INFINITY);
                values.push((*variable, actual(k).max(least).min(info.max.unwrap_or(f64::INFINITY))));
            }
        }
        let (Some(moved), Some(ramp)) = (&reading.moved, &condition.ramp) else {
            return self.stand.stationary(&values, &outputs);
        };
        // from off the road, in steps of which a whole number fits into the window
        let place = signals
            .input(&ramp.input)
            .ok_or_else(|| Error::file(format!("{} is not recorded", ramp.input)))?;
        let input = signals.inputs[place].1;
        let offset = offsets.get(place).copied().unwrap_or(0.0);
        let [from, to] = moved.window.map(|x| x - offset);
        let inside = (((to - from) / moved.rate / ramp.step).round() as usize).max(2);
        let step = (to - from) / moved.rate / inside as f64;
        let way = (from - moved.touch) * moved.rate.signum() + OFF_THE_ROAD;
        let before = (way / moved.rate.abs() / step).ceil() as usize;
        values.push((input, from - before as f64 * step * moved.rate));
        let steps = before + inside;
        let rows = self.stand.along(&values, &[(input, moved.rate)], step * steps as f64, steps, &outputs)?;
        // the mean by the trapezoidal rule
        let window = &rows[before..];
        let weight = |k: usize| if k == 0 || k == inside { 0.5 } else { 1.0 };
        Ok((0..outputs.len())
            .map(|o| {
                window.iter().enumerate().map(|(k, row)| weight(k) * row[o]).sum::<f64>() / inside as f64
            })
            .collect())
    }

    /// The value of the input at which the tire touches the road.
    ///
    /// # Errors
    /// It does not.
    pub(super) fn touch(&self, condition: &Condition, parameters: &Numbers) -> Result<f64> {
        let touch = condition.from_touch.as_ref();
        touch.map_or(Ok(0.0), |touch| self.touch_of(condition, touch, parameters))
    }

    /// What the model says off the road.
    ///
    /// # Errors
    /// It has no such state.
    pub(super) fn free(
        &self,
        condition: &Condition,
        touch: &Touch,
        signals: &Signals,
        parameters: &Numbers,
    ) -> Result<Point> {
        let mut values = self.held(condition, parameters)?;
        values.push((self.stand.settable(&touch.input)?, touch.between[0]));
        let outputs: Vec<usize> = signals.outputs.iter().map(|(_, variable)| *variable).collect();
        let inputs =
            signals.inputs.iter().map(|(_, variable)| self.stand.value(&values, *variable)).collect();
        Ok(Point { inputs, outputs: self.stand.stationary(&values, &outputs)? })
    }

    /// The value of a parameter, or that an input starts with.
    ///
    /// # Errors
    /// There is none of that name.
    pub(super) fn value(&self, name: &str, parameters: &Numbers) -> Result<f64> {
        let variable = self.stand.settable(name)?;
        let start = number(self.stand.interface().variables[variable].start.as_ref());
        Ok(parameters.get(name).copied().or(start).unwrap_or(0.0))
    }
}
