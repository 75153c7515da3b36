//! The models that are shipped.

use crate::control::{AbsController, BrakeHydraulics};
use crate::fmi::Entry;
use crate::rig::{RingBrushCorner, RingBrushFlatTrack, RingBrushTire, RingBrushWheel};

/// Every shipped model.
pub const MODELS: &[Entry] = &[
    Entry::of::<RingBrushFlatTrack>(),
    Entry::of::<RingBrushTire>(),
    Entry::of::<RingBrushWheel>(),
    Entry::of::<RingBrushCorner>(),
    Entry::of::<BrakeHydraulics>(),
    Entry::of::<AbsController>(),
];
