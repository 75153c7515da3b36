//! What joins wheels to the body: links, struts on the steering axis in front, five links and a strut behind.
//!
//! Places are those where the car stands: x before the front axle, y to the left of the middle, z over the road. Of a joint each end
//! is kept as its own body has it. Links and struts are springs and dampers with the force that they have where the car stands.

use super::parameters::{CAMBER, HALF_TRACK, Parameters, TOE, WHEELBASE};
use super::vector::{Vector, solve, v};

/// A link with its bushings; it pulls where its force is positive.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Link {
    /// End on the body, and on the carrier.
    pub(crate) ends: [Vector; 2],
    pub(crate) stiffness: f64,
    pub(crate) damping: f64,
    pub(crate) length: f64,
    /// Force where the car stands \[N\].
    pub(crate) standing: f64,
    /// Its end on the body moves with the rack.
    pub(crate) on_rack: bool,
}

/// How a strut guides the wheel.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Guide {
    /// Its axis is fixed to the carrier, and its mount on the body holds across it, with (stiffness, damping) and the force where the car stands.
    Axis { axis: Vector, mount: (f64, f64), standing: Vector },
    /// It only pushes, between its ends.
    Ends { length: f64 },
}

/// A strut: spring, damper, stops and its share of the anti-roll bar.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Strut {
    pub(crate) ends: [Vector; 2],
    pub(crate) guide: Guide,
    pub(crate) stiffness: f64,
    pub(crate) damping: f64,
    /// Force where the car stands, with which it pushes \[N\].
    pub(crate) standing: f64,
}

/// Ways until a strut meets the stops \[m\], and their forces over the square of the way into them \[N/m²\]: bump, rebound.
const STOPS: [(f64, f64); 2] = [(0.06, 2e7), (0.09, 1e8)];
/// Force of the anti-roll bar over the difference of both struts' ways \[N/m\].
pub(crate) const ANTI_ROLL: f64 = 2e4;

impl Strut {
    /// Force of spring and stops, shortened by a way.
    pub(crate) fn spring(&self, way: f64) -> f64 {
        let [bump, rebound] = STOPS;
        let (into, out) = ((way - bump.0).max(0.0), (-way - rebound.0).max(0.0));
        self.standing + self.stiffness * way + bump.1 * into * into - rebound.1 * out * out
    }

    /// What they store, from where the car stands.
    #[cfg(test)]
    pub(crate) fn energy(&self, way: f64) -> f64 {
        let [bump, rebound] = STOPS;
        let (into, out) = ((way - bump.0).max(0.0), (-way - rebound.0).max(0.0));
        way * (self.standing + 0.5 * self.stiffness * way)
            + (bump.1 * into.powi(3) + rebound.1 * out.powi(3)) / 3.0
    }
}

/// A wheel's place with its joints.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Corner {
    /// The wheel's centre.
    pub(crate) centre: Vector,
    /// Direction of its axle to the left, fixed to the carrier.
    pub(crate) axle: Vector,
    pub(crate) links: Vec<Link>,
    pub(crate) strut: Strut,
}

/// Angles by which the steering axis leans inward and backward at its top.
const LEAN: (f64, f64) = (0.174_533, 0.139_626);
/// So far it passes behind the wheel's centre \[m\].
const CASTER_OFFSET: f64 = 0.012;
/// Heights of the lower ball joint, the strut's mount and the outer joint of the tie rod \[m\].
const HEIGHTS: [f64; 3] = [0.17, 0.75, 0.2];
/// Lengths of the longitudinal link, the transverse link and the tie rod \[m\].
const LENGTHS: [f64; 3] = [0.4, 0.35, 0.36];
/// Angle of the longitudinal link to the direction of travel, from above.
const ASKEW: f64 = 0.698_132;
/// The outer joint of the tie rod before the steering axis \[m\].
const STEERING_ARM: f64 = 0.13;
/// Stiffness \[N/m\] and damping \[N.s/m\] of these links, and of the strut's mount.
const FRONT: [(f64, f64); 3] = [(7e5, 900.0), (1e7, 2000.0), (6e6, 300.0)];
const MOUNT: (f64, f64) = (5e6, 2000.0);

