//! Whether brakes have pads that take time to grip.

use super::{Remark, View};
use crate::cosimulate::Port;

const TOPIC: &str = "pads";

/// Brakes with the parameters of `brake-hydraulics` whose pads grip at once: the pressure of a simulated stop is then smoother than that of any
/// recording (Mack 2009, section 6.1.4).
pub(super) fn constant_friction(view: &View<'_>) -> Vec<Remark> {
    let mut remarks = Vec::new();
    for (index, component) in view.system.components().iter().enumerate() {
        let parameter = |name: &str| {
            let variable = component.interface().find(name).ok()?;
            view.parameters.get(&Port { component: index, variable }).copied()
        };
        let (Some(share), Some(time)) = (parameter("onset_friction_share"), parameter("onset_time")) else {
            continue;
        };
        let constant = time == 0.0 || share == 1.0;
        let name = &component.name;
        remarks.push(Remark::judged(
            !constant,
            TOPIC,
            match constant {
                true => format!(
                    "{name}: the friction is constant from the first contact on; real pads take some 0.1 s, and the pressure of a stop overshoots for it (onset_friction_share, onset_time)"
                ),
                false => format!("{name}: friction builds up from {share} of its full value within {time} s"),
            },
        ));
    }
    remarks
}
