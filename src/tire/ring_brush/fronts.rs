//! Where bristles break away between each other, and what sums over bristles lack for that.

use super::bristle::norm;
use super::bristles::{Bristles, MAX_PER_STRIPE};
use super::passage::{Friction, Sums};
use super::patch::Path;
use super::share::{END, refinement, surplus};
use super::{Deformation, Limits};

/// Spacings that are none.
const ROUNDING: f64 = 1e-9;
const BITS: usize = u64::BITS as usize;
const WORDS: usize = MAX_PER_STRIPE.div_ceil(BITS);

/// Which bristles of a stripe are in contact and which stick, a bit for each of its window.
pub(super) struct Pattern {
    touches: [u64; WORDS],
    sticks: [u64; WORDS],
    used: usize,
}

impl Pattern {
    pub fn new() -> Self {
        Self { touches: [0; WORDS], sticks: [0; WORDS], used: 0 }
    }

    /// Forgets the last stripe.
    pub fn clear(&mut self) {
        self.touches[..self.used].fill(0);
        self.sticks[..self.used].fill(0);
        self.used = 0;
    }

    /// Takes four more.
    #[inline(always)]
    pub fn push(&mut self, at: usize, touches: u64, sticks: u64) {
        let word = at / BITS;
        self.touches[word] |= touches << (at % BITS);
        self.sticks[word] |= sticks << (at % BITS);
        self.used = word + 1;
    }

    /// Every bristle that slides behind one that sticks.
    fn each_front(&self, is_forward: bool, mut front: impl FnMut(usize)) {
        for word in 0..self.used {
            let sticks = |word: Option<usize>| word.and_then(|w| self.sticks.get(w)).copied().unwrap_or(0);
            let own = self.sticks[word];
            let neighbours = if is_forward {
                own >> 1 | sticks(Some(word + 1)) << (BITS - 1)
            } else {
                own << 1 | sticks(word.checked_sub(1)) >> (BITS - 1)
            };
            let mut slid = self.touches[word] & !own & neighbours;
            while slid != 0 {
                front(word * BITS + slid.trailing_zeros() as usize);
                slid &= slid - 1;
            }
        }
    }

    /// The first in contact, if it slides.
    fn first_slides(&self, is_forward: bool) -> Option<usize> {
        let mut words = (0..self.used).filter(|w| self.touches[*w] != 0);
        let word = if is_forward { words.next_back()? } else { words.next()? };
        let bits = self.touches[word];
        let bit = if is_forward { bits.ilog2() } else { bits.trailing_zeros() };
        (self.sticks[word] >> bit & 1 == 0).then_some(word * BITS + bit as usize)
    }
}

/// The fronts of a stripe, at which bristles break away.
///
/// Up to a front the force grows with the sticking bristles to the limit of sticking, and falls there to that of sliding.
/// What sums over bristles lack of the integral over such a function, the formula of Euler and Maclaurin tells from the
/// jump, J, that of the slope, J', and the distance from the front to the next bristle in spacings, t:
/// B1(t) J + B2(t) J' / 2. Where the front is follows from what the last sticking one will be loaded with when it comes to
/// where the next one is; between bristles the limits are parabolas through three points.
///
/// That holds where the front moves over the bristles because they travel. Where a bristle is loaded up to its limit
/// within less than a spacing, many break away at a time, and where the wheel hardly rolls, what is ahead of a bristle
/// says nothing of what it will do: so less of this counts if the load of a spacing is larger than the largest limit, and,
/// as with the direction of the rolling resistance (4.22), if the wheel rolls slower than 1 m/s.
pub(super) struct Fronts<'a> {
    pub bristles: &'a Bristles,
    pub deformation: &'a Deformation<f64>,
    pub friction: &'a Friction,
    /// Spacings in a metre.
    pub per_length: f64,
    /// Travel of the bristles through the patch, positive to the front \[m/s\].
    pub feed: f64,
    /// By how much the force of a sticking bristle falls in a spacing for each m/s of its top \[N.s/m\].
    pub growth: f64,
    /// How much of a front counts at most.
    pub share: f64,
    /// The largest limit of sticking that a bristle can have.
    pub strongest: f64,
}

/// A stripe with its fronts.
pub(super) struct Stripe<'a> {
    pub fronts: &'a Fronts<'a>,
    pub path: &'a Path<f64>,
    /// Place across, length, first bristle.
    pub y: f64,
    pub length: f64,
    pub row: usize,
}

