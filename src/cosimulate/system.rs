//! [`System`]: named slaves and what connects them.

use super::energy::Bond;
use super::master::{Coupling, Exchange};
use crate::model::unit::Unit;
use crate::model::{Causality, Interface, Kind, Role, Slave, Value, VariableInfo};
use crate::recording::{Channel, Recording, interpolate};
use crate::shown::one_line;
use crate::{Error, Result};
use std::collections::{HashMap, HashSet};
use std::rc::Rc;

/// Parameters that say how often a component does something by itself, and what that is. An interval of
/// communication has to be a whole multiple of the first; of the second it may also be a fraction,
/// because a controller that is called more often than its task runs waits.
const OWN_STEPS: [(Role, &str); 2] = [(Role::Step, "step_size"), (Role::SampleTime, "sample_time")];

/// Slaves by name, the connections between them, and recorded inputs.
pub struct System {
    /// How the components are coupled.
    pub coupling: Coupling,
    pub(super) components: Vec<Component>,
    pub(super) wires: Vec<Wire>,
    pub(super) feeds: Vec<Feed>,
    pub(super) bonds: Vec<Bond>,
    pub(super) exchange: Exchange,
    pub(super) warnings: Vec<String>,
    /// Components by name.
    by_name: HashMap<String, usize>,
    /// Inputs that have or had a wire or a feed: only for them the lists are searched.
    driven: HashSet<Port>,
    /// Variables that were set.
    given: HashSet<Port>,
}

/// A slave in a system.
pub struct Component {
    /// Its name in the system, without a dot.
    pub name: String,
    /// What it is, for reports.
    pub about: String,
    /// All its steps have to have the same length.
    pub even_steps_only: bool,
    /// The communication step that its maker names \[s\].
    pub preferred_step: Option<f64>,
    pub(super) slave: Box<dyn Slave>,
    /// Values of parameters and constant ones of inputs.
    pub(super) set: Vec<(usize, Value)>,
}

/// A variable of a component.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Port {
    /// Index of the component.
    pub component: usize,
    /// Index of the variable in the component's interface.
    pub variable: usize,
}

/// What happens to a value on its way from an output to an input.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Transfer {
    /// Linear transformation, after the conversion of units: factor * value + offset.
    pub linear: Option<(f64, f64)>,
    /// The numbers are taken as they are, whatever the units.
    pub keep_units: bool,
    /// The input gets a derivative, too, instead of being held: interpolation where the source was
    /// stepped before, otherwise extrapolation of its last interval.
    pub derivative: bool,
}

/// A connection.
pub(super) struct Wire {
    pub from: Port,
    pub to: Port,
    pub derivative: bool,
    /// A real number, which may be averaged and interpolated.
    pub real: bool,
    /// From the unit of the output to the input; `None` leaves the bits alone.
    pub map: Option<(f64, f64)>,
}

/// A connection that was cut: where its values came from, and how numbers at the output become those at the input.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cut {
    /// The output.
    pub from: Port,
    /// The input, which nothing is connected to any more.
    pub to: Port,
    /// The input was factor * output + offset.
    pub factor: f64,
    /// The input was factor * output + offset, in the input's unit.
    pub offset: f64,
}

/// An input that follows a recording.
pub(super) struct Feed {
    pub to: Port,
    pub time: Rc<[f64]>,
    pub values: Vec<f64>,
    pub continuous: bool,
    pub derivative: bool,
    /// It gets the value at the end of the interval, as from a source that is a step ahead.
    pub lead: bool,
}

impl Wire {
    /// The value at the input for one at the output.
    pub fn map(&self, value: f64) -> f64 {
        self.map.map_or(value, |(factor, offset)| factor * value + offset)
    }
}

