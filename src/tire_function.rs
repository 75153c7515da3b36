//! A tire as a function that a host calls: motion of the wheel carrier in, force and moment out. Made of a property file and a road file.
//!
//! After the tire function of S. Y. Oh (2017), 5.2.3, whose host calls it as often as its integrator likes, also for steps that it then
//! throws away, and does not say which ones count. Here an evaluation changes nothing: it steps a copy of the last state that was
//! [committed](TireFunction::commit) from there to the time asked for. The same committed states and the same motion give the same
//! bits.

use crate::mechanics::{Motion, rotation_z};
use crate::model::{Native, Settings};
use crate::rig::{OnRoad, Wheel};
use crate::road::Road;
use crate::road_file::{self, Lanes};
use crate::tir::{self, Kind};
use crate::tire::magic_formula::MagicFormula;
use crate::tire::super_elastic::SuperElastic;
use crate::tire::{Mounted, Tire};
use crate::{Error, Result};
use nalgebra::{Matrix3, Vector3};
use std::collections::VecDeque;
use std::f64::consts::TAU;
use std::path::Path;

/// Committed states that a host can go back to: the stages of a step that it repeats, and some steps.
const KEPT: usize = 64;
/// Times that differ by less than this share of a step are the same.
const SAME_TIME: f64 = 1e-6;
/// Steps of the tire's own in one evaluation: a minute of the super-elastic tire.
const MOST_STEPS: f64 = 60_000.0;
/// How far a rotation matrix may be from one.
const ROTATION: f64 = 1e-6;
/// Camber up to which a wheel carrier has a steer angle \[rad\].
const MAX_CAMBER: f64 = 1.5;

/// How the wheel carrier moves. The road's axes: x forward, y to the left, z up.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Posture {
    /// Time \[s\].
    pub time: f64,
    /// The wheel's centre \[m\].
    pub place: Vector3<f64>,
    /// From the carrier's axes to the road's; y of the carrier is the wheel's axis, to the left.
    pub carrier: Matrix3<f64>,
    /// Velocity of the wheel's centre in the carrier's axes \[m/s\].
    pub velocity: Vector3<f64>,
    /// Angular velocity of the carrier in its axes \[rad/s\].
    pub turning: Vector3<f64>,
    /// Angle by which the wheel has turned against the carrier, positive forward \[rad\].
    pub wheel_angle: f64,
    /// Its rate \[rad/s\].
    pub wheel_speed: f64,
}

/// What the tire puts on the wheel carrier, in the road's axes: without what masses take that ride on the rim, which the host's wheel has
/// to carry, with their weight.
#[derive(Debug, Clone, PartialEq)]
pub struct Answer {
    /// Force \[N\].
    pub force: Vector3<f64>,
    /// Moment about the wheel's centre \[N.m\].
    pub moment: Vector3<f64>,
    /// What the host's wheel has to be heavier by \[kg\], without weight of its own: that is in the force.
    pub carried_mass: f64,
    /// What it has to have more of inertia about its axis \[kg.m²\].
    pub carried_inertia: f64,
    /// What the host should know of the start.
    pub warning: Option<String>,
    /// Force and moment in H axes: x in the wheel's heading, z up.
    pub in_heading: [Vector3<f64>; 2],
    /// How much lower the wheel's centre is over the road than the tire's radius without load \[m\].
    pub deflection: f64,
    /// Energy lost in the contact since the start \[J\].
    pub energy_loss: f64,
}

