//! `tautline simulate`.

mod motion;
mod phases;

use crate::BadInput;
use anyhow::Result;
use tautline_core::planning::USUAL_POSES;
use tautline_core::simulation::{
    SimulationError, SimulationOptions, TrueGeometry, record, simulate,
};
use tautline_session::{PhaseData, write_dataset, write_robot};

use crate::effect_arguments::HiddenEffects;
use crate::examples::examples;
use crate::hypothesis_arguments::HypothesisFiles;
use crate::input::{self, RobotSource};
use crate::output::confirm;
use crate::replace::{OutputFile, permit};
use crate::tolerances::TolerancesName;

#[derive(Debug, clap::Args)]
#[command(after_help = examples(&[
    ("25 poses of the MINI robot, with pulleys as they were measured", "tautline simulate --robot mini -o mini"),
    ("The same robot with a winch that pays out 2 % too much cable", "tautline simulate --robot mini --effect winch_scale:cable-3:scale=0.02 -o bad"),
    ("With the tables of the other phases", "tautline simulate --robot mini --phases -o phases"),
    ("Five seconds of motion, seen by an external instrument", "tautline simulate --robot mini --motion 5 --tracker -o motion"),
]))]
pub struct Arguments {
    #[arg(long, value_name = "NAME|FILE", help = input::robot_help("Robot to simulate"))]
    robot: String,
    /// Number of poses, without the home pose
    #[arg(long, value_name = "N", default_value_t = USUAL_POSES, value_parser = input::at_most(input::MOST_SIMULATED))]
    poses: usize,
    /// Seed of all random numbers
    #[arg(long, value_name = "SEED", default_value_t = 1)]
    seed: u64,
    #[command(flatten)]
    effects: HiddenEffects,
    #[command(flatten)]
    hypotheses: HypothesisFiles,
    /// True entry points: measured (those of the preset), drawn from the priors, or nominal
    #[arg(long, value_enum)]
    truth: Option<Truth>,
    #[command(flatten)]
    motion: motion::Motion,
    /// Draw the deviation of every part from these tolerances: those that the robot states, those of the catalogue, or none
    #[arg(long, value_enum, default_value_t = TolerancesName::Stated)]
    tolerances: TolerancesName,
    /// Simulate readings without noise
    #[arg(long)]
    no_noise: bool,
    /// Also write the tables of the other phases: winch, force, home, elongation and check
    #[arg(long)]
    phases: bool,
    /// Folder to write the dataset to
    #[arg(short, long, value_name = "DIR")]
    out: OutputFile,
}

/// File of the true robot.
const TRUTH: &str = "truth.json";
/// Files that may be written.
const FILES: [&str; 8] = [
    "robot.json",
    "poses.csv",
    "winch.csv",
    "force.csv",
    "home.csv",
    "elongation.csv",
    "check.csv",
    TRUTH,
];

#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
enum Truth {
    Measured,
    Drawn,
    Nominal,
}

pub fn run(arguments: &Arguments) -> Result<()> {
    let mut files = FILES.iter().map(|name| arguments.out.join(name));
    files.try_for_each(|file| permit(&file, &[]))?;
    let RobotSource { mut robot, machine } = input::robot(&arguments.robot)?;
    let described = robot.hypotheses.clone();
    arguments.hypotheses.add_to(&mut robot)?;
    arguments.motion.equip(&mut robot);
    arguments.tolerances.state(&mut robot);
    let measured = machine
        .as_ref()
        .and_then(|p| p.measured_entry_points_m.clone());
    let geometry = match (arguments.truth, measured) {
        (None | Some(Truth::Measured), Some(points)) => TrueGeometry::EntryPoints(points),
        (Some(Truth::Measured), None) => {
            let message = format!("robot \"{}\" has no measured entry points", arguments.robot);
            return Err(BadInput::new(message));
        }
        (Some(Truth::Nominal), _) => TrueGeometry::Nominal,
        _ => TrueGeometry::Drawn,
    };
    let options = SimulationOptions {
        geometry,
        effects: arguments.effects.settings(&robot)?,
        noise: !arguments.no_noise,
        ..SimulationOptions::new(arguments.poses, arguments.seed)
    };
    let failed = |error: SimulationError| match error {
        // An effect refers to something that does not exist.
        SimulationError::Effect(error) => BadInput::new(format!("--effect: {error}")),
        SimulationError::AtRest(_) => {
            BadInput::new(format!("--effect: {error} (--motion SECONDS)"))
        }
        other => other.into(),
    };
    let recording = arguments.motion.recording()?;
    let mut run = match &recording {
        Some(recording) => record(&robot, &options, recording),
        None => simulate(&robot, &options),
    }
    .map_err(failed)?;
    let phases = match arguments.phases {
        true => phases::tables(&mut run, &options).map_err(failed)?,
        false => PhaseData::default(),
    };
    // Only the true robot contains the hidden effects.
    run.dataset.robot.hypotheses = described;
    write_dataset(&arguments.out, &run.dataset, &phases)?;
    write_robot(&arguments.out.join(TRUTH), &run.truth)?;
    confirm!(
        "{}: {} {} of {} with {} cables, seed {}; the true robot is in truth.json",
        arguments.out.display(),
        run.dataset.measurements.len(),
        if recording.is_some() {
            "samples"
        } else {
            "poses"
        },
        run.dataset.robot.name,
        run.dataset.robot.cable_count(),
        arguments.seed
    );
    if arguments.phases {
        confirm!("and the tables of the other phases, for precalibrate and accuracy");
    }
    if let Some(machine) = machine {
        confirm!("assumed, not published: {}", machine.assumed);
    }
    Ok(())
}
