//! The tire by itself on planes that the master gives: what holds however the road lies.
#![allow(missing_docs, clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod common;

use common::{assert_close, get, set, started};
use latsch::Error;
use latsch::model::{Model, Native, Settings, Slave};
use latsch::rig::{RingBrushFlatTrack, RingBrushTire};
use latsch::tire::Motion;
use nalgebra::{Matrix3, Rotation3, Vector3};

type Bare = Native<RingBrushTire>;

const NAMES: [&str; 12] = [
    "rim_x",
    "rim_y",
    "rim_z",
    "rim_camber",
    "rim_spin",
    "rim_steer",
    "rim_velocity_x",
    "rim_velocity_y",
    "rim_velocity_z",
    "rim_camber_rate",
    "rim_spin_rate",
    "rim_steer_rate",
];

fn values(rim: &Motion<f64>) -> Vec<(&'static str, f64)> {
    let numbers = rim.position.iter().chain(&rim.angles).chain(&rim.velocity).chain(&rim.rates);
    NAMES.into_iter().zip(numbers.copied()).collect()
}

fn vector(tire: &mut Bare, name: &str) -> Vector3<f64> {
    Vector3::from_iterator(["x", "y", "z"].map(|axis| get(tire, &format!("global_{name}_{axis}"))))
}

/// A rim on a manoeuvre over a level road: drifting, braked, cambered and steered, going up and down.
fn manoeuvre(t: f64) -> Motion<f64> {
    let (slow, fast) = (12.0 * t, 60.0 * t);
    Motion {
        position: Vector3::new(15.0 * t, 0.6 * t, 0.316 + 0.003 * fast.cos()),
        velocity: Vector3::new(15.0, 0.6, -0.18 * fast.sin()),
        angles: Vector3::new(0.05 * slow.sin(), 44.0 * t, 0.03 + 0.01 * slow.sin()),
        rates: Vector3::new(0.6 * slow.cos(), 44.0, 0.12 * slow.cos()),
    }
}

/// Force and moment on the rim at the end, in the axes of the road, which is turned by `axes`.
fn end_of_manoeuvre(axes: &Matrix3<f64>, interval: f64, step: f64) -> [Vector3<f64>; 2] {
    let at = |t: f64| manoeuvre(t).turned(axes);
    let normal = axes * Vector3::z();
    let mut start = values(&at(0.0));
    start.extend([
        ("road_slope_x", -normal.x / normal.z),
        ("road_slope_y", -normal.y / normal.z),
        ("gravity", 0.0),
        ("antisymmetric_coupling", 1.0),
        ("step_size", step),
    ]);
    let mut tire: Bare = started(&start);
    for k in 0..(0.25 / interval).round() as u32 {
        let t = f64::from(k) * interval;
        set(&mut tire, &values(&at(t)));
        tire.step(t, f64::from(k + 1) * interval - t).unwrap();
    }
    ["force", "moment"].map(|name| axes.transpose() * vector(&mut tire, name))
}

#[test]
fn a_tilted_road_with_a_tilted_rim_is_a_level_road() {
    let tilted: Matrix3<f64> = *Rotation3::from_euler_angles(0.08, -0.12, 0.3).matrix();
    let difference = |step: f64| {
        let [level, on_tilted] =
            [Matrix3::identity(), tilted].map(|axes| end_of_manoeuvre(&axes, step, step));
        assert!(level[0].z > 1000.0 && level[0].x < -1000.0 && level[0].y.abs() > 300.0, "{level:?}");
        ((on_tilted[0] - level[0]).norm() / level[0].norm())
            .max((on_tilted[1] - level[1]).norm() / level[1].norm())
    };
    let [coarse, fine] = [1e-4, 2.5e-5].map(difference);
    assert!(coarse < 3e-3, "{coarse:.1e}");
    // it is the same but for the steps' errors in other angles
    assert!(fine < 0.5 * coarse, "{fine:.1e} after {coarse:.1e}");
}

