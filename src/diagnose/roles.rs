//! What the variables of a model are: roles from units and names, and signals made of others.

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
    /// Roles from units and names; `given` has names of variables and their roles from the user.
    ///
    /// # Errors
    /// A name that is no variable.
    pub fn of(interface: &Interface, given: &[(String, Role)]) -> Result<Self> {
        let mut of: Vec<Vec<Role>> = interface.variables.iter().map(guess).collect();
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

    /// The signals of a role: inputs and outputs that have it, else rates and integrals of others.
    pub fn signals(&self, interface: &Interface, role: Role) -> Vec<Signal> {
        let with = |role: Role, source: Source| -> Vec<Signal> {
            (0..self.of.len())
                .filter(|v| {
                    let causality = interface.variables[*v].causality;
                    matches!(causality, Causality::Input | Causality::Output)
                        && self.of[*v].iter().any(|own| own.serves(role))
                })
                .map(|variable| Signal { variable, source })
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
        let direct = with(role, Source::Value);
        let made =
            sources.iter().map(|(role, source)| with(*role, *source)).find(|signals| !signals.is_empty());
        if direct.is_empty() { made.unwrap_or_default() } else { direct }
    }
}

fn dimension(info: &VariableInfo) -> Option<Dimension> {
    info.is_real()
        .then(|| Unit::parse(info.unit.as_deref().unwrap_or("1")).ok())
        .flatten()
        .map(|u| u.exponents)
}

fn guess(info: &VariableInfo) -> Vec<Role> {
    if info.variability == Variability::Constant {
        return Vec::new();
    }
    let Some(dimension) = dimension(info) else { return Vec::new() };
    let name = info.name.to_ascii_lowercase();
    let last = name.rsplit('.').next().unwrap_or(&name).to_owned();
    let says = |words: &[&str]| words.iter().any(|w| last.contains(w));
    if info.causality == Causality::Parameter {
        // what parts of a machine do, not where they are
        let mut roles = match dimension {
            _ if says(&["brake", "pad"]) => vec![Role::BrakeGain],
            _ if says(&["stiffness", "spring"]) => vec![Role::Stiffness],
            [0, 0, 0, 0, 0, 0, 0, 0] if says(&["friction", "grip", "mu", "adhesion"]) => vec![Role::Friction],
            _ => Vec::new(),
        };
        roles.push(Role::Other);
        return roles;
    }
    match dimension {
        // the load that a machine is given is no force that something could be added to
        NEWTON if says(&["load", "force_z", "fz", "f_z", "normal", "vertical"]) => match info.causality {
            Causality::Input => vec![Role::Load],
            _ => vec![Role::Load, Role::Force],
        },
        NEWTON if says(&["force_x", "fx", "f_x", "longitudinal"]) => {
            vec![Role::Force, Role::LongitudinalForce]
        }
        NEWTON if says(&["force_y", "fy", "f_y", "lateral"]) => vec![Role::Force, Role::LateralForce],
        NEWTON_METRE if says(&["moment_y", "my", "m_y"]) => vec![Role::Force, Role::LongitudinalForce],
        NEWTON | NEWTON_METRE => vec![Role::Force],
        METRE if says(&["distance", "travel"]) && !says(&["suspension", "spring"]) => {
            vec![Role::TravelDistance]
        }
        METRE => vec![Role::Position],
        RADIAN if says(&["slip_angle", "alpha"]) => vec![Role::SlipAngle],
        RADIAN if says(&["camber", "inclination"]) => vec![Role::Camber],
        RADIAN if says(&["wheel_angle", "drum_angle", "shaft_angle", "rotation", "spin"]) => {
            vec![Role::WheelAngle]
        }
        RADIAN => vec![Role::Position],
        SPEED if says(&["path", "vehicle", "belt", "travel", "road_speed", "drum"]) || last == "speed" => {
            vec![Role::TravelSpeed]
        }
        SPEED => vec![Role::Velocity],
        SPIN if says(&["wheel", "spin", "drum", "roller", "shaft", "rotor", "omega"]) => {
            vec![Role::WheelSpeed]
        }
        SPIN => vec![Role::Velocity],
        ACCELERATION | SPIN_UP => vec![Role::Acceleration],
        PASCAL => vec![Role::Pressure],
        KELVIN => vec![Role::Temperature],
        WATT => vec![Role::FrictionPower],
        _ if dimension == [0; 8] && says(&["slip", "kappa"]) => vec![Role::Slip],
        _ => vec![Role::Other],
    }
}
