//! The tables of the study in Markdown.

use std::fmt::Write as _;

use super::forms::{Form, Origin, forms};
use super::{Case, Crowd, Found, Machine, Outcome, Tried};
use crate::tables::lives::share;

/// Largest held-out error relative to that of the true model that counts as equal.
const EQUAL: f64 = 1.05;

/// The table in Markdown.
#[must_use]
pub fn markdown(found: &[(Case, Option<Outcome>)]) -> String {
    let tried: Vec<(&Case, &Tried)> = (found.iter())
        .filter_map(|(case, outcome)| match outcome {
            Some(Outcome::Tried(tried)) => Some((case, tried)),
            _ => None,
        })
        .collect();
    let crowds = found.iter().filter_map(|(case, outcome)| match outcome {
        Some(Outcome::Crowd(crowd)) => Some((case, crowd)),
        _ => None,
    });
    format!(
        "{}\n{}\n{}\n{}\n{}",
        in_grammar(&tried),
        outside_grammar(&tried),
        files(&tried),
        each(&tried),
        ten(&crowds.collect::<Vec<_>>())
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
fn by_machine<'t, T>(of: &[(&'t Case, &'t T)]) -> Vec<(&'static str, Vec<&'t T>)> {
    let only = |machine: Option<Machine>| {
        of.iter()
            .filter(|(case, _)| machine.is_none_or(|machine| case.machine == machine))
            .map(|(_, outcome)| *outcome)
            .collect()
    };
    let mut rows: Vec<_> = Machine::ALL
        .iter()
        .map(|machine| (machine.name(), only(Some(*machine))))
        .collect();
    rows.push(("all", only(None)));
    rows
}

fn count<T>(of: &[&T], is: impl Fn(&T) -> bool) -> usize {
    of.iter().filter(|one| is(one)).count()
}

fn in_grammar(tried: &[(&Case, &Tried)]) -> String {
    let mut text = String::from(
        "| forms in the grammar, machines | data sets | separated by exact evidence | first in the list | in the list | held-out error within 5 % of the true model's |\n\
         |---|--:|--:|--:|--:|--:|\n",
    );
    let own: Vec<_> = (tried.iter().copied())
        .filter(|(_, tried)| tried.form_is_separated.is_some())
        .collect();
    for (name, all) in by_machine(&own) {
        let separated: Vec<&Tried> = (all.iter().copied())
            .filter(|one| one.form_is_separated == Some(true))
            .collect();
        let ratios: Vec<f64> = all.iter().filter_map(|one| one.held_out_ratio).collect();
        let equal = ratios.iter().filter(|ratio| **ratio <= EQUAL).count();
        // Writing to a string cannot fail.
        let _ = writeln!(
            text,
            "| {name} | {} | {} | {} | {} | {} |",
            all.len(),
            separated.len(),
            share(
                count(&separated, |one| one.place == Some(0)),
                separated.len()
            ),
            share(
                count(&separated, |one| one.place.is_some()),
                separated.len()
            ),
            share(equal, ratios.len())
        );
    }
    text
}

fn outside_grammar(tried: &[(&Case, &Tried)]) -> String {
    let mut text = String::from(
        "| forms outside the grammar, machines | data sets | something is unexplained | a pattern is listed | of these, better at held-out poses | median held-out residual, without and with | a cause of the catalogue named before | named beside the patterns |\n\
         |---|--:|--:|--:|--:|--:|--:|--:|\n",
    );
    let own: Vec<_> = (tried.iter().copied())
        .filter(|(_, tried)| tried.form_is_separated.is_none())
        .collect();
    for (name, all) in by_machine(&own) {
        let listed = count(&all, |one| one.patterns > 0);
        let gains: Vec<(f64, f64)> = all.iter().filter_map(|one| one.gain).collect();
        let better = gains
            .iter()
            .filter(|(before, after)| after < before)
            .count();
        let _ = writeln!(
            text,
            "| {name} | {} | {} | {listed} | {} | {:.2}, {:.2} | {} | {} |",
            all.len(),
            count(&all, |one| one.is_unexplained),
            share(better, gains.len()),
            median(gains.iter().map(|gain| gain.0).collect()),
            median(gains.iter().map(|gain| gain.1).collect()),
            share(count(&all, |one| !one.named.is_empty()), all.len()),
            share(
                count(&all, |one| one
                    .named_beside_patterns
                    .iter()
                    .any(|name| !one.named.contains(name))),
                listed
            ),
        );
    }
    text
}

fn files(tried: &[(&Case, &Tried)]) -> String {
    let mut text = String::from(
        "| files beside the data, machines | data sets with a file | separated by exact evidence | named | named or listed | data sets with the file of another form | that one named |\n\
         |---|--:|--:|--:|--:|--:|--:|\n",
    );
    for (kind, of) in [
        ("of the 16", Origin::Outside),
        ("ten of our own", Origin::Own),
    ] {
        let own: Vec<_> = (tried.iter().copied())
            .filter(|(case, _)| origin(case) == Some(of))
            .collect();
        for (name, all) in by_machine(&own) {
            let separated: Vec<&Tried> = (all.iter().copied())
                .filter(|one| one.file_is_separated == Some(true))
                .collect();
            let wrong = count(&all, |one| one.wrong_file_is_named.is_some());
            let _ = writeln!(
                text,
                "| {kind}, {name} | {} | {} | {} | {} | {wrong} | {} |",
                count(&all, |one| one.found.is_some()),
                separated.len(),
                share(count(&separated, is_named), separated.len()),
                share(count(&separated, is_listed), separated.len()),
                share(
                    count(&all, |one| one.wrong_file_is_named == Some(true)),
                    wrong
                ),
            );
        }
    }
    text
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
    let mut text = String::from(
        "| effect outside the catalogue | in the grammar | as a file | separated by exact evidence | named | named or listed |\n\
         |---|---|---|--:|--:|--:|\n",
    );
    for form in forms().filter(|form| form.origin() == Origin::Outside) {
        let own: Vec<_> = (tried.iter().copied())
            .filter(|(case, _)| case.form.as_deref() == Some(form.id))
            .collect();
        let robots = |is: &dyn Fn(&Tried) -> bool| {
            let mut names: Vec<&str> = (own.iter())
                .filter(|(_, tried)| is(tried))
                .map(|(case, _)| case.robot.as_str())
                .collect();
            names.sort_unstable();
            names.join(", ")
        };
        let in_grammar = robots(&|one| one.form_is_separated.is_some());
        let without = robots(&|one| one.not_a_file.is_some());
        let reason = own.iter().find_map(|(_, one)| one.not_a_file.as_ref());
        let separated: Vec<&Tried> = (own.iter())
            .map(|(_, tried)| *tried)
            .filter(|one| one.file_is_separated == Some(true))
            .collect();
        let with = count(
            &own.iter().map(|(_, one)| *one).collect::<Vec<_>>(),
            |one| one.found.is_some(),
        );
        let file = match reason {
            None => format!("{with} of {}", own.len()),
            Some(reason) => format!("{with} of {}; not on {without}: {reason}", own.len()),
        };
        let _ = writeln!(
            text,
            "| `{}` | {} | {file} | {} | {} | {} |",
            form.id,
            match in_grammar.is_empty() {
                true => "no",
                false => &in_grammar,
            },
            separated.len(),
            count(&separated, is_named),
            count(&separated, is_listed),
        );
    }
    text
}

fn ten(crowds: &[(&Case, &Crowd)]) -> String {
    let mut text = String::from(
        "| ten irrelevant files, machines | data sets | a verdict changes | a file is named | time with them, median | nine tenths below |\n\
         |---|--:|--:|--:|--:|--:|\n",
    );
    for (name, all) in by_machine(crowds) {
        let mut ratios: Vec<f64> = all
            .iter()
            .map(|one| one.seconds[1] / one.seconds[0])
            .collect();
        ratios.sort_by(f64::total_cmp);
        let most = ratios
            .get(ratios.len() * 9 / 10)
            .copied()
            .unwrap_or(f64::NAN);
        let _ = writeln!(
            text,
            "| {name} | {} | {} | {} | {:.2} times | {most:.2} times |",
            all.len(),
            share(count(&all, |one| !one.is_same), all.len()),
            share(count(&all, |one| one.is_file_named), all.len()),
            median(ratios),
        );
    }
    text
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied().unwrap_or(f64::NAN)
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
            Some(Outcome::Tried(Tried {
                form_is_separated: Some(separated),
                place,
                held_out_ratio: Some(1.01),
                ..Tried::default()
            }))
        };
        let text = markdown(&[
            (case("in_grammar_7", Machine::Exact), tried(true, Some(0))),
            (case("in_grammar_8", Machine::Exact), tried(true, None)),
            (case("in_grammar_9", Machine::Exact), tried(false, Some(1))),
            (case("in_grammar_9", Machine::WellKept), None),
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
