//! A laser distance sensor that sends lines of text over a network connection or a serial port.

mod text;

use std::io::{self, ErrorKind};
use std::sync::mpsc::{self, Receiver, RecvTimeoutError, Sender};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant};

use tautline_session::LineLaserSettings;

use text::{LineContent, LineParser, LineSplitter};

use super::port::{self, Port};
use super::source::{LaserReading, LaserSource};
use crate::clock::Clock;
use crate::error::LinkError;

/// First and longest pause before a lost connection is re-established; the pauses double in between.
const RECONNECT_PAUSES: [Duration; 2] = [Duration::from_millis(250), Duration::from_secs(8)];
/// Shortest time between two commands that request a reading.
const BETWEEN_COMMANDS: Duration = Duration::from_millis(20);
/// Timeout for a response and for the rest of a line.
const ANSWER: Duration = Duration::from_secs(1);
/// Largest number of bytes read at once.
const CHUNK: usize = 512;

/// Data received by the thread.
#[derive(Debug, Default)]
struct Received {
    /// Time (s) and distance (m) of the latest reading.
    reading: Option<(f64, Option<f64>)>,
    /// Reason why the latest line was not a distance, or the connection is lost.
    trouble: Option<String>,
    /// The latest line, with unprintable characters replaced.
    line: Option<String>,
}

#[derive(Clone)]
struct Shared {
    received: Arc<Mutex<Received>>,
    clock: Arc<dyn Clock>,
}

impl Shared {
    fn received(&self) -> MutexGuard<'_, Received> {
        self.received.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn connection_lost(&self, why: String) {
        *self.received() = Received {
            reading: None,
            trouble: Some(why),
            line: None,
        };
    }

    /// Stores the content of a line. An invalid line also removes the latest reading, as the sensor may be at fault.
    fn receive(&self, content: LineContent) {
        let mut received = self.received();
        let now_s = self.clock.now_s();
        match content {
            LineContent::Distance(distance_m) => received.reading = Some((now_s, Some(distance_m))),
            LineContent::NoReturn => received.reading = Some((now_s, None)),
            LineContent::Invalid(why) => {
                received.reading = None;
                received.trouble = Some(why);
                return;
            }
        }
        received.trouble = None;
    }
}

/// A laser that sends lines of text. While connected, a thread reads them and re-establishes a lost connection.
pub struct LineLaser {
    settings: LineLaserSettings,
    shared: Shared,
    /// The thread, which ends when the sender is dropped.
    running: Option<(Sender<()>, JoinHandle<()>)>,
}

impl LineLaser {
    /// A laser that is not connected; the clock determines the age of readings.
    #[must_use]
    pub fn new(settings: LineLaserSettings, clock: Arc<dyn Clock>) -> Self {
        let received = Arc::default();
        Self {
            settings,
            shared: Shared { received, clock },
            running: None,
        }
    }

    /// The latest line, for finding the right settings; `None` before the first one and without a connection.
    #[must_use]
    pub fn line(&self) -> Option<String> {
        self.shared.received().line.clone()
    }
}

impl Drop for LineLaser {
    fn drop(&mut self) {
        self.disconnect();
    }
}

impl LaserSource for LineLaser {
    fn identity(&self) -> String {
        format!("Laser at {}", port::name(&self.settings.port))
    }

    fn connect(&mut self) -> Result<(), LinkError> {
        if self.running.is_some() {
            return Ok(());
        }
        let parser = LineParser::new(&self.settings).map_err(LinkError::Laser)?;
        let opened = port::open(&self.settings.port).map_err(LinkError::Laser)?;
        *self.shared.received() = Received::default();
        let (end, ends) = mpsc::channel();
        let reader_thread = LineReader {
            settings: self.settings.clone(),
            parser,
            shared: self.shared.clone(),
            ends,
        };
        let thread = thread::Builder::new().name("laser".into());
        let thread = thread.spawn(move || reader_thread.run(opened));
        let thread = thread.map_err(|error| LinkError::Laser(error.to_string()))?;
        self.running = Some((end, thread));
        Ok(())
    }

    fn disconnect(&mut self) {
        if let Some((end, thread)) = self.running.take() {
            drop(end);
            // A thread that panicked has ended, too.
            let _ = thread.join();
        }
        *self.shared.received() = Received::default();
    }