impl Posture {
    /// The motion of a rim over its place.
    fn motion(&self) -> Result<Motion<f64>> {
        let finite = self.place.iter().chain(&self.velocity).chain(&self.turning).chain(self.carrier.iter());
        let single = [self.time, self.wheel_angle, self.wheel_speed];
        if !finite.chain(&single).all(|x| x.is_finite()) {
            return Err(Error::call("the motion of the wheel carrier has a value that is not finite"));
        }
        let is_rotation = (self.carrier.transpose() * self.carrier - Matrix3::identity()).abs().max()
            < ROTATION
            && self.carrier.determinant() > 0.0;
        if !is_rotation {
            return Err(Error::call(
                "the transformation from the wheel carrier's axes to the road's is no rotation",
            ));
        }
        let axis = self.carrier.column(1).into_owned();
        let camber = axis.z.clamp(-1.0, 1.0).asin();
        if camber.abs() > MAX_CAMBER {
            return Err(Error::numeric("the wheel lies on its side and has no heading"));
        }
        let steer = (-axis.x).atan2(axis.y);
        let heading = Vector3::new(steer.cos(), steer.sin(), 0.0);
        let aside = Vector3::new(-steer.sin(), steer.cos(), 0.0);
        let pitch = {
            let forward = self.carrier.column(0).into_owned();
            (-forward.dot(&heading.cross(&axis))).atan2(forward.dot(&heading))
        };
        // about z, the heading and the wheel's axis
        let turning = self.carrier * self.turning;
        let pitching = turning.dot(&aside) / camber.cos();
        Ok(Motion {
            position: Vector3::new(0.0, 0.0, self.place.z),
            velocity: self.carrier * self.velocity,
            angles: Vector3::new(camber, self.wheel_angle + pitch, steer),
            rates: Vector3::new(
                turning.dot(&heading),
                self.wheel_speed + pitching,
                turning.z - pitching * camber.sin(),
            ),
        })
    }
}

/// A tire that a host calls.
pub trait TireFunction: Send {
    /// Force and moment for a motion at a time: that of the start, of a committed state, or behind one. It is kept as a trial and
    /// changes nothing that is committed. What was tried before at an earlier time is committed first, unless the host
    /// [commits](Self::commit) itself.
    ///
    /// # Errors
    /// A motion that is none or outside of the tire's validity, a time before all that is kept.
    fn evaluate(&mut self, posture: &Posture) -> Result<Answer>;

    /// The step that ended with a motion has succeeded. From now on nothing is committed but by this.
    ///
    /// # Errors
    /// As [`evaluate`](Self::evaluate).
    fn commit(&mut self, posture: &Posture) -> Result<()>;
}

/// The tire of a property file on the road of a road file, or on a level one, and what the user should know of how they were read.
///
/// # Errors
/// A file that cannot be used.
pub fn open(property: &Path, road: Option<&Path>) -> Result<(Box<dyn TireFunction>, Vec<String>)> {
    let file = tir::settings(property)?;
    let (mut settings, mut notes) = (file.settings, file.notes);
    if let Some(road) = road {
        let profile = road_file::read(road, &Lanes { left: None, right: None })?;
        settings.values.extend(profile.settings()?.values);
        notes.extend(profile.left_out().map(|left_out| format!("{}: not used: {left_out}", road.display())));
        notes.extend(profile.notes);
    }
    let function: Box<dyn TireFunction> = match file.kind {
        Kind::SuperElastic => Box::new(Function::<SuperElastic>::new(&settings)?),
        Kind::MagicFormula => Box::new(Function::<MagicFormula>::new(&settings)?),
    };
    Ok((function, notes))
}

/// The tire at a time.
struct State<T> {
    time: f64,
    place: Vector3<f64>,
    mounted: Mounted<T>,
}

struct Function<T> {
    /// As its parameters make it, before any start.
    tire: Mounted<T>,
    road: Road,
    committed: VecDeque<State<T>>,
    /// The last evaluation.
    trial: Option<Trial<T>>,
    /// The host says which steps count.
    is_told: bool,
}

/// What came of a motion.
struct Trial<T> {
    posture: Posture,
    /// The committed state that it began from.
    from: usize,
    state: State<T>,
}

impl<T: Tire> Function<T> {
    fn new(settings: &Settings) -> Result<Self> {
        let wheel = Native::<Wheel<T>>::new(settings)?;
        let mut rolling = wheel.model().rolling().clone();
        rolling.mount()?;
        Ok(Self {
            tire: rolling.mounted,
            road: rolling.road,
            committed: VecDeque::new(),
            trial: None,
            is_told: false,
        })
    }

    fn same(a: f64, b: f64) -> bool {
        (a - b).abs() <= SAME_TIME * T::STEP
    }

