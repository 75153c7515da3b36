//! Draws a case: which effect hides where, how large, and what the rig does.

use crate::base::Base;
use crate::flat_track::{self, Concealed};
use crate::hidden::{Hidden, Law};
use crate::programme::{self, EVERYTHING, Region, Run, Sampling};
use crate::random::Random;
use crate::sensor::Noise;
use crate::simulate::{STEP, World};
use crate::sizing::Refit;
use crate::study::{Kind, name, study};
use std::collections::BTreeSet;

/// An effect that can hide in a machine.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Offer {
    pub(crate) id: &'static str,
    pub(crate) law: Law,
    pub(crate) base: Base,
    /// Inputs (on the way in) or outputs (on the way out) that it can sit at.
    pub(crate) channels: &'static [usize],
    /// Whether its sign is free.
    pub(crate) signed: bool,
    pub(crate) depends_on: &'static [&'static str],
}

pub(crate) const fn offer(
    id: &'static str,
    law: Law,
    base: Base,
    channels: &'static [usize],
    signed: bool,
    depends_on: &'static [&'static str],
) -> Offer {
    Offer { id, law, base, channels, signed, depends_on }
}

use Base::{AbsBrake, BrakeCorner, FlatTrack, MagicWheel, Oscillator, QuarterCar, SteadyTire};

const SPRING: &[&str] = &["position", "suspension_deflection", "deflection"];
const DAMPER: &[&str] = &["velocity", "suspension_velocity", "rate"];
const TIME: &[&str] = &["time"];
const BOTH: &[&str] = &["position", "suspension_deflection", "velocity", "suspension_velocity"];

