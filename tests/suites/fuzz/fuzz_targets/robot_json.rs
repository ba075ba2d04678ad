#![no_main]

use libfuzzer_sys::fuzz_target;
use tautline_session::{parse_robot, read_robot, write_robot};

fuzz_target!(|bytes: &[u8]| {
    let robot = match parse_robot(bytes, "robot.json") {
        Ok(loaded) => loaded.value,
        Err(error) => return tautline_fuzz::check_error(&error, "robot.json"),
    };
    let path = std::env::temp_dir().join(format!("tautline-fuzz-{}.json", std::process::id()));
    write_robot(&path, &robot).expect("what was read can be written");
    assert_eq!(read_robot(&path).expect("and read again").value, robot);
});