impl Feed {
    /// The value at a time: between samples a line, for variables that are no real numbers the last
    /// sample.
    pub fn at(&self, time: f64) -> f64 {
        if self.continuous {
            return interpolate(&self.time, &self.values, time);
        }
        // a clock that adds up misses the samples by rounding
        let slack = 1e-9 * time.abs().max(1e-6);
        let next = self.time.partition_point(|sample| *sample <= time + slack);
        self.values[next.saturating_sub(1)]
    }
}

impl System {
    /// A system without components.
    pub fn new(coupling: Coupling) -> Self {
        Self {
            coupling,
            components: Vec::new(),
            wires: Vec::new(),
            feeds: Vec::new(),
            bonds: Vec::new(),
            exchange: Exchange::default(),
            warnings: Vec::new(),
            by_name: HashMap::new(),
            driven: HashSet::new(),
            given: HashSet::new(),
        }
    }

    /// Adds a slave that has not been started; gives its index.
    ///
    /// # Errors
    /// A name that is empty, has a dot (which ends a component's name in `component.variable`) or is
    /// there already.
    pub fn add(&mut self, name: &str, slave: Box<dyn Slave>) -> Result<usize> {
        if name.is_empty() || name.contains('.') {
            return Err(Error::file(format!("the component name {name:?} has to be a word without a dot")));
        }
        if self.by_name.contains_key(name) {
            return Err(Error::file(format!("there are two components {name:?}")));
        }
        self.by_name.insert(name.into(), self.components.len());
        self.components.push(Component {
            name: name.into(),
            about: slave.interface().name.clone(),
            even_steps_only: false,
            preferred_step: None,
            slave,
            set: Vec::new(),
        });
        Ok(self.components.len() - 1)
    }

    /// The components.
    pub fn components(&self) -> &[Component] {
        &self.components
    }

    /// A component by itself, with the values that it was given.
    pub fn into_slave(mut self, index: usize) -> Box<dyn Slave> {
        self.components.swap_remove(index).slave
    }

    /// A component, to say more about it.
    pub fn component_mut(&mut self, index: usize) -> &mut Component {
        &mut self.components[index]
    }

    /// What should be known before a run: what was not checked, what was left out.
    pub fn warnings(&self) -> &[String] {
        &self.warnings
    }

    /// Adds a warning.
    pub fn warn(&mut self, warning: String) {
        self.warnings.push(one_line(&warning));
    }

    /// Index of the component called `name`.
    ///
    /// # Errors
    /// None; the message lists those that are there.
    pub fn component(&self, name: &str) -> Result<usize> {
        self.by_name.get(name).copied().ok_or_else(|| {
            let names: Vec<&str> = self.components.iter().map(|c| c.name.as_str()).collect();
            Error::variable(format!("there is no component {name:?}; there is {}", names.join(", ")))
        })
    }

    /// A variable by the names of component and variable.
    ///
    /// # Errors
    /// No such component or variable.
    pub fn port(&self, component: &str, variable: &str) -> Result<Port> {
        let index = self.component(component)?;
        let variable = self.components[index].interface().find(variable).map_err(|e| e.at(component))?;
        Ok(Port { component: index, variable })
    }

    /// `component.variable`.
    pub fn name(&self, port: Port) -> String {
        format!("{}.{}", self.components[port.component].name, self.info(port).name)
    }

    /// What the component says of the variable.
    pub fn info(&self, port: Port) -> &VariableInfo {
        &self.components[port.component].interface().variables[port.variable]
    }

    /// Output and input of each connection.
    pub fn connections(&self) -> impl Iterator<Item = (Port, Port)> {
        self.wires.iter().map(|wire| (wire.from, wire.to))
    }

    /// What a parameter, or an input that has no other source, is before the start: the value that was set, else what the component starts
    /// with; `None` if it does not say.
    pub fn given(&self, port: Port) -> Option<&Value> {
        let component = &self.components[port.component];
        let set = component.set.iter().find(|(variable, _)| *variable == port.variable);
        set.map(|(_, value)| value).or(self.info(port).start.as_ref())
    }

