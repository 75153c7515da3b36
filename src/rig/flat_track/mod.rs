//! `ring-brush-flat-track`: the ring-and-brush tire on a flat-track rig (4.36), (4.37).
//!
//! The rig imposes the rim's motion and measures force and moment on the rim in H axes: x horizontal
//! in the wheel's heading, y horizontal to the left, z up, origin in the wheel's centre. The road is
//! an unbounded plane over which the wheel travels. All signs at this interface are those of
//! ISO 8855; the source's slip angle (DIN 70000) has the opposite sign and is converted here, once.

mod derivatives;

use self::derivatives::Changes;
use super::table::{tire_table, with_road};
use super::{Actuation, Actuator, Command, MountedTire, OnRoad};
use crate::model::{Model, Variable, input};
use crate::road::{Road, RoadParameters};
use crate::solver::{Dual, Real};
use crate::tire::Motion;
use crate::tire::ring_brush::{Parameters, State, Stationary, Tire};
use crate::{Result, clone_in_place};
use nalgebra::Vector3;
use serde::{Deserialize, Serialize};
use std::f64::consts::{FRAC_PI_2, PI};

/// The model: parameters, commands, actuators, tire and what the rig measures.
#[derive(Debug, PartialEq, Default, Serialize, Deserialize)]
pub struct RingBrushFlatTrack {
    /// The tire on its rim.
    tire: MountedTire,
    step_size: f64,
    actuation: Actuation,
    commands: Drive<Command>,
    actuators: Drive<Actuator>,
    path: f64,
    /// Where the rim is over the road \[m\].
    place: [f64; 2],
    road_parameters: RoadParameters,
    road: Road,
    friction_factor: f64,
}

/// The six things that the rig drives.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
struct Drive<T> {
    steer: T,
    deflection: T,
    path_speed: T,
    camber: T,
    slip: T,
    slip_angle: T,
}

clone_in_place!(RingBrushFlatTrack {
    tire,
    step_size,
    actuation,
    commands,
    actuators,
    path,
    place,
    road_parameters,
    road,
    friction_factor,
});

/// Access to a command and its rate.
macro_rules! command {
    ($field:ident) => {
        Access::Rated(
            |m: &Self| m.commands.$field.value,
            |m: &mut Self, value, rate| m.commands.$field = Command { value, rate },
        )
    };
}

