//! One element on its ray: the implicit step.
//!
//! The radial equation of an element (4-46 to 4-48) knows nothing of its neighbours, and of the rim only its motion. So it is solved
//! for each element by itself, by a scheme that takes the stiff contact at any step: two stages of
//! Alexander's singly diagonally implicit Runge-Kutta method of second order, which is L-stable and ends at its second stage.

use super::contact::{Contact, Touch};
use crate::tire::Ground;

/// 1 - 1 / sqrt(2): both stages are this share of a step implicit; the first one is at that share of it.
pub(super) const GAMMA: f64 = 1.0 - std::f64::consts::FRAC_1_SQRT_2;

/// Iterations for the place of an element in contact: Halley's method takes two or three, and where it would leave the range that the
/// place is known to be in, that is halved.
const ITERATIONS: usize = 60;
/// A change of the place over the penetration behind which Halley's method has no error that counts: it leaves the cube of that, and
/// what points of the same element bear of its force changes by no more than that.
const CLOSE: f64 = 1e-4;
/// The same where only the place is asked for and not the force there: the cube of this is a hundred-thousandth.
const CLOSE_PLACE: f64 = 2e-2;
/// Where that does not lead anywhere, a place is known well enough \[m\].
const NARROW: f64 = 1e-11;
/// A change that is rounding \[m\].
const ROUNDING: f64 = 1e-15;

/// What acts on an element besides the road, as a function of its distance and speed: force = base + stiffness r + damping v, pulling
/// it to the rim, all else included.
#[derive(Debug, Clone, Copy)]
pub(super) struct Radial {
    pub mass: f64,
    /// Stiffness, damping and force at r = v = 0.
    pub stiffness: f64,
    pub damping: f64,
    pub base: f64,
    /// Friction in parallel.
    pub friction: Friction,
}

/// A spring that slips at a force (Prandtl), since the beginning of the step.
#[derive(Debug, Clone, Copy)]
pub(super) struct Friction {
    pub stiffness: f64,
    pub limit: f64,
    /// Its force, and the distance of the element, at the beginning.
    pub force: f64,
    pub distance: f64,
}

impl Friction {
    /// The force at a distance, and its slope.
    pub fn at(&self, distance: f64) -> (f64, f64) {
        let force = self.force + self.stiffness * (distance - self.distance);
        match force.abs() >= self.limit {
            true => (self.limit.copysign(force), 0.0),
            false => (force, self.stiffness),
        }
    }
}

impl Radial {
    /// The distance at which all is in balance without the road, for what mass and damper take at a distance, from a place nearby. Friction
    /// sticks, or slips to the side on which it could not hold: all else rises with the distance.
    #[inline]
    fn free(&self, moving: &impl Fn(f64) -> f64, per: f64, near: f64) -> f64 {
        let Friction { stiffness, limit, force, distance } = self.friction;
        let rest = moving(near) + self.base + self.stiffness * near;
        let slope = self.mass * per * per + self.stiffness + self.damping * per;
        if limit <= 0.0 {
            return near - rest / slope;
        }
        let held = near - (rest + force + stiffness * (near - distance)) / (slope + stiffness);
        let holding = force + stiffness * (held - distance);
        if holding.abs() <= limit { held } else { near - (rest + limit.copysign(holding)) / slope }
    }
}

/// Where the contact points of an element are, and how they move, in the wheel's plane.
#[derive(Debug, Clone, Copy)]
pub(super) struct Ray<'a> {
    /// Unit vector along the ray.
    pub along: [f64; 2],
    /// Rim: height over the road's datum, velocity, spin speed.
    pub rim_height: f64,
    pub rim_velocity: [f64; 2],
    pub spin: f64,
    /// Turning of the road about the datum below the rim \[rad/s\], positive forward: of a drum; 0 of a road that lies.
    pub turning: f64,
    /// From the middle of the element to its tread.
    pub to_tread: f64,
    pub offsets: &'a [f64],
}

