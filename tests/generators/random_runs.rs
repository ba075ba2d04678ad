//! Result documents of random runs of a built program, to compare those before and after a change that must not change any.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use anyhow::{Context, Result, ensure};
use rand::seq::IndexedRandom;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use serde_json::Value;
use tautline_core::effect::{CATALOGUE, Scope};

/// Kinds of runs, in turn.
const KINDS: [&str; 7] = [
    "identify", "diagnose", "plan", "compare", "adjust", "import", "study",
];
/// Robots to draw from.
const ROBOTS: [&str; 4] = ["mini", "hall", "suspended", "planar"];
/// Fields of documents that differ between any two runs: times.
const TIMES: [&str; 2] = ["seconds", "time"];

/// Runs the program `runs` times and writes what it answers into `folder`: `NUMBER-KIND.txt` with exit code and messages, and
/// `NUMBER-KIND.json` with the document if there is one. Number and `seed` alone decide what is run.
///
/// # Errors
/// If the program cannot be started or the folder exists.
pub fn write(program: &Path, folder: &Path, runs: usize, seed: u64) -> Result<()> {
    fs::create_dir(folder).with_context(|| format!("{}: a new folder", folder.display()))?;
    let program = program.canonicalize()?;
    for number in 0..runs {
        let kind = KINDS[number % KINDS.len()];
        let inside = tempfile::tempdir()?;
        let mut run = Run {
            program: &program,
            folder: inside.path(),
            rng: ChaCha8Rng::seed_from_u64(seed + number as u64),
            answers: String::new(),
        };
        let document = run.of_kind(kind)?;
        let path = folder.join(format!("{number:04}-{kind}.txt"));
        fs::write(path, &run.answers)?;
        if let Ok(text) = fs::read_to_string(&document) {
            let mut value: Value = serde_json::from_str(&text).context("a document")?;
            remove_times(&mut value);
            let path = folder.join(format!("{number:04}-{kind}.json"));
            fs::write(path, serde_json::to_string_pretty(&value)?)?;
        }
    }
    Ok(())
}

fn remove_times(value: &mut Value) {
    match value {
        Value::Object(fields) => {
            fields.retain(|key, _| !TIMES.contains(&key.as_str()));
            fields.values_mut().for_each(remove_times);
        }
        Value::Array(items) => items.iter_mut().for_each(remove_times),
        _ => {}
    }
}

struct Run<'a> {
    program: &'a Path,
    /// An empty folder, in which the program works.
    folder: &'a Path,
    rng: ChaCha8Rng,
    /// Exit codes and messages of all commands.
    answers: String,
}

