//! Pictures of the contact patch: pressure, sliding and shear of every bristle.

use super::shade::shade;
use crate::page::{Html, escape, number};
use crate::tire::{Cell, Tire};
use std::fmt::Write;

/// More cells than this on one page make it slow and large: then frames are left out.
const MAX_CELLS: usize = 9000;
/// Width of the picture in its own units where it is as wide as the page, letters at [`LETTERS`].
const WIDTH: f64 = 1000.0;
const LETTERS: f64 = 13.0;
/// Room for the axes around the patch.
const LEFT: f64 = 62.0;
const RIGHT: f64 = 130.0;
const TOP: f64 = 18.0;
const BOTTOM: f64 = 66.0;
/// Neither a very long nor a very wide patch makes the picture higher than this.
const MAX_HEIGHT: f64 = 560.0;
/// The colour of the outline of what slides.
pub const SLIDING: &str = "#d55e00";
/// The colour of negative pressure.
pub const PULLING: &str = "#d9d4c7";

/// The patch at one instant, in SI units and in the axes of the contact frame: x along the patch in
/// the wheel's heading, y to the left.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct PatchFrame {
    /// When \[s\].
    pub time: f64,
    /// What is said about it, see [`patch_caption`].
    pub title: String,
    /// The bristles in contact.
    pub cells: Vec<Cell>,
}

impl PatchFrame {
    /// The patch of a tire as it is now: what carries something, at its places in the undeformed patch. Empty for a
    /// tire without a patch.
    pub fn of(tire: &impl Tire, time: f64, title: &str) -> Self {
        Self { time, title: title.into(), cells: tire.cells() }
    }

    /// Bristles that slide.
    pub(super) fn sliding(&self) -> usize {
        self.cells.iter().filter(|c| c.sliding).count()
    }

    /// How much there is to see: most where as many bristles stick as slide.
    pub(super) fn interest(&self) -> (usize, usize) {
        (self.sliding().min(self.cells.len() - self.sliding()), self.cells.len())
    }
}

/// A title for a [`PatchFrame`]: vertical force \[N\], longitudinal slip \[1\], slip angle \[rad\].
pub fn patch_caption(force_z: f64, slip: f64, slip_angle: f64) -> String {
    // shown to a fixed number of digits, so that the line does not jump from frame to frame
    let text =
        format!("Fz {force_z:.0} N, slip {:.1} %, slip angle {:.1}°", slip * 100.0, slip_angle.to_degrees());
    text.replace("-0.0", "0.0").replace('-', "−")
}

/// The frames as one figure, all to the same scale. One is visible, the one with the most to see;
/// a slider (a few lines of JavaScript in the page) shows the others. Without JavaScript, and in
/// print, that one stays.
pub fn patch_frames(frames: &[PatchFrame]) -> Html {
    let cells: usize = frames.iter().map(|f| f.cells.len()).sum();
    if cells == 0 {
        return Html::note("No bristle was in contact with the road.");
    }
    let every = cells.div_ceil(MAX_CELLS);
    let shown: Vec<&PatchFrame> = frames.iter().step_by(every).collect();
    let best = (0..shown.len()).rev().max_by_key(|i| shown[*i].interest()).unwrap_or(0);
    let picture = Picture::new(&shown, WIDTH, Vec::new());

    let mut html = String::from("<figure class=\"patch\">\n");
    for (i, frame) in shown.iter().enumerate() {
        let hidden = if i == best { "" } else { " hidden" };
        let _ = write!(html, "<div class=\"frame\"{hidden}>\n{}</div>\n", picture.frame(frame));
    }
    if shown.len() > 1 {
        let _ = write!(
            html,
            "<input type=\"range\" min=\"0\" max=\"{}\" value=\"{best}\" step=\"1\" aria-label=\"frame\" hidden>\n{SCRIPT}",
            shown.len() - 1
        );
    }
    html.push_str("</figure>\n");
    html.push_str(Html::note(&picture.explanation()).as_str());
    if every > 1 {
        let text = format!("{} of {} frames are shown, to keep the page small.", shown.len(), frames.len());
        html.push_str(Html::note(&text).as_str());
    }
    Html::raw(html)
}

