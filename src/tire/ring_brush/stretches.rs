//! Stretches of a stripe whose bristles stick: where they end, and what sums over bristles lack for that.

use super::bristle::norm;
use super::bristles::{Bristles, MAX_PER_STRIPE};
use super::passage::{Friction, Sums};
use super::patch::{Path, Pressure};
use super::stripes::closed;
use super::{Deformation, Limits, Parameters};

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

/// What all stripes share. The sum over the bristles of a stripe is the trapezoidal rule with the bristles and the two ends
/// as nodes. Two things are missing in it.
///
/// Where a stretch that sticks ends between two nodes, the force jumps from the limit of sticking to that of sliding. The
/// force of bristles that stick, followed on from the last two, meets the limit there: that place becomes a node, with both
/// forces. So it does at the ends of a stripe whose outermost bristle sticks. Where bristles come in, the line goes on to
/// the end, where it is 0 in steady rolling.
///
/// Where bristles slide, their force follows the pressure, which is curved. What the trapezoidal rule lacks of the
/// pressure's integral, which has a closed form, it lacks of the friction.
pub(super) struct Patch<'a> {
    pub p: &'a Parameters,
    pub bristles: &'a Bristles,
    pub deformation: &'a Deformation<f64>,
    pub friction: &'a Friction,
    pub pressure: &'a Pressure<f64>,
    /// Exponent of the pressure along the stripes.
    pub exponent: f64,
    /// Travel of the bristles through the patch, positive to the front \[m/s\].
    pub feed: f64,
}

/// A stripe.
pub(super) struct Stripe<'a> {
    pub patch: &'a Patch<'a>,
    pub path: &'a Path<f64>,
    /// Number of the first bristle of the row.
    pub row: usize,
    /// Place across \[m\].
    pub y: f64,
    /// Length \[m\], its logarithm to base 2, and the stripe's factor in the shape of the pressure.
    pub length: f64,
    pub logarithm: f64,
    pub factor: f64,
}

/// Sums over what slides.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Sliding {
    /// Pressures, times 1 and x.
    pub pressure: [f64; 2],
    pub force: [f64; 2],
}

/// What a stripe has of sticking and sliding.
pub(super) struct Share {
    /// Spacings that stick.
    pub sticking: f64,
    /// How much more pressure slides than that of the bristles that do.
    pub sliding: f64,
}

/// An end of a stretch or a stripe.
#[derive(Debug, Clone, Copy)]
struct End {
    x: f64,
    /// Integral of the pressure from the middle, over the spacing, times 1 and x.
    pressure: [f64; 2],
}

/// A way that leads away from a node, in spacings, over which the force of a bristle that sticks grows, while its limit is
/// `limit + rise t + bend t²`.
struct Way {
    from: f64,
    /// 1 to the front, -1 to the rear.
    side: f64,
    spacings: f64,
    force: [f64; 2],
    growth: [f64; 2],
    limit: f64,
    rise: f64,
    bend: f64,
}

impl Way {
    fn force(&self, t: f64) -> [f64; 2] {
        [self.force[0] + t * self.growth[0], self.force[1] + t * self.growth[1]]
    }

    /// Where the force meets the limit, or the end of the way.
    fn meets(&self) -> f64 {
        let w = self.spacings;
        let below = (self.limit - norm(self.force)).max(0.0);
        let above = norm(self.force(w)) - (self.limit + (self.rise + self.bend * w) * w);
        // a bristle that would still stick slides because it broke away elsewhere
        if above <= 0.0 {
            return w;
        }
        let t = w * below / (below + above);
        // one step of Newton's method for the curved limit
        let slope = (below + above) / w - self.bend * (2.0 * t - w);
        if slope > 0.0 { (t + self.bend * t * (t - w) / slope).clamp(0.0, w) } else { t }
    }
}

/// What is where a way ends to stick.
struct Front {
    /// Spacings from the way's beginning.
    at: f64,
    end: End,
    pressure: f64,
    /// Forces on both sides.
    held: [f64; 2],
    slid: [f64; 2],
}

