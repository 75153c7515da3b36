//! What of a tire and its track can be other than the model has it.

/// What of the patch is other than the model has it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Oddness {
    /// Factor on all friction.
    pub(crate) friction: f64,
    /// Share of the sliding friction that is lost at high sliding speed, and the speed at which two thirds of it are
    /// \[m/s\].
    pub(crate) fall: (f64, f64),
    /// Share by which sliding friction is larger where the tread slides forward, and smaller backward.
    pub(crate) nap: f64,
    /// Factor on the vertical spring of the belt.
    pub(crate) stiffness: f64,
    /// Angle by which the tread runs askew on the belt, in the sense of its rotation \[rad\].
    pub(crate) ply: f64,
    /// Angle of the cone that the tread is \[rad\].
    pub(crate) cone: f64,
}

impl Default for Oddness {
    fn default() -> Self {
        Self { friction: 1.0, fall: (0.0, 1.0), nap: 0.0, stiffness: 1.0, ply: 0.0, cone: 0.0 }
    }
}

impl Oddness {
    /// Factor on sliding friction of a bristle whose top moves with `v` over the road and which is pulled this way, a
    /// direction: against that its foot slides.
    pub(crate) fn sliding(&self, v: [f64; 2], way: [f64; 2]) -> f64 {
        let mut factor = 1.0 - self.nap * way[0];
        if self.fall.0 != 0.0 {
            // what slides for more than a moment slides as fast as its top moves
            let speed = (v[0] * v[0] + v[1] * v[1]).sqrt();
            factor *= 1.0 + self.fall.0 * libm::expm1(-speed / self.fall.1);
        }
        factor
    }
}
