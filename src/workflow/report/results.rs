//! Results that a report of a session needs.

use std::sync::Arc;

use tautline_core::estimation::Control;
use tautline_session::{ResultRecord, Session, VersionedFile as _};

use crate::diagnosis::{Diagnosed, DiagnosisDocument};
use crate::diagnosis::{TIME_LIMIT_S, dataset_to_diagnose, diagnose_dataset};
use crate::identification::{Identification, identify_session};

/// Identification and diagnosis of a session, if it has them.
pub type Results = (Option<Arc<Identification>>, Option<Arc<Diagnosed>>);

/// Completes the results of a session: those of a session that was closed and opened again are recomputed from the
/// same data.
#[must_use]
pub fn completed(session: &Session, (fit, diagnosis): Results) -> Results {
    if session.measurements.is_empty() {
        return (fit, diagnosis);
    }
    let identify = || identify_session(session, &mut |_| Control::Continue);
    let fit = fit.or_else(|| identify().ok().map(Arc::new));
    let diagnosis = diagnosis.or_else(|| {
        let fit = fit.as_ref().filter(|_| was_diagnosed(session))?;
        let dataset = Arc::new(dataset_to_diagnose(session, fit));
        let limits = (session.settings.diagnosis.alpha, TIME_LIMIT_S);
        let found = diagnose_dataset(dataset, limits, &mut |_| Control::Continue);
        found.ok().map(Arc::new)
    });
    (fit, diagnosis)
}

/// Whether the present data were diagnosed.
fn was_diagnosed(session: &Session) -> bool {
    let basis = session.basis();
    let is_of_these = |record: &ResultRecord| {
        record.format() == Some(DiagnosisDocument::FORMAT) && record.basis.as_ref() == Some(&basis)
    };
    session.results().iter().any(is_of_these)
}
