//! Writes unsaved changes to the recovery folder, on a separate thread, so that a crash loses nothing.

use std::path::{Path, PathBuf};
use std::sync::mpsc;
use std::thread::{self, JoinHandle};

use tautline_session::{
    MeasuredPose, RecoveryWriter, Session, SessionChanges, UnsavedSession, WriteError,
};

use super::{OpenSession, memory};

enum Job {
    /// Snapshot of the whole session.
    Snapshot {
        session: Box<Session>,
        origin: Option<PathBuf>,
    },
    /// Changes since the last snapshot, other than measured poses.
    Changed(Box<SessionChanges>),
    /// One more measured pose.
    Measured(Box<MeasuredPose>),
    /// Discard a recovered session of an earlier crash.
    Discard(Box<UnsavedSession>),
    /// Report when all earlier jobs are on disk.
    Tell,
    /// End: nothing is unsaved any more, or the operator discarded it.
    Finish,
}

#[derive(Debug)]
pub enum AutosaveEvent {
    /// The pose of this label is on disk.
    Measured(i64),
    /// All jobs before `Job::Tell` are on disk.
    Kept,
    /// Error message of a failed write.
    Failed(String),
}

/// Revision and poses of the session at the last job.
#[derive(Debug, Clone, Copy)]
struct AutosavedState {
    identity: u64,
    revision: u64,
    edits: u64,
    replaced: u64,
    /// Number of measured poses, all on disk.
    poses: usize,
    /// Number of poses of the last snapshot; `None` after a failed write.
    snapshot: Option<usize>,
}

impl AutosavedState {
    fn new(open: &OpenSession, snapshot: usize) -> Self {
        Self {
            identity: open.id(),
            revision: open.revision(),
            edits: open.edits(),
            replaced: open.replaced(),
            poses: open.session().measurements.len(),
            snapshot: Some(snapshot),
        }
    }
}

/// Autosave of the open session.
pub struct Autosave {
    jobs: Option<mpsc::Sender<Job>>,
    events: mpsc::Receiver<AutosaveEvent>,
    thread: Option<JoinHandle<()>>,
    /// State of the session at the last job; `None` while nothing is unsaved.
    followed: Option<AutosavedState>,
    /// Labels of measured poses that were sent to the thread before the session had them.
    ahead: Vec<i64>,
}

impl Autosave {
    /// Starts the thread that writes to the recovery folder `folder`; `context` is woken when an event arrives.
    #[must_use]
    pub fn new(folder: PathBuf, context: egui::Context) -> Self {
        let (jobs, received) = mpsc::channel();
        let (tell, events) = mpsc::channel();
        let work = move || {
            work(&folder, &received, |message| {
                // The receiver is gone when the program ends.
                let _ = tell.send(message);
                context.request_repaint();
            });
        };
        let thread = thread::Builder::new()
            .name("autosave".into())
            .spawn(work)
            .ok();
        Self {
            jobs: Some(jobs),
            events,
            thread,
            followed: None,
            ahead: Vec::new(),
        }
    }

    /// Sends the changes that are neither in the file of the session nor in the recovery folder.
    pub fn follow(&mut self, open: Option<&OpenSession>) {
        let now = open.map(|open| (open.id(), open.revision()));
        let before = self.followed;
        // Saving does not change the revision, but it ends the autosave.
        if now == before.map(|f| (f.identity, f.revision))
            && open.is_none_or(OpenSession::is_unsaved)
        {
            return;
        }
        let other = now.map(|(identity, _)| identity) != before.map(|f| f.identity);
        let unsaved = open.filter(|open| open.is_unsaved());
        let ahead = std::mem::take(&mut self.ahead);
        let has = |label: &i64| {
            open.is_some_and(|open| open.session().measurements.labels.contains(label))
        };
        let still_ahead = ahead.iter().filter(|label| !other && !has(label));
        self.ahead = still_ahead.copied().collect();
        // A file saved while a pose was being sent does not contain that pose.
        let is_done = unsaved.is_none() && self.ahead.is_empty();
        if before.is_some() && (other || is_done) {
            self.send(Job::Finish);
            self.followed = None;
        }
        if let Some(open) = unsaved {
            self.hand_over(open, &ahead);
        }
    }

    /// Sends the changes, or a new snapshot; poses with the labels of `ahead` were sent before.
    fn hand_over(&mut self, open: &OpenSession, ahead: &[i64]) {
        let session = open.session();
        let is_kept = |before: &AutosavedState| {
            let new = session.measurements.labels.get(before.poses..);
            let new = new.is_some_and(|new| new.iter().all(|label| ahead.contains(label)));
            (new && before.replaced == open.replaced())
                .then_some(before.snapshot)
                .flatten()
        };
        let poses = match self.followed.as_ref().map(|f| (f, is_kept(f))) {
            Some((before, Some(snapshot))) => {
                if before.edits != open.edits() {
                    self.send(Job::Changed(Box::new(SessionChanges::of(
                        session, snapshot,
                    ))));
                }
                snapshot
            }
            _ => {
                self.send(Job::Snapshot {
                    session: Box::new(session.clone()),
                    origin: open.path().map(Path::to_owned),
                });
                session.measurements.len()
            }
        };
        self.followed = Some(AutosavedState::new(open, poses));
    }

