//! Runs a slave along a recording of its inputs and records what comes out.

use crate::model::unit::Unit;
use crate::model::{Causality, Interface, Kind, Slave, Value, VariableInfo};
use crate::recording::{Channel, Recording, interpolate};
use crate::{Error, ErrorKind, Result};

/// More values than this (4 GB) are not recorded.
const MAX_VALUES: f64 = 5e8;
/// How far a last step may be from a whole one, in steps, to count as whole.
const STEP_TOLERANCE: f64 = 1e-6;

/// The parameter of a rig that says whether its commands pass its actuators.
pub const ACTUATORS: &str = "command_actuators";

/// Values that switch off the actuators of what recordings drive: these hold the motions that a rig made, and its
/// actuators must not follow them once more.
///
/// `recorded` are the inputs that recordings hold. What switches an actuator is a boolean parameter called
/// [`ACTUATORS`], in a wired system `part.command_actuators`. It is left alone if it is off anyway, if it `is_given` by
/// the user, or if no input of its part is recorded.
pub fn follow_recorded_motions(
    interface: &Interface,
    recorded: &[usize],
    is_given: impl Fn(usize) -> bool,
) -> Vec<(usize, Value)> {
    let drives = |part: &str| {
        let mut names = recorded.iter().filter_map(|v| interface.variables.get(*v)).map(|v| &v.name);
        (part.is_empty() || part.ends_with('.')) && names.any(|name| name.starts_with(part))
    };
    let is_switch = |(variable, info): &(usize, &VariableInfo)| {
        info.name.strip_suffix(ACTUATORS).is_some_and(drives)
            && info.causality == Causality::Parameter
            && info.kind == Kind::Boolean
            && info.start != Some(Value::Boolean(false))
            && !is_given(*variable)
    };
    let switches = interface.variables.iter().enumerate().filter(is_switch);
    switches.map(|(variable, _)| (variable, Value::Boolean(false))).collect()
}

/// What to say to the user if [`follow_recorded_motions`] has switched off the parameter called `name`.
pub fn motions_are_followed(name: &str) -> String {
    format!(
        "{name} is false in these runs: recorded inputs are taken for the motions themselves and do not pass the actuators. If they are commands, set {name} = true."
    )
}

/// What to run.
#[derive(Debug, Clone, Default)]
pub struct Experiment<'a> {
    /// Recorded inputs. Channels named like outputs are what was measured; they are left alone.
    pub inputs: Option<&'a Recording>,
    /// Values of parameters and of inputs that are not recorded.
    pub values: Vec<(usize, Value)>,
    /// Start \[s\]; else the first recorded time, else that of the default experiment.
    pub start: Option<f64>,
    /// Stop \[s\]; else the last recorded time, else that of the default experiment.
    pub stop: Option<f64>,
    /// Communication step \[s\]; else the one that suits the slave.
    pub step: Option<f64>,
}

/// What came out.
#[derive(Debug)]
pub struct Outcome {
    /// Inputs, outputs and internal quantities at the communication points, as far as it went.
    pub recording: Recording,
    /// Why it ended before the stop time, if it did.
    pub stopped: Option<Error>,
}

/// The times of a run.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Schedule {
    /// First communication point \[s\].
    pub start: f64,
    /// Last one \[s\].
    pub stop: f64,
    /// Communication step \[s\].
    pub step: f64,
    /// Number of steps; the last one may be shorter.
    pub steps: usize,
}

impl Schedule {
    /// Communication point `k`: never a sum of steps, so that rounding does not pile up.
    pub fn point(&self, k: usize) -> f64 {
        if k >= self.steps { self.stop } else { self.start + k as f64 * self.step }
    }

    /// True if the last step is as long as the others.
    pub fn is_even(&self) -> bool {
        let last = self.stop - (self.start + (self.steps - 1) as f64 * self.step);
        (last / self.step - 1.0).abs() <= STEP_TOLERANCE
    }
}

/// A recorded input, in the unit of its variable.
struct Course {
    variable: usize,
    values: Vec<f64>,
    continuous: bool,
}

