//! What the variables of a model are: the roles that its author gives them, or that units and names tell where nobody
//! does, and signals made of others.

use crate::effect::{Role, Signal, Source};
use crate::model::unit::Unit;
use crate::model::{Causality, Interface, Variability, VariableInfo};
use crate::{Error, Result};

/// Roles of the variables of an interface.
#[derive(Debug, Clone, Default)]
pub struct Roles {
    /// Roles by index of variable; several are possible.
    of: Vec<Vec<Role>>,
}

/// Exponents of kg, m, s, A, K, mol, cd, rad.
type Dimension = [i8; 8];

const NEWTON: Dimension = [1, 1, -2, 0, 0, 0, 0, 0];
const NEWTON_METRE: Dimension = [1, 2, -2, 0, 0, 0, 0, 0];
const METRE: Dimension = [0, 1, 0, 0, 0, 0, 0, 0];
const RADIAN: Dimension = [0, 0, 0, 0, 0, 0, 0, 1];
const SPEED: Dimension = [0, 1, -1, 0, 0, 0, 0, 0];
const SPIN: Dimension = [0, 0, -1, 0, 0, 0, 0, 1];
const ACCELERATION: Dimension = [0, 1, -2, 0, 0, 0, 0, 0];
const SPIN_UP: Dimension = [0, 0, -2, 0, 0, 0, 0, 1];
const PASCAL: Dimension = [1, -1, -2, 0, 0, 0, 0, 0];
const KELVIN: Dimension = [0, 0, 0, 0, 1, 0, 0, 0];
const WATT: Dimension = [1, 2, -3, 0, 0, 0, 0, 0];

impl Roles {
    /// Roles from the model's author, or else from units and names; `given` has names of variables and their roles
    /// from the user.
    ///
    /// # Errors
    /// A name that is no variable.
    pub fn of(interface: &Interface, given: &[(String, Role)]) -> Result<Self> {
        let mut of: Vec<Vec<Role>> = interface.variables.iter().map(roles_of).collect();
        part_of_a_loss(interface, &mut of);
        for (name, role) in given {
            let variable = interface.find(name).map_err(|e| Error::file(format!("[roles]: {e}")))?;
            // what the user says replaces what was guessed
            if !given.iter().any(|(n, r)| n == name && of[variable].first() == Some(r)) {
                of[variable].clear();
            }
            of[variable].push(*role);
        }
        // without a name that says so, an input speed is the speed that the machine travels with
        let has = |role: Role| of.iter().any(|r| r.contains(&role));
        if !has(Role::TravelSpeed) {
            for (info, roles) in interface.variables.iter().zip(&mut of) {
                if info.causality == Causality::Input && dimension(info) == Some(SPEED) {
                    roles.push(Role::TravelSpeed);
                }
            }
        }
        Ok(Self { of })
    }

    /// True if a variable has a role.
    pub fn is(&self, variable: usize, role: Role) -> bool {
        self.of.get(variable).is_some_and(|r| r.contains(&role))
    }

    /// The signals of a role: inputs and outputs that have it, else rates and integrals of others; velocities and positions, those
    /// beside them.
    pub fn signals(&self, interface: &Interface, role: Role) -> Vec<Signal> {
        let with = |role: Role, source: Source| -> Vec<Signal> {
            (0..self.of.len())
                .filter(|v| {
                    let causality = interface.variables[*v].causality;
                    matches!(causality, Causality::Input | Causality::Output)
                        && self.of[*v].iter().any(|own| own.serves(role))
                })
                .map(|variable| Signal { source, ..Signal::value(variable) })
                .collect()
        };
        let sources: &[(Role, Source)] = match role {
            Role::Velocity => &[(Role::Position, Source::Rate)],
            Role::Acceleration => &[
                (Role::Velocity, Source::Rate),
                (Role::TravelSpeed, Source::Rate),
                (Role::WheelSpeed, Source::Rate),
            ],
            Role::WheelAngle => &[(Role::WheelSpeed, Source::Integral)],
            Role::TravelDistance => &[(Role::TravelSpeed, Source::Integral)],
            Role::Position => &[(Role::Velocity, Source::Integral)],
            Role::TravelSpeed => &[(Role::TravelDistance, Source::Rate)],
            Role::WheelSpeed => &[(Role::WheelAngle, Source::Rate)],
            _ => &[],
        };
        let mut direct = with(role, Source::Value);
        let made =
            sources.iter().map(|(role, source)| with(*role, *source)).find(|signals| !signals.is_empty());
        let made = made.unwrap_or_default();
        let own = |s: &Signal| interface.variables[s.variable].causality == Causality::Output;
        if role == Role::Velocity {
            // the speed that a machine has by itself is a velocity of it; the one that a rig gives it is none
            direct.extend(with(Role::TravelSpeed, Source::Value).into_iter().filter(own));
        }
        // parts of which no sensor shows a velocity have one, too, and so with positions
        if matches!(role, Role::Velocity | Role::Position) && !direct.is_empty() {
            direct.extend(made.iter().copied().filter(own));
        }
        if direct.is_empty() { made } else { direct }
    }
}

