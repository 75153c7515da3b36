//! Springs and dampers between neighbouring elements: around the wheel, and against its bending.
//!
//! The source has their forces (4-31 to 4-34) and moments (4-35), and leaves them out of its equations of motion. Here they follow from
//! an energy of the elements' distances, 1/2 k (L - L0)² of each chord and 1/2 kt θ² of each bend, so that they make and take none.

use super::element::Radial;
use super::parameters::{Parameters, Prepared};
use crate::clone_in_place;
use serde::{Deserialize, Serialize};

/// Ways to couple neighbours, as items of an enumeration from 1.
pub(super) const COUPLINGS: &[(&str, &str)] = &[
    ("none", "each element for itself, as in the source's equations of motion"),
    ("around", "springs and dampers between neighbours, along the chord between them"),
    ("bending", "these, and springs and dampers against a change of direction from chord to chord"),
];

/// Where an element is on its ray: distance \[m\], speed \[m/s\], acceleration \[m/s²\].
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct Place {
    /// Distance from the rim's centre \[m\].
    pub distance: f64,
    /// Its speed \[m/s\].
    pub speed: f64,
    /// Its acceleration \[m/s²\].
    pub acceleration: f64,
}

/// Room for the elements of a step, which depend on each other; empty where they are not coupled.
#[derive(Debug, PartialEq, Default, Serialize, Deserialize)]
pub struct Places {
    /// Where a stage begins.
    pub from: Vec<Place>,
    /// Where it ends.
    pub to: Vec<Place>,
}

clone_in_place!(Places { from, to });

impl Places {
    pub(super) fn new(parameters: &Parameters, elements: usize) -> Self {
        let room = if parameters.coupling > 1 { elements } else { 0 };
        Self { from: vec![Place::default(); room], to: vec![Place::default(); room] }
    }
}

/// What neighbours do to an element: force that pulls it to the rim, and how that grows with its own distance and speed, at least.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct Coupled {
    pub force: f64,
    pub stiffness: f64,
    pub damping: f64,
}

impl Coupled {
    /// The same force as a line through the place where it was found, which [`with`](Self::with) needs it as.
    pub fn about(self, place: &Place) -> Self {
        let force = self.force - self.stiffness * place.distance - self.damping * place.speed;
        Self { force, ..self }
    }

    /// What acts on an element, with this.
    #[inline]
    pub fn with(&self, radial: &Radial) -> Radial {
        Radial {
            stiffness: radial.stiffness + self.stiffness,
            damping: radial.damping + self.damping,
            base: radial.base + self.force,
            ..*radial
        }
    }
}

/// A chord from one element to the next.
struct Chord {
    length: f64,
    /// Derivatives of the length by both distances.
    by: [f64; 2],
    /// Force that pulls both together \[N\].
    tension: f64,
    rate: f64,
}

/// Springs and dampers of a wheel whose neighbours are coupled.
#[derive(Debug, Clone, Copy)]
pub(super) struct Coupling {
    cos: f64,
    /// Length of a chord without load \[m\].
    chord: f64,
    around: [f64; 2],
    /// Of a bend over the square of the distance between neighbours \[N/m, N.s/m\].
    bending: [f64; 2],
}

impl Coupling {
    /// Nothing where elements are not coupled.
    pub fn new(p: &Parameters, prepared: &Prepared) -> Option<Self> {
        let between = prepared.free * prepared.pitch;
        let per_square = 1.0 / (between * between);
        (p.coupling > 1).then(|| Self {
            cos: libm::cos(prepared.pitch),
            chord: 2.0 * prepared.free * libm::sin(0.5 * prepared.pitch),
            around: [p.coupling_stiffness, p.coupling_damping],
            bending: match p.coupling {
                3 => [p.bending_stiffness, p.bending_damping].map(|x| x * per_square),
                _ => [0.0; 2],
            },
        })
    }

    /// (4-31) to (4-33), and how the length changes.
    fn chord(&self, a: &Place, b: &Place) -> Chord {
        let square =
            a.distance * a.distance + b.distance * b.distance - 2.0 * a.distance * b.distance * self.cos;
        let length = libm::sqrt(square);
        let by = [a.distance - b.distance * self.cos, b.distance - a.distance * self.cos].map(|x| x / length);
        let rate = by[0] * a.speed + by[1] * b.speed;
        let [stiffness, damping] = self.around;
        Chord { length, by, tension: stiffness * (length - self.chord) + damping * rate, rate }
    }

    /// The bend at an element and its rate, times the distance between neighbours \[m, m/s\].
    fn bend(places: &[Place], n: usize) -> [f64; 2] {
        let [before, at, after] = [n + places.len() - 1, n, n + 1].map(|i| places[i % places.len()]);
        [before.distance - 2.0 * at.distance + after.distance, before.speed - 2.0 * at.speed + after.speed]
    }

