//! Meaning of the shown channel: set for it alone, or by pattern for all cables.

use egui::{ComboBox, Ui};
use tautline_channels::{Series, parse_unit};
use tautline_import::{Assignment, Quantity, pattern_of};

use super::{Bench, KnownPattern, PanelState};
use crate::theme::GRID;
use crate::widgets::{Entered, Number, UiExt, checkbox, choice, combo_box, form, number};

const UNUSED: &str = "Not used";

struct ShownChannel<'a> {
    series: &'a Series,
    name: &'a str,
    unit: Option<&'a str>,
    /// Entry of the recipe.
    entry: Option<&'a Assignment>,
    /// Pattern of the channels of all cables, and the number of the first.
    pattern: Option<(String, usize)>,
}

pub fn show(ui: &mut Ui, bench: &mut Bench<'_>, panel: &mut PanelState) {
    let open = bench.open;
    let place = open.shown;
    let Some(series) = open.all_series().nth(place.series) else {
        return;
    };
    let text = place.channel.checked_sub(series.channels.len());
    let (name, unit) = match (series.channels.get(place.channel), text) {
        (Some(channel), _) => (channel.name.as_str(), channel.unit.as_deref()),
        (None, Some(text)) => match series.texts.get(text) {
            Some(text) => (text.name.as_str(), None),
            None => return,
        },
        (None, None) => return,
    };
    let cables = bench.robot.cable_count();
    let files = open.draft.sources().len();
    let is_known = |known: &KnownPattern| known.of == place && known.files == files;
    if !panel.pattern.as_ref().is_some_and(is_known) {
        let names = series.channels.iter().map(|channel| channel.name.as_str());
        panel.pattern = Some(KnownPattern {
            of: place,
            files,
            found: pattern_of(names, name, cables),
        });
        panel.for_all = true;
    }
    let shown = ShownChannel {
        series,
        name,
        unit,
        entry: open.draft.recipe().entry_of(&series.name, name, cables),
        pattern: panel.pattern.as_ref().and_then(|known| known.found.clone()),
    };
    ui.heading(name);
    ui.muted(&words(&shown, place.channel));
    ui.add_space(GRID);
    scope(ui, &shown, panel, cables);
    let for_all = panel.for_all && shown.pattern.is_some();
    meaning(ui, bench, &shown, for_all);
}

fn words(shown: &ShownChannel<'_>, channel: usize) -> String {
    let unit = match shown.unit {
        Some(unit) => format!("in {unit}, as the file states"),
        None => "without a unit".to_owned(),
    };
    let Some(channel) = shown.series.channels.get(channel) else {
        return format!("Text, {} rows", shown.series.rows);
    };
    let summary = channel.summary();
    let gaps = match summary.gaps {
        0 => String::new(),
        gaps => format!(", {gaps} without a value"),
    };
    let [low, high] = summary.range.map(short);
    format!("{} rows{gaps}, {low} to {high}, {unit}", shown.series.rows)
}

/// Number with at most five digits.
fn short(value: f64) -> String {
    let rounded: f64 = format!("{value:.4e}").parse().unwrap_or(value);
    rounded.to_string()
}

/// Choice between this channel and those of all cables.
fn scope(ui: &mut Ui, shown: &ShownChannel<'_>, panel: &mut PanelState, cables: usize) {
    let Some((pattern, _)) = &shown.pattern else {
        return;
    };
    let all = format!("All {cables} channels {pattern}");
    choice(ui, &mut panel.for_all, true, &all);
    choice(ui, &mut panel.for_all, false, "Only this channel");
    ui.add_space(GRID);
}

