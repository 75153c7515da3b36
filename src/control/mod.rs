//! Brake control: what stands between the driver's pressure and the brake torque of a wheel.

mod abs_controller;
mod brake_hydraulics;

pub use abs_controller::AbsController;
pub use brake_hydraulics::BrakeHydraulics;
