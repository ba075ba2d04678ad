//! Pulley inspector: one pulley true to scale, in 3D and in three projections with a grid, with its coordinates and
//! their uncertainty.

mod coordinates;
mod inset;
mod region;

use egui::{CentralPanel, Frame, Key, Label, Margin, Panel, RichText, ScrollArea, Ui};
use egui_material_icons::icons;
use tautline_core::robot::Robot;

use super::robot_3d::{self, CameraRequest, Robot3d};
use crate::model::command::{Outbox, ViewCommand};
use crate::model::{Model, Selection};
use crate::theme::{self, GRID};
use crate::widgets::{UiExt, icon_button, icon_only};
use inset::{Inset, SIDES, Scale};
use tautline_workflow::identification::{FitVerdict, IdentifiedPulley, PulleyInspection};
use tautline_workflow::wording::units::significant;

/// Largest side of an inset (points), and its share of the height.
const INSET: f32 = 280.0;
const INSET_SHARE: f32 = 0.26;
/// Smallest width of the numbers beside the insets (points).
const BESIDE: f32 = 400.0;
/// Smallest height of the 3D picture (points).
const PICTURE: f32 = 140.0;
/// Height of the numbers below the insets (points).
const NUMBERS: f32 = 220.0;
/// Height of the captions above and below the insets (points).
const CAPTIONS: f32 = 84.0;

/// Layout of insets and numbers.
#[derive(Debug, Clone, Copy)]
struct Arrangement {
    /// Side of an inset (points).
    inset: f32,
    /// Whether the numbers are beside the insets instead of below them.
    is_wide: bool,
}

impl Arrangement {
    /// Layout for a width and a height (points).
    fn of(width: f32, height: f32) -> Self {
        let across = (width - 4.0 * GRID) / 3.0;
        let inset = across.min(INSET_SHARE * height).clamp(80.0, INSET);
        // With the space between and after the insets.
        let insets = 3.0 * inset + 10.0 * GRID;
        Self {
            inset,
            is_wide: width - insets > BESIDE,
        }
    }

    /// Total height (points).
    fn height(self) -> f32 {
        self.inset + CAPTIONS + if self.is_wide { 0.0 } else { NUMBERS }
    }
}

/// Inspected pulley, by the index of its cable, if it belongs to the open session.
#[must_use]
pub fn inspected(model: &Model) -> Option<usize> {
    let open = model.open.as_ref()?;
    let count = open.session().robot.cable_count();
    model.inspected.filter(|cable| *cable < count)
}

pub fn show(
    ui: &mut Ui,
    model: &Model,
    cable: usize,
    view: &mut Robot3d,
    hovered: &mut Selection,
    outbox: &mut Outbox,
) {
    let Some(open) = &model.open else {
        return;
    };
    let robot = &open.session().robot;
    let fit = open.fit().map(AsRef::as_ref);
    let Some(inspection) = PulleyInspection::of(robot, fit, cable) else {
        return;
    };
    let palette = theme::of(ui);
    let side = Frame::new()
        .fill(palette.panel)
        .inner_margin(Margin::symmetric(3 * GRID as i8, 2 * GRID as i8));
    let mut aim = None;
    Panel::top("inspected pulley")
        .frame(side)
        .show(ui, |ui| aim = header(ui, &inspection, robot, outbox));
    keys(ui, robot, cable, outbox);
    let height = ui.available_height();
    let width = ui.available_width() - 6.0 * GRID;
    let arrangement = Arrangement::of(width, height);
    let wanted = match inspection.identified {
        Some(_) => arrangement.height(),
        None => 14.0 * GRID,
    };
    Panel::bottom("numbers of the pulley")
        .frame(side)
        .resizable(false)
        .exact_size(wanted.min((height - PICTURE).max(60.0)))
        .show(ui, |ui| {
            ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
                let is_explained = fit.is_none_or(|fit| {
                    let verdict = FitVerdict::of(fit.solution.p_value());
                    verdict != FitVerdict::Inadequate
                });
                judged(ui, &inspection, is_explained);
                details(ui, &inspection, robot, open.tolerance_m(), arrangement);
            });
        });
    CentralPanel::no_frame().show(ui, |ui| {
        robot_3d::inspect(ui, model, cable, view, hovered, aim, outbox);
    });
}

/// Header with the name of the pulley and navigation; returns a requested camera movement.
fn header(
    ui: &mut Ui,
    inspection: &PulleyInspection,
    robot: &Robot,
    outbox: &mut Outbox,
) -> Option<CameraRequest> {
    let cable = inspection.cable;
    let mut aim = None;
    ui.horizontal(|ui| {
        let colour = theme::of(ui).cable(cable);
        let (dot, _) = ui.allocate_exact_size(egui::Vec2::splat(10.0), egui::Sense::hover());
        ui.painter().circle_filled(dot.center(), 5.0, colour);
        let title = format!("Pulley of {}", inspection.name);
        ui.add(Label::new(RichText::new(title).font(theme::strong(15.0))).truncate());
        ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
            if icon_only(ui, icons::ICON_CLOSE, "Close inspector (Escape)", true).clicked() {
                outbox.send(ViewCommand::Inspect(None));
            }
            ui.separator();
            let several = robot.cable_count() > 1;
            for (icon, name, step) in [
                (icons::ICON_CHEVRON_RIGHT, "Next pulley (Page down)", 1),
                (icons::ICON_CHEVRON_LEFT, "Previous pulley (Page up)", -1),
            ] {
                if icon_only(ui, icon, name, several).clicked() {
                    go(robot, cable, step, outbox);
                }
            }
            ui.separator();
            let all = "Show the whole robot (Home)";
            if icon_only(ui, icons::ICON_FIT_SCREEN, all, true).clicked() {
                aim = Some(CameraRequest::All);
            }
            let near = "Show the pulley (F)";
            if icon_only(ui, icons::ICON_CENTER_FOCUS_STRONG, near, true).clicked() {
                aim = Some(CameraRequest::Selected);
            }
        });
    });
    aim
}

