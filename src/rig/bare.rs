//! A tire by itself: `ring-brush-tire`. Pose and velocity of the rim in, force and moment on the rim out; the road
//! is a plane that the master gives.

use crate::mechanics::check_steps_of_led_rim;
use crate::model::{Access, Model, Purpose, Role, Table, input, join, output, parameter};
use crate::road::{Point, Road, Window};
use crate::tire::{Ground, Motion, Mounted, Plane, Tire};
use crate::{Result, clone_in_place, lens, real};
use nalgebra::Vector3;
use serde::{Deserialize, Serialize};
use std::f64::consts::TAU;

/// The model: the rim and the plane as the master gives them, and the tire.
#[derive(Debug, PartialEq, Default, Serialize, Deserialize)]
pub struct Bare<T> {
    tire: Mounted<T>,
    step_size: f64,
    /// Pose and velocity of the rim in frame 0, x and y included.
    rim: Motion<f64>,
    plane: RoadPlane,
    /// Where the rim was over the road, and the plane, at the end of the last step.
    last: ([f64; 2], RoadPlane),
}

clone_in_place!(Bare<T> { tire, step_size, rim, plane, last });

/// A plane through a point.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
struct RoadPlane {
    point: [f64; 3],
    slope: [f64; 2],
    friction: f64,
}

impl<T: Tire> Model for Bare<T> {
    const NAME: &'static str = const { &join::<48>(&[T::NAME, "-tire"]) }.as_str();
    const DESCRIPTION: &'static str = const {
        &join::<256>(&[
            T::TITLE,
            " alone: pose and velocity of the rim and a road plane in, force and moment on the rim out (ISO 8855 signs)",
        ])
    }
    .as_str();
    const DOCUMENTATION: &'static [&'static str] = &[include_str!("bare.html"), T::DOCUMENTATION];

    #[rustfmt::skip] // a row is a line
    fn variables() -> Table<Self> {
        Table::new([
            input("rim_x", "m", real!(rim.position.x), 0.0, "Wheel centre, frame 0; between communication points it runs on with rim_velocity_x").runs_on("rim_velocity_x"),
            input("rim_y", "m", real!(rim.position.y), 0.0, "Wheel centre, frame 0; runs on with rim_velocity_y").runs_on("rim_velocity_y"),
            input("rim_z", "m", real!(rim.position.z), 0.319, "Wheel centre, frame 0; runs on with rim_velocity_z").runs_on("rim_velocity_z"),
            input("rim_camber", "rad", real!(rim.angles.x), 0.0, "Inclination angle; positive leans the top of the wheel to -y; runs on with rim_camber_rate").range(-0.6, 0.6).runs_on("rim_camber_rate").role(Role::Camber),
            input("rim_spin", "rad", real!(rim.angles.y), 0.0, "Spin angle, unbounded; runs on with rim_spin_rate").runs_on("rim_spin_rate").role(Role::WheelAngle),
            input("rim_steer", "rad", real!(rim.angles.z), 0.0, "Steer angle about z; runs on with rim_steer_rate").range(-TAU, TAU).runs_on("rim_steer_rate").role(Role::SteerAngle),
            input("rim_velocity_x", "m/s", real!(rim.velocity.x), 10.0, "Velocity of the wheel centre, frame 0").range(-200.0, 200.0),
            input("rim_velocity_y", "m/s", real!(rim.velocity.y), 0.0, "Velocity of the wheel centre, frame 0").range(-200.0, 200.0),
            input("rim_velocity_z", "m/s", real!(rim.velocity.z), 0.0, "Velocity of the wheel centre, frame 0").range(-200.0, 200.0),
            input("rim_camber_rate", "rad/s", real!(rim.rates.x), 0.0, "Rate of the inclination angle").range(-200.0, 200.0),
            input("rim_spin_rate", "rad/s", real!(rim.rates.y), 10.0 / 0.328, "Rate of the spin angle, positive rolling forward").range(-2000.0, 2000.0).role(Role::WheelSpeed),
            input("rim_steer_rate", "rad/s", real!(rim.rates.z), 0.0, "Rate of the steer angle").range(-200.0, 200.0),
            input("road_x", "m", real!(plane.point[0]), 0.0, "Point of the road plane, frame 0: where road_height holds; on a level road it does not matter"),
            input("road_y", "m", real!(plane.point[1]), 0.0, "Point of the road plane, frame 0"),
            input("road_height", "m", real!(plane.point[2]), 0.0, "Height of the road plane at road_x, road_y").range(-1e4, 1e4),
            input("road_slope_x", "1", real!(plane.slope[0]), 0.0, "Slope dz/dx of the road plane").range(-1.0, 1.0),
            input("road_slope_y", "1", real!(plane.slope[1]), 0.0, "Slope dz/dy of the road plane").range(-1.0, 1.0),
            input("friction_factor", "1", real!(plane.friction), 1.0, "Factor on the friction between tire and road").range(0.0, 10.0),
        ])
        // the plane that the master gives is bridged already
        .part("", lens!(tire), Mounted::rows().without("road_filter_length"))
        .and([
            output("global_force_x", "N", Access::computed(|m: &Self| m.tire.tire.on_rim().force.x), "Force of the tire on the rim, frame 0").nominal(1000.0).role(Role::LongitudinalForce),
            output("global_force_y", "N", Access::computed(|m: &Self| m.tire.tire.on_rim().force.y), "Force of the tire on the rim, frame 0").nominal(1000.0).role(Role::LateralForce),
            output("global_force_z", "N", Access::computed(|m: &Self| m.tire.tire.on_rim().force.z), "Force of the tire on the rim, frame 0").nominal(1000.0).role(Role::Load),
            output("global_moment_x", "N.m", Access::computed(|m: &Self| m.tire.tire.on_rim().moment.x), "Moment of the tire on the rim about the wheel centre, frame 0").nominal(100.0),
            output("global_moment_y", "N.m", Access::computed(|m: &Self| m.tire.tire.on_rim().moment.y), "Moment of the tire on the rim about the wheel centre, frame 0").nominal(100.0).role(Role::LongitudinalForce),
            output("global_moment_z", "N.m", Access::computed(|m: &Self| m.tire.tire.on_rim().moment.z), "Moment of the tire on the rim about the wheel centre, frame 0").nominal(100.0).role(Role::AligningMoment),
            output("spin_moment", "N.m", Access::computed(|m: &Self| m.tire.spin_moment()), "Moment of the tire on the rim about the wheel's own axis").nominal(100.0),
            parameter("step_size", "s", real!(step_size), T::STEP, "Step of the model's own time grid").range(1e-7, 1e-3).purpose(Purpose::Numerics).role(Role::Step),
        ])
        .without_derivatives_if(T::RIPPLES)
    }

    fn step_size(&self) -> f64 {
        self.step_size
    }

    fn initialize(&mut self) -> Result<()> {
        self.tire.tire.mount(&Road::default())?;
        check_steps_of_led_rim(self.step_size, self.tire.tire.links())?;
        self.last = (self.place(), self.plane);
        let rim = self.above_ground();
        self.tire.start(&rim, &self.ground(0.0))
    }

    fn tune(&mut self) -> Result<()> {
        check_steps_of_led_rim(self.step_size, self.tire.tire.links())?;
        self.tire.tire.tune()
    }

    fn check(&self) -> Result<()> {
        self.tire.tire.check(&Road::default())
    }

    fn warning(&self) -> Option<String> {
        self.tire.warning()
    }

    fn step(&mut self, length: f64) -> Result<()> {
        let rim = self.above_ground();
        // Masses in the tire travel relative to the rim by velocities; where the master's positions say
        // otherwise, they are right.
        let before = &self.tire.rim.velocity;
        let way = [before.x + rim.velocity.x, before.y + rim.velocity.y].map(|v| 0.5 * length * v);
        let ground = self.ground(length);
        let (from, to) = (self.last.0, self.place());
        self.tire.tire.shift([0, 1].map(|axis| to[axis] - from[axis] - way[axis]));
        self.tire.step(&rim, &ground, length)?;
        self.last = (to, self.plane);
        Ok(())
    }
}

