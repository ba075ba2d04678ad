//! Table with a row for each kind of dataset: results for hidden effects, other findings, computing time.

use std::collections::BTreeMap;
use std::fmt::Write as _;

use super::{Figure, is_found};
use crate::tables::hidden::judge::Found;
use crate::tables::hidden::{Circumstances, Outcome, Study, Wanted};

/// Short description of what is hidden.
pub(super) fn name(wanted: Wanted) -> &'static str {
    match wanted {
        Wanted::Nothing => "nothing",
        Wanted::One(..) => "one effect",
        Wanted::Any => "one visible effect",
        Wanted::Separated => "one effect, no other like it",
        Wanted::Two => "two effects",
        Wanted::Several => "three to five effects",
        Wanted::ByChance => "effects by chance",
        Wanted::CommonOffset => "a large common offset",
        Wanted::Families => "families",
        Wanted::Exchanged(_) => "exchanged channels",
        Wanted::Outside(_) => "outside the catalogue",
    }
}

fn kind(outcome: &Outcome) -> (&'static str, Circumstances) {
    (name(outcome.plan.wanted), outcome.plan.circumstances)
}

/// One row for each kind of dataset.
pub(super) fn table(study: &Study) -> String {
    let mut kinds: BTreeMap<(&str, Circumstances), Vec<&Outcome>> = BTreeMap::new();
    for outcome in &study.outcomes {
        kinds.entry(kind(outcome)).or_default().push(outcome);
    }
    let mut text = String::from(
        "| hidden | data sets | effects | named | named or listed | data sets with a wrong name | with nothing said | \
         with `unknown` for no reason | median s | largest s |\n|---|---|---|---|---|---|---|---|---|---|\n",
    );
    for ((name, circumstances), outcomes) in kinds {
        let name = match circumstances {
            Circumstances::AsStated => name.to_owned(),
            other => format!("{name}; {}", other.name()),
        };
        let _ = writeln!(text, "| {name} | {}", row(&outcomes));
    }
    text.push('\n');
    text
}

fn row(outcomes: &[&Outcome]) -> String {
    let visible = outcomes.iter().filter(|outcome| outcome.drawn.visible);
    let found: Vec<Found> = visible.flat_map(|outcome| outcome.found.clone()).collect();
    let effects = |accepted: fn(&Found) -> bool| {
        share(
            found.iter().filter(|found| accepted(found)).count(),
            found.len(),
        )
    };
    let data_sets = |accepted: fn(&Outcome) -> bool| {
        share(
            outcomes.iter().filter(|outcome| accepted(outcome)).count(),
            outcomes.len(),
        )
    };
    let mut seconds: Vec<f64> = outcomes.iter().map(|outcome| outcome.seconds).collect();
    seconds.sort_by(f64::total_cmp);
    format!(
        "{} | {} | {} | {} | {} | {} | {} | {:.2} | {:.2} |",
        outcomes.len(),
        found.len(),
        effects(|found| *found == Found::Named),
        effects(is_found),
        data_sets(|outcome| !outcome.wrong_names.is_empty()),
        data_sets(|outcome| outcome.said.is_empty()),
        data_sets(Outcome::unknown_without_reason),
        seconds[seconds.len() / 2],
        seconds[seconds.len() - 1],
    )
}

/// A share in percent with its 95 % interval.
fn share(count: usize, of: usize) -> String {
    let figure = Figure {
        what: "",
        count,
        of,
        target: None,
    };
    if of == 0 {
        return "-".to_owned();
    }
    let [low, high] = figure.interval().map(|p| 100.0 * p);
    format!(
        "{count}: {:.1} % ({low:.1} to {high:.1})",
        100.0 * figure.share()
    )
}
