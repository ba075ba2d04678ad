//! Input of the laser distance, read by the operator.

use egui::{Align, FontId, RichText, TextEdit, Ui};

use super::PanelState;
use crate::model::command::Outbox;
use crate::model::link::LinkRequest;
use crate::theme::{self, GRID};
use crate::widgets::{UiExt, entered, name_text_field, parse_number, primary};

/// Longest distance that can be typed (mm).
const LONGEST_MM: f64 = 1e6;
/// Deviation from the prediction (m) above which the typed distance may be a typing error.
const FAR_M: f64 = 0.02;

/// Input for a pose.
#[derive(Debug, Default)]
pub struct DistanceInput {
    label: Option<i64>,
    text: String,
    /// Whether the input was sent.
    sent: bool,
}

pub(super) fn forget(panel: &mut PanelState) {
    panel.typed.label = None;
}

/// Asks for the distance at a pose; `expected_m` is the prediction.
pub(super) fn show(
    ui: &mut Ui,
    panel: &mut PanelState,
    outbox: &mut Outbox,
    label: i64,
    expected_m: Option<f64>,
) {
    let memory = &mut panel.typed;
    let is_new = memory.label != Some(label);
    if is_new {
        *memory = DistanceInput {
            label: Some(label),
            ..DistanceInput::default()
        };
    }
    let name = match label {
        0 => "Laser distance at home".to_owned(),
        label => format!("Laser distance at pose {label}"),
    };
    ui.add_space(GRID);
    ui.label(RichText::new(&name).font(theme::strong(15.0)));
    let mut answer = None;
    ui.horizontal(|ui| {
        let edit = TextEdit::singleline(&mut memory.text)
            .font(FontId::proportional(20.0))
            .desired_width(36.0 * GRID);
        let field = ui.add(edit);
        name_text_field(&field, &name, &memory.text);
        if is_new {
            field.request_focus();
            field.scroll_to_me(Some(Align::Center));
        }
        ui.muted("mm");
        let entered = entered(&field);
        let good = distance_m(&memory.text).is_ok() && !memory.sent;
        let pressed = primary(ui, "Enter distance", good).clicked();
        if good && (entered || pressed) {
            answer = distance_m(&memory.text).ok().map(Some);
        } else if entered {
            field.request_focus();
        }
    });
    if ui.button("No return").clicked() {
        answer = Some(None);
    }
    judge(ui, &memory.text, expected_m);
    if let Some(distance_m) = answer {
        memory.sent = true;
        let command = LinkRequest::LaserDistance(label, distance_m);
        outbox.send(command);
    }
}

/// Assesses the input.
fn judge(ui: &mut Ui, text: &str, expected_m: Option<f64>) {
    if text.trim().is_empty() {
        match expected_m {
            Some(expected_m) => ui.muted(&format!("Expected about {:.0} mm.", expected_m * 1e3)),
            None => ui.muted("The robot waits until the distance is entered."),
        };
        return;
    }
    match (distance_m(text), expected_m) {
        (Err(problem), _) => ui.bad(&format!("Laser distance: {problem}.")),
        (Ok(typed_m), Some(expected_m)) if (typed_m - expected_m).abs() > FAR_M => {
            ui.doubtful(&format!(
                "Expected about {:.0} mm. Check the reading, or enter it anyway.",
                expected_m * 1e3
            ));
        }
        (Ok(_), Some(_)) => ui.good("As expected."),
        (Ok(_), None) => {}
    }
}

/// Typed distance in metres.
fn distance_m(text: &str) -> Result<f64, String> {
    let typed_mm = parse_number(text)?;
    if (0.0..=LONGEST_MM).contains(&typed_mm) {
        Ok(typed_mm * 1e-3)
    } else {
        Err(format!(
            "found {typed_mm}, expected 0 mm to {LONGEST_MM:.0} mm"
        ))
    }
}

#[cfg(test)]
mod tests {
    use super::distance_m;

    #[test]
    fn distances_are_typed_in_millimetres() {
        let typed_m = distance_m(" 412,5 ").expect("a distance");
        assert!((typed_m - 0.4125).abs() < 1e-12);
        for text in ["", "-1", "2e6", "4 1 2", "nan"] {
            let told = distance_m(text).expect_err(text);
            assert!(told.contains("expected"), "{told}");
        }
    }
}
