//! The audit trail of a session: the author of its entries, and its faults in words.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use tautline_session::{
    Session, Timestamp, TrailAuthor, TrailEntry, TrailFault, TrailPart, VersionedFile,
};

use crate::clock;
use crate::planning::poses_in_words;
use crate::wording::{PROGRAM, count, list};

/// Sentence on the records that a trail covers.
const COVERS: &str = "Covered: the readings, measured and imported, the robot description, the tables of phases 1, 2 and 5, \
                      results, adjustments, verifications and the log. Not covered: plan, excluded poses, settings and names.";
/// Sentence for a trail to which the present version has not added an entry yet.
const COVERED_BEFORE: &str = "Covered: the readings as they were measured, adjustments, verifications and the log. Not covered, until \
                              this version saves the session: imported readings, the robot description, tables and results.";

/// The user who runs the program, by the environment; empty if that does not name one.
#[must_use]
pub fn system_user() -> String {
    let names = ["USER", "LOGNAME", "USERNAME"].iter();
    let mut found = names.filter_map(|name| std::env::var(name).ok());
    found.find(|name| !name.is_empty()).unwrap_or_default()
}

/// Adds a new entry with all unrecorded data of a session to its trail, by the `operator`, or the user of the system if that is
/// empty.
pub fn seal(session: &mut Session, operator: &str) {
    let user = system_user();
    let author = TrailAuthor {
        operator: if operator.trim().is_empty() {
            &user
        } else {
            operator.trim()
        },
        program: PROGRAM,
    };
    session.seal(&author, clock::now());
}

/// Summary of the faults in the trail of an opened session: one sentence without full stop.
#[must_use]
pub fn notice(session: &Session) -> Option<String> {
    if session.trail().is_empty() {
        return None;
    }
    let faults = session.audit();
    let first = faults.first()?;
    let others = match faults.len() - 1 {
        0 => String::new(),
        others => format!("; `tautline audit` lists {}", count(others, "other fault")),
    };
    Some(format!(
        "the audit trail is broken: {}{others}",
        sentence(session, first)
    ))
}

/// The state of the trail for a report.
#[must_use]
pub fn state(session: &Session) -> String {
    let trail = session.trail();
    let Some(last) = trail.last_hash() else {
        return "none".to_owned();
    };
    let entries = match trail.entries().len() {
        1 => "1 entry".to_owned(),
        many => format!("{many} entries"),
    };
    match session.audit().len() {
        0 => format!("{entries}, the last one with the hash {last}"),
        faults => format!(
            "broken ({}), {entries}, the last one with the hash {last}",
            count(faults, "fault")
        ),
    }
}

/// The result of `audit`.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct AuditDocument {
    /// intact, broken, or none: the session has no trail.
    pub verdict: String,
    /// The entries, the oldest first.
    pub entries: Vec<AuditEntry>,
    /// Faults of the trail.
    pub faults: Vec<AuditFault>,
    /// Sentences on the records that the trail covers and on those that it does not.
    #[serde(default)]
    pub covers: String,
    /// Labels of the poses that are in no entry: poses of earlier versions, and poses that such a version imported.
    pub uncovered_poses: Vec<i64>,
    /// Labels of the poses that were imported, or not recorded when they were measured.
    #[serde(default)]
    pub imported_poses: Vec<i64>,
    /// Hash of the last entry.
    pub last_hash: Option<String>,
}

/// An entry of the trail.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct AuditEntry {
    /// Its number, from 1.
    pub entry: usize,
    /// Time.
    pub time: Timestamp,
    /// Operator.
    pub operator: String,
    /// Name and version of the program.
    pub program: String,
    /// Whether the entry records data that the session already had when its trail began.
    pub found: bool,
    /// Recorded data, in words.
    pub what: String,
    /// Hash of the entry.
    pub hash: String,
}

/// A fault of the trail.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct AuditFault {
    /// Number of the entry, from 1; null if no entry has that part.
    pub entry: Option<usize>,
    /// hash, changed, missing, uncovered, or lost (no entry has the requested hash).
    pub kind: String,
    /// The fault in one sentence.
    pub text: String,
}

impl VersionedFile for AuditDocument {
    const FORMAT: &'static str = "tautline-audit";
    const VERSION: u32 = 1;
    const MAX_BYTES: u64 = 64 << 20;
}

impl AuditDocument {
    /// Checks the trail of a session, an entry of which must have the hash `contained`, if one is given.
    #[must_use]
    pub fn of(session: &Session, contained: Option<&str>) -> Self {
        let trail = session.trail();
        let mut faults: Vec<AuditFault> = match trail.is_empty() {
            true => Vec::new(),
            false => session
                .audit()
                .iter()
                .map(|fault| found(session, fault))
                .collect(),
        };
        if let Some(hash) = contained {
            let mut hashes = trail.entries().iter().map(|entry| &entry.hash);
            if !hashes.any(|known| known.eq_ignore_ascii_case(hash)) {
                faults.push(AuditFault {
                    entry: None,
                    kind: "lost".to_owned(),
                    text: format!(
                        "no entry has the hash {hash}: it is of another session, the file is an older copy, or the trail was computed anew"
                    ),
                });
            }
        }
        let verdict = match (trail.is_empty(), faults.is_empty()) {
            (true, _) => "none",
            (false, true) => "intact",
            (false, false) => "broken",
        };
        Self {
            verdict: verdict.to_owned(),
            entries: (1..)
                .zip(trail.entries())
                .map(|(number, entry)| AuditEntry {
                    entry: number,
                    time: entry.time,
                    operator: entry.operator.clone(),
                    program: entry.program.clone(),
                    found: entry.found,
                    what: what(session, entry),
                    hash: entry.hash.clone(),
                })
                .collect(),
            faults,
            covers: match trail.has_state() {
                true => COVERS,
                false => COVERED_BEFORE,
            }
            .to_owned(),
            uncovered_poses: match trail.has_state() {
                true => Vec::new(),
                false => session.imported_poses(),
            },
            imported_poses: session.imported_poses(),
            last_hash: trail.last_hash().map(str::to_owned),
        }
    }
}

