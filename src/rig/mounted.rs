//! A tire on a rim whose motion somebody else decides: a rig's imposed motion, a hub, a master.

use super::stability::Link;
use crate::model::SMALL_STEP;
use crate::tire::ring_brush::{Parameters, State, Stationary, Tire, Vertical, stationary};
use crate::tire::{Ground, Motion, Plane};
use crate::{Result, clone_in_place};
use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

/// The slip at which a free wheel starts is looked for up to here. It is a few thousandths; beyond, the
/// moment of the tire no longer depends on it and tells nothing about where it vanishes.
const MAX_START_SLIP: f64 = 0.05;
/// A wheel whose moment is less than this share of load times radius starts free of torque.
const START_TORQUE: f64 = 1e-7;
/// Steps of the search for that: secants take a few; so many halvings of the range get as far.
const MAX_START_STEPS: usize = 30;

/// The ring-and-brush tire with its rim and what is measured between them.
#[derive(Debug, PartialEq, Default, Serialize, Deserialize)]
pub struct MountedTire {
    /// Name of the tire, for reports.
    pub name: String,
    /// Its parameters as set; the tire takes them over at the start and when they are tuned.
    pub parameters: Parameters,
    /// The tire.
    pub tire: Tire,
    /// The rim. Seen from the point below its centre: x and y of its position are 0.
    pub rim: Motion<f64>,
    /// The tire's state.
    pub state: State,
    /// Force of the tire on the rim in H axes \[N\].
    pub force: Vector3<f64>,
    /// Moment of the tire on the rim in H axes, about the wheel's centre \[N.m\].
    pub moment: Vector3<f64>,
    /// The start is a stationary state.
    pub stationary_start: bool,
    /// Torque about the wheel's axis that a free wheel starts with, because it cannot be without \[N.m\].
    pub start_torque: f64,
}

clone_in_place!(MountedTire {
    name,
    parameters,
    tire,
    rim,
    state,
    force,
    moment,
    stationary_start,
    start_torque
});

impl MountedTire {
    /// Makes the tire from its parameters; the first thing in a model's `initialize`.
    ///
    /// # Errors
    /// Parameters that contradict each other.
    pub fn mount(&mut self) -> Result<()> {
        self.tire = Tire::new(&self.parameters)?;
        Ok(())
    }

    /// Takes over tuned parameters.
    ///
    /// # Errors
    /// Parameters that contradict each other.
    pub fn tune(&mut self) -> Result<()> {
        self.tire.tune(&self.parameters)
    }

    /// How much work a step is, as [`Model::step_work`](crate::model::Model::step_work) counts it: all bristles are
    /// looked at in every step, whether or not they are in contact.
    pub fn step_work(&self) -> f64 {
        SMALL_STEP + f64::from(self.parameters.stripes) * f64::from(self.parameters.bristles_per_stripe)
    }

    /// Checks a value that was read from bytes.
    ///
    /// # Errors
    /// Its parts do not fit each other.
    pub fn check(&self) -> Result<()> {
        self.tire.check(&self.state)
    }

    /// What the user should know about the start.
    pub fn warning(&self) -> Option<String> {
        if self.start_torque != 0.0 {
            return Some(format!(
                "no spin was found at which the wheel starts free of torque: the friction of the road is too low for the rolling resistance; it starts at the speed of rolling, with {:.3} N.m about its axis",
                self.start_torque
            ));
        }
        (!self.stationary_start).then(|| {
            "no stationary state was found for the start; the tire starts rolling straight and free".into()
        })
    }

    /// Puts the tire into the stationary state of a rim that keeps moving as `rim` does on the plane
    /// below it; where there is none, into straight free rolling.
    ///
    /// # Errors
    /// Not even free rolling is possible there.
    pub fn start(&mut self, rim: &Motion<f64>, ground: &impl Ground) -> Result<()> {
        self.rim = *rim;
        self.start_torque = 0.0;
        let (plane, on_plane) = self.on_plane(ground);
        let found = self.stationary(ground);
        self.stationary_start = found.is_ok();
        let stationary = found.or_else(|_| {
            let free = free_rolling(&on_plane, &self.parameters);
            stationary(&self.tire, &free, Vertical::Height(plane.clearance), plane.friction)
        })?;
        self.state = stationary.state(&self.tire, &on_plane)?;

        // from the plane's frame, where the road is flat, to frame 0
        let from_rim = self.state.belt.position - Vector3::new(0.0, 0.0, plane.clearance);
        if plane.slope != [0.0; 2] {
            self.state.belt = self.state.belt.turned(&plane.rotation());
        }
        self.state.belt.position = Vector3::new(0.0, 0.0, rim.position.z) + plane.rotation() * from_rim;
        let balanced = self.state.acceleration;
        self.tire.step(&mut self.state, rim, rim, ground, 0.0)?;
        self.state.acceleration = balanced;
        // what the bristles' sums ripple around, and what has derivatives
        self.state.patch.power_loss = stationary.power_loss;
        self.state.patch.force = stationary.patch.force;
        self.state.patch.moment = stationary.patch.moment;
        self.measure();
        Ok(())
    }

