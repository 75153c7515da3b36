//! Stretches of a stripe whose bristles stick, and the ways at their ends.
//!
//! The sum over the bristles of a stripe is the trapezoidal rule with the bristles and the two ends as nodes. Two things
//! are missing in it.
//!
//! Where a stretch that sticks ends between two nodes, the force jumps from the limit of sticking to that of sliding. The
//! force of bristles that stick, followed on from the last two, meets the limit there: that place becomes a node, with
//! both forces. So it does at the ends of a stripe whose outermost bristle sticks. Where bristles come in, the line goes on
//! to the end, where it is 0 in steady rolling.
//!
//! Where bristles slide, their force follows the pressure, which is curved. What the trapezoidal rule lacks of the
//! pressure's integral, which has a closed form, it lacks of the friction.

use super::bristle::norm;
use super::bristles::{Bristles, MAX_PER_STRIPE};
use super::ends::{Ends, Lacking, Patch, Shares, Way};
use super::entry::Entry;
use super::patch::{Path, Pressure};
use fearless_simd::Simd;

/// From this speed \[m/s\] on a wheel rolls: a bristle is through the contact within about a second, and what is ahead of
/// another one comes to it. Below, the rule for what sticks at the exit fades into that of a wheel that stands. Ten times
/// less or more changes mean forces of the example tire between 3 mm/s and 3 m/s by less than 1.5 %.
const ROLLS: f64 = 0.1;
const BITS: usize = u64::BITS as usize;
const WORDS: usize = MAX_PER_STRIPE.div_ceil(BITS);

/// Which bristles of a stripe are in contact and which of them stick, a bit for each of its window.
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
        self.sticks[word] |= (sticks & touches) << (at % BITS);
        self.used = word + 1;
    }

    /// The first and the last in contact.
    fn ends(&self) -> Option<[usize; 2]> {
        let first = (0..self.used).find(|w| self.touches[*w] != 0)?;
        let last = (0..self.used).rfind(|w| self.touches[*w] != 0)?;
        let high = BITS - 1 - self.touches[last].leading_zeros() as usize;
        Some([first * BITS + self.touches[first].trailing_zeros() as usize, last * BITS + high])
    }

    fn sticks(&self, at: usize) -> bool {
        self.sticks[at / BITS] >> (at % BITS) & 1 == 1
    }

    /// Every stretch of bristles that stick: its first and its last.
    fn each_stretch(&self, mut stretch: impl FnMut(usize, usize)) {
        let mut begun = None;
        for word in 0..self.used {
            let base = word * BITS;
            // where the bits change, from the last one of the word before
            let own = self.sticks[word];
            let mut changes = own ^ (own << 1 | u64::from(begun.is_some()));
            while changes != 0 {
                let at = base + changes.trailing_zeros() as usize;
                changes &= changes - 1;
                match begun.take() {
                    Some(first) => stretch(first, at - 1),
                    None => begun = Some(at),
                }
            }
        }
        if let Some(first) = begun {
            stretch(first, self.used * BITS - 1);
        }
    }
}

/// A stripe, one of four that are worked on together.
pub(super) struct Stretches<'a> {
    pub patch: &'a Patch<'a>,
    pub bristles: &'a Bristles,
    /// Its number among the four, and that of the first bristle of its row.
    pub lane: usize,
    pub row: usize,
    /// Travel of the bristles through the patch, positive to the front \[m/s\].
    pub feed: f64,
    /// Place across \[m\].
    pub y: f64,
    /// Velocity of the tops in x at x = 0 \[m/s\].
    pub velocity_x: f64,
    /// Length \[m\], its logarithm to base 2, and the stripe's factor in the shape of the pressure.
    pub length: f64,
    pub logarithm: f64,
    pub factor: f64,
    /// How far integrals count.
    pub closed: f64,
    /// The ends of what is pressed on the road.
    pub bounds: [Bound; 2],
}

/// An end of what is pressed on the road in a stripe.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Bound {
    pub x: f64,
    /// (2 |x| / length)^g there.
    pub power: f64,
    /// Integrals of the pressure from the middle, over the spacing, times 1 and x.
    pub pressure: [f64; 2],
}

