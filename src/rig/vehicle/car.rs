//! Masses and sizes of the car.

use super::five_link::FiveLink;
use super::joint::Springs;
use super::mcpherson::McPherson;
use crate::mechanics::RigidBody;
use crate::model::{Purpose, Role, Table, parameter};
use crate::{Error, Result, clone_in_place, lens, real};
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
    fn rows() -> Table<Self> {
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

/// Masses and sizes; x counts from the front axle.
#[derive(Debug, PartialEq, Default, Serialize, Deserialize)]
pub struct Car {
    pub mass: f64,
    pub wheelbase: f64,
    /// Centre of mass of the vehicle: behind the front axle, over the road \[m\].
    pub centre: [f64; 2],
    /// Of the body about its own centre: roll, pitch, yaw \[kg.m²\].
    pub inertia: [f64; 3],
    /// Front, rear.
    pub axles: [Axle; 2],
    pub mcpherson: McPherson,
    pub five_link: FiveLink,
    pub rack: Rack,
    pub air: Air,
    /// Torque over the difference of the mean speeds of front and rear wheels \[N.m.s/rad\].
    pub coupling: f64,
}

clone_in_place!(Car { mass, wheelbase, centre, inertia, axles, mcpherson, five_link, rack, air, coupling });

/// Rack and column.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct Rack {
    pub mass: f64,
    pub ratio: f64,
    pub stiffness: f64,
    pub damping: f64,
    pub friction: f64,
    pub friction_stiffness: f64,
}

/// Forces of the air.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct Air {
    pub density: f64,
    pub drag: f64,
    /// In front and behind.
    pub lift: [f64; 2],
}

impl Rack {
    #[rustfmt::skip] // a row is a line
    fn rows() -> Table<Self> {
        Table::new([
            parameter("rack_mass", "kg", real!(mass), 4.0, "Mass of the rack, with what turns with it").range(0.1, 1e3),
            parameter("rack_ratio", "m/rad", real!(ratio), 0.0085, "Way of the rack over the angle of the steering wheel").range(1e-4, 1.0).purpose(Purpose::Data),
            parameter("column_stiffness", "N/m", real!(stiffness), 0.6e6, "Stiffness of column, steering wheel and the driver's arms, at the rack").range(0.0, 1e9).role(Role::Stiffness).tunable(),
            parameter("column_damping", "N.s/m", real!(damping), 2300.0, "Damping of that, at the rack").range(0.0, 1e6).tunable(),
            parameter("rack_friction", "N", real!(friction), 0.0, "Friction of the rack").range(0.0, 1e5).tunable(),
            parameter("rack_friction_stiffness", "N/m", real!(friction_stiffness), 1e6, "Stiffness of the rack before its friction slips").range(1.0, 1e9).role(Role::Stiffness),
        ])
    }
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
        .part("front_", lens!(axles[0]), Axle::rows())
        .part("front_", lens!(mcpherson), McPherson::rows())
        .part("", lens!(rack), Rack::rows())
        .part("rear_", lens!(axles[1]), rear)
        .part("rear_", lens!(five_link), FiveLink::rows())
        .part("", lens!(air), Air::rows())
        .and([
            parameter("coupling_damping", "N.m.s/rad", real!(coupling), 0.0, "Torque of a viscous coupling on each axle over the difference of the mean speeds of its wheels and those of the other one").range(0.0, 1e5).tunable(),
        ])
    }

    /// # Errors
    /// Masses and sizes that contradict each other.
    pub fn prepare(&mut self) -> Result<()> {
        self.axles[0].springs.prepare("front_damper")?;
        self.axles[1].springs.prepare("rear_damper")?;
        self.mcpherson.check()?;
        let unsprung = 2.0 * (self.axles[0].unsprung() + self.axles[1].unsprung());
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
        self.mass - 2.0 * (self.axles[0].unsprung() + self.axles[1].unsprung())
    }

    /// The body.
    pub fn body(&self) -> RigidBody {
        RigidBody { mass: self.body_mass(), inertia: self.inertia }
    }

    /// Centre of mass of the body: before the front axle, over the road \[m\]; with the heights of the wheels' centres in front and
    /// behind.
    pub fn body_centre(&self, heights: [f64; 2]) -> [f64; 2] {
        let unsprung = self.axles.each_ref().map(|axle| 2.0 * axle.unsprung());
        let x = -self.mass * self.centre[0] + unsprung[1] * self.wheelbase;
        let z = self.mass * self.centre[1] - unsprung[0] * heights[0] - unsprung[1] * heights[1];
        [x / self.body_mass(), z / self.body_mass()]
    }

    /// x of an axle before the front one \[m\].
    pub fn axle_x(&self, axle: usize) -> f64 {
        if axle == 0 { 0.0 } else { -self.wheelbase }
    }
}
