//! A tire on a flat-track rig: `ring-brush-flat-track`, (4.36), (4.37).
//!
//! The rig imposes the rim's motion and measures force and moment on the rim in H axes: x horizontal
//! in the wheel's heading, y horizontal to the left, z up, origin in the wheel's centre. The road is
//! an unbounded plane over which the wheel travels. All signs at this interface are those of
//! ISO 8855; the source's slip angle (DIN 70000) has the opposite sign and is converted here, once.

use super::load_control::{DEFLECTIONS, LoadControl};
use super::{Actuation, Actuator, Command, Rolling};
use crate::mechanics::check_steps_of_led_rim;
use crate::model::{Model, Purpose, Role, Table, input, join, local, output, parameter};
use crate::road;
use crate::solver::{Dual, Real};
use crate::tire::{Change, Motion, Mounted, Tire, to_heading};
use crate::{Error, Result, clone_in_place, lens, rated, real};
use nalgebra::Vector3;
use serde::{Deserialize, Serialize};
use std::f64::consts::{FRAC_PI_2, PI};

/// A tire whose rolling radius depends on the deflection is put on the road so often at most, until both fit.
const MAX_ROLLING_RADII: usize = 10;
/// They fit if the spin rates of two of these differ by less than this share.
const SAME_RATE: f64 = 1e-12;

