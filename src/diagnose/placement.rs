//! Where on a model an effect can sit: target, drivers, and natural sizes of its parameters there.

use super::locate::TIME;
use super::recalled::Natural;
use super::roles::Roles;
use crate::effect::{Attachment, Chosen, Effect, Parameter, Port, Role, Signal, Source, empirical};
use crate::fit::{Drive, Traces};
use crate::model::unit::Unit;
use crate::model::{Causality, Interface, Kind, Variability};
use crate::stats::{about_mean, median};
use std::collections::BTreeSet;
use std::f64::consts::TAU;
use std::sync::Arc;

/// Parameters that effects without a parameter of their own are tried at.
const MAX_TUNABLE: usize = 5;
/// Combinations of drivers that are tried at one target.
const MAX_COMBINATIONS: usize = 6;

/// Two motions are one if the square of their correlation is larger: rates are differences, which are in phase with the mean
/// velocity of a step, so that only what is faster than steps makes a difference.
const SAME: f64 = 0.98;

/// An effect at a place, with the natural sizes of its parameters.
#[derive(Debug, Clone)]
pub struct Placement {
    /// Which effect.
    pub effect: &'static Effect,
    /// What it changes there.
    pub port: Port,
    /// Indices of the changed variables: one, or several that it changes with the same parameters.
    pub targets: Vec<usize>,
    /// What drives it.
    pub drivers: Vec<Signal>,
    /// Size of one unit of each parameter, in the units of the machine.
    pub scales: Vec<f64>,
    /// Units of the parameters, where they have a name.
    pub units: Vec<Option<String>>,
    /// A fit keeps its parameters within what is plausible, not within what can be searched.
    pub bounded: bool,
}

impl Placement {
    /// True if the other one is the same form of the same effect, with the same signals at the same place.
    pub fn is_same(&self, other: &Self) -> bool {
        self.effect.id == other.effect.id
            && self.effect.parameters.iter().map(|p| p.name).eq(other
                .effect
                .parameters
                .iter()
                .map(|p| p.name))
            && self.port == other.port
            && self.targets == other.targets
            && self.drivers == other.drivers
    }

    /// True if the other one is a part of it: the same effect at the same place, driven by some of its signals only.
    pub fn is_fuller(&self, other: &Self) -> bool {
        self.effect.id == other.effect.id
            && self.port == other.port
            && self.targets == other.targets
            && self.drivers.len() > other.drivers.len()
            && other.drivers.iter().all(|signal| self.drivers.contains(signal))
    }

    /// Where a fit may look for a parameter.
    pub fn limits(&self, parameter: &Parameter) -> (f64, f64) {
        let ((low, high), (least, most)) = (parameter.search, parameter.plausible);
        // what is plausible of a shape may reach farther than a fit can go
        if self.bounded { (low.max(least).min(high), high.min(most).max(low)) } else { (low, high) }
    }

    /// Where it is, in words: `output force_y`.
    pub fn place(&self, interface: &Interface) -> String {
        let names: Vec<&str> = self.targets.iter().map(|v| interface.variables[*v].name.as_str()).collect();
        let (names, plural) = (names.join(", "), if names.len() > 1 { "s" } else { "" });
        match self.port {
            Port::Input => format!("input{plural} {names}"),
            Port::Output => format!("output{plural} {names}"),
            Port::Parameter => format!("parameter{plural} {names}"),
            Port::Force => format!("force at {names}"),
        }
    }

    /// The effect attached here with parameters in multiples of their scales.
    pub fn attach(&self, values: &[f64]) -> Vec<Attachment> {
        let chosen = |((parameter, scale), (value, unit)): ((&Parameter, &f64), (&f64, &Option<String>))| {
            Chosen { value: value * scale, range: range(parameter, *scale), unit: unit.clone() }
        };
        let parameters: Vec<Chosen> = self
            .effect
            .parameters
            .iter()
            .zip(&self.scales)
            .zip(values.iter().zip(&self.units))
            .map(chosen)
            .collect();
        let at = |target: &usize| Attachment {
            effect: self.effect,
            target: *target,
            drivers: self.drivers.clone(),
            parameters: parameters.clone(),
        };
        self.targets.iter().map(at).collect()
    }

