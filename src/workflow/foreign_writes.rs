//! Values of the controller that others write while poses are measured.
//!
//! The values are read before a run moves and at its end. The session keeps the first ones until then, so that a run that was
//! killed, or lost its controller, is compared with the values of the next connection. Poses between two readings that differ
//! are marked: they were commanded with one geometry and measured with another, and it is unknown which pose had which.

use tautline_link::ParameterInfo;
use tautline_session::{ForeignWrite, NamedValue, RunValues, Session, Timestamp, ValueChange};

use crate::adjusting::held;
use crate::wording::{count, list};

/// Number of changed values that a sentence names.
const NAMED: usize = 3;

/// The values that a controller holds.
#[derive(Debug, Clone, Copy)]
pub struct ValuesRead<'a> {
    /// Name of the controller: values of different ones are not compared.
    pub controller: &'a str,
    /// Its parameters.
    pub parameters: &'a [ParameterInfo],
}

/// Records the values at the start of a run. A run that was not compared yet ends; the sentence names the values that changed
/// during it.
pub fn begin_run(session: &mut Session, read: ValuesRead<'_>, now: Timestamp) -> Option<String> {
    let before = end_run(session, read, None, now);
    session.begin_run(read.controller, held(read.parameters), now);
    before
}

/// Compares the values with those at the start of the run that was not compared yet, if there is one. If values changed, marks
/// its poses, together with the `pending` pose that the session does not have yet; the sentence names the changes.
pub fn end_run(
    session: &mut Session,
    read: ValuesRead<'_>,
    pending: Option<i64>,
    now: Timestamp,
) -> Option<String> {
    let RunValues {
        time,
        values,
        measured,
        ..
    } = session.take_run(read.controller)?;
    let changes = changes(&values, read.parameters);
    if changes.is_empty() {
        return None;
    }
    let labels = session.measurements.labels.iter().copied();
    let write = ForeignWrite {
        begun: time,
        noticed: now,
        poses: labels
            .filter(|label| !measured.contains(label))
            .chain(pending)
            .collect(),
        changes,
    };
    let text = in_words(&write.poses, &write.changes);
    session.add_foreign_write(write);
    Some(text)
}

/// Changes of controller values by others while poses were measured that are used, one sentence each.
#[must_use]
pub fn sentences(session: &Session) -> Vec<String> {
    let writes = session.foreign_writes();
    writes
        .map(|write| in_words(&session.marked_poses(write), &write.changes))
        .collect()
}

/// The changed values; two values that are not numbers count as equal.
fn changes(before: &[NamedValue], now: &[ParameterInfo]) -> Vec<ValueChange> {
    let is_same = |a: f64, b: f64| a == b || !a.is_finite() && !b.is_finite();
    let pairs = before.iter().filter_map(|held| {
        let known = now.iter().find(|parameter| parameter.name == held.name)?;
        Some((held, known))
    });
    pairs
        .filter(|(held, known)| !is_same(held.value, known.value))
        .map(|(held, known)| ValueChange {
            name: held.name.clone(),
            unit: known.unit.to_owned(),
            before: held.value,
            after: known.value,
        })
        .collect()
}

fn in_words(poses: &[i64], changes: &[ValueChange]) -> String {
    let mut values: Vec<String> = changes
        .iter()
        .take(NAMED)
        .map(|change| {
            let unit = match change.unit.as_str() {
                "1" => String::new(),
                unit => format!(" {unit}"),
            };
            format!(
                "{} from {} to {}{unit}",
                change.name, change.before, change.after
            )
        })
        .collect();
    if let Some(others @ 1..) = changes.len().checked_sub(NAMED) {
        values.push(count(others, "other"));
    }
    let values = list(&values);
    let somebody = "somebody else changed values of the controller";
    match poses {
        [] => {
            format!("While the robot was measured, before a pose was stored, {somebody}: {values}.")
        }
        poses => format!(
            "While {} measured, {somebody}: {values}. Measure again what was measured, or leave these poses out.",
            poses_were(poses)
        ),
    }
}

/// `poses 1 to 4, 7 and home were`.
fn poses_were(poses: &[i64]) -> String {
    let mut sorted: Vec<i64> = poses.iter().copied().filter(|label| *label != 0).collect();
    sorted.sort_unstable();
    sorted.dedup();
    let mut runs: Vec<[i64; 2]> = Vec::new();
    for label in sorted {
        match runs.last_mut() {
            Some([_, last]) if *last + 1 == label => *last = label,
            _ => runs.push([label, label]),
        }
    }
    let is_one = matches!(runs[..], [[first, last]] if first == last);
    let has_home = poses.contains(&0);
    let mut names: Vec<String> = runs
        .into_iter()
        .map(|[first, last]| match last - first {
            0 => first.to_string(),
            1 => format!("{first}, {last}"),
            _ => format!("{first} to {last}"),
        })
        .collect();
    let noun = match (names.is_empty(), is_one) {
        (true, _) => return "home was".to_owned(),
        (_, true) => "pose",
        (_, false) => "poses",
    };
    names.extend(has_home.then(|| "home".to_owned()));
    let verb = if is_one && !has_home { "was" } else { "were" };
    format!("{noun} {} {verb}", list(&names))
}

