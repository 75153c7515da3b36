//! A car with a body that moves in six directions: `ring-brush-vehicle`. McPherson suspension and rack in front, five links behind;
//! brake torques and the steering wheel in, motions and the forces in links, struts and wheel bearings out.
//!
//! After G. Mack (2009), chapters 3 and 6. The source prints equations and no data: all sizes are placeholders.
//!
//! Body and wheel carriers are rigid bodies, and all that is between them are springs and dampers: links with their bushings, struts,
//! tie rods. So every force in a link is a force of the model, none is worked out behind it, and levers, toe and camber over travel,
//! anti-dive and the wheel's inertia about the steering axis follow from where the joints are.

mod axle;
mod axle_rig;
mod car;
mod five_link;
mod front;
mod joint;
pub mod lever_arms;
mod mcpherson;
mod modes;
mod rack;
mod rows;
mod start;
mod statics;
mod told;

pub use self::axle_rig::AxleRig;

use self::car::Car;
use self::front::FrontAxle;
use super::{Actuation, Actuator, Command, OnRoad};
use crate::mechanics::{Body, Motion, Pose, RigidBody, Spin, Wrench, cross};
use crate::model::{Model, Table, join};
use crate::road::{self, Road, RoadParameters};
use crate::tire::{Mounted, Tire};
use crate::{Error, Result, clone_in_place};
use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

/// Front left, front right, rear left, rear right.
const WHEELS: usize = 4;
const WHEEL_NAMES: [&str; WHEELS] = ["front left", "front right", "rear left", "rear right"];
/// Left and right in the sense of y.
const SIDES: [f64; WHEELS] = [1.0, -1.0, 1.0, -1.0];

/// The model.
#[derive(Debug, PartialEq, Default, Serialize, Deserialize)]
pub struct Vehicle<T> {
    /// Torque with which each brake can resist \[N.m\].
    brakes: [f64; WHEELS],
    /// Torque of the drive on the wheels of an axle together \[N.m\].
    drives: [f64; 2],
    steering: Command,
    /// Factors on the friction, over the road's own.
    friction: [f64; WHEELS],
    actuation: Actuation,
    steered: Actuator,
    road_parameters: RoadParameters,
    road: Road,
    /// The left tires in front and behind, whose parameters are the vehicle's. The right ones are their mirror images.
    tires: [T; 2],
    wheels: [Mounted<T>; WHEELS],
    spins: [Spin; WHEELS],
    /// Energy that the carriers' turning spared the brakes \[J\]: brakes resist a wheel's turning in space, because the inertia of a wheel that
    /// stands is more than that of the carrier, which would have to take it along a step later.
    spared: f64,
    car: Car,
    gravity: f64,
    front: FrontAxle,
    rear: [five_link::Side; 2],
    body: Body,
    carriers: [Body; WHEELS],
    /// Where the wheels' centres are in the vehicle's axes where it stands, from the body's centre of mass \[m\].
    places: [Vector3<f64>; WHEELS],
    /// Height of the body's centre of mass there \[m\].
    standing: f64,
    told: told::Told,
    /// Energy that went since the start \[J\].
    taken: Taken,
    /// What goes now \[W\].
    powers: Taken,
    step_size: f64,
    initial_speed: f64,
}

clone_in_place!(Vehicle<T> {
    brakes,
    drives,
    steering,
    friction,
    actuation,
    steered,
    road_parameters,
    road,
    tires,
    wheels,
    spins,
    spared,
    car,
    gravity,
    front,
    rear,
    body,
    carriers,
    places,
    standing,
    told,
    taken,
    powers,
    step_size,
    initial_speed,
});

/// Power \[W\] or energy \[J\] that goes from bodies and springs.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
struct Taken {
    /// Into heat in dampers, bushings, the rack's friction and the coupling.
    dampers: f64,
    air: f64,
    /// From the rims into the tires: what rolling and sliding take, and what the tires hold.
    tires: f64,
}

impl Taken {
    /// Adds the mean of two powers over a time.
    fn add(&mut self, before: &Self, after: &Self, time: f64) {
        let mean = |a: f64, b: f64| 0.5 * time * (a + b);
        self.dampers += mean(before.dampers, after.dampers);
        self.air += mean(before.air, after.air);
        self.tires += mean(before.tires, after.tires);
    }
}

