//! Two tanks, one above the other, that never run over.

use crate::rk4::rk4;
use latsch::model::{Model, Table, input, output, parameter};
use latsch::{Result, real};
use serde::{Deserialize, Serialize};

/// h1' = k u - a1 sqrt(h1), h2' = a1 sqrt(h1) - a2 sqrt(h2): Torricelli. Levels are in volts of the level sensor of the lower
/// tank, as the recordings have them; the upper tank has the same cross-section.
#[derive(Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct CascadedTanks {
    pump: f64,
    upper_outlet: f64,
    lower_outlet: f64,
    initial_upper: f64,
    initial_lower: f64,
    pump_voltage: f64,
    upper_level: f64,
    lower_level: f64,
}

impl CascadedTanks {
    fn slope(&self, [upper, lower]: [f64; 2]) -> [f64; 2] {
        let between = self.upper_outlet * upper.max(0.0).sqrt();
        [self.pump * self.pump_voltage - between, between - self.lower_outlet * lower.max(0.0).sqrt()]
    }
}

impl Model for CascadedTanks {
    const NAME: &'static str = "cascaded-tanks";
    const DESCRIPTION: &'static str =
        "Two tanks, one above the other, filled by a pump and emptied by outlets";
    fn variables() -> Table<Self> {
        Table::new([
            parameter("pump", "1/s", real!(pump), 0.05, "Rise of the upper level by the pump's voltage")
                .range(1e-4, 1.0),
            parameter(
                "upper_outlet",
                "V/s",
                real!(upper_outlet),
                0.05,
                "Outlet of the upper tank, level per second at a level of 1 V",
            )
            .range(1e-4, 1.0),
            parameter("lower_outlet", "V/s", real!(lower_outlet), 0.05, "Outlet of the lower tank, likewise")
                .range(1e-4, 1.0),
            parameter(
                "initial_upper",
                "V",
                real!(initial_upper),
                5.0,
                "Level of the upper tank at the start",
            )
            .range(0.0, 15.0),
            parameter(
                "initial_lower",
                "V",
                real!(initial_lower),
                5.0,
                "Level of the lower tank at the start",
            )
            .range(0.0, 15.0),
            input("pump_voltage", "V", real!(pump_voltage), 0.0, "Voltage of the pump"),
            output("upper_level", "V", real!(upper_level), "Level of the upper tank").nominal(5.0),
            output("lower_level", "V", real!(lower_level), "Level of the lower tank").nominal(5.0),
        ])
    }
    const COMMUNICATION_STEP: f64 = 4.0;
    const STOP_TIME: f64 = 4096.0;

    fn step_size(&self) -> f64 {
        1.0
    }

    fn initialize(&mut self) -> Result<()> {
        (self.upper_level, self.lower_level) = (self.initial_upper, self.initial_lower);
        Ok(())
    }

    fn step(&mut self, length: f64) -> Result<()> {
        let levels = rk4([self.upper_level, self.lower_level], length, |x| self.slope(x));
        [self.upper_level, self.lower_level] = levels.map(|level| level.max(0.0));
        Ok(())
    }
}
