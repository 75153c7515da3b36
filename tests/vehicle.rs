//! Tires on hubs and vehicles against closed forms: stopping distance, energy, the quarter vehicle of
//! the textbook, and the same stationary state on the flat track.
#![allow(missing_docs, clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod common;

use common::{advance, assert_close, get, set, started};
use latsch::model::{Native, Slave};
use latsch::rig::{RingBrushCorner, RingBrushFlatTrack, RingBrushWheel};

type Corner = Native<RingBrushCorner>;
type Wheel = Native<RingBrushWheel>;

const GRAVITY: f64 = 9.81;
/// Of corner and belt \[kg\].
const MASS: f64 = 428.8;

/// A corner whose friction does not depend on the pressure.
fn plain_corner(friction: f64, more: &[(&str, f64)]) -> Corner {
    let mut values = vec![
        ("rolling_resistance_lever", 0.0),
        ("friction_static_zero", friction),
        ("friction_static_reference", friction),
        ("friction_sliding_zero", friction),
        ("friction_sliding_reference", friction),
    ];
    values.extend(more);
    started(&values)
}

/// Locks the wheel, then measures from 0.3 s on: (speed there, distance from there to standstill).
fn locked_stop(corner: &mut Corner) -> (f64, f64) {
    const TICK: f64 = 1e-3;
    set(corner, &[("brake_torque", 1e4)]);
    advance(corner, TICK, 0, 300);
    assert_eq!(get(corner, "wheel_speed"), 0.0);
    let (speed, place) = (get(corner, "vehicle_speed"), get(corner, "vehicle_distance"));
    for k in 300.. {
        let before = get(corner, "vehicle_speed");
        advance(corner, TICK, k, k + 1);
        let after = get(corner, "vehicle_speed");
        if after <= 0.0 {
            // where between the points the speed went through zero does not matter: 1e-3 s at 1e-2 m/s
            assert!(before < 0.1);
            return (speed, get(corner, "vehicle_distance") - place);
        }
    }
    unreachable!()
}

#[test]
fn a_locked_wheel_stops_after_the_distance_of_constant_deceleration() {
    for friction in [0.3, 1.0] {
        let mut corner = plain_corner(friction, &[("initial_speed", 20.0)]);
        let (speed, distance) = locked_stop(&mut corner);
        assert_close("stopping distance", distance, speed * speed / (2.0 * friction * GRAVITY), 1e-3);
    }
}

#[test]
fn friction_that_falls_with_the_sliding_speed_stops_later_by_just_that() {
    let (friction, falloff) = (0.9, 0.02);
    let mut corner = plain_corner(friction, &[("initial_speed", 20.0), ("friction_speed_falloff", falloff)]);
    let (speed, distance) = locked_stop(&mut corner);
    // m v dv/ds = -friction m g / (1 + falloff v)
    let expected = (speed.powi(2) / 2.0 + falloff * speed.powi(3) / 3.0) / (friction * GRAVITY);
    assert_close("stopping distance", distance, expected, 1e-3);
}

#[test]
fn the_friction_factor_scales_the_deceleration_of_a_locked_wheel() {
    let mut corner = plain_corner(1.0, &[("initial_speed", 20.0), ("friction_factor", 0.25)]);
    let (speed, distance) = locked_stop(&mut corner);
    assert_close("stopping distance", distance, speed * speed / (2.0 * 0.25 * GRAVITY), 1e-3);
}

#[test]
fn friction_patches_act_where_they_lie() {
    let mut corner: Corner = Native::new(&Default::default()).unwrap();
    set(&mut corner, &[("initial_speed", 20.0)]);
    let index = corner.find("road_friction").unwrap();
    corner.set_text(index, "0 1; 10 0.3; 15 1").unwrap();
    corner.start(0.0, None).unwrap();
    corner.finish_start().unwrap();
    set(&mut corner, &[("brake_torque", 1e4)]);
    let mut forces = Vec::new();
    for k in 0..1500 {
        advance(&mut corner, 1e-3, k, k + 1);
        forces.push((get(&mut corner, "vehicle_distance"), -get(&mut corner, "patch_force_x")));
    }
    let mean = |from: f64, to: f64| {
        let inside: Vec<f64> = forces.iter().filter(|(s, _)| *s > from && *s < to).map(|f| f.1).collect();
        inside.iter().sum::<f64>() / inside.len() as f64
    };
    assert_close("on the patch", mean(11.0, 14.0), 0.3 * mean(6.0, 9.0), 5e-3);
    assert_close("behind it", mean(16.5, 19.0), mean(6.0, 9.0), 5e-3);
}

