//! What the program says beside its results, on the standard error: notes, warnings, errors and bars of progress.

use clap::ColorChoice;
use clap::builder::styling::{AnsiColor, Style};
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use latsch::{Error, one_line};
use std::sync::atomic::{AtomicBool, Ordering};

/// Set once, before anything is said.
static QUIET: AtomicBool = AtomicBool::new(false);

/// Says nothing but errors from now on, if asked to, and in colors or not.
pub fn set(quiet: bool, color: ColorChoice) {
    QUIET.store(quiet, Ordering::Relaxed);
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

/// A bar over so many steps behind a title. It is drawn on a terminal and nowhere else.
pub fn bar(steps: u64, title: &str) -> ProgressBar {
    styled(ProgressBar::new(steps), "{msg} {wide_bar} {percent} %  {eta} left").with_message(title.to_owned())
}

/// A bar of what ends at nobody knows when: a share, and what is being done.
pub fn share_bar() -> ProgressBar {
    styled(ProgressBar::new(1000), "{bar:40} {percent} % {msg}")
}

/// Something that turns.
pub fn spinner() -> ProgressBar {
    hidden_if_quiet(ProgressBar::new_spinner())
}

fn styled(bar: ProgressBar, template: &str) -> ProgressBar {
    if let Ok(style) = ProgressStyle::with_template(template) {
        bar.set_style(style);
    }
    hidden_if_quiet(bar)
}

fn hidden_if_quiet(bar: ProgressBar) -> ProgressBar {
    if is_quiet() {
        bar.set_draw_target(ProgressDrawTarget::hidden());
    }
    bar
}
