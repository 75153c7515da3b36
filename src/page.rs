//! HTML pages that need nothing else: sections of text, tables and figures, and the style that they share.

use crate::shown::printable;

/// A piece of finished HTML. What takes text escapes it; [`Html::raw`] does not.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Html(String);

impl Html {
    /// HTML as it stands; whoever calls this has [escaped](escape) the text in it.
    pub fn raw(html: impl Into<String>) -> Self {
        Self(html.into())
    }

    /// A paragraph.
    pub fn text(text: &str) -> Self {
        Self(format!("<p>{}</p>\n", escape(text)))
    }

    /// A remark in small grey print.
    pub fn note(text: &str) -> Self {
        Self(format!("<p class=\"note\">{}</p>\n", escape(text)))
    }

    /// The HTML.
    pub fn as_str(&self) -> &str {
        &self.0
    }
}

/// Text in which nothing is markup any more, inside elements and inside quoted attributes, and no character turns the
/// direction of what stands around it.
pub fn escape(text: &str) -> String {
    let mut escaped = String::with_capacity(text.len());
    for c in printable(text).chars() {
        match c {
            '&' => escaped.push_str("&amp;"),
            '<' => escaped.push_str("&lt;"),
            '>' => escaped.push_str("&gt;"),
            '"' => escaped.push_str("&quot;"),
            '\'' => escaped.push_str("&#39;"),
            c => escaped.push(c),
        }
    }
    escaped
}

/// A table. Columns of numbers are aligned to the right.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Table {
    head: Vec<String>,
    rows: Vec<Vec<String>>,
}

impl Table {
    /// A table without rows; without titles it has no head line.
    pub fn new(head: &[&str]) -> Self {
        Self { head: head.iter().map(|s| (*s).into()).collect(), rows: Vec::new() }
    }

    /// The same with one more row.
    #[must_use]
    pub fn row<S: Into<String>>(mut self, cells: impl IntoIterator<Item = S>) -> Self {
        self.rows.push(cells.into_iter().map(Into::into).collect());
        self
    }

    /// True without rows.
    pub fn is_empty(&self) -> bool {
        self.rows.is_empty()
    }

    /// The table as HTML.
    pub fn html(&self) -> Html {
        // a column stands in one line: a unit of 1 among others is no number
        let has_numbers = |i: usize| {
            let mut cells =
                self.rows.iter().filter_map(|row| row.get(i)).filter(|c| !c.is_empty()).peekable();
            cells.peek().is_some() && cells.all(|c| is_number(c))
        };
        let mut html = String::from("<div class=\"scroll\"><table>\n");
        if !self.head.is_empty() {
            html.push_str("<thead><tr>");
            for (i, cell) in self.head.iter().enumerate() {
                html.push_str(if has_numbers(i) { "<th class=\"number\">" } else { "<th>" });
                html.push_str(&escape(cell));
                html.push_str("</th>");
            }
            html.push_str("</tr></thead>\n");
        }
        html.push_str("<tbody>\n");
        for row in &self.rows {
            html.push_str("<tr>");
            for (i, cell) in row.iter().enumerate() {
                html.push_str(if has_numbers(i) { "<td class=\"number\">" } else { "<td>" });
                html.push_str(&escape(cell));
                html.push_str("</td>");
            }
            html.push_str("</tr>\n");
        }
        html.push_str("</tbody></table></div>\n");
        Html(html)
    }
}

/// True for what [`number`] writes.
fn is_number(text: &str) -> bool {
    text == "–" || text.replace('−', "-").parse::<f64>().is_ok()
}

/// A number for people: four significant digits and a true minus sign; a dash if it is not finite.
pub(crate) fn number(value: f64) -> String {
    if !value.is_finite() {
        return "–".into();
    }
    let size = value.abs();
    let text = if size == 0.0 {
        "0".into()
    } else if (1e-3..1e6).contains(&size) {
        let decimals = (3 - size.log10().floor() as i32).max(0) as usize;
        let text = format!("{value:.decimals$}");
        match text.contains('.') {
            true => text.trim_end_matches('0').trim_end_matches('.').into(),
            false => text,
        }
    } else {
        format!("{value:.3e}")
    };
    text.replace('-', "−")
}

