//! A real machine. Its data belong to another project and are looked for beside the repository.

use std::path::{Path, PathBuf};

use tautline_core::diagnosis::Verdict;
use tautline_validation::hangprinter::{opinion, study};

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

/// The owner tuned the build-up by hand to -1.13e-4; independent fits gave -1.21e-4 and -1.50e-4. An independent
/// analysis found that elasticity gains nothing.
#[test]
fn the_doctor_names_drum_radii_and_build_up_by_itself() {
    let Some(folder) = folder() else {
        return;
    };
    let opinion = opinion(&folder).unwrap();
    let named = |effect: &str| {
        let mut findings = opinion.findings.iter();
        findings.any(|(verdict, causes)| *verdict == Verdict::Named && causes[0].0 == effect)
    };
    assert!(named("winch_scale"), "{opinion:?}");
    assert!(named("drum_growth"), "{opinion:?}");
    for (_, causes) in &opinion.findings {
        let elastic = |(effect, _): &(&str, Vec<usize>)| effect.starts_with("cable_stiff");
        assert!(!causes.iter().any(elastic), "{opinion:?}");
    }
    let (growth, _) = opinion.growth.unwrap();
    assert!((-1.9e-4..=-0.9e-4).contains(&growth), "{growth}");
    assert!(opinion.other_rms_m < 3e-3, "{opinion:?}");
}