    /// [`start`](Self::start) free of torque, at the height at which the tire carries `load` \[N\], the
    /// force on the rim along the road's normal. Height and spin rate of `rim` do not matter; those found
    /// are in the field `rim` afterwards. Where the road's friction cannot turn the wheel against its
    /// rolling resistance, it starts at the speed of rolling and is not free of torque: the field
    /// `start_torque` says how much, and `stationary_start` is false.
    ///
    /// # Errors
    /// As [`start`](Self::start).
    pub fn start_rolling(&mut self, rim: &Motion<f64>, ground: &impl Ground, load: f64) -> Result<()> {
        let (sin, cos) = libm::sincos(rim.angles.z);
        let speed = rim.velocity.x * cos + rim.velocity.y * sin;
        self.rim = *rim;
        self.rim.rates.y = speed / self.parameters.rolling_radius;
        let (plane, on_plane) = self.on_plane(ground);
        let at_load = |rim: &Motion<f64>| stationary(&self.tire, rim, Vertical::Load(load), plane.friction);
        let carried = at_load(&on_plane)?;
        self.rim.position.z += carried.rim_height - plane.clearance;

        // rolling resistance makes the spin a little slower; the moment is nearly linear in it
        let moment = |spin: f64| {
            let mut slower = on_plane;
            slower.rates.y = spin;
            let found = at_load(&slower)?;
            let (sin, cos) = libm::sincos(slower.angles.x);
            let about = to_heading(slower.angles.z, &found.on_rim.moment);
            Ok::<f64, crate::Error>(about.y * cos + about.z * sin)
        };
        let free = on_plane.rates.y;
        let at_free = moment(free)?;
        let enough = START_TORQUE * load.abs() * self.parameters.rolling_radius;
        let reach = MAX_START_SLIP * free.abs();
        let mut best = (free, at_free);
        if reach > 0.0 {
            // secants, kept within the spins between which the moment changes its sign; it falls with the spin
            let (mut low, mut high) = if at_free > 0.0 { (free, free + reach) } else { (free - reach, free) };
            let end = if at_free > 0.0 { high } else { low };
            let mut turns = false;
            let (mut last, mut next) = (best, free + (1e-4 * free).abs().copysign(at_free));
            for _ in 0..MAX_START_STEPS {
                if best.1.abs() <= enough {
                    break;
                }
                let Ok(now) = moment(next) else { break };
                turns |= now * at_free < 0.0;
                if next == end && !turns {
                    break;
                }
                if now > 0.0 {
                    low = next
                } else {
                    high = next
                }
                let secant = next - now * (next - last.0) / (now - last.1);
                last = (next, now);
                if now.abs() < best.1.abs() {
                    best = last;
                }
                next = match low < secant && secant < high {
                    true => secant,
                    false if turns => 0.5 * (low + high),
                    false => end,
                };
            }
        }
        let balanced = reach == 0.0 || best.1.abs() <= enough;
        self.rim.rates.y += if balanced { best.0 - free } else { 0.0 };
        let rim = self.rim;
        self.start(&rim, ground)?;
        self.start_torque = if balanced { 0.0 } else { at_free };
        self.stationary_start &= balanced;
        Ok(())
    }

    /// The plane under the rim, taken to stand still, and the rim's motion against it.
    fn on_plane(&self, ground: &impl Ground) -> (Plane, Motion<f64>) {
        let plane = Plane { slope_rate: [0.0; 2], ..ground.under(&self.rim, 0.0) };
        let on_plane = plane.relative(&self.rim);
        (plane, on_plane)
    }

