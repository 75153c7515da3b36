//! What can be concealed in a machine: equations of its own, written from their sources and not from the catalogue.
//!
//! Three places: inside the equations of motion ([`Hidden::influence`]; forces, friction, brake), on the
//! way of an input into the machine ([`Hidden::enter`]), and on the way of an output to its sensor
//! ([`Hidden::leave`]). `size` scales all of them; at 0 nothing changes.

use crate::base::{Base, Ports};
use crate::follow::Follower;
use crate::random::Random;
use std::collections::VecDeque;
use std::f64::consts::TAU;

/// What hidden effects add to the equations of motion.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Influence {
    /// Force beside the spring, against its deflection \[N\].
    pub force: f64,
    /// Force from outside on the mass or body \[N\].
    pub push: f64,
    /// Factor on that mass.
    pub mass: f64,
    /// Factor on the tire's friction.
    pub friction: f64,
    /// Factor on the tire's cornering stiffness.
    pub cornering: f64,
    /// Added to the slip angle at which the tire acts \[rad\].
    pub slip_angle: f64,
    /// Factor on the torque of the brake.
    pub brake: f64,
    /// Torque on the wheel's axle against its rotation \[N m\].
    pub axle_torque: f64,
    /// Whether the tire can lift off.
    pub lifts: bool,
}

impl Default for Influence {
    fn default() -> Self {
        Self {
            force: 0.0,
            push: 0.0,
            mass: 1.0,
            friction: 1.0,
            cornering: 1.0,
            slip_angle: 0.0,
            brake: 1.0,
            axle_torque: 0.0,
            lifts: false,
        }
    }
}

/// The equations.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[allow(missing_docs)] // each is said where its equation is
pub enum Law {
    // forces in a spring
    Cubic,
    QuadraticDamper,
    Asymmetry,
    BumpStop,
    Hysteresis,
    Coulomb,
    Stribeck,
    Play,
    Maxwell,
    Payne,
    // in the contact
    SpeedFriction,
    Thermal,
    WarmUp,
    LoadSensitivity,
    SideSlip,
    LoadFriction,
    Lift,
    // in the brake
    DiscThickness,
    Fade,
    Onset,
    // on the way in
    InputLag,
    HoldOff,
    RateLimit,
    Relaxation,
    Carcass,
    // on the way out
    Delay,
    Lag,
    Bias,
    Drift,
    Gain,
    CrossTalk,
    Resonance,
    LoadOffset,
    Camber,
    Rolling,
    WheelOrder,
    BeltOrder,
    ToneRing,
    RollingRadius,
    Imbalance,
    // in no catalogue
    TimeStiffness,
    Snap,
    Crack,
    Absorber,
    WalkFriction,
    Chaos,
    Unrecorded,
    MassLoss,
    Product,
    Sampled,
    TanhCross,
    Cogging,
    TimeFriction,
    PatchFriction,
    SpeedLoad,
    CamberSlip,
    SquaredAngle,
    SlipSpeed,
    TimeBrake,
    SpeedBrake,
    WalkBrake,
    // another draw of the road
    RoadScatter,
}

/// One concealed effect.
#[derive(Debug, Clone, PartialEq)]
pub struct Hidden {
    /// Its id: of the catalogue, or one that begins with `outside-`.
    pub id: &'static str,
    /// Its equation.
    pub law: Law,
    /// How large, over its nominal size; negative where the sign is free.
    pub size: f64,
    /// Where: position among the inputs (on the way in) or outputs (on the way out).
    pub channel: usize,
    /// Where cross-talk comes from.
    pub other: usize,
    /// Shares from 0 to 1 that vary the form: thresholds, frequencies, phases.
    pub form: [f64; 3],
    /// Where its own randomness comes from.
    pub seed: u64,
}

/// What an effect remembers besides the states that are integrated.
#[derive(Debug, Clone, Default)]
pub struct Memory {
    value: f64,
    rate: f64,
    started: bool,
    follower: Follower,
    past: VecDeque<(f64, f64)>,
    waves: Vec<[f64; 3]>,
}

