//! What several integration tests need.
#![allow(dead_code, missing_docs, clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use latsch::model::{Model, Native, Settings, Slave};
use latsch::rig::RingBrushFlatTrack;
use latsch::tire::ring_brush::{Parameters, Prepared};
use std::sync::OnceLock;

pub mod rolling;

pub type FlatTrack = Native<RingBrushFlatTrack>;

/// A flat track with these start values, ready to step.
pub fn flat_track(values: &[(&str, f64)]) -> FlatTrack {
    started(values)
}

/// A model with these start values, ready to step.
pub fn started<M: Model>(values: &[(&str, f64)]) -> Native<M> {
    let mut slave = Native::new(&Settings::default()).unwrap();
    set(&mut slave, values);
    slave.start(0.0, None).unwrap();
    slave.finish_start().unwrap();
    slave
}

/// Steps from communication point `from` to `to`, `interval` seconds apart.
pub fn advance(slave: &mut dyn Slave, interval: f64, from: u32, to: u32) {
    for k in from..to {
        let t = f64::from(k) * interval;
        slave.step(t, f64::from(k + 1) * interval - t).unwrap();
    }
}

pub fn set<S: Slave + ?Sized>(slave: &mut S, values: &[(&str, f64)]) {
    for (name, value) in values {
        let index = slave.find(name).unwrap();
        slave.set(index, *value).unwrap();
    }
}

pub fn get<S: Slave + ?Sized>(slave: &mut S, name: &str) -> f64 {
    let index = slave.find(name).unwrap();
    slave.get(index).unwrap()
}

/// A slave with its time.
pub struct Run<S: Slave + ?Sized> {
    pub slave: Box<S>,
    time: f64,
}

impl<M: Model> Run<Native<M>> {
    pub fn new(values: &[(&str, f64)]) -> Self {
        Self { slave: Box::new(started(values)), time: 0.0 }
    }
}

/// A shipped model, which a test does not have to compile again.
pub type Shipped = Run<dyn Slave + Send>;

impl Shipped {
    pub fn new(name: &str, values: &[(&str, f64)]) -> Self {
        let mut slave = shipped(name);
        set(&mut *slave, values);
        slave.start(0.0, None).unwrap();
        slave.finish_start().unwrap();
        Self { slave, time: 0.0 }
    }
}

/// A shipped model before its start.
pub fn shipped(name: &str) -> Box<dyn Slave + Send> {
    let entry = latsch::fmi::Entry::find(latsch::shipped::MODELS, name).unwrap();
    entry.slave(&Settings::default()).unwrap()
}

impl<S: Slave + ?Sized> Run<S> {
    pub fn get(&mut self, name: &str) -> f64 {
        get(&mut *self.slave, name)
    }

    pub fn set(&mut self, name: &str, value: f64) {
        set(&mut *self.slave, &[(name, value)]);
    }

    pub fn step(&mut self, length: f64) {
        self.slave.step(self.time, length).unwrap();
        self.time += length;
    }
}

/// The pressure as the source prints it, for comparisons with the source's numbers.
pub const PRINTED_PRESSURE: (&str, f64) = ("limit_pressure_tilt", 0.0);
/// A rig whose commands are the motion.
pub const NO_ACTUATORS: (&str, f64) = ("command_actuators", 0.0);

/// The example tire of the source, as printed.
pub fn example() -> Parameters {
    example_tire().parameters().clone()
}

pub fn example_tire() -> Prepared {
    static TIRE: OnceLock<Prepared> = OnceLock::new();
    TIRE.get_or_init(|| flat_track(&[PRINTED_PRESSURE]).model().tire().prepared.clone()).clone()
}

/// Fails unless the two agree to `tolerance`, relative to the expected number.
#[track_caller]
pub fn assert_close(what: &str, value: f64, expected: f64, tolerance: f64) {
    let error = (value - expected).abs();
    assert!(
        error <= tolerance * expected.abs(),
        "{what}: {value} instead of {expected}, off by {:.2e} of it",
        error / expected.abs()
    );
}
