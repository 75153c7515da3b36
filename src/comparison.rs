//! How far a simulation is from what was measured: errors channel by channel, of free oscillations, and beside what repeated
//! recordings differ by. Both sides go through the same low-pass.

use crate::characteristic::swing::{Oscillation, oscillation};
use crate::recording::{Channel, Recording, interpolate};
use crate::stats::{deviation, extent, mean, median_interval, root_mean_square};
use crate::{Error, Result};
use std::f64::consts::{LN_2, TAU};

/// What simulation and measurement are compared under.
#[derive(Debug, Clone, Default)]
pub struct Conditions {
    /// Low-pass for both, at half the power \[Hz\].
    pub low_pass: Option<f64>,
    /// From where to where on \[s\] all swings freely.
    pub swing: Option<[f64; 2]>,
    /// Further recordings of the same run.
    pub repeats: Vec<Recording>,
}

impl Conditions {
    /// Anything is asked for.
    pub fn is_any(&self) -> bool {
        self.low_pass.is_some() || self.swing.is_some() || !self.repeats.is_empty()
    }
}

/// How far a channel is from its measurement. Errors are simulation less measurement.
#[derive(Debug, Clone)]
pub struct Difference {
    /// The channel.
    pub name: String,
    /// Unit of all that has one.
    pub unit: String,
    /// Samples at which both are there.
    pub samples: usize,
    /// Root mean square of the error.
    pub rms: f64,
    /// Mean of the error.
    pub bias: f64,
    /// Largest magnitude of the error.
    pub largest: f64,
    /// RMS error over the largest measured magnitude; none if that is 0.
    pub share_of_peak: Option<f64>,
    /// Share of the measured variance that the simulation explains; none if nothing varies.
    pub r2: Option<f64>,
    /// Error of the highest and of the lowest value.
    pub extremes: [f64; 2],
    /// Free oscillation, simulated and measured; or why there is none.
    pub swing: Option<Result<[Oscillation; 2]>>,
    /// What repeated recordings say, or why they say nothing; none without any.
    pub repeated: Option<Result<Repeated>>,
}

/// Repeated recordings of a channel, and how the simulation stands beside them.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Repeated {
    /// Recordings.
    pub runs: usize,
    /// Standard deviation of a recording about their mean.
    pub scatter: f64,
    /// RMS error of the simulation to the mean of all.
    pub rms: f64,
    /// Standard deviation over time of that mean.
    pub common: f64,
}

/// What a comparison with repeated recordings is worth.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Gate {
    /// The simulation is farther from the mean of the recordings than one of them is.
    Beyond,
    /// It is no farther off, but neither is much else: recordings differ by more than their mean varies.
    NotRepeatable,
    /// It is no farther off.
    Within,
}

impl Repeated {
    /// What the comparison is worth.
    pub fn gate(&self) -> Gate {
        if self.rms > self.scatter {
            Gate::Beyond
        } else if self.scatter >= self.common {
            Gate::NotRepeatable
        } else {
            Gate::Within
        }
    }
}

/// How far the window of a low-pass reaches, in its standard deviations: what is left out has a ten-thousandth of its weight.
const REACH: f64 = 4.0;
/// The highest frequency of a low-pass over the sampling rate. There, sums over samples are off by less than 1 % of the amplitude from what
/// the filter is; above, both sides would get different ones.
const HIGHEST: f64 = 0.2;

/// A recording behind a low-pass that has half the power at a frequency \[Hz\] and shifts nothing: a mean over time with the weights of a
/// bell curve, exp(-t²/2s²) with s = sqrt(ln 2) / (2 pi f). Samples need not be even. At both ends the mean is over what is there.
///
/// # Errors
/// A frequency that is none, or is more than a fifth of the sampling rate.
pub fn low_pass(recording: &Recording, frequency: f64) -> Result<Recording> {
    low_pass_of(recording, frequency, |_| true)
}

/// Both recordings behind the same [`low_pass`]; of the simulation those channels that were measured.
///
/// # Errors
/// As there.
pub fn behind_low_pass(
    simulated: &Recording,
    measured: &Recording,
    frequency: f64,
) -> Result<[Recording; 2]> {
    let smoothed = low_pass_of(simulated, frequency, |channel| measured.has(&channel.name))?;
    Ok([smoothed, low_pass(measured, frequency)?])
}

