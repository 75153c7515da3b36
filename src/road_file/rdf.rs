//! Road files in TeimOrbit syntax: the one of the super-elastic tire's source (Oh 2017, 5.2.3), and which of them Adams reads.

use super::profile::{RoadProfile, beyond_points, checked};
use super::{Writing, adams};
use crate::tir::{Document, Units, number, number_text, shown};
use crate::{Error, Result};
use std::fmt::Write as _;
use std::path::Path;

/// A road file with what all kinds of it need.
pub(super) struct File {
    pub document: Document,
    pub units: Units,
    pub road_type: String,
    pub type_line: usize,
    /// What the user should know of its units.
    notes: Vec<String>,
}

impl File {
    /// # Errors
    /// No road file; no unit of length, without which a road may be a thousand times too high.
    fn of(document: Document) -> Result<Self> {
        let mut notes = Vec::new();
        let units = Units::of(&document, &mut notes)?;
        // a road has lengths, which are asked for, and angles; its units of force, mass and time change nothing
        notes.retain(|note| note.contains("unit of angle"));
        if document.get("UNITS", "LENGTH").is_none() {
            return Err(Error::file(format!(
                "{}: [UNITS] has no LENGTH: write LENGTH = 'mm' or 'meter' below [UNITS]",
                document.name()
            )));
        }
        let (road_type, type_line) = document
            .word("MODEL", "ROAD_TYPE")
            .ok_or_else(|| missing(&document, "MODEL", "ROAD_TYPE", "'flat' or 'poly'"))?;
        Ok(Self { document, units, road_type: road_type.to_ascii_lowercase(), type_line, notes })
    }

    pub fn name(&self) -> &str {
        self.document.name()
    }

    /// A number of the file, in its units.
    pub fn number(&self, section: &str, key: &str) -> Result<Option<f64>> {
        let called = format!("[{section}] {key}");
        match self.document.only(section, key, &called)? {
            Some(entry) => self.document.number(&entry, &called),
            None => Ok(None),
        }
    }

    /// The rows of a table of two or more numbers each, with their lines.
    pub fn table(
        &self,
        section: &str,
        table: &str,
        least: usize,
        most: usize,
    ) -> Result<Vec<(usize, Vec<f64>)>> {
        let mut rows = Vec::new();
        for row in self.document.rows(section).filter(|row| row.table == table) {
            let place = self.document.place(row.line);
            let numbers: Option<Vec<f64>> = row
                .text
                .split(|b| b.is_ascii_whitespace())
                .filter(|word| !word.is_empty())
                .map(|word| number(word).filter(|x| x.is_finite()))
                .collect();
            match numbers {
                Some(numbers) if (least..=most).contains(&numbers.len()) => rows.push((row.line, numbers)),
                Some(numbers) => {
                    return Err(Error::file(format!(
                        "{place}: [{section}]: a row with {} numbers; it has {least}{}",
                        numbers.len(),
                        if most > least { format!(" to {most}") } else { String::new() }
                    )));
                }
                None => {
                    return Err(Error::file(format!(
                        "{place}: [{section}]: '{}' is no row of numbers (decimal point, blanks between)",
                        shown(row.text)
                    )));
                }
            }
        }
        Ok(rows)
    }

    /// A length of the file in m.
    pub fn metres(&self, value: f64) -> f64 {
        metres(value, self.units.length)
    }
}

pub(super) fn missing(document: &Document, section: &str, key: &str, form: &str) -> Error {
    let there = document.sections().any(|name| name == section);
    let what = if there {
        format!("[{section}] has no {key}")
    } else {
        format!("there is no [{section}] with {key}")
    };
    Error::file(format!("{}: {what}; add {key} = {form}", document.name()))
}

pub(super) fn read(path: &Path) -> Result<RoadProfile> {
    of_document(Document::open(path)?)
}

