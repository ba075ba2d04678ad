//! `tautline man`.

use std::path::{Path, PathBuf};

use anyhow::{Context, Result};
use clap::builder::StyledStr;
use clap_mangen::Man;
use clap_mangen::roff::{Roff, roman};

use crate::examples::examples;
use crate::output::{confirm, write_file};
use crate::replace::{OutputFile, permit};

#[derive(Debug, clap::Args)]
#[command(after_help = examples(&[
    ("All pages; man man1/tautline-identify.1 shows one", "tautline man -o man1"),
]))]
pub struct Arguments {
    /// Folder to write the pages to
    #[arg(short, long, value_name = "DIR")]
    out: OutputFile,
}

/// A page: its file, and its text.
type Page = (PathBuf, Vec<u8>);

/// Writes a page for `command` and for each of its subcommands.
pub fn run(arguments: &Arguments, command: clap::Command) -> Result<()> {
    let out: &Path = &arguments.out;
    let mut command = command.disable_help_subcommand(true);
    command.build();
    let mut pages = Vec::new();
    collect(&command, out, &mut pages)?;
    pages.iter().try_for_each(|(file, _)| permit(file, &[]))?;
    std::fs::create_dir_all(out).with_context(|| format!("{} cannot be created", out.display()))?;
    for (file, text) in &pages {
        write_file(file, text)?;
    }
    confirm!("{}: {} pages", out.display(), pages.len());
    Ok(())
}

fn collect(command: &clap::Command, folder: &Path, pages: &mut Vec<Page>) -> std::io::Result<()> {
    let man = Man::new(command.clone())
        .source(format!("Tautline {}", env!("CARGO_PKG_VERSION")))
        .manual("Commands of Tautline");
    let mut text = Vec::new();
    man.render_title(&mut text)?;
    man.render_name_section(&mut text)?;
    man.render_synopsis_section(&mut text)?;
    man.render_description_section(&mut text)?;
    man.render_options_section(&mut text)?;
    if command.has_subcommands() {
        man.render_subcommands_section(&mut text)?;
    }
    if let Some(help) = command.get_after_help() {
        below_options(help).to_writer(&mut text)?;
    }
    pages.push((folder.join(man.get_filename()), text));
    for one in command.get_subcommands().filter(|one| !one.is_hide_set()) {
        collect(one, folder, pages)?;
    }
    Ok(())
}

/// The text below the options: a line that ends with a colon begins a section, and indented lines keep their form.
fn below_options(help: &StyledStr) -> Roff {
    let mut page = Roff::new();
    let mut is_literal = false;
    for line in help.to_string().lines() {
        let (text, indented) = (line.trim(), line.starts_with("  "));
        if indented != is_literal {
            page.control(if indented { "nf" } else { "fi" }, []);
            is_literal = indented;
        }
        match text.strip_suffix(':') {
            Some(title) if !indented => page.control("SH", [title.to_uppercase().as_str()]),
            _ => page.text([roman(text)]),
        };
    }
    if is_literal {
        page.control("fi", []);
    }
    page
}
