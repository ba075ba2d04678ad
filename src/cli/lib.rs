//! The command line: arguments, exit codes, output.

mod accuracy;
mod adjust;
mod audit;
mod certificate;
mod check;
mod compare;
mod completions;
mod diagnose;
mod effect_arguments;
mod effects;
mod evaluate;
mod examples;
mod export;
mod failure;
mod formulas;
mod history;
mod home;
mod hypothesis_arguments;
mod identify;
mod import;
mod input;
mod isolability;
mod live;
mod man;
mod measure;
mod method;
mod mistyped;
mod new;
mod output;
mod plan;
mod position_tolerance;
mod precalibrate;
mod progress;
mod replace;
mod replay;
mod report;
mod report_format;
mod schemas;
mod simulate;
mod standard_input;
mod study;
mod symbols;
mod table;
mod tolerances;
mod verify;
mod volume;

use std::path::PathBuf;
use std::process::ExitCode;

use clap::{CommandFactory, FromArgMatches, Parser, Subcommand};
use tautline_files::ReadError;
use tautline_session::Session;
use tautline_workflow::identification::Identification;
use tautline_workflow::session_file::SessionFileError;

use examples::{examples, heading};
use failure::{BadInput, Reservation};

/// The forms of the command line.
const USAGE: &str = "tautline [PATH]\n       tautline <COMMAND> [OPTIONS]";

const EXIT_CODES: [&str; 6] = [
    "success",
    "any other failure",
    "bad input: one line that names file, line and column",
    "identify or evaluate did not converge",
    "adjust settled an earlier attempt and wrote nothing else",
    "a part of check failed",
];

/// Calibrate cable-driven parallel robots: identify their pulleys, find what is wrong with them, correct the controller.
///
/// Without a command, the workbench opens in a window.
#[derive(Debug, Parser)]
#[command(
    name = "tautline",
    version,
    override_usage = USAGE,
    after_help = after_help()
)]
struct Arguments {
    /// Session, robot.json or dataset folder to open in the workbench
    #[arg(value_name = "PATH")]
    path: Option<PathBuf>,
    /// File that describes the contents of the window after every frame, for programs that drive it
    #[arg(long, value_name = "FILE", hide = true)]
    observed: Option<PathBuf>,
    /// Speed of the simulated robot as a multiple of real time, for programs that measure the window
    #[arg(long, value_name = "TIMES", hide = true)]
    robot_speed: Option<f64>,
    /// Print errors, questions and results only: no notices, no progress, no confirmation of files written
    #[arg(short, long, global = true)]
    quiet: bool,
    /// Replace files that exist; results in JSON are replaced by those of the same kind without it
    #[arg(long, global = true)]
    replace: bool,
    #[command(subcommand)]
    command: Option<Command>,
}

/// Where the program comes from, as whoever publishes it states when it is built.
const HOME_PAGE: Option<&str> = option_env!("TAUTLINE_HOMEPAGE");

fn after_help() -> String {
    let mut text = examples(&[
        (
            "The workbench; its start page leads through all phases",
            "tautline",
        ),
        ("A simulated run", "tautline simulate --robot mini -o mini"),
        ("The pulleys of that run", "tautline identify mini"),
    ]);
    text.push_str(&heading("\n\nExit status:"));
    for (code, meaning) in EXIT_CODES.iter().enumerate() {
        text.push_str(&format!("\n  {code} {meaning}"));
    }
    if let Some(page) = HOME_PAGE {
        text.push_str(&heading("\n\nHome page:"));
        text.push_str(&format!("\n  {page}\n  Reports of errors: {page}/issues"));
    }
    text
}