fn dimension(info: &VariableInfo) -> Option<Dimension> {
    info.is_real()
        .then(|| Unit::parse(info.unit.as_deref().unwrap_or("1")).ok())
        .flatten()
        .map(|u| u.exponents)
}

/// What a contact loses as a whole heats it: where a part of a machine tells that, the power of sliding alone, which is in
/// it, is no power that heats.
fn part_of_a_loss(interface: &Interface, of: &mut [Vec<Role>]) {
    let split = |info: &VariableInfo| {
        let name = info.name.to_ascii_lowercase();
        let cut = name.rfind('.').map_or(0, |dot| dot + 1);
        (name[..cut].to_owned(), name[cut..].to_owned())
    };
    let is_signal = |info: &VariableInfo| matches!(info.causality, Causality::Input | Causality::Output);
    let whole: Vec<String> = interface
        .variables
        .iter()
        .filter(|info| is_signal(info) && dimension(info) == Some(WATT))
        .map(split)
        .filter(|(_, name)| name.contains("contact_power_loss"))
        .map(|(part, _)| part)
        .collect();
    for (info, roles) in interface.variables.iter().zip(of) {
        let (part, name) = split(info);
        if info.meaning.is_none() && name.contains("friction_power") && whole.contains(&part) {
            roles.retain(|role| *role != Role::FrictionPower);
        }
    }
}

/// The roles of a variable, from what its author says or from its name, and from its unit.
fn roles_of(info: &VariableInfo) -> Vec<Role> {
    if info.variability == Variability::Constant {
        return Vec::new();
    }
    let Some(dimension) = dimension(info) else { return Vec::new() };
    let role = match info.meaning {
        Some(meaning) => meaning.role,
        None => named(info, dimension),
    };
    let quantity = match dimension {
        _ if info.causality == Causality::Parameter => Role::Other,
        NEWTON | NEWTON_METRE => Role::Force,
        METRE | RADIAN => Role::Position,
        SPEED | SPIN => Role::Velocity,
        ACCELERATION | SPIN_UP => Role::Acceleration,
        PASCAL => Role::Pressure,
        KELVIN => Role::Temperature,
        WATT => Role::FrictionPower,
        _ if info.causality == Causality::Input => Role::Command,
        _ => Role::Other,
    };
    if info.causality == Causality::Input && matches!(dimension, NEWTON | NEWTON_METRE) && is_given(role) {
        let by =
            if info.name.to_ascii_lowercase().contains("brake") { Role::BrakeForce } else { Role::Command };
        return vec![Role::Force, by];
    }
    match role {
        None => vec![quantity],
        Some(Role::Share) => Vec::new(),
        Some(role) if info.causality == Causality::Parameter => vec![role, quantity],
        // the load that a machine is given is no force that something could be added to
        Some(Role::Load) if info.causality == Causality::Input => vec![Role::Load],
        Some(Role::Load) => vec![Role::Load, Role::Force],
        Some(role @ (Role::LongitudinalForce | Role::LateralForce | Role::AligningMoment)) => {
            vec![Role::Force, role]
        }
        Some(Role::SteerAngle) => vec![Role::Position, Role::SteerAngle],
        Some(role) => vec![role],
    }
}

/// Whether a force with this role is one that a brake or another actuator gives: not a load, and no force of a tire.
fn is_given(role: Option<Role>) -> bool {
    matches!(role, None | Some(Role::Force))
}

