//! The page of braking runs: the same stop on several roads with two systems each, the contact patches
//! moving beside each other.

mod figures;
mod film;

pub use figures::StopFigures;

use self::film::Film;
use latsch::recording::Recording;
use latsch::report::{Axis, Html, Page, PatchFrame, Plot, Section, Size, Table, escape};
use latsch::stats::extent;
use latsch::{Error, Result};
use serde_json::{Value, json};
use std::fmt::Write;

const STYLE: &str = include_str!("stop.css");
const SCRIPT: &str = include_str!("stop.js");
/// The colours of the two systems: the first two of plots.
const COLORS: [&str; 2] = ["#0072b2", "#d55e00"];
/// Heights in the side view are drawn larger by this factor.
const EXAGGERATION: f64 = 3.0;

/// One scenario: a road and two runs on it.
#[derive(Debug)]
pub struct StopScene {
    /// A word for addresses.
    pub id: String,
    /// A heading.
    pub title: String,
    /// What the road is like.
    pub text: String,
    /// Points of the road's profile, x and z \[m\].
    pub road: Vec<[f64; 2]>,
    /// The runs; the first is compared with the second.
    pub runs: [StopRun; 2],
}

/// One braking run of a corner (`corner.`) with its brake (`brake.`).
#[derive(Debug)]
pub struct StopRun {
    /// What brakes.
    pub name: String,
    /// Its channels, evenly sampled.
    pub recording: Recording,
    /// The contact patch at every sample.
    pub frames: Vec<PatchFrame>,
    /// Its numbers.
    pub figures: StopFigures,
    /// Radius of the tire \[m\].
    pub radius: f64,
    /// Rolling radius \[m\].
    pub rolling_radius: f64,
    /// Height of the wheel's centre in the static position \[m\].
    pub height: f64,
}

/// The page: numbers of all runs, then for each scenario the moving patches and what was recorded.
/// `about` are paragraphs and tables for its end.
///
/// # Errors
/// Channels that are not there.
pub fn stop_page(title: &str, lead: &str, scenes: &[StopScene], about: Section) -> Result<String> {
    let frames: Vec<&PatchFrame> = scenes.iter().flat_map(|s| &s.runs).flat_map(|r| &r.frames).collect();
    let film = Film::new(&frames);
    let mut page = Page::new(title, lead).section(summary(scenes));
    for scene in scenes {
        page = page.section(scene_section(scene, &film)?);
    }
    let script = format!(
        "<style>\n{STYLE}</style>\n<div class=\"player\" hidden><div><button type=\"button\">Play</button>\
         <select aria-label=\"scenario\"></select>\
         <input type=\"range\" aria-label=\"time\"><output></output>\
         <select class=\"pace\" aria-label=\"speed\"><option value=\"1\">1 ×</option><option value=\"0.25\">1/4 ×</option>\
         <option value=\"0.1\" selected>1/10 ×</option><option value=\"0.02\">1/50 ×</option></select></div></div>\n\
         <noscript><p class=\"note\">Without JavaScript the pictures stand still.</p></noscript>\n{}<script>\n{SCRIPT}</script>\n",
        data("film", &film.scales())
    );
    let page = page.section(about.with(Html::raw(script)));
    Ok(page.html())
}

