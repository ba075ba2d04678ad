//! The tables of the study in Markdown.

use super::forms::{Form, Origin, forms};
use super::{Case, Crowd, Found, Machine, Outcome, Tried};
use crate::tables::counting::{Share, by_name, count, median};
use crate::tables::markdown::Table;

/// Largest held-out error relative to that of the true model that counts as equal.
const EQUAL: f64 = 1.05;

/// The table in Markdown.
#[must_use]
pub fn markdown(found: &[(Case, Outcome)]) -> String {
    let (mut tried, mut crowds) = (Vec::new(), Vec::new());
    for (case, outcome) in found {
        match outcome {
            Outcome::Tried(one) => tried.push((case, one)),
            Outcome::Crowd(one) => crowds.push((case, one)),
        }
    }
    format!(
        "{}\n{}\n{}\n{}\n{}",
        in_grammar(&tried),
        outside_grammar(&tried),
        files(&tried),
        each(&tried),
        ten(&crowds)
    )
}

fn origin(case: &Case) -> Option<Origin> {
    form(case).map(|form| form.origin())
}

fn form(case: &Case) -> Option<Form> {
    let id = case.form.as_ref()?;
    forms().find(|form| form.id == id)
}

/// Outcomes of each kind of machine, then all.
fn by_machine<'t, T>(
    of: &[(&'t Case, &'t T)],
    is: impl Fn(&Case, &T) -> bool,
) -> Vec<(&'static str, Vec<&'t T>)> {
    let some = of.iter().filter(|(case, one)| is(case, one));
    let some: Vec<_> = some.copied().collect();
    let groups = by_name(&Machine::ALL.map(Machine::name), &some, |case| {
        case.machine.name()
    });
    let groups = groups.into_iter();
    groups
        .map(|(name, of)| (name, of.into_iter().copied().collect()))
        .collect()
}

/// Those that are separated by exact evidence.
fn separated<'t>(all: &[&'t Tried], is: fn(&Tried) -> Option<bool>) -> Vec<&'t Tried> {
    let separated = all.iter().filter(|one| is(one) == Some(true));
    separated.copied().collect()
}

fn in_grammar(tried: &[(&Case, &Tried)]) -> String {
    let mut table = Table::of_numbers(
        "forms in the grammar, machines | data sets | separated by exact evidence | first in the list | in the list | held-out error within 5 % of the true model's",
    );
    for (name, all) in by_machine(tried, |_, one| one.form_is_separated.is_some()) {
        let separated = separated(&all, |one| one.form_is_separated);
        let ratios = all.iter().filter_map(|one| one.held_out_ratio);
        table.row(format_args!(
            "{name} | {} | {} | {} | {} | {}",
            all.len(),
            separated.len(),
            Share::of(&separated, |one| one.place == Some(0)),
            Share::of(&separated, |one| one.place.is_some()),
            Share::of(ratios, |ratio| ratio <= EQUAL)
        ));
    }
    table.text()
}

fn outside_grammar(tried: &[(&Case, &Tried)]) -> String {
    let mut table = Table::of_numbers(
        "forms outside the grammar, machines | data sets | something is unexplained | a pattern is listed | of these, better at held-out poses | median held-out residual, without and with | a cause of the catalogue named before | named beside the patterns",
    );
    let is_named_beside = |one: &Tried| {
        let mut names = one.named_beside_patterns.iter();
        names.any(|name| !one.named.contains(name))
    };
    for (name, all) in by_machine(tried, |_, one| one.form_is_separated.is_none()) {
        let listed = count(&all, |one| one.patterns > 0);
        let gains = all.iter().filter_map(|one| one.gain);
        let beside = Share {
            part: count(&all, is_named_beside),
            whole: listed,
        };
        table.row(format_args!(
            "{name} | {} | {} | {listed} | {} | {:.2}, {:.2} | {} | {beside}",
            all.len(),
            count(&all, |one| one.is_unexplained),
            Share::of(gains.clone(), |(before, after)| after < before),
            median(gains.clone().map(|(before, _)| before)),
            median(gains.map(|(_, after)| after)),
            Share::of(&all, |one| !one.named.is_empty()),
        ));
    }
    table.text()
}

