//! The typed variable table: every variable is declared once, with the way to reach it.

use super::interface::{Causality, Initial, Kind, Value, Variability, VariableInfo};

/// How a variable of the model `M` is read and written.
pub enum Access<M: 'static> {
    /// A real number in the unit of its declaration.
    Real(fn(&M) -> f64, fn(&mut M, f64)),
    /// An input with an optional rate: the setter gets the value and, when the master knows it,
    /// the first derivative.
    Rated(fn(&M) -> f64, fn(&mut M, f64, Option<f64>)),
    /// A whole number, or an item (from 1) of an enumeration.
    Integer(fn(&M) -> i32, fn(&mut M, i32)),
    /// A switch.
    Boolean(fn(&M) -> bool, fn(&mut M, bool)),
    /// A text.
    Text(fn(&M) -> &str, fn(&mut M, &str)),
}

impl<M> Clone for Access<M> {
    fn clone(&self) -> Self {
        *self
    }
}
impl<M> Copy for Access<M> {}

/// A start value as a table can hold it.
#[derive(Debug, Clone, Copy)]
pub enum Start {
    /// Real.
    Real(f64),
    /// Integer or enumeration.
    Integer(i32),
    /// Boolean.
    Boolean(bool),
    /// Text.
    Text(&'static str),
    /// Calculated by the model.
    None,
}

/// How a real output moves.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Change {
    /// Its difference over a step of the model tells how it goes on.
    Smooth,
    /// It goes on, but what it did last does not tell how.
    Ragged,
    /// It changes at instants and is held between them.
    Discrete,
}

/// One row of a model's variable table.
pub struct Variable<M: 'static> {
    name: &'static str,
    unit: &'static str,
    description: &'static str,
    causality: Causality,
    access: Access<M>,
    start: Start,
    min: Option<f64>,
    max: Option<f64>,
    nominal: Option<f64>,
    items: &'static [(&'static str, &'static str)],
    tunable: bool,
    runs_on: Option<&'static str>,
    change: Change,
}

/// Access to a real field: `real!(tire.belt.mass)`, inside `impl Model`.
#[macro_export]
macro_rules! real {
    ($($path:tt)+) => {
        $crate::model::Access::Real(|m: &Self| m.$($path)+, |m: &mut Self, value| m.$($path)+ = value)
    };
}

/// Access to an integer field.
#[macro_export]
macro_rules! integer {
    ($($path:tt)+) => {
        $crate::model::Access::Integer(|m: &Self| m.$($path)+, |m: &mut Self, value| m.$($path)+ = value)
    };
}

/// Access to a boolean field.
#[macro_export]
macro_rules! boolean {
    ($($path:tt)+) => {
        $crate::model::Access::Boolean(|m: &Self| m.$($path)+, |m: &mut Self, value| m.$($path)+ = value)
    };
}

const fn row<M>(
    name: &'static str,
    unit: &'static str,
    causality: Causality,
    access: Access<M>,
    description: &'static str,
    start: Start,
) -> Variable<M> {
    Variable {
        name,
        unit,
        description,
        causality,
        access,
        start,
        min: None,
        max: None,
        nominal: None,
        items: &[],
        tunable: false,
        runs_on: None,
        change: Change::Smooth,
    }
}

/// A real parameter, fixed after initialization. `unit` as in FMI: `"N.m/rad"`, `"1"`.
pub const fn parameter<M>(
    name: &'static str,
    unit: &'static str,
    access: Access<M>,
    start: f64,
    description: &'static str,
) -> Variable<M> {
    row(name, unit, Causality::Parameter, access, description, Start::Real(start))
}

/// A whole-number parameter.
pub const fn integer_parameter<M>(
    name: &'static str,
    access: Access<M>,
    start: i32,
    description: &'static str,
) -> Variable<M> {
    row(name, "", Causality::Parameter, access, description, Start::Integer(start))
}

/// A switch among the parameters.
pub const fn boolean_parameter<M>(
    name: &'static str,
    access: Access<M>,
    start: bool,
    description: &'static str,
) -> Variable<M> {
    row(name, "", Causality::Parameter, access, description, Start::Boolean(start))
}

/// A text among the parameters.
pub const fn text_parameter<M>(
    name: &'static str,
    access: Access<M>,
    start: &'static str,
    description: &'static str,
) -> Variable<M> {
    row(name, "", Causality::Parameter, access, description, Start::Text(start))
}

/// A continuous real input.
pub const fn input<M>(
    name: &'static str,
    unit: &'static str,
    access: Access<M>,
    start: f64,
    description: &'static str,
) -> Variable<M> {
    row(name, unit, Causality::Input, access, description, Start::Real(start))
}

