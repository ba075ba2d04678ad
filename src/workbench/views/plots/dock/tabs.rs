//! Tabs of the docked plots, and the buttons beside them.

use std::collections::{BTreeMap, HashSet};
use std::sync::Arc;

use super::super::{PlotState, pane, sources};
use super::PlotId;
use super::tree::Preset;
use crate::model::command::{Outbox, ViewCommand};
use crate::model::part::ScreenPart;
use crate::model::{Model, OpenSession, Selection};
use crate::theme::{self, GRID};
use crate::widgets::{fitting, icon_only};
use egui::{
    Button, CursorIcon, Galley, Popup, Rect, Response, Role, Sense, Stroke, TextStyle,
    TextWrapMode, Ui, Vec2, Visuals, WidgetInfo, WidgetText, vec2,
};
use egui_material_icons::icons;
use egui_tiles::{
    Behavior, ResizeState, SimplificationOptions, TabState, Tabs, TileId, Tiles, UiResponse,
};

/// Height of a row of tabs (points).
const BAR: f32 = 7.0 * GRID;
/// Width of an icon button with the space beside it (points).
const ICON: f32 = 48.0;

/// Requested change of the arrangement.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum DockRequest {
    /// Bring the plot to the front.
    Show(PlotId),
    /// Open the plot in a separate window.
    Detach(PlotId),
    /// Open another plot of the same kind.
    Another(PlotId),
    /// Close the plot, of which there are others.
    Close(PlotId),
    /// Apply a preset arrangement.
    Arrange(Preset),
}

/// Docked plots in one frame.
pub(crate) struct Dock<'a> {
    pub(crate) model: &'a Model,
    pub(crate) open: &'a OpenSession,
    pub(crate) plots: &'a mut BTreeMap<PlotId, PlotState>,
    pub(crate) hovered: &'a mut Selection,
    pub(crate) outbox: &'a mut Outbox,
    pub(crate) area: Rect,
    /// Tabs without room.
    pub(crate) hidden: HashSet<TileId>,
    pub(crate) wish: Option<DockRequest>,
}

impl Dock<'_> {
    fn is_maximised(&self) -> bool {
        self.model.maximised == Some(ScreenPart::Plots)
    }

    /// Buttons to the right of the tabs of an area.
    fn buttons(&mut self, ui: &mut Ui, tiles: &Tiles<PlotId>, tabs: &Tabs, is_corner: bool) {
        let shown = tabs.active.and_then(|tile| tiles.get_pane(&tile)).copied();
        if is_corner {
            let button = icon_only(ui, icons::ICON_GRID_VIEW, "Plot layout", true);
            Popup::menu(&button).show(|ui| {
                for preset in Preset::ALL {
                    if ui.button(preset.title()).clicked() {
                        self.wish = Some(DockRequest::Arrange(preset));
                        ui.close();
                    }
                }
                if let Some(plot) = shown {
                    ui.separator();
                    self.entries(ui, plot);
                }
            });
        }
        if let Some(plot) = shown.filter(|_| !self.is_maximised()) {
            let name = format!("Maximise {}", plot.title());
            if icon_only(ui, icons::ICON_OPEN_IN_FULL, &name, true).clicked() {
                self.maximise(plot);
            }
        }
    }

    fn maximise(&mut self, plot: PlotId) {
        self.wish = Some(DockRequest::Show(plot));
        self.outbox
            .send(ViewCommand::Maximise(Some(ScreenPart::Plots)));
    }

    /// Menu entries for a plot.
    fn entries(&mut self, ui: &mut Ui, plot: PlotId) {
        let title = plot.title();
        if ui.button(format!("Open {title} in a window")).clicked() {
            self.wish = Some(DockRequest::Detach(plot));
            ui.close();
        }
        if plot.kind == &sources::variable::PLOT && ui.button("Another plot by variable").clicked()
        {
            self.wish = Some(DockRequest::Another(plot));
            ui.close();
        }
        if plot.copy > 0 && ui.button(format!("Close {title}")).clicked() {
            self.wish = Some(DockRequest::Close(plot));
            ui.close();
        }
    }

    /// Menu of the tabs without room.
    fn more(&mut self, ui: &mut Ui, tiles: &Tiles<PlotId>, hidden: &[TileId]) {
        let button = icon_only(ui, icons::ICON_EXPAND_MORE, "More plots", true);
        Popup::menu(&button).show(|ui| {
            for plot in hidden.iter().filter_map(|tile| tiles.get_pane(tile)) {
                let missing = (plot.kind.missing)(self.open);
                let entry = ui.add_enabled(missing.is_none(), Button::new(plot.title()));
                if entry.clicked() {
                    self.wish = Some(DockRequest::Show(*plot));
                    ui.close();
                }
                if let Some(why) = missing {
                    entry.on_disabled_hover_text(why);
                }
            }
        });
    }
}

fn galley(ui: &Ui, plot: PlotId) -> Arc<Galley> {
    let text = WidgetText::from(plot.title());
    text.into_galley(
        ui,
        Some(TextWrapMode::Extend),
        f32::INFINITY,
        TextStyle::Button,
    )
}

