//! What an FMU carries in `documentation/`: a page about the model, and licenses.

use super::c::Fmi;
use super::import::Capabilities;
use super::log::CATEGORIES;
use super::platform::{PLATFORM, folder_of};
use super::state::Function;
use crate::model::{Causality, Interface, Kind, Value, Variability, VariableInfo};
use crate::page::{Html, Page, Section, Table, escape, number as short};

/// Files of `documentation/licenses/`: the project's own and what is linked into the binary.
pub const LICENSES: [(&str, &str); 3] = [
    ("LICENSE-APACHE", include_str!("../../LICENSE-APACHE")),
    ("LICENSE-MIT", include_str!("../../LICENSE-MIT")),
    ("THIRD-PARTY.md", include_str!("../../THIRD-PARTY.md")),
];

/// `documentation/index.html`: the author's text, then what follows from the interface.
///
/// `table` has the start values of the model, `interface` those of this FMU. `text` is the model's
/// [`DOCUMENTATION`](crate::model::Model::DOCUMENTATION).
pub fn page(table: &Interface, interface: &Interface, guid: &str, text: &str, fmi: Fmi) -> String {
    page_with(table, interface, guid, text, (calls(interface, fmi), fmi))
}

/// As [`page`], for an FMU that carries another one with these capabilities.
pub fn page_of_carrier(
    table: &Interface,
    interface: &Interface,
    guid: &str,
    text: &str,
    capabilities: &Capabilities,
) -> String {
    page_with(table, interface, guid, text, (calls_of_carrier(interface, capabilities), Fmi::Two))
}

fn page_with(
    table: &Interface,
    interface: &Interface,
    guid: &str,
    text: &str,
    (calls, fmi): (Section, Fmi),
) -> String {
    let mut page = Page::new(&interface.name, &interface.description);
    for section in author_sections(text) {
        page = page.section(section);
    }
    for (heading, causality) in
        [("Inputs", Causality::Input), ("Outputs", Causality::Output), ("Inner quantities", Causality::Local)]
    {
        page = page.section(variables(heading, interface, causality));
    }
    page.section(items(interface))
        .section(parameters(table, interface))
        .section(calls)
        .section(licenses(guid, fmi))
        .html()
}

/// A drawing that stands where an author's HTML has this comment: axes and signs of a wheel.
const DRAWN: (&str, &str) = ("<!-- axes of a wheel -->", include_str!("../rig/axes.svg"));

/// The author's HTML, cut at its `<h2>`.
fn author_sections(text: &str) -> Vec<Section> {
    let text = &text.replacen(DRAWN.0, DRAWN.1, 1);
    let (before, rest) = text.split_once("<h2>").unwrap_or((text, ""));
    let mut sections = Vec::new();
    if !before.trim().is_empty() {
        sections.push(Section::default().with(Html::raw(before)));
    }
    for topic in rest.split("<h2>").filter(|topic| !topic.is_empty()) {
        let (heading, body) = topic.split_once("</h2>").unwrap_or(("", topic));
        sections.push(Section::raw(heading).with(Html::raw(body)));
    }
    sections
}

fn variables(heading: &str, interface: &Interface, causality: Causality) -> Section {
    let of_kind: Vec<&VariableInfo> = interface.with(causality).map(|i| &interface.variables[i]).collect();
    if of_kind.is_empty() {
        return Section::default();
    }
    let given = causality == Causality::Input;
    let head: &[&str] = if given { &["Name", "Unit", "Start", "Range"] } else { &["Name", "Unit"] };
    let rows = of_kind.into_iter().map(|v| {
        let mut cells = vec![name(v), unit(v)];
        if given {
            cells.extend([start(v), escape(&range(v))]);
        }
        (false, cells, v)
    });
    Section::new(heading).with(table_of(head, rows))
}

fn parameters(table: &Interface, interface: &Interface) -> Section {
    let mut changes = 0;
    let rows: Vec<_> = interface
        .with(Causality::Parameter)
        .map(|i| {
            let (variable, default) = (&interface.variables[i], &table.variables[i]);
            let changed = variable.start != default.start;
            changes += usize::from(changed);
            let default = if changed { start(default) } else { String::new() };
            let settable = if variable.variability == Variability::Tunable { "any time" } else { "start" };
            let cells = vec![
                name(variable),
                unit(variable),
                start(variable),
                default,
                escape(&range(variable)),
                settable.into(),
            ];
            (changed, cells, variable)
        })
        .collect();
    if rows.is_empty() {
        return Section::default();
    }
    let note = match changes {
        0 => "The values in this FMU; all are the model's defaults.".into(),
        1 => "The values in this FMU; the marked one differs from the model's default.".into(),
        n => format!("The values in this FMU; the {n} marked ones differ from the model's defaults."),
    };
    Section::new("Parameters of this FMU")
        .with(Html::text(&format!(
            "{note} They can be set until initialization ends, some also between steps."
        )))
        .with(table_of(&["Name", "Unit", "Value", "Default", "Range", "Set at"], rows))
}

