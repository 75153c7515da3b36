//! Which curves are measured, and their measuring.

use super::readings::{Measure, Reading, readings};
use super::{Condition, Point, Rig};
use crate::{Error, Result};

/// States on one side of a curve over slip angle or camber, and how much denser they are at its beginning: places go with this power.
const ANGLES: (u32, f64) = (30, 1.4);
/// The same over slip, most of which is far behind the peak.
const SLIPS: (u32, f64) = (40, 2.2);
/// Slip angles at which the wheel is braked as well, as shares of the largest.
const COMBINED: [f64; 3] = [1.0 / 6.0, 1.0 / 3.0, 2.0 / 3.0];
/// Loads of the vertical curve over the largest one.
const VERTICAL: u32 = 16;

/// What is measured.
#[derive(Debug, Clone, PartialEq)]
pub struct Programme {
    /// \[N\], ascending.
    pub loads: Vec<f64>,
    /// \[m/s\]; all curves are measured at the first, those over slip angle and slip at all.
    pub speeds: Vec<f64>,
    /// Factors on the friction of the road; as speeds.
    pub frictions: Vec<f64>,
    /// Largest slip angle \[rad\].
    pub slip_angle: f64,
    /// Largest slip of a driven wheel; braked ones are braked until they are locked.
    pub slip: f64,
    /// Largest camber \[rad\].
    pub camber: f64,
}

/// What a curve goes over.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Quantity {
    /// \[rad\].
    SlipAngle,
    /// As a ratio.
    Slip,
    /// \[rad\].
    Camber,
    /// \[N\].
    Load,
}

/// What a curve is for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// Over slip angle.
    Cornering,
    /// Over slip, straight ahead.
    Braking,
    /// Over slip, at a slip angle.
    Combined,
    /// Over camber, straight ahead.
    Camber,
    /// Over load.
    Vertical,
}

impl Kind {
    /// What it goes over.
    pub fn over(self) -> Quantity {
        match self {
            Self::Cornering => Quantity::SlipAngle,
            Self::Braking | Self::Combined => Quantity::Slip,
            Self::Camber => Quantity::Camber,
            Self::Vertical => Quantity::Load,
        }
    }

    /// Its name in files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Cornering => "cornering",
            Self::Braking => "braking",
            Self::Combined => "combined",
            Self::Camber => "camber",
            Self::Vertical => "vertical",
        }
    }
}

/// States over one quantity, in ascending order; those that cannot be held are none.
#[derive(Debug, Clone, PartialEq)]
pub struct Curve {
    /// What it is for.
    pub kind: Kind,
    /// What is held; the quantity that it goes over is that of its first state.
    pub held: Condition,
    /// The states.
    pub states: Vec<(Condition, Option<Point>)>,
}

/// What was measured of a tire.
#[derive(Debug, Clone, PartialEq)]
pub struct Tire {
    /// Its name.
    pub name: String,
    /// The curves.
    pub curves: Vec<Curve>,
    /// What is read from them.
    pub readings: Vec<Reading>,
    /// What should be known.
    pub notes: Vec<String>,
}

impl Condition {
    /// The same with another value of a quantity.
    #[must_use]
    pub fn with(self, quantity: Quantity, value: f64) -> Self {
        match quantity {
            Quantity::SlipAngle => Self { slip_angle: value, ..self },
            Quantity::Slip => Self { slip: value, ..self },
            Quantity::Camber => Self { camber: value, ..self },
            Quantity::Load => Self { load: value, ..self },
        }
    }

    /// The value of a quantity.
    pub fn of(&self, quantity: Quantity) -> f64 {
        match quantity {
            Quantity::SlipAngle => self.slip_angle,
            Quantity::Slip => self.slip,
            Quantity::Camber => self.camber,
            Quantity::Load => self.load,
        }
    }
}

impl Programme {
    /// Checks its numbers.
    ///
    /// # Errors
    /// A list without a number, a number that is not positive, loads that do not rise.
    pub fn check(&self) -> Result<()> {
        let lists = [("loads", &self.loads), ("speeds", &self.speeds), ("friction factors", &self.frictions)];
        for (name, list) in lists {
            if list.is_empty() || !list.iter().all(|value| value.is_finite() && *value > 0.0) {
                return Err(Error::call(format!("{name} have to be one or more numbers above 0")));
            }
        }
        if !self.loads.is_sorted_by(|a, b| a < b) {
            return Err(Error::call("loads have to rise"));
        }
        Ok(())
    }

