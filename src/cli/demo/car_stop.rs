//! The example of a whole car that stops, with and without its controller, on a level road and on slabs: forces in links, and all four contact patches.

use super::abs_stop::{every, until};
use super::stop::{Film, Readout, Scene, Stage, Way, player};
use super::twin::Replay;
use latsch::cosimulate::{Assignment, Plan, cosimulate, parse_toml};
use latsch::model::{Settings, Value};
use latsch::recording::{Recording, write_csv};
use latsch::report::{Axis, Html, Page, PatchFrame, Plot, Section, Size, Table, write_html};
use latsch::rig::Vehicle;
use latsch::stats::extent;
use latsch::tire::ring_brush::RingBrush;
use latsch::{Result, write_file};
use std::path::Path;

const SYSTEM: &str = include_str!("../../../examples/car-abs-stop/system.toml");
/// The driver's pressure. On slabs the car has to start on level road, and brakes later than in the example.
const DRIVER: &str = "time [s],driver_pressure [bar]\n0,0\n0.7,0\n0.85,150\n20,150\n";
/// Every run ends by then \[s\].
const STOP: f64 = 5.0;
/// Every how many communication points are recorded.
const EVERY: usize = 5;
/// Wheels, in the order of the model, and where their patches are in the picture.
const WHEELS: [(&str, &str, [f64; 2]); 4] = [
    ("front_left", "front left", [0.5, 0.5]),
    ("front_right", "front right", [0.5, -0.5]),
    ("rear_left", "rear left", [-0.5, 0.5]),
    ("rear_right", "rear right", [-0.5, -0.5]),
];
/// Distance of the patches in the picture, along and across \[m\]: just apart.
const APART: [f64; 2] = [0.24, 0.32];
/// A name stands so far below the middle of its patch \[m\].
const NAME_BELOW: f64 = 0.148;
/// Forces of links are read from the driver's first pressure to this speed \[m/s\], before the car rocks as it stands.
const SLOW: f64 = 1.0;
/// Forces that are shown: channel, title.
const FORCES: [(&str, &str); 4] = [
    ("car.front_left.longitudinal_link_force", "Longitudinal link, front left"),
    ("car.front_left.tie_rod_force", "Tie rod, front left"),
    ("car.front_left.transverse_link_force", "Transverse link, front left"),
    ("car.front_left.strut_force", "Strut, front left"),
];

struct Road {
    id: &'static str,
    title: &'static str,
    text: &'static str,
    /// Parameters of the car.
    values: &'static [(&'static str, f64)],
}

const ROADS: [Road; 2] = [
    Road {
        id: "slabs",
        title: "On slabs",
        text: "Slabs of 15 m that rise by 50 mm and end in a vertical drop. The car begins to brake 1.1 m before the first drop; length and height are placeholders, because the source does not print them.",
        // 80 km/h for 0.7 s, and 1.1 m, less a slab
        values: &[("road_kind", 7.0), ("road_start", 1.66), ("road_length", 15.0), ("road_height", 0.05)],
    },
    Road {
        id: "level",
        title: "On level road",
        text: "A flat road, friction as the tire has it.",
        values: &[],
    },
];

/// One run.
struct Run {
    name: &'static str,
    recording: Recording,
    frames: Vec<PatchFrame>,
    way: Way,
}

/// Runs everything and writes systems, results and the page into an existing folder.
pub fn run(folder: &Path) -> Result<()> {
    write_file(&folder.join("driver.csv"), DRIVER.as_bytes())?;
    let mut all = Vec::new();
    for road in &ROADS {
        all.push((road, [road.run(true, folder)?, road.run(false, folder)?]));
    }
    let frames: Vec<&PatchFrame> =
        all.iter().flat_map(|(_, runs)| runs).flat_map(|run| &run.frames).collect();
    let names = WHEELS
        .iter()
        .map(|(_, name, at)| ((*name).to_owned(), [at[0] * APART[0], at[1] * APART[1] - NAME_BELOW]));
    let film = Film::new(&frames, names.collect());
    let mut page = Page::new(
        "A car's stop",
        "A car brakes from 80 km/h, with ABS and without: forces in the links of its suspension, and the bristles in all four contact patches.",
    )
    .section(summary(&all)?);
    for (road, runs) in all {
        page = page.section(road.scene(runs)?.section(&film));
    }
    write_html(&folder.join("index.html"), &page.section(about().with(player(&film))).html())
}

