//! The tire in time: one step of belt and patch.

use super::bristles::MAX_PER_STRIPE;
use super::passage::Passage;
use super::patch::PressureState;
use super::sidewall::{Coupling, coupling};
use super::stripes::MAX_STRIPES;
use super::{Contact, Deformation, Lag, Loads, Parameters, State, Tops, moment_y, patch_on_belt};
use crate::mechanics::{Motion, Wrench, drift, kick};
use crate::road::{Road, Window};
use crate::solver::lanes::{LANES, level};
use crate::tire::Ground;
use crate::{Error, Result, clone_in_place};
use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

/// Beyond this camber of the belt \[rad\] the Cardan angles come too near to their singularity.
const MAX_CAMBER: f64 = 1.3;
/// Time constant \[s\] of the mean that [`PatchReport::power_loss`](super::PatchReport) is: about as long as a bristle is in
/// the contact at 10 m/s, which it leaves with what it has stored; what heats up takes seconds.
pub const LOSS_TIME: f64 = 0.01;

/// A tire with checked parameters and what follows from them.
#[derive(Debug, PartialEq, Default, Serialize, Deserialize)]
pub struct Prepared {
    parameters: Parameters,
    /// Lateral places of the stripes \[m\].
    places: Vec<f64>,
    /// Radii of the belt shell above the stripes \[m\].
    radii: Vec<f64>,
    /// The stripes in fours.
    pub(super) lanes: StripeLanes,
    /// The length over which the contact bridges the road.
    window: Window,
}

/// What does not change of the stripes, with as many more that are never used as makes it a multiple of four.
#[derive(Debug, PartialEq, Default, Serialize, Deserialize)]
pub(super) struct StripeLanes {
    /// Lateral places \[m\].
    pub places: Vec<f64>,
    /// Radii \[m\].
    pub radii: Vec<f64>,
    /// Logarithms to base 2 of the distances from the middle over half the width.
    pub sides: Vec<f64>,
}

clone_in_place!(StripeLanes { places, radii, sides });
clone_in_place!(Prepared { parameters, places, radii, lanes, window });

impl StripeLanes {
    fn new(p: &Parameters, places: &[f64], radii: &[f64]) -> Self {
        let filled = |values: &[f64], with: f64| {
            let mut filled = values.to_vec();
            filled.resize(values.len().next_multiple_of(LANES), with);
            filled
        };
        let sides: Vec<f64> = places.iter().map(|y| libm::log2((2.0 * y / p.width).abs())).collect();
        Self {
            places: filled(places, 0.0),
            radii: filled(radii, f64::MIN_POSITIVE),
            sides: filled(&sides, 0.0),
        }
    }

    fn fits(&self, stripes: usize) -> bool {
        let length = stripes.checked_next_multiple_of(LANES).unwrap_or(usize::MAX);
        [&self.places, &self.radii, &self.sides].iter().all(|values| values.len() == length)
    }
}

