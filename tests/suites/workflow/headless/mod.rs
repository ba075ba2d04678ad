//! Measuring, adjusting and verifying without a window: the whole loop, and kills at any moment of it.

mod audit;
mod kill_adjust;
mod kill_measure;
mod refusals;
mod until;
mod whole_loop;

use std::path::Path;
use std::time::Duration;

use tautline_session::{Session, read_session, write_plan};
use tautline_validation::support::program::{self, beside, command};

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

/// Starts the program and kills it once `when` says so; its standard error until then, and whether it
/// was still running.
fn killed(arguments: &[&str], when: impl FnMut(Duration) -> bool) -> (String, bool) {
    program::killed(&mut command(arguments), when)
}
