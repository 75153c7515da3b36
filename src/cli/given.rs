//! Values for a model that files give: a tire property file, and parameters over it.

use super::{note, warn};
use latsch::model::{Interface, Settings};
use latsch::recording::read_settings;
use latsch::road_file::{self, Lanes};
use latsch::tire::Tire;
use latsch::tire::super_elastic::SuperElastic;
use latsch::{Error, Result};
use std::path::{Path, PathBuf};

/// The files of a model that one names on the command line.
#[derive(clap::Args)]
pub struct Given {
    /// Parameters and inputs of a shipped model: TOML with [parameters] and [inputs], in SI units or as "170 N/mm"
    #[arg(long, value_name = "F.toml")]
    pub parameters: Option<PathBuf>,
    /// Tire property file: of the Magic Formula 5.2 for the models magic-formula-..., of the super-elastic tire (TYR501) for super-elastic-...; --parameters goes over it
    #[arg(long, value_name = "F.tir")]
    pub tire: Option<PathBuf>,
    /// Road file that the models roll on: .rdf, .crg (OpenCRG) or .csv with the columns x [m], z [m]; --parameters and --set go over it
    #[arg(long, value_name = "F.rdf|F.crg|F.csv")]
    pub road: Option<PathBuf>,
    /// Where the left track, or the only one, is on an OpenCRG road [m]; positive to the left of its reference line [default: 0]
    #[arg(long, value_name = "Y", requires = "road", allow_negative_numbers = true)]
    pub road_left: Option<f64>,
    /// Where the right track is on an OpenCRG road [m]; without one both are the same
    #[arg(long, value_name = "Y", requires = "road", allow_negative_numbers = true)]
    pub road_right: Option<f64>,
}

impl Given {
    /// Whether there is any.
    pub fn any(&self) -> bool {
        self.parameters.is_some() || self.tire.is_some() || self.road.is_some()
    }

    /// The files that are read.
    pub fn read(&self) -> impl Iterator<Item = &Path> {
        self.parameters.iter().chain(&self.tire).chain(&self.road).map(PathBuf::as_path)
    }

    /// The values for a model with this interface, with warnings about what of the files is not used.
    ///
    /// # Errors
    /// A file that cannot be used, or is for another tire than the model's.
    pub fn settings(&self, interface: Option<&Interface>) -> Result<Settings> {
        let mut settings = read_settings(self.parameters.as_deref())?;
        if let Some(path) = &self.tire {
            let tire = latsch::tir::settings(path)?;
            if let Some(interface) = interface {
                tire.check_fits(interface)?;
            }
            tire.notes.iter().for_each(|note| warn(note));
            settings = over(tire.settings, settings);
        }
        if let Some(path) = &self.road {
            let lanes = Lanes { left: self.road_left, right: self.road_right };
            let road = road_file::read(path, &lanes)?;
            for text in &road.notes {
                note(text);
            }
            let left_out: Vec<&str> = road.left_out().map(String::as_str).collect();
            if !left_out.is_empty() {
                note(&format!("{}: not used: {}", path.display(), left_out.join("; ")));
            }
            let edges = road.edges();
            if edges > 0 && interface.is_some_and(|i| i.name.starts_with(SuperElastic::NAME)) {
                warn(&format!(
                    "{}: {edges} vertical edges: the elements of the super-elastic tire meet one in its full height at once, with forces that mean nothing; make them short ramps",
                    path.display()
                ));
            }
            let road = road.settings()?;
            if let Some(interface) = interface
                && interface.index("road_profile").is_none()
            {
                return Err(Error::call(format!(
                    "{}: {} has no road; models that have are wheels and corners",
                    path.display(),
                    interface.name
                )));
            }
            // another kind of road goes over all of the file's, not over one number of it
            match settings.values.iter().find(|setting| setting.name == "road_kind") {
                Some(own) => warn(&format!(
                    "{}: not used: {} has a road_kind of its own, which goes over the file",
                    path.display(),
                    own.place
                )),
                None => settings = over(road, settings),
            }
        }
        Ok(settings)
    }
}

/// The values of a file, with those of another in place of them.
pub fn over(below: Settings, mut own: Settings) -> Settings {
    let mut values = below.values;
    values.retain(|below| !own.values.iter().any(|o| o.name == below.name));
    values.append(&mut own.values);
    Settings { values, ..own }
}
