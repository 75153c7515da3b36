//! The bristles' passage through the patch in a step: how the normal force is spread over them, what each does, and the
//! sums of what they do (4.17)-(4.34). Four bristles are worked on at once.
//!
//! A bristle stands for the cell around it. So that sums over bristles do not ripple while these pass one by one, they
//! are integrals over the stripe by the trapezoidal rule: up to the stripe's ends, which lie between bristles, and up to
//! where stretches of bristles that stick end, which they do there, too (see `stretches.rs`).

use super::bristles::Bristles;
use super::ends::{Ends, Patch};
use super::entry::Entry;
use super::patch::{Path, Pressure};
use super::stretches::{Bound, Pattern, Stretches};
use super::stripes::closed;
use super::totals::{Four, Total};
use super::turning::Slid;
use super::{Contact, Deformation, Limits, Parameters, Prepared, Tops};
use crate::solver::lanes::{LANES, exp2, lanes, larger, log2, smaller, sum};
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
        let patch = Patch::new(passage, p, &pressure);
        let sums = dispatch!(level, simd => Pass::new(simd, self, &patch, passage).all(simd, bristles));
        Ok((sums, pressure))
    }
}

/// What all bristles have in a step.
struct Pass<'a, S: Simd> {
    tire: &'a Prepared,
    patch: &'a Patch<'a>,
    passage: &'a Passage<'a>,
    /// 1 / (dt c + d).
    relaxed: f64x4<S>,
}

/// A stripe, and which of four it is.
#[derive(Clone, Copy)]
struct Stripe {
    lane: usize,
    number: usize,
    y: f64,
    length: f64,
    path: Path<f64>,
    /// Its ends, and those of what is pressed on the road of it.
    whole: [Bound; 2],
    pressed: [Bound; 2],
}

impl<'a, S: Simd> Pass<'a, S> {
    #[inline(always)]
    fn new(simd: S, tire: &'a Prepared, patch: &'a Patch<'a>, passage: &'a Passage<'a>) -> Self {
        let p = tire.parameters();
        let relaxed = f64x4::splat(simd, 1.0)
            / f64x4::splat(simd, passage.dt * p.bristle_stiffness + p.bristle_damping);
        Self { tire, patch, passage, relaxed }
    }

    #[inline(always)]
    fn all(&self, simd: S, bristles: &mut Bristles) -> Sums {
        let p = self.patch.p;
        let [from, to] = bristles.window;
        for j in (from..to).step_by(LANES) {
            // the same in all stripes
            let size = places(simd, p, bristles, j).abs();
            log2(simd, size * 2.0).store_slice(&mut bristles.logarithms[j..j + LANES]);
        }
        let mut total = Total::new(simd);
        let (mut ends, mut pattern) = (Ends::default(), Pattern::new());
        let mut numbers = 0..self.tire.stripe_places().len();
        while !numbers.is_empty() {
            let mut four = Four::default();
            for (lane, number) in numbers.by_ref().take(LANES).enumerate() {
                let (length, old_length) = (bristles.stripes.lengths[number], bristles.old_lengths[number]);
                if length <= 0.0 {
                    if old_length > 0.0 {
                        bristles.lift(number);
                    }
                    continue;
                }
                let y = self.tire.stripe_places()[number];
                let (logarithm, factor) =
                    (bristles.stripes.logarithms[number], bristles.stripes.factors[number]);
                let (whole, pressed) = Bound::of(self.patch, length, logarithm, factor);
                let path = self.passage.tops.at_stripe(y);
                let stripe = Stripe { lane, number, y, length, path, whole, pressed };
                self.advance(simd, &stripe, bristles, &mut four, &mut total);
                self.sum(simd, &stripe, bristles, &mut pattern, &mut four, &mut total);
                self.hand_over(simd, &stripe, bristles, &pattern, &mut four, &mut ends);
            }
            ends.work(simd, self.patch, &mut four.shares);
            four.finish(simd, self.patch, &mut total);
        }
        let (area, rest) = (p.cell_area(), ends.lacking);
        let force_y = sum(total.force_y);
        bristles.stored = sum(total.stored) + rest.stored;
        Sums {
            force: [sum(total.force_x), force_y],
            moment: [
                area * sum(total.moment_x),
                sum(total.moment_z) + self.passage.deformation.shift_x * force_y + rest.moment,
            ],
            touching: sum(total.touching),
            sliding: sum(total.sliding),
            power: sum(total.power),
            slip: area * sum(total.slip),
            negative: area * sum(total.negative),
            highest: <[f64; LANES]>::from(total.highest).into_iter().fold(0.0, f64::max),
            work: sum(total.work) + rest.work,
        }
    }

