//! The page of one run.

use super::channels::{Chapter, MAX_LINES, chapters};
use super::compared::comparison;
use super::patch::{PatchFrame, patch_frames};
use super::plot::{Axis, Plot, Size};
use super::scale::called;
use crate::comparison::Conditions;
use crate::page::{Html, Page, Section, Table, number};
use crate::recording::{Channel, Recording};
use crate::stats::extent;
use std::collections::{BTreeMap, BTreeSet};

/// Commands of a rig and the unit to show them in.
const COMMANDS: [(&str, &str); 6] = [
    ("slip", "%"),
    ("slip_angle", "deg"),
    ("camber", "deg"),
    ("steer", "deg"),
    ("deflection", "mm"),
    ("path_speed", "km/h"),
];
/// Forces and moments: quantity, unit, size of the plot, channels. The aligning moment is so much
/// smaller than the others that it would vanish among them.
const LOADS: [(&str, &str, Size, &[&str]); 3] = [
    ("force", "N", Size::Full, &["force_x", "force_y", "force_z"]),
    ("moment", "N.m", Size::Full, &["moment_x", "moment_y"]),
    ("moment z", "N.m", Size::Strip, &["moment_z"]),
];

/// What happens inside the tire: title, unit, channels.
const INSIDE: [(&str, &str, &[&str]); 6] = [
    ("Contact length", "mm", &["contact_length_left", "contact_length_center", "contact_length_right"]),
    ("Bristles that slide", "%", &["sliding_share"]),
    ("Friction power", "W", &["friction_power"]),
    ("Largest pressure", "bar", &["pressure_max"]),
    ("Penetration of the belt", "mm", &["belt_deflection"]),
    ("Sliding distance", "m", &["sliding_distance"]),
];

/// Over which slip what is shown: y, its unit, slip, its unit.
const OVER_SLIP: [(&str, &str, &str, &str); 4] = [
    ("force_x", "N", "slip", "%"),
    ("force_y", "N", "slip_angle", "deg"),
    ("moment_z", "N.m", "slip_angle", "deg"),
    ("force_y", "N", "force_x", "N"),
];

/// What the numbers 1, 2, ... of channels are called, by the name of the channel: the items of enumerations.
pub type Names = BTreeMap<String, Vec<String>>;

/// What a plot over time spans at least, as a share of its largest value,
const LEAST_SHARE: f64 = 0.1;
/// and by unit, so that noise and rounding about 0 do not look like a signal: some ten times the noise of sensors on rigs. It decides no
/// more than how a plot looks, and zooming shows the rest.
const LEAST: [(&str, f64); 13] = [
    ("N", 20.0),
    ("kN", 0.02),
    ("N.m", 2.0),
    ("deg", 0.5),
    ("rad", 0.01),
    ("%", 1.0),
    ("mm", 1.0),
    ("m", 1e-3),
    ("km/h", 1.0),
    ("m/s", 0.2),
    ("m/s2", 0.5),
    ("bar", 0.1),
    ("Pa", 1e4),
];

/// The page of a simulation: what went in and out over time, forces over slip and the contact patch
/// where there are such channels, what was measured beside it, and a table of all channels.
///
/// Channels are found by the names that the tire models of this crate give them; all others are
/// shown over time, grouped by unit, those of systems by component and quantity, so that the page makes sense for any model. Measured channels
/// belong to the simulated ones of the same name, and are compared with them. `facts` are rows of a table at the top (model,
/// step size, settings, ...).
pub fn simulation_report(
    title: &str,
    description: &str,
    recording: &Recording,
    names: &Names,
    beside: Option<Beside<'_>>,
    frames: &[PatchFrame],
    facts: &[(String, String)],
) -> String {
    let mut run = Run { recording, names, beside, shown: BTreeSet::new() };
    let mut table = Table::new(&[]);
    for (name, value) in facts {
        table = table.row([name, value]);
    }
    let mut about = Section::default();
    if !table.is_empty() {
        about = about.with(table.html());
    }
    let mut patch = Section::new("Contact patch");
    if !frames.is_empty() {
        patch = patch.with(patch_frames(frames));
    }
    let page = Page::new(title, description)
        .section(about)
        .section(run.forces())
        .section(run.commands())
        .section(run.over_slip())
        .section(patch)
        .section(run.inside())
        .section(run.states());
    run.others()
        .into_iter()
        .fold(page, Page::section)
        .section(comparison(recording, beside))
        .section(run.channels())
        .html()
}

