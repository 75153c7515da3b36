//! The patch of a tire that rolls steadily: bristles of no length, (4.24) and (4.34).
//!
//! Bristles pass through the patch like beads on a string: what one does in time is what all do along a
//! stripe. So sums over the bristles of a stripe become integrals over x divided by the bristle length,
//! and a stripe is followed from where bristles enter to where they leave. A bristle enters sliding, as
//! its pressure begins at zero, comes to rest, breaks away, and may come to rest again.
//!
//! * The pressure's integrals have closed forms.
//! * While the bottom rests, the force is a polynomial in x: three Gauss points are exact.
//! * Sliding is stiff: deflection and friction balance within microseconds, in which a bristle that breaks
//!   away snaps back, and then the force turns. It is marched by an implicit Runge-Kutta method.
//! * The places where a bristle comes to rest and breaks away are located, so that the loads and their
//!   derivatives contain how they move.

use super::bristle::norm;
use super::friction::{Friction, at_speed};
use super::patch::{Moments, Pressure, Shape};
use super::{Contact, Deformation, Limits, Loads, Parameters, Prepared, Tops, moment_y};
use crate::mechanics::Wrench;
use crate::solver::Real;
use nalgebra::Vector3;

/// A time \[s\] in which every bristle of a wheel that does not spin has started to slide.
const LONG: f64 = 1e3;
/// Steps of the search for a place in an interval: secants take about six, halvings would take 17.
const MAX_SECANTS: usize = 40;
/// Gauss's rule with three points on \[0, 1\]: places and weights.
const GAUSS: [(f64, f64); 3] =
    [(0.112_701_665_379_258_3, 5.0 / 18.0), (0.5, 8.0 / 18.0), (0.887_298_334_620_741_7, 5.0 / 18.0)];
/// The singly diagonally implicit Runge-Kutta method of third order that damps what is stiff at once (Alexander,
/// SIAM J. Numer. Anal. 14, 1977): the diagonal, a root of x³ - 3 x² + 3/2 x - 1/6.
const DIAGONAL: f64 = 0.435_866_521_508_459;
/// Weights of the stages before for the second stage and for the third, which is the end.
const SECOND: f64 = (1.0 - DIAGONAL) / 2.0;
const THIRD: [f64; 2] = [
    (-6.0 * DIAGONAL * DIAGONAL + 16.0 * DIAGONAL - 1.0) / 4.0,
    (6.0 * DIAGONAL * DIAGONAL - 20.0 * DIAGONAL + 5.0) / 4.0,
];
/// Where the stages are in an interval.
const STAGES: [f64; 3] = [DIAGONAL, DIAGONAL + SECOND, 1.0];

/// What the patch does to the belt.
#[derive(Clone, Copy)]
pub(super) struct Patch<T: Real> {
    /// In K about the contact point.
    pub on_belt: Wrench<T>,
    /// Power lost in the contact.
    pub power_loss: T,
}

/// Told of every node: number of the stripe, place x, deflection, sticking.
pub(super) type Visit<'a> = dyn FnMut(usize, f64, [f64; 2], bool) + 'a;

