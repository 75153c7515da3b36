//! The same braking with and without ABS on several roads: three FMUs wired to each other.

use super::stop::{StopFigures, StopRun, StopScene, stop_page};
use super::twin::Replay;
use latsch::control::{AbsController, BrakeHydraulics};
use latsch::cosimulate::{Experiment, cosimulate, energy_warnings, parse_toml};
use latsch::fmi::archive::ModelLibrary;
use latsch::model::{Model, Settings};
use latsch::recording::{Channel, Recording, write_csv};
use latsch::report::{Html, PatchFrame, Section, Table, write_html};
use latsch::rig::RingBrushCorner;
use latsch::{Result, write_file};
use std::fmt::Write as _;
use std::path::Path;

/// Every how many communication points are recorded.
const EVERY: usize = 5;
/// A point of the road's profile at every such distance \[m\].
const ROAD_STEP: f64 = 0.01;

/// A road, and how long a stop on it may take.
struct Scenario {
    id: &'static str,
    title: &'static str,
    text: &'static str,
    /// Time \[s\] and friction factor: constant up to the next.
    friction: &'static [(f64, f64)],
    /// Parameters of the corner, as in TOML.
    road: &'static str,
    /// When the run ends \[s\].
    stop: f64,
}

const SCENARIOS: [Scenario; 4] = [
    Scenario {
        id: "dry",
        title: "Dry",
        text: "A flat road, friction as the tire has it.",
        friction: &[(0.0, 1.0)],
        road: "",
        stop: 5.0,
    },
    Scenario {
        id: "wet",
        title: "Wet",
        text: "A flat road with a friction factor of 0.5: half of the tire's friction on a dry road. A film of water is not modelled.",
        friction: &[(0.0, 0.5)],
        road: "",
        stop: 9.2,
    },
    Scenario {
        id: "split",
        title: "Split in time",
        text: "A flat road whose friction factor falls from 1 to 0.3 at 1.2 s and is 1 again from 2.4 s on, under all of the wheel at once.",
        friction: &[(0.0, 1.0), (1.2, 0.3), (2.4, 1.0)],
        road: "",
        stop: 6.0,
    },
    Scenario {
        id: "slabs",
        title: "Over ramps",
        text: "Even slabs of 15 m that rise by 50 mm and end in a vertical drop, where the wheel leaves the ground for a moment (Mack 2009, figure 6.33; the height is a placeholder, because the source does not give it).",
        friction: &[(0.0, 1.0)],
        road: ", road_kind = \"slabs\", road_start = 5.0, road_length = 15.0, road_height = \"50 mm\"",
        stop: 5.0,
    },
];

/// Runs everything and writes FMUs, systems, results and the page into existing folders.
pub fn run(folder: &Path, library: &ModelLibrary) -> Result<()> {
    let tire = super::tire()?;
    let none = Settings::default();
    for (model, settings) in
        [(RingBrushCorner::NAME, &tire), (BrakeHydraulics::NAME, &none), (AbsController::NAME, &none)]
    {
        write_file(&folder.join(format!("{model}.fmu")), &library.fmu(model, settings, &[])?)?;
    }
    write_file(&folder.join("abs-stop.toml"), SCENARIOS[0].system(true, "", "runs/", &tire)?.as_bytes())?;
    let mut scenes = Vec::new();
    for scenario in &SCENARIOS {
        let inputs = folder.join("runs").join(format!("{}-inputs.csv", scenario.id));
        write_file(&inputs, scenario.inputs().as_bytes())?;
        let (with, road) = scenario.run(true, folder, &tire)?;
        let (without, _) = scenario.run(false, folder, &tire)?;
        scenes.push(StopScene {
            id: scenario.id.into(),
            title: scenario.title.into(),
            text: scenario.text.into(),
            road,
            runs: [with, without],
        });
    }
    let lead = format!(
        "A quarter of a vehicle brakes from {:.0} km/h, with ABS and without: a tire of a rigid belt and single bristles, \
         brake hydraulics and a controller, three FMUs stepped together.",
        3.6 * scenes[0].runs[0].recording.channel_in("corner.vehicle_speed", "m/s")?[0]
    );
    let page = stop_page("An ABS stop, down to the bristle", &lead, &scenes, about(&scenes))?;
    write_html(&folder.join("index.html"), &page)
}

