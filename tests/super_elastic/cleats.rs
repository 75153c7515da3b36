//! A wheel that rolls over cleats, its speed led, its height free.

use super::reference::Wheel;
use super::{rim, single, tire};
use latsch::rig::OnRoad;
use latsch::road::{Road, RoadParameters};
use latsch::tire::super_elastic::SuperElastic;
use latsch::tire::{Motion, Plane, Tire, Vertical};

/// A mass that carries the tire and cannot turn aside: velocity Verlet in steps of `step` seconds.
pub struct Led {
    pub tire: SuperElastic,
    pub rim: Motion<f64>,
    pub road: Road,
    place: f64,
    mass: f64,
    acceleration: f64,
}

impl Led {
    pub fn new(tire: &SuperElastic, road: Road, total_mass: f64, speed: f64, spin: f64) -> Self {
        let mass = total_mass - tire.parameters.rubber_mass;
        let mut tire = tire.clone();
        let rest = tire.stationary(&rim(0.0, speed, spin), Vertical::Load(mass * 9.81), 1.0).unwrap();
        let rim = rim(rest.rim_height, speed, spin);
        tire.begin(&rest, &rim, &Plane::level(rest.rim_height, 1.0), &OnRoad::at(&road, [0.0; 2], 1.0))
            .unwrap();
        Self { tire, rim, road, place: 0.0, mass, acceleration: 0.0 }
    }

    /// Lets it go from a state at rest, so much lower.
    pub fn press(&mut self, lower: f64) {
        self.rim.position.z -= lower;
        let height = self.rim.position.z;
        let rest = self.tire.stationary(&self.rim, Vertical::Height(height), 1.0).unwrap();
        let ground = OnRoad::at(&self.road, [0.0; 2], 1.0);
        self.tire.begin(&rest, &self.rim, &Plane::level(height, 1.0), &ground).unwrap();
    }

    pub fn step(&mut self, step: f64) {
        let before = self.rim;
        let from = self.place;
        self.rim.velocity.z += 0.5 * step * self.acceleration;
        self.rim.position.z += step * self.rim.velocity.z;
        self.rim.angles.y += step * self.rim.rates.y;
        self.place += step * self.rim.velocity.x;
        let mut predicted = self.rim;
        predicted.velocity.z += 0.5 * step * self.acceleration;
        let ground = OnRoad { road: &self.road, from: [from, 0.0], to: [self.place, 0.0], friction: 1.0 };
        self.tire.step(&before, &predicted, &ground, step).unwrap();
        let (force, carried) = (self.tire.on_rim().force, self.tire.carried());
        let force = force + carried.acceleration * carried.mass;
        self.acceleration = (force.z - self.mass * 9.81) / (self.mass + carried.mass);
        self.rim.velocity.z += 0.5 * step * self.acceleration;
    }

    /// Deflection from the level road \[mm\].
    pub fn deflection(&self) -> f64 {
        1e3 * (0.2265 - self.rim.position.z)
    }
}

fn cleat(height: f64, start: f64) -> Road {
    let text = format!("0 0; 0.05 {height}; 0.2 {height}; 0.25 0");
    let mut parameters = RoadParameters::default();
    RoadParameters::rows().write_starts(&mut parameters);
    (parameters.kind, parameters.start, parameters.profile) = (8, start, text);
    Road::new(&parameters).unwrap()
}

/// A tire that rolls towards a cleat of a height at a speed, with the wheel's middle over the first element at the start.
fn rolling(height: f64, speed: f64, start: f64) -> Led {
    let change = single(151_105.0);
    let tire = tire(|p| {
        change(p);
        // nothing along the road, which lifts the wheel on a ramp
        (p.friction_max, p.friction_min, p.rolling_resistance) = (0.0, 0.0, 0.0);
    });
    Led::new(&tire, cleat(height, start), 670.0, speed, speed / 0.222_17)
}

/// Least and most deflection from a place on \[mm\].
fn extremes(led: &mut Led, step: f64, from: f64, to: f64) -> (f64, f64) {
    let (mut least, mut most) = (f64::INFINITY, f64::NEG_INFINITY);
    while led.place < to {
        led.step(step);
        if led.place > from {
            (least, most) = (least.min(led.deflection()), most.max(led.deflection()));
        }
    }
    (least, most)
}

