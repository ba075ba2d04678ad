//! Sessions in lists.

use std::path::Path;

use tautline_session::{RecentSession, Timestamp};

use super::local_time::date_and_time;

/// What tells a session from others of the same name: `measured 2026-03-02 10:00, mini, monday.json`.
#[must_use]
pub fn session_facts(
    measured: Option<Timestamp>,
    robot: Option<&str>,
    path: Option<&Path>,
) -> String {
    let measured = measured.map(|time| format!("measured {}", date_and_time(time)));
    let file = path.and_then(Path::file_name);
    let file = file.map(|file| file.to_string_lossy().into_owned());
    let facts = [measured, robot.map(str::to_owned), file];
    facts.into_iter().flatten().collect::<Vec<_>>().join(", ")
}

/// The same of a session that was open before.
#[must_use]
pub fn recent_facts(recent: &RecentSession) -> String {
    session_facts(
        recent.measured,
        recent.robot.as_deref(),
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
        let all = session_facts(Some(time), Some("mini"), Some(path));
        assert!(all.starts_with("measured 2018-07-23 ") && all.ends_with(", mini, monday.json"));
        assert_eq!(session_facts(None, None, Some(path)), "monday.json");
        assert_eq!(session_facts(None, Some("mini"), None), "mini");
    }
}
