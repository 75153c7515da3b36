//! What the flat-track rig drives: sweeps of slip angle and slip, steps, bands and lifts at several speeds and loads.

use crate::programme::{Region, Wave};
use crate::random::Random;

/// Height of the wheel centre that a run may not fall below in contact \[m\] of deflection.
const LEAST_DEFLECTION: f64 = 4e-3;

/// Per input of run number `index` its mean, its wave and the least value.
pub(crate) fn waves(
    random: &mut Random,
    duration: f64,
    region: &Region,
    index: usize,
) -> Vec<(f64, Wave, f64)> {
    const ANY: f64 = f64::NEG_INFINITY;
    let level = random.log_within(0.5, 1.0);
    let speed = random.within(region.speed.0, region.speed.1);
    let deflection = random.within(0.012, 0.024);
    // rad, 1, rad, m, m/s
    let (angle, slip, camber, lift, pace) = (0.1 * level, 0.08 * level, 0.06, 3e-3, 0.25 * speed);
    let top = 4.0 * region.band;
    let slow = |random: &mut Random, amplitude| Wave::triangle(random, amplitude, (4.0, 8.0));
    // what moves mass has no corners: only sweeps (0) and bands (3) are smooth
    let smooth = |random: &mut Random, amplitude, band| {
        let kind = random.pick(&[0, 3]);
        Wave::of(kind, random, amplitude, band, duration)
    };
    let band = (0.2, top);
    let mut all = [Wave::Rest, Wave::Rest, Wave::Rest, Wave::Rest, Wave::Rest];
    match index % 10 {
        0 => all[2] = slow(random, angle),
        1 => all[3] = slow(random, slip),
        2 => all[2] = Wave::of(0, random, 0.6 * angle, band, duration),
        3 => {
            all[4] = smooth(random, camber, (0.1, 0.5));
            all[2] = Wave::steps(random, 0.3 * angle, duration, 0.3);
        }
        4 => {
            all[2] = slow(random, angle);
            all[3] = Wave::of(3, random, 0.7 * slip, band, duration);
        }
        5 => {
            all[1] = smooth(random, lift, (0.3, 6.0 * region.band));
            all[2] = Wave::steps(random, 0.5 * angle, duration, 0.3);
        }
        6 => all[2] = Wave::steps(random, 0.7 * angle, duration, 0.15),
        7 => all[3] = Wave::of(0, random, 0.7 * slip, band, duration),
        8 => {
            all[0] = Wave::of(3, random, pace, (0.1, 0.4), duration);
            all[2] = slow(random, angle);
        }
        _ => {
            all[1] = smooth(random, lift, (0.3, 2.0));
            all[2] = Wave::draw(random, 0.7 * angle, band, duration);
            all[3] = Wave::draw(random, 0.5 * slip, band, duration);
            all[4] = smooth(random, camber, (0.1, 0.5));
        }
    }
    let means = [speed, deflection, 0.0, 0.0, 0.0];
    let least = [2.0, LEAST_DEFLECTION, ANY, ANY, ANY];
    means.into_iter().zip(all).zip(least).map(|((mean, wave), least)| (mean, wave, least)).collect()
}
