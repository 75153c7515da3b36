//! Stationary states: the tire rolls, slides or stands with all forces constant (source: 4.1.7).
//!
//! Belt and rim move alike, the lagged loads are the loads, and bristles pass through the patch like
//! beads on a string: what one does in time is what all do along the patch. So the patch is a
//! continuum, integrated from where bristles enter to where they leave, and ten equations are solved
//! by Newton's method with exact derivatives.

use super::bristle::norm;
use super::patch::{Moments, Pressure, Shape};
use super::{
    Bristles, Contact, Deformation, Limits, Loads, Parameters, Prepared, State, Step, Tops, advance,
    moment_y, patch_on_belt, stationary_coupling,
};
use crate::mechanics::{Motion, Wrench};
use crate::solver::{Convergence, Dual, Real, newton};
use crate::tire::{Flat, Vertical};
use crate::{Error, Result};
use nalgebra::{DMatrix, DVector, Vector3};

/// Intervals along each stripe. They are shortest at the entry, where a bristle's damper builds up
/// its force over 0.1 mm; with 200 the forces are within 1e-4 of their limit.
const INTERVALS: usize = 200;
/// Residual over the wheel load (and tire radius) at which a state counts as stationary.
const TOLERANCE: f64 = 1e-6;
/// A time \[s\] in which every bristle of a wheel that does not spin has started to slide.
const LONG: f64 = 1e3;

/// A stationary state.
#[derive(Debug, Clone, PartialEq)]
pub struct Stationary {
    /// Height of the rim's centre \[m\].
    pub rim_height: f64,
    /// Belt centre from rim centre, frame 0 \[m\].
    pub belt_from_rim: Vector3<f64>,
    /// Camber of the belt \[rad\].
    pub belt_camber: f64,
    /// Steer angle of the belt \[rad\].
    pub belt_yaw: f64,
    /// Spin angle of the rim ahead of the belt \[rad\].
    pub windup: f64,
    /// Loads of the patch in K.
    pub loads: Loads<f64>,
    /// Force and moment of the patch on the belt in K \[N, N.m\].
    pub patch: Wrench<f64>,
    /// Force and moment of the tire on the rim, frame 0, about the rim's centre.
    pub on_rim: Wrench<f64>,
    /// Power lost in the contact \[W\], as [`PatchReport::power_loss`](super::PatchReport).
    pub power_loss: f64,
    /// Factor on both friction coefficients.
    pub friction: f64,
    /// Intervals along each stripe.
    pub intervals: usize,
    /// How the search ended.
    pub convergence: Convergence,
}

/// The unknowns in the order of the search.
#[derive(Clone, Copy)]
struct Unknowns<T: Real> {
    belt_from_rim: Vector3<T>,
    camber: T,
    yaw: T,
    windup: T,
    loads: Loads<T>,
    rim_height: T,
}

impl<T: Real> Unknowns<T> {
    fn from(x: &[T; 10]) -> Self {
        Self {
            belt_from_rim: Vector3::new(x[0], x[1], x[2]),
            camber: x[3],
            yaw: x[4],
            windup: x[5],
            loads: Loads { force_x: x[6], force_y: x[7], moment_z: x[8] },
            rim_height: x[9],
        }
    }

    /// The belt; its spin angle is 0.
    fn belt(&self, rim: &Motion<T>) -> Motion<T> {
        let zero = T::zero();
        let mut position = self.belt_from_rim;
        position.z += self.rim_height;
        Motion {
            position,
            velocity: Vector3::new(rim.velocity.x, rim.velocity.y, zero),
            angles: Vector3::new(self.camber, zero, self.yaw),
            rates: Vector3::new(zero, rim.rates.y, zero),
        }
    }
}

/// The stationary state of a tire whose rim keeps its velocity, camber, steer angle and spin rate.
///
/// Of `rim`, the horizontal velocity, the angles x and z and the rate y count; `friction` is a factor on
/// both friction coefficients. The search starts at
/// straight rolling without slip and, where one jump does not succeed, approaches the state in steps.
///
/// # Errors
/// No stationary state was found: the source does not promise one, and far from straight rolling
/// there may be none.
pub fn stationary(
    tire: &Prepared,
    rim: &Motion<f64>,
    vertical: Vertical,
    friction: f64,
) -> Result<Stationary> {
    stationary_refined(tire, rim, vertical, friction, INTERVALS)
}

