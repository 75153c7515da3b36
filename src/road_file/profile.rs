//! The road that all formats become and come from.

use crate::recording::points_from_csv;
use crate::road::{MAX_POINTS, Road, RoadParameters};
use crate::{Error, Result};
use std::fmt::Write as _;
use std::path::Path;

/// The most points of a track that are read: a hundred kilometres in steps of a centimetre. Models take [`MAX_POINTS`].
pub const MAX_POINTS_READ: usize = 10_000_000;

/// The least distance of two points that make no vertical edge, and the largest coordinate \[m\], as roads of models have them.
pub(super) const LEAST_DISTANCE: f64 = 1e-5;
pub(super) const LARGEST_PLACE: f64 = 1e6;

/// Heights along one or two tracks, straight lines between points, level before the first and behind the last. Two points at the
/// same place are a vertical edge.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct RoadProfile {
    /// The file that it is from, for messages.
    pub source: String,
    /// x and z of the left track, or of both \[m\]; x counts from where the wheel starts.
    pub left: Vec<[f64; 2]>,
    /// Those of the right track if it is another.
    pub right: Option<Vec<[f64; 2]>>,
    /// Distance of the tracks \[m\]; of no consequence where there is one.
    pub track_width: f64,
    /// How far to the left of the place y = 0 the middle between the tracks lies \[m\].
    pub middle: f64,
    /// Angle about z from x to the direction along which the road changes \[rad\].
    pub direction: f64,
    /// Distance from the beginning of an obstacle to that of the next \[m\]; 0: only one.
    pub spacing: f64,
    /// "s factor" \[m, 1\]: from s on the friction is multiplied by the factor.
    pub friction: Vec<[f64; 2]>,
    /// What the file says of the road and this does not: a sentence each.
    pub lost: Vec<String>,
    /// What the file has beside the road, such as a header: a file that is made like it keeps that.
    pub beside: Vec<String>,
    /// What the user should know of how the file was read.
    pub notes: Vec<String>,
}

impl RoadProfile {
    /// A road with these points on both tracks.
    pub fn of(source: &str, points: Vec<[f64; 2]>) -> Self {
        Self { source: source.into(), left: points, track_width: 1.5, ..Self::default() }
    }

    /// The tracks: one, or left and right.
    pub(super) fn tracks(&self) -> impl Iterator<Item = (&'static str, &Vec<[f64; 2]>)> {
        let name = if self.right.is_some() { "left" } else { "road" };
        std::iter::once((name, &self.left)).chain(self.right.iter().map(|right| ("right", right)))
    }

    /// All that the file has and this has not.
    pub fn left_out(&self) -> impl Iterator<Item = &String> {
        self.lost.iter().chain(&self.beside)
    }

    /// Vertical edges: two points at one place with different heights.
    pub fn edges(&self) -> usize {
        let is_edge = |pair: &&[[f64; 2]]| pair[0][0] == pair[1][0] && pair[0][1] != pair[1][1];
        self.tracks().map(|(_, points)| points.windows(2).filter(is_edge).count()).sum()
    }

    /// Leaves out points that lie exactly on the straight line between their neighbours, which changes nothing. Returns how many.
    pub fn thin(&mut self) -> usize {
        let mut gone = 0;
        for points in std::iter::once(&mut self.left).chain(self.right.as_mut()) {
            let before = points.len();
            let mut kept: Vec<[f64; 2]> = Vec::with_capacity(before.min(MAX_POINTS));
            for (i, point) in points.iter().enumerate() {
                let next = points.get(i + 1);
                let between = match (kept.last(), next) {
                    (Some([ax, az]), Some([cx, cz])) => {
                        let [bx, bz] = *point;
                        // an edge keeps both of its points, whatever is level beside it
                        *ax < bx && bx < *cx && (bz - az) * (cx - bx) == (cz - bz) * (bx - ax)
                    }
                    _ => false,
                };
                if !between {
                    kept.push(*point);
                }
            }
            gone += before - kept.len();
            *points = kept;
        }
        gone
    }

    /// Leaves out points as long as no height changes by more than `tolerance` \[m\] at any point that was there. Returns how many.
    pub fn simplify(&mut self, tolerance: f64) -> usize {
        let mut gone = 0;
        for points in std::iter::once(&mut self.left).chain(self.right.as_mut()) {
            let before = points.len();
            *points = simplified(points, tolerance);
            gone += before - points.len();
        }
        gone
    }

