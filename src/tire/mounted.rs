//! A tire on a rim whose motion somebody else decides: a rig's imposed motion, a hub, a master.

use super::{Change, Ground, Motion, Plane, Rest, Tire, Vertical, Wrench};
use crate::model::{Purpose, Role, Table, boolean_parameter, local, output};
use crate::solver::{Dual, Real};
use crate::{Error, Result, boolean, clone_in_place, lens, real};
use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

/// The slip at which a free wheel starts is looked for up to here. It is a few thousandths; beyond, the
/// moment of the tire no longer depends on it and tells nothing about where it vanishes.
const MAX_START_SLIP: f64 = 0.05;
/// A wheel whose moment is less than this share of load times radius starts free of torque.
const START_TORQUE: f64 = 1e-7;
/// Steps of the search for that: secants take a few; so many halvings of the range get as far.
const MAX_START_STEPS: usize = 30;

/// What a start found.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub enum Start {
    /// The stationary state of the rim's motion.
    #[default]
    Stationary,
    /// None: the tire rolls straight and free, which is another motion than the rim's.
    Rolling,
    /// A free wheel that cannot be free of torque, because friction cannot turn it against its rolling resistance:
    /// it rolls with this torque about its axis \[N.m\].
    Dragged(f64),
}

/// A tire with its rim and what is measured between them.
#[derive(Debug, PartialEq, Default, Serialize, Deserialize)]
pub struct Mounted<T> {
    /// The tire.
    pub tire: T,
    /// The rim. Seen from the point below its centre: x and y of its position are 0.
    pub rim: Motion<f64>,
    /// Force of the tire on the rim in H axes \[N\].
    pub force: Vector3<f64>,
    /// Moment of the tire on the rim in H axes, about the wheel's centre \[N.m\].
    pub moment: Vector3<f64>,
    /// What the start found.
    pub start: Start,
    /// A start that finds no stationary state is an error.
    pub only_stationary: bool,
}

clone_in_place!(Mounted<T> { tire, rim, force, moment, start, only_stationary });

impl<T: Tire> Mounted<T> {
    /// Force and moment on the rim, what the start found, and the tire's own rows.
    pub fn rows() -> Table<Self> {
        Table::new([
            output("force_x", "N", real!(force.x), "Longitudinal force of the tire on the rim, H axes").nominal(1000.0).role(Role::LongitudinalForce),
            output("force_y", "N", real!(force.y), "Lateral force of the tire on the rim, H axes").nominal(1000.0).role(Role::LateralForce),
            output("force_z", "N", real!(force.z), "Vertical force of the tire on the rim, H axes: the normal force on the road less the weight of the belt").nominal(1000.0).role(Role::Load),
            output("moment_x", "N.m", real!(moment.x), "Overturning moment of the tire on the rim about the wheel centre, H axes").nominal(100.0),
            output("moment_y", "N.m", real!(moment.y), "Moment about the lateral axis of the tire on the rim, H axes").nominal(100.0).role(Role::LongitudinalForce),
            output("moment_z", "N.m", real!(moment.z), "Aligning moment of the tire on the rim, H axes").nominal(100.0).role(Role::AligningMoment),
        ])
        .part("", lens!(tire), T::rows())
        .and([
            local("stationary_start", "", crate::model::Access::computed_boolean(|m: &Self| m.start == Start::Stationary), "The start is a stationary state; false: none was found for the start inputs, and the tire starts rolling straight and free, or the friction of the road cannot turn a free wheel against its rolling resistance"),
            boolean_parameter("only_stationary_start", boolean!(only_stationary), false, "What happens where there is no stationary state for the start inputs: false, the tire starts rolling straight and free, and a warning says so; true, the start fails. An identification wants true: it would fit another motion than the recorded one").purpose(Purpose::Numerics),
        ])
    }

    /// What the user should know about the start.
    pub fn warning(&self) -> Option<String> {
        match self.start {
            Start::Stationary => None,
            Start::Rolling => Some(
                "no stationary state was found for the start; the tire starts rolling straight and free"
                    .into(),
            ),
            Start::Dragged(torque) => Some(format!(
                "no spin was found at which the wheel starts free of torque: the friction of the road is too low for the rolling resistance; it starts at the speed of rolling, with {torque:.3} N.m about its axis"
            )),
        }
    }

