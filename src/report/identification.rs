//! The page of an identification from recordings: what is known of each parameter first, then what it was read from.

use super::plot::{Axis, Plot, Size, Tone};
use crate::identify::recorded::{Answer, Light, Quantity, Response};
use crate::page::{Html, Page, Section, Table, number};
use std::fmt::Write;

const STYLE: &str = "\
.light { display: inline-block; width: .8rem; height: .8rem; margin-right: .5rem; border-radius: 50%; vertical-align: -.05rem; }
td:has(> .light) { white-space: nowrap; }
.light.green { background: #2e9e5b; } .light.yellow { background: #e9b82c; } .light.red { background: #cf4332; }
td.why { min-width: 24rem; max-width: 26rem; font-size: .87rem; color: #46525c; }
";

/// The page of what recordings told of a tire; `plan` is what was followed, `units` are those of the model's parameters by name.
pub fn identification_report(plan: &str, answer: &Answer, unit: impl Fn(&str) -> String) -> String {
    let count = |light| answer.parameters.iter().filter(|p| p.light == light).count();
    let lead = format!(
        "{plan}. Of {} parameters {} are known within a tenth, {} less well, and {} are not known.",
        answer.parameters.len(),
        count(Light::Green),
        count(Light::Yellow),
        count(Light::Red)
    );
    let mut page = Page::new("Parameters from recordings", &lead)
        .section(parameters(answer, unit).with(Html::raw(format!("<style>\n{STYLE}</style>\n"))))
        .section(characteristics(answer));
    for section in groups(answer) {
        page = page.section(section);
    }
    page.section(offsets(answer)).section(notes(answer)).html()
}

fn name(light: Light) -> &'static str {
    match light {
        Light::Green => "green",
        Light::Yellow => "yellow",
        Light::Red => "red",
    }
}

fn parameters(answer: &Answer, unit: impl Fn(&str) -> String) -> Section {
    let mut html = String::from(
        "<div class=\"scroll\"><table>\n<thead><tr><th>parameter</th><th class=\"number\">value</th><th class=\"number\">± (90 %)</th>\
         <th class=\"number\">± %</th><th>unit</th><th>group</th></tr></thead>\n<tbody>\n",
    );
    for row in &answer.parameters {
        let light = name(row.light);
        let (half, share) = match row.half_width {
            Some(half) => (number(half), number(100.0 * half / row.value.abs())),
            None => ("–".to_owned(), "–".to_owned()),
        };
        let _ = writeln!(
            html,
            "<tr><td><i class=\"light {light}\" title=\"{light}\"></i><code>{}</code></td><td class=\"number\">{}</td>\
             <td class=\"number\">{half}</td><td class=\"number\">{share}</td><td>{}</td><td class=\"why\">{}</td></tr>",
            super::escape(&row.name),
            number(row.value),
            super::escape(&unit(&row.name)),
            super::escape(row.why.as_deref().unwrap_or(&row.group)),
        );
    }
    html.push_str("</tbody></table></div>\n");
    Section::new("Parameters").with(Html::raw(html)).with(Html::note(
        "Green: known within a tenth. Yellow: known less well. Red: not known; the value is the one that it had, or its interval \
         reaches down to nothing. Intervals count what scatters, and what is held and may be elsewhere.",
    ))
}

fn axis(quantity: &Quantity) -> Axis {
    Axis::new(&quantity.name, &quantity.unit)
}

fn characteristics(answer: &Answer) -> Section {
    let plots = answer.characteristics.iter().map(|c| {
        Plot::new("", axis(&c.over), axis(&c.of))
            .size(Size::Half)
            .rings("modelled", &c.at, &c.modelled)
            .dots("measured", &c.at, &c.measured)
            .html()
    });
    let plots: Vec<Html> = plots.collect();
    if plots.is_empty() {
        return Section::new("Measured and modelled");
    }
    Section::new("Measured and modelled").side_by_side(plots).with(Html::note(
        "Each dot is a stretch in which the rig held still, less the offsets of the channels; the ring is what the model has at the \
         same inputs. Where several inputs were varied, dots of all of them are shown.",
    ))
}

fn groups(answer: &Answer) -> Vec<Section> {
    let mut names: Vec<&String> = answer.targets.iter().map(|t| &t.group).collect();
    names.dedup();
    let one = |(place, group): (usize, &String)| {
        let head = ["target", "readings", "measured", "± (90 %)", "modelled"];
        let targets = answer.targets.iter().filter(|t| t.group == *group);
        let table = targets.fold(Table::new(&head), |table, t| {
            let numbers = [t.measured, t.half_width, t.modelled].map(number);
            let [measured, half, modelled] = numbers;
            table.row([t.name.clone(), t.readings.to_string(), measured, half, modelled])
        });
        let plots = answer.responses.iter().filter(|r| r.group == *group).map(|r| response(answer, r));
        let section = Section::new(&format!("{}. {group}", place + 1)).with(table.html()).side_by_side(plots);
        let words = answer.responses.iter().filter(|r| r.group == *group && r.amplification.is_finite());
        words.fold(section, |section, r| {
            section.with(Html::note(&format!(
                "1 % more of \"{}\" with all other targets as they are: {} % of {}.",
                r.target,
                number(r.amplification),
                r.parameter.name
            )))
        })
    };
    names.into_iter().enumerate().map(one).collect()
}

/// The target over the parameter, with what was measured and where the parameter is then.
fn response(answer: &Answer, response: &Response) -> Html {
    let (target, unit) = response.target.split_once(" [").unwrap_or((&response.target, "1"));
    let mut plot = Plot::new("", axis(&response.parameter), Axis::new(target, unit.trim_end_matches(']')))
        .size(Size::Half)
        .line("target", &response.at, &response.reads);
    if let Some(told) = answer.targets.iter().find(|t| t.name == response.target) {
        let ends = [response.at.first(), response.at.last()].map(|end| end.copied().unwrap_or(f64::NAN));
        let [low, high] = [told.measured - told.half_width, told.measured + told.half_width];
        plot = plot
            .band(Tone::Before, &ends, &[low; 2], &[high; 2])
            .dots("found", &[response.value], &[told.measured])
            .measured("measured", &ends, &[told.measured; 2]);
    }
    plot.html()
}

fn offsets(answer: &Answer) -> Section {
    let rows = answer.offsets.iter().chain(&answer.zeros);
    let table =
        rows.fold(Table::new(&["channel", "offset"]), |t, (name, v)| t.row([name.clone(), number(*v)]));
    let section = Section::new("Offsets of the channels");
    if table.is_empty() {
        return section;
    }
    section.with(table.html()).with(Html::note(
        "What a channel shows more than there is: of forces as measured off the road, of angles, slip and height as the model asks for.",
    ))
}

fn notes(answer: &Answer) -> Section {
    let contradictions = answer.misfits.iter().map(|misfit| format!("Contradiction: {}", misfit.words()));
    let notes = contradictions.chain(answer.notes.iter().cloned());
    notes.fold(Section::new("Notes"), |section, note| section.with(Html::text(&note)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::identify::recorded::Found;

    #[test]
    fn what_is_not_known_is_red_and_says_why_as_text() {
        let found = |name: &str, light, why: Option<&str>| Found {
            name: name.into(),
            group: "springs".into(),
            value: 1.5e5,
            half_width: why.is_none().then_some(3e3),
            light,
            why: why.map(Into::into),
        };
        let answer = Answer {
            parameters: vec![
                found("radial", Light::Green, None),
                found("tilt", Light::Red, Some("\"<moment>\" cannot be read")),
            ],
            notes: vec!["<script>".into()],
            ..Answer::default()
        };
        let page = identification_report("a plan", &answer, |_| "N/m".into());
        assert!(
            page.contains("Of 2 parameters 1 are known within a tenth, 0 less well, and 1 are not known")
        );
        assert!(page.contains("light red") && page.contains("&lt;moment&gt;") && !page.contains("<script>"));
        // 3e3 of 1.5e5
        assert!(page.contains("<td class=\"number\">2</td>"), "{page}");
    }
}