/// [`low_pass`] of some channels.
fn low_pass_of(recording: &Recording, frequency: f64, of: impl Fn(&Channel) -> bool) -> Result<Recording> {
    let mut passed = recording.clone();
    let time = &recording.time;
    if time.len() < 2 {
        return Ok(passed);
    }
    let interval = median_interval(time);
    if !(frequency > 0.0 && frequency <= HIGHEST / interval) {
        return Err(Error::call(format!(
            "{}: a low-pass of {frequency} Hz is not between 0 and a fifth of the sampling rate, {:.4} Hz",
            recording.source,
            HIGHEST / interval
        )));
    }
    let width = LN_2.sqrt() / (TAU * frequency);
    // the time that a sample stands for; beside a gap not for the gap
    let stands = |k: usize| {
        let (before, after) = (k.saturating_sub(1), (k + 1).min(time.len() - 1));
        (0.5 * (time[after] - time[before])).min(width)
    };
    let mut pairs: Vec<(&Channel, &mut Channel)> =
        recording.channels.iter().zip(&mut passed.channels).filter(|(raw, _)| of(raw)).collect();
    let (mut first, mut weights) = (0, Vec::new());
    for k in 0..time.len() {
        while time[first] < time[k] - REACH * width {
            first += 1;
        }
        weights.clear();
        weights.extend((first..time.len()).take_while(|i| time[*i] <= time[k] + REACH * width).map(|i| {
            let part = (time[i] - time[k]) / width;
            stands(i) * (-0.5 * part * part).exp()
        }));
        for (raw, passed) in &mut pairs {
            if raw.values[k].is_finite() {
                let (mut sum, mut all) = (0.0, 0.0);
                for (weight, value) in weights.iter().zip(&raw.values[first..]).filter(|(_, v)| v.is_finite())
                {
                    (sum, all) = (sum + weight * value, all + weight);
                }
                passed.values[k] = sum / all;
            }
        }
    }
    Ok(passed)
}

/// Compares every measured channel with the simulated one of its name, at the times of the measurement; low-passes are behind both.
/// Returns what was compared, and what could not be and why.
pub fn compare(
    simulated: &Recording,
    measured: &Recording,
    conditions: &Conditions,
) -> (Vec<Difference>, Vec<String>) {
    let (mut all, mut notes) = (Vec::new(), Vec::new());
    for channel in &measured.channels {
        match difference(simulated, measured, &channel.name, conditions) {
            Ok(difference) => all.push(difference),
            Err(e) => notes.push(e.to_string()),
        }
    }
    (all, notes)
}

fn difference(
    simulated: &Recording,
    measured: &Recording,
    name: &str,
    conditions: &Conditions,
) -> Result<Difference> {
    let own = simulated
        .channel(name)
        .map_err(|_| Error::file(format!("The measured channel {name:?} was not simulated.")))?;
    let values = measured.channel_in(name, &own.unit)?;
    let of_simulation = |t: f64| interpolate(&simulated.time, &own.values, t);
    let pairs: Vec<[f64; 3]> = measured
        .time
        .iter()
        .zip(&values)
        .map(|(t, v)| [*t, of_simulation(*t), *v])
        .filter(|[_, s, m]| s.is_finite() && m.is_finite())
        .collect();
    if pairs.is_empty() {
        return Err(Error::file(format!(
            "The measured channel {name:?} has no sample during the simulation."
        )));
    }
    let column = |i: usize| pairs.iter().map(move |pair| pair[i]);
    let errors: Vec<f64> = pairs.iter().map(|[_, s, m]| s - m).collect();
    let course: Vec<f64> = column(2).collect();
    let rms = root_mean_square(errors.iter().copied());
    let largest = |values: &[f64]| values.iter().fold(0.0_f64, |most, v| most.max(v.abs()));
    let (peak, varies) = (largest(&course), deviation(&course));
    let ((low, high), (own_low, own_high)) = (extent(column(2)), extent(column(1)));
    let swing = conditions.swing.map(|[from, to]| {
        let within: Vec<[f64; 3]> = pairs.iter().copied().filter(|[t, ..]| (from..=to).contains(t)).collect();
        both_swing(&within)
    });
    let repeats = &conditions.repeats;
    let repeated = (!repeats.is_empty()).then(|| repeated(&pairs, &own.unit, name, repeats));
    Ok(Difference {
        name: name.to_string(),
        unit: own.unit.clone(),
        samples: pairs.len(),
        rms,
        bias: mean(&errors),
        largest: largest(&errors),
        share_of_peak: (peak > 0.0).then(|| rms / peak),
        r2: (varies > 0.0).then(|| 1.0 - (rms / varies).powi(2)),
        extremes: [own_high - high, own_low - low],
        swing,
        repeated,
    })
}

