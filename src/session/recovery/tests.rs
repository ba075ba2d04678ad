//! A kill at any moment loses no pose that was measured.

use std::fs;
use std::path::PathBuf;

use tautline_core::measurement::{Grid, Measurements};

use super::*;
use crate::error::Loaded;
use crate::phases::PhaseData;
use crate::session::tests::session;
use crate::session::{
    MeasuredPose, ResultDocument, ResultRecord, Session, Settings, Timestamp, write_session,
};

fn pose(label: i64) -> MeasuredPose {
    with_lengths(label, vec![1.0, 0.1 + 0.2 * label as f64])
}

fn with_lengths(label: i64, length_m: Vec<f64>) -> MeasuredPose {
    MeasuredPose::from(Measurements {
        labels: vec![label],
        time_s: vec![label as f64],
        length_m: Grid::of_row(length_m),
        ..Measurements::default()
    })
}

/// The session of the tests with poses measured afterwards.
fn with_poses(labels: impl IntoIterator<Item = i64>) -> Session {
    let mut session = session();
    for label in labels {
        session.append_pose(&pose(label)).expect("a pose");
    }
    session
}

fn session_without_poses() -> Session {
    let mut session = session();
    session.measurements = Measurements::default();
    session.phases = PhaseData::default();
    session.settings = Settings::default();
    for label in [1, 3] {
        session.include(label);
    }
    session
}

struct Bench {
    root: tempfile::TempDir,
}

impl Bench {
    fn new() -> Self {
        Self {
            root: tempfile::tempdir().expect("a folder"),
        }
    }

    fn begin(&self, session: &Session) -> RecoveryWriter {
        RecoveryWriter::create(self.root.path(), None, session).expect("a writer")
    }

    fn left(&self) -> Vec<UnsavedSession> {
        find_unsaved_sessions(self.root.path()).expect("a list")
    }

    /// The folder of the only session.
    fn own(&self) -> PathBuf {
        let entries = fs::read_dir(self.root.path()).expect("a folder");
        let mut folders = entries.map(|e| e.expect("an entry").path());
        folders.find(|path| path.is_dir()).expect("a session")
    }

    fn file(&self, name: &str) -> PathBuf {
        self.own().join(name)
    }

    /// The recovered session, and the notices.
    fn recovered(&self) -> (Session, Vec<String>) {
        let left = self.left();
        assert_eq!(left.len(), 1);
        assert_eq!(left[0].problem, None);
        let loaded = left[0].recover().expect("a session");
        assert_eq!(left[0].poses, loaded.value.session.measurements.len());
        (loaded.value.session, loaded.notices)
    }

    fn assert_recovers(&self, expected: &Session) {
        let (session, notices) = self.recovered();
        assert!(notices.is_empty(), "{notices:?}");
        assert_eq!(format!("{session:?}"), format!("{expected:?}"));
    }
}

#[test]
fn an_open_session_is_not_found_as_unsaved() {
    let bench = Bench::new();
    let writer = bench.begin(&session());
    assert!(bench.left().is_empty(), "its program runs");
    drop(writer);
    let left = bench.left();
    assert_eq!((left.len(), left[0].name.as_str()), (1, "Monday"));
    assert_eq!((left[0].poses, &left[0].origin), (2, &None));
    assert!(left[0].when.unix_seconds() > 1_500_000_000);
    assert!(bench.left().is_empty(), "the other program has it");
    drop(left);
    bench.assert_recovers(&session());
}

#[test]
fn a_folder_that_does_not_exist_is_empty() {
    let bench = Bench::new();
    let folder = bench.root.path().join("none");
    assert!(find_unsaved_sessions(&folder).expect("a list").is_empty());
}

