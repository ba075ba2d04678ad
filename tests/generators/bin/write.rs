//! Validation tables: each on its own, or all of them into docs/validation. Also the sample sessions
//! and the screenshots.

mod arguments;
mod hidden;

use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, bail, ensure};
use tautline_validation::generators::{
    gallery, hypotheses, random_runs, screenshots, sessions, your_data,
};
use tautline_validation::support::ads::Protocol;
use tautline_validation::support::window;
use tautline_validation::tables::motion::Late;
use tautline_validation::tables::{
    adjusted, certificate, damaged_files, field, formulas, hangprinter, health, hypothesis_files,
    isolability, kills, live_readings, lives, many_poses, markdown, motion, nist, random_robots,
    soak, study_speed, table1, tolerances, truth, until, which_sensor,
};

use arguments::Arguments;

/// Seed of the first random run.
const RUNS_SEED: u64 = 49_000;
/// Tables that `write` writes; that of `hidden all` has another name.
const WRITTEN: [&str; 14] = [
    "nist",
    "truth",
    "table1",
    "adjusted",
    "motion",
    "isolability",
    "lives",
    "health",
    "formulas",
    "hypothesis-files",
    "until",
    "hidden-effects",
    "clean-robots",
    "certificate",
];

const USAGE: &str = "expected one of: truth [DATA_SETS], table1, adjusted, many-poses [POSES], live-readings [SECONDS], soak [POSES], kills [RUNS], \
             damaged-files [FILES], hangprinter [FOLDER], isolability, motion [RECORDINGS [DIAGNOSED]], tolerances [MACHINES], \
             clean-robots [ROBOTS [FIRST_SEED]], certificate [ROBOTS [FIRST_SEED]], over-poses [POSES], field {exact | rough} [EACH [FIRST_SEED]], \
             lives [LIVES], health [ROBOTS], formulas [DATA_SETS], hypothesis-files [DATA_SETS [FIRST_SEED]], until [ROBOTS [FIRST_SEED]], nist, \
             hidden KIND, studies [FIRST_DATA_SETS], all of these with [--records FILE]; workbench [write | PART], which-sensor [write], \
             study-speed [write | CALIBRATIONS], write [FOLDER], sessions [FOLDER], screenshots [FOLDER], looks FOLDER [PART OF A NAME], \
             your-data, gallery, hypotheses, random-runs PROGRAM FOLDER [RUNS]";

fn main() -> Result<()> {
    let arguments = Arguments::new(std::env::args().skip(1)).context(USAGE)?;
    let argument = arguments.word(1);
    match arguments.word(0).context(USAGE)? {
        "workbench" => workbench(argument)?,
        "hidden" => hidden::command(&arguments)?,
        "studies" => studies(&arguments)?,
        "which-sensor" => which_sensor_tables(argument)?,
        "study-speed" => study_speed(argument)?,
        "write" => write(argument)?,
        "hypotheses" => hypotheses::write()?,
        "random-runs" => random_runs(&arguments)?,
        "your-data" => your_data::write()?,
        "gallery" => gallery::write(&gallery::folder())?,
        "sessions" => sessions::write_all(argument.map_or(sessions::folder(), Path::new))?,
        "screenshots" => {
            screenshots::write_all(argument.map_or(screenshots::folder(), Path::new))?;
        }
        "looks" => {
            let folder = argument.context("looks: the folder to write to is missing")?;
            screenshots::looks::write_all(Path::new(folder), arguments.word(2))?;
        }
        name => println!("{}", table(name, &arguments)?),
    }
    Ok(())
}

