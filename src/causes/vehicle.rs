//! The vehicle under the recorded torques of its brakes, with the friction followed.

use super::cause::{Cause, How, of_vehicles};
use super::part::{
    Opened, Part, SLOWEST, changed, component, samples_in, slave, smooth_wheel_speed, source, step, value_of,
    with,
};
use super::runs::Recorded;
use crate::cosimulate::{Plan, PlannedComponent};
use crate::model::{Role, Slave, Value};
use crate::recording::interpolate;
use crate::{Error, Result};

/// How much the factor on the friction of a wheel answers to its speed being off \[s/rad\]: slip follows within some ten ms, and
/// noise of a wheel's speed of 0.3 rad/s becomes 3 % of friction.
const FOLLOWS: f64 = 0.1;
/// That factor stays within these: no road scatters by more, and beyond a wheel that is about to lock cannot be followed.
const FRICTION: [f64; 2] = [0.5, 1.5];
/// A friction is a torque over a load and a radius: its squared error is that of three quantities, each known as well as a sensor is.
const FRICTION_FROM: f64 = 3.0;
/// The recorded speed is smoothed over so long to each side \[s\].
const SMOOTHED: f64 = 0.025;
/// Torque below this share of the greatest is none: the time before it shows the sensors' zeros.
const UNBRAKED: f64 = 0.02;
/// The brake's torque is corrected by at most so much for what else turns the carrier: a coupling of 200 N.m.s/rad between axles that differ by 10 rad/s \[N.m\].
const CORRECTION: f64 = 2000.0;

pub(super) struct Vehicle<'a> {
    plan: Plan,
    opened: Opened<'a>,
    name: String,
    wheels: Vec<String>,
    travel: String,
    driven: Vec<Driven>,
}

/// What drives it in one run.
struct Driven {
    component: PlannedComponent,
    speed: Vec<f64>,
    wheel_speeds: Vec<Vec<f64>>,
    torques: Vec<Vec<f64>>,
    /// Further inputs that were recorded: name and course.
    others: Vec<(String, Vec<f64>)>,
    /// Samples that are compared.
    end: usize,
}

impl<'a> Vehicle<'a> {
    pub(super) fn new(plan: &Plan, runs: &'a [Recorded]) -> Result<Self> {
        let needed = ["brake_torque", "friction_factor", "wheel_speed", "carrier_moment_y"];
        for planned in &plan.components {
            let one = slave(planned)?;
            let wheels: Vec<String> = one
                .interface()
                .variables
                .iter()
                .filter_map(|v| v.name.strip_suffix(".wheel_speed"))
                .filter(|place| needed.iter().all(|n| one.find(&format!("{place}.{n}")).is_ok()))
                .map(str::to_owned)
                .collect();
            let travel = one.interface().variables.iter().find(|v| {
                v.name == "vehicle_speed" || v.meaning.and_then(|m| m.role) == Some(Role::TravelSpeed)
            });
            if let (false, Some(travel)) = (wheels.is_empty(), travel) {
                let travel = travel.name.clone();
                let causes: Vec<Cause> = of_vehicles()
                    .into_iter()
                    .filter(|c| c.unknowns.iter().all(|u| u.names.iter().all(|n| one.find(n).is_ok())))
                    .collect();
                let mut vehicle = Self {
                    plan: plan.clone(),
                    opened: Opened { runs, causes, channels: Vec::new(), step: step(plan)? },
                    name: planned.name.clone(),
                    wheels,
                    travel,
                    driven: Vec::new(),
                };
                vehicle.drive(&*one)?;
                return Ok(vehicle);
            }
        }
        Err(Error::call(format!(
            "{}: no component is a vehicle whose loop can be opened: outputs vehicle_speed, and for each wheel wheel_speed and carrier_moment_y, inputs brake_torque and friction_factor",
            plan.source
        )))
    }

    fn of(&self, wheel: &str, what: &str) -> String {
        format!("{}.{wheel}.{what}", self.name)
    }

