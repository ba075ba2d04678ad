//! Table of symbols: purpose, name at the controller, scale and unit.

use egui::{Grid, RichText, TextEdit, Ui};
use egui_material_icons::icons;
use tautline_core::robot::Robot;
use tautline_link::symbols::{SymbolCheck, SymbolFound};
use tautline_session::{SymbolMapping, is_per_cable, name_of_cable};

use super::entry::{SymbolRole, no_command, read, title_of, unit_of, write};
use super::problems::{FieldId, Problems};
use crate::theme::{self, GRID};
use crate::widgets::{UiExt, Verdict, name_text_field, parse_number};
use tautline_workflow::wording::{count, sentence};

/// Width (points) at which the columns fit side by side.
const WIDE: f32 = 560.0;

#[derive(Debug, Clone)]
struct SymbolRow {
    need: SymbolRole,
    title: String,
    unit: String,
    /// Name, or comma-separated names; empty if there is none.
    symbol: String,
    scale: String,
}

/// All rows, with the answers of the controller.
#[derive(Debug, Clone)]
pub struct SymbolRows {
    rows: Vec<SymbolRow>,
    /// Parts of the mapping without a row: offsets, elements, format of orientations.
    base: SymbolMapping,
    cables: Vec<String>,
    /// Answer of the controller, or the reason why there is none.
    pub checked: Option<Result<Vec<SymbolCheck>, String>>,
}

impl SymbolRows {
    #[must_use]
    pub fn of(mapping: &SymbolMapping, robot: &Robot) -> Self {
        let mut rows: Vec<SymbolRow> = SymbolRole::FIXED
            .into_iter()
            .map(|(need, title, unit)| {
                let (symbol, scale) = read(mapping, need);
                SymbolRow {
                    need,
                    title: title.to_owned(),
                    unit: unit.to_owned(),
                    symbol,
                    scale: scale.map_or_else(String::new, |scale| scale.to_string()),
                }
            })
            .collect();
        let parameters = mapping.parameters.iter().enumerate();
        rows.extend(parameters.map(|(k, parameter)| SymbolRow {
            need: SymbolRole::Parameter(k),
            title: title_of(&parameter.name),
            unit: unit_of(&parameter.name).to_owned(),
            symbol: parameter.symbol.clone(),
            scale: parameter.scale.to_string(),
        }));
        let cables = robot.cables.iter();
        Self {
            rows,
            base: mapping.clone(),
            cables: cables.map(|cable| cable.name.clone()).collect(),
            checked: None,
        }
    }

    /// Mapping made from the rows.
    pub fn mapping(&self, robot: &Robot, problems: &mut Problems) -> Option<SymbolMapping> {
        let mut mapping = self.base.clone();
        let commands = self.rows.iter().filter(|row| row.need.is_of_command());
        if commands
            .clone()
            .all(|row: &SymbolRow| row.symbol.trim().is_empty())
        {
            mapping.command = None;
        } else {
            mapping.command.get_or_insert_with(no_command);
        }
        let mut good = true;
        for (k, row) in self.rows.iter().enumerate() {
            let scale = match row.need.has_scale() && !row.symbol.trim().is_empty() {
                true => problems.take(FieldId::Symbol(k), parse_number(&row.scale)),
                false => Some(1.0),
            };
            let written = scale.map(|scale| write(&mut mapping, row.need, &row.symbol, scale));
            if let Some(Err(text)) = written {
                problems.add(FieldId::Symbol(k), text);
                good = false;
            }
            good &= scale.is_some();
        }
        // Parameters without a name are not available at the controller.
        mapping.parameters.retain(|p| !p.symbol.is_empty());
        if !good {
            return None;
        }
        match mapping.check(robot) {
            Ok(()) => Some(mapping),
            Err(error) => {
                let place = error
                    .pointer
                    .trim_start_matches('/')
                    .replace(['/', '_'], " ");
                problems.add(FieldId::Symbols, format!("{place}: {}", error.message));
                None
            }
        }
    }

    /// Names of the symbols of a row, one per cable for a pattern.
    fn names(&self, row: &SymbolRow) -> Vec<String> {
        let names = row.symbol.split(',').map(str::trim);
        let mut all = Vec::new();
        for name in names.filter(|name| !name.is_empty()) {
            if is_per_cable(name) {
                let cables = self.cables.iter().enumerate();
                all.extend(cables.map(|(k, cable)| name_of_cable(name, cable, k)));
            } else {
                all.push(name.to_owned());
            }
        }
        all
    }

