//! `tautline audit`.

use std::path::{Path, PathBuf};

use anyhow::{Result, anyhow};
use tautline_session::{AuditKey, Folders, read_session};
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
    #[arg(value_name = "SESSION", required_unless_present = "new_key")]
    session: Option<PathBuf>,
    /// Fail unless every entry is signed with this public key
    #[arg(long, value_name = "KEY")]
    signed_by: Option<String>,
    /// Fail unless an entry has this hash, such as the one that a report prints
    #[arg(long, value_name = "HASH")]
    contains: Option<String>,
    /// Make the key with which your programs sign from now on, and print its public key
    #[arg(long, conflicts_with_all = ["session", "signed_by", "contains", "json"])]
    new_key: bool,
    #[command(flatten)]
    json: JsonOutput<AuditDocument>,
}

pub fn run(arguments: &Arguments) -> Result<()> {
    let Some(path) = &arguments.session else {
        return make_key();
    };
    let key = digits("--signed-by", arguments.signed_by.as_deref())?;
    let hash = digits("--contains", arguments.contains.as_deref())?;
    let read = read_session(path)?;
    read.notices.into_iter().for_each(notice);
    let document = AuditDocument::of(&read.value, key, hash);
    arguments.json.deliver(&document, || print(&document))?;
    result(path, &document)
}

/// Makes the key of the user.
fn make_key() -> Result<()> {
    let path = Folders::of_user()?.audit_key();
    if path.exists() {
        return Err(anyhow!(
            "{}: there is a key already; move it away before you make another one",
            path.display()
        ));
    }
    let key = AuditKey::create(&path)?;
    say!(
        "{}: entries are signed with this key from now on",
        path.display()
    );
    say!("public key: {}", key.public());
    Ok(())
}

/// A key or a hash, as it was typed.
fn digits<'a>(option: &str, text: Option<&'a str>) -> Result<Option<&'a str>> {
    let is_valid = |text: &&str| text.len() == 64 && text.chars().all(|c| c.is_ascii_hexdigit());
    match text {
        Some(text) if !is_valid(&text) => Err(BadInput::new(format!(
            "{option}: found {text:?}, expected 64 hexadecimal digits"
        ))),
        text => Ok(text),
    }
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
    let heads = [
        "Entry", "time", "operator", "program", "what", "signed", "hash",
    ];
    let mut lines = table::texts(&heads);
    for entry in &document.entries {
        let what = match entry.found {
            true => format!("found when the trail began: {}", entry.what),
            false => entry.what.clone(),
        };
        let short = |text: &str| text.chars().take(SHOWN).collect::<String>();
        let cells = [
            entry.entry.to_string(),
            entry.time.to_string(),
            entry.operator.clone(),
            entry.program.clone(),
            what,
            entry
                .signed_by
                .as_deref()
                .map_or_else(|| "-".to_owned(), short),
            short(&entry.hash),
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
