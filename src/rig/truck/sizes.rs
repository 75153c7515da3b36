//! Masses and sizes of the truck. x counts from the front axle, forward; y from the middle, to the left; z from the road.

use super::frame::{Places, Point};
use crate::mechanics::{Link, SpringDamper};
use crate::model::{Purpose, Role, Table, parameter};
use crate::{Error, Result, real};
use serde::{Deserialize, Serialize};

/// What the truck is made of.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct Sizes {
    pub wheelbase: f64,
    /// Distance of the front wheels and of the twin rear wheels \[m\].
    pub tracks: [f64; 2],
    /// Chassis with counterweight, axles, bolster and wheels \[kg\].
    pub chassis_mass: f64,
    /// Its centre of mass: x and height \[m\].
    pub chassis: [f64; 2],
    /// Inertia of pitch and roll \[kg.m²\].
    pub chassis_inertia: [f64; 2],
    pub cabin_mass: f64,
    pub cabin: [f64; 2],
    pub cabin_inertia: [f64; 2],
    /// Height of the mounts \[m\].
    pub mount_height: f64,
    /// Half distances of the four mounts along and across \[m\].
    pub mount_places: [f64; 2],
    /// Each of four.
    pub mount: SpringDamper,
    pub carriage_mass: f64,
    pub payload: f64,
    /// x of carriage and payload \[m\].
    pub carriage: f64,
    pub chain: SpringDamper,
    /// Way of the carriage up, over its place at rest, until it meets the mast \[m\]; and the stop.
    pub play: f64,
    pub stop: SpringDamper,
    pub bolster_inertia: f64,
    pub bolster_damping: f64,
    /// Of the roof's sensor, over the road; x and y of the seat's one.
    pub roof: f64,
    pub seat: [f64; 2],
}

