//! A part of the system by itself, driven by recordings.

use super::cause::{Cause, How};
use super::runs::{Recorded, given};
use crate::cosimulate::{Assignment, Experiment, Plan, PlannedComponent, Port, Source, System, cosimulate};
use crate::model::{Slave, Value};
use crate::recording::{Channel, Recording, interpolate};
use crate::{Error, Result};

/// What all parts have.
pub(super) struct Opened<'a> {
    pub(super) runs: &'a [Recorded],
    /// What can differ in it.
    pub(super) causes: Vec<Cause>,
    /// What is compared.
    pub(super) channels: Vec<String>,
    /// Communication step \[s\].
    pub(super) step: f64,
}

/// A part with its causes.
pub(super) trait Part: Sync {
    /// What it is, and how it was opened.
    fn name(&self) -> String;
    fn opened(&self) -> &Opened<'_>;
    /// True for a channel that may be off by a constant: a sensor's zero.
    fn has_offset(&self, channel: usize) -> bool;
    /// Measured less simulated of each channel at the samples of a run that are compared, with values of unknowns of causes.
    fn errors(&self, run: usize, changes: &[(usize, Vec<f64>)]) -> Result<Vec<Vec<f64>>>;
    /// Mean square of what each channel varies by in a run, of a friction factor its square.
    fn variation(&self, run: usize) -> Result<Vec<f64>>;
    /// Values of parameters that such a change makes.
    fn values(&self, cause: usize, x: &[f64]) -> Result<Vec<(String, Value, Value)>>;

    fn runs(&self) -> &[Recorded] {
        self.opened().runs
    }

    fn causes(&self) -> &[Cause] {
        &self.opened().causes
    }

    fn channels(&self) -> &[String] {
        &self.opened().channels
    }
}

/// Lets an input follow a channel of a recording, its course changed on the way and kept within what the input can be: noise about zero is beyond what a pressure can be. `ahead`: what is held over a
/// step is what the recording has at its end, for what follows at once.
pub(super) fn follow(
    system: &mut System,
    port: Port,
    (recording, channel): (&Recording, &str),
    change: impl FnOnce(Vec<f64>) -> Vec<f64>,
    ahead: f64,
) -> Result<()> {
    let info = system.info(port);
    let unit = info.unit.clone().unwrap_or_else(|| "1".into());
    let [low, high] = [info.min.unwrap_or(f64::NEG_INFINITY), info.max.unwrap_or(f64::INFINITY)];
    let values = change(recording.channel_in(channel, &unit)?);
    let values = values.into_iter().map(|v| v.clamp(low, high)).collect();
    let drive = Recording {
        time: recording.time.iter().map(|t| t - ahead).collect(),
        channels: vec![Channel { name: channel.to_owned(), unit, values }],
        source: recording.source.clone(),
    };
    system.feed(port, &drive, channel, false)
}

/// Runs a driven system along a recording, to the sample `end` or as far as what is ahead by a step goes.
pub(super) fn along(system: &mut System, recording: &Recording, end: usize, step: f64) -> Result<Recording> {
    let (start, last) = (recording.time[0], recording.time[recording.time.len() - 1]);
    let experiment = Experiment {
        start,
        stop: recording.time[end - 1].min(last - step).max(start + step),
        step,
        record_every: 1,
        all: false,
        log: false,
    };
    let outcome = cosimulate(system, &experiment, |_| {})?;
    match outcome.stopped {
        None => Ok(outcome.recording),
        Some(error) => Err(error.at(&recording.source)),
    }
}

/// Recorded less simulated values of a channel at the first samples of a recording. The run may end a step before the recording.
pub(super) fn less(recorded: &[f64], time: &[f64], run: &Recording, simulated: &[f64]) -> Vec<f64> {
    let last = run.time.last().copied().unwrap_or_default();
    let at = |t: f64| interpolate(&run.time, simulated, t.min(last));
    recorded.iter().zip(time).map(|(value, t)| value - at(*t)).collect()
}

/// A variable's value in the system, else its own.
pub(super) fn value_of(component: &PlannedComponent, slave: &dyn Slave, variable: &str) -> Option<Value> {
    let own = || {
        let index = slave.find(variable).ok()?;
        slave.interface().variables[index].start.clone()
    };
    let value = given(&component.set, variable).cloned().or_else(own)?;
    let index = slave.find(variable).ok()?;
    slave.interface().variables[index].accept_quantity(&value).ok()
}

/// What a change of a cause makes of a component's parameters: before and after.
pub(super) fn changed(
    component: &PlannedComponent,
    slave: &dyn Slave,
    cause: &Cause,
    x: &[f64],
) -> Result<Vec<(String, Value, Value)>> {
    let mut values = Vec::new();
    for (unknown, x) in cause.unknowns.iter().zip(x) {
        if matches!(unknown.how, How::Friction | How::Input) {
            continue;
        }
        for name in &unknown.names {
            let Some(before) = value_of(component, slave, name) else { continue };
            let mut after = unknown.how.changed(name, &before, *x)?;
            if let (Value::Real(v), Ok(index)) = (&mut after, slave.find(name)) {
                let info = &slave.interface().variables[index];
                *v = v.clamp(info.min.unwrap_or(f64::NEG_INFINITY), info.max.unwrap_or(f64::INFINITY));
            }
            values.push(((*name).to_owned(), before, after));
        }
    }
    Ok(values)
}

