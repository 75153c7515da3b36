//! The numbers of a TYDEX file: `**MEASURDATA`, with what `**MEASURCHANNELS` says of its columns.

use super::channels::{RUNTIME, converts};
use super::record::record;
use super::sections::{Line, Sections};
use crate::model::unit::Unit;
use crate::recording::form::MAX_COLUMNS;
use crate::{Error, Result};
use std::collections::HashMap;

/// Where a value is missing.
pub const MISSING: &str = "NOTAVAIL";
/// Width of a field of `**MEASURDATA` \[characters\].
const FIELD: usize = 10;

/// A channel of the file.
pub struct Column {
    /// The line that says what it is.
    pub line: usize,
    /// Which of the channels it is, from 1.
    number: usize,
    /// Its name there, in capitals.
    pub tydex: String,
    /// Its unit in the notation of recordings; `None` where the file names none.
    pub unit: Option<String>,
    conversion: Conversion,
    /// Its values, converted; NaN where one is missing.
    pub values: Vec<f64>,
}

/// How measured values become physical ones.
#[derive(Debug, Clone, Copy)]
struct Conversion {
    factor: f64,
    /// Shift of the measured value, in what was measured.
    measured: f64,
    /// Shift of the physical value, in the channel's unit.
    physical: f64,
}

/// How the fields of a row are told apart.
#[derive(Debug, Clone, Copy)]
enum Layout {
    /// There are blanks between them.
    Blanks,
    /// All are ten characters wide, whether there are blanks or not.
    Columns,
}

/// The channels of a file.
pub struct Table<'a> {
    source: &'a str,
    rows: &'a [Line<'a>],
    pub columns: Vec<Column>,
}

impl<'a> Table<'a> {
    /// Reads channels and numbers.
    ///
    /// # Errors
    /// See [`read_tydex`](super::read_tydex).
    pub fn of(sections: &'a Sections<'a>, source: &'a str) -> Result<Self> {
        let columns = columns(sections.needed("MEASURCHANNELS", "names and units of the channels")?, source)?;
        let rows = sections.needed("MEASURDATA", "the numbers")?;
        if rows.len() < 2 {
            return Err(Error::file(format!(
                "{source}: {} row{} of numbers in **MEASURDATA; at least 2 are needed",
                rows.len(),
                if rows.len() == 1 { "" } else { "s" }
            )));
        }
        let mut table = Self { source, rows, columns };
        // A file with blanks between all numbers is one of numbers with blanks between them: where it can be read in
        // columns as well, that gives the same, as no field of ten characters then holds two numbers or none. Numbers
        // without blanks between them are only told apart by columns. If neither reads all rows, the way that goes
        // further is the one that is meant.
        let values = table.values(Layout::Blanks).or_else(|(row, error)| {
            table
                .values(Layout::Columns)
                .map_err(|(further, other)| if further > row { other } else { error })
        })?;
        table.columns.iter_mut().zip(values).for_each(|(column, values)| column.values = values);
        Ok(table)
    }

    /// The values of all columns; or the first row in which something is wrong, and what.
    fn values(&self, layout: Layout) -> std::result::Result<Vec<Vec<f64>>, (usize, Error)> {
        let mut values = vec![Vec::new(); self.columns.len()];
        for (i, row) in self.rows.iter().enumerate() {
            let cells = layout.cells(row.text, self.columns.len());
            if cells.len() != self.columns.len() {
                let error = format!(
                    "{}:{}: there are {} channels, this row has {}",
                    self.source,
                    row.number,
                    self.columns.len(),
                    layout.count(row.text)
                );
                return Err((i, Error::file(error)));
            }
            for (k, (cell, column)) in cells.iter().zip(&self.columns).enumerate() {
                let value = number(cell, column.conversion);
                let at = |what: String| (i, Error::file(format!("{}: {what}", self.place(i, k))));
                values[k].push(value.map_err(at)?);
            }
        }
        Ok(values)
    }

    /// What messages call a number.
    fn place(&self, row: usize, column: usize) -> String {
        let Column { tydex, number, .. } = &self.columns[column];
        format!("{}:{}:{tydex} (channel {number})", self.source, self.rows[row].number)
    }