#[derive(Debug, Subcommand)]
enum Command {
    /// Write the robot.json of a common machine, to be completed with your numbers
    New(new::Arguments),
    /// Simulate a calibration run: create a dataset of a virtual robot
    Simulate(simulate::Arguments),
    /// Plan the poses to measure and predict the standard deviations
    Plan(plan::Arguments),
    /// Move a robot to the planned poses and measure; continues an interrupted run
    Measure(Box<measure::Arguments>),
    /// Create a dataset from files of other programs: logs, motion capture, point lists, spreadsheets
    Import(import::Arguments),
    /// Check a dataset before identification: readings, geometry, and the faults it would reveal
    Check(check::Arguments),
    /// Identify the pulleys from a dataset
    Identify(identify::Arguments),
    /// Diagnose the model: whether it explains a dataset, what is wrong and what to do about it
    Diagnose(diagnose::Arguments),
    /// Look for patterns of an error that no cause explains; the likeliest becomes a hypothesis file
    Formulas(formulas::Arguments),
    /// Estimate poses only, with the geometry and effects of a model kept fixed
    Evaluate(evaluate::Arguments),
    /// Export a dataset or its results as a table for other programs: CSV, Parquet, MATLAB
    Export(export::Arguments),
    /// Compare a simulator with the machine: how far its readings are from the measured ones, and what explains it
    Replay(replay::Arguments),
    /// Compare two runs: which pulleys moved, which differences are noise
    Compare(compare::Arguments),
    /// Follow one robot over all its sessions: what moved or drifts, and when to calibrate again
    History(history::Arguments),
    /// Compute the accuracy figures of ISO 9283 from a check.csv
    Accuracy(accuracy::Arguments),
    /// Measure the home pose, once or several times, and use the mean
    Home(home::Arguments),
    /// Fit winches, force sensors, home platform and cable elongation to the calibration tables of a dataset
    Precalibrate(precalibrate::Arguments),
    /// Identify, diagnose and write a report as HTML or PDF
    Report(report::Arguments),
    /// Identify and write the values to the controller, or restore the old ones
    Adjust(adjust::Arguments),
    /// Move to test poses and paths and compute the accuracy figures of ISO 9283
    Verify(verify::Arguments),
    /// Check that nothing was changed that a session recorded: readings, adjustments, operators, log
    Audit(audit::Arguments),
    /// Show the certificate with which this computer connects to OPC UA servers, and export it for their trust lists
    Certificate(certificate::Arguments),
    /// Studies of many simulated calibrations: which sensor, how many poses, what accuracy
    #[command(subcommand)]
    Study(study::Command),
    /// Write the default symbol names of a controller, for --symbols
    Symbols(symbols::Arguments),
    /// List the physical effects that can be simulated, identified and diagnosed
    Effects(effects::Arguments),
    /// Write the JSON Schemas of the file formats
    Schemas(schemas::Arguments),
    /// Write the completions of a shell: commands, options and their values
    Completions(completions::Arguments),
    /// Write the manual pages of all commands
    Man(man::Arguments),
}

/// Options for opening the window.
#[derive(Debug, Clone, Default)]
pub struct WindowOptions {
    /// Session, robot.json or dataset folder to open.
    pub path: Option<PathBuf>,
    /// File that describes the contents of the window after every frame.
    pub observed: Option<PathBuf>,
    /// Speed of the simulated robot as a multiple of real time.
    pub robot_speed: Option<f64>,
}

/// Functions of the window's crate, on which this crate does not depend.
pub struct Window {
    /// Opens the window; returns once it is closed.
    pub open: fn(WindowOptions) -> anyhow::Result<()>,
    /// Draws the robot for a report (PNG).
    pub picture: fn(&Session, Option<&Identification>) -> Result<Vec<u8>, String>,
}

/// Runs the command line.
pub fn run(window: &Window) -> ExitCode {
    // Options report the error of a negative number themselves.
    let negative = |argument: clap::Arg| match argument.get_action().takes_values() {
        true => argument.allow_negative_numbers(true),
        false => argument,
    };
    let commands = Arguments::command().mut_subcommands(|command| command.mut_args(negative));
    let parsed = commands.try_get_matches().and_then(|matches| {
        let arguments = Arguments::from_arg_matches(&matches)?;
        Ok((matches, arguments))
    });
    let (matches, arguments) = match parsed {
        Ok(parsed) => parsed,
        Err(error) if error.use_stderr() => {
            let words = std::env::args_os().skip(1);
            match mistyped::first_word(words, &Arguments::command()) {
                Some(mistyped) => return finish(Err(mistyped)),
                None => error.exit(),
            }
        }
        Err(help) => {
            output::note_failure(help.print());
            return finish(output::check());
        }
    };
    if arguments.quiet {
        output::be_quiet();
    }
    if let (Some(path), Some(_)) = (&arguments.path, &arguments.command) {
        let message = format!(
            "found {} before a command, expected one of them",
            path.display()
        );
        return finish(Err(BadInput::new(message)));
    }
    let Some(command) = arguments.command else {
        return finish(open(
            window,
            WindowOptions {
                path: arguments.path,
                observed: arguments.observed,
                robot_speed: arguments.robot_speed,
            },
        ));
    };
    if let Err(refused) = replace::permit_all(&matches, arguments.replace) {
        return finish(Err(refused));
    }
    let result = match command {
        Command::New(arguments) => new::run(&arguments),
        Command::Simulate(arguments) => simulate::run(&arguments),
        Command::Plan(arguments) => plan::run(&arguments),
        Command::Measure(arguments) => measure::run(&arguments),
        Command::Import(arguments) => import::run(&arguments),
        Command::Check(arguments) => check::run(&arguments),
        Command::Identify(arguments) => identify::run(&arguments),
        Command::Diagnose(arguments) => diagnose::run(&arguments),
        Command::Formulas(arguments) => formulas::run(&arguments),
        Command::Evaluate(arguments) => evaluate::run(&arguments),
        Command::Export(arguments) => export::run(&arguments),
        Command::Replay(arguments) => replay::run(&arguments),
        Command::Compare(arguments) => compare::run(&arguments),
        Command::History(arguments) => history::run(&arguments),
        Command::Accuracy(arguments) => accuracy::run(&arguments),
        Command::Home(arguments) => home::run(&arguments),
        Command::Precalibrate(arguments) => precalibrate::run(&arguments),
        Command::Report(arguments) => report::run(&arguments, window),
        Command::Adjust(arguments) => adjust::run(&arguments),
        Command::Verify(arguments) => verify::run(&arguments),
        Command::Audit(arguments) => audit::run(&arguments),
        Command::Certificate(arguments) => certificate::run(&arguments),
        Command::Study(command) => study::run(&command),
        Command::Symbols(arguments) => symbols::run(&arguments),
        Command::Effects(arguments) => effects::run(&arguments),
        Command::Schemas(arguments) => schemas::run(&arguments),
        Command::Completions(arguments) => completions::run(&arguments, Arguments::command()),
        Command::Man(arguments) => man::run(&arguments, Arguments::command()),
    };
    finish(result.and_then(|()| output::check()))
}