    /// The bristles' law, four at once; see [`advance`](super::advance), which is the law for one that is in the contact all
    /// the time: without what happens at the entry.
    #[inline(always)]
    fn advance(
        &self,
        simd: S,
        stripe: &Stripe,
        bristles: &mut Bristles,
        four: &mut Four,
        total: &mut Total<S>,
    ) {
        let Patch { p, pressure, ref friction, grip_area, exponent, spacings, .. } = *self.patch;
        let Passage { shift, dt, .. } = *self.passage;
        let splat = |x: f64| f64x4::splat(simd, x);
        let (zero, one, tiny) = (splat(0.0), splat(1.0), splat(f64::MIN_POSITIVE));
        let (c, d) = (p.bristle_stiffness, p.bristle_damping);
        let (half, old_half) = (0.5 * stripe.length, 0.5 * bristles.old_lengths[stripe.number]);
        let factor = bristles.stripes.factors[stripe.number];
        let logarithm = bristles.stripes.logarithms[stripe.number];
        let Path { velocity_x: vx, velocity_y: vy, led } = stripe.path;
        let feed = self.passage.tops.feed();
        // how far inside the end they come to rest
        let (mut rests, mut inward) = (splat(f64::INFINITY), 0.0);
        if feed != 0.0 && !p.whole_step_entry {
            let entry = Entry::new(self.patch, &stripe.path, feed, &stripe.pressed, factor);
            (rests, inward) = (splat(half - entry.x.abs() + entry.rests * p.bristle_length), entry.side);
        }
        let (mut power, mut slip) = (zero, zero);
        let [from, to] = bristles.window;
        for j in (from..to).step_by(LANES) {
            let k = stripe.number * bristles.stride() + j;
            let x = places(simd, p, bristles, j);
            let inside = -x.abs() + half;
            // the pressure, and how much of it counts
            let exponents = smaller((lanes(simd, &bristles.logarithms, j) - logarithm) * exponent, zero);
            let shape = (-exp2(simd, exponents) + 1.0) * factor;
            let touches = inside.simd_ge(0.0) & shape.simd_gt(0.0);
            let cell_pressure = touches.select(shape, zero) * (x * pressure.tilt + pressure.level);
            let mut counts = touches.select(one, zero);
            if !p.whole_step_entry {
                let farther = smaller((x.abs() + half) * spacings, one);
                counts = counts * (smaller(inside * spacings, one) + farther) * 0.5;
            }

            // 0 out of contact
            let Limits { sticking: sticking_limit, sliding: sliding_limit } =
                friction.limits_of_four(simd, cell_pressure, cell_pressure * grip_area);

            // a bristle that came into contact within the step is loaded for the rest of it only
            let inside_before = -(x + shift).abs() + old_half;
            let enters = inside.simd_gt(0.0) & inside_before.simd_lt(0.0);
            let (mut loaded, mut per_relaxed) = (one, self.relaxed);
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
                (lanes(simd, &bristles.deflection_x, k), lanes(simd, &bristles.deflection_y, k));
            let resistance = time * c + d;
            let trial_x = old_x * c - velocity_x * resistance;
            let trial_y = old_y * c - velocity_y * resistance;
            let trial = (trial_x * trial_x + trial_y * trial_y).sqrt();
            let sliding_limit = friction.at_speed_of_four(sliding_limit, [velocity_x, velocity_y]);
            // what travels past the place where bristles come to rest does, however far it gets in the step
            let outside_of_it = (-(x + shift).abs() + half).simd_lt(rests);
            let came_to_rest = inside.simd_ge(rests) & outside_of_it & (x * inward).simd_lt(0.0);
            let stuck = lanes(simd, &bristles.stick, k).simd_gt(0.0) | came_to_rest;
            let bound = stuck.select(sticking_limit, sliding_limit);
            let sticks = bound.simd_gt(0.0) & trial.simd_le(bound);
            let cut = sticks.select(one, sliding_limit / larger(trial, tiny));
            let slip_speed = sticks.select(zero, (trial - sliding_limit) * per_relaxed);
            let (mut force_x, mut force_y) = (trial_x * cut, trial_y * cut);
            let slides = !sticks & sliding_limit.simd_gt(0.0);
            if !p.whole_step_entry && slides.any_true() {
                let spring = time * c;
                let dragged = [velocity_x * spring, velocity_y * spring];
                let slid = Slid { trial: [trial_x, trial_y], dragged, held: stuck.select(bound, -one) };
                let turned = slid.force_of_four(simd, trial, sliding_limit, [force_x, force_y]);
                force_x = slides.select(turned[0], force_x);
                force_y = slides.select(turned[1], force_y);
            }
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
            total.work -= (force_x * velocity_x + force_y * free_y) * counts;
            let slipping = slip_speed * counts;
            power += sliding_limit * slipping;
            slip += larger(cell_pressure, zero) * slipping;
        }
        four.power[stripe.lane] = sum(power);
        four.slip[stripe.lane] = sum(slip);
    }