    /// Names of what it depends on; the time, for a function without a name that no signal drives.
    pub fn depends_on(&self, interface: &Interface) -> Vec<String> {
        if self.drivers.is_empty() && empirical::is(self.effect) {
            return vec![TIME.into()];
        }
        self.drivers
            .iter()
            .map(|signal| {
                let name = &interface.variables[signal.variable].name;
                let text = match signal.source {
                    Source::Value => name.clone(),
                    Source::Rate => format!("rate of {name}"),
                    Source::Integral => format!("integral of {name}"),
                };
                if signal.is_turned { format!("−{text}") } else { text }
            })
            .collect()
    }
}

fn range(parameter: &Parameter, scale: f64) -> (f64, f64) {
    let (low, high) = parameter.search;
    // rounding must not refuse what a search ends at
    let slack = 1e-9 * (high - low) * scale;
    (low * scale - if low == 0.0 { 0.0 } else { slack }, high * scale + slack)
}

/// What placements are made from.
pub struct Site<'a> {
    /// The model.
    pub interface: &'a Interface,
    /// What its variables are.
    pub roles: &'a Roles,
    /// The measured outputs.
    pub measured: &'a [usize],
    /// The driven inputs that move within a run.
    pub driven: Vec<usize>,
    /// Tunable parameters that matter, the most important first.
    pub tunable: Vec<usize>,
    /// What is natural for the machine.
    pub natural: Natural,
}

