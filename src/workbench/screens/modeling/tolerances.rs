//! Tolerances of the parts: exact, typical or stated, with their effect on the readings.

use egui::{Align, Label, Layout, RichText, Ui, Vec2};
use tautline_core::effect::find;
use tautline_core::robot::{PartTolerances, StatedTolerances};
use tautline_workflow::tolerances::{
    DeviatingPart, DeviationsInReadings, class_in_words, deviating_parts, typical_as_stated,
};
use tautline_workflow::wording::list;
use tautline_workflow::wording::units::significant;

use super::description::field::{change, put};
use crate::model::Memo;
use crate::screens::bench_panel::Bench;
use crate::theme::{self, GRID};
use crate::widgets::{Entered, Number, UiExt, choice, number_checked};

/// Widths of the columns of numbers (points).
const TYPICAL: f32 = 14.0 * GRID;
const FIELD: f32 = 17.0 * GRID;
const CHANGE: f32 = 16.0 * GRID;
/// Significant digits of a tolerance, and of a change of a reading.
const DIGITS: i32 = 3;
const DIGITS_OF_CHANGE: i32 = 2;

/// State of the page between frames.
#[derive(Debug, Default)]
pub struct PanelState {
    in_readings: Memo<u64, Result<DeviationsInReadings, String>>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Choice {
    Exact,
    Typical,
    Stated,
}

impl Choice {
    fn of(tolerances: Option<&PartTolerances>) -> Self {
        match tolerances {
            None => Self::Exact,
            Some(PartTolerances::Typical(_)) => Self::Typical,
            Some(PartTolerances::Stated(_)) => Self::Stated,
        }
    }
}

pub fn show(ui: &mut Ui, bench: &mut Bench<'_>, panel: &mut PanelState) {
    ui.muted("By how much sound parts deviate from the description, as standard deviations. A fault is a part outside its tolerance.");
    choose(ui, bench);
    let session = bench.session();
    let in_readings =
        (panel.in_readings).get(bench.open.inputs(), || DeviationsInReadings::of(session));
    ui.add_space(GRID);
    match in_readings {
        Ok(found) => ui.muted(&format!(
                "In readings: by how many standard deviations of its noise a deviation of one tolerance changes the reading that it changes most, at {}.",
                found.poses
            )),
        Err(error) => {
            ui.doubtful(&format!("The effect of deviations on the readings cannot be computed: {error}."));
            return table(ui, bench, None);
        }
    };
    table(ui, bench, in_readings.as_ref().ok());
}

/// Choice between exact parts, typical tolerances and stated ones.
fn choose(ui: &mut Ui, bench: &mut Bench<'_>) {
    let robot = bench.robot();
    let now = Choice::of(robot.tolerances.as_ref());
    let mut chosen = now;
    ui.horizontal(|ui| {
        choice(ui, &mut chosen, Choice::Exact, "Exact");
        choice(ui, &mut chosen, Choice::Typical, "Typical");
        choice(ui, &mut chosen, Choice::Stated, "Stated");
    });
    let class = class_in_words(robot);
    ui.muted(&match now {
            Choice::Exact => "Nothing is stated: an identification takes all parts as exact, so its standard deviations are too small for a real machine; a diagnosis takes typical tolerances.".to_owned(),
            Choice::Typical => format!("Those of the table, typical of {class}."),
            Choice::Stated => "Those of this machine. A part with an empty field is exact.".to_owned(),
        });
    if let (Choice::Stated, Some(PartTolerances::Stated(stated))) = (now, &robot.tolerances) {
        factor(ui, bench, stated);
    }
    if chosen != now {
        let (tolerances, what) = match chosen {
            Choice::Exact => (None, "take the parts as exact"),
            Choice::Typical => (Some(PartTolerances::typical()), "take typical tolerances"),
            Choice::Stated => (
                Some(PartTolerances::Stated(typical_as_stated(robot))),
                "state tolerances",
            ),
        };
        change(bench, what, |robot| robot.tolerances = tolerances);
    }
}

fn factor(ui: &mut Ui, bench: &mut Bench<'_>, stated: &StatedTolerances) {
    ui.horizontal(|ui| {
        ui.label("Factor of all stated tolerances");
        let field = Tolerance {
            name: "Factor of all stated tolerances",
            value: Some(stated.factor),
            per_si: 1.0,
            unit: "",
            is_optional: false,
        };
        edit(ui, bench, &field, |stated, factor| {
            stated.factor = factor.unwrap_or(1.0);
        });
    });
}

fn table(ui: &mut Ui, bench: &mut Bench<'_>, in_readings: Option<&DeviationsInReadings>) {
    let robot = bench.robot();
    let stated = match &robot.tolerances {
        Some(PartTolerances::Stated(stated)) => Some(stated),
        _ => None,
    };
    let (mut shown, mut unread) = (Vec::new(), Vec::new());
    for part in deviating_parts(robot) {
        let is_stated = stated.is_some_and(|s| s.effects.contains_key(part.effect.id()));
        let is_read =
            in_readings.is_none_or(|found| found.largest(robot, part.effect, |_| 1.0) > 0.0);
        match (
            is_stated || is_read,
            stated.is_some() || part.typical.is_some(),
        ) {
            (true, true) => shown.push(part),
            (false, true) => unread.push(part.effect.title().to_lowercase()),
            (_, false) => {}
        }
    }
    head(ui, stated.is_some());
    for part in &shown {
        let change = in_readings.map(|found| found.of_part(robot, part));
        let change = change.filter(|change| *change > 0.0);
        row(ui, bench, part, stated, change);
    }
    let kept = stated.into_iter().flat_map(|stated| stated.effects.keys());
    let kept = kept.filter(|id| shown.iter().all(|part| part.effect.id() != *id));
    let kept = kept.filter_map(|id| Some(find(id)?.title().to_lowercase()));
    let kept: Vec<String> = kept.collect();
    if !kept.is_empty() {
        ui.add_space(2.0 * GRID);
        let what = list(&kept);
        ui.muted(&format!("Stated in the file and kept as it is: {what}."));
    }
    if !unread.is_empty() {
        ui.add_space(2.0 * GRID);
        ui.muted(&format!(
            "No reading of this robot depends on: {}.",
            list(&unread)
        ));
    }
}

/// Row with a name on the left and columns of numbers on the right.
fn line(ui: &mut Ui, name: RichText, numbers: impl FnOnce(&mut Ui)) {
    ui.horizontal(|ui| {
        ui.spacing_mut().item_spacing.x = 2.0 * GRID;
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
            numbers(ui);
            ui.with_layout(Layout::left_to_right(Align::Center), |ui| {
                ui.wrapped(name);
            });
        });
    });
}

