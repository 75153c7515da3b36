//! Left and right track: heights between them, spectra, coherence.

use super::*;

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
