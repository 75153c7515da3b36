//! Two-dimensional roads of Adams (`METHOD = '2D'`), as its manual and those of other programs that read them describe the keys.

use super::profile::{LARGEST_PLACE, RoadProfile, beyond_points, checked};
use super::rdf::{File, beside_the_road, missing};
use crate::tir::{number_text, shown};
use crate::{Error, Result};
use std::f64::consts::TAU;
use std::fmt::Write as _;

/// Straight pieces that stand for a wave: off by 1 - cos(pi / pieces) of the amplitude, 0.012 %.
const PIECES: u32 = 200;

/// A length of `[PARAMETERS]` in m.
fn length_of(file: &File, key: &str) -> Result<f64> {
    parameter(file, key).map(|value| file.metres(value))
}

/// A number of `[PARAMETERS]` as it stands there.
fn parameter(file: &File, key: &str) -> Result<f64> {
    file.number("PARAMETERS", key)?.ok_or_else(|| missing(&file.document, "PARAMETERS", key, "a number"))
}

fn optional(file: &File, key: &str, unit: f64) -> Result<f64> {
    Ok(file.number("PARAMETERS", key)?.unwrap_or(0.0) * unit)
}

/// The road of a file.
pub(super) fn read(file: &File) -> Result<RoadProfile> {
    let name = file.name();
    let refuse = |why: &str| {
        Err(Error::file(format!(
            "{}: ROAD_TYPE is '{}': {why}",
            file.document.place(file.type_line),
            shown(file.road_type.as_bytes())
        )))
    };
    let line = file.type_line;
    let mut road = RoadProfile::of(name, Vec::new());
    let mut spacing = 0.0;
    let mut keys = vec!["OFFSET", "ROTATION_ANGLE_XY_PLANE", "MU"];
    let points: Vec<[f64; 2]> = match file.road_type.as_str() {
        "flat" => vec![[0.0, 0.0], [1.0, 0.0]],
        "plank" | "cleat" => {
            keys.extend([
                "HEIGHT",
                "START",
                "LENGTH",
                "BEVEL_EDGE_LENGTH",
                "DIRECTION",
                "EDGE_ROUNDED",
                "MU_FACTOR_CLEAT",
            ]);
            let (height, start, long) =
                (length_of(file, "HEIGHT")?, length_of(file, "START")?, length_of(file, "LENGTH")?);
            let bevel = file.metres(optional(file, "BEVEL_EDGE_LENGTH", 1.0)?);
            if long <= 0.0 || bevel < 0.0 || 2.0 * bevel > long || bevel > height.abs() {
                return Err(Error::file(format!(
                    "{name}: [PARAMETERS] a plank of LENGTH {long} m and HEIGHT {height} m with bevels of {bevel} m cannot be: LENGTH has to be above 0 and hold two bevels, and these go no higher than it is"
                )));
            }
            if optional(file, "EDGE_ROUNDED", 1.0)? != 0.0 && bevel > 0.0 {
                road.lost.push(
                    "EDGE_ROUNDED: the rounded edges of the plank have become bevels of 45 degrees".into(),
                );
            }
            if !matches!(file.number("PARAMETERS", "MU_FACTOR_CLEAT")?, None | Some(1.0)) {
                road.lost.push("MU_FACTOR_CLEAT: the friction on the plank".into());
            }
            oblique(file, &mut road)?;
            let start = start * road.direction.cos();
            let side = height - bevel.copysign(height);
            let mut points = vec![[start, 0.0], [start, side], [start + bevel, height]];
            points.extend([[start + long - bevel, height], [start + long, side], [start + long, 0.0]]);
            points.dedup();
            points
        }
        "poly_line" => {
            let rows = file.table("PARAMETERS", "XZ_DATA", 2, 3)?;
            if rows.is_empty() {
                return Err(Error::file(format!(
                    "{name}: [PARAMETERS] has no rows under (XZ_DATA); a row is x z_left z_right"
                )));
            }
            let column = |i: usize| -> Vec<(usize, [f64; 2])> {
                let one = |(line, row): &(usize, Vec<f64>)| {
                    let z = row.get(i).or(row.get(1)).copied().unwrap_or(f64::NAN);
                    (*line, [file.metres(row.first().copied().unwrap_or(f64::NAN)), file.metres(z)])
                };
                rows.iter().map(one).collect()
            };
            let left = checked(name, "[PARAMETERS] (XZ_DATA)", "row x z_left z_right", &column(1))?;
            let right = checked(name, "[PARAMETERS] (XZ_DATA)", "row x z_left z_right", &column(2))?;
            if left != right {
                road.right = Some(right);
                road.notes.push(format!(
                    "{name}: the distance of the tracks is not in the file; it is taken as {} m",
                    road.track_width
                ));
            }
            left
        }
        "pot_hole" | "pothole" => {
            keys.extend(["DEPTH", "START", "LENGTH", "DIRECTION"]);
            let (depth, start, long) =
                (length_of(file, "DEPTH")?, length_of(file, "START")?, length_of(file, "LENGTH")?);
            positive(file, "LENGTH", long)?;
            oblique(file, &mut road)?;
            road.notes.push(format!(
                "{name}: DEPTH = {depth} m is taken as the depth of a hole, negative of a bump; programs differ in the sign"
            ));
            let start = start * road.direction.cos();
            vec![[start, 0.0], [start, -depth], [start + long, -depth], [start + long, 0.0]]
        }
        "ramp" => {
            keys.extend(["HEIGHT", "START", "SLOPE"]);
            let (height, start) = (length_of(file, "HEIGHT")?, length_of(file, "START")?);
            let slope = parameter(file, "SLOPE")?;
            if slope == 0.0
                || height == 0.0
                || slope.signum() != height.signum() && slope < 0.0 && height > 0.0
            {
                return Err(Error::file(format!(
                    "{name}: [PARAMETERS] a ramp with HEIGHT = {height} m and SLOPE = {slope} goes nowhere; SLOPE is height over length, 1 for 45 degrees"
                )));
            }
            road.notes.push(format!("{name}: SLOPE = {slope} is height over length, 1 for 45 degrees"));
            vec![[start, 0.0], [start + (height / slope).abs(), height]]
        }
        "roof" => {
            keys.extend(["HEIGHT", "START", "LENGTH"]);
            let (height, start, long) =
                (length_of(file, "HEIGHT")?, length_of(file, "START")?, length_of(file, "LENGTH")?);
            positive(file, "LENGTH", long)?;
            vec![[start, 0.0], [start + 0.5 * long, height], [start + long, 0.0]]
        }
        "sine" => {
            keys.extend(["AMPLITUDE", "WAVE_LENGTH", "START", "LENGTH"]);
            let (amplitude, wave, start) =
                (length_of(file, "AMPLITUDE")?, length_of(file, "WAVE_LENGTH")?, length_of(file, "START")?);
            positive(file, "WAVE_LENGTH", wave)?;
            if wave < 0.1 {
                return refuse("waves shorter than 0.1 m are not made of straight pieces here");
            }
            road.notes.push(format!(
                "{name}: the wave is AMPLITUDE sin(2 pi (x - START) / WAVE_LENGTH), made of {PIECES} straight pieces: off by at most {:e} m",
                amplitude.abs() * (1.0 - (0.5 * TAU / f64::from(PIECES)).cos())
            ));
            let height = |i: u32| match i % PIECES {
                0 => 0.0,
                i => amplitude * (TAU * f64::from(i) / f64::from(PIECES)).sin(),
            };
            let waves = match file.number("PARAMETERS", "LENGTH")? {
                None => {
                    spacing = wave;
                    1
                }
                Some(total) => {
                    let count = file.metres(total) / wave;
                    if !(count >= 0.5 && (count - count.round()).abs() < 1e-6 && count < 90.0) {
                        return refuse(
                            "LENGTH is read where it is a whole number of waves, 1 to 90; leave it out for waves without end",
                        );
                    }
                    count.round() as u32
                }
            };
            (0..=waves * PIECES)
                .map(|i| [start + wave * f64::from(i) / f64::from(PIECES), height(i)])
                .collect()
        }
        "drum" | "flatbelt" | "hydraulic_test_rig" | "hydropulse" => {
            return refuse("that is a rig and no road; take a model of such a rig");
        }
        "sine_sweep" | "sweep" => {
            return refuse(
                "a sweep is not read: programs differ in how its wavelength goes; give its points as poly_line",
            );
        }
        "stochastic_uneven" => {
            return refuse(
                "such a road is made by the other program's own random numbers, so no other program has the same; take road_kind = iso_8608, or let that program write its points as poly_line",
            );
        }
        _ => {
            return refuse("read are flat, plank, poly_line, pot_hole, ramp, roof and sine");
        }
    };
    let up = file.metres(optional(file, "OFFSET", 1.0)?);
    let raise = |points: Vec<[f64; 2]>| -> Result<Vec<[f64; 2]>> {
        let raised: Vec<(usize, [f64; 2])> = points.into_iter().map(|[x, z]| (line, [x, z + up])).collect();
        checked(name, "[PARAMETERS]", "road", &raised)
    };
    road.left = raise(points)?;
    road.right = road.right.take().map(raise).transpose()?;
    road.spacing = spacing;
    if let Some(mu) = file.number("PARAMETERS", "MU")?
        && mu != 1.0
    {
        if mu < 0.0 {
            return Err(Error::file(format!("{name}: [PARAMETERS] MU = {mu} must not be negative")));
        }
        road.friction = vec![[-LARGEST_PLACE, mu]];
    }
    let turned = optional(file, "ROTATION_ANGLE_XY_PLANE", file.units.angle)?;
    if turned != 0.0 {
        road.lost.push(format!(
            "ROTATION_ANGLE_XY_PLANE of {turned} rad: it turns the road into the direction in which the other program's vehicle travels; models travel along x, and the road lies along it"
        ));
    }
    let unknown: Vec<String> = file
        .document
        .entries()
        .filter(|e| e.section == "PARAMETERS" && !keys.contains(&e.key))
        .map(|e| e.key.to_string())
        .take(20)
        .collect();
    if !unknown.is_empty() {
        road.lost.push(format!("keys of [PARAMETERS] that this road does not use: {}", unknown.join(", ")));
    }
    beside_the_road(file, &["PARAMETERS"], &["METHOD", "FUNCTION_NAME", "ROAD_TYPE"], &mut road);
    Ok(road)
}

