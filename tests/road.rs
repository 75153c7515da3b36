//! Roads against their definitions, quadrature of the window's, closed forms, limits, conservation and statistics.
#![cfg(feature = "host")]
#![allow(missing_docs, clippy::unwrap_used, clippy::expect_used, clippy::panic)]

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

#[test]
fn steps_and_ramps_are_the_filters_integral() {
    let p = RoadParameters { height: -0.03, direction: 0.4, ..parameters(2) };
    compare(&p, |s| if s < 5.0 { 0.0 } else { -0.03 }, &[5.0], 4.9..5.1);
    // shorter and longer than the filter
    for length in [0.05, 0.3] {
        let p = RoadParameters { height: 0.02, length, ..parameters(3) };
        let z = |s: f64| 0.02 * ((s - 5.0) / length).clamp(0.0, 1.0);
        compare(&p, z, &[5.0, 5.0 + length], 4.9..5.5);
    }
    let flat = mean_of(&parameters(1))(1.0, 2.0);
    assert_eq!(flat, Surface { height: 0.0, slope: [0.0; 2], curvature: [0.0; 3], friction: 1.0 });
    let flat = road(&parameters(1)).at(1.0, 2.0);
    assert_eq!(flat, Point { height: 0.0, slope: [0.0; 2], friction: 1.0 });
}

#[test]
fn repeated_cleats_and_slabs_are_the_filters_integral() {
    // height and bevel; a cleat may be a groove, and its bevels may meet
    for (height, bevel) in [(0.012, 0.004), (-0.02, 0.0), (0.012, 0.01), (0.01, 0.01)] {
        let p =
            RoadParameters { height, bevel, length: 0.02, spacing: 0.06, direction: -1.1, ..parameters(4) };
        let z = |s: f64| {
            let u = if s < 5.0 { 1.0 } else { (s - 5.0) % 0.06 };
            let depth = u.min(0.02 - u);
            if depth < 0.0 { 0.0 } else { height.signum() * (height.abs() - bevel + depth).min(height.abs()) }
        };
        let breaks: Vec<_> = (0..8)
            .flat_map(|n| [0.0, bevel, 0.02 - bevel, 0.02].map(|u| 5.0 + 0.06 * f64::from(n) + u))
            .collect();
        compare(&p, z, &breaks, 4.9..5.3);
    }
    let p = RoadParameters { height: 0.05, length: 0.5, ..parameters(7) };
    let z = |s: f64| if s < 5.0 { 0.0 } else { 0.1 * ((s - 5.0) % 0.5) };
    compare(&p, z, &[5.0, 5.5, 6.0, 6.5, 7.0], 4.9..6.8);
    let p = RoadParameters { spacing: 0.7, ..p };
    let z = |s: f64| if s < 5.0 || (s - 5.0) % 0.7 >= 0.5 { 0.0 } else { 0.1 * ((s - 5.0) % 0.7) };
    compare(&p, z, &[5.0, 5.5, 5.7, 6.2, 6.4, 6.9], 4.9..6.7);
}

#[test]
fn sines_are_the_filters_integral_from_their_beginning_on() {
    // 2 L and what is hardly another wavelength are where the closed form 0 / 0 would be
    for length in [0.5 * L, L, 1.5 * L, 2.0 * L, 2.0 * L * (1.0 + 1e-9), 2.001 * L, 1.3] {
        let p = RoadParameters { height: 0.01, length, ..parameters(5) };
        let z = |s: f64| 0.005 * (1.0 - (TAU * (s - 5.0).max(0.0) / length).cos());
        compare(&p, z, &[5.0], 4.9..5.4);
    }
}

#[test]
fn sines_have_the_gain_of_the_table() {
    for (ratio, gain, digits) in [
        (20.0, 0.994, 5e-4),
        (10.0, 0.974, 5e-4),
        (4.0, 0.849, 5e-4),
        (2.0, 0.5, 1e-12),
        (1.5, 0.266, 5e-4),
        (1.0, 0.0, 1e-12),
    ] {
        let p = RoadParameters { height: 2.0, length: ratio * L, ..parameters(5) };
        let peak = 5.0 + 3.5 * ratio * L;
        let height = mean_of(&p)(peak, 0.0).height;
        assert!((height - 1.0 - gain).abs() < digits, "{ratio}: {height}");
    }
    // the largest lobes below wavelength L
    let lobes = (1..1000).map(|i| {
        let a = TAU * (1.0 + 0.01 * f64::from(i));
        a.sin() / (a * (1.0 - (a / PI).powi(2)))
    });
    let (least, most) = lobes.fold((0.0_f64, 0.0_f64), |(least, most), g| (least.min(g), most.max(g)));
    assert!((least + 0.027).abs() < 5e-4 && (most - 0.008).abs() < 5e-4, "{least} {most}");
}

#[test]
fn a_filtered_step_is_as_steep_and_as_bent_as_documented() {
    let mean = mean_of(&RoadParameters { height: 0.02, ..parameters(2) });
    let places: Vec<_> = (0..=4000).map(|i| mean(5.0 + L * (f64::from(i) / 2000.0 - 1.0), 0.0)).collect();
    let most = |f: &dyn Fn(&Surface) -> f64| places.iter().map(f).fold(0.0, f64::max);
    assert!((most(&|at| at.slope[0]) - 0.02 / L).abs() < 1e-12);
    assert!((most(&|at| at.curvature[0].abs()) - PI * 0.02 / (2.0 * L * L)).abs() < 1e-10);
    assert_eq!(places[0].height, 0.0);
    assert!((places[4000].height - 0.02).abs() < 1e-16);
}

