//! OpenCRG as text of double length.

use crate::road_file::profile::{RoadProfile, Walk, beyond_points};
use crate::{Error, Result};
use std::fmt::Write as _;

/// The most cross sections that are written.
const MAX_SECTIONS: f64 = 5e6;
/// Half the width of a road of one track \[m\].
const HALF_WIDTH: f64 = 1.0;

/// The file, and what it does not hold. `increment` is the step along the road \[m\]; without one, the one in which all points
/// lie.
///
/// # Errors
/// Points that lie in no common step, without an increment; more cross sections than can be written.
pub(in crate::road_file) fn write(
    road: &RoadProfile,
    increment: Option<f64>,
) -> Result<(Vec<u8>, Vec<String>)> {
    let fail = |what: String| Err(Error::call(format!("{}: {what}", road.source)));
    let places: Vec<f64> = road.tracks().flat_map(|(_, points)| points.iter().map(|[x, _]| *x)).collect();
    let first = places.iter().copied().fold(f64::INFINITY, f64::min);
    let last = places.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let step = match increment {
        Some(step) if step.is_nan() || step <= 1e-6 => {
            return fail(format!("--increment = {step} m has to be above 0"));
        }
        Some(step) => step,
        None => match common_step(&places, first) {
            Some(step) => step,
            None => {
                return fail(
                    "its points lie in no common step along the road, and OpenCRG has one; give it with --increment, for example 0.01".into(),
                );
            }
        },
    };
    let steps = ((last - first) / step - 1e-6).ceil().max(1.0);
    if steps > MAX_SECTIONS {
        return fail(format!(
            "{steps} steps of {step} m are more than are written; give a larger --increment"
        ));
    }
    let (right, left) = match &road.right {
        Some(_) => (road.middle - 0.5 * road.track_width, road.middle + 0.5 * road.track_width),
        None => (-HALF_WIDTH, HALF_WIDTH),
    };
    let end = first + steps * step;
    let mut text = String::from("$CT\nRoad of one or two tracks, straight and level across beyond them\n$\n");
    let _ = write!(
        text,
        "$ROAD_CRG\nREFERENCE_LINE_START_U = {first}\nREFERENCE_LINE_END_U = {end}\nREFERENCE_LINE_INCREMENT = {step}\nLONG_SECTION_V_RIGHT = {right}\nLONG_SECTION_V_LEFT = {left}\n$\n$KD_Definition\n#:LDFI\nU:reference line u,m,{first},{step}\nD:long section at v = {right},m\nD:long section at v = {left},m\n$\n"
    );
    let _ = writeln!(text, "{}", "$".repeat(72));
    // the right one first, as its position is the smaller one
    let tracks = [road.right.as_ref().unwrap_or(&road.left), &road.left];
    let mut walks = tracks.map(|points| Walk::new(points));
    let mut written: [Vec<[f64; 2]>; 2] = [Vec::new(), Vec::new()];
    for i in 0..=steps as usize {
        let x = first + i as f64 * step;
        // where a point lies on the step, rounding must not find the straight line beside it
        let x = tracks.iter().find_map(|points| nearest(points, x, step * 1e-7)).unwrap_or(x);
        for (walk, written) in walks.iter_mut().zip(&mut written) {
            let (_, height) = walk.heights_at(x);
            let field = field(height)?;
            written.push([x, field.trim().parse().unwrap_or(height)]);
            text += &field;
        }
        text.push('\n');
    }
    let mut lost = beyond_points(road, "OpenCRG here");
    if first != 0.0 {
        lost.push(format!(
            "where the wheel starts, x = 0: the first point at x = {first} m is u = {first} m of the file, and who takes where u begins for x = 0, as latsch does, has the road {} m {}",
            first.abs(),
            if first < 0.0 { "farther ahead" } else { "nearer" }
        ));
    }
    let off = tracks
        .iter()
        .zip(&written)
        .flat_map(|(points, written)| {
            let mut walk = Walk::new(written);
            points.iter().map(move |[x, z]| (walk.heights_at(*x).0 - z).abs()).collect::<Vec<_>>()
        })
        .fold(0.0, f64::max);
    if off > 0.0 {
        lost.push(format!(
            "points between steps of {step} m, and digits beyond a field: heights are off by up to {off:e} m where the road has a point"
        ));
    }
    let edges = road.edges();
    if edges > 0 {
        lost.push(format!("{edges} vertical edges: they rise over a step of {step} m"));
    }
    Ok((text.into_bytes(), lost))
}

/// The largest step in which all places lie, if it is not too small.
fn common_step(places: &[f64], first: f64) -> Option<f64> {
    let mut sorted: Vec<f64> = places.to_vec();
    sorted.sort_by(f64::total_cmp);
    let least = sorted
        .windows(2)
        .map(|pair| pair[1] - pair[0])
        .filter(|gap| *gap > 1e-6)
        .fold(f64::INFINITY, f64::min);
    let range = sorted.last()? - first;
    // the round number first: differences of places have lost their last digits
    let candidates = (1..=20).flat_map(|part| {
        let step = least / f64::from(part);
        [(step * 1e9).round() / 1e9, step]
    });
    candidates.filter(|step| *step > 1e-6).find(|step| {
        range / step < MAX_SECTIONS
            && sorted.iter().all(|x| {
                let count = (x - first) / step;
                (count - count.round()).abs() < 1e-7
            })
    })
}

/// The place of a point within `reach` of x, if there is one.
fn nearest(points: &[[f64; 2]], x: f64, reach: f64) -> Option<f64> {
    let next = points.partition_point(|[place, _]| *place < x - reach);
    points.get(next).map(|[place, _]| *place).filter(|place| (place - x).abs() <= reach)
}

/// A number in 20 characters, with as many digits as fit; the first one is a blank or a sign.
fn field(value: f64) -> Result<String> {
    let shortest = format!("{value}");
    if shortest.len() <= 19 {
        return Ok(format!("{shortest:>20}"));
    }
    (0..=16)
        .rev()
        .flat_map(|digits| [format!("{value:.digits$}"), format!("{value:.digits$e}")])
        .chain([format!("{value:e}")])
        .filter(|text| text.len() <= 19 && text.parse::<f64>().is_ok())
        .min_by(|a, b| {
            let off = |text: &String| (text.parse::<f64>().unwrap_or(f64::INFINITY) - value).abs();
            off(a).total_cmp(&off(b)).then(a.len().cmp(&b.len()))
        })
        .map(|text| format!("{text:>20}"))
        .ok_or_else(|| Error::call(format!("{value} cannot be written in 20 characters")))
}
