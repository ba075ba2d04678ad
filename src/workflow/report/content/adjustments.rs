//! Values written to the controller.

use tautline_core::robot::Cable;
use tautline_session::{Adjustment, Outcome, Session};

use super::{number, signed, when};
use crate::adjusting::{Review, in_effect, written};
use crate::identification::Identification;
use crate::report::document::{Section, Table};
use crate::wording::parameters::{title, unit};
use crate::wording::units::display_unit;

pub fn section(session: &Session) -> Option<Section> {
    if session.adjustments().is_empty() {
        return None;
    }
    let mut section = Section::new("Adjustments of the controller");
    for adjustment in session.adjustments() {
        section.heading(when(adjustment.time));
        section.paragraph(sentence(adjustment));
        section.table(changes(adjustment, &session.robot.cables));
    }
    Some(section)
}

/// Whether the identified values are in the controller, who wrote them, and who accepted the robot; `None` if nothing was
/// written.
pub fn state(session: &Session, fit: &Identification) -> Option<String> {
    let last = in_effect(session)?;
    let review = Review::recorded(session, fit);
    let Some(written) = written(session, &review.lines) else {
        return Some(match last.outcome {
            Outcome::Written if !last.restores => format!(
                "The controller holds other values than these: those written on {}.",
                when(last.time)
            ),
            _ => "The controller does not hold these values; see the adjustments.".to_owned(),
        });
    };
    let mut text = format!(
        "These values were written to the controller{} on {} and read back.",
        by(&written.adjustment.operator),
        when(written.adjustment.time)
    );
    if let Some(adaptation) = &review.adaptation {
        text += &format!(" {}.", adaptation.sentence);
    }
    if let Some(accepted) = written.acceptance {
        text += &format!(
            " The robot was accepted{} on {}.",
            by(&accepted.operator),
            when(accepted.time)
        );
    }
    Some(text)
}

/// ` by Ada`; empty if the operator is not named.
fn by(operator: &str) -> String {
    match operator.trim() {
        "" => String::new(),
        name => format!(" by {name}"),
    }
}

fn sentence(adjustment: &Adjustment) -> String {
    let Adjustment {
        operator,
        controller,
        outcome,
        ..
    } = adjustment;
    let outcome = match outcome {
        Outcome::Written => "all values were written and read back".to_owned(),
        Outcome::RolledBack => "the old values were written back".to_owned(),
        Outcome::Begun => "it was interrupted while values were being written".to_owned(),
        Outcome::Failed(reason) => format!("it failed: {reason}"),
        Outcome::Unsettled(reason) => {
            format!("the controller may hold both old and new values: {reason}")
        }
    };
    format!(
        "Controller {controller}{}: {}.",
        by(operator),
        outcome.trim_end_matches('.')
    )
}

fn changes(adjustment: &Adjustment, cables: &[Cable]) -> Table {
    let mut table = Table::new(
        "Parameters of the controller",
        2,
        &["Parameter", "unit", "before", "written", "change"],
    );
    for change in &adjustment.changes {
        let unit = unit(&change.name, &change.unit);
        let (factor, shown) = unit.map_or((1.0, ""), display_unit);
        // Counts have no decimals.
        let digits = if unit.is_some() { 3 } else { 0 };
        table.push([
            title(&change.name, cables),
            shown.to_owned(),
            number(factor * change.before, digits),
            number(factor * change.after, digits),
            signed(factor * (change.after - change.before), digits),
        ]);
    }
    table
}
