//! A tire on a hub with mass and spin: `ring-brush-wheel`. Forces of the axle, drive and brake torque in, motion out:
//! the unit that couples safely.

use super::hub::{SLIP_FLOOR, slip, slip_angle};
use super::{Actuation, Actuator, Command, Hub, HubParameters, Rolling};
use crate::mechanics::{ABOUT, ALONG, Spin, check_step_size};
use crate::model::{Access, Model, Purpose, Role, Table, input, integer_parameter, join, output, parameter};
use crate::road;
use crate::tire::{Motion, Mounted, Tire, to_heading};
use crate::{Error, Result, clone_in_place, integer, lens, rated, real};
use nalgebra::Vector3;
use serde::{Deserialize, Serialize};
use std::f64::consts::TAU;

/// The model: hub, tire, road and what acts on them.
#[derive(Debug, PartialEq, Default, Serialize, Deserialize)]
pub struct Wheel<T> {
    tire: Rolling<T>,
    hub: Hub,
    hub_parameters: HubParameters,
    step_size: f64,
    actuation: Actuation,
    initial_speed: f64,
    initial_load: f64,
    /// Camber and steer angle as commanded.
    commands: [Command; 2],
    actuators: [Actuator; 2],
    axle_force: Vector3<f64>,
    drive_torque: f64,
    brake_torque: f64,
    /// What drives the wheel.
    drive: i32,
    drive_speed: Command,
    spin_actuator: Actuator,
    /// The torque that the drive had to put on the wheel \[N.m\].
    driven: f64,
}

/// What drives the wheel, from 1.
const DRIVES: &[(&str, &str)] =
    &[("torque", "the torque that is given"), ("speed", "a drive that keeps the spin speed that is given")];

clone_in_place!(Wheel<T> {
    tire,
    hub,
    hub_parameters,
    step_size,
    actuation,
    initial_speed,
    initial_load,
    commands,
    actuators,
    axle_force,
    drive_torque,
    brake_torque,
    drive,
    drive_speed,
    spin_actuator,
    driven,
});

