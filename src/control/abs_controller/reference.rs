//! The controller's own estimate of the vehicle's speed.
//!
//! The fastest wheel is the best witness, and under the brakes every wheel may slip. So the estimate
//! follows the fastest wheel up, and down no faster than a limit that adapts to the surface: the
//! speeds to which wheels recover, cycle by cycle, tell how fast the vehicle really slows down.

use serde::{Deserialize, Serialize};

/// Speeds of recovery closer in time than this tell nothing about the deceleration \[s\].
const SHORTEST_BASE: f64 = 0.1;

/// What limits the estimate; see the table of the model for meanings.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct Limits {
    pub ascent: f64,
    pub descent_max: f64,
    pub descent_min: f64,
    pub descent_growth: f64,
    pub descent_margin: f64,
    pub descent_per_pressure: f64,
}

/// The estimate.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct Reference {
    /// Estimated speed \[m/s\].
    pub speed: f64,
    /// The fastest descent now \[m/s2\].
    pub descent: f64,
    anchor: Option<Anchor>,
}

/// A speed that a wheel had when it did not slip.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
struct Anchor {
    speed: f64,
    age: f64,
}

/// What the wheels are doing.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Wheels {
    /// The brake is not applied: nothing is known about the surface.
    Free,
    /// At least one is braked and has not been caught slipping.
    Trusted,
    /// All recover from too much slip.
    Recovering,
}

impl Reference {
    /// An estimate to begin with.
    pub fn new(fastest: f64) -> Self {
        Self { speed: fastest, descent: 0.0, anchor: None }
    }

    /// Takes over the speed of the fastest wheel after `dt`.
    pub fn update(&mut self, fastest: f64, wheels: Wheels, driver_pressure: f64, limits: &Limits, dt: f64) {
        let cap = limits.descent_cap(driver_pressure);
        self.descent = match wheels {
            Wheels::Free => limits.descent_max,
            // a surface may have become better than the last one, but pressure builds only so fast
            Wheels::Trusted if self.anchor.is_some() => (self.descent + limits.descent_growth * dt).min(cap),
            Wheels::Trusted => cap,
            Wheels::Recovering => self.descent.min(cap),
        };
        if wheels == Wheels::Free {
            self.anchor = None;
        }
        if let Some(anchor) = &mut self.anchor {
            anchor.age += dt;
        }
        let (least, most) = (self.speed - self.descent * dt, self.speed + limits.ascent * dt);
        self.speed = fastest.max(least).min(most).max(0.0);
    }

    /// False for a state that no run leads to.
    pub fn is_finite(&self) -> bool {
        let anchor = self.anchor.is_none_or(|anchor| anchor.speed.is_finite() && anchor.age.is_finite());
        anchor && self.speed.is_finite() && self.descent.is_finite()
    }

    /// A wheel was caught slipping: so far the estimate is good.
    pub fn slip_begins(&mut self) {
        if self.anchor.is_none() {
            self.anchor = Some(Anchor { speed: self.speed, age: 0.0 });
        }
    }

    /// A wheel has recovered and runs at the vehicle's speed: measures the surface since the last time.
    pub fn wheel_recovered(&mut self, limits: &Limits) {
        let measured = self.anchor.filter(|anchor| anchor.age >= SHORTEST_BASE);
        if let Some(anchor) = measured {
            let deceleration = (anchor.speed - self.speed) / anchor.age;
            self.descent =
                (limits.descent_margin * deceleration).clamp(limits.descent_min, limits.descent_max);
            self.anchor = Some(Anchor { speed: self.speed, age: 0.0 });
        }
    }

    /// The fastest wheel neither slows down nor speeds up without brake: it is the estimate that is wrong.
    pub fn correct(&mut self, fastest: f64, limits: &Limits) {
        self.speed = fastest;
        self.descent = limits.descent_max;
        self.anchor = Some(Anchor { speed: fastest, age: 0.0 });
    }
}

impl Limits {
    /// The fastest descent that the driver's pressure can be the cause of.
    pub fn descent_cap(&self, driver_pressure: f64) -> f64 {
        (self.descent_min + self.descent_per_pressure * driver_pressure.max(0.0)).min(self.descent_max)
    }
}
