//! A road under a rim that travels.

use crate::road::{Point, Road, Window};
use crate::tire::{Ground, Motion, Plane};
use crate::{Error, Result};

/// Places before and behind a wheel's centre at which the road is looked at for the start.
const LOOKS: i32 = 100;

/// A road for the length of a step.
///
/// The plane under a body has the height and slope of the mean over the tire's window below the body's centre: its
/// distance from the centre is measured vertically, and it is tilted there by the slope. That is the
/// convention of the effective road plane. On a long slope s a circle of radius R would sit
/// R s²/2 higher. On a drum the plane is that of the road as it would lie, below the wheel: the plane does not know that the drum is round.
#[derive(Debug, Clone, Copy)]
pub struct OnRoad<'a> {
    /// The road.
    pub road: &'a Road,
    /// Where the rim is over the road at the beginning of the step, x and y \[m\].
    pub from: [f64; 2],
    /// Where it is at the end.
    pub to: [f64; 2],
    /// Factor on the road's friction.
    pub friction: f64,
}

impl<'a> OnRoad<'a> {
    /// At one place.
    pub fn at(road: &'a Road, place: [f64; 2], friction: f64) -> Self {
        Self { road, from: place, to: place, friction }
    }

    /// Checks that the road under a wheel at a place is level at height 0, as far as `reach` \[m\] before and behind it: the place at
    /// rest of what stands on several wheels is that of a level road.
    ///
    /// # Errors
    /// It is not; the message says where, with the names of the whole and of the wheel.
    pub fn check_level(road: &Road, whole: &str, wheel: &str, [x, y]: [f64; 2], reach: f64) -> Result<()> {
        for k in -LOOKS..=LOOKS {
            let at = x + reach * f64::from(k) / f64::from(LOOKS);
            let height = road.at(at, y).height;
            if height != 0.0 {
                return Err(Error::variable(format!(
                    "the {whole} starts on a level road at height 0, and the road under the {wheel} wheel is {height:.5} m high at x = {at:.3} m; move it on with road_start, by the {whole}'s length and a wheel's radius"
                )));
            }
        }
        Ok(())
    }

    /// Where the rim is at a share of the step; on a drum, within its first turn.
    fn place(&self, share: f64) -> [f64; 2] {
        let [s, t] = [0, 1].map(|axis| self.from[axis] + share * (self.to[axis] - self.from[axis]));
        [self.road.within_turn(s), t]
    }
}

impl Ground for OnRoad<'_> {
    fn plane(&self, body: &Motion<f64>, window: &Window, share: f64) -> Plane {
        let [x, y] = self.place(share);
        let surface = self.road.mean(window, x + body.position.x, y + body.position.y);
        let ([slope_x, slope_y], [xx, xy, yy]) = (surface.slope, surface.curvature);
        let (vx, vy) = (body.velocity.x, body.velocity.y);
        Plane {
            clearance: body.position.z - surface.height,
            clearance_rate: body.velocity.z - slope_x * vx - slope_y * vy,
            slope: surface.slope,
            slope_rate: [xx * vx + xy * vy, xy * vx + yy * vy],
            friction: surface.friction * self.friction,
        }
    }

    fn point(&self, x: f64, y: f64, share: f64) -> Point {
        let place = self.place(share);
        let point = match self.road.drum_curvature() == 0.0 {
            true => self.road.at(place[0] + x, place[1] + y),
            false => self.road.on_drum(place[0], x, place[1] + y),
        };
        Point { friction: point.friction * self.friction, ..point }
    }

    #[inline]
    fn relief(&self, x: f64, y: f64, share: f64) -> (f64, [f64; 2]) {
        let place = self.place(share);
        match self.road.drum_curvature() == 0.0 {
            true => self.road.relief(place[0] + x, place[1] + y),
            false => self.road.relief_on_drum(place[0], x, place[1] + y).1,
        }
    }

    fn highest(&self) -> f64 {
        self.road.highest()
    }
}
