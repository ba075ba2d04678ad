//! Card of a finding.

use std::collections::BTreeSet;

use egui::{CollapsingHeader, CornerRadius, Frame, Margin, RichText, Ui};
use egui_material_icons::icons;
use tautline_core::diagnosis::{Cause, Evidence, Finding, FoundParameter, Verdict as Sure};
use tautline_core::effect::{EffectSetting, Search};

use super::check::back_to_import;
use super::{Panel, ambiguous, effects, gain, patterns};
use crate::model::command::{FileCommand, ViewCommand};
use crate::model::edit::{Edit, same_effect};
use crate::model::findings;
use crate::theme::{self, GRID};
use crate::views::plots::small;
use crate::views::pulley_inspector;
use crate::widgets::{UiExt, icon_button, named, probability};
use tautline_workflow::diagnosis::Diagnosed;
use tautline_workflow::diagnosis::dependences::of_finding;
use tautline_workflow::wording::probability::{odds_between, percent};
use tautline_workflow::wording::units::{self, unit_of};
use tautline_workflow::wording::{count, odds, readings, sentence};

/// Height of a plot (points).
const HEIGHT: f32 = 190.0;
/// Largest number of cables of a finding with buttons for their pulleys.
const INSPECTED: usize = 2;

/// Finding of a diagnosis, with its place among the findings.
pub struct Card<'a> {
    pub diagnosed: &'a Diagnosed,
    pub finding: &'a Finding,
    pub number: usize,
}

pub fn show(ui: &mut Ui, panel: &mut Panel<'_>, diagnosed: &Diagnosed, number: usize) {
    let Some(finding) = diagnosed.diagnosis.findings.get(number) else {
        return;
    };
    let is_unknown = finding.verdict() == Sure::Unknown;
    if is_unknown && largest_unknown(diagnosed) != Some(number) {
        return;
    }
    ui.add_space(GRID);
    let frame = Frame::new()
        .fill(ui.visuals().faint_bg_color)
        .corner_radius(CornerRadius::same(6))
        .inner_margin(Margin::same(3 * GRID as i8));
    let card = &Card {
        diagnosed,
        finding,
        number,
    };
    frame.show(ui, |ui| {
        ui.set_width(ui.available_width());
        ui.push_id(("finding", number), |ui| match finding.verdict() {
            Sure::Ambiguous if finding.is_list() => ambiguous::body(ui, panel, card),
            Sure::Ambiguous | Sure::Named => single(ui, panel, card),
            Sure::Unknown => unknown(ui, panel, card),
        });
        ui.horizontal_wrapped(|ui| {
            dependence(ui, panel, card);
            inspect(ui, panel, diagnosed, finding);
        });
    });
}

/// Button that shows the residuals of a finding: those of its cables, strongest dependence first.
fn dependence(ui: &mut Ui, panel: &mut Panel<'_>, card: &Card<'_>) {
    let found = &card.diagnosed.diagnosis.discrepancies;
    let Some(shown) = of_finding(found, card.finding).and_then(|index| found.get(index)) else {
        return;
    };
    let button = icon_button(ui, icons::ICON_SHOW_CHART, "Show its residuals", true);
    let name = format!("Show the residuals of finding {}", card.number + 1);
    if named(button, &name)
        .on_hover_text(
            "Plots them against what they depend on, and colours the cables by their residuals",
        )
        .clicked()
    {
        let shown = ViewCommand::ShowDependence(shown.quantity, shown.cable, shown.variable);
        panel.outbox.send(shown);
    }
}

/// Buttons that show the pulleys of the cables of a finding, if there are few.
fn inspect(ui: &mut Ui, panel: &mut Panel<'_>, diagnosed: &Diagnosed, finding: &Finding) {
    let cables: BTreeSet<usize> = finding.subject.cables().into_iter().collect();
    if cables.len() > INSPECTED {
        return;
    }
    for cable in cables {
        if let Some(name) = diagnosed.cable(Some(cable)) {
            pulley_inspector::button(ui, cable, &name, panel.outbox);
        }
    }
}

pub fn title(ui: &mut Ui, text: &str) {
    ui.wrapped(RichText::new(text).font(theme::strong(14.0)));
}

