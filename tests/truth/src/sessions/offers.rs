//! What can be concealed in a session, and with which shapes.

use super::concealed::{Concealed, Law, Place};
use super::rig::{SLIP, SLIP_ANGLE};
use super::session::{CHANNELS, FORCES};
use crate::machines::conceal::{self, Law as Chain, Natural, Place as At};
use crate::random::Random;
use std::f64::consts::TAU;

/// What is offered.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Offer {
    Imbalance,
    NonUniformity,
    Conicity,
    PlySteer,
    WarmUp,
    Softening,
    SpeedFriction,
    SlipAngleLag,
    SlipLag,
    Delay,
    Lag,
    Drift,
    CrossTalk,
    Gain,
    Resonance,
    Nap,
    TrackPart,
    SlipAngleTime,
    CamberSpeed,
    AngleDescent,
}

/// Of the catalogue.
pub(crate) const NAMED: [Offer; 15] = [
    Offer::Imbalance,
    Offer::NonUniformity,
    Offer::Conicity,
    Offer::PlySteer,
    Offer::WarmUp,
    Offer::Softening,
    Offer::SpeedFriction,
    Offer::SlipAngleLag,
    Offer::SlipLag,
    Offer::Delay,
    Offer::Lag,
    Offer::Drift,
    Offer::CrossTalk,
    Offer::Gain,
    Offer::Resonance,
];

/// Of no catalogue.
pub(crate) const OUTSIDE: [Offer; 5] =
    [Offer::Nap, Offer::TrackPart, Offer::SlipAngleTime, Offer::CamberSpeed, Offer::AngleDescent];

/// Copies of the first channel in the second that no other physics makes: a moment about an axis is nearly a copy of the
/// force across it as it is, so that such a pair would be a gain.
const COPIES: [(usize, usize); 8] = [(0, 1), (1, 0), (0, 2), (2, 1), (2, 0), (1, 5), (2, 4), (1, 4)];

/// Natural time of channels and commands \[s\]: a delay of size 1 is a fifth of it, two samples; a lag of a command a
/// third.
const TIME: f64 = 0.05;
/// The same of the frame, whose mode is at 1.5 to 4 over it: 30 to 45 Hz are shares of 0.42 to 0.83 of that.
const FRAME: (f64, f64, f64) = (0.012, 0.42, 0.83);

impl Offer {
    pub(crate) fn id(self) -> &'static str {
        match self {
            Self::Imbalance => "imbalance",
            Self::NonUniformity => "non-uniformity",
            Self::Conicity => "conicity",
            Self::PlySteer => "plysteer",
            Self::WarmUp => "inflation-warm-up",
            Self::Softening => "thermal-softening",
            Self::SpeedFriction => "speed-dependent-friction",
            Self::SlipAngleLag | Self::SlipLag => "actuator-lag",
            Self::Delay => "sensor-delay",
            Self::Lag => "sensor-lag",
            Self::Drift => "sensor-drift",
            Self::CrossTalk => "cross-talk",
            Self::Gain => "sensor-gain",
            Self::Resonance => "frame-resonance",
            Self::Nap => "outside-sliding-direction",
            Self::TrackPart => "outside-track-part",
            Self::SlipAngleTime => "outside-slip-angle-time",
            Self::CamberSpeed => "outside-camber-speed",
            Self::AngleDescent => "outside-slip-angle-descent",
        }
    }

    /// The effect at size 1; `spreads` are those of the channels, `duration` is that of a run.
    pub(crate) fn draw(self, random: &mut Random, spreads: &[f64; CHANNELS], duration: f64) -> Concealed {
        let r = random;
        let phase = |r: &mut Random| r.within(0.0, TAU);
        let law = match self {
            Self::Imbalance => Law::Imbalance(phase(r)),
            Self::NonUniformity => Law::NonUniformity(phase(r), phase(r), r.within(0.3, 0.7)),
            Self::Conicity => Law::Conicity,
            Self::PlySteer => Law::PlySteer,
            Self::WarmUp => Law::WarmUp(r.log_within(30.0, 90.0)),
            Self::Softening => Law::Softening(r.log_within(30.0, 90.0)),
            Self::SpeedFriction => Law::SpeedFriction(r.log_within(0.4, 1.2)),
            Self::Nap => Law::Nap,
            // a loop of steel with a piece of abrasive that is another
            Self::TrackPart => {
                let length = r.within(5.0, 8.0);
                Law::TrackPart(length, r.within(0.5, 3.0), r.within(0.6, 1.5))
            }
            Self::SlipAngleTime => Law::SlipAngleTime,
            Self::CamberSpeed => Law::CamberSpeed,
            Self::AngleDescent => Law::AngleDescent,
            _ => return Concealed { place: Place::Chain(self.chain(r, spreads, duration)), size: 1.0 },
        };
        Concealed { place: Place::Tire(law), size: 1.0 }
    }

    /// What happens to a command or a channel.
    fn chain(self, r: &mut Random, spreads: &[f64; CHANNELS], duration: f64) -> conceal::Concealed {
        let channel = r.below(FORCES);
        let force = r.below(3);
        let (law, place, other) = match self {
            Self::SlipAngleLag => (Chain::InputLag, At::Input(SLIP_ANGLE), 0),
            Self::SlipLag => (Chain::InputLag, At::Input(SLIP), 0),
            Self::Delay => (Chain::Delay, At::Output(channel), 0),
            Self::Lag => (Chain::Lag, At::Output(channel), 0),
            Self::Drift => (Chain::Drift, At::Output(channel), 0),
            Self::Gain => (Chain::Gain, At::Output(channel), 0),
            Self::CrossTalk => {
                let (from, to) = r.pick(&COPIES);
                (Chain::CrossTalk, At::Output(to), from)
            }
            _ => (Chain::Resonance, At::Output(force), 0),
        };
        let own = match place {
            At::Output(k) => spreads[k],
            _ => 1.0,
        };
        let (time, form) = match law {
            // a frame of steel: lightly damped, by 6 to 9 %
            Chain::Resonance => (FRAME.0, [r.within(FRAME.1, FRAME.2), r.within(0.0, 0.35)]),
            _ => (TIME, [r.share(), r.share()]),
        };
        conceal::Concealed {
            id: self.id(),
            law,
            place,
            natural: Natural { way: own, ..Natural::default() },
            other: (other, spreads[other]),
            time,
            duration,
            size: 1.0,
            form,
            seed: r.bits(),
        }
    }
}

impl Offer {
    /// Whether it goes both ways. Times, the loss of a friction and the share of a mode do not, and tires get stiffer
    /// while they warm up.
    pub(crate) fn may_be_negative(self) -> bool {
        use Offer::{
            AngleDescent, CamberSpeed, Conicity, CrossTalk, Drift, Gain, Nap, PlySteer, SlipAngleTime,
            TrackPart,
        };
        matches!(
            self,
            Conicity
                | PlySteer
                | Drift
                | CrossTalk
                | Gain
                | Nap
                | TrackPart
                | SlipAngleTime
                | CamberSpeed
                | AngleDescent
        )
    }
}
