//! How a command becomes a motion with a velocity.
//!
//! A rig does not jump to where it is told to be: its actuator is a critically damped second-order
//! filter. It is physics, and so it stands between command and motion whether the master holds the
//! command between communication points or says how it goes on: both ways give the same motion as the
//! communication step goes to 0. Where the commands *are* the motion, as in a recording of what the
//! rig did, the actuator is switched off, again for both.

use crate::model::{Table, boolean_parameter, parameter};
use crate::solver::Real;
use crate::{boolean, real};
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

/// How the actuators of a rig follow their commands.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct Actuation {
    /// False: there is no actuator, and the commands are the motion.
    pub on: bool,
    /// Corner of the filter \[rad/s\].
    pub frequency: f64,
}

impl Actuation {
    /// The filter and its switch.
    #[rustfmt::skip] // a row is a line
    pub(super) fn rows() -> Table<Self> {
        Table::new([
            parameter("actuator_frequency", "rad/s", real!(frequency), 200.0, "Corner of the critically damped filter between commands and motion; its delay is 2 over this").range(1.0, 1e5).tunable(),
            boolean_parameter("command_actuators", boolean!(on), true, "Actuators between commands and motion: true, whether commands come with derivatives or not; false, the commands are the motion, as in a recording of what the rig did"),
        ])
    }

    /// The filter's corner \[rad/s\], if there is a filter.
    pub fn corner(&self) -> Option<f64> {
        self.on.then_some(self.frequency)
    }
}

impl Actuator {
    /// At rest where the command is.
    pub fn at_rest(command: &Command) -> Self {
        Self { position: command.value, velocity: 0.0 }
    }

    /// Advances by `dt` towards a command, which has its value at the end of the step and got there
    /// with its rate (0 where it has none).
    ///
    /// With a `corner` w \[rad/s\]: q'' + 2 w q' + w² (q - u) = 0. The step is the exact solution for a
    /// command that runs straight, so any `dt` is stable. Without one the motion is the command; where
    /// the command jumped and has no rate, the velocity is that of the jump, in this step only.
    pub fn follow(&mut self, command: &Command, corner: Option<f64>, dt: f64) {
        let Some(corner) = corner else {
            let jump = if dt > 0.0 { (command.value - self.position) / dt } else { 0.0 };
            *self = Self { position: command.value, velocity: command.rate.unwrap_or(jump) };
            return;
        };
        // against a command that runs straight the filter ends up behind by 2 rate / corner
        let rate = command.rate.unwrap_or(0.0);
        let behind = 2.0 * rate / corner;
        let decay = Real::exp(-corner * dt);
        let error = self.position - (command.value - rate * dt - behind);
        let slope = self.velocity - rate + corner * error;
        self.position = command.value - behind + (error + slope * dt) * decay;
        self.velocity = rate + (self.velocity - rate - corner * slope * dt) * decay;
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
                actuator.follow(&command, Some(omega), time / f64::from(parts));
            }
            assert!((actuator.position - expected).abs() < 1e-12, "{parts}: {actuator:?}");
        }
    }

    /// q'' + 2 w q' + w² q = w² r t from rest: q = r (t - 2/w + (t + 2/w) exp(-w t)).
    #[test]
    fn a_ramp_is_followed_with_the_textbook_response_in_any_partition() {
        let (omega, time, rate) = (50.0, 0.03_f64, 3.0);
        let decay = (-omega * time).exp();
        let expected = rate * (time - 2.0 / omega + (time + 2.0 / omega) * decay);
        let velocity = rate * (1.0 - (1.0 + omega * time) * decay);
        for parts in [1, 7, 1000] {
            let mut actuator = Actuator::default();
            for k in 1..=parts {
                let value = rate * time * f64::from(k) / f64::from(parts);
                actuator.follow(&Command { value, rate: Some(rate) }, Some(omega), time / f64::from(parts));
            }
            assert!((actuator.position - expected).abs() < 1e-12, "{parts}: {actuator:?}");
            assert!((actuator.velocity - velocity).abs() < 1e-11, "{parts}: {actuator:?}");
        }
    }

    #[test]
    fn switched_off_the_command_is_the_motion_and_a_jump_has_the_velocity_that_makes_it() {
        let mut actuator = Actuator::default();
        actuator.follow(&Command { value: 1.0, rate: Some(3.0) }, None, 1e-3);
        assert_eq!(actuator, Actuator { position: 1.0, velocity: 3.0 });
        actuator.follow(&Command { value: 1.5, rate: None }, None, 1e-3);
        assert_eq!(actuator, Actuator { position: 1.5, velocity: 500.0 });
        actuator.follow(&Command { value: 1.5, rate: None }, None, 1e-3);
        assert_eq!(actuator, Actuator { position: 1.5, velocity: 0.0 });
    }
}
