#![no_main]

use std::sync::LazyLock;

use libfuzzer_sys::fuzz_target;
use tautline_core::robot::Robot;
use tautline_session::{read_poses, write_poses};

static ROBOT: LazyLock<Robot> = LazyLock::new(tautline_fuzz::robot);

fuzz_target!(|bytes: &[u8]| {
    let measurements = match read_poses(bytes, "poses.csv", &ROBOT) {
        Ok(loaded) => loaded.value,
        Err(error) => return tautline_fuzz::check_error(&error, "poses.csv"),
    };
    let mut written = Vec::new();
    write_poses(&mut written, &measurements).expect("what was read can be written");
    let again = read_poses(&written[..], "poses.csv", &ROBOT).expect("and read again");
    // NaN is not equal to itself, so the numbers are compared as they print.
    assert_eq!(format!("{:?}", again.value), format!("{measurements:?}"));
});
