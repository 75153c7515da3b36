//! A plan that is another one but for what it says.

use super::plan::Plan;
use super::ring_brush;
use crate::model::did_you_mean;
use crate::{Error, Result};
use serde::Deserialize;
use toml::{Table, Value};

/// Plans that are shipped, by the names of the models that they are for.
const SHIPPED: [(&str, &str); 1] = [("ring-brush-flat-track", ring_brush::PLAN)];

/// The text of a plan that is shipped, if there is one of this name.
pub fn shipped(name: &str) -> Option<&'static str> {
    SHIPPED.iter().find(|(own, _)| *own == name).map(|(_, text)| *text)
}

/// The same, of a plan that has to be there.
///
/// # Errors
/// There is none: those that there are.
pub fn shipped_plan(name: &str) -> Result<&'static str> {
    shipped(name).ok_or_else(|| {
        let names = SHIPPED.map(|(name, _)| name).join(", ");
        Error::call(format!("there is no shipped plan \"{name}\"; there is {names}"))
    })
}

/// A plan from its text, of which `like` may name a shipped one.
pub(super) fn parse(text: &str) -> Result<Plan> {
    let wrong = |e: toml::de::Error| Error::file(e.to_string());
    let mut own = match text.parse::<Table>() {
        Ok(own) if own.contains_key("like") => own,
        // with its line
        _ => return toml::from_str(text).map_err(wrong),
    };
    let like = match own.remove("like") {
        Some(Value::String(name)) => name,
        _ => return Err(Error::file("like: the name of a shipped plan in quotes is needed")),
    };
    let base = shipped_plan(&like).map_err(|e| e.at("like"))?;
    let mut whole: Table = base.parse().map_err(wrong)?;
    put(&mut whole, own)?;
    let before: Plan = toml::from_str(base).map_err(wrong)?;
    let plan = Plan::deserialize(whole).map_err(wrong)?;
    let is_new = |name: &str| before.conditions.iter().all(|c| c.name != name);
    let is_used = |name: &str| plan.groups.iter().flat_map(|g| &g.targets).any(|t| t.condition == name);
    // a name with a slip of the pen would change nothing, and nobody would see
    match plan.conditions.iter().find(|c| is_new(&c.name) && !is_used(&c.name)) {
        Some(condition) => {
            let hint = did_you_mean(&condition.name, before.conditions.iter().map(|c| c.name.as_str()));
            Err(Error::file(format!(
                "condition \"{}\" is none of the plan \"{like}\", and no target is read in it{hint}",
                condition.name
            )))
        }
        None => Ok(plan),
    }
}

/// Puts entries in the place of those of the same name: of tables one by one, of lists of tables by their `name`. What has a new
/// name comes behind the entry that its `after` names, or last.
fn put(whole: &mut Table, own: Table) -> Result<()> {
    for (key, value) in own {
        match (whole.get_mut(&key), value) {
            (Some(Value::Table(into)), Value::Table(own)) => put(into, own)?,
            (Some(Value::Array(into)), Value::Array(own))
                if own.iter().chain(into.iter()).all(|v| name(v).is_some()) =>
            {
                for entry in own {
                    put_one(into, entry).map_err(|e| e.at(&key))?;
                }
            }
            (_, value) => {
                whole.insert(key, value);
            }
        }
    }
    Ok(())
}

fn put_one(into: &mut Vec<Value>, mut entry: Value) -> Result<()> {
    let after = entry.as_table_mut().and_then(|entry| entry.remove("after"));
    let place_of = |wanted: Option<&str>| into.iter().position(|other| name(other) == wanted);
    let Some(after) = after else {
        match place_of(name(&entry)) {
            Some(place) => into[place] = entry,
            None => into.push(entry),
        }
        return Ok(());
    };
    let own = name(&entry).unwrap_or_default();
    if place_of(Some(own)).is_some() {
        return Err(Error::file(format!(
            "{own}: it is in the place of the shipped one, and cannot have `after`"
        )));
    }
    let Some(place) = after.as_str().and_then(|after| place_of(Some(after))) else {
        let hint = did_you_mean(after.as_str().unwrap_or_default(), into.iter().filter_map(name));
        return Err(Error::file(format!("{own}: after = {after}: there is none of this name{hint}")));
    };
    into.insert(place + 1, entry);
    Ok(())
}

fn name(value: &Value) -> Option<&str> {
    value.get("name")?.as_str()
}
