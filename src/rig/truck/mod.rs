//! An industrial truck: `super-elastic-counterbalance-truck`. Chassis, elastic cabin, mast with a carriage that can jump, two
//! driven front wheels and twin rear wheels on a bolster, straight over cleats.
//!
//! After S. Y. Oh (2017), 6.1.3 and 7.3. The source gives no masses and no sizes: defaults are placeholders with which a
//! front wheel carries about 8000 N empty and 15 000 N with 875 kg on the forks, as the source's runs do.

mod frame;
mod sizes;

use self::frame::{Frame, Places};
use self::sizes::Sizes;
use super::hub::{SLIP_FLOOR, turning_rows};
use super::{Actuation, Actuator, Command, OnRoad, hub};
use crate::mechanics::{ABOUT, ALONG, Spin, check_step_size};
use crate::model::{Access, Model, Purpose, Role, Table, input, integer_parameter, join, output, parameter};
use crate::road::{self, Road, RoadParameters};
use crate::tire::{Motion, Mounted, Tire};
use crate::{Error, Result, clone_in_place, integer, lens, rated, real};
use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

/// Front left, front right, rear left, rear right.
const WHEELS: usize = 4;
const WHEEL_NAMES: [&str; WHEELS] = ["front left", "front right", "rear left", "rear right"];
/// What drives the front wheels, from 1.
const DRIVES: &[(&str, &str)] =
    &[("speed", "a controller that keeps the speed"), ("torque", "the torque that is given")];

/// The model.
#[derive(Debug, PartialEq, Default, Serialize, Deserialize)]
pub struct CounterbalanceTruck<T> {
    speed: Command,
    torque: f64,
    drive: i32,
    /// Factor on the friction, over the road's own.
    friction: f64,
    actuation: Actuation,
    actuator: Actuator,
    road_parameters: RoadParameters,
    road: Road,
    /// Parameters of the tires in front and behind.
    tires: [T; 2],
    wheels: [Mounted<T>; WHEELS],
    spins: [Spin; WHEELS],
    /// Inertia of a wheel in front and behind, without masses inside the tires' models \[kg.m²\].
    wheel_inertia: [f64; 2],
    sizes: Sizes,
    frame: Frame,
    /// Height of a wheel's centre over the road at rest, in front and behind \[m\].
    level: [f64; 2],
    /// Way since the start \[m\].
    way: f64,
    /// Torque of the drive on both front wheels \[N.m\].
    driven: f64,
    /// What the controller has summed up \[m\].
    summed: f64,
    gains: [f64; 2],
    most_torque: f64,
    step_size: f64,
}

clone_in_place!(CounterbalanceTruck<T> {
    speed,
    torque,
    drive,
    friction,
    actuation,
    actuator,
    road_parameters,
    road,
    tires,
    wheels,
    spins,
    wheel_inertia,
    sizes,
    frame,
    level,
    way,
    driven,
    summed,
    gains,
    most_torque,
    step_size,
});