impl<T: Tire> Model for Wheel<T> {
    const NAME: &'static str = const { &join::<48>(&[T::NAME, "-wheel"]) }.as_str();
    const DESCRIPTION: &'static str = const {
        &join::<256>(&[
            T::TITLE,
            " on a hub with mass and spin: forces of the axle, drive and brake torque in, motion of the wheel out (ISO 8855 signs)",
        ])
    }
    .as_str();
    const STOP_TIME: f64 = 5.0;
    const DOCUMENTATION: &'static [&'static str] = &[
        include_str!("wheel.html"),
        include_str!("actuator.html"),
        include_str!("hub.html"),
        T::DOCUMENTATION,
        road::DOCUMENTATION,
        T::ON_ROAD,
    ];

    #[rustfmt::skip] // a row is a line
    fn variables() -> Table<Self> {
        Table::new([
            input("axle_force_x", "N", real!(axle_force.x), 0.0, "Force of the axle on the hub, frame 0").range(-1e6, 1e6).nominal(1000.0).role(Role::LongitudinalForce),
            input("axle_force_y", "N", real!(axle_force.y), 0.0, "Force of the axle on the hub, frame 0").range(-1e6, 1e6).nominal(1000.0).role(Role::LateralForce),
            input("axle_force_z", "N", real!(axle_force.z), -3800.0, "Force of the axle on the hub, frame 0: negative where it carries a vehicle").range(-1e6, 1e6).nominal(1000.0).role(Role::Load),
            input("drive_torque", "N.m", real!(drive_torque), 0.0, "Torque on the hub about its axis, positive forward").range(-1e5, 1e5).nominal(100.0),
            input("brake_torque", "N.m", real!(brake_torque), 0.0, "Torque with which the brake can resist the spin, in either direction; a wheel that stands is held").range(0.0, 1e5).nominal(100.0),
            input("drive_speed", "rad/s", rated!(drive_speed), 0.0, "Spin speed of the wheel where drive says speed; drive and brake torque do nothing then").range(-1e3, 1e3),
            input("camber", "rad", rated!(commands[0]), 0.0, "Inclination angle of the axle; positive leans the top of the wheel to -y").range(-0.6, 0.6).role(Role::Camber),
            input("steer", "rad", rated!(commands[1]), 0.0, "Steer angle of the axle about z").range(-TAU, TAU).role(Role::SteerAngle),
        ])
        .part("", lens!(tire), Rolling::rows())
        .and([
            output("position_x", "m", real!(hub.centre.position.x), "Wheel centre, frame 0, from the start"),
            output("position_y", "m", real!(hub.centre.position.y), "Wheel centre, frame 0, from the start"),
            output("position_z", "m", real!(hub.centre.position.z), "Wheel centre over the datum of the road, frame 0"),
            output("velocity_x", "m/s", real!(hub.centre.velocity.x), "Velocity of the wheel centre, frame 0"),
            output("velocity_y", "m/s", real!(hub.centre.velocity.y), "Velocity of the wheel centre, frame 0"),
            output("velocity_z", "m/s", real!(hub.centre.velocity.z), "Velocity of the wheel centre, frame 0"),
            output("slip", "1", Access::computed(|m: &Self| m.slip()), "Longitudinal slip, (rolling radius times spin speed - v) / |v| with the speed v in the wheel's heading (below 0.1 m/s, over 0.1 m/s); a locked wheel is -1 forward, +1 in reverse").role(Role::Slip),
            output("slip_angle", "rad", Access::computed(|m: &Self| m.slip_angle()), "Slip angle of ISO 8855, atan2(v_y, |v_x|) in the wheel's heading: positive when the wheel travels to its left, forward or in reverse (0 below 0.1 m/s)").role(Role::SlipAngle),
            output("drive_torque_actual", "N.m", real!(driven), "Torque of the drive on the hub: drive_torque, or what it takes to keep drive_speed").nominal(100.0),
            output("bearing_moment_x", "N.m", Access::computed(|m: &Self| m.bearing_moment().x), "Moment of the wheel on the axle about the wheel centre, H axes: the tire's less what turns the spin axis").nominal(100.0),
            output("bearing_moment_z", "N.m", Access::computed(|m: &Self| m.bearing_moment().z), "The same about z").nominal(100.0),
            output("road_elevation", "m", Access::computed(|m: &Self| m.tire.surface(m.hub.place()).height), "Height of the road below the wheel centre, as the tire bridges it"),
        ])
        .part("", lens!(hub), Hub::rows())
        .part("", lens!(hub_parameters), HubParameters::rows())
        .and([
            integer_parameter("drive", integer!(drive), 1, "What drives the wheel").items(DRIVES).purpose(Purpose::Data),
            parameter("initial_speed", "m/s", real!(initial_speed), 20.0, "Speed in the wheel's heading at the start; the wheel rolls freely, or has its drive_speed").range(-100.0, 100.0).purpose(Purpose::Start),
            parameter("initial_load", "N", real!(initial_load), 4100.0, "Vertical force of the tire on the rim at the start, from which the height follows").range(0.0, 1e5).purpose(Purpose::Start),
            parameter("step_size", "s", real!(step_size), T::STEP, "Step of the model's own time grid").range(1e-7, 1e-3).purpose(Purpose::Numerics).role(Role::Step),
        ])
        .part("", lens!(actuation), Actuation::rows())
        .without_derivatives_if(T::RIPPLES)
    }

    fn step_size(&self) -> f64 {
        self.step_size
    }

    fn initialize(&mut self) -> Result<()> {
        self.tire.mount()?;
        self.check_steps()?;
        self.hub_parameters.gravity = self.tire.tire().gravity();
        self.actuators = [Actuator::at_rest(&self.commands[0]), Actuator::at_rest(&self.commands[1])];
        let (sin, cos) = libm::sincos(self.actuators[1].position);
        self.hub = Hub::moving(Vector3::new(self.initial_speed * cos, self.initial_speed * sin, 0.0));
        self.spin_actuator = Actuator::at_rest(&self.drive_speed);
        if self.keeps_speed() {
            self.hub.spin.speed = self.spin_actuator.position;
            self.tire.start_carrying(&self.rim(), [0.0; 2], self.initial_load)?;
        } else {
            self.tire.start_rolling(&self.rim(), [0.0; 2], self.initial_load)?;
        }
        self.hub.centre.position.z = self.tire.mounted.rim.position.z;
        self.hub.spin.speed = self.tire.mounted.rim.rates.y;
        self.accelerate();
        if self.keeps_speed() {
            self.driven = -self.tire.mounted.spin_moment();
        }
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
        for (actuator, command) in self.actuators.iter_mut().zip(&self.commands) {
            actuator.follow(command, self.actuation.corner(), length);
        }
        let p = self.hub_parameters;
        let from = self.hub.place();
        let (before, angle) = (self.spin_actuator.position, self.hub.spin.angle);
        let (velocity, mut speed) = self.hub.drift(&p, self.brake_torque, length);
        if self.keeps_speed() {
            self.spin_actuator.follow(&self.drive_speed, self.actuation.corner(), length);
            speed = self.spin_actuator.position;
            self.hub.spin.angle = angle + 0.5 * length * (before + speed);
        }
        let rim = self.rim_with(&velocity, speed);
        self.tire.step(&rim, from, self.hub.place(), length)?;
        self.accelerate();
        self.hub.kick(&p, self.brake_torque, length);
        if self.keeps_speed() {
            self.hub.spin = Spin { speed, angle: self.hub.spin.angle, ..Spin::default() };
            // the tire's moment has what its own masses take
            self.driven = p.inertia * (speed - before) / length - self.tire.mounted.spin_moment();
        }
        if self.hub.is_finite() {
            Ok(())
        } else {
            Err(Error::numeric("the wheel's motion is no longer finite; a smaller step_size may help"))
        }
    }
}

