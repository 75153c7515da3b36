//! `ring-brush-wheel`: the ring-and-brush tire on a hub with mass and spin. Forces of the axle, drive
//! and brake torque in, motion out: the unit that couples safely.

use super::hub::{slip, slip_angle};
use super::stability::{ABOUT, ALONG, check_step_size};
use super::table::{tire_table, with_road};
use super::{Actuation, Actuator, Command, Hub, HubParameters, MountedTire, OnRoad};
use crate::model::{Model, Variable, input};
use crate::road::{Road, RoadParameters};
use crate::tire::Motion;
use crate::{Error, Result, clone_in_place};
use nalgebra::Vector3;
use serde::{Deserialize, Serialize};
use std::f64::consts::TAU;

/// Speed below which slip and slip angle are no longer what their definitions say \[m/s\].
pub(super) const SLIP_FLOOR: f64 = 0.1;

/// The model: hub, tire, road and what acts on them.
#[derive(Debug, PartialEq, Default, Serialize, Deserialize)]
pub struct RingBrushWheel {
    tire: MountedTire,
    hub: Hub,
    hub_parameters: HubParameters,
    road_parameters: RoadParameters,
    road: Road,
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
    friction_factor: f64,
}

clone_in_place!(RingBrushWheel {
    tire,
    hub,
    hub_parameters,
    road_parameters,
    road,
    step_size,
    actuation,
    initial_speed,
    initial_load,
    commands,
    actuators,
    axle_force,
    drive_torque,
    brake_torque,
    friction_factor,
});

/// Access to a command and its rate.
macro_rules! command {
    ($index:literal) => {
        Access::Rated(
            |m: &Self| m.commands[$index].value,
            |m: &mut Self, value, rate| m.commands[$index] = Command { value, rate },
        )
    };
}

