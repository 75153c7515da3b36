//! [`SystemSlave`]: a wired system as one slave, for all that knows slaves.

use super::master::Memory;
use super::system::{Port, System};
use crate::model::{
    Causality, Initial, Interface, Slave, Snapshot, Value, VariableInfo, check_experiment, check_step,
};
use crate::{Error, Result};

/// How far a step may be from a whole number of communication steps, in those.
const STEP_TOLERANCE: f64 = 1e-6;

/// A system that is stepped, saved and reset as one.
///
/// Its variables are those of its components, as `component.variable`; connected and recorded inputs are
/// internal quantities. Its steps are whole multiples of the communication step. Its state cannot be
/// turned into bytes.
pub struct SystemSlave {
    system: System,
    interface: Interface,
    /// Where each variable of the interface is.
    ports: Vec<Port>,
    clock: Clock,
    /// Warnings of the wiring, which stay after a reset.
    warnings: usize,
}

#[derive(Clone, Copy)]
struct Clock {
    phase: Phase,
    start: f64,
    stop: Option<f64>,
    /// Communication steps since the start.
    ticks: u64,
    time: f64,
}

#[derive(Clone, Copy, PartialEq)]
enum Phase {
    New,
    /// In initialization; `true`: something was set since outputs were exchanged.
    Starting(bool),
    Running,
    Failed,
}

const NEW: Clock = Clock { phase: Phase::New, start: 0.0, stop: None, ticks: 0, time: 0.0 };

struct Saved {
    components: Vec<Snapshot>,
    memory: Memory,
    clock: Clock,
}

impl SystemSlave {
    /// A slave of a system that was not started, with its communication step \[s\].
    ///
    /// # Errors
    /// A step that is not positive.
    pub fn new(name: &str, system: System, step: f64) -> Result<Self> {
        if !(step.is_finite() && step > 0.0) {
            return Err(Error::call(format!("the step {step} s has to be a positive time")));
        }
        let mut ports = Vec::new();
        let mut variables: Vec<VariableInfo> = Vec::new();
        for (component, part) in system.components.iter().enumerate() {
            for (variable, info) in part.interface().variables.iter().enumerate() {
                let port = Port { component, variable };
                let connected =
                    system.wires.iter().any(|w| w.to == port) || system.feeds.iter().any(|f| f.to == port);
                let set = part.set.iter().find(|(v, _)| *v == variable).map(|(_, value)| value.clone());
                let mut info = VariableInfo {
                    name: system.name(port),
                    reference: variables.len() as u32,
                    start: set.or_else(|| info.start.clone()),
                    ..info.clone()
                };
                match info.causality {
                    // there is one time, and it is not a component's
                    Causality::Independent => continue,
                    Causality::Input if connected => {
                        info.causality = Causality::Local;
                        info.initial = Some(Initial::Calculated);
                        info.start = None;
                    }
                    _ => {}
                }
                ports.push(port);
                variables.push(info);
            }
        }
        let interface = Interface {
            name: name.into(),
            description: "A co-simulated system".into(),
            communication_step: step,
            start_time: 0.0,
            stop_time: 1.0,
            directional_derivatives: false,
            variables,
        };
        let warnings = system.warnings.len();
        Ok(Self { system, interface, ports, clock: NEW, warnings })
    }

    /// The system.
    pub fn system(&self) -> &System {
        &self.system
    }

    /// Where a variable is in the system.
    ///
    /// # Errors
    /// No variable has that number.
    pub fn port(&self, variable: usize) -> Result<Port> {
        self.ports.get(variable).copied().ok_or_else(|| {
            Error::variable(format!("{} has no variable number {variable}", self.interface.name))
        })
    }

    /// The port of a variable that is to be set.
    fn settable(&mut self, variable: usize) -> Result<Port> {
        let port = self.port(variable)?;
        let info = &self.interface.variables[variable];
        if !matches!(info.causality, Causality::Parameter | Causality::Input) {
            return Err(Error::variable(format!(
                "{} is computed by the system; it cannot be set",
                info.name
            )));
        }
        if let Phase::Starting(stale) = &mut self.clock.phase {
            *stale = true;
        }
        Ok(port)
    }

    /// The port of a variable that is to be read; exchanges outputs during initialization.
    fn readable(&mut self, variable: usize) -> Result<Port> {
        if self.clock.phase == Phase::Starting(true) {
            self.system.settle()?;
            self.clock.phase = Phase::Starting(false);
        }
        self.port(variable)
    }

    fn wrong_order(&self, what: &str, when: &str) -> Error {
        Error::call(format!("{}: {what} is not possible {when}", self.interface.name))
    }
}

impl Slave for SystemSlave {
    fn interface(&self) -> &Interface {
        &self.interface
    }

    fn get(&mut self, variable: usize) -> Result<f64> {
        let port = self.readable(variable)?;
        let component = &mut self.system.components[port.component];
        component.slave.get(port.variable).map_err(|e| e.at(&component.name))
    }

