//! Recordings of a measurement programme: a tire of the flat track with parameters of its own, on a rig that holds the load itself
//! and whose sensors are off.
//!
//! Elastic parameters lie within [`NEAR`] of those of the model; friction anywhere where it falls with the pressure, and rises as a
//! force with it, up to the highest pressure. Forces have white noise of 1 % of their range in the whole programme, a drift, a zero
//! that is off, a filter of 100 Hz, and 12 bit; angles are off by 0.05 degrees.

use super::{INPUTS, OUTPUTS, Tire};
use crate::random::Random;
use crate::simulate::Filter;
use latsch::Result;
use serde::Serialize;
use std::collections::BTreeMap;
use std::path::Path;

/// Elastic parameters, and what the model has.
const ELASTIC: [(&str, f64); 11] = [
    ("vertical_stiffness", 154e3),
    ("vertical_stiffness_quadratic", 2.47e6),
    ("sidewall_radial_stiffness", 4.67e6),
    ("cross_section_radius", 0.675),
    ("bristle_stiffness", 4e4),
    ("sidewall_tilt_stiffness", 8e4),
    ("stripe_length_factor", 0.75),
    ("patch_compliance_twist", 1e-4),
    ("patch_compliance_y", 8e-7),
    ("patch_compliance_x", 3e-6),
    ("sidewall_lateral_stiffness", 85e3),
];

/// How far a tire is from another one of its kind.
pub const NEAR: f64 = 0.3;

/// Pressure at which the friction parameters at reference pressure are meant, and the highest \[Pa\].
const PRESSURES: [f64; 2] = [2e5, 5.23e5];
/// Static friction at no pressure at most, and the least fall up to the highest pressure.
const MOST: f64 = 2.0;
const FALL: f64 = 0.1;

/// Times, and the values between which something runs straight.
type Course = (Vec<f64>, Vec<f64>);

/// Steps of the rig's control and of the tire \[s\]; samples are so many steps of the rig apart.
const STEPS: [f64; 2] = [1e-3, 2e-4];
const SAMPLE: usize = 5;
/// Time constant of the sensors \[s\]: 100 Hz.
const FILTER: f64 = 1.0 / (std::f64::consts::TAU * 100.0);
/// Speed of the deflection per missing load \[m/(N s)\].
const CONTROL: f64 = 1e-4;

/// White noise, drift, and zero of the forces, of their range.
const WHITE: f64 = 0.01;
const DRIFT: f64 = 0.003;
const ZERO: f64 = 0.01;
/// Time between two values between which the drift runs straight \[s\].
const DRIFTS: f64 = 15.0;
/// Steps of a converter of 12 bit.
const BITS: f64 = 4096.0;
/// Offset of angles \[rad\].
const ANGLE: f64 = 0.05 * std::f64::consts::PI / 180.0;

/// Values of parameters, by their names.
type Parameters = BTreeMap<&'static str, f64>;

/// What a rig recorded, and of what tire.
pub struct Session {
    /// Names and content of the files.
    pub files: Vec<(String, String)>,
    /// What is true.
    pub truth: Truth,
}

/// What is true of a recording session.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Truth {
    /// Parameters of the tire.
    pub parameters: Parameters,
    /// Offsets of channels.
    pub offsets: BTreeMap<&'static str, f64>,
}

/// A run of the programme, as its file has it.
struct Commands {
    name: String,
    time: Vec<f64>,
    /// In the order of [`INPUTS`]; without a load, it is the deflection that is commanded.
    values: Vec<Vec<f64>>,
    load: Option<Vec<f64>>,
}

