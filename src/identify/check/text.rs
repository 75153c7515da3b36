//! The report as text.

use super::closed_form::ClosedForm;
use super::injectivity::Injectivity;
use super::next_group::Next;
use super::report::{GroupReport, Report, Standing};
use super::response::Response;
use std::fmt::{self, Display, Formatter};

impl Display for Report {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        let [draws, computed] = self.computed;
        writeln!(
            f,
            "Conditions met at {computed} of {draws} draws of all parameters within their bounds.\n"
        )?;
        self.write_influence(f)?;
        for (number, group) in self.groups.iter().enumerate() {
            writeln!(f, "\nGroup {}: {}", number + 1, group.name)?;
            self.write_independence(f, group)?;
            write_injectivity(f, &group.injectivity)?;
            if let Some(form) = &group.closed_form {
                write_closed_form(f, form)?;
            }
            self.write_search(f, group)?;
        }
        self.write_choice(f)
    }
}

impl Report {
    fn write_influence(&self, f: &mut Formatter<'_>) -> fmt::Result {
        writeln!(f, "Influence of parameters (columns) on targets (rows), as a share of a target's range:")?;
        let widest = self.targets.iter().map(|t| t.chars().count()).max().unwrap_or(0);
        for (row, target) in self.influence.iter().zip(&self.targets) {
            write!(f, "  {target:widest$} ")?;
            for share in row {
                match share {
                    None => write!(f, "     ?")?,
                    Some(0.0) => write!(f, "     .")?,
                    Some(s) if *s < 1e-3 => write!(f, "  <.001")?,
                    Some(s) => write!(f, "  {s:4.2}")?,
                }
            }
            writeln!(f)?;
        }
        for (k, parameter) in self.parameters.iter().enumerate() {
            writeln!(f, "  column {:2}: {parameter}", k + 1)?;
        }
        Ok(())
    }

    fn write_independence(&self, f: &mut Formatter<'_>, group: &GroupReport) -> fmt::Result {
        match (&group.dependence, self.independence(group)) {
            (_, None) => writeln!(f, "  there are no later parameters"),
            (Some(d), _) => writeln!(
                f,
                "  NOT independent (proof): \"{}\" differs by {:.1e} of its range between\n    {:?}\n    {:?}",
                self.targets[d.target], d.change, d.points[0], d.points[1]
            ),
            (None, Some(Standing::Passed)) => writeln!(
                f,
                "  independent of later parameters: no counter-example in {} pairs (evidence)",
                group.compared
            ),
            (None, _) => writeln!(
                f,
                "  independent of later parameters: not tested, as no two points could be compared"
            ),
        }
    }

    fn write_search(&self, f: &mut Formatter<'_>, group: &GroupReport) -> fmt::Result {
        match &group.response {
            None => writeln!(f, "  search: no order of its parameters has one set of signs")?,
            Some(Response { nesting, tail }) => {
                let name = |k: &usize| self.parameters[group.range[0] + k].as_str();
                let order: Vec<&str> = nesting.parameters.iter().map(name).collect();
                let how = if tail.is_some() { ", the last two together" } else { "" };
                writeln!(f, "  search: nested bisection in the order {}{how} (evidence)", order.join(" > "))?;
            }
        }
        match group.states_its_signs {
            Some(true) => writeln!(f, "  the plan's own signs hold at all draws (evidence)"),
            Some(false) => writeln!(
                f,
                "  the plan's own signs do NOT hold at all draws (proof): its search may end undecided, and says so then"
            ),
            None => Ok(()),
        }
    }

    fn write_choice(&self, f: &mut Formatter<'_>) -> fmt::Result {
        writeln!(
            f,
            "\nNext group, from influence and the half-space criterion alone (what is known > what could be found next):"
        )?;
        for (number, step) in self.choice.steps.iter().enumerate() {
            match number {
                0 => writeln!(f, "  nothing is known >")?,
                _ => writeln!(f, "  those are known, too >")?,
            }
            for next in &step.next {
                writeln!(f, "    {}", self.next(next))?;
            }
        }
        if !self.choice.left.is_empty() {
            let left: Vec<&str> = self.choice.left.iter().map(|k| self.parameters[*k].as_str()).collect();
            writeln!(f, "  no set of targets is found that fixes {}", left.join("; "))?;
        }
        Ok(())
    }

    /// What could be next, in a line.
    fn next(&self, next: &Next) -> String {
        let names = |of: &[String], numbers: &[usize]| -> String {
            numbers.iter().map(|k| of[*k].as_str()).collect::<Vec<_>>().join("; ")
        };
        let what = match self.group_of(&next.targets, &next.parameters) {
            Some(number) => format!("group {}", number + 1),
            None => names(&self.targets, &next.targets),
        };
        let standing = match (next.injectivity.standing(), next.is_chosen) {
            (Standing::Refuted, _) => "has two answers (proof)",
            (Standing::Passed, true) => "passes (evidence)",
            (Standing::Open, true) => "open",
            (_, false) => "another way to what is found above",
        };
        format!("{what} -> {}: {standing}", names(&self.parameters, &next.parameters))
    }
}

fn write_injectivity(f: &mut Formatter<'_>, injectivity: &Injectivity) -> fmt::Result {
    let least = injectivity.margin().unwrap_or(f64::NAN);
    match injectivity {
        Injectivity::Refuted { points: [a, b] } => {
            writeln!(f, "  NOT unique (proof): the same targets at\n    {a:?}\n    {b:?}")
        }
        Injectivity::Open { .. } => writeln!(
            f,
            "  one answer: open. No two answers were found, but the half-space criterion fails{} (least margin 0); it is sufficient, not necessary",
            in_orthants(injectivity)
        ),
        Injectivity::Passed { points, .. } => writeln!(
            f,
            "  one answer: the half-space criterion holds at {points} points and more{}, least margin {least:.2} (evidence)",
            in_orthants(injectivity)
        ),
    }
}

/// In which share of the orthants the criterion fails or holds; of one parameter there is one.
fn in_orthants(injectivity: &Injectivity) -> String {
    let count = injectivity.orthants().len();
    let open = injectivity.orthants().iter().filter(|o| o.margin <= 0.0).count();
    match (count, open) {
        (1, _) => String::new(),
        (_, 0) => format!(" in all {count} orthants"),
        _ => format!(" in {open} of {count} orthants"),
    }
}

fn write_closed_form(f: &mut Formatter<'_>, form: &ClosedForm) -> fmt::Result {
    let ClosedForm { name, points, deviation, counter_example } = form;
    match counter_example {
        Some((point, Some(why))) => {
            writeln!(f, "  closed form \"{name}\" is NOT one of this model (proof): {why}; at\n    {point:?}")
        }
        Some((point, None)) => writeln!(
            f,
            "  closed form \"{name}\" is NOT one of this model (proof): it misses by {deviation:.1e} of a range at\n    {point:?}"
        ),
        None if *points == 0 => {
            writeln!(f, "  closed form \"{name}\": not tested, as no targets could be computed")
        }
        None => writeln!(
            f,
            "  closed form \"{name}\" gives the parameters back within {deviation:.1e} of their ranges at {points} points (evidence)"
        ),
    }
}