/// [`stationary`] with a number of intervals along each stripe; the error falls with its square.
///
/// # Errors
/// As [`stationary`].
pub fn stationary_refined(
    tire: &Prepared,
    rim: &Motion<f64>,
    vertical: Vertical,
    friction: f64,
    intervals: usize,
) -> Result<Stationary> {
    let p = tire.parameters();
    let mut x = straight_rolling(p, rim.angles.z, vertical);
    let (mut reached, mut stride) = (0.0, 1.0_f64);
    loop {
        let goal = (reached + stride).min(1.0);
        let mut trial = x;
        let target = between(p, rim, goal);
        let convergence = search(tire, &target, vertical, friction, intervals, &mut trial);
        if convergence.residual <= TOLERANCE {
            (x, reached, stride) = (trial, goal, 2.0 * stride);
            if reached >= 1.0 {
                return Ok(describe(tire, rim, friction, &x, intervals, convergence));
            }
        } else {
            stride *= 0.5;
            if stride < 1e-3 {
                return Err(Error::numeric(format!(
                    "no stationary state was found: {:.0} % of the way from straight rolling the forces stay {:.1e} of the wheel load away from balance",
                    100.0 * goal,
                    convergence.residual
                )));
            }
        }
    }
}

/// The rim's motion at a share of the way from straight free rolling.
fn between(p: &Parameters, rim: &Motion<f64>, share: f64) -> Motion<f64> {
    let mut target = *rim;
    target.angles.x *= share;
    let (vx, vy) = (rim.velocity.x, rim.velocity.y);
    let speed = libm::hypot(vx, vy);
    if share < 1.0 && speed > 0.0 {
        let mut drift = libm::atan2(vy, vx) - rim.angles.z;
        drift -= (drift / std::f64::consts::TAU).round() * std::f64::consts::TAU;
        // backward travel: the nearest free rolling is backward
        let back = drift.abs() > std::f64::consts::FRAC_PI_2;
        let offset = if back { std::f64::consts::PI.copysign(drift) } else { 0.0 };
        let heading = rim.angles.z + offset + share * (drift - offset);
        target.velocity.x = speed * libm::cos(heading);
        target.velocity.y = speed * libm::sin(heading);
        let free = if back { -speed } else { speed } / p.rolling_radius;
        target.rates.y = free + share * (rim.rates.y - free);
    }
    target
}

/// Unknowns of the tire that rolls straight and without slip, or hangs in the air: springs in series.
fn straight_rolling(p: &Parameters, steer: f64, vertical: Vertical) -> [f64; 10] {
    let (linear, quadratic) = (p.vertical_stiffness, p.vertical_stiffness_quadratic);
    let radial = p.sidewall_radial_stiffness;
    let weight = p.belt_mass * p.gravity;
    let root = |a: f64, b: f64, c: f64| 2.0 * c / (b + (b * b + 4.0 * a * c).sqrt());
    // penetration: quadratic * f² + linear * f = force, or with the side wall in series
    let penetration = match vertical {
        Vertical::Load(load) => root(quadratic, linear, (load + weight).max(0.0)),
        Vertical::Height(height) => {
            let closed = p.radius - height + weight / radial;
            root(quadratic / radial, 1.0 + linear / radial, closed.max(0.0))
        }
    };
    let force = (quadratic * penetration + linear) * penetration;
    let sag = (force - weight) / radial;
    let height = match vertical {
        Vertical::Height(height) => height,
        Vertical::Load(_) => p.radius - penetration - sag,
    };
    let mut x = [0.0; 10];
    x[2] = sag;
    x[4] = steer;
    x[9] = height;
    x
}

