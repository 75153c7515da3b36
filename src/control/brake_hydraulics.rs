//! `brake-hydraulics`: valves, line, caliper and pads of one wheel brake.
//!
//! Mack (2009) gives equations (6.32) to (6.34) and the shape of the pads' friction over time; rates
//! of valves, lags and sizes are placeholders of sports-car size, and all are parameters. Between
//! changes of the inputs the pressures are known in closed form, so a step of any length is exact.

use crate::model::{Access, Model, Table, input, output, parameter};
use crate::solver::Real;
use crate::{Error, Result, real};
use serde::{Deserialize, Serialize};

/// Halvings of an interval to the last bit of a double.
const HALVINGS: usize = 60;

/// The model: inputs, parameters, pressures and how long the pads have been in contact.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct BrakeHydraulics {
    driver_pressure: f64,
    inlet_valve: f64,
    outlet_valve: f64,
    parameters: Parameters,
    step_size: f64,
    line: f64,
    caliper: f64,
    /// Time since the caliper pressure exceeded the contact pressure; 0 below it.
    contact_time: f64,
}

#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
struct Parameters {
    piston_area: f64,
    friction_radius: f64,
    friction: f64,
    onset_share: f64,
    onset_time: f64,
    contact_pressure: f64,
    caliper_lag: f64,
    build_rate: f64,
    dump_rate: f64,
    release_rate: f64,
}

impl Model for BrakeHydraulics {
    const NAME: &'static str = "brake-hydraulics";
    const DESCRIPTION: &'static str = "Hydraulics and pads of one wheel brake: the driver's pressure and two valve openings in, pressures and brake torque out";
    const DOCUMENTATION: &'static [&'static str] = &[include_str!("brake_hydraulics.html")];
    fn variables() -> Table<Self> {
        Table::new([
        input("driver_pressure", "Pa", real!(driver_pressure), 0.0, "Pressure in the master cylinder, over ambient; below 0 counts as 0").range(-1e7, 1e8),
        input("inlet_valve", "1", real!(inlet_valve), 1.0, "Opening of the inlet valve, or the share of time for which it is open: 1 builds pressure, 0 closes").range(0.0, 1.0),
        input("outlet_valve", "1", real!(outlet_valve), 0.0, "Opening of the outlet valve, or the share of time for which it is open: 1 dumps pressure, 0 closes").range(0.0, 1.0),
        output("brake_torque", "N.m", Access::computed(|m: &Self| m.torque()), "Torque that the sliding pads put on the wheel against its rotation, never negative; on a wheel that stands it is the most that the brake can hold (6.33)").nominal(1000.0),
        output("pressure", "Pa", real!(line), "Pressure in the wheel's line").nominal(1e6),
        output("caliper_pressure", "Pa", real!(caliper), "Pressure in the caliper, behind its lag").nominal(1e6),
        output("pad_friction", "1", Access::computed(|m: &Self| m.parameters.friction_after(m.contact_time)), "Friction coefficient of the pads (mu_Br)"),
        parameter("piston_area", "m2", real!(parameters.piston_area), 43e-4, "Piston area, sum over both pads (A_piston; placeholder)").range(1e-6, 1.0).tunable(),
        parameter("friction_radius", "m", real!(parameters.friction_radius), 0.14, "Radius at which the pads' friction acts (r_Reib; placeholder)").range(1e-3, 2.0).tunable(),
        parameter("friction", "1", real!(parameters.friction), 0.4, "Friction coefficient of pads in full contact (mu_0; placeholder)").range(0.0, 2.0).tunable(),
        parameter("onset_friction_share", "1", real!(parameters.onset_share), 0.25, "Friction at first contact over that of full contact (c_0; placeholder); 1 makes it constant").range(0.0, 1.0).tunable(),
        parameter("onset_time", "s", real!(parameters.onset_time), 0.22, "Time from first to full contact (T_on; placeholder); 0 makes the friction constant").range(0.0, 10.0).tunable(),
        parameter("contact_pressure", "Pa", real!(parameters.contact_pressure), 5e4, "Caliper pressure that it takes to bring the pads to the disc, and that does not press them on it: without torque below it, and the onset starts here, anew after each fall below it (placeholder)").range(0.0, 1e7).tunable(),
        parameter("caliper_lag", "s", real!(parameters.caliper_lag), 6e-3, "First-order lag of the caliper pressure behind the line (placeholder); 0 makes them equal").range(0.0, 1.0).tunable(),
        parameter("build_rate", "Pa/s", real!(parameters.build_rate), 1.2e8, "Rise of the line pressure through the open inlet valve (placeholder)").range(1e5, 1e11).tunable(),
        parameter("dump_rate", "Pa/s", real!(parameters.dump_rate), 9e7, "Fall of the line pressure through the open outlet valve (placeholder)").range(0.0, 1e11).tunable(),
        parameter("release_rate", "Pa/s", real!(parameters.release_rate), 3e8, "Fall of the line pressure through the check valve beside the inlet valve, while it is above the driver's (placeholder)").range(1e5, 1e11).tunable(),
        parameter("step_size", "s", real!(step_size), 1e-4, "Step of the model's own time grid; the inputs are held over it, and that is its only error").range(1e-6, 0.1),
    ])
    }

    fn step_size(&self) -> f64 {
        self.step_size
    }

    fn initialize(&mut self) -> Result<()> {
        let source = self.source();
        let (inflow, outflow) = self.flows();
        self.line = if inflow < outflow { 0.0 } else { source };
        self.caliper = self.line;
        let contact = self.caliper > self.parameters.contact_pressure;
        self.contact_time = if contact { self.parameters.onset_time } else { 0.0 };
        Ok(())
    }

    fn check(&self) -> Result<()> {
        let states = [self.line, self.caliper, self.contact_time];
        if states.iter().all(|state| (0.0..1e300).contains(state)) {
            return Ok(());
        }
        Err(Error::numeric("pressures and contact time have to be finite and not negative"))
    }

    fn step(&mut self, length: f64) -> Result<()> {
        let mut rest = length;
        while rest > 0.0 {
            let (ramp, end) = self.next_ramp(rest);
            self.follow(&ramp);
            self.line = end;
            rest -= ramp.duration;
        }
        Ok(())
    }
}

