//! `latsch completions`: what a shell completes.

use super::{Cli, print};
use clap::CommandFactory;
use clap_complete::Shell;
use latsch::{Error, Result};

/// Print what a shell completes: subcommands, options, and their values
///
/// For bash: latsch completions bash > ~/.local/share/bash-completion/completions/latsch
#[derive(clap::Args)]
pub struct Args {
    /// The shell
    shell: Shell,
}

pub fn run(args: &Args) -> Result<()> {
    let mut script = Vec::new();
    clap_complete::generate(args.shell, &mut Cli::command(), "latsch", &mut script);
    print(String::from_utf8(script).map_err(|e| Error::file(e.to_string()))?.trim_end())
}