    /// Sends a measured pose at once; [`AutosaveEvent::Measured`] reports that it is on disk.
    pub fn measured(&mut self, pose: MeasuredPose) {
        self.ahead.push(pose.label());
        self.send(Job::Measured(Box::new(pose)));
    }

    /// Asks for [`AutosaveEvent::Kept`] when all earlier jobs are on disk.
    pub fn tell(&self) {
        self.send(Job::Tell);
    }

    /// Discards a recovered session of an earlier crash, after all earlier jobs.
    pub fn discard(&self, left: UnsavedSession) {
        self.send(Job::Discard(Box::new(left)));
    }

    /// Events since the last call; after a failed write the next job is a new snapshot.
    pub fn events(&mut self) -> Vec<AutosaveEvent> {
        let events: Vec<AutosaveEvent> = self.events.try_iter().collect();
        let failed = |event: &AutosaveEvent| matches!(event, AutosaveEvent::Failed(_));
        let has_failed = events.iter().any(failed);
        if let Some(followed) = self.followed.as_mut().filter(|_| has_failed) {
            followed.snapshot = None;
        }
        events
    }

    /// Waits until all jobs are on disk and ends the thread.
    pub fn flush(&mut self) {
        self.jobs = None;
        if let Some(thread) = self.thread.take() {
            // A thread that panicked has nothing more to write.
            let _ = thread.join();
        }
    }

    fn send(&self, job: Job) {
        if let Some(jobs) = &self.jobs {
            // The thread ends with the program only.
            let _ = jobs.send(job);
        }
    }
}

impl Drop for Autosave {
    fn drop(&mut self) {
        self.flush();
    }
}

fn work(folder: &Path, jobs: &mpsc::Receiver<Job>, tell: impl Fn(AutosaveEvent)) {
    let mut writer = None;
    while let Ok(first) = jobs.recv() {
        let mut batch = vec![first];
        batch.extend(jobs.try_iter());
        let batch = newest(batch);
        let wrote_much = batch.iter().any(|job| matches!(job, Job::Snapshot { .. }));
        for job in batch {
            if let Err(message) = perform(folder, &mut writer, job, &tell) {
                tell(AutosaveEvent::Failed(message));
            }
        }
        if wrote_much {
            memory::give_back();
        }
    }
}

/// Leaves out snapshots and changes that a later job supersedes.
fn newest(jobs: Vec<Job>) -> Vec<Job> {
    let mut wanted: Vec<Job> = Vec::new();
    for job in jobs {
        while let Some(before) = wanted.last() {
            let is_needless = match job {
                Job::Snapshot { .. } => matches!(before, Job::Snapshot { .. } | Job::Changed(_)),
                Job::Changed(_) => matches!(before, Job::Changed(_)),
                _ => false,
            };
            if !is_needless {
                break;
            }
            wanted.pop();
        }
        wanted.push(job);
    }
    wanted
}