impl Model for RingBrushFlatTrack {
    const NAME: &'static str = "ring-brush-flat-track";
    const DESCRIPTION: &'static str = "Ring-and-brush tire on a flat-track rig: commands of the rig in, force and moment on the rim in H axes out (ISO 8855 signs)";
    const STOP_TIME: f64 = 5.0;
    const DIRECTIONAL_DERIVATIVES: bool = true;
    const DOCUMENTATION: &'static str = concat!(
        include_str!("documentation.html"),
        include_str!("../actuator.html"),
        include_str!("../../tire/ring_brush/documentation.html"),
        include_str!("../../road/documentation.html")
    );
    const VARIABLES: &'static [Variable<Self>] = with_road! { tire_table! {
        inputs: [
            input("steer", "rad", command!(steer), 0.0, "Steer angle of the wheel about z; it turns wheel and path together, so it makes no slip angle").range(-2.0 * PI, 2.0 * PI),
            input("deflection", "m", command!(deflection), 0.02, "Unloaded radius minus height of the wheel centre; negative lifts the tire off").range(-0.2, 0.1),
            input("path_speed", "m/s", command!(path_speed), 10.0, "Speed of the wheel over the road along its path; negative: in reverse").range(-100.0, 100.0),
            input("camber", "rad", command!(camber), 0.0, "Inclination angle; positive leans the top of the wheel to -y").range(-0.6, 0.6),
            input("slip", "1", command!(slip), 0.0, "Longitudinal slip, (rolling radius times spin speed - v) / |v| with the speed v in the wheel's heading: positive makes a positive force_x; a locked wheel is -1 forward, +1 in reverse").range(-100.0, 100.0),
            input("slip_angle", "rad", command!(slip_angle), 0.0, "Slip angle of ISO 8855, atan2(v_y, |v_x|) in the wheel's heading: positive when the wheel travels to its left (+y), forward or in reverse, which gives a negative force_y").range(-FRAC_PI_2, FRAC_PI_2),
        ],
        outputs: [
            output("wheel_angle", "rad", real!(tire.rim.angles.y), "Spin angle of the rim"),
        ],
        locals: [
            local("wheel_speed", "rad/s", real!(tire.rim.rates.y), "Spin speed of the rim"),
            local("path_distance", "m", real!(path), "Distance that the wheel centre has travelled"),
            local("actual_steer", "rad", real!(actuators.steer.position), "Steer angle behind the actuator"),
            local("actual_deflection", "m", real!(actuators.deflection.position), "Deflection behind the actuator"),
            local("actual_path_speed", "m/s", real!(actuators.path_speed.position), "Path speed behind the actuator"),
            local("actual_camber", "rad", real!(actuators.camber.position), "Camber behind the actuator"),
            local("actual_slip", "1", real!(actuators.slip.position), "Slip behind the actuator"),
            local("actual_slip_angle", "rad", real!(actuators.slip_angle.position), "Slip angle behind the actuator"),
        ],
        parameters: [
            parameter("actuator_frequency", "rad/s", real!(actuation.frequency), 200.0, "Corner of the critically damped filter between commands and motion; its delay is 2 over this").range(1.0, 1e5).tunable(),
            parameter("step_size", "s", real!(step_size), 1e-4, "Step of the model's own time grid").range(1e-7, 5e-4),
            input("friction_factor", "1", real!(friction_factor), 1.0, "Factor on the friction between tire and road, over the road's own").range(0.0, 10.0),
        ],
        appended: [
            boolean_parameter("command_actuators", boolean!(actuation.on), true, "Actuators between commands and motion: true, whether commands come with derivatives or not; false, the commands are the motion, as in a recording of what the rig did"),
        ],
    }};

    fn step_size(&self) -> f64 {
        self.step_size
    }

    fn step_work(&self) -> f64 {
        self.tire.step_work()
    }

    fn initialize(&mut self) -> Result<()> {
        self.tire.mount()?;
        self.road = Road::new(&self.road_parameters)?;
        let commands = &self.commands;
        self.actuators = Drive {
            steer: Actuator::at_rest(&commands.steer),
            deflection: Actuator::at_rest(&commands.deflection),
            path_speed: Actuator::at_rest(&commands.path_speed),
            camber: Actuator::at_rest(&commands.camber),
            slip: Actuator::at_rest(&commands.slip),
            slip_angle: Actuator::at_rest(&commands.slip_angle),
        };
        self.path = 0.0;
        self.place = [0.0; 2];
        let rim = self.rim_motion(0.0);
        self.tire.start(&rim, &OnRoad::at(&self.road, self.place, self.friction_factor))?;
        Ok(())
    }

    fn directional_derivatives(
        &self,
        starting: bool,
        direction: &[(usize, f64)],
        unknowns: &[usize],
    ) -> Result<Vec<Option<f64>>> {
        let mut position = self.actuators.map(|a| Dual::<1>::from(a.position));
        let mut friction = Dual::<1>::from(self.friction_factor);
        for (index, share) in direction {
            let name = Self::VARIABLES[*index].name();
            // between steps the actuators, where they are on, stand between commands and rim
            if let Some(drive) = position.named(name).filter(|_| starting || !self.actuation.on) {
                drive.gradient[0] += share;
            }
            if name == "friction_factor" {
                friction.gradient[0] += share;
            }
        }
        let velocity = self.actuators.map(|a| Dual::<1>::from(a.velocity));
        let rim = imposed(&self.tire.parameters, &position, &velocity, self.tire.rim.angles.y);
        let changes = if starting {
            match Changes::stationary(self, &rim, friction) {
                Ok(changes) => changes,
                // on a slope, or where the stationary state is none
                Err(_) => return Ok(vec![None; unknowns.len()]),
            }
        } else {
            Changes::side_wall(self, &rim, friction)
        };
        unknowns.iter().map(|index| changes.of(Self::VARIABLES[*index].name())).collect()
    }

    fn tune(&mut self) -> Result<()> {
        self.tire.tune()
    }

    fn check(&self) -> Result<()> {
        self.tire.check()?;
        self.road.check()
    }

    fn warning(&self) -> Option<String> {
        self.tire.warning()
    }

    fn step(&mut self, length: f64) -> Result<()> {
        let (commands, corner) = (&self.commands, self.actuation.corner());
        let actuators = &mut self.actuators;
        actuators.steer.follow(&commands.steer, corner, length);
        actuators.deflection.follow(&commands.deflection, corner, length);
        actuators.path_speed.follow(&commands.path_speed, corner, length);
        actuators.camber.follow(&commands.camber, corner, length);
        actuators.slip.follow(&commands.slip, corner, length);
        actuators.slip_angle.follow(&commands.slip_angle, corner, length);

        let before = self.tire.rim;
        let mut rim = self.rim_motion(before.angles.y);
        rim.angles.y += 0.5 * length * (before.rates.y + rim.rates.y);
        self.path += length * self.actuators.path_speed.position.abs();
        let from = self.place;
        self.place[0] += 0.5 * length * (before.velocity.x + rim.velocity.x);
        self.place[1] += 0.5 * length * (before.velocity.y + rim.velocity.y);
        let ground = OnRoad { road: &self.road, from, to: self.place, friction: self.friction_factor };
        self.tire.step(&rim, &ground, length)?;
        Ok(())
    }
}

