//! What a tire rolls on: a height and a friction factor along one direction.
//!
//! A road has a profile z(s) and a friction factor mu(s) over s = x cos(direction) + y sin(direction);
//! it is the same all the way across. A tire does not follow every edge of z, its contact bridges
//! them: it rolls on the *filtered* profile
//!
//! w(s) = integral of K(u) z(s - u) du, K(u) = (1 + cos(pi u / L)) / (2 L) for |u| < L,
//!
//! where L is `filter_length`, the length of the contact: the kernel's full width at half its height.
//! Profiles are sums of straight pieces with edges and of sinusoids, for which w, dw/ds and d²w/ds² have
//! closed forms. w and dw/ds are continuous, d²w/ds² is bounded. The friction factor is the mean over
//! a window of length L.
//!
//! # Validity
//!
//! The filter is linear and its kernel a choice; no tire was measured for it.
//!
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

mod friction;
mod parameters;
mod polyline;
mod text;
mod waves;

pub use parameters::{KINDS, MAX_POINTS, RoadParameters};

use self::friction::Friction;
use self::polyline::Polyline;
use self::waves::{Irregular, Versine};
use crate::{Error, Result, clone_in_place};
use serde::{Deserialize, Serialize};

/// A compiled road.
#[derive(Debug, PartialEq, Serialize, Deserialize)]
pub struct Road {
    /// Cosine and sine of the direction.
    along: [f64; 2],
    filter_length: f64,
    // The profile is the sum of these; a kind of road fills one of them.
    polyline: Polyline,
    versine: Versine,
    irregular: Irregular,
    friction: Friction,
}

clone_in_place!(Road { along, filter_length, polyline, versine, irregular, friction });

/// The filtered road under a point.
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
            filter_length: RoadParameters::default().filter_length,
            polyline: Polyline::default(),
            versine: Versine::default(),
            irregular: Irregular::default(),
            friction: Friction::default(),
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
        let mut road = Self {
            along: [cos, sin],
            filter_length: p.filter_length,
            friction: Friction::new(&p.friction_steps()?),
            ..Self::default()
        };
        match p.kind {
            5 => road.versine = Versine::new(p.start, p.height, p.length, p.filter_length),
            6 => road.irregular = Irregular::new(p.start, p.roughness, p.seed, p.filter_length),
            _ => road.polyline = Polyline::new(p.start, &p.points()?, p.period()?, p.filter_length),
        }
        Ok(road)
    }

    /// The filtered road at x and y \[m\].
    pub fn at(&self, x: f64, y: f64) -> Surface {
        let [cos, sin] = self.along;
        let (s, length) = (x * cos + y * sin, self.filter_length);
        let parts = [self.polyline.at(s, length), self.versine.at(s, length), self.irregular.at(s)];
        let [height, slope, curvature] = [0, 1, 2].map(|i| parts[0][i] + parts[1][i] + parts[2][i]);
        Surface {
            height,
            slope: [slope * cos, slope * sin],
            curvature: [curvature * cos * cos, curvature * cos * sin, curvature * sin * sin],
            friction: self.friction.at(s, length),
        }
    }

    /// The height z of the profile as it is, not filtered, at s = x cos(direction) + y sin(direction)
    /// \[m\]; at a vertical edge that behind it.
    pub fn raw_height(&self, s: f64) -> f64 {
        self.polyline.raw(s) + self.versine.raw(s) + self.irregular.raw(s)
    }

    /// Checks a road that was read from a saved state.
    ///
    /// # Errors
    /// Numbers or lengths that [`new`](Self::new) cannot have made.
    pub fn check(&self) -> Result<()> {
        let [cos, sin] = self.along;
        let whole = (cos * cos + sin * sin - 1.0).abs() < 1e-9
            && self.filter_length.is_finite()
            && self.filter_length > 0.0
            && self.polyline.is_whole(self.filter_length)
            && self.versine.is_whole()
            && self.irregular.is_whole()
            && self.friction.is_whole();
        if whole { Ok(()) } else { Err(Error::numeric("the saved road is damaged")) }
    }
}
