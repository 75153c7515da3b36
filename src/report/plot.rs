//! Line plots as inline SVG.

use super::scale::Scale;
use super::shade::shade;
use super::short::{shorten, thin_out};
use crate::page::{Html, escape};
use crate::stats::extent;
use plotters::prelude::*;

/// Okabe and Ito's colours, told apart with any colour vision; yellow, too pale on white, is left out.
const PALETTE: [RGBColor; 7] = [
    RGBColor(0, 114, 178),
    RGBColor(213, 94, 0),
    RGBColor(0, 158, 115),
    RGBColor(204, 121, 167),
    RGBColor(86, 180, 233),
    RGBColor(230, 159, 0),
    RGBColor(60, 60, 60),
];
const TEXT: RGBColor = RGBColor(70, 80, 88);
const GRID: RGBColor = RGBColor(228, 232, 235);
const AXES: RGBColor = RGBColor(150, 158, 164);

/// A long series is drawn with up to four points for each of so many columns.
const COLUMNS: usize = 800;
/// The palest shade of a line: it has to be seen on white.
const PALEST: f64 = 0.35;
/// What is beside dots on every side, as a share of what they span.
const DOTS: f64 = 0.04;

/// What an axis shows and in which unit.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Axis {
    /// The quantity.
    pub quantity: String,
    /// Its unit.
    pub unit: String,
}

impl Axis {
    /// An axis.
    pub fn new(quantity: &str, unit: &str) -> Self {
        Self { quantity: quantity.into(), unit: unit.into() }
    }

    /// The time in seconds.
    pub fn time() -> Self {
        Self::new("time", "s")
    }
}

/// How large a plot is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Size {
    /// As wide as the page.
    #[default]
    Full,
    /// As wide as the page and low, to be stacked with others over the same x.
    Strip,
    /// Half as wide as the page, see [`Section::side_by_side`](super::Section::side_by_side).
    Half,
}

impl Size {
    /// Width, height and height of letters in the units of the drawing.
    fn drawing(self) -> (u32, u32, u32) {
        match self {
            Size::Full => (2400, 880, 36),
            Size::Strip => (2400, 440, 36),
            Size::Half => (1600, 940, 48),
        }
    }
}

#[derive(Debug, Clone, PartialEq)]
struct Series {
    name: String,
    points: Vec<(f64, f64)>,
    color: RGBColor,
    look: Look,
}

/// How a series is drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Look {
    Line,
    /// Thin and dashed.
    Measured,
    /// A dot at each point.
    Dots,
    /// A ring at each point.
    Rings,
}

/// What a line in a comparison shows: the same colours on the whole page.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Tone {
    /// The given model.
    Before,
    /// The corrected one.
    After,
}

impl Tone {
    fn color(self) -> RGBColor {
        match self {
            Tone::Before => PALETTE[1],
            Tone::After => PALETTE[0],
        }
    }
}

/// A plot of lines over time or of one quantity over another.
#[derive(Debug, Clone, PartialEq)]
pub struct Plot {
    title: String,
    x: Axis,
    y: Axis,
    size: Size,
    series: Vec<Series>,
    /// Areas below all lines: outline and colour.
    bands: Vec<(Vec<(f64, f64)>, RGBColor)>,
    /// Columns for long series, and paths in short form.
    columns: Option<usize>,
    /// What the axis of y spans at least.
    least: f64,
    /// What 1, 2, ... on it are called, if they are names.
    names: Vec<String>,
}

impl Plot {
    /// An empty plot.
    pub fn new(title: &str, x: Axis, y: Axis) -> Self {
        Self {
            title: title.into(),
            x,
            y,
            size: Size::Full,
            series: Vec::new(),
            bands: Vec::new(),
            columns: None,
            least: 0.0,
            names: Vec::new(),
        }
    }

    /// The same with names for the values 1, 2, ... of y.
    #[must_use]
    pub fn named(mut self, names: &[String]) -> Self {
        self.names = names.to_vec();
        self
    }

    /// The same with an axis of y that spans this at least: what changes by much less looks level. The largest of several counts.
    #[must_use]
    pub fn at_least(mut self, span: f64) -> Self {
        self.least = self.least.max(span);
        self
    }

    /// The same in another size.
    #[must_use]
    pub fn size(mut self, size: Size) -> Self {
        self.size = size;
        self
    }

    /// The same with one more line through the points (x, y), in their order. It breaks where a
    /// coordinate is not finite.
    #[must_use]
    pub fn line(mut self, name: &str, x: &[f64], y: &[f64]) -> Self {
        self.push(name, x, y, self.next_color(), Look::Line);
        self
    }

