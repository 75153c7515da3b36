//! The influence matrix of a plan as a picture: a row for each target, a column for each parameter, in the order of the groups.

use crate::identify::check::Report;
use crate::page::{Html, escape};
use std::fmt::Write;

/// Colours: what may be, full; what may not, full; and frames, grid, letters.
const MAY: [f64; 3] = [0.0, 114.0, 178.0];
const MAY_NOT: [f64; 3] = [213.0, 94.0, 0.0];
const FRAME: &str = "#1c2329";
const GRID: &str = "#dfe4e7";
const GREY: &str = "#5b6770";
/// What later groups may not touch has this ground.
const LATER: &str = "#f4f5f6";
/// From this share of a target's range on a cell has the full colour, from that one on it has some; even over the orders of magnitude
/// between.
const FULL: f64 = 1.0;
const FAINT: f64 = 1e-4;
/// Of a range, what the faintest colour is of the full one.
const LEAST: f64 = 0.07;

/// Width of the drawing, of a letter, and of what is left beside the cells for names of groups.
const WIDTH: f64 = 1100.0;
const LETTER: f64 = 6.6;
const BESIDE: f64 = 210.0;
/// Distance of lines.
const LINE: f64 = 15.0;
/// Largest and smallest cell.
const CELL: [f64; 2] = [16.0, 44.0];
/// From this size on a cell has its number in it.
const WITH_NUMBER: f64 = 30.0;
/// Letters of a name; more are left out.
const LONGEST: usize = 46;

/// Where everything is.
struct Drawing<'a> {
    report: &'a Report,
    width: f64,
    left: f64,
    top: f64,
    cell: f64,
}

/// The matrix as a figure, with its legend.
pub(super) fn influence_picture(report: &Report) -> Html {
    let longest = |names: &[String]| names.iter().map(|n| short(n).chars().count()).max().unwrap_or(0) as f64;
    let columns = report.parameters.len().max(1) as f64;
    let left = LETTER * longest(&report.targets) + 34.0;
    let cell = ((WIDTH - left - BESIDE) / columns).clamp(CELL[0], CELL[1]);
    // names of parameters lean to the right by 45 degrees
    let top = LETTER * longest(&report.parameters) * 0.5f64.sqrt() + 22.0;
    let width = WIDTH.max(left + columns * cell + BESIDE);
    let drawing = Drawing { report, width, left, top, cell };
    let bottom = top + report.targets.len() as f64 * cell;
    let mut svg = format!(
        "<figure><div class=\"scroll\"><svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width:.0} {:.0}\" role=\"img\" \
         style=\"min-width:46rem\" font-family=\"system-ui, sans-serif\" font-size=\"12.5\" fill=\"#37434c\">\
         <title>Influence of parameters on targets</title>\n",
        bottom + 74.0
    );
    drawing.later(&mut svg);
    drawing.cells(&mut svg);
    drawing.names(&mut svg);
    drawing.frames(&mut svg);
    drawing.legend(&mut svg, bottom + 34.0);
    svg.push_str("</svg></div></figure>\n");
    Html::raw(svg)
}

/// A name that is not longer than there is room for.
fn short(name: &str) -> String {
    if name.chars().count() <= LONGEST {
        return name.to_owned();
    }
    let kept: String = name.chars().take(LONGEST - 1).collect();
    kept + "…"
}

/// Words in lines of `room` letters; of more than `most` lines the rest is left out.
fn lines(text: &str, room: usize, most: usize) -> Vec<String> {
    let mut lines = vec![String::new()];
    for word in text.split(' ') {
        let last = lines.len() - 1;
        let length = lines[last].chars().count() + word.chars().count();
        if length < room || lines[last].is_empty() {
            if !lines[last].is_empty() || word.is_empty() {
                lines[last].push(' ');
            }
            lines[last].push_str(word);
        } else if lines.len() < most {
            // names stand below each other, behind the number
            lines.push(format!("\u{2003}{word}"));
        } else {
            lines[last].push('…');
            break;
        }
    }
    lines
}

/// The share of the full colour.
fn shade(share: f64) -> f64 {
    let part = (share / FAINT).log10() / (FULL / FAINT).log10();
    LEAST + (1.0 - LEAST) * part.clamp(0.0, 1.0)
}

fn color(full: [f64; 3], shade: f64) -> String {
    let [r, g, b] = full.map(|full| (255.0 + shade * (full - 255.0)).round() as u8);
    format!("#{r:02x}{g:02x}{b:02x}")
}

/// A share in a few letters.
fn number(share: f64) -> String {
    match share {
        s if s >= 9.95 => format!("{s:.0}"),
        s if s >= 0.995 => format!("{s:.1}"),
        s if s >= 0.01 => format!("{s:.2}").trim_start_matches('0').to_owned(),
        s => format!("{s:.0e}").replace('-', "−"),
    }
}

