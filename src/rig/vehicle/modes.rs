//! What the bodies of the vehicle do about a state, for the check of its step.

use crate::mechanics::{Body, Coordinate, Motion};

/// A length that makes the turning of a body a way of its joints \[m\].
const ARM: f64 = 0.3;

/// The six coordinates of a body.
pub fn names(body: &str) -> Vec<Coordinate> {
    let along = ["forward", "sideways", "up and down"];
    let about = ["in roll or camber", "in pitch", "in yaw or steer"];
    let ways = along.iter().map(|way| (format!("{body} {way}"), 1.0));
    ways.chain(about.iter().map(|turn| (format!("{body} {turn}"), ARM))).collect()
}

/// A motion where places and velocities of its coordinates are changed.
pub fn moved(motion: &Motion<f64>, places: &[f64], velocities: &[f64]) -> Motion<f64> {
    let mut moved = *motion;
    for i in 0..3 {
        moved.position[i] += places[i];
        moved.angles[i] += places[3 + i];
        moved.velocity[i] += velocities[i];
        moved.rates[i] += velocities[3 + i];
    }
    moved
}

/// Accelerations of the coordinates of a body.
pub fn accelerations(body: &Body) -> impl Iterator<Item = f64> {
    body.acceleration.into_iter().chain(&body.turning).copied()
}