impl Site<'_> {
    /// Typical size of a signal.
    fn size_of(&self, signal: &Signal) -> f64 {
        match signal.source {
            Source::Value => self.natural.size[signal.variable],
            Source::Rate => self.natural.rate[signal.variable].0,
            Source::Integral => self.natural.rate[signal.variable].1,
        }
    }

    /// Groups of variables that an effect can change together, with the port.
    fn targets(&self, effect: &Effect) -> Vec<(Port, Vec<usize>)> {
        let fits = |v: &usize| {
            effect.targets.is_empty() || effect.targets.iter().any(|role| self.roles.is(*v, *role))
        };
        let forces = (0..self.interface.variables.len()).filter(|v| {
            let info = &self.interface.variables[*v];
            info.causality == Causality::Input && info.kind == Kind::Real && self.roles.is(*v, Role::Force)
        });
        let all: Vec<usize> = match effect.port {
            Port::Output => self.measured.to_vec(),
            Port::Input => self.driven.clone(),
            Port::Parameter => self.tunable.iter().copied().take(MAX_TUNABLE).collect(),
            Port::Force => forces.collect(),
        };
        let mut groups: Vec<(Port, Vec<usize>)> =
            all.into_iter().filter(fits).map(|v| (effect.port, vec![v])).collect();
        // what is one cause, such as the friction of a tire or the clock of a recorder, changes all outputs alike
        let is_relative = effect.parameters.iter().all(|p| p.scale.target == 0);
        if effect.port == Port::Output && is_relative && groups.len() > 1 {
            groups.push((effect.port, groups.iter().flat_map(|g| g.1.clone()).collect()));
        }
        for (port, role) in effect.also {
            let list = if *port == Port::Parameter { &self.tunable } else { &self.driven };
            let own: Vec<usize> = list.iter().copied().filter(|v| self.roles.is(*v, *role)).collect();
            groups.extend(own.iter().map(|v| (*port, vec![*v])));
            if *port == Port::Parameter && is_relative {
                groups.extend(self.of_one_law(&own).into_iter().map(|group| (*port, group)));
            }
        }
        groups
    }

    /// Parameters that a cause changes alike because they are of one law, such as a coefficient at no pressure and at some pressure: those
    /// with the same name but for its last part, and all of them.
    fn of_one_law(&self, parameters: &[usize]) -> Vec<Vec<usize>> {
        let mut groups: Vec<Vec<usize>> = Vec::new();
        for first in parameters {
            let own = stem(self.interface, *first);
            let alike = |v: &usize| !own.is_empty() && stem(self.interface, *v) == own;
            groups.push(parameters.iter().copied().filter(alike).collect());
        }
        groups.push(parameters.to_vec());
        groups.iter_mut().for_each(|group| group.sort_unstable());
        groups.retain(|group| group.len() > 1);
        groups.sort();
        groups.dedup();
        groups
    }

    /// Every place where an effect can sit.
    pub fn placements(&self, effect: &'static Effect) -> Vec<Placement> {
        let mut placements = Vec::new();
        for (port, targets) in self.targets(effect) {
            let lists: Vec<Vec<Signal>> =
                effect.drivers.iter().map(|role| self.drivers(port, *role, &targets)).collect();
            for drivers in combinations(&lists, self.interface) {
                let sizes: Vec<f64> = drivers.iter().map(|s| self.size_of(s)).collect();
                if sizes.iter().any(|s| !(s.is_finite() && *s > 0.0)) {
                    continue;
                }
                let own = self.natural.size[targets[0]];
                let scale = |parameter: &Parameter| {
                    let time = self.natural.time.powi(i32::from(parameter.scale.time));
                    let factor = time * own.powi(i32::from(parameter.scale.target));
                    sizes
                        .iter()
                        .zip(parameter.scale.drivers)
                        .fold(factor, |f, (size, power)| f * size.powi(i32::from(power)))
                };
                let scales: Vec<f64> = effect.parameters.iter().map(scale).collect();
                if scales.iter().any(|s| !(s.is_finite() && *s > 0.0)) {
                    continue;
                }
                let units = effect.parameters.iter().map(|p| self.unit(p, targets[0], &drivers)).collect();
                placements.push(Placement {
                    effect,
                    port,
                    targets: targets.clone(),
                    drivers,
                    scales,
                    units,
                    bounded: false,
                });
            }
        }
        placements
    }

    fn drivers(&self, port: Port, role: Role, targets: &[usize]) -> Vec<Signal> {
        let mut signals = if role == Role::Other {
            // anything that moves
            let moves = |v: &usize| self.natural.size[*v] > 0.0 && !targets.contains(v);
            let variables = self.driven.iter().chain(self.measured).filter(|v| moves(v));
            variables.copied().map(Signal::value).collect()
        } else {
            self.roles.signals(self.interface, role)
        };
        // an output that is changed is no driver of its own change
        if port == Port::Output {
            signals.retain(|s| !targets.contains(&s.variable) || s.source != Source::Value);
        }
        signals.retain(|s| self.size_of(s) > 0.0);
        if matches!(role, Role::Position | Role::Velocity) {
            signals.retain(|s| s.source == Source::Value || !self.natural.shown.contains(&s.variable));
        }
        if port == Port::Force && matches!(role, Role::Position | Role::Velocity) {
            let is_turned =
                |s: &Signal| targets.iter().all(|force| self.natural.against.contains(&(*force, s.variable)));
            signals.iter_mut().for_each(|s| s.is_turned = is_turned(s));
        }
        signals
    }

    fn unit(&self, parameter: &Parameter, target: usize, drivers: &[Signal]) -> Option<String> {
        let of = |variable: usize| {
            let text = self.interface.variables[variable].unit.as_deref().unwrap_or("1");
            Unit::parse(text).ok().filter(|u| u.factor == 1.0 && u.offset == 0.0)
        };
        let scale = parameter.scale;
        let alone = scale.unit == "1" && scale.drivers == [0; 3];
        match (scale.target, scale.time) {
            (1, 0) if alone => return self.interface.variables[target].unit.clone(),
            (0, -1) if alone => return Some("Hz".into()),
            _ => {}
        }
        let mut exponents = Unit::parse(scale.unit).ok()?.exponents;
        let mut add = |more: [i8; 8], power: i8, seconds: i8| {
            for (sum, e) in exponents.iter_mut().zip(more) {
                *sum += e * power;
            }
            exponents[2] += seconds * power;
        };
        add([0; 8], 1, scale.time);
        if scale.target != 0 {
            add(of(target)?.exponents, scale.target, 0);
        }
        for (signal, power) in drivers.iter().zip(scale.drivers) {
            if power != 0 {
                let seconds = match signal.source {
                    Source::Value => 0,
                    Source::Rate => -1,
                    Source::Integral => 1,
                };
                add(of(signal.variable)?.exponents, power, seconds);
            }
        }
        Some(unit_text(exponents))
    }
}

