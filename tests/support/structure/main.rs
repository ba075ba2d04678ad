//! Checks the imports between crates and modules of Tautline, and lists violations of the rules:
//!
//!     cargo run --package tautline-structure
//!
//! Code for tests is left out: it may import anything that it tests. With `-- lines` it prints the lines of every crate.

mod imports;
mod lines;
mod modules;
mod rules;
mod tokens;

#[cfg(test)]
mod tests;

use std::path::Path;
use std::process::ExitCode;

use crate::imports::{crates_mentioned, imports};
use crate::lines::Lines;
use crate::modules::Crate;
use crate::rules::{circles, disorder};

/// Rules of a crate: the crates of ours that it may import, and the order of its top-level modules.
#[derive(Debug)]
struct Rules<'a> {
    folder: &'a str,
    /// Crates that it may import.
    crates: &'a [&'a str],
    /// Top-level modules, from the bottom to the top; empty where circles are all that is checked.
    order: &'a [&'a str],
}

/// The crates in the order of their dependencies. `main.rs` of the workbench is not looked at: it
/// chooses between window and commands.
const CRATES: [Rules; 11] = [
    Rules {
        folder: "src/core",
        crates: &[],
        order: &[],
    },
    Rules {
        folder: "src/files",
        crates: &[],
        order: &[],
    },
    Rules {
        folder: "src/channels",
        crates: &["tautline_files"],
        order: &[],
    },
    Rules {
        folder: "src/session",
        crates: &["tautline_core", "tautline_files"],
        order: &[],
    },
    Rules {
        folder: "src/import",
        crates: &[
            "tautline_core",
            "tautline_files",
            "tautline_session",
            "tautline_channels",
        ],
        order: &[],
    },
    Rules {
        folder: "src/link",
        crates: &["tautline_core", "tautline_session"],
        order: &[],
    },
    Rules {
        folder: "src/workflow",
        crates: &[
            "tautline_core",
            "tautline_files",
            "tautline_session",
            "tautline_channels",
            "tautline_import",
            "tautline_link",
        ],
        order: &[],
    },
    Rules {
        folder: "src/study",
        crates: &[
            "tautline_core",
            "tautline_files",
            "tautline_session",
            "tautline_workflow",
        ],
        order: &[],
    },
    Rules {
        folder: "src/python",
        crates: &[
            "tautline_core",
            "tautline_files",
            "tautline_session",
            "tautline_channels",
            "tautline_import",
            "tautline_workflow",
            "tautline_study",
        ],
        order: &[],
    },
    Rules {
        folder: "src/cli",
        crates: &[
            "tautline_core",
            "tautline_files",
            "tautline_session",
            "tautline_channels",
            "tautline_import",
            "tautline_link",
            "tautline_workflow",
            "tautline_study",
        ],
        order: &[],
    },
    Rules {
        folder: "src/workbench",
        crates: &[
            "tautline_core",
            "tautline_files",
            "tautline_session",
            "tautline_channels",
            "tautline_import",
            "tautline_link",
            "tautline_workflow",
            "tautline_study",
        ],
        order: &[
            "model", "commands", "theme", "widgets", "views", "screens", "shell", "lib",
        ],
    },
];

fn main() -> ExitCode {
    let repository = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../../.."));
    if std::env::args()
        .nth(1)
        .is_some_and(|argument| argument == "lines")
    {
        return match print_lines(repository) {
            Ok(()) => ExitCode::SUCCESS,
            Err(error) => {
                println!("error: {error}");
                ExitCode::FAILURE
            }
        };
    }
    let mut count = 0;
    for rules in &CRATES {
        let root = repository.join(rules.folder);
        match violations(&root, rules) {
            Ok(found) => {
                count += found.len();
                found.iter().for_each(|violation| println!("{violation}"));
            }
            Err(error) => {
                count += 1;
                println!("error: {error}");
            }
        }
    }
    if count == 0 {
        println!("imports point one way");
        return ExitCode::SUCCESS;
    }
    println!("{count} violations of the structure in docs/ARCHITECTURE.md");
    ExitCode::FAILURE
}

/// Prints the lines of every crate, of all of them, and of the suites across crates.
fn print_lines(repository: &Path) -> Result<(), String> {
    let print =
        |name: &str, lines: Lines| println!("{name:16}{:8}{:8}", lines.production, lines.tests);
    println!("{:16}{:>8}{:>8}", "", "program", "tests");
    let mut sum = Lines::default();
    for rules in &CRATES {
        let lines = Lines::of_folder(&repository.join(rules.folder))?;
        print(rules.folder, lines);
        sum = sum.plus(lines);
    }
    print("src", sum);
    let suites = Lines::of_folder(&repository.join("tests"))?;
    print(
        "tests",
        Lines {
            production: 0,
            tests: suites.production + suites.tests,
        },
    );
    Ok(())
}

/// The violations in the crate whose `lib.rs` lies in `root`; that of a circle has a line for each import.
fn violations(root: &Path, rules: &Rules) -> Result<Vec<String>, String> {
    let krate = Crate::read(&root.join("lib.rs"))?;
    let name = |file: &Path| {
        let below = file.strip_prefix(root).unwrap_or(file);
        format!("{}/{}", rules.folder, below.display())
    };
    let mut found = Vec::new();
    for (other, file, line) in crates_mentioned(&krate) {
        if other.starts_with("tautline_") && !rules.crates.contains(&other.as_str()) {
            found.push(format!("{}:{line}: may not import {other}", name(&file)));
        }
    }
    let imports = imports(&krate);
    if !rules.order.is_empty() {
        let disorder = disorder(&imports, root, rules.order);
        for module in &disorder.without_place {
            found.push(format!(
                "{}: module {module} has no place in the order",
                rules.folder
            ));
        }
        for import in &disorder.upward {
            let (from, to) = (name(&import.from), name(&import.to));
            found.push(format!(
                "{from}:{}: may not import {to} ({})",
                import.line, import.path
            ));
        }
    }
    for circle in circles(&imports) {
        let mut violation = format!(
            "{}: {} files import each other in a circle, by way of",
            rules.folder,
            circle.files.len()
        );
        for import in &circle.imports {
            let (from, to) = (name(&import.from), name(&import.to));
            violation += &format!("\n    {from}:{} -> {to} ({})", import.line, import.path);
        }
        found.push(violation);
    }
    Ok(found)
}