    fn drive(&mut self, one: &dyn Slave) -> Result<()> {
        let prefix = format!("{}.", self.name);
        let first = &self.opened.runs[0].recording;
        let followed = |name: &str| name.ends_with(".wheel_speed") || name.ends_with(".carrier_moment_y");
        let is_output = |name: &str| {
            let variable = name.strip_prefix(&prefix).and_then(|v| one.find(v).ok());
            variable
                .is_some_and(|v| one.interface().variables[v].causality == crate::model::Causality::Output)
        };
        self.opened.channels = first
            .channels
            .iter()
            .map(|c| c.name.clone())
            .filter(|n| {
                is_output(n) && !followed(n) && self.opened.runs.iter().all(|run| run.recording.has(n))
            })
            .collect();
        let followed_friction: Vec<String> =
            self.wheels.iter().map(|wheel| self.of(wheel, "friction")).collect();
        self.opened.channels.extend(followed_friction);
        for run in self.opened.runs {
            let recording = &run.recording;
            let plan = run.applied(&self.plan)?;
            let mut part = component(&plan, &self.name)?.clone();
            if one.find("road_friction_deviation").is_ok() {
                // the scatter of the recorded road is followed, not that of another one added
                let values = [("road_friction_deviation".to_owned(), Value::Real(0.0), Value::Real(0.0))];
                part = with(&part, &values);
            }
            let course = |name: String, unit: &str| recording.channel_in(&name, unit);
            let speed = course(format!("{prefix}{}", self.travel), "m/s")?;
            let speed = smoothed(&speed, samples_in(&recording.time, SMOOTHED));
            let per_wheel = |what: &str, unit: &str| -> Result<Vec<Vec<f64>>> {
                self.wheels.iter().map(|wheel| course(self.of(wheel, what), unit)).collect()
            };
            let wheel_speeds: Vec<Vec<f64>> = per_wheel("wheel_speed", "rad/s")?
                .iter()
                .map(|speeds| smooth_wheel_speed(&recording.time, speeds))
                .collect();
            let mut torques = per_wheel("carrier_moment_y", "N.m")?;
            let onset = onset(&torques);
            for torque in &mut torques {
                let zero = mean(&torque[..onset]);
                torque.iter_mut().for_each(|v| *v -= zero);
            }
            let used = |name: &str| {
                !followed(name) && !name.ends_with(".brake_torque") && !name.ends_with(".friction_factor")
            };
            let others = recording
                .channels
                .iter()
                .filter_map(|c| Some((c, c.name.strip_prefix(&prefix)?)))
                .filter(|(_, name)| used(name))
                .filter_map(|(c, name)| {
                    let info = &one.interface().variables[one.find(name).ok()?];
                    (info.causality == crate::model::Causality::Input).then(|| {
                        Some((
                            name.to_owned(),
                            recording.channel_in(&c.name, info.unit.as_deref().unwrap_or("1")).ok()?,
                        ))
                    })?
                })
                .collect();
            // below that slip says nothing either: noise of the recorded speed is several percent of it
            let end = speed.iter().position(|v| *v < SLOWEST).unwrap_or(speed.len());
            if end < 2 {
                return Err(Error::file(format!(
                    "{}: it is slower than {SLOWEST} m/s from the start",
                    run.name
                )));
            }
            self.driven.push(Driven { component: part, speed, wheel_speeds, torques, others, end });
        }
        Ok(())
    }

    /// Recorded courses of the channels, at least as long as what is compared.
    fn measured(&self, run: usize) -> Result<Vec<Vec<f64>>> {
        let recording = &self.opened.runs[run].recording;
        let part = slave(&self.driven[run].component)?;
        let prefix = format!("{}.", self.name);
        let of = |(c, name): (usize, &String)| -> Result<Vec<f64>> {
            if !self.has_offset(c) {
                return Ok(vec![1.0; self.driven[run].end]);
            }
            let info = &part.interface().variables[part.find(name.strip_prefix(&prefix).unwrap_or(name))?];
            recording.channel_in(name, info.unit.as_deref().unwrap_or("1"))
        };
        self.opened.channels.iter().enumerate().map(of).collect()
    }

