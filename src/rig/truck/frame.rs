//! The bodies of the truck: chassis, cabin, carriage and bolster, which move by little about their places at rest, and travel.

use super::sizes::Sizes;
use crate::mechanics::{Motion, drift, kick};
use nalgebra::Vector3;
use serde::{Deserialize, Serialize};
use std::ops::{Add, Mul};

/// A point on a body, from its centre of mass: forward and to the left \[m\].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Point {
    pub x: f64,
    pub y: f64,
}

impl Point {
    /// Height of the point on a body with a height, pitch (nose down) and roll (to the right): of anything linear in them.
    fn on(&self, [height, pitch, roll]: &[f64; 3]) -> f64 {
        height - self.x * pitch + self.y * roll
    }

    /// Force upward and moments of pitch and roll of a force upward at the point.
    fn load(&self, force: f64) -> [f64; 3] {
        [force, -self.x * force, self.y * force]
    }
}

/// Where things are on the chassis, from its centre of mass.
#[derive(Debug, Clone, Copy)]
pub struct Places {
    /// x of the front axle.
    pub front_axle: f64,
    pub wheels: [Point; 4],
    pub bolster: Point,
}

impl Places {
    /// Where a wheel is over the road if the front axle has gone a way: x and y \[m\].
    pub fn of_wheel(&self, i: usize, way: f64) -> [f64; 2] {
        let Point { x, y } = self.wheels[i];
        [way + x - self.front_axle, y]
    }
}

/// Coordinates of all bodies, or their rates: height, pitch and roll from the places at rest.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct Coordinates {
    /// Along the road; a rate.
    pub travel: f64,
    pub chassis: [f64; 3],
    pub cabin: [f64; 3],
    pub carriage: f64,
    /// Roll of the bolster.
    pub bolster: f64,
}

impl Coordinates {
    fn zip(self, other: Self, f: impl Fn(f64, f64) -> f64) -> Self {
        Self {
            travel: f(self.travel, other.travel),
            chassis: [0, 1, 2].map(|i| f(self.chassis[i], other.chassis[i])),
            cabin: [0, 1, 2].map(|i| f(self.cabin[i], other.cabin[i])),
            carriage: f(self.carriage, other.carriage),
            bolster: f(self.bolster, other.bolster),
        }
    }

    /// Of a point of the chassis, upward.
    pub fn of_point(&self, point: &Point) -> f64 {
        point.on(&self.chassis)
    }

    /// Of a point of the cabin, upward.
    pub fn of_cabin(&self, point: Point) -> f64 {
        point.on(&self.cabin)
    }
}

impl Add for Coordinates {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        self.zip(other, |a, b| a + b)
    }
}

impl Mul<f64> for Coordinates {
    type Output = Self;
    fn mul(self, by: f64) -> Self {
        self.zip(self, |a, _| a * by)
    }
}

/// Moment of pitch of the forces along and of the drive: a force below the centre of mass lifts the nose, and what turns the wheels
/// forward turns the chassis backward.
fn pitch_along(s: &Sizes, forces: &[Vector3<f64>; 4], heights: [f64; 2], drive: f64) -> f64 {
    let of = |(i, force): (usize, &Vector3<f64>)| -force.x * (s.chassis[1] - heights[i / 2]);
    forces.iter().enumerate().map(of).sum::<f64>() - drive
}

/// The motion of all bodies.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct Frame {
    pub position: Coordinates,
    pub velocity: Coordinates,
    pub acceleration: Coordinates,
    /// Velocity predicted for the end of the step, for what damps.
    pub predicted: Coordinates,
    /// Vertical forces of the wheels in which all is at rest, and the moment of pitch of those along and of the drive.
    at_rest: [f64; 4],
    pitch_at_rest: f64,
    gravity: f64,
    /// Force of the chains on the carriage \[N\].
    pub chain: f64,
}

impl Frame {
    /// All travels with a speed, and is at rest under these forces of the wheels.
    pub fn rolling(
        s: &Sizes,
        speed: f64,
        gravity: f64,
        forces: &[Vector3<f64>; 4],
        heights: [f64; 2],
        drive: f64,
    ) -> Self {
        let velocity = Coordinates { travel: speed, ..Coordinates::default() };
        Self {
            velocity,
            predicted: velocity,
            at_rest: forces.map(|force| force.z),
            pitch_at_rest: pitch_along(s, forces, heights, drive),
            gravity,
            ..Self::default()
        }
    }

    pub fn drift(&mut self, dt: f64) -> Coordinates {
        let step = drift(self.velocity, self.acceleration, dt);
        self.velocity = step.velocity;
        self.position = self.position + step.travel;
        step.predicted
    }

