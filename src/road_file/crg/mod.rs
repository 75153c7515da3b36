//! OpenCRG roads: a grid of heights over a curved reference line (ASAM OpenCRG 1.2), read along one or two lines beside it.
//!
//! A road becomes heights over the way along the reference line: z = grid + reference line + banking v, as the standard adds them
//! up. The line itself is laid out straight.

mod header;
mod records;
mod write;

use self::header::{Channel, Format, Header, Numbers};
use self::records::NanMode;
pub(super) use self::write::write;
use super::bytes_of;
use super::profile::{MAX_POINTS_READ, RoadProfile, checked};
use crate::{Error, Result};
use std::ops::Range;
use std::path::Path;

/// The most bytes of a file.
const MAX_BYTES: u64 = 1 << 30;
/// How deep a file may refer to another one.
const MAX_DEPTH: usize = 5;

/// Where across a road its tracks are \[m\], positive to the left of the reference line.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Lanes {
    /// The left track, or the only one.
    pub left: Option<f64>,
    /// The right track.
    pub right: Option<f64>,
}

pub(super) fn read(path: &Path, lanes: &Lanes) -> Result<RoadProfile> {
    let source = path.display().to_string();
    let bytes = bytes_of(path, MAX_BYTES)?;
    let mut header = Header::read(&bytes, &source)?;
    let mut bytes = bytes;
    let mut from = path.to_path_buf();
    for depth in 0.. {
        let Some((named, line)) = header.file.take() else { break };
        let place = format!("{}:{line}", from.display());
        if depth == MAX_DEPTH {
            return Err(Error::file(format!("{place}: more than {MAX_DEPTH} files refer to another one")));
        }
        if named.starts_with('$') {
            return Err(Error::file(format!(
                "{place}: the file {named} is named by an environment variable, which is not read; write its path"
            )));
        }
        // relative to the file that names it; the standard says to the reader's folder, which is nobody's business
        let folder = from.parent().unwrap_or(Path::new(""));
        let other = folder.join(&named);
        let other = if other.is_file() { other } else { named.clone().into() };
        bytes = bytes_of(&other, MAX_BYTES).map_err(|e| e.at(&place))?;
        let mut behind = Header::read(&bytes, &other.display().to_string())?;
        // a block of the file that refers replaces that of the file it refers to
        behind.mods = header.mods.take().or(behind.mods);
        behind.opts = header.opts.take().or(behind.opts);
        header = behind;
        from = other;
    }
    let name = from.display().to_string();
    let mut road = Road::of(&header, &bytes, &name)?.profile(lanes)?;
    road.source = source;
    Ok(road)
}

/// A road with its data.
struct Road<'a> {
    header: &'a Header,
    bytes: &'a [u8],
    name: &'a str,
    format: Format,
    data: Range<usize>,
    /// The first line of the data.
    line: usize,
    /// Positions of the long sections, rising, and the channel of each.
    across: Vec<(f64, usize)>,
    notes: Vec<String>,
}