/// The road of a document.
pub(super) fn of_document(document: Document) -> Result<RoadProfile> {
    let (method, line) = document
        .word("MODEL", "METHOD")
        .ok_or_else(|| missing(&document, "MODEL", "METHOD", "'USER' or '2D'"))?;
    match method.to_ascii_uppercase().as_str() {
        "USER" => of_source(&File::of(document)?),
        "2D" => adams::read(&File::of(document)?),
        "3D" | "3D_SPLINE" | "RGR" | "CRG" | "5.2.1" => Err(Error::file(format!(
            "{}: METHOD is '{method}': a road in three dimensions has no two tracks along which heights are given; read are METHOD = 'USER' with [PROFILE] and '2D'. An OpenCRG file is read by itself",
            document.place(line)
        ))),
        _ => Err(Error::file(format!(
            "{}: METHOD is '{}', which is not known; read are 'USER' with [PROFILE] (the source of the super-elastic tire) and '2D' (Adams)",
            document.place(line),
            shown(method.as_bytes())
        ))),
    }
}

/// The road file of the source.
fn of_source(file: &File) -> Result<RoadProfile> {
    let (document, name) = (&file.document, file.name());
    match file.road_type.as_str() {
        "flat" | "poly" => {}
        "drum" => {
            return Err(Error::file(format!(
                "{}: ROAD_TYPE is 'drum': a drum is a rig and no road",
                document.place(file.type_line)
            )));
        }
        other => {
            return Err(Error::file(format!(
                "{}: ROAD_TYPE is '{}'; with METHOD = 'USER' it is 'flat' or 'poly'",
                document.place(file.type_line),
                shown(other.as_bytes())
            )));
        }
    }
    let rows = file.table("PROFILE", "", 2, 3)?;
    if rows.is_empty() && file.road_type == "poly" {
        return Err(Error::file(format!(
            "{name}: ROAD_TYPE is 'poly', and [PROFILE] has no rows; a row is x y z or x z, two at least"
        )));
    }
    let mut aside = None;
    let offset = Offset::of(file)?;
    let mut points: Vec<(usize, [f64; 2])> = Vec::with_capacity(rows.len());
    for (line, row) in rows {
        let [x, z] = match row[..] {
            [x, y, z] => {
                if y != 0.0 {
                    aside.get_or_insert(line);
                }
                [x, z]
            }
            [x, z] => [x, z],
            _ => continue,
        };
        points.push((line, offset.moved([file.metres(x), file.metres(z)])));
    }
    if points.is_empty() {
        points = vec![(file.type_line, offset.moved([0.0, 0.0])), (file.type_line, offset.moved([1.0, 0.0]))];
    }
    let mut road = RoadProfile::of(name, checked(name, "[PROFILE]", "row x y z", &points)?);
    if let Some(pair) = points.windows(2).find(|pair| pair[0].1[0] == pair[1].1[0]) {
        return Err(Error::file(format!(
            "{}: [PROFILE]: a second point at x = {} m is a vertical edge, on which the contact of that tire has no force that could be meant; make it a short ramp, as the source does",
            document.place(pair[1].0),
            pair[1].1[0]
        )));
    }
    road.direction = offset.yaw;
    if let Some(line) = aside {
        road.lost.push(format!(
            "{}: y of [PROFILE]: a profile is the same all the way across",
            document.place(line)
        ));
    }
    if file.road_type == "flat" && road.left.iter().any(|[_, z]| *z != road.left[0][1]) {
        road.notes.push(format!(
            "{}: ROAD_TYPE is 'flat', but the rows of [PROFILE] are not level; they are used",
            document.place(file.type_line)
        ));
    }
    if offset.pitch != 0.0 {
        road.notes.push(format!(
            "{name}: [OFFSET] BETHA turns the road about y, which points to the left: a positive angle lowers what lies ahead. The source does not say so"
        ));
    }
    beside_the_road(file, &["PROFILE", "OFFSET"], &["METHOD", "FUNCTION_NAME", "ROAD_TYPE"], &mut road);
    Ok(road)
}

