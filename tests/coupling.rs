//! How far apart the communication points of the bare tire may lie: a free rim in its master, coupled
//! by explicit exchange. docs/tires-on-vehicles.md prints what is measured here.
#![allow(missing_docs, clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod common;

use common::{get, started};
use latsch::model::{Native, Slave};
use latsch::rig::RingBrushTire;

type Bare = Native<RingBrushTire>;

/// Which motion of the rim is free; the others are imposed.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Free {
    /// Up and down, under a load of 4 kN.
    Vertical,
    /// Along the road.
    Longitudinal,
    /// About the wheel's axis.
    Spin,
}

/// Who steps first.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Order {
    /// Both with the other's values of the communication point.
    SideBySide,
    /// The tire, then the rim with the new force.
    TireFirst,
}

const SPEED: f64 = 20.0;
const RADIUS: f64 = 0.328;

/// Runs a second after a small push and returns how much larger the motion is in its last tenth than
/// in its second tenth. `inertia` is a mass \[kg\] or, for the spin, a moment of inertia \[kg.m²\].
fn growth(free: Free, order: Order, inertia: f64, interval: f64) -> f64 {
    let mut tire: Bare = started(&[
        ("rim_z", 0.319),
        ("rim_velocity_x", SPEED),
        ("rim_spin_rate", SPEED / RADIUS),
        ("antisymmetric_coupling", 1.0),
        ("step_size", if interval < 1e-4 { interval } else { 1e-4 }),
    ]);
    let (force, pose, velocity) = match free {
        Free::Vertical => ("global_force_z", "rim_z", "rim_velocity_z"),
        Free::Longitudinal => ("global_force_x", "rim_x", "rim_velocity_x"),
        Free::Spin => ("spin_moment", "rim_spin", "rim_spin_rate"),
    };
    let index = [force, pose, velocity].map(|name| tire.find(name).unwrap());
    let balance = get(&mut tire, force);
    let mut v = tire.get(index[2]).unwrap() + 1e-3;
    let mut x = tire.get(index[1]).unwrap();
    let v0 = v;
    let count = (1.0 / interval).round() as u32;
    let (mut early, mut late) = (0.0_f64, 0.0_f64);
    for k in 0..count {
        let t = f64::from(k) * interval;
        let before = tire.get(index[0]).unwrap();
        tire.set(index[1], x).unwrap();
        tire.set(index[2], v).unwrap();
        let stepped = tire.step(t, f64::from(k + 1) * interval - t);
        let after = if stepped.is_ok() { tire.get(index[0]).unwrap() } else { f64::NAN };
        let acting = if order == Order::SideBySide { before } else { after };
        let acceleration = (acting - balance) / inertia;
        x += interval * v + 0.5 * interval * interval * acceleration;
        v += interval * acceleration;
        if !(v - v0).is_finite() || (v - v0).abs() > 10.0 {
            return f64::INFINITY;
        }
        let share = f64::from(k) / f64::from(count);
        let swing = acceleration.abs();
        if (0.1..0.2).contains(&share) {
            early = early.max(swing);
        } else if share >= 0.9 {
            late = late.max(swing);
        }
    }
    late / early
}

/// Size, then the largest stable interval \[s\] side by side and with the tire first: the table of the
/// docs, rounded down.
const VERTICAL: [(f64, f64, f64); 3] =
    [(10.0, 0.37e-3, 1.9e-3), (20.0, 0.58e-3, 2.6e-3), (80.0, 0.84e-3, 5.3e-3)];
const LONGITUDINAL: [(f64, f64, f64); 2] = [(10.0, 0.72e-3, 1.9e-3), (20.0, 1.1e-3, 3.6e-3)];
const SPIN: [(f64, f64, f64); 2] = [(0.5, 0.39e-3, 1.3e-3), (1.0, 0.83e-3, 1.9e-3)];

#[test]
fn the_documented_communication_steps_are_the_largest_stable_ones() {
    for (free, table) in
        [(Free::Vertical, &VERTICAL[..]), (Free::Longitudinal, &LONGITUDINAL), (Free::Spin, &SPIN)]
    {
        for &(size, side_by_side, tire_first) in table {
            for (order, largest) in [(Order::SideBySide, side_by_side), (Order::TireFirst, tire_first)] {
                let stable = |share: f64| growth(free, order, size, share * largest) < 1.0;
                assert!(
                    [0.7, 1.0].into_iter().all(stable),
                    "{free:?} {order:?} {size}: unstable up to {largest} s"
                );
                assert!(
                    ![1.06, 1.12].into_iter().all(stable),
                    "{free:?} {order:?} {size}: stable beyond {largest} s"
                );
            }
        }
    }
}

/// With the tire first, the exchange is symplectic Euler for the springs of the side wall between rim
/// and belt, whose limit is twice the reciprocal of their frequency; dampers and the rim's own
/// movement on the road shift it a little.
#[test]
fn a_light_rim_has_the_limit_of_the_side_wall() {
    for (mass, _, largest) in &VERTICAL[..2] {
        let reduced = mass * 8.8 / (mass + 8.8);
        let limit = 2.0 * (reduced / 4.67e6_f64).sqrt();
        assert!((largest / limit - 1.0).abs() < 0.15, "{mass} kg: {largest} s, {limit} s");
    }
}

/// A heavy rim hops on the tire with little damping: side by side the held force takes k T / 2 of
/// that, and the limit is where nothing is left.
#[test]
fn a_heavy_rim_has_the_limit_of_the_tires_damping() {
    let penetration = 0.019;
    let stiffness = 1.0 / (1.0 / (1.54e5 + 2.0 * 2.47e6 * penetration) + 1.0 / 4.67e6);
    let limit = 2.0 * 83.0 / stiffness;
    let (mass, largest, _) = VERTICAL[2];
    assert!((largest / limit - 1.0).abs() < 0.3, "{mass} kg: {largest} s, {limit} s");
}
