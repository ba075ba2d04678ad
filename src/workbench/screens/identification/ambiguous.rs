//! Card of causes that the data cannot distinguish.

use egui::{Align, Layout, Ui};
use tautline_core::diagnosis::{Separation, Subject};

use super::card::Card;
use super::rows::{heads, row};
use super::{Panel, card, gain};
use crate::model::findings;
use crate::theme::{self, GRID};
use crate::widgets::{Cell, UiExt, probability};
use tautline_workflow::diagnosis::Diagnosed;
use tautline_workflow::wording::count;
use tautline_workflow::wording::units::{fixed, mm};

/// Smallest width of a cause beside others (points).
const NARROWEST: f32 = 150.0;

/// Draws the body of the card.
pub fn body(ui: &mut Ui, panel: &mut Panel<'_>, card: &Card<'_>) {
    let (diagnosed, finding, number) = (card.diagnosed, card.finding, card.number);
    let others = finding.alternatives.iter();
    let causes: Vec<(&Subject, f64)> = std::iter::once((&finding.subject, finding.probability))
        .chain(others.map(|other| (&other.subject, other.probability)))
        .collect();
    let title = format!("{}. One of {} causes", number + 1, causes.len());
    card::title(ui, &title);
    ui.doubtful("These data cannot distinguish the causes below, which exclude each other: each changes the readings at these poses in nearly the same way.");
    if ui.available_width() < NARROWEST * causes.len() as f32 {
        for (subject, probable) in causes {
            ui.separator();
            alternative(ui, panel, diagnosed, subject, probable);
        }
        ui.separator();
    } else {
        ui.columns(causes.len(), |columns| {
            for (ui, (subject, probable)) in columns.iter_mut().zip(causes) {
                ui.with_layout(Layout::top_down(Align::Min), |ui| {
                    alternative(ui, panel, diagnosed, subject, probable);
                });
            }
        });
    }
    ui.muted(&card::evidence(finding));
    gain::show(ui, &finding.gain);
    if let Some((heading, text)) = diagnosed.decides(finding) {
        ui.add_space(GRID);
        ui.muted(heading);
        ui.wrapped(&text);
    }
    if let Some(separation) = &finding.separation {
        separating(ui, panel, separation);
    }
    ui.muted("Sizes and geometry are valid only if the chosen cause is the right one.");
}

fn alternative(
    ui: &mut Ui,
    panel: &mut Panel<'_>,
    diagnosed: &Diagnosed,
    subject: &Subject,
    probable: f64,
) {
    let robot = diagnosed.robot();
    let name = diagnosed.subject(subject);
    ui.wrapped(egui::RichText::new(&name).font(theme::strong(13.0)));
    probability(ui, &name, probable);
    let Some(cause) = subject.cause() else {
        ui.wrapped("No known cause explains this error. There is nothing to add to the model.");
        return;
    };
    let mut said: Vec<String> = Vec::new();
    let mut checks: Vec<String> = Vec::new();
    for bound in &cause.instances {
        for (list, text) in [
            (&mut said, bound.cause(robot)),
            (&mut checks, bound.workshop(robot)),
        ] {
            if !list.contains(&text) {
                list.push(text);
            }
        }
    }
    ui.wrapped(said.join(" "));
    card::advice(ui, &checks.join(" "));
    card::actions(ui, panel, diagnosed, cause, &name);
}

fn separating(ui: &mut Ui, panel: &mut Panel<'_>, separation: &Separation) {
    if separation.poses.is_empty() {
        return;
    }
    ui.add_space(GRID);
    ui.muted("Poses that would tell them apart");
    let shares = [2.0, 3.0, 3.0, 3.0, 2.5, 2.5, 2.5];
    heads(
        ui,
        &shares,
        &["Pose", "x mm", "y mm", "z mm", "rx °", "ry °", "rz °"],
    );
    for (index, pose) in separation.poses.iter().enumerate() {
        let position = <[f64; 3]>::from(pose.position).map(|v| mm(v, 0));
        let rotation = <[f64; 3]>::from(pose.orientation.scaled_axis());
        let rotation = rotation.map(|angle| fixed(angle.to_degrees(), 1));
        let texts: Vec<String> = position.into_iter().chain(rotation).collect();
        let name = format!("Separating pose {}: {}", index + 1, texts.join(", "));
        let mut cells = vec![Cell::new((index + 1).to_string()).coloured(theme::of(ui).muted)];
        cells.extend(texts.into_iter().map(Cell::new));
        row(ui, &shares, &cells, None, &name);
    }
    ui.muted("rx, ry, rz: rotation vector about the axes of the base");
    if findings::are_planned(panel.open, &separation.poses) {
        ui.good("These poses are in the plan: measure them in phase 3, then identify again.");
        return;
    }
    let add = ui.button("Add these poses to the plan");
    let tip = format!(
        "{} more to measure; can be undone",
        count(separation.poses.len(), "pose")
    );
    if add.on_hover_text(tip).clicked() {
        let planning = findings::planning(panel.open, &separation.poses);
        panel.outbox.send(planning);
    }
}
