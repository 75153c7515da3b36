//! `abs-controller`: a rule-based anti-lock controller for one to four wheels, with a reference speed
//! of its own.
//!
//! Mack (2009) used a manufacturer's controller and gives no thresholds: rules and values here are
//! placeholders, and all values are parameters. The vehicle's true speed is no input.

mod reference;
mod wheel;

use self::reference::{Limits, Reference, Wheels};
use self::wheel::{Event, PHASES, Phase, Thresholds, Wheel};
use crate::model::{
    Access, Model, Table, boolean_parameter, input, integer_parameter, local, output, parameter,
};
use crate::{Error, Result, boolean, integer, real};
use serde::{Deserialize, Serialize};

/// A communication point this close before a sample, in samples, is the sample.
const SAMPLE_TOLERANCE: f64 = 1e-6;

/// The model: inputs, parameters, wheels and reference speed.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct AbsController {
    count: i32,
    select_low: bool,
    radii: [f64; 4],
    wheel_speeds: [f64; 4],
    driver_pressure: f64,
    thresholds: Thresholds,
    limits: Limits,
    activation_pressure: f64,
    switch_off_speed: f64,
    sample_time: f64,
    wheels: [Wheel; 4],
    reference: Reference,
}

impl Model for AbsController {
    const NAME: &'static str = "abs-controller";
    const DESCRIPTION: &'static str = "Rule-based anti-lock brake controller for one to four wheels: wheel speeds and the driver's pressure in, openings of the valves out";
    const STOP_TIME: f64 = 5.0;
    const DOCUMENTATION: &'static [&'static str] = &[include_str!("documentation.html")];
    fn variables() -> Table<Self> {
        Table::new([
        input("wheel_speed_1", "rad/s", real!(wheel_speeds[0]), 0.0, "Spin speed of wheel 1, positive forward; not used where wheels is less").range(-1e4, 1e4),
        input("wheel_speed_2", "rad/s", real!(wheel_speeds[1]), 0.0, "Spin speed of wheel 2, positive forward; not used where wheels is less").range(-1e4, 1e4),
        input("wheel_speed_3", "rad/s", real!(wheel_speeds[2]), 0.0, "Spin speed of wheel 3, positive forward; not used where wheels is less").range(-1e4, 1e4),
        input("wheel_speed_4", "rad/s", real!(wheel_speeds[3]), 0.0, "Spin speed of wheel 4, positive forward; not used where wheels is less").range(-1e4, 1e4),
        input("driver_pressure", "Pa", real!(driver_pressure), 0.0, "Pressure in the master cylinder, over ambient").range(-1e7, 1e8),
        output("inlet_valve_1", "1", Access::computed(|m: &Self| m.valves(0)[0]), "Opening of the inlet valve of wheel 1").discrete(),
        output("outlet_valve_1", "1", Access::computed(|m: &Self| m.valves(0)[1]), "Opening of the outlet valve of wheel 1").discrete(),
        output("inlet_valve_2", "1", Access::computed(|m: &Self| m.valves(1)[0]), "Opening of the inlet valve of wheel 2").discrete(),
        output("outlet_valve_2", "1", Access::computed(|m: &Self| m.valves(1)[1]), "Opening of the outlet valve of wheel 2").discrete(),
        output("inlet_valve_3", "1", Access::computed(|m: &Self| m.valves(2)[0]), "Opening of the inlet valve of wheel 3").discrete(),
        output("outlet_valve_3", "1", Access::computed(|m: &Self| m.valves(2)[1]), "Opening of the outlet valve of wheel 3").discrete(),
        output("inlet_valve_4", "1", Access::computed(|m: &Self| m.valves(3)[0]), "Opening of the inlet valve of wheel 4").discrete(),
        output("outlet_valve_4", "1", Access::computed(|m: &Self| m.valves(3)[1]), "Opening of the outlet valve of wheel 4").discrete(),
        output("reference_speed", "m/s", real!(reference.speed), "The controller's own estimate of the vehicle's speed").discrete(),
        output("active", "", Access::computed_boolean(|m: &Self| m.in_use().iter().any(|w| w.phase != Phase::Off)), "True while the brake of at least one wheel is not left to the driver"),
        output("phase_1", "", Access::computed_integer(|m: &Self| m.wheels[0].phase as i32 + 1), "What is being done with wheel 1").items(PHASES),
        output("phase_2", "", Access::computed_integer(|m: &Self| m.wheels[1].phase as i32 + 1), "What is being done with wheel 2").items(PHASES),
        output("phase_3", "", Access::computed_integer(|m: &Self| m.wheels[2].phase as i32 + 1), "What is being done with wheel 3").items(PHASES),
        output("phase_4", "", Access::computed_integer(|m: &Self| m.wheels[3].phase as i32 + 1), "What is being done with wheel 4").items(PHASES),
        output("slip_1", "1", real!(wheels[0].slip), "Brake slip of wheel 1 against the reference speed: 0 rolls, 1 is locked").discrete(),
        output("slip_2", "1", real!(wheels[1].slip), "Brake slip of wheel 2 against the reference speed: 0 rolls, 1 is locked").discrete(),
        output("slip_3", "1", real!(wheels[2].slip), "Brake slip of wheel 3 against the reference speed: 0 rolls, 1 is locked").discrete(),
        output("slip_4", "1", real!(wheels[3].slip), "Brake slip of wheel 4 against the reference speed: 0 rolls, 1 is locked").discrete(),
        output("wheel_acceleration_1", "m/s2", real!(wheels[0].acceleration), "Acceleration of wheel 1 at its circumference, filtered").nominal(10.0).discrete(),
        output("wheel_acceleration_2", "m/s2", real!(wheels[1].acceleration), "Acceleration of wheel 2 at its circumference, filtered").nominal(10.0).discrete(),
        output("wheel_acceleration_3", "m/s2", real!(wheels[2].acceleration), "Acceleration of wheel 3 at its circumference, filtered").nominal(10.0).discrete(),
        output("wheel_acceleration_4", "m/s2", real!(wheels[3].acceleration), "Acceleration of wheel 4 at its circumference, filtered").nominal(10.0).discrete(),
        local("descent_limit", "m/s2", real!(reference.descent), "How fast the reference speed may fall now").discrete(),
        integer_parameter("wheels", integer!(count), 4, "Number of wheels").range(1.0, 4.0),
        boolean_parameter("select_low", boolean!(select_low), false, "Wheels 3 and 4 have one pressure: valves of both do what the wheel needs that is closer to locking. Not used where wheels is less than 4"),
        parameter("rolling_radius_1", "m", real!(radii[0]), 0.325, "Rolling radius of wheel 1 that the controller assumes (r_dyn; placeholder)").range(0.05, 2.0).tunable(),
        parameter("rolling_radius_2", "m", real!(radii[1]), 0.325, "Rolling radius of wheel 2 that the controller assumes (r_dyn; placeholder)").range(0.05, 2.0).tunable(),
        parameter("rolling_radius_3", "m", real!(radii[2]), 0.325, "Rolling radius of wheel 3 that the controller assumes (r_dyn; placeholder)").range(0.05, 2.0).tunable(),
        parameter("rolling_radius_4", "m", real!(radii[3]), 0.325, "Rolling radius of wheel 4 that the controller assumes (r_dyn; placeholder)").range(0.05, 2.0).tunable(),
        parameter("slip_dump", "1", real!(thresholds.slip_dump), 0.13, "Slip above which pressure is dumped if the wheel slows down by more than deceleration_dump (placeholder)").range(0.0, 1.0).tunable(),
        parameter("slip_dump_always", "1", real!(thresholds.slip_dump_always), 0.22, "Slip above which pressure is dumped in any case (placeholder)").range(0.0, 1.0).tunable(),
        parameter("deceleration_dump", "m/s2", real!(thresholds.deceleration_dump), 8.0, "See slip_dump (placeholder)").range(0.0, 1000.0).tunable(),
        parameter("slip_build", "1", real!(thresholds.slip_build), 0.07, "Slip below which a wheel has recovered, if it no longer accelerates (placeholder)").range(0.0, 1.0).tunable(),
        parameter("speed_tolerance", "m/s", real!(thresholds.speed_tolerance), 0.5, "Speed by which a wheel may fall behind in addition to these slips, which leaves room for oscillations at low speed (placeholder)").range(0.0, 10.0).tunable(),
        parameter("acceleration_recovered", "m/s2", real!(thresholds.acceleration_recovered), 2.0, "Acceleration of a wheel below which it no longer recovers: it runs at the vehicle's speed, or does not answer to the pressure (placeholder)").range(0.0, 1000.0).tunable(),
        parameter("acceleration_strong", "m/s2", real!(thresholds.acceleration_strong), 50.0, "Acceleration of a wheel above which pressure is built again before the wheel has recovered, if it will have within lead_time (placeholder)").range(0.0, 1e4).tunable(),
        parameter("lead_time", "s", real!(thresholds.lead_time), 0.015, "How far ahead slip and acceleration of a recovering wheel are extrapolated, against the delays of filter, valves and caliper (placeholder)").range(0.0, 1.0).tunable(),
        parameter("rebuild_per_acceleration", "s3/m", real!(thresholds.rebuild), 1.2e-4, "Time for which the inlet is fully open after a recovery, over the greatest acceleration of the wheel in it, which tells how far the pressure fell (placeholder)").range(0.0, 1.0).tunable(),
        parameter("dump_per_acceleration", "s3/m", real!(thresholds.dump), 2.3e-4, "Time for which the outlet has to be open to raise the acceleration of a wheel, over that acceleration (placeholder)").range(1e-7, 1.0).tunable(),
        parameter("answer_time", "s", real!(thresholds.answer_time), 0.02, "Time constant with which the measured acceleration shows the dumping of pressure: filter and caliper (placeholder)").range(1e-4, 1.0).tunable(),
        parameter("turned_share", "1", real!(thresholds.turned), 0.8, "A wheel whose acceleration has fallen below this share of its greatest in the recovery is back at stable slip (placeholder)").range(0.0, 1.0).tunable(),
        parameter("recovery_time", "s", real!(thresholds.recovery_time), 0.15, "Pressure is dumped until the wheel accelerates so that its slip is below slip_build after this time (placeholder)").range(1e-3, 10.0).tunable(),
        parameter("hold_time", "s", real!(thresholds.hold_time), 0.02, "Shortest recovery (placeholder)").range(0.0, 10.0).tunable(),
        parameter("coast_time", "s", real!(thresholds.coast_time), 0.06, "Dumping without an answer of the wheel for this long means that it runs at the vehicle's speed and the reference speed is too high; five times as long where the wheel may be locked (placeholder)").range(1e-3, 10.0).tunable(),
        parameter("build_opening", "1", real!(thresholds.build_opening), 0.25, "Opening of the inlet valve while pressure is built after a recovery (placeholder)").range(0.0, 1.0).tunable(),
        parameter("build_time", "s", real!(thresholds.build_time), 1.0, "Building for this long without new slip ends the intervention at the wheel (placeholder)").range(1e-2, 100.0).tunable(),
        parameter("acceleration_filter", "s", real!(thresholds.acceleration_filter), 0.015, "Time constant of the filter on the acceleration of wheels (placeholder)").range(0.0, 1.0).tunable(),
        parameter("reference_ascent", "m/s2", real!(limits.ascent), 30.0, "Fastest rise of the reference speed (placeholder)").range(1.0, 1e4).tunable(),
        parameter("descent_max", "m/s2", real!(limits.descent_max), 13.0, "Fastest fall of the reference speed: more than any vehicle's deceleration (placeholder)").range(0.1, 1000.0).tunable(),
        parameter("descent_min", "m/s2", real!(limits.descent_min), 2.0, "Least value of the limit on the fall of the reference speed (placeholder)").range(0.1, 1000.0).tunable(),
        parameter("descent_growth", "m/s3", real!(limits.descent_growth), 25.0, "Growth of that limit while a wheel is trusted (placeholder)").range(0.0, 1e5).tunable(),
        parameter("descent_margin", "1", real!(limits.descent_margin), 1.2, "That limit over the deceleration between the speeds to which wheels recovered (placeholder)").range(1.0, 10.0).tunable(),
        parameter("descent_per_pressure", "m/(s2.Pa)", real!(limits.descent_per_pressure), 3.3e-6, "Most that the driver's pressure adds to descent_min: more than the vehicle's deceleration over pressure (placeholder)").range(0.0, 1.0).tunable(),
        parameter("activation_pressure", "Pa", real!(activation_pressure), 2e5, "Driver's pressure below which there is no intervention (placeholder)").range(0.0, 1e8).tunable(),
        parameter("switch_off_speed", "m/s", real!(switch_off_speed), 2.5, "Reference speed below which there is no intervention (placeholder)").range(0.1, 100.0).tunable(),
        parameter("sample_time", "s", real!(sample_time), 5e-3, "Time between two decisions: the step of the model's own time grid (placeholder)").range(1e-4, 0.1),
    ])
    }

    fn step_size(&self) -> f64 {
        self.sample_time
    }

    fn initialize(&mut self) -> Result<()> {
        self.check_order()?;
        self.wheels = [Wheel::new(0.0); 4];
        for index in 0..self.used() {
            self.wheels[index] = Wheel::new(self.speed(index));
        }
        self.reference = Reference::new(self.fastest());
        for index in 0..self.used() {
            self.wheels[index].slip_against(self.reference.speed);
        }
        Ok(())
    }

    fn tune(&mut self) -> Result<()> {
        self.check_order()
    }

    fn check(&self) -> Result<()> {
        self.check_order()?;
        let speeds = self.wheels.iter().all(|w| w.is_finite()) && self.reference.is_finite();
        if speeds { Ok(()) } else { Err(Error::numeric("speeds and times have to be finite")) }
    }

    fn step(&mut self, length: f64) -> Result<()> {
        // between two samples the valves stay as they are
        if length < (1.0 - SAMPLE_TOLERANCE) * self.sample_time {
            return Ok(());
        }
        for index in 0..self.used() {
            let speed = self.speed(index);
            self.wheels[index].measure(speed, self.thresholds.acceleration_filter, self.sample_time);
        }
        let braked = self.driver_pressure >= self.activation_pressure;
        let doing = if !braked {
            Wheels::Free
        } else if self.in_use().iter().all(Wheel::recovers) {
            Wheels::Recovering
        } else {
            Wheels::Trusted
        };
        self.reference.update(self.fastest(), doing, self.driver_pressure, &self.limits, self.sample_time);
        let intervene = braked && self.reference.speed >= self.switch_off_speed;
        for index in 0..self.used() {
            self.decide(index, intervene);
        }
        Ok(())
    }
}

