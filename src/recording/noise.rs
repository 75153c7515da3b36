//! Noise of sensors, for recordings that stand in for those of a rig.

use super::Recording;
use crate::stats::{SplitMix64, extent};

/// Adds white, normally distributed noise to the channels that are measured. Its standard deviation is a share of what a channel
/// ranges over in all recordings together; the same seed gives the same noise.
pub fn add_noise(recordings: &mut [Recording], is_measured: impl Fn(&str) -> bool, share: f64, seed: u64) {
    let mut random = SplitMix64::new(seed);
    let mut names: Vec<String> =
        recordings.iter().flat_map(|r| &r.channels).map(|c| c.name.clone()).collect();
    names.sort();
    names.dedup();
    for name in names.iter().filter(|name| is_measured(name)) {
        let mut channels: Vec<_> =
            recordings.iter_mut().flat_map(|r| &mut r.channels).filter(|c| c.name == *name).collect();
        let (low, high) = extent(channels.iter().flat_map(|c| c.values.iter().copied()));
        let size = share * (high - low);
        for value in channels.iter_mut().flat_map(|c| &mut c.values) {
            *value += size * random.normal();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::recording::Channel;
    use crate::stats::{deviation, mean};

    fn recording(ends: [f64; 2]) -> Recording {
        let time: Vec<f64> = (0..20_000).map(f64::from).collect();
        let values = time.iter().map(|t| if *t < 10_000.0 { ends[0] } else { ends[1] }).collect();
        let force = Channel { name: "force".into(), unit: "N".into(), values };
        let slip = Channel { name: "slip".into(), ..force.clone() };
        Recording { time, channels: vec![force, slip], source: String::new() }
    }

    /// 1 % of 400, though no recording goes as far alone.
    #[test]
    fn what_is_measured_has_a_share_of_its_whole_range() {
        let clean = [recording([-100.0, 50.0]), recording([0.0, 300.0])];
        let mut noisy = clean.clone();
        add_noise(&mut noisy, |name| name == "force", 0.01, 7);
        for (noisy, clean) in noisy.iter().zip(&clean) {
            assert_eq!(noisy.channels[1], clean.channels[1]);
            let errors: Vec<f64> =
                noisy.channels[0].values.iter().zip(&clean.channels[0].values).map(|(a, b)| a - b).collect();
            assert!((deviation(&errors) / 4.0 - 1.0).abs() < 0.03 && mean(&errors).abs() < 0.15);
        }
        let [mut again, mut other] = [clean.clone(), clean];
        add_noise(&mut again, |name| name == "force", 0.01, 7);
        add_noise(&mut other, |name| name == "force", 0.01, 8);
        assert!(again == noisy && other != noisy);
    }
}
