//! A laser that is tried: a thread of its own connects and listens until it is not wanted any more.

use std::sync::mpsc::{self, Receiver, RecvTimeoutError, Sender};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::{self, JoinHandle};
use std::time::Duration;

use tautline_link::laser::LineLaser;
use tautline_link::{LaserSource, SystemClock};
use tautline_session::LineLaserSettings;

/// Between two looks at what arrived.
const LOOK: Duration = Duration::from_millis(150);

/// What arrived, and what is understood of it.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Heard {
    /// The last line as it came.
    pub line: Option<String>,
    /// The distance (m), or why there is none.
    pub understood: Option<Result<f64, String>>,
}

/// A laser that is tried; it ends with this.
#[derive(Debug)]
pub struct TestLine {
    /// What it is tried with.
    pub settings: LineLaserSettings,
    heard: Arc<Mutex<Heard>>,
    running: Option<(Sender<()>, JoinHandle<()>)>,
}

impl TestLine {
    /// Begins to listen; `context` is woken by what is new.
    #[must_use]
    pub fn start(settings: LineLaserSettings, context: egui::Context) -> Self {
        let heard = Arc::<Mutex<Heard>>::default();
        let (end, ends) = mpsc::channel();
        let (laser, shared) = (settings.clone(), Arc::clone(&heard));
        let thread = thread::Builder::new().name("laser test".into());
        let started = thread.spawn(move || listen(laser, &shared, &ends, &context));
        if let Err(error) = &started {
            tell(&heard, |heard| {
                heard.understood = Some(Err(error.to_string()));
            });
        }
        Self {
            settings,
            heard,
            running: started.ok().map(|thread| (end, thread)),
        }
    }

    /// What arrived last.
    #[must_use]
    pub fn heard(&self) -> Heard {
        self.heard
            .lock()
            .unwrap_or_else(PoisonError::into_inner)
            .clone()
    }
}

impl Drop for TestLine {
    /// The device is free for another connection after this.
    fn drop(&mut self) {
        if let Some((end, thread)) = self.running.take() {
            drop(end);
            // A thread that panicked has ended, too.
            let _ = thread.join();
        }
    }
}

/// Changes what is told; whether that is new.
fn tell(heard: &Mutex<Heard>, change: impl FnOnce(&mut Heard)) -> bool {
    let mut heard = heard.lock().unwrap_or_else(PoisonError::into_inner);
    let before = heard.clone();
    change(&mut heard);
    *heard != before
}

fn listen(
    settings: LineLaserSettings,
    heard: &Mutex<Heard>,
    ends: &Receiver<()>,
    context: &egui::Context,
) {
    let mut laser = LineLaser::new(settings, Arc::new(SystemClock::start()));
    loop {
        let understood = match laser.connect() {
            Err(error) => Some(Err(error.to_string())),
            Ok(()) => match laser.distance_m() {
                Some(distance_m) => Some(Ok(distance_m)),
                None => laser.problem().map(Err),
            },
        };
        let line = laser.line();
        if tell(heard, |heard| *heard = Heard { line, understood }) {
            context.request_repaint();
        }
        if ends.recv_timeout(LOOK) != Err(RecvTimeoutError::Timeout) {
            return;
        }
    }
}

#[cfg(test)]
mod tests {
    use std::io::Write;
    use std::net::TcpListener;

    use tautline_session::LaserPort;

    use super::*;

    #[test]
    fn what_arrives_is_told_as_it_came_and_as_it_is_understood() {
        let listener = TcpListener::bind("127.0.0.1:0").expect("a port");
        let port = listener.local_addr().expect("an address").port();
        let server = thread::spawn(move || {
            let (mut socket, _) = listener.accept().expect("a client");
            while socket.write_all(b"D: 512.5 mm\r\n").is_ok() {
                thread::sleep(Duration::from_millis(20));
            }
        });
        let host = "127.0.0.1".to_owned();
        let settings = LineLaserSettings::new(LaserPort::Tcp { host, port });
        let test = TestLine::start(settings, egui::Context::default());
        let expected = Heard {
            line: Some("D: 512.5 mm".into()),
            understood: Some(Ok(0.5125)),
        };
        let mut looks = 0;
        while test.heard() != expected {
            looks += 1;
            assert!(looks < 1500, "{:?}", test.heard());
            thread::sleep(Duration::from_millis(20));
        }
        drop(test);
        server.join().expect("it ends with the test");
    }
}