/// Distances as bars, and the other numbers.
fn summary(scenes: &[StopScene]) -> Section {
    let longest =
        scenes.iter().flat_map(|s| &s.runs).map(|r| r.figures.distance).fold(f64::MIN_POSITIVE, f64::max);
    let mut bars = String::from("<figure><div class=\"bars\">\n");
    let mut table = Table::new(&[
        "",
        "distance [m]",
        "time [s]",
        "mean deceleration [m/s²]",
        "longest lock [s]",
        "all bristles slide [% of time]",
        "heat in the contact [kJ]",
        "heat in the brake [kJ]",
    ]);
    for scene in scenes {
        let _ = writeln!(bars, "<b>{}</b>", escape(&scene.title));
        for (run, color) in scene.runs.iter().zip(COLORS) {
            let f = &run.figures;
            let _ = writeln!(
                bars,
                "<span>{}</span><div><i style=\"width:{:.1}%;background:{color}\"></i>{:.1} m</div>",
                escape(&run.name),
                // room for the number beside the longest
                80.0 * f.distance / longest,
                f.distance
            );
            table = table.row([
                format!("{}, {}", scene.title, run.name),
                format!("{:.2}", f.distance),
                format!("{:.2}", f.duration()),
                format!("{:.2}", f.deceleration),
                format!("{:.2}", f.locked),
                format!("{:.0}", 100.0 * f.all_slide),
                format!("{:.1}", f.tire_heat / 1e3),
                format!("{:.1}", f.brake_heat / 1e3),
            ]);
        }
    }
    bars.push_str("</div></figure>\n");
    let range = |f: &dyn Fn(&StopScene) -> f64, unit: &str| {
        let (low, high) = extent(scenes.iter().map(f));
        match unit.strip_prefix('±') {
            Some(unit) => format!("{low:+.1} to {high:+.1} {unit}"),
            None => format!("{low:.0} to {high:.0} {unit}"),
        }
        .replace('-', "−")
    };
    let difference = |s: &StopScene| 100.0 * (s.runs[0].figures.distance / s.runs[1].figures.distance - 1.0);
    let share = |i: usize| move |s: &StopScene| 100.0 * s.runs[i].figures.tire_share();
    let names =
        scenes.first().map_or([String::new(), String::new()], |s| [0, 1].map(|i| s.runs[i].name.clone()));
    let reading = format!(
        "The distance {} differs from that {} by {}; how much depends on how fast the sliding friction falls with the sliding \
         speed, see below. What differs as well is where the heat is made, {} of it in the contact patch against {}, and \
         whether bristles are left that stick and could guide the wheel.",
        names[0],
        names[1],
        range(&difference, "±%"),
        range(&share(0), "%"),
        range(&share(1), "%"),
    );
    Section::new("Stopping distance")
        .with(Html::raw(bars))
        .with(Html::text(&reading))
        .with(Html::raw(format!("<div class=\"numbers\">\n{}</div>\n", table.html().as_str())))
        .with(Html::note(
            "From the driver's first pressure to standstill, the first sample below 0.1 m/s. Mean deceleration: speed squared over \
             twice the distance. Lock: slip beyond −80 %; lock and sliding count above 2 m/s.",
        ))
}

fn scene_section(scene: &StopScene, film: &Film) -> Result<Section> {
    let mut html = format!("<div class=\"scene\" id=\"{}\">\n<div class=\"stages\">\n", escape(&scene.id));
    let first = scene.runs[0].figures.start + 0.4;
    let (start, step) = sampling(&scene.runs[0].recording)?;
    for (run, color) in scene.runs.iter().zip(COLORS) {
        let shown = ((first - start) / step).round() as usize;
        let frame = run.frames.get(shown).or(run.frames.last()).cloned().unwrap_or_default();
        let _ = write!(
            html,
            "<figure class=\"stage\"><figcaption><b><span class=\"dot\" style=\"background:{color}\"></span>{}</b>\
             <span>{:.1} m</span></figcaption><output></output>\n\
             <svg role=\"img\" aria-label=\"wheel on the road\" viewBox=\"0 0 560 360\"><g class=\"side\"></g></svg>\n{}</figure>\n",
            escape(&run.name),
            run.figures.distance,
            film.drawing(&frame)
        );
    }
    html.push_str("</div>\n");
    let mut explanation = film.explanation();
    let _ = write!(
        explanation,
        " Side view: wheel and spin angle to scale; heights of wheel, body and road and the wheel's give along the road are {EXAGGERATION} \
         times as large; orange: forces of the road on the wheel. Drag in a plot to move the time."
    );
    html.push_str(Html::note(&explanation).as_str());
    html.push_str("<div class=\"grid\">\n");
    for plot in plots(scene)? {
        html.push_str(plot.html().as_str());
    }
    html.push_str("</div>\n");
    let runs: Result<Vec<Value>> = scene.runs.iter().map(|run| run_data(run, film)).collect();
    let stop = scene.runs.iter().filter_map(|r| r.recording.time.last()).fold(start, |a, b| a.max(*b));
    let [run, _] = &scene.runs;
    html.push_str(&data(
        "data",
        &json!({
            "start": start,
            "step": step,
            "stop": stop,
            "first": first,
            "road": scene.road,
            "view": { "radius": run.radius, "height": run.height, "exaggeration": EXAGGERATION },
            "runs": runs?,
        }),
    ));
    html.push_str("</div>\n");
    Ok(Section::new(&scene.title).with(Html::text(&scene.text)).with(Html::raw(html)))
}