/// What a simulation is shown beside. Both are behind the low-pass of the conditions.
#[derive(Debug, Clone, Copy)]
pub struct Beside<'a> {
    /// What was measured.
    pub measured: &'a Recording,
    /// What it is compared under.
    pub conditions: &'a Conditions,
}

/// A run and which of its channels the page has shown so far.
struct Run<'a> {
    recording: &'a Recording,
    names: &'a Names,
    beside: Option<Beside<'a>>,
    shown: BTreeSet<&'a str>,
}

impl<'a> Run<'a> {
    /// Adds a channel over time to a plot, and what was measured of it. False if there is no such
    /// channel or its unit does not fit.
    fn add(&mut self, plot: &mut Plot, name: &str, label: &str, unit: &str) -> bool {
        let recording = self.recording;
        let Some(channel) = recording.channels.iter().find(|c| c.name == name) else {
            return false;
        };
        let Ok(values) = recording.channel_in(name, unit) else {
            return false;
        };
        let mut grown = plot.clone().line(label, &recording.time, &values);
        if let Some((measured, values)) = self.measured(name, unit) {
            grown = grown.measured(&format!("{label}, measured"), &measured.time, &values);
        }
        let least = LEAST.iter().find(|(of, _)| *of == unit).map_or(0.0, |(_, least)| *least);
        let largest = values.iter().filter(|v| v.is_finite()).fold(0.0, |most: f64, v| most.max(v.abs()));
        *plot = grown.at_least(least.max(LEAST_SHARE * largest));
        self.shown.insert(channel.name.as_str());
        true
    }

    fn measured(&self, name: &str, unit: &str) -> Option<(&'a Recording, Vec<f64>)> {
        let measured = self.beside?.measured;
        Some((measured, measured.channel_in(name, unit).ok()?))
    }

    /// A plot of all channels of these names that there are.
    fn over_time(&mut self, title: &str, quantity: &str, unit: &str, names: &[&str]) -> Plot {
        let mut plot = Plot::new(title, Axis::time(), Axis::new(quantity, unit));
        for name in names {
            self.add(&mut plot, name, name, unit);
        }
        plot
    }

    fn forces(&mut self) -> Section {
        let mut section = Section::new("Forces and moments");
        for (quantity, unit, size, names) in LOADS {
            let plot = self.over_time("", quantity, unit, names).size(size);
            if !plot.is_empty() {
                section = section.with(plot.html());
            }
        }
        section
    }

    /// Commands that change as strips over one another, those that do not as a table.
    fn commands(&mut self) -> Section {
        let mut section = Section::new("Commands");
        let mut constant = Table::new(&["constant command", "value", "unit"]);
        for (name, unit) in COMMANDS {
            let actual = format!("actual_{name}");
            let mut plot =
                Plot::new("", Axis::time(), Axis::new(&name.replace('_', " "), unit)).size(Size::Strip);
            let command = self.add(&mut plot, name, name, unit);
            if !command && !self.recording.has(&actual) {
                continue;
            }
            self.add(&mut plot, &actual, &actual, unit);
            let is_constant = |r: &Recording, name: &str| {
                r.channel(name).is_ok_and(|c| c.values.windows(2).all(|w| w[0] == w[1]))
            };
            let still = |r: &Recording| [name, &actual].iter().all(|n| !r.has(n) || is_constant(r, n));
            if command && still(self.recording) && self.beside.is_none_or(|beside| still(beside.measured)) {
                let value = self.recording.channel_in(name, unit).ok().and_then(|v| v.first().copied());
                constant = constant.row([name, &number(value.unwrap_or(f64::NAN)), unit]);
            } else if !plot.is_empty() {
                section = section.with(plot.html());
            }
        }
        if constant.is_empty() { section } else { section.with(constant.html()) }
    }

