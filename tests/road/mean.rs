//! Means over a window: quadrature of the filter, closed forms, conservation.

use super::*;

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
