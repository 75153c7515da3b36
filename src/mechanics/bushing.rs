//! A bushing: springs and dampers in six directions between two bodies.

use super::motion::{Motion, Wrench, cross};
use nalgebra::{Matrix3, Vector3};

/// Springs and dampers along and about the axes of a body, between a point of that body and a point of another.
///
/// The axes are those of the first body. Displacements are those of the second body's point, seen from the first body's;
/// angles are the components of the rotation vector that turns the first body's axes into the second's, so that
/// none of them is singular below half a turn and none comes before another. For small angles they are the
/// angles about the three axes.
///
/// The force attacks both bodies at the second one's point, the moment is the same on both: no momentum and no moment of
/// momentum is made, whatever the displacement is. It is linear: for displacements and angles that are small
/// against the distances between bushings.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Bushing {
    /// The points in the axes of their bodies, from the bodies' centres \[m\].
    pub points: [Vector3<f64>; 2],
    /// \[N/m\]
    pub stiffness: Vector3<f64>,
    /// \[N.s/m\]
    pub damping: Vector3<f64>,
    /// \[N.m/rad\]
    pub turning_stiffness: Vector3<f64>,
    /// \[N.m.s/rad\]
    pub turning_damping: Vector3<f64>,
}

/// How far the second body is from where the bushing holds it, in the first body's axes.
struct Displacement {
    way: Vector3<f64>,
    rate: Vector3<f64>,
    angle: Vector3<f64>,
    turning: Vector3<f64>,
    /// From the first body's axes to frame 0.
    axes: Matrix3<f64>,
    /// From the bodies' centres to the second body's point, frame 0.
    arms: [Vector3<f64>; 2],
}

impl Bushing {
    /// Force and moment on each of the bodies about its centre, frame 0.
    pub fn wrenches(&self, bodies: [&Motion<f64>; 2]) -> [Wrench<f64>; 2] {
        let at = self.displacement(bodies);
        let pull = at.way.component_mul(&self.stiffness) + at.rate.component_mul(&self.damping);
        let twist =
            at.angle.component_mul(&self.turning_stiffness) + at.turning.component_mul(&self.turning_damping);
        let (force, moment) = (at.axes * pull, at.axes * twist);
        [(at.arms[0], force, moment), (at.arms[1], -force, -moment)]
            .map(|(arm, force, moment)| Wrench { force, moment: moment + cross(&arm, &force) })
    }

    /// Energy in its springs \[J\].
    pub fn energy(&self, bodies: [&Motion<f64>; 2]) -> f64 {
        let at = self.displacement(bodies);
        let square = |v: &Vector3<f64>, k: &Vector3<f64>| 0.5 * k.dot(&v.component_mul(v));
        square(&at.way, &self.stiffness) + square(&at.angle, &self.turning_stiffness)
    }

    /// Power that its dampers turn into heat \[W\].
    pub fn power_loss(&self, bodies: [&Motion<f64>; 2]) -> f64 {
        let at = self.displacement(bodies);
        let square = |v: &Vector3<f64>, d: &Vector3<f64>| d.dot(&v.component_mul(v));
        square(&at.rate, &self.damping) + square(&at.turning, &self.turning_damping)
    }

    fn displacement(&self, [first, second]: [&Motion<f64>; 2]) -> Displacement {
        let (axes, turned) = (first.rotation(), second.rotation());
        let (spin, other_spin) = (first.angular_velocity(), second.angular_velocity());
        let arm = turned * self.points[1];
        let to_point = second.position + arm - first.position;
        // seen from the first body, which turns: the rate of components is not the components of the rate
        let velocity = second.velocity + cross(&other_spin, &arm) - first.velocity - cross(&spin, &to_point);
        let back = axes.transpose();
        Displacement {
            way: back * to_point - self.points[0],
            rate: back * velocity,
            angle: rotation_vector(&(back * turned)),
            turning: back * (other_spin - spin),
            axes,
            arms: [to_point, arm],
        }
    }
}