/// An obstacle across the road or at an angle to that.
fn oblique(file: &File, road: &mut RoadProfile) -> Result<()> {
    let angle = optional(file, "DIRECTION", file.units.angle)?;
    if angle.abs() >= 1.5 {
        return Err(Error::file(format!(
            "{}: [PARAMETERS] DIRECTION = {angle} rad: an obstacle along the road is no profile",
            file.name()
        )));
    }
    if angle != 0.0 {
        road.direction = angle;
        road.notes.push(format!(
            "{}: DIRECTION turns the obstacle about z where it meets y = 0; LENGTH is taken across its edge",
            file.name()
        ));
    }
    Ok(())
}

fn positive(file: &File, key: &str, value: f64) -> Result<()> {
    match value > 0.0 {
        true => Ok(()),
        false => {
            Err(Error::file(format!("{}: [PARAMETERS] {key} = {value} m has to be above 0", file.name())))
        }
    }
}

/// `MU`, which holds everywhere, of a friction that begins and changes at places, and what it does not say of that.
fn one_friction(steps: &[[f64; 2]]) -> (f64, Option<String>) {
    let Some([from, factor]) = steps.first().copied() else { return (1.0, None) };
    if steps.iter().any(|[_, other]| *other != factor) {
        let lost = "the friction factor, which changes along the road: MU is one number for all of it, and 1 is written";
        return (1.0, Some(lost.into()));
    }
    // before the first place it is 1
    if factor == 1.0 || from <= -LARGEST_PLACE {
        (factor, None)
    } else if from <= 0.0 {
        // all that a wheel meets on its way forward
        (
            factor,
            Some(format!(
                "where the friction factor {factor} begins, at {from} m: MU holds before that, too"
            )),
        )
    } else {
        let lost = format!(
            "the friction factor {factor} from {from} m on: MU is one number for all of the road, and 1 is written"
        );
        (1.0, Some(lost))
    }
}

