//! Sums over the bristles of four stripes at once, and what they lack of integrals.

use super::ends::{Patch, Shares};
use crate::solver::lanes::{LANES, lanes, larger, smaller};
use fearless_simd::{Simd, f64x4, prelude::*};

/// Sums that are not yet added up over the lanes.
pub(super) struct Total<S: Simd> {
    pub force_x: f64x4<S>,
    pub force_y: f64x4<S>,
    pub moment_x: f64x4<S>,
    pub moment_z: f64x4<S>,
    pub touching: f64x4<S>,
    pub sliding: f64x4<S>,
    pub power: f64x4<S>,
    pub slip: f64x4<S>,
    pub negative: f64x4<S>,
    pub highest: f64x4<S>,
    pub work: f64x4<S>,
    pub stored: f64x4<S>,
}

impl<S: Simd> Total<S> {
    #[inline(always)]
    pub fn new(simd: S) -> Self {
        let zero = f64x4::splat(simd, 0.0);
        Self {
            force_x: zero,
            force_y: zero,
            moment_x: zero,
            moment_z: zero,
            touching: zero,
            sliding: zero,
            power: zero,
            slip: zero,
            negative: zero,
            highest: zero,
            work: zero,
            stored: zero,
        }
    }
}

/// Four stripes: what is known of each.
#[derive(Default)]
pub(super) struct Four {
    /// Length \[m\], place across \[m\], velocity of the tops in x at x = 0 \[m/s\].
    pub length: [f64; LANES],
    pub y: [f64; LANES],
    pub velocity_x: [f64; LANES],
    /// How far integrals count.
    pub closed: [f64; LANES],
    /// Ends of what is pressed on the road \[m\].
    pub rear: [f64; LANES],
    pub front: [f64; LANES],
    /// Integrals over the spacing: of the pressure, of what is pressed on the road of it, times x.
    pub all: [f64; LANES],
    pub pressed: [f64; LANES],
    pub pressed_lever: [f64; LANES],
    /// The most friction of what is pressed, over its pressure \[N/Pa\].
    pub most: [f64; LANES],
    /// The normal force over a bristle's area, and the sum over the bristles that it is without integrals.
    pub load: [f64; LANES],
    pub normal: [f64; LANES],
    /// Sum of the bristles' forces, x and y \[N\].
    pub force: [[f64; LANES]; 2],
    /// Sums over bristles: pressures that pull, shares of those in contact and of those that stick, pressures that slide.
    pub pulling: [f64; LANES],
    pub touching: [f64; LANES],
    pub sticking: [f64; LANES],
    pub summed: [f64; LANES],
    /// Power of friction, and slip speed times pressure.
    pub power: [f64; LANES],
    pub slip: [f64; LANES],
    pub shares: Shares,
}

impl Four {
    /// Adds what sums over the bristles of four stripes lack, now that it is known what sticks in them.
    #[inline(always)]
    pub fn finish<S: Simd>(&self, simd: S, patch: &Patch<'_>, total: &mut Total<S>) {
        let Patch { deformation, path, spacings, .. } = *patch;
        let (zero, one) = (f64x4::splat(simd, 0.0), f64x4::splat(simd, 1.0));
        let closed = lanes(simd, &self.closed, 0);
        let open = -closed + 1.0;
        let (sliding, summed) = (lanes(simd, &self.shares.sliding[0], 0), lanes(simd, &self.summed, 0));

        // what the trapezoidal rule lacks of the pressure that slides, it lacks of the friction
        let pressed = lanes(simd, &self.pressed, 0);
        let lacks = pressed - lanes(simd, &self.shares.held[0], 0) - sliding;
        let lever = lanes(simd, &self.pressed_lever, 0)
            - lanes(simd, &self.shares.held[1], 0)
            - lanes(simd, &self.shares.sliding[1], 0);
        let slides = sliding.simd_gt(0.0);
        let per_pressure = slides.select(closed / slides.select(sliding, one), zero);
        let mu_x = lanes(simd, &self.shares.friction[0], 0) * per_pressure;
        let mu_y = lanes(simd, &self.shares.friction[1], 0) * per_pressure;
        let (force_x, force_y) = (mu_x * lacks, mu_y * lacks);
        let some = (lacks * lacks).simd_gt(0.0);
        let middle = some.select(lever / some.select(lacks, one), zero);
        let x = smaller(larger(middle, lanes(simd, &self.rear, 0)), lanes(simd, &self.front, 0));
        let y = lanes(simd, &self.y, 0) + deformation.shift_y;
        let normal = lanes(simd, &self.normal, 0);
        total.moment_x += (lanes(simd, &self.load, 0) - normal) * y;
        total.moment_z += mu_y * (lever - x * lacks);

        // in no stripe is more friction than the law has for what is pressed on the road
        let summed_pressed = normal + lanes(simd, &self.pulling, 0);
        let most = lanes(simd, &self.most, 0) * (closed * pressed + open * summed_pressed);
        let all_x = lanes(simd, &self.force[0], 0) + lanes(simd, &self.shares.force[0], 0) + force_x;
        let all_y = lanes(simd, &self.force[1], 0) + lanes(simd, &self.shares.force[1], 0) + force_y;
        let size = (all_x * all_x + all_y * all_y).sqrt();
        let is_more = size.simd_gt(most);
        let too_much = is_more.select(most / is_more.select(size, one) - 1.0, zero);
        let is_pressed = pressed.simd_gt(0.0);
        let centre =
            is_pressed.select(lanes(simd, &self.pressed_lever, 0) / is_pressed.select(pressed, one), zero);
        total.force_x += all_x + all_x * too_much;
        total.force_y += all_y + all_y * too_much;
        for (x, fx, fy) in [(x, force_x, force_y), (centre, all_x * too_much, all_y * too_much)] {
            let place_y = (x * -deformation.bend + deformation.twist) * x + y;
            let velocity_x =
                (x * path.velocity_x[2] + path.velocity_x[1]) * x + lanes(simd, &self.velocity_x, 0);
            let velocity_y = (x * path.velocity_y[2] + path.velocity_y[1]) * x + path.velocity_y[0];
            let free_y = velocity_y - (x * path.led[1] + path.led[0]);
            total.moment_z += x * fy - place_y * fx;
            total.work -= fx * velocity_x + fy * free_y;
        }

        let is_summed = summed.simd_gt(0.0);
        let grows = larger(slides.select(sliding + lacks, summed), zero) / is_summed.select(summed, one);
        let more = is_summed.select(closed * (grows - 1.0) + 1.0, one);
        total.power += lanes(simd, &self.power, 0) * more;
        total.slip += lanes(simd, &self.slip, 0) * more;
        total.negative +=
            closed * (pressed - lanes(simd, &self.all, 0)) + open * lanes(simd, &self.pulling, 0);
        let length = lanes(simd, &self.length, 0);
        let sticks = smaller(larger(lanes(simd, &self.shares.sticking, 0), zero), length);
        let touching = lanes(simd, &self.touching, 0);
        total.touching += closed * length * spacings + open * touching;
        total.sliding +=
            closed * (length - sticks) * spacings + open * (touching - lanes(simd, &self.sticking, 0));
    }
}