fn search(
    tire: &Prepared,
    rim: &Motion<f64>,
    vertical: Vertical,
    friction: f64,
    intervals: usize,
    x: &mut [f64; 10],
) -> Convergence {
    let p = tire.parameters();
    let load = match vertical {
        Vertical::Load(load) => load.abs(),
        Vertical::Height(height) => p.vertical_stiffness * (p.radius - height).max(0.0),
    }
    .max(p.belt_mass * p.gravity)
    .max(1.0);
    let moment = load * p.radius;
    // the last row is a length or a force
    let last = match vertical {
        Vertical::Height(_) => p.radius,
        Vertical::Load(_) => load,
    };
    let scale = [load, load, load, moment, moment, moment, load, load, moment, last];
    let mut rim = rim.constant();
    if let Vertical::Height(height) = vertical {
        rim.position.z = height.into();
    }
    newton(x, &scale, 1e-11, 40, |x: &[Dual<10>; 10]| {
        residual(tire, &rim, vertical, friction.into(), intervals, x)
    })
}

/// What is zero in a stationary state; a height that is held is that of `rim`.
fn residual<T: Real>(
    tire: &Prepared,
    rim: &Motion<T>,
    vertical: Vertical,
    friction: T,
    intervals: usize,
    x: &[T; 10],
) -> [T; 10] {
    let unknowns = Unknowns::from(x);
    let balance = balance(tire, rim, friction, &unknowns, intervals, &mut |_, _, _| {});
    let Loads { force_x, force_y, moment_z } = balance.loads;
    let held = match vertical {
        Vertical::Height(_) => unknowns.rim_height - rim.position.z,
        Vertical::Load(load) => balance.on_rim.force.z - load,
    };
    let (f, m) = (balance.belt.force, balance.belt.moment);
    [
        f.x,
        f.y,
        f.z,
        m.x,
        m.y,
        m.z,
        force_x - unknowns.loads.force_x,
        force_y - unknowns.loads.force_y,
        moment_z - unknowns.loads.moment_z,
        held,
    ]
}

struct Balance<T: Real> {
    /// Sum on the belt, about its centre; zero in a stationary state.
    belt: Wrench<T>,
    loads: Loads<T>,
    patch: Patch<T>,
    on_rim: Wrench<T>,
}

/// What the patch does to the belt.
#[derive(Clone, Copy)]
struct Patch<T: Real> {
    /// In K about the contact point.
    on_belt: Wrench<T>,
    /// Power lost in the contact.
    power_loss: T,
}

/// A node of a stripe: place x, deflection, sticking. Told to whoever wants to fill bristles.
type Visit<'a> = dyn FnMut(usize, f64, ([f64; 2], bool)) + 'a;

fn balance<T: Real>(
    tire: &Prepared,
    rim: &Motion<T>,
    friction: T,
    unknowns: &Unknowns<T>,
    intervals: usize,
    visit: &mut Visit<'_>,
) -> Balance<T> {
    let p = tire.parameters();
    let belt = unknowns.belt(rim);
    let contact = Contact::new(p, &belt);
    let patch = continuum(tire, &contact, belt.rates.y, friction, &unknowns.loads, intervals, visit);
    let Wrench { force: patch_force, moment: patch_moment } = patch.on_belt;
    let (side, on_rim) = stationary_coupling(
        p,
        &unknowns.belt_from_rim,
        (rim.angles.x, rim.angles.z),
        (unknowns.camber, unknowns.yaw),
        unknowns.windup,
        rim.rates.y,
    );
    let on_belt = patch_on_belt(&contact, &patch_force, &patch_moment);
    let mut force = side.force + on_belt.force;
    force.z -= T::from(p.belt_mass * p.gravity);
    Balance {
        belt: Wrench { force, moment: side.moment + on_belt.moment },
        loads: Loads { force_x: patch_force.x, force_y: patch_force.y, moment_z: patch_moment.z },
        patch,
        on_rim,
    }
}

/// A point of a stripe and the force density there.
#[derive(Clone, Copy)]
struct Node<T> {
    x: T,
    force: [T; 2],
}

