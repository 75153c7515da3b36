//! The process that runs foreign code: one case, then it ends. What it finds it writes at once, so that
//! it is kept if the code crashes.

use super::lab::{Case, Lab, word};
use super::reporter::{CALL, Line, Reporter, STDERR, STDOUT};
use super::system::{self, CallNote};
use super::tree::Node;
use super::unit::{Functions, Maker, Outcome, STALE, STRANGE};
use crate::fmi::import::Description;
use crate::fmi::import::library::{Handle, Names, find, is_loaded};
use crate::fmi::import::log::Heard;
use crate::fmi::import::slave::file_uri;
use crate::{Error, Result};
use std::fs::File;
use std::path::Path;
use std::sync::atomic::Ordering;
use std::time::{Duration, Instant};

/// Runs the one of these cases that is called `name`, as [`run_child`](super::run_child) says.
pub(super) fn run(cases: &[Case], name: &str, folder: &Path, work: &Path, timeout: Duration) -> Result<()> {
    let begin = Instant::now();
    let case = cases
        .iter()
        .find(|case| case.name == name)
        .ok_or_else(|| Error::call(format!("there is no check {name:?}")))?;
    let io = |e: std::io::Error| Error::file(format!("{}: {e}", work.display()));
    system::expect_a_crash();
    let out = File::create(work.join(STDOUT)).map_err(io)?;
    let err = File::create(work.join(STDERR)).map_err(io)?;
    let xml = std::fs::read(folder.join("modelDescription.xml")).map_err(io)?;
    let description = Description::parse(&xml)?;
    let root = Node::parse(&xml).map_err(Error::from)?;
    let note = CallNote::at(&work.join(CALL));
    let results =
        system::redirect(1, &out).ok_or_else(|| Error::call("standard output cannot be redirected"))?;
    system::redirect(2, &err).ok_or_else(|| Error::call("standard error cannot be redirected"))?;
    let reporter = Reporter::new(results);

    let resources = std::path::absolute(folder).map_err(io)?.join("resources");
    std::fs::create_dir_all(&resources).map_err(io)?;
    let (file, path) = match find(folder, &description.model_identifier) {
        Ok(found) => found,
        Err(error) => {
            reporter.stop(error.to_string());
            return Ok(());
        }
    };
    note.write("loading the library");
    let handle = match Handle::open(&path, Names::Usual) {
        Ok(handle) => handle,
        Err(error) => {
            reporter.error("Z3", format!("{file}: {error}"));
            reporter.stop(format!("{file} cannot be loaded"));
            return Ok(());
        }
    };
    // SAFETY: running foreign code by the names of FMI 2.0 is what this process is for; the handle is
    // closed after the last call.
    let functions = unsafe { Functions::find(&handle) };
    let categories: Vec<String> = root
        .child("LogCategories")
        .map(|list| list.all("Category").filter_map(|c| c.text("name")).map(Into::into).collect())
        .unwrap_or_default();
    let asynchronous = description.capabilities.can_run_asynchronously;
    let judge = |outcome: &Outcome<'_>| judge(outcome, &reporter, &categories, asynchronous);
    let lab = Lab {
        maker: Maker { functions, note: &note, judge: &judge },
        note: &note,
        description: &description,
        reporter: &reporter,
        level: case.level,
        resources: file_uri(&resources),
        folder: resources,
        work: work.to_owned(),
        begin,
        timeout,
    };
    (case.run)(&lab);
    if STALE.load(Ordering::Relaxed) {
        reporter.error(
            "S4",
            "the FMU calls back through the struct fmi2CallbackFunctions, which is only valid during fmi2Instantiate",
        );
    }
    if STRANGE.load(Ordering::Relaxed) {
        reporter.error("L4", "the logger was called with an environment that the master did not give");
    }
    note.write("closing the library");
    drop(handle);
    if case.name == "unload" && is_loaded(&path) {
        reporter
            .warning("S11", format!("{file} stays loaded after its last instance is freed and it is closed"));
    }
    note.write("printing");
    system::flush_c_streams();
    for (stream, name) in [(STDOUT, "standard output"), (STDERR, "standard error")] {
        if let Ok(bytes) = std::fs::read(work.join(stream))
            && !bytes.is_empty()
        {
            let text = String::from_utf8_lossy(&bytes);
            let line: String = text.lines().next().unwrap_or_default().chars().take(60).collect();
            reporter.warning("S8", format!("the FMU prints to {name}: {line:?}"));
        }
    }
    note.write("the end of the process");
    reporter.send(&Line::Done);
    Ok(())
}