/// Effects of the catalogue, each with the machines in which it makes sense.
const OFFERS: &[Offer] = &[
    offer("progressive-spring", Law::Cubic, Oscillator, &[0], false, SPRING),
    offer("progressive-spring", Law::Cubic, QuarterCar, &[0], false, SPRING),
    offer("quadratic-damper", Law::QuadraticDamper, Oscillator, &[0], false, DAMPER),
    offer("quadratic-damper", Law::QuadraticDamper, QuarterCar, &[0], false, DAMPER),
    offer("damper-asymmetry", Law::Asymmetry, QuarterCar, &[0], true, DAMPER),
    offer("damper-asymmetry", Law::Asymmetry, Oscillator, &[0], true, DAMPER),
    offer("bump-stop", Law::BumpStop, QuarterCar, &[0], false, SPRING),
    offer("bump-stop", Law::BumpStop, Oscillator, &[0], false, SPRING),
    offer("bouc-wen", Law::Hysteresis, Oscillator, &[0], false, BOTH),
    offer("bouc-wen", Law::Hysteresis, QuarterCar, &[0], false, BOTH),
    offer("coulomb-friction", Law::Coulomb, Oscillator, &[0], false, DAMPER),
    offer("coulomb-friction", Law::Coulomb, QuarterCar, &[0], false, DAMPER),
    offer("stribeck-friction", Law::Stribeck, Oscillator, &[0], false, DAMPER),
    offer("play", Law::Play, Oscillator, &[0], false, SPRING),
    offer("play", Law::Play, QuarterCar, &[0], false, SPRING),
    offer("viscoelastic-stiffening", Law::Maxwell, Oscillator, &[0], false, DAMPER),
    offer("viscoelastic-stiffening", Law::Maxwell, QuarterCar, &[0], false, DAMPER),
    offer("payne", Law::Payne, Oscillator, &[0], false, SPRING),
    offer("loss-of-contact", Law::Lift, QuarterCar, &[4], false, &["wheel_load", "load"]),
    offer("fixture-inertia", Law::CrossTalk, QuarterCar, &[4], true, &["wheel_acceleration"]),
    offer("frame-resonance", Law::Resonance, QuarterCar, &[4], false, &["wheel_load", "load"]),
    offer("frame-resonance", Law::Resonance, SteadyTire, &[0, 1], false, &["force_x", "force_y"]),
    offer("belt-mode", Law::Resonance, MagicWheel, &[0], false, &["force_x"]),
    offer("relaxation-length", Law::Relaxation, SteadyTire, &[1], false, &["speed", "slip_angle"]),
    offer("carcass-compliance", Law::Carcass, SteadyTire, &[1], false, &["speed", "slip_angle"]),
    offer("speed-dependent-friction", Law::SpeedFriction, SteadyTire, &[1], false, &["speed"]),
    offer("speed-dependent-friction", Law::SpeedFriction, MagicWheel, &[1], false, &["speed"]),
    offer("thermal-softening", Law::Thermal, SteadyTire, &[1], false, &["slid energy", "energy", "time"]),
    offer("inflation-warm-up", Law::WarmUp, SteadyTire, &[1], false, &["time", "distance"]),
    offer("load-sensitivity", Law::LoadSensitivity, SteadyTire, &[1], false, &["load"]),
    offer("load-sensitivity", Law::LoadSensitivity, MagicWheel, &[1], false, &["load"]),
    offer("rolling-resistance", Law::Rolling, SteadyTire, &[0], false, &["load", "speed"]),
    offer("camber-thrust", Law::Camber, SteadyTire, &[1], false, &["camber"]),
    offer("camber-thrust", Law::Camber, MagicWheel, &[1], false, &["camber"]),
    offer("conicity", Law::LoadOffset, SteadyTire, &[1], true, &["load"]),
    offer("plysteer", Law::SideSlip, SteadyTire, &[1], true, &["load", "slip_angle"]),
    offer("non-uniformity", Law::WheelOrder, SteadyTire, &[1], false, &["wheel_angle", "load"]),
    offer("non-uniformity", Law::WheelOrder, MagicWheel, &[0, 1], false, &["wheel_angle", "load"]),
    offer("belt-order", Law::BeltOrder, SteadyTire, &[0, 1], false, &["distance"]),
    offer("tone-ring", Law::ToneRing, MagicWheel, &[3], false, &["wheel_angle"]),
    offer("tone-ring", Law::ToneRing, SteadyTire, &[3], false, &["wheel_angle"]),
    offer("rolling-radius", Law::RollingRadius, SteadyTire, &[3], true, &["load"]),
    offer("imbalance", Law::Imbalance, MagicWheel, &[0], false, &["wheel_angle", "speed"]),
    offer("imbalance", Law::Imbalance, SteadyTire, &[0], false, &["wheel_angle", "speed"]),
    offer("load-dependent-friction", Law::LoadFriction, MagicWheel, &[0], false, &["load"]),
    offer(
        "disc-thickness-variation",
        Law::DiscThickness,
        MagicWheel,
        &[0],
        false,
        &["wheel_angle", "brake_torque"],
    ),
    offer(
        "disc-thickness-variation",
        Law::DiscThickness,
        BrakeCorner,
        &[3],
        false,
        &["wheel_angle", "pressure"],
    ),
    offer("pad-fade", Law::Fade, BrakeCorner, &[3], false, &["energy", "time", "brake energy"]),
    offer("pad-onset", Law::Onset, BrakeCorner, &[3], false, &["pressure", "time"]),
    offer("hydraulic-lag", Law::InputLag, BrakeCorner, &[0], false, &["line_pressure", "pressure"]),
    offer("hydraulic-lag", Law::InputLag, MagicWheel, &[0], false, &["brake_torque"]),
    offer("hydraulic-hold-off", Law::HoldOff, BrakeCorner, &[0], false, &["line_pressure", "pressure"]),
    offer("hydraulic-hold-off", Law::HoldOff, MagicWheel, &[0], false, &["brake_torque"]),
    offer("valve-rate-limit", Law::RateLimit, BrakeCorner, &[0], false, &["line_pressure", "pressure"]),
    offer("sensor-delay", Law::Delay, Oscillator, &[0, 1, 2], false, TIME),
    offer("sensor-delay", Law::Delay, QuarterCar, &[2, 4], false, TIME),
    offer("sensor-delay", Law::Delay, SteadyTire, &[0, 1], false, TIME),
    offer("sensor-lag", Law::Lag, QuarterCar, &[2, 4], false, TIME),
    offer("sensor-lag", Law::Lag, BrakeCorner, &[1, 3], false, TIME),
    offer("sensor-bias", Law::Bias, Oscillator, &[1, 2], true, &[]),
    offer("sensor-bias", Law::Bias, SteadyTire, &[0, 1], true, &[]),
    offer("sensor-drift", Law::Drift, QuarterCar, &[2, 4], true, TIME),
    offer("sensor-drift", Law::Drift, BrakeCorner, &[3], true, TIME),
    offer("sensor-gain", Law::Gain, Oscillator, &[1, 2], true, &[]),
    offer("sensor-gain", Law::Gain, QuarterCar, &[0, 2], true, &[]),
    offer("cross-talk", Law::CrossTalk, SteadyTire, &[0, 2], true, &["force_y"]),
    offer("cross-talk", Law::CrossTalk, MagicWheel, &[0, 2], true, &["force_y"]),
];

