//! What is diagnosed: a shipped model, an FMU or a wired system, how to make slaves of it, and which of
//! its parameters a fit may change.

use super::given::why_given;
use super::numbers::PRIOR;
use crate::cosimulate::{Source, System, SystemSlave, read_system};
use crate::fit::Factory;
use crate::fmi::Entry;
use crate::fmi::import::ImportedFmu;
use crate::model::{Causality, Interface, Kind, Settings, Slave, Value, VariableInfo};
use crate::recording::read_settings;
use crate::shipped::MODELS;
use crate::simulate::{ACTUATORS, follow_recorded_motions};
use crate::{Error, Result};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// How far a parameter without bounds of its own may move from its nominal value, as a share of it.
const REACH: f64 = 0.5;
/// The filter of a rig's actuators.
const FILTER: &str = "actuator_frequency";
/// Why a parameter is left out, if not by what it is.
const PASSED_BY: &str = "recorded motions are followed as they are and do not pass the actuators";
const ZERO: &str = "it is zero, so nothing is known of its size: [fit] can give it a range";
const NO_ROOM: &str = "it has no value, or its range leaves no room";

/// What the user has in hand.
#[derive(Debug, Clone, PartialEq)]
pub enum Base {
    /// A shipped model with its settings.
    Shipped(String, Settings),
    /// A file of a third party or our own.
    Fmu(PathBuf),
    /// A wired system.
    System(PathBuf),
}

/// A parameter that may be fitted.
#[derive(Debug, Clone, PartialEq)]
pub struct FreeParameter {
    /// Index of the variable.
    pub variable: usize,
    /// Value before the fit.
    pub nominal: f64,
    /// Its typical size: that of the value, or of its range if the value is zero.
    pub scale: f64,
    /// Bounds.
    pub low: f64,
    /// Bounds.
    pub high: f64,
    /// What is known of it beforehand: its standard deviation, in multiples of its size.
    pub prior: f64,
    /// The user asked for it.
    pub asked: bool,
}

/// A parameter that is not fitted unless the user asks for it.
#[derive(Debug, Clone, PartialEq)]
pub struct LeftOut {
    /// Index of the variable.
    pub variable: usize,
    /// Why.
    pub why: &'static str,
}

/// A model under diagnosis.
pub struct Subject {
    /// What it is.
    pub base: Base,
    /// Makes slaves of it.
    pub factory: Factory,
    /// Its interface.
    pub interface: Interface,
    /// Values that the user set, applied before every run.
    pub fixed: Vec<(usize, Value)>,
    /// What may be fitted.
    pub free: Vec<FreeParameter>,
    /// What is left out of that, if the user did not say what may be fitted.
    pub left_out: Vec<LeftOut>,
    /// Values of the wired system's file, by the names of its variables.
    set_in_system: Vec<String>,
    /// See [`Subject::own_step`].
    own_step: Option<f64>,
}

impl Subject {
    /// Switches actuators off that would follow the motions in recordings once more; `recorded` are the inputs that
    /// recordings hold. Gives the switches that were turned.
    ///
    /// # Errors
    /// The user asked for a fit of what then has no effect.
    pub fn follow_recorded_motions(&mut self, recorded: &[usize]) -> Result<Vec<usize>> {
        let off = self.actuators_of(recorded);
        self.fixed.extend(off.iter().cloned());
        let off: Vec<usize> = off.into_iter().map(|(variable, _)| variable).collect();
        for switch in &off {
            let name = &self.interface.variables[*switch].name;
            let filter = format!("{}{FILTER}", name.strip_suffix(ACTUATORS).unwrap_or_default());
            let Some(variable) = self.interface.index(&filter) else { continue };
            if self.free.iter().any(|p| p.variable == variable && p.asked) {
                return Err(Error::file(format!(
                    "[fit]: {filter} does nothing while recorded motions are followed as they are; set {name} = true under [parameters] if the recordings hold commands"
                )));
            }
            self.free.retain(|p| p.variable != variable);
            if !self.left_out.iter().any(|l| l.variable == variable) {
                self.left_out.push(LeftOut { variable, why: PASSED_BY });
            }
        }
        Ok(off)
    }

    /// Where a parameter may be that is left out, if it is a number with a size.
    pub(super) fn may_be(&self, variable: usize) -> Option<FreeParameter> {
        free_parameter(&self.interface, &self.fixed, variable, None)
            .filter(|p| p.nominal != 0.0 && p.high > p.low)
    }

