//! What effects make of signals that are known from beginning to end, without a slave.

use super::{Attachment, Call, Course, MAX_DRIVERS, Memory, Source};
use std::sync::Arc;

/// Signals along a run.
pub struct Along<'a> {
    /// The times \[s\].
    pub time: &'a dyn Fn(usize) -> f64,
    /// Values of the number to be changed.
    pub target: &'a [f64],
    /// Of each driver of the effect: values of its variable, and what effects get more than that.
    pub drivers: Vec<(&'a [f64], f64)>,
    /// What the number to be changed does, for effects that see what is ahead.
    pub course: Option<Course<'a>>,
}

impl Along<'_> {
    /// The number after the effect with these parameters: what [`Attached`](super::Attached) does at communication points.
    pub fn changed(&self, attachment: &Attachment, parameters: &[f64], memory: &mut Memory) -> Vec<f64> {
        let mut integrals = [0.0; MAX_DRIVERS];
        let change = |(k, target): (usize, &f64)| {
            let dt = if k == 0 { 0.0 } else { (self.time)(k) - (self.time)(k - 1) };
            let mut drivers = [0.0; MAX_DRIVERS];
            for (i, (signal, (values, ahead))) in attachment.drivers.iter().zip(&self.drivers).enumerate() {
                let (now, last) = (values[k], values[k.saturating_sub(1)]);
                drivers[i] = signal.directed(match signal.source {
                    Source::Value => now + ahead,
                    Source::Rate if k > 0 => (now - last) / dt,
                    Source::Rate => 0.0,
                    Source::Integral => {
                        integrals[i] += 0.5 * dt * (now + last);
                        integrals[i]
                    }
                });
            }
            let used = &drivers[..self.drivers.len()];
            let call = Call { time: (self.time)(k), dt, target: *target, drivers: used, course: self.course };
            (attachment.effect.apply)(parameters, memory, &call)
        };
        self.target.iter().enumerate().map(change).collect()
    }
}

/// A run of a session that was before another one, as it was recorded.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Earlier {
    /// Times of the samples \[s\].
    pub time: Vec<f64>,
    /// What was recorded of variables of the slave: index and values.
    pub signals: Vec<(usize, Vec<f64>)>,
}

impl Earlier {
    fn of(&self, variable: usize) -> Option<&[f64]> {
        self.signals.iter().find(|(v, _)| *v == variable).map(|(_, values)| &values[..])
    }
}

