//! Ends of stretches of bristles that stick, and what sums over bristles lack for them: four at once.

use super::friction::Friction;
use super::passage::Passage;
use super::patch::{Path, Pressure, Shape};
use super::{Deformation, Parameters};
use crate::solver::lanes::{LANES, exp2, larger, log2, smaller, sum};
use fearless_simd::{Simd, f64x4, prelude::*};

/// Where a place changes by so little, over itself and times the exponent, its power is followed by a parabola: what that
/// lacks, a sixth of the cube of this, is below 2e-4 of the highest pressure.
const NEAR: f64 = 0.1;

/// A way that leads away from a node, over which the force of a bristle that sticks grows, while its limit is
/// `limit + rise t + bend t²`, t in spacings. Where the two meet, bristles break away.
macro_rules! way {
    ($($(#[$doc:meta])* $field:ident,)*) => {
        #[derive(Debug, Clone, Copy, Default)]
        pub(super) struct Way<T> {
            $($(#[$doc])* pub $field: T,)*
        }

        impl Way<[f64; LANES]> {
            fn put(&mut self, lane: usize, way: &Way<f64>) {
                $(self.$field[lane] = way.$field;)*
            }

            #[inline(always)]
            fn lanes<S: Simd>(&self, simd: S) -> Way<f64x4<S>> {
                Way { $($field: f64x4::from_slice(simd, &self.$field),)* }
            }
        }
    };
}

way! {
    /// Place of the node \[m\].
    from,
    /// 1 if the way leads to the front, -1.
    side,
    /// Its length in spacings.
    spacings,
    /// Force of a bristle at the node \[N\].
    force_x,
    force_y,
    /// By how much it grows in a spacing.
    growth_x,
    growth_y,
    limit,
    rise,
    bend,
    /// Where the two meet, if that is known, or negative.
    meets,
    /// How far it counts that they meet.
    breaks,
    /// The node at the end of the way, a bristle that slides: 1, place, force and pressure, or 0.
    next,
    next_x,
    next_force_x,
    next_force_y,
    next_pressure,
    /// The end of the stripe: place, and integrals of the pressure up to there.
    bound_x,
    bound_pressure,
    bound_lever,
    /// What sticks reaches from the end of the stripe on, before the way as well: 1. It is 0 where the way leads to the end.
    begins,
    /// The way itself begins there: 1. The node at `from` is no bristle then and in no sum.
    enters,
    /// Place of the stripe across \[m\].
    y,
    /// Velocity of its tops in x at x = 0.
    velocity_x,
    /// Factor of the stripe in the shape of the pressure, and the logarithm of its length to base 2.
    factor,
    logarithm,
    /// How far integrals count in the stripe.
    closed,
}

/// What does not change from stripe to stripe.
pub(super) struct Patch<'a> {
    pub p: &'a Parameters,
    pub deformation: &'a Deformation<f64>,
    pub friction: Friction,
    /// Area of a bristle times the road's factor on its friction \[m²\].
    pub grip_area: f64,
    pub pressure: &'a Pressure<f64>,
    /// Velocity of the tops; of that in x, the part without x is the stripe's own.
    pub path: Path<f64>,
    /// Exponent of the pressure along the stripes, g, and 1 / (g + 1), 1 / (g + 2), 1 / (g + 3).
    pub exponent: f64,
    pub over: [f64; 3],
    pub spacings: f64,
}

impl<'a> Patch<'a> {
    pub fn new(passage: &Passage<'a>, p: &'a Parameters, pressure: &'a Pressure<f64>) -> Self {
        let (exponent, _) = Shape::new(p, passage.contact.penetration).exponents();
        Self {
            p,
            deformation: passage.deformation,
            friction: Friction::new(p),
            grip_area: p.cell_area() * passage.friction,
            pressure,
            path: passage.tops.at_stripe(0.0),
            exponent,
            over: [1.0, 2.0, 3.0].map(|n| 1.0 / (exponent + n)),
            spacings: 1.0 / p.bristle_length,
        }
    }

    /// Up to here a bristle with this pressure sticks \[N\].
    pub fn sticking(&self, pressure: f64) -> f64 {
        self.friction.limits(pressure, pressure * self.grip_area).sticking
    }

    /// The most that the limit of a bristle is over its pressure, up to this pressure \[Pa\].
    pub fn most(&self, highest: f64) -> f64 {
        self.grip_area * self.friction.most(highest)
    }
}

/// Sums over what sticks and slides in four stripes.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Shares {
    /// Pressure that slides, times 1 and x.
    pub sliding: [[f64; LANES]; 2],
    /// Its friction.
    pub friction: [[f64; LANES]; 2],
    /// Integrals of the pressure that sticks, times 1 and x.
    pub held: [[f64; LANES]; 2],
    /// Length that sticks \[m\].
    pub sticking: [f64; LANES],
    /// What the sums of the bristles' forces lack, x and y \[N\].
    pub force: [[f64; LANES]; 2],
}

/// What sums over bristles lack of integrals.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Lacking {
    /// About z, with places from the middle of the stripe in x.
    pub moment: f64,
    pub work: f64,
    /// Squared deflections \[m²\].
    pub stored: f64,
}

/// Ends that wait to be worked on.
#[derive(Default)]
pub(super) struct Ends {
    used: usize,
    stripes: [usize; LANES],
    ways: Way<[f64; LANES]>,
    /// What sums over bristles lack for all that were worked on.
    pub lacking: Lacking,
}

impl Ends {
    /// Takes a way of one of the four stripes.
    pub fn push<S: Simd>(
        &mut self,
        simd: S,
        patch: &Patch<'_>,
        stripe: usize,
        way: &Way<f64>,
        shares: &mut Shares,
    ) {
        self.stripes[self.used] = stripe;
        self.ways.put(self.used, way);
        self.used += 1;
        if self.used == LANES {
            self.work(simd, patch, shares);
        }
    }

    /// Works on those that wait.
    #[inline(never)]
    pub fn work<S: Simd>(&mut self, simd: S, patch: &Patch<'_>, shares: &mut Shares) {
        if self.used == 0 {
            return;
        }
        for lane in self.used..LANES {
            // a way of no length, where nothing is pressed
            self.ways.put(lane, &Way { from: 1.0, ..Way::default() });
        }
        let found = simd.vectorize(
            #[inline(always)]
            || end(simd, patch, &self.ways.lanes(simd), &mut self.lacking),
        );
        for (lane, stripe) in self.stripes[..self.used].iter().enumerate() {
            let Shares { sliding, friction, held, sticking, force } = &found;
            for c in 0..2 {
                shares.sliding[c][*stripe] += sliding[c][lane];
                shares.friction[c][*stripe] += friction[c][lane];
                shares.held[c][*stripe] += held[c][lane];
                shares.force[c][*stripe] += force[c][lane];
            }
            shares.sticking[*stripe] += sticking[lane];
        }
        self.used = 0;
    }
}

/// The length of four vectors.
#[inline(always)]
fn norm<S: Simd>([x, y]: [f64x4<S>; 2]) -> f64x4<S> {
    (x * x + y * y).sqrt()
}

/// Four vectors, each times a number.
#[inline(always)]
fn times<S: Simd>([x, y]: [f64x4<S>; 2], factor: f64x4<S>) -> [f64x4<S>; 2] {
    [x * factor, y * factor]
}

/// c0 + c1 x + c2 x².
#[inline(always)]
fn parabola<S: Simd>(x: f64x4<S>, c0: f64x4<S>, c1: f64, c2: f64) -> f64x4<S> {
    (x * c2 + c1) * x + c0
}

impl<S: Simd> Way<f64x4<S>> {
    /// Force of a bristle that sticks at t.
    #[inline(always)]
    fn force(&self, t: f64x4<S>) -> [f64x4<S>; 2] {
        [self.growth_x * t + self.force_x, self.growth_y * t + self.force_y]
    }

    /// t where it is on the way, or its nearer end.
    #[inline(always)]
    fn within(&self, simd: S, t: f64x4<S>) -> f64x4<S> {
        smaller(larger(t, f64x4::splat(simd, 0.0)), self.spacings)
    }

    #[inline(always)]
    fn place(&self, patch: &Patch<'_>, t: f64x4<S>) -> f64x4<S> {
        self.side * t * patch.p.bristle_length + self.from
    }

    /// (2 |x| / length)^g.
    #[inline(always)]
    fn power(&self, simd: S, patch: &Patch<'_>, x: f64x4<S>) -> f64x4<S> {
        let power = exp2(simd, (log2(simd, x.abs() * 2.0) - self.logarithm) * patch.exponent);
        smaller(power, f64x4::splat(simd, 1.0))
    }

    /// The pressure where the power has this value.
    #[inline(always)]
    fn pressed(&self, simd: S, patch: &Patch<'_>, x: f64x4<S>, power: f64x4<S>) -> f64x4<S> {
        let Pressure { level, tilt, .. } = *patch.pressure;
        larger((x * tilt + level) * self.factor * (-power + 1.0), f64x4::splat(simd, 0.0))
    }

    /// Velocity of the tops.
    #[inline(always)]
    fn velocity(&self, simd: S, patch: &Patch<'_>, x: f64x4<S>) -> [f64x4<S>; 2] {
        let Path { velocity_x: [_, x1, x2], velocity_y: [y0, y1, y2], .. } = patch.path;
        [parabola(x, self.velocity_x, x1, x2), parabola(x, f64x4::splat(simd, y0), y1, y2)]
    }

    /// Integral over what sticks, from the integrals up to where sticking ends and up to the end of the stripe.
    #[inline(always)]
    fn held(&self, there: f64x4<S>, bound: f64x4<S>) -> [f64; LANES] {
        (self.side * self.breaks * (there - self.begins * bound)).into()
    }
}

/// Works on four ends: returns what they change in their stripes.
#[inline(always)]
fn end<S: Simd>(simd: S, patch: &Patch<'_>, way: &Way<f64x4<S>>, lacking: &mut Lacking) -> Shares {
    let Patch { p, deformation, ref friction, grip_area, pressure, path, exponent, over, .. } = *patch;
    let (zero, one) = (f64x4::splat(simd, 0.0), f64x4::splat(simd, 1.0));
    let tiny = f64x4::splat(simd, f64::MIN_POSITIVE);
    let w = way.spacings;

    // where the line meets the parabola: a chord, and a step of Newton's method
    let (load, there) = (norm([way.force_x, way.force_y]), norm(way.force(w)));
    let below = larger(way.limit - load, zero);
    let above = there - (way.limit + (way.rise + way.bend * w) * w);
    let whole = larger(below + above, tiny);
    let per_spacing = one / larger(w, tiny);
    let t = w * below / whole;
    let slope = whole * per_spacing - way.bend * (t * 2.0 - w);
    let t = slope.simd_gt(0.0).select(way.within(simd, t + way.bend * t * (t - w) / slope), t);
    // a bristle that would still stick slides because it broke away elsewhere
    let t = above.simd_gt(0.0).select(t, w);
    let t = way.meets.simd_ge(0.0).select(way.meets, t);

    // a step more, with the pressure itself
    let near = way.place(patch, t);
    let power = way.power(simd, patch, near);
    let pressed = way.pressed(simd, patch, near, power);
    let limits = friction.limits_of_four(simd, pressed, pressed * grip_area);
    let gap = limits.sticking - norm(way.force(t));
    let slope = way.rise + way.bend * t * 2.0 - (there - load) * per_spacing;
    let goes = slope.simd_lt(0.0);
    let t = goes.select(way.within(simd, t - gap / smaller(slope, -tiny)), t);
    let x = way.place(patch, t);
    let by = x / near - 1.0;
    let is_near = (by * exponent).abs().simd_lt(NEAR);
    let followed = power * ((by * (0.5 * (exponent - 1.0)) + 1.0) * by * exponent + 1.0);
    let power =
        if is_near.all_true() { followed } else { is_near.select(followed, way.power(simd, patch, x)) };
    let power = smaller(larger(power, zero), one);

    // what is there
    let pressed = way.pressed(simd, patch, x, power);
    let limits = friction.limits_of_four(simd, pressed, pressed * grip_area);
    let sliding = friction.at_speed_of_four(limits.sliding, way.velocity(simd, patch, x));
    let force = way.force(t);
    let per_size = one / larger(norm(force), tiny);
    let held = times(force, smaller(limits.sticking * per_size, one));
    let slid = times(times(force, per_size), sliding);

    // nodes: the first, the bristle that slides, both sides of where sticking ends
    let half = way.breaks * 0.5;
    let (before, behind) = (half * t, half * (w - t));
    let no_longer = before * way.next;
    let nodes = [
        (way.from, way.enters * half * w - behind, [way.force_x, way.force_y]),
        (way.next_x, -no_longer, [way.next_force_x, way.next_force_y]),
        (x, before, held),
        (x, behind, slid),
    ];
    let (mut force_x, mut force_y, mut moment, mut work, mut stored) = (zero, zero, zero, zero, zero);
    for (x, share, [node_x, node_y]) in nodes {
        let (fx, fy) = (share * node_x, share * node_y);
        let [velocity_x, velocity_y] = way.velocity(simd, patch, x);
        let place_y = parabola(x, way.y + deformation.shift_y, deformation.twist, -deformation.bend);
        force_x += fx;
        force_y += fy;
        moment += x * fy - place_y * fx;
        work -= fx * velocity_x + fy * (velocity_y - (x * path.led[1] + path.led[0]));
        stored += fx * node_x + fy * node_y;
    }
    // products of what is linear over the way are curved
    let (grown_x, grown_y) = (held[0] - way.force_x, held[1] - way.force_y);
    let lever = way.breaks * way.side * t * t * (p.bristle_length / 6.0);
    moment -= lever * grown_y;
    work += lever * (grown_x * path.velocity_x[1] + grown_y * (path.velocity_y[1] - path.led[1]));
    stored -= way.breaks * t * (1.0 / 6.0) * (grown_x * grown_x + grown_y * grown_y);
    lacking.moment += sum(moment * way.closed);
    lacking.work += sum(work * way.closed);
    lacking.stored += sum(stored * way.closed) / (p.bristle_stiffness * p.bristle_stiffness);

    // integrals of the pressure up to there
    let scale = way.factor * patch.spacings;
    let squared = x * x;
    let first = x * (-power * over[0] + 1.0);
    let second = squared * (-power * over[1] + 0.5);
    let third = squared * x * (-power * over[2] + 1.0 / 3.0);
    let up_to = scale * (first * pressure.level + second * pressure.tilt);
    let lever = scale * (second * pressure.level + third * pressure.tilt);
    // nothing sticks beyond where anything is pressed; a way that begins at that end leads away from it
    let is_pressed = (way.side * (x - way.bound_x)).simd_le(0.0) | way.begins.simd_gt(0.0);
    let up_to = is_pressed.select(up_to, way.bound_pressure);
    let lever = is_pressed.select(lever, way.bound_lever);
    let end = is_pressed.select(x, way.bound_x);
    let (slides, stops) = (behind * pressed, no_longer * way.next_pressure);
    Shares {
        sliding: [(slides - stops).into(), (slides * x - stops * way.next_x).into()],
        friction: [
            (slid[0] * behind - no_longer * way.next_force_x).into(),
            (slid[1] * behind - no_longer * way.next_force_y).into(),
        ],
        held: [way.held(up_to, way.bound_pressure), way.held(lever, way.bound_lever)],
        sticking: way.held(end, way.bound_x),
        force: [(force_x * way.closed).into(), (force_y * way.closed).into()],
    }
}
