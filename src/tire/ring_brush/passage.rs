//! The bristles' passage through the patch in a step: how the normal force is spread over them, what each does, and the
//! sums of what they do (4.17)-(4.34). Four bristles are worked on at once.
//!
//! A bristle stands for the cell around it. So that sums over bristles do not ripple while these pass one by one, they
//! are integrals over the stripe by the trapezoidal rule: up to the stripe's ends, which lie between bristles, and up to
//! where stretches of bristles that stick end, which they do there, too (see [`Patch`]).

use super::bristle::norm;
use super::bristles::Bristles;
use super::patch::{Pressure, Shape};
use super::stretches::{Patch, Pattern, Sliding, Stripe};
use super::stripes::closed;
use super::{Contact, Deformation, Limits, Parameters, Prepared, Tops};
use crate::solver::lanes::{LANES, exp2, larger, log2, smaller, sum};
use crate::{Error, Result};
use fearless_simd::{Level, Simd, dispatch, f64x4, prelude::*};

/// A bristle that is by so many spacings out of the contact is in it by rounding.
const ROUNDING: f64 = 1e-9;

/// What presses bristles on the road and moves them in a step.
pub struct Passage<'a> {
    /// The contact at the end of the step.
    pub contact: &'a Contact<f64>,
    /// The motion of the tops at mid-step.
    pub tops: &'a Tops<f64>,
    /// How the patch sits on the belt at the end of the step.
    pub deformation: &'a Deformation<f64>,
    /// Moment about the lateral axis that the pressures have to make \[N.m\] (4.22).
    pub moment: f64,
    /// Spin angle of the belt over the road at the end \[rad\].
    pub spin: f64,
    /// By how much bristles have come to the rear in the step \[m\].
    pub shift: f64,
    /// Factor on both coefficients of friction.
    pub friction: f64,
    /// The step \[s\].
    pub dt: f64,
}

/// Sums over the bristles at the end of a step. Each counts as far as its cell is in contact.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Sums {
    /// Force on the patch, x and y \[N\].
    pub force: [f64; 2],
    /// Its moment about x and z \[N.m\].
    pub moment: [f64; 2],
    /// Bristles in contact.
    pub touching: f64,
    /// Bristles that slide.
    pub sliding: f64,
    /// Power of friction \[W\].
    pub power: f64,
    /// Slip speed times normal force \[W\].
    pub slip: f64,
    /// Sum of the normal forces that pull \[N\].
    pub negative: f64,
    /// Largest pressure \[Pa\].
    pub highest: f64,
    /// Power that they take out of the belt \[W\].
    pub work: f64,
}

/// Friction of bristles over their pressure (4.32).
pub(super) struct Friction {
    /// Coefficient of sticking at no pressure, and how it grows with it \[1/Pa\].
    pub sticking: [f64; 2],
    /// The same of sliding.
    pub sliding: [f64; 2],
    /// Area of a bristle times the road's factor \[m²\].
    pub area: f64,
    /// Fall of the sliding friction with the speed \[s/m\].
    pub falloff: f64,
}

impl Friction {
    fn new(p: &Parameters, factor: f64) -> Self {
        let per_pressure = p.friction_pressure_scale / p.friction_pressure;
        let line = |[at_zero, at_reference]: [f64; 2]| [at_zero, per_pressure * (at_reference - at_zero)];
        Self {
            sticking: line(p.friction_static),
            sliding: line(p.friction_sliding),
            area: p.cell_area() * factor,
            falloff: p.friction_speed_falloff,
        }
    }

    /// The limits of a bristle with this pressure \[Pa\], that of sliding at no speed; see [`Limits::new`].
    pub fn limits(&self, pressure: f64) -> Limits<f64> {
        let held = pressure.max(0.0) * self.area;
        let limit = |[at_zero, slope]: [f64; 2]| (at_zero + slope * pressure).max(0.0) * held;
        Limits { sticking: limit(self.sticking), sliding: limit(self.sliding) }
    }

    /// What is left of the sliding friction at a velocity \[m/s\] of the top.
    pub fn at_speed(&self, velocity: [f64; 2]) -> f64 {
        if self.falloff == 0.0 { 1.0 } else { 1.0 / (1.0 + self.falloff * norm(velocity)) }
    }
}

