//! What the plan of the ring-and-brush tire refers to by name (Kaden 2015, 4.2).

use super::registry::{Functional, Inversion, Numbers, Registry, Transform};
use super::solve::Unsolved;
use crate::Error;

/// All of it.
pub const REGISTRY: Registry = Registry {
    functionals: &[CONTACT_FORCE, DRIFT, YAW_STIFFNESS],
    transforms: &[SHEAR, LENGTH_FACTOR, SLIDING_FRICTION, STATIC_FRICTION, FALL_AND_STATIC_FRICTION],
    inversions: &[SPRINGS, IDENTITY],
};

/// The plan itself.
pub const PLAN: &str = include_str!("ring_brush.toml");

/// The normal force in the contact of a stationary state: the rim carries the belt (l. 2013, Z_1).
const CONTACT_FORCE: Functional = Functional {
    name: "contact force",
    outputs: &["force_z"],
    inputs: &["belt_mass", "gravity"],
    read: |outputs, inputs| outputs[0] + inputs[0] * inputs[1],
};

/// The belt's yaw on the rim, as the direction of the force on the rim tells it where the patch has no longitudinal force (4.78).
fn yaw(force_x: f64, force_y: f64) -> f64 {
    -(force_x / force_y).atan()
}

/// How much faster the wheel turns than one whose patch has no longitudinal force (4.79): 0 where it has none. The source's slip
/// angle is the opposite of the rig's.
const DRIFT: Functional = Functional {
    name: "slip over that of no longitudinal patch force",
    outputs: &["force_x", "force_y"],
    inputs: &["slip", "slip_angle"],
    read: |outputs, inputs| {
        let alpha = -inputs[1];
        (inputs[0] + 1.0) * alpha.cos() - (alpha + yaw(outputs[0], outputs[1])).cos()
    },
};

/// Aligning moment over that yaw (Z_3).
const YAW_STIFFNESS: Functional = Functional {
    name: "aligning moment over yaw",
    outputs: &["moment_z", "force_x", "force_y"],
    inputs: &[],
    read: |outputs, _| outputs[0] / yaw(outputs[1], outputs[2]),
};

fn value(numbers: &Numbers, name: &str) -> f64 {
    numbers.get(name).copied().unwrap_or(f64::NAN)
}

/// Cross-section radius, and shear stiffness times squared length factor: what straight rolling tells (group 2).
const SHEAR: Transform = Transform {
    name: "shear stiffness times squared length factor",
    assumes: &[],
    size: 2,
    to_model: |sought, known| {
        let factor = value(known, "stripe_length_factor");
        vec![("cross_section_radius", sought[0]), ("bristle_stiffness", sought[1] / (factor * factor))]
    },
    from_model: |known| {
        let factor = value(known, "stripe_length_factor");
        vec![value(known, "cross_section_radius"), value(known, "bristle_stiffness") * factor * factor]
    },
};

/// The length factor, with shear stiffness times its square as it was (group 4).
const LENGTH_FACTOR: Transform = Transform {
    name: "length factor of a known shear stiffness",
    assumes: &[],
    size: 1,
    to_model: |sought, known| {
        let ratio = value(known, "stripe_length_factor") / sought[0];
        let stiffness = value(known, "bristle_stiffness") * ratio * ratio;
        vec![("stripe_length_factor", sought[0]), ("bristle_stiffness", stiffness)]
    },
    from_model: |known| vec![value(known, "stripe_length_factor")],
};

/// Sliding friction at no pressure, and its fall with the pressure as a share of what is admissible (group 7): it falls by
/// [`APART`] up to the highest pressure at least (4.103), and less than would let the force fall with the pressure there. What
/// sticks is not known yet; nothing does.
const SLIDING_FRICTION: Transform = Transform {
    name: "sliding friction",
    assumes: &["friction_static_zero", "friction_static_reference"],
    size: 2,
    to_model: |sought, known| {
        let [least, most] = falls(sought[0], known);
        let reference = sought[0] - (least + sought[1] * (most - least));
        vec![
            ("friction_sliding_zero", sought[0]),
            ("friction_sliding_reference", reference),
            ("friction_static_zero", sought[0] + STICKS),
            ("friction_static_reference", reference + STICKS),
        ]
    },
    from_model: |known| {
        let zero = value(known, "friction_sliding_zero");
        let [least, most] = falls(zero, known);
        vec![zero, (zero - value(known, "friction_sliding_reference") - least) / (most - least)]
    },
};

/// The static friction over the sliding one that is assumed until it is known.
const STICKS: f64 = 0.5;

/// Least and largest fall of the sliding friction between no and the reference pressure.
fn falls(at_zero: f64, known: &Numbers) -> [f64; 2] {
    let share = value(known, "friction_pressure") / value(known, "friction_pressure_scale") / HIGHEST;
    [APART * share, 0.5 * at_zero * share]
}

