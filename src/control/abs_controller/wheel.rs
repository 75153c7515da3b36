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
    pub speed_tolerance: f64,
    pub acceleration_recovered: f64,
    pub acceleration_strong: f64,
    pub lead_time: f64,
    pub rebuild: f64,
    pub dump: f64,
    pub answer_time: f64,
    pub turned: f64,
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
    /// Time for which the outlet was open and which the acceleration does not show yet \[s\].
    unseen: f64,
    /// Time in the present recovery or build \[s\].
    since: f64,
    /// Greatest acceleration in the present recovery \[m/s2\].
    strongest: f64,
    /// Time for which the inlet is still to be fully open \[s\].
    rebuild: f64,
    /// Opening of the inlet valve until the next sample.
    pub inlet: f64,
    /// False from the begin of a slip until the wheel is seen back at the vehicle's speed.
    settled: bool,
    /// Time for which pressure was dumped without an answer of the wheel \[s\].
    coasting: f64,
}

impl Wheel {
    /// A wheel that runs evenly.
    pub fn new(speed: f64) -> Self {
        Self { speed, inlet: 1.0, settled: true, ..Self::default() }
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
        [
            self.speed,
            self.acceleration,
            self.unseen,
            self.slip,
            self.since,
            self.strongest,
            self.rebuild,
            self.inlet,
            self.coasting,
        ]
        .iter()
        .all(|x| x.is_finite())
    }

    /// True while slip is being brought down.
    pub fn recovers(&self) -> bool {
        matches!(self.phase, Phase::Hold | Phase::Dump)
    }

    /// Leaves the brake to the driver.
    pub fn release(&mut self) {
        self.enter(Phase::Off);
        self.inlet = 1.0;
        self.settled = true;
    }

    /// Decides for the next `dt`. `descent` is the fastest deceleration \[m/s2\] that the vehicle may have.
    pub fn decide(&mut self, reference: f64, descent: f64, t: &Thresholds, dt: f64) -> Option<Event> {
        self.since += dt;
        let event = match self.phase {
            Phase::Off | Phase::Build => self.watch(reference, t),
            Phase::Hold | Phase::Dump => self.recover(reference, descent, t, dt),
        };
        self.inlet = match self.phase {
            Phase::Off => 1.0,
            Phase::Build => (self.rebuild / dt).clamp(t.build_opening, 1.0),
            Phase::Hold | Phase::Dump => 0.0,
        };
        self.rebuild = (self.rebuild - dt).max(0.0);
        self.unseen = (self.unseen + dt * self.outlet()) * Real::exp(-dt / t.answer_time);
        event
    }

    fn watch(&mut self, reference: f64, t: &Thresholds) -> Option<Event> {
        let falls = self.acceleration < -t.deceleration_dump;
        let slip = self.slip - t.speed_tolerance / reference;
        if slip > t.slip_dump_always || (slip > t.slip_dump && falls) {
            self.enter(Phase::Dump);
            self.settled = false;
            return Some(Event::Slips);
        }
        if self.phase == Phase::Build && self.since >= t.build_time {
            self.enter(Phase::Off);
        }
        let back = !self.settled && self.acceleration < t.acceleration_recovered;
        self.settled |= back;
        back.then_some(Event::Recovered)
    }

    fn recover(&mut self, reference: f64, descent: f64, t: &Thresholds, dt: f64) -> Option<Event> {
        self.strongest = self.strongest.max(self.acceleration);
        let settled = self.acceleration < t.acceleration_recovered;
        let slip = self.slip - t.speed_tolerance / reference;
        let expected = slip - t.lead_time * self.acceleration / reference;
        let strong = self.acceleration > t.acceleration_strong && expected < t.slip_build;
        let turned = settled || self.acceleration < t.turned * self.strongest;
        if strong || (slip < t.slip_build && turned && self.since >= t.hold_time) {
            self.rebuild = t.rebuild * self.strongest;
            self.enter(Phase::Build);
            return None;
        }
        let unanswered = self.phase == Phase::Dump && settled && self.acceleration > -descent;
        self.coasting = if unanswered { self.coasting + dt } else { 0.0 };
        let locked = self.speed < MAY_BE_LOCKED * reference;
        let patience = if locked { LOCKED_PATIENCE * t.coast_time } else { t.coast_time };
        if self.coasting >= patience {
            self.enter(Phase::Build);
            self.settled = true;
            return Some(Event::Coasts);
        }
        // fast enough to have recovered after recovery_time
        let wanted = (slip - t.slip_build) * reference / t.recovery_time;
        let slow = self.acceleration + self.unseen / t.dump < wanted;
        self.phase = if slip > t.slip_build && slow { Phase::Dump } else { Phase::Hold };
        None
    }

    fn enter(&mut self, phase: Phase) {
        *self = Self { phase, since: 0.0, coasting: 0.0, strongest: 0.0, ..*self };
    }

    /// Opening of the outlet valve.
    pub fn outlet(&self) -> f64 {
        f64::from(u8::from(self.phase == Phase::Dump))
    }
}