    /// Puts the tire into the stationary state of a rim that keeps moving as `rim` does on the plane
    /// below it; where there is none, into straight free rolling.
    ///
    /// # Errors
    /// Not even free rolling is possible there, or there is no stationary state and
    /// [`only_stationary`](Mounted::only_stationary) is set.
    pub fn start(&mut self, rim: &Motion<f64>, ground: &impl Ground) -> Result<()> {
        self.rim = *rim;
        let (plane, _) = self.on_plane(ground);
        self.start_held(Vertical::Height(plane.clearance), ground)
    }

    /// [`start`](Self::start) at the height at which the tire carries `load` \[N\], the force on the rim along the
    /// road's normal. The height of `rim` does not matter; the one found is in the field `rim` afterwards.
    ///
    /// # Errors
    /// As [`start`](Self::start).
    pub fn start_carrying(&mut self, rim: &Motion<f64>, ground: &impl Ground, load: f64) -> Result<()> {
        self.rim = *rim;
        self.start_held(Vertical::Load(load), ground)
    }

    /// The start of a rim that moves as the field `rim` says.
    fn start_held(&mut self, held: Vertical, ground: &impl Ground) -> Result<()> {
        let (mut plane, on_plane) = self.on_plane(ground);
        let found = self.tire.stationary(&on_plane, held, plane.friction);
        self.start = if found.is_ok() { Start::Stationary } else { Start::Rolling };
        let rest = match found {
            Err(error) if self.only_stationary => return Err(self.refused(&error.to_string())),
            Err(_) => {
                let deflection = self.tire.radius() - plane.clearance;
                let free = free_rolling(&on_plane, self.tire.rolling_radius(deflection));
                self.tire.stationary(&free, held, plane.friction)?
            }
            Ok(rest) => rest,
        };
        if let Vertical::Load(_) = held {
            self.rim.position.z += rest.rim_height - plane.clearance;
            (plane, _) = self.on_plane(ground);
        }
        let rim = self.rim;
        self.tire.begin(&rest, &rim, &plane, ground)?;
        self.measure();
        Ok(())
    }

    fn refused(&self, why: &str) -> Error {
        Error::numeric(format!(
            "{why}; with only_stationary_start the start is then refused: change the start inputs, or set it to false to start from free rolling"
        ))
    }

    /// [`start`](Self::start) free of torque, at the height at which the tire carries `load` \[N\], the
    /// force on the rim along the road's normal. Height and spin rate of `rim` do not matter; those found
    /// are in the field `rim` afterwards. Where the road's friction cannot turn the wheel against its
    /// rolling resistance, it starts at the speed of rolling and is not free of torque
    /// ([`Start::Dragged`]).
    ///
    /// # Errors
    /// As [`start`](Self::start).
    pub fn start_rolling(&mut self, rim: &Motion<f64>, ground: &impl Ground, load: f64) -> Result<()> {
        let (sin, cos) = libm::sincos(rim.angles.z);
        let speed = rim.velocity.x * cos + rim.velocity.y * sin;
        self.rim = *rim;
        self.rim.rates.y = speed / self.tire.rolling_radius(0.0);
        let (plane, on_plane) = self.on_plane(ground);
        let at_load = Vertical::Load(load);
        let mut carried = self.tire.stationary(&on_plane, at_load, plane.friction)?;
        let rolling_radius = self.tire.rolling_radius(self.tire.radius() - carried.rim_height);
        self.rim.rates.y = speed / rolling_radius;
        let (_, on_plane) = self.on_plane(ground);
        self.rim.position.z += carried.rim_height - plane.clearance;

        // rolling resistance makes the spin a little slower; the moment is nearly linear in it
        let mut moment = |spin: f64| {
            let mut slower = on_plane;
            slower.rates.y = spin;
            carried = self.tire.stationary_near(&carried, &slower, at_load, plane.friction)?;
            let (sin, cos) = libm::sincos(slower.angles.x);
            let about = to_heading(slower.angles.z, &carried.on_rim.moment);
            Ok::<f64, crate::Error>(about.y * cos + about.z * sin)
        };
        let free = on_plane.rates.y;
        let at_free = moment(free)?;
        let enough = START_TORQUE * load.abs() * rolling_radius;
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
        if !balanced {
            self.start = Start::Dragged(at_free);
            if self.only_stationary {
                return Err(self.refused(&self.warning().unwrap_or_default()));
            }
        }
        Ok(())
    }

