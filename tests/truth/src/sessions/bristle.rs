//! One bristle: a spring and a damper between belt and road that sticks or slides (10 of the specification).

/// A bristle.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct Bristle {
    /// Deflection: bottom minus top, contact frame \[m\].
    pub(crate) way: [f64; 2],
    pub(crate) sticks: bool,
    pub(crate) touches: bool,
}

/// What it does: force on the patch \[N\] and what its sliding turns into heat \[W\].
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Pull {
    pub(crate) force: [f64; 2],
    pub(crate) heat: f64,
}

impl Bristle {
    /// Out of contact (10.3), with stiffness and damping of the rubber \[N/m, N.s/m\].
    pub(crate) fn release(&mut self, (spring, damper): (f64, f64), dt: f64) {
        let kept = damper / (damper + spring * dt);
        self.way = self.way.map(|a| a * kept);
        (self.sticks, self.touches) = (false, false);
    }

    /// Drags its top with the velocity `v` over the road for `dt`: backward Euler with radial return (10.2). It goes on
    /// sticking up to the force `held`, and sliding down to what `slid` tells for a direction of the pull.
    pub(crate) fn drag(
        &mut self,
        (spring, damper): (f64, f64),
        v: [f64; 2],
        dt: f64,
        held: f64,
        slid: impl Fn([f64; 2]) -> f64,
    ) -> Pull {
        let trial: [f64; 2] = std::array::from_fn(|k| spring * (self.way[k] - dt * v[k]) - damper * v[k]);
        let size = (trial[0] * trial[0] + trial[1] * trial[1]).sqrt();
        let way = if size > 0.0 { trial.map(|w| w / size) } else { [0.0; 2] };
        let slid = slid(way);
        let soft = damper + spring * dt;
        self.touches = true;
        self.sticks = held > 0.0 && size <= if self.sticks { held } else { slid };
        let (force, heat) = if self.sticks {
            (trial, 0.0)
        } else {
            (way.map(|w| w * slid), slid * (size - slid).max(0.0) / soft)
        };
        self.way = std::array::from_fn(|k| (force[k] * dt + damper * self.way[k]) / soft);
        Pull { force, heat }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    // section 15: 1000 N at 1 bar
    const RUBBER: (f64, f64) = (4e4, 0.65);
    const HELD: f64 = 1450.0;
    const SLID: f64 = 1050.0;

    #[test]
    fn breaks_away_when_the_specification_says_and_slides_on_with_less() {
        let mut bristle = Bristle::default();
        let dt = 1e-6;
        let mut broke = None;
        for n in 1..200_000 {
            let t = f64::from(n) * dt;
            let pull = bristle.drag(RUBBER, [-0.3, 0.0], dt, HELD, |_| SLID);
            if bristle.sticks {
                assert!((pull.force[0] - (4e4 * 0.3 * t + 0.65 * 0.3)).abs() < 1e-6);
                assert!(pull.heat == 0.0 && broke.is_none());
            } else {
                broke.get_or_insert(t);
                assert!((pull.force[0] - SLID).abs() < 1e-9);
            }
        }
        let broke = broke.unwrap();
        assert!((broke - 0.120_817_08).abs() < 2.0 * dt, "{broke}");
        assert!((bristle.way[0] - SLID / 4e4).abs() < 1e-9);
        // all that goes in turns into heat: force times speed of the foot
        assert!((bristle.drag(RUBBER, [-0.3, 0.0], dt, HELD, |_| SLID).heat - 0.3 * SLID).abs() < 1e-6);
    }

    #[test]
    fn remembers_whether_it_stuck_and_pulls_against_its_motion() {
        let held_at = |sticks| {
            let mut bristle = Bristle { way: [1200.0 / 4e4, 0.0], sticks, touches: true };
            bristle.drag(RUBBER, [0.0, 0.0], 1e-4, HELD, |_| SLID);
            bristle.sticks
        };
        assert!(held_at(true) && !held_at(false));
        for speed in [1e-3, 1e3] {
            let mut bristle = Bristle::default();
            let pull = bristle.drag(RUBBER, [3.0 * speed, 4.0 * speed], 1e-4, HELD, |_| SLID);
            assert!((pull.force[0] / pull.force[1] - 0.75).abs() < 1e-12 && pull.force[1] < 0.0);
        }
    }
}