/// The patch of a belt with this contact and spin rate, under the loads that deform it; how stripes are `cut` counts where bristles slide.
pub(super) fn continuum<T: Real>(
    tire: &Prepared,
    contact: &Contact<T>,
    spin_rate: T,
    friction: T,
    loads: &Loads<T>,
    cut: &Cut,
    visit: &mut Visit<'_>,
) -> Patch<T> {
    let p = tire.parameters();
    let zero = T::zero();
    let moment_y = moment_y(p, contact, spin_rate, loads.force_x);
    let deformation = Deformation::new(p, loads);
    let steady = Loads { force_x: zero, force_y: zero, moment_z: zero };
    let tops = Tops::new(p, contact, spin_rate, loads, &steady);
    let shape = Shape::new(p, contact.penetration);

    let stripes = tire.stripe_places().iter().zip(tire.stripe_radii()).enumerate();
    let stripes = stripes.filter_map(|(i, (&y, &radius))| {
        let length = contact.stripe_length(p, y, radius);
        (length.value() > 0.0).then(|| (i, y, length, shape.stripe(y, length)))
    });
    let mut sums = Moments { s0: zero, s1: zero, s2: zero };
    let mut longest: f64 = 0.0;
    for (_, _, length, factor) in stripes.clone() {
        let [i0, i2] = shape.integrals(length);
        sums.s0 += i0 * factor / p.bristle_length;
        sums.s2 += i2 * factor / p.bristle_length;
        longest = longest.max(length.value());
    }
    let tilting = moment_y + deformation.shift_x * contact.normal_force;
    let pressure = Pressure::new(p, &sums, contact.normal_force, tilting, longest);

    let law = Friction::new(p);
    let Cut { places, logarithms } = cut;
    let shapes: Vec<T> = logarithms.iter().map(|logarithm| shape.at_logarithm(*logarithm)).collect();
    // the belt does not turn about the vertical: all stripes have one velocity, linear in x
    let [at_zero, at_one] = [zero, T::one()].map(|x| tops.velocity(x, zero));
    let velocity = [at_zero[0], at_zero[1], at_one[1] - at_zero[1]];
    let mut force = Vector3::new(zero, zero, contact.normal_force);
    let mut moment = Vector3::new(zero, moment_y, zero);
    let mut power_loss = zero;
    for (i, y, length, factor) in stripes {
        let stripe = Stripe {
            p,
            velocity,
            shape: &shape,
            pressure: &pressure,
            law: &law,
            friction,
            length,
            factor: factor * p.cell_area(),
            direction: if spin_rate.value() < 0.0 { -1.0 } else { 1.0 },
            feed: spin_rate.abs() * p.rolling_radius,
        };
        let Sums { force: [force_x, force_y], x_force, xx_force_x } = stripe.sums(places, &shapes, i, visit);
        force.x += force_x;
        force.y += force_y;
        let middle = deformation.shift_y + y;
        moment.z += x_force[1] + deformation.shift_x * force_y
            - (middle * force_x + deformation.twist * x_force[0] - deformation.bend * xx_force_x);
        let [i0, i2] = shape.integrals(length);
        let normal = pressure.level * middle * i0
            + (pressure.tilt * deformation.twist - pressure.level * deformation.bend) * i2;
        moment.x += normal * stripe.factor / p.bristle_length;
        // the power of a force is linear in its place x, which only a lateral force feels
        let power = |x: T, force: [T; 2]| tops.power(x, T::from(y), force);
        let lateral = [zero, x_force[1]];
        power_loss += power(zero, [force_x, force_y]) + power(T::one(), lateral) - power(zero, lateral);
    }
    power_loss += tops.camber_power(moment.z);
    Patch { on_belt: Wrench { force, moment }, power_loss }
}

/// How stripes are cut.
pub(super) struct Cut {
    /// Places of the entry and of the stages in each interval over the length of a stripe, from the entry at 1/2.
    places: Vec<f64>,
    /// Logarithms of twice their distances from the middle, to base 2.
    logarithms: Vec<f64>,
}

impl Cut {
    /// Into so many intervals. They are dense at the entry, where a bristle's damper builds up its force over 0.01 mm,
    /// and at the exit, where the pressure falls steeply.
    pub fn new(intervals: usize) -> Self {
        let node = |k: usize| {
            let t = k as f64 / intervals as f64;
            0.5 - t * t * t * (10.0 - t * (15.0 - 6.0 * t))
        };
        let stages = |k| STAGES.map(|stage| node(k) + stage * (node(k + 1) - node(k)));
        let places: Vec<f64> = std::iter::once(node(0)).chain((0..intervals).flat_map(stages)).collect();
        let logarithms = places.iter().map(|place| Real::log2((2.0 * place).abs())).collect();
        Self { places, logarithms }
    }

    pub fn intervals(&self) -> usize {
        self.places.len() / 3
    }
}

/// A bristle at a place.
#[derive(Clone, Copy)]
struct Node<T> {
    x: T,
    deflection: [T; 2],
    force: [T; 2],
}

