//! A quarter of a vehicle on a tire: `ring-brush-corner`. It travels straight along x: sprung mass and wheel move
//! vertically, vehicle and wheel along the road, the wheel spins freely.

use super::hub::{SLIP_FLOOR, slip};
use super::{Hub, HubParameters, Rolling};
use crate::mechanics::{ABOUT, ALONG, BumpStop, Link, PointMass, SpringDamper, check_step_size};
use crate::model::{Access, Model, Purpose, Role, Table, input, join, local, output, parameter};
use crate::road::{self, Road, Surface};
use crate::tire::{Motion, Mounted, Tire};
use crate::{Error, Result, clone_in_place, lens, real};
use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

/// The model: vehicle, suspension, hub, tire and road.
#[derive(Debug, PartialEq, Default, Serialize, Deserialize)]
pub struct Corner<T> {
    tire: Rolling<T>,
    hub: Hub,
    hub_parameters: HubParameters,
    body: Body,
    vehicle: Vehicle,
    step_size: f64,
    initial_speed: f64,
    drive_torque: f64,
    brake_torque: f64,
    body_force: [f64; 2],
}

clone_in_place!(Corner<T> {
    tire,
    hub,
    hub_parameters,
    body,
    vehicle,
    step_size,
    initial_speed,
    drive_torque,
    brake_torque,
    body_force,
});

/// Masses and suspension.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
struct Vehicle {
    vehicle_mass: f64,
    sprung_mass: f64,
    /// Along x.
    fore_aft: SpringDamper,
    vertical: SpringDamper,
    /// Against the wheel's way up in the vehicle.
    bump_stop: BumpStop,
}

/// What moves besides the wheel, and what holds it there.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
struct Body {
    /// Along x the vehicle and the distance that it has travelled, along z its sprung mass and its height over the static
    /// position. It does not move along y.
    frame: PointMass,
    /// Force of the suspension on the hub, beyond the static load \[N\].
    suspension: Vector3<f64>,
    /// Where the wheel's centre is in the static position.
    wheel_height: f64,
    /// Heat in the suspension's dampers since the start \[J\].
    damper_energy: f64,
}

