//! Results as documents and in words, shared by commands, screens and sessions.

pub mod comparison;
pub mod diagnosis;
pub mod effects;
pub mod isolability;
pub mod plan;
pub mod precalibration;

use tautline_session::{ResultDocument, ResultRecord, Session, Timestamp, VersionedFile};

/// A result in the form that sessions record, with the fingerprint of the data it was computed from.
pub fn record<D: VersionedFile>(
    session: &Session,
    title: &str,
    document: &D,
    time: Timestamp,
) -> ResultRecord {
    let document = tautline_session::versioned(document);
    ResultRecord {
        time,
        title: title.to_owned(),
        // Serialising fails only for keys that are not strings; these documents have none.
        document: ResultDocument::of(&document).unwrap_or_default(),
        basis: Some(session.basis()),
    }
}