/// The axis of a rotation times its angle, from 0 to pi.
fn rotation_vector(rotation: &Matrix3<f64>) -> Vector3<f64> {
    let r = rotation;
    let axis = Vector3::new(r[(2, 1)] - r[(1, 2)], r[(0, 2)] - r[(2, 0)], r[(1, 0)] - r[(0, 1)]) * 0.5;
    let (sin, cos) = (axis.norm(), 0.5 * (r.trace() - 1.0));
    let angle = libm::atan2(sin, cos);
    // at no angle axis / sin is 0 / 0, and its limit is 1
    if sin > 1e-9 { axis * (angle / sin) } else { axis }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn vector(size: f64) -> impl Strategy<Value = Vector3<f64>> {
        [-size..size, -size..size, -size..size].prop_map(Vector3::from)
    }

    fn motion(turn: f64) -> impl Strategy<Value = Motion<f64>> {
        (vector(1.0), vector(2.0), vector(turn), vector(1.0))
            .prop_map(|(position, velocity, angles, rates)| Motion { position, velocity, angles, rates })
    }

    fn bushing() -> impl Strategy<Value = Bushing> {
        (vector(0.3), vector(0.3), vector(5e4), vector(300.0)).prop_map(|(p, q, k, d)| Bushing {
            points: [p, q],
            stiffness: k.abs(),
            damping: d.abs(),
            turning_stiffness: k.yzx().abs() * 0.01,
            turning_damping: d.zxy().abs() * 0.01,
        })
    }

    fn power(at: &Motion<f64>, w: &Wrench<f64>) -> f64 {
        w.force.dot(&at.velocity) + w.moment.dot(&at.angular_velocity())
    }

    proptest! {
        #[test]
        fn it_makes_no_momentum(a in motion(0.7), b in motion(0.7), bushing in bushing()) {
            let [on_a, on_b] = bushing.wrenches([&a, &b]);
            let about = |at: &Motion<f64>, w: &Wrench<f64>| w.moment + cross(&at.position, &w.force);
            let size = 1.0 + on_a.force.norm() + on_a.moment.norm();
            prop_assert!((on_a.force + on_b.force).norm() < 1e-10 * size);
            prop_assert!((about(&a, &on_a) + about(&b, &on_b)).norm() < 1e-10 * size);
        }

        /// What it gives to the bodies is what its springs lose and its dampers do not take: exactly along and
        /// across, and about one axis; about three axes at once to the order of the angle.
        #[test]
        fn what_it_gives_is_what_its_springs_lose(
            mut a in motion(1.0), mut b in motion(1.0), bushing in bushing(), axis in 0..3_usize, turn in -0.5..0.5,
        ) {
            (a.angles, b.angles) = (Vector3::zeros(), Vector3::zeros());
            b.angles[axis] = turn;
            // the second body turns about this axis only, and the first not at all
            let rate = b.rates[axis];
            (a.rates, b.rates) = (Vector3::zeros(), Vector3::zeros());
            b.rates[axis] = rate;
            let h = 1e-5;
            let moved = |m: &Motion<f64>, t: f64| Motion {
                position: m.position + m.velocity * t, angles: m.angles + m.rates * t, ..*m
            };
            let energy = |t: f64| bushing.energy([&moved(&a, t), &moved(&b, t)]);
            let slope = (energy(h) - energy(-h)) / (2.0 * h);
            let [on_a, on_b] = bushing.wrenches([&a, &b]);
            let given = power(&a, &on_a) + power(&b, &on_b);
            let loss = bushing.power_loss([&a, &b]);
            // velocities are of the order of displacements per second, so powers are of that of energies per second; the
            // slope is a difference of them
            let size = 1.0 + energy(0.0) + loss;
            prop_assert!((given + slope + loss).abs() < 1e-7 * size, "{given} {slope} {loss}");
        }
    }

    #[test]
    fn it_gives_way_as_far_as_its_stiffness_says() {
        let bushing = Bushing {
            stiffness: Vector3::new(1e5, 2e5, 3e5),
            turning_stiffness: Vector3::new(100.0, 200.0, 300.0),
            ..Bushing::default()
        };
        let held = Motion::default();
        let out = Motion {
            position: Vector3::new(1e-3, -2e-3, 3e-3),
            angles: Vector3::new(1e-5, 2e-5, -3e-5),
            ..Motion::default()
        };
        let [on_held, _] = bushing.wrenches([&held, &out]);
        assert!((on_held.force - Vector3::new(100.0, -400.0, 900.0)).norm() < 1e-9);
        // the force attacks at the other body's point, which is out of the middle
        let moment = Vector3::new(1e-3, 4e-3, -9e-3) + cross(&out.position, &on_held.force);
        assert!((on_held.moment - moment).norm() < 1e-6, "{}", on_held.moment);
    }
}
