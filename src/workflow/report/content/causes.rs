//! The diagnosis of the model.

use tautline_core::diagnosis::{Finding, FoundParameter, Separation, Verdict};
use tautline_core::geometry::Pose;

use super::{NONE, number};
use crate::diagnosis::Diagnosed;
use crate::diagnosis::evidence::{Evidence, evidence};
use crate::diagnosis::gain;
use crate::report::document::{Block, Section, Table};
use crate::report::input::ReportInput;
use crate::report::plots;
use crate::wording::probability::{certainty, odds_between, percent};
use crate::wording::units::{self, significant, unit_of};
use crate::wording::{count, first_lower, list, odds, ratio, readings, sentence};

pub fn section(input: &ReportInput<'_>, diagnosed: &Diagnosed) -> Section {
    let diagnosis = &diagnosed.diagnosis;
    let mut section = Section::new("Model diagnosis");
    if input.diagnosis_outdated {
        section.lead(
            "This diagnosis was made before the last change of the data or the model: it describes the model as it was then.",
        );
    }
    for line in diagnosed.fit() {
        section.paragraph(line);
    }
    for (heading, sentences) in diagnosed.gross() {
        section.paragraph(format!("{heading}:"));
        section.list(sentences);
    }
    if diagnosis.findings.is_empty() {
        let is_extended = !input.diagnosis_outdated && !input.added_effects().is_empty();
        section.paragraph(match is_extended {
            true => "No cause was found besides the effects in the model.",
            false => "No cause was found.",
        });
    }
    let evidence = evidence(diagnosed);
    for (index, (finding, evidence)) in diagnosis.findings.iter().zip(&evidence).enumerate() {
        self::finding(diagnosed, index + 1, finding, &mut section);
        if let Some(Evidence {
            quantity,
            cable,
            figure,
        }) = evidence
        {
            let cable = diagnosed.cable(*cable);
            let name = sentence(&readings(*quantity, cable.as_deref()));
            section.note(format!(
                "{name} with all other causes in the model, and what this cause explains of them."
            ));
            section
                .blocks
                .push(Block::Plots(vec![plots::dependence(&name, figure)]));
        }
    }
    section.list(diagnosed.remaining_lines());
    if let Some(text) = diagnosed.possible_line() {
        section.note(text);
    }
    section.note(format!(
        "Probability of a false finding if the model is right: {}.",
        significant(diagnosed.alpha, 2)
    ));
    section
}

fn finding(diagnosed: &Diagnosed, number: usize, finding: &Finding, section: &mut Section) {
    section.heading(match finding.verdict() {
        Verdict::Unknown => format!("What remains: {}", first_lower(&diagnosed.heading(finding))),
        Verdict::Named | Verdict::Ambiguous => format!("{number}. {}", diagnosed.heading(finding)),
    });
    section.paragraph(finding.sentence.clone());
    match finding.verdict() {
        Verdict::Named => {}
        Verdict::Ambiguous if finding.is_list() => section.table(candidates(diagnosed, finding)),
        Verdict::Ambiguous => {
            section.paragraph(diagnosed.otherwise(finding).unwrap_or_default());
        }
        Verdict::Unknown => section.paragraph(
            "The residuals depend on something that no effect in the catalogue explains. Its cause is unknown.",
        ),
    }
    section.facts(facts(diagnosed, finding));
    if let Some((heading, text)) = diagnosed.decides(finding) {
        section.paragraph(format!("{heading}: {text}"));
    }
    if let Some(separation) = finding.separation.as_ref().filter(|s| !s.poses.is_empty()) {
        section.table(poses(separation));
    }
}

/// The mutually exclusive causes with their probabilities.
fn candidates(diagnosed: &Diagnosed, finding: &Finding) -> Table {
    let mut table = Table::new(
        "Causes that these data cannot separate; the values below are those of the first"
            .to_owned(),
        1,
        &["Cause", "Probability", "Odds of the first against it"],
    );
    let own = percent(finding.probability);
    table.push([diagnosed.subject(&finding.subject), own, NONE.to_owned()]);
    for other in &finding.alternatives {
        let odds = odds_between(finding.probability, other.probability);
        table.push([
            diagnosed.subject(&other.subject),
            percent(other.probability),
            odds,
        ]);
    }
    table
}