impl Bound {
    /// The ends of a stripe of this length, and of what is pressed on the road of it.
    pub fn of(patch: &Patch<'_>, length: f64, logarithm: f64, factor: f64) -> ([Self; 2], [Self; 2]) {
        let Patch { pressure: &Pressure { level, tilt, .. }, exponent, over, spacings, .. } = *patch;
        let scale = factor * spacings;
        let at = |x: f64, power: f64| {
            let first = x * (1.0 - power * over[0]);
            let second = x * x * (0.5 - power * over[1]);
            let third = x * x * x * (1.0 / 3.0 - power * over[2]);
            let pressure = [scale * (level * first + tilt * second), scale * (level * second + tilt * third)];
            Self { x, power, pressure }
        };
        let half = 0.5 * length;
        let all = [at(-half, 1.0), at(half, 1.0)];
        let pressed = all.map(|end| {
            if level + tilt * end.x >= 0.0 {
                return end;
            }
            let x = (-level / tilt).clamp(-half, half);
            at(x, libm::exp2(exponent * (libm::log2(2.0 * x.abs()) - logarithm)).min(1.0))
        });
        (all, pressed)
    }
}

impl Stretches<'_> {
    /// Hands over the ends of all stretches that stick, and adds what is between them.
    pub fn hand_over<S: Simd>(&self, simd: S, pattern: &Pattern, ends: &mut Ends, shares: &mut Shares) {
        let from = self.row + self.bristles.window[0];
        pattern.each_stretch(|first, last| {
            let (first, last) = (from + first, from + last);
            for (held, side) in [(first, -1.0), (last, 1.0)] {
                let growth = self.growth(held, side, first == last);
                let breaks = match self.neighbour(held, side) {
                    Some(_) => 1.0,
                    None if self.is_entry(side) => 0.0,
                    None => self.rolls(),
                };
                if breaks < 1.0 {
                    self.go_on(held, side, growth, 1.0 - breaks, shares, &mut ends.lacking);
                }
                if breaks > 0.0 {
                    let way = self.way(held, side, growth, breaks);
                    ends.push(simd, self.patch, self.lane, &way, shares);
                }
            }
            if last > first {
                // many equal intervals
                let grown = difference(self.force(last), self.force(first));
                self.add_products(
                    1.0 / (last - first) as f64,
                    (last - first) as f64,
                    grown,
                    &mut ends.lacking,
                );
            }
        });
        if let (Some([first, last]), true) = (pattern.ends(), self.feed != 0.0) {
            let outer = if self.is_forward() { last } else { first };
            if !pattern.sticks(outer)
                && let Some(way) = self.entry(from + outer, shares)
            {
                ends.push(simd, self.patch, self.lane, &way, shares);
            }
        }
    }

    /// What all ways of the stripe have.
    fn own(&self, side: f64, bound: &Bound) -> Way<f64> {
        Way {
            side,
            meets: -1.0,
            bound_x: bound.x,
            bound_pressure: bound.pressure[0],
            bound_lever: bound.pressure[1],
            y: self.y,
            velocity_x: self.velocity_x,
            factor: self.factor,
            logarithm: self.logarithm,
            closed: self.closed,
            ..Way::default()
        }
    }

    /// By how much the force grows in a spacing from the outermost bristle of a stretch on.
    fn growth(&self, held: usize, side: f64, alone: bool) -> [f64; 2] {
        if alone {
            return self.growth_of_one(held).map(|g| if self.is_entry(side) { -g } else { g });
        }
        let inner = if side > 0.0 { held - 1 } else { held + 1 };
        difference(self.force(held), self.force(inner))
    }

    /// Follows the force on to the end of the stripe, a node at which it counts by `share`.
    fn go_on(
        &self,
        held: usize,
        side: f64,
        growth: [f64; 2],
        share: f64,
        shares: &mut Shares,
        lacking: &mut Lacking,
    ) {
        let Patch { p, deformation, path, spacings, .. } = *self.patch;
        let bound = &self.bounds[usize::from(side > 0.0)];
        let (x, force) = (bound.x, self.force(held));
        let length = (side * (x - self.place(held)) * spacings).max(0.0);
        let outer: [f64; 2] = std::array::from_fn(|c| force[c] + length * growth[c]);
        // in no sum is more friction than the law allows
        let most = (self.limit(held) - norm(force)).max(0.0);
        let part = (most / norm(outer).max(f64::MIN_POSITIVE)).min(1.0);
        let outer = outer.map(|f| part * f);
        let [fx, fy] = outer.map(|f| 0.5 * self.closed * share * length * f);
        let [x0, x1, x2] = [self.velocity_x, path.velocity_x[1], path.velocity_x[2]];
        let [y0, y1, y2] = path.velocity_y;
        let (velocity_x, velocity_y) = ((x2 * x + x1) * x + x0, (y2 * x + y1) * x + y0);
        let [_, place_y] = deformation.place(x, self.y);
        shares.force[0][self.lane] += fx;
        shares.force[1][self.lane] += fy;
        lacking.moment += x * fy - place_y * fx;
        lacking.work -= fx * velocity_x + fy * (velocity_y - (path.led[0] + path.led[1] * x));
        lacking.stored += (fx * outer[0] + fy * outer[1]) / (p.bristle_stiffness * p.bristle_stiffness);
        self.add_products(share * length, side * length, difference(outer, force), lacking);
        shares.held[0][self.lane] += share * side * bound.pressure[0];
        shares.held[1][self.lane] += share * side * bound.pressure[1];
        shares.sticking[self.lane] += share * side * x;
    }

    /// The way from a bristle, the outermost of a stretch on this side, to the next node.
    fn way(&self, held: usize, side: f64, growth: [f64; 2], breaks: f64) -> Way<f64> {
        let spacings = self.patch.spacings;
        let bound = &self.bounds[usize::from(side > 0.0)];
        let (next, inner) = (self.neighbour(held, side), self.neighbour(held, -side));
        let (from, [force_x, force_y]) = (self.place(held), self.force(held));
        let [growth_x, growth_y] = growth;
        let length = if next.is_some() { 1.0 } else { (side * (bound.x - from) * spacings).max(0.0) };
        // the limit as a parabola through three nodes
        let limit = |k: Option<usize>| k.map_or(0.0, |k| self.limit(k));
        let behind = if inner.is_some() { 1.0 } else { (0.5 * self.length + side * from) * spacings };
        let at = limit(Some(held));
        let ahead = (limit(next) - at) / length.max(f64::MIN_POSITIVE);
        let bend = (ahead + (limit(inner) - at) / behind) / (length + behind);
        let mut way = Way {
            from,
            spacings: length,
            force_x,
            force_y,
            growth_x,
            growth_y,
            limit: at,
            rise: ahead - bend * length,
            bend,
            breaks,
            ..self.own(side, bound)
        };
        if let Some(next) = next {
            self.slides_at_the_end(next, &mut way);
        }
        way
    }

    fn slides_at_the_end(&self, next: usize, way: &mut Way<f64>) {
        way.next = 1.0;
        way.next_x = self.place(next);
        [way.next_force_x, way.next_force_y] = self.force(next);
        way.next_pressure = self.bristles.pressure[next].max(0.0);
    }

    /// The way on which bristles that came to rest behind the entry stick, to the outermost or second one, which slides.
    fn entry(&self, first: usize, shares: &mut Shares) -> Option<Way<f64>> {
        let entry = self.entry_at();
        let side = entry.side;
        let length = side * (self.place(first) - entry.x) * self.patch.spacings;
        if length <= 0.0 || entry.rests == f64::INFINITY {
            return None;
        }
        // an outermost bristle that has yet to come to rest is on the way already
        let (from, passed, [force_x, force_y], enters, next) = if length < entry.rests {
            let next = self.neighbour(first, side).filter(|next| self.bristles.stick[*next] == 0.0)?;
            (self.place(first), length, self.force(first), 0.0, next)
        } else {
            (entry.x, 0.0, entry.force, 1.0, first)
        };
        let there = side * (self.place(next) - entry.x) * self.patch.spacings;
        let (meets, bend) = entry.breaks_away(there, self.limit(next))?;
        let [growth_x, growth_y] = entry.growth;
        let breaks = self.rolls();
        if enters == 0.0 {
            // what sticks reaches from the end over this bristle, which the sums take for one that slides
            let share = breaks * self.bristles.share[first];
            let pressed = share * self.bristles.pressure[first].max(0.0);
            shares.sliding[0][self.lane] -= pressed;
            shares.sliding[1][self.lane] -= pressed * from;
            shares.friction[0][self.lane] -= share * force_x;
            shares.friction[1][self.lane] -= share * force_y;
        }
        let mut way = Way {
            from,
            spacings: there - passed,
            force_x,
            force_y,
            growth_x,
            growth_y,
            rise: entry.rise + 2.0 * bend * passed,
            bend,
            meets: (meets - passed).max(0.0),
            breaks,
            begins: 1.0,
            enters,
            ..self.own(side, &self.bounds[usize::from(self.is_forward())])
        };
        self.slides_at_the_end(next, &mut way);
        Some(way)
    }

    fn entry_at(&self) -> Entry {
        let Patch { path, .. } = *self.patch;
        let [_, x1, x2] = path.velocity_x;
        let path = Path { velocity_x: [self.velocity_x, x1, x2], ..path };
        Entry::new(self.patch, &path, self.feed, &self.bounds, self.factor)
    }

    /// What products of place, velocity and force, each of which is linear between bristles, have less than the
    /// trapezoidal rule says: over `way` spacings, to the rear if negative, on which the force grows by so much. They count
    /// by `share`, which is that of an interval in the way.
    fn add_products(&self, share: f64, way: f64, [x, y]: [f64; 2], lacking: &mut Lacking) {
        let Patch { p, path, .. } = *self.patch;
        let share = self.closed / 6.0 * share;
        let lever = share * way * p.bristle_length;
        lacking.moment -= lever * y;
        lacking.work += lever * (x * path.velocity_x[1] + y * (path.velocity_y[1] - path.led[1]));
        lacking.stored -= share * (x * x + y * y) / (p.bristle_stiffness * p.bristle_stiffness);
    }

    /// By how much the force of a bristle grows in a spacing towards the exit, if it alone sticks.
    fn growth_of_one(&self, held: usize) -> [f64; 2] {
        if self.feed == 0.0 {
            return [0.0; 2];
        }
        let side = if self.is_forward() { 1.0 } else { -1.0 };
        match self.neighbour(held, side) {
            Some(before) => difference(self.force(held), self.force(before)),
            // it was not deflected where it came in
            None => {
                let spacings = (0.5 * self.length - side * self.place(held)) * self.patch.spacings;
                let per_spacing = self.patch.p.bristle_stiffness / spacings.max(f64::MIN_POSITIVE);
                [self.bristles.deflection_x[held], self.bristles.deflection_y[held]].map(|u| u * per_spacing)
            }
        }
    }

    /// How far what is ahead of a bristle tells what it will do. Where the wheel stands it does not.
    fn rolls(&self) -> f64 {
        (self.feed.abs() / ROLLS).min(1.0)
    }

    /// Bristles go to the rear.
    fn is_forward(&self) -> bool {
        self.feed < 0.0
    }

    /// Bristles come in on this side.
    fn is_entry(&self, side: f64) -> bool {
        self.feed != 0.0 && (side > 0.0) == self.is_forward()
    }

    /// The next bristle in contact on a side.
    fn neighbour(&self, k: usize, side: f64) -> Option<usize> {
        let next = if side > 0.0 { k + 1 } else { k.checked_sub(1)? };
        let in_row = next >= self.row && next < self.row + self.bristles.per_stripe;
        (in_row && self.bristles.share[next] > 0.0).then_some(next)
    }

    fn place(&self, k: usize) -> f64 {
        self.bristles.place(self.patch.p, k - self.row)
    }

    fn force(&self, k: usize) -> [f64; 2] {
        [self.bristles.force_x[k], self.bristles.force_y[k]]
    }

    /// Up to here a bristle sticks.
    fn limit(&self, k: usize) -> f64 {
        self.patch.sticking(self.bristles.pressure[k])
    }
}

fn difference(a: [f64; 2], b: [f64; 2]) -> [f64; 2] {
    [a[0] - b[0], a[1] - b[1]]
}