impl<T: Tire> Model for CounterbalanceTruck<T> {
    const NAME: &'static str = const { &join::<48>(&[T::NAME, "-counterbalance-truck"]) }.as_str();
    const DESCRIPTION: &'static str = const {
        &join::<256>(&[
            T::TITLE,
            "s under a counterbalance truck: speed or torque in; motions of axle, bolster, cabin and forks and forces of the wheels out",
        ])
    }
    .as_str();
    const STOP_TIME: f64 = 10.0;
    const DOCUMENTATION: &'static [&'static str] =
        &[include_str!("documentation.html"), T::DOCUMENTATION, road::DOCUMENTATION, T::ON_ROAD];

    #[rustfmt::skip] // a row is a line
    fn variables() -> Table<Self> {
        let table = Table::new([
            input("speed", "m/s", rated!(speed), 8.0 / 3.6, "Speed that the truck is to have, with speed control, and has at the start").range(-10.0, 10.0).role(Role::TravelSpeed),
            input("drive_torque", "N.m", real!(torque), 0.0, "Torque on both front wheels together, with torque").range(-1e5, 1e5).nominal(100.0),
            input("friction_factor", "1", real!(friction), 1.0, "Factor on the friction between tires and road, over the road's own").range(0.0, 10.0),
            output("truck_speed", "m/s", real!(frame.velocity.travel), "Speed of the truck (sensor 4)").role(Role::TravelSpeed),
            output("truck_distance", "m", real!(way), "Distance that the truck has travelled").role(Role::TravelDistance),
            output("drive_torque_actual", "N.m", real!(driven), "Torque of the drive on both front wheels together").nominal(100.0),
            output("axle_acceleration_left", "m/s2", Access::computed(|m: &Self| m.frame.acceleration.of_point(&m.sizes.places().wheels[0])), "Sensor 1: vertical acceleration of the front axle over the left wheel"),
            output("axle_acceleration_right", "m/s2", Access::computed(|m: &Self| m.frame.acceleration.of_point(&m.sizes.places().wheels[1])), "Sensor 2: the same on the right"),
            output("bolster_acceleration", "m/s2", Access::computed(|m: &Self| m.frame.acceleration.of_point(&m.sizes.places().bolster)), "Sensor 3: vertical acceleration of the steering bolster's pivot"),
            output("roof_acceleration", "m/s2", Access::computed(|m: &Self| m.roof_acceleration()), "Sensor 5: acceleration of the cabin's roof in the direction of travel"),
            output("seat_acceleration", "m/s2", Access::computed(|m: &Self| m.seat_acceleration()), "Sensor 6: vertical acceleration of the cabin beside the seat"),
            output("chassis_height", "m", real!(frame.position.chassis[0]), "Height of the chassis' centre of mass over its place at rest"),
            output("chassis_pitch", "rad", real!(frame.position.chassis[1]), "Pitch of the chassis, positive nose down"),
            output("chassis_roll", "rad", real!(frame.position.chassis[2]), "Roll of the chassis, positive to the right"),
            output("cabin_height", "m", real!(frame.position.cabin[0]), "Height of the cabin's centre of mass over its place at rest"),
            output("cabin_pitch", "rad", real!(frame.position.cabin[1]), "Pitch of the cabin"),
            output("cabin_roll", "rad", real!(frame.position.cabin[2]), "Roll of the cabin"),
            output("bolster_roll", "rad", real!(frame.position.bolster), "Roll of the bolster"),
            output("carriage_height", "m", real!(frame.position.carriage), "Height of fork carriage and payload over their place at rest"),
            output("chain_force", "N", real!(frame.chain), "Force of the mast's chains on the carriage; nothing while it jumps").nominal(1000.0),
        ]);
        let outputs = ["front_left.", "front_right.", "rear_left.", "rear_right."];
        let [a, b, c, d] = outputs;
        let wheel = |table: Table<Self>, prefix: &str, mounted, spin| {
            table.part(prefix, mounted, Mounted::rows().without_parameters()).part(prefix, spin, turning_rows())
        };
        let table = wheel(table, a, lens!(wheels[0]), lens!(spins[0]));
        let table = wheel(table, b, lens!(wheels[1]), lens!(spins[1]));
        let table = wheel(table, c, lens!(wheels[2]), lens!(spins[2]));
        let table = wheel(table, d, lens!(wheels[3]), lens!(spins[3]));
        let slips = [
            output("front_left.slip", "1", Access::computed(|m: &Self| m.slip(0)), SLIP).role(Role::Slip),
            output("front_right.slip", "1", Access::computed(|m: &Self| m.slip(1)), SLIP).role(Role::Slip),
            output("rear_left.slip", "1", Access::computed(|m: &Self| m.slip(2)), SLIP).role(Role::Slip),
            output("rear_right.slip", "1", Access::computed(|m: &Self| m.slip(3)), SLIP).role(Role::Slip),
        ];
        table.and(slips)
        .part("", lens!(sizes), Sizes::rows())
        .and([
            integer_parameter("drive", integer!(drive), 1, "What drives the front wheels").items(DRIVES).purpose(Purpose::Data),
            parameter("speed_gain", "N.s", real!(gains[0]), 1500.0, "Torque of the speed control over the speed that is missing").range(0.0, 1e6),
            parameter("speed_gain_integral", "N", real!(gains[1]), 1500.0, "Torque of the speed control over the way that is missing").range(0.0, 1e6),
            parameter("drive_torque_max", "N.m", real!(most_torque), 2000.0, "The most that the drive puts on both front wheels together").range(0.0, 1e6),
            parameter("front_wheel_inertia", "kg.m2", real!(wheel_inertia[0]), 3.0, "Inertia of a front wheel with what of the drive turns with it, without masses inside the tire's model").range(1e-3, 1e4),
            parameter("rear_wheel_inertia", "kg.m2", real!(wheel_inertia[1]), 0.08, "Inertia of a rear wheel about its axis, without masses inside the tire's model").range(1e-3, 1e4),
        ])
        .part("front_tire.", lens!(tires[0]), T::rows().only_parameters())
        .part("rear_tire.", lens!(tires[1]), REAR.iter().fold(T::rows().only_parameters(), |rows, (name, start)| {
            rows.starting_where_there(name, *start)
        }))
        .part("", lens!(road_parameters), RoadParameters::rows()
            .with("road_track_width", |row| row.start(0.9))
            .with("road_kind", |row| row.start(8))
            .with("road_profile", |row| row.start(CLEAT)))
        .and([
            parameter("step_size", "s", real!(step_size), T::STEP, "Step of the model's own time grid").range(1e-7, 1e-3).purpose(Purpose::Numerics).role(Role::Step),
        ])
        .part("", lens!(actuation), Actuation::rows())
        .without_derivatives_if(T::RIPPLES)
    }

    fn step_size(&self) -> f64 {
        self.step_size
    }

    fn initialize(&mut self) -> Result<()> {
        self.sizes.check()?;
        self.road = Road::new(&self.road_parameters)?;
        for tire in &mut self.tires {
            tire.mount(&self.road)?;
        }
        self.check_steps()?;
        self.actuator = Actuator::at_rest(&self.speed);
        let speed = self.actuator.position;
        (self.way, self.summed) = (0.0, 0.0);
        let gravity = self.tires[0].gravity();
        let loads = self.sizes.loads(gravity)?;
        for (i, name) in WHEEL_NAMES.into_iter().enumerate() {
            let place = self.places().of_wheel(i, 0.0);
            OnRoad::check_level(&self.road, "truck", name, place, self.tires[i / 2].radius())?;
        }
        // rear wheels roll freely, front ones pull what all take
        let mut means = [Vector3::zeros(); WHEELS];
        let (mut resistance, mut moment) = (0.0, 0.0);
        for i in (0..WHEELS).rev() {
            let axle = i / 2;
            let mut wheel = Mounted { tire: self.tires[axle].clone(), ..Mounted::default() };
            let rim = Motion { velocity: Vector3::new(speed, 0.0, 0.0), ..Motion::default() };
            let place = self.places().of_wheel(i, 0.0);
            let ground = OnRoad::at(&self.road, place, self.friction);
            wheel.start_rolling(&rim, &ground, loads[axle])?;
            let wanted = (axle == 0 && self.drive == 1 && speed != 0.0).then_some(0.5 * resistance);
            let (along, about) = pull(&mut wheel, &ground, loads[axle], wanted)?;
            if axle == 1 {
                resistance -= along;
            } else {
                moment += about;
            }
            means[i] = Vector3::new(along, 0.0, loads[axle]);
            self.level[axle] = wheel.rim.position.z;
            self.spins[i] = Spin { speed: wheel.rim.rates.y, ..Spin::default() };
            self.wheels[i] = wheel;
        }
        // a controller holds what rolling takes, and the truck stands level with it; a torque that is given accelerates and pitches it
        let held = if self.drive == 1 { -moment } else { 0.0 };
        if self.gains[1] > 0.0 && self.drive == 1 {
            self.summed = held / self.gains[1];
        }
        self.driven = if self.drive == 1 { held } else { self.given_torque() };
        self.frame = Frame::rolling(&self.sizes, speed, gravity, &means, self.level, held);
        self.accelerate();
        Ok(())
    }

    fn tune(&mut self) -> Result<()> {
        self.sizes.check()?;
        for tire in &mut self.tires {
            tire.tune()?;
        }
        self.check_steps()?;
        for (i, wheel) in self.wheels.iter_mut().enumerate() {
            wheel.tire.share_parameters(&self.tires[i / 2]);
            wheel.tire.tune()?;
        }
        Ok(())
    }

    fn check(&self) -> Result<()> {
        self.road.check()?;
        self.wheels.iter().try_for_each(|wheel| wheel.tire.check(&self.road))
    }

    fn warning(&self) -> Option<String> {
        self.wheels.iter().find_map(Mounted::warning)
    }

    fn step(&mut self, length: f64) -> Result<()> {
        self.actuator.follow(&self.speed, self.actuation.corner(), length);
        let from = self.way;
        let predicted = self.frame.drift(length);
        self.way += length * self.frame.velocity.travel;
        self.control(predicted.travel, length);
        let places = self.places();
        for i in 0..WHEELS {
            let inertia = self.inertia(i);
            let speed = self.spins[i].drift(inertia, 0.0, length);
            let rim = self.frame.rim(&places, i, self.level[i / 2], &predicted, (self.spins[i].angle, speed));
            let ground = OnRoad {
                road: &self.road,
                from: places.of_wheel(i, from),
                to: places.of_wheel(i, self.way),
                friction: self.friction,
            };
            self.wheels[i].step(&rim, &ground, length)?;
        }
        self.frame.predicted = predicted;
        self.accelerate();
        self.frame.kick(length);
        for i in 0..WHEELS {
            let inertia = self.inertia(i);
            self.spins[i].kick(inertia, 0.0, length);
        }
        if self.frame.is_finite() {
            Ok(())
        } else {
            Err(Error::numeric("the truck's motion is no longer finite; a smaller step_size may help"))
        }
    }
}