    /// Courses of the channels at the samples that are compared.
    fn simulated(&self, run: usize, changes: &[(usize, Vec<f64>)]) -> Result<Vec<Vec<f64>>> {
        let driven = &self.driven[run];
        let time = &self.opened.runs[run].recording.time;
        let mut part = driven.component.clone();
        let mut more = 0.0;
        for (cause, x) in changes {
            let cause = &self.opened.causes[*cause];
            let values = changed(&part, &*slave(&part)?, cause, x)?;
            part = with(&part, &values);
            for (unknown, x) in cause.unknowns.iter().zip(x) {
                if unknown.how == How::Friction {
                    more += x;
                }
            }
        }
        let mut slave = slave(&part)?;
        let index = |slave: &dyn Slave, name: &str| slave.find(name);
        let per_wheel = |slave: &dyn Slave, what: &str| -> Result<Vec<usize>> {
            self.wheels.iter().map(|wheel| index(slave, &format!("{wheel}.{what}"))).collect()
        };
        let (torque_in, friction_in) =
            (per_wheel(&*slave, "brake_torque")?, per_wheel(&*slave, "friction_factor")?);
        let (spin_out, moment_out) =
            (per_wheel(&*slave, "wheel_speed")?, per_wheel(&*slave, "carrier_moment_y")?);
        // as the system or this run has it, with what is tried
        let levels: Vec<f64> =
            self.wheels.iter().map(|wheel| friction_given(&part, &*slave, wheel) + more).collect();
        let travel = index(&*slave, &self.travel)?;
        let prefix = format!("{}.", self.name);
        let own = self.opened.channels.len() - self.wheels.len();
        let outputs: Vec<usize> = self.opened.channels[..own]
            .iter()
            .map(|name| index(&*slave, name.strip_prefix(&prefix).unwrap_or(name)))
            .collect::<Result<_>>()?;
        let others: Vec<usize> =
            driven.others.iter().map(|(n, _)| index(&*slave, n)).collect::<Result<_>>()?;
        let at = |values: &[f64], t: f64| interpolate(time, values, t);
        let start = time[0];
        for (input, (_, values)) in others.iter().zip(&driven.others) {
            slave.set(*input, values[0])?;
        }
        slave.start(start, None)?;
        slave.finish_start()?;
        let mut columns: Vec<Vec<f64>> = vec![Vec::with_capacity(driven.end); self.opened.channels.len()];
        let mut before: Vec<f64> = vec![0.0; self.opened.channels.len()];
        let mut now = before.clone();
        let mut factors = levels.clone();
        let mut torques = vec![0.0; self.wheels.len()];
        let mut sample = 0;
        for k in 0.. {
            let t = start + k as f64 * self.opened.step;
            std::mem::swap(&mut before, &mut now);
            for (value, output) in now.iter_mut().zip(&outputs) {
                *value = slave.get(*output)?;
            }
            for ((value, factor), level) in now[own..].iter_mut().zip(&factors).zip(&levels) {
                // how much more friction than the model believes
                *value = 1.0 + factor - level;
            }
            while sample < driven.end && time[sample] <= t + 1e-9 {
                let w = if k == 0 { 1.0 } else { 1.0 - (t - time[sample]) / self.opened.step };
                for (column, (a, b)) in columns.iter_mut().zip(before.iter().zip(&now)) {
                    column.push(if k == 0 { *b } else { a + w.clamp(0.0, 1.0) * (b - a) });
                }
                sample += 1;
            }
            if sample >= driven.end {
                break;
            }
            let speed = slave.get(travel)?;
            for wheel in 0..self.wheels.len() {
                let target = at(&driven.wheel_speeds[wheel], t) * speed / at(&driven.speed, t);
                let off = target - slave.get(spin_out[wheel])?;
                let level = levels[wheel];
                factors[wheel] = level * (1.0 + FOLLOWS * off / level).clamp(FRICTION[0], FRICTION[1]);
                slave.set(friction_in[wheel], factors[wheel])?;
                let told = if k == 0 { 0.0 } else { torques[wheel] - slave.get(moment_out[wheel])? };
                let wanted = at(&driven.torques[wheel], (t + self.opened.step).min(time[time.len() - 1]));
                torques[wheel] = (wanted + told.clamp(-CORRECTION, CORRECTION)).max(0.0);
                slave.set(torque_in[wheel], torques[wheel])?;
            }
            for (input, (_, values)) in others.iter().zip(&driven.others) {
                slave.set(*input, at(values, t))?;
            }
            slave.step(t, self.opened.step)?;
        }
        Ok(columns)
    }
}

