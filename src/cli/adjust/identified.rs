//! The identification whose values are written.

use std::sync::Arc;

use crate::BadInput;
use crate::output::note;
use anyhow::{Result, anyhow};
use tautline_core::estimation::published::PublishedStop;
use tautline_core::estimation::{Control, Solution};
use tautline_core::robot::Robot;
use tautline_session::{Method, ResultRecord, Session};
use tautline_workflow::adjusting::{self, Doubt, DoubtKind};
use tautline_workflow::clock;
use tautline_workflow::diagnosis::{TIME_LIMIT_S, dataset_to_diagnose, diagnose_dataset};
use tautline_workflow::identification::{
    FitVerdict, Identification, IdentificationDocument, IdentificationRequest, identify_published,
    identify_session,
};
use tautline_workflow::results::record;

use crate::method::MethodName;

/// An identification whose values can be written.
pub struct Identified {
    /// The robot with the identified values.
    pub model: Robot,
    /// Reasons against writing its values.
    pub doubts: Vec<Doubt>,
    /// Machine-readable form.
    pub document: IdentificationDocument,
    /// `None` for the published method, which has no standard deviations.
    identification: Option<Identification>,
}

impl Identified {
    /// Identifies a session by the given method, or by the one in its settings.
    pub fn of(session: &Session, method: Option<MethodName>) -> Result<Self> {
        let mut session = session.clone();
        let settings = &mut session.settings.identification;
        settings.method = method.map_or(settings.method, Method::from);
        if settings.method == Method::Published {
            return Self::published(&session);
        }
        let identified = identify_session(&session, &mut |_| Control::Continue)
            .map_err(|error| BadInput::new(format!("{}: {error}", session.name)))?;
        for open in &identified.open {
            note!("undetermined: {}", open.sentence);
        }
        let document = identified.document();
        Ok(Self {
            model: identified.model.clone(),
            doubts: doubts_with_diagnosis(&session, &identified)?,
            document,
            identification: Some(identified),
        })
    }

    fn published(session: &Session) -> Result<Self> {
        let place =
            |error: &dyn std::fmt::Display| BadInput::new(format!("{}: {error}", session.name));
        let request = IdentificationRequest::of_session(session).map_err(|error| place(&error))?;
        let published = identify_published(&request.dataset).map_err(|error| place(&error))?;
        let unconverged: Option<String> = match published.result.stop {
            PublishedStop::SmallStep | PublishedStop::SmallError => None,
            // As in the publication, which prescribes the number of steps rather than convergence.
            PublishedStop::IterationLimit => Some(format!(
                "The published method had not converged after its {} steps",
                published.result.iterations
            )),
            PublishedStop::Diverged => {
                return Err(anyhow!("{}: the published method diverged", session.name));
            }
        };
        let document = published.document();
        let model = published.poses.dataset.robot.clone();
        let unconverged = unconverged.map(|text| Doubt::new(DoubtKind::Unconverged, text));
        let others = [
            adjusting::implausible(&session.robot, &model),
            adjusting::unanswered(session),
        ];
        Ok(Self {
            model,
            doubts: unconverged
                .into_iter()
                .chain(others.into_iter().flatten())
                .collect(),
            document,
            identification: None,
        })
    }

    /// The solution, which provides the standard deviations.
    pub fn solution(&self) -> Option<&Solution> {
        self.identification.as_ref().map(|found| &found.solution)
    }

    /// The result in the form that the session records.
    pub fn record(&self, session: &Session) -> ResultRecord {
        record(session, "Identification", &self.document, clock::now())
    }
}

/// The reasons against writing an identification. Where the model explains the readings poorly, a diagnosis is made, unless
/// the session already contains one.
fn doubts_with_diagnosis(session: &Session, fit: &Identification) -> Result<Vec<Doubt>> {
    let mut doubts = adjusting::doubts(session, fit);
    let hardly = FitVerdict::of(fit.solution.p_value()) == FitVerdict::Doubtful;
    if hardly && doubts.iter().all(|doubt| doubt.kind != DoubtKind::Finding) {
        let dataset = Arc::new(dataset_to_diagnose(session, fit));
        let terms = (session.settings.diagnosis.alpha, TIME_LIMIT_S);
        let diagnosed = diagnose_dataset(dataset, terms, &mut |_| Control::Continue)
            .map_err(|error| BadInput::new(format!("{}: {error}", session.name)))?;
        let findings = diagnosed.diagnosis.findings.iter();
        doubts.extend(adjusting::finding(
            findings.map(|finding| finding.sentence.as_str()),
        ));
    }
    Ok(doubts)
}
