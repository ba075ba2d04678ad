//! `tautline check --against`.

use std::path::Path;

use anyhow::Result;
use tautline_workflow::health::{Baseline, HealthDocument, verdict_sentences};
use tautline_workflow::readiness::readings_readiness;

use super::{Arguments, print_items};
use crate::failure::{BadInput, Reservation};
use crate::input::{self, Measured};
use crate::output::say;

/// Checks readings against a calibration. Few poses need not determine the geometry by themselves.
pub fn run(arguments: &Arguments, read: &Measured, baseline: &Path) -> Result<()> {
    let readings = readings_readiness(&read.dataset, read.lines.as_ref());
    if !readings.ready {
        arguments
            .json
            .deliver(&readings, || print_items(&readings.checks))?;
        return Err(Reservation::NotReady.into());
    }
    let (session, time) = input::dated_session(baseline)?;
    let failed = |path: &Path, error: &dyn std::fmt::Display| {
        BadInput::new(format!("{}: {error}", path.display()))
    };
    let baseline_read = Baseline::new(&session, time).map_err(|e| failed(baseline, &e))?;
    let checked = baseline_read.check(&read.dataset, read.measured_at);
    let checked = checked.map_err(|e| failed(&arguments.dataset, &e))?;
    let sentences = verdict_sentences(&baseline_read, &checked);
    let document = HealthDocument::of(readings, &baseline_read, &checked);
    arguments.json.deliver(&document, || {
        for sentence in sentences {
            say!("{sentence}");
        }
    })
}