/// Loads of the patch in K with bristles of no length (4.24), (4.34): sums over the bristles of a
/// stripe become integrals over x divided by the bristle length.
///
/// Each stripe is marched from its entry with the bristle's own law. The point at which a bristle
/// breaks away is located inside its interval, so that the loads and their derivatives contain its
/// motion. A bristle that slides turns while it does; the bristle's law is of first order there, and
/// of second with Richardson's extrapolation from one step and two half steps.
fn continuum<T: Real>(
    tire: &Prepared,
    contact: &Contact<T>,
    spin_rate: T,
    friction: T,
    loads: &Loads<T>,
    intervals: usize,
    visit: &mut Visit<'_>,
) -> Patch<T> {
    let p = tire.parameters();
    let mut force = Vector3::new(T::zero(), T::zero(), contact.normal_force);
    let moment_y = moment_y(p, contact, spin_rate, loads.force_x);
    let mut moment = Vector3::new(T::zero(), moment_y, T::zero());
    let mut power_loss = T::zero();
    let deformation = Deformation::new(p, loads);
    let tops = Tops::new(p, contact, spin_rate, loads, &Loads::default_real());
    let shape = Shape::new(p, contact.penetration);
    let entry = if spin_rate.value() < 0.0 { -1.0 } else { 1.0 };
    let feed = spin_rate.abs() * p.rolling_radius;

    // place along a stripe as a share of its length, from the entry
    let share = |k: usize| {
        let place = k as f64 / intervals as f64;
        place * place
    };
    let place = |length: T, k: usize| length * (entry * (0.5 - share(k)));

    let stripes = || tire.stripe_places().iter().zip(tire.stripe_radii()).enumerate();
    let zero = T::zero();
    let mut sums = Moments { s0: zero, s1: zero, s2: zero };
    let mut longest: f64 = 0.0;
    for (_, (&y, &radius)) in stripes() {
        let length = contact.stripe_length(p, y, radius);
        if length.value() <= 0.0 {
            continue;
        }
        longest = longest.max(length.value());
        let factor = shape.stripe(y, length);
        for k in 1..intervals {
            let x = place(length, k);
            let width = length * (0.5 * (share(k + 1) - share(k - 1)) / p.bristle_length);
            let s = shape.along(x, length) * factor * width;
            sums.s0 += s;
            sums.s1 += x * s;
            sums.s2 += x * x * s;
        }
    }
    let tilting = moment_y + deformation.shift_x * contact.normal_force;
    let pressure = Pressure::new(p, &sums, contact.normal_force, tilting, longest);

    for (i, (&y, &radius)) in stripes() {
        let length = contact.stripe_length(p, y, radius);
        if length.value() <= 0.0 {
            continue;
        }
        let y_real = T::from(y);
        let factor = shape.stripe(y, length);
        let normal = |x: T| pressure.at(x, shape.along(x, length) * factor) * p.cell_area();
        let limits_at = |load: T| Limits::new(p, load / p.cell_area(), load * friction);
        let mut add = |from: Node<T>, to: Node<T>| {
            let width = (to.x - from.x).abs() * (0.5 / p.bristle_length);
            for Node { x, force: f } in [from, to] {
                let [place_x, place_y] = deformation.place(x, y_real);
                force.x += f[0] * width;
                force.y += f[1] * width;
                moment.x += place_y * normal(x) * width;
                moment.z += (place_x * f[1] - place_y * f[0]) * width;
                power_loss += tops.power(x, y_real, f) * width;
            }
        };

        let mut node = Node { x: place(length, 0), force: [zero; 2] };
        let mut limits = Limits { sticking: zero, sliding: zero };
        let (mut deflection, mut stick) = ([zero; 2], false);
        visit(i, node.x.value(), ([0.0; 2], false));
        for k in 1..=intervals {
            let x = place(length, k);
            let way = (x - node.x).abs();
            let dt = if feed.value() * LONG > way.value() { way / feed } else { T::from(LONG) };
            // the velocity is linear in x: its mean over the interval is exact
            let velocity = tops.velocity((x + node.x) * 0.5, y_real);
            let load = if k == intervals { zero } else { normal(x) };
            let next_limits = limits_at(load);
            // sliding from one place to another; the last interval ends where nothing is carried
            let slide = |from: T, deflection: [T; 2], dt: T| {
                let middle = (from + x) * 0.5;
                let half_limits = limits_at(normal(middle));
                let velocity = |at: T| tops.velocity(at, y_real);
                let whole = advance(p, deflection, velocity(middle), false, &next_limits, dt);
                let (quarter, half) = ((from + middle) * 0.5, dt * 0.5);
                let first = advance(p, deflection, velocity(quarter), false, &half_limits, half);
                let last = (middle + x) * 0.5;
                let second = advance(p, first.deflection, velocity(last), false, &next_limits, half);
                if k == intervals || whole.stick || first.stick || second.stick {
                    return whole;
                }
                let better = |a: [T; 2], b: [T; 2]| std::array::from_fn(|c| a[c] * 2.0 - b[c]);
                Step {
                    deflection: better(second.deflection, whole.deflection),
                    force: better(second.force, whole.force),
                    ..second
                }
            };
            let mut step = if stick {
                advance(p, deflection, velocity, true, &next_limits, dt)
            } else {
                slide(node.x, deflection, dt)
            };
            let trial: [T; 2] = std::array::from_fn(|c| {
                (deflection[c] - dt * velocity[c]) * p.bristle_stiffness - velocity[c] * p.bristle_damping
            });
            if stick && norm(node.force) <= limits.sticking && norm(trial) > next_limits.sticking {
                // broken away: where on the way did the trial force reach the limit?
                let before = limits.sticking - norm(node.force);
                let after = norm(trial) - next_limits.sticking;
                let part = before / (before + after);
                let held = Node {
                    x: node.x + (x - node.x) * part,
                    force: std::array::from_fn(|c| node.force[c] + (trial[c] - node.force[c]) * part),
                };
                let sliding = limits.sliding + (next_limits.sliding - limits.sliding) * part;
                let cut = p.friction_at_speed(sliding, velocity) / norm(held.force);
                let released = Node { x: held.x, force: held.force.map(|f| f * cut) };
                add(node, held);
                node = released;
                deflection = std::array::from_fn(|c| deflection[c] - dt * part * velocity[c]);
                step = slide(held.x, deflection, dt * (-part + 1.0));
            }
            let next = Node { x, force: step.force };
            add(node, next);
            (node, limits, deflection, stick) = (next, next_limits, step.deflection, step.stick);
            visit(i, x.value(), (deflection.map(Real::value), stick));
        }
    }
    power_loss += tops.camber_power(moment.z);
    Patch { on_belt: Wrench { force, moment }, power_loss }
}

