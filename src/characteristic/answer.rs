//! From a plan and its recordings to the coefficients of an element.

use super::decay::{self, Decay};
use super::geometry::{Part, Phase, Wheel, printed};
use super::laws::{Known, linear, mean_of};
use super::loops::{self, Loop};
use super::plan::{DecayPlan, Law, LoopPlan, MassFrom, Plan, cut};
use super::series::{Ends, Even, refuse_clipped};
use crate::recording::{Recording, read_recording};
use crate::{Error, Result};
use serde::Serialize;
use std::path::Path;

/// Loads have to span this factor for an exponent of the load to mean anything: below it, 2 % of stiffness is 0.05 of exponent.
const SPAN: f64 = 1.5;
/// An exponent with half an interval wider than this is not told: at twice the load the coefficient would be open by 7 %.
const TOLD_STIFFNESS: f64 = 0.1;
/// Of damping, which scatters more: at twice the speed by 20 %.
const TOLD_DAMPING: f64 = 0.27;
/// An exponent of the stiffness below this is none: at twice the load it is 1.4 %, which a millimetre of zero makes of it.
const NO_EXPONENT: f64 = 0.02;
/// A power law that misses its points by more than this (root mean square) is no law; then there is a table.
const LAW_MISSES: f64 = 0.03;
/// Share of the contact's length over which elements that go out do not touch any more, from which on it is told.
const EARLY: f64 = 0.01;
/// Points of the stiffness, from this share of the largest load on: below, the zero of the deflection decides.
const LOADS: (usize, f64) = (8, 0.2);

/// What came out.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Answer {
    /// The plan's title.
    pub title: String,
    /// The loops.
    pub loops: Vec<LoopAnswer>,
    /// The decays.
    pub decays: Vec<DecayAnswer>,
    /// Stiffness of an element.
    pub stiffness: Coefficient,
    /// Damping of an element; none without decays and loops.
    pub damping: Coefficient,
    /// Stiffness and damping for other numbers of elements, by the source's sums.
    pub elements: Vec<ForElements>,
    /// Laws of the whole tire's damping over the speed, for each load with three speeds or more.
    pub over_speed: Vec<OverSpeed>,
    /// What a reader has to know.
    pub notes: Vec<String>,
}

/// A loop with what it says of an element.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct LoopAnswer {
    /// The file.
    pub file: String,
    /// The loop itself.
    #[serde(flatten)]
    pub analysis: Loop,
    /// Stiffness at loads.
    pub at: Vec<AtLoad>,
    /// Damping of an element that loses the loop's area \[N.s/m\]: of the standing tire, at the loop's frequency.
    pub element_damping: Known,
}

/// Stiffness at a load.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct AtLoad {
    /// The load \[N\].
    pub load: f64,
    /// The deflection of the mean curve \[m\].
    pub deflection: Known,
    /// Load over deflection k_ges \[N/m\].
    pub secant: Known,
    /// Slope of the mean curve \[N/m\].
    pub tangent: f64,
    /// Stiffness of an element by the source's sum (6-6), one contact point \[N/m\].
    pub printed: f64,
    /// Stiffness of an element of the shipped tire \[N/m\].
    pub element: Known,
}

/// A decay with what it says of an element.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct DecayAnswer {
    /// The file.
    pub file: String,
    /// Channel and its unit.
    pub channel: String,
    /// Its unit.
    pub unit: String,
    /// Wheel load \[N\].
    pub load: f64,
    /// Speed \[m/s\].
    pub speed: f64,
    /// Mass \[kg\],
    pub mass: f64,
    /// and what it is from.
    pub mass_from: MassFrom,
    /// The decay itself.
    #[serde(flatten)]
    pub analysis: Decay,
    /// c_ges = 2 m delta (6-1) \[N.s/m\].
    pub damping: Known,
    /// m (w^2 + delta^2) \[N/m\].
    pub stiffness: Known,
    /// Deflection at the load by the stiffness of the loops \[m\].
    pub deflection: f64,
    /// Slope of the force there, by the geometry \[N/m\].
    pub tangent: f64,
    /// c_ce by the sum of squared cosines (6-10), as printed \[N.s/m\].
    pub by_cosines: f64,
    /// c_ce by the number of elements in contact, which belongs to the compressions (6-4) \[N.s/m\].
    pub by_elements: f64,
    /// c_ce of the shipped tire, rolling \[N.s/m\].
    pub element: Known,
}

/// A coefficient of an element over load and speed.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Coefficient {
    /// How it is written.
    pub law: Law,
    /// Its value at the references.
    pub value: Known,
    /// Exponent of the load.
    pub load_exponent: Option<Known>,
    /// Exponent of the speed.
    pub speed_exponent: Option<Known>,
    /// Reference load \[N\].
    pub reference_load: f64,
    /// Reference speed \[m/s\].
    pub reference_speed: f64,
    /// What was measured: load \[N\], speed \[m/s\], value.
    pub points: Vec<Point>,
    /// Root mean square of what the law misses the points by, as a share.
    pub misses: f64,
    /// Why it is written so.
    pub why: String,
}

