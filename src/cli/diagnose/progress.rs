//! Progress of a long diagnosis, on one line of the terminal.

use std::io::Write;
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use tautline_core::diagnosis::DiagnosisProgress;
use tautline_core::estimation::Control;
use tautline_workflow::diagnosis::stage;

use crate::progress::{is_shown, overwrite};

/// Time after which the line appears, so that a short diagnosis does not show it.
const QUIET: Duration = Duration::from_secs(1);
/// Time to wait for the next message once the latest is shown.
const PATIENCE: Duration = Duration::from_secs(3600);

/// Progress line that exists as long as this value, if progress is shown at all.
pub struct ProgressLine(Option<(Sender<DiagnosisProgress>, JoinHandle<()>)>);

impl ProgressLine {
    /// Starts the line, which appears if the diagnosis takes long.
    pub fn start() -> Self {
        if !is_shown() {
            return Self(None);
        }
        let (sender, receiver) = channel();
        let thread = std::thread::spawn(move || show(&receiver, &mut std::io::stderr(), QUIET));
        Self(Some((sender, thread)))
    }

    /// Shows the progress of the diagnosis.
    pub fn update(&mut self, progress: DiagnosisProgress) -> Control {
        if let Some((sender, _)) = &self.0 {
            // The thread ends early only if standard error is closed; the diagnosis continues without its line.
            let _ = sender.send(progress);
        }
        Control::Continue
    }
}

impl Drop for ProgressLine {
    fn drop(&mut self) {
        if let Some((sender, thread)) = self.0.take() {
            drop(sender);
            let _ = thread.join();
        }
    }
}

/// Shows the latest progress until the sender is dropped, then clears the line.
fn show(progress: &Receiver<DiagnosisProgress>, out: &mut impl Write, quiet: Duration) {
    let started = Instant::now();
    let mut latest = None;
    let mut shown = None;
    loop {
        let wait = if shown == latest {
            PATIENCE
        } else {
            quiet.saturating_sub(started.elapsed())
        };
        match progress.recv_timeout(wait) {
            Ok(progress) => latest = Some(progress),
            Err(RecvTimeoutError::Timeout) => {}
            Err(RecvTimeoutError::Disconnected) => break,
        }
        if started.elapsed() < quiet || shown == latest {
            continue;
        }
        shown = latest;
        if let Some(progress) = latest {
            overwrite(out, &words(&progress));
        }
    }
    if shown.is_some() {
        overwrite(out, "");
    }
}

fn words(progress: &DiagnosisProgress) -> String {
    let stage = stage(progress.stage);
    match progress.findings {
        0 => format!("{stage} ..."),
        found => format!("{found} found, {stage} ..."),
    }
}

#[cfg(test)]
mod tests {
    use tautline_core::diagnosis::Stage;

    use super::*;

    fn shown(quiet: Duration) -> String {
        let (sender, receiver) = channel();
        for (stage, findings) in [(Stage::BaseFit, 0), (Stage::Refits, 2)] {
            let progress = DiagnosisProgress { stage, findings };
            sender.send(progress).expect("a listener");
        }
        drop(sender);
        let mut out = Vec::new();
        show(&receiver, &mut out, quiet);
        String::from_utf8(out).expect("UTF-8")
    }

    #[test]
    fn the_line_tells_the_stage_and_is_cleared() {
        let text = shown(Duration::ZERO);
        assert!(text.contains("fitting the model as it is ..."), "{text:?}");
        assert!(text.ends_with("2 found, fitting the likeliest causes ...\r\x1b[2K"));
    }

    #[test]
    fn a_short_diagnosis_shows_nothing() {
        assert_eq!(shown(Duration::from_secs(60)), "");
    }
}
