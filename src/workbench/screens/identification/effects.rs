//! The effects that were added to the model.

use egui::Ui;
use tautline_core::effect::{BoundEffect, EffectSetting, UNKNOWN, find};
use tautline_core::estimation::ParameterId;

use super::Panel;
use crate::model::OpenSession;
use crate::model::edit::{Edit, same_effect};
use crate::theme;
use crate::widgets::muted;
use tautline_workflow::identification::Identification;
use tautline_workflow::wording::list;
use tautline_workflow::wording::units::{significant, unit_of, with_sd};

/// Draws the list.
pub fn show(ui: &mut Ui, panel: &mut Panel<'_>) {
    let described = &panel.open.session().robot.effects;
    let added = &panel.open.session().settings.identification.effects;
    if described.is_empty() && added.is_empty() {
        muted(
            ui,
            "None besides the geometry. The model doctor proposes effects to add.",
        );
        return;
    }
    for setting in described {
        ui.label(title(std::slice::from_ref(setting)));
        muted(ui, "held at the value in the robot description");
    }
    let fit = panel.open.fit().filter(|_| panel.open.fit_is_current());
    for group in added.chunk_by(|one, other| one.effect == other.effect) {
        let title = title(group);
        ui.horizontal(|ui| {
            ui.add(egui::Label::new(egui::RichText::new(&title).font(theme::strong(13.0))).wrap());
            ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
                let button = ui.button("Remove");
                button.widget_info(|| {
                    let name = format!("Remove {title}");
                    egui::WidgetInfo::labeled(egui::Role::Button, true, name)
                });
                if button
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
                for setting in group {
                    muted(ui, &size(panel.open, fit, setting));
                }
            }
            None => {
                muted(ui, "estimated by the identification");
            }
        }
    }
}

/// What the undo menu says of removing.
pub fn removing(name: &str) -> String {
    format!("remove {name} from the model")
}

/// Name of effects of one kind: `Winch scale (cable-1 and cable-3)`.
fn title(settings: &[EffectSetting]) -> String {
    let id = settings
        .first()
        .map_or("", |setting| setting.effect.as_str());
    let name = match find(id) {
        _ if id == UNKNOWN.id() => "Unexplained pattern",
        Some(effect) => effect.title(),
        None => id,
    };
    let targets: Vec<String> = settings.iter().flat_map(|s| s.targets.clone()).collect();
    if targets.is_empty() {
        name.to_owned()
    } else {
        format!("{name} ({})", list(&targets))
    }
}

/// The size that was identified, in words.
fn size(open: &OpenSession, fit: &Identification, setting: &EffectSetting) -> String {
    let robot = &open.session().robot;
    let effects = fit.solution.globals.effects.iter().enumerate();
    let mut same = effects.filter(|(_, bound)| same_effect(&bound.setting(robot), setting));
    let Some((index, bound)) = same.next_back() else {
        return "acts at no pose of these data".to_owned();
    };
    if bound.effect.id() == UNKNOWN.id() {
        return bound.cause(robot);
    }
    if bound.values.is_empty() {
        return "as found; there is nothing to estimate".to_owned();
    }
    let cable = match &setting.targets[..] {
        [] => String::new(),
        targets => format!("{}: ", list(targets)),
    };
    let values: Vec<_> = (0..bound.values.len())
        .map(|k| value(fit, index, bound, k))
        .collect();
    format!("{cable}{}", values.join(", "))
}

fn value(fit: &Identification, index: usize, bound: &BoundEffect, which: usize) -> String {
    let parameter = &bound.effect.parameters()[which];
    let number = bound.values[which];
    let is_it = |id: &ParameterId| match *id {
        ParameterId::Effect { effect, parameter } => {
            fit.held + effect == index && parameter == which
        }
        _ => false,
    };
    let place = fit.solution.parameters.iter().position(|p| is_it(&p.id));
    let unit = unit_of(parameter.name, parameter.unit);
    let size = match place.map(|place| fit.solution.standard_deviation(place)) {
        Some(sd) => with_sd(number, sd.unwrap_or(f64::NAN), unit),
        None => significant(number, 6),
    };
    match bound.values.len() {
        1 => size,
        _ => format!("{} {size}", parameter.name.replace('_', " ")),
    }
}
