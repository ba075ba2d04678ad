//! The sample sessions equal the output of their recipes, and the statements of their READMEs are true.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

use serde_json::Value;
use tautline_core::diagnosis::{Finding, Verdict};
use tautline_core::estimation::Control;
use tautline_core::history::{CERTAIN, RobotPart};
use tautline_session::{Session, Timestamp, read_session, write_session};
use tautline_validation::generators::sessions::{Made, RECIPES, Recipe, folder, make};
use tautline_workflow::comparison::{LEVEL, compare_identifications, identify_to_compare};
use tautline_workflow::history::{RobotRecord, Tolerance};
use tautline_workflow::samples;

fn recipe(file: &str) -> &'static Recipe {
    let mut recipes = RECIPES.iter();
    recipes
        .find(|recipe| recipe.file == file)
        .expect("a recipe")
}

fn made(file: &str) -> Made {
    make(recipe(file)).expect("a session")
}

fn readme(of: &str) -> String {
    let text = fs::read_to_string(folder().join(of).join("README.md")).expect("a README.md");
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}

fn read(file: &str) -> Session {
    let read = read_session(&folder().join(file)).expect("a session");
    assert!(read.notices.is_empty(), "{file}: {:?}", read.notices);
    read.value
}

/// Effect and cables of the findings, in their order.
fn named(made: &Made) -> Vec<(&'static str, Vec<usize>)> {
    let findings = &made
        .diagnosed
        .as_ref()
        .expect("a diagnosis")
        .diagnosis
        .findings;
    let causes = findings.iter().filter_map(Finding::cause);
    causes
        .map(|cause| (cause.effect().id(), cause.cables()))
        .collect()
}

/// The sentences of the diagnosis are quoted literally in the README.
fn assert_quoted(made: &Made, text: &str) {
    let diagnosed = made.diagnosed.as_ref().expect("a diagnosis");
    for finding in &diagnosed.diagnosis.findings {
        assert!(text.contains(&finding.sentence), "{}", finding.sentence);
    }
}

/// A session without the digits of fits that did not converge: they depend on how the processor rounds.
fn reproducible(session: &[u8]) -> Value {
    let mut session: Value = serde_json::from_slice(session).expect("JSON");
    let results = session["results"].as_array_mut().expect("results");
    for document in results.iter_mut().map(|result| &mut result["document"]) {
        if document["converged"] == false {
            *document = Value::Null;
        }
    }
    session
}

#[test]
fn files_are_what_the_recipes_make() {
    let fresh = tempfile::tempdir().expect("a folder");
    for recipe in &RECIPES {
        let path = fresh.path().join("session.json");
        write_session(&path, &make(recipe).expect("a session").session).expect("written");
        let file = folder().join(recipe.file);
        let [new, old] = [&path, &file].map(|path| fs::read(path).expect("read"));
        let is_made = reproducible(&new) == reproducible(&old);
        assert!(is_made, "{} is not what is made now", recipe.file);
        assert!(old.len() < 400_000, "{}: {} bytes", recipe.file, old.len());
    }
}

#[test]
fn every_sample_is_listed_and_its_results_are_up_to_date() {
    let listed = samples::find(&[folder().to_owned()]);
    let paths: Vec<PathBuf> = listed.iter().map(|sample| sample.session.clone()).collect();
    let mut expected = BTreeSet::new();
    for recipe in &RECIPES {
        let path = folder().join(Path::new(recipe.file));
        // The sessions of a record are listed as one.
        let record = path
            .parent()
            .filter(|folder| folder.ends_with("year-of-mini"));
        expected.insert(record.map_or(path.clone(), Path::to_owned));
        let session = read(recipe.file);
        assert!(!session.results().is_empty());
        for result in session.results() {
            assert_eq!(result.basis, Some(session.basis()), "{}", recipe.file);
        }
    }
    assert_eq!(paths.into_iter().collect::<BTreeSet<_>>(), expected);
    assert!(listed.iter().all(|sample| !sample.shows.is_empty()));
}

