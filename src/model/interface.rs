//! What the outside sees of a slave: its variables without their Rust types.

use super::meaning::Meaning;
#[cfg(feature = "host")]
use super::meaning::Role;
use super::unit::quantity;
use crate::{Error, Result};
use serde::{Deserialize, Serialize};

/// Who gives a variable its value; the words are those of FMI 2.0.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum Causality {
    /// Set by the user before the run.
    Parameter,
    /// Computed from parameters before the run.
    CalculatedParameter,
    /// Set by the master during the run.
    Input,
    /// Computed for the master.
    Output,
    /// Computed, inside the model.
    Local,
    /// Time.
    Independent,
}

/// When a variable may change; the words are those of FMI 2.0.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum Variability {
    /// Never.
    Constant,
    /// Not after initialization.
    Fixed,
    /// Between communication points, by the user.
    Tunable,
    /// At communication points.
    Discrete,
    /// Always.
    Continuous,
}

/// How a variable gets its first value; the words are those of FMI 2.0.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum Initial {
    /// From its start value.
    Exact,
    /// From an iteration that begins at its start value.
    Approx,
    /// From the other variables.
    Calculated,
}

/// The type of a variable.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub enum Kind {
    /// Real number.
    Real,
    /// Whole number.
    Integer,
    /// Switch.
    Boolean,
    /// Text.
    Text,
    /// One of the named values 1, 2, ...: (name, description) each.
    Enumeration(Vec<(String, String)>),
}

/// A value of any type.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub enum Value {
    /// Switch.
    Boolean(bool),
    /// Whole number or item of an enumeration.
    Integer(i32),
    /// Real number.
    Real(f64),
    /// Text.
    Text(String),
}

impl From<f64> for Value {
    fn from(value: f64) -> Self {
        Self::Real(value)
    }
}

impl From<i32> for Value {
    fn from(value: i32) -> Self {
        Self::Integer(value)
    }
}

impl From<bool> for Value {
    fn from(value: bool) -> Self {
        Self::Boolean(value)
    }
}

impl From<&str> for Value {
    fn from(text: &str) -> Self {
        Self::Text(text.into())
    }
}

impl std::fmt::Display for Value {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Value::Boolean(v) => write!(f, "{v}"),
            Value::Integer(v) => write!(f, "{v}"),
            // Debug prints the shortest text that reads back as the same number, and switches to an
            // exponent where that is shorter.
            Value::Real(v) => write!(f, "{v:?}"),
            Value::Text(v) => write!(f, "{v}"),
        }
    }
}

impl Value {
    /// The value of a variable in words: a number, with a unit where the variable is real, `true` or
    /// `false`, the name or number of an item.
    ///
    /// # Errors
    /// A text that is none of these. Ranges are left to [`VariableInfo::accept`].
    pub fn from_text(variable: &VariableInfo, text: &str) -> Result<Self> {
        let not = |what: &str| Err(Error::variable(format!("{text:?} is not {what}")));
        match variable.kind {
            Kind::Text => Ok(Value::Text(text.into())),
            Kind::Boolean => match text {
                "true" | "1" => Ok(Value::Boolean(true)),
                "false" | "0" => Ok(Value::Boolean(false)),
                _ => not("true or false"),
            },
            Kind::Integer => text.parse().map(Value::Integer).or_else(|_| not("a whole number")),
            Kind::Enumeration(_) => {
                Ok(text.parse().map(Value::Integer).unwrap_or_else(|_| Value::Text(text.into())))
            }
            Kind::Real => quantity(text, variable.unit.as_deref().unwrap_or("1")).map(Value::Real),
        }
    }
}