/// Links behind: on the body, on the carrier, x before the rear axle.
const REAR: [[Vector; 2]; 5] = [
    [v(0.30, 0.38, 0.195), v(0.0, 0.70, 0.18)],
    [v(-0.25, 0.40, 0.195), v(0.0, 0.70, 0.18)],
    [v(0.20, 0.36, 0.455), v(0.0, 0.66, 0.47)],
    [v(-0.20, 0.36, 0.455), v(0.0, 0.66, 0.47)],
    [v(-0.13, 0.36, 0.2236), v(-0.13, 0.70, 0.21)],
];
const REAR_LINK: (f64, f64) = (4e6, 1500.0);
const REAR_STRUT: [Vector; 2] = [v(-0.02, 0.58, 0.75), v(-0.02, 0.62, 0.25)];

/// Axle of a left wheel, by camber and toe.
fn axle() -> Vector {
    let (camber, steer) = (-CAMBER, -TOE);
    let level = libm::cos(camber);
    v(-level * libm::sin(steer), level * libm::cos(steer), libm::sin(camber))
}

fn link(ends: [Vector; 2], (stiffness, damping): (f64, f64)) -> Link {
    Link { ends, stiffness, damping, length: (ends[0] - ends[1]).length(), standing: 0.0, on_rack: false }
}

/// A place on the steering axis of the left front wheel at a height, with the wheel's centre as high as told.
pub(crate) fn on_steering_axis(scrub_radius: f64, centre: f64, height: f64) -> Vector {
    let (inward, backward) = (libm::tan(LEAN.0), libm::tan(LEAN.1));
    // camber moves where the wheel's plane meets the road
    let meets = HALF_TRACK - centre * libm::tan(CAMBER);
    v((centre - height) * backward - CASTER_OFFSET, meets - scrub_radius - height * inward, height)
}

/// The left front wheel, its centre as high as told, with a longitudinal link of this slope angle.
fn sloped(p: &Parameters, centre: f64, slope: f64) -> Corner {
    let at = |height: f64| on_steering_axis(p.front_scrub_radius, centre, height);
    let (ball, top) = (at(HEIGHTS[0]), at(HEIGHTS[1]));
    let level = LENGTHS[0] * libm::cos(slope);
    let before = ball + v(level * libm::cos(ASKEW), -level * libm::sin(ASKEW), LENGTHS[0] * libm::sin(slope));
    let outer = at(HEIGHTS[2]) + v(STEERING_ARM, 0.0, 0.0);
    let mut links = vec![
        link([before, ball], FRONT[0]),
        link([ball - v(0.0, LENGTHS[1], 0.0), ball], FRONT[1]),
        link([outer - v(0.0, LENGTHS[2], 0.0), outer], FRONT[2]),
    ];
    links[2].on_rack = true;
    let strut = Strut {
        ends: [top, top],
        guide: Guide::Axis { axis: (top - ball).unit(), mount: MOUNT, standing: Vector::default() },
        stiffness: p.front_spring_stiffness,
        damping: p.front_damping,
        standing: 0.0,
    };
    Corner { centre: v(0.0, HALF_TRACK, centre), axle: axle(), links, strut }
}

/// Way of the contact forward while the wheel travels up, with links that do not give and the brake held: the share of the braking
/// force that lifts the body.
pub(crate) fn lifts(corner: &Corner) -> Option<f64> {
    let contact = v(0.0, -corner.centre.z() * libm::tan(CAMBER), -corner.centre.z());
    let mut rows = [[0.0; 7]; 6];
    // a place on the carrier does not move in a direction
    let held = |place: Vector, direction: Vector| {
        let turning = (place - corner.centre).cross(direction);
        let [a, b, c] = direction.0;
        let [d, e, f] = turning.0;
        [a, b, c, d, e, f, 0.0]
    };
    for (row, link) in rows.iter_mut().zip(&corner.links) {
        *row = held(link.ends[1], (link.ends[0] - link.ends[1]).unit());
    }
    if let Guide::Axis { axis, .. } = corner.strut.guide {
        for (row, across) in rows[3..5].iter_mut().zip(across(axis)) {
            *row = held(corner.strut.ends[1], across);
        }
    }
    rows[5] = held(corner.centre + contact, v(0.0, 0.0, 1.0));
    rows[5][6] = 1.0;
    let motion = solve(rows)?;
    let (moving, turning) = (v(motion[0], motion[1], motion[2]), v(motion[3], motion[4], motion[5]));
    Some((moving + turning.cross(contact)).x())
}

