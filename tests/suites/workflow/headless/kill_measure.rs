//! `measure` is killed at random moments: no accepted pose is lost, none is measured twice.

use std::collections::BTreeSet;
use std::path::Path;
use std::time::{Duration, Instant};

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use super::{beside, killed, plan, session};
use crate::commands::program::{Folder, tautline};
use tautline_validation::support::program::on_disk;

const KILLS: usize = 50;
const POSES: usize = 12;

#[test]
fn a_killed_run_loses_no_pose_and_repeats_none() {
    let folder = Folder::new();
    let plan = plan(&folder, POSES);
    let arguments = |file: &str| {
        let words = [
            "measure",
            file,
            "--controller",
            "sim",
            "--robot",
            "mini",
            "--plan",
            &plan,
            "--arm",
        ];
        words.map(str::to_owned)
    };
    let begun = Instant::now();
    let whole = arguments(&folder.join("whole.json"));
    let told = tautline(&whole.each_ref().map(String::as_str))
        .succeeded()
        .stderr;
    assert_eq!(on_disk(&told).len(), POSES + 1);
    let takes = begun.elapsed();
    let mut rng = ChaCha8Rng::seed_from_u64(5);
    let (mut within, mut pieces) = (0, 0);
    for kill in 0..KILLS {
        let file = folder.join(&format!("{kill}.json"));
        let arguments = arguments(&file);
        let arguments = arguments.each_ref().map(String::as_str);
        let mut accepted = Vec::new();
        // Every third run is killed twice.
        for _ in 0..1 + usize::from(kill % 3 == 0) {
            let after: Duration = takes.mul_f64(rng.random_range(0.0..1.0));
            let (told, ran) = killed(&arguments, |elapsed| elapsed >= after);
            let labels = on_disk(&told);
            within += usize::from(ran && !labels.is_empty());
            accepted.extend(labels);
            if Path::new(&file).exists() {
                session(&file);
            }
        }
        let answer = tautline(&arguments).succeeded();
        pieces += usize::from(!accepted.is_empty());
        accepted.extend(on_disk(&answer.stderr));
        let told: BTreeSet<i64> = accepted.iter().copied().collect();
        assert_eq!(
            told.len(),
            accepted.len(),
            "kill {kill}: a pose is measured twice: {accepted:?}"
        );
        let measured = session(&file).measurements.labels;
        let expected: BTreeSet<i64> = (0..=POSES as i64).collect();
        let kept: BTreeSet<i64> = measured.iter().copied().collect();
        assert_eq!(measured.len(), kept.len(), "kill {kill}: {measured:?}");
        assert_eq!(kept, expected, "kill {kill}");
        let measured = session(&file);
        assert_eq!(measured.audit(), [], "kill {kill}");
        assert_eq!(measured.imported_poses(), [0; 0], "kill {kill}");
        // A pose may be on disk before it could be told.
        assert!(told.is_subset(&kept), "kill {kill}");
        assert_eq!(
            beside(&file),
            Vec::<std::path::PathBuf>::new(),
            "kill {kill}"
        );
    }
    println!("{within} kills came within the poses, {pieces} of {KILLS} runs are of pieces");
}