/// One variable as the outside sees it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct VariableInfo {
    /// Its name, unique within the slave.
    pub name: String,
    /// FMI value reference.
    pub reference: u32,
    /// What it means.
    pub description: String,
    /// Unit of a real variable, in FMI notation.
    pub unit: Option<String>,
    /// Type.
    pub kind: Kind,
    /// Who sets it.
    pub causality: Causality,
    /// When it may change.
    pub variability: Variability,
    /// How it starts; `None` where FMI forbids the attribute.
    pub initial: Option<Initial>,
    /// Start value; `None` when calculated.
    pub start: Option<Value>,
    /// Smallest value accepted.
    pub min: Option<f64>,
    /// Largest value accepted.
    pub max: Option<f64>,
    /// Typical size.
    pub nominal: Option<f64>,
    /// What its author says that it is; `None` where names and units have to tell.
    pub meaning: Option<Meaning>,
}

impl VariableInfo {
    /// True for real variables.
    pub fn is_real(&self) -> bool {
        self.kind == Kind::Real
    }

    /// What its values 1, 2, ... are called, if it is an enumeration.
    pub fn items(&self) -> Option<Vec<String>> {
        match &self.kind {
            Kind::Enumeration(items) => Some(items.iter().map(|(name, _)| name.clone()).collect()),
            _ => None,
        }
    }

    /// As [`accept`](Self::accept), but a real variable also takes a text with a unit: `"170 N/mm"`.
    ///
    /// # Errors
    /// As [`accept`](Self::accept); a text that is no quantity or in a unit that does not convert.
    pub fn accept_quantity(&self, value: &Value) -> Result<Value> {
        match value {
            Value::Text(text) if self.is_real() => {
                let unit = self.unit.as_deref().unwrap_or("1");
                self.accept(&Value::Real(quantity(text, unit).map_err(|e| e.at(&self.name))?))
            }
            value => self.accept(value),
        }
    }

    /// The value, if this variable takes it: right type, finite, within min and max.
    ///
    /// # Errors
    /// A sentence that names the variable, the value and what is accepted.
    pub fn accept(&self, value: &Value) -> Result<Value> {
        let wrong = |what: &str| Err(Error::variable(format!("{} = {value}: {what}", self.name)));
        let shown = |v: f64| if self.is_real() { format!("{v:?}") } else { format!("{v:.0}") };
        let in_range = |v: f64| {
            let low = self.min.is_none_or(|min| v >= min);
            let high = self.max.is_none_or(|max| v <= max);
            if low && high {
                return Ok(());
            }
            let unit =
                self.unit.as_deref().filter(|u| *u != "1").map(|u| format!(" {u}")).unwrap_or_default();
            Err(Error::variable(match (self.min, self.max) {
                (Some(min), Some(max)) => format!(
                    "{} = {}{unit} is outside its range {} to {}{unit}",
                    self.name,
                    shown(v),
                    shown(min),
                    shown(max)
                ),
                (Some(min), None) => {
                    format!("{} = {}{unit} is below its minimum {}{unit}", self.name, shown(v), shown(min))
                }
                (_, max) => format!(
                    "{} = {}{unit} is above its maximum {}{unit}",
                    self.name,
                    shown(v),
                    shown(max.unwrap_or(f64::INFINITY))
                ),
            }))
        };
        let real = |v: f64| {
            if !v.is_finite() {
                return wrong("a finite number is needed");
            }
            in_range(v)?;
            Ok(Value::Real(v))
        };
        match (&self.kind, value) {
            (Kind::Real, Value::Real(v)) => real(*v),
            (Kind::Real, Value::Integer(v)) => real(f64::from(*v)),
            (Kind::Integer, Value::Integer(v)) => {
                in_range(f64::from(*v))?;
                Ok(value.clone())
            }
            (Kind::Enumeration(items), Value::Integer(v)) => {
                if *v < 1 || *v as usize > items.len() {
                    return wrong(&format!("the items are numbered 1 to {}", items.len()));
                }
                Ok(value.clone())
            }
            (Kind::Enumeration(items), Value::Text(text)) => {
                match items.iter().position(|(name, _)| name == text) {
                    Some(i) => Ok(Value::Integer(i as i32 + 1)),
                    None => wrong(&format!(
                        "one of {} is needed",
                        items.iter().map(|(n, _)| n.as_str()).collect::<Vec<_>>().join(", ")
                    )),
                }
            }
            (Kind::Boolean, Value::Boolean(_)) | (Kind::Text, Value::Text(_)) => Ok(value.clone()),
            (Kind::Real, _) => wrong("a number is needed"),
            (Kind::Integer | Kind::Enumeration(_), _) => wrong("a whole number is needed"),
            (Kind::Boolean, _) => wrong("true or false is needed"),
            (Kind::Text, _) => wrong("a text in quotes is needed"),
        }
    }
}

