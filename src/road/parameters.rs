//! The parameters of a road, as the variable tables of rigs have them.

use super::friction::{Friction, LARGEST_DEVIATION, Patches, Variation};
use crate::model::groups;
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

/// Where the kind of road lies, as items of an enumeration: name and description.
pub const TRACKS: &[(&str, &str)] = &[
    ("both", "on both tracks"),
    ("left", "on the left track, y > 0; the right one is level, at height 0"),
    ("right", "on the right track, y < 0; the left one is level, at height 0"),
];

/// The most points that a profile or a friction factor may have.
pub const MAX_POINTS: usize = 20_000;

/// The least distance of a profile's points \[m\], unless they make a vertical edge.
const LEAST_DISTANCE: f64 = 1e-5;
/// The largest coordinate in a text \[m\].
const LARGEST_PLACE: f64 = 1e6;

/// The points of a track, or of both, and those of the right one if it has others \[m\].
pub type Outline = (Vec<[f64; 2]>, Option<Vec<[f64; 2]>>);

/// What a road is made from. Parameters that a kind does not mention are not used by it. Their names in models begin with
/// `road_`; the [table](RoadParameters::rows) has their defaults and ranges.
#[derive(Debug, PartialEq, Default, Serialize, Deserialize)]
pub struct RoadParameters {
    /// The kind, from 1 = flat in the order of [`KINDS`].
    pub kind: i32,
    /// The road is level up to this place \[m\].
    pub start: f64,
    /// Height of the obstacle over the level road before it \[m\]; negative:
    /// depth. For a sine it is twice the amplitude.
    pub height: f64,
    /// Length along s \[m\]: of the ramp, of the cleat at its foot, of a
    /// slab, of a wave.
    pub length: f64,
    /// Width = height of a cleat's bevels, 45 degrees \[m\]. Their faces are sqrt(2)
    /// times as long.
    pub bevel: f64,
    /// Distance from the beginning of an obstacle to that of the next \[m\]; 0:
    /// only one, but slabs join.
    pub spacing: f64,
    /// Displacement PSD Gd(n0) at n0 = 0.1 cycles/m \[m³\]. Geometric means
    /// of the classes of ISO 8608, 1e-6 m³: A 16, B 64, C 256, D 1024, E 4096, F 16384, G 65536, H 262144.
    /// The standard fits the law from 0.011 to 2.83 cycles/m; here it goes from 0.01 to 10.24.
    pub roughness: f64,
    /// Number of the realisation.
    pub seed: i32,
    /// Angle from x to the direction s of the road, about z \[rad\]. A cleat
    /// across the path of a wheel that travels along x lies at 0, an oblique one at 45 degrees.
    pub direction: f64,
    /// Where the kind lies, from 1 = both in the order of [`TRACKS`]. The other track is level, at
    /// height 0.
    pub tracks: i32,
    /// Distance of the tracks \[m\]. The left one lies at y = `track_width` / 2
    /// (with a direction of 0), the right one at -`track_width` / 2; between them heights lie on a straight line,
    /// beyond them they stay. Not used where both tracks are the same.
    pub track_width: f64,
    /// How far to the left of the road's middle y = 0 lies, across the road \[m\]: a single wheel is on the left track
    /// at half the width of the tracks.
    pub lateral_position: f64,
    /// rho \[m\]: the coherence of the tracks of a road of ISO 8608 is
    /// exp(-rho n) at n cycles/m: the size of their cross spectrum over the root of the product of their spectra,
    /// 0.37 at the wavelength rho. 0: both tracks are the same.
    pub coherence_length: f64,
    /// "x z; x z; ..." \[m\]: points with straight lines between them, x counted from `start`;
    /// two points with the same x are a vertical edge. Level before the first and behind the last point.
    pub profile: String,
    /// Another profile for the right track, written and repeated likewise; empty: that of
    /// `road_profile`.
    pub profile_right: String,
    /// "s mu; s mu; ..." \[m, 1\]: from s on (not counted from `start`) the factor on the
    /// friction coefficients is mu; 1 before the first.
    pub friction: String,
    /// Other factors for the right side, y < 0 (with a direction of 0), written likewise;
    /// empty: those of `road_friction`, "0 1": none.
    pub friction_right: String,
    /// Standard deviation of a random factor of mean 1 that the friction is multiplied
    /// with \[1\]; 0: there is none. The factor is between 1 - 2.12 and 1 + 2.12 deviations.
    pub friction_deviation: f64,
    /// l, the integral of the random factor's correlation over all positive
    /// lags \[m\]. The correlation is 0.83 at the lag l/2, 0.47 at l, 0.03 at 2 l, 0 from 8/3 l on.
    pub friction_correlation_length: f64,
    /// Number of the realisation of the random factor.
    pub friction_seed: i32,
    /// The same for the right side; 0: that of the left one.
    pub friction_seed_right: i32,
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
    tracks,
    track_width,
    lateral_position,
    coherence_length,
    profile,
    profile_right,
    friction,
    friction_right,
    friction_deviation,
    friction_correlation_length,
    friction_seed,
    friction_seed_right,
});

