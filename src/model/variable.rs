//! The typed variable table: every variable is declared once, with the way to reach it.

use super::interface::{Causality, Initial, Kind, Value, Variability, VariableInfo};
use super::meaning::{Meaning, Purpose, Role};
use super::table::{Lens, reference};
use std::borrow::Cow;
use std::sync::Arc;

/// Reads a value from a model.
pub type Get<M, V> = Arc<dyn Fn(&M) -> V + Send + Sync>;
/// Writes a value to a model.
pub type Set<M, V> = Arc<dyn Fn(&mut M, V) + Send + Sync>;
/// Reads a text.
type GetText<M> = Arc<dyn Fn(&M) -> &str + Send + Sync>;
/// Writes a text.
type SetText<M> = Arc<dyn Fn(&mut M, &str) + Send + Sync>;
/// Writes the value of an input and, when the master knows it, its first derivative.
type SetRated<M> = Arc<dyn Fn(&mut M, f64, Option<f64>) + Send + Sync>;

/// How a variable of the model `M` is read and written.
pub enum Access<M: 'static> {
    /// A real number in the unit of its declaration.
    Real(Get<M, f64>, Set<M, f64>),
    /// An input with an optional rate.
    Rated(Get<M, f64>, SetRated<M>),
    /// A whole number, or an item (from 1) of an enumeration.
    Integer(Get<M, i32>, Set<M, i32>),
    /// A switch.
    Boolean(Get<M, bool>, Set<M, bool>),
    /// A text.
    Text(GetText<M>, SetText<M>),
}

impl<M> Clone for Access<M> {
    fn clone(&self) -> Self {
        match self {
            Self::Real(get, set) => Self::Real(get.clone(), set.clone()),
            Self::Rated(get, set) => Self::Rated(get.clone(), set.clone()),
            Self::Integer(get, set) => Self::Integer(get.clone(), set.clone()),
            Self::Boolean(get, set) => Self::Boolean(get.clone(), set.clone()),
            Self::Text(get, set) => Self::Text(get.clone(), set.clone()),
        }
    }
}

/// Functions of a row know nothing but the model, as a rule: a closure that captures something has a type of its own, and all that a shared
/// pointer to it needs is compiled for it.
impl<M: 'static> Access<M> {
    /// A real number that can be read and written.
    pub fn real(get: fn(&M) -> f64, set: fn(&mut M, f64)) -> Self {
        Self::Real(Arc::new(get), Arc::new(set))
    }

    /// A real number that is computed when it is read.
    pub fn computed(get: fn(&M) -> f64) -> Self {
        Self::real(get, |_, _| {})
    }

    /// As [`real`](Self::real), with closures that capture something.
    pub fn real_with(
        get: impl Fn(&M) -> f64 + Send + Sync + 'static,
        set: impl Fn(&mut M, f64) + Send + Sync + 'static,
    ) -> Self {
        Self::Real(Arc::new(get), Arc::new(set))
    }

    /// As [`computed`](Self::computed), with a closure that captures something.
    pub fn computed_with(get: impl Fn(&M) -> f64 + Send + Sync + 'static) -> Self {
        Self::real_with(get, |_, _| {})
    }

    /// An input whose setter gets the value and, when the master knows it, the first derivative.
    pub fn rated(get: fn(&M) -> f64, set: fn(&mut M, f64, Option<f64>)) -> Self {
        Self::Rated(Arc::new(get), Arc::new(set))
    }

    /// A whole number that can be read and written.
    pub fn integer(get: fn(&M) -> i32, set: fn(&mut M, i32)) -> Self {
        Self::Integer(Arc::new(get), Arc::new(set))
    }

    /// A whole number that is computed when it is read.
    pub fn computed_integer(get: fn(&M) -> i32) -> Self {
        Self::integer(get, |_, _| {})
    }

    /// A switch that can be read and written.
    pub fn boolean(get: fn(&M) -> bool, set: fn(&mut M, bool)) -> Self {
        Self::Boolean(Arc::new(get), Arc::new(set))
    }

    /// A switch that is computed when it is read.
    pub fn computed_boolean(get: fn(&M) -> bool) -> Self {
        Self::boolean(get, |_, _| {})
    }

    /// A text that can be read and written.
    pub fn text(get: fn(&M) -> &str, set: fn(&mut M, &str)) -> Self {
        Self::Text(Arc::new(get), Arc::new(set))
    }

    /// The access to the same value where the model is a part of another.
    fn through<W: 'static>(self, lens: &Lens<W, M>) -> Access<W> {
        fn get<W: 'static, M: 'static, V: 'static>(lens: &Lens<W, M>, get: Get<M, V>) -> Get<W, V> {
            let of = lens.of.clone();
            Arc::new(move |whole| get(of(whole)))
        }
        fn set<W: 'static, M: 'static, V: 'static>(lens: &Lens<W, M>, set: Set<M, V>) -> Set<W, V> {
            let of_mut = lens.of_mut.clone();
            Arc::new(move |whole, value| set(of_mut(whole), value))
        }
        let (of, of_mut) = (lens.of.clone(), lens.of_mut.clone());
        match self {
            Self::Real(g, s) => Access::Real(get(lens, g), set(lens, s)),
            Self::Rated(g, s) => {
                Access::Rated(get(lens, g), Arc::new(move |w, value, rate| s(of_mut(w), value, rate)))
            }
            Self::Integer(g, s) => Access::Integer(get(lens, g), set(lens, s)),
            Self::Boolean(g, s) => Access::Boolean(get(lens, g), set(lens, s)),
            Self::Text(g, s) => {
                Access::Text(Arc::new(move |w| g(of(w))), Arc::new(move |w, text| s(of_mut(w), text)))
            }
        }
    }
}

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