fn width(ui: &Ui, plot: PlotId) -> f32 {
    galley(ui, plot).size().x + 2.0 * ui.spacing().button_padding.x
}

impl Behavior<PlotId> for Dock<'_> {
    fn pane_ui(&mut self, ui: &mut Ui, _: TileId, plot: &mut PlotId) -> UiResponse {
        let state = self
            .plots
            .entry(*plot)
            .or_insert_with(|| PlotState::of(*plot));
        ui.add_space(0.5 * GRID);
        pane(ui, self.model, state, self.hovered, self.outbox);
        UiResponse::None
    }

    fn tab_title_for_pane(&mut self, plot: &PlotId) -> WidgetText {
        plot.title().into()
    }

    fn tab_ui(
        &mut self,
        tiles: &mut Tiles<PlotId>,
        ui: &mut Ui,
        id: egui::Id,
        tile: TileId,
        state: &TabState,
    ) -> Response {
        let plot = tiles.get_pane(&tile).copied();
        let Some(plot) = plot.filter(|_| !self.hidden.contains(&tile)) else {
            return ui.allocate_response(Vec2::ZERO, Sense::hover());
        };
        let missing = (plot.kind.missing)(self.open);
        let is_enabled = missing.is_none();
        let galley = galley(ui, plot);
        let size = vec2(width(ui, plot), ui.available_height());
        let (_, whole) = ui.allocate_space(size);
        let rect = whole.shrink2(vec2(1.0, 0.5 * GRID));
        let sense = match is_enabled {
            true => Sense::click_and_drag(),
            false => Sense::drag(),
        };
        let response = ui
            .interact(rect, id, sense)
            .on_hover_cursor(CursorIcon::Grab);
        response.widget_info(|| {
            WidgetInfo::selected(Role::Button, is_enabled, state.active, plot.title())
        });
        let palette = theme::of(ui);
        let visuals = ui.style().interact_selectable(&response, state.active);
        if state.active || response.hovered() || response.has_focus() {
            let radius = visuals.corner_radius;
            ui.painter().rect_filled(rect, radius, visuals.weak_bg_fill);
        }
        let colour = match is_enabled {
            true => palette.text,
            false => palette.muted.gamma_multiply(0.7),
        };
        let at = rect.center() - 0.5 * galley.size();
        ui.painter().galley(at, galley, colour);
        if response.double_clicked() && !self.is_maximised() {
            self.maximise(plot);
        }
        response.context_menu(|ui| self.entries(ui, plot));
        let hint = missing.unwrap_or("Drag to dock it elsewhere, double-click to maximise it");
        response.on_hover_text(hint)
    }

    fn top_bar_right_ui(
        &mut self,
        tiles: &Tiles<PlotId>,
        ui: &mut Ui,
        tile: TileId,
        tabs: &Tabs,
        _scroll_offset: &mut f32,
    ) {
        let corner = tiles.rect(tile).map(|rect| rect.right_top());
        let is_corner = corner.is_some_and(|at| (at - self.area.right_top()).length() < 1.0);
        self.buttons(ui, tiles, tabs, is_corner);
        let panes: Vec<(TileId, PlotId)> = tabs
            .children
            .iter()
            .filter_map(|tile| Some((*tile, *tiles.get_pane(tile)?)))
            .collect();
        let widths: Vec<f32> = panes.iter().map(|(_, plot)| width(ui, *plot)).collect();
        let chosen = panes
            .iter()
            .position(|(tile, _)| tabs.active == Some(*tile));
        let is_shown = fitting(&widths, chosen, ui.available_width(), 0.0, ICON);
        let hidden = panes.iter().zip(is_shown).filter(|(_, shown)| !shown);
        let hidden: Vec<TileId> = hidden.map(|((tile, _), _)| *tile).collect();
        if !hidden.is_empty() {
            self.more(ui, tiles, &hidden);
        }
        self.hidden.extend(hidden);
    }

    fn tab_bar_height(&self, _: &egui::Style) -> f32 {
        BAR
    }

    fn tab_bar_color(&self, _visuals: &Visuals) -> egui::Color32 {
        egui::Color32::TRANSPARENT
    }

    /// Wide enough to be grabbed.
    fn gap_width(&self, _: &egui::Style) -> f32 {
        3.0 * GRID
    }

    fn min_size(&self) -> f32 {
        120.0
    }

    fn resize_stroke(&self, style: &egui::Style, state: ResizeState) -> Stroke {
        let visuals = &style.visuals;
        match state {
            ResizeState::Idle => Stroke::new(1.0, visuals.widgets.noninteractive.bg_stroke.color),
            ResizeState::Hovering => Stroke::new(2.0, visuals.widgets.hovered.bg_stroke.color),
            ResizeState::Dragging => Stroke::new(2.0, visuals.hyperlink_color),
        }
    }

    fn simplification_options(&self) -> SimplificationOptions {
        SimplificationOptions {
            all_panes_must_have_tabs: true,
            flatten_tabs_in_tabs: true,
            ..SimplificationOptions::default()
        }
    }

    /// Plots are dragged individually.
    fn is_tile_draggable(&self, tiles: &Tiles<PlotId>, tile: TileId) -> bool {
        tiles.get_pane(&tile).is_some()
    }
}
