//! Texts: sections, values with units, verdicts.

use egui::{
    Align, Color32, Label, Layout, Response, RichText, Role, Spinner, Ui, WidgetInfo, WidgetText,
};
use egui_material_icons::{MaterialIcon, icons};

use crate::theme::{self, GRID, Palette};

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Verdict {
    Good,
    Doubtful,
    Bad,
    Neutral,
}

impl Verdict {
    pub(super) fn icon(self) -> MaterialIcon {
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

    pub(super) fn colour(self, palette: &Palette) -> Color32 {
        match self {
            Self::Good => palette.good,
            Self::Doubtful => palette.warning,
            Self::Bad => palette.bad,
            Self::Neutral => palette.muted,
        }
    }
}

/// Texts that the panels have in common.
pub trait UiExt {
    /// Title of a section.
    fn section(&mut self, text: &str) -> Response;

    /// Text of less importance.
    fn muted(&mut self, text: &str) -> Response;

    /// Text that is wrapped at the edge of the panel, in a horizontal layout too.
    fn wrapped(&mut self, text: impl Into<WidgetText>) -> Response;

    /// Row with a name on the left and a number with its unit on the right.
    fn value(&mut self, name: &str, number: &str, unit: &str);

    /// Spinner and what is being done.
    fn busy(&mut self, text: &str);

    /// Verdict in words, with a coloured icon.
    fn verdict(&mut self, verdict: Verdict, text: &str);

    fn good(&mut self, text: &str) {
        self.verdict(Verdict::Good, text);
    }

    fn doubtful(&mut self, text: &str) {
        self.verdict(Verdict::Doubtful, text);
    }

    fn bad(&mut self, text: &str) {
        self.verdict(Verdict::Bad, text);
    }

    fn neutral(&mut self, text: &str) {
        self.verdict(Verdict::Neutral, text);
    }

    /// Text of an empty area: what will appear here, and how to get it.
    fn empty(&mut self, text: &str);
}

impl UiExt for Ui {
    fn section(&mut self, text: &str) -> Response {
        self.add_space(2.0 * GRID);
        self.label(RichText::new(text).font(theme::strong(13.0)))
    }

    fn muted(&mut self, text: &str) -> Response {
        let colour = theme::of(self).muted;
        self.label(RichText::new(text).color(colour))
    }

    fn wrapped(&mut self, text: impl Into<WidgetText>) -> Response {
        self.add(Label::new(text).wrap())
    }

    fn value(&mut self, name: &str, number: &str, unit: &str) {
        self.horizontal(|ui| {
            ui.label(name);
            ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
                ui.muted(unit);
                ui.label(number);
            });
        });
    }

    fn busy(&mut self, text: &str) {
        self.horizontal(|ui| {
            ui.add(Spinner::new());
            ui.muted(text);
        });
    }

    fn verdict(&mut self, verdict: Verdict, text: &str) {
        let colour = verdict.colour(theme::of(self));
        self.horizontal_top(|ui| {
            let icon = ui.label(verdict.icon().rich_text().size(18.0).color(colour));
            icon.widget_info(|| WidgetInfo::labeled(Role::Label, true, verdict.name()));
            ui.wrapped(text);
        });
    }

    fn empty(&mut self, text: &str) {
        let text = WidgetText::from(RichText::new(text).color(theme::of(self).muted));
        let room = self.available_size() - egui::vec2(4.0 * GRID, 0.0);
        let wrap = Some(egui::TextWrapMode::Wrap);
        let galley = text.into_galley(self, wrap, room.x, egui::TextStyle::Body);
        self.add_space((0.5 * (room.y - galley.size().y)).max(0.0));
        self.vertical_centered(|ui| ui.label(galley));
    }
}
