//! Readiness check before identification: completeness and plausibility of the readings, determination of the geometry, and
//! detectable faults. Every part passes, fails, gives a notice or is not evaluated, with a sentence and advice.

mod faults;
mod readings;
#[cfg(test)]
mod tests;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use tautline_core::effect::measurements_as_modelled;
use tautline_core::estimation::{Control, Options, Problem, Solution, rank_defects, solve};
use tautline_core::measurement::Dataset;
use tautline_import::check_table;
use tautline_session::{PoseLines, VersionedFile};

use crate::isolability::{IsolabilityDocument, IsolabilityTable, SEEN, percent};
use crate::wording::{count, list, sentence};
use faults::in_other_frame;
pub use faults::{ReadingFault, reading_faults};
use readings::{complete, plausible};

/// Name of the part that looks for readings that are missing.
pub const COMPLETE: &str = "complete";

/// Name of the part that compares readings with the commanded poses.
pub const PLAUSIBLE: &str = "plausible";

/// Outcome of a part of the check.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum CheckOutcome {
    /// Passed.
    Pass,
    /// Passed, but limits the conclusions from the readings.
    Notice,
    /// A fault must be removed first.
    Fail,
    /// Could not be evaluated.
    NotEvaluated,
}

/// A part of the check.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct CheckItem {
    /// Subject of the check: `complete`, `plausible`, `geometry` or `faults`.
    pub name: String,
    /// Outcome.
    pub outcome: CheckOutcome,
    /// Reason, in one or two sentences.
    pub sentence: String,
    /// Advice; null if nothing needs to be done.
    pub action: Option<String>,
}

/// The check of a dataset before identification.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ReadinessDocument {
    /// Name of the robot.
    pub robot: String,
    /// Whether no check failed.
    pub ready: bool,
    /// The checks.
    pub checks: Vec<CheckItem>,
    /// Faults that these poses reveal; null if not evaluated.
    pub isolability: Option<IsolabilityDocument>,
}

impl VersionedFile for ReadinessDocument {
    const FORMAT: &'static str = "tautline-readiness";
    const VERSION: u32 = 1;
    const MAX_BYTES: u64 = 64 << 20;
}

impl CheckItem {
    fn new(name: &str, outcome: CheckOutcome, sentence: String) -> Self {
        Self {
            name: name.to_owned(),
            outcome,
            sentence,
            action: None,
        }
    }

    fn with(self, action: impl Into<String>) -> Self {
        Self {
            action: Some(action.into()),
            ..self
        }
    }

    /// Title of the part.
    #[must_use]
    pub fn title(&self) -> &'static str {
        match self.name.as_str() {
            COMPLETE => "Readings complete",
            PLAUSIBLE => "Readings plausible",
            "geometry" => "Geometry determined",
            _ => "Faults visible",
        }
    }
}

/// Checks a dataset with its raw measurements; `table` is the one that they were read from. The faults that the poses reveal
/// take seconds, so they are evaluated only on request.
#[must_use]
pub fn check(dataset: &Dataset, table: Option<&PoseLines>, with_faults: bool) -> ReadinessDocument {
    let found = check_table(&dataset.measurements, &dataset.robot);
    let said = |fault: &ReadingFault| fault.sentence(dataset, table);
    let mut checks = vec![complete(dataset, &said), plausible(dataset, &found, &said)];
    let is_spoilt = checks.iter().any(|c| c.outcome == CheckOutcome::Fail);
    let in_other_frame = in_other_frame(dataset, &found);
    let fitted = if is_spoilt || in_other_frame.is_some() {
        Fitted::Not("the readings cannot be used".to_owned())
    } else {
        fitted(dataset)
    };
    checks.push(match &in_other_frame {
        Some(fault) => CheckItem::new("geometry", CheckOutcome::Fail, said(fault))
            .with("Import the readings again, so that the frame of the instrument is found."),
        None => geometry(&fitted),
    });
    let isolability = match &fitted {
        Fitted::At(..) if with_faults => IsolabilityDocument::of_dataset(dataset).ok(),
        _ => None,
    };
    let hides_most = |found: &&IsolabilityDocument| are_mostly_unseen(&IsolabilityTable::of(found));
    let of_exact_parts = (isolability.as_ref().filter(hides_most))
        .and_then(|_| IsolabilityDocument::of_exact_parts(dataset).ok());
    checks.push(match fitted {
        Fitted::At(..) if !with_faults => not_asked(),
        _ => faults(isolability.as_ref(), of_exact_parts.as_ref()),
    });
    ReadinessDocument {
        robot: dataset.robot.name.clone(),
        ready: checks
            .iter()
            .all(|check| check.outcome != CheckOutcome::Fail),
        checks,
        isolability,
    }
}

/// The check of the readings alone, for a dataset that need not determine its geometry.
#[must_use]
pub fn readings_readiness(dataset: &Dataset, table: Option<&PoseLines>) -> ReadinessDocument {
    let checks = check_readings(dataset, table);
    ReadinessDocument {
        robot: dataset.robot.name.clone(),
        ready: checks.iter().all(|one| one.outcome != CheckOutcome::Fail),
        checks,
        isolability: None,
    }
}

