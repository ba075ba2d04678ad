//! Tells the observer how far a diagnosis is, and asks whether to go on.

use super::{DiagnosisProgress, Observer, Stage};
use crate::estimation::Control;

/// The observer with its last answer.
pub(super) struct Reporter<'o, 'f> {
    observer: &'o mut Observer<'f>,
    pub cancelled: bool,
}

impl<'o, 'f> Reporter<'o, 'f> {
    pub fn new(observer: &'o mut Observer<'f>) -> Self {
        Self {
            observer,
            cancelled: false,
        }
    }

    /// Tells where it is; whether to go on.
    pub fn stage(&mut self, stage: Stage, findings: usize) -> bool {
        if !self.cancelled {
            let progress = DiagnosisProgress { stage, findings };
            self.cancelled = (self.observer)(&progress) == Control::Cancel;
        }
        !self.cancelled
    }
}
