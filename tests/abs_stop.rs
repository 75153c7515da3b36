//! The whole stop: corner, brake and ABS controller, wired and stepped by the master.
#![allow(missing_docs, clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod common;

use common::assert_close;
use latsch::control::{AbsController, BrakeHydraulics};
use latsch::cosimulate::{Coupling, Experiment, System, Transfer, cosimulate};
use latsch::model::{Native, Settings, Slave, Value};
use latsch::recording::{Channel, Recording};
use latsch::rig::RingBrushCorner;

/// A stop from 100 km/h; the driver brakes from the beginning, with 150 bar after 0.15 s. `friction` is the road's, as text.
struct Stop {
    abs: bool,
    friction: &'static str,
    /// Fall of the tire's friction with the sliding speed \[s/m\].
    falloff: f64,
    step: f64,
    time: f64,
}

const STOP: Stop = Stop { abs: true, friction: "", falloff: 0.01, step: 1e-3, time: 6.0 };
const SPEED: f64 = 27.8;
const RADIUS: f64 = 0.328;

impl Stop {
    fn run(&self) -> Recording {
        let native = Settings::default();
        let order = Some(if self.abs { vec![0, 1, 2] } else { vec![0, 1] });
        let mut system = System::new(Coupling { order, iterate: 0, halvings: 0 });
        let mut add = |name: &str, slave: Box<dyn Slave>| system.add(name, slave).unwrap();
        if self.abs {
            add("abs", Box::new(Native::<AbsController>::new(&native).unwrap()));
        }
        add("brake", Box::new(Native::<BrakeHydraulics>::new(&native).unwrap()));
        add("corner", Box::new(Native::<RingBrushCorner>::new(&native).unwrap()));
        let mut wires = vec![("brake", "brake_torque", "corner", "brake_torque")];
        let mut values = vec![
            ("corner", "initial_speed", Value::Real(SPEED)),
            ("corner", "friction_speed_falloff", Value::Real(self.falloff)),
            ("corner", "road_friction", Value::Text(self.friction.into())),
            ("brake", "step_size", Value::Real(1e-4)),
            ("corner", "step_size", Value::Real(self.step.min(5e-4))),
        ];
        if self.abs {
            wires.extend([
                ("corner", "wheel_speed", "abs", "wheel_speed_1"),
                ("abs", "inlet_valve_1", "brake", "inlet_valve"),
                ("abs", "outlet_valve_1", "brake", "outlet_valve"),
            ]);
            values.extend([
                ("abs", "wheels", Value::Integer(1)),
                ("abs", "rolling_radius_1", Value::Real(RADIUS)),
            ]);
        }
        for (component, name, value) in values {
            let port = system.port(component, name).unwrap();
            system.set(port, &value).unwrap();
        }
        for (from, output, to, input) in wires {
            let (from, to) = (system.port(from, output).unwrap(), system.port(to, input).unwrap());
            system.connect(from, to, Transfer::default()).unwrap();
        }
        let driver = driver();
        for name in if self.abs { &["abs", "brake"][..] } else { &["brake"] } {
            let port = system.port(name, "driver_pressure").unwrap();
            system.feed(port, &driver, "pressure", false).unwrap();
        }
        let experiment = Experiment {
            start: 0.0,
            stop: self.time,
            step: self.step,
            record_every: (1e-3 / self.step).round() as usize,
            all: true,
            log: false,
        };
        let outcome = cosimulate(&mut system, &experiment, |_| {}).unwrap();
        assert!(outcome.stopped.is_none(), "{:?}", outcome.stopped);
        outcome.recording
    }
}

fn driver() -> Recording {
    let pressure = Channel { name: "pressure".into(), unit: "Pa".into(), values: vec![0.0, 150e5, 150e5] };
    Recording { time: vec![0.0, 0.15, 100.0], channels: vec![pressure], source: "driver".into() }
}

fn channel<'a>(recording: &'a Recording, name: &str) -> &'a [f64] {
    &recording.channel(name).unwrap().values
}

/// Distance to standstill \[m\].
fn distance(recording: &Recording) -> f64 {
    let stop = channel(recording, "corner.vehicle_speed").iter().position(|v| *v <= 0.0).expect("it stops");
    channel(recording, "corner.vehicle_distance")[stop]
}

