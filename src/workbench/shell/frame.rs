//! Layout of the window: menus, phase rail, status bar, and the screen between them.

use egui::{Align, CentralPanel, Frame, Layout, Margin, Panel, Rangef, Stroke, StrokeKind, Ui};
use egui_material_icons::icons;

use super::sized::{Size, sized};
use super::{
    AppState, alert, dialogs, escape, file_chooser, log, menu, palette, rail, save, status, top,
};
use crate::model::command::ViewCommand;
use crate::model::part::ScreenPart;
use crate::model::phase::{Phase, Screen};
use crate::screens;
use crate::theme::{self, GRID};
use crate::views;
use crate::widgets::icon_button;

/// Width of the window (points) below which the rail shows only icons.
const NARROW: f32 = 1120.0;
/// Width of the window (points) below which one part is shown at a time.
const COMPACT: f32 = 900.0;

/// Default width of a phase's panel: share of the window, within limits (points).
const PANEL: f32 = 0.335;
const PANEL_RANGE: Rangef = Rangef {
    min: 440.0,
    max: 520.0,
};

pub fn show(ui: &mut Ui, state: &mut AppState) {
    // Behind a dialog no key works except Stop, which has been handled.
    let is_behind = ui.memory(|memory| memory.top_modal_layer().is_some());
    let of_dialog = ui.input_mut(|input| is_behind.then(|| std::mem::take(&mut input.events)));
    escape::show(ui, state);
    let items = menu::items(state);
    top::shortcuts(ui, state, &items);
    let bar = Frame::new().inner_margin(Margin::symmetric(2 * GRID as i8, GRID as i8));
    Panel::top("top")
        .frame(bar)
        .show(ui, |ui| top::show(ui, state, &items));
    alert::show(ui, state);
    Panel::bottom("status")
        .frame(bar)
        .show(ui, |ui| status::show(ui, state));
    if let Screen::Phase(current) = state.model.screen {
        if state.model.maximised.is_some() || ui.available_width() < COMPACT {
            one_part(ui, state, current);
        } else {
            phase(ui, state, current);
        }
        let (panes, hovered) = (&mut state.views.plots, &mut state.views.hovered);
        views::plots::show_detached(ui, &state.model, panes, hovered, &mut state.outbox);
    } else {
        let ground = Frame::new().fill(theme::of(ui).ground);
        let centre = CentralPanel::no_frame().frame(ground);
        let visit = state.panels.visit(&state.model);
        centre.show(ui, |ui| ui.push_id(visit, |ui| whole(ui, state)));
    }
    log::show(ui, state);
    let AppState {
        model,
        outbox,
        views,
        ..
    } = state;
    views::manual::show(ui, model, &mut views.manual, outbox);
    ui.input_mut(|input| input.events.extend(of_dialog.unwrap_or_default()));
    if !file_chooser::show(ui, state) {
        modals(ui, state);
    }
    escape::remember_typing(ui);
    focus_ring(ui);
}

/// Draws a ring around the focused widget, whatever its own colour.
fn focus_ring(ui: &Ui) {
    let focused = ui.memory(|memory| memory.focused());
    let Some(response) = focused.and_then(|id| ui.ctx().read_response(id)) else {
        return;
    };
    if response.interact_rect.is_positive() {
        let ring = response.rect.intersect(response.interact_rect).expand(2.0);
        let stroke = Stroke::new(2.0, theme::of(ui).text);
        let painter = ui.ctx().layer_painter(response.layer_id);
        painter.rect_stroke(ring, 5.0, stroke, StrokeKind::Outside);
    }
}

/// Screen without parts.
fn whole(ui: &mut Ui, state: &mut AppState) {
    let AppState {
        model,
        outbox,
        panels,
        views,
    } = state;
    match model.screen {
        Screen::Start => screens::start::show(ui, model, &mut panels.start, outbox),
        Screen::Compare => {
            screens::compare::show(ui, model, &mut panels.compare, views, outbox);
        }
        Screen::Record => screens::record::show(ui, model, &mut panels.record, views, outbox),
        Screen::Simulator => {
            screens::simulator::show(ui, model, &mut panels.simulator, outbox);
        }
        Screen::WhichSensor => {
            screens::which_sensor::show(ui, model, &mut panels.which_sensor, outbox);
        }
        Screen::Hypothesis => screens::hypothesis::show(ui, model, outbox),
        Screen::Gallery => screens::gallery::show(ui, model, &mut panels.gallery, outbox),
        Screen::NewRobot => {
            let back = model.previous_screen();
            screens::modeling::new_robot::show(ui, &mut panels.new_robot, back, outbox);
        }
        Screen::Import => screens::import::show(ui, model, &mut panels.import, outbox),
        Screen::Phase(_) => {}
    }
}

