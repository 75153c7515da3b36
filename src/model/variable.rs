//! The typed variable table: every variable is declared once, with the way to reach it.

use super::access::{Access, Reach, Scalar, Way};
use super::interface::{Causality, Initial, Kind, Value, Variability, VariableInfo};
use super::meaning::{Meaning, Purpose, Role};
use super::table::reference;
use std::any::Any;
use std::borrow::Cow;
use std::marker::PhantomData;
use std::sync::Arc;

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

/// One row of a model's variable table, as the model `M` writes it.
pub struct Variable<M: 'static> {
    pub(super) row: Row,
    model: PhantomData<fn(&M)>,
}

/// One row of a variable table, without the type of its model: [`Table`](super::Table) knows that.
pub struct Row {
    name: Cow<'static, str>,
    unit: &'static str,
    description: Cow<'static, str>,
    causality: Causality,
    reach: Reach,
    start: Option<Value>,
    min: Option<f64>,
    max: Option<f64>,
    nominal: Option<f64>,
    items: &'static [(&'static str, &'static str)],
    tunable: bool,
    runs_on: Option<Cow<'static, str>>,
    change: Change,
    role: Option<Role>,
    purpose: Option<Purpose>,
}

/// Access to a real field: `real!(tire.belt.mass)`, inside `impl Model`.
#[macro_export]
macro_rules! real {
    ($($path:tt)+) => {
        $crate::model::Access::real(|m: &Self| m.$($path)+, |m: &mut Self, value| m.$($path)+ = value)
    };
}

/// Access to an integer field.
#[macro_export]
macro_rules! integer {
    ($($path:tt)+) => {
        $crate::model::Access::integer(|m: &Self| m.$($path)+, |m: &mut Self, value| m.$($path)+ = value)
    };
}

/// Access to a boolean field.
#[macro_export]
macro_rules! boolean {
    ($($path:tt)+) => {
        $crate::model::Access::boolean(|m: &Self| m.$($path)+, |m: &mut Self, value| m.$($path)+ = value)
    };
}

/// Access to a text field.
#[macro_export]
macro_rules! text {
    ($($path:tt)+) => {
        $crate::model::Access::text(
            |m: &Self| m.$($path)+.as_str(),
            |m: &mut Self, text: &str| m.$($path)+ = text.into(),
        )
    };
}

/// Access to a field that holds a value and its rate: anything with the fields `value` and `rate`.
#[macro_export]
macro_rules! rated {
    ($($path:tt)+) => {
        $crate::model::Access::rated(
            |m: &Self| m.$($path)+.value,
            |m: &mut Self, value, rate| {
                m.$($path)+.value = value;
                m.$($path)+.rate = rate;
            },
        )
    };
}

fn variable<M>(
    name: &'static str,
    unit: &'static str,
    causality: Causality,
    access: Access<M>,
    description: &'static str,
    start: Option<Value>,
) -> Variable<M> {
    Variable::of(Row::new(name, unit, causality, access.reach, description, start))
}

/// A real parameter, fixed after initialization. `unit` as in FMI: `"N.m/rad"`, `"1"`.
pub fn parameter<M>(
    name: &'static str,
    unit: &'static str,
    access: Access<M>,
    start: f64,
    description: &'static str,
) -> Variable<M> {
    variable(name, unit, Causality::Parameter, access, description, Some(start.into()))
}

/// A whole-number parameter.
pub fn integer_parameter<M>(
    name: &'static str,
    access: Access<M>,
    start: i32,
    description: &'static str,
) -> Variable<M> {
    variable(name, "", Causality::Parameter, access, description, Some(start.into()))
}

/// A switch among the parameters.
pub fn boolean_parameter<M>(
    name: &'static str,
    access: Access<M>,
    start: bool,
    description: &'static str,
) -> Variable<M> {
    variable(name, "", Causality::Parameter, access, description, Some(start.into()))
}

/// A text among the parameters.
pub fn text_parameter<M>(
    name: &'static str,
    access: Access<M>,
    start: &'static str,
    description: &'static str,
) -> Variable<M> {
    variable(name, "", Causality::Parameter, access, description, Some(start.into()))
}