fn about() -> Section {
    let mut section = Section::new("What this is");
    for text in [
        "The system is that of the documentation (examples/car-abs-stop): a car with a body that moves in six directions, McPherson suspension and rack in \
         front, five links behind, four brakes and a controller with four channels of which those behind have one pressure. After Mack (TU München, 2009) \
         and Kaden (2015); the first prints no data, so all sizes of car, brakes and controller are placeholders. It is no product's ABS.",
        "Tires are a passenger car's, 205/60 R15, identified from published curves. Their sliding friction falls with the speed, which the tire's source does not have: \
         it is divided by 1 + v · friction_speed_falloff.",
        "Without ABS the same pressure goes to the same brakes, whose inlet valves stay open. Forces of links and tie rods are positive where they pull, those of struts where they push.",
        "The patches come from the same car in this program, driven along the recorded brake torques; it has to end at the same place, to the last bit. \
         They are drawn closer to each other than they are.",
        "Each run can be repeated: latsch cosimulate SYSTEM --output RESULTS, with the systems in this folder.",
    ] {
        section = section.with(Html::text(text));
    }
    section
}

fn summary(all: &[(&Road, [Run; 2])]) -> Result<Section> {
    let mut heads = vec!["", "distance [m]", "mean deceleration [m/s²]"];
    heads.extend(["longitudinal link [kN]", "tie rod [kN]", "transverse link [kN]", "strut [kN]"]);
    let mut table = Table::new(&heads);
    for (road, runs) in all {
        for run in runs {
            let mut cells = vec![
                format!("{}, {}", road.title, run.name),
                format!("{:.2}", run.way.distance),
                format!("{:.2}", run.way.deceleration),
            ];
            let speed = run.recording.channel_in("car.vehicle_speed", "m/s")?;
            let braking = run.way.samples[0]..speed.iter().position(|v| *v < SLOW).unwrap_or(speed.len());
            for (name, _) in FORCES {
                let force = run.recording.channel_in(name, "kN")?;
                let (low, high) = extent(force[braking.clone()].iter().copied());
                cells.push(format!("{low:.2} to {high:.2}").replace('-', "−"));
            }
            table = table.row(cells);
        }
    }
    Ok(Section::new("Forces in the links of the left front wheel")
        .with(Html::raw(format!("<div class=\"numbers\">\n{}</div>\n", table.html().as_str())))
        .with(Html::note(
            "Least and greatest force from the driver's first pressure to 1 m/s. Distance: to standstill, the first sample below 0.1 m/s; deceleration: speed \
             squared over twice the distance.",
        )))
}

impl Road {
    /// The example on this road, with or without its controller.
    fn plan(&self, abs: bool, folder: &Path) -> Result<Plan> {
        let mut plan = parse_toml(SYSTEM, "system.toml", folder)?;
        plan.stop = Some(STOP);
        if !abs {
            plan.remove("abs");
        }
        let tire = super::tire()?;
        let mut values: Vec<(String, Value)> = Vec::new();
        for axle in ["front_tire", "rear_tire"] {
            values.extend(tire.values.iter().map(|s| (format!("{axle}.{}", s.name), s.value.clone())));
        }
        for (variable, value) in self.values {
            let is_kind = *variable == "road_kind";
            let value = if is_kind { Value::Integer(*value as i32) } else { Value::Real(*value) };
            values.push(((*variable).to_owned(), value));
        }
        let radius = Value::Real(super::rolling_radius(&tire)?);
        let radii = (1..=WHEELS.len()).map(|k| (format!("rolling_radius_{k}"), radius.clone())).collect();
        for (part, values) in [("car", values), ("abs", radii)] {
            let Some(component) = plan.components.iter_mut().find(|c| c.name == part) else { continue };
            component.set.retain(|own| values.iter().all(|(variable, _)| *variable != own.variable));
            component.set.extend(values.into_iter().map(|(variable, value)| Assignment {
                variable,
                value,
                place: "the demo".into(),
            }));
        }
        Ok(plan)
    }