impl Sizes {
    #[rustfmt::skip] // a row is a line
    pub fn rows() -> Table<Self> {
        Table::new([
            parameter("wheelbase", "m", real!(wheelbase), 1.25, "From the front axle back to the bolster").range(0.2, 10.0).purpose(Purpose::Data),
            parameter("front_track", "m", real!(tracks[0]), 0.9, "Distance of the front wheels").range(0.1, 5.0).purpose(Purpose::Data),
            parameter("rear_track", "m", real!(tracks[1]), 0.2, "Distance of the twin rear wheels").range(0.05, 5.0).purpose(Purpose::Data),
            parameter("chassis_mass", "kg", real!(chassis_mass), 2300.0, "Mass of chassis, drive axle, counterweight, bolster and wheels; without the rubber where the tires have their rim_force as exact").range(10.0, 1e5),
            parameter("chassis_x", "m", real!(chassis[0]), -0.624, "Its centre of mass before the front axle").range(-10.0, 10.0).purpose(Purpose::Data),
            parameter("chassis_z", "m", real!(chassis[1]), 0.6, "Its centre of mass over the road").range(0.0, 5.0).purpose(Purpose::Data),
            parameter("chassis_pitch_inertia", "kg.m2", real!(chassis_inertia[0]), 900.0, "Its inertia about the lateral axis").range(0.1, 1e6),
            parameter("chassis_roll_inertia", "kg.m2", real!(chassis_inertia[1]), 350.0, "Its inertia about the longitudinal axis").range(0.1, 1e6),
            parameter("cabin_mass", "kg", real!(cabin_mass), 350.0, "Mass of the cabin with the driver").range(1.0, 1e4),
            parameter("cabin_x", "m", real!(cabin[0]), -0.75, "Its centre of mass, and the middle of its mounts, before the front axle").range(-10.0, 10.0).purpose(Purpose::Data),
            parameter("cabin_z", "m", real!(cabin[1]), 1.4, "Its centre of mass over the road").range(0.0, 5.0).purpose(Purpose::Data),
            parameter("cabin_pitch_inertia", "kg.m2", real!(cabin_inertia[0]), 90.0, "Its inertia about the lateral axis").range(0.1, 1e5),
            parameter("cabin_roll_inertia", "kg.m2", real!(cabin_inertia[1]), 80.0, "Its inertia about the longitudinal axis").range(0.1, 1e5),
            parameter("mount_z", "m", real!(mount_height), 0.8, "Height of the cabin's mounts over the road").range(0.0, 5.0).purpose(Purpose::Data),
            parameter("mount_x", "m", real!(mount_places[0]), 0.4, "Half distance of the cabin's mounts along").range(0.01, 5.0).purpose(Purpose::Data),
            parameter("mount_y", "m", real!(mount_places[1]), 0.4, "Half distance of the cabin's mounts across").range(0.01, 5.0).purpose(Purpose::Data),
            parameter("mount_stiffness", "N/m", real!(mount.stiffness), 3e5, "Vertical stiffness of each of the four mounts of the cabin").range(1.0, 1e9).role(Role::Stiffness),
            parameter("mount_damping", "N.s/m", real!(mount.damping), 1500.0, "Vertical damping of each").range(0.0, 1e6),
            parameter("carriage_mass", "kg", real!(carriage_mass), 250.0, "Mass of the fork carriage with what of the mast moves with it").range(1.0, 1e5),
            parameter("payload", "kg", real!(payload), 0.0, "Mass on the forks").range(0.0, 1e5),
            parameter("carriage_x", "m", real!(carriage), 0.75, "Carriage and payload before the front axle").range(0.0, 5.0).purpose(Purpose::Data),
            parameter("chain_stiffness", "N/m", real!(chain.stiffness), 1.5e6, "Stiffness of the mast's chains with their cylinder, which can only pull the carriage up").range(1e3, 1e9).role(Role::Stiffness),
            parameter("chain_damping", "N.s/m", real!(chain.damping), 3000.0, "Damping of them").range(0.0, 1e6),
            parameter("mast_play", "m", real!(play), 0.02, "Way of the carriage up over its place at rest until it meets the mast").range(0.0, 1.0),
            parameter("mast_stop_stiffness", "N/m", real!(stop.stiffness), 5e6, "Stiffness of the mast there").range(0.0, 1e9),
            parameter("mast_stop_damping", "N.s/m", real!(stop.damping), 2000.0, "Damping of the mast there").range(0.0, 1e6),
            parameter("bolster_inertia", "kg.m2", real!(bolster_inertia), 2.0, "Inertia of the bolster with its wheels about its pivot").range(0.01, 1e4),
            parameter("bolster_damping", "N.m.s/rad", real!(bolster_damping), 100.0, "Damping of the bolster's pivot").range(0.0, 1e6),
            parameter("roof_z", "m", real!(roof), 2.1, "Height of the sensor on the roof over the road").range(0.0, 10.0).purpose(Purpose::Data),
            parameter("seat_x", "m", real!(seat[0]), -0.7, "Sensor beside the seat, before the front axle").range(-10.0, 10.0).purpose(Purpose::Data),
            parameter("seat_y", "m", real!(seat[1]), 0.3, "Sensor beside the seat, to the left of the middle").range(-5.0, 5.0).purpose(Purpose::Data),
        ])
    }

    /// # Errors
    /// The truck tips over.
    pub fn check(&self) -> Result<()> {
        self.loads(1.0).map(|_| ())
    }

    /// What moves with the carriage \[kg\].
    pub fn carriage_mass(&self) -> f64 {
        self.carriage_mass + self.payload
    }

    pub fn cabin_mass(&self) -> f64 {
        self.cabin_mass
    }

    /// All that travels \[kg\].
    pub fn total_mass(&self) -> f64 {
        self.chassis_mass + self.cabin_mass + self.carriage_mass()
    }

