//! A channel with a clock of its own.

use crate::effect::{Call, Effect, Family, Memory, Parameter, Port, Scale};

/// y_m(t) = y(t - d (t - t_0)).
pub const EFFECT: Effect = Effect {
    id: "clock-drift",
    name: "Clock that runs fast or slow",
    family: Family::Sensor,
    port: Port::Output,
    also: &[],
    equation: "y_m(t) = y(t - d (t - t_0))",
    source: "standard engineering knowledge",
    signature: "a delay of one channel that grows with the time since the start of a run",
    confused_with: &[("sensor-delay", "does not grow")],
    targets: &[],
    drivers: &[],
    parameters: &[Parameter::amplitude(
        "error",
        "Time that is lost per time",
        Scale::plain("1"),
        // quartz errs by 1e-4, the oscillators of resistor and capacitor in small loggers by 2 % over their temperatures
        (-0.02, 0.02),
        (-0.03, 0.03),
        // after a hundred periods a thousandth is a tenth of one: what is farther off is found from near it
        &[
            1e-5, 3e-5, -3e-5, 1e-4, -1e-4, 3e-4, -3e-4, 1e-3, -1e-3, 2e-3, -2e-3, 4e-3, -4e-3, 7e-3, -7e-3,
            0.012, -0.012,
        ],
    )],
    apply,
};

fn apply(p: &[f64], memory: &mut Memory, call: &Call<'_>) -> f64 {
    if call.dt <= 0.0 {
        memory.states[0] = call.time;
        memory.past.clear();
    }
    let late = p[0] * (call.time - memory.states[0]);
    if let Some(course) = call.course {
        return if late == 0.0 { call.target } else { course.at(call.time - late) };
    }
    let (before, last) = memory.past.back().copied().unwrap_or((call.time, call.target));
    memory.remember(call.time, call.target, late.max(0.0));
    if late > 0.0 {
        memory.recall(call.time - late)
    } else if late < 0.0 && call.time > before {
        // nobody knows what is ahead: straight on
        call.target - late * ((call.target - last) / (call.time - before))
    } else {
        call.target
    }
}