    fn run(&self, abs: bool, folder: &Path) -> Result<Run> {
        let name = format!("{}-{}", self.id, if abs { "abs" } else { "no-abs" });
        let plan = self.plan(abs, folder)?;
        let local = |path: &Path| path.file_name().unwrap_or_default().to_string_lossy().into_owned();
        write_file(&folder.join(format!("{name}.toml")), plan.to_toml(&local).as_bytes())?;
        let mut system = plan.load()?;
        let experiment = plan.experiment(&system, None, None, None)?;
        let mut outcome = cosimulate(&mut system, &experiment, |_| {})?;
        if let Some(error) = outcome.stopped {
            return Err(error.at(&name));
        }
        outcome.recording.source.clone_from(&name);
        let inputs = WHEELS.map(|(wheel, ..)| (format!("{wheel}.brake_torque"), "N.m"));
        let replay = Replay {
            plan: &plan,
            part: "car",
            made_with: &Settings::default(),
            inputs: &inputs,
            step: experiment.step,
        };
        let mut frames = Vec::new();
        replay.run(&outcome.recording, |k, car: &Vehicle<RingBrush>| {
            if k % EVERY == 0 {
                frames.push(patches(car, outcome.recording.time[k]));
            }
        })?;
        let mut recording = every(&outcome.recording, EVERY);
        write_csv(&folder.join(format!("{name}.csv")), &recording)?;
        let way =
            Way::of(&recording, ["brake_fl.driver_pressure", "car.vehicle_speed", "car.vehicle_distance"])?;
        let shown = until(&mut recording, way.end);
        frames.truncate(shown);
        Ok(Run { name: if abs { "with ABS" } else { "without ABS" }, recording, frames, way })
    }

    fn scene(&self, runs: [Run; 2]) -> Result<Scene> {
        let mut plots = Vec::new();
        let forces = FORCES.iter().map(|(channel, title)| (*channel, *title, "force", "kN"));
        let others = [
            ("car.vehicle_speed", "Speed of the car", "speed", "km/h"),
            ("car.front_left.slip", "Slip, front left", "slip", "%"),
            ("car.front_left.brake_torque", "Brake torque, front left", "torque", "N.m"),
            ("car.front_left.force_z", "Vertical force on the rim, front left", "force", "kN"),
        ];
        for (channel, title, quantity, unit) in forces.chain(others) {
            let mut plot = Plot::new(title, Axis::time(), Axis::new(quantity, unit));
            for run in &runs {
                plot = plot.line(run.name, &run.recording.time, &run.recording.channel_in(channel, unit)?);
            }
            plots.push(plot);
        }
        let courses = [
            ("v", "car.vehicle_speed", "km/h", 1),
            ("slip", "car.front_left.slip", "%", 1),
            ("longitudinal", "car.front_left.longitudinal_link_force", "kN", 2),
            ("tie_rod", "car.front_left.tie_rod_force", "kN", 2),
        ];
        let readout = |label, key, digits, unit| Readout { label, key, digits, unit };
        let first = runs[0].way.start + 0.3;
        let stages = runs.into_iter().map(|run| {
            let outcome = format!("{:.1} m", run.way.distance);
            Stage::of((run.name, &outcome), &run.recording, run.frames, &courses)
        });
        Ok(Scene {
            id: self.id.into(),
            title: self.title.into(),
            text: self.text.into(),
            first,
            side: None,
            readouts: vec![
                readout("", "v", 1, "km/h"),
                readout("slip front left", "slip", 1, "%"),
                readout("longitudinal link", "longitudinal", 2, "kN"),
                readout("tie rod", "tie_rod", 2, "kN"),
            ],
            runs: stages.collect::<Result<_>>()?,
            plots: plots.into_iter().map(|plot| plot.size(Size::Half)).collect(),
            note: "The patches of the four wheels, drawn closer to each other than they are.".into(),
        })
    }
}

/// All four patches in one frame.
fn patches(car: &Vehicle<RingBrush>, time: f64) -> PatchFrame {
    let mut all = PatchFrame { time, ..PatchFrame::default() };
    for (mounted, (.., at)) in car.mounted().iter().zip(WHEELS) {
        let mut own = PatchFrame::of(&mounted.tire, time, "");
        for cell in &mut own.cells {
            cell.x += at[0] * APART[0];
            cell.y += at[1] * APART[1];
        }
        all.cells.append(&mut own.cells);
    }
    all
}