impl<T: Real> Loads<T> {
    fn default_real() -> Self {
        Self { force_x: T::zero(), force_y: T::zero(), moment_z: T::zero() }
    }
}

fn describe(
    tire: &Prepared,
    rim: &Motion<f64>,
    friction: f64,
    x: &[f64; 10],
    intervals: usize,
    convergence: Convergence,
) -> Stationary {
    let unknowns = Unknowns::from(x);
    let balance = balance(tire, rim, friction, &unknowns, intervals, &mut |_, _, _| {});
    Stationary {
        rim_height: unknowns.rim_height,
        belt_from_rim: unknowns.belt_from_rim,
        belt_camber: unknowns.camber,
        belt_yaw: unknowns.yaw,
        windup: unknowns.windup,
        loads: balance.loads,
        patch: balance.patch.on_belt,
        on_rim: balance.on_rim,
        power_loss: balance.patch.power_loss,
        friction,
        intervals,
        convergence,
    }
}

/// How a stationary state moves when the rim's motion or the friction does.
#[derive(Debug, Clone, Copy)]
pub struct Moved {
    /// The belt; its spin angle is 0.
    pub belt: Motion<Dual<1>>,
    /// Spin angle of the rim ahead of the belt \[rad\].
    pub windup: Dual<1>,
    /// Force and moment of the patch on the belt in K.
    pub patch: Wrench<Dual<1>>,
    /// Power lost in the contact.
    pub power_loss: Dual<1>,
}

impl Stationary {
    /// The unknowns in the order of the search.
    fn unknowns(&self) -> [f64; 10] {
        let [x, y, z] = self.belt_from_rim.into();
        let Loads { force_x, force_y, moment_z } = self.loads;
        [x, y, z, self.belt_camber, self.belt_yaw, self.windup, force_x, force_y, moment_z, self.rim_height]
    }

