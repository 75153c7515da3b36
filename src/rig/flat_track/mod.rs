//! `ring-brush-flat-track`: the ring-and-brush tire on a flat-track rig (4.36), (4.37).
//!
//! The rig imposes the rim's motion and measures force and moment on the rim in H axes: x horizontal
//! in the wheel's heading, y horizontal to the left, z up, origin in the wheel's centre. The road is
//! an unbounded plane over which the wheel travels. All signs at this interface are those of
//! ISO 8855; the source's slip angle (DIN 70000) has the opposite sign and is converted here, once.

mod derivatives;

use self::derivatives::Changes;
use super::{Actuator, Command};
use crate::model::{
    Access, Model, Variable, boolean_parameter, input, integer_parameter, local, output, parameter,
    text_parameter,
};
use crate::solver::{Dual, Real};
use crate::tire::Motion;
use crate::tire::ring_brush::{Parameters, State, Stationary, Tire, Vertical, stationary};
use crate::{Result, boolean, clone_in_place, integer, real};
use nalgebra::Vector3;
use serde::{Deserialize, Serialize};
use std::f64::consts::PI;

/// The model: parameters, commands, actuators, tire and what the rig measures.
#[derive(Debug, PartialEq, Default, Serialize, Deserialize)]
pub struct RingBrushFlatTrack {
    tire_name: String,
    parameters: Parameters,
    step_size: f64,
    actuator_frequency: f64,
    commands: Drive<Command>,
    actuators: Drive<Actuator>,
    tire: Tire,
    rim: Motion<f64>,
    state: State,
    /// Force and moment on the rim in H axes.
    force: Vector3<f64>,
    moment: Vector3<f64>,
    path: f64,
    stationary_start: bool,
}

/// The six things that the rig drives.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
struct Drive<T> {
    steer: T,
    deflection: T,
    path_speed: T,
    camber: T,
    slip: T,
    slip_angle: T,
}

clone_in_place!(RingBrushFlatTrack {
    tire_name,
    parameters,
    step_size,
    actuator_frequency,
    commands,
    actuators,
    tire,
    rim,
    state,
    force,
    moment,
    path,
    stationary_start,
});

/// Access to a command and its rate.
macro_rules! command {
    ($field:ident) => {
        Access::Rated(
            |m: &Self| m.commands.$field.value,
            |m: &mut Self, value, rate| m.commands.$field = Command { value, rate },
        )
    };
}

const PRESSURE_STATES: &[(&str, &str)] = &[
    ("air", "no contact"),
    ("regular", "normal force and lateral-axis moment are met, no pressure is negative"),
    ("negative", "normal force and moment are met with negative pressure in some bristles"),
    ("limited", "tilt limited by limit_pressure_tilt: the normal force is met, the moment is not"),
    ("singular", "all bristles in contact have the same x: the normal force is met, the moment is not"),
    ("between_bristles", "the belt touches the road between bristles: none carries anything"),
];