    /// The plane under the rim, taken to stand still, and the rim's motion against it.
    fn on_plane(&self, ground: &impl Ground) -> (Plane, Motion<f64>) {
        let under = ground.plane(&self.rim, self.tire.window(), 0.0);
        let plane = Plane { slope_rate: [0.0; 2], ..under };
        let on_plane = plane.relative(&self.rim);
        (plane, on_plane)
    }

    /// The stationary state of the rim's present motion on the plane below it, seen from that plane.
    ///
    /// # Errors
    /// There is none.
    pub fn stationary(&self, ground: &impl Ground) -> Result<Rest<T::Inside>> {
        let (plane, on_plane) = self.on_plane(ground);
        self.tire.stationary(&on_plane, Vertical::Height(plane.clearance), plane.friction)
    }

    /// How force, moment and the tire's own outputs change before the first step, where the whole stationary state
    /// moves with the rim and with the friction, which carry their derivatives.
    ///
    /// # Errors
    /// The start is on a slope, or there is no derivative.
    pub fn stationary_change(
        &self,
        ground: &impl Ground,
        rim: &Motion<Dual<1>>,
        friction: Dual<1>,
    ) -> Result<Change> {
        let plane = ground.plane(&self.rim, self.tire.window(), 0.0);
        if plane.slope != [0.0; 2] {
            return Err(Error::call("the start is on a slope: there are derivatives on level road only"));
        }
        // the tire sees its height over the road
        let mut rim = *rim;
        rim.position.z -= Dual::from(self.rim.position.z - plane.clearance);
        self.tire.stationary_change(&self.stationary(ground)?, &rim, friction)
    }

    /// Advances the tire while the rim moves to `rim`, over `ground`.
    ///
    /// # Errors
    /// As [`Tire::step`].
    pub fn step(&mut self, rim: &Motion<f64>, ground: &impl Ground, dt: f64) -> Result<()> {
        let before = std::mem::replace(&mut self.rim, *rim);
        self.tire.step(&before, rim, ground, dt)?;
        self.measure();
        Ok(())
    }

    fn measure(&mut self) {
        let Wrench { force, moment } = self.tire.on_rim();
        let heading = libm::sincos(self.rim.angles.z);
        self.force = along_heading(heading, &force);
        self.moment = along_heading(heading, &moment);
    }

    /// Moment of the tire on the rim about the wheel's own axis \[N.m\].
    pub fn spin_moment(&self) -> f64 {
        let (sin, cos) = libm::sincos(self.rim.angles.x);
        self.moment.y * cos + self.moment.z * sin
    }
}

/// Turns frame 0 into H axes of a steer angle: x horizontal in the wheel's heading, z up (4.37).
pub fn to_heading<T: Real>(steer: T, v: &Vector3<T>) -> Vector3<T> {
    along_heading(steer.sin_cos(), v)
}

/// A vector along, to the left of and normal to a heading in the plane of x and y, of which sine and cosine are given.
pub(super) fn along_heading<T: Real>((sin, cos): (T, T), v: &Vector3<T>) -> Vector3<T> {
    Vector3::new(cos * v.x + sin * v.y, cos * v.y - sin * v.x, v.z)
}

/// The rim rolling straight and without slip at the speed that it has in its heading.
fn free_rolling(rim: &Motion<f64>, rolling_radius: f64) -> Motion<f64> {
    let (sin, cos) = libm::sincos(rim.angles.z);
    let speed = rim.velocity.x * cos + rim.velocity.y * sin;
    let mut free = *rim;
    free.velocity = Vector3::new(speed * cos, speed * sin, 0.0);
    free.angles.x = 0.0;
    free.rates = Vector3::new(0.0, speed / rolling_radius, 0.0);
    free
}