impl<T: Tire> Model for Vehicle<T> {
    const NAME: &'static str = const { &join::<48>(&[T::NAME, "-vehicle"]) }.as_str();
    const DESCRIPTION: &'static str = const {
        &join::<256>(&[
            T::TITLE,
            "s under a car with suspension and steering: brake torques and steering wheel in; motions, forces of the wheels, links and struts out (ISO 8855 signs)",
        ])
    }
    .as_str();
    const STOP_TIME: f64 = 5.0;
    const DOCUMENTATION: &'static [&'static str] =
        &[include_str!("documentation.html"), T::DOCUMENTATION, road::DOCUMENTATION, T::ON_ROAD];

    fn variables() -> Table<Self> {
        Self::table()
    }

    fn step_size(&self) -> f64 {
        self.step_size
    }

    fn initialize(&mut self) -> Result<()> {
        self.start()
    }

    fn tune(&mut self) -> Result<()> {
        self.car.prepare()?;
        for side in &mut self.front.sides {
            side.tune(&self.car.front.mcpherson);
        }
        for side in &mut self.rear {
            side.tune(self.car.five_link.bushing);
        }
        for tire in &mut self.tires {
            tire.tune()?;
        }
        for (i, wheel) in self.wheels.iter_mut().enumerate() {
            wheel.tire.share_parameters(&self.tires[i / 2]);
            if SIDES[i] < 0.0 {
                wheel.tire.mirror();
            }
            wheel.tire.tune()?;
        }
        self.check_steps()
    }

    fn check(&self) -> Result<()> {
        self.road.check()?;
        if ![0, 1].iter().all(|axle| self.car.axle(*axle).springs.damper.is_whole()) {
            return Err(Error::numeric("the saved vehicle is damaged"));
        }
        self.wheels.iter().try_for_each(|wheel| wheel.tire.check(&self.road))
    }

    fn warning(&self) -> Option<String> {
        self.wheels.iter().find_map(Mounted::warning)
    }

    fn step(&mut self, length: f64) -> Result<()> {
        self.steered.follow(&self.steering, self.actuation.corner(), length);
        let before = self.carriers.each_ref().map(|c| [c.motion.position.x, c.motion.position.y]);
        let powers = self.powers;

        // half a kick and drift of all bodies; what damps sees the velocities predicted for the end
        let body = self.body.drift(length);
        let carriers = self.carriers.each_mut().map(|carrier| carrier.drift(length));
        let rack_speed = self.front.rack.drift(length);
        // not by `map`, which copies what it makes
        let [a, b, c, d] = &carriers;
        let poses = [Pose::from(a), Pose::from(b), Pose::from(c), Pose::from(d)];
        let torques = self.torques();
        for i in 0..WHEELS {
            let inertia = self.inertia(i);
            let motion = &carriers[i];
            let speed = self.spins[i].drift(inertia, self.brakes[i], length);
            let rim = rim(motion, &poses[i], self.spins[i].angle, speed);
            let ground = OnRoad {
                road: &self.road,
                from: before[i],
                to: [motion.position.x, motion.position.y],
                friction: self.friction[i],
            };
            self.wheels[i].step(&rim, &ground, length)?;
            // the brake's torque over the step is known when the wheel has done its second half, and the carrier takes it
            let carried = self.wheels[i].tire.carried();
            let torque =
                self.wheels[i].spin_moment() + torques[i] + carried.inertia * carried.spin_acceleration;
            self.spins[i].free_acceleration = torque / inertia;
            self.spins[i].kick(inertia, self.brakes[i], length);
            self.spared += length * self.spins[i].brake_torque * about_axle(&poses[i]);
        }

        // forces at the end, and the second half of the kick
        self.accelerate(&Pose::from(&body), &poses, rack_speed);
        self.body.kick(length);
        self.carriers.iter_mut().for_each(|carrier| carrier.kick(length));
        self.front.rack.kick(length);
        self.taken.add(&powers, &self.powers, length);
        if self.body.is_finite() && self.carriers.iter().all(Body::is_finite) {
            Ok(())
        } else {
            Err(Error::numeric("the vehicle's motion is no longer finite; a smaller step_size may help"))
        }
    }
}

