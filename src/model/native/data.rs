//! All that changes while a [`Native`](super::Native) runs: what a snapshot holds.

use super::machine::Machine;
use crate::clone_in_place;
use crate::model::variable::Row;
use crate::model::{Causality, Interface, Kind, Value};
use serde::{Deserialize, Serialize};
use std::any::Any;

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
pub(super) struct Data {
    pub(super) clock: Clock,
    pub(super) signals: Vec<Signal>,
    /// The state at the last grid point.
    pub(super) grid: Box<dyn Machine>,
    /// The state at the communication point, where `clock.off_grid`.
    pub(super) between: Box<dyn Machine>,
    /// The state one grid step before `grid`, for derivatives of outputs.
    pub(super) before: Box<dyn Machine>,
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

clone_in_place!(Data { clock, signals, grid, between, before });

impl Data {
    /// That of a model with its defaults, which gets the start values of its rows and the settings.
    pub(super) fn new(
        mut grid: Box<dyn Machine>,
        rows: &[Row],
        interface: &Interface,
        settings: &[(usize, Value)],
    ) -> Self {
        for row in rows {
            row.write_start(&mut *grid);
        }
        for (index, value) in settings {
            rows[*index].write(&mut *grid, value);
        }
        let signals = interface
            .with(Causality::Input)
            .filter(|index| interface.variables[*index].kind == Kind::Real)
            .map(|index| Signal {
                variable: index,
                value: rows[index].real(&*grid),
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

    /// Whether a run can lead to this, as far as [`Run`](super::run::Run) relies on it.
    pub(super) fn is_possible(&self, rows: &[Row], interface: &Interface) -> bool {
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
                .all(|model| interface.variables[index].accept(&rows[index].read(model)).is_ok())
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

    fn models(&self) -> [&dyn Machine; 3] {
        [&*self.grid, &*self.between, &*self.before]
    }

    /// Whether both are of models of the same type.
    pub(super) fn is_of_same_model(&self, other: &Self) -> bool {
        let [own, others]: [&dyn Any; 2] = [&*self.grid, &*other.grid];
        own.type_id() == others.type_id()
    }

    pub(super) fn to_bytes(&self) -> postcard::Result<Vec<u8>> {
        let mut bytes = postcard::to_stdvec(&(&self.clock, &self.signals))?;
        for model in self.models() {
            bytes.extend(model.to_bytes()?);
        }
        Ok(bytes)
    }

    /// The data in `bytes`, of a model of the same type as `like`.
    pub(super) fn from_bytes(bytes: &[u8], like: &dyn Machine) -> postcard::Result<Self> {
        let ((clock, signals), rest) = postcard::take_from_bytes(bytes)?;
        let (grid, rest) = like.read(rest)?;
        let (between, rest) = like.read(rest)?;
        let (before, _) = like.read(rest)?;
        Ok(Self { clock, signals, grid, between, before })
    }
}

/// The inputs that run on with another one: where both are among the signals.
pub(super) fn natural_rates(rows: &[Row], signals: &[Signal]) -> Vec<(usize, usize)> {
    let named = |name: &str| signals.iter().position(|s| rows[s.variable].name() == name);
    let rates = signals.iter().enumerate().filter_map(|(i, signal)| {
        let name = rows[signal.variable].natural_rate()?;
        let rate = named(name);
        debug_assert!(rate.is_some(), "{name} is no real input");
        Some((i, rate?))
    });
    rates.collect()
}
