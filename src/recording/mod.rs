//! Recordings: measured or simulated channels over time, with units, and the files that hold them: CSV, TYDEX, RPC III, MDF 4, MATLAB, Parquet.

mod csv;
mod form;
mod header;
mod mat;
mod mdf;
mod names;
mod noise;
mod parquet;
mod profile;
mod rpc;
mod shortest;
mod smooth;
mod tydex;
mod typed;

pub use csv::{parse_csv, read_csv, to_csv, write_csv};
pub(crate) use form::Defect;
pub use header::{Column, Columns};
pub use mat::MAT_ENDINGS;
pub use mdf::MDF_ENDINGS;
pub use names::{Names, read_names};
pub use noise::add_noise;
pub use parquet::PARQUET_ENDINGS;
pub(crate) use profile::points_from_csv;
pub(crate) use profile::profile_file;
pub use profile::{profile_from_csv, profile_value, read_settings};
pub use rpc::{RPC_ENDINGS, parse_rpc, read_rpc, to_rpc, write_rpc};
pub use smooth::Smooth;
pub use tydex::{TYDEX_ENDINGS, parse_tydex, read_tydex, to_tydex, write_tydex};

pub use crate::stats::{interpolate, slope};

use crate::model::unit::Unit;
use crate::stats::within;
use crate::{Error, Result};
use std::path::Path;

/// Channels over one common time.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Recording {
    /// Time of the samples \[s\], strictly increasing.
    pub time: Vec<f64>,
    /// The channels, each as long as the time.
    pub channels: Vec<Channel>,
    /// Where it comes from, for messages: a file name or the name of a run.
    pub source: String,
}

/// One quantity over time.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Channel {
    /// Its name, unique within the recording.
    pub name: String,
    /// The unit of its values, in the notation of [`unit`](crate::model::unit).
    pub unit: String,
    /// Its values, one per sample.
    pub values: Vec<f64>,
}

impl Recording {
    /// The channel called `name`, in the unit that it was recorded in.
    ///
    /// # Errors
    /// No such channel; the message lists those that there are.
    pub fn channel(&self, name: &str) -> Result<&Channel> {
        self.channels.iter().find(|c| c.name == name).ok_or_else(|| {
            let names: Vec<_> = self.channels.iter().map(|c| c.name.as_str()).collect();
            let names = if names.is_empty() { "none".into() } else { names.join(", ") };
            Error::file(format!("{}: there is no channel {name:?}; the channels are: {names}", self.source))
        })
    }

    /// True if there is a channel called `name`.
    pub fn has(&self, name: &str) -> bool {
        self.channels.iter().any(|c| c.name == name)
    }

    /// The values of the channel called `name`, converted to `unit`.
    ///
    /// # Errors
    /// No such channel, or one whose unit has another dimension.
    pub fn channel_in(&self, name: &str, unit: &str) -> Result<Vec<f64>> {
        let channel = self.channel(name)?;
        if channel.unit == unit {
            return Ok(channel.values.clone());
        }
        let parse =
            |text: &str| Unit::parse(text).map_err(|e| Error::file(e.to_string()).at(self.place(name)));
        let Some((factor, offset)) = parse(&channel.unit)?.to(parse(unit)?) else {
            return Err(Error::file(format!(
                "{}: recorded in {:?}, which cannot be converted to {unit:?}: the dimensions differ",
                self.place(name),
                channel.unit
            )));
        };
        Ok(channel.values.iter().map(|v| v * factor + offset).collect())
    }

    fn place(&self, channel: &str) -> String {
        format!("{}: channel {channel:?}", self.source)
    }

    /// Checks that the recording has samples for all of `start` to `stop` \[s\], so that nothing has to
    /// be extrapolated.
    ///
    /// # Errors
    /// It begins later or ends earlier; the message has both spans.
    pub fn covers(&self, start: f64, stop: f64) -> Result<()> {
        let (Some(first), Some(last)) = (self.time.first(), self.time.last()) else {
            return Err(Error::file(format!("{}: the recording is empty", self.source)));
        };
        if within(&self.time, start) && within(&self.time, stop) {
            return Ok(());
        }
        Err(Error::file(format!(
            "{}: recorded from {first} s to {last} s, but {start} s to {stop} s is needed; nothing is extrapolated",
            self.source
        )))
    }
}

/// The files that hold recordings.
#[derive(Clone, Copy, PartialEq)]
enum Form {
    Csv,
    Tydex,
    Rpc,
    Mdf,
    Mat,
    Parquet,
}

/// The forms that a file's name tells, and their endings; any other is CSV.
const FORMS: [(Form, &[&str]); 5] = [
    (Form::Tydex, &TYDEX_ENDINGS),
    (Form::Rpc, &RPC_ENDINGS),
    (Form::Mdf, &MDF_ENDINGS),
    (Form::Mat, &MAT_ENDINGS),
    (Form::Parquet, &PARQUET_ENDINGS),
];