/// A continuous real input.
pub fn input<M>(
    name: &'static str,
    unit: &'static str,
    access: Access<M>,
    start: f64,
    description: &'static str,
) -> Variable<M> {
    variable(name, unit, Causality::Input, access, description, Some(start.into()))
}

/// An output. Real outputs are continuous unless marked [`discrete`](Variable::discrete); integer and boolean ones change at steps.
pub fn output<M>(
    name: &'static str,
    unit: &'static str,
    access: Access<M>,
    description: &'static str,
) -> Variable<M> {
    variable(name, unit, Causality::Output, access, description, None)
}

/// A quantity inside the model that somebody may want to look at.
pub fn local<M>(
    name: &'static str,
    unit: &'static str,
    access: Access<M>,
    description: &'static str,
) -> Variable<M> {
    variable(name, unit, Causality::Local, access, description, None)
}

impl<M: 'static> Variable<M> {
    pub(super) fn of(row: Row) -> Self {
        Self { row, model: PhantomData }
    }

    /// The values that are accepted, ends included, in the variable's unit.
    #[must_use]
    pub fn range(mut self, min: f64, max: f64) -> Self {
        self.row.min = Some(min);
        self.row.max = Some(max);
        self
    }

    /// The smallest value that is accepted.
    #[must_use]
    pub fn min(mut self, min: f64) -> Self {
        self.row.min = Some(min);
        self
    }

    /// A typical size, for solvers that scale.
    #[must_use]
    pub fn nominal(mut self, nominal: f64) -> Self {
        self.row.nominal = Some(nominal);
        self
    }

    /// Lets a parameter change between steps; see [`Model::tune`](super::Model::tune).
    #[must_use]
    pub fn tunable(mut self) -> Self {
        self.row.tunable = true;
        self
    }

    /// A real output that changes at instants and is held between them: what a sampled controller sends. Its
    /// variability is discrete, its derivative over time 0.
    #[must_use]
    pub fn discrete(mut self) -> Self {
        self.row.change = Change::Discrete;
        self
    }

    /// A real output whose last change does not tell how it goes on, such as a sum over parts that come and go
    /// within a step. Its derivative over time is given as 0, as FMI has it for an order that is not known: a
    /// master that extrapolates then holds the value.
    #[must_use]
    pub fn without_derivative(mut self) -> Self {
        self.row.change = Change::Ragged;
        self
    }

    /// Lets a real input that comes without a derivative run on between communication points with the
    /// real input called `rate`: a position with the velocity that comes beside it, x + v t, or, where
    /// the velocity has a derivative a, x + v t + a t²/2.
    #[must_use]
    pub fn runs_on(mut self, rate: &'static str) -> Self {
        self.row.runs_on = Some(rate.into());
        self
    }

    /// Makes an enumeration of an integer variable: (name, description) of the values 1, 2, ...
    #[must_use]
    pub fn items(mut self, items: &'static [(&'static str, &'static str)]) -> Self {
        self.row.items = items;
        self
    }

    /// Says what the variable is to its machine; [`Role`] has what is taken for granted without it.
    #[must_use]
    pub fn role(mut self, role: Role) -> Self {
        self.row.role = Some(role);
        self
    }

    /// Says what a parameter is there for; without it, it is a property of the machine.
    #[must_use]
    pub fn purpose(mut self, purpose: Purpose) -> Self {
        self.row.purpose = Some(purpose);
        self
    }

    /// The same variable with another start value: a part may need another one in another whole.
    #[must_use]
    pub fn start(mut self, start: impl Into<Value>) -> Self {
        self.row.start = Some(start.into());
        self
    }

    /// The same variable with another description.
    #[must_use]
    pub fn described(mut self, description: impl Into<Cow<'static, str>>) -> Self {
        self.row.description = description.into();
        self
    }
}

