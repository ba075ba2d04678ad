//! Sessions in lists.

use std::path::Path;

use tautline_session::{Outcome, RecentSession, Session, Timestamp, VersionedFile as _};

use super::count;
use super::local_time::date_and_time;
use crate::diagnosis::DiagnosisDocument;

/// State of a session in a few words: accepted, written, or diagnosed with its number of findings; `None` before that.
#[must_use]
pub fn session_verdict(session: &Session) -> Option<String> {
    if session
        .verifications()
        .iter()
        .any(|run| session.acceptance(run).is_some())
    {
        return Some("accepted".to_owned());
    }
    let last = session.adjustments().last();
    if last.is_some_and(|last| last.outcome == Outcome::Written) {
        return Some("written to the controller".to_owned());
    }
    let mut results = session.results().iter().rev();
    let diagnosis = results.find(|one| one.format() == Some(DiagnosisDocument::FORMAT))?;
    match diagnosis.document.value()["findings"].as_array()?.len() {
        0 => Some("no finding".to_owned()),
        several => Some(count(several, "finding")),
    }
}

/// Facts that tell a session from others of the same name: `measured 2026-03-02 10:00, mini, 1 finding, monday.json`.
#[must_use]
pub fn session_facts(
    measured: Option<Timestamp>,
    robot: Option<&str>,
    verdict: Option<&str>,
    path: Option<&Path>,
) -> String {
    let measured = measured.map(|time| format!("measured {}", date_and_time(time)));
    let file = path.and_then(Path::file_name);
    let file = file.map(|file| file.to_string_lossy().into_owned());
    let [robot, verdict] = [robot, verdict].map(|text| text.map(str::to_owned));
    let facts = [measured, robot, verdict, file];
    facts.into_iter().flatten().collect::<Vec<_>>().join(", ")
}

/// The same of a session that was open before.
#[must_use]
pub fn recent_facts(recent: &RecentSession) -> String {
    session_facts(
        recent.measured,
        recent.robot.as_deref(),
        recent.verdict.as_deref(),
        Some(recent.path()),
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_not_known_is_left_out() {
        let path = Path::new("robots/monday.json");
        let time = Timestamp::from_unix_seconds(1_532_336_700);
        let all = session_facts(Some(time), Some("mini"), Some("1 finding"), Some(path));
        assert!(all.starts_with("measured 2018-07-23 "));
        assert!(all.ends_with(", mini, 1 finding, monday.json"));
        assert_eq!(session_facts(None, None, None, Some(path)), "monday.json");
        assert_eq!(session_facts(None, Some("mini"), None, None), "mini");
    }
}