#[test]
fn a_saved_session_leaves_nothing() {
    let bench = Bench::new();
    let mut writer = bench.begin(&session());
    writer.append_pose(&pose(5)).expect("on disk");
    writer.finish().expect("removed");
    let mut entries = fs::read_dir(bench.root.path()).expect("a folder");
    assert!(entries.next().is_none());
    // A kill while the files are removed.
    drop(bench.begin(&session()));
    fs::rename(bench.own(), bench.own().with_extension(FINISHED)).expect("renamed");
    assert!(bench.left().is_empty());
    let mut entries = fs::read_dir(bench.root.path()).expect("a folder");
    assert!(entries.next().is_none(), "the remains are removed");
}

#[test]
fn a_kill_while_it_begins_leaves_nothing() {
    for kept in [&[][..], &[ORIGIN], &[ORIGIN, JOURNAL]] {
        let bench = Bench::new();
        drop(bench.begin(&session()));
        for name in [ORIGIN, JOURNAL, SNAPSHOT] {
            if !kept.contains(&name) {
                fs::remove_file(bench.file(name)).expect("removed");
            }
        }
        assert!(bench.left().is_empty());
        let mut entries = fs::read_dir(bench.root.path()).expect("a folder");
        assert!(entries.next().is_none(), "the remains are removed");
    }
}

#[test]
fn a_journal_cut_off_at_any_byte_keeps_every_whole_line() {
    let bench = Bench::new();
    let mut writer = bench.begin(&session());
    let again = MeasuredPose {
        repeats: Some(1),
        ..pose(7)
    };
    for pose in [&pose(5), &pose(6), &again] {
        writer.append_pose(pose).expect("on disk");
    }
    drop(writer);
    let whole = fs::read(bench.file(JOURNAL)).expect("a journal");
    for length in 0..=whole.len() {
        let kept = &whole[..length];
        fs::write(bench.file(JOURNAL), kept).expect("written");
        let lines = kept.iter().filter(|byte| **byte == b'\n').count();
        let mut expected = with_poses((5..7).take(lines));
        if lines == 3 {
            expected.append_pose(&again).expect("a pose");
        }
        let (session, notices) = bench.recovered();
        assert_eq!(format!("{session:?}"), format!("{expected:?}"), "{length}");
        let is_whole = kept.is_empty() || kept.ends_with(b"\n");
        assert_eq!(notices.is_empty(), is_whole, "{length}: {notices:?}");
    }
}

#[test]
fn a_changed_byte_costs_one_line_and_is_named() {
    let bench = Bench::new();
    let mut writer = bench.begin(&session());
    for label in 5..8 {
        writer.append_pose(&pose(label)).expect("on disk");
    }
    drop(writer);
    let whole = fs::read(bench.file(JOURNAL)).expect("a journal");
    let ends = whole.iter().enumerate().filter(|(_, byte)| **byte == b'\n');
    let ends: Vec<usize> = ends.map(|(at, _)| at).collect();
    for at in ends[0] + 1..ends[1] {
        let mut changed = whole.clone();
        changed[at] ^= 1;
        fs::write(bench.file(JOURNAL), &changed).expect("written");
        let (session, notices) = bench.recovered();
        assert_eq!(session.measurements.labels, [3, 1, 5, 7], "{at}");
        assert!(notices[0].contains("line 2: damaged"), "{notices:?}");
    }
}

#[test]
fn a_line_after_a_torn_one_is_whole() {
    let bench = Bench::new();
    let mut writer = bench.begin(&session());
    writer.append_pose(&pose(5)).expect("on disk");
    let whole = fs::read(bench.file(JOURNAL)).expect("a journal");
    fs::write(bench.file(JOURNAL), &whole[..20]).expect("a disk that was full");
    writer.append_pose(&pose(6)).expect("on disk");
    drop(writer);
    let (session, notices) = bench.recovered();
    assert_eq!(session.measurements.labels, [3, 1, 6]);
    assert!(notices[0].contains("line 1: damaged"), "{notices:?}");
}

