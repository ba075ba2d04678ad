//! Isolability of faults: the faults that poses reveal, and those that look alike. A public format, a table and its sentences.

use std::collections::BTreeMap;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use tautline_core::diagnosis::{ExpectedFault, Isolability, isolability};
use tautline_core::effect::Scope;
use tautline_core::estimation::EstimationError;
use tautline_core::measurement::Dataset;
use tautline_core::robot::{PartTolerances, Robot};

use crate::signature::size_in_words;
use crate::wording::{count, list};

/// Probability of detection from which a fault counts as detectable.
pub const SEEN: f64 = 0.8;
/// Probability from which two faults count as confusable.
pub const CONFUSED: f64 = 0.2;

/// Detectability and confusion of every fault at its typical size.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct IsolabilityDocument {
    /// The faults that a reading depends on.
    pub faults: Vec<ExpectedFaultDocument>,
    /// Expected natural logarithm of the Bayes factor of the fault of the row, which is present, against that of the column.
    pub log_bayes_factor: Vec<Vec<f64>>,
    /// Probability that an error is detected with the fault of the row present, but that of the column is not ruled out.
    pub confusion: Vec<Vec<f64>>,
}

/// A fault at its typical size.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ExpectedFaultDocument {
    /// Identifier of the effect.
    pub effect: String,
    /// Its plain title.
    pub title: String,
    /// Cables; empty for an effect of the robot, or common to all cables.
    pub targets: Vec<String>,
    /// Size of the fault: parameters in SI units.
    pub parameters: BTreeMap<String, f64>,
    /// Size of the fault in words.
    pub size: String,
    /// Chi-square that a model without the fault leaves of noise-free data.
    pub noncentrality: f64,
    /// Probability that the fault is named or listed.
    pub detection: f64,
}

impl IsolabilityDocument {
    /// Evaluates the poses of a dataset, independently of its readings.
    ///
    /// # Errors
    /// If the readings cannot be used with the robot.
    pub fn of_dataset(dataset: &Dataset) -> Result<Self, EstimationError> {
        let found = isolability(dataset)?;
        Ok(Self::new(&dataset.robot, &found))
    }

    /// The same if all parts were exactly as described: the isolability by the poses alone.
    ///
    /// # Errors
    /// If the readings cannot be used with the robot.
    pub fn of_exact_parts(dataset: &Dataset) -> Result<Self, EstimationError> {
        let mut exact = dataset.clone();
        exact.robot.tolerances = Some(PartTolerances::exact());
        Self::of_dataset(&exact)
    }

    /// Describes the result for a robot.
    #[must_use]
    pub fn new(robot: &Robot, found: &Isolability) -> Self {
        let all = 0..found.faults.len();
        let matrix = |of: &dyn Fn(usize, usize) -> f64| -> Vec<Vec<f64>> {
            let row = |present: usize| all.clone().map(|other| of(present, other)).collect();
            all.clone().map(row).collect()
        };
        // Further digits are insignificant.
        let rounded = |value: f64| (1e3 * value).round() / 1e3;
        Self {
            faults: found.faults.iter().map(|f| fault(robot, f)).collect(),
            log_bayes_factor: matrix(&|a, b| rounded(found.pair(a, b).log_bayes_factor)),
            confusion: matrix(&|a, b| rounded(found.pair(a, b).confusion)),
        }
    }

    /// Number of detectable faults.
    #[must_use]
    pub fn seen(&self) -> usize {
        self.faults.iter().filter(|f| f.detection >= SEEN).count()
    }

    /// Faults with which a fault could be confused, the likeliest first.
    #[must_use]
    pub fn rivals(&self, present: usize) -> Vec<usize> {
        let row = &self.confusion[present];
        let mut found: Vec<usize> = (0..row.len()).filter(|k| row[*k] >= CONFUSED).collect();
        found.sort_by(|a, b| row[*b].total_cmp(&row[*a]).then(a.cmp(b)));
        found
    }
}

fn fault(robot: &Robot, expected: &ExpectedFault) -> ExpectedFaultDocument {
    let bound = &expected.cause.instances[0];
    let setting = bound.setting(robot);
    ExpectedFaultDocument {
        effect: bound.effect.id().to_owned(),
        title: bound.effect.title().to_owned(),
        targets: setting.targets,
        size: size_in_words(bound),
        parameters: setting
            .parameters
            .into_iter()
            .filter(|(_, value)| value.is_finite())
            .collect(),
        noncentrality: expected.noncentrality.max(0.0),
        detection: expected.detection,
    }
}

impl ExpectedFaultDocument {
    /// `Winch scale of cable-3`.
    #[must_use]
    pub fn name(&self) -> String {
        let is_common = tautline_core::effect::find(&self.effect)
            .is_some_and(|effect| effect.scope() == Scope::CableOrAll);
        match self.targets.as_slice() {
            [] if is_common => format!("{} of all cables", self.title),
            [] => self.title.clone(),
            targets => format!("{} of {}", self.title, list(targets)),
        }
    }
}

/// Kinds of faults: every effect once, represented by its least detectable target.
#[derive(Debug, Clone, PartialEq)]
pub struct IsolabilityTable {
    /// The kinds, in the order of the catalogue.
    pub kinds: Vec<FaultKind>,
    /// Rows: the kind that is present; columns: the kind with which it could be confused.
    pub cells: Vec<Vec<Cell>>,
}

/// All faults of one effect.
#[derive(Debug, Clone, PartialEq)]
pub struct FaultKind {
    /// Title of the effect.
    pub title: String,
    /// Smallest and largest probability of detection among its targets.
    pub detection: [f64; 2],
    /// Detectability in words.
    pub sentence: String,
}

