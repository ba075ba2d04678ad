#![no_main]

use libfuzzer_sys::fuzz_target;
use tautline_import::{MemoryBudget, import, propose, read_robot_description, read_source};

fuzz_target!(|bytes: &[u8]| {
    let path = std::env::temp_dir().join(format!("tautline-fuzz-{}.foreign", std::process::id()));
    std::fs::write(&path, bytes).expect("written");
    let file = path.display().to_string();
    if let Err(error) = read_robot_description(&[path.clone()]) {
        tautline_fuzz::check_error(&error, &file);
    }
    let source = match read_source(&path) {
        Ok(source) => source,
        Err(error) => return tautline_fuzz::check_error(&error, &file),
    };
    for series in &source.series {
        assert!(series.channels.iter().all(|channel| channel.values.len() == series.rows));
        assert!(series.texts.iter().all(|text| text.codes.len() == series.rows));
    }
    // Whatever was read has a proposal, and the proposal is a recipe of these channels.
    let robot = tautline_fuzz::robot();
    let sources = [source];
    let (recipe, _) = propose(&sources, &robot);
    if let Err(error) = import(&sources, &recipe, "recipe.json", &robot, &MemoryBudget::default()) {
        assert!(!error.to_string().chars().any(char::is_control), "{error}");
    }
});
