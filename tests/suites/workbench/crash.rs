//! Sessions after a kill at any moment: the program is killed while it measures, edits and saves.
//!
//! The killed program is this test itself, started again: [`a_session_that_is_measured_edited_and_saved`] goes on until
//! it is killed if it is given a folder.

use std::io::{BufRead, BufReader, Write};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::thread;
use std::time::{Duration, Instant};

use egui_kittest::Harness;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use tautline_core::measurement::Measurements;
use tautline_core::robot::presets;
use tautline_core::simulation::simulate;
use tautline_session::{
    Folders, MeasuredPose, Phase, Session, find_unsaved_sessions, read_session,
};
use tautline_validation::tables::simulated::preset_options;
use tautline_workbench::model::command::FileCommand;
use tautline_workbench::model::edit::Edit;
use tautline_workbench::model::{OpenSession, Options};
use tautline_workbench::shell::App;

use crate::support::settle;

const FOLDER: &str = "TAUTLINE_TEST_CRASH";
/// Poses that can be measured; far more than are before the kill.
const POSES: usize = 200;
/// Most steps before the kill.
const STEPS: u32 = 36;
const KILLS: u64 = 30;

fn saved_file(folder: &Path) -> PathBuf {
    folder.join("saved.json")
}

/// The readings of a simulated MINI.
fn readings() -> Measurements {
    let preset = presets::find("mini").expect("a preset");
    let simulated = simulate(&preset.robot, &preset_options(&preset, POSES, 3));
    simulated.expect("simulated").dataset.measurements
}

fn pose(readings: &Measurements, row: usize) -> MeasuredPose {
    MeasuredPose::from(readings.select(&[row]))
}

/// A program that measures, edits and saves, one step after the other.
struct Running {
    harness: Harness<'static, App>,
    folder: PathBuf,
}

impl Running {
    fn begin(folder: &Path) -> Self {
        let options = Options {
            folders: Some(Folders::below(&folder.join("home"))),
            demo_seed: Some(3),
            ..Options::default()
        };
        let mut harness = Harness::builder()
            .with_size(egui::vec2(1280.0, 800.0))
            .with_max_steps(60)
            .build_eframe(|creation| App::new(creation, options));
        let outbox = &mut harness.state_mut().state.outbox;
        outbox.send(FileCommand::TryDemo);
        harness.step();
        settle(&mut harness);
        Self {
            harness,
            folder: folder.to_owned(),
        }
    }

    fn document(&mut self) -> &mut OpenSession {
        let document = self.harness.state_mut().state.model.open.as_mut();
        document.expect("the demonstration is open")
    }

    /// Stores a pose like the phase Measuring: first on disk, then in the session.
    fn measure(&mut self, pose: &MeasuredPose) {
        if !self.document().is_unsaved() {
            self.document().log(Phase::Poses, "Measuring.");
        }
        let state = &mut self.harness.state_mut().state;
        state.model.autosave.follow(state.model.open.as_ref());
        state.model.autosave.measured(pose.clone());
        let start = Instant::now();
        while state.model.autosave.events().is_empty() {
            assert!(
                start.elapsed() < Duration::from_secs(60),
                "it is never kept"
            );
            thread::sleep(Duration::from_micros(200));
        }
    }

    fn append(&mut self, pose: &MeasuredPose) {
        self.document().append_pose(pose).expect("it fits");
        self.harness.step();
    }

    fn exclude(&mut self, label: i64) {
        assert!(self.document().edit(Edit::Exclude(label)));
        self.harness.step();
    }

    fn save(&mut self) {
        let path = saved_file(&self.folder);
        let outbox = &mut self.harness.state_mut().state.outbox;
        outbox.send(FileCommand::SaveAs(path));
        self.harness.step();
    }
}

/// Reports to the parent what is on disk now.
fn tell(what: &str, value: i64) {
    let mut out = std::io::stdout().lock();
    writeln!(out, "step {what} {value}").expect("the parent listens");
    out.flush().expect("the parent listens");
}

/// Measures the poses of `rows`; every second one is left out, every fifth comes while the file is being saved.
fn work(running: &mut Running, readings: &Measurements, rows: std::ops::Range<usize>) {
    for row in rows {
        let pose = pose(readings, row);
        let saves = row % 5 == 4;
        if saves {
            running.save();
        }
        running.measure(&pose);
        // The previous edit was handed to the autosave before the pose.
        if row % 2 == 1 && row > 1 {
            tell("excluded", readings.labels[row - 1]);
        }
        if saves {
            // The file is done before the document has the pose.
            settle(&mut running.harness);
            let state = &mut running.harness.state_mut().state;
            state.model.autosave.follow(state.model.open.as_ref());
            tell("saved", row as i64);
        }
        running.append(&pose);
        tell("measured", pose.label());
        if row % 2 == 0 && row > 0 {
            running.exclude(pose.label());
        }
    }
}

