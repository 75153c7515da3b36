//! Stretches of a stripe whose bristles stick: where they end, and what sums over bristles lack for that.

use super::bristle::norm;
use super::bristles::{Bristles, MAX_PER_STRIPE};
use super::passage::Friction;
use super::patch::{Path, Pressure};
use super::{Deformation, Limits, Parameters};

/// From this speed \[m/s\] on a wheel rolls: bristles come by within the time in which slips change.
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

/// What sums over the bristles of a stripe lack of integrals over it.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Lacking {
    pub force: [f64; 2],
    /// About z.
    pub moment: f64,
    pub work: f64,
    /// Squared deflections \[m²\].
    pub stored: f64,
    /// Spacings that stick.
    pub sticking: f64,
    /// How much more pressure slides than that of the bristles that do.
    pub sliding: f64,
    /// What pulls of the pressure, over the spacing.
    pub pulls: f64,
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
    /// What the sums over bristles lack.
    pub fn lacking(&self, pattern: &Pattern, summed: Sliding) -> Lacking {
        let Patch { p, bristles, feed, .. } = *self.patch;
        let bounds = self.bounds();
        let mut sums = Lacking::default();
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
            let rear = self.end(first, -1.0, first == last, &bounds[0], &mut slides, &mut sums);
            let front = self.end(last, 1.0, first == last, &bounds[1], &mut slides, &mut sums);
            hold([rear, front], 1.0);
            let grown = difference(self.force(last), self.force(first));
            self.add_products(1.0, (last - first) as f64, grown, 1.0, 1.0, &mut sums);
        });
        if let (Some([first, last]), true) = (pattern.ends(), feed != 0.0) {
            let outer = if self.is_forward() { last } else { first };
            if !pattern.sticks(outer) {
                let share = self.rolls();
                if let Some(front) = self.entry(from + outer, share, &bounds, &mut slides, &mut sums) {
                    hold(if self.is_forward() { [front, bounds[1]] } else { [bounds[0], front] }, share);
                }
            }
        }
        let lacking = self.add_pressure(&bounds, held, &slides, &mut sums);
        let [rear, front] = bounds.map(|b| b.pressure[0]);
        let [all_rear, all_front] = [-0.5, 0.5].map(|end| self.integrals(end * self.length, 1.0).pressure[0]);
        sums.sticking = sticking.clamp(0.0, self.length / p.bristle_length);
        sums.sliding = match summed.pressure[0] {
            summed if summed > 0.0 => (slides.pressure[0] + lacking) / summed,
            _ => 1.0,
        };
        sums.pulls = (front - rear) - (all_front - all_rear);
        sums
    }

    /// The ends of what is pressed on the road.
    fn bounds(&self) -> [End; 2] {
        let half = 0.5 * self.length;
        let Pressure { level, tilt, .. } = *self.patch.pressure;
        [-half, half].map(|x| match level + tilt * x {
            pressed if pressed >= 0.0 => self.integrals(x, 1.0),
            _ => {
                let x = (-level / tilt).clamp(-half, half);
                self.integrals(x, self.power(x).min(1.0))
            }
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
        sums: &mut Lacking,
    ) -> End {
        let Patch { p, .. } = *self.patch;
        let (next, inner) = (self.neighbour(held, side), self.neighbour(held, -side));
        let (from, force) = (self.place(held), self.force(held));
        let growth = match inner {
            Some(inner) if !alone => difference(force, self.force(inner)),
            _ => self.growth_of_one(held).map(|g| if self.is_entry(side) { -g } else { g }),
        };
        let spacings = if next.is_some() { 1.0 } else { side * (bound.x - from) / p.bristle_length };
        if spacings <= 0.0 {
            return *bound;
        }
        let mut way = Way { from, side, spacings, force, growth, limit: 0.0, rise: 0.0, bend: 0.0 };
        let share = if next.is_some() {
            1.0
        } else if self.is_entry(side) {
            0.0
        } else {
            self.rolls()
        };
        let mut end = *bound;
        if share < 1.0 {
            // in no sum is more friction than the law allows
            let outer = way.force(spacings);
            let most = (self.limits(self.pressure(held)).sticking - norm(force)).max(0.0);
            let part = (most / norm(outer).max(f64::MIN_POSITIVE)).min(1.0);
            let outer = outer.map(|f| part * f);
            self.add_node(bound.x, 0.5 * (1.0 - share) * spacings, outer, sums);
            self.add_products(side, 1.0, difference(outer, force), spacings, 1.0 - share, sums);
        }
        if share > 0.0 {
            // the limit as a parabola through three nodes
            let limit = |k: Option<usize>| k.map_or(0.0, |k| self.limits(self.pressure(k)).sticking);
            let behind = match inner {
                Some(_) => 1.0,
                None => (0.5 * self.length + side * from) / p.bristle_length,
            };
            way.limit = limit(Some(held));
            let (ahead, back) = ((limit(next) - way.limit) / spacings, (limit(inner) - way.limit) / behind);
            way.bend = (ahead + back) / (spacings + behind);
            way.rise = ahead - way.bend * spacings;
            let front = self.front(&way, way.meets());

            let (at, left) = (front.at, spacings - front.at);
            self.add_node(from, 0.5 * share * (at - spacings), force, sums);
            if let Some(next) = next {
                self.add_node(self.place(next), -0.5 * at, self.force(next), sums);
                self.slide(next, -0.5 * at, slides);
            }
            self.add_front(&front, 0.5 * share * at, 0.5 * share * left, slides, sums);
            self.add_products(side, 1.0, difference(front.held, force), at, share, sums);
            let mix = |front: f64, bound: f64| bound + share * (front - bound);
            end.x = mix(front.end.x, bound.x);
            end.pressure = std::array::from_fn(|c| mix(front.end.pressure[c], bound.pressure[c]));
        }
        end
    }

    /// The end of the stretch in which bristles stick that have just come in, before the first bristle, which slides. Near
    /// the end bristles stick, if the limit rises faster than the load.
    fn entry(
        &self,
        first: usize,
        share: f64,
        bounds: &[End; 2],
        slides: &mut Sliding,
        sums: &mut Lacking,
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
        self.add_node(self.place(first), -0.5 * at, self.force(first), sums);
        self.slide(first, -0.5 * at, slides);
        self.add_front(&front, 0.5 * at, 0.5 * share * (spacings - front.at), slides, sums);
        self.add_products(side, 1.0, front.held, front.at, share, sums);
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
            let (moved, by) = (place(at), place(at) / near - 1.0);
            power = if by.abs() < 0.1 {
                power * (1.0 + exponent * by * (1.0 + 0.5 * (exponent - 1.0) * by))
            } else {
                self.power(moved)
            };
            power = power.clamp(0.0, 1.0);
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
    fn add_front(&self, front: &Front, held: f64, slid: f64, slides: &mut Sliding, sums: &mut Lacking) {
        for c in 0..2 {
            slides.force[c] += slid * front.slid[c];
        }
        slides.pressure[0] += slid * front.pressure;
        slides.pressure[1] += slid * front.pressure * front.end.x;
        self.add_node(front.end.x, held, front.held, sums);
        self.add_node(front.end.x, slid, front.slid, sums);
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
    fn add_pressure(&self, bounds: &[End; 2], held: [f64; 2], slides: &Sliding, sums: &mut Lacking) -> f64 {
        let deformation = self.patch.deformation;
        let Sliding { pressure, force } = *slides;
        if pressure[0] <= 0.0 {
            return 0.0;
        }
        let [lacking, lever] =
            [0, 1].map(|c| bounds[1].pressure[c] - bounds[0].pressure[c] - held[c] - pressure[c]);
        let friction = force.map(|f| f / pressure[0]);
        let middle = if lacking == 0.0 { 0.0 } else { (lever / lacking).clamp(bounds[0].x, bounds[1].x) };
        let force = friction.map(|f| f * lacking);
        sums.force[0] += force[0];
        sums.force[1] += force[1];
        sums.moment += friction[1] * (lever + deformation.shift_x * lacking)
            - deformation.place(middle, self.y)[1] * force[0];
        sums.work += self.path.power(middle, force);
        lacking
    }

    fn add_node(&self, x: f64, share: f64, force: [f64; 2], sums: &mut Lacking) {
        let stiffness = self.patch.p.bristle_stiffness;
        let [place_x, place_y] = self.patch.deformation.place(x, self.y);
        sums.stored += share * (force[0] * force[0] + force[1] * force[1]) / (stiffness * stiffness);
        let [force_x, force_y] = force.map(|f| share * f);
        sums.force[0] += force_x;
        sums.force[1] += force_y;
        sums.moment += place_x * force_y - place_y * force_x;
        sums.work += self.path.power(x, [force_x, force_y]);
    }

    /// What products of place, velocity and force, each of which is linear, have less than the trapezoidal rule says: over
    /// a way of so many equal intervals, each `spacings` long, on which the force grows by so much.
    fn add_products(
        &self,
        side: f64,
        intervals: f64,
        [growth_x, growth_y]: [f64; 2],
        spacings: f64,
        share: f64,
        sums: &mut Lacking,
    ) {
        let Patch { p, .. } = *self.patch;
        let Path { velocity_x, velocity_y, led } = self.path;
        let lever = share * side * spacings * spacings * p.bristle_length / 6.0;
        sums.moment -= lever * growth_y;
        sums.work += lever * (growth_x * velocity_x[1] + growth_y * (velocity_y[1] - led[1]));
        let squares =
            (growth_x * growth_x + growth_y * growth_y) / (p.bristle_stiffness * p.bristle_stiffness);
        if intervals > 0.0 {
            sums.stored -= share * spacings / 6.0 * squares / intervals;
        }
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
            Some(before) => difference(force, self.force(before)),
            // it was not loaded where it came in
            None => {
                let spacings = (0.5 * self.length - side * self.place(held)) / p.bristle_length;
                force.map(|f| f / spacings.max(f64::MIN_POSITIVE))
            }
        }
    }

    /// How far what is ahead of a bristle tells what it will do. Where the wheel stands it does not.
    fn rolls(&self) -> f64 {
        (self.patch.feed.abs() / ROLLS).min(1.0)
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

fn difference(a: [f64; 2], b: [f64; 2]) -> [f64; 2] {
    [a[0] - b[0], a[1] - b[1]]
}