impl<'a> Road<'a> {
    fn of(header: &'a Header, bytes: &'a [u8], name: &'a str) -> Result<Self> {
        let fail = |what: String| Err(Error::file(format!("{name}: {what}")));
        let Some(format) = header.format else {
            return fail("$KD_DEFINITION has no format; add one such as #:LRFI".into());
        };
        let Some((start, line)) = header.data else {
            return fail("there is no line $$$$, behind which the data stand".into());
        };
        let key = |key: &str| header.road.get(key).map(|(number, _)| *number);
        let mut across: Vec<(f64, usize)> = Vec::new();
        let mut numbered = 0;
        let mut notes = header.notes.clone();
        for (i, channel) in header.channels.iter().enumerate() {
            match channel {
                Channel::At(v) => across.push((*v, i)),
                Channel::Number(number) => {
                    numbered += 1;
                    across.push((*number, i));
                }
                _ => {}
            }
        }
        if numbered > 0 && numbered < across.len() {
            return fail(
                "$KD_DEFINITION has long sections by number and by position; use one of both".into(),
            );
        }
        if across.len() < 2 {
            return fail(format!(
                "$KD_DEFINITION has {} long sections; a road has two at least",
                across.len()
            ));
        }
        across.sort_by(|a, b| a.0.total_cmp(&b.0));
        if numbered > 0 {
            let last = across.len() as f64 - 1.0;
            if across.iter().enumerate().any(|(i, (number, _))| *number != i as f64 + 1.0) {
                return fail(format!("the long sections are not numbered 1 to {}", across.len()));
            }
            // about the reference line where no border says where; others begin at 0 there
            let right = match (
                key("LONG_SECTION_V_RIGHT"),
                key("LONG_SECTION_V_LEFT"),
                key("LONG_SECTION_V_INCREMENT"),
            ) {
                (Some(right), ..) => right,
                (None, Some(left), Some(step)) => left - last * step,
                (None, None, Some(step)) => {
                    let half = 0.5 * last * step;
                    notes.push(format!(
                        "{name}: no LONG_SECTION_V_RIGHT says where the long sections are across; they are taken to lie about the reference line, from v = {} m to {half} m. Other programs begin at 0",
                        -half
                    ));
                    -half
                }
                _ => {
                    return fail("$ROAD_CRG has neither LONG_SECTION_V_RIGHT nor LONG_SECTION_V_INCREMENT, and the long sections have numbers only".into());
                }
            };
            let step = match (key("LONG_SECTION_V_INCREMENT"), key("LONG_SECTION_V_LEFT")) {
                (Some(step), Some(left)) if (right + last * step - left).abs() > 1e-3 * step.abs() => {
                    return fail(format!(
                        "$ROAD_CRG: {} long sections from LONG_SECTION_V_RIGHT = {right} in steps of {step} do not end at LONG_SECTION_V_LEFT = {left}",
                        across.len()
                    ));
                }
                (Some(step), _) => step,
                (None, Some(left)) => (left - right) / last,
                (None, None) => {
                    return fail(
                        "$ROAD_CRG has neither LONG_SECTION_V_INCREMENT nor LONG_SECTION_V_LEFT".into(),
                    );
                }
            };
            for (i, place) in across.iter_mut().enumerate() {
                place.0 = right + i as f64 * step;
            }
        }
        if let Some(pair) = across.windows(2).find(|pair| pair[1].0 - pair[0].0 < 1e-6) {
            return fail(format!(
                "two long sections are at v = {} m and {} m; they have to rise",
                pair[0].0, pair[1].0
            ));
        }
        Ok(Self { header, bytes, name, format, data: start..bytes.len(), line: line + 1, across, notes })
    }

    fn key(&self, key: &str) -> Option<f64> {
        self.header.road.get(key).map(|(number, _)| *number)
    }

    fn modifier(&self, key: &str) -> Option<f64> {
        self.header.mods.as_ref()?.get(key).map(|(number, _)| *number)
    }

