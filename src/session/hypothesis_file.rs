//! Hypothesis files: effects whose physics is a text, stated by the user.

use std::fs;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};

use tautline_core::effect::{Hypothesis, MAX_HYPOTHESES, MAX_HYPOTHESIS_BYTES};
use tautline_core::robot::Robot;
use tautline_files::{Location, ReadError};

use crate::json::read_limited;

/// Folder of hypotheses beside the tables of a dataset, and the ending of their files.
const FOLDER: &str = "effects";
const ENDING: &str = "toml";

/// Reads a hypothesis file.
///
/// # Errors
/// If the file cannot be read, or names the first mistake with its line and column.
pub fn read_hypothesis(path: &Path) -> Result<Hypothesis, ReadError> {
    let file = path.display().to_string();
    parse_hypothesis(
        &read_limited(path, &file, MAX_HYPOTHESIS_BYTES as u64)?,
        &file,
    )
}

/// Reads a hypothesis from memory; `file` is the name for messages.
///
/// # Errors
/// Names the first mistake with its line and column.
pub fn parse_hypothesis(bytes: &[u8], file: &str) -> Result<Hypothesis, ReadError> {
    if bytes.len() > MAX_HYPOTHESIS_BYTES {
        let message = format!("found more than {MAX_HYPOTHESIS_BYTES} bytes, too large");
        return Err(ReadError::new(file, Location::File, message));
    }
    let text = std::str::from_utf8(bytes).map_err(|error| {
        let message = format!("found a byte that is not UTF-8 at {}", error.valid_up_to());
        ReadError::new(file, Location::File, message)
    })?;
    Hypothesis::parse(text).map_err(|error| {
        let place = Location::Character(error.line, error.column);
        ReadError::new(file, place, error.message)
    })
}

/// Reads a hypothesis file and makes it known to a robot.
///
/// # Errors
/// If the file is not valid, or the robot carries another hypothesis with the same identifier.
pub fn add_hypothesis(robot: &mut Robot, path: &Path) -> Result<(), ReadError> {
    let hypothesis = read_hypothesis(path)?;
    robot.add_hypothesis(&hypothesis).map_err(|error| {
        let file = path.display().to_string();
        ReadError::new(&file, Location::File, error.to_string())
    })
}

/// Makes the hypotheses in the folder `effects` of a dataset known to its robot, in the order of their names.
///
/// # Errors
/// As [`add_hypothesis`].
pub(crate) fn add_hypotheses_beside(robot: &mut Robot, folder: &Path) -> Result<(), ReadError> {
    for path in hypothesis_files(&folder.join(FOLDER))? {
        add_hypothesis(robot, &path)?;
    }
    Ok(())
}

/// The hypotheses in a folder, such as that of the user, see [`Folders::effects`](crate::Folders::effects). A file that
/// cannot be used is left out with a notice: no dataset depends on it.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct HypothesisFolder {
    /// The hypotheses with their files, in the order of the names.
    pub hypotheses: Vec<(PathBuf, Hypothesis)>,
    /// Notices about files that were left out, one sentence each.
    pub notices: Vec<String>,
}

impl HypothesisFolder {
    /// Reads a folder; one that does not exist is empty.
    #[must_use]
    pub fn read(folder: &Path) -> Self {
        let mut read = Self::default();
        let files = hypothesis_files(folder).unwrap_or_else(|error| {
            read.notices.push(error.to_string());
            Vec::new()
        });
        if files.len() > MAX_HYPOTHESES {
            let (folder, found) = (folder.display(), files.len());
            read.notices.push(format!(
                "{folder}: found {found} hypotheses, expected at most {MAX_HYPOTHESES}; the others are left out"
            ));
        }
        for path in files.into_iter().take(MAX_HYPOTHESES) {
            match read_hypothesis(&path) {
                Ok(hypothesis) => read.push(path, hypothesis),
                Err(error) => read.notices.push(format!("{error}; the file is left out")),
            }
        }
        read
    }

    fn push(&mut self, path: PathBuf, hypothesis: Hypothesis) {
        let mut known = self.hypotheses.iter();
        match known.find(|(_, other)| other.id() == hypothesis.id()) {
            None => self.hypotheses.push((path, hypothesis)),
            Some((first, _)) => self.notices.push(format!(
                "{}: found the hypothesis \"{}\" as in {}, expected another id; the file is left out",
                path.display(),
                hypothesis.id(),
                first.display()
            )),
        }
    }

    /// Makes the hypotheses known to a robot and returns notices. A hypothesis of the robot or its dataset takes precedence over
    /// a file here with the same identifier.
    pub fn add_to(&self, robot: &mut Robot) -> Vec<String> {
        let mut notices = Vec::new();
        for (path, hypothesis) in &self.hypotheses {
            if let Err(error) = robot.add_hypothesis(hypothesis) {
                notices.push(format!("{}: {error}; the file is left out", path.display()));
            }
        }
        notices
    }
}

/// The hypothesis files of a folder, in the order of their names; none if there is no folder.
fn hypothesis_files(folder: &Path) -> Result<Vec<PathBuf>, ReadError> {
    let unreadable = |error: &std::io::Error| {
        ReadError::io(&folder.display().to_string(), Location::File, error)
    };
    let entries = match fs::read_dir(folder) {
        Err(error) if error.kind() == ErrorKind::NotFound => return Ok(Vec::new()),
        entries => entries.map_err(|error| unreadable(&error))?,
    };
    let mut files = Vec::new();
    for entry in entries {
        let path = entry.map_err(|error| unreadable(&error))?.path();
        if path.extension().is_some_and(|ending| ending == ENDING) {
            files.push(path);
        }
    }
    files.sort();
    Ok(files)
}