    /// Takes the time \[s\] out of the channels.
    ///
    /// # Errors
    /// There is none; it has another unit; it does not increase; it is missing somewhere.
    pub fn take_time(&mut self) -> Result<Vec<f64>> {
        let Some(index) = self.columns.iter().position(|column| column.tydex == RUNTIME) else {
            return Err(Error::file(format!(
                "{}: no channel {RUNTIME}: these are points without time, such as those of a characteristic; a recording needs the time \
                 of each row",
                self.source
            )));
        };
        self.refuse_missing(index)?;
        let column = &self.columns[index];
        let unit = column.unit.as_deref().unwrap_or("");
        if !converts(unit, "s") {
            let at = format!("{}:{}:{RUNTIME}", self.source, column.line);
            return Err(Error::file(format!("{at}: {unit:?} is no unit of time; write s")));
        }
        let (factor, _) = Unit::parse(unit)?.to(Unit::parse("s")?).unwrap_or((1.0, 0.0));
        let time: Vec<f64> = column.values.iter().map(|value| value * factor).collect();
        if let Some(row) = (1..time.len()).find(|row| time[*row] <= time[row - 1]) {
            let (now, before) = (time[row], time[row - 1]);
            let place = self.place(row, index);
            return Err(Error::file(format!(
                "{place}: {now} s comes after {before} s; time has to increase from row to row"
            )));
        }
        self.columns.remove(index);
        Ok(time)
    }

    /// Leaves out channels without any value.
    ///
    /// # Errors
    /// Only some values of a channel are missing.
    pub fn leave_out_what_is_missing(&mut self) -> Result<()> {
        self.columns.retain(|column| !column.values.iter().all(|value| value.is_nan()));
        (0..self.columns.len()).try_for_each(|column| self.refuse_missing(column))
    }

    fn refuse_missing(&self, column: usize) -> Result<()> {
        match self.columns[column].values.iter().position(|value| value.is_nan()) {
            None => Ok(()),
            Some(row) => Err(Error::file(format!(
                "{}: {MISSING}: a recording has a value in every row; leave out these rows, or the channel",
                self.place(row, column)
            ))),
        }
    }
}

/// What the lines of `**MEASURCHANNELS` say.
fn columns(lines: &[Line<'_>], source: &str) -> Result<Vec<Column>> {
    let mut columns: Vec<Column> = Vec::new();
    let mut seen = HashMap::new();
    for Line { number: line, text } in lines {
        let said = record(text, 3).map_err(|what| Error::file(format!("{source}:{line}: {what}")))?;
        let fail = |what: String| Err(Error::file(format!("{source}:{line}:{}: {what}", said.name)));
        if let Some(first) = seen.insert(said.name.clone(), line) {
            return fail(format!("line {first} has the same name; names have to be unique"));
        }
        let [factor, measured, physical] = said.numbers;
        let conversion = Conversion {
            factor: factor.unwrap_or(1.0),
            measured: measured.unwrap_or(0.0),
            physical: physical.unwrap_or(0.0),
        };
        if conversion.factor == 0.0 {
            return fail("the conversion factor is 0: it would make all values the same".into());
        }
        if columns.len() == MAX_COLUMNS {
            return fail(format!("no more than {MAX_COLUMNS} channels are read"));
        }
        let (number, values) = (columns.len() + 1, Vec::new());
        columns.push(Column { line: *line, number, tydex: said.name, unit: said.unit, conversion, values });
    }
    Ok(columns)
}

impl Conversion {
    /// Values that need no conversion keep their bits. The names of the three numbers are printed, the formula is what they say.
    fn physical(self, value: f64) -> f64 {
        let Self { factor, measured, physical } = self;
        if (factor, measured, physical) == (1.0, 0.0, 0.0) {
            return value;
        }
        factor * (value + measured) + physical
    }
}

impl Layout {
    /// The fields of a row of `count`; some other number of fields if it has not as many.
    fn cells(self, row: &str, count: usize) -> Vec<&str> {
        match self {
            Self::Blanks => row.split_whitespace().take(count + 1).collect(),
            // a number has no characters of other alphabets
            Self::Columns if !row.is_ascii() => Vec::new(),
            Self::Columns => {
                let fields = row.len().div_ceil(FIELD).min(count + 1);
                (0..fields).map(|i| row[i * FIELD..row.len().min((i + 1) * FIELD)].trim()).collect()
            }
        }
    }

    /// How many fields a row has.
    fn count(self, row: &str) -> usize {
        match self {
            Self::Blanks => row.split_whitespace().count(),
            Self::Columns => row.len().div_ceil(FIELD),
        }
    }
}

/// The value of a field, NaN if it is missing; or what is wrong with it.
fn number(cell: &str, conversion: Conversion) -> std::result::Result<f64, String> {
    if cell == MISSING {
        return Ok(f64::NAN);
    }
    match cell.parse::<f64>() {
        Ok(value) if value.is_finite() => {
            let physical = conversion.physical(value);
            let fail = || format!("{cell:?}, converted as the channel's line says, is not a finite number");
            if physical.is_finite() { Ok(physical) } else { Err(fail()) }
        }
        Ok(_) => Err(format!("{cell:?} is not a finite number; what is missing is {MISSING}")),
        Err(_) if cell.contains(',') => Err(format!("{cell:?} is not a number; a decimal point is needed")),
        Err(_) => Err(format!("{cell:?} is not a number")),
    }
}
