//! The models that are shipped: every tire on every rig, and what brakes.

use crate::control::{AbsController, BrakeHydraulics};
use crate::fmi::Entry;
use crate::rig::{AxleRig, Bare, Corner, CounterbalanceTruck, Drum, FlatTrack, HydroPulse, Vehicle, Wheel};
use crate::tire::classic::{FialaTire, LinearTire, SwiftTire, TmEasyTire, UaTire};
use crate::tire::magic_formula::MagicFormula;
use crate::tire::ring_brush::RingBrush;
use crate::tire::super_elastic::SuperElastic;

/// Each tire on all rigs, classic ones on those where they make sense, and other models behind them.
macro_rules! models {
    (tires: $($tire:ty),+; with_slip: $($slip:ty),+; vertical: $($vertical:ty),+; others: $($model:ty),+) => {
        &[
            $(
                Entry::of::<FlatTrack<$tire>>(),
                Entry::of::<Bare<$tire>>(),
                Entry::of::<Wheel<$tire>>(),
                Entry::of::<Corner<$tire>>(),
                Entry::of::<HydroPulse<$tire>>(),
                Entry::of::<Drum<$tire>>(),
            )+
            $(
                Entry::of::<FlatTrack<$slip>>(),
                Entry::of::<Bare<$slip>>(),
                Entry::of::<Wheel<$slip>>(),
                Entry::of::<Corner<$slip>>(),
            )+
            $(
                Entry::of::<Wheel<$vertical>>(),
                Entry::of::<Corner<$vertical>>(),
                Entry::of::<HydroPulse<$vertical>>(),
                Entry::of::<Drum<$vertical>>(),
                Entry::of::<CounterbalanceTruck<$vertical>>(),
            )+
            $(Entry::of::<$model>(),)+
        ]
    };
}

/// Every shipped model.
pub const MODELS: &[Entry] = models! {
    tires: RingBrush, MagicFormula, SuperElastic;
    with_slip: FialaTire, UaTire, TmEasyTire, SwiftTire;
    vertical: LinearTire;
    others: CounterbalanceTruck<SuperElastic>, Vehicle<RingBrush>, Vehicle<MagicFormula>, AxleRig, BrakeHydraulics, AbsController
};
