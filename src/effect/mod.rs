//! Physics that a model leaves out: a catalogue of named effects, and [`Attached`], a slave with effects
//! on its ports.
//!
//! An effect changes one number on its way: an input before the model gets it, an output before the
//! world sees it, a parameter in flight, or it adds a force to an input that is one. It has few
//! parameters with an off value at which nothing changes, to the last bit, and a memory of its own.

mod along;
mod attached;
pub mod catalogue;
pub mod empirical;
pub mod file;

pub use crate::model::Role;
pub use along::{Along, Earlier, remembered};
pub use attached::{Attached, Attachment, Chosen, Signal, Source, attached_interface};

use serde::{Deserialize, Serialize};
use std::collections::VecDeque;

/// The effect with this id, named or empirical; of several forms the first.
pub fn find(id: &str) -> Option<&'static Effect> {
    forms(id).next()
}

/// The forms of an effect: the same physics with other signals at hand. They differ in the number of
/// drivers or in the names of parameters.
pub fn forms(id: &str) -> impl Iterator<Item = &'static Effect> {
    catalogue::EFFECTS.iter().chain(empirical::EFFECTS).filter(move |e| e.id == id)
}

/// What kind of machine part an effect belongs to.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Family {
    /// The tire and its contact with the road.
    Tire,
    /// Brake, ABS, wheel and driveline.
    Brake,
    /// Suspension and steering.
    Suspension,
    /// Test rig: fixture, frame, drum, belt, bearings.
    Rig,
    /// Sensor, amplifier, filter, clock.
    Sensor,
    /// What any mechanism has: springs, dampers, friction, play, inertia.
    Mechanism,
}

/// What an effect changes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Port {
    /// The path of an input.
    Input,
    /// The path of an output.
    Output,
    /// A tunable parameter during the run.
    Parameter,
    /// An input that is a force or moment, to which it adds one.
    Force,
}

/// Drivers that an effect has at most.
pub const MAX_DRIVERS: usize = 5;

/// The dimension of an effect's parameter, and with it the size that is natural for a machine: a product
/// of an SI unit and powers of the changed number's scale and of the drivers' scales.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Scale {
    /// An SI unit: `"s"`, `"1"`.
    pub unit: &'static str,
    /// Power of the changed number.
    pub target: i8,
    /// Power of each driver; of a fourth and fifth none.
    pub drivers: [i8; 3],
    /// Power of the machine's own time: the period of its motions, which is about 1 s for a car and a millisecond or an
    /// hour for others \[s\].
    pub time: i8,
}

impl Scale {
    /// A plain number in an SI unit.
    pub const fn plain(unit: &'static str) -> Self {
        Self::of(unit, 0, [0; 3])
    }

    /// A power of the machine's own time: 1 for a time, -1 for a frequency.
    pub const fn own_time(power: i8) -> Self {
        Self { time: power, ..Self::plain("1") }
    }

    /// Times the changed number's scale to the power `target` and the drivers' to `drivers`.
    pub const fn of(unit: &'static str, target: i8, drivers: [i8; 3]) -> Self {
        Self { unit, target, drivers, time: 0 }
    }

    /// Per machine's own time.
    pub const fn per_time(self, power: i8) -> Self {
        Self { time: -power, ..self }
    }

    /// Whether it is a plain number in its unit, whatever the machine.
    pub const fn is_plain(&self) -> bool {
        self.target == 0 && self.time == 0 && matches!(self.drivers, [0, 0, 0])
    }
}

/// A parameter of an effect. All numbers are in multiples of its scale.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Parameter {
    /// Name in snake case.
    pub name: &'static str,
    /// What it means.
    pub description: &'static str,
    /// Dimension and natural size.
    pub scale: Scale,
    /// Where nothing changes; `None` for a parameter of shape (a time constant, a threshold), which
    /// means nothing while the others are off.
    pub off: Option<f64>,
    /// Smallest and largest value that is plausible for the name: outside the name is refuted. The
    /// search goes as far as `search`.
    pub plausible: (f64, f64),
    /// How far a fit may go.
    pub search: (f64, f64),
    /// Values to try first: for a shape a coarse grid; for an amplitude one small value, and behind it, of what sticks or
    /// touches or comes late, sizes that are tried as a whole, because small amounts of it do something else.
    pub probes: &'static [f64],
    /// It says how a run begins after another one of a session, and nothing where there is one run only, as in an FMU.
    pub of_session: bool,
}

impl Parameter {
    /// A parameter that is off at 0.
    pub const fn amplitude(
        name: &'static str,
        description: &'static str,
        scale: Scale,
        plausible: (f64, f64),
        search: (f64, f64),
        probes: &'static [f64],
    ) -> Self {
        Self { name, description, scale, off: Some(0.0), plausible, search, probes, of_session: false }
    }

    /// A parameter of shape.
    pub const fn shape(
        name: &'static str,
        description: &'static str,
        scale: Scale,
        plausible: (f64, f64),
        search: (f64, f64),
        probes: &'static [f64],
    ) -> Self {
        Self { name, description, scale, off: None, plausible, search, probes, of_session: false }
    }

    /// The share of an effect's memory that outlasts the pause to the next run of a session. It is tried with half of it, and with
    /// runs that all begin anew.
    pub const fn kept(description: &'static str) -> Self {
        let share = Self::shape(
            "kept_between_runs",
            description,
            Scale::plain("1"),
            (0.0, 1.0),
            (0.0, 1.0),
            &[0.5, 0.0],
        );
        Self { of_session: true, ..share }
    }

