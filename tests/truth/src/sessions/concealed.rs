//! What is concealed in a session, by its physics: in the tire, on the track, in the wheel; what happens to a command or
//! to a channel is that of the [machines](crate::machines::conceal).

use super::odd::Oddness;
use super::rig::{CAMBER, Commands, SLIP_ANGLE, SPEED};
use crate::machines::conceal;
use std::f64::consts::TAU;

/// The law of an effect in the tire or around it. Numbers are shapes; sizes belong to [`Concealed`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Law {
    /// A mass on the rim, at this angle of the encoder: m r ω² in `force_x` and `force_z`; size 1 is 0.02 kg m.
    Imbalance(f64),
    /// Vertical stiffness over the wheel angle, orders 1 and 2 with their phases and the share of the second; size 1 is
    /// 1 %.
    NonUniformity(f64, f64, f64),
    /// The tread is a cone; size 1 is 10 mrad.
    Conicity,
    /// The tread runs askew; size 1 is 3 mrad.
    PlySteer,
    /// Pressure rises with warmth, of this time constant \[s\]: size 1 is 10 % of vertical stiffness where rolling turns
    /// 1.5 kW into heat for long.
    WarmUp(f64),
    /// Friction falls with the heat of sliding, of this time constant \[s\]: size 1 takes e where 2 kW slide for long.
    Softening(f64),
    /// Sliding friction falls with sliding speed, by two thirds at this one \[m/s\]; size 1 is 20 % at most.
    SpeedFriction(f64),
    /// Sliding friction depends on the sense of sliding along the track; size 1 is 5 % each way.
    Nap,
    /// Friction of a part of a track of this length \[m\], from here on and this long; size 1 is 10 %.
    TrackPart(f64, f64, f64),
    /// Friction grows with time at positive slip angles and falls at negative ones; size 1 is 10 % at 0.1 rad and the
    /// end.
    SlipAngleTime,
    /// Vertical stiffness changes with camber times speed; size 1 is 5 % at 0.05 rad and 10 m/s.
    CamberSpeed,
    /// Vertical stiffness changes with slip angle times the speed at which the wheel is let down; size 1 is 5 % at
    /// 0.1 rad and 10 mm/s.
    AngleDescent,
}

/// Where an effect is.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Place {
    Tire(Law),
    /// On the way of a command or a channel.
    Chain(conceal::Concealed),
}

/// A concealed effect.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Concealed {
    pub(crate) place: Place,
    pub(crate) size: f64,
}

/// Where a session is, for effects.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Now {
    pub(crate) time: f64,
    pub(crate) duration: f64,
    pub(crate) commands: Commands,
    /// Rate of the deflection \[m/s\].
    pub(crate) descent: f64,
    /// Encoder \[rad\], rate of it \[rad/s\], place of the track \[m\].
    pub(crate) angle: f64,
    pub(crate) spin: f64,
    pub(crate) track: f64,
    /// What rolling and sliding turned into heat in the last step \[W\].
    pub(crate) rolling: f64,
    pub(crate) sliding: f64,
}

impl Concealed {
    /// A law of a channel or command has its size in itself.
    pub(crate) fn sized(&self, size: f64) -> Self {
        let mut other = Self { size, ..self.clone() };
        if let Place::Chain(chain) = &mut other.place {
            chain.size = size;
        }
        other
    }

    /// Time constant of its warmth \[s\]; none where nothing is warm.
    pub(crate) fn cooling(&self) -> Option<f64> {
        match self.place {
            Place::Tire(Law::WarmUp(time) | Law::Softening(time)) => Some(time),
            _ => None,
        }
    }

    /// Power that warms it, over that of size 1.
    pub(crate) fn heated(&self, now: &Now) -> f64 {
        match self.place {
            Place::Tire(Law::WarmUp(_)) => (now.rolling + now.sliding) / 1500.0,
            Place::Tire(Law::Softening(_)) => now.sliding / 2000.0,
            _ => 0.0,
        }
    }

