//! Start screen: open, recover or begin a session.

use std::path::{Path, PathBuf};

use egui::{Align, Button, Layout, Response, RichText, Ui};
use egui_material_icons::icons;

use crate::model::Model;
use crate::model::command::{
    Command, CompareCommand, FileCommand, Outbox, RecordCommand, RecordingCommand, ViewCommand,
};
use crate::model::phase::Screen;
use crate::theme::{self, GRID};
use crate::widgets::{COLUMN, UiExt, icon_button, icon_only, page, path_field, primary};
use tautline_workflow::plot::outline::OUTLINE_SIZE;
use tautline_workflow::samples::{self, Sample};
use tautline_workflow::templates::Template;
use tautline_workflow::wording::local_time::date_and_time;
use tautline_workflow::wording::{count, recent_facts, sentence};

/// State between frames.
#[derive(Debug, Default)]
pub struct PanelState {
    path: String,
    /// Whether all unsaved sessions are listed.
    shows_all: bool,
    /// Available sample sessions, looked up once.
    samples: Option<Vec<Sample>>,
}

/// Number of unsaved sessions listed at first.
const UNSAVED_SHOWN: usize = 3;

/// Smallest width of the screen for two columns, and their total width (points).
const WIDE: f32 = 940.0;
const COLUMNS: f32 = 1120.0;

pub fn show(ui: &mut Ui, model: &Model, panel: &mut PanelState, outbox: &mut Outbox) {
    let is_wide = ui.available_width() >= WIDE;
    let above = (ui.ctx().content_rect().height() * 0.09).max(6.0 * GRID);
    let width = if is_wide { COLUMNS } else { COLUMN };
    page(ui, width, above, |ui| {
        ui.label(RichText::new("Tautline").font(theme::strong(32.0)));
        ui.muted("Identify the pulleys of a cable robot and diagnose its model.");
        ui.add_space(4.0 * GRID);
        unsaved_sessions(ui, model, panel, outbox);
        if is_wide {
            ui.spacing_mut().item_spacing.x = 12.0 * GRID;
            ui.columns_const(|[left, right]| {
                for column in [&mut *left, &mut *right] {
                    column.spacing_mut().item_spacing.x = 2.0 * GRID;
                }
                things_to_do(left, model, panel, outbox);
                known_sessions(right, model, panel, outbox);
            });
        } else {
            things_to_do(ui, model, panel, outbox);
            known_sessions(ui, model, panel, outbox);
        }
        ui.add_space(6.0 * GRID);
    });
}

fn things_to_do(ui: &mut Ui, model: &Model, panel: &mut PanelState, outbox: &mut Outbox) {
    begin(ui, model, outbox);
    ui.section("Open a session, a robot.json or a dataset folder");
    open(ui, panel, outbox);
    new_robot(ui, outbox);
    compare(ui, outbox);
}

fn known_sessions(ui: &mut Ui, model: &Model, panel: &mut PanelState, outbox: &mut Outbox) {
    recent(ui, model, outbox);
    sample_sessions(ui, panel, outbox);
}

fn begin(ui: &mut Ui, model: &Model, outbox: &mut Outbox) {
    ui.horizontal_wrapped(|ui| {
        let title = "Try the demo robot";
        // Recovery comes first.
        let demo = match model.recoverable() {
            Some(_) => ui.button(title),
            None => primary(ui, title, true),
        };
        if demo.clicked() {
            outbox.send(FileCommand::TryDemo);
        }
        ui.muted("A simulated robot with a hidden fault; takes five minutes.");
    });
}

fn open(ui: &mut Ui, panel: &mut PanelState, outbox: &mut Outbox) {
    let path = &mut panel.path;
    ui.horizontal(|ui| {
        // Leaves room for both buttons.
        let width = (ui.available_width() - 190.0).clamp(120.0, 400.0);
        let hint = "Path, or drop a file on the window";
        let entered = path_field(ui, "Path", hint, path, width);
        let typed = !path.trim().is_empty();
        if (ui.add_enabled(typed, Button::new("Open")).clicked() || entered) && typed {
            outbox.send(FileCommand::Open(PathBuf::from(path.trim())));
        }
        if icon_button(ui, icons::ICON_FOLDER_OPEN, "Browse…", true).clicked() {
            outbox.send(FileCommand::AskOpen);
        }
    });
}

fn new_robot(ui: &mut Ui, outbox: &mut Outbox) {
    ui.section("New robot");
    template_buttons(ui, outbox);
}

/// Button for each template, and one for a robot to be typed in.
pub(super) fn template_buttons(ui: &mut Ui, outbox: &mut Outbox) {
    ui.horizontal_wrapped(|ui| {
        for template in Template::ALL {
            let button = ui.button(template.title());
            if button.on_hover_text(template.summary()).clicked() {
                outbox.send(FileCommand::New(template));
            }
        }
        if ui
            .button("Empty table")
            .on_hover_text("Type or paste the numbers of all cables")
            .clicked()
        {
            outbox.send(ViewCommand::Go(Screen::NewRobot));
        }
    });
}

fn compare(ui: &mut Ui, outbox: &mut Outbox) {
    for (icon, title, purpose, command) in [
        (
            icons::ICON_COMPARE_ARROWS,
            "Compare two sessions",
            "Has a pulley moved, or is it noise?",
            Command::from(CompareCommand::Show),
        ),
        (
            icons::ICON_TIMELINE,
            "Record of a robot",
            "What moved, and when to calibrate again.",
            RecordCommand::Show.into(),
        ),
        (
            icons::ICON_UPLOAD_FILE,
            "Import files of other programs",
            "Logs, motion capture, spreadsheets.",
            RecordingCommand::Show.into(),
        ),
    ] {
        ui.add_space(GRID);
        ui.horizontal_wrapped(|ui| {
            if icon_button(ui, icon, title, true).clicked() {
                outbox.send(command);
            }
            ui.muted(purpose);
        });
    }
}

