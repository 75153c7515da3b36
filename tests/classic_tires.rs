//! Classic tires against programs that are not ours, and against what follows from their equations.
//!
//! Numbers of Fiala's tire and TMeasy were computed with the functions of Project Chrono (chrono, ChFialaTire and ChTMeasyTire with
//! normalised slips, as its earlier versions have them and a published port of Rill's own code has to the last digit), those of
//! the UA tire by quadrature of the stresses of a brush, those of SWIFT's vertical law with two public implementations of the
//! Magic Formula 6.1 (TyreDyn, MFeval). They are given to twelve digits.

#![allow(missing_docs, clippy::unwrap_used, clippy::expect_used, clippy::panic)]
#![allow(clippy::approx_constant)] // a width of 0.318 m is not 1 / pi

use latsch::tire::classic::{
    AtTwoLoads, Basics, Curve, Fiala, Linear, Ring, Simple, Swift, TmEasy, Trail, Ua,
};
use latsch::tire::one_point::{Input, Law, Pressed, Steady};

mod common;

use common::Shipped;

/// Load [N], slip, slip angle [rad]; Fx, Fy [N], Mz [N.m].
const FIALA: &[[f64; 6]] = &[
    [6000.0, 0.001, 0.0, 193.929, 0.0, 0.0],
    [6000.0, -0.03, 0.0, -4366.56278146, 0.0, 0.0],
    [6000.0, -0.5, 0.0, -4565.84707648, 0.0, 0.0],
    [6000.0, 0.0, -0.005, 0.0, 246.480565735, -25.3909190708],
    [6000.0, 0.0, 0.15, 0.0, -4630.35461351, 128.374585103],
    [6000.0, 0.0, 0.6, 0.0, -4149.47294328, 0.0],
    [6000.0, 0.02, -0.05, 3622.26486577, 2157.45031285, -165.93278752],
    [6000.0, 0.3, 0.2, 4867.7251405, -4809.86623223, 35.460592367],
    [12000.0, 0.001, 0.0, 193.929, 0.0, 0.0],
    [12000.0, -0.03, 0.0, -5817.87, 0.0, 0.0],
    [12000.0, -0.5, 0.0, -9021.58830593, 0.0, 0.0],
    [12000.0, 0.0, -0.005, 0.0, 248.237151604, -25.9416171389],
    [12000.0, 0.0, 0.15, 0.0, -5962.14433029, 367.962446872],
    [12000.0, 0.0, 0.6, 0.0, -8298.94588657, 0.0],
];

/// Load [N], slip with the faster of travelling and rolling below, slip angle [rad]; Fx, Fy [N], Mz [N.m].
const UA: &[[f64; 6]] = &[
    [3000.0, 0.001, 0.0, 79.2907837522, 0.0, 0.0],
    [3000.0, -0.02, 0.0, -1330.89866088, 0.0, 0.0],
    [3000.0, 0.08, 0.0, 2869.46537448, 0.0, 0.0],
    [3000.0, -0.6, 0.0, -2460.0, 0.0, 0.0],
    [3000.0, 0.0, 0.002, 0.0, -98.8924723754, 1.93403468301],
    [3000.0, 0.0, -0.04, 0.0, 1584.52245917, -18.6262274915],
    [3000.0, 0.0, 0.15, 0.0, -2858.96946713, 0.264321700011],
    [3000.0, 0.005, 0.01, 364.522338151, -467.890656539, 8.51386355838],
    [3000.0, -0.03, 0.05, -1403.19665513, -1785.81895229, 11.5067281694],
    [3000.0, 0.1, 0.1, 2136.54465598, -1929.32556708, 5.93580993121],
    [3000.0, -0.5, 0.5, -1575.46228049, -1721.35793298, -3.90518567227],
    [6000.0, 0.01, 0.0, 764.867380559, 0.0, 0.0],
    [6000.0, -0.05, 0.0, -3165.43901244, 0.0, 0.0],
    [6000.0, 0.3, 0.0, 5460.0, 0.0, 0.0],
    [6000.0, -1.0, 0.0, -4200.0, 0.0, 0.0],
    [6000.0, 0.0, 0.02, 0.0, -945.269183663, 16.8323250387],
];

