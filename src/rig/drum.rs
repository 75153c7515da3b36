//! A drum rig: `super-elastic-drum`. A wheel in a swing arm with weights rolls on a drum, or inside of one, over cleats.
//!
//! After S. Y. Oh (2017), 6.1.2 and 7.2.2. The source gives neither the drum's diameter nor the arm's sizes: the defaults are
//! placeholders with which the wheel carries the least load that it names, 6572 N.

use super::hub::SLIP_FLOOR;
use super::{Actuation, Actuator, Command, Hub, HubParameters, Rolling, hub};
use crate::mechanics::{ABOUT, ALONG, check_step_size};
use crate::model::{Access, Model, Purpose, Role, Table, boolean_parameter, input, join, output, parameter};
use crate::road;
use crate::tire::{Motion, Mounted, Tire};
use crate::{Error, Result, boolean, clone_in_place, lens, rated, real};
use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

/// How far the arm may turn \[rad\]: what its sine and cosine are taken for is off by 5 % there.
const FARTHEST_TURN: f64 = 0.3;

/// The model: arm, wheel, tire and drum.
#[derive(Debug, PartialEq, Default, Serialize, Deserialize)]
pub struct Drum<T> {
    tire: Rolling<T>,
    /// Speed of the drum's surface \[m/s\].
    speed: Command,
    actuator: Actuator,
    actuation: Actuation,
    drive_torque: f64,
    brake_torque: f64,
    /// On the arm about its pivot \[N.m\].
    pivot_torque: f64,
    /// The wheel's centre moves with the mass of the arm at the wheel.
    hub: Hub,
    hub_parameters: HubParameters,
    diameter: f64,
    inside: bool,
    arm: Arm,
    sensors: Sensors,
    /// Way of the drum's surface since the start \[m\].
    way: f64,
    /// Height of the wheel's centre at the start, where the arm is level \[m\].
    level: f64,
    step_size: f64,
}

clone_in_place!(Drum<T> {
    tire,
    speed,
    actuator,
    actuation,
    drive_torque,
    brake_torque,
    pivot_torque,
    hub,
    hub_parameters,
    diameter,
    inside,
    arm,
    sensors,
    way,
    level,
    step_size,
});

/// The swing arm, which turns about a pivot behind the wheel.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
struct Arm {
    /// From the pivot to the wheel's centre \[m\].
    length: f64,
    /// Wheel and axle, without masses inside the tire's model \[kg\].
    wheel_mass: f64,
    mass: f64,
    /// From the pivot to its centre of mass \[m\].
    centre: f64,
    /// About the pivot, without wheel and weights \[kg.m²\].
    inertia: f64,
    weight_mass: f64,
    /// From the pivot to the weights \[m\]; beyond the wheel if larger than the length.
    weight_distance: f64,
    /// Of the pivot \[N.m.s/rad\].
    damping: f64,
}

impl Arm {
    /// Mass that moves with the wheel's centre: the moment of inertia about the pivot over the square of the length \[kg\].
    fn moved_mass(&self) -> f64 {
        let square = self.length * self.length;
        self.wheel_mass
            + (self.inertia + self.weight_mass * self.weight_distance * self.weight_distance) / square
    }

    /// Mass that rests on the wheel: the moment of the weights about the pivot over the length \[kg\].
    fn resting_mass(&self) -> f64 {
        self.wheel_mass + (self.mass * self.centre + self.weight_mass * self.weight_distance) / self.length
    }

    #[rustfmt::skip] // a row is a line
    fn rows() -> Table<Self> {
        Table::new([
            parameter("arm_length", "m", real!(length), 1.0, "From the pivot of the swing arm to the wheel's centre").range(0.05, 20.0).purpose(Purpose::Data),
            parameter("wheel_mass", "kg", real!(wheel_mass), 12.0, "Mass of rim and axle, without masses inside the tire's model").range(0.1, 1e4),
            parameter("arm_mass", "kg", real!(mass), 60.0, "Mass of the arm without wheel and weights").range(0.0, 1e4),
            parameter("arm_centre", "m", real!(centre), 0.5, "From the pivot to the arm's centre of mass").range(-20.0, 20.0).purpose(Purpose::Data),
            parameter("arm_inertia", "kg.m2", real!(inertia), 20.0, "Inertia of the arm about the pivot, without wheel and weights").range(0.0, 1e6),
            parameter("weight_mass", "kg", real!(weight_mass), 523.27, "Mass of the weights on the arm").range(0.0, 1e5).purpose(Purpose::Data),
            parameter("weight_distance", "m", real!(weight_distance), 1.2, "From the pivot to the weights: shifting them out loads the wheel, and makes the moved mass larger than the resting one").range(-20.0, 20.0).purpose(Purpose::Data),
            parameter("arm_damping", "N.m.s/rad", real!(damping), 0.0, "Damping of the pivot").range(0.0, 1e6).tunable(),
        ])
    }
}

