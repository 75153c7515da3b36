//! Checks of reading and writing road files; all files are made here.

mod between;
mod opencrg;
mod rdf;

use super::*;
use crate::road::{MAX_POINTS, Road, RoadParameters};
use proptest::prelude::*;
use std::path::PathBuf;

/// The cleat of the source's second listing, with a key that nobody knows.
const CLEAT: &str = "\
$--- a comment\n\
[MDI_HEADER]\nFILE_TYPE='rdf'\nFILE_VERSION=5.00\nFILE_FORMAT='ASCII'\n(COMMENTS)\n{comment_string}\n'cleat'\n\
[UNITS]\nLENGTH='mm'\nFORCE='newton'\nANGLE='degree'\nMASS='kg'\nTIME='sec'\n\
[MODEL]\nMETHOD='USER'\nFUNCTION_NAME='ARC501'\nROAD_TYPE='poly'\n\
[GRAPHICS]\nLENGTH=160000.0\nTYPE_STEPSIZE='FLEXIBLE'\n\
[PROFILE]\n{XZ}\n-80000 0.0 0.0\n500 0.0 0.0\n550 0.0 5.0 $ up\n700 5.0\n750 0.0 0.0\n80000 0.0 0.0\n\
[OFFSET]\nX=0.0\nY=0.0\nZ=0.0\nALPHA=0.0\nBETHA=0.0\nGAMMA=0.0\n[OWN]\nKEPT = 'yes'\n";

struct Folder(tempfile::TempDir);

impl Folder {
    fn new() -> Self {
        Self(tempfile::tempdir().unwrap())
    }

    fn file(&self, name: &str, content: impl AsRef<[u8]>) -> PathBuf {
        let path = self.0.path().join(name);
        std::fs::write(&path, content).unwrap();
        path
    }

    fn read(&self, name: &str, content: impl AsRef<[u8]>, lanes: &Lanes) -> Result<RoadProfile> {
        read(&self.file(name, content), lanes)
    }
}

fn rdf(content: &str) -> Result<RoadProfile> {
    Folder::new().read("r.rdf", content, &Lanes::default())
}

/// A text with one piece replaced by another.
fn changed(text: &str, from: &str, to: &str) -> String {
    assert_eq!(text.matches(from).count(), 1, "{from}");
    text.replace(from, to)
}

fn refused(result: Result<RoadProfile>, words: &[&str]) {
    let message = result.unwrap_err().to_string();
    assert!(words.iter().all(|word| message.contains(word)), "{message} lacks one of {words:?}");
    assert!(message.len() < 800, "{message}");
}

/// The height of the road that a model makes of a profile, at one place.
fn height(road: &RoadProfile, x: f64, y: f64) -> f64 {
    made(road).at(x, y).height
}

/// The road that a model makes of a profile.
fn made(road: &RoadProfile) -> Road {
    let settings = road.settings().unwrap();
    let mut parameters = RoadParameters::flat();
    parameters.kind = 8;
    let real = |name: &str, default: f64| match settings.values.iter().find(|s| s.name == name) {
        Some(crate::model::Setting { value: crate::model::Value::Real(value), .. }) => *value,
        _ => default,
    };
    let text = |name: &str| match settings.values.iter().find(|s| s.name == name) {
        Some(crate::model::Setting { value: crate::model::Value::Text(value), .. }) => value.clone(),
        _ => String::new(),
    };
    parameters.start = real("road_start", 5.0);
    parameters.track_width = real("road_track_width", 1.5);
    parameters.lateral_position = real("road_lateral_position", 0.0);
    parameters.direction = real("road_direction", 0.0);
    parameters.spacing = real("road_spacing", 0.0);
    parameters.profile = text("road_profile");
    parameters.profile_right = text("road_profile_right");
    Road::new(&parameters).unwrap()
}
