//! A controller of slip that is simpler than the shipped one: it knows the car's true speed, and has three phases and
//! fixed thresholds. What parameters of the car do to a stop shows best with it, because it makes up for nothing.
//!
//! Thresholds and rates are those of the specification's placeholder rig.

use crate::WHEELS;
use crate::common::Shipped;

/// Time between two decisions \[s\].
const TASK: f64 = 5e-3;
const STEP: f64 = 1e-3;

#[derive(Clone, Copy, PartialEq)]
enum Phase {
    Build,
    Dump,
    Hold,
}

struct Channel {
    phase: Phase,
    held: f64,
    dumped: bool,
    speed: f64,
}

impl Channel {
    /// Opening of inlet and outlet for the next task, by the slip and the acceleration at the rim.
    fn decide(&mut self, slip: f64, acceleration: f64) -> [f64; 2] {
        self.held += TASK;
        match self.phase {
            Phase::Build if slip > 0.13 && (acceleration < -8.0 || slip > 0.22) => {
                (self.phase, self.dumped) = (Phase::Dump, true);
            }
            Phase::Dump if acceleration > -2.0 => (self.phase, self.held) = (Phase::Hold, 0.0),
            Phase::Hold if slip > 0.13 && (acceleration < -8.0 || slip > 0.22) => self.phase = Phase::Dump,
            Phase::Hold if slip < 0.07 && self.held >= 0.02 => self.phase = Phase::Build,
            _ => {}
        }
        match self.phase {
            Phase::Build if self.dumped => [0.25, 0.0],
            Phase::Build => [1.0, 0.0],
            Phase::Dump => [0.0, 1.0],
            Phase::Hold => [0.0, 0.0],
        }
    }
}

/// What a stop was like, sample after sample of 1 ms, until the car is slower than 4 m/s.
pub struct Stop {
    /// Of the front left wheel, positive where it brakes \[N\].
    pub force: Vec<f64>,
    pub slip: Vec<f64>,
    /// Pressure in its brake \[Pa\].
    pub pressure: Vec<f64>,
    pub speed: Vec<f64>,
    pub wheel_speed: Vec<f64>,
    /// Of tires at the front and behind: force over load.
    pub used: Vec<[f64; 4]>,
    pub deceleration: f64,
}

/// From 80 km/h; the driver presses from the beginning on, 150 bar after 0.15 s. `radius` is the controller's, over the tires' own.
pub fn stop(car_values: &[(&str, f64)], brake_values: &[(&str, f64)], radius: f64) -> Stop {
    let mut car = Shipped::new("magic-formula-vehicle", car_values);
    let mut brakes: Vec<Shipped> = (0..4)
        .map(|i| {
            let area = ("piston_area", if i < 2 { 43e-4 } else { 30e-4 });
            Shipped::new("brake-hydraulics", &[&[area], brake_values].concat())
        })
        .collect();
    let rolling: Vec<f64> = WHEELS
        .iter()
        .map(|wheel| radius * car.get("vehicle_speed") / car.get(&format!("{wheel}.wheel_speed")))
        .collect();
    let mut channels: Vec<Channel> = WHEELS
        .iter()
        .map(|wheel| Channel {
            phase: Phase::Build,
            held: 0.0,
            dumped: false,
            speed: car.get(&format!("{wheel}.wheel_speed")),
        })
        .collect();
    let mut stop = Stop {
        force: Vec::new(),
        slip: Vec::new(),
        pressure: Vec::new(),
        speed: Vec::new(),
        wheel_speed: Vec::new(),
        used: Vec::new(),
        deceleration: 0.0,
    };
    let every = (TASK / STEP).round() as usize;
    for k in 0..4000 {
        let driver = 150e5 * (k as f64 * STEP / 0.15).min(1.0);
        let speed = car.get("vehicle_speed");
        if speed < 4.0 {
            break;
        }
        for (i, wheel) in WHEELS.iter().enumerate() {
            let spin = car.get(&format!("{wheel}.wheel_speed"));
            if k % every == 0 {
                let acceleration = rolling[i] * (spin - channels[i].speed) / TASK;
                channels[i].speed = spin;
                let [inlet, outlet] = channels[i].decide(1.0 - spin * rolling[i] / speed, acceleration);
                brakes[i].set("inlet_valve", inlet);
                brakes[i].set("outlet_valve", outlet);
            }
            brakes[i].set("driver_pressure", driver);
            brakes[i].step(STEP);
            let torque = brakes[i].get("brake_torque");
            car.set(&format!("{wheel}.brake_torque"), torque);
        }
        car.step(STEP);
        stop.force.push(-car.get("front_left.force_x"));
        stop.slip.push(-car.get("front_left.slip"));
        stop.pressure.push(brakes[0].get("pressure"));
        stop.speed.push(car.get("vehicle_speed"));
        stop.wheel_speed.push(car.get("front_left.wheel_speed"));
        stop.used.push(WHEELS.map(|wheel| {
            -car.get(&format!("{wheel}.force_x")) / car.get(&format!("{wheel}.normal_force")).max(500.0)
        }));
    }
    let first = stop.speed[0];
    let from = stop.speed.iter().position(|v| *v < 0.9 * first).unwrap();
    let last = stop.speed.len() - 1;
    stop.deceleration = (stop.speed[from] - stop.speed[last]) / ((last - from) as f64 * STEP);
    stop
}
