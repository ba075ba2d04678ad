//! `tautline import`.

mod report;

use std::cell::RefCell;
use std::path::{Path, PathBuf};

use anyhow::Result;
use tautline_channels::{HAS_MORE_FORMATS, MemoryBudget, Source};
use tautline_core::robot::Robot;
use tautline_files::ReadError;
use tautline_import::{
    AngleOrder, Assignment, ImportDocument, ImportError, Imported, Recipe, align_clocks,
    arrange_per_cable, channel_names, import, import_corrected, is_robot_description,
    propose_around, read_robot_description, read_sources,
};
use tautline_session::{
    Loaded, VersionedFile, read_robot, versioned, write_robot, write_text, write_versioned,
};

use crate::examples::examples;
use crate::input::{self, noticed};
use crate::output::{JsonOutput, confirm, is_standard, note, write_json, write_model};
use crate::progress::ProgressLine;
use crate::replace::{OutputFile, permit};
use crate::{BadInput, standard_input};

/// Name of the recipe that is stored beside the poses.
const RECIPE: &str = "recipe.json";
const ROBOT: &str = "robot.json";
const POSES: &str = "poses.csv";

#[derive(Debug, clap::Args)]
#[command(after_help = examples(&[
    ("What a log holds, and what would become of it", "tautline import log.csv --robot mini --channels"),
    ("A log and a recording of cameras, to a dataset", "tautline import log.csv capture.csv --robot robot.json -o cell"),
    ("With the mistakes corrected that the check reports", "tautline import log.csv --robot mini -o cell --apply-suggestions"),
    ("The robot of a Hangprinter's firmware", "tautline import config.g -o robot.json"),
    ("The robot whose pulleys a sheet lists, to a folder", "tautline import pulleys.xlsx -o cell"),
]))]
pub struct Arguments {
    #[arg(value_name = "SOURCE", required = true, help = sources_help())]
    sources: Vec<PathBuf>,
    /// Recipe that assigns channels to quantities; - is standard input; without it, one is proposed from names, units and ranges
    #[arg(long, value_name = "FILE")]
    recipe: Option<PathBuf>,
    /// Assigns a channel to a column of poses.csv, as in "rev_{i}=theta(:,{i}) [rad]", or "length_{i}_m=belt_{tl,tr,br,bl} [mm]" for channels with names; the rest is proposed, or the recipe's
    #[arg(long, value_name = "COLUMN=CHANNEL [UNIT]")]
    set: Vec<String>,
    /// Axes of the angles of commanded and measured poses: R = R1 R2 R3, each about an axis of the turned frame, as in zyx
    #[arg(long, value_name = "ORDER")]
    angles: Option<AngleOrder>,
    #[arg(long, value_name = "NAME|FILE", help = input::robot_help("Robot, by default the robot.json in the folder"))]
    robot: Option<String>,
    /// Dataset folder to write, or the robot.json if the sources describe a robot
    #[arg(
        short,
        long,
        value_name = "FOLDER",
        required_unless_present = "channels"
    )]
    out: Option<OutputFile>,
    /// Only list the channels and the proposed recipe
    #[arg(long)]
    channels: bool,
    /// Write the recipe that was used or proposed; - is standard output
    #[arg(long, value_name = "FILE")]
    recipe_out: Option<OutputFile>,
    /// Apply the suggestions of the data check to the recipe: units, signs, swapped channels, steps, jumps, dead channels
    #[arg(long)]
    apply_suggestions: bool,
    /// The mass in robot.json was weighed: with --apply-suggestions, it may correct the unit of the forces
    #[arg(long, requires = "apply_suggestions")]
    weighed: bool,
    /// Estimate offset and drift of the clocks of further recorders from the motion that both recorded
    #[arg(long)]
    align_clocks: bool,
    /// Largest memory for decoded content (GiB), as a small file can hold much
    #[arg(long, value_name = "GIB", default_value_t = 2.0)]
    memory_limit: f64,
    #[command(flatten)]
    json: JsonOutput<ImportDocument>,
}

