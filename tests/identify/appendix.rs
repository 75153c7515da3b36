//! The tables of the source's worked examples and counter-examples, row by row. Numbers that the source does not print were
//! computed from its formulas by a program of its own, to the digits that are given.

use crate::examples::*;
use latsch::identify::check::{Injectivity, Sampled, Sampling, depends, injective};
use latsch::identify::solve::{
    Goal, Group, Method, Nesting, Sequence, Side, Stall, Targets, Unsolved, Way, local, nested, sequence,
};
use latsch::stats::SplitMix64;
use std::f64::consts::{FRAC_PI_2, PI, TAU};

/// The Euclidean distance of a stall from the goal, and where.
#[track_caller]
fn assert_stall(map: &Example, to: &Goal, method: Method, start: &[f64], at: &[f64], distance: f64) {
    let (stalled, found) = stall_of(map, to, method, start);
    assert_near(&stalled, at, 1e-4);
    assert!((found - distance).abs() < 2e-6, "{start:?}: {found} instead of {distance}");
}

/// Section B.1: what answers only in a small ball is found by no search that follows slopes, and by no few draws.
#[test]
fn a_needle_in_a_haystack_is_not_found_and_not_denied() {
    const RADIUS: f64 = 1e-3;
    let needle = Example {
        bounds: vec![[-1.0, 1.0]; 2],
        values: |p| vec![(RADIUS - (p[0] - 0.3).hypot(p[1] + 0.2)).max(0.0), 0.0],
        slopes: |p| {
            let [x, y] = [p[0] - 0.3, p[1] + 0.2];
            let distance = x.hypot(y);
            if distance < RADIUS { vec![-x / distance, -y / distance, 0.0, 0.0] } else { vec![0.0; 4] }
        },
    };
    assert_eq!(needle.at(&[0.3, -0.2]).unwrap()[0], RADIUS);
    let highest = Goal { values: vec![RADIUS, 0.0], sizes: vec![RADIUS, 1.0], tolerance: 1e-9 };
    let mut random = SplitMix64::new(11);
    for _ in 0..50 {
        let start = [0; 2].map(|_| 2.0 * random.uniform() - 1.0);
        assert!(needle.jacobian(&start).unwrap().iter().all(|d| *d == 0.0));
        for method in [Method::Newton, Method::Gradient] {
            // no reason but a singular Jacobian: the start is within the box
            match local(&needle, &highest, method, &start) {
                Err(Unsolved::Stalled { at, stall: Stall::Singular, .. }) => assert_near(&at, &start, 0.0),
                other => panic!("{other:?}"),
            }
        }
    }
    // independent, as far as draws tell: a pass is evidence and no proof
    let sampled = Sampled::new(&needle, Sampling::default()).unwrap();
    assert!(depends(&sampled, &[0], &[0, 1]).dependence.is_none());
    let answer = injective(&sampled, &[0, 1], &[0, 1]).unwrap();
    assert!(!matches!(answer, Injectivity::Passed { .. }), "{answer:?}");
    // one unknown: both ends say that the target is too small
    let single = Example {
        bounds: vec![[-1.0, 1.0]],
        values: |p| vec![(RADIUS - (p[0] - 0.3).abs()).max(0.0)],
        slopes: |_| vec![0.0],
    };
    let found = nested(&single, &Goal::new(&[RADIUS / 2.0]), &Nesting::plain(1), None);
    assert!(matches!(found, Err(Unsolved::OutOfReach { .. })), "{found:?}");
}