impl<T: Tire> Wheel<T> {
    fn rim(&self) -> Motion<f64> {
        self.rim_with(&self.hub.centre.velocity, self.hub.spin.speed)
    }

    fn rim_with(&self, velocity: &Vector3<f64>, speed: f64) -> Motion<f64> {
        let [camber, steer] = &self.actuators;
        self.hub.rim(velocity, speed, (camber.position, steer.position), (camber.velocity, steer.velocity))
    }

    /// Checks that `step_size` is short enough for the hub and the side wall.
    fn check_steps(&self) -> Result<()> {
        let HubParameters { mass, inertia, .. } = self.hub_parameters;
        let hub = ("hub_mass", mass);
        let [radial, lateral, windup] = self.tire.tire().links();
        check_step_size(self.step_size, hub, &[radial], &ALONG)?;
        check_step_size(self.step_size, hub, &[lateral], &ALONG)?;
        check_step_size(self.step_size, ("hub_inertia", inertia), &[windup], &ABOUT)
    }

    /// The drive keeps the spin speed.
    fn keeps_speed(&self) -> bool {
        self.drive == 2
    }

    /// Loads the hub with what acts on it now.
    fn accelerate(&mut self) {
        self.driven = self.drive_torque;
        let force = self.tire.tire().on_rim().force + self.axle_force;
        let torque = self.tire.mounted.spin_moment() + self.drive_torque;
        self.hub.load(&self.hub_parameters, &force, torque, &self.tire.tire().carried());
    }

    /// Velocity of the wheel centre in H axes.
    fn heading_velocity(&self) -> Vector3<f64> {
        to_heading(self.actuators[1].position, &self.hub.centre.velocity)
    }

    fn slip(&self) -> f64 {
        let rolling_radius = self.tire.rolling_radius(self.hub.place(), self.hub.centre.position.z);
        slip(rolling_radius * self.hub.spin.speed, self.heading_velocity().x, SLIP_FLOOR)
    }

    fn slip_angle(&self) -> f64 {
        let v = self.heading_velocity();
        slip_angle(v.x, v.y, SLIP_FLOOR)
    }

    /// Energy of the hub's motion and height \[J\]; the tire's own is not in it.
    pub fn energy(&self) -> f64 {
        self.hub.energy(&self.hub_parameters)
    }

    /// Tire, rim and road.
    pub fn rolling(&self) -> &Rolling<T> {
        &self.tire
    }

    /// The tire on its rim.
    pub fn mounted(&self) -> &Mounted<T> {
        &self.tire.mounted
    }

    /// What the tire puts on the hub, but for the moment about the spin axis, less the rate of the hub's
    /// spin momentum; H axes.
    fn bearing_moment(&self) -> Vector3<f64> {
        let [camber, steer] = &self.actuators;
        let (sin, cos) = libm::sincos(camber.position);
        let axis = Vector3::new(0.0, cos, sin);
        let axis_rate = Vector3::new(-steer.velocity * cos, -sin * camber.velocity, cos * camber.velocity);
        self.tire.mounted.moment
            - axis * self.tire.mounted.spin_moment()
            - axis_rate * (self.hub_parameters.inertia * self.hub.spin.speed)
    }
}