/// The text of a unit, with newtons where a mass comes with a time: `N.m.s/rad`, `kg.m2`.
fn unit_text(mut exponents: [i8; 8]) -> String {
    let mut factors: Vec<(&str, i8)> = Vec::new();
    let sign = exponents[0];
    if sign.abs() == 1 && exponents[2] * sign < 0 {
        factors.push(("N", sign));
        exponents[0] = 0;
        exponents[1] -= sign;
        exponents[2] += 2 * sign;
    }
    factors.extend(crate::model::unit::BASE.iter().copied().zip(exponents).filter(|(_, e)| *e != 0));
    let power = |(name, e): &(&str, i8)| if *e == 1 { (*name).to_owned() } else { format!("{name}{e}") };
    let (above, below): (Vec<_>, Vec<_>) = factors.iter().partition(|(_, e)| *e > 0);
    let product = |factors: &[(&str, i8)]| factors.iter().map(power).collect::<Vec<_>>().join(".");
    match (&above[..], &below[..]) {
        ([], []) => "1".into(),
        ([_, ..], [(name, e)]) => format!("{}/{}", product(&above), power(&(*name, -e))),
        _ => product(&[above, below].concat()),
    }
}

/// One of each list, with signals of one body kept together: a velocity that goes with a position has
/// most of its name, or is its rate.
fn combinations(lists: &[Vec<Signal>], interface: &Interface) -> Vec<Vec<Signal>> {
    let mut all: Vec<Vec<Signal>> = vec![Vec::new()];
    for list in lists {
        all = all
            .iter()
            .flat_map(|head| {
                list.iter().map(|signal| {
                    let mut combination = head.clone();
                    combination.push(*signal);
                    combination
                })
            })
            .collect();
    }
    // a slip may be a slip angle, but not where another driver is that one
    let is_free_of_twins = |c: &Vec<Signal>| (1..c.len()).all(|k| !c[..k].contains(&c[k]));
    if all.iter().any(is_free_of_twins) {
        all.retain(is_free_of_twins);
    }
    let kinship = |combination: &Vec<Signal>| {
        let stems: Vec<&str> = combination.iter().map(|signal| stem(interface, signal.variable)).collect();
        stems.windows(2).filter(|w| w[0] == w[1]).count()
    };
    all.sort_by_key(|c| std::cmp::Reverse(kinship(c)));
    all.truncate(if lists.len() > 1 { MAX_COMBINATIONS } else { all.len() });
    all
}

/// The name of a variable but for its last part.
fn stem(interface: &Interface, variable: usize) -> &str {
    let name = &interface.variables[variable].name;
    &name[..name.rfind(['_', '.']).unwrap_or(0)]
}

