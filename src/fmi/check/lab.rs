//! What a case is, and what it works with.

use super::finding::Level;
use super::reporter::{FRAGILE, Reporter};
use super::system::CallNote;
use super::unit::{Maker, Unit};
use crate::fmi::import::Description;
use crate::model::{Causality, Kind, Value, VariableInfo};
use std::ffi::c_int;
use std::path::PathBuf;
use std::time::{Duration, Instant};

/// The name of all instances.
pub(super) const NAME: &str = "unit under test";
/// A value reference that no FMU has.
pub(super) const NOWHERE: u32 = 0xfffe_fffe;
/// Results that differ by less than this share of a variable's size are the same but for rounding: a run that
/// is compared takes some 40 steps of some hundred operations each, with an error of 1e-16 each.
const ROUNDING: f64 = 1e-12;

/// Something to try.
pub(super) struct Case {
    /// As in the report.
    pub(super) name: &'static str,
    /// The rule that a crash or a hang breaks.
    pub(super) rule: &'static str,
    /// How bad a crash or a hang is.
    pub(super) level: Level,
    /// As part of a sentence: "while ...".
    pub(super) title: &'static str,
    /// Whether it makes sense for this FMU.
    pub(super) applies: fn(&Description) -> bool,
    pub(super) run: fn(&Lab<'_>),
}

/// What a case works with.
pub(super) struct Lab<'a> {
    pub(super) maker: Maker<'a>,
    pub(super) note: &'a CallNote,
    pub(super) description: &'a Description,
    pub(super) reporter: &'a Reporter,
    /// How bad what this case finds is.
    pub(super) level: Level,
    /// The folder of the resources, as a URI.
    pub(super) resources: String,
    /// The same as a path.
    pub(super) folder: PathBuf,
    /// Where the case may write.
    pub(super) work: PathBuf,
    pub(super) begin: Instant,
    pub(super) timeout: Duration,
}

/// Values as bits, to be compared exactly.
pub(super) type Bits = Vec<u64>;

impl<'a> Lab<'a> {
    /// Communication step \[s\].
    pub(super) fn h(&self) -> f64 {
        let e = &self.description.experiment;
        match (e.step_size, e.stop) {
            (None, Some(stop)) if stop > self.t(0) => (stop - self.t(0)) / 500.0,
            _ => self.description.interface.communication_step,
        }
    }

    /// The communication point after `k` steps \[s\].
    pub(super) fn t(&self, k: u32) -> f64 {
        let start = self.description.interface.start_time;
        if k == 0 { start } else { start + f64::from(k) * self.h() }
    }