/// The longest time \[s\] for which the wheel turns with less than a fifth of the vehicle's speed while
/// that is above 3 m/s.
fn longest_lock(recording: &Recording) -> f64 {
    let (mut longest, mut now) = (0, 0);
    let speeds =
        channel(recording, "corner.vehicle_speed").iter().zip(channel(recording, "corner.wheel_speed"));
    for (vehicle, wheel) in speeds {
        now = if *vehicle > 3.0 && RADIUS * wheel < 0.2 * vehicle { now + 1 } else { 0 };
        longest = longest.max(now);
    }
    f64::from(longest) * 1e-3
}

#[test]
fn abs_keeps_the_wheel_turning_on_every_friction_and_stops_earlier() {
    for (friction, time) in [("", 6.0), ("0 0.5", 9.0), ("0 0.3", 14.0), ("0 0.15", 28.0)] {
        let [with, without] = [true, false].map(|abs| Stop { abs, friction, time, ..STOP }.run());
        assert!(longest_lock(&with) < 0.15, "{friction:?}: {} s", longest_lock(&with));
        assert!(longest_lock(&without) > 0.5 * time * 0.5, "{friction:?}: it locks without");
        let [short, long] = [distance(&with), distance(&without)];
        assert!(short < 0.97 * long, "{friction:?}: {short} m with, {long} m without");
    }
}

#[test]
fn abs_follows_friction_that_changes_on_the_way() {
    for friction in ["0 1; 12 0.2; 25 1", "0 0.2; 20 1"] {
        let stop = Stop { friction, time: 9.0, ..STOP }.run();
        assert!(longest_lock(&stop) < 0.3, "{friction}: {} s", longest_lock(&stop));
        let locked = Stop { friction, time: 9.0, abs: false, ..STOP }.run();
        assert!(distance(&stop) < distance(&locked), "{friction}");
    }
}

/// The source's friction does not fall with the sliding speed: then there is nothing to win by not
/// locking, and what the cycles of the controller cost shows.
#[test]
fn without_a_fall_of_friction_a_locked_wheel_stops_as_early() {
    let [with, without] = [true, false].map(|abs| distance(&Stop { abs, falloff: 0.0, ..STOP }.run()));
    assert!(without < with && with < 1.15 * without, "{with} m with, {without} m without");
}

#[test]
fn the_energy_of_the_stop_is_in_brake_road_and_dampers() {
    for abs in [true, false] {
        let stop = Stop { abs, time: 5.0, ..STOP }.run();
        let last = |name: &str| *channel(&stop, name).last().unwrap();
        assert!(last("corner.vehicle_speed").abs() < 0.1);
        let spin = SPEED / RADIUS;
        let start = 0.5 * 428.8 * SPEED * SPEED + 0.5 * (0.7 + 0.928) * spin * spin;
        let [brake, road, dampers] =
            ["brake_energy", "friction_energy", "damper_energy"].map(|n| last(&format!("corner.{n}")));
        let rest = start - brake - road - dampers;
        // rolling resistance: lever over radius times the load, while it rolls
        let rolled = if abs { RADIUS * last("corner.wheel_angle") } else { 0.0 };
        let rolling = 0.01 / RADIUS * 428.8 * 9.81 * rolled;
        // what is left is the tire's: bristles that leave the patch bent, dampers of side wall and tread
        assert!(
            rest > 0.9 * rolling && rest - rolling < 0.06 * start,
            "{rest} J left, rolling {rolling} of {start}"
        );
        assert!(brake > 0.0 && road > 0.0 && dampers >= 0.0);
        // a wheel that turns leaves the work to the brake
        assert!(if abs { brake > 2.0 * road } else { road > 5.0 * brake }, "{brake} J, {road} J");
    }
}

/// In the time until the controller's decisions fall apart, the error goes with the step.
#[test]
fn results_converge_with_the_communication_step() {
    let force = |step: f64| {
        let stop = Stop { step, time: 0.4, ..STOP }.run();
        channel(&stop, "corner.wheel_speed").to_vec()
    };
    let reference = force(1e-4);
    let error = |step: f64| {
        let squares = force(step).iter().zip(&reference).map(|(a, b)| (a - b).powi(2)).sum::<f64>();
        (squares / reference.len() as f64).sqrt()
    };
    let [fine, coarse] = [2e-4, 1e-3].map(error);
    // against the step of 1e-4 s, errors of first order are as 9 to 1
    assert_close("ratio", coarse / fine, 9.0, 0.35);
    assert!(coarse < 5.0, "{coarse} rad/s of 85");
}
