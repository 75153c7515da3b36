//! Manoeuvres by which models of tire and vehicle are validated before and after load drives: each a system with its inputs, and what is
//! read from its run.
//!
//! After the additional manoeuvres of G. Mack (2009), section 7.2 (L2616-2636): partial braking tells the load transfer, ABS stops the tire along,
//! a slow ramp steer the tire across; a washboard is the uneven road on which places are certain (L2514).

mod abs_stop;
mod car;
mod partial_braking;
mod ramp_steer;
mod reading;
mod steady_circles;
mod washboard;

pub use car::{Car, Vehicle};
pub use reading::{Reading, readings_csv};

use crate::cosimulate::{Outcome, Plan};
use crate::recording::{Names, Recording};
use crate::{Error, Result};
use std::path::Path;

/// A manoeuvre.
#[derive(Debug, Clone, Copy)]
pub struct Manoeuvre {
    /// Its name.
    pub name: &'static str,
    /// What is done, and what it is for.
    pub what: &'static str,
    run: fn(&Car, &Path) -> Result<Done>,
}

/// A manoeuvre that was driven.
#[derive(Debug)]
pub struct Done {
    /// The system; its files lie in the folder.
    pub plan: Plan,
    /// Outputs and inputs over time.
    pub recording: Recording,
    /// What was read from it.
    pub readings: Vec<Reading>,
    /// What should be known about it.
    pub notes: Vec<String>,
}

/// All manoeuvres.
pub const MANOEUVRES: &[Manoeuvre] = &[
    Manoeuvre {
        name: "partial-braking",
        what: "half of the greatest deceleration, from 80 km/h: load transfer and pitch",
        run: partial_braking::run,
    },
    Manoeuvre {
        name: "abs-stop-80",
        what: "a stop from 80 km/h with ABS on a level road: the tire along",
        run: |car, folder| abs_stop::run(car, folder, 80.0 / 3.6),
    },
    Manoeuvre {
        name: "abs-stop-100",
        what: "the same from 100 km/h",
        run: |car, folder| abs_stop::run(car, folder, 100.0 / 3.6),
    },
    Manoeuvre {
        name: "ramp-steer",
        what: "the steering wheel turned by 30 deg/s, coasting from 100 km/h: the tire across",
        run: ramp_steer::run,
    },
    Manoeuvre {
        name: "steady-circles",
        what: "circles of 100 m with 4, 8 and the greatest m/s2, at constant speed: the tire across, stationary",
        run: steady_circles::run,
    },
    Manoeuvre {
        name: "washboard",
        what: "waves of 2 m and 20 mm from valley to peak, rolling at 50 km/h: forces in links",
        run: washboard::run,
    },
];

impl Manoeuvre {
    /// The manoeuvre called `name`.
    ///
    /// # Errors
    /// None; the message lists those that are there.
    pub fn find(name: &str) -> Result<Self> {
        MANOEUVRES.iter().find(|m| m.name == name).copied().ok_or_else(|| {
            let names: Vec<&str> = MANOEUVRES.iter().map(|m| m.name).collect();
            Error::call(format!("there is no manoeuvre {name:?}; there is {}", names.join(", ")))
        })
    }

    /// Drives it. Input files, and an FMU that is the vehicle, are put in the folder.
    ///
    /// # Errors
    /// A vehicle that cannot be loaded or has not what the manoeuvre needs, a run that ends early, files that cannot be written.
    pub fn drive(&self, vehicle: Vehicle, names: Names, folder: &Path) -> Result<Done> {
        (self.run)(&Car::new(vehicle, names, folder)?, folder)
    }
}

/// The recording of a run that went to its end.
fn whole(outcome: Outcome) -> Result<Recording> {
    match outcome.stopped {
        None => Ok(outcome.recording),
        Some(error) => Err(error),
    }
}
