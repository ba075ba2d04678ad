//! The program is killed at random moments while it measures or adjusts at a controller in a process of its own.

use std::cell::Cell;
use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;
use std::process::Stdio;
use std::thread::sleep;
use std::time::{Duration, Instant};

use anyhow::{Context, Result, ensure};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use serde_json::json;
use tautline_link::Controller;
use tautline_session::{Outcome, Session, read_session};

use super::markdown::table;
use crate::support::ads::symbols::Style;
use crate::support::ads::{Host, Plant, Protocol, User};
use crate::support::program::{Answer, Folder, beside, killed, on_disk, run, spawn};

/// Poses of a run, and the home pose.
const POSES: usize = 12;
const LABELS: usize = POSES + 1;
/// Every so many measuring runs are killed twice.
const TWICE: usize = 3;
/// Time that each answer of the controller takes while values are written (s), so that kills fall between them.
const DELAY_S: f64 = 0.005;
/// What the values of a pair may be, as the second method has other doubts.
const ALLOWED: [&str; 4] = [
    "--allow-unconverged",
    "--allow-unexplained",
    "--allow-implausible",
    "--allow-finding",
];
/// Pairs for each kill of one of a pair.
const PAIRS: usize = 3;
/// Longest time between the beginnings of a pair (ms).
const APART_MS: u64 = 60;
/// Time in which a release that was left behind ends (s).
const RELEASED_S: u64 = 20;
/// Exit code of a command that has settled what another one left.
const SETTLED: i32 = 4;

/// What became of the runs that were killed.
#[derive(Debug, Clone)]
pub struct Kills {
    /// The protocol.
    pub protocol: Protocol,
    /// Number of measuring runs and of adjustments that were killed.
    pub runs: usize,
    /// Measuring runs that had stored a pose and were not at their end.
    pub amid_poses: usize,
    /// Adjustments that had begun to write and were not at their end, by what the controller held: old, new or mixed values.
    pub amid_values: BTreeMap<String, usize>,
    /// Pairs of adjustments that began at once, one of every third killed.
    pub pairs: usize,
    /// Pairs of which both, one or none said that its values were written.
    pub written: [usize; 3],
    /// What should not have happened, in words.
    pub faults: Vec<String>,
}

/// Seed of the moments.
pub const SEED: u64 = 50_000;

/// Kills so many measuring runs, so many adjustments and so many of two adjustments at once over a protocol.
///
/// # Errors
/// If a run that is not killed fails.
pub fn study(protocol: Protocol, runs: usize, seed: u64) -> Result<Kills> {
    let mut kills = Kills {
        protocol,
        runs,
        amid_poses: 0,
        amid_values: BTreeMap::new(),
        pairs: PAIRS * runs,
        written: [0; 3],
        faults: Vec::new(),
    };
    let plant = Plant::fast(protocol, Style::Arrays);
    let controller = plant.server.choice();
    let bench = Bench {
        user: User::of(&plant),
        plant,
        controller,
        folder: Folder::new(),
    };
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    bench.measure(&mut kills, &mut random)?;
    bench.adjust(&mut kills, &mut random)?;
    bench.pairs(&mut kills, &mut random)?;
    Ok(kills)
}

fn session(file: &str) -> Result<Session> {
    Ok(read_session(Path::new(file))?.value)
}

/// The outcome of the last adjustment of a session.
fn last(session: &Session) -> Option<Outcome> {
    session
        .adjustments()
        .last()
        .map(|last| last.outcome.clone())
}

fn succeeded(answer: Answer) -> Result<Answer> {
    ensure!(answer.code == Some(0), "{}", answer.stderr);
    Ok(answer)
}

/// A controller, who works at it, and the files.
struct Bench {
    plant: Plant,
    user: User,
    controller: String,
    folder: Folder,
}

