//! Springs, dampers and stops: what acts along one direction, and what acts between two points of attack.

use super::motion::{Wrench, cross, turn};
use super::pose::{At, Pose};
use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

/// A spring beside a damper, both linear. Of a rotation: N.m/rad and N.m.s/rad.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct SpringDamper {
    /// \[N/m\]
    pub stiffness: f64,
    /// \[N.s/m\]
    pub damping: f64,
}

impl SpringDamper {
    /// Force \[N\] with which it pulls its ends together, drawn out by `extension` \[m\] at `rate` \[m/s\].
    pub fn force(&self, extension: f64, rate: f64) -> f64 {
        self.stiffness * extension + self.damping * rate
    }

    /// Energy in the spring \[J\].
    pub fn energy(&self, extension: f64) -> f64 {
        0.5 * self.stiffness * extension * extension
    }

    /// Power that the damper turns into heat \[W\].
    pub fn power_loss(&self, rate: f64) -> f64 {
        self.damping * rate * rate
    }
}

/// A stop that is met after a free way: from there on a spring whose force grows with the square of the way, as that
/// of cellular rubber does, from zero and without a jump in stiffness.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct BumpStop {
    /// Free way until it is met \[m\].
    pub gap: f64,
    /// Force over the square of the way into it \[N/m²\].
    pub stiffness: f64,
}

impl BumpStop {
    /// Force \[N\] against a way `travel` \[m\]: never negative, a stop does not pull.
    pub fn force(&self, travel: f64) -> f64 {
        let into = (travel - self.gap).max(0.0);
        self.stiffness * into * into
    }

    /// Energy in it \[J\].
    pub fn energy(&self, travel: f64) -> f64 {
        let into = (travel - self.gap).max(0.0);
        self.stiffness * into * into * into / 3.0
    }
}

/// A force along the line between two points of attack, one on each of two bodies.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct Rod {
    /// The points of attack in the axes of their bodies, from the bodies' centres \[m\].
    pub points: [Vector3<f64>; 2],
}

/// A rod as it is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Spanned {
    /// Its ends.
    pub ends: [At; 2],
    /// Unit vector from the first to the second, frame 0; none where they fall together.
    pub along: Vector3<f64>,
    /// Distance of the points \[m\].
    pub length: f64,
    /// Its rate \[m/s\].
    pub rate: f64,
}

impl Rod {
    /// How it is spanned between two bodies.
    #[inline]
    pub fn between(&self, bodies: [&Pose; 2]) -> Spanned {
        Spanned::new([bodies[0].at(&self.points[0]), bodies[1].at(&self.points[1])])
    }
}

impl Spanned {
    /// Between two points.
    #[inline]
    pub fn new(ends: [At; 2]) -> Self {
        let apart = ends[1].place - ends[0].place;
        let length = apart.norm();
        let along = if length > 0.0 { apart / length } else { Vector3::zeros() };
        Self { ends, along, length, rate: along.dot(&(ends[1].velocity - ends[0].velocity)) }
    }

    /// What a force \[N\] that pulls the points together puts on each body: force and moment about its centre, in
    /// frame 0. Both forces lie on one line, so no momentum and no moment of momentum is made.
    #[inline]
    pub fn wrenches(&self, pull: f64) -> [Wrench<f64>; 2] {
        let force = self.along * pull;
        [self.ends[0].load(force), self.ends[1].load(-force)]
    }
}

/// A point of the second body that slides along an axis of the first one: across it springs and dampers hold the point, along it
/// whatever acts there.
///
/// All of it attacks both bodies at the sliding point, so that no momentum and no moment of momentum is made, whatever the way is.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct Guide {
    /// The points in the axes of their bodies, from the bodies' centres \[m\]: where they fall together nothing is strained.
    pub points: [Vector3<f64>; 2],
    /// Unit vector along which the second one slides, in the first body's axes.
    pub axis: Vector3<f64>,
    /// Across it.
    pub held: SpringDamper,
}

/// A guide as it is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Slid {
    /// The sliding point on the first and on the second body.
    pub ends: [At; 2],
    /// The axis, frame 0.
    pub axis: Vector3<f64>,
    /// Way of the second body's point along it \[m\], and its rate \[m/s\].
    pub way: f64,
    /// \[m/s\]
    pub rate: f64,
    /// How far it is off the axis \[m\], frame 0, and the rate of that as the first body sees it.
    pub off: Vector3<f64>,
    /// \[m/s\]
    pub off_rate: Vector3<f64>,
}

impl Guide {
    /// How it is between two bodies.
    #[inline]
    pub fn between(&self, bodies: [&Pose; 2]) -> Slid {
        let second = bodies[1].at(&self.points[1]);
        let arm = second.place - bodies[0].position;
        // the point of the first body at which the second one's point is now
        let first =
            At { arm, place: second.place, velocity: bodies[0].velocity + cross(&bodies[0].spin, &arm) };
        let axis = turn(&bodies[0].axes, &self.axis);
        let apart = arm - turn(&bodies[0].axes, &self.points[0]);
        let closing = second.velocity - first.velocity;
        let (way, rate) = (axis.dot(&apart), axis.dot(&closing));
        Slid {
            ends: [first, second],
            axis,
            way,
            rate,
            off: apart - axis * way,
            off_rate: closing - axis * rate,
        }
    }

