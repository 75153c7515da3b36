//! What quantities are called in TYDEX files and in recordings.

use crate::model::unit::Unit;

/// The time.
pub const RUNTIME: &str = "RUNTIME";

/// Speed of the wheel centre in the wheel's heading: the path speed times the cosine of the slip angle. Reading makes the path
/// speed of it, so no channel is written as it.
pub const LONGVEL: &str = "LONGVEL";

/// A name of TYDEX, and which channel of a recording that is. Both count the same way and in the same axes.
pub struct Known {
    pub tydex: &'static str,
    pub name: &'static str,
    /// A unit of the same dimension.
    pub unit: &'static str,
    /// What it is, for the comment beside the name.
    pub comment: &'static str,
    /// The input of a rig that it is as a constant of the file: what the rig holds during the run.
    pub held: Option<&'static str>,
}

const fn known(
    tydex: &'static str,
    name: &'static str,
    unit: &'static str,
    held: Option<&'static str>,
    comment: &'static str,
) -> Known {
    Known { tydex, name, unit, comment, held }
}

/// The names that are known. Of several for one channel the first is written, and taken first.
///
/// Forces and moments of a rig are those on the rim in H axes: origin in the wheel centre, x horizontal in the wheel's
/// heading, z vertical. C axes have the origin and x in common with them, so FXC and MXC are the same numbers; FX without
/// an axis system stands for a direction that all three have in common on a level road. Nothing else of C and W axes is
/// here: y and z of C lean with the wheel, and moments of W are about the contact point. Nor is a force of W axes, which is
/// that of the road on the tire, without what the tire itself weighs.
#[rustfmt::skip] // a row is a line
pub const KNOWN: &[Known] = &[
    // wheel speed over that of the freely rolling wheel, less 1: driving is positive. Forward, that is the model's slip
    known("LONGSLIP", "slip", "1", Some("slip"), "longitudinal slip"),
    // positive when the wheel travels to its left, which gives a negative lateral force
    known("SLIPANGL", "slip_angle", "rad", Some("slip_angle"), "slip angle"),
    // about x, right-handed: positive leans the top of the wheel to its right
    known("INCLANGL", "camber", "rad", Some("camber"), "inclination angle"),
    known("STEEANGL", "steer", "rad", Some("steer"), "steer angle"),
    known("TRAJVELW", "path_speed", "m/s", Some("path_speed"), "trajectory velocity"),
    known(LONGVEL, "longvel", "m/s", Some("path_speed"), "longitudinal velocity"),
    // normal to the road, positive pressed in: the unloaded radius less the height of the wheel centre
    known("TYREDEFW", "deflection", "m", Some("deflection"), "tyre deflection"),
    // forward is positive
    known("WHROTSPD", "wheel_speed", "rad/s", None, "wheel rotation speed"),
    known("FXH", "force_x", "N", None, "longitudinal force"),
    known("FX", "force_x", "N", None, "longitudinal force"),
    known("FXC", "force_x", "N", None, "longitudinal force"),
    known("FYH", "force_y", "N", None, "lateral force"),
    known("FZH", "force_z", "N", Some("load"), "vertical force"),
    known("MXH", "moment_x", "N.m", None, "overturning moment"),
    known("MXC", "moment_x", "N.m", None, "overturning moment"),
    known("MYH", "moment_y", "N.m", None, "moment about lateral axis"),
    known("MZH", "moment_z", "N.m", None, "aligning moment"),
];

/// The row of a TYDEX name.
pub fn of_tydex(name: &str) -> Option<&'static Known> {
    KNOWN.iter().find(|row| row.tydex == name)
}

/// The row that the channel is written as: it has the name, and its unit is one of the quantity.
pub fn of_channel(name: &str, unit: &str) -> Option<&'static Known> {
    KNOWN.iter().find(|row| row.name == name && row.tydex != LONGVEL).filter(|row| row.takes(unit))
}

/// Whether reading gives this TYDEX name a meaning, so that it must not be written for anything else.
pub fn is_taken(name: &str) -> bool {
    name == RUNTIME || of_tydex(name).is_some()
}

impl Known {
    /// Whether a unit is one of this quantity.
    pub fn takes(&self, unit: &str) -> bool {
        converts(unit, self.unit)
    }

    /// The unit of a file as that of a channel.
    ///
    /// # Errors
    /// There is none, or it is one of something else.
    pub fn unit(&self, text: Option<&str>) -> Result<String, String> {
        let Known { tydex, comment, unit, .. } = self;
        let Some(text) = text else {
            return Err(format!("{tydex} is the {comment}, but has no unit; write one, for instance {unit}"));
        };
        // turns are not said in the unit of a rotation speed: 1/min is one of frequency anywhere else
        let text = match text {
            "1/min" if *unit == "rad/s" => "rpm",
            "1/s" | "Hz" if *unit == "rad/s" => "rev/s",
            _ => text,
        };
        match self.takes(text) {
            true => Ok(text.into()),
            false => Err(format!("{tydex} is the {comment}, but {text:?} does not convert to {unit:?}")),
        }
    }
}

/// Whether both are units of one dimension.
pub fn converts(from: &str, to: &str) -> bool {
    match (Unit::parse(from), Unit::parse(to)) {
        (Ok(from), Ok(to)) => from.to(to).is_some(),
        _ => false,
    }
}

/// The unit of a file in the notation of recordings.
pub fn unit(text: &str) -> &str {
    match text {
        "deg C" | "°C" => "degC",
        "inch" => "in",
        _ => text,
    }
}