fn facts(diagnosed: &Diagnosed, finding: &Finding) -> Vec<(String, String)> {
    let mut facts = Vec::new();
    let mut add = |name: &str, value: String| facts.push((name.to_owned(), value));
    if let Some(size) = diagnosed.size(&finding.parameters) {
        add("Size", size);
    }
    let intervals = intervals(&finding.parameters);
    if !intervals.is_empty() {
        add("95 % interval", list(&intervals));
    }
    add("Probability", sentence(&certainty(finding.probability)));
    add("Evidence", sentence(&chance(finding)));
    if let Some(text) = runner_up(diagnosed, finding) {
        add("Runner-up", text);
    }
    if finding.verdict() != Verdict::Unknown {
        add("Improvement", sentence(&gain(&finding.gain)));
        if let Some(text) = gain_interval(finding) {
            add("Improvement, 95 % interval", sentence(&text));
        }
    }
    if !finding.advice.is_empty() {
        add("What to do", finding.advice.clone());
    }
    if let Some(check) = finding.cause().and_then(|cause| cause.effect().check()) {
        add("What to check", check.to_owned());
    }
    facts
}

/// 95 % intervals of the fitted parameters.
fn intervals(parameters: &[FoundParameter]) -> Vec<String> {
    let interval = |p: &FoundParameter| {
        let sd = p.sd.filter(|sd| sd.is_finite() && *sd > 0.0)?;
        Some(units::interval(p.value, sd, unit_of(p.name, p.unit)))
    };
    parameters.iter().filter_map(interval).collect()
}

fn chance(finding: &Finding) -> String {
    let evidence = &finding.evidence;
    format!(
        "without this cause, evidence as strong would occur {}, corrected for {} tests (chi-square falls by {:.1} for {} more)",
        odds(evidence.p_value),
        evidence.questions,
        evidence.delta_chi2,
        count(evidence.parameters, "parameter")
    )
}

/// The next best cause.
fn runner_up(diagnosed: &Diagnosed, finding: &Finding) -> Option<String> {
    let rival = finding.evidence.ranking.get(1)?;
    let own = finding.evidence.ranking.first()?;
    Some(format!(
        "{}: chi-square falls by {:.1} instead of {:.1}, held-out residuals are {} instead of {} times the expected noise",
        diagnosed.title(&rival.cause),
        rival.delta_chi2,
        own.delta_chi2,
        ratio(rival.holdout),
        ratio(own.holdout)
    ))
}

fn gain_interval(finding: &Finding) -> Option<String> {
    let gain = &finding.gain;
    let [from, to] = gain.interval;
    let is_known = gain.poses_held_out > 0 && from.is_finite() && to.is_finite();
    is_known.then(|| {
        format!(
            "held-out residuals fall by {} to {} times the expected noise",
            number(from, 2),
            number(to, 2)
        )
    })
}

fn poses(separation: &Separation) -> Table {
    let caption = format!(
        "Poses to measure, the most informative first; with them the chi-squares of the two best causes are expected to differ by {:.0}. Angles: rotation vector in the base frame",
        separation.expected_delta_chi2
    );
    let mm = |pose: &Pose, axis: usize| number(1e3 * pose.position[axis], 0);
    let angle =
        |pose: &Pose, axis: usize| number(pose.orientation.scaled_axis()[axis].to_degrees(), 1);
    Table::of(caption, 1, separation.poses.iter().enumerate()).columns(&[
        ("Pose", &|(index, _)| (index + 1).to_string()),
        ("x mm", &|(_, pose)| mm(pose, 0)),
        ("y mm", &|(_, pose)| mm(pose, 1)),
        ("z mm", &|(_, pose)| mm(pose, 2)),
        ("rx °", &|(_, pose)| angle(pose, 0)),
        ("ry °", &|(_, pose)| angle(pose, 1)),
        ("rz °", &|(_, pose)| angle(pose, 2)),
    ])
}