/// The oscillations of simulation and measurement within a window: time, simulated, measured.
fn both_swing(within: &[[f64; 3]]) -> Result<[Oscillation; 2]> {
    let time: Vec<f64> = within.iter().map(|pair| pair[0]).collect();
    let [Some(first), Some(last)] = [time.first(), time.last()] else {
        return Err(Error::file("no samples are there"));
    };
    // evenly, as the fit takes them
    let step = median_interval(&time);
    let count = if step > 0.0 { ((last - first) / step).round() as usize } else { 0 };
    let even = |i: usize| -> Vec<f64> {
        let values: Vec<f64> = within.iter().map(|pair| pair[i]).collect();
        (0..=count).map(|k| interpolate(&time, &values, (first + step * k as f64).min(*last))).collect()
    };
    Ok([oscillation(&even(1), step)?, oscillation(&even(2), step)?])
}

/// What repeated recordings of a channel differ by, at times at which all are there.
fn repeated(pairs: &[[f64; 3]], unit: &str, name: &str, repeats: &[Recording]) -> Result<Repeated> {
    let others: Vec<(&Recording, Vec<f64>)> =
        repeats.iter().map(|r| Ok((r, r.channel_in(name, unit)?))).collect::<Result<_>>()?;
    let runs = 1.0 + others.len() as f64;
    let (mut squares, mut errors, mut means) = (0.0, Vec::new(), Vec::new());
    for [t, own, measured] in pairs {
        let mut all = vec![*measured];
        all.extend(others.iter().map(|(r, values)| interpolate(&r.time, values, *t)));
        if all.iter().all(|v| v.is_finite()) {
            let middle = mean(&all);
            squares += all.iter().map(|v| (v - middle) * (v - middle)).sum::<f64>();
            errors.push(own - middle);
            means.push(middle);
        }
    }
    if means.is_empty() {
        return Err(Error::file(format!("{name:?}: the repeated recordings have no time in common")));
    }
    Ok(Repeated {
        runs: repeats.len() + 1,
        scatter: (squares / ((runs - 1.0) * means.len() as f64)).sqrt(),
        rms: root_mean_square(errors),
        common: deviation(&means),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::stats::SplitMix64;

    fn course(step: f64, count: u32, of: impl Fn(f64) -> f64) -> Recording {
        let time: Vec<f64> = (0..count).map(|k| step * f64::from(k)).collect();
        let values = time.iter().map(|t| of(*t)).collect();
        let channel = Channel { name: "force".into(), unit: "N".into(), values };
        Recording { time, channels: vec![channel], source: "a test".into() }
    }

    /// Half the power at the frequency, nothing far above it, all far below, and no shift; on uneven samples too.
    #[test]
    fn the_low_pass_has_half_the_power_at_its_frequency() {
        let gain = |frequency: f64| {
            let mut wave = course(1e-3, 4000, |t| (TAU * frequency * t).sin());
            for (k, t) in wave.time.iter_mut().enumerate() {
                *t += 2e-4 * (1.7 * k as f64).sin();
            }
            let time = wave.time.clone();
            wave.channels[0].values = time.iter().map(|t| (TAU * frequency * t).sin()).collect();
            let passed = low_pass(&wave, 10.0).unwrap();
            let middle = 1000..3000;
            let (mut same, mut across) = (0.0, 0.0);
            for k in middle.clone() {
                let (sin, cos) = (TAU * frequency * time[k]).sin_cos();
                same += 2.0 * sin * passed.channels[0].values[k] / middle.len() as f64;
                across += 2.0 * cos * passed.channels[0].values[k] / middle.len() as f64;
            }
            assert!(across.abs() < 2e-3, "{frequency}: {across}");
            same
        };
        assert!((gain(10.0) - 0.5_f64.sqrt()).abs() < 5e-3, "{}", gain(10.0));
        assert!((gain(1.0) - 2.0_f64.powf(-0.005)).abs() < 2e-3, "{}", gain(1.0));
        assert!(gain(50.0).abs() < 1e-3, "{}", gain(50.0));
        // of 39 Hz, by where a cosine has its largest value
        let gain_at = |step: f64| {
            let wave = course(step, (1.0 / step) as u32, |t| (TAU * 39.0 * (t - 0.5)).cos());
            low_pass(&wave, 39.0).unwrap().channels[0].values[(0.5 / step).round() as usize]
        };
        let level = low_pass(&course(1e-3, 500, |_| 7.0), 10.0).unwrap();
        assert!(level.channels[0].values.iter().all(|v| (v - 7.0).abs() < 1e-12));
        assert!(low_pass(&level, 300.0).unwrap_err().to_string().contains("200"));
        // at the highest frequency two sampling rates still give the same
        assert!((gain_at(5e-3) - gain_at(1e-3)).abs() < 0.01, "{} {}", gain_at(5e-3), gain_at(1e-3));
    }

    /// Errors of a course with another level, a higher peak, a longer period and more damping.
    #[test]
    fn errors_are_told_as_they_were_made() {
        let decay = |t: f64, level: f64, size: f64, delta: f64, omega: f64| {
            level + size * (-delta * t).exp() * (omega * t).cos()
        };
        let measured = course(1e-3, 1500, |t| decay(t, 10.0, 2.0, 1.0, 30.0));
        let simulated = course(5e-4, 3000, |t| decay(t, 10.5, 2.2, 1.5, 29.0));
        let conditions = Conditions { swing: Some([0.1, 1.2]), ..Conditions::default() };
        let (all, notes) = compare(&simulated, &measured, &conditions);
        assert!(notes.is_empty(), "{notes:?}");
        let it = &all[0];
        assert!((it.extremes[0] - 0.7).abs() < 1e-9, "{:?}", it.extremes);
        assert!((it.bias - 0.5).abs() < 0.02, "{}", it.bias);
        let Some(Ok([own, there])) = &it.swing else { panic!("{:?}", it.swing) };
        assert!((own.period.value / there.period.value - 30.0 / 29.0).abs() < 1e-6);
        let ratio = own.decrement.value / there.decrement.value;
        assert!((ratio - 1.5 * 30.0 / 29.0).abs() < 1e-5, "{ratio}");
        // a tenth too much of a sine about a level: a hundredth of the variance, a tenth of the amplitude at both ends
        let wave = |size: f64| course(1e-3, 4000, move |t| 3.0 + size * (TAU * 2.0 * t).sin());
        let (all, _) = compare(&wave(1.1), &wave(1.0), &Conditions::default());
        assert!((all[0].r2.unwrap() - 0.99).abs() < 1e-6 && (all[0].rms - 0.1 / 2.0_f64.sqrt()).abs() < 1e-6);
        assert!((all[0].extremes[0] - 0.1).abs() < 1e-6 && (all[0].extremes[1] + 0.1).abs() < 1e-6);
        assert!((all[0].share_of_peak.unwrap() - all[0].rms / 4.0).abs() < 1e-6);
        // what is not there is said
        let mut other = measured.clone();
        other.channels[0].name = "moment".into();
        let (none, notes) = compare(&simulated, &other, &Conditions::default());
        assert!(none.is_empty() && notes[0].contains("moment"));
        let still = Conditions { swing: Some([7.0, 8.0]), ..Conditions::default() };
        assert!(matches!(compare(&simulated, &measured, &still).0[0].swing, Some(Err(_))));
    }

    /// Repeats that scatter by a known size: a right simulation is within it, a wrong one beyond, and of noise nothing is said.
    #[test]
    fn repeats_open_and_close_the_gate() {
        let mut random = SplitMix64::new(5);
        let mut noisy = |size: f64| {
            let mut one = course(1e-2, 2000, |t| size * t.sin());
            one.channels[0].values.iter_mut().for_each(|v| *v += 0.1 * random.normal());
            one
        };
        let runs = [noisy(1.0), noisy(1.0), noisy(1.0)];
        let conditions = Conditions { repeats: runs[1..].to_vec(), ..Conditions::default() };
        let gate = |size: f64| {
            let simulated = course(1e-2, 2000, |t| size * t.sin());
            let repeated = compare(&simulated, &runs[0], &conditions).0.remove(0).repeated.unwrap().unwrap();
            assert_eq!(repeated.runs, 3);
            assert!((repeated.scatter / 0.1 - 1.0).abs() < 0.05, "{repeated:?}");
            repeated.gate()
        };
        assert_eq!(gate(1.0), Gate::Within);
        assert_eq!(gate(1.3), Gate::Beyond);
        // a recording without the channel costs only what it would say
        let mut other = runs[1].clone();
        other.channels[0].name = "moment".into();
        let lacking = Conditions { repeats: vec![other], ..Conditions::default() };
        let (all, _) = compare(&runs[0], &runs[0], &lacking);
        assert!(matches!(&all[0].repeated, Some(Err(e)) if e.to_string().contains("force")));
        let runs = [noisy(0.0), noisy(0.0)];
        let conditions = Conditions { repeats: runs[1..].to_vec(), ..Conditions::default() };
        let repeated = compare(&runs[0], &runs[0], &conditions).0.remove(0).repeated.unwrap().unwrap();
        assert_eq!(repeated.gate(), Gate::NotRepeatable);
        // a wrong level is wrong, however little varies
        let off = course(1e-2, 2000, |_| 2.0);
        assert_eq!(
            compare(&off, &runs[0], &conditions).0.remove(0).repeated.unwrap().unwrap().gate(),
            Gate::Beyond
        );
    }
}
