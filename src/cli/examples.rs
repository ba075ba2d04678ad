//! Examples in the help of commands.

use clap::builder::Styles;

/// The section below the options: purpose and command line of each example.
pub fn examples(list: &[(&str, &str)]) -> String {
    let mut text = heading("Examples:");
    for (purpose, line) in list {
        text.push_str(&format!("\n  # {purpose}\n  {line}"));
    }
    text
}

/// A heading in the style of the others.
pub fn heading(text: &str) -> String {
    let styles = Styles::default();
    let style = styles.get_header();
    format!("{}{text}{}", style.render(), style.render_reset())
}

#[cfg(test)]
mod tests {
    use clap::CommandFactory;
    use clap::builder::StyledStr;

    use crate::Arguments;

    /// Widest example, so that none is broken on a terminal of the usual width.
    const WIDEST: usize = 80;

    /// Commands without subcommands, with their full names.
    fn leaves(command: &clap::Command, name: &str, found: &mut Vec<(String, String)>) {
        for one in command.get_subcommands() {
            let name = format!("{name} {}", one.get_name());
            if one.has_subcommands() {
                leaves(one, &name, found);
                continue;
            }
            let help = one.get_after_help().map(StyledStr::to_string);
            found.push((name, help.unwrap_or_default()));
        }
    }

    #[test]
    fn every_command_has_examples_of_its_own_that_parse() {
        let mut all = Vec::new();
        leaves(&Arguments::command(), "tautline", &mut all);
        assert!(all.len() > 24, "only {} commands", all.len());
        for (name, help) in all {
            let lines: Vec<&str> = help
                .lines()
                .filter_map(|line| line.strip_prefix("  tautline "))
                .collect();
            assert!(!lines.is_empty(), "{name} has no example");
            for line in help.lines() {
                assert!(line.chars().count() <= WIDEST, "{name}: {line}");
            }
            for line in lines {
                let line = format!("tautline {line}");
                assert!(
                    line.starts_with(&name),
                    "{line} is not an example of {name}"
                );
                for part in line
                    .split(" | ")
                    .filter(|part| part.starts_with("tautline "))
                {
                    let words = part
                        .split(' ')
                        .take_while(|word| !["<", ">"].contains(word));
                    let parsed = Arguments::command().try_get_matches_from(words);
                    parsed.unwrap_or_else(|error| panic!("{line}: {error}"));
                }
            }
        }
    }
}
