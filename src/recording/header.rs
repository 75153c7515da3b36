//! The heads of files in columns, of CSV above all: what the columns are.

use super::{Channel, Recording};
use crate::model::unit::Unit;
use crate::{Error, Result};
use csv::StringRecord;
use serde::Deserialize;
use std::collections::{BTreeMap, HashMap};

/// What the rows of a file are over.
pub(super) struct Axis {
    /// Its name.
    pub name: &'static str,
    /// The unit that it is converted to.
    pub unit: &'static str,
    /// What that unit is one of.
    pub quantity: &'static str,
    /// Whether a row may have the value of the row before.
    pub repeats: bool,
}

/// What a column is, in place of what its header says.
#[derive(Debug, Clone, Default, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Column {
    /// Its name, `time` for the time; without one the column is left out, whatever is in it.
    pub variable: Option<String>,
    /// Its unit, if the header has none or a wrong one.
    pub unit: Option<String>,
}

/// What the columns of files are, in place of what stands above them.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Columns {
    /// By what stands above a column, with its unit or without.
    pub named: BTreeMap<String, Column>,
    /// Leave out the columns that are not among those.
    pub only_named: bool,
    /// The column at whose times all are taken where a file has columns of several rates.
    pub times_of: Option<String>,
}

impl Columns {
    /// What is said of the column below this title: by all of it, or by the name before the unit.
    pub(super) fn of(&self, title: &str) -> Option<&Column> {
        self.named.get(title).or_else(|| self.named.get(name_and_unit(title)?.0))
    }

    /// Whether the column below this title is not read. The time is always read.
    pub(super) fn leaves_out(&self, title: &str) -> bool {
        self.of(title).map_or(self.only_named, |column| column.variable.is_none())
    }
}

/// A recording whose channels are what is said of them.
///
/// # Errors
/// A unit that is not known, two channels of one name.
pub(super) fn renamed(recording: Recording, columns: &Columns) -> Result<Recording> {
    let Recording { time, channels, source } = recording;
    let mut named: Vec<Channel> = Vec::new();
    for channel in channels {
        let said = columns
            .named
            .get(&channel.name)
            .or_else(|| columns.named.get(&format!("{} [{}]", channel.name, channel.unit)));
        let channel = match said {
            None if columns.only_named => continue,
            None => channel,
            Some(Column { variable: None, .. }) => continue,
            Some(Column { variable: Some(name), unit }) => Channel {
                name: name.clone(),
                unit: unit.clone().unwrap_or(channel.unit),
                values: channel.values,
            },
        };
        let place = || format!("{source}: channel {:?}", channel.name);
        Unit::parse(&channel.unit).map_err(|e| Error::file(e.to_string()).at(place()))?;
        if named.iter().any(|other| other.name == channel.name) {
            return Err(Error::file("two channels have this name; names have to be unique").at(place()));
        }
        named.push(channel);
    }
    Ok(Recording { time, channels: named, source })
}

/// What stands above the numbers.
pub(super) struct Titles {
    /// The first line that is no comment.
    pub names: StringRecord,
    /// Its number, in files that have lines.
    pub line: Option<u64>,
    /// A line with nothing but units, and its number.
    pub units: Option<(StringRecord, u64)>,
}

impl Titles {
    /// Whether no column has a unit.
    pub fn lack_units(&self, given: &Columns) -> bool {
        let has = |cell: &str| {
            name_and_unit(cell).is_some() || given.of(cell).is_some_and(|column| column.unit.is_some())
        };
        !self.names.iter().any(has)
    }

    /// The column that the rows are over: the one that is said to be, else the one with that name, else the first.
    pub fn time(&self, axis: &Axis, given: &Columns) -> usize {
        let is_said =
            |cell: &str| given.of(cell).is_some_and(|column| column.variable.as_deref() == Some(axis.name));
        let find = |is_it: &dyn Fn(&str) -> bool| self.names.iter().position(is_it);
        find(&is_said)
            .or_else(|| find(&|cell| axis.is_called(name_and_unit(cell).map_or(cell, |(name, _)| name))))
            .unwrap_or(0)
    }

    /// What to do about a column without unit.
    fn no_unit(&self, name: &str, column: usize, given: &Columns) -> String {
        if self.line.is_some() {
            return format!(
                "no unit; write `{name} [unit]`, for instance `{name} [N]`, or `{name} [1]` for a number without unit"
            );
        }
        let lacks = |title: &&str| {
            !given.leaves_out(title)
                && name_and_unit(title).is_none()
                && given.of(title).is_none_or(|column| column.unit.is_none())
        };
        let others = self.names.iter().skip(column + 1).filter(lacks).count();
        let others = match others {
            0 => String::new(),
            1 => ", and one more has none".into(),
            more => format!(", and {more} more have none"),
        };
        format!(
            "no unit{others}; a file of --map says it: \"{name}\" = {{ variable = \"{name}\", unit = \"N\" }} below [channels]; with only_named = true at its top, it leaves out what it does not name"
        )
    }

    /// The unit in the second line: nothing stands for a number without one.
    fn unit(&self, column: usize) -> Option<&str> {
        let (units, _) = self.units.as_ref()?;
        let cell = units.get(column)?;
        let inner = [('[', ']'), ('(', ')')]
            .into_iter()
            .find_map(|(open, close)| cell.strip_prefix(open)?.strip_suffix(close));
        Some(match inner.unwrap_or(cell).trim() {
            "" => "1",
            unit => unit,
        })
    }
}

