//! What times a slave accepts.

use crate::{Error, Result};

/// Checks the times of an experiment \[s\].
///
/// # Errors
/// Times that are not finite, or a stop that is not after the start.
pub fn check_experiment(start: f64, stop: Option<f64>) -> Result<()> {
    if !start.is_finite() || stop.is_some_and(|stop| !stop.is_finite()) {
        let stop = stop.map(|stop| format!(" to {stop} s")).unwrap_or_default();
        return Err(Error::call(format!("an experiment from {start} s{stop}: finite times are needed")));
    }
    match stop {
        Some(stop) if stop <= start => {
            Err(Error::call(format!("the stop time {stop} s is not after the start time {start} s")))
        }
        _ => Ok(()),
    }
}

/// The end of a step from `time` by `length` seconds by a master whose last step ended at `last`.
///
/// A master's clock may differ by rounding: from `last` by a thousandth of the step or some units in
/// the last place, from the stop time, to which it may have come by many sums, by as many units as
/// there are steps, and never by more than half a step.
///
/// # Errors
/// Numbers that are not finite, a length that is not positive or too short to move the time, a time
/// that is not where the last step ended, a step past the stop time.
pub fn check_step(last: f64, time: f64, length: f64, stop: Option<f64>) -> Result<f64> {
    if !time.is_finite() || !length.is_finite() {
        return Err(Error::call(format!("a step from {time} s by {length} s: finite times are needed")));
    }
    if length <= 0.0 {
        return Err(Error::call(format!("a step of {length} s: the length has to be positive")));
    }
    let slack = (1e-3 * length).max(8.0 * f64::EPSILON * time.abs());
    if (time - last).abs() > slack {
        return Err(Error::call(format!(
            "a step from {time} s: the last one ended at {last} s, and time can only go back by restoring a state"
        )));
    }
    let target = time + length;
    if target <= last {
        return Err(Error::call(format!("a step of {length} s is too short to move the time {time} s")));
    }
    let sums = (time / length).abs();
    let drift = (f64::EPSILON * time.abs() * sums).clamp(slack, 0.5 * length.max(2.0 * slack));
    match stop {
        Some(stop) if target > stop + drift => {
            Err(Error::call(format!("a step to {target} s would pass the stop time {stop} s")))
        }
        _ => Ok(target),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn follows_clocks_that_add_up_and_epochs() {
        // sums of 1 ms over three hours, to a stop time that was meant exactly
        let (mut time, steps) = (0.0, 10_800_000);
        let stop = 1e-3 * f64::from(steps);
        for _ in 0..steps {
            time = check_step(time, time, 1e-3, Some(stop)).unwrap();
        }
        assert!((time - stop).abs() > 1e-8, "this clock drifts");
        // seconds since 1970, each point computed anew
        let start = 1.7e9;
        let mut last = start;
        for k in 0..1000 {
            last = check_step(last, start + 1e-3 * f64::from(k), 1e-3, None).unwrap();
        }
    }

    #[test]
    fn refuses_clocks_that_jump() {
        for (last, time, length) in
            [(1.0, 1.01, 0.01), (1.0, 0.99, 0.01), (0.0, f64::NAN, 0.1), (0.0, 0.0, 0.0), (1e9, 1e9, 1e-9)]
        {
            assert!(check_step(last, time, length, None).is_err(), "{last} {time} {length}");
        }
        assert!(check_step(0.9, 0.9, 0.2, Some(1.0)).is_err());
    }
}
