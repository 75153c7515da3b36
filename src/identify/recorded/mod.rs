//! A plan's parameters from recordings of a rig.
//!
//! A plan reads its targets where groups do not depend on later ones: in limits of small speeds and angles. A rig measures at
//! angles that give forces, at speeds at which it runs. So a target is read from a recording by an [`Estimate`] (a slope of a
//! plane through stretches, say), the model is read in the same way at the same inputs, and what both have in common counts: with
//! the estimate m of the recording, M(p) of the model, and the plan's target T(p), the groups are solved for
//!
//! ```text
//! T(p) = m - (M(p') - T(p'))
//! ```
//!
//! with the parameters p' of the round before. Where that comes to rest, M(p) = m.

mod answer;
mod estimate;
mod evidence;
mod figures;
mod matching;
mod misfit;
mod offsets;
mod reduced;
mod response;
mod scatter;
mod search;
mod stretches;
mod suspicion;
mod tangent;
mod uncertainty;
mod unmet;
mod zeros;

pub use answer::{Answer, Found, Light, Told};
pub use estimate::{Estimate, Number, Point};
pub use evidence::{Evidence, Read};
pub use figures::{Characteristic, Quantity, Response};
pub use matching::{Moved, Reading, Signals};
pub use misfit::Misfit;
pub use search::{Beforehand, identify};
pub use unmet::Unmet;