/// Effects that are in no catalogue.
const OUTSIDE: &[Offer] = &[
    offer("outside-time-stiffness", Law::TimeStiffness, Oscillator, &[0], false, TIME),
    offer("outside-time-stiffness", Law::TimeStiffness, QuarterCar, &[0], false, TIME),
    offer("outside-snap", Law::Snap, Oscillator, &[0], false, SPRING),
    offer("outside-crack", Law::Crack, Oscillator, &[0], false, TIME),
    offer("outside-crack", Law::Crack, QuarterCar, &[0], false, TIME),
    offer("outside-absorber", Law::Absorber, Oscillator, &[0], false, &[]),
    offer("outside-absorber", Law::Absorber, QuarterCar, &[0], false, &[]),
    offer("outside-walk-friction", Law::WalkFriction, Oscillator, &[0], false, &["velocity", "time"]),
    offer("outside-chaos", Law::Chaos, Oscillator, &[0], false, &[]),
    offer("outside-chaos", Law::Chaos, QuarterCar, &[0], false, &[]),
    offer("outside-unrecorded", Law::Unrecorded, QuarterCar, &[0], false, &[]),
    offer("outside-unrecorded", Law::Unrecorded, Oscillator, &[0], false, &[]),
    offer("outside-mass-loss", Law::MassLoss, Oscillator, &[0], true, TIME),
    offer("outside-mass-loss", Law::MassLoss, QuarterCar, &[0], true, TIME),
    offer("outside-product", Law::Product, Oscillator, &[0], false, BOTH),
    offer("outside-product", Law::Product, QuarterCar, &[0], false, BOTH),
    offer("outside-sampled", Law::Sampled, Oscillator, &[0], false, &["velocity", "time"]),
    offer("outside-tanh-cross", Law::TanhCross, Oscillator, &[0], true, BOTH),
    offer("outside-tanh-cross", Law::TanhCross, QuarterCar, &[0], true, BOTH),
    offer("outside-cogging", Law::Cogging, Oscillator, &[0], false, SPRING),
    offer("outside-time-friction", Law::TimeFriction, SteadyTire, &[1], false, TIME),
    offer("outside-time-friction", Law::TimeFriction, MagicWheel, &[1], false, TIME),
    offer("outside-patch-friction", Law::PatchFriction, SteadyTire, &[1], false, TIME),
    offer("outside-speed-load", Law::SpeedLoad, SteadyTire, &[1, 2], true, &["speed", "load"]),
    offer("outside-camber-slip", Law::CamberSlip, SteadyTire, &[0, 1], true, &["camber", "slip_angle"]),
    offer("outside-squared-angle", Law::SquaredAngle, MagicWheel, &[0], true, &["slip_angle", "force_y"]),
    offer("outside-slip-speed", Law::SlipSpeed, SteadyTire, &[1, 2], true, &["slip", "speed"]),
    offer("outside-time-brake", Law::TimeBrake, BrakeCorner, &[3], false, TIME),
    offer("outside-speed-brake", Law::SpeedBrake, BrakeCorner, &[3], false, &["vehicle_speed", "speed"]),
    offer("outside-walk-brake", Law::WalkBrake, BrakeCorner, &[3], false, TIME),
];

