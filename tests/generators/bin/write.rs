//! Validation tables: each on its own, or all of them into docs/validation. Also the sample sessions
//! and the screenshots.

mod hidden;

use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, bail};
use tautline_validation::generators::{
    gallery, hypotheses, random_runs, screenshots, sessions, your_data,
};
use tautline_validation::support::ads::Protocol;
use tautline_validation::support::window;
use tautline_validation::tables::hidden::Records;
use tautline_validation::tables::motion::{Late, RECORDING};
use tautline_validation::tables::{
    adjusted, certificate, damaged_files, field, formulas, hangprinter, health, hypothesis_files,
    isolability, kills, live_readings, lives, many_poses, motion, nist, random_robots, soak,
    study_speed, table1, tolerances, truth, until, which_sensor,
};

/// Presets of the truth study.
const ROBOTS: [&str; 4] = ["mini", "hall", "suspended", "planar"];
/// Seed of the study of isolability.
const ISOLABILITY_SEED: u64 = 2027;
/// Seed of the first data set of the truth study.
const FIRST_SEED: u64 = 1000;
/// First seed of the machines whose parts deviate within tolerances, and the largest number of faults hidden in one.
const TOLERANCES_SEED: u64 = 40_000;
const MOST_FAULTS: usize = 4;
/// Seed of the first life.
const LIVES_SEED: u64 = 43_000;
/// Seed of the first data set with a hidden pattern.
const FORMULAS_SEED: u64 = 44_000;
/// Seed of the first data set with hypothesis files beside it.
const FILES_SEED: u64 = 47_000;
/// Seed of the first robot whose health is checked.
const HEALTH_SEED: u64 = 45_000;
/// Seed of the first random robot, and numbers of poses at which faults are looked for.
const ROBOTS_SEED: u64 = 48_000;
const NUMBERS_OF_POSES: [usize; 5] = [40, 160, 400, 1000, 2000];
/// Seed of the first random run.
const RUNS_SEED: u64 = 49_000;
/// Seed of the moments at which programs are killed.
const KILLS_SEED: u64 = 50_000;
/// Seed of the run of very many poses with faults.
const SOAK_SEED: u64 = 52_000;
/// Seed of the damage to files.
const DAMAGE_SEED: u64 = 51_000;
/// Seed of the first machine with a fault of the field.
const FIELD_SEED: u64 = 70_000;
/// Seed of the first robot that is measured until its fault is certain.
const UNTIL_SEED: u64 = 46_000;
/// Files of the outcomes of studies, from which an interrupted study continues.
const RECORDS: &str = "target/studies.jsonl";
const UNTIL_RECORDS: &str = "target/until.jsonl";
const FILES_RECORDS: &str = "target/hypothesis-files.jsonl";

const USAGE: &str = "expected one of: truth [DATA_SETS], table1, adjusted, many-poses [POSES], live-readings [SECONDS], soak [POSES], kills [RUNS [ads | none | encrypted]], damaged-files [FILES], hangprinter [FOLDER], isolability, motion [RECORDINGS [DIAGNOSED]], tolerances [MACHINES], clean-robots [ROBOTS [FIRST_SEED]], certificate [ROBOTS [FIRST_SEED]], over-poses [POSES], field {exact | rough} [EACH [FIRST_SEED [WHAT | all [FOLDER]]]], lives [LIVES], health [ROBOTS], formulas [DATA_SETS], hypothesis-files [DATA_SETS [FIRST_SEED]], until [ROBOTS [FIRST_SEED]], nist, hidden KIND, workbench [write | PART], \
             studies [FIRST_DATA_SETS], which-sensor [write], study-speed [write | CALIBRATIONS], write [FOLDER], sessions [FOLDER], screenshots [FOLDER], looks FOLDER [PART OF A NAME], \
             your-data, gallery, hypotheses, random-runs PROGRAM FOLDER [RUNS]";

