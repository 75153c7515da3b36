//! Whether controllers have the tires of the vehicle in mind.

use super::{Remark, View};
use crate::cosimulate::Port;
use crate::model::{Causality, Role};

const TOPIC: &str = "radius in the controller";
/// How far apart the radii may be: a third of the 3 % with which the slips that a controller of slip keeps are clearly
/// others (Mack 2009, section 6.1.1, says that they have to be equal).
const APART: f64 = 0.01;
/// Below this speed at the start a wheel's radius does not follow from how fast it turns \[m/s\].
const ROLLS: f64 = 1.0;

/// The radius of each wheel that a controller is told the speed of, as the controller believes and as the wheel rolls at the start.
pub(super) fn of_controllers(view: &View<'_>) -> Vec<Remark> {
    let mut remarks = Vec::new();
    for (from, to) in view.system.connections() {
        if view.role(from) != Some(Role::WheelSpeed) {
            continue;
        }
        let Some(radius) = radius_of(view, to) else { continue };
        let (name, believed) = (view.name(radius), view.parameters[&radius]);
        let rolling = view
            .outputs(from.component, Role::TravelSpeed)
            .find_map(|port| view.course(port, "m/s"))
            .zip(view.course(from, "rad/s"))
            .map(|(travel, spin)| (travel[0], spin[0]));
        remarks.push(match rolling {
            Some((travel, spin)) if travel.abs() > ROLLS && spin != 0.0 => {
                let rolls = (travel / spin).abs();
                let apart = believed / rolls - 1.0;
                let text = format!(
                    "{name} is {believed:.4} m, and {} rolls with {rolls:.4} m at the start: {:.1} % apart",
                    view.name(from),
                    100.0 * apart
                );
                Remark::judged(apart.abs() <= APART, TOPIC, text)
            }
            _ => Remark::open(
                TOPIC,
                format!("{name}: the radius with which {} rolls is not known, because it does not roll at the start", view.name(from)),
            ),
        });
    }
    remarks
}

/// The parameter of a component that is the radius of the wheel whose speed this input is: the only one, or the one with the same ending.
fn radius_of(view: &View<'_>, input: Port) -> Option<Port> {
    let is_radius = |port: &Port| {
        let info = view.system.info(*port);
        info.unit.as_deref() == Some("m") && info.name.contains("radius")
    };
    let radii: Vec<Port> = view.ports(input.component, Causality::Parameter).filter(is_radius).collect();
    match radii[..] {
        [only] => Some(only),
        _ => {
            let ending = |port: Port| view.system.info(port).name.rsplit('_').next().map(str::to_owned);
            radii.into_iter().find(|port| ending(*port) == ending(input))
        }
    }
}