/// Inspects another pulley, `step` cables further.
fn go(robot: &Robot, cable: usize, step: isize, outbox: &mut Outbox) {
    let count = robot.cable_count() as isize;
    let next = (cable as isize + step).rem_euclid(count.max(1));
    outbox.send(ViewCommand::Inspect(usize::try_from(next).ok()));
}

/// Page up and Page down go to other pulleys, unless a field or a dialog uses the keys.
fn keys(ui: &Ui, robot: &Robot, cable: usize, outbox: &mut Outbox) {
    let pressed = |key| is_pressed(ui, key);
    if pressed(Key::PageDown) {
        go(robot, cable, 1, outbox);
    }
    if pressed(Key::PageUp) {
        go(robot, cable, -1, outbox);
    }
}

/// Text on the displacement from the drawing and its reliability.
fn judged(ui: &mut Ui, inspection: &PulleyInspection, is_explained: bool) {
    let text = inspection.sentence(is_explained);
    if is_explained || inspection.identified.is_none() {
        ui.wrapped(text);
    } else {
        ui.doubtful(&text);
    }
}

/// F inspects the pulley of the selected cable, in any view.
pub fn key(ui: &Ui, model: &Model, outbox: &mut Outbox) {
    if model.selection.cable.is_some() && is_pressed(ui, Key::F) {
        outbox.send(ViewCommand::Inspect(model.selection.cable));
    }
}

/// Whether a key was pressed without modifiers, and no field or menu uses it.
fn is_pressed(ui: &Ui, key: Key) -> bool {
    let is_typing = ui.ctx().text_edit_focused();
    let is_taken = is_typing || egui::Popup::is_any_open(ui.ctx());
    !is_taken && ui.input(|input| input.modifiers.is_none() && input.key_pressed(key))
}

/// The three projections, the coordinates, and their correlations.
fn details(
    ui: &mut Ui,
    inspection: &PulleyInspection,
    robot: &Robot,
    tolerance_m: Option<f64>,
    arrangement: Arrangement,
) {
    let Some(found) = &inspection.identified else {
        ui.muted("Identify in phase 4 to see where the pulley really is, with its uncertainty.");
        return;
    };
    let directions = robot_3d::camera::directions(robot.gravity());
    let insets = SIDES.map(|side| Inset::new(side, &directions, inspection, found, tolerance_m));
    let scale = Scale::of(&insets);
    let colour = theme::of(ui).cable(inspection.cable);
    ui.horizontal_top(|ui| {
        ui.vertical(|ui| {
            ui.horizontal(|ui| {
                for inset in &insets {
                    inset::show(
                        ui,
                        inset,
                        scale,
                        arrangement.inset,
                        colour,
                        &inspection.name,
                    );
                }
            });
            muted_small(ui, &caption(inspection, scale, tolerance_m));
        });
        if arrangement.is_wide {
            ui.add_space(2.0 * GRID);
            ui.vertical(|ui| numbers(ui, found, robot));
        }
    });
    if !arrangement.is_wide {
        numbers(ui, found, robot);
    }
}

/// Legend of the insets.
fn caption(inspection: &PulleyInspection, scale: Scale, tolerance_m: Option<f64>) -> String {
    let mut text = "Ring: nominal place. Dot: identified place, in its 95 % region. ".to_owned();
    if inspection.prior_sd_m.iter().all(Option::is_some) {
        text += "Grey: 95 % region of the drawing. ";
    }
    if let Some(metres) = tolerance_m {
        let tolerance = significant(1e3 * metres, 3);
        text += &format!("Green circle: tolerance, {tolerance} mm. ");
    }
    format!("{text}Grid {}.", scale.grid_words())
}

/// Coordinates and their correlations.
fn numbers(ui: &mut Ui, found: &IdentifiedPulley, robot: &Robot) {
    ui.scope(|ui| coordinates::show(ui, &found.coordinates));
    if found.correlations.is_empty() {
        return;
    }
    ui.section("Strongest correlations with other pulleys");
    ui.spacing_mut().item_spacing.y = 2.0;
    for correlation in &found.correlations {
        let text = format!("{}, {}", correlation.name(robot), correlation.words());
        ui.wrapped(text);
    }
}

fn muted_small(ui: &mut Ui, text: &str) {
    let colour = theme::of(ui).muted;
    ui.wrapped(RichText::new(text).small().color(colour));
}

/// Button that opens the inspector.
pub fn button(ui: &mut Ui, cable: usize, name: &str, outbox: &mut Outbox) {
    let text = format!("Inspect the pulley of {name}");
    if icon_button(ui, icons::ICON_CENTER_FOCUS_STRONG, &text, true)
        .on_hover_text("Shows it true to scale, with its displacement and uncertainty")
        .clicked()
    {
        outbox.send(ViewCommand::Inspect(Some(cable)));
    }
}
