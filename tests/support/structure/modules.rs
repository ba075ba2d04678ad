//! The modules of a crate: the items that each defines, imports and mentions.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

use crate::tokens::{Token, tokens};

/// A module path without the crate: `["views", "plots"]`; the crate's root is empty.
pub type ModulePath = Vec<String>;

/// A mention of a path, as written: `["super", "plots", "Figure"]`.
#[derive(Debug)]
pub struct Mention {
    pub path: Vec<String>,
    pub line: usize,
    /// Whether the mention is a re-export, `pub use`.
    pub is_reexport: bool,
}

/// A module, in a file of its own or inside of another.
#[derive(Debug, Default)]
pub struct Module {
    pub file: PathBuf,
    /// Names of the items that the module defines, without imported ones.
    pub items: BTreeSet<String>,
    /// Imported paths by their names in the module.
    pub imports: BTreeMap<String, Vec<String>>,
    /// Modules of which everything is imported.
    pub globs: Vec<Vec<String>>,
    pub mentions: Vec<Mention>,
}

/// A crate of the repository. Code for tests is left out.
#[derive(Debug)]
pub struct Crate {
    pub modules: BTreeMap<ModulePath, Module>,
}

impl Crate {
    /// Reads the crate of a root file (`lib.rs` or `main.rs`) with all of its modules.
    ///
    /// # Errors
    /// If a file cannot be read or a module has no file.
    pub fn read(root: &Path) -> Result<Self, String> {
        let mut modules = BTreeMap::new();
        let folder = root.parent().unwrap_or(Path::new(""));
        read_file(root, folder, &Vec::new(), &mut modules)?;
        Ok(Self { modules })
    }
}

/// Reads a file and the files of its child modules, which lie in `folder`.
fn read_file(
    file: &Path,
    folder: &Path,
    path: &ModulePath,
    modules: &mut BTreeMap<ModulePath, Module>,
) -> Result<(), String> {
    let source =
        fs::read_to_string(file).map_err(|error| format!("{}: {error}", file.display()))?;
    let tokens = tokens(&source);
    let mut parser = Parser {
        tokens: &tokens,
        at: 0,
        file,
        modules,
        children: Vec::new(),
    };
    parser.module(path);
    for child in parser.children {
        let name = child.last().cloned().unwrap_or_default();
        let inside = folder.join(child[path.len()..].join("/"));
        let beside = inside.with_file_name(format!("{name}.rs"));
        let nested = inside.join("mod.rs");
        let found = if beside.is_file() { beside } else { nested };
        read_file(&found, &inside, &child, modules)?;
    }
    Ok(())
}

struct Parser<'a> {
    tokens: &'a [Token<'a>],
    at: usize,
    file: &'a Path,
    modules: &'a mut BTreeMap<ModulePath, Module>,
    /// Modules that are declared here and lie in files of their own.
    children: Vec<ModulePath>,
}

