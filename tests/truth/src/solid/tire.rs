//! The tire: elements on rays that turn with the rim, and what the road does to them.

use super::parameters::Parameters;
use super::rubber::{Past, Rubber};
use std::f64::consts::{FRAC_PI_2, TAU};

/// Elements around the wheel, and contact points of each.
pub(crate) const ELEMENTS: usize = 45;
const POINTS: [f64; 3] = [-1.0, 0.0, 1.0];
/// Angle between the outer points of neighbours \[rad\].
const GAP: f64 = TAU / 360.0;
/// Below this speed \[m/s\] slip is over it: a number that only keeps a quotient of zeros away.
const STANDS: f64 = 1e-6;

/// What the wheel stands or rolls on. Its origin is below the wheel's centre.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Road {
    /// A level plate at height 0.
    Level,
    /// A drum of this radius \[m\], crest at height 0, with a cleat on it.
    Drum(f64, Cleat),
}

/// A cleat with ramps: where its foot begins, from the drum's index on, length of a ramp and of the top, height \[m\].
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Cleat {
    pub(crate) start: f64,
    pub(crate) ramp: f64,
    pub(crate) top: f64,
    pub(crate) height: f64,
}

impl Cleat {
    /// Height and slope at a place of the drum's surface.
    fn at(&self, s: f64) -> (f64, f64) {
        let (up, slope) = (s - self.start, self.height / self.ramp);
        let down = 2.0 * self.ramp + self.top - up;
        if up <= 0.0 || down <= 0.0 {
            (0.0, 0.0)
        } else if up < self.ramp {
            (up * slope, slope)
        } else if down < self.ramp {
            (down * slope, -slope)
        } else {
            (self.height, 0.0)
        }
    }

    /// As the model's profile has it.
    pub(crate) fn profile(&self) -> String {
        let (a, b, h) = (self.ramp, self.ramp + self.top, self.height);
        format!("0 0; {a:.4} {h:.4}; {b:.4} {h:.4}; {:.4} 0", b + self.ramp)
    }
}

/// Where the road is: place at the wheel \[m\], speed of the surface \[m/s\].
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct Surface {
    pub(crate) place: f64,
    pub(crate) speed: f64,
}

impl Road {
    /// Penetration, normal and the velocity of the surface at a point.
    fn below(&self, [x, z]: [f64; 2], surface: &Surface) -> (f64, [f64; 2], [f64; 2]) {
        let Self::Drum(radius, cleat) = self else { return (-z, [0.0, 1.0], [0.0; 2]) };
        let from = (x * x + (z + radius) * (z + radius)).sqrt();
        let out = [x / from, (z + radius) / from];
        let forward = [out[1], -out[0]];
        let (h, slope) = cleat.at(self.turned(surface.place + radius * libm::atan2(x, z + radius)));
        let level = 1.0 / (1.0 + slope * slope).sqrt();
        let normal = [0, 1].map(|k| level * (out[k] - slope * forward[k]));
        // the surface comes toward a wheel that rolls forward
        let moves = forward.map(|f| -surface.speed * from / radius * f);
        (level * (h - (from - radius)), normal, moves)
    }

    fn turned(&self, s: f64) -> f64 {
        let Self::Drum(radius, _) = self else { return s };
        let around = TAU * radius;
        s - (s / around).floor() * around
    }

    /// Height right below the wheel, and cosine and sine of the slope there.
    pub(crate) fn under(&self, surface: &Surface) -> (f64, [f64; 2]) {
        match self {
            Self::Level => (0.0, [1.0, 0.0]),
            Self::Drum(_, cleat) => {
                let (height, slope) = cleat.at(self.turned(surface.place));
                let cosine = 1.0 / (1.0 + slope * slope).sqrt();
                (height, [cosine, slope * cosine])
            }
        }
    }

    fn highest(&self) -> f64 {
        match self {
            Self::Level => 0.0,
            Self::Drum(_, cleat) => cleat.height,
        }
    }
}

/// Motion of the rim: height of its centre, its velocity, spin angle and speed.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct Rim {
    pub(crate) height: f64,
    pub(crate) climb: f64,
    pub(crate) angle: f64,
    pub(crate) spin: f64,
}