/// Where the arm's sensors are: from the pivot \[m\].
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
struct Sensors {
    distance: [f64; 6],
    /// Of the three-axis ones, over the line from the pivot to the wheel's centre \[m\].
    height: [f64; 2],
}

impl Sensors {
    #[rustfmt::skip] // a row is a line
    fn rows() -> Table<Self> {
        Table::new([
            parameter("sensor_1_distance", "m", real!(distance[0]), 1.0, "From the pivot to accelerometer 1").range(-20.0, 20.0).purpose(Purpose::Data),
            parameter("sensor_2_distance", "m", real!(distance[1]), 0.5, "From the pivot to accelerometer 2").range(-20.0, 20.0).purpose(Purpose::Data),
            parameter("sensor_3_distance", "m", real!(distance[2]), 1.2, "From the pivot to accelerometer 3").range(-20.0, 20.0).purpose(Purpose::Data),
            parameter("sensor_4_distance", "m", real!(distance[3]), 1.0, "From the pivot to the displacement sensor 4").range(-20.0, 20.0).purpose(Purpose::Data),
            parameter("sensor_5_distance", "m", real!(distance[4]), 1.0, "From the pivot to the three-axis accelerometer 5").range(-20.0, 20.0).purpose(Purpose::Data),
            parameter("sensor_6_distance", "m", real!(distance[5]), 0.0, "From the pivot to the three-axis accelerometer 6").range(-20.0, 20.0).purpose(Purpose::Data),
            parameter("sensor_5_height", "m", real!(height[0]), 0.1, "Height of accelerometer 5 over the line from the pivot to the wheel's centre").range(-5.0, 5.0).purpose(Purpose::Data),
            parameter("sensor_6_height", "m", real!(height[1]), 0.1, "Height of accelerometer 6 over that line").range(-5.0, 5.0).purpose(Purpose::Data),
        ])
    }
}

