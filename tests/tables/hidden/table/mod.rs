//! Markdown tables of a study.

mod figures;
mod kinds;
mod reliability;

use std::collections::BTreeMap;
use std::fmt::Write as _;

use tautline_core::diagnosis::Verdict;
use tautline_core::effect::CATALOGUE;

pub use figures::{Figure, Figures, Target};
pub use reliability::{diagram, logarithmic_score};

use super::judge::Found;
use super::{FindingRecord, Hidden, OUTSIDE, Outcome, Stratum, Study, Wanted, robots};
use crate::tables::counting::{Share, median};
use crate::tables::markdown::{Table, table};
use crate::tables::simulated::NORMAL_95;

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
    let mut table = Table::new("what | of | share | 95 % interval | asked for");
    for Figure {
        what,
        share,
        target,
    } in figures.all.iter().filter(|figure| figure.share.whole > 0)
    {
        let [low, high] = share.interval();
        table.row(format_args!(
            "{what} | {} | {:.2} % | {:.2} to {:.2} % | {}",
            share.whole,
            100.0 * share.ratio(),
            100.0 * low,
            100.0 * high,
            target.map_or("-".to_owned(), |target| target.to_string()),
        ));
    }
    table.text() + "\n"
}

fn counts(study: &Study) -> String {
    let seconds = study.outcomes.iter().map(|o| o.seconds);
    let redraws: usize = study.outcomes.iter().map(|o| o.drawn.redraws).sum();
    let ratios = study.outcomes.iter().filter_map(|o| o.held_out_ratio);
    format!(
        "{} data sets; {} more for whose effect the robot has no reading; {redraws} draws thrown away; {} \
         impossible. Diagnosis: median {:.3} s, largest {:.3} s. Held-out error over that of the \
         true model: median {:.4}.\n\n",
        study.outcomes.len(),
        study.not_applicable,
        study.impossible.len(),
        median_or(0.0, seconds.clone()),
        seconds.fold(0.0, f64::max),
        median_or(1.0, ratios),
    )
}

/// The median, or a number for none.
fn median_or(none: f64, values: impl Iterator<Item = f64>) -> f64 {
    let median = median(values);
    if median.is_nan() { none } else { median }
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
    let mut table = Table::new(&format!("effect | {}", names.join(" | ")));
    for id in ids {
        if !cells.keys().any(|(effect, _)| effect == id) {
            continue;
        }
        let cells = names.iter().map(|name| cells.get(&(*id, *name)));
        let row: Vec<&str> = cells.map(|cell| cell.map_or("-", String::as_str)).collect();
        table.row(format_args!("{id} | {}", row.join(" | ")));
    }
    format!("{caption}\n\n{}\n", table.text())
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
    let rows = counts.iter();
    let rows = rows.map(|((hidden, said), times)| format!("{hidden} | {said} | {times}"));
    let table = table("hidden | said | times", rows);
    format!("Confusions; in brackets what was said besides the truth.\n\n{table}\n")
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
    let hidden = match &outcome.drawn.hidden {
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
    let rows = errors.into_iter().map(|((effect, parameter), errors)| {
        let Share { part, whole } = Share::of(&errors, |e| e.abs() < NORMAL_95);
        let squares: f64 = errors.iter().map(|e| e * e).sum();
        let rms = (squares / whole as f64).sqrt();
        format!("{effect} | {parameter} | {part}/{whole} | {rms:.2}")
    });
    table("effect | parameter | covered | rms error, sd", rows)
}

/// Describes a dataset and its outcome in one line.
#[must_use]
pub fn describe(outcome: &Outcome) -> String {
    let hidden = match &outcome.drawn.hidden {
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
    let text = match said.verdict {
        Verdict::Unknown => said.text.clone(),
        Verdict::Named | Verdict::Ambiguous => each.collect::<Vec<_>>().join(" or "),
    };
    format!("{text} ({:.1})", said.gain)
}

#[cfg(test)]
mod tests;
