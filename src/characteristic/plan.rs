//! What is measured where: the plan of a characterization, as TOML.

use super::geometry::{RimForce, Wheel};
use super::loops::Below;
use crate::model::unit::quantity;
use crate::recording::Recording;
use crate::{Error, Result};
use serde::Deserialize;
use std::f64::consts::TAU;

/// A plan.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Plan {
    /// What it is, in a line.
    pub title: String,
    /// What is known of the tire.
    pub tire: Tire,
    /// Radius of the drum of the decays; without, the road is flat.
    pub drum_radius: Option<Quantity>,
    /// Force-deflection loops of the standing wheel.
    #[serde(default, rename = "loop")]
    pub loops: Vec<LoopPlan>,
    /// Decays after impacts.
    #[serde(default, rename = "decay")]
    pub decays: Vec<DecayPlan>,
    /// How stiffness and damping are written.
    #[serde(default)]
    pub characteristic: Wanted,
}

/// A number in the SI unit of its entry, or a text with a unit: `0.2265` or `"226.5 mm"`.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(untagged)]
pub enum Quantity {
    /// In the SI unit.
    Number(f64),
    /// With a unit.
    Text(String),
}

impl Quantity {
    /// The number in a unit; `name` is that of the entry, for messages.
    ///
    /// # Errors
    /// No finite number, or a unit of another dimension.
    pub fn in_unit(&self, name: &str, unit: &str) -> Result<f64> {
        let value = match self {
            Self::Number(value) => *value,
            Self::Text(text) => quantity(text, unit).map_err(|e| Error::file(e.to_string()).at(name))?,
        };
        match value.is_finite() {
            true => Ok(value),
            false => Err(Error::file(format!("{name} = {value}: a finite number is needed"))),
        }
    }

    fn positive(&self, name: &str, unit: &str) -> Result<f64> {
        let value = self.in_unit(name, unit)?;
        match value > 0.0 {
            true => Ok(value),
            false => Err(Error::file(format!("{name} = {value} {unit}: it has to be positive"))),
        }
    }
}

fn positive(of: Option<&Quantity>, name: &str, unit: &str) -> Result<Option<f64>> {
    of.map(|q| q.positive(name, unit)).transpose()
}

/// A tire: names and defaults are those of the super-elastic tire's parameters.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Tire {
    /// For reports and files.
    pub name: String,
    /// Radius without load r0.
    pub radius: Quantity,
    /// Contact elements N.
    pub elements: usize,
    /// Contact points of an element.
    #[serde(default = "three")]
    pub contact_points: usize,
    /// Angle between the outer points of neighbouring elements.
    pub gap_angle: Option<Quantity>,
    /// Contact force of an element at a penetration of 1 mm; 0 for a rigid one.
    pub contact_stiffness: Option<Quantity>,
    /// Exponent of the penetration.
    pub contact_exponent: Option<f64>,
    /// Mass of all elements.
    pub rubber_mass: Option<Quantity>,
    /// What is summed up to the force on the rim.
    #[serde(default)]
    pub rim_force: RimForce,
    /// Stiffness of an element, where there is no loop to tell it.
    pub element_stiffness: Option<Quantity>,
    /// Of the property file alone: width, mass of the tire, mass and radius of the rim.
    pub width: Option<Quantity>,
    /// Mass of tire and rim.
    pub mass: Option<Quantity>,
    /// Mass of the rim.
    pub rim_mass: Option<Quantity>,
    /// Radius of the rim.
    pub rim_radius: Option<Quantity>,
    /// Gravity.
    #[serde(default = "gravity")]
    pub gravity: f64,
}

fn three() -> usize {
    3
}

fn gravity() -> f64 {
    9.81
}