/// Radius and rubber of the rear tires, of which the source gives the radius only.
const REAR: &[(&str, f64)] = &[("tire_radius", 0.1725), ("tire_width", 0.12), ("rubber_mass", 9.0)];
/// The cleat of the source's runs: 10 mm high, 150 mm long, with ramps of 50 mm.
const CLEAT: &str = "0 0; 0.05 0.01; 0.2 0.01; 0.25 0";
const SLIP: &str =
    "Longitudinal slip, (rolling radius times spin speed - v) / |v| (below 0.1 m/s, over 0.1 m/s)";

/// Rounds of the search for the spin of a wheel that pulls: secants on a curve that is nearly straight.
const MOST_ROUNDS: usize = 20;
/// The share of its load to which it has to pull what it is to.
const PULL_FOUND: f64 = 1e-6;

/// Spin angles over which force and moment of a wheel are means: elements make them ripple.
const ANGLES: u32 = 8;
/// Between two of them \[rad\]: the golden section of a turn falls together with no number of elements.
const ANGLE: f64 = 2.399_963;

/// Lets a wheel that rolls freely turn so much faster that it pulls with a force \[N\] in the mean; if it cannot, or is not to, it
/// stays as it is. Returns the mean force along and moment about its axis.
fn pull<T: Tire>(
    wheel: &mut Mounted<T>,
    ground: &OnRoad<'_>,
    load: f64,
    force: Option<f64>,
) -> Result<(f64, f64)> {
    let free = wheel.rim;
    let mut at = |spin: f64| {
        let mut sums = (0.0, 0.0);
        // the last one is that of the start
        for k in (0..ANGLES).rev() {
            let mut rim = free;
            rim.rates.y = spin;
            rim.angles.y = ANGLE * f64::from(k);
            // the height is that of the wheel that rolls freely: the spin hardly changes it
            wheel.start(&rim, ground)?;
            sums = (sums.0 + wheel.force.x, sums.1 + wheel.spin_moment());
        }
        Ok::<_, Error>((sums.0 / f64::from(ANGLES), sums.1 / f64::from(ANGLES)))
    };
    let freely = at(free.rates.y)?;
    let Some(force) = force else { return Ok(freely) };
    let mut last = (free.rates.y, freely.0 - force);
    let mut spin = free.rates.y * 1.001;
    for _ in 0..MOST_ROUNDS {
        let means = at(spin)?;
        let now = (spin, means.0 - force);
        if now.1.abs() <= PULL_FOUND * load {
            return Ok(means);
        }
        let next = spin - now.1 * (now.0 - last.0) / (now.1 - last.1);
        if !next.is_finite() || (next / free.rates.y - 1.0).abs() > 1.0 {
            break;
        }
        (last, spin) = (now, next);
    }
    at(free.rates.y)
}