impl Prepared {
    /// Moves the bristles through the patch, spreads the normal force over them and sums up what they do, with the
    /// instructions of `level`, which change no bit of the result.
    ///
    /// # Errors
    /// The patch gets longer than the ring of bristles.
    pub fn pass(
        &self,
        level: Level,
        bristles: &mut Bristles,
        passage: &Passage<'_>,
    ) -> Result<(Sums, Pressure<f64>)> {
        let p = self.parameters();
        let contact = passage.contact;
        std::mem::swap(&mut bristles.old_lengths, &mut bristles.stripes.lengths);
        dispatch!(level, simd => self.measure(simd, contact, &mut bristles.stripes));
        let longest = bristles.stripes.longest();
        if longest > p.ring_length() {
            return Err(Error::numeric(format!(
                "the contact patch is {longest:.3} m long, the ring of bristles only {:.3} m: more or longer bristles are needed for this deflection",
                p.ring_length()
            )));
        }
        bristles.wind(p, passage.spin);
        bristles.look_at(window(p, bristles, longest));
        let shapes = self.sum_shapes(contact.penetration, bristles);
        let moment = passage.moment + passage.deformation.shift_x * contact.normal_force;
        let pressure = Pressure::new(p, &shapes, contact.normal_force, moment, longest);
        let sums = dispatch!(level, simd => self.bristles(simd, bristles, passage, &pressure));
        Ok((sums, pressure))
    }

