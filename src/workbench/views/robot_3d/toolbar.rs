//! Toolbar above the picture.

use egui::{Slider, Ui, WidgetInfo};
use egui_material_icons::icons;

use super::camera::{Projection, StandardView};
use super::drawing::{ArrowColour, CableColour, FrameLook, Options};
use super::scene::{Reference, Scene};
use crate::widgets::{UiExt, checkbox, icon_only};

/// Width of the slider with its number (points).
const EXAGGERATION: f32 = 240.0;

/// Requested camera movement.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum CameraRequest {
    /// Show everything.
    All,
    /// Inspect the selected pulley, or show everything.
    Selected,
    /// Frame the selection with its surroundings.
    Frame,
    /// Set the projection.
    Project(Projection),
    /// Turn to a standard view and show everything.
    To(StandardView),
}

/// Width (points) at which everything fits in the toolbar.
const WIDE: f32 = 900.0;
/// Width (points) at which the colours are side by side.
const MEDIUM: f32 = 800.0;
/// Width (points) at which the standard views are side by side.
const NARROW: f32 = 460.0;

/// Draws the toolbar for the present projection; `can_frame` enables framing, `maximise` adds its button.
pub fn show(
    ui: &mut Ui,
    options: &mut Options,
    scene: &Scene,
    projection: Projection,
    can_frame: bool,
    maximise: Option<&mut bool>,
) -> Option<CameraRequest> {
    let reference = scene.reference;
    let mut aim = None;
    let width = ui.available_width();
    let is_wide = width > WIDE;
    ui.horizontal_wrapped(|ui| {
        if icon_only(ui, icons::ICON_FIT_SCREEN, "Fit view (Home)", true).clicked() {
            aim = Some(CameraRequest::All);
        }
        let near = "Frame selection (Shift+F)";
        if icon_only(ui, icons::ICON_CENTER_FOCUS_STRONG, near, can_frame).clicked() {
            aim = Some(CameraRequest::Frame);
        }
        if let Some(maximise) = maximise {
            let name = "Maximise the 3D view";
            *maximise = icon_only(ui, icons::ICON_OPEN_IN_FULL, name, true).clicked();
        }
        if width > NARROW {
            aim = views(ui, projection).or(aim);
        } else {
            ui.menu_button("Views", |ui| aim = views(ui, projection).or(aim));
        }
        if width > MEDIUM {
            ui.separator();
            ui.muted("Colour");
            colours(ui, options);
        } else {
            let name = format!("Colour: {}", options.colour.title());
            let button = ui.menu_button("Colour", |ui| colours(ui, options)).response;
            button.widget_info(|| WidgetInfo::labeled(egui::Role::Button, true, &name));
        }
        if width > MEDIUM {
            ui.separator();
        }
        ui.menu_button("Show", |ui| {
            parts(ui, options, scene);
            if reference != Reference::Nothing && !is_wide {
                exaggeration(ui, options, scene);
            }
        });
        if reference != Reference::Nothing && is_wide {
            exaggeration(ui, options, scene);
        }
    });
    aim
}

/// Standard views and projection; returns a requested camera movement.
fn views(ui: &mut Ui, projection: Projection) -> Option<CameraRequest> {
    let mut aim = None;
    for (view, key) in StandardView::ALL.into_iter().zip(["1", "2", "3", "7"]) {
        let button = egui::Button::new(view.title()).frame_when_inactive(false);
        let scale = match view {
            StandardView::Isometric => "",
            _ => ", everything at one scale",
        };
        let hint = format!("{} view{scale}, key {key}", view.title());
        if ui.add(button).on_hover_text(hint).clicked() {
            aim = Some(CameraRequest::To(view));
        }
    }
    let other = projection.other();
    let button = egui::Button::new(projection.title()).frame_when_inactive(false);
    let response = ui.add(button);
    let name = format!("Projection: {}", projection.title().to_lowercase());
    response.widget_info(|| WidgetInfo::labeled(egui::Role::Button, true, &name));
    let hint = format!("Switch to {} projection", other.title().to_lowercase());
    if response.on_hover_text(hint).clicked() {
        aim = Some(CameraRequest::Project(other));
    }
    aim
}