    /// True for a shape whose search spans an order of magnitude or more: twice as long a time is as far
    /// as half as long a one, so that fits count its logarithm.
    pub fn is_logarithmic(&self) -> bool {
        let (low, high) = self.search;
        self.off.is_none() && low > 0.0 && high >= 10.0 * low
    }
}

/// One named piece of physics.
pub struct Effect {
    /// Kebab case, stable: files name it.
    pub id: &'static str,
    /// In words.
    pub name: &'static str,
    /// Where in the machine it belongs.
    pub family: Family,
    /// What it changes.
    pub port: Port,
    /// Where else it may sit: on tunable parameters, if it is a factor; on the paths of inputs with a role.
    pub also: &'static [(Port, Role)],
    /// The equation in plain text.
    pub equation: &'static str,
    /// Where the equation comes from: a published source, or "standard engineering knowledge".
    pub source: &'static str,
    /// How it shows in a residual.
    pub signature: &'static str,
    /// Ids of effects that it is taken for, and what tells them apart.
    pub confused_with: &'static [(&'static str, &'static str)],
    /// What the changed number may be; empty: any real variable of the port.
    pub targets: &'static [Role],
    /// The signals that it needs besides the changed number.
    pub drivers: &'static [Role],
    /// Its parameters; at least one has an off value.
    pub parameters: &'static [Parameter],
    /// The changed number.
    pub apply: fn(&[f64], &mut Memory, &Call<'_>) -> f64,
}

impl Effect {
    /// The number of the parameter that says which share of its memory is there when the next run of a session begins.
    pub fn kept(&self) -> Option<usize> {
        self.parameters.iter().position(|p| p.of_session)
    }
}

impl std::fmt::Debug for Effect {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Effect").field("id", &self.id).finish_non_exhaustive()
    }
}

/// What an effect sees at a communication point.
#[derive(Debug, Clone, Copy)]
pub struct Call<'a> {
    /// Time \[s\].
    pub time: f64,
    /// Time since the last call \[s\]; 0 at the start, where the memory has to be filled.
    pub dt: f64,
    /// The number to be changed; for [`Port::Force`] the force without the effect.
    pub target: f64,
    /// The drivers, in the order of [`Effect::drivers`].
    pub drivers: &'a [f64],
    /// What the number to be changed does in the whole run, where that is over: an FMU does not know what is ahead.
    pub course: Option<Course<'a>>,
}

/// A number over a run that is over, at even times, straight in between and held outside.
#[derive(Debug, Clone, Copy)]
pub struct Course<'a> {
    /// The first time \[s\].
    pub start: f64,
    /// From one to the next \[s\].
    pub step: f64,
    /// The values.
    pub values: &'a [f64],
}

impl Course<'_> {
    /// The value at a time; 0 of an empty course.
    pub fn at(&self, time: f64) -> f64 {
        let place = ((time - self.start) / self.step).max(0.0);
        let k = (place as usize).min(self.values.len().saturating_sub(2));
        let share = place - k as f64;
        match (self.values.get(k), self.values.get(k + 1)) {
            // a time beside a value has that value
            (Some(value), Some(next)) if share >= 1e-9 => value + (next - value) * share.min(1.0),
            (value, _) => value.copied().unwrap_or_default(),
        }
    }
}

/// What an effect remembers: plain data.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Memory {
    /// States of any meaning; zero before the start.
    pub states: [f64; 6],
    /// Times and values of the past, oldest first.
    pub past: VecDeque<(f64, f64)>,
}

impl Memory {
    /// Adds a value to the past and drops what is older than `span` \[s\] but for one.
    pub fn remember(&mut self, time: f64, value: f64, span: f64) {
        self.past.push_back((time, value));
        while self.past.len() > 2 && self.past[1].0 <= time - span {
            self.past.pop_front();
        }
    }

    /// The remembered value at a time, linear between the remembered ones and held outside.
    pub fn recall(&self, time: f64) -> f64 {
        let next = self.past.partition_point(|(t, _)| *t <= time);
        match (next.checked_sub(1).and_then(|i| self.past.get(i)), self.past.get(next)) {
            (Some((t0, v0)), Some((t1, v1))) => v0 + (v1 - v0) * ((time - t0) / (t1 - t0)),
            (Some((_, v)), None) | (None, Some((_, v))) => *v,
            (None, None) => 0.0,
        }
    }

    /// The state `i` after moving towards `goal` with the time constant `tau` \[s\] for `dt` \[s\], the
    /// goal running straight from its last value, which is kept in state `i + 1`. Exact for straight
    /// goals, whatever `dt` is; with `tau <= 0` the goal itself.
    pub fn lag(&mut self, i: usize, goal: f64, tau: f64, dt: f64) -> f64 {
        let (y, last) = (self.states[i], self.states[i + 1]);
        let next = if dt <= 0.0 || tau <= 0.0 {
            goal
        } else if tau == f64::INFINITY {
            y
        } else {
            let (x, decay) = (dt / tau, libm::exp(-dt / tau));
            // of the goal's rise the part that has been followed
            let gone = -libm::expm1(-x);
            let ramp = 1.0 - gone / x;
            y * decay + last * gone + (goal - last) * ramp
        };
        self.states[i] = next;
        self.states[i + 1] = goal;
        next
    }
}