/// Card of a single cause: name, probability and size, then actions, then evidence.
fn single(ui: &mut Ui, panel: &mut Panel<'_>, card: &Card<'_>) {
    let (diagnosed, finding, number) = (card.diagnosed, card.finding, card.number);
    let name = diagnosed.subject(&finding.subject);
    let heading = match finding.verdict() {
        Sure::Ambiguous => diagnosed.heading(finding),
        _ => name.clone(),
    };
    title(ui, &format!("{}. {heading}", number + 1));
    probability(ui, &name, finding.probability).on_hover_text(evidence(finding));
    ui.wrapped(&finding.sentence);
    size(ui, diagnosed, finding);
    if let Some(otherwise) = diagnosed.otherwise(finding) {
        ui.wrapped(&otherwise);
    }
    if let Some(cause) = finding.cause() {
        actions(ui, panel, diagnosed, cause, &name);
    }
    shown_by(ui, panel, diagnosed, number);
    gain::show(ui, &finding.gain);
    otherwise(ui, diagnosed, finding);
    advice(ui, &finding.advice);
    if let Some((heading, text)) = diagnosed.decides(finding) {
        ui.muted(heading);
        ui.wrapped(&text);
    }
}

/// Card of an error without a known cause: its residuals and advice.
fn unknown(ui: &mut Ui, panel: &mut Panel<'_>, card: &Card<'_>) {
    let (diagnosed, finding, number) = (card.diagnosed, card.finding, card.number);
    title(ui, &diagnosed.heading(finding));
    ui.wrapped(&finding.sentence);
    ui.doubtful("No cause is named: only which readings depend on which variable.");
    shown_by(ui, panel, diagnosed, number);
    if !finding.advice.is_empty() {
        ui.muted("What helps");
        ui.wrapped(&finding.advice);
    }
    patterns::show(ui, panel);
    // One fault can affect several kinds of readings.
    let findings = diagnosed.diagnosis.findings.iter().enumerate();
    let is_other =
        |(index, other): &(usize, &Finding)| *index != number && other.verdict() == Sure::Unknown;
    let others: Vec<(usize, &Finding)> = findings.filter(is_other).collect();
    if others.is_empty() {
        return;
    }
    let title = format!("Other readings that show it ({})", others.len());
    CollapsingHeader::new(title).show(ui, |ui| {
        for (index, other) in others {
            ui.wrapped(&other.sentence);
            shown_by(ui, panel, diagnosed, index);
        }
    });
}

/// Largest error without a known cause; its card includes the others.
fn largest_unknown(diagnosed: &Diagnosed) -> Option<usize> {
    let findings = diagnosed.diagnosis.findings.iter().enumerate();
    let unknown = findings.filter(|(_, finding)| finding.verdict() == Sure::Unknown);
    let size = |finding: &Finding| finding.evidence.delta_chi2;
    let largest = unknown.max_by(|(_, a), (_, b)| size(a).total_cmp(&size(b)));
    largest.map(|(index, _)| index)
}

/// Plot of the readings in which a cause is most visible.
fn shown_by(ui: &mut Ui, panel: &mut Panel<'_>, diagnosed: &Diagnosed, number: usize) {
    let plots = panel.open.plotted_diagnosis();
    let evidence = plots.and_then(|plots| plots.evidence.get(number)?.as_ref());
    let Some(evidence) = evidence else {
        return;
    };
    let cable = diagnosed.cable(evidence.cable);
    let readings = sentence(&readings(evidence.quantity, cable.as_deref()));
    let against = evidence.figure.x.title().to_lowercase();
    ui.add_space(GRID);
    ui.muted(&format!(
        "{readings} against {against}, with all other causes in the model:"
    ));
    let name = format!(
        "Evidence of finding {}: {readings} against {against}",
        number + 1
    );
    let selection = panel.model.selection;
    let clicked = small::show(ui, &name, &evidence.figure, HEIGHT, selection);
    if let Some(selection) = clicked {
        panel.outbox.send(ViewCommand::Select(selection));
    }
}

