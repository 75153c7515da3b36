//! A road that is wound around a drum, or inside of one: it turns under a wheel that stays where it is.

use super::{Point, Road};
use crate::{Error, Result};
use std::f64::consts::PI;

/// Rounds of the search for the place of a point on a drum. Each leaves the slope of an obstacle times the slope of the drum there, a
/// hundredth of what the one before left.
const ROUNDS: usize = 12;
/// How far beyond the drum's crest a point may be, as a share of its radius; the drum has no road farther out.
const FARTHEST: f64 = 0.999;
/// Places at which each side of the seam is looked at: less than a millimetre apart for any tire.
const LOOKS: u32 = 1000;

/// Height and slope of a bare drum of a curvature \[1/m\] at x \[m\] from its crest, or of a hollow one (negative) from its lowest point.
pub fn round(curvature: f64, x: f64) -> (f64, f64) {
    if curvature == 0.0 {
        return (0.0, 0.0);
    }
    let sin = (curvature * x).clamp(-FARTHEST, FARTHEST);
    let cos = (1.0 - sin * sin).sqrt();
    // (cos - 1) / curvature without the difference
    (-sin * sin / (1.0 + cos) / curvature, -sin / cos)
}

impl Road {
    /// The road wound around a drum of a radius \[m\], or inside of one, where it is negative. One turn of it is used, from its
    /// start on.
    ///
    /// # Errors
    /// The road does not close: within `reach` \[m\] of its seam, before and behind the turn too, it is not level at height 0.
    pub fn wound(self, radius: f64, reach: f64) -> Result<Self> {
        let turn = 2.0 * PI * radius.abs();
        for k in 0..=LOOKS {
            let way = reach * f64::from(k) / f64::from(LOOKS);
            // what bridges the seam sees the road on beyond it
            for s in [way, -way, turn - way, turn + way] {
                let Point { height, slope, .. } = self.at(s, 0.0);
                if height != 0.0 || slope != [0.0; 2] {
                    return Err(Error::variable(format!(
                        "the road does not close on the drum: its turn of {turn:.4} m has to be level, at height 0, for {reach:.3} m at its beginning and its end, and is {height:.5} m high at {s:.3} m; move it with road_start, or make it shorter"
                    )));
                }
            }
        }
        Ok(Self { curvature: 1.0 / radius, ..self })
    }

    /// Curvature of the drum that it is wound around \[1/m\]: negative inside of one, 0 of a road that lies.
    pub fn drum_curvature(&self) -> f64 {
        self.curvature
    }

    /// The place within the first turn of the drum.
    pub fn within_turn(&self, s: f64) -> f64 {
        if self.curvature == 0.0 { s } else { s.rem_euclid(2.0 * PI / self.curvature.abs()) }
    }

    /// The road at x \[m\] from the drum's crest, at which the place s is, and at y across; x along s. Obstacles stand on the
    /// drum's radii.
    pub fn on_drum(&self, s: f64, x: f64, y: f64) -> Point {
        let (place, (height, slope)) = self.relief_on_drum(s, x, y);
        Point { height, slope, friction: self.at(place, y).friction }
    }

