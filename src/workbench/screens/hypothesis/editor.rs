//! Text editor with line numbers and the first error.

use std::sync::Arc;

use egui::text::{LayoutJob, TextFormat};
use egui::{FontId, Galley, ScrollArea, TextBuffer, TextEdit, TextStyle, Ui};
use tautline_core::effect::{HypothesisError, MAX_HYPOTHESIS_BYTES};

use crate::model::command::{HypothesisCommand, Outbox};
use crate::model::hypothesis::HypothesisDraft;
use crate::theme::{self, GRID};
use crate::widgets::UiExt;

/// Height of the error below the text (points).
const MISTAKE: f32 = 48.0;

pub(super) fn show(ui: &mut Ui, draft: &HypothesisDraft, height: f32, outbox: &mut Outbox) {
    let top = ui.cursor().min.y;
    let label = ui.section("Text");
    let error = draft.checked().err();
    let room = height - (ui.cursor().min.y - top) - MISTAKE;
    let frame = egui::Frame::new()
        .fill(theme::of(ui).panel)
        .inner_margin(2.0 * GRID);
    frame.show(ui, |ui| {
        ScrollArea::both()
            .id_salt(("text", draft.number))
            .max_height(room.max(120.0))
            .auto_shrink(false)
            .show(ui, |ui| text(ui, draft, label.id, error, outbox));
    });
    ui.add_space(GRID);
    match error {
        None => ui.good("The text is a hypothesis; its units fit."),
        Some(error) => {
            let mut sentence = error.to_string();
            sentence[..1].make_ascii_uppercase();
            ui.bad(&format!("{sentence}."));
        }
    }
}

fn text(
    ui: &mut Ui,
    draft: &HypothesisDraft,
    label: egui::Id,
    error: Option<&HypothesisError>,
    outbox: &mut Outbox,
) {
    let font = TextStyle::Monospace.resolve(ui.style());
    ui.horizontal_top(|ui| {
        ui.spacing_mut().item_spacing.x = 2.0 * GRID;
        numbers(ui, draft.text(), &font);
        let mut layouter = |ui: &Ui, text: &dyn TextBuffer, _: f32| -> Arc<Galley> {
            let job = coloured(ui, text.as_str(), &font, error);
            ui.fonts_mut(|fonts| fonts.layout_job(job))
        };
        let mut typed = draft.text().to_owned();
        let field = TextEdit::multiline(&mut typed)
            .id(egui::Id::unique(("text of a hypothesis", draft.number)))
            .code_editor()
            .frame(egui::Frame::NONE)
            .margin(egui::Margin::ZERO)
            .char_limit(MAX_HYPOTHESIS_BYTES)
            .desired_width(f32::INFINITY)
            .desired_rows(24)
            .layouter(&mut layouter);
        if ui.add(field).labelled_by(label).changed() {
            outbox.send(HypothesisCommand::SetText(typed));
        }
    });
}

/// Line numbers, as used in error messages.
fn numbers(ui: &mut Ui, text: &str, font: &FontId) {
    let count = 1 + text.matches('\n').count();
    let lines: Vec<String> = (1..=count).map(|line| line.to_string()).collect();
    let colour = theme::of(ui).muted;
    let mut job = LayoutJob::simple(lines.join("\n"), font.clone(), colour, f32::INFINITY);
    job.halign = egui::Align::RIGHT;
    let galley = ui.fonts_mut(|fonts| fonts.layout_job(job));
    let (place, _) = ui.allocate_exact_size(galley.size(), egui::Sense::hover());
    ui.painter().galley(place.right_top(), galley, colour);
}

/// Text with muted comments and the line of the error marked; lines are not wrapped.
fn coloured(ui: &Ui, text: &str, font: &FontId, error: Option<&HypothesisError>) -> LayoutJob {
    let palette = theme::of(ui);
    let mut job = LayoutJob::default();
    job.wrap.max_width = f32::INFINITY;
    for (index, line) in text.split_inclusive('\n').enumerate() {
        let is_wrong = error.is_some_and(|error| error.line == index as u64 + 1);
        let format = |color| TextFormat {
            underline: match is_wrong {
                true => egui::Stroke::new(1.5, palette.bad),
                false => egui::Stroke::NONE,
            },
            ..TextFormat::simple(font.clone(), color)
        };
        let comment = comment_of(line).unwrap_or(line.len());
        job.append(&line[..comment], 0.0, format(palette.text));
        job.append(&line[comment..], 0.0, format(palette.muted));
    }
    job
}

/// Offset of the comment of a line: the first `#` outside of quotes.
fn comment_of(line: &str) -> Option<usize> {
    let mut is_quoted = false;
    line.char_indices().find_map(|(at, sign)| {
        is_quoted ^= sign == '"';
        (sign == '#' && !is_quoted).then_some(at)
    })
}

#[cfg(test)]
mod tests {
    use super::comment_of;

    #[test]
    fn a_comment_begins_outside_of_quotes() {
        assert_eq!(comment_of("# all"), Some(0));
        assert_eq!(comment_of("id = \"a#b\" # c"), Some(11));
        assert_eq!(comment_of("id = \"a#b\""), None);
    }
}
