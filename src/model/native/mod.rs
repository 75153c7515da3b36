//! [`Native`]: a [`Model`] as a [`Slave`], with the time grid, the inputs' courses and saved states.

mod data;

use self::data::{Data, Phase, feed, natural_rates, put};
use super::slave::wrong_order;
use super::{
    Access, Causality, Get, Initial, Interface, Kind, Model, Settings, Slave, Snapshot, Table, Value,
    Variability, VariableInfo, check_experiment, check_step,
};
use crate::{Error, Result};
use uuid::Uuid;

/// How far from a grid point, in steps, a communication point still counts as lying on it.
const GRID_TOLERANCE: f64 = 1e-6;
/// Half the width of the differences that stand for a derivative, in sizes of what is varied: the error of a smooth
/// function, with its square, and that of rounding, with its inverse, are both about 1e-10 of it.
const DIFFERENCE: f64 = 1e-5;
/// Slopes to both sides of a point that differ by more than this share of the steeper one mean that something jumps
/// there: those of a smooth function differ by the share [`DIFFERENCE`].
const JUMP: f64 = 1e-2;
/// More grid steps than this in one communication step are taken for a mistake.
const MAX_TICKS_PER_STEP: f64 = 1e9;

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
    table: Table<M>,
    interface: Interface,
    settings: Vec<(usize, Value)>,
    /// The real outputs and how to read them: they are looked at after each step.
    outputs: Vec<(usize, Get<M, f64>)>,
    /// Which of the signals is a variable's course, if it has one.
    courses: Vec<Option<usize>>,
    /// The signals that run on with another one, and those.
    rates: Vec<(usize, usize)>,
    data: Data<M>,
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

    fn of(table: Table<M>, mut interface: Interface, settings: &Settings) -> Result<Self> {
        let settings = settings.check(&interface)?;
        for (index, value) in &settings {
            interface.variables[*index].start = Some(value.clone());
        }
        let data = Data::new(&table, &interface, &settings);
        let outputs = interface.with(Causality::Output).filter_map(|i| match table.row(i).access() {
            Access::Real(get, _) | Access::Rated(get, _) => Some((i, get.clone())),
            _ => None,
        });
        let outputs = outputs.collect();
        let mut courses = vec![None; interface.variables.len()];
        for (i, signal) in data.signals.iter().enumerate() {
            courses[signal.variable] = Some(i);
        }
        let rates = natural_rates(&table, &data.signals);
        Ok(Self { table, interface, settings, outputs, courses, rates, data })
    }

    /// The model at the last communication point.
    pub fn model(&self) -> &M {
        if self.data.clock.off_grid { &self.data.between } else { &self.data.grid }
    }

    /// The last communication point \[s\].
    pub fn time(&self) -> f64 {
        self.data.clock.time
    }

    fn fingerprint(&self) -> Uuid {
        // That of the table: start values travel inside the state.
        Self::interface_of(&self.table).fingerprint()
    }

    /// The variable number `index`.
    fn info(&self, index: usize) -> Result<&VariableInfo> {
        let Interface { name, variables, .. } = &self.interface;
        variables.get(index).ok_or_else(|| {
            Error::variable(format!("{name} has {} variables; there is no number {index}", variables.len()))
        })
    }

    /// Fails unless a variable of this causality can be set now.
    fn settable(&self, index: usize) -> Result<()> {
        let variable = self.info(index)?;
        let name = &variable.name;
        let tunable = variable.variability == Variability::Tunable;
        match (variable.causality, self.data.clock.phase) {
            (_, Phase::Failed) => Err(wrong_order(&format!("setting {name}"), "after a failed step")),
            (Causality::Input, _) | (Causality::Parameter, Phase::New | Phase::Starting) => Ok(()),
            (Causality::Parameter, Phase::Running) if tunable => Ok(()),
            (Causality::Parameter, _) => {
                Err(wrong_order(&format!("setting the fixed parameter {name}"), "after initialization"))
            }
            _ => Err(Error::variable(format!("{name} is computed by the model; it cannot be set"))),
        }
    }

    fn write(&mut self, index: usize, value: &Value) -> Result<()> {
        self.settable(index)?;
        let value = self.interface.variables[index].accept(value)?;
        let clock = &mut self.data.clock;
        if let (Some(signal), Value::Real(value)) =
            (self.courses[index].map(|i| &mut self.data.signals[i]), &value)
        {
            signal.value = *value;
            signal.since = clock.time;
            if signal.rate_set_in != clock.steps {
                signal.rate = None;
            }
        }
        let parameter = self.interface.variables[index].causality == Causality::Parameter;
        if parameter || matches!(clock.phase, Phase::New | Phase::Starting) {
            clock.stale = true;
            put(&self.table, &mut self.data.grid, index, &value);
            put(&self.table, &mut self.data.between, index, &value);
        }
        Ok(())
    }

    fn refresh(&mut self) -> Result<()> {
        if self.data.clock.stale {
            self.data.grid.initialize()?;
            self.all_finite("after initialization")?;
            self.data.clock.stale = false;
        }
        Ok(())
    }

    /// Fails where the model computed something that is no number: it would only turn up elsewhere.
    fn all_finite(&self, when: impl std::fmt::Display) -> Result<()> {
        let model = self.model();
        match self.outputs.iter().find(|(_, get)| !get(model).is_finite()) {
            None => Ok(()),
            Some((index, get)) => Err(Error::numeric(format!(
                "{} = {} {when}: the model {} left what it can compute",
                self.interface.variables[*index].name,
                get(model),
                M::NAME
            ))),
        }
    }

    /// The derivatives of the outputs `unknowns` along a change of inputs and parameters before the first step:
    /// differences of what the model initializes to.
    fn differences(&self, direction: &[(usize, f64)], unknowns: &[usize]) -> Result<Vec<f64>> {
        // The variable that may move least decides how far all go.
        let longest = direction.iter().filter(|(_, share)| *share != 0.0).map(|(index, share)| {
            let (info, value) = (&self.interface.variables[*index], self.real_value(*index));
            let width = info.max.unwrap_or(f64::INFINITY) - info.min.unwrap_or(f64::NEG_INFINITY);
            DIFFERENCE * value.abs().max(info.nominal.unwrap_or(1.0).min(width)) / share.abs()
        });
        let far = longest.fold(f64::INFINITY, f64::min);
        if !(far.is_finite() && far > 0.0) {
            return Ok(vec![0.0; unknowns.len()]);
        }
        let at = |far: f64| -> Result<M> {
            let mut model = self.data.grid.clone();
            for (index, share) in direction {
                let value = Value::Real(self.real_value(*index) + far * share);
                put(&self.table, &mut model, *index, &self.interface.variables[*index].accept(&value)?);
            }
            model.initialize()?;
            Ok(model)
        };
        // at the end of a range, or of what the model accepts, there is one side only
        let (above, below) = match (at(far), at(-far)) {
            (Err(error), Err(_)) => {
                return Err(error.at("a difference stands for the derivative; beside the point"));
            }
            (above, below) => (above.ok(), below.ok()),
        };
        let here = &self.data.grid;
        unknowns
            .iter()
            .map(|index| {
                let (Access::Real(get, _) | Access::Rated(get, _)) = self.table.row(*index).access() else {
                    return Err(Error::variable(format!(
                        "{} is no real output",
                        self.table.row(*index).name()
                    )));
                };
                let up = above.as_ref().map(|model| (get(model) - get(here)) / far);
                let down = below.as_ref().map(|model| (get(here) - get(model)) / far);
                match (up, down) {
                    (Some(up), Some(down)) if (up - down).abs() <= JUMP * up.abs().max(down.abs()) => {
                        Ok(0.5 * (up + down))
                    }
                    // the side without the jump
                    (Some(up), Some(down)) => Ok(if up.abs() < down.abs() { up } else { down }),
                    (Some(slope), None) | (None, Some(slope)) => Ok(slope),
                    (None, None) => Ok(0.0),
                }
            })
            .collect()
    }

    /// The value of a real variable before the first step; 0 of any other.
    fn real_value(&self, index: usize) -> f64 {
        match self.table.row(index).access() {
            Access::Real(get, _) | Access::Rated(get, _) => get(&self.data.grid),
            _ => 0.0,
        }
    }

    /// Makes a variable readable: during initialization it brings the model up to date.
    fn make_readable(&mut self, index: usize) -> Result<()> {
        let info = self.info(index)?;
        match self.data.clock.phase {
            Phase::New => {
                return Err(wrong_order(&format!("reading {}", info.name), "before initialization"));
            }
            Phase::Starting if info.initial != Some(Initial::Exact) => {
                self.refresh()?;
            }
            _ => {}
        }
        Ok(())
    }

    fn advance(&mut self, target: f64) -> Result<()> {
        let (table, Data { clock, signals, grid, between, before }) = (&self.table, &mut self.data);
        let h = clock.step_size;
        let position = (target - clock.start) / h;
        // Times of long runs are rounded more coarsely than the grid tolerance.
        let tolerance = GRID_TOLERANCE.max(4.0 * f64::EPSILON * position);
        let ticks = (position + tolerance).floor() as u64;
        while clock.ticks < ticks {
            if clock.ticks + 1 == ticks {
                before.clone_from(grid);
                clock.time_before = clock.start + clock.ticks as f64 * h;
            }
            clock.ticks += 1;
            feed(table, grid, signals, clock.start + clock.ticks as f64 * h);
            grid.step(h)?;
        }
        let rest = target - (clock.start + clock.ticks as f64 * h);
        clock.off_grid = rest > tolerance * h;
        if clock.off_grid {
            between.clone_from(grid);
            feed(table, between, signals, target);
            if let Err(error) = between.step(rest) {
                between.clone_from(grid);
                return Err(error);
            }
        }
        clock.time = target;
        clock.steps += 1;
        Ok(())
    }
}