/// Start and step of an evenly sampled recording \[s\].
fn sampling(recording: &Recording) -> Result<(f64, f64)> {
    match recording.time[..] {
        [first, second, ..] => Ok((first, second - first)),
        _ => Err(Error::file(format!("{}: fewer than two samples", recording.source))),
    }
}

/// Data for the script, which finds it by its class.
fn data(class: &str, value: &Value) -> String {
    // no markup, whatever a text has in it
    format!(
        "<script type=\"application/json\" class=\"{class}\">{}</script>\n",
        value.to_string().replace('<', "\\u003c")
    )
}

/// What the script shows of a run, rounded to what can be seen.
fn run_data(run: &StopRun, film: &Film) -> Result<Value> {
    let mut data = serde_json::Map::new();
    for (key, name, unit, decimals) in [
        ("v", "corner.vehicle_speed", "km/h", 1),
        ("slip", "corner.slip", "%", 1),
        ("pressure", "brake.pressure", "bar", 1),
        ("fx", "corner.force_x", "N", 0),
        ("fz", "corner.force_z", "N", 0),
        ("s", "corner.vehicle_distance", "m", 3),
        ("angle", "corner.wheel_angle", "rad", 3),
        ("wheelHeight", "corner.wheel_height", "m", 4),
        ("bodyHeight", "corner.body_height", "m", 4),
        ("foreAft", "corner.wheel_fore_aft", "m", 4),
        ("road", "corner.road_elevation", "m", 4),
    ] {
        data.insert(key.into(), rounded(&run.recording.channel_in(name, unit)?, decimals));
    }
    data.insert("w".into(), rounded(&rolling(run)?, 1));
    data.insert("frames".into(), run.frames.iter().map(|f| film.encode(f)).collect());
    Ok(Value::Object(data))
}

fn rounded(values: &[f64], decimals: i32) -> Value {
    let scale = 10_f64.powi(decimals);
    values
        .iter()
        .map(|v| {
            let number = (v * scale).round() / scale;
            // whole numbers without ".0"
            if number.fract() == 0.0 && number.abs() < 1e15 { json!(number as i64) } else { json!(number) }
        })
        .collect()
}

/// Speed of the freely rolling wheel that spins like this one \[km/h\].
fn rolling(run: &StopRun) -> Result<Vec<f64>> {
    let spin = run.recording.channel_in("corner.wheel_speed", "rad/s")?;
    Ok(spin.iter().map(|w| 3.6 * w * run.rolling_radius).collect())
}

