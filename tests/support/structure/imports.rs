//! Imports between files, resolved through re-exports: an import leads to the file that defines the item.

use std::collections::BTreeSet;
use std::path::PathBuf;

use crate::modules::{Crate, Module, ModulePath};

/// Import of an item by one file from another file of the same crate.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Import {
    pub from: PathBuf,
    pub to: PathBuf,
    pub line: usize,
    /// The path as written.
    pub path: String,
}

/// Target of a path.
#[derive(Debug)]
enum Target<'a> {
    Module(&'a ModulePath),
    Item(&'a ModulePath, &'a Module),
}

/// The first words of paths that lead to another crate, with file and line.
pub fn crates_mentioned(krate: &Crate) -> BTreeSet<(String, PathBuf, usize)> {
    let mut found = BTreeSet::new();
    for module in krate.modules.values() {
        for mention in &module.mentions {
            found.insert((mention.path[0].clone(), module.file.clone(), mention.line));
        }
    }
    found
}

/// All imports between different files of a crate. A module that re-exports items of its own children does not import them:
/// it is the table of contents of a folder.
pub fn imports(krate: &Crate) -> BTreeSet<Import> {
    let mut found = BTreeSet::new();
    for (path, module) in &krate.modules {
        let mut add = |target: Option<&Module>, written: &[String], line| {
            if let Some(target) = target.filter(|target| target.file != module.file) {
                found.insert(Import {
                    from: module.file.clone(),
                    to: target.file.clone(),
                    line,
                    path: written.join("::"),
                });
            }
        };
        for mention in &module.mentions {
            match resolve(krate, path, &mention.path, 0) {
                Some(Target::Item(at, _)) if mention.is_reexport && at.starts_with(path) => {}
                Some(Target::Item(_, target)) => add(Some(target), &mention.path, mention.line),
                // A module by itself is not an import: the items used from it are mentioned separately.
                Some(Target::Module(_)) | None => {}
            }
        }
        for glob in &module.globs {
            if let Some(Target::Module(target)) = resolve(krate, path, glob, 0) {
                add(krate.modules.get(target), glob, 0);
            }
        }
    }
    found
}

/// Follows a path from a module; `None` if it leads out of the crate.
fn resolve<'a>(
    krate: &'a Crate,
    from: &ModulePath,
    path: &[String],
    depth: usize,
) -> Option<Target<'a>> {
    const MOST_REEXPORTS: usize = 16;
    if depth > MOST_REEXPORTS {
        return None;
    }
    let mut at = from.clone();
    let mut rest = path;
    let mut is_relative = false;
    while let [first, others @ ..] = rest {
        match first.as_str() {
            "crate" => at.clear(),
            "self" => {}
            "super" => {
                at.pop()?;
            }
            _ => break,
        }
        is_relative = true;
        rest = others;
    }
    // After `crate::` and the like the name has to be there; else it may be a crate's.
    let mut is_first = !is_relative;
    loop {
        let (key, module) = krate.modules.get_key_value(&at)?;
        let [name, others @ ..] = rest else {
            return Some(Target::Module(key));
        };
        let mut child = at.clone();
        child.push(name.clone());
        let is_module = krate.modules.contains_key(&child);
        if is_module && !others.is_empty() {
            at = child;
        } else if module.items.contains(name) {
            return Some(Target::Item(key, module));
        } else if let Some(import) = module.imports.get(name).filter(|import| *import != rest) {
            match resolve(krate, &at, import, depth + 1)? {
                Target::Module(target) if !others.is_empty() => at = target.clone(),
                target => return Some(target),
            }
        } else if is_module {
            at = child;
        } else {
            let of_glob = module.globs.iter().find_map(|glob| {
                let mut long = glob.clone();
                long.extend_from_slice(rest);
                resolve(krate, &at, &long, depth + 1)
            });
            // A name that a macro has made is taken for the module's own.
            return of_glob.or((!is_first).then_some(Target::Item(key, module)));
        }
        rest = others;
        is_first = false;
    }
}
