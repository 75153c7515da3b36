//! What each solver finds, and what it says where there is nothing to find.

use crate::examples::*;
use latsch::Result;
use latsch::identify::solve::{
    Direct, Goal, Group, Method, Nesting, Sequence, Side, Solution, Stall, Tail, Targets, Unsolved, Way,
    intervals, local, nested, sequence,
};
use latsch::stats::SplitMix64;
use std::f64::consts::TAU;

#[test]
fn local_methods_stall_where_the_source_says() {
    let map = stalls();
    let to = goal(&map, &[-3.0, 0.5]);
    assert_near(&to.values, &[-2.93877179, 6.54039689], 1e-8);
    for start in [[2.0, 0.1], [2.0, 1.0], [1.0, 0.5], [0.5, 1.0], [1.0, 0.0]] {
        for method in [Method::Newton, Method::Gradient] {
            let (at, distance) = stall_of(&map, &to, method, &start);
            assert_near(&at, &[2.325634, 0.0], 1e-4);
            assert!((distance - 5.384700).abs() < 1e-6, "{distance}");
        }
    }
    // the fixed point of Newton's method lies beside the nearest point
    let (at, distance) = stall_of(&map, &to, Method::Newton, &[3.0, 1.0]);
    assert_near(&at, &[2.352349, 0.0], 1e-5);
    assert!((distance - 5.386066).abs() < 1e-6, "{distance}");
    assert_near(&stall_of(&map, &to, Method::Gradient, &[3.0, 1.0]).0, &[2.325634, 0.0], 1e-4);
    assert_near(&stall_of(&map, &to, Method::Newton, &[0.0, 0.0]).0, &[0.0, 0.0], 1e-9);
    assert_found(local(&map, &to, Method::Gradient, &[0.0, 0.0]), &[-3.0, 0.5], 1e-8);
    for start in [[-0.5, 0.2], [-1.0, 0.5], [-2.0, 1.0], [-5.0, 1.0]] {
        assert_found(local(&map, &to, Method::Newton, &start), &[-3.0, 0.5], 1e-8);
    }
}

#[test]
fn nested_bisection_solves_what_local_methods_do_not() {
    let map = stalls();
    // both exchanged; the first target then falls
    let nesting = Nesting {
        parameters: vec![1, 0],
        targets: vec![1, 0],
        rises: vec![-1.0, 1.0],
        falls: vec![vec![1.0; 2]; 2],
    };
    let mut random = SplitMix64::new(1);
    for k in 0..50 {
        let p = if k == 0 { [-3.0, 0.5] } else { [-10.0 + 20.0 * random.uniform(), 10.0 * random.uniform()] };
        let values = map.at(&p).unwrap();
        let found = nested(&map, &Goal::new(&values), &nesting, None).unwrap();
        assert_near(&found.parameters, &p, 1e-7);
        assert!(found.evaluations < 46 * 46, "{}", found.evaluations);
    }
    // in the printed order its signs are not those that were promised
    let wrong = nested(&map, &goal(&map, &[-3.0, 0.5]), &Nesting::plain(2), None);
    assert!(wrong.is_err(), "{wrong:?}");
}

#[test]
fn a_chain_is_nothing_for_the_gradient_method() {
    let map = chain();
    for (solution, start, at, distance) in [
        ([5.5, 0.5], [2.0, 0.5], [2.139207, 1.0], 3.907771),
        ([6.0, 0.8], [1.0, 0.5], [1.790686, 1.0], 4.729607),
    ] {
        let to = goal(&map, &solution);
        let (stalled, found) = stall_of(&map, &to, Method::Gradient, &start);
        assert_near(&stalled, &at, 1e-5);
        assert!((found - distance).abs() < 1e-6, "{found}");
        assert_found(local(&map, &to, Method::Newton, &start), &solution, 1e-9);
    }
    let map = steep_chain();
    let to = goal(&map, &[5.5, 0.5]);
    let (at, distance) = stall_of(&map, &to, Method::Newton, &[2.2, 1.0]);
    assert_near(&at, &[2.2, 1.0], 1e-12);
    assert!((distance - 2.094378).abs() < 1e-6, "{distance}");
    // the first target hardly changes there: 1e-10 of it is 3e-6 of the parameter
    for longest in [0.1, 0.3, 1.0, 3.0] {
        assert_found(local(&map, &to, Method::ChainNewton { longest }, &[2.2, 1.0]), &[5.5, 0.5], 1e-5);
    }
    // one after the other is safe without any of that
    let chain = [Group::single(), Group::single()];
    let found = sequence(&map, &Goal { tolerance: 1e-15, ..to }, &chain, &[2.2, 1.0], false);
    assert_found(found.and_then(Sequence::solved), &[5.5, 0.5], 1e-9);
}

