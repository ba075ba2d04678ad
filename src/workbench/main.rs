//! The `tautline` program.

use std::process::ExitCode;

fn main() -> ExitCode {
    tautline_workbench::cli::run()
}