fn unsaved_sessions(ui: &mut Ui, model: &Model, panel: &mut PanelState, outbox: &mut Outbox) {
    if model.unsaved_sessions.is_empty() {
        return;
    }
    let warning = theme::of(ui).warning;
    ui.horizontal(|ui| {
        ui.label(icons::ICON_RESTORE.rich_text().size(18.0).color(warning));
        ui.label(
            RichText::new("Tautline was closed without saving. These sessions can be recovered:")
                .font(theme::strong(13.0)),
        );
    });
    let shown = if panel.shows_all {
        usize::MAX
    } else {
        UNSAVED_SHOWN
    };
    for (place, left) in model.unsaved_sessions.iter().enumerate().take(shown) {
        ui.horizontal(|ui| {
            let poses = count(left.poses, "pose");
            ui.label(&left.name);
            ui.muted(&format!("{poses}, {}", date_and_time(left.when)));
            ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
                let name = format!("Discard {}", left.name);
                let discard = ui.button("Discard").on_hover_text(
                    "Moves the files to the folder \"discarded\"; nothing is deleted",
                );
                discard.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Button, true, &name));
                if discard.clicked() {
                    outbox.send(FileCommand::Discard(place));
                }
                let name = format!("Recover {}", left.name);
                let recover = match model.recoverable() == Some(place) {
                    true => primary(ui, "Recover", true),
                    false => ui.add_enabled(left.problem.is_none(), Button::new("Recover")),
                };
                recover.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Button, true, &name));
                if recover.clicked() {
                    outbox.send(FileCommand::Recover(place));
                }
            });
        });
        if let Some(problem) = &left.problem {
            ui.muted(&problem.to_string());
        }
    }
    let more = model.unsaved_sessions.len().saturating_sub(shown);
    if more > 0 && ui.button(format!("Show {more} more")).clicked() {
        panel.shows_all = true;
    }
    ui.add_space(4.0 * GRID);
}

fn recent(ui: &mut Ui, model: &Model, outbox: &mut Outbox) {
    if model.preferences.recent().is_empty() {
        return;
    }
    ui.section("Recent sessions");
    for recent in model.preferences.recent() {
        let there = recent.exists();
        let facts = recent_facts(recent);
        let facts = match there {
            true => facts,
            false => format!("{facts}: the file no longer exists"),
        };
        let forget = format!("Forget {}", recent.name);
        let folder = recent.path().parent().unwrap_or(Path::new(""));
        ui.horizontal_top(|ui| {
            ui.with_layout(Layout::right_to_left(Align::Min), |ui| {
                if icon_only(ui, icons::ICON_CLOSE, &forget, true).clicked() {
                    outbox.send(FileCommand::Forget(recent.path().to_owned()));
                }
                ui.with_layout(Layout::top_down(Align::Min), |ui| {
                    let hint = folder.display().to_string();
                    if entry(ui, &recent.name, &facts, &recent.outline, there)
                        .on_hover_text(hint)
                        .clicked()
                    {
                        outbox.send(FileCommand::Open(recent.path().to_owned()));
                    }
                });
            });
        });
    }
}

fn sample_sessions(ui: &mut Ui, panel: &mut PanelState, outbox: &mut Outbox) {
    let found = panel
        .samples
        .get_or_insert_with(|| samples::find(&samples::places()));
    if found.is_empty() {
        return;
    }
    ui.section("Sample sessions");
    for sample in found.iter() {
        let facts = match sample.facts.as_str() {
            "" => sample.shows.clone(),
            facts => format!("{} {}.", sample.shows, sentence(facts)),
        };
        if entry(ui, &sample.title, &facts, &sample.outline, true).clicked() {
            outbox.send(FileCommand::Open(sample.session.clone()));
        }
    }
}

/// Entry of a session: name, small picture of its robot, and details.
fn entry(ui: &mut Ui, name: &str, facts: &str, outline: &[[i16; 4]], enabled: bool) -> Response {
    let palette = theme::of(ui);
    let colour = if enabled {
        palette.accent
    } else {
        palette.muted
    };
    let entry = ui.horizontal_top(|ui| {
        picture(ui, outline);
        ui.vertical(|ui| {
            ui.spacing_mut().item_spacing.y = 0.0;
            // The name is aligned with the heading, without the margin of a button.
            ui.spacing_mut().button_padding.x = 0.0;
            let name = RichText::new(name).font(theme::strong(13.0)).color(colour);
            let button = Button::new(name).frame_when_inactive(false).wrap();
            let entry = ui.add_enabled(enabled, button);
            ui.wrapped(RichText::new(facts).color(palette.muted));
            ui.add_space(GRID);
            entry
        })
    });
    entry.inner.inner
}

/// Picture of a robot: the lines of its cables.
fn picture(ui: &mut Ui, outline: &[[i16; 4]]) {
    let size = 9.0 * GRID;
    let (rect, _) = ui.allocate_exact_size(egui::Vec2::splat(size), egui::Sense::hover());
    let palette = theme::of(ui);
    let place = |x: i16, y: i16| {
        let part = egui::vec2(x.into(), y.into()) / f32::from(OUTLINE_SIZE);
        rect.min + size * part
    };
    for (index, [x1, y1, x2, y2]) in outline.iter().copied().enumerate() {
        let colour = palette.cables[index % palette.cables.len()];
        let ends = [place(x1, y1), place(x2, y2)];
        ui.painter()
            .line_segment(ends, egui::Stroke::new(1.5, colour));
    }
}