    fn set(&mut self, variable: usize, value: f64) -> Result<()> {
        let port = self.settable(variable)?;
        self.system.components[port.component].assign(port.variable, &Value::Real(value))
    }

    fn text(&mut self, variable: usize) -> Result<String> {
        let port = self.readable(variable)?;
        let component = &mut self.system.components[port.component];
        component.slave.text(port.variable).map_err(|e| e.at(&component.name))
    }

    fn set_text(&mut self, variable: usize, text: &str) -> Result<()> {
        let port = self.settable(variable)?;
        self.system.components[port.component].assign(port.variable, &Value::Text(text.into()))
    }

    fn set_rate(&mut self, variable: usize, rate: f64) -> Result<()> {
        let port = self.settable(variable)?;
        let component = &mut self.system.components[port.component];
        component.slave.set_rate(port.variable, rate).map_err(|e| e.at(&component.name))
    }

    /// False: a derivative would be lost at communication points within a step.
    fn can_interpolate(&self) -> bool {
        false
    }

    fn start(&mut self, start: f64, stop: Option<f64>) -> Result<()> {
        if self.clock.phase != Phase::New {
            return Err(self.wrong_order("a start", "twice without a reset"));
        }
        check_experiment(start, stop)?;
        self.system.begin(start, stop)?;
        self.clock = Clock { phase: Phase::Starting(true), start, stop, ticks: 0, time: start };
        Ok(())
    }

    fn finish_start(&mut self) -> Result<()> {
        let Phase::Starting(stale) = self.clock.phase else {
            return Err(self.wrong_order("the end of initialization", "outside initialization"));
        };
        if stale {
            self.system.settle()?;
        }
        self.system.finish(self.interface.communication_step)?;
        self.clock.phase = Phase::Running;
        Ok(())
    }

    fn own_step(&self) -> Option<f64> {
        Some(self.interface.communication_step)
    }

    fn is_passed_on(&self, variable: usize) -> bool {
        self.ports.get(variable).is_some_and(|port| self.system.wires.iter().any(|w| w.from == *port))
    }

    fn change_passed_on(&mut self, variable: usize, change: f64) {
        if let Some(port) = self.ports.get(variable) {
            self.system.change_wires(*port, change);
        }
    }

    fn warning(&self) -> Option<String> {
        match self.system.warnings.as_slice() {
            [] => None,
            warnings => Some(warnings.join("; ")),
        }
    }

    fn step(&mut self, time: f64, length: f64) -> Result<()> {
        match self.clock.phase {
            Phase::Running => {}
            Phase::Failed => {
                return Err(self.wrong_order("a step", "after a failed step; restore or reset first"));
            }
            _ => return Err(self.wrong_order("a step", "before the end of initialization")),
        }
        let target = check_step(self.clock.time, time, length, self.clock.stop)?;
        let (start, step) = (self.clock.start, self.interface.communication_step);
        let position = (target - start) / step;
        let ticks = position.round();
        if (position - ticks).abs() > STEP_TOLERANCE.max(4.0 * f64::EPSILON * position) {
            return Err(Error::call(format!(
                "a step to {target} s: {} is stepped in whole multiples of its communication step {step} s",
                self.interface.name
            )));
        }
        while self.clock.ticks < ticks as u64 {
            let point = |n: u64| start + n as f64 * step;
            let (from, to) = (point(self.clock.ticks), point(self.clock.ticks + 1));
            if let Err(error) = self.system.advance(from, to - from) {
                self.clock.phase = Phase::Failed;
                return Err(error);
            }
            self.clock.ticks += 1;
        }
        self.clock.time = target;
        Ok(())
    }

    fn save(&mut self) -> Result<Snapshot> {
        let mut components = Vec::new();
        self.system.save_components(&mut components)?;
        Ok(Box::new(Saved { components, memory: self.system.memory(), clock: self.clock }))
    }

    fn restore(&mut self, snapshot: &Snapshot) -> Result<()> {
        let saved: &Saved =
            snapshot.downcast_ref().ok_or_else(|| Error::call("the saved state belongs to another slave"))?;
        self.system.restore_components(&saved.components)?;
        self.system.remember(&saved.memory);
        self.clock = saved.clock;
        Ok(())
    }

    fn serialize(&mut self, _: &Snapshot) -> Result<Vec<u8>> {
        Err(Error::call("the state of a system cannot be turned into bytes"))
    }

    fn deserialize(&mut self, _: &[u8]) -> Result<Snapshot> {
        Err(Error::call("the state of a system cannot be made from bytes"))
    }

    fn reset(&mut self) -> Result<()> {
        for component in &mut self.system.components {
            component.slave.reset().map_err(|e| e.at(&component.name))?;
            for (variable, value) in std::mem::take(&mut component.set) {
                component.assign(variable, &value)?;
                component.set.push((variable, value));
            }
        }
        self.system.warnings.truncate(self.warnings);
        self.clock = NEW;
        Ok(())
    }
}
