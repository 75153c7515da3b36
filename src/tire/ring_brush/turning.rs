//! How a bristle that slides turns towards where its top is dragged.
//!
//! Its force has the size of the friction F and the direction of c u - d v. With an angle of θ between that and -v the
//! bottom slides with |v| cos θ, and dθ/dt = -(c |v| / F) sin θ, if what the damper lags is left out: tan(θ/2) falls by
//! exp(-a) in a step over which the top is dragged by a F / c. A bristle passes the contact in few steps; this does not
//! depend on their number, as a step of backward Euler does, which cuts the force back along the direction in which it
//! would be without sliding. Instead of exp(-a) here is 1 / (1 + a + a²/2), which is as close as the friction is known,
//! and neither grows nor swings for steps of any length.

use super::bristle::norm;
use crate::solver::Real;
use crate::solver::lanes::{larger, smaller};
use fearless_simd::{Simd, f64x4, prelude::*};

/// A step in which a bristle slides, or four at once.
#[derive(Debug, Clone, Copy)]
pub(super) struct Slid<T> {
    /// The force at its end of a bottom that stays where it is \[N\].
    pub trial: [T; 2],
    /// The way of the top in it, times the stiffness \[N\].
    pub dragged: [T; 2],
    /// Up to here the bristle stuck, and broke away \[N\]; negative if it has slid all the time.
    pub held: T,
}

impl<T: Real> Slid<T> {
    /// The force at the end \[N\]: `friction` in size. `size` is that of the trial force, not 0.
    pub fn force(&self, size: T, friction: T) -> [T; 2] {
        let before = norm(self.from(T::one()));
        let broke = self.held.value() >= 0.0;
        let left = if broke {
            let until = (self.held - before) / (size - before).or_at_least(f64::MIN_POSITIVE);
            (T::one() - until.or_at_least(0.0)).or_at_least(0.0)
        } else {
            T::one()
        };
        let mean = if broke { friction } else { (before + friction) * 0.5 };
        match turned(self.from(left), self.dragged.map(|w| w * left), mean) {
            Some(direction) => direction.map(|e| e * friction),
            // it keeps its direction
            None => self.trial.map(|w| w * (friction / size)),
        }
    }

    /// The trial force where this share of the step is left.
    fn from(&self, left: T) -> [T; 2] {
        std::array::from_fn(|k| self.trial[k] + self.dragged[k] * left)
    }
}

impl<S: Simd> Slid<f64x4<S>> {
    /// [`force`](Slid::force) of four bristles; `kept` is that with the direction of the trial force.
    #[inline(always)]
    pub fn force_of_four(
        &self,
        simd: S,
        size: f64x4<S>,
        friction: f64x4<S>,
        kept: [f64x4<S>; 2],
    ) -> [f64x4<S>; 2] {
        let (zero, one) = (f64x4::splat(simd, 0.0), f64x4::splat(simd, 1.0));
        let [mut dragged_x, mut dragged_y] = self.dragged;
        let (mut from_x, mut from_y) = (self.trial[0] + dragged_x, self.trial[1] + dragged_y);
        let before = (from_x * from_x + from_y * from_y).sqrt();
        let mut mean = (before + friction) * 0.5;
        let broke = self.held.simd_ge(0.0);
        if broke.any_true() {
            let until = (self.held - before) / larger(size - before, f64x4::splat(simd, f64::MIN_POSITIVE));
            let until = broke.select(smaller(larger(until, zero), one), zero);
            (from_x, from_y) = (from_x - dragged_x * until, from_y - dragged_y * until);
            (dragged_x, dragged_y) = (dragged_x * (-until + 1.0), dragged_y * (-until + 1.0));
            mean = broke.select(friction, mean);
        }
        turned_of_four(simd, [from_x, from_y], [dragged_x, dragged_y], mean, friction, kept)
    }
}

/// The direction in which a bristle pulls after a step in which its top was `dragged`, the way times the stiffness \[N\]: `from`
/// is the trial force before \[N\], `friction` that of the step. `None` if it is dragged against where it pulls, or not at all: it does
/// not slide by itself then.
#[inline]
fn turned<T: Real>(from: [T; 2], dragged: [T; 2], friction: T) -> Option<[T; 2]> {
    let (size, way) = (norm(from), norm(dragged));
    if size.value() * way.value() <= 0.0 {
        return None;
    }
    let (old, to) = (from.map(|w| w / size), dragged.map(|w| -w / way));
    let cos = old[0] * to[0] + old[1] * to[1];
    if cos.value() <= 0.0 {
        return None;
    }
    let a = way / friction;
    let falls = T::one() / (a * a * 0.5 + a + 1.0);
    // halfway between the two the angles are θ/2
    let half: [T; 2] = std::array::from_fn(|k| to[k] * (cos + 1.0) + (old[k] - to[k] * cos) * falls);
    let mirror = (half[0] * to[0] + half[1] * to[1]) * 2.0 / (half[0] * half[0] + half[1] * half[1]);
    Some(std::array::from_fn(|k| half[k] * mirror - to[k]))
}