/// Shows the slider, which does nothing without it, and switches frames.
const SCRIPT: &str = "<script>
{
  const figure = document.currentScript.parentElement;
  const frames = figure.querySelectorAll('.frame');
  const slider = figure.querySelector('input');
  slider.hidden = false;
  slider.oninput = () => frames.forEach((frame, i) => { frame.hidden = i != slider.value; });
  slider.oninput();
}
</script>
";

/// What all frames share: the place and scale of the patch, of colours and of arrows.
pub struct Picture {
    /// Width of the drawing in its own units.
    width: f64,
    /// Largest |x| and |y| of a cell's edge \[m\].
    pub half: [f64; 2],
    /// Units of the drawing per metre.
    pub scale: f64,
    /// Largest pressure \[Pa\].
    pub pressure: f64,
    /// Some pressure is negative.
    pulling: bool,
    /// Largest deflection \[m\].
    pub deflection: f64,
    /// Length of its arrow in units of the drawing.
    pub arrow: f64,
    /// Where several patches are drawn at once: what each is called and its place in the frame \[m\]. They have a scale instead of axes.
    pub patches: Vec<(String, [f64; 2])>,
}

impl Picture {
    /// The scales for these frames in a drawing of this width; `patches` are the names of several in each frame with their places, see [`Self::patches`].
    pub fn new(frames: &[&PatchFrame], width: f64, patches: Vec<(String, [f64; 2])>) -> Self {
        let cells = || frames.iter().flat_map(|f| &f.cells);
        let largest = |f: fn(&Cell) -> f64| cells().map(f).filter(|v| v.is_finite()).fold(0.0, f64::max);
        let mut half = [largest(|c| c.x.abs() + 0.5 * c.length), largest(|c| c.y.abs() + 0.5 * c.width)];
        for (_, at) in &patches {
            half = [half[0].max(at[0].abs()), half[1].max(at[1].abs())];
        }
        let half = half.map(|half| if half > 0.0 { half * 1.04 } else { 0.1 });
        let scale = (0.5 * (width - LEFT - RIGHT) / half[0]).min(0.5 * (MAX_HEIGHT - TOP - BOTTOM) / half[1]);
        let cell = largest(|c| c.length.max(c.width));
        Self {
            width,
            half,
            scale,
            pressure: largest(|c| c.pressure),
            pulling: cells().any(|c| c.pressure < 0.0),
            deflection: largest(|c| c.deflection[0].hypot(c.deflection[1])),
            arrow: 0.8 * cell * scale,
            patches,
        }
    }

    /// What the marks mean.
    pub fn explanation(&self) -> String {
        let mut text = format!(
            "Seen from above, bristles at their places in the undeformed patch. Outlined and crossed: sliding. Arrows: shear deflection, \
             in the direction of the road's force on the tire; the longest is {} mm.",
            number(self.deflection * 1e3)
        );
        if self.pulling {
            text.push_str(" Grey: negative pressure.");
        }
        text
    }

    /// Left, right, top and bottom of the frame around the patch.
    fn edges(&self) -> [f64; 4] {
        let (x, y) = (self.half[0] * self.scale, self.half[1] * self.scale);
        let centre = 0.5 * (self.width + LEFT - RIGHT);
        [centre - x, centre + x, TOP, TOP + 2.0 * y]
    }

    /// Where a point of the patch lies in the drawing.
    pub fn place(&self, x: f64, y: f64) -> (f64, f64) {
        let [left, right, top, bottom] = self.edges();
        (0.5 * (left + right) + x * self.scale, 0.5 * (top + bottom) - y * self.scale)
    }

    fn frame(&self, frame: &PatchFrame) -> String {
        let sliding = match frame.cells.len() {
            0 => "no contact".into(),
            n => format!("{} of {n} bristles slide", frame.sliding()),
        };
        let time = format!("t = {:.3} s", frame.time).replace('-', "−");
        format!(
            "<figcaption><b>{time}</b><span class=\"key\">{}</span><span class=\"key\">{sliding}</span></figcaption>\n{}",
            escape(&frame.title),
            self.drawing(frame)
        )
    }

