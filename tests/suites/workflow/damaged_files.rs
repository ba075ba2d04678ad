//! The program reads damaged files of every format within a limit that the system enforces; `validation -- damaged-files` takes more.

use tautline_validation::tables::damaged_files::study;

/// About as many files as there are seeds.
const FILES: usize = 60;

#[test]
fn the_program_reads_or_refuses_damaged_files_within_its_limit_of_memory() {
    let outcomes = study(FILES, 51_500).expect("files and a program");
    let mut files = 0;
    for (kind, outcome) in &outcomes {
        assert_eq!(outcome.faults, [""; 0], "{kind}");
        assert!(outcome.files > 0, "{kind}");
        files += outcome.read + outcome.refused;
    }
    assert_eq!((outcomes.len(), files), (6, FILES));
}