#[test]
fn a_kill_between_snapshot_and_journal_counts_no_pose_twice() {
    let bench = Bench::new();
    let mut writer = bench.begin(&session());
    writer.append_pose(&pose(5)).expect("on disk");
    writer.append_pose(&pose(6)).expect("on disk");
    let before = fs::read(bench.file(JOURNAL)).expect("a journal");
    writer.write_snapshot(&with_poses(5..7)).expect("kept");
    assert_eq!(fs::read(bench.file(JOURNAL)).expect("a journal"), b"");
    drop(writer);
    bench.assert_recovers(&with_poses(5..7));
    fs::write(bench.file(JOURNAL), before).expect("the journal as it was before");
    bench.assert_recovers(&with_poses(5..7));
    // Killed while the new snapshot or journal was being written: only a temporary file more.
    fs::write(bench.file(".tautline-x"), "{").expect("written");
    bench.assert_recovers(&with_poses(5..7));
}

#[test]
fn a_snapshot_of_an_older_state_keeps_the_poses_measured_since() {
    let bench = Bench::new();
    let mut writer = bench.begin(&session());
    for label in 5..8 {
        writer.append_pose(&pose(label)).expect("on disk");
    }
    writer.write_snapshot(&with_poses(5..6)).expect("kept");
    writer.append_pose(&pose(8)).expect("on disk");
    drop(writer);
    bench.assert_recovers(&with_poses(5..9));
}

#[test]
fn changes_leave_the_poses_where_they_are() {
    let bench = Bench::new();
    let mut writer = bench.begin(&session());
    let rows = session().measurements.len();
    writer.append_pose(&pose(5)).expect("on disk");
    writer.append_pose(&pose(6)).expect("on disk");
    let mut now = with_poses(5..6);
    now.exclude(5).expect("a pose");
    now.name = "Tuesday".into();
    // Pose 6 is on its way into the session.
    let changes = SessionChanges::of(&now, rows);
    writer.write_changes(changes).expect("kept");
    let again = MeasuredPose {
        repeats: Some(6),
        ..pose(7)
    };
    writer.append_pose(&again).expect("on disk");
    drop(writer);
    now.append_pose(&pose(6)).expect("a pose");
    now.append_pose(&again).expect("a pose");
    assert_eq!(now.excluded().len(), 3);
    bench.assert_recovers(&now);
}

#[test]
fn a_pose_that_was_taken_back_in_after_it_was_repeated_stays_in() {
    let bench = Bench::new();
    let mut writer = bench.begin(&session());
    let rows = session().measurements.len();
    let again = MeasuredPose {
        repeats: Some(1),
        ..pose(5)
    };
    writer.append_pose(&again).expect("on disk");
    let mut now = session();
    now.append_pose(&again).expect("a pose");
    now.include(1);
    writer
        .write_changes(SessionChanges::of(&now, rows))
        .expect("kept");
    drop(writer);
    bench.assert_recovers(&now);
}

fn result(k: i64) -> ResultRecord {
    ResultRecord {
        time: Timestamp::from_unix_seconds(2_000_000_000 + k),
        title: format!("Result {k}"),
        document: ResultDocument::of(&vec![k; 2000]).expect("JSON"),
        basis: None,
    }
}

#[test]
fn a_result_is_written_once_however_often_the_session_is_edited() {
    let bench = Bench::new();
    let mut now = session();
    now.add_result(result(0));
    let mut writer = bench.begin(&now);
    let rows = now.measurements.len();
    for k in 1..4 {
        now.add_result(result(k));
        for name in ["a", "b", "c"] {
            now.name = name.into();
            writer
                .write_changes(SessionChanges::of(&now, rows))
                .expect("kept");
        }
        let changes = fs::metadata(bench.file(CHANGES)).expect("changes").len();
        assert!(changes < 4000, "{changes}");
    }
    let kept = fs::read(bench.file(RESULTS)).expect("results");
    assert_eq!(kept.split(|byte| *byte == b'\n').count(), 3 + 1);
    drop(writer);
    bench.assert_recovers(&now);
    // A kill between the snapshot and the removal of the files that it replaces.
    write_session(&bench.file(SNAPSHOT), &now).expect("a snapshot");
    bench.assert_recovers(&now);
}

