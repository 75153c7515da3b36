//! `ring-brush-corner`: a quarter of a vehicle on the ring-and-brush tire. It travels straight along x:
//! sprung mass and wheel move vertically, vehicle and wheel along the road, the wheel spins freely.

use super::hub::slip;
use super::stability::{ABOUT, ALONG, Link, check_step_size};
use super::table::{tire_table, with_road};
use super::wheel::SLIP_FLOOR;
use super::{Hub, HubParameters, MountedTire, OnRoad};
use crate::model::{Model, Variable, input};
use crate::road::{Road, RoadParameters};
use crate::tire::Motion;
use crate::{Error, Result, clone_in_place};
use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

/// The model: vehicle, suspension, hub, tire and road.
#[derive(Debug, PartialEq, Default, Serialize, Deserialize)]
pub struct RingBrushCorner {
    tire: MountedTire,
    hub: Hub,
    hub_parameters: HubParameters,
    body: Body,
    vehicle: Vehicle,
    road_parameters: RoadParameters,
    road: Road,
    step_size: f64,
    initial_speed: f64,
    drive_torque: f64,
    brake_torque: f64,
    friction_factor: f64,
    body_force: [f64; 2],
}

clone_in_place!(RingBrushCorner {
    tire,
    hub,
    hub_parameters,
    body,
    vehicle,
    road_parameters,
    road,
    step_size,
    initial_speed,
    drive_torque,
    brake_torque,
    friction_factor,
    body_force,
});

/// Masses and suspension.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
struct Vehicle {
    vehicle_mass: f64,
    sprung_mass: f64,
    /// Vertical, along x.
    stiffness: [f64; 2],
    damping: [f64; 2],
}

/// What moves besides the wheel: along x the vehicle, along z its sprung mass.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
struct Body {
    /// Travelled distance; height over the static position \[m\].
    position: [f64; 2],
    velocity: [f64; 2],
    acceleration: [f64; 2],
    /// Force of the suspension on the hub in x and z, beyond the static load \[N\].
    suspension: [f64; 2],
    /// Where the wheel's centre is in the static position.
    wheel_height: f64,
    /// Heat in the suspension's dampers since the start \[J\].
    damper_energy: f64,
}

