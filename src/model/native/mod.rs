//! [`Native`]: a [`Model`] as a [`Slave`].

mod data;
mod machine;
mod rows;
mod run;

use self::run::Run;
use super::access::known;
use super::{Interface, Model, Settings, Slave, Snapshot, Table};
use crate::Result;
use std::any::Any;
use std::marker::PhantomData;
use uuid::Uuid;

/// A model that runs in this process.
///
/// The model steps on the grid t0 + n h, whatever the master's communication points are: a point on
/// the grid (to 1e-6 h) gives the same bits however the time between was cut, as long as the inputs
/// are the same functions of time. At a point between grid points the outputs come from a copy that
/// is stepped the remaining fraction of h; the state on the grid is not touched by that.
///
/// An input is held from the point where it was set, or, once [`Slave::set_rate`] gave it a
/// derivative, runs on linearly until the next value or derivative is set. An input with a natural
/// rate ([`Variable::runs_on`](super::Variable::runs_on)) runs on from communication point to
/// communication point with that.
pub struct Native<M: Model> {
    run: Run,
    model: PhantomData<fn(&M)>,
}

impl<M: Model> Native<M> {
    /// The interface of the model with the start values of its variable table.
    pub fn table() -> Interface {
        Self::interface_of(&M::variables())
    }

    fn interface_of(table: &Table<M>) -> Interface {
        Interface {
            name: M::NAME.into(),
            description: M::DESCRIPTION.into(),
            communication_step: M::COMMUNICATION_STEP,
            start_time: 0.0,
            stop_time: M::STOP_TIME,
            directional_derivatives: M::DIRECTIONAL_DERIVATIVES,
            variables: table.infos(),
        }
    }

    /// A slave of the model with `settings` in place of the table's start values.
    ///
    /// # Errors
    /// Settings of another model, or with names or values that the model does not accept; a table that
    /// contradicts itself.
    pub fn new(settings: &Settings) -> Result<Self> {
        let (table, interface) = Self::checked_table()?;
        Self::of(table, interface, settings)
    }

    /// The same, and the fingerprint of [`table`](Self::table).
    pub(crate) fn with_fingerprint(settings: &Settings) -> Result<(Self, Uuid)> {
        let (table, interface) = Self::checked_table()?;
        let fingerprint = interface.fingerprint();
        Ok((Self::of(table, interface, settings)?, fingerprint))
    }

    fn checked_table() -> Result<(Table<M>, Interface)> {
        let table = M::variables();
        table.check().map_err(|e| e.at(M::NAME))?;
        let interface = Self::interface_of(&table);
        Ok((table, interface))
    }

    fn of(table: Table<M>, interface: Interface, settings: &Settings) -> Result<Self> {
        let run = Run::new(table.into_rows(), interface, settings, || Box::new(M::default()))?;
        Ok(Self { run, model: PhantomData })
    }

    /// The model at the last communication point.
    pub fn model(&self) -> &M {
        let model: &dyn Any = self.run.model();
        known(model.downcast_ref())
    }

    /// The last communication point \[s\].
    pub fn time(&self) -> f64 {
        self.run.time()
    }
}

impl<M: Model> Slave for Native<M> {
    fn interface(&self) -> &Interface {
        self.run.interface()
    }

    fn get(&mut self, variable: usize) -> Result<f64> {
        self.run.get(variable)
    }

    fn get_all(&mut self, variables: &[usize], values: &mut [f64]) -> Result<()> {
        self.run.get_all(variables, values)
    }

    fn set(&mut self, variable: usize, value: f64) -> Result<()> {
        self.run.set(variable, value)
    }

    fn text(&mut self, variable: usize) -> Result<String> {
        self.run.text(variable)
    }

    fn set_text(&mut self, variable: usize, text: &str) -> Result<()> {
        self.run.set_text(variable, text)
    }

    fn set_rate(&mut self, variable: usize, rate: f64) -> Result<()> {
        self.run.set_rate(variable, rate)
    }

    fn can_interpolate(&self) -> bool {
        self.run.can_interpolate()
    }

    fn start(&mut self, start: f64, stop: Option<f64>) -> Result<()> {
        self.run.start(start, stop)
    }

    fn finish_start(&mut self) -> Result<()> {
        self.run.finish_start()
    }

    fn output_derivative(&mut self, variable: usize) -> Result<f64> {
        self.run.output_derivative(variable)
    }

    fn directional_derivatives(
        &mut self,
        unknowns: &[usize],
        knowns: &[usize],
        seed: &[f64],
    ) -> Result<Vec<f64>> {
        self.run.directional_derivatives(unknowns, knowns, seed)
    }

    fn own_step(&self) -> Option<f64> {
        self.run.own_step()
    }

    fn warning(&self) -> Option<String> {
        self.run.warning()
    }

    fn step(&mut self, time: f64, length: f64) -> Result<()> {
        self.run.step(time, length)
    }

    fn save(&mut self) -> Result<Snapshot> {
        self.run.save()
    }

    fn save_into(&mut self, snapshot: &mut Snapshot) -> Result<()> {
        self.run.save_into(snapshot)
    }

    fn restore(&mut self, snapshot: &Snapshot) -> Result<()> {
        self.run.restore(snapshot)
    }

    fn serialize(&mut self, snapshot: &Snapshot) -> Result<Vec<u8>> {
        self.run.serialize(snapshot)
    }

    fn deserialize(&mut self, bytes: &[u8]) -> Result<Snapshot> {
        self.run.deserialize(bytes)
    }

    fn reset(&mut self) -> Result<()> {
        self.run.reset()
    }
}
