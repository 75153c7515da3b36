//! The models that are shipped: every tire on every rig, and what brakes.

use crate::control::{AbsController, BrakeHydraulics};
use crate::fmi::Entry;
use crate::rig::{Bare, Corner, FlatTrack, HydroPulse, Wheel};
use crate::tire::magic_formula::MagicFormula;
use crate::tire::ring_brush::RingBrush;
use crate::tire::super_elastic::SuperElastic;

/// Each tire on all rigs, and other models behind them.
macro_rules! models {
    (tires: $($tire:ty),+; others: $($model:ty),+) => {
        &[
            $(
                Entry::of::<FlatTrack<$tire>>(),
                Entry::of::<Bare<$tire>>(),
                Entry::of::<Wheel<$tire>>(),
                Entry::of::<Corner<$tire>>(),
                Entry::of::<HydroPulse<$tire>>(),
            )+
            $(Entry::of::<$model>(),)+
        ]
    };
}

/// Every shipped model.
pub const MODELS: &[Entry] =
    models! { tires: RingBrush, MagicFormula, SuperElastic; others: BrakeHydraulics, AbsController };