/// Command palette and dialogs.
fn modals(ui: &mut Ui, state: &mut AppState) {
    palette::show(ui, state);
    let AppState {
        model,
        outbox,
        panels,
        ..
    } = state;
    screens::connect::show(ui, model, &mut panels.connect, outbox);
    dialogs::show(ui, state);
    save::show(ui, state);
}

/// Rail, 3D view, plots and phase panel side by side.
fn phase(ui: &mut Ui, state: &mut AppState, current: Phase) {
    let side = side();
    rail_of(ui, state, ui.available_width() < NARROW);
    let layout = state.model.preferences.layout;
    let usual = PANEL_RANGE.clamp(PANEL * ui.ctx().content_rect().width());
    let width = Size {
        wanted: layout.panel_width.map_or(usual, |width| width as f32),
        range: Rangef::new(340.0, (0.6 * ui.available_width()).clamp(340.0, 760.0)),
    };
    let panel = Panel::right("phase").frame(side);
    let dragged = sized(ui, panel, width, 0, |ui| panel_of(ui, state, current));
    if let Some(width) = dragged {
        state
            .model
            .change_preferences(|p| p.layout.panel_width = Some(f64::from(width)));
    }
    if views::pulley_inspector::inspected(&state.model).is_some() {
        return robot(ui, state);
    }
    let height = ui.available_height();
    let rows = state.views.plots.rows() as f32;
    // The live scope has several graphs.
    let (share, rows) = match state.model.link.is_under_way() {
        true => (0.56, 2.0),
        false if rows > 1.0 => (0.64, rows),
        false => (0.38, 1.0),
    };
    // A low window still has room for a plot below its controls.
    let usual = (share * height).min(300.0 * rows);
    let usual = usual.max((0.5 * height).min(240.0));
    let size = Size {
        wanted: layout.plots_height.map_or(usual, |height| height as f32),
        range: Rangef::new(140.0, (0.8 * height).max(150.0)),
    };
    let area = Panel::bottom("plots").frame(side);
    let dragged = sized(ui, area, size, 1, |ui| plots(ui, state));
    if let Some(height) = dragged {
        state
            .model
            .change_preferences(|p| p.layout.plots_height = Some(f64::from(height)));
    }
    robot(ui, state);
}

fn rail_of(ui: &mut Ui, state: &mut AppState, is_narrow: bool) {
    let rail = Panel::left("rail").frame(side()).resizable(false);
    rail.exact_size(if is_narrow { rail::NARROW } else { 208.0 })
        .show(ui, |ui| rail::show(ui, state, is_narrow));
}

/// Draws one part only: in a small window, or if the part is maximised.
fn one_part(ui: &mut Ui, state: &mut AppState, current: Phase) {
    let side = side();
    rail_of(ui, state, ui.available_width() < NARROW);
    let maximised = state.model.maximised;
    let mut part = maximised.unwrap_or(state.panels.part);
    Panel::top("parts").frame(side).show(ui, |ui| {
        ui.horizontal(|ui| {
            for one in ScreenPart::ALL {
                ui.selectable_value(&mut part, one, one.title());
            }
            if maximised.is_none() {
                return;
            }
            ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
                let icon = icons::ICON_CLOSE_FULLSCREEN;
                if icon_button(ui, icon, "Restore panels", true).clicked() {
                    state.outbox.send(ViewCommand::Maximise(None));
                }
            });
        });
    });
    match maximised {
        Some(before) if before != part => state.outbox.send(ViewCommand::Maximise(Some(part))),
        Some(_) => {}
        None => state.panels.part = part,
    }
    CentralPanel::no_frame()
        .frame(side)
        .show(ui, |ui| match part {
            ScreenPart::Panel => panel_of(ui, state, current),
            ScreenPart::Robot => robot(ui, state),
            ScreenPart::Plots => plots(ui, state),
        });
}

/// Margins of a panel without fill; the clear colour of the window is its background.
fn side() -> Frame {
    Frame::new().inner_margin(Margin::same(3 * GRID as i8))
}

fn panel_of(ui: &mut Ui, state: &mut AppState, current: Phase) {
    screens::phase(
        ui,
        &state.model,
        &mut state.panels,
        &mut state.outbox,
        current,
    );
}

fn robot(ui: &mut Ui, state: &mut AppState) {
    views::robot(ui, &state.model, &mut state.views, &mut state.outbox);
}

fn plots(ui: &mut Ui, state: &mut AppState) {
    let (panes, hovered) = (&mut state.views.plots, &mut state.views.hovered);
    views::plots::show(ui, &state.model, panes, hovered, &mut state.outbox);
}