impl<M: Model> Slave for Native<M> {
    fn interface(&self) -> &Interface {
        &self.interface
    }

    fn get(&mut self, variable: usize) -> Result<f64> {
        if self.data.clock.phase != Phase::New
            && let Some(Some(course)) = self.courses.get(variable)
        {
            // What was set, even before a step passes it on to the model.
            return Ok(self.data.signals[*course].at(self.data.clock.time));
        }
        self.make_readable(variable)?;
        let model = self.model();
        match self.table.row(variable).access() {
            Access::Real(get, _) | Access::Rated(get, _) => Ok(get(model)),
            Access::Integer(get, _) => Ok(f64::from(get(model))),
            Access::Boolean(get, _) => Ok(f64::from(u8::from(get(model)))),
            Access::Text(..) => {
                Err(Error::variable(format!("{} is a text", self.table.row(variable).name())))
            }
        }
    }

    fn set(&mut self, variable: usize, value: f64) -> Result<()> {
        let info = self.info(variable)?;
        let value = match info.kind {
            Kind::Integer | Kind::Enumeration(_) if value.fract() == 0.0 && value.abs() < 2e9 => {
                Value::Integer(value as i32)
            }
            Kind::Boolean if value == 0.0 || value == 1.0 => Value::Boolean(value == 1.0),
            _ => Value::Real(value),
        };
        self.write(variable, &value)
    }

