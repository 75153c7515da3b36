//! Cases: reset, going back, and states as bytes.

use super::*;

/// A run with the start values of all variables.
pub(super) fn plain_run(lab: &Lab<'_>, unit: &mut Unit<'_>) -> Option<Bits> {
    if !lab.initialize(unit) {
        return None;
    }
    lab.advance(unit, 0, STEPS, false)
}

pub(super) fn reset(lab: &Lab<'_>) {
    let Some(mut unit) = lab.unit() else { return };
    let Some(fresh) = plain_run(lab, &mut unit) else { return };
    let reset = |unit: &mut Unit<'_>| {
        let status = unit.reset();
        if status > 1 {
            lab.reporter.error("M5", format!("fmi2Reset between steps returned {}", word(status)));
        }
        status <= 1
    };
    if !reset(&mut unit) {
        return;
    }
    // Everything that can be changed is: parameters a little, then the inputs.
    for v in lab.variables().iter().filter(|v| v.is_real() && v.causality == Causality::Parameter) {
        let value = start_of(v) * (1.0 + 1e-6);
        let fits = v.min.is_none_or(|min| value >= min) && v.max.is_none_or(|max| value <= max);
        if fits && unit.set_real(v.reference, value) > 1 && !reset(&mut unit) {
            return;
        }
    }
    if !lab.initialize(&mut unit) || lab.advance(&mut unit, 0, STEPS, true).is_none() {
        lab.unable();
    }
    if !reset(&mut unit) {
        return;
    }
    match plain_run(lab, &mut unit) {
        None => lab.reporter.error("M5", "after fmi2Reset the FMU does not run any more"),
        Some(again)
            if again != fresh
                && lab.repeatable(&fresh, || lab.unit().and_then(|mut unit| plain_run(lab, &mut unit))) =>
        {
            lab.reporter.error(
                "M5",
                format!(
                    "after fmi2Reset the FMU runs otherwise than when it was new: {}",
                    differ(lab, &fresh, &again)
                ),
            );
        }
        Some(_) => {}
    }
}

/// Which variable differs first, and when.
pub(super) fn differ(lab: &Lab<'_>, a: &[u64], b: &[u64]) -> String {
    let read: Vec<&VariableInfo> = lab
        .variables()
        .iter()
        .filter(|v| matches!(v.causality, Causality::Output | Causality::Local) && v.kind != Kind::Text)
        .collect();
    let Some(at) = a.iter().zip(b).position(|(x, y)| x != y) else { return "there are more values".into() };
    let v = read[at % read.len().max(1)];
    let show = |bits: u64| if v.is_real() { format!("{:?}", f64::from_bits(bits)) } else { bits.to_string() };
    format!(
        "{:?} is {} instead of {} after {} steps",
        v.name,
        show(b[at]),
        show(a[at]),
        at / read.len().max(1) + 1
    )
}

pub(super) fn reset_everywhere(lab: &Lab<'_>) {
    let Some(mut unit) = lab.unit() else { return };
    for (place, reach) in [
        ("before the initialization", 0),
        ("in the initialization", 1),
        ("after fmi2Terminate", 2),
        ("after an error", 3),
    ] {
        let reached = match reach {
            0 => true,
            1 => unit.setup(lab.t(0), None) <= 1 && unit.enter() <= 1,
            2 => lab.initialize(&mut unit) && unit.terminate() <= 1,
            // Whether this is refused is found elsewhere.
            _ => lab.initialize(&mut unit) && lab.make_error(&mut unit).is_some_and(|status| status >= ERROR),
        };
        if !reached {
            break;
        }
        let status = unit.reset();
        if status > 1 {
            return lab.reporter.error("M5", format!("fmi2Reset {place} returned {}", word(status)));
        }
    }
    if !lab.initialize(&mut unit) {
        lab.reporter.error("M5", "after fmi2Reset the FMU cannot be initialized any more");
    }
}

