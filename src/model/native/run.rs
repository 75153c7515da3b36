//! A run of a model, whatever its type: the time grid, the inputs' courses and saved states.

use super::data::{Data, Phase, natural_rates};
use super::machine::Machine;
use super::rows::Rows;
use crate::model::slave::wrong_order;
use crate::model::table::infos;
use crate::model::variable::Row;
use crate::model::{
    Causality, Initial, Interface, Kind, Settings, Slave, Snapshot, Value, Variability, VariableInfo,
    check_experiment, check_step,
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

/// What a [`Native`](super::Native) does, without the type of its model: with it, the compiler would make all of this anew for every model.
pub(super) struct Run {
    rows: Rows,
    interface: Interface,
    settings: Vec<(usize, Value)>,
    /// Makes the model with its defaults.
    make: fn() -> Box<dyn Machine>,
    /// The real outputs: they are looked at after each step.
    outputs: Vec<usize>,
    /// Which of the signals is a variable's course, if it has one.
    courses: Vec<Option<usize>>,
    /// The signals that run on with another one, and those.
    rates: Vec<(usize, usize)>,
    data: Data,
}

impl Run {
    /// A run of the model that `make` makes, with `settings` in place of the start values of its table.
    ///
    /// # Errors
    /// As [`Native::new`](super::Native::new).
    pub(super) fn new(
        rows: Vec<Row>,
        mut interface: Interface,
        settings: &Settings,
        make: fn() -> Box<dyn Machine>,
    ) -> Result<Self> {
        let settings = settings.check(&interface)?;
        for (index, value) in &settings {
            interface.variables[*index].start = Some(value.clone());
        }
        let data = Data::new(make(), &rows, &interface, &settings);
        let outputs =
            interface.with(Causality::Output).filter(|i| interface.variables[*i].is_real()).collect();
        let mut courses = vec![None; interface.variables.len()];
        for (i, signal) in data.signals.iter().enumerate() {
            courses[signal.variable] = Some(i);
        }
        let rates = natural_rates(&rows, &data.signals);
        Ok(Self { rows: Rows::new(rows), interface, settings, make, outputs, courses, rates, data })
    }

    /// The model at the last communication point.
    pub(super) fn model(&self) -> &dyn Machine {
        if self.data.clock.off_grid { &*self.data.between } else { &*self.data.grid }
    }

    /// The last communication point \[s\].
    pub(super) fn time(&self) -> f64 {
        self.data.clock.time
    }

    /// That of the table: start values travel inside the state.
    fn fingerprint(&self) -> Uuid {
        Interface { variables: infos(&self.rows), ..self.interface.clone() }.fingerprint()
    }

    /// What a snapshot holds, if it is one of this model.
    fn own<'s>(&self, snapshot: &'s Snapshot) -> Result<&'s Data> {
        snapshot
            .downcast_ref::<Data>()
            .filter(|data| data.is_of_same_model(&self.data))
            .ok_or_else(|| Error::call("the saved state belongs to another model"))
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
            self.rows[index].write(&mut *self.data.grid, &value);
            self.rows[index].write(&mut *self.data.between, &value);
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
        let values = self.rows.reals(model, &self.outputs);
        match self.outputs.iter().zip(values).find(|(_, value)| !value.is_finite()) {
            None => Ok(()),
            Some((&index, value)) => {
                let Interface { name, variables, .. } = &self.interface;
                Err(Error::numeric(format!(
                    "{} = {value} {when}: the model {name} left what it can compute",
                    variables[index].name,
                )))
            }
        }
    }

    /// The derivatives of the outputs `unknowns` along a change of inputs and parameters before the first step:
    /// differences of what the model initializes to.
    fn differences(&self, direction: &[(usize, f64)], unknowns: &[usize]) -> Result<Vec<f64>> {
        // The variable that may move least decides how far all go.
        let longest = direction.iter().filter(|(_, share)| *share != 0.0).map(|(index, share)| {
            let (info, value) = (&self.interface.variables[*index], self.rows[*index].real(&*self.data.grid));
            let width = info.max.unwrap_or(f64::INFINITY) - info.min.unwrap_or(f64::NEG_INFINITY);
            DIFFERENCE * value.abs().max(info.nominal.unwrap_or(1.0).min(width)) / share.abs()
        });
        let far = longest.fold(f64::INFINITY, f64::min);
        if !(far.is_finite() && far > 0.0) {
            return Ok(vec![0.0; unknowns.len()]);
        }
        let at = |far: f64| -> Result<Box<dyn Machine>> {
            let mut model = self.data.grid.clone();
            for (index, share) in direction {
                let value = Value::Real(self.rows[*index].real(&*self.data.grid) + far * share);
                let value = self.interface.variables[*index].accept(&value)?;
                self.rows[*index].write(&mut *model, &value);
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
        let slopes = unknowns.iter().map(|&index| {
            let here = self.rows[index].real(&*self.data.grid);
            let up = above.as_ref().map(|model| (self.rows[index].real(&**model) - here) / far);
            let down = below.as_ref().map(|model| (here - self.rows[index].real(&**model)) / far);
            match (up, down) {
                (Some(up), Some(down)) if (up - down).abs() <= JUMP * up.abs().max(down.abs()) => {
                    0.5 * (up + down)
                }
                // the side without the jump
                (Some(up), Some(down)) => {
                    if up.abs() < down.abs() {
                        up
                    } else {
                        down
                    }
                }
                (Some(slope), None) | (None, Some(slope)) => slope,
                (None, None) => 0.0,
            }
        });
        Ok(slopes.collect())
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
        let Self { rows, data: Data { clock, signals, grid, between, before }, .. } = self;
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
            rows.feed(&mut **grid, signals, clock.start + clock.ticks as f64 * h);
            grid.step(h)?;
        }
        let rest = target - (clock.start + clock.ticks as f64 * h);
        clock.off_grid = rest > tolerance * h;
        if clock.off_grid {
            between.clone_from(grid);
            rows.feed(&mut **between, signals, target);
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

impl Slave for Run {
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
        let row = &self.rows[variable];
        if row.is_real() {
            return Ok(row.real(self.model()));
        }
        match row.read(self.model()) {
            Value::Real(value) => Ok(value),
            Value::Integer(value) => Ok(f64::from(value)),
            Value::Boolean(value) => Ok(f64::from(u8::from(value))),
            Value::Text(_) => Err(Error::variable(format!("{} is a text", self.info(variable)?.name))),
        }
    }

    fn get_all(&mut self, variables: &[usize], values: &mut [f64]) -> Result<()> {
        let clock = &self.data.clock;
        let is_real = |variable: &usize| self.rows.get(*variable).is_some_and(Row::is_real);
        if clock.phase != Phase::Running || !variables.iter().all(is_real) {
            for (variable, value) in variables.iter().zip(values) {
                *value = self.get(*variable)?;
            }
            return Ok(());
        }
        let read = self.rows.reals(self.model(), variables);
        for ((variable, value), read) in variables.iter().zip(values).zip(read) {
            let signal = self.courses[*variable].map(|course| &self.data.signals[course]);
            *value = signal.map_or(read, |signal| signal.at(clock.time));
        }
        Ok(())
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
        match self.rows[variable].read(self.model()) {
            Value::Text(text) => Ok(text),
            _ => Err(Error::variable(format!("{} is not a text", self.info(variable)?.name))),
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
        if !(info.is_real() && info.causality == Causality::Output && clock.phase == Phase::Running) {
            let what = format!("the derivative of {}", info.name);
            return Err(match clock.phase {
                Phase::Running => Error::variable(format!("{what}: only real outputs have one")),
                _ => wrong_order(&what, "before the end of initialization or after a failed step"),
            });
        }
        if !self.rows[variable].has_derivative() {
            return Ok(0.0);
        }
        let past = clock.time - clock.time_before;
        if past > 0.0 {
            return Ok((self.rows[variable].real(self.model())
                - self.rows[variable].real(&*self.data.before))
                / past);
        }
        // no step yet: look ahead on a copy, with the inputs on their way as a step would have them
        let mut ahead = self.data.clone();
        ahead.find_natural_rates(&self.rates);
        let Data { clock, signals, grid, between, .. } = &mut ahead;
        between.clone_from(grid);
        self.rows.feed(&mut **between, signals, clock.start + clock.step_size);
        between.step(clock.step_size)?;
        Ok((self.rows[variable].real(&**between) - self.rows[variable].real(&**grid)) / clock.step_size)
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
        match snapshot.downcast_mut::<Data>().filter(|data| data.is_of_same_model(&self.data)) {
            Some(data) => data.clone_from(&self.data),
            None => *snapshot = self.save()?,
        }
        Ok(())
    }

    fn restore(&mut self, snapshot: &Snapshot) -> Result<()> {
        let data = self.own(snapshot)?;
        self.data.clone_from(data);
        Ok(())
    }

    fn serialize(&mut self, snapshot: &Snapshot) -> Result<Vec<u8>> {
        let payload = self
            .own(snapshot)?
            .to_bytes()
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
        let data = Data::from_bytes(payload, &*self.data.grid)
            .map_err(|e| Error::call(format!("the bytes of the saved state cannot be read: {e}")))?;
        // A digest is no signature: whoever wants to can make a valid one.
        if !data.is_possible(&self.rows, &self.interface) {
            return Err(Error::call("the bytes are not a state that this model can be in"));
        }
        Ok(Box::new(data))
    }

    fn reset(&mut self) -> Result<()> {
        self.data = Data::new((self.make)(), &self.rows, &self.interface, &self.settings);
        Ok(())
    }
}