/// Elements: where they are on their rays, how fast, and the slow part of their deflection.
pub(crate) const STATES: usize = 3 * ELEMENTS;

/// A tire on a road, with what its rubber does beside spring and damper.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Tire {
    pub(crate) p: Parameters,
    pub(crate) road: Road,
    pub(crate) rubber: Option<Rubber>,
    /// Stiffness of each element over the mean, and how far its tread stands out \[m\].
    pub(crate) uneven: Vec<(f64, f64)>,
    /// Cosine and sine of every ray's angle on the rim.
    rays: Vec<[f64; 2]>,
    /// How far the outer points are from the middle \[m\].
    half: f64,
}

/// Directions of the rays, force of the rubber on each, and all of them on the rim.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Told {
    rays: [[f64; 2]; ELEMENTS],
    each: [f64; ELEMENTS],
    pub(crate) x: f64,
    pub(crate) z: f64,
}

impl Tire {
    pub(crate) fn new(p: Parameters, road: Road, rubber: Option<Rubber>) -> Self {
        let angle = TAU / ELEMENTS as f64;
        let ray = |n: usize| {
            let (s, c) = libm::sincos(n as f64 * angle - FRAC_PI_2);
            [c, s]
        };
        let half = p.tire_radius * libm::sin(0.5 * (angle - GAP));
        let rays = (0..ELEMENTS).map(ray).collect();
        Self { p, road, rubber, uneven: vec![(1.0, 0.0); ELEMENTS], rays, half }
    }

    fn mass(&self) -> f64 {
        self.p.rubber_mass / ELEMENTS as f64
    }

    /// Middle of an element without load.
    fn free(&self) -> f64 {
        self.p.tire_radius - 0.5 * self.p.element_thickness
    }

    /// Directions of the rays on a wheel that has turned.
    fn directions(&self, angle: f64) -> [[f64; 2]; ELEMENTS] {
        let (s, c) = libm::sincos(angle);
        std::array::from_fn(|n| {
            let [x, z] = self.rays[n];
            [x * c + z * s, z * c - x * s]
        })
    }

    /// (4-30), with what the rubber does beside; `damping` is that of now.
    fn spring(&self, n: usize, y: &[f64], damping: f64, past: &[Past]) -> f64 {
        let x = y[n] - self.free();
        let own = self.p.element_radial_stiffness * self.uneven[n].0 * x + damping * y[ELEMENTS + n];
        own + self.rubber.map_or(0.0, |rubber| rubber.force(x, y[2 * ELEMENTS + n], &past[n]))
    }

    /// Forces of springs and dampers, and their sum (4-64): all that a rim feels of them, as printed.
    pub(crate) fn force(&self, y: &[f64], angle: f64, damping: f64, past: &[Past]) -> Told {
        let mut told = Told { rays: self.directions(angle), each: [0.0; ELEMENTS], x: 0.0, z: 0.0 };
        for n in 0..ELEMENTS {
            let f = self.spring(n, y, damping, past);
            told.each[n] = f;
            told.x += f * told.rays[n][0];
            told.z += f * told.rays[n][1];
        }
        told
    }

    /// What the road does to an element along its ray (4-60), at this place and speed on it.
    fn contact(&self, n: usize, [c, s]: [f64; 2], (r, v): (f64, f64), rim: &Rim, surface: &Surface) -> f64 {
        let p = &self.p;
        let tread = r + 0.5 * p.element_thickness + self.uneven[n].1;
        // the upper half, and what is far from the road
        if s > 0.0 || rim.height + tread * s - self.half * c.abs() > self.road.highest() {
            return 0.0;
        }
        let mut sum = 0.0;
        for side in POINTS {
            let aside = side * self.half;
            let arm = [tread * c - aside * s, tread * s + aside * c];
            let (deep, normal, moves) = self.road.below([arm[0], rim.height + arm[1]], surface);
            if deep <= 0.0 {
                continue;
            }
            let velocity = [v * c + rim.spin * arm[1], rim.climb + v * s - rim.spin * arm[0]];
            let leaves = (velocity[0] - moves[0]) * normal[0] + (velocity[1] - moves[1]) * normal[1];
            let part = (deep / p.contact_full_damping).min(1.0);
            let damping = p.contact_damping * part * part * (3.0 - 2.0 * part);
            let elastic = p.contact_stiffness * libm::pow(1e3 * deep, p.contact_exponent);
            let force = (elastic - damping * leaves).max(0.0) / POINTS.len() as f64;
            sum += force * (normal[0] * c + normal[1] * s);
        }
        sum
    }