    /// What an element feels where all are.
    pub fn on(&self, places: &[Place], n: usize) -> Coupled {
        let count = places.len();
        let (before, after) = ((n + count - 1) % count, (n + 1) % count);
        let mut felt = Coupled::default();
        let [stiffness, damping] = self.around;
        for other in [before, after] {
            let chord = self.chord(&places[n], &places[other]);
            let square = chord.by[0] * chord.by[0];
            felt.force += chord.tension * chord.by[0];
            felt.stiffness += stiffness * square + chord.tension.max(0.0) * (1.0 - square) / chord.length;
            felt.damping += damping * square;
        }
        let [stiffness, damping] = self.bending;
        if stiffness > 0.0 || damping > 0.0 {
            let moment = |n: usize| {
                let [bend, rate] = Self::bend(places, n);
                stiffness * bend + damping * rate
            };
            felt.force += moment(before) - 2.0 * moment(n) + moment(after);
            felt.stiffness += 6.0 * stiffness;
            felt.damping += 6.0 * damping;
        }
        felt
    }

    /// Stiffness that an element of a round wheel has by its neighbours \[N/m\].
    pub fn of_a_round_wheel(&self) -> f64 {
        // a chord is longer by the sine of half the angle for each of its ends
        self.around[0] * (1.0 - self.cos) + 6.0 * self.bending[0]
    }

    /// Energy of all springs \[J\], and the power that all dampers take \[W\].
    pub fn energy(&self, places: &[Place]) -> (f64, f64) {
        let (mut energy, mut loss) = (0.0, 0.0);
        for n in 0..places.len() {
            let chord = self.chord(&places[n], &places[(n + 1) % places.len()]);
            let stretched = chord.length - self.chord;
            let [bend, bending] = Self::bend(places, n);
            energy += 0.5 * (self.around[0] * stretched * stretched + self.bending[0] * bend * bend);
            loss += self.around[1] * chord.rate * chord.rate + self.bending[1] * bending * bending;
        }
        (energy, loss)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Forces are derivatives of the energy by the distances, those of dampers of half the power by the speeds.
    #[test]
    fn forces_follow_from_energy_and_power() {
        for count in [4, 5, 12] {
            let pitch = std::f64::consts::TAU / f64::from(count);
            let coupling = Coupling {
                cos: pitch.cos(),
                chord: 2.0 * 0.2 * (0.5 * pitch).sin(),
                around: [3e5, 40.0],
                bending: [2e4, 7.0],
            };
            let places: Vec<Place> = (0..count)
                .map(|n| Place {
                    distance: 0.2 + 0.01 * (1.7 * f64::from(n)).sin(),
                    speed: (2.3 * f64::from(n)).cos(),
                    acceleration: 0.0,
                })
                .collect();
            let still: Vec<Place> = places.iter().map(|p| Place { speed: 0.0, ..*p }).collect();
            for n in 0..places.len() {
                let by_place = |by: f64| {
                    let mut moved = still.clone();
                    moved[n].distance += by;
                    coupling.energy(&moved).0
                };
                let slope = (by_place(1e-6) - by_place(-1e-6)) / 2e-6;
                let spring = coupling.on(&still, n).force;
                assert!((spring - slope).abs() < 1e-5 * (1.0 + slope.abs()), "{count} {n}: {spring} {slope}");
                let by_speed = |by: f64| {
                    let mut moved = places.clone();
                    moved[n].speed += by;
                    0.5 * coupling.energy(&moved).1
                };
                let slope = (by_speed(1e-4) - by_speed(-1e-4)) / 2e-4;
                let damper = coupling.on(&places, n).force - spring;
                assert!((damper - slope).abs() < 1e-6 * (1.0 + slope.abs()), "{count} {n}: {damper} {slope}");
            }
        }
    }

    /// A round wheel that is larger all around: hoop stress, k α² of a chord's spring at small pitches, and nothing bends.
    #[test]
    fn a_larger_wheel_is_a_hoop() {
        let pitch = std::f64::consts::TAU / 90.0;
        let coupling = Coupling {
            cos: pitch.cos(),
            chord: 2.0 * 0.2 * (0.5 * pitch).sin(),
            around: [1e6, 0.0],
            bending: [1e5, 0.0],
        };
        let places = [Place { distance: 0.201, ..Place::default() }; 90];
        let hoop = 1e6 * pitch * pitch * 1e-3;
        assert!((coupling.on(&places, 7).force / hoop - 1.0).abs() < 1e-3);
    }
}
