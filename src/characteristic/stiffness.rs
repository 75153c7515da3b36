//! Stiffness of an element over the load: from loops of the whole tire.

use super::answer::{AtLoad, Coefficient, LoopAnswer, Point, list};
use super::geometry::{Phase, Wheel, printed};
use super::laws::{Known, mean_of};
use super::loops::{self, Loop};
use super::plan::{Law, LoopPlan, Plan, cut};
use super::power_law::{LAW_MISSES, SPAN, mean_with_scatter, merged, power, span};
use super::series::{Ends, Even, refuse_clipped};
use crate::recording::Recording;
use crate::{Error, Result};

/// An exponent with half an interval wider than this is not told: at twice the load the coefficient would be open by 7 %.
const TOLD_STIFFNESS: f64 = 0.1;
/// An exponent of the stiffness below this is none: at twice the load it is 1.4 %, which a millimetre of zero makes of it.
const NO_EXPONENT: f64 = 0.02;
/// Points of the stiffness, from this share of the largest load on: below, the zero of the deflection decides.
const LOADS: (usize, f64) = (8, 0.2);

pub(super) fn one_loop(
    plan: &Plan,
    part: &LoopPlan,
    read: &dyn Fn(&str) -> Result<Recording>,
) -> Result<Loop> {
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
pub(super) fn loads(plan: &Plan, loops: &[Loop]) -> Result<Vec<f64>> {
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

pub(super) fn at_loads(wheel: &Wheel, analysis: &Loop, loads: &[f64]) -> Vec<AtLoad> {
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

pub(super) fn stiffness(
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
    if plan.tire.element_stiffness.is_some() {
        notes.push("element_stiffness of the plan is not used: the loops tell it".into());
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
    let mean = mean_with_scatter(&points);
    let widest = points.iter().map(|p| p.value.half_width).filter(|w| w.is_finite()).fold(0.0, f64::max);
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
