//! Controller and hydraulics by themselves, with the recorded wheel speeds and the driver's recorded pressure: hydraulics until the controller's first decision, then the
//! controller.

use super::cause::{How, of_controllers, of_hydraulics};
use super::part::{
    Opened, Part, along, changed, follow, has_all, less, moving, slave, smooth_wheel_speed, step, variation,
    with,
};
use super::runs::Recorded;
use crate::Result;
use crate::cosimulate::Plan;
use crate::model::Value;
use crate::recording::Recording;

pub(super) struct Hydraulics<'a> {
    /// Controller and brakes, and what is between them.
    plan: Plan,
    opened: Opened<'a>,
    /// Inputs that follow channels: component, variable, channel.
    driven: Vec<(String, String, String)>,
    until: Until,
    /// Samples of each run that are compared.
    ends: Vec<usize>,
}

/// How far a run is compared.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Until {
    /// The controller's first decision: what it does with the pressure tells of the controller.
    FirstDecision,
    /// The end.
    Slow,
}

/// A decision may come so much earlier in the recording \[s\].
const MARGIN: f64 = 0.015;

impl<'a> Hydraulics<'a> {
    /// None where recordings do not have pressures of calipers, and all that drives controller and brakes.
    pub(super) fn new(plan: &Plan, runs: &'a [Recorded], until: Until) -> Result<Option<Self>> {
        let mut part = plan.clone();
        let mut kept = Vec::new();
        let mut channels = Vec::new();
        for component in &plan.components {
            let one = slave(component)?;
            let pressure = format!("{}.caliper_pressure", component.name);
            if has_all(&*one, &["driver_pressure", "caliper_pressure"])
                && runs.iter().all(|r| r.recording.has(&pressure))
            {
                channels.push(pressure);
                kept.push(component.name.clone());
            } else if one.find("rolling_radius_1").is_ok() {
                kept.push(component.name.clone());
            }
        }
        if channels.is_empty() {
            return Ok(None);
        }
        part.components.retain(|c| kept.contains(&c.name));
        let inside = |name: &String| kept.contains(name);
        let mut driven: Vec<(String, String, String)> = part
            .connections
            .iter()
            .filter(|c| inside(&c.to.component) && !inside(&c.from.component))
            .map(|c| {
                (
                    c.to.component.clone(),
                    c.to.variable.clone(),
                    format!("{}.{}", c.from.component, c.from.variable),
                )
            })
            .collect();
        part.connections.retain(|c| inside(&c.to.component) && inside(&c.from.component));
        for inputs in std::mem::take(&mut part.inputs) {
            let own = inputs.connect.into_iter().filter(|(_, to)| inside(&to.component));
            driven.extend(own.map(|(channel, to)| (to.component, to.variable, channel)));
        }
        part.bonds.clear();
        part.order = part.order.map(|order| order.into_iter().filter(|name| inside(name)).collect());
        if !driven.iter().all(|(.., channel)| runs.iter().all(|run| run.recording.has(channel))) {
            return Ok(None);
        }
        let causes = match until {
            Until::FirstDecision => of_hydraulics(),
            Until::Slow => of_controllers(),
        };
        let ends: Vec<usize> = runs.iter().map(|run| moving(&run.recording)).collect();
        let opened = Opened { runs, causes, channels, step: step(plan)? };
        let mut all = Self { plan: part, opened, driven, until, ends };
        if until == Until::FirstDecision {
            all.ends = (0..runs.len()).map(|run| all.first_decision(run)).collect::<Result<_>>()?;
        }
        Ok(Some(all))
    }

    /// The sample before a valve first moves.
    fn first_decision(&self, run: usize) -> Result<usize> {
        let simulated = self.simulated(run, &[])?;
        let valves: Vec<String> =
            self.plan.connections.iter().map(|c| format!("{}.{}", c.to.component, c.to.variable)).collect();
        let moved = |name: &String| {
            let values = &simulated.channel(name).ok()?.values;
            values.iter().position(|v| *v != values[0]).map(|k| simulated.time[k])
        };
        let first = valves.iter().filter_map(moved).fold(f64::INFINITY, f64::min) - MARGIN;
        Ok(self.runs()[run].recording.time.iter().take(self.ends[run]).filter(|t| **t < first).count().max(2))
    }

    /// The part's own run.
    fn simulated(&self, run: usize, changes: &[(usize, Vec<f64>)]) -> Result<Recording> {
        let recording = &self.runs()[run].recording;
        let mut plan = self.plan.clone();
        let mut gain = 1.0;
        for (cause, x) in changes {
            let cause = &self.causes()[*cause];
            for component in &mut plan.components {
                let values = changed(component, &*slave(component)?, cause, x)?;
                *component = with(component, &values);
            }
            for (unknown, x) in cause.unknowns.iter().zip(x) {
                if unknown.how == How::Input {
                    gain *= 1.0 + x;
                }
            }
        }
        let mut system = plan.load()?;
        for (component, variable, channel) in &self.driven {
            let port = system.port(component, variable)?;
            // the line follows the driver at once, while a controller looks at wheels as they are
            let drives = variable == "driver_pressure";
            let ahead = if drives { self.opened.step } else { 0.0 };
            let course = |values: Vec<f64>| match drives {
                true => values.into_iter().map(|p| gain * p).collect(),
                false => smooth_wheel_speed(&recording.time, &values),
            };
            follow(&mut system, port, (recording, channel), course, ahead)?;
        }
        along(&mut system, recording, self.ends[run], self.opened.step)
    }
}

impl Part for Hydraulics<'_> {
    fn name(&self) -> String {
        let names: Vec<&str> = self.plan.components.iter().map(|c| c.name.as_str()).collect();
        let until = match self.until {
            Until::FirstDecision => "until the controller's first decision",
            Until::Slow => "with the controller's decisions",
        };
        format!(
            "{} at the recorded wheel speeds and the driver's recorded pressure, {until}",
            names.join(", ")
        )
    }

    fn opened(&self) -> &Opened<'_> {
        &self.opened
    }

    fn has_offset(&self, _: usize) -> bool {
        true
    }

    fn errors(&self, run: usize, changes: &[(usize, Vec<f64>)]) -> Result<Vec<Vec<f64>>> {
        let run_of = self.simulated(run, changes)?;
        let recording = &self.runs()[run].recording;
        let of = |channel: &String| -> Result<Vec<f64>> {
            let measured = recording.channel_in(channel, "Pa")?;
            let simulated = run_of.channel_in(channel, "Pa")?;
            Ok(less(&measured[..self.ends[run]], &recording.time, &run_of, &simulated))
        };
        self.channels().iter().map(of).collect()
    }

    fn variation(&self, run: usize) -> Result<Vec<f64>> {
        variation(&self.runs()[run].recording, self.channels(), "Pa")
    }

    fn values(&self, cause: usize, x: &[f64]) -> Result<Vec<(String, Value, Value)>> {
        let cause = &self.causes()[cause];
        let mut all = Vec::new();
        for component in &self.plan.components {
            let values = changed(component, &*slave(component)?, cause, x)?;
            all.extend(values.into_iter().map(|(n, a, b)| (format!("{}.{n}", component.name), a, b)));
        }
        for (unknown, x) in cause.unknowns.iter().zip(x) {
            if unknown.how == How::Input {
                all.push(("driver_pressure".into(), Value::Real(1.0), Value::Real(1.0 + x)));
            }
        }
        Ok(all)
    }
}
