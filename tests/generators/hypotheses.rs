//! The worked example of docs/HYPOTHESES.md: its hypothesis files, and the output of its commands.

use std::path::{Path, PathBuf};

use anyhow::Result;

use crate::support::console_page;

/// Beginning of a hypothesis file in the page, before its name.
const FILE: &str = "```toml\n# ";

/// The page.
#[must_use]
pub fn page() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/HYPOTHESES.md")
}

/// The hypothesis files that the page shows: a block whose first line is a comment with the name.
#[must_use]
pub fn files(page: &str) -> Vec<(String, String)> {
    let blocks = page.split(FILE).skip(1);
    let file = |block: &str| {
        let (content, _) = block.split_once("```")?;
        let (name, _) = content.split_once(':')?;
        Some((name.to_owned(), format!("# {content}")))
    };
    blocks.filter_map(file).collect()
}

/// The page with the present output of its commands.
///
/// # Errors
/// If a command fails.
pub fn with_outputs(page: &str) -> Result<String> {
    console_page::with_outputs(page, &files(page))
}

/// Writes the outputs into the page.
///
/// # Errors
/// If a command fails or a file cannot be written.
pub fn write() -> Result<()> {
    let text = with_outputs(&std::fs::read_to_string(page())?)?;
    Ok(tautline_session::write_text(&page(), &text)?)
}