#[test]
fn a_filtered_cleat_keeps_its_area() {
    for length in [0.01, 0.1] {
        let p = RoadParameters { height: 0.015, length, bevel: 0.003, ..parameters(4) };
        let mean = mean_of(&p);
        let step = 1e-5;
        let area: f64 = (0..40_000).map(|i| step * mean(4.9 + step * f64::from(i), 0.0).height).sum();
        let expected = 0.015 * length - 0.003 * 0.003;
        assert!((area / expected - 1.0).abs() < 1e-8, "{area} {expected}");
    }
}

#[test]
fn irregular_roads_have_the_psd_of_the_standard_in_both_tracks() {
    const SAMPLES: usize = 1 << 15;
    let (roughness, step) = (256e-6, 0.04);
    let road = road(&RoadParameters { roughness, seed: 7, coherence_length: 2.0, ..parameters(6) });
    for y in [0.75, -0.75] {
        // Hann window, whose mean square is 3 / 8
        let heights: Vec<f64> = (0..SAMPLES)
            .map(|i| {
                let window = 0.5 * (1.0 - (TAU * i as f64 / SAMPLES as f64).cos());
                window * road.at(20.0 + step * i as f64, y).height
            })
            .collect();
        let span = step * SAMPLES as f64;
        let density = |bin: usize| {
            let turn = 2.0 * (TAU * bin as f64 / SAMPLES as f64).cos();
            let (last, before) = heights.iter().fold((0.0, 0.0), |(a, b), z| (z + turn * a - b, a));
            let square = last * last + before * before - turn * last * before;
            2.0 * square * step * step / (span * 0.375)
        };
        for octave in 3..9 {
            let from = 0.01 * f64::from(1 << octave);
            let bins = (from * span) as usize..(2.0 * from * span) as usize;
            let expected = roughness * 0.01 * (1.0 / (bins.start as f64) - 1.0 / bins.end as f64) * span;
            let variance: f64 = bins.map(|bin| density(bin) / span).sum();
            assert!((variance / expected - 1.0).abs() < 0.1, "{y}, from {from} / m: {variance} {expected}");
        }
    }
}

#[test]
fn irregular_roads_are_filtered_and_differ_by_their_seed() {
    let p = RoadParameters { seed: -3, direction: 2.0, ..parameters(6) };
    let road_ = road(&p);
    let (sin, cos) = p.direction.sin_cos();
    let raw = |road: &Road, s: f64| road.at(s * cos, s * sin).height;
    // behind the fade-in; the quadrature is the test's, the profile the road's
    compare(&p, |s| raw(&road_, s), &[], 16.0..19.0);
    compare(&p, |s| raw(&road_, s), &[], 9000.0..9001.0);
    let start = mean_of(&p)(5.0 * cos, 5.0 * sin);
    assert!(start.height.abs() < 1e-15 && start.slope.iter().all(|slope| slope.abs() < 1e-12));
    // over realisations, the variance at one place is that of the whole band
    let expected = 64e-6 * 0.01 * (1.0 / 0.01 - 1.0 / 10.24);
    let heights = (0..2000).map(|seed| raw(&Road::new(&RoadParameters { seed, ..p.clone() }).unwrap(), 50.0));
    let (mean, square) = heights.fold((0.0, 0.0), |(m, q), z| (m + z / 2000.0, q + z * z / 2000.0));
    // four standard deviations of a Gaussian's
    assert!((square / expected - 1.0).abs() < 4.0 * (2.0 / 2000.0_f64).sqrt(), "{square} {expected}");
    assert!(mean.abs() < 4.0 * (expected / 2000.0).sqrt(), "{mean}");
}