/// Kinetic and potential energy of vehicle and hub \[J\], without the belt.
fn energy(corner: &mut Corner) -> f64 {
    let mut at = |name| get(corner, name);
    let (hub, sprung, vehicle) = (at("hub_mass"), at("sprung_mass"), at("vehicle_mass"));
    let kinetic = 0.5 * (vehicle - hub) * at("vehicle_speed").powi(2)
        + 0.5 * sprung * at("body_velocity_z").powi(2)
        + 0.5 * hub * (at("wheel_velocity_x").powi(2) + at("wheel_velocity_z").powi(2))
        + 0.5 * at("hub_inertia") * at("wheel_speed").powi(2);
    let springs = 0.5 * at("fore_aft_stiffness") * at("wheel_fore_aft").powi(2)
        + 0.5 * at("suspension_stiffness") * (at("body_height") - at("wheel_height")).powi(2);
    kinetic + springs + (hub + sprung) * GRAVITY * at("wheel_height")
}

/// Braked over a cleat, to below the limit and beyond it: what the masses and springs lose is what
/// brake, dampers and tire took. Returns the residual over the energy lost.
fn energy_residual(torque: f64, step: f64) -> f64 {
    let mut corner: Corner = started(&[
        ("step_size", step),
        ("initial_speed", 20.0),
        ("road_kind", 4.0),
        ("road_start", 4.0),
        ("road_length", 0.5),
        ("road_height", 0.02),
    ]);
    let (mut before, mut by_tire) = (None, 0.0);
    let start = energy(&mut corner);
    set(&mut corner, &[("brake_torque", torque)]);
    let steps = (0.5 / step).round() as u32;
    for k in 0..steps {
        let mut at = |name| get(&mut corner, name);
        let power = at("force_x") * at("wheel_velocity_x")
            + at("force_z") * at("wheel_velocity_z")
            + at("moment_y") * at("wheel_speed");
        by_tire += before.map_or(0.0, |p: f64| 0.5 * step * (p + power));
        before = Some(power);
        if k + 1 < steps {
            advance(&mut corner, step, k, k + 1);
        }
    }
    let end = energy(&mut corner);
    let mut at = |name| get(&mut corner, name);
    let lost = at("brake_energy") + at("damper_energy");
    ((end - start) - (by_tire - lost)) / (start - end)
}

#[test]
fn energy_that_the_vehicle_loses_is_in_brake_dampers_and_tire() {
    for torque in [700.0, 4000.0] {
        let [coarse, fine] = [1e-4, 5e-5].map(|step| energy_residual(torque, step).abs());
        assert!(fine < 1e-4, "{torque} N.m: {coarse:.1e} {fine:.1e}");
        assert!(fine < 0.7 * coarse, "{torque} N.m: falls with the step, {coarse:.1e} {fine:.1e}");
    }
}

#[test]
fn a_locked_tire_turns_what_it_takes_into_heat() {
    let mut corner: Corner = started(&[("initial_speed", 25.0)]);
    set(&mut corner, &[("brake_torque", 1e4)]);
    advance(&mut corner, 1e-3, 0, 300);
    let speed = get(&mut corner, "vehicle_speed");
    let heat = get(&mut corner, "friction_energy");
    advance(&mut corner, 1e-3, 300, 1500);
    let (after, more) = (get(&mut corner, "vehicle_speed"), get(&mut corner, "friction_energy"));
    let lost = 0.5 * MASS * (speed * speed - after * after);
    assert_close("friction heat", more - heat, lost, 1e-3);
}