/// Pairs that leave different marks, on one machine each.
const MIXES: &[(Base, &str, &str)] = &[
    (Oscillator, "progressive-spring", "sensor-bias"),
    (Oscillator, "coulomb-friction", "progressive-spring"),
    (Oscillator, "quadratic-damper", "sensor-delay"),
    (QuarterCar, "damper-asymmetry", "fixture-inertia"),
    (QuarterCar, "bump-stop", "sensor-drift"),
    (QuarterCar, "coulomb-friction", "frame-resonance"),
    (QuarterCar, "progressive-spring", "sensor-lag"),
    (SteadyTire, "relaxation-length", "camber-thrust"),
    (SteadyTire, "non-uniformity", "rolling-resistance"),
    (SteadyTire, "load-sensitivity", "tone-ring"),
    (SteadyTire, "conicity", "rolling-radius"),
    (MagicWheel, "disc-thickness-variation", "camber-thrust"),
    (MagicWheel, "tone-ring", "hydraulic-lag"),
    (MagicWheel, "imbalance", "load-sensitivity"),
    (BrakeCorner, "pad-onset", "disc-thickness-variation"),
    (BrakeCorner, "pad-fade", "hydraulic-lag"),
];

struct Trap {
    base: Base,
    /// What hides; nothing where it is empty.
    id: &'static str,
    decoys: &'static [&'static str],
    fit: Region,
    check: Region,
}

const fn region(amplitude: (f64, f64), speed: (f64, f64), load: (f64, f64), band: f64) -> Region {
    Region { amplitude, speed, load, band, rest: false }
}

const LOADS: (f64, f64) = (2000.0, 6000.0);
const SPEEDS: (f64, f64) = (6.0, 32.0);
const USUAL: (f64, f64) = (0.25, 1.0);

/// Fitting runs in which a wrong effect looks right, and checking runs in which it does not.
const TRAPS: [Trap; 10] = [
    Trap {
        base: SteadyTire,
        id: "relaxation-length",
        decoys: &["sensor-lag", "sensor-delay"],
        fit: region(USUAL, (14.0, 14.5), LOADS, 1.0),
        check: region(USUAL, SPEEDS, LOADS, 1.0),
    },
    Trap {
        base: SteadyTire,
        id: "sensor-delay",
        decoys: &["relaxation-length", "carcass-compliance"],
        fit: region(USUAL, (14.0, 14.5), LOADS, 1.0),
        check: region(USUAL, SPEEDS, LOADS, 1.0),
    },
    Trap {
        base: SteadyTire,
        id: "non-uniformity",
        decoys: &["belt-order", "imbalance"],
        fit: region(USUAL, (20.0, 20.5), LOADS, 1.0),
        check: region(USUAL, SPEEDS, LOADS, 1.0),
    },
    Trap {
        base: SteadyTire,
        id: "belt-order",
        decoys: &["non-uniformity", "imbalance"],
        fit: region(USUAL, (20.0, 20.5), LOADS, 1.0),
        check: region(USUAL, SPEEDS, LOADS, 1.0),
    },
    Trap {
        base: Oscillator,
        id: "progressive-spring",
        decoys: &["bump-stop", "payne"],
        fit: region((0.5, 0.6), SPEEDS, LOADS, 1.0),
        check: region((0.2, 1.1), SPEEDS, LOADS, 1.0),
    },
    Trap {
        base: QuarterCar,
        id: "coulomb-friction",
        decoys: &["bouc-wen", "damper-asymmetry", "quadratic-damper"],
        fit: region((0.7, 0.9), SPEEDS, LOADS, 1.0),
        check: region((0.2, 0.5), SPEEDS, LOADS, 1.0),
    },
    Trap {
        base: SteadyTire,
        id: "thermal-softening",
        decoys: &["sensor-drift", "inflation-warm-up"],
        fit: region((0.8, 0.9), (14.0, 14.5), (3900.0, 4100.0), 1.0),
        check: region(USUAL, SPEEDS, LOADS, 1.0),
    },
    Trap {
        base: SteadyTire,
        id: "conicity",
        decoys: &["sensor-bias"],
        fit: region(USUAL, SPEEDS, (3980.0, 4020.0), 1.0),
        check: region(USUAL, SPEEDS, LOADS, 1.0),
    },
    Trap {
        base: Oscillator,
        id: "viscoelastic-stiffening",
        decoys: &["payne", "bouc-wen"],
        fit: region((0.5, 0.55), SPEEDS, LOADS, 0.4),
        check: region((0.2, 1.0), SPEEDS, LOADS, 1.0),
    },
    Trap {
        base: QuarterCar,
        id: "",
        decoys: &[],
        fit: region((0.3, 0.35), SPEEDS, LOADS, 0.5),
        check: region(USUAL, SPEEDS, LOADS, 1.0),
    },
];

