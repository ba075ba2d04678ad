//! The exit code of a command that settled an earlier attempt instead of doing what it was asked for.

use std::fmt;

/// Exit code of `adjust` where it settled an earlier, interrupted attempt and wrote nothing else.
pub const EXIT_CODE: u8 = 4;

/// An earlier attempt was settled; what the controller holds is said in the result.
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