/// The line pressure over a time in which it changes evenly.
struct Ramp {
    start: f64,
    rate: f64,
    duration: f64,
}

impl Ramp {
    /// The caliper pressure `time` after the start of the ramp, from `caliper` at its start.
    fn lagged(&self, caliper: f64, lag: f64, time: f64) -> f64 {
        let behind = self.rate * lag;
        let gap = caliper - self.start + behind;
        // no gap decays to none, and at the start all of it is there: the same bits without the function
        let left = if gap == 0.0 || time == 0.0 && lag > 0.0 {
            gap
        } else if lag > 0.0 {
            gap * Real::exp(-time / lag)
        } else {
            gap * 0.0
        };
        self.start + self.rate * time - behind + left
    }

    /// When the caliper pressure turns, if it does so on the ramp.
    fn turn(&self, caliper: f64, lag: f64) -> Option<f64> {
        if self.rate == 0.0 {
            return None;
        }
        let ratio = 1.0 + (caliper - self.start) / (self.rate * lag);
        let time = if ratio > 1.0 { lag * Real::ln(ratio) } else { 0.0 };
        (time > 0.0 && time < self.duration).then_some(time)
    }
}

impl Parameters {
    /// Friction of the pads some time after first contact: a smooth rise (placeholder).
    fn friction_after(&self, time: f64) -> f64 {
        let x = if self.onset_time > 0.0 { (time / self.onset_time).min(1.0) } else { 1.0 };
        let rise = x * x * (3.0 - 2.0 * x);
        self.friction * (self.onset_share + (1.0 - self.onset_share) * rise)
    }
}

