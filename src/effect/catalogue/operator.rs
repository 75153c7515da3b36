//! What several effects are made of: filters and hystereses that take any step, in closed form.
//!
//! Between calls their input runs straight from its last value, so that a step and its two halves give
//! the same.

use crate::effect::{Call, Memory, Parameter};
use std::f64::consts::TAU;

/// What a store of heat has left of one run when the next begins.
pub(super) const HEAT_KEPT: Parameter =
    Parameter::kept("Share of the heat that is left when the next run of a session begins");

/// The sign of a velocity, smooth over `width`; tanh(v / width).
pub(super) fn soft_sign(velocity: f64, width: f64) -> f64 {
    if width > 0.0 {
        libm::tanh(velocity / width)
    } else if velocity == 0.0 {
        0.0
    } else {
        velocity.signum()
    }
}

/// A factor on a driver that keeps products of several finite.
pub(super) fn bounded(value: f64) -> f64 {
    value.clamp(-1e90, 1e90)
}

/// a cos(angle) + b sin(angle).
pub(super) fn harmonic(a: f64, b: f64, angle: f64) -> f64 {
    let (sin, cos) = libm::sincos(angle);
    a * cos + b * sin
}

/// 1 - a loss that is `loss` while it is small, and goes to 0 (or 2) when it is not.
pub(super) fn remaining(loss: f64) -> f64 {
    1.0 - libm::tanh(loss)
}

/// A store that an inflow fills and that leaks: E' = P - E / tau, empty at the start. The content is
/// state `i`, the last inflow state `i + 1`.
pub(super) fn store(memory: &mut Memory, i: usize, inflow: f64, tau: f64, dt: f64) -> f64 {
    let (content, last) = (memory.states[i], memory.states[i + 1]);
    memory.states[i + 1] = inflow;
    if dt > 0.0 {
        let x = dt / tau;
        memory.states[i] = if tau > 0.0 && x > 1e-7 {
            let gone = -libm::expm1(-x);
            content * (1.0 - gone) + tau * (last * gone + (inflow - last) * (1.0 - gone / x))
        } else {
            // hardly any leak in so short a time
            content + 0.5 * dt * (last + inflow)
        };
    }
    memory.states[i]
}

/// A mode of vibration on the way of a number: y'' + 2 D w y' + w^2 (y - goal) = 0 with w = 2 pi f, at
/// rest at the start. Value, rate and last goal are the states `i` to `i + 2`.
pub(super) fn mode(memory: &mut Memory, i: usize, goal: f64, hertz: f64, damping: f64, dt: f64) -> f64 {
    let (y, rate, last) = (memory.states[i], memory.states[i + 1], memory.states[i + 2]);
    memory.states[i + 2] = goal;
    if dt <= 0.0 || hertz <= 0.0 {
        (memory.states[i], memory.states[i + 1]) = (goal, 0.0);
        return goal;
    }
    let damping = damping.clamp(0.0, 0.99);
    let (w, slope) = (TAU * hertz, (goal - last) / dt);
    let (decay, free) = (damping * w, w * (1.0 - damping * damping).sqrt());
    // what is left when the straight course that follows the goal at a distance is taken off
    let behind = 2.0 * damping / w * slope;
    let (e, de) = (y - (last - behind), rate - slope);
    let (shrink, (sin, cos)) = (libm::exp(-decay * dt), libm::sincos(free * dt));
    memory.states[i] = goal - behind + shrink * (e * cos + (de + decay * e) / free * sin);
    memory.states[i + 1] = slope + shrink * (de * cos - (w * w * e + decay * de) / free * sin);
    memory.states[i]
}

/// What an effect does to a number of which the share `p[0]` passes a mode of `p[1]` Hz with the damping ratio `p[2]`.
pub(super) fn share_through_mode(p: &[f64], memory: &mut Memory, call: &Call<'_>) -> f64 {
    if p[0] == 0.0 {
        return call.target;
    }
    call.target + p[0] * (mode(memory, 0, call.target, p[1], p[2], call.dt) - call.target)
}

/// Bouc and Wen's hysteresis with exponent 1 and beta = gamma over a distance `length`, between -1 and 1:
/// straight while unloading, exponential while loading. Value and last input are the states `i` and
/// `i + 1`.
pub(super) fn bouc_wen(memory: &mut Memory, i: usize, x: f64, length: f64, dt: f64) -> f64 {
    let (z, last) = (memory.states[i], memory.states[i + 1]);
    memory.states[i + 1] = x;
    if dt <= 0.0 || length <= 0.0 || x == last {
        return z;
    }
    let way = (x - last) / length;
    let unloads = z * way < 0.0;
    let loading = if unloads { way.abs() - z.abs() } else { way.abs() };
    memory.states[i] = if loading <= 0.0 {
        z + way
    } else {
        let begin = if unloads { 0.0 } else { z.abs() };
        way.signum() * (1.0 - (1.0 - begin) * libm::exp(-loading))
    };
    memory.states[i]
}

/// Berg's friction of rubber: from the last turn on a hyperbola towards -1 or 1, half of which is
/// reached after `length` from the virgin state. States: value, last input, value and input at the last
/// turn, direction.
pub(super) fn berg(memory: &mut Memory, x: f64, length: f64, dt: f64) -> f64 {
    let [value, last, mut turn_value, mut turn, mut direction, _] = memory.states;
    if dt <= 0.0 {
        memory.states = [0.0, x, 0.0, x, 0.0, 0.0];
        return 0.0;
    }
    let way = x - last;
    if way * direction < 0.0 {
        (turn_value, turn) = (value, last);
    }
    if way != 0.0 {
        direction = way.signum();
    }
    let (gone, room) = (x - turn, 1.0 - direction * turn_value);
    let next = if gone == 0.0 || length <= 0.0 {
        value
    } else {
        (turn_value + room * (gone / (length * room + gone.abs()))).clamp(-1.0, 1.0)
    };
    memory.states = [next, x, turn_value, turn, direction, 0.0];
    next
}