    /// What a component has for a number now.
    ///
    /// # Errors
    /// A text, or a component that does not say.
    pub fn number(&mut self, port: Port) -> Result<f64> {
        let component = &mut self.components[port.component];
        component.slave.get(port.variable).map_err(|e| e.at(&component.name))
    }

    /// Gives a parameter its value, or an input a constant one, before the start.
    ///
    /// # Errors
    /// A variable that is neither, an input that has a source already, or a value that is not accepted.
    pub fn set(&mut self, port: Port, value: &Value) -> Result<()> {
        let info = self.info(port);
        let name = self.name(port);
        match info.causality {
            Causality::Parameter => {}
            Causality::Input => self.check_free(port, "a constant value")?,
            _ => {
                return Err(Error::variable(format!(
                    "{name} is computed by the component; it cannot be set"
                )));
            }
        }
        let value = self.info(port).accept(value).map_err(|e| e.at(&name))?;
        let first = self.given.insert(port);
        let component = &mut self.components[port.component];
        component.assign(port.variable, &value)?;
        if !first {
            component.set.retain(|(variable, _)| *variable != port.variable);
        }
        component.set.push((port.variable, value));
        Ok(())
    }

    /// Connects an output to an input.
    ///
    /// # Errors
    /// Not from an output to an input, an input that has a source already, types that do not go
    /// together, units that cannot be converted, a derivative for an input that takes none.
    pub fn connect(&mut self, from: Port, to: Port, transfer: Transfer) -> Result<()> {
        let (source, target) = (self.info(from), self.info(to));
        let (source_name, target_name) = (self.name(from), self.name(to));
        let place = format!("{source_name} -> {target_name}");
        let wrong = |what: String| Err(Error::variable(format!("{place}: {what}")));
        if source.causality != Causality::Output {
            return wrong(format!("{source_name} is {}, not an output", word(source.causality)));
        }
        if target.causality != Causality::Input {
            return wrong(format!("{target_name} is {}, not an input", word(target.causality)));
        }
        self.check_unset(to, &format!("the connection from {source_name}"))?;
        let real = source.kind == Kind::Real && target.kind == Kind::Real;
        let widened = source.kind == Kind::Integer && target.kind == Kind::Real;
        if source.kind == Kind::Text || !(source.kind == target.kind || widened) {
            return wrong(format!(
                "{source_name} is {}, {target_name} is {}; {}",
                kind(&source.kind),
                kind(&target.kind),
                if source.kind == target.kind {
                    "texts cannot be connected"
                } else {
                    "that does not go together"
                }
            ));
        }
        if transfer.linear.is_some() && !real {
            return wrong("only a real number can be transformed linearly".into());
        }
        if let Some((factor, offset)) = transfer.linear
            && !(factor.is_finite() && offset.is_finite())
        {
            return wrong(format!("factor {factor} and offset {offset} have to be finite"));
        }
        if transfer.derivative && !(real && self.components[to.component].slave.can_interpolate()) {
            return wrong(format!("{target_name} takes no derivative (canInterpolateInputs is not true)"));
        }
        let units = match real && !transfer.keep_units {
            true => conversion(source, target, transfer.linear.is_some()),
            false => Ok(Conversion::None),
        };
        let units = match units.map_err(|what| Error::variable(format!("{place}: {what}")))? {
            Conversion::None => None,
            Conversion::Factor(factor, offset) => Some((factor, offset)),
            Conversion::Unknown(what) => {
                self.warn(format!("{place}: {what}; the numbers are passed on as they are"));
                None
            }
        };
        let map = match (units, transfer.linear) {
            (None, None) => None,
            (Some(map), None) | (None, Some(map)) => Some(map),
            (Some((f, o)), Some((factor, offset))) => Some((factor * f, factor * o + offset)),
        };
        // multiplied by one and with nothing added, all bits stay, but for the sign of zero
        let map = map.filter(|map| *map != (1.0, 0.0));
        self.driven.insert(to);
        self.wires.push(Wire { from, to, derivative: transfer.derivative, real, map });
        Ok(())
    }