#[test]
fn a_torn_result_is_told_and_can_be_written_again() {
    let bench = Bench::new();
    let mut now = session();
    let writer = bench.begin(&now);
    drop(writer);
    let path = bench.file(RESULTS);
    now.add_result(result(1));
    let old = session().results().len();
    results::append_new(&path, now.results(), old).expect("kept");
    let whole = fs::read(&path).expect("results");
    fs::write(&path, &whole[..50]).expect("a disk that was full");
    let (recovered, notices) = bench.recovered();
    assert_eq!(recovered.results().len(), old);
    assert!(
        notices[0].contains("while a result was being written"),
        "{notices:?}"
    );
    results::append_new(&path, now.results(), old).expect("kept");
    let (recovered, notices) = bench.recovered();
    assert_eq!(recovered.results(), now.results());
    assert!(notices.is_empty(), "{notices:?}");
}

#[test]
fn a_robot_that_was_changed_before_its_poses_were_measured() {
    let bench = Bench::new();
    let mut writer = bench.begin(&session_without_poses());
    let mut now = session_without_poses();
    now.robot.cables.pop();
    writer
        .write_changes(SessionChanges::of(&now, 0))
        .expect("kept");
    let one_cable = with_lengths(0, vec![1.0]);
    writer.append_pose(&one_cable).expect("on disk");
    now.append_pose(&one_cable).expect("a pose");
    now.name = "Tuesday".into();
    writer
        .write_changes(SessionChanges::of(&now, 0))
        .expect("kept");
    drop(writer);
    bench.assert_recovers(&now);
}

#[test]
fn changes_of_an_older_snapshot_count_no_more() {
    let bench = Bench::new();
    let mut writer = bench.begin(&session());
    let mut now = session();
    now.name = "Tuesday".into();
    writer
        .write_changes(SessionChanges::of(&now, 2))
        .expect("kept");
    let before = fs::read(bench.file(CHANGES)).expect("changes");
    now.name = "Wednesday".into();
    writer.write_snapshot(&now).expect("kept");
    assert!(!bench.file(CHANGES).exists());
    drop(writer);
    bench.assert_recovers(&now);
    // Killed before they were removed.
    fs::write(bench.file(CHANGES), before).expect("written");
    bench.assert_recovers(&now);
}

#[test]
fn changes_that_cannot_be_read_lose_no_pose() {
    let bench = Bench::new();
    let mut writer = bench.begin(&session());
    writer.append_pose(&pose(5)).expect("on disk");
    let changes = SessionChanges::of(&with_poses(5..6), 2);
    writer.write_changes(changes).expect("kept");
    drop(writer);
    fs::write(bench.file(CHANGES), "{").expect("written");
    let (session, notices) = bench.recovered();
    assert_eq!(session.measurements.labels, [3, 1, 5]);
    assert!(notices[0].contains("the latest edits"), "{notices:?}");
}

#[test]
fn a_long_run_writes_what_is_measured_and_not_its_square() {
    let bench = Bench::new();
    let pose = |label: i64| with_lengths(label, vec![1.0, 0.5 + 1e-4 * label as f64]);
    let mut writer = bench.begin(&session());
    let begun = fs::metadata(bench.file(SNAPSHOT)).expect("a file").len();
    let (mut now, mut edits) = (session(), 0_u64);
    for label in 5..1005 {
        writer.append_pose(&pose(label)).expect("on disk");
        now.append_pose(&pose(label)).expect("a pose");
        if label % 100 == 0 {
            now.exclude(label).expect("a pose");
            writer
                .write_changes(SessionChanges::of(&now, 2))
                .expect("kept");
            edits += fs::metadata(bench.file(CHANGES)).expect("a file").len();
        }
    }
    let journal = fs::metadata(bench.file(JOURNAL)).expect("a file").len();
    assert_eq!(
        fs::metadata(bench.file(SNAPSHOT)).expect("a file").len(),
        begun,
        "the snapshot is as it was"
    );
    drop(writer);
    let entry = |label| {
        journal::JournalEntry::of(&pose(label))
            .line()
            .expect("a line")
    };
    let poses: u64 = (5..1005).map(|label| entry(label).len() as u64).sum();
    assert_eq!(journal, poses, "each pose once");
    let written = begun + journal + edits;
    assert!(written < 3 * poses, "{written} bytes for {poses}");
    bench.assert_recovers(&now);
}

