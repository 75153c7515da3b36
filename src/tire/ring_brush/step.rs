//! The tire in time: one step of belt and patch.

use super::patch::{Moments, Pressure, PressureState, Shape};
use super::sidewall::{Coupling, coupling};
use super::{
    Bristles, Contact, Deformation, Limits, Loads, Parameters, State, Tops, advance, moment_y, patch_on_belt,
};
use crate::mechanics::{Motion, Wrench, drift, kick};
use crate::road::{Road, Window};
use crate::tire::Ground;
use crate::{Error, Result, clone_in_place};
use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

/// Beyond this camber of the belt \[rad\] the Cardan angles come too near to their singularity.
const MAX_CAMBER: f64 = 1.3;
/// Time constant \[s\] of the mean that [`PatchReport::power_loss`](super::PatchReport) is. Bristles follow
/// each other in a spacing, 1.4 ms at 10 m/s; what heats up takes seconds.
pub const LOSS_TIME: f64 = 0.01;

/// A tire with checked parameters and what follows from them.
#[derive(Debug, PartialEq, Default, Serialize, Deserialize)]
pub struct Prepared {
    parameters: Parameters,
    /// Lateral places of the stripes \[m\].
    places: Vec<f64>,
    /// Radii of the belt shell above the stripes \[m\].
    radii: Vec<f64>,
    /// The length over which the contact bridges the road.
    window: Window,
}

clone_in_place!(Prepared { parameters, places, radii, window });

impl Prepared {
    /// A tire with these parameters on this road.
    ///
    /// # Errors
    /// Parameters that contradict each other, or the road.
    pub fn new(parameters: &Parameters, road: &Road) -> Result<Self> {
        parameters.check()?;
        let stripes = 0..parameters.stripes as usize;
        Ok(Self {
            places: stripes.clone().map(|i| parameters.stripe_position(i)).collect(),
            radii: stripes.map(|i| parameters.stripe_radius(i)).collect(),
            parameters: parameters.clone(),
            window: road.window(parameters.filter_length)?,
        })
    }

    /// Changes parameters that neither the stripes' places and radii nor the bristles' number depend on.
    ///
    /// # Errors
    /// Parameters that contradict each other.
    pub fn tune(&mut self, parameters: &Parameters) -> Result<()> {
        parameters.check()?;
        self.parameters.clone_from(parameters);
        Ok(())
    }

    /// Checks a tire and its state that were read from bytes: there is a value for each stripe and
    /// each bristle.
    ///
    /// # Errors
    /// There is not.
    pub fn check(&self, state: &State, road: &Road) -> Result<()> {
        self.window.check(road)?;
        let count = |number: i32| usize::try_from(number).unwrap_or(usize::MAX);
        let (stripes, n) = (count(self.parameters.stripes), count(self.parameters.bristles_per_stripe));
        let Bristles { x, laps, lengths, deflection_x, deflection_y, pressure, stick } = &state.bristles;
        let vectors = [
            (self.places.len(), stripes),
            (self.radii.len(), stripes),
            (x.len(), n),
            (laps.len(), n),
            (lengths.len(), stripes),
            (deflection_x.len(), stripes.saturating_mul(n)),
            (deflection_y.len(), stripes.saturating_mul(n)),
            (pressure.len(), stripes.saturating_mul(n)),
            (stick.len(), stripes.saturating_mul(n)),
        ];
        if vectors.iter().all(|(length, expected)| length == expected) {
            Ok(())
        } else {
            Err(Error::call("the tire's stripes and bristles do not fit its parameters"))
        }
    }

    /// The parameters.
    pub fn parameters(&self) -> &Parameters {
        &self.parameters
    }

    /// The length over which the contact bridges the road.
    pub fn window(&self) -> &Window {
        &self.window
    }

    /// Lateral places of the stripes, from the largest +y \[m\] (4.16).
    pub fn stripe_places(&self) -> &[f64] {
        &self.places
    }

    /// Radii of the belt shell above the stripes \[m\] (4.19).
    pub fn stripe_radii(&self) -> &[f64] {
        &self.radii
    }

