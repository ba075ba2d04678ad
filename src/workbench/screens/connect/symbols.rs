//! The table of symbols: what is needed, its name at the controller, scale and unit.

use egui::{Grid, RichText, TextEdit, Ui, WidgetInfo};
use egui_material_icons::icons;
use tautline_core::robot::Robot;
use tautline_link::ads::{SymbolCheck, SymbolFound};
use tautline_session::{
    AdsCommand, AdsMapping, AdsNames, AdsPose, AdsSymbol, AdsSymbols, is_per_cable, name_of_cable,
};

use super::draft::{Field, Problems};
use crate::app::theme::{self, GRID};
use crate::widgets::{Verdict, muted, parse_number};
use crate::wording::{count, sentence};

/// What a symbol is for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Need {
    Revolutions,
    Force,
    Swivel,
    Laser,
    LaserValid,
    Temperature,
    Time,
    Inclination,
    Pose,
    Moving,
    Fault,
    FaultText,
    Target,
    Kind,
    Number,
    Acknowledged,
    Release,
    Watchdog,
    /// A parameter by its place in the mapping.
    Parameter(usize),
}

impl Need {
    /// All but parameters, with what the operator reads and the unit that a scale of 1 stands for.
    const FIXED: [(Self, &'static str, &'static str); 18] = [
        (Self::Revolutions, "Motor revolutions", "revolutions"),
        (Self::Force, "Force readings", "N"),
        (Self::Swivel, "Swivel angles", "rad"),
        (Self::Laser, "Laser distance", "m"),
        (Self::LaserValid, "Laser has a return", ""),
        (Self::Temperature, "Temperature", "°C"),
        (Self::Time, "Time", "s"),
        (Self::Inclination, "Roll, pitch and yaw", "rad"),
        (Self::Pose, "Commanded pose", "m"),
        (Self::Moving, "Platform is moving", ""),
        (Self::Fault, "Fault", ""),
        (Self::FaultText, "Fault in words", ""),
        (Self::Target, "Target pose", "m"),
        (Self::Kind, "Kind of command", ""),
        (Self::Number, "Number of command", ""),
        (Self::Acknowledged, "Number taken", ""),
        (Self::Release, "Release", ""),
        (Self::Watchdog, "Count of samples", ""),
    ];

    fn has_scale(self) -> bool {
        use Need::{
            Force, Inclination, Laser, Parameter, Pose, Revolutions, Swivel, Target, Temperature,
            Time,
        };
        matches!(
            self,
            Revolutions
                | Force
                | Swivel
                | Laser
                | Temperature
                | Time
                | Inclination
                | Pose
                | Target
                | Parameter(_)
        )
    }

    fn is_of_command(self) -> bool {
        matches!(
            self,
            Self::Target | Self::Kind | Self::Number | Self::Acknowledged
        )
    }
}

/// A row.
#[derive(Debug, Clone)]
struct Row {
    need: Need,
    title: String,
    unit: String,
    /// Name, or names with commas between them; nothing where there is none.
    symbol: String,
    scale: String,
}

/// All rows, and what the controller says of them.
#[derive(Debug, Clone)]
pub struct SymbolRows {
    rows: Vec<Row>,
    /// What the table does not show: offsets, elements, how orientations are written.
    base: AdsMapping,
    /// Names of the cables.
    cables: Vec<String>,
    /// What the controller says, or why it could not be asked.
    pub checked: Option<Result<Vec<SymbolCheck>, String>>,
}

