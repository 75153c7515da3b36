//! The ring-and-brush tire: a rigid belt on the rim's spring-dampers, on the road with a patch of
//! bristles.
//!
//! After Kaden, dissertation, TU München 2015 (section 4.1), who reduced the CASCaDE tire of Gipser
//! (Daimler, 1990). Numbers in parentheses are equation numbers of that work.
//!
//! # Axes and signs
//!
//! Frame 0: z up, the flat road at z = 0. Frame G: the belt's body. Frame K: the contact frame, x
//! along the belt's mid-plane, z up. Patch forces act on the belt, wrenches on the rim act on the
//! rim. The lateral signs are those of ISO 8855 but for the slip angle, which the tire does not know:
//! it knows the rim's motion. Positions are seen from the point of the road below the rim's centre:
//! the rim is always at x = y = 0, and the belt's x and y are small. Velocities are over the road.
//!
//! # Stages of a step
//!
//! Belt to mid-step and end (half kick, drift) - contact - stripes - pressure - bristles - what their sums lack - patch lag -
//! side wall and belt (second half kick). See [`Prepared::step`].
//!
//! # Known differences from the source
//!
//! * (4.13): `(B/2)²` under the root, where the print has a wrong dimension.
//! * Stick or slide is a memory of each bristle; the source does not list it among the states.
//! * A bristle that comes into contact within a step is bent from that instant on only, and sums over bristles are
//!   integrals; the source's own numbers seem to come from whole steps, and it sums whole bristles. `whole_step_entry`
//!   does both as it does.
//! * The band of sliding speeds below 1e-4 m/s, over which (4.32) blends static into sliding
//!   friction, is left out: it is unstable and changes forces by less than 1e-4 N.
//! * Roads: the source has flat ones. Here the belt rolls on the plane that a mean over the contact's length makes
//!   of the road under it.

mod belt;
mod bristle;
mod bristles;
mod contact;
mod continuum;
mod ends;
mod entry;
mod friction;
mod lag;
mod parameters;
mod passage;
mod patch;
mod rows;
mod sidewall;
mod state;
mod stationary;
mod step;
mod stretches;
mod stripes;
mod tire;
mod totals;
mod turning;

pub use belt::patch_on_belt;
pub use bristle::{Step, advance};
pub use bristles::Bristles;
pub use contact::Contact;
pub use friction::{Friction, Limits};
pub use lag::Lag;
pub use parameters::Parameters;
pub use passage::{Passage, Sums};
pub use patch::{Deformation, Loads, Moments, Pressure, PressureState, Shape, Tops, moment_y};
pub use sidewall::{Coupling, belt_from_rim, coupling, stationary as stationary_coupling};
pub use state::{PatchReport, State};
pub use stationary::{Moved, Stationary, stationary, stationary_refined};
pub use step::{LOSS_TIME, Prepared};
pub use tire::RingBrush;