/// Values of the enumerations.
fn items(interface: &Interface) -> Section {
    let mut section = Section::new("Enumerations");
    for variable in &interface.variables {
        if let Kind::Enumeration(items) = &variable.kind {
            let mut table = Table::new(&["Value", &variable.name, "Meaning"]);
            for (value, (name, description)) in (1..).zip(items) {
                let value: i32 = value;
                table = table.row([value.to_string(), name.clone(), description.clone()]);
            }
            section = section.with(table.html());
        }
    }
    section
}

/// What holds for every model: the time grid, inputs between points, states, messages.
fn calls(interface: &Interface, fmi: Fmi) -> Section {
    let step = number(interface.communication_step);
    let categories: String = CATEGORIES
        .iter()
        .map(|(name, meaning)| format!("<li><code>{name}</code>: {}.</li>\n", escape(meaning)))
        .collect();
    let rates = match super::description::capabilities_of(interface).max_output_derivative_order {
        0 => "No output has a derivative over time: all are held between the instants at which they change.",
        _ => &format!(
            "First derivatives of real outputs are offered (<code>{}</code>): over the last
step of the model's own grid. They are 0 for outputs that such a difference would foretell worse than their last value
does, and after <code>{}</code> they are those of the last step.",
            Function::GetRealOutputDerivatives.name(fmi),
            Function::Terminate.name(fmi)
        ),
    };
    let inputs = match fmi {
        Fmi::Two => {
            "An input is held from the point where it is set. With a first derivative (<code>fmi2SetRealInputDerivatives</code>)
it runs on linearly until its next value or derivative is set."
        }
        Fmi::Three => {
            "An input is held from the point where it is set: FMI 3.0 has no derivatives of inputs. What is a motion is a staircase then,
whose steps show in forces; communication steps as short as the motion asks for make them small."
        }
    };
    let missing = match fmi {
        Fmi::Two => "asynchronous steps",
        Fmi::Three => "Event Mode, clocks, intermediate updates, early return",
    };
    let (error, platform) = (format!("{}Error", fmi.prefix()), folder_of(PLATFORM, fmi));
    Section::new("Use in a co-simulation").with(Html::raw(format!(
        "<ul>
<li>A communication step of {step} s suits the model; any positive length is accepted, and it may vary.</li>
<li>The model has its own time grid from the start time on. Whatever the communication points are, the same bits come
out at the same times of the grid, as long as the inputs are the same. At a point between grid points the outputs come
from a copy that is stepped the rest of the way.</li>
<li>{inputs}</li>
<li>The state can be saved, restored and serialised, also into another instance or process. Reset gives a fresh
instance. Any number of instances run side by side.</li>
<li>A value that is not a number or out of its range, a call in the wrong order, a step that is not a positive number or
does not begin where the last one ended: <code>{error}</code> and one message. After a failed step the state can be
restored or reset. So it is with an output that becomes infinite or not a number.</li>
<li>{rates}</li>
<li>Not offered: {missing}.</li>
<li>The binary is for {platform}.</li>
</ul>
<h3>Log categories</h3>
<ul>
{categories}</ul>
"
    )))
}

/// What holds for an FMU that carries another one: what that can do.
fn calls_of_carrier(interface: &Interface, capabilities: &Capabilities) -> Section {
    let step = number(interface.communication_step);
    let can = |yes: bool, what: &str| format!("<li>{what}: {}.</li>\n", if yes { "yes" } else { "no" });
    let mut list = format!("<li>A communication step of {step} s suits the model.</li>\n");
    list += &can(capabilities.can_handle_variable_step, "Communication steps of changing length");
    list += &can(capabilities.can_interpolate_inputs, "First derivatives of inputs");
    list += &can(capabilities.max_output_derivative_order > 0, "First derivatives of outputs");
    list += &can(capabilities.can_get_and_set_state, "Saving and restoring the state");
    list += &can(capabilities.can_serialize_state, "Serialising the state");
    list += &can(!capabilities.can_be_instantiated_once, "Several instances in one process");
    Section::new("Use in a co-simulation").with(Html::raw(format!(
        "<p>As the FMU inside has it:</p>
<ul>
{list}<li>Not offered: asynchronous steps, directional derivatives.</li>
</ul>
"
    )))
}

fn licenses(guid: &str, fmi: Fmi) -> Section {
    let what = match fmi {
        Fmi::Two => "FMI 2.0 for co-simulation, GUID",
        Fmi::Three => "FMI 3.0 for co-simulation, instantiation token",
    };
    Section::new("License").with(Html::raw(format!(
        "<p>latsch is licensed under MIT or Apache 2.0, as you like. The texts, and the crates that are linked into the
binary with their licenses, are beside this page in <code>licenses/</code>; crates that a model of your own adds are
not among them. There is no warranty.</p>
<p class=\"note\">{what} <code>{}</code></p>
",
        escape(guid)
    )))
}

