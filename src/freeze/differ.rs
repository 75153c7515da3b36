//! What differs between two manifests.

use super::manifest::{Connection, Driven, Manifest, Part, Structure};
use super::stamp::Stamp;
use serde::Serialize;
use std::collections::{BTreeMap, BTreeSet};

/// One thing that is not the same.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Difference {
    /// What it is: a component, a variable, a file.
    pub what: String,
    /// What it was.
    pub was: String,
    /// What it is now.
    pub is: String,
}

/// What stands for something that is not there.
const NOTHING: &str = "not there";
/// Digits of a hash that are shown: enough to find it again.
const DIGITS: usize = 12;

/// What differs, the system as a whole first. A file of the system or of parameters whose bytes have changed is named if what was changed
/// in it is nothing else of the list, such as a comment.
pub fn differences(was: &Manifest, is: &Manifest) -> Vec<Difference> {
    let mut all = Differences::default();
    all.compare("version of latsch", &was.latsch, &is.latsch);
    structure(&mut all, &was.system, &is.system);
    for name in names(&was.component, &is.component) {
        match (was.component.get(name), is.component.get(name)) {
            (Some(was), Some(is)) => part(&mut all, name, was, is),
            (was, is) => all.compare(
                &format!("component {name}"),
                &was.map_or(NOTHING.into(), source),
                &is.map_or(NOTHING.into(), source),
            ),
        }
    }
    for name in names(&sources(was), &sources(is)) {
        let of = |manifest: &Manifest| sources(manifest).get(name).cloned().unwrap_or(NOTHING.into());
        all.compare(&format!("source of {name}"), &of(was), &of(is));
    }
    let pairs = |manifest: &Manifest| {
        let pairs = manifest.bond.iter().map(|b| format!("{} and {}", b.effort, b.motion));
        pairs.collect::<Vec<_>>().join(", ")
    };
    all.compare("bonds", &pairs(was), &pairs(is));
    let said = all.list.len();
    // each recording once, whatever follows it
    let recordings = |manifest: &Manifest| -> BTreeMap<String, Stamp> {
        manifest.input.values().map(|d| (d.recording.file.clone(), d.recording.clone())).collect()
    };
    let (before, now) = (recordings(was), recordings(is));
    for (file, stamp) in &before {
        if let Some(other) = now.get(file) {
            all.bytes(stamp, other);
        }
    }
    if said == 0 {
        all.bytes(&was.system.file, &is.system.file);
    }
    all.list
}

#[derive(Default)]
struct Differences {
    list: Vec<Difference>,
}

impl Differences {
    fn compare(&mut self, what: &str, was: &str, is: &str) {
        if was != is {
            self.list.push(Difference { what: what.into(), was: was.into(), is: is.into() });
        }
    }

    /// Files of one name.
    fn bytes(&mut self, was: &Stamp, is: &Stamp) {
        let short = |stamp: &Stamp| {
            let digits: String = stamp.sha256.chars().take(DIGITS).collect();
            format!("sha256 {digits}...")
        };
        if was.sha256 != is.sha256 {
            self.compare(&format!("bytes of {}", is.file), &short(was), &short(is));
        }
    }
}

fn names<'a, T>(a: &'a BTreeMap<String, T>, b: &'a BTreeMap<String, T>) -> BTreeSet<&'a String> {
    a.keys().chain(b.keys()).collect()
}

fn structure(all: &mut Differences, was: &Structure, is: &Structure) {
    all.compare("file of the system", &was.file.file, &is.file.file);
    let time = |time: Option<f64>| time.map_or(NOTHING.to_owned(), |time| format!("{time} s"));
    all.compare("communication step", &time(was.step), &time(is.step));
    all.compare("start", &time(was.start), &time(is.start));
    all.compare("stop", &time(was.stop), &time(is.stop));
    let order =
        |of: &Structure| of.order.as_ref().map_or("side by side".to_owned(), |names| names.join(", "));
    all.compare("order", &order(was), &order(is));
    all.compare("repetitions of an interval", &was.iterate.to_string(), &is.iterate.to_string());
    all.compare("halvings of an interval", &was.halvings.to_string(), &is.halvings.to_string());
    all.compare(
        "communication points per sample",
        &was.record_every.to_string(),
        &is.record_every.to_string(),
    );
}

/// What a component is made from, in a few words.
fn source(part: &Part) -> String {
    let name = |name: &Option<String>| name.as_deref().unwrap_or_default().to_owned();
    match (&part.model, &part.fmu) {
        (Some(model), _) => format!("model {model}"),
        (None, Some(fmu)) => format!("{} ({})", fmu.file, name(&part.model_name)),
        (None, None) => NOTHING.into(),
    }
}

fn part(all: &mut Differences, name: &str, was: &Part, is: &Part) {
    let before = all.list.len();
    let exchanged = source(was) != source(is);
    all.compare(&format!("component {name}"), &source(was), &source(is));
    let text = |text: &Option<String>| text.clone().unwrap_or(NOTHING.into());
    all.compare(&format!("GUID of {name}"), &text(&was.guid), &text(&is.guid));
    all.compare(&format!("tool that made {name}"), &text(&was.generation_tool), &text(&is.generation_tool));
    if let (Some(was), Some(is)) = (&was.fmu, &is.fmu) {
        all.bytes(was, is);
    }
    let file = |part: &Part| part.parameters.as_ref().map_or(NOTHING.to_owned(), |stamp| stamp.file.clone());
    all.compare(&format!("parameter file of {name}"), &file(was), &file(is));
    for variable in names(&was.values, &is.values) {
        let shown = |value: &toml::Value| match value {
            toml::Value::String(text) => text.clone(),
            other => other.to_string(),
        };
        match (was.values.get(variable), is.values.get(variable)) {
            (Some(was), Some(is)) => all.compare(&format!("{name}.{variable}"), &shown(was), &shown(is)),
            // another model has other variables
            _ if exchanged => {}
            // an input that is driven now, or was: its source is told
            (was, is) => {
                let of = |value: Option<&toml::Value>| value.map_or(NOTHING.to_owned(), shown);
                all.compare(&format!("{name}.{variable}"), &of(was), &of(is));
            }
        }
    }
    if let (Some(was), Some(is), true) = (&was.parameters, &is.parameters, all.list.len() == before) {
        all.bytes(was, is);
    }
}

/// Where each driven input has its values from, in a few words.
fn sources(manifest: &Manifest) -> BTreeMap<String, String> {
    let held = |derivative: bool| if derivative { ", linear within an interval" } else { "" };
    let connection = |c: &Connection| {
        let linear = match (c.factor, c.offset) {
            (None, None) => String::new(),
            (factor, offset) => {
                format!(", times {} plus {}", factor.unwrap_or(1.0), offset.unwrap_or(0.0))
            }
        };
        let units = if c.keep_units { ", units left alone" } else { "" };
        format!("{}{linear}{units}{}", c.from, held(c.derivative))
    };
    let driven = |d: &Driven| format!("channel {} of {}{}", d.channel, d.recording.file, held(d.derivative));
    let wires = manifest.connection.iter().map(|(to, c)| (to.clone(), connection(c)));
    wires.chain(manifest.input.iter().map(|(to, d)| (to.clone(), driven(d)))).collect()
}
