//! Keeps what is not saved yet, on a thread of its own, so that a crash loses nothing.

use std::path::{Path, PathBuf};
use std::sync::mpsc;
use std::thread::{self, JoinHandle};

use tautline_session::{Keeper, LeftBehind, MeasuredPose, Session, WriteError};

use super::document::Document;

/// What the thread is to do.
enum Job {
    /// Keep the session as it is now.
    Snapshot {
        session: Box<Session>,
        origin: Option<PathBuf>,
    },
    /// Keep one more measured pose.
    Measured(Box<MeasuredPose>),
    /// Set aside what an earlier crash has left behind.
    SetAside(Box<LeftBehind>),
    /// Nothing is unsaved any more, or the operator does not want it.
    Finish,
}

/// What the thread has to tell.
#[derive(Debug)]
pub enum Kept {
    /// The pose of this label is on disk.
    Measured(i64),
    /// Something could not be kept; one sentence.
    Failed(String),
}

/// Keeps the open session.
pub struct Keeping {
    jobs: Option<mpsc::Sender<Job>>,
    kept: mpsc::Receiver<Kept>,
    thread: Option<JoinHandle<()>>,
    /// Identity and revision of the document that was handed over last; `None` while nothing is kept.
    followed: Option<(u64, u64)>,
}

impl Keeping {
    /// Keeps in the recovery folder `folder`; `context` is woken when there is something to tell.
    #[must_use]
    pub fn new(folder: PathBuf, context: egui::Context) -> Self {
        let (jobs, orders) = mpsc::channel();
        let (tell, kept) = mpsc::channel();
        let work = move || {
            work(&folder, &orders, |message| {
                // Nobody listens any more when the program ends.
                let _ = tell.send(message);
                context.request_repaint();
            });
        };
        let thread = thread::Builder::new()
            .name("keeping".into())
            .spawn(work)
            .ok();
        Self {
            jobs: Some(jobs),
            kept,
            thread,
            followed: None,
        }
    }

    /// Hands the document over if it has changes that neither its file nor the recovery folder has.
    pub fn follow(&mut self, document: Option<&Document>) {
        let now = document.map(|document| (document.identity(), document.revision()));
        if now == self.followed {
            return;
        }
        let other =
            now.map(|(identity, _)| identity) != self.followed.map(|(identity, _)| identity);
        let unsaved = document.filter(|document| document.is_unsaved());
        if self.followed.is_some() && (other || unsaved.is_none()) {
            self.send(Job::Finish);
            self.followed = None;
        }
        if let Some(document) = unsaved {
            let origin = document.path().map(Path::to_owned);
            self.send(Job::Snapshot {
                session: Box::new(document.session().clone()),
                origin,
            });
            self.followed = now;
        }
    }

    /// Keeps a measured pose at once; [`Kept::Measured`] tells when it is on disk.
    pub fn measured(&self, pose: MeasuredPose) {
        self.send(Job::Measured(Box::new(pose)));
    }

    /// Sets aside what an earlier crash has left behind, after everything that was handed over before.
    pub fn set_aside(&self, left: LeftBehind) {
        self.send(Job::SetAside(Box::new(left)));
    }

    /// What happened since the last call.
    pub fn kept(&self) -> Vec<Kept> {
        self.kept.try_iter().collect()
    }

    /// Waits until everything that was handed over is on disk; nothing is kept afterwards.
    pub fn flush(&mut self) {
        self.jobs = None;
        if let Some(thread) = self.thread.take() {
            // A thread that broke down has nothing more to write.
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

impl Drop for Keeping {
    fn drop(&mut self) {
        self.flush();
    }
}

fn work(folder: &Path, orders: &mpsc::Receiver<Job>, tell: impl Fn(Kept)) {
    let mut keeper = None;
    while let Ok(first) = orders.recv() {
        let mut jobs = vec![first];
        jobs.extend(orders.try_iter());
        for job in newest(jobs) {
            if let Err(message) = perform(folder, &mut keeper, job, &tell) {
                tell(Kept::Failed(message));
            }
        }
    }
}

/// Leaves out snapshots that a later one makes needless.
fn newest(jobs: Vec<Job>) -> Vec<Job> {
    let mut wanted: Vec<Job> = Vec::new();
    for job in jobs {
        if matches!(
            (&job, wanted.last()),
            (Job::Snapshot { .. }, Some(Job::Snapshot { .. }))
        ) {
            wanted.pop();
        }
        wanted.push(job);
    }
    wanted
}

fn perform(
    folder: &Path,
    keeper: &mut Option<Keeper>,
    job: Job,
    tell: &impl Fn(Kept),
) -> Result<(), String> {
    let failed = |error: WriteError| format!("The session could not be kept for recovery: {error}");
    match job {
        Job::Snapshot { session, origin } => match keeper {
            Some(keeper) => keeper.snapshot(&session).map_err(failed),
            None => {
                *keeper = Some(Keeper::begin(folder, origin.as_deref(), &session).map_err(failed)?);
                Ok(())
            }
        },
        Job::Measured(pose) => {
            let keeper = keeper
                .as_mut()
                .ok_or("A measured pose could not be kept: nothing is being kept.")?;
            keeper.measured(&pose).map_err(failed)?;
            tell(Kept::Measured(pose.label));
            Ok(())
        }
        Job::SetAside(left) => left.discard().map(drop).map_err(failed),
        Job::Finish => keeper.take().map_or(Ok(()), Keeper::finish).map_err(failed),
    }
}
