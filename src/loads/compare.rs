//! A simulation beside one or several recordings of the same run: counted alike, and judged by what recordings differ by.

use super::count::{
    Classes, Cycle, Residue, extremes, large_turning_points, level_crossings, rainflow, range_pairs,
};
use crate::model::unit::Unit;
use crate::recording::{Recording, interpolate};
use crate::stats::{
    Spectrum, chance::student_beyond, deviation, extent, mean, median_interval, root_mean_square, spectrum,
};
use crate::{Error, Result};

/// How histories are made comparable, and counted.
#[derive(Debug, Clone, PartialEq)]
pub struct Conditions {
    /// Channels, and what recordings call them; none: all that are in everything.
    pub channels: Vec<[String; 2]>,
    /// Slope of the S-N line for damage.
    pub slope: f64,
    /// Movements below this share of the recorded span do not count.
    pub gate: f64,
    /// Classes of levels and of ranges over the recorded span.
    pub classes: usize,
    /// What happens in each run at the time that is made 0.
    pub event: Option<Event>,
    /// From when to when \[s\], after that shift.
    pub window: Option<[f64; 2]>,
    /// A channel that errors are taken over, instead of the time: a distance.
    pub over: Option<String>,
}

/// The first time at which a channel is beyond a value.
#[derive(Debug, Clone, PartialEq)]
pub struct Event {
    channel: String,
    above: bool,
    value: f64,
    /// Of the value; empty: that of the channel.
    unit: String,
}

/// A history, counted.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Load {
    /// Smallest and largest value.
    pub extremes: [f64; 2],
    /// Cycles, half ones of the residue as halves.
    pub cycles: f64,
    /// The largest range of a cycle.
    pub largest_range: f64,
    /// Sum of n range^slope, over that of the first recording.
    pub damage: f64,
    /// Crossings upward of each level.
    pub crossings: Vec<usize>,
    /// The same of the middle of the recorded span.
    pub middle: usize,
    /// Cycles in each class of range.
    pub pairs: Vec<f64>,
    /// All cycles and how often each counts: 1, or 0.5 for those of the residue.
    pub counted: Vec<(Cycle, f64)>,
    /// Amplitudes over frequency; none of a short history.
    pub spectrum: Option<Spectrum>,
}

/// What recordings of the same run say of a quantity, and the simulation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Band {
    /// Smallest and largest of the recordings.
    pub recorded: [f64; 2],
    /// Where a further recording of the same run would be with [`SURE`]; none with one recording, or where all are the same.
    pub further: Option<[f64; 2]>,
    /// Of the simulation.
    pub simulated: f64,
}

/// Probability with which a further recording is in a band. Of three recordings the span alone would leave out every second one.
pub const SURE: f64 = 0.95;

/// Differences below this share of a quantity are rounding.
const ROUNDING: f64 = 1e-9;

impl Band {
    /// From the quantity of each recording and of the simulation: the mean, more and less by Student's t times the deviation of a
    /// further value, s sqrt(1 + 1/n).
    pub fn new(recorded: &[f64], simulated: f64) -> Self {
        let n = recorded.len() as f64;
        let (low, high) = extent(recorded.iter().copied());
        // what is the same in all of them, but for rounding, says nothing of how runs differ
        let further = (high - low > ROUNDING * low.abs().max(high.abs())).then(|| {
            let s = deviation(recorded) * (n / (n - 1.0)).sqrt();
            let half = student_beyond(1.0 - SURE, n - 1.0) * s * (1.0 + 1.0 / n).sqrt();
            let middle = mean(recorded);
            [middle - half, middle + half]
        });
        Self { recorded: [low, high], further, simulated }
    }

    /// How far the simulation is from the middle of where a further recording would be, over half the width of that: beyond 1 it is outside.
    /// Negative below. None where recordings say nothing.
    pub fn off(&self) -> Option<f64> {
        self.further.map(|[low, high]| (2.0 * self.simulated - low - high) / (high - low))
    }
}

