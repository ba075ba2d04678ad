//! The suggestion for a mistyped command.

use std::ffi::OsString;
use std::path::Path;

use crate::BadInput;

/// Similarity from which a command is suggested, as for the options.
const SIMILAR: f64 = 0.8;

/// The error for a word that is neither a command nor a file.
pub fn error(word: &str, commands: &clap::Command) -> anyhow::Error {
    let hint = match nearest(word, commands) {
        Some(name) => format!("did you mean `tautline {name}`?"),
        None => "`tautline --help` lists the commands".to_owned(),
    };
    BadInput::new(format!(
        "{word}: neither a command nor an existing file or folder; {hint}"
    ))
}

/// The error of a command line that cannot be parsed because its first word is almost a command.
pub fn first_word(
    mut words: impl Iterator<Item = OsString>,
    commands: &clap::Command,
) -> Option<anyhow::Error> {
    let word = words.find(|word| !word.to_string_lossy().starts_with('-'))?;
    let text = word.to_string_lossy();
    let is_other = Path::new(&word).exists() || commands.find_subcommand(&*text).is_some();
    let is_mistyped = !is_other && nearest(&text, commands).is_some();
    is_mistyped.then(|| error(&text, commands))
}

fn nearest<'a>(word: &str, commands: &'a clap::Command) -> Option<&'a str> {
    let names = commands.get_subcommands().map(clap::Command::get_name);
    let names = names.map(|name| (strsim::jaro_winkler(word, name), name));
    let (likeness, name) = names.max_by(|a, b| a.0.total_cmp(&b.0))?;
    (likeness >= SIMILAR).then_some(name)
}

#[cfg(test)]
mod tests {
    use clap::CommandFactory;

    use super::*;
    use crate::Arguments;

    fn answer(line: &str) -> Option<String> {
        let words = line.split(' ').map(OsString::from);
        first_word(words, &Arguments::command()).map(|error| error.to_string())
    }

    #[test]
    fn a_mistyped_command_is_answered_with_the_nearest() {
        for (line, name) in [
            ("identfy mini --json -", "identify"),
            ("-q diagonse mini", "diagnose"),
            ("compair a b", "compare"),
        ] {
            let answer = answer(line).expect(line);
            let expected = format!("did you mean `tautline {name}`?");
            assert!(answer.ends_with(&expected), "{answer}");
        }
        for line in ["identify nowhere", "--version", "xyz a", "-q check x", "."] {
            assert_eq!(answer(line), None, "{line}");
        }
        let unlike = error("xyz", &Arguments::command()).to_string();
        assert!(unlike.ends_with("`tautline --help` lists the commands"));
    }
}