/// Deflection \[m\], rate \[m/s\] and force \[N\] that are usual in the spring of a machine.
fn scales(base: Base) -> [f64; 3] {
    match base {
        Base::QuarterCar => [0.025, 0.4, 700.0],
        _ => [0.02, 0.3, 80.0],
    }
}

/// How fast valves let the pressure change \[Pa/s\], for size 1.
const RATE_LIMIT: f64 = 1.2e7;

fn low(share: f64, from: f64, to: f64) -> f64 {
    from + (to - from) * share
}

fn waves(memory: &Memory, time: f64) -> f64 {
    memory.waves.iter().map(|[a, w, phase]| a * libm::sin(w * time + phase)).sum()
}

impl Hidden {
    /// How many states of it are integrated with the machine.
    #[must_use]
    pub fn states(&self) -> usize {
        match self.law {
            Law::Hysteresis
            | Law::Maxwell
            | Law::Payne
            | Law::Thermal
            | Law::WarmUp
            | Law::Fade
            | Law::Onset => 1,
            Law::Absorber => 2,
            Law::Chaos => 3,
            _ => 0,
        }
    }

    /// Its states and memory at the start of run number `run`.
    #[must_use]
    pub fn start(&self, base: Base, ports: &Ports, run: u64) -> (Vec<f64>, Memory) {
        let mut random = Random::new(self.seed, run);
        let band = match self.law {
            Law::WalkFriction | Law::PatchFriction | Law::WalkBrake => Some((0.1, 1.2)),
            Law::Unrecorded => Some((0.4, 4.0)),
            Law::RoadScatter => Some((0.3, 8.0)),
            _ => None,
        };
        let mut memory = Memory::default();
        if let Some((from, to)) = band {
            let wave = |r: &mut Random| [(2.0_f64 / 14.0).sqrt(), TAU * r.within(from, to), TAU * r.share()];
            memory.waves = (0..14).map(|_| wave(&mut random)).collect();
        }
        let states = match self.law {
            Law::Absorber => vec![ports.deflection, ports.rate],
            Law::Chaos => {
                vec![random.within(-8.0, 8.0), random.within(-8.0, 8.0), random.within(15.0, 30.0)]
            }
            Law::Payne => vec![ports.deflection.abs() / scales(base)[0]],
            _ => vec![0.0; self.states()],
        };
        (states, memory)
    }

    /// Rates of its states.
    pub fn slope(&self, base: Base, at: &Ports, z: &[f64], dz: &mut [f64]) {
        let [s0, _, f0] = scales(base);
        let [a, b, _] = self.form;
        match self.law {
            // Dahl: z' = (v - |v| z) / x_0
            Law::Hysteresis => dz[0] = (at.rate - at.rate.abs() * z[0]) / (s0 * low(a, 0.08, 0.25)),
            // f' = k s' - f / tau
            Law::Maxwell => {
                dz[0] = f0 / s0 * at.rate - z[0] / low(a, 0.03, 0.12);
            }
            // mean amplitude
            Law::Payne => dz[0] = (at.deflection.abs() / s0 * 1.57 - z[0]) / 0.4,
            Law::Thermal => dz[0] = at.slide_power / low(a, 1.2e4, 2.5e4) - z[0] / 12.0,
            Law::WarmUp => dz[0] = (at.speed * at.load / 8e4 - z[0]) / low(a, 3.0, 8.0),
            Law::Fade => dz[0] = at.brake_power / low(a, 1e5, 2e5),
            // time in contact, forgotten within a millisecond after it
            Law::Onset => dz[0] = if at.pressure > 5e4 { 1.0 } else { -z[0] / 2e-3 },
            // a small mass on a spring of its own
            Law::Absorber => {
                let omega = TAU * low(a, 3.5, 8.0);
                dz[0] = z[1];
                dz[1] = omega * omega * (at.deflection - z[0])
                    - 2.0 * low(b, 0.03, 0.1) * omega * (z[1] - at.rate);
            }
            // Lorenz, six times slower than usual
            Law::Chaos => {
                let pace = low(a, 0.8, 2.0);
                dz[0] = pace * 10.0 * (z[1] - z[0]);
                dz[1] = pace * (z[0] * (28.0 - z[2]) - z[1]);
                dz[2] = pace * (z[0] * z[1] - 8.0 / 3.0 * z[2]);
            }
            _ => {}
        }
    }