/// Load [N], friction factor, slips along and across as the source of the numbers counts them; Fx, Fy [N], Mz [N.m].
const TMEASY: &[[f64; 7]] = &[
    [8562.8266, 1.0, 0.001, 0.0, 150.934886354, 0.0, 0.0],
    [8562.8266, 1.0, 0.12, 0.0, 7575.3614, 0.0, 0.0],
    [8562.8266, 1.0, -1.2, 0.0, -4657.9208, 0.0, 0.0],
    [8562.8266, 1.0, 0.0, 0.18, 0.0, 5479.49548631, -92.0509107561],
    [8562.8266, 1.0, 0.0, -0.6, 0.0, -6262.09989509, -12.8051955611],
    [8562.8266, 1.0, 0.05, -0.05, 5441.50963066, -1883.80365956, 50.7387338255],
    [8562.8266, 1.0, 0.3, 0.3, 5943.1026471, 2057.45083178, -13.1733188286],
    [8562.8266, 0.5, -0.001, 0.0, -150.405189598, 0.0, 0.0],
    [8562.8266, 0.5, -0.15, 0.0, -3211.40592673, 0.0, 0.0],
    [8562.8266, 0.5, 0.0, 0.001, 0.0, 50.6726370032, -1.48408282094],
    [8562.8266, 0.5, 0.0, 0.25, 0.0, 3223.55129666, 6.61141458083],
    [8562.8266, 0.5, 0.0, 0.9, 0.0, 3045.7546, 0.0],
    [8562.8266, 0.5, -0.1, 0.1, -3269.01690086, 1131.70543084, -16.9836482646],
    [8562.8266, 0.5, -0.5, 0.5, -2282.92489784, 790.32889197, 0.0],
    [12844.2399, 1.0, 0.02, 0.0, 3639.26048782, 0.0, 0.0],
    [12844.2399, 1.0, 0.3, 0.0, 9145.11415203, 0.0, 0.0],
    [12844.2399, 1.0, 0.0, -0.02, 0.0, -1398.53498869, 50.4601594115],
    [12844.2399, 1.0, 0.0, -0.3, 0.0, -9440.61760133, 77.3286486852],
];

/// Change of pressure, spin [rad/s], forces along and across [N], loaded radius [m]; vertical force [N], rolling radius without these forces [m].
const SWIFT: &[[f64; 7]] = &[
    [0.0, 0.0, 0.0, 0.0, 0.39218171, 550.731426035, 0.391648378719],
    [0.0, 120.0, 0.0, 0.0, 0.39416878576, 604.248489336, 0.393425934283],
    [0.0, 40.0, 0.0, 0.0, 0.384402496196, 2917.30018971, 0.38746543447],
    [0.0, 0.0, 0.0, 0.0, 0.37418171, 5831.81886034, 0.385621068642],
    [0.0, 120.0, 0.0, 0.0, 0.37616878576, 6398.52307287, 0.387381708063],
    [0.0, 40.0, 0.0, 0.0, 0.364402496196, 9310.2602244, 0.384605615768],
    [0.0, 0.0, 2000.0, 0.0, 0.37418171, 5831.61188925, 0.385621154141],
    [0.0, 0.0, -3500.0, 0.0, 0.37418171, 5831.1850114, 0.385621330488],
    [0.0, 0.0, 0.0, 1500.0, 0.37418171, 5812.31277528, 0.385629136311],
    [0.0, 0.0, 0.0, -4000.0, 0.37418171, 5693.10892213, 0.385678881304],
    [0.0, 0.0, 2500.0, 3000.0, 0.37418171, 5753.47112778, 0.385653595231],
    [0.0, 0.0, -2500.0, -3000.0, 0.37418171, 5753.47112778, 0.385653595231],
];

fn input(fz: f64, kappa: f64, alpha: f64) -> Input {
    Input { fz, kappa, alpha, gamma: 0.0, vx: 10.0, friction: 1.0 }
}

