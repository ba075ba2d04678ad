//! What the targets share.

use tautline_core::robot::Robot;
use tautline_session::ReadError;

/// The robot whose tables are read.
pub fn robot() -> Robot {
    let json = include_bytes!("seeds/robot_json/planar.json");
    match tautline_session::parse_robot(json, "planar.json") {
        Ok(loaded) => loaded.value,
        Err(error) => panic!("{error}"),
    }
}

/// Every error is one sentence on one line that names the file.
pub fn check_error(error: &ReadError, file: &str) {
    let text = error.to_string();
    assert!(text.starts_with(file), "{text}");
    assert!(!text.chars().any(char::is_control), "{text}");
    assert!(text.len() < 1500, "{text}");
}
