//! The audit trail: a chain of hashes over everything that moved the robot or wrote to its controller, over the inputs of its
//! results, and over the log.
//!
//! Each part gets a SHA-256 when the session records it. Saving joins the new records to an entry, with the operator, the
//! program and the hash of the entry before, so that nothing in between can be changed, removed or inserted without notice.
//! Anyone who can write the file can also compute the whole chain anew; to detect this, reports print the last hash.

use std::collections::HashMap;
use std::fmt;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use serde_json::{Value, json};

use super::{Adjustment, MeasurementTable, Outcome, Session, Timestamp, Verification};
use crate::fingerprint::sha256;
use crate::json::value_of;

/// The hash before the first entry.
const ORIGIN: &str = "";
/// Prefix of the columns that only simulated data have.
const TRUTH: &str = "true_";

/// The audit trail of a session.
#[derive(Clone, Default, Serialize, Deserialize, JsonSchema)]
pub struct AuditTrail {
    /// The entries, the oldest first.
    entries: Vec<TrailEntry>,
    /// Parts of [`STATE`] that were found to be other than recorded; nothing makes them right.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    broken: Vec<TrailPart>,
    /// Parts of [`STATE`] that a file has other than recorded.
    #[serde(skip)]
    differing: Vec<TrailPart>,
    /// Records for the next entry.
    #[serde(skip)]
    pending: Vec<TrailRecord>,
}

/// The parts that the program itself changes; saving records their state.
const STATE: [TrailPart; 3] = [TrailPart::Robot, TrailPart::Tables, TrailPart::Imported];

impl PartialEq for AuditTrail {
    /// Records for the next entry are not part of a file.
    fn eq(&self, other: &Self) -> bool {
        self.entries == other.entries
    }
}

impl fmt::Debug for AuditTrail {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_tuple("AuditTrail").field(&self.entries).finish()
    }
}

/// What was recorded between two times of saving.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct TrailEntry {
    /// Time of saving.
    pub time: Timestamp,
    /// Operator.
    pub operator: String,
    /// Name and version of the program.
    pub program: String,
    /// Whether the records are those that a session of an earlier version had when its trail began.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub found: bool,
    /// The records, in the order in which they were made.
    pub records: Vec<TrailRecord>,
    /// SHA-256 of the hash of the entry before and of everything above: 64 hexadecimal digits.
    pub hash: String,
}

/// A part of the session with its hash at that time.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct TrailRecord {
    /// The part.
    pub part: TrailPart,
    /// Its SHA-256: 64 hexadecimal digits.
    pub sha256: String,
}

/// A part of a session that the trail covers. A number is that in its list, from 0.
#[derive(
    Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize, JsonSchema,
)]
#[serde(rename_all = "snake_case")]
pub enum TrailPart {
    /// The readings of the measured pose with this label.
    Pose(i64),
    /// An attempt to write values: when it is begun, and again with its outcome.
    Adjustment(usize),
    /// A run with an external instrument, and again when the robot is accepted on its result.
    Verification(usize),
    /// Such a run that ended early.
    StoppedVerification(usize),
    /// Values that others changed while poses were measured.
    ForeignWrite(usize),
    /// A step in the log.
    Log(usize),
    /// A result.
    Result(usize),
    /// The description of the robot.
    Robot,
    /// The tables of the phases around the poses.
    Tables,
    /// The readings of all imported poses.
    Imported,
}

/// Author of an entry: the operator and the program that saves the session.
#[derive(Debug, Clone, Copy)]
pub struct TrailAuthor<'a> {
    /// Operator.
    pub operator: &'a str,
    /// Name and version of the program.
    pub program: &'a str,
}

/// Fault of an audit trail. Entries are numbered from 0.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum TrailFault {
    /// The hash of an entry is not that of its content and of the entry before.
    Hash(usize),
    /// A part is not what this entry recorded.
    Changed(TrailPart, usize),
    /// A part that this entry recorded is gone.
    Missing(TrailPart, usize),
    /// A part is in no entry.
    Uncovered(TrailPart),
}

impl AuditTrail {
    /// The entries, the oldest first.
    #[must_use]
    pub fn entries(&self) -> &[TrailEntry] {
        &self.entries
    }

