//! The road as it is, and as the limit of short windows.

use super::*;

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