fn main() -> Result<()> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let is_option = |argument: &String| argument.starts_with('-');
    // Only studies have options; elsewhere an option must not be taken for the name of a folder.
    if arguments.first().is_some_and(|first| first != "hidden") && arguments.iter().any(is_option) {
        bail!(USAGE);
    }
    let argument = arguments.get(1).map(String::as_str);
    match arguments.first().map(String::as_str) {
        Some("truth") => println!("{}", truth_table(argument)?),
        Some("table1") => println!("{}", table1::markdown(&table1::study(10)?)),
        Some("adjusted") => println!("{}", adjusted::markdown(&adjusted::study()?)),
        Some("many-poses") => {
            let poses = argument.map_or(Ok(1_000_000), str::parse)?;
            println!("{}", many_poses::markdown(&many_poses::identify(poses)?));
        }
        Some("live-readings") => {
            let seconds = argument.map_or(Ok(20.0), str::parse)?;
            println!(
                "{}",
                live_readings::markdown(&live_readings::study(seconds)?)
            );
        }
        Some("soak") => {
            let poses = argument.map_or(Ok(2000), str::parse)?;
            println!("{}", soak::markdown(&soak::study(poses, SOAK_SEED)?));
        }
        Some("kills") => println!("{}", kills_table(&arguments[1..])?),
        Some("damaged-files") => println!("{}", damaged_files_table(argument)?),
        Some("hangprinter") => println!("{}", hangprinter_table(argument)?),
        Some("isolability") => println!("{}", isolability_table()?),
        Some("motion") => println!("{}", motion_table(&arguments[1..])?),
        Some("tolerances") => println!("{}", tolerances_table(argument)?),
        Some("clean-robots") => println!("{}", clean_robots_table(&arguments[1..])?),
        Some("certificate") => println!("{}", certificate_table(&arguments[1..])?),
        Some("over-poses") => println!("{}", over_poses_table(argument)?),
        Some("field") => println!("{}", field_table(&arguments[1..])?),
        Some("formulas") => println!("{}", formulas_table(argument)?),
        Some("hypothesis-files") => println!("{}", files_table(&arguments[1..])?),
        Some("health") => println!("{}", health_table(argument)?),
        Some("lives") => println!("{}", lives_table(argument)?),
        Some("until") => println!("{}", until_table(&arguments[1..])?),
        Some("nist") => println!("{}", nist::markdown(&nist::table()?)),
        Some("workbench") => workbench(argument)?,
        Some("hidden") => hidden::command(&arguments[1..])?,
        Some("studies") => studies(argument)?,
        Some("which-sensor") => which_sensor_tables(argument)?,
        Some("study-speed") => study_speed(argument)?,
        Some("write") => write(argument)?,
        Some("hypotheses") => hypotheses::write()?,
        Some("random-runs") => random_runs(&arguments[1..])?,
        Some("your-data") => your_data::write()?,
        Some("gallery") => gallery::write(&gallery::folder())?,
        Some("sessions") => sessions::write_all(argument.map_or(sessions::folder(), Path::new))?,
        Some("screenshots") => {
            screenshots::write_all(argument.map_or(screenshots::folder(), Path::new))?;
        }
        Some("looks") => {
            let folder = argument.context("looks: the folder to write to is missing")?;
            screenshots::looks::write_all(Path::new(folder), arguments.get(2).map(String::as_str))?;
        }
        _ => bail!(USAGE),
    }
    Ok(())
}

/// Kills a number of measuring runs and adjustments over OPC UA, without security, encrypted or both; failures
/// go to standard error.
fn kills_table(arguments: &[String]) -> Result<String> {
    let runs = arguments.first().map_or(Ok(50), |runs| runs.parse())?;
    let protocols = match arguments.get(1).map(String::as_str) {
        None => vec![Protocol::Ads, Protocol::OpcUa, Protocol::OpcUaEncrypted],
        Some("ads") => vec![Protocol::Ads],
        Some("none") => vec![Protocol::OpcUa],
        Some("encrypted") => vec![Protocol::OpcUaEncrypted],
        Some(_) => bail!(USAGE),
    };
    let mut all = Vec::new();
    for protocol in protocols {
        let kills = kills::study(protocol, runs, KILLS_SEED)?;
        for fault in &kills.faults {
            eprintln!("{protocol:?}: {fault}");
        }
        all.push(kills);
    }
    Ok(kills::markdown(&all))
}

/// Reads a number of damaged files; panics, aborts and time limits go to standard error.
fn damaged_files_table(files: Option<&str>) -> Result<String> {
    let files = files.map_or(Ok(1000), str::parse)?;
    let outcomes = damaged_files::study(files, DAMAGE_SEED)?;
    for fault in outcomes.values().flat_map(|outcome| &outcome.faults) {
        eprintln!("{fault}");
    }
    Ok(damaged_files::markdown(&outcomes))
}

fn isolability_table() -> Result<String> {
    let pairs = isolability::study(30, 60, ISOLABILITY_SEED)?;
    Ok(isolability::markdown(&pairs))
}

