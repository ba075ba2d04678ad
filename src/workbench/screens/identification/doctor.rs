//! Model doctor: diagnosis of the model.

use std::sync::Arc;

use egui::{CollapsingHeader, Ui};

use super::{Panel, card, discrepancy, effects, results};
use crate::model::command::{DIAGNOSING, FileCommand, IdentificationCommand};
use crate::model::findings;
use crate::theme::GRID;
use crate::widgets::{UiExt, Verdict, probability};
use tautline_workflow::diagnosis::{Diagnosed, adequacy};
use tautline_workflow::wording::{p_value, sentence};

pub fn show(ui: &mut Ui, panel: &mut Panel<'_>) {
    ui.muted("Tests which known faults of cables, pulleys, winches and sensors explain the residuals, and validates each on held-out poses.");
    let settings = &panel.open.session().settings.identification;
    let has_effects = !settings.effects.is_empty();
    if let Some(fit) = panel
        .open
        .fit()
        .filter(|_| panel.open.fit_is_current() && has_effects)
    {
        results::adequacy(ui, panel, fit);
    }
    ui.add_space(GRID);
    let mut running = panel.model.tasks.running().iter();
    if let Some(task) = running.find(|task| task.title == DIAGNOSING) {
        ui.horizontal(|ui| {
            ui.spinner();
            let text = sentence(&task.progress().text);
            ui.wrapped(format!("{text} …"));
        });
        if ui.button("Cancel diagnosis").clicked() {
            panel.outbox.send(IdentificationCommand::Stop);
        }
    } else {
        ask(ui, panel);
    }
    if let Some(diagnosed) = panel.open.diagnosis().cloned() {
        answer(ui, panel, &diagnosed);
    }
    if has_effects {
        ui.section("Effects in the model");
        effects::show(ui, panel);
    }
}

/// Button that starts the diagnosis.
pub fn ask(ui: &mut Ui, panel: &mut Panel<'_>) {
    if ui.button("Diagnose model").clicked() {
        panel.outbox.send(IdentificationCommand::Diagnose);
    }
}

fn answer(ui: &mut Ui, panel: &mut Panel<'_>, diagnosed: &Arc<Diagnosed>) {
    if !panel.open.diagnosis_is_current() {
        ui.doubtful("The model or the data have changed since the last diagnosis. Diagnose again.");
        CollapsingHeader::new("The last diagnosis")
            .id_salt(Arc::as_ptr(diagnosed))
            .show(ui, |ui| found(ui, panel, diagnosed));
        return;
    }
    found(ui, panel, diagnosed);
}

/// Verdict and findings of a diagnosis.
fn found(ui: &mut Ui, panel: &mut Panel<'_>, diagnosed: &Diagnosed) {
    let diagnosis = &diagnosed.diagnosis;
    if panel.open.diagnosis_is_current() && !panel.open.is_model_diagnosed() {
        ui.muted("This diagnosis led to the present model. Diagnose again to check it.");
    } else {
        judgement(ui, diagnosed);
    }
    for (heading, sentences) in diagnosed.gross() {
        ui.section(heading);
        // The last sentence is advice.
        let [found @ .., advice] = &sentences[..] else {
            continue;
        };
        for line in found {
            ui.bad(line);
        }
        ui.muted(advice);
    }
    let may_correct = panel.open.diagnosis_is_current() && !diagnosed.mistakes.is_empty();
    if may_correct && ui.button("Correct a copy of the session").clicked() {
        panel.outbox.send(FileCommand::OpenCorrected);
    }
    for (heading, is_cause) in [("Causes", true), ("What remains", false)] {
        let findings = diagnosis.findings.iter().enumerate();
        let mut shown = findings
            .filter(|(_, f)| f.cause().is_some() == is_cause)
            .peekable();
        if shown.peek().is_some() {
            ui.section(heading);
        }
        for (number, _) in shown {
            card::show(ui, panel, diagnosed, number);
        }
    }
    rest(ui, panel, diagnosed);
    discrepancy::show(ui, panel, diagnosed);
}

/// Verdict on the fit of the model.
fn judgement(ui: &mut Ui, diagnosed: &Diagnosed) {
    let diagnosis = &diagnosed.diagnosis;
    let kind = match findings::explain(diagnosed) {
        true if diagnosis.base.adequate && diagnosed.gross().is_empty() => Verdict::Good,
        true => Verdict::Doubtful,
        false => Verdict::Bad,
    };
    ui.verdict(kind, &sentence(&diagnosed.judgement("not")));
    for (index, line) in diagnosed.fit().iter().enumerate() {
        let test = diagnosis.base.global;
        let tip = format!(
            "Chi-square {:.1} for {:.0} degrees of freedom, {}; a false alarm was allowed {:.1} times in 100.",
            test.chi2,
            test.degrees_of_freedom,
            p_value(test.p_value),
            100.0 * diagnosed.alpha
        );
        let label = ui.muted(line);
        if index == 0 && *line == adequacy(&diagnosis.base) {
            label.on_hover_text(tip);
        }
    }
}

/// Noise, remaining discrepancies, and faults that the data cannot show.
fn rest(ui: &mut Ui, panel: &mut Panel<'_>, diagnosed: &Diagnosed) {
    let diagnosis = &diagnosed.diagnosis;
    if !diagnosis.noise.is_empty() {
        ui.section("Noise");
    }
    for noise in &diagnosis.noise {
        ui.doubtful(&diagnosed.noise_line(noise));
    }
    if !diagnosis.findings.is_empty() {
        for line in diagnosed.remaining_lines().iter().take(3) {
            ui.muted(line);
        }
    }
    possible(ui, diagnosed);
    let lines = diagnosed.invisible_lines();
    let [heading, lines @ ..] = &lines[..] else {
        return;
    };
    ui.add_space(2.0 * GRID);
    let clean = diagnosis.findings.is_empty();
    let header = CollapsingHeader::new("Not detectable with these poses")
        .open(Some(panel.memory.show_invisible))
        .show(ui, |ui| {
            ui.muted(heading);
            for line in lines {
                ui.wrapped(line.trim());
            }
        });
    if header.header_response.clicked() {
        panel.memory.show_invisible = !panel.memory.show_invisible;
    }
    if clean && !panel.memory.show_invisible {
        ui.muted("No finding does not mean no fault: the list says from which size on each fault would have been detected.");
    }
}

/// Possible causes without proof, on request.
fn possible(ui: &mut Ui, diagnosed: &Diagnosed) {
    let causes = &diagnosed.diagnosis.possible;
    if causes.is_empty() {
        return;
    }
    ui.add_space(2.0 * GRID);
    CollapsingHeader::new("Other possible causes").show(ui, |ui| {
        ui.muted("These data neither establish these causes nor rule them out:");
        for cause in causes {
            let name = diagnosed.title(&cause.cause);
            ui.wrapped(&name);
            probability(ui, &name, cause.probability);
        }
    });
}
