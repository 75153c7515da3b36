//! A scene of a page of braking runs: two runs beside each other with moving contact patches, and plots.

use super::film::Film;
use super::rounded;
use latsch::recording::Recording;
use latsch::report::{Html, PatchFrame, Plot, Section, escape};
use latsch::{Error, Result};
use serde_json::{Map, Value, json};
use std::fmt::Write;

/// The colours of the two systems: the first two of plots.
pub const COLORS: [&str; 2] = ["#0072b2", "#d55e00"];
const STYLE: &str = include_str!("stop.css");
const SCRIPT: &str = include_str!("stop.js");

/// Two runs on one road.
pub struct Scene {
    /// A word for addresses.
    pub id: String,
    /// A heading.
    pub title: String,
    /// What the road is like.
    pub text: String,
    /// What is shown first \[s\].
    pub first: f64,
    /// What the script needs for a side view, where there is one.
    pub side: Option<Value>,
    /// What is said of a run at each time.
    pub readouts: Vec<Readout>,
    /// The runs.
    pub runs: Vec<Stage>,
    /// What was recorded.
    pub plots: Vec<Plot>,
    /// What is to be known of the pictures.
    pub note: String,
}

/// A number that is told beside the picture.
pub struct Readout {
    /// What stands before it.
    pub label: &'static str,
    /// Key of its series.
    pub key: &'static str,
    /// Digits after the point.
    pub digits: u8,
    /// Its unit.
    pub unit: &'static str,
}

/// One run of a scene.
pub struct Stage {
    /// What brakes.
    pub name: String,
    /// What came of it, in a word.
    pub outcome: String,
    /// Courses by their keys.
    pub series: Map<String, Value>,
    /// The contact patches at every sample.
    pub frames: Vec<PatchFrame>,
    /// Start, step and stop of the samples \[s\].
    pub sampled: [f64; 3],
}

impl Stage {
    /// A run from its recording: courses by key, channel, unit and decimals.
    ///
    /// # Errors
    /// Channels that are not there, fewer than two samples.
    pub fn of(
        (name, outcome): (&str, &str),
        recording: &Recording,
        frames: Vec<PatchFrame>,
        courses: &[(&str, &str, &str, i32)],
    ) -> Result<Self> {
        let mut series = Map::new();
        for (key, name, unit, decimals) in courses {
            series.insert((*key).into(), rounded(&recording.channel_in(name, unit)?, *decimals));
        }
        let [first, second, .., last] = recording.time[..] else {
            return Err(Error::file(format!("{}: fewer than three samples", recording.source)));
        };
        let sampled = [first, second - first, last];
        Ok(Self { name: name.into(), outcome: outcome.into(), series, frames, sampled })
    }
}

impl Scene {
    /// The scene as a section of the page.
    pub fn section(self, film: &Film) -> Section {
        let mut html = format!("<div class=\"scene\" id=\"{}\">\n<div class=\"stages\">\n", escape(&self.id));
        let side = "<svg role=\"img\" aria-label=\"wheel on the road\" viewBox=\"0 0 560 360\"><g class=\"side\"></g></svg>\n";
        let (mut start, mut step, mut stop) = (0.0, 1.0, 0.0_f64);
        for (run, color) in self.runs.iter().zip(COLORS) {
            [start, step] = [run.sampled[0], run.sampled[1]];
            stop = stop.max(run.sampled[2]);
            let shown = ((self.first - start) / step).round() as usize;
            let frame = run.frames.get(shown).or(run.frames.last()).cloned().unwrap_or_default();
            let _ = write!(
                html,
                "<figure class=\"stage\"><figcaption><b><span class=\"dot\" style=\"background:{color}\"></span>{}</b>\
                 <span>{}</span></figcaption><output></output>\n{}{}</figure>\n",
                escape(&run.name),
                escape(&run.outcome),
                if self.side.is_some() { side } else { "" },
                film.drawing(&frame)
            );
        }
        html.push_str("</div>\n");
        let explanation = format!("{} {} Drag in a plot to move the time.", film.explanation(), self.note);
        html.push_str(Html::note(&explanation).as_str());
        html.push_str("<div class=\"grid\">\n");
        for plot in &self.plots {
            html.push_str(plot.html().as_str());
        }
        html.push_str("</div>\n");
        let readouts: Vec<Value> =
            self.readouts.iter().map(|r| json!([r.label, r.key, r.digits, r.unit])).collect();
        let runs: Vec<Value> = self
            .runs
            .into_iter()
            .map(|mut run| {
                run.series.insert("frames".into(), run.frames.iter().map(|f| film.encode(f)).collect());
                Value::Object(run.series)
            })
            .collect();
        html.push_str(&data(
            "data",
            &json!({
                "start": start,
                "step": step,
                "stop": stop,
                "first": self.first,
                "side": self.side,
                "readouts": readouts,
                "runs": runs,
            }),
        ));
        html.push_str("</div>\n");
        Section::new(&self.title).with(Html::text(&self.text)).with(Html::raw(html))
    }
}

/// What moves the pictures of all scenes of a page.
pub fn player(film: &Film) -> Html {
    Html::raw(format!(
        "<style>\n{STYLE}</style>\n<div class=\"player\" hidden><div><button type=\"button\">Play</button>\
         <select aria-label=\"scenario\"></select>\
         <input type=\"range\" aria-label=\"time\"><output></output>\
         <select class=\"pace\" aria-label=\"speed\"><option value=\"1\">1 ×</option><option value=\"0.25\">1/4 ×</option>\
         <option value=\"0.1\" selected>1/10 ×</option><option value=\"0.02\">1/50 ×</option></select></div></div>\n\
         <noscript><p class=\"note\">Without JavaScript the pictures stand still.</p></noscript>\n{}<script>\n{SCRIPT}</script>\n",
        data("film", &film.scales())
    ))
}

/// Data for the script, which finds it by its class.
fn data(class: &str, value: &Value) -> String {
    // no markup, whatever a text has in it
    format!(
        "<script type=\"application/json\" class=\"{class}\">{}</script>\n",
        value.to_string().replace('<', "\\u003c")
    )
}
