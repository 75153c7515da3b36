//! All that changes while a [`Native`](super::Native) runs: what a snapshot holds.

use crate::clone_in_place;
use crate::model::{Access, Causality, Interface, Kind, Model, Table, Value};
use serde::{Deserialize, Serialize};

/// Grid steps beyond this cannot be told apart in double precision.
const MAX_POSITION: f64 = 9e15;

#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub(super) enum Phase {
    /// Made; parameters can be set.
    New,
    /// Started; parameters and inputs can be set, outputs read.
    Starting,
    /// Ready to step.
    Running,
    /// A step failed; only restore and reset help.
    Failed,
}

/// Everything that changes: what a snapshot holds.
#[derive(Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Data<M> {
    pub(super) clock: Clock,
    pub(super) signals: Vec<Signal>,
    /// The state at the last grid point.
    pub(super) grid: M,
    /// The state at the communication point, where `clock.off_grid`.
    pub(super) between: M,
    /// The state one grid step before `grid`, for derivatives of outputs.
    pub(super) before: M,
}

#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub(super) struct Clock {
    pub(super) phase: Phase,
    /// Something was set after the last `initialize`, or a parameter was tuned after the last step.
    pub(super) stale: bool,
    pub(super) start: f64,
    pub(super) stop: Option<f64>,
    /// The last communication point.
    pub(super) time: f64,
    /// Grid steps since the start.
    pub(super) ticks: u64,
    pub(super) step_size: f64,
    /// Communication steps since the start.
    pub(super) steps: u64,
    /// The communication point lies between grid points.
    pub(super) off_grid: bool,
    /// The time of the state before.
    pub(super) time_before: f64,
}

/// The course of one input.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub(super) struct Signal {
    pub(super) variable: usize,
    pub(super) value: f64,
    pub(super) since: f64,
    pub(super) rate: Option<f64>,
    /// The communication step before which the rate was set.
    pub(super) rate_set_in: u64,
    /// The rate was not set by the master but is another input, whose own rate is `acceleration`.
    pub(super) natural: bool,
    pub(super) acceleration: f64,
}

impl Signal {
    /// The value at a time.
    pub(super) fn at(&self, time: f64) -> f64 {
        let past = time - self.since;
        self.value + (self.rate.unwrap_or(0.0) + 0.5 * self.acceleration * past) * past
    }
}

clone_in_place!(Data<M> { clock, signals, grid, between, before });

impl<M: Model> Data<M> {
    pub(super) fn new(table: &Table<M>, interface: &Interface, settings: &[(usize, Value)]) -> Self {
        let mut grid = M::default();
        table.write_starts(&mut grid);
        for (index, value) in settings {
            put(table, &mut grid, *index, value);
        }
        let signals = interface
            .with(Causality::Input)
            .filter(|index| interface.variables[*index].kind == Kind::Real)
            .map(|index| Signal {
                variable: index,
                value: match take(table, &grid, index) {
                    Value::Real(value) => value,
                    _ => 0.0,
                },
                since: 0.0,
                rate: None,
                rate_set_in: u64::MAX,
                natural: false,
                acceleration: 0.0,
            })
            .collect();
        let clock = Clock {
            phase: Phase::New,
            stale: true,
            start: 0.0,
            stop: None,
            time: 0.0,
            ticks: 0,
            step_size: 0.0,
            steps: 0,
            off_grid: false,
            time_before: 0.0,
        };
        Self { clock, signals, between: grid.clone(), before: grid.clone(), grid }
    }