#[cfg(test)]
mod tests {
    use tautline_link::parameters::parameters_of;

    use super::*;
    use crate::diagnosis::samples::dataset;

    fn measured() -> Session {
        let data = dataset();
        let mut session = Session::new("test", data.robot, time(0));
        session.measurements = data.measurements;
        session
    }

    fn plc(parameters: &[ParameterInfo]) -> ValuesRead<'_> {
        ValuesRead {
            controller: "PLC",
            parameters,
        }
    }

    fn time(minute: i64) -> Timestamp {
        Timestamp::from_unix_seconds(60 * minute)
    }

    #[test]
    fn poses_of_a_run_are_marked_if_a_value_changed_meanwhile() {
        let mut session = measured();
        let mut parameters = parameters_of(&session.robot);
        let all = session.measurements.labels.clone();
        let last = *all.last().expect("a pose");
        // Only the last pose belongs to the run; the others are of an earlier one.
        let whole = session.measurements.clone();
        let before: Vec<usize> = (0..all.len() - 1).collect();
        session.measurements = whole.select(&before);
        assert_eq!(begin_run(&mut session, plc(&parameters), time(1)), None);
        session.measurements = whole;
        parameters[2].value += 0.01;
        parameters[5].value = f64::NAN;
        let text = end_run(&mut session, plc(&parameters), None, time(2)).expect("a sentence");
        assert!(
            text.starts_with(&format!("While pose {last} was measured, somebody else")),
            "{text}"
        );
        assert!(
            text.contains(&parameters[2].name) && text.contains(" to NaN m."),
            "{text}"
        );
        let writes: Vec<&ForeignWrite> = session.foreign_writes().collect();
        assert_eq!(writes.len(), 1);
        assert_eq!((writes[0].begun, writes[0].noticed), (time(1), time(2)));
        assert_eq!(writes[0].poses, [last]);
        assert_eq!(writes[0].changes.len(), 2);
        assert_eq!(sentences(&session), [text]);
        // Each run is compared once, and an excluded pose has no mark.
        assert_eq!(end_run(&mut session, plc(&[]), None, time(3)), None);
        session.exclude(last).expect("a pose");
        assert_eq!(sentences(&session), Vec::<String>::new());
    }

    #[test]
    fn nothing_is_marked_where_nothing_changed() {
        let mut session = measured();
        let mut parameters = parameters_of(&session.robot);
        parameters[0].value = f64::NAN;
        begin_run(&mut session, plc(&parameters), time(1));
        // A parameter that only one of the readings contains does not count as changed.
        parameters.pop();
        assert_eq!(end_run(&mut session, plc(&parameters), None, time(2)), None);
        assert_eq!(session.foreign_writes().count(), 0);
    }

    #[test]
    fn a_run_that_did_not_end_is_compared_when_the_next_one_begins() {
        let mut session = measured();
        let whole = std::mem::take(&mut session.measurements);
        let mut parameters = parameters_of(&session.robot);
        begin_run(&mut session, plc(&parameters), time(1));
        session.measurements = whole;
        for value in &mut parameters {
            value.value += 1.0;
        }
        let text = begin_run(&mut session, plc(&parameters), time(2)).expect("a sentence");
        let others = format!(" and {} others.", parameters.len() - NAMED);
        assert!(text.contains(&others), "{text}");
        assert_eq!(
            end_run(&mut session, plc(&parameters), None, time(3)),
            None,
            "the new run"
        );
    }

    #[test]
    fn values_of_different_controllers_are_not_compared() {
        let mut session = measured();
        let mut parameters = parameters_of(&session.robot);
        begin_run(&mut session, plc(&parameters), time(1));
        parameters[0].value += 1.0;
        let simulated = ValuesRead {
            controller: "simulated",
            parameters: &parameters,
        };
        assert_eq!(end_run(&mut session, simulated, None, time(2)), None);
        assert!(
            session.is_run_open("PLC"),
            "the first one is still to be compared"
        );
        assert!(end_run(&mut session, plc(&parameters), None, time(3)).is_some());
    }

    #[test]
    fn labels_are_listed_as_ranges() {
        for (poses, text) in [
            (&[0][..], "home was"),
            (&[3], "pose 3 was"),
            (&[0, 3], "pose 3 and home were"),
            (&[4, 3], "poses 3, 4 were"),
            (&[0, 1, 2, 3, 7], "poses 1 to 3, 7 and home were"),
        ] {
            assert_eq!(poses_were(poses), text);
        }
    }
}
