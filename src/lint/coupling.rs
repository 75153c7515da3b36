//! Whether the communication step suits the stiffness of what is passed on.

use super::{Remark, View};
use crate::cosimulate::BondKind;
use nalgebra::{DMatrix, DVector};

const TOPIC: &str = "communication step";
/// The damper that holding a force makes may be this share of the damping that is there (docs/cosimulate.md).
const SHARE: f64 = 0.1;
/// A line through force over motion and speed has to explain this much of the force to be its stiffness.
const EXPLAINED: f64 = 0.9;

/// For each pair of force and motion: stiffness and damping as the run shows them, and the damper that holding the
/// force for a communication step makes, d = -k T/2, or three times as much side by side.
pub(super) fn steps(view: &View<'_>, step: f64) -> Vec<Remark> {
    let late = if view.system.coupling.order.is_some() { 0.5 } else { 1.5 };
    let mut remarks = Vec::new();
    for bond in view.system.bonds() {
        let (effort_name, motion_name) = &bond.name;
        let [effort, motion] = bond.outputs();
        let unit = |rotation: &'static str, translation: &'static str| match bond.turns(view.system) {
            true => rotation,
            false => translation,
        };
        let motion_unit = match bond.kind {
            BondKind::Flow => unit("rad/s", "m/s"),
            BondKind::Displacement => unit("rad", "m"),
        };
        let courses = view.course(effort, unit("N.m", "N")).zip(view.course(motion, motion_unit));
        let Some((effort, motion)) = courses else { continue };
        let line = line(&effort, &motion, step, bond.kind);
        let names = format!("{effort_name} over {motion_name}");
        let Some([stiffness, damping]) = line else {
            remarks.push(Remark::open(
                TOPIC,
                format!("{names}: the force is no line over motion and speed, so its stiffness is not known"),
            ));
            continue;
        };
        let made = late * stiffness.abs() * step;
        let there = damping * stiffness.signum();
        let (stiff, damp) = (unit("N.m/rad", "N/m"), unit("N.m.s/rad", "N.s/m"));
        let found = format!(
            "{names}: {:.4e} {stiff} and {there:.4e} {damp}; holding it for {step} s is a damper of -{made:.4e} {damp}",
            stiffness.abs()
        );
        let fine = made <= SHARE * there;
        let longest = SHARE * there / (late * stiffness.abs());
        remarks.push(Remark::judged(
            fine,
            TOPIC,
            if fine || longest <= 0.0 {
                found
            } else {
                format!("{found}, more than a tenth of what is there; {longest:.1e} s would be a tenth")
            },
        ));
    }
    remarks
}

/// Stiffness and damping of an effort by least squares over motion, speed and a constant; none where that explains too little.
fn line(effort: &[f64], motion: &[f64], step: f64, kind: BondKind) -> Option<[f64; 2]> {
    let n = effort.len();
    if n < 8 {
        return None;
    }
    let place: Vec<f64> = match kind {
        BondKind::Displacement => motion.to_vec(),
        BondKind::Flow => motion
            .iter()
            .scan(0.0, |sum, speed| {
                *sum += step * speed;
                Some(*sum)
            })
            .collect(),
    };
    let speed: Vec<f64> = match kind {
        BondKind::Flow => motion.to_vec(),
        BondKind::Displacement => (0..n)
            .map(|k| {
                let (a, b) = (k.saturating_sub(1), (k + 1).min(n - 1));
                (motion[b] - motion[a]) / ((b - a) as f64 * step)
            })
            .collect(),
    };
    let size = |values: &[f64]| values.iter().fold(0.0, |most: f64, v| most.max(v.abs()));
    let (by_place, by_speed) = (size(&place), size(&speed));
    if by_place == 0.0 || by_speed == 0.0 {
        return None;
    }
    let matrix = DMatrix::from_fn(n, 3, |k, c| match c {
        0 => place[k] / by_place,
        1 => speed[k] / by_speed,
        _ => 1.0,
    });
    let target = DVector::from_column_slice(effort);
    let found = matrix.clone().svd(true, true).solve(&target, 1e-12).ok()?;
    let mean = target.mean();
    let whole: f64 = target.iter().map(|v| (v - mean) * (v - mean)).sum();
    let left = (&matrix * &found - &target).norm_squared();
    (whole > 0.0 && left <= (1.0 - EXPLAINED) * whole).then(|| [found[0] / by_place, found[1] / by_speed])
}
