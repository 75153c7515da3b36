//! The super-elastic tire against the numbers of an independent program (the specification's checks), a model of the source's
//! equations that shares no code with it, closed forms and balances.
#![allow(missing_docs, clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod balances;
mod cleats;
#[path = "../common/mod.rs"]
mod common;
mod drum;
mod dynamics;
mod reference;
mod statics;

use latsch::road::Road;
use latsch::tire::super_elastic::{Parameters, SuperElastic};
use latsch::tire::{Flat, Motion, Rest, Tire, Vertical};
use nalgebra::Vector3;

/// The road of all that is not on a rig.
pub const FLAT: Flat = Flat { friction: 1.0 };

/// A tire with its default parameters changed.
pub fn tire(change: impl FnOnce(&mut Parameters)) -> SuperElastic {
    let mut tire = SuperElastic::default();
    SuperElastic::rows().write_starts(&mut tire);
    change(&mut tire.parameters);
    tire.mount(&Road::default()).unwrap();
    tire
}

/// The tire of the specification's dynamic checks: one contact point for an element.
pub fn single(stiffness: f64) -> impl Fn(&mut Parameters) {
    move |p| {
        p.contact_points = 1;
        p.stiffness = stiffness;
        p.rim_force = 2;
    }
}

/// A rim that moves forward and spins.
pub fn rim(height: f64, speed: f64, spin: f64) -> Motion<f64> {
    Motion {
        position: Vector3::new(0.0, 0.0, height),
        velocity: Vector3::new(speed, 0.0, 0.0),
        rates: Vector3::new(0.0, spin, 0.0),
        ..Motion::default()
    }
}

/// The state at rest under a mass, of which the tire's rubber is a part.
pub fn under_mass(tire: &SuperElastic, mass: f64) -> Rest<<SuperElastic as Tire>::Inside> {
    let load = (mass - tire.parameters.rubber_mass) * 9.81;
    tire.stationary(&rim(0.0, 0.0, 0.0), Vertical::Load(load), 1.0).unwrap()
}

/// The tire in that state.
pub fn settled(tire: &SuperElastic, mass: f64) -> (SuperElastic, Motion<f64>) {
    let mut tire = tire.clone();
    let rest = under_mass(&tire, mass);
    let rim = rim(rest.rim_height, 0.0, 0.0);
    let plane = latsch::tire::Plane::level(rest.rim_height, 1.0);
    tire.begin(&rest, &rim, &plane, &FLAT).unwrap();
    (tire, rim)
}
