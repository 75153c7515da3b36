//! Hydraulics and pads of a wheel's brake: valves, line, caliper, and friction of pads that touch (6.33).

/// What a brake is like.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Pads {
    /// Sum over both pads \[m²\].
    pub(crate) piston_area: f64,
    pub(crate) friction_radius: f64,
    /// Of pads in full contact.
    pub(crate) friction: f64,
    /// Friction at first contact over that.
    pub(crate) onset_share: f64,
    /// From first to full contact \[s\].
    pub(crate) onset_time: f64,
    /// Lag of the caliper behind the line \[s\].
    pub(crate) lag: f64,
}

/// Rates of the line through open valves, and through the check valve where the driver lets go \[Pa/s\].
const BUILD: f64 = 120e6;
const DUMP: f64 = 90e6;
const RELEASE: f64 = 300e6;
/// The pads touch above this pressure \[Pa\].
const CONTACT: f64 = 5e4;

/// A brake at work.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct Brake {
    /// Pressure in the line \[Pa\].
    pub(crate) line: f64,
    /// Pressure in the caliper \[Pa\].
    pub(crate) caliper: f64,
    /// How long the pads have touched \[s\].
    touched: f64,
}

impl Brake {
    /// Goes on for `dt` seconds with the driver's pressure and the openings of inlet and outlet.
    pub(crate) fn follow(&mut self, pads: &Pads, driver: f64, (inlet, outlet): (f64, f64), dt: f64) {
        let driver = driver.max(0.0);
        let before = self.line;
        self.line = if self.line > driver {
            (self.line - (RELEASE + outlet * DUMP) * dt).max(driver)
        } else {
            (self.line + (inlet * BUILD - outlet * DUMP) * dt).clamp(0.0, driver)
        };
        if pads.lag > 0.0 {
            // exact for a line that runs straight
            let (x, slope) = (dt / pads.lag, (self.line - before) / dt);
            let decay = libm::exp(-x);
            let behind = before - slope * pads.lag;
            self.caliper = behind + slope * dt + (self.caliper - behind) * decay;
        } else {
            self.caliper = self.line;
        }
        self.touched = if self.caliper > CONTACT { self.touched + dt } else { 0.0 };
    }

    /// The most that the pads can hold \[N.m\].
    pub(crate) fn torque(&self, pads: &Pads) -> f64 {
        let built = if pads.onset_time > 0.0 {
            let x = (self.touched / pads.onset_time).min(1.0);
            pads.onset_share + (1.0 - pads.onset_share) * x * x * (3.0 - 2.0 * x)
        } else {
            1.0
        };
        built * pads.friction * (self.caliper - CONTACT).max(0.0) * pads.piston_area * pads.friction_radius
    }
}
