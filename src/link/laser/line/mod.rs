//! A laser distance sensor that sends lines of text over a network connection or a serial port.

use std::io::{self, ErrorKind};
use std::sync::mpsc::{self, Receiver, RecvTimeoutError, Sender};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant};

use tautline_session::LineLaserSettings;

use super::lines::{Lines, Reader, Said};
use super::port::{self, Port};
use super::{LaserReading, LaserSource};
use crate::clock::Clock;
use crate::controller::LinkError;

/// First wait before a lost connection is made anew, and the longest, to which it doubles.
const WAITS: [Duration; 2] = [Duration::from_millis(250), Duration::from_secs(8)];
/// Shortest time between two commands that ask for a reading.
const BETWEEN_COMMANDS: Duration = Duration::from_millis(20);
/// Time after which an answer or the rest of a line is not waited for any more.
const ANSWER: Duration = Duration::from_secs(1);
/// Bytes that are read at once.
const CHUNK: usize = 512;

/// What the thread leaves for others.
#[derive(Debug, Default)]
struct Heard {
    /// Time (s) and distance (m) of the latest reading.
    reading: Option<(f64, Option<f64>)>,
    /// What was wrong last.
    trouble: Option<String>,
    /// The last line as it came, what cannot be printed replaced.
    line: Option<String>,
}

#[derive(Clone)]
struct Shared {
    heard: Arc<Mutex<Heard>>,
    clock: Arc<dyn Clock>,
}

impl Shared {
    fn heard(&self) -> MutexGuard<'_, Heard> {
        self.heard.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn lose(&self, why: String) {
        *self.heard() = Heard {
            reading: None,
            trouble: Some(why),
            line: None,
        };
    }

    /// A line that is no distance takes the latest reading away: it may have been a fault of the sensor.
    fn hear(&self, said: Said) {
        let mut heard = self.heard();
        let now_s = self.clock.now_s();
        match said {
            Said::Distance(distance_m) => heard.reading = Some((now_s, Some(distance_m))),
            Said::NoReturn => heard.reading = Some((now_s, None)),
            Said::Garbage(why) => {
                heard.reading = None;
                heard.trouble = Some(why);
                return;
            }
        }
        heard.trouble = None;
    }
}

/// A laser that sends lines of text. While it is connected a thread reads them, and makes a lost connection anew.
pub struct LineLaser {
    settings: LineLaserSettings,
    shared: Shared,
    /// The thread ends when this is dropped.
    running: Option<(Sender<()>, JoinHandle<()>)>,
}

impl LineLaser {
    /// A laser, not connected; ages of readings are by the clock.
    #[must_use]
    pub fn new(settings: LineLaserSettings, clock: Arc<dyn Clock>) -> Self {
        let heard = Arc::default();
        Self {
            settings,
            shared: Shared { heard, clock },
            running: None,
        }
    }

    /// The last line as it came, to find the right settings with; `None` before the first and of a lost connection.
    #[must_use]
    pub fn line(&self) -> Option<String> {
        self.shared.heard().line.clone()
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
        let reader = Reader::new(&self.settings).map_err(LinkError::Laser)?;
        let opened = port::open(&self.settings.port).map_err(LinkError::Laser)?;
        *self.shared.heard() = Heard::default();
        let (end, ends) = mpsc::channel();
        let listener = Listener {
            settings: self.settings.clone(),
            reader,
            shared: self.shared.clone(),
            ends,
        };
        let thread = thread::Builder::new().name("laser".into());
        let thread = thread.spawn(move || listener.listen(opened));
        let thread = thread.map_err(|error| LinkError::Laser(error.to_string()))?;
        self.running = Some((end, thread));
        Ok(())
    }

    fn disconnect(&mut self) {
        if let Some((end, thread)) = self.running.take() {
            drop(end);
            // A thread that broke down has ended, too.
            let _ = thread.join();
        }
        *self.shared.heard() = Heard::default();
    }

    fn latest(&self) -> Option<LaserReading> {
        let (read_s, distance_m) = self.shared.heard().reading?;
        Some(LaserReading {
            age_s: self.shared.clock.now_s() - read_s,
            distance_m,
        })
    }

    fn fresh_s(&self) -> f64 {
        self.settings.fresh_s
    }

    fn leave(&mut self) {
        self.shared.heard().reading = None;
    }

    fn trouble(&self) -> Option<String> {
        let name = port::name(&self.settings.port);
        if self.running.is_none() {
            return Some(format!("the laser at {name} is not connected"));
        }
        let latest = self.latest().filter(|r| r.age_s <= self.settings.fresh_s);
        match latest {
            Some(LaserReading { distance_m, .. }) => distance_m
                .is_none()
                .then(|| format!("the laser at {name} says that it has no return")),
            None => {
                let known = self.shared.heard().trouble.clone();
                let known = known.unwrap_or_else(|| "it sends nothing".to_owned());
                Some(format!("the laser at {name}: {known}"))
            }
        }
    }
}

/// The thread that reads.
struct Listener {
    settings: LineLaserSettings,
    reader: Reader,
    shared: Shared,
    ends: Receiver<()>,
}

impl Listener {
    /// Reads until it shall end.
    fn listen(self, first: Box<dyn Port>) {
        let mut opened = Ok(first);
        let mut wait = WAITS[0];
        loop {
            let lost = match opened {
                Ok(port) => {
                    let (lost, any) = self.converse(port);
                    if any {
                        wait = WAITS[0];
                    }
                    lost
                }
                Err(why) => Some(why),
            };
            let Some(why) = lost else { return };
            self.shared.lose(why);
            if self.shall_end(wait) {
                return;
            }
            wait = (2 * wait).min(WAITS[1]);
            opened = port::open(&self.settings.port);
        }
    }

    /// Waits; whether it shall end.
    fn shall_end(&self, wait: Duration) -> bool {
        self.ends.recv_timeout(wait) != Err(RecvTimeoutError::Timeout)
    }

    /// Reads from a port until that is lost, and says why, or shall end; and whether it ever sent a line.
    fn converse(&self, mut port: Box<dyn Port>) -> (Option<String>, bool) {
        let mut lines = Lines::default();
        let mut chunk = [0; CHUNK];
        let mut any = false;
        let mut spoke = Instant::now();
        let mut asks = true;
        loop {
            if asks && let Some(command) = &self.settings.command {
                if self.shall_end(BETWEEN_COMMANDS) {
                    return (None, any);
                }
                let written = port.write_all(command.as_bytes());
                if let Err(error) = written.and_then(|()| port.flush()) {
                    return (Some(lost(&error)), any);
                }
                spoke = Instant::now();
                asks = false;
            }
            if self.shall_end(Duration::ZERO) {
                return (None, any);
            }
            match port.read(&mut chunk) {
                Ok(0) => return (Some("the other side ended the connection".to_owned()), any),
                Ok(count) => {
                    let bytes = chunk.get(..count).unwrap_or_default();
                    lines.take(bytes, |line| {
                        any = true;
                        self.shared.heard().line = line.map(printable);
                        if let Some(said) = self.reader.read(line) {
                            self.shared.hear(said);
                            asks = true;
                        }
                    });
                    spoke = Instant::now();
                }
                Err(error) if is_wait(&error) => {
                    if spoke.elapsed() > ANSWER {
                        lines.give_up();
                        asks = true;
                        spoke = Instant::now();
                    }
                }
                Err(error) => return (Some(lost(&error)), any),
            }
        }
    }
}

/// A line as it can be shown.
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
    format!("the connection broke: {error}")
}

#[cfg(test)]
mod tests;
