//! Time stamps: what is wrong with them and what time the samples have after all.

use super::{Fault, FaultKind, Severity, short};
use crate::stats::{median, quantile};

/// An interval this many times the median one is a gap: a lost sample or two makes 2 or 3, and linear
/// interpolation bridges them.
const GAP: f64 = 5.0;
/// A run that lacks more than this share of its time is no run any more.
const TOO_MUCH_GONE: f64 = 0.2;
/// Scatter of the intervals (standard deviation over median) that is more than loggers have: stamps with
/// 10 % jitter make 0.14, event-driven loggers stay below 0.2.
const JITTER: f64 = 0.25;
/// A stamp that leads by this many intervals may itself be the wrong one.
const LEAD: f64 = 3.0;

/// What becomes of the rows.
pub struct Mended {
    /// The rows to keep, with the times \[s\] that they have then, strictly increasing.
    pub rows: Vec<(usize, f64)>,
    /// What was wrong; the runs are left to the caller.
    pub faults: Vec<Fault>,
}

/// Mends time stamps \[s\]; those that are no number are left out without a word.
///
/// A single stamp out of order costs its row, an equal one too. A clock that was set back and runs on is
/// taken to have counted its rows rightly: the rows after it follow at the median interval.
pub fn mend(time: &[f64]) -> Mended {
    let mut kept: Vec<(usize, f64)> = Vec::with_capacity(time.len());
    let stamps: Vec<(usize, f64)> = time.iter().copied().enumerate().filter(|(_, t)| t.is_finite()).collect();
    let forward: Vec<f64> = stamps.windows(2).map(|w| w[1].1 - w[0].1).filter(|d| *d > 0.0).collect();
    let interval = median(&forward);
    let mut faults = Vec::new();
    if !interval.is_finite() {
        return Mended { rows: stamps.into_iter().take(1).collect(), faults };
    }
    let (mut equal, mut single, mut back) = (Vec::new(), Vec::new(), Vec::new());
    let mut shift = 0.0;
    for (n, &(row, stamp)) in stamps.iter().enumerate() {
        let mut t = stamp + shift;
        if let Some(&(_, last)) = kept.last() {
            if t == last {
                equal.push(t);
                continue;
            }
            if t < last {
                let next = stamps.get(n + 1).map(|s| s.1 + shift);
                let before = kept.len().checked_sub(2).map(|i| kept[i].1);
                if before.is_some_and(|b| t > b && last - b > LEAD * interval && last - t > interval) {
                    // the stamp before was ahead of its time
                    kept.pop();
                    single.push(last);
                } else if next.is_none_or(|next| next > last) {
                    single.push(t);
                    continue;
                } else {
                    back.push((last, last - t));
                    shift += last + interval - t;
                    t = last + interval;
                }
            }
        }
        kept.push((row, t));
    }

    if let (Some(first), Some(last)) = (back.first(), back.last()) {
        let size = back.iter().map(|b| b.1).fold(0.0, f64::max);
        faults.push(Fault {
            span: Some((first.0, last.0)),
            value: size,
            evidence: format!(
                "The clock is set back {} time(s), by up to {} s (first at {} s), and runs on from there.",
                back.len(),
                short(size),
                short(first.0)
            ),
            advice:
                "The rows after it were moved to follow at the median interval; check the logger's clock \
                     (time synchronisation while recording)."
                    .into(),
            ..fault(FaultKind::TimeJumpsBack, "s")
        });
    }
    if let Some((first, last)) = span(&single) {
        faults.push(Fault {
            span: Some((first, last)),
            value: single.len() as f64,
            evidence: format!(
                "{} single stamp(s) are out of order (first at {} s).",
                single.len(),
                short(first)
            ),
            advice: "These rows were left out; check how the logger merges its sources.".into(),
            ..fault(FaultKind::TimeJumpsBack, "1")
        });
    }
    if let Some((first, last)) = span(&equal) {
        let share = equal.len() as f64 / stamps.len() as f64;
        let coarse = share > 0.05;
        faults.push(Fault {
            span: Some((first, last)),
            value: equal.len() as f64,
            evidence: format!(
                "{} row(s) have the time of the row before (first at {} s).",
                equal.len(),
                short(first)
            ),
            advice: if coarse {
                "Of rows with equal time the first was kept; write the time with more digits."
            } else {
                "Of rows with equal time the first was kept."
            }
            .into(),
            ..fault(FaultKind::DuplicateStamps, "1")
        });
    }
    faults.extend(intervals(&kept));
    Mended { rows: kept, faults }
}

