//! Wall-clock time.

use std::time::{SystemTime, UNIX_EPOCH};

use tautline_session::Timestamp;

/// The present time, to the second.
#[must_use]
pub fn now() -> Timestamp {
    let since = SystemTime::now()
        .duration_since(UNIX_EPOCH)
        .unwrap_or_default();
    Timestamp::from_unix_seconds(i64::try_from(since.as_secs()).unwrap_or(i64::MAX))
}
