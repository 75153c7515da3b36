//! The energy that a coupling makes: effort and motion are exchanged at communication points only, so the
//! two sides of a connection do not see the same power.

use super::System;
use super::master::Flow;
use super::system::{Port, Wire};
use crate::model::unit::Unit;
use crate::{Error, Result};
use std::collections::{HashMap, HashSet};

/// How far from 1 the ratio of the factors of a bond's two connections may be.
const FACTOR_TOLERANCE: f64 = 1e-9;

/// Two connections between two components whose product is a power: a force (or moment) one way, a
/// velocity or displacement (or their angular counterparts) the other way.
///
/// The side that receives the effort u and moves with its own velocity v takes up the work ∫u v dt; the
/// side that delivers the effort e and is told the velocity w gives away ∫e w dt. What the first takes
/// and the second does not give was made by the coupling. A spring of stiffness k whose force is held
/// for T makes as much as a damper of d = -k T/2 (see docs/cosimulate.md).
#[derive(Debug, Clone)]
pub struct Bond {
    /// Names of its two outputs, `effort` and `motion`.
    pub name: (String, String),
    /// What the motion is.
    pub kind: BondKind,
    /// Energy that the coupling made so far; negative: that it took \[J\].
    pub generated: f64,
    /// Energy that went to and fro so far: the sum of the amounts over all intervals \[J\].
    pub exchanged: f64,
    /// Integral of the squared velocity \[m²/s or rad²/s\].
    pub squared: f64,
    pub(super) effort: Ends,
    pub(super) motion: Ends,
    /// Sign of the delivered work, so that both sides count the same way.
    sign: f64,
    /// To joules: of effort as received and motion as sent, of effort as sent and motion as received.
    scales: (f64, f64),
    /// To SI, of the motion as sent.
    motion_scale: f64,
    /// What the delivering side was told last of a displacement.
    told: Option<f64>,
}

/// Both ends of a connection.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Ends {
    pub from: Port,
    pub to: Port,
}

/// What a bond's motion is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum BondKind {
    /// Velocity or angular speed.
    Flow,
    /// Displacement or angle.
    Displacement,
}

impl Bond {
    /// The outputs, effort and motion.
    pub fn outputs(&self) -> [Port; 2] {
        [self.effort.from, self.motion.from]
    }

    /// True if it is a moment and an angle or angular speed.
    pub fn turns(&self, system: &System) -> bool {
        let unit = system.info(self.effort.from).unit.as_deref();
        unit.and_then(role).is_some_and(|(_, rotation)| rotation)
    }

    /// The damper on the motion that would take the same energy \[N.s/m or N.m.s/rad\]; negative where the
    /// coupling excites. NaN without motion.
    pub fn equivalent_damping(&self) -> f64 {
        -self.generated / self.squared
    }

    /// Share of the exchanged energy that the coupling made, positive or negative; 0 without exchange.
    pub fn share(&self) -> f64 {
        if self.exchanged > 0.0 { self.generated / self.exchanged } else { 0.0 }
    }

    /// Adds one interval of `length` seconds.
    pub(super) fn add(&mut self, effort: &Flow, motion: &Flow, length: f64) {
        let (taken, given) = match self.kind {
            BondKind::Flow => (
                length * product(effort.applied, motion.sent()),
                length * product(effort.sent(), motion.applied),
            ),
            BondKind::Displacement => {
                // a held displacement moves in one jump, between the forces before and after it
                let told = self.told.replace(motion.applied.1).unwrap_or(motion.applied.0);
                let (before, after) = motion.sent();
                (mean(effort.applied) * (after - before), mean(effort.sent()) * (motion.applied.1 - told))
            }
        };
        let (taken, given) = (self.scales.0 * taken, self.sign * self.scales.1 * given);
        self.generated += taken - given;
        self.exchanged += taken.abs();
        let (v0, v1) = motion.sent();
        self.squared += self.motion_scale
            * self.motion_scale
            * match self.kind {
                BondKind::Flow => length * product((v0, v1), (v0, v1)),
                BondKind::Displacement => (v1 - v0) * (v1 - v0) / length,
            };
    }

    pub(super) fn reset(&mut self, told: f64) {
        self.told = Some(told);
        (self.generated, self.exchanged, self.squared) = (0.0, 0.0, 0.0);
    }
}

/// Mean over an interval of the product of two straight courses.
fn product(a: (f64, f64), b: (f64, f64)) -> f64 {
    (2.0 * a.0 * b.0 + a.0 * b.1 + a.1 * b.0 + 2.0 * a.1 * b.1) / 6.0
}

fn mean(a: (f64, f64)) -> f64 {
    0.5 * (a.0 + a.1)
}

/// What a unit is in a bond.
#[derive(Clone, Copy, PartialEq)]
enum Role {
    Effort,
    Motion(BondKind),
}

/// What a unit can be in a bond, whether of translation or rotation.
fn role(unit: &str) -> Option<(Role, bool)> {
    let unit = Unit::parse(unit).ok()?;
    let is = |text: &str| Unit::parse(text).is_ok_and(|u| u.exponents == unit.exponents);
    [
        ("N", Role::Effort, false),
        ("m/s", Role::Motion(BondKind::Flow), false),
        ("m", Role::Motion(BondKind::Displacement), false),
        ("N.m", Role::Effort, true),
        ("rad/s", Role::Motion(BondKind::Flow), true),
        ("rad", Role::Motion(BondKind::Displacement), true),
    ]
    .into_iter()
    .find(|(text, ..)| is(text))
    .map(|(_, role, rotation)| (role, rotation))
}