/// A tire of number `number`, and what a rig records of it along a programme.
///
/// # Errors
/// A programme that cannot be read, or a tire that leaves what its equations are good for.
pub fn session(seed: u64, number: u64, programme: &Path) -> std::result::Result<Session, String> {
    let mut random = Random::new(seed, number);
    let parameters = parameters(&mut random);
    let mut files: Vec<_> = std::fs::read_dir(programme)
        .map_err(|e| format!("{}: {e}", programme.display()))?
        .filter_map(|entry| Some(entry.ok()?.path()))
        .filter(|file| file.extension().is_some_and(|e| e == "csv"))
        .collect();
    files.sort();
    let runs = files.iter().map(|file| read(file)).collect::<std::result::Result<Vec<_>, _>>()?;
    let drive =
        |run: &Commands| drive(&parameters, run).map_err(|e| format!("tire {number}, {}: {e}", run.name));
    let recorded = runs.iter().map(drive).collect::<std::result::Result<Vec<_>, _>>()?;
    Ok(sense(&parameters, &runs, &recorded, &mut random))
}

fn parameters(random: &mut Random) -> Parameters {
    let mut parameters: Parameters =
        ELASTIC.iter().map(|(name, value)| (*name, value * random.within(1.0 - NEAR, 1.0 + NEAR))).collect();
    let to_reference = PRESSURES[0] / PRESSURES[1];
    let sliding = random.within(0.9, 1.3);
    let sliding_falls = random.within(FALL, 0.5 * sliding);
    let sticking = random.within(sliding, MOST);
    let least = (sliding - sliding_falls).max(0.5 * (sticking + FALL));
    let sticking_falls = sticking - random.within(least, sticking - FALL);
    parameters.insert("friction_sliding_zero", sliding);
    parameters.insert("friction_sliding_reference", sliding - to_reference * sliding_falls);
    parameters.insert("friction_static_zero", sticking);
    parameters.insert("friction_static_reference", sticking - to_reference * sticking_falls);
    parameters
}

fn read(file: &Path) -> std::result::Result<Commands, String> {
    let text = |file: &Path| std::fs::read_to_string(file).map_err(|e| format!("{}: {e}", file.display()));
    let table = text(file)?;
    let mut lines = table.lines();
    let header = lines.next().unwrap_or_default();
    let names: Vec<&str> = header.split(',').map(|c| c.split(" [").next().unwrap_or_default()).collect();
    let mut columns = vec![Vec::new(); names.len()];
    for line in lines {
        for (column, cell) in columns.iter_mut().zip(line.split(',')) {
            column.push(cell.parse::<f64>().map_err(|e| format!("{}: {cell}: {e}", file.display()))?);
        }
    }
    let mut columns: BTreeMap<&str, Vec<f64>> = names.into_iter().zip(columns).collect();
    let time = columns.remove("time").unwrap_or_default();
    let switches = file.with_extension("toml");
    let holds_load = switches.exists() && text(&switches)?.contains("load_control = true");
    let load = columns.remove("load").filter(|_| holds_load);
    let mut take = |name: &str| columns.remove(name).unwrap_or_else(|| vec![0.0; time.len()]);
    let values = INPUTS.iter().map(|row| take(row.0)).collect();
    if let Some((other, _)) = columns.iter().find(|(_, values)| values.iter().any(|v| *v != 0.0)) {
        return Err(format!("{}: this rig has no {other}", file.display()));
    }
    let name = file.file_stem().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
    Ok(Commands { name, time, values, load })
}

/// What ideal sensors behind a filter record: inputs, then outputs.
fn drive(parameters: &Parameters, run: &Commands) -> Result<Vec<Vec<f64>>> {
    const DEFLECTION: usize = 1;
    let mut tire = new_tire(parameters)?;
    let at = |course: &[f64], time: f64| course_at(&run.time, course, time);
    let commands = |time: f64| -> Vec<f64> { run.values.iter().map(|c| at(c, time)).collect() };
    let mut from = commands(0.0);
    if let Some(load) = &run.load {
        from[DEFLECTION] = deflection_at(parameters, &from, load[0])?;
    }
    tire.start(&from, 1.0)?;
    let mut y = tire.measured()?;
    let (mut inputs, mut outputs) = (Filter::new(FILTER, &from), Filter::new(FILTER, &y));
    let mut recorded: Vec<Vec<f64>> = from.iter().chain(&y).map(|v| vec![*v]).collect();
    let steps = (run.time.last().copied().unwrap_or(0.0) / STEPS[0]).round();
    let (mut number, mut count) = (0.0, 0);
    while number < steps - 0.5 {
        let time = number * STEPS[0];
        let mut to = commands(time + STEPS[0]);
        if let Some(load) = &run.load {
            to[DEFLECTION] = from[DEFLECTION] + CONTROL * (at(load, time) - y[2]) * STEPS[0];
        }
        tire.step((&from, &to), 1.0, time, STEPS[0])?;
        from = to;
        y = tire.measured()?;
        inputs.follow(&from, STEPS[0]);
        outputs.follow(&y, STEPS[0]);
        number += 1.0;
        count += 1;
        if count % SAMPLE == 0 {
            for (list, value) in recorded.iter_mut().zip(inputs.state.iter().chain(&outputs.state)) {
                list.push(*value);
            }
        }
    }
    Ok(recorded)
}