/// Identifies a number of recordings of each robot, and diagnoses a number of them.
fn motion_table(numbers: &[String]) -> Result<String> {
    let number = |k: usize| numbers.get(k).map(|text| text.parse::<usize>());
    let recordings = number(0).unwrap_or(Ok(300))?;
    let asked = number(1).unwrap_or(Ok(recordings))?;
    let robots = ["mini", "planar"];
    let rows = [Late::Instrument, Late::Forces]
        .into_iter()
        .flat_map(|late| robots.map(|name| motion::study(name, late, recordings, FIRST_SEED)));
    let rows: Vec<_> = rows.collect::<Result<_>>()?;
    let doctor = robots.map(|name| motion::doctor_study(name, asked, FIRST_SEED, &RECORDING));
    let doctor: Vec<_> = doctor.into_iter().collect::<Result<_>>()?;
    for row in &doctor {
        eprintln!("{}, other causes named: {:?}", row.robot, row.others);
    }
    Ok(motion::markdown(&rows, &doctor))
}

/// Diagnoses a number of machines of each kind, all of whose parts deviate within tolerances, and as many exact ones.
fn formulas_table(sets: Option<&str>) -> Result<String> {
    let sets = sets.map_or(Ok(100), str::parse)?;
    Ok(formulas::markdown(&formulas::study(sets, FORMULAS_SEED)?))
}

/// The first data sets of the study of hypothesis files, or all of them, from a seed on.
fn files_table(numbers: &[String]) -> Result<String> {
    let number = |k: usize| numbers.get(k).map(|text| text.parse::<u64>()).transpose();
    let mut cases = hypothesis_files::cases(number(1)?.unwrap_or(FILES_SEED));
    let all = cases.len();
    cases.truncate(number(0)?.map_or(all, |first| first as usize));
    let records = Records::open(Path::new(FILES_RECORDS))?;
    let table = hypothesis_files::markdown(&hypothesis_files::study(&cases, &records)?);
    Ok(format!(
        "The first {} of {all} data sets.\n\n{table}",
        cases.len()
    ))
}

fn health_table(robots: Option<&str>) -> Result<String> {
    let robots = robots.map_or(Ok(250), str::parse)?;
    Ok(health::markdown(&health::study(robots, HEALTH_SEED)?))
}

fn lives_table(lives: Option<&str>) -> Result<String> {
    let lives = lives.map_or(Ok(300), str::parse)?;
    Ok(lives::markdown(&lives::study(lives, LIVES_SEED)?))
}

/// Measures a number of robots until their fault is certain, from a seed on.
fn until_table(numbers: &[String]) -> Result<String> {
    let robots = numbers.first().map_or(Ok(300), |text| text.parse())?;
    let first_seed = numbers.get(1).map_or(Ok(UNTIL_SEED), |text| text.parse())?;
    let records = Records::open(Path::new(UNTIL_RECORDS))?;
    let outcomes = until::study(&until::cases(robots, first_seed), &records)?;
    Ok(until::markdown(&outcomes))
}

fn tolerances_table(machines: Option<&str>) -> Result<String> {
    let machines = machines.map_or(Ok(60), str::parse)?;
    let rows = tolerances::study(machines, MOST_FAULTS, TOLERANCES_SEED)?;
    Ok(tolerances::markdown(&rows))
}

/// Diagnoses a number of random robots without a fault, from a seed on; false findings go to standard error.
fn clean_robots_table(numbers: &[String]) -> Result<String> {
    let number = |k: usize| numbers.get(k).map(|text| text.parse::<u64>()).transpose();
    let robots = number(0)?.unwrap_or(2000) as usize;
    let rows = random_robots::clean(robots, number(1)?.unwrap_or(ROBOTS_SEED))?;
    Ok(random_robots::clean_markdown(&rows))
}

/// Coverage of the expanded uncertainties of so many robots, and the shares of their budgets, beside a Monte Carlo.
fn certificate_table(numbers: &[String]) -> Result<String> {
    let number = |k: usize| numbers.get(k).map(|text| text.parse::<u64>()).transpose();
    let (robots, first) = (number(0)?.unwrap_or(2000), number(1)?.unwrap_or(2_026_000));
    let coverage = certificate::coverage(robots, first)?;
    let propagation = certificate::propagation(2000, first)?;
    let recomputation = certificate::recomputation(2000, first)?;
    Ok(format!("{coverage}\n{propagation}\n{recomputation}"))
}

/// Diagnoses a fault of five robots with one number of poses, or with all numbers; wrong names go to standard error.
fn over_poses_table(poses: Option<&str>) -> Result<String> {
    let one = poses.map(str::parse).transpose()?;
    let numbers = one.map_or(NUMBERS_OF_POSES.to_vec(), |poses| vec![poses]);
    let rows = random_robots::over_poses(&numbers, ROBOTS_SEED)?;
    Ok(random_robots::poses_markdown(&rows))
}