    /// Lets an input follow a channel of a recording.
    ///
    /// # Errors
    /// Not an input, an input that has a source already, a channel that is not there or whose unit does
    /// not fit, values outside the input's range, a derivative for an input that takes none.
    pub fn feed(&mut self, to: Port, recording: &Recording, channel: &str, derivative: bool) -> Result<()> {
        let info = self.info(to);
        let name = self.name(to);
        let place = format!("{}: channel {channel:?}", recording.source);
        let wrong = |what: String| Err(Error::file(format!("{place}: {what}")));
        if info.causality != Causality::Input {
            return wrong(format!("{name} is {}, not an input", word(info.causality)));
        }
        if info.kind == Kind::Text {
            return wrong(format!("{name} is a text"));
        }
        let continuous = info.kind == Kind::Real;
        if derivative && !(continuous && self.components[to.component].slave.can_interpolate()) {
            return wrong(format!("{name} takes no derivative (canInterpolateInputs is not true)"));
        }
        self.check_unset(to, &place)?;
        let values = recording.channel_in(channel, info.unit.as_deref().unwrap_or("1"))?;
        for (time, value) in recording.time.iter().zip(&values) {
            let Some(value) = typed(&info.kind, *value) else {
                return wrong(format!("at {time} s {name} = {value}: {} is needed", kind(&info.kind)));
            };
            info.accept(&value).map_err(|e| Error::file(format!("{place}: at {time} s {e}")))?;
        }
        self.driven.insert(to);
        self.feeds.push(Feed {
            to,
            time: recording.time.as_slice().into(),
            values,
            continuous,
            derivative,
            lead: false,
        });
        Ok(())
    }

    /// Opens the loop at a component: its connected inputs no longer follow their sources but the
    /// channels `component.input` of a recording, or where it has none the channel of the source. Gives the names of those inputs.
    ///
    /// In an interval they hold the sample at its end: a recording tells what an input had until then, and
    /// a source that is stepped first is that much ahead (Mack 2009, section 5.6). So a recording of all
    /// communication points of a closed loop gives the same bits when the loop is opened, as long as all
    /// inputs are held.
    ///
    /// # Errors
    /// A component without connected inputs, or channels that are missing or do not fit.
    pub fn open(&mut self, component: usize, recording: &Recording) -> Result<Vec<String>> {
        let cut = self.cut(component);
        if cut.is_empty() {
            let name = &self.components[component].name;
            return Err(Error::call(format!("{name} has no connected input: there is nothing to cut")));
        }
        let mut names = Vec::new();
        for cut in cut {
            let name = self.name(cut.to);
            let source = self.name(cut.from);
            if !recording.has(&name) && recording.has(&source) {
                self.feed(cut.to, &self.behind(&cut, recording)?, &name, false)?;
            } else {
                self.feed(cut.to, recording, &name, false)?;
            }
            if let Some(feed) = self.feeds.last_mut() {
                feed.lead = true;
            }
            names.push(name);
        }
        Ok(names)
    }

    /// The recorded output of a connection as what its input got.
    fn behind(&self, cut: &Cut, recording: &Recording) -> Result<Recording> {
        let unit = |port: Port| self.info(port).unit.as_deref().unwrap_or("1");
        let values = recording.channel_in(&self.name(cut.from), unit(cut.from))?;
        let channel = Channel {
            name: self.name(cut.to),
            unit: unit(cut.to).to_owned(),
            values: values.iter().map(|value| cut.factor * value + cut.offset).collect(),
        };
        Ok(Recording {
            time: recording.time.clone(),
            channels: vec![channel],
            source: recording.source.clone(),
        })
    }