fn colours(ui: &mut Ui, options: &mut Options) {
    for colour in CableColour::ALL {
        let hint = match colour {
            CableColour::Own => "Every cable in its own colour",
            CableColour::Tension => "Cables coloured by their tension",
            CableColour::Residual => {
                "Cables coloured by the residual of their length: at the selected pose, or over all poses"
            }
        };
        ui.selectable_value(&mut options.colour, colour, colour.title())
            .on_hover_text(hint);
    }
}

fn parts(ui: &mut Ui, options: &mut Options, scene: &Scene) {
    let reference = scene.reference;
    checkbox(ui, &mut options.labels, "Cable numbers");
    checkbox(ui, &mut options.poses, "Poses");
    checkbox(ui, &mut options.callouts, "Pinned coordinates")
        .on_hover_text("Click a pulley to pin its coordinates, click again to unpin them");
    let has_pins = !options.pinned.is_empty();
    if ui
        .add_enabled(has_pins, egui::Button::new("Clear pins"))
        .on_disabled_hover_text("Click a pulley to pin its coordinates")
        .clicked()
    {
        options.pinned.clear();
    }
    checkbox(ui, &mut options.errors, "Position errors")
        .on_hover_text("Errors of position before and after the adjustment, in phase 5");
    let pulleys = match reference {
        Reference::Other(names) => &format!("Pulleys of {}", names.second),
        Reference::Drawing | Reference::Nothing => "Nominal pulleys",
    };
    let of_identification = [
        (&mut options.nominal, pulleys),
        (&mut options.arrows, "Displacements"),
        (&mut options.ellipsoids, "95 % confidence ellipsoids"),
    ];
    for (shown, name) in of_identification {
        ui.add_enabled_ui(reference != Reference::Nothing, |ui| {
            checkbox(ui, shown, name)
        })
        .inner
        .on_disabled_hover_text("Available after identification");
    }
    ui.separator();
    if reference != Reference::Nothing {
        ui.horizontal(|ui| {
            ui.muted("Displacements by");
            for by in ArrowColour::ALL {
                let known = by != ArrowColour::Tolerance || scene.tolerance_m.is_some();
                let is_chosen = options.arrow_colour_of(scene) == by;
                let button = egui::Button::selectable(is_chosen, by.title());
                let button = ui.add_enabled(known, button);
                if button.clicked() {
                    options.arrow_colour = by;
                }
                button.on_disabled_hover_text("Enter a tolerance for the report first");
            }
        });
    }
    ui.horizontal(|ui| {
        ui.muted("Frame");
        for look in FrameLook::ALL {
            let button = ui.selectable_value(&mut options.frame, look, look.title());
            button.widget_info(|| {
                let name = format!("Frame: {}", look.title());
                WidgetInfo::selected(egui::Role::Button, true, options.frame == look, name)
            });
        }
    });
}

fn exaggeration(ui: &mut Ui, options: &mut Options, scene: &Scene) {
    // A slider does not wrap to the next row by itself.
    if ui.available_size_before_wrap().x < EXAGGERATION {
        ui.end_row();
    }
    let mut value = options.exaggeration_of(scene);
    let slider = Slider::new(&mut value, 1.0..=200.0)
        .logarithmic(true)
        .step_by(1.0)
        .show_value(false);
    ui.spacing_mut().slider_width = 88.0;
    let response = ui.add(slider);
    response.widget_info(|| WidgetInfo::slider(true, value, "Magnification"));
    if response.changed() {
        options.exaggeration = Some(value);
    }
    response
        .on_hover_text("Magnification of displacements: of wheels, arrows and ellipsoids alike");
    ui.add(egui::Label::new(format!("{value:.0}×")).extend());
    let is_automatic = options.exaggeration.is_none();
    if ui
        .selectable_label(is_automatic, "Automatic")
        .on_hover_text("Choose a magnification at which displacements are clearly visible")
        .clicked()
    {
        options.exaggeration = if is_automatic { Some(value) } else { None };
    }
}
