//! Measuring, adjusting and verifying without a window: the whole loop, and kills at any moment of it.

mod audit;
mod kill_adjust;
mod kill_measure;
mod refusals;
mod until;
mod whole_loop;

use std::io::Read;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};

use tautline_session::{Session, read_session, write_plan};
use tautline_validation::support::program::program;

use crate::commands::program::{Folder, tautline};

/// A plan of MINI as `measure` makes it: all its poses can be held by the true robot, too.
fn plan(folder: &Folder, poses: usize) -> String {
    let file = folder.join("planned.json");
    let words = ["measure", &file, "--controller", "sim", "--robot", "mini"];
    tautline(&[words.as_slice(), &["--arm", "--poses", &poses.to_string()]].concat());
    let mut bytes = Vec::new();
    write_plan(&mut bytes, &session(&file).plan).expect("a table");
    folder.write("plan.csv", &String::from_utf8(bytes).expect("text"))
}

/// The session in a file, which must be one at any moment.
fn session(path: &str) -> Session {
    let read = read_session(Path::new(path));
    read.unwrap_or_else(|error| panic!("{error}")).value
}

/// Files next to a session file.
fn beside(path: &str) -> Vec<PathBuf> {
    let folder = Path::new(path).parent().expect("a folder");
    let name = Path::new(path).file_name().expect("a name");
    let name = format!("{}.", name.to_string_lossy());
    let entries = std::fs::read_dir(folder).expect("readable").flatten();
    let paths = entries.map(|entry| entry.path());
    let belongs = |path: &PathBuf| {
        path.file_name()
            .is_some_and(|n| n.to_string_lossy().starts_with(&name))
    };
    paths.filter(belongs).collect()
}

/// Starts the program and kills it once `when` says so; its standard error until then, and whether it
/// was still running.
fn killed(arguments: &[&str], mut when: impl FnMut(Duration) -> bool) -> (String, bool) {
    let mut child = Command::new(program())
        .args(arguments)
        .stdout(Stdio::null())
        .stderr(Stdio::piped())
        .spawn()
        .expect("the program starts");
    let begun = Instant::now();
    while !when(begun.elapsed()) {
        if child.try_wait().expect("a state").is_some() {
            break;
        }
        sleep(Duration::from_micros(200));
    }
    let ran = child.try_wait().expect("a state").is_none();
    // It may end by itself meanwhile.
    let _ = child.kill();
    let mut told = String::new();
    let mut stderr = child.stderr.take().expect("a pipe");
    stderr.read_to_string(&mut told).expect("text");
    child.wait().expect("it has ended");
    (told, ran)
}