    /// Switches of actuators, turned off, of what these inputs drive, where nobody has set them.
    pub(super) fn actuators_of(&self, recorded: &[usize]) -> Vec<(usize, Value)> {
        follow_recorded_motions(&self.interface, recorded, |variable| self.is_given(variable))
    }

    /// Whether somebody has set a variable: the user, the file of a shipped model, or that of a wired system.
    pub(super) fn is_given(&self, variable: usize) -> bool {
        let own = match &self.base {
            Base::Shipped(_, settings) => &settings.values[..],
            _ => &[],
        };
        let name = &self.interface.variables[variable].name;
        self.fixed.iter().any(|(v, _)| *v == variable)
            || own.iter().any(|s| s.name == *name)
            || self.set_in_system.contains(name)
    }

    /// The communication step \[s\] that the model has and no other: that of a wired system, or of an FMU that names one and does not
    /// take any.
    pub fn own_step(&self) -> Option<f64> {
        self.own_step
    }

    /// Loads a model by name or file.
    ///
    /// # Errors
    /// No such model or file, settings that do not fit.
    pub fn load(model: &str, settings: &Settings) -> Result<Self> {
        let path = Path::new(model);
        let (base, factory): (Base, Factory) = match crate::ending(path).as_str() {
            "fmu" => {
                let file = path.to_path_buf();
                let load = move || -> Result<Box<dyn Slave>> { Ok(Box::new(ImportedFmu::load(&file)?)) };
                (Base::Fmu(path.into()), Arc::new(load))
            }
            "ssd" | "ssp" | "toml" => {
                let file = path.to_path_buf();
                let load = move || -> Result<Box<dyn Slave>> {
                    let (system, step) = wired(&file)?;
                    Ok(Box::new(SystemSlave::new("system", system, step)?))
                };
                (Base::System(path.into()), Arc::new(load))
            }
            _ => {
                let entry = Entry::find(MODELS, model).map_err(|e| {
                    Error::variable(format!(
                        "{e}; an FMU is named by its file F.fmu, a system by F.ssd or F.toml"
                    ))
                })?;
                // with bounds and places, which the model does not need
                let own = Settings { fit: Vec::new(), ..settings.clone() };
                let (given, values) = (own.clone(), own);
                let load = move || -> Result<Box<dyn Slave>> {
                    let slave: Box<dyn Slave> = entry.slave(&values)?;
                    Ok(slave)
                };
                (Base::Shipped(model.into(), given), Arc::new(load))
            }
        };
        let interface = factory()?.interface().clone();
        let fixed = Settings { model: None, ..settings.clone() }.check(&interface)?;
        let (free, left_out) = free_parameters(&interface, &fixed, settings)?;
        let set_in_system = match &base {
            Base::System(file) => names_set(file)?,
            _ => Vec::new(),
        };
        let own_step = match &base {
            Base::System(_) => Some(interface.communication_step),
            Base::Fmu(file) => {
                let fmu = ImportedFmu::load(file)?;
                let about = fmu.description();
                about.experiment.step_size.filter(|_| !about.capabilities.can_handle_variable_step)
            }
            Base::Shipped(..) => None,
        };
        Ok(Self { base, factory, interface, fixed, free, left_out, set_in_system, own_step })
    }
}

/// The names of the variables that a system's file sets.
fn names_set(file: &Path) -> Result<Vec<String>> {
    let components = read_system(file)?.plan.components;
    let mut names = Vec::new();
    for component in components {
        names.extend(component.set.iter().map(|s| format!("{}.{}", component.name, s.variable)));
        if let Source::Model(_, parameters) = &component.source {
            let settings = read_settings(parameters.as_deref())?;
            names.extend(settings.values.iter().map(|s| format!("{}.{}", component.name, s.name)));
        }
    }
    Ok(names)
}

/// A wired system from its file, with its communication step \[s\].
///
/// # Errors
/// A file that cannot be read or has no step, parts that cannot be loaded.
pub(super) fn wired(file: &Path) -> Result<(System, f64)> {
    let system = read_system(file)?;
    let loaded = system.plan.load()?;
    let step = system.plan.step.ok_or_else(|| {
        Error::file(format!("{}: there is no communication step; give it in the file", file.display()))
    })?;
    Ok((loaded, step))
}

