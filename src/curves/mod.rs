//! Characteristic curves of a tire on a flat-track rig: forces and moments in stationary states over slip angle, slip, camber and load, the
//! relaxation length, and the numbers that engineers read from them.
//!
//! A [`Rig`] is a model or FMU that is brought into the state of a [`Condition`]; [`measure`] drives it through a [`Programme`]. Signs are
//! those of ISO 8855: a positive slip angle makes a negative lateral force, and so does a positive camber.

mod programme;
mod readings;
mod rig;
mod write;

pub use programme::{Curve, Kind, Programme, Quantity, Tire, measure};
pub use readings::{Measure, Reading};
pub use rig::Rig;
pub use write::{curves_csv, curves_readings_csv, recordings};

/// What a rig holds.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Condition {
    /// Vertical force on the rim \[N\].
    pub load: f64,
    /// Speed of the wheel's centre \[m/s\].
    pub speed: f64,
    /// Factor on the friction of the road.
    pub friction: f64,
    /// Positive where the wheel travels to its left \[rad\].
    pub slip_angle: f64,
    /// Positive where the wheel turns faster than a free one; -1 is a locked wheel.
    pub slip: f64,
    /// Positive where the top leans to the right \[rad\].
    pub camber: f64,
}

impl std::fmt::Display for Condition {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Self { load, speed, friction, slip_angle, slip, camber } = self;
        let [slip_angle, camber] = [slip_angle, camber].map(|angle| angle.to_degrees());
        write!(
            f,
            "load {load:.0} N, slip angle {slip_angle:.2} deg, slip {slip:.3}, camber {camber:.2} deg, speed {speed} m/s, friction factor {friction}"
        )
    }
}

/// What the rig measures in a stationary state.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Point {
    /// Of the tire on the rim, H axes: origin in the wheel's centre, x level in its heading, z up \[N\].
    pub force: [f64; 3],
    /// About the wheel's centre \[N.m\].
    pub moment: [f64; 3],
    /// Of the wheel's centre over the road \[m\], if the rig tells it.
    pub height: Option<f64>,
    /// Way of the rim towards the road from where the tire just touches \[m\], if the rig tells it.
    pub deflection: Option<f64>,
}

impl Point {
    /// The moment about the place where the wheel's middle plane meets the road below its axis (TYDEX W axes on a level road), where rigs
    /// and Magic Formula have it \[N.m\]; none without the height of the wheel's centre.
    pub fn contact_moment(&self, camber: f64) -> Option<[f64; 3]> {
        let height = self.height?;
        // a wheel whose top leans to the right stands to the left of its centre
        let place = [0.0, height * camber.tan(), -height];
        let [x, y, z] = self.force;
        let moment = [place[1] * z - place[2] * y, place[2] * x, -place[1] * x];
        Some([0, 1, 2].map(|i| self.moment[i] - moment[i]))
    }
}

#[cfg(test)]
mod tests;
