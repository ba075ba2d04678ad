//! `tautline measure`.

mod begin;
mod document;
mod drive;
mod plan;

use std::cell::Cell;
use std::path::PathBuf;

use crate::BadInput;
use anyhow::{Result, anyhow};
use tautline_core::planning::USUAL_POSES;
use tautline_core::sequential::{AT_MOST, Goal};
use tautline_session::{LaserSettings, Phase, Session};
use tautline_workflow::adjusting;
use tautline_workflow::controllers::{ConnectionSetup, ControllerChoice};
use tautline_workflow::identification::{Identification, identify_session};
use tautline_workflow::sequential::{SequentialRun, UntilRequest, planned_poses};
use tautline_workflow::wording::{count, list};

use crate::effect_arguments::HiddenEffects;
use crate::examples::examples;
use crate::hypothesis_arguments::HypothesisFiles;
use crate::input;
use crate::live::{Connection, RobotArguments, SessionFile, interrupt, typed};
use crate::output::{JsonOutput, note, notice};
pub use document::MeasuringDocument;
use drive::{Drive, RunEnd};

#[derive(Debug, clap::Args)]
#[command(after_help = examples(&[
    ("25 poses of a simulated robot", "tautline measure run.json --controller sim --robot mini --arm"),
    ("Until the cause is known or excluded", "tautline measure s.json --controller sim --robot mini --until cause=95% --arm"),
    ("An OPC UA controller and the poses of a plan; the session exists", "tautline measure cell.json --controller opc.tcp://plc --plan poses.csv --arm"),
]))]
pub struct Arguments {
    /// Session file to create or to continue
    #[arg(value_name = "SESSION")]
    session: PathBuf,
    #[command(flatten)]
    robot_arguments: RobotArguments,
    #[arg(long, value_name = "NAME|FILE", help = input::robot_help("Robot of a new session"))]
    robot: Option<String>,
    /// Session whose robot, plan and settings a new session adopts to measure a separate series, after the controller
    /// was restarted
    #[arg(long, value_name = "SESSION", conflicts_with = "robot")]
    series_of: Option<PathBuf>,
    /// Poses to measure, as a table pose,x_m,y_m,z_m,qw,qx,qy,qz; - is standard input
    #[arg(long, value_name = "FILE.csv")]
    plan: Option<PathBuf>,
    /// Number of poses to plan if there is no plan, without the home pose
    #[arg(long, value_name = "N", default_value_t = USUAL_POSES, value_parser = input::at_most(input::MOST_POSES))]
    poses: usize,
    /// Seed of the plan and of a new simulated robot
    #[arg(long, value_name = "SEED", default_value_t = 1)]
    seed: u64,
    #[command(flatten)]
    effects: HiddenEffects,
    #[command(flatten)]
    hypotheses: HypothesisFiles,
    /// Stop as soon as all coordinates of all entry points have standard deviations below this (mm)
    #[arg(long, value_name = "MM")]
    stop_at: Option<f64>,
    /// Decide on every next pose by what is known, until accuracy=0.3mm (all pulleys that accurate), cause=95% (it is known
    /// what is wrong, be it nothing) or fault-free=95% (no fault of typical size); may be repeated, until all are reached.
    /// With --plan, only its poses are measured
    #[arg(long, value_name = "GOAL", conflicts_with_all = ["stop_at", "poses"])]
    until: Vec<Goal>,
    /// Largest number of poses with --until, without the home pose
    #[arg(long, value_name = "N", default_value_t = AT_MOST, requires = "until", value_parser = input::at_most(input::MOST_POSES))]
    at_most: usize,
    /// Source of laser distances: controller, manual (typed at each pose), tcp:HOST:PORT or serial:PORT[:BAUD],
    /// both with ?pattern=..&unit=mm; stored in the session
    #[arg(long, value_name = "SOURCE")]
    laser: Option<LaserSettings>,
    /// Number of retries at a pose that cannot be measured before it is skipped
    #[arg(long, value_name = "N", default_value_t = 1)]
    retries: usize,
    #[command(flatten)]
    json: JsonOutput<MeasuringDocument>,
}

impl Arguments {
    /// The precision at which the run stops (m).
    fn stop_at_m(&self) -> Result<Option<f64>> {
        match self.stop_at {
            Some(mm) if !(mm.is_finite() && mm > 0.0) => Err(BadInput::new(format!(
                "--stop-at: found {mm}, expected a positive number of millimetres"
            ))),
            limit => Ok(limit.map(|mm| mm * 1e-3)),
        }
    }