impl From<f64> for Start {
    fn from(value: f64) -> Self {
        Self::Real(value)
    }
}

impl From<i32> for Start {
    fn from(value: i32) -> Self {
        Self::Integer(value)
    }
}

impl From<&'static str> for Start {
    fn from(value: &'static str) -> Self {
        Self::Text(value)
    }
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
    name: Cow<'static, str>,
    unit: &'static str,
    description: Cow<'static, str>,
    causality: Causality,
    access: Access<M>,
    start: Start,
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

fn row<M>(
    name: &'static str,
    unit: &'static str,
    causality: Causality,
    access: Access<M>,
    description: &'static str,
    start: Start,
) -> Variable<M> {
    Variable {
        name: name.into(),
        unit,
        description: description.into(),
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
        role: None,
        purpose: None,
    }
}

/// A real parameter, fixed after initialization. `unit` as in FMI: `"N.m/rad"`, `"1"`.
pub fn parameter<M>(
    name: &'static str,
    unit: &'static str,
    access: Access<M>,
    start: f64,
    description: &'static str,
) -> Variable<M> {
    row(name, unit, Causality::Parameter, access, description, Start::Real(start))
}

/// A whole-number parameter.
pub fn integer_parameter<M>(
    name: &'static str,
    access: Access<M>,
    start: i32,
    description: &'static str,
) -> Variable<M> {
    row(name, "", Causality::Parameter, access, description, Start::Integer(start))
}

/// A switch among the parameters.
pub fn boolean_parameter<M>(
    name: &'static str,
    access: Access<M>,
    start: bool,
    description: &'static str,
) -> Variable<M> {
    row(name, "", Causality::Parameter, access, description, Start::Boolean(start))
}

/// A text among the parameters.
pub fn text_parameter<M>(
    name: &'static str,
    access: Access<M>,
    start: &'static str,
    description: &'static str,
) -> Variable<M> {
    row(name, "", Causality::Parameter, access, description, Start::Text(start))
}

/// A continuous real input.
pub fn input<M>(
    name: &'static str,
    unit: &'static str,
    access: Access<M>,
    start: f64,
    description: &'static str,
) -> Variable<M> {
    row(name, unit, Causality::Input, access, description, Start::Real(start))
}

/// An output. Real outputs are continuous unless marked [`discrete`](Variable::discrete); integer and boolean ones change at steps.
pub fn output<M>(
    name: &'static str,
    unit: &'static str,
    access: Access<M>,
    description: &'static str,
) -> Variable<M> {
    row(name, unit, Causality::Output, access, description, Start::None)
}

