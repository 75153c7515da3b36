//! A model as the FMI side knows it: by name, with its type forgotten.

use crate::model::{Interface, Model, Native, Settings, Slave};
use crate::{Error, Result};

/// One model of a library: its name and how to make its interface and its slaves.
#[derive(Debug, Clone, Copy)]
pub struct Entry {
    /// [`Model::NAME`].
    pub name: &'static str,
    /// The interface with the start values of the model's table.
    pub table: fn() -> Interface,
    /// [`Model::DOCUMENTATION`].
    pub documentation: &'static [&'static str],
    make: fn(&Settings) -> Result<Box<dyn Slave + Send>>,
}

impl Entry {
    /// The entry of a model.
    pub const fn of<M: Model>() -> Self {
        Self {
            name: M::NAME,
            table: Native::<M>::table,
            documentation: M::DOCUMENTATION,
            make: |settings| Ok(Box::new(Native::<M>::new(settings)?)),
        }
    }

    /// A slave of the model with these settings.
    ///
    /// # Errors
    /// Settings that the model does not accept.
    pub fn slave(&self, settings: &Settings) -> Result<Box<dyn Slave + Send>> {
        (self.make)(settings)
    }

    /// The entry called `name`.
    ///
    /// # Errors
    /// None; the message lists those that are there.
    pub fn find(entries: &[Self], name: &str) -> Result<Self> {
        entries.iter().find(|e| e.name == name).copied().ok_or_else(|| {
            let names: Vec<&str> = entries.iter().map(|e| e.name).collect();
            Error::variable(format!("there is no model {name:?}; there is {}", names.join(", ")))
        })
    }
}

/// The GUID of an FMU: it changes with the text of its `resources/model.toml`, with the model's
/// variable table and with the version of the library.
pub fn guid(table: &Interface, settings: &str) -> String {
    format!("{{{}}}", uuid::Uuid::new_v5(&table.fingerprint(), settings.as_bytes()))
}
