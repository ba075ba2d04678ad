//! Publishes events and status of the controller's thread to the window.

use std::sync::mpsc::Sender;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

use tautline_core::robot::Robot;
use tautline_link::Sample;

use super::message::{DriverEvent, LiveState};
use super::scope::Scope;

/// Minimum interval between two frames of the window.
pub(super) const PICTURE: Duration = Duration::from_millis(50);

/// Publishes to the window, and wakes it no more often than it can draw.
pub(super) struct StatusPublisher {
    pub events: Sender<DriverEvent>,
    pub live: Arc<Mutex<LiveState>>,
    pub scope: Arc<Mutex<Option<Scope>>>,
    pub context: egui::Context,
    pub woken: Option<Instant>,
}

impl StatusPublisher {
    pub fn report(&mut self, event: DriverEvent) {
        // The receiver is gone when the program ends.
        let _ = self.events.send(event);
        self.wake();
    }

    pub fn wake(&mut self) {
        let since = self.woken.map_or(PICTURE, |woken| woken.elapsed());
        if since >= PICTURE {
            self.woken = Some(Instant::now());
            self.context.request_repaint();
        } else {
            self.context.request_repaint_after(PICTURE - since);
        }
    }

    /// Replaces the published state.
    pub fn put(&mut self, live: LiveState) {
        *self.live.lock().unwrap_or_else(PoisonError::into_inner) = live;
        self.wake();
    }

    /// Begins to record the readings of a robot.
    pub fn begin_scope(&self, robot: &Robot) {
        let scope = Scope::new(robot);
        *self.scope.lock().unwrap_or_else(PoisonError::into_inner) = Some(scope);
    }

    pub fn record(&self, sample: &Sample) {
        let mut scope = self.scope.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(scope) = scope.as_mut() {
            scope.record(sample);
        }
    }

    /// Whether the published state satisfies a condition.
    pub fn shows(&self, is_so: impl FnOnce(&LiveState) -> bool) -> bool {
        is_so(&self.live.lock().unwrap_or_else(PoisonError::into_inner))
    }

    pub fn is_due(&self) -> bool {
        self.woken.is_none_or(|woken| woken.elapsed() >= PICTURE)
    }
}