#[test]
fn friction_is_the_mean_over_the_contact() {
    let p = RoadParameters { friction: "2 0.5; 2.03 0.8;\n 10 1.2;".into(), ..parameters(1) };
    let mean = mean_of(&p);
    let mu = |s: f64| mean(s, 3.0).friction;
    assert_eq!([mu(-4.0), mu(1.96), mu(3.0), mu(9.9), mu(11.0)], [1.0, 1.0, 0.8, 0.8, 1.2]);
    for (s, expected) in [
        (1.98, (0.06 * 1.0 + 0.02 * 0.5) / 0.08),
        (2.01, (0.03 * 1.0 + 0.03 * 0.5 + 0.02 * 0.8) / 0.08),
        (10.0, 1.0),
    ] {
        assert!((mu(s) - expected).abs() < 1e-12, "{s}: {}", mu(s));
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

proptest! {
    #![proptest_config(ProptestConfig { cases: 64, failure_persistence: None, ..ProptestConfig::default() })]
    #[test]
    fn any_profile_is_the_filters_integral(
        pieces in prop::collection::vec((0.0..0.2f64, -0.05..0.05f64, any::<bool>()), 1..20),
        first in -1.0..1.0f64,
        gap in 0.0..0.1f64,
    ) {
        let mut points = vec![(5.0 + first, 0.02)];
        for (width, z, edge) in pieces {
            let last = points[points.len() - 1].0;
            let twice = points.len() > 1 && points[points.len() - 2].0 == last;
            points.push((if edge && !twice { last } else { last + 1e-3 + width }, z));
        }
        let last = points[points.len() - 1].0 + 0.01;
        points.push((last, 0.02));
        let text: Vec<_> = points.iter().map(|(s, z)| format!("{:?} {z:?}", s - 5.0)).collect();
        // as the road reads them
        for point in &mut points {
            point.0 = 5.0 + (point.0 - 5.0);
        }
        let extent = last - points[0].0;
        let once = RoadParameters { profile: text.join("; "), ..parameters(8) };
        let again = RoadParameters { spacing: extent + gap + 1e-9, ..once.clone() };
        let (start, least, most) = points.iter().fold((points[0].0, 0.0f64, 0.0f64), |(s, a, b), p| (s, a.min(p.1), b.max(p.1)));
        for p in [once, again] {
            let (road, window) = with_window(&p);
            let copies = if p.spacing > 0.0 { 40 } else { 1 };
            let breaks: Vec<_> = (0..copies)
                .flat_map(|n| points.iter().map(move |q| (q.0, n)))
                .map(|(s, n)| s + f64::from(n) * p.spacing)
                .collect();
            let z = |s: f64| {
                let n = if p.spacing > 0.0 { ((s - start) / p.spacing).floor().max(0.0) } else { 0.0 };
                polyline(&points, s - n * p.spacing)
            };
            for i in 0..100 {
                let s = start - 0.1 + f64::from(i) / 100.0 * (2.0 * extent + 0.3);
                let height = road.mean(&window, s, 0.0).height;
                prop_assert!(breaks.iter().any(|edge| (edge - s).abs() < 1e-9) || (road.at(s, 0.0).height - z(s)).abs() < 1e-9);
                prop_assert!((height - filtered(z, &breaks, s)).abs() < 1e-9, "{s}: {height}");
                prop_assert!(height > least - 1e-12 && height < most + 1e-12);
            }
        }
    }
}

#[test]
fn what_is_wrong_is_named() {
    let refuse = |p: RoadParameters, words: &[&str]| {
        let message = Road::new(&p).unwrap_err().to_string();
        for word in words {
            assert!(message.contains(word), "{word:?} is not in {message:?}");
        }
    };
    let profile = |text: &str| RoadParameters { profile: text.into(), ..parameters(8) };
    refuse(profile(" "), &["road_profile", "needs points"]);
    refuse(profile("0 0; 1 0,5; 2 0"), &["road_profile", "pair 2", "\"1 0,5\"", "\"0,5\" is not a number"]);
    refuse(profile("0 0; 1; 2 0"), &["pair 2", "two numbers"]);
    refuse(profile("0 0; 1 2 3"), &["pair 2", "two numbers"]);
    refuse(profile("0 0;; 1 2"), &["pair 2", "two numbers"]);
    refuse(profile("0 NaN"), &["pair 1", "finite"]);
    refuse(profile("0 0; 1 0; 0.5 0"), &["pair 3", "0.5 m comes after 1 m"]);
    refuse(profile("0 0; 0 1; 0 2"), &["pair 3", "third"]);
    refuse(profile("0 0; 1e-7 1"), &["pair 2", "same x"]);
    refuse(profile(&"0 0;".repeat(20_001)), &["20001 points"]);
    let friction = |text: &str| RoadParameters { friction: text.into(), ..parameters(1) };
    refuse(friction("0 1; 5 -0.1"), &["road_friction", "pair 2", "negative"]);
    refuse(friction("0 1; 0 0.1"), &["pair 2", "increase"]);
    refuse(parameters(0), &["road_kind = 0", "1 flat", "8 profile"]);
    for length in [-0.1, 1e-4, f64::NAN, f64::INFINITY] {
        let message = road(&parameters(1)).window(length).unwrap_err().to_string();
        assert!(message.contains("road_filter_length") && message.contains("0.001"), "{message}");
    }
    refuse(RoadParameters { height: f64::NAN, ..parameters(2) }, &["road_height = NaN"]);
    refuse(RoadParameters { length: 0.0, ..parameters(5) }, &["road_length = 0 m"]);
    refuse(RoadParameters { roughness: -1.0, ..parameters(6) }, &["road_roughness"]);
    refuse(RoadParameters { bevel: 0.02, ..parameters(4) }, &["road_bevel = 0.02 m", "0.01 m"]);
    refuse(RoadParameters { bevel: 0.01, length: 0.015, ..parameters(4) }, &["do not fit", "0.015 m"]);
    refuse(RoadParameters { spacing: 0.05, ..parameters(4) }, &["road_spacing = 0.05 m", "0.1 m"]);
    refuse(RoadParameters { spacing: 1.0, ..parameters(3) }, &["road_spacing", "0.01 m above", "to 0"]);
    refuse(RoadParameters { spacing: -1.0, ..profile("0 1") }, &["road_spacing = -1 m", "at least"]);
    // what is seldom met by a point is met often by a window
    let close = RoadParameters { length: 1e-3, spacing: 1e-3, ..parameters(4) };
    let varied =
        RoadParameters { friction_deviation: 0.1, friction_correlation_length: 1e-3, ..parameters(1) };
    for (p, name) in [(close, "road_spacing"), (varied, "road_friction_correlation_length")] {
        let road = road(&p);
        assert!(road.window(0.1).is_ok() && road.window(0.0).is_ok());
        let message = road.window(0.11).unwrap_err().to_string();
        for word in ["road_filter_length = 0.11 m", "100 times", "0.001 m", name] {
            assert!(message.contains(word), "{word:?} is not in {message:?}");
        }
    }
    let right = |text: &str| RoadParameters { profile_right: text.into(), ..profile("0 0; 1 0") };
    refuse(right("0 0; 1 0,5; 2 0"), &["road_profile_right", "pair 2", "\"0,5\" is not a number"]);
    refuse(right(";"), &["road_profile_right", "needs points"]);
    refuse(RoadParameters { spacing: 1.0, ..right("0 0; 1 0.5") }, &["road_spacing = 1 m", "0.5 m above"]);
    refuse(RoadParameters { tracks: 2, ..right("0 0; 1 0.5") }, &["road_profile_right", "road_tracks = 2"]);
    let friction_right = |text: &str| RoadParameters { friction_right: text.into(), ..parameters(1) };
    refuse(friction_right("0 1; 5 -0.1"), &["road_friction_right", "pair 2", "negative"]);
    refuse(RoadParameters { tracks: 4, ..parameters(1) }, &["road_tracks = 4", "1 both", "3 right"]);
    refuse(RoadParameters { track_width: 0.0, ..parameters(1) }, &["road_track_width = 0 m", "0.001"]);
    refuse(RoadParameters { track_width: f64::INFINITY, ..parameters(1) }, &["road_track_width", "finite"]);
    let coherence = |coherence_length| RoadParameters { coherence_length, ..parameters(6) };
    refuse(coherence(-1.0), &["road_coherence_length = -1 m", "negative"]);
    refuse(
        RoadParameters { tracks: 3, ..coherence(1.0) },
        &["road_coherence_length = 1 m", "road_tracks = 3"],
    );
    let deviation = |friction_deviation| RoadParameters { friction_deviation, ..parameters(1) };
    refuse(deviation(0.48), &["road_friction_deviation = 0.48", "0.47"]);
    refuse(deviation(-0.1), &["road_friction_deviation = -0.1", "from 0"]);
    refuse(
        RoadParameters { friction_correlation_length: 0.0, ..deviation(0.1) },
        &["road_friction_correlation_length = 0 m", "0.001"],
    );
}

#[test]
fn saved_roads_are_the_same_and_damage_is_found() {
    let two = |p: RoadParameters| RoadParameters {
        profile_right: "0 0; 1 2; 2 1".into(),
        friction_right: "2 0.1; 3 0.2".into(),
        coherence_length: 3.0,
        friction_deviation: 0.2,
        ..p
    };
    for kind in 1..=8 {
        let p =
            RoadParameters { profile: "0 0; 0 1; 2 1".into(), friction: "1 0.5".into(), ..parameters(kind) };
        for p in [two(p.clone()), RoadParameters { tracks: 3, ..p.clone() }, p] {
            let (road, window) = with_window(&p);
            let bytes = postcard::to_stdvec(&(&road, &window)).unwrap();
            let (same_road, same_window) = postcard::from_bytes::<(Road, Window)>(&bytes).unwrap();
            assert_eq!((&same_road, &same_window), (&road, &window));
            let (mut copy, mut copied_window) = (road.clone(), window.clone());
            let counts = allocation_counter::measure(|| {
                copy.clone_from(&road);
                copied_window.clone_from(&window);
                std::hint::black_box((copy.at(5.0, 0.1), copy.mean(&copied_window, 5.0, 0.1)));
            });
            assert_eq!(counts.count_total, 0);
            assert_eq!((&copy, &copied_window), (&road, &window));
        }
    }
    let p = RoadParameters { friction: "1 0.5".into(), spacing: 0.2, ..parameters(4) };
    let p = RoadParameters { tracks: 2, friction_right: "1 0.5".into(), friction_deviation: 0.1, ..p };
    let (road_, window) = with_window(&p);
    let value = serde_json::to_value(&road_).unwrap();
    for (path, number) in [
        ("/along/0", 2.0),
        ("/half_width", 0.0),
        ("/left/polyline/kinks/1/at", -1.0),
        ("/left/polyline/period", 0.01),
        ("/friction/left/steps/0/factor", -0.5),
        ("/friction/right/steps/0/factor", -0.5),
        ("/friction/variation/amplitude", 1.5),
        ("/friction/variation/spacing", 0.0),
        ("/friction/variation/offset", 1.0),
    ] {
        let mut value = value.clone();
        *value.pointer_mut(path).unwrap() = number.into();
        let damaged: Road = serde_json::from_value(value).unwrap();
        assert!(damaged.check().is_err(), "{path}");
    }
    let value = serde_json::to_value(&window).unwrap();
    for (path, number) in
        [("/length", 0.0), ("/length", 21.0), ("/left/phases/1/0", 2.0), ("/left/wave", 2.0)]
    {
        let mut value = value.clone();
        *value.pointer_mut(path).unwrap() = number.into();
        let damaged: Window = serde_json::from_value(value).unwrap();
        assert!(damaged.check(&road_).is_err(), "{path}");
    }
    for path in ["/left/phases", "/left/lines", "/right/phases", "/right/lines"] {
        let irregular = RoadParameters { coherence_length: 1.0, ..parameters(6) };
        let profiles = RoadParameters {
            profile: "0 0; 1 2; 2 1".into(),
            profile_right: "0 1; 1 0".into(),
            ..parameters(8)
        };
        let (road, window) = with_window(if path.contains("lines") { &irregular } else { &profiles });
        let mut value = serde_json::to_value(&window).unwrap();
        value.pointer_mut(path).unwrap().as_array_mut().unwrap().pop();
        assert!(serde_json::from_value::<Window>(value).unwrap().check(&road).is_err(), "{path}");
    }
    let mut value = serde_json::to_value(road(&parameters(6))).unwrap();
    value.pointer_mut("/left/irregular/octaves").unwrap().as_array_mut().unwrap().pop();
    assert!(serde_json::from_value::<Road>(value).unwrap().check().is_err());
}

#[test]
fn a_window_of_another_road_is_found_and_is_no_panic() {
    let roads = [
        RoadParameters { spacing: 0.2, ..parameters(4) },
        RoadParameters { profile: "0 0; 1 1".into(), profile_right: "0 0; 1 1; 2 0".into(), ..parameters(8) },
        RoadParameters { coherence_length: 1.0, ..parameters(6) },
        parameters(1),
    ];
    for (i, one) in roads.iter().enumerate() {
        let (road, _) = with_window(one);
        Window::point().check(&road).unwrap();
        for (j, other) in roads.iter().enumerate() {
            let (_, window) = with_window(other);
            assert_eq!(window.check(&road).is_ok(), i == j, "{i} {j}");
            for place in [-1e300, 4.95, 5.0, 5.01, 6.0, 20.0, 1e300, f64::INFINITY, f64::NAN] {
                std::hint::black_box((road.mean(&window, place, 0.3), road.at(place, place)));
            }
        }
    }
}

#[test]
fn slabs_rise_drop_and_are_repeated() {
    // a slope of 0.1 from 5 m on
    let p = RoadParameters { height: 0.05, length: 0.5, ..parameters(7) };
    let at = |road: &Road, x| {
        let Point { height, slope: [slope, _], .. } = road.at(x, 0.0);
        [height, slope]
    };
    let close = |a: [f64; 2], b: [f64; 2]| {
        assert!((a[0] - b[0]).abs() < 1e-12 && (a[1] - b[1]).abs() < 1e-12, "{a:?} {b:?}");
    };
    let joined = road(&p);
    let gaps = road(&RoadParameters { spacing: 0.75, ..p });
    for road in [&joined, &gaps] {
        close(at(road, 4.999), [0.0, 0.0]);
        // the beginning is the slab's
        close(at(road, 5.0), [0.0, 0.1]);
        close(at(road, 5.25), [0.025, 0.1]);
        close(at(road, 5.5 - 1e-9), [0.05 - 1e-10, 0.1]);
    }
    // the drop, behind which there is the next slab or the gap
    close(at(&joined, 5.5), [0.0, 0.1]);
    close(at(&gaps, 5.5), [0.0, 0.0]);
    close(at(&gaps, 5.74), [0.0, 0.0]);
    close(at(&gaps, 5.75), [0.0, 0.1]);
    for n in 0..20_000 {
        let n = f64::from(n);
        // halves and quarters are exact
        close(at(&joined, 5.0 + 0.5 * n), [0.0, 0.1]);
        close(at(&joined, 5.0 + 0.5 * n + 0.375), [0.0375, 0.1]);
        close(at(&gaps, 5.0 + 0.75 * n + 0.25), [0.025, 0.1]);
        close(at(&gaps, 5.0 + 0.75 * n + 0.625), [0.0, 0.0]);
    }
    // where rounding decides what is behind an edge, it is one of its sides and no third
    let thirds = road(&RoadParameters { start: 0.0, height: 0.03, length: 0.3, ..parameters(7) });
    for n in 1..100_000 {
        let edge = 0.3 * f64::from(n);
        for s in [edge.next_down(), edge, edge.next_up()] {
            let [height, slope] = at(&thirds, s);
            assert!(height.abs() < 1e-9 || (height - 0.03).abs() < 1e-9, "{n}: {height}");
            assert!((slope - 0.1).abs() < 1e-9, "{n}: {slope}");
        }
    }
}

#[test]
fn a_short_window_is_the_road_as_it_is() {
    let profile = "0 0; 0.1 0.03; 0.1 0.01; 0.4 0.02";
    for kind in 1..=8 {
        let p = RoadParameters { profile: profile.into(), direction: 0.3, ..parameters(kind) };
        let p = RoadParameters { friction: "5.03 0.7; 5.31 0.9".into(), friction_deviation: 0.2, ..p };
        // behind the fade-in, which is of the mean and not within it
        let p = if kind == 6 {
            RoadParameters { coherence_length: 2.0, start: -20.0, ..p }
        } else {
            RoadParameters { tracks: 2, ..p }
        };
        let road = road(&p);
        let windows = [4e-3, 2e-3].map(|length| road.window(length).unwrap());
        for i in 0..500 {
            // no edge within the windows; across, between the tracks and beyond
            let (s, t) = (5.0046 + 0.01 * f64::from(i), f64::from(i % 40) * 0.05 - 1.0);
            let (sin, cos) = p.direction.sin_cos();
            let (x, y) = (s * cos - t * sin, s * sin + t * cos);
            let raw = road.at(x, y);
            let point = road.mean(&Window::point(), x, y);
            assert_eq!(Point { height: point.height, slope: point.slope, friction: point.friction }, raw);
            // half the curvature along s times the window's second moment, L² (1/3 - 2 / pi²)
            let along = point.curvature[0] * cos * cos
                + 2.0 * point.curvature[1] * cos * sin
                + point.curvature[2] * sin * sin;
            let [four, two] = [&windows[0], &windows[1]].map(|window| {
                let mean = road.mean(window, x, y);
                assert!((mean.friction - raw.friction).abs() < 4e-3);
                let moment = window.length() * window.length() * (1.0 / 3.0 - 2.0 / (PI * PI));
                (mean.height - raw.height, 0.5 * along * moment)
            });
            // the next term is of the order L⁴
            for (difference, expected) in [four, two] {
                assert!(
                    (difference - expected).abs() < 0.02 * expected.abs() + 1e-9,
                    "{kind} {s}: {difference} {expected}"
                );
            }
        }
    }
}

#[test]
fn a_profile_of_many_points_is_found_fast_and_right() {
    // 20 000 points about 5 mm apart
    let z = |i: usize| 0.01 * ((i * 7919) % 1000) as f64 / 1000.0;
    let x = |i: usize| 0.005 * i as f64 + 0.001 * ((i * 31) % 3) as f64;
    let points: Vec<_> = (0..20_000).map(|i| (x(i), z(i))).collect();
    let text: Vec<_> = points.iter().map(|(x, z)| format!("{x:?} {z:?}")).collect();
    let p = RoadParameters { start: 0.0, profile: text.join("; "), ..parameters(8) };
    let road = road(&p);
    for i in 0..100_000 {
        let s = 100.1 * f64::from(i) / 100_000.0;
        let (height, expected) = (road.at(s, 0.0).height, polyline(&points, s));
        assert!((height - expected).abs() < 1e-12, "{s}: {height} {expected}");
    }
}

#[test]
fn heights_lie_on_straight_lines_between_the_tracks() {
    let p = RoadParameters { height: 0.02, length: 0.3, track_width: 1.6, ..parameters(3) };
    let [left, right] = [2, 3].map(|tracks| road(&RoadParameters { tracks, ..p.clone() }));
    for (x, z, slope) in [(4.0, 0.0, 0.0), (5.15, 0.01, 0.02 / 0.3), (7.0, 0.02, 0.0)] {
        for (y, share) in
            [(-5.0, 0.0), (-0.8, 0.0), (-0.4, 0.25), (0.0, 0.5), (0.4, 0.75), (0.8, 1.0), (3.0, 1.0)]
        {
            let across = if f64::abs(y) < 0.8 { z / 1.6 } else { 0.0 };
            for (at, side) in [(left.at(x, y), 1.0), (right.at(x, -y), -1.0)] {
                assert!((at.height - share * z).abs() < 1e-14, "{x} {y}: {at:?}");
                assert!((at.slope[0] - share * slope).abs() < 1e-12, "{x} {y}: {at:?}");
                assert!((at.slope[1] - side * across).abs() < 1e-12, "{x} {y}: {at:?}");
            }
        }
    }
    // the tracks turn with the direction: a road along y has its left track at negative x
    let turned = road(&RoadParameters { tracks: 2, direction: PI / 2.0, ..p });
    assert!((turned.at(-0.9, 7.0).height - 0.02).abs() < 1e-14);
    assert_eq!(turned.at(0.9, 7.0).height, 0.0);
}

/// Roads of two different tracks.
fn two_tracks() -> Vec<RoadParameters> {
    let profile = "0 0; 0.1 0.03; 0.1 0.01; 0.4 0";
    let profiles = RoadParameters {
        profile: profile.into(),
        profile_right: "-0.1 0; 0.2 -0.02; 0.3 0".into(),
        ..parameters(8)
    };
    vec![
        profiles.clone(),
        RoadParameters { spacing: 0.6, ..profiles },
        RoadParameters { tracks: 3, bevel: 0.005, spacing: 0.17, ..parameters(4) },
        RoadParameters { tracks: 2, length: 0.3, ..parameters(5) },
        RoadParameters { coherence_length: 1.5, start: -20.0, ..parameters(6) },
        RoadParameters { tracks: 2, coherence_length: 0.0, start: -20.0, ..parameters(6) },
    ]
}

#[test]
fn each_track_is_the_road_of_its_own() {
    for p in two_tracks() {
        let p = RoadParameters { direction: 0.7, ..p };
        let (road_, window) = with_window(&p);
        let (sin, cos) = p.direction.sin_cos();
        // beyond the tracks, and what a road with this track alone is
        let level = parameters(1);
        let same =
            RoadParameters { tracks: 1, profile_right: String::new(), coherence_length: 0.0, ..p.clone() };
        let alone = match (p.kind, p.tracks) {
            (8, _) => [same.clone(), RoadParameters { profile: p.profile_right.clone(), ..same }],
            (_, 3) => [level, same],
            (_, 2) => [same, level],
            _ => [same.clone(), same],
        };
        for (t, one) in [0.8, -0.8].into_iter().zip(alone) {
            let (alone, its_window) = with_window(&RoadParameters { direction: p.direction, ..one });
            for i in 0..200 {
                let s = 4.8 + 0.01 * f64::from(i);
                let (x, y) = (s * cos - t * sin, s * sin + t * cos);
                // the right track of an irregular road is another realisation
                let same = road_.at(x, y) == alone.at(x, y)
                    && road_.mean(&window, x, y) == alone.mean(&its_window, x, y);
                assert_eq!(same, p.coherence_length == 0.0 || t > 0.0, "kind {} at {s} {t}", p.kind);
            }
        }
    }
}

#[test]
fn derivatives_between_the_tracks_are_those_of_the_height() {
    for p in two_tracks() {
        for direction in [0.0, 0.6, -2.0] {
            let p = RoadParameters { direction, ..p.clone() };
            let (road, window) = with_window(&p);
            let (sin, cos) = direction.sin_cos();
            for i in 0..300 {
                let (s, t) = (4.8037 + 0.005 * f64::from(i), -1.0003 + 0.05 * f64::from(i % 41));
                let (x, y) = (s * cos - t * sin, s * sin + t * cos);
                compare_derivatives(|x, y| road.mean(&window, x, y), x, y);
                compare_slope(&road, x, y);
            }
        }
    }
}

#[test]
fn mirrored_roads_are_mirrored() {
    for p in [parameters(4), parameters(5), RoadParameters { start: -20.0, ..parameters(6) }] {
        let left = mean_of(&RoadParameters { tracks: 2, direction: 0.4, ..p.clone() });
        let right = mean_of(&RoadParameters { tracks: 3, direction: -0.4, ..p });
        for i in 0..200 {
            let (x, y) = (4.0 + 0.02 * f64::from(i), -1.0 + 0.05 * f64::from(i % 41));
            let (a, b) = (left(x, y), right(x, -y));
            let pairs = [
                (a.height, b.height),
                (a.slope[0], b.slope[0]),
                (a.slope[1], -b.slope[1]),
                (a.curvature[0], b.curvature[0]),
                (a.curvature[1], -b.curvature[1]),
                (a.curvature[2], b.curvature[2]),
            ];
            for (a, b) in pairs {
                assert!((a - b).abs() < 1e-9, "{x} {y}: {a} {b}");
            }
        }
    }
}

/// Cross spectrum and both spectra of the tracks, summed over bins of each octave from 0.1 cycles/m on and over
/// realisations: Welch's estimate with one Hann window to a realisation.
fn spectra(p: &RoadParameters, realisations: i32) -> Vec<[f64; 4]> {
    const SAMPLES: usize = 1024;
    const STEP: f64 = 0.1;
    let mut octaves = vec![[0.0; 4]; 4];
    let turns: Vec<(f64, f64)> = (0..SAMPLES).map(|i| (TAU * i as f64 / SAMPLES as f64).sin_cos()).collect();
    for seed in 0..realisations {
        let road = Road::new(&RoadParameters { seed, ..p.clone() }).unwrap();
        let [left, right] = [0.75, -0.75].map(|y| {
            let z = |i: usize| 0.5 * (1.0 - turns[i].1) * road.at(20.0 + STEP * i as f64, y).height;
            (0..SAMPLES).map(z).collect::<Vec<_>>()
        });
        for (octave, sums) in octaves.iter_mut().enumerate() {
            // 102.4 m: bin 10 is at 0.098 cycles/m
            for bin in 10 << octave..20 << octave {
                let [mut a, mut b] = [(0.0, 0.0); 2];
                for i in 0..SAMPLES {
                    let (sin, cos) = turns[i * bin % SAMPLES];
                    a = (a.0 + left[i] * cos, a.1 - left[i] * sin);
                    b = (b.0 + right[i] * cos, b.1 - right[i] * sin);
                }
                let pair = [
                    a.0 * b.0 + a.1 * b.1,
                    a.1 * b.0 - a.0 * b.1,
                    a.0 * a.0 + a.1 * a.1,
                    b.0 * b.0 + b.1 * b.1,
                ];
                for i in 0..4 {
                    // as displacement variance of the band
                    sums[i] += pair[i] * 2.0 * STEP
                        / (SAMPLES as f64 * 0.375)
                        / f64::from(realisations)
                        / (STEP * SAMPLES as f64);
                }
            }
        }
    }
    octaves
}

#[test]
fn the_tracks_have_the_coherence() {
    for (rho, realisations) in [(1e-9, 50), (0.5, 400), (2.0, 400), (1e3, 200)] {
        let p = RoadParameters { coherence_length: rho, ..parameters(6) };
        for (octave, [real, imaginary, left, right]) in spectra(&p, realisations).into_iter().enumerate() {
            // a bin reaches half a bin to both sides
            let [from, to] = [10, 20].map(|bin| (f64::from(bin << octave) - 0.5) / 102.4);
            // over an octave, weighted with the PSD
            let (mut weights, mut sum, mut square) = (0.0, 0.0, 0.0);
            for i in 0..1000 {
                let n = from + (to - from) * (f64::from(i) + 0.5) / 1000.0;
                weights += 1.0 / (n * n);
                sum += (-rho * n).exp() / (n * n);
                square += (-2.0 * rho * n).exp() / (n * n);
            }
            let (expected, square) = (sum / weights, square / weights);
            let psd = 64e-6 * 0.01 * (1.0 / from - 1.0 / to);
            // the window's leakage and the chance in the realisations of 16 lines
            assert!(
                (left / psd - 1.0).abs() < 0.1 && (right / psd - 1.0).abs() < 0.1,
                "{rho} {from}: {left} {right} {psd}"
            );
            let root = (left * right).sqrt();
            // An angle d in which exp(i d) is a function analytic in a random exp(i p), with the mean g, has g² as
            // the mean of exp(2 i d): the variances of cosine and sine are (1 - g²) / 2. The weights of 16 lines,
            // n^-2 and dn as n, are worth 15. Four standard deviations, and 1 % for the window's leakage.
            let variance = (1.0 - square).max(0.0) / (2.0 * 15.0 * f64::from(realisations));
            let bound = 4.0 * variance.sqrt() + 0.01 * expected;
            assert!(
                (real / root - expected).abs() < bound,
                "{rho} {from}: {} {expected} {bound}",
                real / root
            );
            // neither track leads
            assert!((imaginary / root).abs() < bound, "{rho} {from}: {} {bound}", imaginary / root);
        }
    }
}

#[test]
fn tracks_of_full_coherence_are_the_same_and_the_left_one_always_is() {
    let p = RoadParameters { seed: 11, ..parameters(6) };
    let (one, its_window) = with_window(&p);
    let nearly = road(&RoadParameters { coherence_length: 1e-12, ..p.clone() });
    for rho in [0.5, 100.0] {
        let (two, window) = with_window(&RoadParameters { coherence_length: rho, ..p.clone() });
        for i in 0..300 {
            let x = 4.0 + 0.37 * f64::from(i);
            assert_eq!(two.at(x, 0.75), one.at(x, -4.0));
            assert_eq!(two.mean(&window, x, 2.0), one.mean(&its_window, x, -0.1));
            assert!((nearly.at(x, -0.75).height - one.at(x, -0.75).height).abs() < 1e-6);
        }
    }
}

#[test]
fn the_sides_have_their_own_friction() {
    let p = RoadParameters {
        friction: "2 0.9".into(),
        friction_right: "2 0.2; 3 1.1".into(),
        direction: 0.5,
        ..parameters(1)
    };
    let (road, window) = with_window(&p);
    let (sin, cos) = p.direction.sin_cos();
    for (s, t, mu) in [
        (1.0, 0.5, 1.0),
        (2.5, 0.0, 0.9),
        (2.5, 1e-9, 0.9),
        (2.5, -1e-9, 0.2),
        (3.5, -2.0, 1.1),
        (3.5, 2.0, 0.9),
    ] {
        // 1e-9 m aside, so that rounding does not decide the side
        let t = t + 1e-12;
        let (x, y) = (s * cos - t * sin, s * sin + t * cos);
        assert_eq!([road.at(x, y).friction, road.mean(&window, x, y).friction], [mu, mu], "{s} {t}");
    }
    // the mean is along s only
    let mean = road.mean(&window, 2.0 * cos + 0.01 * sin, 2.0 * sin - 0.01 * cos).friction;
    assert!((mean - 0.6).abs() < 1e-12, "{mean}");
}

/// Correlation of lines between independent values at nodes of distance D at the lag x D: that of the hat
/// function with itself, by quadrature.
fn hat_correlation(x: f64) -> f64 {
    let hat = |u: f64| (1.0 - u.abs()).max(0.0);
    let sum = |x: f64| {
        (-40_000..40_000).map(|i| (f64::from(i) + 0.5) / 20_000.0).map(|u| hat(u) * hat(u - x)).sum::<f64>()
    };
    sum(x) / sum(0.0)
}

fn varied(friction_seed: i32) -> RoadParameters {
    let p = RoadParameters { friction_deviation: 0.15, friction_correlation_length: 0.6, ..parameters(1) };
    RoadParameters { friction_seed, ..p }
}

#[test]
fn random_friction_has_its_mean_deviation_and_correlation() {
    let lags = [0.0, 0.3, 0.6, 0.9, 1.2, 1.8];
    let expected = lags.map(|lag| hat_correlation(lag / 0.8));
    for (documented, lag) in [(0.83, 1), (0.47, 2), (0.03, 4), (0.0, 5)] {
        assert!((expected[lag] - documented).abs() < 5e-3);
    }
    let check = |mean: f64, products: [f64; 6], count: f64| {
        // five standard deviations of as many independent values
        let bound = 5.0 / count.sqrt();
        assert!((mean - 1.0).abs() < 0.15 * bound, "{mean}");
        for i in 0..6 {
            let correlation = products[i] / (0.15 * 0.15);
            assert!((correlation - expected[i]).abs() < bound, "{}: {correlation} {}", lags[i], expected[i]);
        }
    };
    // over realisations, at several places: none is special
    for place in [-1234.5, 0.0, 7.7] {
        let (mut mean, mut products) = (0.0, [0.0; 6]);
        for seed in -10_000..10_000 {
            let road = road(&varied(seed));
            let factor = |lag: f64| road.at(place + lag, 0.4).friction;
            mean += factor(0.0) / 20_000.0;
            for i in 0..6 {
                products[i] += (factor(0.0) - 1.0) * (factor(lags[i]) - 1.0) / 20_000.0;
            }
        }
        check(mean, products, 20_000.0);
    }
    // along one road of 20 000 nodes
    let road = road(&varied(5));
    let (mut mean, mut products) = (0.0, [0.0; 6]);
    for i in 0..200_000 {
        let s = 0.08 * f64::from(i);
        let factor = |lag: f64| road.at(s + lag, 0.0).friction - 1.0;
        mean += (1.0 + factor(0.0)) / 200_000.0;
        for i in 0..6 {
            products[i] += factor(0.0) * factor(lags[i]) / 200_000.0;
        }
    }
    // a correlation over twice the length makes as many values of fewer independent ones
    check(mean, products, 10_000.0);
}

#[test]
fn random_friction_is_never_negative_and_keeps_its_bounds() {
    let p = RoadParameters { friction_deviation: 2.0_f64.sqrt() / 3.0, ..varied(3) };
    let road_ = road(&p);
    let factors: Vec<f64> = (0..400_000).map(|i| road_.at(0.01 * f64::from(i), 0.0).friction).collect();
    let least = factors.iter().copied().fold(f64::MAX, f64::min);
    let most = factors.iter().copied().fold(0.0, f64::max);
    assert!((0.0..0.02).contains(&least) && (1.98..2.0).contains(&most), "{least} {most}");
    // steps of 1/80 of the nodes' distance
    assert!(factors.windows(2).all(|pair| (pair[1] - pair[0]).abs() <= 2.0 / 80.0 + 1e-9));
    let half = road(&RoadParameters { friction_deviation: 0.5 * p.friction_deviation, ..p });
    for i in 0..1000 {
        let (whole, half) =
            (road_.at(0.1 * f64::from(i), 0.0).friction, half.at(0.1 * f64::from(i), 0.0).friction);
        assert!((0.5 * (whole - 1.0) - (half - 1.0)).abs() < 1e-12);
    }
}

#[test]
fn random_friction_multiplies_patches_and_is_averaged_with_them() {
    for correlation in [1e-3, 0.02, 0.6, 50.0] {
        let p = RoadParameters {
            friction: "1.9 0.5; 2.03 0.8; 2.06 0.1".into(),
            friction_correlation_length: correlation,
            ..varied(9)
        };
        let (one, window) = with_window(&p);
        let even = road(&RoadParameters { friction: String::new(), ..p.clone() });
        let patch = road(&RoadParameters { friction_deviation: 0.0, ..p });
        for i in 0..100 {
            let s = 1.8 + 0.005 * f64::from(i);
            let factor = |s: f64| one.at(s, 0.0).friction;
            assert!((factor(s) - even.at(s, 0.0).friction * patch.at(s, 0.0).friction).abs() < 1e-14);
            // edges of the patches are at multiples of the step
            let quadrature: f64 =
                (0..16_000).map(|k| factor(s + L * ((f64::from(k) + 0.5) / 16_000.0 - 0.5)) / 16_000.0).sum();
            let mean = one.mean(&window, s, 0.0).friction;
            assert!((mean - quadrature).abs() < 1e-5, "{correlation} {s}: {mean} {quadrature}");
        }
    }
    // far away as well
    let (one, window) = with_window(&varied(9));
    for s in [-1e6, 1e6, 1e15, 1e300] {
        assert!((one.mean(&window, s, 0.0).friction - 1.0).abs() < 0.32);
    }
}
