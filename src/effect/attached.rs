//! [`Attached`]: a slave with effects on its ports is a slave again.

use super::{Call, Earlier, Effect, MAX_DRIVERS, Memory, Port, remembered};
use crate::model::{
    Causality, Initial, Interface, Kind, Slave, Snapshot, Value, Variability, VariableInfo, wrong_order,
};
use crate::{Error, Result};
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// What of a variable drives an effect.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Source {
    /// Its value.
    Value,
    /// Its rate, over the last communication step; 0 at the start.
    Rate,
    /// Its integral over time since the start, by trapezoids.
    Integral,
}

/// A signal that drives an effect.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct Signal {
    /// Index of the variable in the slave without effects.
    pub variable: usize,
    /// What of it.
    pub source: Source,
    /// It drives with its negative: effects of a force count motions the way in which the force pushes, and a sensor may count
    /// them the other way.
    pub is_turned: bool,
}

impl Signal {
    /// A variable's own value.
    pub const fn value(variable: usize) -> Self {
        Self { variable, source: Source::Value, is_turned: false }
    }

    /// What drives, where this is what the signal is.
    pub const fn directed(self, now: f64) -> f64 {
        if self.is_turned { -now } else { now }
    }
}

/// A value of an effect's parameter, in the unit of the machine.
#[derive(Debug, Clone, PartialEq)]
pub struct Chosen {
    /// The value.
    pub value: f64,
    /// Smallest and largest value that is accepted.
    pub range: (f64, f64),
    /// Unit, if it has a name.
    pub unit: Option<String>,
}

/// An effect at a place.
#[derive(Debug, Clone)]
pub struct Attachment {
    /// Which.
    pub effect: &'static Effect,
    /// Index of the variable that it changes.
    pub target: usize,
    /// One for each of [`Effect::drivers`].
    pub drivers: Vec<Signal>,
    /// One for each of [`Effect::parameters`].
    pub parameters: Vec<Chosen>,
}

impl Attachment {
    /// What it changes at its place: an effect may sit elsewhere than at its own port.
    pub fn port(&self, interface: &Interface) -> Port {
        let own = self.effect.port;
        let at = match interface.variables.get(self.target).map(|v| v.causality) {
            Some(Causality::Parameter) => Port::Parameter,
            Some(Causality::Input) if own == Port::Output => Port::Input,
            _ => own,
        };
        if self.effect.also.iter().any(|(port, _)| *port == at) { at } else { own }
    }

    /// Its parameters, by number, that say something of a run by itself: they are variables.
    fn of_any_run(&self) -> impl Iterator<Item = usize> {
        let parameters = self.effect.parameters;
        (0..parameters.len()).filter(|i| !parameters[*i].of_session)
    }

    /// Name of one of its parameters as a variable: `effect.sensor_delay.force_y.delay`.
    pub fn variable(&self, interface: &Interface, parameter: usize) -> String {
        let effect = self.effect.id.replace('-', "_");
        let target = &interface.variables[self.target].name;
        format!("effect.{effect}.{target}.{}", self.effect.parameters[parameter].name)
    }
}

/// A slave with effects on its ports.
///
/// Its variables are those of the slave, followed by the parameters of the effects. Effects on inputs,
/// forces and parameters see outputs that run on from the last communication point as they did over the
/// last step: an error of second order in the communication step. Effects on outputs see the outputs and inputs of the same point. Several effects on one
/// variable act in the order in which they were attached. Where an output is passed on inside, as in a wired
/// system, what effects make of it is passed on.
///
/// The derivative of an output that an effect changes is the difference over the last communication step.
/// There are no directional derivatives.
pub struct Attached<S: Slave + ?Sized> {
    attachments: Vec<Attachment>,
    interface: Interface,
    /// Number of variables of the slave itself.
    own: usize,
    /// Variables with effects before the step, and those after it.
    before: Vec<Changed>,
    after: Vec<Changed>,
    signals: Vec<Signal>,
    /// What variables show at the start that effects are driven by.
    begins: Vec<(usize, f64)>,
    /// The runs of the session before this one.
    earlier: Arc<[Arc<Earlier>]>,
    state: State,
    inner: Box<S>,
}