    /// The heights along the lanes.
    fn profile(&self, lanes: &Lanes) -> Result<RoadProfile> {
        let mut road = RoadProfile { source: self.name.into(), track_width: 1.5, ..RoadProfile::default() };
        road.notes.extend(self.notes.iter().cloned());
        let width = self.modifier("SCALE_WIDTH").unwrap_or(1.0);
        let places: Vec<f64> = self.across.iter().map(|(v, _)| v * width).collect();
        let wanted = self.lanes(lanes, &places, &mut road)?;
        let mut brackets = Vec::new();
        for v in &wanted {
            brackets.push(self.bracket(&places, *v)?);
        }
        let mut track = Track::default();
        let nan = NanMode::of(self)?;
        let scale = self.modifier("SCALE_Z_GRID").unwrap_or(1.0);
        let mut missing = 0;
        let mut section = vec![0.0; self.across.len()];
        self.records(|line, record| {
            for (z, (_, channel)) in section.iter_mut().zip(&self.across) {
                *z = record.get(*channel).copied().unwrap_or(f64::NAN) * scale;
            }
            let used = brackets.iter().any(|(i, share)| {
                section.get(*i).is_some_and(|z| z.is_nan())
                    || *share > 0.0 && section.get(i + 1).is_some_and(|z| z.is_nan())
            });
            missing += usize::from(used);
            if used {
                nan.fill(&mut section).map_err(|what| {
                    Error::file(format!(
                        "{}:{line}: data, cross section {}: {what}",
                        self.name,
                        track.z.len() + 1
                    ))
                })?;
            }
            let heights = brackets.iter().map(|(i, share)| {
                let from = section.get(*i).copied().unwrap_or(f64::NAN);
                let to = section.get(i + 1).copied().unwrap_or(from);
                if *share == 0.0 { from } else { from + share * (to - from) }
            });
            let [one, two] = [0, 1].map(|i| heights.clone().nth(i).unwrap_or(0.0));
            track.lines.push(line);
            track.z.push([one, two]);
            for (channel, value) in self.header.channels.iter().zip(record) {
                match channel {
                    Channel::X => track.x.push(*value),
                    Channel::Y => track.y.push(*value),
                    Channel::U => track.u.push(*value),
                    Channel::Slope => track.slope.push(*value),
                    Channel::Banking => track.banking.push(*value),
                    _ => {}
                }
            }
            if track.z.len() > MAX_POINTS_READ {
                return Err(Error::file(format!(
                    "{}: more than {MAX_POINTS_READ} cross sections",
                    self.name
                )));
            }
            Ok(())
        })?;
        if missing > 0 {
            road.notes.push(format!(
                "{}: {missing} cross sections have no height (NaN) on the tracks: {}",
                self.name,
                nan.words()
            ));
        }
        let ways = self.ways(&track, &mut road)?;
        let line = self.reference_line(&track, ways.1, &mut road)?;
        let bank_scale = self.modifier("SCALE_BANKING").unwrap_or(1.0);
        let constant = self.key("REFERENCE_LINE_START_B").unwrap_or(0.0);
        let bank = |i: usize| match track.banking.get(i) {
            Some(bank) if bank.is_finite() => bank * bank_scale,
            // the first one may be unused
            Some(_) if i == 0 => constant * bank_scale,
            Some(_) => f64::NAN,
            None => constant * bank_scale,
        };
        let points = |lane: usize, v: f64| -> Result<Vec<[f64; 2]>> {
            let all: Vec<(usize, [f64; 2])> = (0..track.z.len())
                .map(|i| {
                    let z = track.z[i][lane] + line.get(i).copied().unwrap_or(0.0) + bank(i) * v;
                    (track.lines[i], [i as f64 * ways.1, z])
                })
                .collect();
            if let Some((line, _)) = all.iter().find(|(_, [_, z])| !z.is_finite()) {
                return Err(Error::file(format!(
                    "{}:{line}: data: slope or banking of a cross section is no number",
                    self.name
                )));
            }
            checked(self.name, "data", "cross section", &all)
        };
        road.left = points(0, wanted[0])?;
        if let Some(v) = wanted.get(1) {
            road.right = Some(points(1, *v)?);
            road.track_width = wanted[0] - v;
            road.middle = 0.5 * (wanted[0] + v);
        }
        if ways.0 != 0.0 {
            road.notes.push(format!(
                "{}: u = {} m of the file is x = 0; road_start moves the road away from where the wheel starts",
                self.name, ways.0
            ));
        }
        self.lost(&track, &mut road);
        Ok(road)
    }

    /// The positions of the tracks.
    fn lanes(&self, lanes: &Lanes, places: &[f64], road: &mut RoadProfile) -> Result<Vec<f64>> {
        let range = format!(
            "the file has v from {} to {} m",
            places.first().copied().unwrap_or(0.0),
            places.last().copied().unwrap_or(0.0)
        );
        match (lanes.left, lanes.right) {
            (Some(left), Some(right)) if left <= right => Err(Error::call(format!(
                "{}: the left track at {left} m has to be to the left of the right one at {right} m; v is positive to the left",
                self.name
            ))),
            (Some(left), Some(right)) => Ok(vec![left, right]),
            (Some(v), None) | (None, Some(v)) => Ok(vec![v]),
            (None, None) => {
                road.notes.push(format!(
                    "{}: no lateral position is given, so both tracks have the heights at v = 0; {range}",
                    self.name
                ));
                Ok(vec![0.0])
            }
        }
    }

    /// The long section to the right of a place, and the share of the way to the next.
    fn bracket(&self, places: &[f64], v: f64) -> Result<(usize, f64)> {
        let (first, last) = (places.first().copied().unwrap_or(0.0), places.last().copied().unwrap_or(0.0));
        if !(v >= first - 1e-9 && v <= last + 1e-9) {
            return Err(Error::file(format!(
                "{}: there are no heights at v = {v} m: the long sections go from v = {first} m (right) to {last} m (left); choose the tracks with --left and --right",
                self.name
            )));
        }
        let next = places.partition_point(|place| *place <= v);
        match (next.checked_sub(1), places.get(next)) {
            (None, _) => Ok((0, 0.0)),
            (Some(i), None) => Ok((i, 0.0)),
            (Some(i), Some(high)) => Ok((i, (v - places[i]) / (high - places[i]))),
        }
    }

