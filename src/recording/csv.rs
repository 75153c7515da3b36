//! Recordings as CSV: a header line of `name [unit]` cells, one of them the time; and the dialects of that which programs write.

use super::Recording;
use super::form::{BLOCK, Defect, MAX_COLUMNS, check_lengths, long_enough, out_of_order, read_bytes};
use super::header::{Axis, Columns, Header, Titles};
use super::shortest::push_shortest;
use crate::{Error, Result};
use std::io::Write;
use std::path::Path;

/// Characters that may separate cells.
const SEPARATORS: [u8; 3] = [b',', b';', b'\t'];
/// A line that begins with it is a comment.
const COMMENT: u8 = b'#';

/// Reads a CSV file: UTF-8, cells separated by `,`, `;` or tab (found in the header line, or said by a first line `sep=;`), numbers with
/// a decimal point (or, unless commas separate the cells, a decimal comma throughout), a header of
/// `name [unit]` cells with `time [s]` among them (or another unit of time, which is converted).
///
/// Units may also be in parentheses, `Force (N)`, or in a second line for all columns, where nothing stands for a number without unit.
/// The time may be called `Time`, in any letters, or `t` if it is the first column. Lines that begin with `#` are comments.
///
/// # Errors
/// A file that cannot be read, or content that is not as above: no time column, a column without
/// unit or with an unknown one, a name used twice, a cell that is no finite number, a row of another
/// length, a time that does not increase, fewer than two rows. The message begins with
/// `file:line:column`.
pub fn read_csv(path: &Path) -> Result<Recording> {
    read_csv_over(&TIME, path)
}

pub(super) const TIME: Axis = Axis { name: "time", unit: "s", quantity: "time", repeats: false };

/// Reads a CSV file whose first column is not the time. It still is `time` of the recording.
///
/// # Errors
/// As [`read_csv`].
pub(super) fn read_csv_over(axis: &Axis, path: &Path) -> Result<Recording> {
    let (text, source) = read_text(path)?;
    parse_csv_over(axis, &text, &source)
}

fn read_text(path: &Path) -> Result<(String, String)> {
    let (bytes, source) = read_bytes(path)?;
    let text = String::from_utf8(bytes).map_err(|e| {
        let valid = &e.as_bytes()[..e.utf8_error().valid_up_to()];
        let line = 1 + valid.iter().filter(|b| **b == b'\n').count();
        Error::file(format!("{source}:{line}: not UTF-8 text; save the file as UTF-8"))
    })?;
    Ok((text, source))
}

/// Reads CSV text, see [`read_csv`]; `source` stands for the file's name in messages.
///
/// # Errors
/// As [`read_csv`].
pub fn parse_csv(text: &str, source: &str) -> Result<Recording> {
    parse_csv_over(&TIME, text, source)
}

/// Reads a CSV file of which single rows and cells may be bad: what is no finite number becomes NaN, a
/// row of another length than the header's is NaN throughout, times may do what they like.
///
/// # Errors
/// A file that cannot be read, a header that [`read_csv`] refuses (but for what `names` says of columns, by what stands in the
/// header, with the unit or without), fewer than two rows.
pub(crate) fn read_csv_with_defects(path: &Path, names: &Columns) -> Result<(Recording, Vec<Defect>)> {
    let (text, source) = read_text(path)?;
    let mut defects = Vec::new();
    let recording = parse_rows(&TIME, names, &text, &source, &mut |defect| {
        defects.push(defect);
        Ok(())
    })?;
    Ok((recording, defects))
}

/// Reads a CSV file whose columns are what is said of them.
///
/// # Errors
/// As [`read_csv`].
pub(super) fn read_csv_as(path: &Path, names: &Columns) -> Result<Recording> {
    let (text, source) = read_text(path)?;
    parse_rows(&TIME, names, &text, &source, &mut |defect| Err(defect.error))
}

fn parse_csv_over(axis: &Axis, text: &str, source: &str) -> Result<Recording> {
    parse_rows(axis, &Columns::default(), text, source, &mut |defect| Err(defect.error))
}

