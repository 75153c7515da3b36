//! The state that a wheel stays in: elements where springs, weight, turning and the road balance, each as if it stood still there.
//!
//! As the wheel turns, elements come and go, and load or height ripple with N per turn: the state is that of the spin angle at which
//! the rim is. A wheel that turns under a load has the height at which it carries that load in the mean. An element's speed is how its place changes along the turn; its acceleration there is not looked for.

use super::coupling::{Coupled, Coupling, Place};
use super::element::{Ray, Track, Wanted, reach};
use super::parameters::{Parameters, Prepared};
use super::ring::{Coefficients, RimInPlane, Ring, Rubber, Sums, along};
use crate::{Error, Result, road};

/// A time so long that nothing moves at its end \[s\]: squared, it makes the mass of an element nothing beside its spring.
const LONG: f64 = 1e6;
/// Step of the spin angle for the speeds of elements \[rad\]: a thousandth of the angle between them.
const TURN: f64 = 1e-4;
/// Halvings of the height at most; the secants between them need ten.
const SEARCHES: usize = 80;
/// Sweeps over coupled elements, and the way in one of them that is none \[m\]: without their masses a sweep leaves more than in a step,
/// and speeds are differences over [`TURN`].
const MOST_SWEEPS: usize = 5_000;
const SETTLED: f64 = 1e-13;
/// Angles between two elements over which the force of a wheel that turns is a mean: elements touch and leave once between them.
const ANGLES: u32 = 8;
/// How low the rim's centre may be over the road, as a share of the radius: the rim's own radius is beyond that.
const LOWEST: f64 = 0.4;

/// A level road, or a bare drum under the rim.
pub(super) struct Bare {
    /// Of the drum \[1/m\]; 0: level.
    pub curvature: f64,
}

impl Track for Bare {
    fn at(&self, x: f64) -> (f64, f64) {
        road::round(self.curvature, x)
    }

    fn highest(&self) -> f64 {
        if self.curvature < 0.0 { f64::INFINITY } else { 0.0 }
    }
}

/// A stationary ring.
#[derive(Debug, Clone, PartialEq)]
pub struct Stationary {
    /// The elements.
    pub ring: Ring,
    /// The load that coefficients were taken at \[N\].
    pub load: f64,
    pub(super) coefficients: Coefficients,
    pub(super) sums: Sums,
    /// Height of the rim's centre over the road \[m\].
    pub height: f64,
}

impl Parameters {
    /// Coefficients at a load and a speed.
    pub(super) fn coefficients(&self, prepared: &Prepared, load: f64, speed: f64) -> Coefficients {
        let load = if self.characteristic_load > 0.0 { self.characteristic_load } else { load.max(0.0) };
        Coefficients {
            stiffness: self.stiffness_factor * prepared.stiffness.at(self.stiffness, load, speed),
            damping: prepared.damping.at(self.damping, load, speed),
        }
    }

    /// The vertical part of the force on the rim \[N\].
    pub(super) fn on_rim(&self, sums: &Sums) -> [f64; 2] {
        if self.rim_force == 2 { sums.exact } else { sums.radial }
    }
}

/// The ring at rest on a track under a rim at a height.
///
/// # Errors
/// Coupled elements do not find their balance.
pub(super) fn at_rest(rubber: &Rubber<'_>, rim: &RimInPlane, track: &impl Track) -> Result<(Ring, Sums)> {
    let prepared = rubber.prepared;
    let mut ring = Ring::free(rubber.parameters, prepared);
    let still = |n: usize, angle: f64, guess: f64, felt: &Coupled| {
        let along = along(prepared, n, libm::sincos(angle));
        let ray = Ray {
            along,
            rim_height: rim.height,
            rim_velocity: [0.0; 2],
            spin: 0.0,
            turning: 0.0,
            to_tread: 0.5 * rubber.parameters.element_thickness,
            offsets: &prepared.offsets,
        };
        let radial = felt.with(&rubber.at_rest(rim, along));
        reach(&radial, &ray, track, &prepared.contact, (prepared.free, 0.0, LONG), guess, Wanted::Force)
            .distance
    };
    let coupling = Coupling::new(rubber.parameters, prepared);
    // all elements where the rim is at an angle
    let all = |angle: f64, from: &[f64]| -> Result<Vec<f64>> {
        let free = Coupled::default();
        let Some(coupling) = coupling else {
            return Ok(from.iter().enumerate().map(|(n, guess)| still(n, angle, *guess, &free)).collect());
        };
        let mut places: Vec<Place> =
            from.iter().map(|distance| Place { distance: *distance, ..Place::default() }).collect();
        let settled = (0..MOST_SWEEPS).any(|_| {
            let moved = (0..places.len()).fold(0.0_f64, |moved, n| {
                let felt = coupling.on(&places, n).about(&places[n]);
                let distance = still(n, angle, places[n].distance, &felt);
                let way = (distance - places[n].distance).abs();
                places[n].distance = distance;
                moved.max(way)
            });
            moved <= SETTLED
        });
        if settled {
            return Ok(places.iter().map(|place| place.distance).collect());
        }
        Err(Error::numeric(
            "coupled elements do not find their balance at rest: coupling_stiffness or bending_stiffness is too large for their number beside element_radial_stiffness",
        ))
    };
    let here = all(rim.angle, &ring.distance)?;
    let turned = [all(rim.angle - TURN, &here)?, all(rim.angle + TURN, &here)?];
    for n in 0..here.len() {
        ring.distance[n] = here[n];
        ring.friction[n] =
            rubber.at_rest(rim, along(prepared, n, libm::sincos(rim.angle))).friction.at(here[n]).0;
        ring.speed[n] = rim.spin * (turned[1][n] - turned[0][n]) / (2.0 * TURN);
    }
    let sums = ring.evaluate(rubber, rim, track);
    Ok((ring, sums))
}

