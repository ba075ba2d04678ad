//! Links, and files of other programs beside a session.

use std::os::unix::fs::symlink;

use tautline_core::measurement::{Grid, Measurements};
use tautline_core::robot::presets;
use tautline_session::MeasuredPose;

use super::*;

struct Bench {
    root: tempfile::TempDir,
}

impl Bench {
    fn new() -> Self {
        let bench = Self {
            root: tempfile::tempdir().expect("a folder"),
        };
        let robot = presets::find("mini").expect("a preset").robot;
        let session = Session::new("test", robot, clock::now());
        write_session(&bench.path("file.json"), &session).expect("written");
        bench
    }

    fn path(&self, name: &str) -> PathBuf {
        self.root.path().join(name)
    }

    fn open(&self, name: &str) -> Result<(SessionFile, Vec<String>), SessionFileError> {
        let mut notices = Vec::new();
        let file = SessionFile::open(&self.path(name), &mut |text| notices.push(text))?;
        Ok((file, notices))
    }
}

fn pose(label: i64) -> MeasuredPose {
    MeasuredPose::from(Measurements {
        labels: vec![label],
        revolutions: Grid::of_row(vec![0.0; 8]),
        force_n: Grid::of_row(vec![50.0; 8]),
        ..Measurements::default()
    })
}

#[test]
fn a_session_opened_through_a_link_stays_one_file() {
    let bench = Bench::new();
    fs::create_dir(bench.path("elsewhere")).expect("a folder");
    symlink(bench.path("file.json"), bench.path("elsewhere/link.json")).expect("a link");
    let (held, _) = bench.open("file.json").expect("opened");
    let busy = bench.open("elsewhere/link.json").err().expect("held");
    assert!(matches!(busy, SessionFileError::Lock(LockError::Busy(_))));
    drop(held);
    let (mut file, _) = bench.open("elsewhere/link.json").expect("opened");
    file.log(Phase::Poses, "through the link");
    file.save().expect("saved");
    drop(file);
    assert!(bench.path("elsewhere/link.json").is_symlink());
    let (file, _) = bench.open("file.json").expect("opened");
    assert!(
        file.session
            .log()
            .iter()
            .any(|entry| entry.text == "through the link")
    );
    let beside = fs::read_dir(bench.path("elsewhere")).expect("a folder");
    assert_eq!(beside.count(), 1, "nothing is left beside the link");
}

#[test]
fn a_folder_of_autosaves_that_is_a_link_is_refused() {
    let bench = Bench::new();
    let outside = tempfile::tempdir().expect("a folder");
    fs::write(outside.path().join("theirs"), "theirs").expect("written");
    symlink(outside.path(), bench.path("file.json.unsaved")).expect("a link");
    let refused = bench.open("file.json").err().expect("a link").to_string();
    assert!(refused.contains("is a link or something else"), "{refused}");
    assert_eq!(fs::read_dir(outside.path()).expect("a folder").count(), 1);
}

#[test]
fn files_of_others_beside_a_session_stay() {
    let bench = Bench::new();
    let unsaved = bench.path("file.json.unsaved");
    fs::create_dir_all(unsaved.join("discarded")).expect("a folder");
    let outside = bench.path("outside");
    fs::write(&outside, "theirs").expect("written");
    for name in ["notes.txt", "discarded/letter", "session-notes.txt"] {
        fs::write(unsaved.join(name), "theirs").expect("written");
    }
    symlink(&outside, bench.path("file.json.controller")).expect("a link");
    let (file, _) = bench.open("file.json").expect("opened");
    drop(file);
    for name in ["notes.txt", "discarded/letter", "session-notes.txt"] {
        assert!(unsaved.join(name).exists(), "{name}");
    }
    assert!(bench.path("file.json.controller").is_symlink());
    fs::remove_file(bench.path("file.json.controller")).expect("removed");
    fs::write(bench.path("file.json.controller"), "theirs").expect("written");
    drop(bench.open("file.json").expect("opened"));
    assert!(bench.path("file.json.controller").exists());
    assert_eq!(fs::read_to_string(&outside).expect("there"), "theirs");
}

#[test]
fn a_damaged_autosave_gives_its_poses_and_is_kept() {
    let bench = Bench::new();
    let (file, _) = bench.open("file.json").expect("opened");
    let mut writer = file.autosave().expect("a writer");
    writer.append_pose(&pose(0)).expect("on disk");
    writer.append_pose(&pose(4)).expect("on disk");
    drop(writer);
    drop(file);
    let unsaved = bench.path("file.json.unsaved");
    let own = fs::read_dir(&unsaved)
        .expect("a folder")
        .map(|entry| entry.expect("an entry").path());
    let own = own
        .filter(|path| path.is_dir())
        .last()
        .expect("an autosave");
    fs::write(own.join("snapshot.json"), "{\"format\": \"taut").expect("written");
    let (file, notices) = bench.open("file.json").expect("opened");
    assert_eq!(file.session.measurements.labels, [0, 4]);
    assert!(
        notices
            .iter()
            .any(|text| text.contains("damaged files are kept here")),
        "{notices:?}"
    );
    drop(file);
    let (file, notices) = bench.open("file.json").expect("opened");
    assert_eq!((file.session.measurements.len(), notices.len()), (2, 0));
    let kept = unsaved.join(format!(
        "damaged-{}",
        own.file_name().expect("a name").display()
    ));
    assert!(kept.join("journal.jsonl").exists());
}