/// The number that a variable has, as it is set or where it starts.
pub(super) fn value_of(info: &VariableInfo, variable: usize, fixed: &[(usize, Value)]) -> Option<f64> {
    let set = fixed.iter().find(|(v, _)| *v == variable).map(|(_, value)| value);
    match set.or(info.start.as_ref()) {
        Some(Value::Real(v)) => Some(*v),
        Some(Value::Integer(v)) => Some(f64::from(*v)),
        _ => None,
    }
}

/// A parameter that may be fitted within a range, or as far from its value as one without.
fn free_parameter(
    interface: &Interface,
    fixed: &[(usize, Value)],
    variable: usize,
    range: Option<(f64, f64)>,
) -> Option<FreeParameter> {
    let info = &interface.variables[variable];
    let nominal = value_of(info, variable, fixed)?;
    let reach = REACH * nominal.abs();
    let (low, high) = range.unwrap_or((nominal - reach, nominal + reach));
    let low = low.max(info.min.unwrap_or(f64::NEG_INFINITY));
    let high = high.min(info.max.unwrap_or(f64::INFINITY));
    let scale = if nominal == 0.0 { 0.5 * (high - low) } else { nominal.abs() };
    // whoever gives a range says that it may be anywhere in it: the deviation of a uniform distribution
    let prior = if range.is_some() { (high - low).abs() / 12.0_f64.sqrt() / scale } else { PRIOR };
    let nominal = nominal.clamp(low, high.max(low));
    Some(FreeParameter { variable, nominal, scale, low, high, prior, asked: false })
}

fn free_parameters(
    interface: &Interface,
    fixed: &[(usize, Value)],
    settings: &Settings,
) -> Result<(Vec<FreeParameter>, Vec<LeftOut>)> {
    let parameter = |variable: usize, range: Option<(f64, f64)>| {
        let found = free_parameter(interface, fixed, variable, range)?;
        Some(FreeParameter { asked: !settings.fit.is_empty(), ..found })
    };
    if settings.fit.is_empty() {
        let (mut free, mut left_out) = (Vec::new(), Vec::new());
        for (variable, info) in interface.variables.iter().enumerate() {
            if info.causality != Causality::Parameter {
                continue;
            }
            let why = why_given(info).or_else(|| why_passed_by(interface, info, fixed));
            let found = parameter(variable, None);
            match (why, found) {
                (Some(why), _) => left_out.push(LeftOut { variable, why }),
                (None, Some(p)) if p.nominal != 0.0 && p.high > p.low => free.push(p),
                (None, Some(p)) if p.nominal == 0.0 => left_out.push(LeftOut { variable, why: ZERO }),
                (None, _) => left_out.push(LeftOut { variable, why: NO_ROOM }),
            }
        }
        return Ok((free, left_out));
    }
    let mut free = Vec::new();
    for entry in &settings.fit {
        let at = |e: Error| Error::file(e.to_string()).at(&entry.place);
        let variable = interface.find(&entry.name).map_err(at)?;
        let info = &interface.variables[variable];
        if info.causality != Causality::Parameter || info.kind != Kind::Real {
            return Err(at(Error::variable(format!("{} is no real parameter", entry.name))));
        }
        let found = parameter(variable, entry.range)
            .filter(|p| p.high > p.low && p.scale.is_finite() && p.scale > 0.0);
        free.push(found.ok_or_else(|| {
            at(Error::variable(format!("{}: its start value and range leave nothing to fit", entry.name)))
        })?);
    }
    Ok((free, Vec::new()))
}