impl<T: Tire> CounterbalanceTruck<T> {
    fn places(&self) -> Places {
        self.sizes.places()
    }

    /// Of a wheel with the masses of its tire that turn with it.
    fn inertia(&self, i: usize) -> f64 {
        self.wheel_inertia[i / 2] + self.wheels[i].tire.carried().inertia
    }

    /// The torque that is given, as far as the drive has it.
    fn given_torque(&self) -> f64 {
        self.torque.clamp(-self.most_torque, self.most_torque)
    }

    /// The drive's torque in a step.
    fn control(&mut self, speed: f64, length: f64) {
        if self.drive != 1 {
            self.driven = self.given_torque();
            return;
        }
        let missing = self.actuator.position - speed;
        let [proportional, integral] = self.gains;
        let wanted = proportional * missing + integral * (self.summed + length * missing);
        self.driven = wanted.clamp(-self.most_torque, self.most_torque);
        // a drive at its limit does not sum up what it cannot do
        if self.driven == wanted {
            self.summed += length * missing;
        }
    }

    /// Takes over what acts now.
    fn accelerate(&mut self) {
        let forces = self.wheels.each_ref().map(|wheel| wheel.force);
        let front = self.driven;
        for i in 0..WHEELS {
            let carried = self.wheels[i].tire.carried();
            let driven = if i < 2 { 0.5 * front } else { 0.0 };
            // what the tire's masses take for their turning is in its moment already
            let torque = self.wheels[i].spin_moment() + driven + carried.inertia * carried.spin_acceleration;
            self.spins[i].free_acceleration = torque / self.inertia(i);
        }
        // the drive stands on the chassis, which it turns the other way
        self.frame.accelerate(&self.sizes, &forces, self.level, front);
    }

