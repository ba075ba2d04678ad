//! Input of reports.

use tautline_core::comparison::Comparison;
use tautline_core::effect::EffectSetting;
use tautline_session::{Session, Timestamp};

use super::choice::ReportChoice;
use crate::diagnosis::Diagnosed;
use crate::history::{RobotHistory, RobotRecord};
use crate::identification::{Identification, same_effect};

/// Input of a report.
#[derive(Debug, Clone, Copy)]
pub struct ReportInput<'a> {
    /// The session.
    pub session: &'a Session,
    /// Its identification, if there is one.
    pub fit: Option<&'a Identification>,
    /// Whether the data or the model were changed after the identification.
    pub outdated: bool,
    /// Its diagnosis, if there is one.
    pub diagnosis: Option<&'a Diagnosed>,
    /// Whether the data or the model were changed after the diagnosis.
    pub diagnosis_outdated: bool,
    /// A picture of the robot (PNG), if there is one.
    pub picture: Option<&'a [u8]>,
    /// When the next calibration is due, a sentence; `None` without a record of the robot, from which it follows.
    pub next_calibration: Option<&'a str>,
    /// Propagation of distributions, if it was asked for.
    pub monte_carlo: Option<&'a MonteCarlo>,
    /// The selected parts, and the heading.
    pub choice: &'a ReportChoice,
    /// Time of the report.
    pub now: Timestamp,
}

impl<'a> ReportInput<'a> {
    /// The diagnosis of the model that was identified.
    #[must_use]
    pub fn current_diagnosis(&self) -> Option<&'a Diagnosed> {
        self.diagnosis.filter(|_| !self.diagnosis_outdated)
    }

    /// Effects that were added to the model that was identified.
    #[must_use]
    pub fn added_effects(&self) -> Vec<EffectSetting> {
        let described = &self.session.robot.effects;
        let model = self.fit.map_or(&[][..], |fit| &fit.model.effects);
        let is_described = |one: &EffectSetting| described.iter().any(|d| same_effect(d, one));
        let added = model.iter().filter(|one| !is_described(one));
        added.cloned().collect()
    }
}

/// Propagation of distributions (JCGM 101:2008): the values identified anew from many draws of all inputs.
#[derive(Debug, Clone, PartialEq)]
pub struct MonteCarlo {
    /// Number of draws.
    pub trials: usize,
    /// Number of draws whose identification converged; the intervals are of these.
    pub converged: usize,
    /// Coverage interval of x, y and z of each entry point.
    pub entry_points: Vec<[CoverageInterval; 3]>,
}

/// Probabilistically symmetric coverage interval.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CoverageInterval {
    /// Lower limit (m).
    pub from_m: f64,
    /// Upper limit (m).
    pub to_m: f64,
}

/// Input of the report of a comparison.
#[derive(Debug, Clone, Copy)]
pub struct ComparisonInput<'a> {
    /// Names of the two sessions.
    pub names: [&'a str; 2],
    /// Their identifications.
    pub fits: [&'a Identification; 2],
    /// Whether readings of a simulated robot are compared.
    pub is_simulated: bool,
    /// The comparison, second less first.
    pub comparison: &'a Comparison,
    /// The heading; a comparison has all its parts.
    pub choice: &'a ReportChoice,
    /// Time of the report.
    pub now: Timestamp,
}

/// Input of the report of the record of a robot.
#[derive(Debug, Clone, Copy)]
pub struct HistoryInput<'a> {
    /// The sessions.
    pub record: &'a RobotRecord,
    /// What changed between them.
    pub found: &'a RobotHistory,
    /// The heading; a history has all its parts.
    pub choice: &'a ReportChoice,
    /// Time of the report.
    pub now: Timestamp,
}