    /// Checks that models take the points.
    ///
    /// # Errors
    /// More than [`MAX_POINTS`] on a track, or what [`Road::new`] refuses; the message names the file and what helps.
    pub(super) fn check(&self) -> Result<()> {
        for (track, points) in self.tracks() {
            if points.len() > MAX_POINTS {
                return Err(Error::file(format!(
                    "{}: the {track} track has {} points, and a road of a model takes {MAX_POINTS}, also after points on straight lines are left out; convert the file with --tolerance, for example 0.0005 for half a millimetre, or cut it",
                    self.source,
                    points.len()
                )));
            }
        }
        let mut parameters = RoadParameters::flat();
        parameters.kind = 8;
        parameters.start = 0.0;
        parameters.profile = text(&self.left);
        parameters.profile_right = self.right.as_deref().map(text).unwrap_or_default();
        parameters.spacing = self.spacing;
        Road::new(&parameters).map(|_| ()).map_err(|e| Error::file(format!("{}: {e}", self.source)))
    }

    /// x, height of the left track and of the right one, wherever one of them has a point: straight lines between. Where one has a
    /// vertical edge, two rows have the same x. Points of the right track that lie where the left one has some, but for rounding,
    /// are taken to lie there.
    ///
    /// # Errors
    /// Points of the two tracks that are too close to be two rows and too far apart to be one.
    pub(super) fn rows(&self) -> Result<Vec<[f64; 3]>> {
        let Some(right) = &self.right else {
            return Ok(self.left.iter().map(|[x, z]| [*x, *z, *z]).collect());
        };
        let snapped = |[x, z]: &[f64; 2]| {
            let next = self.left.partition_point(|[at, _]| at < x);
            let near = [next.checked_sub(1), Some(next)].into_iter().flatten();
            let mut places = near.filter_map(|i| self.left.get(i)).map(|[at, _]| *at);
            let place = places.rfind(|at| (at - x).abs() < 1e-3 * LEAST_DISTANCE);
            [place.unwrap_or(*x), *z]
        };
        let right: Vec<[f64; 2]> = right.iter().map(snapped).collect();
        let mut places: Vec<f64> = self.left.iter().chain(&right).map(|[x, _]| *x).collect();
        places.sort_by(f64::total_cmp);
        places.dedup();
        if let Some(pair) = places.windows(2).find(|pair| pair[1] - pair[0] < LEAST_DISTANCE) {
            return Err(Error::file(format!(
                "{}: the left and the right track have points at x = {} m and {} m, less than {LEAST_DISTANCE} m apart; a file with one column of places cannot hold both",
                self.source, pair[0], pair[1]
            )));
        }
        let mut rows = Vec::with_capacity(places.len());
        let mut sides = [Walk::new(&self.left), Walk::new(&right)];
        for x in places {
            let [(left, behind_left), (right, behind_right)] =
                [sides[0].heights_at(x), sides[1].heights_at(x)];
            rows.push([x, left, right]);
            if behind_left != left || behind_right != right {
                rows.push([x, behind_left, behind_right]);
            }
        }
        Ok(rows)
    }
}

/// Heights of a track at places that increase.
pub(super) struct Walk<'a> {
    points: &'a [[f64; 2]],
    /// The first point that is not before the last place.
    next: usize,
}

impl<'a> Walk<'a> {
    pub(super) fn new(points: &'a [[f64; 2]]) -> Self {
        Self { points, next: 0 }
    }

    /// The heights before and behind x.
    pub(super) fn heights_at(&mut self, x: f64) -> (f64, f64) {
        while self.points.get(self.next).is_some_and(|[at, _]| *at < x) {
            self.next += 1;
        }
        let last = self.points.last().map_or(0.0, |[_, z]| *z);
        let Some([at, z]) = self.points.get(self.next).copied() else { return (last, last) };
        if at == x {
            let behind = match self.points.get(self.next + 1) {
                Some([after, behind]) if *after == x => *behind,
                _ => z,
            };
            return (z, behind);
        }
        match self.next.checked_sub(1).and_then(|i| self.points.get(i)) {
            None => (z, z),
            Some([from, low]) => {
                let height = low + (z - low) * ((x - from) / (at - from));
                (height, height)
            }
        }
    }
}

/// Points "x z; x z" in the shortest form that is read as the same numbers.
pub(super) fn text(points: &[[f64; 2]]) -> String {
    let mut text = String::with_capacity(points.len() * 16);
    for (i, [x, z]) in points.iter().enumerate() {
        let _ = write!(text, "{}{x} {z}", if i == 0 { "" } else { "; " });
    }
    text
}

