//! Effects added to the model.

use egui::Ui;

use super::Panel;
use crate::model::edit::Edit;
use crate::theme;
use crate::widgets::{UiExt, named};
use tautline_workflow::identification::{effect_sizes, effects_title};

pub fn show(ui: &mut Ui, panel: &mut Panel<'_>) {
    let robot = &panel.open.session().robot;
    let described = &robot.effects;
    let added = &panel.open.session().settings.identification.effects;
    if described.is_empty() && added.is_empty() {
        ui.muted("None besides the geometry. The model doctor proposes effects to add.");
        return;
    }
    for setting in described {
        ui.label(effects_title(robot, std::slice::from_ref(setting)));
        ui.muted("held at the value in the robot description");
    }
    let fit = panel.open.current_fit();
    for group in added.chunk_by(|one, other| one.effect == other.effect) {
        let title = effects_title(robot, group);
        ui.horizontal(|ui| {
            ui.wrapped(egui::RichText::new(&title).font(theme::strong(13.0)));
            ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
                if named(ui.button("Remove"), &format!("Remove {title}"))
                    .on_hover_text("Removes it from the model and identifies again")
                    .clicked()
                {
                    panel
                        .outbox
                        .send(Edit::RemoveEffects(group.to_vec(), removing(&title)));
                }
            });
        });
        match fit {
            Some(fit) => {
                for size in effect_sizes(fit, group) {
                    ui.muted(&size);
                }
            }
            None => {
                ui.muted("estimated by the identification");
            }
        }
    }
}

/// Name of the removal in the undo menu.
pub fn removing(name: &str) -> String {
    format!("remove {name} from the model")
}
