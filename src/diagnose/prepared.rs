//! What recordings themselves ask for before they are compared: samples after a long gap and samples at a rail are left out, angles
//! count on.

use super::hygiene;
use crate::recording::Recording;
use crate::stats::median_interval;
use std::f64::consts::TAU;

/// A gap of more intervals is long: hygiene takes five for a gap, which inputs that are bridged survive.
const LONG_GAP: f64 = 20.0;
/// The share of a run that is most of it.
const MOST: f64 = 0.5;

/// Leaves out what comes after a long gap, if most of the run was before it: no model knows what happened in the gap, so that
/// the state after it is unknown. Returns whether the states in what is left are known.
pub(super) fn leave_out_after(recording: &mut Recording, gap: &mut hygiene::Fault) -> bool {
    let time = &recording.time;
    let (Some(first), Some(last)) = (time.first(), time.last()) else { return true };
    let usual = median_interval(time);
    let Some(k) = time.windows(2).position(|w| w[1] - w[0] > LONG_GAP * usual) else { return true };
    let is_cut = gap.severity == hygiene::Severity::Repaired && time[k] - first > MOST * (last - first);
    if is_cut {
        recording.time.truncate(k + 1);
        recording.channels.iter_mut().for_each(|c| c.values.truncate(k + 1));
        gap.advice = "What happened in it is unknown: only what was recorded before it is used.".into();
    }
    is_cut
}

/// Leaves out of what is compared the rows in which a channel is at its rail: what it would have shown is unknown there. A rail is
/// one for all runs. Takes from the faults those of runs in which that are few enough, and returns them.
pub(super) fn leave_out_rails(
    names: &[String],
    recordings: &mut [Recording],
    faults: &mut Vec<hygiene::Fault>,
) -> Vec<hygiene::Fault> {
    let is_rail = |f: &hygiene::Fault| f.kind == hygiene::FaultKind::Saturated;
    let mut rails: Vec<(String, f64)> = Vec::new();
    for fault in faults.iter().filter(|f| is_rail(f)) {
        rails.extend(
            fault.channel.clone().map(|channel| (channel, fault.value)).filter(|r| !rails.contains(r)),
        );
    }
    let mut left_out: Vec<&String> = Vec::new();
    for (name, recording) in names.iter().zip(&mut *recordings) {
        let mut at_rail = vec![false; recording.time.len()];
        for (channel, rail) in &rails {
            let Ok(values) = recording.channel(channel).map(|c| &c.values) else { continue };
            let rows = hygiene::at_rail(&recording.time, values, *rail);
            at_rail.iter_mut().zip(rows).for_each(|(all, own)| *all |= own);
        }
        let count = at_rail.iter().filter(|a| **a).count();
        if (count as f64) < (1.0 - MOST) * at_rail.len() as f64 {
            hygiene::leave_out_rows(recording, &at_rail);
            left_out.push(name);
        }
    }
    let is_left_out = |f: &hygiene::Fault| is_rail(f) && f.runs.iter().all(|run| left_out.contains(&run));
    let (mut aside, others): (Vec<hygiene::Fault>, Vec<hygiene::Fault>) =
        std::mem::take(faults).into_iter().partition(is_left_out);
    *faults = others;
    for fault in &mut aside {
        fault.advice = format!("{}. Until then these samples are not compared.", hygiene::RAIL_ADVICE);
    }
    aside
}

