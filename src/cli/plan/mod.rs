//! `tautline plan`.

mod check_against;
mod goal;
mod report;

use std::path::{Path, PathBuf};

use crate::BadInput;
use anyhow::Result;
use tautline_core::estimation::Control;
use tautline_core::planning::{Goal, Plan, PlanError, PlanOptions, USUAL_POSES, plan};
use tautline_core::robot::Robot;
use tautline_workflow::health;

use crate::effect_arguments::EstimatedEffects;
use crate::examples::examples;
use crate::hypothesis_arguments::HypothesisFiles;
use crate::input;
use crate::output::{JsonOutput, confirm, say, write_file};
use crate::replace::OutputFile;
use check_against::Detect;
use goal::GoalName;
use tautline_workflow::isolability::IsolabilityDocument;
use tautline_workflow::planning::{HomeGain, PlanDocument, tape_gain};

#[derive(Debug, clap::Args)]
#[command(after_help = examples(&[
    ("20 poses of the MINI robot, as a table for measure", "tautline plan mini --poses 20 -o poses.csv"),
    ("Eight poses that show whether the robot is still as it was", "tautline plan --check-against mini --detect 2mm -o health.csv"),
    ("Which faults 12 poses reveal, and which look alike", "tautline plan planar --poses 12 --for faults --explain"),
    ("The most accurate platform in a volume", "tautline plan mini --for accuracy --volume -0.1,0.1,-0.1,0.1,-0.1,0.1"),
]))]
pub struct Arguments {
    #[arg(value_name = "NAME|FILE", required_unless_present = "check_against", help = input::robot_help("Robot"))]
    robot: Option<String>,
    /// Number of poses, without the home pose; 25, for a check 8
    #[arg(long, value_name = "N", value_parser = input::at_most(input::MOST_POSES))]
    poses: Option<usize>,
    /// Session or dataset folder of a calibration: plan the few poses that best show whether its robot has changed
    #[arg(long, value_name = "DATASET|SESSION", conflicts_with_all = ["robot", "volume"])]
    check_against: Option<PathBuf>,
    /// What a check is to detect: a move of a pulley such as 2mm, or faults
    #[arg(long, value_name = "MOVE|faults")]
    detect: Option<String>,
    /// Number of feasible poses to choose from
    #[arg(long, value_name = "N", default_value_t = 3000, value_parser = input::at_most(input::MOST_SIMULATED))]
    candidates: usize,
    /// Seed of the random poses
    #[arg(long, value_name = "SEED", default_value_t = 1)]
    seed: u64,
    /// Goal of the poses: standard deviations of the geometry, detecting and separating faults, both, or the
    /// position of the platform in a volume
    #[arg(long = "for", value_enum, value_name = "GOAL", default_value_t = GoalName::Geometry)]
    goal: GoalName,
    /// Box in which the robot is to be accurate: X0,X1,Y0,Y1,Z0,Z1 (m); with --for accuracy
    #[arg(long, value_name = "BOX", allow_hyphen_values = true)]
    volume: Option<String>,
    /// Also print which faults the poses would reveal and which of them could be confused
    #[arg(long)]
    explain: bool,
    #[command(flatten)]
    effects: EstimatedEffects,
    #[command(flatten)]
    hypotheses: HypothesisFiles,
    /// Write the poses, in the order of measurement, as a table; - is standard output
    #[arg(short, long, value_name = "FILE.csv")]
    out: Option<OutputFile>,
    #[command(flatten)]
    json: JsonOutput<PlanDocument>,
}

pub fn run(arguments: &Arguments) -> Result<()> {
    let (out, json) = (arguments.out.as_deref(), &arguments.json);
    let goal = goal::goal(arguments.goal, arguments.volume.as_deref())?;
    let detect = arguments.detect.as_deref().map(check_against::detect);
    let detect = detect.transpose()?;
    if detect.is_some() && arguments.check_against.is_none() {
        return Err(BadInput::new(
            "--detect: expected only with --check-against",
        ));
    }
    let (robot, planned, detection) = match &arguments.check_against {
        Some(path) => {
            let poses = arguments.poses.unwrap_or(health::POSES);
            let options = PlanOptions {
                candidates: arguments.candidates,
                goal,
                ..PlanOptions::new(poses, arguments.seed)
            };
            let check = check_against::plan(path, options, detect)?;
            (check.robot, check.planned, check.detection)
        }
        None => {
            let (robot, planned) = calibration(arguments, goal)?;
            (robot, planned, Vec::new())
        }
    };
    if let Some(path) = out {
        write_poses(path, &planned)?;
    }
    let mut document = PlanDocument::of(&robot, &planned);
    document.detection = detection;
    if arguments.explain || detect == Some(Detect::Faults) {
        let isolability = IsolabilityDocument::of_dataset(&planned.dataset);
        document.isolability = Some(isolability.map_err(BadInput::new)?);
    }
    json.deliver(&document, || {
        report::print(&document);
        if !document.detection.is_empty() {
            check_against::print(&document.detection);
        }
        let home = HomeGain::of(&planned).sentence();
        let tape = tape_gain(&planned, |place| planned.poses[place].label);
        home.into_iter()
            .chain(tape)
            .for_each(|sentence| say!("{sentence}"));
        if let Some(path) = out {
            confirm!("the poses are in {}", path.display());
        }
    })
}

/// The poses of a calibration.
fn calibration(arguments: &Arguments, goal: Goal) -> Result<(Robot, Plan)> {
    let name = arguments.robot.as_deref().unwrap_or_default();
    let mut robot = input::robot(name)?.robot;
    arguments.hypotheses.add_to(&mut robot)?;
    let effects = arguments.effects.bind(&robot)?;
    let options = PlanOptions {
        candidates: arguments.candidates,
        effects: &effects,
        goal,
        ..PlanOptions::new(arguments.poses.unwrap_or(USUAL_POSES), arguments.seed)
    };
    let planned = plan(&robot, &options, &mut |_| Control::Continue).map_err(|e| match e {
        PlanError::NoPoses => BadInput::new(format!("--poses: {e}")),
        PlanError::Cancelled => e.into(),
        _ => BadInput::new(format!("{name}: {e}")),
    })?;
    Ok((robot, planned))
}

/// `pose,x_m,y_m,z_m,qw,qx,qy,qz`.
fn write_poses(path: &Path, plan: &Plan) -> Result<()> {
    let mut text = "pose,x_m,y_m,z_m,qw,qx,qy,qz\n".to_owned();
    for planned in &plan.poses {
        let position: [f64; 3] = planned.pose.position.into();
        let numbers = position.into_iter().chain(planned.pose.orientation_wxyz());
        text.push_str(&planned.label.to_string());
        numbers.for_each(|number| text.push_str(&format!(",{number}")));
        text.push('\n');
    }
    write_file(path, text.as_bytes())
}
