//! Channels of a recording as analyses need them: in SI units, whole, not clipped, and at equal distances in time.

use crate::recording::{Recording, Smooth};
use crate::stats::{extent, median_interval};
use crate::{Error, Result};

/// Samples at an end of a channel's range over those of the next value, from which on the channel is clipped. At the top of
/// an oscillation, rounded values are there 2.4 times as often as at the next step below (the square root of 2 makes it), and
/// scatter makes it less; 8 is beyond both.
const CLIPPED: usize = 8;
/// Fewer samples at an end show nothing.
const FEW: usize = 8;
/// Intervals longer than this many usual ones are a gap: over two, straight lines or cubics still follow an oscillation that
/// is sampled ten times.
const GAP: f64 = 2.5;
/// Fewer samples in a recording than this are no oscillation.
const LEAST: usize = 30;

/// Which ends of a range may be reached for a good reason.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Ends {
    /// None: both are looked at.
    Neither,
    /// The lower one: a load cell reads the same all the time that a tire is off the road.
    Lower,
}

/// Refuses a channel that stays at an end of its range as a sensor or an amplifier does that can show no more.
///
/// # Errors
/// The channel, the value, and how often it is there.
pub fn refuse_clipped(recording: &Recording, channel: &str, values: &[f64], free: Ends) -> Result<()> {
    let (low, high) = extent(values.iter().copied());
    if high.is_nan() || low.is_nan() || high <= low {
        return Err(Error::numeric(format!(
            "{}: channel {channel:?} has the same value all the time, {low}: nothing was measured, or another channel is meant",
            recording.source
        )));
    }
    for (end, other, is_free) in [(high, low, false), (low, high, free == Ends::Lower)] {
        if is_free {
            continue;
        }
        let inward = (other - end).signum();
        let distance = |v: &f64| (v - end) * inward;
        let next = values.iter().filter(|v| distance(v) > 0.0).map(distance).fold(f64::INFINITY, f64::min);
        let at = values.iter().filter(|v| **v == end).count();
        let beside = values.iter().filter(|v| distance(v) == next).count();
        if at >= FEW && at >= CLIPPED * beside {
            let first = values.iter().position(|v| *v == end).unwrap_or(0);
            let unit = recording.channel(channel).map(|c| c.unit.clone()).unwrap_or_default();
            return Err(Error::numeric(format!(
                "{}: channel {channel:?} [{unit}] is clipped: {at} of {} samples are exactly at the {} end of its range, the first at {} s, and next to none beside it. What was beyond is lost; measure again with a wider range",
                recording.source,
                values.len(),
                if inward < 0.0 { "upper" } else { "lower" },
                recording.time[first],
            )));
        }
    }
    Ok(())
}

/// Channels at equal distances in time.
#[derive(Debug, Clone, PartialEq)]
pub struct Even {
    /// Time of the first sample \[s\].
    pub start: f64,
    /// Distance \[s\].
    pub step: f64,
    /// The channels.
    pub values: Vec<Vec<f64>>,
}

impl Even {
    /// From a recording's time and channels: as they are where the clock is even, otherwise from a smooth course through the samples.
    ///
    /// # Errors
    /// Too few samples, or a gap, with its time.
    pub fn of(recording: &Recording, channels: Vec<Vec<f64>>) -> Result<Self> {
        let time = &recording.time;
        let n = time.len();
        if n < LEAST {
            return Err(Error::numeric(format!(
                "{}: {n} samples; at least {LEAST} are needed to see an oscillation",
                recording.source
            )));
        }
        let usual = median_interval(time);
        if let Some(k) = (1..n).find(|k| time[*k] - time[k - 1] > GAP * usual) {
            return Err(Error::numeric(format!(
                "{}: a gap from {} s to {} s, where samples are usually {usual} s apart: cut the recording there and give the parts by themselves",
                recording.source,
                time[k - 1],
                time[k]
            )));
        }
        let (start, step) = (time[0], (time[n - 1] - time[0]) / (n - 1) as f64);
        let off = (0..n).map(|k| (time[k] - start - k as f64 * step).abs()).fold(0.0, f64::max);
        // by a hundredth of an interval a course is not another one
        let is_even = off < 0.01 * step;
        let even = |values: Vec<f64>| match is_even {
            true => values,
            false => {
                let smooth = Smooth::new(time, &values);
                (0..n).map(|k| smooth.at(start + k as f64 * step)).collect()
            }
        };
        Ok(Self { start, step, values: channels.into_iter().map(even).collect() })
    }

    /// Time of a place that may be between samples \[s\].
    pub fn time(&self, place: f64) -> f64 {
        self.start + self.step * place
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::recording::Channel;
    use crate::stats::SplitMix64;

    fn recording(values: Vec<f64>) -> Recording {
        Recording {
            time: (0..values.len()).map(|k| 1e-3 * k as f64).collect(),
            channels: vec![Channel { name: "w".into(), unit: "mm".into(), values }],
            source: "rig.csv".into(),
        }
    }

    fn is_clipped(values: Vec<f64>, free: Ends) -> bool {
        let recording = recording(values.clone());
        refuse_clipped(&recording, "w", &values, free).is_err()
    }

    #[test]
    fn a_sensor_at_its_end_is_told_from_the_top_of_an_oscillation() {
        let sine = |limit: f64, quantum: f64, noise: f64| -> Vec<f64> {
            let mut random = SplitMix64::new(1);
            (0..5000)
                .map(|k| (12.0 * (f64::from(k) * 6.28e-3).sin() + noise * random.normal()).min(limit))
                .map(|v| if quantum > 0.0 { (v / quantum).round() * quantum } else { v })
                .collect()
        };
        for quantum in [0.0, 0.005, 0.05, 0.3] {
            for noise in [0.0, 0.05] {
                assert!(!is_clipped(sine(20.0, quantum, noise), Ends::Neither), "{quantum} {noise}");
                if quantum < 0.1 {
                    assert!(is_clipped(sine(9.0, quantum, noise), Ends::Neither), "{quantum} {noise}");
                    let down: Vec<f64> = sine(9.0, quantum, noise).iter().map(|v| -v).collect();
                    assert!(!is_clipped(down.clone(), Ends::Lower) && is_clipped(down, Ends::Neither));
                }
            }
        }
        let all = recording(vec![1.0; 40]);
        assert!(
            refuse_clipped(&all, "w", &[1.0; 40], Ends::Neither)
                .unwrap_err()
                .to_string()
                .contains("same value")
        );
    }

    #[test]
    fn gaps_are_told_and_a_clock_that_scatters_is_made_even() {
        let mut scattered = recording((0..400).map(f64::from).collect());
        let mut random = SplitMix64::new(2);
        scattered.time.iter_mut().for_each(|t| *t += 3e-4 * (random.uniform() - 0.5));
        let values: Vec<f64> = scattered.time.iter().map(|t| (40.0 * t).sin()).collect();
        let even = Even::of(&scattered, vec![values]).unwrap();
        for (k, v) in even.values[0].iter().enumerate() {
            let exact = (40.0 * even.time(k as f64)).sin();
            assert!((v - exact).abs() < 1e-4, "{k}: {v} {exact}");
        }
        scattered.time.iter_mut().skip(200).for_each(|t| *t += 0.05);
        let values = scattered.channels[0].values.clone();
        assert!(Even::of(&scattered, vec![values]).unwrap_err().to_string().contains("gap from 0.19"));
        assert!(Even::of(&recording(vec![0.0; 5]), vec![vec![0.0; 5]]).is_err());
    }
}
