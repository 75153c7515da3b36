//! The road: slabs that rise and drop, and friction that scatters along both tracks.

use crate::random::Random;

/// Slabs that each rise over their length and end in a vertical drop, without gap.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Slabs {
    /// Where the first one begins, before the front axle's place at the start \[m\].
    pub(crate) start: f64,
    pub(crate) length: f64,
    /// Height of the drop \[m\].
    pub(crate) drop: f64,
}

/// A road; both tracks have the same height.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Road {
    pub(crate) slabs: Option<Slabs>,
    /// Friction of the left and the right track.
    pub(crate) friction: [Scatter; 2],
}

impl Road {
    /// Height \[m\] and slope at a place.
    pub(crate) fn surface(&self, x: f64) -> (f64, f64) {
        match self.slabs {
            Some(slabs) if x >= slabs.start => {
                let on = (x - slabs.start) / slabs.length;
                (slabs.drop * (on - on.floor()), slabs.drop / slabs.length)
            }
            _ => (0.0, 0.0),
        }
    }
}

/// Friction factor along a track.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Scatter {
    level: f64,
    /// Distance of the values \[m\].
    spacing: f64,
    values: Vec<f64>,
}

/// A track begins as far behind the front axle's place at the start \[m\], and is as long.
const BEHIND: f64 = 10.0;
const LONG: f64 = 120.0;
/// Values to a correlation length.
const FINE: f64 = 8.0;
/// Normal deviations beyond this are drawn in.
const FARTHEST: f64 = 2.5;

impl Scatter {
    /// The same everywhere.
    pub(crate) fn none(level: f64) -> Self {
        Self { level, spacing: 1.0, values: Vec::new() }
    }

    /// Scatter about a level: white noise, shaped by a Gaussian bell so that the integral of the correlation over positive lags is
    /// the correlation length.
    pub(crate) fn draw(random: &mut Random, level: f64, (deviation, length): (f64, f64)) -> Self {
        let spacing = length / FINE;
        // a bell exp(-x² / (2 s²)) leaves the correlation exp(-u² / (4 s²)), whose integral is s sqrt(pi)
        let width = FINE / std::f64::consts::PI.sqrt();
        let mut half: Vec<f64> = Vec::new();
        while (half.len() as f64) < 3.5 * width {
            let x = half.len() as f64 / width;
            half.push(libm::exp(-0.5 * x * x));
        }
        let bell: Vec<f64> = half.iter().skip(1).rev().chain(&half).copied().collect();
        let power = bell.iter().map(|b| b * b).sum::<f64>().sqrt();
        let mut white: Vec<f64> = bell.iter().map(|_| random.normal()).collect();
        let mut values = Vec::new();
        while (values.len() as f64) * spacing < BEHIND + LONG {
            let sum: f64 = bell.iter().zip(&white).map(|(b, w)| b * w).sum();
            values.push(level * (1.0 + deviation * (sum / power).clamp(-FARTHEST, FARTHEST)));
            white.remove(0);
            white.push(random.normal());
        }
        Self { level, spacing, values }
    }

    /// Factor at a place.
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)] // not negative, and no farther than the list
    pub(crate) fn at(&self, x: f64) -> f64 {
        let along = ((x + BEHIND) / self.spacing).max(0.0);
        let (k, share) = (along as usize, along - along.floor());
        match (self.values.get(k), self.values.get(k + 1)) {
            (Some(a), Some(b)) => a + (b - a) * share,
            _ => self.level,
        }
    }
}
