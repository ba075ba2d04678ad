//! A study on two HyperQueue workers: the process of one is killed, then the server with both workers, and it goes on.

use std::fs;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use rustix::process::{Pid, Signal, kill_process};
use tautline_validation::support::program::program;

use super::{Study, merged, tautline};

/// Time limit for each step.
const PATIENCE: Duration = Duration::from_secs(120);
const CHUNKS: usize = 24;

/// Server and workers; killed when it is dropped.
struct Engine(Child);

impl Engine {
    /// The script of the documentation, with a program that is slow enough for crashes to fall into the middle.
    fn start(folder: &str, slow: &str) -> Self {
        let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
        let python = root.join("target/python/bin/python");
        assert!(
            python.exists(),
            "the Python environment of this test is missing: make it by bash .ci/python"
        );
        let script = root.join("docs/studies/on_hyperqueue.py");
        let child = Command::new(python)
            .arg(script)
            .args([folder, &CHUNKS.to_string(), slow])
            .stdin(Stdio::null())
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .spawn();
        Self(child.expect("Python starts"))
    }
}

impl Drop for Engine {
    fn drop(&mut self) {
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

fn wait(what: &str, is_there: impl Fn() -> bool) {
    let began = Instant::now();
    while !is_there() {
        assert!(began.elapsed() < PATIENCE, "{what} did not come");
        std::thread::sleep(Duration::from_millis(20));
    }
}

#[test]
fn two_workers_one_killed_and_the_server_restarted_give_the_same_bits() {
    let study = Study::planned();
    tautline(&["study", "run", &study.path]).succeeded();
    let whole = merged(&study.path);
    let spread = study.copy("spread");
    let chunks = || {
        let entries = fs::read_dir(&spread).expect("a folder").flatten();
        let is_chunk = |name: String| name.ends_with(".parquet");
        entries
            .filter(|entry| is_chunk(entry.file_name().to_string_lossy().into_owned()))
            .count()
    };
    // The process of a task says which it is before it waits.
    let running = study.folder.join("running");
    let text = format!(
        "#!/bin/sh\necho $$ > '{running}'\nsleep 0.3\nexec '{}' \"$@\"\n",
        program().display()
    );
    let slow = study.folder.write("slow", &text);
    let executable = std::os::unix::fs::PermissionsExt::from_mode(0o755);
    fs::set_permissions(&slow, executable).expect("set");

    let engine = Engine::start(&spread, &slow);
    wait("the first chunks", || chunks() >= 2);
    // The file is empty for a moment while the next process says which it is.
    let process = || {
        let text = fs::read_to_string(&running).expect("a process");
        text.trim().parse().ok().and_then(Pid::from_raw)
    };
    wait("a process", || {
        process().is_some_and(|id| kill_process(id, Signal::KILL).is_ok())
    });
    wait("more chunks", || chunks() >= 6);
    drop(engine);
    assert!(chunks() < CHUNKS, "the server died in the middle");

    let mut engine = Engine::start(&spread, &slow);
    wait("all chunks", || chunks() == CHUNKS);
    assert!(engine.0.wait().expect("it ends").success());
    let result = fs::read(Path::new(&spread).join("result.json")).expect("merged");
    assert!(result == whole);
}
