//! The stripes of the patch in a step: how long they are, and what of the pressure's shape is in each (4.19)-(4.24).

use super::bristles::Bristles;
use super::patch::{Moments, Shape};
use super::{Contact, Parameters, Prepared};
use crate::clone_in_place;
use crate::solver::lanes::{LANES, acos_near_one, exp2, log2, smaller};
use fearless_simd::{Simd, f64x4, prelude::*};
use serde::{Deserialize, Serialize};

/// Stripes that a tire has at most.
pub(super) const MAX_STRIPES: usize = 64;

/// What the stripes have in a step, in rows that are a multiple of four long.
#[derive(Debug, PartialEq, Default, Serialize, Deserialize)]
pub(super) struct Stripes {
    /// Lengths \[m\].
    pub lengths: Vec<f64>,
    /// Factors of the stripes in the shape of the pressure \[m\] (4.21).
    pub factors: Vec<f64>,
    /// Logarithms of the lengths to base 2.
    pub logarithms: Vec<f64>,
    /// Sums over the bristles of each stripe of the pressure's shape, times 1 and x, as
    /// [`sum_shapes`](Prepared::sum_shapes) leaves them.
    pub sums: Vec<[f64; 2]>,
}

clone_in_place!(Stripes { lengths, factors, logarithms, sums });

impl Stripes {
    pub fn new(stripes: usize) -> Self {
        let row = || vec![0.0; stripes.next_multiple_of(LANES)];
        Self { lengths: row(), factors: row(), logarithms: row(), sums: vec![[0.0; 2]; stripes] }
    }

    /// Whether there is a number for each stripe.
    pub fn fits(&self, stripes: usize) -> bool {
        let rows = [&self.lengths, &self.factors, &self.logarithms];
        self.sums.len() == stripes
            && rows.iter().all(|row| Some(row.len()) == stripes.checked_next_multiple_of(LANES))
    }

    pub fn longest(&self) -> f64 {
        self.lengths.iter().fold(0.0, |a, b| a.max(*b))
    }
}

/// How much each bristle at `x` counts in sums over a stripe that are to be integrals: by the trapezoidal rule with the
/// bristles and the two ends as nodes, at which the force is 0. As printed each counts whole.
pub(super) fn share(p: &Parameters, x: f64, half: f64) -> f64 {
    if p.whole_step_entry {
        return 1.0;
    }
    let part = |y: f64| (y / p.bristle_length).min(1.0);
    0.5 * (part(half - x) + part(half + x))
}

/// How far the normal force of a stripe counts as the integral of its pressure, and not as the sum over its bristles: not
/// at all up to a spacing, where one bristle is in it or none, and wholly from two spacings on.
pub(super) fn closed(p: &Parameters, length: f64) -> f64 {
    if p.whole_step_entry { 0.0 } else { (length / p.bristle_length - 1.0).clamp(0.0, 1.0) }
}

impl Prepared {
    /// Finds lengths (4.19), (4.20) and what the pressure has of a whole stripe.
    #[inline(always)]
    pub(super) fn measure<S: Simd>(&self, simd: S, contact: &Contact<f64>, stripes: &mut Stripes) {
        let p = self.parameters();
        let Stripes { lengths, factors, logarithms, .. } = stripes;
        if contact.penetration <= 0.0 {
            lengths.fill(0.0);
            return;
        }
        let zero = f64x4::splat(simd, 0.0);
        let (_, across) = Shape::new(p, contact.penetration).exponents();
        let (sin, cos) = contact.camber_sin_cos;
        let tangent = sin / cos;
        for k in (0..lengths.len()).step_by(LANES) {
            let own = k..k + LANES;
            let place = f64x4::from_slice(simd, &self.lanes.places[own.clone()]);
            let radius = f64x4::from_slice(simd, &self.lanes.radii[own.clone()]);
            let ratio = (place * tangent + contact.distance) / radius;
            let touches = ratio.simd_lt(1.0);
            let angle = acos_near_one(simd, smaller(ratio, f64x4::splat(simd, 1.0)));
            let length = touches.select(angle * radius * (2.0 * p.stripe_length_factor), zero);
            length.store_slice(&mut lengths[own.clone()]);
            if ratio.simd_lt(0.5).any_true() {
                // pressed in by half of its radius: the formula for small angles ends here
                for i in own.clone() {
                    if let (Some(y), Some(radius)) = (self.stripe_places().get(i), self.stripe_radii().get(i))
                    {
                        lengths[i] = contact.stripe_length(p, *y, *radius);
                    }
                }
            }
            let length = f64x4::from_slice(simd, &lengths[own.clone()]);
            let side = f64x4::from_slice(simd, &self.lanes.sides[own.clone()]);
            ((-exp2(simd, side * across) + 1.0) * length).store_slice(&mut factors[own.clone()]);
            log2(simd, length).store_slice(&mut logarithms[own]);
        }
    }

    /// Sums the shape of the pressure (4.24) over the bristles. As integrals the sums do not change while bristles pass.
    pub(super) fn sum_shapes(&self, penetration: f64, bristles: &mut Bristles) -> Moments<f64> {
        let p = self.parameters();
        let mut all = Moments { s0: 0.0, s1: 0.0, s2: 0.0 };
        let shape = Shape::new(p, penetration);
        let Bristles { window: [from, to], first_place, ref mut stripes, .. } = *bristles;
        let places = (from..to).map(|j| first_place + j as f64 * p.bristle_length);
        for (i, sums) in stripes.sums.iter_mut().enumerate() {
            let (length, factor) = (stripes.lengths[i], stripes.factors[i]);
            if length <= 0.0 {
                *sums = [0.0; 2];
                continue;
            }
            let closed = closed(p, length);
            let [i0, i2] = shape.integrals(length).map(|i| closed * i / p.bristle_length);
            let [mut s0, mut s1, mut s2] = [i0, 0.0, i2];
            if closed < 1.0 {
                for x in places.clone().filter(|x| 2.0 * x.abs() <= length) {
                    let counted = (1.0 - closed) * share(p, x, 0.5 * length) * shape.along(x, length);
                    s0 += counted;
                    s1 += counted * x;
                    s2 += counted * x * x;
                }
            }
            *sums = [factor * s0, factor * s1];
            all.s0 += factor * s0;
            all.s1 += factor * s1;
            all.s2 += factor * s2;
        }
        all
    }
}
