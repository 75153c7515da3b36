//! A road as parameters of a model, and back.

use super::profile::{RoadProfile, text};
use crate::model::{Causality, Setting, Settings, Value};
use crate::recording::read_settings;
use crate::road::RoadParameters;
use crate::{Error, Result};
use std::fmt::Write as _;
use std::path::Path;

impl RoadProfile {
    /// The parameters of a model that rolls on it. `road_start` is 0, so that x of the file counts from where the wheel starts.
    /// Points on straight lines are left out, which changes nothing.
    ///
    /// # Errors
    /// More points than a model takes, or what it refuses.
    pub fn settings(&self) -> Result<Settings> {
        let mut road = self.clone();
        road.thin();
        road.check()?;
        let mut values = vec![
            ("road_kind", Value::Text("profile".into())),
            ("road_start", Value::Real(0.0)),
            ("road_profile", Value::Text(text(&road.left))),
        ];
        if let Some(right) = &road.right {
            values.push(("road_profile_right", Value::Text(text(right))));
            values.push(("road_track_width", Value::Real(road.track_width)));
            values.push(("road_lateral_position", Value::Real(-road.middle)));
        }
        if road.direction != 0.0 {
            values.push(("road_direction", Value::Real(road.direction)));
        }
        if road.spacing != 0.0 {
            values.push(("road_spacing", Value::Real(road.spacing)));
        }
        if !road.friction.is_empty() {
            values.push(("road_friction", Value::Text(text(&road.friction))));
        }
        let table = RoadParameters::rows().infos();
        for (name, value) in &values {
            if let Some(info) = table.iter().find(|info| info.name == *name) {
                info.accept(value).map_err(|e| Error::file(format!("{}: {e}", road.source)))?;
            }
        }
        let setting = |(name, value): (&str, Value)| Setting {
            name: name.into(),
            value,
            causality: Causality::Parameter,
            place: road.source.clone(),
        };
        Ok(Settings { values: values.into_iter().map(setting).collect(), ..Settings::default() })
    }
}

pub(super) fn read(path: &Path) -> Result<RoadProfile> {
    let source = path.display().to_string();
    let settings = read_settings(Some(path))?;
    let table = RoadParameters::rows();
    let infos = table.infos();
    let mut parameters = RoadParameters::flat();
    let mut others = Vec::new();
    for setting in &settings.values {
        let Some(row) = table.position(&setting.name) else {
            others.push(setting.name.as_str());
            continue;
        };
        let value = infos[row].accept_quantity(&setting.value).map_err(|e| e.at(&setting.place))?;
        table.write(row, &mut parameters, &value);
    }
    let at = |e: Error| Error::file(format!("{source}: {e}"));
    let (left, right) = parameters.outline().map_err(at)?;
    let mut road = RoadProfile::of(&source, left);
    road.right = right;
    road.track_width = parameters.track_width;
    road.middle = if road.right.is_some() { -parameters.lateral_position } else { 0.0 };
    road.direction = parameters.direction;
    road.spacing = match parameters.kind {
        // slabs join unless they say otherwise
        7 if parameters.spacing == 0.0 => parameters.length,
        4 | 7 | 8 => parameters.spacing,
        _ => 0.0,
    };
    road.friction = parameters.friction_steps().map_err(at)?;
    if !parameters.friction_right.trim().is_empty() {
        road.lost.push("road_friction_right: a friction of its own on the right".into());
    }
    if parameters.friction_deviation != 0.0 {
        road.lost.push("road_friction_deviation: the friction that varies at random".into());
    }
    if !others.is_empty() {
        road.lost.push(format!("what is no road: {}", others.join(", ")));
    }
    Ok(road)
}

pub(super) fn write(road: &RoadProfile) -> Result<(Vec<u8>, Vec<String>)> {
    let mut text = String::from("[parameters]\n");
    for setting in road.settings()?.values {
        let _ = writeln!(text, "{} = {}", setting.name, setting.value.to_toml());
    }
    Ok((text.into_bytes(), Vec::new()))
}
