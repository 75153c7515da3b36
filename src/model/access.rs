//! How the value of a variable is reached in its model.
//!
//! A whole is made of parts, and each part brings rows of its own. To a row, the way from the whole to the part is a list of [`Lens`]es;
//! at its end two functions read and write the value. Types are checked where rows and lenses are made and are forgotten then: with them,
//! the compiler would make the same code anew for every pair of a whole and one of its parts.

use super::interface::Value;
use std::any::Any;
use std::marker::PhantomData;
use std::sync::Arc;

/// What a value is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Scalar {
    Real,
    Integer,
    Boolean,
    Text,
}

/// How a variable of the model `M` is read and written.
pub struct Access<M: 'static> {
    pub(super) reach: Reach,
    model: PhantomData<fn(&M)>,
}

/// Functions of a row know nothing but the model, as a rule: a closure that captures something has a type of its own, and code of its own
/// is compiled for it.
impl<M: 'static> Access<M> {
    /// A real number that can be read and written, in the unit of its declaration.
    pub fn real(get: fn(&M) -> f64, set: fn(&mut M, f64)) -> Self {
        Self::to(Scalar::Real, Field::Real(get, set))
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
        Self::to(Scalar::Real, Field::Captured(Box::new(get), Box::new(set)))
    }

    /// As [`computed`](Self::computed), with a closure that captures something.
    pub fn computed_with(get: impl Fn(&M) -> f64 + Send + Sync + 'static) -> Self {
        Self::real_with(get, |_, _| {})
    }

    /// An input whose setter gets the value and, when the master knows it, the first derivative.
    pub fn rated(get: fn(&M) -> f64, set: fn(&mut M, f64, Option<f64>)) -> Self {
        Self::to(Scalar::Real, Field::Rated(get, set))
    }

    /// A whole number that can be read and written, or an item (from 1) of an enumeration.
    pub fn integer(get: fn(&M) -> i32, set: fn(&mut M, i32)) -> Self {
        Self::to(Scalar::Integer, Field::Integer(get, set))
    }

    /// A whole number that is computed when it is read.
    pub fn computed_integer(get: fn(&M) -> i32) -> Self {
        Self::integer(get, |_, _| {})
    }

    /// A switch that can be read and written.
    pub fn boolean(get: fn(&M) -> bool, set: fn(&mut M, bool)) -> Self {
        Self::to(Scalar::Boolean, Field::Boolean(get, set))
    }

    /// A switch that is computed when it is read.
    pub fn computed_boolean(get: fn(&M) -> bool) -> Self {
        Self::boolean(get, |_, _| {})
    }

    /// A text that can be read and written.
    pub fn text(get: fn(&M) -> &str, set: fn(&mut M, &str)) -> Self {
        Self::to(Scalar::Text, Field::Text(get, set))
    }

    fn to(scalar: Scalar, field: Field<M>) -> Self {
        Self { reach: Reach { scalar, path: Vec::new(), end: Box::new(field) }, model: PhantomData }
    }
}

/// How a part is reached in the model that it is a part of.
pub struct Lens<M: 'static, P: 'static> {
    pub(super) way: Arc<dyn Way>,
    types: PhantomData<fn(&M) -> &P>,
}

impl<M: 'static, P: 'static> Lens<M, P> {
    /// From the two ways to borrow the part; [`lens!`](crate::lens) writes both.
    pub fn new(
        of: impl for<'a> Fn(&'a M) -> &'a P + Send + Sync + 'static,
        of_mut: impl for<'a> Fn(&'a mut M) -> &'a mut P + Send + Sync + 'static,
    ) -> Self {
        Self { way: Arc::new(Borrow { of, of_mut, types: PhantomData::<fn(&M) -> &P> }), types: PhantomData }
    }
}

/// An [`Access`] without the type of its model.
pub(super) struct Reach {
    pub(super) scalar: Scalar,
    /// From the whole to the part that has the value.
    path: Vec<Arc<dyn Way>>,
    /// How the part's value is read and written.
    pub(super) end: Box<dyn End>,
}

impl Reach {
    /// The same value where its model is a part of another.
    pub(super) fn through(mut self, way: &Arc<dyn Way>) -> Self {
        self.path.insert(0, way.clone());
        self
    }

    /// Whether both values are of the same part, so that the way to it need not be gone twice.
    pub(super) fn is_beside(&self, other: &Self) -> bool {
        self.path.len() == other.path.len()
            && self.path.iter().zip(&other.path).all(|(own, others)| Arc::ptr_eq(own, others))
    }

