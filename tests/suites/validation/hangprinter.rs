//! A real machine. Its data belong to another project and are expected in a folder next to the repository.

use std::path::{Path, PathBuf};

use tautline_core::diagnosis::Verdict;
use tautline_validation::tables::hangprinter::{opinion, study};
use tempfile::TempDir;

/// Expected from an independent fit of the whole problem: chi-square 1226, 650, 137; lengths with poses held
/// 6.49, 2.56, 2.20 mm, held out 7.0, 3.0, 2.5 mm; build-up -1.50e-4 +- 0.07e-4.
fn folder() -> Option<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../shared/data/hangprinter");
    if folder.exists() {
        return Some(folder);
    }
    println!("ABSENT: the Hangprinter data are not beside this repository; nothing was compared");
    None
}

#[test]
fn real_data_are_explained_by_drum_radii_and_build_up() {
    let Some(folder) = folder() else {
        return;
    };
    let rows = study(&folder).unwrap();
    let expected = [(1226.0, 6.49, 7.0), (650.0, 2.56, 3.0), (137.0, 2.20, 2.5)];
    for (row, (chi2, held, held_out)) in rows.iter().zip(expected) {
        // The reference has its own priors of the effects and one row more.
        assert!((row.chi2 - chi2).abs() < 5.0, "{row:?}");
        assert!((row.dof - 166.0).abs() < 0.5, "{row:?}");
        assert!((row.held_rms_m * 1e3 / held - 1.0).abs() < 0.15, "{row:?}");
        assert!(
            (row.held_out_rms_m * 1e3 / held_out - 1.0).abs() < 0.15,
            "{row:?}"
        );
    }
    let (growth, sd) = rows[2].growth.unwrap();
    assert!((growth + 1.50e-4).abs() < 0.05e-4, "{growth}");
    assert!((sd - 0.07e-4).abs() < 0.01e-4, "{sd}");
    assert!(rows[2].other_rms_m < 3e-3, "{:?}", rows[2]);
}

/// The data with revolutions of one motor missing at one pose.
fn with_an_empty_cell(folder: &Path) -> std::io::Result<TempDir> {
    let copy = tempfile::tempdir()?;
    for series in ["series1", "series2"] {
        std::fs::create_dir(copy.path().join(series))?;
        for file in ["robot.json", "poses.csv"] {
            let file = Path::new(series).join(file);
            std::fs::copy(folder.join(&file), copy.path().join(&file))?;
        }
    }
    let poses = copy.path().join("series2/poses.csv");
    let text = std::fs::read_to_string(&poses)?;
    let mut lines: Vec<Vec<&str>> = text.lines().map(|l| l.split(',').collect()).collect();
    lines[8][2] = "";
    let lines: Vec<String> = lines.into_iter().map(|cells| cells.join(",")).collect();
    std::fs::write(&poses, lines.join("\n"))?;
    Ok(copy)
}

#[test]
fn a_missing_reading_changes_neither_fit_nor_diagnosis_by_much() {
    let Some(folder) = folder() else {
        return;
    };
    let copy = with_an_empty_cell(&folder).unwrap();
    for (whole, holed) in study(&folder)
        .unwrap()
        .iter()
        .zip(study(copy.path()).unwrap())
    {
        assert_eq!(whole.dof - holed.dof, 1.0);
        // One reading less: it took no more than its own residual with it.
        assert!(
            (0.9..1.001).contains(&(holed.chi2 / whole.chi2)),
            "{holed:?}"
        );
    }
    let opinion = opinion(copy.path()).unwrap();
    for effect in ["winch_scale", "drum_growth"] {
        let mut findings = opinion.findings.iter();
        assert!(
            findings.any(|(_, causes)| causes[0].0.starts_with(effect)),
            "{opinion:?}"
        );
    }
}

/// The owner tuned the build-up by hand to -1.13e-4; independent fits gave -1.21e-4 and -1.50e-4. An independent
/// analysis found that elasticity gains nothing. Series 2 asks for a build-up of each winch (chi-square 112 with one
/// scale for all winches) rather than a scale of each (140), as many parameters both; series 1, measured on another day, is
/// predicted to 3.04 and 2.68 mm with exact parts. Either says that drums are larger than described and that their build-up
/// matters. With typical tolerances, of which the parts take all (factor 1.0), the prediction is 3.14 mm, without the measured position of pose 17, which may be wrong.
#[test]
fn diagnosis_names_drum_radii_and_build_up() {
    let Some(folder) = folder() else {
        return;
    };
    let opinion = opinion(&folder).unwrap();
    let named = |effect: &str| {
        let mut findings = opinion.findings.iter();
        findings
            .any(|(verdict, causes)| *verdict == Verdict::Named && causes[0].0.starts_with(effect))
    };
    assert!(named("winch_scale"), "{opinion:?}");
    assert!(named("drum_growth"), "{opinion:?}");
    for (_, causes) in &opinion.findings {
        let elastic = |(effect, _): &(&str, Vec<usize>)| effect.starts_with("cable_stiff");
        assert!(!causes.iter().any(elastic), "{opinion:?}");
    }
    let growth = opinion.growth.unwrap();
    assert!((-1.9e-4..=-0.9e-4).contains(&growth), "{growth}");
    // Worse than the 2.68 mm of the other grouping with exact parts: a known weakness.
    let predicted = opinion.other_rms_m * 1e3;
    assert!((predicted / 3.137 - 1.0).abs() < 0.02, "{opinion:?}");
}
