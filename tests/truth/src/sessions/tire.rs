//! The ring-and-brush tire, written from its specification: the belt as a rigid body between sidewall and patch.

use super::footing::Footing;
use super::frames::{Frame, Motion, Vector, add, cross, dot, minus, times};
use super::odd::Oddness;
use super::parameters::Parameters;
use super::patch::{Lagged, Load, Patch};
use super::sidewall::Sidewall;

/// Gravity \[m/s²\].
const GRAVITY: f64 = 9.81;

/// A tire in motion.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Tire {
    pub(crate) parameters: Parameters,
    pub(crate) belt: Motion,
    pub(crate) lagged: Lagged,
    patch: Patch,
}

/// What a step tells: force and moment on the rim in inertial axes (4.9) \[N, N.m\], and what the patch does.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Told {
    pub(crate) force: Vector,
    pub(crate) moment: Vector,
    pub(crate) patch: Load,
}

impl Tire {
    /// A tire whose belt moves with the rim.
    pub(crate) fn new(parameters: Parameters, rim: &Motion) -> Self {
        Self { patch: Patch::new(&parameters), belt: *rim, lagged: Lagged::default(), parameters }
    }

    /// What it does now; then the belt moves on by `dt` (11.1: semi-implicit Euler). The bristles come along from
    /// where they were `dt` before.
    pub(crate) fn step(&mut self, rim: &Motion, odd: &Oddness, dt: f64) -> Told {
        let p = &self.parameters;
        let (f, g) = (Frame::of(rim), Frame::of(&self.belt));
        let wall = Sidewall::new(p, (rim, &f), (&self.belt, &g));
        let foot = Footing::new(p, &self.belt, odd);
        let load = self.patch.roll(p, &self.belt, &foot, &self.lagged, odd, dt);

        // (4.27); its rates enter the next step, which 11.3 shows to be enough
        let lags = [p.patch_lag_x, p.patch_lag_y, p.patch_lag_twist];
        let now = [load.force[0], load.force[1], load.moment[2]];
        for k in 0..3 {
            self.lagged.rate[k] = (now[k] - self.lagged.value[k]) / lags[k];
            self.lagged.value[k] += dt * self.lagged.rate[k];
        }

        // (4.10), (4.11) with an inertia that is round about the axle
        let force = add(wall.belt.0, foot.out(load.force));
        let force = [force[0], force[1], force[2] - p.belt_mass * GRAVITY];
        let moment = add(wall.belt.1, foot.out(foot.moment(&load)));
        let axle = g.axes[1];
        let (radial, polar) = (p.belt_inertia_diametral, p.belt_inertia_polar);
        let inertia = |v: Vector| add(times(v, radial), times(axle, (polar - radial) * dot(axle, v)));
        let turn = minus(moment, cross(g.omega, inertia(g.omega)));
        let about = dot(axle, turn);
        let turning = add(times(turn, 1.0 / radial), times(axle, about / polar - about / radial));
        let bent = g.cardan(turning, self.belt.rates);
        for k in 0..3 {
            self.belt.velocity[k] += dt * force[k] / p.belt_mass;
            self.belt.rates[k] += dt * bent[k];
            self.belt.place[k] += dt * self.belt.velocity[k];
            self.belt.angles[k] += dt * self.belt.rates[k];
        }
        Told { force: wall.rim.0, moment: wall.rim.1, patch: load }
    }
}

#[cfg(test)]
mod tests;
