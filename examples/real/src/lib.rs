//! The simplest models of four published sets of recordings: what one would begin with. Each lacks an effect that the
//! recordings show, and `latsch diagnose` has to find out which. `scripts/real-recordings` makes runs of the recordings.
// the same bits on every processor, as clippy.toml says
#![cfg_attr(not(test), deny(clippy::disallowed_methods))]
#![cfg_attr(test, allow(clippy::disallowed_methods))]

mod constant_moment;
mod linear_oscillator;
mod pneumatic_cylinder;
mod servo_pendulum;

pub use constant_moment::ConstantMoment;
pub use linear_oscillator::LinearOscillator;
pub use pneumatic_cylinder::PneumaticCylinder;
pub use servo_pendulum::ServoPendulum;

latsch::export_fmus!(LinearOscillator, PneumaticCylinder, ConstantMoment, ServoPendulum);