/// [`turned`] of four bristles, each time `size`, and where it is none `other`.
#[inline(always)]
fn turned_of_four<S: Simd>(
    simd: S,
    [from_x, from_y]: [f64x4<S>; 2],
    [dragged_x, dragged_y]: [f64x4<S>; 2],
    friction: f64x4<S>,
    size: f64x4<S>,
    other: [f64x4<S>; 2],
) -> [f64x4<S>; 2] {
    let (zero, one) = (f64x4::splat(simd, 0.0), f64x4::splat(simd, 1.0));
    let pull = (from_x * from_x + from_y * from_y).sqrt();
    let way = (dragged_x * dragged_x + dragged_y * dragged_y).sqrt();
    // all times pull, way, and friction² (1 + a + a²/2): one quotient at the end is enough
    let cos = -(from_x * dragged_x + from_y * dragged_y);
    let grown = (way * 0.5 + friction) * way;
    let squared = friction * friction;
    let of_from = way * way * squared;
    let of_dragged = pull * way * (squared + grown) + cos * grown;
    let half_x = from_x * of_from - dragged_x * of_dragged;
    let half_y = from_y * of_from - dragged_y * of_dragged;
    let length = half_x * half_x + half_y * half_y;
    let divisor = way * length;
    // what is too small for the quotient is dragged by nothing
    let turns = cos.simd_gt(0.0) & divisor.simd_gt(f64::MIN_POSITIVE / f64::EPSILON);
    let mirror = (half_x * dragged_x + half_y * dragged_y) * 2.0;
    let scale = turns.select(size, zero) / turns.select(divisor, one);
    [
        turns.select((dragged_x * length - half_x * mirror) * scale, other[0]),
        turns.select((dragged_y * length - half_y * mirror) * scale, other[1]),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::solver::lanes::{LANES, level};
    use fearless_simd::dispatch;

    /// Against the solution of the differential equation, whose angle is known.
    #[test]
    fn a_bristle_turns_as_the_equation_says_and_four_do_the_same() {
        for angle in [-1.5, -0.7, -0.01, 0.0, 0.3, 1.2] {
            let (sin, cos) = f64::sin_cos(angle + 0.4);
            let to = [libm::cos(0.4), libm::sin(0.4)];
            let turn = |steps: u32, a: f64| {
                let dragged = to.map(|t: f64| -t * a * 50.0 / f64::from(steps));
                let mut force = [50.0 * cos, 50.0 * sin];
                for _ in 0..steps {
                    let one = turned(force, dragged, 50.0).unwrap();
                    let four: [[f64; LANES]; 2] = dispatch!(level(), simd => {
                        let splat = |x: f64| f64x4::splat(simd, x);
                        let zero = [splat(0.0); 2];
                        let (from, dragged) = (force.map(splat), dragged.map(splat));
                        turned_of_four(simd, from, dragged, splat(50.0), splat(1.0), zero).map(Into::into)
                    });
                    for (one, four) in one.iter().zip(four) {
                        assert!(four.iter().all(|f| (f - one).abs() < 1e-13), "{four:?} {one}");
                    }
                    force = one.map(|e| 50.0 * e);
                }
                f64::atan2(force[1], force[0]) - 0.4
            };
            for a in [0.1, 1.0, 5.0] {
                let exact = 2.0 * f64::atan((0.5 * angle).tan() * f64::exp(-a));
                let errors = [2, 4, 8].map(|steps| (turn(steps, a) - exact).abs());
                assert!(
                    errors[2] < 0.02 * angle.abs() * a * a * f64::exp(-a) + 1e-12,
                    "{angle} {a} {errors:?}"
                );
                // second order
                assert!(errors[2] < 0.35 * errors[1] + 1e-12, "{angle} {a} {errors:?}");
            }
        }
        // a step that is much too long ends where the top is dragged to
        let [x, y] = turned([30.0, 40.0], [-1e9, 0.0], 50.0).unwrap();
        assert!((x - 1.0).abs() < 1e-6 && y.abs() < 1e-6, "{x} {y}");
        assert!(turned([1.0, 0.0], [1.0, 0.0], 1.0).is_none() && turned([1.0, 0.0], [0.0; 2], 1.0).is_none());
    }
}