impl Part for Vehicle<'_> {
    fn name(&self) -> String {
        let of = component(&self.plan, &self.name).map_or(String::new(), source);
        format!("{} ({of}) under the recorded brake torques, friction followed", self.name)
    }

    fn opened(&self) -> &Opened<'_> {
        &self.opened
    }

    fn has_offset(&self, channel: usize) -> bool {
        channel + self.wheels.len() < self.opened.channels.len()
    }

    fn errors(&self, run: usize, changes: &[(usize, Vec<f64>)]) -> Result<Vec<Vec<f64>>> {
        let simulated = self.simulated(run, changes).map_err(|e| e.at(&self.opened.runs[run].name))?;
        let measured = self.measured(run)?;
        let error = |(m, s): (Vec<f64>, Vec<f64>)| m.iter().zip(&s).map(|(m, s)| m - s).collect();
        Ok(measured.into_iter().zip(simulated).map(error).collect())
    }

    fn variation(&self, run: usize) -> Result<Vec<f64>> {
        let of = |(c, values): (usize, &Vec<f64>)| match self.has_offset(c) {
            true => crate::stats::deviation(&values[..self.driven[run].end]).powi(2),
            false => FRICTION_FROM,
        };
        Ok(self.measured(run)?.iter().enumerate().map(of).collect())
    }

    fn values(&self, cause: usize, x: &[f64]) -> Result<Vec<(String, Value, Value)>> {
        let part = component(&self.plan, &self.name)?;
        let cause = &self.opened.causes[cause];
        let mut values = changed(part, &*slave(part)?, cause, x)?;
        for (unknown, x) in cause.unknowns.iter().zip(x) {
            if unknown.how == How::Friction {
                for wheel in &self.wheels {
                    let before = friction_given(part, &*slave(part)?, wheel);
                    let name = format!("{wheel}.friction_factor");
                    values.push((name, Value::Real(before), Value::Real(before + x)));
                }
            }
        }
        values.iter_mut().for_each(|(name, ..)| *name = format!("{}.{name}", self.name));
        Ok(values)
    }
}

/// The factor on the friction of a wheel that a component is given.
fn friction_given(part: &PlannedComponent, slave: &dyn Slave, wheel: &str) -> f64 {
    match value_of(part, slave, &format!("{wheel}.friction_factor")) {
        Some(Value::Real(given)) => given,
        _ => 1.0,
    }
}

fn smoothed(values: &[f64], half: usize) -> Vec<f64> {
    (0..values.len())
        .map(|k| mean(&values[k.saturating_sub(half)..(k + half + 1).min(values.len())]))
        .collect()
}

fn mean(values: &[f64]) -> f64 {
    crate::stats::mean_or_zero(values)
}

/// The sample before the brakes begin.
pub(super) fn onset(torques: &[Vec<f64>]) -> usize {
    let sum = |k: usize| torques.iter().map(|t| t[k].abs()).sum::<f64>();
    let samples = torques.first().map_or(0, Vec::len);
    let most = (0..samples).map(sum).fold(0.0, f64::max);
    let begin = (0..samples).find(|k| sum(*k) > UNBRAKED * most).unwrap_or(0);
    // what a filter lets through before
    begin.saturating_sub(begin / 20)
}
