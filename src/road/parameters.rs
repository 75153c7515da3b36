//! The parameters of a road, as the variable tables of rigs have them.

use super::polyline::shortest_period;
use super::text::pairs;
use crate::{Error, Result, clone_in_place};
use serde::{Deserialize, Serialize};

/// The kinds of road, as items of an enumeration: name and description.
pub const KINDS: &[(&str, &str)] = &[
    ("flat", "level, at height 0"),
    ("step", "up by road_height, down if that is negative"),
    ("ramp", "up by road_height over road_length, level behind it"),
    (
        "cleat",
        "road_height high, road_length long, edges bevelled by road_bevel; repeated every road_spacing",
    ),
    ("sine", "waves of wavelength road_length, road_height from valley to peak, begun in a valley"),
    ("iso_8608", "irregular road of ISO 8608 with road_roughness and road_seed"),
    (
        "slabs",
        "each rises by road_height over road_length and ends in a vertical drop; repeated every road_spacing, or without gap",
    ),
    ("profile", "the points of road_profile; repeated every road_spacing"),
];

/// The most points that a profile or a friction factor may have.
pub const MAX_POINTS: usize = 20_000;

/// The least distance of a profile's points \[m\], unless they make a vertical edge.
const LEAST_DISTANCE: f64 = 1e-5;
/// The largest coordinate in a text \[m\].
const LARGEST_PLACE: f64 = 1e6;

/// What a road is made from. Parameters that a kind does not mention are not used by it.
#[derive(Debug, PartialEq, Serialize, Deserialize)]
pub struct RoadParameters {
    /// `road_kind`: the kind, from 1 = flat in the order of [`KINDS`].
    pub kind: i32,
    /// `road_start`: the road is level up to this place \[m\], 5, -1e6 to 1e6.
    pub start: f64,
    /// `road_height`: height of the obstacle over the level road before it \[m\], 0.01, -1 to 1; negative:
    /// depth. For a sine it is twice the amplitude.
    pub height: f64,
    /// `road_length`: length along s \[m\], 0.1, 1e-3 to 1e4: of the ramp, of the cleat at its foot, of a
    /// slab, of a wave.
    pub length: f64,
    /// `road_bevel`: width = height of a cleat's bevels, 45 degrees \[m\], 0, 0 to 1. Their faces are sqrt(2)
    /// times as long.
    pub bevel: f64,
    /// `road_spacing`: distance from the beginning of an obstacle to that of the next \[m\], 0, 0 to 1e4; 0:
    /// only one, but slabs join.
    pub spacing: f64,
    /// `road_roughness`: displacement PSD Gd(n0) at n0 = 0.1 cycles/m \[m³\], 64e-6, 0 to 1. Geometric means
    /// of the classes of ISO 8608, 1e-6 m³: A 16, B 64, C 256, D 1024, E 4096, F 16384, G 65536, H 262144.
    /// The standard fits the law from 0.011 to 2.83 cycles/m; here it goes from 0.01 to 10.24.
    pub roughness: f64,
    /// `road_seed`: number of the realisation, 1, any.
    pub seed: i32,
    /// `road_direction`: angle from x to the direction s of the road, about z \[rad\], 0, -2 pi to 2 pi. A cleat
    /// across the path of a wheel that travels along x lies at 0, an oblique one at 45 degrees.
    pub direction: f64,
    /// `road_filter_length`: length of the contact that bridges edges, L of the filter \[m\], 0.1, 0.01 to 2.
    pub filter_length: f64,
    /// `road_profile`: "x z; x z; ..." \[m\]: points with straight lines between them, x counted from `start`;
    /// two points with the same x are a vertical edge. Level before the first and behind the last point.
    pub profile: String,
    /// `road_friction`: "s mu; s mu; ..." \[m, 1\]: from s on (not counted from `start`) the factor on the
    /// friction coefficients is mu; 1 before the first.
    pub friction: String,
}

clone_in_place!(RoadParameters {
    kind,
    start,
    height,
    length,
    bevel,
    spacing,
    roughness,
    seed,
    direction,
    filter_length,
    profile,
    friction,
});

impl Default for RoadParameters {
    /// A flat road.
    fn default() -> Self {
        Self {
            kind: 1,
            start: 5.0,
            height: 0.01,
            length: 0.1,
            bevel: 0.0,
            spacing: 0.0,
            roughness: 64e-6,
            seed: 1,
            direction: 0.0,
            filter_length: 0.1,
            profile: String::new(),
            friction: String::new(),
        }
    }
}

