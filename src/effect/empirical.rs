//! Functions without a name: what an effect that is not in the catalogue is modelled by, and what named
//! effects have to beat.

use super::{Call, Effect, Family, Memory, Parameter, Port, Role, Scale};

/// All of them.
pub const EFFECTS: &[Effect] = &[
    function(Port::Output, "empirical-output", "An output depends on a signal", &[]),
    function(Port::Input, "empirical-input", "An input depends on a signal", &[]),
    function(Port::Force, "empirical-force", "A force depends on a signal", &[Role::Force]),
    modulation(),
    history(),
    course(),
    schedule(),
];

/// True for effects without a name.
pub fn is(effect: &Effect) -> bool {
    EFFECTS.iter().any(|e| e.id == effect.id)
}

const SIGNATURE: &str = "whatever the function shows";
const SOURCE: &str = "none: a function fitted to the recordings";

/// Amplitude of one term: target scale over a power of the driver's.
const fn term(name: &'static str, description: &'static str, power: i8) -> Parameter {
    Parameter {
        name,
        description,
        scale: Scale::of("1", 1, [-power, 0, 0]),
        off: Some(0.0),
        plausible: (-3.0, 3.0),
        search: (-3.0, 3.0),
        probes: &[0.01],
        of_session: false,
    }
}

const THRESHOLD: Parameter = Parameter {
    name: "width",
    description: "Size of the signal at which the step-like term has three quarters of its height",
    scale: Scale::of("1", 0, [1, 0, 0]),
    off: None,
    plausible: (0.01, 1.0),
    search: (0.01, 1.0),
    probes: &[0.15],
    of_session: false,
};

const POLYNOMIAL: &[Parameter] = &[
    term("linear", "Term that is proportional to the signal", 1),
    term("square", "Term with its square", 2),
    term("cube", "Term with its cube", 3),
    term("magnitude", "Term with its magnitude", 1),
    term("step", "Term with its sign", 0),
    THRESHOLD,
];

const fn function(port: Port, id: &'static str, name: &'static str, targets: &'static [Role]) -> Effect {
    Effect {
        id,
        name,
        family: Family::Mechanism,
        port,
        also: &[],
        equation: "y + a x + b x^2 + c x^3 + d |x| + e tanh(x / w)",
        source: SOURCE,
        signature: SIGNATURE,
        confused_with: &[],
        targets,
        drivers: &[Role::Other],
        parameters: POLYNOMIAL,
        apply: |p, _, call| {
            let x = call.drivers[0];
            call.target + polynomial(p, x)
        },
    }
}

fn polynomial(p: &[f64], x: f64) -> f64 {
    let step = if p[4] == 0.0 { 0.0 } else { p[4] * libm::tanh(x / p[5]) };
    p[0] * x + p[1] * x * x + p[2] * x * x * x + p[3] * x.abs() + step
}

const fn factor(name: &'static str, description: &'static str, power: i8) -> Parameter {
    Parameter {
        name,
        description,
        scale: Scale::of("1", 0, [-power, 0, 0]),
        off: Some(0.0),
        plausible: (-2.0, 2.0),
        search: (-2.0, 2.0),
        probes: &[0.01],
        of_session: false,
    }
}

const FACTORS: &[Parameter] = &[
    factor("linear", "Term that is proportional to the signal", 1),
    factor("square", "Term with its square", 2),
    factor("magnitude", "Term with its magnitude", 1),
];

const fn modulation() -> Effect {
    Effect {
        id: "empirical-parameter",
        name: "A parameter depends on a signal",
        family: Family::Mechanism,
        port: Port::Parameter,
        also: &[],
        equation: "p (1 + a x + b x^2 + c |x|)",
        source: SOURCE,
        signature: SIGNATURE,
        confused_with: &[],
        targets: &[],
        drivers: &[Role::Other],
        parameters: FACTORS,
        apply: |p, _, call| {
            let x = call.drivers[0];
            let relative = p[0] * x + p[1] * x * x + p[2] * x.abs();
            if relative == 0.0 { call.target } else { call.target * (1.0 + relative).max(0.02) }
        },
    }
}

/// Time constants of the memory, over the longest.
const MEMORY: [f64; 3] = [0.02, 0.15, 1.0];

