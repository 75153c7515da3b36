//! The start: the vehicle rolls straight on, in balance.

use super::rack::Rack;
use super::{SIDES, Taken, Vehicle, WHEEL_NAMES, WHEELS, five_link, modes, statics, told};
use crate::mechanics::{ABOUT, Body, Link, Motion, Pose, Response, Spin, Wrench, check_step_size};
use crate::rig::{Actuator, OnRoad};
use crate::road::Road;
use crate::tire::{Mounted, Tire};
use crate::{Error, Result};
use nalgebra::Vector3;

/// Rounds of the search for the loads of the axles, which resistances of rolling and air change by little.
const MOST_ROUNDS: usize = 20;
/// Loads are found where they change by no more than this share of the weight.
const FOUND: f64 = 1e-12;

/// A wheel that rolls.
struct Rolling<T> {
    wheel: Mounted<T>,
    /// Of the tire on the carrier: without what turns the wheel.
    on_carrier: Wrench<f64>,
    /// Mass that it carries.
    carried: f64,
}

impl<T: Tire> Vehicle<T> {
    /// # Errors
    /// Parameters that contradict each other; a road on which the vehicle cannot start.
    pub(super) fn start(&mut self) -> Result<()> {
        self.car.prepare()?;
        self.road = Road::new(&self.road_parameters)?;
        for tire in &mut self.tires {
            tire.mount(&self.road)?;
        }
        for (i, name) in WHEEL_NAMES.into_iter().enumerate() {
            let reach = self.tires[i / 2].radius();
            OnRoad::check_level(&self.road, "vehicle", name, self.wheel_place(i), reach)?;
        }
        self.gravity = self.tires[0].gravity();
        if self.tires[1].gravity() != self.gravity {
            return Err(Error::variable(format!(
                "front_tire.gravity = {} m/s2 and rear_tire.gravity = {} m/s2 have to be the same",
                self.gravity,
                self.tires[1].gravity()
            )));
        }
        let (rolling, acceleration) = self.rolling()?;
        let heights = [0, 2].map(|i| rolling[i].wheel.rim.position.z);
        let velocity = Vector3::new(self.initial_speed, 0.0, 0.0);
        let [x, z] = self.car.body_centre(heights);
        let centre = Vector3::new(x, 0.0, z);
        self.standing = z;
        self.body = Body::moving(Motion { position: centre, velocity, ..Motion::default() });
        let body = Pose::from(&self.body.motion);
        self.front.rack = Rack::default();
        self.steered = Actuator::at_rest(&self.steering);
        for (i, Rolling { wheel, on_carrier, carried }) in rolling.into_iter().enumerate() {
            let place = self.wheel_place(i);
            let mut motion = wheel.rim;
            motion.position = Vector3::new(place[0], place[1], wheel.rim.position.z);
            motion.rates = Vector3::zeros();
            motion.angles.y = 0.0;
            self.places[i] = motion.position - centre;
            self.carriers[i] = Body::moving(motion);
            self.spins[i] = Spin { speed: wheel.rim.rates.y, ..Spin::default() };
            self.wheels[i] = wheel;
            let carrier = Pose::from(&motion);
            let own = self.car.axle(i / 2).unsprung();
            let mut loads = on_carrier;
            loads.force.z -= own * self.gravity;
            loads.force.x -= (own + carried) * acceleration;
            self.hang(i, [&body, &carrier], &loads)?;
        }
        (self.spared, self.taken) = (0.0, Taken::default());
        self.told = told::Told::default();
        let poses = self.carriers.each_ref().map(|carrier| Pose::from(&carrier.motion));
        self.accelerate(&Pose::from(&self.body.motion), &poses, 0.0);
        self.check_steps()
    }

    /// Hangs a carrier under the body so that all is in balance under other loads on it.
    fn hang(&mut self, i: usize, [body, carrier]: [&Pose; 2], loads: &Wrench<f64>) -> Result<()> {
        if i < 2 {
            return self.front.hang(i, &self.car.front, [body, carrier], loads);
        }
        let origin = Vector3::new(self.car.axle_x(1), 0.0, 0.0);
        let joints = self.car.five_link.joints(SIDES[i])?;
        let mut side = five_link::Side::new(self.car.five_link.bushing, &joints, [body, carrier], &origin);
        side.preload(&statics::balance("rear suspension", &side.columns([body, carrier]), loads)?);
        self.rear[i - 2] = side;
        Ok(())
    }

    /// Where a wheel's centre is at the start, x and y \[m\].
    fn wheel_place(&self, i: usize) -> [f64; 2] {
        [self.car.axle_x(i / 2), 0.5 * SIDES[i] * self.car.axle(i / 2).track]
    }