/// Example 3.12: the last row of its table, and the points that the source names.
#[test]
fn points_at_which_local_methods_end_are_those_of_the_source() {
    let map = stalls();
    let to = goal(&map, &[-3.0, 0.5]);
    assert_stall(&map, &to, Method::Newton, &[4.0, 0.0], &[2.352349, 0.0], 5.386066);
    // the nearest point on the whole segment jumps over the boundary stall
    assert_found(local(&map, &to, Method::Gradient, &[4.0, 0.0]), &[-3.0, 0.5], 1e-8);
    for method in [Method::Newton, Method::Gradient] {
        for start in [[-0.5, 0.2], [-1.0, 0.5], [-2.0, 1.0], [-5.0, 1.0]] {
            assert_found(local(&map, &to, method, &start), &[-3.0, 0.5], 1e-8);
        }
    }
    let on_boundary = |x: f64| {
        let excess = to.excess(&map.at(&[x, 0.0]).unwrap());
        let jacobian = map.jacobian(&[x, 0.0]).unwrap();
        assert!(jacobian.determinant() < 0.0);
        let newton = jacobian.clone().lu().solve(&-&excess).unwrap();
        (excess.norm(), jacobian.tr_mul(&excess)[0], newton[0])
    };
    // nearest on the boundary (Z_1 of the text), and the distance's saddle (Z_3): a root of 2x³ + (1 - 2 Z2) x - Z1 each
    assert_near(&map.at(&[2.3256344, 0.0]).unwrap(), &[2.3256344, 5.4085754], 1e-6);
    for (x, distance) in [(2.3256344, 5.384700), (0.2457159, 7.220224)] {
        let (found, slope, _) = on_boundary(x);
        assert!((found - distance).abs() < 1e-6 && slope.abs() < 1e-5, "{found} {slope}");
    }
    // where Newton's direction leads straight off the boundary (Z_2, Z_4)
    for x in [2.3523489, -0.1584325] {
        let (_, _, along) = on_boundary(x);
        assert!(along.abs() < 1e-6, "{along}");
    }
}

/// Section B.4, all rows; Newton's method needs five steps.
#[test]
fn a_chain_row_by_row() {
    let map = chain();
    for (solution, values, start) in [
        ([5.5, 0.5], [5.5, 1.917340], [2.0, 0.5]),
        ([6.0, 0.8], [6.0, 2.720341], [1.0, 0.5]),
        ([5.5, 0.5], [5.5, 1.917340], [1.0, 0.5]),
    ] {
        let to = goal(&map, &solution);
        assert_near(&to.values, &values, 1e-6);
        let found = local(&map, &to, Method::Newton, &start).unwrap();
        assert_near(&found.parameters, &solution, 1e-9);
    }
    // the start decides: the same goal is not reached from (2, 0.5)
    let to = goal(&map, &[5.5, 0.5]);
    assert_found(local(&map, &to, Method::Gradient, &[1.0, 0.5]), &[5.5, 0.5], 1e-8);
}

/// Section B.6: pairs of equal targets lie mirrored about p2 = 1/2, where the determinant changes its sign.
#[test]
fn pairs_of_equal_targets() {
    let map = twofold();
    assert_eq!(map.at(&[1.0, 0.0]).unwrap(), [1.0, 1.0]);
    assert_eq!(map.at(&[0.0, 1.0]).unwrap(), [1.0, 1.0]);
    assert_eq!(map.at(&[2.0, 0.25]).unwrap(), [2.25, 2.0625]);
    assert_eq!(map.at(&[1.5, 0.75]).unwrap(), [2.25, 2.0625]);
    for (p2, sign) in [(0.25, -1.0), (0.75, 1.0)] {
        assert_eq!(map.jacobian(&[1.0, p2]).unwrap().determinant().signum(), sign);
    }
}

