//! The program reads damaged files of every format within a limit of memory that the system enforces.

use std::collections::BTreeMap;
use std::io::{BufRead, BufReader, Write};
use std::path::{Path, PathBuf};
use std::process::Stdio;

use anyhow::{Context, Result, ensure};
use rand::{Rng, RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use serde::Deserialize;
use serde_json::Value;

use super::markdown::table;
use crate::support::program::{Folder, program};
use crate::support::python::python;

/// Seed of the damage.
pub const SEED: u64 = 51_000;
/// Limit of memory of an import (GiB), and of the address space of every command (bytes).
const LIMIT_GIB: u64 = 2;
const LIMIT_BYTES: u64 = LIMIT_GIB << 30;
/// Time limit of a command (s).
const LIMIT_S: u64 = 60;
/// Exit code of a panic.
const PANIC: i64 = 101;

/// How the program ended, as the script tells it.
#[derive(Debug, Deserialize)]
struct End {
    code: Option<i64>,
    told: String,
    peak_bytes: u64,
    seconds: f64,
}

/// What became of the damaged files of a kind.
#[derive(Debug, Clone, Default)]
pub struct Outcome {
    /// Number of files.
    pub files: usize,
    /// Files that were still readable.
    pub read: usize,
    /// Files that were refused.
    pub refused: usize,
    /// Panics, signals, time limits and refusals without a sentence, in words.
    pub faults: Vec<String>,
    /// Largest memory of a command (bytes).
    pub peak_bytes: u64,
    /// Longest time of a command (s).
    pub longest_s: f64,
}

fn seeds() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("suites/fuzz/seeds")
}

/// A file with up to five changes: bits, bytes and ends changed, left out or doubled.
fn damaged(whole: &[u8], random: &mut impl Rng) -> Vec<u8> {
    let mut bytes = whole.to_vec();
    for _ in 0..random.random_range(1..=5) {
        let at = random.random_range(0..bytes.len());
        match random.random_range(0..5) {
            0 => bytes.truncate(at.max(1)),
            1 if bytes.len() > 1 => drop(bytes.remove(at)),
            2 => bytes.extend_from_within(at..),
            3 => bytes[at] = random.random(),
            _ => bytes[at] ^= 1 << random.random_range(0..8),
        }
    }
    bytes
}

/// Where the damaged file of a kind goes, and the command that reads it.
fn command(folder: &Folder, kind: &str, name: &str, turn: usize) -> Result<(PathBuf, Vec<String>)> {
    let dataset = folder.path().join("dataset");
    std::fs::create_dir_all(&dataset)?;
    for (seed, name) in [
        ("robot_json/planar.json", "robot.json"),
        ("poses_csv/all.csv", "poses.csv"),
    ] {
        std::fs::copy(seeds().join(seed), dataset.join(name))?;
    }
    let words = |words: &[&str]| words.iter().map(|word| (*word).to_owned()).collect();
    let text = |path: &Path| path.to_str().map(str::to_owned).context("UTF-8");
    let file = folder.path().join(name);
    let (in_dataset, out) = (text(&dataset)?, folder.join("out"));
    let shown = text(&file)?;
    Ok(match kind {
        "foreign_file" => {
            let limit = LIMIT_GIB.to_string();
            let import = ["import", &shown, "--memory-limit", &limit];
            let more = match turn % 2 {
                0 => vec!["--robot", "mini", "--channels"],
                _ => vec!["--robot", "mini", "--out", &out, "--replace"],
            };
            (file, words(&[&import[..], &more].concat()))
        }
        "poses_csv" | "phase_csvs" => {
            let name = match kind {
                "poses_csv" => "poses.csv".to_owned(),
                _ => format!("{name}.csv"),
            };
            let table = folder.join("table.csv");
            let export = ["export", &in_dataset, "--out", &table];
            (dataset.join(name), words(&export))
        }
        "robot_json" => (file, words(&["symbols", &shown])),
        "session_file" => (file, words(&["effects", &shown])),
        "hypothesis" => (file, words(&["effects", "--hypothesis", &shown])),
        other => anyhow::bail!("no command reads the seeds {other}"),
    })
}

