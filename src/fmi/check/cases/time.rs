//! Cases: the partition of time, clocks and derivatives.

use super::*;

pub(super) fn partition(lab: &Lab<'_>) {
    let reals: Vec<&VariableInfo> =
        lab.variables().iter().filter(|v| v.is_real() && v.causality == Causality::Output).collect();
    let steps = 100;
    let run = |parts: u32| -> Option<Vec<Vec<f64>>> {
        let mut unit = lab.unit()?;
        // Something has to happen for the steps to matter; inputs stay as they are then.
        if !lab.initialize(&mut unit) || !lab.excite(&mut unit, 10) {
            return None;
        }
        let mut values = Vec::new();
        for k in 0..steps {
            for part in 0..parts {
                let time = lab.t(k) + f64::from(part) * lab.h() / f64::from(parts);
                if unit.step(time, lab.h() / f64::from(parts)) > 1 {
                    return None;
                }
            }
            values.push(reals.iter().map(|v| unit.get_real(v.reference).1).collect());
            if lab.late(0.3 * f64::from(parts)) {
                break;
            }
        }
        Some(values)
    };
    let Some(whole) = run(1) else { return };
    let Some(halves) = run(2) else {
        return lab.reporter.found(Found {
            rule: "D10".into(),
            level: Level::Error,
            what: format!("a step by {} s is refused, half the usual one", lab.h() / 2.0),
            variable: None,
            attribute: Some("canHandleVariableCommunicationStepSize".into()),
        });
    };
    for (i, v) in reals.iter().enumerate() {
        let pairs = || whole.iter().zip(&halves).map(|(a, b)| (a[i], b[i]));
        let size = pairs().fold(v.nominal.map_or(0.0, f64::abs), |m, (a, b)| m.max(a.abs()).max(b.abs()));
        let worst = pairs().map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        if worst > PARTITION_TOLERANCE * size && worst > 1e-9 {
            lab.reporter.found(Found {
                rule: "D10".into(),
                level: Level::Warning,
                what: format!(
                    "with steps half as long {:?} differs by {worst:.3e}, more than {} % of its largest value {size:.3e}",
                    v.name,
                    100.0 * PARTITION_TOLERANCE
                ),
                variable: Some(v.name.clone()),
                attribute: None,
            });
        }
    }
}

pub(super) fn clock(lab: &Lab<'_>) {
    let Some(mut unit) = lab.ready() else { return };
    for k in 0..STEPS {
        if unit.step(lab.t(k), lab.h()) > 1 {
            return;
        }
        let end = lab.t(k) + lab.h();
        let wrong = |time: f64| time.is_nan() || (time - end).abs() > 1e-6 * lab.h() + 1e-12 * end.abs();
        if let Some(v) = lab.variables().iter().find(|v| v.causality == Causality::Independent) {
            let (status, time) = unit.get_real(v.reference);
            if status <= 1 && wrong(time) {
                let what =
                    format!("after a step to {end} s the independent variable {:?} is {time} s", v.name);
                return lab.reporter.error("D1", what);
            }
        }
        // The standard has this for steps that were discarded, and does not say what it is after others.
        if let Some(time) = unit.last_successful_time().filter(|time| wrong(*time)) {
            let what = if time.is_nan() {
                format!(
                    "after a step to {end} s fmi2GetRealStatus returns fmi2OK without the last successful time"
                )
            } else {
                format!("after a step to {end} s the last successful time is {time} s")
            };
            return lab.reporter.warning("D1", what);
        }
    }
}

