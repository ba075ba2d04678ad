//! The description of the robot: platform, cables, home pose, instruments and their noise.

pub(crate) mod cables;
mod common;
pub(in crate::screens::modeling) mod field;
pub(crate) mod identity;
mod instruments;

use egui::Ui;

use self::cables::FocusedCell;
use self::identity::Drafts;
use crate::screens::bench_panel::Bench;
use crate::widgets::UiExt;

pub(super) fn show(
    ui: &mut Ui,
    bench: &mut Bench<'_>,
    focused: &mut FocusedCell,
    drafts: &mut Drafts,
) {
    ui.muted("Every number is checked as it is typed, and the 3D view follows. What is not known yet may be rough: identification finds the pulleys.");
    identity::show(ui, bench, drafts);
    common::platform(ui, bench);
    cables::show(ui, bench, focused);
    common::home(ui, bench);
    instruments::show(ui, bench);
}
