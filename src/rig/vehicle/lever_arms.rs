//! The lever arms of the forces of a tire about the steering axis, as the source prints them (6.17 to 6.27).
//!
//! The vehicle does not use them: there all forces attack where they attack. They are what an engineer reads off an axle, and what the
//! vectors are tested with.

/// How the steering axis of a left wheel lies.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct SteeringAxis {
    /// Inclination of the kingpin: its top leans inward \[rad\].
    pub inclination: f64,
    /// Caster angle: its top leans backward \[rad\].
    pub caster: f64,
    /// The axis at the height of the wheel's centre lies so far behind it \[m\].
    pub caster_offset: f64,
    /// Where it meets the road it lies so far inside of the wheel's plane \[m\].
    pub scrub_radius: f64,
}

/// Lever arms for a loaded radius.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct LeverArms {
    /// n_k: the axis meets the road so far before the wheel's centre (6.17) \[m\].
    pub trail: f64,
    /// r_SK: of the lateral force (6.19) \[m\].
    pub lateral: f64,
    /// r_b: of the force along the wheel, at the road (6.22) \[m\].
    pub longitudinal: f64,
    /// r_RL: of the wheel load (6.26), with cos of the inclination once: the square as printed is 0.6 to 5 % too small \[m\].
    pub vertical: f64,
}

impl SteeringAxis {
    /// Lever arms at a loaded radius \[m\], where the force of the contact attacks `behind` and `inside` of the point below the wheel's
    /// centre \[m\]: n_R and r_R.
    pub fn lever_arms(&self, loaded_radius: f64, behind: f64, inside: f64) -> LeverArms {
        let Self { inclination, caster, caster_offset, scrub_radius } = *self;
        let ((sin_s, cos_s), (sin_t, cos_t)) = (libm::sincos(inclination), libm::sincos(caster));
        let trail = loaded_radius * sin_t / cos_t - caster_offset;
        LeverArms {
            trail,
            lateral: (trail + behind) * cos_t,
            longitudinal: (scrub_radius - inside) * cos_s,
            vertical: cos_s * sin_t * (scrub_radius + loaded_radius * sin_s / cos_s)
                - sin_s * cos_t * caster_offset,
        }
    }

    /// Moment about the axis of a left wheel that turns it outward \[N.m\], from forces of the road on the tire: backward, inward
    /// and upward \[N\] ((6.20), (6.24) with the lever of (6.22), (6.25); the load's turns it inward here).
    pub fn moment(&self, arms: &LeverArms, [backward, inward, upward]: [f64; 3]) -> f64 {
        let (cos_s, cos_t) = (libm::cos(self.inclination), libm::cos(self.caster));
        inward * cos_s * arms.lateral + backward * cos_t * arms.longitudinal - upward * arms.vertical
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mechanics::cross;
    use nalgebra::Vector3;

    fn axis(inclination: f64, caster: f64) -> SteeringAxis {
        SteeringAxis {
            inclination: inclination.to_radians(),
            caster: caster.to_radians(),
            caster_offset: 0.012,
            scrub_radius: -0.015,
        }
    }

    /// The moment of the force about the axis itself, left wheel, x forward, y outward.
    fn exact(
        axis: &SteeringAxis,
        radius: f64,
        [behind, inside]: [f64; 2],
        [backward, inward, upward]: [f64; 3],
    ) -> f64 {
        let along = Vector3::new(-axis.caster.tan(), -axis.inclination.tan(), 1.0).normalize();
        let meets = Vector3::new(radius * axis.caster.tan() - axis.caster_offset, -axis.scrub_radius, 0.0);
        let attacks = Vector3::new(-behind, -inside, 0.0);
        along.dot(&cross(&(attacks - meets), &Vector3::new(-backward, -inward, upward)))
    }

    #[test]
    fn printed_numbers_come_out() {
        let axis = axis(10.0, 8.0);
        let arms = axis.lever_arms(0.32, 0.0, 0.0);
        // the specification's numbers, from an independent program
        for (got, expected) in [
            (arms.trail, 0.03297),
            (arms.lateral, 0.03265),
            (arms.longitudinal, -0.01477),
            (arms.vertical, 0.003615),
        ] {
            assert!((got - expected).abs() < 1e-5, "{got} {expected}");
        }
        // -15 mm and -10 mm (6.23)
        let moved = axis.lever_arms(0.32, 0.0, 0.010);
        assert!((moved.longitudinal + 0.025 * 10.0_f64.to_radians().cos()).abs() < 1e-12);
        let braking = |arms: &LeverArms| axis.moment(arms, [7000.0, 0.0, 0.0]);
        assert!((braking(&arms) + 102.0).abs() < 1.0 && (braking(&moved) + 171.0).abs() < 1.0);
        // both forms of (6.18) are the same
        let both = 0.32 * axis.caster.sin() - axis.caster_offset * axis.caster.cos();
        assert!((arms.lateral - both).abs() < 1e-15);
    }

    #[test]
    fn printed_levers_are_the_vectors_to_a_thousandth() {
        for inclination in [0.0, 6.0, 10.0, 14.0] {
            for caster in [0.0, 4.0, 8.0] {
                let axis = axis(inclination, caster);
                for places in [[0.0, 0.0], [0.03, 0.01]] {
                    let arms = axis.lever_arms(0.32, places[0], places[1]);
                    for forces in [[7000.0, 0.0, 0.0], [0.0, 2000.0, 0.0]] {
                        let (printed, exact) =
                            (axis.moment(&arms, forces), exact(&axis, 0.32, places, forces));
                        assert!(
                            (printed - exact).abs() < 1e-3 * exact.abs().max(1e-3 * 7000.0),
                            "{inclination} {caster}: {printed} {exact}"
                        );
                    }
                }
                let arms = axis.lever_arms(0.32, 0.0, 0.0);
                if arms.vertical.abs() > 1e-3 {
                    let forces = [0.0, 0.0, 5000.0];
                    let ratio = axis.moment(&arms, forces) / exact(&axis, 0.32, [0.0; 2], forces);
                    assert!((ratio - 1.0).abs() < 1.5e-3, "{inclination} {caster}: {ratio}");
                }
            }
        }
    }
}
