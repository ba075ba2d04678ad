//! The hidden-effect test on the command line.

use std::path::Path;

use anyhow::{Context, Result, bail, ensure};
use tautline_validation::tables::hidden::{
    Change, Outcome, Plan, Restriction, STUDIES, Study, TABLE_SEED, calibration, changes, clean,
    coverage, describe, diagram, failures, markdown, named, outside, pairs, run_all, single,
    summary, table_plans,
};
use tautline_validation::tables::study::Records;

use crate::arguments::Arguments;

const USAGE: &str = "what to hide: hidden single|pairs|clean|outside|all or hidden STUDY, with [--cases N] [--seed FIRST] [--robot NAME] [--effect ID] \
                     [--records FILE] [--failures], or hidden compare BEFORE AFTER, or hidden calibrate RECORDS...";

/// Data sets of the whole test: per effect and robot, per robot, in all, per effect and robot.
const SINGLE: usize = 3;
const PAIRS: usize = 12;
const CLEAN: usize = 900;
const OUTSIDE: usize = 3;

/// Data sets of a study where no number is given.
const CASES: usize = 20;
/// First seed of data sets for the development of the program.
const DEVELOPMENT: u64 = 600_000;

/// Runs `hidden ...`.
///
/// # Errors
/// If the arguments are not understood.
pub fn command(given: &Arguments) -> Result<()> {
    match given.words_from(1) {
        [kind, before, after] if kind == "compare" => return compare(before, after),
        [kind, files @ ..] if kind == "calibrate" => return calibrate(files),
        _ => {}
    }
    let only = restriction(given)?;
    ensure!(
        only.seed.unwrap_or(0) < TABLE_SEED || !given.lists_failures(),
        "data sets from seed {TABLE_SEED} on are for the table alone: their failures stay unseen"
    );
    let kind = given.word(1).with_context(usage)?;
    let plans = plans(kind, given.value("--cases")?, &only)?;
    let study = run_all(&plans, &given.records("hidden")?);
    println!("{}", markdown(&study));
    if only.seed.is_some() && !STUDIES.iter().any(|(name, _)| *name == kind) {
        study
            .outcomes
            .iter()
            .for_each(|o| println!("{}", describe(o)));
    }
    if given.lists_failures() {
        println!("{}\n{}", failures(&study), coverage(&study));
    }
    report_impossible(&study);
    Ok(())
}

fn restriction(given: &Arguments) -> Result<Restriction> {
    let text = |name| given.option(name).map(str::to_owned);
    Ok(Restriction {
        robot: text("--robot"),
        effect: text("--effect"),
        seed: given.value("--seed")?,
    })
}

fn recorded(file: &str) -> Result<Records<Plan, Outcome>> {
    ensure!(Path::new(file).exists(), "{file}: there is no such file");
    Records::open(Path::new(file))
}

/// Lists the data sets whose answer differs between two files of records.
fn compare(before: &str, after: &str) -> Result<()> {
    let (before, after) = (recorded(before)?, recorded(after)?);
    let (changes, both) = changes(&before, &after);
    println!("{} of {both} data sets get another answer.", changes.len());
    for Change { plan, found, said } in changes {
        let hidden = format!("{} seed {}, {:?}", plan.robot, plan.seed, plan.wanted);
        println!("{hidden}, {:?}", plan.circumstances);
        for (found, said) in found.iter().zip(said) {
            println!("    {found:?}: {said}");
        }
    }
    Ok(())
}

/// Fits the calibration of stated probabilities to files of records.
fn calibrate(files: &[String]) -> Result<()> {
    ensure!(!files.is_empty(), USAGE);
    let mut study = Study::default();
    for file in files {
        study.outcomes.extend(recorded(file)?.outcomes().cloned());
    }
    println!("{}", calibration(&study));
    Ok(())
}

/// The tables of the whole test.
///
/// # Errors
/// Never with these arguments.
pub fn tables() -> Result<String> {
    let plans = plans("all", None, &Restriction::default())?;
    let study = run_all(&plans, &Arguments::default().records("hidden")?);
    report_impossible(&study);
    Ok(markdown(&study))
}

/// The table of the studies, or of their first data sets, and their diagram.
///
/// # Errors
/// If the records cannot be read.
pub fn studies(given: &Arguments) -> Result<(String, String)> {
    let mut plans = table_plans(&Restriction::default());
    let all = plans.len();
    plans.truncate(given.number(1, all)?);
    let study = run_all(&plans, &given.records("hidden")?);
    report_impossible(&study);
    let summary = summary(&study);
    let text = format!("The first {} of {all} data sets.\n\n{summary}", plans.len());
    Ok((text, diagram(&study)))
}

fn report_impossible(study: &Study) {
    for (plan, why) in &study.impossible {
        eprintln!("{plan:?}: {why}");
    }
}

fn usage() -> String {
    let studies = STUDIES.map(|(name, what)| format!("  {name}: {what}\n"));
    format!("{USAGE}\nstudies:\n{}", studies.concat())
}

fn plans(kind: &str, cases: Option<usize>, only: &Restriction) -> Result<Vec<Plan>> {
    let count = |default| cases.unwrap_or(default);
    let plans = match kind {
        "single" => single(count(SINGLE), only),
        "pairs" => pairs(count(PAIRS), only),
        "clean" => clean(count(CLEAN), only),
        "outside" => outside(count(OUTSIDE), only),
        "all" => {
            ensure!(cases.is_none(), "all has its own numbers");
            let kinds = ["single", "pairs", "clean", "outside"];
            let all = kinds.map(|kind| plans(kind, None, only).unwrap_or_default());
            all.concat()
        }
        study => {
            let first = only.seed.unwrap_or(DEVELOPMENT);
            match named(study, count(CASES), first, only) {
                Some(plans) => plans,
                None => bail!(usage()),
            }
        }
    };
    ensure!(!plans.is_empty(), "there is no such robot or effect");
    Ok(plans)
}