    /// Answer of the controller for a row: that of its worst symbol.
    fn found(&self, row: &SymbolRow) -> Option<&SymbolCheck> {
        let Some(Ok(checks)) = &self.checked else {
            return None;
        };
        let names = self.names(row);
        let mut found = checks.iter().filter(|check| names.contains(&check.name));
        let first = found.clone().next();
        let wrong = found.find(|check| !matches!(check.found, SymbolFound::Good { .. }));
        wrong.or(first)
    }

    /// Answer of the controller in one sentence, if it was asked.
    #[must_use]
    pub fn summary(&self) -> Option<(Verdict, String)> {
        let checks = match self.checked.as_ref()? {
            Ok(checks) => checks,
            Err(error) => return Some((Verdict::Bad, format!("{}.", sentence(error)))),
        };
        let number = |is: fn(&SymbolFound) -> bool| checks.iter().filter(|c| is(&c.found)).count();
        let good = number(|found| matches!(found, SymbolFound::Good { .. }));
        let missing = number(|found| matches!(found, SymbolFound::Missing(_)));
        if good == checks.len() {
            let text = format!("All {} are there and can be used.", count(good, "symbol"));
            return Some((Verdict::Good, text));
        }
        let text = format!(
            "Of {}, {good} can be used. Missing: {missing}. Of a wrong type: {}.",
            count(checks.len(), "symbol"),
            checks.len() - good - missing
        );
        Some((Verdict::Bad, text))
    }

    /// Draws the table, for editing if `own`.
    pub fn show(&mut self, ui: &mut Ui, own: bool, problems: &Problems) {
        let found: Vec<Option<SymbolCheck>> = self
            .rows
            .iter()
            .map(|row| self.found(row).cloned())
            .collect();
        let rows = self.rows.iter_mut().zip(&found).enumerate();
        if ui.available_width() < WIDE {
            for (k, (row, found)) in rows {
                ui.label(&row.title);
                ui.horizontal_wrapped(|ui| row.fields(ui, own, true));
                let problem = problems.of(FieldId::Symbol(k));
                if found.is_some() || problem.is_some() {
                    row.judged(ui, found.as_ref(), problem);
                }
                ui.add_space(GRID);
            }
            return;
        }
        Grid::new("symbols")
            .num_columns(5)
            .spacing([2.0 * GRID, GRID])
            .show(ui, |ui| {
                for title in ["Signal", "Symbol", "Scale", "Unit", "At the controller"] {
                    ui.muted(title);
                }
                ui.end_row();
                for (k, (row, found)) in rows {
                    ui.label(&row.title);
                    row.fields(ui, own, false);
                    row.judged(ui, found.as_ref(), problems.of(FieldId::Symbol(k)));
                    ui.end_row();
                }
            });
    }
}

impl SymbolRow {
    /// Fields for symbol, scale and unit; in a narrow window the scale has a label.
    fn fields(&mut self, ui: &mut Ui, own: bool, is_titled: bool) {
        let name = format!("Symbol: {}", self.title);
        edit(ui, own, &name, &mut self.symbol, 208.0);
        if self.need.has_scale() {
            if is_titled {
                ui.muted("Scale");
            }
            let name = format!("Scale: {}", self.title);
            edit(ui, own, &name, &mut self.scale, 56.0);
        } else if !is_titled {
            ui.label("");
        }
        ui.muted(&self.unit);
    }

    /// Answer of the controller, or the error of the row.
    fn judged(&self, ui: &mut Ui, found: Option<&SymbolCheck>, problem: Option<&str>) {
        let found = found.map(|check| (check, self.symbol != check.name));
        state(ui, found, problem);
    }
}

fn edit(ui: &mut Ui, enabled: bool, name: &str, text: &mut String, width: f32) {
    // A grid gives a field only its minimum width.
    let field = TextEdit::singleline(text)
        .desired_width(width)
        .min_size(egui::vec2(width, 0.0))
        .clip_text(true);
    let response = ui.add_enabled(enabled, field);
    name_text_field(&response, name, text);
}