/// A variable and its attachments: index, and places of the drivers in the list of signals.
struct Changed {
    variable: usize,
    by: Vec<(usize, Vec<usize>)>,
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
struct State {
    phase: Phase,
    time: f64,
    /// Parameters of each attachment.
    parameters: Vec<Vec<f64>>,
    memories: Vec<Memory>,
    /// Of the slave's inputs and changed parameters: value and rate as the master gave them.
    values: Vec<f64>,
    rates: Vec<f64>,
    /// The rate was given after the last step: a value that follows does not end it.
    fresh: Vec<bool>,
    /// Of the variables that are changed before the step: what the master's value was to be at the
    /// communication point, and what the slave got there.
    expected: Vec<(f64, f64)>,
    /// Of the variables that are changed after the step: value, and rate over the last step.
    outputs: Vec<(f64, f64)>,
    /// A step was made.
    stepped: bool,
    /// Of each signal: value of the variable, rate or integral, and rate of the value.
    signals: Vec<(f64, f64, f64)>,
    /// Of each signal: what effects get more than the slave says.
    ahead: Vec<f64>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
enum Phase {
    New,
    Starting,
    Running,
}

struct Saved {
    inner: Snapshot,
    state: State,
}

impl<S: Slave + ?Sized> Attached<S> {
    /// A slave that was not started, with effects.
    ///
    /// # Errors
    /// A target or driver that is no real variable of the right causality, or a number of drivers or
    /// parameters that is not the effect's.
    pub fn new(inner: Box<S>, attachments: Vec<Attachment>) -> Result<Self> {
        let interface = attached_interface(inner.interface(), &attachments)?;
        let own = inner.interface().variables.len();
        let mut signals: Vec<Signal> = Vec::new();
        let (mut before, mut after): (Vec<Changed>, Vec<Changed>) = (Vec::new(), Vec::new());
        for (k, attachment) in attachments.iter().enumerate() {
            let drivers = attachment.drivers.iter().map(|signal| {
                signals.iter().position(|s| s == signal).unwrap_or_else(|| {
                    signals.push(*signal);
                    signals.len() - 1
                })
            });
            let by = (k, drivers.collect());
            let list = if attachment.port(&interface) == Port::Output { &mut after } else { &mut before };
            match list.iter_mut().find(|c| c.variable == attachment.target) {
                Some(changed) => changed.by.push(by),
                None => list.push(Changed { variable: attachment.target, by: vec![by] }),
            }
        }
        let mut attached = Self {
            state: State {
                phase: Phase::New,
                time: 0.0,
                parameters: Vec::new(),
                memories: Vec::new(),
                values: Vec::new(),
                rates: Vec::new(),
                fresh: Vec::new(),
                expected: Vec::new(),
                outputs: Vec::new(),
                stepped: false,
                signals: Vec::new(),
                ahead: Vec::new(),
            },
            attachments,
            interface,
            own,
            before,
            after,
            signals,
            begins: Vec::new(),
            earlier: Arc::default(),
            inner,
        };
        attached.forget();
        Ok(attached)
    }

    /// Has the values of a variable, as effects get them, count from this one on, before the start: a wheel's angle counts from
    /// an index that the slave does not know. By itself a variable begins where the slave has it begin.
    pub fn begin_at(&mut self, variable: usize, value: f64) {
        self.begins.retain(|(v, _)| *v != variable);
        self.begins.push((variable, value));
    }

    /// Has the run come after others of a session, before the start: effects begin with what is left of their memory then.
    pub fn comes_after(&mut self, earlier: Arc<[Arc<Earlier>]>) {
        self.earlier = earlier;
    }

    /// The slave without effects.
    pub fn inner(&self) -> &S {
        &self.inner
    }

    /// The slave by itself again.
    pub fn into_inner(self) -> Box<S> {
        self.inner
    }

    fn forget(&mut self) {
        let start = |info: &VariableInfo| match info.start {
            Some(Value::Real(v)) => v,
            _ => 0.0,
        };
        self.state = State {
            phase: Phase::New,
            time: 0.0,
            parameters: self
                .attachments
                .iter()
                .map(|a| a.parameters.iter().map(|p| p.value).collect())
                .collect(),
            memories: vec![Memory::default(); self.attachments.len()],
            values: self.interface.variables[..self.own].iter().map(start).collect(),
            rates: vec![0.0; self.own],
            fresh: vec![false; self.own],
            expected: vec![(0.0, 0.0); self.before.len()],
            outputs: vec![(0.0, 0.0); self.after.len()],
            stepped: false,
            signals: vec![(0.0, 0.0, 0.0); self.signals.len()],
            ahead: vec![0.0; self.signals.len()],
        };
    }

