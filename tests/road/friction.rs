//! Friction: patches, sides, and what varies at random.

use super::*;

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

/// With a seed of its own the right side is the road of that seed, and knows nothing of the left one.
#[test]
fn random_friction_of_the_right_side_is_its_own() {
    let both = road(&RoadParameters { friction_seed_right: 9, ..varied(5) });
    let (left, right, same) = (road(&varied(5)), road(&varied(9)), road(&varied(5)));
    let mut product = 0.0;
    for i in 0..100_000 {
        let s = 0.08 * f64::from(i);
        let [on_left, on_right] = [0.4, -0.4].map(|y| both.at(s, y).friction);
        assert_eq!([on_left, on_right], [left.at(s, 0.4).friction, right.at(s, 0.0).friction]);
        assert_eq!(same.at(s, -0.4).friction, on_left);
        product += (on_left - 1.0) * (on_right - 1.0) / 100_000.0;
    }
    // five standard deviations of 10 000 independent values
    assert!(product.abs() < 0.05 * 0.15 * 0.15, "{product}");
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