/// Right-aligned text in a column.
fn column(ui: &mut Ui, width: f32, text: impl Into<RichText>) {
    let height = ui.spacing().interact_size.y;
    let layout = Layout::right_to_left(Align::Center);
    ui.allocate_ui_with_layout(Vec2::new(width, height), layout, |ui| {
        ui.set_min_width(width);
        ui.add(Label::new(text.into()).extend());
    });
}

fn head(ui: &mut Ui, has_fields: bool) {
    let colour = theme::of(ui).muted;
    let small = |text: &str| RichText::new(text).small().color(colour);
    ui.add_space(GRID);
    line(ui, small("Deviation"), |ui| {
        column(ui, CHANGE, small("In readings"));
        if has_fields {
            column(ui, FIELD, small("Stated"));
        }
        column(ui, TYPICAL, small("Typical"));
    });
    ui.separator();
}

/// Part with its tolerances, the source of the typical one, and the cables named in the file.
fn row(
    ui: &mut Ui,
    bench: &mut Bench<'_>,
    part: &DeviatingPart,
    stated: Option<&StatedTolerances>,
    change: Option<f64>,
) {
    let palette = theme::of(ui);
    let (id, title) = (part.effect.id(), part.effect.title());
    let shown = |value: Option<f64>, digits| {
        value.map_or("–".to_owned(), |value| significant(value, digits))
    };
    let name = match part.unit {
        "" => title.to_owned(),
        unit => format!("{title}, {unit}"),
    };
    line(ui, RichText::new(name).font(theme::strong(13.0)), |ui| {
        column(ui, CHANGE, shown(change, DIGITS_OF_CHANGE));
        if let Some(stated) = stated {
            let field = Tolerance {
                name: &format!("Tolerance of {}", title.to_lowercase()),
                value: stated.others(id),
                per_si: part.per_si,
                unit: part.unit,
                is_optional: true,
            };
            edit(ui, bench, &field, |stated, sd| stated.set_others(id, sd));
        }
        let typical = part.typical.map(|sd| sd * part.per_si);
        column(ui, TYPICAL, shown(typical, DIGITS));
    });
    for (cable, sd) in stated.into_iter().flat_map(|stated| stated.named(id)) {
        line(ui, RichText::new(format!("      of {cable}")), |ui| {
            column(ui, CHANGE, "");
            let field = Tolerance {
                name: &format!("Tolerance of {}, {cable}", title.to_lowercase()),
                value: Some(sd),
                per_si: part.per_si,
                unit: part.unit,
                is_optional: true,
            };
            edit(ui, bench, &field, |stated, sd| {
                stated.set_named(id, cable, sd);
            });
            column(ui, TYPICAL, "");
        });
    }
    if let Some(source) = part.source {
        let text = RichText::new(source).small().color(palette.muted);
        ui.wrapped(text);
    }
    ui.add_space(GRID);
}

/// Field of a stated tolerance.
struct Tolerance<'a> {
    name: &'a str,
    /// Value in the SI unit.
    value: Option<f64>,
    /// Display units per SI unit.
    per_si: f64,
    unit: &'a str,
    /// Whether the field may be empty.
    is_optional: bool,
}

/// Draws the field of a tolerance and sets the entered value.
fn edit(
    ui: &mut Ui,
    bench: &mut Bench<'_>,
    field: &Tolerance<'_>,
    set: impl FnOnce(&mut StatedTolerances, Option<f64>),
) {
    let value = field.value.map(|value| value * field.per_si);
    let text = value.map_or_else(String::new, |value| significant(value, DIGITS));
    let decimals = text
        .split_once('.')
        .map_or(0, |(_, decimals)| decimals.len());
    let shown = Number::of(field.name, value, decimals, "", FIELD).optional(field.is_optional);
    let check = |typed: f64| match typed >= 0.0 {
        true => Ok(()),
        false => Err(format!(
            "found {}, expected 0 or more",
            format!("{typed} {}", field.unit).trim_end()
        )),
    };
    let typed = match number_checked(ui, &shown, &check) {
        Some(Entered::Value(typed)) => Some(typed / field.per_si),
        Some(Entered::Nothing) => None,
        Some(Entered::Wrong(message)) => return bench.refuse(message),
        None => return,
    };
    let mut robot = bench.robot().clone();
    if let Some(PartTolerances::Stated(stated)) = &mut robot.tolerances {
        set(stated, typed);
    }
    put(
        bench,
        robot,
        &format!("change {}", field.name.to_lowercase()),
    );
}
