//! Bad input is refused with one sentence that names the place.

use std::path::Path;

use tautline_session::read_dataset;
use tautline_validation::support::bad_input_cases::{BadInput, bad_inputs, write_good_dataset};

#[test]
fn the_good_dataset_is_good() {
    let folder = tempfile::tempdir().expect("a folder");
    write_good_dataset(folder.path()).expect("written");
    let read = read_dataset(folder.path()).expect("a dataset");
    assert_eq!(read.dataset.measurements.len(), 3);
    assert!(read.notices.is_empty(), "{:?}", read.notices);
}

#[test]
fn every_bad_input_is_refused_in_one_sentence() {
    let cases = bad_inputs();
    assert!(cases.len() >= 70, "only {} cases", cases.len());
    let folder = tempfile::tempdir().expect("a folder");
    let failures: Vec<String> = cases
        .iter()
        .enumerate()
        .filter_map(|(k, case)| failure(case, &folder.path().join(k.to_string())))
        .collect();
    assert!(failures.is_empty(), "\n{}", failures.join("\n"));
}

fn failure(case: &BadInput, folder: &Path) -> Option<String> {
    case.write(folder).expect(case.name);
    let Err(error) = read_dataset(folder) else {
        return Some(format!("{}: accepted", case.name));
    };
    let text = error.to_string();
    let named = text.starts_with(&folder.display().to_string());
    let one_line = !text.chars().any(char::is_control) && text.len() < 400;
    let missing = case.expected.iter().find(|part| !text.contains(**part));
    if named && one_line && missing.is_none() {
        return None;
    }
    Some(format!("{}: \"{text}\" lacks {missing:?}", case.name))
}