    /// The state at the motion's time, from the last committed one that is not behind it.
    fn tried(&self, posture: &Posture) -> Result<(usize, State<T>)> {
        let mut rim = posture.motion()?;
        let to = [posture.place.x, posture.place.y];
        let is_not_behind =
            |state: &State<T>| state.time <= posture.time || Self::same(state.time, posture.time);
        let Some(from) = self.committed.iter().rposition(is_not_behind) else {
            let Some(first) = self.committed.front() else {
                let mut mounted = self.tire.clone();
                mounted.start(&rim, &OnRoad::at(&self.road, to, 1.0))?;
                return Ok((0, State { time: posture.time, place: posture.place, mounted }));
            };
            return Err(Error::call(format!(
                "the time {} s is before {} s, the earliest of the {KEPT} committed states that are kept",
                posture.time, first.time
            )));
        };
        let last = &self.committed[from];
        let mut mounted = last.mounted.clone();
        let length = posture.time - last.time;
        // a host may count angles from 0 in every turn
        let before = &last.mounted.rim;
        for axis in 1..3 {
            let expected = before.angles[axis] + 0.5 * length * (before.rates[axis] + rim.rates[axis]);
            rim.angles[axis] += TAU * ((expected - rim.angles[axis]) / TAU).round();
        }
        if Self::same(last.time, posture.time) {
            if last.place == posture.place && *before == rim {
                // what it was committed with
                return Ok((from, State { time: last.time, place: last.place, mounted }));
            }
            mounted.step(&rim, &OnRoad::at(&self.road, to, 1.0), 0.0)?;
        } else {
            let steps = (length / T::STEP - SAME_TIME).ceil().max(1.0);
            if steps > MOST_STEPS {
                return Err(Error::call(format!(
                    "{length} s since the last committed state are more than {MOST_STEPS} steps of {} s",
                    T::STEP
                )));
            }
            let way = Way { from: (last.mounted.rim, last.place), to: (rim, posture.place), length };
            let mut before = last.place;
            for k in 1..=steps as u32 {
                let (rim, place) = way.at(f64::from(k) / steps);
                let ground = OnRoad {
                    road: &self.road,
                    from: [before.x, before.y],
                    to: [place.x, place.y],
                    friction: 1.0,
                };
                mounted.step(&rim, &ground, length / steps)?;
                before = place;
            }
        }
        Ok((from, State { time: posture.time, place: posture.place, mounted }))
    }

    /// Makes the trial a committed state, in place of those behind the one that it began from.
    fn accept(&mut self) {
        let Some(Trial { from, state, .. }) = self.trial.take() else { return };
        self.committed.truncate(from + 1);
        if self.committed.back().is_some_and(|last| Self::same(last.time, state.time)) {
            // the same time again: the motion that it is left with
            self.committed.pop_back();
        }
        self.committed.push_back(state);
        if self.committed.len() > KEPT {
            self.committed.pop_front();
        }
    }
}

impl<T: Tire> TireFunction for Function<T> {
    fn evaluate(&mut self, posture: &Posture) -> Result<Answer> {
        let is_next = |time: f64| posture.time > time && !Self::same(posture.time, time);
        if !self.is_told && self.trial.as_ref().is_some_and(|trial| is_next(trial.state.time)) {
            self.accept();
        }
        let (from, state) = self.tried(posture)?;
        let mounted = &state.mounted;
        let (on_rim, carried) = (mounted.tire.on_rim(), mounted.tire.carried());
        let axis = posture.carrier.column(1).into_owned();
        // what their accelerations take is in force and moment
        let force = on_rim.force + carried.acceleration * carried.mass;
        let moment = on_rim.moment + axis * (carried.spin_acceleration * carried.inertia);
        let heading = rotation_z(-mounted.rim.angles.z);
        let place = posture.place;
        let under = self.road.mean(mounted.tire.window(), place.x, place.y).height;
        let answer = Answer {
            force,
            moment,
            carried_mass: carried.mass,
            carried_inertia: carried.inertia,
            warning: if self.committed.is_empty() { mounted.warning() } else { None },
            in_heading: [heading * force, heading * moment],
            deflection: mounted.tire.radius() - (place.z - under),
            energy_loss: mounted.tire.energy_loss(),
        };
        self.trial = Some(Trial { posture: *posture, from, state });
        Ok(answer)
    }

    fn commit(&mut self, posture: &Posture) -> Result<()> {
        if self.trial.as_ref().is_none_or(|trial| trial.posture != *posture) {
            let (from, state) = self.tried(posture)?;
            self.trial = Some(Trial { posture: *posture, from, state });
        }
        self.accept();
        self.is_told = true;
        Ok(())
    }
}

/// From a motion to another: cubics that have places and velocities of both ends.
struct Way {
    from: (Motion<f64>, Vector3<f64>),
    to: (Motion<f64>, Vector3<f64>),
    length: f64,
}