/// A coefficient at a load and a speed.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Point {
    /// \[N\]
    pub load: f64,
    /// \[m/s\]
    pub speed: f64,
    /// The coefficient.
    pub value: Known,
}

/// Elements of another number at a load.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct ForElements {
    /// N.
    pub elements: usize,
    /// Load \[N\].
    pub load: f64,
    /// Elements in contact M.
    pub touching: usize,
    /// k_ce by (6-6) \[N/m\].
    pub stiffness: f64,
    /// k_ce of the shipped tire \[N/m\].
    pub tire: f64,
    /// c_ce / c_ges by (6-10).
    pub by_cosines: f64,
    /// c_ce / c_ges by 1 / M.
    pub by_elements: f64,
}

/// The whole tire's damping over speed at a load.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct OverSpeed {
    /// The load \[N\].
    pub load: f64,
    /// c = a v^b: a \[N.s/m at 1 m/s\] and b.
    pub power: [Known; 2],
    /// c = a + b / v: a and b \[N\].
    pub hyperbola: [Known; 2],
    /// Root mean squares of what both leave, over the mean.
    pub misses: [f64; 2],
}

/// Follows a plan; recordings are looked for in `folder`.
///
/// # Errors
/// What the recordings cannot tell, with the file, the channel and what to do.
pub fn characterize(plan: &Plan, folder: &Path) -> Result<Answer> {
    let read = |file: &str| read_recording(&folder.join(file));
    characterize_with(plan, &read)
}

/// The same with recordings from anywhere.
///
/// # Errors
/// As [`characterize`].
pub fn characterize_with(plan: &Plan, read: &dyn Fn(&str) -> Result<Recording>) -> Result<Answer> {
    let flat = plan.wheel(plan.tire.elements, false)?;
    let mut notes = Vec::new();
    let loops: Vec<Loop> = plan
        .loops
        .iter()
        .map(|part| one_loop(plan, part, read).map_err(|e| e.at(format!("loop {:?}", part.file))))
        .collect::<Result<_>>()?;
    let loads = loads(plan, &loops)?;
    let mut answers = Vec::new();
    for (part, analysis) in plan.loops.iter().zip(loops) {
        let at = at_loads(&flat, &analysis, &loads);
        if at.is_empty() {
            return Err(Error::numeric(format!(
                "loop {:?}: none of the loads {} N is within its mean curve, {:.0} to {:.0} N",
                part.file,
                list(&loads),
                analysis.loads[0],
                analysis.loads[1]
            )));
        }
        answers.push(LoopAnswer {
            file: part.file.clone(),
            element_damping: Known::exactly(f64::NAN),
            analysis,
            at,
        });
    }
    let references = references(plan, &loads)?;
    let stiffness = stiffness(plan, &flat, &answers, references, &mut notes)?;
    for answer in &mut answers {
        answer.element_damping = loop_damping(&flat, &stiffness, &answer.analysis);
    }
    let rolling = plan.wheel(plan.tire.elements, true)?;
    let decays: Vec<DecayAnswer> = plan
        .decays
        .iter()
        .map(|part| {
            one_decay(plan, part, &rolling, &stiffness, read)
                .map_err(|e| e.at(format!("decay {:?}", part.file)))
        })
        .collect::<Result<_>>()?;
    notes.extend(mass_notes(&decays));
    if flat.contact.is_none() {
        notes.push("the plan has a rigid contact (contact_stiffness = 0), which the tire cannot have: with its own one it is softer by about 1 to 2 %. For parameters leave contact_stiffness as it is".to_owned());
    }
    let damping = damping(plan, &answers, &decays, references)?;
    let elements = for_elements(plan, &answers)?;
    let over_speed = over_speed(&decays);
    Ok(Answer {
        title: plan.title.clone(),
        loops: answers,
        decays,
        stiffness,
        damping,
        elements,
        over_speed,
        notes,
    })
}

fn list(values: &[f64]) -> String {
    values.iter().map(|v| format!("{v:.0}")).collect::<Vec<_>>().join(", ")
}