/// Section B.7: injective, though each target alone has a value twice. Its closed form finds what neither a search by signs nor
/// the gradient method does.
#[test]
fn a_spiral_is_inverted_by_its_closed_form_only() {
    let map = spiral();
    assert_near(&map.at(&[FRAC_PI_2, 1.0]).unwrap(), &[-0.841471, 0.540302], 1e-6);
    for p in [[0.5, 1.0], [TAU - 2.5, 1.0]] {
        assert!((map.at(&p).unwrap()[0] - 0.070737).abs() < 1e-6);
    }
    assert_stall(&map, &goal(&map, &[5.0, 1.0]), Method::Gradient, &[0.1, 4.9], &[0.0, 0.446962], 0.730571);
    let inverse = |z: &[f64], _: &[f64]| {
        let p2 = z[0].hypot(z[1]);
        Ok(vec![(z[1].atan2(z[0]) - p2).rem_euclid(TAU), p2])
    };
    let closed = [Group { size: 2, way: Way::Direct(&inverse) }];
    let signs = [[1.0, 1.0], [1.0, -1.0], [-1.0, 1.0], [-1.0, -1.0]];
    let mut random = SplitMix64::new(7);
    for _ in 0..50 {
        let p = [1.99 * PI * random.uniform(), 0.01 + 4.99 * random.uniform()];
        assert!((map.jacobian(&p).unwrap().determinant() + p[1]).abs() < 1e-12);
        let to = goal(&map, &p);
        let found = sequence(&map, &to, &closed, &[0.1, 4.9], false).unwrap().solved();
        assert_found(found, &p, 1e-9);
        // a search that relies on signs which are not there may be lucky; it is never wrong
        for rises in signs {
            let nesting = Nesting { rises: rises.to_vec(), ..Nesting::plain(2) };
            if let Ok(found) = nested(&map, &to, &nesting, None) {
                assert_near(&found.parameters, &p, 1e-6);
            }
        }
    }
}

/// Section B.8: the domain of the outer relation for no second target, and how often the gradient method stalls: "in about
/// eight of a hundred" draws.
#[test]
fn a_split_domain_and_how_often_descent_stalls_there() {
    let map = split();
    let second = [Group::single()];
    for (p1, is_inside) in [
        (FRAC_PI_2 - 1e-3, false),
        (FRAC_PI_2 + 1e-3, true),
        (TAU / 3.0 - 1e-3, true),
        (TAU / 3.0 + 1e-3, false),
        (2.0 * TAU / 3.0 - 1e-3, false),
        (2.0 * TAU / 3.0 + 1e-3, true),
        (1.5 * PI - 1e-3, true),
        (1.5 * PI + 1e-3, false),
    ] {
        let part = latsch::identify::solve::Part::new(&map, vec![1], vec![1], &[p1, 0.0]);
        let to = Goal { values: vec![0.0], sizes: vec![1.0], tolerance: 1e-9 };
        let found = sequence(&part, &to, &second, &[0.5], false).and_then(Sequence::solved);
        assert_eq!(found.is_ok(), is_inside, "{p1}: {found:?}");
    }
    let mut random = SplitMix64::new(12);
    let draws = 300;
    let stalled = (0..draws).filter(|_| {
        let mut draw = || [TAU * random.uniform(), random.uniform()];
        let (to, start) = (goal(&map, &draw()), draw());
        local(&map, &Goal { tolerance: 1e-4, ..to }, Method::Gradient, &start).is_err()
    });
    let stalled = stalled.count();
    // three standard deviations of as many draws to each side
    assert!((10..=38).contains(&stalled), "{stalled} of {draws}");
}