    /// Whether a run can lead to this, as far as [`Native`] relies on it.
    pub(super) fn is_possible(&self, table: &Table<M>, interface: &Interface) -> bool {
        let Clock { phase, start, stop, time, ticks, step_size, steps, time_before, .. } = self.clock;
        let times = [start, time, time_before].iter().all(|t| t.is_finite())
            && stop.is_none_or(|s| s.is_finite() && s > start);
        let position = (time - start) / step_size;
        let clock = match phase {
            Phase::New | Phase::Starting => ticks == 0 && steps == 0 && time == start,
            // the step that failed moved the ticks but not the time
            Phase::Failed => true,
            Phase::Running => {
                // not any step: one that is too small would make for too many
                step_size == self.grid.step_size()
                    && step_size > 0.0
                    && position < MAX_POSITION
                    && (position - ticks as f64).abs() <= 1.0 + 1e-12 * position
                    && steps < u64::MAX / 2
            }
        };
        let signals = self.signals.iter().all(|s| {
            let numbers = [s.value, s.since, s.rate.unwrap_or(0.0), s.acceleration];
            numbers.iter().all(|number| number.is_finite())
        });
        let variables = self.signals.iter().map(|s| s.variable);
        let inputs = interface.with(Causality::Input).filter(|i| interface.variables[*i].kind == Kind::Real);
        let parameters = interface.with(Causality::Parameter).all(|index| {
            self.models()
                .into_iter()
                .all(|model| interface.variables[index].accept(&take(table, model, index)).is_ok())
        });
        // what is stale is initialized before it is stepped
        let stale = self.clock.stale && phase != Phase::Running;
        let models = stale || self.models().into_iter().all(|model| model.check().is_ok());
        times && clock && models && signals && variables.eq(inputs) && parameters
    }

    /// Sets the rates of inputs that have none from the master to the inputs that are their rates, as those
    /// are at the communication point. `rates` are the pairs of both, see [`natural_rates`].
    pub(super) fn find_natural_rates(&mut self, rates: &[(usize, usize)]) {
        let time = self.clock.time;
        for &(i, rate) in rates {
            let (signal, of) = (self.signals[i], &self.signals[rate]);
            if !signal.natural && signal.rate.is_some() {
                continue;
            }
            let (rate, acceleration) = (of.at(time), of.rate.unwrap_or(0.0));
            // what goes on as it did is not begun anew, whose rounding the cuts of the time would tell
            let goes_on = signal.natural
                && signal.acceleration == acceleration
                && if acceleration == 0.0 { signal.rate == Some(rate) } else { of.since <= signal.since };
            if !goes_on {
                let value = signal.at(time);
                let rate = Some(rate);
                self.signals[i] = Signal { value, since: time, rate, acceleration, natural: true, ..signal };
            }
        }
    }

    fn models(&self) -> [&M; 3] {
        [&self.grid, &self.between, &self.before]
    }
}

/// The inputs that run on with another one: where both are among the signals.
pub(super) fn natural_rates<M: Model>(table: &Table<M>, signals: &[Signal]) -> Vec<(usize, usize)> {
    let named = |name: &str| signals.iter().position(|s| table.row(s.variable).name() == name);
    let rates = signals.iter().enumerate().filter_map(|(i, signal)| {
        let name = table.row(signal.variable).natural_rate()?;
        let rate = named(name);
        debug_assert!(rate.is_some(), "{name} is no real input");
        Some((i, rate?))
    });
    rates.collect()
}

/// The value of a variable.
fn take<M: Model>(table: &Table<M>, model: &M, index: usize) -> Value {
    match table.row(index).access() {
        Access::Real(get, _) | Access::Rated(get, _) => Value::Real(get(model)),
        Access::Integer(get, _) => Value::Integer(get(model)),
        Access::Boolean(get, _) => Value::Boolean(get(model)),
        Access::Text(get, _) => Value::Text(get(model).into()),
    }
}

/// Writes a value that was accepted for the variable.
pub(super) fn put<M: Model>(table: &Table<M>, model: &mut M, index: usize, value: &Value) {
    match (table.row(index).access(), value) {
        (Access::Real(_, set), Value::Real(v)) => set(model, *v),
        (Access::Rated(_, set), Value::Real(v)) => set(model, *v, None),
        (Access::Integer(_, set), Value::Integer(v)) => set(model, *v),
        (Access::Boolean(_, set), Value::Boolean(v)) => set(model, *v),
        (Access::Text(_, set), Value::Text(v)) => set(model, v),
        // `VariableInfo::accept` lets no other pair through.
        _ => debug_assert!(false, "{} = {value:?}", table.row(index).name()),
    }
}

/// Writes the inputs' values at `time`.
pub(super) fn feed<M: Model>(table: &Table<M>, model: &mut M, signals: &[Signal], time: f64) {
    for signal in signals {
        match table.row(signal.variable).access() {
            Access::Real(_, set) => set(model, signal.at(time)),
            Access::Rated(_, set) => set(model, signal.at(time), signal.rate),
            _ => {}
        }
    }
}
