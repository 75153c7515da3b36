//! Runs that show what the refitted model leaves: some have to be for fitting, and some for checking.

use super::excerpt::{beginning, end};
use super::negligible::negligible;
use super::rest::Rest;
use super::result::Use;
use crate::fit::Run;
use crate::stats::quantile_below;

/// A run errs more than the others if its error is so many times what a quarter of them stay below.
const STANDS_OUT: f64 = 1.5;
/// And it is a witness of what the worst run shows if it has this share of that one's squared error beyond the others'.
const WITNESS: f64 = 0.1;
/// A run is cut with at least this share of its samples on either side.
const LEAST_PART: f64 = 0.1;
/// What is to be checked has to be in more than one moment: of so many parts of the end of a run, in as many as this.
const PARTS: usize = 24;
const MOMENTS: f64 = 2.0;
/// And so much of a run's squared error beyond the usual one.
const LEAST_LEFT: f64 = 0.25;

/// Runs with their uses; one that was cut is there twice, its beginning to fit and its end to check.
pub(super) type Shared = Vec<(Run, Use)>;

/// Runs, their uses, and the squared error of each channel beyond what the channel has in the better runs.
struct Sharing<'a> {
    runs: &'a [&'a Run],
    uses: Vec<Use>,
    /// Runs with faults of their own: they are no witnesses, and stay where they are.
    faulty: &'a [bool],
    excess: Vec<Vec<f64>>,
    /// Mean squared error of each channel that a quarter of the runs stay below.
    usual: Vec<f64>,
    /// Runs that are cut, and the time.
    cut: Vec<Option<f64>>,
}

/// Shares runs out anew where what is left of a channel shows in one set only: a run of the other set comes in, or the only
/// one that shows it is cut in two, so that no sample is for both. `rest` is what the model leaves of all `runs`; those
/// that are `faulty` (a gap, after which the state is unknown) are left alone. `None` if nothing has to be changed.
///
/// Only the fitted model without effects is asked, so that no effect chooses the runs that check it.
pub(super) fn share_out(runs: &[&Run], uses: &[Use], faulty: &[bool], rest: &Rest) -> Option<Shared> {
    let (mut excess, usual) = excess(runs, rest);
    for (own, _) in excess.iter_mut().zip(faulty).filter(|(_, faulty)| **faulty) {
        own.fill(0.0);
    }
    let mut sharing =
        Sharing { runs, uses: uses.to_vec(), faulty, excess, usual, cut: vec![None; runs.len()] };
    let channels = sharing.excess.first().map_or(0, Vec::len);
    let worst = |c: &usize| sharing.excess.iter().map(|e| e[*c]).fold(0.0, f64::max);
    let mut order: Vec<(usize, f64)> =
        (0..channels).map(|c| (c, worst(&c))).filter(|(_, worst)| *worst > 0.0).collect();
    order.sort_by(|a, b| b.1.total_cmp(&a.1));
    for (channel, _) in order {
        for (wanted, other) in [(Use::Fit, Use::Check), (Use::Check, Use::Fit)] {
            sharing.find_witness(channel, wanted, other, rest);
        }
    }
    sharing.done(uses)
}

/// Mean squared error of each channel of each run, over that which a quarter of the runs stay below, less one; zero
/// where the run does not stand out. And what a quarter of them stay below.
fn excess(runs: &[&Run], rest: &Rest) -> (Vec<Vec<f64>>, Vec<f64>) {
    let channels = runs.iter().map(|r| r.channels.len()).min().unwrap_or(0);
    let mut excess = vec![vec![0.0; channels]; runs.len()];
    let mut all_usual = Vec::new();
    for c in 0..channels {
        let square = |(run, simulated): (&&Run, &Vec<Vec<f64>>)| -> f64 {
            errors(run, &simulated[c], c).map(|e| e * e).sum::<f64>() / run.time.len().max(1) as f64
        };
        let squares: Vec<f64> = runs.iter().zip(&rest.simulated).map(square).collect();
        let mut sorted = squares.clone();
        sorted.sort_by(f64::total_cmp);
        let usual = quantile_below(&sorted, 1, 4).max(negligible(runs, c).powi(2));
        for (own, square) in excess.iter_mut().zip(squares) {
            let ratio = square / usual;
            own[c] = if ratio > STANDS_OUT.powi(2) { ratio - 1.0 } else { 0.0 };
        }
        all_usual.push(usual);
    }
    (excess, all_usual)
}

fn errors<'a>(run: &'a Run, simulated: &'a [f64], channel: usize) -> impl Iterator<Item = f64> + 'a {
    run.channels[channel].values.iter().zip(simulated).map(|(m, s)| m - s)
}

