//! `--check-against` and `--detect`: the poses of a health check.

use std::path::Path;

use anyhow::Result;
use tautline_core::planning::{Goal, Plan, PlanOptions};
use tautline_core::robot::Robot;
use tautline_workflow::health::{Baseline, Checked};
use tautline_workflow::planning::DetectionDocument;

use crate::failure::BadInput;
use crate::input;
use crate::output::say;
use crate::table::{self, mm};

/// Faults that a check has to detect.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Detect {
    /// A pulley that moved by this distance (m).
    Move(f64),
    /// All faults, detected and separated from each other.
    Faults,
}

/// Parses the value of `--detect`.
pub fn detect(text: &str) -> Result<Detect> {
    let number = text.strip_suffix("mm");
    let number = number.map(|number| number.trim().parse::<f64>());
    match (text, number) {
        ("faults", _) => Ok(Detect::Faults),
        (_, Some(Ok(millimetres))) if millimetres > 0.0 && millimetres.is_finite() => {
            Ok(Detect::Move(1e-3 * millimetres))
        }
        _ => Err(BadInput::new(format!(
            "--detect: found \"{text}\", expected a length such as 2mm, or faults"
        ))),
    }
}

/// The poses of a check with the predicted detection of faults.
pub struct CheckPlan {
    pub robot: Robot,
    pub planned: Plan,
    pub detection: Vec<DetectionDocument>,
}

/// Plans the poses of a check against a calibration.
pub fn plan(path: &Path, options: PlanOptions<'_>, detect: Option<Detect>) -> Result<CheckPlan> {
    let (session, time) = input::dated_session(path)?;
    let failed =
        |error: &dyn std::fmt::Display| BadInput::new(format!("{}: {error}", path.display()));
    let baseline = Baseline::new(&session, time).map_err(|e| failed(&e))?;
    let goal = match detect {
        Some(Detect::Faults) => Goal::Faults,
        Some(Detect::Move(_)) | None => options.goal,
    };
    let planned = baseline.plan(&PlanOptions { goal, ..options });
    let planned = planned.map_err(|e| failed(&e))?;
    let expected = baseline.check(&planned.dataset, None);
    let expected = expected.map_err(|e| failed(&e))?;
    Ok(CheckPlan {
        detection: detection(&expected, detect),
        robot: baseline.identification.dataset.robot.clone(),
        planned,
    })
}

fn detection(expected: &Checked, detect: Option<Detect>) -> Vec<DetectionDocument> {
    let moves = expected.detectable.iter();
    let found = moves.map(|one| DetectionDocument {
        cable: one.cable.clone(),
        move_m: one.move_m,
        probability: match detect {
            Some(Detect::Move(move_m)) => expected.detection(&one.cable, move_m),
            Some(Detect::Faults) | None => None,
        },
    });
    found.collect()
}

/// Prints the faults that the check would detect.
pub fn print(detection: &[DetectionDocument]) {
    let is_asked = detection.iter().any(|one| one.probability.is_some());
    let mut columns = vec!["Pulley of", "found with 95 % mm"];
    if is_asked {
        columns.push("probability of the move asked for");
    }
    let mut rows = table::numbers(&columns);
    for one in detection {
        let found = one.move_m.map_or_else(|| "none".to_owned(), |m| mm(m, 1));
        let mut row = vec![one.cable.clone(), found];
        row.extend(
            one.probability
                .filter(|_| is_asked)
                .map(|p| format!("{p:.2}")),
        );
        table::push(&mut rows, &row);
    }
    say!("{rows}");
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_to_be_detected_is_a_length_or_faults() {
        for (text, expected) in [
            ("2mm", Detect::Move(0.002)),
            ("1.5 mm", Detect::Move(0.0015)),
            ("faults", Detect::Faults),
        ] {
            assert_eq!(detect(text).expect("read"), expected);
        }
        for wrong in ["2", "-1mm", "mm", "nanmm", "fault"] {
            let error = detect(wrong).expect_err("refused").to_string();
            let expected =
                format!("--detect: found \"{wrong}\", expected a length such as 2mm, or faults");
            assert_eq!(error, expected);
        }
    }
}