#[test]
fn nothing_is_found_where_nothing_is_wrong() {
    let made = made("clean-mini/session.json");
    assert!(named(&made).is_empty());
    let truth = &made.session.simulator.as_ref().expect("a truth").truth;
    for (cable, found) in truth.cables.iter().zip(&made.fit.model.cables) {
        let [is, says] = [cable, found].map(|c| nalgebra::Vector3::from(c.pulley.entry_point_m));
        assert!(
            (is - says).norm() < 0.006,
            "{}: {:?}",
            cable.name,
            is - says
        );
    }
}

#[test]
fn a_drum_of_different_diameter_is_named() {
    let made = made("mini-winch-scale/session.json");
    assert_eq!(named(&made), [("winch_scale", vec![2])]);
    assert_quoted(&made, &readme("mini-winch-scale"));
}

#[test]
fn creep_and_slip_are_named() {
    let made = made("hall-creep-and-slip/session.json");
    assert_eq!(
        named(&made),
        [("cable_creep", vec![]), ("cable_slip", vec![5])]
    );
    let findings = &made
        .diagnosed
        .as_ref()
        .expect("a diagnosis")
        .diagnosis
        .findings;
    assert!(findings.iter().all(|f| f.verdict() == Verdict::Named));
    assert_quoted(&made, &readme("hall-creep-and-slip"));
}

#[test]
fn sag_that_is_not_modelled_is_named() {
    let made = made("suspended-sag/session.json");
    assert_eq!(named(&made), [("cable_sag", vec![])]);
    assert_quoted(&made, &readme("suspended-sag"));
}

#[test]
fn a_tracker_that_was_touched_is_named() {
    let made = made("tracker-touched/session.json");
    assert_eq!(named(&made), [("tracker_moved", vec![])]);
    assert_quoted(&made, &readme("tracker-touched"));
}

#[test]
fn the_pulley_that_was_moved_is_the_only_one() {
    let runs = ["before-after/before.json", "before-after/after.json"].map(read);
    let [before, after] = runs.map(|session| {
        identify_to_compare(&session, &mut |_| Control::Continue).expect("an identification")
    });
    let compared = compare_identifications([&before, &after], LEVEL).expect("a comparison");
    let moved: Vec<&str> = (compared.pulleys.iter())
        .filter(|pulley| pulley.moved)
        .map(|pulley| pulley.cable.as_str())
        .collect();
    assert_eq!(moved, ["cable-6"]);
    let relative = compared.pulleys[5].relative.expect("a displacement");
    let said = format!(
        "{:.1} ± {:.1} mm",
        1e3 * relative.length_m(),
        1e3 * relative.length_sd_m()
    );
    assert!(readme("before-after").contains(&said), "{said}");
}

#[test]
fn the_year_of_mini_shows_the_moved_pulley_and_the_new_cable_and_nothing_else() {
    let year = folder().join("year-of-mini");
    let record = RobotRecord::open(&year, Timestamp::from_unix_seconds(0), &mut |_, _| {
        Control::Continue
    });
    let record = record.expect("a record");
    assert!(record.notices.is_empty(), "{:?}", record.notices);
    let history = record
        .history(&year, Tolerance::default())
        .expect("a history")
        .history;
    let certain: Vec<_> = (history.jumps.iter())
        .filter(|jump| jump.probability >= CERTAIN)
        .map(|jump| (&history.parts[jump.part], jump.between))
        .collect();
    let [(pulley, june), (drum, september)] = certain[..] else {
        panic!("{certain:?}");
    };
    assert_eq!((pulley, june), (&RobotPart::Pulley(2), [2, 3]));
    assert!(matches!(drum, RobotPart::Effect { effect, .. } if effect == "winch_scale"));
    assert_eq!(september, [4, 5]);
    assert_eq!(history.evident_drifts().count(), 0);
}
