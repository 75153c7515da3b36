//! The pads by themselves: brakes at the recorded pressure of their calipers, with nothing of hydraulics before them.

use super::cause::{Cause, of_pads};
use super::part::{Part, changed, has_all, slave, step, with};
use super::runs::Recorded;
use super::vehicle::onset;
use crate::Result;
use crate::cosimulate::{Experiment, Plan, PlannedComponent, cosimulate};
use crate::model::Value;
use crate::recording::{Channel, Recording, interpolate};

/// A brake in which pressure goes where it is told to at once.
const DIRECT: [(&str, f64); 4] =
    [("caliper_lag", 0.0), ("build_rate", 1e11), ("dump_rate", 1e11), ("release_rate", 1e11)];

pub(super) struct Pads<'a> {
    runs: &'a [Recorded],
    brakes: Vec<Brake>,
    causes: Vec<Cause>,
    /// Which brakes a cause is of.
    of: Vec<Vec<usize>>,
    channels: Vec<String>,
    step: f64,
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
        let mut brakes = Vec::new();
        for component in &plan.components {
            let one = slave(component)?;
            if !has_all(&*one, &["driver_pressure", "caliper_pressure", "brake_torque", "friction"]) {
                continue;
            }
            let pressure = format!("{}.caliper_pressure", component.name);
            if let Some(torque) = torque_channel(plan, &component.name, runs)
                && runs.iter().all(|run| run.recording.has(&pressure))
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
        Ok(Some(Self { runs, brakes, causes, of, channels, step: step(plan)? }))
    }
}

/// The recorded channel with a brake's torque: its own, that of the input which it is connected to, or what the rim of that wheel has.
fn torque_channel(plan: &Plan, brake: &str, runs: &[Recorded]) -> Option<String> {
    let to = plan.connections.iter().find(|c| c.from.component == brake && c.from.variable == "brake_torque");
    let mut names = vec![format!("{brake}.brake_torque")];
    if let Some(connection) = to {
        let input = format!("{}.{}", connection.to.component, connection.to.variable);
        names.push(input.replace("brake_torque", "carrier_moment_y"));
        names.push(input);
    }
    names.into_iter().find(|name| runs.iter().all(|run| run.recording.has(name)))
}

impl Part for Pads<'_> {
    fn name(&self) -> String {
        let names: Vec<&str> = self.brakes.iter().map(|b| b.component.name.as_str()).collect();
        format!("pads of {} at the recorded pressure", names.join(", "))
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
        false
    }

    fn errors(&self, run: usize, changes: &[(usize, Vec<f64>)]) -> Result<Vec<Vec<f64>>> {
        let recording = &self.runs[run].recording;
        let torques: Vec<Vec<f64>> =
            self.brakes.iter().map(|b| recording.channel_in(&b.torque, "N.m")).collect::<Result<_>>()?;
        let begin = onset(&torques);
        let zero = |values: &[f64]| crate::stats::mean_or_zero(&values[..begin]);
        let end = moving(recording, self.runs[run].recording.time.len());
        let mut errors = Vec::new();
        for (b, brake) in self.brakes.iter().enumerate() {
            let mut component = brake.component.clone();
            for (cause, x) in changes.iter().filter(|(cause, _)| self.of[*cause].contains(&b)) {
                let values = changed(&component, &*slave(&component)?, &self.causes[*cause], x)?;
                component = with(&component, &values);
            }
            let direct: Vec<(String, Value, Value)> = DIRECT
                .iter()
                .map(|(name, value)| ((*name).to_owned(), Value::Real(*value), Value::Real(*value)))
                .collect();
            component = with(&component, &direct);
            component.set.retain(|a| {
                !["driver_pressure", "inlet_valve", "outlet_valve"].contains(&a.variable.as_str())
            });
            let pressure = recording.channel_in(&brake.pressure, "Pa")?;
            let rest = zero(&pressure);
            let pressure = Channel {
                name: "pressure".into(),
                unit: "Pa".into(),
                values: pressure.iter().map(|p| (p - rest).max(0.0)).collect(),
            };
            let drive = Recording {
                time: ahead(&recording.time, self.step),
                channels: vec![pressure],
                source: self.runs[run].name.clone(),
            };
            let plan =
                Plan { components: vec![component], source: brake.component.name.clone(), ..Plan::default() };
            let mut system = plan.load()?;
            let input = system.port(&brake.component.name, "driver_pressure")?;
            system.feed(input, &drive, "pressure", false)?;
            let experiment = Experiment {
                start: recording.time[0],
                stop: recording.time[end - 1].min(recording.time[recording.time.len() - 1] - self.step),
                step: self.step,
                record_every: 1,
                all: false,
                log: false,
            };
            let outcome = cosimulate(&mut system, &experiment, |_| {})?;
            if let Some(error) = outcome.stopped {
                return Err(error.at(&self.runs[run].name));
            }
            let name = format!("{}.brake_torque", brake.component.name);
            let simulated = outcome.recording.channel_in(&name, "N.m")?;
            let rest = zero(&torques[b]);
            // the drive ends a step before the recording
            let last = outcome.recording.time.last().copied().unwrap_or_default();
            let error = |k: usize| {
                torques[b][k]
                    - rest
                    - interpolate(&outcome.recording.time, &simulated, recording.time[k].min(last))
            };
            errors.push((0..end).map(error).collect());
        }
        Ok(errors)
    }

    fn variation(&self, run: usize) -> Result<Vec<f64>> {
        let recording = &self.runs[run].recording;
        let end = moving(recording, recording.time.len());
        let of =
            |name: &String| Ok(crate::stats::deviation(&recording.channel_in(name, "N.m")?[..end]).powi(2));
        self.channels.iter().map(of).collect()
    }

    fn values(&self, cause: usize, x: &[f64]) -> Result<Vec<(String, Value, Value)>> {
        let mut all = Vec::new();
        for b in &self.of[cause] {
            let component = &self.brakes[*b].component;
            let values = changed(component, &*slave(component)?, &self.causes[cause], x)?;
            all.extend(values.into_iter().map(|(n, a, b)| (format!("{}.{n}", component.name), a, b)));
        }
        Ok(all)
    }
}

/// How many samples the vehicle moves for: a brake that holds a wheel at rest has the torque that it takes for that.
pub(super) fn moving(recording: &Recording, samples: usize) -> usize {
    let speed = recording.channels.iter().find(|c| c.name.ends_with("vehicle_speed"));
    let slow = speed.and_then(|c| recording.channel_in(&c.name, "m/s").ok());
    slow.and_then(|v| v.iter().position(|v| *v < 5.0)).unwrap_or(samples).max(2)
}

/// Times of samples, so that what is held over a step is what the recording has at its end: the torque follows from the pressure of the same time, and the line
/// from the driver's.
pub(super) fn ahead(time: &[f64], step: f64) -> Vec<f64> {
    time.iter().map(|t| t - step).collect()
}
