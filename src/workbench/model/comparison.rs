//! Two sessions compared, with everything that the screen shows of it.

use std::path::PathBuf;
use std::sync::Arc;

use tautline_core::comparison::Comparison;

use crate::views::plots::residuals_of_both;
use crate::views::robot_3d::scene::{Scene, Subject};
use tautline_workflow::comparison::{LEVEL, compare_identifications};
use tautline_workflow::identification::Identification;
use tautline_workflow::plot::figure::Figure;

/// One of the two places of a comparison.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Side {
    /// The first.
    A,
    /// The second: what differs is this less the first.
    B,
}

impl Side {
    /// Both.
    pub const ALL: [Self; 2] = [Self::A, Self::B];

    /// What the operator reads.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::A => "A",
            Self::B => "B",
        }
    }
}

/// Where a session comes from.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Source {
    /// It is the open one.
    Open,
    /// A session file, or a dataset folder.
    File(PathBuf),
}

/// One of the two sessions.
#[derive(Debug)]
pub struct Run {
    /// Its name.
    pub name: String,
    /// Where it comes from.
    pub source: Source,
    /// Its identification.
    pub fit: Arc<Identification>,
    /// Number of the inputs of the open session, if it is that one.
    pub inputs: Option<u64>,
}

/// Two sessions with what differs.
#[derive(Debug)]
pub struct Compared {
    /// The sessions, A and B.
    pub runs: [Arc<Run>; 2],
    /// B less A.
    pub comparison: Comparison,
    /// Both geometries.
    pub scene: Arc<Scene>,
    /// Residuals of the lengths of both.
    pub residuals: Figure,
}

impl Compared {
    /// Compares A and B.
    ///
    /// # Errors
    /// One sentence, if the robots have other cables or one of the sessions leaves its geometry open.
    pub fn new(runs: [Arc<Run>; 2]) -> Result<Self, String> {
        let fits = runs.each_ref().map(|run| run.fit.as_ref());
        let comparison = compare_identifications(fits, LEVEL)?;
        let [first, _] = fits;
        let subject = Subject {
            fit: Some(first),
            ..Subject::new(&first.dataset.robot, &first.dataset.measurements)
        };
        Ok(Self {
            scene: Arc::new(subject.scene().compared(&comparison)),
            residuals: residuals_of_both(fits),
            comparison,
            runs,
        })
    }
}
