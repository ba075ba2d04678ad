//! The sample sessions in `sessions/`: their hidden faults, and the generation of their files.

mod make;
mod recipes;
mod rounding;

use std::fs;
use std::path::Path;

use anyhow::{Context, Result};
use tautline_session::write_session;

pub use make::{Made, make};
pub use recipes::{Moved, RECIPES, Recipe};

/// Folder of the sample sessions.
#[must_use]
pub fn folder() -> &'static Path {
    Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../sessions"))
}

/// Makes all sample sessions and writes them below a folder, and keeps other files there.
///
/// # Errors
/// If one cannot be made or written.
pub fn write_all(into: &Path) -> Result<()> {
    for recipe in &RECIPES {
        let path = into.join(recipe.file);
        let made = make(recipe).with_context(|| recipe.file.to_owned())?;
        if let Some(parent) = path.parent() {
            fs::create_dir_all(parent)?;
        }
        write_session(&path, &made.session)?;
    }
    Ok(())
}
