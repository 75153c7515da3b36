//! Ids and families of effects as a diagnosis names them, and which of them are the same physics on data of this kind.

use crate::flat_track;

/// Families that count as one when a name is judged.
const FAMILIES: [(&str, &[&str]); 6] = [
    (
        "tire",
        &[
            "relaxation-length",
            "carcass-compliance",
            "belt-mode",
            "pressure-dependent-friction",
            "speed-dependent-friction",
            "thermal-softening",
            "inflation-warm-up",
            "viscoelastic-stiffening",
            "payne",
            "rolling-resistance",
            "drum-curvature",
            "camber-thrust",
            "conicity",
            "plysteer",
            "non-uniformity",
            "loss-of-contact",
            "lift-off",
            "load-sensitivity",
        ],
    ),
    (
        "brake",
        &[
            "disc-thickness-variation",
            "pad-fade",
            "pad-onset",
            "hydraulic-lag",
            "hydraulic-hold-off",
            "valve-rate-limit",
            "tone-ring",
            "rolling-radius",
            "imbalance",
            "driveline-compliance",
            "backlash",
            "load-dependent-friction",
        ],
    ),
    (
        "suspension",
        &[
            "progressive-spring",
            "quadratic-damper",
            "damper-asymmetry",
            "bump-stop",
            "bushing-hysteresis",
            "bouc-wen",
            "coulomb-friction",
            "play",
            "added-inertia",
            "steering-compliance",
        ],
    ),
    (
        "rig",
        &[
            "fixture-inertia",
            "frame-resonance",
            "belt-order",
            "seal-friction",
            "stribeck-friction",
            "viscous-drag",
        ],
    ),
    (
        "sensor",
        &[
            "sensor-delay",
            "sensor-lag",
            "sensor-bias",
            "sensor-drift",
            "sensor-gain",
            "cross-talk",
            "quantisation",
            "saturation",
            "supply-sag",
            "clock-drift",
        ],
    ),
    ("mechanism", &[]),
];

/// Effects that recordings of the base machines cannot, or hardly, tell apart.
const ALIKE: [&[&str]; 13] = [
    &["relaxation-length", "carcass-compliance"],
    &["belt-mode", "frame-resonance"],
    &["conicity", "plysteer"],
    &["rolling-resistance", "load-dependent-friction"],
    &["coulomb-friction", "seal-friction", "stribeck-friction"],
    &["bouc-wen", "bushing-hysteresis"],
    &["play", "backlash", "clearance"],
    &["loss-of-contact", "lift-off"],
    &["payne", "amplitude-softening"],
    &["viscoelastic-stiffening", "maxwell-element"],
    &["fixture-inertia", "cross-talk"],
    &["sensor-delay", "sensor-lag"],
    &["hydraulic-lag", "driveline-compliance"],
];

/// The same where the model tells the power of its friction, as the flat track does.
const ALIKE_BY_POWER: &[&str] = &["thermal-softening", "frictional-heating"];

/// The family of an id; none for an unknown one.
#[must_use]
pub fn family(id: &str) -> Option<&'static str> {
    FAMILIES.iter().find(|(_, ids)| ids.contains(&id)).map(|(name, _)| *name)
}

/// All ids that are right where `id` is hidden, itself first.
#[must_use]
pub fn alike(id: &str) -> Vec<String> {
    let mut all = vec![id.to_owned()];
    for group in ALIKE {
        if group.contains(&id) {
            all.extend(group.iter().filter(|other| **other != id).map(|other| (*other).to_owned()));
        }
    }
    all
}

/// As [`alike`], on a machine of this name.
#[must_use]
pub fn alike_on(model: &str, id: &str) -> Vec<String> {
    let mut all = alike(id);
    if model == flat_track::NAME && ALIKE_BY_POWER.contains(&id) {
        all.extend(ALIKE_BY_POWER.iter().filter(|other| **other != id).map(|other| (*other).to_owned()));
    }
    all
}

/// All families in which one of these ids is. A spring or damper that is named as one of any mechanism is one of a
/// suspension too.
#[must_use]
pub fn families(ids: &[String]) -> Vec<&'static str> {
    let mut all: Vec<_> = ids.iter().filter_map(|id| family(id)).collect();
    if all.contains(&"suspension") {
        all.push("mechanism");
    }
    all.dedup();
    all
}