/// What every call has to keep to.
fn judge(outcome: &Outcome<'_>, reporter: &Reporter, categories: &[String], asynchronous: bool) {
    let call = outcome.call;
    if !outcome.same_float_mode {
        reporter.error("S8", format!("{call} leaves the floating-point control word changed"));
    }
    match outcome.status {
        0..=4 => {}
        5 if asynchronous => {}
        5 => reporter.error("D6", format!("{call} returned fmi2Pending, though no step is asynchronous")),
        other => reporter.error("D6", format!("{call} returned {other}, which is no fmi2Status")),
    }
    // The calls for statuses answer fmi2Discard where there is nothing to tell.
    if (1..=4).contains(&outcome.status) && outcome.messages.is_empty() && !call.ends_with("Status") {
        let status = word(outcome.status);
        reporter.error("L5", format!("{call} returned {status} without a message"));
    }
    for message in outcome.messages {
        judge_message(outcome, message, reporter, categories);
    }
}

fn judge_message(outcome: &Outcome<'_>, message: &Heard, reporter: &Reporter, categories: &[String]) {
    let call = outcome.call;
    match &message.category {
        Some(category) if !categories.contains(category) => {
            let what = if categories.is_empty() {
                format!("{call} logs in the category {category:?}, but none is declared")
            } else {
                format!("{call} logs in the category {category:?}; declared are {}", categories.join(", "))
            };
            reporter.error("L1", what);
        }
        _ => {}
    }
    if outcome.name.is_some_and(|name| name != message.name) && !message.name.trim().is_empty() {
        if message.name.bytes().all(|b| b == b'~') {
            reporter.error(
                "S1",
                format!("{call} uses the instance's name, which was freed after fmi2Instantiate"),
            );
        } else {
            reporter.error(
                "L4",
                format!("{call} logs for {:?}, but the instance has another name", message.name),
            );
        }
    }
    let shown: String = message.format.chars().take(60).collect();
    // References to variables may be made by the directives, as in "#r%u#".
    if let Some(sign) = stray_percent(&message.format).or_else(|| stray_hash(&message.text)) {
        reporter.warning("L3", format!("the message {shown:?} has a stray {sign:?}"));
    }
    if message.format.ends_with('\n') {
        reporter.warning("L3", format!("the message {shown:?} ends with a line break"));
    }
}

/// The first percent sign that starts no directive of printf.
fn stray_percent(format: &str) -> Option<String> {
    let plain = format.replace("%%", "");
    let mut rest = plain.as_str();
    while let Some(at) = rest.find('%') {
        let tail = rest[at + 1..]
            .trim_start_matches(|c: char| c.is_ascii_digit() || matches!(c, '-' | '+' | '.' | '*' | '#'));
        let tail = tail.trim_start_matches(['h', 'l', 'L', 'z', 'j', 't']);
        if !tail.starts_with(|c: char| "diouxXeEfFgGaAcspn".contains(c)) {
            return Some(rest[at..].chars().take(6).collect());
        }
        rest = &tail[1..];
    }
    None
}

/// The first hash that starts no reference such as `#r12#`, in a message with its arguments. Where these could
/// not be read, the number may still be a directive, as in `#r%u#`.
fn stray_hash(text: &str) -> Option<String> {
    let plain = text.replace("##", "");
    let mut rest = plain.as_str();
    while let Some(at) = rest.find('#') {
        let reference = rest[at + 1..].split_once('#').filter(|(inside, _)| {
            let mut letters = inside.chars();
            letters.next().is_some_and(|c| matches!(c, 'r' | 'i' | 'b' | 's'))
                && inside.len() > 1
                && (inside[1..].starts_with('%') || letters.all(|c| c.is_ascii_digit()))
        });
        let Some((_, tail)) = reference else { return Some(rest[at..].chars().take(6).collect()) };
        rest = tail;
    }
    None
}

#[cfg(test)]
mod tests {
    use super::{stray_hash, stray_percent};

    #[test]
    fn directives() {
        for good in ["", "100 %% of ##1", "%s is %5.2f, %ld, %-8zu", "variable #r%u# = %#x"] {
            assert_eq!(stray_percent(good), None, "{good}");
        }
        for bad in ["100% sure", "50 %"] {
            assert!(stray_percent(bad).is_some(), "{bad}");
        }
        for good in ["", "100 % of ##1", "variable #r12# and #s3#", "#r%u# = %g"] {
            assert_eq!(stray_hash(good), None, "{good}");
        }
        for bad in ["item #1", "# done", "#r#", "#rx#"] {
            assert!(stray_hash(bad).is_some(), "{bad}");
        }
    }
}
