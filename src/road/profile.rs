//! The heights along a track, and what means over a window need of them.

use super::polyline::Polyline;
use super::waves::{Irregular, Lines, Versine};
use crate::clone_in_place;
use serde::{Deserialize, Serialize};

/// The sum of these; a kind of road fills one of them. The default is level, at height 0.
#[derive(Debug, PartialEq, Default, Serialize, Deserialize)]
pub(super) struct Profile {
    pub(super) polyline: Polyline,
    pub(super) versine: Versine,
    pub(super) irregular: Irregular,
}

clone_in_place!(Profile { polyline, versine, irregular });

impl Profile {
    /// Height, slope and, where there are no edges, curvature at `s`.
    pub(super) fn at(&self, s: f64) -> [f64; 3] {
        let [height, slope] = self.polyline.at(s);
        sum([height, slope, 0.0], self.versine.at(s), self.irregular.at(s))
    }

    /// A height that it nowhere exceeds \[m\]; none where there is an irregular road.
    pub(super) fn highest(&self) -> Option<f64> {
        (self.irregular.len() == 0).then(|| self.polyline.highest() + self.versine.highest())
    }

    /// Mean height over a window of `length` about `s`, its slope and curvature.
    pub(super) fn mean(&self, s: f64, length: f64, filter: &Filter) -> [f64; 3] {
        sum(
            self.polyline.mean(s, length, &filter.phases),
            self.versine.mean(s, length, filter.wave),
            self.irregular.mean(s, &filter.lines),
        )
    }

    /// True if it is finite and its parts fit.
    pub(super) fn is_whole(&self) -> bool {
        self.polyline.is_whole() && self.versine.is_whole() && self.irregular.is_whole()
    }
}

fn sum(a: [f64; 3], b: [f64; 3], c: [f64; 3]) -> [f64; 3] {
    [0, 1, 2].map(|i| a[i] + b[i] + c[i])
}

/// What a window of one length makes of a profile: of its kinks, its waves and its lines.
#[derive(Debug, PartialEq, Default, Serialize, Deserialize)]
pub(super) struct Filter {
    phases: Vec<[f64; 2]>,
    wave: f64,
    lines: Vec<Lines>,
}

clone_in_place!(Filter { phases, wave, lines });

impl Filter {
    /// Of a window of `length` \[m\], not 0, over a profile.
    pub(super) fn new(profile: &Profile, length: f64) -> Self {
        Self {
            phases: profile.polyline.phases(length),
            wave: profile.versine.gain(length),
            lines: profile.irregular.gains(length),
        }
    }

    /// True if [`new`](Self::new) can have made it for this profile.
    pub(super) fn fits(&self, profile: &Profile) -> bool {
        let on_circle = |[cos, sin]: &[f64; 2]| (cos * cos + sin * sin - 1.0).abs() < 1e-9;
        // no mean of a wave is higher than the wave
        let is_gain = |gain: &f64| gain.abs() < 1.0 + 1e-9;
        self.phases.len() == profile.polyline.len()
            && self.phases.iter().all(on_circle)
            && is_gain(&self.wave)
            && self.lines.len() == profile.irregular.len()
            && self.lines.iter().flatten().all(is_gain)
    }
}

impl From<Polyline> for Profile {
    fn from(polyline: Polyline) -> Self {
        Self { polyline, ..Self::default() }
    }
}

impl From<Versine> for Profile {
    fn from(versine: Versine) -> Self {
        Self { versine, ..Self::default() }
    }
}

impl From<Irregular> for Profile {
    fn from(irregular: Irregular) -> Self {
        Self { irregular, ..Self::default() }
    }
}
