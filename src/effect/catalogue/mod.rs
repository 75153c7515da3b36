//! The catalogue: one file per effect, by family.

mod actuator_dead_band;
mod actuator_lag;
mod actuator_limit;
mod actuator_rate_limit;
mod actuator_resonance;
mod added_inertia;
mod aero_drag;
mod amplitude_softening;
mod asymmetric_spring;
mod backlash;
mod belt_mode;
mod belt_order;
mod bouc_wen;
mod brake_torque_variation;
mod bump_stop;
mod bushing_hysteresis;
mod camber_thrust;
mod carcass_compliance;
mod clearance;
mod clock_drift;
mod conicity;
mod constant_force;
mod coulomb_friction;
mod cross_talk;
mod damper_asymmetry;
mod disc_thickness_variation;
mod driveline_compliance;
mod drum_curvature;
mod falling_branch;
mod fixture_inertia;
mod frame_resonance;
mod frictional_heating;
mod guide_drag;
mod guide_friction;
mod hydraulic_hold_off;
mod hydraulic_lag;
mod imbalance;
mod inflation_warm_up;
mod input_offset;
mod lift_off;
#[cfg(test)]
mod literature;
mod load_dependent_friction;
mod load_sensitivity;
mod loss_of_contact;
mod mains_hum;
mod maxwell_element;
pub mod nested;
mod non_uniformity;
mod operator;
mod pad_fade;
mod pad_onset;
mod payne;
#[cfg(test)]
mod physics;
mod play;
mod plysteer;
mod pressure_dependent_friction;
mod progressive_spring;
mod quadratic_damper;
mod quantisation;
mod relaxation_length;
mod rolling_radius;
mod rolling_resistance;
mod saturation;
mod seal_friction;
mod sensor_bias;
mod sensor_delay;
mod sensor_drift;
mod sensor_gain;
mod sensor_lag;
mod sensor_nonlinearity;
mod speed_dependent_friction;
mod steering_compliance;
mod stribeck_friction;
mod supply_sag;
#[cfg(test)]
mod tests;
mod thermal_softening;
mod tone_ring;
mod valve_rate_limit;
mod viscoelastic_stiffening;
mod viscous_drag;

use super::Effect;

/// All effects, by family, in the order in which they are shown.
pub const EFFECTS: &[Effect] = &[
    relaxation_length::EFFECT,
    carcass_compliance::EFFECT,
    belt_mode::EFFECT,
    pressure_dependent_friction::EFFECT,
    load_sensitivity::EFFECT,
    speed_dependent_friction::EFFECT,
    speed_dependent_friction::BOTH_AXES,
    speed_dependent_friction::BY_WHEEL_SPEED,
    falling_branch::EFFECT,
    thermal_softening::EFFECT,
    thermal_softening::SIDEWAYS,
    thermal_softening::BOTH_AXES,
    inflation_warm_up::EFFECT,
    inflation_warm_up::BY_LOAD,
    viscoelastic_stiffening::EFFECT,
    payne::EFFECT,
    rolling_resistance::EFFECT,
    drum_curvature::EFFECT,
    drum_curvature::BY_SLIP,
    drum_curvature::AT_LOAD,
    drum_curvature::ROLLING,
    camber_thrust::EFFECT,
    camber_thrust::BY_LOAD,
    conicity::EFFECT,
    plysteer::EFFECT,
    plysteer::AS_ANGLE,
    non_uniformity::EFFECT,
    non_uniformity::WITH_SECOND,
    non_uniformity::OF_STIFFNESS,
    loss_of_contact::EFFECT,
    lift_off::EFFECT,
    hydraulic_lag::EFFECT,
    hydraulic_hold_off::EFFECT,
    valve_rate_limit::EFFECT,
    disc_thickness_variation::EFFECT,
    brake_torque_variation::EFFECT,
    pad_fade::EFFECT,
    pad_fade::BY_PRESSURE,
    pad_onset::EFFECT,
    pad_onset::BY_PRESSURE,
    tone_ring::EFFECT,
    rolling_radius::EFFECT,
    rolling_radius::BY_LOAD,
    imbalance::EFFECT,
    driveline_compliance::EFFECT,
    backlash::EFFECT,
    quadratic_damper::EFFECT,
    added_inertia::EFFECT,
    play::EFFECT,
    damper_asymmetry::EFFECT,
    bump_stop::EFFECT,
    bushing_hysteresis::EFFECT,
    steering_compliance::EFFECT,
    steering_compliance::BY_SIDE_FORCE,
    steering_compliance::STEER,
    steering_compliance::STEER_BY_SIDE_FORCE,
    fixture_inertia::EFFECT,
    frame_resonance::EFFECT,
    belt_order::EFFECT,
    seal_friction::EFFECT,
    guide_friction::EFFECT,
    guide_drag::EFFECT,
    actuator_lag::EFFECT,
    actuator_rate_limit::EFFECT,
    actuator_limit::EFFECT,
    actuator_dead_band::EFFECT,
    actuator_resonance::EFFECT,
    sensor_delay::EFFECT,
    sensor_lag::EFFECT,
    sensor_bias::EFFECT,
    input_offset::EFFECT,
    sensor_drift::EFFECT,
    sensor_gain::EFFECT,
    sensor_nonlinearity::EFFECT,
    cross_talk::EFFECT,
    quantisation::EFFECT,
    saturation::EFFECT,
    supply_sag::EFFECT,
    clock_drift::EFFECT,
    mains_hum::EFFECT,
    constant_force::EFFECT,
    coulomb_friction::EFFECT,
    coulomb_friction::BY_DIRECTION,
    progressive_spring::EFFECT,
    asymmetric_spring::EFFECT,
    viscous_drag::EFFECT,
    bouc_wen::EFFECT,
    maxwell_element::EFFECT,
    amplitude_softening::EFFECT,
    clearance::EFFECT,
    stribeck_friction::EFFECT,
    load_dependent_friction::EFFECT,
    load_dependent_friction::WITH_BASE,
    frictional_heating::EFFECT,
    aero_drag::EFFECT,
];