/// Reads CSV text; `judge` says of every bad cell, row and order of times whether to go on.
fn parse_rows(
    axis: &Axis,
    names: &Columns,
    text: &str,
    source: &str,
    judge: &mut dyn FnMut(Defect) -> Result<()>,
) -> Result<Recording> {
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    let (separator, text, first_line) = match said_separator(text) {
        Some((separator, rest)) => (separator, rest, 2),
        None => (separator(behind_comments(text.as_bytes())), text, 1),
    };
    let mut lines = Lines { text: text.as_bytes(), byte: 0, line: first_line };
    refuse_wide_rows(text.as_bytes(), separator, source)?;
    let mut reader = csv::ReaderBuilder::new()
        .delimiter(separator)
        .has_headers(false)
        .flexible(true)
        .comment(Some(COMMENT))
        .trim(csv::Trim::All)
        .from_reader(text.as_bytes());
    let mut record = csv::StringRecord::new();
    let mut next = |record: &mut csv::StringRecord| -> Result<Option<u64>> {
        let more =
            reader.read_record(record).map_err(|e| Error::file(format!("{source}: no CSV text: {e}")))?;
        let byte = record.position().map_or(0, csv::Position::byte);
        Ok(more.then(|| lines.number(byte as usize)))
    };

    let Some(line) = next(&mut record)? else {
        return Err(Error::file(format!(
            "{source}: the file is empty; a header line of `name [unit]` cells that begins with `{} [{}]` is needed",
            axis.name, axis.unit
        )));
    };
    let mut titles = Titles { names: record.clone(), line: Some(line), units: None };
    refuse_rows_as_comments(text.as_bytes(), separator, first_line, &titles, source)?;
    let mut pending = next(&mut record)?;
    if let Some(line) = pending
        && titles.lack_units(names)
        && record.get(titles.time(axis, names)).is_some_and(|cell| number(cell, &mut None).is_err())
    {
        titles.units = Some((record.clone(), line));
        pending = None;
    }
    let Header { mut recording, columns, places, factor } = Header::parse(axis, names, &titles, source)?;

    // the decimal mark is the first that is seen; a comma between commas could be anything
    let mut mark = (separator == b',').then_some('.');
    while let Some(line) = match pending.take() {
        None => next(&mut record)?,
        read => read,
    } {
        let row = recording.time.len();
        if record.len() != columns.len() {
            let error = Error::file(format!(
                "{source}:{line}: the header has {} cells, this row has {}{}",
                columns.len(),
                record.len(),
                if record.len() > columns.len() { "; numbers need a decimal point, not a comma" } else { "" }
            ));
            judge(Defect { row, channel: None, error })?;
            recording.time.push(f64::NAN);
            recording.channels.iter_mut().for_each(|channel| channel.values.push(f64::NAN));
            continue;
        }
        for ((cell, column), place) in record.iter().zip(&columns).zip(&places) {
            let Some(channel) = *place else { continue };
            let value = match number(cell, &mut mark) {
                Ok(value) => value,
                Err(what) => {
                    let error = Error::file(format!("{source}:{line}:{column}: {what}"));
                    judge(Defect { row, channel, error })?;
                    f64::NAN
                }
            };
            let Some(channel) = channel else {
                let time = value * factor;
                if let Some(error) =
                    out_of_order(axis, &recording, time, &|| format!("{source}:{line}:{column}"))
                {
                    judge(Defect { row, channel: None, error })?;
                }
                recording.time.push(time);
                continue;
            };
            recording.channels[channel].values.push(value);
        }
    }
    long_enough(recording)
}

/// Fails for a line with more cells than a recording may have columns.
fn refuse_wide_rows(text: &[u8], separator: u8, source: &str) -> Result<()> {
    for (i, line) in text.split(|byte| *byte == b'\n').enumerate() {
        let cells = line.iter().filter(|byte| **byte == separator).count() + 1;
        if cells > MAX_COLUMNS {
            return Err(Error::file(format!(
                "{source}:{}: the line has {cells} cells; no more than {MAX_COLUMNS} are read",
                i + 1
            )));
        }
    }
    Ok(())
}