impl Ray<'_> {
    /// A contact point from below the rim's centre at the datum, and its velocity over the road, for a distance and speed of the element.
    #[inline]
    fn point(&self, offset: f64, distance: f64, speed: f64) -> ([f64; 2], [f64; 2]) {
        let [cos, sin] = self.along;
        let out = distance + self.to_tread;
        let place = [out * cos - offset * sin, self.rim_height + out * sin + offset * cos];
        // the ray turns with - spin, and the road under it
        let velocity = [
            self.rim_velocity[0]
                + speed * cos
                + self.spin * (out * sin + offset * cos)
                + self.turning * place[1],
            self.rim_velocity[1] + speed * sin
                - self.spin * (out * cos - offset * sin)
                - self.turning * place[0],
        ];
        (place, velocity)
    }
}

impl Ray<'_> {
    /// Energy that the contact of an element at a distance holds \[J\].
    pub fn stored(&self, track: &impl Track, contact: &Contact, distance: f64) -> f64 {
        let of = |offset: &f64| {
            let (place, _) = self.point(*offset, distance, 0.0);
            let (height, slope) = track.at(place[0]);
            contact.energy((height - place[1]) / libm::sqrt(1.0 + slope * slope))
        };
        self.offsets.iter().map(of).sum()
    }
}

/// The road in the wheel's plane.
pub(super) trait Track {
    /// Height over the datum \[m\] and slope along the plane, at x \[m\] from the rim's centre.
    fn at(&self, x: f64) -> (f64, f64);

    /// A height that it nowhere exceeds \[m\].
    fn highest(&self) -> f64;
}

/// A track from the points of a ground.
pub(super) struct Along<'a, G> {
    pub ground: &'a G,
    pub heading: [f64; 2],
    /// Of the step.
    pub share: f64,
}

impl<G: Ground> Track for Along<'_, G> {
    fn at(&self, x: f64) -> (f64, f64) {
        let [cos, sin] = self.heading;
        let (height, slope) = self.ground.relief(x * cos, x * sin, self.share);
        (height, slope[0] * cos + slope[1] * sin)
    }

    fn highest(&self) -> f64 {
        self.ground.highest()
    }
}

/// What the road does to an element.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(super) struct Pressed {
    /// Force of the road on it \[N\], in the wheel's plane.
    pub force: [f64; 2],
    /// Moment of that about the rim's centre, about y \[N.m\].
    pub moment: f64,
    /// The part along the ray, and its derivative by the distance where the speed goes with it.
    pub along: f64,
    pub slope: f64,
    /// The derivative of that.
    pub curve: f64,
    /// Largest penetration \[m\].
    pub penetration: f64,
    /// Contact points that touch it.
    pub points: u32,
    /// Power that the contact's dampers take \[W\].
    pub loss: f64,
}

/// How a contact point lies to the road.
#[derive(Debug, Clone, Copy, Default)]
struct Spot {
    /// From the rim's centre \[m\].
    arm: [f64; 2],
    velocity: [f64; 2],
    normal: [f64; 2],
    /// Not positive: it does not touch.
    penetration: f64,
}

impl Ray<'_> {
    fn spot(&self, track: &impl Track, offset: f64, distance: f64, speed: f64) -> Spot {
        let (place, velocity) = self.point(offset, distance, speed);
        let (height, slope) = track.at(place[0]);
        if place[1] >= height {
            return Spot::default();
        }
        let cos = if slope == 0.0 { 1.0 } else { 1.0 / libm::sqrt(1.0 + slope * slope) };
        Spot {
            arm: [place[0], place[1] - self.rim_height],
            velocity,
            normal: [-slope * cos, cos],
            penetration: (height - place[1]) * cos,
        }
    }

    /// True if it is far above the road, as most elements are: its lowest point is one of the outer ones.
    #[inline]
    fn is_above(&self, track: &impl Track, distance: f64) -> bool {
        let [cos, sin] = self.along;
        let farthest = self.offsets.last().map_or(0.0, |offset| offset.abs());
        self.rim_height + (distance + self.to_tread) * sin - farthest * cos.abs() > track.highest()
    }

    /// Largest penetration at a distance \[m\]; 0 if it touches nothing.
    fn penetration(&self, track: &impl Track, distance: f64) -> f64 {
        if self.is_above(track, distance) {
            return 0.0;
        }
        self.offsets
            .iter()
            .fold(0.0, |most: f64, offset| most.max(self.spot(track, *offset, distance, 0.0).penetration))
    }
}

