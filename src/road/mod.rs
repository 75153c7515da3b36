//! What a tire rolls on: heights and friction factors along two tracks.
//!
//! A road has a left track (at +y when its direction is 0, ISO 8855) and a right one, `track_width` apart,
//! each with a profile z(s) over s = x cos(direction) + y sin(direction). Across, t = y cos(direction) -
//! x sin(direction), heights lie on the straight line between the tracks, at t = ± `track_width` / 2, and
//! stay the same beyond them. Where both tracks are the same, so is the road all the way across. The friction
//! factor changes at t = 0. Profiles are sums of straight pieces with edges and of sinusoids.
//!
//! [`Road::at`] is the road as it is. What a contact makes of its edges is a matter of the tire. One that
//! has no way of its own for that rolls on the mean over a window along s, [`Road::mean`],
//!
//! w(s) = integral of K(u) z(s - u) du, K(u) = (1 + cos(pi u / L)) / (2 L) for |u| < L,
//!
//! where L is the window's length, that of the contact: the kernel's full width at half its height. w, dw/ds
//! and d²w/ds² have closed forms. w and dw/ds are continuous along s, d²w/ds² is bounded. The friction factor
//! is the mean over s ± L/2.
//!
//! # Validity
//!
//! Of the road:
//!
//! * dz/dt jumps at the tracks if they differ in height; a place on a track has that beyond it, 0. The step of
//!   the friction at t = 0 is no mean across the tire's width.
//! * The lines of an irregular road have random phases, not random amplitudes: every realisation has the PSD of
//!   the standard in both tracks. Their coherence is exp(-rho n), n in cycles/m, rho the `coherence_length`,
//!   in the mean over lines and realisations; over the 16 lines of an octave of one road it scatters by
//!   sqrt((1 - coherence²) / 32) in phase and as much out of phase.
//!   Potholes and patches, which lines with random phases do not have, are not represented.
//! * Friction that varies at random varies along s only; on the right side it is the same, or independent of the left one.
//!
//! Of the mean over a window:
//!
//! * The filter is linear and its kernel a choice; no tire was measured for it.
//! * A step of height h becomes a rise over 2 L with the largest slope h / L and curvatures up to
//!   pi h / (2 L²); it begins L ahead of the edge whatever h is. A cleat keeps its area, not its height.
//! * A sine of the wavelength lambda keeps its phase and is multiplied by
//!   sin(a) / (a (1 - (a / pi)²)), a = 2 pi L / lambda:
//!
//!   | lambda / L | 20 | 10 | 4 | 2 | 1.5 | 1 | below 1 |
//!   |---|---|---|---|---|---|---|---|
//!   | gain | 0.994 | 0.974 | 0.849 | 0.5 | 0.266 | 0 | -0.027 to 0.008 |
//!
//! * A rigid tire of radius R touches an edge of height h already sqrt(2 R h - h²) ahead of it: 82 mm for
//!   R = 0.338 m and h = 10 mm, more for higher edges. This envelopment by shape is no linear filter.
//!   Results are qualitative for obstacles higher than 10 to 15 mm or shorter than the contact, and
//!   where an edge lifts the tire off.
//! * w is one smooth surface: a tire that bridges a groove and stands on both of its edges, or on an edge and
//!   the road before it, is not represented.
//! * The window lies along s: nothing is averaged across, and the kink of different tracks stays a kink.

mod drum;
mod friction;
mod parameters;
mod polyline;
mod profile;
mod random;
mod rows;
mod waves;
mod window;

pub use drum::round;
pub use parameters::{KINDS, MAX_POINTS, Outline, RoadParameters, TRACKS};
pub use window::Window;

use self::friction::Friction;
use self::polyline::Polyline;
use self::profile::Profile;
use self::waves::{Irregular, Versine};
use crate::{Error, Result, clone_in_place};
use serde::{Deserialize, Serialize};

/// What the documentation of a model on roads says of them.
pub(crate) const DOCUMENTATION: &str = include_str!("documentation.html");