/// Fails for a comment behind the header with as many cells as that has: a spreadsheet writes `#N/A` where it has no number.
fn refuse_rows_as_comments(
    text: &[u8],
    separator: u8,
    first_line: u64,
    titles: &Titles,
    source: &str,
) -> Result<()> {
    let lines = (first_line..).zip(text.split(|byte| *byte == b'\n'));
    let behind = lines.filter(|(line, text)| Some(*line) > titles.line && text.first() == Some(&COMMENT));
    for (line, text) in behind {
        let cells = text.iter().filter(|byte| **byte == separator).count() + 1;
        if cells > 1 && cells == titles.names.len() {
            return Err(Error::file(format!(
                "{source}:{line}: the line begins with # and has as many cells as the header; a row begins with a number, a comment has no {:?} between its words",
                char::from(separator)
            )));
        }
    }
    Ok(())
}

/// A finite number, or what is wrong with the cell. A decimal comma is as good as a point, but not
/// both in one file: it could separate thousands.
fn number(cell: &str, mark: &mut Option<char>) -> std::result::Result<f64, String> {
    if cell.is_empty() {
        return Err("the cell is empty; every cell needs a number".into());
    }
    match cell.parse::<f64>() {
        Ok(number) if number.is_finite() => {
            let point = cell.contains('.');
            if point && *mark.get_or_insert('.') == ',' {
                return Err(format!("{cell:?} has a decimal point, but the numbers before have a comma"));
            }
            Ok(number)
        }
        Ok(_) => Err(format!("{cell:?} is not a finite number")),
        Err(_) => match cell.replacen(',', ".", 1).parse::<f64>() {
            Ok(number) if number.is_finite() && *mark.get_or_insert(',') == ',' => Ok(number),
            Ok(_) => Err(format!("{cell:?} has a decimal comma; a decimal point is needed in this file")),
            Err(_) => Err(format!("{cell:?} is not a number")),
        },
    }
}

/// The separator in a first line `sep=;`, as spreadsheets write it, and the text behind that.
fn said_separator(text: &str) -> Option<(u8, &str)> {
    let (first, rest) = text.split_once('\n')?;
    match first.trim_end_matches('\r').as_bytes() {
        [b's' | b'S', b'e' | b'E', b'p' | b'P', b'=', separator] if SEPARATORS.contains(separator) => {
            Some((*separator, rest))
        }
        _ => None,
    }
}

/// The text from the first line on that is no comment.
fn behind_comments(mut text: &[u8]) -> &[u8] {
    while text.first() == Some(&COMMENT) {
        let end = text.iter().position(|byte| matches!(byte, b'\n' | b'\r')).unwrap_or(text.len());
        let rest = &text[end..];
        let line_break = rest.iter().position(|byte| !matches!(byte, b'\n' | b'\r')).unwrap_or(rest.len());
        text = &rest[line_break..];
    }
    text
}

/// The separator that the header line has most of, outside quotes.
fn separator(text: &[u8]) -> u8 {
    let mut counts = [0; SEPARATORS.len()];
    let (mut quoted, mut anything) = (false, false);
    for byte in text {
        match byte {
            b'"' => quoted = !quoted,
            b'\n' | b'\r' if !quoted && anything => break,
            b'\n' | b'\r' => continue,
            _ if quoted => {}
            _ => {
                if let Some(i) = SEPARATORS.iter().position(|s| s == byte) {
                    counts[i] += 1;
                }
            }
        }
        anything = true;
    }
    let most = (0..SEPARATORS.len()).rev().max_by_key(|i| counts[*i]).unwrap_or(0);
    SEPARATORS[most]
}

/// Counts lines as an editor does. The reader's own count stands before blank lines and comments that it skips.
struct Lines<'a> {
    text: &'a [u8],
    byte: usize,
    line: u64,
}

impl Lines<'_> {
    /// The line of the first row at or after `byte`; rows are asked for in order.
    fn number(&mut self, byte: usize) -> u64 {
        let mut in_comment = false;
        while let Some(b) = self.text.get(self.byte) {
            let ends_line = matches!(b, b'\r' | b'\n');
            in_comment = !ends_line && (in_comment || *b == COMMENT && self.byte >= byte);
            if self.byte >= byte && !ends_line && !in_comment {
                break;
            }
            // an old Mac's lone carriage return ends a line, too
            let ends = *b == b'\n' || (*b == b'\r' && self.text.get(self.byte + 1) != Some(&b'\n'));
            self.line += u64::from(ends);
            self.byte += 1;
        }
        self.line
    }
}