    /// Advances the tire by `dt` seconds while the rim moves from `before` to `after` over `ground`.
    ///
    /// Velocity Verlet: half a kick, drift, forces at the new place, half a kick. The patch is
    /// evaluated once: bristles move with the velocity at mid-step and carry their force at the end.
    /// Second order but for bristles that slide, whose turning backward Euler follows with the first,
    /// the instants at which bristles change between sticking and sliding, and jumps of the rim's
    /// velocity. With `dt` = 0 the state is evaluated where it is: forces and accelerations are brought
    /// up to date.
    ///
    /// # Errors
    /// A state outside the model's validity: the belt falls over, the patch gets longer than the ring
    /// of bristles, or numbers are not finite.
    pub fn step(
        &self,
        state: &mut State,
        before: &Motion<f64>,
        after: &Motion<f64>,
        ground: &impl Ground,
        dt: f64,
    ) -> Result<()> {
        let p = &self.parameters;
        let half = 0.5 * dt;

        // belt: half a kick, drift; at the end with predicted velocities for the dampers
        let start = state.belt;
        let [linear, angular] = state.acceleration;
        let (moving, turning) = (drift(start.velocity, linear, dt), drift(start.rates, angular, dt));
        let mut travel = moving.travel;
        travel.x -= half * (before.velocity.x + after.velocity.x);
        travel.y -= half * (before.velocity.y + after.velocity.y);
        let middle = Motion {
            position: start.position + travel * 0.5,
            velocity: moving.velocity,
            angles: start.angles + turning.travel * 0.5,
            rates: turning.velocity,
        };
        let mut end = Motion {
            position: start.position + travel,
            velocity: moving.predicted,
            angles: start.angles + turning.travel,
            rates: turning.predicted,
        };
        let plane = ground.plane(&end, &self.window, 1.0);
        let on_plane = plane.relative(&end);
        check_belt(&end)?;
        check_belt(&on_plane)?;

        // patch: contact, pressure, bristles; seen from the plane under the belt the road is flat
        let contact = Contact::new(p, &on_plane);
        let old_spin = ground.plane(&start, &self.window, 0.0).relative(&start).angles.y;
        let on_middle_plane = ground.plane(&middle, &self.window, 0.5).relative(&middle);
        let lag_rates = ahead(&state.lag_rates, &state.lag_accelerations, half);
        let lagged_middle = ahead(&state.lagged, &lag_rates, half);
        let lagged_end = ahead(&state.lagged, &lag_rates, dt);
        let middle_contact = Contact::new(p, &on_middle_plane);
        let tops = Tops::new(p, &middle_contact, on_middle_plane.rates.y, &lagged_middle, &lag_rates);
        let old_loads = state.loads;
        self.advance_patch(
            state,
            &contact,
            &tops,
            &lagged_end,
            (old_spin, on_plane.angles.y),
            on_plane.rates.y,
            plane.friction,
            dt,
        )?;

        // lag of the patch's deformation (4.27), by the trapezoidal rule
        let lags = [p.patch_lag_x, p.patch_lag_y, p.patch_lag_twist];
        let relax = |lagged: f64, old: f64, new: f64, lag: f64| {
            let lagged = (lagged * (lag - half) + half * (old + new)) / (lag + half);
            (lagged, (new - lagged) / lag)
        };
        let (lagged, loads) = (state.lagged, state.loads);
        let (force_x, rate_x) = relax(lagged.force_x, old_loads.force_x, loads.force_x, lags[0]);
        let (force_y, rate_y) = relax(lagged.force_y, old_loads.force_y, loads.force_y, lags[1]);
        let (moment_z, rate_z) = relax(lagged.moment_z, old_loads.moment_z, loads.moment_z, lags[2]);
        state.lagged = Loads { force_x, force_y, moment_z };
        let old_rates = state.lag_rates;
        state.lag_rates = Loads { force_x: rate_x, force_y: rate_y, moment_z: rate_z };
        if dt > 0.0 {
            let change = ahead(&state.lag_rates, &old_rates, -1.0);
            state.lag_accelerations = ahead(&Loads::default(), &change, 1.0 / dt);
        }

        // side wall and belt: the second half of the kick
        let patch: Wrench<f64> = patch_on_belt(&contact, &state.patch.force, &state.patch.moment);
        let side: Coupling<f64> = coupling(p, after, &end);
        let to_road = plane.rotation();
        let sum = Wrench {
            force: side.on_belt.force + to_road * patch.force,
            moment: side.on_belt.moment + to_road * patch.moment,
        };
        let (linear, angular) = p.belt().acceleration(&end, &sum, p.gravity);
        end.velocity = kick(moving.velocity, linear, dt);
        end.rates = kick(turning.velocity, angular, dt);
        state.acceleration = [linear, angular];
        state.belt = end;
        state.on_rim = side.on_rim;

        let finite = [linear, angular, side.on_rim.force, side.on_rim.moment];
        if finite.iter().all(|v| v.iter().all(|x| x.is_finite())) {
            Ok(())
        } else {
            Err(Error::numeric("the tire's forces are no longer finite; a smaller step_size may help"))
        }
    }

