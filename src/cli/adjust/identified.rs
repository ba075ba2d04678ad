//! The identification whose values are to be written.

use crate::BadInput;
use anyhow::{Result, anyhow};
use tautline_core::estimation::published::PublishedStop;
use tautline_core::estimation::{Control, Solution};
use tautline_core::robot::Robot;
use tautline_session::{Method, ResultRecord, Session};
use tautline_workflow::clock;
use tautline_workflow::documents::record;
use tautline_workflow::identification::{
    Identification, IdentificationDocument, IdentificationRequest, identify_published,
    identify_session,
};

use crate::method::MethodName;

/// An identification that can be written.
pub struct Identified {
    /// The robot with the identified values.
    pub model: Robot,
    /// One sentence, without a full stop, where the identification did not converge.
    pub unconverged: Option<String>,
    /// Machine form.
    pub document: IdentificationDocument,
    /// Of the joint and simple methods; the published one has no standard deviations.
    identification: Option<Identification>,
}

impl Identified {
    /// Identifies a session, by the method that its settings name unless another one is asked for.
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
            eprintln!("undetermined: {}", open.sentence);
        }
        let document = identified.document();
        Ok(Self {
            model: identified.model.clone(),
            unconverged: (!document.converged).then(|| {
                let steps = document.iterations;
                format!("The identification did not converge in {steps} steps")
            }),
            document,
            identification: Some(identified),
        })
    }

    fn published(session: &Session) -> Result<Self> {
        let place =
            |error: &dyn std::fmt::Display| BadInput::new(format!("{}: {error}", session.name));
        let request = IdentificationRequest::of_session(session).map_err(|error| place(&error))?;
        let published = identify_published(&request.dataset).map_err(|error| place(&error))?;
        let unconverged = match published.result.stop {
            PublishedStop::SmallStep | PublishedStop::SmallError => None,
            // As in the publication, whose steps are counted, not awaited.
            PublishedStop::IterationLimit => Some(format!(
                "The published method had not converged after its {} steps",
                published.result.iterations
            )),
            PublishedStop::Diverged => {
                return Err(anyhow!("{}: the published method diverged", session.name));
            }
        };
        let document = published.document();
        Ok(Self {
            model: published.poses.dataset.robot.clone(),
            unconverged,
            document,
            identification: None,
        })
    }

    /// The solution, for standard deviations.
    pub fn solution(&self) -> Option<&Solution> {
        self.identification.as_ref().map(|found| &found.solution)
    }

    /// The result as the session keeps it.
    pub fn record(&self, session: &Session) -> ResultRecord {
        record(session, "Identification", &self.document, clock::now())
    }
}
