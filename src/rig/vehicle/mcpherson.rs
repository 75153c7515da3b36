//! McPherson front suspension: two links to a ball joint, the strut, and a tie rod.

use super::joint::Link;
use super::lever_arms::SteeringAxis;
use super::statics::Column;
use crate::mechanics::{At, Guide, Pose, Rod, Slid, Spanned, SpringDamper, Wrench, cross, turn, turn_back};
use crate::model::{Purpose, Role, Table, parameter};
use crate::{Error, Result, real};
use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

/// Sizes of the left side where the vehicle stands; the right side is its mirror image.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct McPherson {
    pub inclination: f64,
    pub caster: f64,
    pub caster_offset: f64,
    pub scrub_radius: f64,
    pub ball_joint_height: f64,
    pub strut_top_height: f64,
    pub transverse_length: f64,
    pub longitudinal_length: f64,
    pub longitudinal_angle: f64,
    pub anti_dive: f64,
    pub steering_arm: f64,
    pub tie_rod_height: f64,
    pub tie_rod_length: f64,
    pub transverse: SpringDamper,
    pub longitudinal: SpringDamper,
    pub tie_rod: SpringDamper,
    pub strut_top: SpringDamper,
}

/// The steepest longitudinal link: its rise over its length, of 45 degrees.
const STEEPEST: f64 = 0.7;

/// Joints of a side, from the point on the road below the middle of the front axle: forward, to the left, upward \[m\].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Joints {
    pub ball_joint: Vector3<f64>,
    pub strut_top: Vector3<f64>,
    pub transverse_inner: Vector3<f64>,
    pub longitudinal_inner: Vector3<f64>,
    pub tie_rod_outer: Vector3<f64>,
    pub tie_rod_inner: Vector3<f64>,
}

impl McPherson {
    #[rustfmt::skip] // a row is a line
    pub fn rows() -> Table<Self> {
        let length = |name, access, start, text| parameter(name, "m", access, start, text).range(-2.0, 2.0).purpose(Purpose::Data);
        Table::new([
            parameter("kingpin_inclination", "rad", real!(inclination), 0.174533, "Angle by which the steering axis leans inward at its top").range(-0.5, 0.5).purpose(Purpose::Data),
            parameter("caster", "rad", real!(caster), 0.139626, "Angle by which it leans backward at its top").range(-0.5, 0.5).purpose(Purpose::Data),
            length("caster_offset", real!(caster_offset), 0.012, "So far it passes behind the wheel's centre, at its height"),
            length("scrub_radius", real!(scrub_radius), -0.015, "So far inside of the wheel's plane it meets the road; negative: outside"),
            length("ball_joint_height", real!(ball_joint_height), 0.17, "Height of the lower ball joint over the road"),
            length("strut_top_height", real!(strut_top_height), 0.75, "Height of the strut's upper mount over the road"),
            parameter("transverse_link_length", "m", real!(transverse_length), 0.35, "Length of the transverse link, which lies across and level").range(0.02, 2.0).purpose(Purpose::Data),
            parameter("longitudinal_link_length", "m", real!(longitudinal_length), 0.40, "Length of the longitudinal link, which goes forward and inward from the ball joint").range(0.02, 2.0).purpose(Purpose::Data),
            parameter("longitudinal_link_angle", "rad", real!(longitudinal_angle), 0.698132, "Angle between it and the direction of travel, as seen from above").range(-1.4, 1.4).purpose(Purpose::Data),
            parameter("anti_dive", "1", real!(anti_dive), 0.1, "Force by which braking lifts the body over a wheel, over the braking force of that wheel: made by the slope of the longitudinal link").range(-1.0, 1.0).purpose(Purpose::Data),
            length("steering_arm", real!(steering_arm), 0.13, "Outer joint of the tie rod before the steering axis; negative: behind it"),
            length("tie_rod_height", real!(tie_rod_height), 0.20, "Its height over the road"),
            parameter("tie_rod_length", "m", real!(tie_rod_length), 0.36, "Length of a tie rod, which lies across").range(0.02, 2.0).purpose(Purpose::Data),
            parameter("transverse_link_stiffness", "N/m", real!(transverse.stiffness), 1e7, "Stiffness of the transverse link with its bushings").range(1e3, 1e9).role(Role::Stiffness).tunable(),
            parameter("transverse_link_damping", "N.s/m", real!(transverse.damping), 2000.0, "Damping of that").range(0.0, 1e6).tunable(),
            parameter("longitudinal_link_stiffness", "N/m", real!(longitudinal.stiffness), 0.7e6, "Stiffness of the longitudinal link with its bushings").range(1e3, 1e9).role(Role::Stiffness).tunable(),
            parameter("longitudinal_link_damping", "N.s/m", real!(longitudinal.damping), 900.0, "Damping of that").range(0.0, 1e6).tunable(),
            parameter("tie_rod_stiffness", "N/m", real!(tie_rod.stiffness), 6e6, "Stiffness of a tie rod").range(1e3, 1e9).role(Role::Stiffness).tunable(),
            parameter("tie_rod_damping", "N.s/m", real!(tie_rod.damping), 300.0, "Damping of that").range(0.0, 1e6).tunable(),
            parameter("strut_top_stiffness", "N/m", real!(strut_top.stiffness), 5e6, "Stiffness across the strut, of its upper mount and its piston rod").range(1e3, 1e9).role(Role::Stiffness).tunable(),
            parameter("strut_top_damping", "N.s/m", real!(strut_top.damping), 2000.0, "Damping of that").range(0.0, 1e6).tunable(),
        ])
    }

