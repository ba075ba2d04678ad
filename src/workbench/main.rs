//! The `tautline` program: the window, or the command line.

use std::process::ExitCode;

use anyhow::anyhow;
use tautline_cli::{Window, WindowOptions};
use tautline_workbench::model::Options;
use tautline_workbench::shell;
use tautline_workbench::views::report_picture::report_picture;

fn main() -> ExitCode {
    tautline_cli::run(&Window {
        open,
        picture: |session, fit| report_picture(session, fit, &Default::default()),
    })
}

fn open(options: WindowOptions) -> anyhow::Result<()> {
    let options = Options {
        path: options.path,
        observed: options.observed,
        robot_speed: options.robot_speed,
        ..Options::default()
    };
    shell::run(options).map_err(|error| anyhow!("{}", shell::no_window(&error)))
}