/// A compiled road.
#[derive(Debug, PartialEq, Serialize, Deserialize)]
pub struct Road {
    /// Cosine and sine of the direction.
    along: [f64; 2],
    /// How far to the left of the road's middle y = 0 lies \[m\].
    aside: f64,
    /// Half the distance of the tracks \[m\].
    half_width: f64,
    left: Profile,
    /// None: as on the left.
    right: Option<Profile>,
    friction: Friction,
    /// Of the drum that it is wound around \[1/m\]; 0: of none.
    curvature: f64,
    /// A height that it nowhere exceeds \[m\]; none where none is known.
    highest: Option<f64>,
}

clone_in_place!(Road { along, aside, half_width, left, right, friction, curvature, highest });

/// The height that both tracks nowhere exceed \[m\], if it is known.
fn highest(left: &Profile, right: Option<&Profile>) -> Option<f64> {
    let left = left.highest()?;
    right.map_or(Some(left), |right| Some(left.max(right.highest()?)))
}

/// The road at a point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Point {
    /// Height z \[m\]; at a vertical edge that behind it.
    pub height: f64,
    /// dz/dx and dz/dy of the piece; at an edge those behind it.
    pub slope: [f64; 2],
    /// Factor on the tire's friction coefficients, not negative.
    pub friction: f64,
}

/// The mean of the road over a window about a point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Surface {
    /// Height w \[m\].
    pub height: f64,
    /// dw/dx and dw/dy.
    pub slope: [f64; 2],
    /// d²w/dx², d²w/dxdy and d²w/dy² \[1/m\].
    pub curvature: [f64; 3],
    /// Factor on the tire's friction coefficients, not negative.
    pub friction: f64,
}

impl Default for Road {
    /// The flat road.
    fn default() -> Self {
        Self {
            along: [1.0, 0.0],
            // of no consequence where there is one track
            half_width: 1.0,
            aside: 0.0,
            left: Profile::default(),
            right: None,
            friction: Friction::default(),
            curvature: 0.0,
            highest: Some(0.0),
        }
    }
}

impl Road {
    /// The road that the parameters describe.
    ///
    /// # Errors
    /// A parameter that is not finite, is outside what its kind of road allows or contradicts another; a
    /// text that cannot be read. The message names the parameter and what it has to be.
    pub fn new(p: &RoadParameters) -> Result<Self> {
        p.check()?;
        let (sin, cos) = libm::sincos(p.direction);
        let straight = |points: &[[f64; 2]]| -> Result<Profile> {
            Ok(Polyline::new(p.start, points, p.period(points)?).into())
        };
        let (profile, other): (Profile, Option<Profile>) = match p.kind {
            5 => (Versine::new(p.start, p.height, p.length).into(), None),
            6 => {
                let (left, right) = Irregular::new(p.start, p.roughness, p.seed, p.coherence_length);
                (left.into(), right.map(Profile::from))
            }
            _ => (straight(&p.points()?)?, p.points_right()?.as_deref().map(straight).transpose()?),
        };
        let (left, right) = match p.tracks {
            2 => (profile, Some(Profile::default())),
            3 => (Profile::default(), Some(profile)),
            _ => (profile, other),
        };
        Ok(Self {
            highest: highest(&left, right.as_ref()),
            along: [cos, sin],
            aside: p.lateral_position,
            half_width: 0.5 * p.track_width,
            left,
            right,
            friction: p.friction()?,
            curvature: 0.0,
        })
    }

    /// The road as it is at x and y \[m\].
    pub fn at(&self, x: f64, y: f64) -> Point {
        let (s, t) = self.place(x, y);
        let (height, slope) = self.relief(x, y);
        Point { height, slope, friction: self.friction.mean(s, t, 0.0) }
    }

    /// Height \[m\] and slopes of [`at`](Self::at) without the friction: what each of many contact points asks for.
    #[inline]
    pub fn relief(&self, x: f64, y: f64) -> (f64, [f64; 2]) {
        let (s, t) = self.place(x, y);
        let ([height, slope, _], across) = self.between_tracks(t, |profile, _| profile.at(s));
        (height, self.slope(slope, across))
    }

    /// A height that it nowhere exceeds \[m\]: what is above touches nothing. Infinite where none is known, as of an irregular road and
    /// inside of a drum.
    pub fn highest(&self) -> f64 {
        self.highest.filter(|_| self.curvature >= 0.0).unwrap_or(f64::INFINITY)
    }

