//! The page of braking runs: the same stop on several roads with two systems each, the contact patches
//! moving beside each other.

mod figures;
mod film;
mod scene;

pub use figures::{StopFigures, Way};
pub use film::Film;
pub use scene::{Readout, Scene, Stage, player};

use self::scene::COLORS;
use latsch::Result;
use latsch::recording::Recording;
use latsch::report::{Axis, Html, Page, PatchFrame, Plot, Section, Size, Table, escape};
use latsch::stats::extent;
use serde_json::{Value, json};
use std::fmt::Write;

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
    let film = Film::new(&frames, Vec::new());
    let mut page = Page::new(title, lead).section(summary(scenes));
    for scene in scenes {
        page = page.section(shown(scene)?.section(&film));
    }
    let page = page.section(about.with(player(&film)));
    Ok(page.html())
}

/// Distances as bars, and the other numbers.
fn summary(scenes: &[StopScene]) -> Section {
    let longest =
        scenes.iter().flat_map(|s| &s.runs).map(|r| r.figures.way.distance).fold(f64::MIN_POSITIVE, f64::max);
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
                80.0 * f.way.distance / longest,
                f.way.distance
            );
            table = table.row([
                format!("{}, {}", scene.title, run.name),
                format!("{:.2}", f.way.distance),
                format!("{:.2}", f.way.duration()),
                format!("{:.2}", f.way.deceleration),
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
    let difference =
        |s: &StopScene| 100.0 * (s.runs[0].figures.way.distance / s.runs[1].figures.way.distance - 1.0);
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

fn shown(scene: &StopScene) -> Result<Scene> {
    let courses = [
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
    ];
    let mut runs = Vec::new();
    for run in &scene.runs {
        let outcome = format!("{:.1} m", run.figures.way.distance);
        let mut stage = Stage::of((&run.name, &outcome), &run.recording, run.frames.clone(), &courses)?;
        stage.series.insert("w".into(), rounded(&rolling(run)?, 1));
        runs.push(stage);
    }
    let readout = |label, key, digits, unit| Readout { label, key, digits, unit };
    let [run, _] = &scene.runs;
    Ok(Scene {
        id: scene.id.clone(),
        title: scene.title.clone(),
        text: scene.text.clone(),
        first: run.figures.way.start + 0.4,
        side: Some(json!({
            "road": scene.road,
            "radius": run.radius,
            "height": run.height,
            "exaggeration": EXAGGERATION,
        })),
        readouts: vec![
            readout("", "v", 1, "km/h"),
            readout("wheel", "w", 1, "km/h"),
            readout("slip", "slip", 1, "%"),
            readout("line", "pressure", 0, "bar"),
            readout("Fx", "fx", 0, "N"),
        ],
        runs,
        plots: plots(scene)?,
        note: format!(
            "Side view: wheel and spin angle to scale; heights of wheel, body and road and the wheel's give along the road are {EXAGGERATION} \
             times as large; orange: forces of the road on the wheel."
        ),
    })
}

/// Values as the page has them, rounded to what can be seen.
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
        let mut scene = StopScene {
            id: ATTACK.into(),
            title: ATTACK.into(),
            text: ATTACK.into(),
            road: vec![[0.0, 0.0], [100.0, 0.0]],
            runs: [run(figures, &recording), run(figures, &recording)],
        };
        let html = stop_page(ATTACK, ATTACK, std::slice::from_ref(&scene), Section::new("about")).unwrap();
        // the data of the scene and the film, the script, and that of figures
        assert_eq!(html.matches("<script").count(), 4);
        let rest = html.replace("xmlns=\"http://www.w3.org/2000/svg\"", "");
        for outside in ["http:", "https:", "url(", "@import", "src=", "href=\"h"] {
            assert!(!rest.contains(outside), "{outside}");
        }
        assert!(html.contains(&format!("<td class=\"number\">{:.2}</td>", figures.way.distance)));
        // two pictures for each run, six plots
        assert_eq!(html.matches("<svg").count(), 2 * 2 + 6);
        recording.channels.pop();
        scene.runs[0].recording = recording;
        assert!(shown(&scene).is_err());
    }
}