    /// Rates of the elements' states, on a rim that moves and is accelerated upward by `lift`.
    pub(crate) fn rates(
        &self,
        y: &[f64],
        (rim, lift): (&Rim, f64),
        surface: &Surface,
        told: &Told,
        dy: &mut [f64],
    ) {
        let m = self.mass();
        for (n, ray) in told.rays.into_iter().enumerate() {
            let (r, v) = (y[n], y[ELEMENTS + n]);
            let pushed = self.contact(n, ray, (r, v), rim, surface) - told.each[n];
            dy[n] = v;
            dy[ELEMENTS + n] = pushed / m + r * rim.spin * rim.spin - ray[1] * (self.p.gravity + lift);
            let slow = y[2 * ELEMENTS + n];
            dy[2 * ELEMENTS + n] = self.rubber.map_or(0.0, |rubber| rubber.slow_rate(r - self.free(), slow));
        }
    }

    /// What the elements remember of a step.
    pub(crate) fn remember(&self, y: &[f64], past: &mut [Past], dt: f64) {
        if let Some(rubber) = self.rubber {
            for (n, past) in past.iter_mut().enumerate() {
                rubber.remember(y[n] - self.free(), y[2 * ELEMENTS + n], past, dt);
            }
        }
    }

    /// States of elements that are at rest for long on a standing wheel at this height, and what they remember.
    pub(crate) fn rest(&self, height: f64) -> (Vec<f64>, Vec<Past>) {
        let rim = Rim { height, ..Rim::default() };
        let mut y = vec![0.0; STATES];
        for (n, ray) in self.directions(0.0).into_iter().enumerate() {
            let k = self.p.element_radial_stiffness * self.uneven[n].0;
            let pushed = |r: f64| {
                let road = self.contact(n, ray, (r, 0.0), &rim, &Surface::default());
                road - k * (r - self.free()) - self.mass() * self.p.gravity * ray[1]
            };
            let (mut low, mut high) = (0.5 * self.free(), 1.5 * self.free());
            for _ in 0..60 {
                let middle = 0.5 * (low + high);
                // the farther out, the more it is pushed in
                if pushed(middle) > 0.0 { low = middle } else { high = middle }
            }
            y[n] = 0.5 * (low + high);
            y[2 * ELEMENTS + n] = y[n] - self.free();
        }
        let past = (0..ELEMENTS).map(|n| Past::at(y[n] - self.free())).collect();
        (y, past)
    }