/// Help on the formats that are read, and advice for those that this build leaves out.
fn sources_help() -> String {
    let (more, left_out) = match HAS_MORE_FORMATS {
        true => (", .h5, .mcap, .bag", ""),
        false => (
            "",
            "; this build leaves out .h5, .mcap, .bag and MATLAB 7.3: build it with --features more-formats",
        ),
    };
    format!(
        "Files or folders with readings: CSV, TwinCAT Scope, Motive, Nexus, point lists, .c3d, .mat, .npy, .npz, .parquet, .lvm, .tdms, \
         .mf4, .xlsx, .ods{more}; or a robot description: config.g of a Hangprinter, printer.cfg of Klipper with winches, maslow.yaml, MJCF of MuJoCo, URDF, SDF, yaml of cdpr, cables and \
         bodies of CASPR, a model of WireX, a table of the places of the pulleys{left_out}"
    )
}

pub fn run(arguments: &Arguments) -> Result<()> {
    if describes_robot(&arguments.sources)? {
        return robot_description(arguments);
    }
    // Checked before a long log is read.
    if let (Some(folder), false) = (&arguments.out, arguments.channels) {
        permit(&folder.join(POSES), &[])?;
        permit(&folder.join(RECIPE), &[Recipe::FORMAT])?;
    }
    let robot = robot(arguments)?;
    let budget = budget(arguments)?;
    let mut sources = noticed(read(&arguments.sources, &budget)?);
    arrange_per_cable(&mut sources, robot.robot.cable_count());
    let (mut recipe, name, assumptions) = recipe(arguments, &sources, &robot.robot)?;
    if let Some(order) = arguments.angles {
        recipe.order_angles(order);
    }
    if arguments.align_clocks {
        let clocks = align_clocks(&sources, &mut recipe, &robot.robot)?;
        for clock in &clocks {
            note!("{}", clock.sentence);
        }
    }
    if arguments.channels {
        let document = tautline_import::found(&sources, &recipe, &name, &robot.robot)?;
        return deliver(arguments, document, assumptions);
    }
    let imported = match arguments.apply_suggestions {
        true => {
            let is_weighed = arguments.weighed;
            import_corrected(
                &sources,
                &recipe,
                &name,
                &robot.robot,
                (is_weighed, &budget),
            )
        }
        false => import(&sources, &recipe, &name, &robot.robot, &budget),
    };
    let Imported {
        poses_csv,
        document,
        ..
    } = match (imported, &assumptions) {
        (Ok(imported), _) => imported,
        (Err(error), None) => return Err(BadInput::new(error)),
        (Err(error), Some(_)) => return proposal_failed(arguments, &error, &recipe, &sources),
    };
    if let Some(folder) = &arguments.out {
        write(folder, &robot, &poses_csv, &document.recipe)?;
    }
    deliver(arguments, document, assumptions)
}

/// The memory for the import.
fn budget(arguments: &Arguments) -> Result<MemoryBudget> {
    const GIB: f64 = 1_073_741_824.0;
    let limit = arguments.memory_limit;
    if !(limit.is_finite() && limit > 0.0) {
        let message = format!("--memory-limit: found {limit}, expected a positive number of GiB");
        return Err(BadInput::new(message));
    }
    Ok(MemoryBudget::new((limit * GIB) as u64))
}

/// Fails with the channels of the files and how to assign them; the proposed recipe is written if it was asked for.
fn proposal_failed(
    arguments: &Arguments,
    error: &ImportError,
    recipe: &Recipe,
    sources: &[Source],
) -> Result<()> {
    let recipe_out = match &arguments.recipe_out {
        Some(path) => {
            write_json(path, &versioned(recipe))?;
            format!("edit {}", path.display())
        }
        None => "write a recipe with --recipe-out FILE".to_owned(),
    };
    let message = format!(
        "{error}; found the channels {} (--channels lists them): assign them with --set \"rev_{{i}}=CHANNEL [UNIT]\", or {recipe_out}",
        channel_names(sources)
    );
    Err(BadInput::new(message))
}

/// Reads the sources with progress on the terminal; an interrupt ends the program.
fn read(sources: &[PathBuf], budget: &MemoryBudget) -> Result<Loaded<Vec<Source>>, ReadError> {
    let progress = RefCell::new(ProgressLine::new());
    read_sources(sources, budget, &|part| {
        let text = || format!("reading: {:.0} %", 100.0 * part);
        progress.borrow_mut().show(text);
        true
    })
}

/// Whether all sources are robot descriptions. The reader of readings rejects a mixture.
fn describes_robot(sources: &[PathBuf]) -> Result<bool> {
    for source in sources {
        if source.is_dir() || !is_robot_description(source)? {
            return Ok(false);
        }
    }
    Ok(true)
}