/// The role that a name tells, of a variable of which nobody says anything.
fn named(info: &VariableInfo, dimension: Dimension) -> Option<Role> {
    let name = info.name.to_ascii_lowercase();
    let last = name.rsplit('.').next().unwrap_or(&name).to_owned();
    let says = |words: &[&str]| words.iter().any(|w| last.contains(w));
    if info.causality == Causality::Parameter {
        // what parts of a machine do, not where they are
        return match dimension {
            _ if says(&["brake", "pad"]) => Some(Role::BrakeGain),
            _ if says(&["stiffness", "spring"]) => Some(Role::Stiffness),
            [0, 0, 0, 0, 0, 0, 0, 0] if says(&["friction", "grip", "mu", "adhesion"]) => Some(Role::Friction),
            _ => None,
        };
    }
    Some(match dimension {
        NEWTON if says(&["load", "force_z", "fz", "f_z", "normal", "vertical"]) => Role::Load,
        NEWTON if says(&["force_x", "fx", "f_x", "longitudinal"]) => Role::LongitudinalForce,
        NEWTON if says(&["force_y", "fy", "f_y", "lateral"]) => Role::LateralForce,
        NEWTON_METRE if says(&["moment_y", "my", "m_y"]) => Role::LongitudinalForce,
        NEWTON_METRE if says(&["moment_z", "mz", "m_z", "aligning"]) => Role::AligningMoment,
        METRE if says(&["distance", "travel"]) && !says(&["suspension", "spring"]) => Role::TravelDistance,
        RADIAN if says(&["slip_angle", "alpha"]) => Role::SlipAngle,
        RADIAN if says(&["camber", "inclination"]) => Role::Camber,
        RADIAN if says(&["steer"]) => Role::SteerAngle,
        RADIAN if says(&["wheel_angle", "drum_angle", "shaft_angle", "rotation", "spin"]) => Role::WheelAngle,
        SPEED if says(&["path", "vehicle", "belt", "travel", "road_speed", "drum"]) || last == "speed" => {
            Role::TravelSpeed
        }
        SPIN if says(&["wheel", "spin", "drum", "roller", "shaft", "rotor", "omega"]) => Role::WheelSpeed,
        _ if dimension == [0; 8] && says(&["slip", "kappa"]) => Role::Slip,
        _ => return None,
    })
}

#[cfg(test)]
mod tests {
    use super::super::placement::Site;
    use super::super::recalled::Natural;
    use super::*;
    use crate::effect::{Attached, find, forms};
    use crate::model::{Access, Model, Native, Settings, Slave, Table, input, output};
    use crate::real;
    use serde::{Deserialize, Serialize};

    /// A contact that creeps without sliding: bristles that leave it bent lose all of the power.
    #[derive(Clone, Default, PartialEq, Serialize, Deserialize)]
    struct Creeping<const WHOLE: bool> {
        slip: f64,
        slip_angle: f64,
        steer: f64,
        road_height: f64,
    }

    macro_rules! shown {
        ($value:expr) => {
            Access::computed($value)
        };
    }

    impl<const WHOLE: bool> Model for Creeping<WHOLE> {
        const NAME: &'static str = "creeping";
        const DESCRIPTION: &'static str = "A contact that loses power";
        fn variables() -> Table<Self> {
            Table::new([
                input("slip", "1", real!(slip), 0.0, "Slip"),
                input("slip_angle", "rad", real!(slip_angle), 0.0, "Slip angle"),
                input("steer", "rad", real!(steer), 0.0, "Steer angle"),
                input("road_height", "m", real!(road_height), 0.0, "Height of the road"),
                output("force_x", "N", shown!(|m: &Self| 5e4 * m.slip), "Longitudinal force"),
                output("force_y", "N", shown!(|m: &Self| -5e4 * m.slip_angle), "Lateral force"),
                output("moment_z", "N.m", shown!(|m: &Self| 1e3 * m.slip_angle), "Aligning moment"),
                output("brake_power", "W", shown!(|_: &Self| 0.0), "Power of the brake"),
                output("friction_power", "W", shown!(|_: &Self| 0.0), "Power of sliding"),
                output(
                    if WHOLE { "contact_power_loss" } else { "something_else" },
                    "W",
                    shown!(|m: &Self| 5e4 * m.slip * m.slip * 20.0),
                    "Power that is lost",
                ),
            ])
        }
        fn step_size(&self) -> f64 {
            1e-3
        }
        fn initialize(&mut self) -> Result<()> {
            Ok(())
        }
        fn step(&mut self, _: f64) -> Result<()> {
            Ok(())
        }
    }

    fn interface<const WHOLE: bool>() -> Interface {
        Native::<Creeping<WHOLE>>::new(&Settings::default()).unwrap().interface().clone()
    }

    fn names(interface: &Interface, roles: &Roles, role: Role) -> Vec<String> {
        roles.signals(interface, role).iter().map(|s| interface.variables[s.variable].name.clone()).collect()
    }