/// Section B.6: strictly rising in each parameter, and yet (1, 0) and (0, 1) give the same.
#[test]
fn two_answers_are_shown_as_two() {
    let map = twofold();
    for goal in [[2.25, 2.0625], [2.2, 2.05]] {
        match nested(&map, &Goal::new(&goal), &Nesting::plain(2), None) {
            Err(Unsolved::NotUnique { target: 0, witnesses: [a, b] }) => {
                assert!((a[0] - b[0]).abs() > 1e-3, "{a:?} {b:?}");
                assert_near(&map.at(&a).unwrap(), &map.at(&b).unwrap(), 1e-9);
            }
            other => panic!("{goal:?}: {other:?}"),
        }
    }
}

/// Section B.8: in the printed order the first relation has a domain of two parts.
#[test]
fn a_split_domain_is_no_wrong_answer() {
    let map = split();
    let to = goal(&map, &[4.5, 0.6]);
    assert_near(&to.values, &[4.62, 0.1784084], 1e-7);
    let found = nested(&map, &to, &Nesting::plain(2), None);
    assert!(matches!(found, Err(Unsolved::OutOfReach { .. } | Unsolved::Undecided { .. })), "{found:?}");
    let exchanged = Nesting { parameters: vec![1, 0], targets: vec![1, 0], ..Nesting::plain(2) };
    let mut random = SplitMix64::new(2);
    for k in 0..100 {
        let p = if k == 0 { [4.5, 0.6] } else { [TAU * random.uniform(), random.uniform()] };
        assert_found(nested(&map, &goal(&map, &p), &exchanged, None), &p, 1e-8);
    }
}

/// Section B.9 and the theorem of B.10.
#[test]
fn two_that_rise_with_both_are_found_by_gradient_and_by_descent() {
    let map = gradient_only();
    let to = goal(&map, &[1.0, -0.1625]);
    assert_near(&to.values, &[0.875, 0.675], 1e-12);
    for (start, at, distance) in [
        ([0.15, 0.0], [0.15, 0.0], 0.975388),
        ([0.05, 0.0], [0.05, 0.0], 1.064369),
        ([0.01, -0.5], [0.01, 0.0], 1.097139),
    ] {
        let (stalled, found) = stall_of(&map, &to, Method::Newton, &start);
        assert_near(&stalled, &at, 1e-5);
        assert!((found - distance).abs() < 1e-5, "{found}");
        assert_found(local(&map, &to, Method::Gradient, &start), &[1.0, -0.1625], 1e-8);
    }
    let tail = Some(Tail { sign: 1.0 });
    let mut random = SplitMix64::new(3);
    for _ in 0..200 {
        let p = [0.01 + 1.29 * random.uniform(), -0.5 * random.uniform()];
        assert_found(nested(&map, &goal(&map, &p), &Nesting::plain(2), tail.as_ref()), &p, 1e-7);
    }
}

/// Section B.11: the printed goal has no answer in the box, by 0.01; a farther one has.
#[test]
fn three_unknowns_are_too_many_for_the_gradient_method() {
    let map = three_stall();
    let to = Goal { values: vec![-2.44, 0.38, 1.26], sizes: vec![1.0; 3], tolerance: 1e-10 };
    let solution = [-10.392941, 8.0, -0.047059];
    for start in [[1.0, -2.0, 0.0], [1.2, -2.1, -0.1], [5.0, -4.0, -1.0]] {
        let (at, distance) = stall_of(&map, &to, Method::Gradient, &start);
        assert!(at[2] == 0.0 && distance > 2.4, "{at:?} {distance}");
    }
    assert_found(local(&map, &to, Method::Gradient, &[0.0, 0.0, -2.5]), &solution, 1e-6);
    assert_found(local(&map, &to, Method::Newton, &[5.0, -4.0, -1.0]), &solution, 1e-6);
    let printed = Goal { values: vec![-2.404, 0.348, 1.22], ..to };
    for start in [[0.0, 0.0, -2.5], [1.0, -2.0, 0.0], [-10.0, 7.7, -0.01]] {
        for method in [Method::Newton, Method::Gradient] {
            assert!(local(&map, &printed, method, &start).is_err());
        }
    }
}