/// The parts that need no fit: they take no time.
#[must_use]
pub fn check_readings(dataset: &Dataset, table: Option<&PoseLines>) -> Vec<CheckItem> {
    let said = |fault: &ReadingFault| fault.sentence(dataset, table);
    let found = check_table(&dataset.measurements, &dataset.robot);
    vec![complete(dataset, &said), plausible(dataset, &found, &said)]
}

/// A first fit, which shows the parameters that the readings determine.
enum Fitted {
    At(Box<Solution>, Vec<String>),
    Not(String),
}

fn fitted(dataset: &Dataset) -> Fitted {
    let modelled = match measurements_as_modelled(&dataset.robot, &dataset.measurements) {
        Ok(measurements) => Dataset {
            robot: dataset.robot.clone(),
            measurements: measurements.into_owned(),
        },
        Err(error) => return Fitted::Not(error.to_string()),
    };
    let solved = Problem::new(&modelled).and_then(|problem| {
        let solution = solve(&problem, &Options::default(), &mut |_| Control::Continue)?;
        let open = rank_defects(&problem, &solution);
        Ok((solution, open))
    });
    match solved {
        Ok((solution, _)) if !solution.chi2.is_finite() => {
            Fitted::Not("no poses fit these readings".to_owned())
        }
        Ok((solution, open)) => {
            let open = open.into_iter().map(|defect| defect.sentence).collect();
            Fitted::At(Box::new(solution), open)
        }
        Err(error) => Fitted::Not(error.to_string()),
    }
}

fn geometry(fitted: &Fitted) -> CheckItem {
    let item = |outcome, sentence: String| CheckItem::new("geometry", outcome, sentence);
    match fitted {
        Fitted::Not(why) => item(
            CheckOutcome::NotEvaluated,
            format!(
                "Not evaluated, as there is no fit: {}.",
                why.trim_end_matches('.')
            ),
        )
        .with("Correct the readings first."),
        Fitted::At(_, open) if !open.is_empty() => {
            let open = open.iter().map(|o| sentence(o.trim_end_matches('.')) + ".");
            item(CheckOutcome::Fail, open.collect::<Vec<_>>().join(" "))
                .with("Plan and measure more poses, add an instrument, or state what is known in robot.json.")
        }
        Fitted::At(solution, _) => {
            let parameters = solution.parameters.len();
            item(
                CheckOutcome::Pass,
                format!(
                    "The readings determine all {}, with {:.0} more than needed.",
                    count(parameters, "parameter"),
                    solution.degrees_of_freedom.max(0.0)
                ),
            )
        }
    }
}

/// Advice where poses reveal few faults.
const BETTER_POSES: &str = "Poses planned with `tautline plan --for both` reveal more; the rest needs another instrument or a check in \
                            the workshop.";
/// Sentence and advice if the tolerances of the parts hide most faults.
const HIDDEN_BY_TOLERANCES: &str = "Most of them are hidden by what sound parts may deviate within their tolerances, not by the poses.";
const TIGHTER_TOLERANCES: &str = "State the tolerances of this machine if they are tighter; the rest needs another instrument or a check \
                                  in the workshop.";

/// Whether more than half of the kinds of faults are not reliably detectable.
fn are_mostly_unseen(table: &IsolabilityTable) -> bool {
    let unseen = table.kinds.iter().filter(|kind| kind.detection[0] < SEEN);
    2 * unseen.count() > table.kinds.len()
}

fn not_asked() -> CheckItem {
    let sentence = "Not evaluated, as it takes some seconds.".to_owned();
    CheckItem::new("faults", CheckOutcome::NotEvaluated, sentence)
        .with("To see which faults these poses reveal, add --explain.")
}

/// The check of the detectable faults; `of_exact_parts` has those for exact parts, needed if most faults are hidden.
fn faults(
    isolability: Option<&IsolabilityDocument>,
    of_exact_parts: Option<&IsolabilityDocument>,
) -> CheckItem {
    let item = |outcome, sentence: String| CheckItem::new("faults", outcome, sentence);
    let Some(document) = isolability else {
        return item(
            CheckOutcome::NotEvaluated,
            "Not evaluated, as there is no fit.".to_owned(),
        )
        .with("Correct the readings first.");
    };
    let table = IsolabilityTable::of(document);
    let unseen = table.kinds.iter().filter(|kind| kind.detection[0] < SEEN);
    let unseen: Vec<String> = unseen
        .map(|kind| format!("{} ({})", kind.title, percent(kind.detection[0])))
        .collect();
    if unseen.is_empty() {
        return item(CheckOutcome::Pass, table.summary());
    }
    let sentence = format!(
        "{} Not reliably detectable: {}.",
        table.summary(),
        list(&unseen)
    );
    let by_poses = of_exact_parts.map(|found| are_mostly_unseen(&IsolabilityTable::of(found)));
    match by_poses {
        // Some faults are below the noise at any poses; the poses are poor if that holds for more than half of the faults. The
        // pulleys can be identified from them all the same.
        Some(true) => item(CheckOutcome::Notice, sentence).with(BETTER_POSES),
        None => item(CheckOutcome::Pass, sentence).with(BETTER_POSES),
        Some(false) => item(
            CheckOutcome::Pass,
            format!("{sentence} {HIDDEN_BY_TOLERANCES}"),
        )
        .with(TIGHTER_TOLERANCES),
    }
}
