//! Controller and hydraulics by themselves: what is before the calipers, with the recorded wheel speeds and the driver's recorded pressure.

use super::cause::{Cause, How, of_hydraulics};
use super::pads::moving;
use super::part::{Part, changed, has_all, slave, step, with};
use super::runs::Recorded;
use crate::Result;
use crate::cosimulate::{Experiment, Plan, cosimulate};
use crate::model::Value;
use crate::recording::{Channel, Recording, interpolate};

pub(super) struct Hydraulics<'a> {
    /// Controller and brakes, and what is between them.
    plan: Plan,
    runs: &'a [Recorded],
    /// Inputs that follow channels: component, variable, channel.
    driven: Vec<(String, String, String)>,
    causes: Vec<Cause>,
    channels: Vec<String>,
    step: f64,
}

impl<'a> Hydraulics<'a> {
    /// None where recordings do not have pressures of calipers, and all that drives controller and brakes.
    pub(super) fn new(plan: &Plan, runs: &'a [Recorded]) -> Result<Option<Self>> {
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
        let causes = of_hydraulics();
        Ok(Some(Self { plan: part, runs, driven, causes, channels, step: step(plan)? }))
    }
}

impl Part for Hydraulics<'_> {
    fn name(&self) -> String {
        let names: Vec<&str> = self.plan.components.iter().map(|c| c.name.as_str()).collect();
        format!("{} at the recorded wheel speeds and the driver's recorded pressure", names.join(", "))
    }

    fn runs(&self) -> &[Recorded] {
        self.runs
    }

    fn causes(&self) -> &[Cause] {
        &self.causes
    }

    fn channels(&self) -> &[String] {
        &self.channels
    }

    fn has_offset(&self, _: usize) -> bool {
        true
    }

    fn errors(&self, run: usize, changes: &[(usize, Vec<f64>)]) -> Result<Vec<Vec<f64>>> {
        let recorded = &self.runs[run];
        let recording = &recorded.recording;
        let mut plan = self.plan.clone();
        let mut gain = 1.0;
        for (cause, x) in changes {
            let cause = &self.causes[*cause];
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
            let info = system.info(port);
            let unit = info.unit.clone().unwrap_or_else(|| "1".into());
            let range = [info.min.unwrap_or(f64::NEG_INFINITY), info.max.unwrap_or(f64::INFINITY)];
            let factor = if variable == "driver_pressure" { gain } else { 1.0 };
            let values = recording.channel_in(channel, &unit)?;
            // noise about zero is beyond what a pressure can be
            let values = values.iter().map(|v| (factor * v).clamp(range[0], range[1])).collect();
            let one = Channel { name: channel.clone(), unit, values };
            let drive = Recording {
                time: recording.time.clone(),
                channels: vec![one],
                source: recorded.name.clone(),
            };
            system.feed(port, &drive, channel, false)?;
        }
        let end = moving(recording, recording.time.len());
        let experiment = Experiment {
            start: recording.time[0],
            stop: recording.time[end - 1],
            step: self.step,
            record_every: 1,
            all: false,
            log: false,
        };
        let outcome = cosimulate(&mut system, &experiment, |_| {})?;
        if let Some(error) = outcome.stopped {
            return Err(error.at(&recorded.name));
        }
        self.channels
            .iter()
            .map(|channel| {
                let simulated = outcome.recording.channel_in(channel, "Pa")?;
                let measured = recording.channel_in(channel, "Pa")?;
                let at = |k: usize| interpolate(&outcome.recording.time, &simulated, recording.time[k]);
                Ok((0..end).map(|k| measured[k] - at(k)).collect())
            })
            .collect()
    }

    fn values(&self, cause: usize, x: &[f64]) -> Result<Vec<(String, Value, Value)>> {
        let cause = &self.causes[cause];
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