/// Has an angle \[rad\] count on that an encoder begins anew with each turn.
pub(super) fn unwrap(angle: &mut [f64]) {
    let (least, most) =
        angle.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), v| (a.min(*v), b.max(*v)));
    // what spans more than a turn, and its noise, counts on already
    if most - least > 1.1 * TAU {
        return;
    }
    let mut turns = 0.0;
    let mut last = angle.first().copied().unwrap_or_default();
    for value in angle {
        turns -= ((*value - last) / TAU).round();
        last = *value;
        *value += TAU * turns;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::recording::Channel;

    #[test]
    fn angles_that_begin_anew_with_each_turn_count_on() {
        let truth: Vec<f64> = (0..400).map(|k| 1.0 + 8.0 * (0.01 * f64::from(k)).sin()).collect();
        // a hair of noise, so that it spans a little more than a turn
        let noise = |k: usize| 1e-3 * (k as f64).sin();
        let noisy = |(k, a): (usize, &f64)| a.rem_euclid(TAU) + noise(k);
        let mut angle: Vec<f64> = truth.iter().enumerate().map(noisy).collect();
        unwrap(&mut angle);
        assert!(angle.iter().zip(&truth).all(|(a, t)| (a - t).abs() < 2e-3));
        // half a turn and more from sample to sample, but not wrapped
        let fast: Vec<f64> = (0..9).map(|k| 5.0 * f64::from(k)).collect();
        let mut same = fast.clone();
        unwrap(&mut same);
        assert_eq!(same, fast);
    }

    #[test]
    fn what_comes_after_a_long_gap_is_left_out_if_most_was_before_it() {
        // 10 s at 100 Hz, without some of them
        let with_gaps = |gaps: &[(f64, f64)]| {
            let is_there = |t: &f64| gaps.iter().all(|(from, to)| t <= from || t >= to);
            let time: Vec<f64> = (0..1000).map(|k| 0.01 * f64::from(k)).filter(is_there).collect();
            let channels = vec![Channel { name: "force".into(), unit: "N".into(), values: time.clone() }];
            let mut recording = Recording { source: "a.csv".into(), time, channels };
            let mut gap = fault(hygiene::FaultKind::Gap, "a.csv", None, 1.0);
            let is_known = leave_out_after(&mut recording, &mut gap);
            assert_eq!(recording.channels[0].values, recording.time);
            (recording.time.len(), gap.advice.contains("before it is used"), is_known)
        };
        assert_eq!(with_gaps(&[(7.0, 7.8)]), (701, true, true));
        // short, and early
        assert_eq!(with_gaps(&[(7.0, 7.1)]), (991, false, true));
        assert_eq!(with_gaps(&[(2.0, 2.8)]), (921, false, false));
        // a short one costs nothing of what comes before a long one
        assert_eq!(with_gaps(&[(6.0, 6.1), (7.0, 7.8)]), (692, true, true));
    }

    fn fault(kind: hygiene::FaultKind, run: &str, channel: Option<&str>, value: f64) -> hygiene::Fault {
        hygiene::Fault {
            kind,
            severity: hygiene::Severity::Repaired,
            runs: vec![run.into()],
            channel: channel.map(Into::into),
            span: None,
            value,
            unit: "1".into(),
            evidence: String::new(),
            advice: String::new(),
        }
    }

    #[test]
    fn what_is_at_a_rail_is_left_out_in_all_runs_but_not_most_of_one() {
        let mut random = crate::stats::SplitMix64::new(4);
        // between rails at 1 and -0.8, noise and all
        let mut swing = |amplitude: f64| -> Recording {
            let time: Vec<f64> = (0..1000).map(|k| 0.01 * f64::from(k)).collect();
            let clean: Vec<f64> = time.iter().map(|t| amplitude * t.sin()).collect();
            let values: Vec<f64> =
                clean.iter().map(|v| (v + 0.01 * random.normal()).clamp(-0.8, 1.0)).collect();
            let channel =
                |name: &str, values: Vec<f64>| Channel { name: name.into(), unit: "1".into(), values };
            let channels = vec![channel("angle", values), channel("clean", clean)];
            Recording { source: "a run".into(), time, channels }
        };
        let mut recordings = [swing(1.1), swing(0.9), swing(9.0), swing(0.5)];
        let before = recordings.clone();
        let names: Vec<String> = ["a", "b", "c", "d"].map(Into::into).to_vec();
        let rail = |run: &str, value: f64| fault(hygiene::FaultKind::Saturated, run, Some("angle"), value);
        let mut faults = vec![rail("a", 1.0), rail("a", -0.8), rail("c", 1.0), rail("c", -0.8)];
        let aside = leave_out_rails(&names, &mut recordings, &mut faults);
        assert_eq!((aside.len(), faults.len()), (2, 2));
        assert!(aside.iter().all(|f| f.runs == ["a"]) && faults.iter().all(|f| f.runs == ["c"]));
        // a run that nobody accused meets one of them, too; of another most would be lost; the last is far from both
        assert!(recordings[1].time.len() < 1000 && recordings[1].time.len() > 500);
        assert_eq!(recordings[2..], before[2..]);
        for run in &recordings[..2] {
            let [angle, clean] = [&run.channels[0].values, &run.channels[1].values];
            let errors: Vec<f64> = angle.iter().zip(clean).map(|(a, c)| a - c).collect();
            assert!(angle.iter().all(|v| *v < 1.0 && *v > -0.8));
            // what is left is not chosen by its noise
            let mean = crate::stats::mean_or_zero(&errors);
            assert!(mean.abs() < 4.0 * 0.01 / (errors.len() as f64).sqrt(), "{mean}");
            let near: Vec<f64> =
                errors.iter().zip(clean).filter(|(_, c)| **c > 0.9).map(|(e, _)| *e).collect();
            assert!(crate::stats::mean_or_zero(&near) > -0.004, "{near:?}");
        }
    }
}
