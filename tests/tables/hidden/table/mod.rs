//! Markdown tables of a study.

mod drawn;
mod figures;
mod kinds;
mod reliability;

use std::collections::BTreeMap;
use std::fmt::Write as _;

use tautline_core::effect::CATALOGUE;

pub use drawn::drawn_markdown;
pub use figures::{Figure, Figures, Target};
pub use reliability::{diagram, logarithmic_score};

use figures::NORMAL_95;

use super::judge::Found;
use super::{FindingRecord, Hidden, OUTSIDE, Outcome, Stratum, Study, Sure, Wanted, robots};

/// All tables of a study: figures, results by effect and robot, confusions, computing times.
#[must_use]
pub fn markdown(study: &Study) -> String {
    let mut text = summary(study);
    text.push_str(&counts(study));
    let ids: Vec<&str> = CATALOGUE.iter().map(|effect| effect.id()).collect();
    let caption =
        "Typical sizes: named or listed, of those visible; in brackets those that are not.";
    text.push_str(&by_robot(study, caption, &ids, |outcome| {
        typical(outcome).then(|| found(outcome))
    }));
    let outside: Vec<&str> = OUTSIDE.iter().map(|effect| effect.id).collect();
    let caption = "Outside the catalogue: unknown or ambiguous, and nothing named, of those that can be told \
                   from every single effect in it; in brackets those that cannot.";
    text.push_str(&by_robot(study, caption, &outside, |outcome| {
        is_outside(outcome).then(|| has_finding_without_wrong_name(outcome))
    }));
    text.push_str(&confusions(study));
    text
}

/// The summary tables of a study: requirements, results by kind of dataset, and reliability of stated probabilities.
#[must_use]
pub fn summary(study: &Study) -> String {
    let mut text = figures_table(&Figures::of(study));
    text.push_str(&kinds::table(study));
    text.push_str(&reliability::table(study));
    text
}

pub(super) fn typical(outcome: &Outcome) -> bool {
    outcome.drawn.visible && matches!(outcome.plan.wanted, Wanted::One(_, Stratum::Typical))
}

pub(super) fn is_outside(outcome: &Outcome) -> bool {
    outcome.drawn.visible && matches!(outcome.plan.wanted, Wanted::Outside(_))
}

/// Whether every hidden effect is named or in a short list.
pub(super) fn found(outcome: &Outcome) -> bool {
    outcome.found.iter().all(is_found)
}

/// Whether an effect is named or in a short list.
fn is_found(found: &Found) -> bool {
    matches!(found, Found::Named | Found::Listed)
}

/// Whether there is a finding, but no wrong name.
pub(super) fn has_finding_without_wrong_name(outcome: &Outcome) -> bool {
    !outcome.said.is_empty() && outcome.wrong_names.is_empty()
}

/// Whether there is a finding or a statement of larger noise, but no wrong name.
pub(super) fn is_noticed_without_wrong_name(outcome: &Outcome) -> bool {
    let is_louder = outcome.noise.iter().any(|(_, ratio)| *ratio > 1.0);
    outcome.wrong_names.is_empty() && (is_louder || !outcome.said.is_empty())
}

fn figures_table(figures: &Figures) -> String {
    let mut text =
        String::from("| what | of | share | 95 % interval | asked for |\n|---|---|---|---|---|\n");
    for figure in figures.all.iter().filter(|figure| figure.of > 0) {
        let [low, high] = figure.interval();
        let _ = writeln!(
            text,
            "| {} | {} | {:.2} % | {:.2} to {:.2} % | {} |",
            figure.what,
            figure.of,
            100.0 * figure.share(),
            100.0 * low,
            100.0 * high,
            figure.target.map_or("-".to_owned(), |t| t.to_string()),
        );
    }
    text.push('\n');
    text
}

fn counts(study: &Study) -> String {
    let mut seconds: Vec<f64> = study.outcomes.iter().map(|o| o.seconds).collect();
    seconds.sort_by(f64::total_cmp);
    let median = seconds.get(seconds.len() / 2).copied().unwrap_or(0.0);
    let largest = seconds.last().copied().unwrap_or(0.0);
    let redraws: usize = study.outcomes.iter().map(|o| o.drawn.redraws).sum();
    let mut ratios: Vec<f64> = (study.outcomes.iter())
        .filter_map(|o| o.held_out_ratio)
        .collect();
    ratios.sort_by(f64::total_cmp);
    let ratio = ratios.get(ratios.len() / 2).copied().unwrap_or(1.0);
    format!(
        "{} data sets; {} more for whose effect the robot has no reading; {redraws} draws thrown away; {} \
         impossible. Diagnosis: median {median:.3} s, largest {largest:.3} s. Held-out error over that of the \
         true model: median {ratio:.4}.\n\n",
        study.outcomes.len(),
        study.not_applicable,
        study.impossible.len(),
    )
}

