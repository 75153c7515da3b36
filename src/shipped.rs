//! The models that are shipped.

use crate::control::{AbsController, BrakeHydraulics};
use crate::fmi::Entry;
use crate::rig::RingBrushFlatTrack;

/// Every shipped model.
pub const MODELS: &[Entry] =
    &[Entry::of::<RingBrushFlatTrack>(), Entry::of::<BrakeHydraulics>(), Entry::of::<AbsController>()];
