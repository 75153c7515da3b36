//! Which parameters the next targets fix.

use super::independence::depends;
use super::injectivity::{Injectivity, injective};
use super::samples::Sampled;
use crate::Result;

/// The parameters that the targets `rows` fix once the `known` ones are (s2): those that they depend on, each tested alone.
/// `None` if these are not as many as the targets, or do not pass the test for one answer.
///
/// # Errors
/// As [`injective`].
pub fn next_group(sampled: &Sampled<'_>, rows: &[usize], known: &[usize]) -> Result<Option<Vec<usize>>> {
    let unknown = (0..sampled.targets.bounds().len()).filter(|k| !known.contains(k));
    let group: Vec<usize> = unknown.filter(|k| depends(sampled, rows, &[*k]).dependence.is_some()).collect();
    if group.len() != rows.len() {
        return Ok(None);
    }
    let injective = injective(sampled, rows, &group)?;
    Ok(matches!(injective, Injectivity::Passed { .. }).then_some(group))
}
