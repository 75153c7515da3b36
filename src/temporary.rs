//! Temporary folders and files, and child processes: what has to go when the program is told to end (Ctrl-C, a job
//! scheduler), which no destructor sees.
//!
//! All are made, changed and removed with one lock held. Whoever ends the program takes the lock and keeps it: from then
//! on nothing new comes, and no other thread can end the program in another way.

use std::io;
use std::path::{Path, PathBuf};
use std::process::{Child, Command};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Duration;
use tempfile::{NamedTempFile, TempDir};

static ALL: Mutex<All> = Mutex::new(All { paths: Vec::new(), children: Vec::new() });

struct All {
    paths: Vec<PathBuf>,
    children: Vec<Arc<Mutex<Child>>>,
}

impl All {
    fn lock() -> MutexGuard<'static, Self> {
        // the lists are whole at any time
        ALL.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn forget(&mut self, path: &Path) {
        self.paths.retain(|other| other != path);
    }

    /// Ends the children and removes everything.
    fn remove(&mut self) {
        for child in self.children.drain(..) {
            let mut child = child.lock().unwrap_or_else(PoisonError::into_inner);
            let _ = child.kill();
            let _ = child.wait();
        }
        for path in self.paths.drain(..) {
            // an FMU that still runs may be writing into its folder
            for _ in 0..20 {
                let removed = match path.is_dir() {
                    true => std::fs::remove_dir_all(&path),
                    false => std::fs::remove_file(&path),
                };
                match removed {
                    Err(e) if e.kind() != io::ErrorKind::NotFound => {
                        std::thread::sleep(Duration::from_millis(20))
                    }
                    _ => break,
                }
            }
        }
    }
}

/// Does something that must not be begun any more once the program is about to end: makes a file in a temporary folder,
/// or tells the result.
pub fn before_the_end<T>(body: impl FnOnce() -> T) -> T {
    let _all = All::lock();
    body()
}

/// A folder that is removed with this value, or when the program is told to end.
#[derive(Debug)]
pub struct Folder(Option<TempDir>, PathBuf);

impl Folder {
    /// A new folder where the system has its temporary ones; its name begins with `prefix`.
    ///
    /// # Errors
    /// Any failure of the file system.
    pub fn new(prefix: &str) -> io::Result<Self> {
        let mut all = All::lock();
        let folder = tempfile::Builder::new().prefix(prefix).tempdir()?;
        let path = folder.path().to_owned();
        all.paths.push(path.clone());
        Ok(Self(Some(folder), path))
    }

    /// Where it is.
    pub fn path(&self) -> &Path {
        &self.1
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let mut all = All::lock();
        drop(self.0.take());
        all.forget(&self.1);
    }
}

/// Marks a temporary file as one that goes with the program, as long as this value lives.
pub(crate) struct Mark(PathBuf);

impl Mark {
    /// Makes the file and marks it.
    pub(crate) fn of(make: impl FnOnce() -> io::Result<NamedTempFile>) -> io::Result<(NamedTempFile, Self)> {
        let mut all = All::lock();
        let file = make()?;
        all.paths.push(file.path().to_owned());
        let mark = Self(file.path().to_owned());
        Ok((file, mark))
    }
}

impl Drop for Mark {
    fn drop(&mut self) {
        All::lock().forget(&self.0);
    }
}

/// A child process that is killed when the program is told to end.
pub(crate) struct Running(Arc<Mutex<Child>>);

impl Running {
    /// Starts it.
    pub(crate) fn start(command: &mut Command) -> io::Result<Self> {
        let mut all = All::lock();
        let child = Arc::new(Mutex::new(command.spawn()?));
        all.children.push(child.clone());
        Ok(Self(child))
    }

    /// Does something with the child, soon: who ends the program waits for it.
    pub(crate) fn with<T>(&self, body: impl FnOnce(&mut Child) -> T) -> T {
        body(&mut self.0.lock().unwrap_or_else(PoisonError::into_inner))
    }
}

impl Drop for Running {
    fn drop(&mut self) {
        All::lock().children.retain(|child| !Arc::ptr_eq(child, &self.0));
    }
}

/// From now on, a signal that tells the program to end first removes temporary folders and files and kills the child
/// processes; then the program ends by that signal, as without this. A second one ends it at once. For programs: it
/// changes what signals do in the whole process.
///
/// # Errors
/// The system refuses.
#[cfg(unix)]
pub fn clean_up_on_signals() -> io::Result<()> {
    use signal_hook::consts::{SIGHUP, SIGINT, SIGTERM};
    use signal_hook::{flag, iterator::Signals, low_level};
    use std::sync::atomic::AtomicBool;

    // what is ignored stays ignored: so it is with nohup, and in the background of a script
    let signals: Vec<i32> = [SIGINT, SIGTERM, SIGHUP]
        .into_iter()
        .filter(|signal| !crate::fmi::signal::is_ignored(*signal))
        .collect();
    for signal in &signals {
        let again = Arc::new(AtomicBool::new(false));
        flag::register_conditional_default(*signal, again.clone())?;
        flag::register(*signal, again)?;
    }
    let mut signals = Signals::new(signals)?;
    std::thread::Builder::new().name("signals".into()).spawn(move || {
        if let Some(signal) = signals.forever().next() {
            let mut all = All::lock();
            all.remove();
            let _ = low_level::emulate_default_handler(signal);
        }
    })?;
    Ok(())
}

/// From now on, Ctrl-C and the end of the console or session first remove temporary folders and files and kill the child
/// processes; then the program ends, as without this. For programs: it changes what happens in the whole process.
///
/// # Errors
/// The system refuses.
#[cfg(windows)]
pub fn clean_up_on_signals() -> io::Result<()> {
    /// What Windows itself ends a program with: STATUS_CONTROL_C_EXIT.
    const ENDED_BY_CONTROL_C: u32 = 0xC000_013A;
    ctrlc::set_handler(|| {
        // kept: nothing new comes any more
        let mut all = All::lock();
        all.remove();
        std::process::exit(ENDED_BY_CONTROL_C as i32);
    })
    .map_err(io::Error::other)
}
