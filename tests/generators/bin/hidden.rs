//! The hidden-effect test on the command line.

use std::path::{Path, PathBuf};

use anyhow::{Context, Result, bail, ensure};
use tautline_validation::tables::hidden::{
    Change, Plan, Records, Restriction, STUDIES, Study, TABLE_SEED, calibration, clean, coverage,
    describe, diagram, draw_all, drawn_markdown, failures, markdown, named, outside, pairs,
    run_all, single, summary, table_plans,
};

const USAGE: &str = "what to hide: hidden single|pairs|clean|outside|all [N] [--draw] [--failures] [--robot NAME] \
                     [--effect ID] [--seed N], hidden table, or hidden STUDY [--cases N] [--seed FIRST] [--threads N] [--robot NAME] \
                     [--records FILE] [--failures] [--draw] [--diagram FILE.svg], or hidden compare BEFORE AFTER, or hidden calibrate RECORDS...";

/// Data sets of the whole test: per effect and robot, per robot, in all, per effect and robot.
const SINGLE: usize = 3;
const PAIRS: usize = 12;
const CLEAN: usize = 900;
const OUTSIDE: usize = 3;

/// Data sets of a study where no number is given.
const CASES: usize = 20;
/// First seed of data sets for the development of the program.
const DEVELOPMENT: u64 = 600_000;

struct Arguments {
    kind: String,
    count: Option<usize>,
    /// Only draw the data sets; no diagnosis.
    draw: bool,
    failures: bool,
    threads: Option<usize>,
    records: Option<PathBuf>,
    /// File of the reliability diagram.
    diagram: Option<PathBuf>,
    restriction: Restriction,
}

impl Arguments {
    fn is_study(&self) -> bool {
        STUDIES.iter().any(|(name, _)| *name == self.kind)
    }
}

/// Runs `hidden ...`.
///
/// # Errors
/// If the arguments are invalid.
pub fn command(arguments: &[String]) -> Result<()> {
    if let [kind, before, after] = arguments
        && kind == "compare"
    {
        return compare(Path::new(before), Path::new(after));
    }
    if let [kind, files @ ..] = arguments
        && kind == "calibrate"
    {
        return calibrate(files);
    }
    let arguments = parse(arguments)?;
    let plans = plans(&arguments)?;
    if arguments.draw {
        println!("{}", drawn_markdown(&draw_all(&plans)));
        return Ok(());
    }
    let records = match &arguments.records {
        Some(path) => Records::open(path)?,
        None => Records::default(),
    };
    let study = run_all(&plans, arguments.threads, &records);
    println!("{}", markdown(&study));
    if let Some(path) = &arguments.diagram {
        std::fs::write(path, diagram(&study))?;
    }
    if arguments.restriction.seed.is_some() && !arguments.is_study() {
        study
            .outcomes
            .iter()
            .for_each(|o| println!("{}", describe(o)));
    }
    if arguments.failures {
        println!("{}\n{}", failures(&study), coverage(&study));
    }
    report_impossible(&study);
    Ok(())
}

/// Lists the data sets whose answer differs between two files of records.
fn compare(before: &Path, after: &Path) -> Result<()> {
    for file in [before, after] {
        ensure!(file.exists(), "{}: there is no such file", file.display());
    }
    let (changes, both) = Records::open(before)?.changes(&Records::open(after)?);
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
        let file = Path::new(file);
        ensure!(file.exists(), "{}: there is no such file", file.display());
        study
            .outcomes
            .extend(Records::open(file)?.outcomes().cloned());
    }
    println!("{}", calibration(&study));
    Ok(())
}

/// The tables of the whole test.
///
/// # Errors
/// Never with these arguments.
pub fn tables() -> Result<String> {
    let plans = plans(&parse(&["all".to_owned()])?)?;
    let study = run_all(&plans, None, &Records::default());
    report_impossible(&study);
    Ok(markdown(&study))
}

/// The table of the studies, or of their first data sets, taken from a file as far as they are on record there, and
/// their diagram.
///
/// # Errors
/// If the file cannot be read.
pub fn studies(records: &Path, first: Option<usize>) -> Result<(String, String)> {
    let mut plans = table_plans(&Restriction::default());
    let all = plans.len();
    plans.truncate(first.unwrap_or(all));
    let study = run_all(&plans, Some(1), &Records::open(records)?);
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

fn parse(arguments: &[String]) -> Result<Arguments> {
    let mut parsed = Arguments {
        kind: arguments.first().with_context(usage)?.clone(),
        count: None,
        draw: false,
        failures: false,
        threads: None,
        records: None,
        diagram: None,
        restriction: Restriction::default(),
    };
    let mut rest = arguments[1..].iter();
    while let Some(argument) = rest.next() {
        let mut value = || {
            rest.next()
                .with_context(|| format!("{argument} what? {USAGE}"))
        };
        match argument.as_str() {
            "--draw" => parsed.draw = true,
            "--failures" => parsed.failures = true,
            "--robot" => parsed.restriction.robot = Some(value()?.clone()),
            "--effect" => parsed.restriction.effect = Some(value()?.clone()),
            "--seed" => parsed.restriction.seed = Some(value()?.parse()?),
            "--cases" => parsed.count = Some(value()?.parse()?),
            "--threads" => parsed.threads = Some(value()?.parse()?),
            "--diagram" => parsed.diagram = Some(value()?.into()),
            "--records" => parsed.records = Some(value()?.into()),
            number => parsed.count = Some(number.parse().with_context(usage)?),
        }
    }
    let first = parsed.restriction.seed.unwrap_or(0);
    ensure!(
        (first < TABLE_SEED && parsed.kind != "table") || !parsed.failures,
        "data sets from seed {TABLE_SEED} on are for the table alone: their failures stay unseen"
    );
    Ok(parsed)
}

fn usage() -> String {
    let studies = STUDIES.map(|(name, what)| format!("  {name}: {what}\n"));
    format!("{USAGE}\nstudies:\n{}", studies.concat())
}

fn plans(arguments: &Arguments) -> Result<Vec<Plan>> {
    let count = |default| arguments.count.unwrap_or(default);
    let only = &arguments.restriction;
    let plans = match arguments.kind.as_str() {
        "single" => single(count(SINGLE), only),
        "pairs" => pairs(count(PAIRS), only),
        "clean" => clean(count(CLEAN), only),
        "outside" => outside(count(OUTSIDE), only),
        "all" => {
            ensure!(arguments.count.is_none(), "all has its own numbers");
            let mut all = single(SINGLE, only);
            all.extend(pairs(PAIRS, only));
            all.extend(clean(CLEAN, only));
            all.extend(outside(OUTSIDE, only));
            all
        }
        "table" => table_plans(only),
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
