//! The bristles as they are kept: stripe by stripe a row, in the order of their places.

use super::Parameters;
use super::stripes::Stripes;
use crate::clone_in_place;
use crate::solver::lanes::LANES;
use serde::{Deserialize, Serialize};

/// Bristles that a stripe has at most.
pub(super) const MAX_PER_STRIPE: usize = 2000;

/// The bristles. Those of a stripe are a row of [`stride`](Self::stride) numbers: first its bristles from the rear to the
/// front, then room for the last four that are worked on at once. The places are the same in all rows. A bristle that is
/// out of contact is relaxed, and its numbers are 0.
#[derive(Debug, PartialEq, Default, Serialize, Deserialize)]
pub struct Bristles {
    /// Bristles of a stripe.
    pub per_stripe: usize,
    /// Place of the first of each row along the patch \[m\] (4.17).
    pub first_place: f64,
    /// Spacings by which the ring of bristles has gone to the front, a whole number.
    pub turned: f64,
    /// The first that may be in contact, and the first behind it that is not, the same in all rows.
    pub window: [usize; 2],
    /// The stripes.
    pub(super) stripes: Stripes,
    /// Lengths of the stripes a step before \[m\].
    pub(super) old_lengths: Vec<f64>,
    /// Logarithms to base 2 of twice the distances from the middle, the same in all rows.
    pub(super) logarithms: Vec<f64>,
    /// Deflections in x \[m\].
    pub deflection_x: Vec<f64>,
    /// Deflections in y \[m\].
    pub deflection_y: Vec<f64>,
    /// Forces on the patch in x \[N\].
    pub force_x: Vec<f64>,
    /// Forces on the patch in y \[N\].
    pub force_y: Vec<f64>,
    /// Pressures \[Pa\].
    pub pressure: Vec<f64>,
    /// 1: sticks, 0: slides or is out of contact.
    pub stick: Vec<f64>,
    /// How much each counts in sums.
    pub share: Vec<f64>,
    /// Sum of the squared deflections, each as far as it counts \[m²\].
    pub stored: f64,
}

clone_in_place!(Bristles {
    per_stripe,
    first_place,
    turned,
    window,
    stripes,
    old_lengths,
    logarithms,
    deflection_x,
    deflection_y,
    force_x,
    force_y,
    pressure,
    stick,
    share,
    stored,
});

impl Bristles {
    /// Relaxed bristles out of contact.
    pub fn new(p: &Parameters) -> Self {
        let (stripes, n) = (p.stripes.max(0) as usize, p.bristles_per_stripe.max(0) as usize);
        let row = || vec![0.0; stripes * (n + LANES)];
        Self {
            per_stripe: n,
            first_place: 0.0,
            turned: 0.0,
            window: [0; 2],
            stripes: Stripes::new(stripes),
            old_lengths: vec![0.0; stripes.next_multiple_of(LANES)],
            logarithms: vec![0.0; n + LANES],
            deflection_x: row(),
            deflection_y: row(),
            force_x: row(),
            force_y: row(),
            pressure: row(),
            stick: row(),
            share: row(),
            stored: 0.0,
        }
    }

    /// Whether there is a number for each stripe and bristle of the parameters.
    pub(super) fn fits(&self, p: &Parameters) -> bool {
        let count = |number: i32| usize::try_from(number).unwrap_or(usize::MAX);
        let (stripes, n) = (count(p.stripes), count(p.bristles_per_stripe));
        let Self { deflection_x, deflection_y, force_x, force_y, pressure, stick, share, .. } = self;
        let rows = [deflection_x, deflection_y, force_x, force_y, pressure, stick, share];
        self.per_stripe == n
            && self.stripes.fits(stripes)
            && self.old_lengths.len() == self.stripes.lengths.len()
            && (n == 0 || Some(self.logarithms.len()) == n.checked_add(LANES))
            && self.window[0] <= self.window[1]
            && self.window[1] <= n
            && rows
                .iter()
                .all(|row| Some(row.len()) == n.checked_add(LANES).and_then(|n| n.checked_mul(stripes)))
    }

    /// Lengths of the stripes \[m\].
    pub fn lengths(&self) -> &[f64] {
        &self.stripes.lengths[..self.stripes.sums.len()]
    }

    /// From a bristle to the one at the same place of the next stripe.
    pub fn stride(&self) -> usize {
        self.per_stripe + LANES
    }

    /// Place of bristle `j` of each row \[m\].
    pub fn place(&self, p: &Parameters, j: usize) -> f64 {
        self.first_place + j as f64 * p.bristle_length
    }

    /// Places the bristles for a spin angle \[rad\] (4.17). Those that leave the ring at one end come in at the other,
    /// relaxed.
    pub(super) fn wind(&mut self, p: &Parameters, spin: f64) {
        let passed = -p.rolling_radius * spin / p.bristle_length;
        let turned = passed.floor();
        self.first_place = (passed - turned) * p.bristle_length - 0.5 * p.ring_length();
        let spacings = turned - std::mem::replace(&mut self.turned, turned);
        if spacings != 0.0 {
            self.pass_on(spacings);
        }
    }