    /// The bristles' law, four at once; see [`advance`](super::advance), which is the law for one.
    #[inline(always)]
    fn bristles<S: Simd>(
        &self,
        simd: S,
        bristles: &mut Bristles,
        passage: &Passage<'_>,
        pressure: &Pressure<f64>,
    ) -> Sums {
        let p = self.parameters();
        let Passage { tops, deformation, shift, friction, dt, .. } = *passage;
        let splat = |x: f64| f64x4::splat(simd, x);
        let (zero, one) = (splat(0.0), splat(1.0));
        let (c, d, area) = (p.bristle_stiffness, p.bristle_damping, p.cell_area());
        let law = Friction::new(p, friction);
        let Friction {
            sticking: [static_0, static_slope], sliding: [sliding_0, sliding_slope], falloff, ..
        } = law;
        let tiny = splat(f64::MIN_POSITIVE);
        let stride = bristles.stride();
        let [from, to] = bristles.window;
        let all_relaxed = one / splat(dt * c + d);
        let mut total = Lanes::new(simd);
        let (mut rest, mut stored) = (Sums::default(), 0.0);
        let mut pattern = Pattern::new();
        let (exponent, _) = Shape::new(p, passage.contact.penetration).exponents();
        let spacings = 1.0 / p.bristle_length;
        for j in (from..to).step_by(LANES) {
            // the same in all stripes
            let size = places(simd, p, bristles, j).abs();
            log2(simd, size * 2.0).store_slice(&mut bristles.logarithms[j..j + LANES]);
        }
        for (i, y) in self.stripe_places().iter().enumerate() {
            let (length, old_length) = (bristles.stripes.lengths[i], bristles.old_lengths[i]);
            if length <= 0.0 && old_length <= 0.0 {
                continue;
            }
            let (half, old_half) = (0.5 * length, 0.5 * old_length);
            let (factor, logarithm) = (bristles.stripes.factors[i], bristles.stripes.logarithms[i]);
            let path = tops.at_stripe(*y);
            let (vx, vy, led) = (path.velocity_x, path.velocity_y, path.led);
            let (mut power, mut slip) = (zero, zero);
            for j in (from..to).step_by(LANES) {
                let k = i * stride + j;
                let x = places(simd, p, bristles, j);
                let inside = -x.abs() + half;
                // the pressure, and how much of it counts
                let shape = exp2(simd, (four(simd, &bristles.logarithms, j) - logarithm) * exponent);
                let shape = larger(-shape + 1.0, zero) * factor;
                let touches = inside.simd_ge(0.0) & shape.simd_gt(0.0);
                let cell_pressure = touches.select(shape, zero) * (x * pressure.tilt + pressure.level);
                let mut counts = touches.select(one, zero);
                if !p.whole_step_entry {
                    let farther = smaller((x.abs() + half) * spacings, one);
                    counts = counts * (smaller(inside * spacings, one) + farther) * 0.5;
                }

                // friction limits: linear in the pressure (4.32), neither is negative; 0 out of contact
                let held = larger(cell_pressure, zero) * law.area;
                let sticking_limit = larger(cell_pressure * static_slope + static_0, zero) * held;
                let mut sliding_limit = larger(cell_pressure * sliding_slope + sliding_0, zero) * held;

                // a bristle that came into contact within the step is loaded for the rest of it only
                let inside_before = -(x + shift).abs() + old_half;
                let enters = inside.simd_gt(0.0) & inside_before.simd_lt(0.0);
                let (mut loaded, mut per_relaxed) = (one, all_relaxed);
                if !p.whole_step_entry && enters.any_true() {
                    loaded = enters.select(inside / (inside - inside_before), one);
                    per_relaxed = one / (loaded * (dt * c) + d);
                }
                let time = loaded * dt;
                let middle = loaded * (0.5 * shift) + x;
                let velocity_x = (middle * vx[2] + vx[1]) * middle + vx[0];
                let velocity_y = (middle * vy[2] + vy[1]) * middle + vy[0];

                // radial return
                let (old_x, old_y) =
                    (four(simd, &bristles.deflection_x, k), four(simd, &bristles.deflection_y, k));
                let resistance = time * c + d;
                let trial_x = old_x * c - velocity_x * resistance;
                let trial_y = old_y * c - velocity_y * resistance;
                let trial = (trial_x * trial_x + trial_y * trial_y).sqrt();
                if falloff != 0.0 {
                    let speed = (velocity_x * velocity_x + velocity_y * velocity_y).sqrt();
                    sliding_limit = sliding_limit / (speed * falloff + 1.0);
                }
                let stuck = four(simd, &bristles.stick, k).simd_gt(0.0);
                let bound = stuck.select(sticking_limit, sliding_limit);
                let sticks = bound.simd_gt(0.0) & trial.simd_le(bound);
                let cut = sticks.select(one, sliding_limit / larger(trial, tiny));
                let slip_speed = sticks.select(zero, (trial - sliding_limit) * per_relaxed);
                let (force_x, force_y) = (trial_x * cut, trial_y * cut);
                let (relaxes, gives) = (per_relaxed * d, per_relaxed * time);
                let (new_x, new_y) = (force_x * gives + old_x * relaxes, force_y * gives + old_y * relaxes);

                cell_pressure.store_slice(&mut bristles.pressure[k..k + LANES]);
                new_x.store_slice(&mut bristles.deflection_x[k..k + LANES]);
                new_y.store_slice(&mut bristles.deflection_y[k..k + LANES]);
                force_x.store_slice(&mut bristles.force_x[k..k + LANES]);
                force_y.store_slice(&mut bristles.force_y[k..k + LANES]);
                sticks.select(one, zero).store_slice(&mut bristles.stick[k..k + LANES]);
                counts.store_slice(&mut bristles.share[k..k + LANES]);

                let free_y = velocity_y - (middle * led[1] + led[0]);
                total.work -= (force_x * velocity_x + force_y * free_y) * (loaded * counts);
                let slipping = slip_speed * counts;
                power += sliding_limit * slipping;
                slip += larger(cell_pressure, zero) * slipping;
            }
            // the sums by themselves: nothing there waits for a root and a quotient
            let (mut normal, mut pulling, mut touching, mut sticking) = (zero, zero, zero, zero);
            let mut sliding = [zero; 4];
            pattern.clear();
            for j in (from..to).step_by(LANES) {
                let k = i * stride + j;
                let x = places(simd, p, bristles, j);
                let (counts, sticks) = (four(simd, &bristles.share, k), four(simd, &bristles.stick, k));
                let cell_pressure = four(simd, &bristles.pressure, k);
                let (new_x, new_y) =
                    (four(simd, &bristles.deflection_x, k), four(simd, &bristles.deflection_y, k));
                let fx = four(simd, &bristles.force_x, k) * counts;
                let fy = four(simd, &bristles.force_y, k) * counts;
                let counted = cell_pressure * counts;
                let place_y = (x * -deformation.bend + deformation.twist) * x + (y + deformation.shift_y);
                total.force_x += fx;
                total.force_y += fy;
                total.moment_x += place_y * counted;
                total.moment_z += x * fy - place_y * fx;
                total.highest = larger(cell_pressure, total.highest);
                total.stored += (new_x * new_x + new_y * new_y) * counts;
                normal += counted;
                pulling += larger(-counted, zero);
                touching += counts;
                sticking += counts * sticks;
                let stuck = sticks.simd_gt(0.0);
                let slid = stuck.select(zero, larger(counted, zero));
                sliding[0] += slid;
                sliding[1] += slid * x;
                sliding[2] += stuck.select(zero, fx);
                sliding[3] += stuck.select(zero, fy);
                pattern.push(j - from, counts.simd_gt(0.0).to_bitmask(), stuck.to_bitmask());
            }
            let closed = closed(p, length);
            let mut more = 1.0;
            if closed > 0.0 {
                let patch =
                    Patch { p, bristles, deformation, friction: &law, pressure, exponent, feed: tops.feed() };
                let stripe =
                    Stripe { patch: &patch, path: &path, row: i * stride, y: *y, length, logarithm, factor };
                let [pressed, lever, force_x, force_y] = sliding.map(|s| sum(s));
                let lacking = stripe
                    .lacking(&pattern, Sliding { pressure: [pressed, lever], force: [force_x, force_y] });
                let [level, tilt] = bristles.stripes.sums[i];
                let load = pressure.level * level + pressure.tilt * tilt - sum(normal);
                more += closed * (lacking.sliding - 1.0);
                rest.force[0] += closed * lacking.force[0];
                rest.force[1] += closed * lacking.force[1];
                rest.moment[0] += area * load * (y + deformation.shift_y);
                rest.moment[1] += closed * lacking.moment;
                rest.work += closed * lacking.work;
                stored += closed * lacking.stored;
                rest.negative += closed * lacking.pulls;
                rest.touching += closed * length * spacings;
                rest.sliding += closed * (length * spacings - lacking.sticking);
            }
            total.negative += pulling * (1.0 - closed);
            total.touching += touching * (1.0 - closed);
            total.sticking += sticking * (1.0 - closed);
            total.power += power * more;
            total.slip += slip * more;
        }
        bristles.stored = sum(total.stored) + stored;
        Sums {
            force: [sum(total.force_x) + rest.force[0], sum(total.force_y) + rest.force[1]],
            moment: [
                area * sum(total.moment_x) + rest.moment[0],
                sum(total.moment_z) + deformation.shift_x * sum(total.force_y) + rest.moment[1],
            ],
            touching: sum(total.touching) + rest.touching,
            sliding: sum(total.touching) - sum(total.sticking) + rest.sliding,
            power: sum(total.power),
            slip: area * sum(total.slip),
            negative: area * (sum(total.negative) + rest.negative),
            highest: <[f64; LANES]>::from(total.highest).into_iter().fold(0.0, f64::max),
            work: sum(total.work) + rest.work,
        }
    }
}