    /// Whether the trail has no entries.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.entries.is_empty()
    }

    /// The hash of the last entry.
    #[must_use]
    pub fn last_hash(&self) -> Option<&str> {
        self.entries.last().map(|entry| entry.hash.as_str())
    }

    /// Whether the trail covers the inputs of the results, too. Trails of earlier versions cover only motions and written values.
    #[must_use]
    pub fn has_state(&self) -> bool {
        let mut records = self.entries.iter().flat_map(|entry| &entry.records);
        records.any(|record| record.part == TrailPart::Robot)
    }

    /// The last record of each part with the number of its entry; those that are in no entry yet have the next number.
    fn last_records(&self) -> HashMap<TrailPart, (usize, &str)> {
        let of_entries = self.entries.iter().map(|entry| &entry.records);
        let all = of_entries.chain([&self.pending]).enumerate();
        all.flat_map(|(number, records)| records.iter().map(move |record| (number, record)))
            .map(|(number, record)| (record.part, (number, record.sha256.as_str())))
            .collect()
    }

    fn add(
        &mut self,
        records: Vec<TrailRecord>,
        found: bool,
        (by, now): (&TrailAuthor<'_>, Timestamp),
    ) {
        if records.is_empty() {
            return;
        }
        let mut entry = TrailEntry {
            time: now,
            operator: by.operator.to_owned(),
            program: by.program.to_owned(),
            found,
            records,
            hash: String::new(),
        };
        entry.hash = entry.computed_hash(self.last_hash().unwrap_or(ORIGIN));
        self.entries.push(entry);
    }
}

impl TrailEntry {
    /// The hash of its content after an entry with the hash `before`.
    fn computed_hash(&self, before: &str) -> String {
        let hash = before.to_owned();
        sha256(&value_of(&Self {
            hash,
            ..self.clone()
        }))
    }
}

impl Session {
    /// The audit trail.
    #[must_use]
    pub fn trail(&self) -> &AuditTrail {
        &self.trail
    }

    /// Records the present state of a part for the next entry.
    pub(super) fn cover(&mut self, part: TrailPart) {
        let labels = &self.measurements.labels;
        // The row was added last.
        let row_of = |label| labels.iter().rposition(|known| *known == label);
        let Some(sha256) = self.hash_of(part, &row_of) else {
            return;
        };
        let pending = self.trail.pending.iter_mut();
        match pending.rev().find(|record| record.part == part) {
            Some(record) if record.sha256 == sha256 => {}
            _ => self.trail.pending.push(TrailRecord { part, sha256 }),
        }
    }

    /// Records for the next entry the parts that a killed program left unrecorded: those that are in no entry, except poses,
    /// which may have been imported, and those that were concluded or accepted since their entry.
    pub(crate) fn cover_rest(&mut self) {
        // All differences were made by the program before it was killed.
        self.trail.differing.clear();
        let last = self.trail.last_records();
        let mut parts = self.parts();
        parts.retain(|part| match last.get(part) {
            None => true,
            Some((_, recorded)) => self
                .hash_before(*part)
                .is_some_and(|hash| hash == *recorded),
        });
        for part in parts {
            self.cover(part);
        }
    }

    /// The hash of an adjustment before it was concluded, or of a verification before the robot was accepted; `None` if the part
    /// is in that state still, or never changes.
    fn hash_before(&self, part: TrailPart) -> Option<String> {
        let value = match part {
            TrailPart::Adjustment(number) => {
                let adjustment = self.adjustments.get(number)?;
                value_of(&Adjustment {
                    outcome: Outcome::Begun,
                    read_back: Vec::new(),
                    ..adjustment.clone()
                })
            }
            TrailPart::Verification(number) => {
                let verification = self.verifications.get(number)?;
                value_of(&Verification {
                    accepted: None,
                    ..verification.clone()
                })
            }
            _ => return None,
        };
        Some(sha256(&value)).filter(|before| self.hash_of(part, &|_| None).as_ref() != Some(before))
    }

    /// The parts of [`STATE`] whose last record, if any, is not their present state.
    fn unrecorded_state(&self) -> Vec<TrailRecord> {
        let last = self.trail.last_records();
        let now = STATE.into_iter().filter_map(|part| {
            let sha256 = self.hash_of(part, &|_| None)?;
            Some(TrailRecord { part, sha256 })
        });
        now.filter(|now| last.get(&now.part).is_none_or(|last| last.1 != now.sha256))
            .collect()
    }

    /// Notes the parts of a file that differ from their records because another program changed them.
    pub(super) fn note_differing(&mut self) {
        if self.trail.has_state() {
            let found = self.unrecorded_state().into_iter();
            self.trail.differing = found.map(|record| record.part).collect();
        }
    }

    /// Joins the new records to an entry. The trail of a session of an earlier version begins with its present parts.
    pub fn seal(&mut self, by: &TrailAuthor<'_>, now: Timestamp) {
        let differing = std::mem::take(&mut self.trail.differing);
        self.trail.broken.extend(differing);
        if !self.trail.has_state() {
            let found = self.uncovered().into_iter().filter_map(|part| {
                // Poses are not among the parts.
                let sha256 = self.hash_of(part, &|_| None)?;
                Some(TrailRecord { part, sha256 })
            });
            let found = found.collect();
            self.trail.add(found, true, (by, now));
        }
        let state = self.unrecorded_state().into_iter();
        let state = state.filter(|record| !self.trail.broken.contains(&record.part));
        let state: Vec<TrailRecord> = state.collect();
        let mut new = std::mem::take(&mut self.trail.pending);
        new.extend(state);
        self.trail.add(new, false, (by, now));
    }

