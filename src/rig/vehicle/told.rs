//! What the vehicle tells of its joints, besides motions.

use super::axle::Axle;
use super::mcpherson::Acting;
use crate::mechanics::{Body, Pose, Wrench, cross, turn, turn_back};
use crate::model::{Role, Table, output};
use crate::real;
use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

/// Of all joints.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct Told {
    pub front: [Front; 2],
    pub rear: [Rear; 2],
    pub wheels: [Bearing; 4],
}

/// A front side.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct Front {
    links: [f64; 3],
    /// Of the strut's upper mount on the body, in its axes.
    top: Vector3<f64>,
    push: f64,
    shortened: f64,
    /// About the steering axis: of forces along the wheel, across and upward, of the tie rod, and of what has mass.
    moments: [f64; 5],
    /// Of the tie rod on the carrier about its centre, frame 0.
    tie_rod: Wrench<f64>,
}

impl Front {
    #[rustfmt::skip] // a row is a line
    pub fn rows() -> Table<Self> {
        let force = |name, access, text| output(name, "N", access, text).nominal(1000.0).role(Role::Force);
        let moment = |name, access, text| output(name, "N.m", access, text).nominal(100.0).role(Role::Force);
        Table::new([
            force("longitudinal_link_force", real!(links[0]), "Force of the longitudinal link F_LL, positive if it pulls"),
            force("transverse_link_force", real!(links[1]), "Force of the transverse link F_QL, positive if it pulls"),
            force("tie_rod_force", real!(links[2]), "Force of the tie rod F_SS, positive if it pulls"),
            force("strut_force", real!(push), "Force with which the strut pushes body and wheel apart: spring, damper, stops and anti-roll bar"),
            output("strut_travel", "m", real!(shortened), "Way by which the strut is shorter than where the vehicle stands").role(Role::Position),
            force("strut_top_force_x", real!(top.x), "Force of the strut's upper mount on the body, forward"),
            force("strut_top_force_y", real!(top.y), "The same to the left"),
            force("strut_top_force_z", real!(top.z), "The same upward"),
            moment("steering_moment_longitudinal", real!(moments[0]), "Moment about the steering axis of the force along the wheel and of the brake, positive to the left"),
            moment("steering_moment_lateral", real!(moments[1]), "The same of the lateral force and of the tire's other moments"),
            moment("steering_moment_vertical", real!(moments[2]), "The same of the wheel load"),
            moment("steering_moment_tie_rod", real!(moments[3]), "The same of the tie rod"),
            moment("steering_moment_inertia", real!(moments[4]), "The same of weight and inertia of wheel and carrier, which stand beside the axis: with the other four the sum is 0"),
        ])
    }

    pub fn new(acting: &Acting, body: &Pose, [shortened, _]: [f64; 2]) -> Self {
        Self {
            links: acting.links,
            top: turn_back(&body.axes, &acting.top),
            push: acting.push,
            shortened,
            tie_rod: acting.tie_rod,
            ..Self::default()
        }
    }

    /// Takes over moments about the steering axis: a unit vector, and the ball joint from the wheel's centre.
    pub fn about(&mut self, axis: &Vector3<f64>, ball_joint: &Vector3<f64>, bearing: &Bearing) {
        let of = |force: &Vector3<f64>, moment: &Vector3<f64>| axis.dot(&(moment - cross(ball_joint, force)));
        let [ahead, aside, up] = bearing.heading;
        let (force, moment) = (&bearing.on_rim.force, &bearing.on_rim.moment);
        let part = |direction: &Vector3<f64>| direction * direction.dot(force);
        let none = Vector3::zeros();
        let others = [
            of(&part(&ahead), &(bearing.axle * bearing.brake)),
            of(&part(&aside), &(moment - bearing.axle * bearing.axle.dot(moment))),
            of(&part(&up), &none),
            of(&self.tie_rod.force, &self.tie_rod.moment),
        ];
        self.moments = [others[0], others[1], others[2], others[3], -others.iter().sum::<f64>()];
    }
}

/// A rear side.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct Rear {
    pub links: [f64; 5],
    pub push: f64,
    pub shortened: f64,
}

