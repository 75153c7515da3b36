//! Effects by name, as TOML: `corrected.toml` for people, `resources/model.toml` inside an FMU.
//!
//! ```toml
//! model = "ring-brush-flat-track"
//!
//! [parameters]
//! belt_mass = { value = 8.9, low = 8.7, high = 9.1 }
//!
//! [[effect]]
//! id = "relaxation-length"
//! target = "force_y"
//! drivers = ["path_speed"]
//!
//! [effect.parameters]
//! length = { value = 0.45, unit = "m", low = 0.41, high = 0.49, min = 0.0, max = 5.0 }
//! ```
//!
//! A driver is a variable, `rate(variable)` or `integral(variable)`, or the negative of one: `-rate(variable)`. `low` and
//! `high` are the interval that a fit gave and are for readers; `min` and `max` are what the parameter accepts. A parameter
//! may also be a plain number, or a text with a unit: `length = "45 cm"`. The communication step that an FMU of this proposes to
//! masters stands in `[simulation]`, where it is another one than the model's: `communication_step = 5e-5`, in seconds.

use super::{Attachment, Chosen, Effect, Parameter, Signal, Source};
use crate::model::unit::{Unit, quantity};
use crate::model::{Causality, Interface, Lines, Settings, VariableInfo, key, line_of};
use crate::{Error, Result};
use serde::Deserialize;
use std::collections::BTreeMap;
use std::fmt::Write as _;
use toml::Spanned;

/// A smallest or largest value, as two numbers.
pub type Interval = (f64, f64);

/// A corrected model as a file has it: values of the model's parameters, and effects by name.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Corrections {
    /// The model, the version, parameters and start values of inputs.
    pub settings: Settings,
    /// The model is the FMU that is carried along; inside FMUs only.
    pub original: bool,
    effects: Vec<Named>,
    /// Communication step that the effects were fitted with \[s\].
    pub step: Option<f64>,
}

/// An effect as it stands in a file.
#[derive(Debug, Clone, PartialEq)]
struct Named {
    effect: String,
    target: String,
    drivers: Vec<String>,
    /// Name, value and place of each.
    parameters: Vec<(String, toml::Value, String)>,
    /// `file:line`, for messages.
    place: String,
}

/// A fitted parameter of the model.
#[derive(Debug, Clone, PartialEq)]
pub struct Fitted {
    /// Name of the variable.
    pub name: String,
    /// Value, in the variable's unit.
    pub value: f64,
    /// Interval of the fit, if there is one.
    pub interval: Option<Interval>,
}

