//! What does not depend on step and bristles, and how the rest converges.

use crate::common::rolling::{FREE, Point};
use crate::common::{PRINTED_PRESSURE, assert_close, example_tire, flat_track, get, set};
use crate::{FORCES, check_sanity, finer, forces, means, run};
use latsch::model::Slave;

/// The start is the stationary state: nothing swings in, and the mean is the stationary force but
/// for bristles of 14 mm in place of a continuum.
#[test]
fn stationary_start_stays() {
    let tire = example_tire();
    let points = [
        Point { load: 6000.0, slip: 0.03, ..FREE },
        Point { load: 4000.0, alpha: 0.02, ..FREE },
        Point { load: 5000.0, alpha: 0.05, camber: 0.03, ..FREE },
        Point { load: 3000.0, slip: -0.05, alpha: -0.03, camber: -0.02, ..FREE },
    ];
    for point in points {
        let s = point.solve(&tire, 400);
        let mut rig = flat_track(&[
            ("deflection", 0.338 - s.rim_height),
            ("slip", point.slip),
            ("slip_angle", -point.alpha),
            ("camber", point.camber),
            PRINTED_PRESSURE,
        ]);
        assert_eq!(get(&mut rig, "stationary_start"), 1.0);
        // 140 ms are 100 bristles
        let (early, late) = (means(&mut rig, 0.14), means(&mut rig, 0.28));
        let expected: Vec<f64> = s.on_rim.force.iter().chain(s.on_rim.moment.iter()).copied().collect();
        // lag times are 18 to 76 ms: what is off at the start would show in the drift
        let scale =
            [point.load, point.load, point.load, 0.338 * point.load, 0.338 * point.load, 0.1 * point.load];
        for (k, name) in FORCES.iter().enumerate() {
            println!("{point:?} {name}: stationary {:.2}, means {:.2} {:.2}", expected[k], early[k], late[k]);
            assert!((late[k] - early[k]).abs() < 2e-3 * scale[k], "{point:?} {name} drifts");
            assert!((late[k] - expected[k]).abs() < 5e-3 * scale[k], "{point:?} {name}");
        }
    }
}

/// Finer bristles of the same rubber: towards the continuum with the second order and without a ripple, 4988.80 N without
/// the bristle's damper. With it 0.4 N remain, 1e-4: a bristle that enters slides for the first 0.03 mm, which steps of
/// some microseconds would have to resolve.
#[test]
fn refinement_of_bristles() {
    let s = Point { load: 6000.0, slip: 0.03, ..FREE }.solve(&example_tire(), 800);
    let sums = |damping: f64, factor: f64, h: f64| {
        let mut rig = flat_track(
            &[
                &finer(factor)[..],
                &[
                    ("deflection", 0.338 - s.rim_height),
                    ("slip", 0.03),
                    ("bristle_damping", (damping / factor).max(1e-6)),
                    ("step_size", h),
                ],
            ]
            .concat(),
        );
        run(&mut rig, 0.4, |_| {});
        // 70 ms: 50 bristles of the coarsest kind
        let forces: Vec<f64> = (0..1400)
            .map(|k| {
                rig.step(0.4 + f64::from(k) * 5e-5, 5e-5).unwrap();
                get(&mut rig, "force_x")
            })
            .collect();
        let mean = forces.iter().sum::<f64>() / 1400.0;
        let ripple = (forces.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / 1400.0).sqrt();
        println!(
            "{:4} bristles, h {h:.1e}, damper {damping}: mean {mean:.2} N, standard deviation {ripple:.2} N",
            30.0 * factor,
        );
        (mean, ripple)
    };
    let grids = [(1.0, 5e-5), (2.0, 5e-5), (4.0, 5e-5), (8.0, 2.5e-5)];
    for (damping, limit) in [(0.65, 4995.04), (0.0, 4988.80)] {
        let found = grids.map(|(factor, h)| sums(damping, factor, h));
        let errors = found.map(|(mean, _)| (mean - limit).abs());
        assert!(errors[0] < 3e-4 * limit && errors[3] < 1e-4 * limit, "{errors:?}");
        // 3.8 N when every bristle counted as a whole
        assert!(found.iter().all(|(_, ripple)| *ripple < 0.8), "{found:?}");
        if damping == 0.0 {
            // second order
            assert!(errors.windows(2).all(|e| e[1] < e[0] / 3.0), "{errors:?}");
        }
    }
}

