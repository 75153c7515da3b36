//! Inputs that recordings do not hold: what moves on a rig and is not recorded looks like physics that is missing.

use super::roles::Roles;
use super::subject::{Subject, value_of};
use crate::effect::Role;
use crate::model::{Causality, VariableInfo};
use crate::shown::with_unit;

/// Inputs that are listed at most.
const MOST_LISTED: usize = 12;

impl Subject {
    /// What is said of inputs that neither recordings nor the user say anything of; `recorded` are those that recordings hold. What moves on a
    /// rig and is not recorded looks like physics that is missing; a force that is zero by itself is looked for.
    pub(super) fn what_stays(&self, recorded: &[usize], roles: &Roles) -> Option<String> {
        let is_looked_for = |variable: usize, info: &VariableInfo| {
            roles.is(variable, Role::Force) && value_of(info, variable, &[]) == Some(0.0)
        };
        let stays = |(variable, info): &(usize, &VariableInfo)| {
            info.causality == Causality::Input
                && !is_looked_for(*variable, info)
                && !recorded.contains(variable)
                && !self.is_given(*variable)
        };
        let stay: Vec<(usize, &VariableInfo)> =
            self.interface.variables.iter().enumerate().filter(stays).collect();
        if stay.is_empty() {
            return None;
        }
        let named = |(variable, info): &(usize, &VariableInfo)| match value_of(info, *variable, &[]) {
            Some(value) => {
                format!("{} = {}", info.name, with_unit(value, info.unit.as_deref().unwrap_or("1")))
            }
            None => info.name.clone(),
        };
        let mut list: Vec<String> = stay.iter().take(MOST_LISTED).map(named).collect();
        if stay.len() > MOST_LISTED {
            list.push(format!("{} more", stay.len() - MOST_LISTED));
        }
        let whose = match recorded.is_empty() {
            true => "The recordings hold no input of the model, so that all stay where they start",
            false => "The recordings do not hold all inputs of the model; where they start stay",
        };
        Some(format!(
            "{whose}: {}. What moves on the rig and is not recorded looks like physics that is missing; [inputs] in a file of --parameters says where else they stand.",
            list.join(", ")
        ))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::{Settings, Value};

    #[test]
    fn what_is_not_recorded_is_said_to_stay() {
        let mut subject = Subject::load("fiala-flat-track", &Settings::default()).unwrap();
        let inputs: Vec<usize> = subject.interface.with(Causality::Input).collect();
        let roles = Roles::of(&subject.interface, &[]).unwrap();
        let find = |name: &str| subject.interface.index(name).unwrap();
        let (load, angle, factor) = (find("load"), find("slip_angle"), find("friction_factor"));
        let recorded: Vec<usize> =
            inputs.iter().copied().filter(|v| ![load, angle, factor].contains(v)).collect();
        assert_eq!(subject.what_stays(&inputs, &roles), None);
        // what the user has set is no news
        subject.fixed.push((angle, Value::Real(0.02)));
        let words = subject.what_stays(&recorded, &roles).unwrap();
        assert!(words.starts_with("The recordings do not hold all inputs"), "{words}");
        assert!(words.contains("stay: friction_factor = 1, load = 4000 N. "), "{words}");
        let words = subject.what_stays(&[], &roles).unwrap();
        assert!(words.starts_with("The recordings hold no input") && words.contains("deflection = 0.02 m"));
        // forces that are zero by themselves are tried
        let drum = Subject::load("linear-drum", &Settings::default()).unwrap();
        let words = drum.what_stays(&[], &Roles::of(&drum.interface, &[]).unwrap()).unwrap();
        assert!(words.contains("drum_speed") && !words.contains("torque"), "{words}");
    }
}
