//! A finding in the report.

use tautline_core::diagnosis::{Finding, Separation, Verdict};

use super::Diagnosed;
use crate::table;
use tautline_workflow::diagnosis::gain;
use tautline_workflow::wording::probability::percent;

/// Indentation of the lines below a heading.
pub const INDENT: &str = "   ";
/// Length of a bar in characters.
const BAR: usize = 20;

/// The errors beside the causes, with advice.
pub fn remaining(errors: &[&Finding]) -> Vec<String> {
    let sentences = errors.iter().map(|error| &error.sentence);
    let mut lines: Vec<String> = Vec::new();
    for line in sentences.chain(errors.iter().map(|error| &error.advice)) {
        let line = format!("{INDENT}{line}");
        if !lines.contains(&line) {
            lines.push(line);
        }
    }
    lines
}

/// Heading and body of a cause.
pub fn lines(diagnosed: &Diagnosed, number: usize, finding: &Finding) -> Vec<String> {
    let mut body = vec![finding.sentence.clone()];
    if finding.verdict() == Verdict::Ambiguous {
        body.extend(diagnosed.otherwise(finding));
    }
    if finding.is_list() {
        body.extend(bars(diagnosed, finding));
    }
    let size = diagnosed.size(&finding.parameters);
    body.extend(size.map(|size| format!("Size: {size}")));
    body.push(format!("Improvement: {}", gain(&finding.gain)));
    if !finding.advice.is_empty() {
        body.push(format!("What to do: {}", finding.advice));
    }
    if let Some((heading, text)) = diagnosed.decides(finding) {
        body.push(format!("{heading}: {text}"));
    }
    if let Some(separation) = &finding.separation {
        body.extend(separating(separation));
    }
    let mut lines = vec![format!("{number}. {}", diagnosed.heading(finding))];
    lines.extend(body.into_iter().map(|line| format!("{INDENT}{line}")));
    lines
}

/// Probabilities as bars, one line per cause.
fn bars(diagnosed: &Diagnosed, finding: &Finding) -> Vec<String> {
    let own = (finding.probability, &finding.subject);
    let others = finding.alternatives.iter();
    let all = std::iter::once(own).chain(others.map(|other| (other.probability, &other.subject)));
    all.map(|(probability, subject)| {
        let filled = (probability * BAR as f64).round() as usize;
        let bar = "#".repeat(filled.min(BAR));
        let number = percent(probability);
        format!("[{bar:.<BAR$}] {number:>5}  {}", diagnosed.subject(subject))
    })
    .collect()
}

/// Poses that would separate the causes.
fn separating(separation: &Separation) -> Vec<String> {
    if separation.poses.is_empty() {
        return Vec::new();
    }
    let mut lines = vec!["Poses that would distinguish them:".to_owned()];
    let mut poses = table::numbers(&["Pose", "x mm", "y mm", "z mm", "rx °", "ry °", "rz °"]);
    for (index, pose) in separation.poses.iter().enumerate() {
        let position: [f64; 3] = pose.position.into();
        let rotation: [f64; 3] = pose.orientation.scaled_axis().into();
        let mut cells = vec![(index + 1).to_string()];
        cells.extend(position.map(|v| table::mm(v, 0)));
        cells.extend(rotation.map(|angle| format!("{:.1}", angle.to_degrees())));
        table::push(&mut poses, &cells);
    }
    lines.extend(
        poses
            .to_string()
            .lines()
            .map(|row| row.trim_end().to_owned()),
    );
    lines.push("rx, ry, rz: rotation vector in the base frame".to_owned());
    lines
}