impl Model for RingBrushCorner {
    const NAME: &'static str = "ring-brush-corner";
    const DESCRIPTION: &'static str = "Quarter of a vehicle on the ring-and-brush tire, travelling straight: brake torque in; wheel speed, vehicle speed, slip and forces out (ISO 8855 signs)";
    const STOP_TIME: f64 = 5.0;
    const DOCUMENTATION: &'static str = concat!(
        include_str!("corner.html"),
        include_str!("hub.html"),
        include_str!("../tire/ring_brush/documentation.html"),
        include_str!("../road/documentation.html")
    );
    const VARIABLES: &'static [Variable<Self>] = with_road! { tire_table! {
        inputs: [
            input("brake_torque", "N.m", real!(brake_torque), 0.0, "Torque with which the brake can resist the spin, in either direction; a wheel that stands is held").range(0.0, 1e5).nominal(100.0),
            input("drive_torque", "N.m", real!(drive_torque), 0.0, "Torque on the wheel about its axis, positive forward").range(-1e5, 1e5).nominal(100.0),
            input("friction_factor", "1", real!(friction_factor), 1.0, "Factor on the friction between tire and road, over the road's own").range(0.0, 10.0),
            input("body_force_x", "N", real!(body_force[0]), 0.0, "Further force on the vehicle along x: drag, a trailer, other wheels").range(-1e6, 1e6).nominal(1000.0),
            input("body_force_z", "N", real!(body_force[1]), 0.0, "Further force on the sprung mass, upward: load transfer, downforce (negative)").range(-1e6, 1e6).nominal(1000.0),
        ],
        outputs: [
            output("wheel_speed", "rad/s", real!(hub.speed), "Spin speed of the wheel"),
            output("vehicle_speed", "m/s", real!(body.velocity[0]), "Speed of the vehicle"),
            output("vehicle_distance", "m", real!(body.position[0]), "Distance that the vehicle has travelled"),
            output("vehicle_acceleration", "m/s2", real!(body.acceleration[0]), "Acceleration of the vehicle along x"),
            output("slip", "1", computed!(m: m.slip()), "Longitudinal slip, (rolling radius times spin speed - v) / |v| with the speed v of the wheel centre (below 0.1 m/s, over 0.1 m/s); a locked wheel is -1 forward, +1 in reverse"),
            output("body_height", "m", real!(body.position[1]), "Height of the sprung mass over its static position"),
            output("wheel_height", "m", computed!(m: m.hub.position.z - m.body.wheel_height), "Height of the wheel centre over its static position"),
            output("wheel_fore_aft", "m", computed!(m: m.hub.position.x - m.body.position[0]), "Wheel centre before its place in the vehicle"),
            output("suspension_force_x", "N", real!(body.suspension[0]), "Force of the suspension on the wheel along x: minus the force that brakes the vehicle").nominal(1000.0),
            output("suspension_force_z", "N", computed!(m: m.body.suspension[1] - m.vehicle.sprung_mass * m.hub_parameters.gravity), "Force of spring and damper on the wheel, upward: negative where they carry the vehicle").nominal(1000.0),
            output("brake_torque_actual", "N.m", real!(hub.brake_torque), "Torque with which the brake resisted the forward spin in the last step; on a wheel that stands, what it takes to hold it").nominal(100.0),
            output("brake_energy", "J", real!(hub.brake_energy), "Energy that the brake turned into heat since the start").nominal(1e4),
            output("friction_energy", "J", real!(tire.state.energy_loss), "Energy lost in the contact since the start: contact_energy_loss").nominal(1e4),
            output("damper_energy", "J", real!(body.damper_energy), "Energy that the suspension's dampers turned into heat since the start").nominal(100.0),
            output("wheel_angle", "rad", real!(hub.angle), "Spin angle of the wheel, unbounded"),
            output("road_elevation", "m", computed!(m: m.road.at(m.hub.position.x, 0.0).height), "Height of the filtered road below the wheel centre"),
        ],
        locals: [
            local("wheel_velocity_x", "m/s", real!(hub.velocity.x), "Velocity of the wheel centre along x"),
            local("wheel_velocity_z", "m/s", real!(hub.velocity.z), "Velocity of the wheel centre along z"),
            local("body_velocity_z", "m/s", real!(body.velocity[1]), "Velocity of the sprung mass along z"),
        ],
        parameters: [
            parameter("vehicle_mass", "kg", real!(vehicle.vehicle_mass), 420.0, "Mass that this wheel brakes, without the tire's belt: at least sprung_mass + hub_mass, more where other wheels do not brake").range(1.0, 1e6),
            parameter("sprung_mass", "kg", real!(vehicle.sprung_mass), 380.0, "Mass that the suspension carries").range(1.0, 1e5),
            parameter("hub_mass", "kg", real!(hub_parameters.mass), 40.0, "Unsprung mass without the tire's belt").range(0.1, 1e4),
            parameter("hub_inertia", "kg.m2", real!(hub_parameters.inertia), 0.7, "Inertia of what spins with the rim about the wheel's axis, without the tire's belt").range(1e-3, 1e4),
            parameter("suspension_stiffness", "N/m", real!(vehicle.stiffness[1]), 38e3, "Spring between wheel and sprung mass, vertical").range(1.0, 1e7).tunable(),
            parameter("suspension_damping", "N.s/m", real!(vehicle.damping[1]), 2600.0, "Damper between wheel and sprung mass, vertical").range(0.0, 1e6).tunable(),
            parameter("fore_aft_stiffness", "N/m", real!(vehicle.stiffness[0]), 750e3, "Stiffness of the wheel's guidance along x").range(1e3, 1e9).tunable(),
            parameter("fore_aft_damping", "N.s/m", real!(vehicle.damping[0]), 900.0, "Damping of the wheel's guidance along x").range(0.0, 1e6).tunable(),
            parameter("initial_speed", "m/s", real!(initial_speed), 27.8, "Speed at the start; the wheel rolls freely").range(-100.0, 100.0),
            parameter("step_size", "s", real!(step_size), 1e-4, "Step of the model's own time grid").range(1e-7, 5e-4),
        ],
        appended: [],
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
        let Vehicle { vehicle_mass, sprung_mass, .. } = self.vehicle;
        let (hub_mass, gravity) = (self.hub_parameters.mass, self.tire.parameters.gravity);
        if vehicle_mass < sprung_mass + hub_mass {
            return Err(Error::variable(format!(
                "vehicle_mass = {vehicle_mass} kg is less than sprung_mass + hub_mass = {} kg",
                sprung_mass + hub_mass
            )));
        }
        self.check_steps()?;
        self.hub_parameters.gravity = gravity;
        self.hub = Hub { velocity: Vector3::new(self.initial_speed, 0.0, 0.0), ..Hub::default() };
        self.body = Body { velocity: [self.initial_speed, 0.0], ..Body::default() };
        let ground = OnRoad::at(&self.road, [0.0; 2], self.friction_factor);
        let load = (sprung_mass + hub_mass) * gravity;
        let rim = self.hub.rim(&self.hub.velocity, self.hub.speed, (0.0, 0.0), (0.0, 0.0));
        self.tire.start_rolling(&rim, &ground, load)?;
        self.hub.position.z = self.tire.rim.position.z;
        self.hub.speed = self.tire.rim.rates.y;
        // the rolling resistance has already moved the wheel back in the vehicle
        let share = (vehicle_mass - hub_mass) / vehicle_mass;
        self.hub.position.x = share * self.tire.force.x / self.vehicle.stiffness[0];
        self.body.wheel_height = self.hub.position.z;
        self.accelerate(&self.hub.velocity.clone(), self.body.velocity);
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
        let (p, half) = (self.hub_parameters, 0.5 * length);
        let heat_before = self.damping_power(&self.hub.velocity, self.body.velocity);

        // half a kick and drift of all masses; what damps sees the velocities predicted for the end
        let body = &mut self.body;
        body.velocity = sum(body.velocity, body.acceleration, half);
        body.position = sum(body.position, body.velocity, length);
        let predicted = sum(body.velocity, body.acceleration, half);
        let from = [self.hub.position.x, self.hub.position.y];
        let (velocity, speed) = self.hub.drift(&p, self.brake_torque, length);
        let to = [self.hub.position.x, self.hub.position.y];
        let rim: Motion<f64> = self.hub.rim(&velocity, speed, (0.0, 0.0), (0.0, 0.0));
        let ground = OnRoad { road: &self.road, from, to, friction: self.friction_factor };
        self.tire.step(&rim, &ground, length)?;

        // forces at the end, and the second half of the kick
        self.accelerate(&velocity, predicted);
        self.body.velocity = sum(self.body.velocity, self.body.acceleration, half);
        self.hub.kick(&p, self.brake_torque, length);
        let heat = self.damping_power(&self.hub.velocity, self.body.velocity);
        self.body.damper_energy += half * (heat_before + heat);
        let state = self.body.position.iter().chain(self.hub.position.iter());
        if state.chain([&self.hub.speed]).all(|x| x.is_finite()) {
            Ok(())
        } else {
            Err(Error::numeric("the vehicle's motion is no longer finite; a smaller step_size may help"))
        }
    }
}

