//! What the tests of a plan say of the examples.

use crate::examples::*;
use latsch::Result;
use latsch::identify::check::{
    Dependence, Injectivity, Response, Sampled, Sampling, depends, influence, injective, next_group, responds,
};
use latsch::identify::solve::{Nesting, Tail, Targets, nested};
use latsch::stats::SplitMix64;

fn sampled(targets: &dyn Targets) -> Sampled<'_> {
    Sampled::new(targets, Sampling::default()).unwrap()
}

fn all(map: &Example) -> Vec<usize> {
    (0..map.bounds.len()).collect()
}

fn verdict(map: &Example) -> Injectivity {
    injective(&sampled(map), &all(map), &all(map)).unwrap()
}

#[track_caller]
fn margins(map: &Example) -> Vec<f64> {
    match verdict(map) {
        Injectivity::Passed { orthants, .. } => orthants.iter().map(|o| o.margin).collect(),
        other => panic!("{other:?}"),
    }
}

/// (3.43) is sufficient: it holds of the maps of which it is known to, and fails of three that are injective all the same.
#[test]
fn the_half_space_criterion_passes_what_it_can() {
    for map in [chain(), steep_chain(), split(), three_stall(), three_with_tail(), three()] {
        assert!(margins(&map).iter().all(|m| *m > 0.0));
    }
    for map in [stalls(), spiral(), gradient_only()] {
        let Injectivity::Open { orthants, .. } = verdict(&map) else { panic!("{:?}", verdict(&map)) };
        assert!(orthants.iter().any(|o| o.margin <= 0.0));
    }
}

/// In a map of constant derivatives the margin has a closed form: one of the identity in two dimensions is 1 with the
/// normal (1, 1), as large as the box of normals allows.
#[test]
fn margins_of_a_linear_map() {
    let identity = Example {
        bounds: vec![[-1.0, 1.0]; 2],
        values: |p| p.to_vec(),
        slopes: |_| vec![1.0, 0.0, 0.0, 1.0],
    };
    assert_near(&margins(&identity), &[1.0, 1.0], 1e-9);
    // both columns at 45 degrees: normal (1, 0) or (0, 1) for the other orthant, and its neighbours
    let turned = Example {
        values: |p| vec![p[0] + p[1], p[0] - p[1]],
        slopes: |_| vec![1.0, 1.0, 1.0, -1.0],
        ..identity
    };
    assert_near(&margins(&turned), &[0.5f64.sqrt(); 2], 1e-9);
}

#[test]
fn what_is_not_unique_is_refuted_by_two_points() {
    let map = twofold();
    let Injectivity::Refuted { points: [a, b] } = verdict(&map) else { panic!() };
    assert_near(&map.at(&a).unwrap(), &map.at(&b).unwrap(), 1e-7);
    assert!((a[1] + b[1] - 1.0).abs() < 1e-5, "{a:?} {b:?}");
}

/// Three targets of four parameters, of which each may know those before it.
struct Plan;

impl Targets for Plan {
    fn bounds(&self) -> &[[f64; 2]] {
        &[[-1.0, 1.0]; 4]
    }

    fn at(&self, p: &[f64]) -> Result<Vec<f64>> {
        Ok(vec![
            p[0].powi(3) + p[0],
            p[1] + 0.3 * p[2].sin() + p[0],
            2.0 * p[2] + 0.3 * p[1].sin(),
            p[3].exp() + p[1] * p[2] - p[0],
        ])
    }
}