impl Axis {
    /// Whether that is its name, in any letters.
    fn is_called(&self, name: &str) -> bool {
        name.eq_ignore_ascii_case(self.name)
    }

    /// Whether a column may be it: the first one may be `t`.
    fn may_be(&self, name: &str, column: usize) -> bool {
        self.is_called(name) || column == 0 && self.name == "time" && name.eq_ignore_ascii_case("t")
    }
}

/// What the header line says.
pub(super) struct Header {
    /// The recording without samples.
    pub recording: Recording,
    /// How messages call the columns: name and number.
    pub columns: Vec<String>,
    /// What each column is: the time, a channel by its number, or nothing that is read.
    pub places: Vec<Option<Option<usize>>>,
    /// From the first column's unit to that of the axis.
    pub factor: f64,
}

impl Header {
    /// What titles say; `names` go over them.
    ///
    /// # Errors
    /// See [`read_csv`](super::read_csv).
    pub fn parse(axis: &Axis, names: &Columns, titles: &Titles, source: &str) -> Result<Self> {
        let mut recording = Recording { source: source.into(), ..Recording::default() };
        let (mut columns, mut places) = (Vec::new(), Vec::new());
        let mut seen = HashMap::new();
        let mut factor = 1.0;
        let Axis { name: axis_name, unit: axis_unit, quantity, .. } = axis;
        let time = titles.time(axis, names);
        let line = titles.units.as_ref().map_or(titles.line, |(_, line)| Some(*line));
        let place = line.map_or_else(|| format!("{source}: "), |line| format!("{source}:{line}:"));
        if let Some((units, line)) = &titles.units
            && units.len() != titles.names.len()
        {
            return Err(Error::file(format!(
                "{source}:{line}: the header has {} cells, this line of units has {}",
                titles.names.len(),
                units.len()
            )));
        }
        for (i, cell) in titles.names.iter().enumerate() {
            let (number, given) = (i + 1, names.of(cell));
            let fail = |column: &str, what: String| {
                Err(Error::file(format!("{place}{column} (column {number}): {what}")))
            };
            let own = name_and_unit(cell);
            if i != time && names.leaves_out(cell) {
                columns.push(format!("{cell} (column {number})"));
                places.push(None);
                continue;
            }
            let named = given.and_then(|column| Some((column.variable.as_deref()?, column.unit.as_deref())));
            let (name, unit) = match (named, own) {
                (Some((name, unit)), own) => (name, unit.or(own.map(|(_, unit)| unit))),
                (None, Some((name, unit))) => (name, Some(unit)),
                (None, None) => (cell, None),
            };
            let Some(unit) = unit.or(titles.unit(i)) else {
                if cell.is_empty() {
                    return fail("", "the header cell is empty; write `name [unit]`".into());
                }
                if i == time && given.is_none() && (titles.line.is_some() || !axis.may_be(name, i)) {
                    return fail(
                        cell,
                        format!("a column has to be the {quantity}, `{axis_name} [{axis_unit}]`"),
                    );
                }
                return fail(cell, titles.no_unit(name, i, names));
            };
            let parsed = match Unit::parse(unit) {
                Ok(unit) => unit,
                Err(e) => return fail(name, format!("{e}; write [1] for a number without unit")),
            };
            let own = if i == time { *axis_name } else { name };
            if let Some(first) = seen.insert(own.to_owned(), number) {
                return fail(name, format!("column {first} has the same name; names have to be unique"));
            }
            columns.push(format!("{name} (column {number})"));
            if i != time {
                places.push(Some(Some(recording.channels.len())));
                recording.channels.push(Channel { name: name.into(), unit: unit.into(), values: Vec::new() });
                continue;
            }
            places.push(Some(None));
            if !axis.may_be(name, i) {
                return fail(name, format!("no column is the {quantity}, `{axis_name} [{axis_unit}]`"));
            }
            match Unit::parse(axis_unit).ok().and_then(|si| parsed.to(si)) {
                Some((to_si, _)) => factor = to_si,
                None => {
                    return fail(
                        name,
                        format!("{unit:?} is no unit of {quantity}; write `{axis_name} [{axis_unit}]`"),
                    );
                }
            }
        }
        Ok(Self { recording, columns, places, factor })
    }
}

/// Splits `name [unit]`. Without the space, and in parentheses, `name(unit)`, only what is a unit is taken for one: `x[1]` may be the name
/// of an element, `force (raw)` that of a signal.
fn name_and_unit(cell: &str) -> Option<(&str, &str)> {
    let split = |open: char, close: char| {
        let (name, unit) = cell.strip_suffix(close)?.rsplit_once(open)?;
        let trimmed = name.trim_end();
        (!trimmed.is_empty()).then(|| (trimmed, unit.trim(), trimmed.len() < name.len()))
    };
    let is_unit = |unit: &str| unit.parse::<f64>().is_err() && Unit::parse(unit).is_ok();
    match (split('[', ']'), split('(', ')')) {
        (Some((name, unit, has_space)), _) if has_space || is_unit(unit) => Some((name, unit)),
        (None, Some((name, unit, _))) if is_unit(unit) => Some((name, unit)),
        _ => None,
    }
}