impl BrakeHydraulics {
    /// Torque of the pads: (6.33) with the pressure beyond the one that it takes to bring them to the disc,
    /// which the source does not have.
    fn torque(&self) -> f64 {
        let p = &self.parameters;
        let clamping = (self.caliper - p.contact_pressure).max(0.0);
        p.friction_after(self.contact_time) * clamping * p.piston_area * p.friction_radius
    }

    fn source(&self) -> f64 {
        self.driver_pressure.max(0.0)
    }

    /// Rates at which the line pressure would rise through the inlet valve and fall through the outlet valve.
    fn flows(&self) -> (f64, f64) {
        // an input that came with its rate may end past its range by rounding
        let (inlet, outlet) = (self.inlet_valve.clamp(0.0, 1.0), self.outlet_valve.clamp(0.0, 1.0));
        (inlet * self.parameters.build_rate, outlet * self.parameters.dump_rate)
    }

    /// How the line pressure goes on, for `rest` seconds or until it meets a limit, and where it ends.
    fn next_ramp(&self, rest: f64) -> (Ramp, f64) {
        let (start, source, (inflow, outflow)) = (self.line, self.source(), self.flows());
        let net = inflow - outflow;
        let (rate, limit) = if start > source {
            (-self.parameters.release_rate - outflow, source)
        } else if net > 0.0 {
            (net, source)
        } else {
            (net, 0.0)
        };
        if start == limit || rate == 0.0 {
            return (Ramp { start, rate: 0.0, duration: rest }, start);
        }
        let to_limit = (limit - start) / rate;
        if to_limit < rest {
            (Ramp { start, rate, duration: to_limit }, limit)
        } else {
            // rounding must not carry it past the limit, below 0 least of all
            let end = start + rate * rest;
            (Ramp { start, rate, duration: rest }, if rate < 0.0 { end.max(limit) } else { end.min(limit) })
        }
    }

    /// Takes the caliper and the pads along a ramp of the line pressure.
    fn follow(&mut self, ramp: &Ramp) {
        let lag = self.parameters.caliper_lag;
        let from = self.caliper;
        let at = |time: f64| (time, ramp.lagged(from, lag, time));
        let pressure = |time: f64| at(time).1;
        let (begin, end) = (at(0.0), at(ramp.duration));
        // the pressure is monotonic up to its turn and after it
        match ramp.turn(from, lag).map(at) {
            None => self.keep_contact(&pressure, begin, end),
            Some(turn) => {
                self.keep_contact(&pressure, begin, turn);
                self.keep_contact(&pressure, turn, end);
            }
        }
        self.caliper = end.1.max(0.0);
    }

