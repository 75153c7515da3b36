//! Spikes, rails and frozen values, which a recording shows by itself.

use super::*;

#[test]
fn what_swings_out_and_back_is_no_spike_and_what_jumps_is() {
    let mut random = Random::new(4);
    let rest: Vec<f64> = (0..400).map(|k| (0.05 * k as f64).sin() + 0.02 * random.normal()).collect();
    // a motor that is switched on: an acceleration of seven samples that comes and goes as its voltage rises
    let pulse = [1.0, 3.5, 6.4, 7.9, 6.7, 3.5, 0.8];
    let glitch = [0.0, 0.0, 0.0, 7.9, 0.0, 0.0, 0.0];
    let spikes = |with: [f64; 7]| {
        let mut values = rest.clone();
        values[200..207].iter_mut().zip(with).for_each(|(v, more)| *v += more);
        let channel = Channel { name: "acceleration".into(), unit: "m/s2".into(), values };
        let time = (0..400).map(|k| 0.01 * k as f64).collect();
        let raw =
            RawRecording::new(Recording { source: "run".into(), time, channels: vec![channel] }).unwrap();
        raw.faults.iter().filter(|f| f.kind == FaultKind::Spikes).count()
    };
    assert_eq!((spikes(pulse), spikes(glitch)), (0, 1));
}

/// An encoder of a joint that friction holds for a while at each turn, in counts, averaged over twenty samples. Each turn is at
/// another place, the lowest of them twice.
#[test]
fn a_joint_that_rests_where_it_turns_has_no_rail() {
    let ends = [0.394, 0.397, 0.393, 0.401, 0.393, 0.399];
    let course = |t: f64| {
        let (cycle, phase) = ((t / 3.0) as usize, 2.0 * (t / 3.0).fract());
        // down, held, up again
        let way = if phase < 0.8 {
            phase / 0.8
        } else if phase < 1.2 {
            1.0
        } else {
            (2.0 - phase) / 0.8
        };
        let smooth = way * way * (3.0 - 2.0 * way);
        1.3 - (1.3 - ends[cycle.min(5)]) * smooth
    };
    let rails = |least: f64| {
        let mut random = Random::new(8);
        let count = std::f64::consts::TAU / 4000.0;
        let values: Vec<f64> = (0..900)
            .map(|k| {
                let sample = |j: usize| {
                    let exact = course(1e-3 * (20 * k + j) as f64) + 1e-4 * random.normal();
                    (exact / count).round().max(least) * count
                };
                (0..20).map(sample).sum::<f64>() / 20.0
            })
            .collect();
        let time = (0..900).map(|k| 0.02 * k as f64).collect();
        let channel = Channel { name: "angle".into(), unit: "rad".into(), values };
        let raw =
            RawRecording::new(Recording { source: "run".into(), time, channels: vec![channel] }).unwrap();
        raw.faults.iter().filter(|f| f.kind == FaultKind::Saturated).count()
    };
    // one whose sensor ends before it turns has one
    assert_eq!((rails(0.0), rails(290.0)), (0, 1));
}

/// A speed with noise of its last digit that is frozen until the end, and a joint that friction brings to rest until then.
#[test]
fn what_stays_until_the_end_is_stuck_if_it_did_not_slow_down() {
    let stuck = |course: &dyn Fn(f64) -> f64| {
        let mut random = Random::new(4);
        let mut frozen = None;
        let mut values = Vec::new();
        let time: Vec<f64> = (0..1000).map(|k| 0.005 * f64::from(k)).collect();
        for t in &time {
            let value = (1e3 * (course(*t) + 1e-3 * random.normal())).round() / 1e3;
            // friction holds what is at rest
            values.push(if *t > 3.5 { *frozen.get_or_insert(value) } else { value });
        }
        let other = time.iter().map(|t| (5.0 * t).sin() + 1e-4 * random.normal()).collect();
        let channels = vec![
            Channel { name: "speed".into(), unit: "m/s".into(), values },
            Channel { name: "force".into(), unit: "N".into(), values: other },
        ];
        let raw = RawRecording::new(Recording { source: "run".into(), time, channels }).unwrap();
        raw.faults.iter().filter(|f| f.kind == FaultKind::Stuck).count()
    };
    assert_eq!(stuck(&|t| 0.3 * (7.0 * t).sin()), 1);
    // the same until it slows down evenly, 40 ms before it stays
    let slow = |t: f64| {
        let (last, speed) = (0.3 * (7.0 * 3.46_f64).sin(), 2.1 * (7.0 * 3.46_f64).cos());
        let left = (3.5 - t).clamp(0.0, 0.04);
        if t < 3.46 { 0.3 * (7.0 * t).sin() } else { last + speed * (0.02 - left * left / 0.08) }
    };
    assert_eq!(stuck(&slow), 0);
}