    /// Adds what it does inside the machine.
    pub fn influence(&self, base: Base, at: &Ports, z: &[f64], memory: &Memory, by: &mut Influence) {
        let [s0, v0, f0] = scales(base);
        let [a, b, _] = self.form;
        let (e, r, k) = (at.deflection / s0, at.rate / v0, self.size);
        let force = k * f0;
        let dry = libm::tanh(r / 0.04);
        match self.law {
            Law::Cubic => by.force += force * e * e * e,
            Law::QuadraticDamper => by.force += force * r * r.abs(),
            Law::Asymmetry => by.force += force * r.abs(),
            Law::BumpStop => {
                let side = if b < 0.5 { 1.0 } else { -1.0 };
                let beyond = (e * side - low(a, 0.6, 1.0)).max(0.0);
                by.force += force * side * 3.0 * beyond * (1.0 + beyond);
            }
            Law::Hysteresis => by.force += force * z[0],
            Law::Coulomb => by.force += force * dry,
            Law::Stribeck => {
                let v = r / low(a, 0.12, 0.3);
                by.force += force * (0.4 + 0.6 * libm::exp(-v * v)) * dry;
            }
            // the spring has a gap of +-b in it
            Law::Play => {
                let gap = k * 0.15 * s0;
                by.force -= at.stiffness * at.deflection.clamp(-gap, gap);
            }
            Law::Maxwell => by.force += k * z[0],
            Law::Payne => by.force += force * e / (1.0 + 1.5 * z[0]),
            Law::SpeedFriction => {
                by.friction *= 1.0 - k * 0.3 * (1.0 - libm::exp(-at.sliding / low(a, 0.6, 2.5)));
            }
            Law::Thermal => by.friction *= (1.0 - k * 0.3 * z[0]).max(0.2),
            Law::WarmUp => by.cornering *= 1.0 + k * 0.15 * z[0],
            Law::LoadSensitivity => by.friction *= (1.0 - k * 0.15 * (at.load - 4000.0) / 4000.0).max(0.2),
            // plies steer as a wheel whose heading is off: backwards the other way
            Law::SideSlip => by.slip_angle += k * 0.01 * at.speed.signum(),
            Law::LoadFriction => by.axle_torque += k * 0.02 * at.load * 0.32 * libm::tanh(at.spin / 3.0),
            Law::Lift => by.lifts = true,
            Law::DiscThickness => {
                let order = if a < 0.7 { 1.0 } else { 2.0 };
                by.brake *= 1.0 + k * 0.12 * libm::cos(order * at.angle + TAU * b);
            }
            Law::Fade => by.brake *= (1.0 - k * 0.3 * z[0]).max(0.2),
            // smooth rise over 0.22 s from a quarter (for size 1)
            Law::Onset => {
                let x = (z[0] / low(a, 0.18, 0.28)).clamp(0.0, 1.0);
                by.brake *= 1.0 - k * 0.75 * (1.0 - x * x * (3.0 - 2.0 * x));
            }
            Law::TimeStiffness => by.force += force * e * libm::sin(TAU * (low(a, 0.25, 0.9) * at.time + b)),
            Law::Snap => by.force -= force * 2.0 * e * libm::exp(-2.0 * e * e),
            Law::Crack => {
                by.force -= if at.time > low(a, 1.5, 3.0) { force * e } else { 0.0 };
            }
            Law::Absorber => {
                let omega = TAU * low(a, 3.5, 8.0);
                let stiffness = k * 0.06 * f0 / (s0 * 400.0) * omega * omega;
                by.force += stiffness * (at.deflection - z[0]);
            }
            Law::WalkFriction => by.force += force * waves(memory, at.time) * dry,
            Law::Chaos => by.push += force * z[0] / 12.0,
            Law::Unrecorded => by.push += force * waves(memory, at.time),
            Law::MassLoss => by.mass *= 1.0 - (k * 0.05 * at.time).clamp(-0.8, 0.8),
            Law::Product => by.force += force * e * e * r,
            Law::Sampled => by.force += force * memory.value,
            Law::TanhCross => by.force += force * libm::tanh(1.5 * e) * libm::tanh(2.0 * r),
            Law::Cogging => by.force += force * libm::sin(low(a, 4.0, 8.0) * e + TAU * b),
            Law::TimeFriction => {
                by.friction *= 1.0 + k * 0.12 * libm::sin(TAU * (low(a, 0.25, 0.8) * at.time + b));
            }
            Law::PatchFriction | Law::RoadScatter => {
                by.friction *= (1.0 + k * 0.08 * waves(memory, at.time)).max(0.3);
            }
            Law::TimeBrake => {
                by.brake *= 1.0 + k * 0.12 * libm::sin(TAU * (low(a, 0.6, 1.8) * at.time + b));
            }
            // stick-slip bands: friction of the pads wanders with the speed of the vehicle
            Law::SpeedBrake => {
                by.brake *= 1.0 + k * 0.12 * libm::sin(at.speed / low(a, 0.8, 1.6) + TAU * b);
            }
            Law::WalkBrake => by.brake *= (1.0 + k * 0.1 * waves(memory, at.time)).max(0.2),
            _ => {}
        }
    }