    /// The same with a dot at each point (x, y).
    #[must_use]
    pub fn dots(mut self, name: &str, x: &[f64], y: &[f64]) -> Self {
        self.push(name, x, y, self.next_color(), Look::Dots);
        self
    }

    /// The same with a ring at each point (x, y), around what dots show.
    #[must_use]
    pub fn rings(mut self, name: &str, x: &[f64], y: &[f64]) -> Self {
        self.push(name, x, y, self.next_color(), Look::Rings);
        self
    }

    fn next_color(&self) -> RGBColor {
        PALETTE[self.series.iter().filter(|s| s.look != Look::Measured).count() % PALETTE.len()]
    }

    /// The same with a measured line, thin, dashed and in a greyed shade of the colour of the line
    /// added before it.
    #[must_use]
    pub fn measured(mut self, name: &str, x: &[f64], y: &[f64]) -> Self {
        let RGBColor(r, g, b) = self.series.last().map_or(PALETTE[6], |s| s.color);
        let mix = |c: u8| (0.35 * f64::from(c) + 0.65 * 120.0) as u8;
        self.push(name, x, y, RGBColor(mix(r), mix(g), mix(b)), Look::Measured);
        self
    }

    /// The same with one more line in the colour of its tone.
    #[must_use]
    pub fn toned(mut self, name: &str, tone: Tone, x: &[f64], y: &[f64]) -> Self {
        self.push(name, x, y, tone.color(), Look::Line);
        self
    }

    /// The same with a line that is darker the more there is of something, a share of the most.
    #[must_use]
    pub fn shaded(mut self, name: &str, share: f64, x: &[f64], y: &[f64]) -> Self {
        let [r, g, b] = shade(PALEST + (1.0 - PALEST) * share);
        self.push(name, x, y, RGBColor(r, g, b), Look::Line);
        self
    }

    /// The same with an area from `low` to `high` below all lines, in the colour of its tone. Places where
    /// a coordinate is not finite are left out.
    #[must_use]
    pub fn band(mut self, tone: Tone, x: &[f64], low: &[f64], high: &[f64]) -> Self {
        let there = |(x, y): (&f64, &f64)| (x.is_finite() && y.is_finite()).then_some((*x, *y));
        let mut outline: Vec<(f64, f64)> = x.iter().zip(low).filter_map(there).collect();
        outline.extend(x.iter().zip(high).rev().filter_map(there));
        self.bands.push((outline, tone.color()));
        self
    }

    /// The same in fewer bytes, for pages with many plots: long series are thinned out to the extremes of
    /// so many columns.
    #[must_use]
    pub fn columns(mut self, columns: usize) -> Self {
        self.columns = Some(columns.max(2));
        self
    }

    fn push(&mut self, name: &str, x: &[f64], y: &[f64], color: RGBColor, look: Look) {
        let points = x.iter().copied().zip(y.iter().copied()).collect();
        self.series.push(Series { name: name.into(), points, color, look });
    }

    /// True without lines.
    pub fn is_empty(&self) -> bool {
        self.series.is_empty()
    }

    /// The plot as a figure with its legend above.
    pub fn html(&self) -> Html {
        let mut html = String::from("<figure>\n<figcaption>");
        if !self.title.is_empty() {
            html.push_str(&format!("<b>{}</b>", escape(&self.title)));
        }
        for series in &self.series {
            let class = match series.look {
                Look::Line => "",
                Look::Measured => " class=\"measured\"",
                Look::Dots | Look::Rings => " class=\"dot\"",
            };
            html.push_str(&format!(
                "<span class=\"key\"><i{class} style=\"border-color:{}\"></i>{}</span>",
                hex(series.color),
                escape(&series.name)
            ));
        }
        html.push_str("</figcaption>\n");
        match self.svg() {
            Ok(svg) => html.push_str(&svg),
            Err(e) => html.push_str(Html::note(&format!("The plot could not be drawn: {e}")).as_str()),
        }
        html.push_str("</figure>\n");
        Html::raw(html)
    }

    /// Values, and two more beside them where dots at the ends would be cut off.
    fn with_margin(&self, values: impl Iterator<Item = f64> + Clone) -> impl Iterator<Item = f64> + Clone {
        let (low, high) = extent(values.clone());
        let is_dot = |series: &Series| matches!(series.look, Look::Dots | Look::Rings);
        let margin = if self.series.iter().any(is_dot) { DOTS * (high - low) } else { 0.0 };
        values.chain([low - margin, high + margin])
    }

