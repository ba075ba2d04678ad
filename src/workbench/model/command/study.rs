//! Studies: simulations that check what the expected covariance predicts.

use std::path::PathBuf;

use tautline_core::robot::Robot;
use tautline_study::which_sensor::Question;

pub const SIMULATING: &str = "Simulating";

/// A robot with a question of *Which sensor?*.
#[derive(Debug, Clone)]
pub struct AskedRobot {
    pub robot: Robot,
    pub question: Question,
}

/// Simulates the question as a study.
#[derive(Debug, Clone)]
pub enum StudyCommand {
    /// Asks for a folder.
    Browse(Box<AskedRobot>),
    /// Simulates into a folder.
    Simulate(Box<AskedRobot>, PathBuf),
}
