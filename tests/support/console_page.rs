//! Pages with commands and their output.

use std::path::Path;
use std::process::{Command, Stdio};

use anyhow::{Result, bail};

use crate::support::program::program;

/// The page with the present output of its commands in a folder with these files: after `$ tautline ..` in a block `console`,
/// where any output is shown.
///
/// # Errors
/// If a command fails.
pub fn with_outputs(page: &str, files: &[(String, String)]) -> Result<String> {
    let folder = tempfile::tempdir()?;
    for (name, content) in files {
        let path = folder.path().join(name);
        if let Some(parent) = path.parent() {
            std::fs::create_dir_all(parent)?;
        }
        std::fs::write(path, content)?;
    }
    let mut written = String::new();
    let (mut in_console, mut shown) = (false, true);
    let mut lines = page.lines().peekable();
    while let Some(line) = lines.next() {
        if line.starts_with("```") {
            in_console = line == "```console";
            shown = true;
        }
        if let Some(command) = line.strip_prefix("$ tautline ").filter(|_| in_console) {
            let printed = run(command, folder.path())?;
            written.push_str(line);
            written.push('\n');
            // Shown output is replaced; where none is shown, the command only has to succeed.
            shown = lines
                .peek()
                .is_some_and(|next| next.starts_with("$ ") || next.starts_with("```"));
            if !shown {
                written.push_str(&printed);
            }
        } else if shown || !in_console {
            written.push_str(line);
            written.push('\n');
        }
    }
    Ok(written)
}

/// Standard output and standard error of a command, without blanks at the ends of lines.
fn run(command: &str, folder: &Path) -> Result<String> {
    let output = Command::new(program())
        .args(command.split_whitespace())
        .current_dir(folder)
        .stdin(Stdio::null())
        .output()?;
    let (stdout, stderr) = (
        String::from_utf8(output.stdout)?,
        String::from_utf8(output.stderr)?,
    );
    if !output.status.success() {
        bail!("tautline {command}: {stderr}");
    }
    let lines = stderr.lines().chain(stdout.lines());
    Ok(lines.fold(String::new(), |text, line| {
        format!("{text}{}\n", line.trim_end())
    }))
}
