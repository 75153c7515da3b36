//! What both axles have: wheels, carriers, springs.

use super::joint::Springs;
use crate::mechanics::RigidBody;
use crate::model::{Purpose, Role, Table, parameter};
use crate::{clone_in_place, lens, real};
use serde::{Deserialize, Serialize};

/// What an axle is made of, besides its joints.
#[derive(Debug, PartialEq, Default, Serialize, Deserialize)]
pub struct Axle {
    pub track: f64,
    pub camber: f64,
    pub toe: f64,
    pub wheel_mass: f64,
    pub wheel_inertia: f64,
    pub wheel_transverse_inertia: f64,
    pub carrier_mass: f64,
    pub carrier_inertia: f64,
    pub springs: Springs,
}

clone_in_place!(Axle {
    track,
    camber,
    toe,
    wheel_mass,
    wheel_inertia,
    wheel_transverse_inertia,
    carrier_mass,
    carrier_inertia,
    springs,
});

impl Axle {
    #[rustfmt::skip] // a row is a line
    pub fn rows() -> Table<Self> {
        Table::new([
            parameter("track", "m", real!(track), 1.49, "Distance of the wheels' centres").range(0.5, 4.0).purpose(Purpose::Data),
            parameter("camber", "rad", real!(camber), -0.0087, "Camber where the vehicle stands, positive outward at the top").range(-0.2, 0.2).role(Role::Camber),
            parameter("toe", "rad", real!(toe), 0.0014, "Toe of a wheel where the vehicle stands, positive inward in front").range(-0.1, 0.1).role(Role::SteerAngle),
            parameter("wheel_mass", "kg", real!(wheel_mass), 20.0, "Mass of rim, disc and what turns with them, without masses inside the tire's model; with measuring rims theirs").range(0.5, 1e3),
            parameter("wheel_inertia", "kg.m2", real!(wheel_inertia), 0.9, "Inertia of that about the wheel's axis, without masses inside the tire's model").range(1e-3, 1e3),
            parameter("wheel_transverse_inertia", "kg.m2", real!(wheel_transverse_inertia), 0.5, "Inertia of that about a diameter").range(1e-3, 1e3),
            parameter("carrier_mass", "kg", real!(carrier_mass), 20.0, "Mass of wheel carrier, caliper and what of the links moves with them").range(0.5, 1e3),
            parameter("carrier_inertia", "kg.m2", real!(carrier_inertia), 0.4, "Inertia of that about any axis through the wheel's centre").range(1e-3, 1e3),
        ])
        .part("", lens!(springs), Springs::rows())
    }

    /// Mass of a wheel with its carrier \[kg\].
    pub fn unsprung(&self) -> f64 {
        self.wheel_mass + self.carrier_mass
    }

    /// The carrier with its wheel, which does not turn about its axis with it, and masses of the tire that it carries \[kg\].
    pub fn carrier(&self, carried: f64) -> RigidBody {
        let across = self.carrier_inertia + self.wheel_transverse_inertia;
        RigidBody { mass: self.unsprung() + carried, inertia: [across, self.carrier_inertia, across] }
    }
}