    /// Rejects goals that no pose can serve.
    fn check_until(&self, choice: &ControllerChoice) -> Result<()> {
        if self.until.is_empty() {
            return Ok(());
        }
        if let ControllerChoice::Replay(folder) = choice {
            return Err(BadInput::new(format!(
                "--until: {} is a recording, which cannot go to new poses; expected a controller or sim",
                folder.display()
            )));
        }
        if self.at_most == 0 {
            return Err(BadInput::new(
                "--at-most: found 0, expected at least 1 pose",
            ));
        }
        Ok(())
    }

    /// The decisions for a session with its plan.
    fn until(&self, session: &Session) -> Result<Option<SequentialRun>> {
        if self.until.is_empty() {
            return Ok(None);
        }
        let request = UntilRequest {
            goals: self.until.clone(),
            at_most: self.at_most,
            seed: self.seed,
            among: (self.plan.as_ref()).map(|_| planned_poses(session)),
        };
        // The run asks again and again.
        let run = SequentialRun::start(session, request, || {});
        run.map(Some)
            .map_err(|error| BadInput::new(format!("no pose can be decided on: {error}")))
    }
}

pub fn run(arguments: &Arguments) -> Result<()> {
    let choice = arguments.robot_arguments.choice()?;
    let stop_at_m = arguments.stop_at_m()?;
    arguments.check_until(&choice)?;
    arguments
        .robot_arguments
        .require_arm("The robot was not moved")?;
    let is_new = Cell::new(false);
    let mut file = SessionFile::open_or_begin(
        &arguments.session,
        || {
            is_new.set(true);
            begin::session(arguments, &choice).map(Some)
        },
        &mut notice,
    )?;
    if !is_new.get() && !arguments.effects.is_empty() {
        let place = arguments.session.display();
        note!("{place}: continues with its own simulated robot; --effect is ignored");
    }
    let robot = arguments.robot.as_deref().filter(|_| !is_new.get());
    check(&file, robot, &choice)?;
    let link = &arguments.robot_arguments.link;
    link.take(&mut file.session, &choice)?;
    let laser = arguments
        .laser
        .as_ref()
        .unwrap_or(&file.session.laser_source);
    if *laser == LaserSettings::Manual {
        typed::require("The robot was not moved: the laser distances have to be typed")?;
    }
    plan::complete(&mut file.session, arguments, &choice)?;
    if let Some(laser) = &arguments.laser {
        file.session.laser_source = laser.clone();
    }
    let setup = ConnectionSetup::chosen(&file.session, &[], &choice, Some(&file.controller()));
    let mut connection = Connection::open(&setup, link, arguments.robot_arguments.speed)?;
    interrupt::listen()?;
    file.save()?;
    connection.arm()?;
    let stops = (stop_at_m, arguments.until(&file.session)?);
    let drive = Drive::new(&file.session, &setup, stops, arguments.retries);
    let ended = drive.run(&mut file, &mut connection)?;
    let lacking = lacking(&file.session);
    let document = MeasuringDocument::of(&file.session, &ended, lacking);
    arguments
        .json
        .deliver(&document, || document::print(&document, &arguments.session))?;
    result(&document, &ended, arguments)
}

/// Rejects a session that this command cannot continue; one that existed before belongs to `robot`, if that is given.
fn check(file: &SessionFile, robot: Option<&str>, choice: &ControllerChoice) -> Result<()> {
    let place = file.path.display();
    refuse_unsettled(&file.session, &place.to_string())?;
    require_simulated(&file.session, choice, &place.to_string())?;
    if let Some(robot) = robot {
        let asked = input::robot(robot)?.robot.name;
        let known = &file.session.robot.name;
        if asked != *known {
            return Err(BadInput::new(format!(
                "{place}: is a session of the robot \"{known}\", but --robot is \"{asked}\""
            )));
        }
    }
    Ok(())
}

/// Rejects --controller sim for a session of a real robot, for which simulated readings are meaningless.
pub fn require_simulated(session: &Session, choice: &ControllerChoice, place: &str) -> Result<()> {
    if *choice == ControllerChoice::Simulated && session.simulator.is_none() {
        return Err(BadInput::new(format!(
            "{place}: has no simulated robot, expected a --controller other than sim"
        )));
    }
    Ok(())
}

