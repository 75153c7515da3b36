//! The rig in time: what a stationary start keeps, the transient target Z9 of the source, convergence
//! in step and bristles, manoeuvres at the edge of the model, and random programmes.
#![allow(missing_docs, clippy::unwrap_used, clippy::expect_used, clippy::panic)]

#[path = "../common/mod.rs"]
mod common;
mod grids;
mod manoeuvres;
mod programmes;
mod z9;

use common::{FlatTrack, get};
use latsch::model::Slave;

const FORCES: [&str; 6] = ["force_x", "force_y", "force_z", "moment_x", "moment_y", "moment_z"];
const TICK: f64 = 1e-3;

fn forces(rig: &mut FlatTrack) -> [f64; 6] {
    FORCES.map(|name| get(rig, name))
}

/// Steps to `end` in communication steps of a millisecond.
fn run(rig: &mut FlatTrack, end: f64, mut each: impl FnMut(&mut FlatTrack)) {
    let first = (rig.time() / TICK).round() as u32;
    for k in first..(end / TICK).round() as u32 {
        let t = f64::from(k) * TICK;
        rig.step(t, f64::from(k + 1) * TICK - t).unwrap();
        each(rig);
    }
}

/// Means of force and moment until `end`.
fn means(rig: &mut FlatTrack, end: f64) -> [f64; 6] {
    let (mut sums, mut count) = ([0.0; 6], 0.0);
    run(rig, end, |rig| {
        for (sum, value) in sums.iter_mut().zip(forces(rig)) {
            *sum += value;
        }
        count += 1.0;
    });
    sums.map(|s| s / count)
}

/// What holds in any state.
fn check_sanity(rig: &mut FlatTrack) {
    let outputs: Vec<usize> =
        (0..rig.interface().variables.len()).filter(|i| rig.interface().variables[*i].is_real()).collect();
    for index in outputs {
        let value = rig.get(index).unwrap();
        assert!(value.is_finite(), "{} = {value}", rig.interface().variables[index].name);
    }
    let normal = get(rig, "patch_force_z");
    let horizontal = get(rig, "patch_force_x").hypot(get(rig, "patch_force_y"));
    let share = get(rig, "negative_pressure_share");
    // 1.5 is the largest coefficient; bristles that pull carry no friction, others then carry more
    assert!(normal >= 0.0 && horizontal <= 1.5 * normal * (1.0 + share) + 1e-9, "{horizontal} of {normal}");
    assert!(get(rig, "friction_power") >= 0.0);
    assert!((0.0..=1.0).contains(&get(rig, "sliding_share")));
}

/// Finer bristles of the same rubber.
fn finer(factor: f64) -> [(&'static str, f64); 4] {
    [
        ("bristles_per_stripe", 30.0 * factor),
        ("bristle_length", 0.014 / factor),
        ("bristle_stiffness", 4e4 / factor),
        ("bristle_damping", 0.65 / factor),
    ]
}
