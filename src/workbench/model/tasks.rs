//! Tasks on background threads, with title, progress and cancellation; they report by messages.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError, mpsc};
use std::thread;

use tautline_core::estimation::Control;

use super::caught_panic::{self, CaughtPanic};
use super::command::Outcome;
use super::memory;

#[derive(Debug, Clone, Default, PartialEq)]
pub struct TaskProgress {
    /// Completed share, if known.
    pub fraction: Option<f32>,
    pub text: String,
}

/// Running task as seen by the user interface.
#[derive(Debug)]
pub struct Running {
    id: u64,
    /// Title, such as "Identifying".
    pub title: String,
    shared: Arc<Shared>,
}

#[derive(Debug, Default)]
struct Shared {
    cancelled: AtomicBool,
    progress: Mutex<TaskProgress>,
}

impl Running {
    #[must_use]
    pub fn progress(&self) -> TaskProgress {
        self.shared
            .progress
            .lock()
            .unwrap_or_else(PoisonError::into_inner)
            .clone()
    }

    /// Requests cancellation.
    pub fn cancel(&self) {
        self.shared.cancelled.store(true, Ordering::Relaxed);
    }
}

/// Running task as seen by its own code.
pub struct TaskHandle {
    shared: Arc<Shared>,
    context: egui::Context,
}

impl TaskHandle {
    /// Whether cancellation was requested.
    #[must_use]
    pub fn cancelled(&self) -> bool {
        self.shared.cancelled.load(Ordering::Relaxed)
    }

    /// [`Control::Cancel`] once cancellation was requested.
    #[must_use]
    pub fn control(&self) -> Control {
        if self.cancelled() {
            Control::Cancel
        } else {
            Control::Continue
        }
    }

    pub fn tell(&self, fraction: Option<f32>, text: impl Into<String>) {
        let text = text.into();
        *self
            .shared
            .progress
            .lock()
            .unwrap_or_else(PoisonError::into_inner) = TaskProgress { fraction, text };
        self.context.request_repaint();
    }
}

pub struct Tasks {
    context: egui::Context,
    sender: mpsc::Sender<(u64, Outcome)>,
    receiver: mpsc::Receiver<(u64, Outcome)>,
    running: Vec<Running>,
    next: u64,
}

impl Tasks {
    /// No tasks; `context` is repainted after progress messages.
    #[must_use]
    pub fn new(context: egui::Context) -> Self {
        let (sender, receiver) = mpsc::channel();
        Self {
            context,
            sender,
            receiver,
            running: Vec::new(),
            next: 0,
        }
    }

    /// Starts a task; its outcome arrives in the next frame after its end.
    pub fn start(
        &mut self,
        title: impl Into<String>,
        work: impl FnOnce(&TaskHandle) -> Outcome + Send + 'static,
    ) {
        let id = self.next;
        self.next += 1;
        let shared = Arc::new(Shared::default());
        let title = title.into();
        self.running.push(Running {
            id,
            title: title.clone(),
            shared: Arc::clone(&shared),
        });
        let handle = TaskHandle {
            shared,
            context: self.context.clone(),
        };
        let (sender, context) = (self.sender.clone(), self.context.clone());
        let named = title.clone();
        let run = move || {
            let outcome = caught_panic::guard(|| work(&handle)).unwrap_or_else(|caught_panic| {
                Outcome::Panicked {
                    task: named,
                    caught_panic,
                }
            });
            // The receiver is gone when the program ends.
            let _ = sender.send((id, outcome));
            context.request_repaint();
            memory::give_back();
        };
        if thread::Builder::new()
            .name(title.clone())
            .spawn(run)
            .is_err()
        {
            let _ = self.sender.send((
                id,
                Outcome::Panicked {
                    task: title,
                    caught_panic: CaughtPanic {
                        message: "no thread could be started".into(),
                    },
                },
            ));
        }
    }

    /// Outcomes since the last call.
    pub fn outcomes(&mut self) -> Vec<Outcome> {
        let arrived: Vec<(u64, Outcome)> = self.receiver.try_iter().collect();
        self.running
            .retain(|task| arrived.iter().all(|(id, _)| *id != task.id));
        arrived.into_iter().map(|(_, outcome)| outcome).collect()
    }

    /// Running tasks, oldest first.
    #[must_use]
    pub fn running(&self) -> &[Running] {
        &self.running
    }

    #[must_use]
    pub fn runs(&self, title: &str) -> bool {
        self.running.iter().any(|task| task.title == title)
    }

    /// Requests cancellation of all tasks of this title.
    pub fn cancel(&self, title: &str) {
        self.running
            .iter()
            .filter(|task| task.title == title)
            .for_each(Running::cancel);
    }
}
