//! Functions shared by the fuzz targets.

use tautline_channels::MemoryBudget;
use tautline_files::ReadError;
use tautline_core::robot::Robot;
use tautline_import::{import, propose, read_robot_description, read_source};

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

/// Any file is either read or refused; for every file that is read, the proposal is a valid recipe of its channels.
pub fn check_import(bytes: &[u8]) {
    let path = std::env::temp_dir().join(format!("tautline-fuzz-{}.foreign", std::process::id()));
    std::fs::write(&path, bytes).expect("written");
    let file = path.display().to_string();
    if let Err(error) = read_robot_description(&[path.clone()]) {
        check_error(&error, &file);
    }
    let source = match read_source(&path) {
        Ok(source) => source,
        Err(error) => return check_error(&error, &file),
    };
    for series in &source.series {
        assert!(series.channels.iter().all(|channel| channel.values.len() == series.rows));
        assert!(series.texts.iter().all(|text| text.codes.len() == series.rows));
    }
    let robot = robot();
    let sources = [source];
    let (recipe, _) = propose(&sources, &robot);
    if let Err(error) = import(&sources, &recipe, "recipe.json", &robot, &MemoryBudget::default()) {
        assert!(!error.to_string().chars().any(char::is_control), "{error}");
    }
}
