//! What is concealed: where the car differs from what is believed of it.

use super::parameters::{Parameters, rounded};
use crate::random::Random;

/// What is offered.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Offer {
    PadOnset,
    CaliperLag,
    FallingBranch,
    Column,
    /// The same where both tracks have the same friction: nothing turns the wheels to one side.
    ColumnAlike,
    WheelInertia,
    ControllerRadius,
    Friction,
    CentreHeight,
    AntiDive,
    Coupling,
    ScrubRadius,
    PadFriction,
    OnsetAndColumn,
    Damping,
    Stiffness,
    MasterPressure,
    MassDistribution,
    HubInertia,
    /// Friction of the road of one kind of runs.
    OneRoad,
    /// Nothing but another friction along the road.
    Nothing,
}

/// How often each comes in a study.
pub(crate) const OFFERS: [(Offer, usize); 21] = [
    (Offer::PadOnset, 2),
    (Offer::CaliperLag, 2),
    (Offer::FallingBranch, 3),
    (Offer::Column, 3),
    (Offer::ColumnAlike, 2),
    (Offer::WheelInertia, 2),
    (Offer::ControllerRadius, 3),
    (Offer::Friction, 2),
    (Offer::CentreHeight, 2),
    (Offer::AntiDive, 2),
    (Offer::Coupling, 2),
    (Offer::ScrubRadius, 2),
    (Offer::PadFriction, 3),
    (Offer::OnsetAndColumn, 2),
    (Offer::Damping, 1),
    (Offer::Stiffness, 1),
    (Offer::MasterPressure, 2),
    (Offer::MassDistribution, 2),
    (Offer::HubInertia, 2),
    (Offer::OneRoad, 2),
    (Offer::Nothing, 6),
];

/// Column of a car whose driver holds the steering wheel as people do, and as a rig would \[N/m\].
const COLUMNS: [(f64, f64); 2] = [(5e5, 7e5), (11e6, 13e6)];

impl Offer {
    /// Names of the causes, each with the parameters that a right diagnosis may name.
    pub(crate) fn causes(self) -> Vec<(&'static str, Vec<String>)> {
        let onset = || ("pad_onset", brakes(&["onset_friction_share", "onset_time"], false));
        let column = || ("column_stiffness", owned(&["car.column_stiffness", "car.column_damping"]));
        match self {
            Self::PadOnset => vec![onset()],
            Self::CaliperLag => vec![("caliper_lag", brakes(&["caliper_lag"], false))],
            Self::FallingBranch => vec![("falling_branch", tires(&["PCX1", "LCX"]))],
            Self::Column | Self::ColumnAlike => vec![column()],
            Self::WheelInertia => {
                let names =
                    ["car.front_wheel_inertia", "car.front_wheel_mass", "car.front_wheel_transverse_inertia"];
                vec![("wheel_inertia", owned(&names))]
            }
            Self::ControllerRadius => {
                vec![("controller_radius", owned(&["abs.rolling_radius_1", "abs.rolling_radius_2"]))]
            }
            Self::Friction => {
                let mut names = tires(&["LMUX", "LMUY", "PDX1", "PDY1"]);
                names.push("car.road_friction".to_owned());
                vec![("friction_level", names)]
            }
            Self::CentreHeight => vec![("centre_of_mass_height", owned(&["car.centre_of_mass_z"]))],
            Self::AntiDive => vec![("anti_dive", owned(&["car.front_anti_dive"]))],
            Self::Coupling => vec![("coupling", owned(&["car.coupling_damping"]))],
            Self::ScrubRadius => vec![("scrub_radius", owned(&["car.front_scrub_radius"]))],
            Self::PadFriction => {
                vec![("pad_friction", brakes(&["friction", "piston_area", "friction_radius"], true))]
            }
            Self::OnsetAndColumn => vec![onset(), column()],
            Self::Damping => vec![("front_damping", owned(&["car.front_damper"]))],
            Self::Stiffness => vec![("front_stiffness", owned(&["car.front_spring_stiffness"]))],
            Self::MasterPressure => vec![("master_pressure", owned(&["driver_pressure"]))],
            Self::MassDistribution => {
                vec![("mass_distribution", owned(&["car.centre_of_mass_x", "car.vehicle_mass"]))]
            }
            Self::HubInertia => {
                let names = ["car.front_carrier_inertia", "car.front_wheel_transverse_inertia"];
                vec![("hub_inertia", owned(&names))]
            }
            // where that is, only the case knows
            Self::OneRoad => vec![("friction_level_of_one_road", Vec::new())],
            Self::Nothing => Vec::new(),
        }
    }