fn files(tried: &[(&Case, &Tried)]) -> String {
    let mut table = Table::of_numbers(
        "files beside the data, machines | data sets with a file | separated by exact evidence | named | named or listed | data sets with the file of another form | that one named",
    );
    for (kind, of) in [
        ("of the 16", Origin::Outside),
        ("ten of our own", Origin::Own),
    ] {
        for (name, all) in by_machine(tried, |case, _| origin(case) == Some(of)) {
            let separated = separated(&all, |one| one.file_is_separated);
            let wrong = all.iter().filter_map(|one| one.wrong_file_is_named);
            let wrong = Share::of(wrong, |is_named| is_named);
            table.row(format_args!(
                "{kind}, {name} | {} | {} | {} | {} | {} | {wrong}",
                count(&all, |one| one.found.is_some()),
                separated.len(),
                Share::of(&separated, |one| is_named(one)),
                Share::of(&separated, |one| is_listed(one)),
                wrong.whole,
            ));
        }
    }
    table.text()
}

fn is_named(tried: &Tried) -> bool {
    tried.found == Some(Found::Named)
}

fn is_listed(tried: &Tried) -> bool {
    let listed = [
        Found::Named,
        Found::Listed,
        Found::ListedNeedlessly,
        Found::ListedLong,
    ];
    tried.found.is_some_and(|found| listed.contains(&found))
}

/// Each of the effects outside the catalogue.
fn each(tried: &[(&Case, &Tried)]) -> String {
    let mut table = Table::aligned(
        "lllr",
        "effect outside the catalogue | in the grammar | as a file | separated by exact evidence | named | named or listed",
    );
    for form in forms().filter(|form| form.origin() == Origin::Outside) {
        let own = tried.iter().copied();
        let own = own.filter(|(case, _)| case.form.as_deref() == Some(form.id));
        let robots = |is: fn(&Tried) -> bool| {
            let of = own.clone().filter(|(_, tried)| is(tried));
            let mut names: Vec<&str> = of.map(|(case, _)| case.robot.as_str()).collect();
            names.sort_unstable();
            names.join(", ")
        };
        let in_grammar = robots(|one| one.form_is_separated.is_some());
        let without = robots(|one| one.not_a_file.is_some());
        let all: Vec<&Tried> = own.clone().map(|(_, tried)| tried).collect();
        let reason = all.iter().find_map(|one| one.not_a_file.as_ref());
        let reason = reason.map(|reason| format!("; not on {without}: {reason}"));
        let separated = separated(&all, |one| one.file_is_separated);
        table.row(format_args!(
            "`{}` | {} | {} of {}{} | {} | {} | {}",
            form.id,
            if in_grammar.is_empty() {
                "no"
            } else {
                &in_grammar
            },
            count(&all, |one| one.found.is_some()),
            all.len(),
            reason.unwrap_or_default(),
            separated.len(),
            count(&separated, is_named),
            count(&separated, is_listed),
        ));
    }
    table.text()
}

fn ten(crowds: &[(&Case, &Crowd)]) -> String {
    let mut table = Table::of_numbers(
        "ten irrelevant files, machines | data sets | a verdict changes | a file is named | time with them, median | nine tenths below",
    );
    for (name, all) in by_machine(crowds, |_, _| true) {
        let ratios = all.iter().map(|one| one.seconds[1] / one.seconds[0]);
        let mut sorted: Vec<f64> = ratios.clone().collect();
        sorted.sort_by(f64::total_cmp);
        let most = sorted.get(sorted.len() * 9 / 10);
        table.row(format_args!(
            "{name} | {} | {} | {} | {:.2} times | {:.2} times",
            all.len(),
            Share::of(&all, |one| !one.is_same),
            Share::of(&all, |one| one.is_file_named),
            median(ratios),
            most.copied().unwrap_or(f64::NAN),
        ));
    }
    table.text()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_not_separated_counts_for_no_share() {
        let case = |form: &str, machine| Case {
            robot: "planar".to_owned(),
            form: Some(form.to_owned()),
            machine,
            seed: 1,
        };
        let tried = |separated, place| {
            Outcome::Tried(Tried {
                form_is_separated: Some(separated),
                place,
                held_out_ratio: Some(1.01),
                ..Tried::default()
            })
        };
        let text = markdown(&[
            (case("in_grammar_7", Machine::Exact), tried(true, Some(0))),
            (case("in_grammar_8", Machine::Exact), tried(true, None)),
            (case("in_grammar_9", Machine::Exact), tried(false, Some(1))),
        ]);
        let row = text
            .lines()
            .find(|line| line.starts_with("| exact | 3 | 2 | "));
        let row = row.expect("a row of exact machines");
        assert!(row.matches("1 of 2: 50.0 %").count() == 2, "{row}");
        assert!(row.contains("3 of 3: 100.0 %"), "{row}");
        assert!(text.contains("| well-kept | 0 | 0 | - |"), "{text}");
    }
}
