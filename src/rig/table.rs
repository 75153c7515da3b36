//! The rows that every rig's variable table shares: what the tire on it measures, its parameters, and
//! those of the road.

/// What became of the pressure distribution.
pub(super) const PRESSURE_STATES: &[(&str, &str)] = &[
    ("air", "no contact"),
    ("regular", "normal force and lateral-axis moment are met, no pressure is negative"),
    ("negative", "normal force and moment are met with negative pressure in some bristles"),
    ("limited", "tilt limited by limit_pressure_tilt: the normal force is met, the moment is not"),
    ("singular", "all bristles in contact have the same x: the normal force is met, the moment is not"),
    ("between_bristles", "the belt touches the road between bristles: none carries anything"),
];

/// The table of a rig with a [`MountedTire`](super::MountedTire) in its field `tire`: the rig's own
/// rows with those of the tire between them.
macro_rules! tire_table {
    (
        inputs: [$($input:expr),* $(,)?],
        outputs: [$($output:expr),* $(,)?],
        locals: [$($local:expr),* $(,)?],
        parameters: [$($parameter:expr),* $(,)?],
        appended: [$($appended:expr),* $(,)?],
        road: [$($road:expr),* $(,)?] $(,)?
    ) => {{
        use $crate::model::{Access, boolean_parameter, integer_parameter, local, output, parameter, text_parameter};
        use $crate::rig::table::{PRESSURE_STATES, computed};
        use $crate::{boolean, integer, real};
        &[
            $($input,)*
                output("force_x", "N", real!(tire.force.x), "Longitudinal force of the tire on the rim, H axes").nominal(1000.0),
                output("force_y", "N", real!(tire.force.y), "Lateral force of the tire on the rim, H axes").nominal(1000.0),
                output("force_z", "N", real!(tire.force.z), "Vertical force of the tire on the rim, H axes: the normal force on the road less the weight of the belt").nominal(1000.0),
                output("moment_x", "N.m", real!(tire.moment.x), "Overturning moment of the tire on the rim about the wheel centre, H axes").nominal(100.0),
                output("moment_y", "N.m", real!(tire.moment.y), "Moment about the lateral axis of the tire on the rim, H axes").nominal(100.0),
                output("moment_z", "N.m", real!(tire.moment.z), "Aligning moment of the tire on the rim, H axes").nominal(100.0),
                output("belt_deflection", "m", real!(tire.state.patch.penetration), "Penetration of the belt shell into the road (f_G)"),
                output("contact_length_left", "m", computed!(m: m.tire.contact_length(0.0)), "Length of the contact stripe with the largest y (l_mat 1)"),
                output("contact_length_center", "m", computed!(m: m.tire.contact_length(0.5)), "Length of the middle contact stripe"),
                output("contact_length_right", "m", computed!(m: m.tire.contact_length(1.0)), "Length of the contact stripe with the smallest y (l_mat n)"),
                output("patch_force_x", "N", real!(tire.state.patch.force.x), "Longitudinal force of the patch on the belt, contact frame (F_LGKx)").nominal(1000.0).without_derivative(),
                output("patch_force_y", "N", real!(tire.state.patch.force.y), "Lateral force of the patch on the belt, contact frame (F_LGKy)").nominal(1000.0).without_derivative(),
                output("patch_force_z", "N", real!(tire.state.patch.force.z), "Normal force of the patch on the belt (F_LGKz)").nominal(1000.0),
                output("sliding_share", "1", real!(tire.state.patch.sliding_share), "Bristles that slide over bristles in contact").without_derivative(),
                output("sliding_distance", "m", real!(tire.state.sliding_distance), "Distance slid since the start, mean over the normal force"),
                output("friction_power", "W", real!(tire.state.patch.friction_power), "Power of the friction of bristles that slide, at this instant; contact_power_loss has all that is lost").nominal(1000.0).without_derivative(),
            $($output,)*
            $($local,)*
                local("belt_camber", "rad", real!(tire.state.belt.angles.x), "Camber of the belt (phi_G0x)"),
                local("belt_yaw", "rad", computed!(m: m.tire.state.belt.angles.z - m.tire.rim.angles.z), "Steer angle of the belt minus that of the rim (phi_G0z - phi_F0z)"),
                local("belt_windup", "rad", computed!(m: m.tire.rim.angles.y - m.tire.state.belt.angles.y), "Spin angle of the rim minus that of the belt"),
                local("belt_offset_x", "m", computed!(m: m.tire.belt_offset().x), "Belt centre from wheel centre, H axes"),
                local("belt_offset_y", "m", computed!(m: m.tire.belt_offset().y), "Belt centre from wheel centre, H axes"),
                local("belt_offset_z", "m", computed!(m: m.tire.belt_offset().z), "Belt centre from wheel centre, H axes"),
                local("patch_moment_x", "N.m", real!(tire.state.patch.moment.x), "Moment of the patch on the belt about the contact point, contact frame (M_LGKx)").nominal(100.0),
                local("patch_moment_y", "N.m", real!(tire.state.patch.moment.y), "Moment of the patch on the belt about the contact point, contact frame (M_LGKy)").nominal(100.0),
                local("patch_moment_z", "N.m", real!(tire.state.patch.moment.z), "Moment of the patch on the belt about the contact point, contact frame (M_LGKz)").nominal(100.0),
                local("patch_shift_x", "m", real!(tire.state.patch.shift[0]), "Longitudinal shift of the patch on the belt (Delta x_LGK)"),
                local("patch_shift_y", "m", real!(tire.state.patch.shift[1]), "Lateral shift of the patch on the belt (Delta y_LGK)"),
                local("patch_twist", "rad", real!(tire.state.patch.twist), "Twist of the patch on the belt"),
                local("pressure_max", "Pa", real!(tire.state.patch.pressure_max), "Largest pressure of a bristle").nominal(1e5),
                local("negative_pressure_share", "1", real!(tire.state.patch.negative_share), "Sum of negative normal forces of bristles over the normal force: at light load the printed pressure distribution pulls at one end of the patch"),
                local("pressure_state", "", Access::Integer(|m: &Self| m.tire.state.patch.pressure_state as i32, |_: &mut Self, _| {}), "What became of the pressure distribution").items(PRESSURE_STATES),
                local("stationary_start", "", boolean!(tire.stationary_start), "The start is a stationary state; false: none was found for the start inputs, and the tire starts rolling straight and free, or the friction of the road cannot turn a free wheel against its rolling resistance"),
                text_parameter("tire_name", Access::Text(|m: &Self| &m.tire.name, |m: &mut Self, text: &str| m.tire.name = text.into()), "Kaden 2015, example of section 4.2.10 (225 mm)", "Name of the tire, for reports"),
                parameter("tire_radius", "m", real!(tire.parameters.radius), 0.338, "Largest radius of the belt shell (R_Rmax)").range(0.05, 2.0),
                parameter("tire_width", "m", real!(tire.parameters.width), 0.225, "Width of the belt shell (B_R)").range(0.01, 1.5),
                parameter("cross_section_radius", "m", real!(tire.parameters.cross_section_radius), 0.675, "Radius of the belt shell's cross-section (R_quer)").range(0.01, 100.0),
                parameter("rolling_radius", "m", real!(tire.parameters.rolling_radius), 0.328, "Effective rolling radius (R_dyn)").range(0.05, 2.0),
                parameter("belt_mass", "kg", real!(tire.parameters.belt_mass), 8.8, "Mass of the belt (m_G)").range(0.1, 1000.0),
                parameter("belt_inertia_diametral", "kg.m2", real!(tire.parameters.belt_inertia_diametral), 0.5, "Inertia of the belt about x and z (J_Grad)").range(1e-4, 1000.0),
                parameter("belt_inertia_polar", "kg.m2", real!(tire.parameters.belt_inertia_polar), 0.928, "Inertia of the belt about its spin axis (J_Gquer)").range(1e-4, 1000.0),
                parameter("gravity", "m/s2", real!(tire.parameters.gravity), 9.81, "Gravity (g; the source gives no value)").range(0.0, 100.0),
                parameter("vertical_stiffness", "N/m", real!(tire.parameters.vertical_stiffness), 1.54e5, "Spring between belt and road, linear part (c_r lin)").range(1e3, 1e8).tunable(),
                parameter("vertical_stiffness_quadratic", "N/m2", real!(tire.parameters.vertical_stiffness_quadratic), 2.47e6, "Spring between belt and road, quadratic part (c_r quad)").range(0.0, 1e10).tunable(),
                parameter("vertical_damping", "N.s/m", real!(tire.parameters.vertical_damping), 83.0, "Damper between belt and road (d_r)").range(0.0, 1e6).tunable(),
                parameter("sidewall_radial_stiffness", "N/m", real!(tire.parameters.sidewall_radial_stiffness), 4.67e6, "Side wall, radial translation (c_GF rad)").range(1e4, 1e9).tunable(),
                parameter("sidewall_lateral_stiffness", "N/m", real!(tire.parameters.sidewall_lateral_stiffness), 8.5e4, "Side wall, lateral translation (c_GF quer)").range(1e3, 1e9).tunable(),
                parameter("sidewall_tilt_stiffness", "N.m/rad", real!(tire.parameters.sidewall_tilt_stiffness), 8e4, "Side wall, rotation about radial axes (c_GF rot rad)").range(1e2, 1e9).tunable(),
                parameter("sidewall_windup_stiffness", "N.m/rad", real!(tire.parameters.sidewall_windup_stiffness), 4.51e5, "Side wall, rotation about the spin axis (c_GF rot ax)").range(1e2, 1e9).tunable(),
                parameter("sidewall_radial_damping", "N.s/m", real!(tire.parameters.sidewall_radial_damping), 449.0, "Side wall, radial translation (d_GF rad)").range(0.0, 1e6).tunable(),
                parameter("sidewall_lateral_damping", "N.s/m", real!(tire.parameters.sidewall_lateral_damping), 41.5, "Side wall, lateral translation (d_GF quer)").range(0.0, 1e6).tunable(),
                parameter("sidewall_tilt_damping", "N.m.s/rad", real!(tire.parameters.sidewall_tilt_damping), 9.61, "Side wall, rotation about radial axes (d_GF rot rad)").range(0.0, 1e5).tunable(),
                parameter("sidewall_windup_damping", "N.m.s/rad", real!(tire.parameters.sidewall_windup_damping), 53.1, "Side wall, rotation about the spin axis (d_GF rot ax)").range(0.0, 1e5).tunable(),
                integer_parameter("stripes", integer!(tire.parameters.stripes), 6, "Contact stripes across the tire (n_LS)").range(1.0, 64.0),
                integer_parameter("bristles_per_stripe", integer!(tire.parameters.bristles_per_stripe), 30, "Bristles on the ring of each stripe (n_RES; the source gives no value)").range(2.0, 2000.0),
                parameter("bristle_length", "m", real!(tire.parameters.bristle_length), 0.014, "Spacing of bristles along a stripe (l_RKE)").range(1e-4, 0.2),
                parameter("bristle_stiffness", "N/m", real!(tire.parameters.bristle_stiffness), 4e4, "Shear stiffness of one bristle (c_scher); scale it with the bristle's area").range(1.0, 1e8).tunable(),
                parameter("bristle_damping", "N.s/m", real!(tire.parameters.bristle_damping), 0.65, "Shear damping of one bristle (d_scher); scale it with the bristle's area").range(1e-6, 1e4).tunable(),
                parameter("stripe_length_factor", "1", real!(tire.parameters.stripe_length_factor), 0.75, "Length of a contact stripe over the arc of the belt shell below the road (f_L mat)").range(0.1, 2.0),
                parameter("patch_compliance_x", "m/N", real!(tire.parameters.patch_compliance_x), 3e-6, "Longitudinal shift of the patch on the belt (n_LKx)").range(0.0, 1e-3).tunable(),
                parameter("patch_compliance_y", "m/N", real!(tire.parameters.patch_compliance_y), 8e-7, "Lateral shift and bending of the patch on the belt (n_LKy)").range(0.0, 1e-3).tunable(),
                parameter("patch_compliance_twist", "rad/(N.m)", real!(tire.parameters.patch_compliance_twist), 1e-4, "Twist of the patch on the belt (n_LKt)").range(0.0, 1e-1).tunable(),
                parameter("patch_lag_x", "s", real!(tire.parameters.patch_lag_x), 1.84e-2, "Lag of the longitudinal shift (tau_LKx); constant here, the source leaves its law open").range(1e-5, 10.0).tunable(),
                parameter("patch_lag_y", "s", real!(tire.parameters.patch_lag_y), 7.58e-2, "Lag of the lateral shift and bending (tau_LKy); constant here, the source leaves its law open").range(1e-5, 10.0).tunable(),
                parameter("patch_lag_twist", "s", real!(tire.parameters.patch_lag_twist), 8.24e-3, "Lag of the twist (tau_LKt); constant here, the source leaves its law open").range(1e-5, 10.0).tunable(),
                parameter("pressure_exponent_long_0", "1", real!(tire.parameters.pressure_exponent_long[0]), 3.8, "Exponent of the pressure along a stripe, at no penetration (g_l)").range(0.0, 1e3),
                parameter("pressure_exponent_long_1", "1/m", real!(tire.parameters.pressure_exponent_long[1]), 90.5, "The same, per penetration").range(-1e6, 1e6),
                parameter("pressure_exponent_long_2", "1/m2", real!(tire.parameters.pressure_exponent_long[2]), 1450.0, "The same, per penetration squared; the exponent is never below 1").range(-1e8, 1e8),
                parameter("pressure_exponent_lat_0", "1", real!(tire.parameters.pressure_exponent_lat[0]), 6.0, "Exponent of the pressure across the tire, at no penetration (g_q)").range(0.0, 1e3),
                parameter("pressure_exponent_lat_1", "1/m", real!(tire.parameters.pressure_exponent_lat[1]), 129.0, "The same, per penetration").range(-1e6, 1e6),
                parameter("pressure_exponent_lat_2", "1/m2", real!(tire.parameters.pressure_exponent_lat[2]), 2070.0, "The same, per penetration squared; the exponent is never below 1").range(-1e8, 1e8),
                parameter("rolling_resistance_lever", "m", real!(tire.parameters.rolling_resistance_lever), 0.01, "Lever of the normal force that resists rolling (k_roll), read as a length").range(0.0, 0.1).tunable(),
                parameter("friction_static_zero", "1", real!(tire.parameters.friction_static[0]), 1.5, "Static friction coefficient at no pressure (mu_haft 0bar)").range(0.0, 10.0).tunable(),
                parameter("friction_static_reference", "1", real!(tire.parameters.friction_static[1]), 1.4, "Static friction coefficient at friction_pressure (mu_haft Delta p)").range(0.0, 10.0).tunable(),
                parameter("friction_sliding_zero", "1", real!(tire.parameters.friction_sliding[0]), 1.1, "Sliding friction coefficient at no pressure (mu_gleit 0bar)").range(0.0, 10.0).tunable(),
                parameter("friction_sliding_reference", "1", real!(tire.parameters.friction_sliding[1]), 1.0, "Sliding friction coefficient at friction_pressure (mu_gleit Delta p)").range(0.0, 10.0).tunable(),
                parameter("friction_pressure", "Pa", real!(tire.parameters.friction_pressure), 2e5, "Pressure at which the reference friction coefficients hold (Delta p); extrapolated linearly beyond").range(1e3, 1e8).tunable(),
                parameter("friction_pressure_scale", "1", real!(tire.parameters.friction_pressure_scale), 1.0, "Factor on the pressure in the friction law; 1 as printed, 1.78 brings the source's own example within 1 % of its friction values").range(0.0, 100.0).tunable(),
                boolean_parameter("even_stripes", boolean!(tire.parameters.even_stripes), false, "Width of a stripe: false as printed in (4.16), 3 B / (3 n - 1); true tire_width / stripes"),
                boolean_parameter("antisymmetric_coupling", boolean!(tire.parameters.antisymmetric_coupling), false, "Rotation between rim and belt: false single entries of the rotation matrix as printed in (4.4), with a ripple of second order twice a turn; true its antisymmetric part"),
                boolean_parameter("limit_pressure_tilt", boolean!(tire.parameters.limit_pressure_tilt), true, "Negative pressure at light load: true limits the tilt so that no pressure is negative, and the lateral-axis moment is not met there; false as printed: bristles that pull count in the normal force but not in the friction, so the others rub with more than the wheel carries"),
                boolean_parameter(
                    "whole_step_entry",
                    boolean!(tire.parameters.whole_step_entry),
                    false,
                    "Bristle that comes into contact within a step: false it is loaded from that instant; true for the whole step, which makes the patch longer by half a step's travel and probably is in the source's own example",
                ),
            $($parameter,)*
            $($road,)*
            parameter("friction_speed_falloff", "s/m", real!(tire.parameters.friction_speed_falloff), 0.0, "Fall of the sliding friction with the speed v at which the patch moves over the road where a bristle is: it is divided by 1 + falloff v. Not in the source (0)").range(0.0, 10.0).tunable(),
                output("contact_power_loss", "W", real!(tire.state.patch.power_loss), "Power lost in the contact, all of it: sliding, the bristles' dampers, snapping back at break-away, leaving the contact bent; a mean over the last 10 ms").nominal(1000.0).without_derivative(),
                output("contact_energy_loss", "J", real!(tire.state.energy_loss), "Energy lost in the contact since the start").nominal(1e4),
            $($appended,)*
        ]
    }};
}

