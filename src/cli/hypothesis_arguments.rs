//! `--hypothesis`: effects of the user, stated as text.

use std::path::PathBuf;

use anyhow::Result;
use tautline_core::effect::Hypothesis;
use tautline_core::robot::Robot;
use tautline_session::{add_hypothesis, read_hypothesis};

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

    /// Makes the hypotheses known to a robot.
    pub fn add_to(&self, robot: &mut Robot) -> Result<()> {
        for file in &self.files {
            add_hypothesis(robot, file)?;
        }
        Ok(())
    }
}
