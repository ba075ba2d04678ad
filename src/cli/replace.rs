//! Protection of existing files from the outputs of commands.

use std::ffi::OsString;
use std::fs::{self, File};
use std::io::BufReader;
use std::ops::Deref;
use std::path::{Path, PathBuf};
use std::sync::OnceLock;

use anyhow::Result;
use clap::builder::{OsStringValueParser, TypedValueParser};
use clap::{ArgMatches, Id};
use same_file::is_same_file;

use crate::BadInput;
use crate::output::{self, is_standard};

/// A file or folder that a command writes, checked by [`permit_all`]; `-` is standard output.
#[derive(Debug, Clone)]
pub struct OutputFile {
    path: PathBuf,
    /// Formats of the documents that it may hold; empty if it is no document.
    formats: Vec<&'static str>,
}

impl OutputFile {
    /// Parses the name of a file for documents in some formats.
    pub fn parser(formats: Vec<&'static str>) -> impl TypedValueParser<Value = Self> {
        OsStringValueParser::new().map(move |path| Self {
            path: path.into(),
            formats: formats.clone(),
        })
    }
}

impl From<OsString> for OutputFile {
    fn from(path: OsString) -> Self {
        Self {
            path: path.into(),
            formats: Vec::new(),
        }
    }
}

impl Deref for OutputFile {
    type Target = Path;

    fn deref(&self) -> &Path {
        &self.path
    }
}

/// Files in the arguments of the command.
#[derive(Debug, Default)]
struct Given {
    replace: bool,
    inputs: Vec<PathBuf>,
}

static GIVEN: OnceLock<Given> = OnceLock::new();

/// Checks all outputs of a command before it begins, and that at most one of them is standard output.
pub fn permit_all(matches: &ArgMatches, replace: bool) -> Result<()> {
    let (inputs, outputs) = files_of(matches);
    permit_outputs(GIVEN.get_or_init(|| Given { replace, inputs }), &outputs)
}

/// The files that the arguments of a command name as inputs and as outputs.
fn files_of(matches: &ArgMatches) -> (Vec<PathBuf>, Vec<OutputFile>) {
    let mut command = matches;
    while let Some((_, inner)) = command.subcommand() {
        command = inner;
    }
    let (mut inputs, mut outputs) = (Vec::new(), Vec::<OutputFile>::new());
    for id in command.ids().map(Id::as_str) {
        if let Ok(Some(files)) = command.try_get_many(id) {
            outputs.extend(files.cloned());
        } else if let Ok(Some(files)) = command.try_get_many::<PathBuf>(id) {
            inputs.extend(files.filter(|file| !is_standard(file)).cloned());
        } else if let Ok(Some(texts)) = command.try_get_many::<String>(id) {
            inputs.extend(texts.map(PathBuf::from).filter(|text| text.is_file()));
        }
    }
    (inputs, outputs)
}

fn permit_outputs(given: &Given, outputs: &[OutputFile]) -> Result<()> {
    let (standard, files): (Vec<_>, Vec<_>) = outputs.iter().partition(|file| is_standard(file));
    if standard.len() > 1 {
        return Err(BadInput::new(format!(
            "-: found {} outputs for standard output, expected one",
            standard.len()
        )));
    }
    if standard.iter().any(|file| file.formats.is_empty()) {
        output::expect_document();
    }
    for (index, file) in files.iter().enumerate() {
        permit_with(given, file, &file.formats)?;
        let is_twice = |other: &&OutputFile| is_same(other, file) && !is_device(file);
        if files[..index].iter().any(is_twice) {
            return Err(refused(
                file,
                "is two outputs of this command, expected two names",
            ));
        }
    }
    Ok(())
}

/// Refuses to write over an input of the command, through a link, and, without `--replace`, over anything but a document in
/// one of the formats.
pub fn permit(file: &Path, formats: &[&str]) -> Result<()> {
    permit_with(GIVEN.get_or_init(Given::default), file, formats)
}

fn permit_with(given: &Given, file: &Path, formats: &[&str]) -> Result<()> {
    if is_standard(file) || is_device(file) {
        return Ok(());
    }
    if fs::symlink_metadata(file).is_ok_and(|found| found.is_symlink()) {
        return Err(refused(file, "is a link, expected a file or another name"));
    }
    if file.is_dir() {
        return Ok(());
    }
    if given.inputs.iter().any(|input| is_same(input, file)) || tautline_files::was_read(file) {
        return Err(refused(
            file,
            "is an input of this command, expected another name",
        ));
    }
    // Empty files, such as those of `mktemp`, have nothing to lose.
    let has_content = fs::metadata(file).is_ok_and(|found| found.len() > 0);
    match has_content && !given.replace && !is_document(file, formats) {
        true => Err(refused(
            file,
            "already exists, expected --replace or another name",
        )),
        false => Ok(()),
    }
}