/// Confusion of one kind of fault with another.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Cell {
    /// Largest probability of confusion among the targets of both.
    pub confusion: f64,
    /// The confusion in words.
    pub sentence: String,
}

impl IsolabilityTable {
    /// Summarises a document by kinds of faults.
    #[must_use]
    pub fn of(document: &IsolabilityDocument) -> Self {
        let faults = &document.faults;
        let mut members: Vec<Vec<usize>> = Vec::new();
        for (index, fault) in faults.iter().enumerate() {
            match members
                .iter_mut()
                .find(|m| faults[m[0]].effect == fault.effect)
            {
                Some(known) => known.push(index),
                None => members.push(vec![index]),
            }
        }
        let cells = members.iter().map(|present| {
            members
                .iter()
                .map(|others| cell(document, present, others))
                .collect()
        });
        Self {
            cells: cells.collect(),
            kinds: members.iter().map(|m| kind(document, m)).collect(),
        }
    }

    /// Summary in one sentence.
    #[must_use]
    pub fn summary(&self) -> String {
        let seen = |kind: &&FaultKind| kind.detection[0] >= SEEN;
        let confused = (0..self.kinds.len()).flat_map(|a| (0..a).map(move |b| (a, b)));
        let is_confused = |(a, b): &(usize, usize)| {
            self.cells[*a][*b]
                .confusion
                .max(self.cells[*b][*a].confusion)
                >= CONFUSED
        };
        format!(
            "At typical size these poses show {} of {}; {} of faults could be confused.",
            self.kinds.iter().filter(seen).count(),
            count(self.kinds.len(), "kind of fault").replace("kind of faults", "kinds of fault"),
            count(confused.filter(is_confused).count(), "pair")
        )
    }
}

fn kind(document: &IsolabilityDocument, members: &[usize]) -> FaultKind {
    let faults = &document.faults;
    let order = |a: &&usize, b: &&usize| faults[**a].detection.total_cmp(&faults[**b].detection);
    let least = members
        .iter()
        .min_by(order)
        .map_or(&faults[members[0]], |k| &faults[*k]);
    let most = members
        .iter()
        .max_by(order)
        .map_or(&faults[members[0]], |k| &faults[*k]);
    let mut sentence = format!(
        "{} ({}) would be seen with a probability of {}",
        least.name(),
        least.size,
        percent(least.detection)
    );
    if most.targets != least.targets {
        sentence += &format!(", {} with {}", most.name(), percent(most.detection));
    }
    FaultKind {
        title: least.title.clone(),
        detection: [least.detection, most.detection],
        sentence: sentence + ".",
    }
}

fn cell(document: &IsolabilityDocument, present: &[usize], others: &[usize]) -> Cell {
    let pairs = present
        .iter()
        .flat_map(|a| others.iter().map(move |b| (*a, *b)));
    let value = |(a, b): &(usize, usize)| document.confusion[*a][*b];
    let worst = pairs
        .filter(|(a, b)| a != b)
        .max_by(|x, y| value(x).total_cmp(&value(y)).then_with(|| y.cmp(x)));
    let Some((a, b)) = worst else {
        return Cell::default();
    };
    let (one, other) = (&document.faults[a], &document.faults[b]);
    Cell {
        confusion: value(&(a, b)),
        sentence: format!(
            "If {} is present ({}), {} is seen and not ruled out with a probability of {}. The readings are expected to favour \
             the true fault by {}.",
            lower(&one.name()),
            one.size,
            lower(&other.name()),
            percent(value(&(a, b))),
            odds(document.log_bayes_factor[a][b])
        ),
    }
}

/// A name for use inside a sentence.
fn lower(name: &str) -> String {
    let mut rest = name.chars();
    let first = rest.next().into_iter().flat_map(char::to_lowercase);
    first.chain(rest).collect()
}

/// A probability as a percentage.
#[must_use]
pub fn percent(probability: f64) -> String {
    format!("{:.0} %", 100.0 * probability)
}

fn odds(log_bayes_factor: f64) -> String {
    match log_bayes_factor {
        value if value > 1e4_f64.ln() => "more than 10 000 to 1".to_owned(),
        value if value > 1.5_f64.ln() => format!("{:.0} to 1", value.exp()),
        value if value < (1.0_f64 / 1.5).ln() => {
            format!("1 to {:.0}", (-value).min(1e4_f64.ln()).exp())
        }
        _ => "1 to 1: they look the same".to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use tautline_core::robot::presets;
    use tautline_core::simulation::{SimulationOptions, simulate};

    #[test]
    fn kinds_of_faults_have_sentences() {
        let robot = presets::find("planar").expect("a preset").robot;
        let data = simulate(&robot, &SimulationOptions::new(12, 2)).expect("simulated");
        let document = IsolabilityDocument::of_dataset(&data.dataset).expect("a problem");
        let table = IsolabilityTable::of(&document);
        assert_eq!(table.cells.len(), table.kinds.len());
        assert!(table.kinds.len() < document.faults.len());
        let scale = table
            .kinds
            .iter()
            .position(|k| k.title == "Winch scale")
            .expect("a winch");
        assert!(
            table.kinds[scale].sentence.contains("of cable-"),
            "{:?}",
            table.kinds[scale]
        );
        for cell in table.cells.iter().flatten() {
            assert!((0.0..=1.0).contains(&cell.confusion), "{cell:?}");
        }
        assert!(
            table.summary().contains(" kinds of fault; "),
            "{}",
            table.summary()
        );
        assert_eq!(odds(0.0), "1 to 1: they look the same");
        assert_eq!(odds(3.0), "20 to 1");
        assert_eq!(odds(-3.0), "1 to 20");
        assert_eq!(percent(0.987), "99 %");
    }
}