fn agree(steady: &Steady, expected: &[f64], what: &str) {
    let got = [steady.force[0], steady.force[1], steady.moment[2]];
    for (got, expected) in got.iter().zip(expected) {
        assert!((got - expected).abs() < 1e-7, "{what}: {got} {expected}");
    }
}

#[test]
fn fiala_is_that_of_another_program() {
    let basics = Basics {
        slip_stiffness: 193_929.0,
        cornering_stiffness: 50_000.0,
        friction: [0.9835, 0.5568],
        ..Basics::default()
    };
    let tire = Simple { basics, forces: Fiala { width: 0.318, moment: 1 } };
    for row in FIALA {
        agree(&tire.steady(&input(row[0], row[1], row[2])), &row[3..], &format!("{row:?}"));
    }
}

/// Both branches along meet at half of the friction, all slides across from the critical angle on; the printed moment starts
/// three times as steep as the usual one, which is that of a brush of the length 2 w under a parabolic pressure.
#[test]
fn fiala_has_its_corners_where_they_belong() {
    let basics = Basics {
        slip_stiffness: 6e4,
        cornering_stiffness: 4e4,
        friction: [0.9, 0.9],
        radius: 0.3,
        vertical: [2e5, 0.0],
        ..Basics::default()
    };
    let tire = Simple { basics: basics.clone(), forces: Fiala { width: 0.1, moment: 1 } };
    let printed = Simple { basics: basics.clone(), forces: Fiala { width: 0.1, moment: 2 } };
    let (load, most) = (3000.0, 2700.0);
    let critical: f64 = 0.5 * most / 6e4;
    for beside in [-1e-9, 1e-9] {
        let fx = tire.steady(&input(load, critical + beside, 0.0)).force[0];
        assert!((fx - 0.5 * most).abs() < 1e-3);
    }
    let end = (3.0 * most / 4e4_f64).atan();
    let sliding = tire.steady(&input(load, 0.0, -end));
    assert!((sliding.force[1] - most).abs() < 1e-9 && sliding.moment[2].abs() < 1e-12);
    let small = input(load, 0.0, 1e-6);
    let ratio = printed.steady(&small).moment[2] / tire.steady(&small).moment[2];
    assert!((ratio - 3.0).abs() < 1e-4);
    // the chord of the UA tire's circle is the length of its contact
    let length = 2.0 * (0.3_f64.powi(2) - (0.3 - load / 2e5_f64).powi(2)).sqrt();
    let brush = Simple { basics: basics.clone(), forces: Ua { camber_stiffness: 0.0 } };
    let wide = Simple { basics, forces: Fiala { width: 0.5 * length, moment: 1 } };
    for alpha in [0.01, 0.1, -0.15, 0.3] {
        let of = |law: &Steady| [law.force[1], law.moment[2]];
        let (a, b) =
            (of(&brush.steady(&input(load, 0.0, alpha))), of(&wide.steady(&input(load, 0.0, alpha))));
        assert!((a[0] - b[0]).abs() < 1e-9 && (a[1] - b[1]).abs() < 1e-9, "{alpha}: {a:?} {b:?}");
    }
}

#[test]
fn ua_is_the_integral_of_its_stresses() {
    let (radius, length) = (0.3_f64, 0.12);
    for row in UA {
        let load = row[0];
        // such a spring that the contact has that length
        let deflection = radius - (radius * radius - 0.25 * length * length).sqrt();
        let basics = Basics {
            slip_stiffness: 8e4,
            cornering_stiffness: 5e4,
            friction: [1.0, 0.7],
            radius,
            vertical: [load / deflection, 0.0],
            ..Basics::default()
        };
        let tire = Simple { basics, forces: Ua { camber_stiffness: 3000.0 } };
        let kappa = if row[1] > 0.0 { row[1] / (1.0 - row[1]) } else { row[1] };
        agree(&tire.steady(&input(load, kappa, row[2])), &row[3..], &format!("{row:?}"));
    }
}