    /// # Errors
    /// Joints that do not make a suspension.
    pub fn check(&self) -> Result<()> {
        let (top, ball) = (self.strut_top_height, self.ball_joint_height);
        if ball < 0.0 || top < ball + 0.05 {
            return Err(Error::variable(format!(
                "front_ball_joint_height = {ball} m has to be over the road, and front_strut_top_height = {top} m at least 0.05 m over it"
            )));
        }
        if self.rise().abs() > STEEPEST * self.longitudinal_length {
            return Err(Error::variable(format!(
                "front_anti_dive = {} would need a longitudinal link that rises by {:.3} m on a length of {} m: it may be {STEEPEST} of it",
                self.anti_dive,
                self.rise(),
                self.longitudinal_length
            )));
        }
        if self.steering_arm.abs() < 0.01 {
            return Err(Error::variable(format!(
                "front_steering_arm = {} m: below 0.01 m a tie rod does not hold the wheel",
                self.steering_arm
            )));
        }
        Ok(())
    }

    /// How the steering axis lies.
    pub fn axis(&self) -> SteeringAxis {
        SteeringAxis {
            inclination: self.inclination,
            caster: self.caster,
            caster_offset: self.caster_offset,
            scrub_radius: self.scrub_radius,
        }
    }

    /// How much higher than the ball joint the inner end of the longitudinal link is \[m\].
    ///
    /// Braking lifts the body by the way forward of the point on the road over the wheel's way up. That follows from the ways of the
    /// strut's top, along the strut, and of the ball joint, across the longitudinal link.
    fn rise(&self) -> f64 {
        let (top, ball) = (self.strut_top_height, self.ball_joint_height);
        let forward = (self.anti_dive * (top - ball) - libm::tan(self.caster) * ball) / top;
        let slope = -forward * libm::cos(self.longitudinal_angle);
        self.longitudinal_length * slope / libm::sqrt(1.0 + slope * slope)
    }

    /// Joints of the left (1) or right (-1) side, whose wheel's centre is at a height and `half_track` from the middle, with a camber.
    pub fn joints(&self, side: f64, half_track: f64, height: f64, camber: f64) -> Joints {
        let (caster, inclination) = (libm::tan(self.caster), libm::tan(self.inclination));
        let trail = height * caster - self.caster_offset;
        // where the wheel's plane meets the road
        let plane = half_track - height * libm::tan(camber);
        let on_axis =
            |z: f64| Vector3::new(trail - caster * z, plane - self.scrub_radius - inclination * z, z);
        let (ball_joint, strut_top) = (on_axis(self.ball_joint_height), on_axis(self.strut_top_height));
        let (sin, cos) = libm::sincos(self.longitudinal_angle);
        let rise = self.rise();
        let level = libm::sqrt(self.longitudinal_length * self.longitudinal_length - rise * rise);
        let tie_rod_outer = on_axis(self.tie_rod_height) + Vector3::new(self.steering_arm, 0.0, 0.0);
        let mirrored = |p: Vector3<f64>| Vector3::new(p.x, side * p.y, p.z);
        Joints {
            ball_joint: mirrored(ball_joint),
            strut_top: mirrored(strut_top),
            transverse_inner: mirrored(ball_joint - Vector3::new(0.0, self.transverse_length, 0.0)),
            longitudinal_inner: mirrored(ball_joint + Vector3::new(level * cos, -level * sin, rise)),
            tie_rod_outer: mirrored(tie_rod_outer),
            tie_rod_inner: mirrored(tie_rod_outer - Vector3::new(0.0, self.tie_rod_length, 0.0)),
        }
    }
}

