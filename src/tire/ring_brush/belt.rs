//! The belt: a rigid body between side wall and patch (4.10), (4.11).

use super::{Contact, Parameters};
use crate::solver::Real;
use crate::tire::motion::{Motion, Wrench, cross};
use nalgebra::{Matrix3, Vector3};

/// Force and moment of the patch on the belt in frame 0, about the belt's centre \[N, N.m\] (4.35).
/// `force` and `moment` are in K about the contact point.
pub fn patch_on_belt<T: Real>(contact: &Contact<T>, force: &Vector3<T>, moment: &Vector3<T>) -> Wrench<T> {
    let rotation = contact.rotation();
    Wrench { force: rotation * force, moment: rotation * (moment - cross(&contact.centre, force)) }
}

/// Accelerations of the belt: of its centre \[m/s²\] and of its Cardan angles \[rad/s²\], under the
/// sum of side wall and patch in frame 0 about its centre.
pub fn acceleration<T: Real>(
    p: &Parameters,
    belt: &Motion<T>,
    loads: &Wrench<T>,
) -> (Vector3<T>, Vector3<T>) {
    let mut linear = loads.force * T::from(1.0 / p.belt_mass);
    linear.z -= T::from(p.gravity);

    let (about_x, about_y) = (T::from(p.belt_inertia_diametral), T::from(p.belt_inertia_polar));
    let rotation = belt.rotation();
    let body = |diagonal: [T; 3]| rotation * Matrix3::from_diagonal(&diagonal.into()) * rotation.transpose();
    let inertia = body([about_x, about_y, about_x]);
    let inverse = body([about_x, about_y, about_x].map(|j| T::one() / j));

    let spin = belt.angular_velocity();
    let spin_rate = inverse * (loads.moment - cross(&spin, &(inertia * spin)));
    let angular = belt.rate_map_inverse() * (spin_rate - belt.rate_map_derivative() * belt.rates);
    (linear, angular)
}
