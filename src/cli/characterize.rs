//! `latsch characterize`: the curves of tires.

use super::console::Bar;
use super::given::Given;
use super::simulate::{is_file, parse_assignment};
use super::{print, warn};
use latsch::curves::{Measure, Programme, Rig, Tire, curves_csv, curves_readings_csv, measure, recordings};
use latsch::fmi::Entry;
use latsch::fmi::import::ImportedFmu;
use latsch::model::unit::quantity;
use latsch::model::{Settings, Slave};
use latsch::recording::{Names, read_names, write_tydex};
use latsch::report::{curves_report, write_html};
use latsch::shipped::MODELS;
use latsch::{Error, Result, with_unit, write_file};
use std::path::{Path, PathBuf};

/// What a flat track's name ends with.
const FLAT_TRACK: &str = "-flat-track";
/// Loads, as shares of the one that the first tire is for.
const LOADS: [f64; 3] = [0.5, 1.0, 1.5];
/// Where a rig says nothing \[N\], \[m/s\].
const LOAD: f64 = 4000.0;
const SPEED: f64 = 10.0;

/// Measure the characteristics of tires: forces and moments over slip angle, slip, camber and load
///
/// A page with curves and numbers (index.html), all states (curves.csv) and numbers (readings.csv). States are stationary: those in which a shipped
/// rig starts, or in which an FMU of somebody else settles. Several tires share their pictures. Running an FMU runs its code: use only those that you trust.
#[derive(clap::Args)]
pub struct Args {
    /// Tires: a shipped flat track (ring-brush-flat-track, or ring-brush for short), the same with parameters or a tire property file behind an @
    /// (magic-formula@F.tir, ring-brush@F.toml), or an FMU of a flat track
    #[arg(value_name = "TIRE", required = true)]
    tires: Vec<String>,
    /// Folder to write, which is made
    #[arg(long, short, value_name = "DIR")]
    output: PathBuf,
    /// Vertical forces: numbers in N, or with a unit, as "2 kN,4 kN" [default: 0.5, 1 and 1.5 times that for which the first tire was made]
    #[arg(long, value_name = "F,F,...")]
    loads: Option<String>,
    /// Speeds: numbers in m/s, or with a unit; all is measured at the first, curves over slip angle and slip at each [default: what the first rig starts with]
    #[arg(long, value_name = "V,V,...")]
    speeds: Option<String>,
    /// Factors on the friction of the road, as speeds
    #[arg(long, value_name = "X,X,...", default_value = "1")]
    friction: String,
    /// Largest slip angle: a number in rad, or with a unit
    #[arg(long, value_name = "ANGLE", default_value = "12 deg")]
    slip_angle: String,
    /// Largest slip of a driven wheel
    #[arg(long, value_name = "SLIP", default_value = "50 %")]
    slip: String,
    /// Largest camber: a number in rad, or with a unit
    #[arg(long, value_name = "ANGLE", default_value = "6 deg")]
    camber: String,
    /// Value of a parameter of all tires
    #[arg(long = "set", value_name = "NAME=VALUE")]
    set: Vec<String>,
    /// What an FMU calls its variables: TOML with a table [names] of slip_angle = "alpha"; names that are not there are those of the shipped flat tracks
    #[arg(long, value_name = "F.toml")]
    names: Option<PathBuf>,
    /// Also write each curve as a TYDEX file, into the folder tydex
    #[arg(long)]
    tydex: bool,
}

pub fn run(args: &Args) -> Result<()> {
    let names = args.names.as_deref().map(read_names).transpose()?.unwrap_or_default();
    let mut rigs = Vec::new();
    for tire in &args.tires {
        rigs.push((name_of(tire, &rigs), rig(tire, &args.set, &names).map_err(|e| e.at(tire))?));
    }
    let programme = programme(args, &rigs[0].1)?;
    programme.check()?;
    let inside = |name: &str| args.output.join(name);
    let tydex = inside("tydex");
    let folder = if args.tydex { &tydex } else { &args.output };
    std::fs::create_dir_all(folder)
        .map_err(|e| Error::file(format!("{} cannot be made: {e}", folder.display())))?;
    let states: usize = rigs.iter().map(|(_, rig)| programme.states(rig)).sum();
    let bar = Bar::of_steps(states as u64, "");
    let measured: Result<Vec<Tire>> = rigs
        .iter_mut()
        .map(|(name, rig)| {
            bar.set_what(name);
            measure(name, rig, &programme, &|| bar.step())
        })
        .collect();
    drop(bar);
    let tires = measured?;
    for tire in &tires {
        tire.notes.iter().for_each(|note| warn(&format!("{}: {note}", tire.name)));
    }
    write_file(&inside("curves.csv"), curves_csv(&tires).as_bytes())?;
    write_file(&inside("readings.csv"), curves_readings_csv(&tires).as_bytes())?;
    if args.tydex {
        for (name, recording) in tires.iter().flat_map(recordings) {
            write_tydex(&tydex.join(format!("{name}.tdx")), &recording)?;
        }
    }
    let page = inside("index.html");
    write_html(&page, &curves_report(&tires, &programme))?;
    tires.iter().try_for_each(|tire| print(&told(tire, programme.middle())))?;
    print(&format!("{}", page.display()))
}

