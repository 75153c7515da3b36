//! Recordings: measured or simulated channels over time, with units, and the CSV files that hold them.

mod csv;
mod profile;
mod smooth;

pub(crate) use csv::{Defect, read_csv_with_defects};
pub use csv::{parse_csv, read_csv, to_csv, write_csv};
pub use profile::{profile_from_csv, profile_value, read_settings};
pub use smooth::Smooth;

use crate::model::unit::Unit;
use crate::{Error, Result};

/// How far outside a recording, as a share of its first or last interval, a time still counts as
/// its first or last: clocks that add up steps miss the end by rounding.
const END_TOLERANCE: f64 = 1e-6;

/// Channels over one common time.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Recording {
    /// Time of the samples \[s\], strictly increasing.
    pub time: Vec<f64>,
    /// The channels, each as long as the time.
    pub channels: Vec<Channel>,
    /// Where it comes from, for messages: a file name or the name of a run.
    pub source: String,
}

/// One quantity over time.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Channel {
    /// Its name, unique within the recording.
    pub name: String,
    /// The unit of its values, in the notation of [`unit`](crate::model::unit).
    pub unit: String,
    /// Its values, one per sample.
    pub values: Vec<f64>,
}

impl Recording {
    /// The channel called `name`, in the unit that it was recorded in.
    ///
    /// # Errors
    /// No such channel; the message lists those that there are.
    pub fn channel(&self, name: &str) -> Result<&Channel> {
        self.channels.iter().find(|c| c.name == name).ok_or_else(|| {
            let names: Vec<_> = self.channels.iter().map(|c| c.name.as_str()).collect();
            let names = if names.is_empty() { "none".into() } else { names.join(", ") };
            Error::file(format!("{}: there is no channel {name:?}; the channels are: {names}", self.source))
        })
    }

    /// True if there is a channel called `name`.
    pub fn has(&self, name: &str) -> bool {
        self.channels.iter().any(|c| c.name == name)
    }

    /// The values of the channel called `name`, converted to `unit`.
    ///
    /// # Errors
    /// No such channel, or one whose unit has another dimension.
    pub fn channel_in(&self, name: &str, unit: &str) -> Result<Vec<f64>> {
        let channel = self.channel(name)?;
        if channel.unit == unit {
            return Ok(channel.values.clone());
        }
        let parse =
            |text: &str| Unit::parse(text).map_err(|e| Error::file(e.to_string()).at(self.place(name)));
        let Some((factor, offset)) = parse(&channel.unit)?.to(parse(unit)?) else {
            return Err(Error::file(format!(
                "{}: recorded in {:?}, which cannot be converted to {unit:?}: the dimensions differ",
                self.place(name),
                channel.unit
            )));
        };
        Ok(channel.values.iter().map(|v| v * factor + offset).collect())
    }

    fn place(&self, channel: &str) -> String {
        format!("{}: channel {channel:?}", self.source)
    }

    /// Checks that the recording has samples for all of `start` to `stop` \[s\], so that nothing has to
    /// be extrapolated.
    ///
    /// # Errors
    /// It begins later or ends earlier; the message has both spans.
    pub fn covers(&self, start: f64, stop: f64) -> Result<()> {
        let (Some(first), Some(last)) = (self.time.first(), self.time.last()) else {
            return Err(Error::file(format!("{}: the recording is empty", self.source)));
        };
        if within(&self.time, start) && within(&self.time, stop) {
            return Ok(());
        }
        Err(Error::file(format!(
            "{}: recorded from {first} s to {last} s, but {start} s to {stop} s is needed; nothing is extrapolated",
            self.source
        )))
    }
}

/// True if `t` lies within the samples, or outside by no more than rounding.
fn within(time: &[f64], t: f64) -> bool {
    match time {
        [] => false,
        [only] => t == *only,
        [first, second, ..] => {
            let n = time.len();
            let (before, last) = (time[n - 2], time[n - 1]);
            t >= first - END_TOLERANCE * (second - first) && t <= last + END_TOLERANCE * (last - before)
        }
    }
}

/// Index of the interval that begins at or contains `t`; for the end of the recording the last one.
fn interval(time: &[f64], t: f64) -> Option<usize> {
    let last = time.len().checked_sub(2)?;
    within(time, t).then(|| time.partition_point(|x| *x <= t).saturating_sub(1).min(last))
}

