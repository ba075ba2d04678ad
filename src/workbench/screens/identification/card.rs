//! A cause that was found.

use std::collections::BTreeSet;

use egui::{CornerRadius, Frame, Margin, RichText, Ui};
use egui_material_icons::icons;
use tautline_core::diagnosis::{Cause, Evidence, Finding, FoundParameter, Verdict as Sure};
use tautline_core::effect::{EffectSetting, UNKNOWN};

use super::{Panel, ambiguous, effects, gain};
use crate::model::command::ViewCommand;
use crate::model::edit::Edit;
use crate::theme::{self, GRID};
use crate::views::pulley_inspector;
use crate::widgets::{Verdict, icon_button, muted, probability, verdict};
use tautline_workflow::diagnosis::dependences::of_finding;
use tautline_workflow::documents::diagnosis::Diagnosed;
use tautline_workflow::wording::probability::{odds_between, percent};
use tautline_workflow::wording::units::{self, unit_of};
use tautline_workflow::wording::{count, odds};

/// Most cables of a finding whose pulleys can be inspected from there.
const INSPECTED: usize = 2;

/// Draws a finding.
pub fn show(ui: &mut Ui, panel: &mut Panel<'_>, diagnosed: &Diagnosed, number: usize) {
    let Some(finding) = diagnosed.diagnosis.findings.get(number) else {
        return;
    };
    ui.add_space(GRID);
    let frame = Frame::new()
        .fill(ui.visuals().faint_bg_color)
        .corner_radius(CornerRadius::same(6))
        .inner_margin(Margin::same(3 * GRID as i8));
    frame.show(ui, |ui| {
        ui.set_width(ui.available_width());
        ui.push_id(("finding", number), |ui| match finding.verdict {
            Sure::Ambiguous => ambiguous::body(ui, panel, diagnosed, finding, number),
            Sure::Named => named(ui, panel, diagnosed, finding, number),
            Sure::Unknown => unknown(ui, panel, diagnosed, finding, number),
        });
        ui.horizontal_wrapped(|ui| {
            dependence(ui, panel, diagnosed, (finding, number));
            inspect(ui, panel, diagnosed, finding);
        });
    });
}

/// A button that shows the residuals by which a finding was noticed: those of its cables, the strongest dependence first.
fn dependence(
    ui: &mut Ui,
    panel: &mut Panel<'_>,
    diagnosed: &Diagnosed,
    (finding, number): (&Finding, usize),
) {
    let found = &diagnosed.diagnosis.discrepancies;
    let Some(shown) = of_finding(found, finding).and_then(|index| found.get(index)) else {
        return;
    };
    let button = icon_button(ui, icons::ICON_SHOW_CHART, "Show its residuals", true);
    button.widget_info(|| {
        let name = format!("Show the residuals of finding {}", number + 1);
        egui::WidgetInfo::labeled(egui::Role::Button, true, name)
    });
    if button
        .on_hover_text(
            "Plots them against what they depend on, and colours the cables by their residuals",
        )
        .clicked()
    {
        let shown = ViewCommand::ShowDependence(shown.quantity, shown.cable, shown.variable);
        panel.outbox.send(shown);
    }
}

/// Buttons that show the pulleys of the cables that a finding names, where these are few.
fn inspect(ui: &mut Ui, panel: &mut Panel<'_>, diagnosed: &Diagnosed, finding: &Finding) {
    let bound = finding
        .cause
        .instances
        .iter()
        .filter(|bound| bound.targeted);
    let cables: BTreeSet<usize> = bound
        .flat_map(|bound| bound.cables.iter().copied())
        .collect();
    if cables.len() > INSPECTED {
        return;
    }
    for cable in cables {
        if let Some(name) = diagnosed.cable(Some(cable)) {
            pulley_inspector::button(ui, (cable, &name), panel.outbox);
        }
    }
}

/// The heading of a card.
pub fn title(ui: &mut Ui, text: &str) {
    ui.add(egui::Label::new(RichText::new(text).font(theme::strong(14.0))).wrap());
}

/// A paragraph.
pub fn paragraph(ui: &mut Ui, text: &str) {
    ui.add(egui::Label::new(text).wrap());
}

/// The effects of a cause as the model takes them.
pub fn settings(diagnosed: &Diagnosed, cause: &Cause) -> Vec<EffectSetting> {
    let robot = diagnosed.robot();
    cause
        .instances
        .iter()
        .map(|bound| bound.setting(robot))
        .collect()
}

fn named(
    ui: &mut Ui,
    panel: &mut Panel<'_>,
    diagnosed: &Diagnosed,
    finding: &Finding,
    number: usize,
) {
    let name = diagnosed.title(&finding.cause);
    title(ui, &format!("{}. {name}", number + 1));
    probable(ui, &name, finding);
    paragraph(ui, &finding.sentence);
    size(ui, diagnosed, finding);
    otherwise(ui, diagnosed, finding);
    gain::show(ui, &finding.gain);
    advice(ui, &finding.advice);
    add_or_remove(
        ui,
        panel,
        &settings(diagnosed, &finding.cause),
        &name,
        "Add to model",
        true,
    );
}