    pub fn kick(&mut self, dt: f64) {
        self.velocity = kick(self.velocity, self.acceleration, dt);
    }

    /// The motion of a wheel's rim whose centre is at a height at rest, with its spin.
    pub fn rim(
        &self,
        places: &Places,
        i: usize,
        level: f64,
        velocity: &Coordinates,
        (angle, speed): (f64, f64),
    ) -> Motion<f64> {
        let point = &places.wheels[i];
        // behind, the bolster rolls in place of the chassis
        let of = |c: &Coordinates| match i < 2 {
            true => (point.on(&c.chassis), c.chassis[2]),
            false => (places.bolster.on(&c.chassis) + point.y * c.bolster, c.bolster),
        };
        let ((height, camber), (rising, camber_rate)) = (of(&self.position), of(velocity));
        Motion {
            position: Vector3::new(0.0, 0.0, level + height),
            velocity: Vector3::new(velocity.travel, 0.0, rising),
            angles: Vector3::new(camber, angle, 0.0),
            rates: Vector3::new(camber_rate, speed, 0.0),
        }
    }

    /// Accelerations of all bodies from the forces of the wheels on their rims, the heights of front and rear wheel centres and
    /// the torque of the drive.
    pub fn accelerate(&mut self, s: &Sizes, forces: &[Vector3<f64>; 4], heights: [f64; 2], drive: f64) {
        let (p, v) = (&self.position, &self.predicted);
        let places = s.places();
        let along: f64 = forces.iter().map(|force| force.x).sum();
        let travel = along / s.total_mass();

        let mut chassis = [0.0; 3];
        let mut add = |load: [f64; 3]| (0..3).for_each(|i| chassis[i] += load[i]);
        let mut bolster = 0.0;
        for (i, force) in forces.iter().enumerate() {
            let up = force.z - self.at_rest[i];
            if i < 2 {
                add(places.wheels[i].load(up));
            } else {
                add(places.bolster.load(up));
                bolster += places.wheels[i].y * up;
            }
        }
        add([0.0, pitch_along(s, forces, heights, drive) - self.pitch_at_rest, 0.0]);
        let pivot = s.bolster_damping * (v.bolster - v.chassis[2]);
        add([0.0, 0.0, pivot]);
        bolster -= pivot;

        let mut cabin = [0.0; 3];
        for (on_chassis, on_cabin) in s.mounts_at() {
            let (way, rate) = (
                on_cabin.on(&p.cabin) - on_chassis.on(&p.chassis),
                on_cabin.on(&v.cabin) - on_chassis.on(&v.chassis),
            );
            let pull = s.mount.force(way, rate);
            add(on_chassis.load(pull));
            let load = on_cabin.load(-pull);
            (0..3).for_each(|i| cabin[i] += load[i]);
        }
        // what carries cabin and carriage along acts at the mounts and at the height of the chassis' centre of mass
        let carried = s.cabin_mass * travel;
        cabin[1] -= carried * (s.cabin[1] - s.mount_height);
        add([0.0, -carried * (s.mount_height - s.chassis[1]), 0.0]);

        let fork = s.fork();
        let weight = s.carriage_mass() * self.gravity;
        let (way, rate) = (p.carriage - fork.on(&p.chassis), v.carriage - fork.on(&v.chassis));
        let slack = weight / s.chain.stiffness;
        self.chain = if way < slack { (weight - s.chain.force(way, rate)).max(0.0) } else { 0.0 };
        let stop = if way > s.play { s.stop.force(way - s.play, rate).max(0.0) } else { 0.0 };
        let lift = self.chain - weight - stop;
        add(fork.load(-lift));

        let [pitch, roll] = s.chassis_inertia;
        let [cabin_pitch, cabin_roll] = s.cabin_inertia;
        self.acceleration = Coordinates {
            travel,
            chassis: [chassis[0] / s.chassis_mass, chassis[1] / pitch, chassis[2] / roll],
            cabin: [cabin[0] / s.cabin_mass, cabin[1] / cabin_pitch, cabin[2] / cabin_roll],
            carriage: lift / s.carriage_mass(),
            bolster: bolster / s.bolster_inertia,
        };
    }

    pub fn is_finite(&self) -> bool {
        let (p, v) = (&self.position, &self.velocity);
        [p, v].iter().all(|c| {
            c.chassis.iter().chain(&c.cabin).all(|x| x.is_finite())
                && c.travel.is_finite()
                && c.carriage.is_finite()
                && c.bolster.is_finite()
        })
    }
}