/// The rim on a carrier, as its tire sees it, with the wheel's angle and its speed about its axis.
fn rim(carrier: &Motion<f64>, pose: &Pose, angle: f64, speed: f64) -> Motion<f64> {
    let mut rim = *carrier;
    (rim.position.x, rim.position.y) = (0.0, 0.0);
    rim.angles.y = angle;
    // the carrier's steering turns the wheel about its axis, too
    rim.rates.y = speed - pose.attitude.x.0 * pose.rates.z;
    rim
}

/// Angular velocity about the lateral axis of the body or wheel itself \[rad/s\].
fn about_axle(pose: &Pose) -> f64 {
    pose.rates.y + pose.attitude.x.0 * pose.rates.z
}

impl<T: Tire> Vehicle<T> {
    /// Of a wheel about its axis, with the masses of its tire that turn with it.
    fn inertia(&self, i: usize) -> f64 {
        self.car.axle(i / 2).wheel_inertia + self.wheels[i].tire.carried().inertia
    }

    /// How much faster front wheels turn than rear ones \[rad/s\].
    fn faster(&self) -> f64 {
        let [fl, fr, rl, rr] = self.spins.each_ref().map(|spin| spin.speed);
        0.5 * (fl + fr - rl - rr)
    }

    /// Torques of drive and coupling on the wheels \[N.m\].
    fn torques(&self) -> [f64; WHEELS] {
        let coupled = self.car.coupling * self.faster();
        let [front, rear] = [0.5 * (self.drives[0] - coupled), 0.5 * (self.drives[1] + coupled)];
        [front, front, rear, rear]
    }

    /// Takes over what acts on body, carriers and rack that move so.
    fn accelerate(&mut self, pose: &Pose, poses: &[Pose; WHEELS], rack_speed: f64) {
        let (car, gravity) = (&self.car, self.gravity);
        let mut on_body = self.air(pose);
        let air = -(on_body.force.dot(&pose.velocity) + on_body.moment.dot(&pose.spin));
        let mut powers = Taken { air, ..Taken::default() };
        let mut on_carriers = [Wrench::default(); WHEELS];

        let on_front = [&poses[0], &poses[1]];
        let front = self.front.act(&car.front, self.steered, pose, on_front, rack_speed);
        on_body += front.on_body;
        on_carriers[..2].copy_from_slice(&front.on_carriers);
        powers.dampers += front.dampers;
        self.told.front = front.told;
        let [left, right] = &self.rear;
        let struts = [left.strut([pose, &poses[2]]), right.strut([pose, &poses[3]])];
        for i in 0..2 {
            let [way, rate] = struts[i].shortened;
            let more = car.rear.springs.push(way, rate, struts[1 - i].shortened[0]);
            let acting = self.rear[i].act([pose, &poses[2 + i]], &struts[i], more);
            powers.dampers += acting.power_loss + rate * car.rear.springs.damper.at(rate);
            on_body += acting.on_body;
            on_carriers[2 + i] += acting.on_carrier;
            self.told.rear[i] = told::Rear { links: acting.links, push: acting.push, shortened: way };
        }

        // a drive stands on the body, which it turns the other way
        let driven = self.drives[0] + self.drives[1];
        on_body.moment -= pose.axes.column(1) * driven;
        self.body.load(&car.body(), pose, &on_body, gravity);
        let (torques, faster) = (self.torques(), self.faster());
        powers.dampers += self.car.coupling * faster * faster;
        for i in 0..WHEELS {
            powers.tires += self.tire_power(i, &poses[i]);
            self.load_carrier(i, &poses[i], on_carriers[i], torques[i]);
        }
        for (i, side) in self.front.sides.iter().enumerate() {
            let (axis, ball_joint) = side.steering_axis([pose, &poses[i]]);
            self.told.front[i].about(&axis, &ball_joint, &self.told.wheels[i]);
        }
        self.powers = powers;
    }