/// The velocities and positions that are of one motion, either way and in any unit, as traced.
pub fn shown_twice(
    velocities: &[usize],
    positions: &[usize],
    watch: &[usize],
    traces: &[Traces],
) -> BTreeSet<usize> {
    let course = |variable: usize, of: fn(f64, f64) -> f64| -> Vec<f64> {
        let Some(column) = watch.iter().position(|v| *v == variable) else { return Vec::new() };
        traces.iter().flat_map(|run| run[column].windows(2).map(move |w| of(w[0], w[1]))).collect()
    };
    let product = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    // what it moves in a step is what it goes at on average
    let speeds: Vec<Vec<f64>> = velocities.iter().map(|v| course(*v, |a, b| 0.5 * (a + b))).collect();
    let mut twice = BTreeSet::new();
    for position in positions {
        let ways = course(*position, |a, b| b - a);
        for (velocity, speeds) in velocities.iter().zip(&speeds) {
            if product(&ways, speeds).powi(2) > SAME * product(&ways, &ways) * product(speeds, speeds) {
                twice.extend([*velocity, *position]);
            }
        }
    }
    twice
}

/// The machine's own time: the period of a motion with the spread and rate of a traced variable, of the one in the middle of
/// those `that` are asked for; 1 s where nothing moves.
pub fn own_time(that: &[usize], watch: &[usize], drives: &[Arc<Drive>], traces: &[Traces]) -> f64 {
    let period = |variable: &usize| {
        let column = watch.iter().position(|v| v == variable)?;
        let (mut spread, mut rate) = (0.0, 0.0);
        for (drive, run) in drives.iter().zip(traces) {
            let values = &run[column];
            spread += about_mean(values);
            rate += values.windows(2).map(|w| ((w[1] - w[0]) / drive.step).powi(2)).sum::<f64>();
        }
        Some(TAU * (spread / rate).sqrt())
    };
    let periods: Vec<f64> = that.iter().filter_map(period).filter(|p| p.is_finite() && *p > 0.0).collect();
    if periods.is_empty() { 1.0 } else { median(&periods) }
}

/// Typical sizes of traced variables, and of their rates and integrals: root mean squares over runs.
/// `traces` hold the variables of `watch` for each drive.
pub fn sizes(
    count: usize,
    watch: &[usize],
    drives: &[Arc<Drive>],
    traces: &[Traces],
) -> (Vec<f64>, Vec<(f64, f64)>) {
    let (mut size, mut rate) = (vec![0.0; count], vec![(0.0, 0.0); count]);
    for (column, variable) in watch.iter().enumerate() {
        let mut sums = [0.0; 3];
        let mut samples = 0.0;
        for (drive, run) in drives.iter().zip(traces) {
            let values = &run[column];
            let mut integral = 0.0;
            for (k, value) in values.iter().enumerate() {
                sums[0] += value * value;
                if k > 0 {
                    sums[1] += ((value - values[k - 1]) / drive.step).powi(2);
                    integral += 0.5 * (value + values[k - 1]) * drive.step;
                    sums[2] += integral * integral;
                }
                samples += 1.0;
            }
        }
        let [own, first, second] = sums.map(|s: f64| (s / f64::max(samples, 1.0)).sqrt());
        size[*variable] = own;
        rate[*variable] = (first, second);
    }
    // parameters have the size of their value, which the caller knows
    (size, rate)
}

/// True if a variable can be modulated while the model runs.
pub fn is_tunable(interface: &Interface, variable: usize) -> bool {
    let info = &interface.variables[variable];
    info.causality == Causality::Parameter
        && info.variability == Variability::Tunable
        && info.kind == Kind::Real
}

#[cfg(test)]
mod tests {
    use super::super::subject::Subject;
    use super::*;
    use crate::effect::forms;
    use crate::model::Settings;

    #[test]
    fn units_are_those_that_engineers_write() {
        for text in [
            "N.m.s/rad",
            "N.s/m",
            "N.m",
            "N/m",
            "kg",
            "kg.m2",
            "m/s2",
            "m.s-1.rad-1",
            "1",
            "s-1",
            "kg/m",
            "rad/m",
        ] {
            assert_eq!(unit_text(Unit::parse(text).unwrap().exponents), text);
        }
        assert_eq!(unit_text(Unit::parse("Pa").unwrap().exponents), "N/m2");
    }

