//! The pads by themselves: brakes at the recorded pressure of their calipers, with nothing of hydraulics before them.

use super::cause::of_pads;
use super::part::{
    Opened, Part, along, changed, follow, has_all, less, moving, slave, step, variation, with,
};
use super::runs::Recorded;
use super::vehicle::onset;
use crate::Result;
use crate::cosimulate::{Plan, PlannedComponent};
use crate::model::Value;
use crate::recording::Recording;

/// A brake in which pressure goes where it is told to at once.
const DIRECT: [(&str, f64); 4] =
    [("caliper_lag", 0.0), ("build_rate", 1e11), ("dump_rate", 1e11), ("release_rate", 1e11)];

pub(super) struct Pads<'a> {
    opened: Opened<'a>,
    brakes: Vec<Brake>,
    /// Which brakes a cause is of.
    of: Vec<Vec<usize>>,
}

/// A brake, and the channels that tell its pressure and torque.
struct Brake {
    component: PlannedComponent,
    pressure: String,
    torque: String,
}

impl<'a> Pads<'a> {
    /// None where recordings do not have pressure and torque of two brakes or more.
    pub(super) fn new(plan: &Plan, runs: &'a [Recorded]) -> Result<Option<Self>> {
        let recordings: Vec<&Recording> = runs.iter().map(|run| &run.recording).collect();
        let mut brakes = Vec::new();
        for component in &plan.components {
            let one = slave(component)?;
            if !has_all(&*one, &["driver_pressure", "caliper_pressure", "brake_torque", "friction"]) {
                continue;
            }
            let pressure = format!("{}.caliper_pressure", component.name);
            if let Some(torque) = torque_channel(plan, &component.name, &recordings)
                && recordings.iter().all(|run| run.has(&pressure))
            {
                brakes.push(Brake { component: component.clone(), pressure, torque });
            }
        }
        if brakes.len() < 2 {
            return Ok(None);
        }
        let channels = brakes.iter().map(|brake| brake.torque.clone()).collect();
        let mut causes = Vec::new();
        let mut of = Vec::new();
        let all: Vec<usize> = (0..brakes.len()).collect();
        let axles: Vec<Vec<usize>> = all.chunks(2).map(<[usize]>::to_vec).collect();
        for cause in of_pads() {
            if cause.id == "pad_friction" {
                for axle in &axles {
                    causes.push(cause.clone());
                    of.push(axle.clone());
                }
            } else {
                causes.push(cause);
                of.push(all.clone());
            }
        }
        let opened = Opened { runs, causes, channels, step: step(plan)? };
        Ok(Some(Self { opened, brakes, of }))
    }
}

/// The recorded channel with a brake's torque: its own, that of the input which it is connected to, or what the rim of that wheel has.
pub(super) fn torque_channel(plan: &Plan, brake: &str, runs: &[&Recording]) -> Option<String> {
    let to = plan.connections.iter().find(|c| c.from.component == brake && c.from.variable == "brake_torque");
    let mut names = vec![format!("{brake}.brake_torque")];
    if let Some(connection) = to {
        let input = format!("{}.{}", connection.to.component, connection.to.variable);
        names.push(input.replace("brake_torque", "carrier_moment_y"));
        names.push(input);
    }
    names.into_iter().find(|name| runs.iter().all(|run| run.has(name)))
}

