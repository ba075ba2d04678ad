//! Rules of imports.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use crate::imports::Import;

/// Files that import each other in a circle, all of one crate.
#[derive(Debug)]
pub struct Circle {
    pub files: BTreeSet<PathBuf>,
    /// Those imports of the circle that lead from one folder to another; all if it stays in one.
    pub imports: Vec<Import>,
}

/// Largest number of files of one folder that may import each other. Items defined in the `mod.rs` of a folder may be used
/// in all of its files.
const LARGEST_CIRCLE: usize = 2;

/// Circles that are larger than one folder, and those of more than two files within one.
pub fn circles(imports: &BTreeSet<Import>) -> Vec<Circle> {
    let mut graph: BTreeMap<&Path, BTreeSet<&Path>> = BTreeMap::new();
    for import in imports {
        graph.entry(&import.from).or_default().insert(&import.to);
        graph.entry(&import.to).or_default();
    }
    let mut circles = Vec::new();
    for files in strongly_connected(&graph) {
        let folders: BTreeSet<_> = files.iter().map(|file| folder(file)).collect();
        if folders.len() > 1 {
            circles.push(circle(files, imports, |import| {
                folder(&import.from) != folder(&import.to)
            }));
        }
    }
    for targets in graph.values_mut() {
        targets.retain(|to| !is_facade(to));
    }
    for files in strongly_connected(&graph) {
        let folders: BTreeSet<_> = files.iter().map(|file| folder(file)).collect();
        if folders.len() == 1 && files.len() > LARGEST_CIRCLE {
            circles.push(circle(files, imports, |import| !is_facade(&import.to)));
        }
    }
    circles
}

fn circle(
    files: BTreeSet<PathBuf>,
    imports: &BTreeSet<Import>,
    is_shown: impl Fn(&Import) -> bool,
) -> Circle {
    let is_inside = |import: &&Import| {
        files.contains(&import.from) && files.contains(&import.to) && is_shown(import)
    };
    let mut imports: Vec<_> = imports.iter().filter(is_inside).cloned().collect();
    keep_one_of_each(&mut imports);
    Circle { files, imports }
}

/// Whether a file is the facade of a folder: `mod.rs`, or a file with a folder of the same name.
fn is_facade(file: &Path) -> bool {
    file.ends_with("mod.rs") || file.with_extension("").is_dir()
}

/// Keeps one import for each pair of files.
fn keep_one_of_each(imports: &mut Vec<Import>) {
    imports.dedup_by(|a, b| (&a.from, &a.to) == (&b.from, &b.to));
}

/// The folder of a module: `a/b.rs` with a folder `a/b` beside it belongs to that folder.
fn folder(file: &Path) -> PathBuf {
    let own = file.with_extension("");
    if own.is_dir() {
        own
    } else {
        file.parent().unwrap_or(file).to_owned()
    }
}

/// Groups of files that can be reached from each other (two passes of depth-first search).
fn strongly_connected(graph: &BTreeMap<&Path, BTreeSet<&Path>>) -> Vec<BTreeSet<PathBuf>> {
    let mut reversed: BTreeMap<&Path, BTreeSet<&Path>> = BTreeMap::new();
    for (from, targets) in graph {
        for to in targets {
            reversed.entry(to).or_default().insert(from);
        }
    }
    let mut seen = BTreeSet::new();
    let mut finished = Vec::new();
    for start in graph.keys() {
        visit(start, graph, &mut seen, &mut finished);
    }
    let mut seen = BTreeSet::new();
    let mut groups = Vec::new();
    for start in finished.iter().rev() {
        let mut group = Vec::new();
        visit(start, &reversed, &mut seen, &mut group);
        if group.len() > 1 {
            groups.push(group.into_iter().map(Path::to_owned).collect());
        }
    }
    groups
}

fn visit<'a>(
    file: &'a Path,
    graph: &BTreeMap<&'a Path, BTreeSet<&'a Path>>,
    seen: &mut BTreeSet<&'a Path>,
    finished: &mut Vec<&'a Path>,
) {
    if !seen.insert(file) {
        return;
    }
    for next in graph.get(file).into_iter().flatten() {
        visit(next, graph, seen, finished);
    }
    finished.push(file);
}

/// Violations of the order of a crate's top-level modules.
#[derive(Debug, Default)]
pub struct Disorder {
    /// Imports that lead up: to a module that comes later in the order, or beside its importer.
    pub upward: Vec<Import>,
    /// Top-level modules that have no place in the order.
    pub without_place: BTreeSet<String>,
}

/// Compares the imports of the crate in `root` with an order of its top-level modules, from the
/// bottom to the top. Modules that share an entry (separated by spaces) may not import each other.
pub fn disorder(imports: &BTreeSet<Import>, root: &Path, order: &[&str]) -> Disorder {
    let place = |file: &Path| {
        let name = top_level(file, root);
        let is_name = |names: &&str| names.split(' ').any(|known| *known == name);
        let found = order.iter().position(is_name);
        found.map(|place| (place, name.clone())).ok_or(name)
    };
    let mut disorder = Disorder::default();
    for import in imports {
        match (place(&import.from), place(&import.to)) {
            (Ok(from), Ok(to)) => {
                if to.0 > from.0 || to.0 == from.0 && to.1 != from.1 {
                    disorder.upward.push(import.clone());
                }
            }
            (from, to) => {
                let names = [from.err(), to.err()].into_iter().flatten();
                disorder.without_place.extend(names);
            }
        }
    }
    keep_one_of_each(&mut disorder.upward);
    disorder
}

/// The name of a file's top-level module.
fn top_level(file: &Path, root: &Path) -> String {
    let below = file.strip_prefix(root).unwrap_or(file);
    let top = below.iter().next().map_or(below, Path::new);
    top.with_extension("").to_string_lossy().into_owned()
}