fn one_loop(plan: &Plan, part: &LoopPlan, read: &dyn Fn(&str) -> Result<Recording>) -> Result<Loop> {
    let recording = cut(read(&part.file)?, part.between)?;
    let channel = |name: &str, unit: &str, factor: f64, off: f64, free| -> Result<Vec<f64>> {
        let values = recording.channel_in(name, unit)?;
        refuse_clipped(&recording, name, &values, free)?;
        Ok(values.into_iter().map(|v| factor * v - off).collect())
    };
    let off = |q: &Option<super::plan::Quantity>, name: &str, unit: &str| -> Result<f64> {
        Ok(q.as_ref().map(|q| q.in_unit(name, unit)).transpose()?.unwrap_or(0.0))
    };
    let at_touch = off(&part.deflection_at_touch, "deflection_at_touch", "m")?;
    let off_road = off(&part.force_off_road, "force_off_road", "N")?;
    let below = part.below(plan.tire.gravity)?;
    let deflection = channel(&part.deflection, "m", part.deflection_factor, at_touch, Ends::Neither)?;
    let force = channel(&part.force, "N", part.force_factor, off_road, Ends::Lower)?;
    let even = Even::of(&recording, vec![deflection, force])?;
    loops::analyse(&even, part.skip_cycles, below).map_err(|e| e.at(&recording.source))
}

/// The loads of the stiffness: the plan's, or evenly over what the loops have.
fn loads(plan: &Plan, loops: &[Loop]) -> Result<Vec<f64>> {
    let given = &plan.characteristic.loads;
    let most = loops.iter().map(|l| l.loads[1]).fold(0.0, f64::max);
    let least = loops.iter().map(|l| l.loads[0]).fold(f64::INFINITY, f64::min);
    if loops.is_empty() {
        return Ok(Vec::new());
    }
    if !given.is_empty() {
        let missed: Vec<f64> = given
            .iter()
            .copied()
            .filter(|f| !loops.iter().any(|l| (l.loads[0]..=l.loads[1]).contains(f)))
            .collect();
        return match missed.is_empty() {
            true => Ok(given.clone()),
            false => Err(Error::numeric(format!(
                "characteristic: loads: no loop has {} N; mean curves are from {least:.0} to {most:.0} N, and nothing is extrapolated",
                list(&missed)
            ))),
        };
    }
    let (count, share) = LOADS;
    // a hair inside, so that cycles that are a little smaller have them, too
    let (low, high) = ((least + 0.01 * (most - least)).max(share * most), most - 0.02 * (most - least));
    Ok((0..count).map(|k| low + (high - low) * k as f64 / (count - 1) as f64).collect())
}

fn at_loads(wheel: &Wheel, analysis: &Loop, loads: &[f64]) -> Vec<AtLoad> {
    let one = |load: &f64| {
        let load = *load;
        let deflection = analysis.deflection_at(load)?;
        let e = deflection.value;
        let element = wheel.stiffness(load, e, Phase::Below)?;
        // by how much the element's stiffness changes with the deflection
        let other = wheel.stiffness(load, e * 1.001, Phase::Below)?;
        let by = (other - element).abs() / (0.001 * e);
        let half_width = by * deflection.half_width;
        Some(AtLoad {
            load,
            deflection,
            secant: Known { value: load / e, half_width: load / (e * e) * deflection.half_width },
            tangent: analysis.curve.tangent_at(e),
            printed: load / printed(wheel.radius, wheel.elements, e, 0.0).compression,
            element: Known { value: element, half_width },
        })
    };
    loads.iter().filter_map(one).collect()
}

/// Points of the same load and speed made one.
fn merged(points: Vec<Point>) -> Vec<Point> {
    let mut all: Vec<(Point, Vec<Known>)> = Vec::new();
    for point in points {
        // loads and speeds are set to a few percent
        let same = |p: &Point| {
            (p.load / point.load - 1.0).abs() < 0.02 && (p.speed - point.speed).abs() <= 0.03 * point.speed
        };
        match all.iter_mut().find(|(p, _)| same(p)) {
            Some((_, values)) => values.push(point.value),
            None => all.push((point, vec![point.value])),
        }
    }
    let one = |(point, values): (Point, Vec<Known>)| {
        let value = mean_of(&values.iter().map(|v| v.value).collect::<Vec<_>>());
        let own =
            (values.iter().map(|v| v.half_width * v.half_width).sum::<f64>()).sqrt() / values.len() as f64;
        let half_width = match values.len() {
            1 => values[0].half_width,
            _ => value.half_width.min(10.0 * own).max(own),
        };
        Point { value: Known { half_width, ..value }, ..point }
    };
    let mut merged: Vec<Point> = all.into_iter().map(one).collect();
    merged.sort_by(|a, b| a.load.total_cmp(&b.load).then(a.speed.total_cmp(&b.speed)));
    merged
}

fn span(values: impl Iterator<Item = f64>) -> (f64, f64) {
    values.fold((f64::INFINITY, 0.0), |(low, high), v| (low.min(v), high.max(v)))
}

fn geometric_mean(values: impl Iterator<Item = f64>) -> f64 {
    let (sum, n) = values.fold((0.0, 0.0), |(s, n), v| (s + v.ln(), n + 1.0));
    (sum / n).exp()
}