fn perform(
    folder: &Path,
    writer: &mut Option<RecoveryWriter>,
    job: Job,
    tell: &impl Fn(AutosaveEvent),
) -> Result<(), String> {
    let failed =
        |error: WriteError| format!("The session could not be saved for recovery: {error}");
    match job {
        Job::Snapshot { session, origin } => match writer {
            Some(writer) => writer.write_snapshot(&session).map_err(failed),
            None => {
                *writer = Some(
                    RecoveryWriter::create(folder, origin.as_deref(), &session).map_err(failed)?,
                );
                Ok(())
            }
        },
        Job::Changed(changes) => {
            let writer = writer.as_mut().ok_or(
                "A change could not be saved for recovery: the session is not being autosaved.",
            )?;
            writer.write_changes(*changes).map_err(failed)
        }
        Job::Measured(pose) => {
            let writer = writer
                .as_mut()
                .ok_or("A measured pose could not be saved for recovery: the session is not being autosaved.")?;
            writer.append_pose(&pose).map_err(failed)?;
            tell(AutosaveEvent::Measured(pose.label()));
            Ok(())
        }
        Job::Tell => {
            tell(AutosaveEvent::Kept);
            Ok(())
        }
        Job::Discard(left) => left.discard().map(drop).map_err(failed),
        Job::Finish => writer
            .take()
            .map_or(Ok(()), RecoveryWriter::finish)
            .map_err(failed),
    }
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use tautline_core::measurement::{Grid, Measurements};
    use tautline_core::robot::presets;
    use tautline_session::find_unsaved_sessions;

    use super::*;
    use crate::model::edit::Edit;
    use tautline_workflow::clock;

    fn pose(label: i64) -> MeasuredPose {
        MeasuredPose::from(Measurements {
            labels: vec![label],
            revolutions: Grid::of_row(vec![0.0; 8]),
            force_n: Grid::of_row(vec![50.0; 8]),
            laser_m: vec![1.0],
            ..Measurements::default()
        })
    }

    fn measured_label(autosave: &Autosave) -> i64 {
        let event = autosave.events.recv_timeout(Duration::from_secs(60));
        match event.expect("it is kept") {
            AutosaveEvent::Measured(label) => label,
            event => panic!("{event:?}"),
        }
    }

    #[test]
    fn a_file_saved_while_a_pose_is_on_its_way_does_not_take_the_pose_away() {
        let folder = tempfile::tempdir().expect("a folder");
        let robot = presets::find("mini").expect("a preset").robot;
        let mut open = OpenSession::new(Session::new("MINI", robot, clock::now()), None);
        let mut autosave = Autosave::new(folder.path().into(), egui::Context::default());
        autosave.follow(Some(&open));
        let written = open.revision();
        autosave.measured(pose(0));
        assert_eq!(measured_label(&autosave), 0);
        // The file was begun before the pose arrived and finished before the session had it.
        open.saved_as(folder.path().join("saved.json"), written);
        autosave.follow(Some(&open));
        autosave.flush();
        let left = find_unsaved_sessions(folder.path()).expect("readable");
        assert_eq!(left.len(), 1);
        assert_eq!(left[0].poses, 1);
    }

    #[test]
    fn nothing_is_kept_once_the_file_has_everything() {
        let folder = tempfile::tempdir().expect("a folder");
        let robot = presets::find("mini").expect("a preset").robot;
        let mut open = OpenSession::new(Session::new("MINI", robot, clock::now()), None);
        let mut autosave = Autosave::new(folder.path().into(), egui::Context::default());
        autosave.follow(Some(&open));
        autosave.measured(pose(0));
        assert_eq!(measured_label(&autosave), 0);
        open.append_pose(&pose(0)).expect("it fits");
        autosave.follow(Some(&open));
        open.saved_as(folder.path().join("saved.json"), open.revision());
        autosave.follow(Some(&open));
        autosave.flush();
        assert!(
            find_unsaved_sessions(folder.path())
                .expect("readable")
                .is_empty()
        );
    }

    #[test]
    fn measured_poses_are_lines_of_the_journal_and_nothing_else() {
        let folder = tempfile::tempdir().expect("a folder");
        let robot = presets::find("mini").expect("a preset").robot;
        let mut open = OpenSession::new(Session::new("MINI", robot, clock::now()), None);
        let mut autosave = Autosave::new(folder.path().into(), egui::Context::default());
        autosave.follow(Some(&open));
        let measure = |autosave: &mut Autosave, open: &mut OpenSession, label| {
            autosave.follow(Some(open));
            autosave.measured(pose(label));
            assert_eq!(measured_label(autosave), label);
            open.append_pose(&pose(label)).expect("it fits");
            autosave.follow(Some(open));
        };
        for label in 0..30 {
            measure(&mut autosave, &mut open, label);
        }
        let size = |name: &str| {
            let own = std::fs::read_dir(folder.path()).expect("a folder");
            let own = own.map(|entry| entry.expect("an entry").path());
            let own = own.filter(|path| path.is_dir());
            let file = own.last().expect("a session").join(name);
            file.metadata().map_or(0, |metadata| metadata.len())
        };
        let empty = size("snapshot.json");
        assert!(size("journal.jsonl") > 30 * 300);
        assert_eq!(size("changes.json"), 0, "nothing was edited");
        open.edit(Edit::Exclude(7));
        measure(&mut autosave, &mut open, 30);
        assert_eq!(
            size("snapshot.json"),
            empty,
            "an edit does not write the poses"
        );
        assert!(size("changes.json") < empty + 500);
        // Measurements that did not arrive pose by pose are written as a snapshot.
        open.append(|session| session.measurements.laser_m[3] = 2.0);
        measure(&mut autosave, &mut open, 31);
        assert!(size("snapshot.json") > empty + 31 * 50);
        autosave.flush();
        let left = find_unsaved_sessions(folder.path()).expect("readable");
        let recovered = left[0].recover().expect("a session").value.session;
        assert_eq!(recovered.measurements, open.session().measurements);
        assert_eq!(recovered.excluded(), open.session().excluded());
    }
}
