//! How much each bristle counts in sums that are to be integrals over a stripe.

use super::Parameters;
use crate::solver::lanes::{larger, smaller};
use fearless_simd::{Simd, f64x4, prelude::*};

/// Bristles at each end of a stripe that count other than 1.
pub(super) const END: usize = 3;

/// The share with which bristles at `x` count in sums over a stripe from -half to half, whose ends lie between bristles.
/// As printed each counts whole.
///
/// By the trapezoidal rule a bristle at the distance y spacings from an end counts (1 + y) / 2, if y is below 1. That is
/// exact for forces that are linear between bristles. To be exact for those that begin at the ends with y and y² wherever
/// the bristles are, the next three count
///
/// a(y) = (-8 + 5 y + 11 y²) / 48, (4 + 2 (y - 1) - 7 (y - 1)²) / 24, (y - 3) (3 y - 4) / 48
///
/// more: the sums over y, y² from the end on differ from their integrals by B2(y) / 2, B3(y) / 3 with the polynomials of
/// Bernoulli (Euler and Maclaurin), and these are what cancels that and goes to 0 continuously. Where a stripe is shorter
/// than the three spacings over which that holds, less of it is added, and nothing below two.
#[inline(always)]
pub(super) fn share<S: Simd>(simd: S, p: &Parameters, x: f64x4<S>, length: f64) -> f64x4<S> {
    let one = f64x4::splat(simd, 1.0);
    if p.whole_step_entry {
        return one;
    }
    let (spacings, half) = (1.0 / p.bristle_length, 0.5 * length);
    let refined = refinement(length * spacings) / 48.0;
    if length * spacings >= 2.0 * END as f64 {
        // the farther end takes nothing away
        return share_from(simd, (-x.abs() + half) * spacings, refined) + 0.5;
    }
    share_from(simd, (x + half) * spacings, refined) + share_from(simd, (-x + half) * spacings, refined)
}

/// What an end that is so many spacings away leaves of half a bristle, and what it adds.
#[inline(always)]
fn share_from<S: Simd>(simd: S, y: f64x4<S>, refined: f64) -> f64x4<S> {
    let (zero, one) = (f64x4::splat(simd, 0.0), f64x4::splat(simd, 1.0));
    let first = (y * 11.0 + 5.0) * y - 8.0;
    let z = y - 1.0;
    let second = (z * -14.0 + 4.0) * z + 8.0;
    let third = larger(-y + 3.0, zero) * (-y * 3.0 + 4.0);
    let more = y.simd_lt(1.0).select(first, y.simd_lt(2.0).select(second, third));
    smaller(y, one) * 0.5 + more * refined
}

/// [`share_from`] for one bristle, beyond half.
pub(super) fn surplus(y: f64, refined: f64) -> f64 {
    let z = y - 1.0;
    let more = if y < 1.0 {
        (y * 11.0 + 5.0) * y - 8.0
    } else if y < 2.0 {
        (z * -14.0 + 4.0) * z + 8.0
    } else {
        (3.0 - y).max(0.0) * (4.0 - 3.0 * y)
    };
    0.5 * y.min(1.0) - 0.5 + more * refined / 48.0
}

/// How much of what makes sums exact for curved forces is added in a stripe that is so many spacings long.
pub(super) fn refinement(spacings: f64) -> f64 {
    (spacings - 2.0).clamp(0.0, 1.0)
}
