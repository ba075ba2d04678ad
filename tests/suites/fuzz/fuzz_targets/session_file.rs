#![no_main]

use libfuzzer_sys::fuzz_target;
use tautline_session::{parse_session, read_session, write_session};

fuzz_target!(|bytes: &[u8]| {
    let session = match parse_session(bytes, "session.json") {
        Ok(loaded) => loaded.value,
        Err(error) => return tautline_fuzz::check_error(&error, "session.json"),
    };
    let path = std::env::temp_dir().join(format!("tautline-fuzz-{}.session", std::process::id()));
    write_session(&path, &session).expect("what was read can be written");
    let again = read_session(&path).expect("and read again").value;
    // NaN is not equal to itself, so the numbers are compared as they print.
    assert_eq!(format!("{again:?}"), format!("{session:?}"));
});
