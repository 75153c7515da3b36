//! The program `latsch`: dispatches to its subcommands.
#![deny(unsafe_code)]

mod cli;

fn main() -> std::process::ExitCode {
    cli::run()
}