#[cfg(test)]
mod tests {
    use tautline_core::effect::every_effect;
    use tautline_core::robot::presets;

    use super::*;
    use crate::{parse_robot, versioned};

    fn robot() -> Robot {
        presets::find("mini").expect("a preset").robot
    }

    fn text(id: &str) -> String {
        let mut effects = every_effect();
        let effect = effects.find(|effect| effect.id() == id).expect("an effect");
        effect.as_text(&robot()).expect("a text")
    }

    #[test]
    fn a_folder_beside_a_dataset_makes_them_known() {
        let folder = tempfile::tempdir().expect("a folder");
        let mut robot = robot();
        add_hypotheses_beside(&mut robot, folder.path()).expect("no folder is no mistake");
        assert!(robot.hypotheses.is_empty());
        let effects = folder.path().join("effects");
        fs::create_dir(&effects).expect("a folder");
        for (name, id) in [("b.toml", "winch_scale"), ("a.toml", "cable_slip")] {
            fs::write(effects.join(name), text(id)).expect("written");
        }
        fs::write(effects.join("notes.txt"), "no hypothesis").expect("written");
        add_hypotheses_beside(&mut robot, folder.path()).expect("hypotheses");
        let ids: Vec<&str> = robot.hypothesis_effects().map(|e| e.id()).collect();
        assert_eq!(ids, ["my_cable_slip", "my_winch_scale"]);
        // A second time nothing is repeated; another text with the same id is refused.
        add_hypotheses_beside(&mut robot, folder.path()).expect("the same");
        assert_eq!(robot.hypotheses.len(), 2);
        let other = text("winch_scale").replace("0.03]", "0.04]");
        fs::write(effects.join("c.toml"), other).expect("written");
        let error = add_hypotheses_beside(&mut robot, folder.path()).expect_err("another text");
        assert!(
            error
                .to_string()
                .contains("c.toml: found the hypothesis \"my_winch_scale\""),
            "{error}"
        );
    }

    #[test]
    fn a_folder_of_the_user_leaves_out_what_is_wrong_in_one_sentence_each() {
        let folder = tempfile::tempdir().expect("a folder");
        let absent = HypothesisFolder::read(&folder.path().join("absent"));
        assert_eq!(absent, HypothesisFolder::default());
        let slip = text("cable_slip");
        let files = [
            ("a.toml", slip.clone()),
            (
                "b.toml",
                slip.replace("pose]", "place]").replace("unit", "units"),
            ),
            ("c.toml", slip.clone()),
            ("d.toml", text("winch_scale")),
        ];
        for (name, content) in files {
            fs::write(folder.path().join(name), content).expect("written");
        }
        let read = HypothesisFolder::read(folder.path());
        let ids: Vec<&str> = read.hypotheses.iter().map(|(_, h)| h.id()).collect();
        assert_eq!(ids, ["my_cable_slip", "my_winch_scale"]);
        let [broken, twice] = &read.notices[..] else {
            panic!("{:?}", read.notices);
        };
        assert!(
            broken.contains("b.toml, line ") && broken.contains(", column "),
            "{broken}"
        );
        assert!(
            twice.contains("c.toml: found the hypothesis \"my_cable_slip\" as in "),
            "{twice}"
        );
        // The hypothesis of the robot takes precedence.
        let mut robot = robot();
        let own = text("winch_scale").replace("0.03]", "0.04]");
        let own = parse_hypothesis(own.as_bytes(), "own.toml").expect("one");
        robot.add_hypothesis(&own).expect("added");
        let notices = read.add_to(&mut robot);
        assert_eq!(notices.len(), 1, "{notices:?}");
        assert!(
            notices[0].contains("d.toml: found the hypothesis \"my_winch_scale\""),
            "{notices:?}"
        );
        assert_eq!(robot.hypotheses.len(), 2);
        assert_eq!(robot.hypotheses[0], own.text());
    }

    #[test]
    fn mistakes_have_a_file_line_and_column() {
        let wrong = text("winch_scale").replace("(1 + scale)", "(1 [m] + scale)");
        let error = parse_hypothesis(wrong.as_bytes(), "wrong.toml").expect_err("refused");
        let line = 1 + wrong
            .lines()
            .position(|l| l.starts_with("paid"))
            .expect("a line");
        let expected = format!(
            "wrong.toml, line {line}, column 25: found 1, expected the unit of the term before it, m"
        );
        assert_eq!(error.to_string(), expected);
        let huge = vec![b'#'; 1 << 17];
        let error = parse_hypothesis(&huge, "huge.toml")
            .expect_err("refused")
            .to_string();
        assert_eq!(error, "huge.toml: found more than 65536 bytes, too large");
        assert!(parse_hypothesis(b"\xff", "bytes.toml").is_err());
    }

    #[test]
    fn a_robot_file_carries_the_text() {
        let mut robot = robot();
        let hypothesis = parse_hypothesis(text("winch_scale").as_bytes(), "w.toml").expect("one");
        robot.add_hypothesis(&hypothesis).expect("added");
        let json = serde_json::to_string(&versioned(&robot)).expect("JSON");
        let again = parse_robot(json.as_bytes(), "robot.json").expect("a robot");
        assert_eq!(again.value, robot);
        assert!(again.notices.is_empty());
        let wrong = json.replace("(1 + scale)", "(1 + sale)");
        let error = parse_robot(wrong.as_bytes(), "robot.json")
            .expect_err("refused")
            .to_string();
        assert!(error.starts_with("robot.json, /hypotheses/0: "), "{error}");
        assert!(
            error.contains("found \"sale\", expected a parameter or a quantity, such as \"scale\""),
            "{error}"
        );
    }
}