    fn text(&mut self, variable: usize) -> Result<String> {
        self.make_readable(variable)?;
        let model = self.model();
        match self.table.row(variable).access() {
            Access::Text(get, _) => Ok(get(model).into()),
            _ => Err(Error::variable(format!("{} is not a text", self.table.row(variable).name()))),
        }
    }

    fn set_text(&mut self, variable: usize, text: &str) -> Result<()> {
        self.write(variable, &Value::Text(text.into()))
    }

    fn set_rate(&mut self, variable: usize, rate: f64) -> Result<()> {
        self.settable(variable)?;
        let name = &self.interface.variables[variable].name;
        if !rate.is_finite() {
            return Err(Error::variable(format!("derivative of {name} = {rate}: a finite number is needed")));
        }
        let clock = &self.data.clock;
        let Some(signal) = self.courses[variable].map(|i| &mut self.data.signals[i]) else {
            return Err(Error::variable(format!("{name} is not a real input; it has no derivative")));
        };
        // A value set in an earlier step runs on from where it is now.
        signal.value = signal.at(clock.time);
        signal.since = clock.time;
        signal.rate = Some(rate);
        signal.rate_set_in = clock.steps;
        signal.natural = false;
        Ok(())
    }

    fn can_interpolate(&self) -> bool {
        true
    }

    fn start(&mut self, start: f64, stop: Option<f64>) -> Result<()> {
        if self.data.clock.phase != Phase::New {
            return Err(wrong_order("a start", "twice without a reset"));
        }
        check_experiment(start, stop)?;
        let clock = &mut self.data.clock;
        clock.start = start;
        clock.stop = stop;
        clock.time = start;
        clock.phase = Phase::Starting;
        for signal in &mut self.data.signals {
            signal.since = start;
        }
        Ok(())
    }