/// Sums that are not yet added up over the lanes.
struct Lanes<S: Simd> {
    force_x: f64x4<S>,
    force_y: f64x4<S>,
    moment_x: f64x4<S>,
    moment_z: f64x4<S>,
    touching: f64x4<S>,
    sticking: f64x4<S>,
    power: f64x4<S>,
    slip: f64x4<S>,
    negative: f64x4<S>,
    highest: f64x4<S>,
    work: f64x4<S>,
    stored: f64x4<S>,
}

impl<S: Simd> Lanes<S> {
    #[inline(always)]
    fn new(simd: S) -> Self {
        let zero = f64x4::splat(simd, 0.0);
        Self {
            force_x: zero,
            force_y: zero,
            moment_x: zero,
            moment_z: zero,
            touching: zero,
            sticking: zero,
            power: zero,
            slip: zero,
            negative: zero,
            highest: zero,
            work: zero,
            stored: zero,
        }
    }
}

/// The bristles that are in contact with stripes up to this length.
fn window(p: &Parameters, bristles: &Bristles, longest: f64) -> [usize; 2] {
    if longest <= 0.0 {
        return [0; 2];
    }
    let number = |x: f64| (x - bristles.first_place) / p.bristle_length;
    // what is negative becomes 0
    let from = (number(-0.5 * longest) - ROUNDING).ceil() as usize;
    let to = (number(0.5 * longest) + ROUNDING + 1.0).floor() as usize;
    let n = bristles.per_stripe;
    [from.min(n), to.clamp(from.min(n), n)]
}

/// Four numbers from `k` on.
#[inline(always)]
fn four<S: Simd>(simd: S, values: &[f64], k: usize) -> f64x4<S> {
    f64x4::from_slice(simd, &values[k..k + LANES])
}

/// Places of four bristles from `j` on.
#[inline(always)]
fn places<S: Simd>(simd: S, p: &Parameters, bristles: &Bristles, j: usize) -> f64x4<S> {
    const FIRST: [f64; LANES] = [0.0, 1.0, 2.0, 3.0];
    (f64x4::from_slice(simd, &FIRST) + j as f64) * p.bristle_length + bristles.first_place
}