/// Near full sliding a bristle sticks over a spacing or two only, which it may pass in one step: what the patch carries is
/// that of four times as many bristles with a tenth of the step, and it hardly swings while they pass. At 28 m/s a step is
/// one or two spacings long, and what is left of a ripple beats with it.
#[test]
fn what_sticks_for_less_than_a_step_counts() {
    let points =
        [(28.0, 0.0, 0.12), (28.0, 0.0, 0.16), (28.0, -0.1, 0.0), (28.0, -0.15, 0.1), (-28.0, 0.0, 0.12)];
    for (speed, slip, slip_angle) in points {
        let patch = |factor: f64, step: f64| {
            let point = [
                ("path_speed", speed),
                ("deflection", 0.02),
                ("slip", slip),
                ("slip_angle", slip_angle),
                ("step_size", step),
            ];
            let mut rig = flat_track(&[&finer(factor)[..], &point].concat());
            run(&mut rig, 0.1, |_| {});
            let mut found = Vec::new();
            run(&mut rig, 0.4, |rig| {
                found.push(["patch_force_x", "patch_force_y"].map(|name| get(rig, name)))
            });
            let mean = [0, 1].map(|c| found.iter().map(|f| f[c]).sum::<f64>() / found.len() as f64);
            let squares = found.iter().map(|f| (f[0] - mean[0]).powi(2) + (f[1] - mean[1]).powi(2));
            (mean, (squares.sum::<f64>() / found.len() as f64).sqrt())
        };
        let (fine, _) = patch(4.0, 5e-5);
        let size = fine[0].hypot(fine[1]);
        for step in [5e-4, 1e-3] {
            let (coarse, ripple) = patch(1.0, step);
            let error = (coarse[0] - fine[0]).hypot(coarse[1] - fine[1]);
            println!(
                "{speed} {slip} {slip_angle}, {step}: {coarse:.1?} for {fine:.1?} N, ripple {ripple:.2} N"
            );
            assert!(error < 2e-3 * size && ripple < 2e-3 * size, "{slip} {slip_angle}: {error} {ripple}");
        }
    }
}

/// A wheel that rolls slowly at a slip angle does so quietly: no bristle that breaks away or leaves the contact gives the
/// belt a blow. With each counted as a whole the vertical force swings by some 400 N.
#[test]
fn slow_rolling_is_quiet() {
    for (speed, step) in [(0.3, 1e-4), (1.0, 1e-4), (1.0, 5e-4), (3.0, 5e-4)] {
        let swings = |whole: f64| {
            let mut rig = flat_track(&[
                ("path_speed", speed),
                ("slip_angle", 0.05),
                ("deflection", 0.02),
                ("step_size", step),
                ("whole_step_entry", whole),
            ]);
            let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
            for k in 0..2000 {
                rig.step(f64::from(k) * 1e-3, 1e-3).unwrap();
                if k >= 1000 {
                    low = low.min(get(&mut rig, "force_z"));
                    high = high.max(get(&mut rig, "force_z"));
                }
            }
            high - low
        };
        let (quiet, whole) = (swings(0.0), swings(1.0));
        println!("{speed} m/s, {step} s: {quiet:.2} N, {whole:.1} N with whole bristles");
        assert!(quiet < 2.0 && quiet < 0.2 * whole, "{speed} {step}: {quiet} {whole}");
    }
}

/// Vertical transient of a standing wheel: second order in the step.
#[test]
fn second_order_in_time() {
    // A held command passes the actuator, whose velocity is continuous and whose steps are exact. (A
    // command with a rate jumps in velocity: the damper's jump is then half a step late, once.)
    let at = |h: f64| {
        let mut rig = flat_track(&[("path_speed", 0.0), ("deflection", 0.01), ("step_size", h)]);
        set(&mut rig, &[("deflection", 0.02)]);
        run(&mut rig, 0.012, |_| {});
        [get(&mut rig, "force_z"), get(&mut rig, "belt_deflection")]
    };
    let results = [2e-4, 1e-4, 5e-5, 2.5e-5].map(at);
    for quantity in 0..2 {
        let r = results.map(|r| r[quantity]);
        for k in 0..2 {
            let ratio = (r[k] - r[k + 1]) / (r[k + 1] - r[k + 2]);
            println!("{:.6} {:.6} {:.6}: ratio {ratio:.3}", r[k], r[k + 1], r[k + 2]);
            assert!((3.6..4.4).contains(&ratio), "{r:?}");
        }
    }
}