/// A channel.
#[derive(Debug, Clone, PartialEq)]
pub struct Compared {
    /// The channel.
    pub name: String,
    /// Its unit.
    pub unit: String,
    /// Levels that crossings are counted at.
    pub levels: Vec<f64>,
    /// Classes of values, over the recorded span; ranges have classes of the same width.
    pub values: Classes,
    /// Movements below this were left out.
    pub gate: f64,
    /// Interval of the samples \[s\] that all were brought to.
    pub interval: f64,
    /// The simulation.
    pub simulated: Load,
    /// The recordings, in their order.
    pub recorded: Vec<Load>,
    /// Root mean square of the error to each recording.
    pub errors: Vec<f64>,
    /// Root mean squares of the differences of recordings to the first of them.
    pub repeats: Vec<f64>,
}

/// A name, and what makes the number of a load.
pub type Quantity = (&'static str, fn(&Load) -> f64);

/// What is told of a load.
pub const QUANTITIES: [Quantity; 6] = [
    ("smallest", |load| load.extremes[0]),
    ("largest", |load| load.extremes[1]),
    ("cycles", |load| load.cycles),
    ("largest range", |load| load.largest_range),
    ("middle crossed", |load| load.middle as f64),
    ("damage", |load| load.damage),
];

impl Compared {
    /// Each quantity with the band of the recordings.
    pub fn bands(&self) -> impl Iterator<Item = (&'static str, Band)> {
        QUANTITIES.iter().map(|(name, of)| {
            let recorded: Vec<f64> = self.recorded.iter().map(of).collect();
            (*name, Band::new(&recorded, of(&self.simulated)))
        })
    }
}

impl Conditions {
    /// What recordings call a channel of the simulation.
    fn recorded_as<'a>(&'a self, name: &'a str) -> &'a str {
        self.channels.iter().find(|[own, _]| own == name).map_or(name, |[_, theirs]| theirs)
    }
}

impl Event {
    /// `CHANNEL>VALUE [UNIT]` or with `<`.
    ///
    /// # Errors
    /// Another form.
    pub fn parse(text: &str) -> Result<Self> {
        let form = || {
            Error::call(format!(
                "{text:?}: the form is CHANNEL>VALUE or CHANNEL<VALUE, with a unit behind the value if need be"
            ))
        };
        let sign = text.find(['<', '>']).ok_or_else(form)?;
        let (channel, rest) = (text[..sign].trim(), text[sign + 1..].trim());
        let (number, unit) = rest.split_once(char::is_whitespace).unwrap_or((rest, ""));
        let value = number.parse::<f64>().ok().filter(|v| v.is_finite()).ok_or_else(form)?;
        if channel.is_empty() {
            return Err(form());
        }
        let above = text[sign..].starts_with('>');
        Ok(Self { channel: channel.into(), above, value, unit: unit.trim().into() })
    }

    /// The sample of it in a recording, which has the channel under a name. A value without a unit has that of the simulation.
    fn sample(&self, recording: &Recording, name: &str, of_simulation: &str) -> Result<usize> {
        let unit = if self.unit.is_empty() { of_simulation } else { &self.unit };
        Unit::parse(unit).map_err(|e| Error::call(e.to_string()))?;
        let values = recording.channel_in(name, unit)?;
        let is_beyond = |v: &f64| if self.above { *v > self.value } else { *v < self.value };
        values.iter().position(is_beyond).ok_or_else(|| {
            Error::file(format!(
                "{}: {} is never {} {} {unit}",
                recording.source,
                name,
                if self.above { "above" } else { "below" },
                self.value
            ))
        })
    }
}

/// A window may begin and end so many intervals of samples beside what was recorded.
const MOST_SHORT: f64 = 1.5;
/// Intervals of samples that differ by no more than this share of them are the same: times are written with so many digits.
const EVEN: f64 = 1e-3;

/// A recording on its new time, within the window.
struct Aligned<'a> {
    recording: &'a Recording,
    time: Vec<f64>,
    samples: std::ops::Range<usize>,
    /// Places that errors are taken over, if not the time.
    places: Option<Vec<f64>>,
}