/// The value at time `t` \[s\], linear between samples. `time` increases strictly.
///
/// Outside the samples the value is NaN, which every model refuses: [`Recording::covers`] says
/// beforehand, in words, whether that can happen.
pub fn interpolate(time: &[f64], values: &[f64], t: f64) -> f64 {
    let Some(i) = interval(time, t) else {
        return if time == [t] { values[0] } else { f64::NAN };
    };
    let share = ((t - time[i]) / (time[i + 1] - time[i])).clamp(0.0, 1.0);
    // this form gives the samples exactly
    values[i] * (1.0 - share) + values[i + 1] * share
}

/// The slope \[1/s\] of the interval between samples that begins at or contains time `t` \[s\]; at the
/// end of the recording that of the last interval, outside NaN.
///
/// It is the derivative that an input needs as long as no sample lies within a communication step.
pub fn slope(time: &[f64], values: &[f64], t: f64) -> f64 {
    match interval(time, t) {
        Some(i) => (values[i + 1] - values[i]) / (time[i + 1] - time[i]),
        None => f64::NAN,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn recording() -> Recording {
        Recording {
            time: vec![0.0, 0.1, 0.3],
            channels: vec![
                Channel { name: "speed".into(), unit: "km/h".into(), values: vec![36.0, 72.0, 0.0] },
                Channel { name: "tread".into(), unit: "degC".into(), values: vec![20.0, 21.0, 22.0] },
            ],
            source: "rig.csv".into(),
        }
    }

    #[test]
    fn channels_are_converted() {
        assert_eq!(recording().channel_in("speed", "m/s").unwrap(), [10.0, 20.0, 0.0]);
        assert_eq!(recording().channel_in("tread", "K").unwrap(), [293.15, 294.15, 295.15]);
        assert_eq!(recording().channel_in("speed", "km/h").unwrap(), [36.0, 72.0, 0.0]);
    }

    #[test]
    fn channel_errors_name_file_channel_and_units() {
        let message = recording().channel_in("speed", "N").unwrap_err().to_string();
        for word in ["rig.csv", "\"speed\"", "\"km/h\"", "\"N\""] {
            assert!(message.contains(word), "{message}");
        }
        let message = recording().channel_in("sped", "m/s").unwrap_err().to_string();
        for word in ["rig.csv", "\"sped\"", "speed, tread"] {
            assert!(message.contains(word), "{message}");
        }
        let message = recording().channel_in("speed", "furlong").unwrap_err().to_string();
        assert!(message.contains("rig.csv") && message.contains("furlong"), "{message}");
    }

    #[test]
    fn interpolates_between_samples_and_nowhere_else() {
        let (time, values) = ([0.0, 0.1, 0.3], [5.0, 7.0, 3.0]);
        for (t, value, rate) in
            [(0.0, 5.0, 20.0), (0.05, 6.0, 20.0), (0.1, 7.0, -20.0), (0.2, 5.0, -20.0), (0.3, 3.0, -20.0)]
        {
            assert!((interpolate(&time, &values, t) - value).abs() < 1e-12, "{t}");
            assert!((slope(&time, &values, t) - rate).abs() < 1e-9, "{t}");
        }
        for t in [-0.01, 0.31, f64::NAN, f64::INFINITY] {
            assert!(interpolate(&time, &values, t).is_nan(), "{t}");
            assert!(slope(&time, &values, t).is_nan(), "{t}");
        }
        // three tenths added up are a little more than the last sample
        assert_eq!(interpolate(&time, &values, 0.1 + 0.1 + 0.1), 3.0);
        assert_eq!(interpolate(&[2.0], &[9.0], 2.0), 9.0);
        assert!(interpolate(&[], &[], 0.0).is_nan());
    }

    #[test]
    fn says_what_is_not_covered() {
        assert!(recording().covers(0.0, 0.1 + 0.1 + 0.1).is_ok());
        for (start, stop) in [(-1.0, 0.2), (0.0, 0.4), (0.0, f64::NAN)] {
            let message = recording().covers(start, stop).unwrap_err().to_string();
            assert!(message.contains("rig.csv") && message.contains("0 s to 0.3 s"), "{message}");
        }
        assert!(Recording::default().covers(0.0, 0.0).is_err());
    }
}