    /// Load on a wheel at rest, in front and behind \[N\].
    ///
    /// # Errors
    /// The truck tips over.
    pub fn loads(&self, gravity: f64) -> Result<[f64; 2]> {
        let about_front = self.chassis_mass * self.chassis[0]
            + self.cabin_mass * self.cabin[0]
            + self.carriage_mass() * self.carriage;
        let rear = -about_front / self.wheelbase;
        let front = self.total_mass() - rear;
        if rear <= 0.0 || front <= 0.0 {
            let side = if rear <= 0.0 {
                "forward: payload times carriage_x is too much for the counterweight"
            } else {
                "backward"
            };
            return Err(Error::variable(format!(
                "the truck tips over {side}; the axles carry {front:.0} kg in front and {rear:.0} kg behind"
            )));
        }
        Ok([0.5 * front * gravity, 0.5 * rear * gravity])
    }

    /// Where things are on the chassis, from its centre of mass.
    pub fn places(&self) -> Places {
        let wheel = |x: f64, y: f64| Point { x: x - self.chassis[0], y };
        let [front, rear] = self.tracks.map(|track| 0.5 * track);
        Places {
            front_axle: -self.chassis[0],
            wheels: [
                wheel(0.0, front),
                wheel(0.0, -front),
                wheel(-self.wheelbase, rear),
                wheel(-self.wheelbase, -rear),
            ],
            bolster: wheel(-self.wheelbase, 0.0),
        }
    }

    /// Mass that a wheel moves if it alone pushes the chassis, in front and behind \[kg\]: 1 / (1/m + x²/Iy + y²/Ix).
    pub fn moved_mass(&self, axle: usize) -> f64 {
        let Point { x, y } = self.places().wheels[2 * axle];
        let [pitch, roll] = self.chassis_inertia;
        // behind, the wheel turns the bolster, not the chassis
        let about = if axle == 0 { y * y / roll } else { y * y / self.bolster_inertia };
        1.0 / (1.0 / self.chassis_mass + x * x / pitch + about)
    }

    /// All mounts together, with the mass of the chassis at the other end.
    pub fn mounts(&self) -> Link {
        Link {
            stiffness: ("mount_stiffness of all mounts", 4.0 * self.mount.stiffness),
            damping: ("mount_damping of all mounts", 4.0 * self.mount.damping),
            mass: ("chassis_mass", self.chassis_mass),
        }
    }

    /// Chain and stop together.
    pub fn chain_link(&self) -> Link {
        let stiffness =
            ("chain_stiffness and mast_stop_stiffness", self.chain.stiffness + self.stop.stiffness);
        let damping = ("chain_damping and mast_stop_damping", self.chain.damping + self.stop.damping);
        let Point { x, .. } = self.fork();
        let mass = 1.0 / (1.0 / self.chassis_mass + x * x / self.chassis_inertia[0]);
        Link { stiffness, damping, mass: ("chassis_mass at the mast", mass) }
    }

    /// The carriage, from the chassis' centre of mass.
    pub fn fork(&self) -> Point {
        Point { x: self.carriage - self.chassis[0], y: 0.0 }
    }

    /// The four mounts: from the chassis' centre of mass, and from the cabin's.
    pub fn mounts_at(&self) -> [(Point, Point); 4] {
        let [along, across] = self.mount_places;
        [(1.0, 1.0), (1.0, -1.0), (-1.0, 1.0), (-1.0, -1.0)].map(|(a, b)| {
            let on_cabin = Point { x: a * along, y: b * across };
            (Point { x: on_cabin.x + self.cabin[0] - self.chassis[0], y: on_cabin.y }, on_cabin)
        })
    }

    /// Of the roof's sensor over the cabin's centre of mass \[m\].
    pub fn roof_over_cabin(&self) -> f64 {
        self.roof - self.cabin[1]
    }

    /// The seat's sensor from the cabin's centre of mass.
    pub fn seat(&self) -> Point {
        Point { x: self.seat[0] - self.cabin[0], y: self.seat[1] }
    }
}
