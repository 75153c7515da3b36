//! Whether tires and car brake as hard as real ones.

use super::{Remark, View};
use crate::cosimulate::Port;
use crate::model::Role;

/// Greatest longitudinal force over load of a sports car's tire, from high to low load (Mack 2009, section 6.1.3).
const FRICTION: [f64; 2] = [1.3, 1.6];
/// Deceleration of a sports car with ABS on dry road, over gravity (same section).
const DECELERATION: [f64; 2] = [1.2, 1.4];
/// Friction below this share of the least usual one is that of a run that does not brake to the limit.
const NEAR: f64 = 0.5;
/// Samples with less than this share of the greatest load are left out: over an edge of the road the quotient says nothing.
const LOADED: f64 = 0.3;
const GRAVITY: f64 = 9.81;

/// Greatest friction that each tire uses.
pub(super) fn of_friction(view: &View<'_>) -> Vec<Remark> {
    const TOPIC: &str = "friction of tires";
    let mut remarks = Vec::new();
    // of several forces in one place the first is the tire's own on its rim; others are the same behind the rim's mass, or in its contact
    let mut places: Vec<(usize, String)> = Vec::new();
    for component in 0..view.system.components().len() {
        let loads = view.outputs(component, Role::Load).collect::<Vec<_>>();
        for force in view.outputs(component, Role::LongitudinalForce) {
            let place = |port: Port| prefix(&view.system.info(port).name).to_owned();
            let load = loads.iter().find(|load| place(**load) == place(force));
            let courses = load.and_then(|load| Some((view.course(force, "N")?, view.course(*load, "N")?)));
            let Some((force_course, load)) = courses else { continue };
            let most = load.iter().copied().fold(0.0, f64::max);
            let used = force_course.iter().zip(&load).filter(|(_, load)| **load > LOADED * most);
            let Some((friction, at)) =
                used.map(|(f, load)| (f.abs() / load, *load)).max_by(|a, b| a.0.total_cmp(&b.0))
            else {
                continue;
            };
            if places.contains(&(component, place(force))) {
                continue;
            }
            places.push((component, place(force)));
            let name = view.name(force);
            remarks.push(if friction < NEAR * FRICTION[0] {
                Remark::open(TOPIC, format!("{name} is at most {friction:.2} of the load: it is not braked to the limit"))
            } else {
                let [low, high] = FRICTION;
                Remark::judged(
                    (low..=high).contains(&friction),
                    TOPIC,
                    format!(
                        "{name} is at most {friction:.2} of the load, at {:.1} kN; of a sports car's tire on dry asphalt it is {low} (high load) to {high} (low load)",
                        at / 1e3
                    ),
                )
            });
        }
    }
    remarks
}

/// The place in a name: what stands before its last dot.
fn prefix(name: &str) -> &str {
    name.rsplit_once('.').map_or("", |(before, _)| before)
}

/// Mean deceleration from nine tenths to two tenths of the speed at the start.
pub(super) fn of_deceleration(view: &View<'_>) -> Vec<Remark> {
    const TOPIC: &str = "deceleration";
    let mut remarks = Vec::new();
    for component in 0..view.system.components().len() {
        let Some((port, speed)) = view
            .outputs(component, Role::TravelSpeed)
            .find_map(|port| view.course(port, "m/s").map(|speed| (port, speed)))
        else {
            continue;
        };
        let name = view.name(port);
        let reaches = |share: f64| speed.iter().position(|v| v.abs() <= share * speed[0].abs());
        let (Some(from), Some(to)) = (reaches(0.9), reaches(0.2)) else {
            remarks.push(Remark::open(TOPIC, format!("{name} does not fall to a fifth in this run")));
            continue;
        };
        if speed[0] == 0.0 || to == from {
            continue;
        }
        let mean = (speed[from] - speed[to]).abs() / (view.run.time[to] - view.run.time[from]) / GRAVITY;
        let [low, high] = DECELERATION;
        remarks.push(Remark::judged(
            (low..=high).contains(&mean),
            TOPIC,
            format!(
                "{name} falls with {mean:.2} g; with ABS a sports car does {low} to {high} g on dry road"
            ),
        ));
    }
    remarks
}
