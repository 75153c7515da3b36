//! `latsch demo`: an FMU, a rig programme through it, a page to look at.

use super::print;
use super::simulate::{Subject, selected};
use latsch::fmi::archive::ModelLibrary;
use latsch::model::{Model, Settings};
use latsch::recording::{parse_csv, write_csv};
use latsch::report::write_html;
use latsch::rig::RingBrushFlatTrack;
use latsch::simulate::Experiment;
use latsch::{Error, Result, write_file};
use std::path::PathBuf;

/// The rig programme of the demo, see examples/README.md.
const PROGRAMME: &str = include_str!("../../examples/rig-programme.csv");

/// Export the tire's FMU, run a rig programme through it, write a page with plots
#[derive(clap::Args)]
pub struct Args {
    /// Folder for the FMU, the programme, the results and the page
    #[arg(long, short, value_name = "DIR", default_value = "demo")]
    output: PathBuf,
}

pub fn run(args: &Args) -> Result<()> {
    let folder = &args.output;
    std::fs::create_dir_all(folder).map_err(|e| Error::file(format!("{}: {e}", folder.display())))?;
    let model = RingBrushFlatTrack::NAME;

    let fmu = folder.join(format!("{model}.fmu"));
    write_file(&fmu, &ModelLibrary::shipped()?.fmu(model, &Settings::default(), &[])?)?;
    let programme = folder.join("rig-programme.csv");
    write_file(&programme, PROGRAMME.as_bytes())?;

    let inputs = parse_csv(PROGRAMME, "rig-programme.csv")?;
    let experiment = Experiment { inputs: Some(&inputs), ..Experiment::default() };
    let mut subject = Subject::load(&fmu.display().to_string(), None)?;
    let outcome = subject.run(&experiment, "flat track")?;
    if let Some(error) = outcome.stopped {
        return Err(error);
    }
    let results = folder.join("results.csv");
    write_csv(&results, &selected(subject.slave.interface(), &outcome.recording, false))?;
    let page = folder.join("index.html");
    write_html(&page, &subject.report(&experiment, &outcome)?)?;

    for (path, what) in [
        (&fmu, "the tire on its rig, for any FMI 2.0 co-simulation master"),
        (&programme, "what the rig was told"),
        (&results, "inputs and outputs"),
        (&page, "open this in a browser"),
    ] {
        print(&format!("{:40} {what}", path.display().to_string()))?;
    }
    Ok(())
}