fn new_tire(parameters: &Parameters) -> Result<Tire> {
    Tire::new(parameters.iter().map(|(name, value)| (*name, *value)), STEPS[1])
}

/// The deflection at which the tire starts with a load.
fn deflection_at(parameters: &Parameters, commands: &[f64], load: f64) -> Result<f64> {
    let (mut low, mut high) = (0.0, 0.1);
    for _ in 0..30 {
        let middle = 0.5 * (low + high);
        let mut commands = commands.to_vec();
        commands[1] = middle;
        let mut tire = new_tire(parameters)?;
        tire.start(&commands, 1.0)?;
        let force = tire.measured()?[2];
        if force < load { low = middle } else { high = middle }
    }
    Ok(0.5 * (low + high))
}

/// Straight between its points.
fn course_at(time: &[f64], values: &[f64], at: f64) -> f64 {
    let k = time.partition_point(|t| *t <= at).clamp(1, time.len() - 1);
    let share = ((at - time[k - 1]) / (time[k] - time[k - 1])).clamp(0.0, 1.0);
    values[k - 1] + share * (values[k] - values[k - 1])
}

fn sense(
    parameters: &Parameters,
    runs: &[Commands],
    recorded: &[Vec<Vec<f64>>],
    random: &mut Random,
) -> Session {
    let inputs = INPUTS.len();
    let rows: Vec<(&'static str, &str)> = INPUTS.iter().chain(&OUTPUTS).map(|row| (row.0, row.1)).collect();
    let ranges: Vec<f64> = (0..rows.len())
        .map(|c| {
            let values = || recorded.iter().flat_map(|run| &run[c]).copied();
            values().fold(f64::NEG_INFINITY, f64::max) - values().fold(f64::INFINITY, f64::min)
        })
        .collect();
    let mut offsets = BTreeMap::new();
    for (c, (name, unit)) in rows.iter().enumerate() {
        if c >= inputs {
            offsets.insert(*name, ZERO * ranges[c] * random.normal());
        } else if *unit == "rad" {
            offsets.insert(*name, ANGLE * random.sign());
        }
    }
    let mut files = Vec::new();
    for (run, channels) in runs.iter().zip(recorded) {
        let samples = channels[0].len();
        let time: Vec<f64> = (0..samples).map(|k| (k * SAMPLE) as f64 * STEPS[0]).collect();
        let mut columns = Vec::new();
        for (c, values) in channels.iter().enumerate() {
            let offset = offsets.get(rows[c].0).copied().unwrap_or(0.0);
            if c < inputs {
                columns.push(values.iter().map(|v| v + offset).collect::<Vec<f64>>());
                continue;
            }
            let course = drift(random, time[samples - 1]);
            let bit = ranges[c] / BITS;
            let sensed = values.iter().zip(&time).map(|(v, t)| {
                let error = WHITE * random.normal() + DRIFT * course_at(&course.0, &course.1, *t);
                ((v + offset + ranges[c] * error) / bit).round() * bit
            });
            columns.push(sensed.collect());
        }
        let names: Vec<String> = rows.iter().map(|(name, unit)| format!("{name} [{unit}]")).collect();
        let mut text = format!("time [s],{}\n", names.join(","));
        for (k, t) in time.iter().enumerate() {
            text += &format!("{t:.3}");
            columns.iter().for_each(|column| text += &format!(",{:.6e}", column[k]));
            text.push('\n');
        }
        files.push((format!("{}.csv", run.name), text));
    }
    Session { files, truth: Truth { parameters: parameters.clone(), offsets } }
}

/// A course of standard deviation 1 that runs straight between its points.
fn drift(random: &mut Random, duration: f64) -> Course {
    let count = (duration / DRIFTS).ceil().max(1.0);
    let mut course = (Vec::new(), Vec::new());
    let mut k = 0.0;
    while k < count + 0.5 {
        course.0.push(k / count * duration);
        course.1.push(random.normal());
        k += 1.0;
    }
    course
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn friction_falls_with_the_pressure_and_rises_as_a_force() {
        for seed in 0..300 {
            let drawn = parameters(&mut Random::new(seed, 1));
            for kind in ["sliding", "static"] {
                let [zero, at] = ["zero", "reference"]
                    .map(|pressure| drawn[format!("friction_{kind}_{pressure}").as_str()]);
                let at_highest = zero + (at - zero) * PRESSURES[1] / PRESSURES[0];
                assert!(at_highest <= zero - FALL + 1e-12 && zero <= MOST, "{drawn:?}");
                // mu p rises with p up to where mu has fallen by half
                assert!(2.0 * at_highest >= zero - 1e-12, "{drawn:?}");
            }
            assert!(drawn["friction_static_zero"] >= drawn["friction_sliding_zero"]);
        }
    }

    #[test]
    fn the_rig_holds_the_load_and_its_sensors_are_off() {
        let folder = tempfile::tempdir().unwrap();
        let run = "time [s],load [N],path_speed [m/s],slip_angle [rad]\n0,3000,10,0\n2,3000,10,0\n3,4000,10,0.02\n6,4000,10,0.02\n";
        std::fs::write(folder.path().join("a.csv"), run).unwrap();
        std::fs::write(folder.path().join("a.toml"), "[parameters]\nload_control = true\n").unwrap();
        let session = session(3, 1, folder.path()).unwrap();
        let (name, text) = &session.files[0];
        assert_eq!(name, "a.csv");
        let mut lines = text.lines();
        let names: Vec<&str> = lines.next().unwrap().split(',').collect();
        let rows: Vec<Vec<f64>> =
            lines.map(|line| line.split(',').map(|cell| cell.parse().unwrap()).collect()).collect();
        // 200 Hz
        assert_eq!(rows.len(), 1201);
        let of = |name: &str, from: f64, to: f64| -> Vec<f64> {
            let column = names.iter().position(|n| *n == name).unwrap();
            rows.iter().filter(|row| row[0] >= from && row[0] <= to).map(|row| row[column]).collect()
        };
        let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len() as f64;
        let loads = [(0.5, 2.0), (5.0, 6.0)].map(|(from, to)| of("force_z [N]", from, to));
        let zero = session.truth.offsets["force_z"];
        for (values, load) in loads.iter().zip([3000.0, 4000.0]) {
            // noise of 10 N on a thousand samples' mean, drift of a few
            assert!((mean(values) - zero - load).abs() < 15.0, "{} {zero}", mean(values));
            let deviation =
                (values.iter().map(|v| (v - mean(values)).powi(2)).sum::<f64>() / values.len() as f64).sqrt();
            assert!((8.0..16.0).contains(&deviation), "{deviation}");
        }
        let angle = mean(&of("slip_angle [rad]", 5.0, 6.0)) - 0.02;
        assert!(
            (angle.abs() - ANGLE).abs() < 1e-6 && (angle - session.truth.offsets["slip_angle"]).abs() < 1e-6
        );
        std::fs::write(folder.path().join("a.csv"), "time [s],steer [rad]\n0,0.1\n1,0.1\n").unwrap();
        assert!(super::session(3, 1, folder.path()).err().unwrap().contains("no steer"));
    }
}