impl<'a> Aligned<'a> {
    /// `simulated`: its channels have their own names.
    fn new(recording: &'a Recording, conditions: &Conditions, simulated: Option<&Recording>) -> Result<Self> {
        let called = |name: &str| match simulated {
            None => name.to_owned(),
            Some(_) => conditions.recorded_as(name).to_owned(),
        };
        let reference = simulated.unwrap_or(recording);
        let event = match &conditions.event {
            None => None,
            Some(event) => {
                let unit = &reference.channel(&event.channel)?.unit;
                Some(event.sample(recording, &called(&event.channel), unit)?)
            }
        };
        let zero = event.map_or(0.0, |at| recording.time[at]);
        let time: Vec<f64> = recording.time.iter().map(|t| t - zero).collect();
        let samples = match conditions.window {
            None => 0..time.len(),
            Some([from, to]) => time.partition_point(|t| *t < from)..time.partition_point(|t| *t <= to),
        };
        if samples.len() < 2 {
            return Err(Error::file(format!("{}: there are no samples in the window", recording.source)));
        }
        if let Some([from, to]) = conditions.window {
            let (first, last) = (time[samples.start], time[samples.end - 1]);
            let most = MOST_SHORT * median_interval(&time);
            if first > from + most || last < to - most {
                return Err(Error::file(format!(
                    "{}: of the window from {from} s to {to} s there is only {first:.6} s to {last:.6} s; pieces of other length have other counts",
                    recording.source
                )));
            }
        }
        let places = match &conditions.over {
            None => None,
            Some(name) => {
                let unit = &reference.channel(name)?.unit;
                let all = recording.channel_in(&called(name), unit)?;
                // places count from the event, too
                let zero = event.map_or(0.0, |at| all[at]);
                let places: Vec<f64> = all[samples.clone()].iter().map(|place| place - zero).collect();
                if let Some(at) = places.windows(2).position(|pair| pair[1] < pair[0]) {
                    return Err(Error::file(format!(
                        "{}: {name} goes back at {} s, and errors cannot be taken over it; a window that ends before may help",
                        recording.source,
                        time[samples.start + at]
                    )));
                }
                Some(places)
            }
        };
        Ok(Self { recording, time, samples, places })
    }

    fn times(&self) -> &[f64] {
        &self.time[self.samples.clone()]
    }

    fn values(&self, name: &str, unit: &str) -> Result<Vec<f64>> {
        Ok(self.recording.channel_in(name, unit)?[self.samples.clone()].to_vec())
    }

    /// At even times from its first to its last one.
    fn even(&self, values: &[f64], interval: f64) -> Vec<f64> {
        let times = self.times();
        // sampled so already: nothing is made of other values
        if times.windows(2).all(|pair| (pair[1] - pair[0] - interval).abs() <= EVEN * interval) {
            return values.to_vec();
        }
        let (first, last) = (times[0], times[times.len() - 1]);
        let count = ((last - first) / interval + 1e-6).floor() as usize;
        (0..=count).map(|k| interpolate(times, values, (first + interval * k as f64).min(last))).collect()
    }
}