    /// What it makes of the tire, at this warmth.
    pub(crate) fn change(&self, odd: &mut Oddness, now: &Now, warmth: f64) {
        let Place::Tire(law) = self.place else { return };
        let (k, u) = (self.size, &now.commands);
        // less than this no rubber keeps, and a stiffness stays one
        let least = |factor: f64| factor.clamp(0.3, 3.0);
        match law {
            Law::Imbalance(_) => {}
            Law::NonUniformity(one, two, share) => {
                let waves = libm::cos(now.angle + one) + share * libm::cos(2.0 * now.angle + two);
                odd.stiffness *= least(1.0 + 0.01 * k * waves);
            }
            Law::Conicity => odd.cone += 0.01 * k,
            Law::PlySteer => odd.ply += 3e-3 * k,
            Law::WarmUp(_) => odd.stiffness *= least(1.0 + 0.1 * k * warmth),
            Law::Softening(_) => odd.friction *= least(libm::exp(-k * warmth)),
            Law::SpeedFriction(speed) => odd.fall = ((0.2 * k).min(0.8), speed),
            Law::Nap => odd.nap += (0.05 * k).clamp(-0.6, 0.6),
            Law::TrackPart(length, from, long) => {
                let at = now.track / length;
                let inside = (at - at.floor()) * length - from;
                // within 0.1 m from one to the other, as sheets of abrasive meet
                let edge = |x: f64| 0.5 + 0.5 * libm::tanh(x / 0.05);
                odd.friction *= least(1.0 - 0.1 * k * edge(inside) * edge(long - inside));
            }
            Law::SlipAngleTime => {
                odd.friction *= least(1.0 + k * u[SLIP_ANGLE] * now.time.max(0.0) / now.duration);
            }
            Law::CamberSpeed => odd.stiffness *= least(1.0 + 0.1 * k * u[CAMBER] * u[SPEED]),
            Law::AngleDescent => odd.stiffness *= least(1.0 + 50.0 * k * u[SLIP_ANGLE] * now.descent),
        }
    }

    /// What it adds to the load cell.
    pub(crate) fn shake(&self, y: &mut [f64], now: &Now) {
        if let Place::Tire(Law::Imbalance(phase)) = self.place {
            let force = 0.02 * self.size * now.spin * now.spin;
            let (s, c) = libm::sincos((now.angle + phase) % TAU);
            y[0] += force * c;
            y[2] -= force * s;
        }
    }

    /// Variables on which it depends, by the names of the columns; `channels` are those of the measured ones.
    pub(crate) fn depends_on(&self, channels: &[&'static str]) -> Vec<&'static str> {
        let law = match &self.place {
            Place::Tire(law) => law,
            Place::Chain(chain) if chain.law == conceal::Law::CrossTalk => {
                return vec![channels[chain.other.0]];
            }
            Place::Chain(_) => return vec!["time"],
        };
        let all: &[&str] = match law {
            Law::Imbalance(_) => &["wheel_angle", "path_speed"],
            Law::NonUniformity(..) => &["wheel_angle", "deflection", "force_z"],
            Law::Conicity | Law::PlySteer => &["force_z", "load", "path_speed", "travel_speed"],
            Law::WarmUp(_) => &["time", "path_speed", "travel_speed", "contact_power_loss"],
            Law::Softening(_) => &["time", "contact_power_loss", "slip", "slip_angle"],
            Law::SpeedFriction(_) => &["path_speed", "travel_speed", "slip", "slip_angle"],
            // the sense of sliding is that of the slip, or of its force
            Law::Nap => &["slip", "force_x"],
            Law::TrackPart(..) => &["path_speed", "travel_distance", "path_distance", "time"],
            Law::SlipAngleTime => &["slip_angle", "time"],
            Law::CamberSpeed => &["camber", "path_speed"],
            Law::AngleDescent => &["slip_angle", "deflection"],
        };
        all.to_vec()
    }
}
