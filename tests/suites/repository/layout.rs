//! Statements of docs/ARCHITECTURE.md about files and modules.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

const ARCHITECTURE: &str = include_str!("../../../docs/ARCHITECTURE.md");
/// Folders of the tables of modules, by the headings above them.
const TABLES: [(&str, &str); 4] = [
    ("Diagnosis", "src/core/diagnosis"),
    ("Workflow", "src/workflow"),
    ("Import", "src/import"),
    ("The workbench", "src/workbench"),
];
/// Folders in which the page names files.
const NAMED_FROM: [&str; 8] = [
    "",
    "docs",
    "src",
    "src/core",
    "src/channels",
    "src/session",
    "src/workbench",
    "src/core/estimation",
];

pub fn root() -> &'static Path {
    Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/.."))
}

/// All Rust files of ours below a folder.
pub fn rust_files(folder: &Path) -> Vec<PathBuf> {
    let entries = fs::read_dir(folder).expect("a folder");
    let paths = entries.map(|entry| entry.expect("an entry").path());
    paths
        .flat_map(|path| {
            if path.is_dir() && path.file_name().is_some_and(|name| name != "target") {
                rust_files(&path)
            } else if path.extension().is_some_and(|extension| extension == "rs") {
                vec![path]
            } else {
                Vec::new()
            }
        })
        .collect()
}

fn all_files() -> Vec<PathBuf> {
    let files: Vec<PathBuf> = ["src", "tests"]
        .iter()
        .flat_map(|folder| rust_files(&root().join(folder)))
        .collect();
    assert!(files.len() > 900, "only {} files", files.len());
    files
}

/// Texts between backticks.
fn code(text: &str) -> impl Iterator<Item = &str> {
    text.split('`').skip(1).step_by(2)
}

/// The names in the first column of the table below a heading.
fn modules_in_table(heading: &str) -> BTreeSet<&'static str> {
    let section = ARCHITECTURE
        .split("\n## ")
        .find(|section| section.starts_with(&format!("{heading}\n")))
        .expect("a section");
    let rows = section.lines().filter(|line| line.starts_with("| `"));
    rows.flat_map(|row| code(row.split('|').nth(1).expect("a cell")))
        .collect()
}

/// Modules of a folder, except its tests.
fn modules_of(folder: &Path) -> BTreeSet<String> {
    let entries = fs::read_dir(folder).expect("a folder");
    let paths = entries.map(|entry| entry.expect("an entry").path());
    let modules = paths.filter(|path| {
        path.extension().is_some_and(|extension| extension == "rs") || path.join("mod.rs").is_file()
    });
    let names = modules.map(|path| {
        let stem = path.file_stem().expect("a name");
        stem.to_str().expect("UTF-8").to_owned()
    });
    let roots = ["lib", "main", "mod", "tests"];
    names
        .filter(|name| !roots.contains(&name.as_str()))
        .collect()
}

#[test]
fn a_module_with_submodules_is_a_folder() {
    for file in all_files() {
        let beside = file.with_extension("");
        assert!(
            !beside.is_dir(),
            "{} stands beside a folder",
            file.display()
        );
    }
}

#[test]
fn modules_stand_where_rust_looks_for_them() {
    let attribute = concat!("#[", "path");
    for file in all_files() {
        let text = fs::read_to_string(&file).expect("a file");
        let mut lines = text.lines();
        let found = lines.any(|line| line.trim_start().starts_with(attribute));
        assert!(!found, "{}", file.display());
    }
}

#[test]
fn tables_list_every_module() {
    for (heading, folder) in TABLES {
        let listed: BTreeSet<String> = modules_in_table(heading)
            .iter()
            .map(|&name| name.to_owned())
            .collect();
        assert_eq!(listed, modules_of(&root().join(folder)), "{heading}");
    }
}

#[test]
fn files_that_the_page_names_are_there() {
    let is_path = |text: &&str| {
        text.contains('/')
            && text
                .chars()
                .all(|c| c.is_ascii_alphanumeric() || "/_.-".contains(c))
    };
    let named: Vec<&str> = code(ARCHITECTURE).filter(is_path).collect();
    assert!(named.len() > 40, "only {} paths", named.len());
    for path in named {
        let is_there = |from: &&str| {
            let place = root().join(from).join(path);
            place.exists() || place.with_extension("rs").exists()
        };
        assert!(NAMED_FROM.iter().any(is_there), "{path}");
    }
}