/// Writes a recording as CSV that [`read_csv`] reads back with the same bits, through a temporary file:
/// there is never half a result. Values that are not finite are written as they are, so that a run
/// that went wrong can be looked at; [`read_csv`] refuses them.
///
/// # Errors
/// Channels that are not as long as the time; any failure of the file system, with the path.
pub fn write_csv(path: &Path, recording: &Recording) -> Result<()> {
    check_lengths(recording).map_err(|e| e.at(path.display()))?;
    crate::file::write_whole(path, |file| write(file, recording))
}

/// The text that [`write_csv`] writes.
///
/// # Errors
/// Channels that are not as long as the time.
pub fn to_csv(recording: &Recording) -> Result<String> {
    check_lengths(recording)?;
    let mut bytes = Vec::new();
    write(&mut bytes, recording).map_err(|e| Error::file(e.to_string()))?;
    String::from_utf8(bytes).map_err(|e| Error::file(e.to_string()))
}

fn write(file: &mut dyn Write, recording: &Recording) -> std::io::Result<()> {
    let mut text = String::from("time [s]");
    for channel in &recording.channels {
        text.push(',');
        text.push_str(&quoted(&format!("{} [{}]", channel.name, channel.unit)));
    }
    text.push('\n');
    for (i, time) in recording.time.iter().enumerate() {
        push_shortest(&mut text, *time);
        for channel in &recording.channels {
            text.push(',');
            push_shortest(&mut text, channel.values[i]);
        }
        text.push('\n');
        if text.len() >= BLOCK {
            file.write_all(text.as_bytes())?;
            text.clear();
        }
    }
    file.write_all(text.as_bytes())
}

fn quoted(cell: &str) -> String {
    if cell.contains([',', ';', '\t', '"', '\n', '\r']) {
        return format!("\"{}\"", cell.replace('"', "\"\""));
    }
    cell.into()
}

#[cfg(test)]
mod tests {
    use super::super::{Channel, Column};
    use super::*;
    use proptest::prelude::*;
    use std::collections::BTreeMap;

    fn read(text: &str) -> Recording {
        parse_csv(text, "rig.csv").unwrap()
    }

    #[track_caller]
    fn refuse(text: &str, words: &[&str]) {
        let message = parse_csv(text, "rig.csv").unwrap_err().to_string();
        for word in words {
            assert!(message.contains(word), "{word:?} is not in {message:?}");
        }
    }

    #[test]
    fn reads_names_units_and_numbers() {
        let recording = read("time [s],force x [N],slip [%]\n0,1.5,-2\n0.01,1e3,+.5\n");
        assert_eq!(recording.time, [0.0, 0.01]);
        assert_eq!(recording.source, "rig.csv");
        let [force, slip] = &recording.channels[..] else { panic!() };
        assert_eq!((force.name.as_str(), force.unit.as_str()), ("force x", "N"));
        assert_eq!(force.values, [1.5, 1000.0]);
        assert_eq!((slip.name.as_str(), slip.unit.as_str()), ("slip", "%"));
        assert_eq!(slip.values, [-2.0, 0.5]);
    }

    #[test]
    fn a_map_says_what_columns_are() {
        let column = |variable: Option<&str>, unit: Option<&str>| Column {
            variable: variable.map(str::to_owned),
            unit: unit.map(str::to_owned),
        };
        let names = Columns {
            named: BTreeMap::from([
                ("Force (N)".to_owned(), column(Some("force"), Some("N"))),
                ("note".to_owned(), column(None, None)),
                ("t/ms".to_owned(), column(Some("time"), Some("ms"))),
                ("way".to_owned(), column(Some("deflection"), None)),
                ("slip [%]".to_owned(), column(Some("slip"), Some("1"))),
            ]),
            ..Columns::default()
        };
        let read = |text: &str| parse_rows(&TIME, &names, text, "rig.csv", &mut |defect| Err(defect.error));
        let recording = read("Force (N);note;t/ms;way [mm];slip [%]\n5;cold;0;1;0.1\n6;;10;2;0.2\n").unwrap();
        assert_eq!(recording.time, [0.0, 0.01]);
        let channels = recording.channels.iter().map(|c| (&*c.name, &*c.unit, &c.values[..]));
        assert_eq!(
            channels.collect::<Vec<_>>(),
            [("force", "N", &[5.0, 6.0][..]), ("deflection", "mm", &[1.0, 2.0]), ("slip", "1", &[0.1, 0.2])]
        );
        // a column that is not left out needs a unit, from one of the two
        let refused = read("time [s],way\n0,1\n1,2\n").unwrap_err().to_string();
        assert!(refused.contains("`deflection [unit]`"), "{refused}");
        // and what is not named may be left out, but for the time
        let names = Columns { only_named: true, ..names };
        let text = "t [s];Force (N);x;other [m]\n0;5;cold;1\n1;6;;2\n";
        let recording = parse_rows(&TIME, &names, text, "rig.csv", &mut |defect| Err(defect.error)).unwrap();
        let [force] = &recording.channels[..] else { panic!("{recording:?}") };
        assert_eq!(
            (&*force.name, &force.values[..], &recording.time[..]),
            ("force", &[5.0, 6.0][..], &[0.0, 1.0][..])
        );
    }

