//! Effects on outputs, computed from traces instead of simulated.

use super::bench::{Drive, Traces};
use crate::effect::{Along, Attachment, Course, remembered};

/// The course `target` of an output after an effect on it, with the traces of the `watch`ed variables of the slave without
/// that effect: what [`Attached`](crate::effect::Attached) does at the communication points, but for effects that show what is ahead,
/// which is known here. `None` if a signal that drives the effect is neither watched nor a driven input.
pub fn replay(
    attachment: &Attachment,
    target: &[f64],
    drive: &Drive,
    watch: &[usize],
    traces: &Traces,
) -> Option<Vec<f64>> {
    let parameters: Vec<f64> = attachment.parameters.iter().map(|p| p.value).collect();
    let of = |variable: usize| {
        let driven = || drive.inputs.iter().find(|(v, _)| *v == variable).map(|(_, values)| values);
        let values = watch.iter().position(|v| *v == variable).map(|c| &traces[c]).or_else(driven)?;
        let begin = drive.begins.iter().find(|(v, _)| *v == variable);
        Some((&values[..], begin.map_or(0.0, |(_, begin)| begin - values[0])))
    };
    let drivers: Option<Vec<(&[f64], f64)>> = attachment.drivers.iter().map(|s| of(s.variable)).collect();
    let course = Course { start: drive.start, step: drive.step, values: target };
    let time = |k: usize| drive.time(k);
    let along = Along { time: &time, target, drivers: drivers?, course: Some(course) };
    let held = target.first().copied().unwrap_or_default();
    let mut memory = remembered(attachment, &parameters, held, &drive.earlier);
    Some(along.changed(attachment, &parameters, &mut memory))
}
