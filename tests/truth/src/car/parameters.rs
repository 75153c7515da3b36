//! What a car of this study is like: what may differ between cases, and between a car and what is believed of it.
//!
//! Names are those of the wired system. All values are placeholders of a sports car.

use super::brake::Pads;
use super::tire::Tire;
use super::world::WHEELS;
use crate::random::Random;

/// Acceleration of free fall \[m/s²\].
pub(crate) const GRAVITY: f64 = 9.81;
/// Density of the air \[kg/m³\]; areas of drag and of the lift over both axles \[m²\].
pub(crate) const AIR: f64 = 1.2;
pub(crate) const DRAG: f64 = 0.6;
pub(crate) const LIFT: [f64; 2] = [0.05, 0.02];
/// Inertias of the body about its own axes \[kg.m²\].
pub(crate) const BODY_INERTIA: [f64; 3] = [450.0, 1900.0, 2000.0];
/// From the front axle to the rear one \[m\].
pub(crate) const WHEELBASE: f64 = 2.35;
/// Half of the distance of the wheels' centres \[m\].
pub(crate) const HALF_TRACK: f64 = 0.745;
/// Camber, positive outward at the top, and toe, positive inward in front, of all wheels where the car stands.
pub(crate) const CAMBER: f64 = -0.0087;
pub(crate) const TOE: f64 = 0.0014;
/// Mass of a carrier \[kg\].
pub(crate) const CARRIER_MASS: f64 = 20.0;
/// Inertia of a rear carrier about any axis \[kg.m²\].
pub(crate) const REAR_CARRIER_INERTIA: f64 = 0.4;

/// Values of a car with brakes and controller, in SI units.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Parameters {
    pub(crate) vehicle_mass: f64,
    pub(crate) centre_of_mass_x: f64,
    pub(crate) centre_of_mass_z: f64,
    pub(crate) front_wheel_mass: f64,
    pub(crate) front_wheel_inertia: f64,
    pub(crate) front_wheel_transverse_inertia: f64,
    /// Of a front carrier about any axis.
    pub(crate) front_carrier_inertia: f64,
    pub(crate) front_spring_stiffness: f64,
    /// Slope of the damper's curve \[N.s/m\].
    pub(crate) front_damping: f64,
    pub(crate) rear_spring_stiffness: f64,
    pub(crate) rear_damping: f64,
    pub(crate) front_scrub_radius: f64,
    pub(crate) front_anti_dive: f64,
    pub(crate) column_stiffness: f64,
    pub(crate) column_damping: f64,
    pub(crate) rack_friction: f64,
    pub(crate) coupling_damping: f64,
    /// Of all tires: PCX1, LMUX and LMUY.
    pub(crate) tire: Tire,
    /// Factor on the friction of the road.
    pub(crate) road_friction: f64,
    /// Front and rear.
    pub(crate) brakes: [Pads; 2],
    /// What the controller takes for the radii of the tires, front and rear.
    pub(crate) rolling_radius: [f64; 2],
    /// What the sensor in the master cylinder shows over what is there; nobody believes anything but 1.
    pub(crate) master_gain: f64,
}

impl Default for Parameters {
    /// The placeholders of the models, with the rear pistons and the radii of the example.
    fn default() -> Self {
        let front = Pads {
            piston_area: 43e-4,
            friction_radius: 0.14,
            friction: 0.4,
            onset_share: 0.25,
            onset_time: 0.22,
            lag: 6e-3,
        };
        Self {
            vehicle_mass: 1650.0,
            centre_of_mass_x: 1.44,
            centre_of_mass_z: 0.48,
            front_wheel_mass: 20.0,
            front_wheel_inertia: 0.9,
            front_wheel_transverse_inertia: 0.5,
            front_carrier_inertia: 0.4,
            front_spring_stiffness: 38e3,
            front_damping: 2600.0,
            rear_spring_stiffness: 52e3,
            rear_damping: 3200.0,
            front_scrub_radius: -0.015,
            front_anti_dive: 0.1,
            column_stiffness: 6e5,
            column_damping: 2300.0,
            rack_friction: 0.0,
            coupling_damping: 0.0,
            tire: Tire { shape: 1.6, friction: [1.0; 2] },
            road_friction: 1.0,
            brakes: [front, Pads { piston_area: 30e-4, ..front }],
            rolling_radius: [0.33; 2],
            master_gain: 1.0,
        }
    }
}

/// A number with four digits, as files and people have them.
pub(crate) fn rounded(value: f64) -> f64 {
    format!("{value:.3e}").parse().unwrap_or(value)
}

