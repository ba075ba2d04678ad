//! The rows above a plot: options, cursor readings, saving.

use std::path::PathBuf;
use std::sync::Arc;

use egui::{Align, ComboBox, Layout, Popup, Role, TextEdit, Theme, Ui, WidgetInfo, vec2};
use egui_material_icons::icons;

use super::screen::colours;
use super::screen::text_width;
use super::sources::variable;
use super::{PlotState, print};
use crate::model::command::{Format, Outbox, PlotCommand, PlotPicture};
use crate::model::{Model, OpenSession};
use crate::theme;
use crate::widgets::{icon_button, icon_only, muted};
use tautline_workflow::plot::draw::draw;
use tautline_workflow::plot::table::csv;
use tautline_workflow::plot::{Drawing, Figure, Layout as PlotLayout};

/// Width (points) below which choices are menus.
const NARROW: f32 = 420.0;

/// Options, cursor readings and buttons; while a plot is being saved, the form for its file.
pub fn options(
    ui: &mut Ui,
    (model, open): (&Model, &OpenSession),
    plots: &mut PlotState,
    figure: &Arc<Figure>,
    outbox: &mut Outbox,
) {
    let is_narrow = ui.available_width() < NARROW;
    ui.horizontal(|ui| {
        if plots.saving.is_some() {
            saving(ui, model, plots, figure, outbox);
            return;
        }
        // Two choices leave no room for buttons.
        let has_menu = is_narrow && plots.kind == &variable::PLOT;
        (plots.kind.options)(ui, plots, open, is_narrow);
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
            if has_menu {
                menu(ui, plots, figure);
            } else {
                buttons(ui, plots, figure);
            }
        });
    });
    // A line of its own: it is too long to stand beside anything.
    if let Some(text) = plots.view.reading(figure) {
        ui.add(egui::Label::new(text).wrap());
    }
}

/// One of several: beside each other, or in a menu where there is no room.
pub(super) fn choose<T: Copy + PartialEq>(
    ui: &mut Ui,
    (name, is_narrow): (&str, bool),
    all: &[(T, &str)],
    chosen: &mut T,
) {
    let add = |ui: &mut Ui, chosen: &mut T| {
        for (value, title) in all {
            ui.selectable_value(chosen, *value, *title);
        }
    };
    if !is_narrow {
        add(ui, chosen);
        return;
    }
    let selected = all.iter().find(|(value, _)| value == chosen);
    let selected = selected.map_or("", |(_, title)| title);
    combo(ui, name, selected, |ui| add(ui, chosen));
}

pub(super) fn combo(ui: &mut Ui, name: &str, selected: &str, add: impl FnOnce(&mut Ui)) {
    combo_within(ui, (name, None), selected, add);
}

/// As wide as its text, or so wide.
pub(super) fn combo_within(
    ui: &mut Ui,
    (name, width): (&str, Option<f32>),
    selected: &str,
    add: impl FnOnce(&mut Ui),
) {
    let shown = ComboBox::from_id_salt(name).selected_text(selected);
    let shown = match width {
        // A text is cut where its place ends, whatever width is asked for.
        Some(width) => {
            let size = vec2(width, ui.spacing().interact_size.y);
            let shown = shown.width(width).truncate();
            ui.allocate_ui(size, |ui| shown.show_ui(ui, add)).inner
        }
        None => shown.show_ui(ui, add),
    };
    let text = format!("{name}: {selected}");
    shown
        .response
        .widget_info(|| WidgetInfo::labeled(Role::ComboBox, true, &text));
}

fn buttons(ui: &mut Ui, plots: &mut PlotState, figure: &Figure) {
    let save = icon_only(ui, icons::ICON_DOWNLOAD, "Save plot", true);
    Popup::menu(&save).show(|ui| formats(ui, plots));
    if icon_only(ui, icons::ICON_FIT_SCREEN, "Reset view", true).clicked() {
        plots.view.reset();
    }
    let name = cursors_name(plots);
    if icon_only(ui, icons::ICON_ARROW_RANGE, name, true).clicked() {
        plots.view.switch_cursors(figure);
    }
}

/// The same as a menu, where there is no room for buttons.
fn menu(ui: &mut Ui, plots: &mut PlotState, figure: &Figure) {
    let more = icon_only(ui, icons::ICON_MORE_VERT, "This plot", true);
    Popup::menu(&more).show(|ui| {
        if ui.button(cursors_name(plots)).clicked() {
            plots.view.switch_cursors(figure);
            ui.close();
        }
        if ui.button("Reset view").clicked() {
            plots.view.reset();
            ui.close();
        }
        ui.separator();
        formats(ui, plots);
    });
}

fn formats(ui: &mut Ui, plots: &mut PlotState) {
    for format in Format::ALL {
        if ui.button(format.title()).clicked() {
            plots.begin_saving(format);
            ui.close();
        }
    }
}

fn cursors_name(plots: &PlotState) -> &'static str {
    match plots.view.cursors.is_some() {
        true => "Hide cursors",
        false => "Show cursors",
    }
}

/// Where a plot is saved.
fn saving(
    ui: &mut Ui,
    model: &Model,
    plots: &mut PlotState,
    figure: &Arc<Figure>,
    outbox: &mut Outbox,
) {
    let Some(mut saving) = plots.saving.take() else {
        return;
    };
    muted(ui, saving.format.title());
    let field = ui.add(TextEdit::singleline(&mut saving.path).desired_width(280.0));
    field.widget_info(|| WidgetInfo::labeled(Role::TextInput, true, "Plot file"));
    if icon_button(ui, icons::ICON_FOLDER_OPEN, "Browse…", true).clicked() {
        outbox.send(PlotCommand::Ask(saving.format));
    }
    let path = PathBuf::from(saving.path.trim());
    let can_save = !path.as_os_str().is_empty();
    let is_saved = icon_button(ui, icons::ICON_SAVE, "Save this plot", can_save).clicked();
    if is_saved && let Some(command) = command(ui, model, plots, figure, (saving.format, path)) {
        outbox.send(command);
        return;
    }
    if !ui.button("Cancel").clicked() {
        plots.saving = Some(saving);
    }
}

fn command(
    ui: &Ui,
    model: &Model,
    plots: &PlotState,
    figure: &Figure,
    (format, path): (Format, PathBuf),
) -> Option<PlotCommand> {
    let name = plots.kind.title;
    let selection = model.selection;
    let drawn = plots.view.drawn?;
    let figure = plots.view.visible(figure);
    let view = drawn.scale.view;
    Some(match format {
        Format::Csv => PlotCommand::SaveText(path, csv(&figure, view)),
        Format::Svg => {
            // On white, whatever the theme is.
            let palette = theme::palette(Theme::Light);
            let whole = egui::Rect::from_min_size(egui::Pos2::ZERO, drawn.size);
            let layout = PlotLayout::new(&figure, view, whole, &text_width(ui.painter()));
            let outer = whole.expand(8.0);
            let drawing = Drawing::record(name, outer, 1.0, |canvas| {
                canvas.fill(outer, palette.raised);
                let resolution = ui.pixels_per_point();
                draw(
                    canvas,
                    &figure,
                    &layout,
                    selection,
                    &colours(palette),
                    resolution,
                );
            });
            PlotCommand::SaveText(path, drawing.svg_file())
        }
        Format::Png => {
            let picture = PlotPicture {
                figure: Arc::new(figure),
                view,
                selection,
                aspect: drawn.size.x / drawn.size.y,
                render: print::png,
            };
            PlotCommand::SavePicture(path, picture)
        }
    })
}
