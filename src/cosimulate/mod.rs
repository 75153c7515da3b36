//! Co-simulation: models and FMUs wired to each other, stepped by one master.
//!
//! A [`System`] holds named [`Slave`](crate::model::Slave)s and what connects them. [`Plan`] is what a
//! file says of a system, before its components are loaded: [`read_system`] reads the short form in TOML,
//! and System Structure Descriptions (SSP 1.0). [`cosimulate`] runs a system and records;
//! [`SystemSlave`] is a system as one slave.
//!
//! Between two communication points each component integrates on its own. What it gets from the others
//! is held during that time (zero-order hold), unless a connection or iteration asks for more. The
//! order in which components are stepped ([`Coupling::order`]) decides about delay and energy; see
//! docs/cosimulate.md.

mod corrected;
mod energy;
mod file;
mod friction_level;
mod master;
mod plan;
mod run;
mod slave;
mod ssd;
mod system;
mod toml;
mod write;

pub use corrected::write_corrected;
pub use energy::{Bond, BondKind};
pub use file::{SystemFile, read_system};
pub use friction_level::{FrictionLevel, Tried, WheelMatch, friction_inputs, friction_level};
pub use master::{Coupling, Turn};
pub use plan::{
    Assignment, Plan, PlannedBond, PlannedComponent, PlannedConnection, PlannedConnector, PlannedInputs,
    PortName, Source,
};
pub use run::{ENERGY_SHARE, Experiment, Outcome, Until, cosimulate, cosimulate_until, energy_warnings};
pub use slave::SystemSlave;
pub use ssd::parse_ssd;
pub use system::{Component, Cut, Port, System, Transfer};
pub use toml::parse_toml;