/// A power law through points, by logarithms: value at the references, exponents of load and speed where they are asked for, and what is
/// missed.
fn power(points: &[Point], reference: [f64; 2], over: [bool; 2]) -> Option<(Known, [Option<Known>; 2], f64)> {
    let mut columns = vec![vec![1.0; points.len()]];
    if over[0] {
        columns.push(points.iter().map(|p| (p.load / reference[0]).ln()).collect());
    }
    if over[1] {
        columns.push(points.iter().map(|p| (p.speed / reference[1]).ln()).collect());
    }
    let y: Vec<Known> =
        points.iter().map(|p| Known { value: p.value.value.ln(), half_width: p.value.share() }).collect();
    let found = linear(&columns, &y)?;
    let misses = (0..points.len())
        .map(|i| y[i].value - columns.iter().zip(&found).map(|(c, k)| c[i] * k.value).sum::<f64>())
        .map(|left| left * left)
        .sum::<f64>();
    let misses = (misses / points.len() as f64).sqrt();
    let value = found[0].value.exp();
    let mut rest = found[1..].iter().copied();
    let mut exponent = |is: bool| if is { rest.next() } else { None };
    let exponents = [exponent(over[0]), exponent(over[1])];
    Some((Known { value, half_width: value * found[0].half_width }, exponents, misses))
}

/// Where the constants of power laws hold: the plan's, or the middle of the decays' loads and speeds, or of the loops' loads. One pair for
/// both coefficients, as the tire has it.
fn references(plan: &Plan, loads: &[f64]) -> Result<[f64; 2]> {
    let own =
        |of: &dyn Fn(&DecayPlan) -> Result<f64>| plan.decays.iter().map(of).collect::<Result<Vec<f64>>>();
    let middle = |values: &[f64]| {
        let positive = values.iter().copied().filter(|v| *v > 0.0);
        let middle = geometric_mean(positive);
        (middle.is_finite() && middle > 0.0).then_some(middle)
    };
    let wanted = &plan.characteristic;
    let load = match &wanted.reference_load {
        Some(given) => given.in_unit("reference_load", "N")?,
        // without anything, the tire's own
        None => middle(&own(&DecayPlan::load)?).or_else(|| middle(loads)).unwrap_or(6504.0),
    };
    let speed = match &wanted.reference_speed {
        Some(given) => given.in_unit("reference_speed", "m/s")?,
        None => middle(&own(&DecayPlan::speed)?).unwrap_or(2.0),
    };
    Ok([load, speed])
}

