//! Effects on outputs, computed from traces instead of simulated.

use super::bench::{Drive, Traces};
use crate::effect::{Attachment, Call, Course, MAX_DRIVERS, Memory, Source};

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
        watch.iter().position(|v| *v == variable).map(|c| &traces[c]).or_else(driven)
    };
    let signals: Option<Vec<&Vec<f64>>> = attachment.drivers.iter().map(|s| of(s.variable)).collect();
    let signals = signals?;
    let course = Course { start: drive.start, step: drive.step, values: target };
    let mut memory = Memory::default();
    let mut integrals = [0.0; MAX_DRIVERS];
    let changed = target.iter().enumerate().map(|(k, target)| {
        let dt = if k == 0 { 0.0 } else { drive.time(k) - drive.time(k - 1) };
        let mut drivers = [0.0; MAX_DRIVERS];
        for (i, (signal, values)) in attachment.drivers.iter().zip(&signals).enumerate().take(MAX_DRIVERS) {
            let (now, last) = (values[k], values[k.saturating_sub(1)]);
            let begin = drive.begins.iter().find(|(v, _)| *v == signal.variable);
            drivers[i] = signal.directed(match signal.source {
                Source::Value => now + begin.map_or(0.0, |(_, begin)| begin - values[0]),
                Source::Rate if k > 0 => (now - last) / dt,
                Source::Rate => 0.0,
                Source::Integral => {
                    integrals[i] += 0.5 * dt * (now + last);
                    integrals[i]
                }
            });
        }
        let used = &drivers[..signals.len().min(MAX_DRIVERS)];
        let call = Call { time: drive.time(k), dt, target: *target, drivers: used, course: Some(course) };
        (attachment.effect.apply)(&parameters, &mut memory, &call)
    });
    Some(changed.collect())
}
