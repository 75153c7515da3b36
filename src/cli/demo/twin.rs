//! A part of a recorded system, run again in this process, where its bristles can be seen.

use latsch::cosimulate::Plan;
use latsch::model::{Causality, Model, Native, Setting, Settings, Slave};
use latsch::recording::Recording;
use latsch::{Error, Result};

/// What drives a part along a recording of every communication point.
pub struct Replay<'a> {
    /// The system.
    pub plan: &'a Plan,
    /// The part's name in it.
    pub part: &'a str,
    /// What the part was made with, over which the system sets its own.
    pub made_with: &'a Settings,
    /// Its inputs that were driven, each with its unit.
    pub inputs: &'a [(String, &'a str)],
    /// Communication step \[s\].
    pub step: f64,
}

impl Replay<'_> {
    /// Runs the part; `seen` is told the number of each communication point.
    ///
    /// # Errors
    /// It does not end at the place (`vehicle_distance`) at which the recorded one did, to the last bit.
    pub fn run<M: Model>(&self, recording: &Recording, mut seen: impl FnMut(usize, &M)) -> Result<Native<M>> {
        let values = self.plan.components.iter().filter(|c| c.name == self.part).flat_map(|c| &c.set);
        let mut settings = self.made_with.clone();
        settings.values.extend(values.map(|set| Setting {
            name: set.variable.clone(),
            value: set.value.clone(),
            causality: Causality::Parameter,
            place: set.place.clone(),
        }));
        let mut slave = Native::<M>::new(&settings)?;
        let mut inputs = Vec::new();
        for (name, unit) in self.inputs {
            inputs.push((slave.find(name)?, recording.channel_in(&format!("{}.{name}", self.part), unit)?));
        }
        let (first, last) = (recording.time[0], recording.time.len() - 1);
        slave.start(first, None)?;
        for k in 0..=last {
            // an input beside a sample is the one that led there
            for (index, values) in &inputs {
                slave.set(*index, values[k])?;
            }
            if k == 0 {
                slave.finish_start()?;
            } else {
                slave.step(first + (k - 1) as f64 * self.step, self.step)?;
            }
            seen(k, slave.model());
        }
        let index = slave.find("vehicle_distance")?;
        let name = format!("{}.vehicle_distance", self.part);
        let (place, recorded) = (slave.get(index)?, recording.channel_in(&name, "m")?[last]);
        if place != recorded {
            return Err(Error::numeric(format!(
                "{}: {} in this program ends at {place} m, the recorded one at {recorded} m; are both of the same version?",
                recording.source, self.part
            )));
        }
        Ok(slave)
    }
}