/// Error of a row or answer of the controller, by name if the row stands for several symbols.
fn state(ui: &mut Ui, found: Option<(&SymbolCheck, bool)>, problem: Option<&str>) {
    let palette = theme::of(ui);
    let (icon, colour, text) = match (problem, found) {
        (Some(text), _) => (icons::ICON_ERROR, palette.bad, text.to_owned()),
        (None, None) => {
            ui.label("");
            return;
        }
        (None, Some((check, several))) => {
            let place = match several {
                true => format!("{}: ", check.name),
                false => String::new(),
            };
            match &check.found {
                SymbolFound::Good { type_name } => {
                    let text = format!("found: {type_name}");
                    (icons::ICON_CHECK_CIRCLE, palette.good, text)
                }
                SymbolFound::Missing(why) => {
                    let text = format!("missing: {place}{why}");
                    (icons::ICON_ERROR, palette.bad, text)
                }
                SymbolFound::Wrong { type_name, why } => {
                    let text = format!("wrong type: {place}{type_name}, {why}");
                    (icons::ICON_ERROR, palette.bad, text)
                }
            }
        }
    };
    ui.horizontal(|ui| {
        ui.spacing_mut().item_spacing.x = GRID;
        ui.label(icon.rich_text().size(16.0).color(colour));
        ui.label(RichText::new(text).color(colour));
    });
}

#[cfg(test)]
mod tests {
    use tautline_core::robot::presets;
    use tautline_session::SymbolNames;

    use super::*;

    fn rows(robot: &Robot) -> SymbolRows {
        SymbolRows::of(&SymbolMapping::default_for(robot), robot)
    }

    #[test]
    fn rows_make_the_mapping_that_they_are_of() {
        for name in presets::NAMES {
            let robot = presets::find(name).expect("a preset").robot;
            let mut mapping = SymbolMapping::default_for(&robot);
            mapping.readings.revolutions.offset = 2.5;
            mapping.readings.revolutions.symbol = SymbolNames::One("W[{n}].turns".into());
            let mut problems = Problems::default();
            let made = SymbolRows::of(&mapping, &robot).mapping(&robot, &mut problems);
            assert_eq!(made, Some(mapping), "{problems:?}");
        }
    }

    #[test]
    fn wrong_rows_are_named() {
        let robot = presets::find("mini").expect("a preset").robot;
        let problems_of = |change: fn(&mut SymbolRows)| {
            let mut rows = rows(&robot);
            change(&mut rows);
            let mut problems = Problems::default();
            assert_eq!(rows.mapping(&robot, &mut problems), None);
            problems
        };
        let nothing = problems_of(|rows| rows.rows[0].symbol.clear());
        assert!(nothing.of(FieldId::Symbol(0)).is_some());
        let scale = problems_of(|rows| rows.rows[3].scale = "much".into());
        assert!(scale.of(FieldId::Symbol(3)).is_some());
        let half = problems_of(|rows| rows.rows[13].symbol.clear());
        assert!(half.of(FieldId::Symbol(13)).is_some(), "{half:?}");
        let silent = problems_of(|rows| rows.rows[9].symbol.clear());
        let text = silent.of(FieldId::Symbols).expect("a problem");
        assert!(text.contains("state moving"), "{text}");
    }

    #[test]
    fn the_worst_symbol_of_a_row_is_told() {
        let robot = presets::find("mini").expect("a preset").robot;
        let mut rows = rows(&robot);
        rows.rows[0].symbol = "W{n}".into();
        let check = |name: &str, found| SymbolCheck {
            name: name.to_owned(),
            found,
        };
        let good = SymbolFound::Good {
            type_name: "LREAL".into(),
        };
        let missing = SymbolFound::Missing("not found".into());
        assert_eq!(rows.summary(), None);
        rows.checked = Some(Ok(vec![
            check("W1", good.clone()),
            check("W2", missing.clone()),
            check("W11", good),
        ]));
        let found = rows.found(&rows.rows[0]).map(|check| &check.found);
        assert_eq!(found, Some(&missing));
        let text = rows.summary().expect("a sentence").1;
        assert!(text.contains("2 can be used. Missing: 1."), "{text}");
        assert_eq!(rows.found(&rows.rows[1]), None);
        assert_eq!(
            title_of("{cable}.entry_point.x_m"),
            "Entry point x of every cable"
        );
        assert_eq!(unit_of("home.rx_rad"), "rad");
    }
}
