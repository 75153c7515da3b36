//! What is concealed in a machine, by its physics: forces on a body, flows, what happens to an input on its way in and to
//! an output on its way to the recorder. Sizes are those of the machine itself: what its own forces, ways and speeds are
//! like in the programme, with shapes drawn around them. `size` scales each; at zero nothing changes.

use crate::follow::Follower;
use crate::random::Random;
use std::collections::VecDeque;
use std::f64::consts::TAU;

/// Where it is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Place {
    /// A force on a body, from the ground.
    Body(usize),
    /// A flow out of a store.
    Store(usize),
    /// An input.
    Input(usize),
    /// An output.
    Output(usize),
    /// A parameter.
    Parameter(usize),
}

/// The law. What each is stands where its equation is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[allow(missing_docs)]
pub enum Law {
    Coulomb,
    Stribeck,
    Cubic,
    SquareSpring,
    QuadraticDamper,
    DamperAsymmetry,
    Stop,
    Hysteresis,
    Maxwell,
    Clearance,
    Product,
    Cogging,
    Unrecorded,
    LeakSquared,
    LeakAbove,
    InputLag,
    InputRate,
    InputDeadBand,
    InputPlay,
    Delay,
    Lag,
    Bias,
    Drift,
    Gain,
    Curved,
    CrossTalk,
    Resonance,
    Saturation,
    ByTime,
    Crack,
    Wander,
}

/// What is natural at a place: (way, speed, force) of a body, (level, -, flow) of a store, (spread, -, -) of a signal.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Natural {
    /// Way, level, spread of a signal: a root mean square.
    pub way: f64,
    /// Speed.
    pub speed: f64,
    /// Force or flow.
    pub force: f64,
}

/// One concealed effect.
#[derive(Debug, Clone, PartialEq)]
pub struct Concealed {
    /// What it is called in answers.
    pub id: &'static str,
    /// Its equation.
    pub law: Law,
    /// Where.
    pub place: Place,
    /// What is natural there.
    pub natural: Natural,
    /// Another channel and how large it is, for cross-talk.
    pub other: (usize, f64),
    /// Natural time of the machine \[s\].
    pub time: f64,
    /// How long a run is \[s\].
    pub duration: f64,
    /// 1 is as large as what is natural.
    pub size: f64,
    /// Shares between 0 and 1 that make the shape.
    pub form: [f64; 2],
    /// Of what is random in it.
    pub seed: u64,
}

/// What an effect remembers.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Memory {
    started: bool,
    value: f64,
    rate: f64,
    follower: Follower,
    past: VecDeque<(f64, f64)>,
    waves: Vec<[f64; 3]>,
}

fn between(share: f64, low: f64, high: f64) -> f64 {
    low * libm::pow(high / low, share)
}

impl Concealed {
    /// What there is at the start of a run.
    #[must_use]
    pub fn start(&self, run: u64) -> Memory {
        let mut random = Random::new(self.seed, run);
        let wave = |random: &mut Random| {
            [
                random.normal() * 0.35,
                random.log_within(0.05, 0.6) * TAU / (4.0 * self.time),
                TAU * random.share(),
            ]
        };
        let waves = (0..8).map(|_| wave(&mut random)).collect();
        Memory { waves, ..Memory::default() }
    }

    /// How large an offset of this size is.
    #[must_use]
    pub fn offset(&self, size: f64) -> f64 {
        0.5 * size * self.natural.way
    }

