//! What is to be written: the identified robot.

use anyhow::{Result, anyhow};
use tautline_core::estimation::published::PublishedStop;
use tautline_core::estimation::{Control, Solution};
use tautline_core::robot::Robot;
use tautline_session::{Method, ResultRecord, Session};

use crate::BadInput;
use tautline_workflow::clock;
use tautline_workflow::comparison::identify;
use tautline_workflow::documents::identification::Identification;
use tautline_workflow::documents::record;
use tautline_workflow::identification::{Fit, FitOrder, compare_published};

#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub enum MethodName {
    Joint,
    Simple,
    Published,
}

impl From<MethodName> for Method {
    fn from(name: MethodName) -> Self {
        match name {
            MethodName::Joint => Self::Joint,
            MethodName::Simple => Self::Simple,
            MethodName::Published => Self::Published,
        }
    }
}

/// An identification that can be written.
pub struct Identified {
    /// The robot with the identified values.
    pub model: Robot,
    /// How they were identified.
    pub method: String,
    /// One sentence, without a full stop, where the identification did not converge.
    pub unconverged: Option<String>,
    document: Identification,
    /// Of the joint and simple methods; the published one has no standard deviations.
    fit: Option<Fit>,
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
        let quiet = &mut |_: &_| Control::Continue;
        let fit = identify(&session, quiet)
            .map_err(|error| BadInput::new(format!("{}: {error}", session.name)))?;
        for open in &fit.open {
            eprintln!("open: {}", open.sentence);
        }
        let document = fit.solved().identification();
        Ok(Self {
            model: fit.model.clone(),
            method: document.method.clone(),
            unconverged: (!fit.solution.converged()).then(|| {
                let steps = fit.solution.iterations;
                format!("The identification did not converge in {steps} steps")
            }),
            document,
            fit: Some(fit),
        })
    }

    fn published(session: &Session) -> Result<Self> {
        let place = |error: String| BadInput::new(format!("{}: {error}", session.name));
        let order = FitOrder::of(session).map_err(|error| place(error.to_string()))?;
        let compared = compare_published(&order.dataset).map_err(place)?;
        let unconverged = match compared.fit.result.stop {
            PublishedStop::SmallStep | PublishedStop::SmallError => None,
            // As in the publication, whose steps are counted, not awaited.
            PublishedStop::IterationLimit => Some(format!(
                "The published method was still moving when its {} steps were used up",
                compared.fit.result.iterations
            )),
            PublishedStop::Diverged => {
                return Err(anyhow!("{}: the published method diverged", session.name));
            }
        };
        Ok(Self {
            model: compared.fit.applied_to(&order.dataset).robot,
            method: compared.identification.method.clone(),
            unconverged,
            document: compared.identification,
            fit: None,
        })
    }

    /// The solution, for standard deviations.
    pub fn solution(&self) -> Option<&Solution> {
        self.fit.as_ref().map(|fit| &fit.solution)
    }

    /// The result as the session keeps it.
    pub fn record(&self, session: &Session) -> ResultRecord {
        record(session, "Identification", &self.document, clock::now())
    }
}
