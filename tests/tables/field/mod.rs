//! Faults as they happen in the field, put into the readings of random machines.

pub mod answer;
mod fault;
mod machine;

use std::sync::Arc;

use anyhow::Result;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use serde::{Deserialize, Serialize};

use super::counting::{by_name, count, median};
use super::markdown::Table;
use super::simulated::asked;
use super::study::Study;
use answer::{Answer, judged};
use fault::FAULTS;

/// Seed of the first machine.
pub const FIRST_SEED: u64 = 70_000;

/// Machines with each fault.
#[derive(Debug)]
pub struct Field {
    /// Number of machines with each.
    pub each: u64,
    /// Seed of the first.
    pub first_seed: u64,
    /// Whether the noise is larger than stated and the lengths have an error that no cause describes.
    pub is_rough: bool,
}

/// A machine.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub struct Case {
    /// Which of the faults.
    fault: usize,
    seed: u64,
    is_rough: bool,
}

/// What is made of one data set, and the time that it takes (s).
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Outcome {
    answer: Answer,
    seconds: f64,
}

impl Study for Field {
    type Case = Case;
    type Outcome = Outcome;

    fn cases(&self) -> Result<Vec<Case>> {
        let case = |number: u64| Case {
            fault: (number / self.each) as usize,
            seed: self.first_seed + number,
            is_rough: self.is_rough,
        };
        Ok((0..self.each * FAULTS.len() as u64).map(case).collect())
    }

    /// What is missed or false goes to standard error. A machine that cannot have the fault has no outcome.
    fn run(&self, case: &Case) -> Result<Option<Outcome>> {
        let Case { seed, is_rough, .. } = *case;
        let (fault, name) = FAULTS[case.fault];
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let mut dataset = machine::sound(seed, is_rough, &mut rng)?;
        let Some(right) = fault::put(fault, &mut dataset, &mut rng) else {
            return Ok(None);
        };
        dataset.measurements.truth = Default::default();
        let dataset = Arc::new(dataset);
        let told = asked(Arc::clone(&dataset))?;
        let answer = judged(&told, &right);
        if !matches!(answer, Answer::Right | Answer::Listed | Answer::Quiet) {
            let (robot, said) = (&dataset.robot.name, told.headline());
            eprintln!("{name}, seed {seed}, {robot}: {answer:?}, expected {right:?}; {said}");
        }
        Ok(Some(Outcome {
            answer,
            seconds: told.seconds,
        }))
    }

    fn table(&self, outcomes: &[(Case, Outcome)]) -> Result<String> {
        let mut table = Table::new(
            "what happened | data sets | right | listed | rightly quiet | missed | false names | median s",
        );
        let names = FAULTS.map(|(_, name)| name);
        for (name, all) in by_name(&names, outcomes, |case| FAULTS[case.fault].1) {
            if all.is_empty() && name != "all" {
                continue;
            }
            table.row(format_args!(
                "{name} | {} | {} | {} | {} | {} | {} | {:.2}",
                all.len(),
                count(&all, |one| one.answer == Answer::Right),
                count(&all, |one| one.answer == Answer::Listed),
                count(&all, |one| one.answer == Answer::Quiet),
                count(&all, |one| one.answer == Answer::Missed),
                count(&all, |one| matches!(one.answer, Answer::False(_))),
                median(all.iter().map(|one| one.seconds)),
            ));
        }
        Ok(table.text())
    }
}