#[test]
fn three_unknowns_by_bisection_and_with_a_tail() {
    let map = three();
    let corner = [1.0, -1.0, 1.0];
    for p in [[0.3, -0.4, 0.7], [-0.9, 0.95, -0.2], corner] {
        let found = nested(&map, &goal(&map, &p), &Nesting::plain(3), None).unwrap();
        assert_near(&found.parameters, &p, 1e-8);
    }
    assert_near(&map.at(&corner).unwrap(), &[2.1, -0.6, 2.6], 1e-12);
    let map = three_with_tail();
    for p in [[0.3, -0.4, 0.7], [-0.9, 0.95, -0.2], [0.9, 0.9, 0.9], [0.0, -0.999, 0.99]] {
        let to = goal(&map, &p);
        assert_found(nested(&map, &to, &Nesting::plain(3), Some(&Tail { sign: 1.0 })), &p, 1e-7);
        // the third unknown rises with the first: bisection alone, with signs of its own
        let mut nesting = Nesting::plain(3);
        nesting.falls[0][2] = -1.0;
        assert_found(nested(&map, &to, &nesting, None), &p, 1e-7);
    }
    // the signs that all fall are wrong here, and that is said
    let wrong = nested(&map, &goal(&map, &[0.0, -0.999, 0.99]), &Nesting::plain(3), None);
    assert!(wrong.is_err(), "{wrong:?}");
}

/// With one unknown, and in a group, on the right side.
#[test]
fn what_is_out_of_reach_is_told_with_its_side() {
    let line =
        Example { bounds: vec![[1.0, 3.0]], values: |p| vec![-p[0] * p[0]], slopes: |p| vec![-2.0 * p[0]] };
    let falling = Nesting { rises: vec![-1.0], ..Nesting::plain(1) };
    for (value, expected) in [(-0.5, Side::Below), (-9.5, Side::Above)] {
        match nested(&line, &Goal::new(&[value]), &falling, None) {
            Err(Unsolved::OutOfReach { parameter: 0, side, nearest, residual }) => {
                assert_eq!(side, expected);
                let end = if side == Side::Below { 1.0 } else { 3.0 };
                assert_near(&nearest, &[end], 1e-6);
                assert!((residual - (end * end + value).abs() / value.abs()).abs() < 1e-6);
            }
            other => panic!("{other:?}"),
        }
    }
    for end in [1.0, 3.0] {
        assert_found(nested(&line, &goal(&line, &[end]), &falling, None), &[end], 1e-9);
    }
    // the first would have to be 1.1
    let map = three();
    match nested(&map, &goal(&map, &[1.1, 0.0, 0.0]), &Nesting::plain(3), None) {
        Err(Unsolved::OutOfReach { parameter: 0, side: Side::Above, residual, .. }) => {
            assert!(residual > 0.0)
        }
        other => panic!("{other:?}"),
    }
}

/// A target that turns around has two answers, and a goal within a jump has none.
#[test]
fn one_unknown_that_is_not_monotone_or_jumps() {
    let wave = Example {
        bounds: vec![[0.0, 3.0]],
        values: |p| vec![p[0] + 2.0 * (2.0 * p[0]).sin()],
        slopes: |p| vec![1.0 + 4.0 * (2.0 * p[0]).cos()],
    };
    match nested(&wave, &Goal::new(&[2.0]), &Nesting::plain(1), None) {
        Err(Unsolved::NotUnique { target: 0, witnesses: [a, b] }) => {
            assert!((a[0] - b[0]).abs() > 0.1);
            assert_near(&wave.at(&a).unwrap(), &wave.at(&b).unwrap(), 1e-9);
        }
        other => panic!("{other:?}"),
    }
    let jump = Example {
        bounds: vec![[0.0, 3.0]],
        values: |p| vec![p[0] + f64::from(u8::from(p[0] > 1.0))],
        slopes: |_| vec![1.0],
    };
    let found = nested(&jump, &Goal::new(&[1.5]), &Nesting::plain(1), None);
    assert!(matches!(found, Err(Unsolved::Undecided { .. })), "{found:?}");
}

