//! What parameters do to a stop (Mack 2009, chapter 6.1): each in the direction in which the source has it. The sizes differ from those of the
//! specification's placeholder rig, which has no combined slip, no roll and another suspension.

use crate::controller::stop;
use crate::{deviation, mean};
use std::f64::consts::FRAC_PI_2;

const GRAVITY: f64 = 9.81;
/// Peak of the friction at 4.5 kN, its change with the load, and the slip at the peak: the specification's tire.
const PEAK: f64 = 1.475;
const PEAK_BY_LOAD: f64 = -0.225;
const SLIP_AT_PEAK: f64 = 0.09;

/// That tire in front and behind, with a shape that falls the more beyond the peak the larger it is.
fn tires(shape: f64) -> Vec<(&'static str, f64)> {
    let stiffness = shape * PEAK * (FRAC_PI_2 / shape).tan() / SLIP_AT_PEAK;
    vec![
        ("front_tire.PDX1", PEAK),
        ("rear_tire.PDX1", PEAK),
        ("front_tire.PDX2", PEAK_BY_LOAD),
        ("rear_tire.PDX2", PEAK_BY_LOAD),
        ("front_tire.PEX1", 0.0),
        ("rear_tire.PEX1", 0.0),
        ("front_tire.PCX1", shape),
        ("rear_tire.PCX1", shape),
        ("front_tire.PKX1", stiffness),
        ("rear_tire.PKX1", stiffness),
    ]
}

/// The specification's steeper tire.
const STEEP: f64 = 1.62;

fn rises(what: &str, values: &[f64]) {
    assert!(values.windows(2).all(|pair| pair[1] > pair[0]), "{what} does not rise: {values:?}");
}

/// A sports car's tires use 1.2 to 1.65 of their load and no more than their friction, and the car brakes with 0.8 to 1.4 g (check Q3).
#[test]
fn tires_and_car_brake_as_a_sports_car_does() {
    let stop = stop(&tires(STEEP), &[], 1.0);
    for i in 0..4 {
        let most = stop.used.iter().map(|used| used[i]).fold(0.0, f64::max);
        assert!((1.2..1.65).contains(&most), "wheel {i} uses {most} of its load");
    }
    let deceleration = stop.deceleration / GRAVITY;
    assert!((0.8..1.4).contains(&deceleration), "{deceleration} g");
}

/// The steeper the friction falls beyond its peak, the more the force swings and the less the car slows down (check Q4; there 1.11 to 2.50 kN and
/// 11.9 to 8.8 m/s²).
#[test]
fn a_steeper_fall_of_the_friction_makes_forces_swing_and_stops_longer() {
    let stops = [1.3, 1.45, 1.62, 1.8].map(|shape| stop(&tires(shape), &[], 1.0));
    rises("the swing of the force", &stops.each_ref().map(|stop| deviation(&stop.force)));
    rises("minus the deceleration", &stops.each_ref().map(|stop| -stop.deceleration));
}

/// A wheel with more inertia slows down more slowly (check Q5; there 1752, 1049 and 782 rad/s²).
#[test]
fn a_heavier_wheel_slows_down_more_slowly() {
    let peaks = [1.2, 1.6, 2.0].map(|inertia| {
        let values = [tires(STEEP), vec![("front_wheel_inertia", inertia)]].concat();
        let stop = stop(&values, &[], 1.0);
        let falls = stop.wheel_speed.windows(2).map(|pair| (pair[0] - pair[1]) / 1e-3);
        falls.fold(0.0, f64::max)
    });
    rises("minus the greatest deceleration of a wheel", &peaks.map(|peak| -peak));
}

/// A controller that believes in larger wheels sees less slip and leaves more (check Q6; there 0.054 to 0.189).
#[test]
fn a_larger_radius_in_the_controller_leaves_more_slip() {
    let slips = [0.94, 0.97, 1.0, 1.03, 1.06].map(|radius| mean(&stop(&tires(STEEP), &[], radius).slip));
    rises("the mean slip", &slips);
}

/// Pads that take time to grip let the pressure rise further first, and then the wheel falls deeper (check Q7; there 111 and 146 bar, slips of 0.41
/// and 0.99).
#[test]
fn pads_that_take_time_make_pressure_and_slip_overshoot() {
    let first = |values: &[f64]| values[..400].iter().copied().fold(0.0, f64::max);
    let stops = [0.0, 0.22].map(|onset| stop(&tires(1.3), &[("onset_time", onset)], 1.0));
    rises("the first peak of the pressure", &stops.each_ref().map(|stop| first(&stop.pressure)));
    rises("the first peak of the slip", &stops.each_ref().map(|stop| first(&stop.slip)));
    rises("the swing of the force", &stops.each_ref().map(|stop| deviation(&stop.force)));
}