impl Parameters {
    /// A car of its own.
    pub(crate) fn draw(random: &mut Random) -> Self {
        let mut p = Self::default();
        let mut off = |place: &mut f64, share: f64| *place *= 1.0 + random.within(-share, share);
        off(&mut p.vehicle_mass, 0.05);
        off(&mut p.centre_of_mass_x, 0.02);
        off(&mut p.centre_of_mass_z, 0.05);
        off(&mut p.front_wheel_mass, 0.1);
        off(&mut p.front_wheel_inertia, 0.1);
        off(&mut p.front_wheel_transverse_inertia, 0.1);
        off(&mut p.front_carrier_inertia, 0.1);
        off(&mut p.front_spring_stiffness, 0.1);
        off(&mut p.front_damping, 0.15);
        off(&mut p.rear_spring_stiffness, 0.1);
        off(&mut p.rear_damping, 0.15);
        off(&mut p.front_scrub_radius, 0.2);
        off(&mut p.front_anti_dive, 0.3);
        off(&mut p.column_stiffness, 0.15);
        off(&mut p.column_damping, 0.1);
        off(&mut p.tire.shape, 0.03);
        off(&mut p.tire.friction[0], 0.06);
        off(&mut p.tire.friction[1], 0.06);
        off(&mut p.brakes[0].friction, 0.05);
        off(&mut p.brakes[0].onset_share, 0.2);
        off(&mut p.brakes[0].onset_time, 0.25);
        off(&mut p.brakes[0].lag, 0.2);
        p.brakes[1] = Pads { piston_area: p.brakes[1].piston_area, ..p.brakes[0] };
        p.rounded()
    }

    /// With four digits each.
    pub(crate) fn rounded(mut self) -> Self {
        for value in self.places() {
            *value = rounded(*value);
        }
        self
    }

    fn places(&mut self) -> Vec<&mut f64> {
        let mut all = vec![
            &mut self.vehicle_mass,
            &mut self.centre_of_mass_x,
            &mut self.centre_of_mass_z,
            &mut self.front_wheel_mass,
            &mut self.front_wheel_inertia,
            &mut self.front_wheel_transverse_inertia,
            &mut self.front_carrier_inertia,
            &mut self.front_spring_stiffness,
            &mut self.front_damping,
            &mut self.rear_spring_stiffness,
            &mut self.rear_damping,
            &mut self.front_scrub_radius,
            &mut self.front_anti_dive,
            &mut self.column_stiffness,
            &mut self.column_damping,
            &mut self.coupling_damping,
            &mut self.tire.shape,
            &mut self.road_friction,
            &mut self.master_gain,
        ];
        all.extend(&mut self.tire.friction);
        all.extend(&mut self.rolling_radius);
        for pads in &mut self.brakes {
            all.extend([
                &mut pads.piston_area,
                &mut pads.friction_radius,
                &mut pads.friction,
                &mut pads.onset_share,
                &mut pads.onset_time,
                &mut pads.lag,
            ]);
        }
        all
    }

    /// Names in the wired system with their values. Both axles' tires, and the brakes of an axle, have the same.
    pub(crate) fn named(&self) -> Vec<(String, f64)> {
        let mut all: Vec<(String, f64)> = [
            ("vehicle_mass", self.vehicle_mass),
            ("centre_of_mass_x", self.centre_of_mass_x),
            ("centre_of_mass_z", self.centre_of_mass_z),
            ("front_wheel_mass", self.front_wheel_mass),
            ("front_wheel_inertia", self.front_wheel_inertia),
            ("front_wheel_transverse_inertia", self.front_wheel_transverse_inertia),
            ("front_carrier_inertia", self.front_carrier_inertia),
            ("front_spring_stiffness", self.front_spring_stiffness),
            ("rear_spring_stiffness", self.rear_spring_stiffness),
            ("front_scrub_radius", self.front_scrub_radius),
            ("front_anti_dive", self.front_anti_dive),
            ("column_stiffness", self.column_stiffness),
            ("column_damping", self.column_damping),
            ("coupling_damping", self.coupling_damping),
        ]
        .into_iter()
        .map(|(name, value)| (format!("car.{name}"), value))
        .collect();
        for tire in ["front_tire", "rear_tire"] {
            all.push((format!("car.{tire}.PCX1"), self.tire.shape));
            all.push((format!("car.{tire}.LMUX"), self.tire.friction[0]));
            all.push((format!("car.{tire}.LMUY"), self.tire.friction[1]));
        }
        for k in 0..4 {
            all.push((format!("abs.rolling_radius_{}", k + 1), self.rolling_radius[k / 2]));
        }
        for (k, (_, wheel)) in WHEELS.iter().enumerate() {
            let pads = &self.brakes[k / 2];
            let values = [
                ("piston_area", pads.piston_area),
                ("friction_radius", pads.friction_radius),
                ("friction", pads.friction),
                ("onset_friction_share", pads.onset_share),
                ("onset_time", pads.onset_time),
                ("caliper_lag", pads.lag),
            ];
            all.extend(values.map(|(name, value)| (format!("brake_{wheel}.{name}"), value)));
        }
        all
    }

    /// The curves of the dampers, as the models have them.
    pub(crate) fn dampers(&self) -> [(&'static str, String); 2] {
        let curve = |slope: f64| format!("-2 {:?}; 2 {:?}", -2.0 * slope, 2.0 * slope);
        [("front_damper", curve(self.front_damping)), ("rear_damper", curve(self.rear_damping))]
    }
}
