//! `tautline completions`.

use anyhow::Result;
use clap_complete::Shell;

use crate::examples::examples;
use crate::output::write_file;
use crate::replace::OutputFile;

#[derive(Debug, clap::Args)]
#[command(after_help = examples(&[
    ("For bash; ~/.bashrc reads them with: source tautline.bash", "tautline completions bash -o tautline.bash"),
    ("For zsh; the folder belongs in fpath", "tautline completions zsh -o _tautline"),
    ("For fish, in the folder where it looks for them", "tautline completions fish > ~/.config/fish/completions/tautline.fish"),
]))]
pub struct Arguments {
    /// The shell
    #[arg(value_name = "SHELL", value_enum)]
    shell: Shell,
    /// File to write; - is standard output
    #[arg(short, long, value_name = "FILE", default_value = "-")]
    out: OutputFile,
}

/// Writes the completions of `command`.
pub fn run(arguments: &Arguments, mut command: clap::Command) -> Result<()> {
    let name = command.get_name().to_owned();
    let mut text = Vec::new();
    clap_complete::generate(arguments.shell, &mut command, name, &mut text);
    write_file(&arguments.out, &text)
}