/// Ids of the catalogue that can hide.
#[must_use]
pub fn ids() -> Vec<&'static str> {
    OFFERS.iter().map(|o| o.id).collect::<BTreeSet<_>>().into_iter().collect()
}

/// Effects outside of it.
#[must_use]
pub fn outside_ids() -> Vec<&'static str> {
    OUTSIDE.iter().map(|o| o.id).collect::<BTreeSet<_>>().into_iter().collect()
}

/// A case, complete but for its simulation.
#[derive(Debug, Clone)]
pub struct Case {
    /// Its name, which says nothing.
    pub name: String,
    /// What it is about.
    pub kind: Kind,
    /// The machine with all that hides in it.
    pub world: World,
    /// Per hidden effect: variables on which it depends, and its rest after a refit over the noise, per channel.
    pub marks: Vec<(Vec<String>, Vec<f64>)>,
    /// What the rig does.
    pub runs: Vec<Run>,
    /// Per run whether it is for checking; none leaves that to the tool.
    pub check: Option<Vec<bool>>,
    /// Noise per measured channel.
    pub noise: Vec<Noise>,
    /// Names that fit the fitting runs only.
    pub decoys: Vec<String>,
    /// Parameters that have to be found, with the share by which they may be off.
    pub to_find: Vec<(String, f64)>,
    /// Randomness of the sensors and faults.
    pub random: Random,
}

/// How much remains of an effect after a refit, over the noise.
const CLEAR: (f64, f64) = (3.0, 6.0);
const FAINT: (f64, f64) = (0.3, 0.9);
/// How often a case is drawn anew because its effect cannot be made large enough within reason.
const ATTEMPTS: u64 = 60;

/// Draws case number `number` of the study with this seed.
///
/// # Errors
/// No such case, or one that cannot be drawn: then it says which.
pub fn draw(seed: u64, number: usize) -> Result<Case, String> {
    let kinds = study(seed);
    let kind = *kinds
        .get(number)
        .ok_or_else(|| format!("the study has {} cases; there is no number {}", kinds.len(), number + 1))?;
    for attempt in 0..ATTEMPTS {
        let random = Random::new(seed, 1 + attempt * 100_000 + number as u64);
        if let Some(mut case) = try_draw(kind, random) {
            case.name = name(number);
            return Ok(case);
        }
    }
    Err(format!("case {}: {kind:?} cannot be made as large as wanted in {ATTEMPTS} attempts", number + 1))
}

struct Plan {
    base: Base,
    offers: Vec<Offer>,
    target: (f64, f64),
    fit: Region,
    check: Option<Region>,
    decoys: Vec<String>,
    to_find: Vec<(String, f64)>,
    repeat: bool,
}

fn pick(random: &mut Random, from: &[Offer], wanted: impl Fn(&Offer) -> bool) -> Option<Offer> {
    let list: Vec<Offer> = from.iter().filter(|o| wanted(o)).copied().collect();
    if list.is_empty() { None } else { Some(random.pick(&list)) }
}

