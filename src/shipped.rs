//! The models that are shipped.

use crate::fmi::Entry;
use crate::rig::RingBrushFlatTrack;

/// Every shipped model.
pub const MODELS: &[Entry] = &[Entry::of::<RingBrushFlatTrack>()];
