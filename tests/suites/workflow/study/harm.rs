//! Faults of disks, processes and files of a study: the merged result is right, or nothing is merged.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::Duration;

use tautline_study::chunk::{Origin, read_chunk, write_chunk};
use tautline_study::{merge, read_plan};
use tautline_validation::support::program::{program, start, tautline};

use super::{Study, merged, run_part};

/// Names of the files of a study, sorted.
fn files(folder: &str) -> Vec<String> {
    let entries = fs::read_dir(folder).expect("a folder").flatten();
    let mut names: Vec<String> = entries
        .map(|entry| entry.file_name().to_string_lossy().into_owned())
        .collect();
    names.sort();
    names
}

/// The program where no file may become larger than two blocks of 512 bytes, as on a disk that is full: a write fails in the
/// middle, or, where the signal is not ignored, the process is killed by it.
fn on_a_full_disk(arguments: &[&str], is_killed: bool) -> (Option<i32>, String) {
    let ignored = if is_killed { "" } else { "trap '' XFSZ; " };
    let script = format!("{ignored}ulimit -c 0; ulimit -f 2; exec \"$0\" \"$@\"");
    let mut command = Command::new("sh");
    command.args(["-c", &script]).arg(program()).args(arguments);
    let output = command.stdin(Stdio::null()).output().expect("sh starts");
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    (output.status.code(), said)
}

#[test]
fn a_full_disk_leaves_no_part_of_a_file() {
    let study = Study::planned();
    let run = ["study", "run", &study.path, "--threads", "1"];
    let (code, said) = on_a_full_disk(&run, false);
    assert_eq!(code, Some(1), "{said}");
    assert!(said.contains("chunk-1-of-4.parquet"), "{said}");
    assert_eq!(said.lines().count(), 1, "{said}");
    assert_eq!(files(&study.path), ["plan.json"]);
    let (code, _) = on_a_full_disk(&run, true);
    assert_eq!(code, None, "killed");
    tautline(&["study", "merge", &study.path]).refused(&["found no chunk"]);
    // With room again the same line does it, and a result that was there survives a merge without room.
    tautline(&run).succeeded();
    let whole = merged(&study.path);
    let (code, said) = on_a_full_disk(&["study", "merge", &study.path], false);
    assert!(code == Some(1) && said.contains("result.json"), "{said}");
    let kept = fs::read(Path::new(&study.path).join("result.json"));
    assert!(kept.expect("there") == whole);
}

#[test]
fn killed_processes_cost_no_more_than_their_chunks() {
    let study = Study::planned();
    tautline(&["study", "run", &study.path]).succeeded();
    let whole = merged(&study.path);
    let folder = study.copy("killed");
    for milliseconds in [5, 20, 50, 100, 150, 200, 300] {
        let mut child = start(&["study", "run", &folder], Stdio::null());
        std::thread::sleep(Duration::from_millis(milliseconds));
        child.kill().expect("killed");
        child.wait().expect("it ends");
        let answer = tautline(&["study", "merge", &folder]);
        if answer.code != Some(0) {
            answer.refused(&["found ", "chunk"]);
        }
    }
    tautline(&["study", "run", &folder]).succeeded();
    assert!(merged(&folder) == whole);
}

#[test]
fn mergers_at_once_and_beside_a_run_write_the_same() {
    let study = Study::planned();
    tautline(&["study", "run", &study.path]).succeeded();
    let whole = merged(&study.path);
    let result = Path::new(&study.path).join("result.json");
    for _ in 0..3 {
        fs::remove_file(&result).expect("removed");
        let mergers: Vec<_> = (0..4)
            .map(|_| start(&["study", "merge", &study.path], Stdio::null()))
            .collect();
        for merger in mergers {
            let output = merger.wait_with_output().expect("it ends");
            assert!(output.status.success());
            assert!(fs::read(&result).expect("written") == whole);
        }
    }
    // Two runs of the same chunks, and merges in the middle of them: refused, or right.
    let folder = study.copy("beside");
    let mut runs = [0; 2].map(|_| start(&["study", "run", &folder], Stdio::null()));
    let mut is_over = false;
    while !is_over {
        is_over = runs
            .iter_mut()
            .all(|run| run.try_wait().expect("asked").is_some());
        let answer = tautline(&["study", "merge", &folder]);
        match answer.code {
            Some(0) => {
                assert!(fs::read(Path::new(&folder).join("result.json")).expect("there") == whole);
            }
            _ => answer.refused(&["found ", "chunk"]),
        }
    }
    assert!(merged(&folder) == whole);
}