impl<T: Tire> Model for Drum<T> {
    const NAME: &'static str = const { &join::<48>(&[T::NAME, "-drum"]) }.as_str();
    const DESCRIPTION: &'static str = const {
        &join::<256>(&[
            T::TITLE,
            " in a swing arm with weights on a drum with cleats: speed of the drum in, motion and accelerations of the arm and forces out",
        ])
    }
    .as_str();
    const STOP_TIME: f64 = 5.0;
    const DOCUMENTATION: &'static [&'static str] = &[
        include_str!("drum.html"),
        include_str!("actuator.html"),
        T::DOCUMENTATION,
        road::DOCUMENTATION,
        T::ON_ROAD,
    ];

    #[rustfmt::skip] // a row is a line
    fn variables() -> Table<Self> {
        Table::new([
            input("drum_speed", "m/s", rated!(speed), 2.0, "Speed of the drum's surface, positive where it turns the wheel forward").range(-50.0, 50.0).role(Role::TravelSpeed),
            input("drive_torque", "N.m", real!(drive_torque), 0.0, "Torque on the wheel about its axis, positive forward").range(-1e5, 1e5).nominal(100.0),
            input("brake_torque", "N.m", real!(brake_torque), 0.0, "Torque with which a brake can resist the spin, in either direction; a wheel that stands is held").range(0.0, 1e5).nominal(100.0),
            input("pivot_torque", "N.m", real!(pivot_torque), 0.0, "Further torque on the arm about its pivot, positive where it lifts the wheel: friction of the pivot, another actuator").range(-1e6, 1e6).nominal(100.0),
        ])
        .part("", lens!(tire), Rolling::rows()
            .with("road_kind", |row| row.start(8))
            .with("road_start", |row| row.start(2.0))
            .with("road_profile", |row| row.start(CLEAT)))
        .and([
            output("arm_displacement", "m", Access::computed(|m: &Self| m.raised() * m.sensors.distance[3] / m.arm.length), "Sensor 4: height of the arm there over its place at the start"),
            output("arm_acceleration_1", "m/s2", Access::computed(|m: &Self| m.acceleration_at(0)), "Accelerometer 1, vertical, without gravity"),
            output("arm_acceleration_2", "m/s2", Access::computed(|m: &Self| m.acceleration_at(1)), "Accelerometer 2, vertical, without gravity"),
            output("arm_acceleration_3", "m/s2", Access::computed(|m: &Self| m.acceleration_at(2)), "Accelerometer 3, vertical, without gravity"),
            output("arm_acceleration_5_x", "m/s2", Access::computed(|m: &Self| m.accelerations_of(0)[0]), "Accelerometer 5, away from the pivot"),
            output("arm_acceleration_5_z", "m/s2", Access::computed(|m: &Self| m.accelerations_of(0)[1]), "Accelerometer 5, vertical, without gravity; its y never moves"),
            output("arm_acceleration_6_x", "m/s2", Access::computed(|m: &Self| m.accelerations_of(1)[0]), "Accelerometer 6, away from the pivot"),
            output("arm_acceleration_6_z", "m/s2", Access::computed(|m: &Self| m.accelerations_of(1)[1]), "Accelerometer 6, vertical, without gravity; its y never moves"),
            output("wheel_lowered", "m", Access::computed(|m: &Self| m.tire.tire().radius() - m.hub.centre.position.z), "How much lower than without load on the bare drum the wheel's centre is"),
            output("arm_rate", "rad/s", Access::computed(|m: &Self| m.hub.centre.velocity.z / m.arm.length), "Rate at which the arm turns, upward"),
            output("wheel_velocity", "m/s", real!(hub.centre.velocity.z), "Velocity of the wheel's centre, upward"),
            output("pivot_force_x", "N", Access::computed(|m: &Self| -m.tire.mounted.force.x), "Force that the pivot holds the arm with along x, without inertia"),
            output("slip", "1", Access::computed(|m: &Self| m.slip()), "Longitudinal slip, (rolling radius times spin speed - v) / |v| with the speed v of the drum's surface (below 0.1 m/s, over 0.1 m/s)").role(Role::Slip),
            output("actual_drum_speed", "m/s", real!(actuator.position), "Speed of the drum's surface behind the actuator").role(Role::TravelSpeed),
            output("drum_angle", "rad", Access::computed(|m: &Self| m.way / (0.5 * m.diameter)), "Angle by which the drum has turned since the start"),
            output("drum_torque", "N.m", Access::computed(|m: &Self| m.drum_torque()), "Torque that it takes to turn the drum on with its speed; positive forward, with the drum's own friction left out").nominal(100.0),
            output("moved_mass", "kg", Access::computed(|m: &Self| m.arm.moved_mass()), "Mass that swings with the wheel's centre: inertia about the pivot over the square of arm_length"),
        ])
        .part("", lens!(hub), Hub::rows())
        .and([
            parameter("drum_diameter", "m", real!(diameter), 2.0, "Diameter of the drum; a placeholder, the source gives none").range(0.2, 100.0).purpose(Purpose::Data),
            boolean_parameter("drum_inside", boolean!(inside), false, "The wheel rolls inside of the drum"),
            parameter("wheel_inertia", "kg.m2", real!(hub_parameters.inertia), 0.15, "Inertia of what spins with the rim about the wheel's axis, without masses inside the tire's model").range(1e-3, 1e4),
        ])
        .part("", lens!(arm), Arm::rows())
        .part("", lens!(sensors), Sensors::rows())
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
        let radius = self.radius();
        let tire_radius = self.tire.tire().radius();
        if tire_radius >= -radius && self.inside {
            return Err(Error::variable(format!(
                "the wheel does not fit into the drum: drum_diameter = {} m, and the tire's radius is {tire_radius} m",
                self.diameter
            )));
        }
        self.tire.mount_on_drum(radius)?;
        self.hub_parameters.mass = self.arm.moved_mass();
        self.hub_parameters.gravity = 0.0;
        self.check_steps()?;
        let load = self.arm.resting_mass() * self.tire.tire().gravity();
        if load <= 0.0 {
            return Err(Error::variable(format!(
                "the arm lifts the wheel off: weights and arm load it with {load:.0} N"
            )));
        }
        self.actuator = Actuator::at_rest(&self.speed);
        self.way = 0.0;
        self.hub = Hub::default();
        self.tire.start_rolling(&self.rim(&Vector3::zeros(), 0.0), [0.0; 2], load)?;
        self.hub.centre.position.z = self.tire.mounted.rim.position.z;
        self.hub.spin.speed = self.tire.mounted.rim.rates.y;
        self.level = self.hub.centre.position.z;
        self.accelerate();
        Ok(())
    }

    fn tune(&mut self) -> Result<()> {
        self.check_steps()?;
        self.tire.tune()
    }

    fn check(&self) -> Result<()> {
        self.tire.check()
    }

    fn warning(&self) -> Option<String> {
        self.tire.mounted.warning()
    }

    fn step(&mut self, length: f64) -> Result<()> {
        let before = self.actuator.position;
        self.actuator.follow(&self.speed, self.actuation.corner(), length);
        let p = self.hub_parameters;
        let from = self.way;
        self.way += 0.5 * length * (before + self.actuator.position);
        let (velocity, speed) = self.hub.drift(&p, self.brake_torque, length);
        let rim = self.rim(&velocity, speed);
        self.tire.step(&rim, [from, 0.0], [self.way, 0.0], length)?;
        self.accelerate();
        self.hub.kick(&p, self.brake_torque, length);
        if !self.hub.is_finite() {
            return Err(Error::numeric("the arm's motion is no longer finite; a smaller step_size may help"));
        }
        let turn = self.raised() / self.arm.length;
        if turn.abs() > FARTHEST_TURN {
            return Err(Error::numeric(format!(
                "the arm has turned by {turn:.2} rad, and is taken for one that turns by {FARTHEST_TURN} rad at most"
            )));
        }
        Ok(())
    }
}