/// A loop.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LoopPlan {
    /// The recording, from the plan's folder.
    pub file: String,
    /// Channel of the force, positive where the tire carries.
    pub force: String,
    /// Channel of the deflection, positive inward.
    pub deflection: String,
    /// Factors on them: -1 where they count the other way.
    #[serde(default = "one")]
    pub force_factor: f64,
    /// Of the deflection.
    #[serde(default = "one")]
    pub deflection_factor: f64,
    /// What the force channel shows with the wheel off the road, after its factor.
    pub force_off_road: Option<Quantity>,
    /// What the deflection channel shows where the tire just touches, after its factor.
    pub deflection_at_touch: Option<Quantity>,
    /// Mass between load cell and tire: its inertia is taken out of the force.
    pub mass_below_cell: Option<Quantity>,
    /// Whether the load cell was set to zero with that mass hanging from it; has to be said with the mass.
    pub tared_with_wheel: Option<bool>,
    /// Cycles at the beginning that are left out: rubber that was at rest is stiffer in the first one.
    #[serde(default = "one_cycle")]
    pub skip_cycles: usize,
    /// The part of the recording that is meant \[s\].
    pub between: Option<[f64; 2]>,
}

fn one() -> f64 {
    1.0
}

fn one_cycle() -> usize {
    1
}

/// A recording of decays.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct DecayPlan {
    /// The recording, from the plan's folder.
    pub file: String,
    /// The channel that swings: deflection, arm position, or an acceleration.
    pub channel: String,
    /// Wheel load at rest.
    pub load: Quantity,
    /// Circumferential speed.
    pub speed: Quantity,
    /// Mass that swings on the tire, as at the wheel.
    pub mass: Option<Quantity>,
    /// In place of it: moment of inertia of arm, wheel and weights about the pivot,
    pub pivot_inertia: Option<Quantity>,
    /// and the distance of the wheel from the pivot: m = J / L^2.
    pub wheel_arm: Option<Quantity>,
    /// Time between impacts.
    pub impact_period: Option<Quantity>,
    /// In place of it, the drum's circumference between two cleats.
    pub drum_circumference: Option<Quantity>,
    /// Length of the cleat: while it is below the tire nothing swings freely.
    pub cleat_length: Option<Quantity>,
    /// Share of the amplitude that may be left at the next impact.
    pub most_left: Option<f64>,
    /// The part of the recording that is meant \[s\].
    pub between: Option<[f64; 2]>,
}

/// A way to write a coefficient.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize, serde::Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Law {
    /// What the data tell.
    #[default]
    Auto,
    /// One number.
    Constant,
    /// A power of load and speed.
    Power,
    /// Points.
    Table,
}

/// How the characteristics are written.
#[derive(Debug, Clone, PartialEq, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Wanted {
    /// Law of the stiffness.
    #[serde(default)]
    pub stiffness: Law,
    /// Law of the damping.
    #[serde(default)]
    pub damping: Law,
    /// Loads of the stiffness table \[N\]; without, evenly over what the loops have.
    #[serde(default)]
    pub loads: Vec<f64>,
    /// Load and speed at which the constants of power laws hold; without, the middle of what was measured.
    pub reference_load: Option<Quantity>,
    /// The speed.
    pub reference_speed: Option<Quantity>,
    /// Numbers of elements for which tables are made besides the tire's own.
    #[serde(default)]
    pub elements: Vec<usize>,
}