    pub(super) fn variables(&self) -> &'a [VariableInfo] {
        &self.description.interface.variables
    }

    /// True when a share of the time limit has passed.
    pub(super) fn late(&self, share: f64) -> bool {
        self.begin.elapsed() > self.timeout.mul_f64(share)
    }

    /// A new instance. That it can be made is checked by `run`.
    pub(super) fn unit(&self) -> Option<Unit<'a>> {
        self.maker.make(NAME, &self.description.guid, &self.resources).ok()
    }

    /// Initializes, with start values of inputs `change`d.
    pub(super) fn initialize(&self, unit: &mut Unit<'_>) -> bool {
        unit.setup(self.t(0), None) <= 1 && unit.enter() <= 1 && unit.exit() <= 1
    }

    /// A new instance that is ready for the first step.
    pub(super) fn ready(&self) -> Option<Unit<'a>> {
        let mut unit = self.unit()?;
        self.initialize(&mut unit).then_some(unit)
    }

    /// Outputs and local variables as bits; texts are left out.
    pub(super) fn read(&self, unit: &mut Unit<'_>) -> Option<Bits> {
        let mut bits = Vec::new();
        for v in self.variables() {
            if !matches!(v.causality, Causality::Output | Causality::Local) {
                continue;
            }
            let (status, value) = match v.kind {
                Kind::Real => {
                    let (status, value) = unit.get_real(v.reference);
                    (status, value.to_bits())
                }
                Kind::Integer | Kind::Enumeration(_) => {
                    let (status, value) = unit.get_integer(v.reference);
                    (status, value as u64)
                }
                Kind::Boolean => {
                    let (status, value) = unit.get_boolean(v.reference);
                    (status, u64::from(value))
                }
                Kind::Text => continue,
            };
            if status > 1 {
                return None;
            }
            bits.push(value);
        }
        Some(bits)
    }

    /// Moves the real inputs a little, each within its limits; `k` is the number of the step.
    pub(super) fn excite(&self, unit: &mut Unit<'_>, k: u32) -> bool {
        self.variables().iter().filter(|v| is_real_input(v)).all(|v| {
            let start = start_of(v);
            let reach = match (v.min, v.max) {
                (_, Some(max)) if max > start => (max - start).min(nominal(v)),
                (Some(min), Some(_)) => (min - start).max(-nominal(v)),
                _ => nominal(v),
            };
            let value = start + 0.02 * reach * (0.5 - 0.5 * (0.3 * f64::from(k)).cos());
            unit.set_real(v.reference, value) <= 1
        })
    }

    /// Makes the steps number `from` to `to`, with moving inputs if `excited`; the values after each.
    pub(super) fn advance(&self, unit: &mut Unit<'_>, from: u32, to: u32, excited: bool) -> Option<Bits> {
        let mut bits = Vec::new();
        for k in from..to {
            if excited && !self.excite(unit, k) || unit.step(self.t(k), self.h()) > 1 {
                return None;
            }
            bits.extend(self.read(unit)?);
        }
        Some(bits)
    }

    /// The variables that [`read`](Self::read) reads.
    pub(super) fn watched(&self) -> Vec<&'a VariableInfo> {
        let shown = |v: &&VariableInfo| {
            matches!(v.causality, Causality::Output | Causality::Local) && v.kind != Kind::Text
        };
        self.variables().iter().filter(shown).collect()
    }

    /// How large each of them is in a run: its largest value, at least its nominal one.
    pub(super) fn sizes(&self, bits: &Bits) -> Vec<f64> {
        let watched = self.watched();
        let n = watched.len().max(1);
        let size = |(i, v): (usize, &&VariableInfo)| {
            let values = bits.iter().skip(i).step_by(n).map(|b| f64::from_bits(*b).abs());
            let nominal = v.nominal.map_or(0.0, f64::abs);
            if v.is_real() { values.filter(|x| x.is_finite()).fold(nominal, f64::max) } else { 0.0 }
        };
        watched.iter().enumerate().map(size).collect()
    }

    /// How far the numbers of two runs are apart at most, infinitely for what has no distance: whole numbers,
    /// NaN. `None` for runs of other lengths.
    pub(super) fn errors(&self, a: &Bits, b: &Bits) -> Option<Vec<f64>> {
        let watched = self.watched();
        let mut errors = vec![0.0; watched.len()];
        if a.len() != b.len() {
            return None;
        }
        for (i, (x, y)) in a.iter().zip(b).enumerate() {
            let at = i % watched.len();
            let difference = (f64::from_bits(*x) - f64::from_bits(*y)).abs();
            if x == y {
                continue;
            }
            let far = !watched[at].is_real() || !difference.is_finite();
            errors[at] = if far { f64::INFINITY } else { difference.max(errors[at]) };
        }
        Some(errors)
    }

    /// Whether two runs are the same, but for rounding and for these errors.
    pub(super) fn same(&self, a: &Bits, b: &Bits, allowed: Option<&[f64]>) -> bool {
        let Some(errors) = self.errors(a, b) else { return false };
        errors.iter().zip(self.sizes(a)).enumerate().all(|(i, (error, size))| {
            let allowed = allowed.and_then(|all| all.get(i)).copied().unwrap_or(0.0);
            *error <= allowed.max(ROUNDING * size)
        })
    }

    /// True if the same calls give the same results in a fresh instance. If not, that is reported: then no
    /// difference says anything of what was done between.
    pub(super) fn repeatable(&self, expected: &Bits, again: impl Fn() -> Option<Bits>) -> bool {
        if !many(self.description) {
            return true;
        }
        let Some(bits) = again() else { return true };
        let same = self.same(expected, &bits, None);
        if !same {
            self.reporter.warning(
                "S12",
                "the same calls give other results in the next instance, so that results of reset, rollback and instances side by side cannot be compared",
            );
        }
        same
    }

    /// Brings an instance between steps to an error; `None` where that is known to crash.
    pub(super) fn make_error(&self, unit: &mut Unit<'_>) -> Option<c_int> {
        (!self.work.join(FRAGILE).exists()).then(|| unit.get_real(NOWHERE).0)
    }

    /// Reports that a call that had to fail did not.
    pub(super) fn refused(&self, rule: &str, level: Level, status: c_int, call: &str) {
        if status <= 1 {
            self.reporter.report(
                level,
                rule,
                format!("{call} returned {}; fmi2Error was expected", word(status)),
            );
        }
    }

    /// Tells the parent that a case could not be carried through although `run` was.
    pub(super) fn unable(&self) {
        self.reporter.warning(
            "M0",
            "the FMU does not take small changes of its inputs, so that less could be checked",
        );
    }
}

/// A status as the standard writes it.
pub(super) fn word(status: c_int) -> &'static str {
    match status {
        0 => "fmi2OK",
        1 => "fmi2Warning",
        2 => "fmi2Discard",
        3 => "fmi2Error",
        4 => "fmi2Fatal",
        5 => "fmi2Pending",
        _ => "an unknown status",
    }
}

pub(super) fn start_of(v: &VariableInfo) -> f64 {
    match v.start {
        Some(Value::Real(start)) => start,
        Some(Value::Integer(start)) => f64::from(start),
        _ => 0.0,
    }
}

pub(super) fn nominal(v: &VariableInfo) -> f64 {
    v.nominal.filter(|n| n.is_finite() && *n != 0.0).unwrap_or(1.0).abs().max(start_of(v).abs())
}

/// Whether several instances may live at the same time.
pub(super) fn many(d: &Description) -> bool {
    !d.capabilities.can_be_instantiated_once
}

pub(super) fn is_real_input(v: &VariableInfo) -> bool {
    v.causality == Causality::Input && v.is_real()
}