/// A name for people: that of a file, or of a model without its rig. The second one of a name gets a number.
fn name_of(tire: &str, others: &[(String, Rig)]) -> String {
    let stem = |file: &str| Path::new(file).file_stem().unwrap_or_default().to_string_lossy().into_owned();
    let name = match tire.split_once('@') {
        _ if is_file(tire) => stem(tire),
        Some((_, file)) => stem(file),
        None => tire.trim_end_matches(FLAT_TRACK).into(),
    };
    let named = |k: usize| if k == 1 { name.clone() } else { format!("{name} ({k})") };
    let is_taken = |name: &String| others.iter().any(|(other, _)| other == name);
    (1..).map(named).find(|name| !is_taken(name)).unwrap_or_default()
}

/// The rig that a tire names.
fn rig(tire: &str, set: &[String], names: &Names) -> Result<Rig> {
    if !tire.contains('@') && Path::new(tire).extension().is_some_and(|e| e.eq_ignore_ascii_case("toml")) {
        return Err(Error::call(
            "this is no tire: parameters stand behind a model, as ring-brush@F.toml, and a plan for recordings of a solid tire is for `latsch solid-tire`",
        ));
    }
    let slave: Box<dyn Slave> = if is_file(tire) {
        Box::new(ImportedFmu::load(Path::new(tire))?)
    } else {
        let (model, file) = tire.split_once('@').map_or((tire, None), |(model, file)| (model, Some(file)));
        let full =
            if model.ends_with(FLAT_TRACK) { model.to_owned() } else { format!("{model}{FLAT_TRACK}") };
        let entry = Entry::find(MODELS, &full).or_else(|_| Entry::find(MODELS, model))?;
        entry.slave(&settings(&entry, file)?)?
    };
    let values =
        set.iter().map(|text| parse_assignment(slave.interface(), text)).collect::<Result<Vec<_>>>()?;
    // shipped rigs know their own names only
    let own = Names::new();
    Rig::new(slave, &values, if is_file(tire) { names } else { &own })
}

/// What the file behind an @ says of the tire.
fn settings(entry: &Entry, file: Option<&str>) -> Result<Settings> {
    let Some(file) = file.map(PathBuf::from) else { return Ok(Settings::default()) };
    let is_property_file = file.extension().is_some_and(|e| e.eq_ignore_ascii_case("tir"));
    let (tire, parameters) = if is_property_file { (Some(file), None) } else { (None, Some(file)) };
    let given = Given { parameters, tire, road: None, road_left: None, road_right: None };
    given.settings(Some(&(entry.table)()))
}

fn programme(args: &Args, first: &Rig) -> Result<Programme> {
    let list = |argument: &str, text: &str, unit: &str| {
        let one = |text: &str| quantity(text.trim(), unit).map_err(|e| e.at(format!("{argument} {text}")));
        text.split(',').map(one).collect::<Result<Vec<f64>>>()
    };
    let one = |argument: &str, text: &str, unit: &str| match list(argument, text, unit)?[..] {
        [value] if value.is_finite() && value > 0.0 => Ok(value),
        _ => Err(Error::call(format!("{argument} {text}: one number above 0 is wanted"))),
    };
    let nominal = first.nominal_load().unwrap_or(LOAD);
    let loads = match &args.loads {
        Some(text) => list("--loads", text, "N")?,
        None => LOADS.iter().map(|share| share * nominal).collect(),
    };
    let speeds = match &args.speeds {
        Some(text) => list("--speeds", text, "m/s")?,
        None => vec![first.speed().unwrap_or(SPEED)],
    };
    Ok(Programme {
        loads,
        speeds,
        frictions: list("--friction", &args.friction, "1")?,
        slip_angle: one("--slip-angle", &args.slip_angle, "rad")?,
        slip: one("--slip", &args.slip, "1")?,
        camber: one("--camber", &args.camber, "rad")?,
    })
}

/// A few numbers of a tire.
fn told(tire: &Tire, load: f64) -> String {
    let mut text = format!("{} at {load:.0} N:", tire.name);
    for measure in [
        Measure::CorneringStiffness,
        Measure::LateralPeak,
        Measure::BrakingPeak,
        Measure::VerticalStiffness,
        Measure::RelaxationLength,
    ] {
        if let Some(value) = tire.reading(measure, load) {
            let [_, title, unit] = measure.words();
            text += &format!("\n  {title:36} {}", with_unit(format_args!("{value:10.4}"), unit));
        }
    }
    text
}