fn at(once: f64, twice: f64) -> AtTwoLoads {
    AtTwoLoads { once, twice }
}

fn sedan() -> TmEasy {
    TmEasy {
        radius: 0.3266,
        vertical: [411_121.0, 0.0],
        nominal_load: 8562.8266,
        curves: [
            Curve {
                slope: at(151_447.29, 236_412.79),
                peak: at(7575.3614, 12_808.276),
                sliding: at(4657.9208, 8625.3352),
                peak_slip: at(0.12, 0.15),
                sliding_slip: at(0.9, 0.95),
            },
            Curve {
                slope: at(50_931.693, 94_293.847),
                peak: at(6615.0404, 12_509.947),
                sliding: at(6091.5092, 11_443.875),
                peak_slip: at(0.38786, 0.38786),
                sliding_slip: at(0.82534, 0.91309),
            },
        ],
        trail: Trail { ratio: at(0.178, 0.19), none: at(0.40726, 0.40726), end: at(0.82534, 0.91309) },
        ..TmEasy::default()
    }
}

#[test]
fn tmeasy_is_that_of_another_program() {
    let tire = sedan();
    for row in TMEASY {
        let kappa = row[2] / (1.0 - row[2]);
        let alpha = (-row[3] * (1.0 + kappa)).atan();
        let input = Input { friction: row[1], ..input(row[0], kappa, alpha) };
        agree(&tire.steady(&input), &row[4..], &format!("{row:?}"));
    }
}

/// k1 rho + k2 rho² there and back, and no curve that cannot be one.
#[test]
fn tmeasy_carries_its_load_and_refuses_curves_that_are_none() {
    let mut tire = sedan();
    tire.vertical = [149_545.979_551, 836_333.333_333];
    for load in [0.0, 150.382_312_885, 9000.0] {
        let deflection = tire.deflection(load, 0.0);
        let force = tire.normal_force(&Pressed { deflection, ..Pressed::default() });
        assert!((force - load).abs() < 1e-9 * (1.0 + load));
    }
    assert!((tire.deflection(150.382_312_885, 0.0) - 1e-3).abs() < 1e-12);
    tire.mount().unwrap();
    tire.curves[1].slope.twice = 5e4;
    let message = tire.mount().unwrap_err().to_string();
    assert!(message.contains("y_slope") && message.contains("twice the nominal load"), "{message}");

    // in order at both loads, and not below: a parabola and lines that fall through 0
    type Set = fn(&mut TmEasy);
    let low: [(Set, &str); 5] = [
        (
            |tire| tire.curves[0].peak.twice = 4.1 * tire.curves[0].peak.once,
            "x_peak_2 has to be less than four",
        ),
        (|tire| tire.curves[1].peak_slip = at(0.2, 0.41), "y_peak_slip_2 has to be less than twice"),
        (|tire| tire.curves[0].sliding_slip = at(0.2, 0.399), "x_sliding_slip falls below x_peak_slip"),
        (|tire| tire.trail.end = at(0.6, 1.1), "trail_end_slip"),
        (
            |tire| (tire.curves[0].peak, tire.curves[0].sliding) = (at(6000.0, 12000.0), at(5900.0, 8000.0)),
            "x_sliding is more than x_peak at little load",
        ),
    ];
    for (change, expected) in low {
        let mut tire = sedan();
        change(&mut tire);
        let message = tire.mount().unwrap_err().to_string();
        assert!(message.contains(expected), "{message}");
    }
}

