//! [`Bench`]: runs one kind of slave many times, on all cores.

use crate::effect::{Attached, Attachment, Earlier};
use crate::model::{Interface, Slave, Value};
use crate::{Error, Result};
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::mpsc::{Receiver, Sender, channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread;

/// Makes a slave; every thread has its own.
pub type Factory = Arc<dyn Fn() -> Result<Box<dyn Slave>> + Send + Sync>;

/// What drives a run: an even grid of communication points and the inputs on it.
#[derive(Debug, Clone, PartialEq)]
pub struct Drive {
    /// First communication point \[s\].
    pub start: f64,
    /// Communication step \[s\].
    pub step: f64,
    /// Values of the driven inputs at every communication point: index of the variable and values.
    pub inputs: Vec<(usize, Vec<f64>)>,
    /// What signals show at the start that count on and on, as the angle of a wheel does, where it was recorded: index of
    /// the variable and value. Effects get them from there.
    pub begins: Vec<(usize, f64)>,
    /// The runs of the session before this one, the earliest first.
    pub earlier: Arc<[Arc<Earlier>]>,
    /// Number of communication points.
    pub points: usize,
    /// The same with longer communication steps, where these are enough to tell how outputs change with an unknown.
    pub coarser: Option<Arc<Drive>>,
}

impl Drive {
    /// One without anything that has to be said of few runs only.
    pub fn new(start: f64, step: f64, points: usize, inputs: Vec<(usize, Vec<f64>)>) -> Self {
        Self { start, step, inputs, begins: Vec::new(), earlier: Arc::default(), points, coarser: None }
    }

    /// How long it takes, in the time of the model \[s\].
    pub fn length(&self) -> f64 {
        self.points.saturating_sub(1) as f64 * self.step
    }

    /// Communication point `k` \[s\]: never a sum of steps.
    pub fn time(&self, k: usize) -> f64 {
        self.start + k as f64 * self.step
    }
}

/// What is run: values of variables and attached effects.
#[derive(Debug, Clone, Default)]
pub struct Setup {
    /// Values before the start, by index in the interface with effects.
    pub values: Vec<(usize, f64)>,
    /// Effects.
    pub attachments: Vec<Attachment>,
}

/// Watched variables at every communication point, in the order of the watched ones.
pub type Traces = Vec<Vec<f64>>;

struct Task {
    number: usize,
    drive: Arc<Drive>,
    setup: Arc<Setup>,
    watch: Arc<[usize]>,
    answer: Sender<(usize, Result<Traces>)>,
}

/// A pool of threads with a slave each.
pub struct Bench {
    tasks: Sender<Task>,
    interface: Interface,
    /// Of each variable: parts inside get it.
    passed_on: Vec<bool>,
    threads: usize,
    /// What was simulated, in millionths of a second: whole numbers have a sum that no order changes.
    simulated: AtomicU64,
}

impl Bench {
    /// Makes the slaves. `fixed` is set in every run before the values of its setup.
    ///
    /// # Errors
    /// A slave that cannot be made.
    pub fn new(factory: &Factory, fixed: &[(usize, Value)], threads: usize) -> Result<Self> {
        let slave = factory()?;
        let interface = slave.interface().clone();
        let passed_on = (0..interface.variables.len()).map(|v| slave.is_passed_on(v)).collect();
        let (tasks, queue) = channel::<Task>();
        let queue = Arc::new(Mutex::new(queue));
        for _ in 0..threads.max(1) {
            let (factory, queue, fixed) = (Arc::clone(factory), Arc::clone(&queue), fixed.to_vec());
            thread::spawn(move || work(&factory, &fixed, &queue));
        }
        Ok(Self { tasks, interface, passed_on, threads: threads.max(1), simulated: AtomicU64::new(0) })
    }

    /// The interface of the slaves without effects.
    pub fn interface(&self) -> &Interface {
        &self.interface
    }

    /// Whether parts inside the slaves get the value of an output, as [`Slave::is_passed_on`] says.
    pub fn is_passed_on(&self, variable: usize) -> bool {
        self.passed_on.get(variable).copied().unwrap_or_default()
    }

    /// How many runs go on at the same time.
    pub fn threads(&self) -> usize {
        self.threads
    }

    /// How many seconds were simulated so far, all runs together \[s\].
    pub fn simulated(&self) -> f64 {
        self.simulated.load(Ordering::Relaxed) as f64 * 1e-6
    }

    /// Runs every setup along every drive; the answers are in the order setup by setup. `watch` are
    /// indices of variables.
    ///
    /// # Errors
    /// One for each run that fails: values that the slave refuses, a model that leaves its validity.
    pub fn run(
        &self,
        setups: &[Arc<Setup>],
        drives: &[Arc<Drive>],
        watch: &Arc<[usize]>,
    ) -> Vec<Result<Traces>> {
        let each: f64 = drives.iter().map(|d| 1e6 * d.length()).sum();
        self.simulated.fetch_add((each * setups.len() as f64).round() as u64, Ordering::Relaxed);
        let (answer, answers) = channel();
        let mut number = 0;
        for setup in setups {
            for drive in drives {
                let task = Task {
                    number,
                    drive: Arc::clone(drive),
                    setup: Arc::clone(setup),
                    watch: Arc::clone(watch),
                    answer: answer.clone(),
                };
                // a pool that is gone answers nothing, which is noticed below
                let _ = self.tasks.send(task);
                number += 1;
            }
        }
        drop(answer);
        let mut results: Vec<Result<Traces>> =
            (0..number).map(|_| Err(Error::numeric("the run was never done"))).collect();
        for (number, result) in answers {
            results[number] = result;
        }
        results
    }
}

fn work(factory: &Factory, fixed: &[(usize, Value)], queue: &Mutex<Receiver<Task>>) {
    let mut spare: Option<Box<dyn Slave>> = None;
    loop {
        let task = queue.lock().unwrap_or_else(PoisonError::into_inner).recv();
        let Ok(task) = task else { return };
        let fresh = match spare.take() {
            Some(mut slave) => match slave.reset() {
                Ok(()) => Ok(slave),
                Err(_) => factory(),
            },
            None => factory(),
        };
        let result = fresh.and_then(|slave| Attached::new(slave, task.setup.attachments.clone())).and_then(
            |mut attached| {
                let result = drive(&mut attached, fixed, &task);
                spare = Some(attached.into_inner());
                result
            },
        );
        let _ = task.answer.send((task.number, result));
    }
}

fn drive(slave: &mut Attached<dyn Slave>, fixed: &[(usize, Value)], task: &Task) -> Result<Traces> {
    let Task { drive, setup, watch, .. } = task;
    for (variable, value) in fixed {
        slave.set_value(*variable, value)?;
    }
    for (variable, value) in &setup.values {
        slave.set(*variable, *value)?;
    }
    for (variable, value) in &drive.begins {
        slave.begin_at(*variable, *value);
    }
    let last = drive.points.saturating_sub(1);
    slave.comes_after(Arc::clone(&drive.earlier));
    slave.start(drive.start, Some(drive.time(last)))?;
    for (variable, values) in &drive.inputs {
        slave.set(*variable, values[0])?;
    }
    slave.finish_start()?;
    let mut traces: Traces = watch.iter().map(|_| Vec::with_capacity(drive.points)).collect();
    let mut now_values = vec![0.0; watch.len()];
    let mut take = |slave: &mut Attached<dyn Slave>, traces: &mut Traces| -> Result<()> {
        slave.get_all(watch, &mut now_values)?;
        for ((trace, variable), value) in traces.iter_mut().zip(watch.iter()).zip(&now_values) {
            if !value.is_finite() {
                let name = &slave.interface().variables[*variable].name;
                return Err(Error::numeric(format!("{name} is {value}")));
            }
            trace.push(*value);
        }
        Ok(())
    };
    take(slave, &mut traces)?;
    // what does not move was set at the start, and what is no real number is held
    let interface = slave.interface();
    let moving: Vec<&(usize, Vec<f64>)> =
        drive.inputs.iter().filter(|(_, v)| v.windows(2).any(|w| w[0] != w[1])).collect();
    let (moving, held): (Vec<_>, Vec<_>) =
        moving.into_iter().partition(|(variable, _)| interface.variables[*variable].is_real());
    let variables: Vec<usize> = moving.iter().map(|m| m.0).collect();
    let (mut values, mut rates) = (vec![0.0; moving.len()], vec![0.0; moving.len()]);
    for k in 0..last {
        let now = drive.time(k);
        let length = drive.time(k + 1) - now;
        for (i, (_, course)) in moving.iter().enumerate() {
            values[i] = course[k];
            rates[i] = (course[k + 1] - course[k]) / length;
        }
        slave.set_all(&variables, &values, &rates)?;
        for (variable, course) in &held {
            slave.set(*variable, course[k])?;
        }
        slave.step(now, length).map_err(|e| e.at(format!("{now} s")))?;
        take(slave, &mut traces)?;
    }
    // an input beside a sample is the one of the sample
    for (trace, variable) in traces.iter_mut().zip(watch.iter()) {
        if let Some((_, values)) = drive.inputs.iter().find(|(v, _)| v == variable) {
            trace.copy_from_slice(&values[..drive.points]);
        }
    }
    Ok(traces)
}