    fn over_slip(&self) -> Section {
        let mut plots = Vec::new();
        for (y, y_unit, x, x_unit) in OVER_SLIP {
            let curve = |recording: &Recording| {
                // the slip that the tire really had, behind the actuators
                let actual = format!("actual_{x}");
                let x = if recording.has(&actual) { &actual } else { x };
                let pair = (recording.channel_in(x, x_unit).ok()?, recording.channel_in(y, y_unit).ok()?);
                spread(&pair.0).then_some(pair)
            };
            let Some((xs, ys)) = curve(self.recording) else { continue };
            let axes = (Axis::new(&x.replace('_', " "), x_unit), Axis::new(&y.replace('_', " "), y_unit));
            let plot = Plot::new("", axes.0, axes.1).size(Size::Half);
            let mut plot = match self.recording.channel_in("force_z", "kN") {
                Ok(load) if y != "force_z" && is_several(&load) => by_load(plot, &load, &xs, &ys),
                _ => plot.line(&format!("{y} over {x}"), &xs, &ys),
            };
            if let Some((xs, ys)) = self.beside.and_then(|beside| curve(beside.measured)) {
                plot = plot.measured("measured", &xs, &ys);
            }
            plots.push(plot.html());
        }
        // forces over each other say nothing where there is no slip to vary
        if plots.len() < 2 && !self.recording.has("slip") && !self.recording.has("slip_angle") {
            return Section::default();
        }
        side_by_side("Force over slip", plots)
    }

    fn inside(&mut self) -> Section {
        let plots: Vec<Html> = INSIDE
            .into_iter()
            .map(|(title, unit, names)| {
                self.over_time("", &title.to_lowercase(), unit, names).size(Size::Half)
            })
            .filter(|plot| !plot.is_empty())
            .map(|plot| plot.html())
            .collect();
        side_by_side("Inside the patch", plots)
    }

