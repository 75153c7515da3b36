//! Road profiles from CSV files, and settings that name such files.

use super::csv::read_csv_over;
use super::header::Axis;
use super::shortest::shortest;
use crate::bounded::{self, MAX_TEXT};
use crate::model::{Settings, Value};
use crate::road::MAX_POINTS;
use crate::{Error, Result};
use std::path::{Path, PathBuf};

const PLACE: Axis = Axis { name: "x", unit: "m", quantity: "place", repeats: true };

/// Reads a CSV file of two columns, `x [m]` and `z [m]` or in other units of length, as the text of the
/// parameter `road_profile`: "x z; x z; ..." in m, with the same bits. Rows are as
/// [`read_csv`](super::read_csv) reads them; x must not decrease, and two rows with the same x are a
/// vertical edge.
///
/// # Errors
/// A file that cannot be read, content that is not as above, more than [`MAX_POINTS`] points; the
/// message begins with the file's name.
pub fn profile_from_csv(path: &Path) -> Result<String> {
    let recording = read_csv_over(&PLACE, path)?;
    let fail = |what: String| Err(Error::file(format!("{}: {what}", recording.source)));
    if recording.channels.len() != 1 {
        let columns = 1 + recording.channels.len();
        return fail(format!("a profile has two columns, `x [m]` and `z [m]`; this file has {columns}"));
    }
    let heights = recording.channel_in("z", "m")?;
    if heights.len() > MAX_POINTS {
        return fail(format!("{} points are more than {MAX_POINTS}", heights.len()));
    }
    let points: Vec<_> = recording
        .time
        .iter()
        .zip(&heights)
        .map(|(x, z)| format!("{} {}", shortest(*x), shortest(*z)))
        .collect();
    Ok(points.join("; "))
}

/// Places, heights, and those of the right track if there are others \[m\].
type Columns = (Vec<f64>, Vec<f64>, Option<Vec<f64>>);

/// The points of a CSV file with the columns `x [m]` and `z [m]`, or a third one `z_right [m]` for the right track: x, z and that
/// \[m\]. Rows are as in [`profile_from_csv`], and their number is not limited.
///
/// # Errors
/// A file that cannot be read, content that is not as above.
pub(crate) fn points_from_csv(path: &Path) -> Result<Columns> {
    let recording = read_csv_over(&PLACE, path)?;
    let right = recording.has("z_right").then(|| recording.channel_in("z_right", "m")).transpose()?;
    if let Some(other) = recording.channels.iter().find(|c| c.name != "z" && c.name != "z_right") {
        return Err(Error::file(format!(
            "{}: a road has the columns `x [m]`, `z [m]` and, if the right track is another, `z_right [m]`; there is also {:?}",
            recording.source, other.name
        )));
    }
    let left = recording.channel_in("z", "m")?;
    Ok((recording.time, left, right))
}

/// The value that a user gave to the variable `name`: of `@FILE` for a `road_profile`, the points in that
/// CSV file, looked for in `folder`; otherwise the value as it is.
///
/// # Errors
/// As [`profile_from_csv`].
pub fn profile_value(name: &str, value: Value, folder: &Path) -> Result<Value> {
    match profile_file(name, &value, folder) {
        Some(file) => profile_from_csv(&file).map(Value::Text),
        None => Ok(value),
    }
}

/// The file from which [`profile_value`] reads the points of a road, if a user named one.
pub(crate) fn profile_file(name: &str, value: &Value, folder: &Path) -> Option<PathBuf> {
    match value {
        Value::Text(text) if name == "road_profile" => text.strip_prefix('@').map(|file| folder.join(file)),
        _ => None,
    }
}

/// Settings from a file, with the files that they name read; none without a file.
///
/// # Errors
/// A file that cannot be read, or that says something wrong; with its place.
pub fn read_settings(path: Option<&Path>) -> Result<Settings> {
    let Some(path) = path else { return Ok(Settings::default()) };
    if path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("tir")) {
        let shown = path.display();
        return Err(Error::file(format!(
            "{shown}: this is a tire property file, and parameters are TOML: `latsch tire {shown} --output F.toml` makes them of it. Where there is an option --tire, it takes \
             the file as it is"
        )));
    }
    let text =
        bounded::read_text(path, MAX_TEXT).map_err(|e| Error::file(format!("{}: {e}", path.display())))?;
    let mut settings = Settings::parse(&text, &path.display().to_string())?;
    let folder = path.parent().unwrap_or(Path::new(""));
    for setting in &mut settings.values {
        let value = profile_value(&setting.name, setting.value.clone(), folder);
        setting.value = value.map_err(|e| e.at(&setting.place))?;
    }
    Ok(settings)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::road::{Road, RoadParameters};

    fn read(content: &str) -> Result<String> {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("bump.csv");
        std::fs::write(&path, content).unwrap();
        profile_from_csv(&path)
    }

    #[test]
    fn files_become_the_text_of_a_profile() {
        let profile = read("x [m];z [mm]\n-0,5;0\n0;0\n0;12,5\n1e-1;-20\n").unwrap();
        assert_eq!(profile, "-0.5 0; 0 0; 0 0.0125; 0.1 -0.02");
        let road = Road::new(&RoadParameters { kind: 8, start: 2.0, profile, ..RoadParameters::flat() });
        assert_eq!(road.unwrap().at(2.0, 0.0).height, 0.0125);
    }

    #[test]
    fn errors_name_file_and_line() {
        let many = format!("x [m],z [m]\n{}", "1,2\n".repeat(MAX_POINTS + 1));
        for (content, words) in [
            ("time [s],z [m]\n0,0\n1,0\n", ["bump.csv:1", "`x [m]`"]),
            ("x [s],z [m]\n0,0\n1,0\n", ["bump.csv:1", "no unit of place"]),
            ("x [m],z [kg]\n0,0\n1,0\n", ["bump.csv", "cannot be converted"]),
            ("x [m],y [m]\n0,0\n1,0\n", ["bump.csv", "no channel \"z\""]),
            ("x [m],z [m],mu [1]\n0,0,1\n1,0,1\n", ["bump.csv", "has 3"]),
            ("x [m],z [m]\n0,0\n1,0\n0.5,0\n", ["bump.csv:4", "must not decrease"]),
            (&many, ["bump.csv", "20001 points"]),
        ] {
            let message = read(content).unwrap_err().to_string();
            assert!(words.iter().all(|word| message.contains(word)), "{message}");
        }
    }
}
