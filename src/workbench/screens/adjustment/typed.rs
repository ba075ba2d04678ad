//! Input of the platform's pose at a target, for an instrument that the operator reads.

use egui::{Align, Key, RichText, TextEdit, Ui, WidgetInfo};
use nalgebra::{UnitQuaternion, Vector3};
use tautline_session::CheckPose;

use super::PanelState;
use crate::model::Model;
use crate::model::command::Outbox;
use crate::model::command::RobotCommand;
use crate::theme::{self, GRID};
use crate::widgets::{Verdict, muted, parse_number, primary, verdict};

/// Names of the fields.
const FIELDS: [&str; 6] = ["x", "y", "z", "Roll", "Pitch", "Yaw"];
/// A position this far from the target may be a slip of the keys (m).
const FAR_M: f64 = 0.1;

/// The input of a target.
#[derive(Debug, Default)]
pub struct Typed {
    number: Option<usize>,
    texts: [String; 6],
    sent: bool,
}

/// Closes the input.
pub(super) fn forget(panel: &mut PanelState) {
    panel.typed.number = None;
}

/// Asks where the platform is at a target.
pub(super) fn show(
    ui: &mut Ui,
    model: &Model,
    panel: &mut PanelState,
    outbox: &mut Outbox,
    (number, of): (usize, usize),
) {
    let target = number
        .checked_sub(1)
        .and_then(|k| model.link.targets.get(k));
    let Some(target) = target else { return };
    let (name, commanded) = (target.target.clone(), target.pose);
    let memory = &mut panel.typed;
    let is_new = memory.number != Some(number);
    if is_new {
        *memory = Typed {
            number: Some(number),
            ..Typed::default()
        };
    }
    let title = format!("Where is the platform at {name}?");
    ui.label(RichText::new(title).font(theme::strong(15.0)));
    let [x, y, z] = [0, 1, 2].map(|k| commanded.position[k] * 1e3);
    muted(
        ui,
        &format!(
            "Target {number} of {of}, commanded to {x:.1}, {y:.1}, {z:.1} mm. Enter angles only if they are measured."
        ),
    );
    let (position, angles) = FIELDS.split_at(3);
    let mut last = fields(ui, memory, (position, 0), "mm", is_new);
    last |= fields(ui, memory, (angles, 3), "degrees", false);
    let pose = pose_of(&memory.texts);
    let entered = last && ui.input(|input| input.key_pressed(Key::Enter));
    let good = pose.is_ok() && !memory.sent;
    let pressed = primary(ui, "Enter pose", good).clicked();
    let has_text = memory.texts.iter().any(|text| !text.trim().is_empty());
    match pose {
        Ok(pose) => {
            let off_m = Vector3::from(pose.position_m) - commanded.position;
            if off_m.norm() > FAR_M {
                let off_mm = off_m.norm() * 1e3;
                let text = format!(
                    "This is {off_mm:.0} mm from the target. Check the reading, or enter it anyway."
                );
                verdict(ui, Verdict::Doubtful, &text);
            }
            if good && (entered || pressed) {
                memory.sent = true;
                outbox.send(RobotCommand::TypedPose(number, pose));
            }
        }
        Err(problem) => {
            let waits = "The robot waits until the pose is entered.".to_owned();
            let text = if has_text {
                format!("{problem}.")
            } else {
                waits
            };
            muted(ui, &text);
        }
    }
}

/// A line of fields; whether one of them was left.
fn fields(
    ui: &mut Ui,
    memory: &mut Typed,
    (names, first): (&[&str], usize),
    unit: &str,
    focuses: bool,
) -> bool {
    let mut left = false;
    ui.horizontal_wrapped(|ui| {
        for (name, text) in names.iter().zip(&mut memory.texts[first..]) {
            muted(ui, name);
            let field = ui.add(TextEdit::singleline(text).desired_width(15.0 * GRID));
            let value = text.clone();
            let label = format!("Measured {}", name.to_lowercase());
            field.widget_info(|| {
                let mut info = WidgetInfo::text_edit(true, value.clone(), value.clone(), "");
                info.label = Some(label.clone());
                info
            });
            if focuses && *name == "x" {
                field.request_focus();
                field.scroll_to_me(Some(Align::Center));
            }
            left |= field.lost_focus();
        }
        muted(ui, unit);
    });
    left
}

/// The pose of what is typed: x, y, z (mm), and roll, pitch, yaw (degrees) with `R = Rx(roll) Ry(pitch) Rz(yaw)`, or none
/// of the three.
fn pose_of(texts: &[String; 6]) -> Result<CheckPose, String> {
    let mut numbers = [0.0; 6];
    let oriented = texts[3..].iter().any(|text| !text.trim().is_empty());
    let wanted = if oriented { 6 } else { 3 };
    for (k, text) in texts.iter().enumerate().take(wanted) {
        numbers[k] = parse_number(text).map_err(|problem| format!("{}: {problem}", FIELDS[k]))?;
    }
    let [x, y, z, roll, pitch, yaw] = numbers;
    let about = |axis, degrees: f64| UnitQuaternion::from_axis_angle(&axis, degrees.to_radians());
    let rotation = about(Vector3::x_axis(), roll)
        * about(Vector3::y_axis(), pitch)
        * about(Vector3::z_axis(), yaw);
    Ok(CheckPose {
        position_m: [x, y, z].map(|mm| mm * 1e-3),
        orientation_wxyz: oriented.then(|| [rotation.w, rotation.i, rotation.j, rotation.k]),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn typed(texts: [&str; 6]) -> Result<CheckPose, String> {
        pose_of(&texts.map(str::to_owned))
    }

    #[test]
    fn a_pose_is_typed_with_or_without_its_orientation() {
        let position = typed(["100", "-20,5", "0", "", "", ""]).expect("a pose");
        assert!((position.position_m[1] + 0.0205).abs() < 1e-12);
        assert_eq!(position.orientation_wxyz, None);
        let turned = typed(["0", "0", "0", "0", "0", "90"]).expect("a pose");
        let [w, x, y, z] = turned.orientation_wxyz.expect("an orientation");
        let half = std::f64::consts::FRAC_1_SQRT_2;
        assert!((w - half).abs() < 1e-12 && (z - half).abs() < 1e-12);
        assert_eq!((x, y), (0.0, 0.0));
        let told = typed(["1", "2", "", "", "", ""]).expect_err("no z");
        assert!(told.starts_with("z: found nothing"), "{told}");
        let told = typed(["1", "2", "3", "1", "", ""]).expect_err("half an orientation");
        assert!(told.starts_with("Pitch:"), "{told}");
    }
}