/// Whenever a local method ends elsewhere, Lemma 1 holds: a singular Jacobian, or the boundary with no way downhill.
#[test]
fn every_stall_has_one_of_the_reasons_of_the_lemma() {
    let mut random = SplitMix64::new(5);
    let mut seen = [0; 2];
    for map in [stalls(), chain(), steep_chain(), split(), spiral(), gradient_only()] {
        for _ in 0..10 {
            let mut draw =
                || map.bounds.iter().map(|[a, b]| a + (b - a) * random.uniform()).collect::<Vec<_>>();
            let (to, start) = (goal(&map, &draw()), draw());
            for method in [Method::Newton, Method::Gradient] {
                let Err(Unsolved::Stalled { at, stall, .. }) = local(&map, &to, method, &start) else {
                    seen[0] += 1;
                    continue;
                };
                // the gradient method may just be slow
                if stall == Stall::Iterations && method == Method::Gradient {
                    continue;
                }
                seen[1] += 1;
                let jacobian = map.jacobian(&at).unwrap();
                let excess = goal_excess(&map, &to, &at);
                let singular = jacobian.determinant().abs() < 1e-3 * jacobian.norm_squared();
                let on_boundary = at.iter().zip(&map.bounds).any(|(x, [a, b])| {
                    let margin = 1e-6 * (b - a);
                    *x <= a + margin || *x >= b - margin
                });
                assert!(singular || on_boundary, "{at:?} {stall:?} {excess}");
            }
        }
    }
    assert!(seen[0] > 40 && seen[1] > 10, "{seen:?}");
}

fn goal_excess(map: &Example, goal: &Goal, at: &[f64]) -> f64 {
    goal.excess(&map.at(at).unwrap()).norm()
}

/// The overall solver: a chain of two, a group of three with a tail, and one in closed form.
#[test]
fn a_sequence_of_groups_is_solved_by_what_each_allows() {
    struct Whole(Vec<[f64; 2]>);
    impl Targets for Whole {
        fn bounds(&self) -> &[[f64; 2]] {
            &self.0
        }

        fn at(&self, p: &[f64]) -> Result<Vec<f64>> {
            let mut values = (steep_chain().values)(&p[..2]);
            values.extend((three_with_tail().values)(&p[2..5]).iter().map(|v| v + p[0] * p[1]));
            values.push(p[5] * p[5] + p[2]);
            Ok(values)
        }
    }
    let bounds = [steep_chain().bounds, three().bounds, vec![[0.0, 4.0]]].concat();
    let whole = Whole(bounds);
    let direct = |goal: &[f64], known: &[f64]| Ok(vec![(goal[0] - known[2]).sqrt()]);
    let groups = [
        Group::single(),
        Group::single(),
        Group {
            size: 3,
            way: Way::Nested { nesting: Nesting::plain(3), tail: Some(Tail { sign: 1.0 }), descends: true },
        },
        Group { size: 1, way: Way::Direct(&direct) },
    ];
    let mut random = SplitMix64::new(8);
    for _ in 0..20 {
        let mut draw = |part: f64| {
            whole.0.iter().map(|[a, b]| a + part * (b - a) * random.uniform()).collect::<Vec<_>>()
        };
        let mut p = draw(1.0);
        p[0] *= 0.3; // where its target still changes
        let goal = Goal { tolerance: 1e-11, ..Goal::new(&whole.at(&p).unwrap()) };
        let start = draw(1.0);
        for first_all_at_once in [true, false] {
            let found = sequence(&whole, &goal, &groups, &start, first_all_at_once);
            assert_found(found.and_then(Sequence::solved), &p, 1e-7);
        }
    }
    // the third group's targets out of reach: its parameters are named by their places in the whole
    let p = [0.5, 0.5, 0.0, 0.0, 0.0, 1.0];
    let mut values = whole.at(&p).unwrap();
    values[2] += 10.0;
    let found = sequence(&whole, &Goal::new(&values), &groups, &p, false).unwrap();
    let [(2, Unsolved::OutOfReach { parameter: 2, side: Side::Above, residual, .. })] = found.unsolved[..]
    else {
        panic!("{found:?}")
    };
    // the other groups are solved with the nearest in its place
    assert!(residual > 0.0 && (found.residuals[2] - residual).abs() < 1e-9);
    assert!(found.residuals[0] < 1e-9 && found.residuals[3] < 1e-9, "{found:?}");
    assert_near(&found.parameters[..2], &p[..2], 1e-7);
}