impl Drawing<'_> {
    fn x(&self, column: usize) -> f64 {
        self.left + column as f64 * self.cell
    }

    fn y(&self, row: usize) -> f64 {
        self.top + row as f64 * self.cell
    }

    /// The group of a target, as its first parameter and that of the next group.
    fn range(&self, row: usize) -> [usize; 2] {
        let own = self.report.groups.iter().map(|g| g.range).find(|[_, to]| row < *to);
        own.unwrap_or([row, row + 1])
    }

    /// The ground of what no target of a group may depend on, and the grid.
    fn later(&self, svg: &mut String) {
        let (rows, columns) = (self.report.targets.len(), self.report.parameters.len());
        let right = self.x(columns);
        for group in &self.report.groups {
            let [from, to] = group.range;
            let (x, y) = (self.x(to), self.y(from));
            let (width, height) = (right - x, self.y(to) - y);
            let _ = writeln!(
                svg,
                "<rect x=\"{x:.1}\" y=\"{y:.1}\" width=\"{width:.1}\" height=\"{height:.1}\" fill=\"{LATER}\"/>"
            );
        }
        let mut grid = String::new();
        for column in 0..=columns {
            let _ = write!(grid, "M{:.1} {:.1}V{:.1}", self.x(column), self.y(0), self.y(rows));
        }
        for row in 0..=rows {
            let _ = write!(grid, "M{:.1} {:.1}H{right:.1}", self.x(0), self.y(row));
        }
        let _ = writeln!(svg, "<path d=\"{grid}\" stroke=\"{GRID}\" fill=\"none\"/>");
    }

    fn cells(&self, svg: &mut String) {
        for (i, row) in self.report.influence.iter().enumerate() {
            let [_, later] = self.range(i);
            for (k, share) in row.iter().enumerate() {
                let (x, y) = (self.x(k), self.y(i));
                let (target, parameter) = (&self.report.targets[i], &self.report.parameters[k]);
                let about = format!("{} over {}", escape(target), escape(parameter));
                match share {
                    Some(0.0) => {}
                    Some(share) => {
                        let full = if k < later { MAY } else { MAY_NOT };
                        let shade = shade(*share);
                        let _ = write!(
                            svg,
                            "<g><title>{about}: {share:.2e} of its range</title><rect x=\"{:.1}\" y=\"{:.1}\" width=\"{:.1}\" height=\"{:.1}\" fill=\"{}\"/>",
                            x + 0.5,
                            y + 0.5,
                            self.cell - 1.0,
                            self.cell - 1.0,
                            color(full, shade),
                        );
                        let letters = if shade > 0.62 { "#fff" } else { FRAME };
                        self.letters(svg, [i, k], &number(*share), letters);
                        svg.push_str("</g>\n");
                    }
                    None => {
                        let _ = write!(svg, "<g><title>{about}: not tested</title>");
                        self.letters(svg, [i, k], "?", GREY);
                        svg.push_str("</g>\n");
                    }
                }
            }
        }
    }

    fn letters(&self, svg: &mut String, [row, column]: [usize; 2], text: &str, color: &str) {
        if self.cell >= WITH_NUMBER || text == "?" {
            let (x, y) = (self.x(column) + 0.5 * self.cell, self.y(row) + 0.5 * self.cell + 4.0);
            let _ = write!(
                svg,
                "<text x=\"{x:.1}\" y=\"{y:.1}\" text-anchor=\"middle\" font-size=\"11\" fill=\"{color}\">{text}</text>"
            );
        }
    }

    fn names(&self, svg: &mut String) {
        for (row, name) in self.report.targets.iter().enumerate() {
            let _ = writeln!(
                svg,
                "<text x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"end\">{}</text>",
                self.left - 10.0,
                self.y(row) + 0.5 * self.cell + 4.0,
                escape(&short(name))
            );
        }
        for (column, name) in self.report.parameters.iter().enumerate() {
            let (x, y) = (self.x(column) + 0.5 * self.cell + 3.0, self.top - 8.0);
            let _ = writeln!(
                svg,
                "<text x=\"{x:.1}\" y=\"{y:.1}\" transform=\"rotate(-45 {x:.1} {y:.1})\">{}</text>",
                escape(&short(name))
            );
        }
        let right = self.x(self.report.parameters.len()) + 12.0;
        let room = ((self.width - right) / LETTER) as usize;
        for (number, group) in self.report.groups.iter().enumerate() {
            let [from, to] = group.range;
            let height = self.cell * (to - from) as f64;
            let most = ((height / LINE) as usize).max(1);
            let lines = lines(&format!("{}  {}", number + 1, group.name), room, most);
            let first = self.y(from) + 0.5 * (height - LINE * (lines.len() - 1) as f64) + 4.0;
            let _ = write!(svg, "<g fill=\"{GREY}\"><title>{}</title>", escape(&group.name));
            for (k, line) in lines.iter().enumerate() {
                let y = first + LINE * k as f64;
                let _ = write!(svg, "<text x=\"{right:.1}\" y=\"{y:.1}\">{}</text>", escape(line));
            }
            svg.push_str("</g>\n");
        }
    }

    /// Borders between groups, a frame around what each of them finds, and the step below which all has to be.
    fn frames(&self, svg: &mut String) {
        let (rows, columns) = (self.report.targets.len(), self.report.parameters.len());
        let (mut lines, mut step) = (String::new(), format!("M{:.1} {:.1}", self.x(0), self.y(0)));
        for group in &self.report.groups {
            let [from, to] = group.range;
            let _ = write!(step, "H{:.1}V{:.1}", self.x(to), self.y(to));
            let size = self.cell * (to - from) as f64;
            let _ = writeln!(
                svg,
                "<rect x=\"{:.1}\" y=\"{:.1}\" width=\"{size:.1}\" height=\"{size:.1}\" fill=\"none\" stroke=\"{FRAME}\" stroke-width=\"2.2\"/>",
                self.x(from),
                self.y(from)
            );
            if to < rows {
                let _ =
                    write!(lines, "M{:.1} {:.1}H{:.1}", self.x(0) - 6.0, self.y(to), self.x(columns) + 6.0);
                let _ = write!(lines, "M{:.1} {:.1}V{:.1}", self.x(to), self.y(0) - 6.0, self.y(rows));
            }
        }
        let _ = writeln!(svg, "<path d=\"{lines}\" stroke=\"#aab3ba\" fill=\"none\"/>");
        let _ = writeln!(svg, "<path d=\"{step}\" stroke=\"{FRAME}\" stroke-width=\"2.2\" fill=\"none\"/>");
    }

    fn legend(&self, svg: &mut String, y: f64) {
        let steps = 60;
        let (x, width) = (self.left, 3.0);
        let share = |k: usize| FAINT * (FULL / FAINT).powf(k as f64 / (steps - 1) as f64);
        for k in 0..steps {
            let color = color(MAY, shade(share(k)));
            let x = x + k as f64 * width;
            let _ = write!(
                svg,
                "<rect x=\"{x:.1}\" y=\"{y:.1}\" width=\"{:.1}\" height=\"12\" shape-rendering=\"crispEdges\" fill=\"{color}\"/>",
                width + 0.3
            );
        }
        let bar = steps as f64 * width;
        for (place, text) in ["≤ 10⁻⁴", "10⁻³", "10⁻²", "10⁻¹", "≥ 1"].iter().enumerate() {
            let x = x + bar * place as f64 / 4.0;
            let _ = write!(
                svg,
                "<text x=\"{x:.1}\" y=\"{:.1}\" text-anchor=\"middle\" font-size=\"11\">{text}</text>",
                y + 27.0
            );
        }
        let _ = writeln!(
            svg,
            "<text x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"end\">share of the target's range</text>",
            x - 26.0,
            y + 10.0
        );
        let mut x = x + bar + 34.0;
        let later = format!("<rect width=\"14\" height=\"12\" fill=\"{LATER}\" stroke=\"{GRID}\"/>");
        let own = format!(
            "<rect width=\"14\" height=\"12\" fill=\"none\" stroke=\"{FRAME}\" stroke-width=\"2.2\"/>"
        );
        let wrong = format!("<rect width=\"14\" height=\"12\" fill=\"{}\"/>", color(MAY_NOT, 1.0));
        for (sign, text, room) in [
            (own, "a group's own", 120.0),
            (later, "later parameters: has to be empty", 255.0),
            (wrong, "is not: counter-example", 160.0),
        ] {
            let _ = writeln!(
                svg,
                "<g transform=\"translate({x:.1} {y:.1})\">{sign}<text x=\"21\" y=\"10\">{text}</text></g>"
            );
            x += room;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn colours_are_even_over_orders_of_magnitude() {
        assert_eq!(color(MAY, shade(1.0)), "#0072b2");
        assert_eq!(color(MAY, shade(30.0)), "#0072b2");
        assert_eq!(shade(1e-9), LEAST);
        let steps = [1e-4, 1e-3, 1e-2, 1e-1, 1.0].map(shade);
        assert!(steps.windows(2).all(|w| (w[1] - w[0] - (1.0 - LEAST) / 4.0).abs() < 1e-12), "{steps:?}");
    }

    #[test]
    fn numbers_fit_into_cells() {
        for (share, text) in [(12.3, "12"), (8.79, "8.8"), (0.4567, ".46"), (0.0123, ".01"), (3e-5, "3e−5")]
        {
            assert_eq!(number(share), text);
            assert!(text.chars().count() <= 4);
        }
    }

    #[test]
    fn a_long_name_is_cut_or_goes_on_below() {
        assert_eq!(lines("1  a long name", 40, 1), ["1  a long name"]);
        assert_eq!(lines("1  a long name", 8, 3), ["1  a", "\u{2003}long", "\u{2003}name"]);
        assert_eq!(lines("1  a long name", 8, 1), ["1  a…"]);
        assert_eq!(short("abc"), "abc");
        assert_eq!(short(&"a".repeat(80)).chars().count(), LONGEST);
    }
}
