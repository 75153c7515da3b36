//! Heat maps as tables: numbers stay readable on a phone and for a screen reader.

use crate::page::{Html, escape};
use std::fmt::Write;

/// Vermilion of the plots' palette: where the shade is full.
const FULL: [f64; 3] = [213.0, 94.0, 0.0];

/// One cell of a [`HeatMap`].
#[derive(Debug, Clone, PartialEq, Default)]
pub struct HeatCell {
    /// What stands in it.
    pub text: String,
    /// How much colour, 0 to 1; 0 is a cell that says nothing, in grey letters.
    pub shade: f64,
    /// What is said about it where the pointer rests.
    pub title: String,
}

/// A table of shaded cells.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct HeatMap {
    title: String,
    corner: String,
    columns: Vec<String>,
    rows: Vec<(String, Vec<Option<HeatCell>>)>,
}

impl HeatMap {
    /// A map without rows: its title, what the rows are, and the heads of the columns.
    pub fn new(title: &str, corner: &str, columns: &[String]) -> Self {
        Self { title: title.into(), corner: corner.into(), columns: columns.into(), rows: Vec::new() }
    }

    /// The same with one more row; `None` where there is nothing.
    #[must_use]
    pub fn row(mut self, head: &str, cells: Vec<Option<HeatCell>>) -> Self {
        self.rows.push((head.into(), cells));
        self
    }

    /// The map as a figure.
    pub fn html(&self) -> Html {
        let mut html = String::from("<figure>");
        let _ = write!(
            html,
            "<figcaption><b>{}</b></figcaption>\n<div class=\"scroll\"><table class=\"heat\"><thead><tr><th>{}</th>",
            escape(&self.title),
            escape(&self.corner)
        );
        for column in &self.columns {
            let _ = write!(html, "<th>{}</th>", escape(column));
        }
        html.push_str("</tr></thead>\n<tbody>\n");
        for (head, cells) in &self.rows {
            let _ = write!(html, "<tr><th>{}</th>", escape(head));
            for cell in cells {
                match cell {
                    Some(cell) => html.push_str(&cell.html()),
                    None => html.push_str("<td></td>"),
                }
            }
            html.push_str("</tr>\n");
        }
        html.push_str("</tbody></table></div></figure>\n");
        Html::raw(html)
    }
}

impl HeatCell {
    fn html(&self) -> String {
        let shade = if self.shade.is_finite() { self.shade.clamp(0.0, 1.0) } else { 0.0 };
        let [r, g, b] = FULL.map(|full| (255.0 + shade * (full - 255.0)).round() as u8);
        // dark letters stand out from the full shade better than white ones
        let letters = if shade == 0.0 { ";color:#7a858d" } else { "" };
        format!(
            "<td style=\"background:#{r:02x}{g:02x}{b:02x}{letters}\" title=\"{}\">{}</td>",
            escape(&self.title),
            escape(&self.text)
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shades_go_from_white_to_full() {
        let cell = |shade| HeatCell { text: "x".into(), shade, title: "t".into() }.html();
        assert!(cell(1.0).contains("background:#d55e00\""));
        assert!(cell(0.0).contains("background:#ffffff;color:#7a858d"));
        assert!(cell(0.5).contains("background:#eaaf80\""));
        assert_eq!(cell(7.0), cell(1.0));
        assert_eq!(cell(f64::NAN), cell(0.0));
    }

    #[test]
    fn text_stays_text() {
        let bad = "<script>\"";
        let cell = HeatCell { text: bad.into(), shade: 1.0, title: bad.into() };
        let map = HeatMap::new(bad, bad, &[bad.into()]).row(bad, vec![Some(cell), None]);
        let html = map.html();
        assert!(!html.as_str().contains("<script"));
        assert_eq!(html.as_str().matches("&lt;script&gt;&quot;").count(), 6);
    }
}