    fn roof_acceleration(&self) -> f64 {
        let a = &self.frame.acceleration;
        a.travel + self.sizes.roof_over_cabin() * a.cabin[1]
    }

    fn seat_acceleration(&self) -> f64 {
        self.frame.acceleration.of_cabin(self.sizes.seat())
    }

    fn slip(&self, i: usize) -> f64 {
        let wheel = &self.wheels[i];
        let place = self.places().of_wheel(i, self.way);
        let over = wheel.rim.position.z - self.road.mean(wheel.tire.window(), place[0], place[1]).height;
        let rolling = wheel.tire.rolling_radius(wheel.tire.radius() - over);
        hub::slip(rolling * self.spins[i].speed, self.frame.velocity.travel, SLIP_FLOOR)
    }

    /// Checks that `step_size` is short enough for what a wheel moves and turns, and for the cabin and the carriage.
    fn check_steps(&self) -> Result<()> {
        for (axle, (mass, inertia)) in [
            ("chassis_mass at a front wheel", "front_wheel_inertia"),
            ("chassis_mass at a rear wheel", "rear_wheel_inertia"),
        ]
        .into_iter()
        .enumerate()
        {
            let [radial, _, windup] = self.tires[axle].links();
            check_step_size(self.step_size, (mass, self.sizes.moved_mass(axle)), &[radial], &ALONG)?;
            check_step_size(self.step_size, (inertia, self.wheel_inertia[axle]), &[windup], &ABOUT)?;
        }
        check_step_size(
            self.step_size,
            ("cabin_mass", self.sizes.cabin_mass()),
            &[self.sizes.mounts()],
            &ALONG,
        )?;
        let carriage = ("carriage_mass", self.sizes.carriage_mass());
        check_step_size(self.step_size, carriage, &[self.sizes.chain_link()], &ALONG)
    }

    /// The tires on their rims: front left, front right, rear left, rear right.
    pub fn mounted(&self) -> &[Mounted<T>; WHEELS] {
        &self.wheels
    }
}