#[test]
fn no_damage_of_a_chunk_changes_the_result() {
    let study = Study::planned();
    tautline(&["study", "run", &study.path]).succeeded();
    let folder = PathBuf::from(&study.path);
    let plan = read_plan(&folder).expect("a plan");
    let whole = merge(&plan, &folder).expect("merged");
    let chunk = folder.join("chunk-2-of-4.parquet");
    let good = fs::read(&chunk).expect("there");
    let mut refused = 0;
    for place in (0..good.len()).step_by(11) {
        let mut damaged = good.clone();
        damaged[place] ^= 1 << (place % 8);
        fs::write(&chunk, &damaged).expect("written");
        match merge(&plan, &folder) {
            // Bytes whose change is not refused are irrelevant, such as a date of the archive.
            Ok(result) => assert_eq!(result, whole, "byte {place}"),
            Err(error) => {
                refused += 1;
                let said = error.to_string();
                assert!(said.contains("chunk-2-of-4.parquet: "), "{said}");
                assert_eq!(said.lines().count(), 1, "{said}");
            }
        }
    }
    assert!(
        refused > good.len() / 11 / 2,
        "{refused} of {}",
        good.len() / 11
    );
    for end in (0..good.len()).step_by(101) {
        fs::write(&chunk, &good[..end]).expect("written");
        merge(&plan, &folder).expect_err("cut off");
    }
    // Two chunks that have changed places, under each other's name.
    fs::write(&chunk, &good).expect("written");
    fs::rename(&chunk, folder.join("kept")).expect("renamed");
    fs::rename(folder.join("chunk-3-of-4.parquet"), &chunk).expect("renamed");
    fs::rename(folder.join("kept"), folder.join("chunk-3-of-4.parquet")).expect("renamed");
    tautline(&["study", "merge", &study.path])
        .refused(&["chunk-2-of-4.parquet", "number 3 of 4, expected 2 of 4"]);
}

/// A chunk that is whole in itself, of a program or a study that is a little different.
#[test]
fn what_claims_something_else_is_refused() {
    let study = Study::planned();
    for part in ["1/2", "2/2"] {
        run_part(&study.path, part);
    }
    let folder = PathBuf::from(&study.path);
    let (good, rows) = read_chunk(&folder.join("chunk-2-of-2.parquet")).expect("a chunk");
    let claims: [(Origin, &str); 5] = [
        (
            Origin {
                version: "0.0.1".into(),
                ..good.clone()
            },
            "a chunk of the program version 0.0.1, expected ",
        ),
        (
            Origin {
                study: "0".repeat(16),
                ..good.clone()
            },
            "a chunk of the study 0000000000000000, expected ",
        ),
        (
            Origin {
                seed: 8,
                ..good.clone()
            },
            "a chunk of the seed 8, expected 7",
        ),
        (
            Origin {
                range: [60, 180],
                ..good.clone()
            },
            "a chunk of calibrations 60 to 180, expected 120 to 240",
        ),
        (
            Origin {
                content: "0".repeat(16),
                ..good.clone()
            },
            "the file is damaged",
        ),
    ];
    for (origin, sentence) in claims {
        write_chunk(&folder, &origin, &rows).expect("written");
        for command in ["merge", "run"] {
            let mut arguments = vec!["study", command, &study.path];
            arguments.extend(
                (command == "run")
                    .then_some(["--chunk", "2/2"])
                    .iter()
                    .flatten(),
            );
            tautline(&arguments).refused(&["chunk-2-of-2.parquet: ", sentence]);
        }
    }
    // Calibrations of another cell than their number says.
    let mut moved = rows.clone();
    moved.cell.iter_mut().for_each(|cell| *cell = 0);
    let fingerprint = good.study.clone();
    let plan = read_plan(&folder).expect("a plan");
    let origin = Origin::of((&plan, &fingerprint), good.part, &moved);
    write_chunk(&folder, &origin, &moved).expect("written");
    tautline(&["study", "merge", &study.path]).refused(&["found calibration 120 in cell 0"]);
    write_chunk(&folder, &good, &rows).expect("written");
    merged(&study.path);
}