impl Sharing<'_> {
    /// Runs that show what is left of a channel, the clearest first.
    fn witnesses(&self, channel: usize) -> Vec<usize> {
        let of = |i: usize| self.excess[i][channel];
        let mut order: Vec<usize> = (0..self.runs.len()).collect();
        order.sort_by(|a, b| of(*b).total_cmp(&of(*a)));
        let least = WITNESS * order.first().map_or(0.0, |i| of(*i));
        order.retain(|i| of(*i) > 0.0 && of(*i) >= least);
        order
    }

    /// Whether a set has a run, whole or in part.
    fn has(&self, set: Use, run: usize) -> bool {
        self.uses[run] == set || (self.cut[run].is_some() && set == Use::Check)
    }

    /// Whether a set has no other run that shows something that this one shows.
    fn is_sole(&self, run: usize) -> bool {
        let set = self.uses[run];
        (0..self.excess[run].len()).any(|channel| {
            let witnesses = self.witnesses(channel);
            witnesses.contains(&run) && !witnesses.iter().any(|w| *w != run && self.has(set, *w))
        })
    }

    /// Sees to it that the `wanted` set has a run that shows what is left of a channel.
    fn find_witness(&mut self, channel: usize, wanted: Use, other: Use, rest: &Rest) {
        let witnesses = self.witnesses(channel);
        if witnesses.is_empty() || witnesses.iter().any(|w| self.has(wanted, *w)) {
            return;
        }
        if let [first, second, ..] = witnesses[..] {
            // what is fitted should show it best
            self.exchange(if other == Use::Fit { second } else { first }, wanted);
        } else if let [only] = witnesses[..] {
            let errors = errors(self.runs[only], &rest.simulated[only][channel], channel);
            let more: Vec<f64> = errors.map(|e| e * e - self.usual[channel]).collect();
            self.cut[only] = half(&more).map(|k| self.runs[only].time[k]);
            if self.cut[only].is_some() {
                self.uses[only] = Use::Fit;
            }
        }
    }

    /// Takes a run into a set, in exchange for the one that shows least and is not needed there.
    fn exchange(&mut self, run: usize, wanted: Use) {
        let total = |i: &usize| self.excess[*i].iter().sum::<f64>();
        let free = (0..self.runs.len()).filter(|i| {
            self.uses[*i] == wanted && self.cut[*i].is_none() && !self.faulty[*i] && !self.is_sole(*i)
        });
        if let Some(partner) = free.min_by(|a, b| total(a).total_cmp(&total(b))) {
            self.uses[partner] = self.uses[run];
        }
        self.uses[run] = wanted;
    }

    fn done(self, before: &[Use]) -> Option<Shared> {
        if self.uses == before && self.cut.iter().all(Option::is_none) {
            return None;
        }
        let mut shared = Vec::new();
        for ((run, use_), cut) in self.runs.iter().zip(&self.uses).zip(&self.cut) {
            match cut {
                Some(time) => {
                    let first = beginning(run, time - run.drive.start);
                    let last = first.time.last().map_or(*time, |t| t.max(*time));
                    shared.push((first, Use::Fit));
                    shared.push((end(run, last), Use::Check));
                }
                None => shared.push(((*run).clone(), *use_)),
            }
        }
        let left = |wanted: Use| shared.iter().any(|(_, use_)| *use_ == wanted);
        (left(Use::Fit) && left(Use::Check)).then_some(shared)
    }
}

