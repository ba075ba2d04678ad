//! Every guarantee and every hazard of docs/SAFETY.md names tests, and they exist.

use std::collections::HashSet;
use std::fs;
use std::path::Path;

const SAFETY: &str = include_str!("../../../docs/SAFETY.md");
/// All tests of each row, of which the page names one or two.
const TESTS: &str = include_str!("../../../docs/safety/tests.txt");

/// Names of all tests in the Rust files below a folder.
fn tests(folder: &Path, names: &mut HashSet<String>) {
    for entry in fs::read_dir(folder).expect("a folder") {
        let path = entry.expect("an entry").path();
        if path.is_dir() {
            tests(&path, names);
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            let text = fs::read_to_string(&path).expect("a file");
            let marked = text.split("#[test]").skip(1);
            let marked = marked.filter_map(|rest| rest.split_once("fn ")?.1.split_once('('));
            names.extend(marked.map(|(name, _)| name.to_owned()));
            let listed = text.split("over_all! {").skip(1);
            let listed = listed.filter_map(|rest| rest.split_once('}'));
            for (list, _) in listed {
                names.extend(list.split(',').map(|name| name.trim().to_owned()));
            }
        }
    }
}

/// Names of tests: words in code marks that are joined by three underscores or more.
fn named(text: &str) -> Vec<&str> {
    let marked = text.split('`').skip(1).step_by(2);
    let is_test = |name: &&str| {
        let plain = |c: char| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '_';
        name.chars().all(plain) && name.matches('_').count() >= 3
    };
    marked.filter(is_test).collect()
}

#[test]
fn every_test_that_shows_a_guarantee_exists() {
    let mut known = HashSet::new();
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    tests(&root.join("src"), &mut known);
    tests(&root.join("tests"), &mut known);
    let texts = [SAFETY, TESTS].concat();
    let named = named(&texts);
    assert!(named.len() > 200, "only {} tests are named", named.len());
    let missing: Vec<&&str> = named
        .iter()
        .filter(|name| !known.contains(**name))
        .collect();
    assert!(missing.is_empty(), "{missing:?}");
}

#[test]
fn every_guarantee_and_every_hazard_names_a_test() {
    let is_rule = |line: &&str| line.starts_with("|---");
    let lines: Vec<&str> = SAFETY.lines().collect();
    let mut rows = 0;
    for (at, _) in lines.iter().enumerate().filter(|(_, line)| is_rule(line)) {
        for row in lines[at + 1..]
            .iter()
            .take_while(|line| line.starts_with('|'))
        {
            assert!(!named(row).is_empty(), "{row}");
            for name in named(row) {
                assert!(TESTS.contains(&format!("`{name}`")), "{name}");
            }
            rows += 1;
        }
    }
    assert!(rows > 20, "only {rows} rows");
}