impl Model for RingBrushWheel {
    const NAME: &'static str = "ring-brush-wheel";
    const DESCRIPTION: &'static str = "Ring-and-brush tire on a hub with mass and spin: forces of the axle, drive and brake torque in, motion of the wheel out (ISO 8855 signs)";
    const STOP_TIME: f64 = 5.0;
    const DOCUMENTATION: &'static str = concat!(
        include_str!("wheel.html"),
        include_str!("actuator.html"),
        include_str!("hub.html"),
        include_str!("../tire/ring_brush/documentation.html"),
        include_str!("../road/documentation.html")
    );
    const VARIABLES: &'static [Variable<Self>] = with_road! { tire_table! {
        inputs: [
            input("axle_force_x", "N", real!(axle_force.x), 0.0, "Force of the axle on the hub, frame 0").range(-1e6, 1e6).nominal(1000.0),
            input("axle_force_y", "N", real!(axle_force.y), 0.0, "Force of the axle on the hub, frame 0").range(-1e6, 1e6).nominal(1000.0),
            input("axle_force_z", "N", real!(axle_force.z), -3800.0, "Force of the axle on the hub, frame 0: negative where it carries a vehicle").range(-1e6, 1e6).nominal(1000.0),
            input("drive_torque", "N.m", real!(drive_torque), 0.0, "Torque on the hub about its axis, positive forward").range(-1e5, 1e5).nominal(100.0),
            input("brake_torque", "N.m", real!(brake_torque), 0.0, "Torque with which the brake can resist the spin, in either direction; a wheel that stands is held").range(0.0, 1e5).nominal(100.0),
            input("camber", "rad", command!(0), 0.0, "Inclination angle of the axle; positive leans the top of the wheel to -y").range(-0.6, 0.6),
            input("steer", "rad", command!(1), 0.0, "Steer angle of the axle about z").range(-TAU, TAU),
            input("friction_factor", "1", real!(friction_factor), 1.0, "Factor on the friction between tire and road, over the road's own").range(0.0, 10.0),
        ],
        outputs: [
            output("position_x", "m", real!(hub.position.x), "Wheel centre, frame 0, from the start"),
            output("position_y", "m", real!(hub.position.y), "Wheel centre, frame 0, from the start"),
            output("position_z", "m", real!(hub.position.z), "Wheel centre over the datum of the road, frame 0"),
            output("velocity_x", "m/s", real!(hub.velocity.x), "Velocity of the wheel centre, frame 0"),
            output("velocity_y", "m/s", real!(hub.velocity.y), "Velocity of the wheel centre, frame 0"),
            output("velocity_z", "m/s", real!(hub.velocity.z), "Velocity of the wheel centre, frame 0"),
            output("wheel_angle", "rad", real!(hub.angle), "Spin angle of the wheel, unbounded"),
            output("wheel_speed", "rad/s", real!(hub.speed), "Spin speed of the wheel"),
            output("slip", "1", computed!(m: m.slip()), "Longitudinal slip, (rolling radius times spin speed - v) / |v| with the speed v in the wheel's heading (below 0.1 m/s, over 0.1 m/s); a locked wheel is -1 forward, +1 in reverse"),
            output("slip_angle", "rad", computed!(m: m.slip_angle()), "Slip angle of ISO 8855, atan2(v_y, |v_x|) in the wheel's heading: positive when the wheel travels to its left, forward or in reverse (0 below 0.1 m/s)"),
            output("bearing_moment_x", "N.m", computed!(m: m.bearing_moment().x), "Moment of the wheel on the axle about the wheel centre, H axes: the tire's less what turns the spin axis").nominal(100.0),
            output("bearing_moment_z", "N.m", computed!(m: m.bearing_moment().z), "The same about z").nominal(100.0),
            output("brake_torque_actual", "N.m", real!(hub.brake_torque), "Torque with which the brake resisted the forward spin in the last step; on a wheel that stands, what it takes to hold it").nominal(100.0),
            output("brake_energy", "J", real!(hub.brake_energy), "Energy that the brake turned into heat since the start").nominal(1e4),
            output("road_elevation", "m", computed!(m: m.road.at(m.hub.position.x, m.hub.position.y).height), "Height of the filtered road below the wheel centre"),
        ],
        locals: [],
        parameters: [
            parameter("hub_mass", "kg", real!(hub_parameters.mass), 30.0, "Mass of hub, rim and what moves with them, without the tire's belt").range(0.1, 1e4),
            parameter("hub_inertia", "kg.m2", real!(hub_parameters.inertia), 0.7, "Inertia of what spins with the rim about the wheel's axis, without the tire's belt").range(1e-3, 1e4),
            parameter("initial_speed", "m/s", real!(initial_speed), 20.0, "Speed in the wheel's heading at the start; the wheel rolls freely").range(-100.0, 100.0),
            parameter("initial_load", "N", real!(initial_load), 4100.0, "Vertical force of the tire on the rim at the start, from which the height follows").range(0.0, 1e5),
            parameter("actuator_frequency", "rad/s", real!(actuation.frequency), 200.0, "Corner of the critically damped filter between camber and steer as commanded and as they are; its delay is 2 over this").range(1.0, 1e5).tunable(),
            parameter("step_size", "s", real!(step_size), 1e-4, "Step of the model's own time grid").range(1e-7, 5e-4),
        ],
        appended: [
            boolean_parameter("command_actuators", boolean!(actuation.on), true, "Actuators between camber and steer as commanded and as they are: true, whether commands come with derivatives or not; false, the commands are the motion"),
        ],
    }};

    fn step_size(&self) -> f64 {
        self.step_size
    }

    fn step_work(&self) -> f64 {
        self.tire.step_work()
    }

    fn initialize(&mut self) -> Result<()> {
        self.tire.mount()?;
        self.road = Road::new(&self.road_parameters)?;
        self.check_steps()?;
        self.hub_parameters.gravity = self.tire.parameters.gravity;
        self.actuators = [Actuator::at_rest(&self.commands[0]), Actuator::at_rest(&self.commands[1])];
        let (sin, cos) = libm::sincos(self.actuators[1].position);
        self.hub = Hub {
            velocity: Vector3::new(self.initial_speed * cos, self.initial_speed * sin, 0.0),
            ..Hub::default()
        };
        let ground = OnRoad::at(&self.road, [0.0; 2], self.friction_factor);
        self.tire.start_rolling(&self.rim(), &ground, self.initial_load)?;
        self.hub.position.z = self.tire.rim.position.z;
        self.hub.speed = self.tire.rim.rates.y;
        self.accelerate();
        Ok(())
    }

    fn tune(&mut self) -> Result<()> {
        self.check_steps()?;
        self.tire.tune()
    }

    fn check(&self) -> Result<()> {
        self.tire.check()?;
        self.road.check()
    }

    fn warning(&self) -> Option<String> {
        self.tire.warning()
    }

    fn step(&mut self, length: f64) -> Result<()> {
        for (actuator, command) in self.actuators.iter_mut().zip(&self.commands) {
            actuator.follow(command, self.actuation.corner(), length);
        }
        let p = self.hub_parameters;
        let from = [self.hub.position.x, self.hub.position.y];
        let (velocity, speed) = self.hub.drift(&p, self.brake_torque, length);
        let to = [self.hub.position.x, self.hub.position.y];
        let rim = self.rim_with(&velocity, speed);
        let ground = OnRoad { road: &self.road, from, to, friction: self.friction_factor };
        self.tire.step(&rim, &ground, length)?;
        self.accelerate();
        self.hub.kick(&p, self.brake_torque, length);
        if self.hub.position.iter().all(|x| x.is_finite()) {
            Ok(())
        } else {
            Err(Error::numeric("the wheel's position is no longer finite; a smaller step_size may help"))
        }
    }
}