    /// Kind of a case that has it.
    pub(crate) fn kind(self) -> &'static str {
        match self {
            Self::Nothing => "null",
            Self::ColumnAlike => "hidden",
            Self::OnsetAndColumn => "two",
            _ => "clear",
        }
    }

    /// Sets the car and what is believed of it apart.
    pub(crate) fn conceal(self, truth: &mut Parameters, belief: &mut Parameters, random: &mut Random) {
        let more = |random: &mut Random, low: f64, high: f64| 1.0 + random.within(low, high) * random.sign();
        let onset = |truth: &mut Parameters, belief: &mut Parameters, random: &mut Random| {
            let (share, time) = (random.within(0.2, 0.4), random.within(0.15, 0.3));
            for (pads, believed) in truth.brakes.iter_mut().zip(&mut belief.brakes) {
                (pads.onset_share, pads.onset_time) = (share, time);
                (believed.onset_share, believed.onset_time) = (1.0, 0.0);
            }
        };
        let column = |truth: &mut Parameters, belief: &mut Parameters, random: &mut Random| {
            let [soft, stiff] = COLUMNS;
            truth.column_stiffness = random.within(soft.0, soft.1);
            belief.column_stiffness = random.within(stiff.0, stiff.1);
        };
        match self {
            Self::PadOnset => onset(truth, belief, random),
            Self::CaliperLag => {
                let lag = random.within(0.015, 0.03);
                truth.brakes.iter_mut().for_each(|pads| pads.lag = lag);
            }
            Self::FallingBranch => {
                belief.tire.shape = random.within(1.3, 1.45);
                truth.tire.shape = belief.tire.shape + random.within(0.2, 0.35);
            }
            Self::Column | Self::ColumnAlike => column(truth, belief, random),
            Self::WheelInertia => {
                let factor = 1.0 + random.within(0.15, 0.25);
                truth.front_wheel_inertia *= factor;
                if random.chance(0.5) {
                    truth.front_wheel_mass *= factor;
                    truth.front_wheel_transverse_inertia *= factor;
                }
            }
            // in proportion for all wheels it would be none
            Self::ControllerRadius => truth.rolling_radius[0] *= more(random, 0.02, 0.04),
            Self::Friction => {
                let factor = more(random, 0.08, 0.15);
                if random.chance(0.5) {
                    truth.road_friction *= factor;
                } else {
                    truth.tire.friction = truth.tire.friction.map(|f| f * factor);
                }
            }
            Self::CentreHeight => truth.centre_of_mass_z *= 1.0 + random.within(0.08, 0.15),
            Self::AntiDive => truth.front_anti_dive += random.within(0.15, 0.25),
            Self::Coupling => truth.coupling_damping = random.log_within(30.0, 80.0),
            Self::ScrubRadius => truth.front_scrub_radius += random.within(0.01, 0.02) * random.sign(),
            Self::PadFriction => truth.brakes[0].friction *= more(random, 0.08, 0.15),
            Self::OnsetAndColumn => {
                onset(truth, belief, random);
                column(truth, belief, random);
            }
            Self::Damping => truth.front_damping *= more(random, 0.3, 0.45),
            Self::Stiffness => truth.front_spring_stiffness *= more(random, 0.2, 0.3),
            Self::MasterPressure => truth.master_gain = 1.0 + random.within(0.06, 0.1),
            Self::MassDistribution => {
                truth.vehicle_mass += random.within(60.0, 110.0);
                truth.centre_of_mass_x += random.within(0.03, 0.06) * random.sign();
            }
            Self::HubInertia => {
                let factor = random.within(1.4, 1.8);
                truth.front_carrier_inertia *= factor;
                truth.front_wheel_transverse_inertia *= factor;
            }
            Self::OneRoad | Self::Nothing => {}
        }
    }
}

/// A kind of runs whose road has another friction, and its factor.
pub(crate) fn other_road(random: &mut Random) -> (&'static str, f64) {
    let kinds = ["flat", "fast", "slabs"];
    let kind = kinds[random.below(kinds.len())];
    (kind, rounded(1.0 + random.within(0.1, 0.18) * random.sign()))
}

fn owned(names: &[&str]) -> Vec<String> {
    names.iter().map(|name| (*name).to_owned()).collect()
}

/// Parameters of the brakes, of all or those in front.
fn brakes(names: &[&str], front: bool) -> Vec<String> {
    let wheels: &[&str] = if front { &["fl", "fr"] } else { &["fl", "fr", "rl", "rr"] };
    wheels.iter().flat_map(|wheel| names.iter().map(move |name| format!("brake_{wheel}.{name}"))).collect()
}

/// Parameters of the tires.
fn tires(names: &[&str]) -> Vec<String> {
    ["front", "rear"]
        .iter()
        .flat_map(|axle| names.iter().map(move |name| format!("car.{axle}_tire.{name}")))
        .collect()
}
