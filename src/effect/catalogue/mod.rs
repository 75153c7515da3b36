//! The catalogue: one file per effect.

mod coulomb_friction;
mod relaxation_length;
mod sensor_delay;

use super::Effect;

/// All effects, in the order in which they are shown.
pub const EFFECTS: &[Effect] = &[relaxation_length::EFFECT, coulomb_friction::EFFECT, sensor_delay::EFFECT];

/// The effect with this id.
pub fn find(id: &str) -> Option<&'static Effect> {
    EFFECTS.iter().find(|e| e.id == id)
}