/// A part of the page under one heading.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Section {
    heading: String,
    parts: Vec<Html>,
}

impl Section {
    /// An empty section.
    pub fn new(heading: &str) -> Self {
        Self::raw(escape(heading))
    }

    /// An empty section with HTML as its heading.
    pub(crate) fn raw(heading: impl Into<String>) -> Self {
        Self { heading: heading.into(), parts: Vec::new() }
    }

    /// The same with one more part.
    #[must_use]
    pub fn with(mut self, part: Html) -> Self {
        self.parts.push(part);
        self
    }

    /// The same with parts that stand side by side where the screen is wide enough.
    #[must_use]
    pub fn side_by_side(self, parts: impl IntoIterator<Item = Html>) -> Self {
        let parts: String = parts.into_iter().map(|part| part.0).collect();
        self.with(Html(format!("<div class=\"grid\">\n{parts}</div>\n")))
    }

    /// True without parts.
    pub fn is_empty(&self) -> bool {
        self.parts.is_empty()
    }
}

/// A page: title, description, sections, and a footer with the version.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Page {
    title: String,
    description: String,
    sections: Vec<Section>,
}

impl Page {
    /// A page without sections.
    pub fn new(title: &str, description: &str) -> Self {
        Self { title: title.into(), description: description.into(), sections: Vec::new() }
    }

    /// The same with one more section; an empty one is left out.
    #[must_use]
    pub fn section(mut self, section: Section) -> Self {
        if !section.is_empty() {
            self.sections.push(section);
        }
        self
    }

    /// The page: a whole HTML document.
    pub fn html(&self) -> String {
        let title = escape(&self.title);
        let mut html = format!(
            "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
             <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n\
             <title>{title}</title>\n<style>\n{STYLE}</style>\n</head>\n<body>\n\
             <header>\n<h1>{title}</h1>\n"
        );
        if !self.description.is_empty() {
            html.push_str(&format!("<p class=\"lead\">{}</p>\n", escape(&self.description)));
        }
        let named: Vec<_> = self.sections.iter().enumerate().filter(|(_, s)| !s.heading.is_empty()).collect();
        if named.len() > 2 {
            html.push_str("<nav>");
            for (i, section) in &named {
                html.push_str(&format!("<a href=\"#section-{i}\">{}</a> ", section.heading));
            }
            html.push_str("</nav>\n");
        }
        html.push_str("</header>\n<main>\n");
        for (i, section) in self.sections.iter().enumerate() {
            html.push_str(&format!("<section id=\"section-{i}\">\n"));
            if !section.heading.is_empty() {
                html.push_str(&format!("<h2>{}</h2>\n", section.heading));
            }
            for part in &section.parts {
                html.push_str(&part.0);
            }
            html.push_str("</section>\n");
        }
        let has_figures = html.contains(" data-x=\"");
        let hint = if has_figures { FIGURES_HINT } else { "" };
        html.push_str(&format!("</main>\n<footer>Made by latsch {}{hint}</footer>\n", crate::VERSION));
        if has_figures {
            html.push_str(&format!("<script>\n{FIGURES}</script>\n"));
        }
        html.push_str("</body>\n</html>\n");
        html
    }
}

/// What makes figures something to work with; without, they are pictures.
const FIGURES: &str = include_str!("page/figures.js");

/// How it is worked with.
const FIGURES_HINT: &str = ". Figures: point to read values, drag over a part to see it alone, double-click for the whole, click an entry of the \
    legend to hide it; saved as SVG or PNG by the buttons at their top right.";

/// A page without that script.
#[cfg(test)]
pub(crate) fn still(html: &str) -> String {
    html.replace(&format!("<script>\n{FIGURES}</script>\n"), "")
}

const STYLE: &str = "\
:root { color-scheme: light; }
* { box-sizing: border-box; }
body { margin: 0 auto; padding: 1.5rem; max-width: 68rem; background: #fff; color: #1c2329;
  font: 15px/1.5 system-ui, -apple-system, 'Segoe UI', Roboto, 'Helvetica Neue', Arial, sans-serif; }