    /// The attachment and parameter behind a variable.
    fn parameter(&self, variable: usize) -> Option<(usize, usize)> {
        let mut rest = variable.checked_sub(self.own)?;
        for (k, attachment) in self.attachments.iter().enumerate() {
            let own: Vec<usize> = attachment.of_any_run().collect();
            match own.get(rest) {
                Some(parameter) => return Some((k, *parameter)),
                None => rest -= own.len(),
            }
        }
        None
    }

    /// Reads the signals at a communication point that is `dt` after the last.
    fn sense(&mut self, dt: f64) -> Result<()> {
        let is_start = self.state.phase == Phase::Starting;
        let signals = self.signals.iter().zip(&mut self.state.signals).zip(&mut self.state.ahead);
        for ((signal, (value, more, slope)), ahead) in signals {
            let info = &self.interface.variables[signal.variable];
            let now = if info.causality == Causality::Input {
                self.state.values[signal.variable]
            } else {
                self.inner.get(signal.variable)?
            };
            *slope = if dt > 0.0 { (now - *value) / dt } else { 0.0 };
            match signal.source {
                Source::Value => {}
                Source::Rate if dt > 0.0 => *more = (now - *value) / dt,
                Source::Rate => *more = 0.0,
                Source::Integral => *more += 0.5 * dt * (now + *value),
            }
            *value = now;
            if is_start && let Some((_, begin)) = self.begins.iter().find(|(v, _)| *v == signal.variable) {
                *ahead = begin - now;
            }
        }
        Ok(())
    }

    /// A number after the effects on its variable.
    fn change(&mut self, after: bool, i: usize, mut target: f64, time: f64, dt: f64) -> f64 {
        let changed = if after { &self.after[i] } else { &self.before[i] };
        for (k, places) in &changed.by {
            let mut drivers = [0.0; MAX_DRIVERS];
            for (driver, place) in drivers.iter_mut().zip(places) {
                let (value, more, slope) = self.state.signals[*place];
                // before a step the end of the step is not known: signals run on as they did
                let ahead = if after { 0.0 } else { dt };
                let signal = self.signals[*place];
                *driver = signal.directed(match signal.source {
                    Source::Value => value + self.state.ahead[*place] + slope * ahead,
                    Source::Rate => more,
                    Source::Integral => more + (value + 0.5 * slope * ahead) * ahead,
                });
            }
            let drivers = &drivers[..places.len().min(MAX_DRIVERS)];
            let call = Call { time, dt, target, drivers, course: None };
            target = (self.attachments[*k].effect.apply)(
                &self.state.parameters[*k],
                &mut self.state.memories[*k],
                &call,
            );
        }
        target
    }

