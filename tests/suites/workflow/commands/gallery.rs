//! The gallery of imports: its files, and the commands that docs/GALLERY.md shows for them.

use std::fs;
use std::path::Path;

use tautline_session::read_dataset;
use tautline_validation::generators::gallery;
use tautline_validation::support::program::{command, run};

use super::program::Folder;

const PAGE: &str = include_str!("../../../../docs/GALLERY.md");
/// Rounding of the revolutions in the files (rev), at most half a unit of 0.01 degrees or a count of 1/4096.
const ROUNDED_REV: f64 = 2e-4;

/// The files as they are written now, and as they begin on the page.
#[test]
fn files_of_the_gallery_are_what_its_generator_makes_and_what_the_page_shows() {
    let made = Folder::new();
    gallery::write(made.path()).expect("files");
    let files = fs::read_dir(made.path()).expect("a folder");
    let mut count = 0;
    for file in files {
        let name = file.expect("a file").file_name();
        let [new, kept] =
            [made.path(), &gallery::folder()].map(|folder| fs::read(folder.join(&name)));
        let new = new.expect("made");
        assert!(
            kept.is_ok_and(|kept| kept == new),
            "{}: validation gallery",
            name.display()
        );
        if name == "robot.json" {
            continue;
        }
        count += 1;
        let text = match new.strip_prefix(b"\xff\xfe") {
            Some(rest) => {
                let (words, _) = rest.as_chunks::<2>();
                let words: Vec<u16> = words.iter().map(|word| u16::from_le_bytes(*word)).collect();
                String::from_utf16_lossy(&words)
            }
            None => String::from_utf8_lossy(&new).into_owned(),
        };
        let first = text.lines().next().expect("a line").trim_end();
        let shown: String = first.chars().take(60).collect();
        assert!(
            PAGE.contains(shown.trim_end()),
            "{} begins with {shown:?}",
            name.display()
        );
        let is_named = |line: &str| {
            line.split(' ')
                .any(|word| Path::new(word) == Path::new(&name))
        };
        assert!(
            PAGE.lines().any(is_named),
            "no command for {}",
            name.display()
        );
    }
    assert!(count >= 20, "{count} files");
}

#[test]
fn every_command_of_the_gallery_imports_the_run() {
    let dataset = gallery::dataset().expect("a run");
    let data = &dataset.measurements;
    let folder = Folder::new();
    for (number, line) in PAGE
        .lines()
        .filter(|line| line.starts_with("tautline import "))
        .enumerate()
    {
        let out = folder.join(&format!("out-{number}"));
        // Quoted words have no blanks besides those between name and unit.
        let words = line.replace(" [rev", "\u{a0}[rev").replace("FOLDER", &out);
        let words = words.split(' ').skip(1);
        let words: Vec<String> = words
            .map(|word| word.trim_matches('"').replace('\u{a0}', " "))
            .collect();
        let words: Vec<&str> = words.iter().map(String::as_str).collect();
        run(command(&words).current_dir(gallery::folder())).succeeded();
        let read = read_dataset(Path::new(&out)).unwrap_or_else(|error| panic!("{line}: {error}"));
        let found = &read.dataset.measurements;
        assert_eq!(found.len(), data.len(), "{line}");
        for row in 0..data.len() {
            for cable in 0..8 {
                let [a, b] = [found, data].map(|data| data.revolutions.get(row, cable));
                assert!(
                    (a - b).abs() < ROUNDED_REV,
                    "{line}, row {row}, cable {}: {a} {b}",
                    cable + 1
                );
            }
        }
    }
}