impl Parser<'_> {
    fn text(&self, ahead: usize) -> &str {
        self.tokens.get(self.at + ahead).map_or("", |t| t.text)
    }

    fn line(&self) -> usize {
        self.tokens.get(self.at).map_or(0, |t| t.line)
    }

    /// Reads a module up to its closing brace or the end of the file.
    fn module(&mut self, path: &ModulePath) {
        let mut module = Module {
            file: self.file.to_owned(),
            ..Module::default()
        };
        let mut depth = 0;
        while self.at < self.tokens.len() {
            match self.text(0) {
                "#" if self.is_test_attribute() => self.skip_item(),
                "{" => {
                    depth += 1;
                    self.at += 1;
                }
                "}" if depth == 0 => break,
                "}" => {
                    depth -= 1;
                    self.at += 1;
                }
                "mod" if depth == 0 && is_name(self.text(1)) => self.child(path),
                "use" if self.text(1) != "<" => self.import(&mut module),
                "struct" | "enum" | "union" | "trait" | "type" | "fn" | "static" | "const"
                    if depth == 0 && is_name(self.text(1)) =>
                {
                    module.items.insert(self.text(1).to_owned());
                    self.at += 2;
                }
                "macro_rules" if depth == 0 && is_name(self.text(2)) => {
                    module.items.insert(self.text(2).to_owned());
                    self.at += 3;
                }
                word if is_name(word) => self.mention(&mut module),
                _ => self.at += 1,
            }
        }
        self.modules.insert(path.clone(), module);
    }

    /// `#[cfg(test)]`, alone or with further conditions, and `#[test]`.
    fn is_test_attribute(&self) -> bool {
        let words: Vec<_> = (1..6).map(|ahead| self.text(ahead)).collect();
        words.starts_with(&["[", "cfg", "(", "test", ")"])
            || words.starts_with(&["[", "cfg", "(", "all", "("]) && self.text(6) == "test"
            || words.starts_with(&["[", "test", "]"])
    }

    /// Moves behind the item that begins here, which ends at a semicolon or with a block.
    fn skip_item(&mut self) {
        let mut depth = 0;
        while self.at < self.tokens.len() {
            match self.text(0) {
                "{" | "(" | "[" => depth += 1,
                ")" | "]" => depth -= 1,
                "}" => {
                    depth -= 1;
                    if depth == 0 && self.text(1) != ";" && self.text(1) != "," {
                        self.at += 1;
                        return;
                    }
                }
                ";" | "," if depth == 0 => {
                    self.at += 1;
                    return;
                }
                _ => {}
            }
            if depth < 0 {
                return;
            }
            self.at += 1;
        }
    }

    fn child(&mut self, path: &ModulePath) {
        let mut child = path.clone();
        child.push(self.text(1).to_owned());
        if self.text(2) == "{" {
            self.at += 3;
            self.module(&child);
            self.at += 1;
        } else {
            self.children.push(child);
            self.at += 2;
        }
    }

    fn import(&mut self, module: &mut Module) {
        let before = self.at.checked_sub(1).map(|at| self.tokens[at].text);
        // Behind `pub` or the parenthesis of `pub(crate)`.
        let is_reexport = matches!(before, Some("pub" | ")"));
        self.at += 1;
        let first = module.mentions.len();
        self.tree(&[], module);
        for mention in &mut module.mentions[first..] {
            mention.is_reexport = is_reexport;
        }
    }

    /// One tree of a `use` declaration: `a::b`, `a as b`, `a::*`, `a::{b, c::d}`.
    fn tree(&mut self, before: &[String], module: &mut Module) {
        let line = self.line();
        let mut path = before.to_vec();
        while self.at < self.tokens.len() {
            match self.text(0) {
                "::" | "$" => self.at += 1,
                "*" => {
                    self.at += 1;
                    module.globs.push(path);
                    return;
                }
                "{" => {
                    self.at += 1;
                    while self.at < self.tokens.len() && self.text(0) != "}" {
                        self.tree(&path, module);
                        if self.text(0) == "," {
                            self.at += 1;
                        }
                    }
                    self.at += 1;
                    return;
                }
                "as" => {
                    let name = self.text(1).to_owned();
                    self.at += 2;
                    return keep(module, name, path, line);
                }
                word if is_name(word) => {
                    path.push(word.to_owned());
                    self.at += 1;
                }
                _ => break,
            }
        }
        if path.len() > before.len() + 1 || before.is_empty() {
            let name = path.last().cloned().unwrap_or_default();
            return keep(module, name, path, line);
        }
        // `a::{self}` imports `a`.
        if path.last().is_some_and(|last| last == "self") {
            path.pop();
        }
        let name = path.last().cloned().unwrap_or_default();
        keep(module, name, path, line);
    }

    /// A path in code. A single word is none: its import was seen already.
    fn mention(&mut self, module: &mut Module) {
        let line = self.line();
        let mut path = vec![self.text(0).to_owned()];
        self.at += 1;
        while self.text(0) == "::" && is_name(self.text(1)) {
            path.push(self.text(1).to_owned());
            self.at += 2;
        }
        if path.len() > 1 {
            module.mentions.push(Mention {
                path,
                line,
                is_reexport: false,
            });
        }
    }
}

fn keep(module: &mut Module, name: String, path: Vec<String>, line: usize) {
    module.mentions.push(Mention {
        path: path.clone(),
        line,
        is_reexport: false,
    });
    module.imports.insert(name, path);
}

fn is_name(text: &str) -> bool {
    text.starts_with(|c: char| c.is_alphabetic() || c == '_')
}
