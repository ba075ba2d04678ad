//! What the controller holds beside what was identified, by pulley.

use egui::{Align, Grid, Layout, RichText, Ui};
use tautline_link::adjusting::Difference;

use crate::app::State;
use crate::app::theme::{self, GRID};
use crate::screens::measuring::readings::cable_mark;
use crate::widgets::muted;

/// Draws the table; parameters that stay as they are only where they are asked for.
pub(super) fn show(ui: &mut Ui, state: &mut State, differences: &[Difference]) {
    let Some(document) = &state.document else {
        return;
    };
    let all = state.screens.adjustment.all;
    let shown: Vec<&Difference> = differences
        .iter()
        .filter(|line| all || line.sd.is_some() || line.is_writable_change())
        .collect();
    let cables = &document.session().robot.cables;
    Grid::new("differences")
        .num_columns(5)
        .striped(false)
        .show(ui, |ui| {
            for head in [
                "Parameter",
                "Controller",
                "Identified",
                "Difference",
                "± (1 sd)",
            ] {
                ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
                    let label = muted(ui, head);
                    if head.starts_with('±') {
                        label.on_hover_text("Standard deviation of the identified value");
                    }
                });
            }
            ui.end_row();
            for (index, cable) in cables.iter().enumerate() {
                let of_cable = |line: &&&Difference| is_of(&line.name, &cable.name);
                let mut lines = shown.iter().filter(of_cable).peekable();
                if lines.peek().is_none() {
                    continue;
                }
                cable_mark(ui, index, &cable.name);
                muted(ui, "mm");
                ui.end_row();
                for line in lines {
                    let name = line.name.get(cable.name.len() + 1..).unwrap_or(&line.name);
                    row(ui, name, line);
                }
            }
            let of_none =
                |line: &&&Difference| !cables.iter().any(|cable| is_of(&line.name, &cable.name));
            let mut lines = shown.iter().filter(of_none).peekable();
            if lines.peek().is_some() {
                ui.label(RichText::new("Robot").font(theme::strong(13.0)));
                ui.end_row();
            }
            for line in lines {
                row(ui, &line.name, line);
            }
        });
    ui.add_space(GRID);
    ui.checkbox(&mut state.screens.adjustment.all, "Show all parameters");
}

fn is_of(name: &str, cable: &str) -> bool {
    name.strip_prefix(cable)
        .is_some_and(|rest| rest.starts_with('.'))
}

fn row(ui: &mut Ui, name: &str, line: &Difference) {
    let (scale, unit) = match line.unit {
        "m" => (1e3, ""),
        "rad" => (1.0_f64.to_degrees(), "°"),
        _ => (1.0, ""),
    };
    let decimals = decimals(line.sd.map(|sd| sd * scale), line.unit);
    ui.label(words(name)).on_hover_text(&line.name);
    let number = |value: Option<f64>, sign: bool| {
        value.map_or_else(
            || "–".to_owned(),
            |value| {
                let value = value * scale;
                if sign {
                    format!("{value:+.decimals$}{unit}")
                } else {
                    format!("{value:.decimals$}{unit}")
                }
            },
        )
    };
    let cells = [
        number(line.controller, false),
        number(Some(line.identified), false),
        number(line.difference, true),
        line.sd
            .map_or_else(String::new, |sd| number(Some(sd), false)),
    ];
    for (k, text) in cells.into_iter().enumerate() {
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
            let emphasised = k == 2 && line.is_writable_change();
            let text = RichText::new(text);
            ui.label(if emphasised {
                text.font(theme::strong(13.0))
            } else {
                text
            });
        });
    }
    ui.end_row();
}

/// Decimals such that the standard deviation has two digits.
fn decimals(sd: Option<f64>, unit: &str) -> usize {
    let usual = if unit == "m" { 2 } else { 4 };
    let Some(sd) = sd.filter(|sd| *sd > 0.0 && sd.is_finite()) else {
        return usual;
    };
    let digits = 1.0 - sd.log10().floor();
    digits.clamp(0.0, 6.0) as usize
}

/// A parameter as one reads it.
fn words(name: &str) -> String {
    let (part, axis) = name.rsplit_once('.').unwrap_or(("", name));
    let axis = axis.trim_end_matches("_m").trim_end_matches("_rad");
    match part {
        "entry_point" => format!("Entry point {axis}"),
        "platform_anchor" => format!("Platform anchor {axis}"),
        "pulley" => "Pulley radius".to_owned(),
        "winch" => "Drum diameter".to_owned(),
        "home" => match axis.strip_prefix('r') {
            Some(axis) => format!("Home turn about {axis}"),
            None => format!("Home {axis}"),
        },
        "laser.target_plane" => "Laser target".to_owned(),
        _ => name.trim_start_matches("effect.").replace(['_', '.'], " "),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn decimals_follow_the_standard_deviation() {
        assert_eq!(decimals(Some(0.31), "m"), 2);
        assert_eq!(decimals(Some(12.0), "m"), 0);
        assert_eq!(decimals(Some(0.0042), "rad"), 4);
        assert_eq!(decimals(None, "m"), 2);
    }

    #[test]
    fn parameters_have_words() {
        assert_eq!(words("entry_point.x_m"), "Entry point x");
        assert_eq!(words("home.ry_rad"), "Home turn about y");
        assert_eq!(
            words("effect.winch_scale.cable-3.scale"),
            "winch scale cable-3 scale"
        );
        assert!(is_of("cable-1.pulley.radius_m", "cable-1"));
        assert!(!is_of("cable-10.pulley.radius_m", "cable-1"));
    }
}