#[derive(Deserialize)]
struct File {
    #[serde(default)]
    original: bool,
    #[serde(default)]
    effect: Vec<Spanned<Table>>,
    simulation: Option<Simulation>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Simulation {
    communication_step: Spanned<f64>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Table {
    id: String,
    target: String,
    #[serde(default)]
    drivers: Vec<String>,
    #[serde(default)]
    parameters: BTreeMap<Spanned<String>, toml::Value>,
}

impl Corrections {
    /// Reads TOML; `place` names the file in messages. Names and ranges are checked by
    /// [`attachments`](Self::attachments) and [`Settings::check`].
    ///
    /// # Errors
    /// Not TOML, unknown keys, or values of another form, each with its line.
    pub fn parse(text: &str, place: &str) -> Result<Self> {
        let (settings, corrected) = Settings::parse_corrected(text, place)?;
        if !corrected {
            // every instance of an FMU reads this: not the same text twice
            return Ok(Self { settings, ..Self::default() });
        }
        let file: File = toml::from_str(text).map_err(|e| {
            let line = e.span().map_or(1, |span| line_of(text, span.start));
            Error::file(format!("{place}:{line}: {}", e.message()))
        })?;
        let lines = Lines::new(text);
        let at = |offset: usize| format!("{place}:{}", lines.of(offset));
        let effects = file.effect.into_iter().map(|table| {
            let place = at(table.span().start);
            let table = table.into_inner();
            let mut parameters: Vec<_> = table.parameters.into_iter().collect();
            parameters.sort_by_key(|(name, _)| name.span().start);
            let parameters = parameters.into_iter().map(|(name, value)| {
                let place = at(name.span().start);
                (name.into_inner(), value, place)
            });
            Named {
                effect: table.id,
                target: table.target,
                drivers: table.drivers,
                parameters: parameters.collect(),
                place,
            }
        });
        let effects = effects.collect();
        let step = file.simulation.map(|s| s.communication_step);
        if let Some(step) = step.as_ref().filter(|s| !(s.get_ref().is_finite() && *s.get_ref() > 0.0)) {
            return Err(Error::file(format!(
                "{}: communication_step has to be a positive time [s]",
                at(step.span().start)
            )));
        }
        Ok(Self { settings, original: file.original, effects, step: step.map(Spanned::into_inner) })
    }

    /// True if there are effects.
    pub fn has_effects(&self) -> bool {
        !self.effects.is_empty()
    }

    /// The effects, for a slave with this interface.
    ///
    /// # Errors
    /// An effect that the catalogue does not have, variables that the slave does not have, wrong numbers of
    /// drivers or parameters, values that are not accepted; each with its line.
    pub fn attachments(&self, interface: &Interface) -> Result<Vec<Attachment>> {
        self.effects.iter().map(|named| named.resolve(interface)).collect()
    }
}

impl Named {
    fn resolve(&self, interface: &Interface) -> Result<Attachment> {
        let at = |e: Error| Error::file(e.to_string()).at(format!("{}: effect {}", self.place, self.effect));
        let forms = || super::forms(&self.effect).filter(|e| e.drivers.len() == self.drivers.len());
        let named = |e: &Effect| {
            e.parameters.len() == self.parameters.len()
                && self.parameters.iter().all(|(name, ..)| e.parameters.iter().any(|p| p.name == *name))
        };
        let form = forms()
            .find(|e| named(e))
            .or_else(|| forms().find(|e| e.parameters.len() == self.parameters.len()))
            .or_else(|| forms().next());
        let effect = form.or_else(|| super::find(&self.effect)).ok_or_else(|| {
            let ids: Vec<&str> = super::catalogue::EFFECTS.iter().map(|e| e.id).collect();
            at(Error::variable(format!("there is no such effect; there is {}", ids.join(", "))))
        })?;
        let target = interface.find(&self.target).map_err(at)?;
        if self.drivers.len() != effect.drivers.len() {
            let needed: Vec<String> = effect.drivers.iter().map(|role| format!("{role:?}")).collect();
            return Err(at(Error::variable(match needed.as_slice() {
                [] => "it has no drivers".into(),
                needed => {
                    format!("drivers = [...] has to name {}: {}", needed.len(), needed.join(", "))
                }
            })));
        }
        let drivers = self.drivers.iter().map(|text| signal(interface, text));
        let drivers = drivers.collect::<Result<Vec<_>>>().map_err(at)?;
        if let Some((name, _, place)) =
            self.parameters.iter().find(|(name, ..)| effect.parameters.iter().all(|p| p.name != *name))
        {
            let names: Vec<&str> = effect.parameters.iter().map(|p| p.name).collect();
            return Err(Error::file(format!(
                "{place}: effect {} has no parameter {name}; it has {}",
                effect.id,
                names.join(", ")
            )));
        }
        let mut parameters = Vec::new();
        for parameter in effect.parameters {
            let given = self.parameters.iter().find(|(name, ..)| name == parameter.name);
            if given.is_none() && parameter.of_session {
                parameters.push(Chosen { value: 0.0, range: parameter.search, unit: None });
                continue;
            }
            let (name, value, place) = given
                .ok_or_else(|| at(Error::variable(format!("the parameter {} is missing", parameter.name))))?;
            let unit = natural_unit(parameter, interface, target, &drivers);
            let chosen = chosen(parameter, value, unit);
            parameters.push(chosen.map_err(|what| Error::file(format!("{place}: {name} {what}")))?);
        }
        Ok(Attachment { effect, target, drivers, parameters })
    }
}

/// The signal that a text names.
fn signal(interface: &Interface, text: &str) -> Result<Signal> {
    // a variable may be called like that
    if let Some(variable) = interface.index(text) {
        return Ok(Signal::value(variable));
    }
    if let Some(rest) = text.strip_prefix('-') {
        let signal = signal(interface, rest.trim_start())?;
        return Ok(Signal { is_turned: !signal.is_turned, ..signal });
    }
    for (word, source) in [("rate", Source::Rate), ("integral", Source::Integral)] {
        let inner = text.strip_prefix(word).and_then(|t| t.strip_prefix('(')?.strip_suffix(')'));
        if let Some(name) = inner {
            return Ok(Signal { source, ..Signal::value(interface.find(name.trim())?) });
        }
    }
    interface.find(text).map(Signal::value)
}

/// The text that names a signal.
fn signal_text(interface: &Interface, signal: Signal) -> String {
    let name = interface.variables.get(signal.variable).map_or("?", |v| v.name.as_str());
    let text = match signal.source {
        Source::Value => name.into(),
        Source::Rate => format!("rate({name})"),
        Source::Integral => format!("integral({name})"),
    };
    if signal.is_turned { format!("-{text}") } else { text }
}

/// The unit of an effect's parameter, where it is that of one of the numbers involved.
fn natural_unit(
    parameter: &Parameter,
    interface: &Interface,
    target: usize,
    drivers: &[Signal],
) -> Option<String> {
    let scale = parameter.scale;
    let of = |variable: usize| interface.variables.get(variable).and_then(|v: &VariableInfo| v.unit.clone());
    match (scale.unit, scale.target, scale.drivers) {
        ("1", 0, [0, 0, 0]) if scale.time == 1 => Some("s".into()),
        ("1", 0, [0, 0, 0]) if scale.time == -1 => Some("Hz".into()),
        _ if scale.time != 0 => None,
        (unit, 0, [0, 0, 0]) => Some(unit.into()),
        ("1", 1, [0, 0, 0]) => of(target),
        ("1", 0, powers) if powers.iter().map(|p| p.unsigned_abs()).sum::<u8>() == 1 => {
            let driver = powers.iter().position(|p| *p == 1).and_then(|i| drivers.get(i))?;
            of(driver.variable).filter(|_| driver.source == Source::Value)
        }
        _ => None,
    }
}

/// The value of a parameter in a file.
fn chosen(
    parameter: &Parameter,
    given: &toml::Value,
    natural: Option<String>,
) -> std::result::Result<Chosen, String> {
    let empty = toml::Table::new();
    let (table, main) = match given {
        toml::Value::Table(table) => (table, table.get("value").ok_or("has no value")?),
        other => (&empty, other),
    };
    let keys = ["value", "unit", "low", "high", "min", "max"];
    if let Some(key) = table.keys().find(|k| !keys.contains(&k.as_str())) {
        return Err(format!("has the unknown key {key}; there are {}", keys.join(", ")));
    }
    let written = match table.get("unit") {
        None => natural.clone(),
        Some(toml::Value::String(unit)) => Some(unit.clone()),
        Some(_) => return Err("has a unit that is no text".into()),
    };
    // numbers are in the unit that stands there; the effect computes in its own
    let (factor, offset) = match (&written, &natural) {
        (Some(written), Some(natural)) if written != natural => {
            let convert = || Unit::parse(written).ok()?.to(Unit::parse(natural).ok()?);
            convert().ok_or(format!("has the unit {written:?}, which does not convert to {natural:?}"))?
        }
        _ => (1.0, 0.0),
    };
    let number = |value: &toml::Value| -> std::result::Result<f64, String> {
        let value = match value {
            toml::Value::Float(v) => *v,
            toml::Value::Integer(v) => *v as f64,
            toml::Value::String(text) => {
                quantity(text, written.as_deref().unwrap_or("1")).map_err(|e| format!("= {e}"))?
            }
            other => return Err(format!("is a {}; a number is needed", other.type_str())),
        };
        if value.is_finite() { Ok(value * factor + offset) } else { Err("has to be a finite number".into()) }
    };
    let value = number(main)?;
    let own = own_range(parameter, value);
    let limit = |key: &str, own: f64| table.get(key).map_or(Ok(own), &number);
    let range = (limit("min", own.0)?, limit("max", own.1)?);
    // the interval is not used, but what stands there has to make sense
    let (low, high) = (limit("low", value)?, limit("high", value)?);
    if low > high {
        return Err(format!("has an interval from {low:?} to {high:?}"));
    }
    if !(range.0 <= value && value <= range.1) {
        return Err(format!(
            "= {value:?} is outside its range {:?} to {:?}; min and max change that",
            range.0, range.1
        ));
    }
    Ok(Chosen { value, range, unit: natural.or(written) })
}

/// The range of a parameter where the file gives none: how far a fit goes, or, where that depends on the
/// size of the signals, a wide range around the value on the same side of zero.
fn own_range(parameter: &Parameter, value: f64) -> Interval {
    let (low, high) = parameter.search;
    match parameter.scale.is_plain() {
        true => (low, high),
        false if low < 0.0 => (f64::NEG_INFINITY, f64::INFINITY),
        // a scale on which something happens is never zero
        false if low > 0.0 => (1e-3 * value.abs(), f64::INFINITY),
        false => (0.0, f64::INFINITY),
    }
}

/// The effects as TOML, for a slave with this interface, with the communication step \[s\] that suits them. `intervals` has one
/// list for each attachment with one interval for each parameter; what is missing is left out.
pub fn effects_text(
    interface: &Interface,
    attachments: &[Attachment],
    intervals: &[Vec<Option<Interval>>],
    step: Option<f64>,
) -> String {
    let mut text = String::new();
    if let Some(step) = step.filter(|_| !attachments.is_empty()) {
        let _ = write!(
            text,
            "\n[simulation]\ncommunication_step = {step:?} # [s]: longer ones give other results\n"
        );
    }
    for (k, attachment) in attachments.iter().enumerate() {
        let Effect { id, name, equation, parameters, .. } = attachment.effect;
        let quoted = |text: &str| toml::Value::String(text.into()).to_string();
        let target = interface.variables.get(attachment.target).map_or("?", |v| v.name.as_str());
        let _ = write!(text, "\n[[effect]] # {}: {}\n", comment(name), comment(equation));
        let _ = writeln!(text, "id = {}\ntarget = {}", quoted(id), quoted(target));
        if !attachment.drivers.is_empty() {
            let drivers = attachment.drivers.iter().map(|s| quoted(&signal_text(interface, *s)));
            let _ = writeln!(text, "drivers = [{}]", drivers.collect::<Vec<_>>().join(", "));
        }
        let _ = write!(text, "\n[effect.parameters]\n");
        for (i, (parameter, chosen)) in parameters.iter().zip(&attachment.parameters).enumerate() {
            let mut entry = format!("value = {:?}", chosen.value);
            if let Some(unit) = &chosen.unit {
                let _ = write!(entry, ", unit = {}", quoted(unit));
            }
            if let Some((low, high)) = intervals.get(k).and_then(|list| *list.get(i)?) {
                let _ = write!(entry, ", low = {low:?}, high = {high:?}");
            }
            for (key, limit) in [("min", chosen.range.0), ("max", chosen.range.1)] {
                if limit.is_finite() {
                    let _ = write!(entry, ", {key} = {limit:?}");
                }
            }
            let _ = writeln!(text, "{} = {{ {entry} }} # {}", parameter.name, comment(parameter.description));
        }
    }
    text
}

/// The file `corrected.toml`: fitted parameters of a model and effects, with their intervals. Only what
/// differs from the model has to be named.
///
/// # Errors
/// A parameter that the interface does not have.
pub fn corrected_text(
    interface: &Interface,
    parameters: &[Fitted],
    attachments: &[Attachment],
    intervals: &[Vec<Option<Interval>>],
    step: Option<f64>,
) -> Result<String> {
    let mut text = format!(
        "# Made by latsch {}. `latsch export MODEL --effects THIS_FILE` makes the corrected FMU.\nmodel = {}\n",
        crate::VERSION,
        toml::Value::String(interface.name.clone())
    );
    for (section, causality) in [("parameters", Causality::Parameter), ("inputs", Causality::Input)] {
        let mut lines = String::new();
        for fitted in parameters {
            let variable = &interface.variables[interface.find(&fitted.name)?];
            if (variable.causality == Causality::Input) != (causality == Causality::Input) {
                continue;
            }
            let value = match fitted.interval {
                None => format!("{:?}", fitted.value),
                Some((low, high)) => {
                    format!("{{ value = {:?}, low = {low:?}, high = {high:?} }}", fitted.value)
                }
            };
            let _ = writeln!(lines, "{} = {value}{}", key(&fitted.name), meaning(variable));
        }
        if !lines.is_empty() {
            let _ = write!(text, "\n[{section}]\n{lines}");
        }
    }
    text.push_str(&effects_text(interface, attachments, intervals, step));
    Ok(text)
}
/// Description and unit of a variable as a comment behind its value; nothing where it has neither.
pub(crate) fn meaning(variable: &VariableInfo) -> String {
    let unit = variable.unit.as_deref().map(|u| format!("[{u}]"));
    let parts = [Some(variable.description.clone()), unit];
    let parts: Vec<String> = parts.into_iter().flatten().filter(|part| !part.is_empty()).collect();
    if parts.is_empty() { String::new() } else { format!(" # {}", comment(&parts.join(" "))) }
}

/// A text for a comment: on one line.
fn comment(text: &str) -> String {
    text.chars().map(|c| if c.is_control() { ' ' } else { c }).collect()
}