impl<T: Tire> Model for Corner<T> {
    const NAME: &'static str = const { &join::<48>(&[T::NAME, "-corner"]) }.as_str();
    const DESCRIPTION: &'static str = const {
        &join::<256>(&[
            T::TITLE,
            " under a quarter of a vehicle, travelling straight: brake torque in; wheel speed, vehicle speed, slip and forces out (ISO 8855 signs)",
        ])
    }
    .as_str();
    const STOP_TIME: f64 = 5.0;
    const DOCUMENTATION: &'static [&'static str] = &[
        include_str!("corner.html"),
        include_str!("hub.html"),
        T::DOCUMENTATION,
        road::DOCUMENTATION,
        T::ON_ROAD,
    ];

    #[rustfmt::skip] // a row is a line
    fn variables() -> Table<Self> {
        Table::new([
            input("brake_torque", "N.m", real!(brake_torque), 0.0, "Torque with which the brake can resist the spin, in either direction; a wheel that stands is held").range(0.0, 1e5).nominal(100.0),
            input("drive_torque", "N.m", real!(drive_torque), 0.0, "Torque on the wheel about its axis, positive forward").range(-1e5, 1e5).nominal(100.0),
            input("body_force_x", "N", real!(body_force[0]), 0.0, "Further force on the vehicle along x: drag, a trailer, other wheels").range(-1e6, 1e6).nominal(1000.0).role(Role::LongitudinalForce),
            input("body_force_z", "N", real!(body_force[1]), 0.0, "Further force on the sprung mass, upward: load transfer, downforce (negative)").range(-1e6, 1e6).nominal(1000.0).role(Role::Load),
        ])
        .part("", lens!(tire), Rolling::rows())
        .and([
            output("vehicle_speed", "m/s", real!(body.frame.velocity.x), "Speed of the vehicle").role(Role::TravelSpeed),
            output("vehicle_distance", "m", real!(body.frame.position.x), "Distance that the vehicle has travelled").role(Role::TravelDistance),
            output("vehicle_acceleration", "m/s2", real!(body.frame.acceleration.x), "Acceleration of the vehicle along x"),
            output("slip", "1", Access::computed(|m: &Self| m.slip()), "Longitudinal slip, (rolling radius times spin speed - v) / |v| with the speed v of the wheel centre (below 0.1 m/s, over 0.1 m/s); a locked wheel is -1 forward, +1 in reverse").role(Role::Slip),
            output("body_height", "m", real!(body.frame.position.z), "Height of the sprung mass over its static position"),
            output("wheel_height", "m", Access::computed(|m: &Self| m.hub.centre.position.z - m.body.wheel_height), "Height of the wheel centre over its static position"),
            output("wheel_fore_aft", "m", Access::computed(|m: &Self| m.hub.centre.position.x - m.body.frame.position.x), "Wheel centre before its place in the vehicle"),
            output("suspension_force_x", "N", real!(body.suspension.x), "Force of the suspension on the wheel along x: minus the force that brakes the vehicle").nominal(1000.0).role(Role::LongitudinalForce),
            output("suspension_force_z", "N", Access::computed(|m: &Self| m.body.suspension.z - m.vehicle.sprung_mass * m.hub_parameters.gravity), "Force of spring and damper on the wheel, upward: negative where they carry the vehicle").nominal(1000.0).role(Role::Load),
            output("friction_energy", "J", Access::computed(|m: &Self| m.tire.tire().energy_loss()), "Energy lost in the contact since the start: contact_energy_loss").nominal(1e4),
            output("damper_energy", "J", real!(body.damper_energy), "Energy that the suspension's dampers turned into heat since the start").nominal(100.0),
            output("road_elevation", "m", Access::computed(|m: &Self| m.under_wheel().height), "Height of the road below the wheel centre, as the tire bridges it"),
            local("wheel_velocity_x", "m/s", real!(hub.centre.velocity.x), "Velocity of the wheel centre along x"),
            local("wheel_velocity_z", "m/s", real!(hub.centre.velocity.z), "Velocity of the wheel centre along z"),
            local("body_velocity_z", "m/s", real!(body.frame.velocity.z), "Velocity of the sprung mass along z"),
        ])
        .part("", lens!(hub), Hub::rows())
        .and([
            parameter("vehicle_mass", "kg", real!(vehicle.vehicle_mass), 420.0, "Mass that this wheel brakes, without masses inside the tire's model: at least sprung_mass + hub_mass, more where other wheels do not brake").range(1.0, 1e6),
            parameter("sprung_mass", "kg", real!(vehicle.sprung_mass), 380.0, "Mass that the suspension carries").range(1.0, 1e5),
        ])
        .part("", lens!(hub_parameters), HubParameters::rows().with("hub_mass", |row| row.start(40.0)))
        .and([
            parameter("suspension_stiffness", "N/m", real!(vehicle.vertical.stiffness), 38e3, "Spring between wheel and sprung mass, vertical").range(1.0, 1e7).tunable().role(Role::Stiffness),
            parameter("suspension_damping", "N.s/m", real!(vehicle.vertical.damping), 2600.0, "Damper between wheel and sprung mass, vertical").range(0.0, 1e6).tunable(),
            parameter("fore_aft_stiffness", "N/m", real!(vehicle.fore_aft.stiffness), 750e3, "Stiffness of the wheel's guidance along x").range(1e3, 1e9).tunable().role(Role::Stiffness),
            parameter("fore_aft_damping", "N.s/m", real!(vehicle.fore_aft.damping), 900.0, "Damping of the wheel's guidance along x").range(0.0, 1e6).tunable(),
            parameter("initial_speed", "m/s", real!(initial_speed), 27.8, "Speed at the start; the wheel rolls freely").range(-100.0, 100.0).purpose(Purpose::Start),
            parameter("step_size", "s", real!(step_size), T::STEP, "Step of the model's own time grid").range(1e-7, 1e-3).purpose(Purpose::Numerics).role(Role::Step),
            parameter("bump_stop_gap", "m", real!(vehicle.bump_stop.gap), 0.08, "Way of the wheel up in the vehicle from the static position until it meets the bump stop").range(0.0, 1.0).purpose(Purpose::Data),
            parameter("bump_stop_stiffness", "N/m2", real!(vehicle.bump_stop.stiffness), 0.0, "Force of the bump stop over the square of the way into it; 0: there is none").range(0.0, 1e10).role(Role::Stiffness).tunable(),
        ])
        .without_derivatives_if(T::RIPPLES)
    }

    fn step_size(&self) -> f64 {
        self.step_size
    }

    fn initialize(&mut self) -> Result<()> {
        self.tire.mount()?;
        let Vehicle { vehicle_mass, sprung_mass, .. } = self.vehicle;
        let (hub_mass, gravity) = (self.hub_parameters.mass, self.tire.tire().gravity());
        if vehicle_mass < sprung_mass + hub_mass {
            return Err(Error::variable(format!(
                "vehicle_mass = {vehicle_mass} kg is less than sprung_mass + hub_mass = {} kg",
                sprung_mass + hub_mass
            )));
        }
        self.check_steps()?;
        self.hub_parameters.gravity = gravity;
        let velocity = Vector3::new(self.initial_speed, 0.0, 0.0);
        self.hub = Hub::moving(velocity);
        self.body = Body { frame: PointMass { velocity, ..PointMass::default() }, ..Body::default() };
        let load = (sprung_mass + hub_mass) * gravity;
        let rim = self.hub.rim(&velocity, self.hub.spin.speed, (0.0, 0.0), (0.0, 0.0));
        self.tire.start_rolling(&rim, [0.0; 2], load)?;
        self.hub.centre.position.z = self.tire.mounted.rim.position.z;
        self.hub.spin.speed = self.tire.mounted.rim.rates.y;
        // the rolling resistance has already moved the wheel back in the vehicle
        let share = (vehicle_mass - hub_mass) / vehicle_mass;
        self.hub.centre.position.x = share * self.tire.mounted.force.x / self.vehicle.fore_aft.stiffness;
        self.body.wheel_height = self.hub.centre.position.z;
        self.accelerate(&velocity, &velocity);
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
        let p = self.hub_parameters;
        let heat_before = self.damping_power();

        // half a kick and drift of all masses; what damps sees the velocities predicted for the end
        let predicted = self.body.frame.drift(length);
        let from = self.hub.place();
        let (velocity, speed) = self.hub.drift(&p, self.brake_torque, length);
        let rim: Motion<f64> = self.hub.rim(&velocity, speed, (0.0, 0.0), (0.0, 0.0));
        self.tire.step(&rim, from, self.hub.place(), length)?;

        // forces at the end, and the second half of the kick
        self.accelerate(&velocity, &predicted);
        self.body.frame.kick(length);
        self.hub.kick(&p, self.brake_torque, length);
        self.body.damper_energy += 0.5 * length * (heat_before + self.damping_power());
        if self.body.frame.is_finite() && self.hub.is_finite() {
            Ok(())
        } else {
            Err(Error::numeric("the vehicle's motion is no longer finite; a smaller step_size may help"))
        }
    }
}

