//! What comes out of a plan and its recordings, and the way there.

use super::damping::{damping, loop_damping, mass_notes, one_decay, over_speed};
use super::decay::Decay;
use super::geometry::{Phase, printed};
use super::laws::Known;
use super::loops::Loop;
use super::plan::{Law, MassFrom, Plan};
use super::power_law::references;
use super::stiffness::{at_loads, loads, one_loop, stiffness};
use crate::recording::{Recording, read_recording};
use crate::{Error, Result};
use serde::Serialize;
use std::path::Path;

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

pub(super) fn list(values: &[f64]) -> String {
    values.iter().map(|v| format!("{v:.0}")).collect::<Vec<_>>().join(", ")
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