impl RingBrushWheel {
    fn rim(&self) -> Motion<f64> {
        self.rim_with(&self.hub.velocity, self.hub.speed)
    }

    fn rim_with(&self, velocity: &Vector3<f64>, speed: f64) -> Motion<f64> {
        let [camber, steer] = &self.actuators;
        self.hub.rim(velocity, speed, (camber.position, steer.position), (camber.velocity, steer.velocity))
    }

    /// Checks that `step_size` is short enough for the hub and the side wall.
    fn check_steps(&self) -> Result<()> {
        let HubParameters { mass, inertia, .. } = self.hub_parameters;
        let hub = ("hub_mass", mass);
        check_step_size(self.step_size, hub, &[self.tire.radial()], &ALONG)?;
        check_step_size(self.step_size, hub, &[self.tire.lateral()], &ALONG)?;
        check_step_size(self.step_size, ("hub_inertia", inertia), &[self.tire.windup()], &ABOUT)
    }

    /// Loads the hub with what acts on it now.
    fn accelerate(&mut self) {
        let force = self.tire.state.on_rim.force + self.axle_force;
        let torque = self.tire.spin_moment() + self.drive_torque;
        self.hub.load(&self.hub_parameters, &force, torque);
    }

    /// Velocity of the wheel centre in H axes.
    fn heading_velocity(&self) -> Vector3<f64> {
        super::mounted::to_heading(self.actuators[1].position, &self.hub.velocity)
    }

    fn slip(&self) -> f64 {
        slip(self.tire.parameters.rolling_radius * self.hub.speed, self.heading_velocity().x, SLIP_FLOOR)
    }

    fn slip_angle(&self) -> f64 {
        let v = self.heading_velocity();
        slip_angle(v.x, v.y, SLIP_FLOOR)
    }

    /// What the tire puts on the hub, but for the moment about the spin axis, less the rate of the hub's
    /// spin momentum; H axes.
    fn bearing_moment(&self) -> Vector3<f64> {
        let [camber, steer] = &self.actuators;
        let (sin, cos) = libm::sincos(camber.position);
        let axis = Vector3::new(0.0, cos, sin);
        let axis_rate = Vector3::new(-steer.velocity * cos, -sin * camber.velocity, cos * camber.velocity);
        self.tire.moment
            - axis * self.tire.spin_moment()
            - axis_rate * (self.hub_parameters.inertia * self.hub.speed)
    }
}