fn refused(file: &Path, why: &str) -> anyhow::Error {
    BadInput::new(format!("{}: {why}", file.display()))
}

/// Whether a path is a device or a pipe, such as /dev/stdout, which has no content to lose.
fn is_device(file: &Path) -> bool {
    fs::metadata(file).is_ok_and(|found| !found.is_file() && !found.is_dir())
}

/// Whether two paths name the same file, which need not exist yet.
fn is_same(a: &Path, b: &Path) -> bool {
    let place = |path: &Path| {
        let path = std::path::absolute(path).ok()?;
        Some(
            fs::canonicalize(path.parent()?)
                .ok()?
                .join(path.file_name()?),
        )
    };
    is_same_file(a, b).unwrap_or_else(|_| place(a).is_some_and(|a| Some(a) == place(b)))
}

fn is_document(file: &Path, formats: &[&str]) -> bool {
    #[derive(serde::Deserialize)]
    struct Head {
        format: String,
    }
    let found = File::open(file).map(BufReader::new).ok();
    let head = found.and_then(|text| serde_json::from_reader::<_, Head>(text).ok());
    head.is_some_and(|head| formats.contains(&head.format.as_str()))
}

#[cfg(test)]
mod tests {
    use clap::CommandFactory;
    use clap::builder::ValueParser;

    use super::*;

    /// Checks the outputs of a command with these words.
    fn may_begin(words: &[&str]) -> Result<()> {
        // Other arguments that a command requires are not needed here.
        let command = crate::Arguments::command().ignore_errors(true);
        let matches = command.try_get_matches_from([&["tautline"], words].concat());
        let (inputs, outputs) = files_of(&matches.expect("errors are ignored"));
        let replace = words.contains(&"--replace");
        permit_outputs(&Given { replace, inputs }, &outputs)
    }

    fn told(answer: Result<()>) -> String {
        answer.expect_err("refused").to_string()
    }

    /// Words for an argument; those in front of a positional one stand for the positional ones before it.
    fn words(arg: &clap::Arg, value: &str) -> Vec<String> {
        match arg.get_long() {
            Some(long) => vec![format!("--{long}={value}")],
            None => {
                let before = arg.get_index().unwrap_or(1) - 1;
                let before = (0..before).map(|index| format!("/absent/{index}"));
                before.chain([value.to_owned()]).collect()
            }
        }
    }

    fn is_of(arg: &clap::Arg, parser: impl Into<ValueParser>) -> bool {
        arg.get_value_parser().type_id() == parser.into().type_id()
    }

    /// Every command without commands of its own, with the words that call it.
    fn leaves(
        command: &clap::Command,
        path: &[String],
        all: &mut Vec<(Vec<String>, clap::Command)>,
    ) {
        for one in command.get_subcommands() {
            let path = [path, &[one.get_name().to_owned()]].concat();
            match one.has_subcommands() {
                true => leaves(one, &path, all),
                false => all.push((path, one.clone())),
            }
        }
    }

