//! What changes between two files of records.

use super::{Found, Outcome, Plan};
use crate::tables::study::Records;

/// A data set that gets another answer, before and after.
#[derive(Debug, Clone, PartialEq)]
pub struct Change {
    /// The plan of the data set.
    pub plan: Plan,
    /// Result for each hidden effect.
    pub found: [Vec<Found>; 2],
    /// Findings without their probabilities.
    pub said: [String; 2],
}

/// The data sets of both files that get another answer, as they read before and after, and the number of data sets that both have.
#[must_use]
pub fn changes(
    before: &Records<Plan, Outcome>,
    after: &Records<Plan, Outcome>,
) -> (Vec<Change>, usize) {
    let both = before
        .outcomes()
        .filter_map(|outcome| Some((outcome, after.of(&outcome.plan)?)));
    let changed = both.clone().filter_map(|(before, now)| {
        let change = Change {
            plan: before.plan,
            found: [before.found.clone(), now.found.clone()],
            said: [before.answer(), now.answer()],
        };
        let is_same = change.found[0] == change.found[1] && change.said[0] == change.said[1];
        (!is_same).then_some(change)
    });
    (changed.collect(), both.count())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tables::hidden::{Circumstances, Stratum, Wanted, draw, run};
    use crate::tables::study::results;

    #[test]
    fn recorded_outcomes_are_read_back_and_compared() {
        let folder = tempfile::tempdir().unwrap();
        let [path, other] = ["outcomes", "other"].map(|name| folder.path().join(name));
        let plan = Plan {
            robot: "planar",
            seed: 1,
            wanted: Wanted::One("winch_scale", Stratum::Typical),
            circumstances: Circumstances::HeavyTails,
        };
        let outcome = run(&plan, draw(&plan).unwrap().unwrap()).unwrap();
        let recorded = |path, outcome: &Outcome| {
            let records = Records::open(path).unwrap();
            results(vec![plan], &records, |_| Ok(Some(outcome.clone())));
            Records::open(path).unwrap()
        };
        let again = recorded(&path, &outcome);
        let known: &Outcome = again.of(&plan).unwrap();
        assert_eq!(known.drawn, outcome.drawn);
        assert_eq!(known.said, outcome.said);
        assert_eq!(known.parameters, outcome.parameters);
        assert_eq!(changes(&again, &again), (Vec::new(), 1));

        let silent = Outcome {
            found: vec![Found::Missed],
            said: Vec::new(),
            ..outcome
        };
        let (changes, both) = changes(&again, &recorded(&other, &silent));
        assert_eq!((changes.len(), both), (1, 1));
        assert_eq!(changes[0].found[1], [Found::Missed]);
        assert!(changes[0].said[0].contains("winch_scale") && changes[0].said[1].is_empty());
    }
}