/// Section B.9, all rows, and a second goal on the same ray from the spurious point.
#[test]
fn newton_stalls_left_of_the_spurious_point_and_the_gradient_method_nowhere() {
    let map = gradient_only();
    assert_near(&map.at(&[0.15, 0.0]).unwrap(), &[0.15, 0.0225], 1e-12);
    assert_near(&map.at(&[0.9, -0.09]).unwrap(), &[0.825, 0.63], 1e-12);
    let to = goal(&map, &[1.0, -0.1625]);
    for (start, at, distance) in
        [([0.15, 0.0], 0.15, 0.975388), ([0.05, 0.0], 0.05, 1.064369), ([0.01, -0.5], 0.01, 1.097139)]
    {
        assert_stall(&map, &to, Method::Newton, &start, &[at, 0.0], distance);
    }
    // to the four and six digits that are given
    let (at, distance) = stall_of(&map, &to, Method::Newton, &[0.10, -0.01]);
    assert_near(&at, &[0.0980, 0.0], 1e-4);
    assert!((distance - 1.02296).abs() < 1e-5, "{distance}");
    for start in [[0.1, 0.0], [0.02, 0.0], [0.05, -0.1]] {
        let (at, distance) = stall_of(&map, &to, Method::Newton, &start);
        assert!(at[1] == 0.0 && (0.9..1.1).contains(&distance), "{at:?} {distance}");
    }
    for start in [[0.4, -0.1], [1.3, -0.5], [0.65, -0.25], [0.3, -0.2], [1.0, 0.0], [1.2, -0.4]] {
        assert_found(local(&map, &to, Method::Newton, &start), &[1.0, -0.1625], 1e-8);
        assert_found(local(&map, &to, Method::Gradient, &start), &[1.0, -0.1625], 1e-8);
    }
    assert_found(local(&map, &to, Method::Gradient, &[0.10, -0.01]), &[1.0, -0.1625], 1e-8);
    let second = goal(&map, &[0.9, -0.09]);
    assert!(local(&map, &second, Method::Newton, &[0.15, 0.0]).is_err());
    assert_found(local(&map, &second, Method::Gradient, &[0.15, 0.0]), &[0.9, -0.09], 1e-8);
    // forty draws: all of them, and all but a few
    let mut random = SplitMix64::new(13);
    let mut newton = 0;
    for _ in 0..40 {
        let mut draw = || [0.01 + 1.29 * random.uniform(), -0.5 * random.uniform()];
        let (p, start) = (draw(), draw());
        let to = Goal { tolerance: 1e-6, ..goal(&map, &p) };
        assert_found(local(&map, &to, Method::Gradient, &start), &p, 1e-3);
        newton += u32::from(local(&map, &to, Method::Newton, &start).is_ok());
    }
    assert!((34..40).contains(&newton), "{newton}");
}

/// Section B.11, all rows, with the printed goal and with a farther one: for the printed one the best point of the box is 0.0057 away.
#[test]
fn three_unknowns_row_by_row() {
    let map = three_stall();
    assert_near(&map.at(&[1.0, -2.0, 0.0]).unwrap(), &[-1.0, -0.9, -0.34], 1e-12);
    let to = |values: [f64; 3]| Goal { values: values.to_vec(), sizes: vec![1.0; 3], tolerance: 1e-10 };
    let (farther, printed) = (to([-2.44, 0.38, 1.26]), to([-2.404, 0.348, 1.22]));
    let solution = [-10.392941, 8.0, -0.047059];
    assert_near(&map.at(&solution).unwrap(), &farther.values, 2e-6);
    let (stalled, distance) = stall_of(&map, &farther, Method::Gradient, &[1.0, -2.0, 0.0]);
    assert_near(&stalled, &[1.0, -2.0, 0.0], 1e-6);
    assert!((distance - 2.504396).abs() < 1e-6, "{distance}");
    assert_stall(&map, &farther, Method::Gradient, &[1.2, -2.1, -0.1], &[3.33504, -4.37878, 0.0], 2.477814);
    assert_stall(&map, &farther, Method::Gradient, &[5.0, -4.0, -1.0], &[3.3351, -4.3789, 0.0], 2.477814);
    assert!(local(&map, &farther, Method::Newton, &[1.0, -2.0, 0.0]).is_err());
    assert_stall(&map, &farther, Method::Newton, &[1.2, -2.1, -0.1], &[0.6296, -1.6883, 0.0], 2.503951);
    for start in [[0.0, 0.0, -2.5], [-3.0, 2.0, -1.0], [10.0, 10.0, 0.0], [-12.0, 9.0, -0.5]] {
        for method in [Method::Newton, Method::Gradient] {
            assert_found(local(&map, &farther, method, &start), &solution, 1e-6);
        }
    }
    // the printed goal is met outside of the box only
    assert_near(&map.at(&[-10.165471, 7.75, 0.011471]).unwrap(), &printed.values, 2e-6);
    let (_, distance) = stall_of(&map, &printed, Method::Gradient, &[1.0, -2.0, 0.0]);
    assert!((distance - 2.441786).abs() < 1e-6, "{distance}");
    assert_stall(&map, &printed, Method::Gradient, &[5.0, -4.0, -1.0], &[3.24126, -4.28017, 0.0], 2.418109);
    let best = [-10.1859, 7.7801, 0.0];
    let (at, distance) = stall_of(&map, &printed, Method::Gradient, &[-10.0, 7.7, -0.01]);
    assert_near(&at, &best, 1e-3);
    assert!((distance - 0.005687).abs() < 1e-6, "{distance}");
}

