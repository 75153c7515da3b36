//! The variables of the super-elastic tire: its parameters, and what it tells besides force and moment on the rim.
//!
//! Defaults are those of the source's property file for a Continental SE 18x7-8, as read in the documentation.

use super::SuperElastic;
use super::coupling::COUPLINGS;
use super::parameters::{ADHESIONS, LAWS, RATES, RESISTANCES, RIM_FORCES, SHARINGS};
use crate::model::{
    Access, Purpose, Role, Table, integer_parameter, local, output, parameter, text_parameter,
};
use crate::{integer, real, text};

impl SuperElastic {
    #[rustfmt::skip] // a row is a line
    pub(super) fn table() -> Table<Self> {
        Table::new([
            output("tire_deflection", "m", Access::computed(|m: &Self| m.parameters.radius - m.state.height), "How much lower the wheel's centre is over the road below it than without load; negative in the air"),
            output("radial_force", "N", real!(state.sums.radial[1]), "Vertical part of the forces of the radial springs and dampers, as printed the wheel load (4-64)").nominal(1000.0).role(Role::Load),
            output("contact_force", "N", real!(state.sums.contact[1]), "Vertical part of the forces of the road on the elements").nominal(1000.0).role(Role::Load),
            output("traction", "N", real!(state.traction), "Force of the brush along the road (2-49)").nominal(1000.0).role(Role::LongitudinalForce),
            output("rolling_resistance_force", "N", real!(state.resistance), "Rolling resistance; positive where it holds back a wheel that rolls forward").nominal(100.0),
            output("relaxed_slip", "1", real!(state.slip), "Longitudinal slip behind its lag, which the force follows (2-16)").role(Role::Slip),
            output("contact_power_loss", "W", real!(state.power_loss), "Power that the slip of the brush takes").nominal(1000.0).role(Role::FrictionPower),
            output("contact_energy_loss", "J", real!(state.energy_loss), "Energy of that since the start").nominal(1e4),
            output("rubber_power_loss", "W", real!(state.sums.loss), "Power that dampers of the rubber and of the contact, and the rubber's hysteresis, take at this instant").nominal(100.0).role(Role::Other),
            local("wheel_slip", "1", real!(state.wheel_slip), "Longitudinal slip of the wheel (2-4): rolling less travelling, over the faster of both"),
            local("elements_in_contact", "", Access::computed_integer(|m: &Self| m.state.sums.touching as i32), "Elements that touch the road"),
            local("contact_penetration", "m", real!(state.sums.penetration), "Largest penetration of a contact point into the road"),
            local("element_stiffness", "N/m", real!(state.coefficients.stiffness), "Stiffness of an element that holds now (k_ce)"),
            local("element_damping", "N.s/m", real!(state.coefficients.damping), "Damping of an element that holds now (c_ce)"),
            text_parameter("tire_name", text!(name), "Continental SE 18x7-8 (Oh 2017, as printed)", "Name of the tire, for reports"),
            parameter("tire_radius", "m", real!(parameters.radius), 0.2265, "Radius without load (r0)").range(0.02, 2.0),
            parameter("tire_width", "m", real!(parameters.width), 0.152, "Width of the tread, for pictures: the source prints 152 and 187 mm").range(0.01, 1.5).purpose(Purpose::Data),
            parameter("element_thickness", "m", real!(parameters.element_thickness), 0.005, "Thickness of a contact element along its ray (l_ce)").range(1e-4, 0.5),
            integer_parameter("elements", integer!(parameters.elements), 45, "Contact elements around the wheel (N)").range(4.0, 2000.0).purpose(Purpose::Numerics),
            integer_parameter("contact_points", integer!(parameters.contact_points), 3, "Contact points of an element along the tread; the source leaves their number and places open").range(1.0, 15.0).purpose(Purpose::Numerics),
            parameter("gap_angle", "rad", real!(parameters.gap_angle), std::f64::consts::PI / 180.0, "Angle between the outer contact points of neighbouring elements (ANG_INSIDE_CE, which the source does not explain)").range(0.0, 1.5),
            parameter("rubber_mass", "kg", real!(parameters.rubber_mass), 19.8, "Mass of all contact elements: that of the wheel, 26.1 kg, less that of the rim, 6.3 kg. The rim's belongs to the hub").range(1e-3, 1e4),
            parameter("element_radial_stiffness", "N/m", real!(parameters.stiffness), 1.22e5, "Radial stiffness of an element (k_ce), the constant one").range(1.0, 1e10).tunable().role(Role::Stiffness),
            parameter("element_radial_damping", "N.s/m", real!(parameters.damping), 280.0, "Radial damping of an element (c_ce), the constant one").range(0.0, 1e7).tunable(),
            parameter("stiffness_factor", "1", real!(parameters.stiffness_factor), 1.0, "Factor on the stiffness for tires of other makers (COR_FACTOR_RSTIFF)").range(0.01, 100.0).tunable().role(Role::Stiffness),
            integer_parameter("stiffness_law", integer!(parameters.stiffness_law), 1, "How the stiffness depends on the load").items(LAWS).purpose(Purpose::Data),
            parameter("stiffness_load_exponent", "1", real!(parameters.stiffness_load_exponent), 0.0, "Exponent of the load over reference_load in the stiffness").range(-5.0, 5.0).tunable(),
            text_parameter("stiffness_points", text!(parameters.stiffness_points), "", "Points 'load stiffness; ...' in N and N/m for the table").purpose(Purpose::Data),
            integer_parameter("damping_law", integer!(parameters.damping_law), 1, "How the damping depends on load and speed").items(LAWS).purpose(Purpose::Data),
            parameter("damping_load_exponent", "1", real!(parameters.damping_load_exponent), 0.0, "Exponent of the load over reference_load in the damping").range(-5.0, 5.0).tunable(),
            parameter("damping_speed_exponent", "1", real!(parameters.damping_speed_exponent), 0.0, "Exponent of the speed over reference_speed in the damping; negative: it falls with the speed, and not below a tenth of the reference any more").range(-5.0, 5.0).tunable(),
            text_parameter("damping_points", text!(parameters.damping_points), "", "Points 'load speed damping; ...' in N, m/s and N.s/m for the table, one for each load and each speed").purpose(Purpose::Data),
            parameter("reference_load", "N", real!(parameters.reference_load), 6504.0, "Load at which the constants hold in power laws").range(1.0, 1e6).purpose(Purpose::Data),
            parameter("reference_speed", "m/s", real!(parameters.reference_speed), 2.0, "Speed at which the constants hold in power laws").range(1e-3, 100.0).purpose(Purpose::Data),
            parameter("characteristic_load", "N", real!(parameters.characteristic_load), 0.0, "Load that stiffness and damping are taken at, as in the source one for a run; 0: the present one behind a lag").range(0.0, 1e6).purpose(Purpose::Data),
            parameter("characteristic_lag", "s", real!(parameters.characteristic_lag), 1.0, "Time constant of that lag: a shorter one lets the stiffness answer within an oscillation, which the source's curves are not meant for").range(1e-3, 1e3).purpose(Purpose::Data),
            parameter("relaxing_stiffness", "N/m", real!(parameters.relaxing_stiffness), 0.0, "Stiffness beside that of an element that relaxes: a standard linear solid. Not in the source (0)").range(0.0, 1e10).tunable().role(Role::Stiffness),
            parameter("relaxing_time", "s", real!(parameters.relaxing_time), 0.05, "Time in which it relaxes").range(1e-5, 1e4).tunable(),
            parameter("friction_force", "N", real!(parameters.friction_force), 0.0, "Friction in the rubber of an element, which its damping does not depend on the frequency with. Not in the source (0)").range(0.0, 1e6).tunable().role(Role::Friction),
            parameter("friction_stiffness", "N/m", real!(parameters.friction_stiffness), 1e5, "Stiffness of the rubber up to that friction").range(1.0, 1e10).tunable(),
            integer_parameter("coupling", integer!(parameters.coupling), 1, "How neighbouring elements are coupled").items(COUPLINGS).purpose(Purpose::Numerics),
            parameter("coupling_stiffness", "N/m", real!(parameters.coupling_stiffness), 1e6, "Stiffness between neighbours along the chord between them (k_t), with a coupling; the source gives no number").range(0.0, 1e10).tunable().role(Role::Stiffness),
            parameter("coupling_damping", "N.s/m", real!(parameters.coupling_damping), 0.0, "Damping of that (c_t)").range(0.0, 1e7).tunable(),
            parameter("bending_stiffness", "N.m/rad", real!(parameters.bending_stiffness), 10.0, "Stiffness against a bend from chord to chord (kt_y), with bending; the source gives no number").range(0.0, 1e7).tunable().role(Role::Stiffness),
            parameter("bending_damping", "N.m.s/rad", real!(parameters.bending_damping), 0.0, "Damping of that (ct_y)").range(0.0, 1e5).tunable(),
            parameter("contact_stiffness", "N", real!(parameters.contact.force), 35000.0, "Force of an element or of a point at a penetration of 1 mm").range(1.0, 1e9).purpose(Purpose::Numerics),
            parameter("contact_exponent", "1", real!(parameters.contact.exponent), 1.9, "Exponent of the penetration").range(1.0, 5.0).purpose(Purpose::Numerics),
            parameter("contact_damping", "N.s/m", real!(parameters.contact.damping), 700.0, "Damping of the contact at full penetration").range(0.0, 1e7).purpose(Purpose::Numerics),
            parameter("contact_full_damping", "m", real!(parameters.contact.full_damping), 1e-4, "Penetration from which on all of that damping acts").range(1e-7, 0.1).purpose(Purpose::Numerics),
            integer_parameter("contact_stiffness_of", integer!(parameters.contact_of), 1, "What stiffness and damping of the contact are of; the source does not say").items(SHARINGS).purpose(Purpose::Numerics),
            parameter("slip_stiffness", "N", real!(parameters.slip_stiffness), 5000.0, "Slope of the longitudinal force at no slip (C_s). The source prints 5 with a unit that cannot be; 5 kN is about a tenth of what solid tires have").range(1.0, 1e7).tunable().role(Role::Stiffness),
            parameter("friction_max", "1", real!(parameters.friction_max), 0.94, "Friction coefficient without slip").range(0.0, 10.0).tunable().role(Role::Friction),
            parameter("friction_min", "1", real!(parameters.friction_min), 0.85, "Friction coefficient at a slip of 1").range(0.0, 10.0).tunable().role(Role::Friction),
            parameter("relaxation_length", "m", real!(parameters.relaxation_length), 0.01, "Way in which the slip builds up").range(1e-4, 10.0).tunable(),
            integer_parameter("relaxation_rate", integer!(parameters.relaxation_rate), 1, "The speed with which the slip follows").items(RATES).purpose(Purpose::Numerics),
            integer_parameter("adhesion", integer!(parameters.adhesion), 1, "Where the adhering share of the contact is from").items(ADHESIONS).purpose(Purpose::Numerics),
            parameter("rolling_resistance", "1", real!(parameters.rolling_resistance), 0.015, "Rolling resistance over the wheel load (f_R)").range(0.0, 1.0).tunable(),
            integer_parameter("rolling_resistance_as", integer!(parameters.resistance_as), 1, "What resists rolling").items(RESISTANCES).purpose(Purpose::Numerics),
            integer_parameter("rim_force", integer!(parameters.rim_force), 1, "What is summed up to force and moment on the rim").items(RIM_FORCES).purpose(Purpose::Numerics),
            parameter("gravity", "m/s2", real!(parameters.gravity), 9.81, "Gravity").range(0.0, 100.0).purpose(Purpose::Constant),
        ])
    }
}