    fn latest(&self) -> Option<LaserReading> {
        let (read_s, distance_m) = self.shared.received().reading?;
        Some(LaserReading {
            age_s: self.shared.clock.now_s() - read_s,
            distance_m,
        })
    }

    fn max_age_s(&self) -> f64 {
        self.settings.fresh_s
    }

    fn discard_reading(&mut self) {
        self.shared.received().reading = None;
    }

    fn problem(&self) -> Option<String> {
        let name = port::name(&self.settings.port);
        if self.running.is_none() {
            return Some(format!("the laser at {name} is not connected"));
        }
        let latest = self.latest().filter(|r| r.age_s <= self.settings.fresh_s);
        match latest {
            Some(LaserReading { distance_m, .. }) => distance_m
                .is_none()
                .then(|| format!("the laser at {name} reports no return")),
            None => {
                let known = self.shared.received().trouble.clone();
                let known = known.unwrap_or_else(|| "it sends nothing".to_owned());
                Some(format!("the laser at {name}: {known}"))
            }
        }
    }
}

/// The thread that reads lines.
struct LineReader {
    settings: LineLaserSettings,
    parser: LineParser,
    shared: Shared,
    ends: Receiver<()>,
}

impl LineReader {
    /// Reads until asked to stop.
    fn run(self, first: Box<dyn Port>) {
        let mut opened = Ok(first);
        let mut wait = RECONNECT_PAUSES[0];
        loop {
            let lost = match opened {
                Ok(port) => {
                    let (lost, any) = self.communicate(port);
                    if any {
                        wait = RECONNECT_PAUSES[0];
                    }
                    lost
                }
                Err(why) => Some(why),
            };
            let Some(why) = lost else { return };
            self.shared.connection_lost(why);
            if self.should_stop(wait) {
                return;
            }
            wait = (2 * wait).min(RECONNECT_PAUSES[1]);
            opened = port::open(&self.settings.port);
        }
    }

    /// Waits; returns whether the thread was asked to stop.
    fn should_stop(&self, wait: Duration) -> bool {
        self.ends.recv_timeout(wait) != Err(RecvTimeoutError::Timeout)
    }

    /// Reads from a port until it is lost (returns why) or the thread is asked to stop; also returns whether any line arrived.
    fn communicate(&self, mut port: Box<dyn Port>) -> (Option<String>, bool) {
        let mut lines = LineSplitter::default();
        let mut chunk = [0; CHUNK];
        let mut any = false;
        let mut spoke = Instant::now();
        let mut asks = true;
        loop {
            if asks && let Some(command) = &self.settings.command {
                if self.should_stop(BETWEEN_COMMANDS) {
                    return (None, any);
                }
                let written = port.write_all(command.as_bytes());
                if let Err(error) = written.and_then(|()| port.flush()) {
                    return (Some(lost(&error)), any);
                }
                spoke = Instant::now();
                asks = false;
            }
            if self.should_stop(Duration::ZERO) {
                return (None, any);
            }
            match port.read(&mut chunk) {
                Ok(0) => return (Some("the other side closed the connection".to_owned()), any),
                Ok(count) => {
                    let bytes = chunk.get(..count).unwrap_or_default();
                    lines.take(bytes, |line| {
                        any = true;
                        self.shared.received().line = line.map(printable);
                        if let Some(content) = self.parser.parse(line) {
                            self.shared.receive(content);
                            asks = true;
                        }
                    });
                    spoke = Instant::now();
                }
                Err(error) if is_wait(&error) => {
                    if spoke.elapsed() > ANSWER {
                        lines.reset();
                        asks = true;
                        spoke = Instant::now();
                    }
                }
                Err(error) => return (Some(lost(&error)), any),
            }
        }
    }
}

/// A line with unprintable characters replaced.
fn printable(line: &[u8]) -> String {
    let text = String::from_utf8_lossy(line);
    let shown = text.chars().map(|c| if c.is_control() { ' ' } else { c });
    shown.collect()
}

fn is_wait(error: &io::Error) -> bool {
    matches!(
        error.kind(),
        ErrorKind::WouldBlock | ErrorKind::TimedOut | ErrorKind::Interrupted
    )
}

fn lost(error: &io::Error) -> String {
    format!("the connection is lost ({error})")
}

#[cfg(test)]
mod tests;