/// Counts for one effect on one robot.
#[derive(Default)]
struct Cell {
    right: usize,
    of: usize,
    not_visible: usize,
}

impl Cell {
    fn text(&self) -> String {
        let Self {
            right,
            of,
            not_visible,
        } = self;
        match (of, not_visible) {
            (_, 0) => format!("{right}/{of}"),
            (0, hidden) => format!("({hidden})"),
            (_, hidden) => format!("{right}/{of} ({hidden})"),
        }
    }
}

/// A table with a row per effect and a column per robot. `judge` returns whether an outcome is right, or `None` if it
/// does not count.
fn by_robot(
    study: &Study,
    caption: &str,
    ids: &[&str],
    judge: impl Fn(&Outcome) -> Option<bool>,
) -> String {
    let mut cells: BTreeMap<(&str, &str), Cell> = BTreeMap::new();
    for outcome in &study.outcomes {
        let (Wanted::One(id, _) | Wanted::Outside(id)) = outcome.plan.wanted else {
            continue;
        };
        if !ids.contains(&id) {
            continue;
        }
        let cell = cells.entry((id, outcome.plan.robot)).or_default();
        cell.not_visible += usize::from(!outcome.drawn.visible);
        if let Some(right) = judge(outcome) {
            cell.right += usize::from(right);
            cell.of += 1;
        }
    }
    let cells = cells.into_iter();
    effects_by_robot(
        caption,
        ids,
        &cells.map(|(at, cell)| (at, cell.text())).collect(),
    )
}

/// A table with a column per robot and a row per effect that occurs; empty without cells.
fn effects_by_robot(caption: &str, ids: &[&str], cells: &BTreeMap<(&str, &str), String>) -> String {
    if cells.is_empty() {
        return String::new();
    }
    let names: Vec<&str> = robots().iter().map(|robot| robot.name).collect();
    let mut text = format!("{caption}\n\n| effect | {} |\n", names.join(" | "));
    let _ = writeln!(text, "|---|{}", "---|".repeat(names.len()));
    for id in ids {
        if !cells.keys().any(|(effect, _)| effect == id) {
            continue;
        }
        let cells = names.iter().map(|name| cells.get(&(*id, *name)));
        let row: Vec<&str> = cells.map(|cell| cell.map_or("-", String::as_str)).collect();
        let _ = writeln!(text, "| {id} | {} |", row.join(" | "));
    }
    text.push('\n');
    text
}

/// Table of what was reported instead of the truth or in addition to it.
fn confusions(study: &Study) -> String {
    let mut counts: BTreeMap<(String, String), usize> = BTreeMap::new();
    for outcome in &study.outcomes {
        for confusion in confused(outcome) {
            *counts.entry(confusion).or_default() += 1;
        }
    }
    if counts.is_empty() {
        return String::new();
    }
    let mut text = String::from(
        "Confusions; in brackets what was said besides the truth.\n\n| hidden | said | times |\n|---|---|---|\n",
    );
    for ((hidden, said), times) in counts {
        let _ = writeln!(text, "| {hidden} | {said} | {times} |");
    }
    text.push('\n');
    text
}

/// Hidden effects and what was reported instead, without cable numbers.
fn confused(outcome: &Outcome) -> Vec<(String, String)> {
    let said = |names: &[String]| {
        let plain: Vec<String> = names.iter().map(|name| without_cables(name)).collect();
        if plain.is_empty() {
            "nothing".to_owned()
        } else {
            plain.join(", ")
        }
    };
    let answers: Vec<String> = outcome.said.iter().map(|said| said.text.clone()).collect();
    let hidden = match &outcome.drawn.case.hidden {
        Hidden::Effects(settings) => settings.iter().map(|s| s.effect.clone()).collect(),
        Hidden::Nothing if outcome.said.is_empty() => return Vec::new(),
        Hidden::Nothing => return vec![("nothing".to_owned(), said(&answers))],
        Hidden::Outside(..) if has_finding_without_wrong_name(outcome) || !is_outside(outcome) => {
            return Vec::new();
        }
        Hidden::Outside(effect, _) => return vec![(effect.id.to_owned(), said(&answers))],
        Hidden::Exchanged(channels, _) => vec![format!("{} exchanged", channels.name())],
    };
    let hidden: Vec<String> = hidden;
    let missed = hidden.iter().zip(&outcome.found).filter(|(_, found)| {
        let silent = **found == Found::Missed && !outcome.drawn.visible;
        !silent && !matches!(found, Found::Named | Found::Listed)
    });
    let mut confusions: Vec<_> = missed
        .map(|(hidden, _)| (hidden.clone(), said(&answers)))
        .collect();
    let mut besides = outcome.wrong_names.clone();
    if outcome.unknown_without_reason() {
        besides.push("unknown".to_owned());
    }
    if confusions.is_empty() && !besides.is_empty() {
        confusions.push((hidden.join(" and "), format!("({})", said(&besides))));
    }
    confusions
}