    #[test]
    fn every_usual_dialect_gives_the_same() {
        let plain = read("time [s],a [N],b [m]\n0,1,2\n1,3,4\n");
        for text in [
            "\u{feff}time [s],a [N],b [m]\n0,1,2\n1,3,4\n",
            "time [s];a [N];b [m]\n0;1;2\n1;3;4\n",
            "time [s]\ta [N]\tb [m]\n0\t1\t2\n1\t3\t4",
            "time [s],a [N],b [m]\r\n0,1,2\r\n1,3,4\r\n",
            "\"time [s]\",\"a [N]\",\"b [m]\"\n\"0\",\"1\",\"2\"\n\"1\",\"3\",\"4\"\n",
            "time [s] , a  [ N ], b [m]\n 0, 1, 2\n1 ,3 ,4\n\n\n",
            "\n\ntime [ms],a [N],b [m]\n0,1,2\n1000,3,4\r\n\r\n",
            "sep=;\r\ntime [s];a [N];b [m]\r\n0;1;2\r\n1;3;4\r\n",
            "SEP=\t\ntime [s]\ta [N]\tb [m]\n0\t1\t2\n1\t3\t4\n",
            "# a, b, c;\n\n#\ntime [s],a [N],b [m]\n0,1,2\n# warm\n1,3,4\n",
            "Time (s);a (N);b (m)\n0;1;2\n1;3;4\n",
            "TIME[s];a[N];b[m]\n0;1;2\n1;3;4\n",
            "t,a,b\ns,N,m\n0,1,2\n1,3,4\n",
            "Time;a;b\n[sec];[N];[m]\n0;1;2\n1;3;4\n",
            "time,a,b\n(ms),(N),(m)\n0,1,2\n1000,3,4\n",
            // wherever the time is
            "a [N],Time [s],b [m]\n1,0,2\n3,1,4\n",
        ] {
            assert_eq!(read(text), plain, "{text:?}");
        }
    }

    #[test]
    fn a_line_of_units_says_which_column_has_none_that_is_one() {
        let read = read("Time,slip,note (raw)\ns,,-\n0,0.1,1\n1,0.2,2\n");
        assert_eq!(
            read.channels.iter().map(|c| (&*c.name, &*c.unit)).collect::<Vec<_>>(),
            [("slip", "1"), ("note (raw)", "-")]
        );
        refuse("time,a\ns,furlong\n0,1\n1,2\n", &["rig.csv:2:a (column 2)", "furlong"]);
        refuse("time,a\n,N\n0,1\n1,2\n", &["rig.csv:2:time (column 1)", "no unit of time"]);
        refuse("time,a\ns\n0,1\n1,2\n", &["rig.csv:2: the header has 2 cells", "units has 1"]);
        // a name that ends in parentheses with no unit in them has none
        refuse("time [s],a (raw)\n0,1\n1,2\n", &["rig.csv:1:a (raw) (column 2)", "no unit"]);
        refuse("#\ntime [s],a [N]\n# x\n0,1\n#\n1,x\n", &["rig.csv:6:a"]);
        refuse("sep=;\ntime [s];a [N]\n0;1\n1;x\n", &["rig.csv:4:a"]);
        refuse("sep=;\ntime [s];a [N]\n0;1\n#N/A;2\n1;3\n", &["rig.csv:4: the line begins with #", "';'"]);
    }

