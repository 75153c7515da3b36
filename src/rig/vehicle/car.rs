//! Masses and sizes of the car.

use super::axle::Axle;
use super::five_link::FiveLink;
use super::front::FrontParameters;
use crate::mechanics::RigidBody;
use crate::model::{Purpose, Table, parameter};
use crate::{Error, Result, clone_in_place, lens, real};
use serde::{Deserialize, Serialize};

/// Masses and sizes; x counts from the front axle.
#[derive(Debug, PartialEq, Default, Serialize, Deserialize)]
pub struct Car {
    pub mass: f64,
    pub wheelbase: f64,
    /// Centre of mass of the vehicle: behind the front axle, over the road \[m\].
    pub centre: [f64; 2],
    /// Of the body about its own centre: roll, pitch, yaw \[kg.m²\].
    pub inertia: [f64; 3],
    pub front: FrontParameters,
    pub rear: Axle,
    pub five_link: FiveLink,
    pub air: Air,
    /// Torque over the difference of the mean speeds of front and rear wheels \[N.m.s/rad\].
    pub coupling: f64,
}

clone_in_place!(Car { mass, wheelbase, centre, inertia, front, rear, five_link, air, coupling });

/// Forces of the air.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct Air {
    pub density: f64,
    pub drag: f64,
    /// In front and behind.
    pub lift: [f64; 2],
}

impl Air {
    #[rustfmt::skip] // a row is a line
    fn rows() -> Table<Self> {
        Table::new([
            parameter("air_density", "kg/m3", real!(density), 1.2, "Density of the air").range(0.0, 10.0),
            parameter("drag_area", "m2", real!(drag), 0.6, "Drag of the air, at the height of the vehicle's centre of mass, over the dynamic pressure").range(0.0, 100.0),
            parameter("front_lift_area", "m2", real!(lift[0]), 0.05, "Lift on the body over the front axle, over the dynamic pressure; negative: downforce").range(-100.0, 100.0),
            parameter("rear_lift_area", "m2", real!(lift[1]), 0.02, "Lift on the body over the rear axle, over the dynamic pressure").range(-100.0, 100.0),
        ])
    }
}

impl Car {
    #[rustfmt::skip] // a row is a line
    pub fn rows() -> Table<Self> {
        let rear = Axle::rows()
            .with("spring_stiffness", |row| row.start(52e3))
            .with("damper", |row| row.start("-2 -6400; 2 6400"));
        Table::new([
            parameter("vehicle_mass", "kg", real!(mass), 1650.0, "Mass of the vehicle with wheels and driver, without masses inside the tires' models").range(10.0, 1e6),
            parameter("wheelbase", "m", real!(wheelbase), 2.35, "From the front axle to the rear one").range(0.5, 20.0).purpose(Purpose::Data),
            parameter("centre_of_mass_x", "m", real!(centre[0]), 1.44, "Its centre of mass behind the front axle").range(0.0, 20.0).purpose(Purpose::Data),
            parameter("centre_of_mass_z", "m", real!(centre[1]), 0.48, "Its centre of mass over the road, where the vehicle stands").range(0.05, 5.0).purpose(Purpose::Data),
            parameter("body_roll_inertia", "kg.m2", real!(inertia[0]), 450.0, "Inertia of the body, without wheels and carriers, about the longitudinal axis through its own centre of mass").range(0.1, 1e7),
            parameter("body_pitch_inertia", "kg.m2", real!(inertia[1]), 1900.0, "The same about the lateral axis").range(0.1, 1e7),
            parameter("body_yaw_inertia", "kg.m2", real!(inertia[2]), 2000.0, "The same about the vertical axis").range(0.1, 1e7),
        ])
        .part("", lens!(front), FrontParameters::rows())
        .part("rear_", lens!(rear), rear)
        .part("rear_", lens!(five_link), FiveLink::rows())
        .part("", lens!(air), Air::rows())
        .and([
            parameter("coupling_damping", "N.m.s/rad", real!(coupling), 0.0, "Torque of a viscous coupling on each axle over the difference of the mean speeds of its wheels and those of the other one").range(0.0, 1e5).tunable(),
        ])
    }

    /// # Errors
    /// Masses and sizes that contradict each other.
    pub fn prepare(&mut self) -> Result<()> {
        self.front.prepare()?;
        self.rear.springs.prepare("rear_damper")?;
        let unsprung = self.mass - self.body_mass();
        if self.mass <= 1.05 * unsprung {
            return Err(Error::variable(format!(
                "vehicle_mass = {} kg leaves nothing for a body: wheels and carriers are {unsprung} kg",
                self.mass
            )));
        }
        if self.centre[0] >= self.wheelbase {
            return Err(Error::variable(format!(
                "centre_of_mass_x = {} m has to be between the axles: wheelbase = {} m",
                self.centre[0], self.wheelbase
            )));
        }
        Ok(())
    }

    /// Mass of the body \[kg\].
    pub fn body_mass(&self) -> f64 {
        self.mass - 2.0 * (self.front.axle.unsprung() + self.rear.unsprung())
    }

    /// The body.
    pub fn body(&self) -> RigidBody {
        RigidBody { mass: self.body_mass(), inertia: self.inertia }
    }

    /// Centre of mass of the body: before the front axle, over the road \[m\]; with the heights of the wheels' centres in front and
    /// behind.
    pub fn body_centre(&self, heights: [f64; 2]) -> [f64; 2] {
        let unsprung = [0, 1].map(|axle| 2.0 * self.axle(axle).unsprung());
        let x = -self.mass * self.centre[0] + unsprung[1] * self.wheelbase;
        let z = self.mass * self.centre[1] - unsprung[0] * heights[0] - unsprung[1] * heights[1];
        [x / self.body_mass(), z / self.body_mass()]
    }

    /// The front (0) or rear (1) axle.
    pub fn axle(&self, axle: usize) -> &Axle {
        if axle == 0 { &self.front.axle } else { &self.rear }
    }

    /// x of an axle before the front one \[m\].
    pub fn axle_x(&self, axle: usize) -> f64 {
        if axle == 0 { 0.0 } else { -self.wheelbase }
    }
}
