//! What the program says beside its results, on the standard error: notes, warnings, errors and bars of progress.

use clap::builder::styling::{AnsiColor, Style};
use clap::{ColorChoice, ValueEnum};
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use latsch::{Error, one_line};
use serde::Serialize;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::time::Duration;

/// Set once, before anything is said.
static QUIET: AtomicBool = AtomicBool::new(false);
/// The same, of progress that is said to a program.
static JSON: AtomicBool = AtomicBool::new(false);

/// Steps of a bar that shows a share.
const SHARES: u64 = 1000;

/// Says nothing but errors from now on, if asked to, in colors or not, and how far it is to people or programs.
pub fn set(quiet: bool, color: ColorChoice, progress: Progress) {
    QUIET.store(quiet, Ordering::Relaxed);
    JSON.store(progress == Progress::Json, Ordering::Relaxed);
    let choice = match color {
        ColorChoice::Auto => anstream::ColorChoice::Auto,
        ColorChoice::Always => anstream::ColorChoice::Always,
        ColorChoice::Never => anstream::ColorChoice::Never,
    };
    choice.write_global();
}

fn is_quiet() -> bool {
    QUIET.load(Ordering::Relaxed)
}

fn is_json() -> bool {
    JSON.load(Ordering::Relaxed)
}

/// Prints a line behind a colored word. Where the standard error is no terminal, or NO_COLOR says so, colors are left out.
fn say(word: &str, color: AnsiColor, text: &str) {
    let style = Style::new().bold().fg_color(Some(color.into()));
    anstream::eprintln!("{style}{word}:{style:#} {text}");
}

/// Prints what is good to know.
pub fn note(text: &str) {
    if !is_quiet() {
        say("note", AnsiColor::Cyan, &one_line(text));
    }
}

/// Prints a warning.
pub fn warn(text: &str) {
    if !is_quiet() {
        say("warning", AnsiColor::Yellow, &one_line(text));
    }
}

/// Prints why the program ends.
pub fn error(error: &Error) {
    say("error", AnsiColor::Red, &error.to_string());
}

/// How far a command is.
#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Progress {
    /// Bars on a terminal, and nothing elsewhere
    Auto,
    /// Lines of JSON on the standard error, for programs that run this one: {"progress": 0.42, "what": "..."}
    Json,
}

/// How far something is: a bar on a terminal, or lines for a program. What is drawn goes away with it.
pub struct Bar {
    drawn: ProgressBar,
    /// The percent that was said last.
    said: AtomicU64,
}

/// A line for programs.
#[derive(Serialize)]
struct Line<'a> {
    /// A share; nothing where that is not known.
    progress: Option<f64>,
    what: &'a str,
}

impl Bar {
    /// Over so many steps, behind a title.
    pub fn of_steps(steps: u64, title: &str) -> Self {
        Self::styled(ProgressBar::new(steps), "{msg} {wide_bar} {percent} %  {eta} left", title)
    }

    /// Of what ends at nobody knows when: a share, and what is being done.
    pub fn of_share() -> Self {
        Self::styled(ProgressBar::new(SHARES), "{bar:40} {percent} % {msg}", "")
    }

    /// Of what is as far as nobody knows: what is being done.
    pub fn spinner() -> Self {
        let own = Self::styled(ProgressBar::no_length(), "{spinner} {msg}", "");
        own.drawn.enable_steady_tick(Duration::from_millis(200));
        own
    }

    fn styled(drawn: ProgressBar, template: &str, title: &str) -> Self {
        if let Ok(style) = ProgressStyle::with_template(template) {
            drawn.set_style(style);
        }
        if is_quiet() || is_json() {
            drawn.set_draw_target(ProgressDrawTarget::hidden());
        }
        Self { drawn: drawn.with_message(title.to_owned()), said: AtomicU64::new(0) }
    }

    /// So many steps are done.
    pub fn set(&self, steps: u64) {
        self.drawn.set_position(steps);
        self.say_if_further();
    }

    /// One more is.
    pub fn step(&self) {
        self.drawn.inc(1);
        self.say_if_further();
    }

    /// Such a share is done.
    pub fn set_share(&self, share: f64) {
        self.set((SHARES as f64 * share) as u64);
    }

    /// What is being done.
    pub fn set_what(&self, what: &str) {
        if self.drawn.message() != what {
            self.drawn.set_message(what.to_owned());
            self.say();
        }
    }

    /// Says something that is to stay above it.
    pub fn above(&self, say: impl FnOnce()) {
        self.drawn.suspend(say);
    }

    fn share(&self) -> Option<f64> {
        self.drawn.length().map(|length| self.drawn.position().min(length) as f64 / length.max(1) as f64)
    }

    fn say_if_further(&self) {
        if !is_json() {
            return;
        }
        let percent = self.share().map_or(0, |share| (100.0 * share) as u64);
        if self.said.fetch_max(percent, Ordering::Relaxed) < percent {
            self.say();
        }
    }

    fn say(&self) {
        if !is_json() || is_quiet() {
            return;
        }
        let line = Line { progress: self.share(), what: &self.drawn.message() };
        if let Ok(line) = serde_json::to_string(&line) {
            anstream::eprintln!("{line}");
        }
    }
}

impl Drop for Bar {
    fn drop(&mut self) {
        self.drawn.finish_and_clear();
    }
}