/// A unit after some steps with moving inputs, and its state there.
pub(super) fn saved<'a>(lab: &Lab<'a>) -> Option<(Unit<'a>, *mut std::ffi::c_void)> {
    let mut unit = lab.ready()?;
    if lab.advance(&mut unit, 0, STEPS, true).is_none() {
        lab.unable();
        return None;
    }
    let mut state = ptr::null_mut();
    let status = unit.save(&mut state);
    if status > 1 || state.is_null() {
        lab.reporter.error(
            "M6",
            format!(
                "fmi2GetFMUstate returned {}{}",
                word(status),
                if state.is_null() { " and NULL" } else { "" }
            ),
        );
        return None;
    }
    Some((unit, state))
}

/// Restores, continues with the inputs of the saved state, and compares.
pub(super) fn continues(
    lab: &Lab<'_>,
    unit: &mut Unit<'_>,
    state: *mut std::ffi::c_void,
    expected: &Bits,
    after: &str,
) -> bool {
    let status = unit.restore(state);
    if status > 1 {
        lab.reporter.error("M6", format!("fmi2SetFMUstate {after} returned {}", word(status)));
        return false;
    }
    let Some(bits) = lab.advance(unit, STEPS, 2 * STEPS, false) else {
        lab.reporter.error("M6", format!("after fmi2SetFMUstate {after} the FMU cannot be stepped"));
        return false;
    };
    let what = || {
        format!("after fmi2SetFMUstate {after} the FMU continues otherwise: {}", differ(lab, expected, &bits))
    };
    match compare(lab, expected, &bits, STEPS) {
        Continuation::Same => return true,
        Continuation::Unrepeatable => {}
        Continuation::NewSolver => {
            lab.reporter.warning(
                "M6",
                format!(
                    "a restored state continues otherwise, by less than the error of the FMU's solver, which begins anew: {}",
                    differ(lab, expected, &bits)
                ),
            );
            return true;
        }
        Continuation::Other => lab.reporter.error("M6", what()),
    }
    false
}

/// What a run that continues a restored state is, compared with one that went on.
enum Continuation {
    Same,
    /// Fresh instances differ as well.
    Unrepeatable,
    /// The difference is less than what the solver's steps make.
    NewSolver,
    Other,
}

/// Compares runs that continue the state after `at` steps with moving inputs.
fn compare(lab: &Lab<'_>, expected: &Bits, bits: &Bits, at: u32) -> Continuation {
    if lab.same(expected, bits, None) {
        return Continuation::Same;
    }
    let end = at + (expected.len() / lab.watched().len().max(1)) as u32;
    // A fresh instance on the same way; `parts` of each step after the state.
    let fresh = |parts: u32| -> Option<Bits> {
        let mut unit = lab.ready()?;
        unit.expect_rollback();
        lab.advance(&mut unit, 0, at, true)?;
        let mut bits = Vec::new();
        let h = lab.h() / f64::from(parts);
        for k in at..end {
            if (0..parts).any(|part| unit.step(lab.t(k) + f64::from(part) * h, h) > 1) {
                return None;
            }
            bits.extend(lab.read(&mut unit)?);
        }
        Some(bits)
    };
    if !lab.repeatable(expected, || fresh(1)) {
        return Continuation::Unrepeatable;
    }
    // A solver that chooses its steps begins anew from a restored state. Then it errs otherwise than before,
    // but no more: about what halving the communication steps changes, and within its tolerance.
    if lab.description.capabilities.can_handle_variable_step
        && many(lab.description)
        && let Some(errors) = fresh(2).and_then(|halves| lab.errors(expected, &halves))
    {
        let tolerance = lab.description.experiment.tolerance.unwrap_or(SOLVER_TOLERANCE);
        let allowed: Vec<f64> =
            errors.iter().zip(lab.sizes(expected)).map(|(error, size)| error.min(tolerance * size)).collect();
        if lab.same(expected, bits, Some(&allowed)) {
            return Continuation::NewSolver;
        }
    }
    Continuation::Other
}

