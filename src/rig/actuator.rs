//! How a command becomes a motion with a velocity.
//!
//! A command that is held between communication points is a staircase, and a stiff tire answers to
//! every stair. So a held command moves an actuator: a critically damped second-order filter, whose
//! position and velocity are continuous. A command that comes with its rate is followed exactly.

use crate::solver::Real;
use serde::{Deserialize, Serialize};

/// What the master asks for.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct Command {
    /// The value now.
    pub value: f64,
    /// Its rate, where the master gave one.
    pub rate: Option<f64>,
}

/// What the rig does.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct Actuator {
    /// Position, in the command's unit.
    pub position: f64,
    /// Velocity.
    pub velocity: f64,
}

impl Actuator {
    /// At rest where the command is.
    pub fn at_rest(command: &Command) -> Self {
        Self { position: command.value, velocity: 0.0 }
    }

    /// Advances by `dt` towards a command that is held, or onto one that has a rate. `frequency` is
    /// the filter's corner \[rad/s\]; its steps are exact for a held command, so any `dt` is stable.
    pub fn follow(&mut self, command: &Command, frequency: f64, dt: f64) {
        if let Some(rate) = command.rate {
            *self = Self { position: command.value, velocity: rate };
            return;
        }
        let decay = Real::exp(-frequency * dt);
        let error = self.position - command.value;
        let slope = self.velocity + frequency * error;
        self.position = command.value + (error + slope * dt) * decay;
        self.velocity = (self.velocity - frequency * slope * dt) * decay;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_held_step_is_followed_with_the_textbook_response_in_any_partition() {
        let (omega, time) = (50.0, 0.03_f64);
        let command = Command { value: 2.0, rate: None };
        let expected = 2.0 * (1.0 - (1.0 + omega * time) * (-omega * time).exp());
        for parts in [1, 7, 1000] {
            let mut actuator = Actuator::default();
            for _ in 0..parts {
                actuator.follow(&command, omega, time / f64::from(parts));
            }
            assert!((actuator.position - expected).abs() < 1e-12, "{parts}: {actuator:?}");
        }
    }

    #[test]
    fn a_rate_is_followed_without_delay_and_left_without_a_jump() {
        let mut actuator = Actuator::default();
        actuator.follow(&Command { value: 1.0, rate: Some(3.0) }, 50.0, 1e-3);
        assert_eq!(actuator, Actuator { position: 1.0, velocity: 3.0 });
        let before = actuator;
        actuator.follow(&Command { value: 1.0, rate: None }, 50.0, 1e-6);
        assert!((actuator.position - before.position).abs() < 1e-5);
        assert!((actuator.velocity - before.velocity).abs() < 1e-3);
    }
}
