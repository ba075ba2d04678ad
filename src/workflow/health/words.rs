//! A health check in words.

use tautline_core::history::Jump;

use super::{Baseline, Checked, HealthVerdict};
use crate::history::{date, part_name, size_of_jump};
use crate::wording::list;
use crate::wording::probability::percent;
use crate::wording::sentence;
use crate::wording::units::{mm, quantity};

/// Largest number of alternatives that are listed for a change.
const LISTED: usize = 4;

/// Result of a check in sentences, the verdict first.
#[must_use]
pub fn verdict_sentences(baseline: &Baseline, checked: &Checked) -> Vec<String> {
    let since = baseline.time.map_or_else(
        || format!("in {}", baseline.name),
        |time| format!("on {}", date(time)),
    );
    let history = &checked.found.history;
    let mut told = match (checked.verdict, checked.certain()) {
        (HealthVerdict::Unchanged, _) => vec![format!("As {since}: no change is visible.")],
        (HealthVerdict::Changed, Some(jump)) => {
            vec![format!("Something changed: {}.", changed(checked, jump))]
        }
        (HealthVerdict::Changed, None) if !checked.is_explained() => vec![
            "Something changed, and no part that may have changed explains the readings: check the sensors, then measure \
             the poses of a calibration and ask the model doctor."
                .to_owned(),
        ],
        (HealthVerdict::Changed, None) => vec![format!(
            "Something changed ({}), but these poses do not tell what: {}.",
            percent(1.0 - history.unchanged),
            list(&change_names(checked))
        )],
        (HealthVerdict::Undecided, _) if !checked.is_explained() => vec![
            "Not decidable: the model does not explain the motion in this recording. Measure poses at rest.".to_owned(),
        ],
        (HealthVerdict::Undecided, _) => vec![format!(
            "Not decidable with these poses: perhaps {}.",
            list(&change_names(checked))
        )],
    };
    told.extend(more(checked));
    told.extend(detectable(checked));
    told
}

/// The changes that are possible, each with its probability.
fn change_names(checked: &Checked) -> Vec<String> {
    let mut jumps: Vec<&Jump> = checked.found.history.jumps.iter().collect();
    jumps.sort_by(|a, b| b.probability.total_cmp(&a.probability));
    let shown = jumps.into_iter().take(LISTED);
    shown.map(|jump| changed(checked, jump)).collect()
}

/// A change with its size and probability: `pulley of cable-3 by 4.1 mm (...) (98 %)`.
fn changed(checked: &Checked, jump: &Jump) -> String {
    let history = &checked.found.history;
    let robot = &checked.identification.dataset.robot;
    let (part, axes) = (&history.parts[jump.part], &history.axes[jump.part]);
    format!(
        "{} by {}, {}",
        part_name(part, robot),
        size_of_jump(jump, part, axes),
        percent(jump.probability)
    )
}

fn more(checked: &Checked) -> Option<String> {
    let poses: Vec<String> = (checked.more_poses.iter())
        .map(|pose| {
            let [x, y, z] = <[f64; 3]>::from(pose.position).map(|metres| mm(metres, 0));
            format!("({x}, {y}, {z}) mm")
        })
        .collect();
    (!poses.is_empty()).then(|| format!("Measure besides: {}.", list(&poses)))
}

/// Sentence on the smallest detectable moves, of the best and of the worst pulley.
fn detectable(checked: &Checked) -> Option<String> {
    let moves = checked.detectable.iter();
    let mut seen: Vec<f64> = moves.clone().filter_map(|one| one.move_m).collect();
    seen.sort_by(f64::total_cmp);
    let (least, most) = (seen.first()?, seen.last()?);
    let unseen: Vec<&str> = moves
        .filter(|one| one.move_m.is_none())
        .map(|one| one.cable.as_str())
        .collect();
    let but = match unseen.is_empty() {
        true => String::new(),
        false => format!("; no move of the pulley of {} would be", list(&unseen)),
    };
    Some(sentence(&format!(
        "a move of a pulley by {} to {} would be found with 95 % probability, by which pulley it is{but}.",
        quantity(*least, "m"),
        quantity(*most, "m")
    )))
}