    /// Moves the bristles through the patch, spreads the normal force over them and sums up their
    /// forces (4.17)-(4.34).
    #[allow(clippy::too_many_arguments)] // the patch sits in the middle of everything
    fn advance_patch(
        &self,
        state: &mut State,
        contact: &Contact<f64>,
        tops: &Tops<f64>,
        lagged: &Loads<f64>,
        (old_spin, new_spin): (f64, f64),
        spin_rate: f64,
        friction: f64,
        dt: f64,
    ) -> Result<()> {
        let p = &self.parameters;
        let deformation = Deformation::new(p, lagged);
        let shape = Shape::new(p, contact.penetration);
        let bristles = &mut state.bristles;
        let n = bristles.x.len();
        let area = p.cell_area();

        // bristles at one end of the ring go to the other, relaxed
        wind(p, bristles, new_spin);
        let shift = p.rolling_radius * (new_spin - old_spin);

        // first pass: stripes and the shape of the pressure
        let mut sums = Moments { s0: 0.0, s1: 0.0, s2: 0.0 };
        let mut longest: f64 = 0.0;
        for (i, (y, radius)) in self.places.iter().zip(&self.radii).enumerate() {
            let length = contact.stripe_length(p, *y, *radius);
            if length > p.ring_length() {
                return Err(Error::numeric(format!(
                    "the contact patch is {length:.3} m long, the ring of bristles only {:.3} m: more or longer bristles are needed for this deflection",
                    p.ring_length()
                )));
            }
            longest = longest.max(length);
            let cells = &mut bristles.pressure[i * n..][..n];
            if length <= 0.0 {
                cells.fill(0.0);
                continue;
            }
            let factor = shape.stripe(*y, length);
            for (cell, x) in cells.iter_mut().zip(&bristles.x) {
                *cell = if x.abs() <= 0.5 * length { shape.along(*x, length) * factor } else { 0.0 };
                sums.s0 += *cell;
                sums.s1 += x * *cell;
                sums.s2 += x * x * *cell;
            }
        }

        let moment = moment_y(p, contact, spin_rate, lagged.force_x);
        let pressure = Pressure::new(
            p,
            &sums,
            contact.normal_force,
            moment + deformation.shift_x * contact.normal_force,
            longest,
        );

        // second pass: bristles
        let mut force = Vector3::new(0.0, 0.0, contact.normal_force);
        let mut torque = Vector3::new(0.0, moment, 0.0);
        let (mut touching, mut sliding) = (0_u32, 0_u32);
        let (mut power, mut slip, mut negative, mut highest) = (0.0, 0.0, 0.0, 0.0_f64);
        // what went into the bristles and is not in their springs is lost
        let (mut work, mut stored) = (0.0, 0.0);
        let square = |[x, y]: [f64; 2]| x * x + y * y;
        for (i, (y, radius)) in self.places.iter().zip(&self.radii).enumerate() {
            let length = contact.stripe_length(p, *y, *radius);
            let old_length = std::mem::replace(&mut bristles.lengths[i], length);
            for (j, &x) in bristles.x.iter().enumerate() {
                let k = i * n + j;
                let cell_pressure = pressure.at(x, bristles.pressure[k]);
                bristles.pressure[k] = cell_pressure;
                let old = [bristles.deflection_x[k], bristles.deflection_y[k]];
                stored -= square(old);
                if cell_pressure == 0.0 {
                    // out of contact: no force, the deflection dies away (F = 0 in the bristle's law)
                    let decay = p.bristle_damping / (p.bristle_damping + p.bristle_stiffness * dt);
                    let new = old.map(|x| x * decay);
                    stored += square(new);
                    [bristles.deflection_x[k], bristles.deflection_y[k]] = new;
                    bristles.stick[k] = false;
                    continue;
                }
                let normal = area * cell_pressure;
                let limits = Limits::new(p, cell_pressure, friction * normal);

                // a bristle that came into contact within the step is loaded for the rest of it only
                let inside = 0.5 * length - x.abs();
                let inside_before = 0.5 * old_length - (x + shift).abs();
                let enters = inside > 0.0 && inside_before < 0.0 && !p.whole_step_entry;
                let loaded = if enters { inside / (inside - inside_before) } else { 1.0 };
                let middle = x + 0.5 * shift * loaded;
                let velocity = tops.velocity(middle, *y);
                let step = advance(p, old, velocity, bristles.stick[k], &limits, dt * loaded);
                [bristles.deflection_x[k], bristles.deflection_y[k]] = step.deflection;
                bristles.stick[k] = step.stick;
                stored += square(step.deflection);
                work += loaded * tops.power(middle, *y, step.force);

                let [place_x, place_y] = deformation.place(x, *y);
                let [force_x, force_y] = step.force;
                force.x += force_x;
                force.y += force_y;
                torque.x += place_y * normal;
                torque.z += place_x * force_y - place_y * force_x;
                touching += 1;
                highest = highest.max(cell_pressure);
                negative += (-normal).max(0.0);
                if !step.stick {
                    sliding += 1;
                    power += libm::hypot(force_x, force_y) * step.slip_speed;
                    slip += normal.max(0.0) * step.slip_speed;
                }
            }
        }

        state.loads = Loads { force_x: force.x, force_y: force.y, moment_z: torque.z };
        let patch = &mut state.patch;
        patch.penetration = contact.penetration;
        patch.force = force;
        patch.moment = torque;
        patch.shift = [deformation.shift_x, deformation.shift_y];
        patch.twist = deformation.twist;
        patch.pressure_max = highest;
        patch.negative_share = if negative > 0.0 { negative / contact.normal_force } else { 0.0 };
        patch.pressure_state = match pressure.state {
            // the ends of the stripe need not carry a bristle
            PressureState::Negative if negative == 0.0 => PressureState::Regular,
            other => other,
        };
        patch.sliding_share = if touching > 0 { f64::from(sliding) / f64::from(touching) } else { 0.0 };
        patch.friction_power = power;
        if dt > 0.0 {
            work += tops.camber_power(torque.z);
            let lost = dt * work - 0.5 * p.bristle_stiffness * stored;
            state.energy_loss += lost;
            patch.power_loss += (lost - dt * patch.power_loss) / (LOSS_TIME + dt);
        }
        if negative + contact.normal_force > 0.0 {
            state.sliding_distance += dt * slip / (negative + contact.normal_force);
        }
        Ok(())
    }
}

