//! A wheel that leaves the road, seen by the motion and not only by the load cell.

use crate::effect::{Call, Effect, Family, Memory, Parameter, Port, Role, Scale};

/// The road is taken up to where the load is zero, as long as it would be negative.
pub const EFFECT: Effect = Effect {
    id: "lift-off",
    name: "Wheel that leaves the road",
    family: Family::Tire,
    port: Port::Input,
    also: &[],
    equation: "h = h_0 + a d, d = max(0, -F_s / k), F_s = Fz - k a d, from the last two loads: the load without the lift",
    source: "standard engineering knowledge",
    signature: "after a crest the wheel flies, and the motion that follows is another one; no load is negative",
    confused_with: &[
        ("loss-of-contact", "only the load cell is clipped, the motion is right"),
        ("bump-stop", "on the side of large deflections"),
    ],
    targets: &[Role::Position],
    drivers: &[Role::Load],
    parameters: &[
        Parameter::amplitude(
            "share",
            "How much of the lacking height is taken: 1 when it is there",
            Scale::plain("1"),
            (0.3, 1.3),
            (-0.5, 1.5),
            &[0.1],
        ),
        Parameter::shape(
            "stiffness",
            "Stiffness between height and load",
            Scale::of("1", -1, [1, 0, 0]),
            (0.01, 100.0),
            (0.02, 50.0),
            &[0.3, 1.0, 3.0],
        ),
    ],
    apply,
};

fn apply(p: &[f64], memory: &mut Memory, call: &Call<'_>) -> f64 {
    if p[0] == 0.0 || p[1] <= 0.0 {
        return call.target;
    }
    let [height, seen, alone] = [memory.states[0], memory.states[1], memory.states[2]];
    // the driver runs on from the last two loads: 2 F - F_last; the load now follows from the one before
    let (now, last) = if call.dt > 0.0 {
        let now = 0.5 * (call.drivers[0] + seen);
        (now, alone)
    } else {
        (call.drivers[0], call.drivers[0])
    };
    // without the lift the load is smooth, and runs straight on
    let now_alone = if call.dt > 0.0 { now - p[1] * p[0] * height } else { now };
    let next = 2.0 * now_alone - last;
    memory.states[0] = (-next / p[1]).max(0.0);
    memory.states[1] = now;
    memory.states[2] = now_alone;
    call.target + p[0] * memory.states[0]
}