impl Prepared {
    /// A tire with these parameters on this road.
    ///
    /// # Errors
    /// Parameters that contradict each other, or the road.
    pub fn new(parameters: &Parameters, road: &Road) -> Result<Self> {
        parameters.check()?;
        check_size(parameters)?;
        let stripes = 0..parameters.stripes as usize;
        let places: Vec<f64> = stripes.clone().map(|i| parameters.stripe_position(i)).collect();
        let radii: Vec<f64> = stripes.map(|i| parameters.stripe_radius(i)).collect();
        Ok(Self {
            lanes: StripeLanes::new(parameters, &places, &radii),
            places,
            radii,
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
        check_size(&self.parameters)?;
        let stripes = usize::try_from(self.parameters.stripes).unwrap_or(usize::MAX);
        let is_whole = self.places.len() == stripes
            && self.radii.len() == stripes
            && self.lanes.fits(stripes)
            && state.bristles.fits(&self.parameters);
        if is_whole {
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
    /// Second order but for the instants at which bristles change between sticking and sliding, and
    /// jumps of the rim's velocity. With `dt` = 0 the state is evaluated where it is: forces and accelerations are brought
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
        let decay = Lag::decay(p, &self.places, state.bristles.lengths(), dt);
        let lag_rates = state.lag.means(&decay, dt);
        let lagged_middle = state.lag.ahead(&lag_rates, half);
        let lagged_end = state.lag.ahead(&lag_rates, dt);
        let middle_contact = Contact::new(p, &on_middle_plane);
        let tops = Tops::new(p, &middle_contact, on_middle_plane.rates.y, &lagged_middle, &lag_rates);
        let passage = Passage {
            contact: &contact,
            tops: &tops,
            deformation: &Deformation::new(p, &lagged_end),
            moment: moment_y(p, &contact, on_plane.rates.y, lagged_end.force_x),
            spin: on_plane.angles.y,
            shift: p.rolling_radius * (on_plane.angles.y - old_spin),
            friction: plane.friction,
            dt,
        };
        self.advance_patch(state, &passage)?;

        state.lag.follow(p, &state.loads, &lag_rates, &decay, dt);

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

    /// Moves the bristles through the patch, and takes over their sums (4.17)-(4.34).
    fn advance_patch(&self, state: &mut State, passage: &Passage<'_>) -> Result<()> {
        let p = &self.parameters;
        let Passage { contact, tops, deformation, dt, .. } = *passage;
        let stored = state.bristles.stored;
        let (sums, pressure) = self.pass(level(), &mut state.bristles, passage)?;
        let ([force_x, force_y], [moment_x, moment_z]) = (sums.force, sums.moment);
        state.loads = Loads { force_x, force_y, moment_z };
        let patch = &mut state.patch;
        patch.penetration = contact.penetration;
        patch.force = Vector3::new(force_x, force_y, contact.normal_force);
        patch.moment = Vector3::new(moment_x, passage.moment, moment_z);
        patch.shift = [deformation.shift_x, deformation.shift_y];
        patch.twist = deformation.twist;
        patch.pressure_max = sums.highest;
        patch.negative_share = if sums.negative > 0.0 { sums.negative / contact.normal_force } else { 0.0 };
        patch.pressure_state = match pressure.state {
            // the ends of the stripe need not carry a bristle
            PressureState::Negative if sums.negative == 0.0 => PressureState::Regular,
            other => other,
        };
        patch.sliding_share =
            if sums.touching > 0.0 { (sums.sliding / sums.touching).clamp(0.0, 1.0) } else { 0.0 };
        patch.friction_power = sums.power;
        if dt > 0.0 {
            // what went into the bristles and is not in their springs is lost
            let work = sums.work + tops.camber_power(moment_z);
            let lost = dt * work - 0.5 * p.bristle_stiffness * (state.bristles.stored - stored);
            state.energy_loss += lost;
            patch.power_loss += (lost - dt * patch.power_loss) / (LOSS_TIME + dt);
        }
        if sums.negative + contact.normal_force > 0.0 {
            state.sliding_distance += dt * sums.slip / (sums.negative + contact.normal_force);
        }
        Ok(())
    }
}

/// No tire has more stripes or bristles than there is room for.
fn check_size(p: &Parameters) -> Result<()> {
    let fits = |number: i32, most: usize| usize::try_from(number).is_ok_and(|n| n <= most);
    if fits(p.stripes, MAX_STRIPES) && fits(p.bristles_per_stripe, MAX_PER_STRIPE) {
        return Ok(());
    }
    Err(Error::variable(format!(
        "stripes = {} and bristles_per_stripe = {}: at most {MAX_STRIPES} and {MAX_PER_STRIPE} are possible",
        p.stripes, p.bristles_per_stripe
    )))
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tire::ring_brush::Bristles;

    /// A saved state can say anything, also what agrees with itself.
    #[test]
    fn more_bristles_than_there_is_room_for_are_refused() {
        for (stripes, bristles, fits) in
            [(1, 2000, true), (1, 2001, false), (1, 100_000, false), (-1, 30, false)]
        {
            let parameters = Parameters { stripes, bristles_per_stripe: bristles, ..Parameters::default() };
            let count = stripes.max(0) as usize;
            let mut bristles = Bristles::default();
            if stripes > 0 {
                bristles = Bristles::new(&parameters);
            }
            let lanes = StripeLanes::new(&parameters, &vec![0.0; count], &vec![0.3; count]);
            let tire = Prepared {
                parameters,
                places: vec![0.0; count],
                radii: vec![0.3; count],
                lanes,
                ..Prepared::default()
            };
            let state = State { bristles, ..State::default() };
            assert_eq!(tire.check(&state, &Road::default()).is_ok(), fits, "{stripes}");
        }
    }
}