/// What is wrong with the end of a command, which reads its input or refuses it by a sentence.
fn fault(end: &End) -> Option<String> {
    let last = end.told.lines().last().unwrap_or_default();
    let what = match end.code {
        None => format!("no end within {LIMIT_S} s"),
        Some(PANIC) => "a panic".to_owned(),
        Some(code) if code < 0 => format!("signal {}", -code),
        Some(0) => return None,
        Some(1 | 2) if !last.trim().is_empty() => return None,
        Some(code) => format!("exit code {code} without a sentence"),
    };
    Some(format!("{what}: {last}"))
}

/// Reads so many damaged files, of all seeds in turn, by the program; outcomes by the folder of the seed.
///
/// # Errors
/// If there are no seeds, or commands cannot be run.
pub fn study(files: usize, seed: u64) -> Result<BTreeMap<String, Outcome>> {
    let mut all: Vec<PathBuf> = Vec::new();
    for kind in std::fs::read_dir(seeds())? {
        for file in std::fs::read_dir(kind?.path())? {
            all.push(file?.path());
        }
    }
    all.sort();
    ensure!(!all.is_empty(), "no seeds");
    let (bytes, seconds) = (LIMIT_BYTES.to_string(), LIMIT_S.to_string());
    let mut runner = python("tests/support/limited_runs.py")
        .args([&bytes, &seconds])
        .env("TAUTLINE_HOME", std::env::temp_dir().join("nobody"))
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .spawn()?;
    let mut orders = runner.stdin.take().context("a pipe")?;
    let mut ends = BufReader::new(runner.stdout.take().context("a pipe")?).lines();
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let mut outcomes: BTreeMap<String, Outcome> = BTreeMap::new();
    for (k, source) in all.iter().cycle().take(files).enumerate() {
        let name = source.file_name().and_then(|name| name.to_str());
        let kind = source.parent().and_then(Path::file_name);
        let kind = kind.and_then(|name| name.to_str());
        let (name, kind) = name.zip(kind).context("a seed in a folder")?;
        let whole = std::fs::read(source)?;
        // The first byte of a table of a phase is for the fuzzer.
        let whole = if kind == "phase_csvs" {
            &whole[1..]
        } else {
            &whole
        };
        let folder = Folder::new();
        let (file, words) = command(&folder, kind, name, k / all.len())?;
        std::fs::write(&file, damaged(whole, &mut random))?;
        let own = program().to_str().context("UTF-8")?.to_owned();
        let words: Value = [vec![own], words].concat().into();
        writeln!(orders, "{words}")?;
        let end = ends.next().context("an answer")??;
        let end: End = serde_json::from_str(&end)?;
        let outcome = outcomes.entry(kind.to_owned()).or_default();
        outcome.files += 1;
        outcome.peak_bytes = outcome.peak_bytes.max(end.peak_bytes);
        outcome.longest_s = outcome.longest_s.max(end.seconds);
        match (fault(&end), end.code) {
            (Some(fault), _) => outcome
                .faults
                .push(format!("{kind}/{name}, file {k}: {fault}")),
            (None, Some(0)) => outcome.read += 1,
            (None, _) => outcome.refused += 1,
        }
    }
    drop(orders);
    runner.wait()?;
    Ok(outcomes)
}

/// The table of the documentation.
#[must_use]
pub fn markdown(outcomes: &BTreeMap<String, Outcome>) -> String {
    let mut all = Outcome::default();
    let mut rows = Vec::new();
    for (kind, outcome) in outcomes {
        let name = match kind.as_str() {
            "foreign_file" => "logs, recordings, tables and robots of other programs",
            "hypothesis" => "hypothesis files",
            "phase_csvs" => "tables of phases 1 and 2",
            "poses_csv" => "`poses.csv`",
            "robot_json" => "`robot.json`",
            "session_file" => "sessions",
            other => other,
        };
        rows.push(outcome.row(name));
        all.files += outcome.files;
        all.read += outcome.read;
        all.refused += outcome.refused;
        all.faults.extend(outcome.faults.clone());
        all.peak_bytes = all.peak_bytes.max(outcome.peak_bytes);
        all.longest_s = all.longest_s.max(outcome.longest_s);
    }
    rows.push(all.row("all"));
    table(
        "files | damaged | still readable | refused in a sentence | panics, aborts, time limits | peak memory | longest",
        rows,
    )
}

impl Outcome {
    fn row(&self, name: &str) -> String {
        format!(
            "{name} | {} | {} | {} | {} | {} MiB | {:.1} s",
            self.files,
            self.read,
            self.refused,
            self.faults.len(),
            self.peak_bytes >> 20,
            self.longest_s,
        )
    }
}