    fn change_outputs(&mut self, time: f64, dt: f64) -> Result<()> {
        for i in 0..self.after.len() {
            let target = self.inner.get(self.after[i].variable)?;
            let last = self.state.outputs[i].0;
            let now = self.change(true, i, target, time, dt);
            self.inner.change_passed_on(self.after[i].variable, now - target);
            self.state.outputs[i] = (now, if dt > 0.0 { (now - last) / dt } else { 0.0 });
        }
        Ok(())
    }
}

/// The interface of a slave with effects: its own, then the parameters of the effects.
///
/// # Errors
/// As [`Attached::new`].
pub fn attached_interface(inner: &Interface, attachments: &[Attachment]) -> Result<Interface> {
    let mut interface = inner.clone();
    interface.directional_derivatives = false;
    let own = interface.variables.len();
    let mut reference = interface.variables.iter().map(|v| v.reference).max().unwrap_or(0);
    for attachment in attachments {
        let effect = attachment.effect;
        check(&interface, own, attachment).map_err(|e| e.at(format!("effect {}", effect.id)))?;
        for i in attachment.of_any_run() {
            let (parameter, chosen) = (&effect.parameters[i], &attachment.parameters[i]);
            // a foreign slave may have the largest reference there is; who needs them unique, renumbers
            reference = reference.wrapping_add(1);
            let name = attachment.variable(&interface, i);
            if interface.index(&name).is_some() {
                return Err(Error::variable(format!("{name}: the effect is attached twice")));
            }
            interface.variables.push(VariableInfo {
                name,
                reference,
                description: format!("{}: {}", effect.name, parameter.description),
                unit: chosen.unit.clone(),
                kind: Kind::Real,
                causality: Causality::Parameter,
                variability: Variability::Fixed,
                initial: Some(Initial::Exact),
                start: Some(Value::Real(chosen.value)),
                min: Some(chosen.range.0).filter(|v| v.is_finite()),
                max: Some(chosen.range.1).filter(|v| v.is_finite()),
                nominal: None,
                meaning: None,
            });
        }
    }
    Ok(interface)
}

fn check(interface: &Interface, own: usize, attachment: &Attachment) -> Result<()> {
    let effect = attachment.effect;
    let target = interface.variables[..own].get(attachment.target);
    let target = target.ok_or_else(|| Error::variable("the changed variable is not there"))?;
    let port = attachment.port(interface);
    let fits = match port {
        Port::Input | Port::Force => target.causality == Causality::Input,
        Port::Output => matches!(target.causality, Causality::Output | Causality::Local),
        Port::Parameter => {
            target.causality == Causality::Parameter && target.variability == Variability::Tunable
        }
    };
    if !fits || target.kind != Kind::Real {
        let needed = match port {
            Port::Input | Port::Force => "a real input",
            Port::Output => "a real output",
            Port::Parameter => "a tunable real parameter",
        };
        return Err(Error::variable(format!("it changes {needed}; {} is none", target.name)));
    }
    if attachment.drivers.len() != effect.drivers.len() || effect.drivers.len() > MAX_DRIVERS {
        return Err(Error::variable(format!("it needs {} signals", effect.drivers.len())));
    }
    if attachment.parameters.len() != effect.parameters.len() {
        return Err(Error::variable(format!("it has {} parameters", effect.parameters.len())));
    }
    for signal in &attachment.drivers {
        let is_real = interface.variables[..own].get(signal.variable).is_some_and(VariableInfo::is_real);
        if !is_real {
            return Err(Error::variable("a signal that drives it is no real variable"));
        }
    }
    Ok(())
}

impl<S: Slave + ?Sized> Slave for Attached<S> {
    fn interface(&self) -> &Interface {
        &self.interface
    }

    fn get(&mut self, variable: usize) -> Result<f64> {
        if let Some((k, i)) = self.parameter(variable) {
            return Ok(self.state.parameters[k][i]);
        }
        if self.state.phase == Phase::Running
            && let Some(i) = self.after.iter().position(|c| c.variable == variable)
        {
            return Ok(self.state.outputs[i].0);
        }
        if self.before.iter().any(|c| c.variable == variable) {
            return Ok(self.state.values[variable]);
        }
        self.inner.get(variable)
    }

    fn set(&mut self, variable: usize, value: f64) -> Result<()> {
        if let Some((k, i)) = self.parameter(variable) {
            if self.state.phase == Phase::Running {
                return Err(wrong_order("setting a parameter of an effect", "after initialization"));
            }
            self.interface.variables[variable].accept(&Value::Real(value))?;
            self.state.parameters[k][i] = value;
            return Ok(());
        }
        if self.state.phase == Phase::Running && self.before.iter().any(|c| c.variable == variable) {
            // the slave gets it changed, with the next step
            self.interface.variables[variable].accept(&Value::Real(value))?;
        } else {
            self.inner.set(variable, value)?;
        }
        if variable < self.own {
            self.state.values[variable] = value;
            if !self.state.fresh[variable] {
                self.state.rates[variable] = 0.0;
            }
        }
        Ok(())
    }

    fn get_all(&mut self, variables: &[usize], values: &mut [f64]) -> Result<()> {
        if variables.iter().any(|v| *v >= self.own) {
            for (variable, value) in variables.iter().zip(values) {
                *value = self.get(*variable)?;
            }
            return Ok(());
        }
        self.inner.get_all(variables, values)?;
        if self.state.phase == Phase::Running {
            for (changed, output) in self.after.iter().zip(&self.state.outputs) {
                if let Some(i) = variables.iter().position(|v| *v == changed.variable) {
                    values[i] = output.0;
                }
            }
        }
        for changed in &self.before {
            if let Some(i) = variables.iter().position(|v| *v == changed.variable) {
                values[i] = self.state.values[changed.variable];
            }
        }
        Ok(())
    }

