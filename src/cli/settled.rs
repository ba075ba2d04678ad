//! The exit code of `adjust` after it settled an earlier attempt instead of doing what was requested.

use std::fmt;

/// Exit code of `adjust` if it settled an earlier, interrupted attempt and wrote nothing else.
pub const EXIT_CODE: u8 = 4;

/// An earlier attempt was settled; the result states the values in the controller.
#[derive(Debug)]
pub struct Settled;

impl fmt::Display for Settled {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(
            "an earlier attempt was settled, nothing else was written: run the same command again",
        )
    }
}

impl std::error::Error for Settled {}
