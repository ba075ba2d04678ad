//! What the controller holds beside what was identified, by pulley and effect.

use egui::Ui;
use tautline_core::effect;
use tautline_core::robot::Cable;
use tautline_link::adjusting::Difference;
use tautline_link::parameters::EffectName;

use crate::app::commands::ViewCommand;
use crate::app::theme::{self, GRID};
use crate::app::{Selection, State};
use crate::widgets::{Cell, Column, muted, table};
use crate::wording::units::{fixed, people, signed, unit_of};

/// Columns; the unit has its own, because that of an effect can be any.
const COLUMNS: [Column<'static>; 6] = [
    Column::words("Parameter"),
    Column::number("Controller", ""),
    Column::number("Identified", ""),
    Column::number("Difference", ""),
    Column::number("±", ""),
    Column::words("Unit"),
];

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
    let of_line: Vec<Option<usize>> = shown.iter().map(|line| cable_of(cables, line)).collect();
    let lines = shown.iter().zip(&of_line);
    let rows: Vec<Vec<Cell>> = lines
        .map(|(line, cable)| row(ui, line, cable.and_then(|k| Some((k, cables.get(k)?)))))
        .collect();
    let touched = table(ui, &COLUMNS, &rows, None);
    if let Some(cable) = touched.clicked.and_then(|k| of_line.get(k).copied()?) {
        let selection = Selection {
            cable: Some(cable),
            ..state.selection
        };
        state.outbox.send(ViewCommand::Select(selection));
    }
    ui.add_space(GRID);
    muted(ui, "±: the standard deviation of the identified value.");
    ui.checkbox(
        &mut state.screens.adjustment.all,
        "Show parameters that stay as they are",
    );
    if rows.is_empty() {
        muted(ui, "There is nothing to compare.");
    }
}

/// The cable that a parameter belongs to.
fn cable_of(cables: &[Cable], line: &Difference) -> Option<usize> {
    let is_of = |cable: &Cable| match EffectName::read(&line.name) {
        Some(name) => name.targets == cable.name,
        None => is_of(&line.name, &cable.name),
    };
    cables.iter().position(is_of)
}

fn is_of(name: &str, cable: &str) -> bool {
    name.strip_prefix(cable)
        .is_some_and(|rest| rest.starts_with('.'))
}

fn row(ui: &Ui, line: &Difference, cable: Option<(usize, &Cable)>) -> Vec<Cell> {
    let palette = theme::of(ui);
    let (scale, unit) = unit(line).map_or((1.0, None), |unit| {
        let (scale, unit) = people(unit);
        (scale, Some(unit))
    });
    let decimals = decimals(line.sd.map(|sd| sd * scale), unit);
    let number = |value: f64| Cell::new(fixed(value * scale, decimals));
    let none = || Cell::new("–");
    let name = Cell::new(title(&line.name, cable));
    let difference = line
        .difference
        .map_or_else(none, |value| Cell::new(signed(value * scale, decimals)));
    vec![
        match cable {
            Some((index, _)) => name.with_dot(palette.cable(index)),
            None => name,
        },
        line.controller.map_or_else(none, number),
        number(line.identified),
        difference.coloured(if line.is_writable_change() {
            palette.accent
        } else {
            palette.muted
        }),
        line.sd.map_or_else(Cell::default, number),
        Cell::new(match unit {
            Some("degrees") => "°",
            other => other.unwrap_or_default(),
        })
        .coloured(palette.muted),
    ]
}

/// Unit of a parameter in files; `None` for what is counted, as the pose from which an effect acts.
fn unit(line: &Difference) -> Option<&'static str> {
    let Some(name) = EffectName::read(&line.name) else {
        return Some(line.unit);
    };
    let parameters = effect::find(name.effect).map_or(&[][..], |e| e.parameters());
    match parameters.iter().find(|p| p.name == name.parameter) {
        Some(parameter) if parameter.discrete => None,
        _ => Some(unit_of(name.parameter, line.unit)),
    }
}