fn stiffness(
    plan: &Plan,
    wheel: &Wheel,
    loops: &[LoopAnswer],
    [reference_load, reference_speed]: [f64; 2],
    notes: &mut Vec<String>,
) -> Result<Coefficient> {
    let wanted = &plan.characteristic;
    if loops.is_empty() {
        let given =
            plan.tire.element_stiffness.as_ref().ok_or_else(|| Error::file("there is no stiffness"))?;
        let value = given.in_unit("element_stiffness", "N/m")?;
        if value <= 0.0 {
            return Err(Error::file(format!("element_stiffness = {value} N/m: it has to be positive")));
        }
        return Ok(Coefficient {
            law: Law::Constant,
            value: Known::exactly(value),
            load_exponent: None,
            speed_exponent: None,
            reference_load,
            reference_speed,
            points: Vec::new(),
            misses: 0.0,
            why: "given".into(),
        });
    }
    let all: Vec<Point> = loops
        .iter()
        .flat_map(|l| &l.at)
        .map(|a| Point { load: a.load, speed: 0.0, value: a.element })
        .collect();
    for point in &all {
        let same = all.iter().filter(|p| p.load == point.load).map(|p| p.value.value);
        let (low, high) = span(same);
        // two readings of one load that are apart by more than a reading's error are two stiffnesses
        if high > 1.03 * low {
            notes.push(format!(
                "loops disagree on the stiffness at {:.0} N by {:.1} %: it depends on frequency, amplitude or mean load, or a zero has moved; the mean is taken, and the tire knows none of these",
                point.load,
                100.0 * (high / low - 1.0)
            ));
            break;
        }
    }
    let points = merged(all);
    let (low, high) = span(points.iter().map(|p| p.load));
    // what cycles scatter, each with all its loads: points of one cycle are not independent
    let single: Vec<f64> = loops
        .iter()
        .flat_map(|l| {
            let powers = powers(wheel, &l.at);
            l.analysis.single.iter().map(|curve| exponent_of(&powers, curve, &l.at)).collect::<Vec<_>>()
        })
        .flatten()
        .collect();
    let fitted = power(
        &points.iter().map(|p| Point { value: Known::exactly(p.value.value), ..*p }).collect::<Vec<_>>(),
        [reference_load, 1.0],
        [true, false],
    );
    let exponent = fitted.as_ref().and_then(|(_, [load, _], _)| *load).map(|fit| {
        let scatter = mean_of(&single).half_width;
        Known {
            half_width: if scatter.is_finite() { fit.half_width.max(scatter) } else { fit.half_width },
            ..fit
        }
    });
    let span_text = format!("loads from {low:.0} to {high:.0} N");
    let narrow = (high < SPAN * low).then(|| {
        format!("{span_text} span a factor of {:.2}: at least {SPAN} is needed to tell how the stiffness depends on the load", high / low)
    });
    let vague = exponent.filter(|e| e.half_width.is_nan() || e.half_width >= TOLD_STIFFNESS).map(|e| {
        format!(
            "the exponent of the load would be {:.2} ± {:.2}: it is not told to {TOLD_STIFFNESS}",
            e.value, e.half_width
        )
    });
    let untold =
        narrow.or(vague).or(exponent.is_none().then(|| format!("{} loads tell no law", points.len())));
    let mean = mean_of(&points.iter().map(|p| p.value.value).collect::<Vec<_>>());
    let widest = points.iter().map(|p| p.value.half_width).filter(|w| w.is_finite()).fold(0.0, f64::max);
    let mean = Known {
        value: mean.value,
        half_width: if mean.half_width.is_finite() { mean.half_width.max(widest) } else { widest },
    };
    let misses_of = |at: &dyn Fn(&Point) -> f64| {
        (points.iter().map(|p| (p.value.value / at(p) - 1.0).powi(2)).sum::<f64>() / points.len() as f64)
            .sqrt()
    };
    let constant = |why: String| Coefficient {
        law: Law::Constant,
        value: mean,
        load_exponent: exponent,
        speed_exponent: None,
        reference_load,
        reference_speed,
        misses: misses_of(&|_| mean.value),
        points: points.clone(),
        why,
    };
    let law = |why: String| {
        let (value, _, misses) = fitted.as_ref()?;
        Some(Coefficient {
            law: Law::Power,
            value: Known { half_width: value.half_width.max(widest), ..*value },
            load_exponent: exponent,
            speed_exponent: None,
            reference_load,
            reference_speed,
            misses: *misses,
            points: points.clone(),
            why,
        })
    };
    let table = |why: String| Coefficient { law: Law::Table, misses: 0.0, ..constant(why) };
    Ok(match wanted.stiffness {
        Law::Constant => constant("asked for".into()),
        Law::Table => match points.len() {
            0 | 1 => return Err(Error::numeric("a table of the stiffness needs at least two loads")),
            _ => table("asked for".into()),
        },
        Law::Power => match untold {
            Some(why) => {
                return Err(Error::numeric(format!(
                    "no power law of the stiffness over the load: {why}. Measure over a wider range, or ask for a constant"
                )));
            }
            None => law("asked for".into())
                .ok_or_else(|| Error::numeric("no power law of the stiffness can be found"))?,
        },
        Law::Auto => match (untold, exponent) {
            (Some(why), _) => constant(why),
            (None, Some(e)) if e.value.abs() <= NO_EXPONENT.max(e.half_width) => constant(format!(
                "over {span_text} it is the same: an exponent of the load would be {:.3} ± {:.3}",
                e.value, e.half_width
            )),
            (None, Some(e)) => match fitted.as_ref().is_some_and(|(_, _, misses)| *misses <= LAW_MISSES) {
                true => law(format!("{span_text}, exponent {:.3} ± {:.3}", e.value, e.half_width))
                    .unwrap_or_else(|| table(span_text.clone())),
                false => table(format!(
                    "over {span_text} no power law: it misses by more than {:.0} %",
                    100.0 * LAW_MISSES
                )),
            },
            (None, None) => constant(span_text),
        },
    })
}

/// By which power of the deflection an element's stiffness goes at each load.
fn powers(wheel: &Wheel, at: &[AtLoad]) -> Vec<f64> {
    let other = |a: &AtLoad| wheel.stiffness(a.load, a.deflection.value * 1.001, Phase::Below);
    at.iter().map(|a| other(a).map_or(f64::NAN, |k| (k / a.element.value).ln() / 1.001_f64.ln())).collect()
}

/// Exponent of the load that one cycle's curve has.
fn exponent_of(powers: &[f64], curve: &loops::Curve, at: &[AtLoad]) -> Option<f64> {
    let point = |(a, by): (&AtLoad, &f64)| {
        let e = curve.deflection_at(a.load)?;
        let value = a.element.value * (e / a.deflection.value).powf(*by);
        value.is_finite().then_some(Point { load: a.load, speed: 0.0, value: Known::exactly(value) })
    };
    let points: Vec<Point> = at.iter().zip(powers).filter_map(point).collect();
    power(&points, [at.first()?.load, 1.0], [true, false])?.1[0].map(|e| e.value)
}