/// Diagnoses a number of random machines with each fault of the field, or with one, from a seed on; missed and false findings
/// go to standard error, and to a folder.
fn field_table(arguments: &[String]) -> Result<String> {
    let text = |k: usize| arguments.get(k).map(String::as_str);
    let number = |k: usize| text(k).map(str::parse::<u64>).transpose();
    let is_rough = match text(0) {
        Some("exact") => false,
        Some("rough") => true,
        _ => bail!(USAGE),
    };
    let options = field::Options {
        only: text(3).filter(|name| *name != "all"),
        is_rough,
        keep: text(4).map(Path::new),
    };
    let each = number(1)?.unwrap_or(40) as usize;
    let rows = field::study(each, number(2)?.unwrap_or(FIELD_SEED), &options)?;
    Ok(field::markdown(&rows))
}

fn truth_table(data_sets: Option<&str>) -> Result<String> {
    let data_sets = data_sets.map_or(Ok(16_000), str::parse)?;
    let rows: Result<Vec<_>> = ROBOTS
        .iter()
        .map(|name| truth::study(name, data_sets, FIRST_SEED))
        .collect();
    Ok(truth::markdown(&rows?))
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
fn studies(first: Option<&str>) -> Result<()> {
    let first = first.map(str::parse).transpose()?;
    let (table, diagram) = hidden::studies(Path::new(RECORDS), first)?;
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
fn random_runs(arguments: &[String]) -> Result<()> {
    let [program, folder, runs @ ..] = arguments else {
        bail!(USAGE);
    };
    let runs = runs.first().map_or(Ok(200), |runs| runs.parse())?;
    random_runs::write(Path::new(program), Path::new(folder), runs, RUNS_SEED)
}

fn document() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/VALIDATION.md")
}

/// Writes every table to its file in docs/validation. The Hangprinter's stays as it is where its data
/// are absent.
fn write(folder: Option<&str>) -> Result<()> {
    save("validation/nist", &nist::markdown(&nist::table()?))?;
    save("validation/truth", &truth_table(None)?)?;
    save("validation/table1", &table1::markdown(&table1::study(10)?))?;
    save(
        "validation/adjusted",
        &adjusted::markdown(&adjusted::study()?),
    )?;
    save("validation/motion", &motion_table(&[])?)?;
    save("validation/isolability", &isolability_table()?)?;
    save("validation/lives", &lives_table(None)?)?;
    save("validation/health", &health_table(None)?)?;
    save("validation/formulas", &formulas_table(None)?)?;
    save("validation/hypothesis-files", &files_table(&[])?)?;
    save("validation/until", &until_table(&[])?)?;
    save("validation/hidden-effects", &hidden::tables()?)?;
    save("validation/clean-robots", &clean_robots_table(&[])?)?;
    save("validation/certificate", &certificate_table(&[])?)?;
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
    tautline_session::write_text(&path, &format!("{head}\n\n{}\n", aligned(table.trim())))?;
    Ok(())
}

/// The text with the columns of its Markdown tables padded to equal widths, and no bars at either end.
fn aligned(text: &str) -> String {
    let lines: Vec<&str> = text.lines().collect();
    let parts = lines.chunk_by(|a, b| a.starts_with('|') == b.starts_with('|'));
    let parts = parts.map(|part| {
        if part[0].starts_with('|') {
            columns(part)
        } else {
            part.join("\n")
        }
    });
    parts.collect::<Vec<_>>().join("\n")
}

/// The rows of one table; the last column, which may have sentences, stays as it is.
fn columns(rows: &[&str]) -> String {
    let cells = |row: &&str| -> Vec<String> {
        let cells = row.trim_matches('|').split('|');
        cells.map(|cell| cell.trim().to_owned()).collect()
    };
    let mut rows: Vec<Vec<String>> = rows.iter().map(cells).collect();
    // The rule below the titles is as wide as the columns.
    rows[1].fill(String::new());
    let length = |cell: &String| cell.chars().count();
    let widest = |k: usize| rows.iter().map(|row| length(&row[k])).max().unwrap_or(0);
    let last = rows[0].len() - 1;
    let widths: Vec<usize> = (0..last).map(widest).chain([0]).collect();
    let lines = rows.iter().enumerate().map(|(number, row)| {
        let (fill, bar) = if number == 1 {
            ("-", "-|-")
        } else {
            (" ", " | ")
        };
        let padded = row.iter().zip(&widths).map(|(cell, &width)| {
            let missing = width.saturating_sub(length(cell));
            format!("{cell}{}", fill.repeat(missing))
        });
        let line = padded.collect::<Vec<_>>().join(bar);
        line.trim_end().to_owned()
    });
    lines.collect::<Vec<_>>().join("\n")
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