#[test]
fn a_braked_wheel_settles_where_the_flat_track_has_the_same_forces() {
    // brake torque and a push that keeps the speed: a stationary state of the free wheel
    let (load, torque) = (4000.0, 400.0);
    let mut wheel: Wheel = started(&[
        ("initial_load", load),
        ("initial_speed", 15.0),
        ("axle_force_z", 30.0 * GRAVITY - load),
        ("antisymmetric_coupling", 1.0),
        // the flat track starts with a continuum
        ("bristles_per_stripe", 60.0),
        ("bristle_length", 0.007),
        ("bristle_stiffness", 2e4),
        ("bristle_damping", 0.325),
    ]);
    set(&mut wheel, &[("brake_torque", torque)]);
    for k in 0..4000 {
        let push = 3e3 * (15.0 - get(&mut wheel, "velocity_x")) - get(&mut wheel, "force_x");
        set(&mut wheel, &[("axle_force_x", push)]);
        advance(&mut wheel, 1e-3, k, k + 1);
    }
    let mut at = |name| get(&mut wheel, name);
    let state = [
        ("slip", at("slip")),
        ("deflection", at("tire_radius") - at("position_z")),
        ("path_speed", at("velocity_x")),
        ("antisymmetric_coupling", 1.0),
    ];
    let mut track: Native<RingBrushFlatTrack> = started(&state);
    assert_close("vertical force", at("force_z"), load, 2e-3);
    assert_close("spin", at("moment_y"), torque, 5e-3);
    assert!(at("slip") < -0.003);
    for name in ["force_x", "force_z", "moment_y"] {
        assert_close(name, at(name), get(&mut track, name), 5e-3);
    }
}

#[test]
fn a_braked_wheel_on_a_slope_stands_without_drift() {
    let mut wheel: Wheel = started(&[
        ("initial_speed", 0.0),
        ("road_kind", 3.0),
        ("road_start", -10.0),
        ("road_length", 100.0),
        ("road_height", 1.0),
        ("brake_torque", 500.0),
    ]);
    // the weight of hub and load down the slope, like a vehicle parked on it
    set(&mut wheel, &[("axle_force_x", -38.0)]);
    advance(&mut wheel, 1e-3, 0, 2000);
    let place = get(&mut wheel, "position_x");
    advance(&mut wheel, 1e-3, 2000, 6000);
    assert_eq!(get(&mut wheel, "wheel_speed"), 0.0);
    assert!((get(&mut wheel, "position_x") - place).abs() < 1e-5);
}

/// Amplitude of the fundamental over the last periods.
fn amplitude(values: &[f64], period: f64, interval: f64) -> f64 {
    let whole = ((values.len() as f64 * interval / period).floor() * period / interval).round() as usize;
    let tail = &values[values.len() - whole..];
    let (mut sine, mut cosine) = (0.0, 0.0);
    for (k, value) in tail.iter().enumerate() {
        let (s, c) = (std::f64::consts::TAU * k as f64 * interval / period).sin_cos();
        sine += s * value;
        cosine += c * value;
    }
    2.0 * sine.hypot(cosine) / tail.len() as f64
}

