//! Headless commands: arguments, exit codes, output.

pub(crate) mod accuracy;
mod adjust;
mod compare;
mod diagnose;
mod effects;
mod evaluate;
mod fitted;
mod identify;
mod input;
mod live;
mod measure;
mod output;
mod plan;
mod precalibrate;
mod published;
mod report;
mod schemas;
mod simulate;
mod symbols;
mod table;
mod verify;

use std::path::PathBuf;
use std::process::ExitCode;

use clap::{Parser, Subcommand};
use tautline_session::ReadError;

/// Calibrate cable-driven parallel robots.
#[derive(Debug, Parser)]
#[command(
    name = "tautline",
    version,
    about,
    args_conflicts_with_subcommands = true
)]
struct Arguments {
    /// Session, robot.json or dataset folder to open in the workbench
    #[arg(value_name = "PATH")]
    path: Option<PathBuf>,
    /// File that describes what the window shows after every frame, for programs that drive it
    #[arg(long, value_name = "FILE", hide = true)]
    observed: Option<PathBuf>,
    /// How many times faster than real the simulated robot moves, for programs that measure the window.
    #[arg(long, value_name = "TIMES", hide = true)]
    robot_speed: Option<f64>,
    #[command(subcommand)]
    command: Option<Command>,
}

#[derive(Debug, Subcommand)]
enum Command {
    /// Make a dataset of a virtual robot
    Simulate(simulate::Arguments),
    /// Choose the poses to measure and say what to expect of them
    Plan(plan::Arguments),
    /// Drive a robot from pose to pose and measure; goes on where an earlier run ended
    Measure(measure::Arguments),
    /// Find the pulleys from a dataset
    Identify(identify::Arguments),
    /// Say whether the model explains a dataset, what it gets wrong and what to do about it
    Diagnose(diagnose::Arguments),
    /// Fit poses only, with the geometry and effects of a model held
    Evaluate(evaluate::Arguments),
    /// Say which pulleys differ between two runs and what is noise
    Compare(compare::Arguments),
    /// Accuracy figures of ISO 9283 from a check.csv
    Accuracy(accuracy::Arguments),
    /// Fit winches, force sensors, home platform and cable elongation of a dataset
    Precalibrate(precalibrate::Arguments),
    /// Identify, diagnose and write a report as HTML or PDF
    Report(report::Arguments),
    /// Identify and write the values to the controller, or bring the old ones back
    Adjust(adjust::Arguments),
    /// Drive to test poses and paths, and say how exactly the robot moves
    Verify(verify::Arguments),
    /// Print the default names of a controller's symbols, as --symbols reads them
    Symbols(symbols::Arguments),
    /// List the physical effects that simulate can hide and identify can free
    Effects,
    /// Write the JSON Schemas of the file formats
    Schemas {
        /// Folder to write to
        #[arg(long, value_name = "DIR")]
        out: PathBuf,
    },
}

/// Input that the user has to correct; ends the program with exit code 2.
#[derive(Debug, thiserror::Error)]
#[error("{0}")]
pub(crate) struct BadInput(String);

impl BadInput {
    #[expect(
        clippy::new_ret_no_self,
        reason = "commands only return it, as the error of their result"
    )]
    pub(crate) fn new(message: impl std::fmt::Display) -> anyhow::Error {
        Self(message.to_string()).into()
    }
}

/// Runs the command line.
pub fn run() -> ExitCode {
    let arguments = Arguments::parse();
    let Some(command) = arguments.command else {
        return finish(workbench(crate::app::Options {
            path: arguments.path,
            observed: arguments.observed,
            robot_speed: arguments.robot_speed,
            ..Default::default()
        }));
    };
    finish(match command {
        Command::Simulate(arguments) => simulate::run(&arguments),
        Command::Plan(arguments) => plan::run(&arguments),
        Command::Measure(arguments) => measure::run(&arguments),
        Command::Identify(arguments) => identify::run(&arguments),
        Command::Diagnose(arguments) => diagnose::run(&arguments),
        Command::Evaluate(arguments) => evaluate::run(&arguments),
        Command::Compare(arguments) => compare::run(&arguments),
        Command::Accuracy(arguments) => accuracy::run(&arguments),
        Command::Precalibrate(arguments) => precalibrate::run(&arguments),
        Command::Report(arguments) => report::run(&arguments),
        Command::Adjust(arguments) => adjust::run(&arguments),
        Command::Verify(arguments) => verify::run(&arguments),
        Command::Symbols(arguments) => symbols::run(&arguments),
        Command::Effects => {
            effects::run();
            Ok(())
        }
        Command::Schemas { out } => schemas::run(&out),
    })
}

fn workbench(options: crate::app::Options) -> anyhow::Result<()> {
    if let Some(missing) = options.path.as_deref().filter(|path| !path.exists()) {
        let message = format!(
            "{}: is neither a command nor a file or folder",
            missing.display()
        );
        return Err(BadInput::new(message));
    }
    crate::app::run(options).map_err(|error| anyhow::anyhow!("cannot open a window: {error}"))
}

/// Prints what went wrong, in one line, and gives the exit code.
fn finish(result: anyhow::Result<()>) -> ExitCode {
    let Err(error) = result else {
        return ExitCode::SUCCESS;
    };
    let bad_input = error.is::<ReadError>() || error.is::<BadInput>();
    let message = format!("{error:#}");
    eprintln!("{}", message.replace('\n', " "));
    ExitCode::from(if bad_input { 2 } else { 1 })
}