/// What the road does to an element at a distance and speed; `per_speed` is the derivative of the speed by the distance.
#[inline]
pub(super) fn press(
    ray: &Ray<'_>,
    track: &impl Track,
    contact: &Contact,
    (distance, speed): (f64, f64),
    per_speed: f64,
) -> Pressed {
    let mut pressed = Pressed::default();
    if ray.is_above(track, distance) {
        return pressed;
    }
    for offsets in ray.offsets.chunks(4) {
        let mut spots = [Spot::default(); 4];
        for (spot, offset) in spots.iter_mut().zip(offsets) {
            *spot = ray.spot(track, *offset, distance, speed);
        }
        if spots.iter().all(|spot| spot.penetration <= 0.0) {
            continue;
        }
        // where nothing touches any number will do
        let penetrations = spots.map(|spot| if spot.penetration > 0.0 { spot.penetration } else { 1.0 });
        for (spot, elastic) in spots.iter().zip(contact.elastic(penetrations)) {
            if spot.penetration > 0.0 {
                pressed.add(
                    ray,
                    spot,
                    &contact.touch_at(elastic, spot.penetration, spot.leaving()),
                    per_speed,
                );
            }
        }
    }
    pressed
}

impl Spot {
    /// Speed at which it leaves the road \[m/s\].
    fn leaving(&self) -> f64 {
        self.normal[0] * self.velocity[0] + self.normal[1] * self.velocity[1]
    }
}

impl Pressed {
    /// What one point feels.
    fn add(&mut self, ray: &Ray<'_>, spot: &Spot, touch: &Touch, per_speed: f64) {
        let Spot { arm, normal, .. } = *spot;
        let on_ray = normal[0] * ray.along[0] + normal[1] * ray.along[1];
        self.points += 1;
        self.penetration = self.penetration.max(spot.penetration);
        self.force[0] += touch.force * normal[0];
        self.force[1] += touch.force * normal[1];
        self.moment += touch.force * (arm[1] * normal[0] - arm[0] * normal[1]);
        self.along += touch.force * on_ray;
        // the penetration grows by - on_ray with the distance, the leaving speed by on_ray with the speed
        let square = on_ray * on_ray;
        self.slope += square * (touch.by_leaving * per_speed - touch.by_penetration);
        self.curve += square * on_ray * (touch.by_penetration_twice - 2.0 * touch.by_both * per_speed);
        self.loss += spot.leaving() * (touch.elastic - touch.force);
    }

    /// The same where the element is a little farther out \[m\]: forces go with that along the ray.
    fn moved(self, by: f64) -> Self {
        if self.along == 0.0 {
            return self;
        }
        let along = self.along + (self.slope + 0.5 * self.curve * by) * by;
        let share = along / self.along;
        Self {
            along,
            force: self.force.map(|force| share * force),
            moment: share * self.moment,
            loss: share * self.loss,
            ..self
        }
    }
}

/// Where an element is at a stage, and what the road does to it there.
#[derive(Debug, Clone, Copy)]
pub(super) struct Reached {
    pub distance: f64,
    pub speed: f64,
    pub acceleration: f64,
    pub pressed: Pressed,
}

/// What is asked for of an element.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Wanted {
    /// The place that it reaches: the road's force is that nearby.
    Place,
    /// What the road does to it there, too.
    Force,
}