    /// The part of a model that has the value.
    ///
    /// # Panics
    /// If this is no access to a value of such a model; [`Table`](super::Table) has the types that let no other be asked.
    pub(super) fn part<'m>(&self, model: &'m dyn Any) -> &'m dyn Any {
        self.path.iter().fold(model, |whole, way| way.part(whole))
    }

    /// The same, to change it.
    ///
    /// # Panics
    /// As [`part`](Self::part).
    pub(super) fn part_mut<'m>(&self, model: &'m mut dyn Any) -> &'m mut dyn Any {
        self.path.iter().fold(model, |whole, way| way.part_mut(whole))
    }
}

/// One lens, without its types.
pub(super) trait Way: Send + Sync {
    fn part<'m>(&self, whole: &'m dyn Any) -> &'m dyn Any;
    fn part_mut<'m>(&self, whole: &'m mut dyn Any) -> &'m mut dyn Any;
}

struct Borrow<M, P, F, G> {
    of: F,
    of_mut: G,
    types: PhantomData<fn(&M) -> &P>,
}

impl<M: 'static, P: 'static, F, G> Way for Borrow<M, P, F, G>
where
    F: for<'a> Fn(&'a M) -> &'a P + Send + Sync,
    G: for<'a> Fn(&'a mut M) -> &'a mut P + Send + Sync,
{
    fn part<'m>(&self, whole: &'m dyn Any) -> &'m dyn Any {
        (self.of)(known(whole.downcast_ref()))
    }

    fn part_mut<'m>(&self, whole: &'m mut dyn Any) -> &'m mut dyn Any {
        (self.of_mut)(known(whole.downcast_mut()))
    }
}

/// The two functions at the end of the way, without their type. They panic with a part of another type.
pub(super) trait End: Send + Sync {
    /// The value.
    fn read(&self, part: &dyn Any) -> Value;
    /// A real number; 0 where the value is something else.
    fn real(&self, part: &dyn Any) -> f64;
    /// Writes a value of the right kind.
    fn write(&self, part: &mut dyn Any, value: &Value);
    /// Writes a real number and, where it is an input whose first derivative is known, that.
    fn write_real(&self, part: &mut dyn Any, value: f64, rate: Option<f64>);
}

enum Field<M: 'static> {
    Real(fn(&M) -> f64, fn(&mut M, f64)),
    Captured(GetReal<M>, SetReal<M>),
    Rated(fn(&M) -> f64, fn(&mut M, f64, Option<f64>)),
    Integer(fn(&M) -> i32, fn(&mut M, i32)),
    Boolean(fn(&M) -> bool, fn(&mut M, bool)),
    Text(fn(&M) -> &str, fn(&mut M, &str)),
}

type GetReal<M> = Box<dyn Fn(&M) -> f64 + Send + Sync>;
type SetReal<M> = Box<dyn Fn(&mut M, f64) + Send + Sync>;

impl<M: 'static> End for Field<M> {
    fn read(&self, part: &dyn Any) -> Value {
        let model = known(part.downcast_ref());
        match self {
            Self::Real(..) | Self::Captured(..) | Self::Rated(..) => Value::Real(self.real(part)),
            Self::Integer(get, _) => Value::Integer(get(model)),
            Self::Boolean(get, _) => Value::Boolean(get(model)),
            Self::Text(get, _) => Value::Text(get(model).into()),
        }
    }

    fn real(&self, part: &dyn Any) -> f64 {
        let model = known(part.downcast_ref());
        match self {
            Self::Real(get, _) | Self::Rated(get, _) => get(model),
            Self::Captured(get, _) => get(model),
            Self::Integer(..) | Self::Boolean(..) | Self::Text(..) => 0.0,
        }
    }

    fn write(&self, part: &mut dyn Any, value: &Value) {
        if let Value::Real(value) = value {
            return self.write_real(part, *value, None);
        }
        let model = known(part.downcast_mut());
        match (self, value) {
            (Self::Integer(_, set), Value::Integer(value)) => set(model, *value),
            (Self::Boolean(_, set), Value::Boolean(value)) => set(model, *value),
            (Self::Text(_, set), Value::Text(text)) => set(model, text),
            // values are those of a row's start, which fit its access, or were accepted for its variable
            _ => debug_assert!(false, "{value:?} for another kind of variable"),
        }
    }

    fn write_real(&self, part: &mut dyn Any, value: f64, rate: Option<f64>) {
        let model = known(part.downcast_mut());
        match self {
            Self::Real(_, set) => set(model, value),
            Self::Captured(_, set) => set(model, value),
            Self::Rated(_, set) => set(model, value, rate),
            Self::Integer(..) | Self::Boolean(..) | Self::Text(..) => {
                debug_assert!(false, "{value} for another kind of variable");
            }
        }
    }
}

/// A model or a part as what it was known to be when its row or lens was made.
pub(super) fn known<T>(found: Option<T>) -> T {
    found.unwrap_or_else(|| unreachable!("the row is one of another model"))
}
