//! The parameters of the Magic Formula tire: its coefficients under the names that tire property files have for them.

use super::{Bound, Coefficients, FIELDS, Field, Formula};
use crate::model::{Access, Purpose, Role, Table, Variable, boolean_parameter, parameter, text_parameter};
use crate::{boolean, lens, real, text};

impl Formula {
    #[rustfmt::skip] // a row is a line
    pub(super) fn table() -> Table<Self> {
        Table::new([
            text_parameter("tire_name", text!(name), "Passenger car, round numbers (225 mm)", "Name of the tire, for reports"),
            boolean_parameter("mirrored", boolean!(mirrored), false, "The coefficients are of a tire for the other side of the vehicle"),
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