#[test]
fn a_failed_snapshot_loses_nothing() {
    let bench = Bench::new();
    let mut writer = bench.begin(&session());
    writer.append_pose(&pose(5)).expect("on disk");
    let mut broken = with_poses(5..6);
    broken.name.clear();
    assert!(writer.write_snapshot(&broken).is_err());
    let changes = SessionChanges::of(&with_poses(5..6), 3);
    assert!(
        writer.write_changes(changes).is_err(),
        "the snapshot that it follows is not there"
    );
    drop(writer);
    bench.assert_recovers(&with_poses(5..6));
}

#[test]
fn readings_that_no_file_can_hold_are_refused() {
    let bench = Bench::new();
    let mut writer = bench.begin(&session());
    let infinite = with_lengths(5, vec![f64::INFINITY, 1.0]);
    let error = writer.append_pose(&infinite).expect_err("infinite");
    assert!(
        error
            .to_string()
            .contains("found inf, expected a finite number"),
        "{error}"
    );
    drop(writer);
    bench.assert_recovers(&session());
}

#[test]
fn poses_that_do_not_fit_are_named() {
    let bench = Bench::new();
    let mut writer = bench.begin(&session());
    let three_cables = with_lengths(5, vec![1.0; 3]);
    let other_readings = with_lengths(1, vec![1.5, 0.3]);
    for pose in [&three_cables, &other_readings, &pose(6)] {
        writer.append_pose(pose).expect("on disk");
    }
    drop(writer);
    let (session, notices) = bench.recovered();
    assert_eq!(session.measurements.labels, [3, 1, 6]);
    assert!(notices[0].contains("pose 5 does not fit"), "{notices:?}");
    assert!(
        notices[1].contains("pose 1 was measured twice"),
        "{notices:?}"
    );
}

#[test]
fn the_origin_of_the_session_is_kept() {
    let bench = Bench::new();
    let file = bench.root.path().join("session.json");
    let writer =
        RecoveryWriter::create(bench.root.path(), Some(&file), &session()).expect("a writer");
    drop(writer);
    let left = bench.left();
    assert_eq!(left[0].origin.as_deref(), Some(file.as_path()));
    let recovered = left[0].recover().expect("a session").value;
    assert_eq!(recovered.origin.as_deref(), Some(file.as_path()));
    drop(left);
    fs::write(bench.file(ORIGIN), "x").expect("written");
    let (_, notices) = bench.recovered();
    assert!(
        notices[0].contains("save the session under a new name"),
        "{notices:?}"
    );
}

#[test]
fn what_cannot_be_read_is_shown_and_moved_aside() {
    let bench = Bench::new();
    let mut writer = bench.begin(&session());
    writer.append_pose(&pose(5)).expect("on disk");
    drop(writer);
    fs::write(bench.file(SNAPSHOT), "{").expect("written");
    let left = bench.left().pop().expect("one");
    let problem = left.problem.clone().expect("a problem").to_string();
    assert!(problem.contains("snapshot.json"), "{problem}");
    assert!(left.recover().is_err());
    let kept = left.discard().expect("moved");
    assert!(kept.starts_with(bench.root.path().join(DISCARDED)));
    assert!(kept.join(JOURNAL).exists());
    assert!(bench.left().is_empty());
}

#[test]
fn a_recovered_session_is_kept_again_before_the_remains_go() {
    let bench = Bench::new();
    let mut writer = bench.begin(&session());
    writer.append_pose(&pose(5)).expect("on disk");
    drop(writer);
    let left = bench.left().pop().expect("one");
    let recovered = left.recover().expect("a session").value;
    let writer = bench.begin(&recovered.session);
    left.discard().expect("moved");
    assert!(bench.left().is_empty());
    drop(writer);
    let left = bench.left();
    assert_eq!((left.len(), left[0].poses), (1, 3));
}