impl Model for RingBrushFlatTrack {
    const NAME: &'static str = "ring-brush-flat-track";
    const DESCRIPTION: &'static str = "Ring-and-brush tire on a flat-track rig: commands of the rig in, force and moment on the rim in H axes out (ISO 8855 signs)";
    const STOP_TIME: f64 = 5.0;
    const DIRECTIONAL_DERIVATIVES: bool = true;
    const DOCUMENTATION: &'static str = include_str!("documentation.html");
    const VARIABLES: &'static [Variable<Self>] = &[
        // commands
        input("steer", "rad", command!(steer), 0.0, "Steer angle of the wheel about z; it turns wheel and path together, so it makes no slip angle").range(-2.0 * PI, 2.0 * PI),
        input("deflection", "m", command!(deflection), 0.02, "Unloaded radius minus height of the wheel centre; negative lifts the tire off").range(-0.2, 0.1),
        input("path_speed", "m/s", command!(path_speed), 10.0, "Speed of the wheel over the road along its path").range(-100.0, 100.0),
        input("camber", "rad", command!(camber), 0.0, "Inclination angle; positive leans the top of the wheel to -y").range(-0.6, 0.6),
        input("slip", "1", command!(slip), 0.0, "Longitudinal slip, spin speed times rolling radius over speed in the wheel's heading, minus 1; positive drives, -1 is a locked wheel").range(-100.0, 100.0),
        input("slip_angle", "rad", command!(slip_angle), 0.0, "Slip angle of ISO 8855: positive when the wheel, rolling forward, travels to its left (+y), which gives a negative force_y").range(-PI, PI),
        // measured
        output("force_x", "N", real!(force.x), "Longitudinal force of the tire on the rim, H axes").nominal(1000.0),
        output("force_y", "N", real!(force.y), "Lateral force of the tire on the rim, H axes").nominal(1000.0),
        output("force_z", "N", real!(force.z), "Vertical force of the tire on the rim, H axes: the normal force on the road less the weight of the belt").nominal(1000.0),
        output("moment_x", "N.m", real!(moment.x), "Overturning moment of the tire on the rim about the wheel centre, H axes").nominal(100.0),
        output("moment_y", "N.m", real!(moment.y), "Moment about the lateral axis of the tire on the rim, H axes").nominal(100.0),
        output("moment_z", "N.m", real!(moment.z), "Aligning moment of the tire on the rim, H axes").nominal(100.0),
        // inside
        output("belt_deflection", "m", real!(state.patch.penetration), "Penetration of the belt shell into the road (f_G)"),
        output("contact_length_left", "m", Access::Real(|m: &Self| m.contact_length(0.0), |_: &mut Self, _| {}), "Length of the contact stripe with the largest y (l_mat 1)"),
        output("contact_length_center", "m", Access::Real(|m: &Self| m.contact_length(0.5), |_: &mut Self, _| {}), "Length of the middle contact stripe"),
        output("contact_length_right", "m", Access::Real(|m: &Self| m.contact_length(1.0), |_: &mut Self, _| {}), "Length of the contact stripe with the smallest y (l_mat n)"),
        output("patch_force_x", "N", real!(state.patch.force.x), "Longitudinal force of the patch on the belt, contact frame (F_LGKx)").nominal(1000.0),
        output("patch_force_y", "N", real!(state.patch.force.y), "Lateral force of the patch on the belt, contact frame (F_LGKy)").nominal(1000.0),
        output("patch_force_z", "N", real!(state.patch.force.z), "Normal force of the patch on the belt (F_LGKz)").nominal(1000.0),
        output("sliding_share", "1", real!(state.patch.sliding_share), "Bristles that slide over bristles in contact"),
        output("sliding_distance", "m", real!(state.sliding_distance), "Distance slid since the start, mean over the normal force"),
        output("friction_power", "W", real!(state.patch.friction_power), "Power that sliding friction turns into heat").nominal(1000.0),
        output("wheel_angle", "rad", real!(rim.angles.y), "Spin angle of the rim"),
        // further inside
        local("wheel_speed", "rad/s", real!(rim.rates.y), "Spin speed of the rim"),
        local("path_distance", "m", real!(path), "Distance that the wheel centre has travelled"),
        local("actual_steer", "rad", real!(actuators.steer.position), "Steer angle behind the actuator"),
        local("actual_deflection", "m", real!(actuators.deflection.position), "Deflection behind the actuator"),
        local("actual_path_speed", "m/s", real!(actuators.path_speed.position), "Path speed behind the actuator"),
        local("actual_camber", "rad", real!(actuators.camber.position), "Camber behind the actuator"),
        local("actual_slip", "1", real!(actuators.slip.position), "Slip behind the actuator"),
        local("actual_slip_angle", "rad", real!(actuators.slip_angle.position), "Slip angle behind the actuator"),
        local("belt_camber", "rad", real!(state.belt.angles.x), "Camber of the belt (phi_G0x)"),
        local("belt_yaw", "rad", Access::Real(|m: &Self| m.state.belt.angles.z - m.rim.angles.z, |_: &mut Self, _| {}), "Steer angle of the belt minus that of the rim (phi_G0z - phi_F0z)"),
        local("belt_windup", "rad", Access::Real(|m: &Self| m.rim.angles.y - m.state.belt.angles.y, |_: &mut Self, _| {}), "Spin angle of the rim minus that of the belt"),
        local("belt_offset_x", "m", Access::Real(|m: &Self| m.belt_offset().x, |_: &mut Self, _| {}), "Belt centre from wheel centre, H axes"),
        local("belt_offset_y", "m", Access::Real(|m: &Self| m.belt_offset().y, |_: &mut Self, _| {}), "Belt centre from wheel centre, H axes"),
        local("belt_offset_z", "m", Access::Real(|m: &Self| m.belt_offset().z, |_: &mut Self, _| {}), "Belt centre from wheel centre, H axes"),
        local("patch_moment_x", "N.m", real!(state.patch.moment.x), "Moment of the patch on the belt about the contact point, contact frame (M_LGKx)").nominal(100.0),
        local("patch_moment_y", "N.m", real!(state.patch.moment.y), "Moment of the patch on the belt about the contact point, contact frame (M_LGKy)").nominal(100.0),
        local("patch_moment_z", "N.m", real!(state.patch.moment.z), "Moment of the patch on the belt about the contact point, contact frame (M_LGKz)").nominal(100.0),
        local("patch_shift_x", "m", real!(state.patch.shift[0]), "Longitudinal shift of the patch on the belt (Delta x_LGK)"),
        local("patch_shift_y", "m", real!(state.patch.shift[1]), "Lateral shift of the patch on the belt (Delta y_LGK)"),
        local("patch_twist", "rad", real!(state.patch.twist), "Twist of the patch on the belt"),
        local("pressure_max", "Pa", real!(state.patch.pressure_max), "Largest pressure of a bristle").nominal(1e5),
        local("negative_pressure_share", "1", real!(state.patch.negative_share), "Sum of negative normal forces of bristles over the normal force: at light load the printed pressure distribution pulls at one end of the patch"),
        local("pressure_state", "", Access::Integer(|m: &Self| m.state.patch.pressure_state as i32, |_: &mut Self, _| {}), "What became of the pressure distribution").items(PRESSURE_STATES),
        local("stationary_start", "", boolean!(stationary_start), "The start is a stationary state; false: none was found for the start inputs, and the tire starts rolling straight and free"),
        // parameters
        text_parameter("tire_name", Access::Text(|m: &Self| &m.tire_name, |m: &mut Self, text: &str| m.tire_name = text.into()), "Kaden 2015, example of section 4.2.10 (225 mm)", "Name of the tire, for reports"),
        parameter("tire_radius", "m", real!(parameters.radius), 0.338, "Largest radius of the belt shell (R_Rmax)").range(0.05, 2.0),
        parameter("tire_width", "m", real!(parameters.width), 0.225, "Width of the belt shell (B_R)").range(0.01, 1.5),
        parameter("cross_section_radius", "m", real!(parameters.cross_section_radius), 0.675, "Radius of the belt shell's cross-section (R_quer)").range(0.01, 100.0),
        parameter("rolling_radius", "m", real!(parameters.rolling_radius), 0.328, "Effective rolling radius (R_dyn)").range(0.05, 2.0),
        parameter("belt_mass", "kg", real!(parameters.belt_mass), 8.8, "Mass of the belt (m_G)").range(0.1, 1000.0),
        parameter("belt_inertia_diametral", "kg.m2", real!(parameters.belt_inertia_diametral), 0.5, "Inertia of the belt about x and z (J_Grad)").range(1e-4, 1000.0),
        parameter("belt_inertia_polar", "kg.m2", real!(parameters.belt_inertia_polar), 0.928, "Inertia of the belt about its spin axis (J_Gquer)").range(1e-4, 1000.0),
        parameter("gravity", "m/s2", real!(parameters.gravity), 9.81, "Gravity (g; the source gives no value)").range(0.0, 100.0),
        parameter("vertical_stiffness", "N/m", real!(parameters.vertical_stiffness), 1.54e5, "Spring between belt and road, linear part (c_r lin)").range(1e3, 1e8).tunable(),
        parameter("vertical_stiffness_quadratic", "N/m2", real!(parameters.vertical_stiffness_quadratic), 2.47e6, "Spring between belt and road, quadratic part (c_r quad)").range(0.0, 1e10).tunable(),
        parameter("vertical_damping", "N.s/m", real!(parameters.vertical_damping), 83.0, "Damper between belt and road (d_r)").range(0.0, 1e6).tunable(),
        parameter("sidewall_radial_stiffness", "N/m", real!(parameters.sidewall_radial_stiffness), 4.67e6, "Side wall, radial translation (c_GF rad)").range(1e4, 1e9).tunable(),
        parameter("sidewall_lateral_stiffness", "N/m", real!(parameters.sidewall_lateral_stiffness), 8.5e4, "Side wall, lateral translation (c_GF quer)").range(1e3, 1e9).tunable(),
        parameter("sidewall_tilt_stiffness", "N.m/rad", real!(parameters.sidewall_tilt_stiffness), 8e4, "Side wall, rotation about radial axes (c_GF rot rad)").range(1e2, 1e9).tunable(),
        parameter("sidewall_windup_stiffness", "N.m/rad", real!(parameters.sidewall_windup_stiffness), 4.51e5, "Side wall, rotation about the spin axis (c_GF rot ax)").range(1e2, 1e9).tunable(),
        parameter("sidewall_radial_damping", "N.s/m", real!(parameters.sidewall_radial_damping), 449.0, "Side wall, radial translation (d_GF rad)").range(0.0, 1e6).tunable(),
        parameter("sidewall_lateral_damping", "N.s/m", real!(parameters.sidewall_lateral_damping), 41.5, "Side wall, lateral translation (d_GF quer)").range(0.0, 1e6).tunable(),
        parameter("sidewall_tilt_damping", "N.m.s/rad", real!(parameters.sidewall_tilt_damping), 9.61, "Side wall, rotation about radial axes (d_GF rot rad)").range(0.0, 1e5).tunable(),
        parameter("sidewall_windup_damping", "N.m.s/rad", real!(parameters.sidewall_windup_damping), 53.1, "Side wall, rotation about the spin axis (d_GF rot ax)").range(0.0, 1e5).tunable(),
        integer_parameter("stripes", integer!(parameters.stripes), 6, "Contact stripes across the tire (n_LS)").range(1.0, 64.0),
        integer_parameter("bristles_per_stripe", integer!(parameters.bristles_per_stripe), 30, "Bristles on the ring of each stripe (n_RES; the source gives no value)").range(2.0, 2000.0),
        parameter("bristle_length", "m", real!(parameters.bristle_length), 0.014, "Spacing of bristles along a stripe (l_RKE)").range(1e-4, 0.2),
        parameter("bristle_stiffness", "N/m", real!(parameters.bristle_stiffness), 4e4, "Shear stiffness of one bristle (c_scher); scale it with the bristle's area").range(1.0, 1e8).tunable(),
        parameter("bristle_damping", "N.s/m", real!(parameters.bristle_damping), 0.65, "Shear damping of one bristle (d_scher); scale it with the bristle's area").range(1e-6, 1e4).tunable(),
        parameter("stripe_length_factor", "1", real!(parameters.stripe_length_factor), 0.75, "Length of a contact stripe over the arc of the belt shell below the road (f_L mat)").range(0.1, 2.0),
        parameter("patch_compliance_x", "m/N", real!(parameters.patch_compliance_x), 3e-6, "Longitudinal shift of the patch on the belt (n_LKx)").range(0.0, 1e-3).tunable(),
        parameter("patch_compliance_y", "m/N", real!(parameters.patch_compliance_y), 8e-7, "Lateral shift and bending of the patch on the belt (n_LKy)").range(0.0, 1e-3).tunable(),
        parameter("patch_compliance_twist", "rad/(N.m)", real!(parameters.patch_compliance_twist), 1e-4, "Twist of the patch on the belt (n_LKt)").range(0.0, 1e-1).tunable(),
        parameter("patch_lag_x", "s", real!(parameters.patch_lag_x), 1.84e-2, "Lag of the longitudinal shift (tau_LKx); constant here, the source leaves its law open").range(1e-5, 10.0).tunable(),
        parameter("patch_lag_y", "s", real!(parameters.patch_lag_y), 7.58e-2, "Lag of the lateral shift and bending (tau_LKy); constant here, the source leaves its law open").range(1e-5, 10.0).tunable(),
        parameter("patch_lag_twist", "s", real!(parameters.patch_lag_twist), 8.24e-3, "Lag of the twist (tau_LKt); constant here, the source leaves its law open").range(1e-5, 10.0).tunable(),
        parameter("pressure_exponent_long_0", "1", real!(parameters.pressure_exponent_long[0]), 3.8, "Exponent of the pressure along a stripe, at no penetration (g_l)").range(0.0, 1e3),
        parameter("pressure_exponent_long_1", "1/m", real!(parameters.pressure_exponent_long[1]), 90.5, "The same, per penetration").range(-1e6, 1e6),
        parameter("pressure_exponent_long_2", "1/m2", real!(parameters.pressure_exponent_long[2]), 1450.0, "The same, per penetration squared; the exponent is never below 1").range(-1e8, 1e8),
        parameter("pressure_exponent_lat_0", "1", real!(parameters.pressure_exponent_lat[0]), 6.0, "Exponent of the pressure across the tire, at no penetration (g_q)").range(0.0, 1e3),
        parameter("pressure_exponent_lat_1", "1/m", real!(parameters.pressure_exponent_lat[1]), 129.0, "The same, per penetration").range(-1e6, 1e6),
        parameter("pressure_exponent_lat_2", "1/m2", real!(parameters.pressure_exponent_lat[2]), 2070.0, "The same, per penetration squared; the exponent is never below 1").range(-1e8, 1e8),
        parameter("rolling_resistance_lever", "m", real!(parameters.rolling_resistance_lever), 0.01, "Lever of the normal force that resists rolling (k_roll), read as a length").range(0.0, 0.1).tunable(),
        parameter("friction_static_zero", "1", real!(parameters.friction_static[0]), 1.5, "Static friction coefficient at no pressure (mu_haft 0bar)").range(0.0, 10.0).tunable(),
        parameter("friction_static_reference", "1", real!(parameters.friction_static[1]), 1.4, "Static friction coefficient at friction_pressure (mu_haft Delta p)").range(0.0, 10.0).tunable(),
        parameter("friction_sliding_zero", "1", real!(parameters.friction_sliding[0]), 1.1, "Sliding friction coefficient at no pressure (mu_gleit 0bar)").range(0.0, 10.0).tunable(),
        parameter("friction_sliding_reference", "1", real!(parameters.friction_sliding[1]), 1.0, "Sliding friction coefficient at friction_pressure (mu_gleit Delta p)").range(0.0, 10.0).tunable(),
        parameter("friction_pressure", "Pa", real!(parameters.friction_pressure), 2e5, "Pressure at which the reference friction coefficients hold (Delta p); extrapolated linearly beyond").range(1e3, 1e8).tunable(),
        parameter("friction_pressure_scale", "1", real!(parameters.friction_pressure_scale), 1.0, "Factor on the pressure in the friction law; 1 as printed, 1.78 brings the source's own example within 1 % of its friction values").range(0.0, 100.0).tunable(),
        boolean_parameter("even_stripes", boolean!(parameters.even_stripes), false, "Width of a stripe: false as printed in (4.16), 3 B / (3 n - 1); true tire_width / stripes"),
        boolean_parameter("antisymmetric_coupling", boolean!(parameters.antisymmetric_coupling), false, "Rotation between rim and belt: false single entries of the rotation matrix as printed in (4.4), with a ripple of second order twice a turn; true its antisymmetric part"),
        boolean_parameter("limit_pressure_tilt", boolean!(parameters.limit_pressure_tilt), false, "Negative pressure at light load: false as printed, friction then counts it as zero; true limits the tilt so that no pressure is negative, and the lateral-axis moment is not met"),
        boolean_parameter(
            "whole_step_entry",
            boolean!(parameters.whole_step_entry),
            false,
            "Bristle that comes into contact within a step: false it is loaded from that instant; true for the whole step, which makes the patch longer by half a step's travel and probably is in the source's own example",
        ),
        parameter("actuator_frequency", "rad/s", real!(actuator_frequency), 200.0, "Corner of the critically damped filter that a command without derivative passes; its delay is 2 over this").range(1.0, 1e5).tunable(),
        parameter("step_size", "s", real!(step_size), 1e-4, "Step of the model's own time grid").range(1e-7, 5e-4),
    ];

    fn step_size(&self) -> f64 {
        self.step_size
    }

    fn initialize(&mut self) -> Result<()> {
        self.tire = Tire::new(&self.parameters)?;
        let commands = &self.commands;
        self.actuators = Drive {
            steer: Actuator::at_rest(&commands.steer),
            deflection: Actuator::at_rest(&commands.deflection),
            path_speed: Actuator::at_rest(&commands.path_speed),
            camber: Actuator::at_rest(&commands.camber),
            slip: Actuator::at_rest(&commands.slip),
            slip_angle: Actuator::at_rest(&commands.slip_angle),
        };
        self.path = 0.0;
        self.rim = self.rim_motion(0.0);
        let height = Vertical::Height(self.rim.position.z);
        let (stationary, found) = match stationary(&self.tire, &self.rim, height) {
            Ok(stationary) => (stationary, true),
            Err(_) => (stationary(&self.tire, &self.free_rolling(), height)?, false),
        };
        self.stationary_start = found;
        self.state = stationary.state(&self.tire, &self.rim)?;
        // what the bristles' sums ripple around, and what has derivatives
        self.state.patch.force = stationary.patch.force;
        self.state.patch.moment = stationary.patch.moment;
        self.measure();
        Ok(())
    }

    fn directional_derivatives(
        &self,
        starting: bool,
        direction: &[(usize, f64)],
        unknowns: &[usize],
    ) -> Result<Vec<f64>> {
        let mut position = self.actuators.map(|a| Dual::<1>::from(a.position));
        let mut commands = self.commands;
        for (index, share) in direction {
            let name = Self::VARIABLES[*index].name();
            // between steps the actuator stands between a command that was held in the last one and the rim
            let followed = starting || commands.named(name).is_some_and(|c| c.rate.is_some());
            if let Some(drive) = position.named(name).filter(|_| followed) {
                drive.gradient[0] += share;
            }
        }
        let velocity = self.actuators.map(|a| Dual::<1>::from(a.velocity));
        let rim = imposed(&self.parameters, &position, &velocity, self.rim.angles.y);
        let changes =
            if starting { Changes::stationary(self, &rim)? } else { Changes::side_wall(self, &rim) };
        unknowns.iter().map(|index| changes.of(Self::VARIABLES[*index].name())).collect()
    }

    fn tune(&mut self) -> Result<()> {
        self.tire.tune(&self.parameters)
    }

    fn check(&self) -> Result<()> {
        self.tire.check(&self.state)
    }

    fn warning(&self) -> Option<String> {
        (!self.stationary_start).then(|| {
            "no stationary state was found for the start inputs; the tire starts rolling straight and free".into()
        })
    }

    fn step(&mut self, length: f64) -> Result<()> {
        let (commands, frequency) = (&self.commands, self.actuator_frequency);
        let actuators = &mut self.actuators;
        actuators.steer.follow(&commands.steer, frequency, length);
        actuators.deflection.follow(&commands.deflection, frequency, length);
        actuators.path_speed.follow(&commands.path_speed, frequency, length);
        actuators.camber.follow(&commands.camber, frequency, length);
        actuators.slip.follow(&commands.slip, frequency, length);
        actuators.slip_angle.follow(&commands.slip_angle, frequency, length);

        let before = self.rim;
        self.rim = self.rim_motion(before.angles.y);
        self.rim.angles.y += 0.5 * length * (before.rates.y + self.rim.rates.y);
        self.path += length * self.actuators.path_speed.position.abs();
        self.tire.step(&mut self.state, &before, &self.rim, length)?;
        self.measure();
        Ok(())
    }
}