/// What a closed form gives counts if it is within the bounds and meets the targets, and not before.
#[test]
fn a_closed_form_is_tested_like_any_other_answer() {
    let square =
        Example { bounds: vec![[0.5, 4.0]], values: |p| vec![p[0] * p[0]], slopes: |p| vec![2.0 * p[0]] };
    let with = |goal: f64, direct: &Direct<'_>| {
        let groups = [Group { size: 1, way: Way::Direct(direct) }];
        sequence(&square, &Goal::new(&[goal]), &groups, &[1.0], false).unwrap()
    };
    let root = |goal: &[f64], _: &[f64]| Ok(vec![goal[0].sqrt()]);
    let found = with(9.0, &root);
    assert!(found.unsolved.is_empty() && found.parameters == [3.0], "{found:?}");
    // beyond the bounds: the nearest within them goes on, and is said
    let found = with(25.0, &root);
    let [(0, Unsolved::OutOfReach { parameter: 0, side: Side::Above, residual, .. })] = found.unsolved[..]
    else {
        panic!("{found:?}")
    };
    assert!(found.parameters == [4.0] && (residual - 9.0 / 25.0).abs() < 1e-12, "{found:?}");
    assert_eq!(found.residuals, [residual]);
    // a form that is not quite right is corrected by what the targets say
    let found = with(9.0, &|goal, _| Ok(vec![1.001 * goal[0].sqrt()]));
    assert!(found.unsolved.is_empty(), "{found:?}");
    assert_near(&found.parameters, &[3.0], 1e-8);
    // within the bounds, and nothing meets the target
    let found = with(-1.0, &|_, _| Ok(vec![2.0]));
    let [(0, why @ Unsolved::Contradicted { residual, .. })] = &found.unsolved[..] else {
        panic!("{found:?}")
    };
    assert!(found.parameters == [0.5] && (residual - 1.25).abs() < 1e-12, "{found:?}");
    assert!(
        why.to_string().contains("the closed form gives [2.0], which does not meet the targets"),
        "{why}"
    );
    // no number, or not as many as parameters
    for given in [vec![f64::NAN], vec![2.0, 3.0], Vec::new()] {
        let found = with(9.0, &|_, _| Ok(given.clone()));
        let [(0, Unsolved::Failed(why))] = &found.unsolved[..] else { panic!("{found:?}") };
        assert!(why.to_string().contains("for 1 parameters"), "{why}");
        assert_eq!(found.parameters, [1.0]);
    }
}

/// Intervals of a linear map in closed form; where a target hardly reacts, there is none.
#[test]
fn what_the_targets_are_known_to_becomes_intervals_or_is_told_to_say_nothing() {
    let linear = Example {
        bounds: vec![[-10.0, 10.0]; 2],
        values: |p| vec![2.0 * p[0], p[0] + 4.0 * p[1]],
        slopes: |_| vec![2.0, 0.0, 1.0, 4.0],
    };
    let at =
        |parameters: [f64; 2]| Solution { parameters: parameters.to_vec(), residual: 0.0, evaluations: 0 };
    // the second is (z2 - z1 / 2) / 4
    let found = intervals(&linear, &at([1.0, 1.0]), &[0.6, 0.4]).unwrap();
    assert_near(&found, &[0.3, 0.3f64.hypot(0.4) / 4.0], 1e-12);
    // the first target of the steep chain changes by 3e-5 per unit there
    let steep = steep_chain();
    match intervals(&steep, &at([5.5, 0.5]), &[1e-3, 1e-3]) {
        Err(Unsolved::IllConditioned { parameter: 0, interval, .. }) => {
            assert!(interval > 10.0, "{interval}")
        }
        other => panic!("{other:?}"),
    }
    assert!(intervals(&steep, &at([1.0, 0.5]), &[1e-3, 1e-3]).is_ok());
    // both targets say the same there (section B.6)
    match intervals(&twofold(), &at([1.0, 0.5]), &[1e-9, 1e-9]) {
        Err(Unsolved::IllConditioned { interval, .. }) => assert_eq!(interval, f64::INFINITY),
        other => panic!("{other:?}"),
    }
}
