//! Damping of an element over load and speed: from decays of the whole tire, or from what its loops lose.

use super::answer::{Coefficient, DecayAnswer, LoopAnswer, OverSpeed, Point, value_at};
use super::decay;
use super::geometry::{Part, Phase, Wheel, printed};
use super::laws::{Known, linear};
use super::loops::Loop;
use super::plan::{DecayPlan, Law, MassFrom, Plan, cut};
use super::power_law::{LAW_MISSES, mean_with_scatter, merged, power, span};
use super::series::{Ends, Even, refuse_clipped};
use crate::recording::Recording;
use crate::{Error, Result};

/// Of damping, which scatters more: at twice the speed by 20 %.
const TOLD_DAMPING: f64 = 0.27;
/// Share of the contact's length over which elements that go out do not touch any more, from which on it is told.
const EARLY: f64 = 0.01;

/// Damping of an element with which a cycle loses what the loop loses. An element pushes and never pulls: while the tire rises, it leaves
/// the road when its damper takes what its spring gives, k z = - c dz/dt, and loses nothing behind that.
pub(super) fn loop_damping(wheel: &Wheel, stiffness: &Coefficient, analysis: &Loop) -> Known {
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

pub(super) fn one_decay(
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

pub(super) fn mass_notes(decays: &[DecayAnswer]) -> Vec<String> {
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

pub(super) fn damping(
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
    let stands = points.iter().any(|p| p.speed == 0.0);
    let (slow, fast) = span(points.iter().map(|p| p.speed));
    let (light, heavy) = span(points.iter().map(|p| p.load));
    // set points that differ by less than a fifth are one setting and its errors
    let over = [!from_loops && heavy > 1.2 * light, !stands && fast > 1.2 * slow];
    let value = mean_with_scatter(&points);
    let base = Coefficient {
        law: Law::Constant,
        value,
        load_exponent: None,
        speed_exponent: None,
        reference_load,
        reference_speed,
        misses: (points.iter().map(|p| (p.value.value / value.value - 1.0).powi(2)).sum::<f64>()
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
            let of_load = points.iter().filter(|p| (p.load / load - 1.0).abs() < 0.02);
            let mut speeds: Vec<f64> = of_load.map(|p| p.speed).collect();
            // loads that are the same to a percent are not in the order of their speeds
            speeds.sort_by(f64::total_cmp);
            speeds
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
    let one_speed = match stands && fast > 0.0 {
        true => "one decay is of a wheel that stands, and no power of the speed begins there: leave it out"
            .to_owned(),
        false => format!("all decays are at {fast:.2} m/s: one speed tells no law over the speed"),
    };
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

pub(super) fn over_speed(decays: &[DecayAnswer]) -> Vec<OverSpeed> {
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
