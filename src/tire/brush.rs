//! A brush with a parabolic pressure in one direction (Gim; S. Y. Oh 2017, 2-43 to 2-53) whose slip is given.

/// The share of the contact that adheres at a slip (2-50), from where the stress of bristles meets that of friction:
/// 1 - C S / (3 mu F), not below 0. Of a slip in two directions C S is the length of both. This closure is not printed; it makes both forms of (2-49) the same.
pub(super) fn adhesion(stiffness: f64, slip: f64, friction: f64) -> f64 {
    if friction <= 0.0 {
        return 0.0;
    }
    (1.0 - stiffness * slip.abs() / (3.0 * friction)).max(0.0)
}

/// Force of the brush (2-49, 2-53) \[N\] at a slip, with the sign of the slip: `stiffness` is the slope at no slip \[N\],
/// `friction` the most that friction takes, mu F \[N\], and `adhering` the share of the contact that adheres.
pub(super) fn brush_force(stiffness: f64, slip: f64, friction: f64, adhering: f64) -> f64 {
    let l = adhering;
    let force = stiffness * slip.abs() * l * l + friction * (1.0 - l * l * (3.0 - 2.0 * l));
    force.copysign(slip)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// mu of (4-63) at the printed values.
    fn friction(slip: f64) -> f64 {
        (0.94 + slip * (0.85 - 0.94)) * 6504.03
    }

    /// The specification's check 14.
    #[test]
    fn forces_are_those_of_the_table() {
        let rows = [
            (5000.0, 0.01, 49.864),
            (5000.0, 0.05, 246.592),
            (5000.0, 0.065, 319.240),
            (5000.0, 0.2, 945.444),
            (65e3, 0.01, 627.215),
            (65e3, 0.1, 4451.599),
            (65e3, 0.5, 5821.107),
        ];
        for (stiffness, slip, expected) in rows {
            let most = friction(slip);
            let force = brush_force(stiffness, -slip, most, adhesion(stiffness, slip, most));
            assert!((force + expected).abs() < 6e-4, "{stiffness} {slip}: {force}");
        }
    }

    /// Both printed forms of (2-49), the slope at no slip, and the end of adhesion.
    #[test]
    fn both_forms_agree_and_end_at_the_friction() {
        let (stiffness, most) = (65e3, 6000.0);
        let critical = 3.0 * most / stiffness;
        for k in 0..=20 {
            let slip = critical * f64::from(k) / 20.0;
            let s = slip / critical;
            let first = 3.0 * most * s * (1.0 - s + s * s / 3.0);
            let force = brush_force(stiffness, slip, most, adhesion(stiffness, slip, most));
            assert!((force - first).abs() < 1e-9, "{slip}");
        }
        let slope = brush_force(stiffness, 1e-8, most, adhesion(stiffness, 1e-8, most)) / 1e-8;
        assert!((slope / stiffness - 1.0).abs() < 1e-6);
        assert_eq!(brush_force(stiffness, 2.0, most, adhesion(stiffness, 2.0, most)), most);
        assert_eq!(brush_force(stiffness, 1.0, 0.0, adhesion(stiffness, 1.0, 0.0)), 0.0);
    }
}
