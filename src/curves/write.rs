//! Curves and readings as files.

use super::programme::{Curve, Kind, Tire};
use crate::recording::{Channel, Recording};
use std::fmt::Write as _;

/// All states of all tires, one a line; moments about the contact are those of [`contact_moment`](super::Point::contact_moment).
pub fn curves_csv(tires: &[Tire]) -> String {
    let mut text = String::from(
        "tire,curve,load [N],speed [m/s],friction_factor [1],slip_angle [rad],slip [1],camber [rad],\
         force_x [N],force_y [N],force_z [N],moment_x [N.m],moment_y [N.m],moment_z [N.m],\
         contact_moment_x [N.m],contact_moment_y [N.m],contact_moment_z [N.m],deflection [m]\n",
    );
    for tire in tires {
        for curve in &tire.curves {
            for (at, point) in &curve.states {
                let Some(point) = point else { continue };
                let held = [at.load, at.speed, at.friction, at.slip_angle, at.slip, at.camber];
                let contact = point.contact_moment(at.camber).map_or([None; 3], |m| m.map(Some));
                let measured = held.iter().chain(&point.force).chain(&point.moment).map(|v| Some(*v));
                let _ = write!(text, "{},{}", quoted(&tire.name), curve.kind.name());
                for value in measured.chain(contact).chain([point.deflection]) {
                    let _ = write!(text, ",{}", value.map_or(String::new(), |v| v.to_string()));
                }
                text.push('\n');
            }
        }
    }
    text
}

/// All readings of all tires, one a line; a peak that a curve does not reach has no value.
pub fn curves_readings_csv(tires: &[Tire]) -> String {
    let mut text = String::from("tire,reading,load [N],value,unit\n");
    for tire in tires {
        for reading in &tire.readings {
            let [name, _, unit] = reading.measure.words();
            let value =
                Some(reading.value).filter(|v| v.is_finite()).map_or(String::new(), |v| v.to_string());
            let _ = writeln!(text, "{},{name},{},{value},{unit}", quoted(&tire.name), reading.load);
        }
    }
    text
}

/// A text as a field of CSV.
fn quoted(text: &str) -> String {
    match text.contains([',', '"', '\n', '\r']) {
        true => format!("\"{}\"", text.replace('"', "\"\"")),
        false => text.into(),
    }
}

/// Each curve of a tire as a recording with a stationary state a second, and a name for its file.
pub fn recordings(tire: &Tire) -> Vec<(String, Recording)> {
    let first = tire.curves.first().map(|curve| curve.held);
    let named = |curve: &Curve| {
        let held = &curve.held;
        let mut name = format!("{}-{}", file_name(&tire.name), curve.kind.name());
        if curve.kind != Kind::Vertical {
            name += &format!("-{:.0}N", held.load);
        }
        if curve.kind == Kind::Combined {
            name += &format!("-{:.1}deg", held.slip_angle.to_degrees());
        }
        // what most curves share is in no name
        if first.is_some_and(|first| first.speed != held.speed) {
            name += &format!("-{}mps", held.speed);
        }
        if first.is_some_and(|first| first.friction != held.friction) {
            name += &format!("-friction{}", held.friction);
        }
        name
    };
    tire.curves.iter().map(|curve| (named(curve), recording(tire, curve))).collect()
}

fn recording(tire: &Tire, curve: &Curve) -> Recording {
    let held: Vec<_> = curve.states.iter().filter_map(|(at, point)| Some((at, point.as_ref()?))).collect();
    let mut channels = Vec::new();
    let mut channel = |name: &str, unit: &str, values: Vec<f64>| {
        channels.push(Channel { name: name.into(), unit: unit.into(), values });
    };
    channel("path_speed", "m/s", held.iter().map(|(at, _)| at.speed).collect());
    channel("slip_angle", "rad", held.iter().map(|(at, _)| at.slip_angle).collect());
    channel("slip", "1", held.iter().map(|(at, _)| at.slip).collect());
    channel("camber", "rad", held.iter().map(|(at, _)| at.camber).collect());
    channel("friction_factor", "1", held.iter().map(|(at, _)| at.friction).collect());
    if let Some(deflection) = held.iter().map(|(_, point)| point.deflection).collect() {
        channel("deflection", "m", deflection);
    }
    for (i, axis) in ["x", "y", "z"].iter().enumerate() {
        channel(&format!("force_{axis}"), "N", held.iter().map(|(_, point)| point.force[i]).collect());
    }
    for (i, axis) in ["x", "y", "z"].iter().enumerate() {
        channel(&format!("moment_{axis}"), "N.m", held.iter().map(|(_, point)| point.moment[i]).collect());
    }
    let time = (0..held.len()).map(|k| k as f64).collect();
    let source = format!("{}, {}: stationary states, one a second", tire.name, curve.kind.name());
    Recording { time, channels, source }
}

/// Letters, digits, points, hyphens and underscores of a name.
fn file_name(name: &str) -> String {
    name.chars().map(|c| if c.is_ascii_alphanumeric() || "._-".contains(c) { c } else { '_' }).collect()
}