/// The last of the links.
const TIE_ROD: usize = 2;

/// One side of the suspension.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct Side {
    /// Longitudinal link, transverse link, tie rod.
    links: [Link; 3],
    strut: Guide,
    /// Force across the strut on the carrier where the vehicle stands, in the carrier's axes \[N\], and that with which it pushes.
    across: Vector3<f64>,
    pub push: f64,
}

/// The strut as it is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Strut(Slid);

impl Strut {
    /// By which way it is shortened \[m\], and the rate of that.
    pub fn shortened(&self) -> [f64; 2] {
        [-self.0.way, -self.0.rate]
    }
}

/// Way of the rack off its middle to the left of the body \[m\], and its rate.
pub type RackAt = [f64; 2];

/// What a side does.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Acting {
    pub on_body: Wrench<f64>,
    pub on_carrier: Wrench<f64>,
    /// Forces of longitudinal link, transverse link and tie rod, positive if they pull \[N\].
    pub links: [f64; 3],
    /// Force of the upper mount on the body, frame 0 \[N\].
    pub top: Vector3<f64>,
    /// Force with which the strut pushes \[N\].
    pub push: f64,
    /// Force of the tie rod on the rack, along it \[N\].
    pub on_rack: f64,
    /// What it puts on the carrier.
    pub tie_rod: Wrench<f64>,
    /// Power that the bushings' dampers turn into heat \[W\].
    pub power_loss: f64,
}

impl Side {
    /// A side between body and carrier, which stand as they are, without forces.
    pub fn new(sizes: &McPherson, joints: &Joints, bodies: [&Pose; 2], origin: &Vector3<f64>) -> Self {
        let on = |body: &Pose, point: &Vector3<f64>| body.axes.transpose() * (origin + point - body.position);
        let [body, carrier] = bodies;
        let link = |inner: &Vector3<f64>, outer: &Vector3<f64>, bushing| Link {
            rod: Rod { points: [on(body, inner), on(carrier, outer)] },
            length: (outer - inner).norm(),
            preload: 0.0,
            bushing,
        };
        let j = joints;
        let axis = (j.strut_top - j.ball_joint).normalize();
        Self {
            links: [
                link(&j.longitudinal_inner, &j.ball_joint, sizes.longitudinal),
                link(&j.transverse_inner, &j.ball_joint, sizes.transverse),
                link(&j.tie_rod_inner, &j.tie_rod_outer, sizes.tie_rod),
            ],
            strut: Guide {
                points: [on(carrier, &j.strut_top), on(body, &j.strut_top)],
                axis: turn_back(&carrier.axes, &axis),
                held: sizes.strut_top,
            },
            ..Self::default()
        }
    }

    /// Takes over what may be tuned.
    pub fn tune(&mut self, sizes: &McPherson) {
        let bushings = [sizes.longitudinal, sizes.transverse, sizes.tie_rod];
        self.links.iter_mut().zip(bushings).for_each(|(link, bushing)| link.bushing = bushing);
        self.strut.held = sizes.strut_top;
    }

    /// How the strut is between body and carrier.
    pub fn strut(&self, [body, carrier]: [&Pose; 2]) -> Strut {
        Strut(self.strut.between([carrier, body]))
    }

    /// Longitudinal and transverse link and the tie rod as they are, one after the other.
    #[inline]
    fn spanned(&self, i: usize, [body, carrier]: [&Pose; 2], [way, rate]: RackAt) -> Spanned {
        let rod = &self.links[i].rod;
        if i < TIE_ROD {
            return rod.between([body, carrier]);
        }
        let inner = body.at(&(rod.points[0] + Vector3::y() * way));
        let moved = At { velocity: inner.velocity + body.axes.column(1) * rate, ..inner };
        Spanned::new([moved, carrier.at(&rod.points[1])])
    }

    /// Takes over forces with which all is in balance where the vehicle stands: of the links, across the strut and along it.
    pub fn preload(&mut self, strut: &Strut, carrier: &Pose, forces: &[f64; 6]) {
        for (link, force) in self.links.iter_mut().zip(forces) {
            link.preload = *force;
        }
        let [first, second] = across_axes(&strut.0.axis);
        self.across = turn_back(&carrier.axes, &(first * forces[3] + second * forces[4]));
        self.push = forces[5];
    }