    fn set_all(&mut self, variables: &[usize], values: &[f64], rates: &[f64]) -> Result<()> {
        let apart = |v: &usize| *v >= self.own || self.before.iter().any(|c| c.variable == *v);
        if variables.iter().any(apart) {
            for ((variable, value), rate) in variables.iter().zip(values).zip(rates) {
                self.set(*variable, *value)?;
                self.set_rate(*variable, *rate)?;
            }
            return Ok(());
        }
        self.inner.set_all(variables, values, rates)?;
        for ((variable, value), rate) in variables.iter().zip(values).zip(rates) {
            (self.state.values[*variable], self.state.rates[*variable]) = (*value, *rate);
        }
        Ok(())
    }

    fn text(&mut self, variable: usize) -> Result<String> {
        self.inner.text(variable)
    }

    fn set_text(&mut self, variable: usize, text: &str) -> Result<()> {
        self.inner.set_text(variable, text)
    }

    fn set_rate(&mut self, variable: usize, rate: f64) -> Result<()> {
        let info = self.interface.variables.get(variable);
        let later = self.state.phase == Phase::Running
            && (!self.inner.can_interpolate() || self.before.iter().any(|c| c.variable == variable))
            && variable < self.own
            && info.is_some_and(|info| info.causality == Causality::Input && info.is_real())
            && rate.is_finite();
        if !later {
            // also where it is refused: in the slave's words
            self.inner.set_rate(variable, rate)?;
        }
        if variable < self.own {
            (self.state.rates[variable], self.state.fresh[variable]) = (rate, true);
        }
        Ok(())
    }

    /// Always: a slave that only holds its inputs gets their means over each step, and what they are at its end before
    /// outputs are read. Held from the step's beginning they would be half a step late.
    fn can_interpolate(&self) -> bool {
        true
    }

    fn start(&mut self, start: f64, stop: Option<f64>) -> Result<()> {
        self.inner.start(start, stop)?;
        self.state.time = start;
        self.state.phase = Phase::Starting;
        Ok(())
    }

    fn finish_start(&mut self) -> Result<()> {
        let time = self.state.time;
        for (k, attachment) in self.attachments.iter().enumerate() {
            let held = self.state.values[attachment.target];
            self.state.memories[k] = remembered(attachment, &self.state.parameters[k], held, &self.earlier);
        }
        self.sense(0.0)?;
        for i in 0..self.before.len() {
            let variable = self.before[i].variable;
            let value = self.state.values[variable];
            let changed = self.change(false, i, value, time, 0.0);
            if changed != value {
                self.inner.set(variable, changed)?;
            }
            self.state.expected[i] = (value, changed);
        }
        self.inner.finish_start()?;
        // what the changed inputs made of the outputs
        self.sense(0.0)?;
        self.change_outputs(time, 0.0)?;
        self.state.phase = Phase::Running;
        Ok(())
    }

    /// Of an output that an effect changes: the difference over the last communication step. Before the
    /// first step it is taken over a step that is tried and taken back; 0 where the slave cannot.
    fn output_derivative(&mut self, variable: usize) -> Result<f64> {
        let Some(i) = self.after.iter().position(|c| c.variable == variable) else {
            return self.inner.output_derivative(variable);
        };
        if self.state.phase != Phase::Running {
            let name = &self.interface.variables[variable].name;
            return Err(wrong_order(
                &format!("the derivative of {name}"),
                "before the end of initialization",
            ));
        }
        if !self.state.stepped
            && let Ok(saved) = self.save()
        {
            let length = self.interface.communication_step;
            let rate = self.step(self.state.time, length).map(|()| self.state.outputs[i].1);
            self.restore(&saved)?;
            // e.g. at the stop time
            return Ok(rate.unwrap_or(0.0));
        }
        Ok(self.state.outputs[i].1)
    }

    fn own_step(&self) -> Option<f64> {
        self.inner.own_step()
    }

    fn is_passed_on(&self, variable: usize) -> bool {
        self.inner.is_passed_on(variable)
    }

    fn warning(&self) -> Option<String> {
        self.inner.warning()
    }