/// Places the bristles for a spin angle (4.17) and relaxes those that change ends.
pub(super) fn wind(p: &Parameters, bristles: &mut Bristles, spin: f64) {
    let (cell, ring) = (p.bristle_length, p.ring_length());
    let n = bristles.x.len();
    for j in 0..n {
        let unwound = -(j as f64 + 1.0) * cell - p.rolling_radius * spin;
        let lap = (unwound / ring).floor();
        bristles.x[j] = unwound - lap * ring - 0.5 * ring;
        if std::mem::replace(&mut bristles.laps[j], lap) != lap {
            for k in (j..bristles.stick.len()).step_by(n) {
                bristles.deflection_x[k] = 0.0;
                bristles.deflection_y[k] = 0.0;
                bristles.stick[k] = false;
            }
        }
    }
}

fn ahead(loads: &Loads<f64>, rates: &Loads<f64>, dt: f64) -> Loads<f64> {
    Loads {
        force_x: loads.force_x + dt * rates.force_x,
        force_y: loads.force_y + dt * rates.force_y,
        moment_z: loads.moment_z + dt * rates.moment_z,
    }
}

fn check_belt(belt: &Motion<f64>) -> Result<()> {
    let camber = belt.angles.x;
    if camber.abs() < MAX_CAMBER {
        return Ok(());
    }
    Err(Error::numeric(format!(
        "the belt has fallen over: its camber of {camber:.3} rad is outside the model's validity of {MAX_CAMBER} rad"
    )))
}