impl Row {
    fn new(
        name: &'static str,
        unit: &'static str,
        causality: Causality,
        reach: Reach,
        description: &'static str,
        start: Option<Value>,
    ) -> Self {
        Self {
            name: name.into(),
            unit,
            description: description.into(),
            causality,
            reach,
            start,
            min: None,
            max: None,
            nominal: None,
            items: &[],
            tunable: false,
            runs_on: None,
            change: Change::Smooth,
            role: None,
            purpose: None,
        }
    }

    /// The same variable where the model is a part of another, under a prefix.
    pub(super) fn of_part(self, prefix: &str, way: &Arc<dyn Way>) -> Self {
        let prefixed = |name: Cow<'static, str>| match prefix.is_empty() {
            true => name,
            false => format!("{prefix}{name}").into(),
        };
        Self {
            name: prefixed(self.name),
            runs_on: self.runs_on.map(prefixed),
            reach: self.reach.through(way),
            ..self
        }
    }

    /// The same, [without a derivative](Variable::without_derivative) if it is a real output that has one.
    pub(super) fn without_derivative(self) -> Self {
        let smooth = self.causality == Causality::Output && self.is_real() && self.has_derivative();
        Self { change: if smooth { Change::Ragged } else { self.change }, ..self }
    }

    /// Writes the start value, if there is one.
    pub(super) fn write_start(&self, model: &mut dyn Any) {
        if let Some(start) = &self.start {
            self.write(model, start);
        }
    }

    /// The value in a model.
    ///
    /// # Panics
    /// If the row is not one of such a model.
    pub(super) fn read(&self, model: &dyn Any) -> Value {
        self.reach.end.read(self.reach.part(model))
    }

    /// The value of a real variable in a model; 0 of any other.
    ///
    /// # Panics
    /// As [`read`](Self::read).
    pub(super) fn real(&self, model: &dyn Any) -> f64 {
        self.reach.end.real(self.reach.part(model))
    }

    /// Writes a value that was [accepted](VariableInfo::accept) for the variable.
    ///
    /// # Panics
    /// As [`read`](Self::read).
    pub(super) fn write(&self, model: &mut dyn Any, value: &Value) {
        self.reach.end.write(self.reach.part_mut(model), value);
    }

    /// How to reach the value.
    pub(super) fn reach(&self) -> &Reach {
        &self.reach
    }

    /// True of a parameter.
    pub(super) fn is_parameter(&self) -> bool {
        self.causality == Causality::Parameter
    }

    /// True of a real number.
    pub(super) fn is_real(&self) -> bool {
        self.reach.scalar == Scalar::Real
    }

    /// True if the row says what the variable is or is there for.
    pub(super) fn has_meaning(&self) -> bool {
        self.role.is_some() || self.purpose.is_some()
    }

    /// The name.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// The input that is its rate between communication points where the master gives none.
    pub fn natural_rate(&self) -> Option<&str> {
        self.runs_on.as_deref()
    }

    /// Its last change tells how it goes on, so that it has a derivative over time.
    pub fn has_derivative(&self) -> bool {
        self.change == Change::Smooth
    }

    /// The row as everything outside the model sees it. `meaning`: the model says what its variables are.
    pub(super) fn info(&self, meaning: bool) -> VariableInfo {
        let kind = match self.reach.scalar {
            Scalar::Real => Kind::Real,
            Scalar::Integer if self.items.is_empty() => Kind::Integer,
            Scalar::Integer => Kind::Enumeration(
                self.items.iter().map(|(name, text)| ((*name).into(), (*text).into())).collect(),
            ),
            Scalar::Boolean => Kind::Boolean,
            Scalar::Text => Kind::Text,
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
            name: self.name.clone().into(),
            reference: reference(&self.name),
            description: self.description.clone().into(),
            unit: (!self.unit.is_empty()).then(|| self.unit.into()),
            kind,
            causality: self.causality,
            variability,
            initial,
            start: self.start.clone(),
            min: self.min,
            max: self.max,
            nominal: self.nominal,
            meaning: meaning.then(|| Meaning { role: self.role, purpose: self.purpose.unwrap_or_default() }),
        }
    }
}