/// Meaning of the channel: quantity, cable, unit, sign, factor and offset.
fn meaning(ui: &mut Ui, bench: &mut Bench<'_>, shown: &ShownChannel<'_>, for_all: bool) {
    let cables = bench.robot.cable_count();
    let own = shown
        .entry
        .map(|entry| of_channel(entry, shown.name, cables));
    let quantity = own.as_ref().and_then(|own| Quantity::parse(&own.quantity));
    form("meaning of the channel").show(ui, |ui| {
        ui.label("Is");
        let chosen = choose_quantity(ui, shown, quantity);
        ui.end_row();
        if let Some(chosen) = chosen {
            assign(bench, shown, own.clone(), chosen, for_all);
        }
        let (Some(own), Some(quantity)) = (own, quantity) else {
            return;
        };
        if quantity.is_per_cable() && !for_all {
            ui.label("Of cable");
            if let Some(cable) = choose_cable(ui, bench, quantity.index) {
                let moved = Quantity {
                    index: cable,
                    ..quantity
                };
                assign(bench, shown, Some(own.clone()), Some(moved), false);
            }
            ui.end_row();
        }
        let edit = |bench: &mut Bench<'_>, what: &str, change: &dyn Fn(&mut Assignment)| {
            let mut changed = own.clone();
            change(&mut changed);
            let what = format!("change {what} of {}", shown.name);
            put(bench, shown, changed, quantity, for_all, what);
        };
        if !quantity.is_text() && !quantity.usual_units().is_empty() {
            ui.label("In");
            if let Some(unit) = choose_unit(ui, shown, quantity, own.unit.as_deref()) {
                edit(bench, "unit", &|own| own.unit.clone_from(&unit));
            }
            ui.end_row();
        }
        if quantity.is_text() {
            return;
        }
        ui.label("Sign");
        ui.horizontal(|ui| {
            let mut reversed = own.reversed;
            if checkbox(ui, &mut reversed, "Reversed").changed() {
                edit(bench, "sign", &|own| own.reversed = reversed);
            }
            let mut from_first = own.from_first_pose;
            let text = "Zero at the first pose";
            if quantity.moves() && checkbox(ui, &mut from_first, text).changed() {
                edit(bench, "zero", &|own| own.from_first_pose = from_first);
            }
        });
        ui.end_row();
        ui.label("Factor");
        ui.horizontal(|ui| {
            let typed = number(ui, &plain("Factor", own.factor));
            if let Some(Entered::Value(value)) = typed
                && value != 0.0
            {
                edit(bench, "factor", &|own| own.factor = value);
            }
            ui.label("Offset");
            let typed = number(ui, &plain("Offset", own.offset));
            if let Some(Entered::Value(value)) = typed {
                edit(bench, "offset", &|own| own.offset = value);
            }
        });
        ui.end_row();
    });
}

/// Field for a dimensionless number.
fn plain(name: &str, value: f64) -> Number<'_> {
    Number::of(name, value, 6, "", 88.0)
}

fn of_channel(entry: &Assignment, channel: &str, cables: usize) -> Assignment {
    let mut singles = (0..cables).map(|cable| entry.of_cable(cable));
    singles
        .find(|one| one.channel == channel)
        .unwrap_or_else(|| entry.clone())
}

fn combo(ui: &mut Ui, name: &str, selected: &str, add: impl FnOnce(&mut Ui)) {
    let list = ComboBox::from_id_salt(name).width(168.0).height(360.0);
    combo_box(ui, list, &format!("{name}: {selected}"), selected, add);
}

/// Returns a newly chosen quantity; `Some(None)` if the channel is not used.
fn choose_quantity(
    ui: &mut Ui,
    shown: &ShownChannel<'_>,
    now: Option<Quantity>,
) -> Option<Option<Quantity>> {
    let mut chosen = None;
    let is_text = shown.series.channel(shown.name).is_none();
    let title = now.map_or_else(|| UNUSED.to_owned(), Quantity::title);
    combo(ui, "Quantity", &title, |ui| {
        if ui.selectable_label(now.is_none(), UNUSED).clicked() {
            chosen = Some(None);
        }
        for quantity in Quantity::all() {
            if is_text && !quantity.is_text() {
                continue;
            }
            let is_now = now.is_some_and(|now| now.title() == quantity.title());
            if ui.selectable_label(is_now, quantity.title()).clicked() && !is_now {
                chosen = Some(Some(quantity));
            }
        }
    });
    chosen
}

fn choose_cable(ui: &mut Ui, bench: &Bench<'_>, now: usize) -> Option<usize> {
    let mut chosen = None;
    let name = |cable: usize| {
        let found = bench.robot.cables.get(cable);
        found.map_or_else(|| (cable + 1).to_string(), |cable| cable.name.clone())
    };
    combo(ui, "Cable", &name(now), |ui| {
        for cable in 0..bench.robot.cable_count() {
            let label = ui.selectable_label(cable == now, name(cable));
            if label.clicked() && cable != now {
                chosen = Some(cable);
            }
        }
    });
    chosen
}