/// Check 32. The table does not say how elements lie to the cleat, which makes 0.05 mm and more.
#[test]
fn the_wheel_answers_a_cleat_as_the_table_says() {
    let rows = [
        (0.005, 2.0, (4.89, 19.32)),
        (0.005, 4.0, (6.02, 18.79)),
        (0.01, 2.0, (-3.68, 24.98)),
        (0.01, 4.0, (-2.21, 24.17)),
    ];
    for (height, speed, expected) in rows {
        let found = extremes(&mut rolling(height, speed, 12.0), 1e-3, 12.0, 14.0);
        let away = (found.0 - expected.0).abs().max((found.1 - expected.1).abs());
        assert!(away < 0.1, "{height} {speed}: {found:?} instead of {expected:?}");
    }
}

/// The product with its long implicit steps beside the reference with short explicit ones, from the same state on.
#[test]
fn long_steps_agree_with_short_ones_of_another_program() {
    for (speed, height) in [(2.0, 0.005), (4.0, 0.01)] {
        let start = 0.6;
        let product = |step: f64| {
            let mut led = rolling(height, speed, start);
            let mut all = vec![led.deflection()];
            while all.len() < 600 {
                (0..(1e-3 / step).round() as usize).for_each(|_| led.step(step));
                all.push(led.deflection());
            }
            all
        };
        let led = rolling(height, speed, start);
        let wheel = Wheel {
            elements: 45,
            stiffness: 151_105.0,
            damping: 280.0,
            rubber: 19.8,
            mass: 670.0 - 19.8,
            speed,
            spin: led.rim.rates.y,
            contact: (35_000.0 * 1e3_f64.powf(1.9), 1.9, 700.0, 1e-4),
            road: [-1.0, 0.0, 0.05, 0.2, 0.25, 99.0]
                .map(|x| start + x)
                .into_iter()
                .zip([0.0, 0.0, height, height, 0.0, 0.0])
                .collect(),
            gravity: 9.81,
        };
        let mut y = vec![led.rim.position.z, 0.0];
        y.extend(&led.tire.state.ring.distance);
        y.extend(&led.tire.state.ring.speed);
        let mut reference = vec![led.deflection()];
        let h = 2e-5;
        let mut k = 0;
        while reference.len() < 600 {
            for _ in 0..50 {
                wheel.step(f64::from(k) * h, &mut y, h);
                k += 1;
            }
            reference.push(1e3 * (0.2265 - y[0]));
        }
        let away = |all: &[f64]| all.iter().zip(&reference).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        let errors = [1e-3, 2.5e-4, 1e-4].map(|step| away(&product(step)));
        // edges of the cleat pass within a step: between first and second order
        let swing = reference.iter().copied().fold(f64::NEG_INFINITY, f64::max)
            - reference.iter().copied().fold(f64::INFINITY, f64::min);
        assert!(
            errors[0] < 0.01 * swing && errors[1] < 1e-3 * swing && errors[2] < 2e-4 * swing,
            "{errors:?} of {swing}"
        );
    }
}

/// A wheel that starts on an obstacle stands on it: the forces are those of its springs, and no blow.
#[test]
fn a_start_on_an_obstacle_is_no_blow() {
    for start in [-0.02, -0.1, -0.22] {
        let mut wheel = super::common::shipped("super-elastic-wheel");
        let profile = wheel.find("road_profile").unwrap();
        wheel.set_text(profile, "0 0; 0.05 0.01; 0.2 0.01; 0.25 0").unwrap();
        let values = [
            ("road_kind", 8.0),
            ("road_start", start),
            ("initial_speed", 2.0),
            ("initial_load", 6504.0),
            ("hub_mass", 663.0),
            ("axle_force_z", 0.0),
        ];
        super::common::set(&mut *wheel, &values);
        wheel.start(0.0, None).unwrap();
        wheel.finish_start().unwrap();
        let mut most = super::common::get(&mut *wheel, "contact_force");
        for k in 0..100 {
            wheel.step(1e-3 * f64::from(k), 1e-3).unwrap();
            most = most.max(super::common::get(&mut *wheel, "contact_force"));
        }
        // 10 mm deeper than 13 mm under that load, on springs of which more and more touch
        assert!(most > 5000.0 && most < 20_000.0, "{start}: {most}");
    }
}
