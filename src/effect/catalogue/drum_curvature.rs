//! A contact on a drum: shorter than on a flat road.
//!
//! Between a tire of radius r and a drum of radius R (from outside) the gap under an undeformed tire opens with the
//! curvature 1/r + 1/R = (1 + c) / r, c = r / R: at the deflection d the half length of the contact is
//! a = sqrt(2 r d / (1 + c)). An elastic foundation presses with F ~ d a, a sphere of Hertz with F ~ d^(3/2) (r / (1 + c))^(1/2):
//! the same power of 1 + c. Bristles of a brush carry 2 k a^2 per slip, and slide where what they carry is more than
//! friction times pressure. Only rolling resistance is higher on a drum, because the tire bends more.

use crate::effect::{Call, Effect, Family, Memory, Parameter, Port, Role, Scale};

/// What presses, at a given deflection: F / sqrt(1 + c).
pub const EFFECT: Effect = Effect {
    id: "drum-curvature",
    name: "Drum instead of a flat road",
    family: Family::Tire,
    port: Port::Output,
    also: &[],
    equation: "Fz = F_0 / sqrt(1 + c), c = r / R; at the same deflection",
    source: "derived: contact of curvature 1/r + 1/R on an elastic foundation; Hertz' sphere has the same factor",
    signature: "a constant factor on the load at each deflection, below 1 on a drum",
    confused_with: CONFUSED,
    targets: &[Role::Load],
    drivers: &[],
    parameters: &[RATIO],
    apply: |p, _: &mut Memory, call| {
        if p[0] == 0.0 { call.target } else { call.target * shorter(p[0]) }
    },
};

/// What slip makes, at a given deflection: the cornering stiffness falls with the square of the length, what slides with
/// the load. Which of both it is tells the share of the friction that is used. Where all slides no force tells the slip: it is
/// taken where all begins to slide, and the force is up to (1 - q)^3 too low, 0.3 % on a drum of 1.7 m.
pub const BY_SLIP: Effect = Effect {
    equation: "F = F_0 q g(q s) / g(s), g(s) = 1 - (1 - s)^3, q = 1 / sqrt(1 + c), g(s) = min(1, |F_0| / (m |Fz|)); at the same deflection",
    source: "derived: brush of parabolic pressure whose length shrinks with q, Fz that of the flat road; small slip: F_0 / (1 + c)",
    signature: "less lateral and driving force at the same slip and deflection: by 1 / (1 + c) at small slip, by its root where all slides",
    targets: &[Role::LateralForce, Role::LongitudinalForce],
    drivers: &[Role::Load],
    parameters: &[
        RATIO,
        Parameter::shape(
            "friction",
            "Force over load where all slides",
            Scale::of("1", 1, [-1, 0, 0]),
            (0.3, 20.0),
            (0.3, 20.0),
            &[2.0],
        ),
    ],
    apply: by_slip,
    ..EFFECT
};

/// The same at a given load: the tire sinks in further, C ~ a^2 ~ (1 + c)^(-2/3), and what slides is as before. For a
/// brush that is the same as less slip.
pub const AT_LOAD: Effect = Effect {
    port: Port::Input,
    equation: "s = s_0 (1 + c)^(-2/3), c = r / R; at the same load",
    source: "derived: brush of parabolic pressure on an elastic foundation: F ~ d^(3/2) (1 + c)^(-1/2), a^2 ~ d / (1 + c)",
    signature: "less cornering and slip stiffness at the same load; what slides is right",
    targets: &[Role::SlipAngle, Role::Slip],
    parameters: &[Parameter { name: "radius_ratio_at_load", ..RATIO }],
    apply: |p, _: &mut Memory, call| {
        if p[0] == 0.0 { call.target } else { call.target * libm::pow(opened(p[0]), -2.0 / 3.0) }
    },
    ..EFFECT
};

/// What rolling costs: sqrt(1 + c) times as much. Of a longitudinal force as much counts as rolling resistance as there
/// can be of it.
pub const ROLLING: Effect = Effect {
    equation: "F = F_0 + (sqrt(1 + c) - 1) min(max(F_0, -f |Fz|), f |Fz|), c = r / R",
    source: "Clark's form, as in ISO 28580; Freudenmann, Unrau, El-Haji 2009, TST 37(4):254-278 (rolling resistance on drums; they find the form in need of an upgrade)",
    signature: "more rolling resistance of a wheel that rolls freely",
    targets: &[Role::LongitudinalForce],
    drivers: &[Role::Load],
    parameters: &[
        RATIO,
        Parameter::shape(
            "resistance",
            "Largest force over load that is rolling resistance and not drive or brake",
            Scale::of("1", 1, [-1, 0, 0]),
            (0.1, 5.0),
            (0.1, 5.0),
            &[2.0],
        ),
    ],
    apply: |p, _: &mut Memory, call| {
        if p[0] == 0.0 {
            return call.target;
        }
        let most = (p[1] * call.drivers[0]).abs();
        call.target + (opened(p[0]).sqrt() - 1.0) * call.target.clamp(-most, most)
    },
    ..EFFECT
};

const CONFUSED: &[(&str, &str)] = &[
    ("sensor-gain", "the same for every force on that channel; a known weight tells"),
    ("pressure-dependent-friction", "changes with the pressure"),
    ("load-sensitivity", "changes with the load"),
    (
        "rolling-resistance",
        "on a drum it rises by sqrt(1 + r / R), while load and side force fall: a second drum tells",
    ),
];

const RATIO: Parameter = Parameter::amplitude(
    "radius_ratio",
    "Radius of the tire over that of the drum; negative if the model is on the drum, or in one",
    Scale::plain("1"),
    (-0.4, 0.9),
    (-0.6, 2.0),
    &[0.02],
);

/// 1 + c; an inner drum is larger than the tire.
fn opened(ratio: f64) -> f64 {
    (1.0 + ratio).max(1e-3)
}

/// Length of the contact over that on a flat road, at the same deflection.
fn shorter(ratio: f64) -> f64 {
    1.0 / opened(ratio).sqrt()
}

fn by_slip(p: &[f64], _memory: &mut Memory, call: &Call<'_>) -> f64 {
    if p[0] == 0.0 {
        return call.target;
    }
    let (length, most) = (shorter(p[0]), (p[1] * call.drivers[0]).abs());
    let used = if call.target.abs() < most { call.target.abs() / most } else { 1.0 };
    // slip over that at which all slides, on the flat road and on the drum
    let flat = 1.0 - libm::cbrt(1.0 - used);
    let drum = length * flat;
    // g(drum) / g(flat), without a quotient of nothings
    let top = if drum < 1.0 { length * (3.0 - 3.0 * drum + drum * drum) } else { 1.0 / flat };
    call.target * length * (top / (3.0 - 3.0 * flat + flat * flat))
}
