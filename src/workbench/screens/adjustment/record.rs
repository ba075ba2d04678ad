//! Record of the adjustments: operator, time, outcome.

use egui::{CollapsingHeader, Ui};
use tautline_session::{Adjustment, Outcome};

use crate::model::OpenSession;
use crate::widgets::{UiExt, Verdict};
use tautline_workflow::wording::count;
use tautline_workflow::wording::local_time::date_and_time;

/// Draws the last outcome and the record.
pub(super) fn show(ui: &mut Ui, open: &OpenSession) {
    let adjustments = open.session().adjustments();
    let Some(last) = adjustments.last() else {
        return;
    };
    ui.section("Adjustment history");
    let (kind, text) = words(last);
    ui.verdict(kind, &text);
    let header = CollapsingHeader::new(format!("History ({})", adjustments.len()));
    header.id_salt("record").show(ui, |ui| {
        for adjustment in adjustments.iter().rev() {
            let (_, text) = words(adjustment);
            let who = match adjustment.operator.as_str() {
                "" => "operator not named",
                name => name,
            };
            let when = date_and_time(adjustment.time);
            ui.muted(&format!("{when}, {who}, {}", adjustment.controller));
            ui.wrapped(text);
        }
    });
}

fn words(adjustment: &Adjustment) -> (Verdict, String) {
    let values = adjustment.changes.len();
    match &adjustment.outcome {
        Outcome::Written => (
            Verdict::Good,
            format!("{} written and read back.", count(values, "value")),
        ),
        Outcome::RolledBack => (
            Verdict::Neutral,
            format!(
                "{} restored.",
                count(values, "value")
            ),
        ),
        Outcome::Begun => (
            Verdict::Bad,
            "The program ended while values were being written: the controller may hold a mix of old and new values.".to_owned(),
        ),
        Outcome::Failed(why) | Outcome::Unsettled(why) => (Verdict::Bad, why.clone()),
    }
}