impl Run<'_> {
    /// Runs the commands of a kind; the path of the document that the last one writes.
    fn of_kind(&mut self, kind: &str) -> Result<PathBuf> {
        let number =
            |rng: &mut ChaCha8Rng, range: std::ops::Range<u32>| rng.random_range(range).to_string();
        match kind {
            "plan" => {
                let robot = *ROBOTS.choose(&mut self.rng).context("a robot")?;
                let goal = *["geometry", "faults", "both"]
                    .choose(&mut self.rng)
                    .context("a goal")?;
                let (poses, seed) = (number(&mut self.rng, 8..30), number(&mut self.rng, 1..1000));
                self.command(&[
                    "plan",
                    robot,
                    "--poses",
                    &poses,
                    "--seed",
                    &seed,
                    "--for",
                    goal,
                    "--candidates",
                    "300",
                ])?;
            }
            "compare" => {
                let robot = *ROBOTS.choose(&mut self.rng).context("a robot")?;
                self.dataset(robot, "first")?;
                self.dataset(robot, "second")?;
                self.command(&["compare", "first", "second"])?;
            }
            "adjust" => {
                let poses = number(&mut self.rng, 12..25);
                let seed = number(&mut self.rng, 1..1000);
                self.command(&[
                    "measure",
                    "run.json",
                    "--robot",
                    "mini",
                    "--controller",
                    "sim",
                    "--poses",
                    &poses,
                    "--seed",
                    &seed,
                    "--arm",
                ])?;
                self.command(&["adjust", "run.json", "--controller", "sim", "--dry-run"])?;
            }
            "import" => {
                let robot = *ROBOTS.choose(&mut self.rng).context("a robot")?;
                self.dataset(robot, "data")?;
                self.shuffle_columns()?;
                self.command(&["import", "log.csv", "--robot", robot, "--out", "cell"])?;
            }
            "study" => {
                let robot = *ROBOTS.choose(&mut self.rng).context("a robot")?;
                let poses = number(&mut self.rng, 12..25);
                let seed = number(&mut self.rng, 1..1000);
                let file = format!(
                    "format = \"tautline-study\"\nversion = 1\nname = \"random\"\nseed = {seed}\n\n[design]\nrobots = \
                     [\"{robot}\"]\nposes = [{poses}]\nchoice = [\"random\"]\n\n[simulation]\ncalibrations = 3\nshare = 1.0\n"
                );
                fs::write(self.folder.join("study.toml"), file)?;
                self.command(&["study", "plan", "study.toml", "--out", "study"])?;
                self.command(&["study", "run", "study", "--threads", "1"])?;
                self.command(&["study", "merge", "study"])?;
            }
            _ => {
                let robot = *ROBOTS.choose(&mut self.rng).context("a robot")?;
                self.dataset(robot, "data")?;
                self.command(&[kind, "data"])?;
            }
        }
        Ok(self.folder.join("document.json"))
    }

    /// Simulates a dataset, in two of three cases with an effect.
    fn dataset(&mut self, robot: &str, out: &str) -> Result<()> {
        let poses = self.rng.random_range(12..32).to_string();
        let seed = self.rng.random_range(1..1_000_000).to_string();
        let effect = CATALOGUE.choose(&mut self.rng).context("an effect")?;
        let sizes: Vec<String> = (effect.parameters().iter())
            .map(|parameter| {
                // The only parameter that is a label, of one of the first poses.
                if parameter.name == "pose" {
                    return format!("pose={}", self.rng.random_range(1..12));
                }
                let [least, most] = parameter.typical;
                format!("{}={}", parameter.name, self.rng.random_range(least..=most))
            })
            .collect();
        let cable = match effect.scope() {
            Scope::Cable => ":cable-1",
            _ => "",
        };
        let effect = format!("{}{cable}:{}", effect.id(), sizes.join(","));
        let tolerances = *["none", "typical"]
            .choose(&mut self.rng)
            .context("tolerances")?;
        let mut arguments = vec![
            "simulate",
            "--robot",
            robot,
            "--poses",
            &poses,
            "--seed",
            &seed,
            "--tolerances",
            tolerances,
            "--out",
            out,
        ];
        if self.rng.random_range(0..3) > 0 {
            arguments.extend(["--effect", &effect]);
        }
        self.run(&arguments)
    }

    /// `log.csv`: the readings of the dataset with their columns in another order.
    fn shuffle_columns(&mut self) -> Result<()> {
        // A robot that cannot have the effect was not simulated; the failed import of a missing file counts as an answer, too.
        let Ok(text) = fs::read_to_string(self.folder.join("data/poses.csv")) else {
            return Ok(());
        };
        let columns = text.lines().next().context("a heading")?.split(',').count();
        let mut order: Vec<usize> = (0..columns).collect();
        rand::seq::SliceRandom::shuffle(order.as_mut_slice(), &mut self.rng);
        let lines = text.lines().map(|line| {
            let cells: Vec<&str> = line.split(',').collect();
            ensure!(
                cells.len() == columns,
                "poses.csv: {} cells, expected {columns}",
                cells.len()
            );
            let moved: Vec<&str> = order.iter().map(|column| cells[*column]).collect();
            Ok(moved.join(",") + "\n")
        });
        let lines: Result<String> = lines.collect();
        Ok(fs::write(self.folder.join("log.csv"), lines?)?)
    }

    /// Runs a command that writes a document.
    fn command(&mut self, arguments: &[&str]) -> Result<()> {
        let mut arguments = arguments.to_vec();
        if !["plan", "run"].contains(arguments.get(1).unwrap_or(&"")) {
            arguments.extend(["--json", "document.json"]);
        }
        self.run(&arguments)
    }

    fn run(&mut self, arguments: &[&str]) -> Result<()> {
        let mut command = Command::new(self.program);
        command
            .args(arguments)
            .arg("--quiet")
            .current_dir(self.folder);
        let output = command
            .stdin(Stdio::null())
            .output()
            .context("the program")?;
        self.answers.push_str(&format!(
            "tautline {}: {}\n{}\n",
            arguments.join(" "),
            output.status,
            String::from_utf8_lossy(&output.stderr)
        ));
        Ok(())
    }
}
