//! Texts: headings, values with units, verdicts.

use egui::{Align, Layout, Response, RichText, Role, Ui, WidgetInfo};
use egui_material_icons::{MaterialIcon, icons};

use crate::theme::{self, GRID};

pub fn heading(ui: &mut Ui, text: &str) -> Response {
    ui.heading(text)
}

pub fn section(ui: &mut Ui, text: &str) -> Response {
    ui.add_space(2.0 * GRID);
    ui.label(RichText::new(text).font(theme::strong(13.0)))
}

/// Text of less importance.
pub fn muted(ui: &mut Ui, text: &str) -> Response {
    let colour = theme::of(ui).muted;
    ui.label(RichText::new(text).color(colour))
}

/// Row with a name on the left and a number with its unit on the right.
pub fn value(ui: &mut Ui, name: &str, number: &str, unit: &str) {
    ui.horizontal(|ui| {
        ui.label(name);
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
            muted(ui, unit);
            ui.label(number);
        });
    });
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Verdict {
    Good,
    Doubtful,
    Bad,
    Neutral,
}

impl Verdict {
    fn icon(self) -> MaterialIcon {
        match self {
            Self::Good => icons::ICON_CHECK_CIRCLE,
            Self::Doubtful => icons::ICON_WARNING,
            Self::Bad => icons::ICON_ERROR,
            Self::Neutral => icons::ICON_INFO,
        }
    }

    /// Text of the icon, for screen readers.
    fn name(self) -> &'static str {
        match self {
            Self::Good => "Good:",
            Self::Doubtful => "Warning:",
            Self::Bad => "Problem:",
            Self::Neutral => "Note:",
        }
    }
}

/// Verdict in words, with a coloured icon.
pub fn verdict(ui: &mut Ui, verdict: Verdict, text: &str) {
    let palette = theme::of(ui);
    let colour = match verdict {
        Verdict::Good => palette.good,
        Verdict::Doubtful => palette.warning,
        Verdict::Bad => palette.bad,
        Verdict::Neutral => palette.muted,
    };
    ui.horizontal_top(|ui| {
        let icon = ui.label(verdict.icon().rich_text().size(18.0).color(colour));
        icon.widget_info(|| WidgetInfo::labeled(Role::Label, true, verdict.name()));
        ui.add(egui::Label::new(text).wrap());
    });
}

/// Text of an empty area: what will appear here, and how to get it.
pub fn empty(ui: &mut Ui, text: &str) {
    let text = RichText::new(text).color(theme::of(ui).muted);
    let text = egui::WidgetText::from(text);
    let room = ui.available_size() - egui::vec2(4.0 * GRID, 0.0);
    let wrap = Some(egui::TextWrapMode::Wrap);
    let galley = text.into_galley(ui, wrap, room.x, egui::TextStyle::Body);
    ui.add_space((0.5 * (room.y - galley.size().y)).max(0.0));
    ui.vertical_centered(|ui| ui.label(galley));
}