/// Returns a newly chosen unit; `Some(None)` for that of the file.
fn choose_unit(
    ui: &mut Ui,
    shown: &ShownChannel<'_>,
    quantity: Quantity,
    now: Option<&str>,
) -> Option<Option<String>> {
    let mut chosen = None;
    let stated = shown.unit.filter(|unit| parse_unit(unit).is_some());
    let of_file = match stated {
        Some(unit) => format!("{unit}, as the file states"),
        None if unit_of(quantity) == "rev" => "revolutions (assumed)".to_owned(),
        None => format!("{} (assumed)", unit_of(quantity)),
    };
    combo(ui, "Unit", now.unwrap_or(&of_file), |ui| {
        if ui.selectable_label(now.is_none(), &of_file).clicked() {
            chosen = Some(None);
        }
        for unit in quantity.usual_units() {
            if ui.selectable_label(now == Some(*unit), *unit).clicked() {
                chosen = Some(Some((*unit).to_owned()));
            }
        }
    });
    chosen
}

fn unit_of(quantity: Quantity) -> &'static str {
    let native = |unit: &&&str| quantity.conversion(unit) == Some((1.0, 0.0));
    quantity
        .usual_units()
        .iter()
        .find(native)
        .copied()
        .unwrap_or("")
}

/// Assigns a quantity to the channel or to those of the pattern.
fn assign(
    bench: &mut Bench<'_>,
    shown: &ShownChannel<'_>,
    own: Option<Assignment>,
    quantity: Option<Quantity>,
    for_all: bool,
) {
    let cables = bench.robot.cable_count();
    let series = shown.series.name.clone();
    let Some(mut quantity) = quantity else {
        let names: Vec<String> = match (&shown.pattern, for_all) {
            (Some((pattern, first)), true) => (0..cables)
                .map(|cable| pattern.replacen("{i}", &(cable + first).to_string(), 1))
                .collect(),
            _ => vec![shown.name.to_owned()],
        };
        let what = format!("do not use {}", shown.name);
        return bench.change(what, |recipe| {
            for name in &names {
                recipe.release(&series, name, cables);
            }
        });
    };
    // A numbered channel belongs to the cable of that number, unless set otherwise.
    if quantity.is_per_cable()
        && own.is_none()
        && let Some((pattern, first)) = &shown.pattern
    {
        let name = |cable: usize| pattern.replacen("{i}", &(cable + first).to_string(), 1);
        quantity.index = (0..cables)
            .find(|cable| name(*cable) == shown.name)
            .unwrap_or(0);
    }
    let fits = |own: &Assignment| {
        Quantity::parse(&own.quantity).is_some_and(|old| old.dimension() == quantity.dimension())
    };
    let kept = own.filter(fits);
    let base = kept.unwrap_or_else(|| Assignment::new(shown.name, ""));
    let what = format!("{} is {}", shown.name, quantity.title().to_lowercase());
    put(bench, shown, base, quantity, for_all, what);
}

/// Writes an entry of the recipe, for a channel or its pattern.
fn put(
    bench: &mut Bench<'_>,
    shown: &ShownChannel<'_>,
    own: Assignment,
    quantity: Quantity,
    for_all: bool,
    what: String,
) {
    let cables = bench.robot.cable_count();
    let several = bench
        .open
        .all_series()
        .filter(|series| series.channel(shown.name).is_some() || series.text(shown.name).is_some())
        .count();
    let series = (several > 1).then(|| shown.series.name.clone());
    let entry = match (&shown.pattern, for_all && quantity.is_per_cable()) {
        (Some((pattern, first)), true) => Assignment {
            channel: pattern.clone(),
            quantity: quantity.kind.column_of("{i}"),
            first: *first,
            series,
            ..own
        },
        _ => Assignment {
            channel: shown.name.to_owned(),
            quantity: quantity.column(),
            first: 1,
            series,
            ..own
        },
    };
    let of = shown.series.name.clone();
    bench.change(what, |recipe| recipe.assign(&of, entry, cables));
}