    fn svg(&self) -> Result<String, Box<dyn std::error::Error>> {
        let (width, height, letters) = self.size.drawing();
        let points =
            || self.series.iter().map(|s| &s.points).chain(self.bands.iter().map(|b| &b.0)).flatten();
        let finite = || points().filter(|(x, y)| x.is_finite() && y.is_finite());
        if finite().next().is_none() {
            return Ok(Html::note("No data.").as_str().into());
        }
        // the labels of the other axis are to the left of it
        let room = f64::from(width) / f64::from(letters) - 7.0;
        let x = Scale::beside(self.with_margin(finite().map(|p| p.0)), room);
        let (low, high) = extent(finite().map(|p| p.1));
        let room = (0.5 * (self.least - (high - low))).max(0.0);
        let heights = self.with_margin(finite().map(|p| p.1)).chain([low - room, high + room]);
        let y = match &self.names[..] {
            [] => Scale::new(heights, (height as usize) / 120, true),
            names => Scale::of_names(names),
        };
        // a letter is a little more than half as wide as it is high
        let widest = self.names.iter().map(|name| name.chars().count()).max().unwrap_or(0);
        let room_for_labels = letters * 5.max(widest as u32 * 3 / 5 + 2);

        let mut svg = String::new();
        let mut data = String::new();
        let ends;
        {
            let root = SVGBackend::with_string(&mut svg, (width, height)).into_drawing_area();
            let font = ("sans-serif", letters).into_font().color(&TEXT);
            let mut chart = ChartBuilder::on(&root)
                .margin_top(letters)
                .margin_right(letters)
                .margin_left(letters / 3)
                // the title of the axis stands on the lowest line: what hangs below it, as brackets of units do, would be cut off
                .margin_bottom(letters / 4)
                .x_label_area_size(letters * 12 / 5)
                .y_label_area_size(room_for_labels)
                .build_cartesian_2d(x.clone(), y.clone())?;
            chart
                .configure_mesh()
                .bold_line_style(GRID.stroke_width(2))
                .light_line_style(TRANSPARENT)
                .axis_style(AXES.stroke_width(2))
                .set_all_tick_mark_size(letters / 4)
                .label_style(font.clone())
                .axis_desc_style(font)
                .x_desc(x.title(&self.x))
                .y_desc(y.title(&self.y))
                .y_labels(y.ticks.len().max(2))
                .draw()?;
            let place = |point: &(f64, f64)| chart.backend_coord(point);
            ends = [place(&(x.low, y.low)), place(&(x.high, y.high))];
            for (outline, color) in &self.bands {
                let points: Vec<_> = outline.iter().map(place).collect();
                let color = hex(*color);
                data +=
                    &format!("<polygon opacity=\"0.16\" fill=\"{color}\" points=\"{}\"/>\n", pairs(&points));
            }
            // measured lines come last: they are thin and would vanish below the others
            for look in [Look::Line, Look::Dots, Look::Rings, Look::Measured] {
                for (number, series) in self.series.iter().enumerate().filter(|(_, s)| s.look == look) {
                    // a script can find what belongs to an entry of the legend
                    data += &format!("<g data-key=\"{number}\">\n");
                    series.draw(
                        place,
                        letters / 3,
                        |run| thin_out(run, x.low, x.high, self.columns.unwrap_or(COLUMNS)),
                        &mut data,
                    );
                    data += "</g>\n";
                }
            }
            root.present()?;
        }
        // the page decides on the size
        let start = svg.find("viewBox").ok_or("the drawing has no viewBox")?;
        let drawing = svg[start..].trim_end().strip_suffix("</svg>").ok_or("the drawing does not end")?;
        let data = if self.columns.is_some() { shorten(&data) } else { data };
        let mut label = format!("{} over {}", self.y.quantity, self.x.quantity);
        if !self.title.is_empty() {
            label = format!("{}: {label}", self.title);
        }
        // where the axes are: a script can place a cursor, and draw a part of the figure
        let [from, to] = ends;
        let axes = format!(
            "data-x=\"{} {} {} {} {}\" data-y=\"{} {} {} {} {}\"",
            from.0, to.0, x.low, x.high, x.exponent, from.1, to.1, y.low, y.high, y.exponent
        );
        Ok(format!(
            "<svg role=\"img\" aria-label=\"{}\" {axes} {drawing}<g class=\"data\">\n{data}</g>\n</svg>\n",
            escape(&label)
        ))
    }
}

