//! `--hypothesis`: effects of the user, stated as text.

use std::path::PathBuf;
use std::sync::OnceLock;

use anyhow::Result;
use tautline_core::effect::Hypothesis;
use tautline_core::robot::Robot;
use tautline_session::{Folders, HypothesisFolder, add_hypothesis, read_hypothesis};

use crate::output::note;

/// Hypothesis files.
#[derive(Debug, Default, clap::Args)]
pub struct HypothesisFiles {
    /// Also know the effect that this hypothesis file states, by its id; may be repeated
    #[arg(long = "hypothesis", value_name = "FILE.toml")]
    files: Vec<PathBuf>,
}

impl HypothesisFiles {
    /// The hypotheses, in the order of the arguments.
    pub fn read(&self) -> Result<Vec<Hypothesis>> {
        let read = self.files.iter().map(|file| read_hypothesis(file));
        Ok(read.collect::<Result<_, _>>()?)
    }

    /// Makes the hypotheses known to a robot, and those in the settings folder of the user.
    pub fn add_to(&self, robot: &mut Robot) -> Result<()> {
        for file in &self.files {
            add_hypothesis(robot, file)?;
        }
        for notice in of_user().add_to(robot) {
            note!("{notice}");
        }
        Ok(())
    }

    /// The hypotheses of the arguments with their files.
    pub fn sources(&self) -> Result<Vec<(PathBuf, Hypothesis)>> {
        let files = self.files.iter().cloned();
        Ok(files.zip(self.read()?).collect())
    }
}

/// The hypotheses in the settings folder of the user, read once; errors are reported once.
pub fn of_user() -> &'static HypothesisFolder {
    static READ: OnceLock<HypothesisFolder> = OnceLock::new();
    READ.get_or_init(|| {
        // Without a home folder the user has no settings.
        let folder = Folders::of_user().ok().map(|folders| folders.effects());
        let read = folder.map(|folder| HypothesisFolder::read(&folder));
        let read = read.unwrap_or_default();
        for notice in &read.notices {
            note!("{notice}");
        }
        read
    })
}
