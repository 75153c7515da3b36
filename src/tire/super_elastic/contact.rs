//! The law of contact between a point of an element and the road (4-59, 4-60): a stiffness with an exponent, and a damper that
//! comes in over the first tenth of a millimetre.

use crate::solver::lanes::powers;
use serde::{Deserialize, Serialize};

/// STEP of the source: `h0` up to `x0`, `h1` from `x1` on, and a cubic with level ends between.
pub fn smooth_step(x: f64, (x0, h0): (f64, f64), (x1, h1): (f64, f64)) -> f64 {
    let s = ((x - x0) / (x1 - x0)).clamp(0.0, 1.0);
    h0 + (h1 - h0) * s * s * (3.0 - 2.0 * s)
}

/// The contact of one point.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct Contact {
    /// Force \[N\] at a penetration of 1 mm: so it has a unit whatever the exponent is.
    pub force: f64,
    /// Exponent of the penetration.
    pub exponent: f64,
    /// Damping at full penetration \[N.s/m\].
    pub damping: f64,
    /// Penetration from which on all of the damper acts \[m\].
    pub full_damping: f64,
}

/// The penetration that [`Contact::force`] is for \[m\].
pub const UNIT: f64 = 1e-3;

/// Normal force at a point, and how it changes.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Touch {
    /// Force of the road on the point along the road's normal \[N\], never negative.
    pub force: f64,
    /// Its derivative by the penetration at a constant speed \[N/m\].
    pub by_penetration: f64,
    /// Its derivative by the speed at which the point leaves \[N.s/m\].
    pub by_leaving: f64,
    /// The second derivative by the penetration at a constant speed \[N/m²\].
    pub by_penetration_twice: f64,
    /// The derivative of [`by_leaving`](Self::by_leaving) by the penetration \[N.s/m²\].
    pub by_both: f64,
    /// The elastic part \[N\].
    pub elastic: f64,
}

impl Contact {
    /// The force at a penetration \[m\] and a speed at which the point leaves the road, along its normal \[m/s\].
    pub fn touch(&self, penetration: f64, leaving: f64) -> Touch {
        if penetration <= 0.0 {
            return Touch::default();
        }
        self.touch_at(self.elastic([penetration; 4])[0], penetration, leaving)
    }

    /// The same with the elastic part that belongs to the penetration, which is positive.
    #[inline]
    pub(super) fn touch_at(&self, elastic: f64, penetration: f64, leaving: f64) -> Touch {
        let per = 1.0 / self.full_damping;
        let s = penetration * per;
        let (damper, rate, rate_rate) = match s < 1.0 {
            true => (
                self.damping * s * s * (3.0 - 2.0 * s),
                self.damping * 6.0 * s * (1.0 - s) * per,
                self.damping * (6.0 - 12.0 * s) * per * per,
            ),
            false => (self.damping, 0.0, 0.0),
        };
        let force = elastic - damper * leaving;
        if force <= 0.0 {
            return Touch { elastic, ..Touch::default() };
        }
        let per = 1.0 / penetration;
        let slope = self.exponent * elastic * per;
        Touch {
            force,
            by_penetration: slope - rate * leaving,
            by_leaving: -damper,
            by_penetration_twice: (self.exponent - 1.0) * slope * per - rate_rate * leaving,
            by_both: -rate,
            elastic,
        }
    }

    /// The elastic part of the force at four positive penetrations: powers are most of what a step takes, and four of them cost
    /// little more than one.
    #[inline]
    pub(super) fn elastic(&self, penetrations: [f64; 4]) -> [f64; 4] {
        powers(penetrations.map(|p| p * (1.0 / UNIT)), self.exponent).map(|power| self.force * power)
    }

    /// The energy that the elastic part holds at a penetration \[J\].
    pub fn energy(&self, penetration: f64) -> f64 {
        if penetration <= 0.0 {
            return 0.0;
        }
        self.elastic([penetration; 4])[0] * penetration / (self.exponent + 1.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const PRINTED: Contact = Contact { force: 35000.0, exponent: 1.9, damping: 700.0, full_damping: 1e-4 };

    /// Numbers of the specification's check 10, which come from an independent program.
    #[test]
    fn forces_are_those_of_the_table() {
        let rows = [
            (0.05e-3, 118.062, 153.062, 0.0),
            (0.1e-3, 440.624, 510.624, 0.0),
            (0.2e-3, 1644.467, 1714.467, 244.467),
            (0.3e-3, 3553.026, 3623.026, 2153.026),
        ];
        for (penetration, elastic, approaching, leaving) in rows {
            for (speed, expected) in [(0.0, elastic), (-0.1, approaching), (2.0, leaving)] {
                let force = PRINTED.touch(penetration, speed).force;
                assert!((force - expected).abs() < 6e-4, "{penetration} {speed}: {force} {expected}");
            }
        }
        assert_eq!(PRINTED.touch(0.0, -1.0), Touch::default());
    }

    #[test]
    fn the_step_is_level_at_its_ends_and_half_in_the_middle() {
        let step = |x: f64| smooth_step(x, (0.0, 0.0), (1.0, 0.7));
        assert_eq!([step(-1.0), step(0.0), step(0.5), step(1.0), step(2.0)], [0.0, 0.0, 0.35, 0.7, 0.7]);
        for end in [0.0, 1.0] {
            assert!((step(end + 1e-5) - step(end - 1e-5)).abs() < 1e-9);
        }
    }

    #[test]
    fn derivatives_and_energy_belong_to_the_force() {
        let h = 1e-10;
        for (penetration, leaving) in [(0.03e-3, 0.05), (0.08e-3, -0.3), (0.2e-3, 0.4)] {
            let touch = PRINTED.touch(penetration, leaving);
            let by = |p: f64, v: f64| PRINTED.touch(penetration + p, leaving + v).force;
            let slope = (by(h, 0.0) - by(-h, 0.0)) / (2.0 * h);
            assert!((touch.by_penetration / slope - 1.0).abs() < 1e-5);
            let slope = (by(0.0, 1e-6) - by(0.0, -1e-6)) / 2e-6;
            assert!((touch.by_leaving / slope - 1.0).abs() < 1e-5);
            let at = |p: f64| PRINTED.touch(penetration + p, leaving);
            let curve = (at(h).by_penetration - at(-h).by_penetration) / (2.0 * h);
            assert!((touch.by_penetration_twice / curve - 1.0).abs() < 1e-5);
            let rate = (at(h).by_leaving - at(-h).by_leaving) / (2.0 * h);
            assert!((touch.by_both - rate).abs() < 1e-5 * (1.0 + rate.abs()));
            let work = (PRINTED.energy(penetration + h) - PRINTED.energy(penetration - h)) / (2.0 * h);
            assert!((work / PRINTED.touch(penetration, 0.0).force - 1.0).abs() < 1e-5);
        }
    }
}