    /// The patch with axes and legend; what changes from frame to frame is the group `cells`.
    pub fn drawing(&self, frame: &PatchFrame) -> String {
        let mut svg = format!(
            "<svg role=\"img\" aria-label=\"contact patch\" viewBox=\"0 0 {:.0} {:.0}\" xmlns=\"http://www.w3.org/2000/svg\" \
             font-family=\"sans-serif\" font-size=\"{LETTERS}\" fill=\"#46525c\">\n",
            self.width,
            self.edges()[3] + BOTTOM,
        );
        if self.patches.is_empty() {
            self.axes(&mut svg);
        } else {
            self.names(&mut svg);
        }
        self.legend(&mut svg);
        svg.push_str("<g class=\"cells\">\n");
        let (mut slides, mut arrows) = (String::new(), String::new());
        for cell in &frame.cells {
            let (w, h) = (cell.length * self.scale, cell.width * self.scale);
            let (x, y) = self.place(cell.x - 0.5 * cell.length, cell.y + 0.5 * cell.width);
            let color = if cell.pressure < 0.0 {
                PULLING.into()
            } else {
                pressure_color(cell.pressure / self.pressure)
            };
            let _ = writeln!(svg, "<path d=\"M{x:.1} {y:.1}h{w:.1}v{h:.1}h-{w:.1}z\" fill=\"{color}\"/>");
            if cell.sliding {
                slides.push_str(&slide(x, y, w, h));
            }
            arrows.push_str(&self.arrow(cell));
        }
        let _ = write!(
            svg,
            "<g fill=\"none\" stroke=\"{SLIDING}\" stroke-width=\"1.6\">\n{slides}</g>\n\
             <path d=\"{arrows}\" fill=\"#111\" stroke=\"#fff\" stroke-width=\"1.6\" paint-order=\"stroke\"/>\n</g>\n</svg>\n"
        );
        svg
    }

    fn arrow(&self, cell: &Cell) -> String {
        let [dx, dy] = cell.deflection;
        let length = dx.hypot(dy) / self.deflection * self.arrow;
        // NaN and arrows that would be dots are left out
        if length.is_nan() || length <= 1.5 {
            return String::new();
        }
        // in the drawing y points down
        let (ux, uy) = (dx / dx.hypot(dy), -dy / dx.hypot(dy));
        let (x, y) = self.place(cell.x, cell.y);
        let head = (0.45 * length).min(7.0);
        // the outline, from the tail's one corner around the tip to its other: along, across
        let outline = [
            (-0.5 * length, 0.6),
            (0.5 * length - head, 0.6),
            (0.5 * length - head, 0.42 * head),
            (0.5 * length, 0.0),
            (0.5 * length - head, -0.42 * head),
            (0.5 * length - head, -0.6),
            (-0.5 * length, -0.6),
        ];
        let mut path = String::new();
        for (i, (along, across)) in outline.into_iter().enumerate() {
            let command = if i == 0 { 'M' } else { 'L' };
            let (px, py) = (x + along * ux - across * uy, y + along * uy + across * ux);
            let _ = write!(path, "{command}{px:.1} {py:.1}");
        }
        path.push('z');
        path
    }

    fn ground(&self, svg: &mut String) {
        let [left, right, top, bottom] = self.edges();
        let _ = writeln!(
            svg,
            "<rect x=\"{left:.1}\" y=\"{top:.1}\" width=\"{:.1}\" height=\"{:.1}\" fill=\"#f7f8f9\" stroke=\"#969ea4\"/>",
            right - left,
            bottom - top
        );
    }

    fn heading(&self, svg: &mut String, whose: &str) {
        let [_, right, _, bottom] = self.edges();
        let _ = writeln!(
            svg,
            "<path d=\"M{:.1} {:.1}h46m-8 -5l8 5l-8 5\" fill=\"none\" stroke=\"#46525c\" stroke-width=\"1.6\"/>\n\
             <text x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"end\">{whose} heading</text>",
            right - 46.0,
            bottom + 52.0,
            right - 54.0,
            bottom + 56.5,
        );
    }

