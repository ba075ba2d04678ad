//! The human-readable report of a diagnosis.

mod finding;
mod tables;
#[cfg(test)]
mod tests;

use tautline_workflow::wording::sampling_sentence;

use super::Diagnosed;

/// Largest number of remaining dependences listed without `--explain`.
const REMAINING_SHOWN: usize = 5;

/// The report; `explain` adds the statistics behind the verdicts.
pub fn text(diagnosed: &Diagnosed, explain: bool) -> String {
    let diagnosis = &diagnosed.diagnosis;
    let mut lines = vec![diagnosed.headline()];
    lines.extend(sampling_sentence(&diagnosed.dataset.measurements));
    lines.extend(diagnosed.fit());
    for (heading, sentences) in diagnosed.gross() {
        lines.extend([String::new(), format!("{heading}:")]);
        let indented = sentences
            .iter()
            .map(|line| format!("{}{line}", finding::INDENT));
        lines.extend(indented);
    }
    let (causes, left): (Vec<_>, Vec<_>) = diagnosis
        .findings
        .iter()
        .partition(|finding| finding.cause().is_some());
    for (index, finding) in causes.into_iter().enumerate() {
        lines.push(String::new());
        lines.extend(finding::lines(diagnosed, index + 1, finding));
    }
    if !left.is_empty() {
        lines.extend([String::new(), "What remains:".to_owned()]);
    }
    lines.extend(finding::remaining(&left));
    lines.extend(section(
        diagnosis.noise.iter().map(|n| diagnosed.noise_line(n)),
    ));
    lines.extend(section(remaining_lines(diagnosed, explain).into_iter()));
    lines.extend(section(diagnosed.invisible_lines().into_iter()));
    if diagnosis.findings.iter().any(|f| !f.parameters.is_empty()) {
        lines.extend(section(std::iter::once(
            "± is one standard deviation; the true value lies within two of them with 95 % probability."
                .to_owned(),
        )));
    }
    if explain {
        lines.extend(section(diagnosed.possible_line().into_iter()));
        lines.extend(tables::lines(diagnosed));
    }
    lines.join("\n")
}

/// The lines after an empty one; nothing if there are none.
fn section(lines: impl Iterator<Item = String>) -> Vec<String> {
    let mut lines = lines.peekable();
    match lines.peek() {
        None => Vec::new(),
        Some(_) => std::iter::once(String::new()).chain(lines).collect(),
    }
}

fn remaining_lines(diagnosed: &Diagnosed, all: bool) -> Vec<String> {
    let mut lines = diagnosed.remaining_lines();
    let shown = if all { lines.len() } else { REMAINING_SHOWN };
    let found = lines.len();
    lines.truncate(shown);
    if let Some(more @ 1..) = found.checked_sub(shown) {
        lines.push(format!("... and {more} more (--explain lists them)"));
    }
    lines
}