fn unknown(
    ui: &mut Ui,
    panel: &mut Panel<'_>,
    diagnosed: &Diagnosed,
    finding: &Finding,
    number: usize,
) {
    title(
        ui,
        &format!("{}. {}", number + 1, diagnosed.heading(finding)),
    );
    probable(ui, "an error of unknown cause", finding);
    paragraph(ui, &finding.sentence);
    verdict(
        ui,
        Verdict::Doubtful,
        "No cause is named: only which readings depend on which variable.",
    );
    gain::show(ui, &finding.gain);
    advice(ui, &finding.advice);
    muted(
        ui,
        "In the model it is a smooth curve that keeps the pattern out of the geometry; it does not say how the robot behaves outside the measured poses.",
    );
    let name = format!("an unexplained pattern{}", diagnosed.on(&finding.cause));
    let settings = settings(diagnosed, &finding.cause);
    add_or_remove(
        ui,
        panel,
        &settings,
        &name,
        "Add as unexplained pattern",
        false,
    );
}

/// The size with its interval.
pub fn size(ui: &mut Ui, diagnosed: &Diagnosed, finding: &Finding) {
    if finding.cause.effect().id() == UNKNOWN.id() {
        return;
    }
    let Some(size) = diagnosed.size(&finding.parameters) else {
        return;
    };
    let label = ui.add(egui::Label::new(format!("Size: {size}")).wrap());
    let is_only = finding.parameters.len() == 1;
    let intervals: Vec<_> = finding
        .parameters
        .iter()
        .filter_map(|p| interval(diagnosed, p, is_only))
        .collect();
    label.on_hover_text(intervals.join("\n"));
    if let ([one], true) = (&intervals[..], is_only) {
        muted(ui, one);
    }
}

/// The 95 % interval of a parameter, which has no name where it is the only one.
fn interval(diagnosed: &Diagnosed, parameter: &FoundParameter, is_only: bool) -> Option<String> {
    let sd = parameter.sd.filter(|sd| sd.is_finite())?;
    let of = diagnosed
        .cable(parameter.cable)
        .map_or_else(String::new, |cable| format!("{cable} "));
    let unit = unit_of(parameter.name, parameter.unit);
    let ends = units::interval(parameter.value, sd, unit);
    Some(match is_only {
        true => format!("95 % interval: {ends}"),
        false => {
            let name = parameter.name.replace('_', " ");
            format!("95 % interval of {of}{name}: {ends}")
        }
    })
}

/// The probability of a finding, with the numbers behind it on demand.
fn probable(ui: &mut Ui, what: &str, finding: &Finding) {
    probability(ui, what, finding.probability).on_hover_text(evidence(finding));
}

/// The numbers behind a finding.
pub fn evidence(finding: &Finding) -> String {
    let Evidence {
        delta_chi2,
        parameters,
        p_value,
        questions,
        ..
    } = &finding.evidence;
    let gain = format!(
        "Chi-square falls by {delta_chi2:.1} for {}",
        count(*parameters, "more parameter")
    );
    if !p_value.is_finite() {
        return format!("{gain}.");
    }
    format!(
        "{gain}; by chance alone this happens {} in {}.",
        odds(*p_value),
        count(*questions, "test")
    )
}

/// The likeliest of the causes that a named one leaves little room for.
fn otherwise(ui: &mut Ui, diagnosed: &Diagnosed, finding: &Finding) {
    let Some(next) = finding.alternatives.first() else {
        return;
    };
    let text = format!(
        "Otherwise: {}, {}; {} against it.",
        diagnosed.title(&next.cause),
        percent(next.probability),
        odds_between(finding.probability, next.probability)
    );
    let label = muted(ui, &text);
    if let [own, next, ..] = &finding.evidence.ranking[..] {
        label.on_hover_text(format!(
            "Chi-square falls by {:.1} with this cause and by {:.1} with the other.",
            own.delta_chi2, next.delta_chi2
        ));
    }
}

/// Check in the workshop.
pub fn advice(ui: &mut Ui, advice: &str) {
    if !advice.is_empty() {
        muted(ui, "Check in the workshop");
        paragraph(ui, advice);
    }
}

/// The button that adds a cause to the model, or takes it out again.
pub fn add_or_remove(
    ui: &mut Ui,
    panel: &mut Panel<'_>,
    settings: &[EffectSetting],
    name: &str,
    add: &str,
    is_next: bool,
) {
    ui.add_space(GRID);
    if effects::has(panel.open, settings) {
        verdict(ui, Verdict::Good, "In the model");
        let button = ui.button("Remove from model");
        button.widget_info(|| {
            let name = format!("Remove {name} from model");
            egui::WidgetInfo::labeled(egui::Role::Button, true, name)
        });
        if button.clicked() {
            panel.outbox.send(Edit::RemoveEffects(
                settings.to_vec(),
                effects::removing(name),
            ));
        }
        return;
    }
    let button = if is_next {
        crate::widgets::primary(ui, add, true)
    } else {
        ui.button(add)
    };
    button.widget_info(|| {
        let name = format!("{add}: {name}");
        egui::WidgetInfo::labeled(egui::Role::Button, true, name)
    });
    if button
        .on_hover_text("Adds it and identifies again; can be undone")
        .clicked()
    {
        panel
            .outbox
            .send(Edit::AddEffects(settings.to_vec(), effects::adding(name)));
    }
}