/// All that the outside needs to know of a slave before it runs.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Interface {
    /// Name of the model.
    pub name: String,
    /// What it models.
    pub description: String,
    /// Communication step that suits it \[s\].
    pub communication_step: f64,
    /// Start of its default experiment \[s\].
    pub start_time: f64,
    /// End of its default experiment \[s\].
    pub stop_time: f64,
    /// It offers directional derivatives of outputs by inputs.
    pub directional_derivatives: bool,
    /// The variables; a variable's position is its index in every call of [`Slave`](super::Slave).
    pub variables: Vec<VariableInfo>,
}

impl Interface {
    /// A number that changes with any variable, start value or text of the interface, and with the
    /// version of the library.
    pub fn fingerprint(&self) -> uuid::Uuid {
        // Plain data without maps: it always serialises, and always in the same way.
        let bytes = postcard::to_stdvec(&(crate::VERSION, self)).unwrap_or_default();
        uuid::Uuid::new_v5(&uuid::Uuid::NAMESPACE_OID, &bytes)
    }

    /// Index of the variable called `name`.
    pub fn index(&self, name: &str) -> Option<usize> {
        self.variables.iter().position(|v| v.name == name)
    }

    /// Index of the variable called `name`.
    ///
    /// # Errors
    /// No such variable; the message offers similar names.
    pub fn find(&self, name: &str) -> Result<usize> {
        self.index(name).ok_or_else(|| {
            Error::variable(format!("{} has no variable {name:?}{}", self.name, self.similar(name)))
        })
    }

    /// A hint `; did you mean ...?` for a name that is not there, or nothing.
    #[cfg(feature = "host")]
    fn similar(&self, name: &str) -> String {
        did_you_mean(name, self.variables.iter().map(|v| v.name.as_str()))
    }

    #[cfg(not(feature = "host"))]
    fn similar(&self, _name: &str) -> String {
        String::new()
    }

    /// The parameter that has a role, or, where the author of the model says nothing, this name and the
    /// unit s.
    #[cfg(feature = "host")]
    pub(crate) fn time_parameter(&self, role: Role, name: &str) -> Option<usize> {
        self.variables.iter().position(|info| {
            info.causality == Causality::Parameter
                && match info.meaning {
                    Some(meaning) => meaning.role == Some(role),
                    None => info.name == name && info.unit.as_deref() == Some("s"),
                }
        })
    }

    /// Indices of all variables of one causality.
    pub fn with(&self, causality: Causality) -> impl Iterator<Item = usize> + '_ {
        self.variables.iter().enumerate().filter(move |(_, v)| v.causality == causality).map(|(i, _)| i)
    }
}

/// A hint `; did you mean ...?` with the most similar of the names that there are, or nothing.
#[cfg(feature = "host")]
pub(crate) fn did_you_mean<'a>(name: &str, names: impl Iterator<Item = &'a str>) -> String {
    // the comparison takes the product of both lengths; nobody mistypes a name as long as this
    const LONGEST: usize = 200;
    if name.len() > LONGEST {
        return String::new();
    }
    let near = names
        .filter(|other| other.len() <= LONGEST)
        .map(|other| (strsim::jaro_winkler(name, other), other))
        .filter(|(score, _)| *score > 0.8)
        // the first of equals
        .reduce(|best, next| if next.0 > best.0 { next } else { best });
    near.map_or_else(String::new, |(_, best)| format!("; did you mean {best:?}?"))
}