/// Solves r = r0 + h v, v = v0 + h a(r, v) for an element, h > 0 seconds, with `guess` for the distance.
pub(super) fn reach(
    radial: &Radial,
    ray: &Ray<'_>,
    track: &impl Track,
    contact: &Contact,
    (distance, speed, h): (f64, f64, f64),
    guess: f64,
    wanted: Wanted,
) -> Reached {
    let per = 1.0 / h;
    let speed_at = |r: f64| (r - distance) * per;
    let acceleration_at = |r: f64| (speed_at(r) - speed) * per;
    // what pulls it to the rim and what the mass needs; rises with r
    let without_road = |r: f64| {
        let (friction, slope) = radial.friction.at(r);
        let force = radial.base + radial.stiffness * r + radial.damping * speed_at(r) + friction;
        (
            radial.mass * acceleration_at(r) + force,
            radial.mass * per * per + radial.stiffness + radial.damping * per + slope,
        )
    };
    let free = radial.free(&|r| radial.mass * acceleration_at(r) + radial.damping * speed_at(r), per, guess);
    let reached = |r: f64, pressed: Pressed| Reached {
        distance: r,
        speed: speed_at(r),
        acceleration: acceleration_at(r),
        pressed,
    };
    if ray.along[1] >= 0.0 {
        return reached(free, Pressed::default());
    }
    if ray.is_above(track, free) {
        return reached(free, Pressed::default());
    }
    // the road pushes it in: the place is between there and where it touches no more
    let (mut low, mut high) = (f64::NEG_INFINITY, free);
    let close = if wanted == Wanted::Force { CLOSE } else { CLOSE_PLACE };
    let mut touches = false;
    let mut r = guess;
    if guess >= free {
        let penetration = ray.penetration(track, free);
        if penetration <= 0.0 {
            return reached(free, Pressed::default());
        }
        (touches, r) = (true, free - penetration);
    }
    for _ in 0..ITERATIONS {
        let pressed = press(ray, track, contact, (r, speed_at(r)), per);
        if pressed.points == 0 && !touches {
            if ray.penetration(track, free) <= 0.0 {
                return reached(free, Pressed::default());
            }
            touches = true;
        }
        let (value, slope) = without_road(r);
        let (value, slope) = (value - pressed.along, slope - pressed.slope);
        if value > 0.0 {
            high = r
        } else {
            low = r
        }
        // Halley's method; Newton's where the curve would turn it round
        let turned = 2.0 * slope * slope + value * pressed.curve;
        let next = r - if turned > 0.0 { 2.0 * value * slope / turned } else { value / slope };
        if slope > 0.0 && (next - r).abs() <= ROUNDING {
            return reached(r, pressed);
        }
        if next > low && next < high && slope > 0.0 {
            if (next - r).abs() <= close * pressed.penetration + ROUNDING {
                return reached(next, pressed.moved(next - r));
            }
            r = next;
        } else if low.is_finite() {
            // at an edge the force jumps: the place is where it does
            if high - low < NARROW {
                return reached(r, pressed);
            }
            r = 0.5 * (low + high);
        } else {
            r = high - 2.0 * (free - high).max(pressed.penetration).max(1e-6);
        }
    }
    reached(r, press(ray, track, contact, (r, speed_at(r)), per))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Friction that sticks, and that slips to either side: all in balance, also where corrections from piece to piece would go round
    /// in a circle.
    #[test]
    fn friction_finds_its_balance_from_anywhere() {
        for limit in [0.0, 1.0, 50.0] {
            for base in [-300.0, -20.0, 0.0, 0.5, 300.0] {
                for near in [-1.0, 0.0, 1e-4, 1.0] {
                    let radial = Radial {
                        mass: 1e-6,
                        stiffness: 1.0,
                        damping: 0.0,
                        base,
                        friction: Friction { stiffness: 1e6, limit, force: 0.3 * limit, distance: 0.01 },
                    };
                    let r = radial.free(&|_| 0.0, 0.0, near);
                    let left = base + radial.stiffness * r + radial.friction.at(r).0;
                    assert!(left.abs() < 1e-9 * (1.0 + base.abs()), "{limit} {base} {near}: {left}");
                }
            }
        }
    }
}
