//! The rules of one wheel: slip and acceleration in, openings of its two valves out.

use crate::solver::Real;
use serde::{Deserialize, Serialize};

/// A wheel below this share of the reference speed may be locked.
const MAY_BE_LOCKED: f64 = 0.5;
/// A wheel that may be locked gets this many times `coast_time` to break away.
const LOCKED_PATIENCE: f64 = 5.0;

/// When to do what; see the table of the model for meanings.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct Thresholds {
    pub slip_dump: f64,
    pub slip_dump_always: f64,
    pub deceleration_dump: f64,
    pub slip_build: f64,
    pub acceleration_recovered: f64,
    pub recovery_time: f64,
    pub hold_time: f64,
    pub coast_time: f64,
    pub build_opening: f64,
    pub build_time: f64,
    pub acceleration_filter: f64,
}

/// What the controller does with a wheel.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
pub enum Phase {
    /// The driver's pressure goes to the brake.
    #[default]
    Off,
    /// Pressure is built slowly.
    Build,
    /// Pressure is held.
    Hold,
    /// Pressure is dumped.
    Dump,
}

/// Names and meanings of the phases, in order.
pub const PHASES: &[(&str, &str)] = &[
    ("off", "the driver's pressure goes to the brake: inlet open, outlet closed"),
    ("build", "pressure rises slowly after a recovery: inlet open by build_opening, outlet closed"),
    ("hold", "pressure is held while the wheel recovers: both valves closed"),
    ("dump", "pressure is let out: inlet closed, outlet open"),
];

/// What the speed of a wheel tells the reference.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Event {
    /// Too much slip.
    Slips,
    /// Back at the vehicle's speed.
    Recovered,
    /// Neither braked nor sped up by the road: at the vehicle's speed, whatever the reference says.
    Coasts,
}

/// One wheel.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct Wheel {
    /// Circumferential speed \[m/s\].
    pub speed: f64,
    /// Its filtered derivative \[m/s2\].
    pub acceleration: f64,
    /// Brake slip against the reference speed.
    pub slip: f64,
    /// What is being done.
    pub phase: Phase,
    /// Time in the present recovery or build \[s\].
    since: f64,
    /// Time for which pressure was dumped without an answer of the wheel \[s\].
    coasting: f64,
}

impl Wheel {
    /// A wheel that runs evenly.
    pub fn new(speed: f64) -> Self {
        Self { speed, ..Self::default() }
    }

    /// Takes over the speed after `dt`; a first-order filter takes oscillations out of the acceleration.
    pub fn measure(&mut self, speed: f64, filter: f64, dt: f64) {
        let decay = if filter > 0.0 { Real::exp(-dt / filter) } else { 0.0 };
        let slope = (speed - self.speed) / dt;
        self.acceleration = slope + (self.acceleration - slope) * decay;
        self.speed = speed;
    }

    /// Brake slip against a reference speed.
    pub fn slip_against(&mut self, reference: f64) {
        self.slip = if reference > 0.0 { 1.0 - self.speed / reference } else { 0.0 };
    }

    /// False for a state that no run leads to.
    pub fn is_finite(&self) -> bool {
        [self.speed, self.acceleration, self.slip, self.since, self.coasting].iter().all(|x| x.is_finite())
    }

    /// True while slip is being brought down.
    pub fn recovers(&self) -> bool {
        matches!(self.phase, Phase::Hold | Phase::Dump)
    }

    /// Leaves the brake to the driver.
    pub fn release(&mut self) {
        *self = Self { phase: Phase::Off, since: 0.0, coasting: 0.0, ..*self };
    }

    /// Decides for the next `dt`. `descent` is the fastest deceleration \[m/s2\] that the vehicle may have.
    pub fn decide(&mut self, reference: f64, descent: f64, t: &Thresholds, dt: f64) -> Option<Event> {
        self.since += dt;
        match self.phase {
            Phase::Off | Phase::Build => {
                let falls = self.acceleration < -t.deceleration_dump;
                if self.slip > t.slip_dump_always || (self.slip > t.slip_dump && falls) {
                    self.enter(Phase::Dump);
                    return Some(Event::Slips);
                }
                if self.phase == Phase::Build && self.since >= t.build_time {
                    self.enter(Phase::Off);
                }
                None
            }
            Phase::Hold | Phase::Dump => self.recover(reference, descent, t, dt),
        }
    }

    fn recover(&mut self, reference: f64, descent: f64, t: &Thresholds, dt: f64) -> Option<Event> {
        let slips = self.slip > t.slip_build;
        let settled = self.acceleration < t.acceleration_recovered;
        if !slips && settled && self.since >= t.hold_time {
            self.enter(Phase::Build);
            return Some(Event::Recovered);
        }
        let unanswered = self.phase == Phase::Dump && settled && self.acceleration > -descent;
        self.coasting = if unanswered { self.coasting + dt } else { 0.0 };
        let locked = self.speed < MAY_BE_LOCKED * reference;
        let patience = if locked { LOCKED_PATIENCE * t.coast_time } else { t.coast_time };
        if self.coasting >= patience {
            self.enter(Phase::Build);
            return Some(Event::Coasts);
        }
        // fast enough to have recovered after recovery_time
        let wanted = (self.slip - t.slip_build) * reference / t.recovery_time;
        self.phase = if slips && self.acceleration < wanted { Phase::Dump } else { Phase::Hold };
        None
    }

    fn enter(&mut self, phase: Phase) {
        *self = Self { phase, since: 0.0, coasting: 0.0, ..*self };
    }

    /// Opening of the inlet valve.
    pub fn inlet(&self, t: &Thresholds) -> f64 {
        match self.phase {
            Phase::Off => 1.0,
            Phase::Build => t.build_opening,
            Phase::Hold | Phase::Dump => 0.0,
        }
    }

    /// Opening of the outlet valve.
    pub fn outlet(&self) -> f64 {
        f64::from(u8::from(self.phase == Phase::Dump))
    }
}