impl SymbolRows {
    /// The rows of a mapping.
    #[must_use]
    pub fn of(mapping: &AdsMapping, robot: &Robot) -> Self {
        let mut rows: Vec<Row> = Need::FIXED
            .into_iter()
            .map(|(need, title, unit)| {
                let (symbol, scale) = read(mapping, need);
                Row {
                    need,
                    title: title.to_owned(),
                    unit: unit.to_owned(),
                    symbol,
                    scale: scale.map_or_else(String::new, |scale| scale.to_string()),
                }
            })
            .collect();
        let parameters = mapping.parameters.iter().enumerate();
        rows.extend(parameters.map(|(k, parameter)| Row {
            need: Need::Parameter(k),
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

    /// The mapping that the rows make.
    pub fn mapping(&self, robot: &Robot, problems: &mut Problems) -> Option<AdsMapping> {
        let mut mapping = self.base.clone();
        let commands = self.rows.iter().filter(|row| row.need.is_of_command());
        if commands
            .clone()
            .all(|row: &Row| row.symbol.trim().is_empty())
        {
            mapping.command = None;
        } else {
            mapping.command.get_or_insert_with(no_command);
        }
        let mut good = true;
        for (k, row) in self.rows.iter().enumerate() {
            let scale = match row.need.has_scale() && !row.symbol.trim().is_empty() {
                true => problems.take(Field::Symbol(k), parse_number(&row.scale)),
                false => Some(1.0),
            };
            let written = scale.map(|scale| write(&mut mapping, row, scale));
            if let Some(Err(text)) = written {
                problems.add(Field::Symbol(k), text);
                good = false;
            }
            good &= scale.is_some();
        }
        // Parameters without a name are not at the controller.
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
                problems.add(Field::Symbols, format!("{place}: {}", error.message));
                None
            }
        }
    }

    /// The names for which a row stands, one per cable where it is a pattern.
    fn names(&self, row: &Row) -> Vec<String> {
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

    /// What the controller says of a row: the worst of its symbols.
    fn found(&self, row: &Row) -> Option<&SymbolCheck> {
        let Some(Ok(checks)) = &self.checked else {
            return None;
        };
        let names = self.names(row);
        let mut found = checks.iter().filter(|check| names.contains(&check.name));
        let first = found.clone().next();
        let wrong = found.find(|check| !matches!(check.found, SymbolFound::Good { .. }));
        wrong.or(first)
    }

    /// What the controller says in one sentence, once it was asked.
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
            "Of {}, {good} can be used, {missing} are missing, {} are of a wrong type.",
            count(checks.len(), "symbol"),
            checks.len() - good - missing
        );
        Some((Verdict::Bad, text))
    }

    /// Draws the table; `own`: it can be edited.
    pub fn show(&mut self, ui: &mut Ui, own: bool, problems: &Problems) {
        let found: Vec<Option<SymbolCheck>> = self
            .rows
            .iter()
            .map(|row| self.found(row).cloned())
            .collect();
        Grid::new("symbols")
            .num_columns(5)
            .spacing([2.0 * GRID, GRID])
            .show(ui, |ui| {
                for title in [
                    "What is needed",
                    "Symbol",
                    "Scale",
                    "Unit",
                    "At the controller",
                ] {
                    muted(ui, title);
                }
                ui.end_row();
                for (k, (row, found)) in self.rows.iter_mut().zip(&found).enumerate() {
                    ui.label(&row.title);
                    edit(
                        ui,
                        own,
                        &format!("Symbol: {}", row.title),
                        &mut row.symbol,
                        208.0,
                    );
                    if row.need.has_scale() {
                        edit(
                            ui,
                            own,
                            &format!("Scale: {}", row.title),
                            &mut row.scale,
                            56.0,
                        );
                    } else {
                        ui.label("");
                    }
                    muted(ui, &row.unit);
                    let several = row.symbol != found.as_ref().map_or("", |f| &f.name);
                    let problem = problems.of(Field::Symbol(k));
                    state(ui, found.as_ref().map(|f| (f, several)), problem);
                    ui.end_row();
                }
            });
    }
}

fn edit(ui: &mut Ui, enabled: bool, name: &str, text: &mut String, width: f32) {
    // A grid gives a field no more than it asks for at least.
    let field = TextEdit::singleline(text)
        .desired_width(width)
        .min_size(egui::vec2(width, 0.0))
        .clip_text(true);
    let response = ui.add_enabled(enabled, field);
    let value = text.clone();
    response.widget_info(|| {
        let mut info = WidgetInfo::text_edit(enabled, value.clone(), value.clone(), "");
        info.label = Some(name.to_owned());
        info
    });
}

/// What is wrong with a row, or what the controller says of it, by name where it stands for several symbols.
fn state(ui: &mut Ui, found: Option<(&SymbolCheck, bool)>, problem: Option<&str>) {
    let palette = theme::of(ui);
    let kind = |type_name: &str, bytes: usize| format!("{type_name}, {}", count(bytes, "byte"));
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
                SymbolFound::Good { type_name, bytes } => {
                    let text = format!("found: {}", kind(type_name, *bytes));
                    (icons::ICON_CHECK_CIRCLE, palette.good, text)
                }
                SymbolFound::Missing(why) => {
                    let text = format!("missing: {place}{why}");
                    (icons::ICON_ERROR, palette.bad, text)
                }
                SymbolFound::Wrong {
                    type_name,
                    bytes,
                    why,
                } => {
                    let kind = kind(type_name, *bytes);
                    let text = format!("wrong type: {place}{kind}, {why}");
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

fn no_command() -> AdsCommand {
    AdsCommand {
        target: AdsPose {
            symbol: AdsNames::One(String::new()),
            rotation: Default::default(),
            length_scale: 1.0,
            angle_scale: 1.0,
        },
        kind: String::new(),
        number: String::new(),
        acknowledged: String::new(),
    }
}

fn text_of(names: &AdsNames) -> String {
    match names {
        AdsNames::One(name) => name.clone(),
        AdsNames::Each(names) => names.join(", "),
    }
}

fn names_of(text: &str) -> AdsNames {
    match text.contains(',') {
        true => AdsNames::Each(text.split(',').map(|name| name.trim().to_owned()).collect()),
        false => AdsNames::One(text.to_owned()),
    }
}

/// Name and scale of a need; nothing where the mapping does not have it.
fn read(mapping: &AdsMapping, need: Need) -> (String, Option<f64>) {
    let readings = &mapping.readings;
    let list = |s: &AdsSymbols| (text_of(&s.symbol), Some(s.scale));
    let lists = |s: &Option<AdsSymbols>| s.as_ref().map_or((String::new(), Some(1.0)), list);
    let value = |s: &Option<AdsSymbol>| {
        let known = s.as_ref().map(|s| (s.symbol.clone(), Some(s.scale)));
        known.unwrap_or((String::new(), Some(1.0)))
    };
    let pose = |p: Option<&AdsPose>| {
        let known = p.map(|p| (text_of(&p.symbol), Some(p.length_scale)));
        known.unwrap_or((String::new(), Some(1.0)))
    };
    let name = |s: &Option<String>| (s.clone().unwrap_or_default(), None);
    let command = mapping.command.as_ref();
    let told = |of: fn(&AdsCommand) -> &String| {
        let name = command.map(of).cloned();
        (name.unwrap_or_default(), None)
    };
    match need {
        Need::Revolutions => list(&readings.revolutions),
        Need::Force => lists(&readings.force),
        Need::Swivel => lists(&readings.swivel),
        Need::Laser => value(&readings.laser),
        Need::LaserValid => name(&readings.laser_valid),
        Need::Temperature => value(&readings.temperature),
        Need::Time => value(&readings.time),
        Need::Inclination => lists(&readings.inclination),
        Need::Pose => pose(readings.pose.as_ref()),
        Need::Moving => name(&mapping.state.moving),
        Need::Fault => name(&mapping.state.fault),
        Need::FaultText => name(&mapping.state.fault_text),
        Need::Target => pose(command.map(|c| &c.target)),
        Need::Kind => told(|c| &c.kind),
        Need::Number => told(|c| &c.number),
        Need::Acknowledged => told(|c| &c.acknowledged),
        Need::Release => name(&mapping.release),
        Need::Watchdog => name(&mapping.watchdog),
        Need::Parameter(_) => (String::new(), None),
    }
}

/// Writes a row into a mapping; the error says what is missing.
fn write(mapping: &mut AdsMapping, row: &Row, scale: f64) -> Result<(), String> {
    let text = row.symbol.trim();
    let wanted = !text.is_empty();
    let missing = || Err("found nothing, expected the name of a symbol".to_owned());
    let list = |old: &Option<AdsSymbols>| {
        wanted.then(|| AdsSymbols {
            symbol: names_of(text),
            scale,
            offset: old.as_ref().map_or(0.0, |old| old.offset),
        })
    };
    let value = |old: &Option<AdsSymbol>| {
        wanted.then(|| AdsSymbol {
            symbol: text.to_owned(),
            scale,
            offset: old.as_ref().map_or(0.0, |old| old.offset),
        })
    };
    let pose = |old: Option<&AdsPose>| AdsPose {
        symbol: names_of(text),
        length_scale: scale,
        rotation: old.map_or_else(Default::default, |old| old.rotation),
        angle_scale: old.map_or(1.0, |old| old.angle_scale),
    };
    let name = || wanted.then(|| text.to_owned());
    let readings = &mut mapping.readings;
    match row.need {
        Need::Revolutions if !wanted => return missing(),
        Need::Revolutions => {
            readings.revolutions.symbol = names_of(text);
            readings.revolutions.scale = scale;
        }
        Need::Force => readings.force = list(&readings.force),
        Need::Swivel => readings.swivel = list(&readings.swivel),
        Need::Laser => readings.laser = value(&readings.laser),
        Need::LaserValid => readings.laser_valid = name(),
        Need::Temperature => readings.temperature = value(&readings.temperature),
        Need::Time => readings.time = value(&readings.time),
        Need::Inclination => readings.inclination = list(&readings.inclination),
        Need::Pose => readings.pose = wanted.then(|| pose(readings.pose.as_ref())),
        Need::Moving => mapping.state.moving = name(),
        Need::Fault => mapping.state.fault = name(),
        Need::FaultText => mapping.state.fault_text = name(),
        Need::Release => mapping.release = name(),
        Need::Watchdog => mapping.watchdog = name(),
        Need::Target | Need::Kind | Need::Number | Need::Acknowledged => {
            let Some(command) = &mut mapping.command else {
                return Ok(());
            };
            if !wanted {
                return missing();
            }
            match row.need {
                Need::Target => command.target = pose(Some(&command.target)),
                Need::Kind => command.kind = text.to_owned(),
                Need::Number => command.number = text.to_owned(),
                _ => command.acknowledged = text.to_owned(),
            }
        }
        Need::Parameter(k) => {
            if let Some(parameter) = mapping.parameters.get_mut(k) {
                parameter.symbol = text.to_owned();
                parameter.scale = scale;
            }
        }
    }
    Ok(())
}

/// "{cable}.entry_point.x_m" as "Entry point x of every cable".
fn title_of(name: &str) -> String {
    let (whose, rest) = match name.strip_prefix("{cable}.") {
        Some(rest) => (" of every cable", rest),
        None => ("", name),
    };
    let plain = ["_rad", "_mm", "_m", "_n"]
        .iter()
        .find_map(|unit| rest.strip_suffix(unit));
    let words = plain.unwrap_or(rest).replace(['.', '_'], " ");
    sentence(&format!("{words}{whose}"))
}

/// The unit at the end of a parameter's name.
fn unit_of(name: &str) -> &'static str {
    match name.rsplit('_').next() {
        Some("m") => "m",
        Some("rad") => "rad",
        _ => "",
    }
}

#[cfg(test)]
mod tests {
    use tautline_core::robot::presets;

    use super::*;

    fn rows(robot: &Robot) -> SymbolRows {
        SymbolRows::of(&AdsMapping::default_for(robot), robot)
    }

    #[test]
    fn rows_make_the_mapping_that_they_are_of() {
        for name in presets::NAMES {
            let robot = presets::find(name).expect("a preset").robot;
            let mut mapping = AdsMapping::default_for(&robot);
            mapping.readings.revolutions.offset = 2.5;
            mapping.readings.revolutions.symbol = AdsNames::One("W[{n}].turns".into());
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
        assert!(nothing.of(Field::Symbol(0)).is_some());
        let scale = problems_of(|rows| rows.rows[3].scale = "much".into());
        assert!(scale.of(Field::Symbol(3)).is_some());
        let half = problems_of(|rows| rows.rows[13].symbol.clear());
        assert!(half.of(Field::Symbol(13)).is_some(), "{half:?}");
        let silent = problems_of(|rows| rows.rows[9].symbol.clear());
        let text = silent.of(Field::Symbols).expect("a problem");
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
            bytes: 8,
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
        assert!(text.contains("2 can be used, 1 are missing"), "{text}");
        assert_eq!(rows.found(&rows.rows[1]), None);
        assert_eq!(
            title_of("{cable}.entry_point.x_m"),
            "Entry point x of every cable"
        );
        assert_eq!(unit_of("home.rx_rad"), "rad");
    }
}
