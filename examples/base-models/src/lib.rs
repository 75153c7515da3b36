//! Base models for trying and proving `latsch diagnose`, as FMUs.
#![cfg_attr(test, allow(clippy::unwrap_used, clippy::expect_used, clippy::panic))]
// the same bits on every processor, as clippy.toml says
#![cfg_attr(not(test), deny(clippy::disallowed_methods))]

mod brake;
mod magic_formula;
mod magic_wheel;
mod oscillator;
mod quarter_car;
mod rk4;
mod steady_tire;
#[cfg(test)]
mod truth;

latsch::export_fmus!(
    oscillator::Oscillator,
    quarter_car::QuarterCar,
    steady_tire::SteadyTire,
    magic_wheel::MagicWheel,
    brake::BrakeCorner,
    brake::AbsBrake
);
