//! What a rig's recorder makes of ideal sensors: all channels behind one filter, whose delay is taken off, and samples of them.

use crate::bessel::{Bessel, LIMIT, delay};
use crate::simulate::Ideal;

/// Samples of a run at its time stamps, which are counted from its first one \[s\].
pub(crate) struct Recorder<'a> {
    stamps: &'a [f64],
    filters: Vec<Bessel>,
    last: Vec<f64>,
    taken: usize,
    delay: f64,
    pub(crate) ideal: Ideal,
}

impl<'a> Recorder<'a> {
    /// Of so many inputs and outputs.
    pub(crate) fn new(stamps: &'a [f64], inputs: usize, outputs: usize) -> Self {
        Self::limited(stamps, (inputs, outputs), LIMIT)
    }

    /// The same with another limit of the filter \[Hz\].
    pub(crate) fn limited(stamps: &'a [f64], (inputs, outputs): (usize, usize), limit: f64) -> Self {
        let ideal = Ideal { inputs: vec![Vec::new(); inputs], outputs: vec![Vec::new(); outputs] };
        Self { stamps, filters: Vec::new(), last: Vec::new(), taken: 0, delay: delay(limit), ideal }
    }

    /// Takes over inputs and outputs at a time, `dt` seconds after the last ones.
    pub(crate) fn follow(&mut self, time: f64, u: &[f64], y: &[f64], dt: f64) {
        let values = || u.iter().chain(y).copied();
        if self.filters.is_empty() {
            self.filters = values().map(|v| Bessel::new(v, self.delay)).collect();
            self.last = values().collect();
        }
        let filtered: Vec<f64> =
            self.filters.iter_mut().zip(values()).map(|(f, v)| f.follow(v, dt)).collect();
        let at = time - self.delay;
        while let Some(stamp) = self.stamps.get(self.taken).filter(|stamp| **stamp <= at) {
            let share = 1.0 - (at - stamp) / dt;
            let lists = self.ideal.inputs.iter_mut().chain(&mut self.ideal.outputs);
            for ((list, from), to) in lists.zip(&self.last).zip(&filtered) {
                list.push(from + (to - from) * share);
            }
            self.taken += 1;
        }
        self.last = filtered;
    }
}
