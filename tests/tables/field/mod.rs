//! Faults as they happen in the field, put into the readings of random machines.

pub mod answer;
mod fault;
mod machine;

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::path::Path;
use std::sync::Arc;

use anyhow::Result;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use tautline_core::estimation::Control;
use tautline_session::{PhaseData, write_dataset};
use tautline_workflow::diagnosis::{TIME_LIMIT_S, diagnose_dataset};

use super::parallel::in_parallel;
use answer::{Answer, judged};
pub use fault::Fault;

/// Answers by what happened.
#[derive(Debug, Clone, Default)]
pub struct Row {
    sets: usize,
    right: usize,
    listed: usize,
    quiet: usize,
    missed: usize,
    false_names: usize,
    seconds: Vec<f64>,
}

/// What is diagnosed, and what is done with it.
#[derive(Debug, Clone, Default)]
pub struct Options<'a> {
    /// Only the fault of this name.
    pub only: Option<&'a str>,
    /// Machines whose noise is larger than stated and whose lengths have an error that no cause describes.
    pub is_rough: bool,
    /// Folder for data sets that are not answered well.
    pub keep: Option<&'a Path>,
}

/// Diagnoses so many machines with each fault; what is missed or false goes to standard error.
///
/// # Errors
/// If a machine cannot be simulated or diagnosed.
pub fn study(each: usize, first_seed: u64, options: &Options<'_>) -> Result<BTreeMap<Fault, Row>> {
    let faults = Fault::ALL.iter().enumerate();
    let cases: Vec<(Fault, u64)> = faults
        .filter(|(_, fault)| options.only.is_none_or(|name| fault.name() == name))
        .flat_map(|(index, fault)| {
            let first = first_seed + (index * each) as u64;
            (first..first + each as u64).map(|seed| (*fault, seed))
        })
        .collect();
    let mut rows: BTreeMap<Fault, Row> = BTreeMap::new();
    for (case, answer) in cases
        .iter()
        .zip(in_parallel(&cases, None, |case| answer(case, options)))
    {
        let Some((answer, seconds)) = answer? else {
            continue;
        };
        let row = rows.entry(case.0).or_default();
        row.sets += 1;
        row.seconds.push(seconds);
        match answer {
            Answer::Right => row.right += 1,
            Answer::Listed => row.listed += 1,
            Answer::Quiet => row.quiet += 1,
            Answer::Missed => row.missed += 1,
            Answer::False(_) => row.false_names += 1,
        }
    }
    Ok(rows)
}

/// What is made of one data set, and the time that it takes (s); `None` if the machine cannot have the fault.
fn answer(case: &(Fault, u64), options: &Options<'_>) -> Result<Option<(Answer, f64)>> {
    let (fault, seed) = *case;
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let mut dataset = machine::sound(seed, options.is_rough, &mut rng)?;
    let Some(right) = fault::put(fault, &mut dataset, &mut rng) else {
        return Ok(None);
    };
    let name = dataset.robot.name.clone();
    let dataset = Arc::new(dataset);
    let limits = (0.01, TIME_LIMIT_S);
    let told = diagnose_dataset(Arc::clone(&dataset), limits, &mut |_| Control::Continue)?;
    let answer = judged(&told, &right);
    if !matches!(answer, Answer::Right | Answer::Listed | Answer::Quiet) {
        let said = told.headline();
        if let Some(folder) = options.keep {
            write_dataset(
                &folder.join(seed.to_string()),
                &dataset,
                &PhaseData::default(),
            )?;
        }
        eprintln!(
            "{}, seed {seed}, {name}: {answer:?}, expected {right:?}; {said}",
            fault.name()
        );
    }
    Ok(Some((answer, told.seconds)))
}

/// The table.
#[must_use]
pub fn markdown(rows: &BTreeMap<Fault, Row>) -> String {
    let mut table = "| what happened | data sets | right | listed | rightly quiet | missed | false names | median s |\n|---|---|---|---|---|---|---|---|\n".to_owned();
    let mut all = Row::default();
    let mut line = |name: &str, row: &Row| {
        let mut sorted = row.seconds.clone();
        sorted.sort_by(f64::total_cmp);
        let median = sorted.get(sorted.len() / 2).copied().unwrap_or(f64::NAN);
        let Row {
            sets,
            right,
            listed,
            quiet,
            missed,
            false_names,
            ..
        } = row;
        let _ = writeln!(
            table,
            "| {name} | {sets} | {right} | {listed} | {quiet} | {missed} | {false_names} | {median:.2} |"
        );
    };
    for (fault, row) in rows {
        line(fault.name(), row);
        all.sets += row.sets;
        all.right += row.right;
        all.listed += row.listed;
        all.quiet += row.quiet;
        all.missed += row.missed;
        all.false_names += row.false_names;
        all.seconds.extend(&row.seconds);
    }
    line("all", &all);
    table
}