    /// Cuts all connections into a component: its connected inputs become free ones.
    pub fn cut(&mut self, component: usize) -> Vec<Cut> {
        let (cut, kept): (Vec<Wire>, Vec<Wire>) =
            std::mem::take(&mut self.wires).into_iter().partition(|w| w.to.component == component);
        self.wires = kept;
        self.bonds.retain(|bond| {
            self.wires.iter().any(|w| w.to == bond.effort.to)
                && self.wires.iter().any(|w| w.to == bond.motion.to)
        });
        let of = |wire: Wire| {
            let (factor, offset) = wire.map.unwrap_or((1.0, 0.0));
            Cut { from: wire.from, to: wire.to, factor, offset }
        };
        cut.into_iter().map(of).collect()
    }

    /// True if an input follows a recording.
    pub fn follows(&self, to: Port) -> bool {
        self.feeds.iter().any(|feed| feed.to == to)
    }

    /// True if an input has no source of any kind.
    pub fn is_free(&self, to: Port) -> bool {
        self.check_unset(to, "").is_ok()
    }

    /// Fails if an input follows an output or a recording.
    fn check_free(&self, to: Port, second: &str) -> Result<()> {
        if !self.driven.contains(&to) {
            return Ok(());
        }
        let first = if let Some(wire) = self.wires.iter().find(|w| w.to == to) {
            format!("the connection from {}", self.name(wire.from))
        } else if self.feeds.iter().any(|f| f.to == to) {
            "a recording".into()
        } else {
            return Ok(());
        };
        Err(Error::variable(format!("{} has two sources: {first} and {second}", self.name(to))))
    }

    /// Fails if an input has any source.
    fn check_unset(&self, to: Port, second: &str) -> Result<()> {
        if self.given.contains(&to) {
            let name = self.name(to);
            return Err(Error::variable(format!("{name} has two sources: a constant value and {second}")));
        }
        self.check_free(to, second)
    }

    /// Checks that communication every `interval` seconds suits the components' own steps, once they are
    /// initialized: a component that cannot publish at the communication points would drift away from
    /// the others (Mack 2009, section 5.6).
    pub(super) fn check_interval(&mut self, interval: f64) -> Result<()> {
        for component in &mut self.components {
            let name = &component.name;
            for (role, usual_name) in OWN_STEPS {
                let interface = component.slave.interface();
                let Some(index) = interface.time_parameter(role, usual_name) else { continue };
                let parameter = interface.variables[index].name.clone();
                let own = component.slave.get(index).map_err(|e| e.at(name))?;
                let task = role == Role::SampleTime;
                // zero: it does so at every communication point
                if (task && own == 0.0) || is_multiple(interval, own) || (task && is_multiple(own, interval))
                {
                    continue;
                }
                let offered = own * (interval / own).round().max(1.0);
                return Err(Error::call(format!(
                    "the communication step {interval} s is no whole multiple of {name}.{parameter} = {own} s{}, so the components' times would drift apart; take {offered} s, or change {parameter}",
                    if task { ", nor a whole part of it" } else { "" }
                )));
            }
            if let Some(own) = component.slave.own_step()
                && !is_multiple(interval, own)
                && !is_multiple(own, interval)
            {
                return Err(Error::call(format!(
                    "the communication step {interval} s is no whole multiple of the step {own} s of {name}, nor a whole part of it, so the components' times would drift apart; take {} s",
                    own * (interval / own).round().max(1.0)
                )));
            }
            if let Some(preferred) = component.preferred_step.filter(|_| component.even_steps_only)
                && !is_multiple(interval, preferred)
            {
                self.warnings.push(one_line(&format!(
                    "the communication step {interval} s is no whole multiple of the step {preferred} s that the FMU of {name} names, and the FMU does not take any step (canHandleVariableCommunicationStepSize is not true)"
                )));
            }
        }
        Ok(())
    }
}

impl Component {
    /// What it is and which variables it has.
    pub fn interface(&self) -> &Interface {
        self.slave.interface()
    }