#[test]
fn the_next_group_is_found_from_what_is_known() {
    let sampled = sampled(&Plan);
    let group = |rows: &[usize], known: &[usize]| next_group(&sampled, rows, known).unwrap();
    assert_eq!(group(&[0], &[]), Some(vec![0]));
    assert_eq!(group(&[1, 2], &[]), None);
    assert_eq!(group(&[1, 2], &[0]), Some(vec![1, 2]));
    assert_eq!(group(&[3], &[0]), None);
    assert_eq!(group(&[3], &[0, 1, 2]), Some(vec![3]));
    assert_eq!(group(&[0], &[0]), None);
    let influence = influence(&sampled);
    let pattern = [[1, 0, 0, 0], [1, 1, 1, 0], [0, 1, 1, 0], [1, 1, 1, 1]];
    for (i, row) in pattern.iter().enumerate() {
        for (k, depends) in row.iter().enumerate() {
            assert_eq!(influence[(i, k)] > 0.0, *depends == 1, "{i} {k}");
        }
    }
    // one alone, over its range of 2 in 4 + 0.6 sin(1)
    assert!(influence[(1, 1)] > 0.3 && influence[(1, 1)] <= 2.0 / 4.0, "{}", influence[(1, 1)]);
    let dependence = depends(&sampled, &[1, 2], &[0, 3]).dependence.unwrap();
    let [a, b] = dependence.points.map(|p| Plan.at(&p).unwrap()[dependence.target]);
    assert!(dependence.target == 1 && a != b);
    let none = depends(&sampled, &[1, 2], &[3]);
    assert!(none.dependence.is_none() && none.compared == 100, "{none:?}");
}

/// A target that reacts in one part in a hundred only: few draws miss it, many do not.
#[test]
fn a_narrow_dependence_needs_many_draws() {
    let narrow = Example {
        bounds: vec![[-1.0, 1.0]; 2],
        values: |p| vec![p[0] + (1e-4 - (p[1] - 0.3).powi(2)).max(0.0).powi(2) * 1e7],
        slopes: |_| Vec::new(),
    };
    let found = |draws| -> Option<Dependence> {
        let sampling = Sampling { draws, ..Sampling::default() };
        depends(&Sampled::new(&narrow, sampling).unwrap(), &[0], &[1]).dependence
    };
    assert_eq!(found(2), None);
    let found = found(2000).unwrap();
    assert!(found.points.iter().any(|p| (p[1] - 0.3).abs() < 0.01));
}

/// Orders and signs: what the source says of its examples.
#[test]
fn orders_and_signs_of_the_examples() {
    let of = |map: &Example| responds(&sampled(map), &all(map), &all(map)).unwrap();
    // these two cannot be nested as they are printed (text at 3.35, B.8)
    for map in [stalls(), split()] {
        let Response { nesting, tail } = of(&map).unwrap();
        assert!(nesting.parameters != [0, 1] || nesting.targets != [0, 1], "{nesting:?}");
        assert_eq!(tail, None);
    }
    // what a check finds, a search can use
    let mut random = SplitMix64::new(4);
    for map in [stalls(), split(), three(), three_with_tail(), gradient_only()] {
        let Response { nesting, tail } = of(&map).unwrap();
        for _ in 0..10 {
            let p: Vec<f64> = map.bounds.iter().map(|[a, b]| a + (b - a) * random.uniform()).collect();
            assert_found(nested(&map, &goal(&map, &p), &nesting, tail.as_ref()), &p, 1e-6);
        }
    }
    assert_eq!(of(&three()).unwrap(), Response { nesting: Nesting::plain(3), tail: None });
    assert_eq!(of(&three_with_tail()).unwrap().tail, Some(Tail { sign: 1.0 }));
    // no order of it has signs
    assert_eq!(of(&spiral()), None);
    assert_eq!(of(&twofold()), None);
}

/// Where targets cannot be computed, nothing is tested, and no pass is told.
#[test]
fn what_cannot_be_computed_is_no_pass() {
    struct Half([[f64; 2]; 1], f64);

    impl Targets for Half {
        fn bounds(&self) -> &[[f64; 2]] {
            &self.0
        }

        fn at(&self, p: &[f64]) -> Result<Vec<f64>> {
            if p[0] < self.1 { Ok(vec![p[0]]) } else { Err(latsch::Error::numeric("not there")) }
        }
    }

    let nowhere = Sampled::new(&Half([[0.0, 1.0]], -1.0), Sampling::default());
    assert!(nowhere.is_err_and(|e| e.to_string().contains("anywhere in the box: not there")));
    // a quarter of the box: half of the draws that are corners, too
    let half = Half([[0.0, 1.0]], 0.25);
    let sampled = sampled(&half);
    assert!(sampled.computed[0] == 100 && (20..45).contains(&sampled.computed[1]), "{:?}", sampled.computed);
    let search = depends(&sampled, &[0], &[0]);
    assert!(search.dependence.is_some() && search.compared < 60, "{search:?}");
}
