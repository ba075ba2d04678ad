//! `adjust` is killed at random moments: in the end the controller holds all old or all new values, as reported.

use std::path::Path;
use std::time::{Duration, Instant};

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use serde_json::Value;
use tautline_session::{NamedValue, Outcome};

use super::{beside, killed, session};
use crate::commands::program::{Folder, tautline};

const KILLS: usize = 50;

/// Values of a simulated controller according to the files alone.
fn held(file: &str) -> Vec<NamedValue> {
    match std::fs::read_to_string(format!("{file}.controller")) {
        Ok(text) => {
            let document: Value = serde_json::from_str(&text).expect("a whole document");
            serde_json::from_value(document["values"].clone()).expect("values")
        }
        Err(_) => session(file).controller,
    }
}

/// Old and new values of the parameters that an adjustment changes.
struct Values(Vec<(String, f64, f64)>);

impl Values {
    fn of(file: &str) -> Self {
        let adjustments = session(file);
        let changes = adjustments.adjustments()[0].changes.iter();
        let values = changes.map(|c| (c.name.clone(), c.before, c.after));
        Self(values.collect())
    }

    /// "old", "new" or "mixed".
    fn word(&self, held: &[NamedValue]) -> &'static str {
        let value = |name: &str| held.iter().find(|h| h.name == name).map(|h| h.value);
        let are = |which: fn(&(String, f64, f64)) -> f64| {
            let mut values = self.0.iter();
            values.all(|entry| value(&entry.0) == Some(which(entry)))
        };
        // A controller that was never written to has the values of its description.
        if held.is_empty() || are(|entry| entry.1) {
            "old"
        } else if are(|entry| entry.2) {
            "new"
        } else {
            "mixed"
        }
    }
}

#[test]
fn after_a_killed_adjustment_the_next_call_restores_old_or_new_values() {
    let folder = Folder::new();
    let measured = folder.join("measured.json");
    let new = [
        "measure",
        &measured,
        "--controller",
        "sim",
        "--robot",
        "mini",
        "--arm",
    ];
    tautline(&new).succeeded();
    let copy = |name: &str| {
        let file = folder.join(name);
        std::fs::copy(&measured, &file).expect("copied");
        file
    };
    let whole = copy("whole.json");
    let begun = Instant::now();
    tautline(&["adjust", &whole, "--controller", "sim", "--arm"]).succeeded();
    let takes = begun.elapsed();
    let values = Values::of(&whole);
    assert_eq!(values.word(&held(&whole)), "new");
    let mut rng = ChaCha8Rng::seed_from_u64(6);
    let mut seen = Vec::new();
    for kill in 0..KILLS {
        let file = copy(&format!("{kill}.json"));
        let arguments = [
            "adjust",
            &file,
            "--controller",
            "sim",
            "--arm",
            "--json",
            "-",
        ];
        let after: Duration = takes.mul_f64(rng.random_range(0.0..1.0));
        let controller = format!("{file}.controller");
        let mut first_seen = None;
        let writes = |elapsed: Duration| {
            // Half of the kills wait for the first value, so that they fall between values on any machine.
            if kill % 2 == 0 {
                return elapsed >= after;
            }
            if Path::new(&controller).exists() {
                first_seen.get_or_insert(elapsed);
            }
            first_seen.is_some_and(|first| elapsed >= first + after.mul_f64(0.2))
        };
        killed(&arguments, writes);
        let found = values.word(&held(&file));
        let interrupted = session(&file)
            .adjustments()
            .last()
            .map(|a| a.outcome.clone());
        let begun = interrupted == Some(Outcome::Begun);
        assert!(
            begun || found != "mixed",
            "kill {kill}: mixed values without a record"
        );
        let answer = tautline(&arguments);
        let expected = if begun { 4 } else { 0 };
        assert_eq!(
            answer.code,
            Some(expected),
            "kill {kill}: {}",
            answer.stderr
        );
        let answer = answer.json();
        if begun {
            assert_eq!(answer["interrupted"], found, "kill {kill}");
            seen.push(found);
        } else {
            assert_eq!(answer["interrupted"], Value::Null, "kill {kill}");
        }
        let now = values.word(&held(&file));
        let last = session(&file)
            .adjustments()
            .last()
            .map(|a| a.outcome.clone());
        let expected = match (&answer["outcome"], &last) {
            (outcome, Some(Outcome::Written)) if outcome == "written" => "new",
            (outcome, Some(Outcome::RolledBack)) if outcome == "rolled_back" => "old",
            (outcome, Some(Outcome::Failed(_))) if outcome == "failed" => "old",
            (outcome, Some(Outcome::Written)) if outcome == "nothing_to_write" => "new",
            other => panic!("kill {kill}: {other:?}"),
        };
        assert_eq!(now, expected, "kill {kill}");
        assert_eq!(session(&file).audit(), [], "kill {kill}");
        assert_eq!(
            beside(&file),
            Vec::<std::path::PathBuf>::new(),
            "kill {kill}"
        );
    }
    let count = |word: &str| seen.iter().filter(|found| **found == word).count();
    println!(
        "{} of {KILLS} kills interrupted the writing: {} found old, {} new, {} mixed values",
        seen.len(),
        count("old"),
        count("new"),
        count("mixed")
    );
}