pub fn size(ui: &mut Ui, diagnosed: &Diagnosed, finding: &Finding) {
    let Some(size) = diagnosed.size(&finding.parameters) else {
        return;
    };
    let label = ui.wrapped(format!("Size: {size}"));
    let is_only = finding.parameters.len() == 1;
    let intervals: Vec<_> = finding
        .parameters
        .iter()
        .filter_map(|p| interval(diagnosed, p, is_only))
        .collect();
    label.on_hover_text(intervals.join("\n"));
    if let ([one], true) = (&intervals[..], is_only) {
        ui.muted(one);
    }
}

/// 95 % interval of a parameter, named unless it is the only one.
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

/// Statistical evidence of a finding.
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

/// Likeliest alternative to a named cause.
fn otherwise(ui: &mut Ui, diagnosed: &Diagnosed, finding: &Finding) {
    let Some(next) = finding.alternatives.first() else {
        return;
    };
    let text = format!(
        "Otherwise: {}, {}; {} against it.",
        diagnosed.subject(&next.subject),
        percent(next.probability),
        odds_between(finding.probability, next.probability)
    );
    let label = ui.muted(&text);
    if let [own, next, ..] = &finding.evidence.ranking[..] {
        label.on_hover_text(format!(
            "Chi-square falls by {:.1} with this cause and by {:.1} with the other.",
            own.delta_chi2, next.delta_chi2
        ));
    }
}

/// Advice for the workshop.
pub fn advice(ui: &mut Ui, advice: &str) {
    if !advice.is_empty() {
        ui.muted("Check in the workshop");
        ui.wrapped(advice);
    }
}

/// Two ways to treat a cause, the right one for its kind first, each with its condition.
pub fn actions(
    ui: &mut Ui,
    panel: &mut Panel<'_>,
    diagnosed: &Diagnosed,
    cause: &Cause,
    name: &str,
) {
    let settings = diagnosed.settings(cause);
    ui.add_space(GRID);
    if findings::are_in_model(panel.open, &settings) {
        in_model(ui, panel, &settings, name);
        return;
    }
    if let Some((effects, reason)) = &panel.model.identification.not_added
        && settings
            .iter()
            .any(|one| effects.iter().any(|other| same_effect(one, other)))
    {
        ui.bad(&format!("Not added, because {reason}."));
    }
    if cause.effect().search() == Search::Exchange {
        back_to_import(ui, panel);
    }
    let is_damage = cause.effect().is_damage();
    let once = "Happened once: explains these readings only.";
    if is_damage && !cause.effect().is_wrong_reading() {
        let when = "Damage: repair it, then measure the same poses again. The present readings stay in their file.";
        repaired(ui, panel, &settings, name, when);
        add(ui, panel, settings, name, once);
    } else {
        let when = match is_damage {
            true => once,
            false => "Permanent: correct it in the controller.",
        };
        add(ui, panel, settings.clone(), name, when);
        let when = "Repair it, then measure the same poses again. The present readings stay in their file.";
        repaired(ui, panel, &settings, name, when);
    }
}

fn in_model(ui: &mut Ui, panel: &mut Panel<'_>, settings: &[EffectSetting], name: &str) {
    ui.good("In the model");
    let remove = ui.button("Remove from model");
    if named(remove, &format!("Remove {name} from model")).clicked() {
        let what = effects::removing(name);
        panel
            .outbox
            .send(Edit::RemoveEffects(settings.to_vec(), what));
    }
}

fn add(ui: &mut Ui, panel: &mut Panel<'_>, settings: Vec<EffectSetting>, name: &str, when: &str) {
    let add = ui.button("Add to model");
    if named(add, &format!("Add to model: {name}")).clicked() {
        let what = findings::adding_named(name);
        panel.outbox.send(Edit::AddEffects(settings, what));
    }
    ui.muted(when);
}

fn repaired(
    ui: &mut Ui,
    panel: &mut Panel<'_>,
    settings: &[EffectSetting],
    name: &str,
    when: &str,
) {
    let repaired = ui.button("Repaired: measure again");
    if named(repaired, &format!("Repaired: measure again: {name}")).clicked() {
        panel.outbox.send(FileCommand::NewSeries(settings.to_vec()));
    }
    ui.muted(when);
}