fn robot_description(arguments: &Arguments) -> Result<()> {
    let Some(out) = &arguments.out else {
        return Err(BadInput::new(
            "--out: not given, expected the robot.json to write",
        ));
    };
    let is_folder = out.is_dir() || out.extension().is_none() && !is_standard(out);
    let out = if is_folder {
        create_folder(out)?;
        out.join(ROBOT)
    } else {
        out.to_path_buf()
    };
    permit(&out, &[])?;
    let robot = noticed(read_robot_description(&arguments.sources)?);
    write_model(&out, &robot)?;
    confirm!(
        "{}: {} with {} cables",
        out.display(),
        robot.name,
        robot.cable_count()
    );
    Ok(())
}

/// The robot, and the file from which it is copied.
struct RobotToUse {
    robot: Robot,
    is_in_folder: bool,
}

fn robot(arguments: &Arguments) -> Result<RobotToUse> {
    let in_folder = arguments
        .out
        .as_ref()
        .map(|folder| folder.join(ROBOT))
        .filter(|path| path.exists());
    match (&arguments.robot, in_folder) {
        (Some(name), in_folder) => {
            let robot = input::robot(name)?.robot;
            if let Some(path) = &in_folder
                && noticed(read_robot(path)?) != robot
            {
                let message = format!(
                    "{}: differs from --robot {name}, expected the same robot or an empty folder",
                    path.display()
                );
                return Err(BadInput::new(message));
            }
            Ok(RobotToUse {
                robot,
                is_in_folder: in_folder.is_some(),
            })
        }
        (None, Some(path)) => Ok(RobotToUse {
            robot: noticed(read_robot(&path)?),
            is_in_folder: true,
        }),
        (None, None) => {
            let message = "--robot: not given, expected the robot that was measured, or -o FOLDER with its robot.json";
            Err(BadInput::new(message))
        }
    }
}

/// The recipe, its name for messages, and the assumptions of a proposed one.
fn recipe(
    arguments: &Arguments,
    sources: &[Source],
    robot: &Robot,
) -> Result<(Recipe, String, Option<Vec<String>>)> {
    let set = arguments.set.iter();
    let set = set.map(|text| Assignment::parse_each(text, sources));
    let set: Vec<Vec<Assignment>> = set
        .collect::<Result<_, String>>()
        .map_err(|message| BadInput::new(format!("--set: {message}")))?;
    let set = set.concat();
    match &arguments.recipe {
        Some(path) => {
            let mut recipe = noticed(standard_input::versioned::<Recipe>(path)?);
            recipe.channels.extend(set);
            Ok((recipe, path.display().to_string(), None))
        }
        None => {
            let (recipe, assumptions) = propose_around(sources, robot, set);
            Ok((recipe, "the proposed recipe".into(), Some(assumptions)))
        }
    }
}

fn create_folder(folder: &Path) -> Result<()> {
    std::fs::create_dir_all(folder).map_err(|error| {
        BadInput::new(format!("{}: cannot be created ({error})", folder.display()))
    })
}

fn write(folder: &Path, robot: &RobotToUse, poses_csv: &str, recipe: &Recipe) -> Result<()> {
    create_folder(folder)?;
    if !robot.is_in_folder {
        write_robot(&folder.join(ROBOT), &robot.robot)?;
    }
    write_text(&folder.join(POSES), poses_csv)?;
    write_versioned(&folder.join(RECIPE), recipe)?;
    Ok(())
}

fn deliver(
    arguments: &Arguments,
    mut document: ImportDocument,
    assumptions: Option<Vec<String>>,
) -> Result<()> {
    if let Some(assumptions) = assumptions {
        document.proposed = true;
        document.notices.extend(assumptions);
    }
    if let Some(path) = &arguments.recipe_out {
        write_json(path, &versioned(&document.recipe))?;
    }
    for notice in &document.notices {
        note!("{notice}");
    }
    arguments.json.deliver(&document, || {
        report::print(&document, arguments.channels);
        if let (Some(folder), false) = (&arguments.out, arguments.channels) {
            confirm!(
                "{}: {} poses, and the recipe",
                folder.join(POSES).display(),
                document.poses.len()
            );
        }
    })
}
