//! Method, estimated parts of the model, and the running identification.

use egui::{Grid, RichText, Ui, pos2, vec2};
use tautline_session::Method;

use super::{Panel, effects};
use crate::model::command::{IDENTIFYING, IdentificationCommand};
use crate::model::edit::Edit;
use crate::theme::{self, GRID};
use crate::widgets::{UiExt, primary, radio};
use tautline_workflow::wording::ratio;

/// Name, sentence and explanation of each method.
const METHODS: [(Method, &str, &str, &str); 3] = [
    (
        Method::Joint,
        "Joint",
        "Lengths, tensions and force equilibrium together, each weighted by its noise. Recommended.",
        "Tensions are unknowns with the noise of their sensors; at every pose cable forces and weight are in equilibrium.",
    ),
    (
        Method::Simple,
        "Simple",
        "Lengths only; measured tensions are taken as exact. For a quick comparison.",
        "No force equilibrium: errors of the force sensors bias the geometry.",
    ),
    (
        Method::Published,
        "Published",
        "The joint method, and that of Jin et al. (2018) for comparison.",
        "Jin et al. 2018, doi:10.3390/s18072392: some coordinates count as given, nothing is weighted, there are no standard deviations.",
    ),
];

pub fn show(ui: &mut Ui, panel: &mut Panel<'_>) {
    ui.section("Method");
    method(ui, panel);
    ui.section("Effects in the model");
    effects::show(ui, panel);
    ui.add_space(2.0 * GRID);
    if panel.model.tasks.runs(IDENTIFYING) {
        running(ui, panel);
        return;
    }
    let next = !panel.open.fit_is_current();
    let clicked = if next {
        primary(ui, "Identify", true).clicked()
    } else {
        ui.button("Identify again").clicked()
    };
    if clicked {
        panel.outbox.send(IdentificationCommand::Identify);
    }
}

fn method(ui: &mut Ui, panel: &mut Panel<'_>) {
    let now = panel.open.session().settings.identification.method;
    ui.horizontal(|ui| {
        for (method, name, sentence, explanation) in METHODS {
            let tip = format!("{sentence} {explanation}");
            if radio(ui, method == now, name).on_hover_text(tip).clicked() && method != now {
                panel.outbox.send(Edit::SetMethod(method));
            }
        }
    });
    if let Some((_, _, sentence, _)) = METHODS.iter().find(|(method, ..)| *method == now) {
        ui.muted(sentence);
    }
}

/// Residuals of the running identification.
fn running(ui: &mut Ui, panel: &mut Panel<'_>) {
    let missed = panel.model.identification.progress.missed();
    ui.horizontal(|ui| {
        ui.spinner();
        let text = match missed.last() {
            None => "Preparing".to_owned(),
            Some(now) => format!(
                "Step {}: residuals {} times the expected noise",
                missed.len(),
                ratio(*now)
            ),
        };
        ui.label(text);
    });
    course(ui, &missed);
    if ui.button("Cancel identification").clicked() {
        panel.outbox.send(IdentificationCommand::Stop);
    }
}

/// Residuals after each step on a logarithmic scale, the latest at the right.
fn course(ui: &mut Ui, missed: &[f64]) {
    let palette = theme::of(ui);
    let (rect, _) = ui.allocate_exact_size(
        vec2(ui.available_width(), 10.0 * GRID),
        egui::Sense::hover(),
    );
    let logs = missed.iter().map(|m| m.max(1e-3).ln());
    let (low, high) = logs.clone().fold((0.0_f64, 1.0_f64), |(low, high), v| {
        (low.min(v), high.max(v))
    });
    let last = missed.len().saturating_sub(1).max(1) as f32;
    let at = |(k, v): (usize, f64)| {
        let (x, y) = (k as f32 / last, ((v - low) / (high - low)) as f32);
        pos2(
            rect.left() + x * rect.width(),
            rect.bottom() - y * rect.height(),
        )
    };
    let points: Vec<_> = logs.enumerate().map(at).collect();
    ui.painter()
        .line(points, egui::Stroke::new(1.5, palette.accent));
    ui.painter().hline(
        rect.x_range(),
        rect.bottom(),
        egui::Stroke::new(1.0, palette.line),
    );
}

/// Rows of a name and a right-aligned value.
pub fn pair(ui: &mut Ui, id: &str, lines: &[(String, String)]) {
    Grid::new(id)
        .num_columns(2)
        .spacing([4.0 * GRID, GRID])
        .show(ui, |ui| {
            let colour = theme::of(ui).muted;
            for (name, value) in lines {
                ui.label(RichText::new(name).color(colour));
                ui.label(value);
                ui.end_row();
            }
        });
}
