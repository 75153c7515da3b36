//! All that changes in a tire during a run.

use super::{Bristles, Lag, Loads, PressureState};
use crate::clone_in_place;
use crate::mechanics::{Motion, Wrench};
use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

/// State of the tire and what the last step found out about the patch.
#[derive(Debug, PartialEq, Default, Serialize, Deserialize)]
pub struct State {
    /// The belt.
    pub belt: Motion<f64>,
    /// Accelerations of the belt's centre and Cardan angles \[m/s², rad/s²\].
    pub acceleration: [Vector3<f64>; 2],
    /// The lag of the patch's deformation.
    pub lag: Lag,
    /// Loads of the patch at the end of the last step.
    pub loads: Loads<f64>,
    /// The bristles.
    pub bristles: Bristles,
    /// Force and moment of the tire on the rim, frame 0, about the rim's centre.
    pub on_rim: Wrench<f64>,
    /// The patch at the end of the last step.
    pub patch: PatchReport,
    /// Distance that the patch has slid, the mean over the normal force \[m\].
    pub sliding_distance: f64,
    /// Energy lost in the contact \[J\], of which [`PatchReport::power_loss`] is the rate.
    pub energy_loss: f64,
}

/// The patch at the end of a step, for outputs.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct PatchReport {
    /// Penetration of the belt \[m\].
    pub penetration: f64,
    /// Force of the patch on the belt in K \[N\].
    pub force: Vector3<f64>,
    /// Moment of the patch on the belt in K about the contact point \[N.m\].
    pub moment: Vector3<f64>,
    /// Shift of the patch in x and y \[m\].
    pub shift: [f64; 2],
    /// Twist of the patch \[rad\].
    pub twist: f64,
    /// Largest pressure \[Pa\].
    pub pressure_max: f64,
    /// Sum of the negative normal forces over the normal force.
    pub negative_share: f64,
    /// What became of the pressure distribution.
    pub pressure_state: PressureState,
    /// Bristles that slide, over bristles in contact.
    pub sliding_share: f64,
    /// Power of the friction of bristles that slide \[W\].
    pub friction_power: f64,
    /// Power lost in the contact \[W\]: sliding, the bristles' dampers, their snapping back at break-away
    /// and their leaving the contact bent. Energy leaves bristles as they pass, so it is a mean over the last
    /// [`LOSS_TIME`](super::LOSS_TIME).
    pub power_loss: f64,
}

clone_in_place!(State {
    belt,
    acceleration,
    lag,
    loads,
    bristles,
    on_rim,
    patch,
    sliding_distance,
    energy_loss,
});
