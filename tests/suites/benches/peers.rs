//! Time of identification on one core, compared with a reference solver where one is given:
//!
//!     cargo bench -p tautline-validation --bench peers [-- --peer PROGRAM]
//!
//! MINI, seed 3, as `tautline simulate --robot mini --seed 3` makes it. Both sides are timed in
//! memory, problem set-up included, one thread; the best of several solves counts. The program is
//! called as `PROGRAM DATASET THREADS REPEATS` and prints JSON with `seconds_min`, `iterations` and
//! `chi2` of Problem R1 (see docs/NOTATION.md). Ends with an error if its chi-square differs.

use std::path::{Path, PathBuf};
use std::process::{Command, ExitCode};
use std::time::Instant;

use anyhow::{Context, Result, bail, ensure};
use serde_json::Value;
use tautline_core::estimation::{Control, Method, Options, Problem, Solution, solve};
use tautline_core::measurement::Dataset;
use tautline_core::robot::presets;
use tautline_core::simulation::{SimulationOptions, TrueGeometry, simulate};
use tautline_session::{PhaseData, read_dataset, write_dataset};

/// Rows, home included, and how often each problem is solved in a round.
const SIZES: [(usize, usize); 3] = [(25, 200), (1_001, 20), (10_001, 5)];
const LARGE: (usize, usize) = (100_001, 3);
const PEER_REPEATS: &str = "2";
/// The solvers take turns, so that a slow moment of the machine does not hit one of them alone.
const ROUNDS: usize = 3;
const SEED: u64 = 3;
/// Largest relative difference of chi-square between solvers of the same problem.
const SAME_MINIMUM: f64 = 1e-9;

/// One solved problem with its least time.
struct Timed {
    seconds: f64,
    iterations: u64,
    chi2: f64,
}

/// The least time of each solver.
struct Runs {
    peer: Option<Timed>,
    simple: Timed,
    joint: Timed,
}

impl Runs {
    /// Relative difference of chi-square between the peer and R1.
    fn difference(&self) -> Option<f64> {
        let peer = self.peer.as_ref()?;
        Some((peer.chi2 / self.simple.chi2 - 1.0).abs())
    }

    fn line(&self, rows: usize) -> String {
        let of_peer = |show: &dyn Fn(&Timed) -> String| {
            self.peer.as_ref().map_or_else(|| "-".to_owned(), show)
        };
        let (simple, joint) = (&self.simple, &self.joint);
        format!(
            "{rows:>7} {:>11} {:>11.3e} {:>7} {:>11.3e} {:>6.2} {:>11} {:>9}",
            of_peer(&|peer| format!("{:.3e}", peer.seconds)),
            simple.seconds,
            of_peer(&|peer| format!("{:.1}", peer.seconds / simple.seconds)),
            joint.seconds,
            joint.seconds / simple.seconds,
            self.difference()
                .map_or_else(|| "-".to_owned(), |d| format!("{d:.1e}")),
            format!(
                "{}/{}/{}",
                of_peer(&|peer| peer.iterations.to_string()),
                simple.iterations,
                joint.iterations
            ),
        )
    }
}

fn keep_least(best: &mut Option<Timed>, run: Timed) {
    if best.as_ref().is_none_or(|b| run.seconds < b.seconds) {
        *best = Some(run);
    }
}

fn main() -> ExitCode {
    match run() {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("{error:#}");
            ExitCode::FAILURE
        }
    }
}

fn run() -> Result<()> {
    // Cargo itself adds --bench.
    let arguments: Vec<String> = std::env::args()
        .skip(1)
        .filter(|a| a != "--bench")
        .collect();
    match arguments.iter().map(String::as_str).collect::<Vec<_>>()[..] {
        [] => compare(None),
        ["--peer", peer] => compare(Some(Path::new(peer))),
        // The program calls itself for each large problem, so that the peak of memory is its own.
        ["--solve", folder, method] => solve_alone(Path::new(folder), method),
        _ => bail!("expected nothing or --peer PROGRAM"),
    }
}

fn compare(peer: Option<&Path>) -> Result<()> {
    println!(
        "{:>7} {:>11} {:>11} {:>7} {:>11} {:>6} {:>11} {:>9}",
        "rows", "peer s", "R1 s", "peer/R1", "R2 s", "R2/R1", "chi2 diff.", "steps"
    );
    let mut worst = 0.0_f64;
    for (rows, repeats) in SIZES {
        let runs = take_turns(peer, rows, repeats)?;
        println!("{}", runs.line(rows));
        worst = worst.max(runs.difference().unwrap_or(0.0));
    }
    println!(
        "steps: peer/R1/R2; times: least of several solves that take turns, set-up included, \
         one thread\n"
    );
    compare_large()?;
    ensure!(
        worst <= SAME_MINIMUM,
        "chi-square of R1 differs from the peer's by {worst:.1e}, more than {SAME_MINIMUM:.0e}"
    );
    if peer.is_some() {
        println!(
            "\nchi-square of R1 equals the peer's within {SAME_MINIMUM:.0e} (worst {worst:.1e})"
        );
    }
    Ok(())
}

