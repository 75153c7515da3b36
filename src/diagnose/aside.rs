//! What is left aside because it is at fault: the rest of the recordings may still tell what a model lacks.

use super::hygiene::{Fault, FaultKind};
use super::result::Use;
use crate::fit::Run;
use std::collections::BTreeSet;

/// What is not looked at: runs by name, measured channels by the model's variable.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub(super) struct Aside {
    pub runs: BTreeSet<String>,
    pub channels: BTreeSet<usize>,
}

impl Aside {
    /// What faults ask for, of these runs; `variable` knows the model's variables by name. Of each fault that is left
    /// aside which costs less, as a share of what there is: its runs or its channels. `None` if nothing would be
    /// left to fit or to check, what runs are for being given or not.
    pub fn of(
        faults: &[&Fault],
        (runs, are_given): (&[(Run, Use)], bool),
        variable: impl Fn(&str) -> Option<usize>,
    ) -> Option<Self> {
        let measured: BTreeSet<usize> =
            runs.first()?.0.channels.iter().map(|channel| channel.variable).collect();
        let mut aside = Self::default();
        for fault in faults {
            let own = fault.channel.iter().flat_map(|c| c.split(", ")).map(&variable);
            let own: Option<BTreeSet<usize>> = own.collect();
            // a clock is that of all channels, whichever shows most that it drifts
            let channels = own
                .filter(|c| !c.is_empty() && c.is_subset(&measured) && fault.kind != FaultKind::ClockDrift);
            // one of several copies is a recording like others
            let kept = usize::from(fault.kind == FaultKind::DuplicatedRun);
            let with = |also: Self| Self {
                runs: aside.runs.union(&also.runs).cloned().collect(),
                channels: aside.channels.union(&also.channels).copied().collect(),
            };
            let without_runs =
                with(Self { runs: fault.runs.iter().skip(kept).cloned().collect(), ..Self::default() });
            let without_channels = channels.map(|channels| with(Self { channels, ..Self::default() }));
            let ways = std::iter::once(without_runs)
                .chain(without_channels)
                .filter(|way| way.leaves_enough(runs, are_given));
            aside = ways.min_by(|a, b| a.share_of(runs).total_cmp(&b.share_of(runs)))?;
        }
        Some(aside)
    }

    fn is_left(&self, run: &Run) -> bool {
        !self.runs.contains(&run.name)
    }

    fn leaves_enough(&self, runs: &[(Run, Use)], are_given: bool) -> bool {
        let left: Vec<Use> =
            runs.iter().filter(|(run, _)| self.is_left(run)).map(|(_, use_)| *use_).collect();
        let can_be_shared =
            left.len() > 1 && (!are_given || (left.contains(&Use::Fit) && left.contains(&Use::Check)));
        self.share_of(runs) < 1.0 && can_be_shared
    }

    /// The share of all channels of all runs that is left aside.
    fn share_of(&self, runs: &[(Run, Use)]) -> f64 {
        let left = |(run, _): &&(Run, Use)| self.is_left(run);
        let of_runs = runs.iter().filter(left).count() as f64 / runs.len().max(1) as f64;
        let channels = runs.first().map_or(0, |(run, _)| run.channels.len());
        1.0 - of_runs * channels.saturating_sub(self.channels.len()) as f64 / channels.max(1) as f64
    }
}

#[cfg(test)]
mod tests {
    use super::super::hygiene::Severity;
    use super::*;
    use crate::fit::{Channel, Drive};
    use std::sync::Arc;

    const NAMES: [&str; 3] = ["force", "moment", "speed"];

    fn runs(count: usize, channels: usize) -> Vec<(Run, Use)> {
        let drive = Arc::new(Drive::new(0.0, 1.0, 1, Vec::new()));
        let channel =
            |variable| Channel { variable, values: vec![0.0], counts: false, unresolved: Vec::new() };
        let run = |i: usize| Run {
            name: format!("{i}.csv"),
            drive: drive.clone(),
            time: vec![0.0],
            channels: (0..channels).map(channel).collect(),
        };
        (0..count).map(|i| (run(i), if i % 3 == 1 { Use::Check } else { Use::Fit })).collect()
    }