fn open(window: &Window, options: WindowOptions) -> anyhow::Result<()> {
    if let Some(missing) = options.path.as_deref().filter(|path| !path.exists()) {
        return Err(mistyped::error(
            &missing.to_string_lossy(),
            &Arguments::command(),
        ));
    }
    (window.open)(options)
}

/// Prints an error on one line and returns the exit code.
fn finish(result: anyhow::Result<()>) -> ExitCode {
    let Err(error) = result else {
        return ExitCode::SUCCESS;
    };
    let message = format!("{error:#}");
    output::message(message.replace('\n', " "));
    let file_error = error.downcast_ref::<SessionFileError>();
    let is_bad_file = file_error.is_some_and(SessionFileError::is_bad_input);
    ExitCode::from(
        if is_bad_file || error.is::<ReadError>() || error.is::<BadInput>() {
            BadInput::EXIT_CODE
        } else {
            error
                .downcast_ref::<Reservation>()
                .map_or(1, |reservation| *reservation as u8)
        },
    )
}

#[cfg(test)]
mod tests {
    use clap::builder::ValueParser;

    use super::*;

    /// Value names of numbers with a fraction: units, and dimensionless quantities.
    const UNITS: [&str; 10] = [
        "M",
        "MM",
        "DEG",
        "SECONDS",
        "MS",
        "HZ",
        "GIB",
        "PROBABILITY",
        "SD",
        "TIMES",
    ];

    /// Commands that write only the file of `--out`, or a folder with its JSON.
    const WITHOUT_JSON: [&str; 10] = [
        "new",
        "simulate",
        "export",
        "report",
        "symbols",
        "schemas",
        "completions",
        "man",
        "plan", // of a study, whose folder has plan.json
        "run",
    ];

    fn check_arguments(command: &clap::Command) {
        let has_json = command.get_arguments().any(|one| one.get_id() == "json");
        let is_leaf = !command.has_subcommands();
        assert!(
            has_json || !is_leaf || WITHOUT_JSON.contains(&command.get_name()),
            "{}: no --json",
            command.get_name()
        );
        let number = ValueParser::from(clap::value_parser!(f64)).type_id();
        for one in command.get_arguments() {
            let place = format!("{} {}", command.get_name(), one.get_id());
            let value = one.get_value_names().and_then(|names| names.first());
            let value = value.map_or("", |value| value.as_str());
            if one.get_value_parser().type_id() == number {
                assert!(UNITS.contains(&value), "{place}: {value}");
            }
            if one.get_id() == "out" {
                assert_eq!(one.get_short(), Some('o'), "{place}");
            }
        }
        command.get_subcommands().for_each(check_arguments);
    }

    #[test]
    fn numbers_name_their_units_and_results_have_json() {
        check_arguments(&Arguments::command());
        Arguments::command().debug_assert();
    }

    #[test]
    fn the_exit_code_says_what_went_wrong() {
        for (error, code) in [
            (BadInput::new("poses.csv: not found"), 2),
            (Reservation::NotConverged.into(), 3),
            (Reservation::Settled.into(), 4),
            (Reservation::NotReady.into(), 5),
            (anyhow::anyhow!("the connection is lost"), 1),
        ] {
            assert_eq!(finish(Err(error)), ExitCode::from(code));
        }
        assert_eq!(finish(Ok(())), ExitCode::SUCCESS);
    }
}
