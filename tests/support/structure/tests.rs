//! Planted violations are found, and similar code without a violation is not.

use std::fs;
use std::path::Path;

use crate::tokens::tokens;
use crate::{Rules, violations};

const RULES: Rules = Rules {
    folder: "planted",
    crates: &["tautline_core"],
    order: &[],
};

/// Violations in a crate of these files.
fn found(rules: &Rules, files: &[(&str, &str)]) -> Vec<String> {
    let folder = tempfile::tempdir().expect("a folder");
    for (name, source) in files {
        let path = folder.path().join(name);
        fs::create_dir_all(path.parent().expect("a folder")).expect("a folder");
        fs::write(path, source).expect("a file");
    }
    violations(folder.path(), rules).expect("a crate")
}

#[test]
fn a_circle_of_two_folders_is_found() {
    let found = found(
        &RULES,
        &[
            ("lib.rs", "pub mod a; pub mod b;"),
            ("a/mod.rs", "mod deep; pub struct A; pub use deep::Deep;"),
            ("a/deep.rs", "use crate::b::B; pub struct Deep(B);"),
            (
                "b/mod.rs",
                "pub struct B;\nfn f() { g!(crate::a::Deep::new()) }",
            ),
        ],
    );
    assert_eq!(
        found,
        ["planted: 2 files import each other in a circle, by way of
    planted/a/deep.rs:1 -> planted/b/mod.rs (crate::b::B)
    planted/b/mod.rs:2 -> planted/a/deep.rs (crate::a::Deep::new)"]
    );
}

#[test]
fn a_circle_of_two_files_of_one_folder_is_allowed_and_one_of_three_is_not() {
    let mut files = [
        ("lib.rs", "pub mod a;"),
        (
            "a/mod.rs",
            "mod b; mod c; mod d; pub use self::{b::B, c::C, d::D}; pub struct A(D);",
        ),
        ("a/b.rs", "use super::{A, C}; pub struct B(C, A);"),
        ("a/c.rs", "use super::A; pub struct C(Option<super::B>, A);"),
        ("a/d.rs", "use super::A; pub struct D(A);"),
    ];
    assert!(found(&RULES, &files).is_empty());
    files[3].1 = "use super::D; pub struct C(D);";
    files[4].1 = "pub struct D(Option<super::B>);";
    assert_eq!(
        found(&RULES, &files),
        ["planted: 3 files import each other in a circle, by way of
    planted/a/b.rs:1 -> planted/a/c.rs (super::C)
    planted/a/c.rs:1 -> planted/a/d.rs (super::D)
    planted/a/d.rs:1 -> planted/a/b.rs (super::B)"]
    );
}

/// The item of a facade counts where it is defined, so that a facade makes no circle by itself.
#[test]
fn a_file_beside_its_folder_belongs_to_it() {
    let files = [
        ("lib.rs", "pub mod a;"),
        ("a.rs", "mod b; pub use b::B; pub struct A(B);"),
        ("a/b.rs", "pub struct B(Option<super::A>);"),
    ];
    assert!(found(&RULES, &files).is_empty());
}

/// A folder may use items of the `mod.rs` above it, as long as this only re-exports them.
#[test]
fn a_reexport_is_no_import() {
    let child = ("a/b/mod.rs", "pub struct B(Option<super::A>);");
    let mut files = [
        ("lib.rs", "pub mod a;"),
        ("a/mod.rs", "mod b; pub(crate) use b::B; pub struct A;"),
        child,
    ];
    assert!(found(&RULES, &files).is_empty());
    files[1].1 = "mod b; use b::B; pub struct A(B);";
    assert_eq!(found(&RULES, &files).len(), 1);
}

#[test]
fn tests_comments_and_literals_import_nothing() {
    let files = [
        ("lib.rs", "pub mod a; pub mod b;"),
        (
            "a/mod.rs",
            "pub struct A;
             // crate::b::B
             /* crate::b::B /* nested */ crate::b::B */
             const TEXT: &str = \"crate::b::B \\\" crate::b::B\";
             const RAW: &str = r#\"crate::b::B \" crate::b::B\"#;
             fn f<'a>(_: &'a str) -> char { '\\'' }
             #[cfg(test)]
             mod tests { use crate::b::B; fn f() { B::new() } }
             #[cfg(test)]
             use crate::b::B;",
        ),
        ("b/mod.rs", "use crate::a::A; pub struct B(A);"),
    ];
    assert!(found(&RULES, &files).is_empty());
}

#[test]
fn other_crates_are_those_of_the_rules() {
    let files = [(
        "lib.rs",
        "use tautline_core::robot::Robot;\nfn f() { tautline_cli::run(std::env::args()) }",
    )];
    assert_eq!(
        found(&RULES, &files),
        ["planted/lib.rs:2: may not import tautline_cli"]
    );
}

#[test]
fn an_import_that_leads_up_is_found() {
    let rules = Rules {
        order: &["model", "views charts", "screens", "lib"],
        ..RULES
    };
    let lines = found(
        &rules,
        &[
            ("lib.rs", "mod model; mod views; mod charts; mod screens;"),
            ("model.rs", "pub struct State(pub crate::screens::Panel);"),
            (
                "screens.rs",
                "pub struct Panel; use super::model::State as _;",
            ),
            (
                "views/mod.rs",
                "use crate::{charts, model}; fn f(_: model::State) { charts::draw() }",
            ),
            ("charts.rs", "pub fn draw() {}"),
        ],
    );
    assert_eq!(
        lines,
        [
            "planted/model.rs:1: may not import planted/screens.rs (crate::screens::Panel)",
            "planted/views/mod.rs:1: may not import planted/charts.rs (charts::draw)",
        ]
    );
}

#[test]
fn a_module_without_a_place_is_found() {
    let rules = Rules {
        order: &["a", "lib"],
        ..RULES
    };
    let files = [
        ("lib.rs", "mod a; mod b;"),
        ("a.rs", "pub struct A(crate::b::B);"),
        ("b.rs", "pub struct B;"),
    ];
    assert_eq!(
        found(&rules, &files),
        ["planted: module b has no place in the order"]
    );
}

#[test]
fn words_keep_their_lines() {
    let words = tokens("a\n// b\n\"c\nd\" 'e' 'f g::h");
    let words: Vec<_> = words.iter().map(|word| (word.text, word.line)).collect();
    assert_eq!(words, [("a", 1), ("g", 4), ("::", 4), ("h", 4)]);
}

/// The rules name folders that are there.
#[test]
fn all_crates_are_there() {
    let repository = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../../.."));
    for rules in crate::CRATES {
        assert!(
            repository.join(rules.folder).join("lib.rs").is_file(),
            "{rules:?}"
        );
    }
}
