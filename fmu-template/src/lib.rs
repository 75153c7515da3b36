//! The binary inside the FMUs. To make FMUs of own models, copy this crate and name them here.

latsch::export_fmus!(
    latsch::rig::RingBrushFlatTrack,
    latsch::rig::RingBrushTire,
    latsch::rig::RingBrushWheel,
    latsch::rig::RingBrushCorner,
    latsch::control::BrakeHydraulics,
    latsch::control::AbsController
);