impl<T: Tire> Corner<T> {
    /// Forces at the present places for these velocities of hub and body.
    fn accelerate(&mut self, hub_velocity: &Vector3<f64>, body_velocity: &Vector3<f64>) {
        let Vehicle { vehicle_mass, sprung_mass, fore_aft, vertical, bump_stop } = self.vehicle;
        let gravity = self.hub_parameters.gravity;
        let (way, rate) = (self.suspension_way(), body_velocity - hub_velocity);
        let x = fore_aft.force(way.x, rate.x);
        let z = vertical.force(way.z, rate.z) - bump_stop.force(-way.z);
        self.body.suspension = Vector3::new(x, 0.0, z);
        // what this wheel brakes but does not carry stands on other wheels, on the same grade
        let elsewhere = vehicle_mass - sprung_mass - self.hub_parameters.mass;
        let grade = elsewhere * gravity * self.under_wheel().slope[0];
        self.body.frame.acceleration = Vector3::new(
            (self.body_force[0] - x - grade) / (vehicle_mass - self.hub_parameters.mass),
            0.0,
            (self.body_force[1] - z) / sprung_mass,
        );
        let weight = sprung_mass * gravity;
        let mut force = self.tire.tire().on_rim().force + Vector3::new(x, 0.0, z - weight);
        // the vehicle guides the wheel sideways
        force.y = 0.0;
        let torque = self.tire.mounted.spin_moment() + self.drive_torque;
        self.hub.load(&self.hub_parameters, &force, torque, &self.tire.tire().carried());
    }

