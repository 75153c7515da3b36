//! Stationary states: the tire rolls, slides or stands with all forces constant (source: 4.1.7).
//!
//! Belt and rim move alike, the lagged loads are the loads, and the patch is a
//! [continuum](super::continuum). What the patch does to the belt tells where the belt's centre hangs on
//! the rim; seven equations are left, which Newton's method solves with exact derivatives.

use super::continuum::{Cut, Patch, Visit, continuum};
use super::{
    Bristles, Contact, Lag, Loads, Parameters, Prepared, State, belt_from_rim, patch_on_belt,
    stationary_coupling,
};
use crate::mechanics::{Motion, Wrench};
use crate::solver::{Convergence, Dual, Jump, Real, jump, newton};
use crate::tire::{Flat, Vertical};
use crate::{Error, Result};
use nalgebra::{DMatrix, DVector, Vector3};

/// Intervals along each stripe; with 48 the forces are within 1e-4 of their limit.
const INTERVALS: usize = 48;
/// Intervals of the stripes from which bristles take over their deflection on straight lines.
const NODES: usize = 200;
/// Residual over the wheel load (and tire radius) at which a state counts as stationary.
const TOLERANCE: f64 = 1e-6;
/// A search goes on to here, where rounding of the sums begins, as long as its steps lead closer,
const CONVERGED: f64 = 1e-11;
/// and no longer than this: a regular one takes 3 to 8, one beside a kink is halved again and again.
const MAX_STEPS: usize = 40;
/// Shorter parts of the way from straight rolling are not tried: where the forces do not follow them, they jump.
const SHORTEST: f64 = 1e-3;

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
    /// The forces jump here: the bristles of a stripe just come to rest, or just do not, and each would lead to the
    /// other. This is the mean of both that is in balance, which has no derivatives.
    pub jumps: bool,
    /// The Jacobian of the search near this state, which a search from here begins with.
    jacobian: Option<[[f64; N]; N]>,
}

/// How many numbers are looked for.
const N: usize = 7;

/// The unknowns in the order of the search.
#[derive(Clone, Copy)]
struct Unknowns<T: Real> {
    camber: T,
    yaw: T,
    windup: T,
    loads: Loads<T>,
    /// Of the belt's centre.
    height: T,
}

impl<T: Real> Unknowns<T> {
    fn from(x: &[T; N]) -> Self {
        Self {
            camber: x[0],
            yaw: x[1],
            windup: x[2],
            loads: Loads { force_x: x[3], force_y: x[4], moment_z: x[5] },
            height: x[6],
        }
    }