/// Sums of the force over the bristles of a stripe, and of its moments.
struct Sums<T> {
    force: [T; 2],
    x_force: [T; 2],
    xx_force_x: T,
}

impl<T: Real> Sums<T> {
    fn add(&mut self, x: T, force: [T; 2], weight: T) {
        let [force_x, force_y] = force.map(|f| f * weight);
        let x_force_x = x * force_x;
        self.force[0] += force_x;
        self.force[1] += force_y;
        self.x_force[0] += x_force_x;
        self.x_force[1] += x * force_y;
        self.xx_force_x += x * x_force_x;
    }
}

struct Stripe<'a, T: Real> {
    p: &'a Parameters,
    /// Velocity of the bristles' tops over the road: x, and y at x = 0 and per x.
    velocity: [T; 3],
    shape: &'a Shape<T>,
    pressure: &'a Pressure<T>,
    /// Friction, and the road's factor on it.
    law: &'a Friction,
    friction: T,
    length: T,
    /// Of the stripe's pressure, times a bristle's area.
    factor: T,
    /// 1 if bristles enter in front, -1 if behind.
    direction: f64,
    /// Velocity of the bristles through the patch.
    feed: T,
}

impl<T: Real> Stripe<'_, T> {
    /// Follows the bristles from the entry to the exit.
    fn sums(&self, places: &[f64], shapes: &[T], number: usize, visit: &mut Visit<'_>) -> Sums<T> {
        let zero = T::zero();
        let mut sums = Sums { force: [zero; 2], x_force: [zero; 2], xx_force_x: zero };
        let place = |k: usize| self.length * (self.direction * places[k]);
        let mut sliding = Node { x: place(0), deflection: [zero; 2], force: [zero; 2] };
        // where it came to rest
        let mut resting: Option<Node<T>> = None;
        visit(number, sliding.x.value(), [0.0; 2], false);
        let exit = places.len() - 1;
        for end in (3..=exit).step_by(3) {
            let x = place(end);
            // the last place carries nothing
            let limits = if end == exit { self.limits(x, zero) } else { self.limits(x, shapes[end]) };
            let mut before = place(end - 3);
            if resting.is_none() {
                let stage = |k: usize| self.limits(place(k), shapes[k]);
                let limits = [stage(end - 2), stage(end - 1), limits];
                (sliding, resting) = self.slide(sliding, x, limits, &mut sums);
                before = resting.map_or(x, |at| at.x);
            }
            if let Some(from) = resting
                && norm(self.held(&from, x).force) > limits.sticking
            {
                let way = x - before;
                let margin = |part: f64| {
                    let x = before + way * part;
                    self.limits_at(x).sticking - norm(self.held(&from, x).force)
                };
                let until = self.held(&from, before + way * crossing(margin));
                self.rest(&from, until.x, &mut sums);
                let stage = |k: usize| self.limits_at(until.x + (x - until.x) * STAGES[k]);
                (sliding, resting) =
                    self.slide(self.released(until), x, [stage(0), stage(1), limits], &mut sums);
            }
            let deflection = resting.map_or(sliding.deflection, |from| self.held(&from, x).deflection);
            visit(number, x.value(), deflection.map(Real::value), resting.is_some());
        }
        if let Some(from) = resting {
            self.rest(&from, place(exit), &mut sums);
        }
        sums
    }

    fn limits(&self, x: T, shape: T) -> Limits<T> {
        let load = self.pressure.at(x, shape) * self.factor;
        self.law.limits(load / self.p.cell_area(), load * self.friction)
    }

    fn limits_at(&self, x: T) -> Limits<T> {
        self.limits(x, self.shape.along(x, self.length))
    }

    fn velocity(&self, x: T) -> [T; 2] {
        let [along, across, slope] = self.velocity;
        [along, across + slope * x]
    }

    /// Time from one place to another.
    fn time(&self, from: T, to: T) -> T {
        let way = (to - from).abs();
        if self.feed.value() * LONG > way.value() { way / self.feed } else { T::from(LONG) }
    }

    /// The bristle at x whose bottom rests since it was at `from`.
    fn held(&self, from: &Node<T>, x: T) -> Node<T> {
        let time = self.time(from.x, x);
        // the velocity is linear in x: its mean over the way is exact
        let mean = self.velocity((from.x + x) * 0.5);
        let velocity = self.velocity(x);
        let deflection = std::array::from_fn(|c| from.deflection[c] - time * mean[c]);
        let force = std::array::from_fn(|c| {
            deflection[c] * self.p.bristle_stiffness - velocity[c] * self.p.bristle_damping
        });
        Node { x, deflection, force }
    }

    /// Adds up the forces while the bottom rests.
    fn rest(&self, from: &Node<T>, until: T, sums: &mut Sums<T>) {
        let way = until - from.x;
        for (place, weight) in GAUSS {
            let Node { x, force, .. } = self.held(from, from.x + way * place);
            sums.add(x, force, way.abs() * (weight / self.p.bristle_length));
        }
    }

    /// Friction \[N\] of a bristle that slides at x, with these limits.
    fn friction(&self, x: T, limits: &Limits<T>) -> T {
        at_speed(self.p, limits.sliding, self.velocity(x))
    }

    /// The bristle that broke away and snapped back until its spring balances the friction.
    ///
    /// While it slides its trial force c u - d v, of size r and direction e, turns with the rate -c v⊥/r,
    /// where v⊥ is the part of the velocity across e. Snapping back takes the time constant d/c, in which r
    /// falls from what held to friction + d |v|: for so long it turns less, by d v⊥/r times the logarithm of
    /// the ratio of the two. At 40 m/s that is 5e-4 of the tire's force.
    fn released(&self, held: Node<T>) -> Node<T> {
        let friction = self.friction(held.x, &self.limits_at(held.x));
        let size = norm(held.force);
        if friction.value() <= 0.0 || size.value() <= 0.0 {
            return Node { deflection: [T::zero(); 2], force: [T::zero(); 2], ..held };
        }
        let velocity = self.velocity(held.x);
        let along = held.force.map(|f| f / size);
        let speed = along[0] * velocity[0] + along[1] * velocity[1];
        let across: [T; 2] = std::array::from_fn(|c| velocity[c] - along[c] * speed);
        let after = friction - speed * self.p.bristle_damping;
        // a top that outruns the friction drags the bristle on: it does not snap back
        let turn = if after.value() > 0.0 {
            (size / after).ln() * self.p.bristle_damping / after
        } else {
            T::zero()
        };
        let turned: [T; 2] = std::array::from_fn(|c| along[c] + across[c] * turn);
        let cut = friction / norm(turned);
        let force = turned.map(|f| f * cut);
        let (c, d) = (self.p.bristle_stiffness, self.p.bristle_damping);
        Node { x: held.x, deflection: std::array::from_fn(|k| (force[k] + across[k] * d) / c), force }
    }

    /// An implicit step of a bristle that slides to x against `friction`: the force is that of a bottom
    /// that stays where it is, cut back along the same direction.
    fn slid(&self, deflection: [T; 2], x: T, friction: T, time: T) -> Node<T> {
        let (c, d) = (self.p.bristle_stiffness, self.p.bristle_damping);
        let velocity = self.velocity(x);
        let trial: [T; 2] =
            std::array::from_fn(|k| (deflection[k] - time * velocity[k]) * c - velocity[k] * d);
        let size = norm(trial);
        let cut = if size.value() > 0.0 { friction / size } else { size };
        let force = trial.map(|f| f * cut);
        let relaxed = T::one() / (time * c + d);
        let deflection = std::array::from_fn(|k| (force[k] * time + deflection[k] * d) * relaxed);
        Node { x, deflection, force }
    }

    /// Lets a bristle slide to x, with the limits at the stages, and adds up its forces. Returns it there
    /// or where it comes to rest on its way.
    fn slide(
        &self,
        from: Node<T>,
        x: T,
        limits: [Limits<T>; 3],
        sums: &mut Sums<T>,
    ) -> (Node<T>, Option<Node<T>>) {
        let way = x - from.x;
        for (limits, stage) in limits.iter().zip(STAGES) {
            let x = from.x + way * stage;
            let friction = self.friction(x, limits);
            if friction.value() > 0.0 && norm(self.held(&from, x).force) <= friction {
                let at = self.come_to_rest(&from, x, sums);
                return (at, Some(at));
            }
        }
        // changes of the deflection, were each stage's slope that of the whole interval
        let mut changes = [[T::zero(); 2]; 3];
        let time = self.time(from.x, x) * DIAGONAL;
        let mut to = from;
        for (k, before) in [[0.0, 0.0], [SECOND, 0.0], THIRD].into_iter().enumerate() {
            let start = std::array::from_fn(|c| {
                from.deflection[c] + changes[0][c] * before[0] + changes[1][c] * before[1]
            });
            let x = from.x + way * STAGES[k];
            to = self.slid(start, x, self.friction(x, &limits[k]), time);
            changes[k] = std::array::from_fn(|c| (to.deflection[c] - start[c]) / DIAGONAL);
            let weight = [THIRD[0], THIRD[1], DIAGONAL][k] / self.p.bristle_length;
            sums.add(x, to.force, way.abs() * weight);
        }
        (to, None)
    }

    /// Where a bristle comes to rest on its way to x. An implicit step up to there takes the bottom to be
    /// at rest all the way; Richardson's extrapolation makes two steps of it.
    fn come_to_rest(&self, from: &Node<T>, x: T, sums: &mut Sums<T>) -> Node<T> {
        let rest = |from: &Node<T>| {
            let way = x - from.x;
            let margin = |part: f64| {
                let x = from.x + way * part;
                self.friction(x, &self.limits_at(x)) - norm(self.held(from, x).force)
            };
            self.held(from, from.x + way * crossing(margin))
        };
        let one = rest(from);
        let half = (from.x + one.x) * 0.5;
        let friction = self.friction(half, &self.limits_at(half));
        let first = self.slid(from.deflection, half, friction, self.time(from.x, half));
        let two = rest(&first);
        let at = two.x * 2.0 - one.x;
        let (bottom, less) = (self.held(&two, at), self.held(&one, at));
        let better = |a: [T; 2], b: [T; 2]| std::array::from_fn(|c| a[c] * 2.0 - b[c]);
        let at = Node {
            x: at,
            deflection: better(bottom.deflection, less.deflection),
            force: better(bottom.force, less.force),
        };
        let weight = (at.x - from.x).abs() / (6.0 * self.p.bristle_length);
        sums.add(from.x, from.force, weight);
        sums.add(half, first.force, weight * 4.0);
        sums.add(at.x, at.force, weight);
        at
    }
}