impl Experiment<'_> {
    /// The times of the run on a slave with this interface.
    ///
    /// # Errors
    /// Times that are not finite or reversed, a step that is not positive, a recording that does not
    /// reach from start to stop.
    pub fn schedule(&self, interface: &Interface) -> Result<Schedule> {
        let recorded = self.inputs.and_then(|r| Some((*r.time.first()?, *r.time.last()?)));
        let start = self.start.or(recorded.map(|r| r.0)).unwrap_or(interface.start_time);
        let stop = self.stop.or(recorded.map(|r| r.1)).unwrap_or(interface.stop_time);
        let step = self.step.unwrap_or(interface.communication_step);
        if !(start.is_finite() && stop.is_finite() && stop > start) {
            return Err(Error::call(format!(
                "the stop time {stop} s has to be after the start time {start} s"
            )));
        }
        if !(step.is_finite() && step > 0.0) {
            return Err(Error::call(format!("the step {step} s has to be a positive time")));
        }
        if let Some(recording) = self.inputs {
            recording.covers(start, stop)?;
        }
        let steps = ((stop - start) / step - STEP_TOLERANCE).ceil().max(1.0);
        let values = steps * interface.variables.len() as f64;
        if values > MAX_VALUES {
            return Err(Error::call(format!(
                "{steps:.1e} steps of {step} s give {values:.1e} values, more than the {MAX_VALUES:.0e} that are kept in memory; take longer steps or a shorter time"
            )));
        }
        Ok(Schedule { start, stop, step, steps: steps as usize })
    }

    fn courses(&self, interface: &Interface) -> Result<Vec<Course>> {
        let Some(recording) = self.inputs else { return Ok(Vec::new()) };
        let mut courses = Vec::new();
        for channel in &recording.channels {
            let place = format!("{}: channel {:?}", recording.source, channel.name);
            let variable = interface.find(&channel.name).map_err(|e| {
                let way_out =
                    format!("a column that is not needed is left out with --ignore {}", channel.name);
                Error::file(format!("{place}: {e}; {way_out}"))
            })?;
            let info = &interface.variables[variable];
            match info.causality {
                Causality::Input => {}
                // measured, to be compared with
                Causality::Output | Causality::Local => continue,
                _ => {
                    return Err(Error::file(format!(
                        "{place}: {} is a parameter of {}; set it with --set or in a parameter file",
                        info.name, interface.name
                    )));
                }
            }
            if self.values.iter().any(|(index, _)| *index == variable) {
                return Err(Error::file(format!("{place}: the input is recorded and set at the same time")));
            }
            let values = recording.channel_in(&channel.name, info.unit.as_deref().unwrap_or("1"))?;
            for (time, value) in recording.time.iter().zip(&values) {
                let value = match info.kind {
                    Kind::Real => Value::Real(*value),
                    Kind::Boolean => Value::Boolean(*value != 0.0),
                    _ => Value::Integer(*value as i32),
                };
                info.accept(&value).map_err(|e| Error::file(format!("{place}: at {time} s {e}")))?;
            }
            courses.push(Course { variable, values, continuous: info.kind == Kind::Real });
        }
        Ok(courses)
    }
}

/// Runs `slave`, which was just made or reset, through an experiment.
///
/// Between communication points real inputs run straight from value to value: the slave gets value
/// and derivative at the beginning of each step if it can use derivatives, else it holds the value.
/// `observe` is called at every communication point with its number.
///
/// # Errors
/// An experiment that does not fit the slave, or a slave that does not start. A slave that stops on
/// the way is no error of this function: see [`Outcome::stopped`].
pub fn simulate<S: Slave + ?Sized>(
    slave: &mut S,
    experiment: &Experiment<'_>,
    mut observe: impl FnMut(usize, &mut S),
) -> Result<Outcome> {
    let schedule = experiment.schedule(slave.interface())?;
    let courses = experiment.courses(slave.interface())?;
    let time = experiment.inputs.map(|r| r.time.as_slice()).unwrap_or_default();
    let value = |course: &Course, t: f64| {
        if course.continuous {
            interpolate(time, &course.values, t)
        } else {
            // the last sample that is not later
            let next = time.partition_point(|sample| *sample <= t + STEP_TOLERANCE * schedule.step);
            course.values[next.saturating_sub(1)]
        }
    };

    for (variable, value) in &experiment.values {
        slave.set_value(*variable, value)?;
    }
    slave.start(schedule.start, Some(schedule.stop))?;
    for course in &courses {
        slave.set(course.variable, value(course, schedule.start))?;
    }
    slave.finish_start()?;

    let mut recorder = Recorder::new(slave.interface(), schedule.steps + 1);
    recorder.take(schedule.start, slave)?;
    observe(0, slave);
    let rates = slave.can_interpolate();
    for k in 0..schedule.steps {
        let (now, next) = (schedule.point(k), schedule.point(k + 1));
        let mut step = || -> Result<()> {
            for course in &courses {
                let at = value(course, now);
                slave.set(course.variable, at)?;
                if course.continuous && rates {
                    slave.set_rate(course.variable, (value(course, next) - at) / (next - now))?;
                }
            }
            slave.step(now, next - now)?;
            recorder.take(next, slave)
        };
        if let Err(error) = step() {
            return Ok(Outcome {
                recording: recorder.recording,
                stopped: Some(error.at(format!("{now} s"))),
            });
        }
        for course in &courses {
            // what was asked for, also from slaves that hold it
            recorder.correct(course.variable, value(course, next));
        }
        observe(k + 1, slave);
    }
    Ok(Outcome { recording: recorder.recording, stopped: None })
}

