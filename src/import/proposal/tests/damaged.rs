use std::path::Path;

use tautline_channels::MemoryBudget;
use tautline_core::robot::presets;

use crate::{import, propose, read_source};

/// Every file of the fuzzing seeds with bytes changed, left out, doubled and cut off at random places.
#[test]
fn damaged_files_are_read_or_refused_in_one_sentence() {
    let folder =
        Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/suites/fuzz/seeds/foreign_file");
    let bench = tempfile::tempdir().expect("a folder");
    let damaged = bench.path().join("damaged");
    let place = format!("{}/", bench.path().display());
    let mut state = 1_u64;
    let mut random = |below: usize| {
        state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (state >> 33) as usize % below.max(1)
    };
    let robot = presets::find("planar").expect("a preset").robot;
    let budget = MemoryBudget::default();
    let mut read = 0;
    for entry in std::fs::read_dir(folder).expect("seeds") {
        let path = entry.expect("a seed").path();
        let whole = std::fs::read(&path).expect("a file");
        for _ in 0..500 {
            let mut bytes = whole.clone();
            for _ in 0..=random(4) {
                let at = random(bytes.len());
                match random(5) {
                    0 => bytes.truncate(at.max(1)),
                    1 if bytes.len() > 1 => drop(bytes.remove(at)),
                    2 => bytes.extend_from_within(at..),
                    3 => bytes[at] = random(256) as u8,
                    _ => bytes[at] ^= 1 << random(8),
                }
            }
            std::fs::write(&damaged, &bytes).expect("written");
            match read_source(&damaged) {
                Ok(source) => {
                    read += 1;
                    for series in &source.series {
                        assert!(
                            series
                                .channels
                                .iter()
                                .all(|channel| channel.values.len() == series.rows)
                        );
                        assert!(
                            series
                                .texts
                                .iter()
                                .all(|text| text.codes.len() == series.rows)
                        );
                    }
                    // Every file that was read has a proposal.
                    if read % 5 == 0 {
                        let sources = [source];
                        let (recipe, _) = propose(&sources, &robot);
                        let _ = import(&sources, &recipe, "recipe", &robot, &budget);
                    }
                }
                Err(error) => {
                    let sentence = error.to_string().replace(&place, "");
                    assert!(
                        sentence.starts_with("damaged") && !sentence.chars().any(char::is_control),
                        "{sentence}"
                    );
                    assert!(sentence.len() < 700, "{sentence}");
                }
            }
        }
    }
    assert!(read > 300, "only {read} were still readable");
}