#[test]
fn the_point_of_the_plane_may_lie_anywhere_in_it() {
    let slope = [0.05, -0.02];
    let force = |x: f64, y: f64| {
        let mut tire: Bare = started(&[
            ("road_slope_x", slope[0]),
            ("road_slope_y", slope[1]),
            ("road_x", x),
            ("road_y", y),
            ("road_height", slope[0] * x + slope[1] * y),
        ]);
        common::advance(&mut tire, 1e-3, 0, 100);
        vector(&mut tire, "force")
    };
    let difference = force(0.0, 0.0) - force(30.0, -7.0);
    assert!(difference.norm() < 1e-6, "{difference}");
}

#[test]
fn a_road_that_rises_under_a_resting_rim_is_a_rim_that_sinks() {
    let ends = [("road_height", 1.0), ("rim_z", -1.0)].map(|(name, sign)| {
        let mut tire: Bare = started(&[("rim_velocity_x", 0.0), ("rim_spin_rate", 0.0)]);
        let (index, start) = (tire.find(name).unwrap(), get(&mut tire, name));
        for k in 0..500 {
            let t = f64::from(k) * 1e-3;
            tire.set(index, start + sign * 0.02 * t).unwrap();
            if name == "rim_z" {
                set(&mut tire, &[("rim_velocity_z", sign * 0.02)]);
            } else {
                tire.set_rate(index, sign * 0.02).unwrap();
            }
            tire.step(t, f64::from(k + 1) * 1e-3 - t).unwrap();
        }
        get(&mut tire, "global_force_z")
    });
    // the belt's ringing at the beginning is another, and over
    assert_close("force", ends[0], ends[1], 1e-4);
}

#[test]
fn a_pose_runs_on_with_its_velocity_between_communication_points() {
    // a steady motion: how often it is told does not matter
    let force = |interval: f64| end_of_manoeuvre(&Matrix3::identity(), interval, 1e-4);
    let [reference, fine, coarse] = [1e-4, 1e-3, 2e-3].map(force);
    let error = |e: &[Vector3<f64>; 2]| (e[0] - reference[0]).norm() / reference[0].norm();
    // half an acceleration times the interval squared: 10.8 m/s² of 1 ms are 5 um, 25 N at 4.67e6 N/m
    assert!(error(&fine) < 0.02, "{}", error(&fine));
    assert!(error(&coarse) > 1.5 * error(&fine), "{} {}", error(&coarse), error(&fine));

    let mut tire: Bare = started(&[]);
    common::advance(&mut tire, 1e-3, 0, 500);
    let told = get(&mut tire, "rim_spin");
    assert_close("spin angle", told, 0.5 * 10.0 / 0.328, 1e-9);
    assert!(get(&mut tire, "global_force_x").abs() < 200.0, "it rolls freely");
}

/// The belt swings on its side wall behind a rim that is led; steps that are too long for it are refused.
#[test]
fn steps_too_long_for_the_belt_are_refused() {
    fn start<M: Model>(stiffness: f64) -> Result<Native<M>, Error> {
        let mut slave = Native::<M>::new(&Settings::default()).unwrap();
        set(&mut slave, &[("sidewall_radial_stiffness", stiffness), ("sidewall_radial_damping", 0.0)]);
        slave.start(0.0, None)?;
        slave.finish_start()?;
        Ok(slave)
    }
    // of the belt alone: K h^2 / m = 4
    let mut rig = start::<RingBrushFlatTrack>(4.67e6).unwrap();
    let limit = 4.0 * get(&mut rig, "belt_mass") / get(&mut rig, "step_size").powi(2);
    for message in [
        start::<RingBrushFlatTrack>(1.01 * limit).err().unwrap().to_string(),
        start::<RingBrushTire>(1.01 * limit).err().unwrap().to_string(),
    ] {
        assert!(message.contains("too long for sidewall_radial_stiffness"), "{message}");
        assert!(message.contains("belt_mass"), "{message}");
    }
    assert!(
        start::<RingBrushFlatTrack>(0.99 * limit).is_ok() && start::<RingBrushTire>(0.99 * limit).is_ok()
    );
}