/// Where between 0 and 1 `margin` vanishes, which has different signs there; else the end at which it is smaller.
fn crossing<T: Real>(margin: impl Fn(f64) -> T) -> T {
    /// Steps of the search shorter than this are its last: the next would be its square.
    const NEAR: f64 = 1e-5;
    let value = |part: f64| margin(part).value();
    let (mut a, mut b) = ((0.0, value(0.0)), (1.0, value(1.0)));
    if a.1 * b.1 >= 0.0 {
        return T::from(if a.1.abs() <= b.1.abs() { 0.0 } else { 1.0 });
    }
    // secants between different signs; the side that stays counts half (the Illinois rule)
    for _ in 0..MAX_SECANTS {
        let part = (a.0 * b.1 - b.0 * a.1) / (b.1 - a.1);
        let last = std::mem::replace(&mut b, (part, value(part)));
        if (part - last.0).abs() < NEAR {
            break;
        }
        if last.1 * b.1 < 0.0 {
            a = last;
        } else {
            a.1 *= 0.5;
        }
    }
    // one more, symmetrical, whose derivatives are those of the place
    let (before, after) = ((b.0 - NEAR).max(0.0), (b.0 + NEAR).min(1.0));
    let (at_before, at_after) = (margin(before), margin(after));
    at_before / (at_before - at_after) * (after - before) + before
}