pub(super) fn input_derivatives(lab: &Lab<'_>) {
    let attribute = Some("canInterpolateInputs".to_owned());
    let inputs =
        || lab.variables().iter().filter(|v| is_real_input(v) && v.variability == Variability::Continuous);
    let Some(mut unit) = lab.ready() else { return };
    for v in inputs() {
        let status = unit.set_rate(v.reference, 1, 0.0);
        if status > 1 {
            lab.reporter.found(Found {
                rule: "D7".into(),
                level: Level::Error,
                what: format!(
                    "canInterpolateInputs is true, but setting the first derivative of {:?} returned {}",
                    v.name,
                    word(status)
                ),
                variable: None,
                attribute,
            });
            return;
        }
    }
    if unit.step(lab.t(0), lab.h()) > 1 {
        return lab
            .reporter
            .error("D7", "the FMU cannot be stepped after derivatives of its inputs were set to zero");
    }
    if let Some(v) = inputs().next() {
        let status = unit.set_rate(v.reference, 0, 0.0);
        lab.refused("D7", Level::Warning, status, "setting a derivative of order 0");
    }
}

pub(super) fn output_derivatives(lab: &Lab<'_>) {
    let Some(mut unit) = lab.ready() else { return };
    if unit.step(lab.t(0), lab.h()) > 1 {
        return;
    }
    let outputs = lab.variables().iter().filter(|v| {
        v.is_real() && v.causality == Causality::Output && v.variability == Variability::Continuous
    });
    for v in outputs {
        let (status, value) = unit.get_rate(v.reference, 1);
        if status > 1 || !value.is_finite() {
            lab.reporter.found(Found {
                rule: "D7".into(),
                level: Level::Error,
                what: format!("the first derivative of {:?} is {value} with {}", v.name, word(status)),
                variable: None,
                attribute: Some("maxOutputDerivativeOrder".into()),
            });
            return;
        }
    }
}

pub(super) fn directional(lab: &Lab<'_>) {
    // In the initialization outputs follow inputs at once, so that differences need no step.
    let Some(mut unit) = lab.unit() else { return };
    if unit.setup(lab.t(0), None) > 1 || unit.enter() > 1 {
        return;
    }
    let outputs: Vec<&VariableInfo> = lab
        .variables()
        .iter()
        .filter(|v| {
            v.is_real() && v.causality == Causality::Output && v.variability == Variability::Continuous
        })
        .take(12)
        .collect();
    for input in lab
        .variables()
        .iter()
        .filter(|v| is_real_input(v) && v.variability == Variability::Continuous)
        .take(12)
    {
        let (start, step) = (start_of(input), 1e-5 * nominal(input));
        let mut at = |value: f64| -> Option<Vec<f64>> {
            if unit.set_real(input.reference, value) > 1 {
                return None;
            }
            outputs
                .iter()
                .map(|v| Some(unit.get_real(v.reference)).filter(|(s, _)| *s <= 1).map(|(_, y)| y))
                .collect()
        };
        let mut slopes = |step: f64| -> Option<Vec<f64>> {
            let (above, below) = (at(start + step)?, at(start - step)?);
            Some(above.iter().zip(below).map(|(a, b)| (a - b) / (2.0 * step)).collect())
        };
        let (Some(wide), Some(narrow), Some(middle)) = (slopes(step), slopes(0.5 * step), at(start)) else {
            return;
        };
        // Outputs that are small by symmetry are rounded like those that are not.
        let largest = middle.iter().fold(1e-3, |most: f64, y| most.max(y.abs()));
        for (i, output) in outputs.iter().enumerate() {
            let (status, value) = unit.directional(output.reference, input.reference);
            let difference = (4.0 * narrow[i] - wide[i]) / 3.0;
            // What curvature and rounding do to the difference.
            let noise = (narrow[i] - wide[i]).abs() + 1e-12 * largest / step;
            let what = if status > 1 {
                format!("d {:?} / d {:?} returned {}", output.name, input.name, word(status))
            } else if value.is_nan()
                || (value - difference).abs()
                    > DERIVATIVE_TOLERANCE * value.abs().max(difference.abs()) + noise
            {
                format!(
                    "d {:?} / d {:?} is {value:?}; differences give {difference:?}",
                    output.name, input.name
                )
            } else {
                continue;
            };
            lab.reporter.found(Found {
                rule: "D9".into(),
                level: if status > 1 { Level::Error } else { Level::Warning },
                what,
                variable: Some(output.name.clone()),
                attribute: None,
            });
        }
    }
}