    fn finish_start(&mut self) -> Result<()> {
        if self.data.clock.phase != Phase::Starting {
            return Err(wrong_order("the end of initialization", "outside initialization"));
        }
        self.refresh()?;
        let h = self.data.grid.step_size();
        if !(h.is_finite() && h > 0.0) {
            return Err(Error::numeric(format!("the model's step size {h} is not a positive time")));
        }
        let clock = &mut self.data.clock;
        clock.step_size = h;
        clock.phase = Phase::Running;
        clock.time_before = clock.start;
        self.data.between.clone_from(&self.data.grid);
        self.data.before.clone_from(&self.data.grid);
        Ok(())
    }

    fn output_derivative(&mut self, variable: usize) -> Result<f64> {
        let info = self.info(variable)?;
        let clock = self.data.clock;
        let (Access::Real(get, _), Causality::Output, Phase::Running) =
            (self.table.row(variable).access(), info.causality, clock.phase)
        else {
            let what = format!("the derivative of {}", info.name);
            return Err(match clock.phase {
                Phase::Running => Error::variable(format!("{what}: only real outputs have one")),
                _ => wrong_order(&what, "before the end of initialization or after a failed step"),
            });
        };
        if !self.table.row(variable).has_derivative() {
            return Ok(0.0);
        }
        let past = clock.time - clock.time_before;
        if past > 0.0 {
            return Ok((get(self.model()) - get(&self.data.before)) / past);
        }
        // no step yet: look ahead on a copy, with the inputs on their way as a step would have them
        let mut ahead = self.data.clone();
        ahead.find_natural_rates(&self.rates);
        let Data { clock, signals, grid, between, .. } = &mut ahead;
        between.clone_from(grid);
        feed(&self.table, between, signals, clock.start + clock.step_size);
        between.step(clock.step_size)?;
        Ok((get(between) - get(grid)) / clock.step_size)
    }

    fn directional_derivatives(
        &mut self,
        unknowns: &[usize],
        knowns: &[usize],
        seed: &[f64],
    ) -> Result<Vec<f64>> {
        let starting = match self.data.clock.phase {
            Phase::Starting => true,
            Phase::Running => false,
            _ => {
                return Err(wrong_order(
                    "a directional derivative",
                    "before initialization or after a failed step",
                ));
            }
        };
        // between steps parameters are no unknown's business (FMI 2.0.5, section 2.2.8)
        let may_vary: &[Causality] =
            if starting { &[Causality::Input, Causality::Parameter] } else { &[Causality::Input] };
        let word = if starting { "input or parameter" } else { "input" };
        for (list, causalities, word) in
            [(unknowns, &[Causality::Output][..], "output"), (knowns, may_vary, word)]
        {
            for &index in list {
                let info = self.info(index)?;
                if !causalities.contains(&info.causality) || !info.is_real() {
                    return Err(Error::variable(format!("{} is no real {word}", info.name)));
                }
            }
        }
        if starting {
            self.refresh()?;
        }
        let direction: Vec<(usize, f64)> = knowns.iter().copied().zip(seed.iter().copied()).collect();
        if let Some((_, number)) = direction.iter().find(|(_, number)| !number.is_finite()) {
            return Err(Error::call(format!(
                "the direction has the number {number}; finite ones are needed"
            )));
        }
        let (inputs, parameters): (Vec<_>, Vec<_>) = direction
            .into_iter()
            .partition(|(index, _)| self.interface.variables[*index].causality == Causality::Input);
        let name = |index: usize| self.interface.variables[index].name.as_str();
        let named: Vec<(&str, f64)> = inputs.iter().map(|(index, share)| (name(*index), *share)).collect();
        let wanted: Vec<&str> = unknowns.iter().map(|index| name(*index)).collect();
        let formulas = self.model().directional_derivatives(starting, &named, &wanted)?;
        let by_inputs = match formulas.iter().position(Option::is_none) {
            None => vec![0.0; unknowns.len()],
            Some(_) if starting => self.differences(&inputs, unknowns)?,
            Some(i) => {
                let name = &self.interface.variables[unknowns[i]].name;
                return Err(Error::numeric(format!("{name} has no directional derivative between steps")));
            }
        };
        let by_parameters = self.differences(&parameters, unknowns)?;
        let parts = formulas.into_iter().zip(by_inputs).zip(by_parameters);
        Ok(parts.map(|((formula, difference), rest)| formula.unwrap_or(difference) + rest).collect())
    }