impl<T> Drive<T> {
    fn map<U>(&self, f: impl Fn(&T) -> U) -> Drive<U> {
        Drive {
            steer: f(&self.steer),
            deflection: f(&self.deflection),
            path_speed: f(&self.path_speed),
            camber: f(&self.camber),
            slip: f(&self.slip),
            slip_angle: f(&self.slip_angle),
        }
    }

    /// The drive that is called like an input.
    fn named(&mut self, name: &str) -> Option<&mut T> {
        match name {
            "steer" => Some(&mut self.steer),
            "deflection" => Some(&mut self.deflection),
            "path_speed" => Some(&mut self.path_speed),
            "camber" => Some(&mut self.camber),
            "slip" => Some(&mut self.slip),
            "slip_angle" => Some(&mut self.slip_angle),
            _ => None,
        }
    }
}

/// The rim's motion for positions and velocities of the drives (4.36).
fn imposed<T: Real>(p: &Parameters, position: &Drive<T>, velocity: &Drive<T>, spin_angle: f64) -> Motion<T> {
    // the source's slip angle has the opposite sign
    let source_slip_angle = -position.slip_angle;
    let (_, along) = source_slip_angle.sin_cos();
    let (sin, cos) = (position.steer - source_slip_angle).sin_cos();
    let speed = position.path_speed;
    let zero = T::zero();
    Motion {
        position: Vector3::new(zero, zero, -position.deflection + p.radius),
        velocity: Vector3::new(speed * cos, speed * sin, -velocity.deflection),
        angles: Vector3::new(position.camber, T::from(spin_angle), position.steer),
        rates: Vector3::new(
            velocity.camber,
            (position.slip + 1.0) * speed * along / p.rolling_radius,
            velocity.steer,
        ),
    }
}

