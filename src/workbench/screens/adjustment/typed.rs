//! Input of the platform's pose at a target, read by the operator from an instrument.

use egui::{Key, RichText, Ui};
use nalgebra::Vector3;

use super::PanelState;
use crate::model::Model;
use crate::model::command::Outbox;
use crate::model::link::LinkRequest;
use crate::theme;
use crate::widgets::{PoseFields, UiExt, primary};
use tautline_workflow::wording::units::mm;

/// Distance from the target (m) above which the typed position may be a typing error.
const FAR_M: f64 = 0.1;

#[derive(Debug, Default)]
pub struct TargetPoseInput {
    number: Option<usize>,
    pose: PoseFields,
    sent: bool,
}

pub(super) fn forget(panel: &mut PanelState) {
    panel.typed.number = None;
}

/// Asks for the pose of the platform at a target.
pub(super) fn show(
    ui: &mut Ui,
    model: &Model,
    panel: &mut PanelState,
    outbox: &mut Outbox,
    number: usize,
    of: usize,
) {
    let target = number
        .checked_sub(1)
        .and_then(|k| model.link.targets.get(k));
    let Some(target) = target else { return };
    let (name, commanded) = (target.target.clone(), target.pose);
    let memory = &mut panel.typed;
    let is_new = memory.number != Some(number);
    if is_new {
        *memory = TargetPoseInput {
            number: Some(number),
            ..TargetPoseInput::default()
        };
    }
    let title = format!("Where is the platform at {name}?");
    ui.label(RichText::new(title).font(theme::strong(15.0)));
    let [x, y, z] = [0, 1, 2].map(|k| mm(commanded.position[k], 1));
    ui.muted(&format!(
            "Target {number} of {of}, commanded to {x}, {y}, {z} mm. Enter angles only if they are measured."
        ));
    let fields = memory.pose.show(ui, "Measured", is_new);
    let pose = memory.pose.pose();
    let entered = fields.left && ui.input(|input| input.key_pressed(Key::Enter));
    let good = pose.is_ok() && !memory.sent;
    let pressed = primary(ui, "Enter pose", good).clicked();
    let has_text = !memory.pose.is_empty();
    match pose {
        Ok(pose) => {
            let off_m = Vector3::from(pose.position_m) - commanded.position;
            if off_m.norm() > FAR_M {
                let off_mm = off_m.norm() * 1e3;
                ui.doubtful(&format!(
                    "This is {off_mm:.0} mm from the target. Check the reading, or enter it anyway."
                ));
            }
            if good && (entered || pressed) {
                memory.sent = true;
                outbox.send(LinkRequest::TypedPose(number, pose));
            }
        }
        Err(problem) => {
            let waits = "The robot waits until the pose is entered.".to_owned();
            let text = if has_text {
                format!("{problem}.")
            } else {
                waits
            };
            ui.muted(&text);
        }
    }
}
