//! The stationary solver against the published tables and against a second solver.
//!
//! The second solver, [`reference`], is written from the equations in plain `f64`: a march of the
//! first order with N equal intervals along each stripe and Newton's method with differences. It
//! shares no code with the product. The tables (section 16 of the model's specification) come from
//! a third program with the same march and N = 1000.
#![allow(missing_docs, clippy::unwrap_used, clippy::expect_used, clippy::panic)]

#[path = "../common/mod.rs"]
mod common;
mod reference;

use common::rolling::{FREE, Point};
use common::{assert_close, example, example_tire};
use latsch::road::Road;
use latsch::tire::Vertical;
use latsch::tire::ring_brush::{Contact, Prepared, Shape, Stationary, stationary};
use std::f64::consts::FRAC_PI_2;

/// Columns of the tables.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Column {
    Fx,
    Fy,
    Mx,
    My,
    Mz,
    Camber,
    Yaw,
    Deflection,
}
use Column::{Camber, Deflection, Fx, Fy, Mx, My, Mz, Yaw};

/// A row: the operating point and what is printed.
struct Row {
    point: Point,
    printed: Vec<(Column, &'static str)>,
}

fn table() -> Vec<Row> {
    let mut rows = Vec::new();
    let longitudinal = [
        (0.002, ["201.3", "424.1", "617.6"]),
        (0.005, ["476.9", "1016.1", "1492.9"]),
        (0.01, ["873.1", "1863.7", "2773.7"]),
        (0.02, ["1421.6", "2910.8", "4320.1"]),
        (0.03, ["1713.1", "3396.8", "4999.3"]),
        (0.05, ["1984.8", "3847.4", "5624.9"]),
        (0.08, ["2139.4", "4113.8", "6001.7"]),
        (-0.002, ["-200.8", "-425.5", "-620.0"]),
        (-0.01, ["-815.9", "-1848.6", "-2802.7"]),
        (-0.03, ["-1511.0", "-3305.6", "-5017.8"]),
        (-0.05, ["-1811.7", "-3795.3", "-5669.5"]),
        (-0.08, ["-2034.6", "-4104.6", "-6065.1"]),
    ];
    for (slip, forces) in longitudinal {
        for (load, force) in [2000.0, 4000.0, 6000.0].into_iter().zip(forces) {
            rows.push(Row { point: Point { load, slip, ..FREE }, printed: vec![(Fx, force)] });
        }
    }
    let moments = [
        (2000.0, 0.03, "-582.78"),
        (4000.0, 0.03, "-1155.04"),
        (6000.0, 0.03, "-1700.68"),
        (2000.0, -0.03, "474.74"),
        (4000.0, -0.03, "1043.35"),
        (6000.0, -0.03, "1584.93"),
    ];
    for (load, slip, moment) in moments {
        rows.push(Row { point: Point { load, slip, ..FREE }, printed: vec![(My, moment)] });
    }
    let lateral = "
        0.005  3000 -0.04 514.36  185.04  -30.859 -11.818 0.002087 -1.547e-4 0.016611
        0.0175 3000 -0.13 1667.67 599.80  -30.841 -22.469 0.006768 -3.037e-4 0.016724
        0.05   3000 0.00  2821.46 1014.26 -30.865 7.790   0.011455 5.91e-5   0.016955
        0.1    3000 -0.01 3174.83 1141.03 -30.836 27.329  0.012892 2.991e-4  0.017050
        0.005  5000 -0.17 591.45  224.30  -50.830 -19.977 0.002368 -2.572e-4 0.024967
        0.01   5000 -0.60 1197.65 454.15  -50.711 -37.487 0.004795 -4.839e-4 0.025015
        0.0175 5000 -1.30 2137.42 810.28  -50.532 -55.746 0.008558 -7.248e-4 0.025155
        0.03   5000 -0.81 3553.28 1345.98 -50.725 -44.131 0.014234 -5.981e-4 0.025513
        0.05   5000 -0.03 4545.05 1720.29 -50.885 -0.530  0.018214 -6.41e-5  0.025871
        0.1    5000 -0.01 5148.38 1947.50 -50.756 40.898  0.020637 4.486e-4  0.026131
        0.2    5000 -0.04 5269.83 1993.19 -50.704 52.304  0.021126 5.915e-4  0.026188
        pi/2   3000 0     3225.54 1159.12 0       0       0.0130953 0        0.017064
        pi/2   5000 0     5250.24 1985.53 0       0       0.0210416 0        0.026178";
    for line in lateral.trim().lines() {
        let mut words = line.split_whitespace();
        let alpha = words.next().unwrap();
        let (alpha, speed) = if alpha == "pi/2" { (FRAC_PI_2, 1.0) } else { (alpha.parse().unwrap(), 10.0) };
        let load = words.next().unwrap().parse().unwrap();
        let printed = [Fx, Fy, Mx, My, Mz, Camber, Yaw, Deflection].into_iter().zip(words).collect();
        rows.push(Row { point: Point { load, alpha, speed, ..FREE }, printed });
    }
    let camber = [
        (0.01, ["-201.07", "-67.28", "-0.064", "0.009271"]),
        (0.03, ["-596.42", "-199.68", "-0.19", "0.027835"]),
        (0.05, ["-971.5", "-325.6", "-0.31", "0.046467"]),
        (0.1, ["-1737.6", "-587.1", "-0.58", "0.093599"]),
    ];
    for (camber, texts) in camber {
        let printed = [Fy, Mx, Mz, Camber].into_iter().zip(texts).collect();
        rows.push(Row { point: Point { camber, ..FREE }, printed });
    }
    rows
}

/// Half a unit of the last printed digit, and a little for numbers that were cut off.
fn half_digit(printed: &str) -> f64 {
    let decimals = printed.split(['e', 'E']).next().unwrap().split_once('.').map_or(0, |(_, d)| d.len());
    let exponent: i32 = printed.split(['e', 'E']).nth(1).map_or(0, |e| e.parse().unwrap());
    0.56 * 10f64.powi(exponent - decimals as i32)
}

/// The size against which an error in this column counts. Moments about z are differences of large
/// ones: their size is the horizontal force at the patch's half length. So it is with the small
/// yaw, which is that moment over the tilt stiffness, and with F_x without slip, which is the
/// lateral force turned by the yaw.
fn size(column: Column, expected: f64, point: &Point, force_y: f64) -> f64 {
    let moment = force_y.abs() * 0.5 * 0.19;
    match column {
        Mz => expected.abs().max(moment),
        Yaw => expected.abs().max(moment / 8e4),
        Fx if point.slip == 0.0 => expected.abs().max(moment / 8e4 * force_y.abs()),
        _ => expected.abs(),
    }
}

fn column_of_reference(a: &reference::Answer, column: Column) -> f64 {
    match column {
        Fx => a.force[0],
        Fy => a.force[1],
        Mx => a.moment[0],
        My => a.moment[1],
        Mz => a.moment[2],
        Camber => a.camber,
        Yaw => a.yaw,
        Deflection => a.deflection,
    }
}

fn column_of_product(s: &Stationary, column: Column) -> f64 {
    match column {
        Fx => s.on_rim.force.x,
        Fy => s.on_rim.force.y,
        Mx => s.on_rim.moment.x,
        My => s.on_rim.moment.y,
        Mz => s.on_rim.moment.z,
        Camber => s.belt_camber,
        Yaw => s.belt_yaw,
        Deflection => 0.338 - s.rim_height,
    }
}

/// (i) With the 1000 points of the tables the reference gives what they print.
#[test]
fn reference_reproduces_every_row() {
    let mut worst: f64 = 0.0;
    for Row { point, printed } in table() {
        let answer = reference::solve(point, 1000);
        assert!(answer.residual < 2e-5, "{point:?}: {:.1e}", answer.residual);
        for (column, text) in printed {
            let (value, expected) = (column_of_reference(&answer, column), text.parse::<f64>().unwrap());
            let error = (value - expected).abs();
            // One row prints 873.1 where this search finds 873.34: where the breaking away of single
            // points makes the equations jump there is more than one root, or none.
            let jump = point.load == 2000.0 && point.slip == 0.01;
            let allowed = if jump { 3e-4 * expected.abs() } else { half_digit(text) };
            if !jump {
                worst = worst.max(error / half_digit(text));
            }
            assert!(error <= allowed, "{point:?} {column:?}: {value} instead of {text}");
        }
    }
    println!("reference against the tables: at most {worst:.2} half digits off");
}

/// The limit of the reference for N to infinity: a straight line in 1/N through its results. The
/// points at which bristles break away jump from point to point, which adds a saw-tooth of the same
/// order 1/N; hence more than two N.
fn reference_limit(point: Point, counts: &[usize]) -> [f64; 8] {
    let all = [Fx, Fy, Mx, My, Mz, Camber, Yaw, Deflection];
    let runs: Vec<(f64, reference::Answer)> =
        counts.iter().map(|n| (1.0 / *n as f64, reference::solve(point, *n))).collect();
    let count = runs.len() as f64;
    let mean = runs.iter().map(|(h, _)| h).sum::<f64>() / count;
    let spread: f64 = runs.iter().map(|(h, _)| (h - mean).powi(2)).sum();
    all.map(|column| {
        let value = |a| column_of_reference(a, column);
        let average = runs.iter().map(|(_, a)| value(a)).sum::<f64>() / count;
        let slope = runs.iter().map(|(h, a)| (h - mean) * value(a)).sum::<f64>() / spread;
        average - slope * mean
    })
}

/// (ii) Two programs, two quadratures, one limit.
#[test]
fn reference_and_product_have_the_same_limit() {
    let tire = example_tire();
    let points = [
        Point { load: 6000.0, slip: 0.03, ..FREE },
        Point { load: 2000.0, slip: -0.05, ..FREE },
        Point { alpha: 0.005, ..FREE },
        Point { alpha: 0.03, ..FREE },
        Point { camber: 0.05, ..FREE },
        Point { camber: 0.03, alpha: 0.02, slip: 0.02, load: 4000.0, ..FREE },
        Point { camber: -0.04, alpha: 0.05, slip: -0.04, load: 5500.0, speed: 25.0, ..FREE },
    ];
    for point in points {
        let (limit, product) = (reference_limit(point, &[7000, 9000, 12000, 16000]), point.solve(&tire, 800));
        let force_y = limit[1];
        for (column, expected) in [Fx, Fy, Mx, My, Mz, Camber, Yaw, Deflection].into_iter().zip(limit) {
            let value = column_of_product(&product, column);
            let error = (value - expected).abs() / size(column, expected, &point, force_y).max(1e-3);
            if error > 2e-5 {
                println!("{point:?} {column:?}: {value:.6}, reference {expected:.6}, {error:.1e}");
            }
            assert!(error < 1e-4, "{point:?} {column:?}: {value}, reference {expected}, {error:.1e}");
        }
    }
}

/// (iii) Every row against the product. The tables are 0.5e-3 to 1.3e-3 high by the first order of
/// their march; where that is more than 1e-3 the judge is the limit of the reference.
#[test]
fn product_against_every_row() {
    let tire = example_tire();
    let mut beyond = Vec::new();
    for Row { point, printed } in table() {
        let product = point.solve(&tire, 400);
        let mut limit = None;
        let force_y = product.on_rim.force.y;
        for (k, (column, text)) in printed.into_iter().enumerate() {
            let (value, expected) = (column_of_product(&product, column), text.parse::<f64>().unwrap());
            let scale = size(column, expected, &point, force_y);
            if (value - expected).abs() <= (1e-3 * scale).max(half_digit(text)) {
                continue;
            }
            beyond.push(format!(
                "{column:?} at {} N, slip {}, alpha {}, camber {}: {value:.4} for {text}, {:.2e}",
                point.load,
                point.slip,
                point.alpha,
                point.camber,
                (value - expected) / scale
            ));
            let limit = limit.get_or_insert_with(|| reference_limit(point, &[2000, 2500, 3200, 4000]));
            let all = [Fx, Fy, Mx, My, Mz, Camber, Yaw, Deflection];
            let at = all.iter().position(|c| *c == column).unwrap_or(k);
            let error = (value - limit[at]).abs() / scale;
            assert!(error <= 3e-4, "{point:?} {column:?}: {value}, reference {}, {error:.1e}", limit[at]);
            assert!(
                (value - expected).abs() <= 1.5e-3 * scale + half_digit(text),
                "{point:?} {column:?}: {value} for {text}"
            );
        }
    }
    println!("{} entries are more than 1e-3 off the tables:\n{}", beyond.len(), beyond.join("\n"));
}

/// (iv) The order of the product: the error against the finest falls with the third power of its intervals.
#[test]
fn product_converges_with_the_third_power_of_its_intervals() {
    let point = Point { load: 6000.0, slip: 0.03, ..FREE };
    let counts = [25, 50, 100, 200, 400, 1600];
    let check = |tire: &Prepared, limit: f64, finest: f64| {
        let forces = counts.map(|n| point.solve(tire, n).on_rim.force.x);
        for (n, force) in counts.into_iter().zip(forces) {
            let error = (force - forces[5]).abs();
            println!("{n:5} intervals: {force:.5} N, error {error:.5}");
            // up to twice 0.43 N (25/n)³; 1e-8 where the place at which a bristle comes to rest falls now here,
            // now there in an interval
            let bound = 2e-4 * limit * (25.0 / n as f64).powi(3);
            assert!(error <= bound.max(1e-8 * limit), "{forces:?}");
        }
        assert_close("limit", forces[5], limit, finest);
    };
    // the limit of a march of second order with 1600 intervals; 0.01 N
    check(&example_tire(), 4995.039, 2e-6);
    // without the damper it is the 4988.80 N of the table of continuous targets, which neglects the damper
    let mut p = example();
    p.bristle_damping = 1e-6;
    check(&Prepared::new(&p, &Road::default()).unwrap(), 4988.80, 2e-6);
}

/// Points of all kinds: free rolling, combined slips, camber, fast, locked and standing.
fn various() -> Vec<Point> {
    let slow = Point { speed: 1.0, ..FREE };
    let mut points = vec![
        FREE,
        Point { alpha: FRAC_PI_2, ..slow },
        Point { slip: -1.0, alpha: 0.1, ..FREE },
        Point { slip: -1.0, speed: 0.0, ..FREE },
        Point { slip: 3.0, ..slow },
        Point { camber: 0.1, ..FREE },
        // bristles that come to rest and break away again on a few millimetres
        Point { load: 2500.0, slip: 0.003, alpha: 0.09, camber: 0.05, ..FREE },
    ];
    for load in [1000.0, 4000.0, 8000.0] {
        for (slip, alpha, camber, speed) in [
            (0.03, 0.03, 0.0, 10.0),
            (-0.004, 0.003, 0.02, 10.0),
            (0.1, -0.05, -0.05, 40.0),
            (-0.3, 0.3, 0.0, 10.0),
            (0.0, 0.1, 0.08, 30.0),
        ] {
            points.push(Point { load, slip, alpha, camber, speed, steer: 0.2 });
        }
    }
    points
}

/// (v) What the model uses is within 1e-4 of the limit.
#[test]
fn the_intervals_of_the_model_are_fine_enough() {
    let tire = example_tire();
    let mut worst: f64 = 0.0;
    for point in various() {
        let usual = stationary(&tire, &point.rim(&tire), Vertical::Load(point.load), 1.0).unwrap();
        let (usual, fine) = (usual.on_rim, point.solve(&tire, 800).on_rim);
        let size = fine.force.x.hypot(fine.force.y).max(1e-2 * point.load);
        let error = (usual.force - fine.force).norm() / size;
        // the moments' levers are the radius and the patch's half length
        let turning = (usual.moment - fine.moment).norm() / (0.338 * size);
        worst = worst.max(error).max(turning);
        assert!(error < 1e-4 && turning < 1e-4, "{point:?}: {error:.1e} {turning:.1e}");
    }
    println!("at most {worst:.1e} off the limit");
}

/// (vi) A search from a near state finds the state that a fresh one finds: neighbours in slip, slip angle, camber,
/// load, friction and parameters, and one that is not near at all.
#[test]
fn a_near_start_finds_the_same_state() {
    let tire = example_tire();
    let mut other = example();
    other.bristle_stiffness *= 1.02;
    other.friction_static = [1.53, 1.41];
    other.sidewall_tilt_stiffness *= 0.97;
    let other = Prepared::new(&other, &Road::default()).unwrap();
    for point in various() {
        let from = stationary(&tire, &point.rim(&tire), Vertical::Load(point.load), 1.0).unwrap();
        let moving = point.speed > 0.0 && point.slip != -1.0 && point.alpha < 1.0;
        let change = if moving { 1e-3 } else { 0.0 };
        let next = Point {
            slip: point.slip + change,
            alpha: point.alpha - change,
            camber: point.camber + 1e-3,
            load: 1.02 * point.load,
            ..point
        };
        let far = Point { load: 3000.0, slip: -0.05, alpha: -0.02, ..FREE };
        for (tire, point, friction) in [(&tire, next, 1.0), (&other, point, 0.99), (&tire, far, 1.0)] {
            let (rim, load) = (point.rim(tire), Vertical::Load(point.load));
            let near = from.near(tire, &rim, load, friction).unwrap();
            let fresh = stationary(tire, &rim, load, friction).unwrap();
            let force = (near.on_rim.force - fresh.on_rim.force).norm();
            let moment = (near.on_rim.moment - fresh.on_rim.moment).norm();
            // both stop at 1e-11, or at 1e-6 where a kink holds them up
            let stopped = near.convergence.residual.max(fresh.convergence.residual).max(1e-11);
            let bound = 100.0 * stopped * point.load;
            assert!(force < bound && moment < bound, "{point:?}: {force:.1e} {moment:.1e} {stopped:.1e}");
        }
    }
}

#[test]
fn geometry_of_the_patch() {
    let (tire, p) = (example_tire(), example());
    // load, F_LGKz, f_G, h, l_mat 1..3, sums of l, l^2, l^3, e_l, e_q, Z2 at 10 m/s, Z5
    let rows = "
        2000 2086.328 0.0114462 0.326554 .078259 .115584 .130557 0.648799 0.073058 0.0084976 5.02586 7.74777 104670.1 -1648.10
        2600 2686.328 0.0142066 0.323793 .101266 .132545 .145920 0.759461 0.098231 0.0129481 5.37835 8.25043 140682.5 -2288.99
        3000 3086.328 0.0159571 0.322043 .113490 .142278 .154895 0.821326 0.114231 0.0161164 5.61333 8.58555 163568.3 -2680.21
        4000 4086.328 0.0200724 0.317928 .138095 .162943 .174236 0.950549 0.151958 0.0244985 6.20077 9.42336 217524.1 -3521.88
        5000 5086.328 0.0238810 0.314119 .157552 .180032 .190455 1.056077 0.187014 0.0333086 6.78817 10.26118 267653.3 -4191.23
        6000 6086.328 0.0274427 0.310557 .173845 .194713 .204513 1.146142 0.219921 0.0423800 7.37556 11.09902 314705.6 -4725.82";
    for line in rows.trim().lines() {
        let texts: Vec<&str> = line.split_whitespace().collect();
        let load: f64 = texts[0].parse().unwrap();
        let state = Point { load, ..FREE }.solve(&tire, 50);
        let mut belt = latsch::tire::Motion::default();
        belt.position.z = state.rim_height + state.belt_from_rim.z;
        let contact = Contact::new(&p, &belt);
        let lengths: Vec<f64> = (0..6)
            .map(|i| contact.stripe_length(&p, tire.stripe_places()[i], tire.stripe_radii()[i]))
            .collect();
        let sum = |k: i32| lengths.iter().map(|l| l.powi(k)).sum::<f64>();
        let (long, lat) = Shape::new(&p, contact.penetration).exponents();
        let (c, d, l) = (p.bristle_stiffness, p.bristle_damping, p.bristle_length);
        let a = c * sum(3) / (12.0 * l);
        let product = [
            load,
            state.patch.force.z,
            contact.penetration,
            contact.distance,
            lengths[0],
            lengths[1],
            lengths[2],
            sum(1),
            sum(2),
            sum(3),
            long,
            lat,
            (0.5 * c * sum(2) + 10.0 * d * sum(1)) / l,
            -a / (1.0 + a * (p.patch_compliance_twist + 1.0 / p.sidewall_tilt_stiffness)),
        ];
        let f = reference::penetration(load);
        let other = reference::lengths(0.338 - f, 0.0);
        let exponents = reference::exponents(f);
        for (k, (value, text)) in product.into_iter().zip(&texts).enumerate() {
            let expected: f64 = text.parse().unwrap();
            assert!((value - expected).abs() <= half_digit(text), "{load} N, column {k}: {value} for {text}");
        }
        for (i, (product, reference)) in lengths.iter().zip(other).enumerate() {
            assert_close(&format!("stripe {i}"), *product, reference, 1e-9);
        }
        assert_close("e_l", long, exponents[0], 1e-9);
        assert_close("e_q", lat, exponents[1], 1e-9);
    }
}