    /// Names of several patches, and a scale.
    fn names(&self, svg: &mut String) {
        self.ground(svg);
        for (name, [x, y]) in &self.patches {
            let (x, y) = self.place(*x, *y);
            let _ = writeln!(
                svg,
                "<text x=\"{x:.1}\" y=\"{y:.1}\" text-anchor=\"middle\">{}</text>",
                escape(name)
            );
        }
        let [left, _, _, bottom] = self.edges();
        let scale = 0.1 * self.scale;
        let _ = writeln!(
            svg,
            "<path d=\"M{left:.1} {:.1}v8m0 -4h{scale:.1}m0 -4v8\" fill=\"none\" stroke=\"#46525c\" stroke-width=\"1.6\"/>\n\
             <text x=\"{:.1}\" y=\"{:.1}\">100 mm</text>",
            bottom + 14.0,
            left + scale + 8.0,
            bottom + 22.5,
        );
        self.heading(svg, "car's");
    }

    fn axes(&self, svg: &mut String) {
        let [left, _, _, bottom] = self.edges();
        self.ground(svg);
        for (axis, half) in self.half.into_iter().enumerate() {
            let step = tick_step(half, if axis == 0 { 8.0 * self.width / WIDTH } else { 5.0 });
            let last = (half / step).floor() as i32;
            for i in -last..=last {
                let at = f64::from(i) * step;
                let label = number((at * 1e6).round() / 1e3);
                let (x, y) = self.place(at, at);
                let _ = if axis == 0 {
                    writeln!(
                        svg,
                        "<path d=\"M{x:.1} {bottom:.1}v5\" stroke=\"#969ea4\"/><text x=\"{x:.1}\" y=\"{:.1}\" text-anchor=\"middle\">{label}</text>",
                        bottom + 19.0
                    )
                } else {
                    writeln!(
                        svg,
                        "<path d=\"M{left:.1} {y:.1}h-5\" stroke=\"#969ea4\"/><text x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"end\">{label}</text>",
                        left - 9.0,
                        y + 4.5
                    )
                };
            }
        }
        let (x, y) = self.place(0.0, 0.0);
        let up = left - 46.0;
        let _ = writeln!(
            svg,
            "<text x=\"{x:.1}\" y=\"{:.1}\" text-anchor=\"middle\">x, along the patch [mm]</text>\n\
             <text transform=\"translate({up:.1} {y:.1}) rotate(-90)\" text-anchor=\"middle\">y, to the left [mm]</text>",
            bottom + 40.0,
        );
        self.heading(svg, "wheel's");
    }

    fn legend(&self, svg: &mut String) {
        const STEPS: u32 = 32;
        let [_, right, top, bottom] = self.edges();
        let x = right + 26.0;
        let top = top + 22.0;
        let low = bottom - if self.pulling { 62.0 } else { 34.0 };
        let height = (low - top) / f64::from(STEPS);
        let _ = writeln!(svg, "<text x=\"{x:.1}\" y=\"{:.1}\">pressure [bar]</text>", top - 10.0);
        for i in 0..STEPS {
            let y = low - f64::from(i + 1) * height;
            let color = pressure_color((f64::from(i) + 0.5) / f64::from(STEPS));
            // a little higher than needed: no seams
            let _ = write!(
                svg,
                "<rect x=\"{x:.1}\" y=\"{y:.2}\" width=\"18\" height=\"{:.2}\" fill=\"{color}\"/>",
                height + 0.4
            );
        }
        svg.push('\n');
        let bar = self.pressure / 1e5;
        let step = tick_step(bar, 4.0);
        let last = if bar > 0.0 { (bar / step + 1e-9).floor() as i32 } else { 0 };
        for i in 0..=last {
            let at = f64::from(i) * step;
            let y = if bar > 0.0 { low - (low - top) * at / bar } else { low };
            let _ = writeln!(
                svg,
                "<path d=\"M{:.1} {y:.1}h5\" stroke=\"#969ea4\"/><text x=\"{:.1}\" y=\"{:.1}\">{}</text>",
                x + 18.0,
                x + 27.0,
                y + 4.5,
                number((at * 1e6).round() / 1e6)
            );
        }
        let mut y = bottom - 16.0;
        let _ = writeln!(
            svg,
            "<g fill=\"none\" stroke=\"{SLIDING}\" stroke-width=\"1.6\"><path d=\"{}\"/></g><text x=\"{:.1}\" y=\"{:.1}\">sliding</text>",
            slide_path(x, y, 18.0, 16.0),
            x + 27.0,
            y + 12.5
        );
        if self.pulling {
            y -= 27.0;
            let _ = writeln!(
                svg,
                "<rect x=\"{x:.1}\" y=\"{y:.1}\" width=\"18\" height=\"16\" fill=\"{PULLING}\"/><text x=\"{:.1}\" y=\"{:.1}\">negative</text>",
                x + 27.0,
                y + 12.5
            );
        }
    }
}