h1 { margin: 0 0 .3rem; font-size: 1.7rem; line-height: 1.2; font-weight: 650; }
h2 { margin: 2.4rem 0 .8rem; padding-bottom: .25rem; border-bottom: 1px solid #d5dade;
  font-size: 1.2rem; font-weight: 650; break-after: avoid; }
h1, h2, .lead, figcaption { overflow-wrap: anywhere; }
p { margin: .5rem 0; max-width: 48rem; }
.lead { font-size: 1.05rem; color: #46525c; }
.note { font-size: .87rem; color: #5b6770; }
nav { margin: 1rem 0 0; font-size: .92rem; }
nav a { color: #0b5394; margin-right: 1rem; text-decoration: none; white-space: nowrap; }
nav a:hover { text-decoration: underline; }
figure { margin: 0 0 1.2rem; break-inside: avoid; }
figure svg { display: block; width: 100%; height: auto; }
figcaption { font-size: .9rem; line-height: 1.4; margin-bottom: .2rem; }
figcaption b { font-weight: 600; margin-right: .9rem; }
.key { display: inline-block; margin-right: 1rem; color: #37434c; }
.key i { display: inline-block; width: 1.5rem; margin-right: .35rem; border-top: 3px solid; vertical-align: middle; }
.key i.measured { border-top-width: 2px; border-top-style: dashed; }
.key[role] { cursor: pointer; }
.key.off { opacity: .4; text-decoration: line-through; }
figure:has(.tools) { position: relative; }
.tools { position: absolute; right: 0; top: 0; opacity: 0; white-space: nowrap; background: #fff; }
figure:hover .tools, .tools:focus-within { opacity: 1; }
.tools button { font: inherit; font-size: .75rem; padding: 0 .4rem; margin-right: .25rem; color: #37434c; background: #f6f8fa; border: 1px solid #c8ced3; border-radius: 4px; cursor: pointer; }
figure svg[data-x] { touch-action: pan-y; }
.tip { position: absolute; z-index: 2; padding: .25rem .5rem; font-size: .8rem; line-height: 1.4; background: #fffffff0; border: 1px solid #c8ced3; border-radius: 4px; pointer-events: none; font-variant-numeric: tabular-nums; }
.tip[hidden] { display: none; }
@media print { .tools, .tip { display: none; } }
.key i.dot { width: .6rem; height: .6rem; border: 3px solid; border-radius: 50%; }
.grid { display: grid; grid-template-columns: 1fr 1fr; gap: 0 1.6rem; align-items: end; }
.scroll { overflow-x: auto; }
table { border-collapse: collapse; margin: .4rem 0 1rem; font-size: .9rem; font-variant-numeric: tabular-nums; }
th, td { padding: .2rem 1.4rem .2rem 0; border-bottom: 1px solid #e6e9ec; text-align: left; vertical-align: top; }
th { font-weight: 600; border-bottom-color: #aab3ba; white-space: nowrap; }
.number { text-align: right; white-space: nowrap; }
h3 { margin: 1.6rem 0 .5rem; font-size: 1rem; font-weight: 650; break-after: avoid; }
code { font: .92em ui-monospace, 'SF Mono', Menlo, Consolas, 'DejaVu Sans Mono', monospace; }
td code { white-space: nowrap; }
ul { padding-left: 1.2rem; max-width: 48rem; }
li { margin: .25rem 0; }
dl.eq { margin: .6rem 0; padding: .5rem .9rem; background: #f7f8fa; border-radius: 6px; overflow-x: auto; break-inside: avoid; }
dl.eq > div { display: flex; justify-content: space-between; align-items: center; gap: 2rem; min-height: 2.1rem; }
dl.eq dt, dl.eq dd { margin: 0; white-space: nowrap; }
dl.eq dd { color: #5b6770; font-size: .87rem; }
math { font-size: 1.06em; }
math[display=block] { margin: .25rem 0; text-align: left; }
math .matrix { margin: 0 .2em; padding: 0 .1em; border: solid; border-width: 0 1.5px; border-radius: .6em; }
math .cases { margin-left: .2em; border-left: 1.5px solid; border-radius: .6em; }
math .cases mtd { text-align: left; }
math mrow.matrix { padding: 0 .25em; }
math mover > mo { font-size: 1.25em; }
math mfrac > * { padding: .12em .1em; }
.range { white-space: nowrap; }
.wide .text { white-space: normal; }
.changed { background: #fff6dc; }
.patch input { width: 100%; margin: .4rem 0; accent-color: #0b5394; }
footer { margin-top: 3rem; padding-top: .6rem; border-top: 1px solid #d5dade; font-size: .85rem; color: #5b6770; }
@media screen and (max-width: 900px) {
  .grid { grid-template-columns: minmax(0, 40rem); }
  body { padding: 1rem; }
}
@media print {
  @page { margin: 15mm; }
  body { padding: 0; max-width: none; font-size: 10pt; }
  nav, .patch input { display: none; }
  * { print-color-adjust: exact; -webkit-print-color-adjust: exact; }
}
";

#[cfg(test)]
mod tests {
    use super::*;

    const ATTACK: &str = "<script>alert('x')</script>\"&";

    #[test]
    fn the_stylesheet_says_everything_once() {
        let mut seen = std::collections::BTreeSet::new();
        for rule in STYLE.lines().map(str::trim).filter(|line| line.contains(": ")) {
            assert!(seen.insert(rule), "twice: {rule}");
        }
        let (_, print) = STYLE.split_once("@media print").unwrap();
        assert!(print.contains("nav, .patch input { display: none; }"), "paper has no links and sliders");
        assert_eq!(STYLE.matches('{').count(), STYLE.matches('}').count());
    }

    #[test]
    fn nothing_turns_the_direction_of_writing() {
        assert_eq!(escape("a\u{202e}<b\u{9b}\n"), "a\\u{202e}&lt;b\\u{9b}\n");
    }

    #[test]
    fn text_stays_text_everywhere() {
        let table = Table::new(&[ATTACK]).row([ATTACK]);
        let section =
            Section::new(ATTACK).with(Html::text(ATTACK)).with(Html::note(ATTACK)).with(table.html());
        let page =
            Page::new(ATTACK, ATTACK).section(section.clone()).section(section.clone()).section(section);
        let html = page.html();
        assert!(!html.contains("<script"), "{html}");
        // title, h1 and description; 3 links; heading, text, note, head and cell three times
        assert_eq!(
            html.matches("&lt;script&gt;alert(&#39;x&#39;)&lt;/script&gt;&quot;&amp;").count(),
            3 + 3 + 15
        );
    }

    #[test]
    fn a_page_is_whole_and_needs_nothing_else() {
        let html = Page::new("t", "").section(Section::new("empty")).html();
        assert!(html.starts_with("<!DOCTYPE html>") && html.ends_with("</html>\n"));
        assert!(html.contains(&format!("latsch {}", crate::VERSION)));
        assert!(!html.contains("empty") && !html.contains("lead\""));
        for outside in ["http:", "https:", "url(", "@import", "src="] {
            assert!(!html.contains(outside), "{outside}");
        }
    }

    #[test]
    fn numbers_are_short_and_aligned() {
        for (value, text) in [
            (0.0, "0"),
            (4000.0, "4000"),
            (-12.3456, "−12.35"),
            (0.5, "0.5"),
            (0.00123456, "0.001235"),
            (123456.7, "123457"),
            (1.5e-7, "1.500e−7"),
            (-2.5e9, "−2.500e9"),
            (f64::NAN, "–"),
        ] {
            assert_eq!(number(value), text);
            assert!(is_number(text), "{text}");
        }
        let html = Table::new(&["name", "value"]).row(["a", "−1.5"]).html();
        assert!(html.as_str().contains("<td>a</td><td class=\"number\">−1.5</td>"));
        assert!(html.as_str().contains("<th>name</th><th class=\"number\">value</th>"));
        let mixed = Table::new(&["unit", "value"]).row(["1", "2"]).row(["m", ""]).html();
        assert!(mixed.as_str().contains("<td>1</td><td class=\"number\">2</td>"));
    }
}
