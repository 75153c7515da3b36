//! What an unloaded instrumented belt should measure: always the same.

use latsch::model::{Model, Table, input, output, parameter};
use latsch::{Result, real};
use serde::{Deserialize, Serialize};

/// M = const, whatever the belt does.
#[derive(Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct ConstantMoment {
    moment: f64,
    belt_speed: f64,
    pitch_moment: f64,
}

impl Model for ConstantMoment {
    const NAME: &'static str = "constant-moment";
    const DESCRIPTION: &'static str = "The pitch moment of an instrumented belt without a load on it";
    fn variables() -> Table<Self> {
        Table::new([
            parameter("moment", "N.m", real!(moment), 0.0, "Zero of the load cells")
                .range(-1e3, 1e3)
                .nominal(1.0),
            input(
                "belt_speed",
                "m/s",
                real!(belt_speed),
                0.0,
                "Speed of the belt, without effect on the moment",
            ),
            output("pitch_moment", "N.m", real!(pitch_moment), "Pitch moment that the load cells measure"),
        ])
    }
    const COMMUNICATION_STEP: f64 = 2.5e-3;
    const STOP_TIME: f64 = 60.0;

    fn step_size(&self) -> f64 {
        2.5e-3
    }

    fn initialize(&mut self) -> Result<()> {
        self.pitch_moment = self.moment;
        Ok(())
    }

    fn tune(&mut self) -> Result<()> {
        self.initialize()
    }

    fn step(&mut self, _length: f64) -> Result<()> {
        self.pitch_moment = self.moment;
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use latsch::model::{Native, Settings, Slave};

    #[test]
    fn the_belts_speed_has_no_effect() {
        let mut belt = Native::<ConstantMoment>::new(&Settings::default()).unwrap();
        let [moment, speed, measured] =
            ["moment", "belt_speed", "pitch_moment"].map(|name| belt.interface().find(name).unwrap());
        belt.set(moment, -0.3).unwrap();
        belt.start(0.0, None).unwrap();
        belt.finish_start().unwrap();
        assert_eq!(belt.get(measured).unwrap(), -0.3);
        belt.set(speed, 2.0).unwrap();
        belt.set_rate(speed, 5.0).unwrap();
        belt.step(0.0, 0.1).unwrap();
        assert_eq!(belt.get(measured).unwrap(), -0.3);
    }
}