/// The same for patch, lag and side wall: a standing wheel whose bristles stick is steered and
/// cambered a little.
#[test]
fn second_order_in_time_with_a_sticking_patch() {
    let at = |h: f64| {
        let mut rig = flat_track(&[
            ("path_speed", 0.0),
            ("deflection", 0.02),
            ("step_size", h),
            // each bristle counts as a whole: shares have slopes that change as bristles pass the ends
            ("whole_step_entry", 1.0),
            ("friction_static_zero", 10.0),
            ("friction_static_reference", 10.0),
            ("friction_sliding_zero", 10.0),
            ("friction_sliding_reference", 10.0),
        ]);
        set(&mut rig, &[("steer", 0.002), ("camber", 0.002)]);
        run(&mut rig, 0.03, |_| {});
        let state = &rig.model().tire().state;
        let lagged = [state.lag.lagged.force_y, state.lag.lagged.moment_z];
        assert_eq!(get(&mut rig, "sliding_share"), 0.0);
        [get(&mut rig, "moment_z"), get(&mut rig, "force_y"), lagged[0], lagged[1]]
    };
    let results = [2e-4, 1e-4, 5e-5].map(at);
    for quantity in 0..4 {
        let r = results.map(|r| r[quantity]);
        let ratio = (r[0] - r[1]) / (r[1] - r[2]);
        println!("{:.6} {:.6} {:.6}: ratio {ratio:.3}", r[0], r[1], r[2]);
        assert!((3.6..4.4).contains(&ratio), "{r:?}");
    }
}

/// Steady rolling does not know the step: the way of the tops is integrated exactly.
#[test]
fn steady_means_and_the_step() {
    let inputs = [
        [("camber", 0.05), ("slip_angle", 0.0)],
        [("camber", 0.0), ("slip_angle", 0.01)],
        [("camber", -0.02), ("slip_angle", -0.04)],
    ];
    for inputs in inputs {
        let mean = |h: f64| {
            let mut rig = flat_track(&[&inputs[..], &[("deflection", 0.025), ("step_size", h)]].concat());
            run(&mut rig, 0.2, |_| {});
            means(&mut rig, 0.48)
        };
        let (coarse, fine) = (mean(2e-4), mean(2.5e-5));
        println!(
            "{inputs:?}: force_y {:.2} {:.2}, moment_z {:.3} {:.3}",
            coarse[1], fine[1], coarse[5], fine[5]
        );
        assert!((coarse[1] - fine[1]).abs() < 2.0 && (coarse[5] - fine[5]).abs() < 0.1);
    }
}

/// A carcass ten times as soft as the example's that follows its loads within 1 ms or at once: bristles that stick and the
/// patch's shift are then a loop that settles within a small part of a step.
#[test]
fn no_lag_is_too_short_and_no_carcass_too_soft_for_a_step() {
    let course = |speed: f64, (name, compliance): (&str, f64), lag: f64, step: f64| {
        let mut rig = flat_track(&[
            ("path_speed", speed),
            ("deflection", 0.02),
            ("step_size", step),
            (&format!("patch_compliance_{name}"), compliance),
            (&format!("patch_lag_{name}"), lag),
        ]);
        set(&mut rig, &[("steer", 0.01), ("camber", 0.002)]);
        run(&mut rig, 0.3, |_| {});
        // what is left of the jerk at the start is a slow vibration
        let mut all = Vec::new();
        run(&mut rig, 0.4, |rig| all.push(forces(rig)));
        let mean = |c: usize| all.iter().map(|f| f[c]).sum::<f64>() / all.len() as f64;
        let most = |c: usize| all.iter().map(|f| (f[c] - mean(c)).abs()).fold(0.0, f64::max);
        [0, 1, 5].map(|c| (mean(c), most(c)))
    };
    for speed in [0.0, 10.0] {
        for soft in [("x", 3e-5), ("y", 8e-6), ("twist", 1e-3)] {
            for lag in [1e-3, 1e-5] {
                let [coarse, fine] = [5e-4, 2e-5].map(|step| course(speed, soft, lag, step));
                for ((mean, most), (fine_mean, fine_most)) in coarse.into_iter().zip(fine) {
                    // of forces and moments of 30 to 90 N and N.m
                    let is_close = (mean - fine_mean).abs() < 1.2 && most < 1.3 * fine_most + 1.0;
                    assert!(is_close, "{speed} {soft:?} {lag}: {coarse:?} {fine:?}");
                }
            }
        }
    }
}

/// The patch's deformation closes a loop over its own forces within a step; at the largest step and
/// with the softest patch of the source's search range it still settles.
#[test]
fn largest_step_with_a_soft_patch() {
    let mean = |h: f64| {
        let mut rig = flat_track(&[
            ("deflection", 0.0287),
            ("slip", 0.03),
            ("slip_angle", 0.02),
            ("patch_compliance_x", 5e-6),
            ("patch_compliance_y", 1e-5),
            ("step_size", h),
        ]);
        run(&mut rig, 0.2, check_sanity);
        means(&mut rig, 0.48)
    };
    let (coarse, fine) = (mean(1e-3), mean(5e-5));
    println!("{coarse:.2?} {fine:.2?}");
    assert_close("force_x", coarse[0], fine[0], 0.01);
    assert_close("force_y", coarse[1], fine[1], 0.01);
}
