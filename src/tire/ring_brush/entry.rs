//! What bristles do where they come into contact (4.31)-(4.33).
//!
//! There they slide: nothing presses them yet, and their damper already drags. Where the limit of sliding rises faster than the
//! load of a bristle that sticks, they come to rest soon, and then stick up to where the load meets the limit of sticking.
//! All that happens within a spacing or two, which a bristle may pass in one step.

use super::bristle::norm;
use super::ends::Patch;
use super::friction::at_speed;
use super::patch::{Path, Pressure};
use super::stretches::Bound;

/// The end of a stripe where bristles come into contact.
pub(super) struct Entry {
    /// -1 if bristles go to the rear from there, or 1.
    pub side: f64,
    /// Its place \[m\].
    pub x: f64,
    /// Force of a bristle that sticks, followed back from where it comes to rest to there \[N\].
    pub force: [f64; 2],
    /// By how much that grows in a spacing.
    pub growth: [f64; 2],
    /// How fast the limit of sticking rises there \[N\] per spacing.
    pub rise: f64,
    /// Spacings from there after which a bristle has come to rest; infinite where none does.
    pub rests: f64,
}

impl Entry {
    /// The entry of a stripe: `path` is that of its tops, `feed` the speed at which bristles go through it,
    /// which is not 0; `bounds` the ends of what is pressed on the road, `factor` the stripe's in the shape of the pressure.
    #[inline]
    pub fn new(patch: &Patch<'_>, path: &Path<f64>, feed: f64, bounds: &[Bound; 2], factor: f64) -> Self {
        let Patch { p, ref friction, grip_area, pressure: &Pressure { level, tilt, .. }, exponent, .. } =
            *patch;
        let side = if feed < 0.0 { -1.0 } else { 1.0 };
        let Bound { x, power, .. } = bounds[usize::from(feed < 0.0)];
        let [[x0, x1, x2], [y0, y1, y2]] = [path.velocity_x, path.velocity_y];
        let velocity = [(x2 * x + x1) * x + x0, (y2 * x + y1) * x + y0];
        let speed = norm(velocity);
        let load = p.bristle_stiffness * p.bristle_length / feed.abs();
        let damper = p.bristle_damping;
        // the pressure's slope to the inside: with power = (2 |x| / length)^exponent it is
        // factor (level + tilt x) (1 - power)
        let slope = tilt * (1.0 - power) - (level + tilt * x) * exponent * power / x;
        let most = (side * factor * slope * p.bristle_length).max(0.0) * grip_area;
        let limits = friction.at_no_pressure();
        let sliding = at_speed(p, most * limits.sliding, velocity);
        // the spring of a bristle that slides lags behind the limit, by up to its rise within the time that the damper needs;
        // at rest it lacks the damper's load
        let behind = damper * feed.abs() / (p.bristle_stiffness * p.bristle_length);
        let rests = if load * speed < sliding {
            -behind * libm::log1p(-load * speed / sliding)
        } else {
            f64::INFINITY
        };
        // it comes to rest with the force of one that slides
        let from_rest = if rests < f64::INFINITY { (sliding - load * speed) * rests } else { 0.0 };
        let per_speed = from_rest / speed.max(f64::MIN_POSITIVE);
        Self {
            side,
            x,
            force: velocity.map(|v| -per_speed * v),
            growth: velocity.map(|v| -load * v),
            rise: most * limits.sticking,
            rests,
        }
    }

    /// After how many spacings bristles that have come to rest break away, at most `there`, and the bend of the parabola
    /// that the limit of sticking follows to `limit` \[N\] there. `None` if it is below their load all the way.
    pub fn breaks_away(&self, there: f64, limit: f64) -> Option<(f64, f64)> {
        let bend = (limit - self.rise * there) / (there * there);
        let faster = self.rise - norm(self.growth);
        let discriminant = faster * faster + 4.0 * bend * norm(self.force);
        // a parabola that is bent down meets the load twice, or never; one that is bent up stays above it
        let meets = match bend < 0.0 {
            true if discriminant < 0.0 => return None,
            true => (faster + discriminant.sqrt()) / (-2.0 * bend),
            false => there,
        };
        Some((meets.min(there), bend))
    }
}
