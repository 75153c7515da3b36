//! A force that falls with the heat of friction.

use super::operator::{HEAT_KEPT, bounded, remaining, store};
use crate::effect::{Call, Effect, Family, Memory, Parameter, Port, Role, Scale};

/// The heat E leaks and lowers the force: dE/dt = P - E / T. P is the whole loss of the contact where the model tells it:
/// that of sliding alone misses most at small slip.
pub const EFFECT: Effect = Effect {
    id: "frictional-heating",
    name: "Force that falls while friction heats",
    family: Family::Mechanism,
    port: Port::Output,
    also: &[(Port::Parameter, Role::Friction)],
    equation: "F = F_0 (1 - tanh(a E)), dE/dt = |P| - E / T",
    source: "Mavros 2018, 10.1080/00423114.2018.1484147 (thermo-frictional tire model; here one heat store)",
    signature: "a slow loss that goes with the energy turned into heat and comes back in pauses; the order of runs matters",
    confused_with: &[
        ("thermal-softening", "the same with the power from slip and speed"),
        ("sensor-drift", "at rest too"),
    ],
    targets: &[Role::Force],
    drivers: &[Role::FrictionPower],
    parameters: &[
        Parameter::amplitude(
            "loss",
            "Loss per heat",
            Scale::of("1/s", 0, [-1, 0, 0]),
            (0.0, 0.5),
            (-1.0, 1.0),
            &[0.005],
        ),
        Parameter::shape(
            "time",
            "Time in which the heat leaves",
            Scale::plain("s"),
            (1.0, 3000.0),
            (0.5, 3000.0),
            &[3.0, 60.0],
        ),
        HEAT_KEPT,
    ],
    apply,
};

fn apply(p: &[f64], memory: &mut Memory, call: &Call<'_>) -> f64 {
    if p[0] == 0.0 {
        return call.target;
    }
    let heat = store(memory, 0, bounded(call.drivers[0].abs()), p[1], call.dt);
    call.target * remaining(p[0] * heat)
}