    /// Changes the inputs `u` on their way into the machine, `dt` after they were here last.
    pub fn enter(&self, memory: &mut Memory, at: &Ports, u: &mut [f64], dt: f64) {
        let k = self.size;
        let [a, ..] = self.form;
        match self.law {
            Law::Sampled => {
                // a controller of its own feels the rate now and then
                let period = low(a, 0.04, 0.09);
                if !memory.started || at.time - memory.rate >= period {
                    memory.value = (at.rate / 0.35).clamp(-3.0, 3.0);
                    memory.rate = if memory.started { memory.rate + period } else { at.time };
                    memory.started = true;
                }
            }
            Law::InputLag => u[self.channel] = memory.follower.follow(u[self.channel], dt / (k * 0.03)),
            Law::HoldOff => u[self.channel] = (u[self.channel] - k * dead_band(u)).max(0.0),
            Law::RateLimit => {
                let limit = RATE_LIMIT / k * dt;
                let to = u[self.channel];
                memory.value =
                    if memory.started { memory.value + (to - memory.value).clamp(-limit, limit) } else { to };
                memory.started = true;
                u[self.channel] = memory.value;
            }
            // sigma alpha'' + V alpha' = V alpha
            Law::Relaxation => {
                u[self.channel] = memory.follower.follow(u[self.channel], at.speed * dt / (k * 0.4))
            }
            // C(alpha') alpha'' = k V (alpha - alpha'): the carcass gives way to the tire's own side force
            Law::Carcass => {
                let tangent = libm::tan(memory.value) * 15.0;
                let softer = 1.0 / (1.0 + tangent * tangent);
                let length = k * 0.4 * (at.load / 4000.0).max(0.05) * softer.max(0.05);
                u[self.channel] = memory.follower.follow(u[self.channel], at.speed * dt / length);
            }
            _ => {}
        }
    }

