//! Which parameters the next targets fix, and in which order a plan's targets could be used.

use super::independence::influence;
use super::injectivity::{Injectivity, injective};
use super::samples::Sampled;
use crate::Result;
use nalgebra::DMatrix;
use serde::Serialize;
use std::cell::RefCell;
use std::collections::BTreeMap;

/// More targets together are looked at only where a plan has them in one group.
const MOST: usize = 4;
/// So many sets of targets are looked at, at most; where there are more, smaller ones only.
const SETS: usize = 20_000;

/// Numbers of targets and of parameters.
type Numbers = (Vec<usize>, Vec<usize>);

/// Targets that fix as many parameters, once all others that they depend on are known.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Next {
    /// The targets.
    pub targets: Vec<usize>,
    /// What they fix.
    pub parameters: Vec<usize>,
    /// The other parameters that they depend on.
    pub given: Vec<usize>,
    /// What the test for one answer says. One that is open may be the next, but it is not shown to be.
    pub injectivity: Injectivity,
    /// It is the one that the choice goes on with: not refuted, and nothing else fixes its parameters before.
    pub is_chosen: bool,
}

/// What could be found next with all that the steps before have found.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Step {
    /// What is known by then.
    pub known: Vec<usize>,
    /// What could come next, the chosen ones first, in the order of their targets. None of the chosen needs another, so that their order
    /// does not count.
    pub next: Vec<Next>,
}

/// An order in which targets could be used, made from influence and the test for one answer alone.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Choice {
    /// The steps.
    pub steps: Vec<Step>,
    /// Parameters that no step finds.
    pub left: Vec<usize>,
}

/// The choice of the next group (s2), with what has been tested once kept.
pub struct Finder<'a> {
    sampled: &'a Sampled<'a>,
    influence: DMatrix<f64>,
    tested: RefCell<BTreeMap<Numbers, Injectivity>>,
}

impl<'a> Finder<'a> {
    /// Looks at the influence of each parameter on each target.
    pub fn new(sampled: &'a Sampled<'a>) -> Self {
        Self { sampled, influence: influence(sampled), tested: RefCell::default() }
    }

    /// The influence matrix, see [`influence`].
    pub fn influence(&self) -> &DMatrix<f64> {
        &self.influence
    }

    /// The test for one answer, see [`injective`].
    ///
    /// # Errors
    /// As [`injective`].
    pub fn injective(&self, targets: &[usize], parameters: &[usize]) -> Result<Injectivity> {
        let asked = (targets.to_vec(), parameters.to_vec());
        if let Some(answer) = self.tested.borrow().get(&asked) {
            return Ok(answer.clone());
        }
        let answer = injective(self.sampled, targets, parameters)?;
        self.tested.borrow_mut().insert(asked, answer.clone());
        Ok(answer)
    }

    /// The parameters that the targets `rows` fix once the `known` ones are (s2): those that they depend on, each tested alone, with
    /// what the test for one answer says. `None` if these are not as many as the targets.
    ///
    /// # Errors
    /// As [`injective`].
    pub fn next_group(&self, rows: &[usize], known: &[usize]) -> Result<Option<Next>> {
        let (parameters, given): (Vec<usize>, Vec<usize>) =
            (0..self.influence.ncols()).filter(|k| self.counts(rows, *k)).partition(|k| !known.contains(k));
        if parameters.len() != rows.len() {
            return Ok(None);
        }
        let injectivity = self.injective(rows, &parameters)?;
        Ok(Some(Next { targets: rows.to_vec(), parameters, given, injectivity, is_chosen: false }))
    }

    /// One of the targets depends on a parameter, or might: what could not be compared is no evidence.
    fn counts(&self, rows: &[usize], parameter: usize) -> bool {
        rows.iter().any(|row| self.influence[(*row, parameter)] != 0.0)
    }

    /// Goes from nothing that is known as far as targets fix what is not: all sets of a few targets of which no smaller one will do,
    /// and the plan's own `groups` of them.
    ///
    /// # Errors
    /// As [`injective`].
    pub fn choose(&self, groups: &[Vec<usize>]) -> Result<Choice> {
        let all: Vec<usize> = (0..self.influence.ncols()).collect();
        let (mut known, mut steps) = (Vec::new(), Vec::new());
        loop {
            let mut next = self.candidates(groups, &known)?;
            // what passes goes before what is open
            next.sort_by_key(|n| (!is_passed(&n.injectivity), n.targets.clone()));
            let before = known.clone();
            for one in &mut next {
                let refuted = matches!(one.injectivity, Injectivity::Refuted { .. });
                one.is_chosen = !refuted && !one.parameters.iter().any(|k| known.contains(k));
                if one.is_chosen {
                    known.extend(&one.parameters);
                }
            }
            // what was not gone on with is shown once
            let is_shown = |n: &Next| {
                let same = |other: &Next| other.targets == n.targets && other.parameters == n.parameters;
                steps.iter().any(|step: &Step| step.next.iter().any(same))
            };
            next.retain(|n| n.is_chosen || !is_shown(n));
            next.sort_by_key(|n| (!n.is_chosen, n.targets.clone()));
            let is_last = known.len() == before.len();
            if !next.is_empty() {
                steps.push(Step { known: before, next });
            }
            if is_last || known.len() == all.len() {
                let left = all.into_iter().filter(|k| !known.contains(k)).collect();
                return Ok(Choice { steps, left });
            }
        }
    }

    /// All that could be next, smaller sets of targets first.
    fn candidates(&self, groups: &[Vec<usize>], known: &[usize]) -> Result<Vec<Next>> {
        let is_useful =
            |row: &usize| (0..self.influence.ncols()).any(|k| !known.contains(&k) && self.counts(&[*row], k));
        let rows: Vec<usize> = (0..self.influence.nrows()).filter(is_useful).collect();
        let mut sets = Vec::new();
        for size in 1..=MOST.min(rows.len()) {
            let of_size = subsets(&rows, size, SETS - sets.len());
            let Some(of_size) = of_size else { break };
            sets.extend(of_size);
        }
        sets.extend(groups.iter().filter(|g| g.len() > MOST).cloned());
        let mut found: Vec<Next> = Vec::new();
        for set in sets {
            // a part of it does, and leaves the rest to later
            let is_part = |n: &Next| {
                !matches!(n.injectivity, Injectivity::Refuted { .. })
                    && n.targets.iter().all(|row| set.contains(row))
            };
            if !found.iter().any(is_part) {
                found.extend(self.next_group(&set, known)?);
            }
        }
        Ok(found)
    }
}

pub(super) fn is_passed(injectivity: &Injectivity) -> bool {
    matches!(injectivity, Injectivity::Passed { .. })
}

/// All subsets of a size, if there are no more than `most`.
fn subsets(of: &[usize], size: usize, most: usize) -> Option<Vec<Vec<usize>>> {
    // n over k, whole at every step
    let count = (0..size).try_fold(1usize, |count, k| Some(count.checked_mul(of.len() - k)? / (k + 1)))?;
    if count > most {
        return None;
    }
    let mut sets: Vec<(usize, Vec<usize>)> = vec![(0, Vec::new())];
    for _ in 0..size {
        let longer = sets.into_iter().flat_map(|(from, set)| {
            (from..of.len()).map(move |place| (place + 1, [&set[..], &[of[place]]].concat()))
        });
        sets = longer.collect();
    }
    Some(sets.into_iter().map(|(_, set)| set).collect())
}