impl Form {
    /// By the ending of a file's name, in small letters or capitals.
    fn of(path: &Path) -> Self {
        let ending = crate::file::ending(path);
        let form = FORMS.iter().find(|(_, endings)| endings.contains(&ending.as_str()));
        form.map_or(Self::Csv, |(form, _)| *form)
    }
}

/// Reads a recording: TYDEX, RPC III, MDF 4, MATLAB or Parquet if its name ends like one of those ([`recording_endings`]), else CSV.
///
/// # Errors
/// A file that cannot be read, or content that is not of that form; a channel that has no unit or one that is not known, a value that is no
/// number, a time that does not increase. With the place in the file.
pub fn read_recording(path: &Path) -> Result<Recording> {
    read_recording_as(path, &Columns::default())
}

/// The same of a recording whose columns are what is said of them, by what stands above them.
///
/// # Errors
/// As [`read_recording`]; what is said makes two channels of one name, or is no unit.
pub fn read_recording_as(path: &Path, columns: &Columns) -> Result<Recording> {
    match Form::of(path) {
        Form::Csv => csv::read_csv_as(path, columns),
        Form::Tydex => header::renamed(read_tydex(path)?, columns),
        Form::Rpc => header::renamed(read_rpc(path)?, columns),
        Form::Mdf => typed::faultless(mdf::read_mdf(path, columns)?),
        Form::Mat => typed::faultless(mat::read_mat(path, columns)?),
        Form::Parquet => typed::faultless(parquet::read_parquet(path, columns)?),
    }
}

/// The same of a recording that may be faulty, as far as its form knows of faults: single cells and rows that are refused by
/// [`read_recording_as`].
///
/// # Errors
/// As [`read_recording_as`], without those.
pub(crate) fn read_with_defects(path: &Path, columns: &Columns) -> Result<(Recording, Vec<Defect>)> {
    match Form::of(path) {
        Form::Csv => csv::read_csv_with_defects(path, columns),
        Form::Mdf => mdf::read_mdf(path, columns),
        Form::Mat => mat::read_mat(path, columns),
        Form::Parquet => parquet::read_parquet(path, columns),
        Form::Tydex | Form::Rpc => Ok((read_recording_as(path, columns)?, Vec::new())),
    }
}

/// Writes a recording as [`read_recording`] would read it.
///
/// # Errors
/// As [`write_tydex`], [`write_rpc`] and [`write_csv`]; MATLAB files are not written.
pub fn write_recording(path: &Path, recording: &Recording) -> Result<()> {
    match Form::of(path) {
        Form::Csv => write_csv(path, recording),
        Form::Tydex => write_tydex(path, recording),
        Form::Rpc => write_rpc(path, recording),
        Form::Mdf => mdf::write_mdf(path, recording),
        Form::Parquet => parquet::write_parquet(path, recording),
        Form::Mat => Err(Error::file(format!(
            "{}: MATLAB files are read and not written; .csv, .mf4 and .parquet are",
            path.display()
        ))),
    }
}

/// What the names of recordings in a folder end in, in small letters.
pub fn recording_endings() -> Vec<&'static str> {
    std::iter::once("csv").chain(FORMS.iter().flat_map(|(_, endings)| endings.iter().copied())).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn recording() -> Recording {
        Recording {
            time: vec![0.0, 0.1, 0.3],
            channels: vec![
                Channel { name: "speed".into(), unit: "km/h".into(), values: vec![36.0, 72.0, 0.0] },
                Channel { name: "tread".into(), unit: "degC".into(), values: vec![20.0, 21.0, 22.0] },
            ],
            source: "rig.csv".into(),
        }
    }

    #[test]
    fn channels_are_converted() {
        assert_eq!(recording().channel_in("speed", "m/s").unwrap(), [10.0, 20.0, 0.0]);
        assert_eq!(recording().channel_in("tread", "K").unwrap(), [293.15, 294.15, 295.15]);
        assert_eq!(recording().channel_in("speed", "km/h").unwrap(), [36.0, 72.0, 0.0]);
    }

    #[test]
    fn channel_errors_name_file_channel_and_units() {
        let message = recording().channel_in("speed", "N").unwrap_err().to_string();
        for word in ["rig.csv", "\"speed\"", "\"km/h\"", "\"N\""] {
            assert!(message.contains(word), "{message}");
        }
        let message = recording().channel_in("sped", "m/s").unwrap_err().to_string();
        for word in ["rig.csv", "\"sped\"", "speed, tread"] {
            assert!(message.contains(word), "{message}");
        }
        let message = recording().channel_in("speed", "furlong").unwrap_err().to_string();
        assert!(message.contains("rig.csv") && message.contains("furlong"), "{message}");
    }

    #[test]
    fn says_what_is_not_covered() {
        assert!(recording().covers(0.0, 0.1 + 0.1 + 0.1).is_ok());
        for (start, stop) in [(-1.0, 0.2), (0.0, 0.4), (0.0, f64::NAN)] {
            let message = recording().covers(start, stop).unwrap_err().to_string();
            assert!(message.contains("rig.csv") && message.contains("0 s to 0.3 s"), "{message}");
        }
        assert!(Recording::default().covers(0.0, 0.0).is_err());
    }
}