    /// Energy in what holds across \[J\].
    pub fn energy(&self, slid: &Slid) -> f64 {
        self.held.energy(slid.off.norm())
    }

    /// Power that the dampers across turn into heat \[W\].
    pub fn power_loss(&self, slid: &Slid) -> f64 {
        self.held.power_loss(slid.off_rate.norm())
    }

    /// The force across on the first body \[N\], frame 0.
    pub fn across(&self, slid: &Slid) -> Vector3<f64> {
        slid.off * self.held.stiffness + slid.off_rate * self.held.damping
    }
}

impl Slid {
    /// What a force on the first body at the sliding point \[N\], and its opposite on the second one, put on each.
    pub fn wrenches(&self, force: Vector3<f64>) -> [Wrench<f64>; 2] {
        [self.ends[0].load(force), self.ends[1].load(-force)]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mechanics::Motion;
    use proptest::prelude::*;

    fn vector(size: f64) -> impl Strategy<Value = Vector3<f64>> {
        [-size..size, -size..size, -size..size].prop_map(Vector3::from)
    }

    fn pose() -> impl Strategy<Value = Pose> {
        (vector(2.0), vector(3.0), vector(1.0), vector(2.0)).prop_map(
            |(position, velocity, angles, rates)| Pose::from(&Motion { position, velocity, angles, rates }),
        )
    }

    fn power(at: &Pose, w: &Wrench<f64>) -> f64 {
        w.force.dot(&at.velocity) + w.moment.dot(&at.spin)
    }

    /// Sum of forces, and of moments about the origin.
    fn sum(bodies: [&Pose; 2], wrenches: &[Wrench<f64>; 2]) -> f64 {
        let about = |at: &Pose, w: &Wrench<f64>| w.moment + cross(&at.position, &w.force);
        let force = wrenches[0].force + wrenches[1].force;
        force.norm() + (about(bodies[0], &wrenches[0]) + about(bodies[1], &wrenches[1])).norm()
    }

    proptest! {
        #[test]
        fn a_rod_makes_no_momentum_and_its_power_is_that_of_its_length(
            a in pose(), b in pose(), p in vector(0.5), q in vector(0.5), pull in -1e4..1e4,
        ) {
            let rod = Rod { points: [p, q] }.between([&a, &b]);
            prop_assume!(rod.length > 1e-3);
            let wrenches = rod.wrenches(pull);
            prop_assert!(sum([&a, &b], &wrenches) < 1e-9 * pull.abs());
            let given = power(&a, &wrenches[0]) + power(&b, &wrenches[1]);
            prop_assert!((given + pull * rod.rate).abs() < 1e-8 * pull.abs() * (1.0 + rod.rate.abs()));
        }

        /// What it gives to the bodies is what its springs lose, its dampers do not take, and the force along makes of its way.
        #[test]
        fn a_guide_makes_no_momentum_and_gives_what_its_springs_lose(
            a in vector(0.7), b in vector(0.7), place in vector(0.3), turning in (vector(1.0), vector(1.0)),
            moving in (vector(2.0), vector(2.0)), p in vector(0.5), q in vector(0.5), axis in vector(1.0), pull in -1e3..1e3_f64,
        ) {
            prop_assume!(axis.norm() > 0.1);
            let held = SpringDamper { stiffness: 4e4, damping: 300.0 };
            let guide = Guide { points: [p, q], axis: axis.normalize(), held };
            let motions = [(Vector3::zeros(), a, moving.0, turning.0), (place, b, moving.1, turning.1)]
                .map(|(position, angles, velocity, rates)| Motion { position, angles, velocity, rates });
            let at = |t: f64| motions.map(|m| Pose::from(&Motion {
                position: m.position + m.velocity * t, angles: m.angles + m.rates * t, ..m
            }));
            let slid = |t: f64| { let [a, b] = at(t); guide.between([&a, &b]) };
            let h = 1e-6;
            let slope = (guide.energy(&slid(h)) - guide.energy(&slid(-h))) / (2.0 * h);
            let ([first, second], now) = (at(0.0), slid(0.0));
            let wrenches = now.wrenches(guide.across(&now) + now.axis * pull);
            let size = 1.0 + wrenches[0].force.norm();
            prop_assert!(sum([&first, &second], &wrenches) < 1e-9 * size);
            let given: f64 = power(&first, &wrenches[0]) + power(&second, &wrenches[1]);
            let taken: f64 = slope + guide.power_loss(&now) + pull * now.rate;
            prop_assert!((given + taken).abs() < 1e-5 * size, "{given} {taken}");
        }
    }

    #[test]
    fn forces_are_slopes_of_energies() {
        let (spring, stop) =
            (SpringDamper { stiffness: 3e4, damping: 0.0 }, BumpStop { gap: 0.02, stiffness: 4e7 });
        let h = 1e-6;
        for travel in [-0.03, 0.0, 0.015, 0.025, 0.06] {
            let slope = |energy: &dyn Fn(f64) -> f64| (energy(travel + h) - energy(travel - h)) / (2.0 * h);
            assert!((slope(&|x| spring.energy(x)) - spring.force(travel, 0.0)).abs() < 1e-4);
            assert!((slope(&|x| stop.energy(x)) - stop.force(travel)).abs() < 1e-3);
        }
        assert_eq!(stop.force(0.02), 0.0);
    }
}