/// A quantity inside the model that somebody may want to look at.
pub fn local<M>(
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
    pub fn range(mut self, min: f64, max: f64) -> Self {
        self.min = Some(min);
        self.max = Some(max);
        self
    }

    /// The smallest value that is accepted.
    #[must_use]
    pub fn min(mut self, min: f64) -> Self {
        self.min = Some(min);
        self
    }

    /// A typical size, for solvers that scale.
    #[must_use]
    pub fn nominal(mut self, nominal: f64) -> Self {
        self.nominal = Some(nominal);
        self
    }

    /// Lets a parameter change between steps; see [`Model::tune`](super::Model::tune).
    #[must_use]
    pub fn tunable(mut self) -> Self {
        self.tunable = true;
        self
    }

    /// A real output that changes at instants and is held between them: what a sampled controller sends. Its
    /// variability is discrete, its derivative over time 0.
    #[must_use]
    pub fn discrete(mut self) -> Self {
        self.change = Change::Discrete;
        self
    }

    /// A real output whose last change does not tell how it goes on, such as a sum over parts that come and go
    /// within a step. Its derivative over time is given as 0, as FMI has it for an order that is not known: a
    /// master that extrapolates then holds the value.
    #[must_use]
    pub fn without_derivative(mut self) -> Self {
        self.change = Change::Ragged;
        self
    }

    /// A real output that has a derivative.
    pub(super) fn is_smooth_output(&self) -> bool {
        let is_real = matches!(self.access, Access::Real(..) | Access::Rated(..));
        self.causality == Causality::Output && is_real && matches!(self.change, Change::Smooth)
    }

    /// Lets a real input that comes without a derivative run on between communication points with the
    /// real input called `rate`: a position with the velocity that comes beside it, x + v t, or, where
    /// the velocity has a derivative a, x + v t + a t²/2.
    #[must_use]
    pub fn runs_on(mut self, rate: &'static str) -> Self {
        self.runs_on = Some(rate.into());
        self
    }

    /// Makes an enumeration of an integer variable: (name, description) of the values 1, 2, ...
    #[must_use]
    pub fn items(mut self, items: &'static [(&'static str, &'static str)]) -> Self {
        self.items = items;
        self
    }

    /// Says what the variable is to its machine; [`Role`] has what is taken for granted without it.
    #[must_use]
    pub fn role(mut self, role: Role) -> Self {
        self.role = Some(role);
        self
    }

    /// True of a parameter.
    pub(super) fn is_parameter(&self) -> bool {
        self.causality == Causality::Parameter
    }

    /// Says what a parameter is there for; without it, it is a property of the machine.
    #[must_use]
    pub fn purpose(mut self, purpose: Purpose) -> Self {
        self.purpose = Some(purpose);
        self
    }

    /// The same variable with another start value: a part may need another one in another whole.
    #[must_use]
    pub fn start(mut self, start: impl Into<Start>) -> Self {
        self.start = start.into();
        self
    }

    /// The same variable with another description.
    #[must_use]
    pub fn described(mut self, description: impl Into<Cow<'static, str>>) -> Self {
        self.description = description.into();
        self
    }

    /// The same variable where the model is a part of another, under a prefix.
    pub(super) fn of_part<W: 'static>(self, prefix: &str, lens: &Lens<W, M>) -> Variable<W> {
        let prefixed = |name: Cow<'static, str>| match prefix.is_empty() {
            true => name,
            false => format!("{prefix}{name}").into(),
        };
        Variable {
            name: prefixed(self.name),
            unit: self.unit,
            description: self.description,
            causality: self.causality,
            access: self.access.through(lens),
            start: self.start,
            min: self.min,
            max: self.max,
            nominal: self.nominal,
            items: self.items,
            tunable: self.tunable,
            runs_on: self.runs_on.map(prefixed),
            change: self.change,
            role: self.role,
            purpose: self.purpose,
        }
    }

    /// Writes the start value, if there is one.
    pub(super) fn write_start(&self, model: &mut M) {
        match (&self.access, self.start) {
            (Access::Real(_, set), Start::Real(value)) => set(model, value),
            (Access::Rated(_, set), Start::Real(value)) => set(model, value, None),
            (Access::Integer(_, set), Start::Integer(value)) => set(model, value),
            (Access::Boolean(_, set), Start::Boolean(value)) => set(model, value),
            (Access::Text(_, set), Start::Text(text)) => set(model, text),
            // the functions that make rows let no other pair be
            (_, start) => debug_assert!(matches!(start, Start::None), "{} = {start:?}", self.name),
        }
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
        matches!(self.change, Change::Smooth)
    }

    /// How to reach it.
    pub fn access(&self) -> &Access<M> {
        &self.access
    }

    /// The row without its types, as everything outside the model sees it. `meaning`: the model says what its
    /// variables are.
    pub(super) fn info(&self, meaning: bool) -> VariableInfo {
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
            name: self.name.clone().into(),
            reference: reference(&self.name),
            description: self.description.clone().into(),
            unit: (!self.unit.is_empty()).then(|| self.unit.into()),
            kind,
            causality: self.causality,
            variability,
            initial,
            start,
            min: self.min,
            max: self.max,
            nominal: self.nominal,
            meaning: meaning.then(|| Meaning { role: self.role, purpose: self.purpose.unwrap_or_default() }),
        }
    }
}