#[cfg(unix)]
#[test]
fn only_files_of_ours_are_removed_and_no_link_is_followed() {
    use std::os::unix::fs::symlink;
    let bench = Bench::new();
    let root = bench.root.path();
    let outside = tempfile::tempdir().expect("a folder");
    let theirs = outside.path().join(SNAPSHOT);
    fs::write(&theirs, "theirs").expect("written");
    let writer = bench.begin(&session());
    let own = bench.own();
    fs::write(own.join("notes.txt"), "theirs").expect("written");
    symlink(&theirs, own.join("results.jsonl")).expect("a link");
    writer.finish().expect("removed");
    let rest = own.with_extension(FINISHED);
    assert!(rest.join("notes.txt").exists() && rest.join("results.jsonl").is_symlink());
    assert!(!rest.join(SNAPSHOT).exists() && !rest.join(JOURNAL).exists());
    // Folders that are links, whatever their names, and files with other names than ours.
    for name in ["session-aaaaaa", "session-bbbbbb.finished"] {
        symlink(outside.path(), root.join(name)).expect("a link");
    }
    fs::create_dir_all(root.join(DISCARDED).join("session-cccccc")).expect("a folder");
    fs::write(root.join(DISCARDED).join("letter"), "theirs").expect("written");
    symlink(outside.path(), root.join(DISCARDED).join("session-dddddd")).expect("a link");
    fs::write(root.join("session-report.lock.txt"), "theirs").expect("written");
    symlink(&theirs, root.join("session-eeeeee.lock")).expect("a link");
    assert!(bench.left().is_empty());
    remove_discarded(root).expect("removed");
    assert_eq!(fs::read_to_string(&theirs).expect("there"), "theirs");
    assert!(root.join(DISCARDED).join("letter").exists());
    assert!(!root.join(DISCARDED).join("session-cccccc").exists());
    for name in ["session-report.lock.txt", "session-eeeeee.lock"] {
        assert!(root.join(name).symlink_metadata().is_ok(), "{name}");
    }
}

#[cfg(unix)]
#[test]
fn a_lock_that_is_a_link_is_not_opened() {
    let bench = Bench::new();
    drop(bench.begin(&session()));
    let outside = tempfile::tempdir().expect("a folder");
    let lock = bench.own().with_extension(LOCK);
    fs::remove_file(&lock).expect("removed");
    std::os::unix::fs::symlink(outside.path().join("made"), &lock).expect("a link");
    let refused = find_unsaved_sessions(bench.root.path()).expect_err("a link");
    assert!(refused.to_string().contains("is a link"), "{refused}");
    assert!(!outside.path().join("made").exists());
}

#[test]
fn a_damaged_snapshot_does_not_keep_the_journal_from_coming_back() {
    let bench = Bench::new();
    let file = bench.root.path().join("file.json");
    write_session(&file, &with_poses([])).expect("written");
    let writer = RecoveryWriter::create(bench.root.path(), Some(&file), &with_poses([]));
    let mut writer = writer.expect("a writer");
    for label in [5, 6] {
        writer.append_pose(&pose(label)).expect("on disk");
    }
    drop(writer);
    let snapshot = fs::read(bench.file(SNAPSHOT)).expect("a file");
    fs::write(bench.file(SNAPSHOT), &snapshot[..snapshot.len() / 2]).expect("written");
    let left = bench.left();
    let Loaded { value, notices } = left[0].recover().expect("a session");
    assert!(!value.is_whole);
    // As text, because missing readings are NaN, which equals nothing.
    let expected = with_poses([5, 6]).measurements;
    assert_eq!(
        format!("{:?}", value.session.measurements),
        format!("{expected:?}")
    );
    assert!(
        notices[0].contains("the session is that of its file"),
        "{notices:?}"
    );
    // Without a file there is nothing that the poses could belong to.
    fs::remove_file(&file).expect("removed");
    let refused = left[0].recover().expect_err("nothing");
    assert!(refused.to_string().contains(SNAPSHOT), "{refused}");
}
