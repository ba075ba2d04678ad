//! Table with a row for each kind of dataset: results for hidden effects, other findings, computing time.

use std::collections::BTreeMap;

use super::is_found;
use crate::tables::counting::{Share, median};
use crate::tables::hidden::judge::Found;
use crate::tables::hidden::{Circumstances, Outcome, Study, Wanted};
use crate::tables::markdown::Table;

/// Short description of what is hidden.
fn name(wanted: Wanted) -> &'static str {
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
    let mut table = Table::new(
        "hidden | data sets | effects | named | named or listed | data sets with a wrong name | with nothing said | with `unknown` for no reason | median s | largest s",
    );
    for ((name, circumstances), outcomes) in kinds {
        let besides = match circumstances {
            Circumstances::AsStated => String::new(),
            other => format!("; {}", other.name()),
        };
        table.row(format_args!("{name}{besides} | {}", row(&outcomes)));
    }
    table.text() + "\n"
}

fn row(outcomes: &[&Outcome]) -> String {
    let visible = outcomes.iter().filter(|outcome| outcome.drawn.visible);
    let found: Vec<&Found> = visible.flat_map(|outcome| &outcome.found).collect();
    let effects = |is: fn(&Found) -> bool| Share::of(&found, |found| is(found)).without_whole();
    let sets = |is: fn(&Outcome) -> bool| Share::of(outcomes, |one| is(one)).without_whole();
    let seconds = outcomes.iter().map(|outcome| outcome.seconds);
    format!(
        "{} | {} | {} | {} | {} | {} | {} | {:.2} | {:.2}",
        outcomes.len(),
        found.len(),
        effects(|found| *found == Found::Named),
        effects(is_found),
        sets(|outcome| !outcome.wrong_names.is_empty()),
        sets(|outcome| outcome.said.is_empty()),
        sets(Outcome::unknown_without_reason),
        median(seconds.clone()),
        seconds.fold(0.0, f64::max),
    )
}