impl Plan {
    /// Reads a plan.
    ///
    /// # Errors
    /// No TOML, unknown entries, numbers that cannot be, with the name of the entry.
    pub fn read(text: &str) -> Result<Self> {
        let plan: Self = toml::from_str(text).map_err(|e| Error::file(e.to_string()))?;
        plan.wheel(plan.tire.elements, false)?;
        plan.width_and_rim_radius()?;
        if plan.loops.is_empty() && plan.decays.is_empty() {
            return Err(Error::file(
                "there is nothing to identify anything from: give a [[loop]] or a [[decay]] with its file",
            ));
        }
        if plan.loops.is_empty() && plan.tire.element_stiffness.is_none() {
            return Err(Error::file(
                "decays tell the damping of the whole tire; for that of an element the deflection has to be known, and with it the stiffness: give a [[loop]], or element_stiffness under [tire]",
            ));
        }
        for part in &plan.loops {
            part.below(plan.tire.gravity).map_err(|e| e.at(format!("loop {:?}", part.file)))?;
            between(part.between).map_err(|e| e.at(format!("loop {:?}", part.file)))?;
            for (name, factor) in
                [("force_factor", part.force_factor), ("deflection_factor", part.deflection_factor)]
            {
                if !factor.is_finite() || factor == 0.0 {
                    return Err(Error::file(format!(
                        "loop {:?}: {name} = {factor}: it has to be a number other than 0",
                        part.file
                    )));
                }
            }
        }
        for part in &plan.decays {
            let check = || -> Result<()> {
                part.load()?;
                part.speed()?;
                part.mass(plan.tire.gravity)?;
                part.impacts()?;
                between(part.between)
            };
            check().map_err(|e| e.at(format!("decay {:?}", part.file)))?;
        }
        let wanted = &plan.characteristic;
        if wanted.loads.iter().any(|f| !(*f > 0.0 && f.is_finite()))
            || wanted.loads.windows(2).any(|w| w[0] >= w[1])
        {
            return Err(Error::file("characteristic: loads: positive loads that rise are needed"));
        }
        positive(wanted.reference_load.as_ref(), "reference_load", "N")?;
        positive(wanted.reference_speed.as_ref(), "reference_speed", "m/s")?;
        for n in &wanted.elements {
            plan.wheel(*n, false).map_err(|e| e.at("characteristic"))?;
        }
        Ok(plan)
    }

    /// The tire with a number of elements, on the drum of the decays or on a flat road.
    ///
    /// # Errors
    /// A number that cannot be.
    pub fn wheel(&self, elements: usize, on_drum: bool) -> Result<Wheel> {
        let tire = &self.tire;
        let radius = tire.radius.positive("radius", "m")?;
        // limits of the model's own parameters
        if !(4..=2000).contains(&elements) || !(1..=15).contains(&tire.contact_points) {
            return Err(Error::file(format!(
                "elements = {elements}, contact_points = {}: 4 to 2000 elements with 1 to 15 points are possible",
                tire.contact_points
            )));
        }
        if !(tire.gravity > 0.0 && tire.gravity.is_finite()) {
            return Err(Error::file(format!("gravity = {}: it has to be positive", tire.gravity)));
        }
        let pitch = TAU / elements as f64;
        let gap = self.gap_angle()?;
        if gap >= pitch {
            return Err(Error::file(format!(
                "gap_angle = {gap:.4} rad has to be smaller than the angle between neighbouring elements, {pitch:.4} rad with {elements} elements"
            )));
        }
        let half = radius * (0.5 * (pitch - gap)).sin();
        let points = match tire.contact_points {
            1 => vec![0.0],
            n => (0..n).map(|i| half * (2.0 * i as f64 / (n as f64 - 1.0) - 1.0)).collect(),
        };
        let stiffness = self.contact_stiffness()?;
        let exponent = self.contact_exponent()?;
        let drum = positive(self.drum_radius.as_ref(), "drum_radius", "m")?;
        Ok(Wheel {
            radius,
            elements,
            points,
            contact: (stiffness > 0.0).then_some((stiffness, exponent)),
            drum: drum.filter(|_| on_drum),
            rim_force: tire.rim_force,
            weight: self.rubber_mass()? / elements as f64 * tire.gravity,
        })
    }

    /// Angle between outer points of neighbours \[rad\]: a degree unless the plan says otherwise.
    ///
    /// # Errors
    /// No such angle.
    pub fn gap_angle(&self) -> Result<f64> {
        let angle = self.tire.gap_angle.as_ref().map(|q| q.in_unit("gap_angle", "rad")).transpose()?;
        match angle.unwrap_or(1_f64.to_radians()) {
            gap if gap >= 0.0 => Ok(gap),
            gap => Err(Error::file(format!("gap_angle = {gap} rad: it must not be negative"))),
        }
    }