/// The cleat of the source's road file: 5 mm high, 150 mm long, with ramps of 50 mm.
const CLEAT: &str = "0 0; 0.05 0.005; 0.2 0.005; 0.25 0";

impl<T: Tire> Drum<T> {
    /// The wheel's motion over the drum: it travels as fast as the surface goes the other way.
    fn rim(&self, velocity: &Vector3<f64>, speed: f64) -> Motion<f64> {
        let over = Vector3::new(self.actuator.position, 0.0, velocity.z);
        self.hub.rim(&over, speed, (0.0, 0.0), (0.0, 0.0))
    }

    /// How much higher than at the start the wheel's centre is \[m\].
    fn raised(&self) -> f64 {
        self.hub.centre.position.z - self.level
    }

    /// Angular acceleration and rate of the arm, upward.
    fn turning(&self) -> [f64; 2] {
        [self.hub.centre.acceleration.z, self.hub.centre.velocity.z].map(|x| x / self.arm.length)
    }

    /// Vertical, of a sensor on the line from the pivot to the wheel's centre.
    fn acceleration_at(&self, sensor: usize) -> f64 {
        self.turning()[0] * self.sensors.distance[sensor]
    }

    /// Away from the pivot and vertical, of a three-axis sensor: what its arm takes of the turning, less what holds it on its circle.
    fn accelerations_of(&self, sensor: usize) -> [f64; 2] {
        let [turning, rate] = self.turning();
        let (out, up) = (self.sensors.distance[4 + sensor], self.sensors.height[sensor]);
        [-up * turning - out * rate * rate, out * turning - up * rate * rate]
    }

    /// Radius of the drum, negative inside of it \[m\].
    fn radius(&self) -> f64 {
        if self.inside { -0.5 * self.diameter } else { 0.5 * self.diameter }
    }

    /// What the tire takes of the rim's force and moment is taken from the drum, about whose axis it turns.
    fn drum_torque(&self) -> f64 {
        let (on_rim, radius) = (self.tire.tire().on_rim(), self.radius());
        let about = -on_rim.moment.y - (self.hub.centre.position.z + radius) * on_rim.force.x;
        about * radius.signum()
    }

    fn slip(&self) -> f64 {
        let place = [self.tire.road.within_turn(self.way), 0.0];
        let rolling_radius = self.tire.rolling_radius(place, self.hub.centre.position.z);
        hub::slip(rolling_radius * self.hub.spin.speed, self.actuator.position, SLIP_FLOOR)
    }

    /// Takes over what acts on arm and wheel now.
    fn accelerate(&mut self) {
        let tire = self.tire.tire();
        let weight = self.arm.resting_mass() * tire.gravity();
        let rate = self.hub.centre.velocity.z / self.arm.length;
        let about_pivot = self.pivot_torque - self.arm.damping * rate;
        let held = tire.on_rim().force.z - weight + about_pivot / self.arm.length;
        let torque = self.tire.mounted.spin_moment() + self.drive_torque;
        self.hub.load(&self.hub_parameters, &Vector3::new(0.0, 0.0, held), torque, &tire.carried());
        // the pivot holds it along and across
        (self.hub.centre.acceleration.x, self.hub.centre.acceleration.y) = (0.0, 0.0);
    }

    fn check_steps(&self) -> Result<()> {
        let [radial, _, windup] = self.tire.tire().links();
        check_step_size(self.step_size, ("moved_mass", self.arm.moved_mass()), &[radial], &ALONG)?;
        check_step_size(self.step_size, ("wheel_inertia", self.hub_parameters.inertia), &[windup], &ABOUT)
    }

    /// The tire on its rim.
    pub fn mounted(&self) -> &Mounted<T> {
        &self.tire.mounted
    }
}
