//! What several integration tests need.
#![allow(dead_code, missing_docs, clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use latsch::model::{Native, Settings, Slave};
use latsch::rig::RingBrushFlatTrack;
use latsch::tire::ring_brush::{Parameters, Tire};
use std::sync::OnceLock;

pub mod rolling;

pub type FlatTrack = Native<RingBrushFlatTrack>;

/// A flat track with these start values, ready to step.
pub fn flat_track(values: &[(&str, f64)]) -> FlatTrack {
    let mut rig = FlatTrack::new(&Settings::default()).unwrap();
    set(&mut rig, values);
    rig.start(0.0, None).unwrap();
    rig.finish_start().unwrap();
    rig
}

pub fn set(slave: &mut dyn Slave, values: &[(&str, f64)]) {
    for (name, value) in values {
        let index = slave.find(name).unwrap();
        slave.set(index, *value).unwrap();
    }
}

pub fn get(slave: &mut dyn Slave, name: &str) -> f64 {
    let index = slave.find(name).unwrap();
    slave.get(index).unwrap()
}

/// The example tire of the source.
pub fn example() -> Parameters {
    example_tire().parameters().clone()
}

pub fn example_tire() -> Tire {
    static TIRE: OnceLock<Tire> = OnceLock::new();
    TIRE.get_or_init(|| flat_track(&[]).model().tire().clone()).clone()
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