    /// What it does between body and carrier, with the force with which the strut pushes beyond that where the vehicle stands.
    pub fn act(&self, [body, carrier]: [&Pose; 2], rack: RackAt, Strut(strut): &Strut, more: f64) -> Acting {
        let mut acting = Acting { push: self.push + more, ..Acting::default() };
        for (i, link) in self.links.iter().enumerate() {
            let spanned = self.spanned(i, [body, carrier], rack);
            let pull = link.pull(&spanned);
            acting.links[i] = pull;
            acting.power_loss += link.bushing.power_loss(spanned.rate);
            let [on_body, on_carrier] = spanned.wrenches(pull);
            acting.on_body += on_body;
            acting.on_carrier += on_carrier;
            if i == TIE_ROD {
                acting.tie_rod = on_carrier;
                acting.on_rack = pull * spanned.along.dot(&body.axes.column(1));
            }
        }
        acting.power_loss += self.strut.power_loss(strut);
        let force = self.strut.across(strut) + turn(&carrier.axes, &self.across) - strut.axis * acting.push;
        let [on_carrier, on_body] = strut.wrenches(force);
        acting.on_body += on_body;
        acting.on_carrier += on_carrier;
        acting.top = on_body.force;
        acting
    }

    /// Energy in the bushings beyond that where the vehicle stands \[J\], with the strut's preload and without its spring.
    pub fn energy(&self, bodies: [&Pose; 2], rack: RackAt) -> f64 {
        let links = self.links.iter().enumerate();
        let links: f64 = links.map(|(i, link)| link.energy(&self.spanned(i, bodies, rack))).sum();
        let across = turn(&bodies[1].axes, &self.across);
        let Strut(strut) = self.strut(bodies);
        links + self.strut.energy(&strut) + across.dot(&strut.off) - self.push * strut.way
    }

    /// What unit forces put on the carrier, in the order of [`Side::preload`], with the rack in its middle.
    pub fn columns(&self, bodies: [&Pose; 2]) -> [Column; 6] {
        let [a, b, c] = [0, 1, 2].map(|i| self.spanned(i, bodies, [0.0; 2]).wrenches(1.0)[1]);
        let Strut(strut) = self.strut(bodies);
        let [first, second] = across_axes(&strut.axis);
        let [d, e, f] = [first, second, -strut.axis].map(|force| strut.wrenches(force)[0]);
        [a, b, c, d, e, f]
    }

    /// Unit vector of the steering axis from the ball joint to the strut's top, frame 0, and the ball joint from the carrier's centre.
    pub fn steering_axis(&self, [body, carrier]: [&Pose; 2]) -> (Vector3<f64>, Vector3<f64>) {
        let ball = carrier.at(&self.links[0].rod.points[1]);
        let top = body.at(&self.strut.points[1]);
        ((top.place - ball.place).normalize(), ball.arm)
    }
}

/// Two unit vectors across another one that is about upright: the first one lies in the plane of x and it.
fn across_axes(axis: &Vector3<f64>) -> [Vector3<f64>; 2] {
    let second = cross(axis, &Vector3::x()).normalize();
    [cross(&second, axis), second]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The axis meets the road inside of the wheel's plane by the scrub radius, behind the centre by the offset at its height, and the
    /// longitudinal link has the slope that lifts as much as was asked for.
    #[test]
    fn joints_lie_where_the_angles_say() {
        let mut sizes = McPherson::default();
        McPherson::rows().write_starts(&mut sizes);
        for (camber, anti_dive) in [(0.0, 0.1), (-0.02, 0.5), (0.03, 0.0)] {
            sizes.anti_dive = anti_dive;
            for side in [1.0, -1.0] {
                let (half_track, height) = (0.75, 0.32);
                let j = sizes.joints(side, half_track, height, camber);
                let at = |z: f64| {
                    let share = (z - j.ball_joint.z) / (j.strut_top.z - j.ball_joint.z);
                    j.ball_joint + (j.strut_top - j.ball_joint) * share
                };
                let plane = half_track - height * camber.tan();
                assert!((side * at(0.0).y - (plane - sizes.scrub_radius)).abs() < 1e-12);
                assert!((at(height).x + sizes.caster_offset).abs() < 1e-12);
                let link = j.longitudinal_inner - j.ball_joint;
                assert!((link.norm() - sizes.longitudinal_length).abs() < 1e-12);
                // the ball joint goes up and forward across the link, the top along the strut; the road's point is on their line
                let ball = -link.z / link.x;
                let top = -sizes.caster.tan();
                let lifts = ball + (ball - top) * j.ball_joint.z / (j.strut_top.z - j.ball_joint.z);
                assert!((lifts - anti_dive).abs() < 1e-12, "{lifts}");
            }
        }
    }
}