fn plots(scene: &StopScene) -> Result<Vec<Plot>> {
    let mut plots = vec![Plot::new("Speed", Axis::time(), Axis::new("speed", "km/h"))];
    for run in &scene.runs {
        let (time, speed) = (&run.recording.time, run.recording.channel_in("corner.vehicle_speed", "km/h")?);
        // the vehicle's line, dashed, belongs to its wheel's
        plots[0] = plots[0].clone().line(&format!("wheel {}", run.name), time, &rolling(run)?).measured(
            &format!("vehicle {}", run.name),
            time,
            &speed,
        );
    }
    for (title, name, unit) in [
        ("Slip", "corner.slip", "%"),
        ("Pressure in the wheel's line", "brake.pressure", "bar"),
        ("Brake torque", "corner.brake_torque_actual", "N.m"),
        ("Longitudinal force Fx on the rim", "corner.force_x", "N"),
        ("Vertical force Fz on the rim", "corner.force_z", "N"),
    ] {
        let quantity = match unit {
            "%" => "slip",
            "bar" => "pressure",
            "N" => "force",
            _ => "torque",
        };
        let mut plot = Plot::new(title, Axis::time(), Axis::new(quantity, unit));
        for run in &scene.runs {
            plot = plot.line(&run.name, &run.recording.time, &run.recording.channel_in(name, unit)?);
        }
        if let (true, Some(longest)) = (
            unit == "bar",
            scene.runs.iter().max_by(|a, b| a.recording.time.len().cmp(&b.recording.time.len())),
        ) {
            let driver = longest.recording.channel_in("brake.driver_pressure", unit)?;
            plot = plot.measured("driver", &longest.recording.time, &driver);
        }
        plots.push(plot);
    }
    Ok(plots.into_iter().map(|plot| plot.size(Size::Half)).collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use latsch::tire::Cell;

    const ATTACK: &str = "<script>'\"";

    fn run(figures: StopFigures, recording: &Recording) -> StopRun {
        let cells = vec![Cell { length: 0.01, width: 0.04, pressure: 1e5, ..Cell::default() }];
        let frame = PatchFrame { cells, ..PatchFrame::default() };
        StopRun {
            name: ATTACK.into(),
            recording: recording.clone(),
            frames: vec![frame; recording.time.len()],
            figures,
            radius: 0.33,
            rolling_radius: 0.32,
            height: 0.31,
        }
    }

    #[test]
    fn the_page_is_whole_needs_nothing_else_and_text_stays_text() {
        let mut recording = figures::tests::stop();
        for (name, unit) in [
            ("corner.wheel_speed", "rad/s"),
            ("brake.pressure", "bar"),
            ("corner.brake_torque_actual", "N.m"),
            ("corner.force_x", "N"),
            ("corner.force_z", "N"),
            ("corner.wheel_angle", "rad"),
            ("corner.wheel_height", "m"),
            ("corner.body_height", "m"),
            ("corner.wheel_fore_aft", "m"),
            ("corner.road_elevation", "m"),
        ] {
            recording.channels.push(latsch::recording::Channel {
                name: name.into(),
                unit: unit.into(),
                values: recording.time.clone(),
            });
        }
        let figures = StopFigures::of(&recording).unwrap();
        let scene = StopScene {
            id: ATTACK.into(),
            title: ATTACK.into(),
            text: ATTACK.into(),
            road: vec![[0.0, 0.0], [100.0, 0.0]],
            runs: [run(figures, &recording), run(figures, &recording)],
        };
        let html = stop_page(ATTACK, ATTACK, &[scene], Section::new("about")).unwrap();
        // the data of the scene and the film, and the script
        assert_eq!(html.matches("<script").count(), 3);
        let rest = html.replace("xmlns=\"http://www.w3.org/2000/svg\"", "");
        for outside in ["http:", "https:", "url(", "@import", "src=", "href=\"h"] {
            assert!(!rest.contains(outside), "{outside}");
        }
        assert!(html.contains(&format!("<td class=\"number\">{:.2}</td>", figures.distance)));
        // two pictures for each run, six plots
        assert_eq!(html.matches("<svg").count(), 2 * 2 + 6);
        recording.channels.pop();
        assert!(run_data(&run(figures, &recording), &Film::new(&[])).is_err());
    }
}
