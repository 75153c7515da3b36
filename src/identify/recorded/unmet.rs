//! Targets that no parameters within their bounds meet.

use super::reduced::Known;
use super::search::{MISSED, Search};
use crate::Result;
use crate::identify::plan::Plan;
use crate::identify::solve::Targets;

/// A target that is missed by more than so many half intervals contradicts the others.
const CONTRADICTS: f64 = 2.0;
/// Where a parameter is on a bound up to this share of its range, targets that are missed within their intervals are told.
const ON_BOUND: f64 = 1e-6;

/// What becomes of targets that no parameters within their bounds meet.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum Unmet {
    /// They are an error.
    #[default]
    Refused,
    /// The parameters that come nearest to them, by how sure each of a group's targets is, are the answer; what is left is told,
    /// and counted as how far the model can be from the tire.
    Nearest,
}

/// A target that no parameters within their bounds meet.
pub(super) struct Miss {
    /// Its number,
    pub target: usize,
    /// its group,
    pub group: String,
    /// and by how much it is missed.
    pub by: f64,
    /// That is more than how sure the target is allows.
    pub contradicts: bool,
    /// The same as a sentence,
    pub told: String,
    /// and in a few words.
    pub brief: String,
}

impl Search<'_> {
    /// Targets for which the model does not have what was measured, and why, if that is known.
    pub fn missed(&self, plan: &Plan, known: &Known, refused: Option<String>) -> Result<Vec<Miss>> {
        let model = self.model(plan)?;
        let at = model.sought_values(&self.numbers)?;
        let numbers = model.model_values(&at)?;
        let reads = self.reads(plan)?;
        let modelled = self.modelled(&model, &reads, &numbers)?;
        let mut missed = Vec::new();
        let mut from = 0;
        for group in &plan.groups {
            let own = from..from + group.parameters.len();
            from = own.end;
            let on_bound: Vec<String> = own
                .clone()
                .filter_map(|k| {
                    let [low, high] = model.bounds()[k];
                    let bound = if at[k] - low < high - at[k] { low } else { high };
                    ((at[k] - bound).abs() <= ON_BOUND * (high - low))
                        .then(|| format!("{} = {bound:.4e}", group.parameters[k - own.start].name))
                })
                .collect();
            for k in own {
                let (measured, half) =
                    (self.measured(&reads[k])?, known.side * known.covariance[(k, k)].sqrt());
                let by = (measured - modelled[k]).abs();
                if by <= MISSED * measured.abs() {
                    continue;
                }
                let why = match (&refused, &on_bound[..]) {
                    (Some(why), _) => why.clone(),
                    (None, []) => "no parameter of the group is on a bound".to_owned(),
                    (None, some) => format!("{} is as far as it goes", some.join(", ")),
                };
                let (name, nearest) = (&reads[k].name, modelled[k]);
                missed.push(Miss {
                    target: k,
                    group: group.name.clone(),
                    by,
                    contradicts: by > CONTRADICTS * half,
                    told: format!(
                        "group \"{}\": \"{name}\" was measured to be {measured:.5e} +- {half:.1e} (in {}), and no parameters within \
                         their bounds come nearer to it, together with the group's other targets, than {nearest:.5e} ({why})",
                        group.name,
                        self.evidence.files(&reads[k]),
                    ),
                    brief: format!("\"{name}\" is not met: measured {measured:.4e}, at the nearest {nearest:.4e} ({why})"),
                });
            }
        }
        Ok(missed)
    }
}