    /// Whether every change is in an entry, apart from differences that are known faults.
    #[must_use]
    pub fn is_sealed(&self) -> bool {
        let trail = &self.trail;
        let is_known = |record: TrailRecord| {
            trail.differing.contains(&record.part) || trail.broken.contains(&record.part)
        };
        trail.pending.is_empty() && self.unrecorded_state().into_iter().all(is_known)
    }

    /// Faults of the trail.
    #[must_use]
    pub fn audit(&self) -> Vec<TrailFault> {
        let mut faults = Vec::new();
        let mut before = ORIGIN;
        for (number, entry) in self.trail.entries.iter().enumerate() {
            if entry.computed_hash(before) != entry.hash {
                faults.push(TrailFault::Hash(number));
            }
            before = &entry.hash;
        }
        let labels = self.measurements.labels.iter().copied();
        let rows: HashMap<i64, usize> = labels.zip(0..).collect();
        let row_of = |label| rows.get(&label).copied();
        let mut last: Vec<_> = self.trail.last_records().into_iter().collect();
        last.sort_unstable();
        for (part, (number, recorded)) in last {
            match self.hash_of(part, &row_of) {
                None => faults.push(TrailFault::Missing(part, number)),
                Some(now) if now != recorded => faults.push(TrailFault::Changed(part, number)),
                Some(_) => {}
            }
        }
        let has_state = self.trail.has_state();
        let uncovered = self.uncovered().into_iter();
        let uncovered = uncovered.filter(|p| has_state || !matches!(p, TrailPart::Result(_)));
        faults.extend(uncovered.map(TrailFault::Uncovered));
        faults
    }

    /// Labels of the poses that were not recorded when they were measured: imported ones, and those of earlier versions.
    #[must_use]
    pub fn imported_poses(&self) -> Vec<i64> {
        let rows = self.unmeasured_rows().into_iter();
        rows.map(|row| self.measurements.labels[row]).collect()
    }

    fn unmeasured_rows(&self) -> Vec<usize> {
        let last = self.trail.last_records();
        let labels = self.measurements.labels.iter().enumerate();
        labels
            .filter(|(_, label)| !last.contains_key(&TrailPart::Pose(**label)))
            .map(|(row, _)| row)
            .collect()
    }

    /// All parts that the trail covers when they are made, except poses.
    fn parts(&self) -> Vec<TrailPart> {
        let mut parts: Vec<TrailPart> = (0..self.log.len()).map(TrailPart::Log).collect();
        parts.extend((0..self.adjustments.len()).map(TrailPart::Adjustment));
        parts.extend((0..self.verifications.len()).map(TrailPart::Verification));
        let stopped = 0..self.stopped_verifications.len();
        parts.extend(stopped.map(TrailPart::StoppedVerification));
        parts.extend((0..self.foreign_writes.len()).map(TrailPart::ForeignWrite));
        parts.extend((0..self.results.len()).map(TrailPart::Result));
        parts
    }

    fn uncovered(&self) -> Vec<TrailPart> {
        let last = self.trail.last_records();
        let mut parts = self.parts();
        parts.retain(|part| !last.contains_key(part));
        parts
    }

    /// The hash of the present state of a part, of a pose in the row that `row_of` finds; `None` if there is no such part.
    fn hash_of(&self, part: TrailPart, row_of: &dyn Fn(i64) -> Option<usize>) -> Option<String> {
        let value = match part {
            TrailPart::Pose(label) => self.pose_value(label, row_of(label)?),
            TrailPart::Adjustment(number) => value_of(self.adjustments.get(number)?),
            TrailPart::Verification(number) => value_of(self.verifications.get(number)?),
            TrailPart::StoppedVerification(number) => {
                value_of(self.stopped_verifications.get(number)?)
            }
            TrailPart::ForeignWrite(number) => value_of(self.foreign_writes.get(number)?),
            TrailPart::Log(number) => value_of(self.log.get(number)?),
            TrailPart::Result(number) => value_of(self.results.get(number)?),
            TrailPart::Robot => value_of(&self.robot),
            TrailPart::Tables => value_of(&self.phases),
            TrailPart::Imported => {
                let imported = self.measurements.select(&self.unmeasured_rows());
                value_of(&MeasurementTable::of(&imported).filled(TRUTH))
            }
        };
        Some(sha256(&value))
    }

    /// The readings at a pose without empty cells, which other poses may add to the table, and without true values.
    fn pose_value(&self, label: i64, row: usize) -> Value {
        let table = MeasurementTable::of(&self.measurements.select(&[row]));
        json!({"pose": label, "cells": table.filled(TRUTH).cells()})
    }
}
