//! `ring-brush-tire`: the ring-and-brush tire by itself. Pose and velocity of the rim in, force and
//! moment on the rim out; the road is a plane that the master gives.

use super::table::tire_table;
use super::{Command, MountedTire};
use crate::model::{Model, Variable, input};
use crate::tire::{Ground, Motion, Plane};
use crate::{Result, clone_in_place};
use nalgebra::Vector3;
use serde::{Deserialize, Serialize};
use std::f64::consts::TAU;

/// The model: the rim and the plane as the master gives them, and the tire.
#[derive(Debug, PartialEq, Default, Serialize, Deserialize)]
pub struct RingBrushTire {
    tire: MountedTire,
    step_size: f64,
    /// Pose and velocity of the rim in frame 0, x and y included.
    rim: Motion<f64>,
    plane: RoadPlane,
    /// Where the rim was over the road at the end of the last step.
    place: [f64; 2],
}

clone_in_place!(RingBrushTire { tire, step_size, rim, plane, place });

/// A plane through a point.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
struct RoadPlane {
    point: [Command; 3],
    slope: [Command; 2],
    friction: f64,
}

/// Access to a command and its rate.
macro_rules! command {
    ($($path:tt)+) => {
        Access::Rated(
            |m: &Self| m.$($path)+.value,
            |m: &mut Self, value, rate| m.$($path)+ = Command { value, rate },
        )
    };
}

impl Model for RingBrushTire {
    const NAME: &'static str = "ring-brush-tire";
    const DESCRIPTION: &'static str = "Ring-and-brush tire alone: pose and velocity of the rim and a road plane in, force and moment on the rim out (ISO 8855 signs)";
    const DOCUMENTATION: &'static str =
        concat!(include_str!("bare.html"), include_str!("../tire/ring_brush/documentation.html"));
    const VARIABLES: &'static [Variable<Self>] = tire_table! {
        inputs: [
            input("rim_x", "m", real!(rim.position.x), 0.0, "Wheel centre, frame 0; between communication points it runs on with rim_velocity_x").runs_on(|m| m.rim.velocity.x),
            input("rim_y", "m", real!(rim.position.y), 0.0, "Wheel centre, frame 0; runs on with rim_velocity_y").runs_on(|m| m.rim.velocity.y),
            input("rim_z", "m", real!(rim.position.z), 0.319, "Wheel centre, frame 0; runs on with rim_velocity_z").runs_on(|m| m.rim.velocity.z),
            input("rim_camber", "rad", real!(rim.angles.x), 0.0, "Inclination angle; positive leans the top of the wheel to -y; runs on with rim_camber_rate").range(-0.6, 0.6).runs_on(|m| m.rim.rates.x),
            input("rim_spin", "rad", real!(rim.angles.y), 0.0, "Spin angle, unbounded; runs on with rim_spin_rate").runs_on(|m| m.rim.rates.y),
            input("rim_steer", "rad", real!(rim.angles.z), 0.0, "Steer angle about z; runs on with rim_steer_rate").range(-TAU, TAU).runs_on(|m| m.rim.rates.z),
            input("rim_velocity_x", "m/s", real!(rim.velocity.x), 10.0, "Velocity of the wheel centre, frame 0").range(-200.0, 200.0),
            input("rim_velocity_y", "m/s", real!(rim.velocity.y), 0.0, "Velocity of the wheel centre, frame 0").range(-200.0, 200.0),
            input("rim_velocity_z", "m/s", real!(rim.velocity.z), 0.0, "Velocity of the wheel centre, frame 0").range(-200.0, 200.0),
            input("rim_camber_rate", "rad/s", real!(rim.rates.x), 0.0, "Rate of the inclination angle").range(-200.0, 200.0),
            input("rim_spin_rate", "rad/s", real!(rim.rates.y), 10.0 / 0.328, "Rate of the spin angle, positive rolling forward").range(-2000.0, 2000.0),
            input("rim_steer_rate", "rad/s", real!(rim.rates.z), 0.0, "Rate of the steer angle").range(-200.0, 200.0),
            input("road_x", "m", command!(plane.point[0]), 0.0, "Point of the road plane, frame 0: where road_height holds; on a level road it does not matter"),
            input("road_y", "m", command!(plane.point[1]), 0.0, "Point of the road plane, frame 0"),
            input("road_height", "m", command!(plane.point[2]), 0.0, "Height of the road plane at road_x, road_y").range(-1e4, 1e4),
            input("road_slope_x", "1", command!(plane.slope[0]), 0.0, "Slope dz/dx of the road plane").range(-1.0, 1.0),
            input("road_slope_y", "1", command!(plane.slope[1]), 0.0, "Slope dz/dy of the road plane").range(-1.0, 1.0),
            input("friction_factor", "1", real!(plane.friction), 1.0, "Factor on the friction between tire and road").range(0.0, 10.0),
        ],
        outputs: [
            output("global_force_x", "N", real!(tire.state.on_rim.force.x), "Force of the tire on the rim, frame 0").nominal(1000.0),
            output("global_force_y", "N", real!(tire.state.on_rim.force.y), "Force of the tire on the rim, frame 0").nominal(1000.0),
            output("global_force_z", "N", real!(tire.state.on_rim.force.z), "Force of the tire on the rim, frame 0").nominal(1000.0),
            output("global_moment_x", "N.m", real!(tire.state.on_rim.moment.x), "Moment of the tire on the rim about the wheel centre, frame 0").nominal(100.0),
            output("global_moment_y", "N.m", real!(tire.state.on_rim.moment.y), "Moment of the tire on the rim about the wheel centre, frame 0").nominal(100.0),
            output("global_moment_z", "N.m", real!(tire.state.on_rim.moment.z), "Moment of the tire on the rim about the wheel centre, frame 0").nominal(100.0),
            output("spin_moment", "N.m", computed!(m: m.tire.spin_moment()), "Moment of the tire on the rim about the wheel's own axis").nominal(100.0),
        ],
        locals: [],
        parameters: [
            parameter("step_size", "s", real!(step_size), 1e-4, "Step of the model's own time grid").range(1e-7, 5e-4),
        ],
        road: [],
    };

    fn step_size(&self) -> f64 {
        self.step_size
    }

    fn step_work(&self) -> f64 {
        self.tire.step_work()
    }

    fn initialize(&mut self) -> Result<()> {
        self.tire.mount()?;
        self.place = [self.rim.position.x, self.rim.position.y];
        let rim = self.above_ground();
        self.tire.start(&rim, &self.ground(0.0))
    }

    fn tune(&mut self) -> Result<()> {
        self.tire.tune()
    }

    fn check(&self) -> Result<()> {
        self.tire.check()
    }

    fn warning(&self) -> Option<String> {
        self.tire.warning()
    }

    fn step(&mut self, length: f64) -> Result<()> {
        let rim = self.above_ground();
        // The tire's belt travels relative to the rim by velocities; where the master's positions say
        // otherwise, they are right.
        let before = &self.tire.rim.velocity;
        let way = [before.x + rim.velocity.x, before.y + rim.velocity.y].map(|v| 0.5 * length * v);
        let ground = self.ground(length);
        let belt = &mut self.tire.state.belt.position;
        belt.x -= self.rim.position.x - self.place[0] - way[0];
        belt.y -= self.rim.position.y - self.place[1] - way[1];
        self.tire.step(&rim, &ground, length)?;
        self.place = [self.rim.position.x, self.rim.position.y];
        Ok(())
    }
}