    /// Channels whose values have names: those of the same variable in several places, or with the same names, in one picture.
    fn states(&mut self) -> Section {
        let mut pictures: Vec<(&[String], Vec<&'a str>)> = Vec::new();
        for channel in &self.recording.channels {
            let Some(names) = self.names.get(&channel.name) else { continue };
            match pictures.iter_mut().find(|(others, own)| *others == names && own.len() < MAX_LINES) {
                Some((_, own)) => own.push(&channel.name),
                None => pictures.push((names, vec![&channel.name])),
            }
        }
        let mut section = Section::new("States");
        for (names, channels) in pictures {
            let quantity = if let [one] = channels[..] { one } else { "state" };
            let mut plot =
                Plot::new("", Axis::time(), Axis::new(quantity, "1")).size(Size::Strip).named(names);
            for name in channels {
                self.add(&mut plot, name, name, "1");
            }
            if !plot.is_empty() {
                section = section.with(plot.html());
            }
        }
        section
    }

    /// All that has not been shown, a section for each component of a system.
    fn others(&mut self) -> Vec<Section> {
        let first = self.shown.is_empty();
        let heading = if first { "Channels over time" } else { "Other channels" };
        let recording = self.recording;
        let left: Vec<&Channel> =
            recording.channels.iter().filter(|c| !self.shown.contains(c.name.as_str())).collect();
        let chapters = chapters(&left);
        let few = chapters.iter().map(|chapter| chapter.pictures.len()).sum::<usize>() < 4;
        let size = if first && few { Size::Full } else { Size::Half };
        let mut sections = Vec::new();
        for Chapter { components, pictures } in chapters {
            let title = if components.is_empty() { heading.to_owned() } else { components.join(", ") };
            let mut plots = Vec::new();
            for picture in pictures {
                let mut plot = Plot::new("", Axis::time(), Axis::new(&picture.quantity, picture.unit));
                for (name, label) in &picture.lines {
                    self.add(&mut plot, name, label, picture.unit);
                }
                plots.push(plot.size(size).html());
            }
            sections.push(match size {
                Size::Half => side_by_side(&title, plots),
                _ => plots.into_iter().fold(Section::new(&title), Section::with),
            });
        }
        sections
    }

    fn channels(&self) -> Section {
        let mut table = Table::new(&["channel", "unit", "smallest", "mean", "largest", "at the end"]);
        for Channel { name, unit, values } in &self.recording.channels {
            let mean = values.iter().sum::<f64>() / values.len() as f64;
            let end = values.last().copied().unwrap_or(f64::NAN);
            let [low, high] = [
                values.iter().copied().fold(f64::NAN, f64::min),
                values.iter().copied().fold(f64::NAN, f64::max),
            ];
            let numbers = match self.names.get(name) {
                Some(names) => {
                    let called = |v: f64| called(names, v).map_or_else(|| number(v), str::to_owned);
                    [called(low), number(f64::NAN), called(high), called(end)]
                }
                None => [low, mean, high, end].map(number),
            };
            table = table.row([name.clone(), unit.clone()].into_iter().chain(numbers));
        }
        let section = Section::new("All channels");
        if table.is_empty() { section } else { section.with(table.html()) }
    }
}

/// True if the values vary by more than rounding.
fn spread(values: &[f64]) -> bool {
    let (low, high) = extent(values.iter().copied());
    high - low > 1e-6 * low.abs().max(high.abs()) && high - low > 1e-9
}

/// Whether a rig drove several loads, and not one that its controller holds to a few percent.
fn is_several(load: &[f64]) -> bool {
    let (low, high) = extent(load.iter().copied().filter(|v| v.is_finite()));
    high > 0.0 && high - low.max(0.0) > 0.2 * high
}

/// A curve in shades of the load \[kN\], each for a part of its range.
fn by_load(plot: Plot, load: &[f64], x: &[f64], y: &[f64]) -> Plot {
    /// A run at three loads has each in a shade of its own, with one between.
    const SHADES: usize = 6;
    let (low, high) = extent(load.iter().copied().filter(|v| v.is_finite()));
    let width = (high - low) / SHADES as f64;
    let shade_at = |k: usize| (((load[k] - low) / width) as usize).min(SHADES - 1);
    (0..SHADES).fold(plot, |plot, shade| {
        // a line goes on to the first point of the next shade
        let is_in = |k: usize| shade_at(k) == shade || k > 0 && shade_at(k - 1) == shade;
        if !(0..load.len()).any(|k| shade_at(k) == shade) {
            return plot;
        }
        let cut: Vec<f64> = x.iter().enumerate().map(|(k, x)| if is_in(k) { *x } else { f64::NAN }).collect();
        let [from, to] = [shade, shade + 1].map(|edge| low + width * edge as f64);
        let share = shade as f64 / (SHADES - 1) as f64;
        plot.shaded(&format!("force_z {from:.1} to {to:.1} kN"), share, &cut, y)
    })
}

fn side_by_side(heading: &str, plots: Vec<Html>) -> Section {
    let section = Section::new(heading);
    if plots.is_empty() { section } else { section.side_by_side(plots) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::page::still;

    /// Name, unit, course.
    type Course<'a> = (&'a str, &'a str, &'a dyn Fn(f64) -> f64);

    fn recording(channels: &[Course]) -> Recording {
        let time: Vec<f64> = (0..200).map(|i| f64::from(i) * 0.01).collect();
        let channels = channels
            .iter()
            .map(|(name, unit, f)| Channel {
                name: (*name).into(),
                unit: (*unit).into(),
                values: time.iter().map(|t| f(*t)).collect(),
            })
            .collect();
        Recording { time, channels, source: "run.csv".into() }
    }

    fn tire() -> Recording {
        recording(&[
            ("slip", "1", &|t| 0.1 * t),
            ("slip_angle", "rad", &|t| 0.1 * t),
            ("camber", "rad", &|_| 0.1),
            ("force_x", "N", &|t| 3000.0 * t),
            ("force_y", "N", &|t| -3000.0 * t),
            ("force_z", "N", &|_| 4000.0),
            ("moment_z", "N.m", &|t| t),
            ("contact_length_center", "m", &|_| 0.12),
            ("sliding_share", "1", &|t| 0.3 * t),
            ("belt_yaw", "rad", &|t| t),
        ])
    }

    fn beside(measured: &Recording) -> Beside<'_> {
        static NONE: Conditions = Conditions { low_pass: None, swing: None, repeats: Vec::new() };
        Beside { measured, conditions: &NONE }
    }