/// Rolling resistance is the road's pressure before the axle: it needs no friction, and none pulls along or across.
#[test]
fn on_ice_only_rolling_resistance_is_left() {
    let basics = Basics {
        radius: 0.25,
        slip_stiffness: 6e4,
        cornering_stiffness: 4e4,
        friction: [0.9, 0.8],
        vertical: [2e5, 0.0],
        rolling_resistance: 0.02,
        ..Basics::default()
    };
    let easy = TmEasy { rolling_resistance: 0.02, ..sedan() };
    let ice = Input { friction: 0.0, ..input(3000.0, 0.1, 0.1) };
    let of = |lever: f64, steady: Steady| {
        assert_eq!(steady.force.map(f64::abs), [0.0; 2]);
        assert!((steady.moment[1] + 0.02 * lever * 3000.0).abs() < 1e-12, "{:?}", steady.moment);
        assert_eq!([steady.moment[0].abs(), steady.moment[2].abs()], [0.0; 2]);
    };
    let again = || {
        let mut copy = Basics::default();
        copy.clone_from(&basics);
        copy
    };
    of(0.25, Simple { basics: again(), forces: Linear }.steady(&ice));
    of(0.25, Simple { basics: again(), forces: Fiala { width: 0.1, moment: 1 } }.steady(&ice));
    of(0.25, Simple { basics: again(), forces: Ua { camber_stiffness: 0.0 } }.steady(&ice));
    of(0.3266, easy.steady(&ice));
}

/// A rig that starts in the stationary state of a wheel that creeps along stays in it.
#[test]
fn the_stationary_state_of_a_creeping_wheel_stays() {
    for tire in ["fiala", "ua", "tmeasy", "magic-formula"] {
        let mut rig = Shipped::new(
            &format!("{tire}-flat-track"),
            &[("path_speed", 0.15), ("slip", 0.01), ("slip_angle", 0.01), ("command_actuators", 0.0)],
        );
        let start = ["force_x", "force_y", "moment_y"].map(|name| rig.get(name));
        rig.step(5.0);
        let later = ["force_x", "force_y", "moment_y"].map(|name| rig.get(name));
        for (a, b) in start.iter().zip(later) {
            assert!((a - b).abs() < 1e-6 * (1.0 + b.abs()), "{tire}: {start:?} {later:?}");
        }
    }
}

/// A drive that keeps the spin tells at the start which torque it needs for that.
#[test]
fn a_drive_that_keeps_the_spin_has_its_torque_at_the_start() {
    let mut wheel = Shipped::new(
        "linear-wheel",
        &[
            ("drive", 2.0),
            ("initial_speed", 10.0),
            ("drive_speed", 46.0),
            ("axle_force_z", -6000.0 + 9.81 * 30.0),
            ("initial_load", 6000.0),
        ],
    );
    let at_start = wheel.get("drive_torque_actual");
    wheel.step(1e-3);
    let then = wheel.get("drive_torque_actual");
    assert!(at_start.abs() > 10.0 && (at_start / then - 1.0).abs() < 0.02, "{at_start} {then}");
}

#[test]
fn swift_is_that_of_other_programs() {
    let mut tire = Swift::default();
    let c = &mut tire.formula.coefficients;
    (c.unloaded_radius, c.longvl, c.fnomin) = (0.3943, 16.6, 6752.0);
    (c.breff, c.dreff, c.freff) = (6.217, 0.23778, 0.080544);
    tire.ring = Ring {
        qre0: 0.9997,
        qv1: 0.00062028,
        qv2: 0.034092,
        qfcx: -0.020112,
        qfcy: 0.26033,
        qfz1: 15.9753932596,
        qfz2: 20.7558,
        pfz1: 0.88241,
        pressure_change: 0.0,
        reference: 1,
    };
    for &[change, spin, fx, fy, loaded, expected, rolling] in SWIFT {
        tire.ring.pressure_change = change;
        let deflection = tire.radius() - loaded;
        let force = tire.normal_force(&Pressed { deflection, rate: 0.0, spin, force: [fx, fy] });
        assert!((force - expected).abs() < 1e-6, "{force} {expected}");
        if fx == 0.0 && fy == 0.0 {
            assert!((tire.rolling_radius(deflection, spin) - rolling).abs() < 1e-11);
            assert!((tire.deflection(force, spin) - deflection).abs() < 1e-12);
        }
    }
    // (2-26) is the slope of (2-24) at the nominal load
    tire.ring.pressure_change = 0.2;
    let deflection = tire.deflection(6752.0, 0.0);
    let force = |d: f64| tire.normal_force(&Pressed { deflection: d, ..Pressed::default() });
    let slope = (force(deflection + 1e-6) - force(deflection - 1e-6)) / 2e-6;
    // of the force that is inflated with the pressure at the nominal load without it, the slope at that deflection
    tire.ring.pressure_change = 0.0;
    let plain = tire.deflection(6752.0, 0.0);
    let at_measured = (tire.normal_force(&Pressed { deflection: plain + 1e-6, ..Pressed::default() })
        - tire.normal_force(&Pressed { deflection: plain - 1e-6, ..Pressed::default() }))
        / 2e-6;
    assert!((at_measured / tire.stiffness() - 1.0).abs() < 1e-8);
    assert!(slope > at_measured);
}