/// Why the filter of a rig's actuators has no effect on recorded motions, if so: they come with derivatives, and with
/// those, or without actuators, they are followed as they are.
fn why_passed_by(
    interface: &Interface,
    info: &VariableInfo,
    fixed: &[(usize, Value)],
) -> Option<&'static str> {
    let part = info.name.strip_suffix(FILTER)?;
    if !(part.is_empty() || part.ends_with('.')) {
        return None;
    }
    let Some(switch) = interface.index(&format!("{part}{ACTUATORS}")) else { return Some(PASSED_BY) };
    let set = fixed.iter().find(|(v, _)| *v == switch).map(|(_, value)| value);
    let is_on = set.or(interface.variables[switch].start.as_ref()) == Some(&Value::Boolean(true));
    (!is_on).then_some(PASSED_BY)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The real parameters of a shipped model with the inputs that a recording holds: those that may be fitted, and
    /// those that are left out, with the reason.
    fn shares(model: &str) -> (Vec<String>, Vec<(String, &'static str)>) {
        let mut subject = Subject::load(model, &Settings::default()).unwrap();
        let inputs: Vec<usize> = subject.interface.with(Causality::Input).collect();
        subject.follow_recorded_motions(&inputs).unwrap();
        let info = |variable: usize| &subject.interface.variables[variable];
        let left = subject.left_out.iter().filter(|l| info(l.variable).is_real());
        for other in subject.left_out.iter().filter(|l| !info(l.variable).is_real()) {
            assert_eq!(other.why, "it is no real number", "{}", info(other.variable).name);
        }
        let parameters = subject.interface.with(Causality::Parameter).count();
        assert_eq!(subject.free.len() + subject.left_out.len(), parameters, "{model}");
        (
            subject.free.iter().map(|p| info(p.variable).name.clone()).collect(),
            left.map(|l| (info(l.variable).name.clone(), l.why)).collect(),
        )
    }

    const TIRE: &[&str] = &[
        "tire_radius",
        "tire_width",
        "cross_section_radius",
        "rolling_radius",
        "belt_mass",
        "belt_inertia_diametral",
        "belt_inertia_polar",
        "vertical_stiffness",
        "vertical_stiffness_quadratic",
        "vertical_damping",
        "sidewall_radial_stiffness",
        "sidewall_lateral_stiffness",
        "sidewall_tilt_stiffness",
        "sidewall_windup_stiffness",
        "sidewall_radial_damping",
        "sidewall_lateral_damping",
        "sidewall_tilt_damping",
        "sidewall_windup_damping",
        "bristle_length",
        "bristle_stiffness",
        "bristle_damping",
        "stripe_length_factor",
        "patch_compliance_x",
        "patch_compliance_y",
        "patch_compliance_twist",
        "patch_lag_x",
        "patch_lag_y",
        "patch_lag_twist",
        "pressure_exponent_long_0",
        "pressure_exponent_long_1",
        "pressure_exponent_long_2",
        "pressure_exponent_lat_0",
        "pressure_exponent_lat_1",
        "pressure_exponent_lat_2",
        "rolling_resistance_lever",
        "friction_static_zero",
        "friction_static_reference",
        "friction_sliding_zero",
        "friction_sliding_reference",
        "friction_pressure",
        "friction_pressure_scale",
    ];
    const NUMERICS: &str = "it belongs to the numerics";
    const START: &str = "it is a state at the start, which runs do not share";
    const DATA: &str = "a file or data sheet gives it, and a few recordings do not tell it";
    const GRAVITY: (&str, &str) = ("gravity", "it is a known constant of nature");
    const STEP: (&str, &str) = ("step_size", NUMERICS);
    const FALLOFF: (&str, &str) = ("friction_speed_falloff", ZERO);
    const ROAD: &[&str] = &[
        "road_start",
        "road_height",
        "road_length",
        "road_bevel",
        "road_spacing",
        "road_roughness",
        "road_direction",
        "road_track_width",
        "road_lateral_position",
        "road_coherence_length",
        "road_friction_deviation",
        "road_friction_correlation_length",
    ];

    /// A tire's parameters and others are fitted; what is left out stands in the order of the table.
    fn check_tire(model: &str, fitted: &[&str], before: &[(&str, &str)], has_road: bool) {
        let (free, left) = shares(model);
        let road = if has_road { ROAD } else { &[] };
        // how the tire feels the road is the tire's
        let filter = ["road_filter_length"];
        let (before_it, behind_it) = TIRE.split_at(4);
        let filter = if has_road { &filter[..] } else { &[] };
        assert_eq!(free, [before_it, filter, behind_it, fitted].concat(), "{model}");
        let road = road.iter().map(|name| (*name, "the road that was driven on is given"));
        let expected: Vec<(&str, &str)> =
            before.iter().copied().chain([STEP]).chain(road).chain([FALLOFF]).collect();
        let left: Vec<(&str, &str)> = left.iter().map(|(name, why)| (name.as_str(), *why)).collect();
        // a switch that was turned says so at the end
        let mut sorted = (left, expected);
        sorted.0.sort_unstable();
        sorted.1.sort_unstable();
        assert_eq!(sorted.0, sorted.1, "{model}");
    }

    #[test]
    fn of_every_shipped_model_it_is_known_what_is_fitted_and_why_not() {
        let filter = (FILTER, PASSED_BY);
        check_tire("ring-brush-flat-track", &[], &[GRAVITY, filter, ("load_control_gain", DATA)], true);
        check_tire("ring-brush-tire", &[], &[GRAVITY], false);
        let hub = ["hub_mass", "hub_inertia"];
        let before = [GRAVITY, ("initial_speed", START), ("initial_load", START), filter];
        check_tire("ring-brush-wheel", &hub, &before, true);
        let vehicle = ["vehicle_mass", "sprung_mass", "hub_mass", "hub_inertia"];
        let springs =
            ["suspension_stiffness", "suspension_damping", "fore_aft_stiffness", "fore_aft_damping"];
        let stop = [("bump_stop_gap", DATA), ("bump_stop_stiffness", ZERO)];
        let before = [&[GRAVITY, ("initial_speed", START)][..], &stop].concat();
        check_tire("ring-brush-corner", &[vehicle, springs].concat(), &before, true);

        let (free, left) = shares("brake-hydraulics");
        let all = [
            "piston_area",
            "friction_radius",
            "friction",
            "onset_friction_share",
            "onset_time",
            "contact_pressure",
            "caliper_lag",
            "build_rate",
            "dump_rate",
            "release_rate",
        ];
        assert_eq!((free, left), (all.map(String::from).to_vec(), vec![("step_size".into(), NUMERICS)]));
        // of a tire that a file gives, its scales are fitted
        for rig in ["flat-track", "tire", "wheel", "corner", "hydropulse", "drum"] {
            let (free, left) = shares(&format!("magic-formula-{rig}"));
            let is_coefficient = |name: &&String| name.chars().all(|c| !c.is_ascii_lowercase());
            let fitted: Vec<_> = free.iter().filter(is_coefficient).collect();
            assert_eq!(
                (fitted.len(), fitted.iter().all(|name| name.starts_with('L'))),
                (29, true),
                "{fitted:?}"
            );
            let given = left.iter().filter(|(_, why)| *why == DATA);
            assert!(given.count() > 80, "{left:?}");
        }
        // what the source of a tire leaves out is off, and its contact is numerics
        for rig in ["flat-track", "tire", "wheel", "corner", "hydropulse", "drum"] {
            let (free, left) = shares(&format!("super-elastic-{rig}"));
            let fitted = [
                "element_radial_stiffness",
                "element_radial_damping",
                "rubber_mass",
                "slip_stiffness",
                "friction_max",
            ];
            assert!(fitted.iter().all(|n| free.iter().any(|f| f == n)), "{rig}: {free:?}");
            let off =
                [("relaxing_stiffness", ZERO), ("friction_force", ZERO), ("contact_stiffness", NUMERICS)];
            let is_left = |(name, why): &(&str, &str)| left.iter().any(|(n, w)| n == name && w == why);
            assert!(off.iter().all(is_left), "{rig}: {left:?}");
        }
        let (free, left) = shares("ring-brush-hydropulse");
        assert!(
            free.iter().any(|f| f == "wheel_mass") && !free.iter().any(|f| f.starts_with("excitation")),
            "{left:?}"
        );

        // of rigs and trucks what a ruler measures is given
        for (model, given, fitted) in [
            ("ring-brush-drum", ["drum_diameter", "weight_distance"], ["arm_inertia", "wheel_mass"]),
            ("linear-drum", ["arm_length", "weight_mass"], ["vertical_stiffness", "vertical_damping"]),
            (
                "linear-counterbalance-truck",
                ["wheelbase", "chassis_x"],
                ["mount_stiffness", "chassis_pitch_inertia"],
            ),
            (
                "super-elastic-counterbalance-truck",
                ["front_track", "mount_z"],
                ["chain_stiffness", "cabin_mass"],
            ),
            (
                "ring-brush-vehicle",
                ["wheelbase", "front_caster"],
                ["column_stiffness", "front_wheel_inertia"],
            ),
            (
                "magic-formula-vehicle",
                ["front_track", "front_anti_dive"],
                ["rear_spring_stiffness", "vehicle_mass"],
            ),
            (
                "axle",
                ["front_steering_arm", "wheel_centre_height"],
                ["front_longitudinal_link_stiffness", "front_carrier_mass"],
            ),
        ] {
            let (free, left) = shares(model);
            assert!(
                given.iter().all(|n| left.iter().any(|(l, why)| l == n && *why == DATA)),
                "{model}: {left:?}"
            );
            assert!(fitted.iter().all(|n| free.iter().any(|f| f == n)), "{model}: {free:?}");
        }
        // of classic tires their stiffnesses and friction are fitted, and how they stand still is not
        let on = ["flat-track", "tire", "wheel", "corner"];
        let simple = ["slip_stiffness", "cornering_stiffness", "friction_max"];
        for (tire, rigs, fitted, given) in [
            ("fiala", &on[..], &simple[..], ("low_speed", NUMERICS)),
            ("ua", &on, &[&simple[..], &["camber_stiffness"]].concat(), ("low_speed", NUMERICS)),
            ("linear", &["wheel", "corner", "hydropulse"], &simple, ("low_speed", NUMERICS)),
            ("tmeasy", &on, &["x_slope", "y_peak", "trail"], ("nominal_load", DATA)),
            ("swift", &on, &["Q_FZ1", "LMUX"], ("VXLOW", NUMERICS)),
        ] {
            for rig in rigs {
                let (free, left) = shares(&format!("{tire}-{rig}"));
                assert!(fitted.iter().all(|n| free.iter().any(|f| f == n)), "{tire}-{rig}: {free:?}");
                assert!(left.iter().any(|(n, why)| (n.as_str(), *why) == given), "{tire}-{rig}: {left:?}");
            }
        }

        // thresholds of a controller have units; its reference speed is no reference of anything else
        let (free, left) = shares("abs-controller");
        assert_eq!(left, [("sample_time".to_string(), NUMERICS)]);
        assert_eq!(free.len(), 30);
        assert!(
            ["speed_tolerance", "reference_ascent"].iter().all(|n| free.iter().any(|f| f == n)),
            "{free:?}"
        );
    }

    /// A subject with a switch of its actuators, which is on by default, and the number of that.
    fn with_actuators(settings: &Settings) -> (Subject, usize) {
        let subject = Subject::load("ring-brush-flat-track", settings).unwrap();
        let switch = subject.interface.index(ACTUATORS).unwrap();
        (subject, switch)
    }

    #[test]
    fn recorded_motions_are_followed_and_the_filter_is_not_fitted_then() {
        let (mut subject, switch) = with_actuators(&Settings::default());
        let filter = subject.interface.index(FILTER).unwrap();
        let slip = subject.interface.index("slip").unwrap();
        let is_fitted = |subject: &Subject| subject.free.iter().any(|p| p.variable == filter);
        // commands pass it as long as nothing is recorded
        assert_eq!(subject.follow_recorded_motions(&[]).unwrap(), [0; 0]);
        assert!(is_fitted(&subject) && subject.fixed.is_empty());
        assert_eq!(subject.follow_recorded_motions(&[slip]).unwrap(), [switch]);
        assert_eq!(subject.fixed, [(switch, Value::Boolean(false))]);
        assert!(!is_fitted(&subject));
        assert!(subject.left_out.contains(&LeftOut { variable: filter, why: PASSED_BY }));
        // who says that recordings hold commands is believed
        let (mut subject, switch) = with_actuators(&Settings::default());
        subject.fixed.push((switch, Value::Boolean(true)));
        assert_eq!(subject.follow_recorded_motions(&[slip]).unwrap(), [0; 0]);
        assert!(is_fitted(&subject));
        // and who asks for a fit of what does nothing is told
        let file = "[fit]\nactuator_frequency = true\n";
        let (mut subject, _) = with_actuators(&Settings::parse(file, "own.toml").unwrap());
        let message = subject.follow_recorded_motions(&[slip]).unwrap_err().to_string();
        assert!(message.contains("command_actuators = true under [parameters]"), "{message}");
    }

    /// What `shipped::MODELS` has beside those above would be tested by nobody.
    #[test]
    fn no_shipped_model_is_forgotten() {
        assert_eq!(MODELS.len(), 45);
    }
}