#[test]
fn a_session_that_is_measured_edited_and_saved() {
    let readings = readings();
    if let Some(folder) = std::env::var_os(FOLDER) {
        let mut running = Running::begin(Path::new(&folder));
        tell("opened", 0);
        work(&mut running, &readings, 0..readings.len());
        panic!("it should have been killed by now");
    }
    let folder = tempfile::tempdir().expect("a folder");
    let mut running = Running::begin(folder.path());
    work(&mut running, &readings, 0..12);
    running.save();
    settle(&mut running.harness);
    let saved = read_session(&saved_file(folder.path())).expect("a session");
    assert_eq!(saved.value.measurements.len(), 12);
    assert_eq!(saved.value.excluded().len(), 5);
}

/// Reports of the program before it was killed.
#[derive(Debug, Default)]
struct Told {
    measured: Vec<i64>,
    excluded: Vec<i64>,
    /// Poses of the file that was saved last.
    saved: usize,
}

/// Lets the program run until it has reported `steps` steps, and `delay` longer.
fn killed(folder: &Path, steps: u32, delay: Duration) -> Told {
    let name = "crash::a_session_that_is_measured_edited_and_saved";
    let test = std::env::current_exe().expect("a path");
    let mut child = Command::new(test)
        .args([name, "--exact", "--nocapture", "--test-threads=1"])
        .env(FOLDER, folder)
        .stdout(Stdio::piped())
        .stderr(Stdio::null())
        .spawn()
        .expect("it starts");
    let out = BufReader::new(child.stdout.take().expect("a pipe"));
    let mut lines = out.lines().map_while(Result::ok);
    let mut told = Told::default();
    let mut hear = |line: &str| {
        // The runner of the tests begins the line.
        let words: Vec<&str> = line.split_whitespace().collect();
        let [.., "step", what, value] = words[..] else {
            return false;
        };
        let value: i64 = value.parse().expect("a number");
        match what {
            "measured" => told.measured.push(value),
            "excluded" => told.excluded.push(value),
            "saved" => told.saved = usize::try_from(value).expect("a number of poses"),
            _ => {}
        }
        true
    };
    let mut heard = 0;
    while heard < steps {
        let line = lines.next().expect("it goes on until it is killed");
        heard += u32::from(hear(&line));
    }
    thread::sleep(delay);
    child.kill().expect("it runs");
    child.wait().expect("it has ended");
    for line in lines {
        hear(&line);
    }
    told
}

/// The session as the next start of the program finds it, and whether by recovery.
fn found(folder: &Path) -> (Option<Session>, bool) {
    let place = Folders::below(&folder.join("home")).recovery();
    let left = find_unsaved_sessions(&place).expect("readable");
    assert!(left.len() <= 1, "{left:?}");
    let file = saved_file(folder);
    let saved = file.exists().then(|| {
        let loaded = read_session(&file).expect("the saved file is whole");
        assert!(loaded.notices.is_empty(), "{:?}", loaded.notices);
        loaded.value
    });
    match left.first() {
        Some(left) => {
            let recovered = left.recover().expect("recovered").value.session;
            let saved = saved.map_or(0, |saved| saved.measurements.len());
            assert!(recovered.measurements.len() >= saved);
            (Some(recovered), true)
        }
        None => (saved, false),
    }
}

#[test]
fn a_kill_at_any_moment_loses_no_measured_pose() {
    let readings = readings();
    let (mut poses, mut edits, mut recovered, mut unfinished) = (0, 0, 0, 0);
    for seed in 0..KILLS {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let steps = rng.random_range(1..STEPS);
        let delay = Duration::from_micros(rng.random_range(0..30_000));
        let folder = tempfile::tempdir().expect("a folder");
        let told = killed(folder.path(), steps, delay);
        let (session, by_recovery) = found(folder.path());
        recovered += u32::from(by_recovery);
        let Some(session) = session else {
            assert!(
                told.measured.is_empty(),
                "kill {seed}: nothing of {told:?} is left"
            );
            continue;
        };
        let known = &session.measurements;
        for (row, label) in told.measured.iter().enumerate() {
            let at = known.labels.iter().position(|known| known == label);
            let at = at.unwrap_or_else(|| panic!("kill {seed}: pose {label} is lost"));
            assert_eq!(known.laser_m[at], readings.laser_m[row], "kill {seed}");
            assert_eq!(known.revolutions.row(at), readings.revolutions.row(row));
            poses += 1;
        }
        for label in &told.excluded {
            assert!(
                session.excluded().contains(label),
                "kill {seed}: an edit is lost"
            );
            edits += 1;
        }
        // A pose that was on its way is there or not, but there is only one.
        assert!(known.len() <= told.measured.len() + 1, "kill {seed}");
        unfinished += known.len() - told.measured.len();
        if told.saved > 0 {
            let saved = read_session(&saved_file(folder.path())).expect("whole");
            assert!(saved.value.measurements.len() >= told.saved);
        }
    }
    println!(
        "{KILLS} kills, {recovered} sessions recovered: {poses} measured poses and {edits} edits that were told to be \
         on disk are all there, and {unfinished} poses that were not told yet"
    );
    assert!(poses > 100 && recovered > 15, "the kills come too early");
}