    fn own_step(&self) -> Option<f64> {
        Some(self.data.grid.step_size())
    }

    fn warning(&self) -> Option<String> {
        self.model().warning()
    }

    fn step(&mut self, time: f64, length: f64) -> Result<()> {
        let clock = self.data.clock;
        match clock.phase {
            Phase::Running => {}
            Phase::Failed => {
                return Err(wrong_order("a step", "after a failed step; restore or reset first"));
            }
            _ => return Err(wrong_order("a step", "before the end of initialization")),
        }
        let target = check_step(clock.time, time, length, clock.stop)?;
        if length > MAX_TICKS_PER_STEP * clock.step_size {
            return Err(Error::call(format!(
                "a step of {length} s is more than {MAX_TICKS_PER_STEP:e} steps of {} s",
                clock.step_size
            )));
        }
        self.data.find_natural_rates(&self.rates);
        // a course that leaves its variable's range is refused before anything moves
        for signal in self.data.signals.iter().filter(|s| s.rate.is_some()) {
            let info = &self.interface.variables[signal.variable];
            let mut value = signal.at(target);
            if let (Some(min), Some(max)) = (info.min, info.max)
                && (value.clamp(min, max) - value).abs() <= 1e-9 * (max - min)
            {
                // rounding of value + rate * time
                value = value.clamp(min, max);
            }
            info.accept(&Value::Real(value))
                .map_err(|e| e.at(format!("with its derivative, at {target} s")))?;
        }
        if clock.stale {
            self.data.grid.tune()?;
            self.data.clock.stale = false;
        }
        // what is left to read if the step fails
        if !clock.off_grid {
            self.data.between.clone_from(&self.data.grid);
        }
        let result =
            self.advance(target).and_then(|()| self.all_finite(format_args!("after the step to {target} s")));
        if result.is_err() {
            self.data.clock.phase = Phase::Failed;
            self.data.clock.off_grid = true;
        }
        result
    }

    fn save(&mut self) -> Result<Snapshot> {
        Ok(Box::new(self.data.clone()))
    }

    fn save_into(&mut self, snapshot: &mut Snapshot) -> Result<()> {
        match snapshot.downcast_mut::<Data<M>>() {
            Some(data) => data.clone_from(&self.data),
            None => *snapshot = self.save()?,
        }
        Ok(())
    }

    fn restore(&mut self, snapshot: &Snapshot) -> Result<()> {
        match snapshot.downcast_ref::<Data<M>>() {
            Some(data) => {
                self.data.clone_from(data);
                Ok(())
            }
            None => Err(Error::call("the saved state belongs to another model")),
        }
    }

    fn serialize(&mut self, snapshot: &Snapshot) -> Result<Vec<u8>> {
        let data = snapshot
            .downcast_ref::<Data<M>>()
            .ok_or_else(|| Error::call("the saved state belongs to another model"))?;
        let payload = postcard::to_stdvec(data)
            .map_err(|e| Error::numeric(format!("the state cannot be written: {e}")))?;
        let fingerprint = self.fingerprint();
        let digest = Uuid::new_v5(&fingerprint, &payload);
        Ok([fingerprint.as_bytes(), digest.as_bytes(), payload.as_slice()].concat())
    }

    fn deserialize(&mut self, bytes: &[u8]) -> Result<Snapshot> {
        let fingerprint = self.fingerprint();
        let (Some(head), Some(digest), Some(payload)) = (bytes.get(..16), bytes.get(16..32), bytes.get(32..))
        else {
            return Err(Error::call(format!("{} bytes are too few for a saved state", bytes.len())));
        };
        if head != fingerprint.as_bytes() {
            return Err(Error::call("the bytes are not a state of this model in this version"));
        }
        if digest != Uuid::new_v5(&fingerprint, payload).as_bytes() {
            return Err(Error::call("the bytes of the saved state are damaged"));
        }
        let data: Data<M> = postcard::from_bytes(payload)
            .map_err(|e| Error::call(format!("the bytes of the saved state cannot be read: {e}")))?;
        // A digest is no signature: whoever wants to can make a valid one.
        if !data.is_possible(&self.table, &self.interface) {
            return Err(Error::call("the bytes are not a state that this model can be in"));
        }
        Ok(Box::new(data))
    }

    fn reset(&mut self) -> Result<()> {
        self.data = Data::new(&self.table, &self.interface, &self.settings);
        Ok(())
    }
}