/// Refuses to move the robot while the controller may hold a mixture of old and new values.
pub fn refuse_unsettled(session: &Session, place: &str) -> Result<()> {
    match adjusting::unsettled(session) {
        None => Ok(()),
        Some(why) => Err(BadInput::new(format!(
            "{place}: {why}; run `tautline adjust` first, which settles it"
        ))),
    }
}

/// Reason why the poses measured so far do not determine the robot; `None` if they do: even without the drawing, which counts
/// as one reading per parameter, there are more readings than unknowns, and no parameter remains undetermined.
fn lacking(session: &Session) -> Option<String> {
    let quiet = &mut |_: &_| tautline_core::estimation::Control::Continue;
    let Identification { solution, open, .. } = match identify_session(session, quiet) {
        Ok(identified) => identified,
        Err(error) => return Some(format!("the robot cannot be identified: {error}")),
    };
    if let Some(defect) = open.first() {
        return Some(format!(
            "they leave open: {}",
            defect.sentence.trim_end_matches('.')
        ));
    }
    if !solution.converged() {
        return Some("the identification does not converge with them".to_owned());
    }
    let parameters = solution.parameters.len() as f64;
    let redundant = solution.degrees_of_freedom;
    let poses = session.measurements.labels.len().max(1) as f64;
    // All parameters have a prior, so that each pose adds its share of the redundancy.
    let more = (poses * (parameters + 1.0 - redundant) / redundant.max(1.0))
        .ceil()
        .min(1e3);
    (redundant <= parameters).then(|| {
        format!(
            "they give {redundant:.0} more readings than unknowns, expected more than the {parameters:.0} parameters that the \
             drawing states: measure about {more:.0} poses more"
        )
    })
}

fn result(
    document: &MeasuringDocument,
    ended: &drive::RunOutcome,
    arguments: &Arguments,
) -> Result<()> {
    let on_disk = count(document.measured.len(), "pose");
    let place = arguments.session.display();
    match &ended.end {
        RunEnd::Interrupted => Err(anyhow!(
            "Stopped by the operator: {place} has {on_disk}; the same command continues"
        )),
        RunEnd::Failed(why) if ended.restarted => Err(anyhow!(
            "{} {place} has {on_disk}; measure another series with --series-of {place}",
            ensure_full_stop(why)
        )),
        RunEnd::Failed(why) => Err(anyhow!(
            "{} {place} has {on_disk}; the same command continues",
            ensure_full_stop(why)
        )),
        RunEnd::NotTyped(why) => Err(BadInput::new(format!(
            "{} {place} has {on_disk}; the same command continues",
            ensure_full_stop(why)
        ))),
        RunEnd::Finished | RunEnd::GoodEnough | RunEnd::Decided(_) => match &document.lacking {
            None => require_goals(document, &place.to_string()),
            Some(lacking) => Err(anyhow!(
                "{place} has {on_disk}, not enough to identify the robot: {lacking}"
            )),
        },
    }
}

fn ensure_full_stop(text: &str) -> String {
    format!("{}.", text.trim_end_matches('.'))
}

/// Adds an entry on the run to the session's log.
fn log(file: &mut SessionFile, ended: &drive::RunOutcome) {
    let text = format!(
        "Measured {} by command{}.",
        count(ended.measured.len(), "pose"),
        match &ended.end {
            RunEnd::Finished => String::new(),
            RunEnd::GoodEnough => ", precision reached".to_owned(),
            RunEnd::Decided(why) => format!(", {why}"),
            RunEnd::Interrupted => ", then stopped by the operator".to_owned(),
            RunEnd::Failed(why) | RunEnd::NotTyped(why) =>
                format!(", then it failed: {}", why.trim_end_matches('.')),
        }
    );
    file.log(Phase::Poses, text);
}

/// Fails if a goal of --until is not reached.
fn require_goals(document: &MeasuringDocument, place: &str) -> Result<()> {
    let goals = document.until.iter().flat_map(|until| &until.goals);
    let open: Vec<String> = goals
        .filter(|goal| !goal.reached)
        .map(|goal| goal.goal.clone())
        .collect();
    if open.is_empty() {
        return Ok(());
    }
    Err(anyhow!(
        "{place} has {}, and {} is not reached",
        count(document.measured.len(), "pose"),
        list(&open)
    ))
}
