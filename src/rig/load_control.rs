//! How a rig holds the vertical force: by its deflection.

use super::Command;
use crate::model::{Purpose, Table, boolean_parameter, input, parameter};
use crate::{Error, Result, boolean, real};
use serde::{Deserialize, Serialize};

/// Where a rig can hold the deflection \[m\].
pub const DEFLECTIONS: [f64; 2] = [-0.2, 0.1];

/// A controller that commands the deflection for which the tire carries a load: d' = gain (load - force).
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct LoadControl {
    /// False: the deflection is what the master commands.
    pub on: bool,
    /// The vertical force on the rim that is wanted \[N\].
    pub load: f64,
    /// Speed of the deflection per missing force \[m/(N.s)\].
    gain: f64,
    /// The commanded deflection \[m\].
    deflection: f64,
}

impl LoadControl {
    /// The load as an input, the switch and the gain.
    #[rustfmt::skip] // a row is a line
    pub(super) fn rows() -> Table<Self> {
        Table::new([
            input("load", "N", real!(load), 4000.0, "Vertical force on the rim that is held with load_control; without it nothing depends on it").range(0.0, 1e5),
            boolean_parameter("load_control", boolean!(on), false, "What the rig holds: false, the deflection; true, the vertical force on the rim: deflection is then of no account, the start is the stationary state at that load, and afterwards a controller moves the rim up and down"),
            parameter("load_control_gain", "m/(N.s)", real!(gain), 1e-4, "Speed of the commanded deflection per missing force. Times the vertical stiffness of the tire it is the corner of the control in rad/s: 20 for 200 N/mm; it oscillates where that comes near half the corner of the actuators").range(0.0, 1e-3).purpose(Purpose::Data),
        ])
    }

    /// At rest where the tire carries the load.
    ///
    /// # Errors
    /// The rig does not reach that deflection.
    pub fn rest(&mut self, deflection: f64) -> Result<Command> {
        self.deflection = deflection;
        self.command(0.0)
    }

    /// The deflection that it commands at the end of a step of `dt` seconds, at whose beginning the vertical force was `force`
    /// \[N\].
    ///
    /// # Errors
    /// The rig does not reach that deflection.
    pub fn follow(&mut self, force: f64, dt: f64) -> Result<Command> {
        let rate = self.gain * (self.load - force);
        self.deflection += rate * dt;
        self.command(rate)
    }

    fn command(&self, rate: f64) -> Result<Command> {
        let [least, most] = DEFLECTIONS;
        if (least..=most).contains(&self.deflection) {
            return Ok(Command { value: self.deflection, rate: Some(rate) });
        }
        Err(Error::numeric(format!(
            "load_control: {} N would need a deflection of {:.4} m, and the rig reaches {least} to {most} m: change load, or hold the deflection",
            self.load, self.deflection
        )))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// On a spring without mass the force is missing as exp(-gain c t), to first order in the step.
    #[test]
    fn a_spring_takes_the_load_with_the_corner_of_gain_times_stiffness() {
        let (gain, stiffness, time) = (1e-4, 2e5, 0.05_f64);
        let missing = |steps: u32| {
            let mut control = LoadControl { on: true, load: 3000.0, gain, deflection: 0.01 };
            let mut force = stiffness * 0.01;
            for _ in 0..steps {
                force = stiffness * control.follow(force, time / f64::from(steps)).unwrap().value;
            }
            3000.0 - force
        };
        let exact = 1000.0 * (-gain * stiffness * time).exp();
        let [coarse, fine] = [50, 100].map(|n| missing(n) - exact);
        assert!(fine.abs() < 2.0 && (coarse / fine - 2.0).abs() < 0.05, "{coarse} {fine}");
    }

    #[test]
    fn what_the_rig_does_not_reach_is_an_error() {
        let mut control = LoadControl { on: true, load: 1e5, gain: 1e-4, deflection: 0.0 };
        let refused = (0..100).find_map(|_| control.follow(0.0, 1e-3).err()).unwrap().to_string();
        assert!(refused.contains("100000 N") && refused.contains("0.1 m"), "{refused}");
    }
}
