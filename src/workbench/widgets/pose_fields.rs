//! Fields for typing a measured pose.

use egui::{TextEdit, Ui};
use tautline_core::geometry::Pose;
use tautline_session::CheckPose;

use super::{UiExt, name_text_field, parse_number};
use crate::theme::GRID;

const FIELDS: [&str; 6] = ["x", "y", "z", "Roll", "Pitch", "Yaw"];

/// Typed position (mm) and angles (degrees).
#[derive(Debug, Default)]
pub struct PoseFields {
    texts: [String; 6],
}

#[derive(Debug, Clone, Copy, Default)]
pub struct PoseFieldsResponse {
    pub left: bool,
}

impl PoseFields {
    /// Draws two rows of fields, whose accessible names begin with `name`; `focuses` moves the cursor to the first.
    pub fn show(&mut self, ui: &mut Ui, name: &str, focuses: bool) -> PoseFieldsResponse {
        let (position, angles) = FIELDS.split_at(3);
        let mut left = self.line(ui, name, position, 0, "mm", focuses);
        left |= self.line(ui, name, angles, 3, "degrees", false);
        PoseFieldsResponse { left }
    }

    fn line(
        &mut self,
        ui: &mut Ui,
        of: &str,
        names: &[&str],
        first: usize,
        unit: &str,
        focuses: bool,
    ) -> bool {
        let mut left = false;
        ui.horizontal_wrapped(|ui| {
            for (name, text) in names.iter().zip(&mut self.texts[first..]) {
                ui.muted(name);
                let field = ui.add(TextEdit::singleline(text).desired_width(15.0 * GRID));
                name_text_field(&field, &format!("{of} {}", name.to_lowercase()), text);
                if focuses && *name == "x" {
                    field.request_focus();
                    field.scroll_to_me(Some(egui::Align::Center));
                }
                left |= field.lost_focus();
            }
            ui.muted(unit);
        });
        left
    }

    pub fn is_empty(&self) -> bool {
        self.texts.iter().all(|text| text.trim().is_empty())
    }

    /// Typed pose: x, y, z, and optionally roll, pitch, yaw with `R = Rx(roll) Ry(pitch) Rz(yaw)`.
    ///
    /// # Errors
    /// The name of the field and its error.
    pub fn pose(&self) -> Result<CheckPose, String> {
        let mut numbers = [0.0; 6];
        let oriented = self.texts[3..].iter().any(|text| !text.trim().is_empty());
        let wanted = if oriented { 6 } else { 3 };
        for (k, text) in self.texts.iter().enumerate().take(wanted) {
            let number = parse_number(text);
            numbers[k] = number.map_err(|problem| format!("{}: {problem}", FIELDS[k]))?;
        }
        let [x, y, z, angles @ ..] = numbers;
        let position_m = [x, y, z].map(|mm: f64| mm * 1e-3);
        let pose = Pose::from_angles(position_m, angles.map(f64::to_radians));
        Ok(CheckPose {
            position_m,
            orientation_wxyz: oriented.then(|| pose.orientation_wxyz()),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn typed(texts: [&str; 6]) -> Result<CheckPose, String> {
        PoseFields {
            texts: texts.map(str::to_owned),
        }
        .pose()
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