impl AbsController {
    /// Fails unless thresholds are in the order that the rules need.
    fn check_order(&self) -> Result<()> {
        let Thresholds { slip_build, slip_dump, slip_dump_always, .. } = self.thresholds;
        if slip_build > slip_dump || slip_dump > slip_dump_always {
            return Err(Error::variable(format!(
                "slip_build = {slip_build}, slip_dump = {slip_dump}, slip_dump_always = {slip_dump_always}: they have to be in this order"
            )));
        }
        let Limits { descent_min, descent_max, .. } = self.limits;
        if descent_min > descent_max {
            return Err(Error::variable(format!(
                "descent_min = {descent_min} m/s2 is above descent_max = {descent_max} m/s2"
            )));
        }
        Ok(())
    }

    /// Openings of the inlet and outlet valve of a wheel.
    fn valves(&self, index: usize) -> [f64; 2] {
        let of = |index: usize| [self.wheels[index].inlet, self.wheels[index].outlet()];
        if !self.select_low || self.used() < 4 || index < 2 {
            return of(index);
        }
        let [[inlet, outlet], [other_inlet, other_outlet]] = [of(2), of(3)];
        [inlet.min(other_inlet), outlet.max(other_outlet)]
    }

    fn used(&self) -> usize {
        self.count.clamp(1, 4) as usize
    }