    /// The height at which a standing wheel carries a load, as the rim feels it.
    pub(crate) fn height(&self, load: f64) -> f64 {
        let (mut low, mut high) = (0.6 * self.p.tire_radius, 1.1 * self.p.tire_radius);
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            let (y, past) = self.rest(middle);
            let carried = self.force(&y, 0.0, self.p.element_radial_damping, &past).z;
            if carried > load { low = middle } else { high = middle }
        }
        0.5 * (low + high)
    }

    /// Force of the brush along the road at a slip (2-49, 2-53), under this load.
    pub(crate) fn brush(&self, slip: f64, load: f64) -> f64 {
        let p = &self.p;
        let size = slip.abs();
        let sliding = (p.friction_max + size * (p.friction_min - p.friction_max)) * load.max(0.0);
        if sliding <= 0.0 {
            return 0.0;
        }
        let stick = (1.0 - p.slip_stiffness * size / (3.0 * sliding)).max(0.0);
        let (square, cube) = (stick * stick, stick * stick * stick);
        let force = p.slip_stiffness * size * square + sliding * (1.0 - 3.0 * square + 2.0 * cube);
        force.copysign(slip)
    }

    /// Slip of a wheel (2-4), the faster one of travelling along the road and rolling, and the dynamic radius (4-62), with the
    /// height over the road as along its normal.
    pub(crate) fn slip(&self, rim: &Rim, surface: &Surface) -> (f64, f64, f64) {
        let (height, [c, s]) = self.road.under(surface);
        let radius = 2.0 / 3.0 * self.p.tire_radius + (rim.height - height) * c / 3.0;
        let (rolls, travels) = (rim.spin * radius, surface.speed * c + rim.climb * s);
        let faster = travels.abs().max(rolls.abs()).max(STANDS);
        ((rolls - travels) / faster, faster, radius)
    }

    /// Inertia of the rubber about the axle.
    pub(crate) fn inertia(&self) -> f64 {
        self.p.rubber_mass * self.free() * self.free()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn standing(p: Parameters) -> Tire {
        Tire::new(p, Road::Level, None)
    }

    /// Height at which the road carries a load: weight of the rubber and what rays guide belong to it.
    fn carried(tire: &Tire, load: f64) -> f64 {
        let (mut low, mut high) = (0.15, 0.23);
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            let (y, _) = tire.rest(middle);
            let rim = Rim { height: middle, ..Rim::default() };
            let rays = tire.directions(0.0);
            let sum: f64 = (0..ELEMENTS)
                .map(|n| tire.contact(n, rays[n], (y[n], 0.0), &rim, &Surface::default()) / rays[n][1])
                .sum();
            if sum > load { low = middle } else { high = middle }
        }
        0.5 * (low + high)
    }

    #[test]
    fn a_standing_wheel_sinks_in_as_far_as_the_specification_computed() {
        // 663 kg, the property file, three points
        let tire = standing(Parameters::default());
        let deep = 0.2265 - carried(&tire, 6504.03);
        assert!((deep - 12.67e-3).abs() < 5e-6, "{deep}");
        // what the rim feels as printed is less
        let (y, past) = tire.rest(0.2265 - deep);
        let felt = tire.force(&y, 0.0, 280.0, &past).z;
        assert!((0.95..0.97).contains(&(felt / 6504.03)), "{felt}");
        assert!((tire.height(felt) - (0.2265 - deep)).abs() < 1e-9);
    }

    #[test]
    fn the_contact_has_the_forces_of_the_specification() {
        let tire = standing(Parameters { tire_radius: 0.2265, ..Parameters::default() });
        // an element straight below with all its points at one depth, at rest, approaching, leaving
        for (deep, speed, expected) in [
            (0.05e-3, 0.0, 118.062),
            (0.2e-3, 0.0, 1644.467),
            (0.3e-3, -0.1, 3623.026),
            (0.05e-3, -0.1, 153.062),
            (0.2e-3, 2.0, 244.467),
            (0.1e-3, 2.0, 0.0),
        ] {
            let rim = Rim { height: tire.p.tire_radius - deep, climb: speed, ..Rim::default() };
            let force = tire.contact(0, [0.0, -1.0], (tire.free(), 0.0), &rim, &Surface::default());
            assert!((force + expected).abs() < 2e-3, "{deep} {speed}: {force}");
        }
    }

    #[test]
    fn the_brush_has_the_forces_of_the_specification() {
        let tire = standing(Parameters::default());
        for (slip, expected) in [(0.01, 49.864), (0.05, 246.592), (0.065, 319.240), (0.2, 945.444)] {
            assert!((tire.brush(slip, 6504.03) - expected).abs() < 2e-3, "{slip}");
            assert!((tire.brush(-slip, 6504.03) + expected).abs() < 2e-3, "{slip}");
        }
        let stiff = standing(Parameters { slip_stiffness: 65e3, ..Parameters::default() });
        for (slip, expected) in [(0.01, 627.215), (0.1, 4451.599), (0.5, 5821.107)] {
            assert!((stiff.brush(slip, 6504.03) - expected).abs() < 2e-3, "{slip}");
        }
    }

    #[test]
    fn a_large_drum_is_a_plate_and_a_small_one_takes_more_way() {
        let p = Parameters::default();
        let none = Cleat { start: 1.0, ramp: 0.05, top: 0.1, height: 0.0 };
        let on = |radius: f64| Tire::new(p.clone(), Road::Drum(radius, none), None).height(6500.0);
        let flat = standing(p.clone()).height(6500.0);
        assert!((on(1e5) - flat).abs() < 1e-6, "{} {flat}", on(1e5));
        assert!(on(1.0) < flat - 5e-4, "{} {flat}", on(1.0));
    }
}