/// Largest static friction coefficients that are looked for (l. 3912).
const MOST_STATIC: [f64; 2] = [2.0, 2.0];
/// Least distance of coefficients (rho_mu), and of the slope of friction over pressure from 0 (rho_F) (l. 3912).
const APART: f64 = 0.1;
/// The pressure up to which they are meant \[Pa\] (p_max, l. 3926).
const HIGHEST: f64 = 5.23e5;

/// Patch compliance, and static friction in the unit square of what is admissible (4.105).
///
/// Friction is looked for at no pressure and at the highest; both have to be above sliding friction, fall with the pressure, and
/// rise as a force with it (4.103), (4.104).
const STATIC_FRICTION: Transform = Transform {
    name: "static friction in the unit square",
    assumes: &[],
    size: 3,
    to_model: |sought, known| {
        let square = Square::of(known);
        let at_zero = square.at_zero(sought[1]);
        let at_highest = square.at_highest(at_zero, sought[2]);
        let reference = at_zero + (at_highest - at_zero) * square.reference / HIGHEST;
        vec![
            ("patch_compliance_x", sought[0]),
            ("friction_static_zero", at_zero),
            ("friction_static_reference", reference),
        ]
    },
    from_model: |known| {
        let square = Square::of(known);
        let at_zero = value(known, "friction_static_zero");
        let slope = (value(known, "friction_static_reference") - at_zero) / square.reference;
        let at_highest = at_zero + slope * HIGHEST;
        let [low, high] = [square.at_zero(0.0), square.at_zero(1.0)];
        let [least, most] = [square.at_highest(at_zero, 0.0), square.at_highest(at_zero, 1.0)];
        vec![
            value(known, "patch_compliance_x"),
            (at_zero - low) / (high - low),
            (at_highest - least) / (most - least),
        ]
    },
};

/// The same behind how sliding friction falls with the speed, for tires of which it does.
const FALL_AND_STATIC_FRICTION: Transform = Transform {
    name: "fall over speed, and static friction in the unit square",
    assumes: &[],
    size: 4,
    to_model: |sought, known| {
        let mut values = vec![("friction_speed_falloff", sought[0])];
        values.extend((STATIC_FRICTION.to_model)(&sought[1..], known));
        values
    },
    from_model: |known| {
        let mut sought = vec![value(known, "friction_speed_falloff")];
        sought.extend((STATIC_FRICTION.from_model)(known));
        sought
    },
};

/// What bounds static friction.
struct Square {
    /// Sliding friction at no pressure and at the highest.
    sliding: [f64; 2],
    /// Reference pressure of the friction law, with its scale.
    reference: f64,
}

impl Square {
    fn of(known: &Numbers) -> Self {
        let reference = value(known, "friction_pressure") / value(known, "friction_pressure_scale");
        let [zero, at] =
            ["friction_sliding_zero", "friction_sliding_reference"].map(|name| value(known, name));
        Self { sliding: [zero, zero + (at - zero) * HIGHEST / reference], reference }
    }

    fn at_zero(&self, share: f64) -> f64 {
        let most = MOST_STATIC[0].min(2.0 * MOST_STATIC[1] - APART);
        (1.0 - share) * self.sliding[0] + share * most
    }

    fn at_highest(&self, at_zero: f64, share: f64) -> f64 {
        let least = self.sliding[1].max(0.5 * (at_zero + APART));
        let most = MOST_STATIC[1].min(at_zero - APART);
        (1.0 - share) * least + share * most
    }
}

/// Two springs in series, one of them progressive, from two forces and the slope at touch (4.53), (4.55), (4.58).
const SPRINGS: Inversion = Inversion {
    name: "springs in series",
    size: Some(3),
    held: &["deflection"],
    invert: |targets, held, _| {
        let [first, second] = [0, 1].map(|k| value(&held[k], "deflection"));
        let (z1, z2, both) = (targets[0], targets[1], 1.0 / targets[2]);
        // how far the measured curve is above the tangent at touch, as a deflection
        let above = [both * z1 - first, both * z2 - second];
        if let Some(k) = above.iter().position(|d| *d <= 0.0 || !d.is_finite()) {
            return Err(Unsolved::Failed(Error::numeric(format!(
                "the force at {} m behind touch is not above the tangent at touch: the spring curve is not progressive",
                [first, second][k]
            ))));
        }
        let [a, b] = above.map(f64::sqrt);
        let linear = both + (a * second - b * first) / (b * z1 - a * z2);
        let rim = both - linear;
        if !(linear > 0.0 && rim > 0.0) {
            return Err(Unsolved::Failed(Error::numeric(
                "the spring curve asks for a rim stiffness that is not positive: the two forces and the slope at touch contradict the model",
            )));
        }
        let deflection = second - rim * z2;
        let quadratic = above[1] / (linear * deflection * deflection);
        Ok(vec![1.0 / linear, quadratic, 1.0 / rim])
    },
};

/// The target is the parameter (4.87).
const IDENTITY: Inversion =
    Inversion { name: "identity", size: None, held: &[], invert: |targets, _, _| Ok(targets.to_vec()) };