#[test]
fn on_waves_the_corner_is_the_quarter_vehicle_of_the_textbook() {
    use nalgebra::{Complex, Matrix2, Vector2};
    const INTERVAL: f64 = 1e-3;
    for (wavelength, speed) in [(8.0, 10.0), (2.5, 10.0), (1.5, 15.0)] {
        let height = 0.004;
        let mut corner: Corner = started(&[
            ("initial_speed", speed),
            ("vehicle_mass", 1e5), // rolls on
            ("road_kind", 5.0),
            ("road_start", 1.0),
            ("road_length", wavelength),
            ("road_height", height),
        ]);
        let (mut body, mut wheel) = (Vec::new(), Vec::new());
        let mut penetration = 0.0;
        for k in 0..6000 {
            advance(&mut corner, INTERVAL, k, k + 1);
            if k == 50 {
                penetration = get(&mut corner, "belt_deflection");
            }
            if k >= 3000 {
                body.push(get(&mut corner, "body_height"));
                wheel.push(get(&mut corner, "wheel_height"));
            }
        }
        // linear quarter vehicle: tire spring tangent in series with the side wall, belt and hub as one
        let tangent = 1.54e5 + 2.0 * 2.47e6 * penetration;
        let tire = 1.0 / (1.0 / tangent + 1.0 / 4.67e6);
        let share = (tire / tangent).powi(2);
        let omega = std::f64::consts::TAU * speed / wavelength;
        let real = |x: f64| Complex::new(x, 0.0);
        let spring = Complex::new(38e3, 2600.0 * omega);
        let road = Complex::new(tire, share * 83.0 * omega);
        let matrix = Matrix2::new(
            spring - real(380.0 * omega * omega),
            -spring,
            -spring,
            spring + road - real(48.8 * omega * omega),
        );
        let a = std::f64::consts::TAU * 0.1 / wavelength;
        let gain = a.sin() / (a * (1.0 - (a / std::f64::consts::PI).powi(2)));
        let answer = matrix.try_inverse().unwrap() * Vector2::new(real(0.0), road);
        let period = wavelength / speed;
        for (what, values, expected) in [("body", &body, answer[0]), ("wheel", &wheel, answer[1])] {
            let expected = expected.norm() * gain * height / 2.0;
            assert_close(what, amplitude(values, period, INTERVAL), expected, 0.03);
        }
    }
}

#[test]
fn a_drop_takes_the_wheel_off_the_road_and_a_ramp_lifts_the_vehicle() {
    let mut corner: Corner =
        started(&[("initial_speed", 22.0), ("road_kind", 2.0), ("road_start", 4.0), ("road_height", -0.08)]);
    let mut least = f64::INFINITY;
    for k in 0..400 {
        advance(&mut corner, 1e-3, k, k + 1);
        least = least.min(get(&mut corner, "patch_force_z"));
    }
    assert_eq!(least, 0.0);

    let mut corner: Corner = started(&[
        ("initial_speed", 10.0),
        ("road_kind", 3.0),
        ("road_start", 2.0),
        ("road_length", 5.0),
        ("road_height", 0.2),
    ]);
    advance(&mut corner, 1e-3, 0, 4000);
    assert_close("height", get(&mut corner, "body_height"), 0.2, 1e-3);
    assert_close("force", get(&mut corner, "force_z"), 420.0 * GRAVITY, 1e-3);
    // the vehicle paid for its new height with speed; rolling resistance and dampers took little
    let speed = get(&mut corner, "vehicle_speed");
    let paid = 0.5 * MASS * (100.0 - speed * speed) - MASS * GRAVITY * 0.2;
    let rolling = 130.0 * get(&mut corner, "vehicle_distance");
    assert!((0.0..1.2 * rolling).contains(&paid), "{paid} J beyond the height, rolling took about {rolling}");
}

#[test]
fn on_a_road_without_grip_wheels_start_at_the_speed_of_rolling() {
    for factor in [0.0, 1e-6, 1e-4, 1e-3, 0.01] {
        let mut corner: Corner = started(&[("initial_speed", 20.0), ("friction_factor", factor)]);
        let mut wheel: Wheel = started(&[("initial_speed", 20.0), ("friction_factor", factor)]);
        assert_close("corner", get(&mut corner, "wheel_speed"), 20.0 / 0.328, 0.05);
        assert_close("wheel", get(&mut wheel, "wheel_speed"), 20.0 / 0.328, 0.05);
        advance(&mut corner, 1e-3, 0, 100);
        advance(&mut wheel, 1e-3, 0, 100);
        assert_close("speed", get(&mut corner, "vehicle_speed"), 20.0, 1e-3);
    }
}

#[test]
fn a_wheel_starts_free_of_torque_or_it_is_said() {
    let mut seen = [0, 0];
    for factor in [0.0, 0.01, 0.015, 0.02, 0.03, 0.2, 1.0] {
        for (speed, load) in [(20.0, 4100.0), (-20.0, 4100.0), (60.0, 8000.0)] {
            let mut wheel: Wheel =
                started(&[("initial_speed", speed), ("initial_load", load), ("friction_factor", factor)]);
            let left = get(&mut wheel, "moment_y");
            let free = get(&mut wheel, "stationary_start") == 1.0;
            let case = format!("factor {factor}, {speed} m/s, {load} N: {left} N.m, free: {free}");
            assert_eq!(free, left.abs() < 1e-6 * load, "{case}");
            assert_eq!(free, wheel.warning().is_none(), "{case}");
            assert!(wheel.warning().is_none_or(|w| w.contains("rolling resistance")), "{case}");
            seen[usize::from(free)] += 1;
        }
    }
    assert!(seen.iter().all(|n| *n > 4), "{seen:?}");
}