impl Way {
    fn at(&self, share: f64) -> (Motion<f64>, Vector3<f64>) {
        if share >= 1.0 {
            return self.to;
        }
        let ((from, from_place), (to, to_place)) = (&self.from, &self.to);
        let (s, rest, h) = (share, 1.0 - share, self.length);
        let place = |a: &Vector3<f64>, va: &Vector3<f64>, b: &Vector3<f64>, vb: &Vector3<f64>| {
            a * (rest * rest * (1.0 + 2.0 * s)) + b * (s * s * (3.0 - 2.0 * s)) + va * (h * s * rest * rest)
                - vb * (h * s * s * rest)
        };
        let velocity = |a: &Vector3<f64>, va: &Vector3<f64>, b: &Vector3<f64>, vb: &Vector3<f64>| {
            (b - a) * (6.0 * s * rest / h) + va * (rest * (1.0 - 3.0 * s)) + vb * (s * (3.0 * s - 2.0))
        };
        let rim = Motion {
            position: place(&from.position, &from.velocity, &to.position, &to.velocity),
            velocity: velocity(from_place, &from.velocity, to_place, &to.velocity),
            angles: place(&from.angles, &from.rates, &to.angles, &to.rates),
            rates: velocity(&from.angles, &from.rates, &to.angles, &to.rates),
        };
        let place = place(from_place, &from.velocity, to_place, &to.velocity);
        (Motion { position: Vector3::new(0.0, 0.0, place.z), ..rim }, place)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mechanics::{rotation_x, rotation_y};

    fn posture(carrier: Matrix3<f64>) -> Posture {
        Posture {
            time: 0.0,
            place: Vector3::new(1.0, 2.0, 0.21),
            carrier,
            velocity: Vector3::new(3.0, 0.2, -0.1),
            turning: Vector3::new(0.1, 0.2, 0.3),
            wheel_angle: 0.7,
            wheel_speed: 12.0,
        }
    }

    /// Angles of a carrier that was turned by them, and rates that are differences of angles as the carrier turns on.
    #[test]
    fn angles_and_rates_are_those_that_the_carrier_was_turned_by() {
        let (steer, camber, pitch) = (2.4, -0.2, 0.4);
        let carrier = rotation_z(steer) * rotation_x(camber) * rotation_y(pitch);
        let at = posture(carrier);
        let motion = at.motion().unwrap();
        assert!(
            (motion.angles - Vector3::new(camber, 0.7 + pitch, steer)).norm() < 1e-12,
            "{}",
            motion.angles
        );
        assert!((motion.velocity - carrier * at.velocity).norm() < 1e-12);
        let h = 1e-6;
        let turned = |time: f64| {
            // the carrier turns about its own axes
            let turn = nalgebra::Rotation3::new(at.turning * time);
            let wheel_angle = at.wheel_angle + at.wheel_speed * time;
            Posture { carrier: carrier * turn.matrix(), wheel_angle, ..at }.motion().unwrap().angles
        };
        let rates = (turned(h) - turned(-h)) / (2.0 * h);
        assert!((motion.rates - rates).norm() < 1e-8, "{} {rates}", motion.rates);
        let message = posture(2.0 * carrier).motion().unwrap_err().to_string();
        assert!(message.contains("no rotation"), "{message}");
        assert!(posture(rotation_x(1.55)).motion().is_err());
        assert!(Posture { time: f64::NAN, ..at }.motion().is_err());
    }

    /// The way between two motions has their places and velocities at its ends, and is a straight one where they are.
    #[test]
    fn ways_go_through_both_ends() {
        let end = |x: f64| {
            let place = Vector3::new(x, 0.0, 0.2 + 0.1 * x);
            let rim = Motion {
                position: Vector3::new(0.0, 0.0, place.z),
                velocity: Vector3::new(2.0, 0.0, 0.2),
                angles: Vector3::new(0.0, 5.0 * x, 0.1),
                rates: Vector3::new(0.0, 10.0, 0.0),
            };
            (rim, place)
        };
        let way = Way { from: end(0.0), to: end(1.0), length: 0.5 };
        for share in [0.0, 0.3, 1.0] {
            let (rim, place) = way.at(share);
            let (expected, there) = end(share);
            assert!((place - there).norm() < 1e-12 && (rim.position - expected.position).norm() < 1e-12);
            assert!((rim.velocity - expected.velocity).norm() < 1e-12);
            assert!(
                (rim.angles - expected.angles).norm() < 1e-12 && (rim.rates - expected.rates).norm() < 1e-12
            );
        }
    }
}