    fn step(&mut self, time: f64, length: f64) -> Result<()> {
        let interpolates = self.inner.can_interpolate();
        // of a slave that holds its inputs: what they are at the end of the step
        let mut ends = Vec::new();
        for variable in 0..if interpolates { 0 } else { self.own } {
            let (value, rate) = (self.state.values[variable], self.state.rates[variable]);
            if rate != 0.0 && !self.before.iter().any(|c| c.variable == variable) {
                self.inner.set(variable, value + 0.5 * rate * length)?;
                ends.push((variable, value + rate * length));
            }
        }
        for i in 0..self.before.len() {
            let variable = self.before[i].variable;
            let (value, rate) = (self.state.values[variable], self.state.rates[variable]);
            let (expected, got) = self.state.expected[i];
            let goal = value + rate * length;
            let changed = self.change(false, i, goal, time + length, length);
            // a jump of the master's value passes on at once
            let begin = if got == expected { value } else { got + (value - expected) };
            if changed == goal && begin == value && (interpolates || rate == 0.0) {
                self.inner.set(variable, value)?;
                if rate != 0.0 {
                    self.inner.set_rate(variable, rate)?;
                }
            } else if interpolates && self.interface.variables[variable].causality == Causality::Input {
                self.inner.set(variable, begin)?;
                self.inner.set_rate(variable, (changed - begin) / length)?;
            } else if self.interface.variables[variable].causality == Causality::Input {
                self.inner.set(variable, 0.5 * (begin + changed))?;
                ends.push((variable, changed));
            } else {
                self.inner.set(variable, changed)?;
            }
            self.state.expected[i] = (goal, changed);
        }
        self.inner.step(time, length)?;
        for (variable, end) in ends {
            self.inner.set(variable, end)?;
        }
        self.state.time = time + length;
        self.state.stepped = true;
        // what the master does not set again runs on
        for (value, rate) in self.state.values.iter_mut().zip(&self.state.rates) {
            *value += rate * length;
        }
        self.state.fresh.fill(false);
        self.sense(length)?;
        self.change_outputs(time + length, length)
    }

    fn save(&mut self) -> Result<Snapshot> {
        Ok(Box::new(Saved { inner: self.inner.save()?, state: self.state.clone() }))
    }

    fn restore(&mut self, snapshot: &Snapshot) -> Result<()> {
        let saved = snapshot.downcast_ref::<Saved>();
        let saved = saved.ok_or_else(|| Error::call("the snapshot is of another kind of slave"))?;
        self.inner.restore(&saved.inner)?;
        self.state.clone_from(&saved.state);
        Ok(())
    }

    fn serialize(&mut self, snapshot: &Snapshot) -> Result<Vec<u8>> {
        let saved = snapshot.downcast_ref::<Saved>();
        let saved = saved.ok_or_else(|| Error::call("the snapshot is of another kind of slave"))?;
        let inner = self.inner.serialize(&saved.inner)?;
        postcard::to_stdvec(&(self.interface.fingerprint().into_bytes(), inner, &saved.state))
            .map_err(|e| Error::call(format!("the state cannot be written: {e}")))
    }

    fn deserialize(&mut self, bytes: &[u8]) -> Result<Snapshot> {
        let damaged = |_| Error::call("the bytes are no state of this slave, or damaged");
        let (fingerprint, inner, state): ([u8; 16], Vec<u8>, State) =
            postcard::from_bytes(bytes).map_err(damaged)?;
        let like = |a: usize, b: usize| a == b;
        let fits = fingerprint == self.interface.fingerprint().into_bytes()
            && like(state.parameters.len(), self.attachments.len())
            && state.parameters.iter().zip(&self.attachments).all(|(p, a)| like(p.len(), a.parameters.len()))
            && like(state.memories.len(), self.attachments.len())
            && like(state.values.len(), self.own)
            && like(state.rates.len(), self.own)
            && like(state.fresh.len(), self.own)
            && like(state.expected.len(), self.before.len())
            && like(state.outputs.len(), self.after.len())
            && like(state.signals.len(), self.signals.len())
            && like(state.ahead.len(), self.signals.len());
        if !fits {
            return Err(Error::call("the bytes are the state of another slave"));
        }
        Ok(Box::new(Saved { inner: self.inner.deserialize(&inner)?, state }))
    }

    fn reset(&mut self) -> Result<()> {
        self.inner.reset()?;
        self.forget();
        Ok(())
    }
}