    /// All wheels rolling free under the loads that are in balance, and the acceleration of the whole.
    fn rolling(&self) -> Result<([Rolling<T>; WHEELS], f64)> {
        let (car, speed) = (&self.car, self.initial_speed);
        let weight = car.mass * self.gravity;
        let pressure = 0.5 * car.air.density * speed * speed;
        let drag = pressure * car.air.drag * if speed < 0.0 { -1.0 } else { 1.0 };
        let lift = car.air.lift.map(|area| pressure * area);
        let [behind, over] = car.centre;
        let mut rear = weight * behind / car.wheelbase - lift[1];
        for _ in 0..MOST_ROUNDS {
            let loads = [weight - lift[0] - lift[1] - rear, rear];
            for (load, place) in loads.iter().zip(["front", "rear"]) {
                if *load <= 0.0 {
                    return Err(Error::variable(format!(
                        "at initial_speed = {speed} m/s nothing presses the {place} wheels to the road: centre_of_mass_x or the lift of the air is to blame"
                    )));
                }
            }
            let rolling = self.wheels_rolling(loads)?;
            let sum = |of: &dyn Fn(&Rolling<T>) -> f64| rolling.iter().map(of).sum::<f64>();
            let moved = car.mass + sum(&|r| r.carried);
            let acceleration = (sum(&|r| r.on_carrier.force.x) - drag) / moved;
            // moments about the point of the road below the front axle
            let of_wheel = |r: &Rolling<T>| {
                let height = r.wheel.rim.position.z;
                height * (r.on_carrier.force.x - r.carried * acceleration) + r.on_carrier.moment.y
            };
            let moment = sum(&of_wheel) - behind * weight - over * (car.mass * acceleration + drag)
                + car.wheelbase * lift[1];
            let needed = -moment / car.wheelbase;
            let change = needed - rear;
            rear = needed;
            if change.abs() <= FOUND * weight {
                return Ok((rolling, acceleration));
            }
        }
        Err(Error::numeric("the loads of the axles at the start were not found"))
    }

    /// All wheels rolling free under loads of the axles \[N\].
    fn wheels_rolling(&self, loads: [f64; 2]) -> Result<[Rolling<T>; WHEELS]> {
        let mut all = Vec::with_capacity(WHEELS);
        for i in 0..WHEELS {
            let axle = &self.car.axle(i / 2);
            let mut wheel = Mounted { tire: self.tires[i / 2].clone(), ..Mounted::default() };
            if SIDES[i] < 0.0 {
                wheel.tire.mirror();
            }
            let rim = Motion {
                velocity: Vector3::new(self.initial_speed, 0.0, 0.0),
                angles: Vector3::new(-SIDES[i] * axle.camber, 0.0, -SIDES[i] * axle.toe),
                ..Motion::default()
            };
            let ground = OnRoad::at(&self.road, self.wheel_place(i), self.friction[i]);
            wheel.start_rolling(&rim, &ground, 0.5 * loads[i / 2])?;
            let on_rim = wheel.tire.on_rim();
            let along =
                Pose::from(&Motion { rates: Vector3::zeros(), ..wheel.rim }).axes.column(1).into_owned();
            let on_carrier =
                Wrench { force: on_rim.force, moment: on_rim.moment - along * along.dot(&on_rim.moment) };
            let carried = wheel.tire.carried().mass;
            all.push(Rolling { wheel, on_carrier, carried });
        }
        all.try_into().map_err(|_| Error::numeric("a vehicle has four wheels"))
    }

    /// Checks that `step_size` is short enough for wheels, and for all bodies together as they are.
    pub(super) fn check_steps(&self) -> Result<()> {
        let (step, car) = (self.step_size, &self.car);
        for (i, inertia) in ["front_wheel_inertia", "rear_wheel_inertia"].into_iter().enumerate() {
            let windup = self.tires[i].links()[2];
            // each wheel of an axle has half of the coupling's torque
            let coupled = Link {
                stiffness: ("none", 0.0),
                damping: ("half of coupling_damping", 0.5 * car.coupling),
                mass: ("the wheel_inertia of the other axle", car.axle(1 - i).wheel_inertia),
            };
            check_step_size(step, (inertia, car.axle(i).wheel_inertia), &[windup, coupled], &ABOUT)?;
        }
        let mut names = modes::names("the body");
        names.extend(WHEEL_NAMES.iter().flat_map(|wheel| modes::names(&format!("the {wheel} carrier"))));
        names.push(("the rack".into(), 1.0));
        let mut probe = self.clone();
        let response = Response::new(names.len(), |places, velocities| {
            let moved =
                |n: usize, motion: &Motion<f64>| modes::moved(motion, &places[6 * n..], &velocities[6 * n..]);
            let body = Pose::from(&moved(0, &self.body.motion));
            let carriers: [Pose; WHEELS] =
                std::array::from_fn(|i| Pose::from(&moved(1 + i, &self.carriers[i].motion)));
            probe.front.rack = self.front.rack;
            probe.front.rack.way += places[names.len() - 1];
            probe.accelerate(&body, &carriers, self.front.rack.speed + velocities[names.len() - 1]);
            let bodies = std::iter::once(&probe.body).chain(&probe.carriers);
            let mut all: Vec<f64> = bodies.flat_map(modes::accelerations).collect();
            all.push(probe.front.rack.acceleration);
            all
        });
        response.check(step, &names, |step| {
            // tires tie carriers to the road, or to masses inside
            let mut taken = vec![0.0; names.len()];
            for i in 0..WHEELS {
                let [plane, across, _] = self.tires[i / 2].links();
                let mass = car.axle(i / 2).unsprung();
                for (axis, link) in [plane, across, plane].iter().enumerate() {
                    taken[6 * (1 + i) + axis] = link.needs_at_hub(step) / mass;
                }
                // somewhere a damper may be steeper than at rest
                taken[6 * (1 + i) + 2] += step * car.axle(i / 2).springs.damper.steeper() / mass;
            }
            taken
        })
    }
}