/// The rows of a rig's table for the road in its field `road_parameters`.
macro_rules! with_road {
    ($table:ident! { $($rows:tt)* }) => {
        $table! {
            $($rows)*
            road: [
                integer_parameter("road_kind", integer!(road_parameters.kind), 1, "What the tire rolls on").items($crate::road::KINDS),
                parameter("road_start", "m", real!(road_parameters.start), 5.0, "The road is level up to this place, counted along it from where the wheel starts").range(-1e6, 1e6),
                parameter("road_height", "m", real!(road_parameters.height), 0.01, "Height of an obstacle over the level road before it; negative: depth. For a sine from valley to peak").range(-1.0, 1.0),
                parameter("road_length", "m", real!(road_parameters.length), 0.1, "Length along the road: of a ramp, of a cleat at its foot, of a slab, of a wave").range(1e-3, 1e4),
                parameter("road_bevel", "m", real!(road_parameters.bevel), 0.0, "Width and height of a cleat's bevels of 45 degrees").range(0.0, 1.0),
                parameter("road_spacing", "m", real!(road_parameters.spacing), 0.0, "Distance from the beginning of an obstacle to that of the next; 0: only one, but slabs join").range(0.0, 1e4),
                parameter("road_roughness", "m3", real!(road_parameters.roughness), 64e-6, "Displacement PSD of ISO 8608 at 0.1 cycles/m; geometric means of its classes in 1e-6 m3: A 16, B 64, C 256, D 1024, E 4096, F 16384").range(0.0, 1.0),
                integer_parameter("road_seed", integer!(road_parameters.seed), 1, "Number of the realisation of an ISO 8608 road"),
                parameter("road_direction", "rad", real!(road_parameters.direction), 0.0, "Angle about z from x to the direction along which the road changes; an oblique cleat for a wheel that travels along x").range(-std::f64::consts::TAU, std::f64::consts::TAU),
                parameter("road_filter_length", "m", real!(road_parameters.filter_length), 0.1, "Length of the contact that bridges edges: width at half height of the filter (raised cosine) through which the tire feels the road").range(0.01, 2.0),
                text_parameter("road_profile", Access::Text(|m: &Self| &m.road_parameters.profile, |m: &mut Self, text: &str| m.road_parameters.profile = text.into()), "", "Points 'x z; x z; ...' in m of the profile, x counted from road_start; two points with the same x are a vertical edge"),
                text_parameter("road_friction", Access::Text(|m: &Self| &m.road_parameters.friction, |m: &mut Self, text: &str| m.road_parameters.friction = text.into()), "", "Friction patches 's factor; s factor; ...': from the place s (m from the start) on, the factor on the friction; 1 before the first"),
            ],
        }
    };
}

/// Access to an output that is computed when it is read: `computed!(m: m.speed * m.radius)`.
macro_rules! computed {
    ($model:ident: $value:expr) => {
        $crate::model::Access::Real(|$model: &Self| $value, |_: &mut Self, _| {})
    };
}

pub(super) use {computed, tire_table, with_road};
