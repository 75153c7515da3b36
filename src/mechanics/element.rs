//! Springs, dampers and stops: what acts along one direction, and what acts between two points of attack.

use super::motion::{Motion, Wrench, cross};
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
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Strut {
    /// The points of attack in the axes of their bodies, from the bodies' centres \[m\].
    pub points: [Vector3<f64>; 2],
}

impl Strut {
    /// Distance of the points \[m\] and its rate \[m/s\].
    pub fn length(&self, bodies: [&Motion<f64>; 2]) -> (f64, f64) {
        let (apart, closing, _) = self.between(bodies);
        let length = apart.norm();
        (length, if length > 0.0 { apart.dot(&closing) / length } else { 0.0 })
    }

    /// What a force \[N\] that pulls the points together puts on each body: force and moment about its centre, in
    /// frame 0. Both forces lie on one line, so no momentum and no moment of momentum is made.
    pub fn wrenches(&self, bodies: [&Motion<f64>; 2], pull: f64) -> [Wrench<f64>; 2] {
        let (apart, _, arms) = self.between(bodies);
        let length = apart.norm();
        let along = if length > 0.0 { apart / length } else { Vector3::zeros() };
        [(arms[0], along * pull), (arms[1], along * -pull)]
            .map(|(arm, force)| Wrench { force, moment: cross(&arm, &force) })
    }

    /// From the first point to the second, the rate of that, and the points' arms; frame 0.
    fn between(&self, bodies: [&Motion<f64>; 2]) -> (Vector3<f64>, Vector3<f64>, [Vector3<f64>; 2]) {
        let arms = [0, 1].map(|i| bodies[i].rotation() * self.points[i]);
        let places = [0, 1].map(|i| bodies[i].position + arms[i]);
        let speeds = [0, 1].map(|i| bodies[i].velocity + cross(&bodies[i].angular_velocity(), &arms[i]));
        (places[1] - places[0], speeds[1] - speeds[0], arms)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn vector(size: f64) -> impl Strategy<Value = Vector3<f64>> {
        [-size..size, -size..size, -size..size].prop_map(Vector3::from)
    }

    fn motion() -> impl Strategy<Value = Motion<f64>> {
        (vector(2.0), vector(3.0), vector(1.0), vector(2.0))
            .prop_map(|(position, velocity, angles, rates)| Motion { position, velocity, angles, rates })
    }

    proptest! {
        #[test]
        fn a_strut_makes_no_momentum_and_its_power_is_that_of_its_length(
            a in motion(), b in motion(), p in vector(0.5), q in vector(0.5), pull in -1e4..1e4,
        ) {
            let strut = Strut { points: [p, q] };
            let (length, rate) = strut.length([&a, &b]);
            prop_assume!(length > 1e-3);
            let [on_a, on_b] = strut.wrenches([&a, &b], pull);
            let about_origin = |at: &Motion<f64>, w: &Wrench<f64>| w.moment + cross(&at.position, &w.force);
            prop_assert!((on_a.force + on_b.force).norm() < 1e-9 * pull.abs());
            prop_assert!((about_origin(&a, &on_a) + about_origin(&b, &on_b)).norm() < 1e-9 * pull.abs());
            let power = |at: &Motion<f64>, w: &Wrench<f64>| {
                w.force.dot(&at.velocity) + w.moment.dot(&at.angular_velocity())
            };
            let given = power(&a, &on_a) + power(&b, &on_b);
            prop_assert!((given + pull * rate).abs() < 1e-8 * pull.abs() * (1.0 + rate.abs()));
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
