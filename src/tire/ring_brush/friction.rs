//! The friction of bristles over their pressure and speed (4.32), of one and of four at once.

use super::Parameters;
use super::bristle::norm;
use crate::solver::Real;
use crate::solver::lanes::{larger, smaller};
use fearless_simd::{Simd, f64x4, prelude::*};

/// Friction limits of a bristle \[N\]: the coefficients at its pressure times its normal force.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Limits<T> {
    /// Up to here it sticks.
    pub sticking: T,
    /// With this it slides, at no speed.
    pub sliding: T,
}

/// The law: coefficients are linear in the pressure and extrapolated beyond the reference pressure. Neither is negative,
/// and where the lines cross beyond it sliding keeps to that of sticking: else a bristle would slide with more force
/// than moves it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Friction {
    /// Coefficient of sticking at no pressure, and how it grows with it \[1/Pa\].
    sticking: [f64; 2],
    /// The same of sliding.
    sliding: [f64; 2],
    /// Fall of the sliding friction with the speed \[s/m\].
    falloff: f64,
}

impl Friction {
    /// The law of a tire.
    pub fn new(p: &Parameters) -> Self {
        let per_pressure = p.friction_pressure_scale / p.friction_pressure;
        let line = |[at_zero, at_reference]: [f64; 2]| [at_zero, per_pressure * (at_reference - at_zero)];
        Self {
            sticking: line(p.friction_static),
            sliding: line(p.friction_sliding),
            falloff: p.friction_speed_falloff,
        }
    }

    /// The limits at a pressure \[Pa\] and normal force \[N\]; 0 for a bristle that pulls.
    #[inline]
    pub fn limits<T: Real>(&self, pressure: T, normal_force: T) -> Limits<T> {
        if normal_force.value() <= 0.0 {
            return Limits { sticking: T::zero(), sliding: T::zero() };
        }
        let coefficient = |[at_zero, slope]: [f64; 2]| (pressure * slope + at_zero).or_at_least(0.0);
        let (sticking, sliding) = (coefficient(self.sticking), coefficient(self.sliding));
        let sliding = if sliding > sticking { sticking } else { sliding };
        Limits { sticking: sticking * normal_force, sliding: sliding * normal_force }
    }

    /// The coefficients where nothing presses: the limits over the normal force.
    pub(super) fn at_no_pressure(&self) -> Limits<f64> {
        self.limits(0.0, 1.0)
    }

    /// [`limits`](Self::limits) of four bristles.
    #[inline(always)]
    pub(super) fn limits_of_four<S: Simd>(
        &self,
        simd: S,
        pressure: f64x4<S>,
        normal_force: f64x4<S>,
    ) -> Limits<f64x4<S>> {
        let zero = f64x4::splat(simd, 0.0);
        let held = larger(normal_force, zero);
        let coefficient = |[at_zero, slope]: [f64; 2]| larger(pressure * slope + at_zero, zero);
        let (sticking, sliding) = (coefficient(self.sticking), coefficient(self.sliding));
        Limits { sticking: sticking * held, sliding: smaller(sliding, sticking) * held }
    }

    /// [`at_speed`] of four bristles.
    #[inline(always)]
    pub(super) fn at_speed_of_four<S: Simd>(&self, slow: f64x4<S>, [x, y]: [f64x4<S>; 2]) -> f64x4<S> {
        if self.falloff == 0.0 { slow } else { slow / ((x * x + y * y).sqrt() * self.falloff + 1.0) }
    }

    /// The largest coefficient up to a pressure \[Pa\].
    pub(super) fn most(&self, highest: f64) -> f64 {
        let [at_zero, slope] = self.sticking;
        at_zero + slope.max(0.0) * highest
    }
}

/// Sliding friction \[N\] of a bristle whose top moves with `velocity` \[m/s\] over the road, of which `slow` is the value
/// at no speed: slow / (1 + falloff v). Not in the source, whose sliding friction does not depend on the speed (a falloff
/// of 0).
#[inline]
pub(super) fn at_speed<T: Real>(p: &Parameters, slow: T, velocity: [T; 2]) -> T {
    let falloff = p.friction_speed_falloff;
    if falloff == 0.0 { slow } else { slow / (norm(velocity) * falloff + 1.0) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::solver::lanes::{LANES, level};
    use fearless_simd::dispatch;

    /// Lines that cross at one and a half times the reference pressure, and end at twice of it.
    #[test]
    fn sliding_never_exceeds_sticking_and_four_at_once_are_the_same() {
        let p = Parameters {
            friction_static: [1.6, 0.8],
            friction_sliding: [1.0, 0.6],
            friction_pressure: 2e5,
            friction_pressure_scale: 1.0,
            friction_speed_falloff: 0.05,
            ..Parameters::default()
        };
        let law = Friction::new(&p);
        for k in -4..40 {
            let pressure = 2e4 * f64::from(k);
            let normal = 1e-4 * pressure;
            let limits = law.limits(pressure, normal);
            let expected = |[zero, reference]: [f64; 2]| {
                (zero + pressure / 2e5 * (reference - zero)).max(0.0) * normal.max(0.0)
            };
            let sticking = expected(p.friction_static);
            assert!((limits.sticking - sticking).abs() < 1e-12 * 10.0);
            assert!((limits.sliding - expected(p.friction_sliding).min(sticking)).abs() < 1e-12 * 10.0);
            assert!(0.0 <= limits.sliding && limits.sliding <= limits.sticking);
            let velocity = [0.3 * f64::from(k), -1.0];
            let slides = at_speed(&p, limits.sliding, velocity);
            let four: [[f64; LANES]; 3] = dispatch!(level(), simd => {
                let splat = |x: f64| f64x4::splat(simd, x);
                let four = law.limits_of_four(simd, splat(pressure), splat(normal));
                let at_speed = law.at_speed_of_four(four.sliding, velocity.map(splat));
                [four.sticking.into(), four.sliding.into(), at_speed.into()]
            });
            assert_eq!(four, [limits.sticking, limits.sliding, slides].map(|x| [x; LANES]));
        }
    }
}