impl Rear {
    #[rustfmt::skip] // a row is a line
    pub fn rows() -> Table<Self> {
        let force = |name, access, text| output(name, "N", access, text).nominal(1000.0).role(Role::Force);
        Table::new([
            force("link_force_1", real!(links[0]), "Force of the first link of rear_links, positive if it pulls"),
            force("link_force_2", real!(links[1]), "The same of the second link"),
            force("link_force_3", real!(links[2]), "The same of the third link"),
            force("link_force_4", real!(links[3]), "The same of the fourth link"),
            force("link_force_5", real!(links[4]), "The same of the fifth link"),
            force("strut_force", real!(push), "Force with which the strut pushes body and wheel apart: spring, damper, stops and anti-roll bar"),
            output("strut_travel", "m", real!(shortened), "Way by which the strut is shorter than where the vehicle stands").role(Role::Position),
        ])
    }
}

/// Between a wheel and its carrier.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct Bearing {
    /// Force and moment of the wheel on the carrier about the wheel's centre, H axes.
    force: Vector3<f64>,
    moment: Vector3<f64>,
    /// Force and moment of the tire, frame 0.
    on_rim: Wrench<f64>,
    /// Along the wheel, across and upward, frame 0; the wheel's axis; the brake's torque.
    heading: [Vector3<f64>; 3],
    axle: Vector3<f64>,
    brake: f64,
}

impl Bearing {
    #[rustfmt::skip] // a row is a line
    pub fn rows() -> Table<Self> {
        let force = |name, access, text| output(name, "N", access, text).nominal(1000.0);
        let moment = |name, access, text| output(name, "N.m", access, text).nominal(100.0);
        Table::new([
            force("carrier_force_x", real!(force.x), "Force of the wheel on its carrier as a measuring rim has it, forward, H axes: that of the tire less what the wheel's mass takes (6.11)").role(Role::LongitudinalForce),
            force("carrier_force_y", real!(force.y), "The same to the left (6.12)").role(Role::LateralForce),
            force("carrier_force_z", real!(force.z), "The same upward (6.13)").role(Role::Load),
            moment("carrier_moment_x", real!(moment.x), "Moment of the wheel on its carrier about the wheel's centre, forward, H axes (6.14)").role(Role::Force),
            moment("carrier_moment_y", real!(moment.y), "The same to the left: of the brake, less that of the drive (6.15)").role(Role::LongitudinalForce),
            moment("carrier_moment_z", real!(moment.z), "The same upward (6.16)").role(Role::AligningMoment),
        ])
    }

    /// From force and moment of the wheel on a carrier, as a measuring rim has them, frame 0.
    pub fn measured(pose: &Pose, on_carrier: &Wrench<f64>) -> Self {
        let axle = pose.axes.column(1).into_owned();
        let heading = directions(pose);
        Self {
            force: along(&heading, &on_carrier.force),
            moment: along(&heading, &on_carrier.moment),
            on_rim: *on_carrier,
            heading,
            axle,
            brake: axle.dot(&on_carrier.moment),
        }
    }

    /// From what the tire does to a wheel on a carrier that is accelerated; torques of the brake and of the drive, and the
    /// speed of its spin.
    pub fn new(
        sizes: &Axle,
        carrier: &Body,
        pose: &Pose,
        on_rim: &Wrench<f64>,
        [brake, drive, speed]: [f64; 3],
        gravity: f64,
    ) -> Self {
        let axle = pose.axes.column(1).into_owned();
        let heading = directions(pose);
        let turning = turn(&pose.attitude.rate_map(), &carrier.turning)
            + turn(&pose.attitude.rate_map_derivative(&pose.rates), &pose.rates);
        let force =
            on_rim.force - (carrier.acceleration + Vector3::new(0.0, 0.0, gravity)) * sizes.wheel_mass;
        // about the axle the wheel turns by itself, and across it takes what its inertia and its spin need
        let momentum = axle * (sizes.wheel_inertia * speed);
        let left = on_rim.moment - turning * sizes.wheel_transverse_inertia - cross(&pose.spin, &momentum);
        let moment = left + axle * (brake - drive - axle.dot(&left));
        Self {
            force: along(&heading, &force),
            moment: along(&heading, &moment),
            on_rim: *on_rim,
            heading,
            axle,
            brake,
        }
    }
}

/// Along the heading of a carrier, to its left, and upward.
fn directions(pose: &Pose) -> [Vector3<f64>; 3] {
    let (sin, cos) = pose.attitude.z;
    [Vector3::new(cos, sin, 0.0), Vector3::new(-sin, cos, 0.0), Vector3::z()]
}

/// Components of a vector along three directions.
fn along(directions: &[Vector3<f64>; 3], v: &Vector3<f64>) -> Vector3<f64> {
    Vector3::from(directions.each_ref().map(|direction| direction.dot(v)))
}