    #[test]
    fn a_name_may_end_in_brackets() {
        assert_eq!(read("time [s],x[1] [m]\n0,0\n1,1\n").channels[0].name, "x[1]");
        refuse("time [s],x[1]\n0,0\n1,1\n", &["rig.csv:1:x[1] (column 2)", "no unit"]);
    }

    #[test]
    fn header_errors_say_where_and_what_to_write() {
        refuse("", &["rig.csv", "empty", "time [s]"]);
        refuse("\u{feff}\n\r\n", &["rig.csv", "empty"]);
        refuse("force [N],way [m]\n0,1\n1,2\n", &["rig.csv:1:force (column 1)", "time [s]"]);
        refuse("time [N],a [N]\n0,1\n1,2\n", &["rig.csv:1:time (column 1)", "\"N\"", "time [s]"]);
        refuse("time [s],a\n0,1\n1,2\n", &["rig.csv:1:a (column 2)", "a [N]", "a [1]"]);
        refuse("time [s],a []\n0,1\n1,2\n", &["rig.csv:1:a (column 2)", "[1]"]);
        refuse("time [s],,a [N]\n0,1,2\n", &["rig.csv:1:", "(column 2)", "empty", "name [unit]"]);
        refuse("time [s],[N]\n0,1\n", &["rig.csv:1:", "(column 2)", "no unit"]);
        refuse("time [s],a [N],b [N],a [m]\n0,1,2,3\n", &["rig.csv:1:a (column 4)", "column 2", "unique"]);
        refuse("time [s],time [s]\n0,1\n", &["rig.csv:1:time (column 2)", "column 1", "unique"]);
        refuse("time [s],a [furlong]\n0,1\n1,2\n", &["rig.csv:1:a (column 2)", "furlong", "not known"]);
        refuse("\n\ntime [s],a\n0,1\n1,2\n", &["rig.csv:3:a (column 2)"]);
    }

    #[test]
    fn cell_errors_say_where() {
        let head = "time [s];a [N];b [m]\n0;1;2\n";
        for (row, words) in [
            ("1;x;2", ["rig.csv:3:a (column 2)", "\"x\" is not a number"]),
            ("1;;2", ["rig.csv:3:a (column 2)", "empty"]),
            ("1;2;NaN", ["rig.csv:3:b (column 3)", "finite"]),
            ("1;-inf;2", ["rig.csv:3:a (column 2)", "finite"]),
            ("1;1e400;2", ["rig.csv:3:a (column 2)", "finite"]),
            ("1;2.5;2\n2;2,5;2", ["rig.csv:4:a (column 2)", "decimal point"]),
            ("1;2,5;2\n2;2.5;2", ["rig.csv:4:a (column 2)", "comma"]),
            ("1;2,5,1;2", ["rig.csv:3:a (column 2)", "2,5,1"]),
            ("nan;2;2", ["rig.csv:3:time (column 1)", "finite"]),
            ("1;2", ["rig.csv:3: the header has 3 cells", "has 2"]),
            ("1;2;3;4", ["rig.csv:3: the header has 3", "has 4; numbers need a decimal point, not a comma"]),
        ] {
            refuse(&format!("{head}{row}\n5;6;7\n"), &words);
        }
    }

    #[test]
    fn time_has_to_increase() {
        for (time, shown) in [("0.25", "0.25 s comes after 0.5 s"), ("0.5", "0.5 s comes after 0.5 s")] {
            let text = format!("time [s],a [N]\n0,1\n0.5,1\n{time},1\n");
            refuse(&text, &["rig.csv:4:time (column 1)", shown]);
        }
    }

    #[test]
    fn two_rows_are_needed() {
        refuse("time [s],a [N]\n", &["rig.csv", "0 rows", "at least 2"]);
        refuse("time [s],a [N]\n0,1\n\n", &["rig.csv", "1 row ", "at least 2"]);
    }

