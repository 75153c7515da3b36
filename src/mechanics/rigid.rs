//! Rigid bodies in Cardan angles.

use super::motion::{Attitude, Motion, Wrench, cross, turn, turn_back};
use crate::solver::Real;
use nalgebra::Vector3;

/// What a rigid body is made of. Its own axes are its principal axes of inertia.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct RigidBody {
    /// Mass \[kg\].
    pub mass: f64,
    /// Inertia about its axes x, y, z \[kg.m²\].
    pub inertia: [f64; 3],
}

impl RigidBody {
    /// Accelerations of the centre \[m/s²\] and of the Cardan angles \[rad/s²\] under the sum of all loads in
    /// frame 0 about the centre, and gravity \[m/s²\] along -z: Newton's and Euler's equations.
    pub fn acceleration<T: Real>(
        &self,
        motion: &Motion<T>,
        loads: &Wrench<T>,
        gravity: f64,
    ) -> (Vector3<T>, Vector3<T>) {
        self.acceleration_at(&motion.attitude(), &motion.rates, loads, gravity)
    }

    /// [`acceleration`](Self::acceleration) where sines and cosines of the angles are known.
    pub fn acceleration_at<T: Real>(
        &self,
        attitude: &Attitude<T>,
        rates: &Vector3<T>,
        loads: &Wrench<T>,
        gravity: f64,
    ) -> (Vector3<T>, Vector3<T>) {
        let mut linear = loads.force * T::from(1.0 / self.mass);
        linear.z -= T::from(gravity);

        // moments of inertia are those about the body's own axes
        let moments = Vector3::from(self.inertia.map(T::from));
        let rotation = attitude.rotation();
        let spin = turn(&attitude.rate_map(), rates);
        let momentum = turn(&rotation, &moments.component_mul(&turn_back(&rotation, &spin)));
        let moment = turn_back(&rotation, &(loads.moment - cross(&spin, &momentum)));
        let spin_rate = turn(&rotation, &moment.zip_map(&moments, |m, j| m / j));
        let turning = turn(&attitude.rate_map_derivative(rates), rates);
        let angular = turn(&attitude.rate_map_inverse(), &(spin_rate - turning));
        (linear, angular)
    }

    /// Energy of the motion \[J\].
    pub fn kinetic_energy(&self, motion: &Motion<f64>) -> f64 {
        let spin = turn_back(&motion.rotation(), &motion.angular_velocity());
        let turning: f64 = self.inertia.iter().zip(spin.iter()).map(|(j, w)| j * w * w).sum();
        0.5 * (self.mass * motion.velocity.norm_squared() + turning)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mechanics::{drift, kick};
    use nalgebra::Matrix3;

    /// A body without loads keeps its moment of momentum and its energy, and one that is thrown turning about its
    /// middle axis tumbles: the step is of second order in both.
    #[test]
    fn a_free_body_keeps_momentum_and_energy_to_second_order() {
        let body = RigidBody { mass: 2.0, inertia: [0.3, 0.7, 1.1] };
        let momentum = |motion: &Motion<f64>| {
            let a = motion.rotation();
            a * Matrix3::from_diagonal(&body.inertia.into()) * a.transpose() * motion.angular_velocity()
        };
        let run = |steps: usize| {
            let dt = 0.4 / steps as f64;
            let mut motion = Motion { rates: Vector3::new(0.3, 6.0, 0.2), ..Motion::default() };
            let (before, energy) = (momentum(&motion), body.kinetic_energy(&motion));
            let none = Wrench::default();
            let mut turning = body.acceleration(&motion, &none, 0.0).1;
            for _ in 0..steps {
                let step = drift(motion.rates, turning, dt);
                motion.angles += step.travel;
                motion.rates = step.predicted;
                turning = body.acceleration(&motion, &none, 0.0).1;
                motion.rates = kick(step.velocity, turning, dt);
            }
            ((momentum(&motion) - before).norm() / before.norm(), body.kinetic_energy(&motion) / energy - 1.0)
        };
        let (coarse, fine) = (run(400), run(800));
        assert!(fine.0 < 1e-4 && fine.1.abs() < 1e-4, "{fine:?}");
        assert!((coarse.0 / fine.0 - 4.0).abs() < 0.5, "{coarse:?} {fine:?}");
    }

    #[test]
    fn a_thrown_body_falls() {
        let body = RigidBody { mass: 2.0, inertia: [1.0; 3] };
        let load = Wrench { force: Vector3::new(4.0, 0.0, 0.0), moment: Vector3::new(0.0, 3.0, 0.0) };
        let (linear, angular) = body.acceleration(&Motion::<f64>::default(), &load, 9.81);
        assert_eq!(linear, Vector3::new(2.0, 0.0, -9.81));
        assert_eq!(angular, Vector3::new(0.0, 3.0, 0.0));
    }
}