impl Stripe<'_> {
    /// Adds what the sums over bristles lack.
    pub fn add_all(&self, pattern: &Pattern, summed: Sliding, sums: &mut Sums) -> Share {
        let Patch { p, bristles, feed, .. } = *self.patch;
        let bounds = self.bounds();
        let mut slides = summed;
        let mut sticking = 0.0;
        let mut held = [0.0; 2];
        let mut hold = |[rear, front]: [End; 2], share: f64| {
            for c in 0..2 {
                held[c] += share * (front.pressure[c] - rear.pressure[c]);
            }
            sticking += share * (front.x - rear.x) / p.bristle_length;
        };
        let from = self.row + bristles.window[0];
        pattern.each_stretch(|first, last| {
            let (first, last) = (from + first, from + last);
            let rear = self.end(first, -1.0, first == last, &bounds[0], &mut slides, sums);
            let front = self.end(last, 1.0, first == last, &bounds[1], &mut slides, sums);
            hold([rear, front], 1.0);
            // the product of place and force is curved where both are linear
            let grown = bristles.force_y[last] - bristles.force_y[first];
            sums.moment[1] -= p.bristle_length / 6.0 * grown;
        });
        if let (Some([first, last]), true) = (pattern.ends(), feed != 0.0) {
            let outer = if self.is_forward() { last } else { first };
            if !pattern.sticks(outer) {
                // as the direction of the rolling resistance (4.22)
                let share = feed.abs().min(1.0);
                if let Some(front) = self.entry(from + outer, share, &bounds, &mut slides, sums) {
                    hold(if self.is_forward() { [front, bounds[1]] } else { [bounds[0], front] }, share);
                }
            }
        }
        let lacking = self.add_pressure(&bounds, held, &slides, sums);
        let sliding = match summed.pressure[0] {
            summed if summed > 0.0 => (slides.pressure[0] + lacking) / summed,
            _ => 1.0,
        };
        Share { sticking, sliding }
    }

    /// The ends of what is pressed on the road.
    fn bounds(&self) -> [End; 2] {
        let half = 0.5 * self.length;
        let Pressure { level, tilt, .. } = *self.patch.pressure;
        [-half, half].map(|x| match level + tilt * x {
            pressed if pressed >= 0.0 => self.integrals(x, 1.0),
            _ => self.integrals(-level / tilt, self.power(-level / tilt)),
        })
    }

    /// (2 |x| / length)^exponent.
    fn power(&self, x: f64) -> f64 {
        libm::exp2(self.patch.exponent * (libm::log2(2.0 * x.abs()) - self.logarithm))
    }

    /// Integrals of the pressure from the middle to x, where [`power`](Self::power) has the value `power`.
    fn integrals(&self, x: f64, power: f64) -> End {
        let Patch { p, pressure: &Pressure { level, tilt, .. }, exponent: g, .. } = *self.patch;
        let scale = self.factor / p.bristle_length;
        let first = x * (1.0 - power / (g + 1.0));
        let second = x * x * (0.5 - power / (g + 2.0));
        let third = x * x * x * (1.0 / 3.0 - power / (g + 3.0));
        let pressure = [scale * (level * first + tilt * second), scale * (level * second + tilt * third)];
        End { x, pressure }
    }

    /// The end of a stretch at the bristle `held`, its outermost on this side.
    fn end(
        &self,
        held: usize,
        side: f64,
        alone: bool,
        bound: &End,
        slides: &mut Sliding,
        sums: &mut Sums,
    ) -> End {
        let Patch { p, feed, .. } = *self.patch;
        let (next, inner) = (self.neighbour(held, side), self.neighbour(held, -side));
        let (from, force) = (self.place(held), self.force(held));
        let growth = match inner {
            Some(inner) if !alone => {
                let behind = self.force(inner);
                [force[0] - behind[0], force[1] - behind[1]]
            }
            _ => self.growth_of_one(held).map(|g| if self.is_entry(side) { -g } else { g }),
        };
        let spacings = if next.is_some() { 1.0 } else { side * (bound.x - from) / p.bristle_length };
        if spacings <= 0.0 {
            return *bound;
        }
        let mut way = Way { from, side, spacings, force, growth, limit: 0.0, rise: 0.0, bend: 0.0 };
        if next.is_none() && feed != 0.0 && self.is_entry(side) {
            // no bristle is loaded more outside of the contact than in it
            let (most, there) = (norm(force), norm(way.force(spacings)));
            let outer = way.force(spacings).map(|f| if there > most { f * (most / there) } else { f });
            self.add_node(bound.x, outer.map(|f| 0.5 * spacings * f), sums);
            self.add_product(side, spacings, outer[1] - force[1], sums);
            return *bound;
        }
        // the limit as a parabola through three nodes
        let limit = |k: Option<usize>| k.map_or(0.0, |k| self.limits(self.pressure(k)).sticking);
        let behind = if inner.is_some() { 1.0 } else { 0.5 * self.length / p.bristle_length + side * from / p.bristle_length };
        way.limit = limit(Some(held));
        let (ahead, back) = ((limit(next) - way.limit) / spacings, (limit(inner) - way.limit) / behind);
        way.bend = (ahead + back) / (spacings + behind);
        way.rise = ahead - way.bend * spacings;
        let front = self.front(&way, way.meets());

        let (at, left) = (front.at, spacings - front.at);
        self.add_node(from, force.map(|f| 0.5 * (at - spacings) * f), sums);
        if let Some(next) = next {
            self.add_node(self.place(next), self.force(next).map(|f| -0.5 * at * f), sums);
            self.slide(next, -0.5 * at, slides);
        }
        self.add_front(&front, 0.5 * at, 0.5 * left, slides, sums);
        self.add_product(side, at, front.held[1] - force[1], sums);
        front.end
    }

    /// The end of the stretch in which bristles stick that have just come in, before the first bristle, which slides. Near
    /// the end bristles stick, if the limit rises faster than the load.
    fn entry(
        &self,
        first: usize,
        share: f64,
        bounds: &[End; 2],
        slides: &mut Sliding,
        sums: &mut Sums,
    ) -> Option<End> {
        let Patch { p, feed, .. } = *self.patch;
        let (side, [exit, entry]) =
            if self.is_forward() { (-1.0, *bounds) } else { (1.0, [bounds[1], bounds[0]]) };
        let spacings = side * (self.place(first) - entry.x) / p.bristle_length;
        let velocity = self.path.velocity(self.place(first));
        let growth = velocity.map(|v| -p.bristle_stiffness * p.bristle_length / feed.abs() * v);
        let limit = self.limits(self.pressure(first)).sticking;
        let (farther, there) = match self.neighbour(first, side) {
            Some(second) => (spacings + 1.0, self.limits(self.pressure(second)).sticking),
            None => (side * (exit.x - entry.x) / p.bristle_length, 0.0),
        };
        let chord = limit / spacings;
        let bend = (there / farther - chord) / (farther - spacings);
        let rise = chord - bend * spacings;
        let load = norm(growth);
        let at = (rise - load) / -bend;
        let is_between = spacings > 0.0 && bend < 0.0 && load < rise && at < spacings;
        if !is_between {
            return None;
        }
        let way = Way { from: entry.x, side, spacings, force: [0.0; 2], growth, limit: 0.0, rise, bend };
        let front = self.front(&way, at);
        let at = share * front.at;
        self.add_node(self.place(first), self.force(first).map(|f| -0.5 * at * f), sums);
        self.slide(first, -0.5 * at, slides);
        self.add_front(&front, 0.5 * at, 0.5 * share * (spacings - front.at), slides, sums);
        self.add_product(side, share * front.at, front.held[1], sums);
        Some(front.end)
    }

    /// What is at the front that lies at about `at`.
    fn front(&self, way: &Way, at: f64) -> Front {
        let Patch { p, pressure, exponent, .. } = *self.patch;
        let place = |at: f64| way.from + way.side * at * p.bristle_length;
        let near = place(at);
        let mut power = self.power(near).min(1.0);
        let pressed = |x: f64, power: f64| pressure.at(x, self.factor * (1.0 - power));
        // one more step towards where it is, with the pressure itself
        let gap = self.limits(pressed(near, power)).sticking - norm(way.force(at));
        let w = way.spacings;
        let slope = way.rise + 2.0 * way.bend * at - (norm(way.force(w)) - norm(way.force)) / w;
        let mut at = at;
        if slope < 0.0 && at < w {
            at = (at - gap / slope).clamp(0.0, w);
            let moved = (place(at) - near) / near;
            power = (power * (1.0 + exponent * moved * (1.0 + 0.5 * (exponent - 1.0) * moved))).clamp(0.0, 1.0);
        }
        let x = place(at);
        let pressure = pressed(x, power).max(0.0);
        let limits = self.limits(pressure);
        let force = way.force(at);
        let load = norm(force).max(f64::MIN_POSITIVE);
        let sliding = self.patch.friction.at_speed(self.path.velocity(x)) * limits.sliding;
        Front {
            at,
            end: self.integrals(x, power),
            pressure,
            held: force.map(|f| f * (limits.sticking / load).min(1.0)),
            slid: force.map(|f| f * (sliding / load)),
        }
    }

    /// A front counts on its sticking and on its sliding side.
    fn add_front(&self, front: &Front, held: f64, slid: f64, slides: &mut Sliding, sums: &mut Sums) {
        let sliding = front.slid.map(|f| slid * f);
        for c in 0..2 {
            slides.force[c] += sliding[c];
        }
        slides.pressure[0] += slid * front.pressure;
        slides.pressure[1] += slid * front.pressure * front.end.x;
        self.add_node(front.end.x, std::array::from_fn(|c| held * front.held[c] + sliding[c]), sums);
    }

    /// A bristle that slides counts more.
    fn slide(&self, k: usize, share: f64, slides: &mut Sliding) {
        let (force, pressure) = (self.force(k), share * self.pressure(k));
        for c in 0..2 {
            slides.force[c] += share * force[c];
        }
        slides.pressure[0] += pressure;
        slides.pressure[1] += pressure * self.place(k);
    }

    /// What the trapezoidal rule lacks of the pressure that slides, it lacks of the friction. Returns that pressure.
    fn add_pressure(&self, bounds: &[End; 2], held: [f64; 2], slides: &Sliding, sums: &mut Sums) -> f64 {
        let Patch { p, deformation, .. } = *self.patch;
        let Sliding { pressure, force } = *slides;
        if pressure[0] <= 0.0 {
            return 0.0;
        }
        let closed = closed(p, self.length);
        let [lacking, lever] =
            [0, 1].map(|c| closed * (bounds[1].pressure[c] - bounds[0].pressure[c] - held[c] - pressure[c]));
        let friction = force.map(|f| f / pressure[0]);
        let middle = if lacking == 0.0 { 0.0 } else { (lever / lacking).clamp(bounds[0].x, bounds[1].x) };
        let force = friction.map(|f| f * lacking);
        sums.force[0] += force[0];
        sums.force[1] += force[1];
        sums.moment[1] += friction[1] * (lever + deformation.shift_x * lacking)
            - deformation.place(middle, self.y)[1] * force[0];
        sums.work += self.path.power(middle, force);
        lacking
    }

    fn add_node(&self, x: f64, force: [f64; 2], sums: &mut Sums) {
        let [place_x, place_y] = self.patch.deformation.place(x, self.y);
        sums.force[0] += force[0];
        sums.force[1] += force[1];
        sums.moment[1] += place_x * force[1] - place_y * force[0];
        sums.work += self.path.power(x, force);
    }

    /// What the product of place and force has less over a way than the trapezoidal rule says, both being linear.
    fn add_product(&self, side: f64, spacings: f64, growth: f64, sums: &mut Sums) {
        sums.moment[1] -= side * spacings * spacings * self.patch.p.bristle_length / 6.0 * growth;
    }

    /// By how much the force of a bristle grows in a spacing towards the exit, if it alone sticks.
    fn growth_of_one(&self, held: usize) -> [f64; 2] {
        let Patch { p, feed, .. } = *self.patch;
        if feed == 0.0 {
            return [0.0; 2];
        }
        let side = if self.is_forward() { 1.0 } else { -1.0 };
        let force = self.force(held);
        match self.neighbour(held, side) {
            Some(before) => {
                let before = self.force(before);
                [force[0] - before[0], force[1] - before[1]]
            }
            // it was not loaded where it came in
            None => {
                let spacings = (0.5 * self.length - side * self.place(held)) / p.bristle_length;
                force.map(|f| f / spacings.max(f64::MIN_POSITIVE))
            }
        }
    }

    /// Bristles go to the rear.
    fn is_forward(&self) -> bool {
        self.patch.feed < 0.0
    }

    /// Bristles come in on this side.
    fn is_entry(&self, side: f64) -> bool {
        side > 0.0 && self.is_forward() || side < 0.0 && !self.is_forward()
    }

    /// The next bristle in contact on a side.
    fn neighbour(&self, k: usize, side: f64) -> Option<usize> {
        let bristles = self.patch.bristles;
        let next = if side > 0.0 { k + 1 } else { k.checked_sub(1)? };
        let in_row = next >= self.row && next < self.row + bristles.per_stripe;
        (in_row && bristles.share[next] > 0.0).then_some(next)
    }

    fn place(&self, k: usize) -> f64 {
        self.patch.bristles.place(self.patch.p, k - self.row)
    }

    fn force(&self, k: usize) -> [f64; 2] {
        [self.patch.bristles.force_x[k], self.patch.bristles.force_y[k]]
    }

    fn pressure(&self, k: usize) -> f64 {
        self.patch.bristles.pressure[k].max(0.0)
    }

    fn limits(&self, pressure: f64) -> Limits<f64> {
        self.patch.friction.limits(pressure)
    }
}