/// A road as `poly_line`.
///
/// # Errors
/// Of [`RoadProfile::rows`].
pub(super) fn write(road: &RoadProfile) -> Result<(Vec<u8>, Vec<String>)> {
    let text_of = |x: f64| number_text(x).unwrap_or_default();
    let mut text =
        String::from("[MDI_HEADER]\n FILE_TYPE    = 'rdf'\n FILE_VERSION = 5.00\n FILE_FORMAT  = 'ASCII'\n");
    text += "[UNITS]\n LENGTH = 'meter'\n FORCE  = 'newton'\n ANGLE  = 'radian'\n MASS   = 'kg'\n TIME   = 'sec'\n";
    text += "[MODEL]\n METHOD        = '2D'\n FUNCTION_NAME = 'ARC901'\n ROAD_TYPE     = 'poly_line'\n";
    text += "[PARAMETERS]\n OFFSET                  = 0.0\n ROTATION_ANGLE_XY_PLANE = 0.0\n";
    let (mu, friction_lost) = one_friction(&road.friction);
    let _ = writeln!(text, " MU                      = {}", text_of(mu));
    text += "(XZ_DATA)\n{ x z_left z_right }\n";
    for [x, left, right] in road.rows()? {
        let _ = writeln!(text, " {} {} {}", text_of(x), text_of(left), text_of(right));
    }
    let mut points_only = road.clone();
    points_only.friction.clear();
    let mut lost = beyond_points(&points_only, "poly_line");
    lost.extend(friction_lost);
    if road.right.is_some() {
        lost.push(format!(
            "the distance of the tracks, {} m: such a file has no key for it",
            road.track_width
        ));
    }
    if road.edges() > 0 {
        lost.push("nothing of the vertical edges, which are two rows with the same x; but a program that asks for rising x refuses them".into());
    }
    Ok((text.into_bytes(), lost))
}
