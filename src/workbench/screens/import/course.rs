//! Plot of the shown channel over time, with the poses cut from it.

use egui::Ui;
use tautline_workflow::importing::channel_figure;

use super::Bench;
use crate::model::Selection;
use crate::views::plots::small;
use crate::widgets::UiExt;

pub fn show(ui: &mut Ui, bench: &Bench<'_>) {
    let place = bench.open.shown;
    let series = bench.open.all_series().nth(place.series);
    let Some(channel) = series.and_then(|series| series.channels.get(place.channel)) else {
        return ui.empty("Choose a channel of numbers to see it over time.");
    };
    let cut = bench.open.cut.as_ref();
    let times = cut.and_then(|cut| cut.times.get(place.series)?.as_deref());
    let course = bench.open.outlines.channel(place.series, place.channel);
    let poses = cut.map_or(&[][..], |cut| cut.poses());
    let figure = channel_figure(&channel.name, channel.unit.as_deref(), course, times, poses);
    let name = format!("Plot: {} over time", channel.name);
    let height = ui.available_height().max(80.0);
    small::show(ui, &name, &figure, height, Selection::default());
}
