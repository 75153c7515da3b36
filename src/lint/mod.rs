//! What is odd about a system before anyone believes its results: inputs that nothing drives, a controller with another
//! tire in mind, friction that no tire has, a car that does not stand as the measured one, communication steps too long
//! for what they pass on.
//!
//! After the checks that G. Mack (2009) asks for before each comparison (sections 5.8, 6.1, 6.2).

mod coupling;
mod limit;
mod measured;
mod pads;
mod radius;
mod wiring;

pub use measured::{Measured, read_measured};

use crate::Result;
use crate::cosimulate::{Experiment, Port, System, cosimulate, energy_warnings};
use crate::model::{Causality, Kind, Role};
use crate::recording::Recording;
use serde::Serialize;
use std::collections::HashMap;

/// What a check says.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Remark {
    /// How it is judged.
    pub judgement: Judgement,
    /// What was looked at.
    pub topic: &'static str,
    /// What was found, in numbers, and what to do.
    pub text: String,
}

/// A judgement.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Judgement {
    /// As it should be.
    Fine,
    /// Not checked: something is missing for it.
    Open,
    /// Somebody should look at it.
    Doubtful,
}

impl Remark {
    fn new(judgement: Judgement, topic: &'static str, text: String) -> Self {
        Self { judgement, topic, text }
    }

    fn open(topic: &'static str, text: impl Into<String>) -> Self {
        Self::new(Judgement::Open, topic, text.into())
    }

    /// Fine or doubtful.
    fn judged(fine: bool, topic: &'static str, text: String) -> Self {
        Self::new(if fine { Judgement::Fine } else { Judgement::Doubtful }, topic, text)
    }
}

/// Runs a system and looks at it. `fresh` makes the system, not started yet.
///
/// # Errors
/// A system that cannot be loaded or started, an experiment that does not fit, measured values of variables that are not
/// there.
pub fn lint(
    fresh: impl Fn() -> Result<System>,
    experiment: &Experiment,
    measured: &[Measured],
) -> Result<Vec<Remark>> {
    let all = Experiment { all: true, record_every: 1, ..*experiment };
    let run = |system: &mut System| cosimulate(system, &all, |_| {});
    let mut system = fresh()?;
    let outcome = run(&mut system)?;
    let mut remarks: Vec<Remark> = system
        .warnings()
        .iter()
        .chain(&energy_warnings(&system, experiment.step))
        .map(|warning| Remark::new(Judgement::Doubtful, "system", warning.clone()))
        .collect();
    if let Some(error) = &outcome.stopped {
        let text = format!("it stops before its end: {error}; what follows is about the time before");
        remarks.push(Remark::new(Judgement::Doubtful, "system", text));
    }
    let parameters = parameters(&mut system)?;
    let view = View { system: &system, run: &outcome.recording, parameters };
    remarks.extend(wiring::inputs(&view, |port, value| {
        let mut other = fresh()?;
        other.set(port, &value)?;
        Ok(run(&mut other)?.recording)
    })?);
    remarks.extend(radius::of_controllers(&view));
    remarks.extend(pads::constant_friction(&view));
    remarks.extend(limit::of_friction(&view));
    remarks.extend(limit::of_deceleration(&view));
    remarks.extend(coupling::steps(&view, experiment.step));
    remarks.extend(measured::compared(&view, measured)?);
    Ok(remarks)
}

/// All parameters that are numbers.
fn parameters(system: &mut System) -> Result<HashMap<Port, f64>> {
    let mut ports = Vec::new();
    for (component, one) in system.components().iter().enumerate() {
        let variables = one
            .interface()
            .with(Causality::Parameter)
            .chain(one.interface().with(Causality::CalculatedParameter));
        ports.extend(variables.map(|variable| Port { component, variable }));
    }
    ports.retain(|port| system.info(*port).kind != Kind::Text);
    ports.into_iter().map(|port| Ok((port, system.number(port)?))).collect()
}

/// A system behind its run.
struct View<'a> {
    system: &'a System,
    run: &'a Recording,
    parameters: HashMap<Port, f64>,
}

impl View<'_> {
    fn name(&self, port: Port) -> String {
        self.system.name(port)
    }

    /// The role that its author gave a variable.
    fn role(&self, port: Port) -> Option<Role> {
        self.system.info(port).meaning.and_then(|meaning| meaning.role)
    }

    /// Variables of a component.
    fn ports(&self, component: usize, causality: Causality) -> impl Iterator<Item = Port> {
        let variables = self.system.components()[component].interface().with(causality);
        variables.map(move |variable| Port { component, variable })
    }

    /// Outputs of a component with a role.
    fn outputs(&self, component: usize, role: Role) -> impl Iterator<Item = Port> {
        self.ports(component, Causality::Output).filter(move |port| self.role(*port) == Some(role))
    }

    /// The course of a variable; none if it was not recorded or has a unit that does not convert.
    fn course(&self, port: Port, unit: &str) -> Option<Vec<f64>> {
        self.run.channel_in(&self.name(port), unit).ok().filter(|values| !values.is_empty())
    }
}