    /// The stationary state of the rim's present motion on the plane below it, seen from that plane.
    ///
    /// # Errors
    /// There is none.
    pub fn stationary(&self, ground: &impl Ground) -> Result<Stationary> {
        let (plane, on_plane) = self.on_plane(ground);
        stationary(&self.tire, &on_plane, Vertical::Height(plane.clearance), plane.friction)
    }

    /// The stationary state on a level plane for the rim's present motion with, instead of its height, a
    /// vertical force \[N\] on the rim.
    ///
    /// # Errors
    /// None was found.
    pub fn stationary_at_load(&self, rim: &Motion<f64>, load: f64, friction: f64) -> Result<Stationary> {
        stationary(&self.tire, rim, Vertical::Load(load), friction)
    }

    /// Advances the tire while the rim moves to `rim`, over `ground`.
    ///
    /// # Errors
    /// As [`Tire::step`].
    pub fn step(&mut self, rim: &Motion<f64>, ground: &impl Ground, dt: f64) -> Result<()> {
        let before = std::mem::replace(&mut self.rim, *rim);
        self.tire.step(&mut self.state, &before, rim, ground, dt)?;
        self.measure();
        Ok(())
    }

    /// The side wall between rim and belt in the plane of the wheel.
    pub(super) fn radial(&self) -> Link {
        let p = &self.parameters;
        Link {
            stiffness: ("sidewall_radial_stiffness", p.sidewall_radial_stiffness),
            damping: ("sidewall_radial_damping", p.sidewall_radial_damping),
            mass: ("belt_mass", p.belt_mass),
        }
    }

    /// The same along the wheel's axis.
    pub(super) fn lateral(&self) -> Link {
        let p = &self.parameters;
        Link {
            stiffness: ("sidewall_lateral_stiffness", p.sidewall_lateral_stiffness),
            damping: ("sidewall_lateral_damping", p.sidewall_lateral_damping),
            mass: ("belt_mass", p.belt_mass),
        }
    }

    /// The same about the wheel's axis.
    pub(super) fn windup(&self) -> Link {
        let p = &self.parameters;
        Link {
            stiffness: ("sidewall_windup_stiffness", p.sidewall_windup_stiffness),
            damping: ("sidewall_windup_damping", p.sidewall_windup_damping),
            mass: ("belt_inertia_polar", p.belt_inertia_polar),
        }
    }

    fn measure(&mut self) {
        self.force = to_heading(self.rim.angles.z, &self.state.on_rim.force);
        self.moment = to_heading(self.rim.angles.z, &self.state.on_rim.moment);
    }

    /// Moment of the tire on the rim about the wheel's own axis \[N.m\].
    pub fn spin_moment(&self) -> f64 {
        let (sin, cos) = libm::sincos(self.rim.angles.x);
        self.moment.y * cos + self.moment.z * sin
    }

    /// Belt centre from wheel centre in H axes \[m\].
    pub fn belt_offset(&self) -> Vector3<f64> {
        to_heading(self.rim.angles.z, &(self.state.belt.position - self.rim.position))
    }

    /// Length of the stripe at a share of the way from left to right \[m\].
    pub fn contact_length(&self, share: f64) -> f64 {
        self.state.bristles.lengths.get(self.stripe(share)).copied().unwrap_or(0.0)
    }

    /// Number of the stripe at a share of the way from left to right.
    pub fn stripe(&self, share: f64) -> usize {
        (share * (f64::from(self.parameters.stripes) - 1.0)).max(0.0) as usize
    }
}

/// Turns frame 0 into H axes of a steer angle: x horizontal in the wheel's heading, z up (4.37).
pub fn to_heading<T: crate::solver::Real>(steer: T, v: &Vector3<T>) -> Vector3<T> {
    let (sin, cos) = steer.sin_cos();
    Vector3::new(cos * v.x + sin * v.y, cos * v.y - sin * v.x, v.z)
}

/// The rim rolling straight and without slip at the speed that it has in its heading.
fn free_rolling(rim: &Motion<f64>, p: &Parameters) -> Motion<f64> {
    let (sin, cos) = libm::sincos(rim.angles.z);
    let speed = rim.velocity.x * cos + rim.velocity.y * sin;
    let mut free = *rim;
    free.velocity = Vector3::new(speed * cos, speed * sin, 0.0);
    free.angles.x = 0.0;
    free.rates = Vector3::new(0.0, speed / p.rolling_radius, 0.0);
    free
}
