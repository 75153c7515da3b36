//! [`Car`]: the vehicle in a manoeuvre, by the names that the shipped vehicles have.

use super::reading::View;
use super::whole;
use crate::cosimulate::{
    Assignment, Plan, PlannedComponent, PlannedConnection, PlannedInputs, Port, PortName, Source, Transfer,
    Until, cosimulate_until,
};
use crate::model::Value;
use crate::recording::{Channel, Columns, Names, Recording, write_csv};
use crate::stats::mean;
use crate::{Error, Result};
use std::path::{Path, PathBuf};

/// Wheels, as the controller counts them.
pub(super) const WHEELS: [&str; 4] = ["front_left", "front_right", "rear_left", "rear_right"];
/// Communication step \[s\]: Mack 2009, section 5.6, has 0.1 to 1 ms for controllers and vehicles.
const STEP: f64 = 1e-3;
/// \[m/s2\].
pub(super) const GRAVITY: f64 = 9.81;
/// Where what a manoeuvre makes stands, in messages.
const PLACE: &str = "manoeuvre";

/// What is driven.
#[derive(Debug, Clone)]
pub enum Vehicle {
    /// A shipped model.
    Model(String),
    /// An FMU.
    Fmu(PathBuf),
}

/// A vehicle in a folder.
#[derive(Debug)]
pub struct Car {
    source: Source,
    names: Names,
    folder: PathBuf,
}

/// What a vehicle shows of itself in the first sample.
pub(super) struct Standing {
    /// Mass on the wheels \[kg\].
    pub mass: f64,
    /// Speed over spin speed of each wheel \[m\].
    pub radii: [f64; 4],
}

impl Car {
    pub(super) fn new(vehicle: Vehicle, names: Names, folder: &Path) -> Result<Self> {
        let source = match vehicle {
            Vehicle::Model(name) => Source::Model(name, None),
            Vehicle::Fmu(path) => {
                let own = folder.join("car.fmu");
                std::fs::copy(&path, &own).map_err(|e| Error::file(format!("{}: {e}", path.display())))?;
                Source::Fmu(own)
            }
        };
        Ok(Self { source, names, folder: folder.into() })
    }

    /// What the vehicle calls a variable.
    pub(super) fn name(&self, name: &str) -> String {
        self.names.get(name).cloned().unwrap_or_else(|| name.into())
    }

    fn port(&self, name: &str) -> PortName {
        PortName { component: "car".into(), variable: self.name(name) }
    }

    /// A system of the vehicle alone, with values by names.
    pub(super) fn plan(&self, stop: f64, set: &[(&str, Value)]) -> Plan {
        let set = set.iter().map(|(name, value)| assigned(&self.name(name), value.clone())).collect();
        let car =
            PlannedComponent { name: "car".into(), source: self.source.clone(), set, place: PLACE.into() };
        Plan {
            source: PLACE.into(),
            components: vec![car],
            step: Some(STEP),
            stop: Some(stop),
            record_every: 1,
            ..Plan::default()
        }
    }

    /// Lets inputs of the vehicle follow channels of a file that is written for it.
    pub(super) fn follow(
        &self,
        plan: &mut Plan,
        file: &str,
        time: &[f64],
        inputs: &[(&str, &str, Vec<f64>)],
    ) -> Result<()> {
        let channels = inputs.iter().map(|(name, unit, values)| Channel {
            name: (*name).into(),
            unit: (*unit).into(),
            values: values.clone(),
        });
        let recording = Recording { time: time.to_vec(), channels: channels.collect(), source: file.into() };
        let connect = inputs.iter().map(|(name, ..)| ((*name).to_owned(), self.port(name))).collect();
        self.drive(plan, file, &recording, connect)
    }

    /// Lets any inputs follow a recording that is written for it.
    pub(super) fn drive(
        &self,
        plan: &mut Plan,
        file: &str,
        recording: &Recording,
        connect: Vec<(String, PortName)>,
    ) -> Result<()> {
        let file = self.folder.join(file);
        write_csv(&file, recording)?;
        plan.inputs.push(PlannedInputs {
            file,
            columns: Columns::default(),
            connect,
            derivative: false,
            place: PLACE.into(),
        });
        Ok(())
    }

    /// Connects an output to an input; those of the vehicle by the names of manoeuvres.
    pub(super) fn connect(&self, plan: &mut Plan, from: (&str, &str), to: (&str, &str)) {
        let port = |(component, variable): (&str, &str)| match component {
            "car" => self.port(variable),
            other => PortName { component: other.into(), variable: variable.into() },
        };
        plan.connections.push(PlannedConnection {
            from: port(from),
            to: port(to),
            transfer: Transfer::default(),
            place: PLACE.into(),
        });
    }

    /// Runs a system to its end, or until the vehicle is slower than `until` \[m/s\].
    pub(super) fn run(&self, plan: &Plan, until: Option<f64>) -> Result<Recording> {
        let mut system = plan.load()?;
        let experiment = plan.experiment(&system, None, None, None)?;
        let until = match until {
            Some(value) => {
                let port: Port = system.port("car", &self.name("vehicle_speed"))?;
                Some(Until { port, above: false, value })
            }
            None => None,
        };
        whole(cosimulate_until(&mut system, &experiment, until, |_| {})?)
    }

    /// A parameter of the vehicle, if it has one of that name.
    pub(super) fn parameter(&self, plan: &Plan, name: &str) -> Result<Option<f64>> {
        let system = plan.load()?;
        let Ok(port) = system.port("car", &self.name(name)) else { return Ok(None) };
        Ok(match system.given(port) {
            Some(Value::Real(number)) => Some(*number),
            _ => None,
        })
    }

    /// What the vehicle shows while it rolls freely at a speed \[m/s\].
    pub(super) fn standing(&self, speed: f64) -> Result<Standing> {
        let plan = self.plan(10.0 * STEP, &[("initial_speed", Value::Real(speed))]);
        let run = self.run(&plan, None)?;
        let view = View { run: &run, car: self };
        let own = mean(&view.course("vehicle_speed", "m/s")?);
        let mut load = 0.0;
        let mut radii = [0.0; 4];
        for (radius, wheel) in radii.iter_mut().zip(WHEELS) {
            load += mean(&view.course(&format!("{wheel}.force_z"), "N")?);
            *radius = own / mean(&view.course(&format!("{wheel}.wheel_speed"), "rad/s")?);
        }
        if !radii.iter().all(|radius| radius.is_finite() && *radius > 0.0) || load <= 0.0 {
            return Err(Error::file(format!(
                "the vehicle does not roll forward on its wheels at {speed:.1} m/s: radii {radii:?} m, load {load:.0} N; \
                 is the sign of a variable another one?"
            )));
        }
        Ok(Standing { mass: load / GRAVITY, radii })
    }
}

/// A component that is shipped.
pub(super) fn shipped(name: &str, model: &str, set: &[(&str, Value)]) -> PlannedComponent {
    let set = set.iter().map(|(variable, value)| assigned(variable, value.clone())).collect();
    PlannedComponent {
        name: name.into(),
        source: Source::Model(model.into(), None),
        set,
        place: PLACE.into(),
    }
}

fn assigned(variable: &str, value: Value) -> Assignment {
    Assignment { variable: variable.into(), value, place: PLACE.into() }
}
