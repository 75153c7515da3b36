//! The step that all bodies share.

use std::ops::{Add, Mul};

/// What the first half of a step makes of a coordinate and its velocity.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Drift<V> {
    /// Velocity at mid-step.
    pub velocity: V,
    /// Way over the whole step.
    pub travel: V,
    /// Velocity predicted for the end of the step, for whatever damps there.
    pub predicted: V,
}

/// First half of a velocity-Verlet step of `dt` seconds: half a kick with the acceleration at its beginning, and the
/// drift. A body is then at its new place; forces are found there, at the predicted velocity, and [`kick`] ends the
/// step. Without dampers it is of second order, reversible, and keeps the energy of springs over any time; with
/// them it is of second order.
#[inline]
pub fn drift<V>(velocity: V, acceleration: V, dt: f64) -> Drift<V>
where
    V: Copy + Add<Output = V> + Mul<f64, Output = V>,
{
    let half = 0.5 * dt;
    let middle = velocity + acceleration * half;
    Drift { velocity: middle, travel: middle * dt, predicted: middle + acceleration * half }
}

/// Second half: the velocity at the end of the step from that at mid-step and the acceleration at the end.
#[inline]
pub fn kick<V>(velocity: V, acceleration: V, dt: f64) -> V
where
    V: Copy + Add<Output = V> + Mul<f64, Output = V>,
{
    velocity + acceleration * (0.5 * dt)
}