    fn in_use(&self) -> &[Wheel] {
        &self.wheels[..self.used()]
    }

    fn speed(&self, index: usize) -> f64 {
        self.wheel_speeds[index] * self.radii[index]
    }

    fn fastest(&self) -> f64 {
        self.in_use().iter().fold(0.0, |fastest, wheel| wheel.speed.max(fastest))
    }

    /// Lets a wheel decide, and the reference hear of it.
    fn decide(&mut self, index: usize, intervene: bool) {
        let fastest = self.fastest();
        let descent = self.limits.descent_cap(self.driver_pressure);
        let wheel = &mut self.wheels[index];
        wheel.slip_against(self.reference.speed);
        if !intervene {
            wheel.release();
            return;
        }
        match wheel.decide(self.reference.speed, descent, &self.thresholds, self.sample_time) {
            Some(Event::Slips) => self.reference.slip_begins(),
            Some(Event::Recovered) => self.reference.wheel_recovered(&self.limits),
            Some(Event::Coasts) if wheel.speed >= fastest => self.reference.correct(fastest, &self.limits),
            Some(Event::Coasts) | None => {}
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::{Native, Settings, Slave};

    type Controller = Native<AbsController>;

    fn start(values: &[(&str, f64)]) -> Controller {
        let mut controller = Controller::new(&Settings::default()).unwrap();
        for (name, value) in values {
            let index = controller.find(name).unwrap();
            controller.set(index, *value).unwrap();
        }
        controller.start(0.0, None).unwrap();
        controller.finish_start().unwrap();
        controller
    }

    /// All outputs after every sample of a wheel that brakes, slips and recovers, and its least valve opening.
    fn run(per_sample: u32) -> (Vec<Vec<f64>>, usize) {
        let mut controller = start(&[("wheels", 1.0), ("wheel_speed_1", 60.0), ("driver_pressure", 1e7)]);
        let outputs: Vec<usize> = controller.interface().with(crate::model::Causality::Output).collect();
        let input = controller.find("wheel_speed_1").unwrap();
        let dump = controller.find("outlet_valve_1").unwrap();
        let length = 5e-3 / f64::from(per_sample);
        let (mut seen, mut held): (Vec<Vec<f64>>, usize) = (Vec::new(), 0);
        for k in 0..100 * per_sample {
            let time = f64::from(k) * length;
            let at = (f64::from(k / per_sample) + 1.0) * 5e-3;
            let speed = if at < 0.15 {
                60.0 - 3.0 * at
            } else {
                60.0 - 30.0 * libm::sin(20.0 * (at - 0.15)).max(0.0)
            };
            controller.set(input, speed).unwrap();
            controller.step(time, length).unwrap();
            let now: Vec<f64> = outputs.iter().map(|o| controller.get(*o).unwrap()).collect();
            if (k + 1) % per_sample == 0 {
                seen.push(now);
            } else if let Some(last) = seen.last() {
                // between samples, whatever the wheel does, nothing changes
                assert_eq!(&now, last);
                held += usize::from(controller.get(dump).unwrap() > 0.0);
            }
        }
        (seen, held)
    }

    #[test]
    fn outputs_are_held_between_samples_and_do_not_depend_on_the_communication_step() {
        let (whole, _) = run(1);
        let (parts, held) = run(5);
        assert!(held > 0, "it has to dump to show anything");
        assert_eq!(whole, parts);
    }

    #[test]
    fn wheels_that_are_not_there_have_their_valves_at_rest() {
        let mut controller = start(&[("wheels", 2.0), ("wheel_speed_1", 50.0), ("wheel_speed_2", 50.0)]);
        for k in 0..20 {
            controller.step(0.05 * f64::from(k), 0.05).unwrap();
        }
        for (name, expected) in [
            ("inlet_valve_3", 1.0),
            ("outlet_valve_4", 0.0),
            ("slip_3", 0.0),
            ("phase_4", 1.0),
            ("reference_speed", 16.25),
        ] {
            let index = controller.find(name).unwrap();
            assert_eq!(controller.get(index).unwrap(), expected, "{name}");
        }
    }

    /// Right behind slips, left behind does not: both lines get what the right one needs, with select-low, and its own one without.
    #[test]
    fn wheels_behind_share_the_pressure_of_the_one_that_slips() {
        for (select_low, with_it) in [(1.0, 1.0), (0.0, 0.0)] {
            let speeds = [1, 2, 3, 4].map(|i| format!("wheel_speed_{i}"));
            let mut values: Vec<(&str, f64)> = speeds.iter().map(|name| (name.as_str(), 60.0)).collect();
            values.extend([("select_low", select_low), ("driver_pressure", 1e7)]);
            let mut controller = start(&values);
            let mut dumped = [0.0_f64; 4];
            for k in 0..40 {
                let time = 5e-3 * f64::from(k);
                for (i, name) in speeds.iter().enumerate() {
                    let lost = if i == 3 && k > 5 { 2.0 * f64::from(k - 5) } else { 0.0 };
                    let index = controller.find(name).unwrap();
                    controller.set(index, 60.0 - 3.0 * time - lost.min(30.0)).unwrap();
                }
                controller.step(time, 5e-3).unwrap();
                for (i, most) in dumped.iter_mut().enumerate() {
                    let outlet = controller.find(&format!("outlet_valve_{}", i + 1)).unwrap();
                    *most = most.max(controller.get(outlet).unwrap());
                }
            }
            assert_eq!(dumped, [0.0, 0.0, with_it, 1.0]);
        }
    }

    #[test]
    fn thresholds_in_the_wrong_order_are_refused() {
        let mut controller = Controller::new(&Settings::default()).unwrap();
        let index = controller.find("slip_build").unwrap();
        controller.set(index, 0.2).unwrap();
        let error = controller.start(0.0, None).and_then(|()| controller.finish_start()).unwrap_err();
        assert!(error.to_string().contains("slip_dump"), "{error}");
    }
}
