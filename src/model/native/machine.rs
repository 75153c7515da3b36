//! A model whose type is not known.

use crate::Result;
use crate::model::Model;
use crate::model::access::known;
use std::any::Any;

/// What a run needs of its model: see [`Model`] for what has the same name there.
pub(super) trait Machine: Any + Send {
    fn step_size(&self) -> f64;
    fn initialize(&mut self) -> Result<()>;
    fn tune(&mut self) -> Result<()>;
    fn check(&self) -> Result<()>;
    fn warning(&self) -> Option<String>;
    fn directional_derivatives(
        &self,
        starting: bool,
        direction: &[(&str, f64)],
        unknowns: &[&str],
    ) -> Result<Vec<Option<f64>>>;
    fn step(&mut self, length: f64) -> Result<()>;

    /// A copy of its own.
    fn copy(&self) -> Box<dyn Machine>;
    /// Becomes a copy of another of the same type, in the memory that it has.
    fn copy_from(&mut self, other: &dyn Machine);
    /// Its bytes.
    fn to_bytes(&self) -> postcard::Result<Vec<u8>>;
    /// One of the same type, from the front of `bytes`, and the bytes after it.
    fn read<'b>(&self, bytes: &'b [u8]) -> postcard::Result<(Box<dyn Machine>, &'b [u8])>;
}

impl<M: Model> Machine for M {
    fn step_size(&self) -> f64 {
        Model::step_size(self)
    }

    fn initialize(&mut self) -> Result<()> {
        Model::initialize(self)
    }

    fn tune(&mut self) -> Result<()> {
        Model::tune(self)
    }

    fn check(&self) -> Result<()> {
        Model::check(self)
    }

    fn warning(&self) -> Option<String> {
        Model::warning(self)
    }

    fn directional_derivatives(
        &self,
        starting: bool,
        direction: &[(&str, f64)],
        unknowns: &[&str],
    ) -> Result<Vec<Option<f64>>> {
        Model::directional_derivatives(self, starting, direction, unknowns)
    }

    fn step(&mut self, length: f64) -> Result<()> {
        Model::step(self, length)
    }

    fn copy(&self) -> Box<dyn Machine> {
        Box::new(self.clone())
    }

    fn copy_from(&mut self, other: &dyn Machine) {
        let other: &dyn Any = other;
        self.clone_from(known(other.downcast_ref()));
    }

    fn to_bytes(&self) -> postcard::Result<Vec<u8>> {
        postcard::to_stdvec(self)
    }

    fn read<'b>(&self, bytes: &'b [u8]) -> postcard::Result<(Box<dyn Machine>, &'b [u8])> {
        let (model, rest) = postcard::take_from_bytes::<M>(bytes)?;
        Ok((Box::new(model), rest))
    }
}

impl Clone for Box<dyn Machine> {
    fn clone(&self) -> Self {
        (**self).copy()
    }

    fn clone_from(&mut self, other: &Self) {
        (**self).copy_from(&**other);
    }
}
