//! Roads against their definitions, quadrature of the window's, closed forms, limits, conservation and statistics.
#![cfg(feature = "host")]
#![allow(missing_docs, clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod friction;
mod mean;
mod raw;
mod saved;
mod tracks;

use latsch::road::{Point, Road, RoadParameters, Surface, Window};
use proptest::prelude::*;
use std::f64::consts::{PI, TAU};

const L: f64 = 0.08;

/// A road of a kind that begins at 5 m.
fn parameters(kind: i32) -> RoadParameters {
    RoadParameters { kind, ..RoadParameters::flat() }
}

fn road(p: &RoadParameters) -> Road {
    let road = Road::new(p).unwrap();
    road.check().unwrap();
    road
}

/// A road and its window of length L.
fn with_window(p: &RoadParameters) -> (Road, Window) {
    let road = road(p);
    let window = road.window(L).unwrap();
    window.check(&road).unwrap();
    assert_eq!(window.length(), L);
    (road, window)
}

/// Mean over the window of length L at x, y.
fn mean_of(p: &RoadParameters) -> impl Fn(f64, f64) -> Surface + use<> {
    let (road, window) = with_window(p);
    move |x, y| road.mean(&window, x, y)
}

/// Compares slopes of the raw road with differences of its height, no edge being near.
#[track_caller]
fn compare_slope(road: &Road, x: f64, y: f64) {
    let step = 1e-7;
    let height = |x, y| road.at(x, y).height;
    let expected = [
        (height(x + step, y) - height(x - step, y)) / (2.0 * step),
        (height(x, y + step) - height(x, y - step)) / (2.0 * step),
    ];
    let slope = road.at(x, y).slope;
    for i in 0..2 {
        assert!((slope[i] - expected[i]).abs() < 2e-6, "slope {i} at {x} {y}: {slope:?} {expected:?}");
    }
}

/// Compares derivatives of the mean with differences.
#[track_caller]
fn compare_derivatives(mean: impl Fn(f64, f64) -> Surface, x: f64, y: f64) {
    let here = mean(x, y);
    let step = 1e-7;
    let difference = |f: &dyn Fn(Surface) -> f64, dx: f64, dy: f64| {
        (f(mean(x + dx, y + dy)) - f(mean(x - dx, y - dy))) / (2.0 * step)
    };
    let pairs = [
        (here.slope[0], difference(&|at| at.height, step, 0.0)),
        (here.slope[1], difference(&|at| at.height, 0.0, step)),
        (L * here.curvature[0], L * difference(&|at| at.slope[0], step, 0.0)),
        (L * here.curvature[1], L * difference(&|at| at.slope[0], 0.0, step)),
        (L * here.curvature[1], L * difference(&|at| at.slope[1], step, 0.0)),
        (L * here.curvature[2], L * difference(&|at| at.slope[1], 0.0, step)),
    ];
    for (j, (exact, difference)) in pairs.into_iter().enumerate() {
        assert!((exact - difference).abs() < 2e-6, "derivative {j} at {x} {y}: {exact} {difference}");
    }
}

/// Integral of K(u) z(s - u) du by Gauss-Legendre quadrature between the places where z is not smooth.
fn filtered(z: impl Fn(f64) -> f64, breaks: &[f64], s: f64) -> f64 {
    let mut edges: Vec<f64> = breaks.iter().copied().filter(|b| (b - s).abs() < L).collect();
    edges.extend([s - L, s + L]);
    edges.sort_by(f64::total_cmp);
    let nodes = [
        (0.0, 0.568_888_888_888_888_9),
        (0.538_469_310_105_683_1, 0.478_628_670_499_366_47),
        (0.906_179_845_938_664, 0.236_926_885_056_189_1),
    ];
    let mut sum = 0.0;
    for pair in edges.windows(2) {
        let width = (pair[1] - pair[0]) / 16.0;
        for i in 0..16 {
            let middle = pair[0] + (f64::from(i) + 0.5) * width;
            for (node, weight) in nodes {
                for side in if node == 0.0 { vec![0.0] } else { vec![-node, node] } {
                    let r = middle + 0.5 * side * width;
                    sum += 0.5 * width * weight * z(r) * (1.0 + (PI * (s - r) / L).cos()) / (2.0 * L);
                }
            }
        }
    }
    sum
}

/// Compares a road with its profile, the quadrature of that, and derivatives with differences.
#[track_caller]
fn compare(p: &RoadParameters, z: impl Fn(f64) -> f64, breaks: &[f64], places: std::ops::Range<f64>) {
    let (road, window) = with_window(p);
    let (sin, cos) = p.direction.sin_cos();
    for i in 0..400 {
        let s = places.start + (f64::from(i) + 0.37) / 400.0 * (places.end - places.start);
        // somewhere across the road
        let (x, y) = (s * cos - 0.7 * sin, s * sin + 0.7 * cos);
        assert!((road.at(x, y).height - z(s)).abs() < 1e-11, "profile at {s}");
        if breaks.iter().all(|edge| (edge - s).abs() > 1e-6) {
            compare_slope(&road, x, y);
        }
        let height = road.mean(&window, x, y).height;
        let expected = filtered(&z, breaks, s);
        assert!((height - expected).abs() < 1e-11, "kind {} at {s}: {height} {expected}", p.kind);
        compare_derivatives(|x, y| road.mean(&window, x, y), x, y);
    }
}

/// Height of a polyline at s, by its definition.
fn polyline(points: &[(f64, f64)], s: f64) -> f64 {
    let behind = points.partition_point(|p| p.0 <= s);
    match (behind.checked_sub(1).map(|i| points[i]), points.get(behind)) {
        (Some(a), Some(b)) => a.1 + (b.1 - a.1) * (s - a.0) / (b.0 - a.0),
        (Some(end), None) => end.1,
        (None, first) => first.map_or(0.0, |p| p.1),
    }
}