/// Counts a simulation and recordings of the same run alike, and compares them. Also returns the channels that do not vary in the recordings,
/// of which nothing can be counted.
///
/// All are brought to the longest interval of their samples, as a faster one finds higher peaks.
///
/// # Errors
/// No recording, a channel that is not in all of them, an event that does not happen, an empty window, a distance that goes back.
pub fn compare(
    simulated: &Recording,
    recorded: &[Recording],
    conditions: &Conditions,
) -> Result<(Vec<Compared>, Vec<String>)> {
    if recorded.is_empty() {
        return Err(Error::call("there is no recording to compare with"));
    }
    let own = Aligned::new(simulated, conditions, None)?;
    let others: Vec<Aligned<'_>> =
        recorded.iter().map(|r| Aligned::new(r, conditions, Some(simulated))).collect::<Result<_>>()?;
    let interval = others.iter().chain([&own]).map(|a| median_interval(a.times())).fold(0.0, f64::max);
    let names: Vec<[String; 2]> = match conditions.channels.is_empty() {
        false => conditions.channels.clone(),
        true => {
            let everywhere = |name: &&str| recorded.iter().all(|r| r.has(name));
            let names = simulated.channels.iter().map(|c| c.name.as_str()).filter(everywhere);
            names.map(|name| [name, name].map(str::to_owned)).collect()
        }
    };
    if names.is_empty() {
        return Err(Error::file(format!(
            "no channel of {} is in all recordings: --channel NAME=RECORDED says what they call it",
            simulated.source
        )));
    }
    let (mut all, mut level) = (Vec::new(), Vec::new());
    for [name, recorded_as] in &names {
        let unit = simulated.channel(name)?.unit.clone();
        let course = own.values(name, &unit)?;
        let courses: Vec<Vec<f64>> =
            others.iter().map(|o| o.values(recorded_as, &unit)).collect::<Result<_>>()?;
        let even: Vec<Vec<f64>> =
            others.iter().zip(&courses).map(|(o, values)| o.even(values, interval)).collect();
        let Some((low, high)) = extremes(&even.concat()).filter(|(low, high)| high > low) else {
            level.push(name.clone());
            continue;
        };
        let count = Counting::new([low, high], conditions, interval);
        let mut loads: Vec<Load> = even.iter().map(|values| count.load(values)).collect();
        let mut load = count.load(&own.even(&course, interval));
        // a recording that hardly moves is no measure
        let scale = if loads[0].damage > 0.0 { loads[0].damage } else { f64::NAN };
        loads.iter_mut().chain([&mut load]).for_each(|load| load.damage /= scale);
        let error = |values: &[f64], from: &Aligned<'_>, other: usize| {
            error((values, from), (&courses[other], &others[other]))
        };
        all.push(Compared {
            name: name.clone(),
            unit,
            levels: count.levels.clone(),
            values: count.values,
            gate: count.gate,
            interval,
            simulated: load,
            errors: (0..others.len()).map(|i| error(&course, &own, i)).collect::<Result<_>>()?,
            repeats: (1..others.len()).map(|i| error(&courses[0], &others[0], i)).collect::<Result<_>>()?,
            recorded: loads,
        });
    }
    Ok((all, level))
}

/// How a channel is counted.
struct Counting {
    levels: Vec<f64>,
    middle: f64,
    values: Classes,
    gate: f64,
    slope: f64,
    interval: f64,
}

impl Counting {
    fn new([low, high]: [f64; 2], conditions: &Conditions, interval: f64) -> Self {
        let values = Classes::new([low, high], conditions.classes);
        let levels = (0..conditions.classes).map(|i| low + (i as f64 + 0.5) * values.width).collect();
        Self {
            levels,
            middle: 0.5 * (low + high),
            values,
            gate: conditions.gate * (high - low),
            slope: conditions.slope,
            interval,
        }
    }

    /// The damage is the sum of ranges over a class's width to the power of the slope.
    fn load(&self, values: &[f64]) -> Load {
        let points = large_turning_points(values, self.gate);
        let counted = rainflow(&points);
        let cycles = counted.counted(Residue::Half);
        let (low, high) = extremes(values).unwrap_or((f64::NAN, f64::NAN));
        Load {
            extremes: [low, high],
            cycles: cycles.iter().map(|(_, n)| n).sum(),
            largest_range: cycles.iter().map(|(cycle, _)| cycle.range()).fold(0.0, f64::max),
            damage: cycles
                .iter()
                .map(|(cycle, n)| n * (cycle.range() / self.values.width).powf(self.slope))
                .sum(),
            crossings: level_crossings(&points, &self.levels),
            middle: level_crossings(&points, &[self.middle])[0],
            // a simulation may reach farther than the recordings
            pairs: range_pairs(&counted, Residue::Half, self.values.width, 2 * self.levels.len()),
            counted: cycles,
            spectrum: spectrum(values, self.interval),
        }
    }
}

