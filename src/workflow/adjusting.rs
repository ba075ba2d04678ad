//! Writing identified values to a controller: which values, what is reported and what is recorded, for window and commands.

use tautline_link::ParameterInfo;
use tautline_link::adjusting::{self, Difference, Holds};
use tautline_session::{Adjustment, NamedValue, Outcome, Session, Stage, ValueChange};

/// Why values are written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Purpose {
    /// Identified values.
    Adjust,
    /// Those that were there before.
    RollBack,
}

/// The values that a controller can be given and does not hold.
#[must_use]
pub fn values_to_write(differences: Vec<Difference>) -> Vec<(String, f64)> {
    differences
        .into_iter()
        .filter(Difference::is_writable_change)
        .map(|difference| (difference.name, difference.identified))
        .collect()
}

/// The last adjustment, if it can be rolled back.
#[must_use]
pub fn revertible(session: &Session) -> Option<&Adjustment> {
    let last = session.adjustments().last()?;
    (last.outcome == Outcome::Written && !last.changes.is_empty()).then_some(last)
}

/// The values that were there before an adjustment.
#[must_use]
pub fn former_values(adjustment: &Adjustment) -> Vec<(String, f64)> {
    let changes = adjustment.changes.iter();
    changes
        .map(|change| (change.name.clone(), change.before))
        .collect()
}

/// Summary of an attempt to write so many values, for the operator.
#[must_use]
pub fn summary(adjustment: &adjusting::Adjustment, purpose: Purpose, values: usize) -> String {
    let what = match (&adjustment.holds, purpose) {
        (Holds::New, Purpose::Adjust) => {
            format!(
                "The identified values were written to the controller and verified ({values} changed)."
            )
        }
        (Holds::New, Purpose::RollBack) => {
            format!("The previous values were restored ({values} changed).")
        }
        (Holds::Old, _) => "The values were not written.".to_owned(),
        (Holds::Mixed(names), _) => {
            format!("Warning: {} values are only partly written.", names.len())
        }
        (Holds::Unknown, _) => "Warning: the values in the controller are not known.".to_owned(),
    };
    let problem = adjustment.problem.as_deref().unwrap_or_default();
    let advice = match purpose {
        Purpose::RollBack if adjustment.holds == Holds::New => "",
        _ => adjustment.advice.as_str(),
    };
    let parts = [what.as_str(), problem, advice].into_iter();
    let parts: Vec<&str> = parts.filter(|part| !part.is_empty()).collect();
    parts.join(" ")
}

/// The outcome for the session's record; `text` is the summary.
#[must_use]
pub fn outcome(holds: Option<&Holds>, purpose: Purpose, text: &str) -> Outcome {
    match (holds, purpose) {
        (Some(Holds::New), Purpose::Adjust) => Outcome::Written,
        (Some(Holds::New), Purpose::RollBack) => Outcome::RolledBack,
        _ => Outcome::Failed(text.to_owned()),
    }
}

/// Old and new values side by side, with the units of the controller's parameters.
#[must_use]
pub fn changes(
    parameters: &[ParameterInfo],
    old: &[(String, f64)],
    new: &[(String, f64)],
) -> Vec<ValueChange> {
    let unit = |name: &str| {
        let known = parameters.iter().find(|p| p.name == name);
        known.map_or("", |parameter| parameter.unit).to_owned()
    };
    let pairs = old.iter().zip(new);
    pairs
        .map(|((name, before), (_, after))| ValueChange {
            name: name.clone(),
            unit: unit(name),
            before: *before,
            after: *after,
        })
        .collect()
}

/// The values of a controller in the form of a session.
#[must_use]
pub fn held(parameters: &[ParameterInfo]) -> Vec<NamedValue> {
    let parameters = parameters.iter();
    parameters
        .map(|parameter| NamedValue {
            name: parameter.name.clone(),
            value: parameter.value,
        })
        .collect()
}

/// Title of a verification.
#[must_use]
pub fn title(stage: Stage) -> &'static str {
    match stage {
        Stage::Before => "Before the adjustment",
        Stage::After => "After the adjustment",
    }
}
