//! A pneumatic cylinder whose seals do not rub.

use latsch::model::{Model, Table, input, output, parameter};
use latsch::{Result, real};
use serde::{Deserialize, Serialize};

/// F = p A, however the rod moves.
#[derive(Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct PneumaticCylinder {
    area: f64,
    pressure: f64,
    velocity: f64,
    position: f64,
    force: f64,
}

impl Model for PneumaticCylinder {
    const NAME: &'static str = "pneumatic-cylinder";
    const DESCRIPTION: &'static str =
        "A pneumatic cylinder with its pressure on one side: pressure times area";
    fn variables() -> Table<Self> {
        Table::new([
            parameter("area", "m2", real!(area), 4.9e-4, "Area of the piston")
                .range(1e-6, 1.0)
                .nominal(4.9e-4),
            input("pressure", "Pa", real!(pressure), 0.0, "Pressure in the cylinder above the ambient")
                .nominal(5e5),
            input(
                "velocity",
                "m/s",
                real!(velocity),
                0.0,
                "Velocity of the rod, outwards, without effect on the force",
            )
            .nominal(0.01),
            input(
                "position",
                "m",
                real!(position),
                0.0,
                "Position of the rod, outwards, without effect on the force",
            )
            .nominal(0.01),
            output("force", "N", real!(force), "Force of the rod on what it pushes"),
        ])
    }
    const COMMUNICATION_STEP: f64 = 0.01;
    const STOP_TIME: f64 = 20.0;

    fn step_size(&self) -> f64 {
        0.01
    }

    fn initialize(&mut self) -> Result<()> {
        self.force = self.pressure * self.area;
        Ok(())
    }

    fn step(&mut self, _length: f64) -> Result<()> {
        self.force = self.pressure * self.area;
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use latsch::model::{Native, Settings, Slave};

    #[test]
    fn the_force_is_pressure_times_area() {
        let mut cylinder = Native::<PneumaticCylinder>::new(&Settings::default()).unwrap();
        let [area, pressure, velocity, force] =
            ["area", "pressure", "velocity", "force"].map(|name| cylinder.interface().find(name).unwrap());
        // 25 mm bore
        cylinder.set(area, std::f64::consts::FRAC_PI_4 * 0.025 * 0.025).unwrap();
        cylinder.set(pressure, 1e5).unwrap();
        cylinder.start(0.0, None).unwrap();
        cylinder.finish_start().unwrap();
        assert!((cylinder.get(force).unwrap() - 49.087_385).abs() < 1e-6);
        cylinder.set(velocity, 0.02).unwrap();
        cylinder.set_rate(pressure, 2e6).unwrap();
        cylinder.step(0.0, 0.25).unwrap();
        assert!(
            (cylinder.get(force).unwrap() - 6.0 * 49.087_385).abs() < 1e-5,
            "6 bar at the end of the step"
        );
    }
}