impl<T: Tire> Bare<T> {
    /// The rim as the tire takes it: seen from the point below its centre.
    fn above_ground(&self) -> Motion<f64> {
        let mut rim = self.rim;
        rim.position = Vector3::new(0.0, 0.0, rim.position.z);
        rim
    }

    /// Where the rim is over the road.
    fn place(&self) -> [f64; 2] {
        [self.rim.position.x, self.rim.position.y]
    }

    fn ground(&self, length: f64) -> UnderRim {
        UnderRim { from: self.last, to: (self.place(), self.plane), length }
    }
}

/// Rim and plane for the length of a step, in which both move straight. A plane that the master holds
/// jumps when it is set anew; the tire then rolls from the old one to the new one within a step of its
/// own, as it does over many where the plane comes with derivatives.
struct UnderRim {
    from: ([f64; 2], RoadPlane),
    to: ([f64; 2], RoadPlane),
    length: f64,
}

impl Ground for UnderRim {
    fn moves(&self) -> bool {
        true
    }

    fn point(&self, x: f64, y: f64, share: f64) -> Point {
        let ((from_place, from), (to_place, to)) = (&self.from, &self.to);
        let at = |from: f64, to: f64| from + share * (to - from);
        let from_point = |axis: usize, here: f64| {
            at(from_place[axis], to_place[axis]) + here - at(from.point[axis], to.point[axis])
        };
        let slope = [0, 1].map(|axis| at(from.slope[axis], to.slope[axis]));
        Point {
            height: at(from.point[2], to.point[2])
                + slope[0] * from_point(0, x)
                + slope[1] * from_point(1, y),
            slope,
            friction: to.friction,
        }
    }

    fn plane(&self, body: &Motion<f64>, _window: &Window, share: f64) -> Plane {
        let ((from_place, from), (to_place, to)) = (&self.from, &self.to);
        let at = |from: f64, to: f64| from + share * (to - from);
        let rate = |from: f64, to: f64| if self.length > 0.0 { (to - from) / self.length } else { 0.0 };
        let place: [f64; 2] = std::array::from_fn(|i| at(from_place[i], to_place[i]));
        let point = Vector3::from_fn(|i, _| at(from.point[i], to.point[i]));
        let point_rate = Vector3::from_fn(|i, _| rate(from.point[i], to.point[i]));
        let slope: [f64; 2] = std::array::from_fn(|i| at(from.slope[i], to.slope[i]));
        let slope_rate: [f64; 2] = std::array::from_fn(|i| rate(from.slope[i], to.slope[i]));
        let from_point = Vector3::new(place[0], place[1], 0.0) + body.position - point;
        let velocity = body.velocity - point_rate;
        let normal = Vector3::new(-slope[0], -slope[1], 1.0);
        let normal_rate = Vector3::new(-slope_rate[0], -slope_rate[1], 0.0);
        let length = normal.norm();
        let clearance = normal.dot(&from_point) / length;
        let stretching = normal.dot(&normal_rate) / (length * length);
        Plane {
            clearance,
            clearance_rate: (normal.dot(&velocity) + normal_rate.dot(&from_point)) / length
                - clearance * stretching,
            slope,
            slope_rate,
            friction: to.friction,
        }
    }
}