pub(super) fn free_saved(lab: &Lab<'_>, unit: &mut Unit<'_>, mut state: *mut std::ffi::c_void) {
    let status = unit.free_state(&mut state);
    if status > 1 {
        lab.reporter.error("M6", format!("fmi2FreeFMUstate returned {}", word(status)));
    } else if !state.is_null() {
        lab.reporter.error("S6", "fmi2FreeFMUstate does not set the freed state to NULL");
    }
}

pub(super) fn rollback(lab: &Lab<'_>) {
    let Some((mut unit, state)) = saved(lab) else { return };
    // Without setting inputs: those of the saved state have to come back with it.
    let Some(expected) = lab.advance(&mut unit, STEPS, 2 * STEPS, false) else { return };
    if !continues(lab, &mut unit, state, &expected, "at once") {
        return;
    }
    if unit.restore(state) <= 1
        && lab.advance(&mut unit, STEPS, STEPS + 7, true).is_some()
        && !continues(lab, &mut unit, state, &expected, "after steps with other inputs")
    {
        return;
    }
    free_saved(lab, &mut unit, state);
}

pub(super) fn rollback_after_error(lab: &Lab<'_>) {
    let Some((mut unit, state)) = saved(lab) else { return };
    let Some(expected) = lab.advance(&mut unit, STEPS, 2 * STEPS, false) else { return };
    if lab.make_error(&mut unit) == Some(ERROR) {
        continues(lab, &mut unit, state, &expected, "after fmi2Error");
    }
    free_saved(lab, &mut unit, state);
}

pub(super) fn state_reuse(lab: &Lab<'_>) {
    let Some((mut unit, state)) = saved(lab) else { return };
    if lab.advance(&mut unit, STEPS, STEPS + 5, true).is_none() {
        return;
    }
    let mut second = state;
    let status = unit.save(&mut second);
    if status > 1 {
        return lab
            .reporter
            .error("M6", format!("fmi2GetFMUstate over an old state returned {}", word(status)));
    }
    let run = |unit: &mut Unit<'_>| lab.advance(unit, STEPS + 5, STEPS + 15, false);
    let Some(expected) = run(&mut unit) else { return };
    let again = if unit.restore(second) > 1 { None } else { run(&mut unit) };
    if again.is_none_or(|bits| matches!(compare(lab, &expected, &bits, STEPS + 5), Continuation::Other)) {
        lab.reporter.error("M6", "a state that was saved over an old one is not the new one");
    }
    free_saved(lab, &mut unit, second);
}

pub(super) fn serialize(lab: &Lab<'_>) {
    let Some((mut unit, state)) = saved(lab) else { return };
    let Some(expected) = lab.advance(&mut unit, STEPS, 2 * STEPS, false) else { return };
    let bytes = match unit.serialize(state) {
        Ok(bytes) => bytes,
        Err(status) => {
            return lab.reporter.error("M6", format!("turning a state into bytes returned {}", word(status)));
        }
    };
    let mut copy = ptr::null_mut();
    let status = unit.deserialize(&bytes, &mut copy);
    if status > 1 || copy.is_null() {
        return lab
            .reporter
            .error("M6", format!("fmi2DeSerializeFMUstate of its own bytes returned {}", word(status)));
    }
    let good = continues(lab, &mut unit, copy, &expected, "of a state from bytes");
    free_saved(lab, &mut unit, copy);
    free_saved(lab, &mut unit, state);
    unit.free();
    if !good {
        return;
    }
    let Some(mut other) = lab.unit() else { return };
    let mut copy = ptr::null_mut();
    let status = other.deserialize(&bytes, &mut copy);
    if status > 1 || copy.is_null() {
        return lab
            .reporter
            .error("M6", format!("fmi2DeSerializeFMUstate in a new instance returned {}", word(status)));
    }
    continues(lab, &mut other, copy, &expected, "of a state from another instance's bytes");
    free_saved(lab, &mut other, copy);
}
