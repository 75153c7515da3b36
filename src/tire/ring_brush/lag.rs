//! The lag of the patch's deformation behind its loads (4.27).

use super::{Loads, Parameters};
use serde::{Deserialize, Serialize};

/// Lagged loads. They shift and twist the patch, which loads the bristles that stick, which load the patch: a loop that
/// is the faster the shorter the lag and the softer the carcass. So that no step is too long for it, a step is exact for
/// how fast it would settle if all bristles stuck (`decay`); what else changes the rates is what did in the step
/// before.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct Lag {
    /// Lagged loads.
    pub lagged: Loads<f64>,
    /// Their rates.
    pub rates: Loads<f64>,
    /// How the rates changed over the last step beside their decay, per second.
    drive: Loads<f64>,
}

impl Lag {
    /// Loads that have long been the same.
    pub fn at_rest(loads: &Loads<f64>) -> Self {
        Self { lagged: *loads, ..Self::default() }
    }

    /// How fast the rates would fall in a step of `dt` if all bristles stuck \[1/s\], on stripes with these places and
    /// lengths.
    ///
    /// A step that has moved bristles by its length times their velocity has loaded them with spring and damper. With
    /// twice the damper's part the loop is stable for any step, lag and compliance, whatever share of the bristles
    /// sticks and however fast they pass: so say the eigenvalues of the linear loop.
    pub(super) fn decay(p: &Parameters, places: &[f64], lengths: &[f64], dt: f64) -> Loads<f64> {
        let damper = if dt > 0.0 { 2.0 * p.bristle_damping / dt } else { 0.0 };
        let per_length = (p.bristle_stiffness + damper) / p.bristle_length;
        let (mut length, mut lever) = (0.0, 0.0);
        for (y, own) in places.iter().zip(lengths) {
            length += own;
            lever += own * (own * own / 12.0 + y * y);
        }
        let of = |compliance: f64, sum: f64, lag: f64| (1.0 + compliance * per_length * sum) / lag;
        Loads {
            force_x: of(p.patch_compliance_x, length, p.patch_lag_x),
            force_y: of(p.patch_compliance_y, length, p.patch_lag_y),
            moment_z: of(p.patch_compliance_twist, lever, p.patch_lag_twist),
        }
    }

    /// Means of the rates over a step: exact for rates that decay like this and are driven evenly.
    pub(super) fn means(&self, decay: &Loads<f64>, dt: f64) -> Loads<f64> {
        if dt <= 0.0 {
            return self.rates;
        }
        Loads::each(|of| {
            let (rate, settled, decay) = (of(&self.rates), of(&self.drive) / of(decay), of(decay));
            settled - (rate - settled) * libm::expm1(-decay * dt) / (decay * dt)
        })
    }

    /// Lagged loads after `seconds` with these rates.
    pub(super) fn ahead(&self, rates: &Loads<f64>, seconds: f64) -> Loads<f64> {
        Loads::each(|of| of(&self.lagged) + seconds * of(rates))
    }

    /// Takes over what a step that was made with the mean rates `means` has come to, and the loads of the patch there.
    pub(super) fn follow(
        &mut self,
        p: &Parameters,
        loads: &Loads<f64>,
        means: &Loads<f64>,
        decay: &Loads<f64>,
        dt: f64,
    ) {
        // where the bristles have been moved to, neither more nor less: what they carry is then that of the shift
        self.lagged = self.ahead(means, dt);
        let lags = Loads { force_x: p.patch_lag_x, force_y: p.patch_lag_y, moment_z: p.patch_lag_twist };
        let rates = Loads::each(|of| (of(loads) - of(&self.lagged)) / of(&lags));
        if dt > 0.0 {
            let change = |of: fn(&Loads<f64>) -> f64| (of(&rates) - of(&self.rates)) / dt;
            self.drive = Loads::each(|of| change(of) + of(decay) * of(means));
        }
        self.rates = rates;
    }
}

impl Loads<f64> {
    /// Each of the three from the same of others.
    fn each(from: impl Fn(fn(&Self) -> f64) -> f64) -> Self {
        Self { force_x: from(|l| l.force_x), force_y: from(|l| l.force_y), moment_z: from(|l| l.moment_z) }
    }
}