const LAGGED: &[Parameter] = &[
    term("short", "Term with the signal behind 0.02 of the time", 1),
    term("medium", "Term with the signal behind 0.15 of the time", 1),
    term("long", "Term with the signal behind the time", 1),
    Parameter::shape(
        "time",
        "Longest time constant of the memory",
        Scale::own_time(1),
        (0.3, 3.0),
        (0.3, 3.0),
        &[1.0],
    ),
];

const fn history() -> Effect {
    Effect {
        id: "empirical-history",
        name: "An output depends on the past of a signal",
        family: Family::Mechanism,
        port: Port::Output,
        also: &[],
        equation: "y + a x_1 + b x_2 + c x_3, x_i behind first-order lags of 0.02 T, 0.15 T and T",
        source: SOURCE,
        signature: SIGNATURE,
        confused_with: &[],
        targets: &[],
        drivers: &[Role::Other],
        parameters: LAGGED,
        apply: |p, memory: &mut Memory, call: &Call<'_>| {
            let x = call.drivers[0];
            let mut sum = 0.0;
            for (i, tau) in MEMORY.iter().enumerate() {
                sum += p[i] * (memory.lag(2 * i, x, tau * p[3], call.dt) - x);
            }
            call.target + sum
        },
    }
}

const fn schedule() -> Effect {
    Effect {
        id: "empirical-schedule",
        name: "A parameter changes over the run",
        family: Family::Mechanism,
        port: Port::Parameter,
        also: &[],
        equation: "p (1 + a t + b t^2), t since the start",
        source: SOURCE,
        signature: SIGNATURE,
        confused_with: &[],
        targets: &[],
        drivers: &[],
        parameters: GROWTH,
        apply: |p, memory: &mut Memory, call: &Call<'_>| {
            memory.states[0] += call.dt;
            let t = memory.states[0];
            let growth = p[0] * t + p[1] * t * t;
            if growth == 0.0 { call.target } else { call.target * (1.0 + growth).max(0.02) }
        },
    }
}

const GROWTH: &[Parameter] = &[
    Parameter {
        name: "growth",
        description: "Relative growth per time",
        scale: Scale::own_time(-1),
        off: Some(0.0),
        plausible: (-1.0, 1.0),
        search: (-1.0, 1.0),
        probes: &[0.001],
        of_session: false,
    },
    Parameter {
        name: "curve",
        description: "Relative growth per time squared",
        scale: Scale::own_time(-2),
        off: Some(0.0),
        plausible: (-1.0, 1.0),
        search: (-1.0, 1.0),
        probes: &[0.0001],
        of_session: false,
    },
];

const OVER_TIME: &[Parameter] = &[
    Parameter {
        name: "growth",
        description: "Relative growth per time",
        scale: Scale::own_time(-1),
        off: Some(0.0),
        plausible: (-1.0, 1.0),
        search: (-1.0, 1.0),
        probes: &[0.001],
        of_session: false,
    },
    Parameter {
        name: "curve",
        description: "Relative growth per time squared",
        scale: Scale::own_time(-2),
        off: Some(0.0),
        plausible: (-1.0, 1.0),
        search: (-1.0, 1.0),
        probes: &[0.0001],
        of_session: false,
    },
    Parameter {
        name: "drift",
        description: "Change per time",
        scale: Scale::of("1", 1, [0; 3]).per_time(1),
        off: Some(0.0),
        plausible: (-1.0, 1.0),
        search: (-1.0, 1.0),
        probes: &[0.001],
        of_session: false,
    },
];

const fn course() -> Effect {
    Effect {
        id: "empirical-course",
        name: "An output changes over the run",
        family: Family::Mechanism,
        port: Port::Output,
        also: &[],
        equation: "y (1 + a t + b t^2) + c t, t since the start",
        source: SOURCE,
        signature: SIGNATURE,
        confused_with: &[],
        targets: &[],
        drivers: &[],
        parameters: OVER_TIME,
        apply: |p, memory: &mut Memory, call: &Call<'_>| {
            memory.states[0] += call.dt;
            let t = memory.states[0];
            let growth = p[0] * t + p[1] * t * t;
            let changed = if growth == 0.0 { call.target } else { call.target * (1.0 + growth) };
            changed + p[2] * t
        },
    }
}