/// A table with the descriptions in the last column; cells are HTML.
fn table_of<'a>(
    head: &[&str],
    rows: impl IntoIterator<Item = (bool, Vec<String>, &'a VariableInfo)>,
) -> Html {
    let mut html = String::from("<div class=\"scroll\"><table class=\"wide\">\n<thead><tr>");
    for title in head {
        html.push_str(&format!("<th{}>{title}</th>", alignment(title)));
    }
    html.push_str("<th>Meaning</th></tr></thead>\n<tbody>\n");
    for (changed, cells, variable) in rows {
        html.push_str(if changed { "<tr class=\"changed\">" } else { "<tr>" });
        for (title, cell) in head.iter().zip(&cells) {
            html.push_str(&format!("<td{}>{cell}</td>", alignment(title)));
        }
        html.push_str(&format!("<td>{}</td></tr>\n", escape(&variable.description)));
    }
    html.push_str("</tbody></table></div>\n");
    Html::raw(html)
}

fn alignment(title: &str) -> &'static str {
    match title {
        "Start" | "Value" | "Default" => " class=\"number\"",
        "Range" | "Set at" => " class=\"range\"",
        _ => "",
    }
}

fn name(variable: &VariableInfo) -> String {
    format!("<code>{}</code>", escape(&variable.name))
}

fn unit(variable: &VariableInfo) -> String {
    let unit = match &variable.kind {
        Kind::Real => variable.unit.as_deref().unwrap_or(""),
        Kind::Integer => "integer",
        Kind::Boolean => "switch",
        Kind::Text => "text",
        Kind::Enumeration(_) => "enumeration",
    };
    escape(unit)
}

fn start(variable: &VariableInfo) -> String {
    match (&variable.start, &variable.kind) {
        (None, _) => String::new(),
        (Some(Value::Real(v)), _) => escape(&number(*v)),
        (Some(Value::Integer(v)), Kind::Enumeration(items)) => {
            let item = usize::try_from(*v - 1).ok().and_then(|i| items.get(i));
            item.map_or_else(|| v.to_string(), |(name, _)| escape(name))
        }
        (Some(Value::Text(text)), _) => format!("<span class=\"text\">{}</span>", escape(text)),
        (Some(value), _) => escape(&value.to_string()),
    }
}

fn range(variable: &VariableInfo) -> String {
    // a limit like pi is readable in four digits
    let number = |limit: f64| match number(limit) {
        long if long.len() > 12 => short(limit),
        exact => exact,
    };
    match (variable.min, variable.max) {
        (Some(min), Some(max)) => format!("{} to {}", number(min), number(max)),
        (Some(min), None) => format!("from {}", number(min)),
        (None, Some(max)) => format!("to {}", number(max)),
        (None, None) => String::new(),
    }
}

/// The shortest text that reads back as the same number, for people.
fn number(value: f64) -> String {
    let size = value.abs();
    let text =
        if size == 0.0 || (1e-4..1e6).contains(&size) { format!("{value}") } else { format!("{value:e}") };
    text.replace('-', "−")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::{Native, Settings};
    use crate::rig::RingBrushFlatTrack;

    const ATTACK: &str = "<script>alert(1)</script>";

    #[test]
    fn values_of_this_fmu_are_shown_and_marked() {
        let table = Native::<RingBrushFlatTrack>::table();
        let plain = page(&table, &table, "", "", Fmi::Two);
        assert!(
            plain.contains("all are the model&#39;s defaults") && !plain.contains("<tr class=\"changed\">")
        );
        let settings = Settings::parse("[parameters]\nbelt_mass = 9.25\ntire_radius = 0.33", "t").unwrap();
        let mut interface = table.clone();
        for (index, value) in settings.check(&table).unwrap() {
            interface.variables[index].start = Some(value);
        }
        let html = page(&table, &interface, "", "", Fmi::Two);
        assert_eq!(html.matches("<tr class=\"changed\">").count(), 2);
        assert!(html.contains("<td class=\"number\">9.25</td><td class=\"number\">8.8</td>"), "{html}");
    }

    #[test]
    fn names_units_and_texts_of_a_table_are_escaped() {
        let mut table = Native::<RingBrushFlatTrack>::table();
        table.name = ATTACK.into();
        table.description = ATTACK.into();
        for v in &mut table.variables {
            v.name = ATTACK.into();
            v.description = ATTACK.into();
            if v.unit.is_some() {
                v.unit = Some(ATTACK.into());
            }
            if let Kind::Enumeration(items) = &mut v.kind {
                items.fill((ATTACK.into(), ATTACK.into()));
            }
            if let Some(Value::Text(text)) = &mut v.start {
                *text = ATTACK.into();
            }
        }
        assert!(!page(&table, &table, ATTACK, "", Fmi::Two).contains("<script"));
    }

    #[test]
    fn an_author_writes_topics_a_text_or_nothing() {
        let table = Native::<RingBrushFlatTrack>::table();
        let of = |text: &str| page(&table, &table, "", text, Fmi::Two);
        assert!(of("<p>Only this</p>").contains("<p>Only this</p>"));
        let two = of("<p>0</p><h2>A &amp; B</h2><p>1</p><h2>C</h2><p>2</p>");
        assert!(
            two.contains("<h2>A &amp; B</h2>\n<p>1</p>") && two.contains("<h2>C</h2>\n<p>2</p>"),
            "{two}"
        );
        assert!(of("").contains("<h2>Inputs</h2>"));
    }
}