fn plan(kind: Kind, random: &mut Random) -> Option<Plan> {
    let open = [Oscillator, QuarterCar, SteadyTire, MagicWheel, BrakeCorner];
    let plain = |base: Base, offers: Vec<Offer>, target| Plan {
        base,
        offers,
        target,
        fit: EVERYTHING,
        check: None,
        decoys: Vec::new(),
        to_find: Vec::new(),
        repeat: false,
    };
    Some(match kind {
        Kind::Clear(id) | Kind::Faint(id) => {
            let one = pick(random, OFFERS, |o| o.id == id)?;
            plain(one.base, vec![one], if matches!(kind, Kind::Clear(_)) { CLEAR } else { FAINT })
        }
        Kind::Outside(id) => {
            let one = pick(random, OUTSIDE, |o| o.id == id)?;
            plain(one.base, vec![one], CLEAR)
        }
        Kind::Mix => {
            let (base, first, second) = random.pick(MIXES);
            let of = |random: &mut Random, id| pick(random, OFFERS, |o| o.id == id && o.base == base);
            plain(base, vec![of(random, first)?, of(random, second)?], CLEAR)
        }
        Kind::Null | Kind::Parameters => plain(
            random.pick(&[Oscillator, QuarterCar, SteadyTire, MagicWheel, BrakeCorner, AbsBrake]),
            vec![],
            CLEAR,
        ),
        Kind::Fault(_) => plain(random.pick(&open), vec![], CLEAR),
        Kind::Decoy(k) => {
            let trap = &TRAPS[k % TRAPS.len()];
            let offers = if trap.id.is_empty() {
                vec![]
            } else {
                vec![pick(random, OFFERS, |o| o.id == trap.id && o.base == trap.base)?]
            };
            Plan {
                fit: trap.fit,
                check: Some(trap.check),
                decoys: trap.decoys.iter().map(|s| (*s).into()).collect(),
                ..plain(trap.base, offers, CLEAR)
            }
        }
        Kind::FlatTrack(concealed) => {
            let of = |random: &mut Random, from: &[Offer], id| pick(random, from, |o| o.id == id);
            let (offers, target) = match concealed {
                Concealed::Clear(id) => (vec![of(random, &flat_track::OFFERS, id)?], CLEAR),
                Concealed::Faint(id) => (vec![of(random, &flat_track::OFFERS, id)?], FAINT),
                Concealed::Outside(id) => (vec![of(random, &flat_track::OUTSIDE, id)?], CLEAR),
                Concealed::Parameters => (vec![], CLEAR),
            };
            plain(FlatTrack, offers, target)
        }
        Kind::Mack(k) => {
            let onset = offer("pad-onset", Law::Onset, AbsBrake, &[3], false, &["pressure", "time"]);
            let disc = offer(
                "disc-thickness-variation",
                Law::DiscThickness,
                AbsBrake,
                &[3],
                false,
                &["wheel_angle", "pressure"],
            );
            let scatter = offer("outside-road-scatter", Law::RoadScatter, AbsBrake, &[0], false, &[]);
            let offers = match k {
                1 => vec![onset],
                7 => vec![onset, disc],
                8 => vec![scatter],
                _ => vec![],
            };
            let to_find = match k {
                2 => vec![("shape".to_owned(), 0.05)],
                4 => vec![("spin_inertia".to_owned(), 0.05)],
                5 => vec![("controller_radius".to_owned(), 0.01)],
                6 => vec![("friction".to_owned(), 0.03)],
                _ => vec![],
            };
            Plan { to_find, repeat: k == 8, ..plain(AbsBrake, offers, CLEAR) }
        }
    })
}

fn parameters(kind: Kind, base: Base, random: &mut Random) -> Vec<f64> {
    let mut list = base.defaults();
    let mut change = |name: &str, factor: f64| list[base.parameter(name)] *= factor;
    match kind {
        Kind::Null | Kind::Mack(1 | 7 | 8) => {}
        Kind::Mack(2) => change("shape", 1.62 / 1.3),
        Kind::Mack(4) => change("spin_inertia", 1.2),
        Kind::Mack(5) => change("controller_radius", 1.03),
        Kind::Mack(6) => change("friction", 1.0 / 1.12),
        _ => {
            for (value, row) in list.iter_mut().zip(base.parameters()) {
                // the shape factor has to stay between 1 and 2, and two radii are hardly ever that wrong
                let off = match row.0 {
                    "shape" => 0.1,
                    "radius" | "rolling_radius" | "controller_radius" => 0.03,
                    _ => 0.15,
                };
                *value *= 1.0 + random.within(-off, off);
            }
        }
    }
    list
}