impl Bench {
    fn words<'w>(&'w self, command: &'w str, file: &'w str) -> Vec<&'w str> {
        let words = [command, file, "--controller", &self.controller, "--arm"];
        // A machine that does much else is slow.
        [&words[..], &["--timeout", "20"]].concat()
    }

    fn measuring<'w>(&'w self, file: &'w str) -> Vec<&'w str> {
        let new = ["--robot", "mini", "--poses", "12"];
        [self.words("measure", file), new.to_vec()].concat()
    }

    /// Kills measuring runs and continues each of them.
    fn measure(&self, kills: &mut Kills, random: &mut ChaCha8Rng) -> Result<()> {
        let begun = Instant::now();
        let whole = self.folder.join("whole.json");
        let told = succeeded(self.user.run(&self.measuring(&whole)))?.stderr;
        ensure!(on_disk(&told).len() == LABELS, "{told}");
        let takes = begun.elapsed();
        for run in 0..kills.runs {
            let file = self.folder.join(&format!("measure-{run}.json"));
            let words = self.measuring(&file);
            let mut told = Vec::new();
            for _ in 0..1 + usize::from(run % TWICE == 0) {
                let after = takes.mul_f64(random.random_range(0.0..1.0));
                let (text, ran) = killed(&mut self.user.command(&words), |time| time >= after);
                let stored = on_disk(&text);
                kills.amid_poses += usize::from(ran && !stored.is_empty());
                told.extend(stored);
            }
            let answer = self.user.run(&words);
            let mut fault = |text: String| kills.faults.push(format!("measuring {run}: {text}"));
            if answer.code != Some(0) {
                fault(answer.stderr);
                continue;
            }
            told.extend(on_disk(&answer.stderr));
            let reported: BTreeSet<i64> = told.iter().copied().collect();
            let session = session(&file)?;
            let labels = &session.measurements.labels;
            let kept: BTreeSet<i64> = labels.iter().copied().collect();
            // A pose may be on disk before it could be told.
            if !kept.iter().copied().eq(0..LABELS as i64) || !reported.is_subset(&kept) {
                fault(format!("poses are lost: {labels:?} of {told:?}"));
            }
            if reported.len() < told.len() || kept.len() < labels.len() {
                fault(format!("poses are measured twice: {labels:?}, {told:?}"));
            }
            if !session.audit().is_empty() || !session.imported_poses().is_empty() {
                fault("the audit trail is broken".to_owned());
            }
            let left = beside(&file);
            if !left.is_empty() {
                fault(format!("files are left: {left:?}"));
            }
        }
        Ok(())
    }

    /// What the controller holds, by a client of its own.
    fn held(&self) -> Result<BTreeMap<String, f64>> {
        let mut reader = self.plant.client();
        reader.connect()?;
        let parameters = reader.parameters()?.into_iter();
        Ok(parameters.map(|p| (p.name, p.value)).collect())
    }

    /// Kills adjustments and settles each of them.
    fn adjust(&self, kills: &mut Kills, random: &mut ChaCha8Rng) -> Result<()> {
        let measured = self.folder.join("whole.json");
        let copy = |name: &str| -> Result<String> {
            let file = self.folder.join(name);
            std::fs::copy(&measured, &file)?;
            Ok(file)
        };
        let old = self.held()?;
        self.plant.server.order(json!({ "delay_s": DELAY_S }));
        let whole = copy("adjusted.json")?;
        let (begun, writes) = (Instant::now(), self.plant.server.count("write"));
        succeeded(self.user.run(&self.words("adjust", &whole)))?;
        let takes = begun.elapsed();
        let writes = self.plant.server.count("write") - writes;
        let new = self.held()?;
        ensure!(new != old, "the adjustment changes nothing");
        let roll_back = |file: &str| {
            let words = [self.words("adjust", file), vec!["--roll-back"]].concat();
            self.user.run(&words)
        };
        succeeded(roll_back(&whole))?;
        for run in 0..kills.runs {
            let file = copy(&format!("adjust-{run}.json"))?;
            let words = [self.words("adjust", &file), vec!["--json", "-"]].concat();
            let after = takes.mul_f64(random.random_range(0.0..1.0));
            let at_write = self.plant.server.count("write") + random.random_range(0..=writes);
            // Half of the kills wait for a write, so that they fall between values on any machine.
            let last_count = Cell::new(Instant::now());
            killed(&mut self.user.command(&words), |time| match run % 2 {
                0 => time >= after,
                _ if last_count.get().elapsed() < Duration::from_millis(2) => false,
                _ => {
                    last_count.set(Instant::now());
                    self.plant.server.count("write") >= at_write
                }
            });
            let amid = self.held()?;
            let found = match &amid {
                amid if *amid == old => "old",
                amid if *amid == new => "new",
                _ => "mixed",
            };
            let left = last(&session(&file)?);
            let is_open = left == Some(Outcome::Begun);
            let answer = self.user.run(&words);
            let mut fault = |text: String| kills.faults.push(format!("adjusting {run}: {text}"));
            if is_open {
                *kills.amid_values.entry(found.to_owned()).or_default() += 1;
            } else if left.is_none() && found != "old" {
                fault(format!("{found} values without a record"));
            }
            let expected = if is_open { SETTLED } else { 0 };
            if answer.code != Some(expected) {
                fault(format!("exit code {:?}: {}", answer.code, answer.stderr));
                continue;
            }
            let answer = answer.json();
            if is_open && answer["interrupted"] != found {
                fault(format!(
                    "{found} values are taken for {}",
                    answer["interrupted"]
                ));
            }
            let now = self.held()?;
            let settled = last(&session(&file)?).context("an adjustment without a record")?;
            let is_as_told = match settled {
                Outcome::Written => now == new,
                Outcome::RolledBack | Outcome::Failed(_) => now == old,
                _ => false,
            };
            if !is_as_told {
                fault(format!("{settled:?} is not what the controller holds"));
            }
            if !session(&file)?.audit().is_empty() || !beside(&file).is_empty() {
                fault("the audit trail is broken, or files are left".to_owned());
            }
            if now != old {
                let back = roll_back(&file);
                if back.code != Some(0) || self.held()? != old {
                    fault(format!("cannot be rolled back: {}", back.stderr));
                }
            }
        }
        Ok(())
    }

    /// Writes values by a client of its own, once nobody else is armed.
    fn restore(&self, old: &BTreeMap<String, f64>) -> Result<()> {
        let mut client = self.plant.client();
        client.connect()?;
        let begun = Instant::now();
        while let Err(error) = client.arm() {
            ensure!(begun.elapsed().as_secs() < RELEASED_S, "{error}");
            sleep(Duration::from_millis(50));
        }
        let values: Vec<(String, f64)> = old.iter().map(|(n, v)| (n.clone(), *v)).collect();
        client.write(&values)?;
        client.disarm();
        ensure!(self.held()? == *old, "the old values cannot be written");
        Ok(())
    }

    /// Begins two adjustments with different values at once, and compares what they say with what the controller holds.
    fn pairs(&self, kills: &mut Kills, random: &mut ChaCha8Rng) -> Result<()> {
        let old = self.held()?;
        let measured = self.folder.join("whole.json");
        let methods = ["joint", "simple"];
        let words = |file: &'_ str, method: usize| -> Vec<String> {
            let all = [
                self.words("adjust", file),
                ALLOWED.to_vec(),
                vec!["--method", methods[method]],
            ];
            all.concat().into_iter().map(str::to_owned).collect()
        };
        let command = |file: &str, method: usize| {
            let words = words(file, method);
            self.user
                .command(&words.iter().map(String::as_str).collect::<Vec<_>>())
        };
        let mut new = Vec::new();
        let begun = Instant::now();
        for method in 0..methods.len() {
            let file = self.folder.join(&format!("alone-{method}.json"));
            std::fs::copy(&measured, &file)?;
            succeeded(run(&mut command(&file, method)))?;
            new.push(self.held()?);
            self.restore(&old)?;
        }
        let takes = begun.elapsed() / 4;
        ensure!(new[0] != new[1], "both write the same");
        for number in 0..kills.pairs {
            let files = [0, 1].map(|k| self.folder.join(&format!("pair-{number}-{k}.json")));
            for file in &files {
                std::fs::copy(&measured, file)?;
            }
            let mut first = spawn(&mut command(&files[0], 0), Stdio::null());
            sleep(Duration::from_millis(random.random_range(0..=APART_MS)));
            let second = spawn(&mut command(&files[1], 1), Stdio::null());
            if number % PAIRS == 0 {
                sleep(takes.mul_f64(random.random_range(0.0..1.5)));
                // It may have ended by itself.
                let _ = first.kill();
            }
            let ended: Vec<Answer> = [first, second]
                .map(|child| child.wait_with_output().map(Answer::from))
                .into_iter()
                .collect::<Result<_, _>>()?;
            let held = self.held()?;
            let mut fault = |text: String| kills.faults.push(format!("pair {number}: {text}"));
            let mut wrote = Vec::new();
            let mut is_open = false;
            for (k, (file, answer)) in files.iter().zip(&ended).enumerate() {
                let outcome = last(&session(file)?);
                let is_written = outcome == Some(Outcome::Written);
                if answer.code.is_some() && (answer.code == Some(0)) != is_written {
                    fault(format!(
                        "exit code {:?} of {outcome:?}: {}",
                        answer.code, answer.stderr
                    ));
                }
                is_open |= matches!(outcome, Some(Outcome::Begun | Outcome::Unsettled(_)));
                wrote.extend(is_written.then_some(k));
            }
            kills.written[2 - wrote.len()] += 1;
            // Whoever wrote last is right, also where the other one does not know what it left.
            let is_right = match wrote[..] {
                [] => is_open || held == old,
                _ => wrote.iter().any(|k| held == new[*k]),
            };
            if !is_right {
                let told = ended.iter().map(|answer| answer.stderr.as_str());
                fault(format!(
                    "{wrote:?} wrote, the controller holds others: {}",
                    told.collect::<String>()
                ));
            }
            self.restore(&old)?;
        }
        Ok(())
    }
}

/// The table of the documentation.
#[must_use]
pub fn markdown(all: &[Kills]) -> String {
    let rows = all.iter().map(|kills| {
        let link = match kills.protocol {
            Protocol::Ads => "ADS",
            Protocol::OpcUa => "OPC UA, security None",
            Protocol::OpcUaEncrypted => "OPC UA, SignAndEncrypt with a user",
        };
        let found = |word: &str| kills.amid_values.get(word).copied().unwrap_or(0);
        let [both, one, none] = kills.written;
        format!(
            "{link} | {} | {} | {}, {}, {} | {}: {both}, {one}, {none} | {}",
            kills.runs,
            kills.amid_poses,
            found("old"),
            found("new"),
            found("mixed"),
            kills.pairs,
            kills.faults.len(),
        )
    });
    table(
        "link | runs of each kind | measuring, killed amid the poses | adjusting, killed amid the writing: old, new, mixed values found | pairs of two programs: both, one, none wrote | lost, repeated, not settled or told wrongly",
        rows,
    )
}
