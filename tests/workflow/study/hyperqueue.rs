//! A study on two HyperQueue workers: one of them is killed, then the server, which goes on from its journal.

use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use super::{Study, merged, tautline};
use tautline_validation::program::{Folder, program};

/// How long anything may take.
const PATIENCE: Duration = Duration::from_secs(120);
const CHUNKS: u64 = 24;

/// Server and workers; all are killed when it is dropped.
struct Engine {
    hq: PathBuf,
    /// Where the server keeps how to reach it, and its journal.
    folder: Folder,
    processes: Vec<Child>,
}

impl Engine {
    fn new() -> Self {
        let hq = Path::new(env!("CARGO_MANIFEST_DIR")).join("../target/python/bin/hq");
        assert!(
            hq.exists(),
            "the Python environment of this test is missing: make it by bash .ci/python"
        );
        Self {
            hq,
            folder: Folder::new(),
            processes: Vec::new(),
        }
    }

    fn command(&self, arguments: &[&str]) -> Command {
        let mut command = Command::new(&self.hq);
        command
            .arg("--server-dir")
            .arg(self.folder.path().join("server"))
            .args(arguments);
        command
            .stdin(Stdio::null())
            .stdout(Stdio::null())
            .stderr(Stdio::null());
        command
    }

    /// Starts a process of the engine; its place among all.
    fn start(&mut self, arguments: &[&str]) -> usize {
        let child = self.command(arguments).spawn().expect("hq starts");
        self.processes.push(child);
        self.processes.len() - 1
    }

    fn kill(&mut self, place: usize) {
        let process = &mut self.processes[place];
        process.kill().expect("killed");
        process.wait().expect("it ends");
    }

    fn start_server(&mut self) -> usize {
        let journal = self.folder.join("journal");
        let place = self.start(&["server", "start", "--journal", &journal]);
        wait("the server", || {
            self.command(&["server", "info"])
                .status()
                .is_ok_and(|status| status.success())
        });
        place
    }

    fn start_worker(&mut self) -> usize {
        self.start(&[
            "worker",
            "start",
            "--cpus",
            "1",
            "--no-detect-resources",
            "--on-server-lost",
            "stop",
        ])
    }
}

impl Drop for Engine {
    fn drop(&mut self) {
        for process in &mut self.processes {
            let _ = process.kill();
            let _ = process.wait();
        }
    }
}

fn wait(what: &str, is_there: impl Fn() -> bool) {
    let began = Instant::now();
    while !is_there() {
        assert!(began.elapsed() < PATIENCE, "{what} did not come");
        std::thread::sleep(Duration::from_millis(100));
    }
}

#[test]
fn two_workers_one_killed_and_the_server_restarted_give_the_same_bits() {
    let study = Study::planned();
    tautline(&["study", "run", &study.path]).succeeded();
    let whole = merged(&study.path);
    let spread = study.copy("spread");
    let chunks = || {
        let entries = std::fs::read_dir(&spread).expect("a folder").flatten();
        entries
            .filter(|entry| entry.file_name().to_string_lossy().ends_with(".npz"))
            .count() as u64
    };

    let mut engine = Engine::new();
    let server = engine.start_server();
    let first = engine.start_worker();
    engine.start_worker();
    // Slow enough that the crashes fall into the middle.
    let script = format!(
        "sleep 0.4; exec '{}' study run '{spread}' --chunk \"$HQ_TASK_ID/{CHUNKS}\" --threads 1",
        program().display()
    );
    let array = format!("1-{CHUNKS}");
    let submitted = engine
        .command(&[
            "submit",
            "--array",
            &array,
            "--cpus",
            "1",
            "--crash-limit",
            "unlimited",
            "--stdout",
            "none",
            "--stderr",
            "none",
            "--",
            "sh",
            "-c",
            &script,
        ])
        .status();
    assert!(submitted.expect("hq starts").success());
    wait("the first chunks", || chunks() >= 2);
    engine.kill(first);
    wait("more chunks", || chunks() >= 4);
    engine.kill(server);
    assert!(chunks() < CHUNKS, "the server died in the middle");
    engine.start_server();
    engine.start_worker();
    engine.start_worker();
    wait("all chunks", || chunks() == CHUNKS);
    assert!(merged(&spread) == whole);
}