impl System {
    /// Declares that two outputs are a bond: `effort` is connected to the component of `motion`, and
    /// `motion` to the component of `effort`.
    ///
    /// # Errors
    /// Outputs that are not connected so, connections whose factors do not keep power.
    pub fn bond(&mut self, effort: Port, motion: Port, kind: BondKind) -> Result<()> {
        let (effort_name, motion_name) = (self.name(effort), self.name(motion));
        let wire = |from: Port, to: Port| {
            self.wires.iter().find(|w| w.from == from && w.to.component == to.component).ok_or_else(|| {
                let to = &self.components[to.component].name;
                Error::variable(format!(
                    "the bond of {effort_name} and {motion_name}: {} is not connected to an input of {to}",
                    self.name(from)
                ))
            })
        };
        let (e, m) = (wire(effort, motion)?, wire(motion, effort)?);
        let (e_factor, m_factor) = (self.si_factor(e), self.si_factor(m));
        let sign = e_factor / m_factor;
        if (sign.abs() - 1.0).abs() > FACTOR_TOLERANCE {
            return Err(Error::variable(format!(
                "the bond of {effort_name} and {motion_name}: the connections multiply the effort by {e_factor} and the motion by {m_factor}; they would have to be equal, but for the sign, to keep power"
            )));
        }
        let scale = |port| self.si(port);
        let bond = Bond {
            name: (effort_name, motion_name),
            kind,
            generated: 0.0,
            exchanged: 0.0,
            squared: 0.0,
            effort: Ends { from: e.from, to: e.to },
            motion: Ends { from: m.from, to: m.to },
            sign: sign.signum(),
            scales: (scale(e.to) * scale(m.from), scale(e.from) * scale(m.to)),
            motion_scale: scale(m.from),
            told: None,
        };
        self.bonds.push(bond);
        Ok(())
    }

    /// Finds bonds by units: N with m/s or m, N.m with rad/s or rad, both ways between two components.
    /// Where there are several candidates nothing is assumed, and a warning says so.
    pub fn find_bonds(&mut self) {
        let mut found = Vec::new();
        let mut unclear = Vec::new();
        let mut candidates: Vec<(usize, usize, bool, Role, Port)> = Vec::new();
        for wire in &self.wires {
            let unit = self.info(wire.from).unit.as_deref();
            if let Some((role, rotation)) = unit.filter(|_| wire.real).and_then(role) {
                candidates.push((wire.from.component, wire.to.component, rotation, role, wire.from));
            }
        }
        let mut between: HashMap<(usize, usize, bool), Vec<(Role, Port)>> = HashMap::new();
        for (a, b, rotation, role, port) in &candidates {
            between.entry((*a, *b, *rotation)).or_default().push((*role, *port));
        }
        let pick = |a: usize, b: usize, rotation: bool, role: Role| -> Vec<Port> {
            let all = between.get(&(a, b, rotation)).into_iter().flatten();
            all.filter(|(r, _)| *r == role).map(|(_, port)| *port).collect()
        };
        let mut seen = HashSet::new();
        for (a, b, rotation, ..) in candidates.iter().filter(|c| c.3 == Role::Effort && c.0 != c.1) {
            let key = (*a, *b, *rotation);
            if !seen.insert(key) {
                continue;
            }
            let efforts = pick(*a, *b, *rotation, Role::Effort);
            let flows = pick(*b, *a, *rotation, Role::Motion(BondKind::Flow));
            let displacements = pick(*b, *a, *rotation, Role::Motion(BondKind::Displacement));
            // where the displacement is told as well, it is what the force follows from
            let (motions, kind) = match displacements.is_empty() {
                true => (flows, BondKind::Flow),
                false => (displacements, BondKind::Displacement),
            };
            match (&efforts[..], &motions[..]) {
                (_, []) => {}
                ([effort], [motion]) => found.push((*effort, *motion, kind)),
                _ => unclear.push((*a, *b)),
            }
        }
        for (effort, motion, kind) in found {
            if let Err(e) = self.bond(effort, motion, kind) {
                self.warn(format!("{e}; its energy is not watched"));
            }
        }
        for (a, b) in unclear {
            self.warn(format!(
                "between {} and {} there are several forces or motions; which of them belong together is not guessed, so the energy of this coupling is not watched unless [[bond]] says it",
                self.components[a].name, self.components[b].name
            ));
        }
    }

    /// The bonds, with the energies of the last run.
    pub fn bonds(&self) -> &[Bond] {
        &self.bonds
    }

    /// Factor to SI units.
    fn si(&self, port: Port) -> f64 {
        self.info(port).unit.as_deref().and_then(|u| Unit::parse(u).ok()).map_or(1.0, |u| u.factor)
    }

    /// What a connection multiplies by, apart from the conversion of units.
    fn si_factor(&self, wire: &Wire) -> f64 {
        wire.map.map_or(1.0, |(factor, _)| factor) * self.si(wire.to) / self.si(wire.from)
    }
}