    /// Where u begins, and its step.
    fn ways(&self, track: &Track, road: &mut RoadProfile) -> Result<(f64, f64)> {
        let fail = |what: String| Err(Error::file(format!("{}: {what}", self.name)));
        let count = track.z.len();
        if count < 2 {
            return fail(format!("the data have {count} cross sections; a road has two at least"));
        }
        let steps = (count - 1) as f64;
        let start = self.key("REFERENCE_LINE_START_U").unwrap_or(0.0);
        let end = self.key("REFERENCE_LINE_END_U");
        let even = |least: f64, most: f64, what: &str| -> Result<()> {
            if !(least >= 1e-6 && (most - least) / least <= 0.03) {
                return Err(Error::file(format!(
                    "{}: the steps of {what} go from {least} to {most} m; they have to be equal within 3 %",
                    self.name
                )));
            }
            Ok(())
        };
        let (mut least, mut most, mut sum) = (f64::INFINITY, f64::NEG_INFINITY, 0.0);
        let mut step_of = |step: f64| {
            (least, most) = (least.min(step), most.max(step));
            sum += step;
        };
        let (start, step) = if track.u.len() == count {
            track.u.windows(2).for_each(|pair| step_of(pair[1] - pair[0]));
            even(least, most, "reference line u")?;
            (track.u[0], sum / steps)
        } else if track.x.len() == count && track.y.len() == count {
            let pairs = track.x.windows(2).zip(track.y.windows(2));
            pairs.for_each(|(x, y)| step_of((x[1] - x[0]).hypot(y[1] - y[0])));
            even(least, most, "the reference line")?;
            (start, sum / steps)
        } else if let Some(step) = self.key("REFERENCE_LINE_INCREMENT") {
            if step <= 1e-6 {
                return fail(format!("$ROAD_CRG: REFERENCE_LINE_INCREMENT = {step} m has to be above 0"));
            }
            (start, step)
        } else if let Some(end) = end.filter(|end| *end > start) {
            (start, (end - start) / steps)
        } else {
            return fail(
                "$ROAD_CRG has no REFERENCE_LINE_INCREMENT, nor is there an end to compute it from".into(),
            );
        };
        let said = track.u.len() == count || self.key("REFERENCE_LINE_START_U").is_some();
        if let Some(begin) = self.header.begin.filter(|begin| *begin != 0.0 && !said) {
            road.notes.push(format!(
                "{}: U: of $KD_DEFINITION begins at {begin} m, but no REFERENCE_LINE_START_U does; the first cross section is x = 0",
                self.name
            ));
        }
        if let Some(end) = end {
            let expected = ((end - start) / step).round();
            if steps < expected {
                return fail(format!(
                    "the data have {count} cross sections, but from u = {start} m to REFERENCE_LINE_END_U = {end} m in steps of {step} m there are {}: the file is cut off",
                    expected + 1.0
                ));
            }
            if steps > expected {
                road.notes.push(format!(
                    "{}: the data have {count} cross sections, {} more than to REFERENCE_LINE_END_U = {end} m; all are used",
                    self.name,
                    steps - expected
                ));
            }
        }
        Ok((start, step * self.modifier("SCALE_LENGTH").unwrap_or(1.0)))
    }

