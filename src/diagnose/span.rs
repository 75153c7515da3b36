//! Which courses are sums of others: what answers in proportion answers them with the same sums.

use nalgebra::DVector;
use std::collections::{BTreeMap, HashMap};
use std::ops::Range;

/// A course is a sum of others if it misses less than this share of itself: a change that is predicted ranks effects, it is
/// no fit. Roughly, a hundredth of its square, to find the sixty that are looked at more closely; and then closely.
pub(super) const ROUGHLY: f64 = 0.1;
pub(super) const CLOSELY: f64 = 0.02;
/// And if its terms are not so many times larger than it: what they cancel of each other, answers that are not quite in
/// proportion do not.
const CANCELLED: f64 = 5.0;

/// Of the `open` courses, by number, those that are sums of others at the same place: of `known` ones, of which the answers are known, and of
/// other open ones. `how` closely: the share of itself that a course may miss.
pub(super) fn sums<P: PartialEq>(
    open: &[usize],
    known: &[usize],
    courses: &HashMap<usize, DVector<f64>>,
    place: impl Fn(usize) -> P,
    how: f64,
) -> BTreeMap<usize, Vec<(usize, f64)>> {
    let mut places: Vec<P> = Vec::new();
    for own in open.iter().map(|k| place(*k)) {
        if !places.contains(&own) {
            places.push(own);
        }
    }
    let mut all = BTreeMap::new();
    for own in places {
        let at_place = |numbers: &[usize]| -> Vec<(usize, DVector<f64>)> {
            let there = numbers.iter().filter(|k| place(**k) == own);
            there.filter_map(|k| Some((*k, courses.get(k)?.clone()))).collect()
        };
        let mut there = at_place(known);
        let count = there.len();
        there.extend(at_place(open));
        let (numbers, courses): (Vec<usize>, Vec<DVector<f64>>) = there.into_iter().unzip();
        for (k, sum) in numbers.iter().zip(spanned(&courses, count, how)).skip(count) {
            all.extend(sum.map(|terms| (*k, terms.into_iter().map(|(t, f)| (numbers[t], f)).collect())));
        }
    }
    all
}

/// Of each course: the numbers of others and factors with which it is their sum; `None` if it is none. Those others are no
/// sums themselves, and the first `known` ones, of which the answers are known, are among them before any other. `how` closely:
/// the share of itself that a course may miss.
fn spanned(courses: &[DVector<f64>], known: usize, how: f64) -> Vec<Option<Vec<(usize, f64)>>> {
    let sizes: Vec<f64> = courses.iter().map(DVector::norm).collect();
    // what the ones that were taken do not make of each, and with which factors they make the rest
    let mut rests: Vec<DVector<f64>> = courses.to_vec();
    let mut factors: Vec<Vec<f64>> = vec![Vec::new(); courses.len()];
    let mut taken: Vec<usize> = Vec::new();
    let missed = |rests: &[DVector<f64>], k: usize| {
        if sizes[k] > 0.0 { rests[k].norm() / sizes[k] } else { 0.0 }
    };
    loop {
        let worst = |among: Range<usize>| {
            let open = among.filter(|k| !taken.contains(k)).map(|k| (k, missed(&rests, k)));
            let worst = open.max_by(|a, b| a.1.total_cmp(&b.1).then(b.0.cmp(&a.0)));
            worst.filter(|(_, missed)| *missed > how)
        };
        let Some((next, _)) = worst(0..known).or_else(|| worst(known..courses.len())) else { break };
        // the next one's rest is it less what those before make of it
        let (rest, own) = (rests[next].clone(), factors[next].clone());
        let length = rest.norm_squared();
        for k in 0..courses.len() {
            let share = rest.dot(&rests[k]) / length;
            rests[k].axpy(-share, &rest, 1.0);
            for (factor, less) in factors[k].iter_mut().zip(&own) {
                *factor -= share * less;
            }
            factors[k].push(share);
        }
        taken.push(next);
    }
    let sum = |k: usize| {
        if taken.contains(&k) {
            return None;
        }
        let terms: Vec<(usize, f64)> = taken.iter().copied().zip(factors[k].iter().copied()).collect();
        let size: f64 = terms.iter().map(|(t, factor)| factor.abs() * sizes[*t]).sum();
        (size <= CANCELLED * sizes[k]).then_some(terms)
    };
    (0..courses.len()).map(sum).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn course(of: impl Fn(f64) -> f64) -> DVector<f64> {
        DVector::from_fn(500, |k, _| of(0.01 * k as f64))
    }

    #[test]
    fn courses_that_are_sums_are_found_and_are_them() {
        let courses = [
            course(f64::sin),
            course(|_| 1.0),
            course(|t| 2.0 + 3.0 * t.sin()),
            course(|t| t * t),
            course(|t| 0.5 - t * t),
            course(|_| 0.0),
            // hardly another, but for what is between the two
            course(|t| 1.0 + 1e-3 * (50.0 * t).sin()),
            course(|t| (50.0 * t).sin()),
        ];
        let sums = spanned(&courses, 0, CLOSELY);
        let own = sums.iter().filter(|s| s.is_none()).count();
        assert_eq!(own, 4, "{sums:?}");
        for (course, sum) in courses.iter().zip(&sums) {
            let Some(terms) = sum else { continue };
            assert!(terms.iter().all(|(t, _)| sums[*t].is_none()));
            let made: DVector<f64> =
                terms.iter().fold(DVector::zeros(500), |made, (t, factor)| made + *factor * &courses[*t]);
            assert!((course - made).norm() <= CLOSELY * course.norm());
        }
    }

    #[test]
    fn what_others_make_only_by_cancelling_is_a_course_of_its_own() {
        // two that differ little, and their difference, which is known with their errors only
        let (a, b) = (course(|_| 1.0), course(|t| 1.0 + 0.03 * t.cos()));
        let c = course(|t| 0.03 * t.cos());
        let sums = spanned(&[a, b, c], 0, CLOSELY);
        assert!(sums[0].is_none() && sums[2].is_none(), "{sums:?}");
        assert!(spanned(&[], 0, CLOSELY).is_empty());
    }

    #[test]
    fn what_is_known_makes_others_and_only_at_its_own_place() {
        let courses = [course(f64::sin), course(|t| 2.0 + 3.0 * t.sin()), course(|_| 1.0)];
        // beside the first the third is missed most, so that the second is a sum; unless that one is known
        assert!(spanned(&courses, 0, CLOSELY)[1].is_some());
        let sum = spanned(&courses, 2, CLOSELY)[2].clone().unwrap();
        assert!((sum[0].1 + 1.5).abs() < 1e-9 && (sum[1].1 - 0.5).abs() < 1e-9, "{sum:?}");

        let numbered: HashMap<usize, DVector<f64>> = courses.into_iter().enumerate().collect();
        let at = |place: fn(usize) -> usize| sums(&[2], &[0, 1], &numbered, place, CLOSELY);
        let there = at(|_| 0);
        assert_eq!(there[&2].iter().map(|term| term.0).collect::<Vec<_>>(), [0, 1]);
        assert!(at(|k| k).is_empty());
    }
}