/// What is said at the start with these values.
fn refused<M: latsch::model::Model>(values: &[(&str, f64)]) -> String {
    let mut slave: Native<M> = Native::new(&Default::default()).unwrap();
    set(&mut slave, values);
    slave.start(0.0, None).unwrap();
    slave.finish_start().err().map(|e| e.to_string()).unwrap_or_default()
}

#[test]
fn steps_that_are_too_long_for_the_parameters_are_refused_at_the_start() {
    type C = RingBrushCorner;
    type W = RingBrushWheel;
    for (message, names) in [
        (refused::<C>(&[("fore_aft_damping", 1e6)]), ["fore_aft_damping", "hub_mass"]),
        (refused::<C>(&[("fore_aft_stiffness", 1e9), ("hub_mass", 1.0)]), ["fore_aft_stiffness", "hub_mass"]),
        (refused::<C>(&[("suspension_damping", 1e6)]), ["suspension_damping", "hub_mass"]),
        (refused::<C>(&[("hub_mass", 0.1), ("step_size", 1e-4)]), ["fore_aft_damping", "hub_mass"]),
        (
            refused::<W>(&[("hub_inertia", 1e-3), ("step_size", 1e-4)]),
            ["sidewall_windup_damping", "hub_inertia"],
        ),
        (refused::<W>(&[("hub_mass", 0.1), ("step_size", 5e-4)]), ["sidewall_radial", "hub_mass"]),
    ] {
        for word in names.iter().chain(&["step_size = ", "at most"]) {
            assert!(message.contains(word), "{word}: {message:?}");
        }
    }
    // up to the limit it runs
    for values in [
        [("fore_aft_damping", 3.4e5), ("hub_mass", 40.0)],
        [("fore_aft_stiffness", 1e9), ("hub_mass", 40.0)],
        [("suspension_damping", 1e5), ("hub_mass", 40.0)],
    ] {
        let mut corner: Corner = started(&[&values[..], &[("step_size", 1e-4)]].concat());
        set(&mut corner, &[("brake_torque", 500.0)]);
        advance(&mut corner, 1e-3, 0, 300);
        assert!(get(&mut corner, "vehicle_speed") < 27.5);
    }
    // a damper that is made stiffer on the way is seen as well
    let mut corner: Corner = started(&[]);
    set(&mut corner, &[("fore_aft_damping", 1e6)]);
    let message = corner.step(0.0, 1e-3).unwrap_err().to_string();
    assert!(message.contains("fore_aft_damping"), "{message}");
}

/// On a grade the whole weight climbs, also that of the mass which stands on other wheels: a vehicle that
/// rolls freely is slowed down by g times the slope, but for what the spinning wheel adds to its inertia.
#[test]
fn the_whole_mass_that_a_corner_brakes_climbs_a_grade() {
    for vehicle_mass in [420.0, 690.0] {
        let mut corner = plain_corner(
            1.0,
            &[
                ("vehicle_mass", vehicle_mass),
                ("road_kind", 3.0),
                ("road_height", 1.0),
                ("road_length", 20.0),
                ("road_start", 2.0),
                ("initial_speed", 5.0),
            ],
        );
        advance(&mut corner, 1e-3, 0, 1500);
        let before = get(&mut corner, "vehicle_speed");
        advance(&mut corner, 1e-3, 1500, 2500);
        let mean = get(&mut corner, "vehicle_speed") - before;
        let mass = vehicle_mass + 8.8;
        let spinning = (0.7 + 0.928) / 0.328_f64.powi(2);
        assert_close("acceleration", mean, -0.05 * GRAVITY * mass / (mass + spinning), 0.01);
    }
}
