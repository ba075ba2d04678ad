//! Test of a laser: a thread connects and reads lines until the test is dropped.

use std::sync::mpsc::{self, Receiver, RecvTimeoutError, Sender};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::{self, JoinHandle};
use std::time::Duration;

use tautline_link::laser::LineLaser;
use tautline_link::{LaserSource, SystemClock};
use tautline_session::LineLaserSettings;

/// Interval between two readings.
const INTERVAL: Duration = Duration::from_millis(150);

#[derive(Debug, Clone, Default, PartialEq)]
pub struct LaserTest {
    pub last_line: Option<String>,
    /// The distance (m), or the reason why there is none.
    pub parsed: Option<Result<f64, String>>,
}

/// Thread that tests a laser; dropping it ends the test.
#[derive(Debug)]
pub struct TestLine {
    pub settings: LineLaserSettings,
    result: Arc<Mutex<LaserTest>>,
    running: Option<(Sender<()>, JoinHandle<()>)>,
}

impl TestLine {
    /// Starts the test; `context` is repainted when the result changes.
    #[must_use]
    pub fn start(settings: LineLaserSettings, context: egui::Context) -> Self {
        let shared = Arc::<Mutex<LaserTest>>::default();
        let (end, ends) = mpsc::channel();
        let (laser, result) = (settings.clone(), Arc::clone(&shared));
        let thread = thread::Builder::new().name("laser test".into());
        let started = thread.spawn(move || listen(laser, &result, &ends, &context));
        if let Err(error) = &started {
            update(&shared, |result| {
                result.parsed = Some(Err(error.to_string()));
            });
        }
        Self {
            settings,
            result: shared,
            running: started.ok().map(|thread| (end, thread)),
        }
    }

    #[must_use]
    pub fn result(&self) -> LaserTest {
        self.result
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

/// Updates the shared result; returns whether it changed.
fn update(result: &Mutex<LaserTest>, change: impl FnOnce(&mut LaserTest)) -> bool {
    let mut result = result.lock().unwrap_or_else(PoisonError::into_inner);
    let before = result.clone();
    change(&mut result);
    *result != before
}

fn listen(
    settings: LineLaserSettings,
    result: &Mutex<LaserTest>,
    ends: &Receiver<()>,
    context: &egui::Context,
) {
    let mut laser = LineLaser::new(settings, Arc::new(SystemClock::start()));
    loop {
        let parsed = match laser.connect() {
            Err(error) => Some(Err(error.to_string())),
            Ok(()) => match laser.distance_m() {
                Some(distance_m) => Some(Ok(distance_m)),
                None => laser.problem().map(Err),
            },
        };
        let last_line = laser.line();
        if update(result, |result| *result = LaserTest { last_line, parsed }) {
            context.request_repaint();
        }
        if ends.recv_timeout(INTERVAL) != Err(RecvTimeoutError::Timeout) {
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
    fn the_result_has_the_last_line_and_its_distance() {
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
        let expected = LaserTest {
            last_line: Some("D: 512.5 mm".into()),
            parsed: Some(Ok(0.5125)),
        };
        let mut looks = 0;
        while test.result() != expected {
            looks += 1;
            assert!(looks < 1500, "{:?}", test.result());
            thread::sleep(Duration::from_millis(20));
        }
        drop(test);
        server.join().expect("it ends with the test");
    }
}
