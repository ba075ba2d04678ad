//! Lines of code that each crate may have. Every line is carried by the next person: raising a number is a commit of its own
//! that says what the lines are worth.

use std::fs;
use std::path::Path;

use crate::layout::{root, rust_files};

/// Crates of `src` with their lines of code: no blanks, no comments, no tests.
const BUDGET: [(&str, usize); 11] = [
    ("channels", 8119),
    ("cli", 7607),
    ("core", 37686),
    ("files", 133),
    ("import", 10812),
    ("link", 10451),
    ("python", 989),
    ("session", 8109),
    ("study", 3180),
    ("workbench", 37455),
    ("workflow", 21154),
];

fn is_of_tests(path: &Path) -> bool {
    path.ends_with("tests.rs") || path.iter().any(|part| part == "tests")
}

fn code_lines(text: &str) -> usize {
    let code = text.split("#[cfg(test)]\nmod tests {").next();
    let lines = code.unwrap_or_default().lines().map(str::trim);
    lines
        .filter(|line| !line.is_empty() && !line.starts_with("//"))
        .count()
}

#[test]
fn no_crate_grows_beyond_its_budget() {
    for (name, budget) in BUDGET {
        let files = rust_files(&root().join("src").join(name));
        let files = files.iter().filter(|path| {
            let inside = path.strip_prefix(root());
            !is_of_tests(inside.expect("a path below the root"))
        });
        let texts = files.map(|path| fs::read_to_string(path).expect("a source"));
        let lines: usize = texts.map(|text| code_lines(&text)).sum();
        assert!(
            lines > budget / 2,
            "{name}: only {lines} lines were found, expected about {budget}"
        );
        assert!(
            lines <= budget,
            "{name} has {lines} lines of code, its budget is {budget}"
        );
    }
    assert_eq!(
        code_lines("// a\nfn f() {}\n\n#[cfg(test)]\nmod tests {\n}\n"),
        1
    );
}