    /// Its parameters by the names and equations of latsch's catalogue, in SI units: of those laws that are the same there.
    #[must_use]
    pub fn amounts(&self) -> Vec<(&'static str, f64)> {
        let Natural { way, speed, force } = self.natural;
        let [a, b] = self.form;
        let (size, k) = (self.size, self.size * force);
        let side = if a < 0.5 { 1.0 } else { -1.0 };
        match self.law {
            Law::Coulomb => vec![("force", k), ("velocity", speed * between(a, 0.02, 0.08))],
            Law::Cubic => vec![("cubic", k / (way * way * way))],
            Law::SquareSpring => vec![("quadratic", side * k / (way * way))],
            Law::QuadraticDamper => vec![("quadratic", k / (speed * speed))],
            Law::DamperAsymmetry => vec![("difference", side * k / speed)],
            Law::Stop => {
                let stop = if b < 0.5 { "upper" } else { "lower" };
                vec![(stop, 6.0 * k / way), ("gap", way * between(a, 0.8, 1.8))]
            }
            Law::Maxwell => vec![("stiffness", k / way), ("time", self.time * between(a, 0.4, 2.0))],
            Law::Clearance => vec![("stiffness", k / way), ("gap", way * between(a, 0.2, 0.8))],
            Law::InputLag => vec![("time", size * 0.3 * self.time)],
            Law::InputDeadBand => vec![("band", size * 0.3 * way)],
            Law::InputPlay => vec![("gap", size * 0.2 * way)],
            Law::Delay => vec![("delay", size.abs() * 0.2 * self.time)],
            Law::Lag => vec![("time", size.abs() * 0.2 * self.time)],
            Law::Bias => vec![("offset", self.offset(size))],
            Law::Drift => vec![("rate", size * 0.5 * way / self.duration)],
            Law::Gain => vec![("error", size * 0.2)],
            Law::Curved => vec![("odd", size * 0.1 / way), ("even", 0.0)],
            Law::CrossTalk => vec![("share", size * 0.2 * way / self.other.1)],
            Law::Saturation => vec![("limit", way * 1.8 / size.abs().max(0.3))],
            _ => Vec::new(),
        }
    }

    /// Number of states: of hysteresis and of a Maxwell element.
    #[must_use]
    pub fn states(&self) -> usize {
        usize::from(matches!(self.law, Law::Hysteresis | Law::Maxwell))
    }

    /// Force on the body, or flow into the store, that is at `x` and moves with `v`.
    #[must_use]
    pub fn effort(&self, x: f64, v: f64, time: f64, z: f64, memory: &Memory) -> f64 {
        let Natural { way, speed, force } = self.natural;
        let [a, b] = self.form;
        let k = self.size * force;
        match self.law {
            Law::Coulomb => -k * libm::tanh(v / (speed * between(a, 0.02, 0.08))),
            Law::Stribeck => {
                let fall = speed * between(a, 0.15, 0.6);
                -k * (0.5 + (0.5 + b) * libm::exp(-(v / fall) * (v / fall))) * libm::tanh(10.0 * v / fall)
            }
            Law::Cubic => -k * (x / way) * (x / way) * (x / way),
            Law::SquareSpring => -k * (x / way) * (x / way) * if a < 0.5 { 1.0 } else { -1.0 },
            Law::QuadraticDamper => -k * (v / speed) * (v / speed).abs(),
            Law::DamperAsymmetry => -k * (v / speed).abs() * if a < 0.5 { 1.0 } else { -1.0 },
            Law::Stop => {
                let gap = way * between(a, 0.8, 1.8);
                let side = if b < 0.5 { 1.0 } else { -1.0 };
                -side * 6.0 * k * (side * x / way - gap / way).max(0.0)
            }
            Law::Hysteresis => -k * z,
            Law::Maxwell => -k * (x - z) / way,
            Law::Clearance => {
                let gap = way * between(a, 0.2, 0.8);
                k * x.clamp(-gap, gap) / way
            }
            Law::Product => -k * libm::tanh(x / way) * libm::tanh(v / speed),
            Law::Cogging => -k * libm::sin(TAU * x / (way * between(a, 0.7, 1.6)) + TAU * b),
            Law::Unrecorded => {
                k * memory.waves.iter().map(|[h, w, p]| h * libm::sin(w * time + p)).sum::<f64>()
            }
            Law::LeakSquared => -k * (x / way) * (x / way).abs(),
            Law::LeakAbove => -3.0 * k * (x / way - between(a, 0.95, 1.1)).max(0.0),
            _ => 0.0,
        }
    }