/// Two directions across another.
pub(crate) fn across(axis: Vector) -> [Vector; 2] {
    let first = axis.cross(v(0.0, 1.0, 0.0)).unit();
    [first, axis.cross(first)]
}

/// The left front wheel, its centre as high as told. The slope of the longitudinal link is the one that makes the anti-dive.
pub(crate) fn front(p: &Parameters, centre: f64) -> Option<Corner> {
    let off = |slope: f64| lifts(&sloped(p, centre, slope)).map(|l| l - p.front_anti_dive);
    let (mut a, mut b) = (0.0, 0.1);
    let (mut at_a, mut at_b) = (off(a)?, off(b)?);
    for _ in 0..20 {
        if (at_b - at_a).abs() < 1e-14 || at_b.abs() < 1e-12 {
            break;
        }
        let next = b - at_b * (b - a) / (at_b - at_a);
        (a, at_a) = (b, at_b);
        (b, at_b) = (next, off(next)?);
    }
    Some(sloped(p, centre, b))
}

/// The left rear wheel, its centre as high as told.
pub(crate) fn rear(p: &Parameters, centre: f64) -> Corner {
    let behind = |ends: [Vector; 2]| ends.map(|end| end - v(WHEELBASE, 0.0, 0.0));
    let ends = behind(REAR_STRUT);
    let strut = Strut {
        ends,
        guide: Guide::Ends { length: (ends[0] - ends[1]).length() },
        stiffness: p.rear_spring_stiffness,
        damping: p.rear_damping,
        standing: 0.0,
    };
    Corner {
        centre: v(-WHEELBASE, HALF_TRACK, centre),
        axle: axle(),
        links: REAR.iter().map(|ends| link(behind(*ends), REAR_LINK)).collect(),
        strut,
    }
}

impl Corner {
    /// The mirror image.
    pub(crate) fn mirrored(&self) -> Self {
        let both = |ends: [Vector; 2]| ends.map(Vector::mirrored);
        let guide = match self.strut.guide {
            Guide::Axis { axis, mount, standing } => {
                Guide::Axis { axis: axis.mirrored(), mount, standing: standing.mirrored() }
            }
            ends @ Guide::Ends { .. } => ends,
        };
        Self {
            centre: self.centre.mirrored(),
            // it still points to the left
            axle: -self.axle.mirrored(),
            links: self.links.iter().map(|l| Link { ends: both(l.ends), ..*l }).collect(),
            strut: Strut { ends: both(self.strut.ends), guide, ..self.strut },
        }
    }

    /// Gives its joints the forces that hold the carrier against a force, and a moment about the wheel's centre.
    pub(crate) fn hold(&mut self, force: Vector, moment: Vector) -> Option<()> {
        let centre = self.centre;
        // what a unit force at a place does to the carrier
        let unit = |place: Vector, direction: Vector| {
            let about = (place - centre).cross(direction);
            let ([a, b, c], [d, e, f]) = (direction.0, about.0);
            [a, b, c, d, e, f]
        };
        let mut columns: Vec<[f64; 6]> =
            self.links.iter().map(|link| unit(link.ends[1], (link.ends[0] - link.ends[1]).unit())).collect();
        let [on_body, on_carrier] = self.strut.ends;
        let directions = match self.strut.guide {
            Guide::Axis { axis, .. } => across(axis),
            Guide::Ends { .. } => [Vector::default(); 2],
        };
        match self.strut.guide {
            Guide::Axis { axis, .. } => {
                columns.push(unit(on_carrier, -axis));
                columns.extend(directions.map(|across| unit(on_carrier, -across)));
            }
            Guide::Ends { .. } => columns.push(unit(on_carrier, (on_carrier - on_body).unit())),
        }
        let ([a, b, c], [d, e, f]) = (force.0, moment.0);
        let against = [a, b, c, d, e, f];
        let mut rows = [[0.0; 7]; 6];
        for (k, row) in rows.iter_mut().enumerate() {
            for (value, column) in row.iter_mut().zip(&columns) {
                *value = column[k];
            }
            row[6] = -against[k];
        }
        let forces = solve(rows)?;
        let count = self.links.len();
        self.links.iter_mut().zip(forces).for_each(|(link, force)| link.standing = force);
        self.strut.standing = forces[count];
        if let Guide::Axis { standing, .. } = &mut self.strut.guide {
            *standing = directions[0] * forces[count + 1] + directions[1] * forces[count + 2];
        }
        Some(())
    }
}