    /// Where an effect may sit: changed variables, and what drives it.
    fn places(interface: &Interface, effect: &'static crate::effect::Effect) -> Vec<(String, Vec<String>)> {
        let roles = Roles::of(interface, &[]).unwrap();
        let all = |causality: Causality| -> Vec<usize> {
            (0..interface.variables.len())
                .filter(|v| interface.variables[*v].causality == causality)
                .collect()
        };
        let (measured, driven) = (all(Causality::Output), all(Causality::Input));
        let site = Site {
            interface,
            roles: &roles,
            measured: &measured,
            driven,
            tunable: Vec::new(),
            natural: Natural::of_ones(interface.variables.len()),
        };
        let name = |v: &usize| interface.variables[*v].name.clone();
        let place = |p: &super::super::placement::Placement| {
            (name(&p.targets[0]), p.drivers.iter().map(|s| name(&s.variable)).collect())
        };
        site.placements(effect).iter().map(place).collect()
    }

    #[test]
    fn what_a_contact_loses_as_a_whole_heats_and_not_its_sliding_alone() {
        let interface = interface::<true>();
        let roles = Roles::of(&interface, &[]).unwrap();
        assert_eq!(names(&interface, &roles, Role::FrictionPower), ["brake_power", "contact_power_loss"]);
        // a user who says otherwise is right
        let given = [("friction_power".to_owned(), Role::FrictionPower)];
        let roles = Roles::of(&interface, &given).unwrap();
        assert!(names(&interface, &roles, Role::FrictionPower).contains(&"friction_power".to_owned()));
        // in its place without the whole loss
        let without = self::interface::<false>();
        let roles = Roles::of(&without, &[]).unwrap();
        assert!(names(&without, &roles, Role::FrictionPower).contains(&"friction_power".to_owned()));
        // so heat comes from a contact that only creeps: P = 5e4 * 0.01^2 * 20 m/s = 100 W, E = P t
        let heating = find("frictional-heating").unwrap();
        let at = places(&interface, heating);
        assert!(at.iter().all(|(_, by)| by[0] != "friction_power"), "{at:?}");
        assert!(at.contains(&("force_x".into(), vec!["contact_power_loss".into()])), "{at:?}");
        let slave = Box::new(Native::<Creeping<true>>::new(&Settings::default()).unwrap());
        let roles = Roles::of(&interface, &[]).unwrap();
        let power = roles.signals(&interface, Role::FrictionPower)[1];
        let chosen = |value: f64| crate::effect::Chosen { value, range: (0.0, 1e9), unit: None };
        let attachment = crate::effect::Attachment {
            effect: heating,
            target: interface.find("force_x").unwrap(),
            drivers: vec![power],
            parameters: vec![chosen(1e-4), chosen(1e6), chosen(0.0)],
        };
        let mut slave = Attached::new(slave, vec![attachment]).unwrap();
        slave.set(0, 0.01).unwrap();
        slave.start(0.0, None).unwrap();
        slave.finish_start().unwrap();
        for k in 0..1000 {
            slave.step(f64::from(k) * 1e-3, 1e-3).unwrap();
        }
        let force = slave.get(interface.find("force_x").unwrap()).unwrap();
        assert!((force - 500.0 * (1.0 - 0.01_f64.tanh())).abs() < 1e-3, "{force}");
    }

    #[test]
    fn the_speed_of_a_vehicle_drives_friction_and_that_of_a_rig_does_not() {
        let roles = |model: &str| {
            let subject = super::super::subject::Subject::load(model, &Settings::default()).unwrap();
            let roles = Roles::of(&subject.interface, &[]).unwrap();
            names(&subject.interface, &roles, Role::Velocity)
        };
        let vehicle = roles("magic-formula-corner");
        assert!(vehicle.contains(&"vehicle_speed".to_owned()), "{vehicle:?}");
        let rig = roles("magic-formula-flat-track");
        assert!(!rig.contains(&"path_speed".to_owned()), "{rig:?}");
    }

    #[test]
    fn a_steering_gives_way_at_an_angle_of_the_wheel_by_what_turns_it() {
        let interface = interface::<true>();
        let all: Vec<_> = forms("steering-compliance").flat_map(|e| places(&interface, e)).collect();
        let at = |target: &str, driver: &str| (target.to_owned(), vec![driver.to_owned()]);
        let right = [
            at("slip_angle", "moment_z"),
            at("slip_angle", "force_y"),
            at("steer", "moment_z"),
            at("steer", "force_y"),
        ];
        // neither a road that gives way to a side force nor an angle that gives way to a drive force
        assert!(all.len() == 4 && right.iter().all(|p| all.contains(p)), "{all:?}");
    }
}