    #[test]
    fn a_tire_has_its_sections_and_units() {
        let html = simulation_report(
            "t",
            "d",
            &tire(),
            &Names::new(),
            None,
            &[],
            &[("step size".into(), "1 ms".into())],
        );
        for text in [
            "Forces and moments",
            "Commands",
            "Force over slip",
            "Inside the patch",
            "Other channels",
            "All channels",
            "force [N]",
            "moment z [N.m]",
            "slip angle [deg]",
            "slip [%]",
            "contact length [mm]",
            "belt_yaw [rad]",
            "<td>step size</td><td>1 ms</td>",
        ] {
            assert!(html.contains(text), "{text}");
        }
        // a constant command is a row, not a plot
        assert!(html.contains("<td>camber</td><td class=\"number\">5.73</td><td>deg</td>"));
        assert!(!html.contains("camber [deg]") && !html.contains("Contact patch"));
        // forces, aligning moment, two commands, four over slip, two inside, one other
        assert_eq!(html.matches("<svg").count(), 2 + 2 + 4 + 2 + 1);
    }

    #[test]
    fn forces_over_slip_are_in_shades_of_several_loads() {
        let mut run = tire();
        let load = run.channels.iter_mut().find(|c| c.name == "force_z").unwrap();
        load.values.iter_mut().enumerate().for_each(|(k, v)| *v = if k < 100 { 2000.0 } else { 6000.0 });
        let html = simulation_report("t", "", &run, &Names::new(), None, &[], &[]);
        let over_slip = html.split("<h2>").find(|section| section.starts_with("Force over slip")).unwrap();
        for figure in over_slip.split("<figcaption>").skip(1) {
            let keys: Vec<&str> = figure.split("</i>").skip(1).filter_map(|k| k.split('<').next()).collect();
            assert_eq!(keys, ["force_z 2.0 to 2.7 kN", "force_z 5.3 to 6.0 kN"]);
        }
        assert_eq!(over_slip.matches("<svg").count(), 4);
    }

    #[test]
    fn nothing_is_loaded_from_elsewhere() {
        let frame = PatchFrame { cells: vec![crate::tire::Cell::default(); 2], ..PatchFrame::default() };
        let html = simulation_report(
            "t",
            "d",
            &tire(),
            &Names::new(),
            Some(beside(&tire())),
            &[frame.clone(), frame],
            &[],
        );
        let rest = still(&html).replace("xmlns=\"http://www.w3.org/2000/svg\"", "");
        for outside in ["http:", "https:", "url(", "@import", "src=", "href=\"h"] {
            assert!(!rest.contains(outside), "{outside}");
        }
    }

    #[test]
    fn every_plot_says_its_units() {
        let html = simulation_report("t", "", &tire(), &Names::new(), None, &[], &[]);
        for svg in html.split("<svg").skip(1) {
            let svg = svg.split("</svg>").next().unwrap();
            let texts = svg.split("<text").skip(1).filter(|t| t.contains(']')).count();
            assert_eq!(texts, 2, "{svg}");
        }
    }

    #[test]
    fn any_model_is_shown_by_unit() {
        let run = recording(&[
            ("displacement", "m", &|t| t.sin()),
            ("velocity", "m/s", &|t| t.cos()),
            ("target", "m", &|_| 0.0),
        ]);
        let html = simulation_report("oscillator", "", &run, &Names::new(), None, &[], &[]);
        assert!(
            html.contains("Channels over time")
                && html.contains("velocity [m/s]")
                && html.contains("value [m]")
        );
        assert_eq!(html.matches("<svg").count(), 2);
        let headings: Vec<&str> = html.split("<h2>").skip(1).filter_map(|h| h.split('<').next()).collect();
        assert_eq!(headings, ["Channels over time", "All channels"]);
    }

    #[test]
    fn many_channels_of_one_unit_share_plots_of_a_few() {
        let names: Vec<String> = (0..14).map(|i| format!("c{i}")).collect();
        let channels: Vec<Course> =
            names.iter().map(|n| (n.as_str(), "N", &(|t| t) as &dyn Fn(f64) -> f64)).collect();
        let html = simulation_report("", "", &recording(&channels), &Names::new(), None, &[], &[]);
        assert_eq!(html.matches("<svg").count(), 3);
    }