    /// Takes over what acts on a carrier besides its joints: the tire, the brake, and the wheel that spins on it.
    fn load_carrier(&mut self, i: usize, pose: &Pose, joints: Wrench<f64>, torque: f64) {
        let tire = &self.wheels[i].tire;
        let (on_rim, carried) = (tire.on_rim(), tire.carried());
        let axle = pose.axes.column(1).into_owned();
        let spin = &self.spins[i];
        let mut loads = joints;
        loads.force += on_rim.force + carried.acceleration * carried.mass;
        loads.moment += on_rim.moment - axle * axle.dot(&on_rim.moment);
        loads.moment += axle * spin.brake_torque;
        // turning a wheel that spins takes a moment
        let momentum = axle * (self.car.axle(i / 2).wheel_inertia * spin.speed);
        loads.moment -= cross(&pose.spin, &momentum);
        let own = self.car.axle(i / 2).carrier(0.0).mass;
        let rigid = self.car.axle(i / 2).carrier(carried.mass);
        // the weight of what the tire has is in its force
        self.carriers[i].load(&rigid, pose, &loads, self.gravity * own / rigid.mass);
        let brake = spin.brake_torque;
        self.told.wheels[i] = told::Bearing::new(
            self.car.axle(i / 2),
            &self.carriers[i],
            pose,
            &on_rim,
            [brake, torque, spin.speed],
            self.gravity,
        );
    }

    /// Power that goes from a rim into its tire \[W\].
    fn tire_power(&self, i: usize, carrier: &Pose) -> f64 {
        let (on_rim, axle) = (self.wheels[i].tire.on_rim(), carrier.axes.column(1));
        let spin = self.spins[i].speed - axle.dot(&carrier.spin);
        -(on_rim.force.dot(&carrier.velocity) + on_rim.moment.dot(&(carrier.spin + axle * spin)))
    }

    /// Force and moment of the air on the body about its centre.
    fn air(&self, body: &Pose) -> Wrench<f64> {
        let air = &self.car.air;
        let pressure = 0.5 * air.density * body.velocity.norm_squared();
        let speed = body.velocity.norm();
        let mut on_body = Wrench::default();
        if speed > 0.0 {
            let drag = body.velocity * (-pressure * air.drag / speed);
            let centre = self.vehicle_centre();
            on_body += body.at(&centre).load(drag);
        }
        let up = body.axes.column(2).into_owned();
        for axle in 0..2 {
            let over = Vector3::new(self.places[2 * axle].x, 0.0, 0.0);
            on_body += body.at(&over).load(up * (pressure * air.lift[axle]));
        }
        on_body
    }

    /// The vehicle's centre of mass where it stands, from the body's, in its axes.
    fn vehicle_centre(&self) -> Vector3<f64> {
        let unsprung = |axle: usize| 2.0 * self.car.axle(axle).unsprung();
        let sum = self.places[0] * unsprung(0) + self.places[2] * unsprung(1);
        Vector3::new(sum.x, 0.0, sum.z) / self.car.mass
    }
}

impl<T: Tire> Vehicle<T> {
    /// Energy of motions, heights and springs beyond that of the vehicle where it stands \[J\]; the tires' own is not in it.
    pub fn energy(&self) -> f64 {
        let car = &self.car;
        let of = |rigid: &RigidBody, motion: &Motion<f64>| {
            rigid.kinetic_energy(motion) + rigid.mass * self.gravity * motion.position.z
        };
        let pose = Pose::from(&self.body.motion);
        let mut energy = of(&car.body(), &self.body.motion);
        let poses = self.carriers.each_ref().map(|carrier| Pose::from(&carrier.motion));
        for i in 0..WHEELS {
            let axle = car.axle(i / 2);
            energy += of(&axle.carrier(0.0), &self.carriers[i].motion)
                + self.spins[i].kinetic_energy(axle.wheel_inertia);
        }
        energy += self.front.energy(&car.front, self.steered, &pose, [&poses[0], &poses[1]]);
        let links: f64 = (0..2).map(|i| self.rear[i].energy([&pose, &poses[2 + i]])).sum();
        let shortened = [0, 1].map(|i| self.rear[i].strut([&pose, &poses[2 + i]]).shortened[0]);
        energy + links + car.rear.springs.energy(shortened)
    }

    /// Energy that brakes, dampers, tires and the air took since the start \[J\].
    pub fn lost(&self) -> f64 {
        let Taken { dampers, air, tires } = self.taken;
        self.brake_energy() + dampers + air + tires
    }

    fn brake_energy(&self) -> f64 {
        self.spins.iter().map(|spin| spin.brake_energy).sum::<f64>() - self.spared
    }

    fn friction_energy(&self) -> f64 {
        self.wheels.iter().map(|wheel| wheel.tire.energy_loss()).sum()
    }

    /// The tires on their rims: front left, front right, rear left, rear right.
    pub fn mounted(&self) -> &[Mounted<T>; WHEELS] {
        &self.wheels
    }
}
