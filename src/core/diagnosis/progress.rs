//! Reports progress to the observer and records whether it has cancelled.

use super::{DiagnosisProgress, Observer, Stage};
use crate::estimation::Control;

/// The observer and whether it has cancelled.
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

    /// Reports the stage; returns whether to continue.
    pub fn stage(&mut self, stage: Stage, findings: usize) -> bool {
        if !self.cancelled {
            let progress = DiagnosisProgress { stage, findings };
            self.cancelled = (self.observer)(&progress) == Control::Cancel;
        }
        !self.cancelled
    }
}