/// Friction bounds the linear tire, which points where the unbounded force does.
#[test]
fn the_linear_tire_ends_at_its_friction() {
    let basics =
        Basics { slip_stiffness: 6e4, cornering_stiffness: 4e4, friction: [0.9, 0.9], ..Basics::default() };
    let tire = Simple { basics, forces: Linear };
    let small = tire.steady(&input(3000.0, 0.01, 0.02)).force;
    assert_eq!(small, [600.0, -800.0]);
    let large = tire.steady(&input(3000.0, 0.3, 0.6)).force;
    assert!((large[0].hypot(large[1]) - 2700.0).abs() < 1e-9);
    assert!((large[0] / large[1] - small[0] / small[1]).abs() < 1e-12);
}

/// On rigs: a wheel carries its load, a braked corner stops with friction at most and stays, a standing wheel swings with the
/// stiffness of the tire.
fn on_rigs(tire: &str) {
    let mut wheel = Shipped::new(
        &format!("{tire}-wheel"),
        &[("axle_force_z", -6000.0 + 9.81 * 30.0), ("initial_load", 6000.0)],
    );
    assert_eq!(wheel.get("stationary_start"), 1.0);
    wheel.step(0.5);
    assert!((wheel.get("force_z") - 6000.0).abs() < 30.0, "{}: {}", tire, wheel.get("force_z"));
    let mut corner = Shipped::new(&format!("{tire}-corner"), &[("brake_torque", 9000.0)]);
    corner.step(1.0);
    let (load, braked) = (corner.get("force_z"), -corner.get("vehicle_acceleration") * 420.0);
    assert!(braked > 0.5 * load && braked < 1.2 * load, "{}: {braked} {load}", tire);
    corner.step(20.0);
    let distance = corner.get("vehicle_distance");
    corner.step(2.0);
    assert!((corner.get("vehicle_distance") - distance).abs() < 1e-3, "{} creeps", tire);
}

#[test]
fn classic_tires_roll_brake_and_stand() {
    for tire in ["linear", "fiala", "ua", "tmeasy", "swift"] {
        on_rigs(tire);
    }
}

/// m z'' + c z' + k z = 0 has the period 2 pi / sqrt(k/m - (c/2m)²).
#[test]
fn the_linear_tire_swings_with_its_own_period() {
    let (mass, stiffness, damping) = (600.0, 5e5, 1400.0_f64);
    let mut rig = Shipped::new(
        "linear-hydropulse",
        &[("force", 1000.0), ("wheel_mass", mass), ("command_actuators", 0.0)],
    );
    let start = rig.get("piston_position");
    rig.set("force", 2000.0);
    let end = start + 1000.0 / stiffness;
    let mut crossings = Vec::new();
    let mut last = rig.get("piston_position") - end;
    for n in 1..1000 {
        rig.step(1e-3);
        let now = rig.get("piston_position") - end;
        if last < 0.0 && now >= 0.0 {
            crossings.push(1e-3 * (f64::from(n) - now / (now - last)));
        }
        last = now;
    }
    let period = crossings[2] - crossings[1];
    let expected = std::f64::consts::TAU / (stiffness / mass - (0.5 * damping / mass).powi(2)).sqrt();
    assert!((period / expected - 1.0).abs() < 2e-4, "{period} {expected}");
}