    /// Place on the road, and height and slopes of [`on_drum`](Self::on_drum) there.
    pub fn relief_on_drum(&self, s: f64, x: f64, y: f64) -> (f64, (f64, [f64; 2])) {
        let radius = 1.0 / self.curvature;
        let beside = |out: f64| libm::asin((x / out).clamp(-FARTHEST, FARTHEST));
        let mut angle = beside(radius);
        let mut place = self.within_turn(s + radius * angle);
        let (mut height, mut slope) = self.relief(place, y);
        for _ in 0..ROUNDS {
            let next = beside(radius + height);
            if next == angle {
                break;
            }
            angle = next;
            place = self.within_turn(s + radius * angle);
            (height, slope) = self.relief(place, y);
        }
        let out = radius + height;
        let by_angle = radius * slope[0];
        let (sin, cos) = libm::sincos(angle);
        // out cos - radius, without the difference of radii
        let over = height * cos + round(self.curvature, radius * sin).0;
        let along = (by_angle * cos - out * sin) / (by_angle * sin + out * cos);
        (place, (over, [along, slope[1]]))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::road::RoadParameters;

    fn ramps() -> Road {
        let p = RoadParameters {
            kind: 8,
            start: 1.0,
            profile: "0 0; 0.05 0.005; 0.2 0.005; 0.25 0".into(),
            ..RoadParameters::flat()
        };
        Road::new(&p).unwrap()
    }

    /// A drum of a large radius is a road that lies, a bare one a circle, and a turn later all is there again.
    #[test]
    fn a_drum_is_a_circle_and_a_large_one_the_road() {
        let lying = ramps();
        let large = ramps().wound(1e7, 0.3).unwrap();
        for (s, x) in [(1.0, 0.02), (1.1, -0.07), (1.3, -0.04), (0.9, 0.2)] {
            let (a, b) = (large.on_drum(s, x, 0.0), lying.at(s + x, 0.0));
            assert!((a.height - b.height).abs() < 1e-8 && (a.slope[0] - b.slope[0]).abs() < 1e-7);
        }
        for radius in [0.5, -0.8] {
            let drum = ramps().wound(radius, 0.2).unwrap();
            for x in [-0.2, 0.0, 0.1] {
                let point = drum.on_drum(0.3, x, 0.0);
                let (height, slope) = round(1.0 / radius, x);
                let exact = (radius * radius - x * x).sqrt() * radius.signum() - radius;
                assert!((point.height - exact).abs() < 1e-15 && (height - exact).abs() < 1e-15);
                assert!((point.slope[0] - slope).abs() < 1e-13);
                let ahead = round(1.0 / radius, x + 1e-6).0 - round(1.0 / radius, x - 1e-6).0;
                assert!((slope - ahead / 2e-6).abs() < 1e-9);
            }
            let turn = 2.0 * PI * radius.abs();
            for x in [-0.1, 0.05] {
                let (a, b) = (drum.on_drum(1.1, x, 0.0), drum.on_drum(1.1 + turn, x, 0.0));
                assert!((a.height - b.height).abs() < 1e-13);
            }
        }
    }

    /// On the plateau of an obstacle the road is a circle of a radius that is larger by its height, and smaller inside of a drum;
    /// the slope is that of the heights beside.
    #[test]
    fn obstacles_stand_on_radii() {
        for radius in [0.5, -0.8] {
            let drum = ramps().wound(radius, 0.2).unwrap();
            for x in [-0.03, 0.01, 0.04] {
                let height = drum.on_drum(1.125, x, 0.0).height;
                let out = radius + 0.005;
                let exact = (out * out - x * x).sqrt() * out.signum() - radius;
                assert!((height - exact).abs() < 1e-14, "{radius} {x}: {height} {exact}");
            }
            for (s, x) in [(1.0, 0.03), (1.22, -0.01), (1.125, 0.05)] {
                let at = |x: f64| drum.on_drum(s, x, 0.0);
                let slope = (at(x + 1e-7).height - at(x - 1e-7).height) / 2e-7;
                assert!((at(x).slope[0] - slope).abs() < 1e-6, "{} {slope}", at(x).slope[0]);
            }
        }
    }

    #[test]
    fn a_road_that_does_not_close_is_refused() {
        let message = ramps().wound(0.16, 0.2).unwrap_err().to_string();
        assert!(message.contains("does not close"), "{message}");
        // level within the turn, and not before its beginning, which what bridges the seam sees
        let behind = RoadParameters {
            kind: 8,
            start: -0.3,
            profile: "0 0; 0.05 0.005; 0.2 0.005; 0.25 0".into(),
            ..RoadParameters::flat()
        };
        assert!(Road::new(&behind).unwrap().wound(0.8, 0.2).is_err());
    }
}
