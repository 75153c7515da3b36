//! The variables of the Magic Formula tire: its coefficients under the names that tire property files have for them, and
//! what it tells besides force and moment on the rim.

use super::{Bound, Coefficients, FIELDS, Field, MagicFormula};
use crate::model::{
    Access, Purpose, Role, Table, Variable, boolean_parameter, local, output, parameter, text_parameter,
};
use crate::{boolean, lens, real, text};

impl MagicFormula {
    #[rustfmt::skip] // a row is a line
    pub(super) fn table() -> Table<Self> {
        Table::new([
            output("belt_deflection", "m", real!(state.penetration), "How far the tire is pressed in, along the wheel's plane; negative in the air"),
            output("normal_force", "N", real!(state.contact.force.z), "Force of the road on the tire along the road's normal").nominal(1000.0).role(Role::Load),
            output("relaxed_slip", "1", real!(state.slip[0]), "Longitudinal slip behind the relaxation, which the forces follow").role(Role::Slip),
            output("relaxed_slip_angle", "rad", real!(state.slip[1]), "Slip angle behind the relaxation, which the forces follow").role(Role::SlipAngle),
            output("contact_power_loss", "W", real!(state.power_loss), "Power of the forces at the contact point that its sliding takes").nominal(1000.0).role(Role::FrictionPower),
            output("contact_energy_loss", "J", real!(state.energy_loss), "Energy of that since the start").nominal(1e4),
            local("wheel_slip", "1", real!(state.wheel_slip[0]), "Longitudinal slip of the wheel, -Vsx / |Vx| at the contact point; 0 at rest"),
            local("wheel_slip_angle", "rad", real!(state.wheel_slip[1]), "Slip angle of the wheel, atan2(Vsy, |Vx|) at the contact point"),
            local("relaxation_length_x", "m", real!(state.relaxation[0]), "Relaxation length of longitudinal slip"),
            local("relaxation_length_y", "m", real!(state.relaxation[1]), "Relaxation length of the slip angle"),
            local("pneumatic_trail", "m", real!(state.trail), "Pneumatic trail"),
            local("outside_range", "", Access::computed_boolean(|m: &Self| m.state.outside), "Load, slip or an angle is outside the range that the coefficients hold for; the formula gets the end of the range"),
            text_parameter("tire_name", text!(name), "Passenger car, round numbers (225 mm)", "Name of the tire, for reports"),
            boolean_parameter("mirrored", boolean!(mirrored), false, "The coefficients are of a tire for the other side of the vehicle"),
            parameter("gravity", "m/s2", real!(gravity), 9.81, "Gravity of the rig; the tire has no mass").range(0.0, 100.0).purpose(Purpose::Constant),
            parameter("low_speed_damping", "N.s/m", real!(low_speed_damping), 770.0, "Damping of the tire's deflection along and across at standstill; it fades out up to VXLOW. No tire property file has it; the default is a placeholder").range(0.0, 1e5).purpose(Purpose::Data).tunable(),
        ])
        .part("", lens!(coefficients), Coefficients::rows())
    }
}

impl Coefficients {
    /// Those that an equation uses.
    pub(super) fn rows() -> Table<Self> {
        Table::new(FIELDS.iter().filter(|field| field.is_used()).map(row))
    }
}

fn row(field: &'static Field) -> Variable<Coefficients> {
    let unit = field.unit;
    let mut row = parameter(
        field.name,
        unit,
        Access::real(field.get, field.set),
        field.default,
        field.description.trim_end_matches('.'),
    );
    if matches!(field.bound, Bound::NotNegative | Bound::Positive) {
        row = row.min(0.0);
    }
    match field.name {
        "LMUX" | "LMUY" => row = row.role(Role::Friction),
        "LKX" | "LKY" | "LCZ" => row = row.role(Role::Stiffness),
        _ => {}
    }
    // A few recordings tell scales; the curves behind them take the whole test programme of the file.
    let is_scale = field.section == "SCALING_COEFFICIENTS";
    let is_numeric = matches!(field.name, "VXLOW");
    row = row.purpose(match is_numeric {
        true => Purpose::Numerics,
        false if is_scale => Purpose::Physics,
        false => Purpose::Data,
    });
    // whether the tire is given by its stiffness is told at the start
    if is_scale { row.tunable() } else { row }
}