    /// The belt as seen from the point below its centre; its spin angle is 0.
    fn belt(&self, rim: &Motion<T>) -> Motion<T> {
        let zero = T::zero();
        Motion {
            position: Vector3::new(zero, zero, self.height),
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
/// straight rolling without slip and, where that does not succeed, approaches the state in steps.
///
/// A bristle that slides comes to rest below the limit of sliding and then stays up to that of sticking (4.33). A stripe
/// whose bristles just touch the limit of sliding sticks over some length or not at all, and its force jumps by some
/// thousandths of the load. Where balance lies within such a jump, the state is the mean of both sides
/// ([`jumps`](Stationary::jumps)).
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

/// [`stationary`] with a number of intervals along each stripe; the error falls with its third power, up to what kinks
/// leave.
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
    let cut = &Cut::new(intervals);
    let problem = |rim| Problem { tire, rim, vertical, friction, cut };
    // where the search for the state itself got stuck
    let mut stuck = None;
    loop {
        let goal = (reached + stride).min(1.0);
        let (mut trial, mut jacobian) = (x, None);
        let convergence = problem(on_the_way(p, rim, goal)).search(&mut trial, &mut jacobian);
        if convergence.residual <= TOLERANCE {
            (x, reached, stride) = (trial, goal, 2.0 * stride);
            if reached >= 1.0 {
                return Ok(problem(*rim).describe(&x, jacobian, convergence));
            }
            continue;
        }
        if goal >= 1.0 {
            stuck = Some((trial, jacobian, convergence));
        }
        stride *= 0.5;
        if stride < SHORTEST {
            // a jump is a state only where no way leads to one without
            let jump = |(x, jacobian, convergence)| problem(*rim).at_jump(&x, jacobian, convergence);
            return stuck.and_then(jump).ok_or_else(|| {
                Error::numeric(format!(
                    "no stationary state was found: {:.0} % of the way from straight rolling the forces stay {:.1e} of the wheel load away from balance",
                    100.0 * goal,
                    convergence.residual
                ))
            });
        }
    }
}

/// The rim's motion at a share of the way from straight free rolling.
fn on_the_way(p: &Parameters, rim: &Motion<f64>, share: f64) -> Motion<f64> {
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
fn straight_rolling(p: &Parameters, steer: f64, vertical: Vertical) -> [f64; N] {
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
    [0.0, steer, 0.0, 0.0, 0.0, 0.0, height + sag]
}

/// What a stationary state is looked for.
struct Problem<'a> {
    tire: &'a Prepared,
    rim: Motion<f64>,
    vertical: Vertical,
    friction: f64,
    cut: &'a Cut,
}

impl Problem<'_> {
    fn search(&self, x: &mut [f64; N], jacobian: &mut Option<[[f64; N]; N]>) -> Convergence {
        let (scale, values, derivatives) = (self.scale(), |x: &_| self.residual(x), |x: &_| self.residual(x));
        newton(x, &scale, CONVERGED, MAX_STEPS, jacobian, values, derivatives)
    }

    /// The state at a jump near x, where the search got stuck.
    fn at_jump(
        &self,
        x: &[f64; N],
        jacobian: Option<[[f64; N]; N]>,
        convergence: Convergence,
    ) -> Option<Stationary> {
        let (scale, values, derivatives) = (self.scale(), |x: &_| self.residual(x), |x: &_| self.residual(x));
        let Jump { sides, share, residual } = jump(x, &scale, TOLERANCE, values, derivatives)?;
        let convergence = Convergence { residual, ..convergence };
        let [a, b] = sides.map(|x| self.describe(&x, jacobian, convergence));
        Some(a.mean(&b, share))
    }

    /// The sizes of residuals.
    fn scale(&self) -> [f64; N] {
        let p = self.tire.parameters();
        let load = match self.vertical {
            Vertical::Load(load) => load.abs(),
            Vertical::Height(height) => p.vertical_stiffness * (p.radius - height).max(0.0),
        }
        .max(p.belt_mass * p.gravity)
        .max(1.0);
        let moment = load * p.radius;
        // the last row is a length or a force
        let last = match self.vertical {
            Vertical::Height(_) => p.radius,
            Vertical::Load(_) => load,
        };
        [moment, moment, moment, load, load, moment, last]
    }

    fn residual<T: Real>(&self, x: &[T; N]) -> [T; N] {
        let Self { tire, mut rim, vertical, friction, cut } = *self;
        if let Vertical::Height(height) = vertical {
            rim.position.z = height;
        }
        residual(tire, &rim.constant(), vertical, friction.into(), cut, x)
    }

    fn describe(
        &self,
        x: &[f64; N],
        jacobian: Option<[[f64; N]; N]>,
        convergence: Convergence,
    ) -> Stationary {
        let Self { tire, ref rim, friction, cut, .. } = *self;
        let unknowns = Unknowns::from(x);
        let balance = balance(tire, rim, friction, &unknowns, cut, &mut |_, _, _, _| {});
        Stationary {
            rim_height: balance.rim_height,
            belt_from_rim: balance.belt_from_rim,
            belt_camber: unknowns.camber,
            belt_yaw: unknowns.yaw,
            windup: unknowns.windup,
            loads: balance.loads,
            patch: balance.patch.on_belt,
            on_rim: balance.on_rim,
            power_loss: balance.patch.power_loss,
            friction,
            intervals: cut.intervals(),
            convergence,
            jumps: false,
            jacobian,
        }
    }
}

/// What is zero in a stationary state; a height that is held is that of `rim`.
fn residual<T: Real>(
    tire: &Prepared,
    rim: &Motion<T>,
    vertical: Vertical,
    friction: T,
    cut: &Cut,
    x: &[T; N],
) -> [T; N] {
    let unknowns = Unknowns::from(x);
    let balance = balance(tire, rim, friction, &unknowns, cut, &mut |_, _, _, _| {});
    let Loads { force_x, force_y, moment_z } = balance.loads;
    let held = match vertical {
        Vertical::Height(_) => rim.position.z - balance.rim_height,
        Vertical::Load(load) => balance.on_rim.force.z - load,
    };
    let Loads { force_x: lagged_x, force_y: lagged_y, moment_z: lagged_moment } = unknowns.loads;
    let m = balance.moment;
    [m.x, m.y, m.z, force_x - lagged_x, force_y - lagged_y, moment_z - lagged_moment, held]
}

struct Balance<T: Real> {
    /// Sum on the belt, about its centre; zero in a stationary state.
    moment: Vector3<T>,
    loads: Loads<T>,
    patch: Patch<T>,
    /// Where the side wall's force holds the patch's and the weight of the belt.
    belt_from_rim: Vector3<T>,
    rim_height: T,
    on_rim: Wrench<T>,
}

fn balance<T: Real>(
    tire: &Prepared,
    rim: &Motion<T>,
    friction: T,
    unknowns: &Unknowns<T>,
    cut: &Cut,
    visit: &mut Visit<'_>,
) -> Balance<T> {
    let p = tire.parameters();
    let belt = unknowns.belt(rim);
    let contact = Contact::new(p, &belt);
    let spin_rate = belt.rates.y;
    let patch = continuum(tire, &contact, spin_rate, friction, &unknowns.loads, cut, visit);
    let Wrench { force: patch_force, moment: patch_moment } = patch.on_belt;
    let on_belt = patch_on_belt(&contact, &patch_force, &patch_moment);
    let mut force = -on_belt.force;
    force.z += T::from(p.belt_mass * p.gravity);
    let angles = (unknowns.camber, unknowns.yaw);
    let belt_from_rim = belt_from_rim(p, &force, angles, spin_rate);
    let (side, on_rim) = stationary_coupling(
        p,
        &belt_from_rim,
        (rim.angles.x, rim.angles.z),
        angles,
        unknowns.windup,
        spin_rate,
    );
    Balance {
        moment: side.moment + on_belt.moment,
        loads: Loads { force_x: patch_force.x, force_y: patch_force.y, moment_z: patch_moment.z },
        patch,
        belt_from_rim,
        rim_height: unknowns.height - belt_from_rim.z,
        on_rim,
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
    /// [`stationary`] with a search that begins at this state, of a tire and a motion that differ little from
    /// those wanted: in fewer steps. Where it does not succeed, the search begins anew.
    ///
    /// # Errors
    /// As [`stationary`].
    pub fn near(
        &self,
        tire: &Prepared,
        rim: &Motion<f64>,
        vertical: Vertical,
        friction: f64,
    ) -> Result<Self> {
        let problem = Problem { tire, rim: *rim, vertical, friction, cut: &Cut::new(self.intervals) };
        let (mut x, mut jacobian) = (self.unknowns(), self.jacobian);
        let convergence = problem.search(&mut x, &mut jacobian);
        if convergence.residual <= TOLERANCE {
            return Ok(problem.describe(&x, jacobian, convergence));
        }
        stationary_refined(tire, rim, vertical, friction, self.intervals)
    }

    /// The mean of two sides of a jump, the second of which counts by `share`.
    fn mean(&self, other: &Self, share: f64) -> Self {
        let mean = |of: fn(&Self) -> f64| of(self) + share * (of(other) - of(self));
        let vector = |of: fn(&Self) -> Vector3<f64>| of(self).lerp(&of(other), share);
        let wrench = |of: fn(&Self) -> &Wrench<f64>| {
            let (a, b) = (of(self), of(other));
            Wrench { force: a.force.lerp(&b.force, share), moment: a.moment.lerp(&b.moment, share) }
        };
        Self {
            rim_height: mean(|s| s.rim_height),
            belt_from_rim: vector(|s| s.belt_from_rim),
            belt_camber: mean(|s| s.belt_camber),
            belt_yaw: mean(|s| s.belt_yaw),
            windup: mean(|s| s.windup),
            loads: Loads {
                force_x: mean(|s| s.loads.force_x),
                force_y: mean(|s| s.loads.force_y),
                moment_z: mean(|s| s.loads.moment_z),
            },
            patch: wrench(|s| &s.patch),
            on_rim: wrench(|s| &s.on_rim),
            power_loss: mean(|s| s.power_loss),
            jumps: true,
            ..self.clone()
        }
    }

    /// The unknowns in the order of the search.
    fn unknowns(&self) -> [f64; N] {
        let Loads { force_x, force_y, moment_z } = self.loads;
        let height = self.rim_height + self.belt_from_rim.z;
        [self.belt_camber, self.belt_yaw, self.windup, force_x, force_y, moment_z, height]
    }

    /// The derivative of the state along a change of the rim's motion, height included, and of the
    /// friction factor, which `rim` and `friction` carry as the derivatives of their numbers: the implicit
    /// function theorem on the equations of the search. `None` where their Jacobian is singular or they jump.
    pub fn along(&self, tire: &Prepared, rim: &Motion<Dual<1>>, friction: Dual<1>) -> Option<Moved> {
        if self.jumps {
            return None;
        }
        let held = Vertical::Height(self.rim_height);
        let x = self.unknowns();
        let fixed = Motion {
            position: rim.position.map(Real::value),
            velocity: rim.velocity.map(Real::value),
            angles: rim.angles.map(Real::value),
            rates: rim.rates.map(Real::value),
        };
        let variables: [Dual<N>; N] = std::array::from_fn(|i| Dual::variable(x[i], i));
        let cut = &Cut::new(self.intervals);
        let by_x = residual(tire, &fixed.constant(), held, friction.value.into(), cut, &variables);
        let by_rim = residual(tire, rim, held, friction, cut, &x.map(Dual::<1>::from));
        let jacobian = DMatrix::from_fn(N, N, |i, j| by_x[i].gradient[j]);
        let change = jacobian.lu().solve(&DVector::from_fn(N, |i, _| -by_rim[i].gradient[0]))?;
        let moved: [Dual<1>; N] = std::array::from_fn(|i| Dual { value: x[i], gradient: [change[i]] });
        let unknowns = Unknowns::from(&moved);
        let balance = balance(tire, rim, friction, &unknowns, cut, &mut |_, _, _, _| {});
        let Patch { on_belt, power_loss } = balance.patch;
        let mut belt = unknowns.belt(rim);
        belt.position.x = balance.belt_from_rim.x;
        belt.position.y = balance.belt_from_rim.y;
        Some(Moved { belt, windup: unknowns.windup, patch: on_belt, power_loss })
    }

    /// The tire's state in time: the belt in balance, each bristle with the deflection that belongs
    /// to its place. The bristles' sums differ from the continuum's by what the rule of their integrals leaves.
    ///
    /// # Errors
    /// A state outside the model's validity.
    pub fn state(&self, tire: &Prepared, rim: &Motion<f64>) -> Result<State> {
        let p = tire.parameters();
        let unknowns = Unknowns::from(&self.unknowns());
        let mut belt = unknowns.belt(rim);
        belt.position = self.belt_from_rim;
        belt.position.z += self.rim_height;
        belt.angles.y = rim.angles.y - self.windup;
        let mut bristles = Bristles::new(p);
        bristles.wind(p, belt.angles.y);
        bristles.look_at([0, bristles.per_stripe]);
        let contact = Contact::new(p, &belt);
        for (i, (y, radius)) in tire.stripe_places().iter().zip(tire.stripe_radii()).enumerate() {
            bristles.stripes.lengths[i] = contact.stripe_length(p, *y, *radius);
        }

        // bristles take over the deflection of the interval that they are in
        let (n, stride) = (bristles.per_stripe, bristles.stride());
        let mut last = (usize::MAX, 0.0, [0.0; 2]);
        let first = bristles.place(p, 0);
        balance(tire, rim, self.friction, &unknowns, &Cut::new(NODES), &mut |i, x, deflection, stick| {
            let (stripe, from, before) = std::mem::replace(&mut last, (i, x, deflection));
            if stripe != i {
                return;
            }
            let [low, high] = [from.min(x), from.max(x)].map(|x| ((x - first) / p.bristle_length).floor());
            for j in low.max(0.0) as usize..(high.max(0.0) as usize + 2).min(n) {
                let part = (bristles.place(p, j) - from) / (x - from);
                if part > 0.0 && part <= 1.0 {
                    let k = i * stride + j;
                    bristles.deflection_x[k] = before[0] + part * (deflection[0] - before[0]);
                    bristles.deflection_y[k] = before[1] + part * (deflection[1] - before[1]);
                    bristles.stick[k] = f64::from(u8::from(stick));
                }
            }
        });

        let mut state =
            State { belt, bristles, lag: Lag::at_rest(&self.loads), loads: self.loads, ..State::default() };
        let mut rim = *rim;
        rim.position = Vector3::new(0.0, 0.0, self.rim_height);
        tire.step(&mut state, &rim, &rim, &Flat { friction: self.friction }, 0.0)?;
        state.patch.power_loss = self.power_loss;
        // in balance by construction; what the sums of bristles are off by is no reason to start with a jerk
        state.acceleration = [Vector3::zeros(); 2];
        state.lag = Lag::at_rest(&self.loads);
        Ok(state)
    }
}