/// Lists sections and keys of a file that are no part of the road.
pub(super) fn beside_the_road(file: &File, used: &[&str], model: &[&str], road: &mut RoadProfile) {
    let mut others: Vec<String> = Vec::new();
    let (mut graphics, mut about) = (false, false);
    let beside = &mut road.beside;
    for entry in file.document.entries() {
        match entry.section {
            "UNITS" => {}
            "MDI_HEADER" => about = true,
            "GRAPHICS" => graphics = true,
            "MODEL" if model.contains(&entry.key) => {}
            section if used.contains(&section) => {}
            section => others.push(format!("[{section}] {}", entry.key)),
        }
    }
    for section in file.document.tables() {
        if !used.contains(&section) && !matches!(section, "UNITS" | "MDI_HEADER" | "GRAPHICS") {
            others.push(format!("[{section}] with its rows"));
        }
    }
    if about {
        beside.push("[MDI_HEADER] with its comments".into());
    }
    if graphics {
        beside.push("[GRAPHICS]: how the road is drawn".into());
    }
    if !others.is_empty() {
        let count = others.len();
        others.truncate(20);
        let more = if count > 20 { format!(" and {} more", count - 20) } else { String::new() };
        beside.push(format!("keys that are not known: {}{more}", others.join(", ")));
    }
    road.notes.extend(file.notes.iter().cloned().chain(file.document.told()));
}

/// How `[OFFSET]` moves the road's frame: turned first, then shifted.
struct Offset {
    /// In the plane, in the direction of the road and to the left of that.
    along: f64,
    aside: f64,
    up: f64,
    pitch: f64,
    yaw: f64,
}

impl Offset {
    fn of(file: &File) -> Result<Self> {
        let one =
            |key: &str, factor: f64| Ok::<_, Error>(file.number("OFFSET", key)?.unwrap_or(0.0) * factor);
        let (length, angle) = (file.units.length, file.units.angle);
        let [x, y, z] = [one("X", length)?, one("Y", length)?, one("Z", length)?];
        let roll = one("ALPHA", angle)?;
        // BETA for those who mend the spelling
        let pitch = match file.document.get("OFFSET", "BETHA") {
            Some(_) => one("BETHA", angle)?,
            None => one("BETA", angle)?,
        };
        let yaw = one("GAMMA", angle)?;
        if roll != 0.0 {
            let line = file.document.get("OFFSET", "ALPHA").map_or(0, |entry| entry.line);
            return Err(Error::file(format!(
                "{}: [OFFSET] ALPHA banks the road, which a profile along it cannot; set it to 0, or give the tracks as two columns of heights",
                file.document.place(line)
            )));
        }
        if pitch.abs() >= 1.5 {
            return Err(Error::file(format!("{}: [OFFSET] BETHA stands the road upright", file.name())));
        }
        let (sin, cos) = yaw.sin_cos();
        Ok(Self { along: x * cos + y * sin, aside: y * cos - x * sin, up: z, pitch, yaw })
    }

    /// Whether it does more than to turn the road about z.
    fn moves(&self) -> bool {
        [self.along, self.aside, self.up, self.pitch].iter().any(|x| *x != 0.0)
    }

    fn moved(&self, [x, z]: [f64; 2]) -> [f64; 2] {
        let [x, z] = match self.pitch == 0.0 {
            true => [x, z],
            false => {
                let (sin, cos) = self.pitch.sin_cos();
                [x * cos + z * sin, z * cos - x * sin]
            }
        };
        [x + self.along, z + self.up]
    }
}

/// A road as `.rdf`: of one track as the source has it, of two as Adams has it.
pub(super) fn write(road: &RoadProfile, writing: &Writing<'_>, name: &str) -> Result<(Vec<u8>, Vec<String>)> {
    if let Some(like) = writing.like {
        return write_like(road, like);
    }
    if writing.adams || road.right.is_some() {
        return adams::write(road);
    }
    if road.left.windows(2).any(|pair| pair[0][0] == pair[1][0]) {
        return Err(Error::file(format!(
            "{}: it has vertical edges, and a road file of METHOD = 'USER' has none: make them short ramps, or write it with --adams",
            road.source
        )));
    }
    let level = road.left.iter().all(|[_, z]| *z == 0.0);
    let mut text = String::from(
        "[MDI_HEADER]\n FILE_TYPE     = 'rdf'\n FILE_VERSION  = 5.00\n FILE_FORMAT   = 'ASCII'\n",
    );
    text += "[UNITS]\n LENGTH = 'meter'\n FORCE  = 'newton'\n ANGLE  = 'radian'\n MASS   = 'kg'\n TIME   = 'sec'\n";
    text += "[MODEL]\n METHOD        = 'USER'\n FUNCTION_NAME = 'ARC501'\n";
    let _ = writeln!(text, " ROAD_TYPE     = '{}'", if level { "flat" } else { "poly" });
    text += "[GRAPHICS]\n TYPE_STEPSIZE = 'FLEXIBLE'\n[PROFILE]\n{XZ}\n";
    text += &rows_of(road, 1.0, name)?;
    text += "[OFFSET]\n X     = 0.0\n Y     = 0.0\n Z     = 0.0\n ALPHA = 0.0\n BETHA = 0.0\n";
    let _ = writeln!(text, " GAMMA = {}", number_text(road.direction).unwrap_or_default());
    Ok((text.into_bytes(), beyond_points_and_direction(road)))
}

