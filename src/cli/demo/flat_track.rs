//! A tire on its rig: the FMU, a rig programme through it, a page.

use crate::cli::simulate::{Subject, selected};
use latsch::comparison::Conditions;
use latsch::fmi::archive::ModelLibrary;
use latsch::model::{Model, Settings};
use latsch::recording::{parse_csv, write_csv};
use latsch::report::write_html;
use latsch::rig::RingBrushFlatTrack;
use latsch::simulate::Experiment;
use latsch::{Result, write_file};
use std::path::Path;

/// The rig programme of the demo, see examples/README.md.
const PROGRAMME: &str = include_str!("../../../examples/rig-programme.csv");

/// Writes everything into an existing folder.
pub fn run(folder: &Path, library: &ModelLibrary) -> Result<()> {
    let model = RingBrushFlatTrack::NAME;
    let fmu = folder.join(format!("{model}.fmu"));
    write_file(&fmu, &library.fmu(model, &super::tire()?, &[])?)?;
    write_file(&folder.join("rig-programme.csv"), PROGRAMME.as_bytes())?;

    let inputs = parse_csv(PROGRAMME, "rig-programme.csv")?;
    let experiment = Experiment { inputs: Some(&inputs), ..Experiment::default() };
    let mut subject = Subject::load(&fmu.display().to_string(), &Settings::default())?;
    let outcome = subject.run(&experiment, "flat track")?;
    if let Some(error) = outcome.stopped {
        return Err(error);
    }
    write_csv(&folder.join("results.csv"), &selected(subject.slave.interface(), &outcome.recording, false))?;
    write_html(&folder.join("index.html"), &subject.report(&experiment, &outcome, &Conditions::default())?)
}
