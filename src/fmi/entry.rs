//! A model as the FMI side knows it: by name, with its type forgotten.

use crate::model::{Interface, Model, Native, Settings, Slave};
use crate::{Error, Result};
use uuid::Uuid;

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
    /// The same with the fingerprint of the table, which is made only once.
    make_known: fn(&Settings) -> Result<Known>,
}

/// A slave and the fingerprint of its model's table.
type Known = (Box<dyn Slave + Send>, Uuid);

impl Entry {
    /// The entry of a model.
    pub const fn of<M: Model>() -> Self {
        Self {
            name: M::NAME,
            table: Native::<M>::table,
            documentation: M::DOCUMENTATION,
            make: |settings| Ok(Box::new(Native::<M>::new(settings)?)),
            make_known: |settings| {
                let (slave, fingerprint) = Native::<M>::with_fingerprint(settings)?;
                Ok((Box::new(slave), fingerprint))
            },
        }
    }

    /// A slave of the model with these settings.
    ///
    /// # Errors
    /// Settings that the model does not accept.
    pub fn slave(&self, settings: &Settings) -> Result<Box<dyn Slave + Send>> {
        (self.make)(settings)
    }

    /// The same, and the [fingerprint](Interface::fingerprint) of the interface that [`table`](Self::table) gives.
    ///
    /// # Errors
    /// As [`slave`](Self::slave).
    pub(super) fn slave_with_fingerprint(&self, settings: &Settings) -> Result<Known> {
        (self.make_known)(settings)
    }

    /// The entry called `name`.
    ///
    /// # Errors
    /// None; the message has those that begin so, or the most similar one.
    pub fn find(entries: &[Self], name: &str) -> Result<Self> {
        entries
            .iter()
            .find(|e| e.name == name)
            .copied()
            .ok_or_else(|| no_model(name, entries.iter().map(|e| e.name)))
    }
}

/// More names than these are not listed to somebody who mistyped one.
const FEW: usize = 8;

/// The error for a model that is not there, with those that begin so, all if they are few, or else the most similar one.
pub(super) fn no_model<'a>(name: &str, names: impl Iterator<Item = &'a str>) -> Error {
    let names: Vec<&str> = names.collect();
    let begin: Vec<&str> =
        names.iter().copied().filter(|other| other.starts_with(&format!("{name}-"))).collect();
    let hint = match (&begin[..], names.len() <= FEW) {
        ([], true) => format!("; there is {}", names.join(", ")),
        ([], false) => format!("{} (`latsch models` lists all)", similar(name, &names)),
        (begin, _) => format!("; there is {}", begin.join(", ")),
    };
    Error::variable(format!("there is no model {name:?}{hint}"))
}

#[cfg(feature = "host")]
fn similar(name: &str, names: &[&str]) -> String {
    crate::model::did_you_mean(name, names.iter().copied())
}

#[cfg(not(feature = "host"))]
fn similar(_name: &str, _names: &[&str]) -> String {
    String::new()
}

/// The GUID of an FMU: it changes with the text of its `resources/model.toml`, with the model's
/// variable table and with the version of the library.
pub fn guid(table: &Interface, settings: &str) -> String {
    guid_of(&table.fingerprint(), settings)
}

/// The same for a table with this fingerprint.
pub(super) fn guid_of(table: &Uuid, settings: &str) -> String {
    format!("{{{}}}", Uuid::new_v5(table, settings.as_bytes()))
}