/// The stiffness of an element at a load \[N/m\], as the tire has it.
pub fn value_at(coefficient: &Coefficient, load: f64, speed: f64) -> f64 {
    match coefficient.law {
        Law::Power => {
            let factor = |x: f64, reference: f64, exponent: Option<Known>| match exponent {
                // the tire takes loads and speeds no smaller than a tenth of their references
                Some(e) => (x / reference).max(0.1).powf(e.value),
                None => 1.0,
            };
            coefficient.value.value
                * factor(load, coefficient.reference_load, coefficient.load_exponent)
                * factor(speed, coefficient.reference_speed, coefficient.speed_exponent)
        }
        // of a table of the stiffness, which has no speeds
        Law::Table => {
            let loads: Vec<f64> = coefficient.points.iter().map(|p| p.load).collect();
            let values: Vec<f64> = coefficient.points.iter().map(|p| p.value.value).collect();
            crate::stats::interpolate(&loads, &values, load.clamp(loads[0], loads[loads.len() - 1]))
        }
        _ => coefficient.value.value,
    }
}

/// Damping of an element with which a cycle loses what the loop loses. An element pushes and never pulls: while the tire rises, it leaves
/// the road when its damper takes what its spring gives, k z = - c dz/dt, and loses nothing behind that.
fn loop_damping(wheel: &Wheel, stiffness: &Coefficient, analysis: &Loop) -> Known {
    const PLACES: usize = 160;
    let [low, high] = analysis.deflections;
    let place = |i: usize| low + (high - low) * i as f64 / (PLACES - 1) as f64;
    let k = value_at(stiffness, 0.5 * (analysis.loads[0] + analysis.loads[1]), 0.0);
    let pressed: Vec<_> =
        (0..PLACES).map(|i| if place(i) > 0.0 { wheel.pressed(k, place(i)) } else { Vec::new() }).collect();
    let beyond_spring = |c: f64, e: f64, speed: f64| -> f64 {
        let x = ((e - low) / (high - low) * (PLACES - 1) as f64).clamp(0.0, (PLACES - 1) as f64);
        let of = |(_, part): &(i64, Part)| {
            // the compression at e itself, from the place beside it
            let z = part.compression + part.rate * (e - place(x.round() as usize));
            (c * part.rate * speed).max(-k * z.max(0.0)) * part.counts
        };
        pressed[x.round() as usize].iter().map(of).sum()
    };
    // a loss in proportion to c but for what early leaving takes of it: few rounds
    let mut c = 1e-3 * k;
    for _ in 0..20 {
        let lost = analysis.lost_by(|e, speed| beyond_spring(c, e, speed));
        if lost.is_nan() || lost <= 0.0 {
            return Known { value: f64::NAN, half_width: f64::INFINITY };
        }
        c *= (analysis.area.value / lost).clamp(0.1, 10.0);
    }
    analysis.area.times(c / analysis.area.value)
}

fn one_decay(
    plan: &Plan,
    part: &DecayPlan,
    wheel: &Wheel,
    stiffness: &Coefficient,
    read: &dyn Fn(&str) -> Result<Recording>,
) -> Result<DecayAnswer> {
    let recording = cut(read(&part.file)?, part.between)?;
    let channel = recording.channel(&part.channel)?;
    let (values, unit) = (channel.values.clone(), channel.unit.clone());
    refuse_clipped(&recording, &part.channel, &values, Ends::Neither)?;
    let even = Even::of(&recording, vec![values])?;
    let (load, speed) = (part.load()?, part.speed()?);
    let k = value_at(stiffness, load, speed);
    let phase = if speed > 0.0 { Phase::Rolling } else { Phase::Below };
    let deflection = wheel.deflection(k, load, phase).ok_or_else(|| {
        Error::numeric(format!("elements of {k:.0} N/m do not carry {load:.0} N within half the radius"))
    })?;
    let sums = wheel.sums(k, deflection, phase);
    let source = printed(wheel.radius, wheel.elements, deflection, 0.0);
    let mut impacts = part.impacts()?;
    if impacts.passage > 0.0 {
        // the tire has left a cleat when its contact has
        impacts.passage += source.contact_length / speed;
    }
    let place = format!("{}: channel {:?}", recording.source, part.channel);
    let mut analysis = decay::analyse(&even, impacts).map_err(|e| e.at(place))?;
    let (mass, mass_from) = part.mass(plan.tire.gravity)?;
    let (delta, omega) = (analysis.decay_rate, analysis.frequency);
    let damping = delta.times(2.0 * mass);
    let whole = Known {
        value: mass * (omega.value.powi(2) + delta.value.powi(2)),
        half_width: 2.0 * mass * (omega.value * omega.half_width + delta.value * delta.half_width),
    };
    let element = damping.times(1.0 / sums.damping);
    let early = element.value / k * speed / wheel.radius / source.contact_angle;
    if early > EARLY {
        analysis.notes.push(format!(
            "at {speed:.2} m/s a damper of {:.0} N.s/m lets elements leave the road before the contact's end, over {:.1} % of its length: the sums do not know that, and the damping of an element is open by about as much",
            element.value,
            100.0 * early
        ));
    }
    Ok(DecayAnswer {
        file: part.file.clone(),
        channel: part.channel.clone(),
        unit,
        load,
        speed,
        mass,
        mass_from,
        analysis,
        damping,
        stiffness: whole,
        deflection,
        tangent: sums.slope,
        by_cosines: damping.value * source.damping_share,
        by_elements: damping.value / source.elements as f64,
        element,
    })
}

