#![no_main]

use libfuzzer_sys::fuzz_target;
use tautline_session::parse_hypothesis;

fuzz_target!(|bytes: &[u8]| {
    let hypothesis = match parse_hypothesis(bytes, "hypothesis.toml") {
        Ok(hypothesis) => hypothesis,
        Err(error) => return tautline_fuzz::check_error(&error, "hypothesis.toml"),
    };
    let mut robot = tautline_fuzz::robot();
    robot.add_hypothesis(&hypothesis).expect("the first one");
    robot.check().expect("a robot may carry what was read");
    let path = std::env::temp_dir().join(format!("tautline-fuzz-{}.json", std::process::id()));
    tautline_session::write_robot(&path, &robot).expect("what was read can be written");
    let again = tautline_session::read_robot(&path).expect("and read again");
    assert_eq!(again.value, robot);
});