impl RingBrushTire {
    /// The rim as the tire takes it: seen from the point below its centre.
    fn above_ground(&self) -> Motion<f64> {
        let mut rim = self.rim;
        rim.position = Vector3::new(0.0, 0.0, rim.position.z);
        rim
    }

    fn ground(&self, length: f64) -> UnderRim {
        let to = [self.rim.position.x, self.rim.position.y];
        UnderRim { plane: self.plane, from: self.place, to, length }
    }
}

/// The plane for the length of a step, in which the rim travels.
struct UnderRim {
    plane: RoadPlane,
    from: [f64; 2],
    to: [f64; 2],
    length: f64,
}

impl Ground for UnderRim {
    fn under(&self, belt: &Motion<f64>, share: f64) -> Plane {
        // commands hold their values at the end of the step
        let left = (1.0 - share) * self.length;
        let at = |c: &Command| c.value - c.rate.unwrap_or(0.0) * left;
        let rate = |c: &Command| c.rate.unwrap_or(0.0);
        let RoadPlane { point, slope, friction } = &self.plane;
        let place = |axis: usize| self.from[axis] + share * (self.to[axis] - self.from[axis]);
        let centre = Vector3::new(place(0), place(1), 0.0) + belt.position;
        let from_point = centre - Vector3::new(at(&point[0]), at(&point[1]), at(&point[2]));
        let velocity = belt.velocity - Vector3::new(rate(&point[0]), rate(&point[1]), rate(&point[2]));
        let normal = Vector3::new(-at(&slope[0]), -at(&slope[1]), 1.0);
        let normal_rate = Vector3::new(-rate(&slope[0]), -rate(&slope[1]), 0.0);
        let length = normal.norm();
        let clearance = normal.dot(&from_point) / length;
        let stretching = normal.dot(&normal_rate) / (length * length);
        Plane {
            clearance,
            clearance_rate: (normal.dot(&velocity) + normal_rate.dot(&from_point)) / length
                - clearance * stretching,
            slope: [at(&slope[0]), at(&slope[1])],
            slope_rate: [rate(&slope[0]), rate(&slope[1])],
            friction: *friction,
        }
    }
}
