//! A controller that keeps wheels from locking: it knows the speeds of the wheels and the driver's pressure, and samples them.
//!
//! Written from what the model says of itself to a user; thresholds are its placeholders.

/// Time between two decisions \[s\].
pub(crate) const SAMPLE: f64 = 5e-3;

const SLIP_DUMP: f64 = 0.13;
const SLIP_DUMP_ALWAYS: f64 = 0.22;
const DECELERATION_DUMP: f64 = 8.0;
const SLIP_BUILD: f64 = 0.07;
const TOLERANCE: f64 = 0.5;
const RECOVERED: f64 = 2.0;
const STRONG: f64 = 50.0;
const LEAD_TIME: f64 = 0.015;
const REBUILD: f64 = 1.2e-4;
const DUMP_PER_ACCELERATION: f64 = 2.3e-4;
const ANSWER_TIME: f64 = 0.02;
const TURNED: f64 = 0.8;
const RECOVERY_TIME: f64 = 0.15;
const HOLD_TIME: f64 = 0.02;
const COAST_TIME: f64 = 0.06;
const BUILD_OPENING: f64 = 0.25;
const BUILD_TIME: f64 = 1.0;
const FILTER: f64 = 0.015;
const ASCENT: f64 = 30.0;
const DESCENT: (f64, f64) = (2.0, 13.0);
const GROWTH: f64 = 25.0;
const MARGIN: f64 = 1.2;
const PER_PRESSURE: f64 = 3.3e-6;
const ACTIVATION: f64 = 2e5;
const SWITCH_OFF: f64 = 2.5;
/// A wheel below this share of the reference may be locked, and gets so many times as long to answer.
const LOCKED: (f64, f64) = (0.5, 5.0);
/// A recovery that comes as soon after another tells nothing of the vehicle \[s\].
const SOON: f64 = 0.1 - 1e-9;

/// What is done with a wheel.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Phase {
    Off,
    Build,
    Hold,
    Dump,
}

#[derive(Debug, Clone, Copy, PartialEq)]
struct Wheel {
    speed: f64,
    acceleration: f64,
    phase: Phase,
    /// Time in the phase \[s\].
    since: f64,
    /// Outlet time that the acceleration does not show yet \[s\].
    unseen: f64,
    /// Dumping without an answer \[s\].
    unanswered: f64,
    /// For so long the inlet is still fully open \[s\].
    open: f64,
    greatest: f64,
    /// Runs at the vehicle's speed.
    back: bool,
    /// Inlet and outlet.
    valves: (f64, f64),
}

/// The controller of four wheels, of which those behind have one pressure.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Controller {
    radii: [f64; 4],
    pub(crate) reference: f64,
    pub(crate) descent: f64,
    /// Speed of the last recovery, or at first of the first slip, and its age.
    recovery: Option<(f64, f64)>,
    wheels: [Wheel; 4],
}

impl Controller {
    /// With its idea of the tires' radii, on wheels that roll \[rad/s\].
    pub(crate) fn new(radii: [f64; 4], spins: [f64; 4]) -> Self {
        let speeds: [f64; 4] = std::array::from_fn(|i| radii[i] * spins[i]);
        let wheels = speeds.map(|speed| Wheel {
            speed,
            acceleration: 0.0,
            phase: Phase::Off,
            since: 0.0,
            unseen: 0.0,
            unanswered: 0.0,
            open: 0.0,
            greatest: 0.0,
            back: true,
            valves: (1.0, 0.0),
        });
        let reference = speeds.into_iter().fold(f64::NEG_INFINITY, f64::max);
        Self { radii, reference, descent: DESCENT.1, recovery: None, wheels }
    }

    /// Openings of inlet and outlet of every wheel.
    pub(crate) fn valves(&self) -> [(f64, f64); 4] {
        let mut all = self.wheels.map(|w| w.valves);
        let (left, right) = (all[2], all[3]);
        let low = (left.0.min(right.0), left.1.max(right.1));
        (all[2], all[3]) = (low, low);
        all
    }

    /// What is done with the wheels.
    #[cfg(test)]
    pub(crate) fn phases(&self) -> [Phase; 4] {
        self.wheels.map(|w| w.phase)
    }