/// Variables of a slave that are read together: the real ones in one call, which of an FMU takes a fraction of the time
/// that a call for each takes.
pub(crate) struct Reader {
    /// The variables, in the order of their values.
    variables: Vec<usize>,
    /// The real ones among them, and where their values belong.
    real: Vec<usize>,
    places: Vec<usize>,
    /// The values of those.
    together: Vec<f64>,
    /// Where the values of all others belong.
    others: Vec<usize>,
}

impl Reader {
    pub(crate) fn new(interface: &Interface, variables: Vec<usize>) -> Self {
        let (places, others): (Vec<usize>, Vec<usize>) =
            (0..variables.len()).partition(|i| interface.variables[variables[*i]].is_real());
        let real: Vec<usize> = places.iter().map(|i| variables[*i]).collect();
        Self { together: vec![0.0; real.len()], variables, real, places, others }
    }

    /// Reads all of them into `values`, which has room for them.
    ///
    /// # Errors
    /// As [`Slave::get`], with the first variable that cannot be read.
    pub(crate) fn read(&mut self, slave: &mut (impl Slave + ?Sized), values: &mut [f64]) -> Result<()> {
        if !self.real.is_empty()
            && let Err(error) = slave.get_all(&self.real, &mut self.together)
        {
            // one by one it shows which it was; an FMU that is dead says that of each, and not why
            let failed: Vec<Error> =
                self.variables.iter().filter_map(|variable| slave.get(*variable).err()).collect();
            let is_dead = error.kind() == ErrorKind::Fmu && failed.len() == self.variables.len();
            return Err(failed.into_iter().next().filter(|_| !is_dead).unwrap_or(error));
        }
        for (place, value) in self.places.iter().zip(&self.together) {
            values[*place] = *value;
        }
        for place in &self.others {
            values[*place] = slave.get(self.variables[*place])?;
        }
        Ok(())
    }
}

/// Collects the values of all numeric variables that can change.
struct Recorder {
    reader: Reader,
    /// Values on their way.
    values: Vec<f64>,
    /// The column of each variable, if it has one.
    columns: Vec<Option<usize>>,
    recording: Recording,
}

impl Recorder {
    fn new(interface: &Interface, samples: usize) -> Self {
        let mut recording = Recording {
            time: Vec::with_capacity(samples),
            channels: Vec::new(),
            source: interface.name.clone(),
        };
        let mut variables = Vec::new();
        let mut columns = vec![None; interface.variables.len()];
        for causality in [Causality::Input, Causality::Output, Causality::Local] {
            for variable in interface.with(causality) {
                let info = &interface.variables[variable];
                if info.kind == Kind::Text {
                    continue;
                }
                // a unit from outside that is not known here could not be written to a file that reads back
                let unit = info.unit.clone().filter(|u| Unit::parse(u).is_ok()).unwrap_or_else(|| "1".into());
                columns[variable] = Some(variables.len());
                variables.push(variable);
                let values = Vec::with_capacity(samples);
                recording.channels.push(Channel { name: info.name.clone(), unit, values });
            }
        }
        Self {
            values: vec![0.0; variables.len()],
            reader: Reader::new(interface, variables),
            columns,
            recording,
        }
    }

    fn take(&mut self, time: f64, slave: &mut (impl Slave + ?Sized)) -> Result<()> {
        self.reader.read(slave, &mut self.values)?;
        self.recording.time.push(time);
        for (channel, value) in self.recording.channels.iter_mut().zip(&self.values) {
            channel.values.push(*value);
        }
        Ok(())
    }