fn found(session: &Session, fault: &TrailFault) -> AuditFault {
    let (kind, entry) = match fault {
        TrailFault::Hash(entry) => ("hash", Some(entry)),
        TrailFault::Changed(_, entry) => ("changed", Some(entry)),
        TrailFault::Missing(_, entry) => ("missing", Some(entry)),
        TrailFault::Uncovered(_) => ("uncovered", None),
    };
    AuditFault {
        entry: entry.map(|number| number + 1),
        kind: kind.to_owned(),
        text: sentence(session, fault),
    }
}

fn sentence(session: &Session, fault: &TrailFault) -> String {
    let recorded = |number: usize| match session.trail().entries().get(number) {
        Some(entry) => format!(
            "recorded{} on {} in entry {}",
            by(&entry.operator),
            entry.time,
            number + 1
        ),
        None => "recorded last".to_owned(),
    };
    match fault {
        TrailFault::Hash(number) => format!(
            "entry {} does not have its hash: its operator, time, program or records were changed, or an entry was removed or inserted before it",
            number + 1
        ),
        TrailFault::Changed(part, number) => {
            format!("{} not as {}", part_is(*part), recorded(*number))
        }
        TrailFault::Missing(part, number) => {
            format!("{} gone, which was {}", part_is(*part), recorded(*number))
        }
        TrailFault::Uncovered(part) => {
            format!("{} in no entry: another program added it", part_is(*part))
        }
    }
}

/// ` by Ada`; empty if the operator is not named.
fn by(operator: &str) -> String {
    match operator {
        "" => String::new(),
        name => format!(" by {name}"),
    }
}

/// The subject of a sentence on a part, with its verb.
fn part_is(part: TrailPart) -> String {
    match part {
        TrailPart::Pose(0) => "the readings at home are".to_owned(),
        TrailPart::Pose(label) => format!("the readings of pose {label} are"),
        TrailPart::Adjustment(number) => format!("adjustment {} is", number + 1),
        TrailPart::Verification(number) => format!("verification {} is", number + 1),
        TrailPart::StoppedVerification(number) => {
            format!("verification {} of those that ended early is", number + 1)
        }
        TrailPart::ForeignWrite(number) => {
            format!("change {} of the controller by others is", number + 1)
        }
        TrailPart::Log(number) => format!("step {} of the log is", number + 1),
        TrailPart::Result(number) => format!("result {} is", number + 1),
        TrailPart::Robot => "the robot description is".to_owned(),
        TrailPart::Tables => "the tables of phases 1, 2 and 5 are".to_owned(),
        TrailPart::Imported => "the imported poses are".to_owned(),
    }
}

/// Data that an entry records: `25 poses and the home pose, adjustment 1 (31 values) and 2 steps of the log`.
fn what(session: &Session, entry: &TrailEntry) -> String {
    let parts = || entry.records.iter().map(|record| record.part);
    let mut words = Vec::new();
    let poses: Vec<i64> = parts()
        .filter_map(|part| match part {
            TrailPart::Pose(label) => Some(label),
            _ => None,
        })
        .collect();
    if !poses.is_empty() {
        words.push(poses_in_words(poses));
    }
    for part in parts() {
        match part {
            TrailPart::Pose(_) | TrailPart::Log(_) => {}
            TrailPart::Adjustment(number) => {
                let values = session.adjustments().get(number);
                let values = values.map_or(0, |adjustment| adjustment.changes.len());
                words.push(format!(
                    "adjustment {} ({})",
                    number + 1,
                    count(values, "value")
                ));
            }
            TrailPart::Verification(number) => words.push(format!("verification {}", number + 1)),
            TrailPart::StoppedVerification(_) => {
                words.push("a verification that ended early".to_owned());
            }
            TrailPart::ForeignWrite(_) => {
                words.push("a change of the controller by others".to_owned());
            }
            TrailPart::Result(number) => words.push(format!("result {}", number + 1)),
            TrailPart::Robot => words.push("the robot description".to_owned()),
            TrailPart::Tables => words.push("the tables of the phases".to_owned()),
            TrailPart::Imported => words.push("the imported poses".to_owned()),
        }
    }
    words.dedup();
    let steps = parts()
        .filter(|part| matches!(part, TrailPart::Log(_)))
        .count();
    if steps > 0 {
        words.push(format!("{} of the log", count(steps, "step")));
    }
    list(&words)
}
