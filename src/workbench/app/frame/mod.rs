//! The frame of the window: menus, phase rail, status, and the screen between them.

mod dialogs;
mod log;
mod palette;
mod rail;
mod save_as;
mod status;
mod top;

use egui::{CentralPanel, Frame, Margin, Panel, Ui};

pub use dialogs::{Answer, broken};

use super::screen::Screen;
use super::state::State;
use super::theme::{self, GRID};
use crate::{screens, views};

/// Draws the whole window.
pub fn show(ui: &mut Ui, state: &mut State) {
    top::shortcuts(ui, state);
    let (fill, ground) = (theme::of(ui).panel, theme::of(ui).ground);
    let centre = || CentralPanel::no_frame().frame(Frame::new().fill(ground));
    let bar = Frame::new()
        .fill(fill)
        .inner_margin(Margin::symmetric(2 * GRID as i8, GRID as i8));
    Panel::top("top")
        .frame(bar)
        .show(ui, |ui| top::show(ui, state));
    Panel::bottom("status")
        .frame(bar)
        .show(ui, |ui| status::show(ui, state));
    match state.screen {
        Screen::Start => {
            centre().show(ui, |ui| screens::start::show(ui, state));
        }
        Screen::Compare => {
            centre().show(ui, |ui| screens::compare::show(ui, state));
        }
        Screen::Phase(step) => {
            let side = Frame::new()
                .fill(fill)
                .inner_margin(Margin::same(3 * GRID as i8));
            let rail = Panel::left("rail")
                .frame(side)
                .resizable(false)
                .exact_size(208.0);
            rail.show(ui, |ui| rail::show(ui, state));
            let panel = Panel::right("phase")
                .frame(side)
                .default_size(400.0)
                .size_range(340.0..=640.0);
            panel.show(ui, |ui| screens::phase(ui, state, step));
            let plots = Panel::bottom("plots")
                .frame(side)
                .default_size(250.0)
                .size_range(140.0..=600.0);
            plots.show(ui, |ui| views::plots::show(ui, state));
            centre().show(ui, |ui| views::robot_3d::show(ui, state));
        }
    }
    palette::show(ui, state);
    log::show(ui, state);
    dialogs::show(ui, state);
    save_as::show(ui, state);
}