/// What an effect with these parameters remembers when a run begins after others, the earliest first: the share that
/// [`Effect::kept`](super::Effect::kept) says of what the one before left. Nothing, if not all that drives it was recorded. A
/// parameter that it changes has the value `held`.
pub fn remembered(
    attachment: &Attachment,
    parameters: &[f64],
    held: f64,
    earlier: &[Arc<Earlier>],
) -> Memory {
    let mut memory = Memory::default();
    let kept = attachment.effect.kept().and_then(|i| parameters.get(i));
    let Some(kept) = kept.filter(|kept| **kept != 0.0) else { return memory };
    for run in earlier {
        let drivers: Option<Vec<(&[f64], f64)>> =
            attachment.drivers.iter().map(|signal| Some((run.of(signal.variable)?, 0.0))).collect();
        let Some(drivers) = drivers else { return Memory::default() };
        let time = |k: usize| run.time[k];
        let held = vec![held; run.time.len()];
        let target = run.of(attachment.target).unwrap_or(&held);
        Along { time: &time, target, drivers, course: None }.changed(attachment, parameters, &mut memory);
        memory.past.clear();
        memory.states.iter_mut().for_each(|state| *state *= kept);
    }
    memory
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effect::catalogue::EFFECTS;
    use crate::effect::{Chosen, Effect, Signal};

    const LENGTH: usize = 400;
    const STEP: f64 = 0.05;
    const PAUSE: f64 = 7.0;
    const TIME: f64 = 12.0;

    /// The effect at variable 9, driven by 0, 1, ...; it loses `amount` and keeps this share.
    fn attachment(effect: &'static Effect, amount: f64, kept: f64) -> Attachment {
        let chosen = |value: f64| Chosen { value, range: (0.0, 1e9), unit: None };
        let parameters = [amount, TIME, kept].map(chosen).to_vec();
        let drivers = (0..effect.drivers.len()).map(Signal::value).collect();
        Attachment { effect, target: 9, drivers, parameters }
    }

    /// One of a session's runs: signals at even times that are zero at both ends, the last of them the number to be changed.
    fn signals(run: usize) -> Vec<Vec<f64>> {
        let course = |signal: usize| {
            let at = |k: usize| {
                let t = k as f64 / (LENGTH - 1) as f64;
                let wave = (t * (7.0 + 3.0 * (signal + 2 * run) as f64)).sin();
                (std::f64::consts::PI * t).sin().max(0.0) * (1.0 + 0.5 * wave)
            };
            (0..LENGTH).map(at).collect()
        };
        (0..MAX_DRIVERS + 1).map(course).collect()
    }

    fn along<'a>(
        attachment: &Attachment,
        signals: &'a [Vec<f64>],
        time: &'a dyn Fn(usize) -> f64,
    ) -> Along<'a> {
        let drivers = (0..attachment.drivers.len()).map(|i| (&signals[i][..], 0.0)).collect();
        Along { time, target: &signals[MAX_DRIVERS], drivers, course: None }
    }

    /// Where a pause is a part of a long run in which nothing happens, the run after it is the end of the long one.
    #[test]
    fn a_run_after_others_is_the_end_of_a_long_one_with_pauses() {
        let effects: Vec<&'static Effect> = EFFECTS.iter().filter(|e| e.kept().is_some()).collect();
        assert!(effects.len() >= 7);
        for effect in effects {
            let own = attachment(effect, 0.02, (-PAUSE / TIME).exp());
            let parameters: Vec<f64> = own.parameters.iter().map(|p| p.value).collect();
            let runs: Vec<Vec<Vec<f64>>> = (0..3).map(signals).collect();
            let even = |k: usize| STEP * k as f64;

            // the runs one behind the other, the pauses between their ends
            let long: Vec<Vec<f64>> =
                (0..MAX_DRIVERS + 1).map(|i| runs.iter().flat_map(|r| r[i].clone()).collect()).collect();
            let with_pauses = |k: usize| {
                let (run, sample) = (k / LENGTH, k % LENGTH);
                run as f64 * (even(LENGTH - 1) + PAUSE) + even(sample)
            };
            let mut memory = Memory::default();
            let whole = along(&own, &long, &with_pauses).changed(&own, &parameters, &mut memory);

            let earlier = runs[..2].iter().map(|run| {
                let signals =
                    (0..MAX_DRIVERS).map(|i| (i, run[i].clone())).chain([(9, run[MAX_DRIVERS].clone())]);
                Arc::new(Earlier { time: (0..LENGTH).map(even).collect(), signals: signals.collect() })
            });
            let earlier: Vec<Arc<Earlier>> = earlier.collect();
            let mut memory = remembered(&own, &parameters, 0.0, &earlier);
            let last = along(&own, &runs[2], &even).changed(&own, &parameters, &mut memory);
            let mut cold = Memory::default();
            let cold = along(&own, &runs[2], &even).changed(&own, &parameters, &mut cold);

            let distance =
                |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            let error = distance(&last, &whole[2 * LENGTH..]);
            assert!(error < 1e-12 && distance(&last, &cold) > 1e-3, "{}: {error}", effect.id);
        }
    }

    #[test]
    fn what_is_not_known_of_earlier_runs_is_not_made_up() {
        let effect = EFFECTS.iter().find(|e| e.id == "frictional-heating").unwrap();
        let own = attachment(effect, 0.02, 0.5);
        let run = |variable: usize| {
            Arc::new(Earlier { time: vec![0.0, 1.0], signals: vec![(variable, vec![3.0, 3.0])] })
        };
        let warm = |kept: f64, earlier: &[Arc<Earlier>]| {
            remembered(&own, &[0.02, TIME, kept], 1.0, earlier).states[0]
        };
        // 3 W for 1 s, of which little has left
        let once = 3.0 * TIME * (1.0 - (-1.0 / TIME).exp());
        assert!((warm(0.5, &[run(0)]) - 0.5 * once).abs() < 1e-12);
        assert!(warm(0.5, &[run(0), run(0)]) > 0.5 * once);
        // cold: nothing is kept, the power was not recorded, it was not recorded in one of them, it is the first
        for (kept, earlier) in [(0.0, &[run(0)][..]), (0.5, &[run(1)]), (0.5, &[run(0), run(1)]), (0.5, &[])]
        {
            assert_eq!(warm(kept, earlier), 0.0);
        }
    }
}