/// a + factor b.
fn sum(a: [f64; 2], b: [f64; 2], factor: f64) -> [f64; 2] {
    [a[0] + factor * b[0], a[1] + factor * b[1]]
}

impl RingBrushCorner {
    /// Forces at the present places for these velocities of hub and body.
    fn accelerate(&mut self, hub_velocity: &Vector3<f64>, body_velocity: [f64; 2]) {
        let Vehicle { vehicle_mass, sprung_mass, stiffness, damping } = self.vehicle;
        let weight = sprung_mass * self.hub_parameters.gravity;
        let places = [self.hub.position.x, self.hub.position.z - self.body.wheel_height];
        let speeds = [hub_velocity.x, hub_velocity.z];
        for axis in 0..2 {
            self.body.suspension[axis] = stiffness[axis] * (self.body.position[axis] - places[axis])
                + damping[axis] * (body_velocity[axis] - speeds[axis]);
        }
        let [x, z] = self.body.suspension;
        // what this wheel brakes but does not carry stands on other wheels, on the same grade
        let elsewhere = vehicle_mass - sprung_mass - self.hub_parameters.mass;
        let grade = elsewhere * self.hub_parameters.gravity * self.road.at(self.hub.position.x, 0.0).slope[0];
        self.body.acceleration = [
            (self.body_force[0] - x - grade) / (vehicle_mass - self.hub_parameters.mass),
            (self.body_force[1] - z) / sprung_mass,
        ];
        let mut force = self.tire.state.on_rim.force + Vector3::new(x, 0.0, z - weight);
        // the vehicle guides the wheel sideways
        force.y = 0.0;
        let torque = self.tire.spin_moment() + self.drive_torque;
        self.hub.load(&self.hub_parameters, &force, torque);
    }

    /// Checks that `step_size` is short enough for the masses and what is between them.
    fn check_steps(&self) -> Result<()> {
        let Vehicle { vehicle_mass, sprung_mass, stiffness, damping } = self.vehicle;
        let HubParameters { mass, inertia, .. } = self.hub_parameters;
        let guidance = Link {
            stiffness: ("fore_aft_stiffness", stiffness[0]),
            damping: ("fore_aft_damping", damping[0]),
            mass: ("vehicle_mass less hub_mass", vehicle_mass - mass),
        };
        let suspension = Link {
            stiffness: ("suspension_stiffness", stiffness[1]),
            damping: ("suspension_damping", damping[1]),
            mass: ("sprung_mass", sprung_mass),
        };
        let hub = ("hub_mass", mass);
        check_step_size(self.step_size, hub, &[guidance, self.tire.radial()], &ALONG)?;
        check_step_size(self.step_size, hub, &[suspension, self.tire.radial()], &ALONG)?;
        check_step_size(self.step_size, ("hub_inertia", inertia), &[self.tire.windup()], &ABOUT)
    }

    /// Power of the suspension's dampers \[W\].
    fn damping_power(&self, hub_velocity: &Vector3<f64>, body_velocity: [f64; 2]) -> f64 {
        let [x, z] = [body_velocity[0] - hub_velocity.x, body_velocity[1] - hub_velocity.z];
        self.vehicle.damping[0] * x * x + self.vehicle.damping[1] * z * z
    }

    fn slip(&self) -> f64 {
        let rolling = self.tire.parameters.rolling_radius * self.hub.speed;
        slip(rolling, self.hub.velocity.x, SLIP_FLOOR)
    }

    /// The tire on its rim.
    pub fn mounted(&self) -> &MountedTire {
        &self.tire
    }

    /// The road.
    pub fn road(&self) -> &Road {
        &self.road
    }

    /// Height of the wheel's centre over the road in the static position \[m\].
    pub fn static_height(&self) -> f64 {
        self.body.wheel_height
    }
}