fn sampling(base: Base, random: &mut Random, runs: usize) -> Sampling {
    let rate: f64 = match base {
        Oscillator => random.pick(&[100.0, 125.0, 200.0]),
        FlatTrack => 200.0,
        _ => random.pick(&[200.0, 250.0]),
    };
    #[allow(clippy::cast_precision_loss)] // a dozen
    let duration = if base == FlatTrack { 10.0 } else { (10_000.0 / (rate * runs as f64)).clamp(4.0, 8.0) };
    Sampling { rate, duration, jitter: random.within(0.01, 0.06) }
}

fn hide(one: &Offer, random: &mut Random, kind: Kind) -> Hidden {
    let channel = random.pick(one.channels);
    let other = match one.base {
        QuarterCar => 1,
        _ => 1 - channel.min(1),
    };
    let mut form = [random.share(), random.share(), random.share()];
    if matches!(kind, Kind::Mack(_)) && one.law == Law::Onset {
        form[0] = 0.4; // 0.22 s
    }
    let other = if one.law == Law::CrossTalk && one.base != QuarterCar { 1 } else { other };
    Hidden {
        id: one.id,
        law: one.law,
        size: if one.signed { random.sign() } else { 1.0 },
        channel,
        other,
        form,
        seed: random.bits(),
    }
}

/// The largest size that is still believable.
fn most(law: Law) -> f64 {
    match law {
        Law::Resonance | Law::Onset => 1.2,
        Law::Fade | Law::Thermal | Law::SpeedFriction => 2.5,
        _ => 5.0,
    }
}

fn noise(world: &World, runs: &[(u64, Run)], random: &mut Random) -> Vec<Noise> {
    let rows = world.base.outputs();
    let ideals: Vec<_> = runs.iter().map(|(number, run)| world.run(run, *number, 1e-3)).collect();
    (0..rows.len())
        .map(|c| {
            let values: Vec<f64> = ideals.iter().flat_map(|ideal| ideal.outputs[c].iter().copied()).collect();
            #[allow(clippy::cast_precision_loss)] // a few thousand
            let count = values.len() as f64;
            let mean = values.iter().sum::<f64>() / count;
            let spread = (values.iter().map(|v| (v - mean) * (v - mean)).sum::<f64>() / count).sqrt();
            let least = if world.base == FlatTrack { flat_track::LEAST_NOISE } else { 0.005 };
            let level = random.log_within(least, 0.03);
            let deviation = match rows[c].0 {
                "wheel_angle" => random.within(0.003, 0.01),
                _ => level * spread.max(0.1 * rows[c].2),
            };
            Noise::draw(random, deviation)
        })
        .collect()
}

fn draw_runs(plan: &Plan, random: &mut Random, gain: f64) -> (Vec<Run>, Option<Vec<bool>>) {
    let count = if plan.base == FlatTrack { 10 } else { 6 + random.below(7) };
    let sampling = sampling(plan.base, random, count);
    let check: Vec<bool> = (0..count).map(|k| k % 3 == 2).collect();
    let runs = (0..count)
        .map(|k| {
            let region = if check[k] { plan.check.as_ref().unwrap_or(&plan.fit) } else { &plan.fit };
            let mut own = if plan.repeat { random.clone() } else { Random::new(random.bits(), 0) };
            programme::draw(plan.base, &mut own, &sampling, region, if plan.repeat { 0 } else { k }, gain)
        })
        .collect();
    (runs, plan.check.map(|_| check))
}

