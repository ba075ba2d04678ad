//! The rows above a plot: options, cursor readings, saving.

use std::path::PathBuf;
use std::sync::Arc;

use egui::{Align, ComboBox, Layout, Popup, Role, TextEdit, Theme, Ui, WidgetInfo, vec2};
use egui_material_icons::icons;
use tautline_core::diagnosis::Quantity;

use super::screen::colours;
use super::screen::text_width;
use super::sources::course::Reading;
use super::sources::residuals::Unit;
use super::sources::tensions::Shown as Tensions;
use super::sources::variable::{Choice, capitalised};
use super::view::PlotView;
use super::{PlotState, Tab, print};
use crate::model::Model;
use crate::model::command::{Format, Outbox, PlotCommand, PlotPicture};
use crate::model::plot_preparation::Prepared;
use crate::theme;
use crate::widgets::{icon_button, icon_only, muted};
use tautline_workflow::plot::draw::draw;
use tautline_workflow::plot::table::csv;
use tautline_workflow::plot::{Drawing, Figure, Layout as PlotLayout};

/// Width (points) below which choices are menus.
const NARROW: f32 = 420.0;
/// Width of a button that opens a menu, with the space before it (points).
const MENU: f32 = 72.0;

/// Options, cursor readings and buttons; while a plot is being saved, the form for its file.
pub fn options(
    ui: &mut Ui,
    model: &Model,
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
        let has_menu = is_narrow && plots.tab == Tab::Variable;
        choices(ui, model, plots, is_narrow);
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
            if has_menu {
                menu(ui, plots, figure);
            } else {
                buttons(ui, plots, figure);
            }
        });
    });
    // A line of its own: it is too long to stand beside anything.
    let view = plots.views.get(&plots.tab);
    if let Some(text) = view.and_then(|view| view.reading(figure)) {
        ui.add(egui::Label::new(text).wrap());
    }
}

fn choices(ui: &mut Ui, model: &Model, plots: &mut PlotState, is_narrow: bool) {
    match plots.tab {
        Tab::Residuals | Tab::Laser | Tab::External => {
            let units = [
                (Unit::Deviations, "Standard deviations"),
                (Unit::Millimetres, "Millimetres"),
            ];
            choose(ui, ("Unit", is_narrow), &units, &mut plots.unit);
        }
        Tab::Tensions => {
            let shown = [
                (Tensions::Measured, "Measured"),
                (Tensions::Residuals, "Residuals"),
            ];
            let name = "Tensions shown";
            choose(ui, (name, is_narrow), &shown, &mut plots.tensions);
        }
        Tab::Course => {
            if let Some(open) = &model.open {
                let known = Reading::of(open.session());
                choose(ui, ("Readings", is_narrow), &known, &mut plots.course);
            }
        }
        Tab::Variable => {
            if let (Some(prepared), Some(choice)) = (plots.prepared().cloned(), plots.choice) {
                let room = ui.available_width() - MENU - ui.spacing().item_spacing.x;
                let width = is_narrow.then_some(0.5 * room);
                plots.choice = Some(along(ui, &prepared, choice, width));
            }
        }
        Tab::Elongation => {
            let cables = model
                .open
                .iter()
                .flat_map(|d| &d.session().robot.cables)
                .enumerate();
            let with: Vec<(usize, &str)> = cables
                .filter(|(_, cable)| cable.cable.elongation_surface.is_some())
                .map(|(index, cable)| (index, cable.name.as_str()))
                .collect();
            if with.len() > 1 {
                let chosen = plots.elongation.unwrap_or(with[0].0);
                let name =
                    |index: usize| with.iter().find(|(k, _)| *k == index).map_or("", |c| c.1);
                combo(ui, "Cable", name(chosen), |ui| {
                    for (index, name) in &with {
                        ui.selectable_value(&mut plots.elongation, Some(*index), *name);
                    }
                });
            }
        }
        Tab::Convergence | Tab::Correlation | Tab::BeforeAfter | Tab::Statistics | Tab::Scope => {}
    }
}

/// One of several: beside each other, or in a menu where there is no room.
fn choose<T: Copy + PartialEq>(
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

fn combo(ui: &mut Ui, name: &str, selected: &str, add: impl FnOnce(&mut Ui)) {
    combo_within(ui, (name, None), selected, add);
}

/// As wide as its text, or so wide.
fn combo_within(
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

/// Which readings along which variable, each choice so wide.
fn along(ui: &mut Ui, prepared: &Prepared, mut choice: Choice, width: Option<f32>) -> Choice {
    let name = |quantity: Quantity, cable: Option<usize>| {
        let cables = &prepared.base.dataset.robot.cables;
        match cable.and_then(|index| cables.get(index)) {
            Some(cable) => format!("{} of {}", capitalised(quantity.name()), cable.name),
            None => capitalised(quantity.name()),
        }
    };
    let before = (choice.quantity, choice.cable);
    let readings = name(choice.quantity, choice.cable);
    combo_within(ui, ("Readings", width), &readings, |ui| {
        for group in &prepared.along {
            let is_chosen = (group.quantity, group.cable) == (choice.quantity, choice.cable);
            if ui
                .selectable_label(is_chosen, name(group.quantity, group.cable))
                .clicked()
            {
                (choice.quantity, choice.cable) = (group.quantity, group.cable);
            }
        }
    });
    let group = prepared
        .along
        .iter()
        .find(|g| (g.quantity, g.cable) == (choice.quantity, choice.cable));
    let variables = group.map_or(&[][..], |group| &group.variables);
    if (choice.quantity, choice.cable) != before
        && !variables
            .iter()
            .any(|(variable, _)| *variable == choice.variable)
        && let Some((first, _)) = variables.first()
    {
        choice.variable = *first;
    }
    let variable = capitalised(choice.variable.name());
    combo_within(ui, ("Along", width), &variable, |ui| {
        for (variable, _) in variables {
            ui.selectable_value(
                &mut choice.variable,
                *variable,
                capitalised(variable.name()),
            );
        }
    });
    choice
}

fn buttons(ui: &mut Ui, plots: &mut PlotState, figure: &Figure) {
    let save = icon_only(ui, icons::ICON_DOWNLOAD, "Save plot", true);
    Popup::menu(&save).show(|ui| formats(ui, plots));
    if icon_only(ui, icons::ICON_FIT_SCREEN, "Reset view", true).clicked() {
        view(plots).reset();
    }
    let name = cursors_name(plots);
    if icon_only(ui, icons::ICON_ARROW_RANGE, name, true).clicked() {
        view(plots).switch_cursors(figure);
    }
}

/// The same as a menu, where there is no room for buttons.
fn menu(ui: &mut Ui, plots: &mut PlotState, figure: &Figure) {
    let more = icon_only(ui, icons::ICON_MORE_VERT, "This plot", true);
    Popup::menu(&more).show(|ui| {
        if ui.button(cursors_name(plots)).clicked() {
            view(plots).switch_cursors(figure);
            ui.close();
        }
        if ui.button("Reset view").clicked() {
            view(plots).reset();
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
    let view = plots.views.get(&plots.tab);
    match view.is_some_and(|view| view.cursors.is_some()) {
        true => "Hide cursors",
        false => "Show cursors",
    }
}

fn view(plots: &mut PlotState) -> &mut PlotView {
    plots.views.entry(plots.tab).or_default()
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
    let name = plots.tab.title();
    let selection = model.selection;
    let plot_view = plots.views.get(&plots.tab)?;
    let drawn = plot_view.drawn?;
    let figure = plot_view.visible(figure);
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
