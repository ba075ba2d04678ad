//! Checklist of the phase Adjustment.

use egui::{Align, Label, Layout, RichText, Ui};
use egui_material_icons::{MaterialIcon, icons};
use tautline_link::adjusting::Difference;

use crate::model::OpenSession;
use crate::theme::{self, GRID, Palette};
use tautline_workflow::adjusting::{Check, CheckState};

pub(super) fn show(ui: &mut Ui, open: &OpenSession, differences: &[Difference]) {
    ui.add_space(GRID);
    ui.scope(|ui| {
        ui.spacing_mut().item_spacing.y = 0.5 * GRID;
        for (number, check) in open.checklist(differences).iter().enumerate() {
            line(ui, number + 1, check);
        }
    });
}

fn line(ui: &mut Ui, number: usize, check: &Check) {
    let palette = theme::of(ui);
    let (icon, colour, words) = look(check.state, palette);
    ui.horizontal(|ui| {
        ui.label(icon.rich_text().size(16.0).color(colour));
        let title = format!("{number}. {}", check.step.title());
        let title = match check.state {
            CheckState::Next => RichText::new(title).font(theme::strong(13.0)),
            CheckState::Later => RichText::new(title).color(palette.muted),
            _ => RichText::new(title),
        };
        ui.label(title);
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
            let result = match check.result.as_str() {
                "" => words,
                result => result,
            };
            ui.add(Label::new(RichText::new(result).color(palette.muted)).truncate());
        });
    });
}

fn look(state: CheckState, palette: &Palette) -> (MaterialIcon, egui::Color32, &'static str) {
    match state {
        CheckState::Done => (icons::ICON_CHECK_CIRCLE, palette.good, "done"),
        CheckState::Next => (icons::ICON_ARROW_CIRCLE_RIGHT, palette.accent, "next"),
        CheckState::Later => (icons::ICON_RADIO_BUTTON_UNCHECKED, palette.muted, ""),
        CheckState::LeftOut => (icons::ICON_REMOVE_CIRCLE, palette.warning, "left out"),
        CheckState::Bad => (icons::ICON_ERROR, palette.bad, "worse than before"),
    }
}
