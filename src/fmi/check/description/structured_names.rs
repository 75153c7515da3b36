//! The rules on structured names, and their grammar.

use super::super::finding::Finding;
use super::Variable;
use std::collections::HashMap;

/// A structured name, taken apart: the name with its indices left out, and the indices.
pub(super) struct Structured {
    pub pattern: String,
    pub indices: Vec<u64>,
}

/// Reads `name` or `der(name)` or `der(name,n)` by the grammar of structured names.
pub(super) fn structured(text: &str) -> Option<Structured> {
    let (inner, order) = match text.strip_prefix("der(").and_then(|t| t.strip_suffix(')')) {
        None => (text, ""),
        Some(inner) => match inner.rsplit_once(',') {
            // A comma may also stand between indices.
            Some((name, order)) if !order.is_empty() && order.trim().bytes().all(|b| b.is_ascii_digit()) => {
                (name, order)
            }
            _ => (inner, "1"),
        },
    };
    let mut pattern = if order.is_empty() { String::new() } else { format!("der{}:", order.trim()) };
    let mut indices = Vec::new();
    let mut rest = inner;
    loop {
        if let Some(quoted) = rest.strip_prefix('\'') {
            let mut escaped = false;
            let end = quoted.find(|c| {
                let end = c == '\'' && !escaped;
                escaped = c == '\\' && !escaped;
                end
            })?;
            if end == 0 {
                return None;
            }
            pattern += &rest[..end + 2];
            rest = &quoted[end + 1..];
        } else {
            let end = rest.find(|c: char| !(c.is_ascii_alphanumeric() || c == '_')).unwrap_or(rest.len());
            if end == 0 || rest.starts_with(|c: char| c.is_ascii_digit()) {
                return None;
            }
            pattern += &rest[..end];
            rest = &rest[end..];
        }
        if let Some(list) = rest.strip_prefix('[') {
            let (list, after) = list.split_once(']')?;
            for index in list.split(',') {
                indices.push(index.trim().parse().ok()?);
            }
            pattern += "[]";
            rest = after;
        }
        match rest.strip_prefix('.') {
            Some(after) => {
                pattern.push('.');
                rest = after;
            }
            None if rest.is_empty() => return Some(Structured { pattern, indices }),
            None => return None,
        }
    }
}

/// Checks that all names are structured and that elements of arrays stand in order.
pub(super) fn check(variables: &[Variable], findings: &mut Vec<Finding>) {
    // Of each array: where its last element was seen, and its indices.
    let mut arrays: HashMap<String, (usize, Vec<u64>)> = HashMap::new();
    for (position, v) in variables.iter().enumerate() {
        let Some(name) = structured(v.name) else {
            let what = format!("{:?} is no structured name", v.name);
            findings.push(Finding::error("X16", v.at("name"), what));
            continue;
        };
        // Records in arrays may stand one record after the other: the grammar does not tell which is
        // meant, so only arrays of plain variables are followed.
        if name.indices.is_empty() || !name.pattern.ends_with("[]") || name.pattern.matches("[]").count() > 1
        {
            continue;
        }
        if let Some((last, indices)) = arrays.get(&name.pattern) {
            let what = if *last + 1 != position {
                Some(format!("{:?} does not stand beside the other elements of its array", v.name))
            } else if *indices >= name.indices {
                Some(format!("{:?} is not in order: the last index runs fastest", v.name))
            } else {
                None
            };
            if let Some(what) = what {
                findings.push(Finding::error("X16", v.at("name"), what));
            }
        }
        arrays.insert(name.pattern, (position, name.indices));
    }
}