fn mass_notes(decays: &[DecayAnswer]) -> Vec<String> {
    let mut notes = Vec::new();
    if decays.iter().any(|d| d.mass_from == MassFrom::Load) {
        notes.push(
            "the mass of decays is the load over gravity where nothing else was given. On a swing arm it is the inertia about the pivot over the square of the wheel's distance from it, which differs with where the weights sit, and damping is wrong in that proportion: give pivot_inertia and wheel_arm, or mass".to_owned(),
        );
    }
    for decay in decays {
        let share = decay.stiffness.value / decay.tangent - 1.0;
        // what a stiffness by secant is off by from a tangent is half as much again; a tenth is mass, rig or load dependence
        if share.abs() > 0.1 {
            notes.push(format!(
                "decay {:?}: by its frequency the tire has {:.0} N/mm, by the loops {:.0} N/mm at {:.0} N ({:+.0} %): the mass is another one, the rig swings along, or the stiffness is another one while rolling. The damping goes with the mass",
                decay.file,
                1e-3 * decay.stiffness.value,
                1e-3 * decay.tangent,
                decay.load,
                100.0 * share
            ));
        }
    }
    notes
}

fn damping(
    plan: &Plan,
    loops: &[LoopAnswer],
    decays: &[DecayAnswer],
    [reference_load, reference_speed]: [f64; 2],
) -> Result<Coefficient> {
    let wanted = &plan.characteristic;
    let from_loops = decays.is_empty();
    let points = merged(match from_loops {
        true => loops
            .iter()
            .map(|l| Point {
                load: 0.5 * (l.analysis.loads[0] + l.analysis.loads[1]),
                speed: 0.0,
                value: l.element_damping,
            })
            .collect(),
        false => decays.iter().map(|d| Point { load: d.load, speed: d.speed, value: d.element }).collect(),
    });
    let (slow, fast) = span(points.iter().map(|p| p.speed));
    let (light, heavy) = span(points.iter().map(|p| p.load));
    // set points that differ by less than a fifth are one setting and its errors
    let over = [!from_loops && heavy > 1.2 * light, slow > 0.0 && fast > 1.2 * slow];
    let mean = mean_of(&points.iter().map(|p| p.value.value).collect::<Vec<_>>());
    let widest = points.iter().map(|p| p.value.half_width).filter(|w| w.is_finite()).fold(0.0, f64::max);
    let value = Known {
        half_width: if mean.half_width.is_finite() { mean.half_width.max(widest) } else { widest },
        ..mean
    };
    let base = Coefficient {
        law: Law::Constant,
        value,
        load_exponent: None,
        speed_exponent: None,
        reference_load,
        reference_speed,
        misses: (points.iter().map(|p| (p.value.value / mean.value - 1.0).powi(2)).sum::<f64>()
            / points.len() as f64)
            .sqrt(),
        points: points.clone(),
        why: String::new(),
    };
    if from_loops {
        if matches!(wanted.damping, Law::Power | Law::Table) {
            return Err(Error::numeric(
                "no damping over load and speed without decays: loops are of a wheel that stands. Give [[decay]]s at several speeds, or ask for a constant",
            ));
        }
        if !value.value.is_finite() {
            return Err(Error::numeric("no damping of an element makes the loops' area: give [[decay]]s"));
        }
        return Ok(Coefficient { why: "from the area of the loops: of the standing wheel at the loop's frequency, hysteresis counted as a damper".into(), ..base });
    }
    let constant = |why: &str| Coefficient { why: why.into(), ..base.clone() };
    let whole_grid = || {
        let mut loads: Vec<f64> = points.iter().map(|p| p.load).collect();
        loads.dedup_by(|a, b| (*a / *b - 1.0).abs() < 0.02);
        let row = |load: f64| {
            points.iter().filter(|p| (p.load / load - 1.0).abs() < 0.02).map(|p| p.speed).collect::<Vec<_>>()
        };
        let rows: Vec<Vec<f64>> = loads.iter().map(|l| row(*l)).collect();
        let same = |a: &Vec<f64>, b: &Vec<f64>| {
            a.len() == b.len() && a.iter().zip(b).all(|(a, b)| (a - b).abs() <= 0.03 * b)
        };
        rows.iter().all(|r| same(r, &rows[0]))
    };
    let table = |why: &str| Coefficient { law: Law::Table, misses: 0.0, ..constant(why) };
    let law = |over: [bool; 2], why: String| {
        power(&points, [reference_load, reference_speed], over).map(
            |(value, [load_exponent, speed_exponent], misses)| Coefficient {
                law: Law::Power,
                value,
                load_exponent,
                speed_exponent,
                misses,
                why,
                ..base.clone()
            },
        )
    };
    let vague = |c: &Coefficient| {
        let named = [("load", c.load_exponent), ("speed", c.speed_exponent)];
        named.into_iter().find_map(|(of, e)| {
            let e = e.filter(|e| e.half_width.is_nan() || e.half_width >= TOLD_DAMPING)?;
            Some(format!(
                "the exponent of the {of} would be {:.2} ± {:.2}: it is not told to {TOLD_DAMPING}",
                e.value, e.half_width
            ))
        })
    };
    let one_speed = format!("all decays are at {fast:.2} m/s: one speed tells no law over the speed");
    Ok(match wanted.damping {
        Law::Constant => constant("asked for"),
        Law::Table => match whole_grid() {
            true => table("asked for"),
            false => {
                return Err(Error::numeric(
                    "no table of the damping: there has to be a decay for each load at each of the same speeds",
                ));
            }
        },
        Law::Power if !over[1] => {
            return Err(Error::numeric(format!(
                "no power law of the damping: {one_speed}. Measure at two more, or ask for a constant"
            )));
        }
        Law::Power => {
            let found = law(over, "asked for".into()).ok_or_else(|| {
                Error::numeric(format!("no power law of the damping: {} decays do not tell it", points.len()))
            })?;
            match vague(&found) {
                Some(why) => {
                    return Err(Error::numeric(format!(
                        "no power law of the damping: {why}. Measure over a wider range or longer, or ask for a constant"
                    )));
                }
                None => found,
            }
        }
        Law::Auto if over == [false, false] => constant(&one_speed),
        Law::Auto => match law(
            over,
            format!("loads from {light:.0} to {heavy:.0} N, speeds from {slow:.2} to {fast:.2} m/s"),
        ) {
            Some(found) if vague(&found).is_none() && found.misses <= LAW_MISSES => {
                let why = if over[1] { found.why.clone() } else { format!("{}; {one_speed}", found.why) };
                Coefficient { why, ..found }
            }
            _ if whole_grid() => table("no power law within the decays' own errors"),
            Some(found) if vague(&found).is_none() => Coefficient {
                why: format!(
                    "{}; it misses by {:.0} %, and for a table decays are missing",
                    found.why,
                    100.0 * found.misses
                ),
                ..found
            },
            found => {
                constant(&found.and_then(|f| vague(&f)).unwrap_or_else(|| "the decays tell no law".into()))
            }
        },
    })
}