    #[test]
    fn lines_are_counted_as_an_editor_does() {
        refuse("time [s],a [N]\r\n0,1\r\n\r\n\r\n1,x\r\n", &["rig.csv:5:a"]);
        refuse("time [s],a [N]\r0,1\r1,x\r", &["rig.csv:3:a"]);
        refuse("time [s],\"a\nb [N]\"\n0,1\n1,x\n", &["rig.csv:4:a b"]);
    }

    #[test]
    fn files_that_cannot_be_read_or_written_are_named() {
        let folder = tempfile::tempdir().unwrap();
        let missing = folder.path().join("none").join("run.csv");
        let message = read_csv(&missing).unwrap_err().to_string();
        assert!(message.contains("run.csv cannot be read"), "{message}");
        let message = write_csv(&missing, &Recording::default()).unwrap_err().to_string();
        assert!(message.contains("run.csv cannot be written"), "{message}");

        let latin = folder.path().join("latin.csv");
        std::fs::write(&latin, b"time [s],a [N]\n0,1\n1,2 \xb0\n").unwrap();
        let message = read_csv(&latin).unwrap_err().to_string();
        assert!(message.contains("latin.csv:3") && message.contains("UTF-8"), "{message}");
    }

    #[test]
    fn channels_of_another_length_are_not_written() {
        let channel = Channel { name: "a".into(), unit: "N".into(), values: vec![1.0] };
        let recording = Recording { time: vec![0.0, 1.0], channels: vec![channel], ..Recording::default() };
        let message = to_csv(&recording).unwrap_err().to_string();
        assert!(message.contains("\"a\" has 1 values for 2 times"), "{message}");
    }

    fn any_recording() -> impl Strategy<Value = Recording> {
        let unit = prop::sample::select(vec!["N", "m/s", "1", "-", "%", "deg", "N.m/rad", "°"]);
        let name = "[a-zA-Zµ;,\"\\[(][a-zA-Z0-9 _;,\"\t\n\\[\\].()-]{0,12}[a-zµ;,\"\\])]";
        let names = prop::collection::btree_set(name, 0..5);
        (names, prop::collection::vec(unit, 5), 2..20_usize)
            .prop_flat_map(|(names, units, rows)| {
                let values = prop::collection::vec(any_finite(), rows * names.len());
                let steps = prop::collection::vec(1e-9..1e3, rows);
                (Just(names), Just(units), values, steps)
            })
            .prop_filter_map("increasing time", |(names, units, values, steps)| {
                let rows = steps.len();
                let time: Vec<f64> = steps
                    .iter()
                    .scan(-3.0, |t, step| {
                        *t += step;
                        Some(*t)
                    })
                    .collect();
                let channels = names
                    .into_iter()
                    .filter(|name| name != "time")
                    .zip(units)
                    .enumerate()
                    .map(|(i, (name, unit))| Channel {
                        name,
                        unit: unit.into(),
                        values: values[i * rows..][..rows].to_vec(),
                    })
                    .collect();
                time.windows(2).all(|w| w[0] < w[1]).then(|| Recording {
                    time,
                    channels,
                    source: "rig.csv".into(),
                })
            })
    }

    fn any_finite() -> impl Strategy<Value = f64> {
        prop_oneof![prop::num::f64::NORMAL | prop::num::f64::SUBNORMAL | prop::num::f64::ZERO, -1e3..1e3]
    }

    proptest! {
        #[test]
        fn what_is_written_is_read_back(recording in any_recording()) {
            let text = to_csv(&recording).unwrap();
            let back = parse_csv(&text, "rig.csv").unwrap();
            prop_assert_eq!(&back, &recording);
            // == does not see the sign of zero
            for (a, b) in back.channels.iter().zip(&recording.channels) {
                for (a, b) in a.values.iter().zip(&b.values) {
                    prop_assert_eq!(a.to_bits(), b.to_bits());
                }
            }
        }
    }

    #[test]
    fn files_go_round() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("run.csv");
        let mut recording = read("time [s],a [N]\n0,1\n0.1,0.30000000000000004\n");
        write_csv(&path, &recording).unwrap();
        recording.source = path.display().to_string();
        assert_eq!(read_csv(&path).unwrap(), recording);
        assert_eq!(std::fs::read_to_string(&path).unwrap(), "time [s],a [N]\n0,1\n0.1,0.30000000000000004\n");
    }
}
