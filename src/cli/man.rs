//! `latsch man`: pages for `man`.

use super::{Cli, print};
use clap::CommandFactory;
use latsch::{Error, Result};
use std::path::PathBuf;

/// Write the manual pages: latsch.1, latsch-simulate.1 and so on
///
/// As a user: latsch man ~/.local/share/man/man1, then man latsch-simulate.
#[derive(clap::Args)]
pub struct Args {
    /// Folder to write them to, which is made
    #[arg(value_name = "DIR")]
    folder: PathBuf,
}

pub fn run(args: &Args) -> Result<()> {
    let failed = |e: std::io::Error| Error::file(format!("{}: {e}", args.folder.display()));
    std::fs::create_dir_all(&args.folder).map_err(failed)?;
    clap_mangen::generate_to(Cli::command(), &args.folder).map_err(failed)?;
    print(&args.folder.display().to_string())
}