    /// The derivative of the state along a change of the rim's motion, height included, and of the
    /// friction factor, which `rim` and `friction` carry as the derivatives of their numbers: the implicit
    /// function theorem on the equations of the search. `None` where their Jacobian is singular.
    pub fn along(&self, tire: &Prepared, rim: &Motion<Dual<1>>, friction: Dual<1>) -> Option<Moved> {
        let held = Vertical::Height(self.rim_height);
        let x = self.unknowns();
        let fixed = Motion {
            position: rim.position.map(Real::value),
            velocity: rim.velocity.map(Real::value),
            angles: rim.angles.map(Real::value),
            rates: rim.rates.map(Real::value),
        };
        let variables: [Dual<10>; 10] = std::array::from_fn(|i| Dual::variable(x[i], i));
        let by_x = residual(tire, &fixed.constant(), held, friction.value.into(), self.intervals, &variables);
        let by_rim = residual(tire, rim, held, friction, self.intervals, &x.map(Dual::<1>::from));
        let jacobian = DMatrix::from_fn(10, 10, |i, j| by_x[i].gradient[j]);
        let change = jacobian.lu().solve(&DVector::from_fn(10, |i, _| -by_rim[i].gradient[0]))?;
        let moved: [Dual<1>; 10] = std::array::from_fn(|i| Dual { value: x[i], gradient: [change[i]] });
        let unknowns = Unknowns::from(&moved);
        let Patch { on_belt, power_loss } =
            balance(tire, rim, friction, &unknowns, self.intervals, &mut |_, _, _| {}).patch;
        Some(Moved { belt: unknowns.belt(rim), windup: unknowns.windup, patch: on_belt, power_loss })
    }

    /// The tire's state in time: the belt in balance, each bristle with the deflection that belongs
    /// to its place. The bristles' sums differ from the continuum's by the ripple of their spacing.
    ///
    /// # Errors
    /// A state outside the model's validity.
    pub fn state(&self, tire: &Prepared, rim: &Motion<f64>) -> Result<State> {
        let p = tire.parameters();
        let unknowns = Unknowns::from(&self.unknowns());
        let mut belt = unknowns.belt(rim);
        belt.angles.y = rim.angles.y - self.windup;
        let mut bristles = Bristles::new(p);
        bristles.wind(p, belt.angles.y);
        bristles.look_at([0, bristles.per_stripe]);
        let contact = Contact::new(p, &belt);
        for (i, (y, radius)) in tire.stripe_places().iter().zip(tire.stripe_radii()).enumerate() {
            bristles.lengths[i] = contact.stripe_length(p, *y, *radius);
        }

        // bristles take over the deflection of the interval that they are in
        let (n, stride) = (bristles.per_stripe, bristles.stride());
        let mut last = (usize::MAX, 0.0, [0.0; 2]);
        balance(tire, rim, self.friction, &unknowns, self.intervals, &mut |i, x, (deflection, stick)| {
            let (stripe, from, before) = std::mem::replace(&mut last, (i, x, deflection));
            if stripe != i {
                return;
            }
            for j in 0..n {
                let part = (bristles.place(p, j) - from) / (x - from);
                if part > 0.0 && part <= 1.0 {
                    let k = i * stride + j;
                    bristles.deflection_x[k] = before[0] + part * (deflection[0] - before[0]);
                    bristles.deflection_y[k] = before[1] + part * (deflection[1] - before[1]);
                    bristles.stick[k] = f64::from(u8::from(stick));
                }
            }
        });

        let mut state = State { belt, bristles, lagged: self.loads, loads: self.loads, ..State::default() };
        let mut rim = *rim;
        rim.position = Vector3::new(0.0, 0.0, self.rim_height);
        tire.step(&mut state, &rim, &rim, &Flat { friction: self.friction }, 0.0)?;
        state.patch.power_loss = self.power_loss;
        // in balance by construction; the ripple of the bristles is no reason to start with a jerk
        state.acceleration = [Vector3::zeros(); 2];
        state.lag_rates = Loads::default();
        state.lag_accelerations = Loads::default();
        Ok(state)
    }
}