/// The table that a command prints.
fn table(name: &str, given: &Arguments) -> Result<String> {
    match name {
        "truth" => given.table(name, &truth::Truth(given.seeds(16_000, truth::FIRST_SEED)?)),
        "table1" => Ok(table1::markdown(&table1::study(10)?)),
        "adjusted" => given.table(name, &adjusted::Adjusted::new()?),
        "many-poses" => {
            let taken = many_poses::identify(given.number(1, 1_000_000)?)?;
            Ok(many_poses::markdown(&taken))
        }
        "live-readings" => {
            let delivered = live_readings::study(given.number(1, 20.0)?)?;
            Ok(live_readings::markdown(&delivered))
        }
        "soak" => Ok(soak::markdown(&soak::study(
            given.number(1, 2000)?,
            soak::SEED,
        )?)),
        "kills" => kills_table(given.number(1, 50)?),
        "damaged-files" => damaged_files_table(given.number(1, 1000)?),
        "hangprinter" => hangprinter_table(given.word(1)),
        "isolability" => Ok(isolability::markdown(&isolability::study(
            isolability::STUDY,
        )?)),
        "motion" => motion_tables(given),
        "tolerances" => {
            let machines = given.number(1, 60)?;
            given.table(name, &tolerances::Tolerances { machines })
        }
        "clean-robots" => {
            let seeds = given.seeds(2000, random_robots::FIRST_SEED)?;
            given.table(name, &random_robots::CleanRobots(seeds))
        }
        "certificate" => {
            let seeds = given.seeds(2000, certificate::FIRST_SEED)?;
            given.table(name, &certificate::Certificate(seeds))
        }
        "over-poses" => {
            let poses = match given.word(1) {
                Some(_) => vec![given.number(1, 0)?],
                None => random_robots::NUMBERS_OF_POSES.to_vec(),
            };
            given.table(name, &random_robots::OverPoses(poses))
        }
        "field" => given.table(name, &field_study(given)?),
        "lives" => given.table(name, &lives::Lives(given.seeds(300, lives::FIRST_SEED)?)),
        "health" => given.table(name, &health::Health(given.seeds(250, health::FIRST_SEED)?)),
        "formulas" => {
            let seeds = given.seeds(100, formulas::FIRST_SEED)?;
            given.table(name, &formulas::Formulas(seeds))
        }
        "hypothesis-files" => {
            let study = hypothesis_files::HypothesisFiles {
                first: given.number(1, usize::MAX)?,
                first_seed: given.number(2, hypothesis_files::FIRST_SEED)?,
            };
            given.table(name, &study)
        }
        "until" => {
            let seeds = given.seeds(300, until::FIRST_SEED)?;
            given.table(name, &until::Until::new(seeds)?)
        }
        "nist" => Ok(nist::markdown(&nist::study()?)),
        "hidden-effects" => hidden::tables(),
        _ => bail!(USAGE),
    }
}

/// Kills so many measuring runs and adjustments over each protocol; what should not have happened goes to standard error.
fn kills_table(runs: usize) -> Result<String> {
    let mut all = Vec::new();
    for protocol in [Protocol::Ads, Protocol::OpcUa, Protocol::OpcUaEncrypted] {
        let kills = kills::study(protocol, runs, kills::SEED)?;
        for fault in &kills.faults {
            eprintln!("{protocol:?}: {fault}");
        }
        all.push(kills);
    }
    Ok(kills::markdown(&all))
}

/// Reads so many damaged files; panics, aborts and time limits go to standard error.
fn damaged_files_table(files: usize) -> Result<String> {
    let outcomes = damaged_files::study(files, damaged_files::SEED)?;
    for fault in outcomes.values().flat_map(|outcome| &outcome.faults) {
        eprintln!("{fault}");
    }
    Ok(damaged_files::markdown(&outcomes))
}

/// Identifies so many recordings of each robot, and asks the doctor about so many.
fn motion_tables(given: &Arguments) -> Result<String> {
    let first = motion::FIRST_SEED;
    let recordings = given.number(1, 300)?;
    let asked = motion::AskedInMotion {
        seeds: first..first + given.number(2, recordings)?,
        recording: motion::RECORDING,
    };
    let identified = motion::Motion {
        lates: &[Late::Instrument, Late::Forces],
        seeds: first..first + recordings,
    };
    let identified = given.table("motion", &identified)?;
    Ok(format!(
        "{identified}\n{}",
        given.table("motion-asked", &asked)?
    ))
}

fn field_study(given: &Arguments) -> Result<field::Field> {
    let kind = given.word(1);
    ensure!(matches!(kind, Some("exact" | "rough")), USAGE);
    Ok(field::Field {
        is_rough: kind == Some("rough"),
        each: given.number(2, 40)?,
        first_seed: given.number(3, field::FIRST_SEED)?,
    })
}

