//! The order of the catalogue: what an effect becomes where one of its parameters is at its off value or at an end of its range.

use crate::effect::Effect;

/// Where a parameter says nothing more.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Place {
    /// At its off value.
    Off,
    /// At the lower end of its range, and below.
    Low,
}

/// An effect with one parameter more than a simpler one.
#[derive(Debug, Clone, Copy)]
pub struct Nested {
    /// Id of the effect.
    pub effect: &'static str,
    /// The parameter that sets it apart,
    pub parameter: &'static str,
    /// and where it does not.
    pub place: Place,
    /// Id of what it is there: of its first form.
    pub simpler: &'static str,
}

impl Nested {
    /// Whether an effect, in this form, is what it becomes.
    pub fn is_simpler(&self, effect: &Effect) -> bool {
        let names = |e: &Effect| e.parameters.iter().map(|p| p.name).collect::<Vec<_>>();
        effect.id == self.simpler
            && super::super::find(self.simpler).is_some_and(|e| names(e) == names(effect))
    }
}

const fn nested(
    effect: &'static str,
    parameter: &'static str,
    place: Place,
    simpler: &'static str,
) -> Nested {
    Nested { effect, parameter, place, simpler }
}

/// All of them.
pub const NESTED: &[Nested] = &[
    nested("stribeck-friction", "peak", Place::Off, "coulomb-friction"),
    nested("bouc-wen", "length", Place::Low, "coulomb-friction"),
    nested("bushing-hysteresis", "length", Place::Low, "coulomb-friction"),
    nested("maxwell-element", "time", Place::Low, "viscous-drag"),
    nested("seal-friction", "per_pressure", Place::Off, "guide-friction"),
    nested("load-dependent-friction", "per_load", Place::Off, "coulomb-friction"),
];

/// What an effect, in this form, becomes, and by which of its parameters.
pub fn simpler(effect: &Effect) -> impl Iterator<Item = &'static Nested> {
    let has = |n: &Nested| effect.parameters.iter().any(|p| p.name == n.parameter);
    NESTED.iter().filter(move |n| n.effect == effect.id && has(n))
}

#[cfg(test)]
mod tests {
    use super::super::tests::run;
    use super::*;
    use crate::effect::{Parameter, Role, find, forms};

    const TARGET: f64 = 0.3;

    /// Courses of a sine of 1 m and 1 Hz, with another signal beside it, for the drivers of an effect.
    fn driven(effect: &Effect, p: &[f64]) -> Vec<f64> {
        let points: Vec<_> = (0..30_000)
            .map(|k| {
                let t = 1e-4 * f64::from(k);
                let mut drivers = [0.0; 5];
                for (driver, role) in drivers.iter_mut().zip(effect.drivers) {
                    *driver = match role {
                        Role::Position => (std::f64::consts::TAU * t).sin(),
                        Role::Velocity => std::f64::consts::TAU * (std::f64::consts::TAU * t).cos(),
                        _ => 1.0 + (3.0 * t).sin(),
                    };
                }
                (1e-4, TARGET, drivers)
            })
            .collect();
        run(effect, p, &points)
    }

    #[test]
    fn every_effect_becomes_the_simpler_one() {
        for n in NESTED {
            let has = |e: &&Effect| e.parameters.iter().any(|p| p.name == n.parameter);
            let (effect, simpler) = (forms(n.effect).find(has).unwrap(), find(n.simpler).unwrap());
            let value = |p: &Parameter| match (p.name == n.parameter, n.place) {
                (true, Place::Off) => p.off.unwrap(),
                // the limit, which lies far below the range: at a turn of x = cos(w t) a way of L takes sqrt(2 L) / w
                (true, Place::Low) => 1e-6 * p.search.0,
                _ => p.off.map_or(p.probes[0], |off| off + 0.5),
            };
            let general = driven(effect, &effect.parameters.iter().map(value).collect::<Vec<_>>());
            let general: Vec<f64> = general.iter().map(|f| f - TARGET).collect();
            // what the simpler one is in proportion to, by the best amount of it
            let least = |shape: f64| {
                let value = |p: &Parameter| p.off.map_or(shape, |off| off + 1.0);
                let other = driven(simpler, &simpler.parameters.iter().map(value).collect::<Vec<_>>());
                // the first turn of a hysteresis begins at rest
                let pairs = || general.iter().zip(other.iter().map(|f| f - TARGET)).skip(10_000);
                let (both, own) = pairs().fold((0.0, 0.0), |(x, y), (a, b)| (x + a * b, y + b * b));
                pairs().map(|(a, b)| (a - both / own * b).powi(2)).sum::<f64>()
            };
            let shapes = (-30..20).map(|k| 10_f64.powf(0.1 * f64::from(k)));
            let best = shapes.map(least).fold(f64::INFINITY, f64::min);
            let size: f64 = general.iter().skip(10_000).map(|g| g * g).sum();
            assert!(best < 1e-3 * size, "{} is no {}: {}", n.effect, n.simpler, best / size);
        }
    }
}