    /// Decides anew.
    pub(crate) fn sample(&mut self, spins: [f64; 4], driver: f64) {
        let kept = libm::exp(-SAMPLE / FILTER);
        for (i, wheel) in self.wheels.iter_mut().enumerate() {
            let speed = spins[i] * self.radii[i];
            let quotient = (speed - wheel.speed) / SAMPLE;
            wheel.acceleration = wheel.acceleration * kept + quotient * (1.0 - kept);
            wheel.speed = speed;
        }
        let limit = DESCENT.1.min(DESCENT.0 + PER_PRESSURE * driver.max(0.0));
        self.descent = match self.recovery {
            _ if driver < ACTIVATION => DESCENT.1,
            Some(_) => self.descent.min(limit),
            None => limit,
        };
        let fastest = self.wheels.iter().map(|w| w.speed).fold(f64::NEG_INFINITY, f64::max);
        self.reference =
            fastest.max(self.reference - self.descent * SAMPLE).min(self.reference + ASCENT * SAMPLE);
        if let Some((_, age)) = &mut self.recovery {
            *age += SAMPLE;
        }
        if driver < ACTIVATION || self.reference < SWITCH_OFF {
            for wheel in &mut self.wheels {
                wheel.enter(Phase::Off);
                (wheel.back, wheel.open, wheel.unseen, wheel.unanswered) = (true, 0.0, 0.0, 0.0);
                wheel.valves = (1.0, 0.0);
            }
        } else {
            for i in 0..4 {
                let is_fastest = self.wheels[i].speed >= fastest;
                match self.wheels[i].decide(self.reference) {
                    Event::Slipped if self.recovery.is_none() => {
                        self.recovery = Some((self.reference, 0.0));
                    }
                    Event::Recovered => self.recovered(),
                    Event::Coasts if is_fastest => self.reference = fastest,
                    Event::Slipped | Event::Coasts | Event::None => {}
                }
            }
        }
        let trusted = self.wheels.iter().any(|w| matches!(w.phase, Phase::Off | Phase::Build));
        if driver < ACTIVATION {
            self.recovery = None;
        } else if trusted {
            self.descent += GROWTH * SAMPLE;
        }
    }

    /// The vehicle's deceleration since the last time that a wheel had recovered limits the descent.
    fn recovered(&mut self) {
        if let Some((speed, age)) = self.recovery
            && age > SOON
        {
            let deceleration = (speed - self.reference) / age;
            self.descent = (MARGIN * deceleration).clamp(DESCENT.0, DESCENT.1);
            self.recovery = Some((self.reference, 0.0));
        }
    }
}

/// What a wheel's turn of phase tells.
enum Event {
    None,
    Slipped,
    Recovered,
    Coasts,
}

impl Wheel {
    fn enter(&mut self, phase: Phase) {
        (self.phase, self.since) = (phase, 0.0);
    }

    fn decide(&mut self, reference: f64) -> Event {
        self.since += SAMPLE;
        if self.valves.1 > 0.0 {
            self.unseen += SAMPLE;
        }
        self.unseen *= libm::exp(-SAMPLE / ANSWER_TIME);
        let slip = 1.0 - self.speed / reference - TOLERANCE / reference;
        let event = match self.phase {
            Phase::Off | Phase::Build => self.watch(slip),
            Phase::Dump | Phase::Hold => self.recover(slip, reference),
        };
        self.valves = match self.phase {
            Phase::Off => (1.0, 0.0),
            Phase::Build => {
                let share = (self.open / SAMPLE).min(1.0);
                self.open = (self.open - SAMPLE).max(0.0);
                (share.max(BUILD_OPENING), 0.0)
            }
            Phase::Hold => (0.0, 0.0),
            Phase::Dump => (0.0, 1.0),
        };
        event
    }

    fn watch(&mut self, slip: f64) -> Event {
        let falls = slip > SLIP_DUMP && self.acceleration < -DECELERATION_DUMP;
        if falls || slip > SLIP_DUMP_ALWAYS {
            self.enter(Phase::Dump);
            (self.back, self.greatest, self.unanswered, self.open) = (false, 0.0, 0.0, 0.0);
            return Event::Slipped;
        }
        if self.phase == Phase::Build && self.since >= BUILD_TIME {
            self.enter(Phase::Off);
        }
        if !self.back && self.acceleration < RECOVERED {
            self.back = true;
            return Event::Recovered;
        }
        Event::None
    }

    fn recover(&mut self, slip: f64, reference: f64) -> Event {
        self.greatest = self.greatest.max(self.acceleration);
        let answers = self.acceleration > RECOVERED;
        if answers {
            self.unanswered = 0.0;
        } else if self.phase == Phase::Dump {
            self.unanswered += SAMPLE;
        }
        let turned = self.acceleration < TURNED * self.greatest || self.acceleration < RECOVERED;
        let recovered = slip < SLIP_BUILD && self.since >= HOLD_TIME && turned;
        let strong =
            self.acceleration > STRONG && (slip - SLIP_BUILD) * reference < self.acceleration * LEAD_TIME;
        let patience = if self.speed < LOCKED.0 * reference { LOCKED.1 } else { 1.0 };
        let coasts = self.unanswered >= patience * COAST_TIME;
        if recovered || strong || coasts {
            self.enter(Phase::Build);
            self.open = REBUILD * self.greatest;
            return if coasts && !recovered && !strong { Event::Coasts } else { Event::None };
        }
        let wanted = (slip - SLIP_BUILD) * reference / RECOVERY_TIME;
        let will = self.acceleration + self.unseen / DUMP_PER_ACCELERATION >= wanted;
        match (self.phase, will) {
            (Phase::Dump, true) => self.phase = Phase::Hold,
            (Phase::Hold, false) => self.phase = Phase::Dump,
            _ => {}
        }
        Event::None
    }
}
