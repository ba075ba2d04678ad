//! The program against a controller that misbehaves: wrong frames, broken lines, restarts, other clients, operators in a
//! hurry.

mod adjusting;
mod frames;
mod measuring;
mod notifications;
mod stopping;

use std::collections::BTreeMap;
use std::path::Path;
use std::process::{Child, Stdio};
use std::sync::OnceLock;
use std::time::Duration;

use serde_json::{Value, json};
use tautline_link::{Controller, GuardedController};
use tautline_session::{Outcome, Session, read_session};
use tautline_validation::support::ads::unruly::Unruly;
use tautline_validation::support::ads::{Host, Plant};
use tautline_validation::support::program::{self, Folder, heard, tautline};

/// The name of the release for which the sample program waits.
const RELEASE: &str = "GVL_Tautline.release";

fn controller(plant: &Plant<Unruly>) -> String {
    plant.server.choice()
}

fn session(path: &str) -> Session {
    let read = read_session(Path::new(path));
    read.unwrap_or_else(|error| panic!("{error}")).value
}

fn last_outcome(path: &str) -> Outcome {
    let session = session(path);
    let last = session.adjustments().last();
    last.expect("an adjustment").outcome.clone()
}

/// Values of the controller from the bytes in its memory.
fn held(plant: &Plant<Unruly>) -> BTreeMap<&'static str, Vec<f64>> {
    let symbols = [
        "GVL_Tautline.entry_point",
        "GVL_Tautline.platform_anchor",
        "GVL_Tautline.pulley_radius",
        "GVL_Tautline.drum_diameter",
        "GVL_Tautline.home",
        "GVL_Tautline.laser_plane_offset",
    ];
    let all = symbols.into_iter();
    all.map(|symbol| (symbol, plant.server.numbers(symbol)))
        .collect()
}

/// A connected client of the link.
fn client(plant: &Plant<Unruly>) -> GuardedController<tautline_link::symbols::SymbolController> {
    let mut client = plant.client();
    client.connect().expect("connected");
    client
}

/// A session of MINI with 25 measured poses, in a file of its own.
fn measured(folder: &Folder, name: &str) -> String {
    static MEASURED: OnceLock<String> = OnceLock::new();
    let text = MEASURED.get_or_init(|| {
        let folder = Folder::new();
        let file = folder.join("s.json");
        let sim = ["--controller", "sim", "--robot", "mini", "--arm"];
        tautline(&[&["measure", &file], sim.as_slice()].concat()).succeeded();
        let text = std::fs::read_to_string(&file).expect("a session");
        // A machine that runs many tests at once is slow; the tests of slowness set their own timeout.
        let mut session: Value = serde_json::from_str(&text).expect("JSON");
        session["connection"]["place"] =
            json!({"host": "127.0.0.1", "net_id": [127, 0, 0, 1, 1, 1], "timeout_s": 20.0});
        session.to_string()
    });
    folder.write(name, text)
}

/// Waits until a condition is met, while a program runs.
fn wait_until(child: &mut Child, is_so: impl Fn() -> bool) {
    while !is_so() {
        let ended = child.try_wait().expect("a state");
        assert!(ended.is_none(), "it ends early");
        std::thread::sleep(Duration::from_millis(1));
    }
}

/// Starts the program without standard input.
fn start(words: &[&str]) -> Child {
    program::start(words, Stdio::null())
}
