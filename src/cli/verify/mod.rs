//! `tautline verify`.

mod drive;
mod report;
mod typed;

use std::io::Write;
use std::path::PathBuf;

use anyhow::{Context, Result, anyhow};
use tautline_link::verifying::{CheckTarget, circle, cube_poses, line};
use tautline_session::{CheckRow, Outcome, Phase, Session, Stage, Verification, write_check};

use super::live::{Connection, LinkArguments, SessionFile, interrupt, typed as typing};
use super::measure::{refuse_unsettled, require_simulated};
use crate::examples::examples;
use crate::output::{JsonOutput, note, notice, write_file};
use crate::replace::OutputFile;
use crate::{BadInput, standard_input};
use tautline_workflow::accuracy::VerificationDocument;
use tautline_workflow::adjusting::{in_effect, title};
use tautline_workflow::clock;
use tautline_workflow::controllers::{ConnectionSetup, ControllerChoice};

/// Numbers of points of the circle and of the line.
const POINTS: (usize, usize) = (16, 9);

#[derive(Debug, clap::Args)]
#[command(after_help = examples(&[
    ("The targets of ISO 9283 with a simulated robot, as a table, too", "tautline verify run.json --controller sim --cycles 2 --arm -o check.csv"),
    ("Figures of positions that were measured before", "tautline verify run.json --check check.csv"),
]))]
pub struct Arguments {
    /// Session file
    #[arg(value_name = "SESSION")]
    session: PathBuf,
    /// sim, replay:DIR, ads:HOST[:PORT]/NETID or opc.tcp://HOST[:PORT]; not needed with --check
    #[arg(long, value_name = "CONTROLLER", required_unless_present = "check")]
    controller: Option<String>,
    /// Allow the robot to move
    #[arg(long)]
    arm: bool,
    /// Run a simulated robot this many times faster than real time; by default as fast as it can be computed
    #[arg(long, value_name = "TIMES")]
    speed: Option<f64>,
    #[command(flatten)]
    link: LinkArguments,
    /// Targets: cube (15 poses in three cubes), circle, line
    #[arg(long, value_enum, value_name = "LIST", value_delimiter = ',', default_values_t = TargetName::ALL)]
    targets: Vec<TargetName>,
    /// Number of approaches to each target; ISO 9283 requires 30
    #[arg(long, value_name = "N", default_value_t = 3)]
    cycles: usize,
    /// Number of points of the circle and of the line; by default 16 and 9
    #[arg(long, value_name = "N")]
    points: Option<usize>,
    /// Use the commanded and measured poses of this check.csv instead of moving the robot; - is standard input
    #[arg(long, value_name = "FILE.csv", conflicts_with_all = ["controller", "arm"])]
    check: Option<PathBuf>,
    /// Write commanded and measured poses as a check.csv; - is standard output
    #[arg(short, long, value_name = "FILE.csv")]
    out: Option<OutputFile>,
    /// Whether this is before or after the adjustment; by default according to the session's records
    #[arg(long, value_enum)]
    stage: Option<StageName>,
    #[command(flatten)]
    json: JsonOutput<VerificationDocument>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
enum TargetName {
    Cube,
    Circle,
    Line,
}

impl TargetName {
    const ALL: [Self; 3] = [Self::Cube, Self::Circle, Self::Line];
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
enum StageName {
    Before,
    After,
}

pub fn run(arguments: &Arguments) -> Result<()> {
    check(arguments)?;
    let (out, json) = (arguments.out.as_deref(), &arguments.json);
    let choice = choice(arguments)?;
    if choice.is_some() && !arguments.arm {
        let message = "The robot was not moved: add --arm once nobody is near the robot";
        return Err(BadInput::new(message));
    }
    let mut file = SessionFile::open(&arguments.session, &mut notice)?;
    refuse_unsettled(&file.session, &arguments.session.display().to_string())?;
    let (rows, source) = match (&arguments.check, &choice) {
        (Some(path), _) => (from_file(path)?, format!("from {}", path.display())),
        (None, Some(choice)) => {
            arguments.link.take(&mut file.session, choice)?;
            driven(arguments, &file, choice)?
        }
        (None, None) => return Err(BadInput::new("expected --controller or --check")),
    };
    // Checked first: rows without figures are not a verification.
    tautline_workflow::accuracy::figures(&rows).map_err(|error| match &arguments.check {
        Some(path) => BadInput::new(format!("{}: {error}", path.display())),
        None => anyhow::anyhow!("{error}"),
    })?;
    if let Some(path) = out {
        let mut bytes = Vec::new();
        write_check(bytes.by_ref(), &rows).context("the table cannot be made")?;
        write_file(path, &bytes)?;
    }
    let stage = stage(arguments, &file.session);
    keep(&mut file, stage, rows, &source)?;
    let document =
        VerificationDocument::of(&file.session, stage).map_err(|error| anyhow!(error))?;
    json.deliver(&document, || report::print(&document))
}

fn check(arguments: &Arguments) -> Result<()> {
    let speed = arguments.speed;
    if let Some(speed) = speed.filter(|s| !(s.is_finite() && *s > 0.0)) {
        let message = format!("--speed: found {speed}, expected a positive number");
        return Err(BadInput::new(message));
    }
    if arguments.cycles < 2 {
        let message = format!(
            "--cycles: found {}, expected at least 2 for the repeatability",
            arguments.cycles
        );
        return Err(BadInput::new(message));
    }
    if arguments.points.is_some_and(|points| points < 2) {
        return Err(BadInput::new("--points: expected at least 2"));
    }
    Ok(())
}

fn choice(arguments: &Arguments) -> Result<Option<ControllerChoice>> {
    let parse = |text: &String| {
        let choice = text.parse();
        choice.map_err(|error| BadInput::new(format!("--controller: {error}")))
    };
    arguments.controller.as_ref().map(parse).transpose()
}

fn from_file(path: &std::path::Path) -> Result<Vec<CheckRow>> {
    let read = standard_input::check_rows(path)?;
    for notice in &read.notices {
        note!("{notice}");
    }
    Ok(read.value)
}

/// Moves the robot while the simulated instrument or the operator measures.
fn driven(
    arguments: &Arguments,
    file: &SessionFile,
    choice: &ControllerChoice,
) -> Result<(Vec<CheckRow>, String)> {
    let place = arguments.session.display().to_string();
    require_simulated(&file.session, choice, &place)?;
    let setup = ConnectionSetup::chosen(&file.session, &[], choice, Some(&file.controller()));
    let targets = targets(arguments, &setup);
    if targets.is_empty() {
        let message = format!("{place}: --targets: its robot cannot reach any of them");
        return Err(BadInput::new(message));
    }
    if !setup.has_instrument() {
        typing::require("The robot was not moved: its positions have to be typed")?;
    }
    let mut connection = Connection::open(&setup, &arguments.link, arguments.speed)?;
    interrupt::listen()?;
    connection.arm()?;
    let source = match &connection.instrument {
        Some(instrument) => format!("with the {}", instrument.identity().to_lowercase()),
        None => "typed in".to_owned(),
    };
    let rows = drive::drive(&mut connection, targets, arguments.cycles)?;
    Ok((rows, source))
}

fn targets(arguments: &Arguments, setup: &ConnectionSetup) -> Vec<CheckTarget> {
    let (robot, workspace) = (setup.robot(), setup.workspace());
    let (on_circle, on_line) = POINTS;
    let mut targets = Vec::new();
    for name in TargetName::ALL {
        if arguments.targets.contains(&name) {
            targets.extend(match name {
                TargetName::Cube => cube_poses(robot, workspace),
                TargetName::Circle => {
                    circle(robot, workspace, arguments.points.unwrap_or(on_circle))
                }
                TargetName::Line => line(robot, workspace, arguments.points.unwrap_or(on_line)),
            });
        }
    }
    targets
}

/// After the adjustment if the last adjustment was written.
fn stage(arguments: &Arguments, session: &Session) -> Stage {
    let last = in_effect(session);
    match arguments.stage {
        Some(StageName::Before) => Stage::Before,
        Some(StageName::After) => Stage::After,
        None if last.is_some_and(|last| last.outcome == Outcome::Written) => Stage::After,
        None => Stage::Before,
    }
}

fn keep(file: &mut SessionFile, stage: Stage, rows: Vec<CheckRow>, source: &str) -> Result<()> {
    let text = format!("{}: {} measurements {source}.", title(stage), rows.len());
    file.session.add_verification(Verification {
        time: clock::now(),
        title: title(stage).to_owned(),
        stage,
        rows,
        accepted: None,
    });
    file.log(Phase::Accuracy, text);
    Ok(file.save()?)
}
