//! Number fields.

use egui::{Align2, Id, Key, Margin, Response, Stroke, TextEdit, TextStyle, Ui, Vec2};

use super::{name_text_field, text::UiExt};
use crate::theme::{self, GRID};
use tautline_workflow::wording::units::fixed;

/// Input of a number field.
#[derive(Debug, Clone, PartialEq)]
pub enum Entered {
    Value(f64),
    /// Empty, in an optional field.
    Nothing,
    /// Invalid input, with an error message.
    Wrong(String),
}

/// A field for a number.
#[derive(Debug, Clone, Copy)]
pub struct Number<'a> {
    pub name: &'a str,
    /// `None` if the field is empty.
    pub value: Option<f64>,
    /// Number of decimals.
    pub decimals: usize,
    /// Unit after the field; may be empty.
    pub unit: &'a str,
    /// Whether the field may be empty.
    pub optional: bool,
    /// Smallest width (points).
    pub width: f32,
}

impl<'a> Number<'a> {
    /// Required field, with its smallest width (points).
    #[must_use]
    pub fn of(
        name: &'a str,
        value: impl Into<Option<f64>>,
        decimals: usize,
        unit: &'a str,
        width: f32,
    ) -> Self {
        Self {
            name,
            value: value.into(),
            decimals,
            unit,
            optional: false,
            width,
        }
    }

    /// The same field, which may be empty.
    #[must_use]
    pub fn optional(self, optional: bool) -> Self {
        Self { optional, ..self }
    }

    fn id(&self, ui: &Ui) -> Id {
        ui.make_persistent_id(("number", self.name))
    }

    /// Id of the text field, which has the keyboard focus.
    pub(crate) fn text_id(&self, ui: &Ui) -> Id {
        self.id(ui).with("text")
    }
}

/// Draws a number field; returns its input when it is left or Enter is pressed, if the text was changed.
pub fn number(ui: &mut Ui, field: &Number<'_>) -> Option<Entered> {
    number_checked(ui, field, &|_| Ok(()))
}

/// Number field with a check, which is applied while typing.
pub fn number_checked(
    ui: &mut Ui,
    field: &Number<'_>,
    check: &dyn Fn(f64) -> Result<(), String>,
) -> Option<Entered> {
    let id = field.id(ui);
    let shown = || field.value.map(|value| fixed(value, field.decimals));
    let typed: Option<String> = ui.data(|data| data.get_temp(id));
    let was_typed = typed.is_some();
    let mut text = typed.unwrap_or_else(|| shown().unwrap_or_default());
    let wrong = match was_typed.then(|| entered(&text, field, check)) {
        Some(Entered::Wrong(message)) => Some(message),
        _ => None,
    };
    let mut response = edit(ui, field, &mut text, wrong.is_some());
    if let Some(message) = wrong {
        response = response.on_hover_text(message);
    }
    if !field.unit.is_empty() {
        ui.muted(field.unit);
    }
    if response.changed() {
        ui.data_mut(|data| data.insert_temp(id, text.clone()));
    }
    let escaped = ui.input(|input| input.key_pressed(Key::Escape));
    if !response.lost_focus() || !(was_typed || response.changed()) {
        return None;
    }
    let answer = entered(&text, field, check);
    if escaped || !matches!(answer, Entered::Wrong(_)) {
        ui.data_mut(|data| data.remove::<String>(id));
    }
    (!escaped).then_some(answer)
}

/// Width of a field for a text (points), with room for the cursor.
pub(crate) fn width_of(ui: &Ui, text: &str) -> f32 {
    let font = TextStyle::Body.resolve(ui.style());
    let colour = theme::of(ui).text;
    let galley = ui.painter().layout_no_wrap(text.to_owned(), font, colour);
    galley.size().x + 4.0 * GRID
}

fn edit(ui: &mut Ui, field: &Number<'_>, text: &mut String, wrong: bool) -> Response {
    let palette = theme::of(ui);
    // A number is never truncated, even while a grid column is still too narrow.
    let width = field.width.max(width_of(ui, text));
    let mut edit = TextEdit::singleline(text)
        .id(field.text_id(ui))
        .desired_width(width)
        .min_size(Vec2::new(width, 0.0))
        .align(Align2::RIGHT_CENTER)
        .margin(Margin::symmetric(GRID as i8, 2))
        .clip_text(true);
    if wrong {
        edit = edit.text_color(palette.bad);
    }
    let response = ui.add(edit);
    name_text_field(&response, field.name, text);
    if wrong {
        let stroke = Stroke::new(1.0, palette.bad);
        ui.painter()
            .rect_stroke(response.rect, 4.0, stroke, egui::StrokeKind::Inside);
    }
    response
}

fn entered(text: &str, field: &Number<'_>, check: &dyn Fn(f64) -> Result<(), String>) -> Entered {
    if text.trim().is_empty() && field.optional {
        return Entered::Nothing;
    }
    match parse(text).and_then(|value| check(value).map(|()| value)) {
        Ok(value) => Entered::Value(value),
        Err(message) => Entered::Wrong(format!("{}: {message}.", field.name)),
    }
}

/// Parses a number with a decimal point or comma.
///
/// # Errors
/// If the text is not a number; the message states what was found and expected.
pub fn parse(text: &str) -> Result<f64, String> {
    let text = text.trim();
    if text.is_empty() {
        return Err("found nothing, expected a number such as 12.5".to_owned());
    }
    let separators = text.matches([',', '.']).count();
    let number = text.replace('\u{2212}', "-").replacen(',', ".", 1);
    match number.parse::<f64>() {
        Ok(value) if value.is_finite() && number.bytes().any(|b| b.is_ascii_digit()) => Ok(value),
        _ if separators > 1 => Err(format!(
            "found \"{text}\", expected a number without thousands separators"
        )),
        _ => Err(format!("found \"{text}\", expected a number such as 12.5")),
    }
}

#[cfg(test)]
mod tests {
    use super::parse;

    #[test]
    fn point_and_comma_are_both_understood() {
        for (text, value) in [
            ("1.5", 1.5),
            (" 1,5 ", 1.5),
            ("-3", -3.0),
            ("\u{2212}0,25", -0.25),
            ("2e-3", 2e-3),
        ] {
            assert_eq!(parse(text), Ok(value), "{text}");
        }
    }

    #[test]
    fn what_is_no_number_is_told() {
        for text in ["", "abc", "1.234,5", "1,2,3", "inf", "nan", "1 2"] {
            let message = parse(text).expect_err(text);
            assert!(message.contains("found"), "{message}");
            assert!(message.contains("expected a number"), "{message}");
        }
    }
}