impl Series {
    /// Its lines, or its dots of this radius, at the places of its points.
    fn draw(
        &self,
        place: impl Fn(&(f64, f64)) -> (i32, i32),
        radius: u32,
        thinned: impl Fn(&[(f64, f64)]) -> Vec<(f64, f64)>,
        svg: &mut String,
    ) {
        let color = hex(self.color);
        let style = match self.look {
            Look::Line => format!("fill=\"none\" stroke=\"{color}\" stroke-width=\"4\""),
            Look::Measured => {
                format!("fill=\"none\" stroke=\"{color}\" stroke-width=\"3\" stroke-dasharray=\"12 7\"")
            }
            Look::Dots => format!("r=\"{radius}\" opacity=\"0.6\" fill=\"{color}\""),
            Look::Rings => {
                format!("r=\"{}\" fill=\"none\" stroke=\"{color}\" stroke-width=\"4\"", 2 * radius)
            }
        };
        let runs = self.points.split(|(x, y)| !x.is_finite() || !y.is_finite()).filter(|run| !run.is_empty());
        match self.look {
            Look::Line | Look::Measured => {
                for run in runs {
                    let points: Vec<_> = thinned(run).iter().map(&place).collect();
                    *svg += &format!("<polyline {style} points=\"{}\"/>\n", pairs(&points));
                }
            }
            Look::Dots | Look::Rings => {
                for (x, y) in runs.flatten().map(place) {
                    *svg += &format!("<circle cx=\"{x}\" cy=\"{y}\" {style}/>\n");
                }
            }
        }
    }
}

fn hex(RGBColor(r, g, b): RGBColor) -> String {
    format!("#{r:02X}{g:02X}{b:02X}")
}

