//! The rack with its column.

use super::super::Actuator;
use crate::mechanics::{SpringDamper, drift, kick};
use crate::model::{Purpose, Role, Table, parameter};
use crate::real;
use serde::{Deserialize, Serialize};

/// Rack, column and driver.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct RackParameters {
    pub mass: f64,
    ratio: f64,
    column: SpringDamper,
    friction: f64,
    friction_stiffness: f64,
}

impl RackParameters {
    #[rustfmt::skip] // a row is a line
    pub fn rows() -> Table<Self> {
        Table::new([
            parameter("rack_mass", "kg", real!(mass), 4.0, "Mass of rack, column and steering wheel at the rack, as far as they move against the body: as of what turns").range(0.1, 1e3),
            parameter("rack_ratio", "m/rad", real!(ratio), 0.0085, "Way of the rack over the angle of the steering wheel").range(1e-4, 1.0).purpose(Purpose::Data),
            parameter("column_stiffness", "N/m", real!(column.stiffness), 0.6e6, "Stiffness of column, steering wheel and the driver's arms, at the rack").range(0.0, 1e9).role(Role::Stiffness).tunable(),
            parameter("column_damping", "N.s/m", real!(column.damping), 2300.0, "Damping of that, at the rack").range(0.0, 1e6).tunable(),
            parameter("rack_friction", "N", real!(friction), 0.0, "Friction of the rack").range(0.0, 1e5).tunable(),
            parameter("rack_friction_stiffness", "N/m", real!(friction_stiffness), 1e6, "Stiffness of the rack before its friction slips").range(1.0, 1e9).role(Role::Stiffness),
        ])
    }
}

/// The rack against the body, to the left.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct Rack {
    /// \[m\]
    pub way: f64,
    /// \[m/s\]
    pub speed: f64,
    pub acceleration: f64,
    /// What holds it where the vehicle stands \[N\].
    pub preload: f64,
    /// Force of its friction, and where it was when that was found.
    friction: f64,
    from: f64,
    /// Force of column and driver on it \[N\].
    pub column: f64,
}

impl Rack {
    /// First half of a step; returns the speed predicted for its end.
    pub fn drift(&mut self, dt: f64) -> f64 {
        let step = drift(self.speed, self.acceleration, dt);
        self.speed = step.velocity;
        self.way += step.travel;
        step.predicted
    }

    /// Second half.
    pub fn kick(&mut self, dt: f64) {
        self.speed = kick(self.speed, self.acceleration, dt);
    }

    /// Takes over what acts on a rack that moves so, with tie rods that pull to the left; `arm` is positive if they are before the
    /// axle. Returns the power that friction and the column's damper take \[W\].
    pub fn load(
        &mut self,
        p: &RackParameters,
        steered: Actuator,
        arm: f64,
        speed: f64,
        tie_rods: f64,
    ) -> f64 {
        let [way, rate] = p.wanted(steered, arm);
        self.column = self.preload + p.column.force(way - self.way, rate - speed);
        let held = self.friction - p.friction_stiffness * (self.way - self.from);
        (self.friction, self.from) = (held.clamp(-p.friction, p.friction), self.way);
        self.acceleration = (tie_rods + self.column + self.friction) / p.mass;
        let slips = if self.friction == held { 0.0 } else { -self.friction * speed };
        p.column.power_loss(rate - speed) + slips
    }

    /// Energy of its motion and springs beyond that where the vehicle stands \[J\].
    pub fn energy(&self, p: &RackParameters, steered: Actuator, arm: f64) -> f64 {
        0.5 * p.mass * self.speed * self.speed + p.column.energy(p.wanted(steered, arm)[0] - self.way)
            - self.preload * self.way
            + 0.5 * self.friction * self.friction / p.friction_stiffness
    }
}

impl RackParameters {
    /// Where column and driver would have the rack, and how fast they move that.
    fn wanted(&self, steered: Actuator, arm: f64) -> [f64; 2] {
        // a rack before the axle goes to the left to turn left
        let ratio = self.ratio.copysign(arm);
        [ratio * steered.position, ratio * steered.velocity]
    }
}
