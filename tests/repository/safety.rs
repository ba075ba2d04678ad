//! Every test that docs/SAFETY.md names exists.

use std::collections::HashSet;
use std::fs;
use std::path::Path;

const SAFETY: &str = include_str!("../../docs/SAFETY.md");

/// Names of all functions in the Rust files below a folder.
fn functions(folder: &Path, names: &mut HashSet<String>) {
    for entry in fs::read_dir(folder).expect("a folder") {
        let path = entry.expect("an entry").path();
        if path.is_dir() {
            functions(&path, names);
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            let text = fs::read_to_string(&path).expect("a file");
            let found = text.split("fn ").skip(1);
            let found = found.filter_map(|rest| rest.split_once('(').map(|(name, _)| name));
            names.extend(found.map(str::to_owned));
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
    functions(&root.join("src"), &mut known);
    functions(&root.join("tests"), &mut known);
    let named = named(SAFETY);
    assert!(named.len() > 30, "only {} tests are named", named.len());
    let missing: Vec<&&str> = named
        .iter()
        .filter(|name| !known.contains(**name))
        .collect();
    assert!(missing.is_empty(), "{missing:?}");
}