/// The sample with which half of a run's squared error beyond the usual one is behind, unless that leaves too little on one
/// side, or a single moment.
fn half(more: &[f64]) -> Option<usize> {
    let total: f64 = more.iter().sum();
    let mut sum = 0.0;
    let reached = |m: &f64| {
        sum += m;
        sum >= 0.5 * total
    };
    let k = more.iter().position(reached)?;
    let n = more.len() as f64;
    let end = &more[k + 1..];
    let parts: Vec<f64> =
        end.chunks(end.len().div_ceil(PARTS).max(1)).map(|part| part.iter().sum::<f64>().max(0.0)).collect();
    let left: f64 = parts.iter().sum();
    let moments = left * left / parts.iter().map(|p| p * p).sum::<f64>().max(f64::MIN_POSITIVE);
    let is_within = (LEAST_PART * n..(1.0 - LEAST_PART) * n).contains(&(k as f64));
    (is_within && left > LEAST_LEFT * total && moments >= MOMENTS).then_some(k)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fit::{Channel, Drive};
    use std::sync::Arc;

    /// Runs of 1000 samples at zero whose error is one, and `more` within some samples.
    fn runs(more: &[(f64, std::ops::Range<usize>)]) -> (Vec<Run>, Rest) {
        let n = 1000;
        let time: Vec<f64> = (0..n).map(|k| 0.01 * k as f64).collect();
        let drive = Drive::new(0.0, 0.005, 2 * n - 1, Vec::new());
        let run = |(i, (more, range)): (usize, &(f64, std::ops::Range<usize>))| {
            let own = |k: usize| if range.contains(&k) { *more } else { 1.0 };
            let values = (0..n).map(|k| if k % 2 == 0 { own(k) } else { -own(k) }).collect();
            Run {
                name: i.to_string(),
                drive: Arc::new(drive.clone()),
                time: time.clone(),
                channels: vec![Channel { variable: 0, values, counts: false, unresolved: Vec::new() }],
            }
        };
        let runs: Vec<Run> = more.iter().enumerate().map(run).collect();
        let simulated = vec![vec![vec![0.0; n]]; runs.len()];
        (runs, Rest { simulated, blocks: Vec::new(), total: 0.0, cost: 0.0 })
    }

    fn shared(more: &[(f64, std::ops::Range<usize>)], uses: &[Use]) -> Option<Shared> {
        let (runs, rest) = runs(more);
        share_out(&runs.iter().collect::<Vec<_>>(), uses, &vec![false; runs.len()], &rest)
    }

    fn names(shared: &Shared, wanted: Use) -> String {
        shared.iter().filter(|(_, u)| *u == wanted).map(|(run, _)| &run.name[..]).collect()
    }

    use Use::{Check, Fit};

    #[test]
    fn what_both_sets_show_is_left_as_it_is() {
        let uses = [Fit, Check, Fit, Fit, Check, Fit];
        let alike = [1.0, 1.1, 1.0, 1.0, 1.2, 1.0].map(|e| (e, 0..1000));
        assert!(shared(&alike, &uses).is_none());
        let both = [1.0, 1.0, 3.0, 1.0, 2.0, 1.0].map(|e| (e, 0..1000));
        assert!(shared(&both, &uses).is_none());
    }

    #[test]
    fn one_of_two_runs_that_show_something_is_for_the_other_set() {
        let fitted = [1.0, 1.0, 3.0, 1.0, 1.0, 2.0].map(|e| (e, 0..1000));
        let all = shared(&fitted, &[Fit, Check, Fit, Fit, Check, Fit]).unwrap();
        assert_eq!((&names(&all, Fit)[..], &names(&all, Check)[..]), ("0123", "45"));
        let checked = [1.0, 2.0, 1.0, 1.0, 3.0, 1.0].map(|e| (e, 0..1000));
        let all = shared(&checked, &[Fit, Check, Fit, Fit, Check, Fit]).unwrap();
        assert_eq!((&names(&all, Fit)[..], &names(&all, Check)[..]), ("2345", "01"));
    }

    #[test]
    fn runs_with_faults_are_left_alone() {
        let (runs, rest) = runs(&[1.0, 1.0, 3.0, 1.0, 1.0, 2.0].map(|e| (e, 0..1000)));
        let runs: Vec<&Run> = runs.iter().collect();
        let uses = [Fit, Check, Fit, Fit, Check, Fit];
        // the only witness that is left is cut
        let faulty = [false, true, false, false, false, true];
        let all = share_out(&runs, &uses, &faulty, &rest).unwrap();
        assert_eq!((&names(&all, Fit)[..], &names(&all, Check)[..]), ("0235", "124"));
        assert!(share_out(&runs, &uses, &[false, false, true, false, false, true], &rest).is_none());
    }

    #[test]
    fn the_only_run_that_shows_something_is_cut_where_half_of_it_is_behind() {
        let mut errors = [1.0; 6].map(|e| (e, 0..1000));
        errors[4] = (9.0, 200..800);
        for uses in [[Fit, Check, Fit, Fit, Check, Fit], [Fit, Check, Fit, Check, Fit, Fit]] {
            let all = shared(&errors, &uses).unwrap();
            let parts: Vec<&Run> = all.iter().map(|(run, _)| run).filter(|run| run.name == "4").collect();
            let [first, last] = parts[..] else { panic!("{}", parts.len()) };
            assert!(names(&all, Fit).contains('4') && names(&all, Check).contains('4'));
            // no sample twice, none lost, and the second part is simulated from the start
            assert_eq!(first.time.len() + last.time.len(), 1000);
            assert!(first.time.last().unwrap() < &last.time[0]);
            assert!((4.9..5.1).contains(&last.time[0]), "{}", last.time[0]);
            assert_eq!((last.drive.start, last.drive.points), (0.0, 1999));
            assert_eq!(last.channels[0].values.len(), last.time.len());
        }
        // a single event cannot be checked, wherever it is
        for range in [10..11, 400..440, 500..501] {
            errors[4] = (90.0, range);
            assert!(shared(&errors, &[Fit, Check, Fit, Fit, Check, Fit]).is_none());
        }
    }
}