/// Makes points of numbers that were read, each with its line, or with its number where lines are none.
///
/// # Errors
/// No point, or too many; a place that comes before the last one, a third point at a place, points so close that they are
/// neither an edge nor two, a place that is too far away. The message has the line and `block`.
pub(super) fn checked(
    source: &str,
    block: &str,
    what: &str,
    points: &[(usize, [f64; 2])],
) -> Result<Vec<[f64; 2]>> {
    let fail = |line: usize, text: String| Err(Error::file(format!("{source}:{line}: {block}: {text}")));
    if points.is_empty() {
        return Err(Error::file(format!(
            "{source}: {block} has no points; a {what} is a place and a height"
        )));
    }
    for (line, [x, z]) in points {
        if !(x.abs() <= LARGEST_PLACE && z.abs() <= LARGEST_PLACE) {
            return fail(*line, format!("x = {x} m, z = {z} m: roads go to {LARGEST_PLACE} m"));
        }
    }
    for (i, pair) in points.windows(2).enumerate() {
        let [(_, [before, _]), (line, [x, _])] = pair else { continue };
        if x < before {
            return fail(
                *line,
                format!("x = {x} m comes after {before} m: the road folds back, x must not decrease"),
            );
        }
        if x > before && x - before < LEAST_DISTANCE {
            return fail(
                *line,
                format!(
                    "x = {x} m is {:e} m behind the point before, neither a piece of road nor a vertical edge; for one write the same x, or leave the point out",
                    x - before
                ),
            );
        }
        if x == before && i > 0 && points.get(i - 1).is_some_and(|(_, [other, _])| other == x) {
            return fail(*line, format!("a third point at x = {x} m; a vertical edge has two"));
        }
    }
    Ok(points.iter().map(|(_, point)| *point).collect())
}

/// The longest straight lines from point to point that stay within `tolerance` of all points between; edges stay.
fn simplified(points: &[[f64; 2]], tolerance: f64) -> Vec<[f64; 2]> {
    let mut kept: Vec<[f64; 2]> = Vec::new();
    let mut i = 0;
    while let Some([x, z]) = points.get(i).copied() {
        kept.push([x, z]);
        // slopes with which a line from here passes all points so far
        let (mut low, mut high) = (f64::NEG_INFINITY, f64::INFINITY);
        let mut to = i + 1;
        let mut reached = i + 1;
        while let Some([at, height]) = points.get(to).copied() {
            if at == x {
                reached = to;
                break;
            }
            let slope = (height - z) / (at - x);
            if slope < low || slope > high {
                break;
            }
            reached = to;
            low = low.max((height - tolerance - z) / (at - x));
            high = high.min((height + tolerance - z) / (at - x));
            // nothing goes over a vertical edge
            if points.get(to + 1).is_some_and(|[after, _]| *after == at) {
                break;
            }
            to += 1;
        }
        i = reached;
    }
    kept
}

pub(super) fn read_csv(path: &Path) -> Result<RoadProfile> {
    let source = path.display().to_string();
    let (x, left, right) = points_from_csv(path)?;
    // a header line, then a row a line
    let points = |z: &[f64]| -> Vec<(usize, [f64; 2])> {
        x.iter().zip(z).enumerate().map(|(i, (x, z))| (i + 2, [*x, *z])).collect()
    };
    let mut road = RoadProfile::of(&source, checked(&source, "columns x, z", "row", &points(&left))?);
    if let Some(right) = right {
        road.right = Some(checked(&source, "columns x, z_right", "row", &points(&right))?);
        road.notes.push(format!(
            "{source}: the distance of the tracks is not in the file; it is taken as {} m",
            road.track_width
        ));
    }
    Ok(road)
}

pub(super) fn write_csv(road: &RoadProfile) -> Result<(Vec<u8>, Vec<String>)> {
    let two = road.right.is_some();
    let mut text = String::from(if two { "x [m],z [m],z_right [m]\n" } else { "x [m],z [m]\n" });
    for [x, left, right] in road.rows()? {
        let _ = match two {
            true => writeln!(text, "{x},{left},{right}"),
            false => writeln!(text, "{x},{left}"),
        };
    }
    let mut lost = beyond_points(road, "CSV");
    if two {
        lost.push(format!("the distance of the tracks, {} m: CSV has no place for it", road.track_width));
    }
    Ok((text.into_bytes(), lost))
}

/// What of a road is more than points, for a format that has points only.
pub(super) fn beyond_points(road: &RoadProfile, format: &str) -> Vec<String> {
    let mut lost = Vec::new();
    if road.spacing != 0.0 {
        lost.push(format!("the repetition every {} m: {format} has the obstacle once", road.spacing));
    }
    if road.direction != 0.0 {
        lost.push(format!("the direction of {} rad: {format} has a road along x", road.direction));
    }
    if !road.friction.is_empty() {
        lost.push(format!("the friction factor: {format} has heights only"));
    }
    if road.right.is_some() && road.middle != 0.0 {
        lost.push(format!("the lateral position of the tracks' middle, {} m", road.middle));
    }
    lost
}