    /// Counts the time in contact over a time in which the caliper pressure is monotonic, from one time and
    /// pressure to another.
    fn keep_contact(&mut self, pressure: &impl Fn(f64) -> f64, begin: (f64, f64), end: (f64, f64)) {
        let contact = |pressure: f64| pressure > self.parameters.contact_pressure;
        match (contact(begin.1), contact(end.1)) {
            (_, false) => self.contact_time = 0.0,
            (true, true) => self.contact_time += end.0 - begin.0,
            (false, true) => {
                let (mut before, mut after) = (begin.0, end.0);
                for _ in 0..HALVINGS {
                    let middle = 0.5 * (before + after);
                    if contact(pressure(middle)) { after = middle } else { before = middle }
                }
                self.contact_time = end.0 - after;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::{Native, Settings, Slave};

    type Brake = Native<BrakeHydraulics>;

    fn brake(values: &[(&str, f64)]) -> Brake {
        let mut brake = Brake::new(&Settings::default()).unwrap();
        set(&mut brake, values);
        brake.start(0.0, None).unwrap();
        brake.finish_start().unwrap();
        brake
    }

    fn set(brake: &mut Brake, values: &[(&str, f64)]) {
        for (name, value) in values {
            let index = brake.find(name).unwrap();
            brake.set(index, *value).unwrap();
        }
    }

    fn get(brake: &mut Brake, name: &str) -> f64 {
        let index = brake.find(name).unwrap();
        brake.get(index).unwrap()
    }

    #[track_caller]
    fn close(value: f64, expected: f64) {
        assert!((value - expected).abs() <= 1e-9 * expected.abs().max(1.0), "{value} instead of {expected}");
    }

    #[test]
    fn follows_its_closed_form_however_time_is_cut() {
        // 1200 bar/s for 50 ms up to the driver's 60 bar; contact at 0.5 bar
        let (build, lag, top, end): (f64, f64, f64, f64) = (1.2e8, 6e-3, 6e6, 0.08);
        let meet = top / build;
        let on_ramp = |t: f64| build * (t - lag + lag * (-t / lag).exp());
        let caliper = top + (on_ramp(meet) - top) * (-(end - meet) / lag).exp();
        // first contact by Newton's method, which the model does not use
        let mut first: f64 = 1e-3;
        for _ in 0..50 {
            first -= (on_ramp(first) - 5e4) / (build * (1.0 - (-first / lag).exp()));
        }
        let x = (end - first) / 0.22;
        let friction = 0.4 * (0.25 + 0.75 * (3.0 * x * x - 2.0 * x * x * x));
        for (step_size, steps) in [(0.08, 1), (1e-3, 80), (1e-3, 7), (0.013, 11), (1e-4, 50)] {
            let mut brake = brake(&[("step_size", step_size)]);
            set(&mut brake, &[("driver_pressure", top)]);
            let length = end / f64::from(steps);
            for k in 0..steps {
                brake.step(f64::from(k) * length, length).unwrap();
            }
            close(get(&mut brake, "pressure"), top);
            close(get(&mut brake, "caliper_pressure"), caliper);
            close(get(&mut brake, "pad_friction"), friction);
            close(get(&mut brake, "brake_torque"), friction * (caliper - 5e4) * 43e-4 * 0.14);
        }
    }

    #[test]
    fn valves_and_driver_move_the_line_pressure_between_its_limits() {
        let mut brake = brake(&[("driver_pressure", 1e7), ("caliper_lag", 0.0)]);
        close(get(&mut brake, "pressure"), 1e7);
        let mut time = 0.0;
        let mut after = |values: &[(&str, f64)], length: f64| {
            set(&mut brake, values);
            brake.step(time, length).unwrap();
            time += length;
            assert_eq!(get(&mut brake, "pressure"), get(&mut brake, "caliper_pressure"));
            get(&mut brake, "pressure")
        };
        // dump, hold, pulsed build
        close(after(&[("inlet_valve", 0.0), ("outlet_valve", 1.0)], 0.02), 8.2e6);
        close(after(&[("outlet_valve", 0.0)], 0.1), 8.2e6);
        close(after(&[("inlet_valve", 0.25)], 0.01), 8.5e6);
        // a closed inlet does not keep the pressure above the driver's, nor lets it below
        close(after(&[("inlet_valve", 0.0), ("driver_pressure", 4e6)], 0.01), 5.5e6);
        close(after(&[], 0.01), 4e6);
        // nothing below 0, and nothing above the driver
        close(after(&[("outlet_valve", 1.0)], 1.0), 0.0);
        close(after(&[("outlet_valve", 0.0), ("inlet_valve", 1.0)], 1.0), 4e6);
        // both valves open: what comes in and what goes out
        close(after(&[("outlet_valve", 1.0), ("inlet_valve", 0.25)], 0.01), 3.4e6);
    }

    #[test]
    fn friction_is_constant_without_an_onset_and_starts_anew_after_lifting_off() {
        for constant in ["onset_time", "onset_friction_share"] {
            let value = if constant == "onset_time" { 0.0 } else { 1.0 };
            let mut brake = brake(&[(constant, value)]);
            set(&mut brake, &[("driver_pressure", 3e6)]);
            for k in 0..300 {
                brake.step(f64::from(k) * 1e-3, 1e-3).unwrap();
                assert_eq!(get(&mut brake, "pad_friction"), 0.4);
            }
        }
        // pads that are in contact at the start have been so for long
        let mut brake = brake(&[("driver_pressure", 3e6)]);
        assert_eq!(get(&mut brake, "pad_friction"), 0.4);
        set(&mut brake, &[("driver_pressure", 6e4)]);
        brake.step(0.0, 0.5).unwrap();
        assert_eq!(get(&mut brake, "pad_friction"), 0.4);
        set(&mut brake, &[("driver_pressure", 4e4)]);
        brake.step(0.5, 0.5).unwrap();
        assert_eq!(get(&mut brake, "pad_friction"), 0.1);
        // half of the onset from when it exceeds 0.5 bar
        set(&mut brake, &[("driver_pressure", 3e6), ("caliper_lag", 0.0)]);
        brake.step(1.0, 0.11 + 1e4 / 1.2e8).unwrap();
        close(get(&mut brake, "pad_friction"), 0.4 * (0.25 + 0.75 * 0.5));
    }

    #[test]
    fn pads_that_do_not_touch_do_not_brake_and_the_torque_begins_at_contact_from_zero() {
        let torque_at = |pressure: f64| {
            let mut brake = brake(&[("contact_pressure", 1e6), ("driver_pressure", pressure)]);
            get(&mut brake, "brake_torque")
        };
        for below in [0.0, 9e5, 1e6] {
            assert_eq!(torque_at(below), 0.0, "{below} Pa");
        }
        let [a, b] = [1e6 + 1.0, 1e6 + 2.0].map(torque_at);
        assert!(a > 0.0 && a < 1e-3 && (b / a - 2.0).abs() < 1e-6, "{a} {b}");
    }

    #[test]
    fn a_ramp_that_ends_at_its_limit_does_not_pass_it_by_rounding() {
        // 9e7 Pa/s over this time are more than this pressure by the last bit
        let (line, time) = (51652.92783614738, 0.0005739214204016376);
        let mut brake = brake(&[("driver_pressure", line)]);
        set(&mut brake, &[("inlet_valve", 0.0), ("outlet_valve", 1.0)]);
        brake.step(0.0, time).unwrap();
        assert_eq!(get(&mut brake, "pressure"), 0.0);
    }

    #[test]
    fn a_valve_that_closes_evenly_is_closed_in_spite_of_rounding() {
        let mut brake = brake(&[("driver_pressure", 1e7), ("step_size", 1e-3)]);
        set(&mut brake, &[("inlet_valve", 0.0), ("outlet_valve", 0.1)]);
        let outlet = brake.find("outlet_valve").unwrap();
        brake.step(0.0, 0.05).unwrap();
        let held = get(&mut brake, "pressure");
        // 0.1 - 100.00000005 * 0.001 is below 0 by 5e-11
        brake.set_rate(outlet, -100.000_000_05).unwrap();
        brake.step(0.05, 1e-3).unwrap();
        assert!(get(&mut brake, "outlet_valve") < 0.0);
        assert_eq!(get(&mut brake, "pressure"), held);
    }

    #[test]
    fn a_brush_of_the_pads_within_a_step_is_seen() {
        // line at 10 bar falls at once, the caliper rises past contact first: two crossings in one step
        let mut model = BrakeHydraulics {
            line: 1e6,
            parameters: Parameters {
                caliper_lag: 0.01,
                contact_pressure: 2e5,
                onset_time: 0.2,
                dump_rate: 9e7,
                build_rate: 1.2e8,
                release_rate: 3e8,
                ..Parameters::default()
            },
            driver_pressure: 5e6,
            outlet_valve: 1.0,
            ..BrakeHydraulics::default()
        };
        let mut fine = model.clone();
        model.step(8e-3).unwrap();
        let mut longest: f64 = 0.0;
        for _ in 0..8000 {
            fine.step(1e-6).unwrap();
            longest = longest.max(fine.contact_time);
        }
        assert!(longest > 5e-3, "{longest}");
        assert!((model.contact_time - fine.contact_time).abs() < 1e-9);
        model.step(0.05).unwrap();
        assert_eq!(model.contact_time, 0.0);
    }
}