    /// How far the body is from its place over the wheel \[m\].
    fn suspension_way(&self) -> Vector3<f64> {
        let (body, hub) = (self.body.frame.position, self.hub.centre.position);
        Vector3::new(body.x - hub.x, 0.0, body.z - (hub.z - self.body.wheel_height))
    }

    /// The road below the wheel as the tire bridges it.
    fn under_wheel(&self) -> Surface {
        self.tire.surface(self.hub.place())
    }

    /// Checks that `step_size` is short enough for the masses and what is between them.
    fn check_steps(&self) -> Result<()> {
        let Vehicle { vehicle_mass, sprung_mass, fore_aft, vertical, .. } = self.vehicle;
        let HubParameters { mass, inertia, .. } = self.hub_parameters;
        let guidance = Link {
            stiffness: ("fore_aft_stiffness", fore_aft.stiffness),
            damping: ("fore_aft_damping", fore_aft.damping),
            mass: ("vehicle_mass less hub_mass", vehicle_mass - mass),
        };
        let suspension = Link {
            stiffness: ("suspension_stiffness", vertical.stiffness),
            damping: ("suspension_damping", vertical.damping),
            mass: ("sprung_mass", sprung_mass),
        };
        let hub = ("hub_mass", mass);
        let [radial, _, windup] = self.tire.tire().links();
        check_step_size(self.step_size, hub, &[guidance, radial], &ALONG)?;
        check_step_size(self.step_size, hub, &[suspension, radial], &ALONG)?;
        check_step_size(self.step_size, ("hub_inertia", inertia), &[windup], &ABOUT)
    }

    /// Power of the suspension's dampers \[W\].
    fn damping_power(&self) -> f64 {
        let rate = self.body.frame.velocity - self.hub.centre.velocity;
        self.vehicle.fore_aft.power_loss(rate.x) + self.vehicle.vertical.power_loss(rate.z)
    }

    /// Energy of the motions, of the heights and of the springs \[J\]; the tire's own is not in it, nor that of a
    /// grade that other wheels stand on.
    pub fn energy(&self) -> f64 {
        let Vehicle { vehicle_mass, sprung_mass, fore_aft, vertical, bump_stop } = self.vehicle;
        let p = &self.hub_parameters;
        let way = self.suspension_way();
        let mass = Vector3::new(vehicle_mass - p.mass, 0.0, sprung_mass);
        // in the static position the spring carries the weight: that lifts the body as much as it presses the hub
        self.hub.energy(p)
            + self.body.frame.kinetic_energy(&mass)
            + sprung_mass * p.gravity * self.hub.centre.position.z
            + fore_aft.energy(way.x)
            + vertical.energy(way.z)
            + bump_stop.energy(-way.z)
    }

    fn slip(&self) -> f64 {
        let rolling_radius = self.tire.rolling_radius(self.hub.place(), self.hub.centre.position.z);
        slip(rolling_radius * self.hub.spin.speed, self.hub.centre.velocity.x, SLIP_FLOOR)
    }

    /// The tire on its rim.
    pub fn mounted(&self) -> &Mounted<T> {
        &self.tire.mounted
    }

    /// The road.
    pub fn road(&self) -> &Road {
        &self.tire.road
    }

    /// Height of the wheel's centre over the road in the static position \[m\].
    pub fn static_height(&self) -> f64 {
        self.body.wheel_height
    }
}