    /// Rate of its state.
    #[must_use]
    pub fn slope(&self, x: f64, v: f64, z: f64) -> f64 {
        let a = self.form[0];
        match self.law {
            Law::Hysteresis => {
                let length = self.natural.way * between(a, 0.1, 0.5);
                (v - 0.5 * v.abs() * z - 0.5 * v * z.abs()) / length
            }
            Law::Maxwell => (x - z) / (self.time * between(a, 0.4, 2.0)),
            _ => 0.0,
        }
    }

    /// A parameter at this time of a run.
    #[must_use]
    pub fn parameter(&self, value: f64, time: f64, memory: &Memory) -> f64 {
        let part = time / self.duration;
        let k = self.size;
        value
            * match self.law {
                Law::ByTime => 1.0 + k * 0.3 * (part - 0.5),
                Law::Crack => {
                    let at = 0.25 + 0.5 * self.form[0];
                    1.0 - (k * 0.2).min(0.9) * (0.5 + 0.5 * libm::tanh((part - at) * 60.0))
                }
                Law::Wander => {
                    let w: f64 = memory.waves.iter().map(|[h, w, p]| h * libm::sin(0.3 * w * time + p)).sum();
                    libm::exp((k * 0.3 * w).clamp(-1.5, 1.5))
                }
                _ => 1.0,
            }
    }

    /// What becomes of the input on its way in.
    pub fn enter(&self, memory: &mut Memory, u: &mut f64, dt: f64) {
        let [a, _] = self.form;
        let k = self.size;
        let spread = self.natural.way;
        if !memory.started {
            (memory.value, memory.started) = (*u, true);
        }
        match self.law {
            Law::InputLag => {
                *u = memory.follower.follow(*u, dt / (k * 0.3 * self.time));
            }
            Law::InputRate => {
                let most = spread / (k * between(a, 0.7, 1.4) * self.time) * dt;
                memory.value += (*u - memory.value).clamp(-most, most);
                *u = memory.value;
            }
            Law::InputDeadBand => {
                let band = k * 0.3 * spread;
                *u = u.signum() * (u.abs() - band).max(0.0);
            }
            Law::InputPlay => {
                let gap = k * 0.2 * spread;
                memory.value = memory.value.clamp(*u - gap, *u + gap);
                *u = memory.value;
            }
            _ => {}
        }
    }

    /// What becomes of an output on its way to the recorder.
    pub fn leave(&self, memory: &mut Memory, all: &[f64], y: &mut f64, time: f64, dt: f64) {
        let [a, b] = self.form;
        let k = self.size;
        let own = self.natural.way;
        match self.law {
            Law::Delay => {
                let wanted = time - k.abs() * 0.2 * self.time;
                memory.past.push_back((time, *y));
                while memory.past.len() > 2 && memory.past[1].0 <= wanted {
                    memory.past.pop_front();
                }
                let (t0, y0) = memory.past[0];
                *y = match memory.past.get(1) {
                    Some((t1, y1)) if wanted > t0 => y0 + (y1 - y0) * ((wanted - t0) / (t1 - t0)).min(1.0),
                    _ => y0,
                };
            }
            Law::Lag => {
                *y = memory.follower.follow(*y, dt / (k.abs() * 0.2 * self.time));
            }
            Law::Bias => *y += self.offset(k),
            Law::Drift => *y += k * 0.5 * own * time / self.duration,
            Law::Gain => *y *= 1.0 + k * 0.2,
            Law::Curved => *y += k * 0.1 * *y * y.abs() / own,
            Law::CrossTalk => *y += k * 0.2 * own / self.other.1 * all[self.other.0],
            Law::Saturation => {
                let limit = own * 1.8 / k.abs().max(0.3);
                *y = y.clamp(-limit, limit);
            }
            Law::Resonance => {
                if !memory.started {
                    (memory.value, memory.rate, memory.started) = (*y, 0.0, true);
                }
                let omega = between(a, 1.5, 4.0) / self.time;
                memory.rate += dt
                    * (omega * omega * (*y - memory.value)
                        - 2.0 * between(b, 0.06, 0.2) * omega * memory.rate);
                memory.value += dt * memory.rate;
                *y += k * 0.5 * (memory.value - *y);
            }
            _ => {}
        }
    }
}