    /// Changes the channels `y` on their way to the sensors. `sizes` are the channels' usual ones.
    #[allow(clippy::too_many_lines)] // one line per effect
    pub fn leave(&self, memory: &mut Memory, at: &Ports, sizes: &[f64], y: &mut [f64], dt: f64) {
        let k = self.size;
        let [a, b, _] = self.form;
        let (c, own) = (self.channel, sizes[self.channel]);
        match self.law {
            Law::Delay => {
                memory.past.push_back((at.time, y[c]));
                let wanted = at.time - k * 5e-3;
                while memory.past.len() > 2 && memory.past[1].0 <= wanted {
                    memory.past.pop_front();
                }
                let (t0, y0) = memory.past[0];
                y[c] = match memory.past.get(1) {
                    Some((t1, y1)) if wanted > t0 => y0 + (y1 - y0) * ((wanted - t0) / (t1 - t0)).min(1.0),
                    _ => y0,
                };
            }
            Law::Lag => y[c] = memory.follower.follow(y[c], dt / (k * 6e-3)),
            Law::Bias => y[c] += k * 0.2 * own,
            Law::Drift => y[c] += k * 0.3 * own * at.time / 6.0,
            Law::Gain => y[c] *= 1.0 + k * 0.15,
            Law::CrossTalk => y[c] += k * 0.15 * own / sizes[self.other] * y[self.other],
            // a mass on a spring between the machine and the sensor: semi-implicit steps
            Law::Resonance => {
                if !memory.started {
                    (memory.value, memory.rate, memory.started) = (y[c], 0.0, true);
                }
                let omega = TAU * low(a, 16.0, 28.0);
                memory.rate += dt
                    * (omega * omega * (y[c] - memory.value)
                        - 2.0 * low(b, 0.06, 0.15) * omega * memory.rate);
                memory.value += dt * memory.rate;
                y[c] += k * (memory.value - y[c]);
            }
            Law::LoadOffset => y[c] += k * 0.03 * at.load,
            // to the side of the lean: a positive camber leans to the right (ISO 8855)
            Law::Camber => y[c] -= k * 1.2 * at.load * at.camber,
            Law::Rolling => y[c] -= k * 0.02 * at.load * (1.0 + low(a, 0.0, 0.5) * at.speed / 20.0),
            Law::WheelOrder => {
                let order = if a < 0.6 { 1.0 } else { 2.0 };
                y[c] += k * 0.05 * at.load * own / 1500.0 * libm::cos(order * at.angle + TAU * b);
            }
            Law::BeltOrder => {
                let length = low(a, 2.6, 6.0);
                y[c] += k * 0.12 * own * libm::cos(TAU * (at.distance / length + b));
            }
            Law::ToneRing => {
                let order = 1.0 + (a * 2.99).floor();
                y[c] *= 1.0 + k * 0.02 * libm::cos(order * at.angle + TAU * b);
            }
            Law::RollingRadius => y[c] *= 1.0 + k * 0.02 * (at.load - 4000.0) / 4000.0,
            Law::Imbalance => {
                y[c] +=
                    k * 0.05 * own * (at.speed / 20.0) * (at.speed / 20.0) * libm::sin(at.angle + TAU * b);
            }
            Law::SpeedLoad => {
                y[c] += k * 0.15 * own * (at.speed * at.speed / 400.0) * (at.load - 4000.0) / 1500.0;
            }
            Law::CamberSlip => {
                y[c] += k * 0.3 * own * libm::tanh(at.camber / 0.04) * libm::tanh(at.slip_angle / 0.03)
            }
            Law::SquaredAngle => y[c] += k * 0.15 * own * libm::sin(at.slip_angle / 0.035),
            Law::SlipSpeed => {
                y[c] += k * 0.15 * own * libm::tanh(30.0 * at.slip) * libm::tanh((at.speed - 15.0) / 4.0)
            }
            _ => {}
        }
    }
}

/// Pressure \[Pa\] that a brake needs before it acts; at a wheel, whose input is a torque, in N m.
fn dead_band(u: &[f64]) -> f64 {
    if u.len() == 5 { 60.0 } else { 2.5e5 }
}