    #[test]
    fn every_output_of_every_command_is_checked() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = |name: &str| folder.path().join(name).display().to_string();
        let [input, result, link, twin] = ["input", "result.json", "link", "twin"].map(path);
        fs::write(&input, "content").expect("written");
        fs::hard_link(&input, &twin).expect("a link");
        #[cfg(unix)]
        std::os::unix::fs::symlink(&input, &link).expect("a link");
        let roundabout = folder
            .path()
            .join("..")
            .join(folder.path().file_name().expect("a name"));
        let roundabout = roundabout.join("input").display().to_string();
        let (mut whole, mut all) = (crate::Arguments::command(), Vec::new());
        whole.build();
        leaves(&whole, &[], &mut all);
        let mut outputs_seen = 0;
        for (name, command) in &all {
            let (outputs, others): (Vec<_>, Vec<_>) = command
                .get_arguments()
                .filter(|arg| arg.get_action().takes_values())
                .partition(|arg| is_of(arg, clap::value_parser!(OutputFile)));
            for other in &others {
                let help = other
                    .get_help()
                    .map(ToString::to_string)
                    .unwrap_or_default();
                let writes = help.starts_with("Write ") || help.contains(" to write");
                let is_path = is_of(other, clap::value_parser!(PathBuf));
                assert!(
                    !(writes && is_path),
                    "{name:?} {}: is no OutputFile",
                    other.get_id()
                );
            }
            let inputs = others
                .iter()
                .filter(|arg| is_of(arg, clap::value_parser!(PathBuf)) || arg.get_id() == "robot");
            let inputs: Vec<_> = inputs.collect();
            for output in &outputs {
                outputs_seen += 1;
                let place = format!("{name:?} {}", output.get_id());
                let ask = |target: &str, more: &[&str], read: Option<&clap::Arg>| {
                    let mut line = name.clone();
                    line.extend(words(output, target));
                    line.extend(more.iter().map(|word| (*word).to_owned()));
                    line.extend(read.into_iter().flat_map(|arg| words(arg, &input)));
                    let line: Vec<&str> = line.iter().map(String::as_str).collect();
                    may_begin(&line)
                };
                ask(&path("new"), &[], None).expect("nothing is there");
                let kept = told(ask(&input, &[], None));
                assert!(
                    kept.ends_with("already exists, expected --replace or another name"),
                    "{place}: {kept}"
                );
                ask(&input, &["--replace"], None).unwrap_or_else(|e| panic!("{place}: {e}"));
                for input_arg in &inputs {
                    for target in [&input, &twin, &roundabout] {
                        for more in [&[][..], &["--replace"]] {
                            let kept = told(ask(target, more, Some(input_arg)));
                            assert!(
                                kept.contains("is an input of this command"),
                                "{place} {}: {kept}",
                                input_arg.get_id()
                            );
                        }
                    }
                }
                #[cfg(unix)]
                for more in [&[][..], &["--replace"]] {
                    let kept = told(ask(&link, more, None));
                    assert!(kept.contains("is a link"), "{place}: {kept}");
                }
                if output.get_id() == "json" {
                    fs::write(&result, r#"{"format": "tautline-session", "version": 1}"#)
                        .expect("written");
                    let kept = told(ask(&result, &[], None));
                    assert!(kept.contains("already exists"), "{place}: {kept}");
                }
            }
        }
        assert!(outputs_seen > 35, "{outputs_seen}");
    }

    #[test]
    fn a_result_is_replaced_by_one_of_its_format_only() {
        let folder = tempfile::tempdir().expect("a folder");
        let file = folder.path().join("result.json");
        let given = Given::default();
        fs::write(&file, r#"{"format": "tautline-check", "version": 1}"#).expect("written");
        permit_with(&given, &file, &["tautline-readiness", "tautline-check"]).expect("permitted");
        assert!(permit_with(&given, &file, &["tautline-readiness"]).is_err());
        fs::write(&file, r#"{"format": "tautline-check", "ver"#).expect("written");
        assert!(permit_with(&given, &file, &["tautline-check"]).is_err());
        // Empty files, and devices, have no content to lose.
        fs::write(&file, "").expect("written");
        permit_with(&given, &file, &[]).expect("permitted");
        #[cfg(unix)]
        permit_with(&given, Path::new("/dev/null"), &[]).expect("permitted");
    }

    #[test]
    fn a_file_that_was_read_is_an_input_under_every_name() {
        let folder = tempfile::tempdir().expect("a folder");
        let [file, twin] = ["robot.json", "twin.json"].map(|name| folder.path().join(name));
        fs::write(&file, "{}").expect("written");
        fs::hard_link(&file, &twin).expect("a link");
        let given = Given {
            replace: true,
            ..Given::default()
        };
        permit_with(&given, &twin, &[]).expect("permitted");
        tautline_files::open_input(&file, "robot.json").expect("opened");
        let kept = told(permit_with(&given, &twin, &[]));
        assert!(kept.contains("is an input of this command"), "{kept}");
    }

    #[test]
    fn two_outputs_are_two_files_and_standard_output_takes_one() {
        let twice = ["identify", "/absent", "--json=x.json", "--values=./x.json"];
        assert!(told(may_begin(&twice)).contains("two outputs of this command"));
        let standard = ["identify", "/absent", "--json=-", "--values=-"];
        assert_eq!(
            told(may_begin(&standard)),
            "-: found 2 outputs for standard output, expected one"
        );
    }
}