impl RoadParameters {
    /// The start values of the [table](RoadParameters::rows): a flat road.
    pub fn flat() -> Self {
        let mut parameters = Self::default();
        Self::rows().write_starts(&mut parameters);
        parameters
    }

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
            ("track_width", self.track_width),
            ("lateral_position", self.lateral_position),
            ("coherence_length", self.coherence_length),
            ("friction_deviation", self.friction_deviation),
            ("friction_correlation_length", self.friction_correlation_length),
        ];
        if let Some((name, value)) = finite.iter().find(|(_, value)| !value.is_finite()) {
            return fail(format!("road_{name} = {value} has to be a finite number"));
        }
        for (name, value, items) in [("kind", self.kind, KINDS), ("tracks", self.tracks, TRACKS)] {
            if !(1..=items.len() as i32).contains(&value) {
                let items: Vec<_> =
                    items.iter().enumerate().map(|(i, (item, _))| format!("{} {item}", i + 1)).collect();
                return fail(format!("road_{name} = {value} is none of {}", items.join(", ")));
            }
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
        if self.kind == 6 && self.coherence_length < 0.0 {
            return fail(format!("road_coherence_length = {} m must not be negative", self.coherence_length));
        }
        if self.track_width < 1e-3 {
            return fail(format!("road_track_width = {} m has to be at least 0.001 m", self.track_width));
        }
        // two ways to say what the other track is
        if self.tracks != 1 && self.kind == 6 && self.coherence_length > 0.0 {
            return fail(format!(
                "road_coherence_length = {} m is that of two irregular tracks, but with road_tracks = {} one is level: set road_tracks to 1 both, or road_coherence_length to 0",
                self.coherence_length, self.tracks
            ));
        }
        if self.tracks != 1 && self.kind == 8 && !self.profile_right.trim().is_empty() {
            return fail(format!(
                "road_profile_right is a profile of its own for the right track, but with road_tracks = {} one track is level: set road_tracks to 1 both, or leave road_profile_right empty",
                self.tracks
            ));
        }
        if !(0.0..=LARGEST_DEVIATION).contains(&self.friction_deviation) {
            return fail(format!(
                "road_friction_deviation = {} has to be from 0 to 0.47: a larger one would make friction factors negative",
                self.friction_deviation
            ));
        }
        if self.friction_deviation > 0.0 && self.friction_correlation_length < 1e-3 {
            return fail(format!(
                "road_friction_correlation_length = {} m has to be at least 0.001 m",
                self.friction_correlation_length
            ));
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
            8 => profile_points("road_profile", &self.profile)?,
            _ => Vec::new(),
        })
    }

    /// Those of the right track, if it has others.
    pub(super) fn points_right(&self) -> Result<Option<Vec<[f64; 2]>>> {
        if self.kind != 8 || self.profile_right.trim().is_empty() {
            return Ok(None);
        }
        profile_points("road_profile_right", &self.profile_right).map(Some)
    }

    /// The profile as points "x z" \[m\] with straight lines between them, x counted from where the wheel starts, and that of
    /// the right track if it is another one. Level before the first and behind the last. Repeated obstacles are there once.
    ///
    /// # Errors
    /// A kind that is no straight pieces (sine, iso_8608); parameters that [`Road::new`](super::Road::new) refuses.
    pub fn outline(&self) -> Result<Outline> {
        self.check()?;
        if matches!(self.kind, 5 | 6) {
            let name = KINDS.get(self.kind as usize - 1).map_or("", |kind| kind.0);
            return Err(Error::variable(format!(
                "road_kind = {name} has no straight pieces with points; a road of points can be flat, step, ramp, cleat, slabs or profile"
            )));
        }
        let shifted = |points: Vec<[f64; 2]>| -> Vec<[f64; 2]> {
            match points.is_empty() {
                true => vec![[self.start, 0.0], [self.start + 1.0, 0.0]],
                false => points.into_iter().map(|[x, z]| [x + self.start, z]).collect(),
            }
        };
        let (points, right) = (self.points()?, self.points_right()?);
        self.period(&points)?;
        let level = |points: &[[f64; 2]]| vec![[points[0][0], 0.0], [points[points.len() - 1][0], 0.0]];
        let left = shifted(points);
        Ok(match self.tracks {
            2 => (left.clone(), Some(level(&left))),
            3 => (level(&left), Some(left)),
            _ => (left, right.map(shifted)),
        })
    }

    /// Distance of repeated obstacles with these points, if they are repeated.
    pub(super) fn period(&self, points: &[[f64; 2]]) -> Result<Option<f64>> {
        let fail = |message: String| Err(Error::variable(message));
        let spacing = if self.kind == 7 && self.spacing == 0.0 { self.length } else { self.spacing };
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
        let least = last[0] - first[0];
        if spacing < least || spacing < 0.0 {
            return fail(format!(
                "road_spacing = {spacing} m has to be 0 or at least {least} m: the next obstacle begins behind this one"
            ));
        }
        Ok(Some(spacing))
    }

    /// The steps of `road_friction`: from the place \[m\] of each on, its factor \[1\]; none where it is 1 everywhere.
    ///
    /// # Errors
    /// A text that cannot be read, places that do not increase, a negative factor; the message names parameter and pair.
    pub fn friction_steps(&self) -> Result<Vec<[f64; 2]>> {
        patches("road_friction", &self.friction)
    }

    /// The friction factor.
    pub(super) fn friction(&self) -> Result<Friction> {
        let left = Patches::new(&self.friction_steps()?);
        let right = match self.friction_right.trim() {
            "" => None,
            text => Some(Patches::new(&patches("road_friction_right", text)?)),
        };
        let varies = |seed: i32| {
            (self.friction_deviation > 0.0)
                .then(|| Variation::new(self.friction_deviation, self.friction_correlation_length, seed))
        };
        let other = (self.friction_seed_right != 0).then_some(self.friction_seed_right);
        Ok(Friction::new([Some(left), right], [varies(self.friction_seed), other.and_then(varies)]))
    }
}

/// Reads the points of a profile from the parameter `name`.
fn profile_points(name: &str, text: &str) -> Result<Vec<[f64; 2]>> {
    let points = groups(name, text, LARGEST_PLACE)?;
    let fail = |message: String| Err(Error::variable(format!("{name}: {message}")));
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

/// Reads the steps of a friction factor from the parameter `name`.
fn patches(name: &str, text: &str) -> Result<Vec<[f64; 2]>> {
    let steps = groups(name, text, LARGEST_PLACE)?;
    let fail = |i: usize, message: String| Err(Error::variable(format!("{name}: pair {}: {message}", i + 1)));
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
