//! What is concealed on the rigs, by its physics.

use super::parameters::Rig;
use super::rubber::Rubber;
use super::tire::ELEMENTS;
use crate::random::Random;
use std::f64::consts::TAU;

/// What is offered.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Offer {
    Relaxation,
    Friction,
    Payne,
    Play,
    CellLag,
    PivotFriction,
    NonUniformity,
    /// Of no catalogue.
    SpeedDamping,
}

/// All of them.
pub(crate) const OFFERS: [Offer; 8] = [
    Offer::Relaxation,
    Offer::Friction,
    Offer::Payne,
    Offer::Play,
    Offer::CellLag,
    Offer::PivotFriction,
    Offer::NonUniformity,
    Offer::SpeedDamping,
];

impl Offer {
    pub(crate) fn id(self) -> &'static str {
        match self {
            Self::Relaxation => "viscoelastic-stiffening",
            Self::Friction => "bushing-hysteresis",
            Self::Payne => "payne",
            Self::Play => "play",
            Self::CellLag => "sensor-lag",
            Self::PivotFriction => "coulomb-friction",
            Self::NonUniformity => "non-uniformity",
            Self::SpeedDamping => "outside-speed-damping",
        }
    }

    /// Names that are right beside those that are everywhere: the loop of dry friction in rubber is that of `payne` where a
    /// force is recorded; under one load a friction in proportion to it is any.
    pub(crate) fn also(self) -> &'static [&'static str] {
        match self {
            Self::Friction => &["payne"],
            Self::PivotFriction => &["load-dependent-friction", "bushing-hysteresis", "bouc-wen"],
            _ => &[],
        }
    }

    /// Where it is recorded. The cylinder may control either where its rubber is asked; play shows where the wheel is lifted,
    /// a cell where its force is not the command.
    pub(crate) fn rig(self, random: &mut Random) -> Rig {
        match self {
            Self::Relaxation | Self::Friction | Self::Payne => random.pick(&[Rig::Force, Rig::Position]),
            Self::Play | Self::CellLag => Rig::Position,
            Self::PivotFriction | Self::NonUniformity | Self::SpeedDamping => Rig::Drum,
        }
    }

    /// The effect at size 1.
    pub(crate) fn draw(self, r: &mut Random) -> Law {
        match self {
            Self::Relaxation => Law::Relaxation(r.log_within(0.02, 0.15)),
            Self::Friction => Law::Friction(r.log_within(3e-4, 1e-3)),
            Self::Payne => Law::Payne(r.log_within(1e-3, 4e-3), r.within(1.0, 3.0)),
            Self::Play => Law::Play,
            Self::CellLag => Law::CellLag(0.0),
            Self::PivotFriction => Law::PivotFriction,
            Self::NonUniformity => {
                let mut phase = || r.within(0.0, TAU);
                Law::NonUniformity(phase(), phase(), phase())
            }
            Self::SpeedDamping => Law::SpeedDamping(r.within(1.5, 2.5)),
        }
    }

    /// Variables on which it depends, by the names of the columns and of the model.
    pub(crate) fn depends_on(self) -> &'static [&'static str] {
        match self {
            Self::Relaxation | Self::Friction | Self::Payne | Self::Play => {
                &["piston_position", "piston_velocity", "position", "force", "cell_force", "force_z", "time"]
            }
            Self::CellLag => &["time"],
            Self::PivotFriction => &["wheel_velocity", "arm_displacement", "wheel_lowered"],
            Self::NonUniformity => &["wheel_angle"],
            Self::SpeedDamping => &["drum_speed", "actual_drum_speed", "wheel_speed"],
        }
    }
}

/// The law of an effect. Numbers are shapes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Law {
    /// Rubber relaxes in this time \[s\]; size 1 is a fifth of an element's stiffness.
    Relaxation(f64),
    /// Dry friction in the rubber, which has slipped after this way \[m\]; size 1 is 60 N per element.
    Friction(f64),
    /// Filler, half broken at this amplitude \[m\], built up in so many seconds; size 1 is 30 % of an element's stiffness.
    Payne(f64, f64),
    /// Play between cylinder and wheel; size 1 is 0.4 mm.
    Play,
    /// The amplifier of the load cell is a first-order filter; size 1 is 2 ms, beyond this time \[s\], which less damping of
    /// the rubber would make up for.
    CellLag(f64),
    /// Dry friction in the arm's pivot; size 1 is 100 N at the wheel.
    PivotFriction,
    /// Elements of uneven stiffness, once and twice around, and a tread that is not centred, with their phases; size 1 is 2 %,
    /// half of that twice around, and 0.1 mm.
    NonUniformity(f64, f64, f64),
    /// The rubber's damping falls with the speed, from that of the model at this one \[m/s\] on as a power of it; size 1 is an
    /// exponent of a half.
    SpeedDamping(f64),
}

/// A concealed effect.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Concealed {
    pub(crate) law: Law,
    pub(crate) size: f64,
}

/// Below this speed \[m/s\] the damping does not grow any more: a standing tire has one.
const SLOW: f64 = 0.4;

impl Concealed {
    /// What the rubber of an element of this stiffness does.
    pub(crate) fn rubber(&self, stiffness: f64) -> Option<Rubber> {
        match self.law {
            Law::Relaxation(time) => Some(Rubber::Relaxing(0.2 * self.size * stiffness, time)),
            Law::Friction(way) => Some(Rubber::Friction(60.0 * self.size, way)),
            Law::Payne(half, time) => Some(Rubber::Filler(0.3 * self.size * stiffness, half, time)),
            _ => None,
        }
    }

    /// Stiffness over the mean and run-out of each element.
    pub(crate) fn uneven(&self) -> Option<Vec<(f64, f64)>> {
        let Law::NonUniformity(one, two, out) = self.law else { return None };
        let of = |n: usize| {
            let a = TAU * n as f64 / ELEMENTS as f64;
            let soft = libm::cos(a + one) + 0.5 * libm::cos(2.0 * a + two);
            (1.0 + (0.02 * self.size * soft).clamp(-0.6, 0.6), 1e-4 * self.size * libm::cos(a + out))
        };
        Some((0..ELEMENTS).map(of).collect())
    }

    /// Half of the play \[m\].
    pub(crate) fn gap(&self) -> Option<f64> {
        (self.law == Law::Play).then_some(2e-4 * self.size)
    }

    /// Time constant of the load cell \[s\].
    pub(crate) fn cell(&self) -> Option<f64> {
        let Law::CellLag(beyond) = self.law else { return None };
        Some(beyond + 2e-3 * self.size)
    }

    /// Friction of the pivot, at the wheel \[N\].
    pub(crate) fn pivot(&self) -> Option<f64> {
        (self.law == Law::PivotFriction).then_some(100.0 * self.size)
    }

    /// Factor on the damping at a speed.
    pub(crate) fn damping(&self, speed: f64) -> f64 {
        match self.law {
            Law::SpeedDamping(from) => libm::pow(from / speed.abs().max(SLOW), 0.5 * self.size),
            _ => 1.0,
        }
    }
}