    #[test]
    fn small_channels_do_not_vanish_beside_large_ones() {
        let run = recording(&[
            ("angle", "rad", &|t| 100.0 * t),
            ("tilt", "rad", &|t| 0.1 * t),
            ("yaw", "rad", &|t| -0.2 * t),
            ("still", "rad", &|_| 0.0),
        ]);
        let html = simulation_report("", "", &run, &Names::new(), None, &[], &[]);
        let captions: Vec<&str> =
            html.split("<figcaption>").skip(1).filter_map(|f| f.split("</figcaption>").next()).collect();
        let [large, small] = captions[..] else { panic!("{captions:?}") };
        assert!(
            large.contains("angle")
                && large.contains("still")
                && small.contains("tilt")
                && small.contains("yaw")
        );
    }

    #[test]
    fn measured_channels_are_drawn_in_the_unit_of_the_simulation_and_compared() {
        let run = recording(&[("force_z", "N", &|t| 1000.0 * t)]);
        let rig = recording(&[("force_z", "kN", &|t| t - 0.1), ("noise", "Pa", &|_| 0.0)]);
        let html = simulation_report("", "", &run, &Names::new(), Some(beside(&rig)), &[], &[]);
        assert!(html.contains("force_z, measured"));
        assert_eq!(html.matches("stroke-dasharray").count(), 1);
        // 100 N off everywhere, 1890 N at most measured
        assert!(html.contains("<td>force_z</td><td>N</td><td class=\"number\">100</td><td class=\"number\">100</td><td class=\"number\">100</td><td class=\"number\">5.291</td>"));
        assert!(html.contains("&quot;noise&quot; was not simulated"));
    }

    #[test]
    fn text_stays_text() {
        let bad = "<script>alert(1)</script>";
        let mut run = recording(&[(bad, bad, &|t| t), ("force_x", "N", &|t| t)]);
        run.source = bad.into();
        let frame = PatchFrame {
            title: bad.into(),
            cells: vec![crate::tire::Cell::default()],
            ..PatchFrame::default()
        };
        let html = simulation_report(
            bad,
            bad,
            &run,
            &Names::new(),
            Some(beside(&run)),
            &[frame],
            &[(bad.into(), bad.into())],
        );
        assert!(!still(&html).contains("<script>"));
        assert!(html.contains("&lt;script&gt;alert(1)"));
    }

    #[test]
    fn states_are_called_by_their_names() {
        let phase = |t: f64| {
            if t < 0.5 {
                1.0
            } else if t < 1.0 {
                3.0
            } else {
                2.0
            }
        };
        let run =
            recording(&[("phase_1", "1", &phase), ("phase_2", "1", &|_| 0.0), ("level", "1", &|_| 2.0)]);
        let items = ["off", "hold", "dump"].map(String::from).to_vec();
        let names = Names::from([("phase_1".into(), items.clone()), ("phase_2".into(), items)]);
        let html = simulation_report("", "", &run, &names, None, &[], &[]);
        let states = html.split("<h2").find(|part| part.contains(">States</h2>")).unwrap();
        // one picture with two lines, and a name at each height
        assert_eq!((states.matches("<figure>").count(), states.matches("class=\"key\"").count()), (1, 2));
        for name in ["off", "hold", "dump"] {
            assert!(states.contains(&format!("\n{name}\n")), "{states}");
        }
        let row =
            |name: &str| html.rsplit("<tr>").find(|row| row.contains(&format!("<td>{name}</td>"))).unwrap();
        // smallest, largest, and at the end; 0 is called nothing
        for (name, words) in
            [("phase_1", ["off", "dump", "hold"]), ("phase_2", ["0", "0", "0"]), ("level", ["2"; 3])]
        {
            assert!(words.iter().all(|word| row(name).contains(&format!(">{word}</td>"))), "{}", row(name));
        }
    }

    #[test]
    fn an_empty_run_is_a_page() {
        let html = simulation_report("nothing", "", &Recording::default(), &Names::new(), None, &[], &[]);
        assert!(html.contains("nothing") && !html.contains("<svg"));
    }
}