    /// Passes on a value that the variable accepted.
    pub(super) fn assign(&mut self, variable: usize, value: &Value) -> Result<()> {
        self.slave.set_value(variable, value).map_err(|e| e.at(&self.name))
    }
}

/// True if `long` is a whole multiple of `short`, to a relative 1e-9.
fn is_multiple(long: f64, short: f64) -> bool {
    let ratio = long / short;
    ratio.round() >= 1.0 && (ratio / ratio.round() - 1.0).abs() <= 1e-9
}

/// The number as a value of this type, if it is one.
fn typed(kind: &Kind, value: f64) -> Option<Value> {
    match kind {
        Kind::Real => Some(Value::Real(value)),
        Kind::Boolean => (value == 0.0 || value == 1.0).then_some(Value::Boolean(value == 1.0)),
        // the cast goes to the nearest number that there is
        Kind::Integer | Kind::Enumeration(_) => {
            (f64::from(value as i32) == value).then_some(Value::Integer(value as i32))
        }
        Kind::Text => None,
    }
}

enum Conversion {
    None,
    Factor(f64, f64),
    /// It cannot be said whether the units agree.
    Unknown(String),
}

/// How to convert between two real variables. With a `transformed` value other dimensions are meant.
fn conversion(
    source: &VariableInfo,
    target: &VariableInfo,
    transformed: bool,
) -> std::result::Result<Conversion, String> {
    let (from, to) = match (source.unit.as_deref(), target.unit.as_deref()) {
        (from, to) if from == to => return Ok(Conversion::None),
        (Some(from), Some(to)) => (from, to),
        (Some(unit), None) | (None, Some(unit)) => {
            return Ok(match unit {
                "1" | "-" => Conversion::None,
                _ => Conversion::Unknown(format!("one side is in {unit}, the other names no unit")),
            });
        }
        (None, None) => return Ok(Conversion::None),
    };
    let way_out = "give a factor, and the numbers are multiplied by that";
    match (Unit::parse(from), Unit::parse(to)) {
        (Ok(a), Ok(b)) => match a.to(b) {
            Some((1.0, 0.0)) => Ok(Conversion::None),
            Some((factor, offset)) => Ok(Conversion::Factor(factor, offset)),
            None if transformed => Ok(Conversion::None),
            None => Err(format!(
                "{from} cannot be converted to {to}: the dimensions differ; if it is meant, {way_out}"
            )),
        },
        _ if transformed => Ok(Conversion::None),
        (Err(e), _) | (_, Err(e)) => Err(format!("{from} to {to} cannot be converted: {e}; {way_out}")),
    }
}

fn word(causality: Causality) -> &'static str {
    match causality {
        Causality::Parameter => "a parameter",
        Causality::CalculatedParameter => "a calculated parameter",
        Causality::Input => "an input",
        Causality::Output => "an output",
        Causality::Local => "an internal quantity",
        Causality::Independent => "the time",
    }
}

fn kind(kind: &Kind) -> &'static str {
    match kind {
        Kind::Real => "a real number",
        Kind::Integer => "a whole number (32 bits)",
        Kind::Boolean => "a switch (0 or 1)",
        Kind::Text => "a text",
        Kind::Enumeration(_) => "an item of an enumeration",
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_that_no_integer_holds_are_not_cut_to_one() {
        assert_eq!(typed(&Kind::Integer, 2147483647.0), Some(Value::Integer(i32::MAX)));
        assert_eq!(typed(&Kind::Integer, -3.0), Some(Value::Integer(-3)));
        for value in [1e10, -1e10, 2147483648.0, 0.5, f64::NAN, f64::INFINITY] {
            assert_eq!(typed(&Kind::Integer, value), None, "{value}");
            assert_eq!(typed(&Kind::Enumeration(Vec::new()), value), None, "{value}");
        }
        assert_eq!(typed(&Kind::Boolean, 0.5), None);
    }
}