fn for_elements(plan: &Plan, loops: &[LoopAnswer]) -> Result<Vec<ForElements>> {
    let mut numbers = vec![plan.tire.elements];
    numbers.extend(plan.characteristic.elements.iter().filter(|n| **n != plan.tire.elements));
    let mut all = Vec::new();
    for n in numbers {
        let wheel = plan.wheel(n, false)?;
        for at in loops.iter().flat_map(|l| &l.at) {
            let e = at.deflection.value;
            let source = printed(wheel.radius, n, e, 0.0);
            all.push(ForElements {
                elements: n,
                load: at.load,
                touching: source.elements,
                stiffness: at.load / source.compression,
                tire: wheel.stiffness(at.load, e, Phase::Below).unwrap_or(f64::NAN),
                by_cosines: source.damping_share,
                by_elements: 1.0 / source.elements as f64,
            });
        }
    }
    Ok(all)
}

fn over_speed(decays: &[DecayAnswer]) -> Vec<OverSpeed> {
    let mut loads: Vec<f64> = decays.iter().map(|d| d.load).collect();
    loads.sort_by(f64::total_cmp);
    loads.dedup_by(|a, b| (*a / *b - 1.0).abs() < 0.02);
    let one = |load: f64| {
        let own: Vec<&DecayAnswer> =
            decays.iter().filter(|d| (d.load / load - 1.0).abs() < 0.02 && d.speed > 0.0).collect();
        if own.len() < 3 {
            return None;
        }
        let points: Vec<Point> =
            own.iter().map(|d| Point { load, speed: d.speed, value: d.damping }).collect();
        let (factor, [_, exponent], power_misses) = power(&points, [load, 1.0], [false, true])?;
        let columns = [vec![1.0; own.len()], own.iter().map(|d| 1.0 / d.speed).collect()];
        let y: Vec<Known> = own.iter().map(|d| d.damping).collect();
        let hyperbola = linear(&columns, &y)?;
        let mean = y.iter().map(|y| y.value).sum::<f64>() / y.len() as f64;
        let left = own
            .iter()
            .map(|d| (d.damping.value - hyperbola[0].value - hyperbola[1].value / d.speed).powi(2))
            .sum::<f64>();
        let misses = [power_misses, (left / y.len() as f64).sqrt() / mean];
        Some(OverSpeed { load, power: [factor, exponent?], hyperbola: [hyperbola[0], hyperbola[1]], misses })
    };
    loads.into_iter().filter_map(one).collect()
}