    /// What [`mean`](Self::mean) needs for a raised-cosine window of the length L \[m\]; 0: a point.
    ///
    /// # Errors
    /// A length that is neither 0 nor at least 0.001 m, or is more than 100 times the distance of repeated
    /// obstacles or the correlation length of the friction: evaluations would be long, and the means constants.
    pub fn window(&self, length: f64) -> Result<Window> {
        Window::new(self, length)
    }

    /// The mean of the road over a window of this road, about x and y \[m\]. The window lies along s.
    ///
    /// Over a point it is the road as it is, with the curvature that it has beside its edges.
    pub fn mean(&self, window: &Window, x: f64, y: f64) -> Surface {
        let (s, t) = self.place(x, y);
        let length = window.length();
        let ([height, slope, curvature], across) = if length == 0.0 {
            self.between_tracks(t, |profile, _| profile.at(s))
        } else {
            self.between_tracks(t, |profile, is_left| profile.mean(s, length, window.filter(is_left)))
        };
        Surface {
            height,
            slope: self.slope(slope, across),
            curvature: self.curvature(curvature, across),
            friction: self.friction.mean(s, t, length),
        }
    }

    /// Checks a road that was read from a saved state.
    ///
    /// # Errors
    /// Numbers or lengths that [`new`](Self::new) cannot have made.
    pub fn check(&self) -> Result<()> {
        let [cos, sin] = self.along;
        let whole = (cos * cos + sin * sin - 1.0).abs() < 1e-9
            && self.aside.is_finite()
            && self.half_width.is_finite()
            && self.half_width > 0.0
            && self.left.is_whole()
            && self.right.as_ref().is_none_or(Profile::is_whole)
            && self.friction.is_whole()
            && self.curvature.is_finite()
            && self.highest == highest(&self.left, self.right.as_ref());
        if whole { Ok(()) } else { Err(Error::numeric("the saved road is damaged")) }
    }

    /// Coordinates s along and t across the road.
    fn place(&self, x: f64, y: f64) -> (f64, f64) {
        let [cos, sin] = self.along;
        (x * cos + y * sin, y * cos - x * sin + self.aside)
    }

    /// Height, slope and curvature along the road at `t` across it, from those of the tracks (and whether it is
    /// the left one). Between different tracks also the derivatives of height and slope by t.
    #[inline]
    fn between_tracks(
        &self,
        t: f64,
        track: impl Fn(&Profile, bool) -> [f64; 3],
    ) -> ([f64; 3], Option<[f64; 2]>) {
        let (nearest, is_left, other) = match &self.right {
            Some(right) if t <= -self.half_width => (right, false, None),
            Some(right) if t < self.half_width => (&self.left, true, Some(right)),
            _ => (&self.left, true, None),
        };
        let left = track(nearest, is_left);
        let Some(right) = other else { return (left, None) };
        let right = track(right, false);
        let share = 0.5 + 0.5 * t / self.half_width;
        let difference = [0, 1, 2].map(|i| left[i] - right[i]);
        let by_t = 0.5 / self.half_width;
        (
            [0, 1, 2].map(|i| right[i] + share * difference[i]),
            Some([by_t * difference[0], by_t * difference[1]]),
        )
    }

    /// The slope along x and y.
    fn slope(&self, by_s: f64, across: Option<[f64; 2]>) -> [f64; 2] {
        let [cos, sin] = self.along;
        let [x, y] = [by_s * cos, by_s * sin];
        match across {
            None => [x, y],
            Some([by_t, _]) => [x - by_t * sin, y + by_t * cos],
        }
    }

    /// The curvature along x, mixed, and along y.
    fn curvature(&self, by_ss: f64, across: Option<[f64; 2]>) -> [f64; 3] {
        let [cos, sin] = self.along;
        let [xx, xy, yy] = [by_ss * cos * cos, by_ss * cos * sin, by_ss * sin * sin];
        match across {
            None => [xx, xy, yy],
            Some([_, by_st]) => {
                let twist = 2.0 * by_st * cos * sin;
                [xx - twist, xy + by_st * (cos * cos - sin * sin), yy + twist]
            }
        }
    }
}
