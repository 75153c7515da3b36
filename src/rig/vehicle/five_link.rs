//! Rear suspension: five links and a strut between body and carrier.

use super::joint::Link;
use super::statics::Column;
use crate::mechanics::{Pose, Rod, Spanned, SpringDamper, Wrench};
use crate::model::{Purpose, Role, Table, groups, parameter, text_parameter};
use crate::{Error, Result, clone_in_place, real, text};
use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

/// Number of links.
pub const LINKS: usize = 5;
/// The largest coordinate of a joint \[m\].
const FARTHEST: f64 = 5.0;

/// Sizes of the left side where the vehicle stands; the right side is its mirror image.
#[derive(Debug, PartialEq, Default, Serialize, Deserialize)]
pub struct FiveLink {
    pub links: String,
    pub strut: String,
    pub bushing: SpringDamper,
}

clone_in_place!(FiveLink { links, strut, bushing });

/// Lower arm, upper arm, toe link: inner joint, outer joint.
const LINKS_START: &str = "0.30 0.38 0.195 0 0.70 0.18; -0.25 0.40 0.195 0 0.70 0.18; 0.20 0.36 0.455 0 0.66 0.47; -0.20 0.36 0.455 0 0.66 0.47; -0.13 0.36 0.2236 -0.13 0.70 0.21";
const STRUT_START: &str = "-0.02 0.58 0.75 -0.02 0.62 0.25";

/// Joints of a side: inner and outer one of each link, of which the last is the strut.
pub type Joints = [[Vector3<f64>; 2]; LINKS + 1];

impl FiveLink {
    #[rustfmt::skip] // a row is a line
    pub fn rows() -> Table<Self> {
        const TEXT: &str = "Joints of the left side's five links where the vehicle stands, as 'x y z x y z; ...' [m]: on the body, then on the carrier; x before the axle, y from the middle, z over the road. The right side is the mirror image";
        Table::new([
            text_parameter("links", text!(links), LINKS_START, TEXT).purpose(Purpose::Data),
            text_parameter("strut", text!(strut), STRUT_START, "Joints of the left strut with spring and damper, 'x y z x y z' [m]: on the body, then on the carrier").purpose(Purpose::Data),
            parameter("link_stiffness", "N/m", real!(bushing.stiffness), 4e6, "Stiffness of each link with its bushings").range(1e3, 1e9).role(Role::Stiffness).tunable(),
            parameter("link_damping", "N.s/m", real!(bushing.damping), 1500.0, "Damping of that").range(0.0, 1e6).tunable(),
        ])
    }

    /// Joints of the left (1) or right (-1) side.
    ///
    /// # Errors
    /// A text that is not made of them.
    pub fn joints(&self, side: f64) -> Result<Joints> {
        let mut joints: Vec<[f64; 6]> = groups("rear_links", &self.links, FARTHEST)?;
        if joints.len() != LINKS {
            return Err(Error::variable(format!(
                "rear_links has {} links, and {LINKS} hold a wheel",
                joints.len()
            )));
        }
        let strut: Vec<[f64; 6]> = groups("rear_strut", &self.strut, FARTHEST)?;
        if strut.len() != 1 {
            return Err(Error::variable("rear_strut has to be six numbers: two joints".to_owned()));
        }
        joints.extend(strut);
        let mut ends = Joints::default();
        for (i, [x, y, z, u, v, w]) in joints.into_iter().enumerate() {
            ends[i] = [Vector3::new(x, side * y, z), Vector3::new(u, side * v, w)];
            if (ends[i][1] - ends[i][0]).norm() < 0.02 {
                let name =
                    if i == LINKS { "rear_strut".into() } else { format!("rear_links: link {}", i + 1) };
                return Err(Error::variable(format!("{name} is shorter than 0.02 m")));
            }
        }
        Ok(ends)
    }
}

/// One side of the suspension.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct Side {
    links: [Link; LINKS],
    strut: Rod,
    strut_length: f64,
    /// Force with which the strut pushes where the vehicle stands \[N\].
    pub push: f64,
}