/// Turns frame 0 into H axes of a steer angle (4.37).
fn to_heading<T: Real>(steer: T, v: &Vector3<T>) -> Vector3<T> {
    let (sin, cos) = steer.sin_cos();
    Vector3::new(cos * v.x + sin * v.y, cos * v.y - sin * v.x, v.z)
}

impl RingBrushFlatTrack {
    /// The rim's motion that the actuators impose, at a spin angle.
    fn rim_motion(&self, spin_angle: f64) -> Motion<f64> {
        imposed(
            &self.parameters,
            &self.actuators.map(|a| a.position),
            &self.actuators.map(|a| a.velocity),
            spin_angle,
        )
    }

    /// The rim rolling straight and without slip at the speed that it has in its heading.
    fn free_rolling(&self) -> Motion<f64> {
        let mut rim = self.rim;
        let (sin, cos) = libm::sincos(rim.angles.z);
        let speed = rim.velocity.x * cos + rim.velocity.y * sin;
        rim.velocity = Vector3::new(speed * cos, speed * sin, 0.0);
        rim.angles.x = 0.0;
        rim.rates = Vector3::new(0.0, speed / self.parameters.rolling_radius, 0.0);
        rim
    }

    fn measure(&mut self) {
        self.force = to_heading(self.rim.angles.z, &self.state.on_rim.force);
        self.moment = to_heading(self.rim.angles.z, &self.state.on_rim.moment);
    }

    fn belt_offset(&self) -> Vector3<f64> {
        to_heading(self.rim.angles.z, &(self.state.belt.position - self.rim.position))
    }

    /// Length of the stripe at a share of the way from left to right.
    fn contact_length(&self, share: f64) -> f64 {
        self.state.bristles.lengths.get(self.stripe(share)).copied().unwrap_or(0.0)
    }

    /// Number of the stripe at a share of the way from left to right.
    fn stripe(&self, share: f64) -> usize {
        (share * (f64::from(self.parameters.stripes) - 1.0)).max(0.0) as usize
    }

    /// The tire.
    pub fn tire(&self) -> &Tire {
        &self.tire
    }

    /// The tire's state.
    pub fn state(&self) -> &State {
        &self.state
    }

    /// The stationary state for the present commands with, instead of the commanded deflection, a
    /// vertical force \[N\] on the rim.
    ///
    /// # Errors
    /// None was found.
    pub fn stationary_at_load(&self, load: f64) -> Result<Stationary> {
        stationary(&self.tire, &self.rim, Vertical::Load(load))
    }
}