/// A component made anew.
///
/// # Errors
/// It cannot be made, or a value is not accepted.
pub(super) fn slave(component: &PlannedComponent) -> Result<Box<dyn Slave>> {
    let one =
        Plan { components: vec![component.clone()], source: component.place.clone(), ..Plan::default() };
    let system = one.load()?;
    let index = system.component(&component.name)?;
    Ok(system.into_slave(index))
}

/// The component of a plan by its name.
pub(super) fn component<'a>(plan: &'a Plan, name: &str) -> Result<&'a PlannedComponent> {
    let found = plan.components.iter().find(|c| c.name == name);
    found.ok_or_else(|| Error::variable(format!("{}: there is no component {name:?}", plan.source)))
}

/// A component with other values.
pub(super) fn with(component: &PlannedComponent, values: &[(String, Value, Value)]) -> PlannedComponent {
    let mut one = component.clone();
    for (name, _, after) in values {
        one.set.retain(|a| a.variable != *name);
        one.set.push(Assignment {
            variable: name.clone(),
            value: after.clone(),
            place: component.place.clone(),
        });
    }
    one
}

/// True for a component that is a model or FMU with all these variables.
pub(super) fn has_all(slave: &dyn Slave, variables: &[&str]) -> bool {
    variables.iter().all(|name| slave.find(name).is_ok())
}

/// The communication step of a plan.
pub(super) fn step(plan: &Plan) -> Result<f64> {
    plan.step.ok_or_else(|| Error::call(format!("{}: there is no communication step", plan.source)))
}

/// Whether a component is made from a file: for messages.
pub(super) fn source(component: &PlannedComponent) -> String {
    match &component.source {
        Source::Model(name, _) => name.clone(),
        Source::Fmu(path) => path.display().to_string(),
    }
}

/// Mean square of what channels vary by while the vehicle moves: also where only a piece of a run is compared.
pub(super) fn variation(recording: &Recording, channels: &[String], unit: &str) -> Result<Vec<f64>> {
    let end = moving(recording);
    let of = |name: &String| Ok(crate::stats::deviation(&recording.channel_in(name, unit)?[..end]).powi(2));
    channels.iter().map(of).collect()
}

/// Slower than this a vehicle is about to stand, and a brake that holds a wheel at rest has the torque that it takes for that \[m/s\].
pub(super) const SLOWEST: f64 = 5.0;

/// How many samples the vehicle moves for.
pub(super) fn moving(recording: &Recording) -> usize {
    let speed = recording.channels.iter().find(|c| c.name.ends_with("vehicle_speed"));
    let slow = speed.and_then(|c| recording.channel_in(&c.name, "m/s").ok());
    slow.and_then(|v| v.iter().position(|v| *v < SLOWEST)).unwrap_or(recording.time.len()).max(2)
}

/// How many samples a recording has in so long.
pub(super) fn samples_in(time: &[f64], seconds: f64) -> usize {
    (seconds / crate::stats::median_interval(time)).round() as usize
}

/// Recorded speeds of wheels are smoothed by parabolas over so long to each side: what a sensor's noise makes of the friction would shake the steering, and
/// a column that answers to it would look stiffer than it is; and a controller that looks at accelerations would decide by it. A wheel dips for some 0.1 s \[s\].
const WHEELS_SMOOTHED: f64 = 0.012;

/// A wheel's recorded speed with less of its sensor's noise.
pub(super) fn smooth_wheel_speed(time: &[f64], speeds: &[f64]) -> Vec<f64> {
    by_parabolas(speeds, samples_in(time, WHEELS_SMOOTHED))
}

/// The middle of the parabola through each value and so many neighbours on each side (Savitzky and Golay 1964), fewer at the ends.
fn by_parabolas(values: &[f64], half: usize) -> Vec<f64> {
    let last = values.len() - 1;
    (0..values.len())
        .map(|k| {
            let m = half.min(k).min(last - k) as i32;
            let weight = |j: i32| f64::from(3 * (3 * m * m + 3 * m - 1 - 5 * j * j));
            let whole = f64::from((2 * m + 3) * (2 * m + 1) * (2 * m - 1));
            if m == 0 {
                return values[k];
            }
            (-m..=m).map(|j| weight(j) * values[(k as i32 + j) as usize]).sum::<f64>() / whole
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parabolas_keep_a_cubic_and_take_noise_away() {
        let cubic = |k: f64| 2.0 - k + 0.3 * k * k - 0.01 * k * k * k;
        let values: Vec<f64> = (0..40).map(|k| cubic(f64::from(k))).collect();
        let kept = by_parabolas(&values, 6);
        for (a, b) in kept.iter().zip(&values) {
            assert!((a - b).abs() < 1e-9 * (1.0 + b.abs()), "{a} {b}");
        }
        let mut one = vec![0.0; 41];
        one[20] = 1.0;
        // the weight of the middle of 13 values: 25 / 143
        assert!((by_parabolas(&one, 6)[20] - 25.0 / 143.0).abs() < 1e-12);
    }
}