/// The strut as it is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Strut {
    spanned: Spanned,
    /// By which way it is shortened \[m\], and the rate of that.
    pub shortened: [f64; 2],
}

/// What a side does.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Acting {
    pub on_body: Wrench<f64>,
    pub on_carrier: Wrench<f64>,
    /// Forces of the links, positive if they pull \[N\].
    pub links: [f64; LINKS],
    /// Force with which the strut pushes \[N\].
    pub push: f64,
    /// Power that the bushings' dampers turn into heat \[W\].
    pub power_loss: f64,
}

impl Side {
    /// A side between body and carrier, which stand as they are, without forces.
    pub fn new(bushing: SpringDamper, joints: &Joints, bodies: [&Pose; 2], origin: &Vector3<f64>) -> Self {
        let on = |body: &Pose, point: &Vector3<f64>| body.axes.transpose() * (origin + point - body.position);
        let rod =
            |[inner, outer]: &[Vector3<f64>; 2]| Rod { points: [on(bodies[0], inner), on(bodies[1], outer)] };
        let length = |[inner, outer]: &[Vector3<f64>; 2]| (outer - inner).norm();
        Self {
            links: std::array::from_fn(|i| Link {
                rod: rod(&joints[i]),
                length: length(&joints[i]),
                preload: 0.0,
                bushing,
            }),
            strut: rod(&joints[LINKS]),
            strut_length: length(&joints[LINKS]),
            push: 0.0,
        }
    }

    /// Takes over what may be tuned.
    pub fn tune(&mut self, bushing: SpringDamper) {
        self.links.iter_mut().for_each(|link| link.bushing = bushing);
    }

    /// How the strut is between two bodies.
    pub fn strut(&self, bodies: [&Pose; 2]) -> Strut {
        let spanned = self.strut.between(bodies);
        Strut { spanned, shortened: [self.strut_length - spanned.length, -spanned.rate] }
    }

    /// Takes over forces with which all is in balance where the vehicle stands: of the links, and of the strut, which pushes.
    pub fn preload(&mut self, forces: &[f64; 6]) {
        for (link, force) in self.links.iter_mut().zip(forces) {
            link.preload = *force;
        }
        self.push = forces[LINKS];
    }

    /// What it does between two bodies, with the force with which the strut pushes beyond that where the vehicle stands.
    pub fn act(&self, bodies: [&Pose; 2], strut: &Strut, more: f64) -> Acting {
        let mut acting = Acting { push: self.push + more, ..Acting::default() };
        for (i, link) in self.links.iter().enumerate() {
            let spanned = link.rod.between(bodies);
            acting.links[i] = link.pull(&spanned);
            acting.power_loss += link.bushing.power_loss(spanned.rate);
            acting.add(&spanned, acting.links[i]);
        }
        acting.add(&strut.spanned, -acting.push);
        acting
    }

    /// Energy in the bushings beyond that where the vehicle stands \[J\], with the strut's preload and without its spring.
    pub fn energy(&self, bodies: [&Pose; 2]) -> f64 {
        let links: f64 = self.links.iter().map(|link| link.energy(&link.rod.between(bodies))).sum();
        links + self.push * self.strut(bodies).shortened[0]
    }

    /// What unit forces put on the carrier, in the order of [`Side::preload`].
    pub fn columns(&self, bodies: [&Pose; 2]) -> [Column; 6] {
        let pulls = |spanned: &Spanned, pull: f64| spanned.wrenches(pull)[1];
        let [a, b, c, d, e] = self.links.each_ref().map(|link| pulls(&link.rod.between(bodies), 1.0));
        [a, b, c, d, e, pulls(&self.strut(bodies).spanned, -1.0)]
    }
}

impl Acting {
    fn add(&mut self, spanned: &Spanned, pull: f64) {
        let [on_body, on_carrier] = spanned.wrenches(pull);
        self.on_body += on_body;
        self.on_carrier += on_carrier;
    }
}
