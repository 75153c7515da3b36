//! A session: runs of one tire in their order, with what is concealed, as ideal sensors behind the filter see it.

use super::concealed::{Concealed, Now, Place};
use super::frames::Motion;
use super::odd::Oddness;
use super::parameters::Parameters;
use super::programme::Run;
use super::rig::{self, Commands, SPEED, STEER};
use super::tire::Tire;
use crate::bessel::DELAY;
use crate::machines::conceal::{Memory, Place as At};
use crate::recorder::Recorder;
use crate::simulate::Ideal;

/// Step in recordings \[s\]. Twice as long a one changes the moment about the vertical by up to 0.9 of its noise in a sweep
/// to large slip angles, half as long a one by 0.06.
pub(crate) const FINE: f64 = 5e-5;
/// The same where effects are sized.
pub(crate) const COARSE: f64 = 2.5e-4;
/// Before the first sample of a run the wheel settles for so long \[s\]: thirteen times the slowest lag of the patch.
const SETTLE: f64 = 1.0;
/// The filter settles for so long \[s\]: ten times its delay.
const FILTER: f64 = 10.0 * DELAY;
/// Between two runs \[s\].
const PAUSE: f64 = 20.0;

/// Channels that have noise; the wheel angle is the one behind them.
pub(crate) const FORCES: usize = 6;
pub(crate) const CHANNELS: usize = FORCES + 1;

/// A tire with what is concealed.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct World {
    pub(crate) tire: Parameters,
    pub(crate) concealed: Vec<Concealed>,
}

impl World {
    /// All runs, in their order: what is warm stays warm.
    pub(crate) fn session(&self, runs: &[Run], dt: f64) -> Vec<Ideal> {
        let mut warmth = vec![0.0; self.concealed.len()];
        runs.iter()
            .map(|run| {
                let ideal = self.run(run, &mut warmth, dt);
                for (warmth, one) in warmth.iter_mut().zip(&self.concealed) {
                    *warmth *= one.cooling().map_or(0.0, |time| libm::exp(-PAUSE / time));
                }
                ideal
            })
            .collect()
    }

    fn run(&self, run: &Run, warmth: &mut [f64], dt: f64) -> Ideal {
        let start = |_: &Concealed| Memory::default();
        let (mut way_in, mut way_out): (Vec<Memory>, Vec<Memory>) =
            (self.concealed.iter().map(start).collect(), self.concealed.iter().map(start).collect());
        let mut before = run.commands(0.0);
        let mut rim = rig::follow(&self.tire, &Motion::default(), &before, &before, dt);
        let mut tire = Tire::new(self.tire.clone(), &rim);
        let mut now = Now {
            time: -SETTLE,
            duration: run.duration,
            commands: before,
            descent: 0.0,
            // so that it is where the encoder is at the first sample
            angle: run.angle - SETTLE * rim.rates[1],
            spin: rim.rates[1],
            track: run.track - SETTLE * before[SPEED],
            rolling: 0.0,
            sliding: 0.0,
        };
        let mut recorder = Recorder::new(&run.stamps, 6, CHANNELS);
        let steps = ((run.duration + SETTLE + 2.0 * DELAY) / dt).ceil();
        let mut n = 0.0;
        while n < steps {
            now.time = n * dt - SETTLE;
            let pure = run.commands(now.time);
            let mut u = pure;
            self.enter(&mut way_in, &mut u, dt);
            if n > 0.0 {
                let spin = rim.rates[1];
                rim = rig::follow(&self.tire, &rim, &u, &before, dt);
                now.angle += 0.5 * dt * (spin + rim.rates[1]);
                now.track += 0.5 * dt * (before[SPEED] + u[SPEED]);
            }
            (now.commands, now.spin, now.descent) = (u, rim.rates[1], -rim.velocity[2]);
            before = u;
            let mut odd = Oddness::default();
            for (one, warmth) in self.concealed.iter().zip(warmth.iter()) {
                one.change(&mut odd, &now, *warmth);
            }
            let told = tire.step(&rim, &odd, dt);
            now.sliding = told.patch.heat;
            now.rolling = (told.patch.force[2] * self.tire.rolling_resistance_lever * now.spin).abs();
            if now.time >= 0.0 {
                self.warm(warmth, &now, dt);
            }
            let (force, moment) =
                (rig::horizontal(told.force, u[STEER]), rig::horizontal(told.moment, u[STEER]));
            let mut y = [force[0], force[1], force[2], moment[0], moment[1], moment[2], now.angle];
            self.leave(&mut way_out, &mut y, &now, dt);
            // before, it has nothing to settle from
            if now.time >= -FILTER {
                recorder.follow(now.time, &pure, &y, dt);
            }
            n += 1.0;
        }
        recorder.ideal
    }

    fn warm(&self, warmth: &mut [f64], now: &Now, dt: f64) {
        for (warmth, one) in warmth.iter_mut().zip(&self.concealed) {
            if let Some(time) = one.cooling() {
                *warmth += dt / time * (one.heated(now) - *warmth);
            }
        }
    }

    fn enter(&self, memories: &mut [Memory], u: &mut Commands, dt: f64) {
        for (one, memory) in self.concealed.iter().zip(memories) {
            if let Place::Chain(chain) = &one.place
                && let At::Input(k) = chain.place
            {
                chain.enter(memory, &mut u[k], dt);
            }
        }
    }

    fn leave(&self, memories: &mut [Memory], y: &mut [f64], now: &Now, dt: f64) {
        for one in &self.concealed {
            one.shake(y, now);
        }
        let all = y.to_vec();
        for (one, memory) in self.concealed.iter().zip(memories) {
            if let Place::Chain(chain) = &one.place
                && let At::Output(k) = chain.place
            {
                chain.leave(memory, &all, &mut y[k], now.time.max(0.0), dt);
            }
        }
    }
}
