//! The rows of a running model: many values of one part are read and written on one way to it.

use super::data::Signal;
use crate::model::variable::Row;
use std::any::Any;
use std::ops::Deref;

/// The rows, in the order of the interface.
pub(super) struct Rows {
    rows: Vec<Row>,
    /// A number for each row, the same for those of one part.
    parts: Vec<usize>,
}

impl Rows {
    pub(super) fn new(rows: Vec<Row>) -> Self {
        let mut first: Vec<&Row> = Vec::new();
        let mut parts = Vec::with_capacity(rows.len());
        for row in &rows {
            let known = first.iter().rposition(|other| other.reach().is_beside(row.reach()));
            parts.push(known.unwrap_or_else(|| {
                first.push(row);
                first.len() - 1
            }));
        }
        Self { rows, parts }
    }

    /// The values of real variables in a model (0 of any other), in the order of `variables`.
    pub(super) fn reals<'r>(
        &'r self,
        model: &'r dyn Any,
        variables: &'r [usize],
    ) -> impl Iterator<Item = f64> + 'r {
        let mut at: Option<(usize, &dyn Any)> = None;
        variables.iter().map(move |&index| {
            let reach = self.rows[index].reach();
            let number = self.parts[index];
            let part = match at {
                Some((last, part)) if last == number => part,
                _ => reach.part(model),
            };
            at = Some((number, part));
            reach.end.real(part)
        })
    }

    /// Writes the inputs' values at `time`.
    pub(super) fn feed(&self, model: &mut dyn Any, signals: &[Signal], time: f64) {
        for beside in signals.chunk_by(|a, b| self.parts[a.variable] == self.parts[b.variable]) {
            let part = self.rows[beside[0].variable].reach().part_mut(model);
            for signal in beside {
                let end = &self.rows[signal.variable].reach().end;
                end.write_real(part, signal.at(time), signal.rate);
            }
        }
    }
}

impl Deref for Rows {
    type Target = [Row];

    fn deref(&self) -> &[Row] {
        &self.rows
    }
}