    /// Straight ahead at the first speed and friction.
    pub fn straight(&self, load: f64) -> Condition {
        let [speed, friction] =
            [&self.speeds, &self.frictions].map(|list| list.first().copied().unwrap_or(1.0));
        Condition { load, speed, friction, slip_angle: 0.0, slip: 0.0, camber: 0.0 }
    }

    /// The load in the middle, of an even number the upper one.
    pub fn middle(&self) -> f64 {
        self.loads.get(self.loads.len() / 2).copied().unwrap_or(0.0)
    }

    /// The values of a curve.
    fn values(&self, over: Quantity) -> Vec<f64> {
        let both = |(count, power): (u32, f64), low: f64, high: f64| {
            let share = move |k: u32| (f64::from(k) / f64::from(count)).powf(power);
            (1..=count).rev().map(|k| -low * share(k)).chain((0..=count).map(|k| high * share(k))).collect()
        };
        match over {
            Quantity::SlipAngle => both(ANGLES, self.slip_angle, self.slip_angle),
            Quantity::Camber => both(ANGLES, self.camber, self.camber),
            Quantity::Slip => both(SLIPS, 1.0, self.slip),
            Quantity::Load => {
                let most = self.loads.last().copied().unwrap_or(0.0);
                (1..=VERTICAL).map(|k| most * f64::from(k) / f64::from(VERTICAL)).collect()
            }
        }
    }

    /// All curves of a rig, by what they are for and what is held.
    fn curves(&self, rig: &Rig) -> Vec<(Kind, Condition)> {
        let [slip_angle, slip, camber] = rig.drives();
        let ([speed, friction], middle) = (rig.varies(), self.straight(self.middle()));
        let mut all = Vec::new();
        for (kind, is_there) in [(Kind::Cornering, slip_angle), (Kind::Braking, slip), (Kind::Camber, camber)]
        {
            if !is_there {
                continue;
            }
            all.extend(self.loads.iter().map(|load| (kind, self.straight(*load))));
            if kind == Kind::Camber {
                continue;
            }
            let speeds = self.speeds.iter().skip(1).filter(|_| speed);
            all.extend(speeds.map(|speed| (kind, Condition { speed: *speed, ..middle })));
            let frictions = self.frictions.iter().skip(1).filter(|_| friction);
            all.extend(frictions.map(|friction| (kind, Condition { friction: *friction, ..middle })));
        }
        if slip_angle && slip {
            let angles = COMBINED.map(|share| Condition { slip_angle: share * self.slip_angle, ..middle });
            all.extend(angles.map(|held| (Kind::Combined, held)));
        }
        all.push((Kind::Vertical, middle));
        all
    }

    /// How many states the curves have that are measured of a rig.
    pub fn states(&self, rig: &Rig) -> usize {
        self.curves(rig).iter().map(|(kind, _)| self.values(kind.over()).len()).sum()
    }
}

/// Measures a tire; `done` is called behind each state.
///
/// # Errors
/// A programme with other numbers than [`Programme::check`] takes; a rig that holds no state at all, with the reason of the first.
pub fn measure(name: &str, rig: &mut Rig, programme: &Programme, done: &dyn Fn()) -> Result<Tire> {
    programme.check()?;
    let (mut curves, mut missing) = (Vec::new(), Vec::new());
    let mut held_any = false;
    for (kind, held) in programme.curves(rig) {
        let mut states = Vec::new();
        for value in programme.values(kind.over()) {
            let condition = held.with(kind.over(), value);
            let point = rig.point(&condition).map_err(|e| missing.push(e)).ok();
            held_any |= point.is_some();
            states.push((condition, point));
            done();
        }
        curves.push(Curve { kind, held, states });
    }
    if let (false, Some(first)) = (held_any, missing.first()) {
        return Err(first.clone().at(name));
    }
    let mut notes = Vec::new();
    if let Some(first) = missing.first() {
        notes
            .push(format!("{} states could not be held and are left out; the first: {first}", missing.len()));
    }
    let readings = readings(rig, programme, &curves, &mut notes);
    notes.extend(rig.warnings().iter().cloned());
    Ok(Tire { name: name.into(), curves, readings, notes })
}

impl Tire {
    /// A reading at a load.
    pub fn reading(&self, measure: Measure, load: f64) -> Option<f64> {
        self.readings.iter().find(|r| r.measure == measure && r.load == load).map(|r| r.value)
    }
}