/// The stationary ring under a rim that moves so, at its height or where the rim carries `load`.
///
/// # Errors
/// No height carries that load, coupled elements find no balance, or no load fits the stiffness that it makes.
pub(super) fn stationary(
    parameters: &Parameters,
    prepared: &Prepared,
    rim: &RimInPlane,
    load: Option<f64>,
) -> Result<Stationary> {
    let track = Bare { curvature: prepared.curvature };
    let with = |height: f64, coefficients: Coefficients| {
        let rim = RimInPlane { height, ..*rim };
        at_rest(&Rubber { parameters, prepared, coefficients }, &rim, &track)
    };
    let speed = rim.velocity[0];
    if let Some(load) = load {
        let coefficients = parameters.coefficients(prepared, load, speed);
        // of a wheel that turns the mean over the angle from one element to the next
        let angles = if rim.spin == 0.0 { 1 } else { ANGLES };
        let carried = |height: f64| -> Result<f64> {
            let at = |k: u32| -> Result<f64> {
                let angle = rim.angle + prepared.pitch * f64::from(k) / f64::from(angles);
                let rim = RimInPlane { height, angle, ..*rim };
                let rubber = Rubber { parameters, prepared, coefficients };
                Ok(parameters.on_rim(&at_rest(&rubber, &rim, &track)?.1)[1])
            };
            Ok((0..angles).map(at).sum::<Result<f64>>()? / f64::from(angles) - load)
        };
        // spinning makes it larger; nothing touches at that height
        let spring = coefficients.stiffness - prepared.mass * rim.spin * rim.spin;
        if spring <= 0.0 {
            return Err(Error::numeric(format!(
                "the wheel spins too fast for its rubber: at {:.0} rad/s no spring holds the elements",
                rim.spin
            )));
        }
        let grown = prepared.free * coefficients.stiffness / spring + 0.5 * parameters.element_thickness;
        let (mut low, mut high) = (LOWEST * parameters.radius, grown);
        let (mut at_low, mut at_high) = (carried(low)?, carried(high)?);
        if at_low < 0.0 {
            return Err(Error::numeric(format!(
                "the tire cannot carry {load:.0} N: with its rim at {LOWEST} of its radius it carries {:.0} N",
                at_low + load
            )));
        }
        if at_high > 0.0 {
            return Err(Error::numeric(format!(
                "a load of {load:.0} N is less than the tire in the air has, {:.0} N: its own weight hangs on the rim",
                at_high + load
            )));
        }
        for k in 0..SEARCHES {
            // secants, and a halving now and then, so that both ends come near
            let secant = high - at_high * (high - low) / (at_high - at_low);
            let middle = if k % 3 == 2 { 0.5 * (low + high) } else { secant };
            let at = carried(middle)?;
            if at > 0.0 {
                (low, at_low) = (middle, at)
            } else {
                (high, at_high) = (middle, at)
            }
            if at == 0.0 || high - low < 1e-12 {
                break;
            }
        }
        let height =
            if at_high == at_low { high } else { high - at_high * (high - low) / (at_high - at_low) };
        let (ring, sums) = with(height, coefficients)?;
        return Ok(Stationary { ring, load, coefficients, sums, height });
    }
    // at a height the coefficients know the load that they make
    let mut load = parameters.reference_load;
    for _ in 0..SEARCHES {
        let coefficients = parameters.coefficients(prepared, load, speed);
        let (ring, sums) = with(rim.height, coefficients)?;
        let next = parameters.on_rim(&sums)[1].max(0.0);
        let is_same = (next - load).abs() <= 1e-9 * load;
        load = next;
        if is_same {
            return Ok(Stationary { ring, load, coefficients, sums, height: rim.height });
        }
    }
    Err(Error::numeric(format!(
        "no load was found that fits the stiffness that it makes, at a height of {} m of the rim: the stiffness changes too much with the load",
        rim.height
    )))
}