fn hangprinter_table(folder: Option<&str>) -> Result<String> {
    let folder = folder.unwrap_or("../shared/data/hangprinter");
    let table = hangprinter::markdown(&hangprinter::study(folder.as_ref())?);
    let opinion = hangprinter::opinion(folder.as_ref())?;
    Ok(format!(
        "{table}\n{}",
        hangprinter::opinion_markdown(&opinion)
    ))
}

/// Speed of the window; only on request, because nothing else may run on the machine at the same time.
fn workbench(what: Option<&str>) -> Result<()> {
    if let Some(part) = what.filter(|what| *what != "write") {
        println!("{}", window::speed::part(part)?);
        return Ok(());
    }
    let table = window::speed::measure()?;
    println!("{table}");
    if what == Some("write") {
        save("validation/workbench", &table)?;
    }
    Ok(())
}

/// Writes the table of the studies of hidden effects, or of their first data sets, and the diagram that the page shows.
fn studies(given: &Arguments) -> Result<()> {
    let (table, diagram) = hidden::studies(given)?;
    save("validation/hidden-studies", &table)?;
    tautline_session::write_text(&document().with_file_name("reliability.svg"), &diagram)?;
    Ok(())
}

/// The studies of the documentation, printed, or written to docs/which-sensor.
fn which_sensor_tables(what: Option<&str>) -> Result<()> {
    for name in ["mini", "suspended-15m", "size"] {
        let (plan, result) = which_sensor::study(name)?;
        let table = which_sensor::markdown(&plan, &result)?;
        println!("{table}");
        if what == Some("write") {
            save(&format!("which-sensor/{name}"), &table)?;
        }
    }
    Ok(())
}

/// Speed and memory of studies, printed, or put into docs/STUDIES.md; nothing else may run on the machine at the same time.
fn study_speed(what: Option<&str>) -> Result<()> {
    let is_written = what == Some("write");
    let calibrations = what.filter(|_| !is_written);
    let table = study_speed::table(calibrations.map_or(Ok(1_000_000), str::parse)?)?;
    println!("{table}");
    if is_written {
        let path = document().with_file_name("STUDIES.md");
        let mut text = fs::read_to_string(&path).context("docs/STUDIES.md")?;
        replace(&mut text, "speed", &table)?;
        tautline_session::write_text(&path, &text)?;
    }
    Ok(())
}

/// Documents of random runs of a program, to be compared by `diff --recursive`.
fn random_runs(given: &Arguments) -> Result<()> {
    let [program, folder] = [1, 2].map(|place| given.word(place).map(Path::new));
    let runs = given.number(3, 200)?;
    random_runs::write(
        program.context(USAGE)?,
        folder.context(USAGE)?,
        runs,
        RUNS_SEED,
    )
}

fn document() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/VALIDATION.md")
}

/// Writes every table to its file in docs/validation. The Hangprinter's stays as it is where its data
/// are absent.
fn write(folder: Option<&str>) -> Result<()> {
    for name in WRITTEN {
        let table = table(name, &Arguments::default())?;
        save(&format!("validation/{name}"), &table)?;
    }
    match hangprinter_table(folder) {
        Ok(table) => save("validation/hangprinter", &table)?,
        Err(error) => eprintln!("the table of the Hangprinter stays as it was: {error:#}"),
    }
    Ok(())
}

/// Writes a table to docs/NAME.txt, below the description at its beginning.
fn save(name: &str, table: &str) -> Result<()> {
    let path = document().with_file_name(format!("{name}.txt"));
    let text = fs::read_to_string(&path).with_context(|| path.display().to_string())?;
    let (head, _) = text.split_once("\n\n").context("no blank line")?;
    tautline_session::write_text(
        &path,
        &format!("{head}\n\n{}\n", markdown::padded(table.trim())),
    )?;
    Ok(())
}

fn replace(text: &mut String, name: &str, table: &str) -> Result<()> {
    let (begin, end) = (
        format!("<!-- begin {name} -->\n"),
        format!("<!-- end {name} -->"),
    );
    let start = text
        .find(&begin)
        .with_context(|| format!("no mark {begin}"))?
        + begin.len();
    let stop = text.find(&end).with_context(|| format!("no mark {end}"))?;
    text.replace_range(start..stop, &format!("\n{}\n\n", table.trim()));
    Ok(())
}
