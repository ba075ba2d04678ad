//! Results in a report that belong to an earlier state of the session.

use super::Model;
use super::command::IdentificationCommand;
use tautline_workflow::adjusting::{verified_before_last_write, written};

/// Part of a report that is out of date.
#[derive(Debug)]
pub(crate) struct OutOfDate {
    pub(crate) sentence: &'static str,
    /// Command that updates it, unless that needs the robot.
    pub(crate) remedy: Option<(&'static str, IdentificationCommand)>,
}

/// Parts of the session's report that are out of date.
pub(crate) fn out_of_date(model: &Model) -> Vec<OutOfDate> {
    let Some(open) = &model.open else {
        return Vec::new();
    };
    let session = open.session();
    let mut found = Vec::new();
    let mut add = |sentence, remedy| found.push(OutOfDate { sentence, remedy });
    let identify = Some(("Identify now", IdentificationCommand::Identify));
    let diagnose = Some(("Diagnose now", IdentificationCommand::Diagnose));
    match open.fit() {
        Some(_) if !open.fit_is_current() => add(
            "The data or the model changed after the last identification.",
            identify,
        ),
        Some(_) => {
            match open.diagnosis() {
                Some(_) if open.is_model_diagnosed() => {}
                Some(_) => add(
                    "The last diagnosis is of an earlier model or earlier data.",
                    diagnose,
                ),
                None => add("The present model was not diagnosed.", diagnose),
            }
            let is_changed = !session.adjustments().is_empty();
            if is_changed && written(session, &model.review().lines).is_none() {
                add("The controller does not hold the identified values.", None);
            }
        }
        None => {}
    }
    if verified_before_last_write(session) {
        add(
            "The accuracy after the adjustment was measured before the values were last written.",
            None,
        );
    }
    found
}