fn take_turns(peer: Option<&Path>, rows: usize, repeats: usize) -> Result<Runs> {
    let folder = Folder::with_rows(rows)?;
    let dataset = read_dataset(&folder.path)?.dataset;
    let (mut reference, mut simple, mut joint) = (None, None, None);
    for _ in 0..ROUNDS {
        if let Some(peer) = peer {
            keep_least(&mut reference, run_peer(peer, &folder.path)?);
        }
        keep_least(&mut simple, best_of(&dataset, Method::Simple, repeats)?);
        keep_least(&mut joint, best_of(&dataset, Method::Joint, repeats)?);
    }
    Ok(Runs {
        peer: reference,
        simple: simple.context("nothing was solved")?,
        joint: joint.context("nothing was solved")?,
    })
}

fn compare_large() -> Result<()> {
    let folder = Folder::with_rows(LARGE.0)?;
    let program = std::env::current_exe()?;
    for method in ["simple", "joint"] {
        let output = Command::new(&program)
            .arg("--solve")
            .arg(&folder.path)
            .arg(method)
            .output()?;
        let errors = String::from_utf8_lossy(&output.stderr);
        ensure!(output.status.success(), "{errors}");
        print!("{}", String::from_utf8_lossy(&output.stdout));
    }
    Ok(())
}

/// Reads a dataset, solves it and prints the peak of this process's memory.
fn solve_alone(folder: &Path, method: &str) -> Result<()> {
    let dataset = read_dataset(folder)?.dataset;
    let read = peak_memory_mib();
    let (name, method) = match method {
        "simple" => ("R1", Method::Simple),
        _ => ("R2", Method::Joint),
    };
    let timed = best_of(&dataset, method, LARGE.1)?;
    let show = |mib: Option<f64>| mib.map_or("unknown".to_owned(), |m| format!("{m:.0} MiB"));
    println!(
        "{:>7} rows, {name}: {:.3} s, {} steps; peak memory {} after reading, {} after solving",
        dataset.measurements.len(),
        timed.seconds,
        timed.iterations,
        show(read),
        show(peak_memory_mib())
    );
    Ok(())
}

/// Largest resident memory of this process so far, where the system reports it.
fn peak_memory_mib() -> Option<f64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find_map(|l| l.strip_prefix("VmHWM:"))?;
    let kib: f64 = line.trim().strip_suffix("kB")?.trim().parse().ok()?;
    Some(kib / 1024.0)
}

fn best_of(dataset: &Dataset, method: Method, repeats: usize) -> Result<Timed> {
    let mut best: Option<Timed> = None;
    for _ in 0..repeats {
        let begin = Instant::now();
        let solution = solve_once(dataset, method)?;
        let seconds = begin.elapsed().as_secs_f64();
        ensure!(
            solution.converged(),
            "did not converge: {:?}",
            solution.termination
        );
        let run = Timed {
            seconds,
            iterations: solution.iterations as u64,
            chi2: solution.chi2,
        };
        keep_least(&mut best, run);
    }
    best.context("nothing was solved")
}

fn solve_once(dataset: &Dataset, method: Method) -> Result<Solution> {
    let problem = Problem::new(dataset)?.with_method(method);
    Ok(solve(&problem, &Options::default(), &mut |_| {
        Control::Continue
    })?)
}

fn run_peer(peer: &Path, folder: &Path) -> Result<Timed> {
    let output = Command::new(peer)
        .arg(folder)
        .args(["1", PEER_REPEATS])
        .output()
        .with_context(|| format!("{} cannot be run", peer.display()))?;
    ensure!(
        output.status.success(),
        "{}: {}",
        peer.display(),
        String::from_utf8_lossy(&output.stderr)
    );
    let result: Value = serde_json::from_slice(&output.stdout)?;
    let iterations = result["iterations"].as_u64().context("iterations")?;
    Ok(Timed {
        seconds: result["seconds_min"].as_f64().context("seconds_min")?,
        // Ceres counts its start as an iteration.
        iterations: iterations.saturating_sub(1),
        chi2: result["chi2"].as_f64().context("chi2")?,
    })
}

/// A dataset folder that goes away with its owner.
struct Folder {
    path: PathBuf,
    _owner: tempfile::TempDir,
}

impl Folder {
    fn with_rows(rows: usize) -> Result<Self> {
        let preset = presets::find("mini").context("the preset mini")?;
        let measured = preset.measured_entry_points_m;
        let options = SimulationOptions {
            geometry: TrueGeometry::EntryPoints(measured.context("measured entry points")?),
            workspace: Some(preset.workspace),
            tension: Some(preset.tension),
            ..SimulationOptions::new(rows - 1, SEED)
        };
        let simulated = simulate(&preset.robot, &options)?;
        let owner = tempfile::tempdir()?;
        let path = owner.path().join("mini");
        write_dataset(&path, &simulated.dataset, &PhaseData::default())?;
        Ok(Self {
            path,
            _owner: owner,
        })
    }
}
