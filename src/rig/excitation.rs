//! What a test rig adds to its command by itself: a sine, a sweep, a random band.

use crate::model::{Purpose, Table, integer_parameter, parameter};
use crate::{integer, real};
use serde::{Deserialize, Serialize};
use std::f64::consts::TAU;

/// Kinds, as items of an enumeration from 1.
const KINDS: &[(&str, &str)] = &[
    ("none", "what the input says and nothing else, as with a recording"),
    ("sine", "amplitude at frequency"),
    (
        "sweep",
        "from frequency to frequency_end within excitation_time, in proportion to the time; then at the end",
    ),
    (
        "band",
        "a random course of lines between frequency and frequency_end, of the root mean square of a sine of that amplitude",
    ),
];

/// Lines of a random band.
const LINES: u32 = 48;
/// Two irrational numbers whose multiples spread phases and frequencies evenly: the golden ratio and the root of 2, less 1.
const SPREAD: [f64; 2] = [0.618_033_988_749_894_9, 0.414_213_562_373_095_1];

/// An excitation around a command, in the command's unit.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct Excitation {
    kind: i32,
    amplitude: f64,
    frequency: f64,
    frequency_end: f64,
    time: f64,
    seed: i32,
}

impl Excitation {
    /// Kind, size and frequencies.
    #[rustfmt::skip] // a row is a line
    pub(super) fn rows() -> Table<Self> {
        Table::new([
            integer_parameter("excitation", integer!(kind), 1, "What the rig adds to the command that it controls").items(KINDS).purpose(Purpose::Data),
            parameter("excitation_amplitude", "1", real!(amplitude), 0.0, "Amplitude, in N or in m as what is controlled").range(0.0, 1e6).purpose(Purpose::Data),
            parameter("excitation_frequency", "Hz", real!(frequency), 1.0, "Frequency of the sine; lower end of sweep and band").range(1e-3, 500.0).purpose(Purpose::Data),
            parameter("excitation_frequency_end", "Hz", real!(frequency_end), 10.0, "Upper end of sweep and band").range(1e-3, 500.0).purpose(Purpose::Data),
            parameter("excitation_time", "s", real!(time), 10.0, "Duration of the sweep").range(1e-2, 1e4).purpose(Purpose::Data),
            integer_parameter("excitation_seed", integer!(seed), 1, "Number of the random band").range(1.0, 1e6).purpose(Purpose::Data),
        ])
    }

    /// Value and rate at a time since the start \[s\].
    pub fn at(&self, time: f64) -> (f64, f64) {
        let sine = |frequency: f64, phase: f64| {
            let (sin, cos) = libm::sincos(TAU * frequency * time + phase);
            (sin, TAU * frequency * cos)
        };
        let (value, rate) = match self.kind {
            2 => sine(self.frequency, 0.0),
            3 => {
                // turns since the start, and their rate
                let growth = (self.frequency_end - self.frequency) / self.time;
                let within = time.min(self.time);
                let turns = (self.frequency + 0.5 * growth * within) * within;
                let frequency = self.frequency + growth * within;
                let (sin, cos) = libm::sincos(TAU * (turns + frequency * (time - within)));
                (sin, TAU * frequency * cos)
            }
            4 => {
                let size = 1.0 / libm::sqrt(f64::from(LINES));
                let line = |k: u32| {
                    let of = |i: usize| {
                        libm::fmod(
                            f64::from(k) * f64::from(self.seed) * SPREAD[i]
                                + f64::from(k * k) * SPREAD[1 - i],
                            1.0,
                        )
                    };
                    let place = (f64::from(k) + of(0)) / f64::from(LINES);
                    let (value, rate) =
                        sine(self.frequency + place * (self.frequency_end - self.frequency), TAU * of(1));
                    (size * value, size * rate)
                };
                (0..LINES).map(line).fold((0.0, 0.0), |sum, line| (sum.0 + line.0, sum.1 + line.1))
            }
            _ => (0.0, 0.0),
        };
        (self.amplitude * value, self.amplitude * rate)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn excitation(kind: i32) -> Excitation {
        Excitation { kind, amplitude: 3.0, frequency: 2.0, frequency_end: 9.0, time: 5.0, seed: 7 }
    }

    #[test]
    fn rates_are_derivatives() {
        for kind in 1..=4 {
            let excitation = excitation(kind);
            for time in [0.3, 2.7, 4.999, 6.1] {
                let h = 1e-6;
                let slope = (excitation.at(time + h).0 - excitation.at(time - h).0) / (2.0 * h);
                assert!((excitation.at(time).1 - slope).abs() < 1e-4 * 3.0 * TAU * 9.0, "{kind} {time}");
            }
        }
    }

    /// A sweep has so many turns as its mean frequency makes; a band has the power of a sine, and nothing outside.
    #[test]
    fn a_sweep_ends_at_its_end_and_a_band_has_the_power_of_a_sine() {
        let sweep = excitation(3);
        assert!((sweep.at(5.0).0 - 3.0 * (TAU * 5.5 * 5.0).sin()).abs() < 1e-9);
        assert!((sweep.at(5.0 + 1.0 / 9.0).0 - sweep.at(5.0).0).abs() < 1e-9);
        let band = excitation(4);
        let n = 200_000;
        let mean = (0..n).map(|k| band.at(1e-3 * f64::from(k)).0.powi(2)).sum::<f64>() / f64::from(n);
        assert!((mean / 4.5 - 1.0).abs() < 0.02, "{mean}");
        assert!(band.at(1.0) != Excitation { seed: 8, ..band }.at(1.0));
    }
}