fn about(scenes: &[StopScene]) -> Section {
    let mut files = Table::new(&["run", "system", "results"]);
    for scene in scenes {
        for (run, variant) in scene.runs.iter().zip(["abs", "no-abs"]) {
            let name = format!("runs/{}-{variant}", scene.id);
            files = files.row([
                format!("{}, {}", scene.title, run.name),
                format!("{name}.toml"),
                format!("{name}.csv"),
            ]);
        }
    }
    let mut section = Section::new("What this is");
    for text in [
        "Corner (ring-brush-corner): sprung mass, suspension and wheel of a quarter vehicle that travels straight, on the ring-and-brush \
         tire of Kaden (TU München, 2015) with parameters of a passenger car's tire, 205/60 R15; no load transfer, no aerodynamics. The friction factor \
         scales the tire's dry friction, static and sliding alike. Masses and suspension are of sports-car size and placeholders.",
        "The source's friction does not depend on the sliding speed: with it a locked wheel brakes as hard as a controlled one or harder. \
         Here the sliding friction is divided by 1 + v · friction_speed_falloff, which is identified from the braking force of a locked wheel at 60 km/h in \
         the published curves: how much shorter the stops with ABS are follows from it. Set it to 0 in a run's file to see the source's friction.",
        "Brake (brake-hydraulics): valves, line, lag of the caliper, pads whose friction builds up after first contact (Mack 2009, \
         6.32 to 6.34). Controller (abs-controller): a rule-based stand-in that knows wheel speed and driver's pressure only. The sources \
         give neither sizes, rates nor thresholds: all parameters of brake and controller are placeholders. It is no product's ABS.",
        "Without ABS the same driver's pressure goes to the same brake, whose inlet valve stays open. The driver presses 150 bar within 0.15 s. \
         The master exchanges values every 1 ms, controller first, then brake, then corner; each holds its inputs in between. \
         The pictures of the patch come from the same tire model in this program, driven along the recorded brake torque; \
         it has to end at the same place, to the last bit.",
    ] {
        section = section.with(Html::text(text));
    }
    section
        .with(Html::text("Each run can be repeated: latsch cosimulate SYSTEM --output RESULTS."))
        .with(files.html())
}

impl Scenario {
    /// What drives the runs: CSV.
    fn inputs(&self) -> String {
        const BRAKING: [(f64, f64); 2] = [(0.5, 0.0), (0.65, 150.0)];
        /// A step of the friction takes less than a communication step.
        const EDGE: f64 = 1e-6;
        let driver = |t: f64| {
            let [(from, low), (to, high)] = BRAKING;
            low + (high - low) * ((t - from) / (to - from)).clamp(0.0, 1.0)
        };
        let mut times: Vec<f64> = BRAKING.iter().map(|b| b.0).chain([0.0, self.stop]).collect();
        times.extend(self.friction.iter().skip(1).flat_map(|(t, _)| [t - EDGE, *t]));
        times.sort_by(f64::total_cmp);
        let mut csv = String::from("time [s],driver_pressure [bar],friction_factor [1]\n");
        for t in times {
            let factor = self.friction.iter().rev().find(|(from, _)| *from <= t).map_or(1.0, |f| f.1);
            let _ = writeln!(csv, "{t},{},{factor}", driver(t));
        }
        csv
    }