/// An output. Real outputs are continuous unless marked [`discrete`](Variable::discrete); integer and boolean ones change at steps.
pub const fn output<M>(
    name: &'static str,
    unit: &'static str,
    access: Access<M>,
    description: &'static str,
) -> Variable<M> {
    row(name, unit, Causality::Output, access, description, Start::None)
}

/// A quantity inside the model that somebody may want to look at.
pub const fn local<M>(
    name: &'static str,
    unit: &'static str,
    access: Access<M>,
    description: &'static str,
) -> Variable<M> {
    row(name, unit, Causality::Local, access, description, Start::None)
}

impl<M: 'static> Variable<M> {
    /// The values that are accepted, ends included, in the variable's unit.
    #[must_use]
    pub const fn range(mut self, min: f64, max: f64) -> Self {
        self.min = Some(min);
        self.max = Some(max);
        self
    }

    /// The smallest value that is accepted.
    #[must_use]
    pub const fn min(mut self, min: f64) -> Self {
        self.min = Some(min);
        self
    }

    /// A typical size, for solvers that scale.
    #[must_use]
    pub const fn nominal(mut self, nominal: f64) -> Self {
        self.nominal = Some(nominal);
        self
    }

    /// Lets a parameter change between steps; see [`Model::tune`](super::Model::tune).
    #[must_use]
    pub const fn tunable(mut self) -> Self {
        self.tunable = true;
        self
    }

    /// A real output that changes at instants and is held between them: what a sampled controller sends. Its
    /// variability is discrete, its derivative over time 0.
    #[must_use]
    pub const fn discrete(mut self) -> Self {
        self.change = Change::Discrete;
        self
    }

    /// A real output whose last change does not tell how it goes on, such as a sum over parts that come and go
    /// within a step. Its derivative over time is given as 0, as FMI has it for an order that is not known: a
    /// master that extrapolates then holds the value.
    #[must_use]
    pub const fn without_derivative(mut self) -> Self {
        self.change = Change::Ragged;
        self
    }

    /// Lets a real input that comes without a derivative run on between communication points with the
    /// real input called `rate`: a position with the velocity that comes beside it, x + v t, or, where
    /// the velocity has a derivative a, x + v t + a t²/2.
    #[must_use]
    pub const fn runs_on(mut self, rate: &'static str) -> Self {
        self.runs_on = Some(rate);
        self
    }

    /// Makes an enumeration of an integer variable: (name, description) of the values 1, 2, ...
    #[must_use]
    pub const fn items(mut self, items: &'static [(&'static str, &'static str)]) -> Self {
        self.items = items;
        self
    }

    /// The name.
    pub const fn name(&self) -> &'static str {
        self.name
    }

    /// The input that is its rate between communication points where the master gives none.
    pub const fn natural_rate(&self) -> Option<&'static str> {
        self.runs_on
    }

    /// Its last change tells how it goes on, so that it has a derivative over time.
    pub const fn has_derivative(&self) -> bool {
        matches!(self.change, Change::Smooth)
    }

    /// How to reach it.
    pub const fn access(&self) -> Access<M> {
        self.access
    }

    /// The row without its types, as everything outside the model sees it.
    pub fn info(&self, reference: u32) -> VariableInfo {
        let kind = match self.access {
            Access::Real(..) | Access::Rated(..) => Kind::Real,
            Access::Integer(..) if self.items.is_empty() => Kind::Integer,
            Access::Integer(..) => Kind::Enumeration(
                self.items.iter().map(|(name, text)| ((*name).into(), (*text).into())).collect(),
            ),
            Access::Boolean(..) => Kind::Boolean,
            Access::Text(..) => Kind::Text,
        };
        let start = match self.start {
            Start::Real(v) => Some(Value::Real(v)),
            Start::Integer(v) => Some(Value::Integer(v)),
            Start::Boolean(v) => Some(Value::Boolean(v)),
            Start::Text(v) => Some(Value::Text(v.into())),
            Start::None => None,
        };
        let variability = match (self.causality, &kind) {
            (Causality::Parameter, _) if self.tunable => Variability::Tunable,
            (Causality::Parameter, _) => Variability::Fixed,
            (_, Kind::Real) if self.change != Change::Discrete => Variability::Continuous,
            _ => Variability::Discrete,
        };
        let initial = match self.causality {
            Causality::Parameter => Some(Initial::Exact),
            Causality::Input | Causality::Independent => None,
            _ => Some(Initial::Calculated),
        };
        VariableInfo {
            name: self.name.into(),
            reference,
            description: self.description.into(),
            unit: (!self.unit.is_empty()).then(|| self.unit.into()),
            kind,
            causality: self.causality,
            variability,
            initial,
            start,
            min: self.min,
            max: self.max,
            nominal: self.nominal,
        }
    }
}
