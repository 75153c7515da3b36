//! The catalogue: one file per effect, by family.

mod added_inertia;
mod asymmetric_spring;
mod bouc_wen;
mod clock_drift;
mod coulomb_friction;
mod cross_talk;
mod mains_hum;
mod operator;
#[cfg(test)]
mod physics;
mod play;
mod progressive_spring;
mod quadratic_damper;
mod quantisation;
mod relaxation_length;
mod saturation;
mod sensor_bias;
mod sensor_delay;
mod sensor_drift;
mod sensor_gain;
mod sensor_lag;
mod sensor_nonlinearity;
mod supply_sag;
#[cfg(test)]
mod tests;
mod viscous_drag;

use super::Effect;

/// All effects, by family, in the order in which they are shown.
pub const EFFECTS: &[Effect] = &[
    relaxation_length::EFFECT,
    quadratic_damper::EFFECT,
    added_inertia::EFFECT,
    play::EFFECT,
    sensor_delay::EFFECT,
    sensor_lag::EFFECT,
    sensor_bias::EFFECT,
    sensor_drift::EFFECT,
    sensor_gain::EFFECT,
    sensor_nonlinearity::EFFECT,
    cross_talk::EFFECT,
    quantisation::EFFECT,
    saturation::EFFECT,
    supply_sag::EFFECT,
    clock_drift::EFFECT,
    mains_hum::EFFECT,
    coulomb_friction::EFFECT,
    progressive_spring::EFFECT,
    asymmetric_spring::EFFECT,
    viscous_drag::EFFECT,
    bouc_wen::EFFECT,
];

/// The effect with this id.
pub fn find(id: &str) -> Option<&'static Effect> {
    EFFECTS.iter().find(|e| e.id == id)
}