impl RoadParameters {
    /// Checks what a kind needs of single parameters.
    pub(super) fn check(&self) -> Result<()> {
        let fail = |message: String| Err(Error::variable(message));
        let finite = [
            ("start", self.start),
            ("height", self.height),
            ("length", self.length),
            ("bevel", self.bevel),
            ("spacing", self.spacing),
            ("roughness", self.roughness),
            ("direction", self.direction),
            ("filter_length", self.filter_length),
        ];
        if let Some((name, value)) = finite.iter().find(|(_, value)| !value.is_finite()) {
            return fail(format!("road_{name} = {value} has to be a finite number"));
        }
        if !(1..=KINDS.len() as i32).contains(&self.kind) {
            let kinds: Vec<_> =
                KINDS.iter().enumerate().map(|(i, (name, _))| format!("{} {name}", i + 1)).collect();
            return fail(format!("road_kind = {} is none of {}", self.kind, kinds.join(", ")));
        }
        if self.filter_length < 1e-3 {
            return fail(format!(
                "road_filter_length = {} m has to be at least 0.001 m: it is the length of the contact",
                self.filter_length
            ));
        }
        if matches!(self.kind, 3 | 4 | 5 | 7) && self.length < 1e-3 {
            return fail(format!("road_length = {} m has to be at least 0.001 m", self.length));
        }
        if self.kind == 4 && !(0.0 <= self.bevel && self.bevel <= self.height.abs()) {
            return fail(format!(
                "road_bevel = {} m has to be from 0 to the cleat's road_height, {} m",
                self.bevel, self.height
            ));
        }
        if self.kind == 4 && 2.0 * self.bevel > self.length {
            return fail(format!(
                "two bevels of road_bevel = {} m do not fit on a cleat of road_length = {} m",
                self.bevel, self.length
            ));
        }
        if self.kind == 6 && self.roughness < 0.0 {
            return fail(format!("road_roughness = {} m3 must not be negative", self.roughness));
        }
        Ok(())
    }

    /// The points of a road that consists of straight pieces.
    pub(super) fn points(&self) -> Result<Vec<[f64; 2]>> {
        let (h, l, b) = (self.height, self.length, self.bevel);
        Ok(match self.kind {
            2 => vec![[0.0, 0.0], [0.0, h]],
            3 => vec![[0.0, 0.0], [l, h]],
            4 => {
                let side = h - b.copysign(h);
                vec![[0.0, 0.0], [0.0, side], [b, h], [l - b, h], [l, side], [l, 0.0]]
            }
            7 => vec![[0.0, 0.0], [l, h], [l, 0.0]],
            8 => self.profile_points()?,
            _ => Vec::new(),
        })
    }

    fn profile_points(&self) -> Result<Vec<[f64; 2]>> {
        let points = pairs("road_profile", &self.profile, LARGEST_PLACE)?;
        let fail = |message: String| Err(Error::variable(format!("road_profile: {message}")));
        if points.is_empty() {
            return fail("a road of kind profile needs points, \"x z; x z; ...\" in m".into());
        }
        if points.len() > MAX_POINTS {
            return fail(format!("{} points are more than {MAX_POINTS}", points.len()));
        }
        for (i, pair) in points.windows(2).enumerate() {
            let ([before, _], [x, _], number) = (pair[0], pair[1], i + 2);
            if x < before {
                return fail(format!("pair {number}: x = {x} m comes after {before} m; x must not decrease"));
            }
            if x > before && x - before < LEAST_DISTANCE {
                return fail(format!(
                    "pair {number}: x = {x} m is less than {LEAST_DISTANCE} m behind the point before; for a vertical edge write the same x"
                ));
            }
            if x == before && i > 0 && points[i - 1][0] == x {
                return fail(format!("pair {number}: a third point at x = {x} m; a vertical edge has two"));
            }
        }
        Ok(points)
    }

    /// Distance of repeated obstacles, if they are repeated.
    pub(super) fn period(&self) -> Result<Option<f64>> {
        let fail = |message: String| Err(Error::variable(message));
        let spacing = if self.kind == 7 && self.spacing == 0.0 { self.length } else { self.spacing };
        let points = self.points()?;
        let (Some(first), Some(last)) = (points.first(), points.last()) else { return Ok(None) };
        if spacing == 0.0 {
            return Ok(None);
        }
        if first[1] != last[1] {
            return fail(format!(
                "road_spacing = {spacing} m: a road that ends {} m above its beginning cannot be repeated; set road_spacing to 0",
                last[1] - first[1]
            ));
        }
        let least = (last[0] - first[0]).max(shortest_period(self.filter_length));
        if spacing < least {
            return fail(format!(
                "road_spacing = {spacing} m has to be 0 or at least {least} m: the next obstacle begins behind this one"
            ));
        }
        Ok(Some(spacing))
    }

    /// The steps of the friction factor.
    pub(super) fn friction_steps(&self) -> Result<Vec<[f64; 2]>> {
        let steps = pairs("road_friction", &self.friction, LARGEST_PLACE)?;
        let fail = |i: usize, message: String| {
            Err(Error::variable(format!("road_friction: pair {}: {message}", i + 1)))
        };
        if steps.len() > MAX_POINTS {
            return fail(MAX_POINTS, format!("there are more than {MAX_POINTS} pairs"));
        }
        for (i, [s, factor]) in steps.iter().enumerate() {
            if *factor < 0.0 {
                return fail(i, format!("the friction factor {factor} must not be negative"));
            }
            if i > 0 && *s <= steps[i - 1][0] {
                return fail(i, format!("s = {s} m comes after {} m; s has to increase", steps[i - 1][0]));
            }
        }
        Ok(steps)
    }
}
