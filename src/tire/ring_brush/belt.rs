//! The belt: a rigid body between side wall and patch (4.10), (4.11).

use super::{Contact, Parameters};
use crate::mechanics::{RigidBody, Wrench, cross};
use crate::solver::Real;
use nalgebra::Vector3;

/// Force and moment of the patch on the belt in frame 0, about the belt's centre \[N, N.m\] (4.35).
/// `force` and `moment` are in K about the contact point.
pub fn patch_on_belt<T: Real>(contact: &Contact<T>, force: &Vector3<T>, moment: &Vector3<T>) -> Wrench<T> {
    let rotation = contact.rotation();
    Wrench { force: rotation * force, moment: rotation * (moment - cross(&contact.centre, force)) }
}

impl Parameters {
    /// The belt as a rigid body; it spins about its y.
    pub fn belt(&self) -> RigidBody {
        let (across, spin) = (self.belt_inertia_diametral, self.belt_inertia_polar);
        RigidBody { mass: self.belt_mass, inertia: [across, spin, across] }
    }
}