    /// Contact force of an element at 1 mm \[N\]; 0 for a rigid contact.
    ///
    /// # Errors
    /// A negative one.
    pub fn contact_stiffness(&self) -> Result<f64> {
        let given =
            self.tire.contact_stiffness.as_ref().map(|q| q.in_unit("contact_stiffness", "N")).transpose()?;
        match given.unwrap_or(35_000.0) {
            force if force >= 0.0 => Ok(force),
            force => Err(Error::file(format!("contact_stiffness = {force} N: it must not be negative"))),
        }
    }

    /// Exponent of the penetration.
    ///
    /// # Errors
    /// One outside of 1 to 5, the model's own limits.
    pub fn contact_exponent(&self) -> Result<f64> {
        match self.tire.contact_exponent.unwrap_or(1.9) {
            exponent if (1.0..=5.0).contains(&exponent) => Ok(exponent),
            exponent => Err(Error::file(format!("contact_exponent = {exponent}: 1 to 5 is possible"))),
        }
    }

    /// Mass of all elements \[kg\].
    ///
    /// # Errors
    /// One that is not positive, or masses that do not add up.
    pub fn rubber_mass(&self) -> Result<f64> {
        Ok(self.masses()?.0.unwrap_or(19.8))
    }

    /// Mass of the rim \[kg\], if the plan tells it.
    ///
    /// # Errors
    /// As [`rubber_mass`](Self::rubber_mass).
    pub fn rim_mass(&self) -> Result<Option<f64>> {
        Ok(self.masses()?.1)
    }

    /// Of rubber and rim: each as given, or as the mass of both leaves it.
    fn masses(&self) -> Result<(Option<f64>, Option<f64>)> {
        let tire = &self.tire;
        let rubber = positive(tire.rubber_mass.as_ref(), "rubber_mass", "kg")?;
        let rim = positive(tire.rim_mass.as_ref(), "rim_mass", "kg")?;
        let Some(both) = positive(tire.mass.as_ref(), "mass", "kg")? else { return Ok((rubber, rim)) };
        let left = |of: f64, name: &str| match both > of {
            true => Ok(both - of),
            false => {
                Err(Error::file(format!("mass = {both} kg of tire and rim is no more than {name} = {of} kg")))
            }
        };
        match (rubber, rim) {
            (None, None) => Err(Error::file(format!(
                "mass = {both} kg is that of tire and rim: give rim_mass or rubber_mass with it"
            ))),
            (Some(rubber), None) => Ok((Some(rubber), Some(left(rubber, "rubber_mass")?))),
            (None, Some(rim)) => Ok((Some(left(rim, "rim_mass")?), Some(rim))),
            // scales tell half a percent
            (Some(rubber), Some(rim)) if (rubber + rim - both).abs() > 0.005 * both => {
                Err(Error::file(format!(
                    "rubber_mass = {rubber} kg and rim_mass = {rim} kg are not mass = {both} kg together"
                )))
            }
            all => Ok(all),
        }
    }

    /// Width of the tread and radius of the rim \[m\], if the plan tells them.
    ///
    /// # Errors
    /// One that is not positive.
    pub fn width_and_rim_radius(&self) -> Result<[Option<f64>; 2]> {
        let tire = &self.tire;
        Ok([
            positive(tire.width.as_ref(), "width", "m")?,
            positive(tire.rim_radius.as_ref(), "rim_radius", "m")?,
        ])
    }
}

impl LoopPlan {
    /// The mass below the load cell.
    ///
    /// # Errors
    /// A mass without a word on how the cell was set to zero.
    pub fn below(&self, gravity: f64) -> Result<Option<Below>> {
        let mass = positive(self.mass_below_cell.as_ref(), "mass_below_cell", "kg")?;
        match (mass, self.tared_with_wheel) {
            (None, None) => Ok(None),
            (Some(mass), Some(tared)) => Ok(Some(Below { mass, tared, gravity })),
            (Some(_), None) => Err(Error::file(
                "mass_below_cell needs tared_with_wheel: true if the load cell was set to zero with the wheel hanging from it, false if it shows the weight of what hangs",
            )),
            (None, Some(_)) => Err(Error::file("tared_with_wheel needs mass_below_cell")),
        }
    }
}

