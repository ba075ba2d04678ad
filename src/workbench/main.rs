//! The Tautline program: headless commands.

mod cli;

use std::process::ExitCode;

fn main() -> ExitCode {
    cli::run()
}
