//! `tautline audit`.

use std::path::{Path, PathBuf};

use anyhow::{Result, anyhow};
use tautline_session::read_session;
use tautline_workflow::audit::AuditDocument;
use tautline_workflow::planning::poses_in_words;
use tautline_workflow::wording::{count, sentence};

use crate::BadInput;
use crate::examples::examples;
use crate::output::{JsonOutput, notice, say};
use crate::table;

/// Number of digits of a hash that the table shows.
const SHOWN: usize = 12;

#[derive(Debug, clap::Args)]
#[command(after_help = examples(&[
    ("Whether anything in a session was changed afterwards", "tautline audit run.json"),
    ("The same as JSON", "tautline audit run.json --json -"),
]))]
pub struct Arguments {
    /// Session file
    #[arg(value_name = "SESSION")]
    session: PathBuf,
    /// Fail unless an entry has this hash, such as the one that a report prints
    #[arg(long, value_name = "HASH")]
    contains: Option<String>,
    #[command(flatten)]
    json: JsonOutput<AuditDocument>,
}

pub fn run(arguments: &Arguments) -> Result<()> {
    let path = &arguments.session;
    let hash = arguments.contains.as_deref();
    let is_hash = |text: &str| text.len() == 64 && text.chars().all(|c| c.is_ascii_hexdigit());
    if let Some(text) = hash.filter(|text| !is_hash(text)) {
        return Err(BadInput::new(format!(
            "--contains: found {text:?}, expected 64 hexadecimal digits"
        )));
    }
    let read = read_session(path)?;
    read.notices.into_iter().for_each(notice);
    let document = AuditDocument::of(&read.value, hash);
    arguments.json.deliver(&document, || print(&document))?;
    result(path, &document)
}

fn result(path: &Path, document: &AuditDocument) -> Result<()> {
    let place = path.display();
    match document.verdict.as_str() {
        "intact" => Ok(()),
        "none" => Err(anyhow!(
            "{place}: has no audit trail; it begins when this version of the program saves the session"
        )),
        _ => Err(anyhow!(
            "{place}: the audit trail is broken: {}",
            count(document.faults.len(), "fault")
        )),
    }
}

fn print(document: &AuditDocument) {
    let heads = ["Entry", "time", "operator", "program", "what", "hash"];
    let mut lines = table::texts(&heads);
    for entry in &document.entries {
        let what = match entry.found {
            true => format!("found when the trail began: {}", entry.what),
            false => entry.what.clone(),
        };
        let cells = [
            entry.entry.to_string(),
            entry.time.to_string(),
            entry.operator.clone(),
            entry.program.clone(),
            what,
            entry.hash.chars().take(SHOWN).collect(),
        ];
        table::push(&mut lines, &cells);
    }
    if !document.entries.is_empty() {
        say!("{lines}");
    }
    say!("{}", document.covers);
    if let [_, ..] = &document.imported_poses[..] {
        let poses = poses_in_words(document.imported_poses.iter().copied());
        say!("imported, or measured by an earlier version: {poses}");
    }
    for fault in &document.faults {
        say!("fault: {}", fault.text);
    }
    if let (Some(hash), true) = (&document.last_hash, document.faults.is_empty()) {
        say!(
            "{}: nothing was changed; last hash {hash}",
            sentence(&document.verdict)
        );
    }
}