    fn fault(runs: &[usize], channel: Option<&str>) -> Fault {
        Fault {
            kind: FaultKind::WrongSign,
            severity: Severity::Fatal,
            runs: runs.iter().map(|i| format!("{i}.csv")).collect(),
            channel: channel.map(Into::into),
            span: None,
            value: -1.0,
            unit: "1".into(),
            evidence: String::new(),
            advice: String::new(),
        }
    }

    fn of(faults: &[Fault], runs: &[(Run, Use)]) -> Option<Aside> {
        let variable = |name: &str| NAMES.iter().position(|n| *n == name);
        Aside::of(&faults.iter().collect::<Vec<_>>(), (runs, true), variable)
    }

    #[test]
    fn what_costs_less_is_left_aside() {
        let twelve = runs(12, 3);
        let names = |aside: &Aside| aside.runs.iter().cloned().collect::<Vec<_>>().join(" ");
        // one run of twelve rather than one channel of three
        let one = of(&[fault(&[4], Some("moment"))], &twelve).unwrap();
        assert_eq!((names(&one).as_str(), one.channels.len()), ("4.csv", 0));
        // a channel of all runs
        let all: Vec<usize> = (0..12).collect();
        let channel = of(&[fault(&all, Some("moment"))], &twelve).unwrap();
        assert_eq!((channel.runs.len(), channel.channels.iter().copied().collect::<Vec<_>>()), (0, vec![1]));
        // both, and a second fault of the same channel costs nothing more
        let both = of(&[fault(&all, Some("moment")), fault(&[2], Some("moment"))], &twelve).unwrap();
        assert_eq!(both, channel);
        let both = of(&[fault(&all, Some("moment")), fault(&[2], Some("force"))], &twelve).unwrap();
        assert_eq!((names(&both).as_str(), both.channels.len()), ("2.csv", 1));
        // exchanged channels
        let exchanged = of(&[fault(&all, Some("force, speed"))], &twelve).unwrap();
        assert_eq!(exchanged.channels.len(), 2);
        // all channels have one clock
        let clock = Fault { kind: FaultKind::ClockDrift, ..fault(&[0, 1, 2, 3, 4, 5], Some("force")) };
        assert_eq!(of(&[clock], &twelve).unwrap().runs.len(), 6);
        // one of two copies stays
        let copies = Fault { kind: FaultKind::DuplicatedRun, ..fault(&[3, 7], None) };
        assert_eq!(names(&of(&[copies], &twelve).unwrap()), "7.csv");
    }

    #[test]
    fn nothing_is_left_aside_where_nothing_would_be_left() {
        let all: Vec<usize> = (0..6).collect();
        assert_eq!(of(&[fault(&all, Some("force"))], &runs(6, 1)), None);
        // an input, whose recordings cannot be done without
        assert_eq!(of(&[fault(&all, Some("command"))], &runs(6, 3)), None);
        assert_eq!(of(&[fault(&all, None)], &runs(6, 3)), None);
        // the runs for checking: their channel goes instead
        let checks = of(&[fault(&[1, 4], Some("force"))], &runs(6, 3)).unwrap();
        assert_eq!((checks.runs.len(), checks.channels.len()), (0, 1));
        assert_eq!(of(&[fault(&[1, 4], Some("force"))], &runs(6, 1)), None);
        // unless others may check
        let all = runs(6, 1);
        let shared = Aside::of(&[&fault(&[1, 4], Some("force"))], (&all, false), |_| Some(0)).unwrap();
        assert_eq!((shared.runs.len(), shared.channels.len()), (2, 0));
    }
}