fn pairs(points: &[(i32, i32)]) -> String {
    points.iter().map(|(x, y)| format!("{x},{y}")).collect::<Vec<_>>().join(" ")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn polylines(html: &str) -> Vec<Vec<(i32, i32)>> {
        html.split("<polyline")
            .skip(1)
            .filter(|p| p.contains("stroke-width=\"4\"") || p.contains("stroke-dasharray"))
            .map(|p| {
                let points = p.split("points=\"").nth(1).unwrap().split('"').next().unwrap();
                let pair = |p: &str| {
                    let (x, y) = p.split_once(',').unwrap();
                    (x.parse().unwrap(), y.parse().unwrap())
                };
                points.split_whitespace().map(pair).collect()
            })
            .collect()
    }

    #[test]
    fn axes_have_quantity_and_unit() {
        let plot = Plot::new("", Axis::time(), Axis::new("force", "kN")).line("a", &[0.0, 1.0], &[0.0, 2.0]);
        let html = plot.html();
        assert!(html.as_str().contains("time [s]") && html.as_str().contains("force [kN]"));
    }

    #[test]
    fn what_hardly_changes_looks_level() {
        let y = [60.1, 60.0, 60.1];
        let plot = Plot::new("", Axis::time(), Axis::new("speed", "km/h")).line("a", &[0.0, 1.0, 2.0], &y);
        let heights = |plot: &Plot| {
            let line = polylines(plot.html().as_str()).remove(0);
            f64::from(line[1].1 - line[0].1) / f64::from(Size::Full.drawing().1)
        };
        assert!(heights(&plot) > 0.5 && heights(&plot.clone().at_least(6.0)) < 0.05);
        // a larger change is not touched
        assert_eq!(plot.clone().at_least(0.05).html(), plot.html());
    }

    #[test]
    fn dots_at_the_ends_are_whole() {
        let plot = Plot::new("", Axis::time(), Axis::new("force", "N"));
        let html = plot.dots("a", &[0.0, 1.0], &[0.0, 10.0]).html();
        let ends = html.as_str().split("data-x=\"").nth(1).unwrap().split('"').next().unwrap();
        let ends: Vec<f64> = ends.split(' ').map(|n| n.parse().unwrap()).collect();
        // left and right of the area in the drawing, and what is there
        let place = |x: f64| ends[0] + (x - ends[2]) / (ends[3] - ends[2]) * (ends[1] - ends[0]);
        let circles: Vec<&str> = html.as_str().split("<circle").skip(1).collect();
        assert_eq!(circles.len(), 2);
        for (circle, x) in circles.iter().zip([0.0, 1.0]) {
            let read = |name: &str| -> f64 {
                circle
                    .split(&format!(" {name}=\""))
                    .nth(1)
                    .unwrap()
                    .split('"')
                    .next()
                    .unwrap()
                    .parse()
                    .unwrap()
            };
            assert!((read("cx") - place(x)).abs() <= 1.0);
            assert!(read("cx") - read("r") > ends[0] && read("cx") + read("r") < ends[1]);
        }
    }

    #[test]
    fn labels_have_room_beside_each_other() {
        // a position of hundredths of a millimetre about 0.3 m: labels of seven characters
        for (low, high) in [(0.3, 0.3003), (-1.0, 1.0), (-4e-8, 7e-8), (0.0, 12345.0)] {
            let scale = Scale::beside([low, high].into_iter(), 26.0);
            let characters: usize = scale.ticks.iter().map(|t| scale.label(*t).chars().count()).sum();
            assert!(scale.ticks.len() >= 2, "{:?}", scale.ticks);
            assert!(0.6 * characters as f64 <= 26.0, "{:?}", scale.ticks);
        }
        // where there is room nothing changes
        assert_eq!(Scale::beside([0.0, 10.0].into_iter(), 60.0).ticks.len(), 11);
    }

    #[test]
    fn text_in_plots_stays_text() {
        let bad = "<script>\"&";
        let plot = Plot::new(bad, Axis::new(bad, bad), Axis::new(bad, bad));
        let plot = plot.line(bad, &[0.0, 1.0], &[0.0, 2.0]).measured(bad, &[0.0, 1.0], &[0.0, 2.0]);
        let html = plot.html();
        assert!(!html.as_str().contains("<script"), "{}", html.as_str());
        // title; legend twice; two axes with two texts each; three texts of the description
        assert_eq!(html.as_str().matches("&lt;script&gt;").count(), 1 + 2 + 4 + 3);
    }

    #[test]
    fn lines_break_where_there_is_no_number() {
        let y = [1.0, 2.0, f64::NAN, 3.0, 1.0, f64::INFINITY, 5.0, 4.0];
        let x: Vec<f64> = (0..8).map(f64::from).collect();
        let html = Plot::new("", Axis::time(), Axis::new("y", "1")).line("a", &x, &y).html();
        let lines = polylines(html.as_str());
        assert_eq!(lines.iter().map(Vec::len).collect::<Vec<_>>(), [2, 2, 2]);
        assert!(lines[0][1].0 < lines[1][0].0 && lines[1][1].0 < lines[2][0].0);
    }

    #[test]
    fn measured_lines_are_dashed() {
        let plot = Plot::new("", Axis::time(), Axis::new("y", "1"));
        let plot = plot.line("a", &[0.0, 1.0], &[0.0, 1.0]).measured("b", &[0.0, 1.0], &[0.5, 0.6]);
        assert_eq!(plot.html().as_str().matches("stroke-dasharray").count(), 1);
    }

    #[test]
    fn the_highest_point_is_that_of_the_whole_line_where_columns_are_chosen() {
        let x: Vec<f64> = (0..20_000).map(f64::from).collect();
        let mut y: Vec<f64> = x.iter().map(|x| (7.0 * x).sin()).collect();
        y[12_345] = 9.0;
        let plot = Plot::new("", Axis::time(), Axis::new("y", "1")).line("a", &x, &y);
        let (long, short) = (plot.html(), plot.columns(COLUMNS).html());
        assert!(short.as_str().len() * 5 < long.as_str().len() * 4);
        // the highest point of the line, in the units of the drawing
        let top = polylines(long.as_str()).into_iter().flatten().map(|p| p.1).min().unwrap();
        let d = short.as_str().rsplit(" d=\"M").next().unwrap().split('"').next().unwrap();
        let numbers: Vec<i32> =
            d.replace('l', " ").replace('-', " -").split_whitespace().map(|n| n.parse().unwrap()).collect();
        let heights = numbers.chunks(2).scan(0, |y, step| {
            *y += step[1];
            Some(*y)
        });
        assert_eq!(heights.min(), Some(top));
    }

    #[test]
    fn a_band_widens_the_axis_and_has_no_key() {
        let plot = Plot::new("", Axis::time(), Axis::new("y", "1"));
        let plot = plot.band(Tone::Before, &[0.0, 1.0, 2.0], &[-9.0, f64::NAN, -9.0], &[8.0; 3]);
        let html = plot.toned("mean", Tone::Before, &[0.0, 2.0], &[0.0, 1.0]).html();
        assert_eq!(html.as_str().matches("<polygon").count(), 1);
        assert_eq!(html.as_str().matches("class=\"key\"").count(), 1);
        assert!(html.as_str().contains("−10"), "{}", html.as_str());
    }

    #[test]
    fn without_numbers_there_is_a_note() {
        let plot = Plot::new("", Axis::time(), Axis::new("y", "1")).line("a", &[0.0], &[f64::NAN]);
        assert!(plot.html().as_str().contains("No data"));
    }
}