/// A target that does not depend on the draws of other parameters, but has all its size from them: so that two of one size are
/// compared as they are.
struct Even(Example);

const SIZE: f64 = 1e4;

impl Targets for Even {
    fn bounds(&self) -> &[[f64; 2]] {
        &self.0.bounds
    }

    fn at(&self, p: &[f64]) -> latsch::Result<Vec<f64>> {
        let n = p.len() / 2;
        Ok((self.0.values)(&p[..n]).iter().zip(&p[n..]).map(|(z, shift)| z + SIZE * shift).collect())
    }
}

/// The margins of (3.43) where all targets count alike. Those of B.4 and B.8 have a closed form: half of the angle that the
/// directions take up, with a normal of which the largest component is 1. Those of B.11 are the source's.
#[test]
fn margins_are_those_of_the_tables() {
    let margins = |mut map: Example| -> Vec<f64> {
        let n = map.bounds.len();
        map.bounds.extend(vec![[0.0, 1.0]; n]);
        let even = Even(map);
        let sampled = Sampled::new(&even, Sampling::default()).unwrap();
        let group: Vec<usize> = (0..n).collect();
        match injective(&sampled, &group, &group).unwrap() {
            Injectivity::Passed { orthants, .. } => orthants.iter().map(|o| o.margin).collect(),
            other => panic!("{other:?}"),
        }
    };
    // from where the directions are to where they could be at worst
    let assert_margins = |map: Example, expected: &[f64]| {
        let found = margins(map);
        for (found, expected) in found.iter().zip(expected) {
            assert!((0.999..1.05).contains(&(found / expected)), "{found} instead of {expected}");
        }
    };
    // angles of (1, -2 sin p1) and (0, 1): between them sqrt(5) - 2
    assert_margins(chain(), &[5f64.sqrt() - 2.0; 2]);
    let steep = 2f64.atan();
    let across = 1f64.atan2(0.2);
    let margin = |from: f64, to: f64| {
        let (half, middle) = (0.5 * (to - from), 0.5 * (from + to));
        half.cos() / middle.cos().abs().max(middle.sin().abs())
    };
    let split_margins = [margin(-steep, across), margin(across - PI, steep)];
    assert_near(&split_margins, &[0.328, 0.140], 1e-3);
    assert_margins(split(), &split_margins);
    let found = margins(three_stall());
    assert!(found[0] >= 1.0, "{found:?}");
    let mut others = found[1..].to_vec();
    others.sort_by(f64::total_cmp);
    for (found, expected) in others.iter().zip([0.0557, 0.0568, 0.251]) {
        assert!((0.99..1.05).contains(&(found / expected)), "{found} instead of {expected}");
    }
}

/// Injective maps of which (3.43) does not say so: which orthants fail.
#[test]
fn orthants_that_fail_are_those_of_the_tables() {
    for (map, fails) in [
        (stalls(), vec![[1.0, -1.0]]),
        (gradient_only(), vec![[1.0, -1.0]]),
        (spiral(), vec![[1.0, 1.0], [1.0, -1.0]]),
    ] {
        let sampled = Sampled::new(&map, Sampling::default()).unwrap();
        let answer = injective(&sampled, &[0, 1], &[0, 1]).unwrap();
        let Injectivity::Open { orthants, .. } = answer else { panic!("{answer:?}") };
        for signs in fails {
            // the opposite orthant is the same
            let is_it = |own: &[f64]| own[0] * own[1] == signs[0] * signs[1];
            assert!(orthants.iter().any(|o| is_it(&o.signs) && o.margin == 0.0), "{orthants:?}");
        }
    }
}