impl DecayPlan {
    /// Wheel load \[N\].
    ///
    /// # Errors
    /// None that is positive.
    pub fn load(&self) -> Result<f64> {
        self.load.positive("load", "N")
    }

    /// Speed \[m/s\].
    ///
    /// # Errors
    /// A negative one.
    pub fn speed(&self) -> Result<f64> {
        match self.speed.in_unit("speed", "m/s")? {
            speed if speed >= 0.0 => Ok(speed),
            speed => Err(Error::file(format!("speed = {speed} m/s: it must not be negative"))),
        }
    }

    /// The mass that swings \[kg\], and what it is from.
    ///
    /// # Errors
    /// Two ways at once, or half of one.
    pub fn mass(&self, gravity: f64) -> Result<(f64, MassFrom)> {
        let mass = positive(self.mass.as_ref(), "mass", "kg")?;
        let inertia = positive(self.pivot_inertia.as_ref(), "pivot_inertia", "kg.m2")?;
        let arm = positive(self.wheel_arm.as_ref(), "wheel_arm", "m")?;
        match (mass, inertia, arm) {
            (Some(mass), None, None) => Ok((mass, MassFrom::Given)),
            (None, Some(inertia), Some(arm)) => Ok((inertia / (arm * arm), MassFrom::Pivot)),
            (None, None, None) => Ok((self.load()? / gravity, MassFrom::Load)),
            _ => Err(Error::file("the mass is given by mass, or by pivot_inertia and wheel_arm together")),
        }
    }

    /// What is known of the impacts.
    ///
    /// # Errors
    /// Two periods, or a circumference without a speed.
    pub fn impacts(&self) -> Result<super::decay::Impacts> {
        let speed = self.speed()?;
        let period = positive(self.impact_period.as_ref(), "impact_period", "s")?;
        let way = positive(self.drum_circumference.as_ref(), "drum_circumference", "m")?;
        let cleat = positive(self.cleat_length.as_ref(), "cleat_length", "m")?;
        if (way.is_some() || cleat.is_some()) && speed == 0.0 {
            return Err(Error::file("drum_circumference and cleat_length are ways: they need a speed"));
        }
        if way.is_some() && period.is_some() {
            return Err(Error::file("impact_period and drum_circumference say the same thing: give one"));
        }
        let most_left = self.most_left.unwrap_or(super::decay::MOST_LEFT);
        if !(most_left > 0.0 && most_left < 1.0) {
            return Err(Error::file(format!("most_left = {most_left}: a share between 0 and 1 is needed")));
        }
        Ok(super::decay::Impacts {
            period: period.or(way.map(|way| way / speed)),
            passage: cleat.map_or(0.0, |cleat| cleat / speed),
            most_left,
        })
    }
}

/// What the mass of a decay is from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum MassFrom {
    /// It was given.
    Given,
    /// Inertia about the pivot and arm.
    Pivot,
    /// Load over gravity.
    Load,
}

fn between(part: Option<[f64; 2]>) -> Result<()> {
    match part {
        Some([from, to]) if from.is_nan() || to.is_nan() || from >= to => {
            Err(Error::file(format!("between = [{from}, {to}]: a time and a later one are needed")))
        }
        _ => Ok(()),
    }
}

/// The part of a recording between two times \[s\].
///
/// # Errors
/// One that the recording does not cover.
pub fn cut(recording: Recording, part: Option<[f64; 2]>) -> Result<Recording> {
    let Some([from, to]) = part else { return Ok(recording) };
    recording.covers(from, to)?;
    let Recording { time, mut channels, source } = recording;
    let kept = time.partition_point(|t| *t < from)..time.partition_point(|t| *t <= to);
    for channel in &mut channels {
        channel.values = channel.values[kept.clone()].to_vec();
    }
    Ok(Recording { time: time[kept].to_vec(), channels, source })
}