/// Root mean square of what one course is off from another, over time or over places, where both are there.
///
/// # Errors
/// They are nowhere both there.
fn error((values, own): (&[f64], &Aligned<'_>), (others, other): (&[f64], &Aligned<'_>)) -> Result<f64> {
    // a stop is many samples at one place: the first one stands for them
    let rising = |aligned: &Aligned<'_>, values: &[f64]| {
        let mut kept: (Vec<f64>, Vec<f64>) = Default::default();
        let places = aligned.places.as_deref().unwrap_or(aligned.times());
        for (place, value) in places.iter().zip(values) {
            if kept.0.last().is_none_or(|last| place > last) {
                kept.0.push(*place);
                kept.1.push(*value);
            }
        }
        kept
    };
    let (from, values) = rising(own, values);
    let (to, others) = rising(other, others);
    let errors = to.iter().zip(&others).map(|(place, value)| interpolate(&from, &values, *place) - value);
    let errors: Vec<f64> = errors.filter(|e| e.is_finite()).collect();
    if errors.is_empty() {
        return Err(Error::file(format!(
            "{} and {} have nothing in common: {:.6} to {:.6} and {:.6} to {:.6}; an event makes a common time and place",
            own.recording.source,
            other.recording.source,
            from.first().unwrap_or(&f64::NAN),
            from.last().unwrap_or(&f64::NAN),
            to.first().unwrap_or(&f64::NAN),
            to.last().unwrap_or(&f64::NAN)
        )));
    }
    Ok(root_mean_square(errors))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::recording::Channel;

    fn run(source: &str, shift: f64, scale: f64) -> Recording {
        let time: Vec<f64> = (0..2000).map(|k| 2e-3 * f64::from(k)).collect();
        let force = |t: f64| {
            let t = t - shift;
            scale * (1000.0 * (7.0 * t).sin() + 300.0 * (31.0 * t).sin() * (-t).exp())
        };
        let channel = |name: &str, unit: &str, of: &dyn Fn(f64) -> f64| Channel {
            name: name.into(),
            unit: unit.into(),
            values: time.iter().map(|t| of(*t)).collect(),
        };
        let channels = vec![
            channel("force", "N", &force),
            channel("pressure", "bar", &|t| 50.0 * (t - shift).max(0.0)),
            channel("distance", "m", &|t| 10.0 * (t - shift)),
        ];
        Recording { time: time.clone(), channels, source: source.into() }
    }

    fn conditions() -> Conditions {
        Conditions {
            channels: vec![["force".into(), "force".into()]],
            slope: 5.0,
            gate: 0.05,
            classes: 64,
            event: None,
            // between samples: rounding decides nothing
            window: Some([0.5005, 2.9995]),
            over: None,
        }
    }

    /// The same run later: errors over time are large, from an event on and over the distance they are none; counts are the same.
    #[test]
    fn runs_are_aligned_by_an_event_or_by_a_place() {
        let (first, later) = (run("first", 0.0, 1.0), run("later", 0.4, 1.0));
        let of = |conditions: &Conditions| {
            compare(&first, std::slice::from_ref(&later), conditions).unwrap().0.remove(0)
        };
        assert!(of(&conditions()).errors[0] > 300.0);
        let event = Some(Event::parse("pressure>1e5 Pa").unwrap());
        let by_event = of(&Conditions { event, ..conditions() });
        assert!(by_event.errors[0] < 1e-6, "{}", by_event.errors[0]);
        assert_eq!(by_event.simulated.crossings, by_event.recorded[0].crossings);
        assert!((by_event.simulated.damage - 1.0).abs() < 1e-9);
        let by_place = of(&Conditions { over: Some("distance".into()), window: None, ..conditions() });
        assert!(by_place.errors[0] < 2.0, "{}", by_place.errors[0]);
        let never = Some(Event::parse("pressure>500").unwrap());
        let error =
            compare(&first, std::slice::from_ref(&later), &Conditions { event: never, ..conditions() })
                .unwrap_err();
        assert!(error.to_string().contains("first: pressure is never above 500 bar"), "{error}");
    }

    /// A tenth more on all ranges: the ranges are a tenth larger and the damage 1.1^5 times as much, outside of what repeats span.
    #[test]
    fn a_tenth_more_is_found_beside_the_scatter_of_repeats() {
        let repeats = [run("a", 0.0, 0.98), run("b", 0.0, 1.0), run("c", 0.0, 1.02)];
        let found = compare(&run("simulated", 0.0, 1.1), &repeats, &conditions()).unwrap().0.remove(0);
        let ratio = found.simulated.largest_range / found.recorded[1].largest_range;
        assert!((ratio - 1.1).abs() < 1e-9, "{ratio}");
        assert!((found.simulated.damage / found.recorded[1].damage / 1.1_f64.powi(5) - 1.0).abs() < 1e-6);
        let bands: Vec<_> = found.bands().collect();
        let off = |name: &str| bands.iter().find(|(n, _)| *n == name).unwrap().1.off();
        assert!(off("damage").unwrap() > 1.0 && off("cycles").is_none());
        let inside = compare(&run("simulated", 0.0, 1.01), &repeats, &conditions()).unwrap().0.remove(0);
        assert!(inside.bands().all(|(_, band)| band.off().is_none_or(|off| off.abs() < 1.0)));
    }

    /// Of three recordings and a fourth of the same kind, the fourth is in the band of the three in 95 of 100 cases, and in their span in 50.
    #[test]
    fn a_further_recording_is_in_the_band_as_often_as_it_says() {
        let mut random = crate::stats::SplitMix64::new(3);
        let (mut sure, mut spanned) = (0, 0);
        let cases = 20_000;
        for _ in 0..cases {
            let all: Vec<f64> = (0..4).map(|_| 100.0 + 7.0 * random.normal()).collect();
            let band = Band::new(&all[..3], all[3]);
            sure += usize::from(band.off().unwrap().abs() <= 1.0);
            spanned += usize::from(band.recorded[0] <= all[3] && all[3] <= band.recorded[1]);
        }
        for (found, expected) in [(sure, SURE), (spanned, 0.5)] {
            let share = found as f64 / f64::from(cases);
            assert!(
                (share - expected).abs() < 5.0 * (expected * (1.0 - expected) / f64::from(cases)).sqrt(),
                "{share}"
            );
        }
    }

    /// What would be compared without anything to compare: pieces of other length, places of another beginning, recordings that are all the same.
    #[test]
    fn what_says_nothing_is_not_said() {
        let (first, mut other) = (run("first", 0.0, 1.0), run("other", 0.0, 1.0));
        let of = |other: &Recording, conditions: &Conditions| {
            compare(&first, std::slice::from_ref(other), conditions)
        };
        let error =
            of(&other, &Conditions { window: Some([1.0, 9.0]), ..conditions() }).unwrap_err().to_string();
        assert!(error.contains("there is only 1.000000 s to 3.998"), "{error}");
        other.channels[2].values.iter_mut().for_each(|place| *place += 1e3);
        let over = Conditions { over: Some("distance".into()), ..conditions() };
        let error = of(&other, &over).unwrap_err().to_string();
        assert!(error.contains("nothing in common"), "{error}");
        // from an event on, places have the same beginning again
        let event = Some(Event::parse("pressure>1").unwrap());
        assert!(of(&other, &Conditions { event: event.clone(), ..over }).unwrap().0[0].errors[0] < 1e-6);
        // a value without a unit is that of the simulation
        other.channels[1].unit = "Pa".into();
        other.channels[1].values.iter_mut().for_each(|p| *p *= 1e5);
        assert!(of(&other, &Conditions { event, ..conditions() }).unwrap().0[0].errors[0] < 1e-6);
        assert!(Band::new(&[5.51, 5.51, 5.51], 5.52).off().is_none());
        let still = Recording {
            channels: vec![Channel { values: vec![2.0; 2000], ..first.channels[0].clone() }],
            ..first.clone()
        };
        let (all, level) = of(&still, &conditions()).unwrap();
        assert!(all.is_empty() && level == ["force"]);
    }

    #[test]
    fn an_event_has_a_form() {
        for text in ["pressure", "pressure>", ">5", "pressure>much", "pressure>5 furlong"] {
            let event = Event::parse(text);
            assert!(event.and_then(|e| e.sample(&run("a", 0.0, 1.0), "pressure", "bar")).is_err(), "{text}");
        }
    }
}
