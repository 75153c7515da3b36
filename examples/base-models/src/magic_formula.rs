//! The tire of the base models: a Magic Formula of normalised slip, the same for both directions.
//!
//! rho = |(c_x kappa, c_y tan alpha)| / mu,  F = mu F_z sin(C atan(rho / C)), along that vector;
//! M_z = -t F_y / (1 + rho^2) + c_m F_z gamma. A reduced form of Pacejka, Tire and Vehicle Dynamics,
//! section 4.3.1, with E = 0.

use serde::{Deserialize, Serialize};

/// Parameters of the tire.
#[derive(Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct MagicFormula {
    pub friction: f64,
    pub slip_stiffness: f64,
    pub cornering_stiffness: f64,
    pub shape: f64,
    pub trail: f64,
    pub camber_moment: f64,
}

impl MagicFormula {
    /// F_x, F_y \[N\] and M_z \[N m\] of the road on the tire (ISO 8855).
    pub fn forces(&self, slip: f64, slip_angle: f64, camber: f64, load: f64) -> [f64; 3] {
        let load = load.max(0.0);
        let x = self.slip_stiffness * slip;
        let y = -self.cornering_stiffness * libm::tan(slip_angle);
        let length = (x * x + y * y).sqrt();
        let rho = length / self.friction;
        let force = self.friction * load * libm::sin(self.shape * libm::atan(rho / self.shape));
        let per_slip = if length > 1e-9 { force / length } else { load };
        let (fx, fy) = (per_slip * x, per_slip * y);
        [fx, fy, -self.trail * fy / (1.0 + rho * rho) + self.camber_moment * load * camber]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rk4::tests::close;

    const TIRE: MagicFormula = MagicFormula {
        friction: 1.0,
        slip_stiffness: 20.0,
        cornering_stiffness: 15.0,
        shape: 1.4,
        trail: 0.03,
        camber_moment: 0.01,
    };

    #[test]
    fn slopes_peak_and_directions() {
        let [fx, ..] = TIRE.forces(1e-6, 0.0, 0.0, 4000.0);
        close(fx / 1e-6, 20.0 * 4000.0, 1e-3);
        let [_, fy, mz] = TIRE.forces(0.0, 1e-6, 0.0, 4000.0);
        close(fy / 1e-6, -15.0 * 4000.0, 1e-3);
        close(mz / -fy, 0.03, 1e-9);
        // the peak mu F_z where C atan(rho / C) is a right angle
        let peak = 1.4 * (std::f64::consts::FRAC_PI_2 / 1.4).tan() / 20.0;
        close(TIRE.forces(-peak, 0.0, 0.0, 4000.0)[0], -4000.0, 1e-6);
        assert!(TIRE.forces(-1.0, 0.0, 0.0, 4000.0)[0] > -4000.0);
        // combined: the force opposes the slip vector, and is no larger than friction allows
        let [fx, fy, _] = TIRE.forces(-0.3, 0.4_f64.atan(), 0.0, 4000.0);
        close(fx / fy, (20.0 * -0.3) / (-15.0 * 0.4), 1e-12);
        assert!(fx.hypot(fy) < 4000.0);
        assert_eq!(TIRE.forces(0.1, 0.1, 0.1, -5.0), [0.0, 0.0, 0.0]);
    }
}