impl Part for Pads<'_> {
    fn name(&self) -> String {
        let names: Vec<&str> = self.brakes.iter().map(|b| b.component.name.as_str()).collect();
        format!("pads of {} at the recorded pressure", names.join(", "))
    }

    fn opened(&self) -> &Opened<'_> {
        &self.opened
    }

    fn has_offset(&self, _: usize) -> bool {
        false
    }

    fn errors(&self, run: usize, changes: &[(usize, Vec<f64>)]) -> Result<Vec<Vec<f64>>> {
        let recording = &self.runs()[run].recording;
        let torques: Vec<Vec<f64>> =
            self.brakes.iter().map(|b| recording.channel_in(&b.torque, "N.m")).collect::<Result<_>>()?;
        let begin = onset(&torques);
        let zero = |values: &[f64]| crate::stats::mean_or_zero(&values[..begin]);
        let moves = moving(recording);
        let mut errors = Vec::new();
        for (b, brake) in self.brakes.iter().enumerate() {
            let mut component = brake.component.clone();
            for (cause, x) in changes.iter().filter(|(cause, _)| self.of[*cause].contains(&b)) {
                let values = changed(&component, &*slave(&component)?, &self.causes()[*cause], x)?;
                component = with(&component, &values);
            }
            let direct =
                DIRECT.map(|(name, value)| (name.to_owned(), Value::Real(value), Value::Real(value)));
            component = with(&component, &direct);
            let driven = ["driver_pressure", "inlet_valve", "outlet_valve"];
            component.set.retain(|a| !driven.contains(&a.variable.as_str()));
            let plan =
                Plan { components: vec![component], source: brake.component.name.clone(), ..Plan::default() };
            let mut system = plan.load()?;
            let input = system.port(&brake.component.name, "driver_pressure")?;
            let pressure = recording.channel_in(&brake.pressure, "Pa")?;
            let rest = zero(&pressure);
            let end = moves.min(lifted(&pressure));
            let step = self.opened.step;
            let above = |pressure: Vec<f64>| pressure.into_iter().map(|p| p - rest).collect();
            follow(&mut system, input, (recording, &brake.pressure), above, step)?;
            let run_of = along(&mut system, recording, end, step)?;
            let simulated = run_of.channel_in(&format!("{}.brake_torque", brake.component.name), "N.m")?;
            let rest = zero(&torques[b]);
            let measured: Vec<f64> = torques[b][..end].iter().map(|torque| torque - rest).collect();
            let mut error = less(&measured, &recording.time, &run_of, &simulated);
            let turns = turning(recording, &brake.torque);
            error.iter_mut().zip(turns).filter(|(_, turns)| !turns).for_each(|(error, _)| *error = 0.0);
            errors.push(error);
        }
        Ok(errors)
    }

    fn variation(&self, run: usize) -> Result<Vec<f64>> {
        variation(&self.runs()[run].recording, self.channels(), "N.m")
    }

    fn values(&self, cause: usize, x: &[f64]) -> Result<Vec<(String, Value, Value)>> {
        let mut all = Vec::new();
        for b in &self.of[cause] {
            let component = &self.brakes[*b].component;
            let values = changed(component, &*slave(component)?, &self.causes()[cause], x)?;
            all.extend(values.into_iter().map(|(n, a, b)| (format!("{}.{n}", component.name), a, b)));
        }
        Ok(all)
    }
}

/// Below this pressure pads are about to leave the disc, and how far their friction has built up starts anew when they are back: a decision by tenths of a bar, which a recording
/// does not tell \[Pa\].
const LIFTING: f64 = 2e5;

/// The sample at which the pads of a braked wheel are about to lift.
fn lifted(pressure: &[f64]) -> usize {
    let pressed = pressure.iter().position(|p| *p > 2.0 * LIFTING).unwrap_or(pressure.len());
    let lifted = pressure[pressed..].iter().position(|p| *p < LIFTING);
    lifted.map_or(pressure.len(), |k| pressed + k).max(2)
}

/// A wheel that turns slower than this share of the fastest is locked,
const LOCKED: f64 = 0.05;
/// and so long before and after that the filter of a recorder still shows it \[s\].
const SMEARED: f64 = 0.01;

/// Samples at which the wheel of a torque turns: one that is locked is held by what it takes, and not by the friction of its pads (6.34).
pub(super) fn turning(recording: &Recording, torque: &str) -> Vec<bool> {
    let speed = |name: &str| recording.channel_in(name, "rad/s").ok();
    let own = torque.strip_suffix("carrier_moment_y").and_then(|place| speed(&format!("{place}wheel_speed")));
    let samples = recording.time.len();
    let Some(own) = own else { return vec![true; samples] };
    let names = recording.channels.iter().map(|c| &c.name).filter(|name| name.ends_with(".wheel_speed"));
    let all: Vec<Vec<f64>> = names.filter_map(|name| speed(name)).collect();
    let mut turns = vec![true; samples];
    for k in 0..samples {
        let fastest = all.iter().map(|speeds| speeds[k].abs()).fold(0.0, f64::max);
        if own[k].abs() < LOCKED * fastest {
            let from = recording.time.partition_point(|t| *t < recording.time[k] - SMEARED);
            let to = recording.time.partition_point(|t| *t <= recording.time[k] + SMEARED);
            turns[from..to].fill(false);
        }
    }
    turns
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_locked_wheel_says_nothing_of_its_pads() {
        let channel = |name: &str, values: [f64; 5]| crate::recording::Channel {
            name: name.into(),
            unit: "rad/s".into(),
            values: values.to_vec(),
        };
        let recording = Recording {
            time: vec![0.0, 0.1, 0.2, 0.205, 0.3],
            channels: vec![
                channel("car.left.wheel_speed", [60.0, 50.0, 1.0, 20.0, 30.0]),
                channel("car.right.wheel_speed", [60.0, 55.0, 50.0, 50.0, 40.0]),
            ],
            source: String::new(),
        };
        let turns = |side: &str| turning(&recording, &format!("car.{side}.carrier_moment_y"));
        assert_eq!(turns("left"), [true, true, false, false, true]);
        assert_eq!(turns("right"), [true; 5]);
    }

    #[test]
    fn pads_are_compared_until_they_lift() {
        let pressure = [0.0, 1e5, 3e5, 50e5, 1e6, 1.9e5, 0.0, 50e5];
        assert_eq!(lifted(&pressure), 5);
        assert_eq!(lifted(&pressure[..5]), 5);
        assert_eq!(lifted(&[0.0, 0.0, 0.0]), 3);
    }
}