    /// Heights of the reference line.
    fn reference_line(&self, track: &Track, step: f64, road: &mut RoadProfile) -> Result<Vec<f64>> {
        let count = track.z.len();
        let start = self.key("REFERENCE_LINE_START_Z").unwrap_or(0.0);
        let raised = self.modifier("REFLINE_OFFSET_Z").unwrap_or(0.0);
        let constant = self.key("REFERENCE_LINE_START_S").unwrap_or(0.0);
        let scale = self.modifier("SCALE_SLOPE").unwrap_or(1.0);
        let slope = |i: usize| track.slope.get(i).copied().unwrap_or(constant) * scale;
        if track.slope.is_empty() && constant == 0.0 {
            return Ok(vec![start + raised; count]);
        }
        let mut line = Vec::with_capacity(count);
        let mut z = start;
        for i in 0..count {
            // the slope of a record is that of the piece before it
            if i > 0 {
                z += slope(i) * step;
            }
            line.push(z);
        }
        let scaled = scale != 1.0 || self.modifier("SCALE_LENGTH").is_some();
        if let Some(end) = self.key("REFERENCE_LINE_END_Z").filter(|_| !scaled) {
            if (z - end).abs() > 1e-6 * step * count as f64 {
                road.notes.push(format!(
                    "{}: slopes lead to z = {z} m, and REFERENCE_LINE_END_Z is {end} m; the difference is spread over the length",
                    self.name
                ));
            }
            // also where it is the rounding of the slopes
            let (error, last) = (end - z, (count - 1) as f64);
            line.iter_mut().enumerate().for_each(|(i, z)| *z += error * i as f64 / last);
        }
        line.iter_mut().for_each(|z| *z += raised);
        Ok(line)
    }

    /// What the file has besides.
    fn lost(&self, track: &Track, road: &mut RoadProfile) {
        let has = |channel: Channel| self.header.channels.contains(&channel);
        let turned = self.key("REFERENCE_LINE_START_PHI") != self.key("REFERENCE_LINE_END_PHI")
            && self.key("REFERENCE_LINE_END_PHI").is_some();
        if has(Channel::Phi) || has(Channel::X) || turned {
            road.lost.push(
                "the curvature of the reference line: the road lies straight, heights over the way along it"
                    .into(),
            );
        }
        if !track.banking.is_empty() || self.key("REFERENCE_LINE_START_B").is_some_and(|b| b != 0.0) {
            road.lost.push(
                "the banking other than in the heights of the tracks: beyond them the road is level across"
                    .into(),
            );
        }
        let lanes = if road.right.is_some() { 2 } else { 1 };
        road.lost.push(format!(
            "{} long sections: {} used",
            self.across.len(),
            if lanes == 2 { "two places across the road are" } else { "one place across the road is" }
        ));
        if self.header.comments {
            road.lost.push("the comments of $CT".into());
        }
        if self
            .header
            .road
            .keys()
            .any(|key| key.ends_with("_X") || key.ends_with("_Y") || key.ends_with("_PHI"))
        {
            road.lost.push("place and heading of the reference line in the plane".into());
        }
        if self
            .header
            .road
            .keys()
            .any(|key| key.ends_with("_LON") || key.ends_with("_LAT") || key.ends_with("_ALT"))
        {
            road.lost.push("the place on the globe".into());
        }
        let listed = |numbers: &Option<Numbers>, used: &[&str], neutral: &dyn Fn(&str, f64) -> bool| {
            let all = numbers.iter().flatten();
            let others: Vec<String> = all
                .filter(|(key, (value, _))| !used.contains(&key.as_str()) && !neutral(key, *value))
                .map(|(key, (value, _))| format!("{key} = {value}"))
                .collect();
            others.join(", ")
        };
        let mods = listed(&self.header.mods, MODIFIERS, &|_, value| value == 0.0);
        if !mods.is_empty() {
            road.lost.push(format!("modifiers that place the road in the plane: {mods}"));
        }
        let neutral = |key: &str, value: f64| match key {
            "BORDER_MODE_U" => value == 2.0,
            _ => !key.starts_with("BORDER") || value == 0.0,
        };
        let opts = listed(&self.header.opts, &["BORDER_MODE_V", "BORDER_OFFSET_V"], &neutral);
        if !opts.is_empty() {
            road.lost
                .push(format!("options of the ends: {opts}; before and behind its points a road is level"));
        }
    }
}

/// Modifiers that heights follow, or that do not change them on a line that is laid out straight.
const MODIFIERS: &[&str] = &[
    "SCALE_Z_GRID",
    "SCALE_SLOPE",
    "SCALE_BANKING",
    "SCALE_LENGTH",
    "SCALE_WIDTH",
    "GRID_NAN_MODE",
    "GRID_NAN_OFFSET",
    "REFLINE_OFFSET_Z",
];

/// What the data hold along the way.
#[derive(Default)]
struct Track {
    lines: Vec<usize>,
    /// Heights of the grid on the tracks.
    z: Vec<[f64; 2]>,
    x: Vec<f64>,
    y: Vec<f64>,
    u: Vec<f64>,
    slope: Vec<f64>,
    banking: Vec<f64>,
}