/// Groups of three: the goals of the table, found to 1e-9 with no more evaluations than the printed algorithm needs.
#[test]
fn groups_of_three_need_no_more_evaluations_than_printed() {
    // (3.37) with both ends of each level and brackets of 1e-9
    const PRINTED: usize = 33_265;
    for (map, falls, p, values) in [
        (three(), 1.0, [0.3, -0.4, 0.7], [0.6927, -0.1564, 1.5343]),
        (three(), 1.0, [-0.9, 0.95, -0.2], [-1.6479, 0.9857375, -0.8258]),
        (three_with_tail(), -1.0, [0.3, -0.4, 0.7], [0.6927, -0.1564, 0.9343]),
        (three_with_tail(), -1.0, [-0.9, 0.95, -0.2], [-1.6479, 0.9857375, 0.9742]),
        (three_with_tail(), -1.0, [0.9, 0.9, 0.9], [2.4129, 3.2229, 1.4229]),
        (three_with_tail(), -1.0, [0.0, -0.999, 0.99], [-0.0027, -1.6027003, 1.5775299]),
    ] {
        let to = goal(&map, &p);
        assert_near(&to.values, &values, 1e-7);
        let mut nesting = Nesting::plain(3);
        nesting.falls[0][2] = falls;
        let found = nested(&map, &to, &nesting, None).unwrap();
        assert_near(&found.parameters, &p, 1e-9);
        assert!(found.evaluations < PRINTED, "{}", found.evaluations);
    }
    // with the wrong sign the search leaves the box, while descent meets the goal within: that is no goal out of reach
    let near_corner = goal(&three_with_tail(), &[0.0, -0.999, 0.99]);
    let found = nested(&three_with_tail(), &near_corner, &Nesting::plain(3), None);
    assert!(matches!(found, Err(Unsolved::Undecided { .. })), "{found:?}");
    // two unknowns (3.12), with 1806 as printed for brackets of 1e-12
    let nesting = Nesting {
        parameters: vec![1, 0],
        targets: vec![1, 0],
        rises: vec![-1.0, 1.0],
        falls: vec![vec![1.0; 2]; 2],
    };
    let found = nested(&stalls(), &goal(&stalls(), &[-3.0, 0.5]), &nesting, None).unwrap();
    assert!(found.evaluations < 1806, "{}", found.evaluations);
    // a corner, and a step beyond it
    let mut beyond = goal(&three(), &[1.0, -1.0, 1.0]);
    beyond.values[0] += 0.01;
    let found = nested(&three(), &beyond, &Nesting::plain(3), None);
    assert!(matches!(found, Err(Unsolved::OutOfReach { side: Side::Above, .. })), "{found:?}");
}

/// (2.9): coefficients of a continuous and of a discrete system of the first order, back in closed form.
#[test]
fn a_discrete_system_gives_back_the_continuous_one() {
    const STEP: f64 = 0.5;
    let system = Example {
        bounds: vec![[-10.0, -0.1], [-10.0, 10.0]],
        values: |p| {
            let kept = (p[0] * STEP).exp();
            vec![kept, (kept - 1.0) / p[0] * p[1]]
        },
        slopes: |p| {
            let kept = (p[0] * STEP).exp();
            let gain = (kept - 1.0) / p[0];
            vec![STEP * kept, 0.0, (STEP * kept - gain) / p[0] * p[1], gain]
        },
    };
    let to = goal(&system, &[-2.0, 3.0]);
    assert_near(&to.values, &[0.36787944, 0.94818084], 1e-8);
    let back = |z: &[f64], _: &[f64]| {
        let rate = z[0].ln() / STEP;
        Ok(vec![rate, rate * z[1] / (z[0] - 1.0)])
    };
    let closed = [Group { size: 2, way: Way::Direct(&back) }];
    for groups in [&closed[..], &[Group::single(), Group::single()]] {
        let found = sequence(&system, &to, groups, &[-9.0, -9.0], false).and_then(Sequence::solved);
        assert_found(found, &[-2.0, 3.0], 1e-8);
    }
}
