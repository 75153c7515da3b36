//! The simplest models of published sets of recordings: what one would begin with. Each lacks an effect that the
//! recordings show, and `latsch diagnose` has to find out which. `scripts/real-recordings` makes runs of the recordings.
// the same bits on every processor, as clippy.toml says
#![cfg_attr(not(test), deny(clippy::disallowed_methods))]
#![cfg_attr(test, allow(clippy::disallowed_methods))]

mod cascaded_tanks;
mod constant_moment;
mod linear_oscillator;
mod pneumatic_cylinder;
mod positioning_axis;
mod rk4;
mod servo_pendulum;
mod torque_pendulum;

pub use cascaded_tanks::CascadedTanks;
pub use constant_moment::ConstantMoment;
pub use linear_oscillator::LinearOscillator;
pub use pneumatic_cylinder::PneumaticCylinder;
pub use positioning_axis::PositioningAxis;
pub use servo_pendulum::ServoPendulum;
pub use torque_pendulum::TorquePendulum;

latsch::export_fmus!(
    LinearOscillator,
    PneumaticCylinder,
    ConstantMoment,
    ServoPendulum,
    CascadedTanks,
    PositioningAxis,
    TorquePendulum
);