/// The rows x y z of a road in units of so many metres.
fn rows_of(road: &RoadProfile, unit: f64, name: &str) -> Result<String> {
    let mut text = String::new();
    for [x, z] in &road.left {
        match (number_text(in_unit(*x, unit)), number_text(in_unit(*z, unit))) {
            (Some(x), Some(z)) => {
                let _ = writeln!(text, " {x} 0.0 {z}");
            }
            _ => return Err(Error::file(format!("{name}: x = {x} m, z = {z} m cannot be written"))),
        }
    }
    Ok(text)
}

/// A length in units of so many metres, in m. 700 mm are 0.7 m, and not what 700 times 0.001 rounds to.
fn metres(value: f64, unit: f64) -> f64 {
    let parts = (1.0 / unit).round();
    if parts >= 1.0 && 1.0 / parts == unit { value / parts } else { value * unit }
}

/// The number of units that is so many metres; if rounding leaves none, the nearest.
fn in_unit(value: f64, unit: f64) -> f64 {
    let quotient = value / unit;
    let rounded = (quotient * 1e9).round() / 1e9;
    [rounded, quotient, quotient.next_up(), quotient.next_down()]
        .into_iter()
        .find(|candidate| metres(*candidate, unit) == value)
        .unwrap_or(quotient)
}

/// A file like another one, with points and direction of a road in place of its own; no byte is changed where they are the same.
fn write_like(road: &RoadProfile, like: &Path) -> Result<(Vec<u8>, Vec<String>)> {
    let mut document = Document::open(like)?;
    let there = of_document(document.clone())?;
    let file = File::of(document.clone())?;
    let name = like.display();
    let of_source = document.word("MODEL", "METHOD").is_some_and(|(m, _)| m.eq_ignore_ascii_case("USER"));
    if !of_source || document.rows("PROFILE").next().is_none() {
        return Err(Error::file(format!(
            "{name}: it has no rows of [PROFILE] to replace; name a file of METHOD = 'USER'"
        )));
    }
    if road.right.is_some() {
        return Err(Error::file(format!("{name}: such a file holds one track, and the road has two")));
    }
    if road.edges() > 0 {
        return Err(Error::file(format!(
            "{}: it has vertical edges, and {name} can have none: make them short ramps",
            road.source
        )));
    }
    let mut lost = Vec::new();
    let (moved, turned) = (there.left != road.left, there.direction != road.direction);
    if (moved || turned) && Offset::of(&file)?.moves() {
        return Err(Error::file(format!(
            "{name}: its [OFFSET] moves the points; set X, Y, Z and BETHA to 0 in a file that others are made like"
        )));
    }
    if moved {
        let rows = rows_of(road, file.units.length, like.to_string_lossy().as_ref())?;
        if document.set_rows("PROFILE", "", &rows)? {
            lost.push(format!("comments between the rows of [PROFILE] in {name}"));
        }
        document.set_text("MODEL", "ROAD_TYPE", "poly")?;
    }
    if turned {
        document.set_number("OFFSET", "GAMMA", in_unit(road.direction, file.units.angle))?;
    }
    lost.extend(beyond_points_and_direction(road));
    Ok((document.bytes().to_vec(), lost))
}

/// What such a file does not hold of a road: its direction is `GAMMA`.
fn beyond_points_and_direction(road: &RoadProfile) -> Vec<String> {
    let mut without_direction = road.clone();
    without_direction.direction = 0.0;
    beyond_points(&without_direction, "such a file")
}
