//! The clocks of several recorders.

use egui::Ui;
use egui_material_icons::icons;
use tautline_import::Clock;

use super::Bench;
use crate::model::command::RecordingCommand;
use crate::widgets::{Entered, Number, UiExt, icon_button, number};

/// Draws the part if there are several clocks.
pub fn show(ui: &mut Ui, bench: &mut Bench<'_>) {
    let used = |k: usize| bench.open.uses.keys().any(|(series, _)| *series == k);
    let Some(cut) = &bench.open.cut else {
        return;
    };
    let timed: Vec<String> = bench
        .open
        .all_series()
        .enumerate()
        .filter(|(k, _)| used(*k) && cut.times.get(*k).is_some_and(Option::is_some))
        .map(|(_, series)| series.name.clone())
        .collect();
    if timed.len() < 2 {
        return;
    }
    ui.section("Clocks");
    ui.muted("Offsets that are added to the times of each recorder so that they agree.");
    for series in timed {
        let clocks = &bench.open.draft.recipe().clocks;
        let clock = clocks.iter().find(|clock| clock.series == series);
        let offset_s = clock.map_or(0.0, |clock| clock.offset_s);
        ui.horizontal(|ui| {
            ui.label(&series);
            let drift = clock.map_or(0.0, |clock| clock.drift);
            let name = format!("Offset of {series}");
            let field = Number::of(&name, offset_s, 4, "s", 96.0);
            if let Some(Entered::Value(value)) = number(ui, &field) {
                bench.change(format!("set clock of {series}"), |recipe| {
                    let known = recipe
                        .clocks
                        .iter_mut()
                        .find(|clock| clock.series == series);
                    match known {
                        Some(clock) => clock.offset_s = value,
                        None => recipe.clocks.push(Clock {
                            series: series.clone(),
                            offset_s: value,
                            ..Clock::default()
                        }),
                    }
                });
            }
            if drift != 0.0 {
                ui.muted(&format!("drift {:+.1} ppm", 1e6 * drift));
            }
        });
    }
    if icon_button(ui, icons::ICON_SCHEDULE, "Align the clocks", true).clicked() {
        bench.outbox.send(RecordingCommand::AlignClocks);
    }
    ui.muted("Offset and drift are found from the motion that both have recorded.");
}