impl<T> Drive<T> {
    fn map<U>(&self, f: impl Fn(&T) -> U) -> Drive<U> {
        Drive {
            steer: f(&self.steer),
            deflection: f(&self.deflection),
            path_speed: f(&self.path_speed),
            camber: f(&self.camber),
            slip: f(&self.slip),
            slip_angle: f(&self.slip_angle),
        }
    }

    /// The drive that is called like an input.
    fn named(&mut self, name: &str) -> Option<&mut T> {
        match name {
            "steer" => Some(&mut self.steer),
            "deflection" => Some(&mut self.deflection),
            "path_speed" => Some(&mut self.path_speed),
            "camber" => Some(&mut self.camber),
            "slip" => Some(&mut self.slip),
            "slip_angle" => Some(&mut self.slip_angle),
            _ => None,
        }
    }
}

/// The rim's motion for positions and velocities of the drives.
///
/// (4.36) with the slip angle of ISO 8855, which has the opposite sign of the source's, and with slip and
/// slip angle as all rigs have them (see [`hub::slip`](super::hub::slip) and
/// [`slip_angle`](super::hub::slip_angle)); the source has forward travel only.
fn imposed<T: Real>(p: &Parameters, position: &Drive<T>, velocity: &Drive<T>, spin_angle: f64) -> Motion<T> {
    let (sin, cos) = position.slip_angle.sin_cos();
    let (along, aside) = (position.path_speed * cos, position.path_speed.abs() * sin);
    let (sin, cos) = position.steer.sin_cos();
    let zero = T::zero();
    Motion {
        position: Vector3::new(zero, zero, -position.deflection + p.radius),
        velocity: Vector3::new(along * cos - aside * sin, along * sin + aside * cos, -velocity.deflection),
        angles: Vector3::new(position.camber, T::from(spin_angle), position.steer),
        rates: Vector3::new(
            velocity.camber,
            (along + position.slip * along.abs()) / p.rolling_radius,
            velocity.steer,
        ),
    }
}

impl RingBrushFlatTrack {
    /// The rim's motion that the actuators impose, at a spin angle.
    fn rim_motion(&self, spin_angle: f64) -> Motion<f64> {
        imposed(
            &self.tire.parameters,
            &self.actuators.map(|a| a.position),
            &self.actuators.map(|a| a.velocity),
            spin_angle,
        )
    }

    /// The tire on its rim.
    pub fn mounted(&self) -> &MountedTire {
        &self.tire
    }

    /// The tire.
    pub fn tire(&self) -> &Tire {
        &self.tire.tire
    }

    /// The tire's state.
    pub fn state(&self) -> &State {
        &self.tire.state
    }

    /// The stationary state for the present commands with, instead of the commanded deflection, a
    /// vertical force \[N\] on the rim.
    ///
    /// # Errors
    /// None was found.
    pub fn stationary_at_load(&self, load: f64) -> Result<Stationary> {
        self.tire.stationary_at_load(&self.tire.rim, load, self.friction_factor)
    }
}