/// Decimals such that the standard deviation has two digits.
fn decimals(sd: Option<f64>, unit: Option<&str>) -> usize {
    let usual = match unit {
        None => 0,
        Some("mm") => 2,
        Some(_) => 4,
    };
    let Some(sd) = sd.filter(|sd| *sd > 0.0 && sd.is_finite()) else {
        return usual;
    };
    let digits = 1.0 - sd.log10().floor();
    digits.clamp(0.0, 6.0) as usize
}

/// A parameter, of a cable or not, as one reads it.
fn title(name: &str, cable: Option<(usize, &Cable)>) -> String {
    if let Some(name) = EffectName::read(name) {
        return effect_title(name);
    }
    match cable {
        Some((index, cable)) => {
            let part = name.get(cable.name.len() + 1..).unwrap_or(name);
            format!("{} {}", index + 1, words(part).to_lowercase())
        }
        None => words(name),
    }
}

/// An effect, its cable and, where it has several, the parameter: `Winch scale, cable-3`.
fn effect_title(name: EffectName<'_>) -> String {
    let found = effect::find(name.effect);
    let mut parts = vec![found.map_or(name.effect, |found| found.title()).to_owned()];
    if !name.targets.is_empty() {
        parts.push(name.targets.to_owned());
    }
    if found.is_none_or(|found| found.parameters().len() > 1) {
        parts.push(name.parameter.replace('_', " "));
    }
    parts.join(", ")
}

/// A parameter that is no effect's as one reads it.
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
        _ => name.replace(['_', '.'], " "),
    }
}

#[cfg(test)]
mod tests {
    use tautline_core::robot::presets;

    use super::*;

    #[test]
    fn decimals_follow_the_standard_deviation() {
        assert_eq!(decimals(Some(0.31), Some("mm")), 2);
        assert_eq!(decimals(Some(12.0), Some("mm")), 0);
        assert_eq!(decimals(Some(0.0042), Some("degrees")), 4);
        assert_eq!(decimals(None, Some("mm")), 2);
        assert_eq!(decimals(None, None), 0);
    }

    fn line(name: &str, unit: &'static str) -> Difference {
        Difference {
            name: name.to_owned(),
            unit,
            controller: Some(0.0),
            identified: -0.023_92,
            difference: Some(-0.023_92),
            sd: Some(0.000_52),
        }
    }

    #[test]
    fn parameters_have_words() {
        let cables = presets::find("mini").expect("a preset").robot.cables;
        for (name, cable, text) in [
            ("cable-2.entry_point.x_m", Some(1), "2 entry point x"),
            ("home.ry_rad", None, "Home turn about y"),
            (
                "effect.winch_scale.cable-3.scale",
                Some(2),
                "Winch scale, cable-3",
            ),
            (
                "effect.drum_eccentricity.cable-3.phase",
                Some(2),
                "Drum out of round, cable-3, phase",
            ),
            (
                "effect.winch_scale_common.scale",
                None,
                "Winch scale common to all",
            ),
        ] {
            let of = cable_of(&cables, &line(name, "m"));
            assert_eq!(of, cable, "{name}");
            assert_eq!(title(name, of.map(|k| (k, &cables[k]))), text);
        }
        assert!(!is_of("cable-10.pulley.radius_m", "cable-1"));
    }

    #[test]
    fn values_are_in_the_units_that_people_read() {
        for (name, in_files, read) in [
            ("effect.winch_scale.cable-3.scale", "1", Some("%")),
            ("effect.pulley_friction.mu", "1", Some("")),
            ("effect.cable_slip.cable-3.pose", "1", None),
            ("effect.cable_slip.cable-3.step", "m", Some("mm")),
            ("home.x_m", "m", Some("mm")),
        ] {
            let unit = unit(&line(name, in_files));
            assert_eq!(unit.map(|unit| people(unit).1), read, "{name}");
        }
    }
}