    /// Moves all by so many places to the front.
    fn pass_on(&mut self, spacings: f64) {
        let n = self.per_stripe as f64;
        let [from, to] = self.window;
        let moved = |j: usize| (j as f64 + spacings).clamp(0.0, n) as usize;
        let (new_from, new_to) = (moved(from), moved(to));
        self.window = [new_from, new_to];
        let stride = self.stride();
        let Self { deflection_x, deflection_y, stick, pressure, share, force_x, force_y, .. } = self;
        for rows in [deflection_x, deflection_y, stick] {
            for row in rows.chunks_exact_mut(stride) {
                let kept = new_to - new_from;
                // what falls off the front end falls off behind `from`, what falls off the rear end before it
                let begin = if spacings > 0.0 { from } else { to - kept };
                row.copy_within(begin..begin + kept, new_from);
                relax(row, [from, to], [new_from, new_to]);
            }
        }
        // these are found anew in every step
        for rows in [pressure, share, force_x, force_y] {
            rows.chunks_exact_mut(stride).for_each(|row| row[from..to].fill(0.0));
        }
    }

    /// A stripe leaves the road: its bristles relax within microseconds.
    pub(super) fn lift(&mut self, stripe: usize) {
        let stride = self.stride();
        let [from, to] = self.window.map(|j| stripe * stride + j);
        let Self { deflection_x, deflection_y, stick, pressure, share, force_x, force_y, .. } = self;
        for rows in [deflection_x, deflection_y, stick, pressure, share, force_x, force_y] {
            rows[from..to].fill(0.0);
        }
    }

    /// Takes over a window in which all that touch are, and relaxes what is no longer in it.
    pub(super) fn look_at(&mut self, window: [usize; 2]) {
        let old = std::mem::replace(&mut self.window, window);
        let stride = self.stride();
        let Self { deflection_x, deflection_y, stick, pressure, share, force_x, force_y, .. } = self;
        for rows in [deflection_x, deflection_y, stick, pressure, share, force_x, force_y] {
            rows.chunks_exact_mut(stride).for_each(|row| relax(row, old, window));
        }
    }
}

/// Sets to 0 what is in the old window and not in the new one.
fn relax(row: &mut [f64], [old_from, old_to]: [usize; 2], [from, to]: [usize; 2]) {
    row[old_from..old_to.min(from).max(old_from)].fill(0.0);
    row[old_from.max(to).min(old_to)..old_to].fill(0.0);
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Against the numbers of the bristles on the ring: bristle j of the source is at
    /// -(j + 1) l - R spin, wrapped.
    #[test]
    fn each_bristle_keeps_its_deflection_where_it_goes() {
        let p = Parameters {
            stripes: 2,
            bristles_per_stripe: 7,
            bristle_length: 0.014,
            rolling_radius: 0.3,
            ..Parameters::default()
        };
        let mut bristles = Bristles::new(&p);
        bristles.wind(&p, 0.0);
        // its deflection tells where a bristle was on the ring
        let mut ring: Vec<Option<f64>> = vec![None; 7];
        let at = |x: f64, spin: f64| {
            let along = (-(x + 0.5 * p.ring_length()) - p.rolling_radius * spin) / p.bristle_length;
            (along.round() as i64 - 1).rem_euclid(7) as usize
        };
        bristles.look_at([0, 7]);
        for j in 0..7 {
            let number = at(bristles.place(&p, j), 0.0);
            ring[number] = Some(number as f64 + 1.0);
            for stripe in 0..2 {
                let k = stripe * bristles.stride() + j;
                bristles.deflection_x[k] = number as f64 + 1.0;
            }
        }
        let mut spin = 0.0;
        let mut seen = 0;
        for step in [0.02, 0.03, -0.01, 0.05, -0.2, 0.11, 0.0, 0.04, -0.04] {
            let before: Vec<f64> = (0..7).map(|j| bristles.place(&p, j)).collect();
            spin += step;
            bristles.wind(&p, spin);
            for j in 0..7 {
                let x = bristles.place(&p, j);
                let number = at(x, spin);
                let stayed = before.iter().any(|b| (b - p.rolling_radius * step - x).abs() < 1e-9);
                if !stayed {
                    ring[number] = None;
                }
                for stripe in 0..2 {
                    let deflection = bristles.deflection_x[stripe * bristles.stride() + j];
                    assert_eq!(deflection, ring[number].unwrap_or(0.0), "{spin} {j}");
                }
                seen += usize::from(ring[number].is_some());
            }
        }
        assert!(seen > 10, "{seen}");
        bristles.wind(&p, 1e3);
        assert!(bristles.deflection_x.iter().all(|d| *d == 0.0));
    }
}