/// The mark of a sliding bristle.
fn slide(x: f64, y: f64, w: f64, h: f64) -> String {
    format!("<path class=\"slides\" d=\"{}\"/>\n", slide_path(x, y, w, h))
}

/// An outline just inside the cell and a diagonal.
fn slide_path(x: f64, y: f64, w: f64, h: f64) -> String {
    let inset = 1.6_f64.min(0.2 * w).min(0.2 * h);
    let (x, y, w, h) = (x + inset, y + inset, w - 2.0 * inset, h - 2.0 * inset);
    format!("M{x:.1} {y:.1}h{w:.1}v{h:.1}h-{w:.1}zm0 {h:.1}l{w:.1} -{h:.1}")
}

/// A round step that divides `span` into at most `count` parts.
fn tick_step(span: f64, count: f64) -> f64 {
    if span.is_nan() || span <= 0.0 {
        return 1.0;
    }
    let raw = span / count;
    let power = 10_f64.powf(raw.log10().floor());
    [1.0, 2.0, 5.0].into_iter().map(|m| m * power).find(|s| *s >= 0.999 * raw).unwrap_or(10.0 * power)
}

/// Colour for a share of the largest pressure, from nearly white to blue.
pub fn pressure_color(share: f64) -> String {
    let [r, g, b] = shade(share);
    format!("#{r:02x}{g:02x}{b:02x}")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::{Native, Settings, Slave};
    use crate::rig::RingBrushFlatTrack;

    fn cell(x: f64, sliding: bool) -> Cell {
        Cell { x, y: 0.0, length: 0.01, width: 0.03, pressure: 2e5, sliding, deflection: [1e-3, -2e-3] }
    }

    fn frame(time: f64, cells: Vec<Cell>) -> PatchFrame {
        PatchFrame { time, title: String::new(), cells }
    }

    #[test]
    fn as_many_marks_as_sliding_bristles() {
        let one = frame(0.0, vec![cell(-0.01, true), cell(0.0, false), cell(0.01, true)]);
        let other = frame(1.0, vec![cell(0.0, true)]);
        assert_eq!(patch_frames(std::slice::from_ref(&one)).as_str().matches("class=\"slides\"").count(), 2);
        let html = patch_frames(&[one, other]);
        assert_eq!(html.as_str().matches("class=\"slides\"").count(), 3);
    }

    #[test]
    fn the_frame_with_most_to_see_is_visible_without_javascript() {
        let all = frame(0.0, vec![cell(0.0, true), cell(0.01, true), cell(0.02, true)]);
        let some = frame(0.5, vec![cell(0.0, true), cell(0.01, false)]);
        let html = patch_frames(&[all.clone(), some, all]);
        let visible = html.as_str().split("<div class=\"frame\">").nth(1).unwrap();
        assert!(visible.trim_start().starts_with("<figcaption><b>t = 0.500 s"), "{visible}");
        assert_eq!(html.as_str().matches("<div class=\"frame\" hidden>").count(), 2);
        assert!(html.as_str().contains("value=\"1\""));
    }

    #[test]
    fn titles_stay_text_and_units_are_there() {
        let mut one = frame(0.0, vec![cell(0.0, true)]);
        one.title = "<script>\"".into();
        let html = patch_frames(&[one]);
        assert!(!html.as_str().contains("<script>"), "a single frame needs no slider");
        for text in ["&lt;script&gt;&quot;", "[mm]", "[bar]", "2.236 mm"] {
            assert!(html.as_str().contains(text), "{text}");
        }
    }

    #[test]
    fn odd_frames_are_drawn() {
        assert!(patch_frames(&[]).as_str().contains("No bristle"));
        assert!(patch_frames(&[frame(0.0, Vec::new())]).as_str().contains("No bristle"));
        let mut odd = cell(0.0, false);
        odd.pressure = -1e4;
        odd.deflection = [f64::NAN, 0.0];
        let html = patch_frames(&[frame(0.0, vec![odd]), frame(1.0, Vec::new())]);
        assert!(!html.as_str().contains("NaN") && !html.as_str().contains("inf"), "{}", html.as_str());
        assert!(html.as_str().contains("negative") && html.as_str().contains("no contact"));
    }

    #[test]
    fn many_cells_are_thinned_to_fewer_frames() {
        let big = frame(0.0, vec![cell(0.0, false); 1000]);
        let html = patch_frames(&vec![big; 60]);
        assert!(html.as_str().contains("9 of 60 frames"), "{}", html.as_str().len());
    }

    #[test]
    fn colours_darken_evenly() {
        let bytes = |share| u32::from_str_radix(&pressure_color(share)[1..], 16).unwrap();
        let luma = |rgb: u32| {
            0.2126 * f64::from(rgb >> 16) + 0.7152 * f64::from(rgb >> 8 & 255) + 0.0722 * f64::from(rgb & 255)
        };
        for i in 0..20 {
            let (a, b) = (luma(bytes(f64::from(i) / 20.0)), luma(bytes(f64::from(i + 1) / 20.0)));
            assert!((4.0..14.0).contains(&(a - b)), "{i}: {a} to {b}");
        }
        assert_eq!(pressure_color(f64::NAN), pressure_color(0.0));
    }

    #[test]
    fn captions_have_no_negative_zero() {
        assert_eq!(patch_caption(4000.2, -1e-9, -0.035), "Fz 4000 N, slip 0.0 %, slip angle −2.0°");
        assert_eq!(patch_caption(4000.2, -0.201, 0.0), "Fz 4000 N, slip −20.1 %, slip angle 0.0°");
    }

    #[test]
    fn a_frame_of_the_model_has_its_contact_and_its_sliding() {
        let settings = Settings::default();
        let mut slave = Native::<RingBrushFlatTrack>::new(&settings).unwrap();
        // each bristle counts as a whole: the sums over cells are those of the model
        for (name, value) in [("slip_angle", 0.05), ("whole_step_entry", 1.0)] {
            let variable = slave.find(name).unwrap();
            slave.set(variable, value).unwrap();
        }
        slave.start(0.0, None).unwrap();
        slave.finish_start().unwrap();
        for i in 0..50 {
            slave.step(f64::from(i) * 1e-3, 1e-3).unwrap();
        }
        let share = slave.find("sliding_share").unwrap();
        let share = slave.get(share).unwrap();
        let frame = PatchFrame::of(slave.model().tire(), slave.time(), "");
        let count = frame.cells.len() as f64;
        assert!(count > 20.0 && share > 0.0 && share < 1.0, "{count} {share}");
        assert_eq!(frame.sliding() as f64 / count, share);
        let force: f64 = frame.cells.iter().map(|c| c.pressure * c.length * c.width).sum();
        let force_z = slave.find("patch_force_z").unwrap();
        assert!((force / slave.get(force_z).unwrap() - 1.0).abs() < 1e-9);
    }
}