    /// Where the forms of an effect may sit on a tire whose four coefficients of friction are free: the parameters that they change together, and
    /// what drives.
    fn on_a_tire(id: &str) -> Vec<(Vec<String>, Vec<String>)> {
        let subject = Subject::load("ring-brush-flat-track", &Settings::default()).unwrap();
        let interface = &subject.interface;
        let find = |name: &&str| interface.index(name).unwrap();
        let tunable = ["sliding_reference", "static_reference", "sliding_zero", "static_zero"];
        let all = |causality: Causality| -> Vec<usize> {
            (0..interface.variables.len())
                .filter(|v| interface.variables[*v].causality == causality)
                .collect()
        };
        let measured = all(Causality::Output);
        let site = Site {
            interface,
            roles: &Roles::of(interface, &[]).unwrap(),
            measured: &measured,
            driven: ["slip", "slip_angle", "path_speed"].iter().map(find).collect(),
            tunable: tunable
                .map(|name| format!("friction_{name}"))
                .iter()
                .map(|n| find(&n.as_str()))
                .collect(),
            natural: Natural::of_ones(interface.variables.len()),
        };
        let names = |variables: &[usize]| -> Vec<String> {
            let mut names: Vec<String> =
                variables.iter().map(|v| interface.variables[*v].name.replace("friction_", "")).collect();
            names.sort();
            names
        };
        let place = |p: Placement| {
            (
                names(&p.targets),
                p.drivers.iter().map(|s| interface.variables[s.variable].name.clone()).collect(),
            )
        };
        forms(id).flat_map(|form| site.placements(form)).map(place).collect()
    }

    #[test]
    fn parameters_of_one_law_change_alike_and_no_signal_drives_twice() {
        let places = on_a_tire("speed-dependent-friction");
        let at = |own: &[&str]| places.iter().filter(|(targets, _)| targets == own).count();
        // what sliding loses at any pressure, and all friction
        assert!(
            at(&["sliding_reference", "sliding_zero"]) > 0 && at(&["static_reference", "static_zero"]) > 0
        );
        assert!(at(&["sliding_reference", "sliding_zero", "static_reference", "static_zero"]) > 0);
        // each by itself as well, and nothing that has no part in common
        assert!(at(&["sliding_zero"]) > 0 && at(&["sliding_zero", "static_zero"]) == 0);
        let both = vec!["path_speed".to_owned(), "slip_angle".into(), "slip".into()];
        assert!(places.iter().any(|(targets, by)| targets.len() == 2 && *by == both));
        for (_, by) in &places {
            assert_eq!(by.iter().collect::<BTreeSet<_>>().len(), by.len(), "{by:?}");
        }
    }

    #[test]
    fn a_motion_that_is_shown_twice_is_known_by_its_course() {
        // two oscillations every 0.1 s; the velocity of the first, in another unit and counted the other way
        let course = |of: fn(f64) -> f64| (0..400).map(|k| of(0.1 * f64::from(k))).collect::<Vec<f64>>();
        let first = course(|t| t.sin() + 0.2 * (3.1 * t).cos());
        let second = course(|t| (0.7 * t).sin());
        let velocity = course(|t| -3.6 * (t.cos() - 0.62 * (3.1 * t).sin()));
        let rest = course(|_| 0.0);
        let watch = [2, 5, 7, 9];
        let traces = vec![vec![first, second, velocity, rest]];
        assert_eq!(shown_twice(&[7], &[2, 5, 9], &watch, &traces), BTreeSet::from([2, 7]));
        // what rests shows nothing, and what is not traced is not known
        assert!(shown_twice(&[9, 4], &[2, 5], &watch, &traces).is_empty());
    }
}