fn try_draw(kind: Kind, mut random: Random) -> Option<Case> {
    let random = &mut random;
    let plan = plan(kind, random)?;
    let lifting = plan.offers.iter().any(|o| o.law == Law::Lift);
    let gain = if lifting { random.within(1.2, 3.5) } else { 1.0 };
    let (mut runs, check) = draw_runs(&plan, random, gain);
    let mut world = World {
        base: plan.base,
        parameters: parameters(kind, plan.base, random),
        hidden: Vec::new(),
        filter: 1.0 / (std::f64::consts::TAU * random.within(150.0, 400.0)),
    };
    // every second run, and one that is checked, are enough to size effects
    let some: Vec<(u64, Run)> =
        (0_u64..).zip(&runs).filter(|(k, _)| k % 2 == 0).map(|(k, run)| (k, run.clone())).take(5).collect();
    let noise = noise(&world, &some, random);
    let deviations: Vec<f64> = noise.iter().map(|n| n.deviation).collect();
    let refit = if plan.offers.is_empty() { None } else { Some(Refit::new(&world, &some, &deviations)) };
    let mut marks = Vec::new();
    let mut hidden = Vec::new();
    for one in &plan.offers {
        let mut effect = hide(one, random, kind);
        let target = random.log_within(plan.target.0, plan.target.1);
        let refit = refit.as_ref()?;
        let mut measure = |effect: &Hidden| {
            world.hidden = vec![effect.clone()];
            refit.over_noise(&world, &some, &deviations)
        };
        let left = match kind {
            Kind::Mack(1 | 8) => {
                effect.size = if effect.law == Law::RoadScatter { 0.6 } else { 1.0 };
                measure(&effect)
            }
            // bristles that slide a step earlier or later hide what a small effect does: it is a share of a clear one
            Kind::FlatTrack(Concealed::Faint(_)) => {
                const LARGER: f64 = 8.0;
                let (target, least) = (LARGER * target, LARGER * plan.target.0);
                let mut left = size(&mut effect, target, least, lifting, &mut measure)?;
                effect.size /= LARGER;
                left.iter_mut().for_each(|v| *v /= LARGER);
                left
            }
            _ => size(&mut effect, target, plan.target.0, lifting, &mut measure)?,
        };
        marks.push((one.depends_on.iter().map(|s| (*s).to_owned()).collect(), left));
        hidden.push(effect);
    }
    world.hidden = hidden;
    if matches!(plan.base, BrakeCorner | AbsBrake) {
        stop_before_standstill(&world, &mut runs)?;
    }
    Some(Case {
        name: String::new(),
        kind,
        world,
        marks,
        runs,
        check,
        noise,
        decoys: plan.decoys,
        to_find: plan.to_find,
        random: random.clone(),
    })
}

/// Finds the size at which the largest rest over the channels is `target`.
fn size(
    effect: &mut Hidden,
    target: f64,
    least: f64,
    lifting: bool,
    measure: &mut impl FnMut(&Hidden) -> Vec<f64>,
) -> Option<Vec<f64>> {
    let largest = |list: &[f64]| list.iter().copied().fold(0.0, f64::max);
    let sign = effect.size.signum();
    let mut left = measure(effect);
    if lifting {
        // its size is that of the programme
        let now = largest(&left);
        return (now.is_finite() && now > least && now < 3.0 * least).then_some(left);
    }
    // some effects begin with a threshold: keep what is known to be too small and too large
    let (mut small, mut large) = (0.0, f64::INFINITY);
    for _ in 0..12 {
        let (now, at) = (largest(&left), effect.size.abs());
        if !now.is_finite() {
            return None;
        }
        if (now / target - 1.0).abs() < 0.05 {
            return Some(left);
        }
        if now < target {
            small = at;
        } else {
            large = at;
        }
        if small >= most(effect.law) {
            break;
        }
        let wish = if now > 0.0 { at * (target / now).clamp(0.05, 20.0) } else { 2.0 * at };
        let inside = wish > small && wish < large;
        let next = if inside || small <= 0.0 || large.is_infinite() { wish } else { (small * large).sqrt() };
        effect.size = sign * next.min(most(effect.law));
        left = measure(effect);
    }
    let now = largest(&left);
    (now >= least && now < 1.4 * target).then_some(left)
}

/// Runs end before the vehicle stands, where the equations end to be worth anything.
fn stop_before_standstill(world: &World, runs: &mut [Run]) -> Option<()> {
    for (number, run) in (0_u64..).zip(runs) {
        let ideal = world.run(run, number, STEP);
        let end = ideal.outputs[0].iter().position(|v| *v < 5.0).unwrap_or(run.time.len());
        if end < 150 {
            return None;
        }
        run.time.truncate(end);
        for values in &mut run.inputs {
            values.truncate(end);
        }
    }
    Some(())
}
