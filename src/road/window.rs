//! What means over a window need of a road.

use super::Road;
use super::profile::Filter;
use crate::{Error, Result, clone_in_place};
use serde::{Deserialize, Serialize};

/// The shortest window that is not a point \[m\].
const SHORTEST: f64 = 1e-3;

/// A window over so many repeated obstacles, or correlation lengths of the friction, makes an evaluation
/// long, and the mean over it is a constant.
const MOST_REPEATS: f64 = 100.0;

/// The raised-cosine window of a tire's contact over one road, which [`Road::window`] makes and [`Road::mean`]
/// takes. The default is a point.
///
/// It holds what depends on the window's length and the road and not on the place.
#[derive(Debug, PartialEq, Default, Serialize, Deserialize)]
pub struct Window {
    /// L; 0: a point, and nothing else is there.
    length: f64,
    left: Filter,
    /// As the road's.
    right: Option<Filter>,
}

clone_in_place!(Window { length, left, right });

impl Window {
    /// The window of length 0: means over it are the road as it is. It fits every road.
    pub fn point() -> Self {
        Self::default()
    }

    /// The window of `length` \[m\] over a road.
    pub(super) fn new(road: &Road, length: f64) -> Result<Self> {
        if length == 0.0 {
            return Ok(Self::point());
        }
        check_length(road, length)?;
        let right = road.right.as_ref().map(|right| Filter::new(right, length));
        Ok(Self { length, left: Filter::new(&road.left, length), right })
    }

    /// Length L \[m\], the full width at half the height; 0: a point.
    pub fn length(&self) -> f64 {
        self.length
    }

    /// What it makes of the left or, where that is another one, of the right track.
    pub(super) fn filter(&self, is_left: bool) -> &Filter {
        match &self.right {
            Some(right) if !is_left => right,
            _ => &self.left,
        }
    }

    /// Checks a window that was read from a saved state, for the road that it is used with.
    ///
    /// # Errors
    /// Numbers or lengths that [`Road::window`] cannot have made of this road.
    pub fn check(&self, road: &Road) -> Result<()> {
        let fits = if self.length == 0.0 {
            *self == Self::point()
        } else {
            let right_fits = match (&self.right, &road.right) {
                (Some(filter), Some(right)) => filter.fits(right),
                (None, None) => true,
                _ => false,
            };
            check_length(road, self.length).is_ok() && self.left.fits(&road.left) && right_fits
        };
        if fits { Ok(()) } else { Err(Error::numeric("the saved window of the road is damaged")) }
    }
}

fn check_length(road: &Road, length: f64) -> Result<()> {
    let fail = |message: String| Err(Error::variable(message));
    if !(length >= SHORTEST && length.is_finite()) {
        return fail(format!(
            "road_filter_length = {length} m has to be 0 or at least {SHORTEST} m: it is the length of the contact"
        ));
    }
    let right = road.right.as_ref().and_then(|right| right.polyline.period());
    let period = road.left.polyline.period().into_iter().chain(right).reduce(f64::min);
    let repeats = [
        (period, "the distance of repeated obstacles", "road_spacing, or road_length of slabs"),
        (
            road.friction.correlation_length(),
            "the correlation length of the friction",
            "road_friction_correlation_length",
        ),
    ];
    for (distance, what, name) in repeats {
        if let Some(distance) = distance.filter(|distance| length > MOST_REPEATS * distance) {
            return fail(format!(
                "road_filter_length = {length} m is more than {MOST_REPEATS} times {what}, {distance} m ({name}): shorten it or lengthen that"
            ));
        }
    }
    Ok(())
}