/// Gaps and jitter of increasing times.
fn intervals(kept: &[(usize, f64)]) -> Vec<Fault> {
    let mut faults = Vec::new();
    let steps: Vec<f64> = kept.windows(2).map(|w| w[1].1 - w[0].1).collect();
    let interval = median(&steps);
    let (Some(begin), Some(end)) = (kept.first(), kept.last()) else { return faults };
    // multi-rate files have many long steps: then it is a rhythm, not a gap
    let gaps: Vec<(f64, f64)> =
        kept.windows(2).map(|w| (w[0].1, w[1].1)).filter(|(a, b)| b - a > GAP * interval).collect();
    if let (Some(first), Some(last)) = (gaps.first(), gaps.last()) {
        let gone: f64 = gaps.iter().map(|(a, b)| b - a).sum();
        let longest = gaps.iter().map(|(a, b)| b - a).fold(0.0, f64::max);
        let much = gone > TOO_MUCH_GONE * (end.1 - begin.1);
        faults.push(Fault {
            severity: if much { Severity::Fatal } else { Severity::Repaired },
            span: Some((first.0, last.1)),
            value: longest,
            evidence: format!(
                "{} gap(s), the longest of {} s (the median interval is {} s; first at {} s), {} s in all.",
                gaps.len(),
                short(longest),
                short(interval),
                short(first.0),
                short(gone)
            ),
            advice: if much {
                "Leave the run out or cut it into runs: too much of it is missing."
            } else {
                "Inputs are linear over the gap; what happened in it is unknown, so expect a transient after it."
            }
            .into(),
            ..fault(FaultKind::Gap, "s")
        });
    }
    // 5 % to 95 % of a normal distribution are 3.29 standard deviations
    let scatter = (quantile(&steps, 0.95) - quantile(&steps, 0.05)) / 3.29 / interval;
    if steps.len() >= 20 && scatter > JITTER {
        faults.push(Fault {
            value: 100.0 * scatter,
            evidence: format!(
                "The intervals scatter by {} % of their median {} s (standard deviation; up to 20 % is usual).",
                short(100.0 * scatter),
                short(interval)
            ),
            advice: "The stamps are used as they are; if the samples were taken by a regular clock, write its \
                     times instead."
                .into(),
            ..fault(FaultKind::Jitter, "%")
        });
    }
    faults
}

fn span(times: &[f64]) -> Option<(f64, f64)> {
    Some((*times.first()?, *times.last()?))
}

fn fault(kind: FaultKind, unit: &str) -> Fault {
    Fault {
        kind,
        severity: Severity::Repaired,
        runs: Vec::new(),
        channel: None,
        span: None,
        value: f64::NAN,
        unit: unit.into(),
        evidence: String::new(),
        advice: String::new(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn kinds(time: &[f64]) -> (Vec<FaultKind>, Vec<f64>) {
        let mended = mend(time);
        assert!(mended.rows.windows(2).all(|w| w[0].1 < w[1].1), "{:?}", mended.rows);
        (mended.faults.iter().map(|f| f.kind).collect(), mended.rows.iter().map(|r| r.1).collect())
    }

    #[test]
    fn a_regular_clock_has_no_faults() {
        let time: Vec<f64> = (0..200).map(|i| 0.01 * f64::from(i)).collect();
        assert_eq!(kinds(&time), (vec![], time));
    }

    #[test]
    fn one_stamp_ahead_is_left_out_not_all_after_it() {
        let mut time: Vec<f64> = (0..50).map(f64::from).collect();
        time[20] = 40.5;
        let (found, rows) = kinds(&time);
        assert_eq!(found, [FaultKind::TimeJumpsBack]);
        assert_eq!(rows.len(), 49);
        assert!(!rows.contains(&40.5));
    }

    #[test]
    fn one_stamp_behind_is_left_out() {
        let mut time: Vec<f64> = (0..50).map(f64::from).collect();
        time[20] = 3.5;
        let (found, rows) = kinds(&time);
        assert_eq!(found, [FaultKind::TimeJumpsBack]);
        assert_eq!(rows.len(), 49);
        assert!(!rows.contains(&3.5));
    }

    #[test]
    fn a_clock_that_is_set_back_keeps_its_rows() {
        let time: Vec<f64> = (0..50).map(|i| f64::from(i) - if i >= 30 { 10.0 } else { 0.0 }).collect();
        let mended = mend(&time);
        assert_eq!(mended.faults.len(), 1);
        assert_eq!(mended.faults[0].value, 11.0 - 1.0 - 1.0);
        assert_eq!(
            mended.rows.iter().map(|r| r.1).collect::<Vec<_>>(),
            (0..50).map(f64::from).collect::<Vec<_>>()
        );
    }

    #[test]
    fn hostile_times_do_no_harm() {
        for time in [
            &[][..],
            &[f64::NAN, f64::NAN],
            &[1.0],
            &[1.0, 1.0],
            &[2.0, 1.0, 0.0],
            &[f64::INFINITY, 1.0, 2.0],
        ] {
            let mended = mend(time);
            assert!(mended.rows.windows(2).all(|w| w[0].1 < w[1].1), "{time:?}");
        }
    }
}
