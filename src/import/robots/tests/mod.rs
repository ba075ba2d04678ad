//! Descriptions of robots by other programs.

mod caspr;
mod firmware;
mod mujoco;
mod reprap;
mod simulators;
mod wirex;

use super::*;

fn read(files: &[(&str, &str)]) -> Result<Loaded<Robot>, String> {
    let folder = tempfile::tempdir().expect("a folder");
    let paths: Vec<PathBuf> = files
        .iter()
        .map(|(name, text)| {
            let path = folder.path().join(name);
            std::fs::write(&path, text).expect("written");
            path
        })
        .collect();
    let prefix = format!("{}/", folder.path().display());
    read_described(&paths).map_err(|error| error.to_string().replace(&prefix, ""))
}

/// Text of a number; `None` if rounding leaves it unchanged.
fn rounded(parameter: &Parameter, value: f64) -> Option<String> {
    (!parameter.is_unchanged(value)).then(|| parameter.written(value))
}