    /// The system as TOML, for FMUs in `fmus` and inputs in `inputs`.
    fn system(&self, abs: bool, fmus: &str, inputs: &str, tire: &Settings) -> Result<String> {
        let Self { id, title, road, stop, .. } = self;
        let (order, controller, wires, driver) = if abs {
            (
                "\"abs\", \"brake\", \"corner\"",
                format!(
                    "\n# The controller of one wheel; it has to know the tire's rolling radius.\n[component.abs]\nfmu = \"{fmus}abs-controller.fmu\"\n\
                     set = {{ wheels = 1, rolling_radius_1 = {} }}\n",
                    super::rolling_radius(tire)?
                ),
                "\"corner.wheel_speed\" = \"abs.wheel_speed_1\"\n\"abs.inlet_valve_1\" = \"brake.inlet_valve\"\n\"abs.outlet_valve_1\" = \"brake.outlet_valve\"\n",
                "[\"brake.driver_pressure\", \"abs.driver_pressure\"]",
            )
        } else {
            ("\"brake\", \"corner\"", String::new(), "", "\"brake.driver_pressure\"")
        };
        let variant = if abs { "with ABS" } else { "without ABS" };
        Ok(format!(
            "# {title}, {variant}: a quarter vehicle brakes from 100 km/h.
# latsch cosimulate THIS_FILE --output results.csv --report report.html
stop = {stop:?}
# Values are exchanged every millisecond, and every fifth is recorded.
step = 1e-3
record_every = {EVERY}
# One after the other, each with what those before it have at the end of the interval.
order = [{order}]

# Body, suspension, wheel, tire and road.
[component.corner]
fmu = \"{fmus}ring-brush-corner.fmu\"
set = {{ initial_speed = \"100 km/h\"{road} }}

# Valves, line and pads.
[component.brake]
fmu = \"{fmus}brake-hydraulics.fmu\"
{controller}
[connect]
{wires}\"brake.brake_torque\" = \"corner.brake_torque\"

# What the driver does, and the road's friction over time.
[[inputs]]
file = \"{inputs}{id}-inputs.csv\"
connect = {{ driver_pressure = {driver}, friction_factor = \"corner.friction_factor\" }}
"
        ))
    }

    /// Runs the system and writes it and its results; gives the road, too.
    fn run(&self, abs: bool, folder: &Path, tire: &Settings) -> Result<(StopRun, Vec<[f64; 2]>)> {
        let folder = folder.join("runs");
        let name = format!("{}-{}", self.id, if abs { "abs" } else { "no-abs" });
        let file = folder.join(format!("{name}.toml"));
        let text = self.system(abs, "../", "", tire)?;
        write_file(&file, text.as_bytes())?;
        let plan = parse_toml(&text, &file.display().to_string(), &folder)?;
        let mut system = plan.load()?;
        let experiment = Experiment { record_every: 1, ..plan.experiment(&system, None, None, None)? };
        let outcome = cosimulate(&mut system, &experiment, |_| {})?;
        for warning in system.warnings().iter().chain(&energy_warnings(&system, experiment.step)) {
            crate::cli::warn(&format!("{}: {warning}", file.display()));
        }
        if let Some(error) = outcome.stopped {
            return Err(error.at(file.display()));
        }
        let inputs = [("brake_torque".into(), "N.m"), ("friction_factor".into(), "1")];
        let replay =
            Replay { plan: &plan, part: "corner", made_with: tire, inputs: &inputs, step: experiment.step };
        let mut frames = Vec::new();
        let twin = replay.run(&outcome.recording, |k, corner: &RingBrushCorner| {
            if k % EVERY == 0 {
                frames.push(PatchFrame::of(&corner.mounted().tire, outcome.recording.time[k], ""));
            }
        })?;
        let mut recording = every(&outcome.recording, EVERY);
        recording.source = name.clone();
        write_csv(&folder.join(format!("{name}.csv")), &recording)?;
        let figures = StopFigures::of(&recording)?;
        // afterwards it rocks on its tire, with a slip to and fro
        let shown = until(&mut recording, figures.way.end);
        frames.truncate(shown);
        let model = twin.model();
        let parameters = &model.mounted().tire.parameters;
        let run = StopRun {
            name: if abs { "with ABS" } else { "without ABS" }.into(),
            recording,
            frames,
            figures,
            radius: parameters.radius,
            rolling_radius: parameters.rolling_radius,
            height: model.static_height(),
        };
        Ok((run, profile(model, figures.way.distance + 40.0)))
    }
}

/// Ends a recording at a time; how many samples are left.
pub fn until(recording: &mut Recording, end: f64) -> usize {
    let shown = recording.time.iter().filter(|t| **t <= end).count();
    recording.time.truncate(shown);
    recording.channels.iter_mut().for_each(|channel| channel.values.truncate(shown));
    shown
}

/// Every nth sample of a recording.
pub fn every(recording: &Recording, n: usize) -> Recording {
    let thin = |values: &[f64]| values.iter().step_by(n).copied().collect();
    Recording {
        time: thin(&recording.time),
        channels: recording
            .channels
            .iter()
            .map(|c| Channel { name: c.name.clone(), unit: c.unit.clone(), values: thin(&c.values) })
            .collect(),
        source: recording.source.clone(),
    }
}

/// The corners of the road from a little before the start on.
fn profile(corner: &RingBrushCorner, end: f64) -> Vec<[f64; 2]> {
    let steps = ((end + 3.0) / ROAD_STEP) as usize;
    let points: Vec<[f64; 2]> = (0..=steps)
        .map(|i| {
            let x = -3.0 + i as f64 * ROAD_STEP;
            [x, corner.road().at(x, 0.0).height]
        })
        .collect();
    let mut corners: Vec<[f64; 2]> = Vec::new();
    for (i, point) in points.iter().enumerate() {
        let is_straight = i > 0
            && i < steps
            && ((points[i + 1][1] - point[1]) - (point[1] - points[i - 1][1])).abs() < 1e-9;
        if !is_straight {
            corners.push(point.map(|v| (v * 1e5).round() / 1e5));
        }
    }
    corners
}