/// A front: what is there, and what is around it.
struct Front {
    /// The first that slides.
    slid: usize,
    /// Place \[m\], and spacings from there to the next place of a bristle.
    place: f64,
    distance: f64,
    /// Force of a bristle that sticks at the front, and how it grows in a spacing.
    loaded: [f64; 2],
    growth: [f64; 2],
    /// Limit of sliding at the front, and how it grows in a spacing.
    sliding: f64,
    sliding_slope: f64,
}

impl Stripe<'_> {
    /// What all fronts of the stripe change in the sums.
    pub fn add_all(&self, pattern: &Pattern, sums: &mut Sums) {
        let from = self.row + self.fronts.bristles.window[0];
        pattern.each_front(self.is_forward(), |slid| {
            let slid = from + slid;
            let held = if self.is_forward() { slid + 1 } else { slid - 1 };
            self.between(held, slid, sums);
        });
        if let Some(first) = pattern.first_slides(self.is_forward()) {
            self.before(from + first, sums);
        }
    }

    /// The front between two bristles.
    fn between(&self, held: usize, slid: usize, sums: &mut Sums) {
        let (velocity, growth) = self.growth(0.5 * (self.place(held) + self.place(slid)));
        let force = self.force(held);
        // limits over the way from the one that sticks to the one that slides, 0 to 1
        let (at_held, at_slid) = (self.limits(held), self.limits(slid));
        let (sticking, sliding) = self.parabolas(held, &at_held, &at_slid);
        let below = (sticking.start - norm(force)).max(0.0);
        let above = norm([force[0] + growth[0], force[1] + growth[1]]) - (sticking.start + sticking.rise);
        // a bristle that would still stick slides because it broke away elsewhere
        let mut part = 1.0;
        if above > 0.0 {
            part = below / (below + above);
            // one step of Newton's method for the curved limit
            let slope = below + above - sticking.sag_slope(part);
            if slope > 0.0 {
                part = (part + sticking.sag(part) / slope).clamp(0.0, 1.0);
            }
        }
        let weaker = self.fronts.friction.at_speed(velocity);
        let front = Front {
            slid,
            place: self.place(held) + part * (self.place(slid) - self.place(held)),
            distance: 1.0 - part,
            loaded: std::array::from_fn(|c| force[c] + part * growth[c]),
            growth,
            sliding: weaker * sliding.at(part),
            sliding_slope: weaker * sliding.slope(part),
        };
        self.add(&front, sums);
    }

    /// The front between the end where bristles come in and the first bristle, which slides. Near the end bristles stick,
    /// if the limit rises faster than the load.
    fn before(&self, first: usize, sums: &mut Sums) {
        let second = self.behind_by(first, 1).filter(|k| self.fronts.bristles.share[*k] > 0.0);
        let spacings = self.from_end(first);
        let (Some(second), true) = (second, spacings > 0.0) else { return };
        let (at_first, at_second) = (self.limits(first), self.limits(second));
        // the limit of sticking at t spacings from the end: rise t + bend t^2
        let chord = at_first.sticking / spacings;
        let bend = at_second.sticking / (spacings + 1.0) - chord;
        let rise = chord - bend * spacings;
        let (velocity, growth) = self.growth(self.place(first));
        let load = norm(growth);
        let at = (rise - load) / -bend;
        if bend >= 0.0 || load >= rise || at >= spacings {
            return;
        }
        let distance = spacings - at;
        let weaker = self.fronts.friction.at_speed(velocity) * at_first.sliding / at_first.sticking;
        let front = Front {
            slid: first,
            place: self.place(first) + self.forward(distance),
            distance,
            loaded: growth.map(|g| g * at),
            growth,
            sliding: weaker * load * at,
            sliding_slope: weaker * (rise + 2.0 * bend * at),
        };
        self.add(&front, sums);
    }

    fn add(&self, front: &Front, sums: &mut Sums) {
        let Fronts { bristles, deformation, strongest, .. } = *self.fronts;
        let Front { slid, distance, loaded, growth, .. } = *front;
        let square = |[x, y]: [f64; 2]| x * x + y * y;
        let mut counts = self.fronts.share;
        if square(growth) > strongest * strongest {
            counts *= strongest / norm(growth);
        }
        let per_load = 1.0 / norm(loaded).max(f64::MIN_POSITIVE);
        let direction = loaded.map(|f| f * per_load);
        let refined = refinement(self.length * self.fronts.per_length);
        let first = distance - 0.5;
        let second = 0.5 * ((distance - 1.0) * distance + refined / 6.0);
        let mut force: [f64; 2] = std::array::from_fn(|c| {
            first * (direction[c] * front.sliding - loaded[c])
                + second * (direction[c] * front.sliding_slope - growth[c])
        });
        // where bristles near the end count other than 1, that is meant for what goes on from there
        for n in 0..END {
            let Some(k) = self.behind_by(slid, n) else { break };
            let from_end = self.from_end(k);
            if bristles.share[k] == 0.0 || from_end >= END as f64 {
                break;
            }
            let (own, beyond) = (self.force(k), surplus(from_end, refined));
            for c in 0..2 {
                force[c] += beyond * (loaded[c] + (distance + n as f64) * growth[c] - own[c]);
            }
        }
        // at most as if the one that slides stuck: in no sum is more friction than the law allows
        let most = bristles.share[slid] * (self.limits(slid).sticking - norm(self.force(slid))).max(0.0);
        if square(force) > most * most {
            counts = counts.min(most / norm(force));
        }
        let [force_x, force_y] = force.map(|f| counts * f);
        let [place_x, place_y] = deformation.place(front.place, self.y);
        sums.force[0] += force_x;
        sums.force[1] += force_y;
        sums.moment[1] += place_x * force_y - place_y * force_x;
        sums.work += self.path.power(front.place, [force_x, force_y]);
    }

    /// Velocity of the tops at x, and by how much the force of a sticking bristle grows in a spacing there.
    fn growth(&self, x: f64) -> ([f64; 2], [f64; 2]) {
        let velocity = self.path.velocity(x);
        (velocity, velocity.map(|v| -self.fronts.growth * v))
    }

    /// Bristles go to the rear.
    fn is_forward(&self) -> bool {
        self.fronts.feed < 0.0
    }

    /// So many spacings towards the end where bristles come in \[m\].
    fn forward(&self, spacings: f64) -> f64 {
        if self.is_forward() { spacings / self.fronts.per_length } else { -spacings / self.fronts.per_length }
    }

    /// The bristle that is so many behind another one.
    fn behind_by(&self, k: usize, number: usize) -> Option<usize> {
        let next = if self.is_forward() { k.checked_sub(number)? } else { k + number };
        (next >= self.row && next < self.row + self.fronts.bristles.per_stripe).then_some(next)
    }

    fn place(&self, k: usize) -> f64 {
        self.fronts.bristles.first_place + (k - self.row) as f64 / self.fronts.per_length
    }

    /// Spacings from the end at which bristles come in.
    fn from_end(&self, k: usize) -> f64 {
        let x = if self.is_forward() { self.place(k) } else { -self.place(k) };
        (0.5 * self.length - x) * self.fronts.per_length
    }

    fn force(&self, k: usize) -> [f64; 2] {
        [self.fronts.bristles.force_x[k], self.fronts.bristles.force_y[k]]
    }

    fn limits(&self, k: usize) -> Limits<f64> {
        self.fronts.friction.limits(self.fronts.bristles.pressure[k])
    }

    /// Both limits from one bristle to the next, curved as they are with the one before, or with the end of the stripe.
    fn parabolas(&self, held: usize, at_held: &Limits<f64>, at_slid: &Limits<f64>) -> (Parabola, Parabola) {
        let before = if self.is_forward() { Some(held + 1) } else { held.checked_sub(1) };
        let before = before.filter(|k| self.fronts.bristles.share[*k] > 0.0).map(|k| self.limits(k));
        let spacings = self.from_end(held);
        let parabola = |limit: fn(&Limits<f64>) -> f64| {
            let (start, end) = (limit(at_held), limit(at_slid));
            let rise = end - start;
            let curvature = match &before {
                Some(before) => limit(before) - start + rise,
                None => 2.0 * (rise - start / spacings.max(ROUNDING)) / (1.0 + spacings),
            };
            Parabola { start, rise, curvature }
        };
        (parabola(|l| l.sticking), parabola(|l| l.sliding))
    }
}

/// A parabola by its value at 0, the rise from 0 to 1, and its curvature.
struct Parabola {
    start: f64,
    rise: f64,
    curvature: f64,
}

impl Parabola {
    /// What it has at `t` beyond the straight line from 0 to 1.
    fn sag(&self, t: f64) -> f64 {
        0.5 * self.curvature * t * (t - 1.0)
    }

    fn sag_slope(&self, t: f64) -> f64 {
        self.curvature * (t - 0.5)
    }

    fn at(&self, t: f64) -> f64 {
        self.start + self.rise * t + self.sag(t)
    }

    fn slope(&self, t: f64) -> f64 {
        self.rise + self.sag_slope(t)
    }
}