    /// The sums by themselves: nothing there waits for a root and a quotient.
    #[inline(always)]
    fn sum(
        &self,
        simd: S,
        stripe: &Stripe,
        bristles: &Bristles,
        pattern: &mut Pattern,
        four: &mut Four,
        total: &mut Total<S>,
    ) {
        let (p, deformation) = (self.patch.p, self.patch.deformation);
        let zero = f64x4::splat(simd, 0.0);
        let middle_y = stripe.y + deformation.shift_y;
        let (mut force_x, mut force_y) = (zero, zero);
        let (mut normal, mut pulling, mut touching, mut sticking) = (zero, zero, zero, zero);
        let (mut sliding, mut lever, mut friction_x, mut friction_y) = (zero, zero, zero, zero);
        pattern.clear();
        let [from, to] = bristles.window;
        for j in (from..to).step_by(LANES) {
            let k = stripe.number * bristles.stride() + j;
            let x = places(simd, p, bristles, j);
            let (counts, sticks) = (lanes(simd, &bristles.share, k), lanes(simd, &bristles.stick, k));
            let cell_pressure = lanes(simd, &bristles.pressure, k);
            let (new_x, new_y) =
                (lanes(simd, &bristles.deflection_x, k), lanes(simd, &bristles.deflection_y, k));
            let fx = lanes(simd, &bristles.force_x, k) * counts;
            let fy = lanes(simd, &bristles.force_y, k) * counts;
            let counted = cell_pressure * counts;
            let place_y = (x * -deformation.bend + deformation.twist) * x + middle_y;
            force_x += fx;
            force_y += fy;
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
            sliding += slid;
            lever += slid * x;
            friction_x += stuck.select(zero, fx);
            friction_y += stuck.select(zero, fy);
            pattern.push(j - from, counts.simd_gt(0.0).to_bitmask(), stuck.to_bitmask());
        }
        let lane = stripe.lane;
        four.force[0][lane] = sum(force_x);
        four.force[1][lane] = sum(force_y);
        four.normal[lane] = sum(normal);
        four.pulling[lane] = sum(pulling);
        four.touching[lane] = sum(touching);
        four.sticking[lane] = sum(sticking);
        four.summed[lane] = sum(sliding);
        four.shares.sliding[0][lane] = four.summed[lane];
        four.shares.sliding[1][lane] = sum(lever);
        four.shares.friction[0][lane] = sum(friction_x);
        four.shares.friction[1][lane] = sum(friction_y);
    }

    /// Looks for what sticks in a stripe, and notes what its integrals need.
    #[inline(always)]
    fn hand_over(
        &self,
        simd: S,
        stripe: &Stripe,
        bristles: &Bristles,
        pattern: &Pattern,
        four: &mut Four,
        ends: &mut Ends,
    ) {
        let Stripe { lane, number, y, length, .. } = *stripe;
        let Pressure { level, tilt, .. } = *self.patch.pressure;
        let [s0, s1] = bristles.stripes.sums[number];
        four.length[lane] = length;
        four.y[lane] = y;
        four.velocity_x[lane] = stripe.path.velocity_x[0];
        four.load[lane] = level * s0 + tilt * s1;
        let (factor, logarithm) = (bristles.stripes.factors[number], bristles.stripes.logarithms[number]);
        four.most[lane] = self.patch.most((level + 0.5 * length * tilt.abs()) * factor);
        let closed = closed(self.patch.p, length);
        if closed == 0.0 {
            return;
        }
        let [rear, front] = stripe.pressed;
        four.closed[lane] = closed;
        four.rear[lane] = rear.x;
        four.front[lane] = front.x;
        four.pressed[lane] = front.pressure[0] - rear.pressure[0];
        four.pressed_lever[lane] = front.pressure[1] - rear.pressure[1];
        four.all[lane] = stripe.whole[1].pressure[0] - stripe.whole[0].pressure[0];
        let stretches = Stretches {
            patch: self.patch,
            bristles,
            lane,
            row: number * bristles.stride(),
            feed: self.passage.tops.feed(),
            y,
            velocity_x: stripe.path.velocity_x[0],
            length,
            logarithm,
            factor,
            closed,
            bounds: stripe.pressed,
        };
        stretches.hand_over(simd, pattern, ends, &mut four.shares);
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

/// Places of four bristles from `j` on.
#[inline(always)]
fn places<S: Simd>(simd: S, p: &Parameters, bristles: &Bristles, j: usize) -> f64x4<S> {
    const FIRST: [f64; LANES] = [0.0, 1.0, 2.0, 3.0];
    (f64x4::from_slice(simd, &FIRST) + j as f64) * p.bristle_length + bristles.first_place
}
