//! Inputs that nothing drives while others of their kind are driven.

use super::{Remark, View};
use crate::Result;
use crate::cosimulate::Port;
use crate::model::{Causality, Value};
use crate::recording::Recording;

const TOPIC: &str = "inputs";

/// Inputs without a source beside driven ones of the same name in another place (`rear_left.brake_torque` beside `front_left.brake_torque`,
/// `wheel_speed_4` beside `wheel_speed_1`). `with` runs the system with a value for an input: where nothing changes for it, the input is not used.
///
/// # Errors
/// The system does not run with that value.
pub(super) fn inputs(
    view: &View<'_>,
    with: impl Fn(Port, Value) -> Result<Recording>,
) -> Result<Vec<Remark>> {
    let system = view.system;
    let mut remarks = Vec::new();
    for component in 0..system.components().len() {
        let ports = || view.ports(component, Causality::Input);
        for port in ports().filter(|port| system.is_free(*port) && system.info(*port).is_real()) {
            let info = system.info(port);
            let sibling = ports()
                .find(|other| !system.is_free(*other) && kind(&system.info(*other).name) == kind(&info.name));
            let Some(sibling) = sibling else { continue };
            let own = view.course(port, info.unit.as_deref().unwrap_or("1"));
            let own = own.map_or(0.0, |values| values[0]);
            let moved = [own + info.nominal.unwrap_or(1.0), own - info.nominal.unwrap_or(1.0)]
                .into_iter()
                .find(|value| info.accept(&Value::Real(*value)).is_ok());
            if let Some(moved) = moved {
                let other = with(port, Value::Real(moved))?;
                let name = system.name(port);
                let same =
                    view.run.channels.iter().zip(&other.channels).all(|(a, b)| a.name == name || a == b);
                if same {
                    continue;
                }
            }
            remarks.push(Remark::judged(
                false,
                TOPIC,
                format!(
                    "nothing drives {}, while {} is driven: it stays at {own} {}",
                    system.name(port),
                    system.name(sibling),
                    info.unit.as_deref().unwrap_or("")
                ),
            ));
        }
    }
    if remarks.is_empty() {
        remarks.push(Remark::judged(true, TOPIC, "none is left out among others of its kind".into()));
    }
    Ok(remarks)
}

/// A name without its place: what stands behind the last dot, without a number at its end.
fn kind(name: &str) -> &str {
    let last = name.rsplit('.').next().unwrap_or(name);
    last.trim_end_matches(|c: char| c.is_ascii_digit()).trim_end_matches('_')
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_kind_is_a_name_without_its_place() {
        assert_eq!(kind("front_left.brake_torque"), "brake_torque");
        assert_eq!(kind("wheel_speed_4"), kind("wheel_speed_1"));
        assert_ne!(kind("inlet_valve_1"), kind("outlet_valve_1"));
    }
}
