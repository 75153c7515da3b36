//! The page of a plan's check: what holds of it, shown how, and the order that its targets would be used in.

use super::influence::influence_picture;
use crate::identify::check::{
    ClosedForm, Dependence, GroupReport, Injectivity, Next, Report, Response, Standing,
};
use crate::page::{Html, Page, Section, Table, escape, number};
use std::fmt::Write;

const STYLE: &str = "\
.standing { display: inline-block; padding: 0 .5rem; border-radius: .7rem; font-size: .85rem; white-space: nowrap; }
.standing.refuted { background: #f9d9cd; color: #8c2f00; } .standing.passed { background: #d9efe2; color: #14603a; }
.standing.open { background: #fbeec4; color: #6b5200; }
td.answer { min-width: 13rem; max-width: 24rem; } td.targets { min-width: 15rem; } td.found { min-width: 13rem; }
td.differs { font-weight: 650; }
";
/// More orthants than these are told by their least margins only.
const ORTHANTS: usize = 16;

/// The page of what the tests say of a plan.
pub fn plan_report(report: &Report) -> String {
    let count = |standing| {
        let of = |g: &&GroupReport| g.injectivity.standing() == standing;
        report.groups.iter().filter(of).count()
    };
    let [passed, open, refuted] = [Standing::Passed, Standing::Open, Standing::Refuted].map(count);
    let independent =
        report.groups.iter().filter(|g| report.independence(g) != Some(Standing::Refuted)).count();
    let lead = format!(
        "{}, on {}. Of {} groups {independent} show no dependence on later parameters. One answer: {passed} passed, {open} open, \
         {refuted} refuted.",
        report.title,
        report.model,
        report.groups.len(),
    );
    let mut page = Page::new("Check of an identification plan", &lead)
        .section(summary(report))
        .section(matrix(report))
        .section(choice(report));
    for (number, group) in report.groups.iter().enumerate() {
        page = page.section(of_group(report, number, group));
    }
    page.html()
}

/// A word for how much a test says, in its colour.
fn chip(standing: Standing) -> String {
    let (class, text) = match standing {
        Standing::Refuted => ("refuted", "refuted: proof"),
        Standing::Passed => ("passed", "passes: evidence"),
        Standing::Open => ("open", "open"),
    };
    format!("<span class=\"standing {class}\">{text}</span>")
}

fn summary(report: &Report) -> Section {
    let mut html = String::from(
        "<div class=\"scroll\"><table>\n<thead><tr><th>group</th><th>independent of later parameters</th><th>one answer</th>\
         <th class=\"number\">least margin</th><th>search</th></tr></thead>\n<tbody>\n",
    );
    for (place, group) in report.groups.iter().enumerate() {
        let independent = match report.independence(group) {
            None => "no later ones".to_owned(),
            Some(Standing::Open) => "not tested".to_owned(),
            Some(standing) => chip(standing),
        };
        let margin = group.injectivity.margin().map_or("–".to_owned(), number);
        let _ = writeln!(
            html,
            "<tr><td>{}. {}</td><td>{independent}</td><td class=\"answer\">{}{}</td><td class=\"number\">{margin}</td><td>{}</td></tr>",
            place + 1,
            escape(&group.name),
            chip(group.injectivity.standing()),
            group.closed_form.as_ref().map_or(String::new(), form_in_short),
            escape(&search(report, group)),
        );
    }
    html.push_str("</tbody></table></div>\n");
    let [draws, computed] = report.computed;
    let sampling = &report.sampling;
    Section::new("What holds")
        .with(Html::raw(format!("<style>\n{STYLE}</style>\n{html}")))
        .with(Html::text(
            "A counter-example is a proof that something does not hold: it is given below with its points. A pass is evidence: it holds \
             at all points that were tried. Open: no counter-example, and no criterion that holds.",
        ))
        .with(Html::note(&format!(
            "All conditions were met at {computed} of {draws} draws of all parameters within their bounds. Asked for: {} draws of what is \
             held fixed, {} of what is looked at for each of them, seed {}; a change by less than {} of a target's range is none.",
            sampling.constants,
            sampling.draws,
            sampling.seed,
            number(sampling.tolerance),
        )))
}

fn form_in_short(form: &ClosedForm) -> String {
    match form.counter_example {
        Some(_) => " <span class=\"standing refuted\">closed form: refuted</span>".into(),
        None if form.points == 0 => String::new(),
        None => " <span class=\"standing passed\">closed form: evidence</span>".into(),
    }
}

fn matrix(report: &Report) -> Section {
    Section::new("Influence").with(influence_picture(report)).with(Html::note(
        "By how much of its range a target changes at most with one parameter alone. A plan holds if nothing is right of the step: then \
         each group can be found before those that follow. The matrix does not show whether a group has one answer.",
    ))
}

fn choice(report: &Report) -> Section {
    let names = |of: &[String], numbers: &[usize]| -> String {
        numbers.iter().map(|k| of[*k].as_str()).collect::<Vec<_>>().join("; ")
    };
    let mut html = String::from(
        "<div class=\"scroll\"><table class=\"wide\">\n<thead><tr><th>step</th><th>targets</th><th>find</th><th>given</th><th>one answer</th>\
         <th>in the plan</th></tr></thead>\n<tbody>\n",
    );
    for (place, step) in report.choice.steps.iter().enumerate() {
        for next in &step.next {
            let given =
                if next.given.is_empty() { "–".into() } else { names(&report.parameters, &next.given) };
            let _ = writeln!(
                html,
                "<tr><td>{}</td><td class=\"targets\">{}</td><td class=\"found\">{}</td><td>{}</td><td>{}</td><td>{}</td></tr>",
                place + 1,
                escape(&names(&report.targets, &next.targets)),
                escape(&names(&report.parameters, &next.parameters)),
                escape(&given),
                chip(next.injectivity.standing()),
                escape(&in_plan(report, next)),
            );
        }
    }
    html.push_str("</tbody></table></div>\n");
    let section = Section::new("Next group").with(Html::raw(html));
    let section = if report.choice.left.is_empty() {
        section
    } else {
        section.with(Html::text(&format!(
            "No set of targets was found that fixes {}.",
            names(&report.parameters, &report.choice.left)
        )))
    };
    section.with(Html::note(
        "What could be found next with all that the steps before have found, from influence and the half-space criterion alone, \
         whatever order the plan has: sets of targets that depend on as many parameters that are not known yet, of which no smaller set \
         will do. Sets of one step do not need each other.",
    ))
}

/// Where the plan has what could be next.
fn in_plan(report: &Report, next: &Next) -> String {
    if !next.is_chosen {
        return match next.injectivity.standing() {
            Standing::Refuted => "not used: two answers".into(),
            _ => "not used: found in another way".into(),
        };
    }
    match report.group_of(&next.targets, &next.parameters) {
        Some(number) => format!("group {}", number + 1),
        None => "not as a group".into(),
    }
}

/// In which order a group is searched.
fn search(report: &Report, group: &GroupReport) -> String {
    let found = match &group.response {
        None => "no order has one set of signs".to_owned(),
        Some(_) if group.range[1] - group.range[0] == 1 => "bisection".to_owned(),
        Some(Response { nesting, tail }) => {
            let name = |k: &usize| report.parameters[group.range[0] + k].as_str();
            let order: Vec<&str> = nesting.parameters.iter().map(name).collect();
            format!("{}{}", order.join(" › "), if tail.is_some() { " (last two together)" } else { "" })
        }
    };
    match group.states_its_signs {
        Some(false) => format!("{found}; the plan's signs do not hold everywhere"),
        _ => found,
    }
}

fn of_group(report: &Report, place: usize, group: &GroupReport) -> Section {
    let mut section = Section::new(&format!("{}. {}", place + 1, group.name));
    section = match (&group.dependence, report.independence(group)) {
        (Some(dependence), _) => depends(report, section, dependence),
        (None, None) => section.with(Html::text("There are no later parameters.")),
        (None, Some(Standing::Passed)) => section.with(Html::text(&format!(
            "Independent of later parameters: no counter-example in {} pairs of points. Evidence.",
            group.compared
        ))),
        (None, Some(_)) => section.with(Html::text(
            "Independent of later parameters: not tested, as there were no two points at which its targets can be computed.",
        )),
    };
    section = match &group.injectivity {
        Injectivity::Refuted { points } => section
            .with(Html::text("Not one answer: two points give the same targets. Proof:"))
            .with(points_table(report, points)),
        Injectivity::Passed { points, .. } => section.with(Html::text(&format!(
            "One answer: all directions within an orthant of the parameters move the targets into one half-space, at {points} points and \
             at those where this was most in doubt, and no two points with the same targets were found. Evidence."
        ))),
        Injectivity::Open { points, .. } => section.with(Html::text(&format!(
            "One answer: open. No two points with the same targets were found, but in some orthant no half-space takes up all directions \
             at {points} points. The criterion is sufficient, not necessary."
        ))),
    };
    section = margins(report, section, group);
    if let Some(form) = &group.closed_form {
        section = closed_form(report, section, form);
    }
    let search = match &group.response {
        None => {
            "Search: no order of its parameters has one set of signs at all draws, and nested bisection may end undecided."
        }
        Some(_) => "Search: the targets respond with one set of signs at all draws. Evidence.",
    };
    let stated = match group.states_its_signs {
        None => "",
        Some(true) => " The plan states its signs, and they hold at all draws. Evidence.",
        Some(false) => " The signs that the plan states do not hold at all draws. Proof.",
    };
    let search = format!("{search}{stated}");
    let section = section.with(Html::text(&search));
    match &group.response {
        Some(response) if group.range[1] - group.range[0] > 1 => {
            section.with(nesting(report, group, response))
        }
        _ => section,
    }
}

/// The order of nesting that was found, the outermost first.
fn nesting(report: &Report, group: &GroupReport, response: &Response) -> Html {
    let Response { nesting, tail } = response;
    let n = nesting.parameters.len();
    let first = group.range[0];
    let levels = if tail.is_some() { n.saturating_sub(2) } else { n };
    let mut table = Table::new(&["parameter", "its target", "rises with it", "fall while it rises"]);
    for level in 0..n {
        let name = |k: usize| report.parameters[first + nesting.parameters[k]].clone();
        let target = report.targets[first + nesting.targets[level]].clone();
        let (rises, falls) = if level < levels {
            let falling: Vec<String> = (level + 1..n)
                .filter(|r| nesting.falls.get(level).and_then(|row| row.get(*r)) == Some(&1.0))
                .map(name)
                .collect();
            let falls = if falling.is_empty() { "none".to_owned() } else { falling.join(", ") };
            (if nesting.rises[level] > 0.0 { "yes" } else { "falls" }, falls)
        } else {
            ("with the other of the last two", String::new())
        };
        table = table.row([name(level), target, rises.to_owned(), falls]);
    }
    table.html()
}

fn margins(report: &Report, section: Section, group: &GroupReport) -> Section {
    let mut orthants: Vec<_> = group.injectivity.orthants().iter().collect();
    if orthants.len() < 2 {
        return match group.injectivity.margin() {
            Some(margin) if margin > 0.0 => section,
            Some(_) => section
                .with(Html::text("Its target does not go one way: the derivative is 0 or changes its sign.")),
            None => section,
        };
    }
    orthants.sort_by(|a, b| a.margin.total_cmp(&b.margin));
    let mut head: Vec<&str> =
        report.parameters[group.range[0]..group.range[1]].iter().map(String::as_str).collect();
    head.extend(["margin", "criterion"]);
    let mut table = Table::new(&head);
    for orthant in orthants.iter().take(ORTHANTS) {
        let signs = orthant.signs.iter().map(|s| if *s > 0.0 { "up" } else { "down" }.to_owned());
        let holds = if orthant.margin > 0.0 { "holds" } else { "fails" };
        table = table.row(signs.chain([number(orthant.margin), holds.to_owned()]));
    }
    let left_out = match orthants.len() {
        n if n > ORTHANTS => format!(" The {} others have larger margins.", n - ORTHANTS),
        _ => String::new(),
    };
    section.with(table.html()).with(Html::note(&format!(
        "Orthants of directions, the least margin first: the least component of any such direction, of unit length in the targets, along \
         the normal of the best half-space, which has components of at most 1. An orthant stands for its opposite as well.{left_out}"
    )))
}

fn closed_form(report: &Report, section: Section, form: &ClosedForm) -> Section {
    let ClosedForm { name, points, deviation, counter_example } = form;
    match counter_example {
        None if *points == 0 => {
            section.with(Html::text(&format!("The closed form \"{name}\" was not tested.")))
        }
        None => section.with(Html::text(&format!(
            "The closed form \"{name}\" gives the parameters back within {} of their ranges at {points} points. Evidence.",
            number(*deviation)
        ))),
        Some((point, why)) => {
            let why = why.clone().unwrap_or_else(|| format!("it misses by {} of a range", number(*deviation)));
            let table = Table::new(&["parameter", "value"]);
            let rows = report.parameters.iter().zip(point);
            let table = rows.fold(table, |t, (name, v)| t.row([name.clone(), number(*v)]));
            section
                .with(Html::text(&format!(
                    "The closed form \"{name}\" is not one of this model: {why}. Proof, at:"
                )))
                .with(table.html())
        }
    }
}

fn depends(report: &Report, section: Section, dependence: &Dependence) -> Section {
    section
        .with(Html::text(&format!(
            "Not independent: \"{}\" differs by {} of its range between two points that differ in later parameters only. Proof:",
            report.targets[dependence.target],
            number(dependence.change)
        )))
        .with(points_table(report, &dependence.points))
}

/// Two points beside each other; what differs stands out.
fn points_table(report: &Report, [a, b]: &[Vec<f64>; 2]) -> Html {
    let mut html = String::from(
        "<div class=\"scroll\"><table>\n<thead><tr><th>parameter</th><th class=\"number\">one point</th>\
         <th class=\"number\">the other</th></tr></thead>\n<tbody>\n",
    );
    for (name, (a, b)) in report.parameters.iter().zip(a.iter().zip(b)) {
        let class = if a == b { "number" } else { "number differs" };
        let _ = writeln!(
            html,
            "<tr><td>{}</td><td class=\"{class}\">{}</td><td class=\"{class}\">{}</td></tr>",
            escape(name),
            number(*a),
            number(*b)
        );
    }
    html.push_str("</tbody></table></div>\n");
    Html::raw(html)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::identify::check::{Choice, Orthant, Sampling, Step};

    /// Two groups of one, the first of which depends on the second and the second of which has two answers.
    fn report(name: &str) -> Report {
        let group = |place: usize, injectivity| GroupReport {
            name: name.into(),
            range: [place, place + 1],
            dependence: (place == 0).then(|| Dependence {
                target: 0,
                points: [vec![1.0, 2.0], vec![1.0, 3.0]],
                change: 0.5,
            }),
            compared: 4,
            injectivity,
            closed_form: None,
            response: None,
            states_its_signs: None,
        };
        let orthants = vec![Orthant { signs: vec![1.0], margin: 1.0 }];
        let next = Next {
            targets: vec![1],
            parameters: vec![1],
            given: vec![0],
            injectivity: Injectivity::Passed { orthants: orthants.clone(), points: 3 },
            is_chosen: true,
        };
        Report {
            title: name.into(),
            model: name.into(),
            parameters: vec![name.into(), name.into()],
            targets: vec![name.into(), name.into()],
            influence: vec![vec![Some(1.0), Some(0.5)], vec![Some(0.0), None]],
            groups: vec![
                group(0, Injectivity::Passed { orthants, points: 3 }),
                group(1, Injectivity::Refuted { points: [vec![1.0, 2.0], vec![1.0, 3.0]] }),
            ],
            choice: Choice { steps: vec![Step { known: vec![0], next: vec![next] }], left: vec![0] },
            sampling: Sampling::default(),
            computed: [4, 3],
        }
    }

    #[test]
    fn a_counter_example_is_told_as_a_proof_and_a_pass_as_evidence() {
        let page = plan_report(&report("a"));
        assert!(page.contains("Of 2 groups 1 show no dependence"), "{page}");
        assert!(page.contains("1 passed, 0 open, 1 refuted"));
        assert!(page.contains("differs by 0.5 of its range") && page.contains("class=\"number differs\">3<"));
        assert!(page.contains("two points give the same targets. Proof"));
        assert!(page.contains("passes: evidence") && page.contains("refuted: proof"));
        assert!(page.contains("No set of targets was found that fixes a."));
        // one cell beyond the step, one that was not tested, one that is empty
        assert_eq!(page.matches("0.00e0 of its range").count(), 0);
        assert!(page.contains("a over a: not tested") && page.contains(">?</text>"));
    }

    #[test]
    fn text_stays_text() {
        let page = plan_report(&report("<script>\"&"));
        assert!(!page.contains("<script"), "{page}");
    }
}