/// The model: parameters, commands, actuators, tire and what the rig measures.
#[derive(Debug, PartialEq, Default, Serialize, Deserialize)]
pub struct FlatTrack<T> {
    /// The tire on its rim.
    tire: Rolling<T>,
    step_size: f64,
    actuation: Actuation,
    load_control: LoadControl,
    commands: Drive<Command>,
    actuators: Drive<Actuator>,
    path: f64,
    /// Where the rim is over the road \[m\].
    place: [f64; 2],
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

clone_in_place!(FlatTrack<T> {
    tire,
    step_size,
    actuation,
    load_control,
    commands,
    actuators,
    path,
    place,
});

impl<T: Tire> Model for FlatTrack<T> {
    const NAME: &'static str = const { &join::<48>(&[T::NAME, "-flat-track"]) }.as_str();
    const DESCRIPTION: &'static str = const {
        &join::<256>(&[
            T::TITLE,
            " on a flat-track rig: commands of the rig in, force and moment on the rim in H axes out (ISO 8855 signs)",
        ])
    }
    .as_str();
    const STOP_TIME: f64 = 5.0;
    const DIRECTIONAL_DERIVATIVES: bool = T::DERIVATIVES;
    const DOCUMENTATION: &'static [&'static str] = &[
        include_str!("flat_track.html"),
        include_str!("actuator.html"),
        T::DOCUMENTATION,
        road::DOCUMENTATION,
        T::ON_ROAD,
    ];

    #[rustfmt::skip] // a row is a line
    fn variables() -> Table<Self> {
        Table::new([
            input("steer", "rad", rated!(commands.steer), 0.0, "Steer angle of the wheel about z; it turns wheel and path together, so it makes no slip angle").range(-2.0 * PI, 2.0 * PI).role(Role::SteerAngle),
            input("deflection", "m", rated!(commands.deflection), 0.02, "Unloaded radius minus height of the wheel centre; negative lifts the tire off").range(DEFLECTIONS[0], DEFLECTIONS[1]),
            input("path_speed", "m/s", rated!(commands.path_speed), 10.0, "Speed of the wheel over the road along its path; negative: in reverse").range(-100.0, 100.0).role(Role::TravelSpeed),
            input("camber", "rad", rated!(commands.camber), 0.0, "Inclination angle; positive leans the top of the wheel to -y").range(-0.6, 0.6).role(Role::Camber),
            input("slip", "1", rated!(commands.slip), 0.0, "Longitudinal slip, (rolling radius times spin speed - v) / |v| with the speed v in the wheel's heading: positive makes a positive force_x; a locked wheel is -1 forward, +1 in reverse").range(-100.0, 100.0).role(Role::Slip),
            input("slip_angle", "rad", rated!(commands.slip_angle), 0.0, "Slip angle of ISO 8855, atan2(v_y, |v_x|) in the wheel's heading: positive when the wheel travels to its left (+y), forward or in reverse, which gives a negative force_y").range(-FRAC_PI_2, FRAC_PI_2).role(Role::SlipAngle),
        ])
        .part("", lens!(tire), Rolling::rows())
        .and([
            output("wheel_angle", "rad", real!(tire.mounted.rim.angles.y), "Spin angle of the rim").role(Role::WheelAngle),
            local("wheel_speed", "rad/s", real!(tire.mounted.rim.rates.y), "Spin speed of the rim").role(Role::WheelSpeed),
            local("path_distance", "m", real!(path), "Distance that the wheel centre has travelled").role(Role::TravelDistance),
            local("actual_steer", "rad", real!(actuators.steer.position), "Steer angle behind the actuator").role(Role::SteerAngle),
            local("actual_deflection", "m", real!(actuators.deflection.position), "Deflection behind the actuator"),
            local("actual_path_speed", "m/s", real!(actuators.path_speed.position), "Path speed behind the actuator").role(Role::TravelSpeed),
            local("actual_camber", "rad", real!(actuators.camber.position), "Camber behind the actuator").role(Role::Camber),
            local("actual_slip", "1", real!(actuators.slip.position), "Slip behind the actuator").role(Role::Slip),
            local("actual_slip_angle", "rad", real!(actuators.slip_angle.position), "Slip angle behind the actuator").role(Role::SlipAngle),
            local("wheel_centre_height", "m", real!(tire.mounted.rim.position.z), "Height of the wheel centre over the road"),
            parameter("step_size", "s", real!(step_size), T::STEP, "Step of the model's own time grid").range(1e-7, 1e-3).purpose(Purpose::Numerics).role(Role::Step),
        ])
        .part("", lens!(actuation), Actuation::rows())
        .part("", lens!(load_control), LoadControl::rows())
        .without_derivatives_if(T::RIPPLES)
    }

    fn step_size(&self) -> f64 {
        self.step_size
    }

    fn initialize(&mut self) -> Result<()> {
        self.tire.mount()?;
        check_steps_of_led_rim(self.step_size, self.tire.tire().links())?;
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
        if self.load_control.on {
            return self.start_at_load();
        }
        let rim = self.rim_motion(0.0);
        self.tire.start(&rim, self.place)
    }

    fn directional_derivatives(
        &self,
        starting: bool,
        direction: &[(&str, f64)],
        unknowns: &[&str],
    ) -> Result<Vec<Option<f64>>> {
        let mut position = self.actuators.map(|a| Dual::<1>::from(a.position));
        let mut friction = Dual::<1>::from(self.tire.friction_factor);
        let mut load = 0.0;
        for (name, share) in direction {
            match *name {
                "friction_factor" => friction.gradient[0] += share,
                "load" => load += share,
                "deflection" if self.load_control.on => {}
                // between steps the actuators, where they are on, stand between commands and rim
                name if starting || !self.actuation.on => {
                    if let Some(drive) = position.named(name) {
                        drive.gradient[0] += share;
                    }
                }
                _ => {}
            }
        }
        let alone = self.change(starting, &position, friction, unknowns)?;
        // between steps the load is nothing but what the controller goes for
        if !self.load_control.on || !starting {
            return Ok(alone);
        }
        // the deflection moves along so that the vertical force changes as the load does
        let mut deflected = self.actuators.map(|a| Dual::<1>::from(a.position));
        deflected.deflection.gradient[0] = 1.0;
        let still = Dual::from(self.tire.friction_factor);
        let force = |position: &_, friction| self.change(starting, position, friction, &["force_z"]);
        let ([Some(changed)], [Some(stiffness)]) =
            (&force(&position, friction)?[..], &force(&deflected, still)?[..])
        else {
            return Ok(vec![None; unknowns.len()]);
        };
        let follows = (load - changed) / stiffness;
        if !follows.is_finite() {
            return Err(Error::call(
                "there is no derivative at constant load where the tire is off the road",
            ));
        }
        let by_deflection = self.change(starting, &deflected, still, unknowns)?;
        Ok(alone.iter().zip(by_deflection).map(|(a, d)| Some((*a)? + follows * d?)).collect())
    }

    fn tune(&mut self) -> Result<()> {
        check_steps_of_led_rim(self.step_size, self.tire.tire().links())?;
        self.tire.tune()
    }

    fn check(&self) -> Result<()> {
        self.tire.check()
    }

    fn warning(&self) -> Option<String> {
        self.tire.mounted.warning()
    }

    fn step(&mut self, length: f64) -> Result<()> {
        let (commands, corner) = (&self.commands, self.actuation.corner());
        let actuators = &mut self.actuators;
        actuators.steer.follow(&commands.steer, corner, length);
        let deflection = match self.load_control.on {
            true => self.load_control.follow(self.tire.mounted.force.z, length)?,
            false => commands.deflection,
        };
        actuators.deflection.follow(&deflection, corner, length);
        actuators.path_speed.follow(&commands.path_speed, corner, length);
        actuators.camber.follow(&commands.camber, corner, length);
        actuators.slip.follow(&commands.slip, corner, length);
        actuators.slip_angle.follow(&commands.slip_angle, corner, length);

        let before = self.tire.mounted.rim;
        let mut rim = self.rim_motion(before.angles.y);
        rim.angles.y += 0.5 * length * (before.rates.y + rim.rates.y);
        self.path += length * self.actuators.path_speed.position.abs();
        let from = self.place;
        self.place[0] += 0.5 * length * (before.velocity.x + rim.velocity.x);
        self.place[1] += 0.5 * length * (before.velocity.y + rim.velocity.y);
        self.tire.step(&rim, from, self.place, length)
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
fn imposed<R: Real>(
    tire: &impl Tire,
    position: &Drive<R>,
    velocity: &Drive<R>,
    spin_angle: f64,
) -> Motion<R> {
    let (sin, cos) = position.slip_angle.sin_cos();
    let (along, aside) = (position.path_speed * cos, position.path_speed.abs() * sin);
    let (sin, cos) = position.steer.sin_cos();
    let zero = R::zero();
    Motion {
        position: Vector3::new(zero, zero, -position.deflection + tire.radius()),
        velocity: Vector3::new(along * cos - aside * sin, along * sin + aside * cos, -velocity.deflection),
        angles: Vector3::new(position.camber, R::from(spin_angle), position.steer),
        rates: Vector3::new(
            velocity.camber,
            (along + position.slip * along.abs()) / tire.rolling_radius(position.deflection.value()),
            velocity.steer,
        ),
    }
}

/// The derivative of the output called `name`, if there is a formula for it, from that of the tire.
///
/// # Errors
/// It has none.
fn derivative(change: &Change, steer: Dual<1>, name: &str) -> Result<Option<f64>> {
    let along = |v: &Vector3<Dual<1>>| to_heading(steer, v).map(|x| x.gradient[0]);
    let (force, moment) = (along(&change.on_rim.force), along(&change.on_rim.moment));
    let (refused, why) = change.refused;
    if refused.contains(&name) {
        return Err(Error::call(format!("{name} has no derivative {why}")));
    }
    Ok(Some(match name {
        "force_x" => force.x,
        "force_y" => force.y,
        "force_z" => force.z,
        "moment_x" => moment.x,
        "moment_y" => moment.y,
        "moment_z" => moment.z,
        // it counts from the start
        "wheel_angle" => 0.0,
        _ => match change.outputs.iter().find(|(own, _)| *own == name) {
            Some((_, derivative)) => *derivative,
            None => return Ok(change.others),
        },
    }))
}

impl<T: Tire> FlatTrack<T> {
    /// The stationary state at the load that is held.
    fn start_at_load(&mut self) -> Result<()> {
        let mut rim = self.rim_motion(0.0);
        for _ in 0..MAX_ROLLING_RADII {
            self.tire.start_carrying(&rim, self.place, self.load_control.load)?;
            let deflection = self.tire().radius() - self.tire.mounted.rim.position.z;
            self.actuators.deflection = Actuator::at_rest(&self.load_control.rest(deflection)?);
            let again = self.rim_motion(0.0);
            if (again.rates.y - rim.rates.y).abs() <= SAME_RATE * rim.rates.y.abs() {
                return Ok(());
            }
            rim = again;
        }
        Err(Error::numeric(
            "load_control: no deflection was found whose rolling radius and load fit each other",
        ))
    }

    /// Derivatives of outputs along what drives and friction carry as theirs.
    fn change(
        &self,
        starting: bool,
        position: &Drive<Dual<1>>,
        friction: Dual<1>,
        unknowns: &[&str],
    ) -> Result<Vec<Option<f64>>> {
        let velocity = self.actuators.map(|a| Dual::<1>::from(a.velocity));
        let rim = imposed(self.tire.tire(), position, &velocity, self.tire.mounted.rim.angles.y);
        let change = if starting {
            // the road has its own factor besides the one that the master gives
            let friction = friction * self.tire.surface(self.place).friction;
            match self.tire.mounted.stationary_change(&self.tire.ground(self.place), &rim, friction) {
                Ok(change) => change,
                // on a slope, or where the stationary state is none
                Err(_) => return Ok(vec![None; unknowns.len()]),
            }
        } else {
            self.tire.tire().step_change(&rim, friction)?
        };
        unknowns.iter().map(|name| derivative(&change, rim.angles.z, name)).collect()
    }

    /// The rim's motion that the actuators impose, at a spin angle.
    fn rim_motion(&self, spin_angle: f64) -> Motion<f64> {
        imposed(
            self.tire.tire(),
            &self.actuators.map(|a| a.position),
            &self.actuators.map(|a| a.velocity),
            spin_angle,
        )
    }

    /// The tire on its rim.
    pub fn mounted(&self) -> &Mounted<T> {
        &self.tire.mounted
    }

    /// The tire.
    pub fn tire(&self) -> &T {
        self.tire.tire()
    }
}