    fn correct(&mut self, variable: usize, value: f64) {
        if let Some(i) = self.columns[variable]
            && let Some(last) = self.recording.channels[i].values.last_mut()
        {
            *last = value;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::{Access, Model, Native, Settings, Table, boolean_parameter, input, output, parameter};
    use crate::real;
    use serde::{Deserialize as De, Serialize as Ser};

    /// A drive whose position follows its command by a lag, or is the command.
    #[derive(Clone, Default, PartialEq, Ser, De)]
    struct Rig {
        command: f64,
        position: f64,
        frequency: f64,
        command_actuators: bool,
    }

    impl Model for Rig {
        const NAME: &'static str = "rig";
        const DESCRIPTION: &'static str = "A rig";
        fn variables() -> Table<Self> {
            Table::new([
                input("command", "m", real!(command), 0.0, "Command"),
                output("position", "m", real!(position), "Position"),
                parameter("actuator_frequency", "rad/s", real!(frequency), 10.0, "Corner").range(1.0, 1e3),
                boolean_parameter(
                    "command_actuators",
                    Access::boolean(
                        |m: &Self| m.command_actuators,
                        |m: &mut Self, v| m.command_actuators = v,
                    ),
                    true,
                    "Commands pass the actuators",
                ),
            ])
        }

        fn step_size(&self) -> f64 {
            1e-3
        }

        fn initialize(&mut self) -> Result<()> {
            self.position = self.command;
            Ok(())
        }

        fn step(&mut self, length: f64) -> Result<()> {
            let share = if self.command_actuators { 1.0 - (-self.frequency * length).exp() } else { 1.0 };
            self.position += share * (self.command - self.position);
            Ok(())
        }
    }

    #[test]
    fn variables_that_are_read_together_have_the_values_that_each_has() {
        let mut slave = Native::<Rig>::new(&Settings::default()).unwrap();
        slave.set(0, 0.25).unwrap();
        // real ones and a switch, in no order
        let variables = [3, 1, 2, 0];
        let mut reader = Reader::new(slave.interface(), variables.into());
        let mut values = [f64::NAN; 4];
        let error = reader.read(&mut slave, &mut values).unwrap_err().to_string();
        assert!(error.contains("command_actuators"), "the first that cannot be read: {error}");
        slave.start(0.0, None).unwrap();
        slave.finish_start().unwrap();
        reader.read(&mut slave, &mut values).unwrap();
        assert_eq!(values, [1.0, 0.25, 10.0, 0.25]);
        assert_eq!(values, variables.map(|variable| slave.get(variable).unwrap()));
    }

    #[test]
    fn recorded_motions_do_not_pass_the_actuators_once_more() {
        let interface = Native::<Rig>::table();
        let (command, switch) = (0, 3);
        let off = |recorded: &[usize]| follow_recorded_motions(&interface, recorded, |_| false);
        assert_eq!(off(&[command]), [(switch, Value::Boolean(false))]);
        assert!(motions_are_followed("command_actuators").contains("command_actuators = true"));
        // nothing is recorded that it drives, or somebody has set it
        assert_eq!(off(&[]), []);
        assert_eq!(follow_recorded_motions(&interface, &[command], |v| v == switch), []);
        // or it is off
        let mut is_off = interface.clone();
        is_off.variables[switch].start = Some(Value::Boolean(false));
        assert_eq!(follow_recorded_motions(&is_off, &[command], |_| false), []);
        // it is a number, or belongs to another part
        let mut number = interface.clone();
        number.variables[switch].kind = Kind::Real;
        assert_eq!(follow_recorded_motions(&number, &[command], |_| false), []);
        let mut system = interface.clone();
        for (name, variable) in
            ["left.command", "left.position", "right.actuator_frequency", "right.command_actuators"]
                .iter()
                .zip(&mut system.variables)
        {
            variable.name = (*name).into();
        }
        assert_eq!(follow_recorded_motions(&system, &[command], |_| false), []);
        system.variables[switch].name = "left.command_actuators".into();
        assert_eq!(follow_recorded_motions(&system, &[command], |_| false).len(), 1);

        // a recorded ramp is the motion then, and lags by 1 / frequency otherwise
        let time: Vec<f64> = (0..=200).map(|k| 0.01 * f64::from(k)).collect();
        let ramp = Channel { name: "command".into(), unit: "m".into(), values: time.clone() };
        let recording = Recording { source: "ramp".into(), time, channels: vec![ramp] };
        let last = |values: Vec<(usize, Value)>| {
            let mut slave = Native::<Rig>::new(&Settings::default()).unwrap();
            let experiment = Experiment { inputs: Some(&recording), values, ..Experiment::default() };
            let outcome = simulate(&mut slave, &experiment, |_, _| {}).unwrap();
            *outcome.recording.channel("position").unwrap().values.last().unwrap()
        };
        assert!((last(off(&[command])) - 2.0).abs() < 1e-9);
        // a lag of first order on a ramp, which it meets at the ends of its steps: late by the lag, less half a step
        assert!((last(Vec::new()) - (2.0 - 0.1)).abs() < 1e-3, "{}", last(Vec::new()));
    }
}