/// Removes cable numbers, because the same effect on several cables is not a confusion of effects.
fn without_cables(answer: &str) -> String {
    let names = answer.split(" or ");
    let mut plain: Vec<&str> = names
        .map(|name| name.split(':').next().unwrap_or(name))
        .collect();
    plain.dedup();
    plain.join(" or ")
}

/// One line for each dataset with an error, with all that is needed to reproduce it.
#[must_use]
pub fn failures(study: &Study) -> String {
    let mut text = String::new();
    for outcome in study.outcomes.iter().filter(|o| !confused(o).is_empty()) {
        let _ = writeln!(text, "{}", describe(outcome));
    }
    for (plan, why) in &study.impossible {
        let _ = writeln!(
            text,
            "{} seed {}: {:?}: {why}",
            plan.robot, plan.seed, plan.wanted
        );
    }
    text
}

/// For each parameter the coverage of the 95 % interval, and the root mean square error in standard deviations.
#[must_use]
pub fn coverage(study: &Study) -> String {
    let mut errors: BTreeMap<(&str, &str), Vec<f64>> = BTreeMap::new();
    for error in study.outcomes.iter().flat_map(|o| &o.parameters) {
        errors
            .entry((error.effect, error.parameter))
            .or_default()
            .push(error.standardised);
    }
    let mut text =
        String::from("| effect | parameter | covered | rms error, sd |\n|---|---|---|---|\n");
    for ((effect, parameter), errors) in errors {
        let covered = errors.iter().filter(|e| e.abs() < NORMAL_95).count();
        let squares: f64 = errors.iter().map(|e| e * e).sum();
        let rms = (squares / errors.len() as f64).sqrt();
        let _ = writeln!(
            text,
            "| {effect} | {parameter} | {covered}/{} | {rms:.2} |",
            errors.len()
        );
    }
    text
}

/// Describes a dataset and its outcome in one line.
#[must_use]
pub fn describe(outcome: &Outcome) -> String {
    let hidden = match &outcome.drawn.case.hidden {
        Hidden::Nothing => "nothing".to_owned(),
        Hidden::Effects(settings) => {
            let each = settings.iter();
            let text = each.map(|s| format!("{} {:?} {:?}", s.effect, s.targets, s.parameters));
            text.collect::<Vec<_>>().join(" and ")
        }
        Hidden::Outside(effect, size) => format!("{} {size:.3e}", effect.id),
        Hidden::Exchanged(channels, cables) => {
            format!(
                "{} of {:?} exchanged",
                channels.name(),
                cables.map(|k| k + 1)
            )
        }
    };
    let answers: Vec<String> = outcome.said.iter().map(with_probabilities).collect();
    let possible = outcome.possible.iter();
    let possible: Vec<String> = possible
        .map(|candidate| format!("{} {:.3}", candidate.name, candidate.probability))
        .collect();
    let noise = outcome.noise.iter();
    let noise: Vec<String> = noise
        .map(|(of, ratio)| format!("{of} x{ratio:.2}"))
        .collect();
    format!(
        "{} seed {}: {hidden}, noncentrality {:.1?}: {:?} in {:.2} s; said: {}; possible: {}; noise: {}",
        outcome.plan.robot,
        outcome.plan.seed,
        outcome.drawn.noncentralities,
        outcome.found,
        outcome.seconds,
        answers.join("; "),
        possible.join(", "),
        noise.join(", "),
    )
}

/// Describes a finding with its stated probabilities and the reduction of chi-square.
fn with_probabilities(said: &FindingRecord) -> String {
    let each = said.candidates.iter();
    let each = each.map(|candidate| format!("{} {:.3}", candidate.name, candidate.probability));
    let text = match said.sure {
        Sure::Unknown => said.text.clone(),
        Sure::Named | Sure::Ambiguous => each.collect::<Vec<_>>().join(" or "),
    };
    format!("{text} ({:.1})", said.gain)
}

#[cfg(test)]
mod tests;
